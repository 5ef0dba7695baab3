"""Tests of benchmarks/octave: its answers are those of the published forms in C++; bad input is told in one line."""

import json
import os
import shutil
import sys
import unittest

from programs import BUILD, ROOT, FolderTest, environment, run

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np

import isosyrk
from studies.claims import octave_cells
from lib.programs.command_line import Stop

OCTAVE = shutil.which("octave-cli")
FOLDER = os.path.join(ROOT, "benchmarks", "octave")
CELLS = [f"{form}{s}" for form in ("cotangent", "group", "algebra") for s in (1, 2, 3)]
STEP, STEPS = 0.1, 20
EQUAL = 4e-12  # largest entry of a difference; both are within some 20 tolerances of 1e-13 of the exact step


def products_of_a_sweep(cell):
    s = int(cell[-1])
    return s * (s + 1) if cell.startswith("algebra") else 3 * s


@unittest.skipUnless(OCTAVE, "needs GNU Octave")
class Octave(FolderTest):
    N = 9

    def setUp(self):
        super().setUp()
        self.scene = isosyrk.scene("smooth", n=self.N)
        self.initial = self.path("initial.npy")
        np.save(self.initial, self.scene.initial)

    def run_cells(self, *arguments, folder=FOLDER):
        return run([OCTAVE, "-qf", os.path.join(folder, "run_cells.m"), *arguments],
                   env=environment(OPENBLAS_NUM_THREADS="1"))

    def cells(self, names, folder=FOLDER, hbar="paper"):
        """Returns what Octave printed of some cells, and their W at the end, by cell."""
        done = self.run_cells(self.initial, hbar, repr(STEP), str(STEPS), "1", self.folder, *names, folder=folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout), {name: np.load(self.path(f"{name}.npy")) for name in names}

    def difference(self, scene, name, W):
        ours, report = isosyrk.integrator(scene, name).run(scene.initial, STEP, STEPS)
        return abs(W - ours).max(), report

    def test_answers_sweeps_and_products_are_those_of_the_published_forms(self):
        found, ends = self.cells(CELLS)
        self.assertEqual([cell["cell"] for cell in found["cells"]], CELLS)
        for cell in found["cells"]:
            with self.subTest(cell=cell["cell"]):
                difference, report = self.difference(self.scene, cell["cell"], ends[cell["cell"]])
                self.assertLess(difference, EQUAL)
                # Octave's products may round otherwise, which ends a step a sweep sooner or later where its last change
                # lies near the tolerance: in some steps, not in all. One sweep more in every step is seen.
                self.assertLess(abs(cell["sweeps"] - report.sweeps), STEPS)
                self.assertEqual(cell["products"] - report.products,
                                 products_of_a_sweep(cell["cell"]) * (cell["sweeps"] - report.sweeps))
                self.assertEqual(cell["status"], "converged")
                self.assertGreater(cell["seconds"], 0)
        self.assertGreater(found["product_seconds"], 0)

    def test_other_hbar_and_other_scale(self):
        scene = isosyrk.scene("smooth", n=self.N, hbar="standard")
        _, ends = self.cells(["group2"], hbar="standard")
        self.assertLess(self.difference(scene, "group2", ends["group2"])[0], EQUAL)
        self.assertGreater(self.difference(self.scene, "group2", ends["group2"])[0], 1e3 * EQUAL)  # so it can fail
        large = isosyrk.scene(initial=8.0 * self.scene.initial)
        np.save(self.initial, large.initial)
        found, ends = self.cells(["algebra2"])
        difference, report = self.difference(large, "algebra2", ends["algebra2"])
        self.assertLess(difference, 8 * EQUAL)
        self.assertLess(abs(found["cells"][0]["sweeps"] - report.sweeps), STEPS)

    def test_a_wrong_formula_is_seen(self):
        for file, right, wrong, cell in (
                ("algebra.m", "B{j}*K_sum", "B{i}*K_sum", "algebra2"),  # as the paper prints it
                ("poisson_solve.m", " - mean(f(main))", "", "group1"),
                ("gauss_tableau.m", "r3/6, 1/4]", "r3/6, 0.2500001]", "cotangent2")):
            with self.subTest(file=file):
                copy = self.path(f"copy of {file}")
                shutil.copytree(FOLDER, copy)
                path = os.path.join(copy, file)
                with open(path, encoding="utf-8") as stream:
                    text = stream.read()
                self.assertEqual(text.count(right), 1)
                with open(path, "w", encoding="utf-8") as stream:
                    stream.write(text.replace(right, wrong))
                _, ends = self.cells([cell], folder=copy)
                self.assertGreater(self.difference(self.scene, cell, ends[cell])[0], 1e2 * EQUAL)

    def test_bad_arguments_are_told_in_one_line(self):
        good = [self.initial, "paper", "0.1", "5", "1", "-", "group2"]
        garbage = self.write("garbage.npy", "no NumPy file")
        for place, value, *parts in ((0, self.path("none.npy"), "none.npy"), (0, garbage, "garbage.npy", "NumPy"),
                                     (1, "planck", "planck", "standard"), (2, "-1", "STEP"), (3, "2.5", "STEPS"),
                                     (5, self.path("nowhere"), "nowhere", "written"),
                                     (6, "group4", "group4", "cotangent")):
            with self.subTest(value=value):
                done = self.run_cells(*good[:place], value, *good[place + 1:])
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                line, = [each for each in done.stderr.splitlines() if "while preparing to exit" not in each]
                self.assertTrue(line.startswith("run_cells: "), line)
                for part in parts:
                    self.assertIn(part, line)
        self.assertEqual(self.run_cells().returncode, 2)

    def test_a_run_that_does_not_converge_is_no_time(self):
        done = self.run_cells(self.initial, "paper", "50", "2", "1", self.folder, "group1")
        self.assertEqual(done.returncode, 3)
        cell, = json.loads(done.stdout)["cells"]
        self.assertEqual((cell["status"] in ("diverged", "stagnated"), cell["failed_step"]), (True, 1))
        self.assertFalse(os.path.exists(self.path("group1.npy")))
        with self.assertRaisesRegex(Stop, "exit status 3.*group1 .* at step 1"):
            octave_cells.run(self.initial, ["group1"], 50.0, 2)

    def test_cells_from_python(self):
        found = octave_cells.run(self.initial, ["group1", "algebra1"], STEP, 5)
        self.assertEqual([cell["cell"] for cell in found["cells"]], ["group1", "algebra1"])
        with self.assertRaisesRegex(Stop, "none.npy: cannot be read"):
            octave_cells.run(self.path("none.npy"), ["group1"], STEP, 5)


class Kernels(unittest.TestCase):
    def test_kernels_of_what_octave_says_of_its_library(self):
        config = "OpenBLAS (config: OpenBLAS 0.3.21 NO_LAPACKE DYNAMIC_ARCH NO_AFFINITY {} MAX_THREADS=64)"
        for name in ("Cooperlake", "SkylakeX", "Zen", "Haswell"):
            self.assertEqual(octave_cells.kernels(config.format(name)), name)
        self.assertIsNone(octave_cells.kernels("unknown or reference"))


if __name__ == "__main__":
    unittest.main()
