"""The accuracy layer of the regression gate: errors against bounds that follow from the tolerance.

With tolerance τ and contraction ρ of the iteration (linear theory, at the initial data), an accepted stage is within
e = τ ρ / (1 - ρ) of its equation's solution, in the Frobenius norm. Forming W₁ rounds by about r = 4 √n u ‖W‖, with
u = 2⁻⁵³. After N steps, twice for what the flow does to earlier errors:

    answer      ≤ 2 N (e + r)                              largest entry of the difference from the exact answer
    spectrum    ≤ 2 N (e + r) for cotangent and group;     algebra depends on e at second order only: ≤ 2 N √n u
    skewness    ≤ 2 N √n u    for cotangent and group;     0 for algebra, whose update has no other choice

A fast form accepts by the same rule, but truncates to bands: in each of at most ten factors by a hundredth of τ, so
that e = τ (ρ + 0.1) / (1 - ρ). Its skewness is 0, and its answer that of the published form: they differ by at most the
sum of both bounds, and by no more than 1e-11.
"""

import csv
import math
import os

from command_line import Stop
from gate_cells import FAST, compared, is_fast
from gate_layers import Layer
from study_file import CONVERGED

UNIT_ROUNDOFF = 2.0**-53
TRUNCATED = 0.1  # of the tolerance, by the bands of a fast form
FARTHEST = 1e-11  # that a fast answer may be from the published one, whatever the contraction
ANSWERS = {17: "W_t5_h0.1_n17_s{}.csv"}  # reference answers, by n


def rounding(cell):
    return math.sqrt(cell.n) * UNIT_ROUNDOFF


def answer_bound(cell):
    if cell.contraction >= 1.0:
        return math.inf
    truncated = TRUNCATED if is_fast(cell.name) else 0.0
    stage = cell.tolerance * (cell.contraction + truncated) / (1.0 - cell.contraction)
    return 2.0 * cell.steps * (stage + 4.0 * rounding(cell) * cell.norm)


def is_algebra(cell):
    return cell.name.startswith(("algebra/", FAST + "algebra/"))


def spectrum_bound(cell):
    return 2.0 * cell.steps * rounding(cell) if is_algebra(cell) else answer_bound(cell)


def skewness_bound(cell):
    return 0.0 if is_fast(cell.name) or is_algebra(cell) else 2.0 * cell.steps * rounding(cell)


def accuracy_layer(build, names, folder):
    """Checks these cells; reference answers are in `folder`. Throws Stop if one of those cannot be read."""
    layer = Layer("accuracy")
    for name in names:
        cell = build.cells.get(name)
        if cell is None or cell.status != CONVERGED:
            layer.add(name, "answer", "none", "one", False)
            continue
        check(layer, cell, "spectrum error", cell.spectrum_error, spectrum_bound(cell))
        check(layer, cell, "skew defect", cell.skew_defect, skewness_bound(cell))
        check_distance(layer, build, cell)
        if cell.n in ANSWERS:
            wanted = read_answer(os.path.join(folder, ANSWERS[cell.n].format(name[-1])), cell.n)
            check(layer, cell, "error against the reference answer", distance(cell.W, wanted), answer_bound(cell))
    return layer


def check_distance(layer, build, cell):
    """Checks the difference from the answer that this cell gives too."""
    other = build.cells.get(compared(cell.name))
    if other is cell:
        return
    quantity = "distance to " + ("published" if is_fast(cell.name) else "group")
    if other is None or cell.distance is None:
        layer.add(cell.name, quantity, "none", "one", False)
        return
    bound = answer_bound(cell) + answer_bound(other)
    check(layer, cell, quantity, cell.distance, min(FARTHEST, bound) if is_fast(cell.name) else bound)


def check(layer, cell, quantity, found, bound):
    layer.add(cell.name, quantity, f"{found:.2g}", f"{bound:.2g}", found <= bound)


def distance(W, wanted):
    """Returns the largest entry of the difference; infinite where there is no answer to compare."""
    if W is None:
        return math.inf
    return max(abs(a - b) for a, b in zip(W, wanted))


def read_answer(path, n):
    """Returns the n² entries of a reference answer, row by row, from columns i, j, re, im."""
    try:
        with open(path, encoding="utf-8", newline="") as file:
            entries = {(int(row["i"]), int(row["j"])): complex(float(row["re"]), float(row["im"]))
                       for row in csv.DictReader(file)}
        return [entries[i, j] for i in range(n) for j in range(n)]
    except (OSError, KeyError, TypeError, ValueError):
        raise Stop(f"{path}: is no reference answer for n = {n}") from None
