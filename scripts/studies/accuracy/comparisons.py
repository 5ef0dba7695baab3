"""The comparisons of the study of accuracy: methods at one error of one problem, timed interleaved in fresh processes.

The lines of the study tell which methods of a class (candidates.py) may be its best. Of each the fewest steps that
reach the error are found, whatever a linear limit says, and then whether some more, whose steps may have fewer sweeps,
take less work: no method spends time on a smaller error than the one wanted unless that is cheaper. Every method so
found is timed once, and the fastest stands for its class. Published forms have no lines: all of them are tried. Needs
isosyrk.
"""

import itertools
import math
import os
import random
from functools import partial

import isosyrk

from lib.records.formats import FAST, PUBLISHED
from lib.records.settings import Problem
from lib.judging import verdicts
from lib.running import program, timed, untimed
from studies.accuracy.candidates import CLASSES, EXPLICIT, members
from studies.accuracy.equal_error import cheap_forms
from studies.accuracy.schema import Comparison, Form
from studies.accuracy.single_runs import MAX_SWEEPS, Setting, rounded, scene_of, seconds_of_part

WANTED = (1e-4, 1e-6)  # the errors of all comparisons, ...
SHARP, LARGEST_SHARP = 1e-8, {("smooth", 50.0): 33, ("rough", 5.0): 65}  # ... of some besides, up to this n, ...
LONG_PROBLEM, LONG_WANTED = Problem("smooth", 50.0, 129), (1e-6,)  # ... and of one which takes long
# Published forms take ten times as long and more: they compete at one error, up to an n of each problem.
WANTED_PUBLISHED, LARGEST_PUBLISHED = 1e-6, {("smooth", 5.0): 129, ("rough", 5.0): 65}
CLOSE = 1.02  # the search ends when the failing number of steps is at most this far from the working one
# So many times the fewest steps are tried too, until they take TOO_MUCH times the least work; none for methods whose
# step always takes the same. Near the step at which Picard sweeps no longer contract, up to e times the steps pay.
MORE = {FAST: (1.02, 1.04, 1.06, 1.08, 1.1, 1.25, 1.5, 2.0), PUBLISHED: (1.05, 1.1, 1.25, 1.5, 1.8, 2.2, 2.7)}
TOO_MUCH = 1.15
FURTHER, MAX_MORE = 1.2, 8  # more steps while all fail: from one run to the next, and at most
BY_ORDER, MAX_RUNS = 10, 30  # runs of a search whose order tells the next one, and of all
CLOSE_COST = 1.25  # a method whose line costs at most so many times the least may stand as well
REPETITIONS = 2  # interleaved within a process, of which the least counts; once for runs of
LONG = 0.3  # CPU seconds or more


# ---- who may stand for a class


def wanted_of(problem):
    """Returns the errors of the comparisons of a problem."""
    if problem == LONG_PROBLEM:
        return LONG_WANTED
    return (*WANTED, SHARP) if problem.n <= LARGEST_SHARP.get(problem[:2], 0) else WANTED


def is_published_comparison(problem, wanted):
    """Tells whether published forms compete in a comparison."""
    return wanted == WANTED_PUBLISHED and problem.n <= LARGEST_PUBLISHED.get(problem[:2], 0)


def jobs_of(found, problem, wanted, references):
    """Returns a job for each method that may stand in a comparison, with the steps from which cheapest_steps() begins.

    `found` is an Accuracy without comparisons. A class whose lines do not reach the error is left out; so is one with a
    line that was cut and might have been the cheapest.
    """
    jobs = []
    for candidate, kind in CLASSES.items():
        tolerance, entries = kind.tolerance_for(wanted), members(found.integrators.values(), candidate)
        if tolerance is None or (kind.solver == PUBLISHED and not is_published_comparison(problem, wanted)):
            continue
        if kind.solver == FAST:
            forms = [Form(each.name, kind.line_tolerance(wanted)) for each in entries]
            costs = [(form.integrator, cost)
                     for form, cost in cheap_forms(found, problem, wanted, forms, CLOSE_COST, beyond=True)
                     if cost.fine.solver == FAST]
        else:  # from the steps of the fast Gauss method of the same order on
            costs = [(each.name, found.cost(problem, fast.name, wanted)) for each in entries
                     for fast in members(found.integrators.values(), "gauss") if fast.order == each.order]
        jobs += [{**problem._asdict(), "wanted": wanted, "candidate": candidate, "integrator": name,
                  "solver": kind.solver, "tolerance": tolerance, "steps": math.ceil(problem.time / cost.step),
                  "references": references} for name, cost in costs if cost]
    return jobs


# ---- its steps


def cheapest_steps(job):
    """Returns the row of a method as fields of Comparison, without its times: its steps that take least work.

    The search begins with `steps` of the job. Work is counted in equivalent products. None if no steps reach the error,
    as at a tolerance that is too loose for it.
    """
    setting = Setting(job)
    look = partial(run_of, job, setting)
    fewest = best = fewest_steps(look, job["steps"], job["wanted"], setting.entry.order)
    more = () if fewest is None or CLASSES[job["candidate"]].even else MORE[job["solver"]]
    for steps in dict.fromkeys(math.ceil(times * fewest.steps) for times in more):
        run = look(steps)
        if not is_reached(job["wanted"], run) or run.equivalent_products > TOO_MUCH * best.equivalent_products:
            break
        best = min(best, run, key=lambda each: each.equivalent_products)
    return best and row_of(job, best)


