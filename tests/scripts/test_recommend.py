"""Tests of scripts/recommend on the made-up study of study_documents.py, whose answers are worked out by hand, and of
its trials on small scenes.

There errors and seconds of a fast form are, with N = 5/h steps from 5 to 200, rk4 1e-2 h⁴ and 1e-4 N; rkmk4 1e-3 h⁴ and
1e-3 N; group2 0.1 h⁴ and 4e-3 N, in the frame 1e-2 h⁴; elp4_frame 1e-2 h⁴ and 2e-3 N; group1 h² and 1.5e-3 N;
cotangent1 h² and 2e-3 N. group2_frame at the tolerance 1e-7 and elp4_frame at 1e-8 take half the time. group1 fails at
h = 1; rk4 at n = 33 is within its stability limit up to h = 0.52 only. The lines of group1 and cotangent1 are cut.
"""

import json
import math
import os
import resource
import shlex
import sys
import unittest
from types import SimpleNamespace
from dataclasses import replace
from unittest import mock

import numpy
from programs import (BUILD, DATA, HAS_MODULE, ROOT, FolderTest, call_script, program, run, run_on_full_disk,
                      run_script, strict_json)
from study_documents import INTEGRATORS, accuracy_of, run_of, study_document, write_study

from recommender import trial_planner as trial_planner
from lib.running import built
from studies.accuracy import cheapest as recommendation
from lib.records.settings import ENERGY_BOUNDED, LOOSE_EXPONENTIAL, LOOSE_GAUSS, TIGHT, keeping_tolerance
from studies.accuracy.schema import BELOW, CUT, FLOOR, Form
from lib.programs.messages import UnusableFile
from studies.accuracy.cheapest import MARGIN, MARGIN_OF_N, Question, Recorded
from lib.records.formats import CONVERGED, STATUSES, listed

SCRIPT = os.path.join(ROOT, "scripts", "recommend")
UNANSWERABLE = 3
MINIMUM = 0.99  # the least of a run's repetitions over its usual time
QUESTION = {"--n": "17", "--time": "5", "--error": "1"}


def arguments_of(**changes):
    """Returns the arguments of a question; None leaves one out."""
    options = {**QUESTION, **{f"--{name}": value for name, value in changes.items()}}
    return [word for name, value in options.items() if value is not None for word in (name, value)]


def steps_for(name, error, time=5.0):
    """Returns the steps with which a made-up integrator has an error at T = 5."""
    factor, _ = INTEGRATORS[name]
    return math.ceil(time / (error / factor) ** (1 / listed(name).order))


class RecommendTest(FolderTest):
    BOUNDED = ("exponential Lie–Poisson methods are offered at the tolerance 1e-13 only, at which their energy stays"
               " bounded")

    def setUp(self):
        super().setUp()
        self.document = study_document()
        for without_module in (mock.patch.dict(os.environ, {"ISOSYRK_BUILD": self.folder}),
                               mock.patch.object(built, "MODULE", self.folder)):
            without_module.start()
            self.addCleanup(without_module.stop)

    def recommend(self, *arguments):
        """Runs the script on the document as it is now."""
        return run_script(SCRIPT, "--raw", write_study(self.folder, self.document), *arguments)

    def answer(self, n, error, keep="nothing", time=5.0, scene="smooth", **options):
        return recommendation.answer(accuracy_of(self.document), Question(scene, n, time, error, keep), "raw",
                                     **options)

    def recorded(self, n, error, keep="nothing", time=5.0):
        return Recorded(accuracy_of(self.document), Question("smooth", n, time, error, keep))

    def steps(self, name, n, error, tolerance=TIGHT):
        """Returns the steps that are offered with one integrator to T = 5, or None."""
        offer = self.recorded(n, error).offer(Form(name, tolerance))
        return offer and offer.steps

    def keep_only(self, *integrators):
        """Leaves no other integrators in the document."""
        for name in ("runs", "lines"):
            self.document[name] = [each for each in self.document[name] if each["integrator"] in integrators]


