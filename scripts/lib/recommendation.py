"""Finds the cheapest run that reaches an error and keeps a structure, in what the study of accuracy measured.

The step for an error is interpolated along a line, between two neighbouring runs that worked. Between recorded n, and
between recorded times, steps and seconds are interpolated too. All interpolation is linear in the logarithms. Steps
beyond a failure, beyond the largest step that worked in trials or beyond a stability limit are never offered.
"""

import itertools
import math
import os
import shlex
from typing import Callable, List, NamedTuple

from accuracy_lines import FAST, NEAR_ROUNDING, SCENES, Problem, interpolated
from benchmark_json import one_line
from comparison import MISSING, three_digits
from document import Column, Entry, Heading, Items, Paragraph, Table, plain_table
from study_file import Integrator

# What can be asked for, from the least to the most: a Lie–Poisson integrator keeps the spectrum too.
KEPT = {"nothing": "nothing", "spectrum": "the spectrum", "poisson": "the Lie–Poisson structure"}
MOST_OFFERED = 5  # the winner and its runners-up
TABLE_EXPONENTS = (-2, -4, -6, -8)

# The steps offered are for the error over MARGIN, for interpolation along a line. Between recorded n, and away from a
# recorded time, they are for a smaller one still: at T = 20, the errors of rk4 in the smooth scene at n = 33 are 1.8
# times what interpolation between T = 5 and 50 gives; other methods stay below it.
MARGIN, MARGIN_OF_N, MARGIN_OF_TIME = 1.2, 1.25, 1.6
PREDICTABLE = 0.01  # a reference less certain than that tells no trajectory
SMALLEST_ERROR = 1e-17  # of energy and spectrum, which may be exactly 0

# How the error of energy grows with time, a little more than the most that was seen: n = 33 and 65, smooth and rough, to
# T = 400. It grows while a scene develops, up to SETTLED; then for methods that are not Lie–Poisson only. What the others,
# which lose the spectrum, lose over long times is no such power, and they are not offered.
SETTLED, YOUNG_POWER, MOST_YOUNG, MOST_OLD, OLD_POWER = 50.0, 2.0, 40.0, 2.0, 1.2
ENERGY_JUDGED = (f"the error is that of energy and spectrum, the larger one, of methods that keep the spectrum; it is taken"
                 f" to grow as the square of time up to T = {SETTLED:g}, and later for methods that are not Lie–Poisson,"
                 " about in proportion to time")


class Unanswerable(Exception):
    """A question that nothing measured answers; the message is one line."""


class BelowReference(Exception):
    """An error that the reference solution cannot tell; the message is one line."""


class Question(NamedTuple):
    scene: str
    n: int
    time: float
    error: float
    keep: str


class Offer(NamedTuple):
    """A run that is expected to have the error; `evidence` are the runs it comes from, as columns of a table."""

    integrator: Integrator
    step: float
    steps: int
    error: float
    seconds: float
    evidence: List[dict]


class Answer(NamedTuple):
    question: Question
    offers: List[Offer]  # the cheapest first
    judged: str
    statements: List[str]
    speedup: float  # of this machine against the one of the seconds, None if not known
    source: dict
    scene_arguments: List[str]  # of the program `integrate`


class Basis(NamedTuple):
    """The recorded problems that a question is answered from, and how."""

    weights: dict  # by Problem, in the logarithms; they add up to 1
    trajectory: bool  # whether errors are those of the trajectory, or of energy and spectrum
    growth: Callable[[Integrator], float]  # of the error, from the recorded time to that of the question
    margin: float
    statements: List[str]


def that_keeps(structure):
    return "" if structure == "nothing" else f" that keeps {KEPT[structure]}"


def strongest_structure(integrator):
    return next(structure for structure in reversed(KEPT) if integrator.keeps(structure))


# ---- recorded problems


def neighbours(values, wanted):
    """Returns the values around the wanted one, each with its weight; the nearest alone where it is outside."""
    values = sorted(values)
    for value in values:
        if math.isclose(value, wanted, rel_tol=1e-9):
            return {value: 1.0}
    below, above = [value for value in values if value < wanted], [value for value in values if value > wanted]
    if not below or not above:
        return {(below[-1] if below else above[0]): 1.0}
    share = math.log(wanted / below[-1]) / math.log(above[0] / below[-1])
    return {below[-1]: 1 - share, above[0]: share}


def blend(weights, values):
    """Returns the mean of logarithms as a value."""
    return math.exp(sum(weight * math.log(value) for weight, value in zip(weights, values)))


