"""Whether a step size works, tried on some steps, and the largest that does.

A trial is a run from initial data with one step size, given as h‖B(W₀)‖₂ of the flow without co-rotating frame.
It fails by its solver, or it is unstable: what it conserves did not stay. A long trial takes LONGER times as many steps
as the short one of the same step size, whatever that is. Needs NumPy and isosyrk.
"""

import math

import isosyrk
import numpy

from lib.records.formats import CONVERGED, LARGEST, NOT_FINITE, UNSTABLE_ENERGY, UNSTABLE_SPECTRUM
from lib.records.settings import steps_to
from lib.running import built

TIME = 5.0  # a short trial lasts so long at least,
MIN_STEPS = {False: 50, True: 400}  # and takes so many steps at least: implicit methods, explicit ones
LONGER = 10  # times as many steps has a long trial, which lasts so many times TIME at least
LOOKS = 20  # at the energy in a trial

# Losses that a trial does not survive: of the spectrum, whose largest eigenvalue is 1, where the method keeps it and
# elsewhere, and of the energy, relative.
KEPT_SPECTRUM_LOSS, SPECTRUM_LOSS, ENERGY_LOSS = 1e-6, 0.1, 0.1

GRID_STEP = 2.0 ** 0.5  # h‖B‖ from one trial of the grid to the next
GRID_START = 0.5
# The grid ends after so many failures in a row, a factor of 4 in h. An island of steps that work beyond them is missed.
FAILURES_THAT_END = 4
LARGEST_STEP, SMALLEST_STEP = 100.0, 0.01  # h‖B‖ that the grid does not exceed
# Bisection ends where the failing step is so many times the working one: in short trials, in long ones.
CLOSE, LONG_CLOSE = 1.03, 1.10


class Setting:
    """A scene, with the norms that a step size is multiplied with and the energy that it begins with."""

    def __init__(self, scene):
        self.scene = scene
        self.norm_B, self.norm_ad_B = self.scene.generator_norms()
        self.initial_energy = self.scene.energy(self.scene.initial)

    def energy_error(self, W):
        """Returns the relative energy error of a state; NaN for one that blew up."""
        return abs(energy(self.scene, W) / self.initial_energy - 1.0)

    def errors(self, W):
        """Returns the errors of a state against the initial data, as columns of a table."""
        return {"spectrum_error": isosyrk.spectrum_error(W, self.scene.initial), "skew_defect": isosyrk.skew_defect(W)}

    def run(self, integrator, h, steps, every=1, look=lambda *_: False):
        """Runs from the initial data, and returns what run() does, and the largest energy error after `every` steps.

        After those `look` is called, as an observer of the module's run() is; it may end the run.
        """
        energy_error = 0.0

        def watch(step, W, report):
            nonlocal energy_error
            energy_error = larger(energy_error, self.energy_error(W))
            return look(step, W, report)

        return (*run(integrator, self.scene.initial, h, steps, watch, every), energy_error)


class Method:
    """A listed integrator in a Setting, to be tried with step sizes."""

    def __init__(self, setting, name, solver):
        (self.entry,) = built.entries([name])
        self.setting = setting
        self.integrator = isosyrk.integrator(setting.scene, name, solver=solver)  # with its default sweep cap

    def outcome(self, h_norm_B):
        """Returns how a short trial ends: CONVERGED, a status of the solver, or a loss."""
        return self.trial(h_norm_B, short_steps)[0]

    def trial(self, h_norm_B, steps_of):
        """Returns how a trial ends, as outcome() does, and the relative energy error of its last state.

        `steps_of` is short_steps or long_steps.
        """
        h = h_norm_B / self.setting.norm_B
        steps = steps_of(h, self.entry.explicit)
        energy_lost = False

        def look(_step, W, _report):
            nonlocal energy_lost
            energy_lost |= not self.setting.energy_error(W) <= ENERGY_LOSS  # so that NaN is a loss
            return energy_lost

        W, _, status, _ = run(self.integrator, self.setting.scene.initial, h, steps, look, math.ceil(steps / LOOKS))
        energy_error = self.setting.energy_error(W)  # of the last state, which may be none that was looked at
        if status == CONVERGED:
            energy_lost |= not energy_error <= ENERGY_LOSS
            status = loss(W, self.setting.scene.initial, energy_lost, self.entry.isospectral)
        return status, energy_error


