"""The formats of the files that the scripts read and write, each of them once, and checked before any of it is used.

So a table or chart is made from a sound file or not at all. What a value has to be is its *kind*: a function that
returns the value as it is used, or raises Wrong with what is needed instead. They are no JSON schemas:
python3-jsonschema takes 13 times as long to check the recorded raw files, which doubles or trebles the time of some
reports, and render_table1 and the gate, on the standard library, would keep kinds of their own.

The raw file of every study is

    {"format": "isosyrk study 1", "study": "accuracy", "context": {name: text}, "settings": {name: value},
     "tables": {name: {"columns": [...], "rows": [[...], ...]}}}

A study declares its settings and tables once, as a Schema of NamedTuple classes whose annotations are kinds. A row is
read as a record of its class, which may have properties. The table of integrators says what each of them is; where an
older file does not, LISTED does.
"""

import functools
import json
import operator
import os
from dataclasses import dataclass
from typing import Any, Dict, NamedTuple, Tuple

from lib.programs.messages import LONGEST_TEXT, UnusableFile, naming, one_line, quoted
from lib.programs.output import replace_file
from lib.programs.places import RECORDED

# Errors, norms, counts and step sizes that are not 0 lie far inside; others are damage, and quotients of them overflow.
SMALLEST, LARGEST = 1e-30, 1e18


class Wrong(Exception):
    """A value is not of its kind; the message says what is needed."""


# ---- reading


def read_json(path, make):
    """Returns what `make` makes of the JSON in `path`. Throws UnusableFile with one line that names the file."""
    with naming(path):
        return make(parse_json(read_text(path)))


def read_bytes(path):
    """Returns what is in a file, or says in one line why it cannot."""
    try:
        with open(path, "rb") as stream:
            return stream.read()
    except OSError as problem:
        raise UnusableFile(f"cannot be read: {problem.strerror}") from None


def read_text(path):
    """Returns the text of a file, or says in one line why there is none."""
    try:
        return read_bytes(path).decode("utf-8")
    except UnicodeDecodeError as problem:
        raise UnusableFile(f"is not UTF-8 text (byte {problem.start})") from None


def parse_json(text):
    """Parses JSON, bare NaN allowed: it stands in aggregate rows, and is refused where it would be used."""
    if not text.strip():
        raise UnusableFile("is empty")
    try:
        return json.loads(text)
    except json.JSONDecodeError as problem:
        raise UnusableFile(f"is not whole JSON (line {problem.lineno}: {problem.msg})") from None
    except (ValueError, RecursionError) as problem:
        raise UnusableFile(f"is not usable JSON ({one_line(problem)})") from None


# ---- kinds


def kind_of(needed, allowed, made=lambda value: value):
    """Returns the kind of the values that are `allowed`, which are read as `made` says."""
    def read(value):
        if not allowed(value):
            raise Wrong(needed)
        return made(value)
    return read


