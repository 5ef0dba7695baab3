"""Finds the cheapest recorded run that reaches an error and keeps a structure, in what the study of accuracy measured.

Only runs that were measured are offered: nothing is interpolated in the step size, or extrapolated in n or time.
"""

import math
from dataclasses import dataclass
from typing import Tuple

from accuracy_lines import Run
from benchmark_json import one_line
from comparison import MISSING, three_digits, time_with_spread
from document import Column, Entry, Heading, Item, Items, Paragraph, Table
from statistics_of_repetitions import half_interquartile_range
from study_file import Integrator

# What can be asked for, from the least to the most: a Lie–Poisson integrator keeps the spectrum too.
KEPT = {"nothing": "nothing", "spectrum": "the spectrum", "poisson": "the Lie–Poisson structure"}
RUNNERS_UP = 4
TABLE_EXPONENTS = (-2, -4, -6, -8)

SEPARATED, NOT_SEPARATED = "separated", "not separated"
RULE = ("Two runs are not separated where their CPU seconds overlap, each taken from its fastest to its slowest"
        " repetition, or where one of them was run only once.")


class Unanswerable(Exception):
    """A question that the recorded runs do not answer; the message is one line."""


@dataclass(frozen=True)
class Candidate:
    integrator: Integrator
    run: Run

    @property
    def seconds(self):
        return self.run.seconds

    @property
    def error(self):
        return self.run.error

    def strongest_structure(self):
        return next(structure for structure in reversed(KEPT) if self.integrator.keeps(structure))

    def separated_from(self, slower):
        first, second = self.run.cpu_seconds, slower.run.cpu_seconds
        return min(len(first), len(second)) > 1 and max(first) < min(second)


@dataclass(frozen=True)
class Recommendation:
    winner: Candidate
    others: Tuple[Candidate, ...]  # the best run of each other integrator, the fastest first

    def runners_up(self):
        return self.others[:RUNNERS_UP]

    def ratio(self, other):
        return other.seconds / self.winner.seconds


def candidates(study, n, structure):
    """Returns the runs at n that may be offered at all.

    A step beyond an integrator's stability limit is never offered, whatever error it had in this scene: there
    the method lets a constant generator's flow grow.
    """
    return [Candidate(study.integrators[run.integrator], run) for run in study.runs
            if run.n == n and run.usable and not run.beyond_limit
            and study.integrators[run.integrator].keeps(structure)]


def recommendation(study, n, error, structure):
    """Returns the cheapest runs by median CPU seconds that reach the error, or None. Equal times: the better error.

    An error below the uncertainty of the reference says no more than that uncertainty does.
    """
    best = {}
    uncertainty = study.references[n].uncertainty
    for each in sorted(candidates(study, n, structure), key=lambda each: (each.seconds, each.error)):
        if max(each.error, uncertainty) <= error:
            best.setdefault(each.integrator.name, each)
    runs = tuple(best.values())
    return Recommendation(runs[0], runs[1:]) if runs else None


def answer(study, n, time, error, structure):
    """Returns the Recommendation; throws Unanswerable where no recorded run is an answer. Time None: the recorded."""
    check_recorded(study, n, time)
    found = recommendation(study, n, error, structure)
    if found is None:
        raise Unanswerable(unreached(study, n, error, structure))
    return found


def check_recorded(study, n, time):
    sizes = sorted({run.n for run in study.runs})
    recorded = f"recorded: time {study.time:g} at n = {', '.join(map(str, sizes)) or 'none'}"
    if n not in sizes:
        raise Unanswerable(f"n = {n} is not recorded ({recorded}), and nothing is extrapolated")
    if time is not None and not math.isclose(time, study.time, rel_tol=1e-9):
        raise Unanswerable(f"time {time:.10g} is not recorded ({recorded}), and nothing is extrapolated")


def unreached(study, n, error, structure):
    """Says that no run reaches the error, and what the best of them reached."""
    runs = candidates(study, n, structure)
    if not runs:
        return f"no recorded run at n = {n}{condition(structure)} came to a stable end"
    best = min(runs, key=lambda each: (each.error, each.seconds))
    return (f"no recorded run at n = {n}{condition(structure)} is known to have an error of {error:.10g} or less;"
            f" the best has {known_error(study, best)}, by {best.integrator.name} with {step_text(best)}")


def condition(structure):
    return "" if structure == "nothing" else f" that keeps {KEPT[structure]}"


def known_error(study, candidate):
    uncertainty = study.references[candidate.run.n].uncertainty
    return f"{error_text(candidate.error)} (the reference is good to {uncertainty:.1g})"


# ---- the answer


