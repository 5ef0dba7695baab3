"""Claims of a paper about which row is faster, judged by our repetitions, block by block.

A claim holds or does not hold only where the exact rank test separates the rows; medians alone decide nothing.
"""

from dataclasses import dataclass
from typing import Callable, Tuple

from comparison import block_name, three_digits
from document import Heading, Item, Items, Paragraph
from statistics_of_repetitions import FASTER, FEWEST_REPETITIONS, LEVEL, SLOWER, compare, median

HOLDS, FAILS, OPEN, UNJUDGED = "holds", "does not hold", "too close to call", "not judged"


@dataclass(frozen=True)
class Claim:
    """A statement about every block with these numbers of stages, and the function that judges one block.

    `judge(times, published)` gets the repetitions and the published seconds by formulation, and returns
    (outcome, evidence).
    """

    label: str
    statement: str
    stages: Tuple[int, ...]
    judge: Callable


@dataclass(frozen=True)
class Verdict:
    n: int
    stages: int
    outcome: str
    reason: str = ""
    evidence: str = ""


def fastest(winner):
    """Returns the judge of "`winner` is the fastest row": it must beat each rival; one that beats it refutes."""
    def judge(times, _published):
        rivals = {name: compare(times[winner], times[name]) for name in times if name != winner}
        decisions = {rival.outcome for rival in rivals.values()}
        outcome = FAILS if SLOWER in decisions else HOLDS if decisions == {FASTER} else OPEN
        evidence = [f"{name} takes {three_digits(median(times[name]) / median(times[winner]))} times as long as"
                    f" {winner} (p = {three_digits(rival.p)})" for name, rival in rivals.items()]
        return outcome, "; ".join(evidence)
    return judge


def slower_by(factor, loser):
    """Returns the judge of "`loser` takes at least `factor` times as long as the fastest other row"."""
    def judge(times, published):
        best = min((name for name in times if name != loser), key=lambda name: median(times[name]))
        test = compare([factor * time for time in times[best]], times[loser])
        outcome = {FASTER: HOLDS, SLOWER: FAILS}.get(test.outcome, OPEN)
        ratio = three_digits(median(times[loser]) / median(times[best]))
        return outcome, (f"{loser} takes {ratio} times as long as {best}, the fastest other row"
                         f" (against {factor} times: p = {three_digits(test.p)}{published_ratio(loser, published)})")
    return judge


def published_ratio(loser, published):
    others = [seconds for name, seconds in published.items() if name != loser]
    if loser not in published or not others:
        return ""
    return f"; paper: {three_digits(published[loser] / min(others))} times"


def verdicts(claim, comparison):
    return [verdict(claim, comparison, n, stages) for n in comparison.sizes() for stages in claim.stages]


def verdict(claim, comparison, n, stages):
    """Judges one block, where all its rows have times, and enough of them."""
    obstacle = why_unjudged(comparison, n, stages)
    if obstacle:
        return Verdict(n, stages, UNJUDGED, f": {obstacle}")
    times = comparison.times(n, stages)
    outcome, evidence = claim.judge(times, comparison.published_block(n, stages))
    fewest = min(map(len, times.values()))
    if fewest < FEWEST_REPETITIONS:
        unit = "repetition" if fewest == 1 else "repetitions"
        return Verdict(n, stages, OPEN, f" ({fewest} {unit}; {FEWEST_REPETITIONS} needed)", evidence)
    return Verdict(n, stages, outcome, "", evidence)


def why_unjudged(comparison, n, stages):
    block = comparison.block(n, stages)
    if not block:
        return "not measured"
    missing = [f"{name} not measured" for name in comparison.formulations if name not in block]
    failed = [f"{name} failed: {cell.failure}" for name, cell in block.items() if cell.failure]
    return "; ".join(missing + failed)


def overall(judged):
    """Sums up the verdicts on a claim: for each outcome that occurs, where."""
    many_stages = len({each.stages for each in judged}) > 1
    parts = [f"{outcome} at {places(alike, many_stages)}" for outcome in (HOLDS, FAILS, OPEN, UNJUDGED)
             if (alike := [each for each in judged if each.outcome == outcome])]
    return "; ".join(parts)


def places(judged, many_stages):
    """Names blocks shortly: sizes with the same numbers of stages together, and these only where they vary."""
    stages_of, sizes_of = {}, {}
    for each in judged:
        stages_of.setdefault(each.n, []).append(str(each.stages))
    for n, stages in stages_of.items():
        sizes_of.setdefault(", ".join(stages), []).append(str(n))
    return " and ".join(f"n = {', '.join(sizes)}" + (f" (s = {stages})" if many_stages else "")
                        for stages, sizes in sizes_of.items())


def claims_section(claims, comparison):
    parts = [Heading("The paper's claims"),
             Paragraph(f"p: exact one-sided Mann–Whitney rank test of the repetitions, in the direction they lean;"
                       f" decided where p ≤ {LEVEL}. Ratios are of medians.")]
    for claim in claims:
        judged = verdicts(claim, comparison)
        parts += [Heading(f"Claim ({claim.label}): {claim.statement}", 3),
                  Paragraph(f"Overall: {overall(judged)}."), Items([verdict_item(each) for each in judged])]
    return parts


def verdict_item(judged):
    strong = f"{block_name(judged.n, judged.stages)}: {judged.outcome}"
    evidence = f" – {judged.evidence}" if judged.evidence else ""
    return Item(strong, judged.reason + evidence)
