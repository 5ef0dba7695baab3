"""Finds the cheapest run that reaches an error and keeps a structure, in what the study of accuracy measured.

What is offered is a Form: an integrator at a tolerance of its iteration. The step for an error is interpolated along
the line of a Form, between two neighbouring runs that worked. Between recorded n and between recorded times, steps and
seconds are interpolated too. All interpolation is linear in the logarithms. No step is offered beyond a failure, beyond
a stability limit, beyond the longest recorded step that worked, or, at another n or over a longer time than recorded,
beyond the longest step that survived in the study of limits.
"""

import itertools
import math
import os
import shlex
from dataclasses import dataclass
from typing import NamedTuple, Optional, Sequence

from lib.programs.command_line import NO_ANSWER, Stop
from lib.programs.messages import one_line
from lib.programs.places import MODULE
from lib.records.formats import FAST, Integrator
from lib.records.integrators import IMPLICIT_EXPONENTIAL, KEPT, MAGNUS, strongest_structure
from lib.records.settings import ENERGY_BOUNDED, TIGHT, Problem, keeps
from lib.pages.document import Column, Items, Paragraph, plain_table
from lib.pages.integrate_line import integrate_line, start_of
from lib.pages.numbers import MISSING, three_digits
from studies.accuracy.lines import NEAR_ROUNDING, interpolated
from studies.accuracy.schema import TABLE_EXPONENTS, Form

MAX_OFFERED = 5  # the answer and its runners-up
MAX_NAMED = 3  # Forms of unknown cost that a statement names

# The steps offered are for the error over MARGIN, for interpolation along a line. Between recorded n, and away from a
# recorded time, they are for a smaller one still: at T = 20, the errors of rk4 in the smooth scene at n = 33 are 1.8
# times what interpolation between T = 5 and 50 gives; other methods stay below it.
MARGIN, MARGIN_OF_N, MARGIN_OF_TIME = 1.2, 1.25, 1.6
PREDICTABLE = 0.01  # largest uncertainty of a reference that trajectories are judged by
SMALLEST_ERROR = 1e-17  # of energy and spectrum, which may be exactly 0
# CPU seconds that the first run of a process takes longer than a later one, which is what was timed: memory and caches
# are cold. At n = 17 and 24, rk4_frame and group4_frame: 0.15 to 0.25 ms on a processor with AVX-512.
COLD = 2e-4

# Growth of the error of energy with time, about the most that was seen: n = 33 and 65, smooth and rough, to T = 400.
# The error grows while a scene develops, up to SETTLED. Then it doubles at most for Gauss methods and compositions. For
# others it goes on: rkmk4_frame with h = 1, n = 33, has 4, 12 and 36 times that at T = 50 at T = 100, 200 and 400.
# Methods that lose the spectrum follow no such power over long times, and are not offered.
SETTLED, POWER, MAX_YOUNG, MAX_OLD = 50.0, 2.0, 40.0, 2.0
# Exponential Lie–Poisson methods in these scenes, h = 0.5 and 1. From T = 50 to 400, the error grows 4 to 9 times for
# elp4 and 4 to 23 times for elp6. It runs ahead of the square of time by a factor of 2.4 at most (elp6, smooth, n = 65,
# T = 79). Before, it follows no power: in the smooth scene 8 to 16 times from T = 40 to 80 for elp4, 17 to 34 for elp6.
EXPONENTIAL_OLD = 2.5


def drifts_fast(integrator):
    """Tells whether the energy of a method drifts faster than the square of time.

    In the smooth scene, from T = 50 to 400, 260 to 720 times for magnus5, 19 to 140 times for rk4_projected.
    """
    return integrator.family == MAGNUS or integrator.projected


class Question(NamedTuple):
    scene: str
    n: int
    time: float
    error: float
    keep: str


@dataclass
class Outcome:
    """A run of the fast form of an integrator, as it was made or as it is expected.

    `tolerance` is that of the iteration, as the program `integrate` is given it.
    """

    integrator: Integrator
    n: int
    time: float
    steps: int
    error: Optional[float]
    seconds: float
    tolerance: float = TIGHT
    status: str = "expected"
    growth: Optional[float] = None  # power of time with which the error of a trajectory grew in its second half
    kept: Optional[float] = None  # the error of energy and spectrum, the larger one, of a trial that keeps the spectrum
    evidence: Sequence["Outcome"] = ()  # for an expected run: the runs made that it follows from

    @property
    def step(self):
        return self.time / self.steps

    @property
    def name(self):
        return named(self.integrator.name, self.tolerance)

    @property
    def kept_structure(self):
        """The strongest structure that the integrator keeps at this tolerance."""
        return next(each for each in reversed(KEPT) if keeps(self.integrator, self.tolerance, each))

    def row(self):
        """Returns what answers tell about it, by name."""
        return {"integrator": self.integrator.name, "tolerance": self.tolerance, "order": self.integrator.order,
                "keeps": self.kept_structure, "n": self.n, "time": self.time, "steps": self.steps,
                "step": self.step, "error": self.error, "seconds": self.seconds, "status": self.status}