def joined(values):
    return " and ".join(f"{value:g}" for value in values)


def basis_of(study, question):
    """Returns the Basis of a question. Throws Unanswerable or BelowReference."""
    sizes = {}
    for problem in study.problems():
        if problem.scene == question.scene:
            sizes.setdefault(problem.time, []).append(problem.n)
    times = [time for time, found in sizes.items() if min(found) <= question.n <= max(found)]
    if not times:
        recorded = "; ".join(f"n = {', '.join(map(str, found))} to T = {time:g}" for time, found in sizes.items())
        raise Unanswerable(f"n = {question.n} is outside what is recorded of the scene {question.scene}"
                           f" ({recorded or 'nothing'}), and nothing is extrapolated in n; --modes or --state tries a"
                           " scene itself")
    around = neighbours(times, question.time)
    weights = {Problem(question.scene, time, n): share * part for time, share in around.items()
               for n, part in neighbours(sizes[time], question.n).items()}
    statements, margin, growth = [], MARGIN, 1.0
    used = sorted({problem.n for problem in weights})
    if used != [question.n]:
        margin *= MARGIN_OF_N
        statements.append(f"n = {question.n} is not recorded: steps and seconds are interpolated between n ="
                          f" {joined(used)}")
    longest = max(times)
    uncertainty = max(study.references[problem].uncertainty for problem in weights)
    if question.time > longest * (1 + 1e-9) or uncertainty > PREDICTABLE:
        why = (f"no reference solution goes beyond T = {longest:g}" if question.time > longest * (1 + 1e-9) else
               f"the reference solution is good to {uncertainty:.1g} only")
        statements.append(f"T = {question.time:g} is beyond predictability ({why}): {ENERGY_JUDGED}")
        return Basis(weights, False, lambda each: energy_growth(each, longest, question.time), margin, statements)
    if question.error < uncertainty:
        raise BelowReference(f"--error {question.error:g}: is below the uncertainty of the reference solution,"
                             f" {uncertainty:.2g}")
    if len(around) > 1:
        margin *= MARGIN_OF_TIME
        statements.append(f"T = {question.time:g} is not recorded: steps and seconds are interpolated between T ="
                          f" {joined(around)}")
    elif question.time < min(times) * (1 - 1e-9):
        margin *= MARGIN_OF_TIME
        growth = question.time / min(times)
        statements.append(f"T = {question.time:g} is not recorded: from T = {min(times):g}, up to which the error is"
                          " taken to grow in proportion to time")
    return Basis(weights, True, lambda each: growth, margin, statements)


def safe_runs(study, basis, problem, name):
    """Returns the runs of a line up to the longest safe step, from the shortest one, with the error as judged.

    It ends before the first step that failed, is beyond a limit, or is longer than what worked in trials.
    """
    key = (problem.scene, problem.n, name, FAST)
    longest = study.safe_step_limit(problem.scene, problem.n, name) or 0.0 if key in study.limits else math.inf
    found = []
    for run in reversed(study.line(problem, name)):
        if run.usable and not run.beyond_limit and run.h_norm_B <= longest * (1 + 1e-9):
            found.append(run._replace(error=judged(study, basis, run)))
        elif found:
            break
    return found


def judged(study, basis, run):
    error = (run.error + study.references[run.problem].uncertainty if basis.trajectory else
             max(run.energy_error, run.spectrum_error, SMALLEST_ERROR))
    return error * basis.growth(study.integrators[run.integrator])


def energy_growth(integrator, known, time):
    """Returns the growth of the error of energy and spectrum from a known time on, 1 for an earlier one."""
    young = max(1.0, min(time, SETTLED) / min(known, SETTLED)) ** YOUNG_POWER
    old = max(1.0, max(time, SETTLED) / max(known, SETTLED))
    return min(MOST_YOUNG, young) * min(MOST_OLD, old) if integrator.lie_poisson else young * old ** OLD_POWER


def cost_of(runs, error):
    """Returns the least Cost of an error on safe runs, the shortest step first; None if they do not reach it."""
    runs = list(itertools.dropwhile(lambda run: error < run.error < NEAR_ROUNDING, runs))
    good = list(itertools.takewhile(lambda run: run.error <= error, runs))
    costs = [interpolated(run, run, run.error) for run in good]
    if good and len(good) < len(runs):
        costs.append(interpolated(runs[len(good)], good[-1], error))
    return min(costs, key=lambda cost: cost.seconds, default=None)


