"""What the lines of the study `accuracy` show: ends, orders, and the cost of an error."""

import itertools
import math
import statistics
from typing import Dict, List, NamedTuple, Optional

from lib.programs.messages import UnusableFile
from lib.records import formats
from lib.records.formats import Integrator, keyed
from lib.records.settings import SCENES, TIGHT, Problem
from lib.judging.verdicts import ratio_of, verdict
from studies.accuracy.schema import CUT, SCHEMA, Comparison, Form, Rate, Reference, Run


# A line has reached its floor where the error is within this of the reference's uncertainty, ...
FLOOR_MARGIN = 10
# ... or where, below NEAR_ROUNDING or below so many times the tolerance, it falls with the step by less than this
# share of the order.
NEAR_ROUNDING, NEAR_TOLERANCE = 1e-8, 10
STILL_FALLING = 0.5
# Runs that an observed order is fitted on, those of the smallest steps above the floor: an order is what errors tend
# to. Fewer do not tell one.
ORDER_POINTS = 3


class Cost(NamedTuple):
    """What an error costs on a line: the cost of a run, or interpolated in log error between two neighbouring ones."""

    seconds: float
    step: float
    energy_error: float
    coarse: Run  # the run before, with an error above the one asked for; the same as `fine` if not interpolated
    fine: Run


class Accuracy(NamedTuple):
    context: Dict[str, str]
    references: Dict[Problem, Reference]
    rates: Dict[int, Rate]
    integrators: Dict[str, Integrator]
    runs: List[Run]
    tolerance_runs: List[Run]
    lines: Dict[tuple, List[Run]]  # by (problem, integrator, tolerance), the longest step first
    ends: Dict[tuple, str]  # of the lines
    comparisons: Dict[tuple, Dict[str, Comparison]]  # rows by candidate, of the comparison at (problem, error)

    def problems(self):
        """Returns the problems in the order of SCENES, then of time and n."""
        return sorted(self.references, key=lambda each: (SCENES.index(each.scene), each.time, each.n))

    def forms(self):
        """Returns the Forms that have lines, each integrator at its tightest tolerance first."""
        found = {(name, tolerance) for _, name, tolerance in self.lines}
        return [Form(name, tolerance) for name in self.integrators
                for tolerance in sorted(tolerance for each, tolerance in found if each == name)]

    def line(self, problem, integrator, tolerance=TIGHT):
        """Returns all runs of a line, the longest step first, failures included."""
        return self.lines.get((problem, integrator, tolerance), [])

    def above_floor(self, problem, integrator, tolerance=TIGHT):
        """Returns the usable runs of a line down to where its error reaches the floor."""
        minimum = FLOOR_MARGIN * self.references[problem].uncertainty
        kept = []
        for run in self.line(problem, integrator, tolerance):
            if not run.usable:
                continue
            if run.error < minimum:
                break
            if kept and is_floor(kept[-1], run, self.integrators[integrator].order):
                break
            kept.append(run)
        return kept

    def stretches(self, problem, integrator, tolerance=TIGHT, beyond=False):
        """Returns the line above its floor as lists of neighbouring runs that are no failure, nor beyond a limit unless
        `beyond` says so."""
        kept = set(map(id, self.above_floor(problem, integrator, tolerance)))
        found = itertools.groupby(self.line(problem, integrator, tolerance),
                                  lambda run: id(run) in kept and (beyond or not run.beyond_limit))
        return [list(runs) for good, runs in found if good]

    def cost(self, problem, integrator, error, tolerance=TIGHT, beyond=False) -> Optional[Cost]:
        """Returns the least cost of this error or a smaller one on a line; None where the line does not reach it.

        Runs beyond a limit count if `beyond` says so.
        """
        costs = []
        for stretch in self.stretches(problem, integrator, tolerance, beyond):
            costs += [interpolated(run, run, error) for run in stretch if run.error <= error]
            costs += [interpolated(coarse, fine, error) for coarse, fine in zip(stretch, stretch[1:])
                      if coarse.error >= error >= fine.error]
        return min(costs, key=lambda cost: cost.seconds, default=None)

    def may_reach(self, problem, integrator, error, seconds, tolerance=TIGHT):
        """Tells whether a line was cut above an error before a run took so many seconds: then its cost is not known."""
        runs = [run for run in self.line(problem, integrator, tolerance) if run.usable]
        return (self.ends.get((problem, integrator, tolerance)) == CUT and all(run.error > error for run in runs)
                and all(run.seconds < seconds for run in runs))

    def observed_order(self, problem, integrator, tolerance=TIGHT):
        """Returns the order that a line shows above its floor and below the linear limit; None for too few runs."""
        return fitted_order([run for run in self.above_floor(problem, integrator, tolerance) if not run.beyond_limit])

    def at_step(self, problem, integrator, step, tolerance=TIGHT):
        """Returns the run with this step size, or None."""
        return next((run for run in self.line(problem, integrator, tolerance)
                     if math.isclose(run.step, step, rel_tol=1e-9)), None)

    def comparison(self, problem, error):
        """Returns the rows of the comparison at an error, by candidate; none if there was no comparison."""
        return next((rows for (where, wanted), rows in self.comparisons.items()
                     if where == problem and math.isclose(wanted, error, rel_tol=1e-9)), {})


