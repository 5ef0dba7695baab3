"""What the charts share: figures with panels, keys, labels and notes, and the names and looks of integrators.

Nothing of the machine, the date or a user's settings enters a figure, so that the same data give the same bytes.
"""

import io
import itertools
import math
import re
import textwrap
import zlib

import matplotlib.style
from matplotlib.colors import hsv_to_rgb, to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogFormatterSciNotation, LogLocator, NullLocator

from lib.records.settings import TIGHT, keeps
from lib.records.integrators import (ADAMS, BY_STAGES, COMPOSITION, DIRECT_GAUSS, EXPONENTIAL, GAUSS, MAGNUS, RKMK,
                                     RUNGE_KUTTA, is_new, strongest_structure)
from lib.judging.verdicts import MARGIN

DOTS_PER_INCH = 120
WIDTH = 1600 / DOTS_PER_INCH  # inches
KEY_HEIGHT = 0.21  # inches
TITLE_CHARACTERS = 105  # a line
NOTE_CHARACTERS = 165  # a line
LABEL_SIZE = 11  # points
LABEL_CHARACTER = 0.082  # inches a character, at this size
LABEL_GAP = 1.3  # least distance of two labels, over their size
LABEL_AWAY, LABEL_BEHIND_LEADER = 8, 22  # points from the end of a line to its label
SAME_END = 0.03  # ends of lines that are no further apart, over the width of a panel, have their labels in one column
SETTINGS = {"svg.hashsalt": "isosyrk", "svg.fonttype": "none", "font.size": 10.5, "axes.titlesize": 12,
            "axes.titleweight": "bold", "axes.titlelocation": "left", "axes.grid": True, "grid.color": "0.9",
            "grid.linewidth": 0.6, "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False,
            "lines.markersize": 4, "lines.linewidth": 1.3, "legend.frameon": False, "legend.handlelength": 3,
            "axes.titley": 1.0}  # else matplotlib measures every tick, twice a drawing, to find the same place

# One look for each method in all charts. The hue says to which family it belongs, projected methods being one; the
# lightness its order, the marker its number (of stages where that is half the order by construction, or its order), the
# line what it keeps. At a tolerance at which it keeps less than at the tightest it is lighter. Formulations of the
# Gauss method, which have the same answer, differ in size, so that none hides another.
FORMULATION_COLOURS = {"cotangent": ("#e08214", 7.5), "group": ("#1f67ad", 5.2), "algebra": ("#4a0a5e", 3.4)}
FAMILY_COLOURS = {EXPONENTIAL: ("#ee4b5e", 5.2), COMPOSITION: ("#d8a03c", 4), RKMK: ("#0b8a67", 4),
                  MAGNUS: ("#7fa32a", 4), DIRECT_GAUSS: ("#cf6aa3", 4), RUNGE_KUTTA: ("#6a6a6a", 4),
                  ADAMS: ("#6a6a6a", 4)}
PROJECTED = ("#b5652d", 4)
OTHER_SIZE, SATURATION, VALUE = 4, 0.75, 0.6  # of any other family, whose hue is drawn from its name
LIGHTER, DARKER, DARKEST = 0.3, 0.3, 0.65  # share of white below order 4, of black from order 5 and from order 7 on
LOOSE_LIGHTER = 0.35  # share of white at a loose tolerance
MARKERS = {1: "o", 2: "s", 3: "^", 4: "D", 5: "P", 6: "v", 8: "h"}
LINES = {"poisson": "-", "spectrum": "--", "nothing": ":"}
KEEPING = "Solid: keeps the Lie–Poisson structure; dashed: the spectrum only; dotted: nothing."  # what LINES mean


def own_style():
    """Keeps a user's own matplotlib settings out of the charts that are drawn and encoded in this context."""
    return matplotlib.style.context(["default", SETTINGS])


