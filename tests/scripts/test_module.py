"""Tests of the NumPy module: its answers, what it does with arrays, and what it refuses.

Run with: python3 -m unittest test_module (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import concurrent.futures
import contextlib
import gc
import importlib.util
import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tracemalloc
import unittest
import weakref
from unittest import mock

from programs import BUILD, ROOT, SANITIZED, cpu_seconds_of, environment, program, run, run_script, start, text_of

from lib.records.integrators import FAMILIES

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np

import isosyrk

TOLERANCE = 1e-13
SMOOTH = isosyrk.scene("smooth", n=9)


def ran(scene, name, steps, **options):
    """Returns the last state of a run with h = 0.1 from a scene's initial data, and its work."""
    return isosyrk.integrator(scene, name, **options).run(scene.initial, 0.1, steps)


def spin(n):
    """Returns the spin matrices S_x, S_y, S_z of size n."""
    s = (n - 1) / 2
    m = s - np.arange(n)
    up = np.diag(np.sqrt(s * (s + 1) - m[1:] * (m[1:] + 1)), 1)
    return (up + up.T) / 2, (up - up.T) / 2j, np.diag(m)


def state(n=9, seed=1):
    """Returns some state that is no mode of the project's: skew-Hermitian, without trace, norm about 1."""
    entries = np.random.default_rng(seed).normal(size=(2, n, n)) / n
    W = entries[0] + 1j * entries[1]
    W = W - W.conj().T
    return W - np.trace(W) / n * np.eye(n)


def python(code, how=run, OMP_DISPLAY_ENV=None, **options):
    """Runs, or starts, Python with the module on its path."""
    settings = environment(PYTHONPATH=os.path.join(BUILD, "python"), OMP_DISPLAY_ENV=OMP_DISPLAY_ENV)
    return how([sys.executable, "-c", code], env=settings, **options)


class Answers(unittest.TestCase):
    def test_run_is_that_of_integrate(self):
        for solver in ("published", "fast"):
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "W.npy")
                products = () if solver == "fast" else ("--products", "openblas")
                subprocess.run([program("integrate"), "--n", "17", "--integrator", "group2", "--step", "0.1",
                                "--time", "2", "--solver", solver, "--output", path, *products],
                               check=True, stdout=subprocess.DEVNULL)
                wanted = np.load(path)
            W, report = ran(isosyrk.scene("smooth", n=17), "group2", 20, solver=solver)
            self.assertTrue(np.array_equal(W, wanted), solver)
            self.assertEqual(report.steps, 20)
            self.assertGreater(report.equivalent_products, 0)

    def test_generator_solves_the_poisson_equation_in_both_conventions_of_hbar(self):
        n, W = 9, state(9)
        for hbar, value in (("paper", 2 / np.sqrt(n * (n - 1))), ("standard", 2 / np.sqrt(n**2 - 1))):
            P = value * isosyrk.scene(initial=W, hbar=hbar).generator(W)
            # The Laplacian is minus the double commutator with the spin matrices.
            commutators = [S @ P - P @ S for S in spin(n)]
            laplacian = -sum(S @ C - C @ S for S, C in zip(spin(n), commutators))
            self.assertLess(np.abs(laplacian - W).max(), 1e-13)

    def test_switches_and_threads_do_not_move_the_answer(self):
        scene = isosyrk.scene("smooth", n=65)  # large enough for bands and for two threads
        wanted, predicted = ran(scene, "group2", 10, solver="fast")
        self.assertTrue(np.array_equal(ran(scene, "group2", 10, solver="fast", threads=2)[0], wanted))
        for switch in ("predictor", "newton", "bands"):
            W, report = ran(scene, "group2", 10, solver="fast", without=(switch,))
            self.assertLess(np.abs(W - wanted).max(), 100 * TOLERANCE)
            self.assertGreater(report.equivalent_products, predicted.equivalent_products, switch)
        unused = set(isosyrk.SWITCHES) - {"predictor", "newton", "bands"}
        self.assertTrue(np.array_equal(ran(scene, "group2", 10, solver="fast", without=unused)[0], wanted))

    def test_switches_of_exponential_methods(self):
        scene = isosyrk.scene("smooth", n=17)

        def run(*without):
            return isosyrk.integrator(scene, "elp4", solver="fast", tolerance=1e-8, without=without).run(
                scene.initial, 0.25, 10)

        wanted, complete = run()
        for switch in ("explicit_start", "error_estimates", "graded_series"):
            W, report = run("predictor", switch)
            self.assertLess(np.abs(W - wanted).max(), 1e-6)
            self.assertGreater(report.equivalent_products, 1.1 * complete.equivalent_products, switch)

    def test_measures(self):
        W0, W = SMOOTH.initial, state(9)
        self.assertLess(np.abs(isosyrk.spectrum(W) - np.linalg.eigvalsh(-1j * W)).max(), 1e-13)
        self.assertAlmostEqual(isosyrk.spectrum_error(2 * W, W), np.abs(np.linalg.eigvalsh(-1j * W)).max(), 12)
        self.assertEqual((isosyrk.skew_defect(W), isosyrk.skew_defect(1j * W) > 0), (0.0, True))
        for factor in (1e-8, 1e6):
            nearly, broken = factor * W, factor * W
            nearly[0, 1] *= 1 + 1e-12
            broken[0, 1] *= 1 + 1e-6
            isosyrk.spectrum(nearly)
            for refused in (broken, np.ones((3, 3), complex), np.ones((3, 3))):
                with self.assertRaisesRegex(ValueError,
                                            r"^W: the largest entry of \|W \+ W†\| is .* \(skew-Hermitian\)$"):
                    isosyrk.spectrum(refused)
        self.assertAlmostEqual(isosyrk.relative_error(1.5 * W, W), 0.5)
        self.assertAlmostEqual(isosyrk.casimir_errors(2 * W0, W0)[0], 3.0, 10)
        momentum = [np.trace(S @ W0).imag for S in spin(9)]
        self.assertAlmostEqual(isosyrk.angular_momentum_error(3 * W0, W0),
                               2 * np.abs(momentum).max() / np.linalg.norm(momentum), 12)
        norm_B, norm_ad_B = SMOOTH.generator_norms()
        self.assertAlmostEqual(norm_B, np.linalg.norm(SMOOTH.generator(W0), 2), 12)
        self.assertGreater(norm_ad_B, norm_B)

    def test_modes_make_the_scene_of_the_same_name(self):
        with open(os.path.join(ROOT, "tests", "data", "initial_modes.csv"), encoding="utf-8") as lines:
            rows = [line.split(",") for line in lines if line[0].isdigit()]
        modes = [(int(l), int(m), float(re), float(im)) for l, m, re, im in rows]
        made = isosyrk.scene(modes=modes, n=9)
        self.assertTrue(np.array_equal(SMOOTH.initial, made.initial))
        self.assertEqual(SMOOTH.modes_hash, made.modes_hash)

    def test_timed_runs_repeat_the_state_and_leave_it(self):
        method = isosyrk.integrator(SMOOTH, "group2", solver="fast")
        W = SMOOTH.initial.copy()
        times = method.timed_run(W, h=0.1, steps=50, repetitions=3, warmup=5)
        self.assertEqual(len(times), 3)
        self.assertTrue(np.array_equal(W, SMOOTH.initial))


