"""Tests of scripts/studies/stability.py and long_runs.py, as a user runs them."""

import os
import sys
import unittest

from programs import DONE, HAS_MODULE, ROOT, FolderTest, run, snapshot

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
from stability_files import FAST, PUBLISHED, read_long_runs, read_map  # noqa: E402

# Critical h‖B‖₂ of the smooth scene, found by an independent earlier program: n = 9, and 17 for the
# fast form.
CRITICAL = {"group1": 1.354, "algebra2": 1.737, "rkmk4": 4.914}
CRITICAL_FAST = 2.430
AS_CLOSE = 1.04  # two bisections to 2 %


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class StudyTest(FolderTest):
    def study(self, name, *arguments):
        path = self.path(f"{name}.json")
        done = run([sys.executable, os.path.join(ROOT, "scripts", "studies", f"{name}.py"), "--out", path, *arguments],
                   timeout=120)
        return done, path

    def made(self, name, *arguments):
        done, path = self.study(name, *arguments)
        self.assertEqual((done.returncode, done.stdout), (DONE, ""), done.stderr)
        self.assertFalse(os.path.exists(f"{path}.journal"))
        return path

    def assert_as_close(self, found, expected):
        self.assertLess(max(found, expected) / min(found, expected), AS_CLOSE)


class FailureMaps(StudyTest):
    def test_outcomes_critical_steps_and_theory(self):
        arguments = ("--n", "9", "--integrator", *CRITICAL)
        failures = read_map(self.made("stability", *arguments))
        self.assertEqual((list(failures.integrators), list(failures.settings), len(failures.maps)),
                         (list(CRITICAL), [("smooth", 9), ("rough", 9)], 6))
        for (scene, _, name), each in failures.maps.items():
            with self.subTest(scene=scene, name=name):
                self.assertEqual([trial.h_norm_B for trial in each.trials], [2.0 ** (k / 2) for k in range(-6, 8)])
                self.assertTrue(each.trials[0].works)
                self.assertFalse(each.trials[-1].works)  # nothing works at h‖B‖ = 11
                for trial in each.trials:
                    self.assertEqual(trial.failed_step is None, trial.status in ("converged", "unstable"))
                self.assertTrue(1 < each.edge.fails / each.edge.works <= 1.0201)
                if scene == "smooth":
                    self.assert_as_close(each.edge.works, CRITICAL[name])
        self.assertAlmostEqual(failures.at("smooth", 9, "group1").edge.linear_limit, 2.0)
        self.assertIsNone(failures.at("smooth", 9, "rkmk4").edge.linear_limit)

    def test_fast_forms_under_the_names_of_the_published_ones(self):
        arguments = ("--n", "17", "--scene", "smooth", "--integrator", "group2")
        fast = read_map(self.made("stability", *arguments, "--solver", "fast"), FAST)
        published = read_map(self.made("stability", *arguments), PUBLISHED)
        both = [each.at("smooth", 17, "group2").edge.works for each in (fast, published)]
        self.assertGreater(both[0], 1.1 * both[1])  # what fails is tried again with acceleration
        self.assert_as_close(both[0], CRITICAL_FAST)


class LongRuns(StudyTest):
    def test_samples_shares_and_controls(self):
        runs = read_long_runs(self.made("long_runs", "--n", "9", "--steps", "300", "--integrator", "group1"))
        names = ["group1", "algebra2_two_products", "algebra3_two_products"]
        self.assertEqual(list(runs.integrators), names)
        self.assertEqual([(run.row.integrator, run.row.share) for run in runs.runs],
                         [(name, share) for name in names for share in (0.9, 0.3)])
        for run in runs.runs:
            self.assertAlmostEqual(run.row.h_norm_B, run.row.share * run.row.critical)
            steps = [sample.step for sample in run.samples]
            self.assertEqual((steps[0], steps), (1, sorted(set(steps))))
        kept, lost = runs.at("smooth", 9, 0.3, "group1"), runs.at("smooth", 9, 0.3, "algebra2_two_products")
        self.assertEqual((kept.survived, kept.samples[-1].step), (True, 300))
        self.assertLess(kept.samples[-1].spectrum_error, 1e-10)
        # The control is seen to lose skewness where nothing else fails, and ends when all is lost.
        self.assertEqual((lost.row.status, lost.row.failed_step), ("unstable", lost.samples[-1].step))
        self.assertGreater(lost.samples[-1].skew_defect, 1e3 * lost.samples[0].skew_defect)


class Refusals(StudyTest):
    def test_bad_arguments(self):
        for name, arguments, *parts in (
                ("stability", ("--solver", "slow"), "--solver", "slow"),
                ("stability", ("--scene", "calm"), "calm", "smooth"),
                ("long_runs", ("--solver", "fast"), "--solver"),
                *(("long_runs", ("--steps", steps), "--steps", steps) for steps in ("9", "x", "1000001"))):
            with self.subTest(program=name, arguments=arguments):
                self.assert_refused(self.study(name, *arguments)[0], *parts)
                self.assertEqual(snapshot(self.folder), {})


if __name__ == "__main__":
    unittest.main()
