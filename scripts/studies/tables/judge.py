"""The paper's claims about who is faster, and every pair of rows of a table, judged block by block.

A block is what is compared: the formulations at one n and one number of stages.
"""

import itertools
import math
from typing import Callable, NamedTuple, Tuple

from lib.records.formats import FORMULATIONS
from lib.judging.verdicts import Ratio, claim_of_fastest, claim_of_multiple, fastest, ratio_of, verdict

# The paper calls algebra "really poor" at 2.5 to 3.9 times the fastest row; twice is the mildest fair reading.
POOR = 2.0


COUNTED = ("products", "equivalent_products", "product_share")  # counters that are figures


class Claim(NamedTuple):
    """A statement about every block with these numbers of stages; `judge(times)` returns its result and its Ratio."""

    label: str
    statement: str
    stages: Tuple[int, ...]
    judge: Callable


CLAIMS = (
    Claim("a", "algebra is fastest", (1,), lambda times: claim_of_fastest("algebra", times)),
    Claim("b", "group is fastest", (2, 3), lambda times: claim_of_fastest("group", times)),
    Claim("c", "algebra takes more than twice the time of the fastest other row, our reading of “really poor”", (3,),
          lambda times: claim_of_multiple("algebra", POOR, times)),
)


class Judged(NamedTuple):
    """A claim at one n and s."""

    claim: Claim
    n: int
    stages: int
    result: str
    ratio: Ratio


class Pair(NamedTuple):
    """A row's time against another's."""

    n: int
    stages: int
    row: str
    other: str
    ratio: Ratio
    verdict: str


def stage_counts(run):
    return sorted({key.stages for key in run.measurements})


def sizes(run):
    return sorted({key.n for key in run.measurements})


def pairs(run, n):
    """Returns the Pairs of all blocks at n, in the order of the table."""
    found = []
    for stages in stage_counts(run):
        times = run.times(n, stages)
        for row, other in itertools.combinations([name for name in FORMULATIONS if name in times], 2):
            ratio = ratio_of(times[row], times[other])
            found.append(Pair(n, stages, row, other, ratio, verdict(ratio)))
    return found


def judged(run, n):
    """Returns every claim on the blocks at n in which all rows have times."""
    blocks = ((claim, stages, run.times(n, stages)) for claim in CLAIMS for stages in claim.stages)
    return [Judged(claim, n, stages, *claim.judge(times)) for claim, stages, times in blocks
            if len(times) == len(FORMULATIONS)]


def block_verdicts(run, n):
    """Returns what is said of pairs and claims at n, as a set: with UNDECIDED in it, further processes are wanted."""
    return {each.verdict for each in pairs(run, n)} | {each.result for each in judged(run, n)}


def verdict_data(runs):
    """Returns what verdicts.json holds of some runs, a dict by implementation: "published" or "fast"."""
    data = {"verdicts": [], "claims": []}
    for implementation, run in runs.items():
        for n in sizes(run):
            data["verdicts"] += [{"n": n, "s": each.stages, "implementation": implementation, "row": each.row,
                                  "other": each.other, **interval(each.ratio), "verdict": each.verdict}
                                 for each in pairs(run, n)]
            data["claims"] += [{"claim": each.claim.label, "n": n, "s": each.stages, "implementation": implementation,
                                **interval(each.ratio), "result": each.result} for each in judged(run, n)]
    return data


def interval(found):
    """Returns a Ratio as JSON holds it; where there is no interval, its ends are null."""
    return {"ratio": found.ratio, "low": found.low if found.low > 0 else None,
            "high": found.high if math.isfinite(found.high) else None, "processes": found.processes}


def figures(runs):
    """Returns figures by key of some runs, a dict by code: ratios of rows at each s and n, and their range over n.

    Keys are such as plain.s3.algebra_over_group.n129, and .min and .max over n in place of n129. There are also the
    ratios of the fastest rows, gain.s3.n129, the time of plain code over that of optimised code, and what a run took,
    such as plain.s3.group.products.n129.
    """
    found = {}
    for code, run in runs.items():
        found |= figures_of(code, run)
    found |= {f"gain.s{stages}.{at}": ratio for stages in stage_counts(runs["plain"])
              for at, ratio in gains(runs["plain"], runs["optimised"], stages).items()}
    return found


def figures_of(code, run):
    """Returns the figures of one run, as figures() has them."""
    found = {f"{code}.s{key.stages}.{key.formulation}.{name}.n{key.n}": cell.counters[name]
             for key, cell in run.measurements.items() for name in COUNTED if name in cell.counters}
    for stages in stage_counts(run):
        for row, other in itertools.permutations(FORMULATIONS, 2):
            times = {n: run.times(n, stages) for n in sizes(run)}
            ratios = {f"n{n}": ratio_of(block[row], block[other]).ratio for n, block in times.items()
                      if {row, other} <= block.keys()}
            if ratios:
                ratios |= {"min": min(ratios.values()), "max": max(ratios.values())}
            found |= {f"{code}.s{stages}.{row}_over_{other}.{at}": ratio for at, ratio in ratios.items()}
    return found


def gains(plain, optimised, stages):
    """Returns the time of the fastest plain row over that of the fastest optimised one, by n, and its range."""
    blocks = ((n, plain.times(n, stages), optimised.times(n, stages)) for n in sizes(plain))
    found = {f"n{n}": ratio_of(slow[fastest(slow)], quick[fastest(quick)]).ratio for n, slow, quick in blocks
             if slow and quick}
    return found | ({"min": min(found.values()), "max": max(found.values())} if found else {})
