"""Says how an error of a long run grows: not at all, linearly, like a power of time, or exponentially, and how fast.

What is fitted is the largest error so far: a bounded oscillation leaves it level, and growth keeps its rate. A growth
is fitted between the rounding it starts from and the saturation it ends in.
"""

import math
import statistics
import sys
from dataclasses import dataclass
from typing import Optional

NONE, LINEAR, POWER, EXPONENTIAL = "none", "linear", "power", "exponential"

ROUNDING = 1e-12  # what rounding leaves in 10⁴ steps, as a relative error
# A walk of rounding may look like any growth: below ROUNDING a growth is told only where it is large and its fit is clean,
# and above an exponential only where either is so.
LARGE_GROWTH, CLEAN = 1000, 0.2  # the latter a log residual
SATURATED = 0.1  # relative errors do not grow on beyond the size of what they are errors of
FEWEST_POINTS = 5  # of a fit
LATE = 10  # a drift still grows over the last decade of time, ...
LEAST_EXPONENT = 0.35  # ... by this power of it; what noise and bounded oscillations add is less
LINEAR_EXPONENTS = 0.75, 1.25
MOST_EXPONENT = 8  # a late exponential looks like a higher power; no error of a method grows like one
ABOVE_PLATEAU = 3  # growth is seen where the error is this many times what it was at first
TELLING_GROWTH = 10  # at least, of what is fitted: over less an exponential could as well be a power
# An error that came to a stand has drifted, not oscillated, if it rose from below SMALL up to saturation.
SMALL = 1e-6


@dataclass(frozen=True)
class Drift:
    kind: str
    rate: float  # of value = rate · time, of rate · time^exponent, or of exp(rate · time); 0 for none
    exponent: Optional[float]  # of a power; 1 for linear
    largest: float  # of all values
    reason: str

    @property
    def doubling_time(self):
        """The time in which an exponential drift doubles."""
        return math.log(2) / self.rate


@dataclass(frozen=True)
class Line:
    """A line fitted to logarithms of values."""

    slope: float
    intercept: float
    residual: float  # root mean square


def drift(series):
    """Returns the Drift of a series of (time, value), time rising; None where there are too few points to tell."""
    series = [(time, value) for time, value in series if time > 0]
    if len(series) < FEWEST_POINTS:
        return None
    largest = max(value for _, value in series)
    if largest == 0:
        return Drift(NONE, 0.0, None, 0.0, "exactly 0 in every sample")
    so_far = largest_so_far(series)
    late = late_exponent(so_far)
    if late < LEAST_EXPONENT and not rose_to_saturation(so_far):
        return Drift(NONE, 0.0, None, largest, f"level: like time^{late:.2f} over the last decade of time")
    part = growing_part(so_far)
    if len(part) < FEWEST_POINTS:
        return Drift(NONE, 0.0, None, largest, "level: hardly a sample stands out")
    return fitted(part, so_far, largest)


def fitted(part, so_far, largest):
    """Decides between a power and an exponential by which of them fits the logarithm of the error better.

    Of a power the exponent is that of the last decade of time: errors may grow otherwise until rough modes are there.
    """
    power, exponential = fit_power(part), fit_exponential(part)
    walks = power.slope < LINEAR_EXPONENTS[0] or largest < LARGE_GROWTH * so_far[0][1]
    if largest < ROUNDING and (walks or min(exponential.residual, power.residual) > CLEAN):
        return Drift(NONE, 0.0, None, largest, f"reaches no more than rounding, like time^{power.slope:.2f}")
    if is_exponential(part, power, exponential):
        return Drift(EXPONENTIAL, exponential.slope, None, largest, reason("an exponential", part, exponential, power))
    late = [(time, value) for time, value in part if time >= part[-1][0] / LATE]
    return late_power(late if len(late) >= FEWEST_POINTS else part, largest,
                      reason("a power", part, power, exponential))


def is_exponential(part, power, exponential):
    better = exponential.residual < power.residual or power.slope > MOST_EXPONENT
    growth = part[-1][1] / part[0][1]
    return better and (growth >= LARGE_GROWTH or (growth >= TELLING_GROWTH and exponential.residual <= CLEAN))


def late_power(part, largest, why):
    power = fit_power(part)
    low, high = LINEAR_EXPONENTS
    if power.slope < LEAST_EXPONENT:
        return Drift(NONE, 0.0, None, largest, f"level: like time^{power.slope:.2f} from t = {part[0][0]:.3g} on")
    if low <= power.slope <= high:
        rate = finite_exp(statistics.median(math.log(value) - math.log(time) for time, value in part))
        return Drift(LINEAR, rate, 1.0, largest, why)
    return Drift(POWER, finite_exp(power.intercept), power.slope, largest, why)


def reason(kind, part, chosen, other):
    return (f"{kind} fits better (log residual {chosen.residual:.2g} against {other.residual:.2g}) over {len(part)}"
            f" samples, t = {part[0][0]:.3g} to {part[-1][0]:.3g}")


def fit_power(part):
    return fit([math.log(time) for time, _ in part], [math.log(value) for _, value in part])


def fit_exponential(part):
    return fit([time for time, _ in part], [math.log(value) for _, value in part])


def largest_so_far(series):
    """Returns the largest value up to each time, from the first that is not 0."""
    found, largest = [], 0.0
    for time, value in series:
        largest = max(largest, value)
        if largest > 0:
            found.append((time, largest))
    return found


def late_exponent(so_far):
    """Returns the power of time by which the error grew over the last decade of time, or what there is of it."""
    end, last = so_far[-1]
    before = [(time, value) for time, value in so_far if time <= end / LATE]
    begin, first = before[-1] if before else so_far[0]
    span = math.log(end / begin)
    return math.log(last / first) / span if span > 0 else 0.0


def rose_to_saturation(so_far):
    return so_far[0][1] <= SMALL and so_far[-1][1] >= SATURATED


def grows(points):
    return points[-1][1] >= TELLING_GROWTH * points[0][1]


def growing_part(so_far):
    """Returns the points between the plateau and saturation, if that leaves enough of them to tell; else what does."""
    first, top = so_far[0][1], so_far[-1][1]
    risen = [point for point in so_far if point[1] > ABOVE_PLATEAU * first]
    saturation = min(SATURATED, 0.3 * top) if top >= SATURATED else math.inf
    choices = (
        [point for point in risen if ROUNDING < point[1] <= saturation],
        [point for point in risen if point[1] <= saturation],
        [point for point in so_far if point[1] <= saturation],
    )
    return next((part for part in choices if len(part) >= FEWEST_POINTS and grows(part)), so_far)


def fit(x, y):
    """Fits a line by least squares; a lone abscissa has slope 0."""
    if max(x) == min(x):
        return Line(0.0, statistics.fmean(y), statistics.pstdev(y))
    scale = max(map(abs, x))  # squares of very long or short times are no numbers
    slope, intercept = statistics.linear_regression([each / scale for each in x], y)
    squares = statistics.fmean((slope * each / scale + intercept - value) ** 2 for each, value in zip(x, y))
    return Line(slope / scale, intercept, math.sqrt(squares))


def finite_exp(exponent):
    return math.exp(min(exponent, math.log(sys.float_info.max)))
