"""The paper's Table 1: its layout, its published seconds, and its claims about who is faster, judged block by block.

A claim holds or does not hold only where the exact rank test separates our repetitions; medians alone decide nothing.
"""

import os
from typing import Callable, NamedTuple, Tuple

from lib.formats import FORMULATIONS, read_run
from lib.comparison import (MISSING, Comparison, check_layout, conditions_section, counters_section, errors_section,
                        percentage, read_published, three_digits)
from lib.document import Column, Heading, Paragraph, plain_table
from lib.statistics_of_repetitions import FASTER, FEWEST_REPETITIONS, LEVEL, SLOWER, compare, median

PUBLISHED = os.path.join(os.path.dirname(os.path.realpath(__file__)), os.pardir, os.pardir, "results", "paper",
                         "table1.csv")
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
OUTCOMES = HOLDS, FAILS, OPEN, UNJUDGED = "holds", "does not hold", "too close to call", "not judged"


def beside_the_paper(path, program, counters=COUNTERS, table=None):
    """Returns the Comparison of a table in the raw file of a program with the published seconds."""
    run = read_run(path, program, counters, OPTIONAL_COUNTERS, table)
    check_layout(path, run)
    return Comparison(run, read_published(PUBLISHED))


def closing_sections(comparison, counters):
    """Errors, these counters, the paper's claims, and the conditions of measurement."""
    columns = [(heading, counter, show) for counter, (heading, show) in COUNTER_COLUMNS.items() if counter in counters
               and (counter not in OPTIONAL_COUNTERS or comparison.has_counter(counter))]
    return [
        *errors_section(comparison),
        *counters_section(comparison, columns),
        *claims_section(comparison),
        *conditions_section(comparison.run.context),
    ]


# ---- claims


class Claim(NamedTuple):
    """A statement about every block with these numbers of stages.

    `pairs(times)` gets the repetitions of a block by row, and returns the pairs (faster row, slower row) that the claim
    asserts: the slower takes more than `factor` times as long.
    """

    label: str
    statement: str
    stages: Tuple[int, ...]
    pairs: Callable
    factor: float = 1


class Verdict(NamedTuple):
    n: int
    stages: int
    outcome: str
    evidence: Tuple = ()  # (faster row, slower row, ratio of their medians, p)


def fastest(winner):
    """Returns the pairs of "`winner` is the fastest row"."""
    return lambda times: [(winner, rival) for rival in times if rival != winner]


def slower_than_all(loser):
    """Returns the pair of "`loser` takes longer than the fastest other row"."""
    return lambda times: [(min((name for name in times if name != loser), key=lambda name: median(times[name])), loser)]


# The paper calls algebra "really poor" at 2.5 to 3.9 times the fastest row; twice is the mildest fair reading.
CLAIMS = (
    Claim("a", "at s = 1 algebra is fastest", (1,), fastest("algebra")),
    Claim("b", "at s ≥ 2 group is fastest", (2, 3), fastest("group")),
    Claim("c", "algebra is really poor for large n and s = 3 (at least twice the time of the fastest row)", (3,),
          slower_than_all("algebra"), factor=2),
)


def verdicts(claim, comparison):
    return [verdict(claim, comparison, n, stages) for n in comparison.sizes() for stages in claim.stages]


def verdict(claim, comparison, n, stages):
    """Judges one block, where all its rows have times. A pair the other way round refutes the claim."""
    times = comparison.run.times(n, stages)
    if len(times) < len(FORMULATIONS):
        return Verdict(n, stages, UNJUDGED)
    evidence, found = [], set()
    for faster, slower in claim.pairs(times):
        outcome, p = compare([claim.factor * time for time in times[faster]], times[slower])
        evidence.append((faster, slower, median(times[slower]) / median(times[faster]), p))
        found.add(outcome)
    outcome = FAILS if SLOWER in found else HOLDS if found == {FASTER} else OPEN
    return Verdict(n, stages, outcome, tuple(evidence))


def overall(judged):
    """Sums up the verdicts on a claim: for each outcome that occurs, where."""
    parts = []
    for outcome in OUTCOMES:
        for stages in sorted({each.stages for each in judged}):
            sizes = [str(each.n) for each in judged if (each.outcome, each.stages) == (outcome, stages)]
            if sizes:
                parts.append(f"{outcome} at n = {', '.join(sizes)} (s = {stages})")
    return "; ".join(parts)


def claims_section(comparison):
    parts = [Heading("The paper's claims"),
             Paragraph("Ratio: median time of the second row over that of the first. p: exact one-sided Mann–Whitney"
                       f" rank test of the repetitions, in the direction they lean; decided where p ≤ {LEVEL}, with at"
                       f" least {FEWEST_REPETITIONS} repetitions. Not judged: a row failed or was not measured.")]
    columns = (Column("n"), Column("s"), Column("verdict", align="left"), Column("first", align="left"),
               Column("second", align="left"), Column("ratio"), Column("p"))
    for claim in CLAIMS:
        judged = verdicts(claim, comparison)
        rows = [[str(each.n), str(each.stages), each.outcome, faster, slower, *texts]
                for each in judged
                for faster, slower, *texts in ([(*pair[:2], *map(three_digits, pair[2:])) for pair in each.evidence]
                                               or [[MISSING] * 4])]
        parts += [Heading(f"Claim ({claim.label}): {claim.statement}", 3), Paragraph(f"Overall: {overall(judged)}."),
                  plain_table(columns, rows)]
    return parts
