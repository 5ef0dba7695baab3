"""The report of the study of turbulence: settings against the reference, costs, and how it is judged."""

from lib.records.findings import FILE, as_json
from lib.records.integrators import GAUSS, KEPT
from lib.judging.verdicts import FEWEST, MARGIN
from lib.pages.document import Column, Entry, Heading, Paragraph, Table, conditions, plain_table, shown
from lib.pages.numbers import MISSING, percentage, scientific, span, three_digits, two_digits
from lib.pages.rendering import Rendering
from studies.tables.comparison import ratio_text
from studies.turbulence.against_reference import INVARIANTS, TOLERANCE, judgement_of, methods_of
from studies.turbulence.judge import NOT_JUDGED, figures, findings
from studies.turbulence.schema import LOOSE, QUARTERS, read_turbulence
from studies.turbulence.statistics import COUNT, MIN_SPREAD, LEVEL, TRIALS

KEEPING = {**KEPT, next(iter(KEPT)): "any"}  # what is asked of a method, the least first
CHARTS = (
    ("cheapest_faithful", "CPU time of the cheapest faithful setting of each method over that of the baseline, which"
     " tables call the baseline. Methods stand below what they keep."),
    ("band_energies", "Energy in bands of degrees l against that of the reference: of the cheapest faithful setting,"
     " the cheapest that keeps the Lie–Poisson structure, and the one that is furthest off. Grey: chance."),
)


def turbulence_sections(study, found, charts):
    """Returns the document of a Turbulence and its Judgements by n; `charts` are the names of the charts beside it."""
    times = " and ".join(dict.fromkeys(f"T = {size.time:g}" for size in study.sizes.values()))
    return [
        Heading("Statistics of turbulence, and what they cost", 1),
        Paragraph(f"Do runs to {times} with other methods, longer steps or looser tolerances have the same statistics"
                  " over T/2 … T? An ensemble is faithful if no quantity is further from the reference than chance"
                  " explains, no sample is lost, and energy and enstrophy of every sample average to the initial values"
                  f" within {TOLERANCE:.0%}. Nothing follows for longer runs."),
        *shown(CHARTS, charts),
        Heading("The cheapest faithful settings"),
        Paragraph("Of all methods, of those that keep the spectrum, and of Lie–Poisson methods. Times are those of one"
                  f" run to {times}. The baseline: isospectral midpoint rule, h = ħ/4, tolerance 1e-8, fast form."
                  f" Products are equivalent ones, a unit of time. Tie: within {MARGIN - 1:.0%}; undecided: the"
                  " interval holds a bound of that, or there are too few processes."),
        cheapest_table(study, found),
        Heading("Gauss methods by order"),
        Paragraph(f"The cheapest faithful setting of each to {times}."),
        gauss_table(study, found),
        *(part for n in study.sizes for part in size_sections(study, n, found[n])),
        *lost_parts(study),
        Heading("How far to trust it"),
        *trust_parts(study, found),
        Heading("How it is judged"),
        *how_parts(study, times),
        conditions(study.context),
    ]


# ---- the cheapest


def cheapest_table(study, found):
    rows = []
    for n, judgement in found.items():
        for structure, words in KEEPING.items():
            def allowed(judged, structure=structure):
                return judged.has(structure)

            level = [", ".join(map(setting_text, each)) or MISSING for each in judgement.level_with_cheapest(allowed)]
            rows.append([str(n), f"{study.sizes[n].time:g}", words,
                         *setting_cells(judgement, judgement.cheapest(allowed)), *level])
    return plain_table((Column("n"), Column("T"), Column("keeps", align="left"), *SETTING_COLUMNS,
                        Column("tie with it", align="left"), Column("undecided", align="left")), rows)


SETTING_COLUMNS = (Column("integrator", align="left"), Column("h"), Column("tolerance"), Column("products"),
                   Column("CPU seconds"), Column("over the baseline"), Column("largest |z|"))


def gauss_table(study, found):
    rows = [[str(n), f"{study.sizes[n].time:g}", str(study.integrators[name].order),
             *setting_cells(judgement, judgement.cheapest(lambda judged, name=name: judged.setting.integrator == name))]
            for n, judgement in found.items() for name in methods_of(judgement)
            if study.integrators[name].family == GAUSS]
    return plain_table((Column("n"), Column("T"), Column("order"), *SETTING_COLUMNS), rows)