class Step(RecommendTest):
    def test_no_step_beyond_the_longest_run_within_limits(self):
        self.assertEqual(self.steps("rkmk4", 17, 0.5), 5)
        self.assertEqual(self.steps("rk4", 33, 0.01), 10)
        # Between n = 17 and 33 neither has a larger h‖B‖₂ than the lesser of the two; ‖B‖₂ is in proportion to n.
        self.assertEqual(self.steps("group2", 24, 0.5), math.ceil(5 * 24 / 17))
        for steps in (5, 10):
            run_of(self.document, "group2", 33, steps)["beyond_limit"] = True
        self.assertEqual(self.steps("group2", 24, 0.5), math.ceil(5 * 24 / (33 * 0.25)))
        for each in self.document["runs"]:
            each["beyond_limit"] = False
        self.assertEqual(self.steps("rk4", 33, 0.01), steps_for("rk4", 0.01 / MARGIN))
        run_of(self.document, "rk4", 33, 200)["beyond_limit"] = True  # of the shortest step
        self.assertEqual(self.steps("rk4", 33, 0.01), steps_for("rk4", 0.01 / MARGIN))

    def test_no_step_beyond_a_failure_and_no_interpolation_across_it(self):
        self.assertEqual(self.steps("group2", 17, 0.01), steps_for("group2", 0.01 / MARGIN))
        for changes in (*({"status": status} for status in STATUSES if status != CONVERGED), {"beyond_limit": True}):
            with self.subTest(changes=changes):
                self.document = study_document()
                run_of(self.document, "group2", 17, 20).update(changes)
                self.assertEqual(self.steps("group2", 17, 0.01), 50)  # with 10 steps it worked and had 6e-3

    def test_no_error_that_a_shorter_step_does_not_confirm(self):
        run_of(self.document, "group2", 17, 10)["error"] = 1e-6  # by chance, where 20 steps have 4e-4
        self.assertEqual(self.steps("group2", 17, 1e-5), steps_for("group2", 1e-5 / MARGIN))


class Between(RecommendTest):
    def test_n_is_interpolated_and_that_is_said(self):
        found = self.answer(24, 1e-4, "spectrum")
        self.assertEqual(found["steps"], steps_for("rkmk4", 1e-4 / MARGIN / MARGIN_OF_N))
        self.assertIn("n = 24 is not recorded", found["statements"][0])
        self.assertEqual({each["n"] for each in found["evidence"]}, {17, 33})
        self.assertEqual(self.answer(17, 1e-4)["statements"], [])

    def test_beyond_predictability_energy_and_spectrum_are_judged(self):
        for each in self.document["runs"]:
            if each["integrator"] == "rkmk4" and each["status"] == CONVERGED:
                each["energy_error"] = 1e-3 * (each["time"] / each["steps"])**4
        found = self.answer(17, 1e-3, time=25.0)
        self.assertEqual(found["judged"], "energy and spectrum")
        self.assertIn("beyond the recorded trajectories, which end at T = 5", found["statements"][0])
        offers = {offer["integrator"]: offer["steps"] for offer in (found, *found["runners_up"])}
        self.assertEqual(offers["rkmk4"], steps_for("rkmk4", 1e-3 / MARGIN / 25, 25))  # as the square of time
        self.assertEqual(offers["group2"], 25)
        self.assertNotIn("rk4", offers)
        self.assertNotIn("elp4_frame", offers)
        self.assertIn("is not extrapolated in time", found["statements"][1])
        self.assertIn(self.BOUNDED, found["statements"])
        # A Gauss method at a loose tolerance may lose the spectrum.
        lines = self.recorded(17, 1e-5, time=25.0).lines
        self.assertNotIn(Form("group2_frame", LOOSE_GAUSS), lines)
        self.assertIn(Form("group2_frame"), lines)
        self.document["references"][0]["uncertainty"] = 0.1  # no reference
        self.assertEqual(self.answer(17, 1e-3)["judged"], "energy and spectrum")

    def test_the_growth_of_the_energy_error_is_no_less_than_was_measured(self):
        for integrator, *measured in (
                (listed("rkmk4"), (100, 4.3), (200, 12.4), (400, 36)),  # n = 33, h = 1, from T = 50
                (listed("elp4_frame"), (79, 6.0), (100, 7.3), (400, 23)),  # elp6, n = 65, h = 0.5
                (listed("group2_frame"), (100, 1.4), (400, 1.6))):
            for time, growth in measured:
                with self.subTest(integrator=integrator.name, time=time):
                    promised = recommendation.energy_growth(integrator, 50.0, time)
                    self.assertGreaterEqual(MARGIN * promised, growth)
        # What follows no power is not extrapolated, not even a little.
        for name, known in (("elp6_frame", 40.0), ("magnus5", 100.0), ("rk4_projected_frame", 100.0),
                            ("rk8_projected", 100.0)):
            for time, growth in ((known, 1.0), (known + 1, math.inf)):
                self.assertEqual(recommendation.energy_growth(listed(name), known, time), growth)


