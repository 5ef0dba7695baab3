"""Reads what build/benchmarks/stability and build/benchmarks/long_runs wrote: failures, and errors over time.

A trial is a short run with one step size; the map of one integrator in one setting (a scene at one n) has trials on a
grid of h‖B‖₂, and the bracket that bisection left around the critical value. ‖B‖₂ is taken at the initial data.
"""

from dataclasses import dataclass
from typing import Callable, Dict, List, Optional, Tuple

import raw_files
from benchmark_json import UnusableFile, quoted
from raw_files import CASIMIRS, CONVERGED, LARGEST, STATUSES, Fields, Integrator, is_number, objects, unique

MAP_FORMAT = "isosyrk stability 1"
LONG_RUNS_FORMAT = "isosyrk long_runs 1"
SCENES = ("smooth", "rough")
ROUNDING = 1e-12  # what rounding leaves in 10⁴ steps, as a relative error


@dataclass(frozen=True)
class Trial:
    """A short run; its errors are None where it did not come to a finite end."""

    h_norm_B: float
    step: float
    status: str
    steps: int
    sweeps_per_step: Optional[float]
    spectrum_error: Optional[float]
    skew_defect: Optional[float]
    energy_error: Optional[float]
    failed_step: Optional[int]

    @property
    def works(self):
        return self.status == CONVERGED


@dataclass(frozen=True)
class Critical:
    works: Trial  # with the largest step size that does
    fails: Trial  # with the smallest that does


@dataclass(frozen=True)
class Setting:
    scene: str
    n: int
    norm_B: float
    explicit_steps: int  # of a trial
    implicit_steps: int


@dataclass(frozen=True)
class Map:
    scene: str
    n: int
    integrator: str
    linear_limit: Optional[float]  # h‖B‖₂ beyond which linear theory, B frozen at B(W₀), says that it fails
    trials: Tuple[Trial, ...]  # h‖B‖₂ rising
    critical: Optional[Critical]  # None where no trial failed, or none worked

    @property
    def always_works(self):
        return all(trial.works for trial in self.trials)

    @property
    def largest_working(self):
        """The largest h‖B‖₂ below every failure that was tried; None if there is none."""
        if self.critical:
            return self.critical.works.h_norm_B
        return self.trials[-1].h_norm_B if self.always_works else None

@dataclass(frozen=True)
class FailureMap:
    context: Dict[str, str]
    max_sweeps: int
    integrators: Dict[str, Integrator]
    settings: Dict[Tuple[str, int], Setting]
    maps: Dict[Tuple[str, int, str], Map]

    def scenes(self):
        return [scene for scene in SCENES if any(scene == known for known, _ in self.settings)]

    def sizes(self, scene):
        return sorted(n for known, n in self.settings if known == scene)

    def at(self, scene, n, integrator):
        """Returns the map of an integrator in a setting, or None."""
        return self.maps.get((scene, n, integrator))

    def line(self, scene, integrator):
        """Returns the maps of an integrator in a scene, n rising."""
        found = (self.at(scene, n, integrator) for n in self.sizes(scene))
        return [each for each in found if each]

    def trial_steps(self, setting, integrator):
        return setting.explicit_steps if self.integrators[integrator].explicit else setting.implicit_steps


@dataclass(frozen=True)
class Sample:
    """The state of a long run after a step; an error is None where it was not finite."""

    step: int
    time: float
    spectrum_error: Optional[float]
    casimir_errors: Tuple[Optional[float], ...]  # k = 2 … 5, relative
    energy_error: Optional[float]  # relative, largest since the sample before
    skew_defect: Optional[float]

    @property
    def casimir_error(self):
        return None if None in self.casimir_errors else max(self.casimir_errors)


