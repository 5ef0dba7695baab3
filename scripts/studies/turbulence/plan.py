"""What the study `turbulence` tries: methods, steps and tolerances at each n, and how many samples."""

import math
from typing import NamedTuple

from lib.programs.command_line import Stop
from lib.programs.messages import one_line
from lib.records.integrators import chosen
from lib.running import built
from studies.turbulence import single_runs as runs
from studies.turbulence.schema import LOOSE, METHOD, BASELINE, BASELINE_INTEGRATOR, BASELINE_SHARE, Setting

SIZES, QUICK_SIZES = (33, 65, 257), (33,)
# More accurate than all that is judged by it: its energy is off by 1e-11 at n = 33, T = 1000. Beyond LARGE_N its step
# is half as long from one n to the next, as that of others.
REFERENCE_METHOD = Setting("rk8", 0.25, 1e-10)
# Steps of each method around the longest that is faithful, at n = 33; it is about half as long at twice the n. A new
# integrator has those of the method that is most like it (with_new). Nothing is in the co-rotating frame: the data have
# no part with l = 1, so that it would change nothing.
STEPS = {
    "algebra1": (0.25, 0.375, 0.5),
    "group2": (0.5, 1.0),
    "group3": (1.0, 2.0),
    "elp4": (1.0, 2.0),
    "elp6": (1.0, 2.0),
    "magnus5": (0.5, 1.0),
    "rkmk4": (0.5, 1.0),
    "rk4": (0.25, 0.375, 0.5),
    "rk8": (1.0, 1.5, 2.0),
    "abm8": (0.15, 0.2, 0.25),
    "rk4_projected": (0.25, 0.375, 0.5),
    "rk8_projected": (1.5, 2.0, 3.0),
}
LADDER = {"group2": (1.0, 1e-4), "elp4": (1.0, 1e-4)}  # a step and a looser tolerance
FEW = ("algebra1", "group2", "elp4", "rk4", "rk8")  # methods at LARGE_N, with two steps each
# At still larger n: the cheapest faithful settings of n = 65, of all, with the spectrum, Lie–Poisson, and Gauss.
CHEAPEST, CHEAPEST_LOOSE = {"rk8": (1.5,), "rk8_projected": (1.5,), "algebra1": (0.25,)}, "elp4"
QUICK_STEPS = {"algebra1": (0.5, 1.0), "elp4": (0.5, 1.0), "rk4": (0.25, 0.5), "rk8": (0.75, 1.5)}


class Plan(NamedTuple):
    """What is run at an n."""

    samples: int
    references: int  # ensembles
    far: int  # ensembles
    reference: Setting
    time: float
    steps: dict  # of each integrator
    ladder: dict


SMALL_N, LARGE_N = 33, 129  # up to which n steps are those listed; from which n on few are run
# Beyond LARGE_N, where more would take longer than 100 minutes on two cores: too few samples for a verdict, and half of
# the time. At n = 257 a reference run to T = 1000 takes some six minutes, one of the baseline forty.
FEWEST_SAMPLES, SHORTER_TIME, FEWEST_REFERENCES, FEWEST_FAR = 2, 500.0, 3, 4


def with_new(steps):
    """Returns steps by integrator, new ones included: theirs are those of the nearest order among methods that are
    explicit or not as they are."""
    listed = built.integrators()

    def distance(name, each):
        return listed[name].explicit != each.explicit, abs(listed[name].order - each.order)

    return {name: steps[name] if name in steps else steps[min(steps, key=lambda other: distance(other, each))]
            for name, each in chosen(listed.values(), steps).items()}


def plan_of(n, quick):
    """Returns the Plan at an n. Steps are half as long from one of n = 33, 65, 129 … to the next."""
    if quick:
        return Plan(3, 3, 4, REFERENCE_METHOD, 100.0, with_new(QUICK_STEPS), {})
    parts, shorter = parts_of(n, LARGE_N), parts_of(n, SMALL_N)

    def scaled(steps):
        return with_new({name: tuple(step / shorter for step in each) for name, each in steps.items()})

    ladder = {name: (step / shorter, tolerance) for name, (step, tolerance) in LADDER.items()}
    reference = REFERENCE_METHOD._replace(step=REFERENCE_METHOD.step / parts)
    if parts > 1:
        return Plan(FEWEST_SAMPLES, FEWEST_REFERENCES, FEWEST_FAR, reference, SHORTER_TIME, scaled(CHEAPEST),
                    {CHEAPEST_LOOSE: ladder[CHEAPEST_LOOSE]})
    if n >= LARGE_N:
        few = {name: STEPS[name][:2] for name in FEW}
        return Plan(6, 4, 4, reference, 1000.0, scaled(few), {})
    return Plan(12 if n <= SMALL_N else 10, 6, 6, reference, 1000.0, scaled(STEPS), ladder)


def parts_of(n, unit):
    """Returns into how many parts steps are divided at an n: 1 up to n = `unit`, twice as many from each n of
    33, 65, 129 … beyond to the next."""
    return 2 ** max(0, round(math.log2((n - 1) / (unit - 1))))


def settings_of(n, plan, names):
    """Returns the settings at an n with their roles, as (role, Setting). The baseline is always among them."""
    found = [(BASELINE, Setting(BASELINE_INTEGRATOR, BASELINE_SHARE * 2 / (n * (n - 1)) ** 0.5, LOOSE))]
    for name in names:
        found += [(METHOD, Setting(name, step, LOOSE)) for step in plan.steps.get(name, ())]
        found += [(METHOD, Setting(name, *plan.ladder[name]))] if name in plan.ladder else []
    return found


def names_of(wanted):
    """Returns the integrators to run. Throws Stop for one that has no steps here."""
    known = chosen(built.integrators().values(), STEPS)
    for name in wanted or ():
        if name not in known:
            raise Stop(f"--integrator {one_line(name)!r}: must be one of {', '.join(known)}")
    return list(dict.fromkeys(wanted or known))


def sizes_of(wanted):
    """Returns the sizes to run at. Throws Stop for one that is too small for the modes."""
    minimum = runs.DEGREES[-1] + 1
    for n in wanted:
        if n < minimum:
            raise Stop(f"--n {n}: must be at least {minimum}, for modes up to l = {minimum - 1}")
    return sorted(set(wanted))
