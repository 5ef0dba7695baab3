"""Measures what the practice costs, and what reaches its error, or a tenth of it, for less.

The practice is the isospectral midpoint with h = ħ/4, by the fast form and, where QUFLOW names a checkout of quflow, by
quflow's own step. First initial data, the practice and two references of each problem are computed, stage by stage:
their states stand in a folder beside the raw file until that is written. Then of each method the fewest steps are
found. Last, fresh processes time all rows of a problem interleaved, and the fast forms by one thread and by two.
"""

import os
import shutil
from functools import partial

import isosyrk

from lib.programs.command_line import NO_ANSWER, Stop, whole_number
from lib.programs.output import make_folder
from lib.records import formats
from lib.records.formats import INTEGRATORS
from lib.running import built, program, timed, untimed
from lib.running.checkpoint import Checkpoint, key_of, require_writable
from studies.practice import plan, quflow_step, single_runs, timing
from studies.practice.plan import SIZES
from studies.practice.schema import (AT_PRACTICE, BASELINE_INTEGRATOR, BASELINE_TOLERANCE, PRACTICE, QUFLOW, SCENES,
                                     SCHEMA, Problem, Row, Settings, ThreadRow)
from studies.practice.single_runs import INITIAL, REFERENCE, rounded
from studies.threads.plan import affordable
from studies.turbulence.single_runs import DEGREES

SECOND = "second_reference"
DIGITS = 4  # of times


def parse(arguments):
    parser = program.parser("practice", __doc__.splitlines()[0], largest_n=SIZES[-1])
    parser.add_argument("--scene", choices=SCENES, nargs="+", action="extend", help="(default: all)")
    parser.add_argument("--processes", type=whole_number(1, 100), help="that time a problem; with fewer than"
                        f" {plan.PROCESSES} all is undecided (default: {plan.PROCESSES}, quick {plan.QUICK_PROCESSES})")
    options = parser.parse_args(arguments)
    if options.integrator:
        options.integrator = [each.method for each in built.entries(options.integrator)]
    return options


# ---- untimed stages


def with_states(checkpoint, options):
    """Returns a function (jobs, work, what) as untimed.results, which does again what lost its states."""
    def results(jobs, work, what):
        for job in jobs:
            key = key_of(what, job)
            if key in checkpoint.found and not single_runs.is_kept(job, checkpoint.found[key]["states"]):
                del checkpoint.found[key]
        return untimed.results(jobs, work, checkpoint, options, what)
    return results


def prepared(problems, results):
    """Returns what is known of each problem: its record, the row of the practice, and the wanted errors, by name.

    Throws Stop where two references differ by more than a hundredth of the smallest wanted error.
    """
    begun = results(problems, single_runs.begin, "initial data")
    practised = results(problems, single_runs.practise, "the practice")
    jobs = [{**problem, "integrator": name, "what": what} for problem, found in zip(problems, practised)
            for name, what in zip(plan.reference_methods(found["in_frame"]), (REFERENCE, SECOND))]
    solved = dict(zip(map(str, jobs), results(jobs, single_runs.solve, "references")))
    for problem, start, found in zip(problems, begun, practised):
        own = [job for job in jobs if all(job[name] == problem[name] for name in ("scene", "n"))]
        both = [solved[str(job)] for job in own]
        error, errors = single_runs.errors_of(problem)
        difference = isosyrk.relative_error(*(single_runs.load(problem, what) for what in (SECOND, REFERENCE)))
        if not difference <= plan.MAX_DIFFERENCE * error:
            raise Stop(f"references of the {problem['scene']} scene at n = {problem['n']} differ by {difference:.1e},"
                       f" too much for an error of {error:.1e}", NO_ANSWER)
        yield Problem(problem["scene"], problem["n"], problem["time"], found["in_frame"], found["norm_ad_B"],
                      start["developed"], start["tail"], start["states"][INITIAL], both[0]["states"][REFERENCE],
                      [job["integrator"] for job in own], [each["steps"] for each in both],
                      [each["error"] for each in both], rounded(difference)), {
                          "role": PRACTICE, "wanted": AT_PRACTICE, "integrator": BASELINE_INTEGRATOR,
                          "tolerance": BASELINE_TOLERANCE, **found["row"], "error": rounded(error)}, errors


def rows_of(problems, known, quflow, options, checkpoint):
    """Returns the rows of each problem as fields of Row, without times: the practice, quflow, and methods.

    `quflow` is the folder of its checkout, or None.
    """
    jobs = []
    for problem, (record, _, errors) in zip(problems, known):
        if quflow and record.n <= plan.MIDDLE:
            jobs.append({**problem, "quflow": quflow})
        for entry in plan.methods_of(record.n, record.in_frame, options.integrator):
            forms = plan.forms_of(entry, min(errors.values()), record.n)
            jobs.append({**problem, "integrator": entry.name, "tolerances": [form.tolerance for form in forms],
                         "errors": {name: float(f"{error:.6e}") for name, error in errors.items()}})
    found = untimed.results(jobs, search, checkpoint, options, "fewest steps")
    for problem, (_, practice, _) in zip(problems, known):
        yield [practice, *(row for job, rows in zip(jobs, found) for row in rows
                           if (job["scene"], job["n"]) == (problem["scene"], problem["n"]))]


