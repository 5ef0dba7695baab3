"""Tests of isosyrk.quflow with a stand-in that calls integrators as quflow's commit b42eede does, and quflow itself.

QUFLOW in the environment is a checkout of quflow at that commit; without it what needs quflow itself is skipped. Of
quflow's own needs, numba, h5py, appdirs, matplotlib and ducc0 are replaced by stubs where they are missing.
Run with: python3 -m unittest test_quflow (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import contextlib
import copy
import importlib
import importlib.util
import inspect
import io
import math
import os
import pickle
import re
import sys
import tempfile
import types
import unittest
import warnings
from unittest import mock

from programs import BUILD, ROOT, text_of

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np
from numpy.polynomial import legendre

import isosyrk

TOLERANCE = 1e-13
QUFLOW = os.environ.get("QUFLOW")
ARGUMENTS = ["W", "dt", "steps", "hamiltonian", "time", "forcing", "strang_splitting", "stats", "callback", "tol",
             "maxit", "minit", "verbatim", "compsum", "reinitialize"]


def quflow_module(function):
    """Marks a function as one of quflow's."""
    function.__module__ = "quflow.laplacian.cpu"
    return function


class Quflow:
    """A stand-in for quflow at size N: its conventions (real spherical harmonics, ħ, energy), its midpoint rule, and
    how its solve calls an integrator.

    The basis of diagonal m are the eigenvectors of the Laplacian of norm sqrt(N) whose last entry is positive.
    """

    def __init__(self, N):
        self.N, self.hbar = N, 2 / np.sqrt(N**2 - 1)
        self.l = np.array([l for l in range(N) for _ in range(2 * l + 1)])
        self.bases = []  # of diagonal m: column l - m
        s = (N - 1) / 2
        mz = s - np.arange(N)
        ladder = np.sqrt(s * (s + 1) - mz[:-1] * mz[1:])
        for m in range(N):
            between = -ladder[:N - m - 1] * ladder[m:]
            laplacian = np.diag(2 * (s * (s + 1) - mz[:N - m] * mz[m:])) + np.diag(between, 1) + np.diag(between, -1)
            values, vectors = np.linalg.eigh(laplacian)
            assert np.allclose(values, [l * (l + 1) for l in range(m, N)])
            self.bases.append(vectors * np.sign(vectors[-1]) * np.sqrt(N))
        basis = np.array([self.shr2mat(unit) for unit in np.eye(self.N**2)])

        @quflow_module
        def solve_poisson(W):
            """P with the Laplacian of P = W."""
            omega = np.einsum("kij,ij->k", basis.conj(), W).real / N
            return np.tensordot(-omega[1:] / (self.l * (self.l + 1))[1:], basis[1:], 1)

        self.solve_poisson = solve_poisson

    def shr2mat(self, omega):
        W = np.zeros((self.N, self.N), complex)
        for m, basis in enumerate(self.bases):
            l = np.arange(m, self.N)
            plus, minus = omega[l * l + l + m], omega[l * l + l - m]
            W += np.diag(basis @ (plus / 2 if m == 0 else (plus - 1j * minus) / np.sqrt(2)), m)
        return 1j * (W + W.conj().T)

    def isomp(self, W, dt, steps=100, hamiltonian=None, time=None, stats=None, callback=None):
        for _ in range(steps):
            half, change = W.copy(), np.inf
            while change > 1e-14:
                P = dt / (2 * self.hbar) * hamiltonian(half)
                new = W + P @ half - half @ P + P @ half @ P
                half, change = new, np.abs(new - half).max()
            dW = 2 * (P @ half - half @ P)
            if callback is not None:
                callback(W, dW)
            W += dW
        return W

    def solve(self, W, dt=None, steps=None, steps_out=100, integrator=None, callback=None, integrator_callback=None,
              **kwargs):
        """Passes `time` always, `stats` where the integrator names it, and `callback` where there is one."""
        kwargs["time"] = kwargs.get("time", 0.0)
        if isinstance(W, Simulation):
            kept, callback = {name: pickle.loads(value) for name, value in W.kept.items()}, W
            W, kwargs["time"] = callback.states[-1].copy(), callback.fields["time"][-1]
            dt, steps, integrator = kept.pop("dt", dt), kept.pop("steps", steps), kept.pop("integrator", integrator)
            steps_out = kept.pop("steps_out", steps_out)
            kwargs.update(kept)
        kwargs.setdefault("hamiltonian", self.solve_poisson)
        if "stats" in inspect.getfullargspec(integrator).args:
            kwargs["stats"] = {"iterations": 0.0}
        if integrator_callback is not None:
            kwargs["callback"] = integrator_callback
        for k in range(0, steps, steps_out):
            taken = min(steps_out, steps - k)
            W = integrator(W, dt, steps=taken, **kwargs)
            kwargs["time"] += taken * dt
            if callback is not None:
                callback(W, delta_time=taken * dt, delta_steps=taken, **kwargs.get("stats", {}))
        return W


