"""Finds the cheapest method and step for a user's own scene by runs of that scene, called pilots, within a budget.

Pilots go over a part T/2^k of the time first, where the dear methods drop out; then over the longest part that the
budget allows, at best all of it. The reference solution of each part is the first of two integrators that are refined
together until they agree; their distance is its uncertainty. Fast forms only, in the co-rotating frame where the list
has it: that is exact and costs nothing. At last some steps of each offer that follows from a shorter pilot are timed
from where the longest pilot ended: a step of another size takes another time. Needs NumPy and isosyrk.
"""

import itertools
import math
import signal
from argparse import ArgumentTypeError
from dataclasses import replace

import isosyrk
import numpy
from lib import study
from lib.accuracy_lines import keeping_tolerance
from lib.formats import CONVERGED, FAST, UNSTABLE, read_text
from lib.messages import UnusableFile, one_line
from lib.command_line import number, whole_number
from lib.integrator_names import FRAME
from lib.recommendation import (MOST_OFFERED, PREDICTABLE, SMALLEST_ERROR, Outcome, Question, answer_data,
                            below_reference, beyond_predictability, energy_growth)
from lib.trials import Setting, invariants_lost

REFERENCES = ("group6", "group5")
CANDIDATES = ("rk4", "magnus5", "elp4", "elp6", "rk4_projected", "group3", "group4", "rkmk4", "group5", "group2",
              "group6", "kahan_li6", "yoshida4", "direct2", "group1")
STOPPED = "stopped"  # status of a pilot at TOO_DEAR times the cheapest good one, or at the end of the budget

FIRST_TIME, FIRST_REFERENCE = 10.0, 2.0  # T‖B(W₀)‖₂ of the first part, h‖B(W₀)‖₂ of its first reference
FIRST_STEP = 15.0  # times error^(1/order), at most 1: h‖B(W₀)‖₂ of the first pilot of a method
MOST_UNTRIED = 3.5  # h‖B(W₀)‖₂ over a longer time than tried: long runs were seen to fail from 5.2 on, short ones later
AIM, ENOUGH = 1.3, 4.0  # steps are for the error over AIM; a pilot more than ENOUGH times better is made coarser
MOST_TRIES = 4  # of a method on a part of the time
BELOW_FAILURE = 1.3  # a step that failed, over the longest one that is tried next
SHARP, SHARP_ENOUGH = 10, 4  # the uncertainty of the reference aims at, and has to reach, the error over that
FLOOR = 1e-6  # below, two references that no longer come closer are at rounding
TOO_DEAR = 8.0  # times the seconds of the cheapest good pilot over the part, where others are stopped
MOST_KEPT = 6  # methods that go on to the next part
# Least growth of the error as a power of time, for methods that keep the spectrum and others. Short runs show too
# little. Where trajectories part, errors grow exponentially, which a power fitted to one pilot does not show. So none
# is trusted that grew faster than MOST_GROWTH, and none over more than FARTHEST times the time of its pilot. (A scene
# of n = 48, all of l <= 6: two references to T = 1000 part, while pilots to T = 125 show a power of 2.6.)
LEAST_GROWTH, LEAST_GROWTH_OF_OTHERS, MOST_GROWTH, FARTHEST = 1.5, 4.0, 3.0, 2.0
MOST_DOUBLINGS = 100  # of an error, far more than is offered
LOOKS = 100  # at the energy and the cost of a pilot of many steps
FIRST_SHARE = 1 / 3  # of the budget; after it, no further method is begun on the first part
# Of the budget, kept for timing steps of the offers; the steps and the CPU seconds that are timed of one at least. As
# many steps before them are not timed, for a predictor has no past steps yet. Costs change while a scene develops, so
# more are timed where there is room: SHARE_TIMED of what is left, as the clock of the budget goes on while others run.
RESERVE, LEAST_STEPS, LEAST_SECONDS, SHARE_TIMED = 0.1, 10, 0.02, 0.25


# ---- the user's scene

WHOLE, REAL = whole_number(0, 10**9), number(-math.inf, math.inf)
FIELDS = {"l": WHOLE, "m": WHOLE, "re": REAL, "im": REAL}  # of a mode, with their readers
LEAST_ENERGY = 1e-200
AT_REST = 1e-12  # ‖B(W)‖₂ over the largest entry of W: rounding of a state that does not move


