"""The section of Table 2 that compares one thread with two."""

from dataclasses import replace
from typing import NamedTuple

from benchmark_json import FORMULATIONS, CellKey, read_run
from comparison import MISSING, three_digits
from document import Column, Entry, Heading, Paragraph, Table
from paper_table import STAGES
from statistics_of_repetitions import median

STOLEN = "stolen"  # share of the cores' time that the host of a virtual machine gave to others
MOST_STOLEN = 0.02  # of the cores' time, in either run of a pair that counts
CORES = "cores_at_once"  # what two threads multiply-add at once over what one does, before and after a run
FEWEST_CORES = 1.8  # around either run of a pair that counts; 1 where the host runs both processors on one core
FEWEST_PAIRS = 5


def threads_section(path, counters):
    """How often the time that passes with one thread holds that with two."""
    every = [read_run(path, "table2", counters, (STOLEN, CORES), threads=threads, time="real_time")
             for threads in (1, 2)]
    (one, two), disturbed = undisturbed(*every) if in_rounds(every[0]) else (every, [])
    columns = (Column("n"), Column("formulation", align="left"), *(Column(f"s = {stages}") for stages in STAGES))
    blocks = []
    for n in sorted({key.n for key in two.measurements}):
        rows = [(name, [speed_up_text(one, two, CellKey(name, n, stages)) for stages in STAGES])
                for name in FORMULATIONS]
        blocks.append([[Entry(str(n) if not index else ""), Entry(name), *map(Entry, texts)]
                       for index, (name, texts) in enumerate(rows)])
    return [Heading("One thread over two"),
            Paragraph(f"{'Median over pairs of runs, one straight after the other,' if in_rounds(one) else 'Median'} of"
                      " the time that passes, of the fast forms with one thread over two, measured in turns on cores of"
                      " their own; in brackets the same of the shortest times. The answers are the same bit for bit."),
            *([Paragraph(disturbance(every[1], disturbed))] if disturbed else []),
            Table(columns, blocks)]


class Disturbed(NamedTuple):
    """How many pairs of a cell's runs had their cores to themselves, and whether only those count."""

    key: CellKey
    quiet: int
    pairs: int

    @property
    def left_out(self):
        return self.quiet >= FEWEST_PAIRS


def undisturbed(one, two):
    """Returns both runs without the pairs that the host of a virtual machine disturbed, and the cells that have some.

    A cell keeps all its pairs where too few would be left.
    """
    kept, disturbed = (dict(one.measurements), dict(two.measurements)), []
    for key in one.measurements.keys() & two.measurements.keys():
        sides = (one.measurements[key], two.measurements[key])
        pairs = range(min(len(side.times) for side in sides))
        quiet = [index for index in pairs if all(had_its_cores(side, index) for side in sides)]
        if len(quiet) == len(pairs):
            continue
        disturbed.append(Disturbed(key, len(quiet), len(pairs)))
        if disturbed[-1].left_out:
            for measurements, side in zip(kept, sides):
                measurements[key] = replace(side, times=tuple(side.times[index] for index in quiet))
    return [replace(run, measurements=measurements) for run, measurements in zip((one, two), kept)], sorted(disturbed)


def had_its_cores(side, index):
    """Whether a run had two cores to itself, as far as its row tells."""
    stolen, cores = (side.repeated.get(name) for name in (STOLEN, CORES))
    return (stolen is None or stolen[index] <= MOST_STOLEN) and (cores is None or cores[index] >= FEWEST_CORES)


def disturbance(run, disturbed):
    """Says how many pairs do not count, and in which cells all do because too few others are left."""
    left_out = sum(cell.pairs - cell.quiet for cell in disturbed if cell.left_out)
    crowded = [f"{cell.key.formulation} at n = {cell.key.n}, s = {cell.key.stages} ({cell.quiet} of {cell.pairs})"
               for cell in disturbed if not cell.left_out]
    return (f"Left out: {left_out} of {sum(len(side.times) for side in run.measurements.values())} pairs, around which the"
            f" host gave more than {100 * MOST_STOLEN:g} % of the cores' time to others, or two threads at once"
            f" multiply-add less than {FEWEST_CORES:g} times as fast as one. All pairs count where fewer than"
            f" {FEWEST_PAIRS} were undisturbed: {', '.join(crowded) or 'nowhere'}.")


def in_rounds(run):
    """Whether each repetition of a cell with two threads was measured straight after one with one thread."""
    return run.context.get("order") == "rounds"


def speed_up(one, two, key):
    before, after = (run.measurements[key].times for run in (one, two))
    return (median([first / second for first, second in zip(before, after)]) if in_rounds(one) else
            median(before) / median(after))


def speed_up_text(one, two, key):
    sides = [run.measurements.get(key) for run in (one, two)]
    if not all(side and side.times for side in sides):
        return MISSING
    before, after = (side.times for side in sides)
    return f"{three_digits(speed_up(one, two, key))} ({three_digits(min(before) / min(after))})"
