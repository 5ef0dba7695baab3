"""Finds up to which step size every integrator works, in published and fast form, and how it fails beyond.

A short trial runs to T = 5, in 50 steps at least (explicit methods: 400). A grid of step sizes shows islands of steps
that work; bisection finds the critical step. A long trial has ten times as many steps as the short one of the same step
size, so it runs to T = 50 at least; the longest step that survives it is found too. Nothing here is timed.
"""

from functools import partial

import isosyrk

from lib.records import formats
from lib.records.formats import SOLVERS
from lib.running import built, initial_states, program, trials, untimed
from lib.running.checkpoint import Checkpoint
from studies.limits.plan import jobs_of
from studies.limits.schema import LETTERS, SCENES, SCHEMA, Limit, Settings, State, Survived, Theory


def find(job):
    """Returns the limits of a job: fields of a Limit, and of a Survived or None."""
    setting = trials.Setting(initial_states.scene_of(job["scene"], job["n"], job["state"]))
    method = trials.Method(setting, job["integrator"], job["solver"])
    outcomes, bracket = trials.critical(method.outcome)
    works, fails, fails_as = bracket or (None, None, None)
    limit = {"first": min(outcomes), "grid": "".join(map(LETTERS.get, outcomes.values())), "works": works,
             "fails": fails, "fails_as": fails_as}
    return {"limit": limit, "survived": survived(method, bracket) if job["long"] and bracket else None}


def survived(method, bracket):
    """Returns the fields of a Survived of a Method with a critical `bracket`, or None if no step survives."""
    energy_errors = {}

    def outcome(h_norm_B):
        ending, energy_errors[h_norm_B] = method.trial(h_norm_B, trials.long_steps)
        return ending

    found = trials.survived(outcome, bracket)
    return found and (*found, energy_errors[found[0]])


def states_of(jobs):
    """Returns the State of each initial state that jobs begin from."""
    found = []
    for scene, n, number in sorted({(job["scene"], job["n"], job["state"]) for job in jobs}):
        setting = trials.Setting(initial_states.scene_of(scene, n, number))
        found.append(State(scene, n, number, setting.norm_B, setting.norm_ad_B))
    return found


def theory_of(jobs):
    """Returns what linear theory says of each integrator from a scene's own initial data, where it says anything."""
    found = []
    for scene, n, name in sorted({(job["scene"], job["n"], job["integrator"]) for job in jobs}):
        if built.integrators()[name].co_rotating:
            continue
        limit = isosyrk.integrator(initial_states.scene_of(scene, n, 0), name).linear_limit()
        if limit is not None:
            found.append(Theory(scene, n, name, limit))
    return found


def main(arguments):
    parser = program.parser("limits", __doc__.splitlines()[0])
    parser.add_argument("--scene", choices=SCENES, nargs="+", action="extend", help="(default: all)")
    parser.add_argument("--solver", choices=SOLVERS, nargs="+", action="extend", help="(default: both)")
    options = parser.parse_args(arguments)
    jobs = jobs_of(options)
    sizes = sorted({job["n"] for job in jobs})
    checkpoint = Checkpoint("limits", options, partial(isosyrk.conditions, products="openblas", sizes=sizes))
    found = untimed.results(jobs, find, checkpoint, options, "limits")
    tried = {job["integrator"] for job in jobs}
    place = ("solver", "scene", "n", "integrator")
    formats.write_study(options.out, SCHEMA, checkpoint.context, Settings(
        options.quick, trials.TIME, trials.MIN_STEPS[False], trials.MIN_STEPS[True], trials.LONGER,
        trials.GRID_STEP, trials.CLOSE, trials.LONG_CLOSE), {
        "integrators": [entry for name, entry in built.integrators().items() if name in tried],
        "states": states_of(jobs),
        "limits": [Limit(*(job[name] for name in (*place, "state")), **each["limit"])
                   for job, each in zip(jobs, found)],
        "survived": [Survived(*(job[name] for name in place), *each["survived"]) for job, each in zip(jobs, found)
                     if each["survived"]],
        "theory": theory_of(jobs)})
    checkpoint.remove()