def read_modes(path):
    """Returns the modes in a CSV file with the header l,m,re,im. Throws UnusableFile."""
    header, *lines = [[field.strip() for field in line.split(",")]
                      for line in read_text(path).lstrip("\ufeff").splitlines() or [""]]
    if sorted(header) != sorted(FIELDS):
        raise UnusableFile("the header must name l,m,re,im and no other")
    modes = []
    for place, fields in enumerate(lines, 2):
        if fields == [""]:
            continue
        try:
            row = dict(zip(header, fields, strict=True))
            modes.append(tuple(read(row[name]) for name, read in FIELDS.items()))
        except (ValueError, ArgumentTypeError):
            raise UnusableFile(f"line {place}: must be 4 numbers (l,m,re,im)") from None
    return modes


def read_state(path):
    """Returns the matrix in a NumPy file, as the program `integrate` writes and reads it. Throws UnusableFile."""
    try:
        W = numpy.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError, MemoryError):
        raise UnusableFile("cannot be read as a NumPy .npy file") from None
    if W.dtype != complex or not W.dtype.isnative or not W.flags.c_contiguous:
        raise UnusableFile("must be complex128 in C order")
    return W


def scene_of(options):
    """Returns the user's scene. Throws UnusableFile."""
    try:
        data = {"initial": read_state(options.own)} if options.modes is None else {"modes": read_modes(options.own)}
        scene = isosyrk.scene(n=options.n, hbar=options.hbar, **data)
        if not scene.generator_norms()[0] > AT_REST * abs(scene.initial).max():
            raise UnusableFile("is at rest, as any method keeps it")
        if not LEAST_ENERGY < scene.energy(scene.initial) < 1 / LEAST_ENERGY:
            raise UnusableFile("its energy is too small or too large to be compared with; scale it")
    except (UnusableFile, ValueError, TypeError) as problem:
        name = "--state" if options.modes is None else "--modes"
        raise UnusableFile(f"{name} {one_line(options.own)}: {problem}") from None
    return scene


def even(steps):
    """Returns the even number of steps at or above this, at least 2: pilots are judged at half their time too."""
    return max(2, 2 * math.ceil(steps / 2 * (1 - 1e-9)))


def refinement(error, wanted, integrator, least, most=math.inf):
    """Returns the factor of the steps that takes an error to the wanted one, within bounds."""
    return min(most, max(least, (max(error, SMALLEST_ERROR) / wanted) ** (1 / integrator.order)))


# ---- pilots


def seconds_left():
    """Returns what is left of the budget, 0 after its end, when SIGALRM comes."""
    return signal.getitimer(signal.ITIMER_REAL)[0]


