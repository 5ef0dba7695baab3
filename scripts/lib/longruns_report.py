"""The study of long runs as a document, and its figures."""

from lib.comparison import MISSING, percentage, three_digits
from lib.document import Column, Entry, Heading, Items, Paragraph, Table, conditions, shown
from lib.drift import (ALL_LOST, BLOCKS, BOUNDED, FAILED, GROWS, KEPT, LEAST_GROWTH, LOST, MOST_BOUNDED,
                       ROUNDING)
from lib.longruns_files import COARSE, COST_MARGIN, ENERGY, FINE, LEVELS, ONE_STEP, SPECTRUM
from lib.numbers import scientific
from lib.verdicts import UNDECIDED

CHARTS = (
    ("energy_against_spectrum", "Errors at the end of runs with one step size for all methods: energy error"
     " against spectrum error, a dot a method. Both panels have the same scales."),
    ("energy_against_time", "Largest energy error in each window of time, at the coarse equal cost."),
)
LEVEL_TITLES = {ONE_STEP: "one step size", COARSE: "coarse equal cost", FINE: "fine equal cost"}
FIRST_FINDINGS = (  # heading, method, quantity
    ("RKMK4, energy", "rkmk4", ENERGY), ("RK4, spectrum", "rk4", SPECTRUM),
    ("projected RK4, energy", "rk4_projected", ENERGY), ("group2, energy", "group2", ENERGY),
    ("elp6, energy", "elp6", ENERGY), ("elp6_tight, energy", "elp6_tight", ENERGY),
    ("elp6, spectrum", "elp6", SPECTRUM))
RULES = (
    (FAILED, ": the solver failed, or the energy went beyond all measure"),
    (ALL_LOST, f": an error of {LOST:g} or more, whatever its power"),
    (KEPT, f": always below {ROUNDING:g}"),
    (GROWS, f": the interval of the power lies above {LEAST_GROWTH:g}"),
    (BOUNDED, f": the interval reaches below that, and ends below {MOST_BOUNDED:g}"),
    (UNDECIDED, ": anything else"))


# ---- the document


def sections(runs, charts):
    """Returns the document; `charts` are the names of the charts beside it."""
    return [
        Heading("Long runs", 1),
        Paragraph("Energy, spectrum and Casimirs of long runs from the initial data of a scene. Every method has its"
                  " fast form and the co-rotating frame. Tolerance 1e-13 of Gauss methods, 1e-7 where the name ends in"
                  " _loose; 1e-8 of exponential and Magnus methods, 1e-10 where it ends in _tight. Each runs with"
                  " one step size that all share, and with steps at which all cost the same: a coarse and a fine equal"
                  " cost. A tolerance above rounding leaves an error of the structure in each step, and these add up:"
                  " growth at 1e-7, 1e-8 or 1e-10 need not be that of the method."),
        *shown(CHARTS, charts),
        Heading("First findings"),
        Paragraph("Errors at the end, with the power of time that they grow by. How powers are found, and what the"
                  " words mean, stands below."),
        findings_table(runs),
        Heading("How drift is judged"),
        Paragraph("The energy error is the largest in each window of time; the spectrum error is that at samples. A"
                  " power t^p is fitted to the last decade of time, by least squares of the logarithms. Its 95 %"
                  f" interval is that of the block jackknife: the fit is repeated without each of {BLOCKS} blocks of"
                  " neighbours, since neighbours are not independent. The words:"),
        Items(list(RULES)),
        *counts_section(runs),
        *[part for n, scene in runs.settings() for part in runs_section(runs, scene, n)],
        *costs_section(runs),
        conditions(runs.context),
    ]