@dataclass(frozen=True)
class LongRun:
    scene: str
    n: int
    integrator: str
    share: float  # of the critical h‖B‖₂
    critical: float
    h_norm_B: float
    step: float
    status: str
    steps: int  # completed
    failed_step: Optional[int]
    sweeps_per_step: Optional[float]
    samples: Tuple[Sample, ...]

    @property
    def survived(self):
        return self.status == CONVERGED


@dataclass(frozen=True)
class LongRuns:
    context: Dict[str, str]
    steps: int
    integrators: Dict[str, Integrator]
    runs: List[LongRun]

    def settings(self):
        return sorted({(run.scene, run.n) for run in self.runs}, key=lambda each: (SCENES.index(each[0]), each[1]))

    def shares(self):
        """Returns the shares of the critical h‖B‖₂, from the edge inwards."""
        return sorted({run.share for run in self.runs}, reverse=True)

    def at(self, scene, n, share, integrator):
        """Returns a run, or None."""
        return next((run for run in self.runs
                     if (run.scene, run.n, run.share, run.integrator) == (scene, n, share, integrator)), None)


@dataclass(frozen=True)
class Quantity:
    """What a long run is watched for."""

    name: str
    label: str
    of: Callable

    def series(self, run):
        """Returns (time, value) of every sample that has a value."""
        found = ((sample.time, self.of(sample)) for sample in run.samples)
        return [(time, value) for time, value in found if value is not None]


QUANTITIES = (
    Quantity("spectrum error", "largest error of an eigenvalue", lambda sample: sample.spectrum_error),
    Quantity("skew defect", "largest entry of |W + W†|", lambda sample: sample.skew_defect),
    Quantity("Casimirs", "largest relative error of a Casimir", lambda sample: sample.casimir_error),
    Quantity("energy error", "relative error of the energy", lambda sample: sample.energy_error),
)


def trials_in_words(failures, scenes):
    """Says how many steps the trials of some scenes are of, and at which n."""
    lengths = {}
    for (scene, n), setting in failures.settings.items():
        if scene in scenes:
            lengths.setdefault((setting.implicit_steps, setting.explicit_steps), set()).add(n)
    return "; ".join(f"{length_in_words(*steps)} at n = {', '.join(map(str, sorted(sizes)))}"
                     for steps, sizes in lengths.items())


def length_in_words(implicit, explicit):
    steps = f"{implicit} step" + ("s" if implicit > 1 else "")
    return steps if implicit == explicit else f"{steps} ({explicit} of explicit methods)"


# ---- reading


def read_map(path):
    """Returns the FailureMap in `path`. Throws UnusableFile with one line that names the file and what is wrong."""
    return raw_files.read(path, failure_map)


def read_fast_map(path):
    """Returns the FailureMap of the fast forms in `path`. Throws UnusableFile as read_map does."""
    return raw_files.read(path, lambda document: failure_map(document, "fast"))


def read_long_runs(path):
    """Returns the LongRuns in `path`. Throws UnusableFile as read_map does."""
    return raw_files.read(path, long_runs)


def failure_map(document, solver="published"):
    context = raw_files.context(document, MAP_FORMAT)
    if context.get("solver", "published") != solver:
        raise UnusableFile(f"is no map of the {solver} forms (its solver is {context.get('solver', 'published')})")
    settings = keyed([setting(Fields(each, "a setting")) for each in objects(document, "settings")],
                     lambda each: (each.scene, each.n))
    maps = keyed([map_of(Fields(each, "a map")) for each in objects(document, "maps")],
                 lambda each: (each.scene, each.n, each.integrator))
    if not maps:
        raise UnusableFile("has no maps")
    result = FailureMap(context, Fields(document, "the file").whole("max_sweeps", 1), integrators(document), settings,
                        maps)
    for each in maps.values():
        check_listed(result.integrators, each, "map")
        if (each.scene, each.n) not in settings:
            raise UnusableFile(f"has a map in a setting it does not list, {each.scene} at n = {each.n}")
    return result


