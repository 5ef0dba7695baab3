"""Compares methods at equal error, and says what a study of accuracy shows, every figure from its raw file.

Costs are interpolated along the lines of the study. A ratio comes with its spread: from fastest over slowest
repetitions to slowest over fastest. Best forms are compared, with the co-rotating frame wherever it is the cheaper. A
claim is what stands out, which is also the title of the chart that shows it, and the rest; or None without its data.
"""

import itertools
import math
import statistics
from typing import NamedTuple

from accuracy_lines import FAST, TABLE1_STEP
from benchmark_json import FORMULATIONS
from comparison import three_digits
from integrator_names import frameless, gauss_stages, in_frame
from recommendation import TABLE_EXPONENTS

# Geometric means are over these errors. Larger ones are often those of the longest step that works.
MEAN_EXPONENTS = range(-4, -9, -1)
HEADLINE = ("smooth", 5.0)  # the scene and time of the headline figures
# The tolerance does no harm where what it adds is at most this share of the error that the step size makes.
HARMLESS = 0.1
USUAL_TOLERANCE = 1e-13
NAMES = {"gauss": "Gauss", "rkmk4": "RKMK4", "rk4": "RK4"}
MEAN_OVER = f"1e{MEAN_EXPONENTS[0]} … 1e{MEAN_EXPONENTS[-1]}"


def scientific(value):
    """Writes an error with two digits, as 5.3e-4."""
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}" if value else "0"


def two_digits(value):
    return f"{value:.2g}" if value < 99.5 else three_digits(value)


def span(values, write=two_digits):
    """Writes the smallest and the largest of some values, once where they read the same."""
    ends = [write(each) for each in (min(values), max(values))]
    return " to ".join(dict.fromkeys(ends))


# ---- at equal error


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


def cheapest(study, problem, error, names, solver=FAST):
    """Returns (name, Cost) of the integrator that has this error at the least cost, or None."""
    found = [(name, cost) for name in names if (cost := study.cost(problem, name, error, solver))]
    return min(found, key=lambda each: each[1].seconds, default=None)


def ratios(study, problems, first, second, solvers=(FAST, FAST)):
    """Returns the Ratio of the cheapest of `first` to that of `second`, by (problem, exponent) that both have."""
    found = {}
    for problem in problems:
        for exponent in MEAN_EXPONENTS:
            sides = [cheapest(study, problem, 10.0**exponent, names, solver)
                     for names, solver in zip((first, second), solvers)]
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
    return {other: ratios(study, problems, forms_of(study, "gauss"), forms_of(study, other)) for other in ("rkmk4", "rk4")}


def frame_gains(study, problems):
    """Returns the Ratios of each integrator to its variant in the co-rotating frame, by its name."""
    return {frameless(name): ratios(study, problems, [frameless(name)], [name])
            for name in study.integrators if in_frame(name)}


# ---- claims


def claims(study):
    """Returns the claims that the study has data for, as sentences in two parts."""
    headline = headline_problems(study)
    found = (price(study, headline), exponential(study), order_pays(study), energy(study), frame(study, headline),
             growth(study), needed_tolerance(study), quality(study))
    return [(f"{each[0]}.", f" {each[1]}") for each in found if each]


def price(study, problems):
    """Tells what the Lie–Poisson structure costs, as geometric means for each problem and over all of them."""
    found = {other: one for other, one in prices(study, problems).items() if one}
    if not found:
        return None
    titles = [f"{span([each.value for each in means_by_problem(one).values()])} × {NAMES[other]}'s time"
              for other, one in found.items()]
    means = [f"{mean(one.values())} times {NAMES[other]}'s over {len(one)} comparisons" for other, one in found.items()]
    at_1e6 = [f"{ratio} at n = {problem.n}" for (problem, exponent), ratio in found.get("rkmk4", {}).items()
              if exponent == -6]
    where = " and ".join(dict.fromkeys(f"{problem.scene} scene to T = {problem.time:g}" for problem in problems))
    return (f"At equal error the best Gauss form takes {' and '.join(titles)} ({where})",
            f"Best forms, means over n and the errors {MEAN_OVER}: {'; '.join(means)}. For 1e-6"
            f" alone, over RKMK4's: {', '.join(at_1e6) or 'none'}.")


def exponential(study):
    found = prices(study, study.problems())["rkmk4"].values()
    if not found:
        return None
    told = [each for each in found if each.least < each.most]  # timed more than once
    cheaper, dearer = sum(each.least > 1 for each in told), sum(each.most < 1 for each in told)
    return (f"With an exponential, RKMK4 is cheaper than the best Gauss form in {cheaper} of {len(found)} comparisons on"
            " all problems",
            f"It is dearer in {dearer}; in the others the spreads overlap, or both were timed once. It is explicit: implicit methods with an"
            " exponential, which the paper calls inefficient, are untested.")


