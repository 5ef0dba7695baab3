"""What the study `limits` tries: forms, sizes, scenes and states."""

from typing import NamedTuple, Tuple

from lib.programs.command_line import Stop
from lib.records.formats import FAST, PUBLISHED
from lib.records.integrators import IMPLICIT_EXPONENTIAL, TABLE1_CELLS, is_new
from lib.running import built
from lib.running.initial_states import SMOOTH, STATES
from studies.limits.schema import SCENES

# The plan names methods of the project's own comparisons, implicit and projected ones. Explicit ones without projection
# and new ones are found by rule.
CHOSEN = ("group1", "group2", "group3", "algebra1", "elp4", "elp6", "rk4_projected", "rk8_projected", "group2_frame",
          "group3_frame", "elp4_frame", "elp6_frame")
# What is tried at large n.
LARGE = ("algebra1", "group2_frame", "elp4_frame", "magnus5_frame", "rk4_frame", "rk8_frame")
QUICK = ("group2", "algebra1", "rkmk4", "rk4", "rk8")


class Plan(NamedTuple):
    """What is tried at some n: forms of a solver, in some scenes, from so many states."""

    solver: str
    sizes: Tuple[int, ...]
    names: Tuple[str, ...]
    scenes: Tuple[str, ...] = SCENES
    states: int = STATES
    long: bool = False  # whether long trials follow, from the scene's own state


def plans(quick):
    """Returns the Plans of the study. A form is in one Plan at each n.

    All trials of all forms would take days. At n = 17 all forms have all states and long trials. At n = 33 that holds
    for the fast forms `main` and for published forms of Table 1; others have the smooth scene's own state and short
    trials. Implicit exponential methods have each scene's own state only. Near their limit a step takes hundreds of
    sweeps, at n = 17 half a second each in fast form: there they have short trials in the smooth scene. Beyond, each
    scene has its own state only, and published forms and n ≥ 129 have the smooth scene.

    An earlier record tried more, and what it showed is why it is left out:
    - two more drawn states of each scene: they lowered the least limit of a case by 2 % in the median, though by more
      than a fifth in a quarter of the cases;
    - drawn states at n = 65: how much states differ is seen at n = 17 and 33;
    - published forms in other scenes at n = 65, the developed scene at n = 129: limits of the scenes' own states differ
      by 7 % in the median, those of a scene's states by 31 %;
    - published explicit methods in other scenes at n = 33: fast forms had the same limits, to bisection;
    - published cotangent forms beyond n = 17: group forms had the same limits, to bisection;
    - elp6_frame at n ≥ 129: elp4_frame had the same limits, to bisection;
    - elp4 and elp6 without the frame at n = 65: they had the limits of n = 33, to 7 %.
    Published forms in the co-rotating frame have never been tried.
    """
    def names(holds):
        return tuple(name for name, each in built.integrators().items() if holds(each))

    plain, fast = names(lambda each: not each.co_rotating), names(lambda each: each.has_fast_form)
    new = names(is_new)
    if quick:
        return [Plan(solver, (9, 17), within(forms, (*QUICK, *new)), (SMOOTH,), 2, long=True)
                for solver, forms in ((PUBLISHED, plain), (FAST, fast))]
    explicit = names(lambda each: each.explicit and not each.projected)
    exponential = names(lambda each: each.family in IMPLICIT_EXPONENTIAL)
    main = within(fast, dict.fromkeys((*CHOSEN, *explicit, *new)))
    large = within(fast, (*LARGE, *new))
    cells = names(lambda each: each.name in TABLE1_CELLS and each.formulation != "cotangent")
    return [Plan(PUBLISHED, (17,), without(exponential, plain), long=True),
            Plan(PUBLISHED, (17,), within(exponential, plain), states=1, long=True),
            Plan(PUBLISHED, (33,), cells, long=True),
            Plan(PUBLISHED, (33,), without(TABLE1_CELLS, plain), (SMOOTH,), 1),
            Plan(PUBLISHED, (65, 129), cells, (SMOOTH,), 1),
            Plan(FAST, (17,), without(exponential, fast), long=True),
            Plan(FAST, (17,), within(exponential, fast), (SMOOTH,), 1),
            Plan(FAST, (33,), without(exponential, main), long=True),
            Plan(FAST, (33,), within(exponential, fast), states=1, long=True),
            Plan(FAST, (33,), without((*main, *exponential), fast), (SMOOTH,), 1),
            Plan(FAST, (65,), without(within(plain, exponential), main), states=1, long=True),
            Plan(FAST, (129,), large, (SMOOTH,), 1, long=True),
            Plan(FAST, (257,), large, (SMOOTH,), 1)]


def without(some, names):
    return tuple(name for name in names if name not in some)


def within(some, names):
    return tuple(name for name in names if name in some)


def jobs_of(options):
    """Returns the jobs of the study that options ask for, the longest last."""
    jobs = [{"n": n, "solver": plan.solver, "integrator": name, "scene": scene, "state": state,
             "long": plan.long and state == 0}
            for plan in plans(options.quick) for n in plan.sizes for name in plan.names for scene in plan.scenes
            for state in range(plan.states)]
    if options.integrator:
        wanted = {entry.name for entry in built.entries(options.integrator)}
        jobs = [job for job in jobs if job["integrator"] in wanted]
    for name in ("n", "solver", "scene"):
        if getattr(options, name):
            jobs = [job for job in jobs if job[name] in getattr(options, name)]
    if not jobs:
        raise Stop("nothing is tried of these integrators, n, scenes and solvers together")
    return sorted(jobs, key=lambda job: (job["n"], job["solver"] == PUBLISHED))
