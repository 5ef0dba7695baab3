"""The chart of Tables 1 and 2 beside the paper: for each s the time of each formulation over that of group."""

from math import log

from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from lib.records.formats import FORMULATIONS
from lib.judging.verdicts import ratio_of
from lib.pages.chart_panels import FORMULATION_COLOURS, new_figure
from studies.tables.comparison import STAGES

BASE = "group"
STYLES = {"paper": {"linestyle": (0, (5, 3)), "linewidth": 1.1}, "plain": {"linestyle": "-", "linewidth": 1.1},
          "optimised": {"linestyle": "-", "linewidth": 2.8}}
LOWEST, HIGHEST = 0.22, 4.6  # of the axis
LABELS_AT = 0.61  # of the width of a panel, whose lines end before
LABEL_GAP = 0.055  # least distance of two labels, as a share of the axis


def relative(run, name, stages):
    """Returns (n, time over that of group) of a formulation, where both were measured."""
    found = []
    for n in sorted({key.n for key in run.measurements}):
        times = run.times(n, stages)
        if {name, BASE} <= times.keys():
            found.append((n, ratio_of(times[name], times[BASE]).ratio))
    return found


def formulations(published, fast, paper):
    """Returns the chart of three Runs: plain code, optimised code, and the paper's printed seconds."""
    sides = {"paper": paper, "plain": published, "optimised": fast}
    sizes = sorted({key.n for run in sides.values() for key in run.measurements})
    figure, panels = new_figure(title(published, fast, paper), 1, len(STAGES), 4.6, keys=0, sharey=True)
    for axes, stages in zip(panels[0], STAGES):
        axes.set(title=f"s = {stages}", xscale="log", yscale="log", xlabel="n", ylim=(LOWEST, HIGHEST), xlim=(15, 560))
        axes.plot(sizes, [1] * len(sizes), color=FORMULATION_COLOURS[BASE][0], linewidth=1.3)
        labels = [(1.0, BASE, FORMULATION_COLOURS[BASE][0])]
        for name in (each for each in FORMULATIONS if each != BASE):
            for side, run in sides.items():
                points = relative(run, name, stages)
                if points:
                    axes.plot(*zip(*points), color=FORMULATION_COLOURS[name][0], **STYLES[side])
                    labels.append((points[-1][1], f"{name}, {side}", FORMULATION_COLOURS[name][0]))
        label(axes, labels)
        axes.xaxis.set_major_locator(FixedLocator(sizes))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda n, _: f"{n:.0f}"))
        axes.yaxis.set_major_locator(FixedLocator((0.25, 0.5, 1, 2, 4)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda ratio, _: f"{ratio:g}"))
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_minor_locator(NullLocator())
    panels[0][0].set_ylabel("time over that of group")
    return figure


def label(axes, labels):
    """Writes labels at the right end of their lines, moved apart where they would overlap."""
    place = -LABEL_GAP
    for ratio, text, colour in sorted(labels):
        place = max(log(ratio / LOWEST) / log(HIGHEST / LOWEST), place + LABEL_GAP)
        axes.text(LABELS_AT, place, text, color=colour, transform=axes.transAxes, va="center", fontsize=9.5)


def title(published, fast, paper):
    """Returns what the chart shows, with its figures: algebra's time over group's at the largest n and s."""
    n, stages = max(key.n for key in published.measurements), STAGES[-1]
    found = {side: dict(relative(run, "algebra", stages)).get(n) for side, run in
             (("in the paper", paper), ("in plain code", published), ("in optimised code", fast))}
    told = [f"{ratio:.1f} {side}" for side, ratio in found.items() if ratio]
    return f"Algebra's time over that of group at n = {n}, s = {stages}: {', '.join(told)}"
