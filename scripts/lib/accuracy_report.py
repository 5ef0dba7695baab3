"""A study of accuracy against cost as a document: charts and tables."""

import itertools
import math

from lib.accuracy_figures import AGAINST_N
from lib.accuracy_lines import CONTENDERS, CUT, FLOOR_MARGIN, GOOD_ENOUGH, MATCHED, TABLE1_STEP, TIGHT
from lib.comparison import MISSING, percentage, three_digits
from lib.document import Column, Heading, Items, Paragraph, conditions, plain_table, shown
from lib.equal_error import (CONTENDER_NAMES, MEAN_OVER, contenders_of, duel_errors, frame_gains, headline_problems,
                             means_by_problem, ratio_in, runs_at_table1_step, tolerances, written_tolerance)
from lib.formats import SWEEP_CAP, UNSTABLE
from lib.integrator_names import FRAME, KEPT, strongest_structure
from lib.numbers import power, scientific, span
from lib.recommendation import recommendation_tables
from lib.verdicts import FEWEST, LEVEL, MARGIN, UNDECIDED

CARE_ERROR, CARE_FACTOR = 1e-6, 10  # near which, within what factor, equal care is shown, ...
CARE_SIZE = 65  # ... at the largest n up to this

CHARTS = (
    ("time_against_n", "CPU seconds to an error of 1e-6 against n, smooth and rough scene to T = 5, from the duels. A"
     " line for each class of methods, in the co-rotating frame; it breaks where no method of the class was timed."),
    ("error_against_time", "Work–precision diagram of the smooth scene to T = 5, in the co-rotating frame: the lower a"
     " line, the cheaper the error. Lines break at failures and stability limits, end at their floor or at 1e-9, and"
     " carry an open triangle where they were cut. Panels have equal decades."),
    ("error_against_n", f"Error at h = {TABLE1_STEP}, the step of Table 1, against n, smooth scene to T = 5, not in the"
     " co-rotating frame, tolerance 1e-13. A cross: at the next n the step fails or is beyond the stability limit."),
)
BEYOND_LIMIT = "beyond its stability limit"
LETTERS = {SWEEP_CAP: "c", "stagnated": "s", "diverged": "d", UNSTABLE: "u", BEYOND_LIMIT: "l"}  # of ends of a run
CARE = (  # what was tried and paid
    ("Formulations of the Gauss method", ": predictor, inexact Newton in single precision, triangles, bands"),
    ("Exponential Lie–Poisson, explicit Magnus", ": predictor, graded series, single precision, acceptance by estimate,"
     " bands"),
    ("Direct Gauss", ": predictor, inexact Newton in single precision, bands"),
    ("Yoshida, Suzuki, Kahan–Li", ": a predictor for each substep, inexact Newton, bands"),
    ("RKMK4", ": series cut to what the step's error can use, late terms in single precision, bands"),
    ("RK4, projected RK4", ": one product a stage in split-complex storage, bands; the projection as seldom as the"
     " error allows"),
)


def accuracy_sections(study, charts, limits=None):
    """Returns the document; `charts` are the names of the charts beside it, `limits` those that no recommended step
    exceeds."""
    return [
        Heading("Accuracy against cost", 1),
        Paragraph("Integrators over step sizes on every problem; errors are relative, in the Frobenius norm. Duels give"
                  " the verdicts. The cost of an error on a line is that of the cheapest run with this error or a"
                  " smaller one, interpolated between neighbouring runs that worked. A line ends at its floor, below"
                  f" {GOOD_ENOUGH:g}, or is cut by work; nothing is compared with a cut line that might be cheaper."),
        Paragraph("Explicit methods of order 8 are not in the study. Where the cheapest method stands below, that is"
                  " among the methods that were run. To be measured anew against explicit methods of order 8."),
        *shown(CHARTS, charts),
        *duels_section(study),
        Heading("Reference solutions"),
        Items([(str(problem), f": {each.integrators[0]} in {each.steps[0]} and {each.integrators[1]} in {each.steps[1]}"
                f" steps, which differ by {scientific(each.uncertainty)}")
               for problem, each in study.references.items()]),
        *frame_section(study),
        *step_section(study),
        *care_section(study),
        *integrators_section(study),
        *tolerance_section(study),
        Heading("The cheapest sufficient method"),
        *recommendation_tables(study, limits),
        *ends_section(study),
        *failures_section(study),
        conditions(study.context),
    ]


def written(form):
    """Writes a Form: the integrator, and its tolerance unless that is the tightest."""
    name, tolerance = form.integrator, power(form.tolerance)
    return name if form.tolerance == TIGHT else f"{name}, {tolerance}"


