"""Single runs of the study of accuracy: one integrator on one problem, with its errors and counts. Needs isosyrk."""

import functools
import math

import isosyrk

from lib.records.formats import CONVERGED, FAST, PUBLISHED, UNSTABLE, to_digits
from lib.records.settings import Problem
from lib.running import built, problems, timed, trials
from studies.accuracy.schema import Run

LOOKS = 50  # at the energy in a run, at least while there are as many steps
LOST_SPECTRUM = 0.1  # of the largest eigenvalue, which is 1: a run that lost so much is unstable
PART_WORK = 20e9  # floating-point operations of products, up to which a run is timed whole outside of processes
MAX_SWEEPS = {FAST: 60, PUBLISHED: 200}  # a step; one that takes more is of no use to anybody


def problem_of(job):
    return Problem(*(job[name] for name in Problem._fields))


@functools.lru_cache(maxsize=1)
def scene_of(scene, time, n, folder):
    """Returns the scene of a problem; the last one is kept."""
    return problems.scene_of(Problem(scene, time, n), folder)


class Setting(trials.Setting):
    """The problem of a job, its reference solution, and one integrator.

    A job is a dict with the fields of Problem, `integrator`, `solver`, and the folder of `references`.
    """

    def __init__(self, job):
        self.problem, self.solver = problem_of(job), job["solver"]
        super().__init__(scene_of(*self.problem, job["references"]))
        self.reference, record = problems.reference_of(self.problem, job["references"])
        self.uncertainty = record["uncertainty"]
        self.entry = built.integrators()[job["integrator"]]
        self.limit = math.inf if self.entry.stability_limit is None else self.entry.stability_limit
        _, self.own_norm_ad_B = self.scene.generator_norms(co_rotating=self.entry.co_rotating)

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
        found.update(self.problem._asdict(), integrator=self.entry.name, solver=self.solver, steps=steps,
                     tolerance=tolerance, status=status, h_norm_B=h * self.norm_B,
                     beyond_limit=h * self.own_norm_ad_B > self.limit, sweeps=report.sweeps,
                     products=report.products, equivalent_products=report.equivalent_products, cpu_seconds=[])
        if status != CONVERGED:
            return Run(**found), None
        found.update(error=isosyrk.relative_error(W, self.reference), energy_error=energy_error,
                     spectrum_error=isosyrk.spectrum_error(W, initial))
        return Run(**found), W


def seconds_of_part(method, W, h, steps, products):
    """Returns the CPU seconds of a run of steps with so many equivalent products in all.

    Of one that takes more than PART_WORK the first steps are timed, and their time is scaled by products.
    """
    part = math.ceil(steps * min(1.0, PART_WORK / (8 * len(W)**3 * products)))
    if part == steps:
        return timed.seconds_of(method, W, h, steps)
    _, report = method.run(W, h, part)
    return report.seconds * products / report.equivalent_products


def rounded(record):
    """Returns a record with its measured values to four digits, which keeps the recorded file small."""
    def digits(value):
        if isinstance(value, (list, tuple)):
            return [digits(each) for each in value]
        return to_digits(value, 4) if isinstance(value, float) else value

    return type(record)(*(value if name in ("time", "tolerance", "wanted") else digits(value)
                          for name, value in record._asdict().items()))
