"""Finds the cheapest method and step for a user's own scene by runs of the scene itself, called pilots, within a budget.

Pilots go over a part T/2^k of the time first, where the dear methods drop out; then over the longest part that the
budget allows, at best all of it. The reference solution of each part is the more accurate of two integrators that are
refined together until they agree; their distance is its uncertainty. Fast forms only. Needs NumPy and isosyrk.
"""

import csv
import itertools
import math
import signal
from dataclasses import dataclass, replace
from typing import Optional

import isosyrk
import numpy
import study
from accuracy_lines import FAST
from benchmark_json import UnusableFile, one_line, read_text
from recommendation import (ENERGY_JUDGED, MOST_OFFERED, PREDICTABLE, SMALLEST_ERROR, Answer, BelowReference, Offer,
                            Question, Unanswerable, that_keeps)
from study_file import CONVERGED, UNSTABLE
from trials import invariants_lost, larger

REFERENCES = ("group6", "group5")  # the first is the reference, in the frame where the list has it
FRAME = "_frame"
CANDIDATES = ("group3", "group4", "group5", "group2", "group6", "rkmk4", "rk4", "kahan_li6", "group1", "direct2",
              "yoshida4")
STOPPED = "too dear"  # status of a pilot that was stopped at TOO_DEAR times the cheapest one that was good

FIRST_TIME = 10.0  # of the first part, in units of 1/‖B(W₀)‖₂: some ten steps of a method of high order
AIM, ENOUGH = 1.3, 4.0  # steps are for the error over AIM; a pilot more than ENOUGH times better is made coarser
MOST_TRIES = 4  # of a method on a part of the time
SHARP, SHARP_ENOUGH = 10, 4  # the uncertainty of the reference aims at, and has to reach, the error over that
FLOOR = 1e-6  # below, two references that no longer come closer are at rounding
TOO_DEAR, STILL_CHEAP, MOST_KEPT = 4.0, 2.0, 5  # times the cheapest: pilots stop there, who goes on to the next part
MOST_TWINS = 2  # of the best methods, tried without the co-rotating frame too
NEXT_PART = 1.6  # runs that a method takes there, on average
LEAST_GROWTH = 1.5  # of the error as a power of time; 1 is seen over short times only
LOOKS = 8  # at a run of many steps, for its energy and its cost
TOLERANCE = 1e-13


class OutOfTime(Exception):
    """The budget is spent."""


@dataclass
class Pilot:
    integrator: str
    time: float
    steps: int
    status: str
    seconds: float
    error: Optional[float] = None
    error_at_half: Optional[float] = None  # of the pilot's time
    energy_at_half: Optional[float] = None
    W: Optional[numpy.ndarray] = None
    W_at_half: Optional[numpy.ndarray] = None

    @property
    def step(self):
        return self.time / self.steps

    def row(self, n):
        return {"integrator": self.integrator, "n": n, "time": self.time, "steps": self.steps, "step": self.step,
                "error": self.error, "seconds": self.seconds, "status": self.status}


# ---- the user's scene


def read_modes(path):
    """Returns the modes in a CSV file with the header l,m,re,im. Throws UnusableFile."""
    name = f"--modes {one_line(path)}"
    try:
        lines = read_text(path).lstrip("\ufeff").splitlines()
    except UnusableFile as problem:
        raise UnusableFile(f"{name}: {problem}") from None
    rows = [(number, [field.strip() for field in row]) for number, row in enumerate(csv.reader(lines), 1) if any(row)]
    columns = ("l", "m", "re", "im")
    if not rows or sorted(rows[0][1]) != sorted(columns):
        raise UnusableFile(f"{name}: the header must name l,m,re,im and no other")
    modes = []
    for number, fields in rows[1:]:
        found = dict(zip(rows[0][1], fields))
        try:
            if len(fields) != len(columns):
                raise ValueError
            modes.append((int(found["l"]), int(found["m"]), float(found["re"]), float(found["im"])))
        except ValueError:
            raise UnusableFile(f"{name}, line {number}: must be 4 numbers (l,m,re,im)") from None
    return modes


def scene_of(options):
    """Returns the user's scene. Throws UnusableFile."""
    name = f"--modes {options.modes}" if options.modes is not None else f"--state {options.state}"
    try:
        if options.modes is not None:
            return isosyrk.scene(modes=read_modes(options.modes), n=options.n)
        try:
            W = numpy.load(options.state, allow_pickle=False)
        except (OSError, ValueError, EOFError):
            raise UnusableFile(f"{name}: cannot be read as a NumPy .npy file") from None
        scene = isosyrk.scene(initial=W, n=options.n)
    except (ValueError, TypeError) as problem:
        raise UnusableFile(f"{name}: {problem}") from None
    if not numpy.any(scene.initial):
        raise UnusableFile(f"{name}: is 0")
    return scene


