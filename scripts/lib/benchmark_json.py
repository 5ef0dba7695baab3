"""Reads the JSON that a Google Benchmark 1.7.1 program of this project wrote.

Everything is checked before anything is used, so that a table or chart is either made from a sound file or
not at all. What the format leaves to trap a reader:

- `name` and `run_name` grow suffixes such as `/min_time:0.5/repeats:7`; only the leading part is ours.
- Rows of run_type "aggregate" repeat what the "iteration" rows say, and their coefficient of variation is a
  bare NaN (not JSON) wherever a counter is exactly 0. They are skipped, not rejected.
- A row that failed has no counters and a time of 0.
"""

import json
import math
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
        table = table or program
        rows = [row for row in rows if threads_of(row) == threads]
        return Run(context, measurements(rows, table, counters, optional, time))
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
    """Returns the context fields that can be shown in a line, as text."""
    texts = {key: context_text(value) for key, value in context.items()}
    return {key: text for key, text in texts.items() if text is not None}


def context_text(value):
    """Returns one context value as text, or None for what has no place in one line (the list of caches)."""
    if isinstance(value, str):
        return one_line(value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (int, float)):
        return f"{value:.3g}" if isinstance(value, float) else str(value)
    if isinstance(value, list) and not any(isinstance(item, (list, dict)) for item in value):
        return ", ".join(str(context_text(item)) for item in value)
    return None


def threads_of(row):
    """Returns how many threads a row's name says, 1 where it says none."""
    name = row.get("run_name") if isinstance(row, dict) else None
    match = re.search(r"/threads:([0-9]{1,3})(?=/|$)", name) if isinstance(name, str) else None
    return int(match[1]) if match else 1


def measurements(rows, program, counters, optional, time):
    """Gathers the repetitions of each cell."""
    repetitions = {}
    for row in rows:
        key = cell_key(row, program)
        if key is not None:
            present = (*counters, *(name for name in optional if name in row))
            add_repetition(repetitions.setdefault(key, {}), row, present, time)
    if not repetitions:
        raise UnusableFile(f"has no measured row named {program}/… (run_type \"iteration\")")
    return {key: measurement(cell) for key, cell in repetitions.items()}


def cell_key(row, program):
    """Returns the cell a row belongs to, or None for an aggregate or a row of something else."""
    if not isinstance(row, dict):
        raise UnusableFile(f"has a benchmark row that is no object but {quoted(row)}")
    run_type, run_name = row.get("run_type"), row.get("run_name")
    if run_type not in RUN_TYPES or not isinstance(run_name, str):
        raise UnusableFile(f"has a row whose run_name is {quoted(run_name)} and run_type {quoted(run_type)}")
    if run_type == "aggregate" or not run_name.startswith(program + "/"):
        return None
    match = re.match(r"([a-z0-9_]+)/n:([0-9]{1,6})/s:([0-9]{1,3})(?=/|$)", run_name[len(program) + 1:])
    if not match:
        raise UnusableFile(f"has a row named {quoted(run_name)}, not {program}/<formulation>/n:…/s:…")
    return CellKey(match[1], int(match[2]), int(match[3]))


def add_repetition(cell, row, counters, time):
    """Adds one row to the repetitions of its cell, keyed by repetition so that a doubled one is noticed."""
    index = number(row, "repetition_index")
    if index in cell:
        raise UnusableFile(f"{row_name(row)}: repetition {index:g} stands twice")
    failed = row.get("error_occurred", False)
    if not isinstance(failed, bool):
        raise UnusableFile(f"{row_name(row)}: error_occurred is neither true nor false")
    if failed:
        cell[index] = Measurement(failure=error_message(row))
    else:
        cell[index] = Measurement((seconds(row, time),), {name: (number(row, name),) for name in counters})


def error_message(row):
    message = row.get("error_message", "")
    if not isinstance(message, str):
        raise UnusableFile(f"{row_name(row)}: error_message is {quoted(message)}, not a text")
    return one_line(message) or "no reason recorded"


def measurement(cell):
    """Joins the repetitions of a cell; one that failed fails the cell, for its time would be a biased choice."""
    repetitions = [cell[index] for index in sorted(cell)]
    failures = [each.failure for each in repetitions if each.failure]
    if failures:
        some = f" ({len(failures)} of {len(repetitions)} repetitions)" if len(failures) < len(repetitions) else ""
        return Measurement(failure=failures[0] + some)
    names = [name for name in repetitions[0].repeated if all(name in each.repeated for each in repetitions)]
    return Measurement(tuple(each.times[0] for each in repetitions),
                       {name: tuple(each.repeated[name][0] for each in repetitions) for name in names})


def seconds(row, field):
    """Returns the CPU time of a row in seconds, or the time that passed."""
    unit = row.get("time_unit")
    if not isinstance(unit, str) or unit not in SECONDS_PER_UNIT:
        raise UnusableFile(f"{row_name(row)}: time_unit {quoted(unit)} is none of {', '.join(SECONDS_PER_UNIT)}")
    time = finite(row, field) * SECONDS_PER_UNIT[unit]
    if not SHORTEST_SECONDS <= time <= LONGEST_SECONDS:
        raise UnusableFile(f"{row_name(row)}: {field} {quoted(row[field])} {unit} is no possible time")
    return time


def number(row, field):
    """Returns a field that is a count, share, norm or error, none of which is negative."""
    value = finite(row, field)
    if not 0 <= value <= LARGEST_COUNTER:
        raise UnusableFile(f"{row_name(row)}: {field} is {quoted(row[field])}, not in 0 … {LARGEST_COUNTER:g}")
    return value


def finite(row, field):
    """Returns a field that must be a finite number."""
    if field not in row:
        raise UnusableFile(f"{row_name(row)}: has no {field}")
    value = row[field]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise UnusableFile(f"{row_name(row)}: {field} is {quoted(value)}, not a number")
    try:
        value = float(value)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise UnusableFile(f"{row_name(row)}: {field} is {value}, not a finite number")
    return value


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
