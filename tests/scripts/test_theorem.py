"""Tests of the plain formulations, of where the theorem ends, and of its study and report as a user runs them.

Run with: python3 -m unittest test_theorem (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import os
import sys
import unittest

from programs import BUILD, DONE, FORMULATIONS, ROOT, FolderTest, environment, run, run_script

sys.path[:0] = [os.path.join(BUILD, "python"), os.path.join(ROOT, "scripts", "studies")]
import numpy as np

import isosyrk
from lib import plain_forms
from lib import formats
import theorem
from lib.plain_forms import dagger, gauss
from lib.theorem_table import NOTHING, PAIRS, PRINTED_K, PRINTED_W, SCHEMA

RENDER = os.path.join(ROOT, "scripts", "render_theorem")
ROUNDING = 1e-13  # of one step with entries of about 1, and of its iteration
CHANGED = 1e-9  # the least that a change makes: Lobatto methods of order 4 differ by h⁵ times small constants


class PlainForms(unittest.TestCase):
    """The module and plain_forms share nothing: tableaux, iteration and products are written twice."""

    def test_they_equal_the_module_in_every_scene(self):
        self.assertEqual(set(theorem.SMALL), set(isosyrk.scenes()))
        for name, n in theorem.SMALL.items():
            scene = isosyrk.scene(name, n=n)
            W0, J = scene.initial, theorem.J_of(scene)
            h = 0.3 / np.linalg.norm(scene.generator(W0), 2)
            for s in (1, 2, 3):
                with self.subTest(scene=name, s=s):
                    steps = {"cotangent": plain_forms.cotangent(*gauss(s), scene.generator, W0, h),
                             "group": plain_forms.group(*gauss(s), scene.generator, W0, h, J),
                             "algebra": plain_forms.algebra(*gauss(s), scene.generator, W0, h, J)}
                    for form, step in steps.items():
                        W1 = isosyrk.integrator(scene, f"{form}{s}", tolerance=1e-14).step(W0, h)
                        self.assertLess(abs(W1 - step.W1).max(), 1e-12)
                        self.assertLess(theorem.algebra_defect(step.W1, J), ROUNDING)
                        self.assertLess(theorem.casimir_error(step.W1, W0), ROUNDING)
                    for form in ("cotangent", "group"):
                        Q1 = steps[form].Q1
                        self.assertLess(abs(dagger(Q1) @ J @ Q1 - J).max(), ROUNDING)
                    # The structural identity: only pairs j ≤ k need a product.
                    M = steps["algebra"].M
                    self.assertLess(abs(np.swapaxes(M, 0, 1) + np.linalg.inv(J) @ dagger(M) @ J).max(), ROUNDING)
                    # Controls: it moved, and what is printed is something else.
                    self.assertGreater(abs(W1 - W0).max(), 1e-2)
                    self.assertGreater(abs(M).max(), 1e-3)
                    if s > 1:
                        printed = plain_forms.algebra(*gauss(s), scene.generator, W0, h, J, printed=True)
                        self.assertGreater(abs(W1 - printed.W1).max(), 1e-7)

    def test_a_step_without_a_fixed_point_is_an_error(self):
        scene = isosyrk.scene("rigid_body", n=6)
        with self.assertRaisesRegex(ArithmeticError, "does not converge"), np.errstate(all="ignore"):
            plain_forms.cotangent(*gauss(1), scene.generator, scene.initial, 100.0)


class Ends(unittest.TestCase):
    """Each row has one thing changed; the control is that of NOTHING, by the same code."""

    # Which pairs coincide, and which formulations keep the spectrum. IIIB with s = 2 is the midpoint rule.
    EXPECTED = {
        NOTHING: (PAIRS, FORMULATIONS),
        "a tableau that is not symplectic": (("cotangent–group",), ()),
        "a partitioned pair on T*G": ((), ("cotangent",)),
        "IIIA–IIIB, IIIB, s = 2": (("group–algebra",), FORMULATIONS),
        "J² no multiple of I": (("cotangent–algebra",), ("cotangent", "algebra")),
        "B outside g": ((), ("cotangent",)),
        PRINTED_K: (("cotangent–group",), ("cotangent", "group")),
        PRINTED_W: (("cotangent–algebra",), ("cotangent", "algebra"))}

    def test_what_coincides_and_what_keeps_the_spectrum(self):
        rows = theorem.ends()
        self.assertEqual(len({row.case for row in rows}), len(rows))
        self.assertLess(set(self.EXPECTED), {name for row in rows for name in (row.changed, row.case)})
        for row in rows:
            pairs, kept = self.EXPECTED.get(row.case, self.EXPECTED[row.changed])
            for names, values, zero in ((PAIRS, row.differences, pairs), (FORMULATIONS, row.casimir_errors, kept)):
                for name, value in zip(names, values):
                    with self.subTest(case=row.case, name=name):
                        (self.assertLess if name in zero else self.assertGreater)(
                            value, ROUNDING if name in zero else CHANGED)
            if row.order:
                expected = 3 if row.changed == PRINTED_K else 2 * row.stages
                self.assertAlmostEqual(row.order, expected, delta=0.1)
        self.assertEqual([bool(row.order) for row in rows if row.changed in (NOTHING, PRINTED_K)], [True] * 4)

    def test_the_printed_index_of_K_lets_the_spectrum_drift(self):
        scene = isosyrk.scene("smooth", n=9)
        errors = {}
        for printed in (False, True):
            W = scene.initial
            for steps in (5, 10):
                for _ in range(5):
                    W = plain_forms.algebra(*gauss(2), scene.generator, W, 0.3, np.eye(9), printed).W1
                errors[printed, steps] = theorem.casimir_error(W, scene.initial)
        self.assertLess(errors[False, 10], 1e-12)
        self.assertGreater(errors[True, 10], 1.5 * errors[True, 5])


class Study(FolderTest):
    ARGUMENTS = ("--quick", "--n", "9", "17", "--repetitions", "1", "--integrator", "group2", "algebra2", "yoshida4",
                 "--scene", "rigid_body", "spin_chain")

    def script(self, *arguments):
        return run([sys.executable, "-B", os.path.join(ROOT, "scripts", "studies", "theorem.py"), *arguments],
                   env=environment(ISOSYRK_BUILD=BUILD))

    def test_it_runs_and_is_rendered(self):
        path = self.path("raw.json")
        done = self.script("--out", path, *self.ARGUMENTS)
        self.assertEqual((done.returncode, done.stdout, os.listdir(self.folder)), (DONE, "", ["raw.json"]), done.stderr)
        tables = formats.read_study(path, SCHEMA).tables
        self.assertEqual({(row.scene, row.n, row.method, row.formulation) for row in tables["cost"]}, {
            (scene, n, "s = 2", form) for scene, n in (("rigid_body", 9), ("rigid_body", 17), ("spin_chain", 64),
                                                       ("spin_chain", 128)) for form in ("group", "algebra")})
        self.assertEqual({row.formulation for row in tables["dirk"]}, set(FORMULATIONS))
        for row in (*tables["cost"], *tables["dirk"]):
            self.assertLess(row.difference, 1e-11)
        for row in tables["coincidence"]:
            self.assertLess(row.difference, row.bound)
        failed = [(row.scene, row.stages, row.h_norm_B) for row in tables["coincidence"] if None in row.sweeps]
        self.assertEqual((len(tables["coincidence"]), failed), (18, [("spin_chain", 1, 0.6)]))
        for format in ("text", "markdown", "latex"):
            shown = run_script(RENDER, path, "--format", format)
            self.assertEqual((shown.returncode, shown.stderr), (DONE, ""))
            for part in ("in 18 of 18 settings", "algebra of spin", "from N = 32 to 64", "ISOSYRK, K",
                         "a tableau that is not symplectic:"):
                self.assertIn(part, " ".join(shown.stdout.replace("\\", "").split()))

    def test_bad_arguments_and_foreign_files(self):
        for arguments, *parts in ((("--scene", "calm"), "'calm'", "spin_chain"), (("--n", "4"), "--n", "5 to 513"),
                                  (("--integrator", "rk4"), "--integrator 'rk4'", "kahan_li6"),
                                  (("--repetitions", "0"), "--repetitions"), (("--out", self.folder), "--out")):
            with self.subTest(arguments=arguments):
                self.assert_refused(self.script("--out", self.path("raw.json"), *arguments), *parts)
        self.assertEqual(os.listdir(self.folder), [])
        scaling = os.path.join(ROOT, "results", "recorded", "scaling", "raw.json")
        self.assert_refused(run_script(RENDER, scaling), "scaling/raw.json", "is no raw file of the study theorem")
        self.assert_refused(run_script(RENDER, self.path("none.json")), "none.json", "cannot be read")


if __name__ == "__main__":
    unittest.main()
