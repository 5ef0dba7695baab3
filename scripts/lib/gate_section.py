"""The report's section on the regression gate: what it caught and what it let pass, from scripts/gate_experiment."""

import statistics

from document import Column, Entry, Heading, Paragraph, Table
from gate_experiment_file import FAULTS, SLOWDOWNS
from gate_timing import MEDIAN_LIMIT, QUARTILE_LIMIT


def gate_sections(experiment):
    """Returns the section on a recorded experiment."""
    minutes = sum(run["seconds"] for run in experiment.runs) / 60.0
    return [
        Heading("Regression gate"),
        Paragraph("What scripts/check_regression caught in builds that were made worse, and what it let pass in builds"
                  f" that were the same. {len(experiment.runs)} runs in {minutes:.0f} minutes. Times are judged cell by"
                  f" cell: slower is a median ratio above {MEDIAN_LIMIT} with a lower quartile above {QUARTILE_LIMIT},"
                  " twice in succession."),
        times_table(experiment),
        Paragraph("Where the same build is timed against itself, every run that is called a regression is a false"
                  " alarm. Suspicions are runs that were measured a second time."),
        faults_table(experiment),
    ]


def times_table(experiment):
    kinds = [("same build", experiment.of("same build", busy=False)),
             ("same build, other core busy", experiment.of("same build", busy=True)),
             *((f"slower by {share:.0%}", experiment.of("slowdown", share=share)) for share in SLOWDOWNS)]
    columns = (Column("build", align="left"), Column("runs"), Column("suspicions"), Column("called regression"),
               Column("share"), Column("median ratio"), Column("its range"))
    return Table(columns, [[times_row(name, runs) for name, runs in kinds if runs]])


def times_row(name, runs):
    medians = [timings[0]["median"] for run in runs for timings in run["cells"].values()]
    suspected = sum(any(len(timings) > 1 for timings in run["cells"].values()) for run in runs)
    caught = sum(run["caught"] for run in runs)
    texts = (name, len(runs), suspected, caught, f"{caught / len(runs):.0%}", f"{statistics.median(medians):.3f}",
             f"{min(medians):.3f} – {max(medians):.3f}")
    return [Entry(str(text)) for text in texts]


def faults_table(experiment):
    columns = (Column("fault", align="left"), Column("runs"), Column("caught"), Column("by", align="left"),
               Column("first line of each layer", align="left"))
    rows = [fault_row(fault, experiment.of("fault", fault=fault)) for fault in FAULTS]
    return Table(columns, [[row for row in rows if row]])


def fault_row(fault, runs):
    if not runs:
        return None
    first = runs[0]["first"]
    texts = (FAULTS[fault], len(runs), sum(run["caught"] for run in runs), ", ".join(first) or "nothing",
             "; ".join(first.values()))
    return [Entry(str(text)) for text in texts]
