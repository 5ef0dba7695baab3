"""What the script of a page draws: charts of points as data, with their selectors, their looks and their commands.

Of one chart the page shows the points that its selectors leave. Each point has a value in every column: for what is
drawn, what is chosen by, what is told of it, and the command that repeats it.
"""

import colorsys
from typing import Any, Dict, NamedTuple, Optional, Tuple

from matplotlib.colors import to_hex, to_rgb

from lib.pages.chart_panels import LINES, look
from lib.records.formats import to_digits
from lib.records.integrators import ADAMS

# The marks and lines of the still charts, as Plotly calls them.
SYMBOLS = {"o": "circle", "s": "square", "^": "triangle-up", "D": "diamond", "P": "cross", "v": "triangle-down",
           "h": "hexagon", ".": "circle", "x": "x-thin"}
DASHES = dict(zip(LINES.values(), ("solid", "dash", "dot")))
# Where no lines say what a method keeps, the mark does: open, with a dot inside, filled.
OPEN, DOTTED, FILLED = "-open", "-open-dot", ""
FILLS = dict(zip(LINES.values(), (OPEN, DOTTED, FILLED)))
KEEPING = "Open marks keep the Lie–Poisson structure, those with a dot the spectrum only, filled ones nothing."
ADAMS_SYMBOL = "star"  # by which Adams methods differ from Runge–Kutta ones of their order, whose colour they have
LARGER = 2.2  # a mark in pixels, over its size in points on paper
DARK_GROUND, CONTRAST, LIGHTER = "#15181d", 6, 0.02  # of dark pages; colours are lightened by steps until they differ


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
    has_front: bool = False  # only points that no other beats in both are drawn in colour
    bars: Tuple[str, ...] = ()  # columns with the ends of intervals
    band: Optional[Tuple[Optional[float], float]] = None  # of y, shaded; None: from the lowest point on
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
    return {"color": to_hex(style["color"]), "dark": on_dark(style["color"]), "joined": joined,
            "dash": DASHES[style.get("linestyle", "-")], "width": style.get("linewidth", 1.6),
            "symbol": SYMBOLS[style.get("marker") or "."] + fill,
            "size": LARGER * style.get("markersize", 4) if style.get("marker") else 0}


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
    return {"name": chart.name, "x": chart.x._asdict(), "y": chart.y._asdict(),
            "columns": [{"name": name, "label": each.label, **coded(each.values)}
                        for name, each in chart.columns.items()],
            "selectors": [{"column": each.column, "at_least": each.at_least,
                           "options": [option.value for option in each.options]} for each in chart.selectors],
            "looks": chart.looks, "has_front": chart.has_front, "bars": chart.bars,
            "band": chart.band, "parts": list(shared), "commands": [[shared[part] for part in line] for line in parts]}


def coded(values):
    """Returns values as they are, or where many are alike each once, with the places of all."""
    values = [to_digits(each, DIGITS) if isinstance(each, float) else each for each in values]
    once = {each: place for place, each in enumerate(dict.fromkeys(values))}
    if 2 * len(once) > len(values):
        return {"values": values}
    return {"values": list(once), "places": [once[each] for each in values]}
