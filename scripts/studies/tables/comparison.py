"""A run of a table beside the published one: times, winners, ratios and failures, and the sections that show them.

A block is what is compared: the formulations at one n and one number of stages.
"""

import csv
import math
import statistics
from typing import NamedTuple

from lib.programs.messages import UnusableFile, one_line
from lib.records.formats import FORMULATIONS
from lib.records.table_file import CellKey, Measurement, Run
from lib.judging.verdicts import FEWEST, LEVEL, MARGIN, MAXIMUM, fastest, level_rows, ratio_of
from lib.pages.document import Column, Entry, Heading, Items, Paragraph, Table, plain_table
from lib.pages.numbers import MISSING, three_digits

UNDECIDED_MARK = "†"
STAGES = (1, 2, 3)  # of the table's columns


class Comparison(NamedTuple):
    """Our run and the published one, whose cells have one time each."""

    run: Run
    published: Run

    def sizes(self):
        """Returns every n of either side: what a partial run lacks is shown as missing, not left out."""
        return sorted({key.n for side in self for key in side.measurements})

    def has_counter(self, counter):
        """Tells whether any cell has this counter."""
        return any(counter in cell.counters for cell in self.run.measurements.values())


def check_layout(path, run):
    """Refuses a file with a cell that the table has no place for, rather than dropping it unseen."""
    for key in run.measurements:
        if key.formulation not in FORMULATIONS or key.stages not in STAGES:
            raise UnusableFile(f"{one_line(path)}: the table has no place for {key.formulation} with s = {key.stages}")


def read_published(path):
    """Reads the published seconds: a CSV file with columns n, formulation, stages, seconds."""
    with open(path, encoding="utf-8", newline="") as file:
        return Run({}, {CellKey(row["formulation"], int(row["n"]), int(row["stages"])):
                        Measurement({0: float(row["seconds"])}) for row in csv.DictReader(file)})


# ---- winners


def marks(times):
    """Returns the rows of a block that are marked as fastest, and those that are marked as undecided, as two sets.

    With too few processes for a verdict every row is undecided.
    """
    if len(times) > 1 and min(map(len, times.values())) < FEWEST:
        return set(), set(times)
    return level_rows(times)


def printed_marks(times):
    """Returns the same for printed seconds: the least of a block, and nothing undecided."""
    return ({fastest(times)} if len(times) > 1 else set()), set()


# ---- numbers


def spread_text(text, spread):
    return f"{text} ±{spread:.1f} %" if spread < 9.95 else f"{text} ±{spread:.0f} %"


def time_with_spread(times):
    """Writes the median with half the interquartile range in percent of it; a lone time has no spread."""
    text = three_digits(statistics.median(times))
    if len(times) < 2:
        return text
    lower, _, upper = statistics.quantiles(times, n=4, method="inclusive")
    return spread_text(text, 50 * (upper - lower) / statistics.median(times))


def time_with_interval(times):
    """Writes the geometric mean of the times of processes with its 95 % interval; one process has none."""
    found = ratio_of(times, [1.0] * len(times))
    text = three_digits(found.ratio)
    return spread_text(text, 100 * (found.high / found.ratio - 1)) if len(times) > 1 else text


def ratio_text(found):
    """Writes a Ratio, or None, with its interval, if it has one."""
    if found is None:
        return MISSING
    if not found.low or math.isinf(found.high):
        return three_digits(found.ratio)
    return f"{three_digits(found.ratio)} ({three_digits(found.low)}–{three_digits(found.high)})"


# ---- sections


def times_section(comparison, heading, introduction):
    return [Heading(heading), Paragraph(introduction),
            both_sides(comparison, lambda times, name: time_with_interval(times[name])),
            *footnotes(comparison.run), Paragraph(times_legend(comparison.run))]


def ratios_section(comparison):
    return [Heading("Ratios to the fastest row of the block"),
            Paragraph("Each time over that of the fastest row of its column in its block, so that different machines"
                      " can be compared. Marked as above. A row without a time is left out of its block's comparison."),
            both_sides(comparison, lambda times, name: three_digits(
                ratio_of(times[name], times[fastest(times)]).ratio))]


def both_sides(comparison, show):
    """Lays out the published table's shape twice, ours and then theirs; an entry is show(times of a block, row)."""
    columns = [Column("n"), Column("formulation", align="left")]
    columns += [Column(f"s = {stages}", side) for side in ("this run", "paper") for stages in STAGES]
    sides = ((comparison.run, marks), (comparison.published, printed_marks))
    blocks = [[[Entry(str(n) if name == FORMULATIONS[0] else ""), Entry(name),
                *(entry(run, name, n, stages, show, mark) for run, mark in sides for stages in STAGES)]
               for name in FORMULATIONS] for n in comparison.sizes()]
    return Table(tuple(columns), blocks)


