"""The raw file of the study `longruns`: what methods keep, against what they cost.

A method is an integrator, in the co-rotating frame where the list has it there, at a tolerance of its iteration. A line
is its runs in one scene at one n, with more and more steps. Beside the lines there are long runs, of methods with steps
that cost the same. Costs are full products a unit of time, so nothing is timed.
"""

import math
from typing import Dict, List, NamedTuple, Optional, Tuple

from lib.programs.messages import UnusableFile
from lib.records import formats
from lib.records.formats import (CONVERGED, Integrator, Schema, finite, keyed, list_of, number, one_of, optional,
                                 positive, status, text, truth, whole)
from lib.records.integrators import GAUSS as GAUSS_FAMILY, IMPLICIT_EXPONENTIAL
from lib.records.settings import ENERGY_BOUNDED, keeping_tolerance
from lib.judging.drift import LOST, judged

SCENES = ("smooth", "rough")
# What ends the name of a method whose tolerance is looser or tighter than its integrator's usual one.
LOOSE, TIGHTER = "_loose", "_tight"
COSTS = (50, 150)  # of long runs, in products a unit of time
COST_MARGIN = 0.1  # what a long run may be off its cost
ENERGY, SPECTRUM = QUANTITIES = ("energy", "spectrum")


def method_of(integrator, tolerance):
    """Returns the name of a method: that of an Integrator without its frame, with LOOSE or TIGHTER behind it where its
    tolerance is such."""
    usual = keeping_tolerance(integrator)
    return integrator.method + (LOOSE if tolerance > usual else TIGHTER if tolerance < usual else "")


class Settings(NamedTuple):
    quick: truth


class Plan(NamedTuple):
    """The runs of a line at one n."""

    n: whole(2)
    time: positive
    steps: whole(1)  # of the first run of a line
    energies: whole(1)  # that are looked at in a run, at least, or one after every step
    products: positive  # a unit of time: a line ends before a run that is expected to cost more


class Point(NamedTuple):
    """One run of a line, from the initial data of a scene. Errors are None where it failed."""

    scene: one_of(*SCENES)
    n: whole(2)
    time: positive
    integrator: text
    tolerance: positive
    steps: whole(1)
    status: status
    equivalent_products: number  # a unit of time
    projections: number  # a unit of time
    sweeps_per_step: number
    energy_error: optional(number)  # relative, the largest of the run
    spectrum_error: optional(number)  # largest error of an eigenvalue at the end; ‖W₀‖₂ = 1
    symplectic_defect: optional(number)  # of the steps up to t = 2; None too where n has none

    @property
    def step(self):
        return self.time / self.steps

    @property
    def usable(self):
        """Tells whether the run came to its end with most of its energy and its spectrum."""
        return self.status == CONVERGED and max(self.energy_error, self.spectrum_error) < LOST

    def error(self, quantity):
        return self.energy_error if quantity == ENERGY else self.spectrum_error


class LongRun(NamedTuple):
    """One long run from the initial data of a scene; its lists end where it failed."""

    scene: one_of(*SCENES)
    n: whole(2)
    time: positive
    windows: whole(1)  # of equal lengths
    integrator: text
    tolerance: positive
    cost: whole(1)  # products a unit of time that are wanted
    steps: whole(1)
    status: status
    failed_step: optional(whole(1))
    equivalent_products: number  # a unit of time
    projections: number  # a unit of time
    sweeps_per_step: number
    energy_change: optional(finite)  # H(W) / H(W₀) - 1 at the last window; None without one
    energy_errors: list_of(number)  # relative, the largest in each window
    energy_means: list_of(finite)  # the mean of H(W) / H(W₀) - 1 in each window
    spectrum_errors: list_of(number)  # at the end of each window, as in a Point

    @property
    def step(self):
        return self.time / self.steps

    @property
    def finished(self):
        return self.status == CONVERGED

    @property
    def at_cost(self):
        """Tells whether it costs what is wanted, to COST_MARGIN."""
        return abs(self.equivalent_products / self.cost - 1) <= COST_MARGIN

    def series(self, quantity):
        """Returns (time, error) of a quantity at the ends of windows."""
        return self.timed(self.energy_errors if quantity == ENERGY else self.spectrum_errors)

    def timed(self, values):
        return [(number * self.time / self.windows, value) for number, value in enumerate(values, 1)]

    def last(self, quantity):
        """Returns the error in the last window, or None."""
        series = self.series(quantity)
        return series[-1][1] if series else None

    def judged(self, quantity):
        """Returns the Judgement on a quantity; that on the energy looks at its sign too."""
        signed = self.timed(self.energy_means) if quantity == ENERGY else ()
        return judged(self.series(quantity), self.finished, signed)


SCHEMA = Schema("longruns", Settings, {"integrators": Integrator, "plans": Plan, "points": Point,
                                       "long_runs": LongRun})


# ---- classes of methods