def named(integrator, tolerance):
    """Returns the name of an integrator, with its tolerance where that is not the tightest."""
    return integrator if tolerance == TIGHT else f"{integrator} (tolerance {tolerance:g})"


def that_keeps(structure):
    return "" if structure == "nothing" else f" that keep {KEPT[structure]}"


def below_reference(error, uncertainty, time):
    """Returns the Stop for an error that the reference solution cannot tell."""
    return Stop(f"--error {error:g}: is below the uncertainty of the reference solution at T = {time:g},"
                f" {uncertainty:.2g}")


def beyond_predictability(time, why):
    """Returns the statements on an answer that energy and spectrum are judged for."""
    return [f"T = {time:g} is beyond {why}: the error is that of energy and spectrum, the larger one, of methods that"
            f" keep the spectrum; it is taken to grow as the square of time, for Gauss methods and compositions up to T"
            f" = {SETTLED:g} only",
            "the energy error of explicit Magnus and projected Runge–Kutta methods is not extrapolated in time, that of"
            f" exponential Lie–Poisson methods from T = {SETTLED:g} on only"]


def statements_on_tolerance(offer, bounded):
    """Returns what is to be said of the tolerance of an offer; `bounded` tells whether its energy is to be bounded."""
    if bounded:
        return [f"exponential Lie–Poisson methods are offered at the tolerance {ENERGY_BOUNDED:g} only, at which their"
                " energy stays bounded"]
    if offer.tolerance == TIGHT:
        return []
    if not offer.integrator.spectrum_at_any_tolerance:
        return [f"at the tolerance {offer.tolerance:g} the spectrum is kept to about the tolerance only"]
    return [f"at the tolerance {offer.tolerance:g} the Lie–Poisson structure is kept to about the tolerance only: over"
            " a long run the energy drifts"] if offer.integrator.lie_poisson else []


def energy_growth(integrator, known, time):
    """Returns the growth of the error of energy and spectrum from a known time on, 1 for an earlier one.

    Infinity where the error cannot be extrapolated.
    """
    if time <= known:
        return 1.0
    old, is_exponential = max(1.0, max(time, SETTLED) / max(known, SETTLED)), integrator.family in IMPLICIT_EXPONENTIAL
    if drifts_fast(integrator) or (is_exponential and known < SETTLED):
        return math.inf
    if is_exponential:
        return EXPONENTIAL_OLD * old ** POWER
    young = max(1.0, min(time, SETTLED) / min(known, SETTLED)) ** POWER
    return min(MAX_YOUNG, young) * min(MAX_OLD, old) if integrator.lie_poisson else young * old ** POWER


# ---- recorded problems


def neighbours(values, wanted):
    """Returns the values next to the wanted one, with weights for interpolation; outside them, the nearest alone."""
    wanted = min(max(wanted, min(values)), max(values))
    below, above = max(each for each in values if each <= wanted), min(each for each in values if each >= wanted)
    if below == above:
        return {wanted: 1.0}
    share = math.log(wanted / below) / math.log(above / below)
    return {below: 1 - share, above: share}


def blend(weights, values):
    """Returns the weighted geometric mean of values."""
    return math.exp(math.fsum(weight * math.log(value) for weight, value in zip(weights, values)))


def cost_of(runs, error):
    """Returns the least Cost of an error on runs within limits, the shortest step first.

    None if they do not reach it.
    """
    runs = list(itertools.dropwhile(lambda run: error < run.error < NEAR_ROUNDING, runs))
    good = list(itertools.takewhile(lambda run: run.error <= error, runs))
    costs = [interpolated(run, run, run.error) for run in good]
    if good and len(good) < len(runs):
        costs.append(interpolated(runs[len(good)], good[-1], error))
    return min(costs, key=lambda cost: cost.seconds, default=None)


