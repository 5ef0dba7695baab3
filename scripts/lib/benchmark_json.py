"""Reads the JSON that a Google Benchmark 1.7.1 program of this project wrote.

Everything is checked before anything is used, so that a table or chart is either made from a sound file or
not at all. What the format leaves to trap a reader:

- `name` and `run_name` grow suffixes such as `/min_time:0.5/repeats:7`; only the leading part is ours.
- Rows of run_type "aggregate" repeat what the "iteration" rows say, and their coefficient of variation is a
  bare NaN (not JSON) wherever a counter is exactly 0. They are skipped, not rejected.
- A row that failed has no counters and a time of 0.
"""

import json
import re
import statistics
import unicodedata
from dataclasses import dataclass, field
from typing import Dict, NamedTuple, Optional, Tuple

FORMAT = "1"
FORMULATIONS = ("cotangent", "group", "algebra")  # in the order of the paper's table
RUN_TYPES = ("iteration", "aggregate")
SECONDS_PER_UNIT = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
# No run takes less than a nanosecond or more than thirty years; such a time is damage, not a measurement.
SHORTEST_SECONDS, LONGEST_SECONDS = 1e-9, 1e9
# Counts, shares, norms and errors of a run that converged are far below this.
LARGEST_COUNTER = 1e18


class UnusableFile(Exception):
    """A file that cannot be used; the message is one line naming the file and what is wrong."""


class CellKey(NamedTuple):
    """Names one cell of a table."""

    formulation: str
    n: int
    stages: int


@dataclass(frozen=True)
class Measurement:
    """One cell: CPU seconds and counters of each repetition, in the same order, or why it failed."""

    times: Tuple[float, ...] = ()
    repeated: Dict[str, Tuple[float, ...]] = field(default_factory=dict)
    failure: Optional[str] = None

    @property
    def counters(self):
        """The median of each counter."""
        return {name: statistics.median(values) for name, values in self.repeated.items()}


@dataclass(frozen=True)
class Run:
    """One raw file: the measurement conditions as text, and the cells."""

    context: Dict[str, str]
    measurements: Dict[CellKey, Measurement]


def read_run(path, program, counters, optional=(), table=None, threads=1, time="cpu_time"):
    """Returns the Run in `path`, written by `program`, whose every good row must have all `counters`.

    A cell has an optional counter if each of its repetitions has it. `table` is what the rows are named by, where that
    is not the program. Of rows timed by several threads, named .../threads:2, only those of `threads` are read; for
    their comparison `time` is "real_time".
    """
    try:
        document = parse_json(read_text(path))
        context, rows = context_and_rows(document, program)
        return Run(context, measurements(rows, table or program, threads, counters, optional, time))
    except UnusableFile as problem:
        raise UnusableFile(f"{one_line(path)}: {problem}") from None


def read_text(path):
    """Returns the text of a file, or says in one line why there is none."""
    try:
        with open(path, "rb") as stream:
            return stream.read().decode("utf-8")
    except OSError as problem:
        raise UnusableFile(f"cannot be read: {problem.strerror}") from None
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


def context_and_rows(document, program):
    """Returns the context as text and the list of rows, having checked that `program` wrote the file."""
    if not isinstance(document, dict):
        raise UnusableFile("is not a Google Benchmark file (no JSON object at the top)")
    context, rows = document.get("context"), document.get("benchmarks")
    if not isinstance(context, dict) or not isinstance(rows, list):
        raise UnusableFile("is not a Google Benchmark file (no context, or no list of benchmarks)")
    require_field(context, "isosyrk_program", program)
    require_field(context, "isosyrk_format", FORMAT)
    return printable_context(context), rows


def require_field(context, field, expected):
    """Refuses a file of another program, or of a later format whose meaning this reader cannot know."""
    found = context.get(field)
    if found is None:
        raise UnusableFile(f"was not written by {expected if field == 'isosyrk_program' else 'this project'}"
                           f" (its context has no {field})")
    if found != expected:
        raise UnusableFile(f"has {field} {quoted(found)} where {quoted(expected)} is needed")


def printable_context(context):
    """Returns the texts and numbers of a context as text, each in one line; the list of caches has no place in one."""
    return {key: one_line(value) for key, value in context.items() if isinstance(value, (str, int, float))}


