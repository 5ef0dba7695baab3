"""The raw file of the study `limits`: up to which step size each integrator works, and how it fails beyond.

Step sizes are given as h‖B(W₀)‖₂ of the flow without co-rotating frame, at the initial data W₀ of a state. The critical
step is where short trials begin to fail. The survived step is the longest, up to the critical one, whose long trial
came to its end: it says nothing of accuracy.
"""

import os
from typing import Dict, NamedTuple, Tuple

from lib.programs import places
from lib.programs.messages import UnusableFile
from lib.records import formats
from lib.records.formats import (CONVERGED, LOSSES, SOLVERS, STATUSES, SWEEP_CAP, UNSTABLE, Integrator, Schema, keyed,
                                 number, one_of, optional, positive, text, truth, whole)
from lib.records.settings import SCENES

RECORDED = os.path.join(places.RECORDED, "limits", "raw.json")
OUTCOMES = (*(status for status in STATUSES if status != UNSTABLE), *LOSSES)
# A letter for each outcome, so that a row holds those of a whole grid.
LETTERS = dict(zip(OUTCOMES, "+dscnpe"))
NAMES = {letter: outcome for outcome, letter in LETTERS.items()}
outcome = one_of(*OUTCOMES)


class Settings(NamedTuple):
    quick: truth
    time: positive  # of a short trial, at least
    implicit_steps: whole(1)  # of a short trial, at least
    explicit_steps: whole(1)
    longer: whole(2)  # a long trial has so many times the steps of the short one with the same step size
    grid_step: positive  # factor of h from one trial of the grid to the next
    close: positive  # factor between the failing and the working step where bisection ended
    long_close: positive  # the same for long trials

    @property
    def long_time(self):
        """How long a long trial lasts at least."""
        return self.longer * self.time


class State(NamedTuple):
    """The initial data of some trials: state 0 of a scene is its own, the others were drawn."""

    scene: one_of(*SCENES)
    n: whole(2)
    state: whole()
    norm_B: positive
    norm_ad_B: positive


class Limit(NamedTuple):
    """The critical step of one form of an integrator from one state."""

    solver: one_of(*SOLVERS)
    scene: one_of(*SCENES)
    n: whole(2)
    integrator: text
    state: whole()
    first: positive  # h‖B‖₂ of the first trial of the grid
    grid: text  # its outcomes, by LETTERS
    works: optional(positive)  # h‖B‖₂ on both sides of the first failure; None where no trial failed above one that
    fails: optional(positive)  # worked
    fails_as: optional(outcome)

    def trials(self, grid_step):
        """Returns (h‖B‖₂, outcome) of each trial of the grid, h rising."""
        return [(self.first * grid_step**place, NAMES[letter]) for place, letter in enumerate(self.grid)]

    @property
    def has_island(self):
        """Whether a longer step works beyond the first failure."""
        return LETTERS[CONVERGED] in self.grid.lstrip(LETTERS[CONVERGED])


class Survived(NamedTuple):
    """The longest step of one form of an integrator that survived a long trial, from a scene's own initial data."""

    solver: one_of(*SOLVERS)
    scene: one_of(*SCENES)
    n: whole(2)
    integrator: text
    works: positive  # h‖B‖₂ of the longest step that survived, and of a step that failed
    fails: positive
    fails_as: outcome
    energy_error: number  # relative, at the end of the trial that survived


class Theory(NamedTuple):
    """What linear theory, B frozen at B(W₀), says of the iteration of a published form, or of an explicit step."""

    scene: one_of(*SCENES)
    n: whole(2)
    integrator: text
    limit: number  # h‖B(W₀)‖₂


SCHEMA = Schema("limits", Settings, {"integrators": Integrator, "states": State, "limits": Limit, "survived": Survived,
                                     "theory": Theory})


class Line(NamedTuple):
    """The limits of one form of an integrator in one scene at one n, over its states; the first is the scene's own."""

    limits: Tuple[Limit, ...]

    @property
    def minimum(self):
        """The least critical h‖B‖₂ over the states that have one; None if none has."""
        return min((limit.works for limit in self.limits if limit.works), default=None)

    @property
    def largest(self):
        return max((limit.works for limit in self.limits if limit.works), default=None)

    @property
    def fails_as(self):
        """How the states fail, each way once, in the order of the states."""
        return list(dict.fromkeys(limit.fails_as for limit in self.limits if limit.fails_as))

    @property
    def set_by_cap(self):
        """Whether a state fails at the cap of sweeps: a larger cap would move its limit."""
        return SWEEP_CAP in self.fails_as

    @property
    def has_island(self):
        return any(limit.has_island for limit in self.limits)


