"""Steps at which a step is timed, and sizes that memory allows; the study `scaling` has the same."""

import math

from lib.programs.command_line import say
from lib.records.settings import LOOSE_EXPONENTIAL, TIGHT

STEP, LONG_STEP = 0.1, 0.25  # of Table 1; of exponential methods, with which a step of 0.5 fails at n = 257
FULL_STEPS = 257  # the largest n with these steps; at n = 1025 both fail in the first step from t = 0
FEW, ONCE, ONCE_START = ("group2_frame", "elp4_frame"), 1025, 5.0
MIN_MEMORY = 4e9  # bytes that must be free for n = ONCE; the process that times it takes 1.9e9


def long_step(integrator):
    """Tells whether an Integrator is timed at the long step and the loose tolerance of exponential methods."""
    return integrator.spectrum_at_any_tolerance and not integrator.projected


def step_of(entry, n):
    """Returns the step and the tolerance of an integrator at n."""
    is_long = long_step(entry)
    return {"step": shrunk(n, LONG_STEP if is_long else STEP), "tolerance": LOOSE_EXPONENTIAL if is_long else TIGHT}


def shrunk(n, length):
    """Returns a step, or a time that is some steps long, as it is at n: beyond FULL_STEPS it falls as 1/(n - 1)."""
    return length * min(1.0, (FULL_STEPS - 1) / (n - 1))


def free_memory():
    """Returns the bytes that this machine can give without swapping; infinity where it does not tell."""
    try:
        with open("/proc/meminfo", encoding="ascii") as lines:
            return next(1024.0 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    except (OSError, StopIteration, ValueError):
        return math.inf


def affordable(sizes):
    """Returns sizes, the smallest first; without n = ONCE, which is told, where memory is short."""
    sizes = sorted(set(sizes))
    if ONCE in sizes and free_memory() < MIN_MEMORY:
        say(f"n = {ONCE} is left out: it wants {MIN_MEMORY / 1e9:g} GB of free memory")
        sizes.remove(ONCE)
    return sizes
