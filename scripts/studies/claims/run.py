"""Measures what became of the paper's claims in GNU Octave, with other initial data, and on two threads.

Octave's cells are checked against those of C++ first. Each process on one core times, interleaved, all that is
compared; verdicts.py says how many processes tell which formulation is fastest. Tables 1 and 2 are not measured again:
the renderer reads those recorded, and scripts/reproduce measures them with AVX2 kernels beside this study.
"""

import itertools
import math
import os
import random
import statistics
import tempfile
import time
from functools import partial

import isosyrk
import numpy as np

from lib.programs.command_line import NO_ANSWER, Stop, whole_number
from lib.programs.messages import one_line
from lib.records import formats
from lib.records.formats import FAST, INTEGRATORS, SOLVERS
from lib.records.table_file import CellKey, Measurement, Run
from lib.records.integrators import TABLE1_CELLS
from lib.judging import verdicts
from lib.running import built, initial_states, program, timed, untimed
from lib.running.checkpoint import Checkpoint
from studies.claims import octave_cells
from studies.claims.schema import (EQUAL, HBARS, SCHEMA, WITHOUT, OctaveCell, OctavePair, OctaveProduct, Rate,
                                   SampleCell, Settings, ThreadCell)
from studies.tables import judge as claims

STEP, STEPS, TOLERANCE = 0.1, 50, 1e-13
SIZES, QUICK_SIZES = (17, 33, 65, 129), (17, 33)
SEVERAL_UP_TO = 33  # the n up to which a process runs a cell more than once
REPETITIONS = 2  # of which the least counts
SAMPLES, QUICK_SAMPLES = 5, 2  # with each ħ
SAMPLE_SIZES, QUICK_SAMPLE_SIZES = (17, 33, 65), (17,)
# n of the runs by threads, with their h and number of steps: h‖B(W₀)‖₂ is that of n = 129 in Table 1 from there on.
THREAD_RUNS = {65: (0.1, 20), 129: (0.1, 10), 257: (0.05, 5)}
QUICK_THREAD_SIZES = (65,)
THREAD_STAGES, THREADS = (2, 3), (1, 2)
PRODUCT, PASS = "product", "pass"  # rows of what is timed beside cells
SECONDS_OF_PASSES = 0.02
NOT_RUN = "not run"  # in place of Octave's version


# ---- GNU Octave


def octave_answers(job):
    """Runs the cells of one n and s in GNU Octave.

    Returns each cell's counts and how far its answer is from that in C++, and how far the answers of two cells are
    apart: the largest entry of a difference.
    """
    scene = isosyrk.scene("smooth", n=job["n"])
    answers, cells = {}, {}
    with tempfile.TemporaryDirectory(prefix="isosyrk-") as folder:
        initial = os.path.join(folder, "initial.npy")
        np.save(initial, scene.initial)
        for cell in octave_cells.run(initial, job["cells"], STEP, STEPS, folder=folder)["cells"]:
            name = cell["cell"]
            answers[name] = np.load(os.path.join(folder, f"{name}.npy"))
            ours, _ = isosyrk.integrator(scene, name, tolerance=TOLERANCE).run(scene.initial, STEP, STEPS)
            cells[name] = {"sweeps": cell["sweeps"], "products": cell["products"],
                           "difference": largest_entry(answers[name] - ours)}
    return {"cells": cells, "pairs": [{"row": row, "other": other,
                                       "difference": largest_entry(answers[row] - answers[other])}
                                      for row, other in itertools.combinations(job["cells"], 2)]}


def largest_entry(matrix):
    return float(abs(matrix).max())


def time_octave(block):
    """Returns the CPU seconds of the cells of a block, in an order of this process, and of a product."""
    cells = [row for row in block["rows"] if row != PRODUCT]
    random.Random(block["process"]).shuffle(cells)
    with tempfile.TemporaryDirectory(prefix="isosyrk-") as folder:
        initial = os.path.join(folder, "initial.npy")
        np.save(initial, isosyrk.scene("smooth", n=block["n"]).initial)
        found = octave_cells.run(initial, cells, STEP, STEPS, block["repetitions"])
    require_same_kernels(found["blas"], block["kernels"])
    seconds = {cell["cell"]: cell["seconds"] for cell in found["cells"]}
    return [{**seconds, PRODUCT: found["product_seconds"]}[row] for row in block["rows"]]


def require_same_kernels(blas, kernels):
    """Throws Stop unless Octave runs on the kernels of OpenBLAS that the module runs on."""
    if octave_cells.kernels(blas) != kernels:
        raise Stop(f"octave: its BLAS is {one_line(blas)}, not OpenBLAS with kernels {kernels}; choose it with"
                   " update-alternatives", NO_ANSWER)


