#!/usr/bin/env python3
"""Tests the paper's theorem on every scene, times its formulations there, and goes where the theorem ends.

Runs on small matrices compare the formulations of the module; single steps of lib/plain_forms.py, each with one thing
changed, show what the theorem needs; what is timed begins at the initial data of each scene, in turns on one core.
"""

import contextlib
import itertools
import os
import sys
from functools import lru_cache, partial

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from lib import study

PROGRAM = "theorem"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
import numpy as np
from lib import plain_forms
from lib import formats
from lib.formats import FORMULATIONS
from lib.messages import one_line
from lib.command_line import Stop, whole_number
from lib.integrator_names import TABLE1_CELLS
from lib.plain_forms import LOBATTO_IIIA, LOBATTO_IIIB, LOBATTO_IIIC, RADAU_IIA, dagger, gauss
from lib.theorem_table import NOTHING, PRINTED_K, PRINTED_W, SCENES, SCHEMA, Coincidence, End, Settings, Timed

SMALL = {"smooth": 9, "rough": 9, "euler_top": 3, "rigid_body": 6, "spin_chain": 10, "symplectic": 6,
         "pseudo_unitary": 5}  # n of the runs in which the formulations are compared
STAGES, NORMS = (1, 2, 3), (0.1, 0.3, 0.6)  # of these runs; the norms are h‖B(W₀)‖₂
TIMED = {  # scenes, and n for a given size: some must be even, and a step of the chain costs little
    "smooth": int, "rigid_body": int, "symplectic": lambda n: n - n % 2, "pseudo_unitary": int,
    "spin_chain": lambda n: CHAIN * (n - n % 2)}
TIMED_DIRK = ("smooth", "rigid_body")
SCHEMES = ("yoshida4", "suzuki4", "kahan_li6")
SIZES, QUICK_SIZES = (65, 129), (17, 33)
CHAIN = 8  # times as large is n of the spin chain, and as long are its runs, so that packing W does not weigh
STEPS, TOLERANCE, H_NORM_B, REPETITIONS = 10, 1e-13, 0.5, 7
ENOUGH = 5.0  # CPU seconds on a point, so that most are repeated as often as a rank test needs
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
            ("one of no order", (np.array([[0.3, -0.2], [0.5, 0.1]]), np.array([0.4, 0.6]))))),
        *(row("a partitioned pair on T*G", f"IIIA–IIIB, {name}", LOBATTO_IIIA[s], P=LOBATTO_IIIB[s], named=named[s])
          for s in (2, 3) for name, named in (("IIIA", LOBATTO_IIIA), ("IIIB", LOBATTO_IIIB))),
        row("J² no multiple of I", "J² no multiple of I", gauss(2), W0=np.linalg.solve(J, W0), J=J),
        row("B outside g", "B outside g", gauss(2), B=lambda W: W / (d[:, None] + 2 * d)),
        *(row(PRINTED_K, PRINTED_K, gauss(s), order(s, printed=True), printed=True) for s in (2, 3)),
        row(PRINTED_W, PRINTED_W, gauss(2), adjoint=lambda Q: Q)]


# ---- what is timed


@lru_cache(maxsize=None)
def start(name, n):
    """Returns a scene and the step at which h‖B(W₀)‖₂ = H_NORM_B."""
    scene = isosyrk.scene(name, n=n)
    return scene, H_NORM_B / np.linalg.norm(scene.generator(scene.initial), 2)


def begun(point, integrator):
    """Returns the integrator as new, initial data, h and number of steps of a point."""
    scene, h = start(point["scene"], point["n"])
    made = isosyrk.integrator(scene, integrator, tolerance=TOLERANCE, products=point["products"])
    return made, scene.initial, h, STEPS * (CHAIN if scene.name == "spin_chain" else 1)


def count(point):
    """Returns the costs of a step that are not times, and the difference from the answer on g; None if a step fails."""
    integrator, W0, h, steps = begun(point, point["integrator"])
    try:
        W, report = integrator.run(W0, h, steps)
        on_g, _ = begun(point, point["on_g"])[0].run(W0, h, steps)
    except isosyrk.SolverError:
        return None
    return {"sweeps": report.sweeps / steps, "products": report.products / steps,
            "difference": float(abs(W - on_g).max())}


def time_one(point):
    """Returns the CPU seconds of a step."""
    integrator, W0, h, steps = begun(point, point["integrator"])
    return study.seconds_of(integrator, W0, h, steps) / steps


def main(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--scene", choices=SCENES, nargs="+", action="extend", help="scenes (default: all)")
    parser.add_argument("--repetitions", type=whole_number(1, 1000), help=f"(default: {REPETITIONS}, quick 2)")
    options = parser.parse_args(arguments)
    sizes = sorted(set(options.n or (QUICK_SIZES if options.quick else SIZES)))
    known = (*TABLE1_CELLS, *SCHEMES)
    scenes, names = options.scene or list(SCENES), options.integrator or known
    repetitions = options.repetitions or (2 if options.quick else REPETITIONS)
    for name in {*names} - {*known}:
        raise Stop(f"--integrator {one_line(name)!r}: must be one of {', '.join(known)}")

    journal = study.Journal(PROGRAM, options, partial(isosyrk.conditions, products="fastest", sizes=sizes))
    jobs = [{"scene": scene, "n": SMALL[scene], "stages": s, "h_norm_B": norm}
            for scene in scenes for s in STAGES for norm in NORMS]
    found = study.untimed(jobs, compare, journal, options, "comparing")
    tables = {"coincidence": [Coincidence(**row) for row in found], "ends": ends()}
    cells = [{"method": f"s = {s}", "formulation": form, "integrator": f"{form}{s}", "on_g": f"algebra{s}"}
             for s in STAGES for form in FORMULATIONS if f"{form}{s}" in names]
    schemes = [{"method": name, "formulation": form, "integrator": name if form == "algebra" else f"{name}_{form}",
                "on_g": name} for name in SCHEMES for form in FORMULATIONS if name in names]
    for table, timed, methods in (("cost", TIMED, cells), ("dirk", TIMED_DIRK, schemes)):
        points = [{"scene": scene, "n": TIMED[scene](n), "products": journal.products(n), **method}
                  for scene in timed if scene in scenes for n in sizes for method in methods]
        counts = study.untimed(points, count, journal, options, f"counting {table}")
        done = [(point, found) for point, found in zip(points, counts) if found]
        times = study.in_turns([point for point, _ in done], repetitions, time_one, journal, f"timing {table}", ENOUGH)
        tables[table] = [Timed(*(point[name] for name in Timed._fields[:4]), **found, seconds=seconds)
                         for (point, found), seconds in zip(done, times)]
    settings = Settings(STEPS, TOLERANCE, H_NORM_B, ENDS_N, ENDS_STEP)
    formats.write_study(options.out, SCHEMA, journal.context, settings, tables)
    journal.remove()


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
