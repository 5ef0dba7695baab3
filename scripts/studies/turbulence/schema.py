"""The raw file of the study `turbulence`: what runs of drawn turbulence average to, and what they cost.

A *sample* is one set of initial data, counted from 0. A *setting* is an integrator with a step and a tolerance. A
*reference ensemble* has one run a sample, from data that were moved along their coadjoint orbit at constant energy.
Those of the reference are moved little; *far* ensembles are moved much, to see whether the distance at the start
matters.
"""

from typing import Dict, NamedTuple, Optional, Tuple

from lib.programs.messages import UnusableFile
from lib.records import formats
from lib.records.formats import (CONVERGED, SWEEP_CAP, Integrator, Schema, keyed, list_of, number, one_of, optional,
                                 positive, status, text, whole)

REFERENCE, FAR, METHOD, BASELINE = ROLES = ("reference", "far", "method", "baseline")
EARLIER_ROLES = {"practice": BASELINE}  # what older files call one
BASELINE_INTEGRATOR, BASELINE_SHARE = "algebra1", 0.25  # isospectral midpoint, h = ħ/4
LOOSE = 1e-8
BAND_ENDS = (2, 5, 10, 20, 40, 80, 160, 320, 640)  # largest degree l of each band
QUARTERS = 4  # of the averaging stretch T/2 … T
LAGS = 2  # number of time correlations


def bands_of(n):
    """Returns the bands of degrees at an n as (lowest l, highest l), up to n − 1."""
    starts = (1, *(end + 1 for end in BAND_ENDS))
    return [(low, min(high, n - 1)) for low, high in zip(starts, BAND_ENDS) if low < n]


class Settings(NamedTuple):
    lowest_degree: whole(1)  # of the modes that are drawn
    highest_degree: whole(1)
    displacement: positive  # of reference ensembles, relative to ‖W₀‖
    far_displacement: positive  # of far ensembles
    correlated_degree: whole(1)  # l of the coefficients whose decorrelation is recorded
    lags: list_of(positive, LAGS)  # units of time
    energy_loss: positive  # relative: a run that is off by more is unstable
    max_sweeps: whole(1)  # of a step of a fast form
    warm_steps: whole()  # before those that are timed


class Size(NamedTuple):
    """What was run at one n."""

    n: whole(2)
    samples: whole(2)
    references: whole(3)  # ensembles, of which two are left if one is held out
    far: whole(4)  # ensembles, which may be judged by three of them
    time: positive  # T of a run; averages are those of T/2 … T
    reference_integrator: text
    reference_step: positive
    reference_error: number  # relative, of W(20) of the first sample: at this step against half of it
    norm_B: positive  # ‖B(W₀)‖₂, the mean over the samples


class RunRow(NamedTuple):
    """One run; its averages over T/2 … T are None where it did not come to its end."""

    n: whole(2)
    role: one_of(*ROLES, renamed=EARLIER_ROLES)
    integrator: text
    step: positive
    tolerance: positive
    sample: whole()
    ensemble: whole()  # of reference and far ones; 0 for all others
    status: status
    time: number  # that it came to
    products: number  # equivalent ones, a unit of time
    energy_error: optional(number)  # relative, the largest that was seen; None where not finite
    spectrum_error: optional(number)  # at the end
    energy: optional(number)  # averages, relative to the initial values
    enstrophy: optional(number)
    bands: optional(list_of(list_of(positive), QUARTERS))  # average energy of each band, by quarters of T/2 … T
    decorrelations: optional(list_of(number, LAGS))  # mean |Δω|² over a lag, over twice the mean |ω|²: 0 … about 1

    @property
    def works(self):
        return self.status == CONVERGED


class Cost(NamedTuple):
    """CPU time of a step, from the state of the first sample at T/2."""

    n: whole(2)
    integrator: text
    step: positive
    tolerance: positive
    steps: whole(1)  # that are timed, after some that are not
    seconds: list_of(positive)  # of a step, by process; each process times all that has a cost at its n


SCHEMA = Schema("turbulence", Settings, {"integrators": Integrator, "sizes": Size, "runs": RunRow, "costs": Cost},
                renamed={"draw": "sample", "draws": "samples"})


class Setting(NamedTuple):
    """A method with its step and tolerance."""

    integrator: str
    step: float
    tolerance: float


class Quantity(NamedTuple):
    """What ensembles are compared by: the energy in a band of degrees l, or the decorrelation of one l after a lag."""

    lowest: int  # l
    highest: int
    lag: Optional[float] = None  # units of time; None for a band


