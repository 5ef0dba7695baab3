"""Tests of the report on stability: every claim, table and piece of advice follows from the raw files."""

import math
import os
import sys
import unittest

from programs import DONE, ROOT, FolderTest, environment, run
from stability_documents import (CONTROL, GRID, LONG_STEPS, LOST_RATE, ROUGH, SETTINGS, fail, long_document,
                                 map_document, norm, trial, write_document)
from study_documents import write_study

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
        return as_text(stability_report.stability_sections(failure_map(self.map), runs, {}))

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


class IssueClaims(ReportTest):
    """What was claimed of plain iteration at n = 129 before it was measured."""

    def claims(self):
        return [claim.strong + claim.rest if claim else None
                for claim in stability_report.issue_claims(failure_map(self.map))]

    def test_all_hold_in_the_made_up_file(self):
        outer, midpoint, works, inner = self.claims()
        self.assertTrue(outer.startswith("Group and cotangent, s = 1, 2, 3, fail by h‖B(W₀)‖₂ = 1.9 at n = 129 (holds): "))
        self.assertIn("group1 fails from 1.53 on (diverged)", outer)
        self.assertIn("cotangent3 fails from 1.53 on (diverged)", outer)
        self.assertTrue(midpoint.startswith("The isospectral midpoint fails by h‖B(W₀)‖₂ = 1.9 at n = 129 (holds): "))
        self.assertIn("algebra1 fails from 1.63", midpoint)
        self.assertTrue(works.startswith("Algebra, s = 2, 3, still converges at 1.86 (holds): "))
        # 50 h‖B‖₂ sweeps a step: at the neighbours of 1.86, which are √2 and the critical 1.9, or √2 and 2.
        self.assertIn("algebra2 works up to 1.90, with 71 sweeps a step at 1.41, with 95 sweeps a step at 1.90", works)
        self.assertIn("algebra3 works up to 2.20, with 71 sweeps a step at 1.41, with 100 sweeps a step at 2.00", works)
        self.assertTrue(works.endswith("the 83–99 sweeps a step claimed for it agree with these."))
        self.assertTrue(inner.startswith("Algebra, s = 2, 3, fail by h‖B(W₀)‖₂ = 3.7 at n = 129 (holds): "))

    def test_one_group_that_works_longer_turns_the_first(self):
        self.set_critical(1.95, "group2")
        self.assertRegex(self.claims()[0], r"\(does not hold\): .*group2 fails from 1.99 on")

    def test_a_midpoint_that_never_fails_turns_the_second(self):
        for each in self.maps_of("algebra1"):
            each.update(critical=None, trials=[trial("algebra1", each["n"], h_norm_B, None) for h_norm_B in GRID])
        self.assertRegex(self.claims()[1], r"\(does not hold\): algebra1 never failed")

    def test_algebra_that_fails_earlier_turns_the_third(self):
        self.set_critical(1.8, "algebra2")
        self.assertRegex(self.claims()[2], r"^Algebra, s = 2, 3, still converges at 1.86 \(does not hold\): algebra2 works"
                                           " up to 1.80")

    def test_other_sweeps_are_told(self):
        for each in self.maps_of("algebra3"):
            for one in [*each["trials"], each["critical"]["works"]]:
                one["sweeps_per_step"] /= 2
        self.assertIn("(holds)", self.claims()[2])
        self.assertTrue(self.claims()[2].endswith("do not agree with these."))

    def test_algebra_that_works_longer_turns_the_fourth(self):
        self.set_critical(3.8, "algebra3")
        self.assertIn("does not hold", self.claims()[3])

    def test_without_the_size_nothing_is_judged(self):
        self.map = map_document(SETTINGS[:1])
        (claim,) = self.claims()
        self.assertIn("not judged", claim)
        self.assertIn("n = 129", claim)


