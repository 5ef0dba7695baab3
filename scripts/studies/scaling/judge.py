"""Figures of the study `scaling`, by key; results/README.md says what they mean."""

import itertools
import math

from lib.records.formats import FAST, FORMULATIONS, PUBLISHED
from lib.judging.verdicts import ratio_of
from studies.scaling.schema import (BANDS, ROUGH, ABLATIONS, WITH_PRODUCTS, cells, exponential, lie_poisson, slope,
                                    slope_ends)
from studies.threads.judge import thread_figures


def figures(study, rough=None, threads=None):
    """Returns the figures that pages may quote, by key.

    `rough` is None or the Scaling of the rough scene, `threads` None or the Threads of a raw file of its own.

    ABLATION.nN.tT[.FORM] and exponential.ABLATION.nN.tT[.NAME] are gains of the fast forms. step.*, share.* and slope.*
    are of the lines against n: milliseconds, part of the products, power of n; per_time.* seconds a unit of time, whose
    steps differ with n; products.* the equivalent products of a step; rough.* the same of the rough scene. bands.* are
    gains by bands on lines; trend.* tells of all repetitions, single of single timings. threads.* are those of
    thread_figures, and of an older file gains by a second thread with their intervals.
    """
    found = line_figures(study)
    if rough:
        found.update({f"{ROUGH}.{key}": value for key, value in line_figures(rough).items()})
    for start in study.starts():
        found.update(gain_figures(study, start))
    if parts := gains_of_parts(study):
        found["costliest_part"] = max(0.0, 1 / min(parts) - 1)
    for row in study.threads:
        key, ratio = f"threads.{row.integrator}.n{row.n}.t{row.start:g}", ratio_of(row.one, row.two)
        found[key] = ratio.ratio
        if math.isfinite(ratio.high):
            found.update({f"{key}.low": ratio.low, f"{key}.high": ratio.high})
    found.update(thread_figures(threads) if threads else {})
    found.update({f"memory.n{row.n}": row.peak_bytes / 1e9 for row in study.memory})
    found.update({"points": len(study.points), "single": len(study.singles())})
    trend = study.trend()
    return {**found, **({f"trend.{name}": value for name, value in trend._asdict().items()} if trend else {})}


def gains_of_parts(study):
    """Returns what each part gains in the fast form of each formulation, at every start and n."""
    places = [(start, n) for start in study.starts() for n in study.sizes(start)]
    return [gain for place in places for ablation in ABLATIONS if ablation not in (PUBLISHED, FAST)
            for form in FORMULATIONS if (gain := study.gain(*place, ablation, cells((form,))))]


def gain_figures(study, start):
    """Returns the gains of the fast forms from one start, where there are any."""
    groups = {"": cells(), **{f".{form}": cells((form,)) for form in FORMULATIONS}}
    exponential_groups = {"": lie_poisson(study), **{f".{name}": [name] for name in exponential(study)}}
    found = {}
    for n in study.sizes(start):
        where = f"n{n}.t{start:g}"
        for ablation in ABLATIONS:
            if ablation == FAST:
                continue
            key = ablation.replace(" ", "_")
            found.update({f"{key}.{where}{suffix}": study.gain(start, n, ablation, names)
                          for suffix, names in groups.items()})
            found.update({f"exponential.{key}.{where}{suffix}": study.gain(start, n, ablation, names)
                          for suffix, names in exponential_groups.items()})
        for key, ablation in (("bands", BANDS), ("published_line", PUBLISHED)):
            found.update({f"{key}.{where}.{name}": study.gain(start, n, ablation, [name]) for name in study.lines})
    return {key: mean for key, mean in found.items() if mean}


def line_figures(study):
    """Returns what a step costs on each of the lines, and their slopes."""
    found = {}
    for start, name, ablation in itertools.product(study.starts(), study.lines, (PUBLISHED, FAST)):
        line = study.line(start, name, ablation)
        for point in line:
            found.update(step_figures(study, point))
        if ends := slope_ends(line):
            found[f"slope.{name}.{ablation}.n{ends[0].n}_n{ends[1].n}.t{start:g}"] = slope(*ends)
    return found


def step_figures(study, point):
    """Returns the milliseconds of a step, the seconds of a unit of time, and the share of products if it is known.

    From WITH_PRODUCTS on the equivalent products of a step too.
    """
    where, share = f"{point.integrator}.{point.ablation}.n{point.n}.t{point.start:g}", study.share_of_products(point)
    return {f"step.{where}": 1e3 * point.time, f"per_time.{where}": point.time / point.step,
            **({f"products.{where}": point.equivalent_products} if point.n >= WITH_PRODUCTS else {}),
            **({f"share.{where}": share} if share is not None else {})}
