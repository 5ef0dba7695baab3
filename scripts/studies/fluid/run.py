"""Runs one turbulent flow by explicit methods and a Lie–Poisson method, and keeps its vorticity and energies.

Nothing is timed. At their steps the explicit methods form as many products as each other.
"""

import math
from functools import partial

import isosyrk
import numpy

from lib.programs.command_line import Stop
from lib.programs.messages import one_line
from lib.records import formats
from lib.records.formats import INTEGRATORS, to_digits
from lib.running import built, program, untimed
from lib.running.checkpoint import Checkpoint
from studies.fluid.schema import COLUMNS, ROWS, SCALE, SCHEMA, End, Settings, Start
from studies.turbulence.plan import sizes_of, with_new
from studies.turbulence.single_runs import drawn_scene

SIZE, QUICK_SIZE, SAMPLE = 129, 33, 0
TIME, QUICK_TIME = 999.0, 60.0  # a whole number of steps of each
STEPS = {"rk4": 0.25, "rk8": 0.75, "elp4": 0.5}  # at n = SIZE; elsewhere as many times longer as n is smaller
TOLERANCE = 1e-8
DIGITS = 5


def cells(count):
    """Returns the middles of `count` cells from -1/2 to 1/2."""
    return (numpy.arange(count) + 0.5) / count - 0.5


def vorticity_of(W):
    """Returns ω in the cells of the grid, an array of shape (ROWS, COLUMNS)."""
    return isosyrk.vorticity(W, math.pi * cells(ROWS), 2 * math.pi * cells(COLUMNS))


def state_of(W, largest):
    """Returns the fields of a Start, given the largest |ω| at the start."""
    shares = SCALE * vorticity_of(W) / largest
    return {"energies": [to_digits(each, DIGITS) for each in isosyrk.energy_spectrum(W)[1:].tolist()],
            "vorticity": numpy.rint(shares).astype(int).ravel().tolist()}


def largest_of(scene):
    """Returns the largest |ω| of a cell at the start."""
    return to_digits(float(abs(vorticity_of(scene.initial)).max()), DIGITS)


def end_of(job):
    """Returns the fields of the End of a job's run; None if a step fails."""
    scene = drawn_scene(job["n"], job["sample"])
    method = isosyrk.integrator(scene, job["integrator"], solver=built.solver_of(job["integrator"]),
                                tolerance=job["tolerance"])
    steps = round(job["time"] / job["step"])
    try:
        W, report = method.run(scene.initial, job["step"], steps)
    except isosyrk.SolverError:
        return None
    initial = scene.initial
    found = {"time": steps * job["step"], "products": report.equivalent_products,
             "energy_error": abs(scene.energy(W) / scene.energy(initial) - 1),
             "enstrophy": float(numpy.linalg.norm(W) / numpy.linalg.norm(initial)) ** 2,
             "spectrum_error": isosyrk.spectrum_error(W, initial)}
    return {**{name: job[name] for name in ("integrator", "step", "tolerance")},
            **{name: to_digits(value, DIGITS) for name, value in found.items()}, **state_of(W, largest_of(scene))}


def jobs_of(n, time, names):
    """Returns a job for each method. Throws Stop for a name that has no step here."""
    steps = with_new(STEPS)
    for name in names or ():
        if name not in steps:
            raise Stop(f"--integrator {one_line(name)!r}: must be one of {', '.join(steps)}")
    return [{"n": n, "sample": SAMPLE, "integrator": name, "step": to_digits(step * (SIZE - 1) / (n - 1), 3),
             "tolerance": TOLERANCE, "time": time} for name, step in steps.items() if name in (names or steps)]


def main(arguments):
    options = program.parser("fluid", __doc__.splitlines()[0]).parse_args(arguments)
    n, *more = sizes_of(options.n or [QUICK_SIZE if options.quick else SIZE])
    if more:
        raise Stop(f"--n {n} {more[0]}: one n is drawn")
    jobs = jobs_of(n, QUICK_TIME if options.quick else TIME, options.integrator)
    checkpoint = Checkpoint("fluid", options, partial(isosyrk.conditions, sizes=[n]))
    ends = untimed.results(jobs, end_of, checkpoint, options, "runs")
    scene = drawn_scene(n, SAMPLE)
    largest = largest_of(scene)
    formats.write_study(options.out, SCHEMA, checkpoint.context, Settings(n, SAMPLE, largest), {
        INTEGRATORS: built.entries([job["integrator"] for job in jobs]),
        "starts": [Start(**state_of(scene.initial, largest))], "ends": [End(**each) for each in ends if each]})
    checkpoint.remove()
