"""Whether a step size works, tried on some steps, and the largest that does.

A trial is a short run from the initial data of a scene. Step sizes are told by h‖B(W₀)‖₂, which governs plain
fixed-point iteration. Needs NumPy and isosyrk.
"""

import math

import isosyrk
import numpy
from lib import study
from lib.formats import CONVERGED, LARGEST, UNSTABLE

MAX_SWEEPS = 400  # tells a slow iteration from one that fails without the cost of Table 1's thousand
GRID = [2.0 ** (k / 2) for k in range(-6, 8)]  # h‖B(W₀)‖₂ from 1/8 to 11.3
CLOSE = 1.02  # bisection ends when the failing step is at most this many times the working one

# Losses that a trial does not survive. What is promised to be isospectral is held to 1e-8, far more than a tolerance of
# 1e-13 leaves in a few hundred steps; other methods, to a tenth of the largest eigenvalue, which is 1. Every method
# keeps W skew-Hermitian to 1e-8 and its energy within a factor of two.
PROMISED_LOSS, SPECTRUM_LOSS, ENERGY_LOSS = 1e-8, 0.1, 1.0


class Setting:
    """A scene, with what step sizes are told by."""

    def __init__(self, scene):
        self.scene = scene
        self.norm_B, self.norm_ad_B = self.scene.generator_norms()
        self.initial_energy = self.scene.energy(self.scene.initial)

    def integrator(self, name, solver="published"):
        return isosyrk.integrator(self.scene, name, solver=solver, max_sweeps=MAX_SWEEPS)

    def energy_error(self, W):
        return abs(self.scene.energy(W) / self.initial_energy - 1.0)

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


def trial_steps(n, explicit):
    """Returns the steps of a trial: enough for a growth to show, fewer where they are dear."""
    if explicit:
        return 400 if n <= 129 else 100
    return next((steps for most, steps in ((33, 50), (65, 10), (129, 3)) if n <= most), 1)


def larger(first, second):
    """Returns the larger number, or NaN if one of them is."""
    return float(numpy.maximum(first, second))


def finite(error):
    """Returns an error, or None where it is NaN or beyond all measure: what blew up has no error."""
    return error if error <= LARGEST else None


def run(integrator, W, h, steps, observe, every=1):
    """Runs, and returns (W, report, status, failed step); W is the last good state, the failed step None if none."""
    try:
        return (*integrator.run(W, h, steps, observe, every), CONVERGED, None)
    except isosyrk.SolverError as problem:
        return problem.W, problem.report, problem.status, problem.step


def sweeps_per_step(report):
    return report.sweeps / report.steps if report.steps else 0.0


def invariants_lost(errors, isospectral):
    allowed = {"spectrum_error": PROMISED_LOSS if isospectral else SPECTRUM_LOSS, "skew_defect": PROMISED_LOSS,
               "energy_error": ENERGY_LOSS}
    return not all(errors[name] <= most for name, most in allowed.items())  # so that NaN is a loss


def trial_of(setting, name, solver):
    """Returns a function of h‖B(W₀)‖₂ that tries a listed integrator, and returns the trial as columns of a table."""
    (kept,) = study.entries([name])
    integrator = setting.integrator(name, solver)
    steps = trial_steps(setting.scene.n, kept.explicit)

    def trial(h_norm_B):
        W, report, status, failed_step, energy_error = setting.run(integrator, h_norm_B / setting.norm_B, steps)
        errors = {**setting.errors(W), "energy_error": energy_error}
        if status == CONVERGED and invariants_lost(errors, kept.isospectral):
            status = UNSTABLE
        return {"h_norm_B": h_norm_B, "status": status, "steps": report.steps,
                "sweeps_per_step": sweeps_per_step(report),
                **{name: finite(error) for name, error in errors.items()}, "failed_step": failed_step}

    return trial


def find_edge(setting, name, solver="published"):
    """Returns the trials of a listed integrator over the grid, and (works, fails) around the first failure above a
    success, bisected until they differ by the factor CLOSE at most; None in its place if there is no such failure."""
    tried = trial_of(setting, name, solver)
    trials = [tried(h_norm_B) for h_norm_B in GRID]
    bracket = next(((first, second) for first, second in zip(trials, trials[1:]) if works(first) and not works(second)),
                   None)
    while bracket and bracket[1]["h_norm_B"] > CLOSE * bracket[0]["h_norm_B"]:
        inside, outside = bracket
        middle = tried(math.sqrt(inside["h_norm_B"] * outside["h_norm_B"]))
        bracket = (middle, outside) if works(middle) else (inside, middle)
    return trials, bracket


def works(trial):
    return trial["status"] == CONVERGED
