"""The raw file of the study of accuracy against cost, and what its lines show: floors, orders, cost at an error.

A problem is a scene at one n, solved to one time. A line is the runs of one integrator, by one solver, on one problem,
with more and more steps.
"""

import itertools
import math
import statistics
from typing import Dict, List, NamedTuple, Optional

from lib import formats
from lib.formats import (CASIMIRS, CONVERGED, FAST, SOLVERS, Integrator, Schema, keyed, list_of, number,
                         one_of, optional, positive, status, text, truth, whole)
from lib.messages import UnusableFile
from lib.integrator_names import gauss_stages

SCENES = ("smooth", "rough", "developed")
TABLE1_STEP = 0.1  # the step size of Table 1, where the tolerances were varied too
TABLE_EXPONENTS = (-2, -4, -6, -8)  # powers of ten, as errors for which tables name the cheapest method

# A line has reached its floor where the error is within this of the reference's uncertainty, ...
FLOOR_MARGIN = 10
# ... or where, below NEAR_ROUNDING, it falls with the step by less than this share of the order.
NEAR_ROUNDING = 1e-8
STILL_FALLING = 0.5
# Runs that an observed order is fitted on, those of the smallest steps above the floor: an order is what errors tend
# to. Fewer do not tell one.
ORDER_POINTS = 3


class Problem(NamedTuple):
    scene: str
    time: float
    n: int

    def __str__(self):
        return f"{self.scene}, T = {self.time:g}, n = {self.n}"


class Settings(NamedTuple):
    quick: truth


class Reference(NamedTuple):
    scene: one_of(*SCENES)
    time: positive
    n: whole(2)
    uncertainty: positive  # relative, as the error of a run
    integrators: list_of(text, 2)
    steps: list_of(whole(1), 2)


class Rate(NamedTuple):
    """Products of n x n matrices per CPU second, as measured when the study began."""

    n: whole(2)
    published: positive
    fast: positive  # in split-complex storage


class Limit(NamedTuple):
    """The largest step that works in every trial up to it, told by h‖B(W₀)‖₂; None if the first trial failed."""

    scene: one_of(*SCENES)
    n: whole(2)
    integrator: text
    solver: one_of(*SOLVERS)
    h_norm_B: optional(positive)


class Run(NamedTuple):
    """What a run came to and what it cost; errors are None where it did not come to a usable end."""

    scene: one_of(*SCENES)
    time: positive
    n: whole(2)
    integrator: text
    solver: one_of(*SOLVERS)
    steps: whole(1)
    step: positive
    tolerance: positive
    status: status
    error: optional(positive)  # ‖W(T) − reference‖_F / ‖reference‖_F
    solver_error: optional(number)  # of tolerance_runs: relative distance from the tightest tolerance that converged
    spectrum_error: optional(number)
    casimir_errors: optional(list_of(number, len(CASIMIRS)))
    energy_error: optional(number)  # relative, largest over the steps
    angular_momentum_error: optional(number)
    skew_defect: optional(number)
    h_norm_B: number
    beyond_limit: truth  # the step is longer than the integrator is stable for, by linear theory
    sweeps: whole()
    products: whole()
    equivalent_products: number
    poisson_solves: whole()
    cpu_seconds: list_of(positive)  # one for each repetition; none for a run that failed

    @property
    def problem(self):
        return Problem(self.scene, self.time, self.n)

    @property
    def usable(self):
        return self.status == CONVERGED

    @property
    def seconds(self):
        return statistics.median(self.cpu_seconds)

    @property
    def stages(self):
        """Of a formulation of the Gauss method; None for any other integrator."""
        return gauss_stages(self.integrator)

    @property
    def formulation(self):
        return self.integrator.rstrip("0123456789")


SCHEMA = Schema("accuracy", Settings, {"references": Reference, "rates": Rate, "integrators": Integrator,
                                       "limits": Limit, "runs": Run, "tolerance_runs": Run})


class Cost(NamedTuple):
    """What an error costs on a line: the cost of a run, or interpolated in log error between two neighbouring ones."""

    seconds: float  # interpolated medians
    least: float  # interpolated fastest repetitions
    most: float  # interpolated slowest repetitions
    step: float
    energy_error: float
    coarse: Run  # the run before, with an error above the one asked for; the same as `fine` if not interpolated
    fine: Run


