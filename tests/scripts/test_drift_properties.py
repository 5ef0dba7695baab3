"""Properties of how drift of long runs and trends of repetitions are judged, for series that hypothesis draws."""

import itertools
import math
import random
import statistics
import unittest

import numpy
from hypothesis import strategies as draw
from properties import SEEDS, decades, fails, holds_for
from scipy import stats

from lib.judging import drift, trend
from lib.judging.drift import (ALL_LOST, BLOCKS, BOUNDED, FAILED, GROWS, KEPT, MIN_DRIFT, MIN_GROWTH, LOST, NO_TREND,
                               MAX_TREND, ROUNDING, Estimate, growth_of, judged, slope_of, verdict_on)
from lib.judging.trend import FEWEST_ROUNDS, MIN_CHANGE, LEVEL, Trend
from lib.judging.verdicts import UNDECIDED

WINDOWS = draw.integers(60, 200)
ERRORS = decades(-11.5, -1.5)  # between ROUNDING and LOST


def series_of(windows, size, power, spread, seed):
    """Returns a series of maxima around a power of time, size at the end, with noise, and means of the same size."""
    noise = random.Random(seed)
    times = [50.0 * k for k in range(1, windows + 1)]
    errors = [size * (time / times[-1])**power * math.exp(spread * noise.gauss(0, 1)) for time in times]
    return list(zip(times, errors)), [(time, size * noise.gauss(0.5, 0.1)) for time in times]


SERIES = draw.builds(series_of, WINDOWS, ERRORS, draw.floats(-0.5, 2.0), draw.sampled_from((0.0, 0.01, 0.1, 0.3)),
                     SEEDS)


def estimate_of(points):
    """Returns slope and half interval of the jackknife without blocks of neighbours, by NumPy and SciPy."""
    found = numpy.array(points)
    blocks = numpy.array_split(numpy.arange(len(found)), BLOCKS)  # of lengths that differ by 1 at most

    def slope(kept):
        return numpy.polyfit(found[kept, 0], found[kept, 1], 1)[0]

    others = numpy.array([slope(numpy.setdiff1d(numpy.arange(len(found)), block)) for block in blocks])
    error = math.sqrt((BLOCKS - 1) * numpy.var(others))
    return slope(slice(None)), stats.t.ppf(0.975, BLOCKS - 1) * error


class Estimates(unittest.TestCase):
    @holds_for(count=draw.integers(2, 20), seed=SEEDS, slope=draw.floats(-2, 2))
    def test_they_are_those_of_least_squares_and_of_the_block_jackknife(self, count, seed, slope):
        noise = random.Random(seed)
        points = [(x, slope * x + noise.gauss(0, 1)) for x in range(BLOCKS * count)]
        found, (middle, half) = drift.estimate_of(points, 1.0), estimate_of(points)
        self.assertAlmostEqual(slope_of(points), middle)
        for value, expected in zip(found, (middle, middle - half, middle + half)):
            self.assertAlmostEqual(value, expected, delta=1e-7 * (1 + half))

    @holds_for(series=SERIES)
    def test_a_power_is_of_the_last_decade_and_a_trend_of_the_second_half_alone(self, series):
        errors, _ = series
        end = errors[-1][0]
        decade = [(time, 7 * error if 10 * time <= end else error) for time, error in errors]
        self.assertEqual(growth_of(decade), growth_of(errors))
        half = [(time, 7 * error if 2 * time <= end else error) for time, error in errors]
        self.assertEqual(drift.trend_of(half, 1.0), drift.trend_of(errors, 1.0))
        within = [(time, 7 * error if 5 * time <= end else error) for time, error in errors]
        self.assertNotEqual(growth_of(within), growth_of(errors))  # the control

    @holds_for(series=SERIES)
    def test_a_trend_is_over_the_mean_error_of_the_second_half(self, series):
        errors, _ = series
        late = [error for time, error in errors if 2 * time > errors[-1][0]]
        for one, other in zip(judged(errors).trend, drift.trend_of(errors, statistics.fmean(late))):
            self.assertAlmostEqual(one, other, delta=1e-9 * (1 + abs(other)))

    @holds_for(windows=WINDOWS, power=draw.floats(-1.0, 3.0), gain=draw.floats(-2.0, 2.0))
    def test_exact_powers_and_lines_have_no_interval(self, windows, power, gain):
        times = [50.0 * k for k in range(1, windows + 1)]
        for value in growth_of([(time, 1e-6 * (time / times[-1])**power) for time in times]):
            self.assertAlmostEqual(value, power, delta=1e-6)
        line = [(time, 3e-6 + gain * 1e-6 * time / times[-1]) for time in times]
        for value in drift.trend_of(line, 1e-6):
            self.assertAlmostEqual(value, gain, delta=1e-6)


