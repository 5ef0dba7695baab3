"""Properties of the planner of trials, on outcomes that hypothesis draws, and examples.

No trial is run, and no module is needed.
"""

import math
import unittest
from dataclasses import replace
from unittest import mock

import programs  # noqa: F401, which makes lib importable
from hypothesis import strategies as draw
from properties import decades, holds_for

from lib.running import fresh_process
from recommender import trial_planner as trial_planner
from lib.programs.command_line import Stop
from lib.records.formats import CONVERGED, listed, listed_integrators
from lib.running.fresh_process import MAX_STOLEN, MAX_SWITCHES, MAX_TRIES, Disturbance, stolen_seconds, undisturbed
from recommender.trial_planner import (AIM, BELOW_FAILURE, ENOUGH, FARTHEST, FIRST_TIME, FLOOR, MIN_GROWTH,
                                       MIN_GROWTH_OF_OTHERS, MAX_GROWTH, MAX_KEPT, MAX_TRIES as MAX_OF_A_METHOD,
                                       SHARP, STOPPED, Planner, even, invariants_lost, refinement)
from studies.accuracy.cheapest import PREDICTABLE, SMALLEST_ERROR, Outcome, Question

FRAMED = [each for each in listed_integrators().values() if each.co_rotating and each.has_fast_form]
METHODS = draw.sampled_from(FRAMED)
ISOSPECTRAL = draw.sampled_from([each for each in FRAMED if each.isospectral])
ERRORS = decades(-10.0, -2.0)
TIMES = draw.floats(1.0, 1000.0)
NORMS = draw.floats(0.1, 10.0)


def planner(time, error, norm_B, candidates, limit=math.inf):
    question = Question("made up", 9, time, error, "nothing")
    return Planner(question, norm_B, list(candidates), dict.fromkeys(candidates, limit))


def outcome(plan, integrator, time, steps, error, seconds=1.0, status=CONVERGED, growth=1.0):
    return replace(plan.outcome(integrator, time, steps, error, seconds, status), growth=growth)


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


class Steps(unittest.TestCase):
    @holds_for(steps=draw.floats(0.01, 1e6))
    def test_even_is_the_next_even_number(self, steps):
        found = even(steps)
        self.assertEqual(found % 2, 0)
        self.assertTrue(found >= 2 and found >= steps * (1 - 1e-8) and (found == 2 or found - 2 < steps))

    @holds_for(integrator=METHODS, error=ERRORS, wanted=ERRORS, minimum=draw.floats(0.1, 1.0),
               maximum=draw.floats(1.0, 10.0))
    def test_a_refinement_takes_an_error_of_the_order_to_the_wanted_one_within_bounds(self, integrator, error, wanted,
                                                                                      minimum, maximum):
        factor = refinement(error, wanted, integrator, minimum, maximum)
        after = error / factor**integrator.order
        if minimum < factor < maximum:
            self.assertAlmostEqual(after / wanted, 1)
        self.assertTrue(minimum <= factor <= maximum)

    @holds_for(failed=draw.lists(draw.integers(2, 100), max_size=4),
               stopped=draw.lists(draw.integers(2, 100), max_size=2), limit=draw.floats(0.01, 10.0), integrator=METHODS)
    def test_no_step_is_tried_that_theory_excludes_or_that_is_near_a_failure(self, failed, stopped, limit, integrator):
        plan = planner(8.0, 1e-6, 1.0, [integrator], limit)
        for status, steps in (("diverged", failed), (STOPPED, stopped), (CONVERGED, [1])):
            plan.trials += [outcome(plan, integrator, 8.0, each, 1e-3, status=status) for each in steps]
        longest = plan.longest_step(integrator)
        self.assertEqual(longest, min([limit, *(8.0 / steps / BELOW_FAILURE for steps in failed)]))

    @holds_for(**{name: draw.one_of(draw.just(math.nan), draw.floats(0.0, 3.0), draw.floats(0.0, 3e-8))
                  for name in ("spectrum_error", "skew_defect", "energy_error")}, isospectral=draw.booleans())
    def test_each_invariant_that_is_lost_or_no_number_ends_a_trial(self, isospectral, **errors):
        allowed = {"spectrum_error": 1e-8 if isospectral else 0.1, "skew_defect": 1e-8, "energy_error": 1.0}
        kept = [errors[name] <= allowed[name] for name in errors]  # which NaN is not
        self.assertEqual(invariants_lost(errors, isospectral), not all(kept))