class Accuracy(NamedTuple):
    context: Dict[str, str]
    references: Dict[Problem, Reference]
    rates: Dict[int, Rate]
    integrators: Dict[str, Integrator]
    limits: Dict[tuple, Limit]  # by (scene, n, integrator, solver)
    runs: List[Run]
    tolerance_runs: List[Run]
    lines: Dict[tuple, List[Run]]  # by (problem, integrator, solver), the longest step first

    def problems(self):
        """Returns the problems in the order of SCENES, then of time and n."""
        return sorted(self.references, key=lambda each: (SCENES.index(each.scene), each.time, each.n))

    def line(self, problem, integrator, solver=FAST):
        """Returns all runs of a line, the longest step first, failures included."""
        return self.lines.get((problem, integrator, solver), [])

    def above_floor(self, problem, integrator, solver=FAST):
        """Returns the usable runs of a line down to where its error reaches the floor."""
        least = FLOOR_MARGIN * self.references[problem].uncertainty
        kept = []
        for run in self.line(problem, integrator, solver):
            if not run.usable:
                continue
            if run.error < least:
                break
            if kept and is_rounding(kept[-1], run, self.integrators[integrator].order):
                break
            kept.append(run)
        return kept

    def stretches(self, problem, integrator, solver=FAST):
        """Returns the line above its floor as lists of neighbouring runs that are no failure and not beyond a limit."""
        kept = set(map(id, self.above_floor(problem, integrator, solver)))
        found = itertools.groupby(self.line(problem, integrator, solver),
                                  lambda run: id(run) in kept and not run.beyond_limit)
        return [list(runs) for good, runs in found if good]

    def cost(self, problem, integrator, error, solver=FAST) -> Optional[Cost]:
        """Returns the least cost of this error or a smaller one on a line; None where the line does not reach it."""
        costs = []
        for stretch in self.stretches(problem, integrator, solver):
            costs += [interpolated(run, run, error) for run in stretch if run.error <= error]
            costs += [interpolated(coarse, fine, error) for coarse, fine in zip(stretch, stretch[1:])
                      if coarse.error >= error >= fine.error]
        return min(costs, key=lambda cost: cost.seconds, default=None)

    def observed_order(self, problem, integrator, solver=FAST):
        """Returns the order that a line shows above its floor; None for too few runs."""
        return fitted_order(self.above_floor(problem, integrator, solver))

    def at_step(self, problem, integrator, step, solver=FAST):
        """Returns the run with this step size, or None."""
        return next((run for run in self.line(problem, integrator, solver)
                     if math.isclose(run.step, step, rel_tol=1e-9)), None)


def is_rounding(coarse, fine, order):
    """Tells whether rounding keeps the error of `fine` from falling as the order says."""
    falls = math.log(coarse.error / fine.error)
    return coarse.error < NEAR_ROUNDING and falls < STILL_FALLING * order * math.log(coarse.step / fine.step)


def fitted_order(runs):
    """Fits the slope of log error over log step on the last ORDER_POINTS runs; None for fewer."""
    steps = [math.log(run.step) for run in runs[-ORDER_POINTS:]]
    if len(set(steps)) < ORDER_POINTS:
        return None
    return statistics.linear_regression(steps, [math.log(run.error) for run in runs[-ORDER_POINTS:]]).slope


def interpolated(coarse, fine, error):
    """Returns the Cost of an error between those of two runs, linear in the logarithms."""
    share = 1.0 if coarse.error == fine.error else (math.log(coarse.error / error)
                                                    / math.log(coarse.error / fine.error))

    def between(value):
        return value(coarse) ** (1 - share) * value(fine) ** share

    return Cost(between(lambda run: run.seconds), between(lambda run: min(run.cpu_seconds)),
                between(lambda run: max(run.cpu_seconds)), between(lambda run: run.step),
                between(lambda run: run.energy_error), coarse, fine)


def read_accuracy(path):
    """Returns the Accuracy in `path`. Throws UnusableFile with one line that names the file and what is wrong."""
    return formats.read_study(path, SCHEMA, accuracy)


def accuracy(study):
    """Returns the Accuracy of a Study. Throws UnusableFile for one without problems or integrators."""
    tables = study.tables
    references = {Problem(*key): each for key, each in keyed(tables["references"], "scene", "time", "n").items()}
    lines = {}
    for run in sorted(tables["runs"], key=lambda run: run.steps):
        lines.setdefault((run.problem, run.integrator, run.solver), []).append(run)
    result = Accuracy(study.context, references, keyed(tables["rates"], "n"),
                      keyed(tables["integrators"], "name"),
                      keyed(tables["limits"], "scene", "n", "integrator", "solver"),
                      tables["runs"], tables["tolerance_runs"], lines)
    if not result.references or not result.integrators:
        raise UnusableFile("has no references or no integrators")
    return result
