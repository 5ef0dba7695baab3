"""The raw file of scripts/studies/scaling.py and its figures: what a step costs against n, and what each idea buys."""

import itertools
import math
import re
import statistics
from typing import NamedTuple

from lib import formats
from lib.formats import (FAST, FORMULATIONS, PUBLISHED, SOLVERS, Schema, keyed, list_of, number, one_of, optional,
                         positive, text, whole)
from lib.integrator_names import TABLE1_CELLS, frameless, is_exponential
from lib.messages import UnusableFile
from lib.trend import trend_of
from lib.verdicts import ratio_of

# The ideas of fast forms by family, as the module names them.
GAUSS_IDEAS = ("bands", "predictor", "newton")  # of all implicit methods but exponential ones
EXPLICIT_IDEAS = ("bands",)
LIE_POISSON = "elp"
FAMILIES = {
    LIE_POISSON: ("bands", "predictor", "newton", "explicit_start", "error_estimates", "single_precision",
                  "graded_series"),
    "magnus": ("bands",),  # and single precision, from a tolerance of 1e-6 on
    "rkmk": ("bands", "single_precision", "graded_series"),
}

# A rung: the published form, or the fast form without these ideas; ANY stands for all that a method has.
ANY = "without any"
RUNGS = {
    PUBLISHED: (),
    ANY: (),
    "without newton": ("newton",),
    "without predictor": ("predictor",),
    "without explicit start": ("explicit_start",),
    "without either start": ("predictor", "explicit_start"),
    "without estimates": ("error_estimates",),
    "without single precision": ("single_precision",),
    "without graded series": ("graded_series",),
    "without bands": ("bands",),
    FAST: (),
}
BANDS = "without bands"
BASIC = (PUBLISHED, BANDS, FAST)  # the rungs of an integrator whose ideas are not told apart
STAGES = (1, 2, 3)  # of the cells of Table 1

# The lines of a step's time against n, all in the co-rotating frame, and the sizes between which they have a slope.
LINES = ("algebra1_frame", "group2_frame", "elp4_frame", "rk4_frame")
ROUGH = "rough"  # the scene of the further raw file, of which the lines alone are told
SMALLEST_SLOPE = 65
WITH_PRODUCTS = 257  # the least n whose equivalent products are figures too


class Settings(NamedTuple):
    scene: text
    warmup: positive  # time that a form with a memory runs before the timed steps


class Point(NamedTuple):
    """A rung of an integrator at one n, on steps from one time on; costs are those of a step, or None if one fails."""

    start: positive  # time of the state from which the timed steps start
    n: whole(2)
    integrator: text
    rung: one_of(*RUNGS)
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


class Threads(NamedTuple):
    """A fast form on one thread and on two: seconds that pass for a step, one entry a process, in the same order."""

    start: positive
    n: whole(2)
    integrator: text
    step: positive
    tolerance: positive
    one: list_of(positive)
    two: list_of(positive)


SCHEMA = Schema("scaling", Settings, {"points": Point, "rates": Rate, "memory": Memory, "threads": Threads})


# ---- rungs


def family_of(integrator):
    """Returns the family of an integrator with ideas of its own, in the frame or not, or None for any other."""
    match = re.match("[a-z]+", integrator)
    return match[0] if match and match[0] in FAMILIES else None


def ideas_of(integrator, explicit):
    """Returns the ideas that the fast form of an integrator has."""
    family = family_of(integrator)
    if family:
        return FAMILIES[family]
    return EXPLICIT_IDEAS if explicit else GAUSS_IDEAS


def without(integrator, explicit, rung):
    """Returns what the fast form of an integrator goes without on a rung."""
    return ideas_of(integrator, explicit) if rung == ANY else RUNGS[rung]


def rungs_of(integrator, explicit):
    """Returns the rungs of an integrator: all for a cell of Table 1 and for a family, BASIC for others.

    ANY is left out where it is the same as BANDS.
    """
    if integrator not in TABLE1_CELLS and (family_of(integrator) is None or frameless(integrator) != integrator):
        return BASIC
    ideas = {*ideas_of(integrator, explicit)}
    return tuple(rung for rung, gone in RUNGS.items() if {*gone} <= ideas and (rung != ANY or len(ideas) > 1))


# ---- reading


class Scaling:
    """A raw file, with its points by (start, n, integrator, rung)."""

    def __init__(self, study):
        """Throws UnusableFile for a study without points, or with costs that contradict each other."""
        self.context, self.settings = study.context, study.settings
        self.points = keyed(study.tables["points"], "start", "n", "integrator", "rung")
        self.rates = keyed(study.tables["rates"], "n", "solver")
        self.memory, self.threads = study.tables["memory"], study.tables["threads"]
        if not self.points:
            raise UnusableFile("has no points")
        for point in self.points.values():
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

    def ratios(self, start, n, name, rung):
        """Returns the times of a rung over those of the fast form, each within a round; none where one failed."""
        theirs, ours = (self.points.get((start, n, name, each)) for each in (rung, FAST))
        return [first / second for first, second in zip(theirs.seconds, ours.seconds)] if theirs and ours else []

    def gain(self, start, n, rung, names):
        """Returns the geometric mean, over integrators, of a rung's time over the fast form's; None without any."""
        found = [self.ratios(start, n, name, rung) for name in names]
        medians = [statistics.median(each) for each in found if each]
        return statistics.geometric_mean(medians) if medians else None

    def share_of_products(self, point):
        """Returns the part of a step's time that its products take by themselves; None if that is not known."""
        rate = self.rates.get((point.n, PUBLISHED if point.rung == PUBLISHED else FAST))
        if not (rate and point.seconds):
            return None
        return point.equivalent_products * statistics.median(rate.seconds) / point.time

    def line(self, start, name, rung):
        """Returns the points of a line against n that did not fail, the smallest n first."""
        found = [self.points.get((start, n, name, rung)) for n in self.sizes(start)]
        return [point for point in found if point and point.seconds]

    def singles(self):
        return [point for point in self.points.values() if point.is_single]

    def trend(self):
        """Returns the Trend of all repetitions with their order, or None."""
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
    """Returns the integrators of a study whose ideas are those of exponential methods; RKMK4 is one."""
    return [name for name in study.integrators() if family_of(name) and frameless(name) == name]


