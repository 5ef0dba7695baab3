#!/usr/bin/env python3
"""Runs every integrator over step sizes, and the formulations over tolerances, and writes error and cost of each run.

A line is one integrator on one problem: a scene, n and a time. Its runs take more and more steps (as many as in Table
1 at least), until the error no longer falls, or a run took enough work. Every integrator runs by its fast form if it
has one; the cells of Table 1 by their published forms too, to T = 5 of the smooth scene. First every run is made once
and looked at; then all are timed, in turns, so that a slow minute of the machine falls on all alike. Counts and
errors of published forms are those of OpenBLAS's products, times those of the backend that was the faster at the
start: counts that followed the clock would differ from machine to machine.
"""

import functools
import math
import os
import re
import statistics
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from lib import study

PROGRAM = "accuracy"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
from lib import problems
from lib import formats
from lib.formats import CONVERGED, FAST, PUBLISHED, UNSTABLE
from lib import trials
from lib.accuracy_lines import (FLOOR_MARGIN, SCHEMA, TABLE1_STEP, Limit, Problem, Rate, Reference, Run, Settings,
                                fitted_order, is_rounding)
from lib.command_line import whole_number
from lib.integrator_names import TABLE1_CELLS, in_frame

REFERENCES = os.path.join(study.ROOT, "results", "recorded", "references")

# Whose answers other integrators give too, at the cost of another formulation, or which no comparison needs: these run
# on the main problem only, the one of Table 1.
MAIN_ONLY = re.compile(r"(cotangent[0-9]+|algebra[23]|group[178]|direct1|suzuki4)(_frame)?")

# All that the quick study has: the cells of Table 1 and one or two of each other kind, three of them in the
# co-rotating frame. With steps a factor of 2 apart and two timings of each run it takes a third of the time that all
# take at its n.
QUICK_INTEGRATORS = (*TABLE1_CELLS, "group5", "direct2", "yoshida4", "kahan_li6", "elp4", "elp6_frame", "magnus4",
                     "rk4", "rkmk4", "group2_frame", "rkmk4_frame")
REPETITIONS, QUICK_REPETITIONS = 3, 2

# Published forms that run too, on the main problem.
PUBLISHED_TOO = (*TABLE1_CELLS, "rkmk4", "rk4")

# Steps to T = 5: about a factor √2 apart, with Table 1's 50 among them.
UNIT = 5.0
STEPS = (2, 3, 5, 7, 10, 14, 20, 28, 35, 50, 70, 100, 140, 200, 280, 400, 560, 800, 1120, 1600, 2240, 3200, 4480,
         6400)
# Where a line takes long, at n = 257 and to T = 50, a factor of 2 must do; so it must for published forms, which are
# compared with and not chosen, and in the quick study.
COARSE_STEPS = (3, 6, 12, 25, 50, 100, 200, 400, 800, 1600, 3200)

# A line ends with an error that is good enough, but has Table 1's step too, or with the first run, of that step or a
# shorter one, that takes so much work: floating-point operations of its products. A core does some 5e10 a second. It
# goes on, unless it takes long, to PATIENCE times the work while errors do not yet fall as the order says.
GOOD_ENOUGH = ((65, 1e-11), (math.inf, 1e-9))  # by the largest n
ENOUGH_WORK = ((17, 4e9), (33, 12e9), (65, 12e9), (129, 20e9), (math.inf, 80e9))
ENOUGH_TIMES = {(FAST, 5.0): 1, (FAST, 50.0): 2.5, (PUBLISHED, 5.0): 4, (PUBLISHED, 50.0): 10}  # as many times that
PATIENCE = 15
NEAR_ORDER = 0.2  # by which observed order and order may differ
LOOKS = 50  # at the energy in a run, at least while there are as many steps
LOST_SPECTRUM = 0.1  # of the largest eigenvalue, which is 1: such a run has lost what it should keep, and is unstable

MAX_SWEEPS = {FAST: 60, PUBLISHED: 200}  # a step; one that takes more is of no use to anybody

TOLERANCE = 1e-13
TOLERANCES = tuple(10.0**-exponent for exponent in range(4, 16))
# The tolerances are not varied beyond, where that would take as long as all else.
LARGEST_TOLERANCE_SIZE = 65
RATES = 5  # measurements of a product rate, of which the median counts


# ---- untimed: a line, the tolerances of one cell, or a largest safe step


def draw_line(job):
    """Returns the runs of the line of a job, as fields of Run."""
    setting = Setting(job)
    method, order = setting.method(TOLERANCE), setting.entry.order
    runs, usable = [], []
    at_end = False
    for steps_of_unit in grid(job):
        as_in_table1 = steps_of_unit >= UNIT / TABLE1_STEP
        if at_end and not as_in_table1:
            continue
        runs.append(setting.look(method, round(steps_of_unit * job["time"] / UNIT), TOLERANCE)[0])
        if runs[-1].usable:
            usable.append(runs[-1])
            settled = takes_long(job) or has_order(usable, order)
            at_end = at_end or hidden(usable, setting.uncertainty, order) or (settled and good_enough(runs[-1]))
            if as_in_table1 and (at_end or took_enough(runs[-1], 1 if settled else PATIENCE)):
                break
    return [run._asdict() for run in runs]


