"""The raw file of the study `scaling` and its figures: what a step costs against n, and ablations."""

import math
import statistics
from typing import NamedTuple

from lib.programs.messages import UnusableFile
from lib.records import formats
from lib.records.formats import (FAST, FORMULATIONS, INTEGRATORS, PUBLISHED, SOLVERS, Integrator, Schema, keyed,
                                 list_of, number, one_of, optional, positive, text, whole)
from lib.records.integrators import EXPONENTIAL, MAGNUS, RKMK, TABLE1_CELLS, chosen, is_new

# The parts of fast forms, as the module names them: of families with parts of their own, and of others.
PARTS = {EXPONENTIAL: ("bands", "predictor", "newton", "explicit_start", "error_estimates", "graded_series"),
         MAGNUS: ("bands",), RKMK: ("bands", "graded_series")}
GAUSS_PARTS = ("bands", "predictor", "newton")  # of all other implicit methods
EXPLICIT_PARTS = ("bands",)

# An ablation: the published form, or the fast form without these parts; ANY stands for all that a method has, GONE for
# what fast forms no longer have an option to go without: only older files have that ablation.
ANY, GONE = "without any", None
ABLATIONS = {
    PUBLISHED: (),
    ANY: (),
    "without newton": ("newton",),
    "without predictor": ("predictor",),
    "without explicit start": ("explicit_start",),
    "without either start": ("predictor", "explicit_start"),
    "without estimates": ("error_estimates",),
    "without single precision": GONE,
    "without graded series": ("graded_series",),
    "without bands": ("bands",),
    FAST: (),
}
BANDS = "without bands"
BASIC = (PUBLISHED, BANDS, FAST)  # the ablations of an integrator whose parts are not told apart
STAGES = (1, 2, 3)  # of the cells of Table 1

# The methods with a line of a step's time against n, all in the co-rotating frame; new integrators have one too.
LINES = ("algebra1", "group2", "elp4", "rk4")
ROUGH = "rough"  # the scene of the further raw file, of which the lines alone are told
SMALLEST_SLOPE = 65  # n from which lines have a slope
WITH_PRODUCTS = 257  # the least n whose equivalent products are figures too


class Settings(NamedTuple):
    scene: text
    warmup: positive  # time that a form with a memory runs before the timed steps


class Point(NamedTuple):
    """An ablation of an integrator at one n, on steps from one time on; costs are of a step, or None if one fails."""

    start: positive  # time of the state from which the timed steps start
    n: whole(2)
    integrator: text
    ablation: one_of(*ABLATIONS)
    step: positive
    tolerance: positive
    steps: whole(1)  # that are timed
    sweeps: optional(number)
    equivalent_products: optional(number)
    seconds: list_of(positive)  # CPU time, one for each repetition, each of the same steps; none if one fails

    @property
    def time(self):
        """Returns the CPU seconds of a step, the median of the repetitions; None if a step fails."""
        return statistics.median(self.seconds) if self.seconds else None

    @property
    def is_single(self):
        return len(self.seconds) == 1


class Rate(NamedTuple):
    """The CPU seconds of a product of n × n matrices by itself, one for each repetition."""

    n: whole(2)
    solver: one_of(*SOLVERS)
    seconds: list_of(positive)


class Memory(NamedTuple):
    n: whole(2)
    peak_bytes: positive  # of the process that times, up to and with this n


class TwoThreads(NamedTuple):
    """Of older files: a fast form on one thread and on two.

    The seconds that pass for a step have an entry a process, in the same order.
    """

    start: positive
    n: whole(2)
    integrator: text
    step: positive
    tolerance: positive
    one: list_of(positive)
    two: list_of(positive)


SCHEMA = Schema("scaling", Settings, {INTEGRATORS: Integrator, "points": Point, "rates": Rate, "memory": Memory,
                                      "threads": TwoThreads}, later=(INTEGRATORS, "threads"),
                renamed={"rung": "ablation"})


# ---- ablations


def has_own_parts(integrator):
    """Tells whether an Integrator is of a family with parts of its own, which are told apart outside the frame."""
    return integrator.family in PARTS and not integrator.co_rotating


def parts_of(integrator):
    """Returns the parts that the fast form of an Integrator has."""
    return PARTS.get(integrator.family, EXPLICIT_PARTS if integrator.explicit else GAUSS_PARTS)


def without(integrator, ablation):
    """Returns what the fast form of an Integrator goes without on an ablation."""
    return parts_of(integrator) if ablation == ANY else ABLATIONS[ablation]


def ablations_of(integrator):
    """Returns the ablations of an Integrator: all for a cell of Table 1 and for a family with parts, BASIC for others.

    ANY is left out where it is the same as BANDS.
    """
    if not integrator.has_fast_form:
        return (PUBLISHED,)
    if integrator.name not in TABLE1_CELLS and not has_own_parts(integrator):
        return BASIC
    parts = {*parts_of(integrator)}
    return tuple(ablation for ablation, gone in ABLATIONS.items()
                 if gone is not GONE and {*gone} <= parts and (ablation != ANY or len(parts) > 1))


