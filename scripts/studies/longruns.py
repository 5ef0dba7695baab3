#!/usr/bin/env python3
"""Watches energy, spectrum and Casimirs over long runs, at one step size and at two equal costs of all methods.

Every method runs in its fast form in the co-rotating frame, which makes the energy error of each of them smaller. The
step sizes are data of this file, so that nothing untimed depends on a clock; what a step costs is timed afterwards.
"""

import functools
import math
import os
import sys
from functools import partial

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from lib import study

PROGRAM = "longruns"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
from lib import formats
from lib.accuracy_lines import LOOSE_GAUSS, keeping_tolerance
from lib.command_line import Stop, whole_number
from lib.formats import CONVERGED, FAST, UNSTABLE, to_digits
from lib.integrator_names import FRAME, frameless
from lib.longruns_files import (COARSE, FINE, LOOSE, ONE_STEP, SCENES, SCHEMA, TIGHTER, Plan, Run, Settings,
                                without_variant)

METHODS = ("algebra1", "group2", "group2" + LOOSE, "group3", "elp4", "elp6", "elp6" + TIGHTER, "magnus5", "rkmk4",
           "rk4", "rk4_projected")
TIGHTER_TOLERANCE = 1e-10  # of an exponential method: its energy error drifts at 1e-8
PLANS = {plan.n: plan for plan in (
    Plan(n=17, time=50.0, windows=50),
    Plan(n=33, time=1000.0, windows=200),
    Plan(n=65, time=1000.0, windows=200),
    Plan(n=129, time=200.0, windows=200))}
SIZES, QUICK_SIZES = (33, 65, 129), (17,)
WINDOWS_A_SAMPLE = 5
ENERGIES_A_WINDOW = 20  # at least, or one after every step
GONE = 1e3  # a relative energy error that ends a run
DIGITS, SECONDS_DIGITS = 3, 5  # that errors and times are written with

# Steps in a window at one step size for all methods: h = 0.5, 0.5, 0.25 and 0.125.
STEPS_AT_ONE_STEP = {17: 2, 33: 10, 65: 20, 129: 8}
# Steps in a window at the coarse and at the fine equal cost. group3 cannot do with much less than the coarse cost.
# Chosen on one core with AVX-512; the table "Costs" of the report has what they cost where the raw file was made.
STEPS_AT_EQUAL_COST = {
    (17, "smooth"): {
        "algebra1": (25, 105), "group2": (7, 45), "group2_loose": (20, 45), "group3": (3, 25), "elp4": (8, 25),
        "elp6": (5, 15), "elp6_tight": (3, 13), "magnus5": (7, 21), "rkmk4": (7, 16), "rk4": (35, 85),
        "rk4_projected": (30, 75)},
    (17, "rough"): {
        "algebra1": (23, 105), "group2": (6, 40), "group2_loose": (18, 45), "group3": (3, 25), "elp4": (9, 22),
        "elp6": (5, 15), "elp6_tight": (3, 14), "magnus5": (8, 20), "rkmk4": (6, 18), "rk4": (35, 85),
        "rk4_projected": (30, 80)},
    (33, "smooth"): {
        "algebra1": (165, 700), "group2": (20, 220), "group2_loose": (90, 235), "group3": (8, 90),
        "elp4": (45, 140), "elp6": (23, 90), "elp6_tight": (20, 80), "magnus5": (40, 100), "rkmk4": (30, 80),
        "rk4": (185, 450), "rk4_projected": (150, 425)},
    (33, "rough"): {
        "algebra1": (150, 700), "group2": (19, 225), "group2_loose": (90, 250), "group3": (9, 85),
        "elp4": (35, 145), "elp6": (20, 90), "elp6_tight": (16, 75), "magnus5": (40, 100), "rkmk4": (35, 85),
        "rk4": (180, 475), "rk4_projected": (150, 425)},
    (65, "smooth"): {
        "algebra1": (450, 1150), "group2": (40, 275), "group2_loose": (145, 325), "group3": (16, 115),
        "elp4": (85, 225), "elp6": (50, 150), "elp6_tight": (35, 130), "magnus5": (65, 150), "rkmk4": (50, 120),
        "rk4": (300, 700), "rk4_projected": (275, 650)},
    (65, "rough"): {
        "algebra1": (425, 1175), "group2": (40, 275), "group2_loose": (145, 325), "group3": (14, 110),
        "elp4": (65, 190), "elp6": (35, 130), "elp6_tight": (30, 110), "magnus5": (60, 145), "rkmk4": (55, 125),
        "rk4": (300, 700), "rk4_projected": (275, 650)},
    (129, "smooth"): {
        "algebra1": (125, 375), "group2": (20, 65), "group2_loose": (35, 85), "group3": (5, 35),
        "elp4": (30, 75), "elp6": (21, 55), "elp6_tight": (16, 40), "magnus5": (21, 50), "rkmk4": (16, 40),
        "rk4": (105, 220), "rk4_projected": (95, 220)},
    (129, "rough"): {
        "algebra1": (125, 300), "group2": (20, 60), "group2_loose": (40, 85), "group3": (6, 35),
        "elp4": (30, 70), "elp6": (21, 50), "elp6_tight": (16, 40), "magnus5": (22, 50), "rkmk4": (18, 40),
        "rk4": (105, 225), "rk4_projected": (105, 205)},
}

