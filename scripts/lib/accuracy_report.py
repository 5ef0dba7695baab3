"""What a study of accuracy against cost says, as a document: claims, tables, charts.

Every sentence is made from the raw file: its figures, and which way round it is put.
"""

import statistics

from benchmark_json import FORMULATIONS
from comparison import MISSING, three_digits
from document import Column, Entry, Figure, Heading, Item, Items, Paragraph, Table
from recommendation import recommendation, recommendation_tables
from work_precision import TABLE1_STEP

ORDER_MARGIN = 0.25
# The tolerance does no harm where what it adds is at most this share of the error that the step size makes.
HARMLESS = 0.1
PRICED_ERROR = 1e-6

CHARTS = (
    ("error_against_time", "Error at T against CPU time, one panel for each n; lines end at the floor of the reference."),
    ("error_against_products", "Error at T against matrix products: what remains when the machine is taken away."),
    ("spectrum_error_against_time", "Error of the spectrum against CPU time: who keeps what the flow keeps."),
    ("error_against_n", "Error at the step size of Table 1 against n."),
    ("tolerance", "Errors and time against the tolerance of the fixed point, at the step size of Table 1."),
    ("table1_accuracy", "Table 1 with its accuracy: every cell as time against error."),
)


def accuracy_sections(study, charts, level=2):
    """Returns the section; `charts` maps the names of the charts that exist to their paths."""
    return [
        Heading("Accuracy against cost", level),
        Paragraph(f"Every integrator over step sizes at n = {listed(study.sizes())}, T = {study.time:g}, error relative"
                  " in the Frobenius norm. " + references_sentence(study)),
        Heading("What the runs say", level + 1),
        Items([claim for claim in claims(study) if claim]),
        *[Figure(charts[name], caption) for name, caption in CHARTS if name in charts],
        *properties_section(study, level + 1),
        *fixed_step_section(study, level + 1),
        *tolerance_section(study, level + 1),
        Heading("The cheapest sufficient method", level + 1),
        *recommendation_tables(study, level=level + 2),
        *failures_section(study, level + 1),
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


# ---- claims


def claims(study):
    """Returns one claim a sentence; None where the file lacks what it rests on."""
    return [orders_claim(study), growth_claim(study), price_claim(study), exponential_claim(study),
            tolerance_claim(study), spectrum_claim(study)]


def observed_orders(study):
    """Returns (integrator, n, order) of every line that has one."""
    found = [(each, n, study.observed_order(each.name, n)) for each in study.integrators.values()
             for n in study.sizes()]
    return [(each, n, order) for each, n, order in found if order]


def orders_claim(study):
    lines = observed_orders(study)
    if not lines:
        return None
    within = [line for line in lines if abs(line[2] - line[0].order) <= ORDER_MARGIN]
    integrator, n, order = max(lines, key=lambda line: abs(line[2] - line[0].order))
    verdict = "Every line has its order" if len(within) == len(lines) else "Not every line has its order"
    return Item(verdict, f": {len(within)} of {len(lines)} fitted slopes are within {ORDER_MARGIN} of it; the farthest is"
                         f" {integrator.name} at n = {n} with {order:.2f} for {integrator.order}.")


def growth(study, name):
    """Returns the errors at Table 1's step size at the least and the greatest n, or None."""
    ends = [study.at_step(name, n, TABLE1_STEP) for n in (study.sizes()[0], study.sizes()[-1])]
    if len(study.sizes()) < 2 or not all(point and point.quality.usable for point in ends):
        return None
    return tuple(point.quality.error for point in ends)


def growth_claim(study):
    gauss = [next((f"{formulation}{s}" for formulation in ("group", "algebra", "cotangent")
                   if growth(study, f"{formulation}{s}")), None) for s in (1, 2, 3)]
    gauss = [name for name in gauss if name]
    if not gauss:
        return None
    names = [*gauss, *(name for name in ("rkmk4", "rk4") if growth(study, name))]
    factors = {name: growth(study, name)[1] / growth(study, name)[0] for name in names}
    least, most = study.sizes()[0], study.sizes()[-1]
    grows = min(factors[name] for name in gauss) > 2
    verdict = "One step size is not one accuracy" if grows else "The error hardly depends on n"
    figures = listed(f"{name} by {three_digits(factors[name])} ({scientific(growth(study, name)[0])} to"
                     f" {scientific(growth(study, name)[1])})" for name in names)
    return Item(verdict, f": from n = {least} to n = {most} the error at h = {TABLE1_STEP} changes for {figures}.")


def priced_size(study):
    """Returns the n at which prices are quoted: the largest where a method of each structure reaches the error."""
    sizes = [n for n in study.sizes() if all(recommendation(study, n, PRICED_ERROR, structure)
                                             for structure in ("poisson", "spectrum", "nothing"))]
    return sizes[-1] if sizes else None


def price_claim(study):
    n = priced_size(study)
    if n is None:
        return None
    poisson, spectrum, nothing = (recommendation(study, n, PRICED_ERROR, structure).winner
                                  for structure in ("poisson", "spectrum", "nothing"))
    costs_more = poisson.seconds > 1.05 * nothing.seconds
    verdict = "Structure has a price" if costs_more else "Structure is free"
    return Item(verdict, f": at n = {n} an error of {scientific(PRICED_ERROR)} takes {three_digits(poisson.seconds)} s"
                         f" with the Lie–Poisson structure kept ({described(poisson)}),"
                         f" {three_digits(spectrum.seconds)} s with the spectrum kept ({described(spectrum)}), and"
                         f" {three_digits(nothing.seconds)} s with nothing kept ({described(nothing)}).")


def described(candidate):
    return f"{candidate.integrator.name}, h = {three_digits(candidate.point.quality.step)}"


def cheapest(study, n, wanted):
    """Returns the fastest usable run at n that reaches the priced error, of the integrators that are wanted."""
    points = [point for point in study.points if point.quality.n == n and point.quality.usable
              and not point.beyond_limit and point.quality.error <= PRICED_ERROR
              and wanted(study.integrators[point.integrator])]
    return min(points, key=lambda point: point.costs.seconds, default=None)


def exponential_claim(study):
    """Compares the method with an exponential with the Gauss methods and compositions that the paper prefers."""
    n = priced_size(study)
    if n is None or "rkmk4" not in study.integrators:
        return None
    exponential = cheapest(study, n, lambda each: each.name == "rkmk4")
    implicit = cheapest(study, n, lambda each: each.lie_poisson)
    if not exponential or not implicit:
        return None
    ratio = implicit.costs.seconds / exponential.costs.seconds
    verdict = ("The exponential is not what makes a method slow" if ratio > 1.05
               else "The exponential makes the method slow" if ratio < 0.95
               else "The exponential costs about what it saves")
    per_step = [point.costs.products / point.quality.steps for point in (exponential, implicit)]
    return Item(verdict, f": summed as a series of commutators, RKMK4 takes {three_digits(per_step[0])} products a step"
                         f" and reaches {scientific(PRICED_ERROR)} at n = {n} in {three_digits(exponential.costs.seconds)}"
                         f" s; {implicit.integrator} takes {three_digits(per_step[1])} a step and"
                         f" {three_digits(implicit.costs.seconds)} s, {three_digits(ratio)} times as long. But RKMK4 is not"
                         " Lie–Poisson.")


def tolerance_claim(study):
    rows = [row for row in harmless_tolerances(study) if row.n == max(row.n for row in harmless_tolerances(study))]
    rows = [row for row in rows if row.formulation == "group"]
    if not rows:
        return None
    tightest = min(row.loosest.tolerance for row in rows)
    verdict = ("A tolerance of 1e-13 buys no accuracy at Table 1's step size" if tightest > 1e-12
               else "A tolerance near 1e-13 is needed at Table 1's step size")
    figures = listed(f"s = {row.stages}: {row.loosest.tolerance:.0e} suffices ({three_digits(row.time_ratio)} of the time)"
                     for row in rows)
    price = max(row.loosest.quality.spectrum_error for row in rows)
    return Item(verdict, f": for group at n = {rows[0].n}, {figures}; what it buys is the spectrum, which is then off by up"
                         f" to {scientific(price)}.")


def spectrum_claim(study):
    usable = [point for point in study.points if point.quality.usable]
    kept = [point for point in usable if study.integrators[point.integrator].isospectral]
    lost = [point for point in usable if not study.integrators[point.integrator].isospectral]
    if not kept or not lost:
        return None
    worst = max(kept, key=lambda point: point.quality.spectrum_error)
    verdict = ("Isospectral is to the solver's tolerance" if worst.quality.spectrum_error < 1e-10
               else "Not every isospectral method keeps the spectrum")
    return Item(verdict, f": over {len(kept)} runs of isospectral methods the largest error of an eigenvalue is"
                         f" {scientific(worst.quality.spectrum_error)} ({worst.integrator}, n = {worst.quality.n}); of the"
                         f" {len(lost)} runs of the others the median is"
                         f" {scientific(statistics.median(point.quality.spectrum_error for point in lost))}.")


# ---- tables


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
                      f" points above the floor; {MISSING} where fewer than three are."), table(columns, rows)]