class Search:
    """The pilots of one scene and the best of them. At the end of the budget, any method may throw TimeoutError."""

    def __init__(self, scene, question):
        self.setting, self.question = Setting(scene), question
        self.size = float(numpy.linalg.norm(scene.initial, 2))
        listed = {each.name: study.record_of(each) for each in isosyrk.integrators()}
        self.references, candidates = ([listed.get(name + FRAME, listed[name]) for name in names]
                                       for names in (REFERENCES, CANDIDATES))
        self.candidates = [each for each in candidates if each.keeps(question.keep)]
        self.limits = {each: (self.method(each).linear_limit() or math.inf) / self.setting.norm_B
                       for each in self.candidates}
        self.pilots = []
        # Whether errors are those of the trajectory; if of energy and spectrum, why.
        self.trajectory, self.why = True, ""
        # A pilot, its states at half time and at the end, and how far it is off.
        self.reference, self.exact, self.uncertainty = None, (), math.inf
        self.reference_step = FIRST_REFERENCE / self.setting.norm_B  # of the next part
        self.unsettled = None  # the last two references over a part that do not agree, as one Outcome
        self.spent = False  # whether the budget ended before all pilots were made
        self.good = {}  # by integrator: the best pilot over the longest part that it did
        self.end = 0.0, scene.initial  # the longest time of a pilot that came to a usable end, and its last state
        self.paces = {}  # by integrator and steps of an offer: CPU seconds a step, as timed
        # Of the part that pilots go over.
        self.time = question.time / 2 ** max(0, math.floor(math.log2(question.time * self.setting.norm_B / FIRST_TIME)))

    def method(self, integrator):
        """Returns the module's integrator of the scene."""
        return isosyrk.integrator(self.setting.scene, integrator.name, solver=FAST,
                                  tolerance=keeping_tolerance(integrator.name))

    def outcome(self, integrator, time, steps, error, seconds, status="expected"):
        return Outcome(integrator, self.setting.scene.n, time, steps, error, seconds,
                       keeping_tolerance(integrator.name), status)

    def longest_step(self, integrator):
        """Returns the longest step that may work, by linear theory and by the pilots that failed."""
        failed = [each.step for each in self.pilots
                  if each.integrator == integrator and each.status not in (CONVERGED, STOPPED)]
        return min(self.limits[integrator], min(failed, default=math.inf) / BELOW_FAILURE)

    def run(self, integrator, steps, most_seconds=math.inf):
        """Returns the pilot of an even number of steps over the part, and its states at half time and at the end.

        The pilot has an error if there is a reference. There are no states if it did not come to a usable end.
        """
        pilot = self.outcome(integrator, self.time, steps, None, 0.0, STOPPED)
        self.pilots.append(pilot)
        states = []

        def look(step, W, report):
            if step in (steps // 2, steps):
                states.append(W.copy())
            return report.seconds > most_seconds

        every = next(each for each in range(max(1, steps // LOOKS), 0, -1) if steps // 2 % each == 0)
        W, report, status, _, energy_error = self.setting.run(self.method(integrator), pilot.step, steps, every, look)
        pilot.seconds = report.seconds
        if status != CONVERGED or report.steps < steps:
            pilot.status = STOPPED if status == CONVERGED else status
            return pilot, ()
        errors = {name: error / self.size for name, error in self.setting.errors(W).items()}
        errors["energy_error"] = energy_error
        pilot.kept = max(energy_error, errors["spectrum_error"]) if integrator.isospectral else None
        if invariants_lost(errors, integrator.isospectral):
            pilot.status = UNSTABLE
            return pilot, ()
        pilot.status = CONVERGED
        if self.time > self.end[0]:
            self.end = self.time, W
        if not self.trajectory:
            pilot.error = pilot.kept
        elif self.reference and self.reference.time == self.time:
            at_half, error = map(isosyrk.relative_error, states, self.exact)
            pilot.error = error + self.uncertainty
            pilot.growth = math.log2(error / at_half) if error > 0 < at_half else None
        return pilot, states

    def refer(self, error):
        """Makes the reference solution of the part; if two do not agree, no trajectory is judged any more.

        Throws Stop where rounding keeps them from agreeing to what is asked for.
        """
        second, before = self.references[1], math.inf
        steps = even(self.time / self.reference_step)
        for tries in itertools.count(1):
            pair, states = zip(*(self.run(each, steps) for each in self.references))
            if not all(states):
                steps = even(1.5 * steps)
                continue
            found = isosyrk.relative_error(states[1][1], states[0][1])
            if found <= error / SHARP or (found > before / 2 and (before < FLOOR or tries > MOST_TRIES)):
                break
            before = found
            self.unsettled = replace(pair[1], error=found)
            steps = even(steps * refinement(2 * SHARP * found, error, second, 1.2, 3.0))
        for each in pair:
            each.error = found
        self.reference, self.exact, self.uncertainty, self.unsettled = pair[0], states[0], found, None
        self.reference_step = self.time / steps / refinement(2 * SHARP * found, error, second, 0.5, 1.0)
        if self.uncertainty > PREDICTABLE or self.uncertainty > max(FLOOR, self.question.error):
            self.trajectory, self.good = False, {}
            self.why = f"two reference solutions differ by {self.uncertainty:.2g}"
        elif self.uncertainty > self.question.error:
            raise below_reference(self.question.error, self.uncertainty, self.time)
        for each in pair if self.trajectory else ():
            if each.integrator in self.candidates:
                self.good.setdefault(each.integrator, each)

    def search(self, integrator, error, most_seconds):
        """Returns the pilot with the longest step that has an error over the part; None if none has."""
        if integrator in self.good:
            steps = self.expected(self.good[integrator], self.time, error, cautious=False).steps
        else:
            steps = even(self.time * self.setting.norm_B * max(1.0, error ** (-1 / integrator.order) / FIRST_STEP))
        best, wanted = None, steps
        for _ in range(MOST_TRIES):
            steps = max(wanted, even(self.time / self.longest_step(integrator)))
            pilot, _ = self.run(integrator, steps, most_seconds)
            if pilot.status == STOPPED or (best and pilot.status != CONVERGED):
                break
            if pilot.status != CONVERGED:
                continue
            if pilot.error <= error and (best is None or pilot.seconds < best.seconds):
                best = pilot
            wanted = even(steps * refinement(pilot.error * AIM, error, integrator, 0.25, 4.0))
            enough = error / ENOUGH < pilot.error <= error
            if enough or wanted == steps or pilot.seconds * wanted / steps > most_seconds:
                break
        return best

    def growth(self, pilot, time, cautious=True):
        """Returns how much larger the error of a pilot is expected to be over a longer time.

        If cautious: as the power of time or the exponential that the two halves of the pilot show, whichever grows
        more.
        """
        if not self.trajectory:
            return energy_growth(pilot.integrator, pilot.time, time)
        seen = max(1.0, pilot.growth or 0.0)
        if not cautious:
            return (time / pilot.time) ** min(seen, MOST_GROWTH)
        least = LEAST_GROWTH if pilot.integrator.isospectral else LEAST_GROWTH_OF_OTHERS
        ratio = time / pilot.time
        return 2 ** min(MOST_DOUBLINGS, max(max(least, seen) * math.log2(ratio), 2 * seen * (ratio - 1)))

    def expected(self, pilot, time, error, cautious=True):
        """Returns a pilot over this time as it is; from one over a shorter time, the Outcome with the error."""
        if pilot.time == time:
            return pilot
        at_time = max(pilot.error, SMALLEST_ERROR) * self.growth(pilot, time, cautious)
        steps = even(time / pilot.step * refinement(at_time * AIM, error, pilot.integrator, 0.5))
        longest = min(MOST_UNTRIED / self.setting.norm_B, self.longest_step(pilot.integrator))
        steps = max(steps, even(time / longest))
        pace = self.paces.get((pilot.integrator, steps), pilot.seconds / pilot.steps)
        return self.outcome(pilot.integrator, time, steps,
                            at_time * (time / steps / pilot.step) ** pilot.integrator.order, pace * steps)

    def ranking(self):
        """Returns the expected run of each good integrator over the whole time, the cheapest first."""
        found = [(each, replace(self.expected(each, self.question.time, self.question.error), evidence=self.pilots))
                 for each in self.good.values()]
        return [offer for pilot, offer in sorted(found, key=lambda pair: (-pair[0].time, pair[1].seconds))
                if not self.is_refuted(offer, pilot)]

    def time_offers(self):
        """Times steps of each offer that is shown and was not run; one whose steps fail is offered no more as it is."""
        while untimed := [each for each in self.ranking()[:MOST_OFFERED] if not self.is_timed(each)]:
            self.time_steps(untimed[0], seconds_left() / len(untimed))

    def is_timed(self, offer):
        return offer.status == CONVERGED or (offer.integrator, offer.steps) in self.paces

    def time_steps(self, offer, seconds):
        """Times steps of an offer from the end of the longest pilot on, in about so many seconds at most.

        A failure counts as a pilot.
        """
        (begin, W), h, method = self.end, offer.step, self.method(offer.integrator)
        try:
            (first,) = method.timed_run(W, h, LEAST_STEPS, repetitions=1, warmup=LEAST_STEPS)
            pace = max(first / LEAST_STEPS, 1e-9)
            room = min(seconds * SHARE_TIMED / pace, (offer.time - begin) / h)
            steps = math.ceil(max(LEAST_STEPS, LEAST_SECONDS / pace, room))
            (taken,) = method.timed_run(W, h, steps, repetitions=1, warmup=LEAST_STEPS)
        except isosyrk.SolverError as problem:
            self.pilots.append(self.outcome(offer.integrator, LEAST_STEPS * h, LEAST_STEPS, None, 0.0, problem.status))
        else:
            self.paces[offer.integrator, offer.steps] = taken / steps

    def is_refuted(self, offer, pilot):
        """Tells whether an offer cannot follow from a pilot over a shorter time: that is too short, its error grew too
        fast, or references over a longer time disagree by more than the error, with steps no longer than those
        offered."""
        tried = self.unsettled
        return self.trajectory and pilot.time < offer.time and (
            offer.time > FARTHEST * pilot.time or (pilot.growth or 0.0) > MOST_GROWTH
            or (tried is not None and tried.time > pilot.time and tried.step <= offer.step
                and tried.error > self.question.error))

    def most_promising(self):
        """Returns the integrators that go on to a longer part: those that seem cheapest over the whole time."""
        found = [self.expected(each, self.question.time, self.question.error, cautious=False)
                 for each in self.good.values()]
        return [each.integrator for each in sorted(found, key=lambda each: each.seconds)[:MOST_KEPT]]

    def settle(self):
        """Judges energy and spectrum if nothing can be offered so far, by each integrator's longest pilot."""
        if self.ranking():
            return
        finished = [each for each in self.pilots if each.status == CONVERGED and each.kept is not None]
        if not finished:
            return
        if self.trajectory:
            shown = max((each.time for each in finished if each.error is not None), default=0)
            self.why = (f"what pilots show of trajectories: they end at T = {shown:g}, and errors that grow fast, or"
                        f" over more than {FARTHEST:g} times that, are not extrapolated")
        self.trajectory, self.good = False, {}
        for integrator in self.candidates:
            longest = max((each.time for each in finished if each.integrator == integrator), default=None)
            error = longest and self.error_of_energy(integrator, longest)
            good = [replace(each, error=each.kept) for each in finished
                    if error and each.integrator == integrator and each.time == longest and each.kept <= error]
            if good:
                self.good[integrator] = min(good, key=lambda each: each.seconds)

    def error_of_energy(self, integrator, time):
        """Returns the error of energy and spectrum that a pilot may have; 0 where that cannot be extrapolated."""
        growth = energy_growth(integrator, time, self.question.time)
        return self.question.error / growth if integrator.isospectral else 0.0

    def nearest(self):
        """Returns the pilot with the smallest error over the longest part; None if no candidate has an error."""
        tried = [each for each in self.pilots if each.error is not None and each.integrator in self.candidates]
        return min(tried, key=lambda each: (-each.time, each.error), default=None)

    @property
    def statements(self):
        """Says what stands behind the answer."""
        said, whole, reference = [], self.question.time, self.reference
        if reference:
            said.append(f"reference solution: {reference.integrator.name} with {reference.steps} steps to T ="
                        f" {reference.time:g}, with an uncertainty of {self.uncertainty:.2g}")
        if not self.trajectory:
            said += beyond_predictability(whole, self.why)
        offers = self.ranking()[:MOST_OFFERED]
        best = self.good[offers[0].integrator]
        if best.time < whole:
            said.append(f"the pilots of the answer end at T = {best.time:g}: its error is extrapolated, as growing by a"
                        f" factor of {self.growth(best, whole):.2g}")
            if self.is_timed(offers[0]):
                said.append("the seconds of the answer follow from some of its steps, timed from T ="
                            f" {self.end[0]:g} on")
        untimed = [each.integrator.name for each in offers if not self.is_timed(each)]
        if untimed:
            said.append(f"the budget was spent before steps of {', '.join(untimed)} were timed: these seconds are"
                        " scaled from pilots with another step")
        if self.spent:
            said.append("the budget was spent before all pilots were made")
        return said

    def go_on(self):
        """Makes pilots over longer and longer parts of the time, until it is whole or the next part takes too long."""
        integrators, spared = self.candidates, seconds_left() * (1 - FIRST_SHARE)
        while True:
            before = seconds_left()
            self.try_all(integrators, spared)
            fits = seconds_left() / (before - seconds_left())  # how often the budget has room for such a part
            if self.time == self.question.time or fits < 1:
                return
            integrators, spared = self.most_promising() or integrators, 0.0
            # At least twice the time: of a part that is not finished, the cheapest methods are.
            self.time = min(self.question.time, self.time * 2 ** max(1, math.floor(math.log2(fits))))

    def try_all(self, integrators, spared):
        """Makes the pilots of integrators over the part; if one is good, none is begun in the last `spared` seconds."""
        share = self.time / self.question.time
        if self.trajectory:
            self.refer(self.question.error * share)
        cheapest = min((each.seconds for each in self.good.values() if each.time == self.time), default=math.inf)
        for each in integrators:
            if self.good and seconds_left() < spared:
                break
            if self.trajectory:  # whose error grows at least in proportion to time
                error = min(self.question.error, max(self.question.error * share, SHARP_ENOUGH * self.uncertainty))
            else:
                error = self.error_of_energy(each, self.time)
            if not error:
                continue
            best = self.search(each, error, TOO_DEAR * cheapest)
            self.good.pop(each, None)
            if best:
                self.good[each] = best
                cheapest = min(cheapest, best.seconds)


# ---- the answer


def stop(*_):
    raise TimeoutError


def within(seconds, work):
    """Does a piece of work for at most so many seconds, and tells whether it was finished."""
    try:
        signal.setitimer(signal.ITIMER_REAL, max(0.0, seconds))
        signal.signal(signal.SIGALRM, stop)
        if not seconds_left():
            raise TimeoutError
        work()
        return True
    except TimeoutError:
        return False
    finally:
        signal.signal(signal.SIGALRM, signal.SIG_IGN)


def answer(options):
    """Returns the answer for the user's scene as answer_data() does; throws UnusableFile too. The clock is running."""
    scene = scene_of(options)
    search = Search(scene, Question(one_line(options.own), scene.n, options.time, options.error, options.keep))
    reserve = RESERVE * seconds_left()
    search.spent = not within(seconds_left() - reserve, search.go_on)
    search.settle()
    within(reserve, search.time_offers)
    arguments = ["--initial" if options.modes is None else "--modes", options.own]
    if options.hbar == "standard":
        arguments += ["--hbar", options.hbar]
    return answer_data(search, " within the budget" if search.spent else "", arguments,
                       {"measured": f"here, {len(search.pilots)} pilots"})
