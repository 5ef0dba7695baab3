"""The recorded baseline of the regression gate, and its exact layer: counts, and what a raw file of table1 holds."""

import os
import re
import subprocess
import tempfile
from dataclasses import dataclass
from typing import Dict, Tuple

from benchmark_json import UnusableFile, cell_key, context_and_rows, parse_json, read_text
from document import replace_file
from gate_cells import SIZES, CannotRun, cells_of, is_fast, json_text, read_counts
from gate_layers import Layer
from study_file import CONVERGED, Wrong, an_object, checked, list_of, read_json, require, text

FORMAT = "isosyrk baseline 2"
# Sweeps of a run that other kernels, which round otherwise, may take more or less: an iteration that ends just under
# the tolerance here ends just above it there. One extra sweep a step would be 50.
SWEEPS_OF_OTHER_KERNELS = 3
# A fast form's correction between sweeps ends by what was seen of its contraction, and takes a turn more or less in
# some steps. Between builds with AVX2 and with AVX-512 kernels sweeps differed by up to 3, and work by that of up to 6
# sweeps. One coupling through B more in every step is seen: it is the work of at least 14 sweeps.
SWEEPS_OF_CORRECTIONS = 10
# Equivalent products are sums of 50 quotients below 100, each rounded; one multiplication more at n = 129 adds 1e-7.
ROUNDING_OF_SUMS = 1e-9
RAW_CELLS = "n:17/"  # of table1, for the shape of its raw file
PARTS = ("context", "rows", "fields")  # of a Shape
SECTIONS = ("cells", "fast_cells")  # of Table 1 and of Table 2


@dataclass(frozen=True)
class Shape:
    """What a raw file of table1 holds: fields of its context, its rows, and the fields of each of them."""

    context: Tuple[str, ...]
    rows: Tuple[str, ...]
    fields: Tuple[str, ...]


@dataclass(frozen=True)
class Baseline:
    commit: str
    kernels: str
    compiler: str
    counts: Dict[str, Dict[str, float]]  # by cell
    shape: Shape


def baseline_of(build, commit, shape):
    return Baseline(commit, build.kernels(), build.compiler(),
                    {name: cell.counts for name, cell in build.cells.items()}, shape)


def read_baseline(path):
    """Returns the baseline in `path`. Throws UnusableFile, also where it is one of other cells."""
    return read_json(path, analyse)


def analyse(document):
    require(document, "baseline of this version", "format", FORMAT)
    found = checked(document, {"commit": commit_hash, "kernels": any_text, "compiler": text, "raw_file": an_object,
                               **dict.fromkeys(SECTIONS, list_of(an_object))}, "it")
    cells = [each for section in SECTIONS for each in found[section]]
    counts = {checked(each, {"name": text}, "a cell")["name"]: read_counts(each) for each in cells}
    if len(counts) != len(cells) or set(counts) != set(cells_of(SIZES)):
        raise UnusableFile("is a baseline of other cells than are watched now")
    shape = checked(found["raw_file"], dict.fromkeys(PARTS, list_of(any_text)), "its raw_file")
    if not all(shape.values()):
        raise UnusableFile(f"has a raw_file without {', '.join(part for part in PARTS if not shape[part])}")
    return Baseline(found["commit"], found["kernels"], found["compiler"], counts, Shape(**shape))


def any_text(value):
    if not isinstance(value, str):
        raise Wrong("a text")
    return value


def commit_hash(value):
    if not re.fullmatch("[0-9a-f]{40}", any_text(value)):
        raise Wrong("a commit as 40 hexadecimal digits")
    return value


def write_baseline(path, baseline):
    document = {"format": FORMAT, "commit": baseline.commit, "kernels": baseline.kernels, "compiler": baseline.compiler,
                **{section: [{"name": name, **counts} for name, counts in baseline.counts.items()
                             if is_fast(name) == (section == "fast_cells")] for section in SECTIONS},
                "raw_file": {part: list(getattr(baseline.shape, part)) for part in PARTS}}
    os.makedirs(os.path.dirname(path), exist_ok=True)
    replace_file(path, json_text(document).encode("utf-8"))


def moves(old, new):
    """Returns a line for everything in which two baselines differ; `old` may be None."""
    if old is None:
        return ["there was no baseline to compare with"]
    lines = [f"{name}: {count} {old.counts[name][count]} -> {counts[count]}" for name, counts in new.counts.items()
             for count in counts if old.counts[name][count] != counts[count]]
    for part in PARTS:
        before, after = set(getattr(old.shape, part)), set(getattr(new.shape, part))
        lines += [f"raw file of table1: {part}: {name} gone" for name in sorted(before - after)]
        lines += [f"raw file of table1: {part}: {name} new" for name in sorted(after - before)]
    for part in ("kernels", "compiler", "commit"):
        if getattr(old, part) != getattr(new, part):
            lines.append(f"{part}: {getattr(old, part)} -> {getattr(new, part)}")
    return lines


