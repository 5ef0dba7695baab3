"""The timing layer of the regression gate: two builds on one machine, turn and turn about, in CPU time.

A machine that others share drifts by tens of per cent within seconds, and a process keeps for its life whatever its
place in memory gives or costs it. So both builds run at the same time as servers that are asked for one short block at
a time, in the order base, head, head, base or the reverse, and both are started anew several times. A pair is the two
blocks of the one over the two of the other; a cell is judged by the median of its pairs and their lower quartile.
"""

import contextlib
import math
import os
import shutil
import statistics
import subprocess
import time
from dataclasses import dataclass
from typing import Optional

from benchmark_json import one_line
from gate_cells import FAST, CannotRun, cell_name, is_fast
from gate_layers import Layer

MEDIAN_LIMIT, QUARTILE_LIMIT = 1.03, 1.01


@dataclass(frozen=True)
class Plan:
    """What is timed, and how often."""

    cells: tuple
    launches: int
    pairs: int  # of each cell, a launch
    block_seconds: float


STEPS = {17: 50, 33: 20, 65: 5, 129: 1}  # of a published form's run, by n
FAST_STEPS = 50  # of a fast one's: it starts cold, and costs less as soon as it can predict
QUICK = Plan(tuple(cell_name(*cell) for cell in (
    ("cotangent", 17, 2), ("group", 17, 2), ("algebra", 17, 2),
    ("cotangent", 33, 3), ("group", 33, 3), ("algebra", 33, 1),
    (FAST + "cotangent", 17, 2), (FAST + "group", 17, 2), (FAST + "algebra", 17, 2),
    (FAST + "cotangent", 33, 3), (FAST + "group", 33, 3), (FAST + "algebra", 33, 1))),
    launches=6, pairs=3, block_seconds=0.02)
FULL = Plan(QUICK.cells + tuple(cell_name(*cell) for cell in (
    ("group", 65, 2), ("algebra", 65, 1), ("algebra", 65, 3),
    ("cotangent", 129, 3), ("group", 129, 1), ("algebra", 129, 2),
    (FAST + "cotangent", 65, 2), (FAST + "group", 65, 3), (FAST + "algebra", 65, 2),
    (FAST + "cotangent", 129, 1), (FAST + "group", 129, 2), (FAST + "algebra", 129, 1))),
    launches=6, pairs=3, block_seconds=0.02)


def steps_of(cell):
    return FAST_STEPS if is_fast(cell) else STEPS[int(cell.split("/")[1][2:])]


def is_ready(line):
    """ready"""
    if line != "ready":
        raise ValueError


def positive_seconds(line):
    """a time"""
    seconds = float(line)
    if not 0.0 < seconds < math.inf:
        raise ValueError
    return seconds


class Server:
    """One build's regression_cells, kept running and asked for blocks of runs."""

    def __init__(self, command, cells, environment=None):
        self.what = command[-1]
        try:
            self.process = subprocess.Popen([*command, "--serve", *cells], env=environment, stdin=subprocess.PIPE,
                                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
                                            errors="replace")
        except OSError as problem:
            raise CannotRun(f"{self.what}: cannot be run: {problem.strerror}") from None
        self.cells = {name: place for place, name in enumerate(cells)}
        try:
            self.answer(is_ready)
        except BaseException:
            self.end()
            raise

    def answer(self, read):
        """Returns what `read` makes of the next line; a server that died, or says something else, cannot be judged."""
        line = self.process.stdout.readline().strip()
        try:
            return read(line)
        except ValueError:
            self.process.kill()
            _, problem = self.process.communicate()
            raise CannotRun(f"{self.what}: said {one_line(repr(line))} where {read.__doc__} was expected"
                            f" {one_line(problem)}".rstrip()) from None

    def seconds(self, cell, runs):
        """Returns CPU and wall seconds of so many runs of a cell."""
        start = time.monotonic()
        try:
            self.process.stdin.write(f"{self.cells[cell]} {steps_of(cell)} {runs}\n")
            self.process.stdin.flush()
        except OSError:
            pass  # it has died; the answer says of what
        return self.answer(positive_seconds), time.monotonic() - start

    def end(self):
        with contextlib.suppress(OSError):
            self.process.stdin.close()
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        self.process.stderr.close()


