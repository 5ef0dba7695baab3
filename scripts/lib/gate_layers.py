"""What the regression gate says: what was checked, by cell and figure, for readers and as JSON for programs."""

from dataclasses import dataclass, field
from typing import List, NamedTuple, Optional

from checked_json import one_line
from document import Column, Entry, Heading, Items, Paragraph, Table

PASSED, REGRESSION, NOT_JUDGED = 0, 1, 3  # exit codes
SUMMARY = {PASSED: "No regression.", REGRESSION: "Regression.",
           NOT_JUDGED: "No regression found, but not every layer was judged."}
FORMAT = "isosyrk check_regression 1"


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
            rows = [[Entry(text, not passed) for text in texts] for *texts, passed in shown]
            parts.append(Table(columns, [rows]))
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
