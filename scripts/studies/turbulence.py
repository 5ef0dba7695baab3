#!/usr/bin/env python3
"""Measures what long runs of decaying turbulence average to, and what they cost, by method, step and tolerance.

Initial data are drawn: modes l = 6 … 10, ‖W₀‖₂ = 1, the same draws at every n, each made anew from its number. Two runs
that begin close to each other are strangers before T/2, so that averages over the second half of a run compare
ensembles, not trajectories. Runs are untimed. The cost of a step is timed apart, from the first draw at T/2.
"""

import os
import sys
from functools import partial
from typing import NamedTuple

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from lib import study

PROGRAM = "turbulence"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
from lib import formats
from lib import turbulence_runs as runs
from lib.command_line import Stop, whole_number
from lib.formats import FAST, PUBLISHED
from lib.messages import one_line
from lib.turbulence_files import (LOOSE, METHOD, PRACTICE, PRACTICE_INTEGRATOR, PRACTICE_SHARE, PRACTICE_TOLERANCES,
                                  REFERENCE, SCHEMA, TIGHT, Cost, Parting, RunRow, Setting, Settings, Size)

SIZES, QUICK_SIZES = (33, 65, 129), (33,)
REFERENCE_METHOD = Setting("elp6", 0.25, 1e-10)
REPETITIONS = 5  # of timed steps, in turns
TIMED_STEPS = 50

# Steps of each method, up to where it fails. Nothing is in the co-rotating frame: the data have no part with l = 1, so
# that it would change nothing.
STEPS = {
    "algebra1": (0.125, 0.25, 0.5, 1.0, 2.0),
    "group2": (0.25, 0.5, 1.0, 2.0),
    "group3": (0.5, 1.0, 2.0, 4.0),
    "group4": (0.5, 1.0, 2.0, 4.0),
    "elp4": (0.25, 0.5, 1.0, 2.0, 4.0),
    "elp6": (0.5, 1.0, 2.0, 4.0),
    "magnus5": (0.25, 0.5, 1.0, 2.0),
    "rkmk4": (0.25, 0.5, 1.0, 2.0),
    "rk4": (0.125, 0.25, 0.5, 1.0, 2.0),
    "rk4_projected": (0.125, 0.25, 0.5, 1.0, 2.0),
}
LADDER = {"group2": (1e-4, 1e-6, TIGHT), "elp4": (1e-4, 1e-6)}  # further tolerances, at one step
LADDER_STEP = 0.5
FEW_STEPS = {"algebra1": (0.5,), "group2": (1.0,), "elp4": (1.0,), "magnus5": (1.0,), "rkmk4": (0.5,), "rk4": (0.25,),
             "rk4_projected": (0.5,)}  # at large n, with the practice at one tolerance: eight settings
QUICK_STEPS = {"algebra1": (0.5, 2.0), "group2": (0.5,), "elp4": (0.5, 1.0), "rk4": (0.25, 0.5)}


class Plan(NamedTuple):
    """What is run at an n."""

    draws: int
    references: int  # ensembles
    time: float
    steps: dict  # of each integrator
    ladder: dict
    practice: tuple  # its tolerances


WHOLE = Plan(10, 5, 1000.0, STEPS, LADDER, PRACTICE_TOLERANCES)
LARGE = Plan(3, 5, 1000.0, FEW_STEPS, {}, (LOOSE,))
QUICK = Plan(2, 3, 100.0, QUICK_STEPS, {}, PRACTICE_TOLERANCES)
LARGE_N = 129  # from which n on


def plan_of(n, quick):
    if quick:
        return QUICK
    return LARGE if n >= LARGE_N else WHOLE


def settings_of(n, plan, names):
    """Returns the settings at an n with their roles, as (role, Setting). The practice is always among them."""
    step = PRACTICE_SHARE * 2 / (n * (n - 1)) ** 0.5
    found = [(PRACTICE, Setting(PRACTICE_INTEGRATOR, step, tolerance)) for tolerance in plan.practice]
    for name in names:
        found += [(METHOD, Setting(name, step, LOOSE)) for step in plan.steps.get(name, ())]
        found += [(METHOD, Setting(name, LADDER_STEP, tolerance)) for tolerance in plan.ladder.get(name, ())]
    return found


def job_of(n, plan, setting, draw):
    return {"n": n, "draw": draw, "time": plan.time, **setting._asdict()}


def run_jobs(n, plan, names):
    """Returns the jobs of all runs at an n with their roles, as (role, job)."""
    references = [(REFERENCE, {**job_of(n, plan, REFERENCE_METHOD, draw), "ensemble": ensemble})
                  for draw in range(plan.draws) for ensemble in range(plan.references)]
    return references + [(role, job_of(n, plan, setting, draw)) for role, setting in settings_of(n, plan, names)
                         for draw in range(plan.draws)]


# ---- cost