class Answers(RecommendTest):
    def test_json_and_text(self):
        question = arguments_of(error="1e-3")
        found = strict_json(self.recommend(*question, "--json").stdout)
        self.assertEqual([found[name] for name in ("integrator", "solver", "steps", "step", "keeps")],
                         ["rk4", "fast", 10, 0.5, "nothing"])
        self.assertLessEqual(found["expected_error"], 1e-3)
        self.assertIn("--n 17 --scene smooth --integrator rk4 --solver fast --step 0.5 --time 5.0", found["command"])
        self.assertEqual(sorted(each["steps"] for each in found["evidence"]), [5, 10])
        self.assertNotIn("--tolerance", found["command"])
        self.assertEqual([(each["integrator"], each["tolerance"], each["keeps"]) for each in found["runners_up"]],
                         [("rkmk4", TIGHT, "spectrum"), ("elp4_frame", LOOSE_EXPONENTIAL, "spectrum"),
                          ("group2_frame", LOOSE_GAUSS, "nothing"), ("elp4_frame", TIGHT, "poisson")])
        self.assertEqual([shlex.split(each["command"])[-10:-8] for each in found["runners_up"]],
                         [["--scene", "smooth"], ["--tolerance", "1e-08"], ["--tolerance", "1e-07"],
                          ["--scene", "smooth"]])
        self.assertEqual({each["tolerance"] for each in found["evidence"]}, {TIGHT})
        self.assertEqual(found["source"]["commit"], "0123456789ab")
        result = self.recommend(*question)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"(?s)\nrk4 +fast +1e-13 +4 +nothing +0.5 +10 .*\nrkmk4 .*\n"
                                        r"elp4_frame +fast +1e-08 +4 +spectrum .*\nEvidence .*\nrk4 +1e-13 ")
        self.assertEqual(result.stdout.splitlines()[-1], found["command"])
        self.assertIn("Note: n = 24 is not recorded", self.recommend(*arguments_of(n="24")).stdout)

    def test_the_developed_scene_says_how_its_state_is_made(self):
        for name in ("references", "lines", "runs", "tolerance_runs"):
            self.document[name] = [{**each, "scene": "developed"} for each in self.document[name]
                                   if each["scene"] == "smooth"]
        found = self.answer(17, 1e-3, scene="developed")
        self.assertIn("--initial developed_n17.npy", found["command"])
        self.assertRegex(found["command"], "--scene smooth .* --output developed_n17.npy && "
                                           ".* --initial developed_n17.npy ")


