"""Properties of verdicts on speed, and of claims, for times that hypothesis draws."""

import itertools
import math
import unittest
from unittest import mock

from hypothesis import strategies as draw
from properties import NEAR_ONE, PACES, fails, holds_for, times_of_rows
from scipy import stats

from lib.judging import verdicts
from lib.records.formats import FORMULATIONS
from lib.records.table_file import CellKey, Measurement, Run, measurement
from studies.tables.judge import judged, pairs
from lib.judging.verdicts import (FAILS, FASTER, FEWEST, HOLDS, LEVEL, MARGIN, MAXIMUM, SLOWER, TIE, UNDECIDED,
                                  claim_of_fastest, claim_of_multiple, compared, fastest, further_processes, level_rows,
                                  more_processes, ratio_of, student_t, within)

MIRRORED = {FASTER: SLOWER, SLOWER: FASTER, TIE: TIE, UNDECIDED: UNDECIDED}
FACTORS = draw.floats(1.0, 1.5)


def exactly(ratio):
    """Returns the verdict on a ratio that is known without noise."""
    return FASTER if ratio < 1 / MARGIN else SLOWER if ratio > MARGIN else TIE


def exchange(times):
    row, other = times
    assert compared(other, row) == MIRRORED[compared(row, other)]


class Verdicts(unittest.TestCase):
    @holds_for(times=times_of_rows())
    def test_two_rows_that_are_exchanged_have_the_mirrored_verdict(self, times):
        exchange(times)
        found, inverse = map(ratio_of, times, times[::-1])
        self.assertAlmostEqual(found.ratio * inverse.ratio, 1.0)
        if found.processes > 1:  # one has no interval
            self.assertAlmostEqual(found.low * inverse.high, 1.0)

    @holds_for(times=times_of_rows(minimum=FEWEST), pace=PACES, shuffled=draw.randoms(use_true_random=False))
    def test_neither_the_pace_of_a_process_nor_the_order_of_processes_counts(self, times, pace, shuffled):
        said = compared(*times)
        self.assertEqual(compared([pace * times[0][0], *times[0][1:]], [pace * times[1][0], *times[1][1:]]), said)
        self.assertEqual(compared(*([pace * each for each in row] for row in times)), said)
        processes = list(zip(*times))
        shuffled.shuffle(processes)
        self.assertEqual(compared(*zip(*processes)), said)

    @holds_for(times=times_of_rows(), maximum=draw.integers(0, FEWEST - 1))
    def test_few_processes_decide_nothing(self, times, maximum):
        if maximum:
            self.assertEqual(compared(*(row[:maximum] for row in times)), UNDECIDED)

    @holds_for(ratio=NEAR_ONE, count=draw.integers(FEWEST, MAXIMUM), pace=PACES)
    def test_a_ratio_without_noise_is_decided_by_the_margin(self, ratio, count, pace):
        self.assertEqual(compared([ratio * pace] * count, [pace] * count), exactly(ratio))

    @holds_for(times=times_of_rows(minimum=FEWEST), examples=150)
    def test_a_verdict_is_that_of_every_ratio_within_the_interval_or_undecided(self, times):
        found = ratio_of(*times)
        self.assertTrue(found.low <= found.ratio * (1 + 1e-12) and found.ratio <= found.high * (1 + 1e-12))
        at_ends = {exactly(found.low), exactly(found.high)}
        self.assertEqual(compared(*times), at_ends.pop() if len(at_ends) == 1 else UNDECIDED)

    @holds_for(times=times_of_rows(minimum=FEWEST), factor=FACTORS)
    def test_what_is_slower_stays_so_when_it_gets_slower(self, times, factor):
        row, other = times
        said, later = compared(row, other), compared([factor * each for each in row], other)
        if SLOWER in (said, later):
            self.assertEqual(later, SLOWER if said == SLOWER else later)
            self.assertNotEqual(later, FASTER)
        if later == FASTER:
            self.assertEqual(said, FASTER)

    @holds_for(times=times_of_rows(minimum=2))
    def test_the_interval_is_that_of_student_on_the_logarithms(self, times):
        logarithms = [math.log(each / other) for each, other in zip(*times)]
        found, count = ratio_of(*times), len(logarithms)
        middle, error = sum(logarithms) / count, stats.sem(logarithms)
        low, high = (stats.t.interval(LEVEL, count - 1, middle, error) if error > 1e-12 else (middle, middle))
        for each, expected in ((found.ratio, middle), (found.low, low), (found.high, high)):
            self.assertAlmostEqual(math.log(each), expected, delta=1e-9)

    @holds_for(freedom=draw.integers(1, 50), t=draw.floats(0.0, 50.0), level=draw.floats(0.5, 0.999), examples=40)
    def test_quantiles_are_those_of_student_s_distribution(self, freedom, t, level):
        self.assertAlmostEqual(within(t, freedom), stats.t.cdf(t, freedom) - stats.t.cdf(-t, freedom), delta=1e-10)
        self.assertAlmostEqual(student_t(level, freedom) / stats.t.ppf((1 + level) / 2, freedom), 1, delta=1e-8)

    def test_wrong_rules_are_seen(self):  # the controls
        with mock.patch.object(verdicts, "FEWEST", 2):
            self.assertTrue(fails(lambda times: self.assertEqual(compared(*times), UNDECIDED),
                                  times=times_of_rows(minimum=2, maximum=5)))
        one_sided = mock.patch.dict(MIRRORED, {UNDECIDED: TIE})
        with one_sided:
            self.assertTrue(fails(exchange, times=times_of_rows(minimum=FEWEST)))


