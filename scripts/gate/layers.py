"""The findings of the regression gate, and the two layers that are judged on the report of one build.

**Exact**: the counts of a run. Where this build rounds as the recorded one did, they are the baseline's. On other
kernels an iteration ends a sweep sooner or later wherever a last change lies near the tolerance: there head's counts
are compared with base's, both built here. A commit that changes only rounding still moves such steps, and one that
changes the algorithm moves most. So each build counts from W₀ and from states that differ from it by rounding. The
medians of both may be no further apart than the wider of their ranges is wide, and by two sweeps more: a step at the
very edge of the tolerance may end otherwise in no other run. Kernels with and without fused products moved one such
step. One sweep more in every step takes 50 sweeps more, at n = 17 in fast forms about 20, since the next step then
begins closer. 0.9 K for the coupling K of a fast form takes at least 11 sweeps more.

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
import statistics
from dataclasses import dataclass, field
from typing import Dict, List, NamedTuple, Optional

from lib.programs.messages import one_line
from lib.records.formats import CONVERGED
from lib.pages.document import Column, Entry, Heading, Items, Paragraph, Table
from gate.cells import FAST, compared, in_words, is_fast, other_kernels

PASSED, REGRESSION, NOT_JUDGED = 0, 1, 3  # exit codes
SUMMARY = {PASSED: "No regression.", REGRESSION: "Regression.",
           NOT_JUDGED: "No regression found, but not every layer was judged."}
FORMAT = "isosyrk check_regression 1"

# Runs of a cell from states that differ from W₀ by rounding, where counts of two builds need not be equal. Of five
# normal samples each, with deviations of 1, 2 and 4 sweeps, medians part by more in 0, 15 and 270 of a million pairs.
OTHER_ROUNDINGS = 4
STEPS_AT_THE_EDGE = 2  # of a run, which no state near W₀ shows to end otherwise
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
    pairs: Dict[str, List[float]] = field(default_factory=dict)  # of times: ratios of each cell, launch by launch

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


def as_document(layers, head, base, kernels):
    """Returns the report; `head` and `base` name what was compared, `kernels` is by build, for a reader."""
    summary = f"{SUMMARY[exit_code(layers)]} Head: {head}. Base: {base}."
    return [Heading("Regression gate", 1), Paragraph(summary), Items(list(kernels.items())),
            *(part for layer in layers for part in layer.sections())]


def as_json(layers, head, base, kernels, conditions):
    """Returns every check, as data."""
    return {"format": FORMAT, "exit_code": exit_code(layers), "head": head, "base": base, "kernels": kernels,
            "conditions": conditions,
            "layers": [{**vars(layer), "verdict": layer.verdict(),
                        "checks": [check._asdict() for check in layer.checks]} for layer in layers]}


# ---- exact


def exact_layer(baseline, head, base, names, why_none=None):
    """Checks the counts of these cells: against the baseline's where this build rounds as the recorded one did.

    Elsewhere `base` is another build's report of the same cells, or None, and `why_none` tells why there is none.
    """
    layer = Layer("exact")
    recorded = head.rounding == baseline.rounding
    if not recorded:
        layer.not_judged = (why_not_compared(head, base) if base
                            else f"these are not the recorded kernels, and {why_none}")
        layer.notes.append(f"not the recorded kernels ({in_words(baseline.rounding)}, on {baseline.rounding['cpu']}): "
                           + (f"head is counted against base, within what rounding moves in {OTHER_ROUNDINGS + 1} runs"
                              f" of a cell" if not layer.not_judged else "no sweeps, products or Poisson solves"))
    compares = not layer.not_judged
    for name in names:
        status = head.cells[name].status if name in head.cells else "missing"
        layer.add(name, "status", status, CONVERGED, status == CONVERGED)
        if status != CONVERGED:
            continue
        cell, wanted = head.cells[name], baseline.counts[name]
        layer.add(name, "allocations", cell.counts["allocations"], wanted["allocations"],
                  cell.counts["allocations"] <= wanted["allocations"])
        if recorded:
            check_recorded_counts(layer, cell, wanted)
        elif compares:
            check_counts_of_base(layer, cell, base.cells.get(name))
    return layer


def why_not_compared(head, base):
    """Returns why two builds on one machine cannot be compared, or None."""
    fields = other_kernels(head.rounding, base.rounding)
    return "base runs other kernels: " + ", ".join(
        f"{field} {base.rounding[field]} for {head.rounding[field]}" for field in fields) if fields else None


def counted(cell):
    return [count for count in cell.counts if count != "allocations"]


def check_recorded_counts(layer, cell, wanted):
    for count in counted(cell):
        found = cell.counts[count]
        layer.add(cell.name, count, f"{found:.10g}", f"{wanted[count]:.10g}",
                  abs(found - wanted[count]) <= ROUNDING_OF_SUMS)


def check_counts_of_base(layer, cell, base):
    """Checks that the medians of head's counts and of base's are no further apart than the module's text says."""
    if base is None or base.status != CONVERGED:
        why = f"{cell.name}: base has no counts, {base.status if base else 'and no such cell'}"
        layer.notes.append(why)
        layer.not_judged = layer.not_judged or why
        return
    for count in counted(cell):
        found, wanted = cell.runs(count), base.runs(count)
        of_a_sweep = base.counts[count] / base.counts["sweeps"]
        slack = max(max(found) - min(found), max(wanted) - min(wanted)) + STEPS_AT_THE_EDGE * of_a_sweep
        layer.add(cell.name, count, with_range(found), f"{with_range(wanted)} ± {slack:.3g}",
                  abs(statistics.median(found) - statistics.median(wanted)) <= slack + ROUNDING_OF_SUMS)


def with_range(counts):
    """Returns the median as text, and the range behind it if there is one."""
    low, high = f"{min(counts):.10g}", f"{max(counts):.10g}"
    return f"{statistics.median(counts):.10g}" + (f" ({low} to {high})" if low != high else "")


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