class MapClaims(ReportTest):
    def claim(self, start):
        claims = stability_report.map_claims(failure_map(self.map))
        return next(claim.strong + claim.rest for claim in claims if claim and claim.strong.startswith(start))

    def test_ways_to_fail(self):
        self.assertIn("of 33 edges, 30 diverged, 3 unstable", self.claim('The commonest failure just past the edge is "diverged"'))
        for each in self.map["maps"]:
            if each["critical"]:
                each["critical"]["fails"]["status"] = "stagnated"
        self.assertIn("of 33 edges, 33 stagnated", self.claim('The commonest failure just past the edge is "stagnated"'))

    def test_one_critical_value_at_every_size(self):
        self.assertIn("by a factor of 1.00", self.claim("h‖B(W₀)‖₂ alone decides, smooth scene"))

    def test_a_critical_value_that_moves_with_n_turns_it(self):
        works = self.maps_of("group3")[1]["critical"]["works"]
        for field in ("h_norm_B", "step"):
            works[field] /= 2
        self.assertIn("to 2.00 (group3); by less than 1.25 for 10 of 11", self.claim("h‖B(W₀)‖₂ does not decide alone"))

    def test_the_scenes(self):
        self.assertIn("1.50 (", self.claim("Failure depends on the scene"))
        self.map["maps"] = [each for each in self.map["maps"] if each["scene"] == "smooth"]
        self.map["maps"] += [{**each, "scene": "rough"} for each in self.map["maps"] if each["n"] == 17]
        self.assertIn("in the median 1.00 times", self.claim("Failure hardly depends on the scene"))


class LongRunClaims(ReportTest):
    def claims(self):
        return [claim.strong + claim.rest if claim else None
                for claim in stability_report.long_run_claims(long_runs(self.long),
                                                                                      failure_map(self.map))]

    def claim(self, start):
        return next(claim for claim in self.claims() if claim and claim.startswith(start))

    def test_who_lasts(self):
        self.assertTrue(self.claim("At 0.9").startswith(
            "At 0.9 of the critical step not every method lasts: 12 of 13 runs came through 2000 steps; failed: rk4 at"
            " n = 17 (unstable at step 500)."))
        self.assertTrue(self.claim("At 0.3").startswith("At 0.3 of the critical step every method lasts: 13 of 13"))

    def test_a_run_that_fails_is_named(self):
        fail(self.runs_of("group2")[1], 77, "diverged")
        self.assertIn("12 of 13 runs came through 2000 steps; failed: group2 at n = 17 (diverged at step 77)",
                      self.claim("At 0.3 of the critical step not every method lasts"))

    def test_spectra_that_stay(self):
        self.assertIn("of 22 runs of isospectral integrators that came through, 22 stay level; the largest error is"
                      " 1.5e-14", self.claim("The spectrum does not drift"))

    def test_a_spectrum_that_drifts_is_named(self):
        for each in self.runs_of("group3")[0]["samples"]:
            each["spectrum_error"] = 1e-9 * each["time"]
        self.assertIn("21 stay level;", self.claim("The spectrum drifts in some runs"))
        self.assertIn("drifting (1): group3 at n = 17, 0.9 (linear 1.0e-9)", self.claim("The spectrum drifts in some runs"))

    def test_a_drift_within_the_tolerance_is_told_from_one_beyond(self):
        # 2000 steps to a tolerance of 1e-13 let 2e-10 through; the run is to time 2541.
        for each in self.runs_of("group3")[0]["samples"]:
            each["spectrum_error"] = 5e-14 * each["time"]
        self.assertIn("where steps × tolerance is 2.0e-10",
                      self.claim("The spectrum drifts by no more than the tolerance lets through"))
        self.long["context"]["tolerance"] = "1e-14"
        self.claim("The spectrum drifts in some runs")

    def test_what_grows_more_slowly_than_time_wanders(self):
        for each in self.runs_of("algebra1")[1]["samples"]:
            each["energy_error"] = 1e-5 * each["time"] ** 0.5
        self.assertIn("19 stay level;", self.claim("The energy does not drift"))
        self.assertIn("wandering, more slowly than time (1): algebra1 at n = 17, 0.3 (1.0e-5 t^0.5)", self.claim("The energy does not"))

    def test_energies_that_stay_and_one_that_drifts(self):
        self.assertIn("of 20 runs of Lie–Poisson integrators", self.claim("The energy does not drift"))
        for each in self.runs_of("yoshida4")[1]["samples"]:
            each["energy_error"] = 1e-6 * each["time"] ** 2
        self.assertIn("yoshida4 at n = 17, 0.3 (1.0e-6 t^2.0)", self.claim("The energy drifts in some runs"))

    def test_the_control_loses_skew_hermiticity_at_the_rate_it_was_made_with(self):
        claim = self.claim(f"{CONTROL} loses skew-Hermiticity exponentially")
        for share in (0.9, 0.3):
            step = share * 1.9 / norm(17)
            self.assertIn(f"n = 17, {share} of the critical step: rate {LOST_RATE / step:#.3g} per unit time, 0.0150 a step,"
                          f" doubling in {math.log(2) / LOST_RATE * step:#.3g}", claim)
        self.assertTrue(claim.endswith("With C − C† the skew defect of algebra2 is exactly 0."))

    def test_the_mode_that_grows(self):
        self.assertIn("by 1.27, 0.416 a step, which is not what was measured.", self.claim(CONTROL))
        for each in self.runs_of(CONTROL):
            rate = each["predicted_skew_growth"] * each["step"]
            for one in each["samples"]:
                one["skew_defect"] = 1e-16 * math.exp(min(rate * one["step"], 60))
        self.assertIn("by 1.27, 0.416 a step: that is the mode that grows.", self.claim(CONTROL))

    def test_a_control_that_keeps_it_turns_that(self):
        for each in [each for one in self.runs_of(CONTROL) for each in one["samples"]]:
            each["skew_defect"] = 1e-15
        self.assertIn("none, 1.0e-15", self.claim(f"{CONTROL} does not lose skew-Hermiticity exponentially"))
        for each in self.runs_of(CONTROL)[0]["samples"]:
            each["skew_defect"] = 1e-15 * math.exp(LOST_RATE * each["step"])
        self.claim(f"{CONTROL} loses skew-Hermiticity exponentially in 1 of 2 runs")

    def test_a_sound_update_that_is_not_exact_is_told(self):
        self.runs_of("algebra2")[0]["samples"][0]["skew_defect"] = 3e-16
        self.assertTrue(self.claim(CONTROL).endswith("the skew defect of algebra2 is at most 3.0e-16."))


