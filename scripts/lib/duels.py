"""The duels of the study of accuracy: methods at one error of one problem, timed in turns in fresh processes.

The lines of the study tell which methods may stand for a contender. Of each the fewest steps that reach the error are
found by bisection, and then whether some more, whose steps may have fewer sweeps, take less work: no method spends time
on a smaller error than the one wanted unless that is cheaper. The method with the least work stands. Gauss and
exponential methods compete at a tolerance matched to the error too, where that is looser. Needs isosyrk.
"""

import itertools
import math
import os
import random
from functools import partial

import isosyrk
from lib import study
from lib import verdicts
from lib.accuracy_lines import CONTENDERS, LOOSE_EXPONENTIAL, LOOSE_GAUSS, MATCHED, TIGHT, Duel, Problem
from lib.accuracy_runs import MAX_SWEEPS, Setting, rounded, scene_of
from lib.equal_error import cheap_forms
from lib.formats import FAST, PUBLISHED
from lib.integrator_names import frameless, gauss_stages, in_frame

WANTED = (1e-4, 1e-6)  # the errors of duels
# The published form of the Gauss method that wins takes ten times as long: once a problem is enough.
WANTED_PUBLISHED, LARGEST_PUBLISHED, TIME_PUBLISHED = 1e-6, 129, 5.0
MATCHED_TO = {"gauss_loose": "gauss_matched", "elp": "elp_matched"}  # contenders that compete at that tolerance too
CLOSE = 1.02  # bisection ends when the failing number of steps is at most this far from the working one
FURTHER, MOST_FURTHER = 1.1, 1.6  # other numbers of steps are tried by this factor, up to this many times the first
CLOSE_COST = 1.25  # a method whose line costs at most so many times the least may stand as well
REPETITIONS = 2  # in turns within a process, of which the least counts; once for runs of
LONG = 0.3  # CPU seconds or more


# ---- who stands for a contender


def may_stand(contender, form):
    """Tells whether a Form may stand for a contender."""
    name = frameless(form.integrator)
    if contender in ("gauss", "gauss_loose"):
        return bool(gauss_stages(name)) and form.tolerance == (TIGHT if contender == "gauss" else LOOSE_GAUSS)
    if contender in ("elp", "elp_tight"):
        return name.startswith("elp") and form.tolerance == (TIGHT if contender == "elp_tight" else LOOSE_EXPONENTIAL)
    if contender == "magnus":
        return name.startswith("magnus") and form.tolerance == LOOSE_EXPONENTIAL
    return name == contender


def champions(found, problem, wanted):
    """Returns the [(Form, Cost), ...] of each contender by which it reaches an error at or near the least cost.

    In the co-rotating frame, the cheapest first. `found` is an Accuracy without duels. A contender that reaches the
    error by no line is left out; so is one with a line that was cut and might have been the cheaper.
    """
    result = {}
    for contender in CONTENDERS:
        forms = [form for form in found.forms() if in_frame(form.integrator) and may_stand(contender, form)]
        if cheap := cheap_forms(found, problem, wanted, forms, CLOSE_COST):
            result[contender] = cheap
    return result


def jobs_of(found, problem, wanted, references):
    """Returns a job for each method that may stand in a duel: between which numbers of steps cheapest_steps() looks."""
    jobs = [{**problem._asdict(), "wanted": wanted, "contender": contender, "integrator": form.integrator,
             "solver": cost.fine.solver, "tolerance": form.tolerance, "coarse": cost.coarse.steps,
             "fine": cost.fine.steps, "references": references}
            for contender, cheap in champions(found, problem, wanted).items() for form, cost in cheap]
    matched = wanted / MATCHED
    jobs += [{**job, "contender": MATCHED_TO[job["contender"]], "tolerance": matched} for job in jobs
             if job["contender"] in MATCHED_TO and job["tolerance"] < matched]
    return jobs


# ---- its steps


def cheapest_steps(job):
    """Returns the row of a method as fields of Duel, without its times: the steps that reach the error with least work.

    On its line `fine` steps do, `coarse` steps do not, unless both are the same. Work is counted in equivalent
    products. None if no steps reach the error, as at a tolerance that is looser than that of the line.
    """
    look, reaches = partial(run_of, job, Setting(job)), partial(is_reached, job["wanted"])

    def others(first, factor):
        """Returns the runs with more and more or fewer and fewer steps than a first one, while they reach the error.

        All of them, since work may rise from one number of steps to the next and fall again: a step that needs one
        sweep less may be only a little shorter.
        """
        runs, steps, to_whole = [], first.steps, math.ceil if factor > 1 else math.floor
        while first.steps / MOST_FURTHER <= (steps := to_whole(factor * steps)) <= MOST_FURTHER * first.steps:
            run = look(steps)
            if not reaches(run):
                break
            runs.append(run)
        return runs

    failing, fewest = job["coarse"], look(job["fine"])
    while not reaches(fewest):
        if fewest.steps > MOST_FURTHER * job["fine"]:
            return None
        failing, fewest = fewest.steps, look(math.ceil(FURTHER * fewest.steps))
    while failing < fewest.steps - 1 and fewest.steps > CLOSE * failing:
        middle = look(round((failing * fewest.steps) ** 0.5))
        if reaches(middle):
            fewest = middle
        else:
            failing = middle.steps
    runs = [fewest, *others(fewest, FURTHER)]
    if job["coarse"] == job["fine"]:  # no fewer steps are known to fail
        runs += others(fewest, 1 / FURTHER)
    return row_of(job, min(runs, key=lambda run: run.equivalent_products))


