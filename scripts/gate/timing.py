"""The timing layer of the regression gate: two builds on one machine, turn and turn about, in CPU time.

A machine that others share drifts by tens of per cent within seconds, and a process keeps for its life whatever its
place in memory gives or costs it. So both builds run at the same time as servers that are asked for one short block at
a time, in the order base, head, head, base or the reverse, and both are started anew several times. A pair is the two
blocks of the one over the two of the other; a cell is judged by the median of its pairs and their lower quartile.
"""

import contextlib
import os
import re
import shutil
import statistics
import subprocess

from lib.programs.command_line import Stop
from lib.programs.messages import one_line
from gate.cells import is_fast, with_fast
from gate.layers import Layer

MEDIAN_LIMIT, QUARTILE_LIMIT = 1.03, 1.01
LAUNCHES, PAIRS = 6, 3  # of both builds; of each cell, a launch
BLOCK_SECONDS = 0.02
STEPS = {17: 50, 33: 20, 65: 5, 129: 1}  # of a published form's run, by n
FAST_STEPS = 50  # of a fast one's: it starts cold, and costs less as soon as it can predict
QUICK = with_fast(["cotangent/n:17/s:2", "group/n:17/s:2", "algebra/n:17/s:2",
                   "cotangent/n:33/s:3", "group/n:33/s:3", "algebra/n:33/s:1"])
FULL = [*QUICK,
        "group/n:65/s:2", "algebra/n:65/s:1", "algebra/n:65/s:3",
        "cotangent/n:129/s:3", "group/n:129/s:1", "algebra/n:129/s:2",
        "fast_cotangent/n:65/s:2", "fast_group/n:65/s:3", "fast_algebra/n:65/s:2",
        "fast_cotangent/n:129/s:1", "fast_group/n:129/s:2", "fast_algebra/n:129/s:1"]


def steps_of(cell):
    return FAST_STEPS if is_fast(cell) else STEPS[int(cell.split("/")[1][2:])]


class Server:
    """One build's regression_cells, kept running and asked for blocks of runs."""

    def __init__(self, command, environment, cells):
        self.what = command[-1]
        self.process = subprocess.Popen([*command, "--serve", *cells], env=environment, stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
                                        errors="replace")
        self.cells = {name: place for place, name in enumerate(cells)}
        try:
            self.answer("ready", lambda line: line == "ready")
        except BaseException:
            self.close()
            raise

    def answer(self, expected, is_one):
        """Returns the next line; a server that died, or says something else than expected, cannot be judged."""
        line = self.process.stdout.readline().strip()
        if not is_one(line):
            problem = self.close()
            raise Stop(f"{self.what}: said {one_line(repr(line))} where {expected} was expected"
                       f" {one_line(problem)}".rstrip())
        return line

    def seconds(self, cell, runs):
        """Returns the CPU seconds of so many runs of a cell."""
        with contextlib.suppress(OSError):  # where it has died, the answer says of what
            self.process.stdin.write(f"{self.cells[cell]} {steps_of(cell)} {runs}\n")
            self.process.stdin.flush()
        return float(self.answer("a time", re.compile(r"(?=.*[1-9])[0-9.]+(e[+-]?[0-9]+)?").fullmatch))

    def close(self):
        """Ends it, and returns what it said of a problem."""
        self.process.kill()
        return self.process.communicate()[1]


def quartiles(ratios):
    """Returns the lower quartile and the median."""
    return statistics.quantiles(ratios, n=4, method="inclusive")[:2]


def is_slower(ratios):
    """Tells whether the pairs of a cell, head over base, show head slower: by their median and their lower quartile."""
    lower, middle = quartiles(ratios)
    return middle > MEDIAN_LIMIT and lower > QUARTILE_LIMIT


def pinned(program):
    """Returns the command that runs a program on the last core where that is possible."""
    last = str(max(os.sched_getaffinity(0)))
    return ["taskset", "-c", last, program] if shutil.which("taskset") else [program]


def time_cells(base, head, cells, launches=LAUNCHES, pairs_of_each=PAIRS):
    """Returns the ratios of the pairs of each cell; `base` and `head` start a Server of the cells. Throws Stop."""
    pairs = {cell: [] for cell in cells}
    runs = {}
    for launch in range(launches):
        with contextlib.ExitStack() as running:
            servers = {}
            for start in (base, head) if launch % 2 == 0 else (head, base):
                servers[start] = running.enter_context(contextlib.closing(start(cells)))
            for pair in range(pairs_of_each):
                for cell in cells:
                    if cell not in runs:
                        runs[cell] = runs_in_a_block(servers[base], cell)
                    turns = (base, head, head, base) if (launch + pair) % 2 == 0 else (head, base, base, head)
                    seconds = {base: 0.0, head: 0.0}
                    for turn in turns:
                        seconds[turn] += servers[turn].seconds(cell, runs[cell])
                    pairs[cell].append(seconds[head] / seconds[base])
    return pairs


def runs_in_a_block(server, cell):
    server.seconds(cell, 1)  # the first is slower
    return max(1, round(BLOCK_SECONDS / server.seconds(cell, 1)))


def judge_times(base, head, cells):
    """Times these cells, and those that seem slower once more: a cell is slower if it was both times."""
    layer = Layer("timing")
    layer.pairs = first = time_cells(base, head, cells)
    suspects = [cell for cell in cells if is_slower(first[cell])]
    again = time_cells(base, head, suspects) if suspects else {}
    for cell, ratios in {**first, **again}.items():
        lower, middle = quartiles(ratios)
        layer.add(cell, "CPU time, head over base", f"{middle:.3f} (lower quartile {lower:.3f})",
                  f"{MEDIAN_LIMIT} ({QUARTILE_LIMIT})", not is_slower(ratios))
    if suspects:
        layer.notes.append("measured twice: " + ", ".join(f"{cell} (first {quartiles(first[cell])[1]:.3f})"
                                                          for cell in suspects))
    return layer
