"""Tests of build/benchmarks/reference_solutions, work_precision and table1 --references from outside."""

import os
import shutil
import sys
import tempfile
import unittest

from programs import (DATA, DONE, ROOT, FolderTest, program, run, snapshot, strict_json)

sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))

from work_precision import read_study  # noqa: E402

MEASURED = ("algebra1", "group2", "yoshida4", "rkmk4", "rk4")
STEPS = (5, 10, 28, 50, 100, 140, 200, 280)
# Lines of the same points on a fast machine and on a slow one.
BRIEF = ("--longest", "1000", "--repetitions", "2", "--steps", *map(str, STEPS))


def setUpModule():
    global FOLDER, REFERENCES  # one set of reference solutions for all tests here
    FOLDER = tempfile.mkdtemp(prefix="isosyrk-")
    unittest.addModuleCleanup(shutil.rmtree, FOLDER, ignore_errors=True)
    REFERENCES = os.path.join(FOLDER, "references")
    os.mkdir(REFERENCES)
    done = run([program("reference_solutions"), "--out", REFERENCES, "--n", "17"])
    assert done.returncode == DONE, done.stderr


def integrators(names=MEASURED):
    return [word for name in names for word in ("--integrator", name)]


def reference(folder):
    with open(os.path.join(folder, "reference_n17.json"), encoding="utf-8") as file:
        return strict_json(file.read())


class References(FolderTest):
    def test_uncertainty_is_below_1e_12(self):
        found = reference(REFERENCES)
        self.assertLess(found["uncertainty"], 1e-12)
        self.assertNotEqual(found["first"]["integrator"], found["second"]["integrator"])

    def test_a_file_that_is_there_is_kept(self):
        before = snapshot(REFERENCES)
        done = run([program("reference_solutions"), "--out", REFERENCES, "--n", "17"])
        self.assertEqual(done.returncode, DONE)
        self.assertIn("kept", done.stderr)
        self.assertEqual(snapshot(REFERENCES), before)

    def test_a_broken_file_is_computed_anew(self):
        self.write("reference_n17.json", "{")
        done = run([program("reference_solutions"), "--out", self.folder, "--n", "17"])
        self.assertEqual(done.returncode, DONE)
        self.assertLess(reference(self.folder)["uncertainty"], 1e-12)

    def test_bad_arguments(self):
        for arguments, parts in ((["--n", "17"], ["--out"]), (["--out", self.folder, "--n", "4"], ["--n 4", "5 to"]),
                                 (["--out", self.folder, "--n", "x"], ["--n", "'x'"]),
                                 (["--out", self.path("missing")], ["--out"])):
            with self.subTest(arguments=arguments):
                before = snapshot(self.folder)
                self.assert_refused(run([program("reference_solutions"), *arguments]), *parts)
                self.assertEqual(snapshot(self.folder), before)


class MeasuredStudy(unittest.TestCase):
    """One short study for all tests."""

    @classmethod
    def setUpClass(cls):
        cls.path = os.path.join(FOLDER, "raw.json")
        cls.done = run([program("work_precision"), "--references", REFERENCES, "--out", cls.path, "--n", "17",
                        *BRIEF, *integrators()], timeout=120)
        assert cls.done.returncode == DONE, cls.done.stderr
        with open(cls.path, encoding="utf-8") as file:
            cls.raw = strict_json(file.read())
        cls.study = read_study(cls.path)

    def test_progress_and_time_left_are_shown(self):
        self.assertIn("s left]", self.done.stderr)
        self.assertEqual(self.done.stdout, "")

    def test_every_integrator_has_its_steps_and_repetitions_and_shows_its_order(self):
        self.assertEqual(tuple(self.study.integrators), MEASURED)
        for name, integrator in self.study.integrators.items():
            points = self.study.line(name, 17)
            self.assertEqual([point.quality.steps for point in points], list(STEPS), name)
            self.assertAlmostEqual(self.study.observed_order(name, 17), integrator.order, delta=0.25)
        for point in (*self.study.points, *self.study.tolerance_points):
            if point.quality.usable:
                self.assertEqual(len(point.costs.cpu_seconds), 2)

    def test_isospectral_methods_keep_the_spectrum_and_others_do_not(self):
        # Half a unit of tolerance for every sweep of 700, as in the tests of the formulations.
        for point in self.study.points:
            if point.quality.usable and point.quality.steps == 50:
                kept = point.quality.spectrum_error < 1e-11
                self.assertEqual(kept, self.study.integrators[point.integrator].isospectral, point)

    def test_failures_are_recorded_as_failures(self):
        failed = [point for point in self.study.points if not point.quality.usable]
        self.assertTrue(failed)  # yoshida4 at h = 1
        self.assertLess(len(failed), len(self.study.points) / 4)
        for point in failed:
            self.assertIsNone(point.quality.error)
            self.assertEqual(point.costs.cpu_seconds, ())

    def test_a_step_beyond_the_stability_limit_is_marked(self):
        limit = self.study.integrators["rk4"].stability_limit
        self.assertAlmostEqual(limit, 8**0.5)
        for point in self.study.line("rk4", 17):
            self.assertEqual(point.beyond_limit, point.h_norm_ad_B > limit)
        for point in self.study.line("group2", 17):
            self.assertFalse(point.beyond_limit)

    def test_tolerances_from_1e_4_to_1e_15(self):
        for formulation, stages in (("algebra", 1), ("group", 2)):
            found = [point for point in self.study.tolerance_points
                     if (point.formulation, point.stages) == (formulation, stages)]
            self.assertEqual([round(1 / point.tolerance) for point in found], [10**k for k in range(4, 16)])
            self.assertGreater(found[-1].costs.sweeps, found[0].costs.sweeps)

    def test_the_context_says_what_it_was_measured_with(self):
        for field in ("commit", "compiler", "flags", "cpu", "blas_kernels", "products", "tolerance", "modes_hash"):
            self.assertIn(field, self.raw["context"])


