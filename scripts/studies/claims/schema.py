"""The raw file of the study `claims`: its settings and tables."""

from typing import NamedTuple

from lib.programs.messages import UnusableFile
from lib.records import formats
from lib.records.formats import (FORMULATIONS, INTEGRATORS, SOLVERS, Integrator, Schema, Wrong, list_of, number, one_of,
                                 positive, text, whole)
from lib.records.table_file import CellKey, Measurement, Run

HBARS = ("paper", "standard")

# Codes of the table of threads: fast forms that take plain Picard sweeps from a cold start, as published forms do, on
# full matrices; and fast forms with all that they have.
SWEEPS, WHOLE = THREAD_CODES = ("sweeps", "whole")
# Largest entry of a difference of two answers that are called equal. Each of 50 steps may end up to the tolerance 1e-13
# from the solution of its stage equations, in both runs.
EQUAL = 2 * 50 * 1e-13
WITHOUT = {SWEEPS: ("predictor", "newton", "bands"), WHOLE: ()}


def times(value):
    """The kind of times by process, of which there is one at least."""
    found = list_of(positive)(value)
    if not found:
        raise Wrong("a list of one time or more")
    return found


class Settings(NamedTuple):
    step: positive
    steps: whole(1)  # of a run of the cells of Table 1
    tolerance: positive
    octave: text  # its version
    octave_kernels: text  # of OpenBLAS, that Octave ran on


class OctaveCell(NamedTuple):
    """A cell of Table 1 in GNU Octave."""

    formulation: one_of(*FORMULATIONS)
    n: whole(2)
    stages: whole(1)
    sweeps: whole(1)  # of the run
    products: whole(1)  # of the run
    difference: number  # of W at the end from that of the published form in C++: the largest entry
    seconds: times  # CPU time of the run without set-up, one entry a process


class OctavePair(NamedTuple):
    """Two formulations at one n and s in GNU Octave."""

    n: whole(2)
    stages: whole(1)
    row: one_of(*FORMULATIONS)
    other: one_of(*FORMULATIONS)
    difference: number  # of their W at the end: the largest entry


class OctaveProduct(NamedTuple):
    """Octave's own product of n x n complex matrices, in the processes that timed its cells."""

    n: whole(2)
    seconds: times


class SampleCell(NamedTuple):
    """A cell of Table 1 in C++, with initial modes drawn at random."""

    n: whole(2)
    hbar: one_of(*HBARS)
    sample: whole()
    implementation: one_of(*SOLVERS)
    formulation: one_of(*FORMULATIONS)
    stages: whole(1)
    seconds: times  # CPU time of the run, one entry a process


class ThreadCell(NamedTuple):
    """A fast form by some threads; the run is its first steps from the initial data."""

    n: whole(2)
    step: positive
    steps: whole(1)
    formulation: one_of(*FORMULATIONS)
    stages: whole(1)
    code: one_of(*THREAD_CODES)
    threads: whole(1)
    sweeps: whole(1)  # of the run
    equivalent_products: number  # of the run
    seconds: times  # time that passed, one entry a process


class Rate(NamedTuple):
    """What one product of the fast forms and one pass over matrices take, in the processes of the table of threads."""

    n: whole(2)
    product_seconds: times
    pass_seconds: times  # the sum of two n x n complex matrices into a third


SCHEMA = Schema("claims", Settings, {INTEGRATORS: Integrator, "octave": OctaveCell, "octave_pairs": OctavePair,
                                     "octave_products": OctaveProduct, "samples": SampleCell, "threads": ThreadCell,
                                     "rates": Rate},
                later=(INTEGRATORS,), renamed={"draw": "sample", "draws": "samples"})


def read_claims(path, make=lambda study: study):
    """Returns what `make` makes of the study in a raw file. Throws UnusableFile with one line that names the file."""
    return formats.read_study(path, SCHEMA, lambda study: make(whole_study(study)))


def whole_study(study):
    """Returns a Study whose tables belong together. Throws UnusableFile for one of which a part is missing."""
    products = {row.n: len(row.seconds) for row in study.tables["octave_products"]}
    for cell in study.tables["octave"]:
        if products.get(cell.n, 0) < len(cell.seconds):
            raise UnusableFile(f"the table of octave_products has too few times for n = {cell.n}")
    rates = {row.n for row in study.tables["rates"]}
    singles = {(cell.n, cell.stages, cell.formulation, cell.code) for cell in study.tables["threads"]
               if cell.threads == 1}
    processes = {}
    for cell in study.tables["threads"]:
        where = f"n = {cell.n}, s = {cell.stages}"
        if cell.n not in rates:
            raise UnusableFile(f"the table of rates has no n = {cell.n}")
        if (cell.n, cell.stages, cell.formulation, cell.code) not in singles:
            raise UnusableFile(f"the table of threads has no single thread of {cell.formulation} at {where}")
        if processes.setdefault((cell.n, cell.stages), len(cell.seconds)) != len(cell.seconds):
            raise UnusableFile(f"the table of threads has rows of unequally many processes at {where}")
    return study


def run_of(cells, context):
    """Returns cells of one implementation as the Run of a table; its times are by process."""
    return Run(context, {CellKey(cell.formulation, cell.n, cell.stages): Measurement(dict(enumerate(cell.seconds)))
                         for cell in cells})


def octave_run(study):
    """Returns the cells of GNU Octave as the Run of a table."""
    return run_of(study.tables["octave"], study.context)


def sample_runs(study):
    """Returns Runs by (implementation, ħ, sample)."""
    found = {}
    for cell in study.tables["samples"]:
        found.setdefault((cell.implementation, cell.hbar, cell.sample), []).append(cell)
    return {key: run_of(cells, study.context) for key, cells in found.items()}