class Parts(unittest.TestCase):
    @holds_for(time=TIMES, norm_B=NORMS)
    def test_the_first_part_is_short_and_a_power_of_two_of_the_whole(self, time, norm_B):
        plan = planner(time, 1e-6, norm_B, [listed("group2_frame")])
        halvings = math.log2(time / plan.time)
        self.assertAlmostEqual(halvings, round(halvings))
        self.assertTrue(plan.time == time or FIRST_TIME * (1 - 1e-9) <= plan.time * norm_B < 2 * FIRST_TIME)
        self.assertLess(plan.time * norm_B, max(2 * FIRST_TIME, time * norm_B + 1e-9))

    @holds_for(fits=draw.floats(1.0, 100.0), halvings=draw.integers(1, 8))
    def test_a_longer_part_fits_into_the_budget_if_more_than_twice_as_long(self, fits, halvings):
        plan = planner(2**halvings * FIRST_TIME, 1e-6, 1.0, [listed("group2_frame")])
        before = plan.time
        plan.lengthen(fits)
        ratio = plan.time / before
        self.assertTrue(2 <= ratio <= 2**halvings)
        self.assertLessEqual(ratio, max(2, fits))
        self.assertTrue(ratio == 2**halvings or 2 * ratio > fits)  # and no shorter than need be


class Tries(unittest.TestCase):
    @holds_for(integrator=METHODS, exponent=draw.one_of(draw.floats(-6.0, -1.0), draw.floats(-1.0, 2.0)), error=ERRORS,
               cost=draw.sampled_from((-1.0, 0.5, 1.0)), fails_from=draw.floats(0.5, 5.0), examples=100)
    def test_what_is_found_has_the_error_and_is_the_cheapest_that_was_tried(self, integrator, exponent, error, cost,
                                                                            fails_from):
        plan = planner(8.0, error, 1.0, [integrator])

        def answer(steps):
            """A method of its order that fails with long steps, and whose seconds go like a power of the steps."""
            h = plan.time / steps
            status = CONVERGED if h < fails_from else "diverged"
            found = outcome(plan, integrator, plan.time, steps, 10**exponent * h**integrator.order,
                            steps**cost, status)
            plan.trials.append(found)
            return found

        asked, best = drive(plan.tries(integrator, error, math.inf), answer)
        self.assertLessEqual(len(asked), MAX_OF_A_METHOD)
        good = [each for each in plan.trials if each.status == CONVERGED and each.error <= error]
        self.assertEqual(best, min(good, key=lambda each: each.seconds, default=None))
        for place, trial in enumerate(plan.trials):  # what follows a failure is safely shorter
            for later in plan.trials[place + 1:]:
                if trial.status != CONVERGED:
                    self.assertLessEqual(later.step, trial.step / BELOW_FAILURE * (1 + 1e-9))

    @holds_for(integrator=METHODS, exponent=draw.floats(-6.0, 0.0), error=ERRORS)
    def test_the_last_step_is_near_the_longest_with_the_error(self, integrator, exponent, error):
        plan = planner(8.0, error, 1.0, [integrator])

        def answer(steps):
            return outcome(plan, integrator, 8.0, steps, 10**exponent * (8.0 / steps)**integrator.order, steps)

        asked, best = drive(plan.tries(integrator, error, math.inf), answer)
        if len(asked) < MAX_OF_A_METHOD and best and best.steps > 20:
            self.assertGreater(best.error, error / ENOUGH / AIM * 0.5)


