"""Compares methods at equal error: costs are interpolated along the lines of the study of accuracy.

A ratio comes with its spread: from fastest over slowest repetitions to slowest over fastest. Best forms are compared,
with the co-rotating frame wherever it is the cheaper.
"""

import statistics
from typing import NamedTuple

from accuracy_lines import FAST, interpolated
from integrator_names import frameless, gauss_stages, in_frame

EXPONENTS = range(-2, -9, -1)
# Geometric means are over these errors. Larger ones are often those of the longest step that works.
MEAN_EXPONENTS = range(-4, -9, -1)
HEADLINE = ("smooth", 5.0)  # the scene and time of the headline figures
STRUCTURES = {"poisson": "the Lie–Poisson structure", "spectrum": "the spectrum only", "nothing": "neither"}


class Ratio(NamedTuple):
    value: float
    least: float
    most: float

    def __str__(self):
        return f"{self.value:.2g} ({self.least:.2g}–{self.most:.2g})"


def strongest(integrator):
    """Returns the strongest structure that an integrator keeps."""
    return next(structure for structure in STRUCTURES if integrator.keeps(structure))


def keeping(study, structure):
    """Returns the names of integrators whose strongest structure is this one."""
    return [name for name, each in study.integrators.items() if strongest(each) == structure]


def forms_of(study, *methods):
    """Returns the names of the integrators of these methods, in the frame and not; "gauss" is all its forms."""
    return [name for name in study.integrators
            if frameless(name) in methods or ("gauss" in methods and gauss_stages(frameless(name)))]


def headline_problems(study):
    return [problem for problem in study.problems() if (problem.scene, problem.time) == HEADLINE]


def cheapest(study, problem, error, names, solver=FAST, or_less=False):
    """Returns (name, Cost) of the integrator that has this error at the least cost, or None.

    With `or_less`, the longest step that works on a line stands for every larger error than its own.
    """
    found = []
    for name in names:
        cost = study.cost(problem, name, error, solver)
        if cost is None and or_less:
            stretches = study.stretches(problem, name, solver)
            if stretches and stretches[0][0].error <= error:
                cost = interpolated(stretches[0][0], stretches[0][0], stretches[0][0].error)
        if cost:
            found.append((name, cost))
    return min(found, key=lambda each: each[1].seconds, default=None)


def ratio_of(first, second):
    """Returns the Ratio of two costs."""
    return Ratio(first.seconds / second.seconds, first.least / second.most, first.most / second.least)


def ratios(study, problems, first, second, solvers=(FAST, FAST), exponents=MEAN_EXPONENTS):
    """Returns the Ratio of the cheapest of `first` to that of `second`, by (problem, exponent) that both have."""
    found = {}
    for problem in problems:
        for exponent in exponents:
            sides = [cheapest(study, problem, 10.0**exponent, names, solver)
                     for names, solver in zip((first, second), solvers)]
            if all(sides):
                found[problem, exponent] = ratio_of(*(cost for _, cost in sides))
    return found


def mean(found):
    """Returns the geometric mean of some Ratios, or None of none."""
    return Ratio(*map(statistics.geometric_mean, zip(*found))) if found else None


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
    pairs = {frameless(name): name for name in study.integrators if in_frame(name)}
    return {name: ratios(study, problems, [name], [framed]) for name, framed in pairs.items()}


def published_gains(study, problems):
    """Returns the Ratios of each integrator's published form to its fast form, by its name."""
    found = {name: ratios(study, problems, [name], [name], ("published", FAST)) for name in study.integrators}
    return {name: each for name, each in found.items() if each}
