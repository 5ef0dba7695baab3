"""Tests of lib/judging/trend.py: rank correlation of repetitions with their order."""

import random
import unittest

import programs  # noqa: F401, which makes lib importable

from lib.judging.trend import trend_of


def noisy(count, rounds, slope=0.0, common=0.0, seed=1):
    """Returns series with a noise of 1 % each, a noise of their rounds, and a rise by `slope` a round."""
    drawn = random.Random(seed)
    shared = [drawn.gauss(1.0, common) for _ in range(rounds)]
    return [[unit * shared[k] * drawn.gauss(1.0, 0.01) * (1 + slope * k) for k in range(rounds)]
            for unit in (drawn.uniform(1e-6, 1.0) for _ in range(count))]


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

    def test_the_probability_is_the_share_of_orders(self):
        for rounds, orders in ((6, 720), (7, 5040)):  # all of them, and two are as extreme as a rise
            for values in (range(1, rounds + 1), range(rounds, 0, -1)):
                self.assertAlmostEqual(trend_of([[*values]]).probability, 2 / orders)
        self.assertEqual(trend_of([[7.0] * 6]).probability, 1.0)
        many = noisy(5, 9)  # of more rounds orders are drawn, always the same
        self.assertEqual(trend_of(many), trend_of(many))
        self.assertLess(trend_of([[*range(1, 10)]]).probability, 0.001)


if __name__ == "__main__":
    unittest.main()
