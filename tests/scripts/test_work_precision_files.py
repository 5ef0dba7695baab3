"""Tests of scripts/lib/work_precision.py: what it refuses, and the floors and orders it finds on made-up lines."""

import copy
import os
import random
import sys
import unittest

from programs import ROOT, FolderTest
from study_documents import INTEGRATORS, SIZES, STEPS, study_document, write_study
from wrong_values import WRONG

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
import work_precision  # noqa: E402
from benchmark_json import UnusableFile  # noqa: E402


class ReaderTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.document = study_document()

    def assert_refused(self, document, *words):
        """Refused, in one short line that has every one of `words` in it."""
        with self.assertRaises(UnusableFile) as caught:
            work_precision.study(document)
        self.assert_one_line(f"{caught.exception}\n", *words)
        self.assertLess(len(str(caught.exception)), 300)

    def point(self, name, n, steps):
        return next(each for each in self.document["points"]
                    if (each["integrator"], each["n"], each["steps"]) == (name, n, steps))


class SoundFileTest(ReaderTest):
    def test_every_object_is_read(self):
        study = work_precision.read_study(write_study(self.folder))
        self.assertEqual((study.sizes(), list(study.integrators), len(study.points), len(study.tolerance_points)),
                         (list(SIZES), list(INTEGRATORS), len(self.document["points"]),
                          len(self.document["tolerance_points"])))

    def test_values_stand_where_they_belong(self):
        point = work_precision.study(self.document).at_step("group2", 33, 0.5)
        self.assertEqual((point.integrator, point.quality.n, point.quality.steps, point.quality.error,
                          point.costs.products, point.costs.seconds, point.beyond_limit),
                         ("group2", 33, 10, 0.1 * 0.5**4, 40, 0.04, False))

    def test_a_failed_run_needs_no_errors(self):
        point = work_precision.study(self.document).at_step("group1", 17, 1.0)
        self.assertEqual((point.quality.usable, point.quality.status, point.quality.error), (False, "diverged", None))

    def test_every_known_status_is_read(self):
        for status in work_precision.STATUSES:
            with self.subTest(status=status):
                self.document["points"][0]["status"] = status
                self.assertEqual(work_precision.study(self.document).points[0].quality.status, status)

    def test_what_an_integrator_keeps(self):
        integrators = work_precision.study(self.document).integrators
        kept = {name: [structure for structure in ("nothing", "spectrum", "poisson")
                       if integrators[name].keeps(structure)] for name in ("rk4", "rkmk4", "group2")}
        self.assertEqual(kept, {"rk4": ["nothing"], "rkmk4": ["nothing", "spectrum"],
                                "group2": ["nothing", "spectrum", "poisson"]})


class RefusalTest(ReaderTest):
    def test_empty_references_and_integrators(self):
        self.assert_refused({**self.document, "references": []}, "names no n")
        self.assert_refused({**self.document, "integrators": []}, "names no name")

    def test_time(self):
        for value in WRONG["positive"]:
            with self.subTest(value=str(value)[:20]):
                self.assert_refused({**self.document, "time": value}, "time")

    def test_impossible_times_and_formulations(self):
        for value in WRONG["times"]:
            with self.subTest(value=str(value)[:20]):
                document = copy.deepcopy(self.document)
                document["points"][0]["cpu_seconds"] = value
                self.assert_refused(document, "cpu_seconds")
        for value in (None, 7, "group1", "quotient"):
            self.document["tolerance_points"][0]["formulation"] = value
            self.assert_refused(self.document, "formulation")

    def test_unknown_status(self):
        self.document["points"][0]["status"] = "finished"
        self.assert_refused(self.document, "finished", "converged")

    def test_point_of_an_unlisted_integrator(self):
        self.document["points"][0]["integrator"] = "magic"
        self.assert_refused(self.document, "magic")

    def test_points_at_a_size_without_reference(self):
        for list_name in ("points", "tolerance_points"):
            with self.subTest(list=list_name):
                document = copy.deepcopy(self.document)
                document[list_name][0]["n"] = 65
                self.assert_refused(document, "n = 65", "no reference")

    def test_doubled_point(self):
        self.document["points"].append(copy.deepcopy(self.point("group2", 33, 50)))
        self.assert_refused(self.document, "group2 at n = 33 with 50 steps twice")

    def test_doubled_reference_and_integrator(self):
        for list_name in ("references", "integrators"):
            with self.subTest(list=list_name):
                document = copy.deepcopy(self.document)
                document[list_name].append(document[list_name][0])
                self.assert_refused(document, "twice")

    def test_steps_that_do_not_come_to_the_time(self):
        for list_name in ("points", "tolerance_points"):
            with self.subTest(list=list_name):
                document = copy.deepcopy(self.document)
                document[list_name][0]["step"] *= 1.001
                self.assert_refused(document, "do not come to the time 5")


