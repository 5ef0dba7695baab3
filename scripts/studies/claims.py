#!/usr/bin/env python3
"""Measures what became of the paper's claims in GNU Octave, with other initial data, and on two threads.

Octave's cells are checked against those of C++ first. Each process on one core times in turns all that is compared;
lib/verdicts.py says how many processes tell which formulation is fastest. Tables 1 and 2 are not measured again: the
renderer reads those recorded, and scripts/reproduce measures them with AVX2 kernels beside this study.
"""

import json
import math
import os
import random
import statistics
import sys
import tempfile
import time
from functools import partial

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from lib import study

PROGRAM = "claims"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
import numpy as np
from lib import claims, formats, octave_cells, verdicts
from lib.claims_files import (HBARS, SCHEMA, WITHOUT, DrawCell, OctaveCell, OctaveProduct, Rate, Settings,
                              ThreadCell)
from lib.command_line import NO_ANSWER, Stop, whole_number
from lib.formats import FAST, SOLVERS, CellKey, Measurement, Run
from lib.integrator_names import TABLE1_CELLS, gauss_stages
from lib.messages import one_line

STEP, STEPS, TOLERANCE = 0.1, 50, 1e-13
EQUAL = 1e-11  # largest entry of the difference of Octave's answer from that in C++
SIZES, QUICK_SIZES = (17, 33, 65, 129), (17, 33)
SEVERAL_UP_TO = 33  # the n up to which a process runs a cell more than once
REPETITIONS = 2  # of which the least counts
DRAWS, QUICK_DRAWS = 5, 2  # with each ħ
DRAW_SIZES, QUICK_DRAW_SIZES = (17, 33, 65), (17,)
LARGEST_DEGREE = 4  # of the modes that are drawn, as the paper's
# n of the runs by threads, with their h and number of steps: h‖B(W₀)‖₂ is that of n = 129 in Table 1 from there on.
THREAD_RUNS = {65: (0.1, 20), 129: (0.1, 10), 257: (0.05, 5)}
QUICK_THREAD_SIZES = (65,)
THREAD_STAGES, THREADS = (2, 3), (1, 2)
PRODUCT, PASS = "product", "pass"  # rows of what is timed beside cells
SECONDS_OF_PASSES = 0.02
PROCESS = "--process"  # the hidden mode: what follows is one block to time


# ---- GNU Octave


def octave_answers(job):
    """Returns the counts of cells at one n in GNU Octave and how far their answers are from those in C++."""
    scene = isosyrk.scene("smooth", n=job["n"])
    with tempfile.TemporaryDirectory(prefix="isosyrk-") as folder:
        initial = os.path.join(folder, "initial.npy")
        np.save(initial, scene.initial)
        found = octave_cells.run(initial, [job["cell"]], STEP, STEPS, folder=folder)
        W = np.load(os.path.join(folder, f"{job['cell']}.npy"))
    ours, _ = isosyrk.integrator(scene, job["cell"], tolerance=TOLERANCE).run(scene.initial, STEP, STEPS)
    cell, = found["cells"]
    return {"sweeps": cell["sweeps"], "products": cell["products"], "difference": float(abs(W - ours).max()),
            "octave": found["octave"], "blas": found["blas"]}


def time_octave(block):
    """Returns the CPU seconds of the cells of a block, in an order of this process, and of a product."""
    cells = [row for row in block["rows"] if row != PRODUCT]
    random.Random(block["process"]).shuffle(cells)
    with tempfile.TemporaryDirectory(prefix="isosyrk-") as folder:
        initial = os.path.join(folder, "initial.npy")
        np.save(initial, isosyrk.scene("smooth", n=block["n"]).initial)
        found = octave_cells.run(initial, cells, STEP, STEPS, block["repetitions"])
    seconds = {cell["cell"]: cell["seconds"] for cell in found["cells"]}
    return [{**seconds, PRODUCT: found["product_seconds"]}[row] for row in block["rows"]]


