"""What the study `practice` runs: problems, methods with their tolerances, and how much of a run is timed."""

import math
from typing import NamedTuple

from lib.judging import verdicts
from lib.programs.command_line import Stop
from lib.records.integrators import chosen
from lib.records.settings import ENERGY_BOUNDED, LOOSE, MATCHED, TIGHT
from lib.running import built
from studies.practice.schema import BASELINE_SHARE, ROUGH, SMOOTH, TURBULENCE
from studies.turbulence.plan import sizes_of

# The names are keys of the plan: methods that the studies accuracy and turbulence found to be the cheapest of their
# class, or that people ask for. A method of a new family is tried besides.
METHODS = ("rk8", "rk5", "rk8_projected", "magnus5", "rkmk4", "elp4", "elp6", "group2")
LARGE_METHODS = ("rk8", "magnus5", "elp4")  # beyond MIDDLE, and by threads beyond SMALL
REFERENCES = ("rk8", "magnus5")  # explicit, not isospectral; and on the group, isospectral
SIZES, QUICK_SIZES = (129, 257, 513, 1025), (33,)
SCENE_SIZES = {SMOOTH: 257, ROUGH: 1025, TURBULENCE: 513}  # the largest n of each scene
SMALL, MIDDLE = 257, 513  # the largest n with times of 2, and of 0.5
TIMES = ((SMALL, 2.0), (MIDDLE, 0.5), (math.inf, 0.25))  # T, up to an n
SAMPLE = 0  # of the study turbulence, the same at every n

# Turbulence is developed by this method and step until degrees of at least TAIL_FROM (n - 1) have so much of the
# enstrophy: about what they have in the rough scene, where E(l) falls as l⁻³. It is looked at every TAIL_LOOK. What
# step is stable falls as 1/n: 0.5 diverges at n = 513.
DEVELOPING, MAX_DEVELOPING_STEP, DEVELOPING_STEP_BY_N = "rk8", 0.5, 96.0
TAIL_LOOK, MAX_DEVELOPING = 2.0, 400.0
TAIL_FROM, TAIL_SHARE = 0.9, 0.02

FRAME_GAIN = 0.99  # methods run in the co-rotating frame where ‖ad_B‖₂ is at most so many times that without it
RESOLVED = 3.0  # h‖ad_B‖₂ of the steps that searches begin with
REFERENCE_SHARE = 1e-4  # of the practice's error: a reference is at least so accurate, as its steps halved tell, or
FLOOR = 1e-12  # this accurate, which rounding allows at every n here
MAX_DIFFERENCE = 1e-3  # of two references, over the practice's error: a hundredth of the smallest wanted error
MAX_HALVINGS = 7
CLOSE = ((SMALL, 1.03), (math.inf, 1.1))  # the fewest steps are found to this factor, up to an n
MAX_SWEEPS = 30  # of a step: one that takes more is expensive, and shorter steps are cheaper
LOOKS = 20  # at the energy in a run

PROCESSES, QUICK_PROCESSES = verdicts.FEWEST, 1
LARGEST_WHOLE, LARGEST_WHOLE_QUFLOW = SMALL, 129  # n up to which whole runs are timed, and those of quflow's step
PLACES = 3  # of a run, beyond that, in turn by process: its beginning, after a third and after two thirds of it, with
PART_STEPS, WARM_STEPS = 20, 32  # timed steps behind some that are not, at most a third of the run, and no more than
PART_WORK = 5e10  # floating-point operations of products take, if that allows one step
THREADS, THREAD_SCENE, LARGEST_THREADED = (1, 2), ROUGH, 513


class Form(NamedTuple):
    """An integrator at a tolerance."""

    integrator: str
    tolerance: float


def up_to(table, n):
    """Returns the value of a table of (largest n, value) at n."""
    return next(value for largest, value in table if n <= largest)


def problems_of(sizes, scenes):
    """Returns what is solved as dicts of scene, n and time, those that take longest last.

    Throws Stop for an n that is too small for the modes of turbulence, and where nothing is left.
    """
    found = [{"scene": scene, "n": n, "time": up_to(TIMES, n)} for n in sizes_of(sizes) for scene in scenes
             if n <= SCENE_SIZES[scene]]
    if not found:
        raise Stop("no problem has this scene and n")
    return found


def steps_a_look(n):
    """Returns the number of steps between two looks at turbulence that develops."""
    return math.ceil(TAIL_LOOK / min(MAX_DEVELOPING_STEP, DEVELOPING_STEP_BY_N / n))


def practice_steps(problem):
    """Returns the number of steps of the practice: h is ħ/4 or a little less, with the paper's ħ."""
    n = problem["n"]
    return math.ceil(problem["time"] / (BASELINE_SHARE * 2 / (n * (n - 1)) ** 0.5))


def methods_of(n, in_frame, asked=None):
    """Returns the Integrators that run at an n, in the co-rotating frame where they have one and it helps."""
    names = asked or (METHODS if n <= MIDDLE else LARGE_METHODS)
    found = chosen(built.integrators().values(), names, in_frame)
    return [each for name, each in found.items() if not asked or each.method in asked]


def has_threads(name, n):
    """Tells whether an integrator is timed by several threads at an n: fast forms, whose work they share."""
    entry = built.integrators()[name]
    return entry.has_fast_form and (n <= LARGEST_WHOLE or entry.method in LARGE_METHODS)


def is_explicit(name):
    return built.integrators()[name].explicit


def reference_methods(in_frame):
    """Returns the names of the integrators that find the solution."""
    found = chosen(built.integrators().values(), REFERENCES, in_frame).values()
    return [each.name for each in found if each.method in REFERENCES]


def forms_of(entry, error, n):
    """Returns the Forms of an Integrator for an error: at the tolerance that it needs, and with bounded energy.

    That is the loosest tolerance of its family that leaves trajectories alone, or MATCHED times less than the error as
    a power of ten. Lie–Poisson methods run up to MIDDLE at one besides at which their energy stays bounded.
    """
    loosest = LOOSE.get(entry.family, TIGHT)
    matched = 10.0 ** math.floor(math.log10(error / MATCHED) + 1e-9)
    needed = max(min(loosest, matched), TIGHT)
    bounded = (ENERGY_BOUNDED,) if entry.lie_poisson and n <= MIDDLE else ()
    return [Form(entry.name, float(f"{tolerance:.0e}")) for tolerance in dict.fromkeys((needed, *bounded))]


def part_of(n, steps, work, explicit):
    """Returns how many steps at a place of a run are not timed, and how many are, given its steps and products."""
    affordable = math.floor(PART_WORK / (8 * n**3 * work / steps))
    third = max(1, steps // PLACES)
    timed, warm = (max(1, min(maximum, third, affordable)) for maximum in (PART_STEPS, WARM_STEPS))
    return (0 if explicit else warm), timed
