"""Tests of the study of accuracy on a made-up one: floors, orders and costs of lines, comparisons, figures, the report."""

import random
import unittest

from programs import FolderTest
from study_documents import (CANDIDATES, INTEGRATORS, ROUGH, SMOOTH, SOONER, STEPS, accuracy_of, run_of, small_study,
                             study_document, write_study)

from studies.accuracy.judge import figures, findings
from studies.accuracy.schema import CANDIDATES as ALL_CANDIDATES
from lib.records.settings import ENERGY_BOUNDED, LOOSE_EXPONENTIAL, LOOSE_GAUSS, TIGHT
from studies.accuracy.schema import CUT, Form
from studies.accuracy.lines import read_accuracy
from studies.accuracy.report import accuracy_sections
from studies.accuracy.candidates import CLASSES, all_forms, members
from lib.records.formats import listed
from lib.pages.document import as_markdown


class LineTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.document = study_document()

    def study(self):
        return accuracy_of(self.document)

    def set_errors(self, errors):
        """Gives the line of rkmk4 at n = 17 these errors, the longest step first."""
        for steps, error in zip(STEPS, errors):
            run_of(self.document, "rkmk4", 17, steps)["error"] = error

    def test_values_stand_where_they_belong_whatever_the_order_of_the_file(self):
        random.Random(3).shuffle(self.document["runs"])
        study = read_accuracy(write_study(self.folder, self.document))
        self.assertEqual((study.problems(), list(study.integrators)), ([*SMOOTH, ROUGH], list(INTEGRATORS)))
        for tolerance, seconds in ((TIGHT, 0.04), (LOOSE_GAUSS, 0.04 * SOONER)):
            run = study.at_step(SMOOTH[1], "group2_frame", 0.5, tolerance)
            self.assertEqual((run.problem, run.form, run.steps, run.error),
                             (SMOOTH[1], Form("group2_frame", tolerance), 10, 0.01 * 0.5**4))
            self.assertAlmostEqual(run.seconds, 0.99 * seconds)  # the least repetition
        self.assertIsNone(study.at_step(SMOOTH[0], "group2", 0.11))
        self.assertEqual([run.steps for run in study.line(SMOOTH[1], "group2")], list(STEPS))  # the longest step first
        self.assertEqual([run.usable for run in study.line(SMOOTH[0], "group1")], [False] + [True] * 5)
        self.assertEqual(study.line(ROUGH, "group2", LOOSE_GAUSS), [])
        self.assertEqual({run.integrator for run in study.tolerance_runs}, {"group1", "group2"})
        self.assertEqual(study.forms()[-3:], [Form("group2_frame", LOOSE_GAUSS), Form("elp4_frame"),
                                              Form("elp4_frame", LOOSE_EXPONENTIAL)][-3:])
        self.assertEqual((study.ends[SMOOTH[0], "group1", TIGHT], study.ends[ROUGH, "rk4", TIGHT]), ("cut", "below"))

    def test_where_a_line_ends_and_the_order_there(self):
        def power(order):
            return [1e-3 * (5 / steps) ** order for steps in STEPS]

        for uncertainty, errors, kept, order in (
                (1e-14, power(4), 6, 4), (1e-14, power(3), 6, 3),  # powers of the step to rounding
                (1e-6, power(4), 2, None), (1e-3, power(4), 0, None),  # too few for an order
                (1e-9, power(4), 4, 4),  # 1e-7 at 50 steps, 6.25e-9 at 100: ten times the uncertainty lies between them
                (1e-14, (1e-3, 6e-5, 4e-6, 3e-9, 2.9e-9, 1e-9), 4, "no power"),  # rounding stops the error from falling
                (1e-14, (1e-3, 6e-5, 5.9e-5, 5.8e-5, 6e-9, 4e-10), 6, "no power"),  # a plateau far above is no floor
                (1e-14, [*power(2)[:3], *power(4)[3:]], 6, 4)):  # an order is fitted on the smallest steps
            with self.subTest(uncertainty=uncertainty, errors=errors):
                self.document["references"][0]["uncertainty"] = uncertainty
                self.set_errors(errors)
                self.assertEqual([run.steps for run in self.study().above_floor(SMOOTH[0], "rkmk4")],
                                 list(STEPS[:kept]))
                if order != "no power":
                    found = self.study().observed_order(SMOOTH[0], "rkmk4")
                    self.assertEqual(found and round(found, 12), order)

    def test_an_order_needs_three_steps_that_can_be_told_apart(self):
        # Three counts of steps so large that the logarithms of their step sizes are the same double.
        line = [run_of(self.document, "rkmk4", 17, steps) for steps in STEPS]
        self.document["runs"] = [run for run in self.document["runs"] if run not in line[3:]]
        for index, run in enumerate(line[:3]):
            run.update(steps=10**15 - 3 + index)
        self.assertIsNone(self.study().observed_order(SMOOTH[0], "rkmk4"))

    def test_stretches_end_at_failures_limits_and_the_floor_and_no_cost_bridges_a_gap(self):
        def steps():
            return [[run.steps for run in stretch] for stretch in self.study().stretches(SMOOTH[0], "rkmk4")]

        def cost(step):
            return self.study().cost(SMOOTH[0], "rkmk4", 1e-3 * step**4)

        self.assertEqual((steps(), cost(0.2).coarse.steps), ([list(STEPS)], 20))
        for change in ({"beyond_limit": True},
                       {"beyond_limit": False, "status": "diverged", "error": None, "cpu_seconds": []}):
            run_of(self.document, "rkmk4", 17, 20).update(change)
            self.assertEqual((steps(), cost(0.2).coarse.steps, cost(0.09).coarse.steps),
                             ([[5, 10], [50, 100, 200]], 50, 50))
        run_of(self.document, "rkmk4", 17, 5)["beyond_limit"] = True
        self.document["references"][0]["uncertainty"] = 1e-9  # the error at 100 steps is 6.25e-9
        self.assertEqual(steps(), [[10], [50]])
        self.assertEqual(self.study().stretches(SMOOTH[0], "euler"), [])

    def test_the_cheapest_crossing_counts_and_equal_errors_divide_by_nothing(self):
        self.set_errors((1e-4, 1e-6, 1e-4, 1e-6, 1e-6, 1e-7))
        self.assertEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-5).fine.steps, 10)
        self.assertAlmostEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-6).seconds, 0.01 * 0.99)
        self.set_errors((1e-4, 1e-5, 1e-5, 1e-7, 1e-8, 1e-9))
        self.assertEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-5).fine.steps, 10)
        run_of(self.document, "rkmk4", 17, 100)["cpu_seconds"] = [1e-3]  # with a smaller error, and cheaper
        self.assertEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-5).seconds, 1e-3)


