#!/usr/bin/env python3
"""Finds up to which step size every integrator works, in published and fast form, and how it fails beyond.

A trial runs to T = 5, in 50 steps at least. A grid of step sizes shows islands of steps that work; bisection finds the
critical step. The safe step is the same to T = 50. Nothing here is timed.
"""

import os
import sys
from functools import partial
from typing import NamedTuple, Tuple

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from lib import study

PROGRAM = "limits"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
from lib import formats, initial_states, trials
from lib.command_line import Stop
from lib.formats import FAST, PUBLISHED, SOLVERS
from lib.initial_states import DEVELOPED, SMOOTH, STATES
from lib.integrator_names import TABLE1_CELLS, in_frame
from lib.limits_files import LETTERS, SCENES, SCHEMA, Limit, Safe, Settings, State, Theory

SAFE_TIME = 50.0
# What the project's own comparisons use; the other methods are tried where that is cheap.
EXPLICIT = ("rkmk4", "magnus5", "rk4_projected", "rk4")
MAIN = ("group1", "group2", "group3", "algebra1", "elp4", "elp6", *EXPLICIT, "group2_frame", "group3_frame",
        "elp4_frame", "elp6_frame", "magnus5_frame", "rk4_frame")
SIX = ("algebra1", "group2_frame", "elp4_frame", "elp6_frame", "magnus5_frame", "rk4_frame")
COTANGENT = ("cotangent1", "cotangent2", "cotangent3")
QUICK = ("group2", "algebra1", "elp4", "rkmk4", "rk4")


class Plan(NamedTuple):
    """What is tried at some n: forms of a solver, in some scenes, from so many states."""

    solver: str
    sizes: Tuple[int, ...]
    names: Tuple[str, ...]
    scenes: Tuple[str, ...] = SCENES
    states: int = STATES
    safe: Tuple[str, ...] = ()  # those that are tried to SAFE_TIME too, from the scene's own state


def plans(quick):
    """Returns the Plans of the study. A form is in one Plan at each n.

    All trials of all forms would take days. At n = 33 methods outside MAIN, and published forms outside Table 1 that
    are not explicit, have the smooth scene's own state only. At n = 65 published forms of Table 1 and methods of MAIN
    have each scene's own state, and fast forms of the SIX all states. Beyond, the SIX and published forms of Table 1
    have fewer scenes. Published forms in the co-rotating frame are not tried.
    """
    if quick:
        return [Plan(solver, (9, 17), QUICK, (SMOOTH,), 2, QUICK) for solver in SOLVERS]
    listed = isosyrk.integrators()
    plain = tuple(each.name for each in listed if not in_frame(each.name))
    fast = tuple(each.name for each in listed if each.has_fast_form)
    cells = (*TABLE1_CELLS, *EXPLICIT)
    return [Plan(PUBLISHED, (17,), plain, safe=plain),
            Plan(PUBLISHED, (33,), cells, safe=cells),
            Plan(PUBLISHED, (33,), without(cells, plain), (SMOOTH,), 1),
            Plan(PUBLISHED, (65,), TABLE1_CELLS, states=1),
            # Cotangent has group's limits, to bisection, at n = 17 and 33.
            Plan(PUBLISHED, (129,), without(COTANGENT, TABLE1_CELLS), (SMOOTH,), 1),
            Plan(FAST, (17,), fast, safe=fast),
            Plan(FAST, (33,), MAIN, safe=MAIN),
            Plan(FAST, (33,), without(MAIN, fast), (SMOOTH,), 1),
            Plan(FAST, (65,), SIX, safe=SIX),
            Plan(FAST, (65,), without(SIX, MAIN), states=1, safe=without(SIX, MAIN)),
            Plan(FAST, (129,), SIX, (SMOOTH,), 1, SIX),
            Plan(FAST, (129,), SIX, (DEVELOPED,), 1),
            Plan(FAST, (257,), SIX, (SMOOTH,), 1)]


