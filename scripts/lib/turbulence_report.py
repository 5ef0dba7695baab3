"""The report of the study of turbulence: settings against the reference, costs, and how it is judged."""

import statistics

from lib.comparison import MISSING, percentage, ratio_text, three_digits
from lib.document import Column, Entry, Heading, Paragraph, Table, conditions, plain_table, shown
from lib.formats import PUBLISHED, SOLVERS
from lib.integrator_names import KEPT
from lib.numbers import scientific, span, two_digits
from lib.turbulence_figures import (CLOSE, CONSERVED, findings_of, largest_faithful_step, methods_of,
                                    published_over_fast, times_of_run)
from lib.turbulence_files import INDEPENDENT, LOOSE, PARTED, PRACTICE
from lib.turbulence_statistics import COUNT, LEAST_SHARE, LEVEL
from lib.verdicts import FEWEST, MARGIN

CHART = "statistical_error"
KEEPING = {**KEPT, next(iter(KEPT)): "any"}  # what is asked of a method, the least first
CAPTION = ("Error of the time-averaged energy spectrum against the CPU time of a run, over that of the practice. In the"
           " grey band an ensemble is not told from the reference.")


def turbulence_sections(study, charts):
    """Returns the document of a Turbulence; `charts` are the names of the charts beside it."""
    found = {n: findings_of(study, n) for n in study.sizes}
    return [
        Heading("Statistics of turbulence, and what they cost", 1),
        Paragraph("Do runs with other methods, longer steps or looser tolerances average to the same? An ensemble is"
                  " faithful if its time-averaged energy spectrum is no further from the reference than reference"
                  " ensembles are from one another."),
        *shown([(CHART, CAPTION)], charts),
        Heading("The cheapest faithful settings"),
        Paragraph("Of all methods, of those that keep the spectrum, and of Lie–Poisson methods. Times are those of one"
                  " run to T. The practice: isospectral midpoint rule, h = ħ/4, tolerance 1e-8, fast form."
                  f" Close: energy, enstrophy and tr W⁴ average to the initial values within {CLOSE:.0%} too."
                  f" Tie: within {MARGIN - 1:.0%}; undecided: the interval holds a bound of that, or there are too few"
                  " processes."),
        cheapest_table(found),
        Heading("The largest faithful step"),
        Paragraph(f"Of the steps tried, at a tolerance of 1e-8. {MISSING}: none. One in 20 settings that are right is"
                  " called unfaithful by chance. The fewer the draws, the larger the distance that counts as"
                  " faithful. A step that fails in one draw is not faithful. Where few settings are judged, the largest"
                  " is one of those few, and no limit."),
        *few_draws_paragraphs(study),
        steps_table(found),
        *(part for n in study.sizes for part in size_sections(study, n, found[n])),
        *published_parts(study),
        Heading("How it is judged"),
        *how_parts(study, found),
        conditions(study.context),
    ]


def cheapest_table(found):
    rows = []
    for n, findings in found.items():
        for structure, words in KEEPING.items():
            for close in (False, True):
                def allowed(judged, structure=structure, close=close):
                    return judged.has(structure) and (judged.conserves or not close)

                level = [", ".join(map(setting_text, each)) or MISSING
                         for each in findings.level_with_cheapest(allowed)]
                rows.append([str(n), f"{words}, close" if close else words,
                             *setting_cells(findings, findings.cheapest(allowed)), *level])
    return plain_table((Column("n"), Column("keeps", align="left"), Column("integrator", align="left"), Column("h"),
                        Column("tolerance"), Column("CPU seconds"), Column("over the practice"), Column("distance"),
                        Column("tie with it", align="left"), Column("undecided", align="left")), rows)


def setting_text(judged):
    """Writes a setting, as "elp4 with h = 1", with its tolerance where that is not the usual one."""
    setting = judged.setting
    tolerance = "" if setting.tolerance == LOOSE else f" to {setting.tolerance:g}"
    return f"{setting.integrator} with h = {setting.step:.3g}{tolerance}"


def setting_cells(findings, judged):
    if judged is None:
        return [MISSING] * 6
    return [judged.setting.integrator, f"{judged.setting.step:.3g}", f"{judged.setting.tolerance:g}",
            three_digits(judged.seconds), ratio_text(findings.over_practice(judged)), percentage(judged.distance)]


