"""The study practice: its plan, how the fewest steps and times come about, what is judged, and quflow's own step.

QUFLOW in the environment is a checkout of quflow; without it what needs quflow itself is skipped.
"""

import os
import subprocess
import sys
import time
import unittest
from types import SimpleNamespace
from unittest import mock

import practice_documents as documents
from programs import BUILD, DONE, HAS_MODULE, MEASURE, PATIENCE, RENDER, FolderTest, environment, run, text_of

import drawing
from lib.pages.document import as_markdown
from lib.programs.command_line import Stop
from lib.records.findings import FILE, as_json
from lib.records.formats import listed
from studies.practice.judge import cheapest, figures, findings
from studies.practice.lookup import recorded_runs
from studies.practice.schema import read_practice

QUFLOW = os.environ.get("QUFLOW")
if HAS_MODULE:
    sys.path.insert(0, os.path.join(BUILD, "python"))
    import isosyrk
    import numpy
    from studies.practice import plan, quflow_step, report, single_runs, timing
    from studies.practice import run as study_run

KEY = ("rough", 33)
RK8 = {"role": "method", "integrator": "rk8_frame", "tolerance": 1e-13, "steps": 600, "products": 7200.0}


class Judged(FolderTest):
    def study(self, **changes):
        return read_practice(documents.write_practice(self.path("raw.json"), **changes))

    def test_the_cheapest_of_each_group_and_its_gains(self):
        found = findings(self.study())
        leaders = {(each.wanted, each.group): (each.integrator, each.tolerance) for each in found.leaders}
        self.assertEqual(leaders["tenth", "best"], ("rk8_frame", 1e-13))
        self.assertEqual(leaders["tenth", "spectrum"], ("elp4_frame", 1e-8))
        self.assertEqual(leaders["tenth", "poisson"], ("elp4_frame", 1e-13))
        self.assertEqual(leaders["tenth", "gauss"], ("group2_frame", 1e-13))
        self.assertEqual({group for wanted, group in leaders if wanted == "same"},
                         {"best", "spectrum", "poisson", "explicit", "exponential", "gauss"})
        told = figures(found)
        for key, value in {"tenth.best.seconds": 0.5, "tenth.best.step_over_practice": 130 / 8,
                           "tenth.best.gain_over_practice": 20,
                           "tenth.best.gain_over_quflow": 100, "same.best.gain_over_quflow": 200,
                           "practice.seconds": 10, "quflow.capped": 3, "practice.gain_over_quflow": 5,
                           "tenth.elp4_frame.gain_over_practice": 10,
                           "tenth.elp4_frame_bounded.gain_over_practice": 5, "tenth.poisson.steps": 8,
                           "threads.elp4_frame.p2.gain": 1 / 0.6, "threads.elp4_frame.p1.seconds": 1}.items():
            self.assertLess(abs(told[f"rough.n33.{key}"] / value - 1), 0.01, key)
        # Rows of one process have one noise: ratios have none, and their interval no width.
        self.assertAlmostEqual(told["rough.n33.tenth.best.gain_over_quflow_low"], 100)
        self.assertNotIn("rough.n33.tenth.rk5_frame.seconds", told)  # which does not reach it
        self.assertIn("rough.n33.same.rk5_frame.seconds", told)

    def test_scaled_steps_are_those_of_methods(self):
        told = figures(findings(self.study()))
        self.assertEqual(told["rough.n33.tenth.rk8_frame.scaled_step"], 2.0 / 8 * 8.0)  # h‖ad_B‖₂
        self.assertNotIn("rough.n33.practice.scaled_step", told)

    def test_what_was_recorded_of_a_scene_is_told_in_a_line(self):
        path = self.write(FILE, as_json("practice", findings(self.study())))
        self.assertEqual(recorded_runs("rough", 33, "nothing", path),
                         "the study practice recorded, at n = 33 to T = 2: rk8_frame (tolerance 1e-13, h = 0.4) an"
                         " error of 1.0e-03 for 0.25 s a unit of time, rk8_frame (tolerance 1e-13, h = 0.25) an error"
                         " of 1.0e-04 for 0.5 s a unit of time")
        self.assertIn("elp4_frame (tolerance 1e-13, h = 0.25)", recorded_runs("rough", 33, "poisson", path))
        self.assertIsNone(recorded_runs("rough", 65, "nothing", path))
        self.assertIsNone(recorded_runs("smooth", 33, "nothing", path))

    def test_one_process_decides_nothing(self):
        runs = documents.rows(noise=(1.0,))
        found = findings(self.study(runs=runs, by_threads=documents.threads(noise=(1.0,))))
        self.assertTrue(found.results)
        for each in found.results:
            self.assertIsNone(each.gain_over_quflow_low)
            self.assertIsNone(each.gain_over_practice_high)
        self.assertNotIn("rough.n33.tenth.best.gain_over_quflow_low", figures(found))

    def test_a_slow_process_widens_the_interval(self):  # the control of intervals
        runs = documents.rows()
        place = next(place for place, each in enumerate(runs) if each.role == "quflow")
        runs[place] = runs[place]._replace(cpu_seconds=[*runs[place].cpu_seconds[:-1], 150.0])
        told = figures(findings(self.study(runs=runs)))
        self.assertLess(told["rough.n33.tenth.best.gain_over_quflow_low"],
                        0.95 * told["rough.n33.tenth.best.gain_over_quflow"])

    def test_without_quflow_there_is_a_report_that_says_so(self):
        settings = documents.SETTINGS._replace(quflow=None)
        path = documents.write_practice(self.path("raw.json"), runs=documents.rows(quflow=False), settings=settings)
        for where, said in ((path, True), (documents.write_practice(self.path("with.json")), False)):
            done = run([drawing.PYTHON, "-B", RENDER, "practice", where], timeout=PATIENCE,
                       env=environment(MPLCONFIGDIR=self.path("matplotlib")))
            self.assertEqual((done.returncode, done.stderr), (DONE, ""))
            self.assertEqual("quflow's own step was not run" in done.stdout, said)
            self.assertEqual("and quflow 100 times" in done.stdout, not said)
            self.assertEqual("(of quflow's step, which takes longest, up to n = 129)" in done.stdout, not said)

    def test_the_chart_has_a_panel_a_scene_with_two_n(self):
        problems = [documents.problem(n, scene) for n, scene in ((33, "rough"), (65, "rough"), (33, "smooth"))]
        runs = [each for found in problems for each in documents.rows(found.n, scene=found.scene)]
        path = documents.write_practice(self.path("raw.json"), problems, runs)
        done = run([drawing.PYTHON, "-B", RENDER, "practice", path, "--out", self.path("out")], timeout=PATIENCE,
                   env=environment(MPLCONFIGDIR=self.path("matplotlib")))
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        chart, words = text_of(self.path("out", "time_against_n.svg")), text_of(self.path("out", "report.md"))
        for label in ("practice", "quflow", "Gauss", "exponential", "explicit", "rough scene"):
            self.assertIn(f">{label}<", chart)
        self.assertNotIn("smooth scene", chart)  # of one n
        self.assertNotIn(">Magnus<", chart)  # of which there is none
        self.assertIn("(time_against_n.svg)", words)
        self.assertIn("not reached", words)

    @unittest.skipUnless(HAS_MODULE, "the module is not built")
    def test_no_method_reaches_a_tenth(self):
        runs = [each for each in documents.rows() if each.role != "method"]
        study = self.study(runs=runs, by_threads=[])
        found = findings(study)
        self.assertEqual((found.leaders, cheapest(study, KEY, "tenth", "best")), ([], None))
        words = as_markdown(report.sections(study, found, set()))
        self.assertIn("No method reaches a tenth", words)
        self.assertIn("Nothing was timed by threads", words)


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class Plan(unittest.TestCase):
    def test_problems_are_those_of_the_issue(self):
        found = [(each["scene"], each["n"], each["time"]) for each in plan.problems_of(plan.SIZES, plan.SCENE_SIZES)]
        self.assertEqual(found, [(scene, n, time) for n, time, scenes in (
            (129, 2.0, ("smooth", "rough", "turbulence")), (257, 2.0, ("smooth", "rough", "turbulence")),
            (513, 0.5, ("rough", "turbulence")), (1025, 0.25, ("rough",))) for scene in scenes])
        for sizes, scenes, words in (((9,), ("rough",), "at least 11"), ((513,), ("smooth",), "no problem")):
            with self.assertRaisesRegex(Stop, words):
                plan.problems_of(sizes, scenes)

    def test_the_practice_takes_a_quarter_of_hbar(self):
        steps = plan.practice_steps({"n": 257, "time": 2.0})
        hbar = 2 / (257 * 256) ** 0.5
        self.assertTrue(2.0 / steps <= hbar / 4 < 2.0 / (steps - 1))

    def test_methods_run_in_the_frame_where_it_helps(self):
        for in_frame in (True, False):
            found = plan.methods_of(257, in_frame)
            self.assertEqual([each.method for each in found], list(plan.METHODS))
            self.assertEqual({each.co_rotating for each in found}, {in_frame})
        self.assertEqual([each.method for each in plan.methods_of(1025, True)], list(plan.LARGE_METHODS))
        self.assertEqual([each.name for each in plan.methods_of(33, True, ["rk4"])], ["rk4_frame"])
        self.assertEqual(plan.reference_methods(True), ["rk8_frame", "magnus5_frame"])

    def test_tolerances_are_those_that_an_error_needs(self):
        for name, error, n, expected in (
                ("elp4", 1e-4, 257, [1e-8, 1e-13]), ("elp4", 3e-7, 257, [1e-9, 1e-13]), ("elp4", 1e-4, 1025, [1e-8]),
                ("group2", 1e-4, 257, [1e-7, 1e-13]), ("rk8", 1e-4, 257, [1e-13]), ("magnus5", 1e-8, 257, [1e-10]),
                ("elp4", 1e-12, 257, [1e-13])):
            found = [each.tolerance for each in plan.forms_of(listed(name), error, n)]
            self.assertEqual(found, expected, (name, error))

    def test_what_is_timed_of_a_run_is_bounded(self):
        for n, steps, work, explicit, expected in (
                (513, 513, 900.0, False, (26, 20)),  # the practice
                (513, 6, 72.0, True, (0, 2)), (1025, 6, 72.0, True, (0, 1)), (1025, 8, 800.0, False, (1, 1)),
                (513, 1, 12.0, False, (1, 1))):
            self.assertEqual(plan.part_of(n, steps, work, explicit), expected)


