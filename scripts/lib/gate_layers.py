"""The findings of the regression gate, and the two layers that are judged on the report of one build.

**Exact**: the counts of a run against the baseline's.

**Accuracy**: errors against bounds that follow from the tolerance. With tolerance τ and contraction ρ of the iteration
(linear theory, at the initial data), an accepted stage is within e = τ ρ / (1 - ρ) of its equation's solution, in the
Frobenius norm. Forming W₁ rounds by about r = 4 √n u ‖W‖, with u = 2⁻⁵³. After N steps, twice for what the flow does to
earlier errors:

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
from dataclasses import dataclass, field
from typing import List, NamedTuple, Optional

from lib.formats import CONVERGED
from lib.messages import one_line
from lib.document import Column, Entry, Heading, Items, Paragraph, Table
from lib.gate_cells import FAST, compared, is_fast

PASSED, REGRESSION, NOT_JUDGED = 0, 1, 3  # exit codes
SUMMARY = {PASSED: "No regression.", REGRESSION: "Regression.",
           NOT_JUDGED: "No regression found, but not every layer was judged."}
FORMAT = "isosyrk check_regression 1"

# Sweeps of a run that other kernels, which round otherwise, may take more or less: an iteration that ends just under
# the tolerance here ends just above it there. One extra sweep a step would be 50; one product or Poisson solve more in
# every step is 50, and more than the work of these sweeps.
SWEEPS_OF_OTHER_KERNELS = 3
# A fast form's correction between sweeps ends by what was seen of its contraction, and takes a turn more or less in
# some steps. Between builds with AVX2 and with AVX-512 kernels sweeps differed by up to 3, and work by that of up to 6
# sweeps. One coupling through B more in every step is seen: it is the work of at least 14 sweeps.
SWEEPS_OF_CORRECTIONS = 10
# Equivalent products are sums of 50 quotients below 100, each rounded; one multiplication more at n = 129 adds 1e-7.
ROUNDING_OF_SUMS = 1e-9

UNIT_ROUNDOFF = 2.0**-53
TRUNCATED = 0.1  # of the tolerance, by the bands of a fast form
FARTHEST = 1e-11  # that a fast answer may be from the published one, whatever the contraction
ANSWERS = {17: "W_t5_h0.1_n17_s{}.csv"}  # reference answers, by n


class Check(NamedTuple):
    """One figure of one cell against what is allowed, both as text for a reader."""

    cell: str
    quantity: str
    found: str
    allowed: str
    passed: bool

    def line(self):
        return f"{self.cell}: {self.quantity} {self.found}, allowed {self.allowed}"


@dataclass
class Layer:
    """A layer that was judged, or why some or all of it was not."""

    name: str
    checks: List[Check] = field(default_factory=list)
    not_judged: Optional[str] = None
    notes: List[str] = field(default_factory=list)

    def add(self, cell, quantity, found, allowed, passed):
        self.checks.append(Check(cell, quantity, str(found), str(allowed), bool(passed)))

    def failures(self):
        return [check for check in self.checks if not check.passed]

    def verdict(self):
        if self.failures():
            return "regression"
        return "not judged" if self.not_judged else "passed"

    def sections(self):
        """Returns its part of the report; all checks are shown where they are times, else only failures."""
        parts = [Heading(f"{self.name}: {self.verdict()}")]
        if self.not_judged:
            parts.append(Paragraph(f"{self.name} not judged: {self.not_judged}"))
        if self.checks:
            parts.append(Paragraph(f"{len(self.checks) - len(self.failures())} of {len(self.checks)} checks passed."))
        shown = self.checks if self.name == "timing" else self.failures()
        if shown:
            columns = tuple(Column(name, align="left") for name in ("cell", "quantity", "found", "allowed"))
            parts.append(Table(columns, [[[Entry(text, not passed) for text in texts] for *texts, passed in shown]]))
        if self.notes:
            parts.append(Items([("", one_line(note)) for note in self.notes]))
        return parts


def exit_code(layers):
    if any(layer.failures() for layer in layers):
        return REGRESSION
    return NOT_JUDGED if any(layer.not_judged for layer in layers) else PASSED


def as_document(layers, head, base):
    """Returns the report; `head` and `base` name what was compared."""
    summary = f"{SUMMARY[exit_code(layers)]} Head: {head}. Base of the times: {base}."
    return [Heading("Regression gate", 1), Paragraph(summary), *(part for layer in layers for part in layer.sections())]


def as_json(layers, head, base, conditions):
    """Returns every check, as data."""
    return {"format": FORMAT, "exit_code": exit_code(layers), "head": head, "base": base, "conditions": conditions,
            "layers": [{**vars(layer), "verdict": layer.verdict(),
                        "checks": [check._asdict() for check in layer.checks]} for layer in layers]}


# ---- exact


def exact_layer(baseline, build, names):
    """Checks the counts of these cells.

    Published forms round as their products do, in the kernels of the BLAS; fast ones as the compiler has it, too.
    """
    layer = Layer("exact")
    same_kernels = build.kernels == baseline.kernels
    same_rounding = same_kernels and build.compiler == baseline.compiler
    if not same_rounding:
        layer.notes.append(f"other {'compiler' if same_kernels else 'kernels'} than the baseline's: the sweeps of a"
                           f" {'fast ' if same_kernels else ''}run may differ by {SWEEPS_OF_OTHER_KERNELS}, and the"
                           f" products and Poisson solves by those of so many sweeps, of a fast one by those of"
                           f" {SWEEPS_OF_CORRECTIONS}")
    for name in names:
        status = build.cells[name].status if name in build.cells else "missing"
        layer.add(name, "status", status, CONVERGED, status == CONVERGED)
        if status == CONVERGED:
            check_counts(layer, build.cells[name], baseline.counts[name],
                         same_rounding if is_fast(name) else same_kernels)
    return layer


def check_counts(layer, cell, wanted, exactly):
    """Checks counts: exactly, or within the work of some of the baseline's sweeps. Allocations may only be fewer."""
    for count, found in cell.counts.items():
        if count == "allocations":
            layer.add(cell.name, count, found, wanted[count], found <= wanted[count])
            continue
        sweeps = SWEEPS_OF_CORRECTIONS if is_fast(cell.name) and count != "sweeps" else SWEEPS_OF_OTHER_KERNELS
        slack = 0 if exactly else sweeps * wanted[count] / wanted["sweeps"]
        layer.add(cell.name, count, f"{found:.10g}", f"{wanted[count]:.10g}" + (f" ± {slack:.3g}" if slack else ""),
                  abs(found - wanted[count]) <= slack + ROUNDING_OF_SUMS)


