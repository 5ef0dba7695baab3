"""Made-up reports of builds, for the tests of the regression gate."""

import os
import re

from programs import DATA

from gate.cells import SIZES, cells_of, is_fast
from gate.layers import read_answer

CONTEXT = {"commit": "0123456789ab", "dirty": "no", "cpu": "AMD EPYC", "blas_library": "OpenBLAS 0.3.21",
           "blas_kernels": "Zen", "split_kernels": "avx2", "vector_units": "avx2; compiled for AVX2 with FMA",
           "compiler": "GNU 12.2.0", "flags": "-O3"}


def cell_document(name):
    """Returns what a sound build reports of a cell; sweeps of a fast one take 8 equivalent products, 4 solves."""
    formulation, n, stages = re.fullmatch("(?:fast_)?(.*)/n:(.*)/s:(.*)", name).groups()
    n, stages = int(n), int(stages)
    cell = {"name": name, "n": n, "status": "converged", "steps": 50, "tolerance": 1e-13, "norm": 2.0,
            "contraction": 0.1, "allocations": 0, "spectrum_error": 1e-15}
    if is_fast(name):
        cell.update(sweeps=100, equivalent_products=800.0, poisson_solves=400, skew_defect=0.0,
                    distance_to_published=1e-14)
    else:
        sweeps, products = 500 + n, stages * (stages + 1) if formulation == "algebra" else 3 * stages
        cell.update(sweeps=sweeps, products=products * sweeps + 50 * (products + 1),
                    poisson_solves=stages * (sweeps + 50),
                    skew_defect=0.0 if formulation == "algebra" else 1e-15,
                    distance_to_group=0.0 if formulation == "group" else 1e-14)
    if n == 17:
        answer = read_answer(os.path.join(DATA, f"W_t5_h0.1_n17_s{stages}.csv"))
        cell["W"] = [[entry.real, entry.imag] for entry in answer]
    return cell


def build_document():
    return {"format": "isosyrk regression_cells 2", "context": dict(CONTEXT),
            "cells": [cell_document(name) for name in cells_of(SIZES)]}


def cell_of(document, name):
    return next(cell for cell in document["cells"] if cell["name"] == name)


def with_other_roundings(document, name, *steps):
    """Gives a cell further runs, each of so many sweeps more than that from W₀ and with their work."""
    cell = cell_of(document, name)
    counts = ["sweeps", "poisson_solves", "equivalent_products" if is_fast(name) else "products"]
    cell["other_roundings"] = [{count: cell[count] + step * cell[count] // cell["sweeps"] for count in counts}
                               for step in steps]
    return document


def change(document, name, **values):
    """Changes a cell of a document; None takes a field out."""
    cell = cell_of(document, name)
    for field, value in values.items():
        if value is None:
            del cell[field]
        else:
            cell[field] = value
    return document
