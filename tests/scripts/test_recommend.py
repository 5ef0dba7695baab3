"""Tests of scripts/recommend on the made-up study of study_documents.py, whose answers are worked out by hand, and of
its pilots on small scenes.

There errors and seconds of a fast form are, with N = 5/h steps from 5 to 200, rk4 1e-2 h⁴ and 1e-4 N; rkmk4 1e-3 h⁴ and
1e-3 N; group2 0.1 h⁴ and 4e-3 N, in the frame 1e-2 h⁴; group1 h² and 1.5e-3 N; cotangent1 h² and 2e-3 N. group1 fails
at h = 1; rk4 at n = 33 is safe up to h = 0.52 only.
"""

import array
import json
import math
import os
import shlex
import shutil
import sys
import time
import unittest
from unittest import mock

from programs import BUILD, DATA, HAS_MODULE, ROOT, FolderTest, read_npy, run, run_script, strict_json
from study_documents import INTEGRATORS, accuracy_of, run_of, study_document, write_study

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
import recommendation  # noqa: E402
from document import as_text  # noqa: E402
from recommendation import MARGIN, MARGIN_OF_N, MARGIN_OF_TIME, BelowReference, Question, Unanswerable  # noqa: E402
from study_file import CONVERGED, STATUSES  # noqa: E402

SCRIPT = os.path.join(ROOT, "scripts", "recommend")
UNANSWERABLE = 3


class RecommendTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.document = study_document()
        without_module = mock.patch.dict(os.environ, {"ISOSYRK_BUILD": self.folder})
        without_module.start()
        self.addCleanup(without_module.stop)

    def recommend(self, *arguments, **options):
        """Runs the script on the document as it is now."""
        raw = write_study(self.folder, self.document)
        if options:
            return run([sys.executable, "-B", SCRIPT, "--raw", raw, *arguments], **options)
        return run_script(SCRIPT, "--raw", raw, *arguments)

    def answer(self, n, error, keep="nothing", time=5.0, scene="smooth", **options):
        return recommendation.answer(accuracy_of(self.document), Question(scene, n, time, error, keep), "raw", **options)

    def steps(self, name, n, error):
        """Returns the steps that are offered with one integrator to T = 5, or None."""
        study, question = accuracy_of(self.document), Question("smooth", n, 5.0, error, "nothing")
        offer = recommendation.offer_of(study, question, recommendation.basis_of(study, question), name)
        return offer and offer.steps

    def add_times(self, growth):
        """Adds the smooth problems to T = 50, with errors so many times as large at the same step."""
        for name in ("references", "runs"):
            rows = [each for each in self.document[name] if each["scene"] == "smooth"]
            self.document[name] += [{**each, "time": 50.0, **({} if name == "references" else {
                "steps": 10 * each["steps"], "error": each["error"] and growth * each["error"],
                "cpu_seconds": [10 * value for value in each["cpu_seconds"]]})} for each in rows]


def steps_for(name, error, time=5.0):
    """Returns the steps of the made-up integrator that have an error at T = 5."""
    _, order, *_, factor, _ = INTEGRATORS[name]
    return math.ceil(time / (error / factor) ** (1 / order))


