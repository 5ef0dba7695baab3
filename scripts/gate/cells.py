"""The cells that the regression gate watches, what a build reports of them, and the recorded baseline."""

import json
import os
import subprocess
from typing import Dict, NamedTuple

from lib.programs.command_line import Stop
from lib.programs.messages import UnusableFile, one_line
from lib.programs.output import replace_file
from lib.records.formats import (FORMULATIONS, an_object, any_text, anything, checked, keyed, list_of, number, optional,
                                 parse_json, positive, printable_context, read_json, require, status, text, whole)

SIZES = (17, 33, 65, 129)
QUICK_SIZES = (17, 33)
STAGES = (1, 2, 3)
FORMAT, BASELINE_FORMAT = "isosyrk regression_cells 2", "isosyrk baseline 3"
FAST = "fast_"  # begins the name of a cell of Table 2
COUNTS = ("sweeps", "products", "poisson_solves", "allocations")
FAST_COUNTS = ("sweeps", "equivalent_products", "poisson_solves", "allocations")
# What decides how a build rounds, of its conditions: two builds that share all of it round alike. With -march=native
# the compiler tunes for the processor, and may fuse other products with sums on another that has the same units.
ROUNDING = ("cpu", "blas_library", "blas_kernels", "split_kernels", "vector_units", "compiler", "flags")
# Those that two builds on one machine must share before their counts or times say anything of their algorithms. Flags
# are not among them: a commit may change those of the project.
KERNELS = ("blas_library", "blas_kernels", "split_kernels", "vector_units", "compiler")
UNKNOWN = "unknown"


def cells_of(sizes):
    """Returns the names of the cells of Table 1, then of Table 2."""
    return with_fast([f"{formulation}/n:{n}/s:{stages}" for n in sizes for stages in STAGES
                      for formulation in FORMULATIONS])


def with_fast(names):
    """Returns these cells of Table 1, then those of Table 2 that give the same answers."""
    return names + [FAST + name for name in names]


def is_fast(name):
    return name.startswith(FAST)


def compared(name):
    """Returns the cell whose answer this one gives too: of a fast form its published one, of any other group."""
    return name[len(FAST):] if is_fast(name) else "/".join(["group", *name.split("/")[1:]])


# ---- the report of a build


class Cell(NamedTuple):
    """What a build did in one cell; what a run that did not converge has none of is None."""

    name: text
    n: whole(2)
    status: status
    steps: whole(1)
    tolerance: positive
    norm: positive
    contraction: number
    spectrum_error: optional(number)
    skew_defect: optional(number)
    distance: optional(number)  # of a published form to group, of a fast one to its published form
    W: anything  # its entries, row by row, where there is a reference answer
    counts: anything  # by name, of the run from W₀
    other_roundings: anything  # those of runs from states that differ from it by rounding

    def runs(self, count):
        """Returns a count in the run from W₀, and in those from states that differ from it by rounding."""
        return [counts[count] for counts in (self.counts, *self.other_roundings)]


class Build(NamedTuple):
    """A build's report: its conditions, those that decide how it rounds, and the cells by name."""

    context: Dict[str, str]
    rounding: Dict[str, str]
    cells: Dict[str, Cell]


def report_of(program, names, environment=None, roundings=0):
    """Runs a build's regression_cells; counts of so many other roundings too, if it is none of before. Throws Stop."""
    if roundings and "--roundings" in output_of(program, ["--help"], environment):
        names = ["--roundings", str(roundings), *names]
    try:
        return read_build(parse_json(output_of(program, names, environment)))
    except UnusableFile as problem:
        raise Stop(f"{program}: its report {problem}") from None


def output_of(program, arguments, environment):
    try:
        done = subprocess.run([program, *arguments], stdin=subprocess.DEVNULL, capture_output=True, env=environment,
                              encoding="utf-8", errors="replace", check=False)
    except OSError as problem:
        raise Stop(f"{program}: cannot be run: {problem.strerror}") from None
    if done.returncode != 0:
        raise Stop(f"{program} failed with {done.returncode}: {one_line(done.stderr)}")
    return done.stdout


def read_build(document):
    require(document, "document of regression_cells", "format", FORMAT)
    found = checked(document, {"context": an_object, "cells": list_of(an_object)}, "it")
    context = printable_context(found["context"])
    return Build(context, rounding_of(context), keyed(map(read_cell, found["cells"]), "name"))


def rounding_of(context):
    """Returns what decides how a build rounds."""
    return {field: context.get(field, UNKNOWN) for field in ROUNDING}


def in_words(rounding):
    """Returns the kernels and the flags of a build, for a reader."""
    return (f"OpenBLAS {rounding['blas_kernels']}, split products {rounding['split_kernels']},"
            f" {rounding['vector_units'].rpartition('; ')[2]}; {rounding['compiler']} {rounding['flags']}")


def other_kernels(one, two):
    """Returns the fields of KERNELS in which two roundings differ; builds of before tell no kernels of split products,
    which are those of the same settings."""
    return [field for field in KERNELS if one[field] != two[field] and UNKNOWN not in (one[field], two[field])]


def read_cell(values):
    distance = "distance_to_published" if is_fast(values["name"]) else "distance_to_group"
    others = checked({"other_roundings": [], **values}, {"other_roundings": list_of(an_object)}, "a cell")
    values = {**dict.fromkeys(Cell._fields), **values, "distance": values.get(distance), "counts": read_counts(values),
              "other_roundings": [read_counts({"name": values["name"], "allocations": 0, **each})
                                  for each in others["other_roundings"]]}
    if values["W"] is not None:
        values["W"] = [complex(*entry) for entry in values["W"]]
    return Cell(**checked(values, Cell.__annotations__, "a cell"))


def read_counts(values):
    """Reads what is counted in a cell."""
    counts = FAST_COUNTS if is_fast(values["name"]) else COUNTS
    kinds = {count: positive if count == "equivalent_products" else whole() for count in counts}
    return checked(values, kinds, "a cell")


# ---- the baseline


class Baseline(NamedTuple):
    commit: str
    rounding: Dict[str, str]  # of the build whose counts they are
    counts: Dict[str, Dict[str, float]]  # by cell


def baseline_of(build, commit):
    return Baseline(commit, build.rounding, {name: cell.counts for name, cell in build.cells.items()})


def read_baseline(path):
    """Returns the baseline in `path`. Throws UnusableFile, also where it is one of other cells."""
    def baseline(document):
        require(document, "baseline of this version", "format", BASELINE_FORMAT)
        found = checked(document, {"commit": text, "rounding": an_object,
                                   **dict.fromkeys(("cells", "fast_cells"), list_of(an_object))}, "it")
        found["rounding"] = checked(found["rounding"], dict.fromkeys(ROUNDING, any_text), "its rounding")
        cells = [*found.pop("cells"), *found.pop("fast_cells")]
        counts = {checked(each, {"name": text}, "a cell")["name"]: read_counts(each) for each in cells}
        if len(counts) != len(cells) or set(counts) != set(cells_of(SIZES)):
            raise UnusableFile("is a baseline of other cells than are watched now")
        return Baseline(**found, counts=counts)

    return read_json(path, baseline)


def write_baseline(path, baseline):
    document = {"format": BASELINE_FORMAT, **baseline._asdict(), "cells": [], "fast_cells": []}
    for name, counts in document.pop("counts").items():
        document["fast_cells" if is_fast(name) else "cells"].append({"name": name, **counts})
    os.makedirs(os.path.dirname(path), exist_ok=True)
    replace_file(path, json_text(document).encode("utf-8"))


def json_text(document):
    return json.dumps(document, indent=1) + "\n"