def without(some, names):
    return tuple(name for name in names if name not in some)


def jobs_of(options):
    """Returns the jobs of the study that options ask for, the longest last."""
    jobs = [{"n": n, "solver": plan.solver, "integrator": name, "scene": scene, "state": state,
             "safe": name in plan.safe and state == 0}
            for plan in plans(options.quick) for n in plan.sizes for name in plan.names for scene in plan.scenes
            for state in range(plan.states)]
    if options.integrator:
        wanted = {entry.name for entry in study.entries(options.integrator)}
        jobs = [job for job in jobs if job["integrator"] in wanted]
    for name in ("n", "solver", "scene"):
        if getattr(options, name):
            jobs = [job for job in jobs if job[name] in getattr(options, name)]
    if not jobs:
        raise Stop("nothing is tried of these integrators, n, scenes and solvers together")
    return sorted(jobs, key=lambda job: (job["n"], job["solver"] == PUBLISHED))


def find(job):
    """Returns the limits of a job: fields of a Limit, and of a Safe or None."""
    setting = trials.Setting(initial_states.scene_of(job["scene"], job["n"], job["state"]))
    method = trials.Method(setting, job["integrator"], job["solver"])
    outcomes, bracket = trials.critical(method.outcome)
    works, fails, fails_as = bracket or (None, None, None)
    limit = {"first": min(outcomes), "grid": "".join(map(LETTERS.get, outcomes.values())), "works": works,
             "fails": fails, "fails_as": fails_as}
    safe = trials.safe(partial(method.outcome, time=SAFE_TIME), bracket) if job["safe"] and bracket else None
    return {"limit": limit, "safe": safe}


def states_of(jobs):
    """Returns the State of each initial state that jobs begin from."""
    found = []
    for scene, n, number in sorted({(job["scene"], job["n"], job["state"]) for job in jobs}):
        setting = trials.Setting(initial_states.scene_of(scene, n, number))
        found.append(State(scene, n, number, setting.norm_B, setting.norm_ad_B))
    return found


def theory_of(jobs):
    """Returns what linear theory says of each integrator from a scene's own initial data, where it says anything."""
    entries = {entry.name: entry for entry in isosyrk.integrators()}
    found = []
    for scene, n, name in sorted({(job["scene"], job["n"], job["integrator"]) for job in jobs}):
        if in_frame(name):
            continue
        limit = isosyrk.integrator(initial_states.scene_of(scene, n, 0), entries[name].name).linear_limit()
        if limit is not None:
            found.append(Theory(scene, n, name, limit))
    return found


def main(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--scene", choices=SCENES, nargs="+", action="extend", help="(default: all)")
    parser.add_argument("--solver", choices=SOLVERS, nargs="+", action="extend", help="(default: both)")
    options = parser.parse_args(arguments)
    jobs = jobs_of(options)
    sizes = sorted({job["n"] for job in jobs})
    journal = study.Journal(PROGRAM, options, partial(isosyrk.conditions, products="openblas", sizes=sizes))
    found = study.untimed(jobs, find, journal, options, "limits")
    tried = {job["integrator"] for job in jobs}
    place = ("solver", "scene", "n", "integrator")
    formats.write_study(options.out, SCHEMA, journal.context, Settings(
        options.quick, trials.TIME, SAFE_TIME, trials.LEAST_STEPS[False], trials.LEAST_STEPS[True], trials.GRID_STEP,
        trials.CLOSE, trials.SAFE_CLOSE), {
        "integrators": [study.record_of(entry) for entry in isosyrk.integrators() if entry.name in tried],
        "states": states_of(jobs),
        "limits": [Limit(*(job[name] for name in (*place, "state")), **each["limit"])
                   for job, each in zip(jobs, found)],
        "safe": [Safe(*(job[name] for name in place), *each["safe"]) for job, each in zip(jobs, found)
                 if each["safe"]],
        "theory": theory_of(jobs)})
    journal.remove()


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
