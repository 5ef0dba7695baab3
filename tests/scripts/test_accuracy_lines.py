"""Tests of scripts/lib/accuracy_lines.py: what it refuses, and the floors and orders it finds on made-up lines."""

import copy
import os
import random
import sys
import unittest

from programs import ROOT, FolderTest
from study_documents import (INTEGRATORS, ROUGH, SLOWER, SMOOTH, STEPS, accuracy_of, run_of, study_document,
                             write_study)

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
from accuracy_lines import PUBLISHED, SCHEMA, read_accuracy  # noqa: E402
from benchmark_json import UnusableFile  # noqa: E402


class SoundFileTest(FolderTest):
    def test_values_stand_where_they_belong(self):
        study = read_accuracy(write_study(self.folder))
        self.assertEqual((study.problems(), list(study.integrators), len(study.runs)),
                         ([*SMOOTH, ROUGH], list(INTEGRATORS), len(study_document()["runs"])))
        for solver, seconds in (("fast", 0.04), (PUBLISHED, 0.04 * SLOWER)):
            run = study.at_step(SMOOTH[1], "group2", 0.5, solver)
            self.assertEqual((run.problem, run.integrator, run.steps, run.error, run.seconds, run.beyond_limit),
                             (SMOOTH[1], "group2", 10, 0.1 * 0.5**4, seconds, False))
        self.assertEqual(study.at_step(ROUGH, "group2", 0.5).error, 0.5**4)
        self.assertEqual(study.line(ROUGH, "group2", PUBLISHED), [])
        failed = study.at_step(SMOOTH[0], "group1", 1.0)  # needs no errors
        self.assertEqual((failed.usable, failed.status, failed.error), (False, "diverged", None))
        self.assertEqual({(run.formulation, run.stages) for run in study.tolerance_runs}, {("group", 1), ("group", 2)})
        self.assertEqual((study.rates[17].published, str(ROUGH)), (1e9 / 17**3, "rough, T = 5, n = 17"))
        self.assertEqual([study.safe_step_limit("smooth", n, "rk4") for n in (17, 65)], [1.4142, None])


class RefusalTest(FolderTest):
    def test_tables_that_do_not_belong_together(self):
        def with_first(name, **values):
            return lambda document: document[name][0].update(values)

        def doubled(name):
            return lambda document: document[name].append(copy.deepcopy(document[name][0]))

        for change, *words in (
                *((lambda document, name=name: document[name].clear(), "no references or no integrators")
                  for name in ("references", "integrators")),
                *((with_first("runs", cpu_seconds=value), "cpu_seconds") for value in ([], [0.0])),
                *((with_first("runs", **{name: None}), f"no value of {name}") for name in ("error", "skew_defect")),
                (with_first("runs", integrator="magic"), "magic"),
                (with_first("tolerance_runs", integrator="rk4"), "Gauss"),
                *((with_first(name, n=65), "n = 65", "no reference") for name in ("runs", "tolerance_runs")),
                *((with_first(name, step=1.001), "do not come to the time 5") for name in ("runs", "tolerance_runs")),
                (with_first("runs", scene="developed"), "developed, T = 5, n = 17", "no reference"),
                (with_first("limits", h_norm_B=0.0), "limits has h_norm_B"),
                *((doubled(name), "twice") for name in SCHEMA.tables)):
            document = study_document()
            change(document)
            with self.subTest(words=words), self.assertRaises(UnusableFile) as caught:
                accuracy_of(document)
            self.assert_one_line(f"{caught.exception}\n", *words)


