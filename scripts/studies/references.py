#!/usr/bin/env python3
"""Computes W(5) of the smooth scene to near rounding, which errors are measured against.

Two integrators of different kinds solve it, each with twice the steps until another doubling would not show: Gauss with
s = 5 in the group form, and explicit RKMK of order 4. Their difference is the uncertainty. The folder holds
smooth_n<n>.npy, from the first, and references.json, which says what each is a solution of. What is there is kept.
"""

import io
import json
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.realpath(__file__))), "lib"))

import study

PROGRAM = "references"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import numpy

import isosyrk
from benchmark_json import UnusableFile, one_line
from document import replace_file
from rendered_folder import output_folder
from study_file import an_object, checked, list_of, positive, read_json, require, text, whole

FORMAT = "isosyrk references 1"
SIZES, QUICK_SIZES = (17, 33, 65, 129), (17, 33)
INTEGRATORS = ("group5", "rkmk4")
TOLERANCE = 1e-14
FEWEST_STEPS, MOST_STEPS = 100, 25600
AIM = 2e-14  # an estimated error that no doubling could show to be less
NEAR_ROUNDING = 1e-10  # below, an error that a doubling does not halve is rounding
LARGEST_DIFFERENCE = 1e-12


def refine(scene, integrator):
    """Returns (W, number of steps) at which the error, estimated from the last doubling, is down at rounding.

    The estimate is Richardson's: change / (2^order − 1). Throws Stop if no number of steps converges.
    """
    order = next(each.order for each in isosyrk.integrators() if each.name == integrator)
    method = isosyrk.integrator(scene, integrator, tolerance=TOLERANCE)
    best, last_change, steps = None, math.inf, FEWEST_STEPS
    while steps <= MOST_STEPS:
        try:
            W, _ = method.run(scene.initial, scene.time / steps, steps)
        except isosyrk.SolverError:
            if best or 2 * steps > MOST_STEPS:
                break
        else:
            change = isosyrk.relative_error(best[0], W) if best else math.inf
            if best and change < NEAR_ROUNDING and change >= last_change / 2:
                break
            best, last_change = (W, steps), change
            if change / (2**order - 1) < AIM:
                break
        steps *= 2
    if best is None:
        raise study.Stop(f"reference at n = {scene.n}: {integrator} did not converge at {MOST_STEPS} steps",
                         study.NO_ANSWER)
    return best


def solve(job):
    """Returns the reference solution of a job {"n"}: its line in references.json, and W as n rows."""
    scene = isosyrk.scene("smooth", n=job["n"])
    solutions = [refine(scene, integrator) for integrator in INTEGRATORS]
    runs = [{"integrator": integrator, "steps": steps} for integrator, (_, steps) in zip(INTEGRATORS, solutions)]
    W = solutions[0][0]
    return {"record": {"n": scene.n, "file": f"smooth_n{scene.n}.npy",
                       "uncertainty": isosyrk.relative_error(solutions[1][0], W), "first": runs[0], "second": runs[1]},
            "W": W.view(float).tolist()}


def head():
    """Returns what the solutions of a folder are solutions of."""
    scene = isosyrk.scene("smooth", n=SIZES[0])
    return {"format": FORMAT, "scene": scene.name, "time": scene.time, "hbar": scene.hbar,
            "modes_hash": scene.modes_hash}


def read_records(folder):
    """Returns the records of references.json by n. Throws UnusableFile, also for solutions of another scene."""
    def records(document):
        for name, wanted in head().items():
            require(document, "list of reference solutions of this scene", name, wanted)
        kinds = {"n": whole(2), "file": text, "uncertainty": positive, "first": run, "second": run}
        found = checked(document, {"references": list_of(an_object)}, "it")["references"]
        return {each["n"]: each for each in (checked(each, kinds, "a reference") for each in found)}

    def run(values):
        return checked(an_object(values), {"integrator": text, "steps": whole(1)}, "a run of a reference")

    return read_json(os.path.join(folder, "references.json"), records)


def read_reference(folder, n):
    """Returns (W, record) of the reference solution at n. Throws UnusableFile."""
    record = read_records(folder).get(n)
    path = os.path.join(folder, f"smooth_n{n}.npy")
    remedy = f"; scripts/studies/references.py --n {n} --out {one_line(folder)} makes it"
    if record is None:
        raise UnusableFile(f"{one_line(folder)}: has no reference solution for n = {n}{remedy}")
    try:
        W = numpy.load(path, allow_pickle=False)
    except (OSError, ValueError):
        raise UnusableFile(f"{one_line(path)}: cannot be read{remedy}") from None
    if W.shape != (n, n) or W.dtype != complex:
        raise UnusableFile(f"{one_line(path)}: is no complex matrix of {n} x {n}{remedy}")
    return W, record


def is_whole(folder, n):
    try:
        return bool(read_reference(folder, n))
    except UnusableFile:
        return False


def write(folder, records, solutions):
    """Writes the matrices first, so that references.json never lists one that is not there."""
    for solution in solutions:
        stream = io.BytesIO()
        numpy.save(stream, numpy.array(solution["W"]).view(complex))
        replace_file(os.path.join(folder, solution["record"]["file"]), stream.getvalue())
    lines = ",\n".join(f"  {json.dumps(records[n])}" for n in sorted(records))
    whole_file = json.dumps(head(), indent=1)[:-2] + f',\n "references": [\n{lines}\n ]\n}}\n'
    replace_file(os.path.join(folder, "references.json"), whole_file.encode("utf-8"))


def main(arguments):
    options = study.command_line(PROGRAM, __doc__.splitlines()[0], out="FOLDER").parse_args(arguments)
    if options.integrator:
        raise study.Stop(f"--integrator: reference solutions are those of {' and '.join(INTEGRATORS)}")
    folder = options.out
    output_folder(PROGRAM, "--out", folder)
    records = read_records(folder) if os.path.exists(os.path.join(folder, "references.json")) else {}
    wanted = sorted(set(options.n or (QUICK_SIZES if options.quick else SIZES)))
    missing = [n for n in wanted if n not in records or not is_whole(folder, n)]
    if missing:
        options.out = os.path.join(folder, "references.json")
        journal = study.Journal(PROGRAM, options, isosyrk.conditions)
        solutions = study.untimed([{"n": n} for n in missing], solve, journal, options, "reference solutions")
        for record in (solution["record"] for solution in solutions):
            if not record["uncertainty"] < LARGEST_DIFFERENCE:
                raise study.Stop(f"reference at n = {record['n']}: {' and '.join(INTEGRATORS)} differ by"
                                 f" {record['uncertainty']:.2g}; must be below {LARGEST_DIFFERENCE:g}", study.NO_ANSWER)
            records[record["n"]] = record
        write(folder, records, solutions)
        journal.remove()
    for n in wanted:
        first, second = records[n]["first"], records[n]["second"]
        study.say(f"reference n = {n}: {'computed' if n in missing else 'kept'}; {first['integrator']} with"
                  f" {first['steps']} steps, {second['integrator']} with {second['steps']}; they differ by"
                  f" {records[n]['uncertainty']:.2g}")


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
