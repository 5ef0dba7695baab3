"""A run beside a published table: who is fastest in each block, ratios, failures; and the sections that show it.

A block is what is compared: the formulations at one n and one number of stages.
"""

import csv
import io
import math
from dataclasses import dataclass
from typing import Dict, Tuple

from benchmark_json import CellKey, Run
from checked_json import SMALLEST, UnusableFile, is_number, one_line, quoted, read_text
from document import Column, Entry, Heading, Items, Paragraph, Table, plain_table
from statistics_of_repetitions import (FASTER, FEWEST_REPETITIONS, LEVEL, compare, half_interquartile_range,
                                       median)

MISSING = "–"


@dataclass(frozen=True)
class Comparison:
    """Our run and the published seconds, in a table of these formulations and numbers of stages."""

    run: Run
    published: Dict[CellKey, float]
    formulations: Tuple[str, ...]
    stages: Tuple[int, ...]

    def sizes(self):
        """Returns every n of either side: what a partial run lacks is shown as missing, not left out."""
        return sorted({key.n for key in (*self.run.measurements, *self.published)})

    def measurement(self, formulation, n, stages):
        return self.run.measurements.get(CellKey(formulation, n, stages))

    def block(self, n, stages):
        """Returns the measurements of a block that exist, by formulation."""
        cells = {name: self.measurement(name, n, stages) for name in self.formulations}
        return {name: cell for name, cell in cells.items() if cell}

    def times(self, n, stages):
        """Returns the repetitions of the rows of a block that finished."""
        return {name: cell.times for name, cell in self.block(n, stages).items() if not cell.failure}

    def published_block(self, n, stages):
        keys = [CellKey(name, n, stages) for name in self.formulations]
        return {key.formulation: self.published[key] for key in keys if key in self.published}

    def has_counter(self, counter):
        """Tells whether any cell has this counter."""
        return any(counter in cell.counters for cell in self.run.measurements.values())

    def failures(self):
        """Returns the failed cells in the order of the table; a cell's place here is its footnote number."""
        keys = [CellKey(name, n, stages) for n in self.sizes() for name in self.formulations
                for stages in self.stages]
        return [key for key in keys if key in self.run.measurements and self.run.measurements[key].failure]


def check_layout(path, run, formulations, stages):
    """Refuses a file with a cell that the table has no place for, rather than dropping it unseen."""
    for key in run.measurements:
        if key.formulation not in formulations or key.stages not in stages:
            raise UnusableFile(f"{one_line(path)}: the table has no place for {key.formulation} with"
                               f" s = {key.stages} (formulations {', '.join(formulations)}; s"
                               f" {', '.join(map(str, stages))})")


def read_published(path):
    """Reads the published seconds: a CSV file with columns n, formulation, stages, seconds."""
    try:
        rows = csv.DictReader(io.StringIO(read_text(path)))
        published = {CellKey(row["formulation"], int(row["n"]), int(row["stages"])): float(row["seconds"])
                     for row in rows}
    except UnusableFile as problem:
        raise UnusableFile(f"{one_line(path)}: {problem}") from None
    except (KeyError, TypeError, ValueError, csv.Error) as problem:
        raise UnusableFile(f"{one_line(path)}: is no table of published times ({quoted(str(problem))})") from None
    if not published or not all(is_number(time, SMALLEST) for time in published.values()):
        raise UnusableFile(f"{one_line(path)}: has no published times, or one that is no time")
    return published


# ---- winners


def fastest_rows(times):
    """Returns the rows of a block to mark: the least median, and every row not separated from it.

    A row with no rival has won nothing. Where repetitions are too few for the test, the least median stands
    alone, and the legend says that it is untested.
    """
    if len(times) < 2:
        return set()
    best = min(times, key=lambda name: median(times[name]))
    if too_few(times):
        return {best}
    return {best} | {name for name in times if name != best
                     and compare(times[best], times[name]).outcome != FASTER}


def too_few(times):
    return min(map(len, times.values())) < FEWEST_REPETITIONS


def fastest_published(seconds):
    return {min(seconds, key=seconds.get)} if len(seconds) > 1 else set()


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
    spread = 100 * half_interquartile_range(times) / median(times)
    return f"{text} ±{spread:.1f} %" if spread < 9.95 else f"{text} ±{spread:.0f} %"


# ---- sections


def times_section(comparison, heading, introduction):
    return [Heading(heading), Paragraph(introduction), both_sides(comparison, our_time, published_time),
            *footnotes(comparison), Paragraph(times_legend(comparison))]


def ratios_section(comparison):
    return [Heading("Ratios to the fastest row of the block"),
            Paragraph("Each time over the least of its column in its block, so that different machines can be"
                      " compared. Marked as above. A row without a time is left out of its block's comparison."),
            both_sides(comparison, our_ratio, published_ratio)]


def both_sides(comparison, ours, theirs):
    """Lays out the published table's shape twice, our entries and then the published ones."""
    columns = [Column("n"), Column("formulation", align="left")]
    columns += [Column(f"s = {stages}", side) for side in ("this run", "paper") for stages in comparison.stages]
    blocks = [[[Entry(str(n) if name == comparison.formulations[0] else ""), Entry(name)]
               + [entry(comparison, name, n, stages) for entry in (ours, theirs) for stages in comparison.stages]
               for name in comparison.formulations] for n in comparison.sizes()]
    return Table(tuple(columns), blocks)


