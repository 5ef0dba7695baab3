"""What the readers of this project's own raw files share: fields checked for their kind, and what all files hold.

Everything is checked before anything is used.
"""

import math
from dataclasses import dataclass

from benchmark_json import LARGEST_COUNTER, UnusableFile, one_line, parse_json, printable_context, quoted, read_text

CONVERGED, SWEEP_CAP, UNSTABLE = "converged", "sweep cap", "unstable"
STATUSES = (CONVERGED, "diverged", "stagnated", SWEEP_CAP, UNSTABLE)
CASIMIRS = (2, 3, 4, 5)
# Errors, norms and step sizes that are not 0 lie far inside; others are damage, and quotients of them overflow.
SMALLEST, LARGEST = 1e-30, LARGEST_COUNTER
LONGEST_TEXT = 60  # of a name


@dataclass(frozen=True)
class Integrator:
    name: str
    stages: int
    order: int
    isospectral: bool
    lie_poisson: bool
    symmetric: bool
    explicit: bool

    def keeps(self, structure):
        """Tells whether it keeps "nothing" (always), the "spectrum", or the Lie–"poisson" structure."""
        return {"nothing": True, "spectrum": self.isospectral, "poisson": self.lie_poisson}[structure]


def read(path, analyse):
    """Returns what `analyse` makes of the JSON in `path`. Throws UnusableFile with one line naming file and problem."""
    try:
        return analyse(parse_json(read_text(path)))
    except UnusableFile as problem:
        raise UnusableFile(f"{one_line(path)}: {problem}") from None


def context(document, file_format):
    """Returns the conditions of measurement as text, having checked the format, as "isosyrk work_precision 1"."""
    found = document.get("format") if isinstance(document, dict) else None
    if found != file_format:
        program = file_format.split()[1]
        raise UnusableFile(f"was not written by {program} (its format is {quoted(found)}, not {quoted(file_format)})")
    if not isinstance(document.get("context"), dict):
        raise UnusableFile("has no context")
    return printable_context(document["context"])


def objects(document, field):
    """Returns a list of objects. A table of {"columns": names, "rows": lists of values} is one, in half the bytes."""
    found = document.get(field)
    if isinstance(found, dict) and all(isinstance(found.get(part), list) for part in ("columns", "rows")):
        columns, rows = found["columns"], found["rows"]
        if not all(isinstance(each, str) for each in columns):
            raise UnusableFile(f"has columns of {field} that have no names")
        if not all(isinstance(each, list) and len(each) == len(columns) for each in rows):
            raise UnusableFile(f"has rows of {field} that are not as long as its columns")
        return [dict(zip(columns, row)) for row in rows]
    if not isinstance(found, list) or not all(isinstance(each, dict) for each in found):
        raise UnusableFile(f"has no list of objects named {field}")
    return found


def unique(items, field):
    found = {getattr(item, field): item for item in items}
    if len(found) < len(items):
        raise UnusableFile(f"names the same {field} twice")
    if not found:
        raise UnusableFile(f"names no {field}")
    return found


class Fields:
    """The fields of one JSON object, each asked for by the kind of value it must be."""

    def __init__(self, values, what):
        self.values = values
        self.what = what

    def get(self, field):
        if field not in self.values:
            raise UnusableFile(f"{self.what} has no {field}")
        return self.values[field]

    def refuse(self, field, wanted):
        raise UnusableFile(f"{self.what} has {field} {quoted(self.values[field])} where {wanted} is needed")

    def text(self, field):
        value = self.get(field)
        if not isinstance(value, str) or one_line(value) != value or not 0 < len(value) <= LONGEST_TEXT:
            self.refuse(field, "a short text")
        return value

    def one_of(self, field, allowed):
        value = self.text(field)
        if value not in allowed:
            self.refuse(field, f"one of {', '.join(allowed)}")
        return value

    def truth(self, field):
        value = self.get(field)
        if not isinstance(value, bool):
            self.refuse(field, "true or false")
        return value

    def not_negative(self, field):
        value = self.get(field)
        if not is_not_negative(value):
            self.refuse(field, f"a number from 0 to {LARGEST:g}")
        return float(value)

    def positive(self, field):
        value = self.not_negative(field)
        if value < SMALLEST:
            self.refuse(field, f"a number from {SMALLEST:g} to {LARGEST:g}")
        return value

    def whole(self, field, least=0):
        value = self.get(field)
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value < 10**15:
            self.refuse(field, f"a whole number from {least} on")
        return value

    def optional(self, field):
        """Returns a number, 0 or more, or None where null is recorded."""
        return None if self.get(field) is None else self.not_negative(field)

    def error_of_any_size(self, field):
        """Returns an error, or None where it was not finite or beyond all measure: a run that blew up leaves such."""
        value = self.get(field)
        if value is not None and (not is_number(value) or value < 0):
            self.refuse(field, "a number, 0 or more, or null")
        return None if value is None or value > LARGEST else float(value)

    def numbers(self, field, length=None):
        value = self.get(field)
        if not isinstance(value, list) or not all(map(is_not_negative, value)):
            self.refuse(field, f"a list of numbers from 0 to {LARGEST:g}")
        if length is not None and len(value) != length:
            self.refuse(field, f"a list of {length}")
        return tuple(map(float, value))

    def object(self, field):
        value = self.get(field)
        if not isinstance(value, dict):
            self.refuse(field, "an object")
        return Fields(value, f"{self.what}'s {field}")


def is_number(value):
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    try:
        return math.isfinite(float(value))
    except OverflowError:
        return False


def is_not_negative(value):
    return is_number(value) and 0 <= value <= LARGEST


def integrator(fields):
    return Integrator(*properties(fields))


def properties(fields):
    """Returns the values of an Integrator in their order."""
    return (fields.text("name"), fields.whole("stages", 1), fields.whole("order", 1), fields.truth("isospectral"),
            fields.truth("lie_poisson"), fields.truth("symmetric"), fields.truth("explicit"))
