"""The problems that errors are measured on: a scene, a size and a time, each with initial data and a kept solution.

A folder of references has one subfolder for each scene and time, with references.json and a matrix for each n. The
smooth scene to T = 5, up to n = 129, stands in the folder itself, as complex matrices, which the C++ programs read.
Elsewhere a skew-Hermitian W is packed into one real matrix: Re W above the diagonal, Im W on it and below.
The developed scene is the smooth one at t = DEVELOPED_TIME. Since a flow amplifies differences, its initial data are by
definition the matrices in its subfolder; their energies by degree l are listed with them. Needs NumPy and isosyrk.
"""

import base64
import os

import isosyrk
import numpy

from lib.programs.command_line import Stop
from lib.programs.messages import UnusableFile, one_line
from lib.records.formats import read_json, require
from lib.records.settings import Problem

FORMAT = "isosyrk references 1"
SIZES, QUICK_SIZES, LARGEST_SIZE = (17, 33, 65, 129), (17, 33), 257
LARGEST_UNPACKED = 129
DEVELOPED, DEVELOPED_TIME = "developed", 100.0
# Scene and time, with the largest uncertainty of a solution at any n, some four times the largest found when first
# made. Flow and rounding allow no less: rounding errors grow with the number of steps, and with the norm of B.
UNCERTAINTIES = {("smooth", 5.0): 1e-12, ("smooth", 50.0): 1e-11, ("rough", 5.0): 1e-12, (DEVELOPED, 5.0): 1e-12}
DIGITS = 1e-6  # to which the listed energies of initial data are those of the matrix


def add_filters(parser):
    """Adds the options that choose problems, beside those that every study has."""
    parser.add_argument("--scene", choices=sorted({scene for scene, _ in UNCERTAINTIES}), nargs="+", action="extend",
                        help="(default: all)")
    parser.add_argument("--time", type=float, choices=sorted({time for _, time in UNCERTAINTIES}), nargs="+",
                        action="extend", help="(default: all)")


def asked_for(options):
    """Returns the problems that options ask for. The quick study leaves out the developed scene and long times.

    Only the smooth scene to T = 5 has other sizes than SIZES. Throws Stop if there are none.
    """
    sizes = sorted(set(options.n or (QUICK_SIZES if options.quick else (*SIZES, LARGEST_SIZE))))
    found = [Problem(scene, time, n) for scene, time in UNCERTAINTIES for n in sizes
             if (n in SIZES or (scene, time) == ("smooth", 5.0))
             and not (options.quick and (scene == DEVELOPED or time > 5))
             and scene in (options.scene or (scene,)) and time in (options.time or (time,))]
    if not found:
        raise Stop("no problem has this scene, time and n")
    return found


def folder_of(problem, folder):
    """Returns the folder that keeps the solution of a problem."""
    if (problem.scene, problem.time) == ("smooth", 5.0) and problem.n <= LARGEST_UNPACKED:
        return folder
    return os.path.join(folder, f"{problem.scene}_t{problem.time:g}")


def scene_of(problem, folder):
    """Returns the scene of a problem. Throws UnusableFile where its initial data are not kept or not as listed."""
    if problem.scene != DEVELOPED:
        return isosyrk.scene(problem.scene, n=problem.n)
    initial = record_of(problem, folder)["initial"]
    path = os.path.join(folder_of(problem, folder), initial["file"])
    W = read_matrix(path, problem.n)
    found, listed = isosyrk.energy_spectrum(W)[1:], numpy.array(initial["energy_by_degree"])
    if found.shape != listed.shape or not numpy.allclose([*found, found.sum()], [*listed, initial["energy"]],
                                                         rtol=DIGITS, atol=0):
        raise UnusableFile(f"{one_line(path)}: has not the energies that references.json lists")
    return isosyrk.scene(DEVELOPED, initial=W)


def reference_of(problem, folder):
    """Returns (W, record) of the kept solution of a problem. Throws UnusableFile."""
    record = record_of(problem, folder)
    try:
        return read_matrix(os.path.join(folder_of(problem, folder), record["file"]), problem.n), record
    except UnusableFile as wrong:
        raise UnusableFile(f"{wrong}{remedy(problem, folder)}") from None


def record_of(problem, folder):
    record = read_records(problem, folder).get(problem.n)
    if record is None:
        raise UnusableFile(f"{one_line(folder_of(problem, folder))}: has no reference solution for n = {problem.n}"
                           f"{remedy(problem, folder)}")
    return record


def remedy(problem, folder):
    return f"; scripts/measure references --n {problem.n} --out {one_line(folder)} makes it"


def read_records(problem, folder):
    """Returns the records of a problem's references.json by n. Throws UnusableFile, also for those of another scene."""
    def records(document):
        for name, wanted in head(problem).items():
            require(document, "list of reference solutions of this scene", name, wanted)
        return {each["n"]: each for each in document["references"]}

    return read_json(os.path.join(folder_of(problem, folder), "references.json"), records)


def head(problem):
    """Returns what the solutions beside that of a problem are solutions of."""
    scene = isosyrk.scene("smooth" if problem.scene == DEVELOPED else problem.scene, n=problem.n)
    start = {"developed_from": scene.name, "developed_time": DEVELOPED_TIME} if problem.scene == DEVELOPED else {}
    # The modes of the rough scene depend on n.
    modes = {} if problem.scene == "rough" else {"modes_hash": scene.modes_hash}
    return {"format": FORMAT, "scene": problem.scene, "time": problem.time, "hbar": scene.hbar, **start, **modes}


# ---- matrices


def read_matrix(path, n):
    """Returns the complex matrix in a file, packed or not. Throws UnusableFile."""
    try:
        matrix = numpy.load(path, allow_pickle=False)
    except (OSError, ValueError):
        raise UnusableFile(f"{one_line(path)}: cannot be read") from None
    if matrix.shape != (n, n) or matrix.dtype not in (float, complex):
        raise UnusableFile(f"{one_line(path)}: is no matrix of {n} x {n}")
    return unpacked(matrix) if matrix.dtype == float else matrix


def packed(W):
    """Returns the real matrix that tells a skew-Hermitian W, whose diagonal is imaginary."""
    return numpy.triu(W.real, 1) + numpy.tril(W.imag)


def unpacked(matrix):
    real, imaginary = numpy.triu(matrix, 1), numpy.tril(matrix)
    return real - real.T + 1j * (imaginary + numpy.tril(matrix, -1).T)


def encoded(W):
    """Returns a skew-Hermitian matrix as text."""
    return base64.b64encode(packed(W).tobytes()).decode("ascii")


def decoded(text, n):
    """Returns the matrix of shape (n, n) in a text."""
    return unpacked(numpy.frombuffer(base64.b64decode(text)).reshape(n, n))