def short_steps(h, explicit):
    """Returns the number of steps of a short trial: TIME at least, and MIN_STEPS at least."""
    return max(steps_to(TIME, h), MIN_STEPS[explicit])


def long_steps(h, explicit):
    """Returns the number of steps of a long trial: LONGER times those of the short one with the same step size.

    A number that grew with the time alone would leave long steps with MIN_STEPS in both trials: one and the same run.
    A method fails after some steps, of its iteration or of growing modes, rather than after some time. So the same
    factor in steps tests every step size alike. The time grows by the factor too.
    """
    return LONGER * short_steps(h, explicit)


def loss(W, W0, energy_lost, isospectral):
    """Returns what a run that converged has lost, or CONVERGED: an entry that is finite, the spectrum, the energy."""
    if not numpy.abs(W).max() <= LARGEST:
        return NOT_FINITE
    if not isosyrk.spectrum_error(W, W0) <= (KEPT_SPECTRUM_LOSS if isospectral else SPECTRUM_LOSS):
        return UNSTABLE_SPECTRUM
    return UNSTABLE_ENERGY if energy_lost else CONVERGED


def energy(scene, W):
    """Returns the energy of a state; NaN for one that blew up, whose energy may be no double."""
    return scene.energy(W) if numpy.abs(W).max() <= LARGEST else math.nan


def finite(error):
    """Returns an error, or None where it is NaN or beyond all measure: what blew up has no error."""
    return error if error <= LARGEST else None


def larger(first, second):
    """Returns the larger number, or NaN if one of them is."""
    return float(numpy.maximum(first, second))


def run(integrator, W, h, steps, observe, every=1):
    """Runs, and returns (W, report, status, failed step); W is the last good state, the failed step None if none."""
    try:
        return (*integrator.run(W, h, steps, observe, every), CONVERGED, None)
    except isosyrk.SolverError as problem:
        return problem.W, problem.report, problem.status, problem.step


def grid_of(tried):
    """Returns the outcomes of trials on the grid, by h‖B‖ rising. `tried(h‖B‖)` returns the outcome of one.

    The grid begins at GRID_START, or below where that fails, and ends after FAILURES_THAT_END failures in a row.
    """
    outcomes = {}

    def works(place):
        h_norm_B = GRID_START * GRID_STEP**place
        outcomes[h_norm_B] = tried(h_norm_B)
        return outcomes[h_norm_B] == CONVERGED

    lowest = 0
    while not works(lowest) and GRID_START * GRID_STEP**lowest > SMALLEST_STEP:
        lowest -= 1
    place, failures = 1, -lowest
    while failures < FAILURES_THAT_END and GRID_START * GRID_STEP**place <= LARGEST_STEP:
        failures = 0 if works(place) else failures + 1
        place += 1
    return dict(sorted(outcomes.items()))


def first_failure(outcomes):
    """Returns (works, fails, outcome) of the first failure above a success on a grid; None where there is none."""
    found = list(outcomes.items())
    return next(((works, fails, outcome) for (works, before), (fails, outcome) in zip(found, found[1:])
                 if before == CONVERGED and outcome != CONVERGED), None)


def bisected(tried, works, fails, outcome, close):
    """Returns h‖B‖ that works, one that fails, and how, narrowed by bisection until fails ≤ close · works."""
    while fails > close * works:
        middle = math.sqrt(works * fails)
        found = tried(middle)
        if found == CONVERGED:
            works = middle
        else:
            fails, outcome = middle, found
    return works, fails, outcome


def critical(tried):
    """Returns the outcomes of the grid, and (works, fails, outcome) around its first failure, or None."""
    outcomes = grid_of(tried)
    bracket = first_failure(outcomes)
    return outcomes, bracket and bisected(tried, *bracket, CLOSE)


def survived(tried, bracket):
    """Returns (works, fails, outcome) for trials that are longer than those of the critical `bracket`, or None.

    It is the same bracket where its working step still works; else the step falls until one does, to LONG_CLOSE. No
    accuracy follows: a step survives while solver, spectrum and energy stay within the losses above.
    """
    works, fails, outcome = bracket
    while (found := tried(works)) != CONVERGED:
        fails, outcome = works, found
        works /= GRID_STEP
        if works < SMALLEST_STEP:
            return None
    return bisected(tried, works, fails, outcome, LONG_CLOSE)