def lie_poisson(study):
    return [name for name in exponential(study) if family_of(name) == LIE_POISSON]


# ---- figures


def figures(study, rough=None):
    """Returns the figures that pages may quote, by key. `rough` is None or the Scaling of the rough scene.

    RUNG.nN.tT[.FORM] and exponential.RUNG.nN.tT[.NAME] are gains of the fast forms. step.*, share.* and slope.* are of
    the lines against n: milliseconds, part of the products, power of n; per_time.* seconds a unit of time, whose steps
    differ with n; products.* the equivalent products of a step; rough.* the same of the rough scene. bands.* are gains
    by bands on lines; threads.* gains by a second thread with their intervals; trend.* tells of all repetitions, single
    of single timings.
    """
    found = line_figures(study)
    if rough:
        found.update({f"{ROUGH}.{key}": value for key, value in line_figures(rough).items()})
    for start in study.starts():
        found.update(gain_figures(study, start))
    ideas = [mean for key, mean in found.items() if key.startswith("without") and key.endswith(FORMULATIONS)]
    if ideas:
        found["costliest_idea"] = max(0.0, 1 / min(ideas) - 1)
    for row in study.threads:
        key, ratio = f"threads.{row.integrator}.n{row.n}.t{row.start:g}", ratio_of(row.one, row.two)
        found[key] = ratio.ratio
        if math.isfinite(ratio.high):
            found.update({f"{key}.low": ratio.low, f"{key}.high": ratio.high})
    found.update({f"memory.n{row.n}": row.peak_bytes / 1e9 for row in study.memory})
    found.update({"points": len(study.points), "single": len(study.singles())})
    trend = study.trend()
    return {**found, **({f"trend.{name}": value for name, value in trend._asdict().items()} if trend else {})}


def gain_figures(study, start):
    """Returns the gains of the fast forms from one start, where there are any."""
    groups = {"": cells(), **{f".{form}": cells((form,)) for form in FORMULATIONS}}
    exponential_groups = {"": lie_poisson(study), **{f".{name}": [name] for name in exponential(study)}}
    found = {}
    for n in study.sizes(start):
        where = f"n{n}.t{start:g}"
        for rung in RUNGS:
            if rung == FAST:
                continue
            key = rung.replace(" ", "_")
            found.update({f"{key}.{where}{suffix}": study.gain(start, n, rung, names)
                          for suffix, names in groups.items()})
            found.update({f"exponential.{key}.{where}{suffix}": study.gain(start, n, rung, names)
                          for suffix, names in exponential_groups.items()})
        found.update({f"bands.{where}.{name}": study.gain(start, n, BANDS, [name]) for name in LINES})
        found.update({f"published_line.{where}.{name}": study.gain(start, n, PUBLISHED, [name]) for name in LINES})
    return {key: mean for key, mean in found.items() if mean}


def line_figures(study):
    """Returns what a step costs on each of the lines, and their slopes."""
    found = {}
    for start, name, rung in itertools.product(study.starts(), LINES, (PUBLISHED, FAST)):
        line = study.line(start, name, rung)
        for point in line:
            found.update(step_figures(study, point))
        if ends := slope_ends(line):
            found[f"slope.{name}.{rung}.n{ends[0].n}_n{ends[1].n}.t{start:g}"] = slope(*ends)
    return found


def step_figures(study, point):
    """Returns the milliseconds of a step, the seconds of a unit of time, and the share of products if it is known.

    From WITH_PRODUCTS on the equivalent products of a step too.
    """
    where, share = f"{point.integrator}.{point.rung}.n{point.n}.t{point.start:g}", study.share_of_products(point)
    return {f"step.{where}": 1e3 * point.time, f"per_time.{where}": point.time / point.step,
            **({f"products.{where}": point.equivalent_products} if point.n >= WITH_PRODUCTS else {}),
            **({f"share.{where}": share} if share is not None else {})}


def slope_ends(line):
    """Returns the points between which a line has its slope: SMALLEST_SLOPE and its largest n. None without both."""
    first = next((point for point in line if point.n == SMALLEST_SLOPE), None)
    return (first, line[-1]) if first and line[-1].n > first.n else None


def slope(first, last):
    """Returns the power of n with which the time of a step grows between two points."""
    return math.log(last.time / first.time) / math.log(last.n / first.n)


def long_step(integrator):
    """Tells whether an integrator is timed at the long step and the loose tolerance of exponential methods."""
    return is_exponential(integrator) or family_of(integrator) is not None
