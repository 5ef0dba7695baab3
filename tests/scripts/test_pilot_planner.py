"""Tests of recommender/trial_planner.py on made-up outcomes: what is tried, what goes on and what is offered.

No pilot is run here, and the module isosyrk is not needed.
"""

import math
import unittest

import programs  # noqa: F401, which makes lib importable

from recommender import trial_planner as pilot_planner
from lib.programs.command_line import Stop
from lib.records.formats import CONVERGED, listed
from recommender.trial_planner import (AIM, BELOW_FAILURE, ENOUGH, FARTHEST, FIRST_TIME, MOST_KEPT, MOST_TRIES,
                                       MOST_UNTRIED, SHARP, STOPPED, Planner, even, invariants_lost, refinement)
from studies.accuracy.cheapest import Question

FAILED = "diverged"


GROUP, RKMK, RK4 = map(listed, ("group2_frame", "rkmk4_frame", "rk4_frame"))


def planner(time=8.0, error=1e-6, norm_B=1.0, candidates=(GROUP, RKMK, RK4), limits=None):
    question = Question("made up", 9, time, error, "nothing")
    return Planner(question, norm_B, list(candidates), limits or dict.fromkeys(candidates, math.inf))


def pilot(plan, kind=GROUP, time=None, steps=80, error=1e-7, seconds=1.0, status=CONVERGED, **others):
    """Returns an Outcome over the part of a planner, or over another time."""
    found = plan.outcome(kind, plan.time if time is None else time, steps, error, seconds, status)
    for name, value in others.items():
        setattr(found, name, value)
    return found


def drive(generator, answer):
    """Sends answer(steps) for each number of steps; returns these, and what the generator returns."""
    asked = []
    try:
        steps = next(generator)
        while True:
            asked.append(steps)
            steps = generator.send(answer(steps))
    except StopIteration as end:
        return asked, end.value


class Losses(unittest.TestCase):
    # A loss that a pilot does not survive, and one that it does, of each invariant.
    LOSSES = {"spectrum_error": (1.1e-8, 9e-9), "skew_defect": (1.1e-8, 9e-9), "energy_error": (1.1, 0.9)}

    def test_each_invariant_that_is_lost_ends_a_pilot(self):
        for name, (lost, kept) in self.LOSSES.items():
            for loss, fails in ((lost, True), (kept, False), (math.nan, True)):
                with self.subTest(name=name, loss=loss):
                    errors = {**dict.fromkeys(self.LOSSES, 0.0), name: loss}
                    self.assertEqual(invariants_lost(errors, isospectral=True), fails)
        # Others than isospectral methods may lose a tenth of the spectrum.
        for loss, fails in ((0.09, False), (0.11, True)):
            errors = {**dict.fromkeys(self.LOSSES, 0.0), "spectrum_error": loss}
            self.assertEqual(invariants_lost(errors, isospectral=False), fails)


class Steps(unittest.TestCase):
    def test_even(self):
        self.assertEqual([even(steps) for steps in (0.1, 2, 2.1, 7, 8, 8.0000000001)], [2, 2, 4, 8, 8, 8])

    def test_refinement_follows_the_order_within_bounds(self):
        self.assertAlmostEqual(refinement(16e-6, 1e-6, GROUP, 0.5), 2.0)
        self.assertAlmostEqual(refinement(16e-6, 1e-6, listed("elp2"), 0.5), 4.0)
        self.assertEqual(refinement(1e-12, 1e-6, GROUP, 0.5), 0.5)
        self.assertEqual(refinement(1.0, 1e-6, GROUP, 0.5, 3.0), 3.0)
        self.assertEqual(refinement(0.0, 1e-6, GROUP, 0.25), 0.25)


