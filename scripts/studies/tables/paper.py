"""The paper's Table 1: its layout, its published seconds, and the sections on its claims."""

import os

from lib.programs.places import ROOT
from lib.records.table_file import read_run
from lib.pages.document import Column, Heading, Items, Paragraph, plain_table
from lib.pages.numbers import MISSING, percentage, three_digits
from studies.tables.comparison import (Comparison, check_layout, conditions_section, counters_section, errors_section,
                                       ratio_text, read_published, verdict_rules)
from studies.tables.judge import CLAIMS, judged, pairs

PUBLISHED = os.path.join(ROOT, "results", "paper", "table1.csv")
COUNTERS = ("sweeps_per_step", "products", "poisson_solves", "spectrum_error", "skew_defect", "energy_error",
            "h_norm_B", "product_share")
# Only a run that was given reference solutions has these.
OPTIONAL_COUNTERS = ("relative_error", "reference_uncertainty")
# Heading and how to write it, by counter.
COUNTER_COLUMNS = {
    "sweeps_per_step": ("sweeps/step", three_digits), "equivalent_products": ("full products", three_digits),
    "relative_error": ("error at T", three_digits), "spectrum_error": ("spectrum error", three_digits),
    "product_share": ("product share", percentage), "skew_defect": ("skew defect", three_digits),
    "energy_error": ("energy error", three_digits), "h_norm_B": ("h‖B‖", three_digits),
}


def beside_the_paper(path, table, counters=COUNTERS):
    """Returns the Comparison of "table1" or "table2" in a raw file with the published seconds.

    The program table2 writes the rows of table1 too, if it is asked to.
    """
    run = read_run(path, ("table1", "table2") if table == "table1" else ("table2",), counters, OPTIONAL_COUNTERS, table)
    check_layout(path, run)
    return Comparison(run, read_published(PUBLISHED))


def closing_sections(comparison, counters):
    """Errors, these counters, verdicts on the paper's claims and on all pairs of rows, and the conditions."""
    columns = [(heading, counter, show) for counter, (heading, show) in COUNTER_COLUMNS.items() if counter in counters
               and (counter not in OPTIONAL_COUNTERS or comparison.has_counter(counter))]
    return [
        *errors_section(comparison),
        *claims_section(comparison),
        *pairs_section(comparison),
        *counters_section(comparison, columns),
        *conditions_section(comparison.run.context),
    ]


def claims_section(comparison):
    """Shows for each n, claim and s whether the claim holds, and by which ratio."""
    cases = [(claim, stages) for claim in CLAIMS for stages in claim.stages]
    found = {(each.claim.label, each.stages, each.n): f"{each.result}, {three_digits(each.ratio.ratio)}"
             for n in comparison.sizes() for each in judged(comparison.run, n)}
    rows = [[str(n), *(found.get((claim.label, stages, n), MISSING) for claim, stages in cases)]
            for n in comparison.sizes()]
    columns = (Column("n"), *(Column(f"({claim.label}), s = {stages}", align="left") for claim, stages in cases))
    return [Heading("The paper's claims"),
            Items([(f"({claim.label})", f" s = {', '.join(map(str, claim.stages))}: {claim.statement}.")
                   for claim in CLAIMS]),
            Paragraph("Ratio: for (a) and (b) the time of the fastest other row over that of the row that is said to be"
                      " fastest; for (c) the time of algebra over that of the fastest other row. (a) and (b) hold if"
                      " that row is faster than both others, are a tie if it ties with one and is slower than none, and"
                      " fail if it is slower than one; (c) holds above 2 and fails below. " + verdict_rules()),
            plain_table(columns, rows)]


def pairs_section(comparison):
    """Shows every pair of rows of a block."""
    rows = [[str(n), str(each.stages), each.row, each.other, ratio_text(each.ratio), str(each.ratio.processes),
             each.verdict] for n in comparison.sizes() for each in pairs(comparison.run, n)]
    columns = (Column("n"), Column("s"), Column("row", align="left"), Column("against", align="left"), Column("ratio"),
               Column("processes"), Column("verdict", align="left"))
    return [Heading("Every pair of rows"), Paragraph("Ratio: the time of the first row over that of the second."),
            plain_table(columns, rows)]
