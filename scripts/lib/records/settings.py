"""What studies share: scenes, problems, and the tolerances that methods run at."""

import math
from typing import NamedTuple

from lib.records.integrators import GAUSS, IMPLICIT_EXPONENTIAL, MAGNUS

SCENES = ("smooth", "rough", "developed")
TABLE1_STEP = 0.1  # the step size of Table 1, where the tolerances were varied too

# Tolerances of the iteration: that of Table 1, and by family the loosest that was seen to leave the trajectory alone.
# At it, a Gauss method keeps the spectrum to about the tolerance only, an exponential method to rounding.
TIGHT = 1e-13
LOOSE_GAUSS, LOOSE_EXPONENTIAL = 1e-7, 1e-8
LOOSE = {GAUSS: LOOSE_GAUSS, **dict.fromkeys((*IMPLICIT_EXPONENTIAL, MAGNUS), LOOSE_EXPONENTIAL)}
# The tolerance at which the energy of exponential Lie–Poisson methods stays bounded, as the study of long runs measures
# it. At a looser one errors of the Lie–Poisson structure add up, and the energy drifts.
ENERGY_BOUNDED = 1e-13
MATCHED = 100  # so many times smaller than an error is a tolerance that is matched to it


class Problem(NamedTuple):
    scene: str
    time: float
    n: int

    def __str__(self):
        return f"{self.scene}, T = {self.time:g}, n = {self.n}"


def steps_to(time, step):
    """Returns the least number of steps that reach a time; a step that divides it but for rounding does."""
    return math.ceil(time / step * (1 - 1e-12))


def keeps(integrator, tolerance, structure):
    """Tells whether an Integrator keeps a structure at a tolerance."""
    maximum = {"nothing": math.inf, "spectrum": math.inf if integrator.spectrum_at_any_tolerance else TIGHT,
               "poisson": ENERGY_BOUNDED}
    return integrator.keeps(structure) and tolerance <= maximum[structure]


def keeping_tolerance(integrator, structure="spectrum"):
    """Returns the loosest tolerance that an Integrator is run at and keeps a structure, which it keeps at TIGHT."""
    loose = LOOSE.get(integrator.family, TIGHT)
    return loose if keeps(integrator, loose, structure) else TIGHT
