"""Places labels beside lines in a chart, clear of what is drawn and of each other.

A line named at its end is read faster than a legend; where ends crowd together, a label moves off and a thin leader
joins it to its line. Places are priced by what they hide, and labels take turns until none finds a better one.
"""

import math
from dataclasses import dataclass
from typing import Sequence, Tuple

import numpy
from matplotlib.colors import to_rgb


def darker(shade):
    """Returns a colour dark enough for small text on white."""
    return tuple(0.75 * part for part in to_rgb(shade))


@dataclass(frozen=True)
class Label:
    text: str
    points: Sequence[Tuple[float, float]]  # in data units; the label may stand at any of them
    shade: object


@dataclass(frozen=True)
class Box:
    """A rectangle on the page, in dots."""

    left: float
    bottom: float
    right: float
    top: float

    def grown(self, by):
        return Box(self.left - by, self.bottom - by, self.right + by, self.top + by)

    def overlap(self, other):
        width = min(self.right, other.right) - max(self.left, other.left)
        height = min(self.top, other.top) - max(self.bottom, other.bottom)
        return width * height if width > 0 and height > 0 else 0.0

    def holds(self, dot):
        return self.left < dot[0] < self.right and self.bottom < dot[1] < self.top


@dataclass(frozen=True)
class Place:
    """A label's place: a thin line, its leader, joins it to what it names unless it stands close by."""

    at: Tuple[float, float]  # in data units
    anchor: Tuple[float, float]  # the same in dots
    centre: Tuple[float, float]
    box: Box
    led: bool

    def leader(self):
        if not self.led:
            return []
        (x, y), (to_x, to_y) = self.anchor, self.centre
        return [(x + (to_x - x) * part / 20, y + (to_y - y) * part / 20) for part in range(2, 20)]


class Ink:
    """How much is drawn where: running sums over the page, so that any rectangle is looked up at once."""

    def __init__(self, axes):
        width, height = axes.figure.canvas.get_width_height()
        drawn = numpy.zeros((width + 1, height + 1))
        for (x, y), weight in self.dots(axes):
            if 0 <= x < width and 0 <= y < height:
                drawn[int(x) + 1, int(y) + 1] += weight
        self.sums = drawn.cumsum(axis=0).cumsum(axis=1)

    @staticmethod
    def dots(axes):
        """Returns dots along the lines and how much each weighs: markers most, thin lines least."""
        reach = 2.5 * axes.figure.dpi / 72  # from the middle of a marker to its edge
        for line in axes.lines:
            if line.get_label().startswith("_"):
                continue
            corners = axes.transData.transform(numpy.column_stack(line.get_data()))
            marked = line.get_marker() != "None"
            if marked:
                yield from ((corner + reach * numpy.array(side), MARKER_INK) for corner in corners for side in SIDES)
            if line.get_linestyle() == "None":
                continue
            for begin, end in zip(corners, corners[1:]):
                count = int(math.dist(begin, end) // 4)
                for part in range(1, count + 1):
                    yield begin + part / (count + 1) * (end - begin), 1 if marked else 0.4

    def within(self, box):
        left, right = (min(max(int(x), 0), self.sums.shape[0] - 1) for x in (box.left, box.right))
        bottom, top = (min(max(int(y), 0), self.sums.shape[1] - 1) for y in (box.bottom, box.top))
        return self.sums[right, top] - self.sums[left, top] - self.sums[right, bottom] + self.sums[left, bottom]


DIRECTIONS = [(math.cos(turn * math.pi / 8), math.sin(turn * math.pi / 8)) for turn in range(16)]
DISTANCES = (3, 6, 10, 15, 21, 28, 36, 45, 55, 67, 81, 97)  # points
LEADER_FROM = 10  # points; a label nearer than this needs no leader
AIR = 1.5  # points around a label
PASSES = 10
SIZE = 9
MARKER_INK = 3  # for the middle and each side of a marker; a line's dot has 1
SIDES = ((0, 0), (-1, 0), (1, 0), (0, -1), (0, 1))
MOST_POINTS = 5  # of a line, tried for its label
PLACES_KEPT = 80  # the cheapest of each label, before the labels are weighed against each other


def place_labels(axes, labels, size=SIZE, clear=2):
    """Writes each label near its place, clear of the lines, of the frame and of the other labels.

    Every label takes the cheapest of some places around its points, `clear` points off or more, in turns until
    nothing changes.
    """
    scale = axes.figure.dpi / 72
    ink, frame = Ink(axes), axes.get_window_extent()
    options = []
    for label in labels:
        half = half_size(axes, label.text, size)
        places = [place(at, tuple(axes.transData.transform(at)), half, direction, clear + distance, scale)
                  for at in label.points[::math.ceil(len(label.points) / MOST_POINTS)]
                  for distance in DISTANCES for direction in DIRECTIONS]
        priced = sorted(((lone_cost(spot, frame, ink, scale), index) for index, spot in enumerate(places)))
        options.append([(cost, places[index]) for cost, index in priced[:PLACES_KEPT]])
    for label, spot in zip(labels, choose_places(options, scale)):
        arrow = {"arrowstyle": "-", "color": darker(label.shade), "linewidth": 0.7, "shrinkA": 0, "shrinkB": 2.5}
        offset = [(to - begin) / scale for begin, to in zip(spot.anchor, spot.centre)]
        axes.annotate(label.text, spot.at, xytext=offset, textcoords="offset points", ha="center", va="center",
                      fontsize=size, zorder=6, color=darker(label.shade), annotation_clip=False,
                      arrowprops=arrow if spot.led else None,
                      bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6})


