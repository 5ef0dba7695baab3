"""The paper's claims about who is faster, and every pair of rows of a table, judged block by block.

A block is what is compared: the formulations at one n and one number of stages.
"""

import itertools
import math
from typing import Callable, NamedTuple, Tuple

from lib.formats import FORMULATIONS
from lib.verdicts import Ratio, claim_of_fastest, claim_of_multiple, ratio_of, verdict

# The paper calls algebra "really poor" at 2.5 to 3.9 times the fastest row; twice is the mildest fair reading.
POOR = 2.0


class Claim(NamedTuple):
    """A statement about every block with these numbers of stages; `judge(times)` returns its result and its Ratio."""

    label: str
    statement: str
    stages: Tuple[int, ...]
    judge: Callable


CLAIMS = (
    Claim("a", "at s = 1 algebra is fastest", (1,), lambda times: claim_of_fastest("algebra", times)),
    Claim("b", "at s ≥ 2 group is fastest", (2, 3), lambda times: claim_of_fastest("group", times)),
    Claim("c", "at s = 3 algebra takes more than twice the time of the fastest other row", (3,),
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