def setting_text(judged):
    """Writes a setting, as "elp4 with h = 1", with its tolerance where that is not the usual one."""
    setting = judged.setting
    tolerance = "" if setting.tolerance == LOOSE else f" to {setting.tolerance:g}"
    return f"{setting.integrator} with h = {setting.step:.3g}{tolerance}"


def head_cells(judged):
    return [judged.setting.integrator, f"{judged.setting.step:.3g}", f"{judged.setting.tolerance:g}",
            two_digits(judged.products)]


def setting_cells(judgement, judged):
    if judged is None:
        return [MISSING if judgement.decides else NOT_JUDGED, *[MISSING] * (len(SETTING_COLUMNS) - 1)]
    return [*head_cells(judged), three_digits(judged.seconds), ratio_text(judgement.over_baseline(judged)),
            two_digits(judged.distance)]


# ---- every setting


def size_sections(study, n, judgement):
    """Returns the table of every setting at one n."""
    size = study.sizes[n]
    columns = (*SETTING_COLUMNS, Column("of", align="left"), *(Column(name) for name in INVARIANTS),
               Column("spectrum"), Column("faithful", align="left"))
    blocks = {}
    for judged in judgement.judged.values():
        blocks.setdefault((judged.ensemble.role, judged.setting.integrator), []).append(setting_row(judgement, judged))
    return [
        Heading(f"Every setting, n = {n}, T = {size.time:g}"),
        Paragraph(f"{size.samples} samples. Within chance, and bold: a largest |z| of at most"
                  f" {two_digits(judgement.reference.threshold)}. Energy, enstrophy: change of the average from the"
                  f" initial value, the mean over the samples; bold where it is within {TOLERANCE:.0%} in every sample."
                  " Spectrum: the largest error of an eigenvalue at the end. The first block is the baseline."),
        *limited_paragraphs(judgement),
        Table(columns, list(blocks.values())),
    ]


def setting_row(judgement, judged):
    if not judged.ensemble.works:
        lost = f"no: {judged.ensemble.failed} of {len(judged.ensemble.runs)} samples lost"
        return [*map(Entry, head_cells(judged)), *[Entry(MISSING)] * 7, Entry(lost)]
    return [*map(Entry, head_cells(judged)), Entry(MISSING if judged.seconds is None else three_digits(judged.seconds)),
            Entry(ratio_text(judgement.over_baseline(judged))),
            Entry(two_digits(judged.distance), judged.within_chance), Entry(quantity_text(judged.largest)),
            *(Entry(signed(judged.changes[name]), judged.worst[name] <= TOLERANCE) for name in INVARIANTS),
            Entry(scientific(judged.spectrum_error)), Entry(verdict_text(judgement, judged), judged.faithful)]


def verdict_text(judgement, judged):
    """Writes whether a setting without a lost sample is faithful, or what is not: "no: statistics, energy"."""
    if not judgement.decides:
        return NOT_JUDGED
    off = ["statistics"] * (not judged.within_chance)
    off += [name for name in INVARIANTS if judged.worst[name] > TOLERANCE]
    return f"no: {', '.join(off)}" if off else "yes"


def quantity_text(quantity):
    """Writes a Quantity, as "l = 3–5" or "l = 4 after 12"."""
    lowest, highest, lag = quantity
    return f"l = {lowest}–{highest}" if lag is None else f"l = {lowest} after {lag:g}"


def signed(change):
    """Writes a relative change in percent with its sign, with two digits."""
    return f"{100 * change:+.2g} %" if abs(change) >= 5e-7 else "0"


def limited_paragraphs(judgement):
    """Says where nothing is judged, and where another spread than that of reference runs counts."""
    if not judgement.decides:
        return [Paragraph(f"Nothing is judged here: there are fewer than {FEWEST} samples.")]
    if judgement.spreads.are_independent:
        return []
    return [Paragraph("Reference runs that begin close to each other share a history here: they spread less than those"
                      " that begin further apart. So scores take the wider spread of the latter. Fewer wrong settings"
                      " are found, and fewer right ones called wrong.")]


