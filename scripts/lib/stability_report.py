"""The failure maps and the long runs as a document: charts, critical values, the largest errors."""

import itertools

from lib.comparison import MISSING, three_digits
from lib.document import Column, Heading, Paragraph, conditions, plain_table, shown
from lib.integrator_names import KEPT, TABLE1_CELLS, strongest_structure
from lib.numbers import scientific
from lib.stability_files import QUANTITIES

HOW_CHARTS_READ = (
    "Failure maps: a cell is one trial. Measured critical: the largest h‖B(W₀)‖₂ that works below the first that fails."
    " Linear theory: where the iteration, of explicit methods the step, ceases to be stable with B frozen at B(W₀);"
    " none is drawn where it names no limit. Unstable: every iteration converged, but what the flow conserves did not"
    " stay.",
    "Long runs: every step is the same share of the integrator's own critical step, so times differ. A cross: the run"
    " failed after this state. Grey line: what rounding leaves. The energy error is the largest since the sample"
    " before; what is exactly 0 has no place on the axis.")


def charts_of(failures, fast=None, runs=None):
    """Returns the charts of a failure map, and of a map of the fast forms and of long runs where there are any.

    Of each its name, its caption, its function in stability_charts, and what that takes.
    """
    found, others = [], [name for name in failures.integrators if name not in TABLE1_CELLS]
    for study, kinds in ((failures, (("", TABLE1_CELLS, "Where the formulations of Table 1 fail"),
                                     ("_others", others, "Where the other integrators fail"))),
                         (fast, (("_fast", TABLE1_CELLS, "Where the fast forms of Table 1 fail"),))):
        for scene, (kind, names, title) in itertools.product(study.scenes() if study else (), kinds):
            if mapped := study.mapped(scene, names):
                found.append((f"failure_map{kind}_{scene}", f"{title}, {scene} scene.", "failure_map",
                              (study, scene, mapped, title)))
    for scene, n in runs.settings() if runs else ():
        where = f"long_runs_n{n}" if scene == "smooth" else f"long_runs_{scene}_n{n}"
        for name, isospectral, which in ((where, True, "keep"), (f"{where}_controls", False, "lose")):
            found.append((name, f"Errors of long runs at n = {n}, {scene} scene: integrators that {which} the"
                          " spectrum.", "long_runs", (runs, scene, n, isospectral)))
    return found


def stability_sections(failures, runs, charts, fast=None):
    """Returns the document; `charts` are the names of the charts beside it.

    `runs`, and `fast`, a map of the fast forms, may be None.
    """
    return [
        Heading("Stability", 1),
        *map(Paragraph, HOW_CHARTS_READ),
        *shown([each[:2] for each in charts_of(failures, fast, runs)], charts),
        *critical_section("Critical h‖B(W₀)‖₂", failures),
        *(critical_section("Critical h‖B(W₀)‖₂ of the fast forms", fast) if fast else []),
        *(long_runs_section(runs) if runs else []),
        conditions(failures.context),
    ]


def critical_section(title, failures):
    """Returns what a trial is, and a table for each scene: its integrators by n, and their ways of failing."""
    settings = [[scene, str(n), three_digits(each.norm_B), str(each.implicit_steps), str(each.explicit_steps)]
                for (scene, n), each in failures.settings.items()]
    parts = [
        Heading(title),
        Paragraph('The largest h‖B(W₀)‖₂ that works below the first that fails, by bisection; "> x": the largest'
                  ' tried still works, "< x": the smallest tried fails. Ways of failing stand last, in the order of n.'
                  f" A trial has so many steps, of at most {failures.max_sweeps} sweeps each:"),
        plain_table((Column("scene", align="left"), Column("n"), Column("‖B(W₀)‖₂"), Column("steps of a trial"),
                     Column("of explicit methods")), settings)]
    for scene in failures.scenes():
        columns = (Column("integrator", align="left"), *(Column(f"n = {n}") for n in failures.sizes(scene)),
                   Column("fails as", align="left"))
        rows = [critical_row(name, failures.line(scene, name)) for name in failures.mapped(scene, failures.integrators)]
        parts += [Heading(f"{scene.capitalize()} scene", 3), plain_table(columns, rows)]
    return parts


def critical_row(name, line):
    failures = dict.fromkeys(each.first_failure for each in line if each and each.first_failure)
    return [name, *map(critical_text, line), ", ".join(failures) or MISSING]


def critical_text(each):
    if each is None:
        return MISSING
    if each.edge.works:
        return three_digits(each.edge.works)
    if each.always_works:
        return f"> {three_digits(each.trials[-1].h_norm_B)}"
    return MISSING if each.trials[0].works else f"< {three_digits(each.trials[0].h_norm_B)}"


def long_runs_section(runs):
    parts = [Heading("Largest errors of long runs"), Paragraph(
        f"The largest over all samples of {runs.steps} steps; of a run that failed, up to there."
        f' "{MISSING}": no sample with a finite value. A run that converged may have lost its energy, as the first'
        f' table'
        " shows of the runs that came through, by what their integrators keep."), energy_table(runs)]
    for scene, n in runs.settings():
        columns = [Column("integrator", align="left")]
        for share in runs.shares():
            group = f"{share:g} of the critical step"
            columns += [Column("ends", group, "left"), Column("steps", group),
                        *(Column(quantity.replace("_", " "), group) for quantity in QUANTITIES)]
        rows = [[name, *(text for share in runs.shares() for text in run_texts(runs.runs.get((scene, n, name, share))))]
                for name in runs.integrators]
        parts += [Heading(f"n = {n}, {scene} scene", 3), plain_table(tuple(columns), rows)]
    return parts


def energy_table(runs):
    """Shows how far the energy of runs that came through is off, by what their integrators keep."""
    found = {}
    for (_, _, name, _), run in runs.runs.items():
        if run.survived:
            found.setdefault(strongest_structure(runs.integrators[name]), []).append(run.largest("energy_error") or 0.0)
    rows = [[KEPT[structure], str(len(found[structure])), scientific(min(found[structure])),
             scientific(max(found[structure]))] for structure in reversed(KEPT) if structure in found]
    return plain_table((Column("keeps", align="left"), *map(Column, ("runs", "least energy error", "largest"))), rows)


def run_texts(run):
    """Returns how a run ended, the number of its completed steps, and its largest errors."""
    if run is None:
        return [MISSING] * (2 + len(QUANTITIES))
    largest = map(run.largest, QUANTITIES)
    return [run.row.status, str(run.row.steps), *(MISSING if each is None else scientific(each) for each in largest)]
