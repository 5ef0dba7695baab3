"""Properties of trials, of the search and the timing of comparisons, and of what studies time, for outcomes that
hypothesis draws.

Run with: python3 -m unittest test_trial_properties (in tests/scripts; the module is that of ISOSYRK_BUILD or build/)
"""

import math
import os
import random
import sys
import unittest
from types import SimpleNamespace
from unittest import mock

from hypothesis import strategies as draw
from programs import BUILD
from properties import SEEDS, decades, holds_for, times_of_rows

sys.path.insert(0, os.path.join(BUILD, "python"))

import isosyrk  # noqa: F401 (CTest leaves this file out where there is no module)
from studies.accuracy import comparisons as comparisons
from lib.running import timed, trials
from lib.running.checkpoint import Checkpoint
from lib.judging import verdicts
from lib.records.settings import Problem
from lib.records.formats import CONVERGED
from lib.running.trials import CLOSE, FAILURES_THAT_END, GRID_START, GRID_STEP, LARGEST_STEP, LONG_CLOSE, SMALLEST_STEP

FAILED = "diverged"
EDGES = draw.lists(decades(-2.5, 2.5), min_size=0, max_size=5).map(sorted)


def works_at(edges, h_norm_B):
    """Tells whether a step works where steps do up to the first edge, and again from the second to the third …"""
    return sum(edge < h_norm_B for edge in edges) % 2 == 0 and bool(edges)


class Trials(unittest.TestCase):
    @holds_for(edges=EDGES, examples=200)
    def test_the_grid_goes_on_until_so_many_steps_in_a_row_fail(self, edges):
        tried = []

        def outcome(h_norm_B):
            tried.append(h_norm_B)
            return CONVERGED if works_at(edges, h_norm_B) else FAILED

        found = trials.grid_of(outcome)
        self.assertEqual(list(found), sorted(tried))
        self.assertEqual(len(set(tried)), len(tried))
        for one, other in zip(found, list(found)[1:]):
            self.assertAlmostEqual(other / one, GRID_STEP)
        self.assertLessEqual(max(tried), LARGEST_STEP)
        self.assertTrue(found[min(found)] == CONVERGED or min(found) <= SMALLEST_STEP)
        works = [each == CONVERGED for each in found.values()]
        runs = [works[place:place + FAILURES_THAT_END] for place in range(len(works) - FAILURES_THAT_END + 1)]
        ends = [place for place, run in enumerate(runs) if not any(run)]
        if max(tried) * GRID_STEP <= LARGEST_STEP:
            self.assertTrue(ends and ends[0] == len(runs) - 1 or not any(works[1:]) or min(tried) < GRID_START)

    @holds_for(edges=EDGES.filter(bool), examples=150)
    def test_a_critical_step_is_between_one_that_works_and_one_that_fails(self, edges):
        def outcome(h_norm_B):
            return CONVERGED if works_at(edges, h_norm_B) else FAILED

        outcomes, bracket = trials.critical(outcome)
        first = trials.first_failure(outcomes)
        self.assertEqual(bracket is None, first is None)
        if not bracket:
            return
        works, fails, how = bracket
        self.assertEqual((outcome(works), outcome(fails), how), (CONVERGED, FAILED, FAILED))
        self.assertTrue(1 < fails / works <= CLOSE)
        self.assertTrue(first[0] <= works < fails <= first[1])
        below = [each for each in outcomes if each <= first[0]]  # nothing failed below but at the start
        place = next(k for k, each in enumerate(below) if outcomes[each] == CONVERGED)
        self.assertTrue(all(outcomes[each] == CONVERGED for each in below[place:]))

    @holds_for(edge=decades(-3.0, 1.0), works=draw.floats(0.5, 5.0))
    def test_a_step_that_survives_works_and_is_no_longer_than_the_critical_one(self, edge, works):
        def outcome(h_norm_B):
            return CONVERGED if h_norm_B <= edge else "energy lost"

        bracket = (works, 1.02 * works, FAILED)
        found = trials.survived(outcome, bracket)
        if works <= edge:
            self.assertEqual(found, bracket)
        elif found is None:
            self.assertLess(edge, SMALLEST_STEP * GRID_STEP)
        else:
            self.assertTrue(found[0] <= edge < found[1] <= LONG_CLOSE * found[0])
            self.assertEqual(found[2], "energy lost")


