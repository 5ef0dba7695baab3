"""Reads what build/benchmarks/work_precision wrote, and says what its lines show: floors and observed orders.

A line is one integrator at one n, a point one run of it. Everything is checked before anything is used.
"""

import math
import statistics
from dataclasses import dataclass
from typing import Dict, List, Optional, Tuple

import raw_files
from benchmark_json import FORMULATIONS, LONGEST_SECONDS, SHORTEST_SECONDS, UnusableFile, quoted
from raw_files import CASIMIRS, CONVERGED, STATUSES, Fields, objects, unique

FORMAT = "isosyrk work_precision 1"
TABLE1_STEP = 0.1  # the step size of Table 1, where the tolerances were varied too

# A line has reached its floor where the error is within this of the reference's uncertainty, ...
FLOOR_MARGIN = 10
# ... or where, below NEAR_ROUNDING, the next step size does not lower it to this share.
NEAR_ROUNDING = 1e-8
STILL_FALLING = 0.8
# Points that an observed order is fitted on, those of the smallest steps above the floor: an order is what errors tend
# to. Fewer do not tell one.
ORDER_POINTS = 3


@dataclass(frozen=True)
class Integrator(raw_files.Integrator):
    stability_limit: Optional[float]  # largest stable h‖ad_B‖₂; None if there is none


@dataclass(frozen=True)
class Reference:
    n: int
    uncertainty: float  # relative, as the error of a point
    integrators: Tuple[str, str]
    steps: Tuple[int, int]


@dataclass(frozen=True)
class Costs:
    sweeps: int
    products: int
    poisson_solves: int
    cpu_seconds: Tuple[float, ...]  # one for each repetition; none for a run that failed

    @property
    def seconds(self):
        return statistics.median(self.cpu_seconds)


@dataclass(frozen=True)
class Quality:
    """What a run came to; errors are None where it did not come to a usable end."""

    n: int
    steps: int
    step: float
    status: str
    error: Optional[float]  # ‖W(T) − reference‖_F / ‖reference‖_F
    spectrum_error: Optional[float]
    casimir_errors: Optional[Tuple[float, ...]]  # k = 2 … 5
    energy_error: Optional[float]
    angular_momentum_error: Optional[float]
    skew_defect: Optional[float]

    @property
    def usable(self):
        return self.status == CONVERGED


@dataclass(frozen=True)
class Point:
    integrator: str
    quality: Quality
    costs: Costs
    h_norm_B: float
    h_norm_ad_B: float
    beyond_limit: bool  # the step is longer than the integrator is stable for


@dataclass(frozen=True)
class TolerancePoint:
    formulation: str
    stages: int
    tolerance: float
    solver_error: Optional[float]  # distance from the tightest tolerance that converged, relative
    quality: Quality
    costs: Costs


@dataclass(frozen=True)
class Study:
    context: Dict[str, str]
    time: float
    references: Dict[int, Reference]
    integrators: Dict[str, Integrator]
    points: List[Point]
    tolerance_points: List[TolerancePoint]

    def sizes(self):
        return sorted(self.references)

    def line(self, integrator, n):
        """Returns all points of a line, the longest step first, failures included."""
        points = [point for point in self.points if point.integrator == integrator and point.quality.n == n]
        return sorted(points, key=lambda point: point.quality.steps)

    def above_floor(self, integrator, n):
        """Returns the usable points of a line down to where its error reaches the floor."""
        least = FLOOR_MARGIN * self.references[n].uncertainty
        kept = []
        for point in self.line(integrator, n):
            error = point.quality.error
            if not point.quality.usable:
                continue
            if error < least:
                break
            if kept and kept[-1].quality.error < NEAR_ROUNDING and error > STILL_FALLING * kept[-1].quality.error:
                break
            kept.append(point)
        return kept

    def observed_order(self, integrator, n):
        """Fits the slope of log error over log step on the last points above the floor; None for too few."""
        points = self.above_floor(integrator, n)[-ORDER_POINTS:]
        steps = [math.log(point.quality.step) for point in points]
        if len(set(steps)) < ORDER_POINTS:
            return None
        slope, _ = statistics.linear_regression(steps, [math.log(point.quality.error) for point in points])
        return slope

    def at_step(self, integrator, n, step):
        """Returns the point of this step size, or None."""
        return next((point for point in self.line(integrator, n)
                     if math.isclose(point.quality.step, step, rel_tol=1e-9)), None)


