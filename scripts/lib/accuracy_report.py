"""A study of accuracy against cost as a document: charts and tables."""

from benchmark_json import FORMULATIONS
from comparison import MISSING, three_digits
from document import Column, Heading, Paragraph, conditions, plain_table, shown
from recommendation import recommendation_tables
from accuracy_lines import FLOOR_MARGIN, TABLE1_STEP

# The tolerance does no harm where what it adds is at most this share of the error that the step size makes.
HARMLESS = 0.1

CHARTS = (
    ("error_against_time", "Error at T against CPU time, one panel for each n. A line ends where the reference can no"
     f" longer tell its error (grey: up to {FLOOR_MARGIN} times the uncertainty), where it stops falling, or where runs"
     " take too long. A cross marks the longest step that works where longer ones failed."),
    ("tolerance", "Errors and time against the tolerance of the fixed point, at the step size of Table 1, h ="
     f" {TABLE1_STEP}. Solver error: distance from the answer with the tightest tolerance that converged. The diagonal"
     " is where an error equals the tolerance."),
    ("table1_accuracy", "Table 1 with its accuracy: every cell that did not fail as time against error. Thin lines join"
     " the stages of a formulation at one n, dotted lines the formulations with one answer. Bars span the quartiles."),
)


def accuracy_sections(study, charts):
    """Returns the document; `charts` are the names of the charts beside it."""
    return [
        Heading("Accuracy against cost", 1),
        Paragraph(f"Every integrator over step sizes, to T = {study.time:g}; errors are relative, in the Frobenius"
                  f" norm. An error is drawn and fitted only above {FLOOR_MARGIN} times the uncertainty of the"
                  " reference solution, and only while a smaller step still lowers it."),
        *shown(CHARTS, charts),
        *references_section(study),
        *properties_section(study),
        *fixed_step_section(study),
        *tolerance_section(study),
        Heading("The cheapest sufficient method"),
        *recommendation_tables(study),
        *failures_section(study),
        conditions(study.context),
    ]


def scientific(value):
    """Writes an error with two digits, as 5.3e-4."""
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}" if value else "0"


def references_section(study):
    columns = (Column("n"), Column("from", align="left"), Column("which differ by"))
    rows = [[str(n), " and ".join(each.integrators), scientific(each.uncertainty)]
            for n, each in sorted(study.references.items())]
    return [Heading("Reference solutions"), plain_table(columns, rows)]


def properties_section(study):
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
    return [Heading("What each integrator is"),
            Paragraph("Each property is tested in both directions by the project's tests. The order is fitted on the"
                      f" last points above the floor; {MISSING} where fewer than three are."),
            plain_table(columns, rows)]


def fixed_step_section(study):
    def error_at(run):
        if run is None:
            return MISSING
        return scientific(run.error) if run.usable else run.status

    columns = (Column("integrator", align="left"), *(Column(f"n = {n}") for n in study.sizes()))
    rows = [[name, *(error_at(study.at_step(name, n, TABLE1_STEP)) for n in study.sizes())]
            for name in study.integrators]
    return [Heading(f"Error at h = {TABLE1_STEP}"),
            Paragraph("The step size of Table 1. What a method did instead of converging is named."),
            plain_table(columns, rows)]


def tolerance_section(study):
    """Shows for each cell the loosest tolerance that hardly adds to its error, and what it saves."""
    cells = {}
    for run in sorted(study.tolerance_runs, key=lambda run: (run.n, FORMULATIONS.index(run.formulation), run.stages,
                                                             run.tolerance)):
        if run.usable:
            cells.setdefault((run.n, run.formulation, run.stages), []).append(run)
    rows = []
    for (n, formulation, stages), runs in cells.items():
        error = runs[0].error
        harmful = next((index for index, run in enumerate(runs) if run.solver_error > HARMLESS * error), len(runs))
        loosest = runs[max(harmful - 1, 0)]
        usual = min(runs, key=lambda run: abs(run.tolerance - 1e-13))
        rows.append([str(n), formulation, str(stages), scientific(error), f"{loosest.tolerance:.0e}",
                     f"{loosest.sweeps}/{usual.sweeps}", three_digits(loosest.seconds / usual.seconds),
                     scientific(loosest.spectrum_error)])
    if not rows:
        return []
    columns = (Column("n"), Column("formulation", align="left"), Column("s"), Column(f"error at h = {TABLE1_STEP}"),
               Column("loosest tolerance"), Column("sweeps against 1e-13"), Column("time against 1e-13"),
               Column("spectrum error there"))
    failed = sum(not run.usable for run in study.tolerance_runs)
    return [Heading("Which tolerance an accuracy needs"),
            Paragraph("The loosest tolerance of the fixed point that adds less than a tenth to the error which the step"
                      f" size makes, and so do all tighter ones. {failed} of {len(study.tolerance_runs)} runs did not"
                      " converge."),
            plain_table(columns, rows)]


def failures_section(study):
    """Lists every run that failed or lies beyond its limit: a study that hides its failures recommends them."""
    rows = []
    for n in study.sizes():
        for name in study.integrators:
            found = [f"{three_digits(run.step)} {'beyond its limit' if run.usable else run.status}"
                     for run in study.line(name, n) if not run.usable or run.beyond_limit]
            if found:
                rows.append([str(n), name, ", ".join(found)])
    columns = (Column("n"), Column("integrator", align="left"), Column("step sizes, and how", align="left"))
    return [Heading("Runs that failed"),
            Paragraph(f"{sum(not run.usable for run in study.runs)} of {len(study.runs)} runs. A step beyond the"
                      " stability limit may come to an end because T is short; such a run is never recommended."),
            plain_table(columns, rows)]
