"""What the script of a page draws: charts of points as data, with their selectors, their looks and their commands.

Of one chart the page shows the points that its selectors leave. Each point has a value in every column: for what is
drawn, what is chosen by, what is told of it, and the command that repeats it.
"""

import colorsys
import textwrap
from typing import Any, Dict, NamedTuple, Optional, Tuple

from matplotlib.colors import to_hex, to_rgb

from lib.pages.chart_panels import LINES, look
from lib.records.formats import to_digits
from lib.records.integrators import ADAMS

# The marks and lines of the still charts, as Plotly calls them.
SYMBOLS = {"o": "circle", "s": "square", "^": "triangle-up", "D": "diamond", "P": "cross", "v": "triangle-down",
           "h": "triangle-right", ".": "circle", "x": "x-thin"}
DASHES = dict(zip(LINES.values(), ("solid", "dash", "dot")))
# Where no lines say what a method keeps, the mark does: open, with a dot inside, filled.
OPEN, DOTTED, FILLED = "-open", "-open-dot", ""
FILLS = dict(zip(LINES.values(), (OPEN, DOTTED, FILLED)))
KEEPING = "Open marks keep the Lie–Poisson structure, those with a dot the spectrum only, filled ones nothing."
ADAMS_SYMBOL = "star"  # by which Adams methods differ from Runge–Kutta ones of their order, whose colour they have
# Marks of points that differ in grey too; each there is open and with a dot besides.
MARKS = ("square", "diamond", "triangle-up", "triangle-down", "cross", "x", "star", "circle", "hexagram",
         "triangle-left", "triangle-right", "star-diamond", "diamond-tall", "star-square", "diamond-wide",
         "star-triangle-up")
MOST_MARKS = 16  # on a line
BEATEN = "beaten by another"  # name of what is not drawn in colour
LARGER = 2.2  # a mark in pixels, over its size in points on paper
DARK_GROUND, CONTRAST, LIGHTER = "#15181d", 6, 0.02  # of dark pages; colours are lightened by steps until they differ
GREY = {"color": "#8f959c", "dark": "#6a727c", "joined": False, "symbol": "circle-open", "mode": "markers",
        "line": {}, "marker": {"size": 5}}
BELOW = 2  # times less than the lowest point, where a band begins that has no lower end
TITLE_LINE = 24  # letters after which the title of the upright axis is broken, so that a narrow page has room for it


class Column(NamedTuple):
    """A value of every point. Those with a label are told when a point is shown; None of a point is not told."""

    label: str
    values: list


class Axis(NamedTuple):
    column: str
    title: str
    is_logarithmic: bool = True
    is_reversed: bool = False
    has_ticks: bool = False  # at the values alone, as sizes n


class Option(NamedTuple):
    label: str
    value: Any  # that points have in the column; None leaves all


class Selector(NamedTuple):
    """Leaves the points with a value, or with this and larger ones."""

    column: str
    label: str
    options: Tuple[Option, ...]
    chosen: int = 0  # at first
    at_least: bool = False


class Chart(NamedTuple):
    name: str  # of the chart in the page and in its address
    title: str
    x: Axis
    y: Axis
    columns: Dict[str, Column]
    selectors: Tuple[Selector, ...]
    looks: Dict[str, dict]  # how points are drawn, by the value in the column `series`, in the order of the key
    commands: list  # of every point; "" where no program of this project repeats it
    has_front: bool = False  # only points that no other beats in both are drawn in colour; the others are grey
    bars: Tuple[str, ...] = ()  # columns with the ends of intervals
    band: Optional[Tuple[Optional[float], float]] = None  # of y, shaded; None: from below all points
    note: str = ""


def options_of(values, write=str):
    """Returns an Option for each of some values, once, in their order."""
    return tuple(Option(write(each), each) for each in dict.fromkeys(values))


def look_of(integrator, tolerance):
    """Returns how the line of an Integrator is drawn."""
    return as_plotly(look(integrator, tolerance))


def mark_of(integrator, tolerance):
    """Returns how the points of an Integrator are drawn, which no line joins."""
    style = look(integrator, tolerance)
    found = as_plotly(style, joined=False, fill=FILLS[style["linestyle"]])
    return {**found, "symbol": ADAMS_SYMBOL + FILLS[style["linestyle"]]} if integrator.family == ADAMS else found


