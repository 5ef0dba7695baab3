#!/usr/bin/env python3
"""Runs every integrator over step sizes, and the formulations over tolerances, and writes error and cost of each run.

A line is one integrator at one n. Its runs solve the smooth scene to T with more and more steps (as many as in Table 1
at least), until the error no longer falls, or a run took enough work and the slope of the line has settled. First every
run is made once and looked at; then all are timed, in turns, so that a slow minute of the machine falls on all alike.
Counts and errors are those of OpenBLAS's products, times those of the backend that was the faster at the start: counts
that followed the clock would differ from machine to machine.
"""

import functools
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.realpath(__file__))), "lib"))

import study

PROGRAM = "accuracy"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
import study_file
from accuracy_lines import NEAR_ROUNDING, SCHEMA, STILL_FALLING, Reference, Run, Settings
from command_line import whole_number
from integrator_names import TABLE1_CELLS
from references import read_reference
from study_file import CONVERGED, UNSTABLE

SIZES, QUICK_SIZES = (17, 33, 65, 129), (17, 33)
REFERENCES = os.path.join(study.ROOT, "results", "recorded", "references")

# About a factor √2 apart, with Table 1's 50 among them.
TABLE1_STEPS = 50
STEPS = (5, 7, 10, 14, 20, 28, 35, 50, 70, 100, 140, 200, 280, 400, 560, 800, 1120, 1600, 2240, 3200, 4480, 6400)

# A line that has settled ends with the first run, of at least Table 1's steps, that takes as much work: floating-point
# operations of its products, as many as take 0.2, 0.5, 1.4 and 7 s on an AMD EPYC with AVX2.
ENOUGH_WORK = ((17, 3.5e9), (33, 15e9), (65, 52e9), (math.inf, 292e9))
PATIENCE = 2.0  # one that has not settled ends with the first run of so many times the work
SETTLED = 0.1  # change of the slope
LOST_SPECTRUM = 0.1  # of the largest eigenvalue, which is 1: such a run has lost what it should keep, and is unstable

TOLERANCE = 1e-13
TOLERANCES = tuple(10.0**-exponent for exponent in range(4, 16))
# The tolerances are not varied beyond, where that would take as long as all else.
LARGEST_TOLERANCE_SIZE = 65


# ---- untimed: a line, or the tolerances of one cell


def draw_line(job):
    """Returns the runs of the line of a job {"n", "integrator", "references"}, as fields of Run."""
    setting = Setting(job)
    method = setting.method(TOLERANCE)
    runs = []
    for steps in STEPS:
        runs.append(setting.look(method, steps, TOLERANCE)[0])
        if steps >= TABLE1_STEPS and (at_floor(runs, setting.uncertainty) or took_enough(runs)):
            break
    return runs


def vary_tolerance(job):
    """Returns the runs of one cell of Table 1 at each tolerance, from loose to tight."""
    setting = Setting(job)
    runs, states = zip(*(setting.look(setting.method(tolerance), TABLE1_STEPS, tolerance) for tolerance in TOLERANCES))
    tightest = next((W for W in reversed(states) if W is not None), None)
    return [{**run, "solver_error": None if W is None else isosyrk.relative_error(W, tightest)}
            for run, W in zip(runs, states)]


class Setting:
    """The scene of a job, its reference solution, and one integrator."""

    def __init__(self, job):
        self.scene = isosyrk.scene("smooth", n=job["n"])
        self.energy = self.scene.energy(self.scene.initial)
        self.norm_B, self.norm_ad_B = self.scene.generator_norms()
        self.reference, record = read_reference(job["references"], job["n"])
        self.uncertainty = record["uncertainty"]
        (self.entry,) = study.entries([job["integrator"]])

    def method(self, tolerance):
        return isosyrk.integrator(self.scene, self.entry.name, tolerance=tolerance)

    def look(self, method, steps, tolerance):
        """Makes one run, and returns its fields and W(T), which is None if it did not come to a usable end."""
        h = self.scene.time / steps
        energy_error = 0.0

        def watch(_step, W, _report):
            nonlocal energy_error
            energy_error = max(energy_error, abs(self.scene.energy(W) / self.energy - 1))

        try:
            W, report = method.run(self.scene.initial, h, steps, observe=watch)
            status = CONVERGED if isosyrk.spectrum_error(W, self.scene.initial) <= LOST_SPECTRUM else UNSTABLE
        except isosyrk.SolverError as failure:
            W, report, status = None, failure.report, failure.status
        found = dict.fromkeys(Run._fields)
        found.update(integrator=self.entry.name, n=self.scene.n, steps=steps, step=h, tolerance=tolerance,
                     status=status, h_norm_B=h * self.norm_B, h_norm_ad_B=h * self.norm_ad_B,
                     beyond_limit=h * self.norm_ad_B > self.entry.stability_limit, sweeps=report.sweeps,
                     products=report.products, poisson_solves=report.poisson_solves, cpu_seconds=[])
        if status != CONVERGED:
            return found, None
        initial = self.scene.initial
        found.update(error=isosyrk.relative_error(W, self.reference), energy_error=energy_error,
                     spectrum_error=isosyrk.spectrum_error(W, initial), skew_defect=isosyrk.skew_defect(W),
                     casimir_errors=list(isosyrk.casimir_errors(W, initial)),
                     angular_momentum_error=isosyrk.angular_momentum_error(W, initial))
        return found, W


