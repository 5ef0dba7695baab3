"""Figures of the study `theorem`, by key; results/README.md says what they mean."""

import itertools
import math
import statistics

from lib.records.formats import FORMULATIONS
from lib.judging.verdicts import claim_of_fastest, ratio_of
from studies.theorem.schema import CHAIN, CLAIMS, PAIRS, by, comparisons, times_of


def figures(study):
    """Returns the figures that results/README.md may quote, by key.

    cost.SCENE.sS.FORM-over-OTHER.least and .most are the ratio of two formulations' times, one of them group, over all
    n and h. All scenes but the spin chain stand under others too, and these and the chain at one h under others.H and
    spin_chain.H.
    """
    tables = study.tables
    rows, found = tables["coincidence"], {}
    found.update({"coincidence.settings": len(rows),
                  "coincidence.within": sum(row.difference <= row.bound for row in rows),
                  "coincidence.failed": sum(sweeps is None for row in rows for sweeps in row.sweeps)})
    for field in ("difference", "algebra_defect", "casimir_error"):
        found[f"coincidence.{field}"] = max(getattr(row, field) for row in rows)
    for row in tables["ends"]:
        key = f"ends.{key_part(row.case)}"
        found.update({f"{key}.{pair.replace('–', '-')}": value for pair, value in zip(PAIRS, row.differences)})
        found.update({f"{key}.casimirs.{form}": value for form, value in zip(FORMULATIONS, row.casimir_errors)})
        found[f"{key}.from_g"] = row.algebra_defect
        if row.order:
            found[f"{key}.order"] = row.order
    found.update(ratio_figures(tables["cost"]))
    for claim, name, methods, wanted in CLAIMS:
        found.update(claim_figures(claim.strip("()"), comparisons(tables[name]), methods, wanted))
    return {**found, **chain_power([row for row in tables["cost"] if row.scene == CHAIN and row.seconds])}


def key_part(name):
    """Writes a name as part of a key: small ASCII letters and digits, and an underscore for all else between them."""
    plain = "".join(c if c.isascii() and c.isalnum() else " " for c in name.replace("s = ", "s").lower())
    return "_".join(plain.split())


def ratio_figures(rows):
    spans = {}
    for (scene, _, norm, method), block in comparisons(rows).items():
        times, method = times_of(block), key_part(method)
        for form, other in (pair for pair in itertools.permutations(times, 2) if "group" in pair):
            pair, ratio = f"{method}.{form}-over-{other}", ratio_of(times[form], times[other]).ratio
            together = CHAIN if scene == CHAIN else "others"
            for over in dict.fromkeys((scene, together, f"{together}.{norm:g}")):
                spans.setdefault(f"cost.{over}.{pair}", []).append(ratio)
    found = {f"{key}.least": min(values) for key, values in spans.items()}
    found.update({f"{key}.most": max(values) for key, values in spans.items()})
    return found


def claim_figures(claim, blocks, methods, wanted):
    """Returns in how many of the blocks a claim comes out how, by scene; `none` where it could not be judged."""
    found = {}
    for (scene, _, _, method), block in blocks.items():
        if methods is None or method in methods:
            times = times_of(block)
            result = claim_of_fastest(wanted, times)[0] if wanted in times and len(times) > 1 else "none"
            for each in (result, "of"):
                key = f"claims.{claim}.{scene}.{each}"
                found[key] = found.get(key, 0) + 1
    return found


def chain_power(rows):
    """Returns the power of N with which the time of a sweep grows on the chain, if there are two sizes."""
    cost = {n: statistics.geometric_mean(second / row.sweeps for row in found for second in row.seconds)
            for (n,), found in sorted(by(rows, "n").items())}
    if len(cost) < 2:
        return {}
    (small, first), *_, (large, last) = cost.items()
    return {"chain.smallest": small // 2, "chain.largest": large // 2,
            "chain.power": math.log(last / first, large / small)}
