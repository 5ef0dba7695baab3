"""Tests of recommender/trial_planner.py on made-up outcomes: what is tried, what goes on and what is offered.

No trial is run here, and the module isosyrk is not needed.
"""

import math
import unittest

import programs  # noqa: F401, which makes lib importable

from recommender import trial_planner as trial_planner
from lib.programs.command_line import Stop
from lib.records.formats import CONVERGED, listed
from recommender.trial_planner import FIRST_TIME, MAX_TRIES, STOPPED, Planner
from studies.accuracy.cheapest import Question

FAILED = "diverged"


GROUP, RKMK, RK4 = map(listed, ("group2_frame", "rkmk4_frame", "rk4_frame"))


def planner(time=8.0, error=1e-6, norm_B=1.0, candidates=(GROUP, RKMK, RK4), limits=None):
    question = Question("made up", 9, time, error, "nothing")
    return Planner(question, norm_B, list(candidates), limits or dict.fromkeys(candidates, math.inf))


def trial(plan, kind=GROUP, time=None, steps=80, error=1e-7, seconds=1.0, status=CONVERGED, **others):
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


class Parts(unittest.TestCase):
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
    def test_a_known_method_begins_at_what_is_expected_of_it(self):
        plan = planner(8.0)
        plan.good[GROUP] = trial(plan, time=4.0, steps=100, error=1e-6, growth=1.0)
        first = next(plan.tries(GROUP, 1e-6, math.inf))
        self.assertEqual(first, plan.expected(plan.good[GROUP], 8.0, 1e-6, cautious=False).steps)
        self.assertGreater(first, 200)

    def test_one_that_is_stopped_or_would_take_too_long_ends_it(self):
        plan = planner(8.0)
        asked, best = drive(plan.tries(GROUP, 1e-6, 1.0), lambda steps: trial(plan, steps=steps, status=STOPPED,
                                                                             error=None))
        self.assertEqual((len(asked), best), (1, None))
        asked, best = drive(plan.tries(GROUP, 1e-6, 1.0), lambda steps: trial(plan, steps=steps, error=1e-3,
                                                                             seconds=0.9))
        self.assertEqual((len(asked), best), (1, None))
        # The control: with time to spare it is tried again.
        asked, _ = drive(plan.tries(GROUP, 1e-6, 1e3), lambda steps: trial(plan, steps=steps, error=1e-3, seconds=0.9))
        self.assertEqual(len(asked), MAX_TRIES)

    def test_no_step_is_longer_than_linear_theory_allows(self):
        plan = planner(8.0, limits={GROUP: 0.1, RKMK: math.inf})
        self.assertEqual(plan.longest_step(GROUP), 0.1)
        self.assertGreaterEqual(next(plan.tries(GROUP, 1e-1, math.inf)), 80)


class References(unittest.TestCase):
    def references(self, plan, distances):
        """Drives the refinements with these distances of a pair; returns the steps asked for."""
        left = iter(distances)

        def answer(steps):
            return [trial(plan, kind, steps=steps) for kind in (GROUP, RKMK)], next(left)

        return drive(plan.refinements(1e-6, RKMK), answer)[0]

    def test_a_pair_that_fails_takes_shorter_steps(self):
        plan = planner()
        asked = self.references(plan, (None, None, 1e-8))
        self.assertEqual([later >= 1.5 * earlier for earlier, later in zip(asked, asked[1:])], [True, True])

    def test_those_that_part_leave_energy_and_spectrum_to_be_judged(self):
        plan = planner()
        plan.good[RK4] = trial(plan, RK4)
        self.references(plan, [0.5] * (MAX_TRIES + 1))
        self.assertEqual((plan.trajectory, plan.good), (False, {}))
        self.assertIn("differ by 0.5", plan.why)

    def test_rounding_that_hides_the_error_is_refused(self):
        plan = planner(error=1e-12)
        with self.assertRaisesRegex(Stop, "uncertainty"):
            self.references(plan, (1e-9, 0.9e-9))


class Offers(unittest.TestCase):
    def test_a_run_over_the_whole_time_is_offered_as_it_was(self):
        plan = planner()
        plan.good[GROUP] = trial(plan, time=8.0)
        (offer,) = plan.ranking()
        self.assertEqual((offer.steps, offer.seconds, offer.error, offer.status), (80, 1.0, 1e-7, CONVERGED))
        self.assertTrue(plan.is_timed(offer))

    def test_without_an_offer_energy_and_spectrum_are_judged(self):
        plan = planner()
        plan.trials = [trial(plan, time=2.0, kept=kept, seconds=seconds)
                       for kept, seconds in ((1e-4, 1.0), (1e-9, 2.0))]
        plan.settle()
        self.assertEqual((plan.trajectory, plan.good[GROUP].error), (False, 1e-9))
        # The control: with an offer nothing changes.
        plan = planner()
        plan.good[GROUP] = trial(plan, time=8.0)
        plan.settle()
        self.assertTrue(plan.trajectory)

    def test_the_nearest_is_that_over_the_longest_part(self):
        plan = planner()
        self.assertIsNone(plan.nearest())
        plan.trials = [trial(plan, time=2.0, error=1e-9), trial(plan, time=4.0, error=1e-3),
                       trial(plan, time=4.0, error=1e-4), trial(plan, time=8.0, error=None)]
        self.assertEqual(plan.nearest(), plan.trials[2])

    def test_statements_say_what_was_extrapolated_and_left(self):
        plan = planner()
        plan.good[GROUP], plan.spent = trial(plan, time=4.0, growth=1.0), True
        said = " ".join(plan.statements)
        for part in ("end at T = 4", "extrapolated", "these seconds are scaled", "before all trials were made"):
            self.assertIn(part, said)
        plan.good[GROUP], plan.spent = trial(plan, time=8.0), False
        self.assertEqual(plan.statements, [])


class Alone(unittest.TestCase):
    def test_the_planner_knows_neither_the_module_nor_the_clock(self):
        with open(trial_planner.__file__, encoding="utf-8") as file:
            text = file.read()
        for word in ("import isosyrk", "import numpy", "import time", "signal", "seconds_left"):
            self.assertNotIn(word, text)


if __name__ == "__main__":
    unittest.main()
