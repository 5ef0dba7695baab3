"""What the study `theorem` compares and times: scenes, sizes, steps and methods."""

import itertools
from functools import lru_cache
from typing import NamedTuple

from lib.records.formats import FORMULATIONS
from lib.records.integrators import COMPOSITION, TABLE1_CELLS
from lib.running import built

SMALL = {"smooth": 9, "rough": 9, "euler_top": 3, "rigid_body": 6, "spin_chain": 10, "symplectic": 6,
         "pseudo_unitary": 5}  # n of the runs in which the formulations are compared
STAGES, NORMS = (1, 2, 3), (0.1, 0.3, 0.6)  # of these runs; the norms are h‖B(W₀)‖₂
TIMED = {  # scenes, and n for a given size: some must be even, and a step of the chain costs little
    "smooth": int, "rigid_body": int, "symplectic": lambda n: n - n % 2, "pseudo_unitary": int,
    "spin_chain": lambda n: CHAIN * (n - n % 2)}
TIMED_DIRK = ("smooth", "rigid_body", "spin_chain")
SIZES, QUICK_SIZES = (65, 129), (33,)
CHAIN = 4  # times as large is n of the spin chain, and as long are its runs, so that packing W does not weigh
TIMED_NORMS = (0.05, 0.1, 0.25, 0.5)  # h‖B(W₀)‖₂ of timed runs
FEW_NORMS = (0.1, 0.5)  # the same with --quick, and beyond SMALL_N
QUICK_PROCESSES = 8  # at most
SMALL_N = 65  # up to it a process has a warm run and repeats; beyond it a run is so long that neither shows
STEPS, TIMED_STEPS, TOLERANCE, REPETITIONS = 10, 5, 1e-13, 3


class Cell(NamedTuple):
    """What an integrator is in the tables; `on_g` names the same method on g."""

    table: str
    method: str
    formulation: str
    on_g: str


@lru_cache(maxsize=None)
def known_methods():
    """Returns the Integrators that the study is about, by name: those of Table 1, and compositions, on g."""
    return {name: each for name, each in built.integrators().items()
            if name in TABLE1_CELLS or (each.family == COMPOSITION and not each.co_rotating)}


@lru_cache(maxsize=None)
def cells():
    """Returns the Cells by integrator: the compositions in each formulation, whose controls are not in the list."""
    schemes = [name for name, each in known_methods().items() if each.family == COMPOSITION]
    return {**{f"{form}{s}": Cell("cost", f"s = {s}", form, f"algebra{s}") for s in STAGES for form in FORMULATIONS},
            **{name if form == "algebra" else f"{name}_{form}": Cell("dirk", name, form, name)
               for name in schemes for form in FORMULATIONS}}


def blocks_of(scenes, sizes, names, quick, products):
    """Returns what is timed together: scene, n, h‖B(W₀)‖₂, number of steps and repetitions, and integrators as rows."""
    found = []
    for scene, size in itertools.product(scenes, sizes):
        if scene not in TIMED:
            continue
        chain = scene == "spin_chain"
        n, small = TIMED[scene](size), chain or size <= SMALL_N
        rows = [name for name, cell in cells().items() if cell.method in names or name in names
                if cell.table == "cost" or scene in TIMED_DIRK]
        found += [{"scene": scene, "n": n, "h_norm_B": norm, "products": products(size),
                   "steps": TIMED_STEPS * (CHAIN if chain else 1), "repetitions": REPETITIONS if small else 1,
                   "warm": small, "rows": rows} for norm in (TIMED_NORMS if small and not quick else FEW_NORMS)]
    return found