def require_equal(n, cell, answers):
    if not answers["difference"] <= EQUAL:
        raise Stop(f"octave: {cell} at n = {n} ends {answers['difference']:.1e} from the published form, more than"
                   f" {EQUAL:g}", NO_ANSWER)


# ---- other initial data


def time_sample(block):
    """Returns the CPU seconds of the rows of a block, "published group2" and so on, the least of its repetitions."""
    modes = initial_states.drawn_modes(initial_states.SMOOTH, block["n"], block["sample"] + 1)  # 0 is the scene's own
    scene = isosyrk.scene("drawn", n=block["n"], hbar=block["hbar"], modes=modes)
    shuffled = random.Random(block["process"])
    found = {row: [] for row in block["rows"]}
    for _ in range(block["repetitions"]):
        for row in shuffled.sample(block["rows"], len(block["rows"])):
            solver, name = row.split()
            products = {} if solver == FAST else {"products": block["products"]}
            method = isosyrk.integrator(scene, name, solver=solver, tolerance=TOLERANCE, **products)
            found[row].append(timed.seconds_of(method, scene.initial, STEP, STEPS))
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
    """Returns the seconds that pass in the rows of a block, "sweeps group2 2" and so on, and those of its rates."""
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


def formulation_of(name):
    return built.integrators()[name].formulation


def stages_of(name):
    return built.integrators()[name].stages


def table_of(times):
    """Returns the times by process of cells such as "group2", all at one n, as the Run of a table with n = 0."""
    return Run({}, {CellKey(formulation_of(name), 0, stages_of(name)): Measurement(dict(enumerate(seconds)))
                    for name, seconds in times.items()})


def further(options, verdicts_on, seconds):
    """Returns how many further processes each row of a block wants; all rows of a block stop together."""
    return dict.fromkeys(seconds, verdicts.further_processes(options.processes, seconds, verdicts_on))


def of_octave(seconds):
    """Returns every verdict on pairs of rows and on claims."""
    return claims.block_verdicts(table_of({row: found for row, found in seconds.items() if row != PRODUCT}), 0)


def of_samples(seconds):
    """Returns the verdicts on claims: a pair of rows that no claim is about needs no further process."""
    tables = (table_of({row.split()[1]: found for row, found in seconds.items() if row.startswith(solver)})
              for solver in SOLVERS)
    return {each.result for table in tables for each in claims.judged(table, 0)}


def of_threads(seconds):
    """Returns nothing: the table of threads takes the fewest processes that give an interval."""
    return ()


# ---- the study


TIMED = {"octave": time_octave, "samples": time_sample, "threads": time_threads}


def time_block(block):
    """Returns the CPU seconds of each row of a block."""
    return TIMED[block["what"]](block)


def row_of(name):
    """Returns the fields of a row on a cell such as "group2"."""
    return {"formulation": formulation_of(name), "stages": stages_of(name)}


def times_of(blocks, verdicts_on, checkpoint, options, what, cores=None):
    return timed.by_processes(blocks, partial(program.process_command, "claims"),
                              partial(further, options, verdicts_on), checkpoint, what, cores) if blocks else []


def octave_tables(options, sizes, names, checkpoint):
    """Returns the tables of Octave: its cells, their pairs, and its products.

    The checkpoint keeps answers of any processor; on which kernels Octave runs is asked where it is timed.
    """
    by_stages = {s: [name for name in names if stages_of(name) == s] for s in map(stages_of, names)}
    jobs = [{"n": n, "cells": cells} for n in sizes for cells in by_stages.values()]
    answers = untimed.results(jobs, octave_answers, checkpoint, options, "checking Octave's answers") if jobs else []
    counted, pairs = {}, []
    for job, each in zip(jobs, answers):
        for name, counts in each["cells"].items():
            require_equal(job["n"], name, counts)
            counted[job["n"], name] = counts
        pairs += [OctavePair(n=job["n"], stages=stages_of(pair["row"]), row=formulation_of(pair["row"]),
                             other=formulation_of(pair["other"]), difference=pair["difference"])
                  for pair in each["pairs"]]
    blocks = [{"what": "octave", "n": n, "rows": [*names, PRODUCT], "kernels": checkpoint.context["blas_kernels"],
               "repetitions": REPETITIONS if n <= SEVERAL_UP_TO else 1} for n in sizes]
    seconds = times_of(blocks, of_octave, checkpoint, options, "timing Octave")
    cells = [OctaveCell(**row_of(name), n=block["n"], **counted[block["n"], name], seconds=found[name])
             for block, found in zip(blocks, seconds) for name in names]
    products = [OctaveProduct(block["n"], found[PRODUCT]) for block, found in zip(blocks, seconds)]
    return {"octave": cells, "octave_pairs": pairs, "octave_products": products}