def by_size(study, heading, text, rows, entry):
    """Returns a section with a table for each scene and time: a column for each n, a row for each of `rows`.

    `rows` are (text, what entry(problem, …) is asked for); a row without entries is left out.
    """
    tables = []
    for (scene, time), group in itertools.groupby(study.problems(), lambda problem: problem[:2]):
        problems = list(group)
        found = [[text, *entries] for text, what in rows
                 if set(entries := [entry(problem, what) for problem in problems]) != {MISSING}]
        columns = (Column("integrator", align="left"), *(Column(f"n = {problem.n}") for problem in problems))
        tables += [Heading(f"{scene}, T = {time:g}", 3), plain_table(columns, found)] if found else []
    return [Heading(heading), Paragraph(text), *tables] if tables else []


def duels_section(study):
    """Shows duels: the time of each contender over that of the exponential method, then every row."""
    contenders = contenders_of(study)
    parts = []
    for wanted in duel_errors(study):
        found = {problem: duel for problem in study.problems() if (duel := study.duel(problem, wanted))}
        columns = (Column("problem", align="left"), *(Column(CONTENDER_NAMES[each]) for each in contenders))
        ratios = [[str(problem), *(over_exponential(duel, each) for each in contenders)]
                  for problem, duel in found.items()]
        rows = [[str(problem), CONTENDER_NAMES[each], written(row), str(row.steps), scientific(row.error),
                 scientific(row.spectrum_error), f"{row.equivalent_products:.0f}", three_digits(row.seconds),
                 str(len(row.cpu_seconds))]
                for problem, duel in found.items() for each, row in in_order(duel)]
        heads = ("steps", "error", "spectrum error", "equivalent products", "CPU seconds", "processes")
        parts += [Heading(f"Error {wanted:g}", 3), plain_table(columns, ratios),
                  plain_table((*(Column(head, align="left") for head in ("problem", "contender", "method")),
                               *map(Column, heads)), rows)]
    matched = (f" Matched: at a tolerance {MATCHED} times smaller than the error, where that is looser."
               if {"gauss_matched", "elp_matched"} & {*contenders} else "")
    return [Heading("Time at equal error"),
            Paragraph("For each contender stands the method of its kind that reaches the error at the least cost, in"
                      " the co-rotating frame, with the steps that take least work; the published form takes the steps"
                      " of the best Gauss method. Loose: Gauss at 1e-7. Exponential and Magnus: at 1e-8 unless said."
                      f"{matched} Times: whole runs in fresh processes, in turns. First table: time over that of the"
                      f" exponential method ({100 * LEVEL:.0f} % interval over processes); †: undecided, the interval"
                      f" is on both sides of a bound of the tie within {100 * (MARGIN - 1):.0f} %, or from fewer than"
                      f" {FEWEST} processes. Runs of few steps time starts: compare the numbers of steps. An error is"
                      " reached by a whole number of steps and may be smaller than asked for. No row takes a step"
                      " beyond the limit of stability, though a run of a few such steps can reach the error."),
            *parts] if parts else []


def in_order(duel):
    return [(each, duel[each]) for each in CONTENDERS if each in duel]


def over_exponential(duel, contender):
    """Writes the time of a contender over that of the exponential method."""
    found = ratio_in(duel, contender, "elp")
    if found is None:
        return MISSING
    if contender == "elp":
        return "1"
    ratio, said = found
    return f"{ratio.ratio:.2f} ({ratio.low:.2f}–{ratio.high:.2f})" + " †" * (said == UNDECIDED)


def frame_section(study):
    found = {name: means_by_problem(each) for name, each in frame_gains(study, study.problems()).items()}

    def entry(problem, name):
        return f"{found[name][problem]:.2g}" if problem in found[name] else MISSING

    return by_size(study, "What the co-rotating frame buys",
                   f"Time without the frame over time in it, at equal error, {MEAN_OVER}, where both reach it. Timings"
                   " of one process.", [(name, name) for name in found], entry)


def step_section(study):
    """Shows that one step size is not one accuracy."""
    sizes = [problem.n for problem in headline_problems(study)]
    rows = []
    for name in (f"{each}{suffix}" for each in AGAINST_N for suffix in ("", FRAME)):
        errors = {run.n: scientific(run.error) for run in runs_at_table1_step(study, name)}
        rows += [[name, *(errors.get(n, MISSING) for n in sizes)]] if errors else []
    columns = (Column("integrator", align="left"), *(Column(f"n = {n}") for n in sizes))
    return [Heading(f"Error at h = {TABLE1_STEP}"),
            Paragraph(f"Smooth scene, T = 5. {MISSING}: the step does not work."),
            plain_table(columns, rows)] if rows else []


