"""The figures of a study of accuracy, by key; results/README.md says what they mean.

A key names what was measured, then n where that varies. What a study has no data for has no key.
"""

import statistics

from lib.accuracy_lines import TABLE_EXPONENTS
from lib.equal_error import (cheapest, forms_of, frame_gains, headline_problems, mean, means_by_problem, prices,
                             runs_at_table1_step, tolerances)
from lib.integrator_names import FRAME, frameless, gauss_stages

# Whose error at Table 1's step is told against n, in the co-rotating frame and not.
AGAINST_N = ("group1", "group2", "group3", "group4", "rkmk4", "rk4")


def figures(study):
    """Returns the figures by key."""
    headline = headline_problems(study)
    return {"problems": len(study.problems()), **price(study, headline), **order(study), **frame(study, headline),
            **error_at_table1_step(study), **tolerance(study), **spectrum(study)}


def price(study, headline):
    """Time of the best Gauss form over that of RKMK4 and of RK4 at equal error, smooth scene to T = 5.

    Its mean over the errors at each n and over all, and at 1e-6. Then in how many comparisons on all problems it is
    below 1, and of how many; a ratio whose sides were timed once is counted, too.
    """
    found = {}
    for other, smooth in prices(study, headline).items():
        key = f"gauss_over_{other}"
        found.update({f"{key}.n{problem.n}": each.value for problem, each in means_by_problem(smooth).items()})
        found.update({f"{key}.n{problem.n}.at_1e-6": each.value for (problem, exponent), each in smooth.items()
                      if exponent == -6})
        found.update({f"{key}.mean": mean(smooth.values()).value} if smooth else {})
    for other, everywhere in prices(study, study.problems()).items():
        found[f"gauss_over_{other}.below_1"] = sum(each.value < 1 for each in everywhere.values())
        found[f"gauss_over_{other}.comparisons"] = len(everywhere)
        found[f"gauss_over_{other}.timed_once"] = sum(not each.repeated for each in everywhere.values())
    return found


def order(study):
    """The order of the cheapest Gauss form at an error over all problems: the least, the median and the largest."""
    found = {}
    for exponent in TABLE_EXPONENTS:
        best = [cheapest(study, problem, 10.0**exponent, forms_of(study, "gauss")) for problem in study.problems()]
        orders = [2 * gauss_stages(frameless(each[0])) for each in best if each]
        for which, of in (("least", min), ("median", statistics.median), ("largest", max)) if orders else ():
            found[f"gauss_order.at_1e{exponent}.{which}"] = of(orders)
    return found


def frame(study, headline):
    """Time of Gauss methods over their time in the co-rotating frame, at equal error, smooth scene to T = 5."""
    gains = [each for name, found in frame_gains(study, headline).items() if gauss_stages(name)
             for each in found.values()]
    return {"frame_gain": mean(gains).value, "frame_gain.comparisons": len(gains)} if gains else {}


def error_at_table1_step(study):
    """The error at Table 1's step, smooth scene to T = 5, by integrator and n."""
    return {f"error.{name}.n{run.n}": run.error for each in AGAINST_N for name in (each, each + FRAME)
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