def run_of(job, setting, steps):
    """Returns the Run of a job with so many steps."""
    return setting.look(setting.method(job["tolerance"]), steps, job["tolerance"])[0]


def is_reached(wanted, run):
    """Tells whether a run came to its end within the limit of stability with an error that is small enough."""
    return run.usable and not run.beyond_limit and run.error <= wanted


def row_of(job, run):
    """Returns a run as fields of Duel, without its times."""
    return {**{name: getattr(run, name) for name in Duel._fields if hasattr(run, name)},
            "wanted": job["wanted"], "contender": job["contender"]}


def standing(rows):
    """Returns the rows of the methods that stand for the contenders: those of cheapest_steps() with the least work."""
    best = {}
    for row in rows:
        key = (*(row[name] for name in Problem._fields), row["wanted"], row["contender"])
        if key not in best or row["equivalent_products"] < best[key]["equivalent_products"]:
            best[key] = row
    return list(best.values())


def with_published(row):
    """Tells whether the published form of a row is timed beside it."""
    return (row["contender"] == "gauss" and row["solver"] == FAST and row["wanted"] == WANTED_PUBLISHED
            and row["n"] <= LARGEST_PUBLISHED and row["time"] == TIME_PUBLISHED)


def published_form(job):
    """Returns the row of the published form of a row of cheapest_steps(), with the same steps and the same answer.

    None if its sweeps fail with those steps. The job is the row and the folder of `references`.
    """
    job = {**job, "contender": "gauss_published", "solver": PUBLISHED}
    run = run_of(job, Setting(job), job["steps"])
    return row_of(job, run) if is_reached(job["wanted"], run) else None


# ---- its times


def blocks_of(rows, references, products):
    """Returns what is timed together: for each problem and error the runs of its contenders.

    `rows` are those of duels(), where a duel's rows follow each other. `products(n)` names the backend of published
    forms.
    """
    blocks = []
    for key, group in itertools.groupby(rows, lambda row: (*(row[name] for name in Problem._fields), row["wanted"])):
        runs = {}
        for row in group:
            runs[row["contender"]] = {name: row[name] for name in ("integrator", "solver", "tolerance", "steps")}
            if row["solver"] == PUBLISHED:
                runs[row["contender"]]["products"] = products(row["n"])
        blocks.append({"problem": key[:-1], "wanted": key[-1], "references": references, "rows": list(runs),
                       "runs": runs})
    return blocks


def time_block(block):
    """Returns the CPU seconds of a run of each row, the least of repetitions in turns, in changing order.

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
            found[row].append(study.seconds_of(method, scene.initial, block["problem"][1] / steps, steps))
    return [min(each) for each in found.values()]


def further_processes(most, seconds):
    """Returns how many further processes each row of a block wants, given its seconds by process so far.

    The rows stop together, once the exponential method, or else the first, is told from each of the others.
    """
    first = "elp" if "elp" in seconds else next(iter(seconds))
    return dict.fromkeys(seconds, verdicts.further_processes(most, seconds, lambda found: [
        verdicts.compared(found[first], found[other]) for other in found if other != first]))


def duels(found, options, journal, program):
    """Returns the rows of all duels. `found` is the Accuracy of the lines; `program` is the path of the study."""
    references = os.path.realpath(options.references)
    jobs = [job for problem in found.problems() for wanted in WANTED
            for job in jobs_of(found, problem, wanted, references)]
    fast = standing(filter(None, study.untimed(jobs, cheapest_steps, journal, options, "duels")))
    published = iter(study.untimed([{**row, "references": references} for row in fast if with_published(row)],
                                   published_form, journal, options, "published forms"))
    rows = [each for row in fast for each in ((row, next(published)) if with_published(row) else (row,)) if each]
    blocks = blocks_of(rows, references, journal.products)

    command = partial(study.process_command, program)
    times = study.by_processes(blocks, command, partial(further_processes, options.processes), journal, "duels")
    seconds = [each for block in times for each in block.values()]
    return [rounded(Duel(**{**row, "cpu_seconds": each})) for row, each in zip(rows, seconds)]