def recorded_sizes(study, scene):
    """Returns the recorded n of a scene, by time."""
    sizes = {}
    for problem in study.problems():
        if problem.scene == scene:
            sizes.setdefault(problem.time, []).append(problem.n)
    return sizes


def outside_the_records(study, scene, n):
    """Returns a text that says so where an n is below or above all recorded ones of a scene; otherwise None."""
    sizes = recorded_sizes(study, scene)
    if any(min(found) <= n <= max(found) for found in sizes.values()):
        return None
    recorded = "; ".join(f"n = {', '.join(map(str, found))} to T = {time:g}" for time, found in sizes.items())
    return f"n = {n} is outside what is recorded of the scene {scene} ({recorded or 'nothing'})"


class Recorded:
    """The recorded problems that a question is answered from. Throws Stop if there are none that tell the error."""

    def __init__(self, study, question, limits=None):
        """`limits` are the Limits that no step exceeds, or None."""
        self.study, self.question, self.limits = study, question, limits
        self.margin, self.said = MARGIN, []
        outside = outside_the_records(study, question.scene, question.n)
        if outside:
            raise Stop(f"{outside}, and nothing is extrapolated in n; --modes or --state tries a scene itself",
                       NO_ANSWER)
        sizes = recorded_sizes(study, question.scene)
        times = [time for time, found in sizes.items() if min(found) <= question.n <= max(found)]
        self.shortest, self.longest = min(times), max(times)
        around = neighbours(times, question.time)
        self.weights = {Problem(question.scene, time, n): share * part for time, share in around.items()
                        for n, part in neighbours(sizes[time], question.n).items()}
        self.interpolate("n", question.n, sorted({problem.n for problem in self.weights}), MARGIN_OF_N)
        uncertainty = max(study.references[problem].uncertainty for problem in self.weights)
        self.trajectory = question.time <= self.longest and uncertainty <= PREDICTABLE
        if not self.trajectory:
            self.said += beyond_predictability(question.time, (
                f"the recorded trajectories, which end at T = {self.longest:g}, good to {uncertainty:.1g}; --modes or"
                " --state tries whether it is predictable"))
        elif question.error < uncertainty:
            raise below_reference(question.error, uncertainty, max(problem.time for problem in self.weights))
        else:
            self.interpolate("T", question.time, around, MARGIN_OF_TIME)
        candidates = list(filter(self.is_candidate, study.forms()))
        # The lines of the study, with errors as they are judged.
        self.judged = study._replace(lines={
            (problem, *form): [run._replace(error=self.judged_error(run)) if run.usable else run
                               for run in study.line(problem, *form)]
            for problem in self.weights for form in candidates})
        self.lines = {form: [self.runs_within_limits(problem, form) for problem in self.weights] for form in candidates}

    def is_candidate(self, form):
        """Tells whether a Form keeps what is asked for, and has an error that can be judged.

        Beyond trajectories a method is a candidate only at a tolerance at which it keeps all that it can.
        """
        integrator = self.study.integrators[form.integrator]
        return keeps(integrator, form.tolerance, self.question.keep) and (self.trajectory or (
            integrator.isospectral and keeps(integrator, form.tolerance, strongest_structure(integrator))
            and math.isfinite(self.energy_growth(form))))

    def energy_growth(self, form):
        """Returns the growth of the error of energy and spectrum up to the time of the question."""
        return energy_growth(self.study.integrators[form.integrator], self.longest, self.question.time)

    def interpolate(self, what, wanted, used, margin):
        """Takes a margin for interpolation in n or T, and says so, unless the wanted value is recorded."""
        if wanted not in used:
            self.margin *= margin
            how = "interpolated" if len(used) > 1 else "scaled"
            self.said.append(f"{what} = {wanted:g} is not recorded: steps and seconds are {how} from {what} ="
                             f" {' and '.join(f'{value:g}' for value in used)}")

    def judged_error(self, run):
        """Returns the error of a recorded run at the time of the question, of the kind that is judged."""
        if not self.trajectory:
            return max(run.energy_error, run.spectrum_error, SMALLEST_ERROR) * self.energy_growth(run.form)
        # Up to the shortest recorded time, the error is taken to grow in proportion to time.
        share = min(1.0, self.question.time / self.shortest)
        return run.error * share + self.study.references[run.problem].uncertainty

    def runs_within_limits(self, problem, form):
        """Returns the runs of a line from the shortest step up to the first that failed or is beyond a limit.

        A step that worked at the n of the question, to its time or longer, needs no limit that another run had.
        """
        told = problem.n == self.question.n and problem.time >= self.question.time
        maximum = (None if told or not self.limits
                else self.limits.survived_around(FAST, problem.scene, problem.n, form.integrator))

        def is_within(run):
            return run.usable and not run.beyond_limit and (maximum is None or run.h_norm_B <= maximum)

        runs = itertools.dropwhile(lambda run: not is_within(run), reversed(self.judged.line(problem, *form)))
        return list(itertools.takewhile(is_within, runs))

    def outcome(self, run):
        return Outcome(self.study.integrators[run.integrator], run.n, run.time, run.steps, run.error, run.seconds,
                       run.tolerance, run.status)

    def costs(self, form):
        """Returns the Cost of the error on the line of each problem, None where the line does not reach it."""
        return [cost_of(line, self.question.error / self.margin) for line in self.lines[form]]

    def offer(self, form):
        """Returns the run of a Form that is expected to have the error, or None."""
        error, time, costs = self.question.error / self.margin, self.question.time, self.costs(form)
        if None in costs:
            return None
        known = [(cost.step, cost.fine.h_norm_B / cost.fine.step,
                  cost.fine.error if cost.coarse is cost.fine else error,
                  cost.seconds / problem.time) for problem, cost in zip(self.weights, costs)]
        step, norm_B, expected, pace = (blend(self.weights.values(), values) for values in zip(*known))
        longest = min(line[-1].h_norm_B for line in self.lines[form]) / norm_B
        steps = math.ceil(time / min(step, longest) * (1 - 1e-9))
        shortened, integrator = time / steps / step, self.study.integrators[form.integrator]
        runs = dict.fromkeys(run for cost in costs for run in (cost.coarse, cost.fine))
        return Outcome(integrator, self.question.n, time, steps, expected * shortened**integrator.order,
                       pace * time / shortened, form.tolerance, evidence=list(map(self.outcome, runs)))

    def ranking(self):
        """Returns the offer of each Form that reaches the error, the cheapest first."""
        offers = filter(None, map(self.offer, self.lines))
        return sorted(offers, key=lambda offer: (offer.seconds, offer.error))

    def nearest(self):
        """Returns the Outcome with the smallest error; of each Form, that of its worst problem. None if none."""
        found = [max((min(line, key=lambda run: run.error) for line in lines), key=lambda run: run.error)
                 for lines in self.lines.values() if all(lines)]
        return self.outcome(min(found, key=lambda run: run.error)) if found else None

    @property
    def statements(self):
        """Says what stands behind the answer."""
        return [*self.said, *self.of_unknown_cost()]

    def of_unknown_cost(self):
        """Says of which Forms it is not known whether they are cheaper than the answer."""
        best, error = self.ranking()[0], self.question.error / self.margin
        seconds = [cost.seconds for cost in self.costs(Form(best.integrator.name, best.tolerance))]
        names = [named(*form) for form in self.lines if self.offer(form) is None and any(
            self.judged.may_reach(problem, form.integrator, error, maximum, form.tolerance)
            for problem, maximum in zip(self.weights, seconds))]
        if not names:
            return []
        *first, last = names[:MAX_NAMED] + ["others"] * (len(names) > MAX_NAMED)
        if not first:
            return [f"not known whether {last} is cheaper: its recorded line was cut before the error was reached"]
        return [f"not known whether {', '.join(first)} and {last} are cheaper: their recorded lines were cut before the"
                " error was reached"]


