"""What the study `turbulence` finds, as records, and the figures for pages, by key. Standard library only."""

from typing import List, NamedTuple

from lib.records.formats import finite, keyed, list_of, number, one_of, optional, positive, text, truth, whole
from lib.records.integrators import KEPT
from lib.judging import verdicts
from lib.pages.numbers import power
from studies.turbulence.schema import LOOSE, BASELINE

NOT_JUDGED = "not judged"  # what is said of settings where Trust.decides is false


class Trust(NamedTuple):
    """How far what is judged at one n is to be trusted."""

    n: whole(2)
    samples: whole(1)
    time: positive  # T of a run
    references: whole(1)  # ensembles
    far: whole(1)
    threshold: number  # of the distance: settings that are further off are not within chance
    false_positives: number  # share of right ensembles beyond the threshold
    far_distance: number  # of the far ensemble that is furthest off
    spread: number  # of reference runs over that of far runs, all quantities together, with its 95 % interval
    spread_low: number
    spread_high: number
    are_independent: truth  # reference runs of one sample
    is_stationary: truth
    reference_error: number
    reference_energy_error: number
    reference_spectrum_error: number

    @property
    def decides(self):
        """Tells whether there are samples enough for a verdict: each is one history of the flow."""
        return self.samples >= verdicts.FEWEST


class Precision(NamedTuple):
    """How well the reference at one n tells a quantity: the energy in a band of degrees l, or a decorrelation."""

    n: whole(2)
    lowest: whole(1)  # l
    highest: whole(1)
    lag: optional(positive)  # units of time, after which one l is decorrelated; None for a band
    deviation: number  # of one run; relative for bands
    minimum: number  # mean difference over the samples at which a setting is no longer within chance
    spread: number  # of reference runs over that of far runs, with its 95 % interval
    spread_low: number
    spread_high: number
    drift: optional(finite)  # of a band: relative change from the first to the last quarter of T/2 … T
    drift_score: optional(finite)  # over its standard error


class SettingResult(NamedTuple):
    """What became of a setting at one n; where a sample was lost, only what stands before `within_chance` is known."""

    n: whole(2)
    integrator: text
    order: whole(1)
    family: text
    keeps: one_of(*KEPT)  # strongest structure of the method
    step: positive
    tolerance: positive
    is_baseline: truth
    failed: whole()  # samples that were lost
    capped: whole()  # of these by the sweep cap
    first_lost: optional(number)  # time at which the first and the last of them was lost
    last_lost: optional(number)
    products: number  # equivalent ones, a unit of time
    faithful: truth
    within_chance: optional(truth) = None
    distance: optional(number) = None  # the largest |z|
    scores: optional(list_of(finite)) = None  # z of each quantity in the order of `precision`
    energy: optional(finite) = None  # averages, relative to the initial value, less 1: the mean over the samples
    enstrophy: optional(finite) = None
    energy_worst: optional(number) = None  # the largest of a sample, without sign
    enstrophy_worst: optional(number) = None
    spectrum_error: optional(number) = None  # at the end, the largest of the samples
    seconds: optional(positive) = None  # CPU time of a run; None where no step was timed
    over_baseline: optional(positive) = None  # seconds over those of the baseline; its interval needs enough processes
    over_baseline_low: optional(positive) = None
    over_baseline_high: optional(positive) = None


CHEAPEST = "cheapest"


class Leader(NamedTuple):
    """A faithful setting that is the cheapest of those that keep a structure, or is not told from the cheapest."""

    n: whole(2)
    keeps: one_of(*KEPT)
    integrator: text
    step: positive
    tolerance: positive
    standing: one_of(CHEAPEST, verdicts.TIE, verdicts.UNDECIDED)


class Findings(NamedTuple):
    trust: List[Trust]
    precision: List[Precision]
    settings: List[SettingResult]
    leaders: List[Leader]


def findings(study, judgements):
    """Returns the Findings of a Turbulence, given its Judgements by n."""
    found = Findings([], [], [], [])
    for n, judgement in judgements.items():
        found.trust.append(trust(study, n, judgement))
        found.precision.extend(precisions(n, judgement))
        found.settings.extend(setting_result(study, n, judgement, each) for each in judgement.judged.values())
        for structure in KEPT:
            found.leaders.extend(leaders(n, judgement, structure))
    return found


