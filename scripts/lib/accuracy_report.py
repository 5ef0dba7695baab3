"""A study of accuracy against cost as a document: what it says, charts and tables."""

import math

from accuracy_claims import (MEAN_OVER, claims, frame_gains, headline_problems, mean, means_by_problem, prices, ratios,
                             scientific, tolerances)
from accuracy_lines import FAST, FLOOR_MARGIN, PUBLISHED, TABLE1_STEP
from benchmark_json import FORMULATIONS
from comparison import MISSING, percentage, three_digits
from document import Column, Heading, Items, Paragraph, conditions, plain_table, shown
from recommendation import KEPT, recommendation_tables, strongest_structure

CARE_ERROR, CARE_FACTOR = 1e-6, 10  # near which, within what factor, equal care is shown, ...
CARE_SIZE = 65  # ... at the largest n up to this

CHARTS = (
    ("error_against_time", "Error against CPU time, smooth scene, T = 5. A thin line is one integrator in its fast form"
     " (of a Gauss method the formulation whose step is cheapest), with dots in the co-rotating frame. It ends at"
     f" {FLOOR_MARGIN} times the uncertainty of the reference, where the error stops falling, or where runs take too"
     " long, and breaks at failures and limits. Thick: of those with the same strongest structure, the cheapest with"
     " this error or a smaller one, upright above the longest step that ran. All panels have equal decades."),
    ("error_against_time_others", "The same for the two largest n of every other scene and time."),
    ("energy_against_time", "The same for the energy error, the largest over the steps, in the smooth scene."),
    ("error_against_n", f"Error at h = {TABLE1_STEP}, the step of Table 1, against n, and of every step, not in the frame,"
     " against h‖B(W₀)‖₂, smooth scene, T = 5. Lines of all n that coincide say that h‖B‖₂ decides, not n."),
    ("table1_accuracy", "Tables 1 and 2 with their accuracy, timed in turns. Dotted lines join the forms with one answer."),
)
# What was tried and paid, by what the name of an integrator begins with.
CARE = {
    **dict.fromkeys(FORMULATIONS, "predictor, inexact Newton in single precision, triangles, bands"),
    **dict.fromkeys(("yoshida", "suzuki", "kahan_li"), "a predictor for each substep, inexact Newton, bands"),
    "direct": "predictor, inexact Newton in single precision, bands",
    "rkmk": "late terms of the series in single precision, bands",
    "rk": "one product a stage in split-complex storage, bands",
}


def accuracy_sections(study, charts):
    """Returns the document; `charts` are the names of the charts beside it."""
    return [
        Heading("Accuracy against cost", 1),
        Paragraph("Every integrator over step sizes on every problem; errors are relative, in the Frobenius norm, and"
                  " costs at an error are interpolated between two neighbouring runs that worked. Ratios: geometric"
                  " mean (from fastest over slowest repetitions to slowest over fastest)."),
        Items(claims(study)),
        *shown(CHARTS, charts),
        Heading("Reference solutions"),
        Items([(str(problem), f": {each.integrators[0]} in {each.steps[0]} and {each.integrators[1]} in {each.steps[1]}"
                f" steps, which differ by {scientific(each.uncertainty)}") for problem, each in study.references.items()]),
        *ratios_section(study, "The price of structure", prices, "{}",
                        "Time of the best Gauss form over that of the other method's best form"),
        *ratios_section(study, "What the co-rotating frame buys", frame_gains, "{0.value:.2g}",
                        "Time without the frame over time in it"),
        *care_section(study),
        *integrators_section(study),
        *tolerance_section(study),
        Heading("The cheapest sufficient method"),
        *recommendation_tables(study),
        *failures_section(study),
        conditions(study.context),
    ]


def by_problem(study, heading, text, entry, columns=()):
    """Returns a section with a row for each integrator and a column for each problem, after some (heading, text).

    Without such columns, integrators without any entry are left out.
    """
    rows = []
    for name, integrator in study.integrators.items():
        entries = [entry(problem, name) for problem in study.problems()]
        if columns or set(entries) != {MISSING}:
            rows.append([name, *(show(integrator) for _, show in columns), *entries])
    heads = (Column("integrator", align="left"), *(Column(name) for name, _ in columns),
             *(Column(f"n = {problem.n}", f"{problem.scene}, T = {problem.time:g}") for problem in study.problems()))
    return [Heading(heading), Paragraph(text), plain_table(heads, rows)] if rows else []


