"""Single runs of the study `practice`: initial data, the practice, references, and the fewest steps of a method.

A job is a dict of `scene`, `n`, `time` and the `folder` of states, which stands beside the raw file until that is
written: a reference at n = 1025 takes minutes and 17 MB. Results name states by a hash of their bytes. Needs isosyrk.
"""

import functools
import hashlib
import io
import math
import os
from functools import partial
from typing import NamedTuple, Optional

import isosyrk
import numpy

from lib.programs.command_line import Stop
from lib.programs.output import replace_file
from lib.records.formats import CONVERGED, FAST, UNSTABLE, to_digits
from lib.records.settings import TIGHT
from lib.running import built, trials
from studies.accuracy.comparisons import MORE, TOO_MUCH, fewest_steps, is_reached
from studies.practice import plan, quflow_step
from studies.practice.schema import (AT_PRACTICE, AT_TENTH, BASELINE_INTEGRATOR, BASELINE_TOLERANCE, METHOD, PRACTICE,
                                     QUFLOW, TENTH, TURBULENCE)
from studies.turbulence.single_runs import drawn_scene

LOST_SPECTRUM = 0.1  # of the largest eigenvalue, which is 1: a run that lost so much is unstable
DIGITS = 4  # of what is recorded

INITIAL, REFERENCE = "initial", "reference"  # states; others are called "practice", a method, or a place of the run


# ---- states beside the raw file


def state_path(job, what):
    return os.path.join(job["folder"], f"{job['scene']}_n{job['n']}_{what}.npy")


def save(job, what, W):
    """Keeps a state. Returns the hash of its bytes."""
    stream = io.BytesIO()
    numpy.save(stream, W)
    replace_file(state_path(job, what), stream.getvalue())
    return hash_of(W)


def load(job, what):
    return numpy.load(state_path(job, what), allow_pickle=False)


def hash_of(W):
    return hashlib.sha256(numpy.ascontiguousarray(W).tobytes()).hexdigest()[:16]


def is_kept(job, hashes):
    """Tells whether states, a dict of hashes by name, are all beside the raw file as they were found."""
    try:
        return all(hash_of(load(job, what)) == found for what, found in hashes.items())
    except (OSError, ValueError):
        return False


# ---- initial data


def begin(job):
    """Finds the initial data of a job. Returns hashes, the time of development, and the share of the tail."""
    developed = 0.0
    if job["scene"] == TURBULENCE:
        W, developed = develop(job["n"])
    else:
        W = isosyrk.scene(job["scene"], n=job["n"]).initial
    return {"states": {INITIAL: save(job, INITIAL, W)}, "developed": developed, "tail": rounded(tail_of(W))}


def develop(n):
    """Returns a sample of the study turbulence when it has filled the tail of E(l), and the time that this took."""
    scene = drawn_scene(n, plan.SAMPLE)
    method = isosyrk.integrator(scene, plan.DEVELOPING, solver=FAST)
    every = plan.steps_a_look(n)
    step = plan.TAIL_LOOK / every
    try:
        W, report = method.run(scene.initial, step, round(plan.MAX_DEVELOPING / step),
                               lambda _step, W, _report: tail_of(W) >= plan.TAIL_SHARE, every)
    except isosyrk.SolverError as error:
        raise Stop(f"turbulence at n = {n} did not develop: {error}") from error
    return W, rounded(report.steps * step)


def tail_of(W):
    """Returns the share of the enstrophy in degrees l ≥ TAIL_FROM (n − 1)."""
    degrees = numpy.arange(1, len(W))
    enstrophies = degrees * (degrees + 1) * isosyrk.energy_spectrum(W)[1:]
    return float(enstrophies[degrees >= plan.TAIL_FROM * degrees[-1]].sum() / enstrophies.sum())


# ---- runs


class Look(NamedTuple):
    """What a run came to and what it cost; errors are None where it came to no usable end."""

    steps: int
    status: str
    error: Optional[float] = None
    energy_error: Optional[float] = None
    spectrum_error: Optional[float] = None
    sweeps: Optional[int] = None
    equivalent_products: Optional[float] = None

    @property
    def usable(self):
        return self.status == CONVERGED