class Simulation:
    """What a QuSimulation is for solve: states, fields, and arguments that it pickles."""

    def __init__(self, W):
        self.kept, self.states = {}, [W.copy()]
        self.fields = {name: [0.0] for name in ("time", "step", "tol_auto", "iterations", "number_of_maxit")}

    def __setitem__(self, name, value):
        self.kept[name] = pickle.dumps(value)

    def __call__(self, W, delta_time, delta_steps=1, **fields):
        self.states.append(W.copy())
        self.fields["time"].append(self.fields["time"][-1] + delta_time)
        self.fields["step"].append(self.fields["step"][-1] + delta_steps)
        for name, value in fields.items():
            if name in self.fields:
                self.fields[name].append(value)


class Tested(unittest.TestCase):
    def setUp(self):
        self.quflow = Quflow(8)
        self.omega = np.random.default_rng(5).normal(size=64) / 8
        self.omega[0] = 0.0
        self.W = self.quflow.shr2mat(self.omega)

    def in_one_run(self, name, dt, steps, **options):
        scene = isosyrk.scene(initial=self.W, hbar="standard")
        return isosyrk.integrator(scene, name, **{"solver": "fast", **options}).run(self.W, dt, steps)


class Steps(Tested):
    """What an integrator gives to solve."""

    def test_solve_takes_the_steps_of_isomp_and_overwrites_W(self):
        ends = [self.quflow.solve(self.W.copy(), 0.05, 40, 10, integrator)
                for integrator in (self.quflow.isomp, isosyrk.quflow.integrator(),
                                   isosyrk.quflow.integrator("group8"))]
        self.assertLess(isosyrk.relative_error(ends[1], ends[0]), 1e-11)
        self.assertGreater(isosyrk.relative_error(ends[2], ends[0]), 1e-6)  # the control: another method
        W = self.W.copy()
        self.assertIs(self.quflow.solve(W, 0.05, 40, 10, isosyrk.quflow.integrator()), W)
        self.assertTrue(np.array_equal(W, ends[1]))
        # The step is dt, not dt over hbar.
        other = self.quflow.solve(self.W.copy(), 0.05 / self.quflow.hbar, 1, 1, isosyrk.quflow.integrator())
        self.assertGreater(isosyrk.relative_error(other, isosyrk.quflow.integrator()(self.W.copy(), 0.05, 1)), 1e-2)

    def test_calls_on_one_state_are_one_run(self):
        for name in ("algebra1", "group2", "elp4"):
            wanted, report = self.in_one_run(name, 0.05, 40)
            seen = []
            made = mock.Mock(wraps=isosyrk.integrator)
            method = isosyrk.quflow.integrator(name)
            with mock.patch.object(isosyrk.quflow, "_integrator_of_scene", made):
                W = self.quflow.solve(self.W.copy(), 0.05, 40, 10, method,
                                      callback=lambda W, iterations, **_: seen.append(iterations))
            self.assertTrue(np.array_equal(W, wanted), name)
            self.assertEqual(made.call_count, 1)
            self.assertAlmostEqual(10 * sum(seen), report.sweeps)

    def test_signature_is_that_of_isomp(self):
        method = isosyrk.quflow.integrator()
        self.assertEqual(inspect.getfullargspec(method).args[-len(ARGUMENTS):], ARGUMENTS)
        defaults = inspect.signature(method).parameters
        self.assertEqual([defaults[name].default for name in ("steps", "tol", "maxit", "minit")], [100, "auto", 10, 1])

    def test_every_method_of_the_list(self):
        for entry in isosyrk.integrators():
            with self.subTest(entry.name):
                how = {} if entry.has_fast_form else {"solver": "published"}
                W = self.quflow.solve(self.W.copy(), 0.02, 4, 2, isosyrk.quflow.integrator(entry.name, **how))
                wanted, report = self.in_one_run(entry.name, 0.02, 4, **how)
                self.assertLess(isosyrk.relative_error(W, wanted), 100 * TOLERANCE)

    def test_stats_have_the_fields_of_a_simulation(self):
        for name, explicit in (("group2", False), ("rk4", True)):
            stats = {}
            isosyrk.quflow.integrator(name, tolerance=1e-9)(self.W.copy(), 0.05, 10, stats=stats)
            self.assertEqual((stats["number_of_maxit"], stats["tol_auto"]), (0.0, 1e-9))
            self.assertEqual(stats["iterations"] == 0.0, explicit)
        isosyrk.quflow.integrator()(self.W.copy(), 0.05, 0, stats=stats)
        self.assertEqual(stats["iterations"], 0.0)

    def test_verbatim_prints_the_sweeps_a_step(self):
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            isosyrk.quflow.integrator()(self.W.copy(), 0.05, 5, verbatim=True)
        self.assertRegex(printed.getvalue(), r"^\d+\.\d\d sweeps a step\n$")

    def test_the_callback_sees_the_state_before_each_step_and_its_change(self):
        seen = {}
        for integrator in (self.quflow.isomp, isosyrk.quflow.integrator()):
            pairs = seen[integrator] = []
            self.quflow.solve(self.W.copy(), 0.05, 6, 3, integrator,
                              integrator_callback=lambda W, dW: pairs.append((W.copy(), dW.copy())))
        for wanted, found in zip(*seen.values()):
            np.testing.assert_allclose(found, wanted, atol=1e-12)
        self.assertEqual([len(pairs) for pairs in seen.values()], [6, 6])

        def changes(W, dW):
            W *= 2

        with self.assertRaisesRegex(ValueError, "read-only"):
            isosyrk.quflow.integrator()(self.W.copy(), 0.05, 1, callback=changes)

    def test_a_callback_s_answer_does_not_end_the_run(self):
        calls = []
        isosyrk.quflow.integrator()(self.W.copy(), 0.05, 5, callback=lambda *_: calls.append(1) or True)
        self.assertEqual(len(calls), 5)

    def test_a_simulation_keeps_the_integrator_and_goes_on(self):
        simulation = Simulation(self.W)
        for name, value in dict(dt=0.05, steps=20, steps_out=5,
                                integrator=isosyrk.quflow.integrator("group2", tolerance=1e-10)).items():
            simulation[name] = value
        self.quflow.solve(simulation)
        self.quflow.solve(simulation)
        self.assertEqual(simulation.fields["step"], [0, 5, 10, 15, 20, 25, 30, 35, 40])
        self.assertAlmostEqual(simulation.fields["time"][-1], 2.0)
        self.assertEqual(simulation.fields["tol_auto"][1:], [1e-10] * 8)
        self.assertEqual({len(values) for values in simulation.fields.values()}, {9})
        self.assertLess(isosyrk.relative_error(simulation.states[-1], self.in_one_run("group2", 0.05, 40)[0]), 1e-8)

    def test_single_precision_is_the_rounding_of_a_run_in_double(self):
        single = self.W.astype(np.complex64)
        wanted = isosyrk.quflow.integrator("group2")(single.astype(complex), 0.05, 40).astype(np.complex64)
        seen = []
        W = self.quflow.solve(single, 0.05, 40, 10, isosyrk.quflow.integrator("group2"),
                              integrator_callback=lambda W, dW: seen.append((W.dtype, dW.dtype)))
        self.assertIs(W, single)
        self.assertEqual((W.dtype, set(seen)), (np.complex64, {(np.dtype(np.complex64),) * 2}))
        self.assertTrue(np.array_equal(W, wanted))
        # A state that something changed is the new beginning.
        method = isosyrk.quflow.integrator("group2")
        W = method(self.W.astype(np.complex64), 0.05, 10)
        W *= 0.5
        wanted = isosyrk.quflow.integrator("group2")(W.astype(complex), 0.05, 10).astype(np.complex64)
        self.assertTrue(np.array_equal(method(W, 0.05, 10), wanted))
        # Rounding of single precision is no reason to refuse.
        W[0, 1] *= 1 + 1e-6
        self.assertLess(isosyrk.skew_defect(method(W, 0.05, 10)), 1e-6)

    def test_any_layout(self):
        wanted = isosyrk.quflow.integrator()(self.W.copy(), 0.05, 3)
        stack = np.stack([self.W, 0 * self.W])
        for W in (np.asfortranarray(self.W), stack[0], np.repeat(np.repeat(self.W, 2, 0), 2, 1)[::2, ::2]):
            self.assertIs(isosyrk.quflow.integrator()(W, 0.05, 3), W)
            self.assertTrue(np.array_equal(W, wanted))
        self.assertFalse(stack[1].any())

    def test_copies_are_made_of_the_name_and_the_options(self):
        method = isosyrk.quflow.integrator("elp6_frame", tolerance=1e-8, max_sweeps=77)
        wanted = method(self.W.copy(), 0.05, 10)
        for again in (pickle.loads(pickle.dumps(method)), copy.deepcopy(method), copy.copy(method)):
            self.assertEqual((again.name, again.options, repr(again)), (method.name, method.options, repr(method)))
            self.assertTrue(np.array_equal(again(self.W.copy(), 0.05, 10), wanted))


