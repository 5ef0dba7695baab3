"""Compares methods at equal error, and says what a study of accuracy shows, every figure from its raw file.

The cost of an error is that of the cheapest run with this error or a smaller one, interpolated along the lines of the
study. A ratio comes with its spread, from fastest over slowest repetitions to slowest over fastest, unless a side was
timed once. Best forms are compared, with the co-rotating frame wherever it is the cheaper. A
claim is what stands out, which is also the title of the chart that shows it, and the rest; or None without its data.
"""

import itertools
import math
import statistics
from typing import NamedTuple

from lib.accuracy_lines import PUBLISHED, TABLE1_STEP, interpolated
from lib.formats import FORMULATIONS
from lib.comparison import three_digits
from lib.integrator_names import frameless, gauss_stages, in_frame, method_name
from lib.recommendation import TABLE_EXPONENTS

# Geometric means are over these errors.
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
    pairs = [(run, study.at_step(problem, name, run.step)) for run in study.line(problem, name, PUBLISHED) if run.usable]
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
    return {other: ratios(study, problems, forms_of(study, "gauss"), forms_of(study, other)) for other in ("rkmk4", "rk4")}


def frame_gains(study, problems):
    """Returns the Ratios of each integrator to its variant in the co-rotating frame, by its name."""
    return {frameless(name): ratios(study, problems, [frameless(name)], [name])
            for name in study.integrators if in_frame(name)}


# ---- claims


def claims(study):
    """Returns the claims that the study has data for, as sentences in two parts."""
    headline = headline_problems(study)
    found = (price(study, headline), exponential(study, study.problems(), "all problems"), order_pays(study),
             energy(study), frame(study, headline), growth(study), needed_tolerance(study), quality(study))
    return [(f"{each[0]}.", f" {each[1]}") for each in found if each]


def price(study, problems):
    """Tells what the Lie–Poisson structure costs on problems of rising n, at 1e-6 and as geometric means."""
    found = {other: one for other, one in prices(study, problems).items() if one}
    if not found:
        return None
    trends, means = [], []
    for other, one in found.items():
        at_1e6 = sorted((each.value, problem.n) for (problem, exponent), each in one.items() if exponent == -6)
        ends = dict.fromkeys(f"{value:.2g} (n = {n})" for value, n in at_1e6[:1] + at_1e6[-1:])
        trends += [f"{' to '.join(ends)} times {NAMES[other]}'s time"] if ends else []
        by_n = [f"{each} at n = {problem.n}" for problem, each in means_by_problem(one).items()]
        means.append(f"over {NAMES[other]}'s time: {', '.join(by_n)}; {mean(one.values())} over all {len(one)}"
                     " comparisons")
    return (f"At 1e-6 the best Gauss form takes {' and '.join(trends) or 'times that are not known'}",
            f"{problems[0].scene.capitalize()} scene to T = {problems[0].time:g}. Means over the errors {MEAN_OVER},"
            f" {'. The same '.join(means)}.")


def exponential(study, problems, where):
    found = prices(study, problems)["rkmk4"].values()
    if not found:
        return None
    gauss, rkmk4 = sum(each.value < 1 for each in found), sum(each.value > 1 for each in found)
    close = sum(each.repeated and each.least <= 1 <= each.most for each in found)
    return (f"The best Gauss form is cheaper than RKMK4 in {gauss} of {len(found)} comparisons on {where}, RKMK4 in"
            f" {rkmk4}",
            f"In {close} the spreads overlap; in {sum(not each.repeated for each in found)} a side was timed once. RKMK4"
            " is explicit: implicit methods with an exponential, which the paper calls inefficient, are untested.")


def order_pays(study):
    """Tells the orders of the cheapest Gauss form over the problems."""
    parts = []
    for exponent in TABLE_EXPONENTS:
        best = [cheapest(study, problem, 10.0**exponent, forms_of(study, "gauss")) for problem in study.problems()]
        found = [2 * gauss_stages(frameless(each[0])) for each in best if each]
        if found:
            parts.append(f"{span(found, str)} at 1e{exponent} (median {statistics.median(found):g})")
    return parts and ("Which order pays depends on the error", "Order of the cheapest Gauss form over"
                      f" {len(study.problems())} problems: {', '.join(parts)}.")


