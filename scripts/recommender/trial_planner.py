"""Plans the trials of a user's own scene: which steps a method is tried with, which go on, and what is offered at last.

A trial is a short run of the scene. All of this follows from the Outcomes of the trials made so far; who runs them, and
how long that takes, is no matter here. Standard library only.
"""

import itertools
import math
from dataclasses import replace

from lib.records.formats import CONVERGED
from lib.records.integrators import strongest_structure
from lib.records.settings import keeping_tolerance
from studies.accuracy.cheapest import (MAX_OFFERED, PREDICTABLE, SMALLEST_ERROR, Outcome, below_reference,
                                       beyond_predictability, energy_growth)

STOPPED = "stopped"  # status of a trial at TOO_EXPENSIVE times the cheapest good one, or at the end of the budget

FIRST_TIME, FIRST_REFERENCE = 10.0, 2.0  # T‖B(W₀)‖₂ of the first part, h‖B(W₀)‖₂ of its first reference
FIRST_STEP = 15.0  # times error^(1/order), at most 1: h‖B(W₀)‖₂ of the first trial of a method
MAX_UNTRIED = 3.5  # h‖B(W₀)‖₂ over a longer time than tried: long runs were seen to fail from 5.2 on, short ones later
AIM, ENOUGH = 1.3, 4.0  # steps are for the error over AIM; a trial more than ENOUGH times better is made coarser
MAX_TRIES = 4  # of a method on a part of the time
BELOW_FAILURE = 1.3  # a step that failed, over the longest one that is tried next
SHARP, SHARP_ENOUGH = 10, 4  # the uncertainty of the reference aims at, and has to reach, the error over that
FLOOR = 1e-6  # below, two references that no longer come closer are at rounding
TOO_EXPENSIVE = 8.0  # times the seconds of the cheapest good trial over the part, where others are stopped
MAX_KEPT = 6  # methods that go on to the next part
# Least growth of the error as a power of time, for methods that keep the spectrum and others. Short runs show too
# little. Where trajectories part, errors grow exponentially, which a power fitted to one trial does not show. So none
# is trusted that grew faster than MAX_GROWTH, and none over more than FARTHEST times the time of its trial. (A scene
# of n = 48, all of l <= 6: two references to T = 1000 part, while trials to T = 125 show a power of 2.6.)
MIN_GROWTH, MIN_GROWTH_OF_OTHERS, MAX_GROWTH, FARTHEST = 1.5, 4.0, 3.0, 2.0
MAX_DOUBLINGS = 100  # of an error, far more than is offered
# Losses that a trial does not survive. What is promised to be isospectral is held to 1e-8, far more than a tolerance of
# 1e-13 leaves in a few hundred steps; other methods, to a tenth of the largest eigenvalue of a state of norm 1. Every
# method keeps W skew-Hermitian to 1e-8 and its energy within a factor of two.
PROMISED_LOSS, SPECTRUM_LOSS, ENERGY_LOSS = 1e-8, 0.1, 1.0


def even(steps):
    """Returns the even number of steps at or above this, at least 2: trials are judged at half their time too."""
    return max(2, 2 * math.ceil(steps / 2 * (1 - 1e-9)))


def refinement(error, wanted, integrator, minimum, maximum=math.inf):
    """Returns the factor of the steps that takes an error to the wanted one, within bounds."""
    return min(maximum, max(minimum, (max(error, SMALLEST_ERROR) / wanted) ** (1 / integrator.order)))


def invariants_lost(errors, isospectral):
    """Tells whether a run has lost an invariant: `errors` is a dict of "spectrum_error", "skew_defect" and
    "energy_error", the first two over the norm of the state."""
    allowed = {"spectrum_error": PROMISED_LOSS if isospectral else SPECTRUM_LOSS, "skew_defect": PROMISED_LOSS,
               "energy_error": ENERGY_LOSS}
    return not all(errors[name] <= maximum for name, maximum in allowed.items())  # so that NaN is a loss