class Rows(unittest.TestCase):
    """Which rows a process times, and whose time is scaled from another's."""

    def rows(self):
        shared = {"role": "method", "integrator": "rk8_frame", "tolerance": 1e-13}
        return [{"role": "practice", "wanted": "same", "integrator": "algebra1", "tolerance": 1e-8, "steps": 130,
                 "products": 200.0},
                {**shared, "wanted": "same", "steps": 4, "products": 48.0},
                {**shared, "wanted": "tenth", "steps": 6, "products": 72.0},
                {**shared, "integrator": "rk5_frame", "wanted": "tenth"}]

    @unittest.skipUnless(HAS_MODULE, "the module is not built")
    def test_whole_runs_at_small_n_and_the_finer_one_at_large_n(self):
        rows = self.rows()
        for n, count in ((257, 3), (513, 2)):
            block = timing.cpu_block({"scene": "rough", "n": n, "time": 0.5}, rows)
            self.assertEqual(len(block["rows"]), count)
            found = {name: [float(block["runs"][name]["steps"])] for name in block["rows"]}
            coarse = 4.0 if n == 257 else 6.0 * 48 / 72
            self.assertEqual(timing.seconds_by_row(rows, found), [[130.0], [coarse], [6.0], []])
        # A method that reaches the practice's error alone is timed there.
        alone = timing.cpu_block({"scene": "rough", "n": 513, "time": 0.5}, rows[:2])
        self.assertEqual(len(alone["rows"]), 2)


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class Runs(FolderTest):
    def job(self, scene="rough", n=17, time=0.5):
        return {"scene": scene, "n": n, "time": time, "folder": self.folder}

    def prepared(self, **job):
        """Returns a job with initial data, practice and reference."""
        job = self.job(**job)
        single_runs.begin(job)
        found = single_runs.practise(job)
        for name, what in zip(plan.reference_methods(found["in_frame"]), ("reference", "second_reference")):
            single_runs.solve({**job, "integrator": name, "what": what})
        return job

    def test_two_references_agree_far_below_the_smallest_wanted_error(self):
        job = self.prepared()
        error, errors = single_runs.errors_of(job)
        both = [single_runs.load(job, what) for what in ("reference", "second_reference")]
        self.assertTrue(0 < isosyrk.relative_error(*both) < plan.MAX_DIFFERENCE * error)
        self.assertEqual(errors, {"same": error, "tenth": error / 10})
        # A third kind of method, whose error is known to be small.
        scene = isosyrk.scene("rough", n=17)
        W, _ = isosyrk.integrator(scene, "group4", solver="fast").run(scene.initial, 0.01, 50)
        self.assertLess(isosyrk.relative_error(W, both[0]), 1e-3 * error)

    def test_the_fewest_steps_reach_the_error_and_one_less_does_not(self):
        job = self.prepared(time=2.0)
        _, errors = single_runs.errors_of(job)
        rows = single_runs.find({**job, "integrator": "rk4_frame", "tolerances": [1e-13], "errors": errors})
        self.assertEqual([row["wanted"] for row in rows], ["same", "tenth"])
        setting = single_runs.Setting(job)
        method = setting.method("rk4_frame", 1e-13)
        for row in rows:
            at, before = (setting.look_with_error(method, row["steps"] - less) for less in (0, 1))
            self.assertLessEqual(at.error, errors[row["wanted"]])
            self.assertGreater(before.error, errors[row["wanted"]])
            self.assertAlmostEqual(row["error"] / at.error, 1, 3)

    def test_an_error_that_no_steps_reach_is_told(self):
        job = self.prepared()
        rows = single_runs.find({**job, "integrator": "elp4_frame", "tolerances": [1e-4], "errors": {"tenth": 1e-11}})
        self.assertEqual(rows, [{"role": "method", "wanted": "tenth", "integrator": "elp4_frame", "tolerance": 1e-4}])

    def test_a_second_tolerance_begins_with_the_steps_of_the_first(self):
        job, tried = self.prepared(), []
        look = single_runs.Setting.look_with_error

        def counted(setting, method, steps):
            tried.append((method._options["tolerance"], steps))
            return look(setting, method, steps)

        with mock.patch.object(single_runs.Setting, "look_with_error", counted):
            rows = single_runs.find({**job, "integrator": "elp4_frame", "tolerances": [1e-8, 1e-13],
                                     "errors": {"tenth": 1e-6}})
        self.assertEqual(*(row["steps"] for row in rows))
        self.assertEqual([steps for tolerance, steps in tried if tolerance == 1e-13], [rows[0]["steps"]])

    def test_turbulence_is_developed_until_its_tail_is_filled(self):
        found = single_runs.begin(self.job("turbulence"))
        self.assertTrue(plan.TAIL_SHARE <= found["tail"] < 0.5)
        W = single_runs.load(self.job("turbulence"), "initial")
        self.assertGreater(found["developed"], 0)
        self.assertLess(abs(numpy.linalg.norm(W, 2) - 1), 0.01)
        self.assertEqual(found["states"]["initial"], single_runs.hash_of(W))
        # Control: what is drawn has no tail.
        with mock.patch.object(plan, "MAX_DEVELOPING", 0.5):
            self.assertLess(single_runs.begin(self.job("turbulence", n=33))["tail"], 1e-6)

    def test_turbulence_that_diverges_ends_the_study(self):
        with mock.patch.multiple(plan, MAX_DEVELOPING_STEP=1e4, DEVELOPING_STEP_BY_N=1e9, TAIL_LOOK=1e4,
                                 MAX_DEVELOPING=4e4):
            with self.assertRaisesRegex(Stop, "turbulence at n = 17 did not develop: diverged"):
                single_runs.begin(self.job("turbulence"))

    def test_states_that_are_gone_or_changed_are_told(self):
        job = self.job()
        states = single_runs.begin(job)["states"]
        self.assertTrue(single_runs.is_kept(job, states))
        path = single_runs.state_path(job, "initial")
        numpy.save(path, 2 * numpy.load(path))
        self.assertFalse(single_runs.is_kept(job, states))
        self.write(os.path.basename(path), "no array")
        self.assertFalse(single_runs.is_kept(job, states))
        os.unlink(path)
        self.assertFalse(single_runs.is_kept(job, states))

    def test_a_practice_that_does_not_converge_ends_the_study(self):
        single_runs.begin(self.job())
        with mock.patch.object(plan, "practice_steps", lambda job: 1):
            with self.assertRaisesRegex(Stop, "the practice of the rough scene at n = 17: "):
                single_runs.practise(self.job(time=1e3))

    def test_references_that_differ_too_much_end_the_study(self):
        job = self.job()

        def results(jobs, work, what):
            found = [work(each) for each in jobs]
            if what == "references":
                W = single_runs.load(job, "reference")
                found[0]["states"]["reference"] = single_runs.save(job, "reference", W * (1 + 1e-2))
            return found

        with self.assertRaisesRegex(Stop, "references of the rough scene at n = 17 differ"):
            list(study_run.prepared([job], results))

    def test_some_steps_at_places_of_a_run_give_the_time_of_the_whole(self):
        with mock.patch.object(plan, "LARGEST_WHOLE", 16), mock.patch.object(plan, "LARGEST_WHOLE_QUFLOW", 16):
            job = self.prepared(time=2.0)
            self.assertTrue(os.path.exists(single_runs.state_path(job, "reference_place2")))
            block = {**job, "kind": timing.CPU, "process": 0, "rows": ["a"], "runs": {"a": RK8}}
            parts = [timing.time_block({**block, "process": process})[0] for process in range(plan.PLACES)]
            os.unlink(single_runs.state_path(job, "reference_place2"))
            with self.assertRaises(FileNotFoundError):  # the control: each process has a place
                timing.time_block({**block, "process": 2})
        (whole,) = timing.time_block(block)
        for part in parts:
            self.assertTrue(0.3 < part / whole < 3, (parts, whole))

    def test_the_time_that_passes_is_a_part_of_the_time_that_passed(self):
        block = {**self.prepared(time=2.0), "kind": timing.PASSED, "process": 0, "rows": ["a"],
                 "runs": {"a": {**RK8, "threads": 1}}}
        begun = time.perf_counter()
        (seconds,) = timing.time_block(block)
        self.assertTrue(0 < seconds < time.perf_counter() - begun, seconds)

    def test_from_where_its_runs_take_long_quflow_is_timed_in_parts_and_methods_as_a_whole(self):
        with mock.patch.object(plan, "LARGEST_WHOLE_QUFLOW", 16):
            job = self.prepared(time=2.0)
        runs = {"quflow": {"role": "quflow", "integrator": "algebra1", "tolerance": 1e-8, "steps": 600,
                           "products": 2400.0},
                "rk8": {"role": "method", "integrator": "rk8", "tolerance": 1e-13, "steps": 30, "products": 360.0}}
        block = {**job, "kind": timing.CPU, "process": 1, "rows": list(runs), "runs": runs, "quflow": "folder"}
        told = []

        def seconds_of(_folder, W, h, steps, warmup=0):
            told.append((single_runs.hash_of(W), steps, warmup))
            return 0.5 * steps

        begun, after_a_third = (single_runs.hash_of(single_runs.load(job, what))
                                for what in ("initial", "reference_place1"))
        with mock.patch.object(quflow_step, "seconds_of", seconds_of), \
                mock.patch.object(timing, "time_part", wraps=timing.time_part) as parts:
            for largest, expected in ((16, (after_a_third, 20, 32)), (17, (begun, 600, 0))):
                with mock.patch.object(plan, "LARGEST_WHOLE_QUFLOW", largest):
                    self.assertEqual(timing.time_block(block)[0], 300)
                self.assertEqual(told.pop(), expected)
        self.assertEqual([call.args[2]["role"] for call in parts.call_args_list], ["quflow"])

    def test_work_that_was_lost_with_its_states_is_done_again_after_an_interruption(self):
        raw = self.path("raw.json")
        arguments = [sys.executable, "-B", MEASURE, "practice", "--quick", "--n", "17", "--scene", "rough",
                     "--integrator", "rk8", "--out", raw]
        surroundings = environment(ISOSYRK_BUILD=BUILD, QUFLOW=None)
        begun = subprocess.Popen(arguments, env=surroundings, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL,
                                 encoding="utf-8")
        checkpoint = f"{raw}.checkpoint"
        while begun.poll() is None and not (os.path.exists(checkpoint) and "references" in text_of(checkpoint)):
            pass
        begun.terminate()
        said = begun.communicate(timeout=PATIENCE)[1]
        self.assertEqual(begun.returncode, 143, said)
        self.assertFalse(os.path.exists(raw))
        os.unlink(os.path.join(f"{raw}.states", "rough_n17_initial.npy"))
        done = run(arguments, env=surroundings, timeout=PATIENCE)
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertIn("going on after", done.stderr)
        self.assertEqual(os.listdir(self.folder), ["raw.json"])
        self.assertIsNone(read_practice(raw).settings.quflow)


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class QuflowNamed(FolderTest):
    """What QUFLOW may name."""

    def told(self, folder):
        with mock.patch.dict(os.environ, QUFLOW=folder):
            return quflow_step.checkout()

    def test_nothing_and_what_is_no_checkout(self):
        self.assertEqual(self.told(""), (None, None))
        with self.assertRaisesRegex(Stop, "QUFLOW .*: is no checkout of quflow"):
            self.told(self.folder)
        self.write(quflow_step.WHERE, "")
        with mock.patch.object(quflow_step, "NEEDS", ("no_such_module",)):
            with self.assertRaisesRegex(Stop, "needs no_such_module; install python3-no_such_module"):
                self.told(self.folder)
        with mock.patch.object(quflow_step, "NEEDS", ()), mock.patch.dict(os.environ, GIT_CEILING_DIRECTORIES="/"):
            with mock.patch.object(subprocess, "run", lambda *_, **__: SimpleNamespace(returncode=128, stdout="")):
                with self.assertRaisesRegex(Stop, "git does not tell its commit"):
                    self.told(self.folder)

    def test_it_is_refused_in_one_line_before_any_work(self):
        done = run([sys.executable, "-B", MEASURE, "practice", "--quick", "--out", self.path("raw.json")],
                   env=environment(ISOSYRK_BUILD=BUILD, QUFLOW=self.folder))
        self.assert_refused(done, "QUFLOW", "is no checkout of quflow")
        self.assertEqual(os.listdir(self.folder), [])


