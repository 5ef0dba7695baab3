"""Whether an ensemble of turbulent runs has the statistics of a reference. Needs NumPy.

Each run has some quantities: the logarithm of the time-averaged energy in each band of degrees, and decorrelations over
some lags. An ensemble has one run a sample. Its difference from the reference is paired by sample: minus the mean over
the reference ensembles, which start from the same sample. The *score* z of a quantity is the mean difference over the
samples, over its standard deviation by chance, which the spread of reference runs of one sample gives. So each quantity
is weighted by how well it is known. The *distance* of an ensemble is its largest |z|.

The threshold comes from the references: in each of COUNT samples one run of each sample is held out at random and
judged against the others, exactly as a setting is. A setting is within chance if its distance is at most the LEVEL
quantile. The unit is the sample: its run is chosen apart from those of other samples.

Where reference runs spread less than far ones, they share a history. Then the spread of far runs counts, which is
wider: the differences are still those from the mean of the reference ensembles, whose data are nearly the sample's own.

SciPy has no test that holds out an ensemble by samples, and its bootstrap would sample other samples than the record
has.
"""

from typing import NamedTuple

import numpy

from lib.judging.verdicts import student_t

LEVEL = 0.95
COUNT = 4000  # samples behind a threshold
TRIALS, TRIAL_COUNT = 1000, 400  # ensembles behind the rate of false positives, and samples behind each threshold there
RESAMPLED = 2000  # sets of samples behind an interval
SEED = 20261128
# References are independent where their spread is this share of that of far ensembles or more, at 97.5 %.
MIN_SPREAD = 0.75


class Reference(NamedTuple):
    """The reference at one n, with the distance at most of which an ensemble is within chance."""

    means: numpy.ndarray  # over the ensembles: samples × quantities
    deviations: numpy.ndarray  # standard deviation of a run, samples apart: one a quantity
    ensembles: int
    threshold: float

    def with_means_of(self, values):
        """Returns a Reference with the means of other ensembles, samples × ensembles × quantities.

        Their number is taken for that of its own. If they are more, scores are a little too small.
        """
        return self._replace(means=values.mean(axis=1))

    @property
    def chance(self):
        """The standard deviation of the mean difference of a right ensemble, one a quantity."""
        return self.deviations * numpy.sqrt((1 + 1 / self.ensembles) / len(self.means))

    def scores(self, values):
        """Returns the score z of each quantity of an ensemble, given its values, samples × quantities."""
        return (values - self.means).mean(axis=0) / self.chance

    def distance(self, values):
        """Returns the largest |z| of an ensemble, given its values, samples × quantities."""
        return float(abs(self.scores(values)).max())


def reference_of(values, count=COUNT, seed=SEED):
    """Returns the Reference of some ensembles, given their values, samples × ensembles × quantities.

    Throws ValueError for fewer than three ensembles: one is held out, and two others tell a spread.
    """
    samples, ensembles, _ = values.shape
    if ensembles < 3:
        raise ValueError("fewer than three reference ensembles")
    chosen = numpy.random.default_rng(seed).integers(ensembles, size=(count, samples))
    threshold = quantile(held_out(values, chosen), LEVEL)
    return Reference(values.mean(axis=1), numpy.sqrt(values.var(axis=1, ddof=1).mean(axis=0)), ensembles, threshold)


def held_out(values, chosen):
    """Returns the distances of ensembles that are held out of the reference, each judged against the others.

    `values` are samples × ensembles × quantities, `chosen` the ensembles whose run is taken: samples × samples.
    """
    samples, ensembles, _ = values.shape
    values = values - values.mean(axis=1, keepdims=True)
    own, others = values[numpy.arange(samples), chosen], ensembles - 1
    means = -own / others  # of the others
    variances = ((values ** 2).sum(axis=1) - own ** 2 - others * means ** 2).mean(axis=1) / (others - 1)
    scores = (own - means).mean(axis=1) / numpy.sqrt(variances * (1 + 1 / others) / samples)
    return abs(scores).max(axis=1)


def quantile(values, level):
    """Returns the least of some values that at least the share `level` of them does not exceed."""
    return float(numpy.quantile(values, level, method="inverted_cdf"))


def false_positives(runs, ensembles):
    """Returns the share of right ensembles that lie beyond the threshold, measured on TRIALS of them.

    Each takes one of the `runs` of each sample, samples × runs × quantities, at random, and is judged by so many
    ensembles of the others, whose threshold is found anew.
    """
    rng, found, (samples, count, _) = numpy.random.default_rng(SEED + 1), 0, runs.shape
    for trial in range(TRIALS):
        order = rng.permuted(numpy.tile(numpy.arange(count), (samples, 1)), axis=1)[:, :ensembles + 1]
        own, others = numpy.split(numpy.take_along_axis(runs, order[:, :, None], axis=1), [1], axis=1)
        reference = reference_of(others, TRIAL_COUNT, SEED + trial)
        found += reference.distance(own[:, 0]) > reference.threshold
    return found / TRIALS


class Spreads(NamedTuple):
    """The spread of reference runs over that of far runs, samples apart, with its 95 % interval by resampled samples.

    Arrays with an entry a quantity, and at the end one for their geometric mean.
    """

    ratio: numpy.ndarray
    low: numpy.ndarray
    high: numpy.ndarray

    @property
    def are_independent(self):
        """Tells whether references that begin close to each other spread as far ones do."""
        return bool(self.low[-1] >= MIN_SPREAD)


def spreads_of(references, far):
    """Returns the Spreads of reference ensembles over far ones, given samples × ensembles × quantities of both."""
    variances = [values.var(axis=1, ddof=1) for values in (references, far)]

    def ratios(samples):
        own, other = (each[samples].mean(axis=-2) for each in variances)
        logarithms = numpy.log(own / other) / 2
        return numpy.exp(numpy.concatenate((logarithms, logarithms.mean(axis=-1, keepdims=True)), axis=-1))

    samples = len(references)
    resampled = ratios(numpy.random.default_rng(SEED + 2).integers(samples, size=(RESAMPLED, samples)))
    ends = numpy.quantile(resampled, [(1 - LEVEL) / 2, (1 + LEVEL) / 2], axis=0)
    return Spreads(ratios(numpy.arange(samples)), *ends)


class Drift(NamedTuple):
    """The change of each band's energy from the first to the last quarter of the averaging stretch."""

    change: float  # relative
    score: float  # over its standard error, by samples
    critical: float  # |score| beyond which the change is no chance, at 95 % over all bands

    @property
    def is_stationary(self):
        return abs(self.score) <= self.critical


def drifts_of(energies):
    """Returns the Drift of each band, given energies of runs: samples × ensembles × quarters × bands."""
    changes = numpy.log(energies[:, :, -1] / energies[:, :, 0]).mean(axis=1)
    samples, bands = changes.shape
    means = changes.mean(axis=0)
    scores = means / (changes.std(axis=0, ddof=1) / numpy.sqrt(samples))
    critical = student_t(1 - (1 - LEVEL) / bands, samples - 1)
    return [Drift(float(change), float(score), critical) for change, score in zip(numpy.expm1(means), scores)]
