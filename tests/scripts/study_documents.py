"""A small file of work_precision, made up, whose every answer can be worked out by hand.

Errors are exactly C·h^order down to a floor, products and times exactly proportional to the number of steps.
"""

import json
import os

STEPS = (5, 10, 20, 50, 100, 200)
TIME = 5.0
UNCERTAINTY = 1e-14
SIZES = (17, 33)

# name: stages, order, isospectral, Lie-Poisson, symmetric, explicit, limit, C of the error, seconds a step
INTEGRATORS = {
    "cotangent1": (1, 2, True, True, True, False, None, 1.0, 2e-3),
    "group1": (1, 2, True, True, True, False, None, 1.0, 1.5e-3),
    "group2": (2, 4, True, True, True, False, None, 0.1, 4e-3),
    "rkmk4": (4, 4, True, False, False, True, None, 1e-3, 1e-3),
    "rk4": (4, 4, False, False, False, True, 2.8284, 1e-2, 1e-4),
}


def context():
    return {"isosyrk_program": "work_precision", "isosyrk_format": "1", "commit": "0123456789ab", "dirty": "no",
            "compiler": "GNU 12.2.0", "cpu": "a processor", "blas_kernels": "Zen", "tolerance": "1e-13"}


def point(name, n, steps, status="converged"):
    _, order, isospectral, _, _, _, limit, factor, seconds_a_step = INTEGRATORS[name]
    step = TIME / steps
    usable = status == "converged"
    error = max(factor * step**order, UNCERTAINTY) if usable else None
    small = 1e-15 if usable else None
    norm = 1.4 * n / 17 * step
    result = {
        "integrator": name, "n": n, "steps": steps, "step": step, "status": status, "error": error,
        "spectrum_error": (1e-15 if isospectral else error) if usable else None,
        "casimir_errors": [1e-15] * 4 if usable else None, "energy_error": small,
        "angular_momentum_error": small, "skew_defect": 0.0 if usable else None,
        "h_norm_B": norm, "h_norm_ad_B": 2 * norm, "beyond_limit": limit is not None and 2 * norm > limit,
        "sweeps": 0, "products": 4 * steps, "poisson_solves": 4 * steps,
        "cpu_seconds": [seconds_a_step * steps * factor for factor in (0.99, 1.0, 1.02)] if usable else [],
    }
    if not usable:
        result["failed_step"] = 1
    return result


def tolerance_point(formulation, stages, n, exponent):
    name = f"{formulation}{stages}"
    result = point(name, n, 50)
    for field in ("integrator", "h_norm_B", "h_norm_ad_B", "beyond_limit"):
        del result[field]
    tolerance = 10.0**-exponent
    result.update(formulation=formulation, stages=stages, tolerance=tolerance, solver_error=tolerance / 10,
                  error=result["error"] + tolerance / 10)
    return result


def study_document():
    """Returns the document; tests change a copy of it."""
    points = [point(name, n, steps) for n in SIZES for name in INTEGRATORS for steps in STEPS]
    for index, each in enumerate(points):
        if each["integrator"] == "group1" and each["steps"] == 5:  # past the edge of plain iteration
            points[index] = point("group1", each["n"], 5, "diverged")
    return {
        "format": "isosyrk work_precision 1",
        "context": context(),
        "scene": "smooth",
        "time": TIME,
        "references": [{"n": n, "uncertainty": UNCERTAINTY, "first": {"integrator": "group5", "steps": 200},
                        "second": {"integrator": "rkmk4", "steps": 3200}} for n in SIZES],
        "integrators": [{"name": name, "stages": stages, "order": order, "isospectral": isospectral,
                         "lie_poisson": poisson, "symmetric": symmetric, "explicit": explicit,
                         "stability_limit": limit}
                        for name, (stages, order, isospectral, poisson, symmetric, explicit, limit, _, _)
                        in INTEGRATORS.items()],
        "points": points,
        "tolerance_points": [tolerance_point("group", stages, n, exponent) for n in SIZES for stages in (1, 2)
                             for exponent in range(4, 14)],
    }


def small_study():
    """Returns a study of two integrators at one n, which is drawn in a second or two."""
    study = study_document()
    study["references"] = study["references"][:1]
    kept = ("group1", "rk4")
    study["integrators"] = [each for each in study["integrators"] if each["name"] in kept]
    study["points"] = [point for point in study["points"] if point["n"] == 17 and point["integrator"] in kept]
    study["tolerance_points"] = [point for point in study["tolerance_points"] if point["n"] == 17]
    return study


def write_study(folder, document=None, name="raw.json"):
    """Writes a document (by default the one above) and returns its path."""
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(document if document is not None else study_document(), file)
    return path
