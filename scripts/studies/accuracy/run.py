"""Runs every integrator over step sizes, lets methods compete at equal error, and varies the tolerance of Table 1.

A line is one integrator at one tolerance on one problem: a scene, n and a time. Its runs take more and more steps (as
many as in Table 1 at least), until the error no longer falls, is below GOOD_ENOUGH, or a run took enough work: then the
line is cut. Every integrator runs by its fast form if it has one. Lines are those of the methods that may stand for a
class in a comparison (candidates.py), at the tolerances of the classes; the main problem, that of Table 1, has lines of
the others too, at small n.

First every run is made once and looked at; then all are timed, interleaved, so that a slow minute of the machine falls
on all alike. Then the comparisons (comparisons.py) follow. Counts and errors of published forms are those of OpenBLAS's
products, times those of the backend that was the faster at the start: counts that followed the clock would differ from
machine to machine.
"""

import os
import statistics

import isosyrk

from lib.programs.command_line import whole_number
from lib.programs.places import REFERENCES
from lib.records import formats
from lib.records.formats import FAST, PUBLISHED, Study
from lib.records.integrators import TABLE1_CELLS
from lib.records.settings import TABLE1_STEP
from lib.judging import verdicts
from lib.running import built, problems, program, timed, untimed
from lib.running.checkpoint import Checkpoint
from studies.accuracy import comparisons as comparisons
from studies.accuracy.lines import accuracy
from studies.accuracy.plan import UNIT, end_of, is_main, lines_of, quick_integrators, steps_of, took_enough
from studies.accuracy.schema import ALONE, CUT, SCHEMA, Line, Rate, Reference, Run, Settings
from studies.accuracy.single_runs import Setting, rounded, scene_of, seconds_of_part

REPETITIONS = 1  # timings of each run; comparisons, from which verdicts come, have processes
QUICK_PROCESSES = 6  # at most, that time a comparison


TOLERANCES = tuple(10.0**-exponent for exponent in range(4, 16))
# The tolerances are not varied beyond, where that would take as long as all else.
LARGEST_TOLERANCE_SIZE = 33
RATES = 5  # measurements of a product rate, of which the median counts


# ---- untimed: a line, or the tolerances of one cell


def draw_line(job):
    """Returns the runs of the line of a job, as fields of Run, and how it ends."""
    setting, tolerance = Setting(job), job["tolerance"]
    method, order = setting.method(tolerance), setting.entry.order
    runs, usable, end = [], [], None
    for steps_of_unit in steps_of(job):
        as_in_table1 = steps_of_unit >= UNIT / TABLE1_STEP
        if end and not as_in_table1:
            continue
        runs.append(setting.look(method, round(steps_of_unit * job["time"] / UNIT), tolerance)[0])
        if runs[-1].usable:
            usable.append(runs[-1])
            end = end or end_of(usable, setting.uncertainty, order)
        if as_in_table1 and (end or took_enough(runs[-1], job["quick"])):
            break
    return {"end": ALONE if job["table1_step"] else end or CUT, "runs": [run._asdict() for run in runs]}


def vary_tolerance(job):
    """Returns the runs of one cell of Table 1 at each tolerance, from loose to tight."""
    setting = Setting(job)
    steps = round(job["time"] / TABLE1_STEP)
    runs, states = zip(*(setting.look(setting.method(tolerance), steps, tolerance) for tolerance in TOLERANCES))
    tightest = next((W for W in reversed(states) if W is not None), None)
    return [{**run._asdict(), "solver_error": None if W is None else isosyrk.relative_error(W, tightest)}
            for run, W in zip(runs, states)]


# ---- timed


def time_one(point, folder):
    """Returns the CPU seconds of a run [scene, time, n, integrator, solver, tolerance, backend of products, steps,
    equivalent products], as the mean of a few."""
    scene, time, n, integrator, solver, tolerance, products, steps, work = point
    setting = scene_of(scene, time, n, folder)
    method = isosyrk.integrator(setting, integrator, solver=solver, tolerance=tolerance,
                                **({"products": products} if solver == PUBLISHED else {}))
    return seconds_of_part(method, setting.initial, time / steps, steps, work)


