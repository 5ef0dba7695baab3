"""A study of accuracy against cost as a document: charts and tables."""

import itertools
import math
import os

from lib.records.findings import FILE, as_json
from lib.records.formats import SWEEP_CAP, UNSTABLE
from lib.records.integrators import KEPT, strongest_structure
from lib.records.settings import ENERGY_BOUNDED, LOOSE_EXPONENTIAL, MATCHED, TABLE1_STEP, TIGHT
from lib.judging.verdicts import FEWEST, LEVEL, MARGIN, UNDECIDED, level_rows
from lib.pages.document import Column, Entry, Heading, Items, Paragraph, Table, conditions, plain_table, shown
from lib.pages.numbers import MISSING, percentage, power, scientific, span, three_digits
from lib.pages.rendering import Rendering
from studies.accuracy.candidates import CLASSES, EXPLICIT
from studies.accuracy.cheapest import recommendation_tables
from studies.accuracy.equal_error import (FEW, MEAN_OVER, beaten_by, comparison_errors, frame_gains, headline_problems,
                                          is_few, means_by_problem, ratio_in, runs_at_table1_step, tolerances,
                                          written_tolerance)
from studies.accuracy.judge import figures, findings, told_against_n
from studies.accuracy.lines import FLOOR_MARGIN, read_accuracy
from studies.accuracy.schema import CANDIDATES, CUT, GOOD_ENOUGH, OTHER
from studies.limits.schema import read_limits
from studies.tables.comparison import UNDECIDED_MARK

CARE_ERROR, CARE_FACTOR = 1e-6, 10  # near which, within what factor, equal care is shown, ...
CARE_SIZE = 65  # ... at the largest n up to this

PROFILE = ("Performance profile: for each class of methods the share of cases that it solves within a factor of the"
           " time of the cheapest method. Read a line at the left for how often its class is the cheapest, and where it"
           " reaches 100 % for how much more it ever costs. All cases count alike:")
CHARTS = (
    ("time_against_n", "CPU time at an error of 1e-6 over that of the best explicit method, against n. A line for each"
     " class of methods, in the co-rotating frame; it breaks where no method of the class was timed."),
    ("error_against_time", "Work–precision diagram of the smooth scene to T = 50, in the co-rotating frame: the lower a"
     " line, the cheaper the error. Lines break at failures and stability limits, end at their floor or at 1e-9, and"
     " carry an open triangle where they were cut. Panels have equal decades."),
    ("error_against_n", f"Error at h = {TABLE1_STEP}, the step of Table 1, against n, smooth scene to T = 5, not in the"
     " co-rotating frame, tolerance 1e-13. A cross: at the next n the step fails or is beyond the stability limit."),
)
CHIEF = ("explicit", "projected", "elp_bounded", "elp", "magnus", "gauss", "named_published")  # of the first tables
FEW_MARK, BEYOND_MARK = "°", "‡"
BEYOND_LIMIT = "beyond its stability limit"
LETTERS = {SWEEP_CAP: "c", "stagnated": "s", "diverged": "d", UNSTABLE: "u", BEYOND_LIMIT: "l"}  # of ends of a run
CARE = (  # what was tried and paid
    ("Formulations of the Gauss method", ": predictor, inexact Newton in single precision, triangles, bands"),
    ("Exponential Lie–Poisson, explicit Magnus", ": predictor, graded series, single precision, acceptance by estimate,"
     " bands"),
    ("Direct Gauss", ": predictor, inexact Newton in single precision, bands"),
    ("Yoshida, Suzuki, Kahan–Li", ": a predictor for each substep, inexact Newton, bands"),
    ("RKMK4", ": series cut to what the step's error can use, late terms in single precision, bands"),
    ("Explicit methods, projected or not", ": one product a stage in split-complex storage, bands; the projection as"
     " seldom as the error allows"),
)


