"""Small files of stability and long_runs, made up, whose every answer can be worked out by hand.

Every trial up to the critical h‖B‖₂ of its integrator works, with 50 h‖B‖₂ sweeps a step, and every one beyond fails.
"""

import json
import math
import os

from study_documents import context

GRID = [2.0 ** (k / 2) for k in range(-6, 8)]
BISECTED = 1.02  # the first that fails over the last that works
MOST_SWEEPS = 400
SETTINGS = (("smooth", 17), ("smooth", 129), ("rough", 17))
ROUGH = 1.5  # critical values of the rough scene over those of the smooth one
TRIAL_STEPS = {17: 50, 129: 5}

# name: stages, order, isospectral, Lie-Poisson, symmetric, explicit, critical h‖B‖₂, linear limit, contraction there
INTEGRATORS = {
    **{f"{formulation}{s}": (s, 2 * s, True, True, True, False, 1.5, 1.5, 0.9)
       for formulation in ("cotangent", "group") for s in (1, 2, 3)},
    "algebra1": (1, 2, True, True, True, False, 1.6, 2.0, 0.6),
    "algebra2": (2, 4, True, True, True, False, 1.9, 1.9, 0.9),
    "algebra3": (3, 6, True, True, True, False, 2.2, 2.2, 0.9),
    "yoshida4": (3, 4, True, True, True, False, 1.2, 1.2, 0.9),
    "rkmk4": (4, 4, True, False, False, True, None, None, 0.0),  # works wherever it was tried
    "rk4": (4, 4, False, False, False, True, 2.0, 1.0, 0.0),
}
CONTROL = "algebra2_two_products"

LONG_STEPS = 2000
SHARES = (0.9, 0.3)
LOST_RATE = 0.015  # of the control's skew defect, a step
LINEAR_RATE = 1e-5  # of what rk4 loses, per unit time


def norm(n):
    return n / 16


def trial(name, n, h_norm_B, critical):
    explicit, contraction = INTEGRATORS[name][5], INTEGRATORS[name][8]
    works = critical is None or h_norm_B <= critical
    failed = "unstable" if explicit else "diverged"
    result = {
        "h_norm_B": h_norm_B, "step": h_norm_B / norm(n), "status": "converged" if works else failed,
        "steps": TRIAL_STEPS[n] if works else 2, "sweeps_per_step": 0.0 if explicit else 50 * h_norm_B,
        "contraction": contraction if works else None, "spectrum_error": 1e-15 if works else None,
        "skew_defect": 0.0 if works else None, "energy_error": 1e-6 if works else None,
    }
    if not works:
        result["failed_step"] = 3
    return result


def failure_map(scene, n, name):
    critical, limit = INTEGRATORS[name][6:8]
    if critical and scene == "rough":
        critical *= ROUGH
    bracket = critical and {"works": trial(name, n, critical, critical),
                            "fails": trial(name, n, BISECTED * critical, critical)}
    return {"scene": scene, "n": n, "integrator": name, "linear_limit": limit,
            "trials": [trial(name, n, h_norm_B, critical) for h_norm_B in GRID], "critical": bracket}


def integrators(names=INTEGRATORS):
    fields = ("stages", "order", "isospectral", "lie_poisson", "symmetric", "explicit")
    return [{"name": name, **dict(zip(fields, INTEGRATORS[name][:6]))} for name in names]


def map_document(settings=SETTINGS):
    """Returns the document; tests change a copy of it."""
    return {
        "format": "isosyrk stability 1",
        "context": {**context(), "isosyrk_program": "stability"},
        "max_sweeps": MOST_SWEEPS,
        "integrators": integrators(),
        "settings": [{"scene": scene, "n": n, "norm_B": norm(n), "norm_ad_B": 2 * norm(n),
                      "trial_steps": {"explicit": TRIAL_STEPS[n], "implicit": TRIAL_STEPS[n]}} for scene, n in settings],
        "maps": [failure_map(scene, n, name) for scene, n in settings for name in INTEGRATORS],
    }


def sampled_steps():
    """Returns about ten steps a decade, and every 250th."""
    return sorted({round(10 ** (k / 10)) for k in range(100) if 10 ** (k / 10) <= LONG_STEPS}
                  | set(range(250, LONG_STEPS + 1, 250)))


def sample(name, step, h):
    time, wobble = step * h, 1 + 0.5 * math.sin(7.0 * step)
    lost = LINEAR_RATE * time if name == "rk4" else 1e-14 * wobble
    skew = 0.0 if name.startswith("algebra") else 2e-15 * wobble
    if name == CONTROL:
        skew = 1e-15 * math.exp(LOST_RATE * step)
    return {"step": step, "time": time, "spectrum_error": lost, "casimir_errors": [lost, lost / 2, lost / 2, lost / 4],
            "energy_error": 1e-3 * wobble, "skew_defect": skew}


def long_run(name, share, n=17):
    critical = INTEGRATORS["algebra2" if name == CONTROL else name][6] or GRID[-1]
    h = share * critical / norm(n)
    return {"scene": "smooth", "n": n, "integrator": name, "share": share, "critical": critical,
            "h_norm_B": share * critical, "step": h, "status": "converged", "steps": LONG_STEPS,
            "sweeps_per_step": 20.0, "samples": [sample(name, step, h) for step in sampled_steps()]}


def fail(run, step, status="unstable"):
    """Ends a run of a document at a step."""
    run.update(status=status, steps=step - 1, failed_step=step,
               samples=[each for each in run["samples"] if each["step"] < step])


def long_document():
    """Returns the document; near the edge rk4 fails at step 500."""
    listed = integrators()
    control = {**next(each for each in listed if each["name"] == "algebra2"), "name": CONTROL, "isospectral": False,
               "lie_poisson": False}
    runs = [long_run(name, share) for name in [*INTEGRATORS, CONTROL] for share in SHARES]
    fail(next(run for run in runs if (run["integrator"], run["share"]) == ("rk4", 0.9)), 500)
    return {"format": "isosyrk long_runs 1", "context": {**context(), "isosyrk_program": "long_runs"},
            "steps": LONG_STEPS, "integrators": [*listed, control], "runs": runs}


def write_document(folder, document, name):
    """Writes a document and returns its path."""
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(document, file)
    return path
