"""Finds the cheapest method and step for a scene by runs of it, called trials, within a budget: for a user's own scene,
and for a named one at an n that is not recorded.

Trials go over a part T/2^k of the time first, where the expensive methods drop out; then over the longest part that the
budget allows, at best all of it. The reference solution of each part is the first of two integrators that are refined
together until they agree; their distance is its uncertainty. Fast forms only, in the co-rotating frame where the list
has it: that is exact and costs nothing. At last some steps of each offer that follows from a shorter trial are timed
from where the longest trial ended: a step of another size takes another time. Needs NumPy and isosyrk.
"""

import math
import signal
from argparse import ArgumentTypeError

import isosyrk
import numpy

from lib.programs.command_line import number, whole_number
from lib.programs.messages import UnusableFile, one_line
from lib.pages.integrate_line import Start
from lib.records.formats import CONVERGED, FAST, UNSTABLE, read_text
from lib.records.settings import TIGHT
from lib.running import built
from lib.running.trials import Setting
from studies.accuracy.cheapest import MAX_OFFERED, Question, answer_data
from recommender.trial_planner import STOPPED, TOO_EXPENSIVE, Planner, invariants_lost

REFERENCES = ("group6_frame", "group5_frame")
MIDDLE_ORDER = 6  # methods of about this order win at the errors that are asked for most

LOOKS = 100  # at the energy and the cost of a trial of many steps
FIRST_SHARE = 1 / 3  # of the budget; after it, no further method is begun on the first part, if that is not the whole
# Of the budget, kept for timing steps of the offers; the steps and the CPU seconds that are timed of one at least. As
# many steps before them are not timed, for a predictor has no past steps yet. Costs change while a scene develops, so
# more are timed where there is room: SHARE_TIMED of what is left, as the clock of the budget goes on while others run.
RESERVE, MIN_STEPS, MIN_SECONDS, SHARE_TIMED = 0.1, 10, 0.02, 0.25


# ---- the user's scene

WHOLE, REAL = whole_number(0, 10**9), number(-math.inf, math.inf)
FIELDS = {"l": WHOLE, "m": WHOLE, "re": REAL, "im": REAL}  # of a mode, with their readers
MIN_ENERGY = 1e-200
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
    """Returns the scene to run. Throws UnusableFile."""
    option, value = given(options)
    try:
        data = ({"initial": read_state(value)} if option == "--state" else
                {"modes": read_modes(value)} if option == "--modes" else {"name": value})
        scene = isosyrk.scene(n=options.n, hbar=options.hbar, **data)
        if not scene.generator_norms()[0] > AT_REST * abs(scene.initial).max():
            raise UnusableFile("is at rest, as any method keeps it")
        if not MIN_ENERGY < scene.energy(scene.initial) < 1 / MIN_ENERGY:
            raise UnusableFile("its energy is too small or too large to be compared with; scale it")
    except (UnusableFile, ValueError, TypeError) as problem:
        raise UnusableFile(f"{option} {one_line(value)}: {problem}") from None
    return scene


def given(options):
    """Returns the option that says which scene to run, and its value."""
    return next((f"--{name}", value) for name in ("state", "modes", "scene")
                if (value := getattr(options, name)) is not None)


# ---- trials


def seconds_left():
    """Returns what is left of the budget, 0 after its end, when SIGALRM comes."""
    return signal.getitimer(signal.ITIMER_REAL)[0]


def candidates_for(structure):
    """Returns all Integrators in the co-rotating frame that have a fast form and keep a structure, the first to try
    first: explicit ones, of MIDDLE_ORDER or near it."""
    listed = built.integrators().values()
    return sorted((each for each in listed if each.has_fast_form and each.co_rotating and each.keeps(structure)),
                  key=lambda each: (not each.explicit, abs(each.order - MIDDLE_ORDER)))