class LineTest(unittest.TestCase):
    def setUp(self):
        self.document = study_document()

    def study(self):
        return accuracy_of(self.document)

    def set_errors(self, name, errors):
        """Gives the line at n = 17 these errors, the longest step first."""
        for steps, error in zip(STEPS, errors):
            run_of(self.document, name, 17, steps)["error"] = error

    def test_where_a_line_ends_and_the_order_there(self):
        def power(order):
            return [1e-3 * (5 / steps) ** order for steps in STEPS]

        for uncertainty, errors, kept, order in (
                (1e-14, power(4), 6, 4), (1e-14, power(3), 6, 3),  # powers of the step to rounding
                (1e-9, power(4), 4, 4),  # 1e-7 at 50 steps, 6.25e-9 at 100: ten times the uncertainty lies between them
                (1e-14, (1e-3, 6e-5, 4e-6, 3e-9, 2.9e-9, 1e-9), 4, None),  # rounding stops the error from falling
                (1e-14, (1e-3, 6e-5, 5.9e-5, 5.8e-5, 6e-9, 4e-10), 6, None),  # a plateau far above is no floor
                (1e-14, [*power(2)[:3], *power(4)[3:]], 6, 4)):  # an order is fitted on the smallest steps
            with self.subTest(uncertainty=uncertainty, errors=errors):
                self.document["references"][0]["uncertainty"] = uncertainty
                self.set_errors("rkmk4", errors)
                self.assertEqual([run.steps for run in self.study().above_floor(SMOOTH[0], "rkmk4")], list(STEPS[:kept]))
                if order:
                    self.assertAlmostEqual(self.study().observed_order(SMOOTH[0], "rkmk4"), order, delta=1e-12)

    def test_an_order_needs_three_steps_that_can_be_told_apart(self):
        def order(steps):
            self.document["runs"] = [each for each in study_document()["runs"]
                                     if each["integrator"] != "rkmk4" or each["steps"] in steps]
            return self.study().observed_order(SMOOTH[0], "rkmk4")

        self.assertIsNone(order(()))
        self.assertIsNone(order(STEPS[:2]))
        self.assertIsNotNone(order(STEPS[:3]))
        # Three counts of steps whose step sizes are the same to the last digit: damage, but each comes to the time.
        for index, steps in enumerate(STEPS[:3]):
            run_of(self.document, "rkmk4", 17, steps).update(steps=10**14 + index, step=5e-14)
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
            self.assertEqual((steps(), cost(0.2), cost(0.09).coarse.steps), ([[5, 10], [50, 100, 200]], None, 50))
        run_of(self.document, "rkmk4", 17, 5)["beyond_limit"] = True
        self.document["references"][0]["uncertainty"] = 1e-9  # the error at 100 steps is 6.25e-9
        self.assertEqual(steps(), [[10], [50]])
        self.assertEqual(self.study().stretches(SMOOTH[0], "euler"), [])

    def test_a_cost_is_interpolated_between_two_runs_that_enclose_the_error(self):
        def cost(error, problem=SMOOTH[0], **solver):
            return self.study().cost(problem, "rkmk4", error, **solver)

        # error = 1e-3 h⁴, 1 ms a step: on a power law interpolation is exact.
        for problem, factor in ((SMOOTH[0], 1e-3), (ROUGH, 1e-2)):
            found = cost(factor * 0.2**4, problem)
            self.assertEqual((found.coarse.steps, found.fine.steps), (20, 50))
            for value, wanted in ((found.seconds, 0.025), (found.least, 0.025 * 0.99), (found.most, 0.025 * 1.02),
                                  (found.step, 0.2)):
                self.assertAlmostEqual(value, wanted, delta=1e-12 * wanted)
        self.assertAlmostEqual(cost(run_of(self.document, "rkmk4", 17, 50)["error"]).seconds, 0.05, delta=1e-12)
        for outside in (1.001e-3, 3.9e-10):
            self.assertIsNone(cost(outside))
        self.assertIsNone(cost(1e-5, solver=PUBLISHED))
        slow = self.study().cost(SMOOTH[0], "group2", 1e-5, PUBLISHED).seconds
        self.assertAlmostEqual(slow, SLOWER * self.study().cost(SMOOTH[0], "group2", 1e-5).seconds, delta=1e-12)

    def test_the_cheapest_crossing_counts_and_equal_errors_divide_by_nothing(self):
        self.set_errors("rkmk4", (1e-4, 1e-6, 1e-4, 1e-6, 1e-6, 1e-7))
        self.assertEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-5).fine.steps, 10)
        self.assertEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-6).seconds, 0.01)
        self.set_errors("rkmk4", (1e-4, 1e-5, 1e-5, 1e-7, 1e-8, 1e-9))
        self.assertEqual(self.study().cost(SMOOTH[0], "rkmk4", 1e-5).fine.steps, 10)


if __name__ == "__main__":
    unittest.main()
