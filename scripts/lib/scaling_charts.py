"""Draws what a step of the fast forms costs: against n with its floor, and idea by idea."""

import matplotlib
from matplotlib.ticker import FixedLocator, NullLocator

from benchmark_json import FORMULATIONS
from chart_panels import GREY, SMALL, hide_rest, key_of, logarithmic, new_figure, set_panel, styled
from charts import FORMULATION_COLOURS, FORMULATION_MARKERS
from scaling import ladder

STEP_LABEL = "CPU seconds per step (median)"
# Names of rungs that are too long for a chart, and the rungs' shades, the later the darker.
SHORT = {"structure and planar products": "structure, planar products", "corrections in single precision": "corrections",
         "structure and split products": "structure, split products", "Newton in single precision": "Newton"}
RUNG_SHADES = ("#c9c9c9", "#c3daee", "#8fc1e3", "#4f9bd0", "#1f67ad", "#062a56")


@styled
def cost_against_n(study):
    """What a step costs, and the least that its products could, one panel for each number of stages."""
    stages = study.stage_counts()
    figure, panels = new_figure(
        "A step of the fast forms against n",
        f"Steps such that h‖B(W₀)‖₂ = {study.h_norm_B:g} at every n, once start values have all their past steps. Solid:"
        " what a step takes; dashed: its floor, the operations of the products that it forms at the measured peak of the core.",
        1, len(stages), 4.9)
    key_of(figure, [line_of(each) for each in FORMULATIONS] + [
        matplotlib.lines.Line2D([], [], color=GREY, linestyle="--", label="floor")])
    for axes, s in zip(panels.flat, stages):
        against_n(axes, study)
        for formulation in FORMULATIONS:
            points = study.line(formulation, s)
            draw(axes, formulation, points, lambda point: point.seconds, "-", "measured")
            draw(axes, formulation, points, lambda point: point.floor, "--", "floor", marker="None")
        set_panel(axes, f"s = {s}", "n", STEP_LABEL if s == stages[0] else "")
    return figure


def line_of(formulation):
    return matplotlib.lines.Line2D([], [], color=FORMULATION_COLOURS[formulation],
                                   marker=FORMULATION_MARKERS[formulation], markerfacecolor="white", label=formulation)


def against_n(axes, study):
    logarithmic(axes)
    axes.xaxis.set_major_locator(FixedLocator(study.sizes()))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(lambda n, _: f"{n:g}")


def draw(axes, formulation, points, value, style, what, marker=None):
    """Draws one line; what has the value 0 has no place on the axis."""
    places = [(point.n, value(point)) for point in points if value(point) > 0]
    if places:
        axes.plot(*zip(*places), color=FORMULATION_COLOURS[formulation], linestyle=style,
                  marker=marker or FORMULATION_MARKERS[formulation], markerfacecolor="white", markersize=4.2,
                  linewidth=1.2 if style == "-" else 0.9, label=f"{formulation}: {what}")


@styled
def ladder_of_ideas(study):
    """What each idea bought, from the published form to the fast one: the time of a step as bars."""
    sizes, stages = study.idea_sizes(), study.stage_counts()
    figure, panels = new_figure(
        "From Table 1 to Table 2, idea by idea",
        "Time of a step over that of the published form, after the first steps, all timed in turns at h = 0.1; each bar has"
        " one idea more than the one above, and says how many times as fast as the published form it is. Structure: fewer"
        " products, triangles where the result is skew-Hermitian; planar products: this project's kernels; corrections: in"
        " single precision; bands: what lies far off the diagonal left out.",
        len(sizes), len(stages), 3.4, right=0.2, column_gap=0.9)
    for row, n in zip(panels, sizes):
        for axes, s in zip(row, stages):
            bars(axes, study, n, s)
            set_panel(axes, f"n = {n}, s = {s}", "share of the published form's time", "")
    for axes in panels.flat:
        axes.grid(axis="y", visible=False)
    hide_rest(panels, len(sizes) * len(stages))
    return figure


def bars(axes, study, n, s):
    heights, names = [], []
    for formulation in FORMULATIONS:
        cell = study.ideas.get((formulation, n, s))
        if not cell:
            continue
        rungs = ladder(cell)
        whole = rungs[0][1].seconds
        for index, (idea, cost) in enumerate(rungs):
            shade = RUNG_SHADES[min(index, len(RUNG_SHADES) - 1)]
            place = len(heights)
            axes.barh(place, cost.seconds / whole, color=shade, height=0.8)
            axes.annotate(idea if index == 0 else f"{whole / cost.seconds:.2f} × {SHORT.get(idea, idea)}",
                          (cost.seconds / whole, place), xytext=(4, 0), textcoords="offset points", va="center",
                          fontsize=SMALL)
            heights.append(place)
            names.append(formulation if index == 0 else "")
        heights.append(len(heights))
        names.append("")
    axes.set_yticks(heights, names, fontsize=SMALL)
    axes.tick_params(axis="y", length=0)
    axes.set_ylim(len(heights) - 0.5, -0.7)
    axes.set_xlim(0, 1.9)
    axes.xaxis.set_major_locator(FixedLocator([0, 0.25, 0.5, 0.75, 1]))