class Refusals(Tested):
    def refused(self, error, message, call, *arguments, **options):
        with self.assertRaisesRegex(error, message) as raised:
            call(*arguments, **options)
        self.assertNotIn("\n", str(raised.exception))

    def test_what_it_cannot_do_is_refused_before_the_first_step(self):
        W, steps = self.W.copy(), []
        for message, arguments in (
                ("^hamiltonian: must be quflow's solve_poisson; for a P.W. of your own run",
                 dict(hamiltonian=lambda W: W)),
                ("^hamiltonian: must be", dict(hamiltonian=mock.Mock(spec=[]))),
                ("^hamiltonian: must be", dict(hamiltonian=types.SimpleNamespace(
                    __module__="quflow.laplacian.gpu", __name__="solve_poisson"))),
                ("^forcing: not taken here; use between=f", dict(forcing=lambda P, W: 0 * W)),
                ("^strang_splitting: not taken here; use between=f", dict(strang_splitting=lambda dt, W: W)),
                ("^tol: .*tolerance=…", dict(tol=1e-9)), ("^tol: ", dict(tol=np.float64(1e-9))),
                ("^tol: ", dict(tol=0)), ("^tol: ", dict(tol=np.ones(2))),
                ("^maxit: ", dict(maxit=np.ones(2))), ("^maxit: .*max_sweeps=…", dict(maxit=20)),
                ("^minit: ", dict(minit=2)), ("^compsum: ", dict(compsum=True)),
                ("^reinitialize: .*without='predictor'", dict(reinitialize=True))):
            with self.subTest(arguments):
                self.refused(ValueError, message, self.quflow.solve, W, 0.05, 2, 1, isosyrk.quflow.integrator(),
                             integrator_callback=lambda *_: steps.append(1), **arguments)
        self.refused(TypeError, "nonsense", self.quflow.solve, W, 0.05, 2, 1, isosyrk.quflow.integrator(), nonsense=1)
        self.assertTrue(np.array_equal(W, self.W))
        self.assertEqual(steps, [])
        # What quflow gives by default is taken.
        isosyrk.quflow.integrator()(W, 0.05, np.int64(1), self.quflow.solve_poisson, 3.0, None, None, None, None, -1.0,
                                    np.int64(10), 1, False, np.bool_(False), False)

    def test_matrices(self):
        read_only = self.W.copy()
        read_only.flags.writeable = False
        nan = self.W.copy()
        nan[0, 1] = np.nan
        for error, message, W in (
                (TypeError, "^W: is a list, must be a NumPy array", self.W.tolist()),
                (TypeError, "^W: is a MaskedArray", np.ma.array(self.W)),
                (ValueError, "^W: its dtype is float64, must be complex128 or complex64; W.astype", self.W.real),
                (ValueError, "^W: its dtype is complex256", self.W.astype(np.clongdouble)),
                (ValueError, r"^W: its shape is \(2, 8, 8\), must be \(N, N\); call it once for each",
                 np.stack(2 * [self.W])),
                (ValueError, r"^W: its shape is \(8, 7\)", self.W[:, :7].copy()),
                (ValueError, "^W: is read-only, and is overwritten; pass W.copy", read_only),
                (ValueError, r"^W: the largest entry of \|W \+ W†\| is .*1e-10; pass \(W - W.conj\(\).T\) / 2",
                 self.W + 1e-6 * np.eye(8)),
                (ValueError, "^W: .* 1e-05; pass", (self.W + 1e-3 * np.eye(8)).astype(np.complex64)),
                (ValueError, r"entry \(0, 1\) is nan", nan), (ValueError, "all entries are 0", 0 * self.W)):
            with self.subTest(message):
                self.refused(error, message, isosyrk.quflow.integrator(), W, 0.05, 1)

    def test_other_arguments(self):
        for error, message, arguments in (
                (TypeError, "^dt: is a str", dict(dt="0.05")), (ValueError, "^dt = nan", dict(dt=float("nan"))),
                (TypeError, "^steps: is a float", dict(dt=0.05, steps=2.0)),
                (ValueError, "^steps = -1", dict(dt=0.05, steps=-1)),
                (TypeError, "^stats: is a list, must be a dictionary", dict(dt=0.05, stats=[])),
                (TypeError, "^callback: is a int, must be a function", dict(dt=0.05, callback=3))):
            self.refused(error, message, isosyrk.quflow.integrator(), self.W, **arguments)

    def test_names_and_options_are_refused_at_once(self):
        for error, message, name, options in (
                (ValueError, "^integrator 'isomp': must be one of", "isomp", {}),
                (TypeError, "tol", "group2", dict(tol=1e-8)),
                (ValueError, "^tolerance 0: ", "group2", dict(tolerance=0)),
                (ValueError, "has no fast form", "yoshida4_group", {}),
                (ValueError, "^threads: goes with", "group2", dict(solver="published", threads=2))):
            self.refused(error, message, isosyrk.quflow.integrator, name, **options)
        isosyrk.quflow.integrator("yoshida4_group", solver="published")(self.W.copy(), 0.05, 1)

    def test_a_run_that_does_not_begin_leaves_W_as_it_is(self):
        W = self.W.astype(np.complex64)
        W[0, 1] = np.nextafter(W[0, 1].real, np.float32(9)) + 1j * W[0, 1].imag  # skew-Hermitian to rounding only
        method, before = isosyrk.quflow.integrator(), W.tobytes()
        method._methods[len(W)] = mock.Mock(run=mock.Mock(side_effect=RuntimeError("no threads here")))
        with self.assertRaisesRegex(RuntimeError, "no threads here"):
            method(W, 0.05, 1)
        self.assertEqual(W.tobytes(), before)

    def test_a_step_that_fails_leaves_the_last_state_in_W(self):
        for dtype in (np.complex128, np.complex64):
            W, seen = self.W.astype(dtype), []
            method = isosyrk.quflow.integrator("group2", max_sweeps=2, without="predictor", tolerance=1e-15)
            with self.assertRaises(isosyrk.SolverError) as raised:
                method(W, 0.5, 100, callback=lambda W, dW: seen.append(W + dW))
            self.assertIs(raised.exception.W, W)
            self.assertEqual(raised.exception.report.steps, len(seen))

            def fails(V, dV):
                seen.append(V + dV)
                if len(seen) == 4:
                    raise KeyError("mine")

            W, seen = self.W.astype(dtype), []
            with self.assertRaisesRegex(KeyError, "mine") as raised:
                isosyrk.quflow.integrator("group2")(W, 0.05, 9, callback=fails)
            self.assertIs(raised.exception.W, W)
            self.assertEqual(raised.exception.report.steps, 4)
            self.assertLess(isosyrk.relative_error(W, seen[-1]), 1e-6)


