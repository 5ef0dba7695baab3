#!/usr/bin/env python3
"""Times a step of every integrator in its published and fast form, and without each idea of the fast form in turn.

Everything is timed on the same stretch: the first steps from the initial data of the smooth scene, h = 0.1.
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
from lib.command_line import whole_number
from lib.scaling_table import NEEDS_ITERATION, RUNGS, SCHEMA, Point, Settings

SIZES, QUICK_SIZES = (17, 33, 65, 129), (17, 33)
QUICK_INTEGRATORS = ("cotangent2", "group2", "algebra2", "kahan_li6", "rkmk4", "rk4")
SCENE, STEP, STEPS, REPETITIONS = "smooth", 0.1, 20, 7


def made(point):
    """Returns the scene of a point, and its integrator as new, so that no repetition knows of the one before."""
    solver, without = RUNGS[point["rung"]]
    scene = isosyrk.scene(SCENE, n=point["n"])
    products = {} if solver == "fast" else {"products": point["products"]}
    return scene, isosyrk.integrator(scene, point["integrator"], solver=solver, without=without, **products)


def count(point):
    """Returns the counts of a point, each for a step; None where a step fails."""
    scene, integrator = made(point)
    try:
        _, report = integrator.run(scene.initial, h=STEP, steps=STEPS)
    except isosyrk.SolverError:
        return None
    return {"sweeps": report.sweeps / STEPS, "equivalent_products": report.equivalent_products / STEPS}


def time_one(point):
    """Returns the CPU seconds of the stretch: as the mean of a few runs of it."""
    scene, integrator = made(point)
    return study.seconds_of(integrator, scene.initial, STEP, STEPS)


def rungs_of(entry):
    """Returns the rungs that there are for an integrator."""
    return [rung for rung, (solver, without) in RUNGS.items()
            if not (entry.explicit and NEEDS_ITERATION & {*without}) and (solver != "fast" or entry.has_fast_form)]


def main(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=whole_number(1, 1000), default=REPETITIONS, help="(default: %(default)s)")
    options = parser.parse_args(arguments)
    sizes = sorted(set(options.n or (QUICK_SIZES if options.quick else SIZES)))
    entries = study.entries(options.integrator or (QUICK_INTEGRATORS if options.quick else None))

    journal = study.Journal(PROGRAM, options, partial(isosyrk.conditions, products="fastest", sizes=sizes))
    points = [{"integrator": entry.name, "n": n, "rung": rung, "products": journal.products(n)}
              for n in sizes for entry in entries for rung in rungs_of(entry)]
    counts = study.untimed(points, count, journal, options, "counting")
    done = [(point, found) for point, found in zip(points, counts) if found]
    seconds = study.in_turns([point for point, _ in done], options.repetitions, time_one, journal, "timing")
    rows = [Point(point["integrator"], point["n"], point["rung"], **found, seconds=[each / STEPS for each in times])
            for (point, found), times in zip(done, seconds)]
    formats.write_study(options.out, SCHEMA, journal.context, Settings(SCENE, STEP, STEPS), {"points": rows})
    journal.remove()


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
