"""Draws where each method fails, and the errors of long runs: failure maps and errors against time.

Each chart is a figure made from its data alone. In a map a cell is one trial, coloured and hatched by what became of
it; in a chart of long runs a line is one integrator and carries its name.
"""

import math

import matplotlib
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import FixedLocator, NullLocator

from benchmark_json import FORMULATIONS
from chart_panels import (LOOKS, Label, colour, column_of_labels, cross_mark, draw_line, floor_band, hide_rest,
                          key_of, logarithmic, look, new_figure, set_panel, style_key, styled)
from integrator_names import TABLE1_CELLS, others
from stability_files import QUANTITIES, ROUNDING, trials_in_words
from study_file import SWEEP_CAP, UNSTABLE

CELLS = -2  # of the drawing order; what lies below 0 an SVG holds as one image
GENERATOR_LABEL = "h‖B(W₀)‖₂"
MEASURED, THEORY = "measured critical", "linear theory"

# ---- failure maps

# A shade for each number of sweeps a step, the more the darker.
SWEEP_SHADES = ((20, "#f1f6fb"), (50, "#d3e4f3"), (math.inf, "#a9cae6"))
# Colour and hatching of what failed, apart in grey too.
FAILURES = {
    "diverged": ("#e0724a", "////", "0.25"),
    "stagnated": ("#f2c063", "\\\\\\\\", "0.25"),
    SWEEP_CAP: ("#f9e79a", "....", "0.25"),
    UNSTABLE: ("#7c4596", "xxxx", "0.9"),
}


@styled
def failure_map(study, scene):
    return map_of(study, scene, TABLE1_CELLS, f"Where the formulations fail: {scene} scene")


@styled
def failure_map_fast(study, scene):
    return map_of(study, scene, TABLE1_CELLS, f"Where the fast forms fail: {scene} scene")


@styled
def failure_map_others(study, scene):
    return map_of(study, scene, others(study.integrators), f"Where the other integrators fail: {scene} scene")


def map_of(study, scene, names, title):
    columns = len(FORMULATIONS)
    rows = math.ceil(len(names) / columns)
    figure, panels = new_figure(title, map_caption(study, scene), rows, columns, 3.0, right=1.3, row_gap=0.75,
                                column_gap=1.65)
    map_key(figure, study, scene)
    for axes, name in zip(panels.flat, names):
        if study.line(scene, name):
            map_panel(axes, study, scene, name)
        else:
            axes.set_visible(False)
    for axes in panels[:, 1:].flat:
        axes.set_ylabel("")
    hide_rest(panels, len(names))
    return figure


def map_caption(study, scene):
    return (f"Each cell is one trial from the initial data: {trials_in_words(study, [scene])}; at most {study.max_sweeps}"
            " sweeps a step. Invariants lost: every iteration converged, but what the flow"
            " conserves did not stay. Measured critical: the largest step that works below the first that fails, by"
            " bisection. Linear theory: where the iteration (of explicit methods the step) ceases to be stable with B frozen"
            " at B(W₀); none is drawn where it names no limit. The values beside a panel are those at its largest n.")


def map_key(figure, study, scene):
    """Says under the title what shades, hatchings and lines mean, of those that occur in this scene."""
    found = {trial.status for each in study.maps.values() if each.edge.scene == scene for trial in each.trials}
    handles = [Patch(facecolor=shade, edgecolor="0.6", linewidth=0.5,
                     label="more" if math.isinf(most) else f"≤ {most} sweeps") for most, shade in SWEEP_SHADES]
    handles += [Patch(facecolor=shade, edgecolor=ink, hatch=hatch, linewidth=0,
                      label="invariants lost" if status == UNSTABLE else status)
                for status, (shade, hatch, ink) in FAILURES.items() if status in found]
    handles += [matplotlib.lines.Line2D([], [], color="black", linewidth=2.2, label=MEASURED),
                matplotlib.lines.Line2D([], [], color="black", linewidth=1.4, linestyle=(0, (4, 2)), label=THEORY)]
    for patch in key_of(figure, handles, handlelength=2.4, columnspacing=1.5).get_patches():
        patch.set_rasterized(True)  # a hatching in an SVG is thousands of curves