# ---- pilots


class Search:
    """The pilots of one scene, and what they say so far."""

    def __init__(self, scene, question):
        self.scene, self.question = scene, question
        self.norm_B, _ = scene.generator_norms()
        self.energy = scene.energy(scene.initial)
        self.largest = float(numpy.linalg.norm(scene.initial, 2))
        # The module's tolerance suits states of norm 1.
        self.tolerance = TOLERANCE if 0.5 < self.largest < 2 else max(1e-15, TOLERANCE * self.largest)
        self.entries = {each.name: study.record_of(each) for each in isosyrk.integrators()}
        self.pilots = []
        self.reference = None  # Pilot
        self.uncertainty = 0.0
        self.trajectory = True  # whether that is judged, or energy and spectrum
        self.good = {}  # integrator: the best Pilot over the longest part that it did
        self.failed = {}  # integrator: the shortest step that failed

    def in_frame(self, name):
        """Returns the name of an integrator in the co-rotating frame, if the list has it."""
        return name + FRAME if name + FRAME in self.entries else name

    def candidates(self):
        """Returns the names of the integrators that may be offered, those with a listed frame in it only."""
        names = map(self.in_frame, CANDIDATES)
        return [name for name in names if self.entries[name].keeps(self.question.keep)]

    def run(self, name, steps, time, most_seconds=math.inf):
        """Returns the Pilot of a run, its steps as even() has them; an error of the trajectory is not yet in it."""
        method = isosyrk.integrator(self.scene, name, solver=FAST, tolerance=self.tolerance)
        pilot = Pilot(name, time, steps, CONVERGED, 0.0)
        self.pilots.append(pilot)
        limit, energy_errors = method.linear_limit(), [0.0]

        def look(step, W, report):
            energy_errors.append(larger(energy_errors[-1], abs(self.scene.energy(W) / self.energy - 1)))
            if 2 * step == steps:
                pilot.W_at_half, pilot.energy_at_half = W.copy(), energy_errors[-1]
            return report.seconds > most_seconds

        if limit is not None and self.norm_B * pilot.step > limit:
            pilot.status = UNSTABLE
        else:
            try:
                every = steps // LOOKS if steps % LOOKS == 0 else 1
                pilot.W, report = method.run(self.scene.initial, pilot.step, steps, observe=look, every=every)
                pilot.seconds = report.seconds
                pilot.status = self.status(pilot, energy_errors[-1]) if report.steps == steps else STOPPED
            except isosyrk.SolverError as failure:
                pilot.status, pilot.seconds = failure.status, failure.report.seconds
        if pilot.status not in (CONVERGED, STOPPED):
            self.failed[name] = min(pilot.step, self.failed.get(name, math.inf))
        elif pilot.status == CONVERGED and not self.trajectory:
            pilot.error = max(energy_errors[-1], self.spectrum_error(pilot.W))
            pilot.error_at_half = max(pilot.energy_at_half, self.spectrum_error(pilot.W_at_half))
        return pilot

    def status(self, pilot, energy_error):
        errors = {"spectrum_error": self.spectrum_error(pilot.W), "energy_error": energy_error,
                  "skew_defect": isosyrk.skew_defect(pilot.W) / self.largest}
        return UNSTABLE if invariants_lost(errors, self.entries[pilot.integrator].isospectral) else CONVERGED

    def spectrum_error(self, W):
        return isosyrk.spectrum_error(W, self.scene.initial) / self.largest

    def refer(self, time, error):
        """Makes the reference solution of a part of the time; if two do not agree, no trajectory is judged any more.

        Throws BelowReference where they agree to less than what is asked for.
        """
        names = list(map(self.in_frame, REFERENCES))
        order = self.entries[names[1]].order
        steps, before = even(time * (1 / self.reference.step if self.reference else self.norm_B)), math.inf
        for tries in itertools.count(1):
            pair = [self.run(name, steps, time) for name in names]
            if any(each.status != CONVERGED for each in pair):
                steps = even(1.5 * steps)
                continue
            found = isosyrk.relative_error(pair[1].W, pair[0].W)
            pair[0].error = pair[1].error = found
            if found < before:
                self.reference, self.uncertainty = replace(pair[0], seconds=pair[0].seconds + pair[1].seconds), found
            for each in pair:
                each.W = each.W_at_half = None
            if found <= error / SHARP or (found > before / 2 and (before < FLOOR or tries > MOST_TRIES)):
                break
            before = min(before, found)
            steps = even(steps * min(3.0, max(1.2, (2 * SHARP * found / error) ** (1 / order))))
        if self.uncertainty > PREDICTABLE:
            self.trajectory, self.good = False, {}
        elif self.uncertainty > self.question.error:
            raise BelowReference(f"--error {self.question.error:g}: is below the uncertainty of the reference solution of"
                                 f" this scene, {self.uncertainty:.2g} at T = {time:g}")

    def pilot(self, name, steps, time, most_seconds):
        """Returns a Pilot with its error."""
        pilot = self.run(name, steps, time, most_seconds)
        if pilot.status == CONVERGED and self.trajectory:
            pilot.error = isosyrk.relative_error(pilot.W, self.reference.W) + self.uncertainty
            pilot.error_at_half = isosyrk.relative_error(pilot.W_at_half, self.reference.W_at_half)
        pilot.W = pilot.W_at_half = None
        return pilot

    def search(self, name, time, error, most_seconds):
        """Returns the Pilot with the longest step that has an error over a part of the time; None if none has."""
        order, best = self.entries[name].order, None
        steps = (self.expected(self.good[name], time, error).steps if name in self.good else
                 even(time * self.norm_B * max(1.0, error ** (-1 / order) / 5)))
        for _ in range(MOST_TRIES):
            if time / steps >= self.failed.get(name, math.inf):
                if best:
                    break
                steps = even(1.3 * time / self.failed[name])
            pilot = self.pilot(name, steps, time, most_seconds)
            if pilot.status == STOPPED:
                break
            if pilot.status != CONVERGED:
                continue
            if pilot.error <= error and (best is None or pilot.seconds < best.seconds):
                best = pilot
            change = (max(pilot.error, SMALLEST_ERROR) * AIM / error) ** (1 / order)
            wanted = even(steps * min(4.0, max(0.25, change)))
            if error / ENOUGH < pilot.error <= error or wanted == steps:
                break
            if pilot.seconds * wanted / steps > most_seconds:
                break
            steps = wanted
        return best

    def growth(self, pilot):
        """Returns the growth of a pilot's error as a power of time."""
        if not self.trajectory:
            return 0.0 if self.entries[pilot.integrator].lie_poisson else 1.0
        seen = math.log2(pilot.error / pilot.error_at_half) if pilot.error_at_half else 0.0
        return min(4.0, max(LEAST_GROWTH, seen))

    def expected(self, pilot, time, error):
        """Returns a pilot over this time as it is; otherwise one for the error, as extrapolated from a shorter time."""
        if pilot.time == time:
            return pilot
        order = self.entries[pilot.integrator].order
        at_time = max(pilot.error, SMALLEST_ERROR) * (time / pilot.time) ** self.growth(pilot)
        steps = even(time / pilot.step * max(0.5, (at_time * AIM / error) ** (1 / order)))
        if time / steps >= self.failed.get(pilot.integrator, math.inf):
            steps = even(time / pilot.step)
        return replace(pilot, time=time, steps=steps, error=at_time * (time / steps / pilot.step) ** order,
                       seconds=pilot.seconds * steps / pilot.steps)

    def ranking(self):
        """Returns what is expected of each good integrator over the whole time; first those with the longest pilots."""
        longest = max((each.time for each in self.good.values()), default=0)
        found = [(each.time < longest, self.expected(each, self.question.time, self.question.error))
                 for each in self.good.values()]
        return [each for _, each in sorted(found, key=lambda pair: (pair[0], pair[1].seconds))]

    def go_on(self, left):
        """Makes pilots over longer and longer parts of the time, until it is whole or the next part takes too long.

        `left()` returns the seconds that are left. Throws BelowReference, and OutOfTime from anywhere.
        """
        whole, names = self.question.time, self.candidates()
        time = whole / 2 ** max(0, math.floor(math.log2(whole * self.norm_B / FIRST_TIME)))
        while True:
            before, made = left(), len(self.pilots)
            self.try_all(names, time)
            if made == 0:  # whether the frame is of use in this scene
                self.try_all([each.integrator.replace(FRAME, "") for each in self.ranking()[:MOST_TWINS]
                              if FRAME in each.integrator], time)
            if time == whole:
                return
            ranked = self.ranking()
            if ranked:
                names = [each.integrator for each in ranked[:MOST_KEPT] if each.seconds <= STILL_CHEAP * ranked[0].seconds]
            chosen = NEXT_PART * sum(self.good[name].seconds for name in names if name in self.good)
            busy = (before - left()) / sum(each.seconds for each in self.pilots[made:])  # wall time a CPU second
            parts = math.floor(math.log2(left() / busy / (chosen + NEXT_PART * self.reference.seconds)))
            if parts < 1:
                return
            time = min(whole, time * 2 ** parts)

    def try_all(self, names, time):
        """Makes the pilots of these integrators over a part of the time."""
        share = time / self.question.time  # an error grows at least in proportion to time
        if self.trajectory and not (self.reference and self.reference.time == time):
            self.refer(time, self.question.error * share)
        error = self.question.error
        if self.trajectory:
            error = min(error, max(error * share, SHARP_ENOUGH * self.uncertainty))
        cheapest = min((each.seconds for each in self.good.values() if each.time == time), default=math.inf)
        for name in names:
            best = self.search(name, time, error, TOO_DEAR * cheapest)
            if best:
                self.good[name] = best
                cheapest = min(cheapest, best.seconds)
            else:
                self.good.pop(name, None)