class Planner:
    """The trials of one scene, the best of them, and what follows from them."""

    def __init__(self, question, norm_B, candidates, limits):
        """`norm_B` is ‖B(W₀)‖₂. `limits` are the longest steps by linear theory of the candidates, by Integrator."""
        self.question, self.norm_B, self.candidates, self.limits = question, norm_B, candidates, limits
        self.trials = []
        # Whether errors are those of the trajectory; if of energy and spectrum, why.
        self.trajectory, self.why = True, ""
        self.reference, self.uncertainty = None, math.inf  # a trial, and how far it is off
        self.reference_step = FIRST_REFERENCE / norm_B  # of the next part
        self.unsettled = None  # the last two references over a part that do not agree, as one Outcome
        self.spent = False  # whether the budget ended before all trials were made
        self.untried = ()  # the candidates that it had no room for
        self.good = {}  # by integrator: the best trial over the longest part that it did
        self.end = 0.0, None  # the longest time of a trial that came to a usable end, and its last state
        self.paces = {}  # by integrator and steps of an offer: CPU seconds a step, as timed
        # Of the part that trials go over.
        self.time = question.time / 2 ** max(0, math.floor(math.log2(question.time * norm_B / FIRST_TIME)))

    # ---- trials

    def tolerance_of(self, integrator):
        """Returns the tolerance of runs: that which keeps all that a method keeps, where the Lie–Poisson structure
        or energies over long times are asked for; else that which keeps the spectrum."""
        all_is_kept = self.question.keep == "poisson" or not self.trajectory
        return keeping_tolerance(integrator, strongest_structure(integrator) if all_is_kept else "spectrum")

    def outcome(self, integrator, time, steps, error, seconds, status="expected"):
        """Returns the Outcome of a run at the tolerance of now."""
        return Outcome(integrator, self.question.n, time, steps, error, seconds, self.tolerance_of(integrator), status)

    def longest_step(self, integrator):
        """Returns the longest step that may work, by linear theory and by the trials that failed."""
        failed = [each.step for each in self.trials
                  if each.integrator == integrator and each.status not in (CONVERGED, STOPPED)]
        return min(self.limits[integrator], min(failed, default=math.inf) / BELOW_FAILURE)

    # ---- the part that trials go over

    def lengthen(self, fits):
        """Takes a longer part of the time: at least twice it, if the budget has room for `fits` such parts.

        Of a part that is not finished, the cheapest methods are.
        """
        self.time = min(self.question.time, self.time * 2 ** max(1, math.floor(math.log2(fits))))

    def proportional_error(self):
        """Returns the error that a trajectory may have over the part if it grows in proportion to time."""
        return self.question.error * (self.time / self.question.time)

    def error_over_part(self, integrator):
        """Returns the error that a trial may have over the part; 0 where none can be extrapolated.

        That of a trajectory grows at least in proportion to time.
        """
        if not self.trajectory:
            return self.error_of_energy(integrator, self.time)
        return min(self.question.error, max(self.proportional_error(), SHARP_ENOUGH * self.uncertainty))

    def refinements(self, error, second):
        """Yields the steps of pairs of reference solutions, until two agree or at rounding no longer come closer.

        Each time it is to be sent (pair, found): the trials, and their distance or None if one did not come to a usable
        end. `second` is the Integrator of the second. At the end the reference is chosen. Throws Stop where rounding
        keeps them from agreeing to what is asked for.
        """
        before, steps = math.inf, even(self.time / self.reference_step)
        for tries in itertools.count(1):
            pair, found = yield steps
            if found is None:
                steps = even(1.5 * steps)
                continue
            if found <= error / SHARP or (found > before / 2 and (before < FLOOR or tries > MAX_TRIES)):
                break
            before = found
            self.unsettled = replace(pair[1], error=found)
            steps = even(steps * refinement(2 * SHARP * found, error, second, 1.2, 3.0))
        self.reference_step = self.time / steps / refinement(2 * SHARP * found, error, second, 0.5, 1.0)
        self.choose_reference(pair, found)

    def choose_reference(self, pair, found):
        """Takes the first of two reference solutions with this distance; if it is large, judges no trajectory any more.

        Throws Stop where it is larger than the error that is asked for.
        """
        for each in pair:
            each.error = found
        self.reference, self.uncertainty, self.unsettled = pair[0], found, None
        if found > PREDICTABLE or found > max(FLOOR, self.question.error):
            self.trajectory, self.good = False, {}
            self.why = f"two reference solutions differ by {found:.2g}"
        elif found > self.question.error:
            raise below_reference(self.question.error, found, self.time)
        for each in pair if self.trajectory else ():
            if each.integrator in self.candidates:
                self.good.setdefault(each.integrator, each)

    def tries(self, integrator, error, max_seconds):
        """Yields the steps of trials of an integrator over the part, and is to be sent each of these trials.

        Returns the cheapest that has the error, None if none has. One that would take longer than `most_seconds` is not
        tried.
        """
        if integrator in self.good:
            steps = self.expected(self.good[integrator], self.time, error, cautious=False).steps
        else:
            steps = even(self.time * self.norm_B * max(1.0, error ** (-1 / integrator.order) / FIRST_STEP))
        best, wanted = None, steps
        for _ in range(MAX_TRIES):
            steps = max(wanted, even(self.time / self.longest_step(integrator)))
            trial = yield steps
            if trial.status == STOPPED or (best and trial.status != CONVERGED):
                break
            if trial.status != CONVERGED:
                continue
            if trial.error <= error and (best is None or trial.seconds < best.seconds):
                best = trial
            wanted = even(steps * refinement(trial.error * AIM, error, integrator, 0.25, 4.0))
            enough = error / ENOUGH < trial.error <= error
            if enough or wanted == steps or trial.seconds * wanted / steps > max_seconds:
                break
        return best

    # ---- what is expected over a longer time

    def growth(self, trial, time, cautious=True):
        """Returns how much larger the error of a trial is expected to be over a longer time.

        If cautious: as the power of time or the exponential that the two halves of the trial show, whichever grows
        more.
        """
        if not self.trajectory:
            return energy_growth(trial.integrator, trial.time, time)
        seen = max(1.0, trial.growth or 0.0)
        if not cautious:
            return (time / trial.time) ** min(seen, MAX_GROWTH)
        minimum = MIN_GROWTH if trial.integrator.isospectral else MIN_GROWTH_OF_OTHERS
        ratio = time / trial.time
        return 2 ** min(MAX_DOUBLINGS, max(max(minimum, seen) * math.log2(ratio), 2 * seen * (ratio - 1)))

    def expected(self, trial, time, error, cautious=True):
        """Returns a trial over this time as it is; from one over a shorter time, the Outcome with the error."""
        if trial.time == time:
            return trial
        at_time = max(trial.error, SMALLEST_ERROR) * self.growth(trial, time, cautious)
        steps = even(time / trial.step * refinement(at_time * AIM, error, trial.integrator, 0.5))
        longest = min(MAX_UNTRIED / self.norm_B, self.longest_step(trial.integrator))
        steps = max(steps, even(time / longest))
        pace = self.paces.get((trial.integrator, steps), trial.seconds / trial.steps)
        return self.outcome(trial.integrator, time, steps,
                            at_time * (time / steps / trial.step) ** trial.integrator.order, pace * steps)

    def ranking(self):
        """Returns the expected run of each good integrator over the whole time, the cheapest first."""
        found = [(each, replace(self.expected(each, self.question.time, self.question.error), evidence=self.trials))
                 for each in self.good.values()]
        return [offer for trial, offer in sorted(found, key=lambda pair: (-pair[0].time, pair[1].seconds))
                if not self.is_refuted(offer, trial)]

    def is_timed(self, offer):
        return offer.status == CONVERGED or (offer.integrator, offer.steps) in self.paces

    def is_refuted(self, offer, trial):
        """Tells whether an offer cannot follow from a trial over a shorter time: that is too short, its error grew too
        fast, or references over a longer time disagree by more than the error, with steps no longer than those
        offered."""
        tried = self.unsettled
        return self.trajectory and trial.time < offer.time and (
            offer.time > FARTHEST * trial.time or (trial.growth or 0.0) > MAX_GROWTH
            or (tried is not None and tried.time > trial.time and tried.step <= offer.step
                and tried.error > self.question.error))

    def without_a_trial(self):
        """Returns the candidates that could be judged, and of which no trial was made."""
        tried = {each.integrator for each in self.trials}
        return [each for each in self.candidates if each not in tried and self.error_over_part(each)]

    def most_promising(self):
        """Returns the integrators that go on to a longer part: those that seem cheapest over the whole time."""
        found = [self.expected(each, self.question.time, self.question.error, cautious=False)
                 for each in self.good.values()]
        return [each.integrator for each in sorted(found, key=lambda each: each.seconds)[:MAX_KEPT]]

    def settle(self):
        """Judges energy and spectrum if nothing can be offered so far, by each integrator's longest trial."""
        if self.ranking():
            return
        finished = [each for each in self.trials if each.status == CONVERGED and each.kept is not None]
        if not finished:
            return
        if self.trajectory:
            shown = max((each.time for each in finished if each.error is not None), default=0)
            self.why = (f"what trials show of trajectories: they end at T = {shown:g}, and errors that grow fast, or"
                        f" over more than {FARTHEST:g} times that, are not extrapolated")
        self.trajectory, self.good = False, {}
        for integrator in self.candidates:
            own = [each for each in finished if each.integrator == integrator
                   and each.tolerance <= self.tolerance_of(integrator)]
            longest = max((each.time for each in own), default=None)
            error = longest and self.error_of_energy(integrator, longest)
            good = [replace(each, error=each.kept) for each in own
                    if error and each.time == longest and each.kept <= error]
            if good:
                self.good[integrator] = min(good, key=lambda each: each.seconds)

    def error_of_energy(self, integrator, time):
        """Returns the error of energy and spectrum that a trial may have; 0 where that cannot be extrapolated."""
        growth = energy_growth(integrator, time, self.question.time)
        return self.question.error / growth if integrator.isospectral else 0.0

    def nearest(self):
        """Returns the trial with the smallest error over the longest part; None if no candidate has an error."""
        tried = [each for each in self.trials if each.error is not None and each.integrator in self.candidates]
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
        offers = self.ranking()[:MAX_OFFERED]
        best = self.good[offers[0].integrator]
        if best.time < whole:
            said.append(f"the trials of the answer end at T = {best.time:g}: its error is extrapolated, as growing by a"
                        f" factor of {self.growth(best, whole):.2g}")
            if self.is_timed(offers[0]):
                said.append("the seconds of the answer follow from some of its steps, timed from T ="
                            f" {self.end[0]:g} on")
        untimed = [each.integrator.name for each in offers if not self.is_timed(each)]
        if untimed:
            said.append(f"the budget was spent before steps of {', '.join(untimed)} were timed: these seconds are"
                        " scaled from trials with another step")
        if self.untried:
            said.append(f"the budget had no room for {len(self.untried)} of {len(self.candidates)} methods, which may"
                        " be cheaper; --budget gives more")
        if self.spent:
            said.append("the budget was spent before all trials were made")
        return said
