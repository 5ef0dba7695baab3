"""A study of accuracy against cost as a document: charts and tables."""

from benchmark_json import FORMULATIONS
from comparison import MISSING, three_digits
from document import Column, Heading, Paragraph, conditions, plain_table, shown
from recommendation import recommendation_tables
from accuracy_lines import TABLE1_STEP

# The tolerance does no harm where what it adds is at most this share of the error that the step size makes.
HARMLESS = 0.1

CHARTS = (
    ("error_against_time", "Error at T against CPU time, one panel for each n; lines end at the floor of the reference."),
    ("tolerance", "Errors and time against the tolerance of the fixed point, at the step size of Table 1."),
    ("table1_accuracy", "Table 1 with its accuracy: every cell as time against error."),
)


def accuracy_sections(study, charts, level=1):
    """Returns the document; `charts` are the names of the charts beside it."""
    return [
        Heading("Accuracy against cost", level),
        Paragraph(f"Every integrator over step sizes at n = {listed(study.sizes())}, T = {study.time:g}, error relative"
                  " in the Frobenius norm. " + references_sentence(study)),
        *shown(CHARTS, charts),
        *properties_section(study, level + 1),
        *fixed_step_section(study, level + 1),
        *tolerance_section(study, level + 1),
        Heading("The cheapest sufficient method", level + 1),
        *recommendation_tables(study, level=level + 2),
        *failures_section(study, level + 1),
        conditions(study.context),
    ]


def listed(items):
    return ", ".join(map(str, items))


def scientific(value):
    """Writes an error with two digits, as 5.3e-4."""
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def references_sentence(study):
    worst = max(study.references.values(), key=lambda reference: reference.uncertainty)
    return (f"Reference solutions come from {' and '.join(worst.integrators)}, which differ by at most"
            f" {scientific(worst.uncertainty)} (n = {worst.n}); an error is drawn and fitted only above ten times"
            " that, and only while a smaller step still lowers it.")


def properties_section(study, level):
    """Shows what each integrator promises, and the order that its lines show at each n."""
    sizes = study.sizes()
    columns = (Column("integrator", align="left"), Column("order"),
               *(Column(f"n = {n}", "observed order") for n in sizes),
               *(Column(name) for name in ("isospectral", "Lie–Poisson", "symmetric", "explicit")))
    rows = []
    for each in study.integrators.values():
        orders = [study.observed_order(each.name, n) for n in sizes]
        kept = (each.isospectral, each.lie_poisson, each.symmetric, each.explicit)
        rows.append([each.name, str(each.order), *(f"{order:.2f}" if order else MISSING for order in orders),
                     *("yes" if value else "no" for value in kept)])
    return [Heading("What each integrator is", level),
            Paragraph("Each property is tested in both directions by the project's tests. The order is fitted on the last"
                      f" points above the floor; {MISSING} where fewer than three are."), plain_table(columns, rows)]


def fixed_step_section(study, level):
    columns = (Column("integrator", align="left"), *(Column(f"n = {n}") for n in study.sizes()))
    rows = [[name, *(error_at(study.at_step(name, n, TABLE1_STEP)) for n in study.sizes())]
            for name in study.integrators]
    return [Heading(f"Error at h = {TABLE1_STEP}", level),
            Paragraph("The step size of Table 1. What a method did instead of converging is named."),
            plain_table(columns, rows)]


def error_at(run):
    if run is None:
        return MISSING
    return scientific(run.error) if run.usable else run.status


class HarmlessTolerance:
    """The loosest tolerance of one cell that hardly adds to its error, and what it saves."""

    def __init__(self, runs):
        tightest = runs[-1]
        self.n, self.formulation, self.stages = tightest.n, tightest.formulation, tightest.stages
        self.error = tightest.error
        good = len(runs)
        while good > 0 and runs[good - 1].solver_error <= HARMLESS * self.error:
            good -= 1
        self.loosest = runs[min(good, len(runs) - 1)]
        self.usual = min(runs, key=lambda run: abs(run.tolerance - 1e-13))
        self.time_ratio = self.loosest.seconds / self.usual.seconds


def harmless_tolerances(study):
    """Returns a HarmlessTolerance for each cell, all tighter tolerances of which are harmless too."""
    cells = {}
    for run in study.tolerance_runs:
        if run.usable:
            cells.setdefault((run.n, run.formulation, run.stages), []).append(run)
    return [HarmlessTolerance(sorted(runs, key=lambda run: -run.tolerance))
            for _, runs in sorted(cells.items(), key=lambda item: (item[0][0], FORMULATIONS.index(item[0][1]), item[0][2]))]


def tolerance_section(study, level):
    found = harmless_tolerances(study)
    if not found:
        return []
    columns = (Column("n"), Column("formulation", align="left"), Column("s"), Column("error at h = 0.1"),
               Column("loosest tolerance"), Column("sweeps against 1e-13"), Column("time against 1e-13"),
               Column("spectrum error there"))
    rows = [[str(row.n), row.formulation, str(row.stages), scientific(row.error), f"{row.loosest.tolerance:.0e}",
             f"{row.loosest.sweeps}/{row.usual.sweeps}", three_digits(row.time_ratio),
             scientific(row.loosest.spectrum_error)] for row in found]
    failed = [run for run in study.tolerance_runs if not run.usable]
    text = ("The loosest tolerance of the fixed point that adds less than a tenth to the error which the step size makes,"
            " and so do all tighter ones.")
    if failed:
        text += (f" {len(failed)} of {len(study.tolerance_runs)} runs did not converge, at tolerances of"
                 f" {max(run.tolerance for run in failed):.0e} or less.")
    return [Heading("Which tolerance an accuracy needs", level), Paragraph(text), plain_table(columns, rows)]


def failures_section(study, level):
    """Lists every run that failed: a study that hides its failures recommends them."""
    rows = []
    for n in study.sizes():
        for name in study.integrators:
            failed = [run for run in study.line(name, n) if not run.usable]
            if failed:
                rows.append([str(n), name, listed(f"{three_digits(run.step)} {run.status}"
                                                  for run in failed)])
    beyond = [run for run in study.runs if run.beyond_limit and run.usable]
    text = f"Of {len(study.runs)} runs {sum(not run.usable for run in study.runs)} failed."
    if beyond:
        text += (f" {len(beyond)} more came to an end beyond their stability limit, because T is short"
                 f" ({listed(sorted({run.integrator for run in beyond}))}); they are recorded and never recommended.")
    parts = [Heading("Runs that failed", level), Paragraph(text)]
    if rows:
        columns = (Column("n"), Column("integrator", align="left"), Column("step sizes, and how", align="left"))
        parts.append(plain_table(columns, rows))
    return parts
