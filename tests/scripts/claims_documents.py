"""A small raw file of the study of claims, made up, whose every answer can be worked out by hand.

In Octave algebra takes half of group's time at s = 1, and 1.5 and 3 times at s = 2 and 3; a product takes a tenth of
the time of a run divided by its products. With the drawn modes plain formulations all take the same time with one ħ,
and group takes half of it with the other. On threads a run takes what the model says, times THREAD_OVERHEAD.
"""

import itertools
import os

import programs  # noqa: F401 (finds the modules of scripts/lib)

from lib.records import formats
from studies.claims.schema import (HBARS, SCHEMA, THREAD_CODES, SampleCell, OctaveCell, OctavePair, OctaveProduct, Rate,
                                   Settings, ThreadCell)
from lib.records.formats import FORMULATIONS, SOLVERS
from studies.claims.parallel_model import Rates, sweep_seconds

PROCESSES = (0.99, 1.01, 1.0, 1.0, 0.995, 1.005)  # times of all rows over their usual ones
OCTAVE = {"cotangent": (1.2, 1.2, 1.2), "group": (1.0, 1.0, 1.0), "algebra": (0.5, 1.5, 3.0)}  # seconds by s
PRODUCTS, SWEEPS = 1000, 500  # of a run
RATES = Rates(40e-6, 4e-6)
THREAD_OVERHEAD = 1.1
STEPS = 20


def processes(seconds, count=len(PROCESSES)):
    return [seconds * share for share in PROCESSES[:count]]


def tables(count=len(PROCESSES)):
    """Returns the tables, with times by so many processes."""
    octave = [OctaveCell(form, n, s, SWEEPS, PRODUCTS, 2e-14, processes(OCTAVE[form][s - 1], count))
              for n in (17, 33) for form in FORMULATIONS for s in (1, 2, 3)]
    samples = [SampleCell(17, hbar, sample, solver, form, s,
                      processes(0.5 if (form, hbar) == ("group", "standard") else 1.0, count))
             for hbar in HBARS for sample in range(2) for solver in SOLVERS for form in FORMULATIONS for s in (1, 2, 3)]
    threads = [ThreadCell(65, 0.1, STEPS, form, s, code, p, 400, 2000.0,
                          processes(THREAD_OVERHEAD * (400 + STEPS) * sweep_seconds(form, s, RATES, p), count))
               for s in (2, 3) for code in THREAD_CODES for form in FORMULATIONS for p in (1, 2)]
    pairs = [OctavePair(n, s, row, other, 3e-14) for n in (17, 33) for s in (1, 2, 3)
             for row, other in itertools.combinations(FORMULATIONS, 2)]
    products = [OctaveProduct(n, processes(1e-4, count)) for n in (17, 33)]
    return {"octave": octave, "octave_pairs": pairs, "octave_products": products, "samples": samples,
            "threads": threads,
            "rates": [Rate(65, processes(RATES.product, count), processes(RATES.single_pass, count))]}


def write_claims(folder, made=None, name="claims.json"):
    """Writes the raw file, by default of the tables above, and returns its path."""
    path = os.path.join(folder, name)
    formats.write_study(path, SCHEMA, {"cpu": "a processor", "blas_kernels": "Cooperlake"},
                        Settings(0.1, 50, 1e-13, "7.3.0", "Cooperlake"), made or tables())
    return path
