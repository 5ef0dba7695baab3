"""The report of the study of turbulence: settings against the reference, costs, and how it is judged."""

import statistics

from lib.comparison import MISSING, percentage, three_digits
from lib.document import Column, Entry, Heading, Paragraph, Table, conditions, plain_table, shown
from lib.formats import FAST, PUBLISHED
from lib.integrator_names import KEPT
from lib.numbers import scientific, span, two_digits
from lib.turbulence_figures import (CLOSE, CONSERVED, findings_of, largest_faithful_step, methods_of,
                                    seconds_of_run)
from lib.turbulence_files import PRACTICE
from lib.turbulence_statistics import COUNT, LEAST_SHARE, LEVEL

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
                  f" Close: energy, enstrophy and tr W⁴ average to the initial values within {CLOSE:.0%} too."),
        cheapest_table(found),
        Heading("The largest faithful step"),
        Paragraph(f"Of the steps tried, at a tolerance of 1e-8. {MISSING}: none. Over 30 settings are judged at an n,"
                  " and one in 20 of those that are right is called unfaithful by chance. A step"
                  " that fails in one draw is not faithful."),
        steps_table(found),
        *(part for n in study.sizes for part in size_sections(study, n, found[n])),
        Heading("How it is judged"),
        *how_paragraphs(study, found),
        conditions(study.context),
    ]


def cheapest_table(found):
    rows = []
    for n, findings in found.items():
        for structure, words in KEEPING.items():
            for close in (False, True):
                best = findings.cheapest(lambda judged: judged.has(structure) and (judged.conserves or not close))
                rows.append([str(n), f"{words}, close" if close else words, *setting_cells(findings, best)])
    return plain_table((Column("n"), Column("keeps", align="left"), Column("integrator", align="left"), Column("h"),
                        Column("tolerance"), Column("CPU seconds"), Column("over the practice"), Column("distance")),
                       rows)


def setting_cells(findings, judged):
    if judged is None:
        return [MISSING] * 6
    over = findings.over_practice(judged)
    return [judged.setting.integrator, f"{judged.setting.step:.3g}", f"{judged.setting.tolerance:g}",
            three_digits(judged.seconds), MISSING if over is None else two_digits(over),
            percentage(judged.distance)]


def steps_table(found):
    names = list(dict.fromkeys(name for findings in found.values() for name in methods_of(findings)))

    def cell(findings, name):
        step = largest_faithful_step(findings, name)
        return MISSING if step is None else f"{step:.3g}"

    rows = [[name, *(cell(findings, name) for findings in found.values())] for name in names]
    return plain_table((Column("integrator", align="left"), *(Column(f"n = {n}") for n in found)), rows)


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
        *published_paragraphs(study, n),
    ]


def setting_row(findings, judged):
    setting, over = judged.setting, findings.over_practice(judged)
    head = [setting.integrator, f"{setting.step:.3g}", f"{setting.tolerance:g}"]
    if not judged.ensemble.works:
        return [*map(Entry, head), Entry(MISSING), Entry(MISSING), Entry(failure_text(judged.ensemble)),
                *[Entry(MISSING)] * 5]
    return [*map(Entry, head), Entry(MISSING if judged.seconds is None else three_digits(judged.seconds)),
            Entry(MISSING if over is None else two_digits(over)),
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


def published_paragraphs(study, n):
    """Says what the practice costs in its published form, where that was timed."""
    found = []
    for ensemble in study.ensembles[n].values():
        fast, published = (seconds_of_run(study, n, ensemble.setting, solver) for solver in (FAST, PUBLISHED))
        if ensemble.role == PRACTICE and fast and published:
            found.append(Paragraph(f"The practice at a tolerance of {ensemble.setting.tolerance:g} takes"
                                   f" {three_digits(published)} s in its published form,"
                                   f" {two_digits(published / fast)} times the fast one."))
    return found


def how_paragraphs(study, found):
    settings = study.settings
    yield Paragraph(f"Initial data: modes l = {settings.lowest_degree} … {settings.highest_degree}, complex"
                    " coefficients of equal variance by a seeded generator, real where m = 0, the same at every n; then"
                    " ‖W₀‖₂ = 1. They have no part with l = 1, so the co-rotating frame changes nothing.")
    for n, size in study.sizes.items():
        yield Paragraph(parting_text(study, n) + f" The reference is {size.reference_integrator} with h ="
                        f" {size.reference_step:g}, {size.references} ensembles displaced by"
                        f" {settings.displacement:g} along the coadjoint orbit; half its step changes W(20) by"
                        f" {scientific(size.reference_error)}.")
    yield Paragraph("Distance: the logarithms of E(l), averaged over T/2 … T, minus their mean over the reference"
                    " ensembles of the same draw; mean over the draws; root mean square over the degrees that have more"
                    f" than {LEAST_SHARE:g} of the energy. Faithful: at most the {LEVEL:.0%} quantile of {COUNT}"
                    " bootstrap samples, each as many draws with replacement and of each one reference run against the"
                    " mean of the others.")
    yield Paragraph(f"A run fails by its solver (at most {settings.max_sweeps} sweeps a step), or as unstable: not"
                    f" finite, or its energy off by more than {settings.energy_loss:.0%}. A setting with a failed draw"
                    " has no average.")
    yield Paragraph("CPU seconds: the median time of a step, from the first draw at T/2, timed in turns, times the"
                    " number of steps. Sampling is not in it. RK4 has no use for the tolerance, with or without the"
                    " projection.")
    yield Paragraph("Median distance of two reference ensembles: " + "; ".join(
        f"{percentage(findings.reference.typical)} at n = {n}" for n, findings in found.items()) + ".")


def parting_text(study, n):
    """Says when runs that begin close to each other have parted."""
    size, settings, found = study.sizes[n], study.settings, []
    for displacement in (settings.displacement, settings.small_displacement):
        partings = [parting for parting in study.partings[n] if parting.displacement == displacement]
        times = [parting.time for parting in partings if parting.time is not None]
        difference = statistics.median(parting.at_window for parting in partings)
        when = f" at t = {span(times, lambda time: f'{time:.3g}')}" if times else ""
        found.append(f"{len(times)} of {len(partings)} pairs of runs {displacement:g} apart differ by half of"
                     f" ‖W‖{when}, median at T/2 {two_digits(difference)}")
    return f"n = {n}, T/2 = {size.time / 2:g}: " + "; ".join(found) + ". Independent states differ by √2."


def unjudged_paragraphs(study, n):
    """Says that nothing is judged where reference ensembles are still one trajectory at T/2."""
    if study.is_unpredictable(n):
        return []
    return [Paragraph("Nothing is judged here: reference ensembles are still the same trajectory at T/2, so their"
                      " distance from one another is not that of independent ones.")]
