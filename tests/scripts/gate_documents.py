"""Made-up reports of builds, for the tests of the regression gate. Import after scripts/lib is on the path."""

import os

from gate_accuracy import read_answer
from gate_cells import SIZES, cells_of, compared, is_fast
from programs import DATA

CONTEXT = {"commit": "0123456789ab", "dirty": "no", "blas_kernels": "Zen", "vector_units": "avx2",
           "compiler": "GNU 12.2.0"}


def reference_answer(stages):
    answer = read_answer(os.path.join(DATA, f"W_t5_h0.1_n17_s{stages}.csv"), 17)
    return [[entry.real, entry.imag] for entry in answer]


def cell_document(name):
    """Returns what a sound build reports of a cell."""
    if is_fast(name):
        return fast_document(name)
    formulation, n, stages = name.split("/")[0], int(name.split(":")[1].split("/")[0]), int(name[-1])
    each = stages * (stages + 1) if formulation == "algebra" else 3 * stages
    sweeps = 500 + n
    cell = {"name": name, "n": n, "status": "converged", "steps": 50, "tolerance": 1e-13, "norm": 2.0,
            "contraction": 0.1, "sweeps": sweeps, "products": each * sweeps + 50 * (each + 1),
            "poisson_solves": stages * (sweeps + 50), "allocations": 0, "spectrum_error": 1e-15,
            "distance_to_group": 0.0 if formulation == "group" else 1e-14, "skew_defect": 0.0 if formulation == "algebra" else 1e-15}
    if n == 17:
        cell["W"] = reference_answer(stages)
    return cell


def fast_document(name):
    """Returns the same of a fast cell, whose sweeps take 8 equivalent products and 4 Poisson solves each."""
    cell = cell_document(compared(name))
    del cell["products"], cell["distance_to_group"]
    return {**cell, "name": name, "sweeps": 100, "equivalent_products": 800.0, "poisson_solves": 400,
            "skew_defect": 0.0, "distance_to_published": 1e-14}


def build_document(names=None):
    return {"format": "isosyrk regression_cells 2", "context": dict(CONTEXT),
            "cells": [cell_document(name) for name in names or cells_of(SIZES)]}


def cell_of(document, name):
    return next(cell for cell in document["cells"] if cell["name"] == name)


def change(document, name, **values):
    """Changes a cell of a document; None takes a field out."""
    cell = cell_of(document, name)
    for field, value in values.items():
        if value is None:
            del cell[field]
        else:
            cell[field] = value
    return document