# ---- accuracy


def accuracy_layer(build, names, folder):
    """Checks these cells; reference answers are in `folder`."""
    layer = Layer("accuracy")
    for name in names:
        cell = build.cells.get(name)
        errors = (errors_of(cell, build.cells.get(compared(name)), folder) if cell and cell.status == CONVERGED
                  else [("answer", None, None)])
        for quantity, found, bound in errors:
            if found is None:
                layer.add(name, quantity, "none", "one", False)
            else:
                layer.add(name, quantity, f"{found:.2g}", f"{bound:.2g}", found <= bound)
    return layer


def errors_of(cell, other, folder):
    """Yields (quantity, error, bound) of a cell; an error that cannot be told is None.

    `other` is the cell that gives the same answer, or None.
    """
    fast, algebra = is_fast(cell.name), cell.name.startswith(("algebra/", FAST + "algebra/"))
    bound, rounding = answer_bound(cell), 2.0 * cell.steps * rounding_of(cell.n)
    yield "spectrum error", cell.spectrum_error, rounding if algebra else bound
    yield "skew defect", cell.skew_defect, 0.0 if fast or algebra else rounding
    if other is not cell:
        both = bound + answer_bound(other) if other else 0.0
        yield ("distance to " + ("published" if fast else "group"), other and cell.distance,
               min(FARTHEST, both) if fast else both)
    if cell.n in ANSWERS:
        wanted = read_answer(os.path.join(folder, ANSWERS[cell.n].format(cell.name[-1])))
        distance = cell.W and max(abs(a - b) for a, b in zip(cell.W, wanted))
        yield "error against the reference answer", distance, bound


def rounding_of(n):
    return math.sqrt(n) * UNIT_ROUNDOFF


def answer_bound(cell):
    if cell.contraction >= 1.0:
        return math.inf
    truncated = TRUNCATED if is_fast(cell.name) else 0.0
    stage = cell.tolerance * (cell.contraction + truncated) / (1.0 - cell.contraction)
    return 2.0 * cell.steps * (stage + 4.0 * rounding_of(cell.n) * cell.norm)


def read_answer(path):
    """Returns the entries of a reference answer, row by row."""
    with open(path, encoding="utf-8", newline="") as file:
        return [complex(float(row["re"]), float(row["im"])) for row in csv.DictReader(file)]