class Verdicts(unittest.TestCase):
    @holds_for(series=SERIES, unit=draw.floats(1e-3, 1e3))
    def test_the_unit_of_time_does_not_count(self, series, unit):
        errors, means = series
        other = judged([(unit * time, error) for time, error in errors], True,
                       [(unit * time, mean) for time, mean in means])
        found = judged(errors, True, means)
        self.assertEqual(other.verdict, found.verdict)
        for one, two in zip(found[1:], other[1:]):
            for value, expected in zip(one, two):
                self.assertAlmostEqual(value, expected, delta=1e-6 * (1 + abs(expected)))

    def test_a_window_at_a_tenth_of_the_time_is_out_in_any_unit(self):
        errors = [(50.0 * k, 1e-3 * (1 + 0.5 * math.sin(9 * k))) for k in range(1, 61)]  # one is at 300, of 3000
        found = growth_of(errors)
        for unit in (1.001**k for k in range(100)):
            for value, expected in zip(growth_of([(unit * time, error) for time, error in errors]), found):
                self.assertAlmostEqual(value, expected, delta=1e-9)

    def test_equal_errors_are_bounded_whatever_the_unit_of_time(self):
        for unit in (1.0, 0.1, 1 / 3, 7.7, *(1.001**k for k in range(100))):
            errors = [(50.0 * unit * k, 3.1622776601683794e-12) for k in range(1, 61)]
            self.assertEqual(judged(errors, True, [(time, 0.5 * error) for time, error in errors]).verdict, BOUNDED)

    @holds_for(series=SERIES)
    def test_a_drift_down_is_judged_as_one_up(self, series):
        errors, means = series
        mirrored = [(time, -mean) for time, mean in means]
        self.assertEqual(judged(errors, True, mirrored).verdict, judged(errors, True, means).verdict)
        falling, rising = ([(time, sign * errors[-1][1] * (3 * time / means[-1][0] - 1)) for time, _ in means]
                           for sign in (-1, 1))
        self.assertEqual(judged(errors, True, falling).verdict, judged(errors, True, rising).verdict)

    @holds_for(series=SERIES, place=draw.floats(0.0, 1.0), size=draw.floats(1.0, 10.0))
    def test_one_window_at_a_tenth_is_a_loss_wherever_it_stands(self, series, place, size):
        errors, means = series
        place = round(place * (len(errors) - 1))
        below = max(error for _, error in errors) < LOST
        self.assertEqual(judged(errors, True, means).verdict == ALL_LOST, not below)
        errors[place] = errors[place][0], size * LOST
        self.assertEqual(judged(errors, True, means).verdict, ALL_LOST)
        self.assertEqual(judged(errors, False, means).verdict, FAILED)

    @holds_for(series=SERIES, place=draw.floats(0.0, 1.0))
    def test_rounding_is_where_every_window_is(self, series, place):
        largest = max(error for _, error in series[0])
        errors = [(time, 0.9 * ROUNDING * error / largest) for time, error in series[0]]
        self.assertEqual(judged(errors).verdict, KEPT)
        place = round(place * (len(errors) - 1))
        errors[place] = errors[place][0], 1.1 * ROUNDING
        self.assertNotEqual(judged(errors).verdict, KEPT)

    @holds_for(growth=draw.tuples(draw.floats(-1, 1), draw.floats(0, 1)),
               trend_found=draw.tuples(draw.floats(-1, 1), draw.floats(0, 1)),
               drift_found=draw.tuples(draw.floats(-3, 3), draw.floats(0, 3)), examples=150)
    def test_bounded_needs_a_small_trend_whose_interval_holds_0_whichever_way(self, growth, trend_found, drift_found):
        def said(*signs):
            estimates = [Estimate(sign * value, sign * value - half, sign * value + half)
                         for sign, (value, half) in zip(signs, (growth, trend_found, drift_found))]
            return verdict_on([1e-6], *estimates, True)

        found = said(1, 1, 1)
        self.assertEqual(found, said(1, -1, -1))  # trends up and down
        grows = growth[0] - growth[1] > MIN_GROWTH or abs(drift_found[0]) - drift_found[1] > MIN_DRIFT
        stays = all(abs(value) - half <= NO_TREND and abs(value) < MAX_TREND
                    for value, half in (trend_found, drift_found))
        self.assertEqual(found, GROWS if grows else BOUNDED if stays else UNDECIDED)
        without = verdict_on([1e-6], None, None, None, True)
        self.assertEqual(without, UNDECIDED)

    @holds_for(series=SERIES, size=draw.floats(0.1, 10.0))
    def test_the_size_of_an_error_between_rounding_and_loss_does_not_count(self, series, size):
        errors, means = series
        small, large = (min, max)
        if ROUNDING < size * small(error for _, error in errors) and large(1.0, size) * large(
                error for _, error in errors) < LOST and small(error for _, error in errors) > ROUNDING:
            other = judged([(time, size * error) for time, error in errors], True,
                           [(time, size * mean) for time, mean in means])
            self.assertEqual(other.verdict, judged(errors, True, means).verdict)

    @holds_for(series=SERIES, kept=draw.integers(0, 19))
    def test_a_few_windows_tell_nothing(self, series, kept):
        errors = [(time, min(error, LOST / 2)) for time, error in series[0]][:kept]
        self.assertIn(judged(errors).verdict, (UNDECIDED, KEPT) if errors else (FAILED,))