def as_plotly(style, joined=True, fill=OPEN):
    """Returns the look that a style of the still charts has on the page."""
    marked = bool(style.get("marker"))
    return {"color": to_hex(style["color"]), "dark": on_dark(style["color"]), "joined": joined,
            "symbol": SYMBOLS[style.get("marker") or "."] + fill,
            "mode": "markers" if not joined else "lines+markers" if marked else "lines",
            "line": {"dash": DASHES[style.get("linestyle", "-")], "width": style.get("linewidth", 1.6)},
            "marker": {"size": LARGER * style.get("markersize", 4), "maxdisplayed": MOST_MARKS if joined else 0}}


def on_dark(colour):
    """Returns a colour of the same hue, lightened until it stands out from the ground of a dark page."""
    hue, lightness, saturation = colorsys.rgb_to_hls(*to_rgb(colour))
    while contrast(colour, DARK_GROUND) < CONTRAST:
        lightness = min(1.0, lightness + LIGHTER)
        colour = colorsys.hls_to_rgb(hue, lightness, saturation)
    return to_hex(colour)


def contrast(colour, ground):
    """Returns the contrast of two colours, 1 to 21. Source: WCAG 2.1, relative luminance."""
    def luminance(each):
        linear = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055)**2.4 for c in to_rgb(each))
        return sum(weight * c for weight, c in zip((0.2126, 0.7152, 0.0722), linear))

    low, high = sorted(map(luminance, (colour, ground)))
    return (high + 0.05) / (low + 0.05)


# ---- as JSON

DIGITS = 6  # of numbers that are drawn and told; commands have all
AT_OPTIONS = " --"  # where lines are split into what many of them share


def as_data(chart):
    """Returns a Chart as what JSON can hold, its columns as short as they can be."""
    counts = {len(column.values) for column in chart.columns.values()} | {len(chart.commands)}
    if len(counts) != 1:
        raise ValueError(f"columns of {chart.name} have other lengths")
    if unknown := {*chart.columns["series"].values} - chart.looks.keys():
        raise ValueError(f"{chart.name} has no look of {min(unknown)}")
    parts = [line.split(AT_OPTIONS) for line in chart.commands]
    shared = {part: place for place, part in enumerate(dict.fromkeys(part for line in parts for part in line))}
    looks = {BEATEN: GREY, **chart.looks} if chart.has_front else chart.looks
    return {"name": chart.name, "x": axis_data(chart.x, chart.x.title),
            "y": axis_data(chart.y, in_lines(chart.y.title)),
            "columns": [{"name": name, "label": each.label, **coded(each.values)}
                        for name, each in {**chart.columns, **bars_of(chart)}.items()],
            "selectors": [{"column": each.column, "at_least": each.at_least,
                           "options": [option.value for option in each.options]} for each in chart.selectors],
            "looks": looks, "marks": MARKS, "beaten": BEATEN if chart.has_front else None,
            "shapes": shapes_of(chart), "parts": list(shared),
            "commands": [[shared[part] for part in line] for line in parts]}


def axis_data(axis, title):
    """Returns an Axis as what the script reads, with Plotly's layout of it."""
    return {"column": axis.column, "has_ticks": axis.has_ticks, "layout": {
        "title": {"text": title}, "type": "log" if axis.is_logarithmic else "linear", "zeroline": False,
        "automargin": True, "autorange": "reversed" if axis.is_reversed else True, "exponentformat": "power",
        "tickangle": 0}}


def bars_of(chart):
    """Returns columns with the lengths of the bars of points, 0 where there is no interval."""
    if not chart.bars:
        return {}
    low, high = (chart.columns[name].values for name in chart.bars)
    heights = chart.columns[chart.y.column].values
    return {"above": Column("", [0 if end is None else end - at for at, end in zip(heights, high)]),
            "below": Column("", [0 if end is None else at - end for at, end in zip(heights, low)])}


def shapes_of(chart):
    """Returns the band that is shaded, as Plotly's shape."""
    if not chart.band:
        return []
    low, high = chart.band
    lowest = min(chart.columns[chart.y.column].values, default=high) / BELOW if low is None else low
    return [{"type": "rect", "xref": "paper", "x0": 0, "x1": 1, "y0": lowest, "y1": high, "layer": "below",
             "line": {"width": 0}}]


def in_lines(title):
    return "<br>".join(textwrap.wrap(title, TITLE_LINE))


def coded(values):
    """Returns values as they are, or where many are alike each once, with the places of all."""
    values = [to_digits(each, DIGITS) if isinstance(each, float) else each for each in values]
    once = {each: place for place, each in enumerate(dict.fromkeys(values))}
    if 2 * len(once) > len(values):
        return {"values": values}
    return {"values": list(once), "places": [once[each] for each in values]}