def findings_table(runs):
    columns = (Column("n"), Column("scene", align="left"), Column("T"), Column("steps", align="left"),
               *(Column(heading) for heading, _, _ in FIRST_FINDINGS))
    blocks = []
    for n, scene in runs.settings():
        rows = []
        for level in LEVELS:
            found = runs.at(scene, n, level)
            cells = [finding(found.get(method), quantity) for _, method, quantity in FIRST_FINDINGS]
            rows.append([Entry(text) for text in (str(n), scene, f"{runs.plans[n].time:g}", LEVEL_TITLES[level],
                                                  *cells)])
        blocks.append(rows)
    return Table(columns, blocks)


def finding(run, quantity):
    """Writes the error of a run at its end, with its power where it grows and how it is judged where it does not."""
    if run is None or run.last(quantity) is None:
        return MISSING
    verdict, growth = run.judged(quantity)
    said = f"t^{two_places(growth.power)}" if verdict == GROWS else verdict
    return f"{scientific(run.last(quantity))} ({said})"


def counts_section(runs):
    """Returns a table of how many runs of each method were judged how."""
    counted = (KEPT, BOUNDED, UNDECIDED, GROWS, ALL_LOST, FAILED)
    columns = [Column("method", align="left"), Column("runs")]
    columns += [Column(verdict, quantity) for quantity in (ENERGY, SPECTRUM) for verdict in counted]
    rows = []
    for method in runs.methods():
        found = runs_of(runs, method)
        cells = [str(len(found))]
        for quantity in (ENERGY, SPECTRUM):
            verdicts = [run.judged(quantity).verdict for run in found]
            cells += [str(verdicts.count(verdict)) for verdict in counted]
        rows.append([Entry(text) for text in (method, *cells)])
    return [Heading("Runs by what became of energy and spectrum"), Table(tuple(columns), [rows])]


def runs_of(runs, method):
    return [run for (_, _, name, _), run in runs.runs.items() if name == method]


def runs_section(runs, scene, n):
    """Returns the table of all runs at one n in one scene, a block a level."""
    plan = runs.plans[n]
    columns = (Column("steps", align="left"), Column("method", align="left"), Column("h"),
               Column("at the end", "energy error"), Column("change", "energy"), Column("power", "energy error"),
               Column("drift", "energy error", "left"), Column("at the end", "spectrum error"),
               Column("power", "spectrum error"), Column("drift", "spectrum error", "left"), Column("Casimir error"))
    blocks = [[[Entry(text) for text in (LEVEL_TITLES[level], method, three_digits(run.run.step), *run_texts(run))]
               for method, run in runs.at(scene, n, level).items()] for level in LEVELS]
    return [
        Heading(f"n = {n}, {scene} scene, T = {plan.time:g}"),
        Paragraph(f"{plan.windows} windows. Change of energy: of the whole run, with its sign. Casimir error: relative,"
                  f" the largest of tr Wᵏ, k = 2 … 5, at the end. {MISSING}: the run failed before."),
        Table(columns, [block for block in blocks if block]),
    ]


def run_texts(run):
    """Returns what became of energy, spectrum and Casimirs of a run as texts."""
    change = run.run.energy_change
    casimir = run.run.casimir_errors[-1:]
    energy_drift, spectrum_drift = (drift_texts(run, quantity) for quantity in (ENERGY, SPECTRUM))
    return [error_text(run.last(ENERGY)), signed_text(change), *energy_drift,
            error_text(run.last(SPECTRUM)), *spectrum_drift, *(map(scientific, casimir) if casimir else [MISSING])]


def error_text(error):
    return MISSING if error is None else scientific(error)


def signed_text(change):
    if change is None:
        return MISSING
    return ("-" if change < 0 else "+") + scientific(abs(change))


def drift_texts(run, quantity):
    """Returns the power with its interval, and the verdict, of which a failed run gives its status."""
    verdict, growth = run.judged(quantity)
    power = "{} ({} to {})".format(*map(two_places, growth)) if growth else MISSING
    if verdict == FAILED:
        return [power, f"{run.run.status} at step {run.run.failed_step}"]
    return [power, verdict]


