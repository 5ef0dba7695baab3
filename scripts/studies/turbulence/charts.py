"""Draws the study of turbulence: what the cheapest faithful setting of each method costs, and how energies differ."""

import math

from matplotlib.ticker import NullLocator

from lib.pages.chart_panels import KEEPING, LABEL_SIZE, equals, label_ends, look, new_figure, note, percent
from lib.records.integrators import KEPT, name_with_order, strongest_structure
from lib.pages.numbers import power, two_digits
from studies.turbulence.against_reference import TOLERANCE, methods_of
from studies.turbulence.schema import LOOSE
from lib.judging.verdicts import FEWEST

PLAIN_TITLE = "Turbulence: cost of the cheapest faithful setting of each method"
BAR = 0.7  # height, over that of a row
ROW, HEADS = 0.27, {"nothing": "keeps nothing", "spectrum": "keeps the spectrum",
                    "poisson": "keeps the Lie–Poisson structure"}  # inches of a row; of the groups of methods


def cheapest_faithful(study, found):
    """Draws the cost of the cheapest faithful setting of each method over that of the baseline, a panel an n.

    `found` are its Judgements by n. Methods stand below what they keep, the cheapest first; where none of the settings
    that were tried is faithful, that is written. None where no n has a faithful setting whose cost is known.
    """
    found = {n: each for n, each in found.items() if each.over_baseline(each.cheapest())}
    if not found:
        return None
    rows = {n: rows_of(study, each) for n, each in found.items()}
    height = ROW * max(map(len, rows.values()))
    figure, (panels,) = new_figure(title_of(study, found), 1, len(found), height, keys=3, sharex=True,
                                   labels=["rk4_projected, h = 0.125, 1e-4"])
    for axes, (n, judgement) in zip(panels, found.items()):
        axes.set(title=f"n = {n}, T = {study.sizes[n].time:g}", ylim=(len(rows[n]) - 0.3, -0.7),
                 xlabel="CPU time of a run over that of the baseline")
        axes.grid(False, axis="y")
        for place, (structure, name, best) in enumerate(rows[n]):
            if name is None:
                axes.text(0, place, HEADS[structure], va="center", fontweight="bold")
            elif best is None:
                axes.text(0.003, place, f"{name_with_order(study.integrators[name])}: no setting that was tried is"
                          " faithful", va="center", color="0.4")
            else:
                draw_bar(axes, study.integrators[name], place, judgement.over_baseline(best), best.setting)
        axes.yaxis.set_major_locator(NullLocator())
        axes.spines["left"].set_visible(False)
    panels[0].set_xlim(left=0)
    note(figure, "Faithful: the statistics are within chance of the reference, and energy and enstrophy are kept to"
         f" {percent(TOLERANCE)}. Baseline: isospectral midpoint with h = ħ/4, whose bar would end at 1. Tolerance"
         f" {power(LOOSE)}, or as said; methods stand below what they keep at 1e-13. Lines: 95 % intervals of the cost"
         " over processes; sampling is not in them.", study.context)
    return figure


def rows_of(study, judgement):
    """Returns the rows of a panel as (structure, method, its cheapest faithful setting or None).

    The first row of a structure, its heading, has no method.
    """
    rows = []
    for structure in KEPT:
        own = [name for name in methods_of(judgement) if strongest_structure(study.integrators[name]) == structure]
        best = {name: judgement.cheapest(lambda judged, name=name: judged.setting.integrator == name) for name in own}
        order = sorted(own, key=lambda name: (best[name] is None, best[name] and best[name].seconds))
        rows += [(structure, None, None), *((structure, name, best[name]) for name in order)] if own else []
    return rows


def draw_bar(axes, integrator, place, over, setting):
    """Draws the cost of a setting over the baseline's, a Ratio, with its interval where there are processes enough."""
    axes.barh(place, over.ratio, BAR, color=look(integrator)["color"], label=setting.integrator)
    end = over.ratio
    if over.processes >= FEWEST:
        axes.hlines(place, over.low, over.high, color="black", linewidth=1.2)
        end = over.high
    tolerance = "" if setting.tolerance == LOOSE else f", {power(setting.tolerance)}"
    axes.annotate(f"{name_with_order(integrator)}, h = {setting.step:.3g}{tolerance}", (end, place), (6, 0),
                  textcoords="offset points", va="center", fontsize=LABEL_SIZE, annotation_clip=False)