def entry(run, name, n, stages, show, mark):
    """Shows something of one cell's block, or that the cell is missing or failed."""
    times = run.times(n, stages)
    if name not in times:
        return Entry(absence(run, name, n, stages))
    best, undecided = mark(times)
    return Entry(show(times, name) + (UNDECIDED_MARK if name in undecided else ""), name in best)


def absence(run, name, n, stages):
    """Writes why a cell has no time: not measured, or failed with the number of its footnote."""
    cell = run.cell(name, n, stages)
    return f"failed ({run.failures().index(CellKey(name, n, stages)) + 1})" if cell and cell.failure else MISSING


def footnotes(run):
    notes = [(f"({number}) {key.formulation}, n = {key.n}, s = {key.stages}",
              f": failed: {run.measurements[key].failure}") for number, key in enumerate(run.failures(), 1)]
    return [Items(notes)] if notes else []


def times_legend(run):
    counts = sorted({len(cell.times) for cell in run.measurements.values() if not cell.failure})
    counted = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}" if counts else "no"
    return (f"Geometric means of {counted} process{'es' if counted != '1' else ''}, ± the half width of their"
            f" {LEVEL:.0%} interval. Marked (bold, or * in plain text): the fastest row of its column in its block, and"
            f" every row that ties with it, that is within {MARGIN - 1:.0%} of it. {UNDECIDED_MARK}: undecided, as"
            f' everything is with fewer than {FEWEST} processes. "{MISSING}": not measured.')


def verdict_rules():
    """Says how ratios are judged."""
    return (f"Ratios are geometric means over processes, with their {LEVEL:.0%} interval (Student's t of the logarithms"
            f" of one ratio a process). Faster or slower: the whole interval is beyond {MARGIN}; tie: it lies within"
            f" 1/{MARGIN} … {MARGIN}; otherwise undecided. At least {FEWEST} processes, up to {MAXIMUM} while anything"
            " at that n is undecided.")


def counters_section(comparison, columns):
    """Shows counters, one row a cell; `columns` lists (heading, counter, how to write it)."""
    run, blocks = comparison.run, []
    for n in sorted({key.n for key in run.measurements}):
        rows = [[str(stages) if name == FORMULATIONS[0] else "", name, *counter_texts(run, name, n, stages, columns)]
                for stages in STAGES for name in FORMULATIONS]
        blocks.append([[Entry(text) for text in (str(n) if not index else "", *row)] for index, row in enumerate(rows)])
    return [Heading("What the time went into, and how good the answer is"),
            Table((Column("n"), Column("s"), Column("formulation", align="left"),
                   *(Column(name) for name, _, _ in columns)), blocks)]


def counter_texts(run, name, n, stages, columns):
    cell = run.cell(name, n, stages)
    if not cell or cell.failure:
        return [absence(run, name, n, stages)] + [MISSING] * (len(columns) - 1)
    return [show(cell.counters[counter]) if counter in cell.counters else MISSING for _, counter, show in columns]


def errors_section(comparison):
    """Shows the largest error over the formulations, one row for each n and one column for each s.

    Nothing is shown for a run that was not compared with reference solutions.
    """
    if not comparison.has_counter("relative_error"):
        return []

    def largest(n, stages, counter, digits):
        found = [cell.counters[counter] for key, cell in comparison.run.measurements.items()
                 if key.n == n and key.stages in stages and counter in cell.counters]
        return f"{max(found):.{digits}g}" if found else MISSING

    rows = [[str(n), *(largest(n, (stages,), "relative_error", 2) for stages in STAGES),
             largest(n, STAGES, "reference_uncertainty", 1)] for n in comparison.sizes()]
    columns = (Column("n"), *(Column(f"s = {stages}") for stages in STAGES), Column("reference good to"))
    return [Heading("Error at T = 5"),
            Paragraph("Relative error of W(5) in the Frobenius norm against reference solutions, the largest of the"
                      " three formulations, which coincide: what the times above buy."), plain_table(columns, rows)]


# ---- measurement conditions

PACKAGED = ("library build type: of Google Benchmark as the distribution packaged it; it says nothing of the code"
            " measured here.")
# A file says more: whose machine it was is nobody's business.
CONDITIONS = ("date", "commit", "dirty", "build_type", "compiler", "flags", "cpu", "num_cpus", "mhz_per_cpu",
              "vector_units", "load_average", "processes", "disturbed_processes", "pinned_to", "blas_library",
              "blas_kernels", "blas_threads", "environment", "products", "product_rate", "peak_gflops", "tolerance",
              "norm", "start", "update_order", "hbar", "modes_hash", "notice", "library_build_type")


def conditions_section(context):
    """Lists under what conditions the run was made."""
    return [Heading("Measurement conditions"),
            Items([(name.replace("_", " "), f": {context.get(name, 'not recorded') or 'none'}")
                   for name in CONDITIONS]),
            Paragraph(PACKAGED)]