EXPLICIT, PROJECTED, EXPLICIT_LIE, EXPONENTIAL_LOOSE, EXPONENTIAL, GAUSS, GAUSS_LOOSE = CLASSES = (
    "explicit", "projected", "rkmk_magnus", "exponential_loose", "exponential", "gauss", "gauss_loose")
STRUCTURE = (EXPONENTIAL, GAUSS)  # Lie–Poisson, at a tolerance at which the energy is bounded
PLAIN = (EXPLICIT, PROJECTED)  # explicit steps of W itself


def class_of(integrator, tolerance):
    """Returns which of CLASSES an Integrator belongs to at a tolerance; None for another kind."""
    bounded = tolerance <= ENERGY_BOUNDED
    if integrator.lie_poisson:
        if integrator.family in IMPLICIT_EXPONENTIAL:
            return EXPONENTIAL if bounded else EXPONENTIAL_LOOSE
        if integrator.family == GAUSS_FAMILY:
            return GAUSS if bounded else GAUSS_LOOSE
        return None
    if not integrator.explicit:
        return None
    if not integrator.isospectral:
        return EXPLICIT
    return PROJECTED if integrator.projected else EXPLICIT_LIE


# ---- the study


class Price(NamedTuple):
    """The least cost of an error in a class of methods."""

    products: float  # a unit of time
    method: str
    at_most: bool  # the longest step of the line has the error, so that a longer one might too


class LongRuns(NamedTuple):
    context: Dict[str, str]
    integrators: Dict[str, Integrator]
    plans: Dict[int, Plan]
    lines: Dict[Tuple[str, int, str], List[Point]]  # by scene, n and method, the longest step first
    long_runs: Dict[Tuple[str, int, str], LongRun]  # by scene, cost and method

    def settings(self):
        """Returns (n, scene) of all lines, n rising."""
        return sorted({(n, scene) for scene, n, _ in self.lines},
                      key=lambda each: (each[0], SCENES.index(each[1])))

    def methods(self):
        return list(dict.fromkeys(method for _, _, method in self.lines))

    def lines_at(self, scene, n):
        """Returns the lines in one scene at one n, by method."""
        return {method: line for (*place, method), line in self.lines.items() if place == [scene, n]}

    def long_methods(self):
        return list(dict.fromkeys(method for _, _, method in self.long_runs))

    def long_at(self, scene, cost):
        """Returns the long runs in one scene at one cost, by method."""
        return {method: run for (*place, method), run in self.long_runs.items() if place == [scene, cost]}

    def integrator_of(self, run):
        """Returns the Integrator of a Point or a LongRun."""
        return self.integrators[run.integrator]

    def class_of(self, run):
        return class_of(self.integrator_of(run), run.tolerance)

    def price(self, scene, n, quantity, error, classes) -> Optional[Price]:
        """Returns the least Price of an error in some classes; None where no line of theirs reaches it."""
        prices = [price for method, line in self.lines_at(scene, n).items() if self.class_of(line[0]) in classes
                  and (price := price_on(line, quantity, error, method))]
        return min(prices, key=lambda price: price.products, default=None)


def price_on(line, quantity, error, method):
    """Returns the least Price of this error or a smaller one on the line of a method, or None.

    It is that of a run, or between two usable neighbours, interpolated in the logarithms.
    """
    found = [Price(point.equivalent_products, method, index == 0) for index, point in enumerate(line)
             if point.usable and point.error(quantity) <= error]
    for coarse, fine in zip(line, line[1:]):
        if coarse.usable and fine.usable and coarse.error(quantity) > error >= fine.error(quantity) > 0:
            share = (math.log(coarse.error(quantity) / error)
                     / math.log(coarse.error(quantity) / fine.error(quantity)))
            products = coarse.equivalent_products**(1 - share) * fine.equivalent_products**share
            found.append(Price(products, method, False))
    return min(found, key=lambda price: price.products, default=None)


def read_longruns(path):
    """Returns the LongRuns in `path`. Throws UnusableFile with one line that names the file and what is wrong."""
    return formats.read_study(path, SCHEMA, long_runs)


def long_runs(study):
    """Returns the LongRuns of a Study. Throws UnusableFile."""
    tables = study.tables
    plans, integrators = keyed(tables["plans"], "n"), keyed(tables["integrators"], "name")
    for run in [*tables["points"], *tables["long_runs"]]:
        if run.integrator not in integrators:
            raise UnusableFile(f"has a run of {run.integrator} without its integrator")

    def method(run):
        return method_of(integrators[run.integrator], run.tolerance)

    lines = {(point.scene, point.n, method(point)): [] for point in tables["points"]}
    for point in sorted(tables["points"], key=lambda point: point.steps):
        if point.n not in plans:
            raise UnusableFile(f"has a run of {point.integrator} at n = {point.n} without its plan")
        lines[point.scene, point.n, method(point)].append(point)
    if not lines:
        raise UnusableFile("has no runs")
    if len({run.n for run in tables["long_runs"]}) > 1:
        raise UnusableFile("has long runs at more than one n")
    return LongRuns(study.context, integrators, plans, lines,
                    {(run.scene, run.cost, method(run)): run for run in tables["long_runs"]})
