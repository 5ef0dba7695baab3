"""Draws the time of a step against n, from the raw file of `scaling`."""

from typing import NamedTuple

from lib.chart_panels import (FAMILIES, LINES, draw_line, equals, extended, label_ends, logarithmic, new_figure,
                              note)
from lib.formats import FAST, PUBLISHED
from lib.numbers import two_digits


class Line(NamedTuple):
    """A line of the chart."""

    label: str
    integrator: str
    rung: str
    colour: str
    style: dict


PUBLISHED_LINE = {"linewidth": 1, "markersize": 5}
FAST_LINE = {"linewidth": 2.2, "markersize": 6}
DRAWN = (
    Line("Gauss 4, published", "group2_frame", PUBLISHED, FAMILIES["group"][0],
         {"linestyle": LINES["poisson"], "marker": "s", **PUBLISHED_LINE}),
    Line("exponential 4, published", "elp4_frame", PUBLISHED, FAMILIES["elp"][0],
         {"linestyle": LINES["poisson"], "marker": "D", **PUBLISHED_LINE}),
    Line("Gauss 4, fast", "group2_frame", FAST, FAMILIES["group"][0],
         {"linestyle": LINES["poisson"], "marker": "s", **FAST_LINE}),
    Line("midpoint, fast", "algebra1_frame", FAST, FAMILIES["algebra"][0],
         {"linestyle": LINES["poisson"], "marker": "^", **FAST_LINE}),
    Line("exponential 4, fast", "elp4_frame", FAST, FAMILIES["elp"][0],
         {"linestyle": LINES["poisson"], "marker": "D", **FAST_LINE}),
    Line("RK4, fast", "rk4_frame", FAST, FAMILIES["rk"][0],
         {"linestyle": LINES["nothing"], "marker": "o", **FAST_LINE}))
TOLD = "group2_frame"  # the method of the title


def step_against_n(study):
    """Returns a figure with a panel for each start of a Scaling. None if no line of DRAWN has two n.

    A single timing is an open mark. A line ends where its method was not timed, or where a step fails.
    """
    lines = {start: drawn for start in study.starts() if (drawn := lines_from(study, start))}
    if not any(len(points) > 1 for drawn in lines.values() for _, points in drawn):
        return None
    figure, (panels,) = new_figure(gain_title(study), 1, len(lines), 5.6, keys=2, sharex=True, sharey=True,
                                   labels=[each.label for each in DRAWN])
    sizes = {point.n for drawn in lines.values() for _, points in drawn for point in points}
    for axes, (start, drawn) in zip(panels, lines.items()):
        logarithmic(axes)
        axes.set(title=f"from t = {start:g} on", xlabel="n")
        axes.set_xticks(sorted(sizes), [str(n) for n in sorted(sizes)])
        axes.grid(False, axis="x")
        for each, points in drawn:
            draw_points(axes, each, points)
    panels[0].set_ylabel("CPU milliseconds a step")
    for axes, drawn in zip(panels, lines.values()):
        largest = max(points[-1].n for _, points in drawn)
        label_ends(axes, [(extended(coordinates(points), largest), each.label, each.colour)
                          for each, points in drawn])
    note(figure, "Smooth scene, methods in the co-rotating frame; numbers are orders. Gauss methods, the midpoint rule"
         " on g and RK4: h = 0.1, tolerance 1e-13; exponential methods: h = 0.25, 1e-8. A half of these steps at"
         " n = 513, a quarter at n = 1025. Medians of repetitions of the same steps; open marks: timed once. Dotted:"
         " keeps no structure.")
    return figure


def lines_from(study, start):
    """Returns (Line, its points) of each line that has points from a start."""
    found = [(each, study.line(start, each.integrator, each.rung)) for each in DRAWN]
    return [(each, points) for each, points in found if points]


def coordinates(points):
    return [(point.n, 1e3 * point.time) for point in points]


def draw_points(axes, line, points):
    """Draws a line, then its single timings as open marks on top of it."""
    drawn = draw_line(axes, line.label, coordinates(points), color=line.colour, **line.style)
    single = [place for place, point in zip(drawn, points) if point.is_single]
    if single:
        mark = {**line.style, "linestyle": "none", "color": line.colour, "markerfacecolor": "white", "zorder": 5}
        axes.plot(*zip(*single), label=f"_{line.label}, once", **mark)


def gain_title(study):
    """Returns the gain of the fast form of TOLD at each start, at the largest n that has it at all of them."""
    starts = study.starts()
    gains = {n: [study.gain(start, n, PUBLISHED, [TOLD]) for start in starts] for n in study.sizes()}
    largest = max((n for n, found in gains.items() if None not in found), default=None)
    if largest is None:
        return "CPU time of a step against n"
    told = " and ".join(f"{two_digits(gain)} at {equals('t', f'{start:g}')}"
                        for gain, start in zip(gains[largest], starts))
    return (f"The fast form of the Gauss method of order 4 gains a factor of {told}"
            f" over its published form at {equals('n', largest)}")