def lines_of(integrators):
    """Returns the names of those Integrators that have a line of a step's time against n."""
    return [name for name, each in chosen(integrators, LINES, in_frame=True).items()
            if each.co_rotating or is_new(each)]


# ---- reading


class Scaling:
    """A raw file, with its points by (start, n, integrator, ablation)."""

    def __init__(self, study):
        """Throws UnusableFile for a study without points, or with costs that contradict each other."""
        self.context, self.settings = study.context, study.settings
        self.points = keyed(study.tables["points"], "start", "n", "integrator", "ablation")
        self.identities = keyed(study.tables[INTEGRATORS], "name")
        self.lines = lines_of(self.identities.values())
        self.rates = keyed(study.tables["rates"], "n", "solver")
        self.memory, self.threads = study.tables["memory"], study.tables["threads"]
        if not self.points:
            raise UnusableFile("has no points")
        for point in self.points.values():
            if point.integrator not in self.identities:
                raise UnusableFile(f"has points of {point.integrator} without its integrator")
            if (point.sweeps is None) == bool(point.seconds):
                raise UnusableFile("has a point with sweeps and no time, or with times and no sweeps")
        for row in self.threads:
            if not row.one or len(row.one) != len(row.two):
                raise UnusableFile("has a row of threads whose two sides are not of the same processes")

    def starts(self):
        return sorted({start for start, *_ in self.points})

    def sizes(self, start=None, integrators=None):
        """Returns the n of all points, or of those from a start, or of some integrators."""
        return sorted({n for begin, n, name, _ in self.points
                       if start in (None, begin) and (integrators is None or name in integrators)})

    def integrators(self):
        return list(dict.fromkeys(name for _, _, name, _ in self.points))

    def ratios(self, start, n, name, ablation):
        """Returns the times of an ablation over those of the fast form, each within a round; none where one failed."""
        theirs, ours = (self.points.get((start, n, name, each)) for each in (ablation, FAST))
        return [first / second for first, second in zip(theirs.seconds, ours.seconds)] if theirs and ours else []

    def gain(self, start, n, ablation, names):
        """Returns the geometric mean, over integrators, of an ablation's time over the fast form's, or None."""
        found = [self.ratios(start, n, name, ablation) for name in names]
        medians = [statistics.median(each) for each in found if each]
        return statistics.geometric_mean(medians) if medians else None

    def share_of_products(self, point):
        """Returns the part of a step's time that its products take by themselves; None if that is not known."""
        rate = self.rates.get((point.n, PUBLISHED if point.ablation == PUBLISHED else FAST))
        if not (rate and point.seconds):
            return None
        return point.equivalent_products * statistics.median(rate.seconds) / point.time

    def line(self, start, name, ablation):
        """Returns the points of a line against n that did not fail, the smallest n first."""
        found = [self.points.get((start, n, name, ablation)) for n in self.sizes(start)]
        return [point for point in found if point and point.seconds]

    def singles(self):
        return [point for point in self.points.values() if point.is_single]

    def trend(self):
        """Returns the Trend of all repetitions with their order, or None."""
        from lib.judging.trend import trend_of  # only now: who measures need not have SciPy
        return trend_of([point.seconds for point in self.points.values()])


def read_scaling(path):
    """Returns the Scaling in a raw file. Throws UnusableFile with one line that names the file."""
    return formats.read_study(path, SCHEMA, Scaling)


def read_rough(path):
    """Returns the Scaling in a raw file of the rough scene. Throws UnusableFile with one line that names the file."""
    return formats.read_study(path, SCHEMA, rough_of)


def rough_of(study):
    if study.settings.scene != ROUGH:
        raise UnusableFile(f"is of the {study.settings.scene} scene, not of the {ROUGH} one")
    return Scaling(study)


# ---- groups of integrators whose gains are averaged


def cells(forms=FORMULATIONS):
    """Returns the integrators of Table 1 in some formulations."""
    return [f"{form}{s}" for form in forms for s in STAGES]


def exponential(study):
    """Returns the integrators of a study whose parts are those of exponential methods; RKMK4 is one."""
    return [name for name in study.integrators() if has_own_parts(study.identities[name])]


def lie_poisson(study):
    return [name for name in exponential(study) if study.identities[name].family == EXPONENTIAL]


# ---- figures


def slope_ends(line):
    """Returns the points between which a line has its slope: SMALLEST_SLOPE and its largest n. None without both."""
    first = next((point for point in line if point.n == SMALLEST_SLOPE), None)
    return (first, line[-1]) if first and line[-1].n > first.n else None


def slope(first, last):
    """Returns the power of n with which the time of a step grows between two points."""
    return math.log(last.time / first.time) / math.log(last.n / first.n)
