"""Whether an ensemble of turbulent runs has the statistics of a reference. Standard library only.

Of each run the logarithms of its time-averaged E(l) are compared, over the degrees l that have more than LEAST_SHARE of
the energy. The difference of a run from the reference is paired by draw: minus the mean over the reference ensembles,
which start from the same draw, DISPLACEMENT apart. The *distance* of an ensemble is

    D = sqrt( mean over l of ( mean over draws of the difference at l )² ),

so that 0.05 is a spectrum that is wrong by 5 %, root mean square over the degrees.

The reference is not known exactly, since its time is finite. How far apart two ensembles of the same flow come out is
found from the reference ensembles themselves: each of COUNT bootstrap samples takes as many draws as there are, with
replacement, and of each one reference run, chosen at random, against the mean of the others. An ensemble is *faithful*
if its distance is at most the LEVEL quantile of these. A fresh reference ensemble then is in about 95 of 100 cases.
"""

import math
import random
import statistics
from typing import NamedTuple, Tuple

LEAST_SHARE = 1e-6  # of the energy, that a degree must have to count
LEVEL = 0.95
COUNT = 2000  # bootstrap samples: the quantile is good to some 2 %
SEED = 20261125


class Reference(NamedTuple):
    """The reference at one n, with the distance at most of which an ensemble is faithful."""

    degrees: Tuple[int, ...]  # that are compared
    means: Tuple[Tuple[float, ...], ...]  # of the logarithms of E(l) over the ensembles: draws × degrees
    threshold: float
    typical: float  # the median distance of reference ensembles from one another

    def differences(self, spectra):
        """Returns the differences of an ensemble from the reference, draws × degrees, given E(l) of each draw."""
        return [[own - mean for own, mean in zip(logarithms(spectrum, self.degrees), means)]
                for spectrum, means in zip(spectra, self.means, strict=True)]

    def distance(self, spectra):
        """Returns the distance D of an ensemble, given E(l), l = 1 …, of each draw; infinite if an E(l) is 0."""
        return distance(self.differences(spectra))

    def is_faithful(self, spectra):
        return self.distance(spectra) <= self.threshold


def reference_of(spectra):
    """Returns the Reference of some ensembles: `spectra[draw][ensemble]` lists E(l), l = 1 …. At least two ensembles.

    Throws ValueError if there are fewer: they tell nothing of how far two come apart.
    """
    if min(map(len, spectra)) < 2:
        raise ValueError("fewer than two reference ensembles")
    degrees = compared_degrees([spectrum for draw in spectra for spectrum in draw])
    values = [[logarithms(spectrum, degrees) for spectrum in draw] for draw in spectra]
    means = tuple(tuple(statistics.fmean(column) for column in zip(*draw)) for draw in values)
    null = sorted(null_distances(values))
    return Reference(degrees, means, quantile(null, LEVEL), quantile(null, 0.5))


def compared_degrees(spectra):
    """Returns the degrees that have more than LEAST_SHARE of the energy, in the mean over some spectra."""
    energies = [statistics.fmean(column) for column in zip(*spectra)]
    return tuple(degree for degree, energy in enumerate(energies, 1) if energy > LEAST_SHARE * math.fsum(energies))


def logarithms(spectrum, degrees):
    return [math.log(spectrum[degree - 1]) if spectrum[degree - 1] > 0 else -math.inf for degree in degrees]


def distance(differences):
    """Returns the root mean square over the degrees of the mean over the draws, of differences draws × degrees."""
    return math.sqrt(statistics.fmean(statistics.fmean(column) ** 2 for column in zip(*differences)))


def null_distances(values):
    """Returns the distances of COUNT bootstrap samples of the reference, given logarithms[draw][ensemble][degree]."""
    left_out = [against_others(draw) for draw in values]
    chosen = random.Random(SEED)
    return [distance([chosen.choice(chosen.choice(left_out)) for _ in left_out]) for _ in range(COUNT)]


def against_others(runs):
    """Returns the difference of each run of a draw from the mean of the others, as lists over the degrees."""
    sums, others = [math.fsum(column) for column in zip(*runs)], len(runs) - 1
    return [[value - (total - value) / others for value, total in zip(run, sums)] for run in runs]


def quantile(rising, level):
    """Returns the least of some rising values that at least the share `level` of them does not exceed."""
    return rising[max(0, math.ceil(level * len(rising)) - 1)]
