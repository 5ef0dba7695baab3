"""Reads the JSON that a Google Benchmark 1.7.1 program of this project wrote.

What the format leaves to trap a reader:

- `name` and `run_name` grow suffixes such as `/min_time:0.5/repeats:7`; only the leading part is ours.
- Rows of run_type "aggregate" repeat what the "iteration" rows say, and their coefficient of variation is a
  bare NaN (not JSON) wherever a counter is exactly 0. They are skipped, not rejected.
- A row that failed has no counters and a time of 0.
"""

import re
import statistics
from dataclasses import dataclass, field
from typing import Dict, NamedTuple, Optional, Tuple

from lib.checked_json import (UnusableFile, an_object, any_text, checked, list_of, number, one_line, one_of, positive,
                          printable_context, quoted, read_json, require, shortened, truth, whole)

FORMAT = "1"
FORMULATIONS = ("cotangent", "group", "algebra")  # in the order of the paper's table
SECONDS_PER_UNIT = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


class CellKey(NamedTuple):
    """Names one cell of a table."""

    formulation: str
    n: int
    stages: int


@dataclass(frozen=True)
class Measurement:
    """One cell: CPU seconds of each repetition and the median of each counter, or why it failed."""

    times: Tuple[float, ...] = ()
    counters: Dict[str, float] = field(default_factory=dict)
    failure: Optional[str] = None


class Run(NamedTuple):
    """One raw file: the measurement conditions as text, and the cells."""

    context: Dict[str, str]
    measurements: Dict[CellKey, Measurement]

    def cell(self, formulation, n, stages):
        """Returns a Measurement, or None."""
        return self.measurements.get(CellKey(formulation, n, stages))

    def times(self, n, stages):
        """Returns the repetitions of the rows of a block that finished, by formulation."""
        cells = {name: self.cell(name, n, stages) for name in FORMULATIONS}
        return {name: cell.times for name, cell in cells.items() if cell and not cell.failure}

    def failures(self):
        """Returns the failed cells in the order of the table; a cell's place here is its footnote number."""
        return sorted((key for key, cell in self.measurements.items() if cell.failure),
                      key=lambda key: (key.n, FORMULATIONS.index(key.formulation), key.stages))


def read_run(path, program, counters, optional=(), table=None):
    """Returns the Run in `path`, written by `program`, whose every good row must have all `counters`.

    A cell has an optional counter if each of its repetitions has it. `table` is what the rows are named by, where that
    is not the program. Rows timed by several threads, named .../threads:2, are passed over.
    """
    def run_of(document):
        context = document.get("context") if isinstance(document, dict) else None
        for name, wanted in (("isosyrk_program", program), ("isosyrk_format", FORMAT)):
            require(context, f"raw file of {program}", name, wanted)
        rows = checked(document, {"benchmarks": list_of(an_object)}, "it")["benchmarks"]
        return Run(printable_context(context), {key: measurement(cell, counters, optional) for key, cell
                                                in rows_by_cell(rows, table or program).items()})

    return read_json(path, run_of)


def rows_by_cell(rows, table):
    """Returns the repetitions of each cell, in the order of their index, by which a doubled one is noticed."""
    cells = {}
    for row in rows:
        key = cell_key(row, table)
        if key is None:
            continue
        index = checked(row, {"repetition_index": whole()}, row_name(row))["repetition_index"]
        if index in cells.setdefault(key, {}):
            raise UnusableFile(f"{row_name(row)}: repetition {index} stands twice")
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
    return Measurement(tuple(SECONDS_PER_UNIT[row["time_unit"]] * row["cpu_time"] for row in found),
                       {name: statistics.median(row[name] for row in found) for name in names})


def failure(row):
    """Returns why a row failed, or None."""
    found = checked({"error_occurred": False, "error_message": "", **row},
                    {"error_occurred": truth, "error_message": any_text}, row_name(row))
    return (one_line(found["error_message"]) or "no reason recorded") if found["error_occurred"] else None


def row_name(row):
    return f"row {shortened(row['run_name'])}"