def drawn_run(steps, error, usable=True):
    return SimpleNamespace(steps=steps, error=error if usable else None, usable=usable)


class Comparisons(unittest.TestCase):
    @holds_for(order=draw.integers(2, 10), needed=draw.integers(2, 400), first=draw.integers(2, 400), seed=SEEDS)
    def test_the_fewest_steps_that_reach_an_error_are_found(self, order, needed, first, seed):
        noise = random.Random(seed)
        factors = {}

        def look(steps):
            factors.setdefault(steps, noise.uniform(0.98, 1.0))
            return drawn_run(steps, 1e-6 * (needed / steps) ** order * factors[steps], steps >= needed / 3)

        found = comparisons.fewest_steps(look, first, 1e-6, order)
        if found is None:
            self.assertGreater(needed, first)  # far more than it begins with
            self.assertGreater(needed, comparisons.MAX_MORE * first / comparisons.FURTHER)
            return
        self.assertLessEqual(found.error, 1e-6)
        self.assertTrue(needed * 0.98 <= found.steps <= math.ceil(max(needed + 1, comparisons.CLOSE * needed + 1)))

    @holds_for(errors=draw.lists(draw.one_of(draw.none(), decades(-9.0, -3.0)), min_size=1, max_size=1))
    def test_a_run_that_misses_the_error_or_fails_does_not_reach_it(self, errors):
        (error,) = errors
        reached = comparisons.is_reached(1e-6, drawn_run(9, error, error is not None))
        self.assertEqual(reached, error is not None and error <= 1e-6)

    @holds_for(rows=draw.lists(draw.tuples(draw.sampled_from((17, 33)), draw.sampled_from((1e-4, 1e-6)),
                                           draw.sampled_from(("gauss", "rk4")), decades(-3.0, 1.0)), max_size=12))
    def test_of_each_class_the_fastest_stands(self, rows):
        made = [{**Problem("smooth", 5.0, n)._asdict(), "wanted": wanted, "candidate": candidate, "place": place}
                for place, (n, wanted, candidate, _) in enumerate(rows)]
        found = comparisons.standing(made, [seconds for *_, seconds in rows])
        keys = [(row["n"], row["wanted"], row["candidate"]) for row in found]
        self.assertEqual(len(set(keys)), len(keys))
        self.assertEqual(set(keys), {row[:3] for row in rows})
        for row, key in zip(found, keys):
            self.assertEqual(rows[row["place"]][3], min(row[3] for row in rows if row[:3] == key))

    @holds_for(times=times_of_rows(rows=3, maximum=14), maximum=draw.integers(2, 14), done=draw.integers(0, 14))
    def test_a_row_goes_on_until_it_is_told_from_the_best_explicit_one(self, times, maximum, done):
        seconds = dict(zip(("explicit", "gauss", "elp"), (row[:done] for row in times)))
        count = len(seconds["explicit"])
        found = comparisons.further_processes(maximum, seconds)
        self.assertEqual(found["explicit"], max(found["gauss"], found["elp"]))
        for row in ("gauss", "elp"):
            self.assertTrue(0 <= found[row] <= max(0, maximum - count))
            if count >= verdicts.FEWEST:
                said = verdicts.compared(seconds["explicit"], seconds[row])
                self.assertEqual(bool(found[row]),
                                 said == verdicts.UNDECIDED and count < min(maximum, verdicts.MAXIMUM))
        stopped = {**seconds, "explicit": [*seconds["explicit"], 1.0, 1.0]}
        self.assertEqual(comparisons.further_processes(maximum, stopped)["gauss"], 0)  # and does not begin again

    @holds_for(seconds=draw.lists(decades(-4.0, -1.0), min_size=2, max_size=2))
    def test_the_least_repetition_is_the_time_of_a_process(self, seconds):
        block = {"problem": ("smooth", 1.0, 9), "references": None, "process": 0, "rows": ["one"],
                 "runs": {"one": {"steps": 4, "integrator": "rk4", "solver": "fast"}}}
        with mock.patch.object(comparisons, "scene_of"), mock.patch.object(comparisons.isosyrk, "integrator"), \
                mock.patch.object(comparisons.timed, "seconds_of", side_effect=seconds):
            self.assertEqual(comparisons.time_block(block), [min(seconds)])