def steps_table(found):
    """Returns the largest faithful step of each integrator at each n, below how strictly it was judged there."""
    names = list(dict.fromkeys(name for findings in found.values() for name in methods_of(findings)))

    def cell(findings, name):
        step = largest_faithful_step(findings, name)
        return MISSING if step is None else f"{step:.3g}"

    each = found.values()
    judging = [["draws", *(str(len(findings.reference.means)) for findings in each)],
               ["faithful: distance at most", *(percentage(findings.reference.threshold) for findings in each)],
               ["settings judged", *(str(len(findings.judged)) for findings in each)]]
    rows = [[name, *(cell(findings, name) for findings in found.values())] for name in names]
    return Table((Column("integrator", align="left"), *(Column(f"n = {n}") for n in found)),
                 [[list(map(Entry, row)) for row in block] for block in (judging, rows)])


def size_sections(study, n, findings):
    """Returns the table of every setting at one n."""
    size = study.sizes[n]
    columns = (Column("integrator", align="left"), Column("h"), Column("tolerance"), Column("CPU seconds"),
               Column("over the practice"), Column("distance"), Column("upper third of E(l)"),
               *(Column(name) for name in ("energy", "enstrophy", "tr W⁴")), Column("spectrum"))
    blocks = {}
    for judged in findings.judged.values():
        blocks.setdefault((judged.ensemble.role, judged.setting.integrator), []).append(setting_row(findings, judged))
    return [
        Heading(f"Every setting, n = {n}"),
        Paragraph(f"{size.draws} draws to T = {size.time:g}; {len(findings.reference.degrees)} degrees are compared."
                  f" Faithful, and bold: a distance of at most {percentage(findings.reference.threshold)}. Changes of"
                  " averages are relative: of E(l) against the reference, else against the initial values. Spectrum:"
                  " the largest error of an eigenvalue at the end. The first block is the practice."),
        *unjudged_paragraphs(study, n),
        Table(columns, list(blocks.values())),
    ]


def setting_row(findings, judged):
    setting = judged.setting
    head = [setting.integrator, f"{setting.step:.3g}", f"{setting.tolerance:g}"]
    if not judged.ensemble.works:
        return [*map(Entry, head), Entry(MISSING), Entry(MISSING), Entry(failure_text(judged.ensemble)),
                *[Entry(MISSING)] * 5]
    return [*map(Entry, head), Entry(MISSING if judged.seconds is None else three_digits(judged.seconds)),
            Entry(ratio_text(findings.over_practice(judged))),
            Entry(percentage(judged.distance), judged.faithful), Entry(signed(judged.tail)),
            *(Entry(signed(judged.changes[name])) for name in CONSERVED), Entry(scientific(judged.spectrum_error))]


def failure_text(ensemble):
    """Writes how many of the draws failed, how and when, as "3 of 10 unstable, t = 90 to 120"."""
    failed = [run for run in ensemble.runs if not run.works]
    how = " or ".join(dict.fromkeys(run.status for run in failed))
    times = span([run.time for run in failed], lambda time: f"{time:.3g}")
    return f"{len(failed)} of {len(ensemble.runs)} {how}, t = {times}"


def signed(change):
    """Writes a relative change in percent with its sign, with two digits."""
    return f"{100 * change:+.2g} %" if abs(change) >= 5e-7 else "0"


def published_parts(study):
    table = published_table(study)
    return [Heading("The practice in its published form"), table] if list(table.rows()) else []


def published_table(study):
    """Returns what the practice costs in its published form and over the fast one, where that was timed."""
    rows = []
    for n, ensembles in study.ensembles.items():
        for setting, ensemble in ensembles.items():
            over = published_over_fast(study, n, setting)
            if ensemble.role == PRACTICE and over:
                seconds = statistics.geometric_mean(times_of_run(study, n, setting, PUBLISHED))
                rows.append([str(n), f"{setting.step:.3g}", f"{setting.tolerance:g}", three_digits(seconds),
                             ratio_text(over)])
    return plain_table((Column("n"), Column("h"), Column("tolerance"), Column("CPU seconds, published"),
                        Column("over the fast form")), rows)


