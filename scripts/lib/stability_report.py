"""The failure maps and the long runs as a document: charts, critical values, the largest safe step, drift."""

import math
from dataclasses import dataclass
from typing import Tuple

from accuracy_report import listed, scientific
from comparison import MISSING, three_digits
from document import Column, Heading, Paragraph, conditions, plain_table, shown
from drift import EXPONENTIAL, LINEAR, NONE, drift
from integrator_names import joined, others
from stability import QUANTITIES, trials_in_words

PLAIN_SCENE = "smooth"  # whose name the files of its long runs do not bear


@dataclass(frozen=True)
class Chart:
    name: str
    caption: str
    draw: str  # its function in stability_charts, ...
    arguments: Tuple  # ... and what that takes beside the study


def map_charts(failures):
    """Returns the charts of a failure map."""
    charts = []
    for scene in failures.scenes():
        charts.append(Chart(f"failure_map_{scene}", f"Where the formulations of Table 1 fail, {scene} scene: h‖B(W₀)‖₂"
                            " against n, with the measured critical value and linear theory.", "failure_map", (scene,)))
        if others(failures.integrators):
            charts.append(Chart(f"failure_map_others_{scene}", f"Where the other integrators fail, {scene} scene.",
                                "failure_map_others", (scene,)))
    return charts


def fast_map_charts(fast):
    """Returns the charts of a failure map of the fast forms; none where there is no such map."""
    return [Chart(f"failure_map_fast_{scene}", f"Where the fast forms fail, {scene} scene.", "failure_map_fast", (scene,))
            for scene in (fast.scenes() if fast else ())]


def long_run_charts(runs):
    """Returns the charts of long runs; none where there are no runs."""
    charts = []
    for scene, n in runs.settings() if runs else ():
        where = f"n{n}" if scene == PLAIN_SCENE else f"{scene}_n{n}"
        charts.append(Chart(f"long_runs_{where}", f"Errors of long runs at n = {n}, {scene} scene: integrators that keep"
                            " the spectrum.", "long_runs", (scene, n)))
        if any(not each.isospectral for each in runs.integrators.values()):
            charts.append(Chart(f"long_runs_{where}_controls", f"Errors of long runs at n = {n}, {scene} scene:"
                                " integrators that lose the spectrum.", "long_runs_controls", (scene, n)))
    return charts


def stability_sections(failures, runs, charts, level=1, fast=None):
    """Returns the document; `charts` are the names of the charts beside it.

    `runs`, and `fast`, a map of the fast forms, may be None.
    """
    drawn = [*map_charts(failures), *fast_map_charts(fast), *long_run_charts(runs)]
    return [
        Heading("Stability", level),
        Paragraph(introduction(failures, runs)),
        *shown([(each.name, each.caption) for each in drawn], charts),
        *critical_section(failures, level + 1),
        *(fast_section(failures, fast, level + 1) if fast else []),
        *advice_section(failures, runs, level + 1),
        *(drift_section(runs, level + 1) if runs else []),
        conditions(failures.context),
    ]


def introduction(failures, runs):
    grids = [each.trials for each in failures.maps.values()]
    least, most = (pick(trial.h_norm_B for trials in grids for trial in trials) for pick in (min, max))
    text = (f"{len(failures.integrators)} integrators on {' and '.join(scenes_and_sizes(failures.settings))}, in trials with"
            f" h‖B(W₀)‖₂ from {three_digits(least)} to {three_digits(most)}.")
    if runs:
        text += (f" Long runs of {runs.steps} steps at {listed(f'{share:g}' for share in runs.shares())} of the"
                 f" critical step, on {' and '.join(scenes_and_sizes(runs.settings()))}.")
    return text


def scenes_and_sizes(settings):
    """Names settings, each a scene and an n, scene by scene."""
    sizes = {}
    for scene, n in settings:
        sizes.setdefault(scene, []).append(n)
    return [f"the {scene} scene at n = {listed(sorted(found))}" for scene, found in sizes.items()]


