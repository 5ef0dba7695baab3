"""Reads what scripts/gate_experiment recorded of the regression gate."""

from dataclasses import dataclass
from typing import Dict, List

from benchmark_json import UnusableFile
from raw_files import Fields, context, objects, read

FORMAT = "isosyrk gate_experiment 1"
SLOWDOWNS = (0.02, 0.05, 0.1, 0.25)
RUNS = 20  # of each slowdown, and of the same build on a quiet and on a busy machine
# Those of core/faults.h that change what is computed, and what they are to a reader.
FAULTS = {
    "tolerance": "tolerance 1e-11 for 1e-13", "tableau": "a_11 of the tableau off by 1e-10",
    "printed_index": "K_ij with the printed index", "extra_sweep": "one extra sweep a step",
    "single_precision": "Poisson solve in single precision", "skewness": "update of algebra as B W - W B",
    "allocation": "an allocation in every sweep",
}
KINDS = ("same build", "slowdown", "fault")


@dataclass(frozen=True)
class Experiment:
    context: Dict[str, str]
    commit: str
    runs: List[dict]

    def of(self, kind, **wanted):
        return [run for run in self.runs if run["kind"] == kind
                and all(run.get(name) == value for name, value in wanted.items())]


def read_experiment(path):
    """Returns the Experiment in `path`. Throws UnusableFile."""
    return read(path, analyse)


def analyse(document):
    conditions = context(document, FORMAT)
    commit = Fields(document, "it").text("commit")
    runs = objects(document, "runs")
    for run in runs:
        check_run(Fields(run, "a run"))
    return Experiment(conditions, commit, runs)


def check_run(fields):
    kind = fields.one_of("kind", KINDS)
    fields.truth("caught")
    fields.positive("seconds")
    if kind == "fault":
        fields.one_of("fault", FAULTS)
        first = fields.object("first")
        if not all(isinstance(line, str) for line in first.values.values()):
            raise UnusableFile("a fault's first failures are not texts")
        return
    fields.truth("busy")
    if kind == "slowdown" and fields.positive("share") not in SLOWDOWNS:
        fields.refuse("share", f"one of {SLOWDOWNS}")
    cells = fields.object("cells")
    for cell, timings in cells.values.items():
        if not isinstance(timings, list) or not 1 <= len(timings) <= 2:
            cells.refuse(cell, "one or two timings")
        for timing in timings:
            if not isinstance(timing, dict):
                cells.refuse(cell, "one or two timings")
            found = Fields(timing, f"a timing of {cell}")
            found.positive("median")
            found.positive("lower_quartile")