def half_size(axes, text, size):
    probe = axes.text(0, 0, text, fontsize=size)
    extent = probe.get_window_extent(axes.figure.canvas.get_renderer())
    probe.remove()
    return extent.width / 2, extent.height / 2


def place(at, anchor, half, direction, distance, scale):
    x, y = (start + towards * (reach + distance * scale) for start, towards, reach in zip(anchor, direction, half))
    box = Box(x - half[0], y - half[1], x + half[0], y + half[1])
    gap = math.hypot(max(box.left - anchor[0], anchor[0] - box.right, 0),
                     max(box.bottom - anchor[1], anchor[1] - box.top, 0))
    return Place(at, anchor, (x, y), box, gap > LEADER_FROM * scale)


def lone_cost(spot, frame, ink, scale):
    """Prices a place by what it hides, how far off and how awkward it is; other labels apart."""
    outside = sum(max(excess, 0) for excess in (frame.x0 + 3 - spot.box.left, spot.box.right - frame.x1,
                                                frame.y0 + 3 - spot.box.bottom, spot.box.top - frame.y1))
    crossed = sum(leader_cost(ink.within(Box(*dot, *dot).grown(2 * scale))) for dot in spot.leader()
                  if math.dist(dot, spot.anchor) > 6 * scale)
    away = math.dist(spot.anchor, spot.centre) / scale
    # To the right and below, where lines head for, a label is taken for its line's more readily.
    awkward = 4 * (1 - (0.9 * (spot.centre[0] - spot.anchor[0]) - 0.43 * (spot.centre[1] - spot.anchor[1]))
                   / math.dist(spot.anchor, spot.centre))
    hidden = 6 * ink.within(spot.box.grown(AIR * scale)) + 0.3 * ink.within(spot.box.grown(4 * AIR * scale))
    return hidden + 30 * outside + 0.6 * away + crossed + awkward


def leader_cost(ink):
    """Prices a part of a leader: across a line it may be followed, at a foreign marker it is taken for that one's."""
    return 80 if ink >= MARKER_INK else 8 if ink > 0 else 0


def choose_places(options, scale):
    """Returns a place for each label: the better outcome of settling them first to last and last to first."""
    outcomes = [settle(options, scale, order) for order in (range(len(options)), range(len(options))[::-1])]
    return min(outcomes, key=lambda outcome: outcome[0])[1]


def settle(options, scale, order):
    """Returns the total cost and the places after each label in turn took the best left by the others."""
    chosen = [places[0] for places in options]
    for _ in range(PASSES):
        before = list(chosen)
        for index in order:
            others = [spot for _, spot in chosen[:index] + chosen[index + 1:]]
            chosen[index] = min(options[index],
                                key=lambda priced: priced[0] + conflicts(priced[1], others, scale))
        if chosen == before:
            break
    spots = [spot for _, spot in chosen]
    total = sum(cost for cost, _ in chosen) + sum(conflicts(spot, spots[:index], scale)
                                                  for index, spot in enumerate(spots))
    return total, spots


def conflicts(spot, others, scale):
    total = 0.0
    room, leader = spot.box.grown(AIR * scale), spot.leader()
    for other in others:
        other_room = other.box.grown(AIR * scale)
        shared = room.overlap(other_room)
        total += 300 + 5 * shared if shared else 0
        total += 40 * min(sum(map(other_room.holds, leader)), 3) + 40 * min(sum(map(room.holds, other.leader())), 3)
        total += 60 * (spot.led and other.led and cross(spot, other))
    return total


def cross(one, other):
    """Tells whether two leaders cross each other."""
    def side(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    a, b, c, d = one.anchor, one.centre, other.anchor, other.centre
    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
