"""Charts of the study `limits`."""

import math

from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, NullLocator

from lib.chart_panels import draw_line, extended, key, label_ends, logarithmic, look, new_figure, note
from lib.charts import label_sizes
from lib.comparison import three_digits
from lib.formats import CONVERGED, FAST, LOSSES, PUBLISHED, SWEEP_CAP
from lib.integrator_names import in_frame

# At most seven a panel.
DRAWN = {PUBLISHED: ("group2", "algebra1", "algebra2", "elp4", "rkmk4", "magnus5", "rk4"),
         FAST: ("group2", "group2_frame", "algebra1", "elp4_frame", "rkmk4", "magnus5_frame", "rk4")}
TITLES = {PUBLISHED: "published forms", FAST: "fast forms"}
WITH_THEORY = ("group2", "algebra1", "rk4")
THEORY = {"linewidth": 1.0, "linestyle": (0, (4, 3))}
EXAMPLE = (PUBLISHED, "smooth", "algebra1")
COLOURS = {CONVERGED: "#d3e4f3", SWEEP_CAP: "#eda63a", "stagnated": "#cc6a36", "diverged": "#8f2f2f",
           **dict.fromkeys(LOSSES, "#33184a")}


def critical_steps(limits):
    """Draws the least critical h‖B(W₀)‖₂ over scenes and states against n. None without two n."""
    lines = {solver: {name: points for name in names if len(points := line_of(limits, solver, name)) > 1}
             for solver, names in DRAWN.items()}
    lines = {solver: found for solver, found in lines.items() if found}
    if not lines:
        return None
    labels = [name for found in lines.values() for name in found]
    figure, (panels,) = new_figure(title(limits), 1, len(lines), 5.2, keys=2, labels=labels, sharex=True, sharey=True)
    sizes = sorted({n for found in lines.values() for points in found.values() for n, _ in points})
    for axes, (solver, found) in zip(panels, lines.items()):
        logarithmic(axes)
        axes.set(title=TITLES[solver], xlabel="n")
        for name, points in found.items():
            style = dict(look(limits.integrators[name]), linestyle=":" if in_frame(name) else "-")
            draw_line(axes, name, points, **style)
            if solver == PUBLISHED and name in WITH_THEORY:
                draw_line(axes, "_theory", theory_of(limits, name), color=style["color"], **THEORY)
    panels[0].set_ylabel("critical h‖B(W₀)‖₂")
    label_sizes(panels, sizes)
    panels[0].yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    for axes, found in zip(panels, lines.values()):
        label_ends(axes, [(extended(points, sizes[-1]), name, look(limits.integrators[name])["color"])
                          for name, points in found.items()])
    note(figure, "The least over scenes and initial states that were tried at each n. Dotted: in the co-rotating frame,"
         " told by the norm of the flow without it. Dashed: linear theory, the smooth scene's B frozen at W₀, of"
         " iterations and of RK4's step.")
    return figure


def line_of(limits, solver, name):
    points = [(n, limits.critical(solver, n, name)) for n in limits.sizes(solver)]
    return [(n, value) for n, value in points if value]


def theory_of(limits, name):
    return sorted((n, limit) for (scene, n, each), limit in limits.theory.items() if (scene, each) == ("smooth", name))


def title(limits):
    """Returns how far apart methods fail at the largest n at which the fast forms of the first and last line were
    tried."""
    n = max((n for n in limits.sizes(FAST) if limits.critical(FAST, n, "elp4_frame")
             and limits.critical(FAST, n, "group2")), default=None)
    if n is None:
        return "Critical step against n"
    longest, gauss = (limits.critical(FAST, n, name) for name in ("elp4_frame", "group2"))
    return (f"At n = {n} fast elp4_frame works up to h‖B‖₂ = {three_digits(longest)}, fast group2 up to"
            f" {three_digits(gauss)}")


def failure_map(limits):
    """Draws how trials of the EXAMPLE end on its grid: a column for each n. None where it was not tried."""
    solver, scene, name = EXAMPLE
    lines = {n: limits.lines[solver, scene, n, name] for n in limits.sizes(solver)
             if (solver, scene, n, name) in limits.lines}
    if not lines:
        return None
    figure, ((axes,),) = new_figure(f"How steps of {solver} {name} end, {scene} scene", 1, 1, 4.2, keys=2)
    axes.grid(False)
    axes.set(xlabel="n", ylabel="h‖B(W₀)‖₂")
    axes.set_yscale("log", base=2)
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_locator(FixedLocator(range(len(lines))))
    axes.set_xticklabels([str(n) for n in lines])
    half = math.sqrt(limits.settings.grid_step)
    seen = set()
    for column, line in enumerate(lines.values()):
        own = line.limits[0]
        for value, outcome in own.trials(limits.settings.grid_step):
            axes.bar(column, value * half - value / half, width=0.9, bottom=value / half, color=COLOURS[outcome],
                     edgecolor="white", linewidth=0.6)
            seen.add(outcome)
        if own.works:
            axes.plot([column - 0.45, column + 0.45], [own.works] * 2, color="black", linewidth=2)
    key(figure, [Patch(facecolor=colour, label=outcome) for outcome, colour in COLOURS.items() if outcome in seen])
    return figure
