"""What the study `accuracy` finds, as records, and the figures for pages, by key.

A key names what was measured, then the problem or n where that varies. What a study has no data for has no key.
"""

import math
import statistics
from collections import Counter
from typing import List, NamedTuple

from lib.records.formats import PUBLISHED, finite, list_of, number, one_of, optional, positive, text, whole
from lib.records.integrators import GAUSS, chosen
from lib.records.settings import SCENES
from lib.judging.verdicts import FASTER, SLOWER, TIE, UNDECIDED
from studies.accuracy.candidates import CLASSES, EXPLICIT
from studies.accuracy.equal_error import (PAIRS, beaten_by, cheapest, frame_gains, gauss_forms, headline_problems,
                                          is_few, ratio_in, runs_at_table1_step, tolerances)
from studies.accuracy.schema import CANDIDATES, TABLE_EXPONENTS

# Classes whose spectrum error is told.
WITH_SPECTRUM = ("explicit", "gauss_loose", "gauss_matched", "elp", "elp_matched")
# Methods whose error at Table 1's step is told against n, in the co-rotating frame and not; new ones are added.
AGAINST_N = ("group1", "group2", "group3", "group4", "elp2", "elp4", "elp6", "magnus5", "rkmk4", "rk4", "rk8")
SAID = (FASTER, SLOWER, TIE, UNDECIDED)


class ProblemSolved(NamedTuple):
    scene: one_of(*SCENES)
    time: positive
    n: whole(2)
    uncertainty: positive  # of its reference solution, relative


class Best(NamedTuple):
    """The method that stands for a class (candidates.py) at one error of one problem, and what it takes."""

    scene: one_of(*SCENES)
    time: positive
    n: whole(2)
    wanted: positive  # the error
    candidate: one_of(*CANDIDATES)  # the class
    integrator: text
    order: whole(1)
    steps: whole(1)
    seconds: positive  # CPU time of the run
    spectrum_error: number


class Comparison(NamedTuple):
    """The time of the best method of one class over that of another at equal error, in fresh processes."""

    scene: one_of(*SCENES)
    time: positive
    n: whole(2)
    wanted: positive
    first: one_of(*CANDIDATES)
    second: one_of(*CANDIDATES)
    ratio: positive
    verdict: one_of(*SAID)  # on the first
    products_ratio: optional(positive)  # of equivalent products, where both are published forms


class BestExplicit(NamedTuple):
    """The best explicit method at one error of one problem, and which classes are faster by the verdict."""

    scene: one_of(*SCENES)
    time: positive
    n: whole(2)
    wanted: positive
    integrator: text
    beaten_by: list_of(one_of(*CANDIDATES))  # the fastest first


class GaussOrder(NamedTuple):
    """The order of the cheapest Gauss form in the frame at one error, over all problems.

    Problems where no form reaches the error, or where a line was cut that might be the cheapest, do not count.
    """

    wanted: positive
    minimum: whole(1)
    median: finite  # halfway between two orders, or one
    largest: whole(1)
    problems: whole(1)


class FrameGain(NamedTuple):
    """The time of a Gauss method over its time in the co-rotating frame at equal error, smooth scene to T = 5."""

    integrator: text
    n: whole(2)
    wanted: positive
    gain: positive


class ErrorAtTable1Step(NamedTuple):
    """The error at Table 1's step, smooth scene to T = 5."""

    integrator: text
    n: whole(2)
    error: positive


class LoosestTolerance(NamedTuple):
    """The loosest tolerance that does no harm to a cell of Table 1 by its published form, against 1e-13."""

    integrator: text
    n: whole(2)
    tolerance: positive
    spectrum_error: number
    tight_spectrum_error: number  # at 1e-13
    gain: positive  # the time at 1e-13 over that at the loosest


class Findings(NamedTuple):
    problems: List[ProblemSolved]
    best: List[Best]
    comparisons: List[Comparison]
    best_explicit: List[BestExplicit]
    gauss_order: List[GaussOrder]
    frame_gains: List[FrameGain]
    errors: List[ErrorAtTable1Step]
    tolerances: List[LoosestTolerance]


def findings(study):
    """Returns the Findings of an Accuracy."""
    return Findings([ProblemSolved(*problem, study.references[problem].uncertainty) for problem in study.problems()],
                    best_of_classes(study), comparisons(study), best_explicit(study), gauss_orders(study),
                    gains_of_the_frame(study), errors_at_table1_step(study),
                    [LoosestTolerance(loosest.integrator, loosest.n, loosest.tolerance, loosest.spectrum_error,
                                      usual.spectrum_error, usual.seconds / loosest.seconds)
                     for loosest, usual in tolerances(study)])


def best_of_classes(study):
    return [Best(*problem, wanted, candidate, row.integrator, study.integrators[row.integrator].order, row.steps,
                 row.seconds, row.spectrum_error)
            for (problem, wanted), comparison in study.comparisons.items() for candidate, row in comparison.items()]