class Page(Tested):
    """What core/python/README.md says to users of quflow, against the stand-in's formulas."""

    def test_the_stand_in_s_harmonics_of_l_1_are_the_coordinates(self):
        m = 3.5 - np.arange(8)
        up = np.diag(np.sqrt(3.5 * 4.5 - m[1:] * (m[1:] + 1)), 1)
        for order, S in ((-1, (up - up.T) / 2j), (0, -np.diag(m)), (1, (up + up.T) / 2)):  # its third one ascends
            unit = np.zeros(64)
            unit[2 + order] = 1
            X = self.quflow.hbar * 1j * S
            np.testing.assert_allclose(self.quflow.shr2mat(unit), np.sqrt(3) * X, atol=1e-14)

    def test_the_example(self):
        page = text_of(ROOT, "core", "python", "README.md")
        code = re.search("^```python\n(import isosyrk, quflow\n.*?)```\n", page, re.M | re.S).group(1)
        simulation, W = Simulation(self.W), self.W.copy()
        simulation["steps"] = 10
        with mock.patch.dict(sys.modules, quflow=self.quflow):
            exec(code, {"W": W, "dt": 0.05, "steps": 10, "simulation": simulation})  # pylint: disable=exec-used
        self.assertTrue(np.array_equal(W, self.in_one_run("elp6_frame", 0.05, 10, tolerance=1e-8)[0]))
        self.assertTrue(np.array_equal(simulation.states[-1], W))

    def test_energy(self):
        energy = -(self.W * self.quflow.solve_poisson(self.W).conj()).sum().real / 8 / 2
        self.assertAlmostEqual(isosyrk.scene(initial=self.W, hbar="standard").energy(self.W) / 8, energy, 14)

    def test_modes(self):
        modes = modes_of(self.omega, 8)
        found = isosyrk.scene(modes=modes, n=8, hbar="standard").initial
        np.testing.assert_allclose(found, self.W / np.linalg.norm(self.W, 2), atol=1e-14)

    def test_a_stream_matrix_of_one_s_own(self):
        scene = isosyrk.scene(initial=self.W, generator=lambda W: self.quflow.solve_poisson(W) / self.quflow.hbar)
        found, _ = isosyrk.integrator(scene, "algebra1").run(self.W, 0.05, 3)
        wanted = self.quflow.isomp(self.W.copy(), 0.05, 3, self.quflow.solve_poisson)
        self.assertLess(isosyrk.relative_error(found, wanted), 1e-12)


