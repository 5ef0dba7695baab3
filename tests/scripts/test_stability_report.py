"""Tests of the report on stability: every table follows from the raw files."""

import sys
import unittest

sys.dont_write_bytecode = True
from stability_documents import LINEAR_RATE, LONG_STEPS, LOST_AT, long_study, map_study, norm

from document import as_text  # noqa: E402  (stability_documents finds it)
from stability_files import failure_map, long_runs
from stability_report import stability_sections


class ReportTest(unittest.TestCase):
    def setUp(self):
        self.map, self.long = map_study(), long_study()

    def row(self, name, heading):
        """Returns the cells of an integrator in the first table after a heading; two blanks part cells."""
        report = as_text(stability_sections(failure_map(self.map, "published"), long_runs(self.long), ()))
        lines = report.split(f"\n{heading}", 1)[1].splitlines()
        line = next(line for line in lines if line.startswith(name + " "))
        return [cell.strip() for cell in line.split("  ") if cell.strip()]

    def test_critical_values(self):
        self.assertEqual(self.row("algebra2", "Smooth scene"), ["algebra2", "1.90", "1.90", "diverged"])
        self.assertEqual(self.row("rkmk4", "Smooth scene"), ["rkmk4", "> 11.3", "> 11.3", "–"])
        self.assertEqual(self.row("rk4", "Rough scene"), ["rk4", "3.00", "unstable"])
        self.assertEqual(self.row("smooth  129", "Critical h‖B(W₀)‖₂")[-2:], ["5", "5"])  # steps of a trial

    def test_a_method_that_never_works(self):
        tables = self.map.tables
        tables["maps"] = [each._replace(works=None, fails=None, fails_as=None) for each in tables["maps"]]
        tables["trials"] = [each._replace(status="unstable") for each in tables["trials"]]
        self.assertEqual(self.row("rk4", "Smooth scene"), ["rk4", "< 0.125", "< 0.125", "unstable"])

    def test_largest_errors_of_long_runs(self):
        # Inside the edge rk4 loses 1e-5 of the spectrum and half of that of the Casimirs in a unit of time.
        lost, half = (f"{share * LINEAR_RATE * LONG_STEPS * 0.3 * 2.0 / norm(17):.1e}".replace("e-0", "e-")
                      for share in (1, 0.5))
        cells = self.row("rk4", "Largest errors of long runs")
        self.assertEqual(cells[1:3], ["unstable", str(LOST_AT - 1)])
        self.assertEqual(cells[7:], ["converged", str(LONG_STEPS), lost, "2.0e-15", half, "1.0e-3"])
        self.assertEqual(self.row("algebra3", "Largest errors of long runs")[4], "0")

    def test_a_run_without_samples(self):
        self.long.tables["samples"] = [each for each in self.long.tables["samples"] if each.run != 0]
        self.assertEqual(self.row("cotangent1", "Largest errors of long runs")[3:7], [*"––––"])

    def test_long_runs_may_be_left_out(self):
        report = as_text(stability_sections(failure_map(self.map, "published"), None, ()))
        self.assertNotIn("Largest errors", report)
        self.assertIn("Critical", report)


if __name__ == "__main__":
    unittest.main()
