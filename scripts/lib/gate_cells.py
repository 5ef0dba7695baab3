"""The cells that the regression gate watches, and what a build reports of them."""

import json
import subprocess
from dataclasses import dataclass
from typing import Dict, List, Optional

from benchmark_json import FORMULATIONS, UnusableFile, one_line, parse_json
from raw_files import CONVERGED, STATUSES, Fields, context, objects, unique

SIZES = (17, 33, 65, 129)
QUICK_SIZES = (17, 33)
STAGES = (1, 2, 3)
FORMAT = "isosyrk regression_cells 1"
# What a build promises of a cell whatever the machine, and what its kernels may shift a little.
COUNTS = ("sweeps", "products", "poisson_solves", "products_a_sweep", "poisson_solves_a_sweep", "allocations")


class CannotRun(Exception):
    """The gate cannot judge; the message is one line."""


def cell_name(formulation, n, stages):
    return f"{formulation}/n:{n}/s:{stages}"


def cells_of(sizes):
    return [cell_name(formulation, n, stages) for n in sizes for stages in STAGES for formulation in FORMULATIONS]


@dataclass(frozen=True)
class Cell:
    """What a build did in one cell; errors are None where the run did not converge."""

    name: str
    n: int
    status: str
    steps: int
    tolerance: float
    norm: float
    contraction: float
    counts: Dict[str, int]
    spectrum_error: Optional[float] = None
    skew_defect: Optional[float] = None
    distance_to_group: Optional[float] = None
    W: Optional[List[complex]] = None

    def outside_sweeps(self, count):
        """Returns how many products or Poisson solves the updates took, which no rounding changes."""
        return self.counts[count] - self.counts["sweeps"] * self.counts[f"{count}_a_sweep"]


@dataclass(frozen=True)
class Build:
    """A build's report: the commit, the kernels that rounded, and the cells by name."""

    context: Dict[str, str]
    cells: Dict[str, Cell]

    def kernels(self):
        return "; ".join(self.context.get(field, "unknown") for field in ("blas_kernels", "vector_units"))


def report_of(program, names, environment=None):
    """Runs a build's regression_cells. Throws CannotRun."""
    try:
        done = subprocess.run([program, *names], stdin=subprocess.DEVNULL, capture_output=True, env=environment,
                              encoding="utf-8", errors="replace", check=False)
    except OSError as problem:
        raise CannotRun(f"{program}: cannot be run: {problem.strerror}") from None
    if done.returncode != 0:
        raise CannotRun(f"{program} failed with {done.returncode}: {one_line(done.stderr)}")
    try:
        return read_build(parse_json(done.stdout))
    except UnusableFile as problem:
        raise CannotRun(f"{program}: its report {problem}") from None


def read_build(document):
    found = context(document, FORMAT)
    cells = [read_cell(Fields(each, "a cell")) for each in objects(document, "cells")]
    return Build(found, unique(cells, "name"))


def read_cell(fields):
    status = fields.one_of("status", STATUSES)
    known = {"name": fields.text("name"), "n": fields.whole("n", 2), "status": status,
             "steps": fields.whole("steps", 1), "tolerance": fields.positive("tolerance"),
             "norm": fields.positive("norm"),
             "contraction": fields.not_negative("contraction"), "counts": read_counts(fields)}
    if status != CONVERGED:
        return Cell(**known)
    if "distance_to_group" in fields.values:
        known["distance_to_group"] = fields.not_negative("distance_to_group")
    if "W" in fields.values:
        known["W"] = read_entries(fields, known["n"])
    return Cell(**known, spectrum_error=fields.not_negative("spectrum_error"),
                skew_defect=fields.not_negative("skew_defect"))


def read_counts(fields):
    return {name: fields.whole(name) for name in COUNTS}


def read_entries(fields, n):
    entries = fields.get("W")
    try:
        found = [complex(float(re), float(im)) for re, im in entries]
    except (TypeError, ValueError, OverflowError):
        found = []
    if len(found) != n * n:
        fields.refuse("W", f"a list of {n * n} pairs of numbers")
    return found


def json_text(document):
    return json.dumps(document, indent=1) + "\n"