def at_floor(runs, uncertainty):
    """Tells whether the reference or rounding hides the error of the last run."""
    error, before = runs[-1]["error"], runs[-2]["error"] if len(runs) > 1 else None
    if error is None:
        return False
    return error < 2 * uncertainty or (before is not None and before < NEAR_ROUNDING and error > STILL_FALLING * before)


def took_enough(runs):
    """Tells whether the last run took the work that ends a line."""
    last = runs[-1]
    enough = next(work for n, work in ENOUGH_WORK if last["n"] <= n)
    work = 8 * last["n"]**3 * last["products"]
    return last["error"] is not None and work >= (enough if has_settled(runs) else PATIENCE * enough)


def has_settled(runs):
    """Tells whether the slope at the end of the line no longer changes, whatever it is."""
    if len(runs) < 3 or any(run["error"] is None for run in runs[-3:]):
        return False
    first, second, third = runs[-3:]
    return abs(slope(second, third) - slope(first, second)) < SETTLED


def slope(coarse, fine):
    """Returns log(error ratio) / log(step ratio): the order, once steps are small."""
    return math.log(coarse["error"] / fine["error"]) / math.log(fine["steps"] / coarse["steps"])


# ---- timed


@functools.lru_cache(maxsize=None)
def timed_method(n, integrator, tolerance, products):
    scene = isosyrk.scene("smooth", n=n)
    return scene, isosyrk.integrator(scene, integrator, tolerance=tolerance, products=products)


def time_one(point):
    """Returns the CPU seconds of a run [n, integrator, tolerance, products, steps], as the mean of a few."""
    *what, steps = point
    scene, method = timed_method(*what)
    return study.seconds_of(method, scene.initial, scene.time / steps, steps)


# ---- the study


def parse(arguments):
    parser = study.command_line(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--references", metavar="FOLDER", default=REFERENCES,
                        help="what scripts/studies/references.py wrote (default: the recorded ones)")
    parser.add_argument("--repetitions", metavar="K", type=whole_number(1, 1000), default=3,
                        help="timings of each run (default 3)")
    return parser.parse_args(arguments)


def main(arguments):
    options = parse(arguments)
    chosen = study.entries(options.integrator)
    sizes = sorted(set(options.n or (QUICK_SIZES if options.quick else SIZES)))
    references = [read_reference(options.references, n)[1] for n in sizes]
    journal = study.Journal(PROGRAM, options, lambda: isosyrk.conditions(sizes=sizes))

    def jobs(names, largest=math.inf):
        return [{"n": n, "integrator": name, "references": os.path.realpath(options.references)}
                for n in sizes if n <= largest for name in names]

    names = [entry.name for entry in chosen]
    lines = study.untimed(jobs(names), draw_line, journal, options, "lines")
    cells = study.untimed(jobs([name for name in names if name in TABLE1_CELLS], LARGEST_TOLERANCE_SIZE),
                          vary_tolerance, journal, options, "tolerances")
    runs, tolerance_runs = ([Run(**run) for each in found for run in each] for found in (lines, cells))
    points = [[run.n, run.integrator, run.tolerance, journal.products(run.n), run.steps]
              for run in (*runs, *tolerance_runs) if run.usable]
    seconds = iter(study.in_turns(points, options.repetitions, time_one, journal, "timings"))

    def timed(runs):
        return [run._replace(cpu_seconds=next(seconds)) if run.usable else run for run in runs]

    settings = Settings("smooth", isosyrk.scene("smooth", n=sizes[0]).time)
    study_file.write(options.out, SCHEMA, journal.context, settings, {
        "references": [reference_of(each) for each in references], "integrators": list(map(study.record_of, chosen)),
        "runs": timed(runs), "tolerance_runs": timed(tolerance_runs)})
    journal.remove()


def reference_of(record):
    both = record["first"], record["second"]
    return Reference(record["n"], record["uncertainty"], [run["integrator"] for run in both],
                     [run["steps"] for run in both])


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