class Setting(trials.Setting):
    """The problem of a job; its reference is there from the second stage on."""

    def __init__(self, job):
        self.job, self.time = job, job["time"]
        super().__init__(scene_of(job))
        self.framed_norm = self.scene.generator_norms(co_rotating=True)[1]

    @property
    def in_frame(self):
        """Tells whether methods run in the co-rotating frame."""
        return self.framed_norm <= plan.FRAME_GAIN * self.norm_ad_B

    @property
    def own_norm(self):
        """Returns ‖ad_B‖₂ of the initial data as methods see it."""
        return self.framed_norm if self.in_frame else self.norm_ad_B

    @functools.cached_property
    def reference(self):
        return load(self.job, REFERENCE)

    def method(self, name, tolerance):
        return method_of(self.scene, name, tolerance)

    def look(self, method, steps):
        """Makes one run to T. Returns its Look, without an error against the reference, and W(T)."""
        initial = self.scene.initial
        with numpy.errstate(all="ignore"):
            W, report, status, _, energy_error = self.run(method, self.time / steps, steps,
                                                          math.ceil(steps / plan.LOOKS))
            if status == CONVERGED and not (numpy.isfinite(W).all() and (
                    spectrum_error := isosyrk.spectrum_error(W, initial)) <= LOST_SPECTRUM):
                status = UNSTABLE
        if status != CONVERGED:
            return Look(steps, status), None
        return Look(steps, status, None, energy_error, spectrum_error, report.sweeps, report.equivalent_products), W

    def look_with_error(self, method, steps):
        """Makes one run to T. Returns its Look."""
        found, W = self.look(method, steps)
        return found._replace(error=isosyrk.relative_error(W, self.reference)) if found.usable else found


def scene_of(job):
    """Returns the scene of a job, from its kept initial data."""
    return isosyrk.scene(job["scene"], initial=load(job, INITIAL), hbar="paper")


def method_of(scene, name, tolerance, **options):
    """Returns an integrator, in its fast form where it has one."""
    return isosyrk.integrator(scene, name, solver=built.solver_of(name), tolerance=tolerance,
                              max_sweeps=plan.MAX_SWEEPS, **options)


def rounded(value):
    return to_digits(value, DIGITS)


def fields_of(look, capped=0):
    """Returns a Look as fields of Row."""
    return {"steps": look.steps, "sweeps": look.sweeps, "products": rounded(look.equivalent_products), "capped": capped,
            **{name: rounded(getattr(look, name)) for name in ("error", "energy_error", "spectrum_error")
               if getattr(look, name) is not None}}


def practise(job):
    """Runs the practice. Returns hashes, its fields of Row but for the error, and what is known of the problem."""
    setting = Setting(job)
    look, W = setting.look(setting.method(BASELINE_INTEGRATOR, BASELINE_TOLERANCE), plan.practice_steps(job))
    if not look.usable:
        raise Stop(f"the practice of the {job['scene']} scene at n = {job['n']}: {look.status}")
    return {"states": {PRACTICE: save(job, PRACTICE, W)}, "row": fields_of(look), "in_frame": bool(setting.in_frame),
            "norm_ad_B": rounded(setting.own_norm)}


