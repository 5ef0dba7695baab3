"""The line that a run of Table 1 leaves in a history: every pair of rows of its blocks."""

from lib.records.history import TABLE1, UNKNOWN, line_of
from studies.tables.judge import pairs, sizes
from studies.tables.report import runs_of


def line_of_run(path):
    """Returns the Line of the raw file of table1. Throws UnusableFile."""
    run = runs_of(path, ("published",))["published"]
    units = run.context.get("vector_units", UNKNOWN).rpartition("; ")[2]
    kernels = f"OpenBLAS {run.context.get('blas_kernels', UNKNOWN)}, {units}"
    return line_of(TABLE1, run.context, kernels, [
        (f"{each.row} over {each.other}, s = {each.stages}, n = {n}", each.ratio)
        for n in sizes(run) for each in pairs(run, n)])