class Arrays(unittest.TestCase):
    def setUp(self):
        self.scene = isosyrk.scene("smooth", n=17)
        self.method = isosyrk.integrator(self.scene, "group2", solver="fast")
        self.wanted, _ = self.method.run(self.scene.initial, 0.1, 5)

    def test_input_of_any_layout_gives_the_same_and_stays(self):
        W0 = self.scene.initial
        spread = np.zeros((34, 34), complex)[::2, ::2]
        spread[...] = W0
        read_only = W0.copy()
        read_only.flags.writeable = False
        for W in (np.asfortranarray(W0), spread, read_only, W0.tolist(), W0.astype(">c16")):
            self.assertTrue(np.array_equal(self.method.run(W, 0.1, 5)[0], self.wanted))
            self.assertTrue(np.array_equal(W, W0))

    def test_input_of_other_numbers_is_converted(self):
        d = np.arange(1.0, 5.0)
        W = np.triu(np.arange(16).reshape(4, 4), 1)
        W = W - W.T
        for scene in (isosyrk.scene("rigid_body", n=4), isosyrk.scene("rigid_body", initial=W / 8.0),
                      isosyrk.scene(initial=W / 8.0, generator=lambda W: W / (d[:, None] + d[None, :]))):
            method = isosyrk.integrator(scene, "algebra2")
            wanted, _ = method.run(W.astype(complex) / 8, 0.1, 3)
            for dtype in (np.float16, np.float32, np.float64, ">f8", np.complex64):
                result, _ = method.run((W / 8).astype(dtype), 0.1, 3)
                self.assertEqual(result.dtype, np.complex128)
                self.assertTrue(np.array_equal(result, wanted), dtype)
            self.assertTrue(np.array_equal(method.step(W, 0.01), method.step(W.astype(complex), 0.01)))

    def test_input_is_converted_once_a_run(self):
        converted = []

        class Counted(np.ndarray):
            def __array_finalize__(self, other):
                converted.append(other)

        W = np.ascontiguousarray(isosyrk.scene("rigid_body", n=17).initial.real).view(Counted)
        method = isosyrk.integrator(isosyrk.scene("rigid_body", n=17), "group1")
        counts = []
        for steps in (1, 20):
            converted.clear()
            method.run(W, 0.1, steps)
            counts.append(len(converted))
        self.assertEqual(*counts)

    def test_out_is_written_and_may_be_the_input(self):
        W = self.scene.initial.copy()
        result, _ = self.method.run(W, 0.1, 5, out=W)
        self.assertIs(result, W)
        self.assertTrue(np.array_equal(W, self.wanted))
        read_only = np.empty_like(W)
        read_only.flags.writeable = False
        for out in (read_only, np.asfortranarray(W), np.empty((17, 18), complex), np.empty((17, 17), np.float64)):
            with self.assertRaisesRegex(ValueError, "^out: "):
                self.method.run(self.scene.initial, 0.1, 5, out=out)

    def test_no_copy_of_W_a_step(self):
        W = self.scene.initial.copy()

        def peak(observe):
            tracemalloc.start()
            self.method.run(W, 0.1, 20, observe=observe, out=W)
            _, maximum = tracemalloc.get_traced_memory()
            tracemalloc.stop()
            return maximum

        kept = []
        self.assertLess(peak(lambda step, V, report: self.assertTrue(np.shares_memory(V, W))), 2 * W.nbytes)
        self.assertGreater(peak(lambda step, V, report: kept.append(V.copy())), 20 * W.nbytes)

    def test_observer_sees_every_state_and_may_end_the_run(self):
        seen = []

        def observe(step, W, report):
            self.assertEqual(report.steps, step)
            with self.assertRaises(ValueError):
                W[0, 0] = 0
            seen.append((step, W.copy()))
            return np.float64(step) == 4  # an np.bool_

        W, report = self.method.run(self.scene.initial, 0.1, 9, observe=observe, every=2)
        self.assertEqual([step for step, _ in seen], [2, 4])
        self.assertEqual(report.steps, 4)
        self.assertTrue(np.array_equal(W, seen[-1][1]))
        self.method.run(self.scene.initial, 0.1, 5, observe=lambda step, *_: seen.append((step, None)), every=2)
        self.assertEqual([step for step, _ in seen[2:]], [2, 4, 5])


def damped(step, W):
    """Changes W as friction does in a step of 0.1."""
    W *= 1 - 1e-4


