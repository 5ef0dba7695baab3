"""Tests of the NumPy module at states of any norm: energies, relative errors, steps.

Run with: python3 -m unittest test_module_norms (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import json
import math
import os
import sys
import tempfile
import unittest

from programs import BUILD, program, run

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np

import isosyrk

SMOOTH = isosyrk.scene("smooth", n=9)
# Powers of two, by which no digit changes, about 1e-300, 1e-155, 1e-100, 1e100, 1e155 and 1e300.
EXPONENTS = (-997, -515, -332, 332, 515, 997)


def scenes():
    return [SMOOTH, isosyrk.scene("rough", n=9, hbar="standard"), isosyrk.scene("rigid_body", n=5),
            isosyrk.scene("euler_top", n=3), isosyrk.scene("spin_chain", n=8), isosyrk.scene("symplectic", n=4),
            isosyrk.scene("pseudo_unitary", n=5, signature=(3, 2))]


def moved(scene):
    """Returns a state of a scene's algebra, some steps from its initial data."""
    return isosyrk.integrator(scene, "rk4").run(scene.initial, 0.05, 5)[0]


class Energies(unittest.TestCase):
    def test_energy_is_that_of_norm_one_times_the_square_or_refused(self):
        for scene in scenes():
            W = moved(scene)
            energy = scene.energy(W)
            self.assertNotEqual(energy, 0.0)
            for exponent in EXPONENTS:
                for nearby in range(exponent - 3, exponent + 4):
                    with self.subTest(scene=scene.name, exponent=nearby):
                        try:
                            wanted = math.ldexp(energy, 2 * nearby)
                        except OverflowError:
                            wanted = math.inf
                        if math.isfinite(wanted) and abs(wanted) >= sys.float_info.min:
                            self.assertEqual(scene.energy(2.0**nearby * W), wanted)
                        else:
                            with self.assertRaisesRegex(
                                    ValueError, r"^energy: is about 1e-?\d{3} for this W of norm \d.*, which no double"
                                    " holds; that of c W is c\\^2 times as large$"):
                                scene.energy(2.0**nearby * W)

    def test_the_largest_and_the_least_energy_of_a_double_are_right(self):
        # Here squares of W overflow or underflow, while the energy does not.
        energy = SMOOTH.energy(SMOOTH.initial)
        exponent = (1023 - math.frexp(energy)[1]) // 2
        self.assertEqual(SMOOTH.energy(2.0**exponent * SMOOTH.initial), math.ldexp(energy, 2 * exponent))
        exponent = -((1021 + math.frexp(energy)[1]) // 2)
        self.assertEqual(SMOOTH.energy(2.0**exponent * SMOOTH.initial), math.ldexp(energy, 2 * exponent))

    def test_of_0_and_of_what_is_not_finite(self):
        self.assertEqual(SMOOTH.energy(np.zeros((9, 9))), 0.0)
        for value in (np.nan, np.inf):
            self.assertFalse(np.isfinite(SMOOTH.energy(np.full((9, 9), value, complex))))

    def test_an_energy_of_ones_own_is_what_it_returns(self):
        scene = isosyrk.scene(initial=SMOOTH.initial, generator=SMOOTH.generator,
                              hamiltonian=lambda W: np.linalg.norm(W)**3)
        self.assertEqual(scene.energy(8 * SMOOTH.initial), np.linalg.norm(8 * SMOOTH.initial)**3)


class Errors(unittest.TestCase):
    def test_relative_errors_are_those_of_norm_one(self):
        W0 = isosyrk.scene("rough", n=9).initial
        W = moved(isosyrk.scene("rough", n=9))
        W += 1e-9 * np.diag(np.diag(W))
        for exponent in EXPONENTS:
            V, V0 = 2.0**exponent * W, 2.0**exponent * W0
            with self.subTest(exponent=exponent):
                self.assertEqual(isosyrk.relative_error(V, V0), isosyrk.relative_error(W, W0))
                np.testing.assert_allclose(isosyrk.casimir_errors(V, V0), isosyrk.casimir_errors(W, W0), 1e-3, 1e-14)
                self.assertEqual(isosyrk.angular_momentum_error(V, V0), isosyrk.angular_momentum_error(W, W0))
                found = isosyrk.spectrum_error(V, V0) * 2.0**-exponent
                self.assertAlmostEqual(found, isosyrk.spectrum_error(W, W0), 13)
                np.testing.assert_allclose(isosyrk.spectrum(V) * 2.0**-exponent, isosyrk.spectrum(W), atol=1e-14)
        self.assertGreater(isosyrk.casimir_errors(W, W0)[0], 1e-11)  # the control: there is an error

    def test_integrate_reports_the_energy_error_of_norm_one(self):
        def result(W, step):
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "W.npy")
                np.save(path, W)
                done = run([program("integrate"), "--n", "9", "--integrator", "group2", "--step", repr(step), "--time",
                            repr(10 * step), "--initial", path, "--json"])
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            return json.loads(done.stdout)

        wanted = result(SMOOTH.initial, 0.125)
        self.assertGreater(wanted["energy_error"], 1e-12)
        for exponent in EXPONENTS:
            found = result(2.0**exponent * SMOOTH.initial, 0.125 * 2.0**-exponent)
            self.assertAlmostEqual(found["energy_error"] / wanted["energy_error"], 1, 3, exponent)


class Steps(unittest.TestCase):
    def test_steps_are_those_of_norm_one(self):
        for entry in isosyrk.integrators():
            for solver in isosyrk.SOLVERS if entry.has_fast_form else ("published",):
                wanted, _ = isosyrk.integrator(SMOOTH, entry.name, solver=solver).run(SMOOTH.initial, 0.125, 4)
                for exponent in EXPONENTS:
                    with self.subTest(name=entry.name, solver=solver, exponent=exponent):
                        method = isosyrk.integrator(SMOOTH, entry.name, solver=solver)
                        W, _ = method.run(2.0**exponent * SMOOTH.initial, 0.125 * 2.0**-exponent, 4)
                        self.assertLess(isosyrk.relative_error(W, 2.0**exponent * wanted), 1e-12)
