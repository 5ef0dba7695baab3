"""The initial states that limits of step sizes are measured on: a scene's own, and others drawn like it.

The study of claims draws its modes here too. Draws come from seeds and are not kept. Needs NumPy and isosyrk.
"""

import functools
import math

import isosyrk
import numpy

from lib.records.settings import SCENES
from lib.running.problems import DEVELOPED_TIME

SMOOTH, ROUGH, DEVELOPED = SCENES
SMOOTHEST = 4  # largest l of the smooth scene
DEVELOPING_STEP = 0.25  # to DEVELOPED_TIME
STATES = 3  # of a scene: its own, number 0, and the drawn ones


def drawn_modes(scene, n, number):
    """Returns the modes (l, m, re, im) of drawn state `number` ≥ 1, with E|ω_lm|² as in the named scene.

    In the smooth scene all modes with l ≤ 4 have one variance. In the rough scene E|ω_lm|² = (l + 1) / (l² (2l + 1)),
    so that energy falls as l⁻³ on average. A mode is the same for every n. Source: core/scenes/modes.h.
    """
    degrees = range(1, n if scene == ROUGH else SMOOTHEST + 1)
    sizes = {degree: math.sqrt((degree + 1) / (degree**2 * (2 * degree + 1))) if scene == ROUGH else 1.0
             for degree in degrees}
    return modes_of_sizes(sizes, (SCENES.index(scene), number))


def modes_of_sizes(sizes, seed):
    """Returns drawn modes (l, m, re, im) with E|ω_lm|² = size², given a dict of sizes by degree l.

    `seed` is a tuple of whole numbers. A mode does not depend on the other degrees. A mode with m = 0 is real, so that
    the vorticity is.
    """
    modes = []
    for degree, size in sizes.items():
        random = numpy.random.default_rng((*seed, degree))
        modes.append((degree, 0, size * random.standard_normal(), 0.0))
        for order in range(1, degree + 1):
            real, imaginary = random.standard_normal(2) * size / math.sqrt(2)
            modes.append((degree, order, real, imaginary))
    return modes


@functools.lru_cache(maxsize=8)
def scene_of(scene, n, number):
    """Returns the isosyrk scene of initial state `number` (0 … STATES - 1), with spectral norm 1."""
    if scene == DEVELOPED:
        start = scene_of(SMOOTH, n, number)
        develop = isosyrk.integrator(start, "elp6_frame", solver="fast")
        W, _ = develop.run(start.initial, h=DEVELOPING_STEP, steps=round(DEVELOPED_TIME / DEVELOPING_STEP))
        return isosyrk.scene(DEVELOPED, initial=W)
    if number == 0:
        return isosyrk.scene(scene, n=n)
    return isosyrk.scene(scene, n=n, modes=drawn_modes(scene, n, number))