def modes_of(omega, N):
    """Returns the modes of quflow's coefficients ω, as the page has them."""
    modes = []
    for l in range(1, N):
        modes.append((l, 0, (-1)**l * np.sqrt(N) * omega[l * l + l], 0.0))
        for m in range(1, l + 1):
            value = (-1)**l * np.sqrt(N / 2) * (omega[l * l + l + m] - 1j * omega[l * l + l - m])
            modes.append((l, m, value.real, value.imag))
    return modes


# ---- quflow itself


def compiled(*function, **_):
    """Stands for numba.njit, which compiles."""
    return function[0] if function and callable(function[0]) else lambda plain: plain


def synthesis_2d(alm, ntheta, nphi, lmax, geometry, **_):
    """Stands for ducc0.sht.experimental.synthesis_2d: a real map of orthonormal harmonics, on quflow's grid "MW"."""
    assert geometry == "MW"
    theta = np.pi * (2 * np.arange(ntheta) + 1) / (2 * ntheta - 1)
    phi = 2 * np.pi * np.arange(nphi) / nphi
    field, place = np.zeros((ntheta, nphi)), 0
    for m in range(lmax + 1):
        for l in range(m, lmax + 1):
            size = math.sqrt((2 * l + 1) / (4 * np.pi) * math.factorial(l - m) / math.factorial(l + m))
            P = (-np.sin(theta))**m * legendre.Legendre.basis(l).deriv(m)(np.cos(theta))
            field += (2 if m else 1) * np.outer(size * P, (alm[0, place] * np.exp(1j * m * phi)).real)
            place += 1
    return field[np.newaxis]


