"""The raw file of a study: one format, one reader and one writer for all studies.

    {"format": "isosyrk study 1", "study": "accuracy", "context": {name: text}, "settings": {name: value},
     "tables": {name: {"columns": [...], "rows": [[...], ...]}}}

A study declares its settings and tables once, as a Schema of NamedTuple classes whose annotations are *kinds*:
functions that return a checked value, or raise Wrong with what is needed instead. A row is read as a record of its
class, which may have properties. Everything is checked before anything is used.
"""

import json
import math
from dataclasses import dataclass
from typing import Any, Dict, NamedTuple

from benchmark_json import LARGEST_COUNTER, UnusableFile, one_line, parse_json, printable_context, quoted, read_text
from document import replace_file

FORMAT = "isosyrk study 1"
CONVERGED, SWEEP_CAP, UNSTABLE = "converged", "sweep cap", "unstable"
STATUSES = (CONVERGED, "diverged", "stagnated", SWEEP_CAP, UNSTABLE)
CASIMIRS = (2, 3, 4, 5)
SOLVERS = PUBLISHED, FAST = ("published", "fast")
# Errors, norms and step sizes that are not 0 lie far inside; others are damage, and quotients of them overflow.
SMALLEST, LARGEST = 1e-30, LARGEST_COUNTER
LONGEST_TEXT = 60  # of a name


# ---- kinds


class Wrong(Exception):
    """A value is not of its kind; the message says what is needed."""


def kind_of(needed, allowed, made=lambda value: value):
    """Returns the kind of the values that are `allowed`, which are read as `made` says."""
    def read(value):
        if not allowed(value):
            raise Wrong(needed)
        return made(value)
    return read


def is_number(value):
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    try:
        return math.isfinite(float(value))
    except OverflowError:
        return False


# Errors, norms, counts and times are finite and never negative.
number = kind_of(f"a number from 0 to {LARGEST:g}", lambda value: is_number(value) and 0 <= value <= LARGEST, float)
positive = kind_of(f"a number from {SMALLEST:g} to {LARGEST:g}",
                   lambda value: is_number(value) and SMALLEST <= value <= LARGEST, float)
# None where the error was not finite or beyond LARGEST: a run that blew up leaves such.
error_of_any_size = kind_of("a number, 0 or more, or null",
                            lambda value: value is None or (is_number(value) and value >= 0),
                            lambda value: None if value is None or value > LARGEST else float(value))
truth = kind_of("true or false", lambda value: isinstance(value, bool))
text = kind_of("a short text", lambda value: (isinstance(value, str) and one_line(value) == value
                                              and 0 < len(value) <= LONGEST_TEXT))
an_object = kind_of("an object", lambda value: isinstance(value, dict))


def one_of(*allowed):
    return kind_of(f"one of {', '.join(allowed)}", lambda value: isinstance(value, str) and value in allowed)


def whole(least=0):
    return kind_of(f"a whole number from {least} on",
                   lambda value: isinstance(value, int) and not isinstance(value, bool) and least <= value < 10**15)


def optional(kind):
    return lambda value: None if value is None else kind(value)


def list_of(kind, length=None):
    def kind_of_list(value):
        if not isinstance(value, list) or length not in (None, len(value)):
            raise Wrong("a list" if length is None else f"a list of {length}")
        try:
            return tuple(map(kind, value))
        except Wrong as wrong:
            raise Wrong(f"a list, each of it {wrong},") from None
    return kind_of_list


status = one_of(*STATUSES)


# ---- records


def require(document, what, name, wanted):
    """Throws UnusableFile, saying that a document is no `what`, if a field of it is not `wanted`."""
    found = document.get(name) if isinstance(document, dict) else None
    if found != wanted:
        raise UnusableFile(f"is no {what} (its {name} is {quoted(found)}, not {quoted(wanted)})")


class Integrator(NamedTuple):
    """The properties of an integrator, as the module lists them; the same table in every study."""

    name: text
    stages: whole(1)
    order: whole(1)
    isospectral: truth
    lie_poisson: truth
    symmetric: truth
    explicit: truth
    stability_limit: optional(number)  # largest stable h‖ad_B‖₂; None if there is none

    def keeps(self, structure):
        """Tells whether it keeps "nothing" (always), the "spectrum", or the Lie–"poisson" structure."""
        return {"nothing": True, "spectrum": self.isospectral, "poisson": self.lie_poisson}[structure]


