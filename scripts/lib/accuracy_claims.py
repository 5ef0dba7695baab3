"""What a study of accuracy against cost says, in sentences whose every figure comes from its raw file.

A claim is what stands out, which is also the title of the chart that shows it, and the rest; or None without its data.
"""

import math
import statistics

from accuracy_lines import TABLE1_STEP
from comparison import three_digits
from equal_error import (EXPONENTS, MEAN_EXPONENTS, cheapest, forms_of, frame_gains, headline_problems, mean,
                         means_by_problem, prices)
from integrator_names import frameless, gauss_stages

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


def claims(study):
    """Returns the claims that the study has data for, as sentences in two parts."""
    headline = headline_problems(study)
    found = (price(study, headline), exponential(study), order_pays(study), energy(study), frame(study, headline),
             growth(study), needed_tolerance(study), quality(study))
    return [(f"{each[0]}.", f" {each[1]}") for each in found if each]


# ---- at equal error


def price(study, problems):
    """Tells what the Lie–Poisson structure costs, as geometric means for each problem and over all of them."""
    found = prices(study, problems)
    if not found:
        return None
    titles = [f"{span([each.value for each in means_by_problem(one).values()])} × {NAMES[other]}'s time"
              for other, one in found.items()]
    means = [f"{mean(one.values())} times {NAMES[other]}'s over {len(one)} comparisons" for other, one in found.items()]
    at_1e6 = [f"{ratio} at n = {problem.n}" for (problem, exponent), ratio in found.get("rkmk4", {}).items()
              if exponent == -6]
    return (f"At equal error the best Gauss form takes {' and '.join(titles)}",
            f"Best forms, means over n and the errors {MEAN_OVER}: {'; '.join(means)}. Over RKMK4,"
            f" for 1e-6: {', '.join(at_1e6) or 'no comparison'}.")


def exponential(study):
    found = prices(study, study.problems()).get("rkmk4", {}).values()
    if not found:
        return None
    cheaper, dearer = sum(each.least > 1 for each in found), sum(each.most < 1 for each in found)
    return (f"With an exponential, RKMK4 is cheaper than the best Gauss form in {cheaper} of {len(found)} comparisons",
            f"It is dearer in {dearer}; in the others the spreads overlap. It is explicit: implicit methods with an"
            " exponential, which the paper calls inefficient, are untested.")


def order_pays(study):
    """Tells the orders of the cheapest Gauss form over the problems."""
    parts = []
    for exponent in EXPONENTS[::2]:
        best = [cheapest(study, problem, 10.0**exponent, forms_of(study, "gauss")) for problem in study.problems()]
        found = [2 * gauss_stages(frameless(each[0])) for each in best if each]
        if found:
            parts.append(f"{span(found, str)} at 1e{exponent} (median {statistics.median(found):g})")
    return parts and ("Which order pays depends on the error", f"Of the cheapest Gauss form, {', '.join(parts)}.")


def energy(study):
    """Compares energy errors where all err alike in W, in the longest run of the smooth scene at its largest n.

    The error in W is the largest at which most methods can be compared.
    """
    smooth = [problem for problem in study.problems() if problem.scene == "smooth"]
    found = {}
    for exponent in EXPONENTS if smooth else ():
        best = {name: cheapest(study, smooth[-1], 10.0**exponent, forms_of(study, method))
                for method, name in NAMES.items()}
        parts = [f"{scientific(each[1].energy_error)} by {name}" for name, each in best.items() if each]
        found.setdefault(len(parts), (exponent, parts))
    most = max(found, default=0)
    if not most:
        return None
    exponent, parts = found[most]
    return (f"Where W errs by 1e{exponent} ({smooth[-1]}), the energy errs by {', '.join(parts)}",
            "Each in the cheapest of its forms.")