def ending(runs, run):
    if run.survived:
        return f"{runs.steps} steps"
    return f"{run.status}" + (f" at step {run.failed_step}" if run.failed_step else f" after {run.steps} steps")


# ---- tables


def critical_section(failures, level):
    parts = [Heading("Critical h‖B(W₀)‖₂", level), Paragraph(
        'The largest h‖B(W₀)‖₂ that works below the first that fails, by bisection; "> x": the largest tried still works,'
        ' "< x": the smallest tried fails. The linear limit is that at the largest n. What the first failure is stands'
        f" last, in the order of n. A trial is of {trials_in_words(failures, failures.scenes())}.")]
    for scene in failures.scenes():
        largest = failures.sizes(scene)[-1]
        parts += critical_table(failures, scene, level + 1,
                                lambda n, name: critical_text(failures.at(scene, n, name)),
                                (Column(f"linear limit, n = {largest}"),
                                 lambda name: limit_text(failures.at(scene, largest, name))))
    return parts


def fast_section(failures, fast, level):
    """Critical values of the published forms beside those of the fast ones."""
    parts = [Heading("Critical h‖B(W₀)‖₂ of the fast forms", level), Paragraph(
        "The same of the fast forms, and in brackets of the published ones, at the tolerance of Table 1. Where a step fails, a"
        " fast form tries it again from a cold start, then by plain sweeps, then with acceleration. A trial is of"
        f" {trials_in_words(fast, fast.scenes())}.")]
    for scene in fast.scenes():
        parts += critical_table(fast, scene, level + 1,
                                lambda n, name: f"{critical_text(fast.at(scene, n, name))}"
                                                f" ({critical_text(failures.at(scene, n, name))})")
    return parts


def critical_table(failures, scene, level, text, *further):
    """One scene's integrators by n: `text(n, name)`, `further` columns with theirs by name, and the ways of failing."""
    sizes = failures.sizes(scene)
    columns = (Column("integrator", align="left"), *(Column(f"n = {n}") for n in sizes),
               *(column for column, _ in further), Column("fails as", align="left"))
    rows = [[name, *(text(n, name) for n in sizes), *(of(name) for _, of in further),
             ways_text(failures.line(scene, name))]
            for name in failures.integrators if failures.line(scene, name)]
    return [Heading(f"{scene.capitalize()} scene", level), plain_table(columns, rows)]


def critical_text(each):
    if each is None:
        return MISSING
    if each.critical:
        return three_digits(each.critical.works.h_norm_B)
    if each.always_works:
        return f"> {three_digits(each.trials[-1].h_norm_B)}"
    return MISSING if each.trials[0].works else f"< {three_digits(each.trials[0].h_norm_B)}"


def limit_text(each):
    return three_digits(each.linear_limit) if each and each.linear_limit else MISSING


def ways_text(line):
    failing = [[trial for trial in (*each.trials, *([each.critical.fails] if each.critical else [])) if not trial.works]
               for each in line]
    ways = [min(trials, key=lambda trial: trial.h_norm_B).status for trials in failing if trials]
    return listed(dict.fromkeys(ways)) or MISSING


# ---- advice


def safe_share(runs, name):
    """Returns the largest share of the critical step up to which every long run of a method lasted; None if none did.

    Where no long run was made of it, the critical step itself is all that is known: 1.
    """
    tried = [run for run in runs.runs if run.integrator == name] if runs else []
    failed = min((run.share for run in tried if not run.survived), default=math.inf)
    return max((run.share for run in tried if run.share < failed), default=None) if tried else 1.0


def safe_constant(failures, runs, scene, name):
    """Returns the c of h ≤ c / ‖B(W₀)‖₂ that holds at every n of a scene, or None."""
    largest = [each.largest_working for each in failures.line(scene, name)]
    share = safe_share(runs, name)
    return None if share is None or not largest or None in largest else share * min(largest)


