"""Whether an error that is watched over a long run stays bounded, grows like a power of time, or is lost.

An error is given as maxima over windows of time, or as samples. A power t^p is fitted to the last decade of time by
least squares of the logarithms. Neighbouring windows are not independent. So the 95 % interval of p is that of the
block jackknife: the fit is repeated without each of ten blocks of neighbours, and Student's t is applied to the spread
of these powers. Standard library only.

Source: Künsch, The jackknife and the bootstrap for general stationary observations, Annals of Statistics 17 (1989).
"""

import math
from typing import NamedTuple, Optional

from lib.verdicts import LEVEL, UNDECIDED, student_t

DECADE = 10  # the fit begins at the last time over this
FEWEST_POINTS = 30  # that a fit takes
BLOCKS = 10  # of neighbouring points, of equal numbers

ROUNDING = 1e-10  # a relative error that never reaches this is kept
LOST = 0.1  # one that reaches this is lost, whatever its power
# Powers. An error grows if its interval lies above LEAST_GROWTH, and is bounded if it ends below MOST_BOUNDED. Bounded
# noise of a tenth of its size gives intervals within ±0.1, or ±0.25 if correlated. A linear drift gives one around 1,
# a random walk a wide one around 0.5 (tests/scripts/test_longruns.py).
LEAST_GROWTH, MOST_BOUNDED = 0.1, 0.3

KEPT, BOUNDED, GROWS, ALL_LOST, FAILED = "kept", "bounded", "grows", "lost", "failed"
VERDICTS = (KEPT, BOUNDED, GROWS, UNDECIDED, ALL_LOST, FAILED)


class Growth(NamedTuple):
    """The power p of t^p, with its 95 % interval."""

    power: float
    low: float
    high: float


class Judgement(NamedTuple):
    verdict: str  # of VERDICTS
    growth: Optional[Growth]  # None where too few values are above 0


def growth_of(series):
    """Returns the Growth over the last decade of a series, a list of (time, error) with rising times.

    Values of 0 have no logarithm and are left out. None if fewer than FEWEST_POINTS remain.
    """
    last_time = series[-1][0] if series else 0.0
    points = [(math.log(time), math.log(error)) for time, error in series if time * DECADE > last_time and error > 0]
    if len(points) < FEWEST_POINTS:
        return None
    power = power_of(points)
    blocks = in_blocks(points, BLOCKS)
    others = [power_of([point for kept in blocks[:k] + blocks[k + 1:] for point in kept]) for k in range(BLOCKS)]
    middle = math.fsum(others) / BLOCKS
    variance = (BLOCKS - 1) / BLOCKS * math.fsum((each - middle)**2 for each in others)
    half = student_t(LEVEL, BLOCKS - 1) * math.sqrt(variance)
    return Growth(power, power - half, power + half)


def power_of(points):
    """Returns the slope of the straight line through points by least squares."""
    mean_x, mean_y = (math.fsum(values) / len(points) for values in zip(*points))
    spread = math.fsum((x - mean_x)**2 for x, _ in points)
    return math.fsum((x - mean_x) * (y - mean_y) for x, y in points) / spread


def in_blocks(values, count):
    """Returns a list in `count` parts of neighbours, whose lengths differ by 1 at most."""
    ends = [len(values) * k // count for k in range(count + 1)]
    return [values[begin:end] for begin, end in zip(ends, ends[1:])]


def judged(series, finished=True):
    """Returns the Judgement on a series, a list of (time, error). `finished`: the run came to its end."""
    growth = growth_of(series)
    return Judgement(verdict_on([error for _, error in series], growth, finished), growth)


def verdict_on(errors, growth, finished):
    """Returns one of VERDICTS for the errors of a run and their Growth or None."""
    if not finished or not errors:
        return FAILED
    if max(errors) >= LOST:
        return ALL_LOST
    if max(errors) < ROUNDING:
        return KEPT
    if growth is None:
        return UNDECIDED
    if growth.low > LEAST_GROWTH:
        return GROWS
    return BOUNDED if growth.high < MOST_BOUNDED else UNDECIDED
