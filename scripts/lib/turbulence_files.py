"""The raw file of scripts/studies/turbulence.py: what runs of drawn turbulence average to, and what they cost.

A *draw* is one set of initial data, counted from 0. A *setting* is an integrator with a step and a tolerance. A
*reference ensemble* has one run a draw, from data that were moved by DISPLACEMENT along their coadjoint orbit.
"""

from typing import Dict, NamedTuple, Tuple

from lib import formats
from lib.formats import (CONVERGED, FAST, SOLVERS, SWEEP_CAP, Integrator, Schema, keyed, list_of, number, one_of,
                         optional, positive, status, text, whole)
from lib.messages import UnusableFile

REFERENCE, METHOD, PRACTICE = ROLES = ("reference", "method", "practice")
PRACTICE_INTEGRATOR, PRACTICE_SHARE = "algebra1", 0.25  # isospectral midpoint, h = ħ/4
PRACTICE_TOLERANCES = LOOSE, TIGHT = (1e-8, 1e-13)
# Relative differences d of two states of one norm, whose correlation is 1 − d²/2; that of independent states is √2.
PARTED = 0.5  # told as the time of parting; a correlation of 0.875
# A correlation of one half, which every pair of reference runs is to have at T/2. Their difference grows on during the
# averages over T/2 … T.
INDEPENDENT = 1.0


class Settings(NamedTuple):
    lowest_degree: whole(1)  # of the modes that are drawn
    highest_degree: whole(1)
    displacement: positive  # of reference ensembles, relative to ‖W₀‖
    small_displacement: positive  # of the runs that are watched as they part, beside this one
    energy_loss: positive  # relative: a run that is off by more is unstable
    max_sweeps: whole(1)  # of a step of a fast form
    warm_steps: whole()  # before those that are timed


class Size(NamedTuple):
    """What was run at one n."""

    n: whole(2)
    draws: whole(1)
    references: whole(2)  # ensembles
    time: positive  # T of a run; averages are those of T/2 … T
    reference_integrator: text
    reference_step: positive
    reference_error: number  # relative, of W(20) of the first draw: at this step against half of it
    norm_B: positive  # ‖B(W₀)‖₂, the mean over the draws


class Parting(NamedTuple):
    """Two runs of the reference method from data that differ by a displacement along the coadjoint orbit."""

    n: whole(2)
    draw: whole()
    displacement: positive  # relative to ‖W₀‖: the small one, or that of reference ensembles
    time: optional(positive)  # from which they differ by half of ‖W‖ or more; None if they never do
    at_window: number  # their relative difference at T/2; independent states differ by √2


class RunRow(NamedTuple):
    """One run; its averages over T/2 … T are None where it did not come to its end."""

    n: whole(2)
    role: one_of(*ROLES)
    integrator: text
    step: positive
    tolerance: positive
    draw: whole()
    ensemble: whole()  # of references; 0 for all others
    status: status
    time: number  # that it came to
    energy_error: optional(number)  # relative, the largest that was seen; None where not finite
    spectrum_error: optional(number)  # at the end
    energy: optional(number)  # averages, relative to the initial values
    enstrophy: optional(number)
    quartic: optional(number)  # tr W⁴
    energy_by_degree: optional(list_of(number))  # average of E(l), l = 1 … n − 1

    @property
    def works(self):
        return self.status == CONVERGED


class Cost(NamedTuple):
    """CPU time of a step, from the state of the first draw at T/2; no seconds where a step fails there."""

    n: whole(2)
    integrator: text
    step: positive
    tolerance: positive
    solver: one_of(*SOLVERS)
    steps: whole(1)  # that are timed, after some that are not
    equivalent_products: optional(number)  # a step
    seconds: list_of(positive)  # of a step, by process; each process times all that has a cost at its n


SCHEMA = Schema("turbulence", Settings, {"integrators": Integrator, "sizes": Size, "partings": Parting,
                                         "runs": RunRow, "costs": Cost})


class Setting(NamedTuple):
    """A method with its step and tolerance."""

    integrator: str
    step: float
    tolerance: float