# What is timed: a stretch from the state at MIDWAY, or from half the run if that is sooner.
MIDWAY, MIDWAY_STEP, MIDWAY_INTEGRATOR = 100.0, 0.25, "elp6_frame"
STRETCH = 2.0  # units of time
REPETITIONS = 5


def integrator_of(method):
    """Returns the integrator and the tolerance of a method of METHODS."""
    name = without_variant(method) + FRAME
    if method.endswith(LOOSE):
        return name, LOOSE_GAUSS
    if method.endswith(TIGHTER):
        return name, TIGHTER_TOLERANCE
    return name, keeping_tolerance(name)


def rounded(value):
    return to_digits(value, DIGITS)


# ---- untimed: one run


def carry_out(job):
    """Returns what a run came to, as fields of a Run."""
    scene = isosyrk.scene(job["scene"], n=job["n"])
    method = isosyrk.integrator(scene, job["integrator"], solver=FAST, tolerance=job["tolerance"])
    watch = Watch(scene, job["steps_a_window"])
    steps = PLANS[job["n"]].windows * job["steps_a_window"]
    step = job["time"] / steps
    status, failed_step = CONVERGED, None
    try:
        _, report = method.run(scene.initial, step, steps, watch, watch.every)
    except isosyrk.SolverError as problem:
        report, status, failed_step = problem.report, problem.status, problem.step
    if watch.gone:
        status, failed_step = UNSTABLE, report.steps
    passed = max(report.steps, 1) * step
    return {"steps": steps, "step": step, "status": status, "failed_step": failed_step,
            "sweeps_per_step": rounded(report.sweeps / max(report.steps, 1)),
            "equivalent_products": rounded(report.equivalent_products / passed), **watch.found}