class Schema(NamedTuple):
    study: str
    settings: type
    tables: Dict[str, type]


@dataclass(frozen=True)
class Study:
    context: Dict[str, str]
    settings: Any
    tables: Dict[str, list]


def checked(values, kinds, what):
    """Returns the fields of an object that have `kinds`, a dict by name. Throws UnusableFile, naming it `what`."""
    found = {}
    for name, kind in kinds.items():
        if name not in values:
            raise UnusableFile(f"{what} has no {name}")
        try:
            found[name] = kind(values[name])
        except Wrong as wrong:
            raise UnusableFile(f"{what} has {name} {quoted(values[name])} where {wrong} is needed") from None
    return found


def keyed(records, *names):
    """Returns records by the value of one field, or by the tuple of several. Throws UnusableFile for two of one key."""
    found = {}
    for record in records:
        key = tuple(getattr(record, name) for name in names)
        if found.setdefault(key if len(key) > 1 else key[0], record) is not record:
            raise UnusableFile(f"has {', '.join(f'{name} {value}' for name, value in zip(names, key))} twice")
    return found


def object_of(what, **kinds):
    """The kind of an object that has fields of these kinds; another is refused, named `what`."""
    return lambda value: checked(an_object(value), kinds, what)


# ---- reading


def read(path, schema, make=lambda study: study):
    """Returns what `make` makes of the Study in `path`. Throws UnusableFile with one line that names the file."""
    return read_json(path, lambda document: make(study_of(document, schema)))


def read_json(path, make):
    """Returns what `make` makes of the JSON in `path`. Throws UnusableFile with one line that names the file."""
    try:
        return make(parse_json(read_text(path)))
    except UnusableFile as problem:
        raise UnusableFile(f"{one_line(path)}: {problem}") from None


def study_of(document, schema):
    """Returns the Study in a document of JSON. Throws UnusableFile."""
    what = f"raw file of the study {schema.study}"
    require(document, what, "format", FORMAT)
    require(document, what, "study", schema.study)
    parts = checked(document, dict.fromkeys(("context", "settings", "tables"), an_object), "it")
    return Study(printable_context(parts["context"]),
                 schema.settings(**checked(parts["settings"], schema.settings.__annotations__, "settings")),
                 {name: table(parts["tables"].get(name), record, name) for name, record in schema.tables.items()})


def table(found, record, name):
    """Returns the rows of a table, as records of their class."""
    kinds = record.__annotations__
    if not isinstance(found, dict) or not all(isinstance(found.get(part), list) for part in ("columns", "rows")):
        raise UnusableFile(f"has no table of {name}")
    columns, rows = found["columns"], found["rows"]
    if not all(isinstance(each, str) for each in columns) or sorted(columns) != sorted(kinds):
        raise UnusableFile(f"has a table of {name} with other columns than {', '.join(kinds)}")
    if not all(isinstance(row, list) and len(row) == len(columns) for row in rows):
        raise UnusableFile(f"has rows of {name} that are not as long as its columns")
    return [record(**checked(dict(zip(columns, row)), kinds, f"a row of {name}")) for row in rows]


# ---- writing


def write(path, schema, context, settings, tables):
    """Writes a raw file, one row a line, having read it back. `settings` and the rows of `tables` are records."""
    def block(record, rows):
        lines = ",\n".join(compact(row) for row in rows)
        return f'{{"columns":{compact(record._fields)},"rows":[\n{lines}\n]}}'

    blocks = ",\n".join(f"{compact(name)}:{block(record, tables[name])}" for name, record in schema.tables.items())
    whole_file = (f'{{"format":{compact(FORMAT)},"study":{compact(schema.study)},\n'
                  f'"context":{json.dumps(context, indent=1)},\n"settings":{compact(settings._asdict())},\n'
                  f'"tables":{{\n{blocks}\n}}}}\n')
    study_of(json.loads(whole_file), schema)
    replace_file(path, whole_file.encode("utf-8"))


def compact(value):
    return json.dumps(value, separators=(",", ":"), allow_nan=False)