def frame(study, problems):
    """Tells by how much the co-rotating frame divides times: those of all Gauss methods together, and of each other one."""
    methods = {}
    for name, each in frame_gains(study, problems).items():
        methods.setdefault("Gauss" if gauss_stages(name) else name, []).extend(each.values())
    parts = [f"{mean(each)} for {method}" for method, each in methods.items()]
    return parts and (f"The co-rotating frame divides time at equal error by {parts[0]}",
                      f"Means, smooth, T = 5, {MEAN_OVER}{''.join(f'; {each}' for each in parts[1:])}.")


def growth(study):
    """Tells how the error at Table 1's step grows from the first n to the last that works."""
    problems = headline_problems(study)
    parts = []
    for name in ("group3", "group3_frame", "group1", "group2", "rkmk4", "rk4"):
        errors = [run.error for problem in problems
                  if (run := study.at_step(problem, name, TABLE1_STEP)) and run.usable]
        if len(errors) > 1:
            parts.append(f"{scientific(errors[0])} to {scientific(errors[-1])} ({name})")
    return parts and (f"From n = {problems[0].n} to {problems[-1].n} the error at h = {TABLE1_STEP} goes from"
                      f" {' and from '.join(parts[:2])}",
                      "One step size is not one accuracy" + "".join(f"; {each}" for each in parts[2:]) + ".")


# ---- tolerances


def loosest_tolerances(study):
    """Returns (loosest harmless run, run at 1e-13, error of the step size) for each problem, integrator and solver."""
    cells = {}
    for run in sorted(study.tolerance_runs, key=lambda run: run.tolerance):
        if run.usable:
            cells.setdefault((run.problem, run.integrator, run.solver), []).append(run)
    found = []
    for runs in cells.values():
        harmful = next((index for index, run in enumerate(runs) if run.solver_error > HARMLESS * runs[0].error),
                       len(runs))
        usual = min(runs, key=lambda run: abs(run.tolerance - USUAL_TOLERANCE))
        found.append((runs[max(harmful - 1, 0)], usual, runs[0].error))
    return found


def needed_tolerance(study):
    found = loosest_tolerances(study)
    if not found:
        return None
    largest = max(loosest.n for loosest, *_ in found)
    needed = [f"{scientific(loosest.tolerance)} at s = {loosest.stages}" for loosest, *_ in found
              if (loosest.n, loosest.formulation) == (largest, "group")]
    times = statistics.geometric_mean(usual.seconds / loosest.seconds for loosest, usual, _ in found)
    worst, tight = (max(run.spectrum_error for run in runs) for runs in list(zip(*found))[:2])
    return ("What the tolerance 1e-13 buys is the spectrum, not the trajectory",
            f"At h = {TABLE1_STEP}, n = {largest}, looser ones add less than a tenth to group's error:"
            f" {', '.join(needed)}. The spectrum errs by up to {scientific(worst)} at such tolerances of all cells, and"
            f" by {scientific(tight)} at 1e-13, for {two_digits(times)} times the time (geometric mean).")


def quality(study):
    """Compares the spectrum errors of group and algebra at 1e-13 where they differ most."""
    runs = {(run.problem, run.stages, run.formulation): run for _, run, _ in loosest_tolerances(study)
            if run.spectrum_error > 0 and math.isclose(run.tolerance, USUAL_TOLERANCE)}
    pairs = [(run, runs[problem, s, "algebra"]) for (problem, s, formulation), run in runs.items()
             if formulation == "group" and (problem, s, "algebra") in runs]
    if not pairs:
        return None
    group, algebra = max(pairs, key=lambda pair: pair[0].spectrum_error / pair[1].spectrum_error)
    return (f"Equal tolerance is not equal quality: at {USUAL_TOLERANCE:g} algebra's spectrum errs up to"
            f" {two_digits(group.spectrum_error / algebra.spectrum_error)} times less than group's",
            f"By {scientific(algebra.spectrum_error)} and {scientific(group.spectrum_error)} at n = {group.n}, s ="
            f" {group.stages}.")