def fewest_steps(look, steps, wanted, order, close=CLOSE):
    """Returns the run with the fewest steps that reach an error, to a factor `close`; None if none do.

    `look(steps)` makes a run. Between the most steps that fail and the fewest that do not, the next are those that the
    order tells from the last run, or the middle.
    """
    failing, working, maximum = 0, None, MAX_MORE * steps
    for count in range(MAX_RUNS):
        run = look(steps)
        told = math.ceil(steps * (run.error / wanted) ** (1 / order)) if run.usable and count < BY_ORDER else 0
        if is_reached(wanted, run):
            working = run
        else:
            failing = steps
        if working is None:
            if failing > maximum:
                return None
            steps = max(math.ceil(FURTHER * failing), min(told, 2 * failing))
        elif working.steps <= max(failing + 1, close * failing):
            break
        elif failing < told < working.steps:
            steps = told
        elif told >= working.steps:
            steps = max(failing + 1, math.floor(working.steps / close - 1e-9))
        else:
            steps = max(failing + 1, min(working.steps - 1, round((failing * working.steps) ** 0.5)))
    return working


def run_of(job, setting, steps):
    """Returns the Run of a job with so many steps."""
    return setting.look(setting.method(job["tolerance"]), steps, job["tolerance"])[0]


def is_reached(wanted, run):
    """Tells whether a run came to its end with an error that is small enough, beyond a limit of stability or not."""
    return run.usable and run.error <= wanted


def row_of(job, run):
    """Returns a run as fields of Comparison, without its times."""
    return {**{name: getattr(run, name) for name in Comparison._fields if hasattr(run, name)},
            "wanted": job["wanted"], "candidate": job["candidate"]}


def standing(rows, seconds):
    """Returns the rows that stand for their classes: of each comparison and class the one with the least seconds."""
    best = {}
    for row, each in zip(rows, seconds, strict=True):
        key = (*(row[name] for name in Problem._fields), row["wanted"], row["candidate"])
        if key not in best or each < best[key][0]:
            best[key] = each, row
    return [row for _, row in best.values()]


# ---- its times


def blocks_of(rows, references, products):
    """Returns what is timed together: for each problem and error the runs of its candidates.

    `rows` are those of comparisons(), where a comparison's rows follow each other. `products(n)` names the backend of
    published forms.
    """
    blocks = []
    for key, group in itertools.groupby(rows, lambda row: (*(row[name] for name in Problem._fields), row["wanted"])):
        runs = {}
        for row in group:
            runs[row["candidate"]] = {name: row[name] for name in ("integrator", "solver", "tolerance", "steps")}
            if row["solver"] == PUBLISHED:
                runs[row["candidate"]]["products"] = products(row["n"])
        blocks.append({"problem": key[:-1], "wanted": key[-1], "references": references, "rows": list(runs),
                       "runs": runs})
    return blocks


def time_block(block):
    """Returns the CPU seconds of a run of each row, the least of interleaved repetitions, in changing order.

    `process` of the block tells the orders of one process from those of another.
    """
    scene = scene_of(*block["problem"], block["references"])
    shuffled = random.Random(block["process"])
    found = {row: [] for row in block["rows"]}
    for _ in range(REPETITIONS):
        for row in shuffled.sample(block["rows"], len(block["rows"])):
            if found[row] and min(found[row]) >= LONG:
                continue
            run = dict(block["runs"][row])
            steps = run.pop("steps")
            method = isosyrk.integrator(scene, run.pop("integrator"), max_sweeps=MAX_SWEEPS[run["solver"]], **run)
            found[row].append(timed.seconds_of(method, scene.initial, block["problem"][1] / steps, steps))
    return [min(each) for each in found.values()]


def further_processes(maximum, seconds):
    """Returns how many further processes each row of a block wants, given its seconds by process so far.

    A row stops once it is told from the best explicit method, or else the first row, which stops with the last of them.
    """
    first = EXPLICIT if EXPLICIT in seconds else next(iter(seconds))
    wanted = {}
    for row, times in seconds.items():
        if row != first:
            pair = {each: seconds[each][:len(times)] for each in (first, row)}
            stopped = len(times) < len(seconds[first])
            wanted[row] = 0 if stopped else verdicts.further_processes(maximum, pair, lambda found: [
                verdicts.compared(found[first], found[row])])
    alone = max(0, min(maximum, verdicts.FEWEST) - len(seconds[first]))
    return {**wanted, first: max(wanted.values(), default=alone)}


def time_row(row, references, products):
    """Returns the CPU seconds of the run of a row, as time_block() times it, or scaled from its first steps."""
    run = dict(blocks_of([row], references, products)[0]["runs"][row["candidate"]])
    steps, scene = run.pop("steps"), scene_of(row["scene"], row["time"], row["n"], references)
    method = isosyrk.integrator(scene, run.pop("integrator"), max_sweeps=MAX_SWEEPS[run["solver"]], **run)
    return seconds_of_part(method, scene.initial, row["time"] / steps, steps, row["equivalent_products"])


def comparisons(found, options, checkpoint):
    """Returns the rows of all comparisons. `found` is the Accuracy of the lines."""
    references = os.path.realpath(options.references)
    jobs = [job for problem in found.problems() for wanted in wanted_of(problem)
            for job in jobs_of(found, problem, wanted, references)]
    rows = list(filter(None, untimed.results(jobs, cheapest_steps, checkpoint, options, "steps of comparisons")))
    time_one = partial(time_row, references=references, products=checkpoint.products)
    once = timed.interleaved(rows, 1, time_one, checkpoint, "choices")
    rows = standing(rows, [seconds for (seconds,) in once])
    blocks = blocks_of(rows, references, checkpoint.products)

    command = partial(program.process_command, "accuracy")
    further = partial(further_processes, options.processes)
    times = timed.by_processes(blocks, command, further, checkpoint, "comparisons")
    seconds = [each for block in times for each in block.values()]
    return [rounded(Comparison(**{**row, "cpu_seconds": each})) for row, each in zip(rows, seconds)]