def answer(study, question, path, rates_here=lambda sizes: None, limits=None):
    """Returns the answer as answer_data() does. `rates_here` returns products per second here for each n, or None."""
    recorded = Recorded(study, question, limits)
    around = neighbours(study.rates, question.n) if study.rates else {}
    here = rates_here(around) if around else None
    speedup = here and blend(around.values(), [rate / study.rates[n].fast for rate, n in zip(here, around)])
    start = start_of(question.scene, question.n, integrate())
    source = {"raw": one_line(path), **{name: study.context.get(name) for name in ("cpu", "commit", "dirty")}}
    return answer_data(recorded, f" with a margin of {recorded.margin:g}", start, source, speedup)


# ---- the answer


def integrate():
    """Returns the path of the program `integrate`, from here where that is shorter."""
    path = os.path.join(os.path.dirname(os.path.abspath(MODULE)), "benchmarks", "integrate")
    return shlex.quote(min(os.path.relpath(path), path, key=len))


def answer_data(search, how, start, source, speedup=None):
    """Returns the answer for programs, as what JSON can hold: of a question, from recorded runs or from trials.

    Throws Stop if nothing reaches the error; `how` says how it was to be reached. `start` is the Start that commands
    name. `speedup` is that of this machine against the one of the seconds, None if not known.
    """
    question, offers = search.question, search.ranking()[:MAX_OFFERED]
    if not offers or offers[0].error > question.error:
        best = search.nearest()
        found = (f"the best there is has {best.error:.3g}, by {best.name} with h = {best.step:.4g} at n ="
                 f" {best.n} to T = {best.time:g}" if best else "no run that is to be trusted was finished")
        raise Stop(f"no methods{that_keeps(question.keep)} are known to reach the error {question.error:g}{how};"
                   f" {found}",
                   NO_ANSWER)

    def offered(offer):
        row = offer.row()
        del row["status"]
        expected = row.pop("error")
        return {**row, "solver": FAST, "expected_error": expected, "seconds": offer.seconds / (speedup or 1.0) + COLD,
                "seconds_recorded": offer.seconds,
                "command": integrate_line(start, offer.n, offer.integrator.name, offer.step, offer.time,
                                          offer.tolerance, program=integrate())}

    winner, *others = offers
    return {**offered(winner), "question": question._asdict(),
            "judged": "trajectory" if search.trajectory else "energy and spectrum",
            "statements": [*search.statements, *statements_on_tolerance(
                winner, question.keep == "poisson" or not search.trajectory)],
            "speedup": speedup, "evidence": [each.row() for each in winner.evidence],
            "runners_up": list(map(offered, others)), "source": source}