class Ensemble(NamedTuple):
    """The runs of one setting at one n, a draw each."""

    setting: Setting
    role: str
    runs: Tuple[RunRow, ...]  # by draw

    @property
    def works(self):
        return all(run.works for run in self.runs)

    @property
    def failed(self):
        """The number of draws whose run failed."""
        return sum(not run.works for run in self.runs)

    @property
    def capped(self):
        """The number of draws whose run was ended by the sweep cap, which is lower here than the default."""
        return sum(run.status == SWEEP_CAP for run in self.runs)


class Turbulence(NamedTuple):
    """A whole study, by n."""

    settings: Settings
    integrators: Dict[str, Integrator]
    sizes: Dict[int, Size]
    partings: Dict[int, Tuple[Parting, ...]]
    references: Dict[int, Tuple[Tuple[RunRow, ...], ...]]  # n: draws, each a run for each ensemble
    ensembles: Dict[int, Dict[Setting, Ensemble]]  # without the references
    costs: Dict[Tuple[int, Setting, str], Cost]
    context: Dict[str, str]

    def practice(self, n, tolerance=LOOSE):
        """Returns the Ensemble of the practice at a tolerance, or None."""
        return next((each for each in self.ensembles[n].values()
                     if each.role == PRACTICE and each.setting.tolerance == tolerance), None)

    def at_window(self, n, displacement):
        """Returns the differences at T/2 of the pairs of runs that begin with a displacement, a draw each."""
        return [parting.at_window for parting in self.partings[n] if parting.displacement == displacement]

    def is_unpredictable(self, n):
        """Tells whether reference ensembles are independent at T/2 in every draw: averages compare ensembles then."""
        return min(self.at_window(n, self.settings.displacement)) >= INDEPENDENT

    def cost(self, n, setting, solver=FAST):
        """Returns the Cost of a setting's step, or None where there is none."""
        found = self.costs.get((n, setting, solver))
        return found if found and found.seconds else None


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
    references, ensembles = {}, {}
    for n, size in sizes.items():
        rows = [row for row in tables["runs"] if row.n == n]
        own = {(row.draw, row.ensemble): row for row in rows if row.role == REFERENCE}
        wanted = {(draw, ensemble) for draw in range(size.draws) for ensemble in range(size.references)}
        if set(own) != wanted or not all(row.works for row in own.values()):
            raise UnusableFile(f"has not every reference run at n = {n}")
        parted = {(row.displacement, row.draw) for row in tables["partings"] if row.n == n}
        if not {(study.settings.displacement, draw) for draw in range(size.draws)} <= parted:
            raise UnusableFile(f"does not say how two runs of every draw part at n = {n}")
        references[n] = tuple(tuple(own[draw, ensemble] for ensemble in range(size.references))
                              for draw in range(size.draws))
        ensembles[n] = ensembles_of([row for row in rows if row.role != REFERENCE], size)
    partings = {n: tuple(row for row in tables["partings"] if row.n == n) for n in sizes}
    costs = {(row.n, setting_of(row), row.solver): row for row in tables["costs"]}
    for n in sizes:
        if len({len(row.seconds) for row in tables["costs"] if row.n == n and row.seconds}) > 1:
            raise UnusableFile(f"has costs at n = {n} from different numbers of processes")
    return Turbulence(study.settings, integrators, sizes, partings, references, ensembles,
                      costs, study.context)


def ensembles_of(rows, size):
    """Returns the Ensembles among the rows at one n, by Setting. Throws UnusableFile for one without all draws."""
    found = {}
    for row in rows:
        found.setdefault(setting_of(row), []).append(row)
    for setting, runs in found.items():
        if sorted(row.draw for row in runs) != list(range(size.draws)):
            raise UnusableFile(f"has not every draw of {setting.integrator} with h = {setting.step:g}"
                               f" at n = {size.n}")
    return {setting: Ensemble(setting, runs[0].role, tuple(sorted(runs, key=lambda row: row.draw)))
            for setting, runs in found.items()}