class Theory(ReportTest):
    def family(self, name, scene="smooth"):
        """Returns the cells of a family: ratio, of what, contraction and reading, of the least and of the greatest."""
        lines = self.report().split("\nWhere theory and measurement part", 1)[1].splitlines()
        cells = [[cell.strip() for cell in line.split("  ") if cell.strip()] for line in lines]
        return next(each[2:] for each in cells if each[:2] == [name, scene])

    def test_families(self):
        found = stability_report.families(failure_map(self.map), "smooth")
        self.assertEqual(list(found), ["cotangent", "group", "isospectral midpoint", "algebra, s ≥ 2",
                                       "compositions of the midpoint", "rk4"])

    def test_agreement(self):
        self.assertEqual(self.family("group"), ["1.00", "group1, n = 17", "0.900", "agree"] * 2)
        self.assertIn("agree: theory and measurement are within a factor of 1.15", self.prose())

    def test_below_the_limit_with_a_strong_contraction_the_cold_start_decides(self):
        self.assertEqual(self.family("isospectral midpoint")[:4], ["0.800", "algebra1, n = 17", "0.600", "cold start"])
        self.assertIn("the cold start leaves the basin", self.prose())

    def test_below_the_limit_with_a_weak_contraction_it_is_the_contraction(self):
        for each in self.maps_of("algebra1"):
            each["critical"]["works"]["contraction"] = 0.97
        self.assertEqual(self.family("isospectral midpoint")[2:4], ["0.970", "weak contraction"])
        self.assertNotIn("the cold start leaves the basin", self.prose())

    def test_beyond_the_limit_growth_starts_at_rounding(self):
        self.assertEqual(self.family("group", "rough")[::4], ["1.50", "1.50"])
        self.assertEqual(self.family("group", "rough")[3], "tolerance met first")
        self.assertEqual(self.family("rk4")[:4], ["2.00", "rk4, n = 17", "–", "trial ends first"])

    def test_an_explicit_method_below_its_limit(self):
        self.set_critical(0.5, "rk4")
        self.assertEqual(self.family("rk4")[3], "invariants first")
        for each in self.maps_of("rk4"):
            each["critical"]["fails"]["status"] = "diverged"
        self.assertEqual(self.family("rk4")[3], "B moves")

    def test_both_ends_of_a_family_are_read(self):
        self.set_critical(1.0, "group2")
        self.assertEqual(self.family("group"), ["0.667", "group2, n = 17", "0.900", "weak contraction", "1.00",
                                                "group1, n = 17", "0.900", "agree"])

    def test_a_contraction_that_was_not_measured(self):
        for each in self.maps_of("algebra1"):
            each["critical"]["works"]["contraction"] = None
        self.assertEqual(self.family("isospectral midpoint")[2:4], ["–", "not explained"])

    def test_the_sweep_cap_is_explained_where_it_ends_runs(self):
        self.assertNotIn("sweeps no longer suffice", self.prose())
        for each in self.maps_of("algebra1"):
            each["critical"]["fails"]["status"] = "sweep cap"
        # 1e-13 to the power 1/400.
        self.assertIn("2 edges are where 400 sweeps no longer suffice: changes fall from 1 to 1e-13 in so many where they"
                      " contract by 0.928 a sweep.", self.prose())

    def test_a_method_without_a_limit_has_no_row(self):
        self.assertNotIn("rkmk4", stability_report.families(failure_map(self.map), "smooth"))


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

    def test_a_file_of_one_explicit_method_makes_a_report(self):
        self.map["integrators"] = [each for each in self.map["integrators"] if each["name"] == "rkmk4"]
        self.map["maps"] = self.maps_of("rkmk4")
        self.assertNotIn("theory and measurement", self.report(with_runs=False))


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


