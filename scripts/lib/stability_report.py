"""What the failure maps and the long runs say, as a document: claims, tables, charts, advice.

Every sentence is made from the raw files: its figures, and which way round it is put.
"""

import math
import statistics
from dataclasses import dataclass
from typing import Tuple

from accuracy_report import listed, scientific, table
from comparison import MISSING, three_digits
from document import Column, Figure, Heading, Item, Items, Paragraph
from drift import EXPONENTIAL, LINEAR, LINEAR_EXPONENTS, NONE, POWER, drift
from integrator_names import MIDPOINT, family, joined, others
from raw_files import STATUSES, SWEEP_CAP, UNSTABLE
from stability import ENERGY, QUANTITIES, SKEW, SPECTRUM, TWO_PRODUCTS, trials_in_words

# What is claimed of the smooth scene, at this n.
CLAIMED_SCENE, CLAIMED_N = "smooth", 129
CLAIMED_WORKING, CLAIMED_SWEEPS = 1.86, (83, 99)

HARDLY = 1.25  # critical values within this factor of one another hardly differ
AGREES = 1.15  # theory and measurement agree within this factor
CLEARLY_CONTRACTS = 0.8  # an iteration that contracts so much does not fail for lack of local contraction


@dataclass(frozen=True)
class Chart:
    name: str
    caption: str
    draw: str  # its function in stability_charts, ...
    arguments: Tuple  # ... and what that takes beside the study


def map_charts(failures):
    """Returns the charts of a failure map."""
    charts = []
    for scene in failures.scenes():
        charts.append(Chart(f"failure_map_{scene}", f"Where the formulations of Table 1 fail, {scene} scene: h‖B(W₀)‖₂"
                            " against n, with the measured critical value and linear theory.", "failure_map", (scene,)))
        if others(failures.integrators):
            charts.append(Chart(f"failure_map_others_{scene}", f"Where the other integrators fail, {scene} scene.",
                                "failure_map_others", (scene,)))
    return charts


def fast_map_charts(fast):
    """Returns the charts of a failure map of the fast forms; none where there is no such map."""
    return [Chart(f"failure_map_fast_{scene}", f"Where the fast forms fail, {scene} scene.", "failure_map_fast", (scene,))
            for scene in (fast.scenes() if fast else ())]


def long_run_charts(runs):
    """Returns the charts of long runs; none where there are no runs."""
    charts = []
    for scene, n in runs.settings() if runs else ():
        where = f"n{n}" if scene == CLAIMED_SCENE else f"{scene}_n{n}"
        charts.append(Chart(f"long_runs_{where}", f"Errors of long runs at n = {n}, {scene} scene: integrators that keep"
                            " the spectrum.", "long_runs", (scene, n)))
        if any(not each.isospectral for each in runs.integrators.values()):
            charts.append(Chart(f"long_runs_{where}_controls", f"Errors of long runs at n = {n}, {scene} scene:"
                                " integrators that lose the spectrum.", "long_runs_controls", (scene, n)))
    return charts


def stability_sections(failures, runs, charts, level=2, fast=None):
    """Returns the section; `charts` maps the names of the charts that exist to their paths.

    `runs`, and `fast`, a map of the fast forms, may be None.
    """
    drawn = [*map_charts(failures), *fast_map_charts(fast), *long_run_charts(runs)]
    figures = [Figure(charts[each.name], each.caption) for each in drawn if each.name in charts]
    claims = [*issue_claims(failures), *map_claims(failures), *(long_run_claims(runs, failures) if runs else [])]
    return [
        Heading("Stability", level),
        Paragraph(introduction(failures, runs)),
        Heading("What the runs say", level + 1),
        Items([claim for claim in claims if claim]),
        *figures,
        *critical_section(failures, level + 1),
        *(fast_section(failures, fast, level + 1) if fast else []),
        *theory_section(failures, level + 1),
        *advice_section(failures, runs, level + 1),
        *(drift_section(runs, level + 1) if runs else []),
    ]


