"""Places labels beside lines in a chart, clear of what is drawn and of each other.

A line named at its end is read faster than a legend; where ends crowd together, a label moves off and a thin leader
joins it to its line. Places are priced by what they hide, and labels take turns until none finds a better one.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Sequence, Tuple

import numpy
from matplotlib.colors import to_rgb


def darker(shade):
    """Returns a colour dark enough for small text on white."""
    return tuple(0.75 * part for part in to_rgb(shade))


LEADER_PARTS = [part / 20 for part in range(2, 20)]  # of the way, where what a leader crosses is looked up


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

    @property
    def edges(self):
        return self.left, self.bottom, self.right, self.top

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

    @cached_property
    def leader(self):
        if not self.led:
            return []
        (x, y), (to_x, to_y) = self.anchor, self.centre
        return [(x + (to_x - x) * part, y + (to_y - y) * part) for part in LEADER_PARTS]


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

    def within(self, left, bottom, right, top):
        """Returns the ink in each of some boxes, given by their edges."""
        left, right = (numpy.clip(edges.astype(int), 0, self.sums.shape[0] - 1) for edges in (left, right))
        bottom, top = (numpy.clip(edges.astype(int), 0, self.sums.shape[1] - 1) for edges in (bottom, top))
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
        priced = sorted((cost, index) for index, cost in enumerate(lone_costs(places, frame, ink, scale)))
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


def lone_costs(places, frame, ink, scale):
    """Prices each place by what it hides, how far off and how awkward it is; other labels apart."""
    left, bottom, right, top = numpy.array([spot.box.edges for spot in places]).T

    def around(air):
        return ink.within(left - air, bottom - air, right + air, top + air)
    hidden = 6 * around(AIR * scale) + 0.3 * around(4 * AIR * scale)
    return [over + leader + aside_cost(spot, frame, scale)
            for spot, over, leader in zip(places, hidden, leader_costs(places, ink, scale))]


def aside_cost(spot, frame, scale):
    """Prices how far a place reaches out of the frame, how far off it is and in what direction."""
    outside = sum(max(excess, 0) for excess in (frame.x0 + 3 - spot.box.left, spot.box.right - frame.x1,
                                                frame.y0 + 3 - spot.box.bottom, spot.box.top - frame.y1))
    away = math.dist(spot.anchor, spot.centre)
    # To the right and below, where lines head for, a label is taken for its line's more readily.
    awkward = 4 * (1 - (0.9 * (spot.centre[0] - spot.anchor[0]) - 0.43 * (spot.centre[1] - spot.anchor[1])) / away)
    return 30 * outside + 0.6 * away / scale + awkward


def leader_costs(places, ink, scale):
    """Prices what each place's leader crosses, away from its own point.

    Across a line a leader may be followed; at a foreign marker it is taken for that one's.
    """
    anchors = numpy.array([spot.anchor for spot in places])[:, None]
    dots = anchors + (numpy.array([spot.centre for spot in places])[:, None] - anchors) * numpy.array(LEADER_PARTS)[:, None]
    x, y = dots[..., 0], dots[..., 1]
    crossed = ink.within(x - 2 * scale, y - 2 * scale, x + 2 * scale, y + 2 * scale)
    own = numpy.hypot(*numpy.moveaxis(dots - anchors, -1, 0)) <= 6 * scale
    led = numpy.array([[spot.led] for spot in places])
    return numpy.where(led & ~own, numpy.where(crossed >= MARKER_INK, 80, 8 * (crossed > 0)), 0).sum(axis=1)


def choose_places(options, scale):
    """Returns a place for each label: the better outcome of settling them first to last and last to first."""
    conflicts = Conflicts(options, scale)
    outcomes = [settle(options, conflicts, order) for order in (range(len(options)), range(len(options))[::-1])]
    return min(outcomes, key=lambda outcome: outcome[0])[1]


def settle(options, conflicts, order):
    """Returns the total cost and the places after each label in turn took the best left by the others."""
    chosen = [0] * len(options)
    for _ in range(PASSES):
        before = list(chosen)
        for label in order:
            others = [(other, chosen[other]) for other in range(len(options)) if other != label]
            chosen[label] = min(range(len(options[label])),
                                key=lambda option: options[label][option][0] + conflicts.of((label, option), others))
        if chosen == before:
            break
    taken = list(enumerate(chosen))
    total = sum(options[label][option][0] + conflicts.of((label, option), taken[:label]) for label, option in taken)
    return total, [options[label][option][1] for label, option in taken]


class Conflicts:
    """Prices how labels at two places stand in each other's way. Each pair of places is priced once.

    A place is named by its label's index and its own among the options of that label.
    """

    def __init__(self, options, scale):
        self.spots = [[spot for _, spot in places] for places in options]
        self.rooms = [[spot.box.grown(AIR * scale) for spot in places] for places in self.spots]
        self.known = {}

    def of(self, one, others):
        return sum(self.between(one, other) for other in others)

    def between(self, one, other):
        pair = (one, other) if one < other else (other, one)
        if pair not in self.known:
            self.known[pair] = self.price(*pair)
        return self.known[pair]

    def price(self, one, other):
        (spot, room), (other_spot, other_room) = ((self.spots[label][option], self.rooms[label][option])
                                                  for label, option in (one, other))
        shared = room.overlap(other_room)
        return ((300 + 5 * shared if shared else 0)
                + 40 * min(sum(map(other_room.holds, spot.leader)), 3)
                + 40 * min(sum(map(room.holds, other_spot.leader)), 3)
                + 60 * (spot.led and other_spot.led and cross(spot, other_spot)))


def cross(one, other):
    """Tells whether two leaders cross each other."""
    def side(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    a, b, c, d = one.anchor, one.centre, other.anchor, other.centre
    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
