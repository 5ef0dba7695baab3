"""A small study of accuracy, made up, whose every answer can be worked out by hand.

Errors are exactly C·h^order down to a floor, products and times exactly proportional to the number of steps. A document
is the context, the settings, and each table as a list of dicts, which tests change. Every integrator runs on every
problem: the smooth scene at two n, and the rough scene, whose errors are ten times as large. Those with a loose
tolerance take half the time at it and are as accurate, and Gauss methods then lose the spectrum.
"""

import json
import math
import os

import programs  # noqa: F401 (finds the modules of scripts/lib)

from lib.records.settings import LOOSE, TIGHT, Problem, keeps
from studies.accuracy.schema import BELOW, CUT, SCHEMA, Comparison
from studies.accuracy.lines import accuracy
from lib.records.formats import FAST, PUBLISHED, STUDY_FORMAT, listed, study_of

STEPS = (5, 10, 20, 50, 100, 200)
SMOOTH = tuple(Problem("smooth", 5.0, n) for n in (17, 33))
ROUGH = Problem("rough", 5.0, 17)
PROBLEMS = {**dict.fromkeys(SMOOTH, 1e-14), ROUGH: 1e-12}  # with the uncertainty of the reference
WITH_LOOSE = ("group2_frame", "elp4_frame")  # that run with a loose tolerance too
SOONER = 0.5  # is the time at it, over that at the tight one
SLOWER = 4  # a published form than the fast one
PROCESSES = (0.98, 1.01, 1.0, 0.99, 1.02, 1.0)  # of a comparison: the times of all rows over their usual ones

# name: C of the error, seconds a step
INTEGRATORS = {"cotangent1": (1.0, 2e-3), "group1": (1.0, 1.5e-3), "group2": (0.1, 4e-3), "rkmk4": (1e-3, 1e-3),
               "rk4": (1e-2, 1e-4), "group2_frame": (1e-2, 4e-3), "elp4_frame": (1e-2, 2e-3)}
# Who stands for a candidate of a comparison; the others have no row.
CANDIDATES = {"explicit": ("rk4", FAST, TIGHT), "rkmk": ("rkmk4", FAST, TIGHT), "elp": ("elp4_frame", FAST, 1e-8),
              "elp_matched": ("elp4_frame", FAST, 1e-6), "elp_bounded": ("elp4_frame", FAST, TIGHT),
              "gauss": ("group2_frame", FAST, TIGHT), "gauss_loose": ("group2_frame", FAST, 1e-7),
              "gauss_matched": ("group2_frame", FAST, 1e-6), "gauss_published": ("group2_frame", PUBLISHED, TIGHT),
              "named_published": ("group2", PUBLISHED, TIGHT)}
COMPARISONS = (1e-4, 1e-6)  # the errors of the comparisons, which are in the smooth scene only
# The largest h‖B(W₀)‖₂ that works: group1 fails at 5 steps; rk4 at half its limit by linear theory, as ‖ad_B‖₂ = 2‖B‖₂.
LIMITS = {**dict.fromkeys(INTEGRATORS, 100.0), "group1": 1.38, "rk4": 1.4142}

# What a run that fails has none of.
OF_GOOD_RUNS = ("error", "spectrum_error", "energy_error")


def spectrum_error(name, tolerance, error):
    """Returns that of a run: a Gauss method keeps the spectrum to its tolerance, an exponential one to rounding."""
    if not listed(name).isospectral:
        return error
    return 1e-15 if keeps(listed(name), tolerance, "spectrum") else tolerance


def run(problem, name, steps, solver=FAST, status="converged", tolerance=TIGHT):
    factor, seconds_a_step = INTEGRATORS[name]
    step = problem.time / steps
    error = max((10 if problem == ROUGH else 1) * factor * step**listed(name).order, PROBLEMS[problem])
    h_norm_B = 1.4 * problem.n / 17 * step
    slower = (SLOWER if solver == PUBLISHED else 1) * (SOONER if tolerance > TIGHT else 1)
    result = {
        **problem._asdict(), "integrator": name, "solver": solver, "steps": steps, "step": step,
        "tolerance": tolerance, "status": status, "error": error, "solver_error": None,
        "spectrum_error": spectrum_error(name, tolerance, error),
        "energy_error": 1e-15,
        "h_norm_B": h_norm_B, "beyond_limit": h_norm_B > LIMITS[name],
        "sweeps": 0, "products": 4 * steps, "equivalent_products": 4.0 * steps * slower,
        "cpu_seconds": [seconds_a_step * steps * slower * share for share in (0.99, 1.0, 1.02)],
    }
    return result if status == "converged" else {**result, **dict.fromkeys(OF_GOOD_RUNS), "cpu_seconds": []}