class Ensemble(NamedTuple):
    """The runs of one setting at one n, a sample each."""

    setting: Setting
    role: str
    runs: Tuple[RunRow, ...]  # by sample

    @property
    def works(self):
        return all(run.works for run in self.runs)

    @property
    def lost(self):
        """The runs that failed or lost their energy."""
        return [run for run in self.runs if not run.works]

    @property
    def failed(self):
        """The number of samples whose run failed."""
        return len(self.lost)

    @property
    def capped(self):
        """The number of samples whose run was ended by the sweep cap, which is lower here than the default."""
        return sum(run.status == SWEEP_CAP for run in self.runs)


class Turbulence(NamedTuple):
    """A whole study, by n."""

    settings: Settings
    integrators: Dict[str, Integrator]
    sizes: Dict[int, Size]
    references: Dict[int, Tuple[Tuple[RunRow, ...], ...]]  # n: samples, each a run for each ensemble
    far: Dict[int, Tuple[Tuple[RunRow, ...], ...]]  # of far ensembles
    ensembles: Dict[int, Dict[Setting, Ensemble]]  # without references and far ones
    costs: Dict[Tuple[int, Setting], Cost]
    context: Dict[str, str]

    def baseline(self, n):
        """Returns the Ensemble of the baseline, or None."""
        return next((each for each in self.ensembles[n].values() if each.role == BASELINE), None)

    def cost(self, n, setting):
        """Returns the Cost of a setting's step, or None where there is none."""
        return self.costs.get((n, setting))


def setting_of(row):
    return Setting(row.integrator, row.step, row.tolerance)


def read_turbulence(path):
    """Returns the Turbulence in `path`. Throws UnusableFile with one line that names the file and what is wrong."""
    return formats.read_study(path, SCHEMA, turbulence)


def turbulence(study):
    """Returns the Turbulence of a Study. Throws UnusableFile where it has no runs, or an incomplete ensemble."""
    tables = study.tables
    sizes = keyed(tables["sizes"], "n")
    if not tables["runs"]:
        raise UnusableFile("has no runs")
    if unknown := {row.n for row in tables["runs"]} - set(sizes):
        raise UnusableFile(f"has runs at n = {min(unknown)}, which its sizes do not list")
    integrators = keyed(tables["integrators"], "name")
    named = [row.reference_integrator for row in tables["sizes"]]
    named += [row.integrator for row in (*tables["runs"], *tables["costs"])]
    if unknown := set(named) - set(integrators):
        raise UnusableFile(f"does not list the integrator {min(unknown)}")
    for row in tables["runs"]:
        if row.works and (row.bands is None or {len(quarter) for quarter in row.bands} != {len(bands_of(row.n))}
                          or None in (row.decorrelations, row.energy, row.enstrophy)):
            raise UnusableFile(f"has a run at n = {row.n} without its averages")
    references, far, ensembles = {}, {}, {}
    for n, size in sizes.items():
        rows = [row for row in tables["runs"] if row.n == n]
        references[n] = every_run(rows, REFERENCE, size, size.references)
        far[n] = every_run(rows, FAR, size, size.far)
        ensembles[n] = ensembles_of([row for row in rows if row.role in (METHOD, BASELINE)], size)
        if len({len(row.seconds) for row in tables["costs"] if row.n == n}) > 1:
            raise UnusableFile(f"has costs at n = {n} from different numbers of processes")
    costs = {(row.n, setting_of(row)): row for row in tables["costs"]}
    return Turbulence(study.settings, integrators, sizes, references, far, ensembles, costs, study.context)


def every_run(rows, role, size, count):
    """Returns the runs of `count` ensembles of a role, by sample. Throws UnusableFile where one is missing."""
    own = {(row.sample, row.ensemble): row for row in rows if row.role == role}
    wanted = {(sample, ensemble) for sample in range(size.samples) for ensemble in range(count)}
    if set(own) != wanted or not all(row.works for row in own.values()):
        raise UnusableFile(f"has not every {role} run at n = {size.n}")
    return tuple(tuple(own[sample, ensemble] for ensemble in range(count)) for sample in range(size.samples))


def ensembles_of(rows, size):
    """Returns the Ensembles among the rows at one n, by Setting. Throws UnusableFile for one without all samples."""
    found = {}
    for row in rows:
        found.setdefault(setting_of(row), []).append(row)
    for setting, runs in found.items():
        if sorted(row.sample for row in runs) != list(range(size.samples)):
            raise UnusableFile(f"has not every sample of {setting.integrator} with h = {setting.step:g}"
                               f" at n = {size.n}")
    return {setting: Ensemble(setting, runs[0].role, tuple(sorted(runs, key=lambda row: row.sample)))
            for setting, runs in found.items()}
