"""Finds the cheapest recorded run that reaches an error and keeps a structure, in what the study of accuracy measured.

Only runs that were measured are offered: nothing is interpolated in the step size, or extrapolated in n or time.
"""

import math

from benchmark_json import one_line
from comparison import MISSING, three_digits, time_with_spread
from document import Column, Entry, Heading, Items, Paragraph, Table, plain_table
from statistics_of_repetitions import half_interquartile_range

# What can be asked for, from the least to the most: a Lie–Poisson integrator keeps the spectrum too.
KEPT = {"nothing": "nothing", "spectrum": "the spectrum", "poisson": "the Lie–Poisson structure"}
MOST_OFFERED = 5  # the winner and its runners-up
TABLE_EXPONENTS = (-2, -4, -6, -8)

RULE = ("Two runs are not separated where their CPU seconds overlap, each taken from its fastest to its slowest"
        " repetition, or where one of them was run only once.")


class Unanswerable(Exception):
    """A question that the recorded runs do not answer; the message is one line."""


def separated(faster, slower):
    first, second = faster.cpu_seconds, slower.cpu_seconds
    return min(len(first), len(second)) > 1 and max(first) < min(second)


def strongest_structure(study, run):
    return next(structure for structure in reversed(KEPT) if study.integrators[run.integrator].keeps(structure))


def candidates(study, n, structure):
    """Returns the runs at n that may be offered at all.

    A step beyond an integrator's stability limit is never offered, whatever error it had in this scene: there
    the method lets a constant generator's flow grow.
    """
    return [run for run in study.runs if run.n == n and run.usable and not run.beyond_limit
            and study.integrators[run.integrator].keeps(structure)]


def ranking(study, n, error, structure):
    """Returns the best run of each integrator that reaches the error, the cheapest by median CPU seconds first.

    Equal times: the better error. An error below the uncertainty of the reference says no more than that does.
    """
    best = {}
    uncertainty = study.references[n].uncertainty
    for run in sorted(candidates(study, n, structure), key=lambda run: (run.seconds, run.error)):
        if max(run.error, uncertainty) <= error:
            best.setdefault(run.integrator, run)
    return list(best.values())


def answer(study, n, time, error, structure):
    """Returns the ranking; throws Unanswerable where it is empty. Time None: the recorded one."""
    sizes = sorted({run.n for run in study.runs})
    recorded = f"recorded: time {study.time:g} at n = {', '.join(map(str, sizes)) or 'none'}"
    if n not in sizes:
        raise Unanswerable(f"n = {n} is not recorded ({recorded}), and nothing is extrapolated")
    if time is not None and not math.isclose(time, study.time, rel_tol=1e-9):
        raise Unanswerable(f"time {time:.10g} is not recorded ({recorded}), and nothing is extrapolated")
    runs = candidates(study, n, structure)
    if not runs:
        raise Unanswerable(f"no recorded run at n = {n}{that_keeps(structure)} came to a stable end")
    found = ranking(study, n, error, structure)
    if not found:
        best = min(runs, key=lambda run: (run.error, run.seconds))
        raise Unanswerable(f"no recorded run at n = {n}{that_keeps(structure)} is known to have an error of"
                           f" {error:.10g} or less; the best has {known_error(study, best)}, by {best.integrator} with"
                           f" {step_text(best)}")
    return found


def that_keeps(structure):
    return "" if structure == "nothing" else f" that keeps {KEPT[structure]}"


def known_error(study, run):
    return f"{run.error:.3g} (the reference is good to {study.references[run.n].uncertainty:.1g})"


def step_text(run):
    return f"h = {run.step:.4g} ({run.steps} steps)"


# ---- the answer


