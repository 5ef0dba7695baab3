"""What the charts share: figures and their panels, the look of an integrator, keys, and labels at the edge.

Nothing of the machine, the date or a user's settings enters a figure, so that the same data give the same bytes. Line
style and marker say what an integrator keeps, lightness and hue tell its relatives apart, also in grey.
"""

import io
import math
import re
import textwrap
from dataclasses import dataclass
from typing import Tuple

import matplotlib
import matplotlib.style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from integrator_names import gauss_stages

DOTS_PER_INCH = 120
RASTER = 100  # dots per inch of what an SVG holds as an image; ten more are a tenth more bytes
WIDTH = 1600 / DOTS_PER_INCH  # inches
MARGIN, KEY_HEIGHT = 0.15, 0.22  # inches
SETTINGS = {"svg.hashsalt": "isosyrk", "svg.fonttype": "none", "font.size": 9.5, "axes.titlesize": 11,
            "axes.grid": True, "grid.color": "0.9", "grid.linewidth": 0.6, "axes.axisbelow": True,
            "axes.spines.top": False, "axes.spines.right": False, "lines.markersize": 4.2,
            "lines.linewidth": 1.7, "hatch.linewidth": 0.4, "savefig.dpi": DOTS_PER_INCH,
            "axes.titley": 1.0}  # else matplotlib measures every tick, twice a drawing, to find the same place
SMALL, NOTE_COLOUR, GREY = 8, "0.3", "0.45"
KEYS_A_ROW = 9

# Relatives share a hue and differ in lightness, the cheaper lighter.
COLOURS = {
    "yoshida4": "#eb9a2d", "suzuki4": "#cf6a10", "kahan_li6": "#97400a",
    "rkmk4": "#0b8a67", "rk4": "#000000",
    "direct1": "#c08fd0", "direct2": "#9a5bb5", "direct3": "#6b2a8c",
    "algebra2_two_products": "#e0729b", "algebra3_two_products": "#a01850",
}
GAUSS_COLOURS = {1: "#62a8da", 2: "#3d88c6", 3: "#1f67ad", 4: "#114a87", 5: "#062a56"}
OTHER_COLOUR = "0.35"


@dataclass(frozen=True)
class Look:
    line: object
    marker: str
    filled: bool
    meaning: str


KEEPS_POISSON = Look("-", "o", True, "keeps the Lie–Poisson structure and the spectrum")
KEEPS_SPECTRUM = Look((0, (6, 2)), "s", False, "keeps the spectrum only")
KEEPS_NOTHING = Look((0, (1.2, 1.6)), "^", True, "keeps neither")
LOOKS = (KEEPS_POISSON, KEEPS_SPECTRUM, KEEPS_NOTHING)


def look(integrator):
    if integrator.keeps("poisson"):
        return KEEPS_POISSON
    return KEEPS_SPECTRUM if integrator.keeps("spectrum") else KEEPS_NOTHING


def colour(name):
    return GAUSS_COLOURS.get(gauss_stages(name)) or COLOURS.get(name, OTHER_COLOUR)


@dataclass(frozen=True)
class Label:
    """The name of a line, and the point of the line where it ends."""

    text: str
    end: Tuple[float, float]
    shade: object


def darker(shade):
    """Returns a colour dark enough for small text on white."""
    return tuple(0.75 * part for part in to_rgb(shade))


# ---- figures and panels


def styled(draw):
    """Keeps a user's own matplotlib settings out of a chart."""
    def drawn(*arguments):
        with matplotlib.style.context(["default", SETTINGS]):
            return draw(*arguments)
    drawn.__name__, drawn.__doc__ = draw.__name__, draw.__doc__
    return drawn


# Coordinates beyond a tenth of a point are a third of an SVG; numbers below 1 are scales.
PRECISE = re.compile(rb"(?<![\w.])([1-9][0-9]*\.[0-9])[0-9]+(?![\w.])")


def encode(figure, kind):
    """Returns the figure as the bytes of an SVG or PNG file that names neither a date nor a program."""
    unnamed = {"svg": {"Date": None, "Creator": None}, "png": {"Software": None}}
    stream = io.BytesIO()
    with matplotlib.style.context(["default", SETTINGS]):
        figure.savefig(stream, format=kind, metadata=unnamed[kind], dpi=RASTER if kind == "svg" else DOTS_PER_INCH)
    if kind == "png":
        return stream.getvalue()
    return re.sub(rb"<[^!][^>]*>", lambda tag: PRECISE.sub(rb"\1", tag[0]), stream.getvalue())


def new_figure(title, caption, rows, columns, panel_height, keys=1, right=0.18, row_gap=0.85, column_gap=0.78,
               **subplots):
    """Returns a figure with its panels, all of one size; `keys` are the lines of keys under the title."""
    caption = textwrap.fill(caption, 215)
    foot = 0.85 + 0.175 * (caption.count("\n") + 1)
    head, left = 0.8 + KEY_HEIGHT * keys, 0.8
    height = head + rows * panel_height + (rows - 1) * row_gap + foot
    figure = Figure(figsize=(WIDTH, height), dpi=DOTS_PER_INCH)
    FigureCanvasAgg(figure)
    panels = figure.subplots(rows, columns, squeeze=False, **subplots)
    panel_width = (WIDTH - left - right - (columns - 1) * column_gap) / columns
    figure.subplots_adjust(left=left / WIDTH, right=1 - right / WIDTH, top=1 - head / height, bottom=foot / height,
                           hspace=row_gap / panel_height, wspace=column_gap / panel_width)
    figure.text(MARGIN / WIDTH, 1 - 0.14 / height, title, fontsize=14, fontweight="bold", va="top")
    figure.text(MARGIN / WIDTH, 0.1 / height, caption, fontsize=SMALL + 0.5, color=NOTE_COLOUR, va="bottom",
                linespacing=1.3)
    return figure, panels


