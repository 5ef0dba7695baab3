"""Compares methods at equal error.

The cost of an error is that of the cheapest run with this error or a smaller one, interpolated along the lines of the
study. A ratio comes with its range, from fastest over slowest repetitions to slowest over fastest, unless a side was
timed once. Best forms are compared, with the co-rotating frame wherever it is the cheaper.
"""

import itertools
import math
import statistics
from typing import NamedTuple

from lib.accuracy_lines import TABLE1_STEP, interpolated
from lib.formats import FORMULATIONS, PUBLISHED
from lib.integrator_names import frameless, gauss_stages, in_frame

# Geometric means are over these errors.
MEAN_EXPONENTS = range(-4, -9, -1)
HEADLINE = ("smooth", 5.0)  # the scene and time of the headline figures
# The tolerance does no harm where what it adds is at most this share of the error that the step size makes.
HARMLESS = 0.1
USUAL_TOLERANCE = 1e-13
NAMES = {"gauss": "Gauss", "rkmk4": "RKMK4", "rk4": "RK4"}
MEAN_OVER = f"1e{MEAN_EXPONENTS[0]} … 1e{MEAN_EXPONENTS[-1]}"


# ---- at equal error


class Ratio(NamedTuple):
    value: float
    least: float
    most: float
    repeated: bool  # all was timed more than once, so that there is a spread

    def __str__(self):
        return f"{self.value:.2g} ({self.least:.2g}–{self.most:.2g})" if self.repeated else f"{self.value:.2g}"


def ratio(dear, cheap):
    """Returns the Ratio of two Costs."""
    once = any(len(run.cpu_seconds) == 1 for cost in (dear, cheap) for run in (cost.coarse, cost.fine))
    return Ratio(dear.seconds / cheap.seconds, dear.least / cheap.most, dear.most / cheap.least, not once)


def forms_of(study, method):
    """Returns the names of the integrators of a method, in the frame and not; "gauss" is all its forms."""
    return [name for name in study.integrators
            if frameless(name) == method or (method == "gauss" and gauss_stages(frameless(name)))]


def headline_problems(study):
    return [problem for problem in study.problems() if (problem.scene, problem.time) == HEADLINE]


def cheapest(study, problem, error, names):
    """Returns (name, Cost) of the integrator that has this error or a smaller one at the least cost, or None."""
    found = [(name, cost) for name in names if (cost := study.cost(problem, name, error))]
    return min(found, key=lambda each: each[1].seconds, default=None)


def ratios(study, problems, first, second):
    """Returns the Ratio of the cheapest of `first` to that of `second`, by (problem, exponent) that both have."""
    found = {}
    for problem in problems:
        for exponent in MEAN_EXPONENTS:
            sides = [cheapest(study, problem, 10.0**exponent, names) for names in (first, second)]
            if all(sides):
                found[problem, exponent] = ratio(*(cost for _, cost in sides))
    return found


def published_over_fast(study, problem, name):
    """Returns the Ratios of the forms of an integrator at equal steps, where their errors are equal too."""
    pairs = [(run, study.at_step(problem, name, run.step)) for run in study.line(problem, name, PUBLISHED)
             if run.usable]
    return [ratio(*(interpolated(run, run, run.error) for run in pair)) for pair in pairs if pair[1] and pair[1].usable]


def mean(found):
    """Returns the geometric mean of some Ratios."""
    *figures, repeated = zip(*found)
    return Ratio(*map(statistics.geometric_mean, figures), all(repeated))


def means_by_problem(found):
    """Returns the geometric mean of each problem that has Ratios."""
    return {problem: mean([each for (where, _), each in found.items() if where == problem])
            for problem in dict.fromkeys(problem for problem, _ in found)}


def prices(study, problems):
    """Returns the Ratios of the best Gauss form to the best form of RKMK4 and of RK4."""
    return {other: ratios(study, problems, forms_of(study, "gauss"), forms_of(study, other))
            for other in ("rkmk4", "rk4")}


def frame_gains(study, problems):
    """Returns the Ratios of each integrator to its variant in the co-rotating frame, by its name."""
    return {frameless(name): ratios(study, problems, [frameless(name)], [name])
            for name in study.integrators if in_frame(name)}


def runs_at_table1_step(study, name):
    """Returns the runs of an integrator with the step of Table 1 that work, n rising."""
    runs = (study.at_step(problem, name, TABLE1_STEP) for problem in headline_problems(study))
    return [run for run in runs if run and run.usable and not run.beyond_limit]


# ---- tolerances


def tolerances(study):
    """Returns (loosest run that does no harm, run at 1e-13) for each cell of Table 1, by n, formulation and s."""
    cells = {}
    for run in sorted(study.tolerance_runs, key=lambda run: run.tolerance):
        if run.usable:
            cells.setdefault((run.problem, FORMULATIONS.index(run.formulation), run.stages), []).append(run)
    found = []
    for _, runs in sorted(cells.items()):
        harmless = list(itertools.takewhile(lambda run: run.solver_error <= HARMLESS * runs[0].error, runs))
        found += [((harmless or runs[:1])[-1], run) for run in runs if math.isclose(run.tolerance, USUAL_TOLERANCE)]
    return found


def written_tolerance(study, loosest):
    """Writes the loosest tolerance of a cell that does no harm: at least that, if it is the loosest that was tried."""
    tried = max(run.tolerance for run in study.tolerance_runs)
    return "at least " * (loosest.tolerance == tried) + f"{loosest.tolerance:.0e}".replace("e-0", "e-")