def search(job):
    """Returns the rows of a job. quflow runs in a process that ends by itself: its compiler leaves locks behind."""
    if "quflow" not in job:
        return single_runs.find(job)
    command = program.process_command("practice", {**job, "kind": QUFLOW}, 0)
    return timed.printed(os.sched_getaffinity(0), command, [QUFLOW], QUFLOW, lambda printed, _rows: printed)[0]


# ---- timed


def times_of(blocks, options, checkpoint, what, quflow=None, cores=None):
    """Returns the seconds of the rows of some blocks, as dicts by row of lists by process."""
    maximum = options.processes or (plan.QUICK_PROCESSES if options.quick else plan.PROCESSES)

    def command(block, process):
        return program.process_command("practice", block, process, folder=states_of(options), quflow=quflow)

    return timed.by_processes(blocks, command, partial(timing.further_processes, maximum), checkpoint, what, cores)


def time_block(block):
    """Returns what a fresh process prints: the seconds of the rows of a block, or the row of quflow's run."""
    return [single_runs.run_quflow(block)] if block["kind"] == QUFLOW else timing.time_block(block)


def digits_of(times):
    return [formats.to_digits(each, DIGITS) for each in times]


def row_record(problem, row, seconds):
    return Row(scene=problem["scene"], n=problem["n"], cpu_seconds=digits_of(seconds),
               **{name: row.get(name) for name in Row._fields if name not in ("scene", "n", "cpu_seconds")})


def thread_rows(block, found):
    """Returns the rows of the table of threads that a block gave."""
    return [ThreadRow(block["scene"], block["n"], run["integrator"], run["tolerance"], run["steps"], run["threads"],
                      digits_of(found[name])) for name, run in block["runs"].items()]


# ---- the study


def states_of(options):
    return f"{os.path.realpath(options.out)}.states"


def settings_of(options, cores):
    return Settings(quick=options.quick, quflow=options.quflow, cores=cores, lowest_degree=DEGREES[0],
                    highest_degree=DEGREES[-1], sample=plan.SAMPLE, tail_from=plan.TAIL_FROM,
                    tail_share=plan.TAIL_SHARE, largest_whole=plan.LARGEST_WHOLE,
                    places=plan.PLACES, largest_whole_quflow=plan.LARGEST_WHOLE_QUFLOW)


def main(arguments):
    options = parse(arguments)
    # What was run of quflow belongs to the checkpoint; where it lies does not.
    quflow, options.quflow = quflow_step.checkout()
    sizes = affordable(options.n or (plan.QUICK_SIZES if options.quick else SIZES))
    listed = plan.problems_of(sizes, options.scene or SCENES)
    require_writable(options.out)
    folder, cores = states_of(options), os.sched_getaffinity(0)
    checkpoint = Checkpoint("practice", options, partial(isosyrk.conditions, products="openblas",
                                                         sizes=sorted({min(n, plan.MIDDLE) for n in sizes})))
    make_folder("--out", folder)
    problems = [{**problem, "folder": folder} for problem in sorted(listed, key=lambda each: each["n"])]
    known = list(prepared(problems, with_states(checkpoint, options)))
    rows = list(rows_of(problems, known, quflow, options, checkpoint))

    plain = [{name: problem[name] for name in ("scene", "n", "time")} for problem in problems]
    blocks = [timing.cpu_block(problem, each) for problem, each in zip(plain, rows)]
    seconds = [timing.seconds_by_row(each, found) for each, found in zip(rows, times_of(
        blocks, options, checkpoint, timing.CPU, quflow))]
    numbers = [number for number in plan.THREADS if number <= len(cores)] if len(cores) > 1 else []
    shared = [block for problem, each in zip(plain, rows)
              if problem["scene"] == plan.THREAD_SCENE and problem["n"] <= plan.LARGEST_THREADED
              and (block := timing.thread_block(problem, each, numbers))["rows"]]
    passed = times_of(shared, options, checkpoint, timing.PASSED, cores=cores)

    named = dict.fromkeys([BASELINE_INTEGRATOR, *(name for record, *_ in known for name in record.references),
                           *(row["integrator"] for each in rows for row in each)])
    formats.write_study(options.out, SCHEMA, checkpoint.context, settings_of(options, len(cores)), {
        INTEGRATORS: built.entries(named), "problems": [record for record, *_ in known],
        "runs": [row_record(problem, *pair) for problem, each, times in zip(plain, rows, seconds)
                 for pair in zip(each, times)],
        "threads": [row for each in zip(shared, passed) for row in thread_rows(*each)]})
    checkpoint.remove()
    shutil.rmtree(folder)
