"""What the study `practice` finds, as records, and the figures for pages, by key. Standard library only."""

import statistics
from typing import List, NamedTuple

from lib.judging.verdicts import fastest, ratio_of
from lib.records.formats import number, one_of, optional, positive, text, truth, whole
from lib.records.integrators import EXPONENTIAL, GAUSS, KEPT, MAGNUS, RKMK, RUNGE_KUTTA, is_new
from lib.records.settings import ENERGY_BOUNDED, keeps
from studies.practice.schema import METHOD, PRACTICE, QUFLOW, ROLES, SCENES, WANTED, finite_or_none

NOTHING, SPECTRUM, POISSON = KEPT

# Groups of methods, of each of which the cheapest is told: by what they keep at their tolerance, and by class. A group
# is a function of an Integrator and a tolerance.
BEST = "best"
BY_STRUCTURE = {BEST: lambda each, tolerance: True,
                SPECTRUM: lambda each, tolerance: keeps(each, tolerance, SPECTRUM),
                POISSON: lambda each, tolerance: keeps(each, tolerance, POISSON)}
BY_CLASS = {"explicit": lambda each, tolerance: each.explicit and not each.isospectral,
            "projected": lambda each, tolerance: each.projected,
            "magnus": lambda each, tolerance: each.family == MAGNUS,
            "rkmk": lambda each, tolerance: each.family == RKMK,
            "exponential": lambda each, tolerance: each.family == EXPONENTIAL,
            "gauss": lambda each, tolerance: each.family == GAUSS,
            "other": lambda each, tolerance: is_new(each)}
GROUPS = {**BY_STRUCTURE, **BY_CLASS}


class Result(NamedTuple):
    """A row with its cost, and how many times as long the practice and quflow take, with 95 % intervals.

    Where no steps reach the error, what stands from `steps` on is None.
    """

    scene: one_of(*SCENES)
    n: whole(2)
    role: one_of(*ROLES)
    wanted: one_of(*WANTED)
    integrator: text
    order: whole(1)
    family: text
    tolerance: positive
    keeps: one_of(*KEPT)  # the strongest structure that it keeps at its tolerance
    is_bounded: truth  # whether it runs at the tolerance at which the energy stays bounded
    steps: optional(whole(1)) = None
    step: optional(positive) = None
    step_over_practice: optional(positive) = None
    scaled_step: optional(positive) = None  # h‖ad_B‖₂ at the start, as methods see it; none of practice and quflow
    error: optional(number) = None
    energy_error: optional(number) = None
    spectrum_error: optional(number) = None
    sweeps: optional(number) = None  # a step
    products: optional(positive) = None  # equivalent ones, of the run
    capped: optional(whole()) = None
    seconds: optional(positive) = None  # of CPU time for a unit of simulated time
    gain_over_practice: optional(positive) = None
    gain_over_practice_low: optional(positive) = None
    gain_over_practice_high: optional(positive) = None
    gain_over_quflow: optional(positive) = None
    gain_over_quflow_low: optional(positive) = None
    gain_over_quflow_high: optional(positive) = None

    @property
    def method(self):
        """Returns its name in keys: that of the integrator, told apart at the tolerance of bounded energy."""
        return f"{self.integrator}_bounded" if self.is_bounded else self.integrator


class Leader(NamedTuple):
    """The cheapest method of a group at an error."""

    scene: one_of(*SCENES)
    n: whole(2)
    wanted: one_of(*WANTED)
    group: one_of(*GROUPS)
    integrator: text
    tolerance: positive


class ThreadGain(NamedTuple):
    """What threads gain, in seconds that pass, with its 95 % interval."""

    scene: one_of(*SCENES)
    n: whole(2)
    integrator: text
    tolerance: positive
    threads: whole(1)
    seconds: positive  # for a unit of simulated time, by so many threads
    gain: optional(positive) = None  # over one thread
    gain_low: optional(positive) = None
    gain_high: optional(positive) = None


class Findings(NamedTuple):
    results: List[Result]
    leaders: List[Leader]
    threads: List[ThreadGain]


def findings(study):
    """Returns the Findings of a Practice."""
    found = Findings([], [], [])
    for key in study.problems:
        found.results.extend(result(study, key, row) for row in study.rows[key])
        for wanted in WANTED:
            for group in GROUPS:
                if (row := cheapest(study, key, wanted, group)) is not None:
                    found.leaders.append(Leader(*key, wanted, group, row.integrator, row.tolerance))
    for (*key, form), rows in study.thread_blocks().items():
        for threads, row in sorted(rows.items()):
            over = ratio_of(rows[1].seconds, row.seconds) if threads > 1 else None
            told = ThreadGain(*key, *form, threads, statistics.geometric_mean(row.seconds)
                              / study.problems[tuple(key)].time)
            found.threads.append(told if over is None else told._replace(
                gain=over.ratio, gain_low=over.low or None, gain_high=finite_or_none(over.high)))
    return found