class Parts(unittest.TestCase):
    def test_the_first_part_is_short_and_a_power_of_two_of_the_whole(self):
        for time, norm_B in ((1000.0, 1.0), (8.0, 1.0), (100.0, 3.0), (1e-3, 1.0)):
            plan = planner(time, norm_B=norm_B)
            halvings = math.log2(time / plan.time)
            self.assertEqual(halvings, round(halvings))
            if time * norm_B >= 2 * FIRST_TIME:
                self.assertTrue(FIRST_TIME <= plan.time * norm_B < 2 * FIRST_TIME, plan.time)
            else:
                self.assertEqual(plan.time, time)

    def test_a_part_is_lengthened_by_what_the_budget_has_room_for(self):
        for fits, expected in ((1.0, 2.0), (3.9, 2.0), (4.0, 4.0), (9.0, 8.0), (1e6, 64.0)):
            plan = planner(64 * FIRST_TIME)
            first = plan.time
            plan.lengthen(fits)
            self.assertEqual(plan.time / first, expected)

    def test_the_error_over_a_part(self):
        plan = planner(4 * FIRST_TIME)
        self.assertEqual(plan.time, FIRST_TIME)
        plan.uncertainty = 0.0
        self.assertAlmostEqual(plan.error_over_part(GROUP), 1e-6 / 4)
        plan.uncertainty = 1e-7  # below some multiple of which no error can be told
        self.assertAlmostEqual(plan.error_over_part(GROUP), 4e-7)
        plan.uncertainty = 1.0
        self.assertEqual(plan.error_over_part(GROUP), 1e-6)
        plan.trajectory = False
        self.assertLess(0.0, plan.error_over_part(GROUP))
        self.assertEqual(plan.error_over_part(RK4), 0.0)  # it loses the spectrum, whatever its energy does


class Tries(unittest.TestCase):
    def power_law(self, plan, kind, factor, seconds=1e-3):
        """Returns pilots whose error is `factor` times the fourth power of the step."""
        def answer(steps):
            found = pilot(plan, kind, steps=steps, error=factor * (plan.time / steps) ** 4, seconds=seconds * steps)
            plan.pilots.append(found)
            return found
        return answer

    def test_the_longest_step_with_the_error_is_found(self):
        for factor in (1e-6, 1e-3, 1.0):
            plan = planner(8.0)
            asked, best = drive(plan.tries(GROUP, 1e-6, math.inf), self.power_law(plan, GROUP, factor))
            with self.subTest(factor=factor):
                self.assertLessEqual(len(asked), MOST_TRIES)
                self.assertLessEqual(best.error, 1e-6)
                exact = 8.0 * (factor / 1e-6) ** 0.25
                self.assertLessEqual(best.steps, max(2, exact * (AIM * ENOUGH) ** 0.25 + 4))

    def test_a_known_method_begins_at_what_is_expected_of_it(self):
        plan = planner(8.0)
        plan.good[GROUP] = pilot(plan, time=4.0, steps=100, error=1e-6, growth=1.0)
        first = next(plan.tries(GROUP, 1e-6, math.inf))
        self.assertEqual(first, plan.expected(plan.good[GROUP], 8.0, 1e-6, cautious=False).steps)
        self.assertGreater(first, 200)

    def test_after_a_failure_only_shorter_steps_are_tried(self):
        plan = planner(8.0)

        def answer(steps):
            found = pilot(plan, steps=steps, status=FAILED if steps < 100 else CONVERGED, error=1e-9)
            plan.pilots.append(found)
            return found

        asked, best = drive(plan.tries(GROUP, 1e-3, math.inf), answer)
        self.assertTrue(all(later >= earlier * BELOW_FAILURE for earlier, later in zip(asked, asked[1:])), asked)
        self.assertEqual(len(asked), MOST_TRIES)
        self.assertIsNone(best)

    def test_one_that_is_stopped_or_would_take_too_long_ends_it(self):
        plan = planner(8.0)
        asked, best = drive(plan.tries(GROUP, 1e-6, 1.0), lambda steps: pilot(plan, steps=steps, status=STOPPED,
                                                                             error=None))
        self.assertEqual((len(asked), best), (1, None))
        asked, best = drive(plan.tries(GROUP, 1e-6, 1.0), lambda steps: pilot(plan, steps=steps, error=1e-3,
                                                                             seconds=0.9))
        self.assertEqual((len(asked), best), (1, None))
        # The control: with time to spare it is tried again.
        asked, _ = drive(plan.tries(GROUP, 1e-6, 1e3), lambda steps: pilot(plan, steps=steps, error=1e-3, seconds=0.9))
        self.assertEqual(len(asked), MOST_TRIES)

    def test_no_step_is_longer_than_linear_theory_allows(self):
        plan = planner(8.0, limits={GROUP: 0.1, RKMK: math.inf})
        self.assertEqual(plan.longest_step(GROUP), 0.1)
        self.assertGreaterEqual(next(plan.tries(GROUP, 1e-1, math.inf)), 80)