def introduction(failures, runs):
    grids = [each.trials for each in failures.maps.values()]
    least, most = (pick(trial.h_norm_B for trials in grids for trial in trials) for pick in (min, max))
    text = (f"{len(failures.integrators)} integrators on {' and '.join(scenes_and_sizes(failures.settings))}, in trials with"
            f" h‖B(W₀)‖₂ from {three_digits(least)} to {three_digits(most)}.")
    if runs:
        text += (f" Long runs of {runs.steps} steps at {listed(f'{share:g}' for share in runs.shares())} of the"
                 f" critical step, on {' and '.join(scenes_and_sizes(runs.settings()))}.")
    return text


def scenes_and_sizes(settings):
    """Names settings, each a scene and an n, scene by scene."""
    sizes = {}
    for scene, n in settings:
        sizes.setdefault(scene, []).append(n)
    return [f"the {scene} scene at n = {listed(sorted(found))}" for scene, found in sizes.items()]


# ---- what was claimed before it was measured


def issue_claims(failures):
    """Judges what was claimed of plain iteration before this study."""
    if CLAIMED_N not in failures.sizes(CLAIMED_SCENE):
        return [Item("The claims on plain iteration are not judged",
                     f": they are about the {CLAIMED_SCENE} scene at n = {CLAIMED_N}, which these runs leave out.")]
    outer = [f"{formulation}{s}" for formulation in ("group", "cotangent") for s in (1, 2, 3)]
    inner = ["algebra2", "algebra3"]
    return [fails_by("Group and cotangent, s = 1, 2, 3,", "fail", failures, outer, 1.9),
            fails_by("The isospectral midpoint", "fails", failures, [MIDPOINT], 1.9),
            works_at(failures, inner),
            fails_by("Algebra, s = 2, 3,", "fail", failures, inner, 3.7)]


def claimed_maps(failures, names):
    return [each for each in (failures.at(CLAIMED_SCENE, CLAIMED_N, name) for name in names) if each]


def smallest_failing(each):
    """Returns the trial of a map with the smallest step that fails, or None."""
    tried = [*each.trials, *([each.critical.fails] if each.critical else [])]
    return min((trial for trial in tried if not trial.works), key=lambda trial: trial.h_norm_B, default=None)


def fails_by(subject, verb, failures, names, bound):
    maps = claimed_maps(failures, names)
    if not maps:
        return None
    failing = {each.integrator: smallest_failing(each) for each in maps}
    holds = all(trial and trial.h_norm_B <= bound for trial in failing.values())
    figures = listed(f"{name} {verb_of(trial)}" for name, trial in failing.items())
    return Item(f"{subject} {verb} by h‖B(W₀)‖₂ = {bound} at n = {CLAIMED_N}", f" {judged(holds)}: {figures}.")


def judged(holds):
    return "(holds)" if holds else "(does not hold)"


def verb_of(trial):
    return f"fails from {three_digits(trial.h_norm_B)} on ({trial.status})" if trial else "never failed"


def works_at(failures, names):
    maps = claimed_maps(failures, names)
    if not maps:
        return None
    figures, holds, agrees = [], True, True
    for each in maps:
        works = each.largest_working
        holds = holds and works is not None and works >= CLAIMED_WORKING
        around = sweeps_around(each, CLAIMED_WORKING)
        agrees = agrees and bool(around) and between(around)
        text = f"{each.integrator} works up to {three_digits(works)}" if works else f"{each.integrator} never works"
        figures.append(text + "".join(f", with {trial.sweeps_per_step:.0f} sweeps a step at {three_digits(trial.h_norm_B)}"
                                      for trial in around))
    least, most = CLAIMED_SWEEPS
    sweeps = f"the {least}–{most} sweeps a step claimed for it {'agree' if agrees else 'do not agree'} with these"
    return Item(f"Algebra, s = 2, 3, still converges at {CLAIMED_WORKING}",
                f" {judged(holds)}: {'; '.join(figures)}; {sweeps}.")


def sweeps_around(each, h_norm_B):
    """Returns the working trials next to this h‖B‖₂, the nearest below and above it; fewer where there are not both."""
    tried = [*each.trials, *([each.critical.works] if each.critical else [])]
    working = sorted((trial for trial in tried if trial.works and trial.sweeps_per_step),
                     key=lambda trial: trial.h_norm_B)
    below = [trial for trial in working if trial.h_norm_B <= h_norm_B][-1:]
    return below + [trial for trial in working if trial.h_norm_B > h_norm_B][:1]