class LineTest(ReaderTest):
    def study(self):
        return work_precision.study(self.document)

    def set_errors(self, name, errors):
        """Gives the line at n = 17 these errors, the longest step first."""
        for steps, error in zip(STEPS, errors):
            self.point(name, 17, steps)["error"] = error

    def kept_steps(self, name):
        return [point.quality.steps for point in self.study().above_floor(name, 17)]

    def test_a_line_is_the_longest_step_first_whatever_the_order_of_the_file(self):
        random.Random(3).shuffle(self.document["points"])
        self.assertEqual([point.quality.steps for point in self.study().line("group2", 33)], list(STEPS))

    def test_a_line_holds_failures_too(self):
        self.assertEqual([point.quality.usable for point in self.study().line("group1", 17)], [False] + [True] * 5)

    def test_at_step(self):
        self.assertEqual(self.study().at_step("group2", 17, 0.1).quality.steps, 50)
        self.assertIsNone(self.study().at_step("group2", 17, 0.11))

    def test_a_line_above_the_floor_is_kept_whole(self):
        self.assertEqual(self.kept_steps("group2"), list(STEPS))

    def test_failures_are_left_out(self):
        self.assertEqual(self.kept_steps("group1"), list(STEPS[1:]))

    def test_ends_where_the_reference_tells_no_more(self):
        # Errors 1e-3 h⁴: 1e-7 at 50 steps and 6.25e-9 at 100; ten times the uncertainty lies between them.
        self.document["references"][0]["uncertainty"] = 1e-9
        self.assertEqual(self.kept_steps("rkmk4"), [5, 10, 20, 50])

    def test_ends_where_rounding_stops_the_error_from_falling(self):
        self.set_errors("rkmk4", (1e-3, 6e-5, 4e-6, 3e-9, 2.9e-9, 1e-9))
        self.assertEqual(self.kept_steps("rkmk4"), [5, 10, 20, 50])

    def test_a_plateau_far_above_rounding_is_no_floor(self):
        self.set_errors("rkmk4", (1e-3, 6e-5, 5.9e-5, 5.8e-5, 6e-9, 4e-10))
        self.assertEqual(self.kept_steps("rkmk4"), list(STEPS))

    def test_observed_orders_are_those_the_errors_were_made_with(self):
        for name, (_, order, *_) in INTEGRATORS.items():
            for n in SIZES:
                with self.subTest(integrator=name, n=n):
                    # Errors are a power of the step to rounding: a relative 1e-15 over a factor of at least 4.
                    self.assertAlmostEqual(self.study().observed_order(name, n), order, delta=1e-12)

    def test_a_wrong_order_is_seen(self):
        self.set_errors("rkmk4", [1e-3 * (5 / steps) ** 3 for steps in STEPS])
        self.assertAlmostEqual(self.study().observed_order("rkmk4", 17), 3, delta=1e-12)

    def test_an_order_is_taken_above_the_floor_only(self):
        self.set_errors("rkmk4", [max(1e-3 * (5 / steps) ** 4, 5e-9) for steps in STEPS])
        self.document["references"][0]["uncertainty"] = 1e-9
        self.assertAlmostEqual(self.study().observed_order("rkmk4", 17), 4, delta=1e-12)

    def test_an_order_needs_three_points(self):
        for kept, told in ((3, True), (2, False), (0, False)):
            with self.subTest(kept=kept):
                self.document["points"] = [each for each in study_document()["points"]
                                           if each["integrator"] != "rkmk4" or each["steps"] in STEPS[:kept]]
                self.assertEqual(self.study().observed_order("rkmk4", 17) is not None, told)

    def test_an_order_needs_steps_that_can_be_told_apart(self):
        # Three counts of steps whose step sizes are the same to the last digit: damage, but each comes to the time.
        self.document["points"] = [each for each in self.document["points"] if each["integrator"] != "rkmk4"
                                   or each["steps"] in STEPS[:3]]
        for index, steps in enumerate(STEPS[:3]):
            self.point("rkmk4", 17, steps).update(steps=10**14 + index, step=5e-14)
        self.assertIsNone(self.study().observed_order("rkmk4", 17))

    def test_an_order_is_that_of_the_smallest_steps(self):
        self.set_errors("rkmk4", [1e-3 * (5 / steps) ** (2 if steps < 50 else 4) for steps in STEPS])
        self.assertAlmostEqual(self.study().observed_order("rkmk4", 17), 4, delta=1e-12)


if __name__ == "__main__":
    unittest.main()