class Watch:
    """An observer of a run: keeps the largest energy error of each window, and spectrum and Casimirs now and then.

    `every`  after how many steps it is to be called
    `gone`   whether the energy has gone beyond all measure, which ends the run
    `found`  what was seen, as fields of a Run
    """

    def __init__(self, scene, steps_a_window):
        self.scene = scene
        self.initial_energy = scene.energy(scene.initial)
        self.steps_a_window = steps_a_window
        self.every = steps_between_energies(steps_a_window)
        self.largest = 0.0
        self.gone = False
        self.found = {"energy_change": None, "energy_errors": [], "spectrum_errors": [], "casimir_errors": []}

    def __call__(self, step, W, _report):
        change = self.scene.energy(W) / self.initial_energy - 1.0
        if not abs(change) <= GONE:  # so that NaN is gone
            self.gone = True
            return True
        self.largest = max(self.largest, abs(change))
        if step % self.steps_a_window == 0:
            self.end_window(step // self.steps_a_window, W, change)
        return False

    def end_window(self, number, W, change):
        self.found["energy_change"] = rounded(change)
        self.found["energy_errors"].append(rounded(self.largest))
        self.largest = 0.0
        if number % WINDOWS_A_SAMPLE == 0:
            self.found["spectrum_errors"].append(rounded(isosyrk.spectrum_error(W, self.scene.initial)))
            self.found["casimir_errors"].append(rounded(max(isosyrk.casimir_errors(W, self.scene.initial))))


def steps_between_energies(steps_a_window):
    """Returns the largest divisor of the steps of a window that leaves ENERGIES_A_WINDOW energies, or 1."""
    return max((divisor for divisor in range(1, steps_a_window // ENERGIES_A_WINDOW + 1)
                if steps_a_window % divisor == 0), default=1)


# ---- timed: a stretch of each run


@functools.lru_cache(maxsize=None)
def midway(scene_name, n):
    """Returns the scene, and its state at MIDWAY or after half the run."""
    scene = isosyrk.scene(scene_name, n=n)
    steps = math.ceil(min(MIDWAY, PLANS[n].time / 2) / MIDWAY_STEP)
    method = isosyrk.integrator(scene, MIDWAY_INTEGRATOR, solver=FAST, tolerance=keeping_tolerance(MIDWAY_INTEGRATOR))
    return scene, method.run(scene.initial, MIDWAY_STEP, steps)[0]


def time_one(point):
    """Returns the CPU seconds a unit of time of a run, measured on a stretch from its scene's state midway."""
    scene, W = midway(point["scene"], point["n"])
    method = isosyrk.integrator(scene, point["integrator"], solver=FAST, tolerance=point["tolerance"])
    steps = math.ceil(STRETCH / point["step"])
    (seconds,) = method.timed_run(W, point["step"], steps, repetitions=1, warmup=study.WARM_STEPS)
    return to_digits(seconds / (steps * point["step"]), SECONDS_DIGITS)


# ---- the study


def jobs_of(n, methods):
    """Returns the jobs at one n, the longest last."""
    jobs = []
    for scene in SCENES:
        for method in methods:
            integrator, tolerance = integrator_of(method)
            at_equal_cost = dict(zip((COARSE, FINE), STEPS_AT_EQUAL_COST[n, scene][method]))
            jobs += [{"scene": scene, "n": n, "integrator": integrator, "tolerance": tolerance, "level": level,
                      "time": PLANS[n].time, "steps_a_window": steps}
                     for level, steps in {ONE_STEP: STEPS_AT_ONE_STEP[n], **at_equal_cost}.items()]
    return sorted(jobs, key=lambda job: job["level"] == FINE)


def asked_for(options):
    """Returns the n and the methods of the study. Throws Stop for those that it does not have."""
    sizes = sorted(set(options.n or (QUICK_SIZES if options.quick else SIZES)))
    for n in sizes:
        if n not in PLANS:
            raise Stop(f"--n {n}: must be one of {', '.join(map(str, PLANS))}")
    if not options.integrator:
        return sizes, METHODS
    names = {frameless(entry.name) for entry in study.entries(options.integrator)}
    for name in sorted(names):
        if name not in METHODS:
            raise Stop(f"--integrator {name}: has no steps in this study; must be one of {', '.join(METHODS)}")
    return sizes, [method for method in METHODS if without_variant(method) in names]


def main(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=whole_number(1, 1000), default=REPETITIONS,
                        help="of timed stretches (default: %(default)s)")
    options = parser.parse_args(arguments)
    sizes, methods = asked_for(options)

    journal = study.Journal(PROGRAM, options, partial(isosyrk.conditions, products="openblas", sizes=sizes))
    jobs = [job for n in sizes for job in jobs_of(n, methods)]
    found = study.untimed(jobs, carry_out, journal, options, "long runs")
    rows = [{**{name: job[name] for name in ("scene", "n", "integrator", "tolerance", "level")}, **each}
            for job, each in zip(jobs, found)]
    points = [{name: row[name] for name in ("scene", "n", "integrator", "tolerance", "step")}
              for row in rows if row["status"] == CONVERGED]
    seconds = iter(study.in_turns(points, options.repetitions, time_one, journal, "timing"))
    runs = [Run(**row, cpu_seconds=next(seconds) if row["status"] == CONVERGED else []) for row in rows]

    integrators = [study.record_of(entry) for entry in
                   study.entries(list(dict.fromkeys(run.integrator for run in runs)))]
    formats.write_study(options.out, SCHEMA, journal.context, Settings(options.quick, WINDOWS_A_SAMPLE),
                        {"integrators": integrators, "plans": [PLANS[n] for n in sizes], "runs": runs})
    journal.remove()


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