def between(around):
    """Tells whether what was claimed may lie between the sweeps of the trials on both sides."""
    sweeps = [trial.sweeps_per_step for trial in around]
    least, most = CLAIMED_SWEEPS
    return min(sweeps) <= most and max(sweeps) >= least


# ---- claims on the maps


def map_claims(failures):
    return [ways_claim(failures), *(size_claim(failures, scene) for scene in failures.scenes()), scene_claim(failures)]


def ways_claim(failures):
    ways = [each.critical.fails.status for each in failures.maps.values() if each.critical]
    if not ways:
        return None
    counts = {status: ways.count(status) for status in STATUSES if status in ways}
    commonest = max(counts, key=counts.get)
    return Item(f"The commonest failure just past the edge is {quoted_way(commonest)}",
                f": of {len(ways)} edges, {listed(f'{count} {status}' for status, count in counts.items())}.")


def quoted_way(status):
    return f'"{status}"' + (" (iterations converge, invariants are lost)" if status == UNSTABLE else "")


def spreads(failures, scene):
    """Returns the largest over the smallest critical h‖B‖₂ of each integrator that has one at every n of the scene."""
    found = {}
    for name in failures.integrators:
        critical = [each.critical.works.h_norm_B for each in failures.line(scene, name) if each.critical]
        if len(critical) == len(failures.sizes(scene)) > 1:
            found[name] = max(critical) / min(critical)
    return found


def size_claim(failures, scene):
    found = spreads(failures, scene)
    if not found:
        return None
    steady = [name for name in found if found[name] <= HARDLY]
    least, most = min(found, key=found.get), max(found, key=found.get)
    verdict = ("h‖B(W₀)‖₂ alone decides" if len(steady) == len(found) else "h‖B(W₀)‖₂ does not decide alone")
    return Item(f"{verdict}, {scene} scene", f": over n = {listed(failures.sizes(scene))} the critical value changes by a"
                f" factor of {three_digits(found[least])} ({least}) to {three_digits(found[most])} ({most}); by less than"
                f" {HARDLY} for {len(steady)} of {len(found)} integrators.")


def scene_claim(failures):
    """Compares the scenes at the largest n they share."""
    if len(failures.scenes()) < 2:
        return None
    first, second = failures.scenes()[:2]
    shared = sorted(set(failures.sizes(first)) & set(failures.sizes(second)))
    if not shared:
        return None
    n = shared[-1]
    pairs = {name: (failures.at(first, n, name), failures.at(second, n, name)) for name in failures.integrators}
    ratios = {name: two.critical.works.h_norm_B / one.critical.works.h_norm_B for name, (one, two) in pairs.items()
              if one and two and one.critical and two.critical}
    if not ratios:
        return None
    least, most = min(ratios, key=ratios.get), max(ratios, key=ratios.get)
    depends = not 1 / HARDLY <= ratios[least] <= ratios[most] <= HARDLY
    return Item("Failure depends on the scene" if depends else "Failure hardly depends on the scene",
                f": at n = {n} the critical h‖B(W₀)‖₂ of the {second} scene is {three_digits(ratios[least])} ({least}) to"
                f" {three_digits(ratios[most])} ({most}) times that of the {first} scene, in the median"
                f" {three_digits(statistics.median(ratios.values()))} times.")


# ---- claims on long runs


def long_run_claims(runs, failures):
    return [*(survival_claim(runs, share) for share in runs.shares()), spectrum_claim(runs), energy_claim(runs),
            *two_products_claims(runs)]


def survival_claim(runs, share):
    tried = [run for run in runs.runs if run.share == share]
    failed = [run for run in tried if not run.survived]
    text = f": {len(tried) - len(failed)} of {len(tried)} runs came through {runs.steps} steps"
    if failed:
        text += "; failed: " + listed(f"{run.integrator} at n = {run.n} ({ending(runs, run)})" for run in failed)
    verdict = "every method lasts" if not failed else "not every method lasts"
    return Item(f"At {share:g} of the critical step {verdict}", text + ".")


def ending(runs, run):
    if run.survived:
        return f"{runs.steps} steps"
    return f"{run.status}" + (f" at step {run.failed_step}" if run.failed_step else f" after {run.steps} steps")