class Times(unittest.TestCase):
    @holds_for(seconds=decades(-7.0, 1.0), warmup=draw.integers(0, 40))
    def test_a_short_run_is_repeated_until_it_fills_some_time_each_as_warm_as_the_first(self, seconds, warmup):
        calls = []

        def timed_run(W, h, steps, repetitions, warmup=0):
            calls.append((repetitions, warmup))
            return [seconds] * repetitions

        found = timed.seconds_of(SimpleNamespace(timed_run=timed_run), None, 0.1, 5, warmup)
        self.assertAlmostEqual(found / seconds, 1)
        self.assertEqual({each for _, each in calls}, {warmup})
        self.assertEqual(len(calls) > 1, seconds < timed.MIN_SECONDS)
        if len(calls) > 1:
            self.assertGreaterEqual(calls[-1][0] * max(seconds, 1e-6), timed.MIN_SECONDS * (1 - 1e-9))

    @holds_for(seconds=draw.lists(decades(-3.0, 1.0), min_size=1, max_size=5), repetitions=draw.integers(1, 5),
               done=draw.integers(0, 10))
    def test_points_are_timed_in_turns_on_the_last_core_until_that_is_enough(self, seconds, repetitions, done):
        cores, run, on = os.sched_getaffinity(0), [], set()
        checkpoint = SimpleNamespace(context={}, found={}, key_of_timed=lambda what, point: f"{what} {point}")
        checkpoint.add = checkpoint.found.__setitem__

        def time_one(point):
            run.append(point)
            on.update(os.sched_getaffinity(0))
            return seconds[point]

        points = list(range(len(seconds)))
        with mock.patch.object(timed, "progress", lambda total, what: mock.MagicMock()):
            found = timed.interleaved(points, repetitions, time_one, checkpoint, "timings")
            self.assertEqual((on, os.sched_getaffinity(0)), ({max(cores)}, cores))  # and all cores again
            for point, times in zip(points, found):
                maximum = next((k for k in range(1, repetitions) if k * seconds[point] >= timed.ENOUGH), repetitions)
                self.assertEqual(len(times), maximum)
            turns = [[point for point in points if len(found[point]) > turn] for turn in range(repetitions)]
            self.assertEqual(run, [point for turn in turns for point in turn])  # all once, then all again
            # What stands in the checkpoint is not timed again.
            kept = dict(list(checkpoint.found.items())[:done])
            checkpoint.found.clear()
            checkpoint.found.update(kept)
            count = len(run)
            self.assertEqual(timed.interleaved(points, repetitions, time_one, checkpoint, "timings"), found)
            self.assertEqual(len(run) - count, max(0, count - done))

    @holds_for(sizes=draw.dictionaries(draw.integers(5, 300), draw.sampled_from(("eigen", "openblas", "split")),
                                       min_size=1, max_size=5), n=draw.integers(5, 1100))
    def test_published_forms_take_the_backend_of_the_nearest_n(self, sizes, n):
        checkpoint = object.__new__(Checkpoint)
        checkpoint.context = {"products": "the faster by measurement: " + ", ".join(
            f"n={tried} {backend}" for tried, backend in sizes.items())}
        nearest = min(abs(tried - n) for tried in sizes)
        self.assertIn(checkpoint.products(n), {sizes[tried] for tried in sizes if abs(tried - n) == nearest})


if __name__ == "__main__":
    unittest.main()
