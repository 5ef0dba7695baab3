"""Runs every kind of method with more and more steps, and some to T = 1e4, and records what they keep and cost.

Every method runs in its fast form in the co-rotating frame, where it has them. The frame makes the energy error of each
of them smaller. Costs are counted, in full products a unit of time: nothing is timed, and other work may run beside it.
"""

import math
from functools import partial

import isosyrk

from lib.records import formats
from lib.records.formats import CONVERGED, UNSTABLE, to_digits
from lib.running import built, program, trials, untimed
from lib.running.checkpoint import Checkpoint
from studies.longruns.plan import (DEFECT_SIZES, DEFECT_TIME, LONG_RUNS, PLANS, asked_for, in_order, lines_of,
                                   long_runs_of)
from studies.longruns.schema import COST_MARGIN, SCHEMA, LongRun, Point, Settings
from studies.longruns.symplectic_defect import symplectic_defect

MAX_POINTS = 12  # of a line
EXACT = 1e-13  # a line ends where energy and spectrum are as good

ENERGIES_A_WINDOW = 20  # at least, or one after every step
# The steps of a long run are sought between these, by trials of so many windows that are counted in their last half.
LONGEST_STEP, SHORTEST_STEP = 2.0, 1 / 64
TRIAL_WINDOWS = 4
NEAR = 1.02  # steps are not told apart further

GONE = 1.0  # a relative energy error that ends a run
DIGITS = 3  # that errors are written with


def rounded(value):
    return None if value is None else to_digits(value, DIGITS)


# ---- one run


def made(job):
    """Returns the scene and the method of a job."""
    scene = isosyrk.scene(job["scene"], n=job["n"])
    return scene, isosyrk.integrator(scene, job["integrator"], solver=built.solver_of(job["integrator"]),
                                     tolerance=job["tolerance"])


