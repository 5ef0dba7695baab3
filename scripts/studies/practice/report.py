"""The report of the study `practice`: what people run, and what reaches its error, or a tenth of it, for less."""

from lib.judging.verdicts import FEWEST, LEVEL
from lib.pages.document import Column, Heading, Paragraph, conditions, plain_table, shown
from lib.pages.numbers import MISSING, power, scientific, span, three_digits, two_digits
from lib.pages.rendering import Rendering
from lib.records.findings import FILE, as_json
from lib.records.integrators import GAUSS, KEPT
from studies.practice.judge import BEST, BY_STRUCTURE, NOTHING, POISSON, SPECTRUM, figures, findings, leading_results
from studies.practice.schema import (AT_PRACTICE, AT_TENTH, BASELINE_TOLERANCE, METHOD, PRACTICE, QUFLOW, TURBULENCE,
                                     read_practice)

CHARTS = (("time_against_n", "CPU time for a unit of simulated time against n: the practice, and the cheapest method of"
           " each class at a tenth of its error."),)
ERRORS = {AT_PRACTICE: "the practice's error", AT_TENTH: "a tenth of it"}
KEEPING = {BEST: "any", SPECTRUM: KEPT[SPECTRUM], POISSON: KEPT[POISSON]}


def sections(study, found, charts):
    """Returns the document of a Practice and its Findings; `charts` are the names of the charts beside it."""
    results = {key: [row for row in found.results if (row.scene, row.n) == key] for key in study.problems}
    return [
        Heading("What people run, and what reaches a tenth of its error for less", 1),
        Paragraph("The practice is the isospectral midpoint with h = ħ/4: integrator algebra1, tolerance"
                  f" {power(BASELINE_TOLERANCE)}, fast form. {quflow_text(study)} {answer_text(found)}"),
        *shown(CHARTS, charts),
        Heading("The cheapest method at a tenth of the practice's error"),
        Paragraph("Of all methods, of those that keep the spectrum, and of Lie–Poisson methods at a tolerance that"
                  " bounds the energy. Times are CPU seconds for a unit of simulated time. Gain: how many times as"
                  f" long the practice and quflow take, with {LEVEL:.0%} intervals over processes; both take the step"
                  " ħ/4 and have ten times the error."),
        leaders_table(study, found),
        *(part for key in study.problems for part in problem_parts(study, key, results[key])),
        Heading("Threads"),
        *thread_parts(study, found),
        Heading("References"),
        *reference_parts(study),
        Heading("How it is measured"),
        *how_parts(study),
        Heading("What was not tried"),
        Paragraph("One start of each scene, and one sample of turbulence; times beyond T; steps longer than those that"
                  " reach the errors, as statistics allow; tolerances other than those named; steps other than ħ/4 of"
                  " the practice; quflow on a GPU, with its other integrators, in single precision or with more than"
                  " one thread; forcing and dissipation. A trajectory with a small error says nothing of averages over"
                  " long runs, for which see the study of turbulence."),
        conditions(study.context)]


def quflow_text(study):
    if study.settings.quflow is None:
        return ("quflow's own step was not run: QUFLOW named no checkout of quflow when this was measured, so that its"
                " rows are missing.")
    return f"quflow's own step, isomp with its defaults, is that of commit {study.settings.quflow}."


def answer_text(found):
    """Says what the best methods gain at a tenth of the practice's error."""
    best = [row for each, row in leading_results(found) if (each.wanted, each.group) == (AT_TENTH, BEST)]
    if not best:
        return "No method reaches a tenth of its error."
    text = f"The practice takes {gain_span(best, PRACTICE)} times as long as the best method for a tenth of its error"
    over_quflow = [row for row in best if row.gain_over_quflow is not None]
    return f"{text}, and quflow {gain_span(over_quflow, QUFLOW)} times." if over_quflow else f"{text}."


def gain_span(rows, other):
    return span([getattr(row, f"gain_over_{other}") for row in rows])


# ---- cells


