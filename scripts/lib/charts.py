"""Draws a Study, and a run of Table 1, as charts: error against time and against the tolerance.

Each chart is a figure made from its data alone. A line stands for one integrator and carries its name.
"""

import math
import statistics

import matplotlib
from matplotlib.ticker import LogLocator, NullLocator

from benchmark_json import FORMULATIONS
from chart_panels import (GREY, LOOKS, OTHER_COLOUR, SMALL, cross_mark, draw_line, floor_band, hide_rest, key_of,
                          logarithmic, method_key, new_figure, panel_grid, set_panel, style_key, styled)
from integrator_names import relatives
from accuracy_lines import FLOOR_MARGIN, TABLE1_STEP

FORMULATION_COLOURS = {"cotangent": "#e08214", "group": "#1f67ad", "algebra": "#4a0a5e"}
FORMULATION_MARKERS = {"cotangent": "s", "group": "o", "algebra": "^"}
FORMULATION_SIZES = {"cotangent": 7.5, "group": 5, "algebra": 3.6}  # so that none hides another with the same answer
ERROR_LABEL = "relative error of W at T = {time:g}"
SECONDS_LABEL = "CPU seconds (median)"


# ---- error against time


@styled
def error_against_time(study):
    rows, columns = panel_grid(len(study.sizes()))
    figure, panels = new_figure(
        f"Error at T = {study.time:g} against CPU time",
        f"Each point is one run to T = {study.time:g} with one step size. The formulations of the Gauss method with the"
        " same number of stages (cotangent, group, algebra) have the same error: the one that takes least stands with"
        " points, the others as thin lines of its colour. Lines end where the reference can no longer tell"
        " their error, where it stops falling, or where runs would take too long; they bend back where long steps need"
        " more sweeps. A cross marks the longest step that works where longer ones were tried and failed.",
        rows, columns, 4.9, keys=3)
    style_key(figure, LOOKS)
    method_key(figure, study.integrators)
    for axes, n in zip(panels.flat, study.sizes()):
        error_panel(axes, study, n)
    hide_rest(panels, len(study.sizes()))
    return figure


def error_panel(axes, study, n):
    logarithmic(axes)
    drawn = []
    for group in relatives(study.integrators):
        leader = cheapest(study, group, n)
        for name in group:
            points = [(run.seconds, run.error) for run in study.above_floor(name, n)]
            if points:
                draw_line(axes, name, points, study.integrators[name], name == leader)
                drawn.append((name, points, name == leader))
    set_panel(axes, f"n = {n}", SECONDS_LABEL, ERROR_LABEL.format(time=study.time))
    seconds = [point[0] for _, points, _ in drawn for point in points]
    if seconds:
        axes.set_xlim(min(seconds) / 1.6, max(seconds) * 1.6)
    mark_floor(axes, study, n)
    for name, points, leading in drawn:
        if leading and failed_before(study, name, n):
            cross_mark(axes, points[0])


def mark_floor(axes, study, n):
    floor = FLOOR_MARGIN * study.references[n].uncertainty
    floors = [FLOOR_MARGIN * each.uncertainty for each in study.references.values()]
    errors = [run.error for run in study.runs if run.usable]
    axes.set_ylim(min(floors) / 20, max([*floors, *errors]) * 3)
    floor_band(axes, floor, f"floor: {FLOOR_MARGIN} × the uncertainty of the reference solution,"
                            f" {study.references[n].uncertainty:.1e}")


def cheapest(study, group, n):
    """Returns the member of a group that takes least, in the geometric mean over the steps all of them did."""
    lines = {name: {run.steps: run.seconds for run in study.above_floor(name, n)} for name in group}
    lines = {name: line for name, line in lines.items() if line}
    common = set.intersection(*map(set, lines.values())) if lines else set()
    if not common:
        return next(iter(lines), None)
    return min(lines, key=lambda name: sum(math.log(lines[name][steps]) for steps in common))


def failed_before(study, name, n):
    line = study.line(name, n)
    return bool(line) and not line[0].usable


# ---- tolerance