# ---- reading


def read_study(path):
    """Returns the Study in `path`. Throws UnusableFile with one line that names the file and what is wrong."""
    return raw_files.read(path, study)


def study(document):
    context = raw_files.context(document, FORMAT)
    references = [reference(Fields(each, "a reference")) for each in objects(document, "references")]
    integrators = [integrator(Fields(each, "an integrator")) for each in objects(document, "integrators")]
    top = Fields(document, "the file")
    result = Study(context, top.positive("time"), unique(references, "n"),
                   unique(integrators, "name"),
                   [point(Fields(each, "a point")) for each in objects(document, "points")],
                   [tolerance_point(Fields(each, "a tolerance point"))
                    for each in objects(document, "tolerance_points")])
    check_names(result)
    return result


def check_names(result):
    for each in result.points:
        if each.integrator not in result.integrators:
            raise UnusableFile(f"has a point of an integrator it does not list, {quoted(each.integrator)}")
    for each in [*result.points, *result.tolerance_points]:
        if each.quality.n not in result.references:
            raise UnusableFile(f"has a point at n = {each.quality.n}, for which it has no reference")
        if not math.isclose(each.quality.steps * each.quality.step, result.time, rel_tol=1e-9):
            raise UnusableFile(f"has a point of {each.quality.steps} steps of {each.quality.step:g}, which do not"
                               f" come to the time {result.time:g}")
    seen = set()
    for each in result.points:
        key = (each.integrator, each.quality.n, each.quality.steps)
        if key in seen:
            raise UnusableFile(f"has {each.integrator} at n = {key[1]} with {key[2]} steps twice")
        seen.add(key)


def reference(fields):
    runs = fields.object("first"), fields.object("second")
    return Reference(fields.whole("n", 2), fields.positive("uncertainty"),
                     tuple(run.text("integrator") for run in runs), tuple(run.whole("steps", 1) for run in runs))


def integrator(fields):
    return Integrator(*raw_files.properties(fields), fields.optional("stability_limit"))


def quality(fields):
    status = fields.one_of("status", STATUSES)
    usable = status == CONVERGED
    names = ("error", "spectrum_error", "energy_error", "angular_momentum_error", "skew_defect")
    values = {name: fields.positive(name) if usable and name == "error" else fields.optional(name) for name in names}
    if usable and None in values.values():
        raise UnusableFile(f"{fields.what} is {CONVERGED} and has no value of"
                           f" {', '.join(name for name in names if values[name] is None)}")
    casimirs = fields.numbers("casimir_errors", len(CASIMIRS)) if usable else None
    return Quality(n=fields.whole("n", 2), steps=fields.whole("steps", 1), step=fields.positive("step"),
                   status=status, casimir_errors=casimirs, **(values if usable else dict.fromkeys(names)))


def costs(fields):
    found = Costs(fields.whole("sweeps"), fields.whole("products"), fields.whole("poisson_solves"),
                  fields.numbers("cpu_seconds"))
    usable = fields.get("status") == CONVERGED
    possible = all(SHORTEST_SECONDS <= seconds <= LONGEST_SECONDS for seconds in found.cpu_seconds)
    if usable and not (found.cpu_seconds and possible):
        fields.refuse("cpu_seconds", f"at least one time, all from {SHORTEST_SECONDS:g} to {LONGEST_SECONDS:g} s,")
    return found


def point(fields):
    return Point(fields.text("integrator"), quality(fields), costs(fields), fields.not_negative("h_norm_B"),
                 fields.not_negative("h_norm_ad_B"), fields.truth("beyond_limit"))


def tolerance_point(fields):
    usable = fields.get("status") == CONVERGED
    return TolerancePoint(fields.one_of("formulation", FORMULATIONS), fields.whole("stages", 1), fields.positive("tolerance"),
                          fields.not_negative("solver_error") if usable else None, quality(fields), costs(fields))
