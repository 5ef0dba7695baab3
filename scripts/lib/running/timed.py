"""Timed work of a study: interleaved, on one core, in this process or in fresh ones."""

import contextlib
import json
import math
import os
import statistics
import sys
import tempfile
from functools import partial

from lib.programs.command_line import NO_ANSWER, Stop
from lib.programs.messages import one_line
from lib.running import fresh_process
from lib.running.program import progress

ENOUGH = 0.6  # CPU seconds of timed work on a point, after which it is repeated no more
WARM_STEPS = 32  # untimed, of a method with a predictor, which knows 24 past steps at most (core/solver/tuning.h)
MIN_SECONDS = 0.01  # that a repetition fills with runs, so that clock and interruptions do not weigh


def seconds_of(method, W, h, steps, warmup=0):
    """Returns the CPU seconds of a run after `warmup` untimed steps: the mean of as many as fill MIN_SECONDS."""
    first = method.timed_run(W, h, steps, repetitions=1, warmup=warmup)[0]
    if first >= MIN_SECONDS:
        return first
    repetitions = math.ceil(MIN_SECONDS / max(first, 1e-6))
    return statistics.fmean(method.timed_run(W, h, steps, repetitions=repetitions, warmup=warmup))


def interleaved(points, repetitions, time_one, checkpoint, what, enough=ENOUGH):
    """Returns the CPU seconds of each point, a list of so many repetitions, by time_one(point).

    All points are timed once, in their order, then again: a slow minute of the machine falls on all alike. This process
    is kept on the last core meanwhile. A point on which `enough` seconds were spent is not repeated.
    """
    cores = os.sched_getaffinity(0)
    checkpoint.context["timed_on"] = f"core {max(cores)}"
    os.sched_setaffinity(0, {max(cores)})
    seconds = [[] for _ in points]
    try:
        with progress(len(points) * repetitions, what) as bar:
            for repetition in range(repetitions):
                for point, found in zip(points, seconds):
                    if sum(found) < enough:
                        key = checkpoint.key_of_timed(f"{what} {repetition}", point)
                        if key not in checkpoint.found:
                            checkpoint.add(key, time_one(point))
                        found.append(checkpoint.found[key])
                    bar.update()
    finally:
        os.sched_setaffinity(0, cores)
    return seconds


def by_processes(blocks, command, further, checkpoint, what, cores=None, results=lambda printed, rows: printed):
    """Returns the CPU seconds of the rows of each block, as dicts from a row to a list with an entry for each process.

    A block is an object of JSON whose "rows" are names. `command(block, process)` is a command that times the rows of a
    block interleaved and prints their seconds, a list of JSON; `process` counts from 0. Where it prints other JSON,
    `results(printed, rows)` makes of it the list that is kept, an entry a row, in place of seconds. `further(seconds)`
    returns, given the dict of a block so far, how many further processes each row wants; it is asked again when these
    are done. Every block gets its first process, then every block its second: a slow minute of the machine falls on all
    alike. They run on the last core, or on `cores`, a set; the checkpoint's context names them, a set
    under WHAT_timed_on. A disturbed process is repeated; those that stayed disturbed are counted in that context too,
    over all parts of the study.
    """
    where = "timed_on" if cores is None else f"{what.replace(' ', '_')}_timed_on"
    cores = cores or {fresh_process.last_core()}
    seconds = [{row: [] for row in block["rows"]} for block in blocks]
    wanted = [further(found) for found in seconds]
    done = process = 0
    with progress(sum(maximum(each) for each in wanted), what) as bar:
        while any(map(maximum, wanted)):
            for block, found, each in zip(blocks, seconds, wanted):
                part = {**block, "rows": [row for row in block["rows"] if each[row] > 0]}
                if not part["rows"]:
                    continue
                key = checkpoint.key_of_timed(f"{what}, process {process}", part)
                if key not in checkpoint.found:
                    times, disturbance = fresh_process.undisturbed(
                        partial(printed, cores, command(part, process), part["rows"], what, results),
                        partial(bar.write, file=sys.stderr))
                    checkpoint.add(key, {"seconds": times, "disturbed": bool(disturbance)})
                checkpoint.processes += 1
                checkpoint.disturbed += checkpoint.found[key]["disturbed"]
                for row, passed in zip(part["rows"], checkpoint.found[key]["seconds"]):
                    found[row].append(passed)
                    each[row] -= 1
                done += 1
                bar.update()
            process += 1
            wanted = [each if maximum(each) else further(found) for found, each in zip(seconds, wanted)]
            bar.total = done + sum(map(maximum, wanted))
    named = f"core{'s' if len(cores) > 1 else ''} {', '.join(map(str, sorted(cores)))}"
    disturbed = f"{checkpoint.disturbed} of {checkpoint.processes}"
    checkpoint.context.update({where: named, "disturbed_processes": disturbed})
    return seconds


def maximum(counts):
    return max(counts.values(), default=0)


def printed(cores, command, rows, what, results):
    """Runs a command on cores. Returns results(what it printed, rows), an entry a row, and the Disturbance."""
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        status, disturbance = fresh_process.run_on(cores, command, stdout=output, stderr=errors)
        output.seek(0)
        errors.seek(0)
        *_, last = [""] + errors.read().decode("utf-8", "replace").split("\n")[:-1]
        with contextlib.suppress(ValueError, TypeError, KeyError):
            found = results(json.loads(output.read()), rows)
            if status == 0 and len(found) == len(rows):
                return found, disturbance
    raise Stop(f"{what}: a process ended with status {status} and without its times: {one_line(last)}", NO_ANSWER)
