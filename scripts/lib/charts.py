"""Draws a study of accuracy, and a run of Table 1, as charts: error against time and against the tolerance."""

import statistics

from matplotlib.lines import Line2D

from benchmark_json import FORMULATIONS
from chart_panels import FAMILIES, METHOD_KEYS, cross, draw_line, key, logarithmic, look, method_key, new_figure
from accuracy_lines import FLOOR_MARGIN

ERROR_LABEL = "relative error of W at T = {time:g}"
SECONDS_LABEL = "CPU seconds (median)"


def error_against_time(study):
    """Draws a panel for each n, with a line for each integrator."""
    columns = min(len(study.sizes()), 2)
    integrators = list(study.integrators.values())
    figure, panels = new_figure(f"Error at T = {study.time:g} against CPU time", -(-len(study.sizes()) // columns),
                                columns, 5, METHOD_KEYS, sharey=True)
    for axes, n in zip(panels.flat, study.sizes()):
        logarithmic(axes)
        axes.set(title=f"n = {n}", xlabel=SECONDS_LABEL, ylabel=ERROR_LABEL.format(time=study.time))
        floor = FLOOR_MARGIN * study.references[n].uncertainty
        axes.axhspan(floor / FLOOR_MARGIN, floor, color="0.93", zorder=0)
        for each in integrators:
            runs = study.above_floor(each.name, n)
            points = draw_line(axes, each.name, [(run.seconds, run.error) for run in runs], **look(each))
            if points and not study.line(each.name, n)[0].usable:
                cross(axes, points[0])
    for axes in panels.flat[len(study.sizes()):]:
        axes.remove()
    method_key(figure, integrators)
    return figure


def tolerance(study):
    """Draws errors at the largest n, and times at every n, against the tolerance; None without such runs."""
    runs = [run for run in study.tolerance_runs if run.usable]
    if not runs:
        return None
    sizes, stages = (sorted({getattr(run, name) for run in runs}) for name in ("n", "stages"))
    figure, panels = new_figure("What the tolerance of the fixed-point iteration buys", 3, len(stages), 3,
                                row_gap=0.3, sharex=True, sharey="row")
    for axes in panels.flat:
        logarithmic(axes)
    panels[0, 0].set(xlim=(2 * max(run.tolerance for run in runs), min(run.tolerance for run in runs) / 2),
                     ylabel=ERROR_LABEL.format(time=study.time) + f", n = {sizes[-1]}")
    panels[1, 0].set_ylabel(f"error of the spectrum, n = {sizes[-1]}")
    panels[2, 0].set_ylabel(SECONDS_LABEL)
    for (errors, spectra, times), s in zip(panels.T, stages):
        errors.set_title(f"s = {s}, order {2 * s}")
        times.set_xlabel("tolerance (tighter to the right)")
        times.margins(y=0.12)
        for axes in (errors, spectra):
            axes.axline((1e-4, 1e-4), (1e-8, 1e-8), color="0.45", linewidth=0.9, label="_diagonal")
        quantities = ((errors, "error", "-"), (errors, "solver_error", "--"), (spectra, "spectrum_error", "-"),
                      (times, "seconds", "-"))
        for name, n in dict.fromkeys((run.integrator, run.n) for run in runs if run.stages == s):
            line = sorted((run for run in runs if (run.integrator, run.n) == (name, n)), key=lambda run: run.tolerance)
            for axes, quantity, style in quantities if n == sizes[-1] else quantities[-1:]:
                draw_line(axes, f"{name}: {quantity}", [(run.tolerance, getattr(run, quantity)) for run in line],
                          **{**look(study.integrators[name]), "linestyle": style})
        for n in sizes:
            at = [run for run in runs if (run.n, run.stages) == (n, s)]
            if at:
                tightest = min(run.tolerance for run in at)
                times.annotate(f"n = {n}", (tightest, max(run.seconds for run in at if run.tolerance == tightest)),
                               xytext=(0, 9), textcoords="offset points", ha="right")
    key(figure, [*formulation_handles(), Line2D([], [], color="black", label="error"),
                 Line2D([], [], color="black", linestyle="--", label="solver error")])
    return figure


def table1_accuracy(run):
    """Draws each cell of a run of Table 1 as its time against its error; None where no cell has an error."""
    cells = {key: cell for key, cell in run.measurements.items()
             if cell.failure is None and cell.counters.get("relative_error", 0) > 0}
    if not cells:
        return None
    figure, ((axes,),) = new_figure("Table 1 with its accuracy: what the time of each cell buys", 1, 1, 6.5)
    logarithmic(axes)
    axes.set(xlabel=SECONDS_LABEL, ylabel=ERROR_LABEL.format(time=5))
    axes.margins(x=0.12)
    for formulation, n in sorted({(key.formulation, key.n) for key in cells}):
        line = [cells[key] for key in sorted(cells) if (key.formulation, key.n) == (formulation, n)]
        colour, size = FAMILIES[formulation]
        axes.plot([statistics.median(cell.times) for cell in line], [cell.counters["relative_error"] for cell in line],
                  marker="o", color=colour, markersize=size + 2, markerfacecolor="none", linewidth=0.9,
                  label=f"{formulation}, n = {n}")
        for cell in line:
            if len(cell.times) > 1:
                low, _, high = statistics.quantiles(cell.times, n=4, method="inclusive")
                axes.plot([low, high], [cell.counters["relative_error"]] * 2, color=colour, label="_quartiles")
    for n, s in sorted({(key.n, key.stages) for key in cells}):
        same = sorted((statistics.median(cell.times), cell.counters["relative_error"]) for key, cell in cells.items()
                      if (key.n, key.stages) == (n, s))
        axes.plot(*zip(*same), color="0.45", linestyle=":", zorder=1, label="_same answer")
        axes.annotate(f"n = {n}, s = {s}", same[-1], xytext=(10, 3), textcoords="offset points")
    key(figure, formulation_handles())
    return figure


def formulation_handles():
    return [Line2D([], [], color=FAMILIES[each][0], marker="o", markersize=FAMILIES[each][1], markerfacecolor="none",
                   label=each) for each in FORMULATIONS]
