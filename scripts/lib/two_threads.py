"""The section of Table 2 that compares one thread with two."""

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
    one, two = (read_run(path, "table2", counters, (STOLEN, CORES), threads=threads, time="real_time").measurements
                for threads in (1, 2))
    quiet = {key: [times for index, times in enumerate(zip(one[key].times, two[key].times))
                   if not disturbed(one[key], index) and not disturbed(two[key], index)]
             for key in one.keys() & two.keys()}
    pairs = sum(min(len(one[key].times), len(two[key].times)) for key in quiet)
    columns = (Column("n"), Column("formulation", align="left"), *(Column(f"s = {stages}") for stages in STAGES))
    blocks = [[[Entry(str(n) if name == FORMULATIONS[0] else ""), Entry(name),
                *(Entry(speed_up(quiet.get(CellKey(name, n, stages), ()))) for stages in STAGES)] for name in FORMULATIONS]
              for n in sorted({key.n for key in two})]
    return [Heading("One thread over two"),
            Paragraph("Median over pairs of runs, one straight after the other, of the time that passes, of the fast"
                      " forms with one thread over two, on cores of their own; in brackets the same of the shortest"
                      " times. The answers are the same bit for bit."),
            Paragraph(f"Left out: {pairs - sum(map(len, quiet.values()))} of {pairs} pairs, around which the host gave"
                      f" more than {100 * MOST_STOLEN:g} % of the cores' time to others, or two threads at once"
                      f" multiply-add less than {FEWEST_CORES:g} times as fast as one; and cells with fewer than"
                      f" {FEWEST_PAIRS} others."),
            Table(columns, blocks)]


def disturbed(cell, index):
    stolen, cores = (cell.repeated.get(name) for name in (STOLEN, CORES))
    return bool(stolen and stolen[index] > MOST_STOLEN or cores and cores[index] < FEWEST_CORES)


def speed_up(pairs):
    if len(pairs) < FEWEST_PAIRS:
        return MISSING
    shortest = [min(times) for times in zip(*pairs)]
    return f"{three_digits(median([first / second for first, second in pairs]))} ({three_digits(shortest[0] / shortest[1])})"