def gain_text(row, other):
    """Writes a gain with its interval, where there is one."""
    return with_interval(*(getattr(row, f"gain_over_{other}{end}") for end in ("", "_low", "_high")))


def with_interval(gain, low, high):
    if gain is None:
        return MISSING
    return two_digits(gain) + (f" ({two_digits(low)}–{two_digits(high)})" if low and high else "")


def tolerance_text(row):
    return scientific(row.tolerance) if row.role == QUFLOW else power(row.tolerance)


def name_of(row):
    """Returns what tables call the method of a row."""
    return {PRACTICE: f"practice ({row.integrator})", QUFLOW: "quflow"}.get(row.role, row.integrator)


def cost_cells(row):
    if row.seconds is None:
        return ["not reached", *[MISSING] * 5]
    return [str(row.steps), f"{row.step:.3g}", two_digits(row.products), three_digits(row.seconds),
            gain_text(row, PRACTICE), gain_text(row, QUFLOW)]


COST_COLUMNS = (Column("steps"), Column("h"), Column("products"), Column("s a unit"), Column("gain over practice"),
                Column("gain over quflow"))


def leaders_table(study, found):
    leaders = {(each.scene, each.n, each.group): row for each, row in leading_results(found)
               if each.wanted == AT_TENTH}
    rows = []
    for key, problem in study.problems.items():
        for group in BY_STRUCTURE:
            row = leaders.get((*key, group))
            cells = [row.integrator, tolerance_text(row), *cost_cells(row)] if row else [MISSING] * 8
            rows.append([key[0], str(key[1]), f"{problem.time:g}", KEEPING[group], *cells])
    return plain_table((Column("scene", align="left"), Column("n"), Column("T"), Column("keeps", align="left"),
                        Column("integrator", align="left"), Column("tolerance"), *COST_COLUMNS), rows)


# ---- each problem


def problem_parts(study, key, results):
    """Returns the tables of one problem: costs at both errors, and what is kept."""
    problem, practice = study.problems[key], study.practice(key)
    frame = ("Methods run in the co-rotating frame, which makes the generator smaller."
             if problem.in_frame else "The co-rotating frame does not make the generator smaller, and is not used.")
    begun = f" The start is the state after {problem.developed:g} units of time." if problem.developed else ""
    base = [row for row in results if row.role != METHOD]
    columns = (Column("integrator", align="left"), Column("tolerance"), *COST_COLUMNS)
    return [
        Heading(f"{key[0].capitalize()}, n = {key[1]}, T = {problem.time:g}"),
        Paragraph(f"The practice has an error of {scientific(practice.error)} after {practice.steps} steps."
                  f" {frame}{begun}"),
        *(part for wanted, words in ERRORS.items() for part in (
            Heading(f"At {words}", 3),
            plain_table(columns, [[name_of(row), tolerance_text(row), *cost_cells(row)] for row in (
                *base, *(row for row in results if row.role == METHOD and row.wanted == wanted))]))),
        Heading("Errors", 3),
        errors_table([*base, *(row for row in results if row.role == METHOD and row.wanted == AT_TENTH)])]


def errors_table(rows):
    def cells(row):
        if row.steps is None:
            return [MISSING] * 5
        return [scientific(row.error), scientific(row.energy_error), scientific(row.spectrum_error),
                two_digits(row.sweeps), str(row.capped)]

    return plain_table((Column("integrator", align="left"), Column("tolerance"), Column("keeps", align="left"),
                        Column("error"), Column("energy error"), Column("spectrum error"), Column("sweeps a step"),
                        Column("capped steps")),
                       [[name_of(row), tolerance_text(row), kept_text(row), *cells(row)] for row in rows])


def kept_text(row):
    """Writes what a method keeps at its tolerance, for a Gauss method at a loose one too."""
    return f"{KEPT[SPECTRUM]} to the tolerance" if row.keeps == NOTHING and row.family == GAUSS else KEPT[row.keeps]


# ---- threads, references, how


