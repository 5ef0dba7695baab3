"""The history of a benchmark: a file with one line of JSON for each run, which only grows.

    {"format": "isosyrk history 1", "program": "table1", "date": "2026-11-28T20:00:00+00:00", "commit": "0123456789ab",
     "dirty": "no", "cpu": "AMD EPYC, cpu family 25, model 1, stepping 1",
     "kernels": "OpenBLAS Zen, split products avx2",
     "ratios": [{"what": "algebra over group, s = 3, n = 129", "ratio": 2.1, "low": 2.0, "high": 2.2}, ...]}

Ratios compare times of one run with each other. Nothing is said of times on two processors. Standard library only.
"""

import fcntl
import os
from datetime import datetime, timezone
from typing import List, NamedTuple, Optional

from lib.programs.command_line import Stop
from lib.programs.messages import UnusableFile, naming, one_line
from lib.records.formats import (an_object, any_text, checked, compact, list_of, number, one_of, optional, parse_json,
                                 read_text, require, text, to_digits)

FORMAT = "isosyrk history 1"
DIRTY = YES, NO, UNKNOWN = ("yes", "no", "unknown")  # of a checkout
PROGRAMS = TABLE1, GATE = ("table1", "check_regression")
DIGITS = 6


class Entry(NamedTuple):
    """A ratio of times that were measured interleaved, with its 95 % interval where there are processes enough."""

    what: any_text
    ratio: number
    low: optional(number)
    high: optional(number)


class Line(NamedTuple):
    """A run."""

    program: one_of(*PROGRAMS)
    date: text  # ISO 8601, UTC
    commit: text
    dirty: one_of(*DIRTY)
    cpu: any_text
    kernels: any_text
    ratios: List[Entry]

    @property
    def machine(self):
        """What runs are compared within: the processor and the kernels that ran."""
        return f"{self.cpu}; {self.kernels}"


def line_of(program, context, kernels, ratios):
    """Returns the Line of a run that ends now, by the context of its raw file. `ratios` are (what, Ratio)."""
    def end(value):
        return to_digits(value, DIGITS) if 0 < value < float("inf") else None

    dirty = context.get("dirty")
    return Line(program, datetime.now(timezone.utc).isoformat(timespec="seconds"), context.get("commit") or UNKNOWN,
                dirty if dirty in DIRTY else UNKNOWN, context.get("cpu", UNKNOWN), kernels,
                [Entry(what, to_digits(each.ratio, DIGITS), end(each.low), end(each.high)) for what, each in ratios])


# ---- reading


def read_history(path):
    """Returns the Lines of a file, none of an empty one. Throws UnusableFile, naming the file and the line."""
    with naming(path):
        lines = read_text(path).split("\n")
    if lines.pop():
        raise UnusableFile(f"{one_line(path)}: line {len(lines) + 1} has no end; a run was interrupted while it wrote")
    found = []
    for place, line in enumerate(lines, 1):
        try:
            found.append(line_from(parse_json(line)))
        except UnusableFile as problem:
            raise UnusableFile(f"{one_line(path)}: line {place} {problem}") from None
    return found


def line_from(document):
    require(document, "line of a history", "format", FORMAT)
    kinds = {**Line.__annotations__, "ratios": list_of(an_object)}
    fields = checked(document, kinds, "it")
    return Line(**{**fields, "ratios": [Entry(**checked(each, Entry.__annotations__, "a ratio"))
                                        for each in fields["ratios"]]})


# ---- appending


def require_history(path: Optional[str]):
    """Throws Stop unless a Line can be appended to a file, which is not made yet. Before any work."""
    if path is None:
        return
    if os.path.exists(path):
        read_history(path)
        is_writable = os.path.isfile(path) and os.access(path, os.W_OK)
    else:
        folder = os.path.dirname(os.path.abspath(path))
        is_writable = os.path.isdir(folder) and os.access(folder, os.W_OK)
    if not is_writable:
        raise Stop(f"--history {one_line(path)}: cannot be written")


def append(path, line):
    """Appends a Line by one write, under the lock of the file. Throws UnusableFile for a file that is none of ours."""
    data = (compact({"format": FORMAT, **line._asdict(), "ratios": [each._asdict() for each in line.ratios]})
            + "\n").encode("utf-8")
    descriptor = os.open(path, os.O_RDWR | os.O_APPEND | os.O_CREAT, 0o644)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        read_history(path)
        length = os.fstat(descriptor).st_size
        try:
            if os.write(descriptor, data) != len(data):
                raise OSError(28, "No space left on device")
        except OSError as problem:
            os.ftruncate(descriptor, length)  # whole lines or none
            problem.filename = path
            raise
    finally:
        os.close(descriptor)
