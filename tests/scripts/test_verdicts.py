"""Tests of verdicts.py on made-up processes: how often a verdict is right, and what each verdict and claim needs."""

import math
import random
import unittest

import programs  # finds the package lib

from studies.tables.judge import CLAIMS
from lib.judging.verdicts import FASTER, HOLDS, MARGIN, SLOWER, TIE, UNDECIDED, compared, more_processes

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
        for ratio, spread, said, minimum in ((1.02, 0.02, TIE, 0.98), (1.08, 0.02, SLOWER, 0.98),
                                           (1.12, 0.04, SLOWER, 0.99), (1 / 1.08, 0.02, FASTER, 0.98)):
            self.assertGreaterEqual(shares(ratio, spread)[said], minimum, ratio)

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


class ClaimsTest(unittest.TestCase):
    def test_the_papers_own_winners_are_those_of_the_claims(self):
        # The paper's seconds at n = 129, taken as the same in six processes.
        seconds = {1: (36.2, 19.5, 9.84), 2: (52.0, 26.8, 52.6), 3: (60.2, 31.3, 108)}
        for claim in CLAIMS:
            for stages in claim.stages:
                times = dict(zip(programs.FORMULATIONS, ([each] * 6 for each in seconds[stages])))
                self.assertEqual(claim.judge(times)[0], HOLDS)


if __name__ == "__main__":
    unittest.main()