def thread_parts(study, found):
    if not study.threads:
        return [Paragraph("Nothing was timed by threads: the study had one core only, or no problem for it.")]
    rows = [[each.scene, str(each.n), each.integrator, power(each.tolerance), str(each.threads),
             three_digits(each.seconds), with_interval(each.gain, each.gain_low, each.gain_high)]
            for each in found.threads]
    return [Paragraph(f"Seconds that pass for fast forms at a tenth of the practice's error, on {study.settings.cores}"
                      " cores; gain over one thread."),
            plain_table((Column("scene", align="left"), Column("n"), Column("integrator", align="left"),
                         Column("tolerance"), Column("threads"), Column("s a unit"), Column("gain")), rows)]


def reference_parts(study):
    rows = [[*map(str, key), *(f"{name}, {steps} steps, {scientific(error)}" for name, steps, error in zip(
        each.references, each.reference_steps, each.reference_errors)), scientific(each.difference),
        scientific(each.difference / study.practice(key).error), each.reference]
        for key, each in study.problems.items()]
    return [Paragraph("Two methods of different kinds solve each problem. Each halves its steps until its change with"
                      " the last halving, over 2^p − 1 for order p, is far below the errors here. Errors are measured"
                      " against the first; the last columns are the difference of the two, the same over the practice's"
                      " error, and the hash of the first solution, which is computed again in each run of the study."),
            plain_table((Column("scene", align="left"), Column("n"), Column("first", align="left"),
                         Column("second", align="left"), Column("difference"), Column("over the practice's error"),
                         Column("hash", align="left")), rows)]


def how_parts(study):
    settings = study.settings
    counts = {len(row.cpu_seconds) for rows in study.rows.values() for row in rows if row.steps is not None}
    turbulence = [each for key, each in study.problems.items() if key[0] == TURBULENCE]
    drawn = (f" Turbulence: modes l = {settings.lowest_degree} … {settings.highest_degree} by a seeded generator,"
             f" ‖W‖₂ = 1, sample {settings.sample}, developed until degrees from {settings.tail_from:g} (n − 1) on have"
             f" {settings.tail_share:.0%} of the enstrophy, about what they have in the rough scene: at t = "
             + ", ".join(f"{each.developed:g} for n = {each.n}" for each in turbulence) + "." if turbulence else "")
    return [Paragraph("Of each method the fewest steps are found that reach an error, and whether some more take less"
                      " work. A tolerance is the loosest that leaves the trajectory alone, or a hundredth of a tenth of"
                      " the practice's error where that is smaller; Lie–Poisson methods run at 1e-13 besides, at which"
                      f" their energy stays bounded.{drawn}"),
            Paragraph(f"Times are CPU seconds by {span(counts, str)} fresh processes on one core, which time all rows"
                      f" of a problem interleaved, in changing order; fewer than {FEWEST} decide nothing. Up to"
                      f" n = {settings.largest_whole} whole runs are timed{quflow_whole_text(settings)}, beyond it some"
                      f" steps at one of {settings.places} places of a run, in turn by process, scaled to the whole by"
                      " equivalent products, or by steps for quflow's step; of a method with two numbers of steps those"
                      " of the smaller error are timed for both. quflow's compiler has done its work before its step is"
                      " timed, by one thread. Capped steps ended at the largest number of iterations.")]


def quflow_whole_text(settings):
    """Says up to which n whole runs of quflow's step are timed, where that is another n than of the others."""
    if settings.quflow is None or settings.largest_whole_quflow in (None, settings.largest_whole):
        return ""
    return f" (of quflow's step, which takes longest, up to n = {settings.largest_whole_quflow})"


def rendered(raw, _recorded):
    """Returns the Rendering of a raw file."""
    study = read_practice(raw)
    from studies.practice import charts  # only now: it needs matplotlib

    found = findings(study)
    return Rendering(lambda names: sections(study, found, names), figures(found),
                     {name: getattr(charts, name)(study) for name, _ in CHARTS}, {FILE: as_json("practice", found)})