def answer_document(study, found, n, error, structure, path):
    """Returns the answer as a document: the winner, its rivals, and where the numbers come from."""
    winner = found.winner
    run = winner.run
    facts = (
        ("method", f"{winner.integrator.name}, order {winner.integrator.order}, keeps"
                   f" {KEPT[winner.strongest_structure()]}"),
        ("step", step_text(winner)),
        ("expected error", known_error(study, winner)),
        ("spectrum error", error_text(run.spectrum_error)),
        ("CPU seconds", time_with_spread(run.cpu_seconds)),
        ("products", str(run.products)),
        ("Poisson solves", str(run.poisson_solves)),
    )
    return [
        Paragraph(f"The cheapest recorded run at n = {n} to time {study.time:g} with an error of"
                  f" {error:.10g} or less{condition(structure)}:"),
        Items([Item(name, f": {text}") for name, text in facts]),
        *runners_up_section(found),
        Paragraph(source(study, path)),
    ]


def runners_up_section(found):
    if not found.others:
        return [Paragraph("No other integrator has a recorded run that does.")]
    left = ("method", "keeps", "step", "repetitions")
    columns = tuple(Column(heading, align="left" if heading in left else "right") for heading in
                    ("method", "order", "keeps", "step", "error", "CPU seconds", "times as long", "repetitions"))
    rows = [[each.integrator.name, str(each.integrator.order), KEPT[each.strongest_structure()], step_text(each),
             error_text(each.error), time_with_spread(each.run.cpu_seconds), three_digits(found.ratio(each)),
             SEPARATED if found.winner.separated_from(each) else NOT_SEPARATED] for each in found.runners_up()]
    return [Paragraph("Runners-up, the cheapest such run of each other integrator:"),
            Table(columns, [[[Entry(text) for text in row] for row in rows]]), Paragraph(RULE)]


def step_text(candidate):
    return f"h = {candidate.run.step:.4g} ({candidate.run.steps} steps)"


def error_text(error):
    return f"{error:.3g}"


def source(study, path):
    processor, commit = (study.context.get(field) or "not recorded" for field in ("cpu", "commit"))
    changed = " with changes" if study.context.get("dirty") == "yes" else ""
    return f"Measured: {one_line(path)}, processor {processor}, commit {commit}{changed}."


def answer_data(study, found, n, error, structure, path):
    """Returns the answer for programs, as what JSON can hold."""
    return {
        "question": {"n": n, "time": study.time, "error": error, "keep": structure},
        "winner": run_data(found.winner),
        "runners_up": [{**run_data(each), "ratio": found.ratio(each),
                        "separated": found.winner.separated_from(each)} for each in found.runners_up()],
        "source": {"raw": one_line(path), "cpu": study.context.get("cpu"), "commit": study.context.get("commit"),
                   "dirty": study.context.get("dirty")},
    }


def run_data(candidate):
    run = candidate.run
    return {
        "integrator": candidate.integrator.name, "order": candidate.integrator.order,
        "keeps": candidate.strongest_structure(), "step": run.step, "steps": run.steps,
        "error": run.error, "spectrum_error": run.spectrum_error, "seconds": run.seconds,
        "half_interquartile_range": half_interquartile_range(run.cpu_seconds),
        "repetitions": len(run.cpu_seconds), "products": run.products, "poisson_solves": run.poisson_solves,
    }


# ---- the table


def recommendation_tables(study, level=2):
    """Returns, for each structure, a heading and a table of the winner by n and error; then how to read them."""
    parts = []
    for structure in KEPT:
        heading = "Whatever is kept" if structure == "nothing" else f"Keeping {KEPT[structure]}"
        parts += [Heading(heading, level), recommendation_table(study, structure)]
    return [*parts, Paragraph(
        f"The cheapest recorded run to time {study.time:g} with at most the column's error: method, step, median CPU"
        f' seconds. "{MISSING}": no recorded run reaches it. Marked: separated from the best run of every other'
        f" method. {RULE}")]


def recommendation_table(study, structure):
    columns = (Column("n"), *(Column(f"error 1e{exponent}", align="left") for exponent in TABLE_EXPONENTS))
    rows = [[Entry(str(n)), *(table_entry(recommendation(study, n, 10.0**exponent, structure))
                              for exponent in TABLE_EXPONENTS)] for n in study.sizes()]
    return Table(columns, [rows])


def table_entry(found):
    if found is None:
        return Entry(MISSING)
    winner = found.winner
    clear = bool(found.others) and all(map(winner.separated_from, found.others))
    return Entry(f"{winner.integrator.name}, h = {winner.run.step:.4g}, {three_digits(winner.seconds)} s",
                 clear)
