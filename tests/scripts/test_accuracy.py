"""Tests of the study of accuracy on a made-up one: what is refused, floors, orders and costs of lines, figures, the
report."""

import random
import unittest

from programs import FolderTest
from study_documents import (INTEGRATORS, ROUGH, SLOWER, SMOOTH, STEPS, accuracy_of, run_of, small_study,
                             study_document, write_study)

from lib.accuracy_figures import figures
from lib.accuracy_lines import read_accuracy
from lib.accuracy_report import accuracy_sections
from lib.messages import UnusableFile
from lib.document import as_markdown
from lib.formats import FAST, PUBLISHED


class RefusalTest(FolderTest):
    def test_values_of_another_kind_and_empty_tables(self):
        def with_first(name, **values):
            return lambda document: document[name][0].update(values)

        for change, *words in (
                *((lambda document, name=name: document[name].clear(), "no references or no integrators")
                  for name in ("references", "integrators")),
                (with_first("runs", cpu_seconds=[0.0]), "cpu_seconds"), (with_first("runs", scene="calm"), "calm"),
                (with_first("limits", h_norm_B=0.0), "limits has h_norm_B")):
            document = study_document()
            change(document)
            with self.subTest(words=words), self.assertRaises(UnusableFile) as caught:
                accuracy_of(document)
            self.assert_one_line(f"{caught.exception}\n", *words)


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
        for solver, seconds in (("fast", 0.04), (PUBLISHED, 0.04 * SLOWER)):
            run = study.at_step(SMOOTH[1], "group2", 0.5, solver)
            self.assertEqual((run.problem, run.integrator, run.steps, run.error, run.seconds),
                             (SMOOTH[1], "group2", 10, 0.1 * 0.5**4, seconds))
        self.assertIsNone(study.at_step(SMOOTH[0], "group2", 0.11))
        self.assertEqual([run.steps for run in study.line(SMOOTH[1], "group2")], list(STEPS))  # the longest step first
        self.assertEqual([run.usable for run in study.line(SMOOTH[0], "group1")], [False] + [True] * 5)
        self.assertEqual(study.line(ROUGH, "group2", PUBLISHED), [])
        self.assertEqual({(run.formulation, run.stages) for run in study.tolerance_runs}, {("group", 1), ("group", 2)})
        self.assertEqual(study.limits["smooth", 17, "rk4", "fast"].h_norm_B, 1.4142)

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
        # Three counts of steps whose step sizes are the same to the last digit: damage, but each comes to the time.
        line = [run_of(self.document, "rkmk4", 17, steps) for steps in STEPS]
        self.document["runs"] = [run for run in self.document["runs"] if run not in line[3:]]
        for index, run in enumerate(line[:3]):
            run.update(steps=10**14 + index, step=5e-14)
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

    def test_a_cost_is_interpolated_between_two_runs_that_enclose_the_error(self):
        study = self.study()
        # The error of rkmk4 is 1e-3 h⁴, ten times that in the rough scene; 1 ms a step, group2 4 ms. On a power law
        # interpolation is exact.
        for problem, factor in ((SMOOTH[0], 1e-3), (ROUGH, 1e-2)):
            found = study.cost(problem, "rkmk4", factor * 0.2**4)
            self.assertEqual((found.coarse.steps, found.fine.steps), (20, 50))
            for value, wanted in ((found.seconds, 0.025), (found.least, 0.025 * 0.99), (found.most, 0.025 * 1.02),
                                  (found.step, 0.2)):
                self.assertAlmostEqual(value, wanted, delta=1e-12 * wanted)
        for error, solver in ((3.9e-10, FAST), (1e-5, PUBLISHED)):
            self.assertIsNone(study.cost(SMOOTH[0], "rkmk4", error, solver))
        self.assertEqual(study.cost(SMOOTH[0], "rkmk4", 0.1).fine.steps, 5)  # its longest step errs by less
        fast, slow = (study.cost(SMOOTH[0], "group2", 1e-5, solver).seconds for solver in (FAST, PUBLISHED))
        self.assertAlmostEqual(slow, SLOWER * fast, delta=1e-12)

    def test_the_cheapest_crossing_counts_and_equal_errors_divide_by_nothing(self):
        self.set_errors((1e-4, 1e-6, 1e-4, 1e-6, 1e-6, 1e-7))
        self.assertEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-5).fine.steps, 10)
        self.assertEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-6).seconds, 0.01)
        self.set_errors((1e-4, 1e-5, 1e-5, 1e-7, 1e-8, 1e-9))
        self.assertEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-5).fine.steps, 10)
        run_of(self.document, "rkmk4", 17, 100)["cpu_seconds"] = [1e-3]  # with a smaller error, and cheaper
        self.assertEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-5).seconds, 1e-3)


def report(document):
    return as_markdown(accuracy_sections(accuracy_of(document), ()))


def figures_of(document):
    return figures(accuracy_of(document))


def timed_once(document):
    """Has every run of group2_frame at n = 17, smooth, timed once."""
    for run in document["runs"]:
        if (run["integrator"], run["n"], run["scene"]) == ("group2_frame", 17, "smooth"):
            run["cpu_seconds"] = run["cpu_seconds"][1:2]