def grid(job):
    """Returns the steps to T = 5 of the line of a job."""
    if job["solver"] == PUBLISHED:
        return COARSE_STEPS[COARSE_STEPS.index(25):]
    return COARSE_STEPS if takes_long(job) or job["quick"] else STEPS


def takes_long(job):
    return job["solver"] == PUBLISHED or job["n"] > 129 or job["time"] > UNIT


def vary_tolerance(job):
    """Returns the runs of one cell of Table 1 at each tolerance, from loose to tight."""
    setting = Setting(job)
    steps = round(job["time"] / TABLE1_STEP)
    runs, states = zip(*(setting.look(setting.method(tolerance), steps, tolerance) for tolerance in TOLERANCES))
    tightest = next((W for W in reversed(states) if W is not None), None)
    return [{**run._asdict(), "solver_error": None if W is None else isosyrk.relative_error(W, tightest)}
            for run, W in zip(runs, states)]


def find_limit(job):
    """Returns the limit of an integrator in a scene, as fields of Limit."""
    setting = trials.Setting(scene_of(*problem_of(job), job["references"]))
    return {**{name: job[name] for name in Limit._fields if name in job},
            "h_norm_B": trials.safe_step(setting, job["integrator"], job["solver"])}


def problem_of(job):
    return Problem(*(job[name] for name in Problem._fields))


@functools.lru_cache(maxsize=1)
def scene_of(scene, time, n, folder):
    return problems.scene_of(Problem(scene, time, n), folder)


class Setting(trials.Setting):
    """The problem of a job, its reference solution, and one integrator."""

    def __init__(self, job):
        self.problem, self.solver = problem_of(job), job["solver"]
        super().__init__(scene_of(*self.problem, job["references"]))
        self.reference, record = problems.reference_of(self.problem, job["references"])
        self.uncertainty = record["uncertainty"]
        (self.entry,) = study.entries([job["integrator"]])
        _, self.own_norm_ad_B = self.scene.generator_norms(co_rotating=in_frame(self.entry.name))

    def method(self, tolerance):
        return isosyrk.integrator(self.scene, self.entry.name, solver=self.solver, tolerance=tolerance,
                                  max_sweeps=MAX_SWEEPS[self.solver])

    def look(self, method, steps, tolerance):
        """Makes one run, and returns it and W(T), which is None if it did not come to a usable end."""
        h = self.problem.time / steps
        initial = self.scene.initial
        W, report, status, _, energy_error = self.run(method, h, steps, math.ceil(steps / LOOKS))
        if status == CONVERGED and not isosyrk.spectrum_error(W, initial) <= LOST_SPECTRUM:
            status = UNSTABLE
        found = dict.fromkeys(Run._fields)
        found.update(self.problem._asdict(), integrator=self.entry.name, solver=self.solver, steps=steps, step=h,
                     tolerance=tolerance, status=status, h_norm_B=h * self.norm_B,
                     beyond_limit=h * self.own_norm_ad_B > self.entry.stability_limit, sweeps=report.sweeps,
                     products=report.products, equivalent_products=report.equivalent_products,
                     poisson_solves=report.poisson_solves, cpu_seconds=[])
        if status != CONVERGED:
            return Run(**found), None
        found.update(error=isosyrk.relative_error(W, self.reference), **self.errors(W),
                     energy_error=energy_error,
                     casimir_errors=list(isosyrk.casimir_errors(W, initial)),
                     angular_momentum_error=isosyrk.angular_momentum_error(W, initial))
        return Run(**found), W


def good_enough(run):
    return run.error < up_to(run.n, GOOD_ENOUGH)


def hidden(runs, uncertainty, order):
    """Tells whether the error of the last of some runs is hidden by the reference or by rounding."""
    return runs[-1].error < FLOOR_MARGIN * uncertainty or (len(runs) > 1 and is_rounding(*runs[-2:], order))


def has_order(runs, order):
    """Tells whether the errors of the last of some runs fall as the order says."""
    observed = fitted_order(runs)
    return observed is not None and abs(observed - order) < NEAR_ORDER


def up_to(n, values):
    """Returns the value of the first (largest n, value) that holds for n."""
    return next(value for largest, value in values if n <= largest)


def took_enough(run, times):
    """Tells whether a run took so many times the work that ends a line."""
    enough = times * up_to(run.n, ENOUGH_WORK) * ENOUGH_TIMES[run.solver, run.time]
    return 8 * run.n**3 * run.equivalent_products >= enough


# ---- timed