def panel_grid(count):
    columns = min(count, 2)
    return math.ceil(count / columns), columns


def logarithmic(axes, horizontal=True):
    if horizontal:
        axes.set_xscale("log")
    axes.set_yscale("log")
    axes.tick_params(which="minor", length=2)
    axes.yaxis.set_major_locator(LogLocator(numticks=12))
    axes.yaxis.set_minor_locator(NullLocator())


def style_key(figure, looks):
    """Says under the title what line styles and markers mean."""
    key_of(figure, [matplotlib.lines.Line2D([], [], color="0.2", linestyle=each.line, marker=each.marker,
                                            markerfacecolor="0.2" if each.filled else "white", label=each.meaning)
                    for each in looks])


def method_key(figure, integrators, row=1):
    """Says under the title which line is whose: one entry for the formulations of a Gauss method."""
    handles = {}
    for name, integrator in integrators.items():
        stages, style, shade = gauss_stages(name), look(integrator), colour(name)
        handles.setdefault(f"Gauss, s = {stages}" if stages else name, matplotlib.lines.Line2D(
            [], [], color=shade, linestyle=style.line, marker=style.marker,
            markerfacecolor=shade if style.filled else "white"))
    for index in range(0, len(handles), KEYS_A_ROW):
        names = list(handles)[index:index + KEYS_A_ROW]
        key_of(figure, [handles[name] for name in names], row + index // KEYS_A_ROW, labels=names)


def key_of(figure, handles, row=0, **options):
    height = figure.get_size_inches()[1]
    return figure.legend(handles=handles, loc="upper left",
                         bbox_to_anchor=(MARGIN / WIDTH, 1 - (0.45 + KEY_HEIGHT * row) / height),
                         ncol=len(handles), frameon=False, fontsize=SMALL + 1, borderaxespad=0, borderpad=0,
                         **{"handlelength": 3.6, "columnspacing": 2.2, **options})


def hide_rest(panels, used):
    for axes in list(panels.flat)[used:]:
        axes.set_visible(False)


def set_panel(axes, title, xlabel, ylabel):
    axes.set_title(title, loc="left", fontweight="bold")
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)


def floor_band(axes, floor, text, at=(0, 0), coordinates="axes fraction", offset=(6, 5)):
    """Greys what lies under the floor: errors there say more about the reference, or rounding, than the integrator."""
    axes.axhspan(axes.get_ylim()[0], floor, facecolor="0.93", linewidth=0, zorder=0)
    axes.axhline(floor, color=GREY, linewidth=0.8, zorder=1)
    axes.annotate(text, at, xycoords=coordinates, xytext=offset, textcoords="offset points", fontsize=SMALL,
                  color=NOTE_COLOUR, zorder=1, bbox={"facecolor": "0.96", "edgecolor": "none", "pad": 1.0})


def draw_line(axes, name, points, integrator, leading=True, **options):
    """Draws one integrator; relatives of a leading line stay thin and bare. `options` are those of a leading one."""
    shade, style = colour(name), look(integrator)
    x, y = zip(*points)
    if leading:
        axes.plot(x, y, color=shade, linestyle=style.line, marker=style.marker, label=name, zorder=4,
                  markerfacecolor=shade if style.filled else "white", markeredgewidth=1.1, **options)
    else:
        axes.plot(x, y, color=shade, linestyle=style.line, linewidth=0.8, label=name, zorder=3)


def cross_mark(axes, at):
    axes.plot(*at, marker="x", color="black", markersize=6.5, markeredgewidth=1.2, linestyle="none", zorder=7,
              label="_failure")


def column_of_labels(axes, labels):
    """Writes labels in a column at the right, in the order of the lines' ends, pushed apart where they would touch."""
    scale = axes.figure.dpi / 72
    labels = sorted(labels, key=lambda label: label.end[1])
    height = 1.45 * (SMALL + 1) * scale
    ends = [axes.transData.transform(label.end) for label in labels]
    right = axes.transAxes.transform((1, 0))[0]
    for label, end, y in zip(labels, ends, pushed_apart([end[1] for end in ends], height)):
        axes.annotate(label.text, label.end, xytext=((right - end[0]) / scale + 8, (y - end[1]) / scale),
                      textcoords="offset points", va="center", fontsize=SMALL + 1, color=darker(label.shade),
                      annotation_clip=False,
                      arrowprops={"arrowstyle": "-", "color": darker(label.shade), "linewidth": 0.6, "shrinkA": 0,
                                  "shrinkB": 3, "relpos": (0, 0.5)})


def pushed_apart(wanted, least):
    """Returns positions at least this far apart, in the same order, near the wanted ones (which are sorted)."""
    blocks = []  # of [sum of wanted starts, number]; each block stands packed around its mean
    for index, value in enumerate(wanted):
        blocks.append([value - index * least, 1])
        while len(blocks) > 1 and blocks[-2][0] / blocks[-2][1] > blocks[-1][0] / blocks[-1][1]:
            total, number = blocks.pop()
            blocks[-1][0] += total
            blocks[-1][1] += number
    starts = [total / number for total, number in blocks for _ in range(number)]
    return [start + index * least for index, start in enumerate(starts)]
