"""Whether repetitions of a measurement rise or fall with their order, by rank correlation. Standard library only.

A round repeats all series once, so that a slow minute of the machine falls on all of them. The rounds, and not single
times, are therefore what a test may permute.
"""

import itertools
import math
import random
import statistics
from typing import NamedTuple

LEVEL = 0.01  # a trend is one that so small a share of the orders of the rounds would show by chance
LEAST_CHANGE = 0.01  # of times; what changes less is no matter for a page that prints two or three digits
FEWEST_ROUNDS = 6  # 720 orders; of fewer rounds, no order is rare enough
MOST_EXACT = 7  # rounds whose orders are all tried, 5040; of more, DRAWN orders are drawn
DRAWN, SEED = 5040, 1


class Trend(NamedTuple):
    """What the times of some series show, each with one time for each round."""

    series: int
    rounds: int
    correlation: float  # Spearman's, of time and round: the mean over the series
    probability: float  # share of the orders of the rounds with at least this correlation, up or down
    change: float  # geometric mean of the later half of the rounds over the earlier, less 1

    def is_shown(self):
        """Tells whether the times rise or fall with their order by more than chance, and by enough to matter."""
        return self.probability < LEVEL and abs(self.change) > LEAST_CHANGE


def ranks(values):
    """Returns the rank of each value, from 1; equal values share the mean of their ranks."""
    ordered = sorted(values)
    first = {value: ordered.index(value) + 1 for value in set(values)}
    return [first[value] + (ordered.count(value) - 1) / 2 for value in values]


def normalised(values):
    """Returns values less their mean, over their root sum of squares; zeros if all are equal."""
    mean = statistics.fmean(values)
    centred = [value - mean for value in values]
    size = math.sqrt(math.fsum(value * value for value in centred))
    return [value / size if size else 0.0 for value in centred]


def rank_correlation(values):
    """Returns Spearman's rank correlation of values with their order; 0 if all are equal."""
    order = normalised(range(len(values)))
    return math.fsum(x * y for x, y in zip(normalised(ranks(values)), order))


def trend_of(series):
    """Returns the Trend of series of positive times; of those with the most rounds, as only they share all rounds.

    None where there are fewer than FEWEST_ROUNDS. Spearman's correlation is linear in the normalised ranks, so that its
    mean over the series is that of their mean, whatever the order of the rounds.
    """
    rounds = max(map(len, series), default=0)
    if rounds < FEWEST_ROUNDS:
        return None
    whole = [each for each in series if len(each) == rounds]
    order = normalised(range(rounds))
    mean = [statistics.fmean(column) for column in zip(*(normalised(ranks(each)) for each in whole))]

    def correlation(permuted):
        return math.fsum(x * y for x, y in zip(permuted, order))

    found = correlation(mean)
    tried = [abs(correlation(each)) for each in orders_of(mean)]
    half = rounds // 2
    logarithms = [statistics.fmean(map(math.log, each[-half:])) - statistics.fmean(map(math.log, each[:half]))
                  for each in whole]
    return Trend(len(whole), rounds, found, sum(each >= abs(found) - 1e-12 for each in tried) / len(tried),
                 math.expm1(statistics.fmean(logarithms)))


def orders_of(values):
    """Returns values in all orders, or in DRAWN of them, always the same, with the given one first."""
    if len(values) <= MOST_EXACT:
        return itertools.permutations(values)
    shuffled = random.Random(SEED)
    return [values, *(shuffled.sample(values, len(values)) for _ in range(DRAWN - 1))]
