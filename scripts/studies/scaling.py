#!/usr/bin/env python3
"""Times a step of every integrator in its published and fast form, and without each idea of the fast form in turn.

Everything is timed on the same stretch: the first steps from the initial data of the smooth scene, h = 0.1. Exponential
methods, which are for long steps at a loose tolerance, are timed on one of their own. A few fast forms are timed once
at large n.
"""

import os
import sys
from functools import partial

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from lib import study

PROGRAM = "scaling"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
from lib import formats
from lib.accuracy_lines import LOOSE_EXPONENTIAL, TIGHT, keeping_tolerance
from lib.command_line import whole_number
from lib.formats import FAST
from lib.integrator_names import is_exponential
from lib.scaling_table import (EXPONENTIAL_RUNGS, NEEDS_ITERATION, RUNGS, SCHEMA, ExponentialPoint,
                               LargePoint, Point, Settings, exponential_rungs, family_of)

SIZES, QUICK_SIZES = (17, 33, 65, 129), (17, 33)
QUICK_INTEGRATORS = ("cotangent2", "group2", "algebra2", "kahan_li6", "elp4", "magnus5", "rkmk4", "rk4")
SCENE, STEP, STEPS, REPETITIONS = "smooth", 0.1, 20, 7
EXPONENTIAL_STEP = 0.5  # of these methods and of RKMK4, at the loose tolerance of exponential methods
LARGE_SIZES, LARGE_SCENES = (257, 513), ("smooth", "rough")
LARGE_EXPONENTIAL_STEP = 0.25  # a step of 0.5 fails in the rough scene at n = 513
LARGE_INTEGRATORS = ("elp4_frame", "elp6_frame", "group2_frame", "rk4_frame")


def made(point):
    """Returns the scene of a point, and its integrator as new, so that no repetition knows of the one before."""
    solver, without = {**RUNGS, **EXPONENTIAL_RUNGS}[point["rung"]]
    scene = isosyrk.scene(point["scene"], n=point["n"])
    products = {} if solver == FAST else {"products": point["products"]}
    return scene, isosyrk.integrator(scene, point["integrator"], solver=solver, tolerance=point["tolerance"],
                                     without=without, **products)


def count(point):
    """Returns the counts of a point, each for a step; None where a step fails."""
    scene, integrator = made(point)
    try:
        _, report = integrator.run(scene.initial, h=point["step"], steps=STEPS)
    except isosyrk.SolverError:
        return None
    return {"sweeps": report.sweeps / STEPS, "equivalent_products": report.equivalent_products / STEPS}


def time_one(point):
    """Returns the CPU seconds of the stretch: as the mean of a few runs of it."""
    scene, integrator = made(point)
    return study.seconds_of(integrator, scene.initial, point["step"], STEPS)


def rungs_of(entry):
    """Returns the rungs that there are for an integrator."""
    return [rung for rung, (solver, without) in RUNGS.items()
            if not (entry.explicit and NEEDS_ITERATION & {*without}) and (solver != FAST or entry.has_fast_form)]


def stretch(name):
    """Returns the step and the tolerance at which a method is timed at large n."""
    return {"step": LARGE_EXPONENTIAL_STEP if is_exponential(name) else STEP, "tolerance": keeping_tolerance(name)}


def points_on_the_stretch(entries, sizes, journal):
    """Returns the points of all methods but exponential ones. RKMK4 has both kinds of points."""
    return [{"integrator": entry.name, "n": n, "rung": rung, "products": journal.products(n), "scene": SCENE,
             "step": STEP, "tolerance": TIGHT}
            for n in sizes for entry in entries if family_of(entry.name) in (None, "rkmk") for rung in rungs_of(entry)]


def exponential_points(entries, sizes, journal):
    return [{"integrator": entry.name, "n": n, "rung": rung, "products": journal.products(n), "scene": SCENE,
             "step": EXPONENTIAL_STEP, "tolerance": LOOSE_EXPONENTIAL}
            for n in sizes for entry in entries if family_of(entry.name) for rung in exponential_rungs(entry.name)]


def large_points():
    return [{"integrator": name, "n": n, "rung": FAST, "scene": scene, **stretch(name)}
            for n in LARGE_SIZES for scene in LARGE_SCENES for name in LARGE_INTEGRATORS]


def record(kind, point, **found):
    """Returns a point as a row of its table."""
    values = {**point, **found}
    return kind(*(values[name] for name in kind._fields))


def main(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=whole_number(1, 1000), default=REPETITIONS, help="(default: %(default)s)")
    parser.add_argument("--no-large", action="store_true",
                        help=f"not n = {' and '.join(map(str, LARGE_SIZES))}; nor with --quick, --n, --integrator")
    options = parser.parse_args(arguments)
    sizes = sorted(set(options.n or (QUICK_SIZES if options.quick else SIZES)))
    entries = study.entries(options.integrator or (QUICK_INTEGRATORS if options.quick else None))
    has_large = not (options.no_large or options.quick or options.n or options.integrator)

    journal = study.Journal(PROGRAM, options, partial(isosyrk.conditions, products="fastest", sizes=sizes))
    exponential = exponential_points(entries, sizes, journal)
    points = [*points_on_the_stretch(entries, sizes, journal), *exponential]
    counts = study.untimed(points, count, journal, options, "counting")
    done = [(point, found) for point, found in zip(points, counts) if found]
    large = large_points() if has_large else []
    of_large = study.untimed(large, count, journal, options, "counting at large n") if large else []
    seconds = study.in_turns([point for point, _ in done], options.repetitions, time_one, journal, "timing")
    once = iter(study.in_turns([point for point, found in zip(large, of_large) if found], 1, time_one, journal,
                               "timing at large n") if large else [])
    rates = {n: isosyrk.product_rate(n) for n in sorted({point["n"] for point in large})}

    tables = {"points": [], "exponential": [], "large": []}
    for (point, found), times in zip(done, seconds):
        name, kind = ("exponential", ExponentialPoint) if point in exponential else ("points", Point)
        tables[name].append(record(kind, point, **found, seconds=[each / STEPS for each in times]))
    failed = dict.fromkeys(("sweeps", "equivalent_products"))
    for point, found in zip(large, of_large):
        tables["large"].append(record(LargePoint, point, **(found or failed), product_rate=rates[point["n"]],
                                      seconds=next(once)[0] / STEPS if found else None))
    formats.write_study(options.out, SCHEMA, journal.context, Settings(SCENE, STEP, STEPS), tables)
    journal.remove()


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