class References(unittest.TestCase):
    def references(self, plan, distances):
        """Drives the refinements with these distances of a pair; returns the steps asked for."""
        left = iter(distances)

        def answer(steps):
            return [pilot(plan, kind, steps=steps) for kind in (GROUP, RKMK)], next(left)

        return drive(plan.refinements(1e-6, RKMK), answer)[0]

    def test_two_are_refined_until_they_agree(self):
        plan = planner()
        asked = self.references(plan, (1e-3, 1e-5, 1e-6 / SHARP))
        self.assertEqual(len(asked), 3)
        self.assertEqual(asked, sorted(set(asked)))
        self.assertEqual((plan.uncertainty, plan.trajectory, plan.unsettled), (1e-6 / SHARP, True, None))
        self.assertEqual(plan.reference.error, 1e-6 / SHARP)
        self.assertEqual(set(plan.good), {GROUP, RKMK})  # both are candidates

    def test_a_pair_that_fails_takes_shorter_steps(self):
        plan = planner()
        asked = self.references(plan, (None, None, 1e-8))
        self.assertEqual([later >= 1.5 * earlier for earlier, later in zip(asked, asked[1:])], [True, True])

    def test_those_that_part_leave_energy_and_spectrum_to_be_judged(self):
        plan = planner()
        plan.good[RK4] = pilot(plan, RK4)
        self.references(plan, [0.5] * (MOST_TRIES + 1))
        self.assertEqual((plan.trajectory, plan.good), (False, {}))
        self.assertIn("differ by 0.5", plan.why)

    def test_rounding_that_hides_the_error_is_refused(self):
        plan = planner(error=1e-12)
        with self.assertRaisesRegex(Stop, "uncertainty"):
            self.references(plan, (1e-9, 0.9e-9))