class Step(RecommendTest):
    def test_it_is_interpolated_for_the_error_over_the_margin(self):
        for name, error in (("rkmk4", 1e-5), ("group2", 3e-4), ("group1", 0.02), ("group2_frame", 1e-7)):
            with self.subTest(name=name):
                self.assertEqual(self.steps(name, 17, error), steps_for(name, error / MARGIN))

    def test_the_cheapest_for_each_structure(self):
        for n, error, structure, expected in (
                (17, 1e-3, "nothing", "rk4"), (17, 1e-3, "spectrum", "rkmk4"), (17, 1e-3, "poisson", "group2_frame"),
                (17, 0.9, "poisson", "cotangent1")):  # group1 fails at h = 1
            with self.subTest(error=error, structure=structure):
                self.assertEqual(self.answer(n, error, structure).offers[0].integrator.name, expected)

    def test_the_longest_safe_run_where_it_is_better_than_the_error(self):
        self.assertEqual(self.steps("rkmk4", 17, 0.5), 5)

    def test_no_step_beyond_what_trials_allow(self):
        self.assertEqual(self.steps("rk4", 33, 0.01), 10)
        for each in self.document["limits"]:
            each["h_norm_B"] = 100.0
        for each in self.document["runs"]:
            each["beyond_limit"] = False
        self.assertEqual(self.steps("rk4", 33, 0.01), steps_for("rk4", 0.01 / MARGIN))

    def test_no_method_that_failed_its_first_trial(self):
        limit = next(each for each in self.document["limits"] if (each["integrator"], each["n"]) == ("rkmk4", 17))
        limit["h_norm_B"] = None
        self.assertIsNone(self.steps("rkmk4", 17, 1e-3))

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
        self.assertEqual(found.offers[0].steps, steps_for("rkmk4", 1e-4 / MARGIN / MARGIN_OF_N))
        self.assertIn("n = 24 is not recorded", found.statements[0])
        self.assertEqual({each["n"] for each in found.offers[0].evidence}, {17, 33})
        self.assertEqual(self.answer(17, 1e-4).statements, [])

    def test_a_limit_holds_between_too(self):
        # The lesser limit over ‖B‖₂ at n = 24, from h = 1 at n = 17 and 0.5 at n = 33.
        norm = 1.4 * 24 / 17
        self.assertGreaterEqual(self.steps("rk4", 24, 0.5), 5 * norm / 1.4142)

    def test_time_is_interpolated_and_that_is_said(self):
        self.add_times(growth=10)
        for wanted, growth in ((50, 10), (20, 4), (2, 0.4)):
            with self.subTest(time=wanted):
                margin = MARGIN if wanted == 50 else MARGIN * MARGIN_OF_TIME
                found = self.answer(17, 1e-4, "spectrum", time=float(wanted))
                self.assertEqual(found.offers[0].steps, steps_for("rkmk4", 1e-4 / margin / growth, wanted))
                self.assertAlmostEqual(found.offers[0].seconds, 1e-3 * found.offers[0].steps)
                self.assertEqual(len(found.statements), wanted != 50)

    def test_beyond_predictability_energy_and_spectrum_are_judged(self):
        for each in self.document["runs"]:
            if each["integrator"] == "rkmk4" and each["status"] == CONVERGED:
                each["energy_error"] = 1e-3 * each["step"]**4
        found = self.answer(17, 1e-3, "nothing", time=25.0)
        offers = {offer.integrator.name: offer.steps for offer in found.offers}
        # The error of energy grows as the square of time.
        self.assertEqual(offers["rkmk4"], steps_for("rkmk4", 1e-3 / MARGIN / 25, 25))
        self.assertEqual(offers["group2"], 25)
        self.assertNotIn("rk4", offers)
        self.assertEqual(found.judged, "energy and spectrum")
        self.assertIn("beyond predictability", found.statements[0])

    def test_a_reference_that_is_no_reference_tells_no_trajectory(self):
        self.document["references"][0]["uncertainty"] = 0.1
        self.assertEqual(self.answer(17, 1e-3).judged, "energy and spectrum")


class Answers(RecommendTest):
    def test_seconds_are_told_for_this_machine(self):
        rate = 2e9 / 17**3
        for here, factor in ((2 * rate, 0.5), (None, 1.0)):
            data = recommendation.answer_data(self.answer(17, 1e-3, "spectrum", rate_here=lambda n: here))
            self.assertAlmostEqual(data["seconds"], factor * 1e-3 * data["steps"])
            self.assertAlmostEqual(data["seconds_recorded"], 1e-3 * data["steps"])

    def test_json(self):
        found = strict_json(self.recommend("--n", "17", "--time", "5", "--error", "1e-3", "--json").stdout)
        self.assertEqual([found[name] for name in ("integrator", "solver", "steps", "step", "keeps")],
                         ["rk4", "fast", 10, 0.5, "nothing"])
        self.assertLessEqual(found["expected_error"], 1e-3)
        self.assertIn("--n 17 --scene smooth --integrator rk4 --solver fast --step 0.5 --time 5.0", found["command"])
        self.assertEqual(sorted(each["steps"] for each in found["evidence"]), [5, 10])
        self.assertEqual([each["integrator"] for each in found["runners_up"]],
                         ["rkmk4", "group2_frame", "group2", "group1"])
        self.assertEqual(found["source"]["commit"], "0123456789ab")

    def test_text(self):
        result = self.recommend("--n", "24", "--time", "5", "--error", "1e-3", env={"LC_ALL": "C"})
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for part in ("- method: rk4, order 4, keeps nothing", "- solver: fast", "Note: n = 24 is not recorded", "Runners-up"):
            self.assertIn(part, result.stdout)
        self.assertIn("integrate --n 24 --scene smooth --integrator rk4", result.stdout.splitlines()[-1])

    def test_the_developed_scene_says_how_its_state_is_made(self):
        for name in ("references", "runs", "limits", "tolerance_runs"):
            self.document[name] = [{**each, "scene": "developed"} for each in self.document[name]
                                   if each["scene"] == "smooth"]
        found = self.answer(17, 1e-3, scene="developed")
        self.assertIn("--initial developed_n17.npy", recommendation.command(found, found.offers[0]))
        self.assertIn("--output developed_n17.npy", found.statements[0])

    def test_a_table_for_each_structure_with_rows_by_problem(self):
        text = as_text(recommendation.recommendation_tables(accuracy_of(self.document)))
        self.assertEqual(text.count("\nsmooth  "), 6)
        self.assertEqual(text.count("\nrough  "), 3)
        self.assertIn("rk4, h = 0.5, 0.00100 s", text)


