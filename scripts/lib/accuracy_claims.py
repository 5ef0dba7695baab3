"""What a study of accuracy against cost says, in sentences and titles whose every figure comes from its raw file."""

import math
import statistics

from accuracy_lines import PUBLISHED, TABLE1_STEP
from comparison import three_digits
from equal_error import (EXPONENTS, MEAN_EXPONENTS, cheapest, forms_of, frame_gains, headline_problems, keeping,
                         mean, means_by_problem, prices, published_gains, ratio_of, ratios)
from integrator_names import frameless, gauss_stages

# The tolerance does no harm where what it adds is at most this share of the error that the step size makes.
HARMLESS = 0.1
USUAL_TOLERANCE = 1e-13
NAMES = {"rkmk4": "RKMK4", "rk4": "RK4"}
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


def by_n(found):
    """Writes the geometric mean of each problem's Ratios after its n."""
    return ", ".join(f"{each.value:.2g} at n = {problem.n}" for problem, each in means_by_problem(found).items())


# ---- titles of charts


def price_title(study, problems):
    """Tells what the Lie–Poisson structure costs: the mean over the problems, and the range of their means."""
    parts = []
    for other, found in prices(study, problems).items():
        if found:
            each = [one.value for one in means_by_problem(found).values()]
            parts.append(f"{two_digits(mean(found.values()).value)} × {NAMES[other]}'s time"
                         + (f" ({span(each)} over the panels)" if len(each) > 1 else ""))
    return f"At equal error Gauss methods take {' and '.join(parts)}" if parts else "Error against CPU time"


def at_error(study, problem, error, names, value):
    """Returns the name and a value, interpolated, of the cheapest integrator at an error; None if there is none."""
    found = cheapest(study, problem, error, names)
    if not found:
        return None
    (name, cost), coarse, fine = found, value(found[1].coarse), value(found[1].fine)
    share = 1.0 if cost.coarse.error == cost.fine.error else (math.log(cost.coarse.error / error)
                                                              / math.log(cost.coarse.error / cost.fine.error))
    return name, (coarse ** (1 - share) * fine ** share if coarse and fine else max(coarse, fine))


def energy_title(study, problems):
    """Compares the energy errors of Gauss, RKMK4 and RK4 where each errs by the same in W, at the last problem.

    The error in W is the largest at which most of the three can be compared.
    """
    def errors(exponent):
        found = {name: at_error(study, problems[-1], 10.0**exponent, forms_of(study, method),
                                lambda run: run.energy_error)
                 for method, name in (("gauss", "Gauss"), *NAMES.items())}
        return [f"{scientific(each[1])} by {name}" for name, each in found.items() if each]

    exponent = max(EXPONENTS, key=lambda each: (len(errors(each)), each))
    if not errors(exponent):
        return "Energy error against CPU time"
    return f"Where W errs by 1e{exponent} ({problems[-1]}), the energy errs by {', '.join(errors(exponent))}"


def growth(study, problems, name):
    """Returns the errors at Table 1's step at the first and the last n that have one, and these n; None without two."""
    runs = [run for run in (study.at_step(problem, name, TABLE1_STEP) for problem in problems) if run and run.usable]
    return (runs[0], runs[-1]) if len(runs) > 1 else None


def growth_title(study, problems, name="group3"):
    ends = {each: growth(study, problems, each) for each in (name, f"{name}_frame")}
    if not ends[name]:
        return f"Error at h = {TABLE1_STEP} against n"
    text, framed = (pair and f"× {two_digits(pair[1].error / pair[0].error)}" for pair in ends.values())
    first, last = ends[name]
    return (f"From n = {first.n} to {last.n} the error at h = {TABLE1_STEP} (Gauss, order {2 * first.stages}) grows"
            f" {text}" + (f", in the co-rotating frame {framed}" if framed else ""))


