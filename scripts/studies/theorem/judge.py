"""What the study `theorem` finds, as records, and the figures for pages, by key."""

import itertools
import math
import statistics
from collections import Counter
from typing import List, NamedTuple

from lib.records.formats import FORMULATIONS, number, one_of, optional, positive, text, whole
from lib.judging.verdicts import FAILS, HOLDS, TIE, UNDECIDED, claim_of_fastest, ratio_of
from studies.theorem.schema import CHAIN, CLAIMS, PAIRS, End, by, comparisons, times_of


class Agreement(NamedTuple):
    """How the three formulations coincide in one scene, over all n, s and h; errors are the largest."""

    scene: text
    settings: whole(1)
    within: whole()  # settings in which no difference is above its bound
    failed: whole()  # runs of a formulation that failed
    difference: number  # largest entry of the difference of two formulations
    algebra_defect: number
    casimir_error: number


class CostRatio(NamedTuple):
    """The time of one formulation over that of another, one of them group, at one scene, n, h and method."""

    scene: text
    n: whole(2)
    h_norm_B: positive
    method: text
    formulation: one_of(*FORMULATIONS)
    other: one_of(*FORMULATIONS)
    ratio: positive


class ClaimResult(NamedTuple):
    """What became of a claim of the paper at one scene, n, h and method."""

    claim: one_of(*(name for name, *_ in CLAIMS))
    scene: text
    n: whole(2)
    h_norm_B: positive
    method: text
    result: optional(one_of(HOLDS, FAILS, TIE, UNDECIDED))  # None where too few formulations converge


class SweepTime(NamedTuple):
    """What a sweep takes on the spin chain, the geometric mean over methods, formulations and processes."""

    spins: whole(1)
    seconds: positive


class Findings(NamedTuple):
    coincidence: List[Agreement]
    ends: List[End]  # where the theorem ends: single steps with one thing changed
    cost_ratios: List[CostRatio]
    claims: List[ClaimResult]
    chain: List[SweepTime]  # by rising number of spins


def findings(study):
    """Returns the Findings of a Study."""
    tables = study.tables
    return Findings([agreement(scene, rows) for (scene,), rows in by(tables["coincidence"], "scene").items()],
                    tables["ends"], cost_ratios(tables["cost"]),
                    [result for claim in CLAIMS for result in claim_results(*claim, tables)],
                    sweep_times([row for row in tables["cost"] if row.scene == CHAIN and row.seconds]))


def agreement(scene, rows):
    return Agreement(scene, len(rows), sum(row.difference <= row.bound for row in rows),
                     sum(sweeps is None for row in rows for sweeps in row.sweeps),
                     *(max(getattr(row, field) for row in rows) for field in Agreement._fields[-3:]))


def cost_ratios(rows):
    found = []
    for where, block in comparisons(rows).items():
        times = times_of(block)
        found += [CostRatio(*where, form, other, ratio_of(times[form], times[other]).ratio)
                  for form, other in itertools.permutations(times, 2) if "group" in (form, other)]
    return found


def claim_results(claim, table, methods, wanted, tables):
    """Judges one of CLAIMS in all blocks of its table with one of its methods."""
    found = []
    for (*where, method), block in comparisons(tables[table]).items():
        if methods is None or method in methods:
            times = times_of(block)
            is_judged = wanted in times and len(times) > 1
            found.append(ClaimResult(claim, *where, method, claim_of_fastest(wanted, times)[0] if is_judged else None))
    return found


def sweep_times(rows):
    return [SweepTime(n // 2, statistics.geometric_mean(second / row.sweeps for row in found for second in row.seconds))
            for (n,), found in sorted(by(rows, "n").items())]


# ---- figures


def figures(found):
    """Returns the figures that pages may quote, by key, given the Findings.

    cost.SCENE.sS.FORM-over-OTHER.min and .max are the ratio of two formulations' times, one of them group, over all
    n and h. All scenes but the spin chain stand under others too, and these and the chain at one h under others.H and
    spin_chain.H.
    """
    return {**coincidence_figures(found.coincidence), **end_figures(found.ends), **cost_figures(found.cost_ratios),
            **claim_figures(found.claims), **chain_figures(found.chain)}


def key_part(name):
    """Writes a name as part of a key: small ASCII letters and digits, and an underscore for all else between them."""
    plain = "".join(c if c.isascii() and c.isalnum() else " " for c in name.replace("s = ", "s").lower())
    return "_".join(plain.split())


def coincidence_figures(scenes):
    return {f"coincidence.{name}": of(getattr(each, name) for each in scenes)
            for of, names in ((sum, ("settings", "within", "failed")),
                              (max, ("difference", "algebra_defect", "casimir_error"))) for name in names}


def end_figures(ends):
    found = {}
    for end in ends:
        key = f"ends.{key_part(end.case)}"
        found |= {f"{key}.{pair.replace('–', '-')}": end.difference(pair) for pair in PAIRS}
        found |= {f"{key}.casimirs.{form}": end.casimir_error(form) for form in FORMULATIONS}
        found[f"{key}.from_g"] = end.algebra_defect
        if end.order:
            found[f"{key}.order"] = end.order
    return found


def cost_figures(ratios):
    spans = {}
    for each in ratios:
        together = CHAIN if each.scene == CHAIN else "others"
        for over in dict.fromkeys((each.scene, together, f"{together}.{each.h_norm_B:g}")):
            key = f"cost.{over}.{key_part(each.method)}.{each.formulation}-over-{each.other}"
            spans.setdefault(key, []).append(each.ratio)
    return {f"{key}.{which}": of(values) for key, values in spans.items()
            for which, of in (("min", min), ("max", max))}


def claim_figures(results):
    """Counts the results of each claim by scene; `none` where it could not be judged."""
    return Counter(f"claims.{each.claim.strip('()')}.{each.scene}.{said}" for each in results
                   for said in (each.result or "none", "of"))


def chain_figures(times):
    """The power of the number of spins with which the time of a sweep grows, if there are two sizes."""
    if len(times) < 2:
        return {}
    first, last = times[0], times[-1]
    return {"chain.smallest": first.spins, "chain.largest": last.spins,
            "chain.power": math.log(last.seconds / first.seconds, last.spins / first.spins)}
