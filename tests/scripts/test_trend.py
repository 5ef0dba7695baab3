"""Tests of lib/judging/trend.py: rank correlation of repetitions with their order."""

import random
import unittest

import programs  # noqa: F401, which makes lib importable

from lib.judging.trend import FEWEST_ROUNDS, LEVEL, Trend, trend_of


def noisy(count, rounds, slope=0.0, common=0.0, seed=1):
    """Returns series with a noise of 1 % each, a noise of their rounds, and a rise by `slope` a round."""
    drawn = random.Random(seed)
    shared = [drawn.gauss(1.0, common) for _ in range(rounds)]
    return [[unit * shared[k] * drawn.gauss(1.0, 0.01) * (1 + slope * k) for k in range(rounds)]
            for unit in (drawn.uniform(1e-6, 1.0) for _ in range(count))]


class Correlation(unittest.TestCase):
    def correlation(self, values):
        return trend_of([[float(value) for value in values]]).correlation

    def test_known_values(self):
        for values, expected in (([1, 2, 3, 4, 5, 6], 1.0), ([6, 5, 4, 3, 2, 1], -1.0), ([7] * 6, 0.0),
                                 ([2, 1, 3, 4, 5, 6], 1 - 6 * 2 / 210), ([6, 2, 3, 4, 5, 1], 1 - 6 * 50 / 210),
                                 ([1, 1, 2, 2, 3, 3], 0.956183)):  # 1 - 6 Σd² / (k³ - k); the last by hand, with ties
            with self.subTest(values=values):
                self.assertAlmostEqual(self.correlation(values), expected, places=6)

    def test_only_the_order_counts(self):
        self.assertAlmostEqual(self.correlation([1.0, 9.0, 2.0, 1e6, 3.0, 4.0]), self.correlation([1, 5, 2, 6, 3, 4]))

    def test_the_probability_is_the_share_of_orders(self):
        for rounds, orders in ((6, 720), (7, 5040)):  # all of them, and two are as extreme as a rise
            for values in (range(1, rounds + 1), range(rounds, 0, -1)):
                self.assertAlmostEqual(trend_of([[*values]]).probability, 2 / orders)
        self.assertEqual(trend_of([[7.0] * 6]).probability, 1.0)
        many = noisy(5, 9)  # of more rounds orders are drawn, always the same
        self.assertEqual(trend_of(many), trend_of(many))
        self.assertLess(trend_of([[*range(1, 10)]]).probability, 0.001)


class OfManySeries(unittest.TestCase):
    def test_noise_shows_no_trend(self):
        shown = [trend_of(noisy(100, 7, seed=seed)).is_shown() for seed in range(20)]
        self.assertEqual(sum(shown), 0)

    def test_a_rise_and_a_fall_are_caught(self):  # the negative control
        for slope in (0.005, -0.005):
            found = trend_of(noisy(100, 7, slope))
            with self.subTest(slope=slope):
                self.assertTrue(found.is_shown())
                self.assertGreater(found.correlation * slope, 0)
                self.assertAlmostEqual(found.change, 4 * slope, delta=0.005)  # three rounds against three

    def test_a_first_round_without_a_warm_up_is_caught_if_the_times_go_on_to_fall(self):
        cold = [[value * factor for value, factor in zip(each, (1.3, 1.1, 1.05, 1.02, 1.01, 1.005, 1.0))]
                for each in noisy(100, 7)]
        self.assertTrue(trend_of(cold).is_shown())

    def test_a_round_that_is_slow_for_all_is_one_event_and_not_a_hundred(self):
        shown = [trend_of(noisy(100, 7, common=0.05, seed=seed)).is_shown() for seed in range(40)]
        self.assertLess(sum(shown), 4)

    def test_the_mean_is_that_of_the_correlations(self):
        series = noisy(10, 7, 0.003)
        mean = sum(trend_of([each]).correlation for each in series) / 10
        self.assertAlmostEqual(trend_of(series).correlation, mean)

    def test_series_with_fewer_rounds_are_left_out(self):
        whole = noisy(5, 7)
        self.assertEqual(trend_of([*whole, [1.0], [1.0, 2.0, 3.0]]), trend_of(whole))

    def test_few_rounds_tell_nothing(self):
        self.assertIsNone(trend_of([]))
        self.assertIsNone(trend_of(noisy(5, FEWEST_ROUNDS - 1, 0.1)))
        self.assertTrue(trend_of(noisy(5, FEWEST_ROUNDS, 0.1)).is_shown())

    def test_what_changes_little_is_no_matter(self):
        self.assertFalse(Trend(9, 7, 1.0, LEVEL / 2, 0.005).is_shown())
        self.assertTrue(Trend(9, 7, 1.0, LEVEL / 2, 0.02).is_shown())


if __name__ == "__main__":
    unittest.main()