class Search(Planner):
    """Runs the trials of one scene as they are planned, and times steps of the offers.

    At the end of the budget, any method may throw TimeoutError.
    """

    def __init__(self, scene, question):
        self.setting = Setting(scene)
        self.size = float(numpy.linalg.norm(scene.initial, 2))
        self.references = built.entries(REFERENCES)
        candidates = candidates_for(question.keep)
        limits = {each: (self.method(each, TIGHT).linear_limit() or math.inf) / self.setting.norm_B
                  for each in candidates}
        super().__init__(question, self.setting.norm_B, candidates, limits)
        self.end = 0.0, scene.initial
        self.exact = ()  # the states of the reference at half time and at the end

    def method(self, integrator, tolerance=None):
        """Returns the module's integrator of the scene, at the tolerance of now unless another is given."""
        return isosyrk.integrator(self.setting.scene, integrator.name, solver=FAST,
                                  tolerance=tolerance or self.tolerance_of(integrator))

    def run(self, integrator, steps, max_seconds=math.inf):
        """Returns the trial of an even number of steps over the part, and its states at half time and at the end.

        The trial has an error if there is a reference. There are no states if it did not come to a usable end.
        """
        trial = self.outcome(integrator, self.time, steps, None, 0.0, STOPPED)
        self.trials.append(trial)
        states = []

        def look(step, W, report):
            if step in (steps // 2, steps):
                states.append(W.copy())
            return report.seconds > max_seconds

        every = next(each for each in range(max(1, steps // LOOKS), 0, -1) if steps // 2 % each == 0)
        W, report, status, _, energy_error = self.setting.run(self.method(integrator), trial.step, steps, every, look)
        trial.seconds = report.seconds
        if status != CONVERGED or report.steps < steps:
            trial.status = STOPPED if status == CONVERGED else status
            return trial, ()
        errors = {name: error / self.size for name, error in self.setting.errors(W).items()}
        errors["energy_error"] = energy_error
        trial.kept = max(energy_error, errors["spectrum_error"]) if integrator.isospectral else None
        if invariants_lost(errors, integrator.isospectral):
            trial.status = UNSTABLE
            return trial, ()
        trial.status = CONVERGED
        if self.time > self.end[0]:
            self.end = self.time, W
        if not self.trajectory:
            trial.error = trial.kept
        elif self.reference and self.reference.time == self.time:
            at_half, error = map(isosyrk.relative_error, states, self.exact)
            trial.error = error + self.uncertainty
            trial.growth = math.log2(error / at_half) if error > 0 < at_half else None
        return trial, states

    def refer(self, error):
        """Makes the reference solution of the part; if two do not agree, no trajectory is judged any more.

        Throws Stop where rounding keeps them from agreeing to what is asked for.
        """
        refinements = self.refinements(error, self.references[1])
        steps = next(refinements)
        while True:
            pair, states = zip(*(self.run(each, steps) for each in self.references))
            found = isosyrk.relative_error(states[1][1], states[0][1]) if all(states) else None
            try:
                steps = refinements.send((pair, found))
            except StopIteration:
                break
        self.exact = states[0]

    def search(self, integrator, error, max_seconds):
        """Returns the trial with the longest step that has an error over the part; None if none has."""
        tries = self.tries(integrator, error, max_seconds)
        steps = next(tries)
        while True:
            trial, _ = self.run(integrator, steps, max_seconds)
            try:
                steps = tries.send(trial)
            except StopIteration as end:
                return end.value

    def time_offers(self):
        """Times steps of each offer that is shown and was not run; one whose steps fail is offered no more as it is."""
        while untimed := [each for each in self.ranking()[:MAX_OFFERED] if not self.is_timed(each)]:
            self.time_steps(untimed[0], seconds_left() / len(untimed))

    def time_steps(self, offer, seconds):
        """Times steps of an offer from the end of the longest trial on, in about so many seconds at most.

        A failure counts as a trial.
        """
        (begin, W), h, method = self.end, offer.step, self.method(offer.integrator)
        try:
            (first,) = method.timed_run(W, h, MIN_STEPS, repetitions=1, warmup=MIN_STEPS)
            pace = max(first / MIN_STEPS, 1e-9)
            room = min(seconds * SHARE_TIMED / pace, (offer.time - begin) / h)
            steps = math.ceil(max(MIN_STEPS, MIN_SECONDS / pace, room))
            (taken,) = method.timed_run(W, h, steps, repetitions=1, warmup=MIN_STEPS)
        except isosyrk.SolverError as problem:
            self.trials.append(self.outcome(offer.integrator, MIN_STEPS * h, MIN_STEPS, None, 0.0, problem.status))
        else:
            self.paces[offer.integrator, offer.steps] = taken / steps

    def go_on(self):
        """Makes trials over longer and longer parts of the time, until it is whole or the next part takes too long."""
        # What is spared is for longer parts, where there are any.
        longer = 1 - FIRST_SHARE if self.time < self.question.time else 0.0
        integrators, spared = self.candidates, seconds_left() * longer
        while True:
            before = seconds_left()
            self.try_all(integrators, spared)
            fits = seconds_left() / (before - seconds_left())  # how often the budget has room for such a part
            if self.time == self.question.time or fits < 1:
                return
            integrators, spared = self.most_promising() or integrators, 0.0
            self.lengthen(fits)

    def try_all(self, integrators, spared):
        """Makes the trials of integrators over the part; if one is good, none is begun in the last `spared` seconds."""
        if self.trajectory:
            self.refer(self.proportional_error())
        cheapest = min((each.seconds for each in self.good.values() if each.time == self.time), default=math.inf)
        for each in integrators:
            if self.good and seconds_left() < spared:
                break
            error = self.error_over_part(each)
            if not error:
                continue
            best = self.search(each, error, TOO_EXPENSIVE * cheapest)
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
    """Returns the answer for a scene as answer_data() does; throws UnusableFile too. The clock is running."""
    scene, (option, value) = scene_of(options), given(options)
    search = Search(scene, Question(one_line(value), scene.n, options.time, options.error, options.keep))
    reserve = RESERVE * seconds_left()
    search.spent = not within(seconds_left() - reserve, search.go_on)
    search.untried = search.without_a_trial()
    search.settle()
    within(reserve, search.time_offers)
    arguments = ["--initial" if option == "--state" else option, value]
    if options.hbar == "standard":
        arguments += ["--hbar", options.hbar]
    return answer_data(search, " within the budget" if search.spent else "", Start(tuple(arguments)),
                       {"measured": f"here, {len(search.trials)} trials"})
