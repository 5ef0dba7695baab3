"""Tests of the explicit methods against SciPy's: the same tableaux, by other hands.

Run with: python3 -m unittest test_scipy (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import os
import sys
import unittest

from programs import BUILD

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np
import scipy.integrate

import isosyrk

STEP, STEPS = 0.125, 16  # sums of the step are exact, so SciPy takes as many


def solution(solver, scene):
    """Returns W after STEPS steps of one of SciPy's solvers, which accepts every step: its tolerance is no bound."""
    shape = scene.initial.shape

    def slope(_, w):
        W = w.reshape(shape)
        B = scene.generator(W)
        return (B @ W - W @ B).ravel()

    taken = solver(slope, 0.0, scene.initial.ravel(), STEP * STEPS, first_step=STEP, max_step=STEP, rtol=1e6, atol=1e6)
    steps = 0
    while taken.status == "running":
        taken.step()
        steps += 1
    assert steps == STEPS, steps
    return taken.y.reshape(shape)


class Answers(unittest.TestCase):
    def test_rk8_is_dop853_and_rk5_is_rk45(self):
        for scene in (isosyrk.scene("smooth", n=17), isosyrk.scene("rough", n=9)):
            for name, solver in (("rk8", scipy.integrate.DOP853), ("rk5", scipy.integrate.RK45)):
                expected = solution(solver, scene)
                for form in ("published", "fast"):
                    with self.subTest(scene=scene.name, name=name, form=form):
                        W, _ = isosyrk.integrator(scene, name, solver=form).run(scene.initial, STEP, STEPS)
                        self.assertLess(np.abs(W - expected).max(), 1e-13)
            other, _ = isosyrk.integrator(scene, "rk10").run(scene.initial, STEP, STEPS)
            self.assertGreater(np.abs(other - solution(scipy.integrate.RK45, scene)).max(), 1e-11)


if __name__ == "__main__":
    unittest.main()
