"""The figures of a study of accuracy, by key; results/README.md says what they mean.

A key names what was measured, then the problem or n where that varies. What a study has no data for has no key.
"""

import collections
import math
import statistics

from lib.records.formats import PUBLISHED
from lib.records.integrators import GAUSS, chosen
from lib.judging.verdicts import FASTER, SLOWER, TIE, UNDECIDED
from studies.accuracy.candidates import CLASSES, EXPLICIT
from studies.accuracy.equal_error import (PAIRS, beaten_by, cheapest, duel_errors, frame_gains, gauss_forms,
                                          headline_problems, is_few, ratio_in, runs_at_table1_step, tolerances)
from studies.accuracy.schema import TABLE_EXPONENTS

# Classes whose spectrum error is told.
WITH_SPECTRUM = ("explicit", "gauss_loose", "gauss_matched", "elp", "elp_matched")
# Methods whose error at Table 1's step is told against n, in the co-rotating frame and not; new ones are added.
AGAINST_N = ("group1", "group2", "group3", "group4", "elp2", "elp4", "elp6", "magnus5", "rkmk4", "rk4", "rk8")


def told_against_n(integrators):
    """Returns those of some Integrators whose error at Table 1's step is told, by name: each, then in the frame."""
    plain = chosen(integrators, AGAINST_N)
    framed = {each.method: each for each in integrators if each.co_rotating}
    return {each.name: each for method in plain for each in (plain[method], framed.get(method)) if each}


def figures(study):
    """Returns the figures by key."""
    return {"problems": len(study.problems()), **duel_times(study), **duel_ratios(study), **order(study),
            **frame(study), **error_at_table1_step(study), **tolerance(study), **spectrum(study)}


def name_of(problem, wanted):
    """Returns the end of the key of a duel's figure, as smooth_t5.n129.at_1e-6."""
    return f"{problem.scene}_t{problem.time:g}.n{problem.n}.at_1e{round(math.log10(wanted))}"


def duel_times(study):
    """CPU seconds and steps of the rows of duels, the order of the method that stands for a class, and the spectrum
    error of some; how many rows take few steps; in how many duels of an error no class is faster than the best explicit
    method, and how often that is which one.
    """
    found = {"rows": sum(map(len, study.duels.values())),
             "rows.of_few_steps": sum(is_few(row) for duel in study.duels.values() for row in duel.values())}
    for key, duel in study.duels.items():
        for contender, row in duel.items():
            found[f"seconds.{contender}.{name_of(*key)}"] = row.seconds
            found[f"steps.{contender}.{name_of(*key)}"] = row.steps
            found[f"order.{contender}.{name_of(*key)}"] = study.integrators[row.integrator].order
            if contender in WITH_SPECTRUM:
                found[f"spectrum.{contender}.{name_of(*key)}"] = row.spectrum_error
    for wanted in duel_errors(study):
        duels = [duel for (_, error), duel in study.duels.items() if error == wanted and EXPLICIT in duel]
        error = f"at_1e{round(math.log10(wanted))}"
        found[f"explicit_fastest.{error}"] = sum(not beaten_by(duel) for duel in duels)
        found[f"explicit_fastest.{error}.duels"] = len(duels)
        for name, times in collections.Counter(duel[EXPLICIT].integrator for duel in duels).items():
            found[f"best_explicit.{error}.{name}"] = times
    return found


def duel_ratios(study):
    """Ratios of times in duels, and in how many duels the verdict says what; of published forms, ratios of products."""
    found, counts = {}, {}
    for key, duel in study.duels.items():
        for first, second in PAIRS:
            pair, result = f"{first}_over_{second}", ratio_in(duel, first, second)
            if not result:
                continue
            ratio, said = result
            found[f"{pair}.{name_of(*key)}"] = ratio.ratio
            if CLASSES[first].solver == CLASSES[second].solver == PUBLISHED:
                found[f"{pair}.products.{name_of(*key)}"] = (duel[first].equivalent_products
                                                             / duel[second].equivalent_products)
            for each in (FASTER, SLOWER, TIE, UNDECIDED):
                counts[f"{pair}.{each}"] = counts.get(f"{pair}.{each}", 0) + (said == each)
            counts[f"{pair}.duels"] = counts.get(f"{pair}.duels", 0) + 1
    return {**found, **counts}


def order(study):
    """The order of the cheapest Gauss form in the frame at an error, over all problems: least, median and largest.

    Problems where no form reaches the error, or where a line was cut that might be the cheapest, do not count.
    """
    found = {}
    for exponent in TABLE_EXPONENTS:
        best = [cheapest(study, problem, 10.0**exponent, gauss_forms(study)) for problem in study.problems()]
        orders = [study.integrators[form.integrator].order for form, _ in filter(None, best)]
        for which, of in (("least", min), ("median", statistics.median), ("largest", max),
                          ("problems", len)) if orders else ():
            found[f"gauss_order.at_1e{exponent}.{which}"] = of(orders)
    return found


def frame(study):
    """Time of Gauss methods over their time in the co-rotating frame, at equal error, smooth scene to T = 5."""
    gains = [gain for name, found in frame_gains(study, headline_problems(study)).items()
             if name in study.integrators and study.integrators[name].family == GAUSS for gain in found.values()]
    return {"frame_gain": statistics.geometric_mean(gains), "frame_gain.comparisons": len(gains)} if gains else {}


def error_at_table1_step(study):
    """The error at Table 1's step, smooth scene to T = 5, by integrator and n."""
    return {f"error.{name}.n{run.n}": run.error for name in told_against_n(study.integrators.values())
            for run in runs_at_table1_step(study, name)}


def tolerance(study):
    """The loosest tolerance that does no harm, by cell; over all cells, what it costs the spectrum and saves."""
    cells = tolerances(study)
    if not cells:
        return {}
    loosest, usual = zip(*cells)
    return {**{f"tolerance.{run.integrator}.n{run.n}": run.tolerance for run in loosest},
            "tolerance.spectrum_error": max(run.spectrum_error for run in loosest),
            "tolerance.spectrum_error.at_1e-13": max(run.spectrum_error for run in usual),
            "tolerance.time": statistics.geometric_mean(tight.seconds / loose.seconds for loose, tight in cells)}


def spectrum(study):
    """The spectrum error at 1e-13 of the published forms, by cell."""
    return {f"spectrum_error.{run.integrator}.n{run.n}": run.spectrum_error for _, run in tolerances(study)}