def look(integrator, tolerance=TIGHT):
    """Returns how the line of an integrator at a tolerance is drawn."""
    colour, size = colour_and_size(integrator)
    number = integrator.stages if integrator.family in BY_STAGES else integrator.order
    colour = at_order(colour, integrator.order)
    if not keeps(integrator, tolerance, strongest_structure(integrator)):
        colour = mixed(colour, "white", LOOSE_LIGHTER)
    return {"color": colour, "marker": MARKERS.get(number, "."), "markersize": size, "markerfacecolor": "none",
            "linestyle": next(LINES[each] for each in LINES if keeps(integrator, tolerance, each))}


def colour_and_size(integrator):
    """Returns the colour of the family of an integrator at order 4, and the size of its markers."""
    if integrator.family == GAUSS:
        return FORMULATION_COLOURS[integrator.formulation]
    if integrator.projected:
        return PROJECTED
    kind = integrator.method if is_new(integrator) else integrator.family
    hue = zlib.crc32(kind.encode("utf-8")) / 2**32
    return FAMILY_COLOURS.get(kind) or (to_hex(hsv_to_rgb((hue, SATURATION, VALUE))), OTHER_SIZE)


def at_order(colour, order):
    """Returns the colour of a family at an order: itself at order 4, lighter below, darker above."""
    if order < 4:
        return mixed(colour, "white", LIGHTER)
    if order == 4:
        return colour
    return mixed(colour, "black", DARKER if order < 7 else DARKEST)


def mixed(colour, other, share):
    """Returns a colour with a share of another one in it."""
    return to_hex([(1 - share) * own + share * added for own, added in zip(to_rgb(colour), to_rgb(other))])


def equals(name, value):
    """Returns an equation that no title breaks into two lines."""
    return f"{name}\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}{value}"


def percent(share):
    """Writes a share in percent, never broken into two lines."""
    return f"{100 * share:.0f}\N{NO-BREAK SPACE}%"


def new_figure(title, rows, columns, panel_height, keys=1, row_gap=0.75, labels=(), last_labels=None, **subplots):
    """Returns a figure and its rows of panels, with room right of each for the longest of `labels`.

    With `last_labels` the last column has room for these instead. `keys` are the lines of keys or of notes under the
    panels. Heights and gaps are in inches. Nothing is laid out by matplotlib's solver, which does not always find the
    same places.
    """
    label_room, last_room = (room_for(each) for each in (labels, labels if last_labels is None else last_labels))
    lines = textwrap.wrap(title, TITLE_CHARACTERS)
    left, right, head, foot = 0.8, 0.15 + last_room, 0.55 + 0.25 * len(lines), 0.7 + KEY_HEIGHT * keys
    column_gap = (0.75 if label_room else 0.4) + label_room
    height = head + rows * panel_height + (rows - 1) * row_gap + foot
    figure = Figure(figsize=(WIDTH, height), dpi=DOTS_PER_INCH)
    panel_width = (WIDTH - left - right - (columns - 1) * column_gap) / columns
    figure.subplots_adjust(left=left / WIDTH, right=1 - right / WIDTH, top=1 - head / height, bottom=foot / height,
                           hspace=row_gap / panel_height, wspace=column_gap / panel_width)
    figure.text(0.01, 1 - 0.15 / height, "\n".join(lines), va="top", fontsize=14, fontweight="bold")
    return figure, figure.subplots(rows, columns, squeeze=False, **subplots)


def room_for(labels):
    """Returns the inches that the longest of some labels takes, with the leader to its line."""
    longest = max(map(len, labels), default=0)
    return LABEL_CHARACTER * longest + LABEL_BEHIND_LEADER / 72 if longest else 0.0