class Dataset:
    def __init__(self, shape, dtype):
        self.array, self.attrs = np.zeros(shape, dtype), {}

    shape = property(lambda self: self.array.shape)
    dtype = property(lambda self: self.array.dtype)

    def resize(self, size, axis):
        shape = list(self.array.shape)
        shape[axis] = size
        array = np.zeros(shape, self.array.dtype)
        array[:len(self.array)] = self.array
        self.array = array

    def __getitem__(self, key):
        return self.array[key]

    def __setitem__(self, key, value):
        self.array[key] = value


class Group:
    def __init__(self):
        self.attrs, self.members = {}, {}

    def _found(self, path):
        names = [name for name in path.split("/") if name]
        for name in names[:-1]:
            self = self.members[name]
        return (self.members.get(names[-1]), self, names[-1]) if names else (self, None, None)

    def __contains__(self, path):
        return self._found(path)[0] is not None

    def __getitem__(self, path):
        return self._found(path)[0]

    def keys(self):
        return self.members.keys()

    def create_group(self, path):
        _, parent, name = self._found(path)
        parent.members[name] = Group()

    def create_dataset(self, path, shape, dtype, **_):
        _, parent, name = self._found(path)
        parent.members[name] = Dataset(shape, dtype)
        return parent.members[name]