class Unanswered(RecommendTest):
    def test_what_no_recorded_run_answers(self):
        for options, *words in (
                ({"--error": "1e-12"}, "1e-12", "the best there is has 3.91e-10, by rkmk4 with h = 0.025"),
                ({"--error": "1e-12", "--keep": "poisson"}, "that keeps the Lie–Poisson", "by group2_frame with"),
                ({"--n": "16"}, "n = 16", "n = 17, 33 to T = 5"), ({"--n": "34"}, "n = 34"),
                ({"--scene": "developed"}, "developed (nothing)")):
            with self.subTest(options=options):
                question = {"--n": "17", "--time": "5", "--error": "1", **options}
                result = self.recommend(*(word for pair in question.items() for word in pair))
                self.assertEqual((result.returncode, result.stdout), (UNANSWERABLE, ""), result.stderr)
                self.assert_one_line(result.stderr, *words)

    def test_an_error_below_the_uncertainty_of_the_reference(self):
        self.assert_refused(self.recommend("--n", "17", "--time", "5", "--error", "9e-15"), "uncertainty", "1e-14")
        with self.assertRaises(Unanswerable):
            self.answer(17, 1.1e-14)  # it could be told, but no run has it
        with self.assertRaises(BelowReference):
            self.answer(17, 9e-13, scene="rough")


class Refusals(RecommendTest):
    def test_bad_arguments(self):
        question = ("--n", "17", "--time", "5", "--error", "1")
        for arguments, *parts in (
                *(((*question, "--n", value), "--n", f"'{value}'", "a whole number from 2 to 4096")
                  for value in ("1", "-17", "17.0", "4097", "")),
                *(((*question, name, value), name, f"'{value}'", "above 0") for name in ("--error", "--time", "--budget")
                  for value in ("0", "-1e-6", "nan", "1e999", "x", "")),
                (question[2:], "--n"), (question[:4], "--error"), (question[:2] + question[4:], "--time"),
                ((*question, "--keep", "energy"), "--keep", "'energy'", "nothing", "spectrum", "poisson"),
                ((*question, "--scene", "calm"), "--scene", "'calm'", "smooth", "rough", "developed"),
                ((*question, "--scene", "rough", "--state", "W.npy"), "--scene, --modes, --state", "one of them"),
                ((*question, "--modes", "m.csv"), "--raw"), ((*question, "--budget", "5"), "--budget", "--modes"),
                ((*question, "17"), "17"), ((*question, "--err", "1"), "--err"), ((*question, "two\nlines"), "two")):
            with self.subTest(arguments=arguments):
                self.assert_refused(self.recommend(*arguments), *parts)

    def test_files_that_cannot_be_used(self):
        for raw, *parts in ((self.path("two\nlines.json"), "two lines.json", "No such file"),
                            (self.write("foreign.json", '{"benchmarks": []}'), "recommend: ", "foreign.json: ")):
            self.assert_refused(run_script(SCRIPT, "--n", "17", "--time", "5", "--error", "1", "--raw", raw), *parts)

    def test_the_recorded_run_is_the_default(self):
        # In a copy of scripts/, so that whatever is recorded in this tree does not matter.
        shutil.copytree(os.path.join(ROOT, "scripts"), self.path("scripts"))
        script = [self.path("scripts", "recommend"), "--n", "17", "--time", "5", "--error", "1e-3"]
        self.assert_refused(run(script), os.path.join("results", "recorded", "accuracy", "raw.json"))
        recorded = self.path("results", "recorded", "accuracy")
        os.makedirs(recorded)
        write_study(recorded, self.document)
        self.assertIn("method: rk4", run(script).stdout)

    def test_output_that_is_closed_or_full(self):
        question = ("--n", "17", "--time", "5", "--error", "1")
        reader, writer = os.pipe()
        os.close(reader)
        result = self.recommend(*question, stdout=writer)
        os.close(writer)
        self.assertEqual((result.returncode, result.stderr), (1, ""))  # its reader has seen enough
        with open("/dev/full", "wb") as full:
            result = self.recommend(*question, stdout=full)
        self.assertEqual(result.returncode, 2)
        self.assert_one_line(result.stderr, "recommend: standard output: cannot be written")


