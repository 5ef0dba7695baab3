"""A study of accuracy against cost as a document: charts and tables."""

import itertools
import math

from lib.accuracy_figures import AGAINST_N
from lib.accuracy_lines import FLOOR_MARGIN, TABLE1_STEP
from lib.comparison import MISSING, percentage, three_digits
from lib.document import Column, Heading, Items, Paragraph, conditions, plain_table, shown
from lib.equal_error import (MEAN_OVER, NAMES, frame_gains, headline_problems, mean, means_by_problem, prices,
                             published_over_fast, runs_at_table1_step, tolerances, written_tolerance)
from lib.formats import SWEEP_CAP, UNSTABLE
from lib.integrator_names import FRAME, KEPT, strongest_structure
from lib.numbers import scientific, span
from lib.recommendation import recommendation_tables

CARE_ERROR, CARE_FACTOR = 1e-6, 10  # near which, within what factor, equal care is shown, ...
CARE_SIZE = 65  # ... at the largest n up to this

CHARTS = (
    ("error_against_time", "Error against CPU time, smooth scene, T = 5. Thin: an integrator in its fast form, with"
     " dots in the co-rotating frame, of a Gauss method the formulation whose step is cheapest. A line ends at"
     f" {FLOOR_MARGIN} times the uncertainty of the reference, where the error stops falling, or where runs take too"
     " long. It breaks at failures and limits. Thick: the cheapest method of each class. Panels have equal decades."),
    ("error_against_time_others", "Error against CPU time for the two largest n of every other scene and time."),
    ("energy_against_time", "Energy error, the largest over the steps, against CPU time, smooth scene. Direct Gauss"
     " lies below the panels: it keeps the energy to rounding."),
    ("error_against_n", f"Left: error at h = {TABLE1_STEP}, the step of Table 1, against n. Right: error at every"
     " step, not in the frame, against h‖B(W₀)‖₂. Smooth scene, T = 5. Lines of all n coincide for Gauss, and not for"
     " RKMK4 and RK4."),
    ("table1_accuracy", "Tables 1 and 2 with their accuracy. Dotted lines join the forms with one answer."),
)
BEYOND_LIMIT = "beyond its stability limit"
LETTERS = {SWEEP_CAP: "c", "stagnated": "s", "diverged": "d", UNSTABLE: "u", BEYOND_LIMIT: "l"}  # of ends of a run
CARE = (  # what was tried and paid
    ("Formulations of the Gauss method", ": predictor, inexact Newton in single precision, triangles, bands"),
    ("Direct Gauss", ": predictor, inexact Newton in single precision, bands"),
    ("Yoshida, Suzuki, Kahan–Li", ": a predictor for each substep, inexact Newton, bands"),
    ("RKMK4", ": late terms of the series in single precision, bands"),
    ("RK4", ": one product a stage in split-complex storage, bands"),
)


def accuracy_sections(study, charts):
    """Returns the document; `charts` are the names of the charts beside it."""
    return [
        Heading("Accuracy against cost", 1),
        Paragraph("Every integrator over step sizes on every problem; errors are relative, in the Frobenius norm. The"
                  " cost of an error is that of the cheapest run with this error or a smaller one, interpolated between"
                  " neighbouring runs that worked. Ratios: geometric mean (from fastest over slowest repetitions to"
                  " slowest over fastest). No range: single timing, on one side at least."),
        *shown(CHARTS, charts),
        Heading("Reference solutions"),
        Items([(str(problem), f": {each.integrators[0]} in {each.steps[0]} and {each.integrators[1]} in {each.steps[1]}"
                f" steps, which differ by {scientific(each.uncertainty)}")
               for problem, each in study.references.items()]),
        *price_section(study),
        *frame_section(study),
        *step_section(study),
        *care_section(study),
        *integrators_section(study),
        *tolerance_section(study),
        Heading("The cheapest sufficient method"),
        *recommendation_tables(study),
        *failures_section(study),
        conditions(study.context),
    ]


def by_size(study, heading, text, entry):
    """Returns a section with a table for each scene and time: a column for each n, a row for each integrator."""
    tables = []
    for (scene, time), group in itertools.groupby(study.problems(), lambda problem: problem[:2]):
        problems = list(group)
        rows = [[name, *entries] for name in study.integrators
                if set(entries := [entry(problem, name) for problem in problems]) != {MISSING}]
        columns = (Column("integrator", align="left"), *(Column(f"n = {problem.n}") for problem in problems))
        tables += [Heading(f"{scene}, T = {time:g}", 3), plain_table(columns, rows)] if rows else []
    return [Heading(heading), Paragraph(text), *tables] if tables else []


def price_section(study):
    found = {other: ratios for other, ratios in prices(study, study.problems()).items() if ratios}
    means = {other: means_by_problem(ratios) for other, ratios in found.items()}

    def entries(other, problem):
        here = [each for (where, _), each in found[other].items() if where == problem]
        return [str(means[other].get(problem, MISSING)), f"{sum(each.value < 1 for each in here)} of {len(here)}"]

    rows = [[str(problem), *itertools.chain.from_iterable(entries(other, problem) for other in found)]
            for problem in study.problems()]
    columns = [Column(head) for other in found for head in (f"over {NAMES[other]}", "cheaper in")]
    return [Heading("The price of structure"),
            Paragraph("Time of the best Gauss form over that of the other method's best form, at equal error,"
                      f" {MEAN_OVER}, where both reach it, and in how many of these comparisons Gauss is cheaper."),
            plain_table((Column("problem", align="left"), *columns), rows)] if found else []


def frame_section(study):
    found = {name: means_by_problem(each) for name, each in frame_gains(study, study.problems()).items()}
    return by_size(study, "What the co-rotating frame buys",
                   f"Time without the frame over time in it, at equal error, {MEAN_OVER}, where both reach it.",
                   lambda problem, name: str(found.get(name, {}).get(problem, MISSING)))


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
        gains = published_over_fast(study, problem, name)
        rows.append([name, three_digits(run.step), scientific(run.error), three_digits(run.seconds),
                     f"{run.equivalent_products:.0f}", percentage(run.equivalent_products / rate.fast / run.seconds),
                     str(mean(gains)) if gains else MISSING])
    columns = (Column("integrator", align="left"), *map(Column, (
        "step", "error", "CPU seconds", "equivalent products", "product share", "published over fast")))
    return [Heading("Equal care"),
            Paragraph(f"{problem}, the run nearest to {CARE_ERROR:g}, within a factor of {CARE_FACTOR}. Product share:"
                      " the time of its products, at the rate of products alone, over all its time; bands and triangles"
                      " count as the part that they are. Published over fast: at equal steps, where errors are equal."),
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


def failures_section(study):
    """Names every fast form with a run that failed or is beyond its limit: who hides failures recommends them."""

    def failed(problem, name):
        bad = [run for run in study.line(problem, name) if not run.usable or run.beyond_limit]
        how = bad and (BEYOND_LIMIT if bad[-1].usable else bad[-1].status)
        return f"{three_digits(bad[-1].step)} {LETTERS[how]}" if bad else MISSING

    letters = ", ".join(f"{letter} {how}" for how, letter in LETTERS.items())
    return by_size(study, "Runs that failed",
                   f"{sum(not run.usable for run in study.runs)} of {len(study.runs)} runs. Of each fast form the"
                   f" smallest step that failed, and how: {letters}. A step beyond the stability limit may come to an"
                   " end because T is short; such a run is never recommended.", failed)