class Between(unittest.TestCase):
    """What a run may change between its steps."""

    def test_it_is_called_after_each_step_and_the_next_one_begins_with_what_it_leaves(self):
        def change(step, W):
            called.append(step)
            W *= 0.4 if step == 3 else 0.95  # a twofold change, too
            W += 0.01 * force / step

        scenes = [SMOOTH, isosyrk.scene("rough", n=9), isosyrk.scene("rigid_body", n=5),
                  isosyrk.scene("spin_chain", n=8), isosyrk.scene("symplectic", n=4),
                  isosyrk.scene("pseudo_unitary", n=4, signature=(2, 2)),
                  isosyrk.scene(initial=state(), generator=SMOOTH.generator)]
        for scene in scenes:
            zeitlin = scene.hbar is not None
            # Conjugate, so that it is in the algebra, and another matrix.
            force = isosyrk.integrator(scene, "algebra1").step(scene.initial, 0.5)
            for name in ("cotangent1", "group2", "algebra1", "algebra3", "direct2", "yoshida4", "rk4", "rkmk4",
                         *["group2_frame", "algebra1_frame", "rk4_frame"] * zeitlin):
                for solver in isosyrk.SOLVERS[:1 + zeitlin]:
                    with self.subTest(scene=scene.name, name=name, solver=solver):
                        called, seen = [], []
                        method = isosyrk.integrator(scene, name, solver=solver)
                        W = scene.initial.copy()
                        for step in range(1, 7):
                            W = method.step(W, 0.05)
                            change(step, W)
                        found, report = method.run(scene.initial, 0.05, 6, between=change, every=2,
                                                   observe=lambda step, W, _: seen.append((step, W.copy())))
                        self.assertEqual(called, [1, 2, 3, 4, 5, 6] * 2)
                        self.assertEqual((report.steps, [step for step, _ in seen]), (6, [2, 4, 6]))
                        self.assertTrue(np.array_equal(found, seen[-1][1]))
                        self.assertLess(isosyrk.relative_error(found, W), 1e-11)

    def test_what_leaves_W_alone_changes_no_digit(self):
        for name, solver in (("group2", "fast"), ("yoshida4", "fast"), ("rk4", "fast"), ("algebra2", "published")):
            wanted, report = ran(SMOOTH, name, 10, solver=solver)
            found, again = isosyrk.integrator(SMOOTH, name, solver=solver).run(SMOOTH.initial, 0.1, 10,
                                                                               between=lambda step, W: None)
            self.assertTrue(np.array_equal(found, wanted), name)
            self.assertEqual((report.sweeps, report.products), (again.sweeps, again.products))

    def test_a_damped_run_costs_what_an_undamped_one_does(self):
        def cost(scene, name, **options):
            between = options.pop("between", None)
            method = isosyrk.integrator(scene, name, solver="fast", **options)
            return method.run(scene.initial, 0.1, 100, between=between)[1]

        for scene in (isosyrk.scene("smooth", n=33), isosyrk.scene("rough", n=17)):
            for name in ("algebra1", "cotangent2", "group2", "group3", "algebra2", "direct2", "yoshida4",
                         "group2_frame", "algebra1_frame"):
                with self.subTest(scene=scene.name, name=name):
                    undamped, found = cost(scene, name), cost(scene, name, between=damped)
                    cold = cost(scene, name, between=damped, without=("predictor",))
                    self.assertLessEqual(found.sweeps, 1.3 * undamped.sweeps)
                    self.assertLessEqual(found.equivalent_products, 1.3 * undamped.equivalent_products)
                    # The control.
                    self.assertGreater(cold.equivalent_products, 1.3 * undamped.equivalent_products)

    def test_it_may_return_W_as_ufuncs_do(self):
        method = isosyrk.integrator(SMOOTH, "group2")
        wanted, _ = method.run(SMOOTH.initial, 0.1, 5, between=damped)
        found, _ = method.run(SMOOTH.initial, 0.1, 5, between=lambda step, W: np.multiply(W, 1 - 1e-4, out=W))
        self.assertTrue(np.array_equal(found, wanted))

    def test_what_it_must_not_leave_is_refused_and_the_run_ends_at_the_last_step_done(self):
        def at_step_3(change):
            return lambda step, W: damped(step, W) if step < 3 else change(W)

        def raises(W):
            W *= 2
            raise KeyError("mine")

        def not_finite(W):
            W[1, 2] = np.nan

        def not_skew(W):
            W[0, 1] += 0.1

        def zero(W):
            W *= 0

        def imaginary(W):
            W *= 1j

        def imaginary_inside(W):
            W += 1e-3j * np.eye(len(W))

        def outside_blocks(W):
            W[0, 5] = 1
            W[5, 0] = -1

        chain, body = isosyrk.scene("spin_chain", n=8), isosyrk.scene("rigid_body", n=5)
        for scene, name, solver, change, error, message in (
                (SMOOTH, "group2", "published", not_finite, ValueError, r"^between, step 3: entry \(1, 2\) is nan"),
                (SMOOTH, "group2", "fast", not_finite, ValueError, r"^between, step 3: entry \(1, 2\) is nan"),
                (SMOOTH, "group2_frame", "fast", not_skew, ValueError, "^between, step 3: the largest .*skew-Herm"),
                (SMOOTH, "rk4", "fast", imaginary, ValueError, r"^between, step 3: the largest .*\|W \+ W†\|"),
                (SMOOTH, "yoshida4", "fast", zero, ValueError, "^between, step 3: all entries are 0"),
                (body, "group2", "published", imaginary_inside, ValueError, "^between, step 3: W: .* must be real$"),
                (chain, "algebra2", "published", outside_blocks, ValueError, "^between, step 3: W: .* outside"),
                (SMOOTH, "group2", "fast", lambda W: 0.9 * W, TypeError, "^between: returned a ndarray, must change W"),
                (SMOOTH, "algebra1", "fast", raises, KeyError, "^'mine'$")):
            with self.subTest(name=name, change=change.__name__):
                method = isosyrk.integrator(scene, name, solver=solver)
                out = np.empty_like(scene.initial)
                seen = []
                with self.assertRaisesRegex(error, message) as raised:
                    method.run(scene.initial, 0.1, 9, out=out, between=at_step_3(change),
                               observe=lambda step, W, _: seen.append(W.copy()))
                self.assertNotIn("\n", str(raised.exception))
                self.assertIs(raised.exception.W, out)
                self.assertEqual((raised.exception.report.steps, len(seen)), (2, 2))
                self.assertTrue(np.array_equal(out, seen[-1]))
                # From there the run can go on.
                rest, _ = method.run(out, 0.1, 3, between=damped)
                whole, _ = method.run(scene.initial, 0.1, 5, between=damped)
                self.assertLess(isosyrk.relative_error(rest, whole), 1e-11)

    def test_a_step_that_fails_leaves_what_it_began_with(self):
        method = isosyrk.integrator(SMOOTH, "group2", max_sweeps=40)
        seen = []
        with self.assertRaises(isosyrk.SolverError) as raised:
            method.run(SMOOTH.initial, 0.1, 9, between=lambda step, W: np.multiply(W, 3, out=W),
                       observe=lambda step, W, _: seen.append(W.copy()))
        self.assertEqual(raised.exception.step, len(seen) + 1)
        self.assertGreater(len(seen), 0)
        self.assertTrue(np.array_equal(raised.exception.W, seen[-1]))


class Parts(unittest.TestCase):
    """A run from the W that the call before has returned is the rest of the run in one go, bit for bit."""

    SCENES = (SMOOTH, isosyrk.scene(initial=SMOOTH.initial + 100j * np.eye(SMOOTH.n)))  # the other has a trace

    def for_each(self):
        for scene in self.SCENES:
            for solver in isosyrk.SOLVERS:
                for name in ("group2", "elp4", "rk4_projected", "group2_frame", "rkmk4_frame", "rk4_projected_frame"):
                    with self.subTest(trace=scene is not SMOOTH, solver=solver, name=name):
                        yield scene, lambda: isosyrk.integrator(scene, name, solver=solver)

    @staticmethod
    def work(report):
        return np.array([report.steps, report.sweeps, report.products, report.poisson_solves])

    def test_runs_and_single_steps_are_the_run_in_one_go(self):
        for scene, make in self.for_each():
            whole, expected = make().run(scene.initial, 0.1, 20)
            method, W, total = make(), scene.initial, 0
            for _ in range(2):
                W, report = method.run(W, 0.1, 10)
                total = total + self.work(report)
            self.assertTrue(np.array_equal(W, whole))
            self.assertEqual(total.tolist(), self.work(expected).tolist())
            method, W = make(), scene.initial
            for _ in range(20):
                W = method.step(W, 0.1)
            self.assertTrue(np.array_equal(W, whole))

    def test_what_between_leaves_is_where_the_next_part_begins(self):
        for scene, make in self.for_each():
            def damp(step, W):
                W *= 0.999

            whole, _ = make().run(scene.initial, 0.1, 8, between=damp)
            method, W = make(), scene.initial
            for _ in range(2):
                W, _ = method.run(W, 0.1, 4, between=damp)
            self.assertTrue(np.array_equal(W, whole))

    def test_a_step_of_another_state_in_between_begins_both_anew(self):
        for scene, make in self.for_each():
            method = make()
            W, _ = method.run(scene.initial, 0.1, 5)
            other = 0.5 * W
            self.assertTrue(np.array_equal(method.step(other, 0.1), make().step(other, 0.1)))
            self.assertTrue(np.array_equal(method.run(W, 0.1, 5)[0], make().run(W, 0.1, 5)[0]))