def our_time(comparison, name, n, stages):
    return measured_entry(comparison, name, n, stages, lambda times: time_with_spread(times[name]))


def our_ratio(comparison, name, n, stages):
    def ratio(times):
        return three_digits(median(times[name]) / min(map(median, times.values())))
    return measured_entry(comparison, name, n, stages, ratio)


def measured_entry(comparison, name, n, stages, show):
    """Shows something of one cell's block, or that the cell is missing or failed."""
    cell = comparison.measurement(name, n, stages)
    if not cell or cell.failure:
        return Entry(absence(comparison, name, n, stages))
    times = comparison.times(n, stages)
    return Entry(show(times), name in fastest_rows(times))


def absence(comparison, name, n, stages):
    """Writes why a cell has no time: not measured, or failed with the number of its footnote."""
    key = CellKey(name, n, stages)
    return f"failed ({comparison.failures().index(key) + 1})" if key in comparison.failures() else MISSING


def published_time(comparison, name, n, stages):
    return published_entry(comparison, name, n, stages, lambda seconds: seconds[name])


def published_ratio(comparison, name, n, stages):
    return published_entry(comparison, name, n, stages, lambda seconds: seconds[name] / min(seconds.values()))


def published_entry(comparison, name, n, stages, value):
    seconds = comparison.published_block(n, stages)
    if name not in seconds:
        return Entry(MISSING)
    return Entry(three_digits(value(seconds)), name in fastest_published(seconds))


def footnotes(comparison):
    notes = [(f"({number}) {key.formulation}, n = {key.n}, s = {key.stages}",
                  f": failed: {comparison.run.measurements[key].failure}")
             for number, key in enumerate(comparison.failures(), 1)]
    return [Items(notes)] if notes else []


def times_legend(comparison):
    return (f"Medians of {repetitions_text(comparison)}, ± half their interquartile range. Marked (bold, or * in plain"
            " text): the row with the least median of its column in its block, and every row that the exact rank test does"
            f" not separate from it (one-sided Mann–Whitney, p ≤ {LEVEL}); with fewer than {FEWEST_REPETITIONS} repetitions"
            f' the least median alone, untested. "{MISSING}": not measured.')


def repetitions_text(comparison):
    counts = sorted({len(cell.times) for cell in comparison.run.measurements.values() if not cell.failure})
    return f"{' or '.join(map(str, counts)) or 'no'} repetitions"


def counters_section(comparison, heading, columns):
    """Shows counters, one row a cell; `columns` lists (heading, counter, how to write it)."""
    names = [name for name, _, _ in columns]
    table_columns = (Column("n"), Column("s"), Column("formulation", align="left"), *map(Column, names))
    sizes = [n for n in comparison.sizes() if any(comparison.block(n, s) for s in comparison.stages)]
    blocks = [counters_block(comparison, n, columns) for n in sizes]
    return [Heading(heading), Table(table_columns, blocks)]


def counters_block(comparison, n, columns):
    rows = []
    for stages in comparison.stages:
        for name in comparison.formulations:
            label = [str(n) if not rows else "", str(stages) if name == comparison.formulations[0] else "", name]
            rows.append([Entry(text) for text in label + counter_texts(comparison, name, n, stages, columns)])
    return rows


def counter_texts(comparison, name, n, stages, columns):
    cell = comparison.measurement(name, n, stages)
    if not cell or cell.failure:
        return [absence(comparison, name, n, stages)] + [MISSING] * (len(columns) - 1)
    return [show(cell.counters[counter]) if counter in cell.counters else MISSING for _, counter, show in columns]


def errors_section(comparison, heading, introduction, error, uncertainty):
    """Shows the counter `error`, the largest over the formulations: one row for each n, one column for each s.

    Nothing is shown for a run that was not compared with reference solutions.
    """
    if not comparison.has_counter(error):
        return []
    def largest(n, stages, counter, digits):
        found = [cell.counters[counter] for s in stages for cell in comparison.block(n, s).values()
                 if not cell.failure and counter in cell.counters]
        return f"{max(found):.{digits}g}" if found else MISSING

    rows = [[str(n), *(largest(n, (stages,), error, 2) for stages in comparison.stages),
             largest(n, comparison.stages, uncertainty, 1)] for n in comparison.sizes()]
    columns = (Column("n"), *(Column(f"s = {stages}") for stages in comparison.stages), Column("reference good to"))
    return [Heading(heading), Paragraph(introduction), plain_table(columns, rows)]


# ---- measurement conditions

PACKAGED = ("library build type: of Google Benchmark as the distribution packaged it; it says nothing of the code"
            " measured here.")
# A file says more: whose machine it was is nobody's business.
CONDITIONS = ("date", "commit", "dirty", "build_type", "compiler", "flags", "cpu", "num_cpus", "mhz_per_cpu",
              "vector_units", "load_average", "blas_library", "blas_kernels", "blas_threads", "environment", "products", "product_rate",
              "peak_gflops", "tolerance", "norm", "start", "update_order", "hbar", "modes_hash", "notice",
              "library_build_type")


def conditions_section(context):
    """Lists under what conditions the run was made."""
    return [Heading("Measurement conditions"),
            Items([(name.replace("_", " "), f": {context.get(name, 'not recorded') or 'none'}")
                   for name in CONDITIONS]),
            Paragraph(PACKAGED)]