def care_section(study):
    """Shows what each fast form spends its time on, at one problem and near one error."""
    problem = next((each for each in reversed(headline_problems(study)) if each.n <= CARE_SIZE), None)
    rate = problem and study.rates.get(problem.n)
    rows = []
    for name in study.integrators if rate else ():
        runs = [run for run in study.above_floor(problem, name) if not run.beyond_limit
                and CARE_ERROR / CARE_FACTOR <= run.error <= CARE_ERROR * CARE_FACTOR]
        if not runs:
            continue
        run = min(runs, key=lambda each: abs(math.log(each.error / CARE_ERROR)))
        rows.append([name, three_digits(run.step), scientific(run.error), three_digits(run.seconds),
                     f"{run.equivalent_products:.0f}", percentage(run.equivalent_products / rate.fast / run.seconds)])
    columns = (Column("integrator", align="left"), *map(Column, (
        "step", "error", "CPU seconds", "equivalent products", "product share")))
    return [Heading("Equal care"),
            Paragraph(f"{problem}, tolerance 1e-13, the run nearest to {CARE_ERROR:g}, within a factor of"
                      f" {CARE_FACTOR}. Product share: the time of its products, at the rate of products alone, over"
                      " all its time; bands and triangles count as the part that they are."),
            plain_table(columns, rows), Paragraph("What makes them fast:"), Items(CARE)] if rows else []


# ---- each integrator


def integrators_section(study):
    scenes = list(dict.fromkeys(problem[:2] for problem in study.problems()))

    def orders(name, scene):
        found = [study.observed_order(problem, name) for problem in study.problems() if problem[:2] == scene]
        return span(list(filter(None, found)), "{:.2f}".format) if any(found) else MISSING

    rows = [[name, str(each.order), KEPT[strongest_structure(each)], *(orders(name, scene) for scene in scenes)]
            for name, each in study.integrators.items()]
    columns = (Column("integrator", align="left"), Column("order"), Column("keeps", align="left"),
               *(Column(f"{scene}, T = {time:g}") for scene, time in scenes))
    return [Heading("What each integrator is, and its observed order"),
            Paragraph("The order is fitted on the last three points above the floor, at each n that has as many: the"
                      " least and the largest."), plain_table(columns, rows)]


def tolerance_section(study):
    """Shows for each cell the loosest tolerance that hardly adds to its error, and what it saves."""
    rows = [[str(loosest.n), loosest.formulation, str(loosest.stages), scientific(usual.error),
             written_tolerance(study, loosest), three_digits(loosest.seconds / usual.seconds),
             scientific(loosest.spectrum_error), scientific(usual.spectrum_error)]
            for loosest, usual in tolerances(study)]
    if not rows:
        return []
    columns = (Column("n"), Column("formulation", align="left"), *map(Column, (
        "s", f"error at h = {TABLE1_STEP}", "loosest tolerance", "time against 1e-13", "spectrum error", "at 1e-13")))
    failed = sum(not run.usable for run in study.tolerance_runs)
    return [Heading("Which tolerance an accuracy needs"),
            Paragraph("The loosest tolerance of the fixed point that adds less than a tenth to the error which the step"
                      " size makes, and so do all tighter ones, published forms. At least: none looser was tried."
                      f" {failed} of {len(study.tolerance_runs)} runs did not converge."),
            plain_table(columns, rows)]


def ends_section(study):
    """Names the lines that were cut, with their smallest error: comparisons stop there."""
    def entry(problem, form):
        if study.ends.get((problem, *form)) != CUT:
            return MISSING
        errors = [run.error for run in study.line(problem, *form) if run.usable]
        return scientific(min(errors)) if errors else "no run"

    return by_size(study, "Lines that were cut",
                   "The smallest error of each line that was cut by work, before its error was at its floor or below"
                   f" {GOOD_ENOUGH:g}. Floor: within {FLOOR_MARGIN} times the uncertainty of the reference, or no"
                   " longer falling with the step.", [(written(form), form) for form in study.forms()], entry)


def failures_section(study):
    """Names every line with a run that failed or is beyond its limit: who hides failures recommends them."""

    def entry(problem, form):
        bad = [run for run in study.line(problem, *form) if not run.usable or run.beyond_limit]
        how = bad and (BEYOND_LIMIT if bad[-1].usable else bad[-1].status)
        return f"{three_digits(bad[-1].step)} {LETTERS[how]}" if bad else MISSING

    letters = ", ".join(f"{letter} {how}" for how, letter in LETTERS.items())
    return by_size(study, "Runs that failed",
                   f"{sum(not run.usable for run in study.runs)} of {len(study.runs)} runs. Of each line the smallest"
                   f" step that failed, and how: {letters}. A step beyond the stability limit may come to an end"
                   " because T is short; such a run is never recommended.",
                   [(written(form), form) for form in study.forms()], entry)