class EndOfALine(FolderTest):
    def last_steps(self, *arguments):
        path = self.path("raw.json")
        done = run([program("work_precision"), "--references", REFERENCES, "--out", path, "--n", "17", "--integrator",
                    "rkmk4", "--repetitions", "1", *arguments])
        self.assertEqual(done.returncode, DONE, done.stderr)
        return read_study(path).line("rkmk4", 17)[-1].quality.steps

    def test_a_line_has_the_steps_of_table_1_at_least(self):
        self.assertEqual(self.last_steps("--longest", "1e-9"), 50)

    def test_a_line_ends_at_its_floor(self):
        reached = self.last_steps("--longest", "1000")
        self.assertGreater(reached, 1000)  # of fourth order: the error at 50 steps is some 1e-7
        self.assertLess(reached, 6400)


class Refusals(FolderTest):
    def refuses(self, *arguments, parts):
        with self.subTest(arguments=arguments):
            before = snapshot(self.folder)
            self.assert_refused(run([program("work_precision"), *arguments]), *parts)
            self.assertEqual(snapshot(self.folder), before)

    def given(self, **changes):
        arguments = {"references": REFERENCES, "out": self.path("raw.json"), "n": "17", **changes}
        return [word for name, value in arguments.items() if value is not None for word in (f"--{name}", value)]

    def test_bad_arguments(self):
        for name, values, *parts in (
                ("references", (None,)), ("out", (None, self.path("missing", "raw.json"), self.folder)),
                ("n", ("4", "514", "x", "1e9", "-17"), "5 to 513"), ("integrator", ("euler",), "rkmk4"),
                ("repetitions", ("0", "x", "1001")), ("longest", ("0", "-1", "nan", "x")),
                ("steps", ("0", "-5", "x", "2.5")), ("products", ("abacus",))):
            for value in values:
                self.refuses(*self.given(**{name: value}), parts=["integrator" if name == "integrator" else f"--{name}",
                                                                  value or "", *parts])
        self.refuses(*self.given(steps="10"), "10", parts=["--steps", "rise"])
        self.refuses(*self.given(), "perhaps", parts=["perhaps"])

    def test_references_that_are_missing_or_foreign(self):
        self.refuses(*self.given(n="33"), parts=["--references", "reference_n33.json"])
        self.refuses(*self.given(references=self.path("nowhere")), parts=["--references", "reference_n17.json"])
        os.mkdir(self.path("other"))
        shutil.copy(os.path.join(REFERENCES, "reference_n17.json"), self.path("other", "reference_n33.json"))
        self.refuses(*self.given(n="33", references=self.path("other")), parts=["another scene"])


class Table1WithReferences(FolderTest):
    ROW = "--benchmark_filter=table1/group/n:17/s:2"

    def rows(self, *arguments):
        path = self.path("raw.json")
        done = run([program("table1"), self.ROW, "--benchmark_min_time=0.01", f"--benchmark_out={path}", *arguments])
        self.assertEqual(done.returncode, DONE, done.stderr)
        with open(path, encoding="utf-8") as file:
            return strict_json(file.read())["benchmarks"]

    def test_rows_have_the_error_at_the_end(self):
        (row,) = self.rows("--references", REFERENCES)
        # tests/data holds W(5) of this cell and, for s = 3, one that is 10⁴ times closer to the truth.
        self.assertLess(abs(row["relative_error"] / expected_error() - 1), 1e-3)
        self.assertLess(row["reference_uncertainty"], 1e-12)

    def test_without_references_there_is_no_error(self):
        (row,) = self.rows()
        self.assertNotIn("relative_error", row)

    def test_references_that_are_not_there_are_named(self):
        done = run([program("table1"), self.ROW, "--references", self.folder])
        self.assert_refused(done, "--references", "reference_n17.json")


def expected_error():
    """Returns the relative distance of the reference answers of s = 2 and s = 3 at n = 17."""
    answers = []
    for s in (2, 3):
        with open(os.path.join(DATA, f"W_t5_h0.1_n17_s{s}.csv"), encoding="utf-8") as file:
            next(file)
            answers.append([complex(float(re), float(im)) for _, _, re, im in (line.split(",") for line in file)])
    difference = sum(abs(a - b)**2 for a, b in zip(*answers))
    return (difference / sum(abs(b)**2 for b in answers[1]))**0.5


if __name__ == "__main__":
    unittest.main()
