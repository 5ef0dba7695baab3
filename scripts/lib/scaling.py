"""Reads what build/benchmarks/scaling wrote: what a step of the fast forms costs against n, and idea by idea.

Everything is checked before anything is used.
"""

import statistics
from dataclasses import dataclass, replace
from typing import Dict, List, Tuple

import raw_files
from benchmark_json import FORMULATIONS, LONGEST_SECONDS, SHORTEST_SECONDS, UnusableFile
from raw_files import Fields, objects

FORMAT = "isosyrk scaling 2"
FLOPS = 8  # of a product of complex n x n matrices, for each of its n³ terms
PUBLISHED, BY_DEFAULT = "published", "by default"


@dataclass(frozen=True)
class Cost:
    """What a step of one cell takes."""

    formulation: str
    stages: int
    n: int
    step: float
    seconds: float  # median of the repetitions
    sweeps: float
    products: float  # in full ones
    product_seconds: float
    peak: float  # floating point operations a second
    rung: bool = False  # of the ladder from the published form to the default, each with one idea more

    @property
    def cubic(self):
        """The seconds of the products, at the rate of products alone."""
        return self.products * self.product_seconds

    @property
    def floor(self):
        """The seconds of the operations that its products need, at the core's peak."""
        return self.products * FLOPS * self.n**3 / self.peak


@dataclass(frozen=True)
class Scaling:
    context: Dict[str, str]
    kernels: str
    h_norm_B: float
    points: List[Cost]
    ideas: Dict[Tuple[str, int, int], Dict[str, Cost]]  # by formulation, n, s; then by idea, in order

    def line(self, formulation, stages):
        """Returns the points of one cell, by n."""
        return sorted((point for point in self.points if (point.formulation, point.stages) == (formulation, stages)),
                      key=lambda point: point.n)

    def stage_counts(self):
        return sorted({point.stages for point in self.points})

    def sizes(self):
        return sorted({point.n for point in self.points})

    def idea_sizes(self):
        return sorted({n for _, n, _ in self.ideas})


def read_scaling(path):
    return raw_files.read(path, scaling)


def scaling(document):
    context = raw_files.context(document, FORMAT)
    head = Fields(document, "it")
    points = [cost(values, f"point {index + 1}") for index, values in enumerate(objects(document, "points"))]
    if not points:
        raise UnusableFile("has no points")
    if len({(each.formulation, each.stages, each.n) for each in points}) < len(points):
        raise UnusableFile("has two points of one cell")
    ideas = {}
    for index, values in enumerate(objects(document, "ideas")):
        found = cost(values, f"idea {index + 1}")
        name = Fields(values, f"idea {index + 1}").text("idea")
        cell = ideas.setdefault((found.formulation, found.n, found.stages), {})
        if name in cell:
            raise UnusableFile(f"has the idea {name} twice for one cell")
        cell[name] = replace(found, rung=Fields(values, f"idea {index + 1}").truth("rung"))
    for cell in ideas.values():
        if PUBLISHED not in cell or BY_DEFAULT not in cell:
            raise UnusableFile(f"has a cell of ideas without {PUBLISHED} or {BY_DEFAULT}")
    return Scaling(context, head.text("kernels"), head.positive("h_norm_B"), points, ideas)


def cost(values, what):
    fields = Fields(values, what)
    return Cost(fields.one_of("formulation", FORMULATIONS), fields.whole("stages", 1), fields.whole("n", 2),
                fields.positive("step"), median_time(fields, "seconds_per_step"), fields.positive("sweeps_per_step"),
                fields.positive("equivalent_products_per_step"), median_time(fields, "product_seconds"),
                1e9 * median_of(fields, "peak_gflops"))


def median_of(fields, field):
    values = fields.numbers(field)
    if not values or min(values) < raw_files.SMALLEST:
        fields.refuse(field, "a list of positive numbers")
    return statistics.median(values)


def median_time(fields, field):
    time = median_of(fields, field)
    if not SHORTEST_SECONDS <= time <= LONGEST_SECONDS:
        fields.refuse(field, "a list of possible times")
    return time


def ladder(cell):
    """Returns the rungs from the published form to the fast form by default: (idea, cost), each with one idea more."""
    return [(name, cost) for name, cost in cell.items() if cost.rung]
