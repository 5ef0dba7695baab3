"""The raw file of a study: one format, one reader and one writer for all studies.

    {"format": "isosyrk study 1", "study": "accuracy", "context": {name: text}, "settings": {name: value},
     "tables": {name: {"columns": [...], "rows": [[...], ...]}}}

A study declares its settings and tables once, as a Schema of NamedTuple classes whose annotations are the kinds of
checked_json. A row is read as a record of its class, which may have properties.
"""

import json
from dataclasses import dataclass
from typing import Any, Dict, NamedTuple

from lib.checked_json import (UnusableFile, an_object, anything, checked, list_of, number, one_of, optional,
                          printable_context, quoted, read_json, require, text, truth, whole)
from lib.output import replace_file

FORMAT = "isosyrk study 1"
CONVERGED, SWEEP_CAP, UNSTABLE = "converged", "sweep cap", "unstable"
STATUSES = (CONVERGED, "diverged", "stagnated", SWEEP_CAP, UNSTABLE)
CASIMIRS = (2, 3, 4, 5)
SOLVERS = PUBLISHED, FAST = ("published", "fast")
status = one_of(*STATUSES)


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


# ---- reading


def read(path, schema, make=lambda study: study):
    """Returns what `make` makes of the Study in `path`. Throws UnusableFile with one line that names the file."""
    return read_json(path, lambda document: make(study_of(document, schema)))


def study_of(document, schema):
    """Returns the Study in a document of JSON. Throws UnusableFile."""
    what = f"raw file of the study {schema.study}"
    require(document, what, "format", FORMAT)
    require(document, what, "study", schema.study)
    parts = checked(document, dict.fromkeys(("context", "settings", "tables"), an_object), "it")
    found = checked(parts["tables"], dict.fromkeys(schema.tables, an_object), "tables")
    tables = {name: table(found[name], record, name) for name, record in schema.tables.items()}
    listed = {each.name for each in tables.get("integrators", ())}
    for name, rows in tables.items() if listed else ():
        for row in rows:
            if getattr(row, "integrator", None) not in (None, *listed):
                raise UnusableFile(f"has {name} of an integrator it does not list, {quoted(row.integrator)}")
    return Study(printable_context(parts["context"]),
                 schema.settings(**checked(parts["settings"], schema.settings.__annotations__, "settings")), tables)


def table(found, record, name):
    """Returns the rows of a table, as records of their class."""
    kinds, what = record.__annotations__, f"the table of {name}"
    columns = checked(found, {"columns": list_of(text)}, what)["columns"]
    if sorted(columns) != sorted(kinds):
        raise UnusableFile(f"{what} has other columns than {', '.join(kinds)}")
    rows = checked(found, {"rows": list_of(list_of(anything, len(columns)))}, what)["rows"]
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
