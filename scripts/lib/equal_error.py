"""Compares methods at equal error: costs are interpolated along the lines of the study of accuracy.

A ratio comes with its spread: from fastest over slowest repetitions to slowest over fastest. Best forms are compared,
with the co-rotating frame wherever it is the cheaper.
"""

import statistics
from typing import NamedTuple

from integrator_names import frameless, gauss_stages, in_frame

EXPONENTS = range(-2, -9, -1)
# Geometric means are over these errors. Larger ones are often those of the longest step that works.
MEAN_EXPONENTS = range(-4, -9, -1)
HEADLINE = ("smooth", 5.0)  # the scene and time of the headline figures


class Ratio(NamedTuple):
    value: float
    least: float
    most: float

    def __str__(self):
        return f"{self.value:.2g} ({self.least:.2g}–{self.most:.2g})"


def forms_of(study, method):
    """Returns the names of the integrators of a method, in the frame and not; "gauss" is all its forms."""
    return [name for name in study.integrators
            if frameless(name) == method or (method == "gauss" and gauss_stages(frameless(name)))]


def headline_problems(study):
    return [problem for problem in study.problems() if (problem.scene, problem.time) == HEADLINE]


def cheapest(study, problem, error, names):
    """Returns (name, Cost) of the integrator that has this error at the least cost, or None."""
    found = [(name, cost) for name in names if (cost := study.cost(problem, name, error))]
    return min(found, key=lambda each: each[1].seconds, default=None)


def ratios(study, problems, first, second):
    """Returns the Ratio of the cheapest of `first` to that of `second`, by (problem, exponent) that both have."""
    found = {}
    for problem in problems:
        for exponent in MEAN_EXPONENTS:
            sides = [cheapest(study, problem, 10.0**exponent, names) for names in (first, second)]
            if all(sides):
                (_, dear), (_, cheap) = sides
                found[problem, exponent] = Ratio(dear.seconds / cheap.seconds, dear.least / cheap.most,
                                                 dear.most / cheap.least)
    return found


def mean(found):
    """Returns the geometric mean of some Ratios."""
    return Ratio(*map(statistics.geometric_mean, zip(*found)))


def means_by_problem(found):
    """Returns the geometric mean of each problem that has Ratios."""
    return {problem: mean([each for (where, _), each in found.items() if where == problem])
            for problem in dict.fromkeys(problem for problem, _ in found)}


def prices(study, problems):
    """Returns the Ratios of the best Gauss form to the best form of RKMK4 and of RK4."""
    return without_empty({other: ratios(study, problems, forms_of(study, "gauss"), forms_of(study, other))
                          for other in ("rkmk4", "rk4")})


def frame_gains(study, problems):
    """Returns the Ratios of each integrator to its variant in the co-rotating frame, by its name."""
    return without_empty({frameless(name): ratios(study, problems, [frameless(name)], [name])
                          for name in study.integrators if in_frame(name)})


def without_empty(found):
    return {name: each for name, each in found.items() if each}
