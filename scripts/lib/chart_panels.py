"""What the charts share: figures with panels and keys, and the look of an integrator.

Nothing of the machine, the date or a user's settings enters a figure, so that the same data give the same bytes.
"""

import io
import re
import textwrap

import matplotlib.style
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullLocator

DOTS_PER_INCH = 120
WIDTH = 1600 / DOTS_PER_INCH  # inches
KEY_HEIGHT = 0.21  # inches
TITLE_CHARACTERS = 105  # a line
METHOD_KEYS = 3
SETTINGS = {"svg.hashsalt": "isosyrk", "svg.fonttype": "none", "font.size": 10.5, "axes.titlesize": 12,
            "axes.titleweight": "bold", "axes.titlelocation": "left", "axes.grid": True, "grid.color": "0.9",
            "grid.linewidth": 0.6, "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False,
            "lines.markersize": 4, "lines.linewidth": 1.3, "legend.frameon": False, "legend.handlelength": 3,
            "axes.titley": 1.0}  # else matplotlib measures every tick, twice a drawing, to find the same place

# Colour and size of the markers say which family an integrator belongs to, the marker its number (of stages, or its
# order), the line what it keeps. Formulations with the same answer differ in size, so that none hides another.
FAMILIES = {"cotangent": ("#e08214", 7.5), "group": ("#1f67ad", 5.2), "algebra": ("#4a0a5e", 3.4),
            "yoshida": ("#d8a03c", 4), "suzuki": ("#c06a28", 4), "kahan_li": ("#8a3b12", 4), "rkmk": ("#0b8a67", 4),
            "direct": ("#cf6aa3", 4), "rk": ("#000000", 4)}
OTHER_FAMILY = ("0.5", 4)
MARKERS = {"1": "o", "2": "s", "3": "^", "4": "D", "5": "P", "6": "v"}
LINES = {"poisson": "-", "spectrum": "--", "nothing": ":"}
LINES_IN_WORDS = ("Solid lines: keeps the Lie–Poisson structure and the spectrum. Dashed: keeps the spectrum only."
                  " Dotted: keeps neither.")


def own_style():
    """Keeps a user's own matplotlib settings out of the charts that are drawn and encoded in this context."""
    return matplotlib.style.context(["default", SETTINGS])


def look(integrator):
    """Returns how the line of an integrator is drawn."""
    family, number = re.match(r"([a-z_]+)([0-9]?)", integrator.name).groups()
    colour, size = FAMILIES.get(family, OTHER_FAMILY)
    return {"color": colour, "marker": MARKERS.get(number, "."), "markersize": size, "markerfacecolor": "none",
            "linestyle": next(LINES[each] for each in LINES if integrator.keeps(each))}


def new_figure(title, rows, columns, panel_height, keys=1, row_gap=0.75, **subplots):
    """Returns a figure and its rows of panels; `keys` are the lines of keys under them. Heights and gaps are in inches.

    Nothing is laid out by matplotlib's solver, which does not always find the same places.
    """
    lines = textwrap.wrap(title, TITLE_CHARACTERS)
    left, right, head, foot, column_gap = 0.8, 0.15, 0.55 + 0.25 * len(lines), 0.7 + KEY_HEIGHT * keys, 0.75
    height = head + rows * panel_height + (rows - 1) * row_gap + foot
    figure = Figure(figsize=(WIDTH, height), dpi=DOTS_PER_INCH)
    panel_width = (WIDTH - left - right - (columns - 1) * column_gap) / columns
    figure.subplots_adjust(left=left / WIDTH, right=1 - right / WIDTH, top=1 - head / height, bottom=foot / height,
                           hspace=row_gap / panel_height, wspace=column_gap / panel_width)
    figure.text(0.01, 1 - 0.15 / height, "\n".join(lines), va="top", fontsize=14, fontweight="bold")
    return figure, figure.subplots(rows, columns, squeeze=False, **subplots)


def key(figure, handles, rows=1, title=None):
    """Puts a key under the panels."""
    figure.legend(handles=handles, loc="lower left", ncol=-(-len(handles) // rows), title=title, alignment="left")


def handle(label, **style):
    return Line2D([], [], label=label, **style)


def method_key(figure, integrators):
    """Says under the panels whose line is whose, in METHOD_KEYS lines."""
    handles = [handle(each.name, **look(each)) for each in integrators]
    key(figure, handles, METHOD_KEYS - 1, LINES_IN_WORDS)


def logarithmic(axes):
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=12))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_locator(NullLocator())


def draw_line(axes, label, points, **style):
    """Draws those points whose coordinates have a place on logarithmic axes, and returns them."""
    points = [(x, y) for x, y in points if x > 0 and y > 0]
    if points:
        axes.plot(*zip(*points), label=label, **style)
    return points


def cross(axes, at):
    """Marks a failure."""
    axes.plot(*at, marker="x", color="black", markersize=6.5, zorder=7, label="_failure")


# Coordinates beyond a tenth of a point are a third of an SVG; numbers below 1 are scales.
PRECISE = re.compile(rb"(?<![\w.])([1-9][0-9]*\.[0-9])[0-9]+(?![\w.])")


def encode(figure, kind):
    """Returns the figure as the bytes of an SVG or PNG file that names neither a date nor a program."""
    unnamed = {"svg": {"Date": None, "Creator": None}, "png": {"Software": None}}
    stream = io.BytesIO()
    figure.savefig(stream, format=kind, metadata=unnamed[kind])
    if kind == "png":
        return stream.getvalue()
    return re.sub(rb"<[^!][^>]*>", lambda tag: PRECISE.sub(rb"\1", tag[0]), stream.getvalue())