@dataclass(frozen=True)
class Timing:
    """The pairs of one cell: head over base."""

    ratios: tuple
    wall_ratio: float  # median, for information

    @property
    def median(self):
        return statistics.median(self.ratios)

    @property
    def lower_quartile(self):
        return statistics.quantiles(self.ratios, n=4, method="inclusive")[0]

    def is_slower(self):
        return self.median > MEDIAN_LIMIT and self.lower_quartile > QUARTILE_LIMIT


def pinned(program):
    """Returns the command that runs a program on the last core where that is possible."""
    last = max(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else None
    return [program] if last is None or not shutil.which("taskset") else ["taskset", "-c", str(last), program]


@dataclass(frozen=True)
class Contestant:
    """A build that is timed: the command of its regression_cells, and the environment it runs in."""

    command: list
    environment: Optional[dict] = None

    def serve(self, cells):
        return Server(self.command, cells, self.environment)


def time_cells(base, head, cells, plan):
    """Returns the Timing of each cell over both Contestants. Throws CannotRun."""
    pairs = {cell: [] for cell in cells}
    runs = {}
    for launch in range(plan.launches):
        base_server, head_server = servers = start_both(base, head, cells, launch)
        try:
            for pair in range(plan.pairs):
                for cell in cells:
                    if cell not in runs:
                        runs[cell] = runs_in_a_block(base_server, cell, plan.block_seconds)
                    turns = servers if (launch + pair) % 2 == 0 else servers[::-1]
                    pairs[cell].append(one_pair(turns, base_server, head_server, cell, runs[cell]))
        finally:
            for server in servers:
                server.end()
    return {cell: Timing(tuple(cpu for cpu, _ in found), statistics.median(wall for _, wall in found))
            for cell, found in pairs.items()}


def start_both(base, head, cells, launch):
    """Starts both servers, every other time the second first; returns base's and head's."""
    started = []
    try:
        for contestant in (base, head) if launch % 2 == 0 else (head, base):
            started.append(contestant.serve(cells))
    except BaseException:
        for server in started:
            server.end()
        raise
    return tuple(started) if launch % 2 == 0 else tuple(started[::-1])


def runs_in_a_block(server, cell, block_seconds):
    server.seconds(cell, 1)  # the first is slower
    once, _ = server.seconds(cell, 1)
    return max(1, round(block_seconds / once))


def one_pair(turns, base, head, cell, runs):
    """Returns the ratios of CPU and of wall time of a pair: first, second, second, first."""
    first, second = turns
    blocks = [(server, *server.seconds(cell, runs)) for server in (first, second, second, first)]

    def total(wanted, kind):
        return sum(block[kind] for block in blocks if block[0] is wanted)

    return total(head, 1) / total(base, 1), total(head, 2) / total(base, 2)


def judge_times(base, head, plan):
    """Times the cells of the plan, and those that seem slower once more: a cell is slower if it was both times."""
    layer = Layer("timing")
    first = time_cells(base, head, plan.cells, plan)
    suspects = tuple(cell for cell in plan.cells if first[cell].is_slower())
    again = time_cells(base, head, suspects, plan) if suspects else {}
    latest = {**first, **again}
    for cell, timing in latest.items():
        layer.add(cell, "CPU time, head over base", f"{timing.median:.3f} (lower quartile {timing.lower_quartile:.3f})",
                  f"{MEDIAN_LIMIT} ({QUARTILE_LIMIT})", not timing.is_slower())
    if suspects:
        layer.notes.append("measured twice: " + ", ".join(f"{cell} (first {first[cell].median:.3f})"
                                                          for cell in suspects))
    layer.notes.append("wall time, not judged: " + ", ".join(f"{cell} {timing.wall_ratio:.3f}"
                                                              for cell, timing in latest.items()))
    return layer
