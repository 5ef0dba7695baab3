"""The raw file of the study `theorem`: where the formulations coincide, which is the fastest, what they cost, and where
the theorem ends."""

from typing import NamedTuple

from lib.programs.messages import UnusableFile
from lib.records import formats
from lib.records.formats import (FORMULATIONS, INTEGRATORS, Integrator, Schema, list_of, number, one_of, optional,
                                 positive, text, whole)

PAIRS = ("cotangent–group", "group–algebra", "cotangent–algebra")
SCENES = {  # the algebra, and the arithmetic of its steps
    "smooth": ("su(n)", "complex, Poisson solves"), "rough": ("su(n)", "complex, Poisson solves"),
    "euler_top": ("so(3)", "real"), "rigid_body": ("so(n)", "real"), "spin_chain": ("su(2)^N", "complex 2 × 2 blocks"),
    "symplectic": ("sp(n)", "real, products with J"), "pseudo_unitary": ("su(p,q)", "complex, products with J")}
# Of what is changed where the theorem ends.
NOTHING, PRINTED_K, PRINTED_W = "nothing", "K as printed", "W̃ as printed"
PARTITIONED = "a partitioned pair on T*G"
AT_ROUNDING = 1e-12  # differences of one step that are below stem from rounding
FOOTNOTE = "footnote"
# Name, the table and the methods it is about (None: all that the table has), and the formulation said to be fastest.
CLAIMS = (
    ("(a)", "cost", ("s = 1",), "algebra"), ("(b)", "cost", ("s = 2", "s = 3"), "group"),
    (FOOTNOTE, "dirk", None, "algebra"))
CHAIN = "spin_chain"


class Settings(NamedTuple):
    steps: whole(1)  # of a run in which the formulations are compared
    timed_steps: whole(1)  # of a timed run; the spin chain's are longer
    tolerance: positive
    ends_n: whole(2)  # of the rigid body on which the theorem ends
    ends_step: positive


class Coincidence(NamedTuple):
    """Runs of the three formulations with s-stage Gauss; errors are the largest over those that converge."""

    scene: text
    n: whole(2)
    stages: whole(1)
    h_norm_B: positive
    difference: number  # largest entry of the difference of two of them
    algebra_defect: number  # largest entry of |W†J + JW|
    casimir_error: number  # largest |tr Wᵏ - tr W₀ᵏ| / Σ|λ|ᵏ, k = 2 … 5
    sweeps: list_of(optional(number), 3)  # of a step, by formulation; None for one that fails
    bound: number  # of the difference: steps · tolerance / (1 - contraction)


class End(NamedTuple):
    """One step of the plain formulations, with one thing changed."""

    changed: text
    case: text
    stages: whole(1)
    differences: list_of(number, 3)  # of PAIRS: largest entry
    casimir_errors: list_of(number, 3)  # of FORMULATIONS
    algebra_defect: number  # largest of the three
    order: optional(number)  # observed, of the form on g

    def difference(self, pair):
        """Returns the difference of one of PAIRS."""
        return self.differences[PAIRS.index(pair)]

    def casimir_error(self, formulation):
        return self.casimir_errors[FORMULATIONS.index(formulation)]


class Timed(NamedTuple):
    """A method, "s = 2" of Gauss or a composition of midpoint steps, in one formulation; costs are those of a step.

    Where the Picard sweeps of a step fail, there are no costs and no times.
    """

    scene: text
    n: whole(2)
    h_norm_B: positive  # h‖B(W₀)‖₂
    method: text
    formulation: one_of(*FORMULATIONS)
    sweeps: optional(number)
    products: optional(number)
    difference: optional(number)  # from the answer on g: largest entry; None where either fails
    # CPU seconds, one entry a process: the median of its repetitions. The processes of the formulations of one method
    # are the same, in the same order.
    seconds: list_of(positive)


SCHEMA = Schema("theorem", Settings, {INTEGRATORS: Integrator, "coincidence": Coincidence, "ends": End, "cost": Timed,
                                      "dirk": Timed}, later=(INTEGRATORS,))


def read_theorem(path):
    """Returns the Study in `path`. Throws UnusableFile with one line that names the file."""
    return formats.read_study(path, SCHEMA, checked)


def checked(study):
    """Returns a study. Throws UnusableFile for one without rows, or with times that are not of the same processes."""
    for name in ("coincidence", "ends"):
        if not study.tables[name]:
            raise UnusableFile(f"has no rows of {name}")
    for name in ("cost", "dirk"):
        for row in study.tables[name]:
            if (row.sweeps is None) == bool(row.seconds):
                raise UnusableFile(f"has a row of {name} with sweeps and no time, or with times and no sweeps")
        for block in comparisons(study.tables[name]).values():
            if len({len(row.seconds) for row in block if row.seconds}) > 1:
                raise UnusableFile(f"has formulations of {name} that were not timed by the same processes")
    return study


# ---- tables


def by(rows, *fields):
    """Returns lists of the rows that agree in some fields, by the tuple of these."""
    found = {}
    for row in rows:
        found.setdefault(tuple(getattr(row, field) for field in fields), []).append(row)
    return found


def comparisons(rows):
    """Returns the rows that are compared with one another, by scene, n, h‖B‖ and method."""
    return by(rows, "scene", "n", "h_norm_B", "method")


def methods_of(rows):
    return list(dict.fromkeys(row.method for row in rows))


def times_of(block):
    """Returns the seconds of the formulations that converge, by formulation."""
    return {row.formulation: row.seconds for row in block if row.seconds}
