"""Charts of the study `limits`."""

import math

from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, NullLocator

from lib.records.formats import CONVERGED, FAST, NOT_FINITE, PUBLISHED, SWEEP_CAP, UNSTABLE_ENERGY, UNSTABLE_SPECTRUM
from lib.records.integrators import is_new
from lib.pages.chart_panels import draw_line, key, label_ends, label_sizes, logarithmic, look, new_figure, note
from lib.pages.numbers import three_digits

# At most seven a panel, and new integrators.
DRAWN = {PUBLISHED: ("group2", "algebra1", "algebra2", "elp4", "rkmk4", "rk4", "rk8"),
         FAST: ("group2", "group2_frame", "algebra1", "elp4_frame", "magnus5_frame", "rk4_frame", "rk8_frame")}
TITLES = {PUBLISHED: "published forms", FAST: "fast forms"}
WITH_THEORY = ("group2", "algebra1", "rk4")
THEORY = {"linewidth": 1.0, "linestyle": (0, (4, 3))}
TICKS = (0.5, 1, 2, 5, 10, 20)
SCENE = "smooth"
EXAMPLE = (PUBLISHED, SCENE, "algebra1")
COLOURS = {CONVERGED: "#dfeaf5", SWEEP_CAP: "#f0b95c", "stagnated": "#cc6a36", "diverged": "#8f2f2f",
           UNSTABLE_ENERGY: "#8fa3c8", UNSTABLE_SPECTRUM: "#55489a", NOT_FINITE: "#1d0f33"}


def critical_steps(limits):
    """Draws the critical h‖B(W₀)‖₂ from the smooth scene's own initial data against n. None without two n."""
    new = [name for name, each in limits.integrators.items() if is_new(each)]
    lines = {solver: {name: points for name in (*names, *new) if len(points := line_of(limits, solver, name)) > 1}
             for solver, names in DRAWN.items()}
    lines = {solver: found for solver, found in lines.items() if found}
    if not lines:
        return None
    labels = [name for found in lines.values() for name in found]
    figure, (panels,) = new_figure(message(limits), 1, len(lines), 5.2, keys=2, labels=labels, sharex=True, sharey=True)
    sizes = sorted({n for found in lines.values() for points in found.values() for n, _ in points})
    for axes, (solver, found) in zip(panels, lines.items()):
        logarithmic(axes)
        axes.set(title=TITLES[solver], xlabel="n")
        for name, points in found.items():
            style = dict(look(limits.integrators[name]),
                         linestyle=":" if limits.integrators[name].co_rotating else "-")
            draw_line(axes, name, points, **style)
            if solver == PUBLISHED and name in WITH_THEORY:
                draw_line(axes, "_theory", theory_of(limits, name), color=style["color"], **THEORY)
    panels[0].set_ylabel("critical h‖B(W₀)‖₂")
    label_sizes(panels, sizes)
    panels[0].set_yticks(TICKS, list(map(str, TICKS)))
    for axes, found in zip(panels, lines.values()):
        label_ends(axes, [((sizes[-1], points[-1][1]), name, look(limits.integrators[name])["color"])
                          for name, points in found.items()])
    note(figure, "Smooth scene, its own initial data. Dotted: in the co-rotating frame, where ‖B‖ is still that of the"
         " flow without it. Dashed: linear theory, with B frozen at W₀, of iterations and of RK4's step.")
    return figure


def line_of(limits, solver, name):
    points = [(n, limits.own(solver, SCENE, n, name)) for n in limits.sizes(solver)]
    return [(n, value) for n, value in points if value]


def theory_of(limits, name):
    return sorted((n, limit) for (scene, n, each), limit in limits.theory.items() if (scene, each) == (SCENE, name))


def message(limits):
    """Returns how far apart fast methods fail at the largest n where both of the title were tried."""
    def critical(n):
        return [limits.own(FAST, SCENE, n, name) for name in ("elp4_frame", "group2_frame")]

    n = max((n for n in limits.sizes(FAST) if all(critical(n))), default=None)
    if n is None:
        return "Critical step against n"
    longest, gauss = map(three_digits, critical(n))
    return f"At n = {n} fast elp4_frame works up to h‖B‖₂ = {longest}, fast group2_frame up to {gauss}"


def failure_map(limits):
    """Draws how trials of the EXAMPLE end on its grid: a column for each n. None where it was not tried."""
    solver, scene, name = EXAMPLE
    lines = {n: limits.lines[solver, scene, n, name] for n in limits.sizes(solver)
             if (solver, scene, n, name) in limits.lines}
    if not lines:
        return None
    title = f"How steps of {solver} {name} end, {scene} scene, and the longest that works"
    figure, ((axes,),) = new_figure(title, 1, 1, 4.2, keys=2)
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
