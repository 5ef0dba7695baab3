"""Whether an error of a long run stays at rounding, stays bounded, grows like a power of time, or is lost.

An error is given as maxima over windows of time, or as samples; beside it may stand its means with their sign. Two fits
are made by least squares. A power t^p is fitted to the logarithms of the last decade of time. A straight line is fitted
to the second half of the run: its slope, times the length of the run and over the mean error, is the trend.

Neighbouring windows are not independent. So the 95 % interval of both is that of the block jackknife: the fit is
repeated without each of ten blocks of neighbours, and Student's t is applied to the spread of what they give. SciPy has
no jackknife of blocks, and its t would be a second one beside that of lib.judging.verdicts. Standard library only.

Source: Künsch, The jackknife and the bootstrap for general stationary observations, Annals of Statistics 17 (1989).
"""

import math
import statistics
from typing import NamedTuple, Optional

from lib.judging.verdicts import LEVEL, UNDECIDED, student_t

DECADE = 10  # a power is fitted to what comes after the last time over this
BEYOND = 1 + 1e-9  # a window that ends exactly there is left out, whatever rounding makes of another unit of time
FEWEST_POINTS = 30  # that a power takes
BLOCKS = 10  # of neighbouring points, of equal numbers

# A relative error below this is at rounding: a million steps that each err at random by some 1e-15 give it.
ROUNDING = 1e-12
LOST = 0.1  # one that reaches this is lost, whatever its power
# An error grows if the interval of its power lies above MIN_GROWTH, or that of its drift, the trend of its means with
# their sign, beyond MIN_DRIFT on either side: a drift through 0 makes the error fall for a while. It is bounded if it
# does not grow, and the intervals of trend and drift hold 0 and both are below MAX_TREND.
MIN_GROWTH, MIN_DRIFT, MAX_TREND = 0.1, 1.0, 0.2
NO_TREND = 1e-9  # a smaller one is rounding: that of equal errors, whose interval has no width

KEPT, BOUNDED, GROWS, ALL_LOST, FAILED = "at rounding", "bounded", "growing", "lost", "failed"
VERDICTS = (KEPT, BOUNDED, GROWS, UNDECIDED, ALL_LOST, FAILED)


class Estimate(NamedTuple):
    """The power p of t^p, or a trend, with its 95 % interval."""

    value: float
    low: float
    high: float


class Judgement(NamedTuple):
    verdict: str  # of VERDICTS
    growth: Optional[Estimate]  # the power; None where too few values are above 0
    trend: Optional[Estimate]  # None where there are too few values
    drift: Optional[Estimate]  # None too where no means were given


def growth_of(series):
    """Returns the power over the last decade of a series, a list of (time, error) with rising times.

    Values of 0 have no logarithm and are left out. None if fewer than FEWEST_POINTS remain.
    """
    last_time = series[-1][0] if series else 0.0
    points = [(math.log(time), math.log(error)) for time, error in series
              if time * DECADE > last_time * BEYOND and error > 0]
    return estimate_of(points, 1.0) if len(points) >= FEWEST_POINTS else None


def trend_of(series, size):
    """Returns the trend over the second half of a series: what a straight line gains in the whole time, over `size`.

    None for fewer than two points a block.
    """
    points = [(time, value) for time, value in series if 2 * time > series[-1][0]]
    return estimate_of(points, series[-1][0] / size) if len(points) >= 2 * BLOCKS and size > 0 else None


def estimate_of(points, factor):
    """Returns the slope of points times a factor, with the interval of the block jackknife."""
    blocks = in_blocks(points, BLOCKS)
    others = [slope_of([point for kept in blocks[:k] + blocks[k + 1:] for point in kept]) for k in range(BLOCKS)]
    middle = math.fsum(others) / BLOCKS
    variance = (BLOCKS - 1) / BLOCKS * math.fsum((each - middle)**2 for each in others)
    half = student_t(LEVEL, BLOCKS - 1) * math.sqrt(variance)
    slope = slope_of(points)
    return Estimate(factor * slope, factor * (slope - half), factor * (slope + half))


def slope_of(points):
    """Returns the slope of the straight line through points by least squares."""
    return statistics.linear_regression(*zip(*points)).slope


def in_blocks(values, count):
    """Returns a list in `count` parts of neighbours, whose lengths differ by 1 at most."""
    ends = [len(values) * k // count for k in range(count + 1)]
    return [values[begin:end] for begin, end in zip(ends, ends[1:])]


def judged(series, finished=True, signed=()):
    """Returns the Judgement on a series, a list of (time, error). `finished`: the run came to its end.

    `signed` is the same of means with their sign: a drift shows in them while the error still hides it.
    """
    late = [error for time, error in series if 2 * time > series[-1][0]]
    size = math.fsum(late) / len(late) if late else 0.0
    growth, trend, drift = growth_of(series), trend_of(series, size), trend_of(signed, size)
    return Judgement(verdict_on([error for _, error in series], growth, trend, drift, finished), growth, trend, drift)


def verdict_on(errors, growth, trend, drift, finished):
    """Returns one of VERDICTS for the errors of a run, with the Estimates of its Judgement."""
    if not finished or not errors:
        return FAILED
    if max(errors) >= LOST:
        return ALL_LOST
    if max(errors) < ROUNDING:
        return KEPT
    if growth and growth.low > MIN_GROWTH or drift and max(drift.low, -drift.high) > MIN_DRIFT:
        return GROWS
    stays = all(each.low <= NO_TREND and each.high >= -NO_TREND and abs(each.value) < MAX_TREND
                for each in (trend, drift) if each)
    return BOUNDED if trend and stays else UNDECIDED