def energy(study):
    """Tells whose energy error is the least for its time, in the longest run of the smooth scene at its largest n."""
    problem = [each for each in study.problems() if each.scene == "smooth"][-1]
    names = {form: name for each, name in NAMES.items() for form in forms_of(study, each)}
    runs = [run for form in names for stretch in study.stretches(problem, form) for run in stretch]
    least = {names[run.integrator]: run.energy_error for run in sorted(runs, key=lambda run: -run.energy_error)}
    best = []
    for run in sorted(runs, key=lambda run: run.seconds):
        if not best or run.energy_error < best[-1].energy_error:
            best.append(run)
    parts = []
    for name, group in itertools.groupby(best, lambda run: names[run.integrator]):
        first, *_, last = [*group] * 2
        parts.append(f"{name}'s" + f" from {two_digits(first.seconds)} s on" * (first != best[0])
                     + f" down to {scientific(last.energy_error)}" * (last != best[-1])
                     + ", where its runs end" * (last != best[-1] and last.energy_error == least[name]))
    found = {name: cheapest(study, problem, 1e-6, forms_of(study, each)) for each, name in NAMES.items()}
    at_1e6 = [f"{scientific(each[1].energy_error)} by {name}" for name, each in found.items() if each]
    return parts and (f"At T = {problem.time:g}, n = {problem.n} the least energy error for its time is"
                      f" {', then '.join(parts)}",
                      f"Of {', '.join(NAMES.values())}; direct Gauss keeps the energy, which is quadratic, to rounding."
                      f" Where W errs by 1e-6 at most, the energy errs by {', '.join(at_1e6) or 'what is not known'}. Over longer"
                      " times: the long runs of the study of stability.")


def frame(study, problems):
    """Tells by how much the co-rotating frame divides the times of Gauss methods."""
    gains = [each for name, found in frame_gains(study, problems).items() if gauss_stages(name)
             for each in found.values()]
    return gains and (f"The co-rotating frame divides the time of Gauss methods at equal error by {mean(gains)}",
                      f"Mean of {len(gains)} comparisons over n, s and the errors {MEAN_OVER}, smooth, T = 5.")


def runs_at_table1_step(study, name):
    """Returns the runs of an integrator with the step of Table 1 that work, n rising."""
    runs = (study.at_step(problem, name, TABLE1_STEP) for problem in headline_problems(study))
    return [run for run in runs if run and run.usable and not run.beyond_limit]


def growth(study):
    """Tells how the error at Table 1's step grows from the first n to the last that works."""
    sizes = [problem.n for problem in headline_problems(study)]
    lines = {name: runs_at_table1_step(study, name)
             for name in ("group3", "group3_frame", "group1", "group2", "rkmk4", "rk4")}
    parts = [f"{scientific(runs[0].error)} to {scientific(runs[-1].error)}"
             f" ({NAMES.get(name) or method_name(study.integrators[name])}{', in the co-rotating frame' * in_frame(name)})"
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


def written_tolerance(study, loosest):
    """Writes the loosest tolerance of a cell that does no harm: at least that, if it is the loosest that was tried."""
    tried = max(run.tolerance for run in study.tolerance_runs)
    return "at least " * (loosest.tolerance == tried) + f"{loosest.tolerance:.0e}".replace("e-0", "e-")


def needed_tolerance(study):
    found = tolerances(study)
    if not found:
        return None
    needed = [f"{written_tolerance(study, loosest)} at s = {loosest.stages}" for loosest, _ in found
              if (loosest.n, loosest.formulation) == (found[-1][0].n, "group")]
    times = statistics.geometric_mean(usual.seconds / loosest.seconds for loosest, usual in found)
    worst, tight = (scientific(max(run.spectrum_error for run in runs)) for runs in zip(*found))
    return ("What the tolerance 1e-13 buys is the spectrum, not the trajectory (published forms)",
            "The loosest tolerance that adds less than a tenth to the error which the step size makes is, for group at"
            f" h = {TABLE1_STEP}, n = {found[-1][0].n}, {', '.join(needed)}. With the loosest such tolerance of each cell"
            f" the spectrum errs by up to {worst}, at 1e-13 by up to {tight}, for {two_digits(times)} times the time"
            " (geometric mean).")


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
