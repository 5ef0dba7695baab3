"""Tests of scripts/lib/drift.py: made-up series of each kind, and that none is taken for another."""

import math
import os
import random
import sys
import unittest

from programs import ROOT

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
from drift import EXPONENTIAL, LINEAR, NONE, POWER, drift  # noqa: E402

STEP = 0.25
STEPS = sorted({round(10 ** (k / 10)) for k in range(41)} | set(range(250, 10001, 250)))
TIMES = [STEP * step for step in STEPS]
END = TIMES[-1]
SEEDS = range(20)


def series(value):
    return [(time, value(time)) for time in TIMES]


def noisy(values, seed, spread=0.3):
    """Multiplies values by noise of this relative size, in the mean."""
    choose = random.Random(seed)
    return [(time, value * math.exp(choose.gauss(0, spread))) for time, value in values]


def random_walk(seed, step=1e-15, directions=10):
    """Returns the distance of a walk of 10⁴ steps of this size in each of some directions, at the samples."""
    choose = random.Random(seed)
    places, found, wanted = [0.0] * directions, [], set(STEPS)
    for index in range(1, STEPS[-1] + 1):
        places = [place + choose.choice((-step, step)) for place in places]
        if index in wanted:
            found.append((STEP * index, math.hypot(*places)))
    return found


class DriftTest(unittest.TestCase):
    def assert_kind(self, kind, values, rate=None, within=0.05):
        found = drift(values)
        self.assertEqual(found.kind, kind, found)
        if rate is not None:
            self.assertAlmostEqual(found.rate / rate, 1, delta=within, msg=str(found))
        return found


class Level(DriftTest):
    def test_exactly_zero(self):
        found = self.assert_kind(NONE, series(lambda time: 0.0))
        self.assertEqual((found.rate, found.largest, found.reason), (0.0, 0.0, "exactly 0 in every sample"))

    def test_noise_at_rounding(self):
        for seed in SEEDS:
            self.assert_kind(NONE, noisy(series(lambda time: 1e-15), seed, 0.5))

    def test_noise_far_above_rounding(self):
        for seed in SEEDS:
            self.assert_kind(NONE, noisy(series(lambda time: 1e-4), seed))

    def test_rounding_that_adds_up_like_a_random_walk(self):
        for seed in SEEDS:
            for directions in (1, 4):
                found = self.assert_kind(NONE, random_walk(seed, directions=directions))
                self.assertLess(found.largest, 1e-12)

    def test_bounded_oscillations(self):
        for period in (0.7, 11.0, 90.0):
            for size in (1e-9, 1e-3, 0.2):
                self.assert_kind(NONE, series(lambda time: size * abs(math.sin(2 * math.pi * time / period))))

    def test_an_error_that_falls(self):
        self.assert_kind(NONE, series(lambda time: 1e-3 / (1 + time)))


