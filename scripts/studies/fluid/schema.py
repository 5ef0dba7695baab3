"""The raw file of the study `fluid`: the vorticity of one turbulent flow at its start and late, by some methods."""

from typing import NamedTuple

from lib.programs.messages import UnusableFile
from lib.records import formats
from lib.records.formats import (INTEGRATORS, Integrator, Schema, finite, keyed, list_of, number, positive, text, whole)

ROWS, COLUMNS = 120, 240  # of the grid: cells of 1.5° by 1.5°
SCALE = 500  # ω of a cell is kept as a whole number of this part of the largest |ω| at the start


class Settings(NamedTuple):
    n: whole(2)
    sample: whole()  # of the initial data of `turbulence`
    largest_vorticity: positive  # the largest |ω| of a cell at the start


FIELD = list_of(finite, ROWS * COLUMNS)


class Start(NamedTuple):
    """The fluid at t = 0."""

    energies: list_of(number)  # E(l), l = 1 … n − 1
    # ω in the middle of each cell, in parts of largest_vorticity / SCALE: rows from the south pole on, of COLUMNS cells
    # from longitude −180° on.
    vorticity: FIELD


class End(NamedTuple):
    """The fluid at the end of a run by a method."""

    integrator: text
    step: positive
    tolerance: positive
    time: positive
    products: number  # equivalent ones of the run
    energy_error: number  # relative
    enstrophy: positive  # over that at the start
    spectrum_error: number
    energies: list_of(number)  # as those of Start
    vorticity: FIELD


SCHEMA = Schema("fluid", Settings, {INTEGRATORS: Integrator, "starts": Start, "ends": End})


class Fluid:
    """A raw file: the Start, and Ends by integrator."""

    def __init__(self, study):
        self.context, self.settings = study.context, study.settings
        self.integrators = keyed(study.tables[INTEGRATORS], "name")
        self.ends = keyed(study.tables["ends"], "integrator")
        if len(study.tables["starts"]) != 1:
            raise UnusableFile("the table of starts has not one row")
        (self.start,) = study.tables["starts"]
        for name, end in self.ends.items():
            if name not in self.integrators:
                raise UnusableFile(f"the table of integrators has no {name}")
            if len(end.energies) != len(self.start.energies):
                raise UnusableFile(f"the table of ends has energies of another n by {name}")


def read_fluid(path):
    """Returns the Fluid in a raw file. Throws UnusableFile with one line that names the file."""
    return formats.read_study(path, SCHEMA, Fluid)