@styled
def tolerance(study):
    sizes = sorted({run.n for run in study.tolerance_runs})
    stages = sorted({run.stages for run in study.tolerance_runs})
    largest = sizes[-1] if sizes else 0
    figure, panels = new_figure(
        "What the tolerance of the fixed-point iteration buys",
        f"The run of Table 1 (h = {TABLE1_STEP:g}, T = {study.time:g}) solved to different tolerances. Upper and middle"
        f" rows at n = {largest}, the largest n of this study; times at every n. Solver error (dashed):"
        " distance from the answer with the tightest tolerance that converged, at which it is 0 and not drawn. The"
        " diagonal is where an error equals the tolerance. Runs that failed are not drawn.",
        3, max(len(stages), 1), 3.0, row_gap=0.42, sharex=True)
    formulation_key(figure, matplotlib.lines.Line2D([], [], color="black", label="error"),
                    matplotlib.lines.Line2D([], [], color="black", linestyle="--", label="solver error"))
    if not stages:
        for axes in panels.flat:
            axes.set_visible(False)
        return figure
    for column, s in zip(panels.T, stages):
        chosen = [run for run in study.tolerance_runs if run.stages == s and run.usable]
        at_largest = [run for run in chosen if run.n == largest]
        errors, spectra, times = column
        tolerance_lines(errors, at_largest, lambda run: run.error, "error")
        tolerance_lines(errors, at_largest, lambda run: run.solver_error, "solver error", "--")
        tolerance_lines(spectra, at_largest, lambda run: run.spectrum_error, "spectrum error")
        for n in sizes:
            tolerance_lines(times, [run for run in chosen if run.n == n],
                            lambda run: run.seconds, f"n = {n}", sizes=dict.fromkeys(FORMULATIONS, 3.8))
        set_panel(errors, f"s = {s}, order {2 * s}", "", ERROR_LABEL.format(time=study.time))
        set_panel(spectra, "", "", "error of the spectrum")
        set_panel(times, "", "tolerance (tighter to the right)", SECONDS_LABEL)
    errors, spectra, times = panels
    for row in panels:
        share_limits(row)
    tolerances = [run.tolerance for run in study.tolerance_runs]
    errors[0].set_xlim(max(tolerances) * 2, min(tolerances) / 2)
    for axes in (*errors, *spectra):
        axes.plot(axes.get_xlim(), axes.get_xlim(), color=GREY, linewidth=0.9, scalex=False, scaley=False, zorder=1,
                  label="_diagonal")
    for axes in times:
        name_families(axes, [f"n = {n}" for n in sizes])
    return figure


def tolerance_lines(axes, runs, value, what, line="-", sizes=FORMULATION_SIZES):
    """Draws a quantity of each formulation against the tolerance; what has the value 0 has no place on the axis."""
    logarithmic(axes)
    axes.xaxis.set_major_locator(LogLocator(numticks=7))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.tick_params(labelbottom=True)
    for formulation in FORMULATIONS:
        line_points = [(run.tolerance, value(run)) for run in runs
                       if run.formulation == formulation and value(run) > 0]
        if line_points:
            axes.plot(*zip(*line_points), color=FORMULATION_COLOURS[formulation], linestyle=line, linewidth=1.3,
                      marker=FORMULATION_MARKERS[formulation], markerfacecolor="white",
                      markersize=sizes[formulation], label=f"{formulation}: {what}", zorder=3)


def name_families(axes, families):
    """Names the lines of each quantity over the last point of the topmost of them."""
    for what in families:
        lines = [line for line in axes.lines if line.get_label().endswith(f": {what}")]
        if lines:
            top = max(lines, key=lambda line: statistics.fmean(map(math.log, line.get_ydata())))
            axes.annotate(what, top.get_xydata()[-1], xytext=(0, 7), textcoords="offset points", ha="right",
                          fontsize=SMALL + 1)


def share_limits(row):
    """Gives the panels of a row the same vertical limits."""
    drawn = [axes.dataLim for axes in row if axes.lines]
    if drawn:
        low, high = min(each.minposy for each in drawn), max(each.y1 for each in drawn)
        for axes in row:
            axes.set_ylim(low / 2, high * 2.5)