def report(document):
    return as_markdown(accuracy_sections(accuracy_of(document), ()))


def figures_of(document):
    return figures(findings(accuracy_of(document)))


def elp_slower(document):
    """Has the exponential method take 10 times as long in comparisons at n = 17, and as long as RKMK4 in those at n = 33."""
    for row in document["comparisons"]:
        if row["candidate"] == "elp":
            factor = 10 if row["n"] == 17 else 1
            rival = next(each for each in document["comparisons"] if each["candidate"] == "rkmk"
                         and (each["n"], each["wanted"]) == (row["n"], row["wanted"]))
            row["cpu_seconds"] = [factor * time for time in (row if row["n"] == 17 else rival)["cpu_seconds"]]


def explicit_slower(document):
    """Has the explicit method take 12 times as long in the comparison at 1e-6 and n = 33."""
    (row,) = (each for each in document["comparisons"] if (each["candidate"], each["n"], each["wanted"])
              == ("explicit", 33, 1e-6))
    row["cpu_seconds"] = [12 * time for time in row["cpu_seconds"]]


def scattered(document):
    """Has the times of RKMK4 scatter from process to process, about those of the explicit method."""
    for row in document["comparisons"]:
        if row["candidate"] == "rkmk":
            row["cpu_seconds"] = [time / 5.7 * factor
                                  for time, factor in zip(row["cpu_seconds"], (1, 4, 1, 0.2, 3, 0.4))]


