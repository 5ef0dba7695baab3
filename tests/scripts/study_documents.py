"""A small study of accuracy, made up, whose every answer can be worked out by hand.

Errors are exactly C·h^order down to a floor, products and times exactly proportional to the number of steps. A document
is the context, the settings, and each table as a list of dicts, which tests change.
"""

import json
import os
import sys

from programs import ROOT

sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
from accuracy_lines import SCHEMA, accuracy  # noqa: E402
from study_file import FORMAT, study_of  # noqa: E402

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
    return {"commit": "0123456789ab", "dirty": "no", "compiler": "GNU 12.2.0", "cpu": "a processor",
            "blas_kernels": "Zen", "tolerance": "1e-13"}


def run(name, n, steps, status="converged"):
    _, order, isospectral, _, _, _, limit, factor, seconds_a_step = INTEGRATORS[name]
    step = TIME / steps
    usable = status == "converged"
    error = max(factor * step**order, UNCERTAINTY) if usable else None
    small = 1e-15 if usable else None
    norm = 1.4 * n / 17 * step
    return {
        "integrator": name, "n": n, "steps": steps, "step": step, "tolerance": 1e-13, "status": status, "error": error,
        "solver_error": None, "spectrum_error": (1e-15 if isospectral else error) if usable else None,
        "casimir_errors": [1e-15] * 4 if usable else None, "energy_error": small,
        "angular_momentum_error": small, "skew_defect": 0.0 if usable else None,
        "h_norm_B": norm, "h_norm_ad_B": 2 * norm, "beyond_limit": limit is not None and 2 * norm > limit,
        "sweeps": 0, "products": 4 * steps, "poisson_solves": 4 * steps,
        "cpu_seconds": [seconds_a_step * steps * factor for factor in (0.99, 1.0, 1.02)] if usable else [],
    }


def tolerance_run(name, n, exponent):
    result = run(name, n, 50)
    tolerance = 10.0**-exponent
    result.update(tolerance=tolerance, solver_error=tolerance / 10, error=result["error"] + tolerance / 10)
    return result


def study_document():
    """Returns the document; tests change a copy of it."""
    runs = [run(name, n, steps) for n in SIZES for name in INTEGRATORS for steps in STEPS]
    for index, each in enumerate(runs):
        if each["integrator"] == "group1" and each["steps"] == 5:  # past the edge of plain iteration
            runs[index] = run("group1", each["n"], 5, "diverged")
    return {
        "context": context(),
        "settings": {"scene": "smooth", "time": TIME},
        "references": [{"n": n, "uncertainty": UNCERTAINTY, "integrators": ["group5", "rkmk4"], "steps": [200, 3200]}
                       for n in SIZES],
        "integrators": [{"name": name, "stages": stages, "order": order, "isospectral": isospectral,
                         "lie_poisson": poisson, "symmetric": symmetric, "explicit": explicit,
                         "stability_limit": limit}
                        for name, (stages, order, isospectral, poisson, symmetric, explicit, limit, _, _)
                        in INTEGRATORS.items()],
        "runs": runs,
        "tolerance_runs": [tolerance_run(name, n, exponent) for n in SIZES for name in ("group1", "group2")
                           for exponent in range(4, 14)],
    }


def run_of(document, name, n, steps):
    """Returns a run of a document, to be changed there."""
    return next(each for each in document["runs"] if (each["integrator"], each["n"], each["steps"]) == (name, n, steps))


def small_study():
    """Returns a study of two integrators at one n, which is drawn in a second or two."""
    study = study_document()
    study["references"] = study["references"][:1]
    kept = ("group1", "rk4")
    study["integrators"] = [each for each in study["integrators"] if each["name"] in kept]
    study["runs"] = [each for each in study["runs"] if each["n"] == 17 and each["integrator"] in kept]
    study["tolerance_runs"] = [each for each in study["tolerance_runs"]
                               if each["n"] == 17 and each["integrator"] in kept]
    return study


def raw(document):
    """Returns a document as a raw file holds it."""
    def table(name, record):
        return {"columns": list(record._fields), "rows": [[row[column] for column in record._fields]
                                                          for row in document[name]]}

    return {"format": FORMAT, "study": SCHEMA.study, "context": document["context"], "settings": document["settings"],
            "tables": {name: table(name, record) for name, record in SCHEMA.tables.items()}}


def accuracy_of(document):
    return accuracy(study_of(raw(document), SCHEMA))


def write_study(folder, document=None, name="raw.json"):
    """Writes a document (by default the one above) and returns its path."""
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(raw(document if document is not None else study_document()), file)
    return path