def cheapest(study, key, wanted, group):
    """Returns the row of the cheapest method of a group on a problem at an error, or None."""
    rows = {row.form: row for row in study.methods(key, wanted) if row.steps is not None
            and GROUPS[group](study.integrators[row.integrator], row.tolerance)}
    return rows[fastest({form: row.cpu_seconds for form, row in rows.items()})] if rows else None


def result(study, key, row):
    integrator, time = study.integrators[row.integrator], study.problems[key].time
    strongest = next(each for each in reversed(KEPT) if keeps(integrator, row.tolerance, each))
    told = Result(*key, row.role, row.wanted, row.integrator, integrator.order, integrator.family, row.tolerance,
                  strongest, row.role == METHOD and integrator.lie_poisson and row.tolerance <= ENERGY_BOUNDED)
    if row.steps is None:
        return told
    return told._replace(
        steps=row.steps, step=time / row.steps, step_over_practice=study.practice(key).steps / row.steps,
        scaled_step=scaled_step(study, key, row), error=row.error,
        energy_error=row.energy_error, spectrum_error=row.spectrum_error, sweeps=row.sweeps / row.steps,
        products=row.products, capped=row.capped, seconds=row.seconds / time,
        **gains("practice", study.practice(key), row), **gains("quflow", study.quflow(key), row))


def scaled_step(study, key, row):
    """Returns h‖ad_B‖₂ of a method, None of the practice and of quflow, which see the flow outside the frame."""
    problem = study.problems[key]
    return problem.time / row.steps * problem.norm_ad_B if row.role == METHOD else None


def gains(name, other, row):
    """Returns how many times as long another row takes as fields of Result; none where there is no other."""
    if other is None or other.role == row.role:
        return {}
    found = ratio_of(other.cpu_seconds, row.cpu_seconds)
    return {f"gain_over_{name}": found.ratio, f"gain_over_{name}_low": found.low or None,
            f"gain_over_{name}_high": finite_or_none(found.high)}


def leading_results(found):
    """Yields each Leader of Findings with its Result."""
    rows = {(row.scene, row.n, row.wanted, row.integrator, row.tolerance): row for row in found.results
            if row.role == METHOD}
    for each in found.leaders:
        yield each, rows[each.scene, each.n, each.wanted, each.integrator, each.tolerance]


# ---- figures for pages

# The step of the script that pages show to users of quflow, over the practice's: 20 ħ over ħ/4.
SCRIPT = 80
NUMBERS = ("steps", "step", "step_over_practice", "scaled_step", "seconds", "error", "energy_error", "spectrum_error",
           "capped", *(f"gain_over_{other}{end}" for other in (PRACTICE, QUFLOW) for end in ("", "_low", "_high")))


def figures(found):
    """Returns the figures of Findings, by key.

    SCENE.nN.practice.* and SCENE.nN.quflow.* are of the practice and of quflow's own step. SCENE.nN.WANTED.WHO.* are of
    a method, or of the cheapest of a group: WANTED is same or tenth, WHO a group or an integrator, with _bounded behind
    it at the tolerance of bounded energy. Each has what NUMBERS names: seconds of CPU time for a unit of simulated
    time, and gain_over_quflow, how many times as long quflow takes; of a Runge–Kutta method whose step may be that of
    the script also script_gain_over_quflow, at that step. SCENE.nN.threads.NAME.pP.gain is of P threads.
    """
    told = {}
    for row in found.results:
        key = f"{row.scene}.n{row.n}"
        put(told, f"{key}.{row.wanted}.{row.method}" if row.role == METHOD else f"{key}.{row.role}", row)
    for each, row in leading_results(found):
        put(told, f"{each.scene}.n{each.n}.{each.wanted}.{each.group}", row)
    for each in found.threads:
        key = f"{each.scene}.n{each.n}.threads.{each.integrator}.p{each.threads}"
        told.update({f"{key}.{name}": value for name in ("gain", "gain_low", "gain_high")
                     if (value := getattr(each, name)) is not None})
        told[f"{key}.seconds"] = each.seconds
    return told


def put(told, key, row):
    if row.seconds is not None:
        told.update({f"{key}.{name}": value for name in NUMBERS if (value := getattr(row, name)) is not None})
        told.update({f"{key}.script_{name}": value for name, value in script_gains(row).items()})


def script_gains(row):
    """Returns what the step of the script gains, by name, where it is shorter and every step takes as long."""
    if row.family != RUNGE_KUTTA or row.keeps != NOTHING or row.step_over_practice < SCRIPT:
        return {}
    return {name: SCRIPT / row.step_over_practice * gain for name in (f"gain_over_{PRACTICE}", f"gain_over_{QUFLOW}")
            if (gain := getattr(row, name)) is not None}
