"""Tests of what the NumPy module says of the fluid: coefficients, energies, ω on the sphere, pictures, Δ and Δ⁻¹.

Run with: python3 -m unittest test_module_fluid (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import math
import os
import sys
import unittest
from unittest import mock

from programs import BUILD, environment, run
from test_quflow import Quflow

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np
from numpy.polynomial import legendre

import isosyrk
from isosyrk import _core

LATITUDES = np.array([-np.pi / 2, -1.2, -0.3, 0.0, 0.7, np.pi / 2])
LONGITUDES = np.array([-4.0, 0.0, 0.4, 2.5, 7.0])
POINTS = [(0.3, 1.1), (-1.2, 2.8), (1.4, -2.0), (0.0, 0.0)]  # latitude, longitude


def state(n, seed=1):
    """Returns some W of every degree, with a trace."""
    entries = np.random.default_rng(seed).normal(size=(2, n, n)) / n
    W = entries[0] + 1j * entries[1]
    return W - W.conj().T


def coordinates(n):
    """Returns the matrices of x, y and z: -i times them are Hermitian, and their field is a coordinate."""
    s = (n - 1) / 2
    m = s - np.arange(n)
    up = np.diag(np.sqrt(s * (s + 1) - m[1:] * (m[1:] + 1)), 1)
    return [2j / np.sqrt(n**2 - 1) * S for S in ((up + up.T) / 2, (up.T - up) / 2j, -np.diag(m))]


def direction(latitude, longitude):
    return np.array([np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)])


def angles(point):
    """Returns latitude and longitude of a unit vector."""
    return np.arcsin(np.clip(point[2], -1, 1)), np.arctan2(point[1], point[0])


def legendre_function(l, m, latitude):
    """Returns P_lm without phase, of mean square 1 over the sphere with exp(imλ), from the derivatives of P_l."""
    size = math.sqrt((2 * l + 1) * math.factorial(l - m) / math.factorial(l + m))
    return size * np.cos(latitude)**m * legendre.Legendre.basis(l).deriv(m)(np.sin(latitude))


def at(W, point, **options):
    """Returns ω at a point (latitude, longitude)."""
    return isosyrk.vorticity(W, point[:1], point[1:], **options)[0, 0]


def turned(W, axis, angle):
    """Returns U W U†, the fluid turned about an axis by an angle, right-handed."""
    n = len(W)
    generator = sum(a * X for a, X in zip(axis, coordinates(n))) * -1j * np.sqrt(n**2 - 1) / 2
    values, vectors = np.linalg.eigh(generator)
    U = vectors * np.exp(-1j * angle * values) @ vectors.conj().T
    return U @ W @ U.conj().T


def rotation(axis, angle):
    """Returns the matrix that turns vectors about a unit axis, by Rodrigues."""
    cross = -np.cross(np.eye(3), axis).T
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


class Fields(unittest.TestCase):
    def test_each_harmonic_of_quflow_is_the_closed_form(self):
        # Those of order -m are -sin mλ: quflow's shr2shc differs there from the real form that it names.
        n = 9
        quflow = Quflow(n)  # a stand-in with quflow's signs
        for l in range(n):
            for order in range(-l, l + 1):
                unit = np.zeros(n * n)
                unit[l * l + l + order] = 1
                found = isosyrk.vorticity(quflow.shr2mat(unit), LATITUDES, LONGITUDES)
                m = abs(order)
                wave = np.cos(m * LONGITUDES) if order >= 0 else -np.sin(m * LONGITUDES)
                wanted = (math.sqrt(2) if m else 1) * np.outer(legendre_function(l, m, LATITUDES), wave)
                np.testing.assert_allclose(found, wanted, atol=2e-13, err_msg=f"{l} {order}")
                if l:  # the control: of any other sign, the field is another
                    self.assertGreater(np.abs(found + wanted).max(), 0.5)
                if (l + m) % 2:
                    self.assertGreater(np.abs(found - wanted[::-1]).max(), 0.5)

    def test_coordinates(self):
        for n in (2, 3, 8):
            for each, X in enumerate(coordinates(n)):
                for point in POINTS:
                    self.assertAlmostEqual(at(X, point), direction(*point)[each], 14)

    def test_each_coefficient_of_modes_is_the_closed_form(self):
        n = 9
        for l in range(1, n):
            for m in range(l + 1):
                re, im = (1.0, 0.0) if m == 0 else (0.6, -0.8)
                W = isosyrk.scene(modes=[(l, m, re, im)], n=n).initial
                (size,) = {round(np.hypot(*mode[2:]), 12) for mode in isosyrk.modes(W)} - {0.0}
                wave = (2 if m else 1) * (complex(re, im) * np.exp(-1j * m * LONGITUDES)).real
                wanted = (-1)**l * size / math.sqrt(n) * np.outer(legendre_function(l, m, LATITUDES), wave)
                np.testing.assert_allclose(isosyrk.vorticity(W, LATITUDES, LONGITUDES), wanted, atol=1e-11)

    def test_mean_squares(self):
        n, W = 9, state(9)
        sines, weights = legendre.leggauss(n)
        field = isosyrk.vorticity(W, np.arcsin(sines), 2 * np.pi * np.arange(2 * n) / (2 * n))

        def mean(values):
            return weights / 2 @ values.mean(axis=1)

        self.assertAlmostEqual(mean(field**2), np.linalg.norm(W)**2 / n, 13)
        self.assertAlmostEqual(mean(field), np.trace(W).imag / n, 13)
        self.assertGreater(abs(mean(field)), 1e-3)
        damped = isosyrk.vorticity(W, np.arcsin(sines), 2 * np.pi * np.arange(2 * n) / (2 * n), berezin=True)
        self.assertLess(mean(damped**2), 0.6 * mean(field**2))  # the control
        self.assertAlmostEqual(mean(damped), mean(field), 13)

    def test_a_turned_matrix_is_the_turned_field(self):
        n = 12
        W = state(n)
        # About the poles the field is moved east.
        np.testing.assert_allclose(isosyrk.vorticity(turned(W, (0, 0, 1), 0.8), LATITUDES, LONGITUDES),
                                   isosyrk.vorticity(W, LATITUDES, LONGITUDES - 0.8), atol=1e-12)
        for axis in (direction(0.2, 2.0), direction(-1.0, 0.5), np.array([1.0, 0, 0])):
            V = turned(W, axis, 0.8)
            found = [at(V, point) for point in POINTS]
            back, forth = ([at(W, angles(rotation(axis, angle) @ direction(*point))) for point in POINTS]
                           for angle in (-0.8, 0.8))
            np.testing.assert_allclose(found, back, atol=1e-12)
            self.assertGreater(np.abs(np.subtract(found, forth)).max(), 0.1)  # the control: turned the other way

    def test_berezin_is_the_expectation_in_coherent_states(self):
        for n in (2, 7, 40):
            W, X = state(n), coordinates(n)
            for point in POINTS:
                along = sum(a * each for a, each in zip(direction(*point), X))
                coherent = np.linalg.eigh(-1j * along)[1][:, -1]
                wanted = (coherent.conj() @ (-1j * W) @ coherent).real
                self.assertAlmostEqual(at(W, point, berezin=True), wanted, 12)
                if n == 7:  # the control
                    self.assertGreater(abs(at(W, point) - wanted), 1e-3)

    def test_a_wave_on_a_solid_rotation_moves_as_the_equations_say(self):
        # For ω = az + f, f of degree l: ∂f/∂t = -a (1/2 - 1/(l(l+1))) ∂f/∂λ, so that a > 0 turns eastward.
        n, l, m, a, time = 16, 3, 2, 0.7, 2.0
        wave = isosyrk.scene(modes=[(l, m, 0.3, 0.4)], n=n).initial
        W = a * coordinates(n)[2] + 1e-3 * wave
        scene = isosyrk.scene(initial=W, hbar="standard")
        end, _ = isosyrk.integrator(scene, "group3").run(W, 0.05, round(time / 0.05))
        moved = a * (0.5 - 1 / (l * (l + 1))) * time
        found = isosyrk.vorticity(end, LATITUDES, LONGITUDES)
        np.testing.assert_allclose(found, isosyrk.vorticity(W, LATITUDES, LONGITUDES - moved), atol=1e-9)
        self.assertGreater(np.abs(found - isosyrk.vorticity(W, LATITUDES, LONGITUDES + moved)).max(), 1e-4)

    def test_any_layout_and_any_grid(self):
        W = state(6)
        wanted = isosyrk.vorticity(W, LATITUDES, LONGITUDES)
        self.assertEqual((wanted.shape, wanted.dtype), ((6, 5), np.float64))
        np.testing.assert_array_equal(isosyrk.vorticity(np.asfortranarray(W), list(LATITUDES), LONGITUDES), wanted)
        np.testing.assert_allclose(isosyrk.vorticity(W, LATITUDES[::-2], LONGITUDES[3:1:-1]),
                                   wanted[::-2, 3:1:-1], atol=1e-14)
        self.assertEqual(isosyrk.vorticity(W, [], [0, 1]).shape, (0, 2))
        self.assertFalse(isosyrk.vorticity(np.zeros((4, 4)), LATITUDES, LONGITUDES).any())
        for scale in (2.0**400, 2.0**-400):
            np.testing.assert_allclose(isosyrk.vorticity(scale * W, LATITUDES, LONGITUDES) / scale, wanted, rtol=1e-12)

    def test_legendre_functions_at_large_n(self):
        # Σ_m |Y_lm|² over m = -l … l is 2l + 1 at every point; each term is wrong if one function were.
        n = 1025
        latitudes = np.array([0.0, 1e-3, 0.6, -1.3, 1.5, 1.57, np.pi / 2])
        for l in (512, 1024):
            row = np.zeros((n, n), complex)
            row[l, :l + 1] = 1
            squares = np.abs(_core.along_latitudes(row, latitudes))**2
            np.testing.assert_allclose(squares[:, 0] + 2 * squares[:, 1:].sum(axis=1), 2 * l + 1, rtol=1e-12)
        # The largest degree on the largest diagonal: √(Π (2k+1)/(2k)) cos^l θ, with l = n - 1.
        n = 513
        W = np.zeros((n, n), complex)
        W[0, -1], W[-1, 0] = 1j, 1j
        k = np.arange(1, n)
        latitudes = np.array([0.0, 0.05, 0.3])
        wanted = 2 * np.exp(np.log1p(1 / (2 * k)).sum() / 2) * np.cos(latitudes)**(n - 1) / np.sqrt(n)
        np.testing.assert_allclose(isosyrk.vorticity(W, latitudes, [0.0])[:, 0], wanted, rtol=1e-11)

    def test_time_and_memory_at_n_513(self):
        code = """if True:
            import isosyrk, numpy as np, resource

            def used():
                return resource.getrusage(resource.RUSAGE_SELF)

            n = 513
            W = np.random.default_rng(1).normal(size=(n, n)) / n
            W = W - W.T
            latitudes, longitudes = np.linspace(-1.5, 1.5, 512), np.linspace(-np.pi, np.pi, 1024, endpoint=False)
            isosyrk.vorticity(W[:9, :9], latitudes, longitudes)
            before = used()
            isosyrk.vorticity(W, latitudes, longitudes)
            print(used().ru_utime - before.ru_utime, (used().ru_maxrss - before.ru_maxrss) * 1024)
            """
        done = run([sys.executable, "-c", code], env=environment(PYTHONPATH=os.path.join(BUILD, "python")))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        seconds, memory = map(float, done.stdout.split())
        self.assertLess(seconds, 20)  # CPU time, some 2 s
        # What its docstring says, and the result; an array of n x n x 512 would take 2 GB.
        self.assertLess(memory, 1.2 * (16 * 513 * (2 * 513 + 2 * (512 + 1024)) + 8 * 512 * 1024))

    def test_arguments(self):
        W = state(4)
        for error, message, latitudes, longitudes in (
                (ValueError, r"^latitudes: 45 is among them, must be -pi/2 to pi/2 \(radians\)$", [0, 45.0], [0]),
                (ValueError, "^latitudes: must be finite$", [np.nan], [0]),
                (ValueError, "^longitudes: must be finite$", [0], [np.inf]),
                (ValueError, r"^latitudes: shape is \(\), must be \(k,\)$", 0.5, [0]),
                (ValueError, r"^longitudes: shape is \(1, 2\), must be \(k,\)$", [0], [[0, 1]]),
                (TypeError, "^latitudes: dtype is complex128, must be real numbers", [1j], [0]),
                (TypeError, "^longitudes: dtype is <U1, must be real numbers", [0], ["a"])):
            with self.subTest(message):
                with self.assertRaisesRegex(error, message):
                    isosyrk.vorticity(W, latitudes, longitudes)
        for call in (isosyrk.plot, lambda W, berezin: isosyrk.vorticity(W, [0], [0], berezin)):
            with self.assertRaisesRegex(TypeError, "^berezin: is a str, must be True or False$"):
                call(W, berezin="no")


class Coefficients(unittest.TestCase):
    def test_modes_make_W_over_its_norm(self):
        for n in (2, 3, 9, 34):
            W = state(n)
            modes = isosyrk.modes(W)
            self.assertEqual([mode[:2] for mode in modes], [(l, m) for l in range(1, n) for m in range(l + 1)])
            traceless = W - np.trace(W) / n * np.eye(n)
            found = isosyrk.scene(modes=modes, n=n).initial
            np.testing.assert_allclose(found, traceless / np.linalg.norm(traceless, 2), atol=1e-14)
        # The control: without one of them it is another.
        self.assertGreater(np.abs(isosyrk.scene(modes=modes[:-1], n=n).initial - found).max(), 1e-4)

    def test_modes_are_those_of_the_scene_up_to_a_factor(self):
        given = [(1, 0, 0.5, 0.0), (3, 2, -0.2, 0.7), (4, 4, 1.0, -0.1)]
        W = isosyrk.scene(modes=given, n=7).initial
        found = {mode[:2]: np.array(mode[2:]) for mode in isosyrk.modes(W)}
        factor = found[1, 0][0] / 0.5
        for l, m, re, im in given:
            np.testing.assert_allclose(found.pop((l, m)), factor * np.array([re, im]), atol=1e-14)
        self.assertLess(max(np.abs(each).max() for each in found.values()), 1e-15)
        np.testing.assert_allclose([each[2:] for each in isosyrk.modes(2.0**900 * W)],
                                   2.0**900 * np.array([each[2:] for each in isosyrk.modes(W)]))

    def test_energies_add_up_to_that_of_the_scene(self):
        for n in (2, 9, 34):
            W = state(n)
            E = isosyrk.energy_spectrum(W)
            self.assertEqual((E.shape, E[0]), ((n,), 0.0))
            self.assertAlmostEqual(E.sum() / isosyrk.scene(initial=W).energy(W), 1, 13)
            self.assertGreater(E[1:].min(), 0.0)
        for l, m in ((1, 0), (4, 3)):
            W = isosyrk.scene(modes=[(l, m, 1.0, 0.0)], n=9).initial
            E = isosyrk.energy_spectrum(W)
            self.assertAlmostEqual(E[l], np.linalg.norm(W)**2 / (2 * l * (l + 1)), 14)
            self.assertLess(np.delete(E, l).max(), 1e-28)  # the control

    def test_energies_at_any_norm(self):
        W = state(9)
        E = isosyrk.energy_spectrum(W)
        for exponent in (500, -500):
            np.testing.assert_array_equal(isosyrk.energy_spectrum(2.0**exponent * W), 2.0**(2 * exponent) * E)
        for exponent, about in ((600, 360), (-600, -363)):
            with self.assertRaisesRegex(ValueError, rf"^W: its energies are about 1e{about}, which no double holds"):
                isosyrk.energy_spectrum(2.0**exponent * W)
        self.assertFalse(isosyrk.energy_spectrum(np.zeros((3, 3))).any())


class Operators(unittest.TestCase):
    def test_laplace_is_the_double_commutator(self):
        n, W = 9, state(9)
        wanted = 0
        for X in coordinates(n):
            S = -0.5j * np.sqrt(n**2 - 1) * X
            inner = S @ W - W @ S
            wanted = wanted - (S @ inner - inner @ S)
        np.testing.assert_allclose(isosyrk.laplace(W), wanted, atol=1e-12)
        harmonic = isosyrk.scene(modes=[(4, 1, 0.3, 0.1)], n=n).initial
        np.testing.assert_allclose(isosyrk.laplace(harmonic), -20 * harmonic, atol=1e-13)
        self.assertFalse(isosyrk.laplace(1j * np.eye(n)).round(13).any())

    def test_solve_poisson_is_its_inverse_beside_the_trace(self):
        n, W = 9, state(9)
        P = isosyrk.solve_poisson(W)
        traceless = W - np.trace(W) / n * np.eye(n)
        np.testing.assert_allclose(isosyrk.laplace(P), traceless, atol=1e-13)
        self.assertLess(abs(np.trace(P)), 1e-14)
        self.assertGreater(np.abs(isosyrk.laplace(P) - W).max(), 1e-3)  # the control: W has a trace
        for hbar, value in (("paper", 2 / np.sqrt(n * (n - 1))), ("standard", 2 / np.sqrt(n**2 - 1))):
            B = isosyrk.scene(initial=W, hbar=hbar).generator(W)
            np.testing.assert_allclose(P / value, B, atol=1e-14)


class Refusals(unittest.TestCase):
    def test_matrices(self):
        nan, broken = state(4), state(4)
        nan[1, 2] = complex(0, np.nan)
        broken[0, 1] *= 1 + 1e-6
        calls = {"modes": isosyrk.modes, "energy_spectrum": isosyrk.energy_spectrum, "laplace": isosyrk.laplace,
                 "solve_poisson": isosyrk.solve_poisson, "plot": isosyrk.plot,
                 "vorticity": lambda W: isosyrk.vorticity(W, [0.0], [0.0])}
        for error, message, W in (
                (ValueError, r"^[WP]: its shape is \(4, 3\), must be \(n, n\)$", state(4)[:, :3]),
                (ValueError, r"^[WP]: its shape is \(2, 4, 4\), must be", np.stack(2 * [state(4)])),
                (ValueError, "^[WP]: n = 1, must be 2 to 4096$", state(1)),
                (ValueError, r"^[WP]: entry \(1, 2\) is .*nan.*, must be finite$", nan),
                (ValueError, r"^[WP]: the largest entry of .* \(skew-Hermitian\)$", broken),
                (ValueError, r"^[WP]: the largest entry of .* \(skew-Hermitian\)$", 1j * state(4)),
                (ValueError, "^[WP]: its dtype is <U1, must be real or complex", np.full((2, 2), "a")),
                (TypeError, "^[WP]: is a masked array", np.ma.array(state(4)))):
            for name, call in calls.items():
                with self.subTest(name, message=message):
                    with self.assertRaisesRegex(error, message) as raised:
                        call(W)
                    self.assertNotIn("\n", str(raised.exception))

        with self.assertRaisesRegex(ValueError, r"^W: entry \(1, 2\) is .*nan.*, must be finite$"):
            isosyrk.spectrum(nan)

    def test_a_matrix_is_not_changed(self):
        W = state(5)
        before = W.copy()
        W.flags.writeable = False
        for call in (isosyrk.modes, isosyrk.energy_spectrum, isosyrk.laplace, isosyrk.solve_poisson):
            call(W)
        isosyrk.vorticity(W, LATITUDES, LONGITUDES)
        np.testing.assert_array_equal(W, before)


class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        try:
            import matplotlib
        except ImportError:
            raise unittest.SkipTest("needs matplotlib") from None
        matplotlib.use("Agg")
        cls.W = isosyrk.scene("smooth", n=9).initial

    def setUp(self):
        from matplotlib import pyplot
        self.pyplot = pyplot
        self.addCleanup(pyplot.close, "all")

    def mesh(self, figure):
        """Returns what is drawn in the first axes, and draws the figure."""
        figure.canvas.draw()
        return figure.axes[0].collections[0]

    def test_both_projections_show_the_field_in_symmetric_colours(self):
        for projection, center in (("mollweide", (0, 0)), ("mollweide", (0, 2.0)), ("orthographic", (0.6, -1.0)),
                                   ("orthographic", (-np.pi / 2, 0.0))):
            with self.subTest(projection, center=center):
                mesh = self.mesh(isosyrk.plot(self.W, projection, center))
                low, high = mesh.get_clim()
                self.assertEqual(low, -high)
                rows = len(np.ravel(mesh.get_array())) // 360
                shown = np.ma.reshape(mesh.get_array(), (rows, 360))
                latitudes = (np.arange(rows) + 0.5) * np.pi / rows - np.pi / 2
                longitudes = (np.arange(360) + 0.5) * np.pi / 180 - np.pi
                field = isosyrk.vorticity(self.W, latitudes, longitudes + center[1])
                self.assertAlmostEqual(high, np.abs(field).max(), 13)
                self.assertLess(np.ma.abs(shown - field).max(), 1e-14)
                hidden = np.ma.getmaskarray(shown).mean()
                self.assertTrue(hidden == 0 if projection == "mollweide" else 0.4 < hidden < 0.5, hidden)

    def test_north_is_up_and_east_is_right(self):
        # Where in the picture x, y and z are largest.
        for axis, center, wanted in ((2, (0.3, 0.0), (0, np.cos(0.3))), (1, (0.0, 0.0), (1, 0)),
                                     (0, (0.4, 0.0), (0, -np.sin(0.4))), (0, (0.0, -0.5), (np.sin(0.5), 0))):
            mesh = isosyrk.plot(coordinates(5)[axis], "orthographic", center).axes[0].collections[0]
            corners = mesh.get_coordinates()
            values = np.ma.reshape(mesh.get_array(), np.subtract(corners.shape[:2], 1))
            row, column = np.unravel_index(np.ma.argmax(values), values.shape)
            np.testing.assert_allclose(corners[row, column], wanted, atol=0.03)

    def test_title_limits_and_given_axes(self):
        figure = isosyrk.plot(self.W, title="smooth\nt = 0", vmax=0.5)
        self.assertEqual(self.mesh(figure).get_clim(), (-0.5, 0.5))
        self.assertEqual((figure.axes[0].get_title(), len(figure.axes)), ("smooth\nt = 0", 2))
        figure = self.pyplot.figure()
        for place, projection in ((121, "mollweide"), (122, None)):
            axes = figure.add_subplot(place, projection=projection)
            found = isosyrk.plot(self.W, projection or "orthographic", axes=axes)
            self.assertIs(found, figure)
            self.assertEqual(len(axes.collections), 1)
            with self.assertRaisesRegex(ValueError, "^axes: .*of matplotlib's projection mollweide"):
                isosyrk.plot(self.W, "orthographic" if projection else "mollweide", axes=axes)
        self.assertEqual(len(figure.axes), 2)  # without a colour bar
        self.assertEqual(self.mesh(isosyrk.plot(np.zeros((3, 3)))).get_clim(), (-1.0, 1.0))

    def test_berezin_is_passed_on(self):
        W = isosyrk.scene("rough", n=9).initial
        limits = [self.mesh(isosyrk.plot(W, berezin=berezin)).get_clim()[1] for berezin in (False, True)]
        self.assertLess(limits[1], 0.9 * limits[0])

    def test_arguments(self):
        for error, message, arguments in (
                (ValueError, "^projection 'hammer': must be mollweide or orthographic$", dict(projection="hammer")),
                (TypeError, "^projection: is a int", dict(projection=1)),
                (ValueError, "^center: its latitude is 0.5, must be 0 with mollweide$", dict(center=(0.5, 0))),
                (ValueError, r"^center: its latitude is 20, must be -pi/2 to pi/2 \(radians\)$",
                 dict(projection="orthographic", center=(20, 0))),
                (ValueError, r"^center 1.0: must be \(latitude, longitude\)$", dict(center=1.0)),
                (ValueError, "^center: its longitude = nan: must be finite$", dict(center=(0, np.nan))),
                (ValueError, "^vmax = 0: must be above 0$", dict(vmax=0)),
                (TypeError, "^vmax: is a str", dict(vmax="1")), (TypeError, "^title: is a int", dict(title=3)),
                (TypeError, "^axes: is a Figure, must be axes of matplotlib$", dict(axes=self.pyplot.Figure()))):
            with self.subTest(message):
                with self.assertRaisesRegex(error, message):
                    isosyrk.plot(self.W, **arguments)
        self.assertEqual(self.pyplot.get_fignums(), [])

    def test_without_matplotlib_one_line_says_what_is_missing(self):
        with mock.patch.dict(sys.modules, {"matplotlib": None}):
            with self.assertRaisesRegex(ImportError, r"^plot: needs matplotlib \(the package python3-matplotlib,.*\)$"):
                isosyrk.plot(self.W)
            isosyrk.vorticity(self.W, LATITUDES, LONGITUDES)


if __name__ == "__main__":
    unittest.main()