class Ended(unittest.TestCase):
    """What a run that an exception ends leaves."""

    def setUp(self):
        self.method = isosyrk.integrator(SMOOTH, "group2", solver="fast")

    def ended(self, error, steps=9, **options):
        with self.assertRaises(type(error)) as raised:
            self.method.run(SMOOTH.initial, 0.1, steps, **options)
        self.assertIs(raised.exception, error)
        return raised.exception

    def test_the_state_and_the_work_are_with_the_exception(self):
        wanted, report = self.method.run(SMOOTH.initial, 0.1, 4)
        for error in (KeyError("mine"), KeyboardInterrupt(), SystemExit()):
            def observe(step, W, report):
                if step == 4:
                    raise error

            found = self.ended(error, observe=observe)
            self.assertTrue(np.array_equal(found.W, wanted))
            self.assertEqual(found.report[:5], report[:5])
            self.assertGreater(found.report.seconds, 0)

    def test_of_a_generator_too(self):
        def generator(W):
            if len(seen) == 3:
                raise error
            return SMOOTH.generator(W)

        error, seen = KeyError("mine"), []
        self.method = isosyrk.integrator(isosyrk.scene(initial=SMOOTH.initial, generator=generator), "group2")
        found = self.ended(error, observe=lambda step, W, _: seen.append(W.copy()))
        self.assertEqual(found.report.steps, 3)
        self.assertTrue(np.array_equal(found.W, seen[-1]))

    def test_an_exception_that_has_no_room_for_them_passes(self):
        class Odd(Exception):
            W = property(lambda self: "mine")

        def observe(*_):
            raise error

        error = Odd()
        self.assertEqual(self.ended(error, observe=observe).W, "mine")

    def test_a_failed_run_within_a_run_keeps_its_own(self):
        def observe(*_):
            isosyrk.integrator(inner, "group1", max_sweeps=1).run(inner.initial, 0.1, 3)

        inner = isosyrk.scene("smooth", n=5)
        with self.assertRaises(isosyrk.SolverError) as raised:
            self.method.run(SMOOTH.initial, 0.1, 9, observe=observe)
        self.assertEqual((raised.exception.W.shape, raised.exception.report.steps), ((5, 5), 0))

    def test_a_call_that_never_began_leaves_none(self):
        def observe(*_):
            with self.assertRaisesRegex(RuntimeError, "in use") as raised:
                self.method.step(SMOOTH.initial, 0.1)
            self.assertFalse(hasattr(raised.exception, "W"))

        self.method.run(SMOOTH.initial, 0.1, 2, observe=observe)


class Progress(unittest.TestCase):
    CODE = ("import isosyrk\n"
            "scene = isosyrk.scene('smooth', n=9)\n"
            "method = isosyrk.integrator(scene, 'group2', max_sweeps=SWEEPS)\n"
            "try:\n"
            "    W, report = method.run(scene.initial, 0.1, 20, progress=True)\n"
            "    print('done', report.steps)\n"
            "except Exception as error:\n"
            "    print(type(error).__name__, error)\n")

    def test_a_bar_shows_the_steps_done(self):
        if importlib.util.find_spec("tqdm") is None:
            self.skipTest("this Python has no tqdm (python3-tqdm)")
        done = python(self.CODE.replace("SWEEPS", "100"))
        self.assertEqual((done.returncode, done.stdout), (0, "done 20\n"))
        self.assertRegex(done.stderr, r"100%\|.*\| 20/20 \[.*\]\n$")
        done = python(self.CODE.replace("SWEEPS", "1"))
        self.assertRegex(done.stdout, "^SolverError sweep cap at step 1 ")
        self.assertRegex(done.stderr, r"\| 0/20 \[.*\]\n$")

    def test_a_long_run_shows_it_now_and_then(self):
        shown = []
        with mock.patch.object(isosyrk, "_Bar", lambda steps, outcome: contextlib.nullcontext(shown.append)):
            begun = time.monotonic()
            isosyrk.integrator(SMOOTH, "rk4").run(SMOOTH.initial, 1e-6, 10**6, progress=True, every=100,
                                                  observe=lambda *_: len(shown) == 3)
            self.assertGreaterEqual(time.monotonic() - begun, 0.3)
        self.assertEqual((len(shown), shown), (3, sorted(set(shown))))

    def test_without_tqdm_one_line_says_so(self):
        done = python("import sys; sys.modules['tqdm'] = None\n" + self.CODE.replace("SWEEPS", "100"))
        self.assertEqual(done.stdout,
                         "ImportError progress: needs tqdm (the package python3-tqdm, or pip install tqdm)\n")
        self.assertEqual(done.stderr, "")


def reference(B, W, time, steps=500):
    """Returns the end of the classical Runge-Kutta method for W' = [B(W), W]."""
    def slope(W):
        return B(W) @ W - W @ B(W)

    h = time / steps
    for _ in range(steps):
        k1 = slope(W)
        k2 = slope(W + h / 2 * k1)
        k3 = slope(W + h / 2 * k2)
        W = W + h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(W + h * k3))
    return W


def rigid_body(n=8):
    d = np.linspace(0.5, 2, n)
    W = np.random.default_rng(1).normal(size=(n, n))
    W -= W.T
    return W / np.linalg.norm(W, 2), lambda W: W / (d[:, None] + d[None, :])


def toda(n=6):
    """W = iL, L tridiagonal; L' = [B, L] with B = L_+ - L_-."""
    W = 1j * (np.diag(np.cos(np.arange(n))) + np.diag(np.full(n - 1, 0.4), 1) + np.diag(np.full(n - 1, 0.4), -1))
    return W, lambda W: -1j * (np.triu(W, 1) - np.tril(W, -1))


