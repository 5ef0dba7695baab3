"""Tests of the report on stability: every table follows from the raw files."""

import os
import sys
import unittest

from programs import ROOT
from stability_documents import GRID, LINEAR_RATE, LONG_STEPS, fail, long_document, map_document, norm, trial

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
import stability_report  # noqa: E402
from document import as_text  # noqa: E402
from stability import failure_map, long_runs  # noqa: E402


class ReportTest(unittest.TestCase):
    def setUp(self):
        self.map, self.long = map_document(), long_document()

    def report(self, with_runs=True):
        runs = long_runs(self.long) if with_runs else None
        return as_text(stability_report.stability_sections(failure_map(self.map), runs, ()))

    def row(self, name, heading):
        """Returns the cells of an integrator in the first table after a heading; two blanks part cells."""
        lines = self.report().split(f"\n{heading}", 1)[1].splitlines()
        line = next(line for line in lines if line.startswith(name + " "))
        return [cell.strip() for cell in line.split("  ") if cell.strip()]

    def test_critical_values(self):
        self.assertEqual(self.row("algebra2", "Smooth scene"), ["algebra2", "1.90", "1.90", "diverged"])
        self.assertEqual(self.row("rkmk4", "Smooth scene"), ["rkmk4", "> 11.3", "> 11.3", "–"])
        self.assertEqual(self.row("rk4", "Rough scene"), ["rk4", "3.00", "unstable"])

    def test_a_method_that_never_works(self):
        for each in self.map["maps"]:
            if each["integrator"] == "rk4":
                each.update(critical=None, trials=[trial("rk4", each["n"], h_norm_B, 0.0) for h_norm_B in GRID])
        self.assertEqual(self.row("rk4", "Smooth scene"), ["rk4", "< 0.125", "< 0.125", "unstable"])

    def test_short_trials_are_told(self):
        self.assertIn("A trial is of 50 steps at n = 17; 5 steps at n = 129.", " ".join(self.report().split()))

    def test_largest_errors_of_long_runs(self):
        # Near the edge rk4 failed at step 500; inside it loses 1e-5 of the spectrum and Casimirs in a unit of time.
        lost = f"{LINEAR_RATE * LONG_STEPS * 0.3 * 2.0 / norm(17):.1e}".replace("e-0", "e-")
        cells = self.row("rk4", "Largest errors of long runs")
        self.assertEqual(cells[1], "unstable at step 500")
        self.assertEqual(cells[6:], [f"{LONG_STEPS} steps", lost, "3.0e-15", lost, "1.5e-3"])
        self.assertEqual(self.row("algebra3", "Largest errors of long runs")[3], "0")

    def test_a_run_without_samples(self):
        fail(next(run for run in self.long["runs"] if run["integrator"] == "group1"), 1, "diverged")
        self.assertEqual(self.row("group1", "Largest errors of long runs")[1:6], ["diverged at step 1", *"––––"])

    def test_long_runs_may_be_left_out(self):
        report = self.report(with_runs=False)
        self.assertNotIn("ong runs", report)
        self.assertIn("Critical", report)


if __name__ == "__main__":
    unittest.main()
