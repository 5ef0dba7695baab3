"""What the study `longruns` tries: methods, sizes, times and costs."""

from typing import NamedTuple

from lib.programs.command_line import Stop
from lib.records.formats import Integrator
from lib.records.integrators import EXPONENTIAL, GAUSS, MAGNUS, RKMK, RUNGE_KUTTA, is_fastest_formulation, is_new
from lib.records.settings import LOOSE_EXPONENTIAL, LOOSE_GAUSS, TIGHT
from lib.running import built
from studies.longruns.schema import CLASSES, COSTS, SCENES, Plan, class_of, method_of

# Of the methods (tolerances_of) what is run at large n, and in long runs; new ones are in both.
METHODS_AT_LARGE_N = ("rk4", "rk8", "rk8_projected", "magnus5", "elp6", "elp6_tight", "group2")
LONG_METHODS = ("rk4", "rk8", "rk8_projected", "rkmk4", "magnus5", "elp4", "elp4_tight", "elp6", "elp6_tight", "group2")
LARGE_N = 257  # from here on
LARGEST_N_OF = {"rk10": 33}  # of methods that are not in all lines
SCENES_AT = {513: ("rough",)}  # where not in both
# The first step is too long for most methods; it is as long at each n, over the size of B.
PLANS = {plan.n: plan for plan in (
    Plan(n=17, time=50.0, steps=25, energies=50, products=100.0),
    Plan(n=33, time=1000.0, steps=500, energies=200, products=300.0),
    Plan(n=65, time=100.0, steps=100, energies=100, products=300.0),
    Plan(n=129, time=20.0, steps=40, energies=40, products=300.0),
    Plan(n=257, time=5.0, steps=20, energies=20, products=400.0),
    Plan(n=513, time=1.0, steps=8, energies=8, products=400.0))}
SIZES, QUICK_SIZES = (33, 65, 129, 257, 513), (17,)
LONG_RUNS = {33: (1e4, 200), 17: (200.0, 40)}  # n: time and windows
DEFECT_SIZES, DEFECT_TIME = (17, 33), 2.0  # n and T of the symplectic defect


class Method(NamedTuple):
    integrator: Integrator
    tolerance: float

    @property
    def name(self):
        return method_of(self.integrator, self.tolerance)

    def is_among(self, names):
        return self.name in names or is_new(self.integrator)


def tolerances_of(integrator):
    """Returns the tolerances that an Integrator runs at; none for one that is not in the study."""
    family, order = integrator.family, integrator.order
    if is_new(integrator) or (integrator.explicit and not integrator.isospectral) or family == RKMK:
        return (TIGHT,)
    if integrator.projected:
        return (TIGHT,) if family == RUNGE_KUTTA and order in (4, 8) else ()
    if family == MAGNUS:
        return (LOOSE_EXPONENTIAL,) if order == 5 else ()
    if family == EXPONENTIAL:
        return (LOOSE_EXPONENTIAL, TIGHT) if order > 2 else (TIGHT,)
    if family == GAUSS and is_fastest_formulation(integrator) and order <= 6:
        return (TIGHT, LOOSE_GAUSS) if order == 4 else (TIGHT,)
    return ()


def methods_of(listed):
    """Returns the Methods of some Integrators, each in the frame where it has one, explicit ones first."""
    best = {each.method: each for each in sorted(listed, key=lambda each: each.co_rotating)}

    def place(each):
        kind = class_of(each, TIGHT)
        return CLASSES.index(kind) if kind else len(CLASSES), each.order if each.family == GAUSS else 0

    return [Method(each, tolerance) for each in sorted(best.values(), key=place) for tolerance in tolerances_of(each)]


def job_of(scene, n, method, **further):
    return {"scene": scene, "n": n, "integrator": method.integrator.name, "tolerance": method.tolerance, **further}


def lines_of(sizes, methods):
    """Returns the jobs of the lines, the longest last."""
    jobs = [job_of(scene, n, method) for n in sizes for scene in SCENES_AT.get(n, SCENES) for method in methods
            if n <= LARGEST_N_OF.get(method.name, n) and (n < LARGE_N or method.is_among(METHODS_AT_LARGE_N))]
    return sorted(jobs, key=lambda job: PLANS[job["n"]].time * job["n"]**3)


def long_runs_of(sizes, methods):
    """Returns the jobs of the long runs, the longest last: at the largest n that has such."""
    largest = [n for n in sizes if n in LONG_RUNS][-1:]
    return [job_of(scene, n, method, cost=cost) for n in largest for cost in COSTS for scene in SCENES
            for method in methods if method.is_among(LONG_METHODS)]


def asked_for(options):
    """Returns the n and the methods of the study. Throws Stop for those that it does not have."""
    sizes = sorted(set(options.n or (QUICK_SIZES if options.quick else SIZES)))
    for n in sizes:
        if n not in PLANS:
            raise Stop(f"--n {n}: must be one of {', '.join(map(str, PLANS))}")
    methods = methods_of(built.integrators().values())
    if not options.integrator:
        return sizes, methods
    names = {entry.method for entry in built.entries(options.integrator)}
    known = dict.fromkeys(method.integrator.method for method in methods)
    for name in sorted(names):
        if name not in known:
            raise Stop(f"--integrator {name}: is not in this study; must be one of {', '.join(known)}")
    return sizes, [method for method in methods if method.integrator.method in names]


def in_order(rows, methods):
    """Returns rows by n, scene, cost, method and steps."""
    places = {(method.integrator.name, method.tolerance): place for place, method in enumerate(methods)}
    return sorted(rows, key=lambda row: (row.n, SCENES.index(row.scene), getattr(row, "cost", 0),
                                         places[row.integrator, row.tolerance], row.steps))
