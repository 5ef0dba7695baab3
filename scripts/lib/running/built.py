"""What the build has made: the module isosyrk with its list of integrators, and the programs of benchmarks/."""

import functools
import math
import os
import sys

from lib.programs import chart_python
from lib.programs.command_line import Stop
from lib.programs.messages import one_line
from lib.programs.places import BUILD, MODULE
from lib.records.formats import Integrator


def require_module(program, modules=("isosyrk", "numpy", "tqdm")):
    """Makes isosyrk importable; where this Python lacks a module, starts the script again under one that has them all.

    Exits with 2 and one line, which begins with the name `program`, if there is none.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # NumPy's; the module's products take one thread anyway
    if os.path.isdir(MODULE):
        sys.path.insert(0, MODULE)
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (MODULE, os.environ.get("PYTHONPATH"))))
    chart_python.require(program, modules,
                         "build it with scripts/reproduce accuracy, or install python3-numpy and python3-tqdm")


def program(name):
    """Returns the path of a program of the build. Throws Stop where it is not there."""
    path = os.path.join(BUILD, "benchmarks", name)
    if not os.access(path, os.X_OK):
        raise Stop(f"{one_line(path)}: is not built; build it with cmake --build, or with scripts/reproduce scaling")
    return path


@functools.lru_cache(maxsize=None)
def integrators():
    """Returns the Integrators of the module's list by name."""
    import isosyrk  # only now: where it is, require_module() finds
    found = ({field: getattr(each, field) for field in Integrator._fields} for each in isosyrk.integrators())
    return {each["name"]: Integrator(**{**each, "stability_limit": finite_or_none(each["stability_limit"])})
            for each in found}


def finite_or_none(value):
    return value if math.isfinite(value) else None


def entries(names, frames=False):
    """Returns the Integrators of these names in the module's list. Throws Stop for an unknown name.

    None stands for all; for those in the co-rotating frame only where `frames` says so, since each doubles a study.
    """
    for name in names or ():
        if name not in integrators():
            raise Stop(f"--integrator {one_line(name)!r}: must be one of {', '.join(integrators())}")
    every = (name for name, each in integrators().items() if frames or not each.co_rotating)
    return [integrators()[name] for name in dict.fromkeys(names or every)]


def solver_of(name):
    """Returns the solver of the best form of an integrator: fast where there is one."""
    return integrators()[name].best_form