def vortices(count=3):
    """Point vortices W_k = (i/2) x_k . sigma in diagonal blocks; B_k = 0.4 * sum of W_j / (1.1 - x_j . x_k), j != k."""
    x = np.random.default_rng(2).normal(size=(count, 3))
    x /= np.linalg.norm(x, axis=1)[:, None]
    W = np.zeros((2 * count, 2 * count), complex)
    for k, (a, b, c) in enumerate(x):
        W[2 * k:2 * k + 2, 2 * k:2 * k + 2] = 0.5j * np.array([[c, a - 1j * b], [a + 1j * b, -c]])

    def B(W):
        blocks = [W[k:k + 2, k:k + 2] for k in range(0, 2 * count, 2)]
        result = np.zeros_like(W)
        for k, mine in enumerate(blocks):
            result[2 * k:2 * k + 2, 2 * k:2 * k + 2] = sum(0.4 * other / (1.1 + 2 * np.trace(other @ mine))
                                                           for j, other in enumerate(blocks) if j != k)
        return result

    return W, B


class OwnFlow(unittest.TestCase):
    def test_measured_limits_are_those_of_a_form_around_an_n(self):
        limit = isosyrk.measured_limit
        self.assertEqual(limit("group2", 24), min(limit("group2", 17), limit("group2", 33)))
        self.assertGreater(limit("group2", 33, "fast"), 1.3 * limit("group2", 33))
        self.assertIsNotNone(limit("elp4_frame", 129, "fast"))
        for nothing in (("group2", 65), ("group2", 16), ("elp4_frame", 130, "fast"), ("elp4_frame", 33)):
            self.assertIsNone(limit(*nothing), nothing)  # beyond the recorded n, and a form that was not tried
        for wrong in (("euler", 33), ("group2", 33, "slow")):
            with self.assertRaises(ValueError):
                limit(*wrong)

    def test_every_published_method_integrates_flows_of_ones_own(self):
        controls = ["algebra2_two_products", "algebra3_two_products", "yoshida4_group", "yoshida4_cotangent"]
        orders = {entry.name: entry.order for entry in isosyrk.integrators() if not entry.co_rotating}
        isospectral = {entry.name for entry in isosyrk.integrators() if entry.isospectral}
        for flow in (rigid_body, toda, vortices):
            W0, B = flow()
            wanted = reference(B, W0, 0.5)
            self.assertGreater(isosyrk.relative_error(wanted, W0), 0.01)
            scene = isosyrk.scene(initial=W0, generator=B)
            for name in [*orders, *controls]:
                with self.subTest(flow=flow.__name__, name=name):
                    if name in ("elp4", "elp6") and flow is not rigid_body:
                        with self.assertRaisesRegex(ValueError, "^elp[46]: B .* self-adjoint .*; elp2 takes any B$"):
                            isosyrk.integrator(scene, name)
                        continue
                    W, _ = isosyrk.integrator(scene, name).run(W0, 0.025, 20)
                    order = orders.get(name, 4)
                    self.assertLess(isosyrk.relative_error(W, wanted), 1.5e-3 if order == 2 else 5e-6)
                    self.assertLess(isosyrk.skew_defect(W), 1e-11)
                    if name in isospectral:
                        self.assertLess(isosyrk.spectrum_error(W, np.asarray(W0, complex)), 1e-11)

    def test_elp4_and_elp6_try_once_whether_a_generator_is_linear_and_self_adjoint(self):
        W0, B = rigid_body()
        calls = []

        def counted(W):
            calls.append(W)
            return B(W)

        scene = isosyrk.scene(initial=7 * W0, generator=counted)
        for name in ("group2", "elp2", "magnus4"):
            isosyrk.integrator(scene, name)
        self.assertEqual(len(calls), 0)
        for name in ("elp4", "elp6", "elp4"):
            isosyrk.integrator(scene, name)
        self.assertEqual(len(calls), 3)
        for W in calls:
            self.assertEqual(isosyrk.skew_defect(W), 0.0)
            self.assertAlmostEqual(np.linalg.norm(W) / np.linalg.norm(7 * W0), 1, delta=0.1)

        # A part of 1e-8 is seen, and one of 1e-13 is rounding.
        turned = state(8)
        parts = {"constant": lambda W: turned, "cubic": lambda W: W @ W @ W, "not finite": lambda W: np.nan * W,
                 "not self-adjoint": lambda W: turned @ W - W @ turned}
        for what, part in parts.items():
            for size, accepted in ((1e-8, False), (1e-13, what != "not finite")):
                with self.subTest(what, size=size):
                    scene = isosyrk.scene(initial=W0, generator=lambda W: B(W) + size * part(W))
                    if accepted:
                        isosyrk.integrator(scene, "elp4")
                    else:
                        with self.assertRaisesRegex(ValueError, "^elp4: B of this flow is not known to be linear"):
                            isosyrk.integrator(scene, "elp4")
                        isosyrk.integrator(scene, "elp2")

    def test_an_exception_of_a_generator_that_is_tried_is_that_of_the_caller(self):
        def fails(W):
            raise ZeroDivisionError("by the user")

        W0, _ = rigid_body()
        with self.assertRaisesRegex(ZeroDivisionError, "by the user"):
            isosyrk.integrator(isosyrk.scene(initial=W0, generator=fails), "elp6")

    def test_a_generator_sees_skew_hermitian_matrices_only(self):
        W0, B = rigid_body()
        defects = []
        scene = isosyrk.scene(initial=W0, generator=lambda W: defects.append(isosyrk.skew_defect(W)) or B(W))
        for name in ("cotangent2", "group2", "algebra2", "algebra3", "direct2", "rkmk4"):
            isosyrk.integrator(scene, name).run(W0, 0.01, 3)
        self.assertEqual(max(defects), 0.0)

    def test_a_generator_in_python_gives_the_same(self):
        W0 = SMOOTH.initial
        own = isosyrk.scene(initial=W0, generator=SMOOTH.generator, hamiltonian=SMOOTH.energy)
        self.assertTrue(np.array_equal(ran(own, "group2", 5)[0], ran(SMOOTH, "group2", 5)[0]))
        self.assertEqual(own.energy(W0), SMOOTH.energy(W0))
        self.assertTrue(np.isnan(isosyrk.scene(initial=W0, generator=SMOOTH.generator).energy(W0)))
        with self.assertRaisesRegex(ValueError, "^solver 'fast': not for a generator of your own"):
            isosyrk.integrator(own, "group2", solver="fast")

    def test_a_generator_that_fails_ends_the_step(self):
        def raises(W):
            raise KeyError("mine")

        for generator, error, message in ((raises, KeyError, "mine"), (lambda W: W[:3], ValueError, r"shape \(3, 9\)"),
                                          (lambda W: "B", TypeError, "returned a str"),
                                          (lambda W: 1j * SMOOTH.generator(W), ValueError, r"\|B \+ B†\| is 2 of"),
                                          (lambda W: W * np.nan, isosyrk.SolverError, "diverged at step 1")):
            scene = isosyrk.scene(initial=state(), generator=generator)
            W = scene.initial.copy()
            with self.assertRaisesRegex(error, message):
                isosyrk.integrator(scene, "group2").run(W, 0.1, 3, out=W)
            self.assertTrue(np.array_equal(W, scene.initial))

    def test_a_hamiltonian_that_is_no_number_is_refused(self):
        scene = isosyrk.scene(initial=state(), generator=lambda W: W, hamiltonian=lambda W: 1j)
        with self.assertRaisesRegex(TypeError, "^hamiltonian: its result"):
            scene.energy(scene.initial)

    def test_a_model_that_holds_its_scene_is_freed(self):
        class Model:
            def __init__(self):
                self.scene = isosyrk.scene(initial=state(), generator=self.B)
                self.method = isosyrk.integrator(self.scene, "group1")

            def B(self, W):
                return 0 * W

        model = Model()
        model.method.step(model.scene.initial, 0.1)
        freed = weakref.ref(model)
        del model
        gc.collect()
        self.assertIsNone(freed())

    def test_a_generator_may_keep_its_argument(self):
        kept = []
        ran(isosyrk.scene(initial=state(), generator=lambda W: kept.append(W) or 0 * W), "group1", 2)
        self.assertTrue(all(np.isfinite(W).all() for W in kept))


