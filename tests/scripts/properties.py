"""What the property tests share: how inputs are drawn, and times of processes.

Hypothesis draws inputs and, where a property fails, looks for the smallest that breaks it. It draws the same ones in
every run, so that a failure repeats. A busy machine fails none, as there is no time limit.
"""

import functools
import math
import random

import programs  # noqa: F401 (finds the modules of scripts/lib)
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as draw


def power_of_ten(exponent):
    return 10.0**exponent


def decades(lowest, highest):
    """Draws numbers from 10^lowest to 10^highest.

    Like all strategies here it has no lambda: hypothesis would read its source, which takes seconds.
    """
    return draw.floats(lowest, highest).map(power_of_ten)


PACES = draw.floats(-12.0, 3.0).map(math.exp)  # seconds: 6 µs to 20 s
NEAR_ONE = draw.floats(-0.2, 0.2).map(math.exp)  # ratios about the margin of 5 %
SEEDS = draw.integers(0, 2**32)  # of noise that is cheaper to make than to draw
SPREADS = draw.sampled_from((0.0, 0.002, 0.01, 0.03, 0.1))  # of the logarithms of times, from process to process


def holds_for(examples=60, **drawn):
    """Decorates a test method: it is called with so many drawn values of each argument."""
    def decorated(method):
        method = given(**drawn)(method)
        return settings(max_examples=examples, deadline=None, derandomize=True, database=None,
                        suppress_health_check=list(HealthCheck))(method)
    return decorated


def times_of_rows(rows=2, minimum=1, maximum=14):
    """Draws the times of some rows by process: lists of equal lengths, in the same order of processes.

    Each process has a pace of its own. Each row has a ratio to it, and its times spread about that.
    """
    def made(count, ratios, spreads, noise):
        paces = [math.exp(noise.uniform(-12, 3)) for _ in range(count)]
        return [[pace * ratio * math.exp(spread * noise.uniform(-1, 1)) for pace in paces]
                for ratio, spread in zip(ratios, spreads)]

    return draw.builds(made, draw.integers(minimum, maximum), draw.tuples(*[NEAR_ONE] * rows),
                       draw.tuples(*[SPREADS] * rows), SEEDS.map(random.Random))


def fails(test, **drawn):
    """Tells whether a property, a function that asserts it, fails for some drawn input: for controls."""
    try:
        functools.partial(holds_for(**drawn)(test))()
    except AssertionError:
        return True
    return False