def watched(job, time, steps, windows, energies):
    """Returns what a run came to: its status, its work a unit of time, and what its Watch found."""
    scene, method = made(job)
    watch = Watch(scene, steps // windows, energies)
    step = time / steps
    status, failed_step = CONVERGED, None
    try:
        _, report = method.run(scene.initial, step, steps, watch, watch.every)
    except isosyrk.SolverError as problem:
        report, status, failed_step = problem.report, problem.status, problem.step
    if watch.gone:
        status, failed_step = UNSTABLE, report.steps
    passed = max(report.steps, 1)
    return {"steps": steps, "status": status, "failed_step": failed_step,
            "equivalent_products": rounded(report.equivalent_products / (passed * step)),
            "projections": rounded(report.projections / (passed * step)),
            "sweeps_per_step": rounded(report.sweeps / passed), **watch.found}


class Watch:
    """An observer of a run: keeps the energy errors of each window, and the spectrum error at its end.

    `every`  after how many steps it is to be called
    `gone`   whether the energy is lost, which ends the run
    `found`  what was seen, as fields of a LongRun
    """

    def __init__(self, scene, steps_a_window, energies):
        self.scene = scene
        self.initial_energy = scene.energy(scene.initial)
        self.steps_a_window = steps_a_window
        self.every = steps_between_energies(steps_a_window, energies)
        self.changes = []  # in the window at hand
        self.gone = False
        self.found = {"energy_change": None, "energy_errors": [], "energy_means": [], "spectrum_errors": []}

    def __call__(self, step, W, _report):
        change = trials.energy(self.scene, W) / self.initial_energy - 1.0
        if not abs(change) < GONE:  # so that NaN is gone
            self.gone = True
            return True
        self.changes.append(change)
        if step % self.steps_a_window == 0:
            self.found["energy_change"] = rounded(change)
            self.found["energy_errors"].append(rounded(max(map(abs, self.changes))))
            self.found["energy_means"].append(rounded(math.fsum(self.changes) / len(self.changes)))
            self.found["spectrum_errors"].append(rounded(isosyrk.spectrum_error(W, self.scene.initial)))
            self.changes = []
        return False


def steps_between_energies(steps_a_window, energies):
    """Returns the largest divisor of the steps of a window that leaves so many energies, or 1."""
    return max((divisor for divisor in range(1, steps_a_window // energies + 1) if steps_a_window % divisor == 0),
               default=1)


# ---- a line


def carry_out_line(job):
    """Returns the runs of a line, as fields of Points."""
    plan, points = PLANS[job["n"]], []
    while not has_ended(points, plan.products):
        points.append(point_of(job, plan, plan.steps * 2**len(points)))
    return points


def has_ended(points, products):
    """Tells whether the next run of a line would cost too much, or has nothing left to gain.

    The cost is expected to change as it last did: that of an implicit method hardly rises, and falls at first.
    """
    if len(points) == MAX_POINTS:
        return True
    finished = [point for point in points if point["status"] == CONVERGED]
    if not finished or finished[-1] is not points[-1]:
        return False
    if len(finished) > 1:
        before, last = (point["equivalent_products"] for point in finished[-2:])
        if last**2 / before > products:
            return True
    return max(finished[-1]["energy_error"], finished[-1]["spectrum_error"]) < EXACT


def point_of(job, plan, steps):
    """Returns the run of a line with so many steps."""
    found = watched(job, plan.time, steps, 1, plan.energies)
    kept = {name: found[name] for name in Point._fields if name in found}
    good = found["status"] == CONVERGED
    return {**kept, "time": plan.time, "energy_error": found["energy_errors"][0] if good else None,
            "spectrum_error": found["spectrum_errors"][0] if good else None,
            "symplectic_defect": rounded(defect(job, plan.time / steps)) if good and job["n"] in DEFECT_SIZES else None}


def defect(job, step):
    """Returns the symplectic defect of the steps up to DEFECT_TIME from the scene's initial data.

    None if one fails from a displaced state.
    """
    scene, method = made(job)
    steps = max(1, round(DEFECT_TIME / step))
    try:
        return symplectic_defect(lambda W: method.run(W, step, steps)[0], scene.initial)
    except isosyrk.SolverError:
        return None


# ---- a long run


def carry_out_long_run(job):
    """Returns what a run at a wanted cost came to, as fields of a LongRun; None where no step costs that."""
    time, windows = LONG_RUNS[job["n"]]
    steps_a_window = steps_at_cost(partial(cost_of, job, time / windows), time / windows, job["cost"])
    if steps_a_window is None:
        return None
    return {"time": time, "windows": windows,
            **watched(job, time, windows * steps_a_window, windows, ENERGIES_A_WINDOW)}


def steps_at_cost(cost, window, wanted):
    """Returns the most steps in a window of time that cost what is wanted, to COST_MARGIN; None if none do.

    `cost(steps)` returns the products a unit of time, 0 for a step that fails: those are too long. Source of the cost
    is a count, never a clock.
    """
    low, high = math.ceil(window / LONGEST_STEP), math.ceil(window / SHORTEST_STEP)
    found = {}
    while high > max(low + 1, NEAR * low):
        middle = min(max(round(math.sqrt(low * high)), low + 1), high - 1)
        found[middle] = cost(middle)
        low, high = (middle, high) if found[middle] < wanted else (low, middle)
    nearest = min(found, key=lambda steps: abs(found[steps] / wanted - 1))
    return nearest if abs(found[nearest] / wanted - 1) <= COST_MARGIN else None


def cost_of(job, window, steps_a_window):
    """Returns the products a unit of time in the last half of a trial; 0 if it fails."""
    scene, method = made(job)
    half = TRIAL_WINDOWS // 2 * steps_a_window
    try:
        W, _ = method.run(scene.initial, window / steps_a_window, half)
        W, report = method.run(W, window / steps_a_window, half)
    except isosyrk.SolverError:
        return 0.0
    if not abs(trials.energy(scene, W) / scene.energy(scene.initial) - 1.0) < GONE:
        return 0.0
    return report.equivalent_products / (TRIAL_WINDOWS // 2 * window)


# ---- the study


def main(arguments):
    options = program.parser("longruns", __doc__.splitlines()[0]).parse_args(arguments)
    sizes, methods = asked_for(options)

    checkpoint = Checkpoint("longruns", options, partial(isosyrk.conditions, products="openblas"))
    lines, long_runs = lines_of(sizes, methods), long_runs_of(sizes, methods)
    found = untimed.results(lines, carry_out_line, checkpoint, options, "lines")
    points = [Point(**job, **each) for job, line in zip(lines, found) for each in line]
    found = untimed.results(long_runs, carry_out_long_run, checkpoint, options, "long runs")
    runs = [LongRun(**job, **each) for job, each in zip(long_runs, found) if each]

    integrators = built.entries(list(dict.fromkeys(row.integrator for row in in_order([*points, *runs], methods))))
    formats.write_study(options.out, SCHEMA, checkpoint.context, Settings(options.quick),
                        {"integrators": integrators, "plans": [PLANS[n] for n in sizes],
                         "points": in_order(points, methods), "long_runs": in_order(runs, methods)})
    checkpoint.remove()