def outcomes_table(rows, names):
    """Returns a table with a column for each of some names of what Outcome.row() returns."""
    def shown(value):
        return MISSING if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)

    columns = [Column(name, align="left" if isinstance(rows[0][name], str) else "right") for name in names]
    return plain_table(columns, [[shown(row[name]) for name in names] for row in rows])


def answer_document(data):
    """Returns an answer as a document: the cheapest method above its rivals, and where the numbers come from."""
    question = Question(**data["question"])
    recorded = [] if data["speedup"] is None else ["seconds_recorded"]
    return [
        Paragraph(f"The cheapest methods{that_keeps(question.keep)} for the scene {question.scene}, n = {question.n},"
                  f" to T = {question.time:g} with an error of {question.error:g} or less ({data['judged']}). The first"
                  " row is the answer, the others are its runners-up:"),
        outcomes_table([data, *data["runners_up"]], ["integrator", "solver", "tolerance", "order", "keeps", "step",
                                                     "steps", "expected_error", "seconds", *recorded]),
        *(Paragraph(f"Note: {each}.") for each in data["statements"]),
        Paragraph("Evidence for the answer:"),
        outcomes_table(data["evidence"], ["integrator", "tolerance", "n", "time", "steps", "error", "seconds",
                                          "status"]),
        Items([(name, f": {text}") for name, text in data["source"].items() if text is not None]),
        Paragraph("Run it:"),
    ]


# ---- the table


def recommendation_tables(study, limits=None):
    """Returns a table of the cheapest method by structure, problem and error; then how to read it."""
    def entry(structure, problem, exponent):
        try:
            question = Question(problem.scene, problem.n, problem.time, 10.0**exponent, structure)
            best = Recorded(study, question, limits).ranking()[0]
        except (Stop, IndexError):
            return MISSING
        return f"{best.name}, h = {best.step:.3g}, {three_digits(best.seconds)} s"

    columns = (Column("keeps", align="left"), Column("scene", align="left"), Column("T"), Column("n"),
               *(Column(f"error 1e{exponent}", align="left") for exponent in TABLE_EXPONENTS))
    rows = [[structure, problem.scene, f"{problem.time:g}", str(problem.n),
             *(entry(structure, problem, exponent) for exponent in TABLE_EXPONENTS)]
            for structure in KEPT for problem in study.problems()]
    return [plain_table(columns, rows), Paragraph(
        "The cheapest method by its fast form, as scripts/recommend answers: method, step, CPU seconds, interpolated"
        f" along the line for the column's error over {MARGIN}. A step is never longer than the longest recorded one"
        f" that worked. The tolerance of the iteration is {TIGHT:g} where none is named."
        f' "{MISSING}": nothing recorded reaches the error.')]