def ratios_section(study, heading, compare, written, text):
    """Shows the geometric mean of an integrator's ratios on each problem, where there are any, written in a format."""
    found = {name: means_by_problem(each) for name, each in compare(study, study.problems()).items()}
    return by_problem(study, heading, f"{text}, at equal error, {MEAN_OVER}, where both have it.",
                      lambda problem, name: written.format(found[name][problem]) if problem in found.get(name, ())
                      else MISSING)


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
        gains = ratios(study, [problem], [name], [name], (PUBLISHED, FAST)).values()
        family = max((each for each in CARE if name.startswith(each)), key=len, default=None)
        rows.append([name, three_digits(run.step), scientific(run.error), three_digits(run.seconds),
                     f"{run.equivalent_products:.0f}", percentage(run.equivalent_products / rate.fast / run.seconds),
                     str(mean(gains)) if gains else MISSING, CARE.get(family, MISSING)])
    columns = (Column("integrator", align="left"), *map(Column, (
        "step", "error", "CPU seconds", "equivalent products", "product share", "published over fast")),
               Column("what makes it fast", align="left"))
    return [Heading("Equal care"),
            Paragraph(f"{problem}, the run nearest to {CARE_ERROR:g}, within a factor of {CARE_FACTOR}. Product share: the time of its products, at the"
                      " rate of products alone, over all its time; bands and triangles count as the part that they are."
                      f" Published over fast: at equal error, {MEAN_OVER}."),
            plain_table(columns, rows)] if rows else []


# ---- each integrator


def integrators_section(study):
    def order(problem, name):
        observed = study.observed_order(problem, name)
        return f"{observed:.2f}" if observed else MISSING

    return by_problem(
        study, "What each integrator is, and its observed order",
        "The order is fitted on the last points above the floor; – where fewer than three are.", order,
        (("order", lambda each: str(each.order)), ("keeps", lambda each: KEPT[strongest_structure(each)])))


def tolerance_section(study):
    """Shows for each cell the loosest tolerance that hardly adds to its error, and what it saves."""
    rows = [[str(loosest.n), loosest.formulation, str(loosest.stages), scientific(usual.error),
             f"{loosest.tolerance:.0e}", three_digits(loosest.seconds / usual.seconds),
             scientific(loosest.spectrum_error), scientific(usual.spectrum_error)]
            for loosest, usual in tolerances(study)]
    if not rows:
        return []
    columns = (Column("n"), Column("formulation", align="left"), *map(Column, (
        "s", f"error at h = {TABLE1_STEP}", "loosest tolerance", "time against 1e-13", "spectrum error", "at 1e-13")))
    failed = sum(not run.usable for run in study.tolerance_runs)
    return [Heading("Which tolerance an accuracy needs"),
            Paragraph("The loosest tolerance of the fixed point that adds less than a tenth to the error which the step"
                      f" size makes, and so do all tighter ones, published forms. {failed} of"
                      f" {len(study.tolerance_runs)} runs did not converge."),
            plain_table(columns, rows)]


def failures_section(study):
    """Names every fast form with a run that failed or is beyond its limit: who hides failures recommends them."""

    def failed(problem, name):
        bad = [run for run in study.line(problem, name) if not run.usable or run.beyond_limit]
        how = dict.fromkeys("beyond its limit" if run.usable else run.status for run in reversed(bad))
        return f"{three_digits(bad[-1].step)} {', '.join(how)}" if bad else MISSING

    return by_problem(study, "Runs that failed",
                      f"{sum(not run.usable for run in study.runs)} of {len(study.runs)} runs. Of each fast form the"
                      " smallest step that failed, and how this and longer ones did. A step beyond the stability limit"
                      " may come to an end because T is short; such a run is never recommended.", failed)
