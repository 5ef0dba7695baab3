"""What the study of claims runs: cells of Table 1 in GNU Octave, with samples of initial data, and by threads."""

from typing import NamedTuple, Tuple

from lib.programs.command_line import Stop
from lib.programs.messages import one_line
from lib.records.integrators import TABLE1_CELLS

STEP, STEPS, TOLERANCE = 0.1, 50, 1e-13
SIZES, QUICK_SIZES = (17, 33, 65, 129), (17, 33)
SEVERAL_UP_TO = 33  # the n up to which a process runs a cell more than once
REPETITIONS = 2  # of which the least counts
SAMPLES, QUICK_SAMPLES = 5, 2  # with each ħ
SAMPLE_SIZES, QUICK_SAMPLE_SIZES = (17, 33, 65), (17,)
# n of the runs by threads, with their h and number of steps: h‖B(W₀)‖₂ is that of n = 129 in Table 1 from there on.
THREAD_RUNS = {65: (0.1, 20), 129: (0.1, 10), 257: (0.05, 5)}
QUICK_THREAD_SIZES = (65,)
THREAD_STAGES, THREADS = (2, 3), (1, 2)


class Sizes(NamedTuple):
    """The n of each part of the study."""

    octave: Tuple[int, ...]
    samples: Tuple[int, ...]
    threads: Tuple[int, ...]


WHOLE = Sizes(SIZES, SAMPLE_SIZES, tuple(THREAD_RUNS))
QUICK = Sizes(QUICK_SIZES, QUICK_SAMPLE_SIZES, QUICK_THREAD_SIZES)


def cells_of(options):
    """Returns the cells of Table 1 that --integrator names, all without it. Throws Stop for one that is none."""
    for name in options.integrator or ():
        if name not in TABLE1_CELLS:
            raise Stop(f"--integrator {one_line(name)!r}: must be one of {', '.join(TABLE1_CELLS)}")
    return [name for name in TABLE1_CELLS if not options.integrator or name in options.integrator]


def sizes_of(options):
    """Returns the Sizes that --n and --quick ask for. Throws Stop for an n that no part has."""
    known = sorted({n for sizes in WHOLE for n in sizes})
    for n in options.n or ():
        if n not in known:
            raise Stop(f"--n {n}: must be one of {', '.join(map(str, known))}")
    sizes = QUICK if options.quick and not options.n else WHOLE
    return Sizes(*(tuple(n for n in each if not options.n or n in options.n) for each in sizes))