@unittest.skipUnless(HAS_MODULE, "the module is not built")
class Pilots(FolderTest):
    MODES = os.path.join(DATA, "initial_modes.csv")

    def pilots(self, *arguments, budget=5):
        return run([sys.executable, "-B", SCRIPT, "--time", "4", "--budget", str(budget), *arguments])

    def executed(self, line, *more):
        """Runs an integrate line and returns its last state as one list."""
        output = self.path("W.npy")
        result = run([*shlex.split(line), *more, "--output", output])
        self.assertEqual(result.returncode, 0, result.stderr)
        return [entry for row in read_npy(output) for entry in row]

    def reference(self, *scene):
        return self.executed(f"{BUILD}/benchmarks/integrate --integrator group5 --solver fast --step 0.1 --time 4", *scene)

    def check(self, found, error, *scene):
        exact, W = self.reference(*scene), self.executed(found["command"])
        wrong = math.sqrt(sum(abs(a - b)**2 for a, b in zip(W, exact)) / sum(abs(b)**2 for b in exact))
        self.assertLessEqual(wrong, error)
        # The run that was measured, to rounding, with the uncertainty of its reference.
        self.assertLessEqual(wrong, 1.01 * found["expected_error"])

    def test_the_line_that_is_printed_has_the_error(self):
        for keep, error in (("nothing", 1e-4), ("poisson", 1e-7)):
            with self.subTest(keep=keep):
                result = self.pilots("--n", "13", "--modes", self.MODES, "--keep", keep, "--error", str(error), "--json")
                self.assertEqual(result.returncode, 0, result.stderr)
                found = strict_json(result.stdout)
                self.assertEqual((found["evidence"][0]["status"], found["solver"]), (CONVERGED, "fast"))
                self.assertLessEqual(found["expected_error"], error)
                self.check(found, error, "--n", "13", "--modes", self.MODES)

    def test_a_state_of_another_norm(self):
        run([os.path.join(BUILD, "benchmarks", "integrate"), "--n", "9", "--integrator", "rk4", "--step", "1", "--time", "0",
             "--output", self.path("W0.npy")])
        with open(self.path("W0.npy"), "rb") as stream:
            contents = stream.read()
        header, entries = contents[:-9 * 9 * 16], array.array("d", contents[-9 * 9 * 16:])
        with open(self.path("W0.npy"), "wb") as stream:
            stream.write(header + array.array("d", (0.125 * value for value in entries)).tobytes())
        result = self.pilots("--state", self.path("W0.npy"), "--error", "1e-6", "--keep", "spectrum", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = strict_json(result.stdout)
        self.assertIn("--tolerance", found["command"])  # of the iteration: it is absolute
        self.check(found, 1e-6, "--n", "9", "--initial", self.path("W0.npy"), "--tolerance", "1e-14")
        with open(self.path("W0.npy"), "r+b") as stream:  # no longer skew-Hermitian
            stream.seek(len(header) + 16)
            stream.write(b"\0" * 16)
        self.assert_refused(self.pilots("--state", self.path("W0.npy"), "--error", "1e-6"), "--state", "skew")
        self.assert_refused(self.pilots("--state", self.path("W0.npy"), "--n", "10", "--error", "1e-6"), "(9, 9), must be (10, 10)")

    def test_a_scene_that_takes_too_long_is_answered_within_the_budget(self):
        started = time.monotonic()
        result = self.pilots("--n", "65", "--modes", self.MODES, "--time", "400", "--error", "1e-6", "--json", budget=2)
        self.assertLess(time.monotonic() - started, 2.4 + 1)  # and the start of two Pythons
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("extrapolated", json.dumps(strict_json(result.stdout)["statements"]))

    def test_what_cannot_be_used_or_answered(self):
        question = ("--n", "9", "--error", "1e-6", "--modes")
        modes = {"empty": "", "header": "l,m\n1,0\n", "fields": "l,m,re,im\n1,0,1\n", "number": "l,m,re,im\n2,1,x,0\n",
                 "infinite": "l,m,re,im\n2,1,nan,0\n", "degree": "l,m,re,im\n9,1,1,0\n", "none": "l,m,re,im\n"}
        for name, text in modes.items():
            with self.subTest(name=name):
                self.assert_refused(self.pilots(*question, self.write(name, text)), "--modes", name)
        self.assert_refused(self.pilots(*question, self.path("missing")), "--modes", "No such file")
        self.assert_refused(self.pilots("--state", self.MODES, "--error", "1"), "--state", "cannot be read")
        self.assert_refused(self.pilots("--n", "9", "--modes", self.MODES, "--error", "1e-20"), "uncertainty")
        result = self.pilots("--n", "9", "--modes", self.MODES, "--error", "1e-6", budget=1e-3)
        self.assertEqual((result.returncode, result.stdout), (UNANSWERABLE, ""))
        self.assert_one_line(result.stderr, "within the budget")


if __name__ == "__main__":
    unittest.main()
