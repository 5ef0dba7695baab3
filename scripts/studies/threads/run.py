"""Times a step of fast forms by one thread and by several, and compares the answers bit for bit.

Each fresh process is the program build/benchmarks/threads. It runs one method at one n from the initial state of the
rough scene by every number of threads, one after the other. The numbers rise in one process and fall in the next.
"""

import itertools
import os
from functools import partial

import isosyrk

from lib.programs.command_line import Stop, say, whole_number
from lib.records import formats
from lib.records.formats import INTEGRATORS
from lib.records.integrators import is_new
from lib.judging import verdicts
from lib.running import built, program, timed
from lib.running.checkpoint import Checkpoint
from studies.threads.plan import affordable, step_of
from studies.threads.schema import BY_PROCESS, SCHEMA, Run, Settings

SCENE = "rough"  # whose bands are full: what is timed is work, at every n
SIZES, QUICK_SIZES = (129, 257, 513, 1025), (97,)  # below 96 one thread does all, however many are asked for
METHODS = ("elp4_frame", "rk8_frame", "magnus5_frame", "group2")  # one a kind; new ones besides
THREADS = (1, 2, 4, 8, 16)  # as far as there are cores
PROCESSES, QUICK_PROCESSES = 8, 2  # at most, of one method at one n

# Warm-up steps, timed steps and repetitions within a process, up to an n. At n = 1025 the first step is timed, of which
# elp4_frame takes some 11 s by one thread, group2 40 s: a study of all takes about 25 minutes on two cores.
EFFORTS = {129: (8, 8, 2), 257: (4, 4, 1), 513: (1, 2, 1), 1025: (0, 1, 1)}


def blocks_of(entries, sizes, numbers):
    """Returns what a process runs: an Integrator at one n by all numbers of threads, which are its rows."""
    return [{"n": n, "integrator": entry.name, **step_of(entry, n), **effort_at(n),
             "rows": list(map(str, numbers))} for n in sizes for entry in entries]


def effort_at(n):
    found = next(effort for maximum, effort in EFFORTS.items() if n <= maximum)
    return dict(zip(("warmup", "steps", "repetitions"), found))


def command_of(block, process):
    """Returns the command of a process of a block."""
    options = {name: block[name] for name in ("n", "integrator", "step", "tolerance", "warmup", "steps", "repetitions")}
    numbers = block["rows"] if process % 2 == 0 else block["rows"][::-1]
    return [built.program("threads"), "--scene", SCENE,
            *itertools.chain(*((f"--{name}", str(value)) for name, value in options.items())),
            *itertools.chain(*(("--threads", number) for number in numbers))]


def results_of(printed, rows):
    """Returns the result of each row, in their order, from what the program printed: the least times, and shares."""
    found = {str(row["threads"]): row for row in printed["rows"]}
    return [{"seconds": formats.to_digits(min(found[row]["seconds"]), 5),
             "looking": formats.to_digits(min(found[row]["looking"]), 5),
             "operations": found[row]["operations"], "same": found[row]["same"],
             # Clocks may tell a little less than nothing.
             **{name: formats.to_digits(max(0.0, found[row][name]), 5) for name in ("serial", "waiting")}}
            for row in rows]


def further_processes(maximum, found):
    """Returns how many further processes a block wants until each number is judged against the one below, by row."""
    seconds = {row: [each["seconds"] for each in results] for row, results in found.items()}
    return dict.fromkeys(found, verdicts.further_processes(maximum, seconds, lambda times: [
        verdicts.compared(more, fewer) for fewer, more in zip(times.values(), list(times.values())[1:])]))


def runs_of(block, found):
    """Returns the rows of the table of a block, given its results by number of threads."""
    settings = {name: block[name] for name in ("n", "integrator", "step", "tolerance", "warmup", "steps")}
    return [Run(threads=int(row), **settings, **{name: [each[name] for each in results] for name in BY_PROCESS})
            for row, results in found.items()]


def entries_asked_for(names):
    """Returns the Integrators of these names, by default of METHODS and all new ones that have a fast form.

    Throws Stop for a name without one.
    """
    for entry in built.entries(names) if names else ():
        if not entry.has_fast_form:
            raise Stop(f"--integrator {entry.name!r}: has no fast form, and threads share the work of fast forms only")
    return built.entries(names or [name for name, each in built.integrators().items()
                                   if each.has_fast_form and (name in METHODS or is_new(each))])


def numbers_of(cores):
    """Returns the numbers of threads that are timed; none, which is told, where there is one core only."""
    if cores == 1:
        say("threads are not timed: there is one core only")
        return []
    return [number for number in THREADS if number <= cores]


def main(arguments):
    parser = program.parser("threads", __doc__.splitlines()[0], largest_n=SIZES[-1])
    parser.add_argument("--processes", type=whole_number(1, 100), help="at most; with fewer than"
                        f" {verdicts.FEWEST} all is undecided (default: {PROCESSES}, quick {QUICK_PROCESSES})")
    options = parser.parse_args(arguments)
    entries = entries_asked_for(options.integrator)
    sizes = affordable(options.n or (QUICK_SIZES if options.quick else SIZES))
    maximum = options.processes or (QUICK_PROCESSES if options.quick else PROCESSES)
    cores = os.sched_getaffinity(0)
    numbers = numbers_of(len(cores))
    built.program("threads")  # whether it is there, before any work

    checkpoint = Checkpoint("threads", options, partial(isosyrk.conditions, products="fastest",
                                                      sizes=sorted({min(n, 257) for n in sizes})))
    blocks = blocks_of(entries, sizes, numbers) if numbers else []
    found = timed.by_processes(blocks, command_of, partial(further_processes, maximum), checkpoint, "threads", cores,
                               results_of)
    formats.write_study(options.out, SCHEMA, checkpoint.context, Settings(SCENE, len(cores)), {
        INTEGRATORS: entries, "runs": [run for each in zip(blocks, found) for run in runs_of(*each)]})
    checkpoint.remove()
