"""Measures what long runs of decaying turbulence average to, and what they cost, by method, step and tolerance.

Initial data are drawn: modes l = 6 … 10, ‖W₀‖₂ = 1, the same samples at every n, each made anew from its number. Two
runs that begin near each other are strangers before T/2, so that averages over the second half of a run compare
ensembles, not trajectories; ensembles that begin further apart show whether that is so. Runs are untimed. The cost of a
step is timed at the end, from the state of the first sample at T/2, in fresh processes, each of which times all
settings of one n interleaved.
"""

import os
import random
import statistics
import tempfile
from functools import partial

import isosyrk
import numpy

from lib.programs.command_line import whole_number
from lib.records import formats
from lib.records.settings import steps_to
from lib.judging import verdicts
from lib.running import built, program, timed, untimed
from lib.running.checkpoint import Checkpoint
from lib.running.problems import decoded
from studies.turbulence import single_runs as runs
from studies.turbulence.plan import QUICK_SIZES, SIZES, names_of, plan_of, settings_of, sizes_of
from studies.turbulence.schema import FAR, BASELINE_INTEGRATOR, REFERENCE, SCHEMA, Cost, RunRow, Settings, Size


# What is timed: steps that fill a stretch of time behind WARM_STEPS others from T/2 on, or so many if they are longer.
STRETCH, MIN_TIMED = 10.0, 8
TURNS = 2  # of all settings within a process, of which the least counts; one for those of
LONG = 0.3  # CPU seconds or more
PROCESSES, QUICK_PROCESSES = verdicts.FEWEST, 2


def job_of(n, plan, setting, sample):
    return {"n": n, "sample": sample, "time": plan.time, **setting._asdict()}


def run_jobs(n, plan, names):
    """Returns the jobs of all runs at an n with their roles, as (role, job)."""
    references = [(role, {**job_of(n, plan, plan.reference, sample), "role": role, "ensemble": ensemble})
                  for role, count in ((REFERENCE, plan.references), (FAR, plan.far))
                  for sample in range(plan.samples) for ensemble in range(count)]
    return references + [(role, job_of(n, plan, setting, sample)) for role, setting in settings_of(n, plan, names)
                         for sample in range(plan.samples)]


# ---- cost


def points_of(n, plan, rows):
    """Returns what is timed at an n: every setting whose runs all work."""
    working = [setting for role, setting in settings_of(n, plan, {**plan.steps, **plan.ladder})
               if (found := [row for row in rows if row.n == n and row.role == role
                             and row[2:5] == setting]) and all(row.works for row in found)]
    return [{"n": n, **setting._asdict(), "steps": max(MIN_TIMED, steps_to(STRETCH, setting.step))}
            for setting in working]


def prepare(job):
    """Returns the state that points are timed from, as text, and those of the points whose steps work there.

    A job is that of the first sample by the reference method, with `points` besides.
    """
    text = runs.developed(job)
    W = decoded(text, job["n"])
    return {"state": text, "points": [point for point in job["points"] if steps_work(point, W)]}


def steps_work(point, W):
    try:
        runs.method_of(point, runs.drawn_scene(point["n"], 0)).run(W, point["step"], timed.WARM_STEPS + point["steps"])
    except isosyrk.SolverError:
        return False
    return True


def row_of(point):
    """Returns the name of a point among those of its n."""
    return f"{point['integrator']}, h = {point['step']:g}, {point['tolerance']:g}"


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
            seconds = timed.seconds_of(method, W, point["step"], point["steps"], timed.WARM_STEPS)
            found[row].append(seconds / point["steps"])
    return [min(each) for each in found.values()]


def further_processes(maximum, seconds):
    """Returns how many further processes each row wants: all rows have the same, so that any two can be compared."""
    return {row: maximum - len(each) for row, each in seconds.items()}