def trust(study, n, judgement):
    size, spreads = study.sizes[n], judgement.spreads
    runs = [run for sample in study.references[n] for run in sample]
    return Trust(n, size.samples, size.time, size.references, size.far, judgement.reference.threshold,
                 judgement.false_positives, max(judgement.far_distances), *map(float, (
                     spreads.ratio[-1], spreads.low[-1], spreads.high[-1])), bool(spreads.are_independent),
                 judgement.is_stationary, size.reference_error, max(run.energy_error for run in runs),
                 max(run.spectrum_error for run in runs))


def precisions(n, judgement):
    found = []
    reference, spreads = judgement.reference, judgement.spreads
    for place, quantity in enumerate(judgement.quantities):
        drift = judgement.drifts.get(quantity)
        found.append(Precision(n, *quantity, *(float(each[place]) for each in (
            reference.deviations, reference.threshold * reference.chance, spreads.ratio, spreads.low, spreads.high)),
            drift and drift.change, drift and drift.score))
    return found


def setting_result(study, n, judgement, judged):
    setting, ensemble, integrator = judged.setting, judged.ensemble, study.integrators[judged.setting.integrator]
    lost, over = [run.time for run in ensemble.lost], judgement.over_baseline(judged)
    found = SettingResult(n, integrator.name, integrator.order, integrator.family, judged.keeps, setting.step,
                          setting.tolerance, ensemble.role == BASELINE, ensemble.failed, ensemble.capped,
                          min(lost, default=None), max(lost, default=None), judged.products, bool(judged.faithful))
    if not ensemble.works:
        return found
    found = found._replace(within_chance=bool(judged.within_chance), distance=judged.distance,
                           scores=list(judged.scores.values()), **judged.changes,
                           **{f"{name}_worst": each for name, each in judged.worst.items()},
                           spectrum_error=judged.spectrum_error, seconds=judged.seconds,
                           over_baseline=over and over.ratio)
    if over and over.processes >= verdicts.FEWEST:
        found = found._replace(over_baseline_low=over.low, over_baseline_high=over.high)
    return found


def leaders(n, judgement, structure):
    """Returns the Leaders among the settings that keep a structure, the cheapest first."""
    def allowed(judged):
        return judged.has(structure)

    best = judgement.cheapest(allowed)
    ties, undecided = judgement.level_with_cheapest(allowed)
    return [Leader(n, structure, *judged.setting, standing)
            for standing, some in ((CHEAPEST, [best] if best else []), (verdicts.TIE, ties),
                                   (verdicts.UNDECIDED, undecided)) for judged in some]


# ---- figures


def figures(found):
    """Returns the figures that pages may quote, by key, given the Findings.

    nN.INTEGRATOR.hSTEP… are those of a setting, `.tolerance_1e-4` where it is not 1e-8. The name of a winner stands in
    its key, so that a page that names another one fails its test: nN.cheapest.KEPT.INTEGRATOR.hSTEP….
    """
    figures_of = {}
    for trusted in found.trust:
        n = trusted.n
        precisions_at = [each for each in found.precision if each.n == n]
        settings = [each for each in found.settings if each.n == n]
        of_n = {"judged": len(settings), **trust_figures(trusted),
                **{key: value for each in precisions_at for key, value in precision_figures(each)},
                **{key: value for each in settings for key, value in setting_figures(each, precisions_at)},
                **method_figures(settings),
                **leader_figures([each for each in found.leaders if each.n == n], settings)}
        figures_of |= {f"n{n}.{key}": value for key, value in of_n.items() if value is not None}
    return figures_of


def trust_figures(trusted):
    return {"samples": trusted.samples, "time": trusted.time, "references": trusted.references, "far": trusted.far,
            "threshold": trusted.threshold, "false_positives": trusted.false_positives,
            "far.distance": trusted.far_distance, "independent": trusted.spread,
            "independent_low": trusted.spread_low, "independent_high": trusted.spread_high,
            "are_independent": int(trusted.are_independent), "stationary": int(trusted.is_stationary),
            "reference.error": trusted.reference_error, "reference.energy_error": trusted.reference_energy_error,
            "reference.spectrum_error": trusted.reference_spectrum_error}