def measurements(rows, table, threads, counters, optional, time):
    """Gathers the repetitions of each cell, by their index so that a doubled one is noticed."""
    cells = {}
    for row in rows:
        key = cell_key(row, table, threads)
        if key is None:
            continue
        index = number(row, "repetition_index")
        if index in cells.setdefault(key, {}):
            raise UnusableFile(f"{row_name(row)}: repetition {index:g} stands twice")
        cells[key][index] = row
    if not cells:
        raise UnusableFile(f"has no measured row named {table}/… (run_type \"iteration\")")
    return {key: measurement([cell[index] for index in sorted(cell)], counters, optional, time)
            for key, cell in cells.items()}


def cell_key(row, program, threads=1):
    """Returns the cell a row belongs to, or None for an aggregate, a row of something else or of other threads."""
    if not isinstance(row, dict):
        raise UnusableFile(f"has a benchmark row that is no object but {quoted(row)}")
    run_type, run_name = row.get("run_type"), row.get("run_name")
    if run_type not in RUN_TYPES or not isinstance(run_name, str):
        raise UnusableFile(f"has a row whose run_name is {quoted(run_name)} and run_type {quoted(run_type)}")
    if run_type == "aggregate" or not run_name.startswith(program + "/"):
        return None
    match = re.match(r"([a-z0-9_]+)/n:([0-9]{1,6})/s:([0-9]{1,3})(?:/threads:([0-9]{1,3}))?(?=/|$)",
                     run_name[len(program) + 1:])
    if not match:
        raise UnusableFile(f"has a row named {quoted(run_name)}, not {program}/<formulation>/n:…/s:…")
    return CellKey(match[1], int(match[2]), int(match[3])) if int(match[4] or 1) == threads else None


def measurement(rows, counters, optional, time):
    """Joins the repetitions of a cell; one that failed fails the cell, for its time would be a biased choice."""
    failures = [why for why in map(failure, rows) if why]
    if failures:
        some = f" ({len(failures)} of {len(rows)} repetitions)" if len(failures) < len(rows) else ""
        return Measurement(failure=failures[0] + some)
    names = [*counters, *(name for name in optional if all(name in row for row in rows))]
    return Measurement(tuple(seconds(row, time) for row in rows),
                       {name: tuple(number(row, name) for row in rows) for name in names})


def failure(row):
    """Returns why a row failed, or None."""
    failed, message = row.get("error_occurred", False), row.get("error_message", "")
    if not isinstance(failed, bool) or not isinstance(message, str):
        raise UnusableFile(f"{row_name(row)}: error_occurred is {quoted(failed)}, error_message {quoted(message)}")
    return (one_line(message) or "no reason recorded") if failed else None


def seconds(row, field):
    """Returns the CPU time of a row in seconds, or the time that passed."""
    unit = row.get("time_unit")
    if not isinstance(unit, str) or unit not in SECONDS_PER_UNIT:
        raise UnusableFile(f"{row_name(row)}: time_unit {quoted(unit)} is none of {', '.join(SECONDS_PER_UNIT)}")
    factor = SECONDS_PER_UNIT[unit]
    return factor * number(row, field, SHORTEST_SECONDS / factor, LONGEST_SECONDS / factor)


def number(row, field, least=0.0, most=LARGEST_COUNTER):
    """Returns a field that is a count, share, norm, error or time, none of which is negative."""
    if field not in row:
        raise UnusableFile(f"{row_name(row)}: has no {field}")
    value = row[field]
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not least <= value <= most:  # nor NaN
        raise UnusableFile(f"{row_name(row)}: {field} is {quoted(value)}, not a number in {least:g} … {most:g}")
    return float(value)


def row_name(row):
    return f"row {shortened(one_line(row['run_name']))}"


def quoted(value):
    """Shows a foreign value in a message, cut so that the message stays one short line."""
    if isinstance(value, (list, dict)):
        return "a JSON list" if isinstance(value, list) else "a JSON object"
    return shortened(one_line(json.dumps(value, ensure_ascii=False)))


def shortened(text):
    return text if len(text) <= 60 else text[:57] + "..."


def one_line(value):
    """Makes foreign text safe to print: no line breaks, control codes or lone surrogates."""
    visible = ("\ufffd" if "\ud800" <= c <= "\udfff" else " " if unicodedata.category(c)[0] == "C" else c
               for c in str(value))
    return " ".join("".join(visible).split())
