"""What a study of turbulence found: each setting judged against the reference, and the figures for pages."""

import math
import statistics
from typing import NamedTuple, Optional, Tuple

from lib import verdicts
from lib.formats import FAST, PUBLISHED
from lib.integrator_names import KEPT
from lib.turbulence_files import LOOSE, PRACTICE, TIGHT, Ensemble
from lib.turbulence_statistics import Reference, reference_of

CONSERVED = ("energy", "enstrophy", "quartic")
CLOSE = 0.01  # a conserved average that is off by no more is kept, for the stricter figures


class Judged(NamedTuple):
    """A setting at one n. Where a run of it failed all but the first two has no value."""

    ensemble: Ensemble
    keeps: str  # strongest structure of the method, of KEPT
    distance: Optional[float] = None  # from the reference
    faithful: bool = False
    changes: Optional[dict] = None  # of CONSERVED averages, relative, the mean over the draws
    tail: Optional[float] = None  # change of E(l) over the upper third of the compared degrees, relative
    spectrum_error: Optional[float] = None  # at the end, the largest of the draws
    times: Tuple[float, ...] = ()  # CPU seconds of one run to T, by process; none where no step was timed

    @property
    def setting(self):
        return self.ensemble.setting

    @property
    def seconds(self):
        """The geometric mean of the times, or None."""
        return statistics.geometric_mean(self.times) if self.times else None

    def has(self, structure):
        """Tells whether the method keeps a structure of KEPT, or a stronger one."""
        return list(KEPT).index(self.keeps) >= list(KEPT).index(structure)

    @property
    def conserves(self):
        """Tells whether energy, enstrophy and tr W⁴ are those of the initial data to CLOSE."""
        return bool(self.changes) and all(abs(change) <= CLOSE for change in self.changes.values())


class Findings(NamedTuple):
    """All that was found at one n."""

    reference: Reference
    judged: dict  # Judged by Setting
    practice: Optional[Judged]  # at the loose tolerance

    def over_practice(self, judged):
        """Returns the Ratio of the cost of a setting to that of the practice, or None where one is not known."""
        if not (judged and judged.times and self.practice and self.practice.times):
            return None
        return verdicts.ratio_of(judged.times, self.practice.times)

    def candidates(self, allowed):
        """Returns the faithful settings of those that are allowed, but the practice, whose cost is known."""
        return [each for each in self.judged.values() if each.faithful and each.times and allowed(each)
                and each.ensemble.role != PRACTICE]

    def cheapest(self, allowed=lambda judged: True):
        """Returns the cheapest faithful setting of those that are allowed, but the practice, as Judged; or None."""
        return min(self.candidates(allowed), key=lambda each: each.seconds, default=None)

    def level_with_cheapest(self, allowed=lambda judged: True):
        """Returns the other faithful settings that tie with the cheapest, and those not decided against it."""
        found = {each.setting: each for each in self.candidates(allowed)}
        times = {setting: each.times for setting, each in found.items()}
        best = verdicts.fastest(times) if times else None
        ties, undecided = verdicts.level_rows(times)
        return ([each for setting, each in found.items() if setting in ties and setting != best],
                [each for setting, each in found.items() if setting in undecided])


def findings_of(study, n):
    """Returns the Findings of a Turbulence at one n."""
    reference = reference_of([[run.energy_by_degree for run in draw] for draw in study.references[n]])
    judged = {setting: judged_of(study, n, ensemble, reference) for setting, ensemble in study.ensembles[n].items()}
    practice = study.practice(n)
    return Findings(reference, judged, practice and judged[practice.setting])