def formulation_key(figure, *further):
    handles = [matplotlib.lines.Line2D([], [], color=FORMULATION_COLOURS[each], marker=FORMULATION_MARKERS[each],
                                       markerfacecolor="white", label=each) for each in FORMULATIONS]
    key_of(figure, [*handles, *further])


# ---- Table 1 with its accuracy


@styled
def table1_accuracy(run):
    """Returns the chart of a run of Table 1, or None where no cell says how large its error is."""
    cells = {key: cell for key, cell in run.measurements.items()
             if cell.failure is None and "relative_error" in cell.counters and cell.counters["relative_error"] > 0}
    if not cells:
        return None
    failed = sorted(key for key, cell in run.measurements.items() if cell.failure is not None)
    figure, panels = new_figure(
        "Table 1 with its accuracy: what the time of each cell buys",
        "The run of Table 1 (T = 5, h = 0.1). Each point is one cell: a formulation of the Gauss method with s stages"
        " at one n. Thin lines join the stages of one formulation at one n, dotted lines the formulations at one n and"
        " s: they have the same error. Bars, where longer than the markers, span the quartiles of the repetitions. "
        + uncertainty_in_words(cells) + failures_in_words(failed),
        1, 1, 6.8)
    formulation_key(figure)
    axes = panels[0, 0]
    logarithmic(axes)
    for formulation, n in sorted({(key.formulation, key.n) for key in cells}):
        table_line(axes, formulation, n, sorted((key.stages, cell) for key, cell in cells.items()
                                                if (key.formulation, key.n) == (formulation, n)))
    set_panel(axes, "", SECONDS_LABEL, ERROR_LABEL.format(time=5))
    times = [statistics.median(cell.times) for cell in cells.values()]
    errors = [cell.counters["relative_error"] for cell in cells.values()]
    axes.set_xlim(min(times) / 2, max(times) * 2.6)
    axes.set_ylim(min(errors) / 8, max(errors) * 8)
    clusters = sorted({(key.n, key.stages) for key in cells})
    for cluster in clusters:
        here = sorted((statistics.median(cell.times), cell.counters["relative_error"])
                      for key, cell in cells.items() if (key.n, key.stages) == cluster)
        axes.plot(*zip(*here), color=GREY, linewidth=1, linestyle=":", zorder=2, label="_same n and s")
    for n, s in clusters:
        name_cluster(axes, cells, n, s)
    return figure


def failures_in_words(failed):
    names = [f"{key.formulation} at n = {key.n}, s = {key.stages}" for key in failed]
    return f"Failed: {'; '.join(names)}." if names else "No cell failed."


def uncertainty_in_words(cells):
    known = [cell.counters["reference_uncertainty"] for cell in cells.values()
             if "reference_uncertainty" in cell.counters]
    return f"The reference solutions are uncertain by {max(known):.1e} at most. " if known else ""


def table_line(axes, formulation, n, stages_and_cells):
    times = [statistics.median(cell.times) for _, cell in stages_and_cells]
    errors = [cell.counters["relative_error"] for _, cell in stages_and_cells]
    shade = FORMULATION_COLOURS.get(formulation, OTHER_COLOUR)
    axes.plot(times, errors, color=shade, linewidth=0.7, marker=FORMULATION_MARKERS.get(formulation, "D"),
              markersize=7, markerfacecolor="white", markeredgewidth=1.5, label=f"{formulation}, n = {n}", zorder=4)
    for (_, cell), error in zip(stages_and_cells, errors):
        if len(cell.times) > 1:
            low, _, high = statistics.quantiles(cell.times, n=4, method="inclusive")
            axes.plot([low, high], [error, error], color=shade, linewidth=1.2, zorder=3, label="_quartiles")


def name_cluster(axes, cells, n, stages):
    """Names the formulations at one n and s beside the slowest of them."""
    here = [cell for key, cell in cells.items() if (key.n, key.stages) == (n, stages)]
    slowest = max(here, key=lambda cell: statistics.median(cell.times))
    axes.annotate(f"n = {n}, s = {stages}", (statistics.median(slowest.times), slowest.counters["relative_error"]),
                  xytext=(9, 3), textcoords="offset points", fontsize=SMALL + 1)