def order_pays(study):
    """Tells the orders of the cheapest Gauss form over the problems."""
    parts = []
    for exponent in TABLE_EXPONENTS:
        best = [cheapest(study, problem, 10.0**exponent, forms_of(study, "gauss")) for problem in study.problems()]
        found = [2 * gauss_stages(frameless(each[0])) for each in best if each]
        if found:
            parts.append(f"{span(found, str)} at 1e{exponent} (median {statistics.median(found):g})")
    return parts and ("Which order pays depends on the error", f"Of the cheapest Gauss form on each problem, {', '.join(parts)}.")


def energy(study):
    """Compares energy errors where all err by 1e-6 in W, in the longest run of the smooth scene at its largest n."""
    smooth = [problem for problem in study.problems() if problem.scene == "smooth"]
    best = {name: cheapest(study, problem, 1e-6, forms_of(study, method))
            for problem in smooth[-1:] for method, name in NAMES.items()}
    parts = [f"{scientific(each[1].energy_error)} by {name}" for name, each in best.items() if each]
    return parts and (f"Where W errs by 1e-6 ({smooth[-1]}), the energy errs by {', '.join(parts)}",
                      "Each in the cheapest of its forms.")


def frame(study, problems):
    """Tells by how much the co-rotating frame divides the times of Gauss methods."""
    gains = [ratio for name, each in frame_gains(study, problems).items() if gauss_stages(name) for ratio in each.values()]
    return gains and (f"The co-rotating frame divides the time of Gauss methods at equal error by {mean(gains)}",
                      f"Mean over n, s and the errors {MEAN_OVER}, smooth, T = 5.")


def runs_at_table1_step(study, name):
    """Returns the runs of an integrator with the step of Table 1 that work, n rising."""
    runs = (study.at_step(problem, name, TABLE1_STEP) for problem in headline_problems(study))
    return [run for run in runs if run and run.usable and not run.beyond_limit]


def growth(study):
    """Tells how the error at Table 1's step grows from the first n to the last that works."""
    sizes = [problem.n for problem in headline_problems(study)]
    lines = {name: runs_at_table1_step(study, name)
             for name in ("group3", "group3_frame", "group1", "group2", "rkmk4", "rk4")}
    parts = [f"{scientific(runs[0].error)} to {scientific(runs[-1].error)} ({name})"
             for name, runs in lines.items() if runs]
    return parts and (f"From n = {sizes[0]} to {sizes[-1]} the error at h = {TABLE1_STEP} goes from"
                      f" {' and from '.join(parts[:2])}", "One step size is not one accuracy. Others, to the last n that"
                      f" works: {', '.join(parts[2:]) or 'none'}.")


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


def needed_tolerance(study):
    found = tolerances(study)
    if not found:
        return None
    needed = [f"{scientific(loosest.tolerance)} at s = {loosest.stages}" for loosest, _ in found
              if (loosest.n, loosest.formulation) == (found[-1][0].n, "group")]
    times = statistics.geometric_mean(usual.seconds / loosest.seconds for loosest, usual in found)
    worst, tight = (scientific(max(run.spectrum_error for run in runs)) for runs in zip(*found))
    return ("What the tolerance 1e-13 buys is the spectrum, not the trajectory",
            f"At h = {TABLE1_STEP}, n = {found[-1][0].n}, looser ones add less than a tenth to group's error:"
            f" {', '.join(needed)}. The spectrum errs by up to {worst} at such tolerances of all cells, and by {tight} at"
            f" 1e-13, for {two_digits(times)} times the time (geometric mean).")


def quality(study):
    """Compares the spectrum errors of group and algebra at 1e-13 where they differ most."""
    runs = {(run.problem, run.stages, run.formulation): run for _, run in tolerances(study) if run.spectrum_error > 0}
    pairs = [(run.spectrum_error / runs[problem, s, "algebra"].spectrum_error, run)
             for (problem, s, formulation), run in runs.items()
             if formulation == "group" and (problem, s, "algebra") in runs]
    if not pairs:
        return None
    ratio, run = max(pairs, key=lambda pair: pair[0])
    return (f"Equal tolerance is not equal quality: at 1e-13 algebra's spectrum errs up to {two_digits(ratio)} times less"
            " than group's", f"There (n = {run.n}, s = {run.stages}) group's errs by {scientific(run.spectrum_error)}.")