class Processes(unittest.TestCase):
    @holds_for(verdicts_on=draw.lists(draw.lists(draw.sampled_from((FASTER, SLOWER, TIE, UNDECIDED)), max_size=4),
                                      min_size=20, max_size=20))
    def test_they_are_added_until_all_is_decided_or_there_are_most(self, verdicts_on):
        done = 0
        for said in verdicts_on:
            more = more_processes(done, said)
            if not more:
                break
            done += more
        self.assertTrue(FEWEST <= done <= MAXIMUM)
        self.assertTrue(done == MAXIMUM or UNDECIDED not in said)

    @holds_for(done=draw.integers(0, 20), maximum=draw.integers(1, 20), undecided=draw.booleans())
    def test_never_more_than_are_allowed_and_none_once_decided(self, done, maximum, undecided):
        asked = []

        def verdicts_on(seconds):
            asked.append(seconds)
            return [UNDECIDED if undecided else TIE]

        more = further_processes(maximum, {"row": [1.0] * done, "other": [1.0] * done}, verdicts_on)
        self.assertTrue(0 <= more <= max(0, maximum - done))
        self.assertEqual(bool(asked), done >= FEWEST)
        if done >= FEWEST and not undecided:
            self.assertEqual(more, 0)
        if done < FEWEST:
            self.assertEqual(done + more, max(done, min(maximum, FEWEST)))


def named(times):
    return dict(zip(FORMULATIONS, times))


