"""What the names of integrators say: which are forms of one Gauss method, and which run in the co-rotating frame.

And what integrators keep.
"""

import re

from lib.formats import FORMULATIONS

# A row for each s, a column for each formulation.
TABLE1_CELLS = tuple(f"{formulation}{s}" for s in (1, 2, 3) for formulation in FORMULATIONS)

# What can be asked for, from the least to the most: a Lie–Poisson integrator keeps the spectrum too.
KEPT = {"nothing": "nothing", "spectrum": "the spectrum", "poisson": "the Lie–Poisson structure"}

FRAME = "_frame"  # ends the name of an integrator in the co-rotating frame


def in_frame(name):
    return name.endswith(FRAME)


def gauss_stages(name):
    """Returns s of a formulation of the s-stage Gauss method, or None for any other integrator."""
    match = re.fullmatch(rf"(?:{'|'.join(FORMULATIONS)})([0-9]+)", name)
    return int(match[1]) if match else None


def is_exponential(name):
    """Tells whether an integrator solves for Ω: such methods keep the spectrum to rounding at any tolerance."""
    return re.match("elp|magnus|bm|cg", name) is not None


def frameless(name):
    """Returns the name of the integrator without the co-rotating frame."""
    return name.removesuffix(FRAME)


def family(name):
    """Returns the name of an integrator up to its order, as "rk" of rk4_projected_frame."""
    return re.match("[a-z_]*[a-z]", name)[0]


def method_name(integrator):
    """Returns the name of its method, one for all formulations and in the frame or not, as "Gauss, order 4"."""
    name = frameless(integrator.name)
    families = {**dict.fromkeys(FORMULATIONS, "Gauss"), "direct": "direct Gauss", "yoshida": "Yoshida",
                "suzuki": "Suzuki", "kahan_li": "Kahan–Li", "rkmk": "RKMK", "rk": "Runge–Kutta",
                "abm": "Adams–Bashforth–Moulton", "elp": "exponential Lie–Poisson", "magnus": "explicit Magnus",
                "bm": "Bogfjellmo–Marthinsen", "cg": "Crouch–Grossman"}
    projected = "projected " if name.endswith("_projected") else ""
    return f"{projected}{families.get(family(name), family(name))}, order {integrator.order}"


def strongest_structure(integrator):
    """Returns the strongest structure that an integrator keeps."""
    return next(structure for structure in reversed(KEPT) if integrator.keeps(structure))