def require_same_kernels(answers, context):
    """Throws Stop unless Octave runs on the kernels of OpenBLAS that the module runs on."""
    kernels = octave_cells.kernels(answers["blas"])
    if kernels != context["blas_kernels"]:
        raise Stop(f"octave: its BLAS is {one_line(answers['blas'])}, not OpenBLAS with kernels"
                   f" {context['blas_kernels']}; choose it with update-alternatives", NO_ANSWER)


def require_equal(n, cell, answers):
    if not answers["difference"] <= EQUAL:
        raise Stop(f"octave: {cell} at n = {n} ends {answers['difference']:.1e} from the published form, more than"
                   f" {EQUAL:g}", NO_ANSWER)


# ---- other initial data


def drawn_modes(draw):
    """Returns coefficients (l, m, re, im) of all modes up to LARGEST_DEGREE, normally distributed, for a seed."""
    numbers = np.random.default_rng(draw)
    return [(degree, order, *map(float, numbers.standard_normal(2) * (1, order > 0)))
            for degree in range(1, LARGEST_DEGREE + 1) for order in range(degree + 1)]


def time_draw(block):
    """Returns the CPU seconds of the rows of a block, "published group2" and so on, the least of its repetitions."""
    scene = isosyrk.scene("drawn", n=block["n"], hbar=block["hbar"], modes=drawn_modes(block["draw"]))
    shuffled = random.Random(block["process"])
    found = {row: [] for row in block["rows"]}
    for _ in range(block["repetitions"]):
        for row in shuffled.sample(block["rows"], len(block["rows"])):
            solver, name = row.split()
            products = {} if solver == FAST else {"products": block["products"]}
            method = isosyrk.integrator(scene, name, solver=solver, tolerance=TOLERANCE, **products)
            found[row].append(study.seconds_of(method, scene.initial, STEP, STEPS))
    return [min(each) for each in found.values()]


# ---- threads


def fast_form(scene, name, code, threads):
    return isosyrk.integrator(scene, name, solver=FAST, tolerance=TOLERANCE, threads=threads, without=WITHOUT[code])


def count_threads(job):
    """Returns the counts of a run of a fast form as it is timed, the same for every number of threads."""
    scene = isosyrk.scene("smooth", n=job["n"])
    method = fast_form(scene, job["name"], job["code"], 1)
    method.run(scene.initial, job["step"], 1)
    _, report = method.run(scene.initial, job["step"], job["steps"])
    return {"sweeps": report.sweeps, "equivalent_products": report.equivalent_products}


def time_threads(block):
    """Returns the seconds that pass in the rows of a block, "sweeps group2 2" and so on, and those of its rates.

    The rows with two threads need two cores, which this process takes back.
    """
    os.sched_setaffinity(0, block["cores"])
    scene = isosyrk.scene("smooth", n=block["n"])
    found = {PRODUCT: 1 / isosyrk.product_rate(block["n"]), PASS: seconds_of_pass(scene.initial)}
    rows = [row for row in block["rows"] if row not in found]
    for row in random.Random(block["process"]).sample(rows, len(rows)):
        code, name, threads = row.split()
        method = fast_form(scene, name, code, int(threads))
        method.run(scene.initial, block["step"], 1)  # its threads are there, and its memory
        begun = time.perf_counter()
        method.run(scene.initial, block["step"], block["steps"])
        found[row] = time.perf_counter() - begun
    return [found[row] for row in block["rows"]]


def seconds_of_pass(W):
    """Returns the CPU seconds of the sum of two matrices into a third, the median of five trials."""
    A, total = W.copy(), W.copy()

    def trial(count):
        begun = time.thread_time()
        for _ in range(count):
            np.add(A, W, out=total)
        return (time.thread_time() - begun) / count

    count = math.ceil(SECONDS_OF_PASSES / max(trial(100), 1e-7))
    return statistics.median(trial(count) for _ in range(5))


