"""quflow's own step: the isospectral midpoint of a checkout, called as quflow calls it, with its defaults.

Source: Modin et al., github.com/klasmodin/quflow. Its own ħ is 2/sqrt(N² − 1): dt is scaled, so that the flow is that
of the other methods. The packages of quflow that a step does not need are not loaded.
"""

import importlib
import importlib.util
import os
import subprocess
import sys
import time
import types
import warnings

from lib.programs.command_line import Stop
from lib.programs.messages import one_line

NEEDS = ("numba", "scipy")  # of its step alone
WHERE = os.path.join("quflow", "integrators", "isospectral.py")
PRODUCTS = 2  # an iteration


def checkout():
    """Returns the folder that QUFLOW names and its commit, or (None, None). Throws Stop where it cannot be run."""
    folder = os.environ.get("QUFLOW")
    if not folder:
        return None, None
    named = f"QUFLOW {one_line(folder)}:"
    if not os.path.isfile(os.path.join(folder, WHERE)):
        raise Stop(f"{named} is no checkout of quflow (it has no {WHERE})")
    for module in NEEDS:
        if importlib.util.find_spec(module) is None:
            raise Stop(f"{named} needs {module}; install python3-{module}, or leave QUFLOW out")
    head, changes = (subprocess.run(["git", "-C", folder, *question], capture_output=True, encoding="utf-8",
                                    check=False) for question in (
        ("rev-parse", "--short=12", "HEAD"), ("status", "--porcelain", "--untracked-files=no", "--", "quflow")))
    if head.returncode != 0:
        raise Stop(f"{named} is no checkout of quflow (git does not tell its commit)")
    return os.path.realpath(folder), head.stdout.strip() + ("-dirty" if changes.stdout else "")


def isomp_of(folder):
    """Returns quflow's isomp, from a checkout."""
    if "quflow" not in sys.modules:
        os.environ["NUMBA_NUM_THREADS"] = "1"
        package = types.ModuleType("quflow")  # without what it imports for pictures and transforms
        package.__path__ = [os.path.join(folder, "quflow")]
        sys.modules["quflow"] = package
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of escape sequences
        return importlib.import_module("quflow.integrators.isospectral").isomp


def dt_of(n, h):
    """Returns quflow's dt for a step h of the flow with the paper's ħ, 2/sqrt(n(n − 1))."""
    return h * (n / (n + 1)) ** 0.5


def run(folder, W, h, steps, callback=None):
    """Returns W after so many steps of h, and what quflow told: iterations a step, capped steps a step, tolerance."""
    stats = {"iterations": 0.0}  # an empty one would stay empty
    end = isomp_of(folder)(W.copy(), dt_of(len(W), h), steps=steps, stats=stats, callback=callback)
    return end, stats


def seconds_of(folder, W, h, steps, warmup=0):
    """Returns the CPU seconds of some steps, behind `warmup` others. Its compiler has done its work before."""
    run(folder, W, h, 1)
    marks = [time.process_time()]
    run(folder, W, h, warmup + steps, lambda *_: marks.append(time.process_time()))
    return marks[-1] - marks[warmup]