def is_number(value, minimum=0, maximum=LARGEST):
    """Tells whether a value is a number within bounds, which NaN is not."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and minimum <= value <= maximum


# Errors, norms, counts and times are finite and never negative.
number = kind_of(f"a number from 0 to {LARGEST:g}", is_number, float)
positive = kind_of(f"a number from {SMALLEST:g} to {LARGEST:g}", lambda value: is_number(value, SMALLEST), float)
finite = kind_of("a finite number", lambda value: is_number(value, -LARGEST))  # as it is, whole or not
anything = kind_of("anything", lambda value: True)
truth = kind_of("true or false", lambda value: isinstance(value, bool))
any_text = kind_of("a text", lambda value: isinstance(value, str))
text = kind_of("a short text", lambda value: (isinstance(value, str) and one_line(value) == value
                                              and 0 < len(value) <= LONGEST_TEXT))
an_object = kind_of("an object", lambda value: isinstance(value, dict))


def one_of(*allowed, renamed={}):
    """Returns the kind of some texts; the keys of `renamed` are what older files call some of them."""
    return kind_of(f"one of {', '.join(allowed)}",
                   lambda value: isinstance(value, str) and value in (*allowed, *renamed),
                   lambda value: renamed.get(value, value))


def whole(minimum=0):
    return kind_of(f"a whole number from {minimum} on",
                   lambda value: isinstance(value, int) and is_number(value, minimum, 10**15 - 1))


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


# ---- records


def require(document, what, name, wanted):
    """Throws UnusableFile, saying that a document is no `what`, if a field of it is not `wanted`."""
    found = document.get(name) if isinstance(document, dict) else None
    if found != wanted:
        raise UnusableFile(f"is no {what} (its {name} is {quoted(found)}, not {quoted(wanted)})")


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
    """Returns records by the value of one field, or by the tuple of several."""
    return {operator.attrgetter(*names)(record): record for record in records}


# ---- foreign text


def printable_context(context):
    """Returns the texts and numbers of a context as text, each in one line; the list of caches has no place in one."""
    return {key: one_line(value) for key, value in context.items() if isinstance(value, (str, int, float))}


# ---- the raw file of a study

STUDY_FORMAT = "isosyrk study 1"
CONVERGED, SWEEP_CAP, UNSTABLE = "converged", "sweep cap", "unstable"
STATUSES = (CONVERGED, "diverged", "stagnated", SWEEP_CAP, UNSTABLE)
# What a run may lose though its iterations converge, where that is told apart; elsewhere UNSTABLE.
LOSSES = NOT_FINITE, UNSTABLE_SPECTRUM, UNSTABLE_ENERGY = ("not finite", "spectrum lost", "energy lost")
CASIMIRS = (2, 3, 4, 5)
SOLVERS = PUBLISHED, FAST = ("published", "fast")
FORMULATIONS = ("cotangent", "group", "algebra")  # in the order of the paper's table
status = one_of(*STATUSES)


class Integrator(NamedTuple):
    """What an integrator is and keeps, as the module lists it; the same table in every study."""

    name: text
    stages: whole(1)
    order: whole(1)
    isospectral: truth
    lie_poisson: truth
    symmetric: truth
    explicit: truth
    stability_limit: optional(number)  # largest stable h‖ad_B‖₂; None if there is none
    has_fast_form: truth
    method: text  # name of the same method outside the co-rotating frame
    family: text  # of lib.integrators, or another
    formulation: optional(one_of(*FORMULATIONS))
    co_rotating: truth  # runs in the co-rotating frame
    projected: truth  # projects onto the spectrum
    spectrum_at_any_tolerance: truth  # keeps it to rounding; other isospectral methods to the tolerance

    @property
    def best_form(self):
        """Returns FAST where it has a fast form, else PUBLISHED."""
        return FAST if self.has_fast_form else PUBLISHED

    def keeps(self, structure):
        """Tells whether it keeps "nothing" (always), the "spectrum", or the Lie–"poisson" structure."""
        return {"nothing": True, "spectrum": self.isospectral, "poisson": self.lie_poisson}[structure]


INTEGRATORS = "integrators"  # the name of their table
LATER_FIELDS = Integrator._fields[Integrator._fields.index("has_fast_form"):]  # that older files do not have
# The list of integrators as of the recorded files, which scripts/update writes.
LISTED = os.path.join(RECORDED, "integrators.json")
LIST_FORMAT = "isosyrk integrators 1"


@functools.lru_cache(maxsize=None)
def listed_integrators():
    """Returns the Integrators of LISTED by name. Throws UnusableFile."""
    def integrators_of(document):
        require(document, "list of integrators", "format", LIST_FORMAT)
        return keyed(records(document, Integrator, INTEGRATORS), "name")

    return read_json(LISTED, integrators_of)


def listed(name):
    """Returns the Integrator of LISTED with a name. Throws UnusableFile."""
    if name not in listed_integrators():
        raise UnusableFile(f"does not say what {name} is, nor does {os.path.basename(LISTED)}")
    return listed_integrators()[name]


class Schema(NamedTuple):
    study: str
    settings: type  # what older files do not have has a default
    tables: Dict[str, type]
    later: Tuple[str, ...] = ()  # tables that older files do not have; they are read as empty, or of LISTED
    renamed: Dict[str, str] = {}  # names of tables and columns in older files, and what they are called now


@dataclass(frozen=True)
class Study:
    context: Dict[str, str]
    settings: Any
    tables: Dict[str, list]


# ---- reading a study


def read_study(path, schema, make=lambda study: study):
    """Returns what `make` makes of the Study in `path`. Throws UnusableFile with one line that names the file."""
    return read_json(path, lambda document: make(study_of(document, schema)))


def study_of(document, schema):
    """Returns the Study in a document of JSON. Throws UnusableFile."""
    what = f"raw file of the study {schema.study}"
    require(document, what, "format", STUDY_FORMAT)
    require(document, what, "study", schema.study)
    parts = checked(document, dict.fromkeys(("context", "settings", "tables"), an_object), "it")
    given = {schema.renamed.get(name, name): table for name, table in parts["tables"].items()}
    if len(given) < len(parts["tables"]):
        raise UnusableFile("has a table under its earlier name too")
    older = {name: None for name in schema.later if name not in given}
    found = checked(given, dict.fromkeys(schema.tables.keys() - older, an_object), "tables")
    tables = {name: records(found[name], record, name, schema.renamed) if name in found else []
              for name, record in schema.tables.items()}
    if INTEGRATORS in older:
        names = {row.integrator for rows in tables.values() for row in rows if hasattr(row, "integrator")}
        tables[INTEGRATORS] = list(map(listed, sorted(names, key=[*listed_integrators(), *names].index)))
    kinds = {name: kind for name, kind in schema.settings.__annotations__.items()
             if name in parts["settings"] or name not in schema.settings._field_defaults}
    return Study(printable_context(parts["context"]), schema.settings(**checked(parts["settings"], kinds, "settings")),
                 tables)


def records(found, record, name, renamed={}):
    """Returns the rows of a table, as records of their class. Throws UnusableFile, also for a row that stands twice.

    Columns may have the names that older files give them, the keys of `renamed`.
    """
    kinds, what, made = record.__annotations__, f"the table of {name}", record
    columns = [renamed.get(column, column) for column in checked(found, {"columns": list_of(text)}, what)["columns"]]
    if record is Integrator and not {*LATER_FIELDS} & {*columns}:
        kinds = {field: kind for field, kind in kinds.items() if field not in LATER_FIELDS}
        made = older_integrator
    if sorted(columns) != sorted(kinds):
        raise UnusableFile(f"{what} has other columns than {', '.join(kinds)}")
    rows = checked(found, {"rows": list_of(list_of(anything, len(columns)))}, what)["rows"]
    made_rows = [made(**checked(dict(zip(columns, row)), kinds, f"a row of {name}")) for row in rows]
    if len(set(made_rows)) < len(made_rows):
        raise UnusableFile(f"{what} has a row twice")
    return made_rows


def older_integrator(name, **fields):
    """Returns the Integrator of an older file, whose rows have not all fields."""
    return listed(name)._replace(**fields)


# ---- writing a study


def write_study(path, schema, context, settings, tables):
    """Writes a raw file, one row a line, having read it back. `settings` and the rows of `tables` are records.

    Tables of schema.later may be left out.
    """
    blocks = ",\n".join(f"{compact(name)}:{{{columns_and_rows(record, tables[name])}}}"
                        for name, record in schema.tables.items() if name in tables)
    whole_file = (f'{{"format":{compact(STUDY_FORMAT)},"study":{compact(schema.study)},\n'
                  f'"context":{json.dumps(context, indent=1)},\n"settings":{compact(settings._asdict())},\n'
                  f'"tables":{{\n{blocks}\n}}}}\n')
    study_of(json.loads(whole_file), schema)
    replace_file(path, whole_file.encode("utf-8"))


def columns_and_rows(record, rows):
    """Returns the text of a table in a file, a row a line."""
    lines = ",\n".join(compact(row) for row in rows)
    return f'"columns":{compact(record._fields)},"rows":[\n{lines}\n]'


def list_text(integrators):
    """Returns the text of LISTED that holds some Integrators."""
    return f'{{"format":{compact(LIST_FORMAT)},{columns_and_rows(Integrator, integrators)}}}\n'


def to_digits(value, digits):
    """Returns a number with so many significant digits: what raw files hold of what was measured."""
    return float(f"{value:.{digits}g}")


def compact(value):
    return json.dumps(value, separators=(",", ":"), allow_nan=False)
