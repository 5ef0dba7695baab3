"""The times of the study `practice`, by fresh processes: blocks, what a process does, and processes that are wanted.

A block is all that is timed on one problem, so that any two of its rows are paired by process. Up to LARGEST_WHOLE a
process times whole runs, of quflow's step up to LARGEST_WHOLE_QUFLOW. Beyond, a process times some steps at one place
of a run, behind some that are not timed, and the time is scaled to the whole run, by equivalent products or, of
quflow's step, by steps: the places take turns, so that each has two of six processes. Of a method that has two step
sizes, the shorter one is timed and gives the time of both. Needs isosyrk.
"""

import random
import time

from lib.running import timed
from studies.practice import plan, quflow_step
from studies.practice.schema import AT_TENTH, METHOD, QUFLOW
from studies.practice.single_runs import INITIAL, REFERENCE, load, method_of, scene_of

REPETITIONS, LONG = 2, 0.3  # interleaved within a process, of which the least counts; once for runs of LONG seconds
CPU, PASSED = "timing", "threads"  # kinds of blocks: CPU seconds, and seconds that pass by numbers of threads


def row_name(row):
    """Returns the name of a row among those of its problem."""
    return f"{row['role']} {row['integrator']} {row['tolerance']:g} {row['wanted']}"


def cpu_block(problem, rows):
    """Returns what is timed on a problem, a dict: the rows of its table that have steps."""
    named = {row_name(row): row for row in rows if row.get("steps")}
    whole = problem["n"] <= plan.LARGEST_WHOLE
    kept = named if whole else {name: row for name, row in named.items()
                                if row["role"] != METHOD or row["wanted"] == AT_TENTH or not finer_of(row, rows)}
    return {**problem, "kind": CPU, "rows": list(kept), "runs": {name: run_of(row) for name, row in kept.items()}}


def finer_of(row, rows):
    """Returns the row of the same method at the smaller error, or None."""
    return next((each for each in rows if each.get("steps") and each["wanted"] == AT_TENTH and all(
        each[name] == row[name] for name in ("role", "integrator", "tolerance"))), None)


def run_of(row):
    return {name: row[name] for name in ("role", "integrator", "tolerance", "steps", "products")}


def thread_block(problem, rows, numbers):
    """Returns the fast forms at a tenth of the practice's error by numbers of threads, on a problem.

    Each runs at the tolerance that it needs, the first of its rows. Where whole runs take long there are few methods.
    """
    first = {row["integrator"]: row for row in reversed(rows) if row["role"] == METHOD and row["wanted"] == AT_TENTH
             and row.get("steps") and plan.has_threads(row["integrator"], problem["n"])}
    runs = {f"{row_name(row)} {number}": {**run_of(row), "threads": number}
            for row in reversed(first.values()) for number in numbers}
    return {**problem, "kind": PASSED, "rows": list(runs), "runs": runs}


def seconds_by_row(rows, found):
    """Returns the CPU seconds of each row of a problem, by process, from those of a block's rows by name."""
    seconds = []
    for row in rows:
        if not row.get("steps"):
            seconds.append([])
        elif (name := row_name(row)) in found:
            seconds.append(found[name])
        else:
            finer = finer_of(row, rows)
            seconds.append([each * row["products"] / finer["products"] for each in found[row_name(finer)]])
    return seconds


def further_processes(maximum, seconds):
    """Returns how many further processes each row wants: all rows have the same, so that any two can be compared."""
    return {row: maximum - len(each) for row, each in seconds.items()}


# ---- in a process


def time_block(block):
    """Returns the seconds of a whole run of each row, in changing order, the least of REPETITIONS.

    `process` of the block tells the orders of one process from those of another, `folder` has the states, and `quflow`
    is its checkout.
    """
    scene, shuffled = scene_of(block), random.Random(block["process"])
    time_one = time_passed if block["kind"] == PASSED else time_run
    found = {row: [] for row in block["rows"]}
    for _ in range(REPETITIONS):
        for row in shuffled.sample(block["rows"], len(block["rows"])):
            if not found[row] or min(found[row]) < LONG:
                found[row].append(time_one(scene, block, block["runs"][row]))
    return [min(each) for each in found.values()]


def time_run(scene, block, run):
    """Returns the CPU seconds of a run."""
    initial, h = scene.initial, block["time"] / run["steps"]
    largest_whole = plan.LARGEST_WHOLE_QUFLOW if run["role"] == QUFLOW else plan.LARGEST_WHOLE
    if block["n"] > largest_whole:
        return time_part(scene, block, run)
    if run["role"] == QUFLOW:
        return quflow_step.seconds_of(block["quflow"], initial, h, run["steps"])
    return timed.seconds_of(method_of(scene, run["integrator"], run["tolerance"]), initial, h, run["steps"])


def time_part(scene, block, run):
    """Returns the CPU seconds of a run, from some steps at the place of this process."""
    explicit = run["role"] != QUFLOW and plan.is_explicit(run["integrator"])
    warm, steps = plan.part_of(block["n"], run["steps"], run["products"], explicit)
    h, place = block["time"] / run["steps"], block["process"] % plan.PLACES
    W = load(block, f"{REFERENCE}_place{place}" if place else INITIAL)
    if run["role"] == QUFLOW:
        return quflow_step.seconds_of(block["quflow"], W, h, steps, warm) / steps * run["steps"]
    method = method_of(scene, run["integrator"], run["tolerance"])
    if warm:
        W, _ = method.run(W, h, warm)
    _, report = method.run(W, h, steps)
    return report.seconds / report.equivalent_products * run["products"]


def time_passed(scene, block, run):
    """Returns the seconds that pass for a whole run by some threads."""
    method = method_of(scene, run["integrator"], run["tolerance"], threads=run["threads"])
    initial, h = scene.initial, block["time"] / run["steps"]
    begun = time.perf_counter()
    method.run(initial, h, run["steps"])
    return time.perf_counter() - begun