def a_sloppy_spectrum(document):
    """Has the spectrum of group1 suffer from loose tolerances."""
    for run in document["tolerance_runs"]:
        if run["integrator"] == "group1":
            run["spectrum_error"] = run["tolerance"] * 5


class Compared(unittest.TestCase):
    def test_comparisons_are_found_by_problem_and_error(self):
        study = accuracy_of(study_document())
        self.assertEqual(set(study.comparison(SMOOTH[0], 1e-4)), set(CANDIDATES))
        self.assertEqual(study.comparison(SMOOTH[0], 1e-4)["elp"].tolerance, LOOSE_EXPONENTIAL)
        self.assertEqual((study.comparison(ROUGH, 1e-4), study.comparison(SMOOTH[0], 1e-5)), ({}, {}))


class Classes(unittest.TestCase):
    """Of methods that compete, found by rule."""

    RK4, PROJECTED = listed("rk4_frame"), listed("rk4_projected_frame")
    LISTED = (RK4._replace(name="rk12_frame", order=12), RK4, RK4._replace(name="rk12", order=12, co_rotating=False),
              RK4._replace(name="rk2_frame", order=2), PROJECTED._replace(name="rk12_projected_frame", order=12),
              *map(listed, ("rkmk4_frame", "magnus5_frame", "elp6_frame", "elp2_frame", "group2_frame",
                            "algebra2_frame", "group4_frame", "cotangent2_frame", "bm2_frame", "cg4_frame")),
              listed("direct2")._replace(name="direct2_frame", co_rotating=True),
              listed("elp4_frame")._replace(name="elp8_frame", family="of another kind"))

    def test_each_finds_its_methods_in_the_frame_from_order_four_on(self):
        self.assertEqual(list(CLASSES), list(ALL_CANDIDATES))
        found = {each: [method.name.removesuffix("_frame") for method in members(self.LISTED, each)]
                 for each in CLASSES}
        exponential, gauss = dict.fromkeys(("elp", "elp_matched", "elp_bounded"), ["elp6"]), ["group2", "group4"]
        self.assertEqual(found, {
            "explicit": ["rk12", "rk4"], "rk4": ["rk4"], "projected": ["rk12_projected"], "rkmk": ["rkmk4"],
            "magnus": ["magnus5"], **exponential, **dict.fromkeys(("gauss", "gauss_loose", "gauss_matched"), gauss),
            "gauss_published": ["group2", "algebra2"], "named_published": ["bm2", "cg4"],
            "other": ["elp8"]})
        self.assertEqual(all_forms(self.LISTED), [Form(f"{name}_frame", tolerance) for name, tolerance in (
            ("rk12", TIGHT), ("rk4", TIGHT), ("rk12_projected", TIGHT), ("rkmk4", TIGHT),
            ("magnus5", LOOSE_EXPONENTIAL), ("elp6", LOOSE_EXPONENTIAL), ("elp6", ENERGY_BOUNDED), ("group2", TIGHT),
            ("group4", TIGHT), ("elp8", TIGHT))])

    def test_a_matched_tolerance_competes_where_it_is_looser_or_needed(self):
        for name, error, tolerance in (("gauss", 1e-4, TIGHT), ("elp", 1e-8, LOOSE_EXPONENTIAL),
                                       ("elp_bounded", 1e-4, ENERGY_BOUNDED), ("gauss_matched", 1e-4, 1e-6),
                                       ("gauss_matched", 1e-6, None), ("gauss_matched", 1e-8, 1e-10),
                                       ("elp_matched", 1e-4, 1e-6), ("elp_matched", 1e-6, None),
                                       ("elp_matched", 1e-8, 1e-10)):
            with self.subTest(name=name, error=error):
                found = CLASSES[name].tolerance_for(error)
                self.assertEqual(found and float(f"{found:.6g}"), tolerance)
        self.assertEqual([CLASSES["elp_matched"].line_tolerance(error) for error in (1e-4, 1e-8)],
                         [LOOSE_EXPONENTIAL, TIGHT])


