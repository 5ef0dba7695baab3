#!/usr/bin/env python3
"""Measures what long runs of decaying turbulence average to, and what they cost, by method, step and tolerance.

Initial data are drawn: modes l = 6 … 10, ‖W₀‖₂ = 1, the same draws at every n, each made anew from its number. Two runs
that begin close to each other are strangers before T/2, so that averages over the second half of a run compare
ensembles, not trajectories. Runs are untimed. The cost of a step is timed apart, from the state of the first draw at
T/2, in fresh processes, each of which times all settings of one n in turns.
"""

import os
import random
import statistics
import sys
import tempfile
from functools import partial
from typing import NamedTuple

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from lib import study

PROGRAM = "turbulence"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
import numpy
from lib import formats
from lib import turbulence_runs as runs
from lib import verdicts
from lib.command_line import Stop, whole_number
from lib.formats import FAST, PUBLISHED
from lib.messages import one_line
from lib.problems import decoded
from lib.turbulence_figures import steps_to
from lib.turbulence_files import (LOOSE, METHOD, PRACTICE, PRACTICE_INTEGRATOR, PRACTICE_SHARE, PRACTICE_TOLERANCES,
                                  REFERENCE, SCHEMA, TIGHT, Cost, Parting, RunRow, Setting, Settings, Size)

SIZES, QUICK_SIZES = (33, 65, 129), (33,)
REFERENCE_METHOD = Setting("elp6", 0.25, 1e-10)

# What is timed: steps that fill a stretch of time behind WARM_STEPS others from T/2 on, or so many if they are longer.
STRETCH, LEAST_TIMED = 10.0, 8
PUBLISHED_STRETCH = 1.0  # of the practice in its published form, whose step is the shortest and expensive
TURNS = 2  # of all settings within a process, of which the least counts; one for those of
LONG = 0.3  # CPU seconds or more
PROCESSES, QUICK_PROCESSES = 8, 2

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
# At large n, with the practice at one tolerance: eight settings. Half the longest faithful steps at n = 65.
FEW_STEPS = {"algebra1": (0.25,), "group2": (0.5,), "elp4": (0.5,), "magnus5": (0.25,), "rkmk4": (0.5,),
             "rk4": (0.0625,), "rk4_projected": (0.0625,)}
QUICK_STEPS = {"algebra1": (0.5, 2.0), "group2": (0.5,), "elp4": (0.5, 1.0), "rk4": (0.25, 0.5)}


class Plan(NamedTuple):
    """What is run at an n."""

    draws: int
    references: int  # ensembles
    time: float
    steps: dict  # of each integrator
    ladder: dict
    practice: tuple  # its tolerances


WHOLE = Plan(draws=10, references=5, time=1000.0, steps=STEPS, ladder=LADDER, practice=PRACTICE_TOLERANCES)
# The larger n, the later two runs become strangers: at n = 129 one of three pairs is not yet at t = 500.
LARGE = Plan(draws=3, references=5, time=1200.0, steps=FEW_STEPS, ladder={}, practice=(LOOSE,))
QUICK = Plan(draws=2, references=3, time=100.0, steps=QUICK_STEPS, ladder={}, practice=PRACTICE_TOLERANCES)
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
    return [{"n": n, **setting._asdict(), "solver": solver, "steps": timed_steps(setting.step, solver)}
            for setting, solver in solvers]


def timed_steps(step, solver):
    """Returns how many steps of a setting are timed."""
    return max(LEAST_TIMED, steps_to(PUBLISHED_STRETCH if solver == PUBLISHED else STRETCH, step))


def prepare(job):
    """Returns the state that points are timed from, as text, and what count() returns of each.

    A job is that of the first draw by the reference method, with `points` besides.
    """
    text = runs.developed(job)
    W = decoded(text, job["n"])
    return {"state": text, "counts": [count(point, W) for point in job["points"]]}


def count(point, W):
    """Returns the equivalent products of a timed step of a point, or None where a step fails."""
    method, seen = runs.method_of(point, runs.drawn_scene(point["n"], 0)), []
    stretches = study.WARM_STEPS, study.WARM_STEPS + point["steps"]

    def look(step, _, report):
        if step in stretches:
            seen.append(report.equivalent_products)

    try:
        method.run(W, point["step"], stretches[1], look)
    except isosyrk.SolverError:
        return None
    return runs.recorded((seen[1] - seen[0]) / point["steps"])


def row_of(point):
    """Returns the name of a point among those of its n."""
    return f"{point['integrator']}, h = {point['step']:g}, {point['tolerance']:g}, {point['solver']}"


def blocks_of(points):
    """Returns what is timed together: all points of one n as rows, by name."""
    return [{"n": n, "rows": list(rows), "points": rows} for n in dict.fromkeys(point["n"] for point in points)
            if (rows := {row_of(point): point for point in points if point["n"] == n})]