class Tolerances(RecommendTest):
    DRIFTS = ("at the tolerance 1e-08 the Lie–Poisson structure is kept to about the tolerance only: over a long run"
              " the energy drifts")
    CUT_LINE = "its recorded line was cut before the error was reached"

    def test_beyond_trajectories_exponential_methods_are_offered_with_bounded_energy_only(self):
        for row in self.document["runs"]:  # recorded to a time from which their energy is extrapolated
            row["time"] *= 10
        for table in ("references", "lines"):
            self.document[table] = [{**row, "time": 50.0} for row in self.document[table]]
        self.keep_only("elp4_frame")
        for time, tolerance in ((50.0, LOOSE_EXPONENTIAL), (200.0, ENERGY_BOUNDED)):
            for keep in ("nothing", "spectrum"):
                found = self.answer(17, 1e-2, keep, time=time)
                self.assertEqual(found["tolerance"], tolerance)
                self.assertEqual(self.BOUNDED in found["statements"], tolerance == ENERGY_BOUNDED)

    def test_what_a_loose_one_keeps_is_said(self):
        self.assertEqual(self.answer(17, 1e-3, "poisson")["statements"], [self.BOUNDED])
        self.keep_only("elp4_frame")
        for keep in ("nothing", "spectrum"):
            found = self.answer(17, 1e-3, keep)
            self.assertEqual((found["tolerance"], found["statements"]), (LOOSE_EXPONENTIAL, [self.DRIFTS]))
        self.document = study_document()
        self.keep_only("group2_frame")
        found = self.answer(17, 1e-3)
        self.assertEqual((found["tolerance"], found["statements"]),
                         (LOOSE_GAUSS, ["at the tolerance 1e-07 the spectrum is kept to about the tolerance only"]))
        self.assertEqual(self.answer(17, 1e-3, "spectrum")["statements"], [])  # at the tightest

    def cut(self, name, steps, end=CUT):
        """Ends the line of an integrator at n = 17 at a run, so."""
        where = {"scene": "smooth", "n": 17, "integrator": name}
        for table in ("runs", "lines"):
            self.document[table] = [each for each in self.document[table]
                                    if not where.items() <= each.items() or each.get("steps", 0) <= steps]
        next(each for each in self.document["lines"] if where.items() <= each.items())["end"] = end

    def test_a_line_that_was_cut_is_not_compared_with(self):
        self.cut("cotangent1", 5)  # after 0.01 s; the answer takes 0.017 s
        said = f"not known whether cotangent1 is cheaper: {self.CUT_LINE}"
        self.assertEqual(self.answer(17, 1e-4, "poisson")["statements"], [said, self.BOUNDED])
        # Controls: at another n, a sooner answer, an error that the line reaches, and a line that ended otherwise.
        self.assertEqual(self.answer(33, 1e-4, "poisson")["statements"], [self.BOUNDED])
        self.assertEqual(self.answer(17, 1e-4)["statements"], [])
        self.assertEqual(self.answer(17, 1.3, "poisson")["statements"], [self.BOUNDED])
        for end in (BELOW, FLOOR):
            self.cut("cotangent1", 5, end)
            self.assertEqual(self.answer(17, 1e-4, "poisson")["statements"], [self.BOUNDED])
        self.cut("cotangent1", 5)
        self.cut("group1", 10)
        self.assertIn("cotangent1 and group1 are cheaper: their", self.answer(17, 1e-4, "poisson")["statements"][0])


