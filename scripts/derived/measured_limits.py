"""The recorded steps that survived, in core/catalogue/measured_limits.cpp."""

import os

from lib.programs.output import between, keep
from lib.programs.places import ROOT
from studies.limits.schema import RECORDED, read_limits

RAW = os.path.relpath(RECORDED, ROOT)
SOURCE = os.path.join("core", "catalogue", "measured_limits.cpp")
BEGIN = "// Written by scripts/update: begin\n"
END = "// Written by scripts/update: end\n"


def table(limits):
    """Returns the least h‖B‖₂ that survived, over scenes, of each form at each n, cut to two decimals, in C++."""
    rows = [f'    {{"{name}", Solver::{solver}, {n}, {int(value * 100) / 100:.2f}}},\n'
            for (name, solver, n), value in limits.min_survived().items()]
    return f"constexpr Limit limits[] = {{\n{''.join(rows)}}};\n"


def updated(source):
    recorded = table(read_limits())
    return between(source, BEGIN, END, f"{SOURCE}: its", recorded)


def update(check):
    """Writes the table; with `check` throws Stop, with status 1, where the source holds another."""
    keep(check, os.path.join(ROOT, SOURCE), updated,
         f"{SOURCE} does not hold the limits of {RAW}; run scripts/update")