class ResultsPage(FolderTest):
    """scripts/render_report with and without a recorded run of stability."""

    def setUp(self):
        super().setUp()
        for name in ("accuracy", "stability"):
            os.makedirs(self.path("recorded", name))
        write_study(self.path("recorded", "accuracy"))

    def render(self, *arguments):
        return run([os.path.join(ROOT, "scripts", "render_report"), *arguments],
                   env=environment(ISOSYRK_RESULTS=self.folder, PYTHONDONTWRITEBYTECODE="1"))

    def text(self):
        self.assertEqual(self.render().returncode, DONE)
        with open(self.path("README.md"), encoding="utf-8") as file:
            return file.read()

    def test_the_section_is_there_once_it_is_recorded(self):
        self.assertNotIn("## Stability", self.text())
        self.assertNotIn("recorded/stability", self.text())
        write_document(self.path("recorded", "stability"), map_document(), "map.json")
        self.assertEqual(self.render("--check").returncode, 1)
        text = self.text()
        self.assertIn("## Stability", text)
        self.assertIn("**recorded/stability/**", text)
        self.assertNotIn("### Drift in long runs", text)
        self.assertEqual(self.render("--check").returncode, DONE)
        write_document(self.path("recorded", "stability"), long_document(), "long_runs.json")
        self.assertEqual(self.render("--check").returncode, 1)
        self.assertIn("### Drift in long runs", self.text())

    def test_charts_that_exist_are_shown(self):
        write_document(self.path("recorded", "stability"), map_document(), "map.json")
        self.write("recorded/stability/failure_map_smooth.svg", "<svg/>")
        text = self.text()
        self.assertIn("(recorded/stability/failure_map_smooth.svg)", text)
        self.assertNotIn("failure_map_rough.svg", text)

    def test_what_cannot_be_used_is_told_in_a_line(self):
        self.write("recorded/stability/map.json", "{")
        self.assert_refused(self.render(), "map.json")


if __name__ == "__main__":
    unittest.main()