class Figures(unittest.TestCase):
    def test_they_can_be_worked_out_by_hand(self):
        found = figures_of(study_document())
        # At 1e-4 group2_frame and elp4_frame need 5 (1e-2 / 1e-4)^(1/4) = 15.8 steps, of 4 ms, and 1 ms at the loose
        # tolerance; rkmk4 8.9 steps of 1 ms; rk4 15.8 of 0.1 ms. At 1e-6: 50, 28.1 and 50 steps.
        for key, wanted in {
                "problems": 3, "gauss_over_elp.smooth_t5.n17.at_1e-4": 4,
                "gauss_loose_over_elp.smooth_t5.n17.at_1e-4": 2, "elp_matched_over_elp.smooth_t5.n17.at_1e-4": 1,
                "gauss_matched_over_elp_matched.smooth_t5.n17.at_1e-4": 2,
                "gauss_published_over_gauss.smooth_t5.n33.at_1e-6": 4,
                "rkmk_over_explicit.smooth_t5.n17.at_1e-4": 90 / 16,
                "elp_over_explicit.smooth_t5.n33.at_1e-6": 10, "elp_bounded_over_explicit.smooth_t5.n33.at_1e-6": 20,
                "named_published_over_gauss_published.smooth_t5.n33.at_1e-6": 89 / 50,
                "named_published_over_gauss_published.products.smooth_t5.n33.at_1e-6": 89 / 50,
                "elp_over_explicit.slower": 4, "elp_over_explicit.faster": 0, "elp_over_explicit.undecided": 0,
                "elp_over_explicit.comparisons": 4, "rows": 40, "rows.of_few_steps": 2,  # rkmk4 at 1e-4
                "explicit_fastest.at_1e-6": 2, "explicit_fastest.at_1e-6.comparisons": 2,
                "seconds.elp.smooth_t5.n17.at_1e-6": 0.05, "steps.elp.smooth_t5.n17.at_1e-6": 50,
                "spectrum.gauss_loose.smooth_t5.n17.at_1e-6": 1e-7, "spectrum.elp.smooth_t5.n17.at_1e-6": 1e-15,
                "frame_gain": 10**0.25, "frame_gain.comparisons": 8,  # group2 itself ends above 1e-8
                "gauss_order.at_1e-2.min": 4, "gauss_order.at_1e-8.largest": 4,
                "error.group2.n17": 1e-5, "error.group2_frame.n33": 1e-6,
                # Errors 0.01 (s = 1) and 1e-5 (s = 2); a solver error is a tenth of the tolerance, 1e-4 at most.
                "tolerance.group1.n17": 1e-4, "tolerance.group2.n33": 1e-5, "tolerance.time": 1,
                "tolerance.spectrum_error": 1e-15, "spectrum_error.group1.n33": 1e-15}.items():
            with self.subTest(key=key):
                self.assertAlmostEqual(found[key], wanted, delta=1e-3 * wanted)
        self.assertFalse([key for key in found if "magnus" in key or "projected" in key])  # which nobody sent

    def test_a_change_of_a_run_changes_them(self):
        before = figures_of(study_document())
        for change, changed in (
                (lambda document: run_of(document, "rkmk4", 17, 50).update(error=3.3e-3), {"error.rkmk4.n17": 3.3e-3}),
                (elp_slower, {"gauss_over_elp.faster": 2, "gauss_over_elp.slower": 2,
                              "gauss_over_elp.smooth_t5.n17.at_1e-4": 0.4}),
                (explicit_slower, {"explicit_fastest.at_1e-6": 1, "elp_over_explicit.faster": 1}),
                (scattered, {"rkmk_over_explicit.undecided": 4}),
                (a_sloppy_spectrum, {"tolerance.spectrum_error": 5e-4, "tolerance.spectrum_error.at_1e-13": 5e-13,
                                     "spectrum_error.group1.n17": 5e-13})):
            document = study_document()
            change(document)
            after = figures_of(document)
            for key, wanted in changed.items():
                with self.subTest(key=key):
                    self.assertNotAlmostEqual(before[key], wanted, delta=1e-9 * wanted)
                    self.assertAlmostEqual(after[key], wanted, delta=1e-9 * wanted)


