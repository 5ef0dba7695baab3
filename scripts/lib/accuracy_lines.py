"""The raw file of the study of accuracy against cost, and what its lines show: floors and observed orders.

A line is the runs of one integrator at one n, to the same time with more and more steps.
"""

import math
import statistics
from typing import Dict, List, NamedTuple

import study_file
from benchmark_json import UnusableFile, quoted
from integrator_names import gauss_stages
from study_file import (CASIMIRS, CONVERGED, Integrator, Schema, keyed, list_of, number, optional, positive,
                        status, text, truth, whole)

TABLE1_STEP = 0.1  # the step size of Table 1, where the tolerances were varied too

# A line has reached its floor where the error is within this of the reference's uncertainty, ...
FLOOR_MARGIN = 10
# ... or where, below NEAR_ROUNDING, the next step size does not lower it to this share.
NEAR_ROUNDING = 1e-8
STILL_FALLING = 0.8
# Runs that an observed order is fitted on, those of the smallest steps above the floor: an order is what errors tend
# to. Fewer do not tell one.
ORDER_POINTS = 3


class Settings(NamedTuple):
    scene: text
    time: positive


class Reference(NamedTuple):
    n: whole(2)
    uncertainty: positive  # relative, as the error of a run
    integrators: list_of(text, 2)
    steps: list_of(whole(1), 2)


class Run(NamedTuple):
    """What a run came to and what it cost; errors are None where it did not come to a usable end."""

    integrator: text
    n: whole(2)
    steps: whole(1)
    step: positive
    tolerance: positive
    status: status
    error: optional(positive)  # ‖W(T) − reference‖_F / ‖reference‖_F
    solver_error: optional(number)  # of tolerance_runs: relative distance from the tightest tolerance that converged
    spectrum_error: optional(number)
    casimir_errors: optional(list_of(number, len(CASIMIRS)))
    energy_error: optional(number)
    angular_momentum_error: optional(number)
    skew_defect: optional(number)
    h_norm_B: number
    h_norm_ad_B: number
    beyond_limit: truth  # the step is longer than the integrator is stable for
    sweeps: whole()
    products: whole()
    poisson_solves: whole()
    cpu_seconds: list_of(positive)  # one for each repetition; none for a run that failed

    @property
    def usable(self):
        return self.status == CONVERGED

    @property
    def seconds(self):
        return statistics.median(self.cpu_seconds)

    @property
    def stages(self):
        """Of a formulation of the Gauss method; None for any other integrator."""
        return gauss_stages(self.integrator)

    @property
    def formulation(self):
        return self.integrator.rstrip("0123456789")


# What a run that converged must have.
NEEDED = ("error", "spectrum_error", "casimir_errors", "energy_error", "angular_momentum_error", "skew_defect",
          "cpu_seconds")
SCHEMA = Schema("accuracy", Settings, {"references": Reference, "integrators": Integrator, "runs": Run,
                                       "tolerance_runs": Run})


class Accuracy(NamedTuple):
    context: Dict[str, str]
    time: float
    references: Dict[int, Reference]
    integrators: Dict[str, Integrator]
    runs: List[Run]
    tolerance_runs: List[Run]

    def sizes(self):
        return sorted(self.references)

    def line(self, integrator, n):
        """Returns all runs of a line, the longest step first, failures included."""
        runs = [run for run in self.runs if run.integrator == integrator and run.n == n]
        return sorted(runs, key=lambda run: run.steps)

    def above_floor(self, integrator, n):
        """Returns the usable runs of a line down to where its error reaches the floor."""
        least = FLOOR_MARGIN * self.references[n].uncertainty
        kept = []
        for run in self.line(integrator, n):
            if not run.usable:
                continue
            if run.error < least:
                break
            if kept and kept[-1].error < NEAR_ROUNDING and run.error > STILL_FALLING * kept[-1].error:
                break
            kept.append(run)
        return kept

    def observed_order(self, integrator, n):
        """Fits the slope of log error over log step on the last runs above the floor; None for too few."""
        runs = self.above_floor(integrator, n)[-ORDER_POINTS:]
        steps = [math.log(run.step) for run in runs]
        if len(set(steps)) < ORDER_POINTS:
            return None
        slope, _ = statistics.linear_regression(steps, [math.log(run.error) for run in runs])
        return slope

    def at_step(self, integrator, n, step):
        """Returns the run with this step size, or None."""
        return next((run for run in self.line(integrator, n) if math.isclose(run.step, step, rel_tol=1e-9)), None)


def read_accuracy(path):
    """Returns the Accuracy in `path`. Throws UnusableFile with one line that names the file and what is wrong."""
    return study_file.read(path, SCHEMA, accuracy)


def accuracy(study):
    """Returns the Accuracy of a Study, having checked what its tables say together. Throws UnusableFile."""
    result = Accuracy(study.context, study.settings.time, keyed(study.tables["references"], "n"),
                      keyed(study.tables["integrators"], "name"), study.tables["runs"], study.tables["tolerance_runs"])
    if not result.references or not result.integrators:
        raise UnusableFile("has no references or no integrators")
    keyed(result.runs, "integrator", "n", "steps")
    keyed(result.tolerance_runs, "integrator", "n", "tolerance")
    for run in (*result.runs, *result.tolerance_runs):
        check(run, result)
    if any(run.stages is None for run in result.tolerance_runs):
        raise UnusableFile("has a tolerance run of another method than Gauss's")
    return result


def check(run, result):
    if run.integrator not in result.integrators:
        raise UnusableFile(f"has a run of an integrator it does not list, {quoted(run.integrator)}")
    if run.n not in result.references:
        raise UnusableFile(f"has a run at n = {run.n}, for which it has no reference")
    if not math.isclose(run.steps * run.step, result.time, rel_tol=1e-9):
        raise UnusableFile(f"has a run of {run.steps} steps of {run.step:g}, which do not come to the time"
                           f" {result.time:g}")
    if run.usable:
        missing = [name for name in NEEDED if getattr(run, name) in (None, ())]
        if missing:
            raise UnusableFile(f"has a run that {CONVERGED} and has no value of {', '.join(missing)}")
