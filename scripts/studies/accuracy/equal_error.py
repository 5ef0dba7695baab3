"""Compares methods at equal error.

Between lines: the cost of an error is that of the cheapest run with this error or a smaller one, interpolated along the
line. Nothing is compared with a line that was cut and may have been the cheaper. In comparisons: the ratio of times by
process, with its verdict (lib/judging/verdicts.py).
"""

import itertools
import math
import statistics

from lib.records.formats import FAST, FORMULATIONS
from lib.records.integrators import GAUSS
from lib.records.settings import TABLE1_STEP, TIGHT
from lib.judging.verdicts import FASTER
from lib.pages.numbers import power
from studies.accuracy.candidates import CLASSES, EXPLICIT
from studies.accuracy.lines import compared
from studies.accuracy.schema import CANDIDATES, Form

FEW = 10  # steps; a run of fewer is marked
AS_EXPLICIT = (EXPLICIT, "rk4")  # the classes of explicit methods that keep nothing

# Geometric means are over these errors.
MEAN_EXPONENTS = range(-4, -9, -1)
HEADLINE = ("smooth", 5.0)  # the scene and time of the headline figures
# The tolerance does no harm where what it adds is at most this share of the error that the step size makes.
HARMLESS = 0.1
MEAN_OVER = f"1e{MEAN_EXPONENTS[0]} … 1e{MEAN_EXPONENTS[-1]}"

# The classes that comparisons compare: time of the first over that of the second. Every class but explicit ones is
# compared with these.
PAIRS = (*((each, EXPLICIT) for each in CANDIDATES if each != EXPLICIT and CLASSES[each].solver == FAST),
         *((gauss, "elp") for gauss in ("gauss", "gauss_loose", "gauss_matched")),
         *((gauss, "elp_matched") for gauss in ("gauss_loose", "gauss_matched")),
         ("gauss", "elp_bounded"), ("elp_bounded", "elp"), ("elp_matched", "elp"), ("elp", "magnus"), ("elp", "rk4"),
         ("gauss_published", "gauss"), ("named_published", "gauss_published"))


def headline_problems(study):
    return [problem for problem in study.problems() if (problem.scene, problem.time) == HEADLINE]


# ---- comparisons


def comparison_errors(study):
    """Returns the errors of the comparisons, the largest first."""
    return sorted({wanted for _, wanted in study.comparisons}, reverse=True)


def ratio_in(comparison, first, second):
    """Returns (Ratio, verdict) of the time of a candidate over another's in a comparison; None where one has no row."""
    return compared(comparison[first], comparison[second]) if first in comparison and second in comparison else None


def beaten_by(comparison):
    """Returns the classes that are faster than the best explicit method by the verdict, the fastest first."""
    return sorted((each for each in comparison
                   if each not in AS_EXPLICIT and ratio_in(comparison, each, EXPLICIT)[1] == FASTER),
                  key=lambda each: comparison[each].seconds)


def is_few(row):
    """Tells whether a row of a comparison takes so few steps that its time is mostly that of starts."""
    return row.steps < FEW


# ---- lines


def cheap_forms(study, problem, error, forms, within, beyond=False):
    """Returns (Form, Cost) of the forms that have this error or a smaller one at up to `within` times the least cost.

    The cheapest first, and none if no line reaches the error, or if one that was cut might have reached it sooner.
    Steps beyond a linear limit count if `beyond` says so.
    """
    costs = [(form, cost) for form in forms
             if (cost := study.cost(problem, form.integrator, error, form.tolerance, beyond))]
    costs.sort(key=lambda each: each[1].seconds)
    minimum = costs[0][1].seconds if costs else math.inf
    if any(study.may_reach(problem, form.integrator, error, minimum, form.tolerance) for form in forms):
        return []
    return [(form, cost) for form, cost in costs if cost.seconds <= within * minimum]


def cheapest(study, problem, error, forms):
    """Returns the first of cheap_forms(), or None."""
    return next(iter(cheap_forms(study, problem, error, forms, within=1.0)), None)


def gauss_forms(study):
    """Returns the Forms of the Gauss integrators in the co-rotating frame, at their tightest tolerance."""
    return [Form(name) for name, each in study.integrators.items() if each.co_rotating and each.family == GAUSS]


def means_by_problem(found):
    """Returns the geometric mean of each problem that has ratios; `found` has them by (problem, exponent)."""
    return {problem: statistics.geometric_mean([ratio for (where, _), ratio in found.items() if where == problem])
            for problem in dict.fromkeys(problem for problem, _ in found)}


def frame_gains(study, problems):
    """Returns the time of each integrator over that of its variant in the co-rotating frame, by its name.

    As a dict by (problem, exponent of the error), where both reach the error.
    """
    gains = {}
    for framed_name, method in [(each.name, each.method) for each in study.integrators.values() if each.co_rotating]:
        found = gains[method] = {}
        for problem, exponent in itertools.product(problems, MEAN_EXPONENTS):
            plain, framed = (study.cost(problem, each, 10.0**exponent) for each in (method, framed_name))
            if plain and framed:
                found[problem, exponent] = plain.seconds / framed.seconds
    return gains


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
            cell = study.integrators[run.integrator]
            cells.setdefault((run.problem, FORMULATIONS.index(cell.formulation), cell.stages), []).append(run)
    found = []
    for _, runs in sorted(cells.items()):
        harmless = list(itertools.takewhile(lambda run: run.solver_error <= HARMLESS * runs[0].error, runs))
        found += [((harmless or runs[:1])[-1], run) for run in runs if math.isclose(run.tolerance, TIGHT)]
    return found


def written_tolerance(study, loosest):
    """Writes the loosest tolerance of a cell that does no harm: at least that, if it is the loosest that was tried."""
    tried = max(run.tolerance for run in study.tolerance_runs)
    return "at least " * (loosest.tolerance == tried) + power(loosest.tolerance)