class References(unittest.TestCase):
    @holds_for(ratios=draw.lists(draw.one_of(draw.none(), decades(-2.0, 2.0)), min_size=1, max_size=8),
               error=decades(-8.0, -3.0), examples=100)
    def test_the_uncertainty_is_far_below_the_error_or_as_small_as_it_gets(self, ratios, error):
        first, second = map(listed, ("group6_frame", "group5_frame"))
        plan = planner(8.0, error, 1.0, [first, second])
        left = iter([*(ratio and ratio * error for ratio in ratios), *[1e-15] * 20])
        seen = []

        def answer(steps):
            seen.append(next(left))
            return [outcome(plan, kind, plan.time, steps, None) for kind in (first, second)], seen[-1]

        try:
            asked, _ = drive(plan.refinements(error, second), answer)
        except Stop:
            self.assertTrue(error < plan.uncertainty <= FLOOR)  # rounding hides the error
            return
        self.assertEqual(asked, sorted(set(asked)))  # each pair has shorter steps
        found = [each for each in seen if each is not None]
        self.assertEqual(plan.uncertainty, found[-1])
        came_closer = [later <= earlier / 2 for earlier, later in zip(found, found[1:])]
        self.assertTrue(found[-1] <= error / SHARP or not came_closer[-1])
        self.assertFalse([each for each in found[:-1] if each <= error / SHARP])
        self.assertEqual(plan.trajectory, found[-1] <= max(FLOOR, error) and found[-1] <= PREDICTABLE)


class Offers(unittest.TestCase):
    @holds_for(integrator=METHODS, error=ERRORS, steps=draw.integers(2, 200), growth=draw.floats(0.0, 4.0),
               ratio=draw.floats(1.0, 4.0), further=draw.floats(1.0, 2.0))
    def test_an_error_grows_with_time_and_no_less_if_cautious(self, integrator, error, steps, growth, ratio, further):
        plan = planner(8.0, 1e-6, 1.0, [integrator])
        trial = outcome(plan, integrator, 2.0, steps, error, growth=growth)
        cautious, other = (plan.growth(trial, ratio * 2.0, cautious) for cautious in (True, False))
        self.assertTrue(1 - 1e-12 <= other <= cautious * (1 + 1e-12))
        self.assertLessEqual(cautious, plan.growth(trial, further * ratio * 2.0) * (1 + 1e-12))
        seen = max(1.0, growth)
        self.assertAlmostEqual(other, ratio**min(seen, MAX_GROWTH))
        minimum = MIN_GROWTH if integrator.isospectral else MIN_GROWTH_OF_OTHERS
        self.assertGreaterEqual(cautious * (1 + 1e-12), ratio**max(minimum, seen))
        # An exponential whose doubling the halves of the trial show.
        self.assertGreaterEqual(cautious * (1 + 1e-12), 2**(2 * seen * (ratio - 1)))

    @holds_for(integrator=METHODS, error=ERRORS, wanted=ERRORS, steps=draw.integers(2, 400), norm_B=NORMS,
               ratio=draw.floats(1.01, 4.0), pace=draw.floats(1e-4, 1.0), limit=draw.floats(0.02, 10.0))
    def test_an_offer_has_the_error_and_the_seconds_of_its_own_steps(self, integrator, error, wanted, steps, norm_B,
                                                                     ratio, pace, limit):
        plan = planner(2.0 * ratio, wanted, norm_B, [integrator], limit)
        trial = outcome(plan, integrator, 2.0, steps, error, seconds=pace * steps)
        found = plan.expected(trial, plan.question.time, wanted)
        grown = max(error, SMALLEST_ERROR) * plan.growth(trial, plan.question.time)
        self.assertAlmostEqual(found.error / (grown * (found.step / trial.step)**integrator.order), 1)
        self.assertLessEqual(found.error, wanted * (1 + 1e-9))
        self.assertLessEqual(found.step, min(limit, trial_planner.MAX_UNTRIED / norm_B) * (1 + 1e-8))
        self.assertAlmostEqual(found.seconds / (pace * found.steps), 1)
        plan.paces[integrator, found.steps] = 3 * pace  # as timed
        self.assertAlmostEqual(plan.expected(trial, plan.question.time, wanted).seconds / (3 * pace * found.steps), 1)

    @holds_for(trials=draw.lists(draw.tuples(draw.integers(0, len(FRAMED) - 1), draw.sampled_from((1.0, 2.0, 5.0, 8.0)),
                                             draw.floats(0.1, 10.0), draw.floats(0.5, 5.0)), max_size=12))
    def test_offers_follow_from_long_enough_trials_the_longest_and_cheapest_first(self, trials):
        plan = planner(8.0, 1e-3, 1.0, FRAMED)
        for place, time, seconds, growth in trials:
            plan.good[FRAMED[place]] = outcome(plan, FRAMED[place], time, 80, 1e-9, seconds, growth=growth)
        offers = plan.ranking()
        trusted = {each for each, trial in plan.good.items()
                   if trial.time == 8.0 or (8.0 <= FARTHEST * trial.time and trial.growth <= MAX_GROWTH)}
        self.assertEqual({each.integrator for each in offers}, trusted)
        order = [(-plan.good[each.integrator].time, each.seconds) for each in offers]
        self.assertEqual(order, sorted(order))
        found = plan.most_promising()
        expected = {each: plan.expected(trial, 8.0, 1e-3, cautious=False).seconds for each, trial in plan.good.items()}
        self.assertEqual([expected[each] for each in found], sorted(expected.values())[:MAX_KEPT])

    @holds_for(tried=draw.floats(1.0, 8.0), steps=draw.integers(2, 400), distance=ERRORS, wanted=ERRORS)
    def test_references_that_part_over_a_longer_time_refute_an_offer_with_longer_steps(self, tried, steps, distance,
                                                                                      wanted):
        kind = listed("group2_frame")
        plan = planner(8.0, wanted, 1.0, [kind])
        trial = outcome(plan, kind, 5.0, 50, 1e-9)
        offer = Outcome(kind, 9, 8.0, 80, 1e-9, 1.0)
        plan.unsettled = outcome(plan, kind, tried, steps, distance)
        refuted = tried > 5.0 and distance > wanted and plan.unsettled.step <= offer.step
        self.assertEqual(plan.is_refuted(offer, trial), refuted)
        self.assertFalse(plan.is_refuted(offer, replace(offer, growth=9.0)))  # over the whole time it was seen