def title_of(study, found):
    """Returns what the cheapest faithful runs cost, at the largest n: of all, and of those that keep the structure."""
    n = max(found)
    judgement = found[n]
    run = f"Turbulence at {equals('n', n)} to {equals('T', format(study.sizes[n].time, 'g'))}"
    told = [(setting_text(study, judgement, best), words) for words, structure in
            (("", "nothing"), (" with the Lie–Poisson structure", "poisson"))
            if (best := judgement.cheapest(lambda judged, structure=structure: judged.has(structure)))]
    costs = [f"{text[1]} of the baseline's time{words} ({text[0]})" for text, words in told]
    return f"{run}: the same statistics for {', '.join(costs)}" if told else PLAIN_TITLE


def setting_text(study, judgement, best):
    """Returns the method of a setting, and its cost over the baseline's."""
    return (name_with_order(study.integrators[best.setting.integrator]),
            two_digits(judgement.over_baseline(best).ratio))


# ---- energies


def band_energies(study, found):
    """Draws by how much the energy in each band of degrees differs from that of the reference, a panel an n.

    `found` are its Judgements by n, settings those of examples(). Grey is what chance explains. None where nothing is
    judged.
    """
    told = {n: examples(judgement) for n, judgement in found.items() if judgement.decides and examples(judgement)}
    if not told:
        return None
    labels = {n: [with_step(study, judged) for judged in settings] for n, settings in told.items()}
    figure, (panels,) = new_figure(bands_title(study, found, told), 1, len(told), 4.4, keys=3, sharey=True,
                                   labels=sum(labels.values(), []))
    for axes, (n, settings) in zip(panels, told.items()):
        bands = list(found[n].drifts)
        places = range(len(bands))
        unseen = [found[n].reference.threshold * chance for chance in found[n].reference.chance[:len(bands)]]
        heights, lower_ends = [200 * each for each in unseen], [-100 * each for each in unseen]
        axes.bar(places, heights, 0.9, lower_ends, color="0.88", zorder=0)
        axes.axhline(0, color="0.6", linewidth=0.8)
        ends = []
        for judged, label in zip(settings, labels[n]):
            style = look(study.integrators[judged.setting.integrator], judged.setting.tolerance)
            changes = [100 * change for change in changes_of(found[n], judged)]
            axes.plot(places, changes, label=judged.setting.integrator, **style)
            ends.append(((len(bands) - 0.5, changes[-1]), label, style["color"]))
        axes.set(title=f"n = {n}, T = {study.sizes[n].time:g}", xlabel="degrees l of the band",
                 xlim=(-0.5, len(bands) - 0.5))
        axes.set_xticks(places, [band_text(band) for band in bands])
        axes.grid(False, axis="x")
        axes.ends = ends
    highest = 1.05 * max(map(abs, panels[0].get_ylim()))
    panels[0].set(ylabel="energy, change from the reference in %", ylim=(-highest, highest))
    for axes in panels:
        label_ends(axes, axes.ends)
    note(figure, "Averages over T/2 … T, mean over the samples, of the cheapest faithful setting, the cheapest that"
         " keeps the Lie–Poisson structure, and the one furthest off. Grey: what chance explains; a faithful setting"
         f" stays within it in every band. Lighter where a method keeps less at its tolerance. {KEEPING}")
    return figure


def examples(judgement):
    """Returns the settings whose energies are drawn, as Judged, each once: the cheapest faithful one, the cheapest of
    them with the Lie–Poisson structure, and the one that is furthest from the reference."""
    furthest = max((judged for judged in judgement.judged.values() if judged.distance),
                   key=lambda judged: judged.distance, default=None)
    found = (judgement.cheapest(), judgement.cheapest(lambda judged: judged.has("poisson")), furthest)
    return list({judged.setting: judged for judged in found if judged}.values())


def changes_of(judgement, judged):
    """Returns the relative change of the energy in each band from the reference's, the mean over the samples."""
    return [math.exp(judged.scores[band] * chance) - 1
            for band, chance in zip(judgement.drifts, judgement.reference.chance)]


def with_step(study, judged):
    return f"{name_with_order(study.integrators[judged.setting.integrator])}, h = {judged.setting.step:.3g}"


def band_text(band):
    """Writes the degrees of a band."""
    return f"{band.lowest}–{band.highest}"


def bands_title(study, found, told):
    """Returns by how much the setting that is furthest off changes the band that it changes most, at the largest n."""
    n = max(told)
    judged = max(told[n], key=lambda judged: judged.distance)
    band = max(found[n].drifts, key=lambda band: abs(judged.scores[band]))
    change = changes_of(found[n], judged)[list(found[n].drifts).index(band)]
    written = f"{100 * change:+.2g}".replace("-", "\N{MINUS SIGN}")
    return (f"Turbulence at {equals('n', n)}: {with_step(study, judged)} changes the energy at l = {band_text(band)} by"
            f" {written}\N{NO-BREAK SPACE}%; faithful settings stay within chance in every band")