class Refusals(unittest.TestCase):
    def refused(self, error, message, call, *arguments, **options):
        with self.assertRaises(error) as raised:
            call(*arguments, **options)
        self.assertRegex(str(raised.exception), message)
        self.assertNotIn("\n", str(raised.exception))

    def test_scenes(self):
        W = state()
        # What core refuses in the same words as integrate does is tested there, but for one of each function.
        nearly, broken = W.copy(), W.copy()
        nearly[0, 1] *= 1 + 1e-12
        broken[0, 1] *= 1 + 1e-6
        isosyrk.scene(initial=nearly)  # as skew as what a run leaves
        for error, message, arguments in (
                (ValueError, "^scene: must have a name", dict(n=9)),
                (ValueError, "^scene: n is missing$", dict(name="smooth")),
                (TypeError, "^n: is a float", dict(name="smooth", n=9.0)),
                (ValueError, "^scene: has modes and initial", dict(modes=[(1, 0, 1, 0)], initial=W)),
                (ValueError, "^mode l=9, m=0: l must be", dict(modes=[(9, 0, 1.0, 0.0)], n=9)),
                (ValueError, "^mode 5: must be", dict(modes=[5], n=9)),
                (TypeError, "^re: is a str", dict(modes=[(1, 0, "1", 0.0)], n=9)),
                (ValueError, "dtype is complex256", dict(initial=W.astype(np.clongdouble))),
                (ValueError, "dtype is bool", dict(initial=np.zeros((9, 9), bool))),
                (ValueError, "dtype is object", dict(initial=W.astype(object))),
                (TypeError, "masked", dict(initial=np.ma.array(W))),
                (ValueError, r"shape is \(9, 8\), must be \(n, n\)", dict(initial=W[:, :8])),
                (ValueError, r"shape is \(9, 9\), must be \(8, 8\)", dict(initial=W, n=8)),
                (ValueError, "1e-10", dict(initial=broken)),
                (ValueError, "^hamiltonian: goes with", dict(initial=W, hamiltonian=abs)),
                (TypeError, "^generator: is a int", dict(initial=W, generator=5)),
                (ValueError, "^generator: needs initial", dict(name="smooth", n=9, generator=abs))):
            self.refused(error, message, isosyrk.scene, **arguments)

    def test_integrators(self):
        for error, message, arguments in (
                (ValueError, "^integrator 'group99': must be one of cotangent1", dict(name="group99")),
                (ValueError, "^threads: goes with", dict(name="group2", threads=2)),
                (ValueError, "^without: goes with", dict(name="group2", without=("bands",))),
                (ValueError, "^without 'magic': must be of predictor, newton, bands, explicit_start,",
                 dict(name="group2", solver="fast", without=("magic",))),
                (TypeError, "^tolerance: is a str", dict(name="group2", tolerance="1e-13")),
                (ValueError, "must be printable$", dict(name="a\0b")),
                (ValueError, "^products: goes with", dict(name="group2", solver="fast", products="eigen")),
                (ValueError, "^products 'abacus': must be fastest, openblas or eigen$",
                 dict(name="group2", products="abacus"))):
            self.refused(error, message, isosyrk.integrator, SMOOTH, **arguments)
        self.refused(TypeError, "^scene: is a str", isosyrk.integrator, "smooth", "group2")

    def test_steps(self):
        method = isosyrk.integrator(SMOOTH, "group2")
        W = SMOOTH.initial
        for error, message, arguments in (
                (TypeError, "^h: is a ndarray", (W, np.array("0.1"), 5)),
                (ValueError, "^h: is too large", (W, 10**400, 5)),
                (ValueError, "^h = nan", (W, float("nan"), 5)), (ValueError, "^steps = -1: must be 0 to", (W, 0.1, -1)),
                (ValueError, r"shape is \(8, 8\)", (W[:8, :8], 0.1, 5)), (ValueError, "dtype", ("W", 0.1, 5)),
                (ValueError, "1e-10", (W + np.eye(9), 0.1, 5)), (TypeError, "^observe: is a int", (W, 0.1, 5, 3)),
                (ValueError, "^every = 0", (W, 0.1, 5, None, 0)),
                (TypeError, "^between: is a float, must be a function of step", (W, 0.1, 5, None, 1, None, 0.9)),
                (TypeError, "^progress: is a str, must be True or False", (W, 0.1, 5, None, 1, None, None, "yes"))):
            self.refused(error, message, method.run, *arguments)

    def test_a_step_that_does_not_converge(self):
        scene = isosyrk.scene("rough", n=9)
        W0 = scene.initial.copy()
        method = isosyrk.integrator(scene, "group2", max_sweeps=12)  # enough for the first steps only
        seen = [W0]
        for call, options in ((method.run, {"observe": lambda step, W, report: seen.append(W.copy())}),
                              (method.timed_run, {}), (method.timed_run, {"warmup": 2})):
            with self.assertRaises(isosyrk.SolverError) as raised:
                call(W0, 0.2, 40, **options)
            error = raised.exception
            self.assertEqual((error.step, error.status), (len(seen), "sweep cap"))
            self.assertTrue(np.array_equal(error.W, seen[-1]))
            self.assertGreater(error.last_change, TOLERANCE)
            self.assertTrue(np.array_equal(W0, scene.initial))
            if call == method.run:
                self.assertEqual(error.report.steps, len(seen) - 1)
        self.assertGreater(len(seen), 1)
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.step, again.report), (str(error), error.step, error.report))
        self.assertTrue(np.array_equal(again.W, error.W))

    def test_empty_matrices(self):
        empty = np.zeros((0, 0), complex)
        self.refused(ValueError, r"shape is \(0, 0\)", isosyrk.spectrum, empty)
        one = np.ones((1, 1), complex)
        self.refused(ValueError, "n >= 2", isosyrk.angular_momentum_error, one, one)