def drifts(runs, quantity, wanted):
    """Returns (run, Drift) of the runs that came through, of the integrators that are wanted."""
    found = [(run, drift(quantity.series(run))) for run in runs.runs
             if run.survived and wanted(runs.integrators[run.integrator])]
    return [(run, each) for run, each in found if each]


def spectrum_claim(runs):
    found = drifts(runs, SPECTRUM, lambda each: each.isospectral)
    return drift_claim(found, "spectrum", "isospectral integrators", tolerated(runs)) if found else None


def energy_claim(runs):
    found = drifts(runs, ENERGY, lambda each: each.lie_poisson)
    return drift_claim(found, "energy", "Lie–Poisson integrators", 0.0) if found else None


def tolerated(runs):
    """Returns the error that the solver's tolerance lets through in every step together; 0 if it is not recorded."""
    return runs.steps * recorded_tolerance(runs)


def recorded_tolerance(study):
    """Returns the tolerance of the fixed point; 0 if it is not recorded."""
    try:
        tolerance = float(study.context["tolerance"])
    except (KeyError, ValueError):
        return 0.0
    return tolerance if 0 < tolerance < 1 else 0.0


def wanders(each):
    """Tells whether an error grows more slowly than a drift: as a random walk does, or what is slow to come to its bound."""
    return each.kind == POWER and each.exponent < LINEAR_EXPONENTS[0]


def drift_claim(found, what, who, allowed):
    drifting = [(run, each) for run, each in found if each.kind != NONE and not wanders(each)]
    wandering = [(run, each) for run, each in found if wanders(each)]
    run, largest = max(found, key=lambda pair: pair[1].largest)
    text = (f": of {len(found)} runs of {who} that came through, {len(found) - len(drifting) - len(wandering)} stay level;"
            f" the largest error is {scientific(largest.largest)} ({run.integrator}, n = {run.n}, {run.share:g} of the"
            " critical step)")
    if allowed:
        text += f", where steps × tolerance is {scientific(allowed)}"
    for runs, verb in ((drifting, "drifting"), (wandering, "wandering, more slowly than time")):
        if runs:
            text += f"; {verb} ({len(runs)}): " + listed(f"{run.integrator} at n = {run.n}, {run.share:g} ({drift_text(each)})"
                                           for run, each in runs)
    verdict = (f"The {what} does not drift" if not drifting
               else f"The {what} drifts by no more than the tolerance lets through" if largest.largest <= allowed
               else f"The {what} drifts in some runs")
    return Item(verdict, text + ".")


def two_products_claims(runs):
    """Returns a claim for each control whose update is formed as BW̃ − W̃B."""
    return [two_products_claim(runs, name) for name in runs.integrators if name.endswith(TWO_PRODUCTS)]


def two_products_claim(runs, name):
    tried = [(run, drift(SKEW.series(run))) for run in runs.runs if run.integrator == name]
    tried = [(run, each) for run, each in tried if each]
    if not tried:
        return None
    growing = [(run, each) for run, each in tried if each.kind == EXPONENTIAL]
    verdict = ("loses skew-Hermiticity exponentially" if len(growing) == len(tried)
               else f"loses skew-Hermiticity exponentially in {len(growing)} of {len(tried)} runs" if growing
               else "does not lose skew-Hermiticity exponentially")
    figures = "; ".join(f"n = {run.n}, {run.share:g} of the critical step: {skew_text(runs, run, each)}"
                        for run, each in tried)
    decided = f" Decided in the first run: {tried[0][1].reason}."
    return Item(f"{name} {verdict}", f": {figures}.{decided}{growing_mode(growing)}"
                                     f"{sound_twin(runs, name.removesuffix(TWO_PRODUCTS))}")


def skew_text(runs, run, each):
    if each.kind != EXPONENTIAL:
        return f"{drift_text(each)}, {ending(runs, run)}"
    return (f"rate {three_digits(each.rate)} per unit time, {three_digits(each.rate * run.step)} a step, doubling in"
            f" {three_digits(each.doubling_time)}, {ending(runs, run)}")


