"""The parts of a verdict of the regression gate: what was checked, by cell and figure, and whether it passed."""

from dataclasses import dataclass, field
from typing import List, Optional

PASSED, REGRESSION, COULD_NOT_RUN, NOT_JUDGED = 0, 1, 2, 3  # exit codes
INTERRUPTED = 130  # as a shell has it


@dataclass(frozen=True)
class Check:
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


def exit_code(layers):
    if any(layer.failures() for layer in layers):
        return REGRESSION
    return NOT_JUDGED if any(layer.not_judged for layer in layers) else PASSED