def lost_parts(study):
    """Returns the table of the samples that lost a run: none if there are none."""
    rows = [[str(n), ensemble.setting.integrator, f"{ensemble.setting.step:.3g}", f"{ensemble.setting.tolerance:g}",
             f"{ensemble.failed} of {len(ensemble.runs)}",
             ", ".join(dict.fromkeys(run.status for run in ensemble.lost)),
             ", ".join(f"{run.sample} at {run.time:.3g}" for run in ensemble.lost)]
            for n, ensembles in study.ensembles.items() for ensemble in ensembles.values() if ensemble.lost]
    if not rows:
        return []
    return [Heading("Samples that were lost"),
            Paragraph(f"By the solver, or unstable: not finite, or the energy off by {study.settings.energy_loss:.0%}."
                      f" Sweep cap: a step took more than {study.settings.max_sweeps} sweeps, which would be expensive;"
                      " with the default cap of 1000 such a run may go on. A setting that loses a sample is not"
                      " faithful."),
            plain_table((Column("n"), Column("integrator", align="left"), Column("h"), Column("tolerance"),
                         Column("lost"), Column("how", align="left"), Column("sample and t", align="left")), rows)]


# ---- how far to trust it


def trust_parts(study, found):
    """Returns what was measured of the judgement itself: false positives, independence, stationarity."""
    settings = study.settings
    moving = [n for n, judgement in found.items() if not judgement.is_stationary]
    return [
        Paragraph(f"False positives: the share of {TRIALS} right ensembles that are called wrong, {1 - LEVEL:.0%} is"
                  " expected. Each takes one run of each sample, chosen at random from all reference and far runs, and"
                  " is judged by others of them, with a threshold found anew; from far runs alone where reference runs"
                  " share a history. So a few of the settings that are right are called unfaithful by chance. Far: the"
                  " largest |z| of each far ensemble."),
        trust_table(study, found),
        Paragraph(f"Independence: reference ensembles begin {settings.displacement:g} apart, far ones"
                  f" {settings.far_displacement:g}, along the coadjoint orbit, at constant energy. The spread of"
                  " reference runs of one sample over that of far runs, with its 95 % interval over resampled samples:"
                  " it is 1 where the distance at the start is forgotten, and smaller where runs share a history. They"
                  f" are taken to share one unless the interval of all quantities together begins at {MIN_SPREAD:g} or"
                  " above; then the spread of far runs counts, with the reference's means. Deviation: of one run that"
                  " counts, relative for bands. Minimum: the mean difference over the samples at which |z|"
                  " reaches the threshold; what is wrong by less passes."),
        spread_table(found),
        Paragraph("Stationarity: the change of a band's energy from the first to the last quarter of T/2 … T, by all"
                  " reference and far runs; in brackets over its standard error by samples. Bold: beyond chance, at 5 %"
                  " over all bands of an n." + transient_text(study, moving)),
        drift_table(found),
    ]


def transient_text(study, moving):
    """Says where averages are those of a transient."""
    few = [n for n, size in study.sizes.items() if size.samples < FEWEST]
    unjudged = f" Too few samples for this: n = {', '.join(map(str, few))}." if few else ""
    if not moving:
        return f" No band changes beyond chance.{unjudged}"
    places = ", ".join(f"n = {n}, T = {study.sizes[n].time:g}" for n in moving)
    return (f" So at {places} the averages are those of a transient at equal times, not of a stationary state, and they"
            f" depend on T.{unjudged}")


def trust_table(study, found):
    rows = [[str(n), f"{size.time:g}", str(size.samples), str(size.references), str(size.far),
             two_digits(found[n].reference.threshold), percentage(found[n].false_positives),
             ", ".join(map(two_digits, found[n].far_distances))] for n, size in study.sizes.items()]
    return plain_table((Column("n"), Column("T"), Column("samples"), Column("reference ensembles"),
                        Column("far ensembles"), Column("threshold of |z|"), Column("false positives"),
                        Column("far")), rows)


def spread_table(found):
    rows = []
    for n, judgement in found.items():
        spreads, reference = judgement.spreads, judgement.reference
        minimum = reference.threshold * reference.chance
        for place, name in enumerate((*map(quantity_text, judgement.quantities), "all")):
            own = [percentage(each[place]) if place < len(minimum) else MISSING
                   for each in (reference.deviations, minimum)]
            rows.append([str(n), name, *own, two_digits(spreads.ratio[place]),
                         f"{two_digits(spreads.low[place])}–{two_digits(spreads.high[place])}"])
    return plain_table((Column("n"), Column("quantity", align="left"), Column("deviation"), Column("minimum"),
                        Column("spread over that of far runs"), Column("95 %")), rows)