def answer_document(study, found, n, error, structure, path):
    """Returns the answer as a document: the winner, its rivals, and where the numbers come from."""
    winner, *others = found[:MOST_OFFERED]
    facts = {
        "method": f"{winner.integrator}, order {study.integrators[winner.integrator].order}, keeps"
                  f" {KEPT[strongest_structure(study, winner)]}",
        "step": step_text(winner),
        "expected error": known_error(study, winner),
        "spectrum error": f"{winner.spectrum_error:.3g}",
        "CPU seconds": time_with_spread(winner.cpu_seconds),
        "products": str(winner.products),
        "Poisson solves": str(winner.poisson_solves),
    }
    columns = (Column("method", align="left"), Column("order"), Column("keeps", align="left"),
               Column("step", align="left"), Column("error"), Column("CPU seconds"), Column("times as long"),
               Column("repetitions", align="left"))
    rows = [[run.integrator, str(study.integrators[run.integrator].order), KEPT[strongest_structure(study, run)],
             step_text(run), f"{run.error:.3g}", time_with_spread(run.cpu_seconds),
             three_digits(run.seconds / winner.seconds), "separated" if separated(winner, run) else "not separated"]
            for run in others]
    processor, commit = (study.context.get(field) or "not recorded" for field in ("cpu", "commit"))
    changed = " with changes" if study.context.get("dirty") == "yes" else ""
    return [
        Paragraph(f"The cheapest recorded run at n = {n} to time {study.time:g} with an error of {error:.10g} or"
                  f" less{that_keeps(structure)}:"),
        Items([(name, f": {text}") for name, text in facts.items()]),
        *([Paragraph("Runners-up, the cheapest such run of each other integrator:"), plain_table(columns, rows),
           Paragraph(RULE)] if others else [Paragraph("No other integrator has a recorded run that does.")]),
        Paragraph(f"Measured: {one_line(path)}, processor {processor}, commit {commit}{changed}."),
    ]


def answer_data(study, found, n, error, structure, path):
    """Returns the answer for programs, as what JSON can hold."""
    def data(run):
        return {
            "integrator": run.integrator, "order": study.integrators[run.integrator].order,
            "keeps": strongest_structure(study, run), "step": run.step, "steps": run.steps,
            "error": run.error, "spectrum_error": run.spectrum_error, "seconds": run.seconds,
            "half_interquartile_range": half_interquartile_range(run.cpu_seconds),
            "repetitions": len(run.cpu_seconds), "products": run.products, "poisson_solves": run.poisson_solves,
        }

    winner, *others = found[:MOST_OFFERED]
    return {
        "question": {"n": n, "time": study.time, "error": error, "keep": structure},
        "winner": data(winner),
        "runners_up": [{**data(run), "ratio": run.seconds / winner.seconds, "separated": separated(winner, run)}
                       for run in others],
        "source": {"raw": one_line(path), **{name: study.context.get(name) for name in ("cpu", "commit", "dirty")}},
    }


# ---- the table


def recommendation_tables(study):
    """Returns, for each structure, a heading and a table of the winner by n and error; then how to read them."""
    def entry(found):
        if not found:
            return Entry(MISSING)
        winner, *others = found
        return Entry(f"{winner.integrator}, h = {winner.step:.4g}, {three_digits(winner.seconds)} s",
                     bool(others) and all(separated(winner, run) for run in others))

    columns = (Column("n"), *(Column(f"error 1e{exponent}", align="left") for exponent in TABLE_EXPONENTS))
    parts = []
    for structure in KEPT:
        rows = [[Entry(str(n)), *(entry(ranking(study, n, 10.0**exponent, structure)) for exponent in TABLE_EXPONENTS)]
                for n in study.sizes()]
        heading = "Whatever is kept" if structure == "nothing" else f"Keeping {KEPT[structure]}"
        parts += [Heading(heading, 3), Table(columns, [rows])]
    return [*parts, Paragraph(
        f"The cheapest recorded run to time {study.time:g} with at most the column's error: method, step, median CPU"
        f' seconds. "{MISSING}": no recorded run reaches it. Marked: separated from the best run of every other'
        f" method. {RULE}")]
