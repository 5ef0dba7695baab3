"""Whether repetitions of a measurement rise or fall with their order, by rank correlation. Needs SciPy.

A round repeats all series once, so that a slow minute of the machine falls on all of them. The rounds, and not single
times, are therefore what a test may permute.
"""

from typing import NamedTuple

import numpy
import scipy.stats

LEVEL = 0.01  # a trend is one that so small a share of the orders of the rounds would show by chance
MIN_CHANGE = 0.01  # of times; what changes less is no matter for a page that prints two or three digits
FEWEST_ROUNDS = 6  # 720 orders; of fewer rounds, no order is rare enough
ORDERS, SEED = 5040, 1  # that are tried at most: all of seven rounds, of more as many that are drawn


class Trend(NamedTuple):
    """What the times of some series show, each with one time for each round."""

    series: int
    rounds: int
    correlation: float  # Spearman's, of time and round: the mean over the series
    probability: float  # share of the orders of the rounds with at least this correlation, up or down
    change: float  # geometric mean of the later half of the rounds over the earlier, less 1

    def is_shown(self):
        """Tells whether the times rise or fall with their order by more than chance, and by enough to matter."""
        return self.probability < LEVEL and abs(self.change) > MIN_CHANGE


def trend_of(series):
    """Returns the Trend of series of positive times; of those with the most rounds, as only they share all rounds.

    None where there are fewer than FEWEST_ROUNDS. Spearman's correlation is linear in the normalised ranks, so that its
    mean over the series is that of their mean, whatever the order of the rounds. A series of equal times has none: it
    counts as 0.
    """
    rounds = max(map(len, series), default=0)
    if rounds < FEWEST_ROUNDS:
        return None
    whole = numpy.array([each for each in series if len(each) == rounds])
    mean, order = normalised(scipy.stats.rankdata(whole, axis=1)).mean(axis=0), normalised(numpy.arange(rounds))
    permuted = scipy.stats.permutation_test(
        (mean,), lambda values, axis: abs((values * order).sum(axis=axis)), vectorized=True,
        permutation_type="pairings", alternative="greater", n_resamples=ORDERS, random_state=SEED)
    half, logarithms = rounds // 2, numpy.log(whole)
    change = logarithms[:, -half:].mean() - logarithms[:, :half].mean()
    return Trend(len(whole), rounds, float(mean @ order), float(permuted.pvalue), float(numpy.expm1(change)))


def normalised(values):
    """Returns values less their mean, over their root sum of squares, along the last axis; zeros if all are equal."""
    centred = values - numpy.mean(values, axis=-1, keepdims=True)
    size = numpy.linalg.norm(centred, axis=-1, keepdims=True)
    return centred / numpy.where(size > 0, size, 1)
