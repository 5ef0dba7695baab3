"""Claims of a paper about which row is faster, judged by our repetitions, block by block.

A claim holds or does not hold only where the exact rank test separates the rows; medians alone decide nothing.
"""

from typing import Callable, NamedTuple, Tuple

from comparison import MISSING, three_digits
from document import Column, Heading, Paragraph, plain_table
from statistics_of_repetitions import FASTER, FEWEST_REPETITIONS, LEVEL, SLOWER, compare, median

OUTCOMES = HOLDS, FAILS, OPEN, UNJUDGED = "holds", "does not hold", "too close to call", "not judged"


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


def verdicts(claim, comparison):
    return [verdict(claim, comparison, n, stages) for n in comparison.sizes() for stages in claim.stages]


def verdict(claim, comparison, n, stages):
    """Judges one block, where all its rows have times. A pair the other way round refutes the claim."""
    times = comparison.times(n, stages)
    if set(times) != set(comparison.formulations):
        return Verdict(n, stages, UNJUDGED)
    evidence, found = [], set()
    for faster, slower in claim.pairs(times):
        decision = compare([claim.factor * time for time in times[faster]], times[slower])
        evidence.append((faster, slower, median(times[slower]) / median(times[faster]), decision.p))
        found.add(decision.outcome)
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


def claims_section(claims, comparison):
    parts = [Heading("The paper's claims"),
             Paragraph("Ratio: median time of the second row over that of the first. p: exact one-sided Mann–Whitney"
                       f" rank test of the repetitions, in the direction they lean; decided where p ≤ {LEVEL}, with at"
                       f" least {FEWEST_REPETITIONS} repetitions. Not judged: a row failed or was not measured.")]
    columns = (Column("n"), Column("s"), Column("verdict", align="left"), Column("first", align="left"),
               Column("second", align="left"), Column("ratio"), Column("p"))
    for claim in claims:
        judged = verdicts(claim, comparison)
        rows = [[str(each.n), str(each.stages), each.outcome, faster, slower, *texts]
                for each in judged
                for faster, slower, *texts in ([(*pair[:2], *map(three_digits, pair[2:])) for pair in each.evidence]
                                               or [[MISSING] * 4])]
        parts += [Heading(f"Claim ({claim.label}): {claim.statement}", 3), Paragraph(f"Overall: {overall(judged)}."),
                  plain_table(columns, rows)]
    return parts