def growing_mode(growing):
    """Compares the growth a step with that of a Hermitian part of W by linear theory (core/linear_theory.h)."""
    pairs = [(each.rate * run.step, run.predicted_skew_growth * run.step)
             for run, each in growing if run.predicted_skew_growth is not None]
    if not pairs:
        return ""
    agree = all(theory <= HARDLY * measured and measured <= HARDLY * theory for measured, theory in pairs)
    text = (" By linear theory this update advances a Hermitian part of W as explicit Euler does and lets it grow, fastest"
            " between the eigenvectors of B of extreme frequencies, by"
            f" {listed(three_digits(theory) for _, theory in pairs)} a step")
    return text + (": that is the mode that grows." if agree else ", which is not what was measured.")


def sound_twin(runs, name):
    """Says what the same method does whose update is formed as C − C†."""
    found = [drift(SKEW.series(run)) for run in runs.runs if run.integrator == name]
    found = [each for each in found if each]
    if not found:
        return ""
    largest = max(each.largest for each in found)
    kept = "exactly 0" if largest == 0 else f"at most {scientific(largest)}"
    return f" With C − C† the skew defect of {name} is {kept}."


# ---- tables


def critical_section(failures, level):
    parts = [Heading("Critical h‖B(W₀)‖₂", level), Paragraph(
        'The largest h‖B(W₀)‖₂ that works below the first that fails, by bisection; "> x": the largest tried still works,'
        ' "< x": the smallest tried fails. The linear limit is that at the largest n. What the first failure is stands'
        f" last, in the order of n. A trial is of {trials_in_words(failures, failures.scenes())}.")]
    for scene in failures.scenes():
        largest = failures.sizes(scene)[-1]
        parts += critical_table(failures, scene, level + 1,
                                lambda n, name: critical_text(failures.at(scene, n, name)),
                                (Column(f"linear limit, n = {largest}"),
                                 lambda name: limit_text(failures.at(scene, largest, name))))
    return parts


def fast_section(failures, fast, level):
    """Critical values of the published forms beside those of the fast ones."""
    parts = [Heading("Critical h‖B(W₀)‖₂ of the fast forms", level), Paragraph(
        "The same of the fast forms, and in brackets of the published ones, at the tolerance of Table 1. Where a step fails, a"
        " fast form tries it again from a cold start, then by plain sweeps, then with acceleration. A trial is of"
        f" {trials_in_words(fast, fast.scenes())}.")]
    for scene in fast.scenes():
        parts += critical_table(fast, scene, level + 1,
                                lambda n, name: f"{critical_text(fast.at(scene, n, name))}"
                                                f" ({critical_text(failures.at(scene, n, name))})")
    return parts


def critical_table(failures, scene, level, text, *further):
    """One scene's integrators by n: `text(n, name)`, `further` columns with theirs by name, and the ways of failing."""
    sizes = failures.sizes(scene)
    columns = (Column("integrator", align="left"), *(Column(f"n = {n}") for n in sizes),
               *(column for column, _ in further), Column("fails as", align="left"))
    rows = [[name, *(text(n, name) for n in sizes), *(of(name) for _, of in further),
             ways_text(failures.line(scene, name))]
            for name in failures.integrators if failures.line(scene, name)]
    return [Heading(f"{scene.capitalize()} scene", level), table(columns, rows)]


def critical_text(each):
    if each is None:
        return MISSING
    if each.critical:
        return three_digits(each.critical.works.h_norm_B)
    if each.always_works:
        return f"> {three_digits(each.trials[-1].h_norm_B)}"
    return MISSING if each.trials[0].works else f"< {three_digits(each.trials[0].h_norm_B)}"


def limit_text(each):
    return three_digits(each.linear_limit) if each and each.linear_limit else MISSING


def ways_text(line):
    ways = [trial.status for trial in map(smallest_failing, line) if trial]
    return listed(dict.fromkeys(ways)) or MISSING


# ---- theory and measurement