def offer_of(study, question, basis, name):
    """Returns the Offer of an integrator, or None."""
    error = question.error / basis.margin
    costs = [cost_of(safe_runs(study, basis, problem, name), error) for problem in basis.weights]
    if None in costs:
        return None

    def blended(value):
        return blend(basis.weights.values(), [value(problem, cost) for problem, cost in zip(basis.weights, costs)])

    step = blended(lambda _, cost: cost.step)
    limits = [study.safe_step_limit(problem.scene, problem.n, name) or math.inf for problem in basis.weights]
    longest = min(limits) / blended(lambda _, cost: cost.fine.h_norm_B / cost.fine.step)
    steps = math.ceil(question.time / min(step, longest, question.time) * (1 - 1e-9))
    shorter = question.time / steps / step
    expected = blended(lambda _, cost: error if cost.coarse is not cost.fine else cost.fine.error)
    seconds = blended(lambda problem, cost: cost.seconds / problem.time) * question.time / shorter
    runs = {id(run): run for cost in costs for run in (cost.coarse, cost.fine)}.values()
    return Offer(study.integrators[name], question.time / steps, steps,
                 expected * min(1.0, shorter) ** study.integrators[name].order, seconds, list(map(evidence, runs)))


def evidence(run):
    return {"integrator": run.integrator, "n": run.n, "time": run.time, "steps": run.steps, "step": run.step,
            "error": run.error, "seconds": run.seconds, "status": run.status}


def candidates(study, question, basis):
    """Returns the names of the integrators that may be offered."""
    return [name for name, each in study.integrators.items()
            if each.keeps(question.keep) and (basis.trajectory or each.isospectral)]


def ranking(study, question, basis):
    """Returns the offer of each integrator that reaches the error, the cheapest first."""
    offers = (offer_of(study, question, basis, name) for name in candidates(study, question, basis))
    return sorted(filter(None, offers), key=lambda offer: (offer.seconds, offer.error))


def answer(study, question, path, rate_here=lambda n: None):
    """Returns the Answer. Throws Unanswerable or BelowReference. `rate_here(n)` measures products per second."""
    basis = basis_of(study, question)
    offers = ranking(study, question, basis)
    if not offers:
        raise Unanswerable(best_there_is(study, question, basis))
    speedup = None
    if min(study.rates, default=math.inf) <= question.n <= max(study.rates, default=0):
        around = neighbours(study.rates, question.n)
        here = rate_here(question.n)
        speedup = here and here / blend(around.values(), [study.rates[n].fast for n in around])
    source = {"raw": one_line(path), **{name: study.context.get(name) for name in ("cpu", "commit", "dirty")}}
    arguments = ["--scene", question.scene]
    statements = basis.statements
    if question.scene == SCENES[2]:
        arguments = ["--initial", f"developed_n{question.n}.npy"]
        statements = [*statements, f"the developed state is made by: {integrate()} --n {question.n} --scene smooth"
                      f" --integrator group5 --solver fast --step 0.05 --time 100 --output {arguments[1]}"]
    judged_by = "trajectory" if basis.trajectory else "energy and spectrum"
    return Answer(question, offers[:MOST_OFFERED], judged_by, statements, speedup, source, arguments)


def best_there_is(study, question, basis):
    """Says in a line that nothing reaches the error, and what comes nearest."""
    found = []
    for name in candidates(study, question, basis):
        lines = [safe_runs(study, basis, problem, name) for problem in basis.weights]
        if all(lines):
            found.append(max((min(line, key=lambda run: run.error) for line in lines), key=lambda run: run.error))
    what = f"no recorded method{that_keeps(question.keep)}"
    if not found:
        return f"{what} has a safe run at n = {question.n} to T = {question.time:g}"
    best = min(found, key=lambda run: run.error)
    return (f"{what} is known to reach the error {question.error:g} with a margin of {basis.margin:g}; the best there is"
            f" has {best.error:.3g}, by {best.integrator} with h = {best.step:.4g} at n = {best.n} to T = {best.time:g}")


# ---- the answer


def integrate():
    """Returns the path of the program `integrate`, from here where that is shorter."""
    here = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
    path = os.path.join(os.environ.get("ISOSYRK_BUILD") or os.path.join(here, "build"), "benchmarks", "integrate")
    return shlex.quote(min(os.path.relpath(path), os.path.abspath(path), key=len))


def command(found, offer):
    """Returns the line that runs an offer."""
    return (f"{integrate()} --n {found.question.n} {shlex.join(found.scene_arguments)} --integrator"
            f" {offer.integrator.name} --solver fast --step {offer.step!r} --time {found.question.time!r}")


def seconds_here(found, offer):
    return offer.seconds / (found.speedup or 1.0)