class Disturbances(unittest.TestCase):
    DISTURBED = draw.builds(Disturbance, draw.floats(0.0, 2 * MAX_STOLEN), draw.floats(0.0, 2 * MAX_SWITCHES))

    @holds_for(tries=draw.lists(DISTURBED, min_size=MAX_TRIES, max_size=MAX_TRIES))
    def test_the_first_quiet_try_is_taken_or_else_the_least_disturbed(self, tries):
        for each in tries:
            self.assertEqual(bool(each), each.stolen > MAX_STOLEN or each.switches > MAX_SWITCHES)
            self.assertEqual(bool(each), each.size > 1)
        left, told = list(tries), []
        found, _ = undisturbed(lambda: (left[0], left.pop(0)), told.append)
        quiet = [each for each in tries if not each]
        self.assertEqual(found, quiet[0] if quiet else min(tries, key=lambda each: each.size))
        self.assertEqual(len(told), tries.index(quiet[0]) if quiet else MAX_TRIES)

    @holds_for(cores=draw.dictionaries(draw.integers(0, 40), draw.tuples(*[draw.integers(0, 10**9)] * 10), max_size=4),
               core=draw.integers(0, 40))
    def test_stolen_seconds_are_the_eighth_number_of_the_core(self, cores, core):
        """Those of proc(5): user, nice, system, idle, iowait, irq, softirq, steal, guest and guest_nice."""
        stat = "cpu  9 9 9 9 9 9 9 9 9 9\n" + "".join(f"cpu{each} {' '.join(map(str, found))}\n"
                                                      for each, found in cores.items())
        with mock.patch("builtins.open", mock.mock_open(read_data=stat)):
            ticks = stolen_seconds(core) * fresh_process.os.sysconf("SC_CLK_TCK")
        self.assertAlmostEqual(ticks, cores.get(core, [0] * 8)[7], delta=1e-3)


GROUP, RKMK, RK4 = map(listed, ("group2_frame", "rkmk4_frame", "rk4_frame"))


