"""A run of a table beside the published one: winners, ratios and failures, and the sections that show them.

A block is what is compared: the formulations at one n and one number of stages.
"""

import csv
import math
import statistics
from typing import NamedTuple

from lib.formats import FORMULATIONS, CellKey, Measurement, Run
from lib.messages import UnusableFile, one_line
from lib.document import Column, Entry, Heading, Items, Paragraph, Table, plain_table
from lib.statistics_of_repetitions import FASTER, FEWEST_REPETITIONS, LEVEL, compare, median

MISSING = "–"
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
        return Run({}, {CellKey(row["formulation"], int(row["n"]), int(row["stages"])): Measurement((float(row["seconds"]),))
                        for row in csv.DictReader(file)})


# ---- winners


def fastest_rows(times):
    """Returns the rows of a block to mark: the least median, and every row not separated from it.

    A row with no rival has won nothing. Where repetitions are too few for the test, the least median stands
    alone, and the legend says that it is untested.
    """
    if len(times) < 2:
        return set()
    best = min(times, key=lambda name: median(times[name]))
    if min(map(len, times.values())) < FEWEST_REPETITIONS:
        return {best}
    return {name for name in times if name == best or compare(times[best], times[name])[0] != FASTER}


# ---- numbers


def three_digits(value):
    """Writes a number with three significant digits, plainly where that is short."""
    if value == 0:
        return "0"
    rounded = float(f"{value:.2e}")
    exponent = math.floor(math.log10(abs(rounded)))
    if not -5 < exponent < 6:
        return f"{value:.2e}"
    return f"{rounded:.{max(0, 2 - exponent)}f}"


def percentage(share):
    return f"{three_digits(100 * share)} %"


def time_with_spread(times):
    """Writes the median with half the interquartile range in percent of it; a lone time has no spread."""
    text = three_digits(median(times))
    if len(times) < 2:
        return text
    lower, _, upper = statistics.quantiles(times, n=4, method="inclusive")
    spread = 50 * (upper - lower) / median(times)
    return f"{text} ±{spread:.1f} %" if spread < 9.95 else f"{text} ±{spread:.0f} %"


# ---- sections


def times_section(comparison, heading, introduction):
    return [Heading(heading), Paragraph(introduction),
            both_sides(comparison, lambda times, name: time_with_spread(times[name])),
            *footnotes(comparison.run), Paragraph(times_legend(comparison.run))]


def ratios_section(comparison):
    return [Heading("Ratios to the fastest row of the block"),
            Paragraph("Each time over the least of its column in its block, so that different machines can be"
                      " compared. Marked as above. A row without a time is left out of its block's comparison."),
            both_sides(comparison, lambda times, name: three_digits(
                median(times[name]) / min(map(median, times.values()))))]


def both_sides(comparison, show):
    """Lays out the published table's shape twice, ours and then theirs; an entry is show(times of a block, row)."""
    columns = [Column("n"), Column("formulation", align="left")]
    columns += [Column(f"s = {stages}", side) for side in ("this run", "paper") for stages in STAGES]
    blocks = [[[Entry(str(n) if name == FORMULATIONS[0] else ""), Entry(name),
                *(entry(run, name, n, stages, show) for run in comparison for stages in STAGES)]
               for name in FORMULATIONS] for n in comparison.sizes()]
    return Table(tuple(columns), blocks)


def entry(run, name, n, stages, show):
    """Shows something of one cell's block, or that the cell is missing or failed."""
    times = run.times(n, stages)
    if name not in times:
        return Entry(absence(run, name, n, stages))
    return Entry(show(times, name), name in fastest_rows(times))


def absence(run, name, n, stages):
    """Writes why a cell has no time: not measured, or failed with the number of its footnote."""
    cell = run.cell(name, n, stages)
    return f"failed ({run.failures().index(CellKey(name, n, stages)) + 1})" if cell else MISSING


def footnotes(run):
    notes = [(f"({number}) {key.formulation}, n = {key.n}, s = {key.stages}",
              f": failed: {run.measurements[key].failure}") for number, key in enumerate(run.failures(), 1)]
    return [Items(notes)] if notes else []


def times_legend(run):
    counts = sorted({len(cell.times) for cell in run.measurements.values() if not cell.failure})
    return (f"Medians of {' or '.join(map(str, counts)) or 'no'} repetitions, ± half their interquartile range. Marked"
            " (bold, or * in plain text): the row with the least median of its column in its block, and every row that"
            f" the exact rank test does not separate from it (one-sided Mann–Whitney, p ≤ {LEVEL}); with fewer than"
            f' {FEWEST_REPETITIONS} repetitions the least median alone, untested. "{MISSING}": not measured.')


def counters_section(comparison, columns):
    """Shows counters, one row a cell; `columns` lists (heading, counter, how to write it)."""
    run, blocks = comparison.run, []
    for n in sorted({key.n for key in run.measurements}):
        rows = [[str(stages) if name == FORMULATIONS[0] else "", name, *counter_texts(run, name, n, stages, columns)]
                for stages in STAGES for name in FORMULATIONS]
        blocks.append([[Entry(text) for text in (str(n) if not index else "", *row)] for index, row in enumerate(rows)])
    return [Heading("What the time went into, and how good the answer is"),
            Table((Column("n"), Column("s"), Column("formulation", align="left"), *(Column(name) for name, _, _ in columns)),
                  blocks)]


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
            Paragraph("Relative error of W(5) in the Frobenius norm against reference solutions, the largest of the three"
                      " formulations, which coincide: what the times above buy."), plain_table(columns, rows)]


# ---- measurement conditions

PACKAGED = ("library build type: of Google Benchmark as the distribution packaged it; it says nothing of the code"
            " measured here.")
# A file says more: whose machine it was is nobody's business.
CONDITIONS = ("date", "commit", "dirty", "build_type", "compiler", "flags", "cpu", "num_cpus", "mhz_per_cpu",
              "vector_units", "load_average", "blas_library", "blas_kernels", "blas_threads", "environment", "products",
              "product_rate", "peak_gflops", "tolerance", "norm", "start", "update_order", "hbar", "modes_hash",
              "notice", "library_build_type")


def conditions_section(context):
    """Lists under what conditions the run was made."""
    return [Heading("Measurement conditions"),
            Items([(name.replace("_", " "), f": {context.get(name, 'not recorded') or 'none'}")
                   for name in CONDITIONS]),
            Paragraph(PACKAGED)]
