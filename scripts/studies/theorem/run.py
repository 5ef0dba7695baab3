"""Tests the paper's theorem on every scene, times its formulations there, and goes where the theorem ends.

Runs on small matrices compare the formulations of the module; single steps of plain_forms.py, each with one thing
changed, show what the theorem needs. Timed runs begin at the initial data of each scene. Each process on one core times
all formulations of one scene, n and h, interleaved; lib/judging/verdicts.py says how many processes tell which is
faster.
"""

import contextlib
import itertools
import math
import random
import statistics
from functools import lru_cache, partial

import isosyrk
import numpy as np

from lib.programs.command_line import Stop, whole_number
from lib.programs.messages import one_line
from lib.records import formats
from lib.records.formats import FORMULATIONS, INTEGRATORS
from lib.judging import verdicts
from lib.running import program, timed, untimed
from lib.running.checkpoint import Checkpoint
from studies.theorem import plain_forms
from studies.theorem.plain_forms import LOBATTO_IIIA, LOBATTO_IIIB, LOBATTO_IIIC, RADAU_IIA, dagger, gauss
from studies.theorem.plan import (NORMS, QUICK_PROCESSES, QUICK_SIZES, SIZES, SMALL, STAGES, STEPS, TIMED_STEPS,
                                  TOLERANCE, blocks_of, cells, known_methods)
from studies.theorem.schema import (NOTHING, PARTITIONED, PRINTED_K, PRINTED_W, SCENES, SCHEMA, Coincidence, End,
                                    Settings, Timed)

MIN_SECONDS = 0.004  # of CPU time that a repetition fills with runs: 1e5 readings of the clock
ENDS_N, ENDS_STEP = 6, 0.3


# ---- runs in which the formulations coincide


def J_of(scene):
    """Returns the matrix J of a scene's algebra, shape (n, n)."""
    I, m = np.eye(scene.n), scene.n // 2
    if scene.name == "symplectic":
        return np.block([[0 * I[:m, :m], I[:m, :m]], [-I[:m, :m], 0 * I[:m, :m]]])
    return np.diag([1.0] * (scene.n - m) + [-1.0] * m) if scene.name == "pseudo_unitary" else I


def algebra_defect(W, J):
    return float(abs(dagger(W) @ J + J @ W).max())


def casimir_error(W, W0):
    """Returns the largest |tr Wᵏ - tr W₀ᵏ| over Σ|λ|ᵏ, k = 2 … 5."""
    eigenvalues = np.linalg.eigvals(W0)
    return float(max(abs(np.trace(np.linalg.matrix_power(W, k)) - (eigenvalues**k).sum()) / (abs(eigenvalues)**k).sum()
                     for k in range(2, 6)))


def compare(job):
    """Returns the row of one scene, s and h as a dict; forms that fail are left out."""
    scene = isosyrk.scene(job["scene"], n=job["n"])
    W0, J = scene.initial, J_of(scene)
    h = job["h_norm_B"] / np.linalg.norm(scene.generator(W0), 2)
    runs = {}
    for form in FORMULATIONS:
        integrator = isosyrk.integrator(scene, f"{form}{job['stages']}", tolerance=TOLERANCE)
        with contextlib.suppress(isosyrk.SolverError):
            runs[form] = integrator.run(W0, h, STEPS)
    ends, contraction = [W for W, _ in runs.values()], max(report.contraction for _, report in runs.values())
    return {**job, "difference": float(max(abs(U - V).max() for U, V in itertools.combinations(ends, 2))),
            "algebra_defect": max(algebra_defect(W, J) for W in ends),
            "casimir_error": max(casimir_error(W, W0) for W in ends),
            "sweeps": [runs[form][1].sweeps / STEPS if form in runs else None for form in FORMULATIONS],
            "bound": STEPS * TOLERANCE / (1 - contraction)}


# ---- where the theorem ends