class File(Group):
    """Stands for h5py.File: what a QuSimulation needs of it, in memory."""

    stored = {}

    def __init__(self, path, mode):
        super().__init__()
        self.mode = mode
        if mode == "w":
            with open(path, "w", encoding="utf-8"):
                self.stored[path] = self
        else:
            self.attrs, self.members = self.stored[path].attrs, self.stored[path].members

    def close(self):
        pass


def stubs():
    """Returns a module for each need of quflow that is missing here."""
    contents = {"numba": dict(njit=compiled, jit=compiled, prange=range), "h5py": dict(File=File, Dataset=Dataset),
                "appdirs": dict(user_data_dir=lambda *_: tempfile.gettempdir()), "matplotlib": {},
                "ducc0": dict(sht=types.SimpleNamespace(
                    experimental=types.SimpleNamespace(synthesis_2d=synthesis_2d)))}
    missing = {}
    for name, names in contents.items():
        if importlib.util.find_spec(name) is None:
            missing[name] = types.ModuleType(name)
            vars(missing[name]).update(names)
    if "matplotlib" in missing:
        for name in ("matplotlib.pyplot", "matplotlib.animation", "matplotlib.colors", "matplotlib.backends",
                     "matplotlib.backends.backend_agg", "mpl_toolkits", "mpl_toolkits.axes_grid1"):
            missing[name] = mock.MagicMock()
    return missing