class Report(unittest.TestCase):
    def test_figures_can_be_worked_out_by_hand(self):
        text = report(study_document())
        for pattern in (
                r"in 2 of 2 comparisons no class is faster than the best explicit method, which keeps nothing\.\n",
                r"\| smooth, T = 5, n = 17 \| \*\*0\.00160 \(16\)\*\* \| – \| 0\.0320 \(16\) \|",
                r"### Error 1e-4\n[^#]*\n\| smooth, T = 5, n = 17 \| – \| – \| 5\.63 \(5\.63–5\.63\) \| – \| 10\.00 ",
                r"\| 1e-6 \| smooth, T = 5, n = 33 \| group2\\_frame \| 50 \| 0\.800 \| group2 \| 89 \| 1\.42 \| 1\.78 "
                r"[^|]*\| 1\.78 ",
                r"smooth, T = 5, n = 17 \| Gauss, 1e-7 \| group2\\_frame, 1e-7 \| 50 \| 1\.0e-6 \| 1\.0e-7 \|",
                r"\| 1e-4 \| smooth, T = 5, n = 17 \| RKMK \| rkmk4 \| 9° \|",
                # (1e-1 / 1e-2)^(1/4)
                r"co-rotating frame buys\n[^*]*\| group2 +\| +1\.8 \| +1\.8 \|\n",
                r"## Error at h = 0\.1\n[^#]*\| group2 +\| 1\.0e-5 +\| 1\.0e-5 +\|\n",
                r"\| +17 \| group +\| +1 \| +1\.0e-2 \| +at least 1e-4 \|",
                r"\| +17 \| group +\| +2 \| +1\.0e-5 \| +1e-5 \|",
                # 100 steps of group2: an error of 6.3e-7, 400 equivalent products, 0.396 s; the rate 2e9 / 33^3.
                r"\| group2 +\| 0\.0500 +\| 6\.3e-7 \| +0\.396 \| +400 \| +1\.81 % \|\n",
                r"## Lines that were cut\n[^#]*### smooth, T = 5\n[^#]*\| cotangent1 +\| +6\.3e-4 \| +6\.3e-4 \|"):
            with self.subTest(pattern=pattern):
                self.assertRegex(text, pattern)

    def test_a_change_of_a_run_changes_them(self):
        for change, after in (
                (lambda document: run_of(document, "rk4", 17, 5).update(beyond_limit=True),
                 r"\| rk4 +\| 1\.00 l \| 1\.00 l \|\n"),
                (lambda document: run_of(document, "rk4", 33, 5).update(status="unstable", cpu_seconds=[]),
                 r"\| rk4 +\| +– \| 1\.00 u \|\n"),
                (elp_slower, r"n = 17 [^\n]*\| 100\.00 \("), (scattered, r"–[0-9.]+\) † \|"),
                (explicit_slower, r"1 of 2 comparisons [^.]*\. The fastest elsewhere: smooth, T = 5, n = 33 \(RKMK\)\."),
                (explicit_slower, r"\*\*0\.0500 \(50\)\*\*"),
                (lambda document: document["comparisons"][0].update(beyond_limit=True), r"\| 0\.00160 \(16‡\)|\(16‡\)\*\*"),
                (lambda document: document["lines"][-1].update(end=CUT), r"\| elp4\\_frame, 1e-8 +\| +3\.9e-8"),
                (lambda document: run_of(document, "group2", 33, 50).update(beyond_limit=True),
                 r"\| group2 +\| 1\.0e-5 \| +– \|")):
            with self.subTest(after=after):
                document = study_document()
                self.assertNotRegex(report(document), after)
                change(document)
                self.assertRegex(report(document), after)

    def test_a_study_of_one_problem_without_tolerances_makes_a_report(self):
        document = small_study()
        document["tolerance_runs"] = document["comparisons"] = document["rates"] = []
        self.assertIn("Runs that failed", report(document))
        self.assertEqual(figures_of(document)["problems"], 1)


if __name__ == "__main__":
    unittest.main()
