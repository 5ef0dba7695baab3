"""Finds the cheapest method and step for a user's own scene by runs of that scene, called pilots, within a budget.

Pilots go over a part T/2^k of the time first, where the dear methods drop out; then over the longest part that the
budget allows, at best all of it. The reference solution of each part is the first of two integrators that are refined
together until they agree; their distance is its uncertainty. Fast forms only, in the co-rotating frame where the list
has it: that is exact and costs nothing. Needs NumPy and isosyrk.
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
                            Question, Unanswerable, energy_growth, that_keeps)
from study_file import CONVERGED, UNSTABLE
from trials import invariants_lost, larger

REFERENCES = ("group6", "group5")
FRAME = "_frame"
CANDIDATES = ("rk4", "group3", "group4", "rkmk4", "group5", "group2", "group6", "kahan_li6", "yoshida4", "direct2",
              "group1")
STOPPED = "too dear"  # status of a pilot that was stopped at TOO_DEAR times the cheapest one that was good

# Step sizes are told by h‖B(W₀)‖₂, the first part of the time by T‖B(W₀)‖₂.
FIRST_TIME, FIRST_REFERENCE = 10.0, 2.0
FIRST_STEP = 15.0  # times the root of the error, at most 1
# Longest step that is offered untried over the whole time: long runs were seen to fail from 5.2 on, short ones later.
MOST_UNTRIED = 3.5
AIM, ENOUGH = 1.3, 4.0  # steps are for the error over AIM; a pilot more than ENOUGH times better is made coarser
MOST_TRIES = 4  # of a method on a part of the time
SHARP, SHARP_ENOUGH = 10, 4  # the uncertainty of the reference aims at, and has to reach, the error over that
FLOOR = 1e-6  # below, two references that no longer come closer are at rounding
TOO_DEAR, STILL_CHEAP = 8.0, 2.0  # times the cheapest: where pilots stop, and who goes on to the next part;
LEAST_KEPT, MOST_KEPT = 2, 5  # so many do at least, and at most
NEXT_PART = 1.6  # runs that a method takes there, on average
# Of the error as a power of time, for what keeps the spectrum and what does not; over short times less is seen.
LEAST_GROWTH, LEAST_GROWTH_OF_OTHERS, MOST_GROWTH = 1.5, 4.0, 5.0
LOOKS = 100  # at a run of many steps, for its energy and its cost
FIRST_SHARE = 1 / 3  # of the budget, after which no further method is begun on the first part
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
    error_at_half: Optional[float] = None  # of its time, of the trajectory only
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
    lines = csv.reader(read_text(path).lstrip("\ufeff").splitlines())
    rows = [(number, [field.strip() for field in row]) for number, row in enumerate(lines, 1) if any(row)]
    if not rows or sorted(rows[0][1]) != ["im", "l", "m", "re"]:
        raise UnusableFile("the header must name l,m,re,im and no other")
    modes = []
    for number, fields in rows[1:]:
        try:
            found = dict(zip(rows[0][1], fields, strict=True))
            modes.append((int(found["l"]), int(found["m"]), float(found["re"]), float(found["im"])))
        except ValueError:
            raise UnusableFile(f"line {number}: must be 4 numbers (l,m,re,im)") from None
    return modes


def scene_of(options):
    """Returns the user's scene. Throws UnusableFile."""
    try:
        if options.modes is not None:
            scene = isosyrk.scene(modes=read_modes(options.modes), n=options.n)
        else:
            try:
                W = numpy.load(options.state, allow_pickle=False)
            except (OSError, ValueError, EOFError):
                raise UnusableFile("cannot be read as a NumPy .npy file") from None
            scene = isosyrk.scene(initial=W, n=options.n)
        if not scene.generator_norms()[0] > 0:
            raise UnusableFile("is at rest, as any method keeps it")
    except (UnusableFile, ValueError, TypeError) as problem:
        name = "--modes" if options.modes is not None else "--state"
        raise UnusableFile(f"{name} {one_line(options.modes or options.state)}: {problem}") from None
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
        """Returns the Pilot of a run of an even number of steps, with its error where there is a reference for it."""
        method = isosyrk.integrator(self.scene, name, solver=FAST, tolerance=self.tolerance)
        pilot = Pilot(name, time, steps, STOPPED, 0.0)
        self.pilots.append(pilot)
        limit, energy_errors = method.linear_limit(), [0.0]

        def look(step, W, report):
            energy_errors.append(larger(energy_errors[-1], abs(self.scene.energy(W) / self.energy - 1)))
            if 2 * step == steps:
                pilot.W_at_half = W.copy()
            return report.seconds > most_seconds

        try:
            if limit is not None and self.norm_B * pilot.step > limit:
                pilot.status = UNSTABLE
            else:
                every = next(each for each in range(max(1, steps // LOOKS), 0, -1) if steps // 2 % each == 0)
                W, report = method.run(self.scene.initial, pilot.step, steps, observe=look, every=every)
                pilot.seconds = report.seconds
                if report.steps == steps:
                    self.judge(pilot, W, energy_errors)
        except isosyrk.SolverError as failure:
            pilot.status, pilot.seconds = failure.status, failure.report.seconds
        if pilot.status not in (CONVERGED, STOPPED):
            self.failed[name] = min(pilot.step, self.failed.get(name, math.inf))
        return pilot

    def judge(self, pilot, W, energy_errors):
        """Gives a Pilot that came to its end its status and errors."""
        errors = {"spectrum_error": self.spectrum_error(W), "energy_error": energy_errors[-1],
                  "skew_defect": isosyrk.skew_defect(W) / self.largest}
        lost = invariants_lost(errors, self.entries[pilot.integrator].isospectral)
        pilot.status, pilot.W = UNSTABLE if lost else CONVERGED, W
        if not self.trajectory:
            pilot.error = max(energy_errors[-1], errors["spectrum_error"])
        elif self.reference and self.reference.time == pilot.time:
            pilot.error = isosyrk.relative_error(W, self.reference.W) + self.uncertainty
            pilot.error_at_half = isosyrk.relative_error(pilot.W_at_half, self.reference.W_at_half)

    def spectrum_error(self, W):
        return isosyrk.spectrum_error(W, self.scene.initial) / self.largest

    def refer(self, time, error):
        """Makes the reference solution of a part of the time; if two do not agree, no trajectory is judged any more.

        Throws BelowReference where they agree to less than what is asked for.
        """
        names = list(map(self.in_frame, REFERENCES))
        order = self.entries[names[1]].order
        steps, before = even(time * self.norm_B / FIRST_REFERENCE), math.inf
        if self.reference:  # of a shorter time
            grown = max(self.uncertainty, SMALLEST_ERROR) * time / self.reference.time
            finer = (2 * SHARP * grown / error) ** (1 / order)
            steps = even(time / self.reference.step * min(1.0, max(0.5, finer)))
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
        else:
            self.good.update((each.integrator, each) for each in pair
                             if each.error == self.uncertainty and each.integrator in self.candidates()
                             and each.integrator not in self.good)

    def search(self, name, time, error, most_seconds):
        """Returns the Pilot with the longest step that has an error over a part of the time; None if none has."""
        order, best = self.entries[name].order, None
        steps = (self.expected(self.good[name], time, error).steps if name in self.good else
                 even(time * self.norm_B * max(1.0, error ** (-1 / order) / FIRST_STEP)))
        for _ in range(MOST_TRIES):
            if time / steps >= self.failed.get(name, math.inf):
                if best:
                    break
                steps = even(1.3 * time / self.failed[name])
            pilot = self.run(name, steps, time, most_seconds)
            pilot.W = pilot.W_at_half = None
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

    def growth(self, pilot, time):
        """Returns how much larger the error of a pilot is expected to be over a longer time."""
        entry = self.entries[pilot.integrator]
        if not self.trajectory:
            return energy_growth(entry, pilot.time, time)
        seen = math.log2(pilot.error / pilot.error_at_half) if pilot.error_at_half else 0.0
        least = LEAST_GROWTH if entry.isospectral else LEAST_GROWTH_OF_OTHERS
        return (time / pilot.time) ** min(MOST_GROWTH, max(least, seen))

    def expected(self, pilot, time, error, longest=math.inf):
        """Returns a pilot over this time as it is; otherwise one for the error, as extrapolated from a shorter time.

        Its step is no longer than `longest`, told by h‖B(W₀)‖₂.
        """
        if pilot.time == time:
            return pilot
        order = self.entries[pilot.integrator].order
        at_time = max(pilot.error, SMALLEST_ERROR) * self.growth(pilot, time)
        steps = even(time / pilot.step * max(0.5, (at_time * AIM / error) ** (1 / order)))
        if time / steps >= self.failed.get(pilot.integrator, math.inf):
            steps = even(time / pilot.step)
        steps = max(steps, even(time * self.norm_B / longest))
        return replace(pilot, time=time, steps=steps, error=at_time * (time / steps / pilot.step) ** order,
                       seconds=pilot.seconds * steps / pilot.steps)

    def ranking(self):
        """Returns what is expected of each good integrator over the whole time; first those with the longest pilots."""
        longest = max((each.time for each in self.good.values()), default=0)
        found = [(each.time < longest, self.expected(each, self.question.time, self.question.error, MOST_UNTRIED))
                 for each in self.good.values()]
        return [each for _, each in sorted(found, key=lambda pair: (pair[0], pair[1].seconds))]

    def go_on(self, left):
        """Makes pilots over longer and longer parts of the time, until it is whole or the next part takes too long.

        `left()` returns the seconds that are left. Throws BelowReference, and OutOfTime from anywhere.
        """
        whole, names = self.question.time, self.candidates()
        time = whole / 2 ** max(0, math.floor(math.log2(whole * self.norm_B / FIRST_TIME)))
        spared = left() * (1 - FIRST_SHARE)
        while True:
            before, made = left(), len(self.pilots)
            self.try_all(names, time, lambda: not made and self.good and left() < spared)
            if time == whole:
                return
            ranked = self.ranking()
            names = [each.integrator for place, each in enumerate(ranked[:MOST_KEPT])
                     if place < LEAST_KEPT or each.seconds <= STILL_CHEAP * ranked[0].seconds] or names
            chosen = NEXT_PART * sum(self.good[name].seconds for name in names if name in self.good)
            busy = (before - left()) / sum(each.seconds for each in self.pilots[made:])  # wall time a CPU second
            fits = left() / busy / (chosen + NEXT_PART * self.reference.seconds)
            if fits < 1:
                return
            time = min(whole, time * 2 ** max(1, math.floor(math.log2(fits))))  # of twice the time, half fits at least

    def try_all(self, names, time, enough):
        """Makes the pilots of these integrators over a part of the time, or of some until `enough()`."""
        error = self.question.error * time / self.question.time  # of a trajectory: it grows at least so fast
        if self.trajectory:
            self.refer(time, error)
        error = min(self.question.error, max(error, SHARP_ENOUGH * self.uncertainty))
        cheapest = min((each.seconds for each in self.good.values() if each.time == time), default=math.inf)
        for name in names:
            if enough():
                break
            if not (self.trajectory or self.entries[name].isospectral):
                continue
            if not self.trajectory:
                error = self.question.error / energy_growth(self.entries[name], time, self.question.time)
            best = self.search(name, time, error, TOO_DEAR * cheapest)
            if best:
                self.good[name] = best
                cheapest = min(cheapest, best.seconds)
            else:
                self.good.pop(name, None)


def even(steps):
    return max(2, 2 * math.ceil(steps / 2 * (1 - 1e-9)))


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
                    f" as growing by a factor of {search.growth(best, whole):.2g}; whether the trajectory can be told so far"
                    " was not tried")
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
        return f"{what}, and none came to an end; a larger --budget may help"
    best = min(tried, key=lambda each: (-each.time, each.error))
    return (f"{what}; the best there is has {best.error:.3g}, by {best.integrator} with h = {best.step:.4g} to T ="
            f" {best.time:g}")