def accuracy_sections(study, charts, limits=None):
    """Returns the document; `charts` are the names of the charts beside it, `limits` those that no recommended step
    exceeds."""
    return [
        Heading("Accuracy against cost", 1),
        *losses(study),
        Paragraph("Integrators over step sizes on every problem; errors are relative, in the Frobenius norm."
                  " Comparisons give the verdicts. The cost of an error on a line is that of the cheapest run with this"
                  " error or a smaller one, interpolated between neighbouring runs that worked. A line ends at its floor, below"
                  f" {power(GOOD_ENOUGH)}, or is cut by work; nothing is compared with a cut line that might be the"
                  " cheaper. On lines the first steps of runs of much work are timed, and their time is scaled by"
                  " products."),
        *shown((("performance_profile", f"{PROFILE} {cases_text(study)}."), *CHARTS), charts),
        *comparisons_section(study),
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
    return form.integrator if form.tolerance == TIGHT else f"{form.integrator}, {power(form.tolerance)}"


def cases_text(study):
    """Writes where classes were compared at equal error: scenes and times with their n, and the errors."""
    sizes = {}
    for problem in study.problems():
        if any(problem == where for where, _ in study.comparisons):
            sizes.setdefault(problem[:2], []).append(problem.n)
    places = [f"{scene} scene, T = {time:g}, n = {span(found, str)}" for (scene, time), found in sizes.items()]
    return f"{'; '.join(places)}; errors {', '.join(map(power, comparison_errors(study)))}"


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


# ---- comparisons


def losses(study):
    """Says in how many comparisons no class is faster than the best explicit method, by error, and which elsewhere."""
    items = []
    for wanted in comparison_errors(study):
        found = [(problem, beaten_by(comparison)) for problem, comparison in comparisons_at(study, wanted)
                 if EXPLICIT in comparison]
        others = [f"{problem} ({CLASSES[faster[0]].label})" for problem, faster in found if faster]
        items.append((f"Error {power(wanted)}", f": in {len(found) - len(others)} of {len(found)} comparisons no class"
                      " is faster than the best explicit method, which keeps nothing"
                      + (f". The fastest elsewhere: {'; '.join(others)}." if others else ".")))
    return [Items(items)] if items else []


def comparisons_at(study, wanted):
    return [(problem, comparison) for problem in study.problems() if (comparison := study.comparison(problem, wanted))]


def comparisons_section(study):
    """Shows the times and steps of the chief classes, all times over the best explicit method, and every row."""
    if not study.comparisons:
        return []
    times = [table for wanted in comparison_errors(study) for table in times_table(study, wanted)]
    ratios = [table for wanted in comparison_errors(study) for table in ratios_table(study, wanted)]
    head = (*(Column(head, align="left") for head in ("error", "problem", "class", "method")), *map(Column, (
        "steps", "reached", "spectrum error", "equivalent products", "CPU seconds", "processes")))
    rows = [[power(wanted), str(problem), CLASSES[each].label, written(comparison[each]), steps_text(comparison[each]),
             scientific(comparison[each].error), scientific(comparison[each].spectrum_error),
             f"{comparison[each].equivalent_products:.0f}", three_digits(comparison[each].seconds),
             str(len(comparison[each].cpu_seconds))]
            for wanted in comparison_errors(study) for problem, comparison in comparisons_at(study, wanted)
            for each in CANDIDATES if each in comparison]
    return [
        Heading("CPU time at equal error"),
        Paragraph("CPU seconds and, in brackets, steps, by the method of each class that reaches the error in the least"
                  " time. Whole runs in the co-rotating frame, in fresh processes, interleaved. The steps are those"
                  " that take least work: no number of steps that was tried, 2 % apart, is cheaper. Bold: the fastest,"
                  f" or within {100 * (MARGIN - 1):.0f} % of it; †: undecided. {FEW_MARK}: fewer than {FEW} steps, whose"
                  f" time is that of starts. {BEYOND_MARK}: steps beyond the linear limit, which a long run does not"
                  " survive. Exponential methods are shown at the tolerance"
                  f" {power(ENERGY_BOUNDED)}, at which their energy is bounded, and at {power(LOOSE_EXPONENTIAL)}, at"
                  f" which it drifts; Gauss at {power(TIGHT)}; the named methods, Bogfjellmo–Marthinsen and"
                  " Crouch–Grossman, have no fast form."),
        *times,
        Heading("Time over that of the best explicit method"),
        Paragraph(f"With the {100 * LEVEL:.0f} % interval over processes; †: undecided, the interval is on both sides"
                  f" of a bound of the tie within {100 * (MARGIN - 1):.0f} %, or from fewer than {FEWEST} processes."
                  f" Matched: at a tolerance {MATCHED} times smaller than the error."),
        *ratios, *published_section(study),
        Heading("All rows of the comparisons"),
        Paragraph("An error is reached by a whole number of steps and may be smaller than asked for."),
        plain_table(head, rows)]


def steps_text(row):
    """Writes the steps of a row, marked where they are few or beyond the linear limit."""
    return f"{row.steps}" + FEW_MARK * is_few(row) + BEYOND_MARK * row.beyond_limit


def times_table(study, wanted):
    """Returns a heading and the table of seconds and steps of the chief classes at an error."""
    rows = []
    for problem, comparison in comparisons_at(study, wanted):
        chief = {each: comparison[each].cpu_seconds for each in CHIEF if each in comparison}
        common = min(map(len, chief.values()), default=0)  # processes
        level, undecided = level_rows({each: times[:common] for each, times in chief.items()})
        found = {each: f"{three_digits(comparison[each].seconds)} ({steps_text(comparison[each])})" for each in CHIEF
                 if each in comparison}
        rows.append([Entry(str(problem)), *(Entry(
            found.get(each, MISSING) + UNDECIDED_MARK * (each in undecided), each in level) for each in CHIEF)])
    columns = (Column("problem", align="left"), *(Column(CLASSES[each].label) for each in CHIEF))
    return [Heading(f"Error {power(wanted)}", 3), Table(columns, [rows])] if rows else []


def ratios_table(study, wanted):
    """Returns a heading and the table of the times of all classes over that of the best explicit method at an error."""
    new = any(OTHER in comparison for comparison in study.comparisons.values())
    others = [each for each in CANDIDATES if each != EXPLICIT and (each != OTHER or new)]
    rows = [[str(problem), *(over_explicit(comparison, each) for each in others)]
            for problem, comparison in comparisons_at(study, wanted)]
    columns = (Column("problem", align="left"), *(Column(CLASSES[each].label) for each in others))
    return [Heading(f"Error {power(wanted)}", 3), plain_table(columns, rows)] if rows else []


def over_explicit(comparison, candidate):
    """Writes the time of a class over that of the best explicit method."""
    found = ratio_in(comparison, candidate, EXPLICIT)
    return MISSING if found is None else ratio_with_interval(*found)


def ratio_with_interval(ratio, said):
    return f"{ratio.ratio:.2f} ({ratio.low:.2f}–{ratio.high:.2f})" + f" {UNDECIDED_MARK}" * (said == UNDECIDED)


def published_section(study):
    """Shows the methods that the paper named beside its own, both in published form."""
    classes, rows = ("gauss_published", "named_published"), []
    for wanted in comparison_errors(study):
        for problem, comparison in comparisons_at(study, wanted):
            if {*classes} <= {*comparison}:
                gauss, named = (comparison[each] for each in classes)
                rows.append([power(wanted), str(problem), *(text for row in (gauss, named) for text in (
                    written(row), steps_text(row), three_digits(row.seconds))),
                    ratio_with_interval(*ratio_in(comparison, *reversed(classes))),
                    f"{named.equivalent_products / gauss.equivalent_products:.2f}"])
    columns = (*(Column(head, align="left") for head in ("error", "problem")), *(
        Column(head, group, "left" if head == "method" else "right") for group in ("Gauss", "named by the paper")
        for head in ("method", "steps", "CPU seconds")), Column("time"), Column("products"))
    return [Heading("Published forms"),
            Paragraph("The Lie–Poisson methods that the paper calls inefficient, and Gauss methods, each the fastest of"
                      f" its kind in published form, at the tolerance {TIGHT:g}. Time and products: those of the former"
                      " over those of the latter."), plain_table(columns, rows)] if rows else []


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
    for name in told_against_n(study.integrators.values()):
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
    tightest = {(problem, name): (problem, name, tolerance)  # lines, each the last of these keys
                for problem, name, tolerance in sorted(study.lines, key=lambda line: -line[2])}.values()

    def orders(name, scene):
        found = [study.observed_order(problem, *form) for problem, *form in tightest
                 if (problem[:2], form[0]) == (scene, name)]
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
    rows = [[str(loosest.n), study.integrators[loosest.integrator].formulation,
             str(study.integrators[loosest.integrator].stages), scientific(usual.error),
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


def rendered(raw, recorded):
    """Returns the Rendering of a raw file, with what the recorded study of limits says of long steps."""
    study, limits = read_accuracy(raw), read_limits(os.path.join(recorded, "limits", "raw.json"))
    from studies.accuracy.charts import error_against_n, error_against_time  # only now: they need matplotlib
    from studies.accuracy.equal_error_charts import performance_profile, time_against_n

    charts = (performance_profile, time_against_n, error_against_time, error_against_n)
    found = findings(study)
    return Rendering(lambda names: accuracy_sections(study, names, limits), figures(found),
                     {chart.__name__: chart(study) for chart in charts}, {FILE: as_json("accuracy", found)})