def noisy(rounds, seed, slope, shared):
    """Returns some series of times with noise, noise that their rounds share, and a rise by `slope` a round."""
    noise = random.Random(seed)
    common = [1 + shared * noise.random() for _ in range(rounds)]
    return [[unit * common[k] * noise.gauss(1.0, 0.01) * (1 + slope * k) for k in range(rounds)]
            for unit in (noise.uniform(1e-6, 1.0) for _ in range(noise.randint(1, 12)))]


TIMES = draw.builds(noisy, draw.integers(1, 9), SEEDS, draw.sampled_from((-0.02, 0.0, 0.005)),
                    draw.sampled_from((0.0, 0.05)))


def rank_correlation(values):
    """Returns Spearman's correlation of values that are not all equal with their order, by his formula."""
    ranks, places = (each - each.mean() for each in (stats.rankdata(values), numpy.arange(len(values))))
    return ranks @ places / math.sqrt((ranks @ ranks) * (places @ places))


class Trends(unittest.TestCase):
    @holds_for(values=draw.lists(draw.floats(1.0, 2.0) | draw.integers(1, 6), min_size=FEWEST_ROUNDS, max_size=7))
    def test_the_correlation_is_that_of_spearman(self, values):
        expected = stats.spearmanr(values, range(len(values)))[0] if len(set(values)) > 1 else 0.0
        self.assertAlmostEqual(trend.trend_of([values]).correlation, expected)

    @holds_for(times=TIMES, factor=draw.floats(1e-3, 1e3), examples=15)
    def test_units_do_not_count_and_times_in_reverse_turn_the_sign(self, times, factor):
        found = trend.trend_of(times)
        if len(times[0]) < FEWEST_ROUNDS:
            self.assertIsNone(found)
            return
        scaled = trend.trend_of([[factor * each for each in times[0]], *times[1:]])
        self.assertEqual(scaled.is_shown(), found.is_shown())
        turned = trend.trend_of([each[::-1] for each in times])
        for value, expected in ((scaled.correlation, found.correlation), (scaled.change, found.change),
                                (turned.correlation, -found.correlation), (1 + turned.change, 1 / (1 + found.change))):
            self.assertAlmostEqual(value, expected)
        half = len(times[0]) // 2
        later = statistics.geometric_mean([each for row in times for each in row[-half:]])
        self.assertAlmostEqual(1 + found.change, later / statistics.geometric_mean(
            [each for row in times for each in row[:half]]))
        shorter = [times[0][:-1], times[0][:2]]  # of fewer rounds
        self.assertEqual(trend.trend_of([*times, *shorter]), found)

    @holds_for(order=draw.permutations(range(FEWEST_ROUNDS)), ties=draw.booleans(), examples=15)
    def test_the_probability_is_the_share_of_orders_with_as_much(self, order, ties):
        times = [1.0 + (min(each, 3) if ties else each) for each in order]
        found = trend.trend_of([times])
        as_much = [abs(rank_correlation(each)) >= abs(found.correlation) - 1e-12
                   for each in itertools.permutations(times)]
        self.assertAlmostEqual(found.probability, sum(as_much) / len(as_much))

    @holds_for(change=draw.floats(-0.05, 0.05), probability=draw.floats(0.0, 0.02))
    def test_a_trend_is_shown_up_or_down_if_it_is_rare_and_large_enough(self, change, probability):
        shown = Trend(9, 7, 1.0, probability, change).is_shown()
        self.assertEqual(shown, Trend(9, 7, -1.0, probability, -change).is_shown())
        self.assertEqual(shown, probability < LEVEL and abs(change) > MIN_CHANGE)

    def test_a_wrong_property_is_seen(self):  # the control
        def rises_only(times):
            self.assertGreaterEqual(trend.trend_of(times).correlation if len(times[0]) >= FEWEST_ROUNDS else 0, 0)

        self.assertTrue(fails(rises_only, times=TIMES))


def repeated(common=0.0, seed=1):
    """Returns 100 series of seven rounds with a noise of 1 % each, and a noise that their rounds share."""
    drawn = random.Random(seed)
    shared = [drawn.gauss(1.0, common) for _ in range(7)]
    return [[unit * each * drawn.gauss(1.0, 0.01) for each in shared]
            for unit in (drawn.uniform(1e-6, 1.0) for _ in range(100))]


class HowOftenTrendsAreShown(unittest.TestCase):
    def test_noise_shows_none_and_a_round_that_is_slow_for_all_is_one_event_and_not_a_hundred(self):
        self.assertEqual(sum(trend.trend_of(repeated(seed=seed)).is_shown() for seed in range(20)), 0)
        self.assertLess(sum(trend.trend_of(repeated(0.05, seed)).is_shown() for seed in range(40)), 4)

    def test_a_first_round_without_a_warm_up_is_caught_if_the_times_go_on_to_fall(self):  # the control
        cold = [[value * factor for value, factor in zip(each, (1.3, 1.1, 1.05, 1.02, 1.01, 1.005, 1.0))]
                for each in repeated()]
        self.assertTrue(trend.trend_of(cold).is_shown())


if __name__ == "__main__":
    unittest.main()