def points_of(n, plan, rows):
    """Returns what is timed at an n: every setting whose runs all work, and the practice in its published form too."""
    working = [(role, setting) for role, setting in settings_of(n, plan, plan.steps)
               if (found := [row for row in rows if row.n == n and row.role == role
                             and row[2:5] == setting]) and all(row.works for row in found)]
    solvers = [(setting, FAST) for _, setting in working]
    solvers += [(setting, PUBLISHED) for role, setting in working if role == PRACTICE]
    return [{"n": n, **setting._asdict(), "solver": solver, "time": plan.time} for setting, solver in solvers]


def begun(point):
    """Returns the integrator of a point as new, and the developed state that its steps begin from."""
    scene, W = runs.developed(point["n"], *REFERENCE_METHOD, point["time"])
    return runs.method_of(point, scene), W


def count(point):
    """Returns the equivalent products of a step of a point, or None where a step fails."""
    method, W = begun(point)
    try:
        W, _ = method.run(W, point["step"], study.WARM_STEPS)
        _, report = method.run(W, point["step"], TIMED_STEPS)
    except isosyrk.SolverError:
        return None
    return runs.recorded(report.equivalent_products / TIMED_STEPS)


def time_one(point):
    """Returns the CPU seconds of TIMED_STEPS steps of a point, after WARM_STEPS from its developed state."""
    method, W = begun(point)
    return method.timed_run(W, point["step"], TIMED_STEPS, repetitions=1, warmup=study.WARM_STEPS)[0]


# ---- the study


def names_of(wanted):
    """Returns the integrators to run. Throws Stop for one that has no steps here."""
    for name in wanted or ():
        if name not in STEPS:
            raise Stop(f"--integrator {one_line(name)!r}: must be one of {', '.join(STEPS)}")
    return list(dict.fromkeys(wanted or STEPS))


def sizes_of(wanted):
    """Returns the sizes to run at. Throws Stop for one that is too small for the modes."""
    least = runs.DEGREES[-1] + 1
    for n in wanted:
        if n < least:
            raise Stop(f"--n {n}: must be at least {least}, for modes up to l = {least - 1}")
    return sorted(set(wanted))


def size_row(n, plan, reference_error):
    norms = [runs.drawn_scene(n, draw).generator_norms()[0] for draw in range(plan.draws)]
    return Size(n, plan.draws, plan.references, plan.time, REFERENCE_METHOD.integrator, REFERENCE_METHOD.step,
                reference_error, runs.recorded(sum(norms) / len(norms)))


def main(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=whole_number(1, 1000), default=REPETITIONS, help="(default: %(default)s)")
    options = parser.parse_args(arguments)
    sizes = sizes_of(options.n or (QUICK_SIZES if options.quick else SIZES))
    names = names_of(options.integrator)
    plans = {n: plan_of(n, options.quick) for n in sizes}

    journal = study.Journal(PROGRAM, options, partial(isosyrk.conditions, products="openblas", sizes=sizes))
    untimed = partial(study.untimed, journal=journal, options=options)
    errors = untimed([job_of(n, plans[n], REFERENCE_METHOD, 0) for n in sizes], runs.converge,
                     what="checking the reference")
    pairs = [job_of(n, plans[n], REFERENCE_METHOD, draw) for n in sizes for draw in range(plans[n].draws)]
    partings = untimed(pairs, runs.part, what="watching runs part")
    roles, jobs = zip(*(each for n in sizes for each in run_jobs(n, plans[n], names)))
    found = untimed(jobs, runs.carry_out, what="runs")
    rows = [RunRow(job["n"], role, job["integrator"], job["step"], job["tolerance"], job["draw"],
                   job.get("ensemble", 0), **each) for role, job, each in zip(roles, jobs, found)]
    points = [point for n in sizes for point in points_of(n, plans[n], rows)]
    products = untimed(points, count, what="counting")
    timed = [point for point, each in zip(points, products) if each is not None]
    seconds = iter(study.in_turns(timed, options.repetitions, time_one, journal, "timing"))
    costs = [Cost(point["n"], point["integrator"], point["step"], point["tolerance"], point["solver"], each,
                  [] if each is None else [time / TIMED_STEPS for time in next(seconds)])
             for point, each in zip(points, products)]

    settings = Settings(runs.DEGREES[0], runs.DEGREES[-1], runs.DISPLACEMENT, runs.SMALL_DISPLACEMENT,
                        runs.ENERGY_LOSS, runs.MAX_SWEEPS)
    listed = dict.fromkeys((PRACTICE_INTEGRATOR, REFERENCE_METHOD.integrator, *names))
    formats.write_study(options.out, SCHEMA, journal.context, settings, {
        "integrators": [study.record_of(entry) for entry in study.entries(listed)],
        "sizes": [size_row(n, plans[n], error) for n, error in zip(sizes, errors)],
        "partings": [Parting(pair["n"], pair["draw"], displacement, *each) for pair, found in zip(pairs, partings)
                     for displacement, each in zip(runs.DISPLACEMENTS, found)],
        "runs": rows, "costs": costs})
    journal.remove()


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
