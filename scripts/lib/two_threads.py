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
NEARER = 0.9  # a ratio that falls to this share of what it was has fallen clearly


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
            *([Paragraph(disturbance(every, (one, two), disturbed))] if disturbed else []),
            Table(columns, blocks),
            *parallel_algebra(one, two)]


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


def what_disturbs(run):
    """Says in what way the host of a virtual machine can have disturbed a pair, as far as the rows tell."""
    told = {name for side in run.measurements.values() for name in side.repeated}
    ways = {STOLEN: f"gave more than {100 * MOST_STOLEN:g} % of the cores' time to others",
            CORES: "ran both processors on one core (two threads at once multiply-add less than"
                   f" {FEWEST_CORES:g} times as fast as one, before or after)"}
    return " or ".join(text for name, text in ways.items() if name in told)


def disturbance(every, counted, disturbed):
    """Says which pairs were disturbed, and what would stand here if they counted."""
    left_out = [cell for cell in disturbed if cell.left_out]
    crowded = [cell for cell in disturbed if not cell.left_out]
    texts = []
    if left_out:
        change = max(abs(speed_up(*counted, cell.key) - speed_up(*every, cell.key)) for cell in left_out)
        texts.append(f"Pairs in which the host of this virtual machine {what_disturbs(every[1])}"
                     f" are left out: {sum(cell.pairs - cell.quiet for cell in left_out)} of"
                     f" {sum(len(side.times) for side in every[1].measurements.values())}. With them, medians would"
                     f" differ by up to {change:.2f}.")
    if crowded:
        names = ", ".join(f"{cell.key.formulation} at n = {cell.key.n}, s = {cell.key.stages} ({cell.quiet} of"
                          f" {cell.pairs})" for cell in crowded)
        texts.append(f"All pairs count where fewer than {FEWEST_PAIRS} had the cores to themselves: {names}.")
    return " ".join(texts)


def in_rounds(run):
    """Whether each repetition of a cell with two threads was measured straight after one with one thread."""
    return run.context.get("order") == "rounds"


def parallel_algebra(one, two):
    """What two threads do to the place of algebra (ISOSYRK), which the paper leaves open."""
    n = max(key.n for key in two.measurements)
    several = [stages for stages in STAGES if stages > 1]
    ratios = [[behind_the_fastest(run, n, stages) for stages in several] for run in (one, two)]
    if any(ratio is None for side in ratios for ratio in side):
        return []
    with_one, with_two = (", ".join(map(three_digits, side)) for side in ratios)
    gains = all(after < NEARER * before for before, after in zip(*ratios))
    return [Paragraph("The paper leaves open whether ISOSYRK would gain by a parallel implementation."
                      f" At n = {n}, s = {', '.join(map(str, several))} algebra takes {with_one} times the time of the"
                      f" fastest formulation with one thread and {with_two} times with two: "
                      + ("so it gains more by it than they do." if gains else
                         "so it does not gain more by it than they do; what its pairs of stages offer to a second core,"
                         " the stages of the others offer too."))]


def behind_the_fastest(run, n, stages):
    times = {name: run.measurements.get(CellKey(name, n, stages)) for name in FORMULATIONS}
    if not all(each and each.times for each in times.values()):
        return None
    return median(times["algebra"].times) / min(median(each.times) for each in times.values())


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