@unittest.skipUnless(QUFLOW and HAS_MODULE, "QUFLOW names no checkout of quflow")
class QuflowItself(unittest.TestCase):
    def test_its_step_is_ours_with_the_hbar_of_the_paper(self):
        folder, commit = quflow_step.checkout()
        self.assertTrue(commit)
        scene = isosyrk.scene("rough", n=33)
        h, steps = 0.25 * 2 / (33 * 32) ** 0.5, 8
        ours, _ = isosyrk.integrator(scene, "algebra1", solver="fast").run(scene.initial, h, steps)
        found, stats = quflow_step.run(folder, scene.initial, h, steps)
        self.assertLess(isosyrk.relative_error(found, ours), 1e-6)
        self.assertEqual(stats["number_of_maxit"], 0)
        # Controls: a step that is longer by what the two ħ differ, and so many iterations that it is capped.
        other, _ = quflow_step.run(folder, scene.initial, h * 34**0.5 / 33**0.5, steps)
        self.assertGreater(isosyrk.relative_error(other, ours), 1e-4)
        _, stats = quflow_step.run(folder, scene.initial, 10 * h, 1)
        self.assertGreater(stats["number_of_maxit"], 0)
        self.assertGreater(quflow_step.seconds_of(folder, scene.initial, h, 4, 2), 0)


if __name__ == "__main__":
    unittest.main()
