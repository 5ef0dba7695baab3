"""The raw file of scripts/studies/longruns.py: what methods keep over long runs, at one step and at equal cost.

A method is an integrator, in the co-rotating frame, at a tolerance of its iteration. It runs at three levels: with one
step size for all methods, and with step sizes at which all cost the same, a coarse and a fine budget.
"""

import statistics
from typing import Dict, NamedTuple, Tuple

from lib import formats
from lib.accuracy_lines import keeping_tolerance
from lib.drift import judged
from lib.figures import finite
from lib.formats import (CONVERGED, Integrator, Schema, keyed, list_of, number, one_of, optional, positive, status,
                         text, truth, whole)
from lib.integrator_names import frameless
from lib.messages import UnusableFile

SCENES = ("smooth", "rough")
LEVELS = ONE_STEP, COARSE, FINE = ("one step", "coarse", "fine")
EQUAL_COSTS = (COARSE, FINE)
# What ends the name of a method whose tolerance is looser or tighter than its integrator's usual one.
VARIANTS = LOOSE, TIGHTER = ("_loose", "_tight")
COST_MARGIN = 0.15  # equal costs differ from their median by this share at most
ENERGY, SPECTRUM = "energy", "spectrum"


def without_variant(method):
    """Returns the name of a method without what says its tolerance."""
    return method.removesuffix(LOOSE).removesuffix(TIGHTER)


class Settings(NamedTuple):
    quick: truth
    windows_a_sample: whole(1)  # spectrum and Casimirs are looked at once in so many windows


class Plan(NamedTuple):
    """How long the runs at one n are."""

    n: whole(2)
    time: positive
    windows: whole(1)  # of equal lengths, whose energy errors are kept as maxima


class Run(NamedTuple):
    """One run from the initial data of a scene; its lists end where it failed."""

    scene: one_of(*SCENES)
    n: whole(2)
    integrator: text
    tolerance: positive
    level: one_of(*LEVELS)
    steps: whole(1)
    step: positive
    status: status
    failed_step: optional(whole(1))
    sweeps_per_step: number
    equivalent_products: number  # a unit of time
    energy_change: optional(finite)  # H(W) / H(W₀) - 1 at the last window; None without one
    energy_errors: list_of(number)  # relative, the largest in each window
    spectrum_errors: list_of(number)  # largest error of an eigenvalue; ‖W₀‖₂ = 1
    casimir_errors: list_of(number)  # relative, largest of k = 2 … 5
    cpu_seconds: list_of(positive)  # a unit of time, one for each repetition; none for a run that failed

    @property
    def method(self):
        """Returns the integrator without its frame, with LOOSE or TIGHTER behind it where its tolerance is such."""
        name, usual = frameless(self.integrator), keeping_tolerance(self.integrator)
        if self.tolerance == usual:
            return name
        return name + (LOOSE if self.tolerance > usual else TIGHTER)

    @property
    def is_variant(self):
        """Tells whether the tolerance is another one than the usual."""
        return self.method.endswith(VARIANTS)

    @property
    def finished(self):
        return self.status == CONVERGED

    @property
    def seconds(self):
        """Returns the median of the CPU seconds a unit of time, or None."""
        return statistics.median(self.cpu_seconds) if self.cpu_seconds else None


class LongRun(NamedTuple):
    run: Run
    plan: Plan
    windows_a_sample: int

    def series(self, quantity):
        """Returns (time, error) of a quantity, ENERGY or SPECTRUM, at the ends of windows or at samples."""
        window = self.plan.time / self.plan.windows
        if quantity == ENERGY:
            return [(number * window, error) for number, error in enumerate(self.run.energy_errors, 1)]
        return [(number * window * self.windows_a_sample, error)
                for number, error in enumerate(self.run.spectrum_errors, 1)]

    def last(self, quantity):
        """Returns the error in the last window or sample, or None."""
        series = self.series(quantity)
        return series[-1][1] if series else None

    def judged(self, quantity):
        """Returns the Judgement on a quantity."""
        return judged(self.series(quantity), self.run.finished)


class LongRuns(NamedTuple):
    context: Dict[str, str]
    integrators: Dict[str, Integrator]
    plans: Dict[int, Plan]
    runs: Dict[Tuple[str, int, str, str], LongRun]  # by scene, n, method and level

    def settings(self):
        """Returns (n, scene) of all runs, n rising."""
        found = {(n, scene) for scene, n, _, _ in self.runs}
        return sorted(found, key=lambda each: (each[0], SCENES.index(each[1])))

    def methods(self):
        return list(dict.fromkeys(method for _, _, method, _ in self.runs))

    def at(self, scene, n, level):
        """Returns the long runs of one scene, n and level, by method."""
        found = ((method, self.runs.get((scene, n, method, level))) for method in self.methods())
        return {method: run for method, run in found if run}

    def integrator_of(self, run):
        return self.integrators[run.run.integrator]

    def cost_share(self, run):
        """Returns the cost of a run over the median at its scene, n and level; None if it has none, or no equals."""
        if run.run.level not in EQUAL_COSTS or not run.run.seconds:
            return None
        equals = self.at(run.run.scene, run.run.n, run.run.level).values()
        return run.run.seconds / statistics.median(each.run.seconds for each in equals if each.run.seconds)

    def is_unequal(self, run):
        """Tells whether the cost of a run differs from that of its equals by more than COST_MARGIN."""
        share = self.cost_share(run)
        return share is not None and abs(share - 1) > COST_MARGIN


SCHEMA = Schema("longruns", Settings, {"integrators": Integrator, "plans": Plan, "runs": Run})


def read_longruns(path):
    """Returns the LongRuns in `path`. Throws UnusableFile with one line that names the file and what is wrong."""
    return formats.read_study(path, SCHEMA, long_runs)


def long_runs(study):
    """Returns the LongRuns of a Study. Throws UnusableFile."""
    plans, integrators = keyed(study.tables["plans"], "n"), keyed(study.tables["integrators"], "name")
    runs = {}
    for run in study.tables["runs"]:
        if run.n not in plans or run.integrator not in integrators:
            raise UnusableFile(f"has a run of {run.integrator} at n = {run.n} without its plan or its integrator")
        runs[run.scene, run.n, run.method, run.level] = LongRun(run, plans[run.n], study.settings.windows_a_sample)
    if not runs:
        raise UnusableFile("has no runs")
    return LongRuns(study.context, integrators, plans, runs)