def some(time=8.0, error=1e-6):
    """Returns a Planner of three methods."""
    return planner(time, error, 1.0, (GROUP, RKMK, RK4))


def trial(plan, kind=GROUP, time=None, steps=80, error=1e-7, seconds=1.0, status=CONVERGED, **others):
    """Returns an Outcome over the part of a planner, or over another time."""
    return replace(plan.outcome(kind, plan.time if time is None else time, steps, error, seconds, status), **others)


class Examples(unittest.TestCase):
    """What follows from one outcome or two."""

    def test_the_error_over_a_part(self):
        plan = some(4 * FIRST_TIME)
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

    def test_a_known_method_begins_at_what_is_expected_of_it(self):
        plan = some(8.0)
        plan.good[GROUP] = trial(plan, time=4.0, steps=100, error=1e-6, growth=1.0)
        first = next(plan.tries(GROUP, 1e-6, math.inf))
        self.assertEqual(first, plan.expected(plan.good[GROUP], 8.0, 1e-6, cautious=False).steps)
        self.assertGreater(first, 200)

    def test_one_that_is_stopped_or_would_take_too_long_ends_it(self):
        plan = some(8.0)
        asked, best = drive(plan.tries(GROUP, 1e-6, 1.0), lambda steps: trial(plan, steps=steps, status=STOPPED,
                                                                             error=None))
        self.assertEqual((len(asked), best), (1, None))
        asked, best = drive(plan.tries(GROUP, 1e-6, 1.0), lambda steps: trial(plan, steps=steps, error=1e-3,
                                                                             seconds=0.9))
        self.assertEqual((len(asked), best), (1, None))
        # The control: with time to spare it is tried again.
        asked, _ = drive(plan.tries(GROUP, 1e-6, 1e3), lambda steps: trial(plan, steps=steps, error=1e-3, seconds=0.9))
        self.assertEqual(len(asked), MAX_OF_A_METHOD)

    def references(self, plan, distances):
        """Drives the refinements with these distances of a pair; returns the steps asked for."""
        left = iter(distances)

        def answer(steps):
            return [trial(plan, kind, steps=steps) for kind in (GROUP, RKMK)], next(left)

        return drive(plan.refinements(1e-6, RKMK), answer)[0]

    def test_those_that_part_leave_energy_and_spectrum_to_be_judged(self):
        plan = some()
        plan.good[RK4] = trial(plan, RK4)
        self.references(plan, [0.5] * (MAX_OF_A_METHOD + 1))
        self.assertEqual((plan.trajectory, plan.good), (False, {}))
        self.assertIn("differ by 0.5", plan.why)

    def test_a_run_over_the_whole_time_is_offered_as_it_was(self):
        plan = some()
        plan.good[GROUP] = trial(plan, time=8.0)
        (offer,) = plan.ranking()
        self.assertEqual((offer.steps, offer.seconds, offer.error, offer.status), (80, 1.0, 1e-7, CONVERGED))
        self.assertTrue(plan.is_timed(offer))

    def test_without_an_offer_energy_and_spectrum_are_judged(self):
        plan = some()
        plan.trials = [trial(plan, time=2.0, kept=kept, seconds=seconds)
                       for kept, seconds in ((1e-4, 1.0), (1e-9, 2.0))]
        plan.settle()
        self.assertEqual((plan.trajectory, plan.good[GROUP].error), (False, 1e-9))
        # The control: with an offer nothing changes.
        plan = some()
        plan.good[GROUP] = trial(plan, time=8.0)
        plan.settle()
        self.assertTrue(plan.trajectory)

    def test_the_nearest_is_that_over_the_longest_part(self):
        plan = some()
        self.assertIsNone(plan.nearest())
        plan.trials = [trial(plan, time=2.0, error=1e-9), trial(plan, time=4.0, error=1e-3),
                       trial(plan, time=4.0, error=1e-4), trial(plan, time=8.0, error=None)]
        self.assertEqual(plan.nearest(), plan.trials[2])

    def test_statements_say_what_was_extrapolated_and_left(self):
        plan = some()
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
