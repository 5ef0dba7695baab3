"""The raw file of the study of accuracy against cost, and what its lines show: ends, orders, cost at an error.

A problem is a scene at one n, solved to one time. A line is the runs of one integrator, at one tolerance of its
iteration, on one problem, with more and more steps. A comparison is several methods at one error of one problem, timed
interleaved in fresh processes.
"""

import statistics
from typing import NamedTuple

from lib.records.formats import (CONVERGED, SOLVERS, Integrator, Schema, list_of, number, one_of, optional, positive,
                                 status, text, truth, whole)
from lib.records.settings import SCENES, TIGHT, Problem

TABLE_EXPONENTS = (-2, -4, -6, -8)  # powers of ten, as errors for which tables name the cheapest method


# How a line ends: its error no longer falls, it is below GOOD_ENOUGH, or the next run would have taken too much work.
# One of a single step, that of Table 1, is alone.
FLOOR, BELOW, CUT, ALONE = "floor", "below", "cut", "alone"
GOOD_ENOUGH = 1e-9

# The rows of a comparison, each the best method of a class in the co-rotating frame: candidates.py says of which.
OTHER = "other"  # of new integrators
CANDIDATES = ("explicit", "rk4", "projected", "rkmk", "magnus", "elp", "elp_matched", "elp_bounded", "gauss",
              "gauss_loose", "gauss_matched", "gauss_published", "named_published", OTHER)


class Form(NamedTuple):
    """An integrator at a tolerance, which has a line on each problem."""

    integrator: str
    tolerance: float = TIGHT


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


class Run(NamedTuple):
    """What a run came to and what it cost; errors are None where it did not come to a usable end."""

    scene: one_of(*SCENES)
    time: positive
    n: whole(2)
    integrator: text
    solver: one_of(*SOLVERS)
    steps: whole(1)
    tolerance: positive
    status: status
    error: optional(positive)  # ‖W(T) − reference‖_F / ‖reference‖_F
    solver_error: optional(number)  # of tolerance_runs: relative distance from the tightest tolerance that converged
    spectrum_error: optional(number)
    energy_error: optional(number)  # relative, largest over the steps
    h_norm_B: number
    beyond_limit: truth  # the step is longer than the integrator is stable for, by linear theory
    sweeps: whole()
    products: whole()
    equivalent_products: number
    cpu_seconds: list_of(positive)  # one for each repetition; none for a run that failed

    @property
    def problem(self):
        return Problem(self.scene, self.time, self.n)

    @property
    def form(self):
        return Form(self.integrator, self.tolerance)

    @property
    def step(self):
        return self.time / self.steps

    @property
    def usable(self):
        return self.status == CONVERGED

    @property
    def seconds(self):
        """The least of the repetitions: interruptions only add."""
        return min(self.cpu_seconds)


class Line(NamedTuple):
    """How a line ends."""

    scene: one_of(*SCENES)
    time: positive
    n: whole(2)
    integrator: text
    tolerance: positive
    end: one_of(FLOOR, BELOW, CUT, ALONE)


class Comparison(NamedTuple):
    """A row of a comparison: the method that stands for a candidate, with the steps that take least work."""

    scene: one_of(*SCENES)
    time: positive
    n: whole(2)
    wanted: positive  # the error that every row of the comparison reaches
    candidate: one_of(*CANDIDATES)
    integrator: text
    solver: one_of(*SOLVERS)
    tolerance: positive
    steps: whole(1)
    error: positive
    spectrum_error: number
    beyond_limit: truth  # as that of a Run
    equivalent_products: number
    cpu_seconds: list_of(positive)  # of the whole run, one for each process

    @property
    def seconds(self):
        """The geometric mean over the processes."""
        return statistics.geometric_mean(self.cpu_seconds)


SCHEMA = Schema("accuracy", Settings, {"references": Reference, "rates": Rate, "integrators": Integrator,
                                       "lines": Line, "runs": Run, "tolerance_runs": Run, "comparisons": Comparison},
                renamed={"duels": "comparisons", "contender": "candidate"})
