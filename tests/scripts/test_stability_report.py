"""Tests of the report on stability: every table follows from the raw files."""

import os
import sys
import unittest

from programs import ROOT
from stability_documents import (CONTROL, GRID, LONG_STEPS, ROUGH, fail, long_document, map_document, norm,
                                 trial)

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

    def prose(self, **options):
        """Returns the report with every run of blanks as one, so that it is found across line breaks."""
        return " ".join(self.report(**options).split())

    def row(self, name, heading, **options):
        """Returns the cells of an integrator in the first table after a heading; two blanks part cells."""
        lines = self.report(**options).split(f"\n{heading}", 1)[1].splitlines()
        line = next(line for line in lines if line.startswith(name + " "))
        return [cell.strip() for cell in line.split("  ") if cell.strip()]

    def maps_of(self, *names, scene="smooth"):
        return [each for each in self.map["maps"] if each["integrator"] in names and each["scene"] == scene]

    def set_critical(self, value, *names, scene="smooth"):
        """Gives integrators another critical h‖B‖₂ in a scene."""
        for each in self.maps_of(*names, scene=scene):
            name, n = each["integrator"], each["n"]
            each["trials"] = [trial(name, n, h_norm_B, value) for h_norm_B in GRID]
            each["critical"] = {"works": trial(name, n, value, value), "fails": trial(name, n, 1.02 * value, value)}

    def runs_of(self, name):
        return [each for each in self.long["runs"] if each["integrator"] == name]


class Tables(ReportTest):
    def test_critical_values(self):
        self.assertEqual(self.row("algebra2", "Smooth scene"), ["algebra2", "1.90", "1.90", "1.90", "diverged"])
        self.assertEqual(self.row("rkmk4", "Smooth scene"), ["rkmk4", "> 11.3", "> 11.3", "–", "–"])
        self.assertEqual(self.row("rk4", "Rough scene"), ["rk4", "3.00", "1.00", "unstable"])

    def test_a_method_that_never_works(self):
        for each in self.maps_of("rk4"):
            each.update(critical=None, trials=[trial("rk4", each["n"], h_norm_B, 0.0) for h_norm_B in GRID])
        self.assertEqual(self.row("rk4", "Smooth scene"), ["rk4", "< 0.125", "< 0.125", "1.00", "unstable"])
        self.assertEqual(self.row("rk4", "The largest safe step")[1], "–")

    def test_a_critical_value_that_changes_changes_its_cell(self):
        self.set_critical(0.7, "group1")
        self.assertEqual(self.row("group1", "Smooth scene")[1:3], ["0.700", "0.700"])

    def test_short_trials_are_told(self):
        self.assertIn("A trial is of 50 steps at n = 17; 5 steps at n = 129.", self.prose())

    def test_drift(self):
        # Near the edge rk4 failed at step 500; inside it loses 1e-5 of the spectrum and Casimirs in a unit of time.
        cells = self.row("rk4", "Drift in long runs")
        self.assertEqual(cells[1:3], ["unstable at step 500", "linear 1.0e-5"])
        self.assertEqual(cells[6:], [f"{LONG_STEPS} steps", "linear 1.0e-5", "none, 3.0e-15", "linear 1.0e-5",
                                     "none, 1.5e-3"])
        self.assertEqual(self.row("algebra3", "Drift in long runs")[3], "exactly 0")
        self.assertRegex(self.row(CONTROL, "Drift in long runs")[3], r"^exp 0\.00932$")

    def test_a_run_with_too_few_samples(self):
        fail(self.runs_of("group1")[0], 4, "diverged")
        self.assertEqual(self.row("group1", "Drift in long runs")[1:6], ["diverged at step 4", *"––––"])

    def test_without_long_runs_the_report_has_no_drift(self):
        report = self.report(with_runs=False)
        self.assertNotIn("Drift", report)
        self.assertIn("Critical", report)


class Advice(ReportTest):
    def advice(self, name, **options):
        return self.row(name, "The largest safe step", **options)[1:]

    def test_the_constant_and_the_steps(self):
        # c is 0.9 of the critical values 1.5 and 1.5 ROUGH; ‖B(W₀)‖₂ is n/16.
        self.assertEqual(self.advice("group1"), ["1.35", f"{0.9 * (1.5 * ROUGH):.2f}", "0.900", f"{1.35 / norm(17):.2f}",
                                                 f"{1.35 / norm(129):.3f}"])

    def test_a_method_that_failed_near_the_edge_gets_the_smaller_share(self):
        self.assertEqual(self.advice("rk4")[0:3:2], ["0.600", "0.300"])

    def test_a_method_that_failed_at_both_shares_gets_no_step(self):
        fail(self.runs_of("rk4")[1], 900)
        self.assertEqual(self.advice("rk4"), ["–"] * 5)

    def test_a_method_that_failed_well_inside_gets_no_step_though_it_lasted_near_the_edge(self):
        fail(self.runs_of("group1")[1], 900)
        self.assertEqual(self.advice("group1"), ["–"] * 5)

    def test_the_constant_is_that_of_the_worst_n(self):
        works = self.maps_of("group3")[1]["critical"]["works"]
        for field in ("h_norm_B", "step"):
            works[field] /= 2
        self.assertEqual(self.advice("group3")[0], "0.675")
        self.assertEqual(self.advice("group3")[3:], [f"{1.35 / norm(17):.2f}", f"{0.675 / norm(129):.4f}"])

    def test_without_long_runs_the_share_is_1_and_said_so(self):
        self.assertEqual(self.advice("rk4", with_runs=False)[0:3:2], ["2.00", "1.00"])
        self.assertIn("no long runs were made", self.prose(with_runs=False))

    def test_a_method_without_a_long_run_is_named(self):
        self.long["runs"] = [each for each in self.long["runs"] if each["integrator"] != "group2"]
        self.assertEqual(self.advice("group2")[2], "1.00")
        self.assertIn("it is 1 for what had no long run (group2)", self.prose())

    def test_norms_are_quoted(self):
        self.assertIn("‖B(W₀)‖₂ is in the smooth scene 1.06 at n = 17, 8.06 at n = 129.", self.prose())


if __name__ == "__main__":
    unittest.main()