def time_one(point, folder):
    """Returns the CPU seconds of a run [scene, time, n, integrator, solver, tolerance, products, steps], as the mean of
    a few."""
    scene, time, n, integrator, solver, tolerance, products, steps = point
    setting = scene_of(scene, time, n, folder)
    method = isosyrk.integrator(setting, integrator, solver=solver, tolerance=tolerance,
                                **({"products": products} if solver == PUBLISHED else {}))
    return study.seconds_of(method, setting.initial, time / steps, steps)


def rate_of(n, journal):
    """Returns the product rates at n, as measured when the study began."""
    key = study.key_of("rates", n)
    if key not in journal.found:
        journal.add(key, [statistics.median(isosyrk.product_rate(n, solver) for _ in range(RATES))
                          for solver in (PUBLISHED, FAST)])
    return Rate(n, *journal.found[key])


# ---- the study


def parse(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    problems.add_filters(parser)
    parser.add_argument("--references", metavar="FOLDER", default=REFERENCES,
                        help="what scripts/studies/references.py wrote (default: the recorded ones)")
    parser.add_argument("--repetitions", metavar="K", type=whole_number(1, 1000),
                        help=f"timings of each run (default {REPETITIONS}, with --quick {QUICK_REPETITIONS})")
    options = parser.parse_args(arguments)
    if options.repetitions is None:
        options.repetitions = QUICK_REPETITIONS if options.quick else REPETITIONS
    return options


def is_main(problem):
    return (problem.scene, problem.time) == ("smooth", UNIT) and problem.n in problems.SIZES


def lines_of(problem, entries, all_of_them):
    """Returns integrators and solvers of the lines of a problem: the fast form, or the published one if it is alone."""
    lines = [(entry.name, FAST if entry.has_fast_form else PUBLISHED) for entry in entries
             if all_of_them or is_main(problem) or not MAIN_ONLY.fullmatch(entry.name)]
    return lines + [(entry.name, PUBLISHED) for entry in entries
                    if is_main(problem) and entry.name in PUBLISHED_TOO and entry.has_fast_form]


def main(arguments):
    options = parse(arguments)
    chosen = study.entries(options.integrator or (QUICK_INTEGRATORS if options.quick else None), frames=True)
    wanted = problems.asked_for(options)
    references = [reference_row(problem, problems.reference_of(problem, options.references)[1]) for problem in wanted]
    for problem in wanted:
        problems.scene_of(problem, options.references)  # so that initial data that cannot be used are told now
    sizes = sorted({problem.n for problem in wanted})
    journal = study.Journal(PROGRAM, options, lambda: isosyrk.conditions(sizes=sizes))
    rates = [rate_of(n, journal) for n in sizes]

    folder = os.path.realpath(options.references)
    jobs = [{**problem._asdict(), "integrator": name, "solver": solver, "references": folder, "quick": options.quick}
            for problem in sorted(wanted, key=lambda problem: (problem.n, problem.time))  # the longest last
            for name, solver in lines_of(problem, chosen, options.integrator is not None)]
    by_scene = {(job["scene"], job["n"], job["integrator"]): job for job in reversed(jobs)
                if job["solver"] == FAST and not MAIN_ONLY.fullmatch(job["integrator"])}  # what recommend may offer
    limits = [Limit(**found) for found in study.untimed(list(by_scene.values())[::-1], find_limit, journal, options,
                                                       "limits")]
    lines = study.untimed(jobs, draw_line, journal, options, "lines")
    cells = study.untimed([job for job in jobs if job["solver"] == PUBLISHED and job["n"] <= LARGEST_TOLERANCE_SIZE
                           and job["integrator"] in TABLE1_CELLS], vary_tolerance, journal, options, "tolerances")

    runs, tolerance_runs = ([Run(**run) for each in found for run in each] for found in (lines, cells))
    points = [[*run.problem, run.integrator, run.solver, run.tolerance,
               journal.products(run.n) if run.solver == PUBLISHED else None, run.steps]
              for run in (*runs, *tolerance_runs) if run.usable]
    seconds = iter(study.in_turns(points, options.repetitions, lambda point: time_one(point, folder), journal,
                                  "timings"))

    def completed(runs):
        return [rounded(run._replace(cpu_seconds=next(seconds) if run.usable else ())) for run in runs]

    formats.write_study(options.out, SCHEMA, journal.context, Settings(options.quick), {
        "references": references, "rates": rates, "integrators": list(map(study.record_of, chosen)), "limits": limits,
        "runs": completed(runs), "tolerance_runs": completed(tolerance_runs)})
    journal.remove()


def rounded(run):
    """Returns a run with its measured values to four digits, which keeps the recorded file small."""
    def digits(value):
        if isinstance(value, (list, tuple)):
            return [digits(each) for each in value]
        return float(f"{value:.4g}") if isinstance(value, float) else value

    return Run(*(value if name in ("time", "step", "tolerance") else digits(value)
                 for name, value in run._asdict().items()))


def reference_row(problem, record):
    both = record["first"], record["second"]
    return Reference(*problem, record["uncertainty"], [run["integrator"] for run in both],
                     [run["steps"] for run in both])


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