def time_block(block):
    """Returns the CPU seconds of a step of each row, the least of TURNS in changing order.

    `process` of the block tells the orders of one process from those of another, `state` names the file of its state.
    """
    W, scene = numpy.load(block["state"]), runs.drawn_scene(block["n"], 0)
    shuffled = random.Random(block["process"])
    found = {row: [] for row in block["rows"]}
    for _ in range(TURNS):
        for row in shuffled.sample(block["rows"], len(block["rows"])):
            point = block["points"][row]
            if found[row] and min(found[row]) * point["steps"] >= LONG:
                continue
            method = runs.method_of(point, scene)  # as new, so that no repetition knows of the one before
            seconds = study.seconds_of(method, W, point["step"], point["steps"], study.WARM_STEPS)
            found[row].append(seconds / point["steps"])
    return [min(each) for each in found.values()]


def further_processes(most, seconds):
    """Returns how many further processes each row wants: all rows have the same, so that any two can be compared."""
    return {row: most - len(each) for row, each in seconds.items()}


def time_all(points, texts, most, journal):
    """Returns the CPU seconds of a step of each point by process, as dicts by row and n; `texts` are states by n."""
    blocks = blocks_of(points)
    with tempfile.TemporaryDirectory() as folder:
        files = {block["n"]: os.path.join(folder, f"n{block['n']}.npy") for block in blocks}
        for n, path in files.items():
            numpy.save(path, decoded(texts[n], n))

        def command(block, process):
            return study.process_command(__file__, block, process, state=files[block["n"]])

        times = study.by_processes(blocks, command, partial(further_processes, most), journal, "timing")
    return {(block["n"], row): seconds for block, found in zip(blocks, times) for row, seconds in found.items()}


def cost_of(point, products, seconds):
    """Returns a point as a row of its table, with times of five digits."""
    return Cost(**{name: point[name] for name in Cost._fields[:-2]}, equivalent_products=products,
                seconds=[formats.to_digits(each, 5) for each in seconds])


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
    return Size(n=n, draws=plan.draws, references=plan.references, time=plan.time,
                reference_integrator=REFERENCE_METHOD.integrator, reference_step=REFERENCE_METHOD.step,
                reference_error=reference_error, norm_B=runs.recorded(statistics.fmean(norms)))


def run_row(role, job, found):
    """Returns a run as a row of its table, given what carry_out() returned."""
    named = {name: job[name] for name in ("n", "integrator", "step", "tolerance", "draw")}
    return RunRow(**named, role=role, ensemble=job.get("ensemble", 0), **found)


def main(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--processes", type=whole_number(1, 100), help="that time a step; with fewer than"
                        f" {verdicts.FEWEST} all is undecided (default: {PROCESSES}, quick {QUICK_PROCESSES})")
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
    rows = [run_row(*each) for each in zip(roles, jobs, found)]
    points = {n: points_of(n, plans[n], rows) for n in sizes}
    prepared = untimed([{**job_of(n, plans[n], REFERENCE_METHOD, 0), "points": points[n]} for n in sizes], prepare,
                       what="states and counts")
    counted = [each for n, state in zip(sizes, prepared) for each in zip(points[n], state["counts"])]
    most = options.processes or (QUICK_PROCESSES if options.quick else PROCESSES)
    seconds = time_all([point for point, products in counted if products is not None],
                       {n: state["state"] for n, state in zip(sizes, prepared)}, most, journal)
    costs = [cost_of(point, products, seconds.get((point["n"], row_of(point)), ())) for point, products in counted]

    settings = Settings(lowest_degree=runs.DEGREES[0], highest_degree=runs.DEGREES[-1], displacement=runs.DISPLACEMENT,
                        small_displacement=runs.SMALL_DISPLACEMENT, energy_loss=runs.ENERGY_LOSS,
                        max_sweeps=runs.MAX_SWEEPS, warm_steps=study.WARM_STEPS)
    listed = dict.fromkeys((PRACTICE_INTEGRATOR, REFERENCE_METHOD.integrator, *names))
    formats.write_study(options.out, SCHEMA, journal.context, settings, {
        "integrators": [study.record_of(entry) for entry in study.entries(listed)],
        "sizes": [size_row(n, plans[n], error) for n, error in zip(sizes, errors)],
        "partings": [Parting(n=pair["n"], draw=pair["draw"], displacement=displacement, time=time, at_window=at_window)
                     for pair, found in zip(pairs, partings)
                     for displacement, (time, at_window) in zip(runs.DISPLACEMENTS, found)],
        "runs": rows, "costs": costs})
    journal.remove()


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:], time_block)