def ends():
    """Returns the rows of single steps on so(ENDS_N), each with one thing changed."""
    n, h, W0 = ENDS_N, ENDS_STEP, isosyrk.scene("rigid_body", n=ENDS_N).initial.real
    d, I, J = np.linspace(0.5, 2.0, n), np.eye(n), np.diag([1.0] * (n // 2) + [2.0] * (n - n // 2))

    def body(W):
        return W / (d[:, None] + d)

    def row(changed, case, tableau, order=None, P=None, named=None, B=body, W0=W0, J=I, adjoint=dagger, printed=False):
        """Returns a row; P is the tableau of P on T*G, `named` that of the forms on G and on g, if not `tableau`."""
        steps = [each.W1 for each in (plain_forms.cotangent(*tableau, B, W0, h, P and P[0]),
                                      plain_forms.group(*named or tableau, B, W0, h, J, adjoint),
                                      plain_forms.algebra(*named or tableau, B, W0, h, J, printed))]
        s, differences = len(tableau[1]), [float(abs(steps[i] - steps[j]).max()) for i, j in ((0, 1), (1, 2), (0, 2))]
        return End(changed, f"{case}, s = {s}", s, differences, [casimir_error(W, W0) for W in steps],
                   max(algebra_defect(W, J) for W in steps), order)

    def end_of(s, steps, printed=False):
        W = W0
        for _ in range(steps):
            W = plain_forms.algebra(*gauss(s), body, W, 8 * h / steps, I, printed).W1
        return W

    def order(s, printed=False):
        """Returns the observed order of the form on g, between h and h/2."""
        coarse, fine = (abs(end_of(s, steps, printed) - exact).max() for steps in (8, 16))
        return float(np.log2(coarse / fine))

    exact = end_of(5, 32)
    return [
        *(row(NOTHING, "Gauss", gauss(s), order(s)) for s in (2, 3)),
        *(row("a tableau that is not symplectic", case, tableau) for case, tableau in (
            ("Radau IIA", RADAU_IIA), ("Lobatto IIIC", LOBATTO_IIIC[2]), ("Lobatto IIIC", LOBATTO_IIIC[3]),
            ("one of order 1", (np.array([[0.3, -0.2], [0.5, 0.1]]), np.array([0.4, 0.6]))))),
        *(row(PARTITIONED, f"IIIA–IIIB, {name}", LOBATTO_IIIA[s], P=LOBATTO_IIIB[s], named=named[s])
          for s in (2, 3) for name, named in (("IIIA", LOBATTO_IIIA), ("IIIB", LOBATTO_IIIB))),
        row("J² no multiple of I", "J² no multiple of I", gauss(2), W0=np.linalg.solve(J, W0), J=J),
        row("B outside g", "B outside g", gauss(2), B=lambda W: W / (d[:, None] + 2 * d)),
        *(row(PRINTED_K, PRINTED_K, gauss(s), order(s, printed=True), printed=True) for s in (2, 3)),
        row(PRINTED_W, PRINTED_W, gauss(2), adjoint=lambda Q: Q)]


# ---- what is timed


@lru_cache(maxsize=None)
def scene_and_norm(name, n):
    """Returns a scene and ‖B(W₀)‖₂."""
    scene = isosyrk.scene(name, n=n)
    return scene, np.linalg.norm(scene.generator(scene.initial), 2)


def begun(block, integrator):
    """Returns the integrator as new, initial data, h and number of steps of a block."""
    scene, norm = scene_and_norm(block["scene"], block["n"])
    made = isosyrk.integrator(scene, integrator, tolerance=TOLERANCE, products=block["products"])
    return made, scene.initial, block["h_norm_B"] / norm, block["steps"]


def count(job):
    """Returns the costs of a step that are not times, and the difference from the answer on g; None where a run fails.

    A job is a block with one `integrator` in place of its rows.
    """
    steps, ends, costs = job["steps"], [], {"sweeps": None, "products": None}
    for name in (job["integrator"], cells()[job["integrator"]].on_g):
        integrator, *start = begun(job, name)
        with contextlib.suppress(isosyrk.SolverError):
            W, report = integrator.run(*start)
            ends.append(W)
            if name == job["integrator"]:
                costs = {"sweeps": report.sweeps / steps, "products": report.products / steps}
    return {**costs, "difference": float(abs(ends[0] - ends[1]).max()) if len(ends) == 2 else None}


def time_block(block):
    """Returns the CPU seconds of a step of each row, the median of interleaved repetitions, in changing order.

    `process` of the block tells the orders of one process from those of another.
    """
    rows = [begun(block, name) for name in block["rows"]]
    shuffled, runs = random.Random(block["process"]), [1] * len(rows)
    if block["warm"]:
        runs = [math.ceil(MIN_SECONDS / max(integrator.timed_run(*start, repetitions=1)[0], 1e-6))
                for integrator, *start in rows]
    found = [[] for _ in rows]
    for _ in range(block["repetitions"]):
        for index in shuffled.sample(range(len(rows)), len(rows)):
            integrator, *start = rows[index]
            found[index].append(statistics.fmean(integrator.timed_run(*start, repetitions=runs[index])))
    return [statistics.median(each) / block["steps"] for each in found]


def further_processes(maximum, seconds):
    """Returns how many further processes each row of a block wants, given its seconds by process so far.

    The rows of one method are compared with one another, and stop together.
    """
    wanted = {}
    for _, rows in itertools.groupby(seconds, lambda name: cells()[name].method):
        compared = {row: seconds[row] for row in rows}
        wanted.update(dict.fromkeys(compared, verdicts.further_processes(maximum, compared, verdicts_on_pairs)))
    return wanted


def verdicts_on_pairs(seconds):
    return [verdicts.compared(row, other) for row, other in itertools.combinations(seconds.values(), 2)]


def main(arguments):
    parser = program.parser("theorem", __doc__.splitlines()[0])
    parser.add_argument("--scene", choices=SCENES, nargs="+", action="extend", help="scenes (default: all)")
    parser.add_argument("--processes", type=whole_number(1, 100), help="that time a row at most; with fewer than"
                        f" {verdicts.FEWEST} all is undecided (default: {verdicts.MAXIMUM}, quick {QUICK_PROCESSES})")
    options = parser.parse_args(arguments)
    sizes = sorted(set(options.n or (QUICK_SIZES if options.quick else SIZES)))
    known = known_methods()
    scenes, names = options.scene or list(SCENES), options.integrator or list(known)
    maximum = options.processes or (QUICK_PROCESSES if options.quick else verdicts.MAXIMUM)
    for name in {*names} - {*known}:
        raise Stop(f"--integrator {one_line(name)!r}: must be one of {', '.join(known)}")

    checkpoint = Checkpoint("theorem", options, partial(isosyrk.conditions, products="fastest", sizes=sizes))
    jobs = [{"scene": scene, "n": SMALL[scene], "stages": s, "h_norm_B": norm}
            for scene in scenes for s in STAGES for norm in NORMS]
    found = untimed.results(jobs, compare, checkpoint, options, "comparing")
    tables = {INTEGRATORS: [each for name, each in known.items() if name in names],
              "coincidence": [Coincidence(**row) for row in found], "ends": ends(), "cost": [], "dirk": []}
    blocks = blocks_of(scenes, sizes, names, options.quick, checkpoint.products)
    jobs = [{**block, "rows": None, "integrator": row} for block in blocks for row in block["rows"]]
    counts = iter(untimed.results(jobs, count, checkpoint, options, "counting"))
    counts = [{row: next(counts) for row in block["rows"]} for block in blocks]
    converging = [{**block, "rows": [row for row in block["rows"] if costs[row]["sweeps"]]}
                  for block, costs in zip(blocks, counts)]
    times = timed.by_processes(converging, partial(program.process_command, "theorem"),
                               partial(further_processes, maximum), checkpoint, "timing")
    for block, costs, seconds in zip(blocks, counts, times):
        for row in block["rows"]:
            cell = cells()[row]
            tables[cell.table].append(Timed(block["scene"], block["n"], block["h_norm_B"], cell.method,
                                            cell.formulation, **costs[row], seconds=seconds.get(row, [])))
    settings = Settings(STEPS, TIMED_STEPS, TOLERANCE, ENDS_N, ENDS_STEP)
    formats.write_study(options.out, SCHEMA, checkpoint.context, settings, tables)
    checkpoint.remove()