def map_panel(axes, study, scene, name):
    maps = study.line(scene, name)
    axes.set_yscale("log")
    axes.grid(False)
    axes.tick_params(length=2)
    axes.set_rasterization_zorder(0)
    edges = [edge for each in maps for bottom, top in cell_edges(each) for edge in (bottom, top)]
    axes.set_ylim(min(edges), max(edges))
    axes.set_xlim(-0.5, len(maps) - 0.5)
    critical = [each.edge.works or math.nan for each in maps]
    limits = [each.edge.linear_limit or math.nan for each in maps]
    for column, each in enumerate(maps):
        for trial, (bottom, top) in zip(each.trials, cell_edges(each)):
            cell(axes, column, trial, bottom, top)
    set_panel(axes, name, "n", GENERATOR_LABEL)
    axes.xaxis.set_major_locator(FixedLocator(range(len(maps))))
    axes.xaxis.set_major_formatter(lambda column, _: str(maps[round(column)].edge.n))
    axes.yaxis.set_major_locator(FixedLocator([2.0**power for power in range(-20, 21)]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    labels = [*level_line(axes, critical, MEASURED, "-", 2.2), *level_line(axes, limits, THEORY, (0, (4, 2)), 1.4)]
    column_of_labels(axes, labels)


def cell_edges(each):
    """Returns (bottom, top) of the cell of each trial: half way to its neighbours on the logarithmic axis, but up to the
    critical value where that lies between what works and what fails."""
    values = [trial.h_norm_B for trial in each.trials]
    critical = each.edge.works or 0.0
    inner = [critical if first.works and not second.works and first.h_norm_B <= critical <= second.h_norm_B
             else math.sqrt(first.h_norm_B * second.h_norm_B) for first, second in zip(each.trials, each.trials[1:])]
    half = 2**0.25 if len(values) == 1 else math.sqrt(values[1] / values[0])
    edges = [values[0] / half, *inner, values[-1] * half]
    return list(zip(edges, edges[1:]))


def cell(axes, column, trial, bottom, top):
    if trial.works:
        shade, hatch, ink = sweep_shade(trial), "", "white"
    else:
        shade, hatch, ink = FAILURES[trial.status]
    axes.add_patch(Rectangle((column - 0.5, bottom), 1, top - bottom, facecolor=shade, edgecolor=ink, hatch=hatch,
                             linewidth=0.4 if trial.works else 0, zorder=CELLS))


def sweep_shade(trial):
    return next(shade for most, shade in SWEEP_SHADES if trial.sweeps_per_step <= most)


def level_line(axes, values, name, style, width):
    """Draws a level across each column that has one, on white so that it stands off the cells; returns its label."""
    x = [edge for column in range(len(values)) for edge in (column - 0.5, column + 0.5)]
    y = [value for value in values for _ in range(2)]
    axes.plot(x, y, color="white", linewidth=width + 1.4, zorder=4, label="_ground", solid_capstyle="butt")
    axes.plot(x, y, color="black", linestyle=style, linewidth=width, zorder=5, label=name, solid_capstyle="butt")
    known = [index for index, value in enumerate(values) if not math.isnan(value)]
    low, high = axes.get_ylim()
    if not known or not low <= values[known[-1]] <= high:
        return []
    return [Label(f"{name.split()[0]} {values[known[-1]]:.3g}", (known[-1] + 0.5, values[known[-1]]), "black")]


# ---- long runs

MARKERS = 7  # a line has one on every so many of its samples


@styled
def long_runs(study, scene, n):
    """Draws the integrators that keep the spectrum; None if none was run."""
    return errors_against_time(study, scene, n, "that keep the spectrum", lambda each: each.isospectral)


@styled
def long_runs_controls(study, scene, n):
    """Draws the integrators that do not keep the spectrum; None if none was run."""
    return errors_against_time(study, scene, n, "that lose the spectrum", lambda each: not each.isospectral)


def errors_against_time(study, scene, n, which, wanted):
    names = [name for name, each in study.integrators.items() if wanted(each)
             and any(study.at(scene, n, share, name) for share in study.shares())]
    if not names:
        return None
    shares = study.shares()
    panel_height = max(2.75, 0.25 * len(names))  # so that the labels of all lines have room beside it
    figure, panels = new_figure(
        f"Long runs at n = {n}, {scene} scene: integrators {which}",
        f"Every run is of {study.steps} steps of one size, the share of the integrator's own critical step that stands over"
        " the column, so that times differ. × k: the run failed at step k; a cross marks its last state. The energy error is"
        " the largest since the sample before. What is exactly 0 has no place on the axis.",
        len(QUANTITIES), len(shares), panel_height, right=1.9, row_gap=0.75, column_gap=2.35,
        sharex="col")
    style_key(figure, [each for each in LOOKS if any(look(study.integrators[name]) == each for name in names)])
    for index, (row, quantity) in enumerate(zip(panels, QUANTITIES)):
        labels = []
        for axes, share in zip(row, shares):
            runs = {name: study.at(scene, n, share, name) for name in names if study.at(scene, n, share, name)}
            labels.append(time_panel(axes, study, quantity, runs))
            title = f"{quantity.name}, {share:g} of the critical step" if index == 0 else quantity.name
            set_panel(axes, title, "time" if index == len(QUANTITIES) - 1 else "",
                      quantity.label if share == shares[0] else "")
        label_row(row, labels)
    return figure


def time_panel(axes, study, quantity, runs):
    """Draws a quantity of some runs and returns the labels of the lines, which need the limits of the whole row."""
    logarithmic(axes)
    axes.xaxis.set_minor_locator(NullLocator())  # over five decades
    axes.tick_params(labelbottom=True)  # also where the panels below have the same times
    labels = []
    for index, (name, run) in enumerate(runs.items()):
        points = drawable(quantity.series(run))
        if not points:
            continue
        draw_line(axes, name, points, study.integrators[name], linewidth=1.1, markersize=3.2,
                  markevery=(index % MARKERS, MARKERS))
        if not run.survived:
            cross_mark(axes, points[-1])
        labels.append(Label(name + failure(run), points[-1], colour(name)))
    return labels


def drawable(series):
    return [(time, value) for time, value in series if time > 0 and value > 0]


def failure(run):
    return "" if run.survived else f" × {run.row.failed_step or run.row.status}"


LEAST_DRAWN, LARGEST_DRAWN = 1e-18, 1e8


def label_row(row, labels):
    """Gives the panels of a row the same limits, and their lines their names: the labels of each panel."""
    drawn = [axes.dataLim for axes in row if axes.lines]
    if not drawn:
        return
    low = max(min(each.minposy for each in drawn) / 3, LEAST_DRAWN)
    high = min(max(max(each.y1 for each in drawn) * 3, 10 * ROUNDING), LARGEST_DRAWN)
    for axes, names in zip(row, labels):
        axes.set_ylim(low, high)
        if low < ROUNDING:
            floor_band(axes, ROUNDING, "rounding", at=(0, ROUNDING), offset=(6, -11),
                       coordinates=("axes fraction", "data"))
        column_of_labels(axes, names)