def long_runs(document):
    context = raw_files.context(document, LONG_RUNS_FORMAT)
    runs = [long_run(Fields(each, "a run")) for each in objects(document, "runs")]
    keyed(runs, lambda each: (each.scene, each.n, each.integrator, each.share))
    if not runs:
        raise UnusableFile("has no runs")
    result = LongRuns(context, Fields(document, "the file").whole("steps", 1), integrators(document), runs)
    for each in runs:
        check_listed(result.integrators, each, "run")
    return result


def integrators(document):
    return unique([raw_files.integrator(Fields(each, "an integrator")) for each in objects(document, "integrators")],
                  "name")


def keyed(items, key):
    found = {key(item): item for item in items}
    if len(found) < len(items):
        twice = next(each for each in map(key, items) if list(map(key, items)).count(each) > 1)
        raise UnusableFile(f"has {', '.join(map(str, twice))} twice")
    return found


def check_listed(known, each, what):
    if each.integrator not in known:
        raise UnusableFile(f"has a {what} of an integrator it does not list, {quoted(each.integrator)}")


def setting(fields):
    steps = fields.object("trial_steps")
    return Setting(fields.one_of("scene", SCENES), fields.whole("n", 2), fields.positive("norm_B"), steps.whole("explicit", 1), steps.whole("implicit", 1))


def map_of(fields):
    trials = objects(fields.values, "trials")
    if not trials:
        raise UnusableFile("has a map without trials")
    critical = fields.object("critical") if fields.get("critical") is not None else None
    limit = fields.positive("linear_limit") if fields.get("linear_limit") is not None else None
    return Map(fields.one_of("scene", SCENES), fields.whole("n", 2), fields.text("integrator"), limit,
               tuple(trial(Fields(each, "a trial")) for each in trials),
               Critical(trial(critical.object("works")), trial(critical.object("fails"))) if critical else None)


ERRORS = ("spectrum_error", "skew_defect", "energy_error")


def trial(fields):
    status = fields.one_of("status", STATUSES)
    errors = {name: fields.error_of_any_size(name) for name in ERRORS}
    if status == CONVERGED and None in errors.values():
        raise UnusableFile(f"{fields.what} is {CONVERGED} and has no value of"
                           f" {', '.join(name for name in errors if errors[name] is None)}")
    return Trial(h_norm_B=fields.positive("h_norm_B"), step=fields.positive("step"), status=status,
                 steps=fields.whole("steps"), sweeps_per_step=fields.optional("sweeps_per_step"),
                 failed_step=failed_step(fields), **errors)


def failed_step(fields):
    return fields.whole("failed_step", 1) if fields.values.get("failed_step") is not None else None


def long_run(fields):
    return LongRun(scene=fields.one_of("scene", SCENES), n=fields.whole("n", 2), integrator=fields.text("integrator"),
                   share=fields.positive("share"), critical=fields.positive("critical"),
                   h_norm_B=fields.positive("h_norm_B"), step=fields.positive("step"),
                   status=fields.one_of("status", STATUSES), steps=fields.whole("steps"),
                   failed_step=failed_step(fields), sweeps_per_step=fields.optional("sweeps_per_step"),
                   samples=tuple(sample(Fields(each, "a sample")) for each in objects(fields.values, "samples")))


def sample(fields):
    return Sample(fields.whole("step"), fields.not_negative("time"), fields.error_of_any_size("spectrum_error"),
                  casimir_errors(fields), fields.error_of_any_size("energy_error"),
                  fields.error_of_any_size("skew_defect"))


def casimir_errors(fields):
    values = fields.get("casimir_errors")
    sound = isinstance(values, list) and len(values) == len(CASIMIRS) and all(
        value is None or (is_number(value) and value >= 0) for value in values)
    if not sound:
        fields.refuse("casimir_errors", f"a list of {len(CASIMIRS)} numbers, 0 or more, or nulls")
    return tuple(None if value is None or value > LARGEST else float(value) for value in values)