def shape_of(program, environment=None):
    """Runs table1 on a few cells for as short as it can, and returns the Shape of its raw file. Throws CannotRun."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "raw.json")
        done = subprocess.run([program, "--products", "openblas", f"--benchmark_filter={RAW_CELLS}",
                               "--benchmark_min_time=0.001", f"--benchmark_out={path}"], stdin=subprocess.DEVNULL,
                              capture_output=True, env=environment, encoding="utf-8", errors="replace", check=False)
        try:
            document = parse_json(read_text(path))
            _, found = context_and_rows(document, "table1")
            rows = [row for row in found if cell_key(row, "table1")]
        except UnusableFile as problem:
            raise CannotRun(f"{program} (exit status {done.returncode}): its raw file {problem}") from None
    common = set.intersection(*(set(row) for row in rows)) if rows else set()
    return Shape(tuple(sorted(document["context"])), tuple(sorted(row["run_name"] for row in rows)),
                 tuple(sorted(common)))


def exact_layer(baseline, build, names, shape):
    """Checks the counts of these cells, and that a raw file holds what it held.

    Published forms round as their products do, in the kernels of the BLAS; fast ones as the compiler has it, too.
    """
    layer = Layer("exact")
    same_kernels = build.kernels() == baseline.kernels
    same_rounding = same_kernels and build.compiler() == baseline.compiler
    if not same_rounding:
        layer.notes.append(f"other {'compiler' if same_kernels else 'kernels'} than the baseline's: the sweeps of a"
                           f" {'fast ' if same_kernels else ''}run may differ by {SWEEPS_OF_OTHER_KERNELS}, and the"
                           f" products and Poisson solves of a fast one by those of {SWEEPS_OF_CORRECTIONS} sweeps")
    for name in names:
        cell = build.cells.get(name)
        if cell is None:
            layer.add(name, "cell", "missing", "present", False)
            continue
        layer.add(name, "status", cell.status, CONVERGED, cell.status == CONVERGED)
        if cell.status == CONVERGED:
            if is_fast(name):
                check_work(layer, cell, baseline.counts[name], same_rounding)
            else:
                check_counts(layer, cell, baseline.counts[name], 0 if same_kernels else SWEEPS_OF_OTHER_KERNELS)
            layer.add(name, "allocations", cell.counts["allocations"], baseline.counts[name]["allocations"],
                      cell.counts["allocations"] <= baseline.counts[name]["allocations"])
    for part in PARTS:
        for wanted in getattr(baseline.shape, part):
            found = "present" if wanted in getattr(shape, part) else "missing"
            layer.add("raw file of table1", f"{part}: {wanted}", found, "present", found == "present")
    return layer


def check_counts(layer, cell, wanted, slack):
    found = cell.counts
    layer.add(cell.name, "sweeps", found["sweeps"], f"{wanted['sweeps']} ± {slack}" if slack else wanted["sweeps"],
              abs(found["sweeps"] - wanted["sweeps"]) <= slack)
    for count in ("products", "poisson_solves"):
        each = f"{count}_a_sweep"
        outside = wanted[count] - wanted["sweeps"] * wanted[each]
        layer.add(cell.name, each, found[each], wanted[each], found[each] == wanted[each])
        layer.add(cell.name, f"{count} outside sweeps", cell.outside_sweeps(count), outside,
                  cell.outside_sweeps(count) == outside)


def check_work(layer, cell, wanted, exactly):
    """Checks a fast form's counts: exactly, or within the work of some of the baseline's sweeps."""
    for count, sweeps in (("sweeps", SWEEPS_OF_OTHER_KERNELS), ("equivalent_products", SWEEPS_OF_CORRECTIONS),
                          ("poisson_solves", SWEEPS_OF_CORRECTIONS)):
        slack = 0 if exactly else sweeps * wanted[count] / wanted["sweeps"]
        layer.add(cell.name, count, f"{cell.counts[count]:.10g}",
                  f"{wanted[count]:.10g} ± {slack:.3g}" if slack else f"{wanted[count]:.10g}",
                  abs(cell.counts[count] - wanted[count]) <= slack + ROUNDING_OF_SUMS)