def time_all(points, texts, maximum, checkpoint):
    """Returns the CPU seconds of a step of each point by process, as dicts by row and n; `texts` are states by n."""
    blocks = blocks_of(points)
    with tempfile.TemporaryDirectory() as folder:
        files = {block["n"]: os.path.join(folder, f"n{block['n']}.npy") for block in blocks}
        for n, path in files.items():
            numpy.save(path, decoded(texts[n], n))

        def command(block, process):
            return program.process_command("turbulence", block, process, state=files[block["n"]])

        times = timed.by_processes(blocks, command, partial(further_processes, maximum), checkpoint, "timing")
    return {(block["n"], row): seconds for block, found in zip(blocks, times) for row, seconds in found.items()}


def cost_of(point, seconds):
    """Returns a point as a row of its table, with times of five digits."""
    return Cost(**point, seconds=[formats.to_digits(each, 5) for each in seconds])


# ---- the study


def size_row(n, plan, reference_error):
    norms = [runs.drawn_scene(n, sample).generator_norms()[0] for sample in range(plan.samples)]
    return Size(n=n, samples=plan.samples, references=plan.references, far=plan.far, time=plan.time,
                reference_integrator=plan.reference.integrator, reference_step=plan.reference.step,
                reference_error=reference_error, norm_B=runs.recorded(statistics.fmean(norms)))


def run_row(role, job, found):
    """Returns a run as a row of its table, given what carry_out() returned."""
    named = {name: job[name] for name in ("n", "integrator", "step", "tolerance", "sample")}
    return RunRow(**named, role=role, ensemble=job.get("ensemble", 0), **found)


def main(arguments):
    parser = program.parser("turbulence", __doc__.splitlines()[0])
    parser.add_argument("--processes", type=whole_number(1, 100), help="that time a step; with fewer than"
                        f" {verdicts.FEWEST} all is undecided (default: {PROCESSES}, quick {QUICK_PROCESSES})")
    options = parser.parse_args(arguments)
    sizes = sizes_of(options.n or (QUICK_SIZES if options.quick else SIZES))
    names = names_of(options.integrator)
    plans = {n: plan_of(n, options.quick) for n in sizes}

    checkpoint = Checkpoint("turbulence", options, partial(isosyrk.conditions, products="openblas", sizes=sizes))
    results = partial(untimed.results, checkpoint=checkpoint, options=options)
    errors = results([job_of(n, plans[n], plans[n].reference, 0) for n in sizes], runs.converge,
                     what="checking the reference")
    roles, jobs = zip(*(each for n in sizes for each in run_jobs(n, plans[n], names)))
    found = results(jobs, runs.carry_out, what="runs")
    rows = [run_row(*each) for each in zip(roles, jobs, found)]
    prepared = results([{**job_of(n, plans[n], plans[n].reference, 0), "points": points_of(n, plans[n], rows)}
                        for n in sizes], prepare, what="states")
    points = [point for each in prepared for point in each["points"]]
    maximum = options.processes or (QUICK_PROCESSES if options.quick else PROCESSES)
    states = {n: each["state"] for n, each in zip(sizes, prepared)}
    seconds = time_all(points, states, maximum, checkpoint)  # last: nothing else runs meanwhile

    settings = Settings(lowest_degree=runs.DEGREES[0], highest_degree=runs.DEGREES[-1],
                        displacement=runs.DISPLACEMENTS[REFERENCE], far_displacement=runs.DISPLACEMENTS[FAR],
                        correlated_degree=runs.CORRELATED_DEGREE, lags=runs.LAGS, energy_loss=runs.ENERGY_LOSS,
                        max_sweeps=runs.MAX_SWEEPS, warm_steps=timed.WARM_STEPS)
    listed = dict.fromkeys((BASELINE_INTEGRATOR, *(plan.reference.integrator for plan in plans.values()), *names))
    formats.write_study(options.out, SCHEMA, checkpoint.context, settings, {
        "integrators": built.entries(listed),
        "sizes": [size_row(n, plans[n], error) for n, error in zip(sizes, errors)],
        "runs": rows, "costs": [cost_of(point, seconds[point["n"], row_of(point)]) for point in points]})
    checkpoint.remove()