def judged_of(study, n, ensemble, reference):
    """Returns one setting as Judged."""
    kept = study.integrators[ensemble.setting.integrator]
    strongest = next(structure for structure in reversed(KEPT) if kept.keeps(structure))
    if not ensemble.works:
        return Judged(ensemble, strongest)
    spectra = [run.energy_by_degree for run in ensemble.runs]
    changes = {name: statistics.fmean(getattr(run, name) for run in ensemble.runs) - 1 for name in CONSERVED}
    faithful = study.is_unpredictable(n) and reference.is_faithful(spectra)
    return Judged(ensemble, strongest, reference.distance(spectra), faithful, changes, tail_change(reference, spectra),
                  max(run.spectrum_error for run in ensemble.runs), times_of_run(study, n, ensemble.setting))


def tail_change(reference, spectra):
    """Returns the relative change of E(l) against the reference, the geometric mean over draws and the upper third of
    the compared degrees."""
    upper = 2 * len(reference.degrees) // 3
    return math.expm1(statistics.fmean(value for draw in reference.differences(spectra) for value in draw[upper:]))


def times_of_run(study, n, setting, solver=FAST):
    """Returns the CPU seconds of a run to T by process, from the timed steps; none where none was timed."""
    cost = study.cost(n, setting, solver)
    steps = steps_to(study.sizes[n].time, setting.step)
    return tuple(seconds * steps for seconds in cost.seconds) if cost else ()


def published_over_fast(study, n, setting):
    """Returns the Ratio of the cost of a setting's published form to that of the fast one; None without both."""
    published, fast = (times_of_run(study, n, setting, solver) for solver in (PUBLISHED, FAST))
    return verdicts.ratio_of(published, fast) if published and fast else None


def steps_to(time, step):
    """Returns the least number of steps that reach a time."""
    return math.ceil(time / step * (1 - 1e-12))


# ---- figures


def figures(study):
    """Returns the figures that results/README.md may quote, by key.

    nN.INTEGRATOR.hSTEP… are those of a setting, `.tolerance_1e-6` where it is not 1e-8. The name of a winner stands in
    its key, so that a page that names another one fails its test: nN.cheapest.KEPT.INTEGRATOR.hSTEP….
    """
    found = {}
    for n in study.sizes:
        parts = findings_of(study, n)
        for figures_at in (reference_figures, practice_figures, setting_figures, winner_figures):
            found.update({f"n{n}.{key}": value for key, value in figures_at(study, n, parts).items()
                          if value is not None})
    return found


def reference_figures(study, n, found):
    size = study.sizes[n]
    runs = [run for draw in study.references[n] for run in draw]
    kept = {"threshold": found.reference.threshold, "typical": found.reference.typical,
            "degrees": len(found.reference.degrees), "draws": size.draws, "judged": len(found.judged),
            "reference.error": size.reference_error,
            "reference.energy_error": max(run.energy_error for run in runs),
            "reference.spectrum_error": max(run.spectrum_error for run in runs)}
    for displacement in (study.settings.displacement, study.settings.small_displacement):
        times = [parting.time for parting in study.partings[n]
                 if parting.displacement == displacement and parting.time is not None]
        key = f"parted.{displacement:.0e}".replace("e-0", "e-")
        kept[f"{key}.draws"] = len(times)
        differences = study.at_window(n, displacement)
        kept[f"{key}.at_window"] = statistics.median(differences)
        kept[f"{key}.at_window_least"] = min(differences)
        if times:
            kept.update({f"{key}.least": min(times), f"{key}.most": max(times)})
    return kept


def practice_figures(study, n, found):
    """Returns the figures of the practice at each tolerance, and of its published form's cost over the fast one's."""
    kept = {}
    for name, tolerance in (("practice", LOOSE), ("practice_1e-13", TIGHT)):
        ensemble = study.practice(n, tolerance)
        if ensemble is None:
            continue
        judged = found.judged[ensemble.setting]
        kept[f"{name}.step"] = ensemble.setting.step
        kept.update({f"{name}.{key}": value for key, value in figures_of(found, judged).items()})
        published = published_over_fast(study, n, ensemble.setting)
        kept.update(ratio_figures(f"{name}.published_over_fast", published))
    return kept