def drift_table(found):
    """Returns the change of each band between quarters, an n a row."""
    bands = list(dict.fromkeys(band for judgement in found.values() for band in judgement.drifts))

    def entry(drifts, band):
        if band not in drifts:
            return Entry(MISSING)
        return Entry(f"{signed(drifts[band].change)} ({drifts[band].score:+.1f})", not drifts[band].is_stationary)

    return Table((Column("n"), *(Column(quantity_text(band)) for band in bands)),
                 [[[Entry(str(n)), *(entry(judgement.drifts, band) for band in bands)]
                   for n, judgement in found.items()]])


# ---- how it is judged


def how_parts(study, times):
    """Returns how data, reference, distances and costs come about."""
    settings = study.settings
    lags = " and ".join(f"{lag:g}" for lag in settings.lags)
    return [
        Paragraph(f"Initial data: modes l = {settings.lowest_degree} … {settings.highest_degree}, complex coefficients"
                  " of equal variance by a seeded generator, real where m = 0, the same at every n; then ‖W₀‖₂ = 1."
                  " They have no part with l = 1, so the co-rotating frame changes nothing."),
        Paragraph("The reference, by a method whose change by h/2 is that of W(20) of the first sample, relative:"),
        reference_table(study),
        Paragraph("Quantities: the logarithm of the energy in each band of degrees l, averaged over T/2 … T, and the"
                  f" decorrelation of the coefficients with l = {settings.correlated_degree} after {lags} units of"
                  " time, that is the mean |ω(t + lag) − ω(t)|² over twice the mean |ω|². The score z of a setting: the"
                  " difference from the mean of the reference ensembles of the same sample, mean over the samples, over"
                  " its standard deviation by chance, from the spread of the runs of one sample that count. So each"
                  " quantity is weighted by how well it is known. Within chance: the largest |z| is at most the"
                  f" {LEVEL:.0%} quantile of {COUNT} samples, each with one reference run of each sample held out at"
                  " random and judged by the others."),
        Paragraph("Energy and enstrophy have a tolerance of their own: reference runs keep them, so that they have no"
                  f" spread. The averages are divided into {QUARTERS} quarters for the stationarity alone."),
        Paragraph("CPU seconds: the geometric mean over fresh processes of the time of a step, times the number of"
                  f" steps to {times}. Each process times all settings of one n interleaved, from the state of the"
                  f" first sample at T/2, behind {settings.warm_steps} steps that are not timed. Ratios have the 95 %"
                  f" interval over the processes; with fewer than {FEWEST} nothing is decided. Sampling is not in it."
                  " Explicit methods have no use for the tolerance, with or without the projection."),
        timing_table(study),
    ]


def reference_table(study):
    rows = []
    for n, size in study.sizes.items():
        runs = [run for sample in study.references[n] for run in sample]
        rows.append([str(n), f"{size.time:g}", size.reference_integrator, f"{size.reference_step:g}",
                     scientific(size.reference_error), scientific(max(run.energy_error for run in runs)),
                     scientific(max(run.spectrum_error for run in runs))])
    return plain_table((Column("n"), Column("T"), Column("reference", align="left"), Column("h"),
                        Column("change by h/2"), Column("energy error"), Column("spectrum error")), rows)


def timing_table(study):
    """Returns over how many processes, steps and units of time costs were measured."""
    rows = []
    for n in study.sizes:
        costs = [cost for (at, _), cost in study.costs.items() if at == n]
        if costs:
            rows.append([str(n), str(len(costs[0].seconds)), span([cost.steps for cost in costs], str),
                         span([cost.steps * cost.step for cost in costs], lambda time: f"{time:.3g}")])
    return plain_table((Column("n"), Column("processes"), Column("timed steps"), Column("units of time")), rows)


def rendered(raw, _recorded):
    """Returns the Rendering of a raw file."""
    study = read_turbulence(raw)
    from studies.turbulence import charts  # only now: it needs matplotlib

    judgements = {n: judgement_of(study, n) for n in study.sizes}
    found = findings(study, judgements)
    return Rendering(lambda names: turbulence_sections(study, judgements, names), figures(found),
                     {name: getattr(charts, name)(study, judgements) for name, _ in CHARTS},
                     {FILE: as_json("turbulence", found)})
