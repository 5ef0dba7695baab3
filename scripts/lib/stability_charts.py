"""Draws where each integrator fails, and the errors of long runs.

In a map a cell is one trial, coloured by its outcome: the darker, the worse.
"""

import math

from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, NullLocator

from lib.chart_panels import METHOD_KEYS, cross, draw_line, handle, key, logarithmic, look, method_key, new_figure
from lib.stability_files import QUANTITIES, ROUNDING
from lib.formats import SWEEP_CAP, UNSTABLE

SWEEP_SHADES = {"≤ 20 sweeps": (20, "#f4f8fc"), "≤ 50 sweeps": (50, "#d3e4f3"), "more sweeps": (math.inf, "#a9cae6")}
FAILURES = {SWEEP_CAP: "#eda63a", "stagnated": "#cc6a36", "diverged": "#8f2f2f", UNSTABLE: "#33184a"}
LEVELS = {"measured critical": {"color": "black", "linewidth": 2.2},
          "linear theory": {"color": "black", "linewidth": 1.4, "linestyle": (0, (4, 2))}}
COLUMNS = 3
MARKERS = 7  # a line of a long run has a marker on every so many of its samples


def failure_map(study, scene, names, title):
    """Draws a panel for each integrator: its trials at each n, the measured critical value and linear theory."""
    figure, panels = new_figure(f"{title}: {scene} scene", -(-len(names) // COLUMNS), COLUMNS, 2.6, keys=2,
                                sharey=True)
    sizes = study.sizes(scene)
    for axes, name in zip(panels.flat, names):
        axes.set(title=name, xlabel="n")
        axes.grid(False)
        axes.set_yscale("log", base=2)
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.yaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_locator(FixedLocator(range(len(sizes))))
        axes.xaxis.set_major_formatter(lambda column, _: str(sizes[round(column)]))
        maps = study.line(scene, name)
        for column, trials in ((column, each.trials) for column, each in enumerate(maps) if each):
            values = [trial.h_norm_B for trial in trials]
            half = math.sqrt(values[1] / values[0]) if len(values) > 1 else 2**0.25
            axes.bar([column] * len(values), [value * half - value / half for value in values], width=1,
                     bottom=[value / half for value in values], color=list(map(shade, trials)), edgecolor="white",
                     linewidth=0.4)
        x = [edge for column in range(len(sizes)) for edge in (column - 0.5, column + 0.5)]
        for (label, style), values in zip(LEVELS.items(), ([each and each.edge.works for each in maps],
                                                           [each and each.edge.linear_limit for each in maps])):
            axes.plot(x, [value or math.nan for value in values for _ in range(2)], label=label, **style,
                      path_effects=[withStroke(linewidth=style["linewidth"] + 1.6, foreground="white")])
        axes.margins(0)
    for axes in panels.flat[len(names):]:
        axes.remove()
    for axes in panels[:, 0]:
        axes.set_ylabel("h‖B(W₀)‖₂")
    shades = {**{label: colour for label, (_, colour) in SWEEP_SHADES.items()}, **FAILURES}
    key(figure, [*(Patch(facecolor=colour, edgecolor="0.6", label=label) for label, colour in shades.items()),
                 *(handle(label, **style) for label, style in LEVELS.items())], 2)
    return figure


def shade(trial):
    """Returns the colour of a trial's cell."""
    if not trial.works:
        return FAILURES[trial.status]
    return next(colour for most, colour in SWEEP_SHADES.values() if trial.sweeps_per_step <= most)


def long_runs(study, scene, n, isospectral):
    """Draws a row for each quantity and a column for each share of the critical step; None if none of these was run.

    The integrators are those that keep the spectrum, or those that do not.
    """
    integrators = [each for name, each in study.integrators.items() if each.isospectral == isospectral
                   and any((scene, n, name, share) in study.runs for share in study.shares())]
    if not integrators:
        return None
    figure, panels = new_figure(
        f"Long runs at n = {n}, {scene} scene: integrators that {'keep' if isospectral else 'lose'} the spectrum",
        len(QUANTITIES), len(study.shares()), 2.8, METHOD_KEYS, row_gap=0.3, sharex="col", sharey="row")
    for row, (quantity, label) in zip(panels, QUANTITIES.items()):
        row[0].set_ylabel(label)
        for axes, share in zip(row, study.shares()):
            logarithmic(axes)
            axes.axhline(ROUNDING, color="0.45", linewidth=0.9, zorder=1, label="_rounding")
            for index, each in enumerate(integrators):
                run = study.runs.get((scene, n, each.name, share))
                points = draw_line(axes, each.name, run.series(quantity) if run else [], **look(each),
                                   markevery=(index % MARKERS, MARKERS))
                if points and not run.survived:
                    cross(axes, points[-1])
    for top, bottom, share in zip(panels[0], panels[-1], study.shares()):
        top.set_title(f"{share:g} of the critical step")
        bottom.set_xlabel("time")
    method_key(figure, integrators)
    return figure