# ---- how many processes


def table_of(times):
    """Returns the times by process of cells such as "group2", all at one n, as the Run of a table with n = 0."""
    return Run({}, {CellKey(name[:-1], 0, gauss_stages(name)): Measurement(dict(enumerate(seconds)))
                    for name, seconds in times.items()})


def further(options, verdicts_on, seconds):
    """Returns how many further processes each row of a block wants; all rows of a block stop together."""
    done = len(next(iter(seconds.values())))
    found = verdicts_on(seconds) if done >= verdicts.FEWEST else ()
    return dict.fromkeys(seconds, max(0, min(options.processes - done, verdicts.more_processes(done, found))))


def of_octave(seconds):
    """Returns every verdict on pairs of rows and on claims."""
    return claims.block_verdicts(table_of({row: found for row, found in seconds.items() if row != PRODUCT}), 0)


def of_draws(seconds):
    """Returns the verdicts on claims: a pair of rows that no claim is about needs no further process."""
    tables = (table_of({row.split()[1]: found for row, found in seconds.items() if row.startswith(solver)})
              for solver in SOLVERS)
    return {each.result for table in tables for each in claims.judged(table, 0)}


def of_threads(seconds):
    """Returns nothing: the table of threads takes the fewest processes that give an interval."""
    return ()


# ---- the study


TIMED = {"octave": time_octave, "draws": time_draw, "threads": time_threads}


def command(block, process):
    """Returns the command that times a block in a fresh process."""
    return [sys.executable, "-B", os.path.realpath(__file__), PROCESS, json.dumps({**block, "process": process})]


def timed(blocks, verdicts_on, journal, options, what):
    return study.by_processes(blocks, command, partial(further, options, verdicts_on), journal, what) if blocks else []


def octave_tables(options, sizes, names, journal):
    """Returns the rows of Octave's cells and of its products, and what Octave says of itself."""
    jobs = [{"n": n, "cell": name} for n in sizes for name in names]
    answers = study.untimed(jobs, octave_answers, journal, options, "checking Octave's answers")
    for job, each in zip(jobs, answers):
        require_same_kernels(each, journal.context)
        require_equal(job["n"], job["cell"], each)
    blocks = [{"what": "octave", "n": n, "rows": [*names, PRODUCT],
               "repetitions": REPETITIONS if n <= SEVERAL_UP_TO else 1} for n in sizes]
    seconds = timed(blocks, of_octave, journal, options, "timing Octave")
    counted = {(job["n"], job["cell"]): each for job, each in zip(jobs, answers)}
    cells = [OctaveCell(name[:-1], block["n"], gauss_stages(name),
                        *(counted[block["n"], name][each] for each in ("sweeps", "products", "difference")),
                        found[name]) for block, found in zip(blocks, seconds) for name in names]
    products = [OctaveProduct(block["n"], found[PRODUCT]) for block, found in zip(blocks, seconds)]
    return cells, products, answers[0]


def draw_table(options, sizes, names, journal):
    draws = QUICK_DRAWS if options.quick else DRAWS
    blocks = [{"what": "draws", "n": n, "hbar": hbar, "draw": draw, "products": journal.products(n),
               "repetitions": REPETITIONS if n <= SEVERAL_UP_TO else 1,
               "rows": [f"{solver} {name}" for solver in SOLVERS for name in names]}
              for n in sizes for hbar in HBARS for draw in range(draws)]
    seconds = timed(blocks, of_draws, journal, options, "timing draws")
    return [DrawCell(block["n"], block["hbar"], block["draw"], solver, name[:-1], gauss_stages(name),
                     found[f"{solver} {name}"])
            for block, found in zip(blocks, seconds) for solver in SOLVERS for name in names]