def rate_of(n, checkpoint):
    """Returns the product rates at n, as measured when the study began."""
    key = checkpoint.key_of_timed("rates", n)
    if key not in checkpoint.found:
        checkpoint.add(key, [statistics.median(isosyrk.product_rate(n, solver) for _ in range(RATES))
                          for solver in (PUBLISHED, FAST)])
    return Rate(n, *checkpoint.found[key])


# ---- the study


def parse(arguments):
    parser = program.parser("accuracy", __doc__.splitlines()[0])
    problems.add_filters(parser)
    parser.add_argument("--references", metavar="FOLDER", default=REFERENCES,
                        help="what scripts/measure references wrote (default: the recorded ones)")
    parser.add_argument("--repetitions", metavar="K", type=whole_number(1, 1000), default=REPETITIONS,
                        help="timings of each run (default: %(default)s)")
    parser.add_argument("--processes", metavar="K", type=whole_number(1, 100),
                        help=f"that time a comparison at most; with fewer than {verdicts.FEWEST} all is undecided"
                        f" (default: {verdicts.MAXIMUM}, quick {QUICK_PROCESSES})")
    options = parser.parse_args(arguments)
    if options.processes is None:
        options.processes = QUICK_PROCESSES if options.quick else verdicts.MAXIMUM
    return options


def main(arguments):
    options = parse(arguments)
    chosen = built.entries(options.integrator, frames=True)
    if options.quick and not options.integrator:
        chosen = quick_integrators(chosen)
    wanted = problems.asked_for(options)
    references = [reference_row(problem, problems.reference_of(problem, options.references)[1]) for problem in wanted]
    for problem in wanted:
        problems.scene_of(problem, options.references)  # so that initial data that cannot be used are told now
    sizes = sorted({problem.n for problem in wanted})
    checkpoint = Checkpoint("accuracy", options, lambda: isosyrk.conditions(sizes=sizes))
    rates = [rate_of(n, checkpoint) for n in sizes]

    folder = os.path.realpath(options.references)
    ordered = sorted(wanted, key=lambda problem: (problem.n, problem.time))  # the longest last
    jobs = []
    for problem in ordered:
        forms, alone = lines_of(problem, chosen, options.integrator is not None)
        jobs += [{**problem._asdict(), **form._asdict(), "solver": built.solver_of(form.integrator),
                  "table1_step": form in alone, "references": folder, "quick": options.quick} for form in forms]
    lines = untimed.results(jobs, draw_line, checkpoint, options, "lines")
    cells = untimed.results([{**problem._asdict(), "integrator": entry.name, "solver": PUBLISHED, "references": folder}
                           for problem in ordered if is_main(problem) and problem.n <= LARGEST_TOLERANCE_SIZE
                           for entry in chosen if entry.name in TABLE1_CELLS],
                          vary_tolerance, checkpoint, options, "tolerances")

    runs, tolerance_runs = ([Run(**run) for each in found for run in each]
                            for found in ((line["runs"] for line in lines), cells))
    points = [[*run.problem, run.integrator, run.solver, run.tolerance,
               checkpoint.products(run.n) if run.solver == PUBLISHED else None, run.steps, run.equivalent_products]
              for run in (*runs, *tolerance_runs) if run.usable]
    seconds = iter(timed.interleaved(points, options.repetitions, lambda point: time_one(point, folder), checkpoint,
                                  "timings"))

    def completed(runs):
        return [rounded(run._replace(cpu_seconds=next(seconds) if run.usable else ())) for run in runs]

    tables = {"references": references, "rates": rates, "integrators": chosen,
              "lines": [Line(**{name: job[name] for name in Line._fields if name in job}, end=line["end"])
                        for job, line in zip(jobs, lines)],
              "runs": completed(runs), "tolerance_runs": completed(tolerance_runs), "comparisons": []}
    found = accuracy(Study(checkpoint.context, Settings(options.quick), tables))
    tables["comparisons"] = comparisons.comparisons(found, options, checkpoint)
    formats.write_study(options.out, SCHEMA, checkpoint.context, Settings(options.quick), tables)
    checkpoint.remove()


def reference_row(problem, record):
    both = record["first"], record["second"]
    return Reference(*problem, record["uncertainty"], [run["integrator"] for run in both],
                     [run["steps"] for run in both])


time_block = comparisons.time_block