def table(columns, rows):
    return Table(columns, [[[Entry(text) for text in row] for row in rows]])


def fixed_step_section(study, level):
    columns = (Column("integrator", align="left"), *(Column(f"n = {n}") for n in study.sizes()))
    rows = [[name, *(error_at(study.at_step(name, n, TABLE1_STEP)) for n in study.sizes())]
            for name in study.integrators]
    return [Heading(f"Error at h = {TABLE1_STEP}", level),
            Paragraph("The step size of Table 1. What a method did instead of converging is named."),
            table(columns, rows)]


def error_at(point):
    if point is None:
        return MISSING
    return scientific(point.quality.error) if point.quality.usable else point.quality.status


class HarmlessTolerance:
    """The loosest tolerance of one cell that hardly adds to its error, and what it saves."""

    def __init__(self, points):
        tightest = points[-1]
        self.n, self.formulation, self.stages = tightest.quality.n, tightest.formulation, tightest.stages
        self.error = tightest.quality.error
        good = len(points)
        while good > 0 and points[good - 1].solver_error <= HARMLESS * self.error:
            good -= 1
        self.loosest = points[min(good, len(points) - 1)]
        self.usual = min(points, key=lambda point: abs(point.tolerance - 1e-13))
        self.time_ratio = self.loosest.costs.seconds / self.usual.costs.seconds