AGREE, COLD_START, WEAK, UNEXPLAINED = "agree", "cold start", "weak contraction", "not explained"
FROM_ROUNDING, TRIAL_ENDS, INVARIANTS, MOVING = "tolerance met first", "trial ends first", "invariants first", "B moves"
READINGS = {
    AGREE: f"theory and measurement are within a factor of {AGREES} of one another.",
    COLD_START: f"below the limit, though the last step that works contracts by less than {CLEARLY_CONTRACTS} a sweep. Not"
                " the local contraction decides but the start value: the cold start leaves the basin of the iteration.",
    WEAK: f"below the limit, and the last step that works contracts by {CLEARLY_CONTRACTS} or more a sweep. Theory is about"
          " rough perturbations, which hardly change B. Smooth ones do, from sweep to sweep, and contract more slowly.",
    UNEXPLAINED: "below the limit, and the contraction of the last step that works was not measured.",
    FROM_ROUNDING: "beyond the limit. The errors that theory lets grow are the rough ones, which start at rounding size: the"
                   " tolerance is met before they have grown.",
    TRIAL_ENDS: "beyond the limit of an explicit method. The errors that theory lets grow start at rounding size: the trial"
                " ends before they have grown.",
    INVARIANTS: "below the limit of stability, for what is lost first is not stability: invariants that the method does not"
                " keep are lost by its error within the steps of a trial.",
    MOVING: "below the limit of an explicit method: B does not stay as it is at W₀.",
}


def theory_section(failures, level):
    columns = (Column("methods", align="left"), Column("scene", align="left"),
               *(column for group in ("least", "greatest") for column in
                 (Column("ratio", group), Column("of", group, "left"), Column("contraction", group),
                  Column("reading", group, "left"))))
    rows, readings = [], []
    for scene in failures.scenes():
        for name, maps in families(failures, scene).items():
            ends = [pick(maps, key=lambda each: each.over_limit) for pick in (min, max)]
            rows.append([name, scene, *(text for each in ends for text in end_texts(failures, each))])
            readings += [reading(failures, each) for each in ends]
    if not rows:
        return []
    return [Heading("Where theory and measurement part", level),
            Paragraph("Linear theory takes B as it is at W₀ and asks when the iteration, or the step of an explicit method,"
                      " ceases to be stable. The ratio is the measured critical h‖B(W₀)‖₂ over that limit, the least and"
                      " the greatest of a family of methods; the contraction is that of the last step that works."),
            table(columns, rows),
            Items([Item(name, f": {text}") for name, text in READINGS.items() if name in readings]),
            *sweep_cap_note(failures)]


def sweep_cap_note(failures):
    """Says how slow a contraction the sweep cap lets through: where runs end by it, the edge is not where it is 1."""
    capped = sum(bool(each.critical) and each.critical.fails.status == SWEEP_CAP for each in failures.maps.values())
    tolerance = recorded_tolerance(failures)
    if not capped or not tolerance:
        return []
    slowest = tolerance ** (1 / failures.max_sweeps)
    return [Paragraph(f"{capped} edges are where {failures.max_sweeps} sweeps no longer suffice: changes fall from 1 to"
                      f" {tolerance:.0e} in so many where they contract by {three_digits(slowest)} a sweep.")]


def families(failures, scene):
    """Returns the maps with a critical value and a linear limit, by families of methods."""
    found = {}
    for name in failures.integrators:
        for each in failures.line(scene, name):
            if each.over_limit:
                found.setdefault(family(name), []).append(each)
    return found


def end_texts(failures, each):
    contraction = each.critical.works.contraction
    known = contraction is not None and not failures.integrators[each.integrator].explicit
    return [three_digits(each.over_limit), f"{each.integrator}, n = {each.n}",
            three_digits(contraction) if known else MISSING, reading(failures, each)]


def reading(failures, each):
    """Says in a word why an edge is where it is, from the contraction measured in the last trial that works."""
    explicit = failures.integrators[each.integrator].explicit
    contraction = each.critical.works.contraction
    if 1 / AGREES <= each.over_limit <= AGREES:
        return AGREE
    if each.over_limit > 1:
        return TRIAL_ENDS if explicit else FROM_ROUNDING
    if each.critical.fails.status == UNSTABLE:
        return INVARIANTS
    if explicit:
        return MOVING
    if contraction is None:
        return UNEXPLAINED
    return COLD_START if contraction < CLEARLY_CONTRACTS else WEAK


# ---- advice


def safe_share(runs, name):
    """Returns the largest share of the critical step up to which every long run of a method lasted; None if none did.

    Where no long run was made of it, the critical step itself is all that is known: 1.
    """
    tried = [run for run in runs.runs if run.integrator == name] if runs else []
    failed = min((run.share for run in tried if not run.survived), default=math.inf)
    return max((run.share for run in tried if run.share < failed), default=None) if tried else 1.0