class Offers(unittest.TestCase):
    def test_the_cheapest_first_and_longer_pilots_before_shorter(self):
        plan = planner()
        for kind, time, seconds in ((GROUP, 8.0, 3.0), (RKMK, 8.0, 2.0), (RK4, 4.0, 0.1)):
            plan.good[kind] = pilot(plan, kind, time=time, seconds=seconds, growth=1.0)
        self.assertEqual([each.integrator for each in plan.ranking()], [RKMK, GROUP, RK4])

    def test_a_run_over_the_whole_time_is_offered_as_it_was(self):
        plan = planner()
        plan.good[GROUP] = pilot(plan, time=8.0)
        (offer,) = plan.ranking()
        self.assertEqual((offer.steps, offer.seconds, offer.error, offer.status), (80, 1.0, 1e-7, CONVERGED))
        self.assertTrue(plan.is_timed(offer))

    def test_steps_over_a_longer_time_are_bounded_and_cost_what_was_timed(self):
        plan = planner(error=1.0, norm_B=10.0, time=0.8)
        plan.good[GROUP] = pilot(plan, time=0.4, steps=2, error=1e-9, growth=1.0)
        (offer,) = plan.ranking()
        self.assertLessEqual(offer.step, MOST_UNTRIED / 10.0)
        self.assertAlmostEqual(offer.seconds, 0.5 * offer.steps)
        self.assertFalse(plan.is_timed(offer))
        plan.paces[GROUP, offer.steps] = 0.25
        (offer,) = plan.ranking()
        self.assertAlmostEqual(offer.seconds, 0.25 * offer.steps)
        self.assertTrue(plan.is_timed(offer))

    def test_shorter_steps_over_a_longer_time_have_the_error_of_their_order(self):
        for kind in (GROUP, listed("elp2")):
            plan = planner(error=1.0, norm_B=20.0, time=0.8, candidates=(kind,))
            plan.good[kind] = pilot(plan, kind, time=0.4, steps=2, error=1e-9, growth=1.0)
            (offer,) = plan.ranking()
            self.assertLess(offer.step, 0.75 * 0.2)
            grown = 1e-9 * plan.growth(plan.good[kind], 0.8)
            self.assertAlmostEqual(offer.error / grown, (offer.step / 0.2) ** kind.order)

    def test_none_is_offered_from_a_pilot_that_is_too_short_or_grew_too_fast(self):
        for time, growth, offered in ((4.0, 1.0, 1), (8.0 / FARTHEST / 1.1, 1.0, 0), (4.0, 3.5, 0)):
            plan = planner()
            plan.good[GROUP] = pilot(plan, time=time, growth=growth)
            self.assertEqual(len(plan.ranking()), offered, (time, growth))

    def test_methods_that_lose_the_spectrum_are_trusted_less(self):
        plan = planner()
        kept, lost = (plan.growth(pilot(plan, kind, time=4.0, growth=1.0), 8.0) for kind in (GROUP, RK4))
        self.assertGreater(lost, 2 * kept)

    def test_a_few_go_on(self):
        kinds = [GROUP._replace(name=f"group{k}_frame") for k in range(1, 9)]
        plan = planner(candidates=kinds)
        plan.good = {kind: pilot(plan, kind, time=8.0, seconds=float(k)) for k, kind in enumerate(kinds[::-1])}
        self.assertEqual(plan.most_promising(), kinds[::-1][:MOST_KEPT])

    def test_without_an_offer_energy_and_spectrum_are_judged(self):
        plan = planner()
        plan.pilots = [pilot(plan, time=2.0, kept=kept, seconds=seconds)
                       for kept, seconds in ((1e-4, 1.0), (1e-9, 2.0))]
        plan.settle()
        self.assertEqual((plan.trajectory, plan.good[GROUP].error), (False, 1e-9))
        # The control: with an offer nothing changes.
        plan = planner()
        plan.good[GROUP] = pilot(plan, time=8.0)
        plan.settle()
        self.assertTrue(plan.trajectory)

    def test_the_nearest_is_that_over_the_longest_part(self):
        plan = planner()
        self.assertIsNone(plan.nearest())
        plan.pilots = [pilot(plan, time=2.0, error=1e-9), pilot(plan, time=4.0, error=1e-3),
                       pilot(plan, time=4.0, error=1e-4), pilot(plan, time=8.0, error=None)]
        self.assertEqual(plan.nearest(), plan.pilots[2])

    def test_statements_say_what_was_extrapolated_and_left(self):
        plan = planner()
        plan.good[GROUP], plan.spent = pilot(plan, time=4.0, growth=1.0), True
        said = " ".join(plan.statements)
        for part in ("end at T = 4", "extrapolated", "these seconds are scaled", "before all pilots were made"):
            self.assertIn(part, said)
        plan.good[GROUP], plan.spent = pilot(plan, time=8.0), False
        self.assertEqual(plan.statements, [])


class Alone(unittest.TestCase):
    def test_the_planner_knows_neither_the_module_nor_the_clock(self):
        with open(pilot_planner.__file__, encoding="utf-8") as file:
            text = file.read()
        for word in ("import isosyrk", "import numpy", "import time", "signal", "seconds_left"):
            self.assertNotIn(word, text)


if __name__ == "__main__":
    unittest.main()