def even(steps):
    """Rounds a number of steps up to an even one, a multiple of LOOKS where there are many."""
    unit = LOOKS if steps > 8 * LOOKS else 2
    return max(unit, unit * math.ceil(steps / unit * (1 - 1e-9)))


# ---- the answer


def answer(options, left):
    """Returns the Answer for the user's scene. Throws UnusableFile, BelowReference, Unanswerable.

    `left()` returns the seconds that are left; SIGALRM comes at their end.
    """
    def stop(*_):
        raise OutOfTime

    scene = scene_of(options)
    question = Question(one_line(options.modes or options.state), scene.n, options.time, options.error, options.keep)
    search, spent = Search(scene, question), False
    try:
        signal.signal(signal.SIGALRM, stop)
        if left() > 0:
            search.go_on(left)
        else:
            spent = True
    except OutOfTime:
        spent = True
    signal.setitimer(signal.ITIMER_REAL, 0)
    offers = [offer_of(search, each) for each in search.ranking()]
    if not offers or offers[0].error > question.error:
        raise Unanswerable(best_there_is(search, spent))
    offers[0] = offers[0]._replace(evidence=[each.row(scene.n) for each in search.pilots])
    arguments = ["--modes", options.modes] if options.modes is not None else ["--initial", options.state]
    if search.tolerance != TOLERANCE:
        arguments += ["--tolerance", repr(search.tolerance)]
    source = {"measured": f"here, {len(search.pilots)} pilots"}
    return Answer(question, offers[:MOST_OFFERED], "trajectory" if search.trajectory else "energy and spectrum",
                  statements(search, spent), None, source, arguments)