def safe_constant(failures, runs, scene, name):
    """Returns the c of h ≤ c / ‖B(W₀)‖₂ that holds at every n of a scene, or None."""
    largest = [each.largest_working for each in failures.line(scene, name)]
    share = safe_share(runs, name)
    return None if share is None or not largest or None in largest else share * min(largest)


def safe_step(failures, runs, scene, n, name):
    """Returns the largest safe step at one n, or None."""
    each, share = failures.at(scene, n, name), safe_share(runs, name)
    if each is None or share is None or each.largest_working is None:
        return None
    return share * each.largest_working / failures.settings[scene, n].norm_B


def advice_section(failures, runs, level):
    scene = CLAIMED_SCENE if CLAIMED_SCENE in failures.scenes() else failures.scenes()[0]
    sizes = failures.sizes(scene)
    columns = (Column("integrator", align="left"), *(Column(f"c, {each}") for each in failures.scenes()),
               Column("share"), *(Column(f"n = {n}", group=f"largest safe h, {scene} scene") for n in sizes))
    rows = [[name, *(number(safe_constant(failures, runs, each, name)) for each in failures.scenes()),
             number(safe_share(runs, name)), *(number(safe_step(failures, runs, scene, n, name)) for n in sizes)]
            for name in failures.integrators]
    norms = listed(f"{three_digits(failures.settings[scene, n].norm_B)} at n = {n}" for n in sizes)
    return [Heading("The largest safe step", level),
            Paragraph(f"Take h ≤ c / ‖B(W₀)‖₂. ‖B(W₀)‖₂ is in the {scene} scene {norms}. c is a share of the largest"
                      " h‖B(W₀)‖₂ that works, at the n where that is least; the steps at each n are by its own value."
                      + share_text(failures, runs) + f' "{MISSING}": no step is known to be safe. Other scenes fail'
                      " elsewhere: where they are rougher than both, try a few steps first."), table(columns, rows)]


def share_text(failures, runs):
    if not runs:
        return " Short trials are all that stands behind it: no long runs were made, and the share is 1."
    untried = [name for name in failures.integrators if not any(run.integrator == name for run in runs.runs)]
    text = (f" The share is the largest of {listed(f'{share:g}' for share in runs.shares())} up to which every long run of the"
            f" method came through {runs.steps} steps")
    return text + (f"; it is 1 for what had no long run ({joined(untried)})." if untried else ".")


def number(value):
    return MISSING if value is None else three_digits(value)


# ---- drift


def drift_section(runs, level):
    parts = [Heading("Drift in long runs", level), Paragraph(
        'Of the largest error so far. "none, x": it stays level, at most x. "linear r": it is r · time. "r t^p": it is'
        ' r · time^p. "exp r": it grows as exp(r · time). Decided on the samples above rounding and below saturation: an'
        " exponential where it fits the logarithm of the error better than a power of time does, and a power by the last"
        " decade of time. Of a run that failed: up to there."
        f' "{MISSING}": too few samples to tell.')]
    for scene, n in runs.settings():
        columns = [Column("integrator", align="left")]
        for share in runs.shares():
            group = f"{share:g} of the critical step"
            columns += [Column("ends", group, "left"), *(Column(each.name, group, "left") for each in QUANTITIES)]
        rows = [[name, *(text for share in runs.shares() for text in run_texts(runs, runs.at(scene, n, share, name)))]
                for name in runs.integrators]
        parts += [Heading(f"n = {n}, {scene} scene", level + 1), table(tuple(columns), rows)]
    return parts


def run_texts(runs, run):
    if run is None:
        return [MISSING] * (1 + len(QUANTITIES))
    return [ending(runs, run), *(drift_text(drift(each.series(run))) for each in QUANTITIES)]


def drift_text(each):
    if each is None:
        return MISSING
    if each.largest == 0:
        return "exactly 0"
    if each.kind == NONE:
        return f"none, {scientific(each.largest)}"
    if each.kind == EXPONENTIAL:
        return f"exp {three_digits(each.rate)}"
    return f"linear {scientific(each.rate)}" if each.kind == LINEAR else f"{scientific(each.rate)} t^{each.exponent:.1f}"