def ratio_figures(key, ratio):
    """Returns a Ratio or None as figures: KEY, and with enough processes for an interval KEY_low and KEY_high."""
    if ratio is None:
        return {}
    ends = {f"{key}_low": ratio.low, f"{key}_high": ratio.high} if ratio.processes >= verdicts.FEWEST else {}
    return {key: ratio.ratio, **ends}


def figures_of(found, judged):
    """Returns the figures of one setting, by the ends of their keys."""
    kept = {"failed": judged.ensemble.failed, "capped": judged.ensemble.capped, "faithful": int(judged.faithful)}
    if judged.ensemble.works:
        kept.update(distance=judged.distance, tail=judged.tail, spectrum_error=judged.spectrum_error,
                    **judged.changes, seconds=judged.seconds,
                    **ratio_figures("over_practice", found.over_practice(judged)))
    return kept


def key_of(setting):
    tolerance = "" if setting.tolerance == LOOSE else f".tolerance_{setting.tolerance:.0e}".replace("e-0", "e-")
    return f"{setting.integrator}.h{setting.step:g}{tolerance}"


def setting_figures(study, n, found):
    return {f"{key_of(setting)}.{key}": value for setting, judged in found.judged.items()
            if judged.ensemble.role != PRACTICE for key, value in figures_of(found, judged).items()}


def winner_figures(study, n, found):
    """Returns the cheapest faithful settings: by what a method keeps, also with conserved averages to CLOSE, and of
    each method; and the largest faithful step of each method at the loose tolerance."""
    kept = {}
    for structure in KEPT:
        kept.update(winner(found, f"cheapest.{structure}", lambda judged: judged.has(structure)))
        kept.update(winner(found, f"cheapest.{structure}.close",
                           lambda judged: judged.has(structure) and judged.conserves))
    for name in methods_of(found):
        best = found.cheapest(lambda judged: judged.setting.integrator == name)
        if best:
            kept[f"cheapest_of.{name}.step"] = best.setting.step
            kept.update(ratio_figures(f"cheapest_of.{name}.over_practice", found.over_practice(best)))
        kept[f"largest_faithful.{name}"] = largest_faithful_step(found, name)
    return kept


def winner(found, start, allowed):
    """Returns the figures of the cheapest faithful setting of those that are allowed.

    START.tie.SETTING is the cost over the practice's of each setting that ties with it, START.undecided counts those
    that are not decided against it.
    """
    judged = found.cheapest(allowed)
    if judged is None:
        return {}
    key, over = f"{start}.{key_of(judged.setting)}", found.over_practice(judged)
    ties, undecided = found.level_with_cheapest(allowed)
    kept = {f"{key}.seconds": judged.seconds, **ratio_figures(f"{key}.over_practice", over),
            f"{start}.ties": len(ties), f"{start}.undecided": len(undecided)}
    if over:
        inverse = verdicts.ratio_of(found.practice.times, judged.times)
        kept.update(ratio_figures(f"{key}.practice_over", inverse))
    for each in ties:
        kept.update(ratio_figures(f"{start}.tie.{key_of(each.setting)}.over_practice", found.over_practice(each)))
    return kept


def methods_of(found):
    """Returns the integrators with settings that are not the practice."""
    return list(dict.fromkeys(setting.integrator for setting, judged in found.judged.items()
                              if judged.ensemble.role != PRACTICE))


def largest_faithful_step(found, integrator):
    """Returns the largest faithful step of an integrator at the loose tolerance, or None."""
    return max((judged.setting.step for judged in line_of(found, integrator) if judged.faithful), default=None)


def line_of(found, integrator):
    """Returns the settings of an integrator at the loose tolerance, the practice among them, its longest step first."""
    line = [judged for setting, judged in found.judged.items()
            if (setting.integrator, setting.tolerance) == (integrator, LOOSE)]
    return sorted(line, key=lambda judged: -judged.setting.step)