class Limits(NamedTuple):
    context: Dict[str, str]
    settings: Settings
    integrators: Dict[str, Integrator]
    states: Dict[Tuple[str, int, int], State]
    lines: Dict[Tuple[str, str, int, str], Line]  # by solver, scene, n, integrator
    survived: Dict[Tuple[str, str, int, str], Survived]
    theory: Dict[Tuple[str, int, str], float]

    def sizes(self, solver):
        return sorted({n for each, _, n, _ in self.lines if each == solver})

    def scenes(self):
        return [scene for scene in SCENES if any(scene == each for _, each, _, _ in self.lines)]

    def names(self, solver):
        """Returns the integrators that have limits by a solver, in the order of the list."""
        found = {name for each, _, _, name in self.lines if each == solver}
        return [name for name in self.integrators if name in found]

    def own(self, solver, scene, n, name):
        """Returns the critical h‖B‖₂ from a scene's own initial data; None where nothing is known or nothing failed."""
        line = self.lines.get((solver, scene, n, name))
        return line and line.limits[0].works

    def survived_and_critical(self):
        """Returns the Survived and the Limit of the same state, for each Survived."""
        return [(survived, self.lines[key].limits[0]) for key, survived in self.survived.items()]

    def held(self, survived):
        """Returns the h‖B‖₂ of a Survived, or the least critical one of the drawn states where that is less."""
        line = self.lines[survived.solver, survived.scene, survived.n, survived.integrator]
        return min(survived.works, line.minimum or survived.works)

    def min_survived(self):
        """Returns the least h‖B‖₂ that survived, over scenes, by (integrator, solver, n), n rising within a form."""
        found = {}
        for (solver, _, n, name), survived in self.survived.items():
            key = (name, solver, n)
            found[key] = min(self.held(survived), found.get(key, survived.works))
        order = list(self.integrators)
        return {key: found[key] for key in sorted(found, key=lambda key: (order.index(key[0]), key[1], key[2]))}

    def survived_around(self, solver, scene, n, name):
        """Returns the h‖B‖₂ that survived in a scene at the recorded n on both sides of n, the lesser one, or at the
        nearest recorded n. None where the form has none in the scene."""
        known = {at: self.held(survived) for (by, where, at, each), survived in self.survived.items()
                 if (by, where, each) == (solver, scene, name)}
        below, above = [at for at in known if at <= n], [at for at in known if at >= n]
        around = [max(below, default=None), min(above, default=None)]
        return min((known[at] for at in around if at), default=None)


def read_limits(path=RECORDED):
    """Returns the Limits in `path`. Throws UnusableFile with one line that names the file and what is wrong."""
    return formats.read_study(path, SCHEMA, limits_of)


def limits_of(study):
    tables = study.tables
    if not tables["limits"]:
        raise UnusableFile("has no limits")
    rows = {}
    integrators, states = keyed(tables["integrators"], "name"), keyed(tables["states"], "scene", "n", "state")
    for limit in tables["limits"]:
        if limit.integrator not in integrators or (limit.scene, limit.n, limit.state) not in states:
            raise UnusableFile(f"has limits of {limit.integrator} from a state that it does not list")
        if not set(limit.grid) <= set(NAMES):
            raise UnusableFile(f"has a grid with unknown outcomes: {limit.grid}")
        rows.setdefault((limit.solver, limit.scene, limit.n, limit.integrator), []).append(limit)
    survived = keyed(tables["survived"], "solver", "scene", "n", "integrator")
    if not survived.keys() <= rows.keys():
        raise UnusableFile("has survived steps without critical ones")
    return Limits(study.context, study.settings, integrators, states,
                  {key: Line(tuple(found)) for key, found in rows.items()}, survived,
                  {(each.scene, each.n, each.integrator): each.limit for each in tables["theory"]})