def two_places(value):
    """Writes a number with two places, without a sign before 0."""
    return f"{round(value, 2) + 0.0:.2f}"


def costs_section(runs):
    """Returns the table of costs, with what each is of the median at its level where costs are to be equal."""
    columns = [Column("steps", align="left"), Column("method", align="left")]
    columns += [Column(f"n = {n}, {scene}") for n, scene in runs.settings()]
    blocks = [[cost_row(runs, level, method) for method in runs.methods()] for level in LEVELS]
    return [
        Heading("Costs"),
        Paragraph("CPU milliseconds a unit of time, medians of repetitions in turns, on a stretch from the state at"
                  " t = 100 or after half the run. At equal cost: in percent of the median over the methods. Marked as"
                  f" unequal: off it by more than {percentage(COST_MARGIN)}; the errors of such a run are not at equal"
                  " cost."),
        Table(tuple(columns), blocks),
    ]


def cost_row(runs, level, method):
    found = [runs.runs.get((scene, n, method, level)) for n, scene in runs.settings()]
    return [Entry(text) for text in (LEVEL_TITLES[level], method, *(cost_text(runs, run) for run in found))]


def cost_text(runs, run):
    if run is None or run.run.seconds is None:
        return MISSING
    text, share = three_digits(1e3 * run.run.seconds), runs.cost_share(run)
    if share is None:
        return text
    return f"{text} ({100 * share:.0f} %{', unequal' if runs.is_unequal(run) else ''})"


# ---- figures


def figures(runs):
    """Returns the figures by key: of each run SCENE.nN.LEVEL.METHOD.QUANTITY, of costs, and counts of verdicts."""
    found = {}
    for (scene, n, method, level), run in runs.runs.items():
        key = f"{scene}.n{n}.{level.replace(' ', '_')}.{method}"
        found.update({f"{key}.{name}": value for name, value in figures_of(run).items() if value is not None})
    for quantity in (ENERGY, SPECTRUM):
        found.update(counts_of(runs, quantity))
    return {**found, **figures_of_costs(runs)}


def figures_of_costs(runs):
    """Returns how equal the equal costs are: how many runs are compared, how many of them are unequal, and by what."""
    shares = [share for run in runs.runs.values() if (share := runs.cost_share(run))]
    if not shares:
        return {}
    return {"equal_cost.runs": len(shares), "equal_cost.unequal": sum(map(runs.is_unequal, runs.runs.values())),
            "equal_cost.largest_deviation": max(abs(share - 1) for share in shares)}


def figures_of(run):
    """Returns the figures of a run by name; None where there is none."""
    found = {"energy_change": run.run.energy_change}
    for quantity in (ENERGY, SPECTRUM):
        growth = run.judged(quantity).growth
        found[f"{quantity}_error"] = run.last(quantity)
        found[f"{quantity}_power"] = growth and growth.power
    return found


def counts_of(runs, quantity):
    """Returns, by key, how many runs there are of each method and of Lie–Poisson methods, and how they were judged.

    Where an error grows is told by n too, since the times of runs differ.
    """
    groups = {method: runs_of(runs, method) for method in runs.methods()}
    groups["lie_poisson"] = [run for run in runs.runs.values() if runs.integrator_of(run).lie_poisson
                             and not run.run.is_variant]
    found = {}
    for name, members in groups.items():
        judged = [(run.run.n, run.judged(quantity).verdict) for run in members]
        verdicts = [verdict for _, verdict in judged]
        found[f"{quantity}.{name}.runs"] = len(members)
        found.update({f"{quantity}.{name}.{verdict}": verdicts.count(verdict)
                      for verdict in (KEPT, BOUNDED, UNDECIDED, GROWS, ALL_LOST, FAILED)})
        for n in runs.plans:
            found[f"{quantity}.{name}.n{n}.runs"] = sum(each == n for each, _ in judged)
            found[f"{quantity}.{name}.n{n}.{GROWS}"] = judged.count((n, GROWS))
    return found
