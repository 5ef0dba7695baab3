"""Tests of verdicts.py on made-up processes: how often a verdict is right, and what each verdict and claim needs."""

import math
import random
import statistics
import unittest

import programs  # finds the package lib

from studies.tables.judge import CLAIMS
from lib.judging.verdicts import (FAILS, FASTER, FEWEST, HOLDS, MARGIN, MOST, SLOWER, TIE, UNDECIDED, Ratio,
                                  claim_of_fastest, claim_of_multiple, compared, fastest, level_rows, more_processes,
                                  ratio_of, student_t, verdict, within)

DRAWS = 1000


def processes(ratio, spread, count, draws):
    """Returns times whose ratio to 1 varies by `spread`, of its logarithm, from process to process."""
    return [ratio * math.exp(draws.gauss(0, spread)) for _ in range(count)]


def decided(ratio, spread, draws):
    """Returns the verdict of a made-up measurement, whose processes are added by the rule; and how many it took."""
    times, said = [], UNDECIDED
    while more := more_processes(len(times), {said}):
        times += processes(ratio, spread, more, draws)
        said = compared(times, [1.0] * len(times))
    return said, len(times)


def shares(ratio, spread):
    """Returns how often each verdict comes out of DRAWS made-up measurements."""
    draws = random.Random(f"{ratio} {spread}")
    found = [decided(ratio, spread, draws)[0] for _ in range(DRAWS)]
    return {said: found.count(said) / DRAWS for said in (FASTER, SLOWER, TIE, UNDECIDED)}


class HowOftenVerdictsAreRight(unittest.TestCase):
    """A ratio above 1 is a slower row; the same holds of faster ones by symmetry."""

    def test_at_the_margin_neither_side_is_taken_often(self):
        for spread in (0.002, 0.01, 0.02, 0.04):
            found = shares(MARGIN, spread)
            self.assertLessEqual(found[SLOWER], 0.09, spread)
            self.assertLessEqual(found[TIE], 0.09, spread)
            self.assertEqual(found[FASTER], 0)

    def test_off_the_margin_verdicts_are_right(self):
        for ratio, spread, said, least in ((1.02, 0.02, TIE, 0.98), (1.08, 0.02, SLOWER, 0.98),
                                           (1.12, 0.04, SLOWER, 0.99), (1 / 1.08, 0.02, FASTER, 0.98)):
            self.assertGreaterEqual(shares(ratio, spread)[said], least, ratio)

    def test_repetitions_of_one_process_are_not_independent(self):
        # The control: what one process is given moves all of its seven repetitions alike, by 3 % from process to
        # process, while they differ by 0.1 % among themselves. Taken as independent they decide too soon.
        draws = random.Random(1)
        wrong = 0
        for _ in range(DRAWS):
            (given,) = processes(1.02, 0.03, 1, draws)
            wrong += compared(processes(given, 0.001, 7, draws), [1.0] * 7) == SLOWER
        self.assertGreaterEqual(wrong / DRAWS, 0.10)
        self.assertLess(shares(1.02, 0.03)[SLOWER], 0.02)  # as processes they do not


