"""Solves the problems of scripts/lib/running/problems.py to near rounding; errors are measured against these solutions.

The fast forms of two integrators of different kinds solve each, with twice the steps until another doubling would not
show: Gauss with s = 8 in the group form, and explicit RKMK of order 4. Their difference is the uncertainty. Each
references.json says what its matrices, the solutions of the first, are solutions of. What is there is kept.
"""

import io
import json
import math
import os

import isosyrk
import numpy

from lib.programs.command_line import NO_ANSWER, Stop, say
from lib.programs.messages import UnusableFile
from lib.programs.output import make_folder, replace_file
from lib.records.formats import FAST, to_digits
from lib.records.settings import Problem
from lib.running import built, problems, program, untimed
from lib.running.checkpoint import Checkpoint

INTEGRATORS = ("group8", "rkmk4")
TOLERANCE = 1e-14
LONGEST_STEP, SHORTEST_STEP = 0.05, 0.0001
AIM = 0.05  # an estimated error of this share of the largest uncertainty is small enough, ...
MIN_HALVED = 1e-10  # ... and below this, an error that a doubling does not halve is rounding
DEVELOPING_STEP = 0.1  # to DEVELOPED_TIME; half the step must lead to the same energies to six digits
LARGEST_DIFFERENCE = problems.DIGITS / 10


def refine(scene, time, integrator, aim):
    """Returns (W, number of steps) at which the error, estimated from the last doubling, is below `aim` or at rounding.

    The estimate is Richardson's: change / (2^order − 1). Throws Stop if no number of steps converges.
    """
    (entry,) = built.entries([integrator])
    method = isosyrk.integrator(scene, integrator, solver=FAST, tolerance=TOLERANCE)
    best, last_change, steps = None, math.inf, round(time / LONGEST_STEP)
    while time / steps >= SHORTEST_STEP:
        try:
            W, _ = method.run(scene.initial, time / steps, steps)
        except isosyrk.SolverError:
            if best:
                break
        else:
            change = isosyrk.relative_error(best[0], W) if best else math.inf
            if best and change < MIN_HALVED and change >= last_change / 2:
                break
            best, last_change = (W, steps), change
            if change / (2**entry.order - 1) < aim:
                break
        steps *= 2
    if best is None:
        raise Stop(f"reference at n = {scene.n}: {integrator} did not converge at {steps // 2} steps",
                         NO_ANSWER)
    return best


def develop(n):
    """Returns the initial data of the developed scene. Throws Stop if half the step leads elsewhere."""
    scene = isosyrk.scene("smooth", n=n)
    method = isosyrk.integrator(scene, INTEGRATORS[0], solver=FAST)
    steps = round(problems.DEVELOPED_TIME / DEVELOPING_STEP)
    W, finer = (method.run(scene.initial, problems.DEVELOPED_TIME / each, each)[0] for each in (steps, 2 * steps))
    difference = isosyrk.relative_error(W, finer)
    if not difference < LARGEST_DIFFERENCE:
        raise Stop(f"developed scene at n = {n}: half the step changes it by {difference:.2g}; must be below"
                         f" {LARGEST_DIFFERENCE:g}", NO_ANSWER)
    return problems.unpacked(problems.packed(finer))


def solve(job):
    """Returns the solution of a problem: its line in references.json, and the matrices that it names."""
    problem = Problem(**job)
    developed = problem.scene == problems.DEVELOPED
    scene = (isosyrk.scene(problem.scene, initial=develop(problem.n)) if developed
             else isosyrk.scene(problem.scene, n=problem.n))
    aim = AIM * problems.UNCERTAINTIES[problem.scene, problem.time]
    solutions = [refine(scene, problem.time, integrator, aim) for integrator in INTEGRATORS]
    W = solutions[0][0]
    first, second = ({"integrator": integrator, "steps": steps}
                     for integrator, (_, steps) in zip(INTEGRATORS, solutions))
    record = {"n": problem.n, "file": f"{problem.scene}_n{problem.n}.npy",
              "uncertainty": isosyrk.relative_error(solutions[1][0], W), "first": first, "second": second}
    matrices = {record["file"]: W.view(float).tolist()}
    if developed:
        energies = isosyrk.energy_spectrum(scene.initial)[1:]
        record["initial"] = {"file": f"initial_n{problem.n}.npy", "energy": digits(sum(energies)),
                             "energy_by_degree": list(map(digits, energies))}
        matrices[record["initial"]["file"]] = scene.initial.view(float).tolist()
    return {"record": record, "matrices": matrices}


def digits(energy):
    return to_digits(energy, 7)


def is_whole(problem, folder):
    """Tells whether solution and initial data of a problem can be read."""
    try:
        problems.scene_of(problem, folder)
        return bool(problems.reference_of(problem, folder))
    except UnusableFile:
        return False


def write(problem, folder, solution):
    """Writes the matrices first, so that references.json never lists one that is not there."""
    place = problems.folder_of(problem, folder)
    os.makedirs(place, exist_ok=True)
    for name, rows in solution["matrices"].items():
        W = numpy.array(rows).view(complex)
        stream = io.BytesIO()
        numpy.save(stream, W if place == folder else problems.packed(W))
        replace_file(os.path.join(place, name), stream.getvalue())
    listed = os.path.join(place, "references.json")
    records = problems.read_records(problem, folder) if os.path.exists(listed) else {}
    records[problem.n] = solution["record"]
    lines = ",\n".join(f"  {json.dumps(records[n])}" for n in sorted(records))
    whole_file = json.dumps(problems.head(problem), indent=1)[:-2] + f',\n "references": [\n{lines}\n ]\n}}\n'
    replace_file(listed, whole_file.encode("utf-8"))


def main(arguments):
    parser = program.parser("references", __doc__.splitlines()[0], out="FOLDER")
    problems.add_filters(parser)
    options = parser.parse_args(arguments)
    if options.integrator:
        raise Stop(f"--integrator: reference solutions are those of {' and '.join(INTEGRATORS)}")
    folder = options.out
    wanted = problems.asked_for(options)
    make_folder("--out", folder)
    missing = sorted((problem for problem in wanted if not is_whole(problem, folder)),
                     key=lambda problem: (problem.n, problem.time))  # the longest last
    if missing:
        options.out = os.path.join(folder, "references.json")
        checkpoint = Checkpoint("references", options, isosyrk.conditions)
        solutions = untimed.results([problem._asdict() for problem in missing], solve, checkpoint, options,
                                  "reference solutions")
        for problem, solution in zip(missing, solutions):
            found, maximum = solution["record"]["uncertainty"], problems.UNCERTAINTIES[problem.scene, problem.time]
            if not found < maximum:
                raise Stop(f"reference of {problem}: {' and '.join(INTEGRATORS)} differ by {found:.2g}; must be"
                                 f" below {maximum:g}", NO_ANSWER)
            write(problem, folder, solution)
        checkpoint.remove()
    for problem in wanted:
        record = problems.record_of(problem, folder)
        first, second = record["first"], record["second"]
        say(f"reference {problem}: {'computed' if problem in missing else 'kept'}; {first['integrator']} with"
                  f" {first['steps']} steps, {second['integrator']} with {second['steps']}; they differ by"
                  f" {record['uncertainty']:.2g}")