def safe_step(failures, runs, scene, n, name):
    """Returns the largest safe step at one n, or None."""
    each, share = failures.at(scene, n, name), safe_share(runs, name)
    if each is None or share is None or each.largest_working is None:
        return None
    return share * each.largest_working / failures.settings[scene, n].norm_B


def advice_section(failures, runs, level):
    scene = PLAIN_SCENE if PLAIN_SCENE in failures.scenes() else failures.scenes()[0]
    sizes = failures.sizes(scene)
    columns = (Column("integrator", align="left"), *(Column(f"c, {each}") for each in failures.scenes()),
               Column("share"), *(Column(f"n = {n}", group=f"largest safe h, {scene} scene") for n in sizes))
    rows = [[name, *(number(safe_constant(failures, runs, each, name)) for each in failures.scenes()),
             number(safe_share(runs, name)), *(number(safe_step(failures, runs, scene, n, name)) for n in sizes)]
            for name in failures.integrators]
    norms = listed(f"{three_digits(failures.settings[scene, n].norm_B)} at n = {n}" for n in sizes)
    return [Heading("The largest safe step", level),
            Paragraph(f"Take h ≤ c / ‖B(W₀)‖₂. ‖B(W₀)‖₂ is in the {scene} scene {norms}. c is a share of the largest"
                      " h‖B(W₀)‖₂ that works, at the n where that is least; the steps at each n are by its own value."
                      + share_text(failures, runs) + f' "{MISSING}": no step is known to be safe. Other scenes fail'
                      " elsewhere: where they are rougher than both, try a few steps first."), plain_table(columns, rows)]


def share_text(failures, runs):
    if not runs:
        return " Short trials are all that stands behind it: no long runs were made, and the share is 1."
    untried = [name for name in failures.integrators if not any(run.integrator == name for run in runs.runs)]
    text = (f" The share is the largest of {listed(f'{share:g}' for share in runs.shares())} up to which every long run of the"
            f" method came through {runs.steps} steps")
    return text + (f"; it is 1 for what had no long run ({joined(untried)})." if untried else ".")


def number(value):
    return MISSING if value is None else three_digits(value)


# ---- drift


def drift_section(runs, level):
    parts = [Heading("Drift in long runs", level), Paragraph(
        'Of the largest error so far. "none, x": it stays level, at most x. "linear r": it is r · time. "r t^p": it is'
        ' r · time^p. "exp r": it grows as exp(r · time). Decided on the samples above rounding and below saturation: an'
        " exponential where it fits the logarithm of the error better than a power of time does, and a power by the last"
        " decade of time. Of a run that failed: up to there."
        f' "{MISSING}": too few samples to tell.')]
    for scene, n in runs.settings():
        columns = [Column("integrator", align="left")]
        for share in runs.shares():
            group = f"{share:g} of the critical step"
            columns += [Column("ends", group, "left"), *(Column(each.name, group, "left") for each in QUANTITIES)]
        rows = [[name, *(text for share in runs.shares() for text in run_texts(runs, runs.at(scene, n, share, name)))]
                for name in runs.integrators]
        parts += [Heading(f"n = {n}, {scene} scene", level + 1), plain_table(tuple(columns), rows)]
    return parts


def run_texts(runs, run):
    if run is None:
        return [MISSING] * (1 + len(QUANTITIES))
    return [ending(runs, run), *(drift_text(drift(each.series(run))) for each in QUANTITIES)]


def drift_text(each):
    if each is None:
        return MISSING
    if each.largest == 0:
        return "exactly 0"
    if each.kind == NONE:
        return f"none, {scientific(each.largest)}"
    if each.kind == EXPONENTIAL:
        return f"exp {three_digits(each.rate)}"
    return f"linear {scientific(each.rate)}" if each.kind == LINEAR else f"{scientific(each.rate)} t^{each.exponent:.1f}"