def how_parts(study, found):
    """Returns how data, reference, distances and costs come about."""
    settings = study.settings
    return [
        Paragraph(f"Initial data: modes l = {settings.lowest_degree} … {settings.highest_degree}, complex coefficients"
                  " of equal variance by a seeded generator, real where m = 0, the same at every n; then ‖W₀‖₂ = 1."
                  " They have no part with l = 1, so the co-rotating frame changes nothing."),
        Paragraph("The reference: ensembles displaced by"
                  f" {settings.displacement:g} along the coadjoint orbit, relative to ‖W₀‖. Change by h/2: of"
                  " W(20) of the first draw, relative. Distance: the median of two reference ensembles."),
        reference_table(study, found),
        Paragraph("How two runs of the reference method part that begin close to each other: the time from which they"
                  f" differ by {PARTED:g} of ‖W‖, a correlation of {correlation(PARTED):.3g}, and their difference at"
                  " T/2; independent states differ by √2. A setting is judged if the least difference at T/2 of the"
                  f" pairs {settings.displacement:g} apart is at least {INDEPENDENT:g}, a correlation of"
                  f" {correlation(INDEPENDENT):.3g}. Their difference grows on during the averages over T/2 … T."),
        parting_table(study),
        Paragraph("Distance: the logarithms of E(l), averaged over T/2 … T, minus their mean over the reference"
                  " ensembles of the same draw; mean over the draws; root mean square over the degrees that have more"
                  f" than {LEAST_SHARE:g} of the energy. Faithful: at most the {LEVEL:.0%} quantile of {COUNT}"
                  " bootstrap samples, each as many draws with replacement and of each one reference run against the"
                  " mean of the others. With few draws this threshold is wide, and a faithful setting is less sure."
                  " Every degree weighs alike: the energy of the largest scales, best known and the largest part,"
                  " counts as one degree of all. A setting may be off by many of its standard errors there and be"
                  " called faithful."),
        Paragraph("A run fails by its solver, or as unstable: not finite, or its energy off by more than"
                  f" {settings.energy_loss:.0%}. Sweep cap: a step took more than {settings.max_sweeps} sweeps, which"
                  " would be expensive; with the default cap of 1000 such a run may go on. A setting with a failed draw"
                  " has no average."),
        Paragraph("CPU seconds: the geometric mean over fresh processes of the time of a step, times the number of"
                  f" steps. Each process times all settings of one n in turns, from the state of the first draw at T/2,"
                  f" behind {settings.warm_steps} steps that are not timed. Ratios have the 95 % interval over the"
                  f" processes; with fewer than {FEWEST} nothing is decided. Sampling is not in it. RK4 has no use for"
                  " the tolerance, with or without the projection."),
        timing_table(study),
    ]


def correlation(difference):
    """Returns the correlation of two states of one norm with this relative difference."""
    return 1 - difference ** 2 / 2


def reference_table(study, found):
    rows = [[str(n), str(size.draws), f"{size.time:g}", size.reference_integrator, f"{size.reference_step:g}",
             str(size.references), scientific(size.reference_error), percentage(found[n].reference.typical)]
            for n, size in study.sizes.items()]
    return plain_table((Column("n"), Column("draws"), Column("T"), Column("reference", align="left"), Column("h"),
                        Column("ensembles"), Column("change by h/2"), Column("distance")), rows)


def parting_table(study):
    """Returns when runs that begin close to each other have parted, and how far apart they are at T/2."""
    rows = []
    for n in study.sizes:
        for displacement in (study.settings.displacement, study.settings.small_displacement):
            times = [parting.time for parting in study.partings[n]
                     if parting.displacement == displacement and parting.time is not None]
            differences = study.at_window(n, displacement)
            rows.append([str(n), f"{displacement:g}", f"{len(times)} of {len(differences)}",
                         span(times, lambda time: f"{time:.3g}") if times else MISSING, two_digits(min(differences)),
                         two_digits(statistics.median(differences))])
    return plain_table((Column("n"), Column("apart at t = 0"), Column("parted"), Column("at t"),
                        Column("least difference at T/2"), Column("median")), rows)


def timing_table(study):
    """Returns over how many processes, steps and units of time costs were measured."""
    rows = []
    for n in study.sizes:
        for solver in SOLVERS:
            costs = [cost for (at, _, form), cost in study.costs.items() if (at, form) == (n, solver) and cost.seconds]
            if costs:
                rows.append([str(n), solver, str(len(costs[0].seconds)), span([cost.steps for cost in costs], str),
                             span([cost.steps * cost.step for cost in costs], lambda time: f"{time:.3g}")])
    return plain_table((Column("n"), Column("form", align="left"), Column("processes"), Column("timed steps"),
                        Column("units of time")), rows)


def few_draws_paragraphs(study):
    """Says where verdicts are not supported: by few draws, whose references begin close and share a history."""
    sizes = [n for n, size in study.sizes.items() if size.draws < FEWEST]
    if not sizes:
        return []
    return [Paragraph(f"At n = {', '.join(map(str, sizes))} the verdicts decide nothing. There are fewer than"
                      f" {FEWEST} draws, and reference ensembles that begin close to each other have one history until"
                      " they part, with the same large vortices. To be measured anew with independent references.")]


def unjudged_paragraphs(study, n):
    """Says that nothing is judged where runs of reference ensembles are not independent at T/2."""
    if study.is_unpredictable(n):
        return []
    return [Paragraph("Nothing is judged here: in some draw, runs of two reference ensembles are still correlated at"
                      " T/2, so their distance from one another is not that of independent ones.")]