def thread_tables(options, sizes, names, journal):
    """Returns the rows of fast forms by threads and of rates; without a second core those of one thread."""
    cores = sorted(os.sched_getaffinity(0))
    threads = [each for each in THREADS if each <= len(cores)]
    journal.context["cores"] = f"{len(cores)}"
    names = [name for name in names if gauss_stages(name) in THREAD_STAGES]
    sizes = sizes if names else ()
    runs = {n: dict(zip(("step", "steps"), THREAD_RUNS[n])) for n in sizes}
    jobs = [{"n": n, "name": name, "code": code, **runs[n]} for n in sizes for name in names for code in WITHOUT]
    counts = study.untimed(jobs, count_threads, journal, options, "counting for threads") if jobs else []
    counted = {(job["n"], job["name"], job["code"]): each for job, each in zip(jobs, counts)}
    blocks = [{"what": "threads", "n": n, "cores": cores, **runs[n],
               "rows": [PRODUCT, PASS, *(f"{code} {name} {each}" for code in WITHOUT for name in names
                                         for each in threads)]} for n in sizes]
    seconds = timed(blocks, of_threads, journal, options, "timing threads")
    cells = [ThreadCell(n := block["n"], *THREAD_RUNS[n], name[:-1], gauss_stages(name), code, each,
                        **counted[n, name, code], seconds=found[f"{code} {name} {each}"])
             for block, found in zip(blocks, seconds) for code in WITHOUT for name in names for each in threads]
    return cells, [Rate(block["n"], found[PRODUCT], found[PASS]) for block, found in zip(blocks, seconds)]


def chosen(sizes, wanted):
    """Returns those of some sizes that --n names; all of them without it."""
    return [n for n in sizes if not wanted or n in wanted]


def main(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--processes", type=whole_number(1, 100), default=None, help="that time a block at most; with"
                        f" fewer than {verdicts.FEWEST} all is undecided (default: {verdicts.MOST}, quick"
                        f" {verdicts.FEWEST})")
    options = parser.parse_args(arguments)
    options.processes = options.processes or (verdicts.FEWEST if options.quick else verdicts.MOST)
    names = [name for name in TABLE1_CELLS if not options.integrator or name in options.integrator]
    for name in options.integrator or ():
        if name not in TABLE1_CELLS:
            raise Stop(f"--integrator {one_line(name)!r}: must be one of {', '.join(TABLE1_CELLS)}")
    full = (SIZES, DRAW_SIZES, tuple(THREAD_RUNS))
    sizes = [chosen(each, options.n) for each in
             ((QUICK_SIZES, QUICK_DRAW_SIZES, QUICK_THREAD_SIZES) if options.quick and not options.n else full)]
    known = sorted({n for each in full for n in each})
    for n in options.n or ():
        if n not in known:
            raise Stop(f"--n {n}: must be one of {', '.join(map(str, known))}")

    journal = study.Journal(PROGRAM, options, partial(isosyrk.conditions, products="fastest",
                                                      sizes=sorted({*sizes[0], *sizes[1]})))
    cells, products, octave = octave_tables(options, sizes[0], names, journal) if sizes[0] else ([], [], {})
    threads, rates = thread_tables(options, sizes[2], names, journal)
    tables = {"octave": cells, "octave_products": products, "draws": draw_table(options, sizes[1], names, journal),
              "threads": threads, "rates": rates}
    settings = Settings(STEP, STEPS, TOLERANCE, octave.get("octave", "not run"),
                        octave_cells.kernels(octave.get("blas", "")) or "not run")
    formats.write_study(options.out, SCHEMA, journal.context, settings, tables)
    journal.remove()


if __name__ == "__main__":
    if sys.argv[1:2] == [PROCESS]:
        block = json.loads(sys.argv[2])
        try:
            print(json.dumps(TIMED[block["what"]](block)))
        except Stop as problem:
            sys.exit(f"{PROGRAM}: {problem}")
    else:
        study.run(PROGRAM, main, sys.argv[1:])