def comparison_row(problem, wanted, candidate):
    """Returns the row of a candidate, with the fewest steps that reach the error."""
    name, solver, tolerance = CANDIDATES[candidate]
    factor, _ = INTEGRATORS[name]
    steps = math.ceil(problem.time * (factor / wanted) ** (1 / listed(name).order))
    found = run(problem, name, steps, solver, tolerance=tolerance)
    seconds = found["cpu_seconds"][1]
    return {**{field: found[field] for field in Comparison._fields if field in found}, "wanted": wanted,
            "candidate": candidate, "cpu_seconds": [seconds * share for share in PROCESSES]}


def study_document():
    """Returns the document; tests change a copy of it."""
    lines = [(problem, name, tolerance) for problem in PROBLEMS for name in INTEGRATORS
             for tolerance in (TIGHT, *((LOOSE[listed(name).family],) if name in WITH_LOOSE else ()))]
    return {
        "context": {"commit": "0123456789ab", "dirty": "no", "compiler": "GNU 12.2.0", "cpu": "a processor",
                    "blas_kernels": "Zen", "tolerance": "1e-13"},
        "settings": {"quick": False},
        "references": [{**problem._asdict(), "uncertainty": uncertainty, "integrators": ["group5", "rkmk4"],
                        "steps": [200, 3200]} for problem, uncertainty in PROBLEMS.items()],
        "rates": [{"n": n, "published": 1e9 / n**3, "fast": 2e9 / n**3} for n in (17, 33)],
        "integrators": [listed(name)._asdict() for name in INTEGRATORS],
        "lines": [{**problem._asdict(), "integrator": name, "tolerance": tolerance,
                   "end": CUT if name in ("cotangent1", "group1") else BELOW} for problem, name, tolerance in lines],
        "runs": [run(problem, name, steps, FAST, "diverged" if (name, steps) == ("group1", 5) else "converged",
                     tolerance) for problem, name, tolerance in lines for steps in STEPS],
        "tolerance_runs": [{**run(problem, name, 50, PUBLISHED), "tolerance": 10.0**-digits,
                            "solver_error": 10.0**-(digits + 1)}
                           for problem in SMOOTH for name in ("group1", "group2") for digits in range(4, 14)],
        "comparisons": [comparison_row(problem, wanted, candidate) for problem in SMOOTH for wanted in COMPARISONS
                  for candidate in CANDIDATES],
    }


def run_of(document, name, n, steps, tolerance=TIGHT, scene="smooth"):
    """Returns a run of a document, to be changed there."""
    wanted = {"scene": scene, "n": n, "integrator": name, "tolerance": tolerance, "steps": steps}
    return next(each for each in document["runs"] if wanted.items() <= each.items())


def small_study():
    """Returns a study of two integrators on one problem, which is drawn in a second or two."""
    study = study_document()
    for table, rows in study.items():
        if table not in ("context", "settings"):
            study[table] = [each for each in rows if each.get("n", 17) == 17 and each.get("scene", "smooth") == "smooth"
                            and (each.get("integrator") or each.get("name", "rk4")) in ("group1", "rk4")]
    return study


def raw(document):
    """Returns a document as a raw file holds it."""
    def table(name, record):
        return {"columns": list(record._fields), "rows": [[row[column] for column in record._fields]
                                                          for row in document[name]]}

    return {"format": STUDY_FORMAT, "study": SCHEMA.study, "context": document["context"],
            "settings": document["settings"],
            "tables": {name: table(name, record) for name, record in SCHEMA.tables.items()}}


def accuracy_of(document):
    return accuracy(study_of(raw(document), SCHEMA))


def write_study(folder, document=None, name="raw.json"):
    """Writes a document (by default the one above) and returns its path."""
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(raw(document if document is not None else study_document()), file)
    return path