def rkmk4_dearer(document):
    for run in document["runs"]:
        if run["integrator"] == "rkmk4":
            run["cpu_seconds"] = [100 * time for time in run["cpu_seconds"]]


def a_sloppy_spectrum(document):
    """Has the spectrum of group1 suffer from loose tolerances."""
    for run in document["tolerance_runs"]:
        if run["integrator"] == "group1":
            run["spectrum_error"] = run["tolerance"] * 5


class Figures(unittest.TestCase):
    def test_they_can_be_worked_out_by_hand(self):
        found = figures_of(study_document())
        # C h^4 in S/h seconds: group2_frame costs 4e-3 (1e-2)^(1/4) / (1e-3 (1e-3)^(1/4)) = 7.1 times rkmk4.
        over_rkmk4 = 4 * 10**0.25
        for key, wanted in {
                "problems": 3, "gauss_over_rkmk4.n17": over_rkmk4, "gauss_over_rkmk4.n33.at_1e-6": over_rkmk4,
                "gauss_over_rkmk4.mean": over_rkmk4, "gauss_over_rk4.n17": 40, "gauss_over_rkmk4.below_1": 0,
                "gauss_over_rkmk4.comparisons": 14, "gauss_over_rkmk4.timed_once": 0,
                "frame_gain": 10**0.25, "frame_gain.comparisons": 8,  # group2 itself ends above 1e-8
                "gauss_order.at_1e-2.least": 4, "gauss_order.at_1e-8.largest": 4,
                "error.group2.n17": 1e-5, "error.group2_frame.n33": 1e-6,
                # Errors 0.01 (s = 1) and 1e-5 (s = 2); a solver error is a tenth of the tolerance, 1e-4 at most.
                "tolerance.group1.n17": 1e-4, "tolerance.group2.n33": 1e-5, "tolerance.time": 1,
                "tolerance.spectrum_error": 1e-15, "spectrum_error.group1.n33": 1e-15}.items():
            with self.subTest(key=key):
                self.assertAlmostEqual(found[key], wanted, delta=1e-9 * wanted)

    def test_a_change_of_a_run_changes_them(self):
        before = figures_of(study_document())
        for change, changed in (
                (timed_once, {"gauss_over_rkmk4.timed_once": 5, "gauss_over_rk4.timed_once": 5}),
                (lambda document: run_of(document, "rkmk4", 17, 50).update(error=3.3e-3), {"error.rkmk4.n17": 3.3e-3}),
                (rkmk4_dearer, {"gauss_over_rkmk4.below_1": 14, "gauss_over_rkmk4.n17": 0.04 * 10**0.25}),
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
                r"## The price of structure\n[^#]*\n\| rough, T = 5, n = 17 +\| 7\.1 \(6\.9–7\.3\) +\| +0 of 4 +\|"
                r" 40 \(39–41\)",
                # (1e-1 / 1e-2)^(1/4)
                r"co-rotating frame buys\n[^*]*\| group2 +\| 1\.8 \(1\.7–1\.8\) +\| 1\.8 \(1\.7–1\.8\) \|\n",
                r"## Error at h = 0\.1\n[^#]*\| group2 +\| 1\.0e-5 +\| 1\.0e-5 +\|\n",
                r"\| +17 \| group +\| +1 \| +1\.0e-2 \| +at least 1e-4 \|",
                r"\| +17 \| group +\| +2 \| +1\.0e-5 \| +1e-5 \|",
                # 100 steps of group2: an error of 6.3e-7, 400 equivalent products, 0.4 s; the rate 2e9 / 33^3.
                r"\| group2 +\| 0\.0500 +\| 6\.3e-7 \| +0\.400 +\| +400 \| +1\.80 % \| +4 \(3\.9–4\.1\) \|\n"):
            with self.subTest(pattern=pattern):
                self.assertRegex(text, pattern)

    def test_a_change_of_a_run_changes_them(self):
        for change, after in (
                (lambda document: run_of(document, "rk4", 17, 5).update(beyond_limit=True),
                 r"\| rk4 +\| 1\.00 l \| 1\.00 l \|\n"),
                (lambda document: run_of(document, "rk4", 33, 5).update(status="unstable", cpu_seconds=[]),
                 r"\| rk4 +\| +– \| 1\.00 u \|\n"),
                (timed_once, r"\| group2 +\| +1\.8 \| 1\.8 \("), (rkmk4_dearer, r"n = 17 +\| 0\.071 \("),
                (rkmk4_dearer, r"\| +5 of 5 \|"),
                (lambda document: run_of(document, "group2", 33, 50).update(beyond_limit=True),
                 r"\| group2 +\| 1\.0e-5 \| +– \|")):
            with self.subTest(after=after):
                document = study_document()
                self.assertNotRegex(report(document), after)
                change(document)
                self.assertRegex(report(document), after)

    def test_a_study_of_one_problem_without_tolerances_makes_a_report(self):
        document = small_study()
        document["tolerance_runs"] = document["limits"] = document["rates"] = []
        self.assertIn("Runs that failed", report(document))
        self.assertEqual(figures_of(document)["problems"], 1)


if __name__ == "__main__":
    unittest.main()
