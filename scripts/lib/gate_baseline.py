"""The recorded baseline of the regression gate, and its exact layer: counts of what a run did."""

import os
from typing import Dict, NamedTuple

from checked_json import UnusableFile, an_object, any_text, checked, list_of, read_json, require, text
from gate_cells import SIZES, cells_of, is_fast, json_text, read_counts
from gate_layers import Layer
from output import replace_file
from study_file import CONVERGED

FORMAT = "isosyrk baseline 2"
# Sweeps of a run that other kernels, which round otherwise, may take more or less: an iteration that ends just under
# the tolerance here ends just above it there. One extra sweep a step would be 50; one product or Poisson solve more in
# every step is 50, and more than the work of these sweeps.
SWEEPS_OF_OTHER_KERNELS = 3
# A fast form's correction between sweeps ends by what was seen of its contraction, and takes a turn more or less in
# some steps. Between builds with AVX2 and with AVX-512 kernels sweeps differed by up to 3, and work by that of up to 6
# sweeps. One coupling through B more in every step is seen: it is the work of at least 14 sweeps.
SWEEPS_OF_CORRECTIONS = 10
# Equivalent products are sums of 50 quotients below 100, each rounded; one multiplication more at n = 129 adds 1e-7.
ROUNDING_OF_SUMS = 1e-9
SECTIONS = ("cells", "fast_cells")  # of Table 1 and of Table 2


class Baseline(NamedTuple):
    commit: str
    kernels: str
    compiler: str
    counts: Dict[str, Dict[str, float]]  # by cell


def baseline_of(build, commit):
    return Baseline(commit, build.kernels(), build.compiler(), {name: cell.counts for name, cell in build.cells.items()})


def read_baseline(path):
    """Returns the baseline in `path`. Throws UnusableFile, also where it is one of other cells."""
    return read_json(path, analyse)


def analyse(document):
    require(document, "baseline of this version", "format", FORMAT)
    found = checked(document, {"commit": text, "kernels": any_text, "compiler": text,
                               **dict.fromkeys(SECTIONS, list_of(an_object))}, "it")
    cells = [each for section in SECTIONS for each in found[section]]
    counts = {checked(each, {"name": text}, "a cell")["name"]: read_counts(each) for each in cells}
    if len(counts) != len(cells) or set(counts) != set(cells_of(SIZES)):
        raise UnusableFile("is a baseline of other cells than are watched now")
    return Baseline(found["commit"], found["kernels"], found["compiler"], counts)


def write_baseline(path, baseline):
    document = {"format": FORMAT, "commit": baseline.commit, "kernels": baseline.kernels, "compiler": baseline.compiler,
                **{section: [{"name": name, **counts} for name, counts in baseline.counts.items()
                             if is_fast(name) == (section == "fast_cells")] for section in SECTIONS}}
    os.makedirs(os.path.dirname(path), exist_ok=True)
    replace_file(path, json_text(document).encode("utf-8"))


def exact_layer(baseline, build, names):
    """Checks the counts of these cells.

    Published forms round as their products do, in the kernels of the BLAS; fast ones as the compiler has it, too.
    """
    layer = Layer("exact")
    same_kernels = build.kernels() == baseline.kernels
    same_rounding = same_kernels and build.compiler() == baseline.compiler
    if not same_rounding:
        layer.notes.append(f"other {'compiler' if same_kernels else 'kernels'} than the baseline's: the sweeps of a"
                           f" {'fast ' if same_kernels else ''}run may differ by {SWEEPS_OF_OTHER_KERNELS}, and the"
                           f" products and Poisson solves by those of so many sweeps, of a fast one by those of"
                           f" {SWEEPS_OF_CORRECTIONS}")
    for name in names:
        cell = build.cells.get(name)
        if cell is None:
            layer.add(name, "cell", "missing", "present", False)
            continue
        layer.add(name, "status", cell.status, CONVERGED, cell.status == CONVERGED)
        if cell.status == CONVERGED:
            check_counts(layer, cell, baseline.counts[name], same_rounding if is_fast(name) else same_kernels)
    return layer


def check_counts(layer, cell, wanted, exactly):
    """Checks counts: exactly, or within the work of some of the baseline's sweeps. Allocations may only be fewer."""
    sweeps_of_work = SWEEPS_OF_CORRECTIONS if is_fast(cell.name) else SWEEPS_OF_OTHER_KERNELS
    for count, found in cell.counts.items():
        if count == "allocations":
            layer.add(cell.name, count, found, wanted[count], found <= wanted[count])
            continue
        sweeps = SWEEPS_OF_OTHER_KERNELS if count == "sweeps" else sweeps_of_work
        slack = 0 if exactly else sweeps * wanted[count] / wanted["sweeps"]
        layer.add(cell.name, count, f"{found:.10g}",
                  f"{wanted[count]:.10g} ± {slack:.3g}" if slack else f"{wanted[count]:.10g}",
                  abs(found - wanted[count]) <= slack + ROUNDING_OF_SUMS)
