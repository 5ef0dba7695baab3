"""Raw files of scripts/studies/stability.py and long_runs.py: where integrators fail, and errors over time.

A trial is a short run with one step size; the map of one integrator in one setting (a scene at one n) has trials on a
grid of h‖B‖₂, and the bracket that bisection left around the critical value. ‖B‖₂ is taken at the initial data.
"""

from typing import Dict, NamedTuple, Tuple

from lib import formats
from lib.formats import (CONVERGED, PUBLISHED, SOLVERS, Integrator, Schema, keyed, number, one_of, optional,
                         positive, status, text, whole)
from lib.messages import UnusableFile

SCENES = ("smooth", "rough")
ROUNDING = 1e-12  # what rounding leaves in 10⁴ steps, as a relative error


class MapSettings(NamedTuple):
    solver: one_of(*SOLVERS)
    max_sweeps: whole(1)


class Setting(NamedTuple):
    scene: one_of(*SCENES)
    n: whole(2)
    norm_B: positive
    norm_ad_B: positive
    explicit_steps: whole(1)  # of a trial
    implicit_steps: whole(1)


class Trial(NamedTuple):
    """A short run; its errors are None where they were not finite."""

    scene: one_of(*SCENES)
    n: whole(2)
    integrator: text
    h_norm_B: positive
    status: status
    steps: whole()  # completed
    sweeps_per_step: number
    spectrum_error: optional(number)
    skew_defect: optional(number)
    energy_error: optional(number)
    failed_step: optional(whole(1))

    @property
    def works(self):
        return self.status == CONVERGED


class Edge(NamedTuple):
    """The critical h‖B‖₂ of an integrator; None where no trial failed, or none worked below one that failed."""

    scene: one_of(*SCENES)
    n: whole(2)
    integrator: text
    linear_limit: optional(positive)  # h‖B‖₂ beyond which linear theory, B frozen at B(W₀), says that it fails
    works: optional(positive)  # the largest h‖B‖₂ of the bracket that does
    fails: optional(positive)  # the smallest that does
    fails_as: optional(status)


class LongRunSettings(NamedTuple):
    steps: whole(1)
    max_sweeps: whole(1)


class RunRow(NamedTuple):
    scene: one_of(*SCENES)
    n: whole(2)
    integrator: text
    share: positive  # of the critical h‖B‖₂
    critical: positive
    h_norm_B: positive
    step: positive
    status: status
    steps: whole()  # completed
    sweeps_per_step: number
    failed_step: optional(whole(1))


class Sample(NamedTuple):
    """The state of a long run after a step; an error is None where it was not finite."""

    run: whole()  # its row among the runs, from 0
    step: whole()
    spectrum_error: optional(number)
    casimir_error: optional(number)  # relative, largest of k = 2 … 5
    energy_error: optional(number)  # relative, largest since the sample before
    skew_defect: optional(number)


# What a long run is watched for: errors of a Sample, and what each is.
QUANTITIES = {"spectrum_error": "largest error of an eigenvalue", "skew_defect": "largest entry of |W + W†|",
              "casimir_error": "largest relative error of a Casimir", "energy_error": "relative error of the energy"}

MAP_SCHEMA = Schema("stability", MapSettings,
                    {"integrators": Integrator, "settings": Setting, "maps": Edge, "trials": Trial})
LONG_RUNS_SCHEMA = Schema("long_runs", LongRunSettings, {"integrators": Integrator, "runs": RunRow, "samples": Sample})


class Map(NamedTuple):
    """One integrator in one setting."""

    edge: Edge
    trials: Tuple[Trial, ...]  # h‖B‖₂ rising

    @property
    def always_works(self):
        return all(trial.works for trial in self.trials)

    @property
    def largest_working(self):
        """The largest h‖B‖₂ below every failure that was tried; None if there is none."""
        return self.edge.works or (self.trials[-1].h_norm_B if self.always_works else None)

    @property
    def first_failure(self):
        """The status of the failure with the smallest h‖B‖₂ that was tried; None if there is none."""
        failures = [(trial.h_norm_B, trial.status) for trial in self.trials if not trial.works]
        if self.edge.fails:
            failures.append((self.edge.fails, self.edge.fails_as))
        return min(failures)[1] if failures else None