def offer_of(search, pilot):
    return Offer(search.entries[pilot.integrator], pilot.step, pilot.steps, pilot.error, pilot.seconds,
                 [each.row(search.scene.n) for each in search.pilots if each.integrator == pilot.integrator])


def statements(search, spent):
    """Says what stands behind the answer."""
    said, whole = [], search.question.time
    reference = search.reference
    if reference:
        said.append(f"reference solution: {reference.integrator} with {reference.steps} steps to T = {reference.time:g},"
                    f" with an uncertainty of {search.uncertainty:.2g}")
    if not search.trajectory:
        said.append(f"T = {whole:g} is beyond predictability (two reference solutions differ by {search.uncertainty:.2g}):"
                    f" {ENERGY_JUDGED}")
    best = search.good[search.ranking()[0].integrator]
    if best.time < whole:
        said.append(f"the pilots behind the answer end at T = {best.time:g}: error and seconds are extrapolated, the error"
                    f" as time to the power {search.growth(best):.2g}")
    if spent:
        said.append("the budget was spent before all pilots were made")
    return said


def best_there_is(search, spent):
    """Says in a line that no pilot reaches the error, and which came nearest."""
    what = f"no pilot of a method{that_keeps(search.question.keep)} reached the error {search.question.error:g}"
    if spent:
        what += " within the budget"
    tried = [each for each in search.pilots if each.error is not None and each.integrator in search.candidates()]
    if not tried:
        return f"{what}, and none came to an end"
    best = min(tried, key=lambda each: (-each.time, each.error))
    return (f"{what}; the best there is has {best.error:.3g}, by {best.integrator} with h = {best.step:.4g} to T ="
            f" {best.time:g}")
