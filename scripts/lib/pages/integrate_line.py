"""The command lines that repeat recorded runs by the program `integrate`, from the root of a clone that was built."""

import shlex
from typing import NamedTuple, Tuple

from lib.records.formats import FAST
from lib.records.settings import SCENES, TIGHT

PROGRAM = "build/benchmarks/integrate"
DEVELOPED = SCENES[2]
PYTHON = "PYTHONPATH=scripts:build/python python3 -c"


class Start(NamedTuple):
    """The initial data of a run: arguments of `integrate`, and what is to be run before it, up to `&&`."""

    arguments: Tuple[str, ...]
    first: str = ""


def start_of(scene, n, program=PROGRAM):
    """Returns the Start of a named scene. The developed one is the end of a run from the smooth one."""
    if scene != DEVELOPED:
        return Start(("--scene", scene))
    file = f"developed_n{n}.npy"
    return Start(("--initial", file), f"{program} --n {n} --scene smooth --integrator group5 --solver fast --step 0.05"
                                      f" --time 100 --output {file} && ")


def start_of_code(name, imports, code):
    """Returns the Start of a matrix that Python computes: `code`, after `imports`, is kept as the file NAME.npy."""
    statement = f"import numpy; {imports}; numpy.save({name + '.npy'!r}, {code})"
    return Start(("--initial", f"{name}.npy"), f'{PYTHON} "{statement}" && ')


def integrate_line(start, n, integrator, step, time, tolerance=TIGHT, solver=FAST, program=PROGRAM):
    """Returns the line that runs a listed integrator from a Start, step by step up to a time."""
    loose = ("--tolerance", repr(tolerance)) if tolerance != TIGHT else ()
    arguments = shlex.join((*start.arguments, *loose, "--integrator", integrator))
    return f"{start.first}{program} --n {n} {arguments} --solver {solver} --step {step!r} --time {time!r}"


def formulation_line(n, formulation, stages, step, time, solver):
    """Returns the line that runs a cell of Tables 1 and 2."""
    return (f"{PROGRAM} --n {n} --formulation {formulation} --stages {stages} --solver {solver} --step {step!r}"
            f" --time {time!r}")
