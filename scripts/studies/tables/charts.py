"""The chart of Tables 1 and 2 beside the paper: for each s the time of each formulation over that of group."""

from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from lib.pages.chart_panels import (FORMULATION_COLOURS, equals, label_ends, label_sizes, mixed, new_figure, note,
                                    percent, tie_band)
from studies.tables.comparison import STAGES
from lib.records.formats import FORMULATIONS
from lib.judging.verdicts import FEWEST, MARGIN, ratio_of

BASE = "group"
# What was timed, with how it is drawn: light with open marks, thin, thick. All lines are solid, since all formulations
# keep the same structure.
STYLES = {"paper": {"linewidth": 1.1, "marker": "o", "markerfacecolor": "white"}, "published": {"linewidth": 1.1},
          "fast": {"linewidth": 2.8}}
PAPER_LIGHTER = 0.45  # share of white
TICKS = (0.25, 0.5, 1, 2, 4)


def relative(run, name, stages):
    """Returns (n, Ratio of the time of a formulation over that of group), n rising, where both were measured."""
    found = []
    for n in sorted({key.n for key in run.measurements}):
        times = run.times(n, stages)
        if {name, BASE} <= times.keys():
            found.append((n, ratio_of(times[name], times[BASE])))
    return found


def formulations(published, fast, paper):
    """Returns the chart of three Runs: published forms, fast forms, and the paper's printed seconds."""
    sides = {"paper": paper, "published": published, "fast": fast}
    sizes = sorted({key.n for run in sides.values() for key in run.measurements})
    others = [name for name in FORMULATIONS if name != BASE]
    labels = [f"{name}, {side}" for name in others for side in sides]
    figure, (panels,) = new_figure(title(published, fast, paper), 1, len(STAGES), 4.6, keys=2, labels=labels,
                                   sharey=True)
    for axes, stages in zip(panels, STAGES):
        axes.set(title=f"s = {stages}", xscale="log", yscale="log", xlabel="n")
        tie_band(axes)
        axes.plot(sizes, [1] * len(sizes), color=FORMULATION_COLOURS[BASE][0], linewidth=1.3, label=BASE)
        axes.ends = [((sizes[-1], 1), BASE, FORMULATION_COLOURS[BASE][0])]
        for name in others:
            for side, run in sides.items():
                axes.ends += draw(axes, name, side, relative(run, name, stages))
        label_sizes([axes], sizes)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_minor_locator(NullLocator())
    panels[0].set_ylabel("time over that of group")
    panels[0].yaxis.set_major_locator(FixedLocator(TICKS))
    panels[0].yaxis.set_major_formatter(FuncFormatter(lambda ratio, _: f"{ratio:g}"))
    for axes in panels:
        label_ends(axes, axes.ends)
    note(figure, "Light with circles: the seconds that the paper prints. Thin: published forms, in C++. Thick: fast"
         f" forms. Bars: 95 % intervals over processes. Grey: a tie, within {percent(MARGIN - 1)}. All"
         " formulations keep the same structure.", fast.context)
    return figure


def draw(axes, name, side, points):
    """Draws a line with its intervals; returns its end with label and colour as a list, empty without points."""
    if not points:
        return []
    own = FORMULATION_COLOURS[name][0]
    colour = mixed(own, "white", PAPER_LIGHTER) if side == "paper" else own
    line = [(n, over.ratio) for n, over in points]
    axes.plot(*zip(*line), color=colour, label=f"{name}, {side}", **STYLES[side])
    for n, over in points:
        if over.processes >= FEWEST:
            axes.vlines(n, over.low, over.high, color=colour, linewidth=1)
    return [(line[-1], f"{name}, {side}", own)]


def title(published, fast, paper):
    """Returns what the chart shows, with its figures: algebra's time over group's at the largest n, for each s."""
    n = max(key.n for key in published.measurements)
    told = []
    for side, run in (("in the paper", paper), ("in published forms", published), ("in fast forms", fast)):
        ratios = [dict(relative(run, "algebra", stages)).get(n) for stages in STAGES]
        if all(ratios):
            told.append(f"{', '.join(f'{over.ratio:.2g}' for over in ratios)} {side}")
    return (f"Algebra's time over that of group at {equals('n', n)}, s = {', '.join(map(str, STAGES))}: "
            + "; ".join(told))