def key(figure, handles, rows=1, title=None):
    """Puts a key under the panels."""
    figure.legend(handles=handles, loc="lower left", ncol=-(-len(handles) // rows), title=title, alignment="left")


def note(figure, text, timed_on=None):
    """Puts a note under the panels. `timed_on` is the context of a raw file whose times are drawn: its processor."""
    processor = f" Processor: {timed_on['cpu']}." if timed_on and "cpu" in timed_on else ""
    figure.text(0.01, 0.1 / figure.get_figheight(), "\n".join(textwrap.wrap(text + processor, NOTE_CHARACTERS)),
                va="bottom", color="0.25")


def label_ends(axes, ends, in_one_column=False):
    """Writes labels right of the ends of lines, moved apart where they would overlap, then with a leader to its line.

    `ends` are ((x, y), label, colour), drawn before. Labels of lines that end further left stand there, or
    `in_one_column` with all others.
    """
    axes.autoscale_view()  # which matplotlib puts off else
    to_share = (axes.transData + axes.transAxes.inverted()).transform
    labels = sorted((*to_share(point).tolist(), label, colour) for point, label, colour in ends)
    columns = []
    for x, y, label, colour in labels:
        if not columns or not (in_one_column or x - columns[-1][-1][0] <= SAME_END):
            columns.append([])
        columns[-1].append((x, min(y, 1.0), label, colour))
    for column in columns:
        label_column(axes, sorted(column, key=lambda each: (each[1], each[2])))


def label_column(axes, labels):
    """Writes labels in one column; each is (x, y, label, colour) of the end of its line, as shares of the axes."""
    width, height = (72 * size / axes.figure.dpi for size in (axes.bbox.width, axes.bbox.height))  # points
    right, gap = max(x for x, *_ in labels), LABEL_GAP * LABEL_SIZE / height
    places = spread([y for _, y, *_ in labels], gap)
    moved = [abs(place - y) > gap / 4 or right - x > SAME_END for place, (x, y, *_) in zip(places, labels)]
    away = LABEL_BEHIND_LEADER if any(moved) else LABEL_AWAY
    for place, led, (x, y, label, colour) in zip(places, moved, labels):
        if led:
            axes.add_line(Line2D((x + 3 / width, right + (away - 3) / width), (y, place), transform=axes.transAxes,
                                 clip_on=False, color="0.6", linewidth=0.5, zorder=1, label="_leader"))
        axes.annotate(label, (right, place), xycoords="axes fraction", xytext=(away, 0), textcoords="offset points",
                      va="center", color=colour, fontsize=LABEL_SIZE, annotation_clip=False)


def spread(places, gap):
    """Returns rising places moved apart to at least a gap, with the least sum of squares of the moves."""
    blocks = []  # of neighbours at the least gap: mean of place - index * gap, and how many they are
    for index, place in enumerate(places):
        mean, count = place - index * gap, 1
        while blocks and blocks[-1][0] > mean:
            before, many = blocks.pop()
            mean, count = (before * many + mean * count) / (many + count), many + count
        blocks.append((mean, count))
    means = [mean for mean, count in blocks for _ in range(count)]
    return [mean + index * gap for index, mean in enumerate(means)]


def unbroken(points):
    """Returns points as lists of neighbours, parted where a value is None."""
    groups = itertools.groupby(points, lambda point: point[1] is not None)
    return [list(group) for good, group in groups if good]


def label_sizes(panels, sizes):
    """Gives panels that are drawn against n a tick at each n."""
    for axes in panels:
        axes.set_xticks(sorted(sizes), [str(n) for n in sorted(sizes)])
        axes.grid(False, axis="x")


class Decades(LogLocator):
    """Ticks at powers of ten, and where fewer than two of them are seen at twice and five times each too."""

    def tick_values(self, vmin, vmax):
        seen = math.floor(math.log10(vmax)) - math.ceil(math.log10(vmin)) + 1
        self.set_params(subs=(1.0, 2.0, 5.0) if seen < 2 else (1.0,))
        return super().tick_values(vmin, vmax)


def logarithmic(axes):
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(Decades(numticks=12))
    axes.yaxis.set_major_formatter(LogFormatterSciNotation(labelOnlyBase=False, minor_thresholds=(math.inf, math.inf)))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_locator(NullLocator())


def draw_line(axes, label, points, **style):
    """Draws those points whose coordinates have a place on logarithmic axes, and returns them."""
    points = [(x, y) for x, y in points if x > 0 and y > 0]
    if points:
        axes.plot(*zip(*points), label=label, **style)
    return points


def tie_band(axes, axis="y"):
    """Shades the ratios that are a tie, along an axis."""
    span = axes.axhspan if axis == "y" else axes.axvspan
    span(1 / MARGIN, MARGIN, color="0.9", linewidth=0, zorder=0, label="_tie")


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