class Rules(unittest.TestCase):
    def test_intervals_have_the_quantiles_of_student(self):
        # Source: Abramowitz and Stegun, table 26.10.
        for freedom, quantile in ((1, 12.706), (2, 4.303), (5, 2.571), (6, 2.447), (7, 2.365), (11, 2.201),
                                  (30, 2.042)):
            self.assertAlmostEqual(student_t(0.95, freedom), quantile, delta=5e-4)
        self.assertAlmostEqual(within(1.0, 10**6), math.erf(1 / math.sqrt(2)), places=6)  # tends to the normal

    def test_a_ratio_is_the_geometric_mean_of_paired_ratios(self):
        # Processes differ by a factor 2 in both rows alike; their ratios do not.
        found = ratio_of([2.0, 4.0, 8.0], [1.0, 2.0, 4.0])
        self.assertEqual((found.ratio, found.low, found.high), (2.0, 2.0, 2.0))
        logarithms = [0.01, 0.03]
        found = ratio_of([math.exp(each) for each in logarithms], [1.0, 1.0])
        self.assertAlmostEqual(math.log(found.ratio), 0.02)
        half = 12.7062 * statistics.stdev(logarithms) / math.sqrt(2)
        self.assertAlmostEqual(math.log(found.high), 0.02 + half, places=5)
        self.assertAlmostEqual(found.low * found.high, found.ratio**2)
        self.assertRaises(ValueError, ratio_of, [1.0], [1.0, 2.0])

    def test_verdicts_need_the_whole_interval(self):
        for low, high, said in ((1.051, 1.2, SLOWER), (0.8, 0.952, FASTER), (0.953, 1.049, TIE),
                                (1.0, 1.051, UNDECIDED), (1.049, 1.3, UNDECIDED), (0.951, 1.0, UNDECIDED),
                                (0.5, 2.0, UNDECIDED)):
            self.assertEqual(verdict(Ratio(1.0, low, high, FEWEST)), said)
            self.assertEqual(verdict(Ratio(1.0, low, high, FEWEST - 1)), UNDECIDED)

    def test_processes_are_added_while_anything_is_undecided(self):
        for count, said, more in ((0, {UNDECIDED}, FEWEST), (2, {TIE}, FEWEST - 2), (FEWEST, {TIE, SLOWER}, 0),
                                  (FEWEST, {TIE, UNDECIDED}, 2), (MOST - 1, {UNDECIDED}, 1), (MOST, {UNDECIDED}, 0)):
            self.assertEqual(more_processes(count, said), more)

    def test_rows_that_tie_with_the_fastest_are_level_and_others_undecided_or_neither(self):
        def row(ratio, spread):
            return [ratio * (1 + sign * spread) for sign in (-1, 1) * 3]

        times = {"group": row(1, 0), "cotangent": row(1.02, 0.01), "algebra": row(1.5, 0.01), "other": row(1.05, 0.01)}
        self.assertEqual(fastest(times), "group")
        self.assertEqual(level_rows(times), ({"group", "cotangent"}, {"other"}))
        self.assertEqual(level_rows({"group": [1.0] * 6}), (set(), set()))  # no rival


class ClaimsTest(unittest.TestCase):
    def test_who_is_fastest(self):
        for cotangent, algebra, result, ratio in (
                ([1.2] * 6, [1.3] * 6, HOLDS, 1.2), ([1.02] * 6, [1.3] * 6, TIE, 1.02),
                ([0.9] * 6, [1.02] * 6, FAILS, 0.9), ([1.02, 1.08] * 3, [1.3] * 6, UNDECIDED, math.sqrt(1.02 * 1.08)),
                ([1.2] * 5, [1.3] * 5, UNDECIDED, 1.2)):
            times = {"group": [1.0] * len(algebra), "cotangent": cotangent, "algebra": algebra}
            found, of = claim_of_fastest("group", times)
            self.assertEqual(found, result)
            self.assertAlmostEqual(of.ratio, ratio)

    def test_who_takes_a_multiple(self):
        for algebra, result in (([2.1] * 6, HOLDS), ([1.9] * 6, FAILS), ([1.9, 2.1] * 3, UNDECIDED),
                                ([3.0] * 5, UNDECIDED), ([0.5] * 6, FAILS)):
            times = {"group": [1.0] * len(algebra), "cotangent": [1.5] * len(algebra), "algebra": algebra}
            found, of = claim_of_multiple("algebra", 2.0, times)
            self.assertEqual(found, result)
            self.assertAlmostEqual(of.ratio, statistics.geometric_mean(algebra))

    def test_the_papers_own_winners_are_those_of_the_claims(self):
        # The paper's seconds at n = 129, taken as the same in six processes.
        seconds = {1: (36.2, 19.5, 9.84), 2: (52.0, 26.8, 52.6), 3: (60.2, 31.3, 108)}
        for claim in CLAIMS:
            for stages in claim.stages:
                times = dict(zip(programs.FORMULATIONS, ([each] * 6 for each in seconds[stages])))
                self.assertEqual(claim.judge(times)[0], HOLDS)


if __name__ == "__main__":
    unittest.main()