def compared(row, other):
    """Returns (Ratio, verdict) of a row's time in a comparison over another's, by the processes that timed both."""
    both = min(len(row.cpu_seconds), len(other.cpu_seconds))
    found = ratio_of(row.cpu_seconds[:both], other.cpu_seconds[:both])
    return found, verdict(found)


def is_floor(coarse, fine, order):
    """Tells whether rounding or the tolerance keeps the error of `fine` from falling as the order says."""
    falls = math.log(coarse.error / fine.error)
    near = coarse.error < max(NEAR_ROUNDING, NEAR_TOLERANCE * fine.tolerance)
    return near and falls < STILL_FALLING * order * math.log(coarse.step / fine.step)


def fitted_order(runs):
    """Fits the slope of log error over log step on the last ORDER_POINTS runs; None for fewer."""
    steps = [math.log(run.step) for run in runs[-ORDER_POINTS:]]
    if len(set(steps)) < ORDER_POINTS:
        return None
    return statistics.linear_regression(steps, [math.log(run.error) for run in runs[-ORDER_POINTS:]]).slope


def interpolated(coarse, fine, error):
    """Returns the Cost of an error between those of two runs, linear in the logarithms."""
    share = 1.0 if coarse.error == fine.error else (math.log(coarse.error / error)
                                                    / math.log(coarse.error / fine.error))

    def between(value):
        return value(coarse) ** (1 - share) * value(fine) ** share

    return Cost(between(lambda run: run.seconds), between(lambda run: run.step),
                between(lambda run: run.energy_error), coarse, fine)


def read_accuracy(path):
    """Returns the Accuracy in `path`. Throws UnusableFile with one line that names the file and what is wrong."""
    return formats.read_study(path, SCHEMA, accuracy)


def accuracy(study):
    """Returns the Accuracy of a Study. Throws UnusableFile for one without problems or integrators."""
    tables = study.tables
    references = {Problem(*key): each for key, each in keyed(tables["references"], "scene", "time", "n").items()}
    lines, ends, comparisons = {}, {}, {}
    for run in sorted(tables["runs"], key=lambda run: run.steps):
        lines.setdefault((run.problem, run.integrator, run.tolerance), []).append(run)
    for each in tables["lines"]:
        ends[Problem(each.scene, each.time, each.n), each.integrator, each.tolerance] = each.end
    for each in tables["comparisons"]:
        comparisons.setdefault((Problem(each.scene, each.time, each.n), each.wanted), {})[each.candidate] = each
    result = Accuracy(study.context, references, keyed(tables["rates"], "n"), keyed(tables["integrators"], "name"),
                      tables["runs"], tables["tolerance_runs"], lines, ends, comparisons)
    if not result.references or not result.integrators:
        raise UnusableFile("has no references or no integrators")
    for problem, name, tolerance in lines:
        if (problem, name, tolerance) not in ends or name not in result.integrators or problem not in references:
            raise UnusableFile(f"has runs of {name} on {problem} and not the line, integrator or reference that they"
                               " belong to")
    return result