@unittest.skipUnless(QUFLOW, "QUFLOW names no checkout of quflow")
class QuflowItself(unittest.TestCase):
    """The comparison that a new user would make, at N = 64."""

    N = 64

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        settings = mock.patch.dict(os.environ, XDG_DATA_HOME=cls.folder.name)  # quflow keeps its bases there
        modules, path = mock.patch.dict(sys.modules, stubs()), mock.patch.object(sys, "path", [QUFLOW, *sys.path])
        for each in (settings, modules, path):
            each.start()
            cls.addClassCleanup(each.stop)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of escape sequences
            cls.quflow = importlib.import_module("quflow")
        N = cls.N
        cls.omega = np.zeros(N**2)
        cls.omega[1:121] = np.random.default_rng(1).normal(size=120)  # l = 1 ... 10
        W = cls.quflow.shr2mat(cls.omega, N=N)
        cls.omega /= np.linalg.norm(W, 2)
        cls.W = W / np.linalg.norm(W, 2)
        cls.dt = 2 / np.sqrt(N**2 - 1)

    def solved(self, integrator, steps=8, **options):
        """Returns the end of a run, and the energies on the way."""
        energies, W = [], self.W.copy()
        self.quflow.solve(W, dt=self.dt, steps=steps, steps_out=4, integrator=integrator, progress_bar=False,
                          callback=lambda W, **_: energies.append(self.quflow.energy_euler(W)), **options)
        return W, np.array(energies)

    def test_energies_and_casimirs_are_those_of_its_isomp_to_its_tolerance(self):
        steps = 8
        W, energies = self.solved(isosyrk.quflow.integrator("algebra1"))
        casimirs = isosyrk.casimir_errors(W, self.W)
        # quflow's tolerance is of the last change of half a step's unknown, in the maximum norm; its own default is
        # sqrt(eps) dt/ħ ‖W‖, here 1.5e-8 ‖W‖. What is left of a step is less than that for a contraction below 1/2,
        # and twice as much in W.
        for options, tolerance in (({}, 1.5e-8), (dict(tol=1e-14, maxit=100), TOLERANCE)):
            own, own_energies = self.solved(self.quflow.isomp, **options)
            bound = 2 * steps * tolerance
            self.assertLess(np.linalg.norm(W - own, np.inf), bound * np.linalg.norm(own, np.inf))
            self.assertLess(np.abs(energies / own_energies - 1).max(), bound)
            for mine, theirs in zip(casimirs, isosyrk.casimir_errors(own, self.W)):
                self.assertLess(abs(mine - theirs), bound)
        # A control: another method of order 2.
        other, _ = self.solved(isosyrk.quflow.integrator("cotangent1"))
        self.assertGreater(isosyrk.relative_error(self.solved(isosyrk.quflow.integrator("group2"))[0], W), 1e-6)
        self.assertLess(isosyrk.relative_error(other, W), 1e-2)

    def test_a_simulation_on_disk(self):
        path = os.path.join(self.folder.name, "run.hdf5")
        simulation = self.quflow.QuSimulation(path, overwrite=True, state=self.W, qutypes={"mat": None},
                                              loggers={"energy": self.quflow.energy_euler})
        method = isosyrk.quflow.integrator("elp6_frame", tolerance=1e-8)
        for name, value in dict(dt=self.dt, steps_out=2, simtime=4 * self.dt, integrator=method).items():
            simulation[name] = value
        self.quflow.solve(simulation, progress_bar=False)
        again = self.quflow.QuSimulation(path)
        self.assertEqual(repr(again["integrator"]), repr(method))
        self.quflow.solve(again, progress_bar=False)
        self.assertEqual(list(again["step"]), [0, 2, 4, 6, 8])
        self.assertEqual([len(again[name]) for name in ("iterations", "number_of_maxit", "tol_auto")], [5, 5, 5])
        self.assertLess(np.abs(again["energy"] / again["energy"][0] - 1).max(), 1e-8)
        wanted, _ = self.solved(method)
        self.assertLess(isosyrk.relative_error(again["mat", -1], wanted), 1e-7)

    def test_what_it_cannot_do(self):
        method = isosyrk.quflow.integrator()
        for message, options in (("^hamiltonian: must be", dict(hamiltonian=lambda W: self.quflow.solve_poisson(W))),
                                 ("^hamiltonian: must be", dict(hamiltonian=self.quflow.laplacian.cpu.solve_globalqg)),
                                 ("^forcing: ", dict(forcing=lambda P, W: 0 * W)), ("^compsum: ", dict(compsum=True))):
            with self.assertRaisesRegex(ValueError, message):
                self.solved(method, 1, **options)
        for module in ("direct", "tridiagonal", "cpu"):
            self.solved(method, 1, hamiltonian=getattr(self.quflow.laplacian, module).solve_poisson)

    def test_conventions_of_the_page(self):
        scene = isosyrk.scene(modes=modes_of(self.omega, self.N), n=self.N, hbar="standard")
        np.testing.assert_allclose(scene.initial, self.W, atol=1e-13)
        self.assertAlmostEqual(scene.energy(self.W) / self.N / self.quflow.energy_euler(self.W), 1, 12)

    def test_fields_and_energies_of_the_page(self):
        quflow, N = self.quflow, 12  # closed forms of the stand-in lose digits at large l
        omega = np.random.default_rng(2).normal(size=N * N)
        W = quflow.shr2mat(omega)
        theta, phi = (each[:, 0] if place else each[0] for place, each in zip((1, 0), quflow.sphgrid(N)))
        for berezin in (False, True):
            wanted = quflow.shr2fun(quflow.mat2shr(W), berezin=berezin)
            found = isosyrk.vorticity(W, np.pi / 2 - theta, phi, berezin=berezin)
            np.testing.assert_allclose(found, wanted, atol=1e-10)
            self.assertGreater(np.abs(isosyrk.vorticity(W, theta - np.pi / 2, phi, berezin) - wanted).max(), 0.1)
        np.testing.assert_array_equal(quflow.shr2fun(quflow.mat2shr(W)), wanted)  # by default
        degrees, energies = quflow.analysis.energy_spectrum(W)
        np.testing.assert_array_equal(degrees, np.arange(1, N))
        np.testing.assert_allclose(isosyrk.energy_spectrum(W)[1:], N / 2 * energies)
        np.testing.assert_allclose(isosyrk.solve_poisson(W), quflow.solve_poisson(W), atol=1e-12)
        np.testing.assert_allclose(isosyrk.laplace(W), quflow.laplacian.laplace(W), atol=1e-10)

    def test_the_callback_of_a_step(self):
        seen = {}
        for integrator, options in ((self.quflow.isomp, dict(tol=1e-14, maxit=100)), (isosyrk.quflow.integrator(), {})):
            pairs = seen[integrator] = []
            self.solved(integrator, 3, integrator_callback=lambda *pair: pairs.append([each.copy() for each in pair]),
                        **options)
        np.testing.assert_allclose(*seen.values(), atol=1e-12)