def quality(study):
    """Returns the largest ratio of group's to algebra's spectrum error at 1e-13, and both runs; None without."""
    pairs, runs = [], {}
    for run in study.tolerance_runs:
        if run.usable and run.spectrum_error > 0 and math.isclose(run.tolerance, USUAL_TOLERANCE):
            runs[run.problem, run.solver, run.stages, run.formulation] = run
    for (*where, formulation), run in runs.items():
        other = runs.get((*where, "algebra"))
        if formulation == "group" and other:
            pairs.append((run.spectrum_error / other.spectrum_error, run, other))
    return max(pairs, key=lambda pair: pair[0], default=None)


def tolerance_title(study):
    found = quality(study)
    if not found:
        return "What the tolerance of the fixed-point iteration buys"
    ratio, run, _ = found
    return (f"Equal tolerance is not equal quality: at {USUAL_TOLERANCE:g} algebra's spectrum errs up to"
            f" {two_digits(ratio)} times less than group's (n = {run.n}, s = {run.stages})")


def table1_title(times):
    """`times` are pairs (published, fast) of median seconds of a cell."""
    if not times:
        return "Table 1 with its accuracy"
    return ("Table 1 with its accuracy: the fast forms give the same errors"
            f" {span([before / after for before, after in times])} times sooner")


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


# ---- sentences


def claims(study):
    """Returns each claim that the study has data for as (what stands out, the rest)."""
    headline = headline_problems(study)
    return [each for each in (
        orders_claim(study), price_claim(study, headline), exponential_claim(study), order_pays_claim(study),
        frame_claim(study, headline), published_claim(study, headline), growth_claim(study, headline),
        *tolerance_claims(study), isospectral_claim(study)) if each]


def orders_claim(study):
    found = [(abs(order - each.order), order, each, problem) for problem in study.problems()
             for each in study.integrators.values() if (order := study.observed_order(problem, each.name))]
    if not found:
        return None
    off, order, each, problem = max(found, key=lambda one: one[0])
    return ("Observed orders.", f" {len(found)} slopes were fitted; the farthest from its order is `{each.name}`'s,"
                                f" {order:.2f} for {each.order} ({problem}).")


def price_claim(study, problems):
    parts = [f"{mean(found.values())} times `{other}`'s time over {len(found)} comparisons ({by_n(found)})"
             for other, found in prices(study, problems).items() if found]
    if not parts:
        return None
    at, error = problems[-1], 1e-6
    sides = [cheapest(study, at, error, keeping(study, structure), or_less=True)
             for structure in ("poisson", "spectrum")]
    goal = (f" For 1e-6 at n = {at.n} the cheapest Lie–Poisson method, `{sides[0][0]}`, takes"
            f" {ratio_of(sides[0][1], sides[1][1])} times as long as the cheapest that keeps the spectrum only,"
            f" `{sides[1][0]}`.") if all(sides) else ""
    return ("The price of structure.", " Geometric means over n and the errors"
            f" {MEAN_OVER}, smooth, T = 5, best forms: the best Gauss form takes {'; and '.join(parts)}.{goal}")


def exponential_claim(study):
    found = ratios(study, study.problems(), forms_of(study, "rkmk4"), keeping(study, "poisson"))
    if not found:
        return None
    cheaper, dearer = (sum(test(each) for each in found.values())
                       for test in (lambda each: each.most < 1, lambda each: each.least > 1))
    return ("Exponential or not.", f" At equal error `rkmk4` is cheaper than every Lie–Poisson method in {cheaper} of"
            f" {len(found)} comparisons over all problems, dearer than the cheapest in {dearer}; in the others the"
            f" spreads overlap. Its time over theirs: {span([each.value for each in found.values()])}. It is explicit"
            " and keeps no Lie–Poisson structure: implicit methods with an exponential, which the paper calls"
            " inefficient, are untested.")


def cheapest_orders(study, exponent):
    """Returns the order of the cheapest Gauss form at an error, by problem."""
    found = {problem: cheapest(study, problem, 10.0**exponent, forms_of(study, "gauss"))
             for problem in study.problems()}
    return {problem: 2 * gauss_stages(frameless(each[0])) for problem, each in found.items() if each}