def solve(job):
    """Finds the solution by a method, halving its steps until it is much more accurate than the practice.

    Returns hashes, the number of steps, and the error of the solution: its change with the last halving over 2^p − 1,
    for order p. States at the places where runs are timed are kept with it.
    """
    setting, practice = Setting(job), load(job, PRACTICE)
    method, order = setting.method(job["integrator"], TIGHT), built.integrators()[job["integrator"]].order
    fewest, before, error = plan.PLACES * first_steps(setting, 1 / plan.PLACES), None, math.inf
    for halvings in range(plan.MAX_HALVINGS + 1):
        steps, at = 2**halvings * fewest, {}

        def keep(step, W, _report):
            if step < steps:
                at[step * plan.PLACES // steps] = W.copy()

        W, _, status, _ = trials.run(method, setting.scene.initial, job["time"] / steps, steps, keep,
                                     steps // plan.PLACES)
        good = status == CONVERGED and numpy.isfinite(W).all()
        if good and before is not None:
            error = isosyrk.relative_error(before, W) / (2**order - 1)
            if error <= max(plan.REFERENCE_SHARE * isosyrk.relative_error(practice, W), plan.FLOOR):
                break
        before = W if good else None
    states = {job["what"]: W, **{f"{job['what']}_place{place}": state for place, state in at.items()
                                 if job["what"] == REFERENCE and job["n"] > plan.LARGEST_WHOLE_QUFLOW}}
    return {"states": {name: save(job, name, state) for name, state in states.items()}, "steps": steps,
            "error": rounded(min(error, 1.0))}


def first_steps(setting, share=1.0):
    """Returns the number of steps that a search begins with, for a share of the run."""
    return max(1, math.ceil(share * setting.time * setting.own_norm / plan.RESOLVED))


# ---- the fewest steps


def find(job):
    """Returns the rows of an integrator at each of its tolerances and each wanted error, as fields of Row.

    A job has `integrator`, its `tolerances` and the `errors` by name. The second tolerance begins with the steps of the
    first, which are its own where the error is that of the step.
    """
    setting, entry = Setting(job), built.integrators()[job["integrator"]]
    rows, begin_with = [], {}
    for tolerance in job["tolerances"]:
        method = setting.method(entry.name, tolerance)
        look = functools.lru_cache(maxsize=None)(partial(setting.look_with_error, method))
        for wanted, error in job["errors"].items():
            best = cheapest(look, entry, error, begin_with.get(wanted) or first_steps(setting),
                            plan.up_to(plan.CLOSE, job["n"]), is_known=wanted in begin_with)
            if best is not None:
                begin_with[wanted] = best.steps
            rows.append({"role": METHOD, "wanted": wanted, "integrator": entry.name, "tolerance": tolerance,
                         **({} if best is None else fields_of(best))})
    return rows


def cheapest(look, entry, error, steps, close, is_known):
    """Returns the Look with the fewest steps that reach an error, or with some more where these take less work.

    `steps` are tried first; they are taken as they are if they are known to be the fewest of another tolerance and
    reach the error. None if no steps reach it.
    """
    first = look(steps)
    if is_known and is_reached(error, first):
        return first
    if first.usable and not is_reached(error, first):  # so that a search goes on from where the order tells
        steps = max(steps, math.ceil(steps * (first.error / error) ** (1 / entry.order)))
    fewest = best = fewest_steps(look, steps, error, entry.order, close)
    for more in () if fewest is None or entry.explicit else MORE[FAST]:
        run = look(math.ceil(more * fewest.steps))
        if not is_reached(error, run) or run.equivalent_products > TOO_MUCH * best.equivalent_products:
            break
        best = min(best, run, key=lambda each: each.equivalent_products)
    return best


# ---- quflow's own step


def run_quflow(job):
    """Returns the run of quflow's own step with the steps of the practice, as fields of Row."""
    setting = Setting(job)
    initial, steps, largest = setting.scene.initial, plan.practice_steps(job), 0.0
    every, seen = math.ceil(steps / plan.LOOKS), 0

    def watch(W, dW):
        nonlocal largest, seen
        seen += 1
        if seen % every == 0 or seen == steps:
            largest = trials.larger(largest, setting.energy_error(W + dW))

    W, stats = quflow_step.run(job["quflow"], initial, job["time"] / steps, steps, watch)
    W = (W - W.conj().T) / 2
    iterations = round(stats["iterations"] * steps)
    look = Look(steps, CONVERGED, isosyrk.relative_error(W, setting.reference), largest,
                isosyrk.spectrum_error(W, initial), iterations, quflow_step.PRODUCTS * iterations)
    return {"role": QUFLOW, "wanted": AT_PRACTICE, "integrator": BASELINE_INTEGRATOR,
            "tolerance": to_digits(stats["tol_auto"] / numpy.linalg.norm(initial, numpy.inf), 2),
            **fields_of(look, round(stats["number_of_maxit"] * steps))}


def errors_of(job):
    """Returns the error of the practice, and the errors that methods are brought to, by name."""
    error = isosyrk.relative_error(load(job, PRACTICE), load(job, REFERENCE))
    return error, {AT_PRACTICE: error, AT_TENTH: TENTH * error}
