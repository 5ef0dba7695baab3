"""Tests of the NumPy module: what a run counts, when it ends, where a timed one begins, which generators are linear.

Run with: python3 -m unittest test_module_runs (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import os
import sys
import time
import unittest

from programs import BUILD

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np

import isosyrk

SMOOTH = isosyrk.scene("smooth", n=9)


def works(seconds):
    """Spends CPU time."""
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


class Counted(unittest.TestCase):
    def test_seconds_are_without_observe_and_between(self):
        method = isosyrk.integrator(SMOOTH, "group2", solver="fast")
        method.run(SMOOTH.initial, 0.1, 10)
        for calls in (dict(observe=lambda *_: works(0.05)), dict(between=lambda *_: works(0.05))):
            seconds = []
            calls_and_look = dict(calls)
            if "observe" in calls:
                def look(step, W, report):
                    works(0.05)
                    seconds.append(report.seconds)

                calls_and_look["observe"] = look
            _, report = method.run(SMOOTH.initial, 0.1, 10, **calls_and_look)
            # Half a second of theirs; ten steps of n = 9 take milliseconds.
            for found in (report.seconds, *seconds):
                self.assertLess(found, 0.25, calls)
                self.assertGreater(found, 0.0)

    def test_seconds_of_a_run_that_fails_are_too(self):
        def observe(step, W, report):
            works(0.3)
            raise KeyError("mine")

        for calls in (dict(observe=observe), dict(between=lambda step, W: observe(step, W, None))):
            with self.assertRaises(KeyError) as raised:
                isosyrk.integrator(SMOOTH, "group2", solver="fast").run(SMOOTH.initial, 0.1, 10, **calls)
            self.assertLess(raised.exception.report.seconds, 0.15)

    def test_a_generator_of_ones_own_counts(self):
        def generator(W):
            works(0.02)
            return 0 * W

        scene = isosyrk.scene(initial=SMOOTH.initial, generator=generator)
        self.assertGreater(isosyrk.integrator(scene, "rk4").run(scene.initial, 0.1, 2)[1].seconds, 8 * 0.02 * 0.9)


class Ends(unittest.TestCase):
    def test_only_True_ends_a_run(self):
        for answer, steps in ((1, 9), ("stop", 9), (np.int64(1), 9), (None, 9), (False, 9), (np.False_, 9), (0.0, 9),
                              (np.ones((2, 2)), 9), (True, 1), (np.True_, 1)):
            with self.subTest(answer=answer):
                for solver in isosyrk.SOLVERS:
                    method = isosyrk.integrator(SMOOTH, "group2", solver=solver)
                    self.assertEqual(method.run(SMOOTH.initial, 0.1, 9, observe=lambda *_: answer)[1].steps, steps)


class Timed(unittest.TestCase):
    def test_each_repetition_begins_with_W(self):
        seen = []

        def generator(W):
            seen.append(W)
            return SMOOTH.generator(W)

        scene = isosyrk.scene(initial=SMOOTH.initial, generator=generator)
        method = isosyrk.integrator(scene, "rk4")
        W = isosyrk.integrator(SMOOTH, "rk4").step(SMOOTH.initial, 0.3)
        for warmup in (0, 2):
            seen.clear()
            method.timed_run(W, 0.1, 3, repetitions=4, warmup=warmup)
            each = 4 * (3 + warmup)  # evaluations of B in a repetition, of which the first is at its beginning
            self.assertEqual(len(seen), 4 * each)
            for k in range(0, len(seen), each):
                np.testing.assert_allclose(seen[k], W, atol=1e-15)
            self.assertGreater(np.abs(seen[each - 1] - W).max(), 1e-3)  # the control: a repetition moves


class Linear(unittest.TestCase):
    """elp4 and elp6 take generators that are linear and self-adjoint."""

    def test_a_generator_that_is_self_adjoint_on_matrices_of_one_norm_alone_is_refused(self):
        # |W| B(W) passes tr(A B(C)) = tr(B(A) C) where A and C have the same norm.
        others = {"norm": lambda W: np.linalg.norm(W) * SMOOTH.generator(W),
                  "square of the norm": lambda W: np.linalg.norm(W)**2 * SMOOTH.generator(W),
                  "largest entry": lambda W: np.abs(W).max() * SMOOTH.generator(W)}
        for what, generator in others.items():
            scene = isosyrk.scene(initial=SMOOTH.initial, generator=generator)
            for name in ("elp4", "elp6"):
                with self.subTest(what, name=name), self.assertRaisesRegex(
                        ValueError, f"^{name}: B of this flow is not known to be linear"):
                    isosyrk.integrator(scene, name)
            isosyrk.integrator(scene, "elp2")

    def test_at_any_norm_of_W(self):
        for factor in (1e-300, 1e-160, 1.0, 1e155, 1e300):
            for generator, is_linear in ((SMOOTH.generator, True), (lambda W: 1j * np.abs(W), False)):
                with self.subTest(factor=factor, linear=is_linear):
                    scene = isosyrk.scene(initial=factor * SMOOTH.initial, generator=generator)
                    if is_linear:
                        isosyrk.integrator(scene, "elp4")
                    else:
                        with self.assertRaisesRegex(ValueError, "^elp4: B of this flow"):
                            isosyrk.integrator(scene, "elp4")
