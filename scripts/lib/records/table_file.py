"""The raw file of table1 and table2: cells with their times by process.

It is the JSON of Google Benchmark 1.7.1, which leaves to trap a reader:

- `name` and `run_name` grow suffixes such as `/min_time:0.5/repeats:7`; only the leading part is ours.
- Rows of run_type "aggregate" repeat what the "iteration" rows say, and their coefficient of variation is a
  bare NaN (not JSON) wherever a counter is exactly 0. They are skipped, not rejected.
- A row that failed has no counters and a time of 0.
"""

import re
import statistics
from dataclasses import dataclass, field
from typing import Dict, NamedTuple, Optional

from lib.programs.messages import UnusableFile, one_line, quoted, shortened
from lib.records.formats import (FORMULATIONS, an_object, any_text, checked, list_of, number, one_of, positive,
                                 printable_context, read_json, require, truth, whole)

BENCHMARK_FORMAT = "1"
SECONDS_PER_UNIT = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


class CellKey(NamedTuple):
    """Names one cell of a table."""

    formulation: str
    n: int
    stages: int


@dataclass(frozen=True)
class Measurement:
    """One cell: CPU seconds by process, in each the least of its repetitions, and counters, or why it failed."""

    times: Dict[int, float] = field(default_factory=dict)
    counters: Dict[str, float] = field(default_factory=dict)
    failure: Optional[str] = None

    @property
    def seconds(self):
        """Returns the geometric mean over the processes."""
        return statistics.geometric_mean(self.times.values())


class Run(NamedTuple):
    """One raw file: the measurement conditions as text, and the cells."""

    context: Dict[str, str]
    measurements: Dict[CellKey, Measurement]

    def cell(self, formulation, n, stages):
        """Returns a Measurement, or None."""
        return self.measurements.get(CellKey(formulation, n, stages))

    def times(self, n, stages):
        """Returns the times of the rows of a block that finished, by formulation: lists over the same processes."""
        cells = {name: self.cell(name, n, stages) for name in FORMULATIONS}
        times = {name: cell.times for name, cell in cells.items() if cell and not cell.failure}
        common = sorted(set.intersection(*map(set, times.values()))) if times else []
        return {name: [found[process] for process in common] for name, found in times.items() if common}

    def failures(self):
        """Returns the failed cells in the order of the table; a cell's place here is its footnote number."""
        return sorted((key for key, cell in self.measurements.items() if cell.failure),
                      key=lambda key: (key.n, FORMULATIONS.index(key.formulation), key.stages))


def read_run(path, programs, counters, optional, table):
    """Returns the Run of a table in the raw file at `path`, whose every good row must have all `counters`.

    `programs` are those that write such rows, named by `table`. A cell has an optional counter if each of its
    repetitions has it. Rows timed by several threads, named .../threads:2, are passed over.
    """
    return read_json(path, lambda document: run_of(document, programs, counters, optional, table))


def run_of(document, programs, counters, optional, table):
    """Returns the Run in a document of JSON, as read_run does. Throws UnusableFile."""
    context = document.get("context") if isinstance(document, dict) else None
    what = f"raw file of {' or '.join(programs)}"
    if not isinstance(context, dict) or context.get("isosyrk_program") not in programs:
        require(context, what, "isosyrk_program", programs[0])
    require(context, what, "isosyrk_format", BENCHMARK_FORMAT)
    rows = checked(document, {"benchmarks": list_of(an_object)}, "it")["benchmarks"]
    return Run(printable_context(context), {key: measurement(cell, counters, optional) for key, cell
                                            in rows_by_cell(rows, table).items()})


def rows_by_cell(rows, table):
    """Returns the rows of each cell, in the order of process and repetition, by which a doubled one is noticed.

    What the program itself wrote has no processes: it is one, number 0.
    """
    cells = {}
    for row in rows:
        key = cell_key(row, table)
        if key is None:
            continue
        found = checked({"process": 0, **row}, {"process": whole(), "repetition_index": whole()}, row_name(row))
        index = found["process"], found["repetition_index"]
        if index in cells.setdefault(key, {}):
            raise UnusableFile(f"{row_name(row)}: repetition {index[1]} of process {index[0]} stands twice")
        cells[key][index] = row
    if not cells:
        raise UnusableFile(f"has no measured row named {table}/… (run_type \"iteration\")")
    return {key: [cell[index] for index in sorted(cell)] for key, cell in cells.items()}


def cell_key(row, table):
    """Returns the cell a row belongs to, or None for an aggregate, a row of something else or of several threads."""
    named = checked(row, {"run_name": any_text, "run_type": one_of("iteration", "aggregate")}, "a row")
    if named["run_type"] == "aggregate" or not named["run_name"].startswith(table + "/"):
        return None
    match = re.match(r"([a-z0-9_]+)/n:([0-9]{1,6})/s:([0-9]{1,3})(/threads:[0-9]{1,3})?(?=/|$)",
                     named["run_name"][len(table) + 1:])
    if not match:
        raise UnusableFile(f"has a row named {quoted(named['run_name'])}, not {table}/<formulation>/n:…/s:…")
    return None if match[4] else CellKey(match[1], int(match[2]), int(match[3]))


def measurement(rows, counters, optional):
    """Joins the repetitions of a cell; one that failed fails the cell, for its time would be a biased choice."""
    failures = [why for why in map(failure, rows) if why]
    if failures:
        some = f" ({len(failures)} of {len(rows)} repetitions)" if len(failures) < len(rows) else ""
        return Measurement(failure=failures[0] + some)
    names = [*counters, *(name for name in optional if all(name in row for row in rows))]
    kinds = {"time_unit": one_of(*SECONDS_PER_UNIT), "cpu_time": positive, **dict.fromkeys(names, number)}
    found = [checked(row, kinds, row_name(row)) for row in rows]
    times = {}
    for row, values in zip(rows, found):
        times.setdefault(row.get("process", 0), []).append(SECONDS_PER_UNIT[values["time_unit"]] * values["cpu_time"])
    return Measurement({process: min(seconds) for process, seconds in times.items()},
                       {name: statistics.median(row[name] for row in found) for name in names})


def failure(row):
    """Returns why a row failed, or None."""
    found = checked({"error_occurred": False, "error_message": "", **row},
                    {"error_occurred": truth, "error_message": any_text}, row_name(row))
    return (one_line(found["error_message"]) or "no reason recorded") if found["error_occurred"] else None


def row_name(row):
    return f"row {shortened(row['run_name'])}"