def harmless_tolerances(study):
    """Returns a HarmlessTolerance for each cell, all tighter tolerances of which are harmless too."""
    cells = {}
    for point in study.tolerance_points:
        if point.quality.usable:
            cells.setdefault((point.quality.n, point.formulation, point.stages), []).append(point)
    return [HarmlessTolerance(sorted(points, key=lambda point: -point.tolerance))
            for _, points in sorted(cells.items(), key=lambda item: (item[0][0], FORMULATIONS.index(item[0][1]), item[0][2]))]


def tolerance_section(study, level):
    found = harmless_tolerances(study)
    if not found:
        return []
    columns = (Column("n"), Column("formulation", align="left"), Column("s"), Column("error at h = 0.1"),
               Column("loosest tolerance"), Column("sweeps against 1e-13"), Column("time against 1e-13"),
               Column("spectrum error there"))
    rows = [[str(row.n), row.formulation, str(row.stages), scientific(row.error), f"{row.loosest.tolerance:.0e}",
             f"{row.loosest.costs.sweeps}/{row.usual.costs.sweeps}", three_digits(row.time_ratio),
             scientific(row.loosest.quality.spectrum_error)] for row in found]
    failed = [point for point in study.tolerance_points if not point.quality.usable]
    text = ("The loosest tolerance of the fixed point that adds less than a tenth to the error which the step size makes,"
            " and so do all tighter ones.")
    if failed:
        text += (f" {len(failed)} of {len(study.tolerance_points)} runs did not converge, at tolerances of"
                 f" {max(point.tolerance for point in failed):.0e} or less.")
    return [Heading("Which tolerance an accuracy needs", level), Paragraph(text), table(columns, rows)]


def failures_section(study, level):
    """Lists every run that failed: a study that hides its failures recommends them."""
    rows = []
    for n in study.sizes():
        for name in study.integrators:
            failed = [point for point in study.line(name, n) if not point.quality.usable]
            if failed:
                rows.append([str(n), name, listed(f"{three_digits(point.quality.step)} {point.quality.status}"
                                                  for point in failed)])
    beyond = [point for point in study.points if point.beyond_limit and point.quality.usable]
    text = f"Of {len(study.points)} runs {sum(not point.quality.usable for point in study.points)} failed."
    if beyond:
        text += (f" {len(beyond)} more came to an end beyond their stability limit, because T is short"
                 f" ({listed(sorted({point.integrator for point in beyond}))}); they are recorded and never recommended.")
    parts = [Heading("Runs that failed", level), Paragraph(text)]
    if rows:
        columns = (Column("n"), Column("integrator", align="left"), Column("step sizes, and how", align="left"))
        parts.append(table(columns, rows))
    return parts