class Beside(unittest.TestCase):
    """What goes on beside a run: other threads, signals, NumPy's own arithmetic."""

    def printed(self, code):
        """Returns what Python printed in the end, having said nothing on stderr."""
        done = python(code)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def test_a_second_call_is_refused(self):
        scene = isosyrk.scene("smooth", n=17)
        method = isosyrk.integrator(scene, "group2")
        untouched, _ = method.run(scene.initial, 0.1, 5)
        shared = np.empty_like(untouched)

        def again():
            with self.assertRaisesRegex(RuntimeError, "^integrator: is in use by another call$"):
                method.step(scene.initial, 0.1, out=shared)

        def observe(*_):
            again()
            with concurrent.futures.ThreadPoolExecutor() as pool:
                pool.submit(again).result()

        method.run(scene.initial, 0.1, 5, out=shared, observe=observe)
        self.assertTrue(np.array_equal(shared, untouched))

    def test_an_integrator_is_free_again_after_an_exception(self):
        raising = False

        def generator(W):
            if raising:
                raise KeyError("mine")
            return SMOOTH.generator(W)

        def observe(*_):
            raise KeyError("mine")

        method = isosyrk.integrator(isosyrk.scene(initial=SMOOTH.initial, generator=generator), "group2")
        wanted, _ = method.run(SMOOTH.initial, 0.1, 5)
        for call, options in ((method.run, {}), (method.timed_run, {}), (method.step, {}),
                              (method.run, {"observe": observe})):
            steps = () if call == method.step else (5,)
            raising = not options
            with self.assertRaisesRegex(KeyError, "mine"):
                call(SMOOTH.initial, 0.1, *steps, **options)
            raising = False
            self.assertTrue(np.array_equal(method.run(SMOOTH.initial, 0.1, 5)[0], wanted))

    def turns_beside(self, *calls):
        """Returns how many times this thread had a turn while others made the calls, and the answers."""
        turns = 0
        with concurrent.futures.ThreadPoolExecutor() as pool:
            runs = [pool.submit(*call) for call in calls]
            while concurrent.futures.wait(runs, 0.001).not_done:
                turns += 1
        return turns, [run.result() for run in runs]

    def test_other_threads_go_on_while_one_steps(self):
        scene = isosyrk.scene("smooth", n=33)
        wanted, _ = ran(scene, "group3", 100)
        turns, answers = self.turns_beside(*[(ran, scene, "group3", 100)] * 2)
        self.assertGreater(turns, 3)
        for W, _ in answers:
            self.assertTrue(np.array_equal(W, wanted))

    def test_other_threads_go_on_while_one_is_timed(self):
        scene = isosyrk.scene("smooth", n=33)
        method = isosyrk.integrator(scene, "group3")
        turns, [times] = self.turns_beside((method.timed_run, scene.initial, 0.1, 100, 2))
        self.assertEqual(len(times), 2)
        self.assertGreater(turns, 3)

    def interrupted(self, n, solver, steps):
        """Interrupts a run after half a second; returns what its process printed, the CPU time that it then took, and
        that of a sweep.

        On a busy machine that is not the time that passes; nor is a sweep as long on every processor.
        """
        code = ("import isosyrk, time, numpy as np\n"
                f"scene = isosyrk.scene('rough', n={n})\n"
                f"method = isosyrk.integrator(scene, 'group2', solver='{solver}')\n"
                "W = scene.initial.copy()\n"
                "print('begins', flush=True)\n"
                "try:\n"
                f"    method.run(W, 0.02, {steps}, out=W)\n"
                "except KeyboardInterrupt as error:\n"
                "    seconds = time.process_time()\n"
                "    assert error.W is W and error.report.seconds > 0, error.report\n"
                "    unmoved = np.array_equal(W, scene.initial), error.report.steps == 0\n"
                "    print('ended', seconds, isosyrk.spectrum_error(W, scene.initial), *unmoved, flush=True)\n"
                "    isosyrk.integrator(scene, 'rk4').step(W, 0.001)\n"
                "    print('and works', flush=True)\n"
                "begun = time.process_time()\n"
                "try:\n"
                f"    isosyrk.integrator(scene, 'group2', solver='{solver}', max_sweeps=1).step(scene.initial, 0.02)\n"
                "except isosyrk.SolverError as error:\n"
                "    assert error.report.sweeps > 0\n"
                "    print(time.process_time() - begun)\n")
        process = python(code, start, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual(process.stdout.readline(), "begins\n", process)
        threading.Event().wait(0.5)
        used = cpu_seconds_of(process)
        process.send_signal(signal.SIGINT)
        ended = process.stdout.readline()
        with process:
            works, _, sweep = process.stdout.read().partition("\n")
            self.assertEqual(works, "and works", process.stderr.read())
        _, seconds, *found = ended.split()
        return found, float(seconds) - used, float(sweep)

    def test_ctrl_c_ends_a_run_with_a_whole_state_and_a_step_between_sweeps(self):
        for n, steps, unmoved in ((33, 10**8, "False"), (600, 1, "True")):
            if SANITIZED and steps == 1:
                continue  # a sweep takes long
            for solver in ("published", "fast"):
                with self.subTest(n=n, solver=solver):
                    (error, *found), seconds, sweep = self.interrupted(n, solver, steps)
                    self.assertEqual(found, [unmoved] * 2)
                    self.assertLess(float(error), 1e-8)
                    self.assertLess(seconds, 0.9 + 1.5 * sweep)  # a published step takes 24 of them

    def test_the_interpreter_ends_while_a_daemon_thread_runs(self):
        for solver, observe in (("published", None), ("fast", "lambda *_: None")):
            self.printed("import isosyrk, threading, time\n"
                         "scene = isosyrk.scene('smooth', n=17)\n"
                         f"method = isosyrk.integrator(scene, 'group2', solver='{solver}')\n"
                         f"run = lambda: method.run(scene.initial, 0.1, 10**9, observe={observe})\n"
                         "threading.Thread(target=run, daemon=True).start()\n"
                         "time.sleep(0.3)\n")

    def test_threads_in_a_forked_process_are_refused(self):
        code = ("import isosyrk, os, sys, warnings\n"
                "warnings.simplefilter('ignore', DeprecationWarning)\n"  # Python 3.12 warns of what is tried here
                "scene = isosyrk.scene('smooth', n=65)\n"
                "method = isosyrk.integrator(scene, 'group2', solver='fast', threads=2)\n"
                "PARENT\n"
                "if os.fork() == 0:\n"
                "    try:\n"
                "        method.step(scene.initial, 0.1)\n"
                "        os.write(1, b'done')\n"
                "    except RuntimeError as error:\n"
                "        os.write(1, str(error).encode())\n"
                "    os._exit(0)\n"
                "os.wait()\n")
        for parent, printed in (("", "done"),
                                ("method.step(scene.initial, 0.1)", "threads = 2: hang in a process forked")):
            self.assertTrue(self.printed(code.replace("PARENT", parent)).startswith(printed))

    def test_numpy_is_left_as_it_was(self):
        code = ("import ctypes, ctypes.util\n"
                "blas = ctypes.CDLL('libopenblas.so.0')\n"
                "blas.openblas_set_num_threads(2)\n"
                "import isosyrk, numpy as np\n"
                "scene = isosyrk.scene('smooth', n=17)\n"
                "seen = []\n"
                "for solver in ('published', 'fast'):\n"
                "    isosyrk.integrator(scene, 'group2', solver=solver).run(scene.initial, 0.1, 3,\n"
                "        observe=lambda *_: seen.append(blas.openblas_get_num_threads()))\n"
                "import signal\n"
                "flushed = []\n"
                "signal.signal(signal.SIGALRM, lambda *_: flushed.append(np.float64(2.0)**-1060 / 2 == 0))\n"
                "signal.setitimer(signal.ITIMER_REAL, 0.2)\n"
                "isosyrk.integrator(scene, 'group2', solver='fast').run(scene.initial, 0.1, 30000)\n"
                "assert flushed == [False], flushed\n"
                "least = np.float64(2.0)**-1074\n"
                "print(blas.openblas_get_num_threads(), set(seen), least * 1 > 0, np.float64(2.0)**-1060 / 2 > 0)\n")
        self.assertEqual(self.printed(code), "2 {1} True True\n")


class Package(unittest.TestCase):
    def test_version_is_that_of_the_project_and_of_every_measurement(self):
        with open(os.path.join(ROOT, "CMakeLists.txt"), encoding="utf-8") as file:
            self.assertIn(f"project(isosyrk VERSION {isosyrk.__version__} ", file.read())
        self.assertEqual(isosyrk.conditions()["version"], isosyrk.__version__)

    def test_every_record_says_whether_there_is_a_fast_form(self):
        without = []
        for entry in isosyrk.integrators():
            if entry.has_fast_form:
                isosyrk.integrator(isosyrk.scene("smooth", n=9), entry.name, solver="fast")
            else:
                without.append(entry.name)
        self.assertEqual(without, [name + end for end in ("", "_frame") for name in ("bm1", "bm2", "bm3", "cg4")])
        for name in (*without, "yoshida4_group"):  # the last is a control, which is not listed
            with self.assertRaisesRegex(ValueError, f"^integrator '{name}': has no fast form$"):
                isosyrk.integrator(isosyrk.scene("smooth", n=9), name, solver="fast")

    def test_every_record_says_what_the_integrator_is(self):
        listed = {entry.name: entry for entry in isosyrk.integrators()}
        for name, *expected in (
                ("group2", "group2", "Gauss", "group", False, False, False),
                ("kahan_li6_frame", "kahan_li6", "composition", "algebra", True, False, False),
                ("elp4_frame", "elp4", "exponential Lie–Poisson", None, True, False, True),
                ("rk8_projected_frame", "rk8_projected", "Runge–Kutta", None, True, True, True),
                ("direct1", "direct1", "direct Gauss", None, False, False, False)):
            entry = listed[name]
            self.assertEqual([entry.method, entry.family, entry.formulation, entry.co_rotating, entry.projected,
                              entry.spectrum_at_any_tolerance], expected)
        self.assertEqual({entry.family for entry in listed.values()}, {*FAMILIES})
        for entry in listed.values():  # the frame changes nothing else
            plain = listed[entry.method]
            self.assertEqual(entry._replace(name=plain.name, co_rotating=False), plain)

    def test_the_recorded_list_is_that_of_the_module(self):
        done = run_script(os.path.join(ROOT, "scripts", "update"), "--check", "integrators")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_threads_sleep_after_a_short_spin_unless_told_otherwise(self):
        code = "import isosyrk, os; print(os.environ.get('GOMP_SPINCOUNT'), os.environ.get('OMP_WAIT_POLICY'))"
        for settings, spins, left in (({}, "1500", "None None"), ({"GOMP_SPINCOUNT": "70"}, "70", "70 None"),
                                      ({"OMP_WAIT_POLICY": "passive"}, "0", "None passive")):
            with self.subTest(settings):
                done = python(f"import os; os.environ.update({settings}); {code}", OMP_DISPLAY_ENV="verbose")
                # libgomp tells what it was loaded with; no other has such a setting.
                if "GOMP_SPINCOUNT" not in done.stderr:
                    self.skipTest("this OpenMP is not libgomp")
                self.assertIn(f"GOMP_SPINCOUNT = '{spins}'", done.stderr)
                self.assertEqual(done.stdout, left + "\n")

    def test_stubs_name_what_is_there(self):
        from isosyrk import _conditions, _core
        for extension in (_core, _conditions):
            stub = text_of(ROOT, "core", "python", "isosyrk", f"{extension.__name__.rpartition('.')[2]}.pyi")
            named = set(re.findall(r"^(?:def |class |)(\w+)(?=[(:])", stub, re.M))
            self.assertEqual(named, {name for name in dir(extension) if not name.startswith("_")})

    def test_calls_of_the_readme_make_integrators(self):
        scene = isosyrk.scene("smooth", n=17)
        calls = re.findall(r"\| `(isosyrk\.integrator\(scene, .*?\))` +\|", text_of(ROOT, "README.md"))
        self.assertGreaterEqual(len(calls), 6)
        for call in calls:
            with self.subTest(call=call):
                self.assertIn(f'"{eval(call, {"isosyrk": isosyrk, "scene": scene}).name}"', call)

    def test_examples_of_the_pages_run(self):
        pages = text_of(ROOT, "README.md") + text_of(ROOT, "core", "python", "README.md")
        examples = re.findall(r"^```python\n(.*?)^```", pages, re.M | re.S)
        self.assertEqual(len(examples), 5)
        for example in examples:
            if "quflow" in example:
                continue  # test_quflow.py runs it
            with tempfile.TemporaryDirectory() as folder:
                done = python(f"import matplotlib; matplotlib.use('Agg')\n{example}", timeout=120, cwd=folder)
                self.assertEqual(done.returncode, 0, done.stderr)