class Growth(DriftTest):
    def test_linear(self):
        for rate in (1e-12, 1e-6, 1e-4):
            self.assertEqual(self.assert_kind(LINEAR, series(lambda time: rate * time), rate).exponent, 1)

    def test_linear_with_noise(self):
        for seed in SEEDS:
            self.assert_kind(LINEAR, noisy(series(lambda time: 1e-9 * time), seed, 0.2), 1e-9, 0.5)

    def test_linear_out_of_rounding(self):
        self.assert_kind(LINEAR, series(lambda time: 1e-14 + 1e-12 * time), 1e-12, 0.1)

    def test_linear_under_an_oscillation(self):
        self.assert_kind(LINEAR, series(lambda time: 1e-7 * time + 1e-6 * abs(math.sin(time))), 1e-7, 0.3)

    def test_linear_growth_of_rounding_is_told(self):
        self.assert_kind(LINEAR, series(lambda time: 2e-16 * time), 2e-16)

    def test_a_power(self):
        for exponent in (0.5, 2.0, 3.0):
            found = self.assert_kind(POWER, series(lambda time: 1e-10 * time**exponent), 1e-10)
            self.assertAlmostEqual(found.exponent, exponent, delta=0.05)

    def test_a_random_walk_above_rounding(self):
        for seed in SEEDS[:5]:
            found = self.assert_kind(POWER, random_walk(seed, 1e-8))
            self.assertAlmostEqual(found.exponent, 0.5, delta=0.25)

    def test_the_exponent_is_that_of_the_last_decade(self):
        # Errors that grow like the cube of time until rough modes are there, then linearly.
        found = self.assert_kind(LINEAR, series(lambda time: 1e-9 * min(time, 100.0) ** 3 + 3e-5 * time))
        self.assertEqual(found.exponent, 1)

    def test_exponential(self):
        for rate in (25 / END, 10 / END):
            self.assert_kind(EXPONENTIAL, series(lambda time: 1e-15 * math.exp(rate * time)), rate)

    def test_exponential_with_noise(self):
        for seed in SEEDS:
            self.assert_kind(EXPONENTIAL, noisy(series(lambda time: 1e-15 * math.exp(25 * time / END)), seed), 25 / END,
                             0.1)

    def test_exponential_that_saturates(self):
        # It starts at rounding and comes to a stand at the size of the data, early or late in the run.
        for rate in (50 / END, 500 / END, 2000 / END):
            self.assert_kind(EXPONENTIAL, series(lambda time: 1 / (1 + 1e15 * math.exp(-rate * time))), rate, 0.1)

    def test_exponential_out_of_rounding_that_adds_up(self):
        self.assert_kind(EXPONENTIAL, series(lambda time: 1e-15 * math.sqrt(time) + 1e-20 * math.exp(40 * time / END)),
                         40 / END, 0.1)

    def test_exponential_that_stands_out_late(self):
        self.assert_kind(EXPONENTIAL, series(lambda time: 1e-13 + 1e-30 * math.exp(60 * time / END)), 60 / END, 0.15)

    def test_exponential_up_to_a_failure(self):
        # The run ends where it overflows: the last samples are far beyond the size of the data.
        rate = 1.5
        values = [(time, 1e-16 * math.exp(rate * time)) for time in TIMES if rate * time < math.log(1e28)]
        self.assert_kind(EXPONENTIAL, values, rate, 0.1)

    def test_a_linear_drift_is_not_exponential_however_far_it_goes(self):
        for end in (1e-13, 1e-9, 1e-4, 0.05, 1.0):
            self.assertNotEqual(drift(series(lambda time: end * time / END)).kind, EXPONENTIAL, end)

    def test_an_exponential_is_neither_linear_nor_a_power(self):
        for growth in (1e2, 1e4, 1e10):
            rate = math.log(growth) / END
            self.assert_kind(EXPONENTIAL, series(lambda time: 1e-13 * math.exp(rate * time)), rate)

    def test_a_growth_less_than_tenfold_is_not_exponential(self):
        self.assertNotEqual(drift(series(lambda time: 1e-6 * math.exp(2 * time / END))).kind, EXPONENTIAL)


class Telling(DriftTest):
    def test_too_few_samples_tell_nothing(self):
        self.assertIsNone(drift([]))
        self.assertIsNone(drift(series(lambda time: time)[:4]))
        self.assertIsNotNone(drift(series(lambda time: time)[:5]))

    def test_the_start_has_no_time(self):
        self.assert_kind(LINEAR, [(0.0, 0.0), *series(lambda time: 1e-6 * time)], 1e-6)

    def test_how_it_was_decided(self):
        self.assertRegex(drift(series(lambda time: 1e-6 * time)).reason,
                         r"^a power fits better \(log residual .* against .*\) over \d+ samples, t = .* to 2.5e\+03$")

    def test_the_largest_error_is_kept(self):
        self.assertEqual(drift(series(lambda time: 1e-6 * time)).largest, 1e-6 * END)

    def test_the_doubling_time(self):
        found = drift(series(lambda time: 1e-15 * 2 ** (time / 100)))
        self.assertAlmostEqual(found.doubling_time, 100, delta=1)

    def test_extreme_values(self):
        for values in ([(1e-300 * k, 1e300) for k in range(1, 9)], [(1e300 + k, 5e-324) for k in range(1, 9)],
                       [(float(k), 5e-324 if k < 5 else 1e308) for k in range(1, 12)]):
            drift(values)


if __name__ == "__main__":
    unittest.main()