class FailureMap(NamedTuple):
    context: Dict[str, str]
    max_sweeps: int
    integrators: Dict[str, Integrator]
    settings: Dict[Tuple[str, int], Setting]
    maps: Dict[Tuple[str, int, str], Map]

    def scenes(self):
        return [scene for scene in SCENES if self.sizes(scene)]

    def sizes(self, scene):
        return sorted(n for known, n in self.settings if known == scene)

    def line(self, scene, integrator):
        """Returns the map of an integrator in a scene at each of its n, or None."""
        return [self.maps.get((scene, n, integrator)) for n in self.sizes(scene)]

    def mapped(self, scene, names):
        """Returns those of some integrators that have maps in a scene."""
        return [name for name in names if any(self.line(scene, name))]


class LongRun(NamedTuple):
    row: RunRow
    samples: Tuple[Sample, ...]

    @property
    def survived(self):
        return self.row.status == CONVERGED

    def series(self, quantity):
        """Returns (time, value) of every sample that has a value of a quantity."""
        found = ((sample.step * self.row.step, getattr(sample, quantity)) for sample in self.samples)
        return [(time, value) for time, value in found if value is not None]

    def largest(self, quantity):
        """Returns the largest value of a quantity, or None if no sample has one."""
        return max((value for _, value in self.series(quantity)), default=None)


class LongRuns(NamedTuple):
    steps: int
    integrators: Dict[str, Integrator]
    runs: Dict[Tuple[str, int, str, float], LongRun]  # by scene, n, integrator and share of the critical h‖B‖₂

    def settings(self):
        return sorted({key[:2] for key in self.runs}, key=lambda each: (SCENES.index(each[0]), each[1]))

    def shares(self):
        """Returns the shares of the critical h‖B‖₂, from the edge inwards."""
        return sorted({share for *_, share in self.runs}, reverse=True)


def read_map(path, solver=PUBLISHED):
    """Returns the FailureMap of the forms of a solver in `path`. Throws UnusableFile with one line that names the file
    and what is wrong."""
    return formats.read_study(path, MAP_SCHEMA, lambda study: failure_map(study, solver))


def read_long_runs(path):
    """Returns the LongRuns in `path`. Throws UnusableFile as read_map does."""
    return formats.read_study(path, LONG_RUNS_SCHEMA, long_runs)


def failure_map(study, solver):
    if study.settings.solver != solver:
        raise UnusableFile(f"is no map of the {solver} forms (its solver is {study.settings.solver})")
    trials = {}
    for trial in study.tables["trials"]:
        trials.setdefault((trial.scene, trial.n, trial.integrator), []).append(trial)
    edges = keyed(study.tables["maps"], "scene", "n", "integrator")
    if not edges:
        raise UnusableFile("has no maps")
    settings = keyed(study.tables["settings"], "scene", "n")
    return FailureMap(study.context, study.settings.max_sweeps, keyed(study.tables["integrators"], "name"), settings,
                      {key: Map(edge, tuple(trials[key])) for key, edge in edges.items()})


def long_runs(study):
    rows = keyed(study.tables["runs"], "scene", "n", "integrator", "share")
    if not rows:
        raise UnusableFile("has no runs")
    samples = [[] for _ in rows]
    for sample in study.tables["samples"]:
        samples[sample.run].append(sample)
    return LongRuns(study.settings.steps, keyed(study.tables["integrators"], "name"),
                    {key: LongRun(row, tuple(found)) for (key, row), found in zip(rows.items(), samples)})