def answer_document(found):
    """Returns the answer as a document: the winner, its rivals, and where the numbers come from."""
    question, (winner, *others) = found.question, found.offers
    recorded = f" ({three_digits(winner.seconds)} where it was recorded)" if found.speedup else ""
    facts = {
        "method": f"{winner.integrator.name}, order {winner.integrator.order}, keeps"
                  f" {KEPT[strongest_structure(winner.integrator)]}",
        "solver": "fast",
        "step": f"h = {winner.step:.6g} ({winner.steps} steps)",
        "expected error": f"{winner.error:.3g} ({found.judged})",
        "CPU seconds": three_digits(seconds_here(found, winner)) + recorded,
    }
    columns = (Column("method", align="left"), Column("order"), Column("keeps", align="left"), Column("step"),
               Column("steps"), Column("error"), Column("CPU seconds"), Column("times as long"))
    rows = [[offer.integrator.name, str(offer.integrator.order), KEPT[strongest_structure(offer.integrator)],
             f"{offer.step:.4g}", str(offer.steps), f"{offer.error:.3g}", three_digits(seconds_here(found, offer)),
             three_digits(offer.seconds / winner.seconds)] for offer in others]
    tried = (Column("method", align="left"), Column("n"), Column("to T"), Column("steps"), Column("error"),
             Column("CPU seconds"), Column("status", align="left"))
    return [
        Paragraph(f"The cheapest method{that_keeps(question.keep)} for the scene {question.scene}, n = {question.n}, to"
                  f" T = {question.time:g} with an error of {question.error:g} or less:"),
        Items([(name, f": {text}") for name, text in facts.items()]),
        *(Paragraph(f"Note: {each}.") for each in found.statements),
        *([Paragraph("Runners-up:"), plain_table(columns, rows)] if others else
          [Paragraph("No other integrator does.")]),
        Paragraph("Evidence:"),
        plain_table(tried, [[each["integrator"], str(each["n"]), f"{each['time']:.4g}", str(each["steps"]),
                             MISSING if each["error"] is None else f"{each['error']:.3g}",
                             MISSING if each["seconds"] is None else three_digits(each["seconds"]), each["status"]]
                            for each in winner.evidence]),
        Items([(name, f": {text}") for name, text in found.source.items() if text is not None]),
    ]


def answer_data(found):
    """Returns the answer for programs, as what JSON can hold."""
    def data(offer):
        return {"integrator": offer.integrator.name, "solver": FAST, "step": offer.step, "steps": offer.steps,
                "expected_error": offer.error, "seconds": seconds_here(found, offer),
                "seconds_recorded": offer.seconds, "keeps": strongest_structure(offer.integrator),
                "order": offer.integrator.order, "command": command(found, offer)}

    winner, *others = found.offers
    return {**data(winner), "question": found.question._asdict(), "judged": found.judged,
            "statements": found.statements, "speedup": found.speedup, "evidence": winner.evidence,
            "runners_up": [{**data(offer), "ratio": offer.seconds / winner.seconds} for offer in others],
            "source": found.source}


# ---- the table


def recommendation_tables(study):
    """Returns, for each structure, a heading and a table of the winner by scene, n and error; then how to read them."""
    def entry(problem, structure, exponent):
        question = Question(problem.scene, problem.n, problem.time, 10.0**exponent, structure)
        try:
            winner = ranking(study, question, basis_of(study, question))[0]
        except (Unanswerable, BelowReference, IndexError):
            return Entry(MISSING)
        return Entry(f"{winner.integrator.name}, h = {winner.step:.3g}, {three_digits(winner.seconds)} s")

    columns = (Column("scene", align="left"), Column("T"), Column("n"),
               *(Column(f"error 1e{exponent}", align="left") for exponent in TABLE_EXPONENTS))
    parts = []
    for structure in KEPT:
        rows = [[Entry(problem.scene), Entry(f"{problem.time:g}"), Entry(str(problem.n)),
                 *(entry(problem, structure, exponent) for exponent in TABLE_EXPONENTS)]
                for problem in study.problems()]
        heading = "Whatever is kept" if structure == "nothing" else f"Keeping {KEPT[structure]}"
        parts += [Heading(heading, 3), Table(columns, [rows])]
    return [*parts, Paragraph(
        "The cheapest method by its fast form, as scripts/recommend answers: method, step, CPU seconds, interpolated along"
        f" the line for the column's error over {MARGIN}. A step is never longer than what worked in trials."
        f' "{MISSING}": nothing recorded reaches the error.')]
