"""Each setting of the study `turbulence`, judged against the reference at its n."""

import statistics
from typing import NamedTuple, Optional, Tuple

import numpy

from lib.records.integrators import KEPT, strongest_structure
from lib.records.settings import steps_to
from lib.judging import verdicts
from studies.turbulence.schema import BASELINE, Ensemble, Quantity, bands_of
from studies.turbulence.statistics import Reference, Spreads, drifts_of, false_positives, reference_of, spreads_of

INVARIANTS = ("energy", "enstrophy")
TOLERANCE = 0.01  # relative: averages of energy and enstrophy that are off by more in some sample are not faithful


class Judged(NamedTuple):
    """A setting at one n. Where a run of it failed all but the first three have no value."""

    ensemble: Ensemble
    keeps: str  # strongest structure of the method, of KEPT
    products: float  # equivalent ones, a unit of time
    scores: Optional[dict] = None  # z by Quantity
    changes: Optional[dict] = None  # of averages of INVARIANTS, relative, the mean over the samples
    worst: Optional[dict] = None  # the largest of these, without sign, of a sample
    within_chance: bool = False  # the distance is at most the threshold
    faithful: bool = False
    spectrum_error: Optional[float] = None  # at the end, the largest of the samples
    times: Tuple[float, ...] = ()  # CPU seconds of one run to T, by process; none where no step was timed

    @property
    def setting(self):
        return self.ensemble.setting

    @property
    def seconds(self):
        """The geometric mean of the times, or None."""
        return statistics.geometric_mean(self.times) if self.times else None

    @property
    def largest(self):
        """The Quantity that is furthest off."""
        return max(self.scores, key=lambda quantity: abs(self.scores[quantity]))

    @property
    def distance(self):
        """The largest |z|, or None."""
        return abs(self.scores[self.largest]) if self.scores else None

    @property
    def conserves(self):
        """Tells whether energy and enstrophy are those of the initial data to TOLERANCE in every sample."""
        return bool(self.worst) and max(self.worst.values()) <= TOLERANCE

    def has(self, structure):
        """Tells whether the method keeps a structure of KEPT, or a stronger one."""
        return list(KEPT).index(self.keeps) >= list(KEPT).index(structure)


class Judgement(NamedTuple):
    """All that is judged at one n."""

    quantities: Tuple[Quantity, ...]
    reference: Reference
    false_positives: float  # share of right ensembles beyond the threshold
    far_distances: Tuple[float, ...]  # of the far ensembles from the reference
    spreads: Spreads
    drifts: dict  # Drift by Quantity, of bands
    judged: dict  # Judged by Setting
    baseline: Optional[Judged]

    @property
    def decides(self):
        """Tells whether there are samples enough for a verdict."""
        return len(self.reference.means) >= verdicts.FEWEST

    @property
    def is_stationary(self):
        return all(drift.is_stationary for drift in self.drifts.values())

    def over_baseline(self, judged):
        """Returns the Ratio of the cost of a setting to that of the baseline, or None where one is not known."""
        if not (judged and judged.times and self.baseline and self.baseline.times):
            return None
        return verdicts.ratio_of(judged.times, self.baseline.times)

    def candidates(self, allowed):
        """Returns the faithful settings of those that are allowed, but the baseline, whose cost is known."""
        return [each for each in self.judged.values() if each.faithful and each.times and allowed(each)
                and each.ensemble.role != BASELINE]

    def cheapest(self, allowed=lambda judged: True):
        """Returns the cheapest faithful setting of those that are allowed, but the baseline, as Judged; or None."""
        return min(self.candidates(allowed), key=lambda each: each.seconds, default=None)

    def level_with_cheapest(self, allowed=lambda judged: True):
        """Returns the other faithful settings that tie with the cheapest, and those not decided against it."""
        found = {each.setting: each for each in self.candidates(allowed)}
        times = {setting: each.times for setting, each in found.items()}
        best = verdicts.fastest(times) if times else None
        ties, undecided = verdicts.level_rows(times)
        return ([each for setting, each in found.items() if setting in ties and setting != best],
                [each for setting, each in found.items() if setting in undecided])


def judgement_of(study, n):
    """Returns the Judgement of a Turbulence at one n."""
    references, far = (values_of(runs) for runs in (study.references[n], study.far[n]))
    spreads, quantities = spreads_of(references, far), quantities_of(study, n)
    if spreads.are_independent:
        reference = reference_of(references)
        right = numpy.concatenate((references, far), axis=1), reference.ensembles
    else:  # the wider spread counts
        reference = reference_of(far).with_means_of(references)
        right = far, reference.ensembles - 1
    energies = numpy.array([[run.bands for run in (*near, *far)]
                            for near, far in zip(study.references[n], study.far[n])])
    judged = {setting: judged_of(study, n, ensemble, quantities, reference)
              for setting, ensemble in study.ensembles[n].items()}
    baseline = study.baseline(n)
    return Judgement(quantities, reference, false_positives(*right),
                    tuple(reference.distance(far[:, ensemble]) for ensemble in range(far.shape[1])), spreads,
                    dict(zip(quantities, drifts_of(energies))), judged, baseline and judged[baseline.setting])


def values_of(runs):
    """Returns the quantities of runs by sample and ensemble: the logarithms of the bands' energies, and decorrelations.

    The array is samples × ensembles × quantities.
    """
    return numpy.array([[[*numpy.log(numpy.mean(run.bands, axis=0)), *run.decorrelations] for run in sample]
                        for sample in runs])


def quantities_of(study, n):
    """Returns the Quantities at one n, in the order of values_of()."""
    degree = study.settings.correlated_degree
    return (*(Quantity(*band) for band in bands_of(n)), *(Quantity(degree, degree, lag) for lag in study.settings.lags))


def judged_of(study, n, ensemble, quantities, reference):
    """Returns one setting as Judged; none is faithful by few samples."""
    setting, cost = ensemble.setting, study.cost(n, ensemble.setting)
    keeps = strongest_structure(study.integrators[setting.integrator])
    products = statistics.fmean(run.products for run in ensemble.runs)
    if not ensemble.works:
        return Judged(ensemble, keeps, products)
    changes = {name: [getattr(run, name) - 1 for run in ensemble.runs] for name in INVARIANTS}
    scores = dict(zip(quantities, map(float, reference.scores(values_of([[run] for run in ensemble.runs])[:, 0]))))
    times = tuple(seconds * steps_to(study.sizes[n].time, setting.step) for seconds in cost.seconds) if cost else ()
    found = Judged(ensemble, keeps, products, scores,
                   {name: statistics.fmean(each) for name, each in changes.items()},
                   {name: max(map(abs, each)) for name, each in changes.items()},
                   spectrum_error=max(run.spectrum_error for run in ensemble.runs), times=times)
    within = len(ensemble.runs) >= verdicts.FEWEST and found.distance <= reference.threshold
    return found._replace(within_chance=within, faithful=within and found.conserves)


def methods_of(found):
    """Returns the integrators with settings that are not the baseline."""
    return list(dict.fromkeys(setting.integrator for setting, judged in found.judged.items()
                              if judged.ensemble.role != BASELINE))