def order_pays_claim(study):
    parts = [f"{span(orders.values(), str)} at 1e{exponent} (median {statistics.median(orders.values()):g})"
             for exponent in EXPONENTS[::2] if (orders := cheapest_orders(study, exponent))]
    return parts and ("Which order pays.", f" Order of the cheapest Gauss form over the problems: {', '.join(parts)}.")


def frame_claim(study, problems):
    gains = {name: found for name, found in frame_gains(study, problems).items() if found}
    if not gains:
        return None
    gauss = [each for name, found in gains.items() if gauss_stages(name) for each in found.values()]
    parts = [f"`{name}` {mean(found.values()).value:.2g}" for name, found in gains.items() if not gauss_stages(name)]
    return ("The co-rotating frame", f" divides the time at equal error (smooth, T = 5, {MEAN_OVER}) by"
            + (f" {mean(gauss)} for Gauss methods, largest"
               f" {max(each.value for each in gauss):.2g}" if gauss else "")
            + (f"; for {', '.join(parts)}" if parts else "") + ".")


def published_claim(study, problems):
    gains = published_gains(study, problems)
    gauss = [each for name, found in gains.items() if gauss_stages(name) for each in found.values()]
    parts = ([f"Gauss {mean(gauss)}"] if gauss else []) + [
        f"`{name}` {mean(gains[name].values())}" for name in NAMES if name in gains]
    return parts and ("Published over fast forms at equal error,", f" geometric means: {', '.join(parts)}.")


def growth_claim(study, problems):
    parts = [f"{scientific(pair[0].error)} to {scientific(pair[1].error)} (`{name}`)"
             for name in ("group1", "group2", "group3", "group3_frame", "rkmk4", "rk4")
             if (pair := growth(study, problems, name))]
    if not parts:
        return None
    sizes = [problem.n for problem in problems]
    return ("One step size is not one accuracy.", f" From n = {sizes[0]} to {sizes[-1]}, or the last n that works, the"
            f" error at h = {TABLE1_STEP} goes from {', from '.join(parts)}.")


def tolerance_claims(study):
    found = loosest_tolerances(study)
    if not found:
        return []
    largest = max(loosest.n for loosest, *_ in found)
    at = sorted((each for each in found if each[0].n == largest and each[0].formulation == "group"),
                key=lambda each: each[0].stages)
    claims = [("Which tolerance is needed.", f" For `group` at n = {largest} and h = {TABLE1_STEP} tolerances of "
               + ", ".join(f"{scientific(loosest.tolerance)} at s = {loosest.stages}" for loosest, *_ in at)
               + " add less than a tenth to the error.")] if at else []
    shares = [loosest.seconds / usual.seconds for loosest, usual, _ in found]
    worst = max(loosest.spectrum_error for loosest, *_ in found)
    tight = max(usual.spectrum_error for _, usual, _ in found)
    claims.append(("What 1e-13 buys", f" at that step is the spectrum, not the trajectory: its error is up to"
                   f" {scientific(worst)} at the loosest such tolerance and {scientific(tight)} at 1e-13, for"
                   f" {two_digits(1 / statistics.geometric_mean(shares))} times the time (geometric mean,"
                   f" {'published' if found[0][0].solver == PUBLISHED else 'fast'} forms)."))
    pair = quality(study)
    if pair:
        ratio, run, other = pair
        claims.append(("Equal tolerance is not equal quality.", f" At tolerance {run.tolerance:g}, n = {run.n}, s ="
                       f" {run.stages}, `group`'s spectrum errs by {scientific(run.spectrum_error)} and `algebra`'s by"
                       f" {scientific(other.spectrum_error)}: {two_digits(ratio)} times less."))
    return claims


def isospectral_claim(study):
    def errors(kept):
        return [run.spectrum_error for run in study.runs
                if run.usable and study.integrators[run.integrator].isospectral == kept]

    kept, lost = errors(True), errors(False)
    if not kept or not lost:
        return None
    return ("Isospectral is to the solver's tolerance.", f" Over {len(kept)} runs the largest error of an eigenvalue is"
            f" {scientific(max(kept))}; over the {len(lost)} runs of methods that lose the spectrum the median is"
            f" {scientific(statistics.median(lost))}.")
