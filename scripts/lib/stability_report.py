"""The failure maps and the long runs as a document: charts, critical values, the largest errors."""

from dataclasses import dataclass
from typing import Tuple

from accuracy_report import listed, scientific
from comparison import MISSING, three_digits
from document import Column, Heading, Paragraph, conditions, plain_table, shown
from integrator_names import others
from stability_files import QUANTITIES, trials_in_words

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
        *critical_section("Critical h‖B(W₀)‖₂", failures, level + 1),
        *(critical_section("Critical h‖B(W₀)‖₂ of the fast forms", fast, level + 1) if fast else []),
        *(long_runs_section(runs, level + 1) if runs else []),
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
    row = run.row
    return row.status + (f" at step {row.failed_step}" if row.failed_step else f" after {row.steps} steps")


# ---- tables


def critical_section(title, failures, level):
    """A table for each scene: its integrators by n, and their ways of failing."""
    parts = [Heading(title, level), Paragraph(
        'The largest h‖B(W₀)‖₂ that works below the first that fails, by bisection; "> x": the largest tried still works,'
        ' "< x": the smallest tried fails. What the first failure is stands last, in the order of n. A trial is of'
        f" {trials_in_words(failures, failures.scenes())}.")]
    for scene in failures.scenes():
        sizes = failures.sizes(scene)
        columns = (Column("integrator", align="left"), *(Column(f"n = {n}") for n in sizes),
                   Column("fails as", align="left"))
        rows = [[name, *(critical_text(failures.at(scene, n, name)) for n in sizes),
                 ways_text(failures.line(scene, name))]
                for name in failures.integrators if failures.line(scene, name)]
        parts += [Heading(f"{scene.capitalize()} scene", level + 1), plain_table(columns, rows)]
    return parts


def critical_text(each):
    if each is None:
        return MISSING
    if each.edge.works:
        return three_digits(each.edge.works)
    if each.always_works:
        return f"> {three_digits(each.trials[-1].h_norm_B)}"
    return MISSING if each.trials[0].works else f"< {three_digits(each.trials[0].h_norm_B)}"


def ways_text(line):
    ways = [each.first_failure for each in line if each.first_failure]
    return listed(dict.fromkeys(ways)) or MISSING


# ---- long runs


def long_runs_section(runs, level):
    parts = [Heading("Largest errors of long runs", level), Paragraph(
        "The largest over all samples; of a run that failed, up to there."
        f' "{MISSING}": no sample with a finite value.')]
    for scene, n in runs.settings():
        columns = [Column("integrator", align="left")]
        for share in runs.shares():
            group = f"{share:g} of the critical step"
            columns += [Column("ends", group, "left"), *(Column(each.name, group) for each in QUANTITIES)]
        rows = [[name, *(text for share in runs.shares() for text in run_texts(runs, runs.at(scene, n, share, name)))]
                for name in runs.integrators]
        parts += [Heading(f"n = {n}, {scene} scene", level + 1), plain_table(tuple(columns), rows)]
    return parts


def run_texts(runs, run):
    if run is None:
        return [MISSING] * (1 + len(QUANTITIES))
    return [ending(runs, run), *(largest_text(each.series(run)) for each in QUANTITIES)]


def largest_text(series):
    if not series:
        return MISSING
    largest = max(value for _, value in series)
    return scientific(largest) if largest else "0"