class Refusals(RecommendTest):
    def test_what_no_recorded_run_answers(self):
        for changes, *words in (
                ({"error": "1e-12"}, "1e-12", "the best there is has 3.91e-10, by rkmk4 with h = 0.025"),
                ({"error": "1e-12", "keep": "poisson"}, "that keep the Lie–Poisson", "by group2_frame with"),
                ({"error": "1.1e-14"}, "the best"),  # it could be told, but no run has it
                ({"n": "16"}, "n = 16", "n = 17, 33 to T = 5"), ({"n": "34"}, "n = 34"),
                ({"scene": "developed"}, "developed (nothing)")):
            with self.subTest(changes=changes):
                result = self.recommend(*arguments_of(**changes))
                self.assertEqual((result.returncode, result.stdout), (UNANSWERABLE, ""), result.stderr)
                self.assert_one_line(result.stderr, *words)

    def test_bad_arguments_and_files_that_cannot_be_used(self):
        foreign = self.write("foreign.json", '{"benchmarks": []}')
        for arguments, *parts in (
                *((arguments_of(n=value), "--n", f"'{value}'", "a whole number from 2 to 4096")
                  for value in ("1", "-17", "17.0", "4097", "")),
                *((arguments_of(error=value), "--error", f"'{value}'", "is not a number from")
                  for value in ("0", "-1", "1e-320", "nan", "1e300", "x", "")),
                *((arguments_of(**{name: "0"}), f"--{name}", "is not a number from") for name in ("time", "budget")),
                (arguments_of(raw=""), "No such file"),
                *((arguments_of(**{name: None}), f"--{name}") for name in ("n", "time", "error")),
                (arguments_of(keep="energy"), "--keep", "'energy'", "nothing", "spectrum", "poisson"),
                (arguments_of(scene="calm"), "--scene", "'calm'", "smooth", "rough", "developed"),
                (arguments_of(scene="rough", state="W.npy"), "--state", "not allowed with", "--scene"),
                (arguments_of(modes="m.csv"), "--raw"), (arguments_of(modes="m.csv", hbar="old"), "'old'", "standard"),
                *((arguments_of(**{name: value}), f"--{name}", "--modes")
                  for name, value in (("budget", "5"), ("hbar", "standard"))),
                ([*arguments_of(), "17"], "17"), (arguments_of(err="1"), "--err"),
                ([*arguments_of(), "two\nlines"], "two"),
                (arguments_of(error="9e-15"), "uncertainty", "1e-14"),
                (arguments_of(error="9e-13", scene="rough"), "uncertainty", "1e-12"),
                (arguments_of(raw=self.path("two\nlines.json")), "two lines.json", "No such file"),
                (arguments_of(raw=foreign), "recommend: ", "foreign.json: ")):
            with self.subTest(arguments=arguments):
                path = write_study(self.folder, self.document)
                self.assert_refused(call_script(SCRIPT, "--raw", path, *arguments), *parts)
        # As a user meets it: a wrong argument, a file that cannot be used, and an error below the reference's.
        for arguments, *parts in ((arguments_of(n="1"), "--n"), (arguments_of(raw=foreign), "foreign.json: "),
                                  (arguments_of(error="9e-15"), "uncertainty")):
            self.assert_refused(self.recommend(*arguments), "recommend: ", *parts)

    def test_the_recorded_run_is_the_default(self):
        result = run_script(SCRIPT, *arguments_of(error="1e-4"), "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        found, path = strict_json(result.stdout), os.path.join(ROOT, "results", "recorded", "accuracy", "raw.json")
        self.assertEqual(os.path.realpath(found["source"]["raw"]), os.path.realpath(path))
        self.assertLessEqual(found["expected_error"], 1e-4)
        # Control: the made-up study answers otherwise.
        made_up = strict_json(self.recommend(*arguments_of(error="1e-4"), "--json").stdout)
        self.assertNotEqual(found["command"], made_up["command"])

    def test_output_that_is_closed_or_full(self):
        command = [sys.executable, "-B", SCRIPT, "--raw", write_study(self.folder, self.document), *arguments_of()]
        reader, writer = os.pipe()
        os.close(reader)
        result = run(command, stdout=writer)
        os.close(writer)
        self.assertEqual((result.returncode, result.stderr), (1, ""))  # its reader has seen enough
        result = run_on_full_disk(command)
        self.assertEqual(result.returncode, 2)
        self.assert_one_line(result.stderr, "recommend: standard output: cannot be written")


@unittest.skipUnless(HAS_MODULE, "the module is not built")
class Trials(FolderTest):
    MODES = os.path.join(DATA, "initial_modes.csv")

    def trials(self, *arguments, error=1e-6, budget=5):
        return run([sys.executable, "-B", SCRIPT, "--time", "4", "--error", str(error), "--budget", str(budget),
                    *arguments])

    def answer(self, *arguments, **options):
        result = self.trials(*arguments, "--json", **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return strict_json(result.stdout)

    def executed(self, line, *more):
        """Runs an integrate line and returns its last state."""
        result = run([*shlex.split(line), *more, "--output", self.path("W.npy")])
        self.assertEqual(result.returncode, 0, result.stderr)
        return numpy.load(self.path("W.npy"))

    def state(self):
        return self.executed(f"{program('integrate')} --n 9 --integrator rk4 --step 1 --time 0")

    def check(self, found, error, *scene):
        exact = self.executed(f"{program('integrate')} --integrator group5 --solver fast --step 0.1 --time 4", *scene)
        wrong = numpy.linalg.norm(self.executed(found["command"]) - exact) / numpy.linalg.norm(exact)
        self.assertLessEqual(wrong, error)
        # The run that was measured, to rounding, with the uncertainty of its reference.
        self.assertLessEqual(wrong, 1.01 * found["expected_error"])

    def test_the_line_that_is_printed_has_the_error(self):
        for keep, hbar, error in (("nothing", "paper", 1e-4), ("poisson", "standard", 1e-7)):
            with self.subTest(keep=keep):
                scene = "--n", "13", "--modes", self.MODES, "--hbar", hbar
                found = self.answer(*scene, "--keep", keep, error=error)
                self.assertEqual((found["evidence"][0]["status"], found["solver"]), (CONVERGED, "fast"))
                self.assertEqual("--hbar standard" in found["command"], hbar == "standard")
                self.check(found, error, *scene)

    def test_a_state_of_another_norm(self):
        W, initial = self.state(), self.path("W0.npy")
        numpy.save(initial, W / 8)
        found = self.answer("--state", initial, "--keep", "spectrum")
        for offer in (found, *found["runners_up"]):  # the tolerance is relative to the state
            usual = keeping_tolerance(listed(offer["integrator"]))
            self.assertEqual(offer["tolerance"], usual)
            self.assertEqual("--tolerance 1e-08" in offer["command"], usual == 1e-8)
        self.assertIn(1e-8, [offer["tolerance"] for offer in (found, *found["runners_up"])])
        self.check(found, 1e-6, "--n", "9", "--initial", initial, "--tolerance", "1e-14")
        self.assert_refused(self.trials("--state", initial, "--n", "10"), "(9, 9), must be (10, 10)")
        numpy.save(initial, numpy.triu(W))
        self.assert_refused(self.trials("--state", initial), "--state", "skew")

    def test_a_named_scene_at_an_n_that_is_not_recorded_is_run_here(self):
        for scene in ("smooth", "rough"):
            found = self.answer("--n", "9", "--scene", scene, error=1e-5)
            self.assertIn(f"n = 9 is outside what is recorded of the scene {scene} (n = 17, 33, ",
                          found["statements"][0])
            self.assertIn(": the evidence is runs of the scene, made here", found["statements"][0])
            self.assertIn(f" --n 9 --scene {scene} ", found["command"])
            self.assertEqual({each["n"] for each in found["evidence"]}, {9})
            self.assertIn("trials", found["source"]["measured"])
            self.check(found, 1e-5, "--n", "9", "--scene", scene)
        # The controls: a recorded n is answered from the record, other scenes cannot be made.
        self.assert_refused(self.trials("--n", "17"), "--budget: goes with --modes or --state, or an n outside")
        result = self.trials("--n", "513", "--scene", "developed")
        self.assertEqual((result.returncode, result.stdout), (UNANSWERABLE, ""))
        self.assert_one_line(result.stderr, "n = 513 is outside what is recorded of the scene developed")
        self.assert_refused(self.trials("--n", "3"), "--scene smooth", "need n >= 5")

    def test_methods_that_the_budget_has_no_room_for_are_counted(self):
        _, search, rkmk4, trial = self.search()
        search.good = {rkmk4: replace(trial, time=8.0, status=CONVERGED)}
        search.trials = [replace(trial, integrator=each) for each in search.candidates]
        self.assertEqual(search.without_a_trial(), [])
        self.assertNotIn("had no room for", " ".join(search.statements))
        *search.trials, _, _ = search.trials
        search.untried = search.without_a_trial()
        self.assertEqual(search.untried, search.candidates[-2:])
        self.assertIn(f"the budget had no room for 2 of {len(search.candidates)} methods", " ".join(search.statements))
        # Where energies are judged, those of methods without the spectrum are not.
        search.trajectory, search.trials = False, []
        self.assertTrue(all(each.isospectral for each in search.without_a_trial()))

    def test_a_scene_that_takes_too_long_is_answered_within_the_budget(self):
        # Of CPU time it cannot take more, however busy the machine: the answer's run takes longer.
        def used():
            children = resource.getrusage(resource.RUSAGE_CHILDREN)
            return children.ru_utime + children.ru_stime

        for budget in (2, 4, 8, 16):  # a slow or busy machine finishes no trial run in the least
            before = used()
            time = str(1600 * budget)
            result = self.trials("--n", "65", "--modes", self.MODES, "--time", time, "--json", budget=budget)
            self.assertLess(used() - before, budget + 2)  # and the start of two Pythons
            if result.returncode == 0:
                break
            self.assert_one_line(result.stderr, "within the budget; no run that is to be trusted was finished")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = strict_json(result.stdout)
        self.assertGreater(found["seconds"], 2 * budget)
        self.assertIn("extrapolated", json.dumps(found["statements"]))

    def search(self):
        """Returns trials, a Search of a scene to T = 8, one of its integrators, and a trial to T = 4 of that."""
        sys.path.insert(0, os.path.join(BUILD, "python"))
        from recommender import trial_runs as trials  # only now: it needs the module
        search = trials.Search(trials.isosyrk.scene("smooth", n=9), Question("smooth", 9, 8.0, 1e-6, "spectrum"))
        (rkmk4,) = (each for each in search.candidates if each.name == "rkmk4_frame")
        return trials, search, rkmk4, recommendation.Outcome(rkmk4, 9, 4.0, 40, 1e-7, 1.0, growth=2.0)

    def test_candidates_are_all_fast_forms_in_the_frame_that_keep_what_is_asked_for(self):
        trials, search, *_ = self.search()
        listed = [each.name for each in trials.isosyrk.integrators() if each.has_fast_form
                  and each.name.endswith("_frame")]
        for structure, some, none in (("nothing", "rk8_frame", "bm2_frame"), ("poisson", "elp6_frame", "magnus5_frame"),
                                      ("spectrum", "abm8_projected_frame", "rk8_frame")):
            names = [each.name for each in trials.candidates_for(structure)]
            self.assertEqual((some in names, none in names), (True, False))
            self.assertEqual(set(names), set(listed) if structure == "nothing" else {*names} & {*listed})
        self.assertEqual(names, [each.name for each in search.candidates])

    def test_trials_of_exponential_methods_have_bounded_energy_where_structure_or_energy_is_asked_for(self):
        _, search, rkmk4, _ = self.search()
        elp6, magnus5 = (next(each for each in search.candidates if each.name == f"{name}_frame")
                         for name in ("elp6", "magnus5"))
        for keep, trajectory, tolerance in (("spectrum", True, LOOSE_EXPONENTIAL), ("poisson", True, ENERGY_BOUNDED),
                                            ("spectrum", False, ENERGY_BOUNDED)):
            search.question, search.trajectory = search.question._replace(keep=keep), trajectory
            self.assertEqual([search.outcome(each, 1.0, 2, None, 0.0).tolerance for each in (elp6, magnus5, rkmk4)],
                             [tolerance, LOOSE_EXPONENTIAL, TIGHT])
        # What was run at a looser one before energies were judged is not offered.
        ran = recommendation.Outcome(elp6, 9, 80.0, 400, 1e-9, 1.0, status=CONVERGED, kept=1e-12)
        search.question = search.question._replace(time=100.0)
        for tolerance, good in ((LOOSE_EXPONENTIAL, False), (ENERGY_BOUNDED, True)):
            search.good, search.trials = {}, [replace(ran, tolerance=tolerance)]
            search.settle()
            self.assertEqual(elp6 in search.good, good)

    def test_seconds_of_an_offer_are_those_of_its_own_steps(self):
        trials, search, rkmk4, trial = self.search()
        search.good, search.end = {rkmk4: trial}, (4.0, "the state at T = 4")
        (before,) = search.ranking()
        self.assertAlmostEqual(before.seconds, before.steps / trial.steps)
        self.assertIn("steps of rkmk4_frame were timed: these seconds are scaled", search.statements[-1])
        calls, timed = [], []

        class Method:
            """Fails at once; later a step takes as much longer as it is shorter."""

            def timed_run(self, W, h, steps, repetitions, warmup):
                calls.append(W)
                timed.append(steps)
                if len(calls) == 1:
                    raise trials.isosyrk.SolverError(1, "diverged", 1.0, W, mock.Mock(sweeps=9))
                return [steps * 1e-5 / h]

        search.method = lambda *_: Method()
        search.time_offers()
        (after,) = search.ranking()
        self.assertLessEqual(after.step, before.step / trial_planner.BELOW_FAILURE)
        self.assertGreater(timed[-1], trials.MIN_STEPS)  # steps as short as these take more of them to be timed
        self.assertAlmostEqual(after.seconds, after.steps * 1e-5 / after.step)
        self.assertEqual(set(calls), {"the state at T = 4"})
        self.assertIn("timed from T = 4 on", search.statements[-1])
        # What was run over the whole time is not timed again.
        search.good = {rkmk4: replace(trial, time=8.0, status=CONVERGED)}
        done = len(calls)
        search.time_offers()
        self.assertEqual((len(calls), search.ranking()[0].seconds), (done, 1.0))

    def test_the_growth_of_a_trial_is_the_power_of_time_that_its_error_follows(self):
        trials, search, rkmk4, _ = self.search()
        W = search.setting.scene.initial
        search.exact, search.uncertainty = (W, W), 1e-7  # how far the reference is off itself
        search.reference = recommendation.Outcome(rkmk4, 9, search.time, 40, 1e-12, 1.0)
        for power in (1, 3):

            def known(method, h, steps, every, look):
                for step in (steps // 2, steps):
                    look(step, (1 + 1e-6 * (step / steps) ** power) * W, SimpleNamespace(seconds=0.0))
                return W, SimpleNamespace(seconds=0.0, steps=steps), CONVERGED, None, 0.0

            with mock.patch.object(search.setting, "run", known):
                trial, _ = search.run(rkmk4, 8)
            self.assertAlmostEqual(trial.growth, power, 5)
            self.assertAlmostEqual(trial.error / 1.1e-6, 1, 5)

    def test_what_cannot_be_used_or_answered(self):
        modes = {"empty": "", "header": "l,m\n1,0\n", "fields": "l,m,re,im\n1,0,1\n", "more": "l,m,re,im\n2,1,1,0,0\n",
                 "number": "l,m,re,im\n2,1,x,0\n", "infinite": "l,m,re,im\n2,1,nan,0\n",
                 "degree": "l,m,re,im\n9,1,1,0\n", "none": "l,m,re,im\n", "underscore": "l,m,re,im\n2,1,1_0,0\n",
                 "space": "l,m,re,im\n2,1,1 0,0\n", "quoted": 'l,m,re,im\n2,1,"1",0\n'}
        trials, *_ = self.search()

        def refused(option, path, *parts, n=9):
            options = SimpleNamespace(**{"modes": None, "state": None, option: path}, own=path, n=n, hbar=None)
            with self.subTest(path=path, parts=parts), self.assertRaises(UnusableFile) as caught:
                trials.scene_of(options)
            self.assert_one_line(f"{caught.exception}\n", f"--{option}", *parts)

        for name, text in modes.items():
            refused("modes", self.write(name, text), name)
        refused("modes", self.path("missing"), "No such file")
        refused("state", self.MODES, "cannot be read", n=None)
        for W, part in ((1j * numpy.eye(9), "at rest"), (1e-200 * self.state(), "energy"), (self.state().T, "C order"),
                        (self.state().imag, "complex128")):
            numpy.save(self.path("W0.npy"), W)
            refused("state", self.path("W0.npy"), part, n=None)
        # As a user meets it.
        self.assert_refused(self.trials("--n", "9", "--modes", self.write("empty", "")), "--modes", "empty")
        self.assert_refused(self.trials("--state", self.MODES), "--state", "cannot be read")
        self.assert_refused(self.trials("--n", "9", "--modes", self.MODES, error=1e-20), "uncertainty")
        result = self.trials("--n", "9", "--modes", self.MODES, budget=1e-3)
        self.assertEqual((result.returncode, result.stdout), (UNANSWERABLE, ""))
        self.assert_one_line(result.stderr, "within the budget")


if __name__ == "__main__":
    unittest.main()
