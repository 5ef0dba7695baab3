"""Small studies of stability and long runs, made up, whose every answer can be worked out by hand.

Every trial up to the critical h‖B‖₂ of its integrator works, with 50 h‖B‖₂ sweeps a step, and every one beyond fails.
"""

import os
import sys

from programs import ROOT

sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
import study_file  # noqa: E402
from stability_files import (LONG_RUNS_SCHEMA, MAP_SCHEMA, Edge, LongRunSettings, MapSettings, RunRow,  # noqa: E402
                             Sample, Setting, Trial)

GRID = [2.0 ** (k / 2) for k in range(-6, 8)]
BISECTED = 1.02  # the first that fails over the last that works
SETTINGS = (("smooth", 17), ("smooth", 129), ("rough", 17))
ROUGH = 1.5  # critical values of the rough scene over those of the smooth one
TRIAL_STEPS = {17: 50, 129: 5}
CONTEXT = {"commit": "0123456789ab", "dirty": "no", "compiler": "GNU 12.2.0", "cpu": "a processor",
           "blas_kernels": "Zen"}

# name: stages, order, isospectral, Lie-Poisson, symmetric, explicit, critical h‖B‖₂, linear limit
INTEGRATORS = {
    **{f"{formulation}{s}": (s, 2 * s, True, True, True, False, 1.5, 1.5)
       for formulation in ("cotangent", "group") for s in (1, 2, 3)},
    "algebra1": (1, 2, True, True, True, False, 1.6, 2.0),
    "algebra2": (2, 4, True, True, True, False, 1.9, 1.9),
    "algebra3": (3, 6, True, True, True, False, 2.2, 2.2),
    "yoshida4": (3, 4, True, True, True, False, 1.2, 1.2),
    "rkmk4": (4, 4, True, False, False, True, None, None),  # works wherever it was tried
    "rk4": (4, 4, False, False, False, True, 2.0, 1.0),
    "algebra2_two_products": (2, 4, False, False, True, False, 1.9, 1.9),  # a control of long runs only
}
CONTROL = "algebra2_two_products"
LISTED = tuple(name for name in INTEGRATORS if name != CONTROL)

LONG_STEPS = 2000
SHARES = (0.9, 0.3)
LOST_AT = 500  # near the edge rk4 fails at this step
LINEAR_RATE = 1e-5  # of what rk4 loses, per unit time
SAMPLED = sorted({round(10 ** (k / 10)) for k in range(34)} | set(range(250, LONG_STEPS + 1, 250)))


def norm(n):
    return n / 16


def integrators(names):
    return [study_file.Integrator(name, *INTEGRATORS[name][:6], None) for name in names]


def edge_and_trials(scene, n, name):
    *_, explicit, critical, limit = INTEGRATORS[name]
    critical = critical and critical * (ROUGH if scene == "rough" else 1)
    failed = "unstable" if explicit else "diverged"
    trials = []
    for h_norm_B in GRID:
        sweeps = 0.0 if explicit else 50 * h_norm_B
        works = critical is None or h_norm_B <= critical
        outcome = (("converged", TRIAL_STEPS[n], sweeps, 1e-15, 0.0, 1e-6, None) if works
                   else (failed, 2, sweeps, None, None, None, 3))
        trials.append(Trial(scene, n, name, h_norm_B, *outcome))
    bracket = (limit, critical, BISECTED * critical, failed) if critical else (None, None, None, None)
    return Edge(scene, n, name, *bracket), trials


def map_study(settings=SETTINGS, names=LISTED, solver="published"):
    """Returns the Study; tests change its tables."""
    maps = [edge_and_trials(scene, n, name) for scene, n in settings for name in names]
    return study_file.Study(dict(CONTEXT), MapSettings(solver, 400), {
        "integrators": integrators(names),
        "settings": [Setting(scene, n, norm(n), 2 * norm(n), TRIAL_STEPS[n], TRIAL_STEPS[n]) for scene, n in settings],
        "maps": [edge for edge, _ in maps],
        "trials": [trial for _, trials in maps for trial in trials]})


def long_study(names=tuple(INTEGRATORS)):
    runs, samples = [], []
    for name, share in ((name, share) for name in names for share in SHARES):
        critical = INTEGRATORS[name][6] or GRID[-1]
        h = share * critical / norm(17)
        lost = (name, share) == ("rk4", 0.9)
        steps = LOST_AT - 1 if lost else LONG_STEPS
        for step in (step for step in SAMPLED if step <= steps):
            error = LINEAR_RATE * step * h if name == "rk4" else 1e-14
            skew = 1e-15 * step if name == CONTROL else 0.0 if name.startswith("algebra") else 2e-15
            samples.append(Sample(len(runs), step, error, error / 2, 1e-3, skew))
        runs.append(RunRow("smooth", 17, name, share, critical, share * critical, h,
                           "unstable" if lost else "converged", steps, 20.0, LOST_AT if lost else None))
    return study_file.Study(dict(CONTEXT), LongRunSettings(LONG_STEPS, 400),
                            {"integrators": integrators(names), "runs": runs, "samples": samples})


def write(folder, study, name):
    """Writes a study's raw file and returns its path."""
    path = os.path.join(folder, name)
    schema = MAP_SCHEMA if "maps" in study.tables else LONG_RUNS_SCHEMA
    study_file.write(path, schema, study.context, study.settings, study.tables)
    return path