def key_of_quantity(found):
    return f"l{found.lowest}-{found.highest}" if found.lag is None else f"l{found.lowest}.lag{found.lag:g}"


def precision_figures(found):
    names = {"deviation": "deviation", "minimum": "min", "spread": "spread", "spread_low": "spread_low",
             "spread_high": "spread_high", "drift": "quarters", "drift_score": "quarters_score"}
    return [(f"{key_of_quantity(found)}.{key}", getattr(found, name)) for name, key in names.items()]


def setting_figures(result, precisions_at):
    """Returns the figures of one setting as (key, value), given the Precisions at its n.

    Those of the baseline begin with baseline. lost.SETTING counts the lost samples, and says when.
    """
    start, key = ("baseline" if result.is_baseline else key_of(result)), key_of(result)
    found = [(f"{start}.{name}", getattr(result, name)) for name in (
        "products", "distance", "seconds", "spectrum_error", "energy", "enstrophy", "energy_worst", "enstrophy_worst")]
    found += [(f"{start}.{name}", int(getattr(result, name))) for name in ("failed", "capped", "faithful")]
    if result.within_chance is not None:
        found.append((f"{start}.within_chance", int(result.within_chance)))
    found += [(f"{start}.{key_of_quantity(each)}.score", score)
              for each, score in zip(precisions_at, result.scores or ())]
    found += cost_figures(f"{start}.over_baseline", result)
    if result.is_baseline:
        found.append(("baseline.step", result.step))
    if result.failed:
        found += [(f"lost.{key}.samples", result.failed), (f"lost.{key}.first", result.first_lost),
                  (f"lost.{key}.last", result.last_lost)]
    return found


def key_of(setting):
    tolerance = "" if setting.tolerance == LOOSE else f".tolerance_{power(setting.tolerance)}"
    return f"{setting.integrator}.h{setting.step:g}{tolerance}"


def cost_figures(key, result):
    """Returns the cost of a setting over the baseline's as (key, value): KEY, KEY_low and KEY_high."""
    return [(key, result.over_baseline), (f"{key}_low", result.over_baseline_low),
            (f"{key}_high", result.over_baseline_high)]


def method_figures(settings):
    """Returns what the cheapest faithful setting of each method is and costs, by key; the baseline is none of them."""
    found = {}
    for each in settings:
        if each.faithful and each.seconds and not each.is_baseline:
            found[each.integrator] = min(found.get(each.integrator, each), each, key=lambda one: one.seconds)
    return {f"cheapest_of.{name}.{key}": value for name, best in found.items() for key, value in (
        ("step", best.step), ("products", best.products), *cost_figures("over_baseline", best))}


def leader_figures(leading, settings):
    """Returns the figures of the cheapest faithful settings, by what a method keeps.

    START.tie.SETTING is the cost over the baseline's of each setting that ties with it, START.undecided counts those
    that are not decided against it.
    """
    results, found = keyed(settings, "integrator", "step", "tolerance"), {}
    for leader in leading:
        start, key = f"cheapest.{leader.keeps}", key_of(leader)
        result = results[leader.integrator, leader.step, leader.tolerance]
        if leader.standing == CHEAPEST:
            found |= {f"{start}.{key}.seconds": result.seconds, f"{start}.{key}.products": result.products,
                      **dict(cost_figures(f"{start}.{key}.over_baseline", result)),
                      **{f"{start}.{key}.baseline_over{end}": over and 1 / over for end, over in (
                          ("", result.over_baseline), ("_low", result.over_baseline_high),
                          ("_high", result.over_baseline_low))},
                      f"{start}.ties": 0, f"{start}.undecided": 0}
        elif leader.standing == verdicts.TIE:
            found |= cost_figures(f"{start}.tie.{key}.over_baseline", result)
            found[f"{start}.ties"] += 1
        else:
            found[f"{start}.undecided"] += 1
    return found