def draw_table(options, sizes, names, checkpoint):
    samples = QUICK_SAMPLES if options.quick else SAMPLES
    blocks = [{"what": "samples", "n": n, "hbar": hbar, "sample": sample, "products": checkpoint.products(n),
               "repetitions": REPETITIONS if n <= SEVERAL_UP_TO else 1,
               "rows": [f"{solver} {name}" for solver in SOLVERS for name in names]}
              for n in sizes for hbar in HBARS for sample in range(samples)]
    seconds = times_of(blocks, of_samples, checkpoint, options, "timing samples")
    return [SampleCell(**{field: block[field] for field in ("n", "hbar", "sample")}, implementation=solver,
                       **row_of(name), seconds=found[f"{solver} {name}"])
            for block, found in zip(blocks, seconds) for solver in SOLVERS for name in names]


def thread_tables(options, sizes, names, checkpoint):
    """Returns the tables of fast forms by threads and of rates; without a second core those of one thread.

    A process that times threads has all cores from its beginning: what OpenMP finds then decides if threads wait for
    each other by looking or asleep, and asleep a run at n = 65 takes up to five times as long.
    """
    cores = os.sched_getaffinity(0)
    threads = [each for each in THREADS if each <= len(cores)]
    checkpoint.context["cores"] = f"{len(cores)}"
    names = [name for name in names if stages_of(name) in THREAD_STAGES]
    sizes = sizes if names else ()
    runs = {n: dict(zip(("step", "steps"), THREAD_RUNS[n])) for n in sizes}
    jobs = [{"n": n, "name": name, "code": code, **runs[n]} for n in sizes for name in names for code in WITHOUT]
    counts = untimed.results(jobs, count_threads, checkpoint, options, "counting for threads") if jobs else []
    counted = {(job["n"], job["name"], job["code"]): each for job, each in zip(jobs, counts)}
    blocks = [{"what": "threads", "n": n, **runs[n],
               "rows": [PRODUCT, PASS, *(f"{code} {name} {each}" for code in WITHOUT for name in names
                                         for each in threads)]} for n in sizes]
    seconds = times_of(blocks, of_threads, checkpoint, options, "threads", cores)
    cells = [ThreadCell(n=block["n"], **runs[block["n"]], **row_of(name), code=code, threads=each,
                        **counted[block["n"], name, code], seconds=found[f"{code} {name} {each}"])
             for block, found in zip(blocks, seconds) for code in WITHOUT for name in names for each in threads]
    return {"threads": cells,
            "rates": [Rate(block["n"], found[PRODUCT], found[PASS]) for block, found in zip(blocks, seconds)]}


def chosen(sizes, wanted):
    """Returns those of some sizes that --n names; all of them without it."""
    return [n for n in sizes if not wanted or n in wanted]


def main(arguments):
    parser = program.parser("claims", __doc__.splitlines()[0])
    parser.add_argument("--processes", type=whole_number(1, 100), default=None, help="that time a block at most; with"
                        f" fewer than {verdicts.FEWEST} all is undecided (default: {verdicts.MAXIMUM}, quick"
                        f" {verdicts.FEWEST})")
    options = parser.parse_args(arguments)
    options.processes = options.processes or (verdicts.FEWEST if options.quick else verdicts.MAXIMUM)
    names = [name for name in TABLE1_CELLS if not options.integrator or name in options.integrator]
    for name in options.integrator or ():
        if name not in TABLE1_CELLS:
            raise Stop(f"--integrator {one_line(name)!r}: must be one of {', '.join(TABLE1_CELLS)}")
    full = (SIZES, SAMPLE_SIZES, tuple(THREAD_RUNS))
    sizes = [chosen(each, options.n) for each in
             ((QUICK_SIZES, QUICK_SAMPLE_SIZES, QUICK_THREAD_SIZES) if options.quick and not options.n else full)]
    known = sorted({n for each in full for n in each})
    for n in options.n or ():
        if n not in known:
            raise Stop(f"--n {n}: must be one of {', '.join(map(str, known))}")

    checkpoint = Checkpoint("claims", options, partial(isosyrk.conditions, products="fastest",
                                                      sizes=sorted({*sizes[0], *sizes[1]})))
    tables = octave_tables(options, sizes[0], names, checkpoint)
    tables |= thread_tables(options, sizes[2], names, checkpoint)
    tables |= {"samples": draw_table(options, sizes[1], names, checkpoint), INTEGRATORS: built.entries(names)}
    octave = {"octave": octave_cells.version(), "octave_kernels": checkpoint.context["blas_kernels"]} if sizes[0] else \
        {"octave": NOT_RUN, "octave_kernels": NOT_RUN}
    settings = Settings(step=STEP, steps=STEPS, tolerance=TOLERANCE, **octave)
    formats.write_study(options.out, SCHEMA, checkpoint.context, settings, tables)
    checkpoint.remove()