class Rows(unittest.TestCase):
    @holds_for(times=times_of_rows(rows=3, minimum=FEWEST))
    def test_the_fastest_has_the_least_mean_and_is_level_with_what_ties_with_it(self, times):
        rows = named(times)
        best = fastest(rows)
        for row, found in rows.items():
            self.assertGreaterEqual(ratio_of(found, rows[best]).ratio, 1 - 1e-12)
        level, undecided = level_rows(rows)
        self.assertIn(best, level)
        self.assertFalse(level & undecided)
        for row in rows:
            said = compared(rows[row], rows[best]) if row != best else TIE
            self.assertEqual((row in level, row in undecided), (said == TIE, said == UNDECIDED))
        self.assertEqual(level_rows({best: rows[best]}), (set(), set()))  # no rival
        pair = {row: rows[row] for row in list(rows)[1:]}
        self.assertIn(fastest(pair), level_rows(pair)[0])  # one is rival enough

    @holds_for(times=times_of_rows(rows=3, minimum=1), examples=100)
    def test_of_claims_to_be_fastest_one_holds_at_most_and_then_all_others_fail(self, times):
        rows = named(times)
        found = {row: claim_of_fastest(row, rows) for row in rows}
        for row, (result, ratio) in found.items():
            rivals = {other: compared(rows[row], rows[other]) for other in rows if other != row}
            if result == HOLDS:
                self.assertEqual(set(rivals.values()), {FASTER})
                self.assertEqual({found[other][0] for other in rivals}, {FAILS})
                self.assertGreater(ratio.ratio, 1)
            self.assertEqual(result == FAILS, SLOWER in rivals.values())
            self.assertEqual(result == TIE, SLOWER not in rivals.values() and TIE in rivals.values())
            self.assertEqual(ratio, min((ratio_of(rows[other], rows[row]) for other in rivals),
                                        key=lambda each: each.ratio))
            turned = dict(reversed(rows.items()))  # whatever the order of the rows
            self.assertEqual(claim_of_fastest(row, turned)[0], result)

    @holds_for(times=times_of_rows(rows=3, minimum=FEWEST), factor=draw.floats(0.7, 1.4), smaller=draw.floats(0.5, 1.0))
    def test_a_multiple_that_holds_does_so_for_every_smaller_factor(self, times, factor, smaller):
        rows = named(times)
        result, ratio = claim_of_multiple("algebra", factor, rows)
        less, _ = claim_of_multiple("algebra", smaller * factor, rows)
        if result == HOLDS:
            self.assertEqual(less, HOLDS)
        if less == FAILS:
            self.assertEqual(result, FAILS)
        self.assertEqual(result, HOLDS if ratio.low > factor else FAILS if ratio.high < factor else UNDECIDED)
        few = {row: found[:FEWEST - 1] for row, found in rows.items()}
        self.assertEqual(claim_of_multiple("algebra", factor, few)[0], UNDECIDED)

    @holds_for(times=times_of_rows(rows=3, minimum=1, maximum=8),
               missing=draw.tuples(*[draw.sets(draw.integers(0, 7), max_size=3)] * 3),
               failed=draw.sampled_from((None, *FORMULATIONS)), examples=50)
    def test_a_block_is_compared_by_the_processes_that_all_its_rows_have(self, times, missing, failed):
        cells = {}
        for (name, found), lost in zip(named(times).items(), missing):
            kept = {process: each for process, each in enumerate(found) if process not in lost}
            cells[CellKey(name, 17, 1)] = (Measurement(failure="diverged") if name == failed or not kept
                                           else Measurement(kept))
        run, rows = Run({}, cells), [key.formulation for key, cell in cells.items() if not cell.failure]
        common = sorted(set.intersection(*(set(cells[name, 17, 1].times) for name in rows))) if rows else []
        block = run.times(17, 1)
        if not common:
            self.assertEqual(block, {})
            return
        self.assertEqual(block, {name: [cells[name, 17, 1].times[process] for process in common] for name in rows})
        found = [(pair.row, pair.other) for pair in pairs(run, 17)]
        self.assertEqual(found, list(itertools.combinations([name for name in FORMULATIONS if name in rows], 2)))
        self.assertEqual(bool(judged(run, 17)), len(rows) == 3)  # no claim without all formulations

    @holds_for(milliseconds=draw.lists(draw.lists(draw.floats(1e-3, 1e6), min_size=1, max_size=4), min_size=1,
                                       max_size=6))
    def test_the_time_of_a_process_is_the_least_of_its_repetitions(self, milliseconds):
        rows = [{"run_name": "table1/group/n:17/s:1", "time_unit": "ms", "cpu_time": each, "process": process}
                for process, found in enumerate(milliseconds) for each in found]
        found = measurement(rows, (), ()).times
        self.assertEqual(list(found), list(range(len(milliseconds))))
        for process, each in enumerate(milliseconds):
            self.assertAlmostEqual(found[process], 1e-3 * min(each))


if __name__ == "__main__":
    unittest.main()