def comparisons(study):
    found = []
    for (problem, wanted), comparison in study.comparisons.items():
        for first, second in PAIRS:
            if result := ratio_in(comparison, first, second):
                ratio, said = result
                products = None
                if CLASSES[first].solver == CLASSES[second].solver == PUBLISHED:
                    products = comparison[first].equivalent_products / comparison[second].equivalent_products
                found.append(Comparison(*problem, wanted, first, second, ratio.ratio, said, products))
    return found


def best_explicit(study):
    return [BestExplicit(*problem, wanted, comparison[EXPLICIT].integrator, beaten_by(comparison))
            for (problem, wanted), comparison in study.comparisons.items() if EXPLICIT in comparison]


def gauss_orders(study):
    found = []
    for wanted in (10.0**exponent for exponent in TABLE_EXPONENTS):
        best = [cheapest(study, problem, wanted, gauss_forms(study)) for problem in study.problems()]
        orders = [study.integrators[form.integrator].order for form, _ in filter(None, best)]
        if orders:
            found.append(GaussOrder(wanted, min(orders), statistics.median(orders), max(orders), len(orders)))
    return found


def gains_of_the_frame(study):
    return [FrameGain(name, problem.n, 10.0**exponent, gain)
            for name, gains in frame_gains(study, headline_problems(study)).items()
            if name in study.integrators and study.integrators[name].family == GAUSS
            for (problem, exponent), gain in gains.items()]


def told_against_n(integrators):
    """Returns those of some Integrators whose error at Table 1's step is told, by name: each, then in the frame."""
    plain = chosen(integrators, AGAINST_N)
    framed = {each.method: each for each in integrators if each.co_rotating}
    return {each.name: each for method in plain for each in (plain[method], framed.get(method)) if each}


def errors_at_table1_step(study):
    return [ErrorAtTable1Step(name, run.n, run.error) for name in told_against_n(study.integrators.values())
            for run in runs_at_table1_step(study, name)]


# ---- figures


def figures(found):
    """Returns the figures by key, given the Findings."""
    return {"problems": len(found.problems), **best_figures(found.best), **comparison_figures(found.comparisons),
            **explicit_figures(found.best_explicit), **order_figures(found.gauss_order),
            **frame_figures(found.frame_gains), **tolerance_figures(found.tolerances),
            **{f"error.{each.integrator}.n{each.n}": each.error for each in found.errors}}


def at_error(wanted):
    """Returns the part of a key that names an error, as at_1e-6."""
    return f"at_1e{round(math.log10(wanted))}"


def place_of(finding):
    """Returns the end of the key of what was found at one error of one problem, as smooth_t5.n129.at_1e-6."""
    return f"{finding.scene}_t{finding.time:g}.n{finding.n}.{at_error(finding.wanted)}"


def best_figures(best):
    """CPU seconds, steps and order of the best of each class, the spectrum error of some; how many take few steps."""
    found = {"rows": len(best), "rows.of_few_steps": sum(map(is_few, best))}
    for each in best:
        names = ("seconds", "steps", "order") + ("spectrum_error",) * (each.candidate in WITH_SPECTRUM)
        found |= {f"{name.removesuffix('_error')}.{each.candidate}.{place_of(each)}": getattr(each, name)
                  for name in names}
    return found


def comparison_figures(compared):
    """Ratios of times, and how often the verdict says what; of published forms, ratios of products."""
    found, counts = {}, {}
    for each in compared:
        pair = f"{each.first}_over_{each.second}"
        found[f"{pair}.{place_of(each)}"] = each.ratio
        if each.products_ratio:
            found[f"{pair}.products.{place_of(each)}"] = each.products_ratio
        counts.setdefault(pair, Counter(dict.fromkeys(SAID, 0))).update([each.verdict, "comparisons"])
    return found | {f"{pair}.{said}": count for pair, said_of in counts.items() for said, count in said_of.items()}


def explicit_figures(best):
    """At each error, in how many comparisons no class is faster than the best explicit method, and which that is."""
    found = Counter()
    for each in best:
        error = at_error(each.wanted)
        found.update({f"explicit_fastest.{error}": int(not each.beaten_by), f"explicit_fastest.{error}.comparisons": 1,
                      f"best_explicit.{error}.{each.integrator}": 1})
    return found


def order_figures(orders):
    return {f"gauss_order.{at_error(each.wanted)}.{name}": value for each in orders
            for name, value in (("min", each.minimum), ("median", each.median), ("largest", each.largest),
                                ("problems", each.problems))}


def frame_figures(gains):
    return {"frame_gain": statistics.geometric_mean(each.gain for each in gains),
            "frame_gain.comparisons": len(gains)} if gains else {}


def tolerance_figures(loosest):
    """The loosest tolerance by cell; over all cells, what it costs the spectrum and saves; spectrum errors at 1e-13."""
    if not loosest:
        return {}
    return {**{f"tolerance.{each.integrator}.n{each.n}": each.tolerance for each in loosest},
            "tolerance.spectrum_error": max(each.spectrum_error for each in loosest),
            "tolerance.spectrum_error.at_1e-13": max(each.tight_spectrum_error for each in loosest),
            "tolerance.time": statistics.geometric_mean(each.gain for each in loosest),
            **{f"spectrum_error.{each.integrator}.n{each.n}": each.tight_spectrum_error for each in loosest}}
