"""Tests of the scenes beside Euler-Zeitlin, in integrate and in the NumPy module.

Run with: python3 -m unittest test_scenes (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import os
import sys
import unittest

from programs import BUILD, DONE, FolderTest, program, run, strict_json

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np

import isosyrk

# Each scene with arguments of its own; those of integrate are these with two dashes.
SCENES = {"euler_top": {"n": 3}, "rigid_body": {"n": 8}, "spin_chain": {"n": 10}, "symplectic": {"n": 6},
          "pseudo_unitary": {"n": 5, "signature": (3, 2)}}
METHOD = ("--stages", "2", "--formulation", "group", "--step", "0.1")
REFUSED = {  # arguments of integrate: what the line names
    "--scene euler_top --n 4": "euler_top has n = 3",
    "--scene rigid_body --n 2": "n >= 3",
    "--scene spin_chain --n 7": "n = 2 N",
    "--scene symplectic --n 5": "even n",
    "--scene pseudo_unitary --n 8 --signature 5,4": "P + Q = n = 8",
    "--scene pseudo_unitary --n 8 --signature 8,0": "--signature 0: out of range",
    "--scene pseudo_unitary --n 8 --signature 5": "must be P,Q",
    "--scene pseudo_unitary --n 8 --signature 5,3,1": "--signature '3,1'",
    "--scene rigid_body --n 8 --signature 5,3": "goes with pseudo_unitary",
    "--n 8 --signature 5,3": "goes with pseudo_unitary",
    "--scene rigid_body --n 8 --hbar paper": "--hbar paper: goes with Euler-Zeitlin",
    "--scene rigid_body --n 8 --modes none.csv": "--modes none.csv: goes with Euler-Zeitlin",
    "--scene calm --n 8": "smooth, rough, euler_top, rigid_body, spin_chain, symplectic, pseudo_unitary",
    "--scene rigid_body --n 8 --solver fast": "no generator in split storage",
}


def arguments(name):
    line = ["--scene", name]
    for option, value in SCENES[name].items():
        line += [f"--{option}", ",".join(map(str, value)) if isinstance(value, tuple) else str(value)]
    return line


class Integrate(FolderTest):
    def integrate(self, *line):
        return run([program("integrate"), *METHOD, *line])

    def test_each_runs_and_goes_on_from_its_own_output(self):
        for name in SCENES:
            with self.subTest(name):
                whole, half, end = (self.path(f"{name}_{part}.npy") for part in ("whole", "half", "end"))
                answer = self.integrate(*arguments(name), "--time", "4", "--output", whole, "--json")
                self.assertEqual((answer.returncode, answer.stderr), (DONE, ""))
                result = strict_json(answer.stdout)
                self.assertEqual((result["scene"], result["converged"], result["hbar"]), (name, True, None))
                for error in ("spectrum_error", "skew_defect"):
                    self.assertLess(result[error], 1e-11)
                self.assertLess(result["energy_error"], 1e-5)
                for initial, output in ((None, half), (half, end)):
                    start = ("--initial", initial) if initial else ()
                    answer = self.integrate(*arguments(name), *start, "--time", "2", "--output", output)
                    self.assertEqual((answer.returncode, answer.stderr), (DONE, ""))
                np.testing.assert_allclose(np.load(end), np.load(whole), atol=1e-12)

    def test_bad_arguments_are_refused_with_one_line(self):
        for line, part in REFUSED.items():
            with self.subTest(line), self.unchanged():
                self.assert_refused(self.integrate(*line.split(), "--time", "1", "--output", self.path("W.npy")), part)

    def test_initial_data_outside_the_algebra_are_refused_with_the_figure(self):
        for name, wrong, part in (("rigid_body", 1j * np.eye(8), "must be real"),
                                  ("spin_chain", np.fliplr(np.eye(10)) * 1j, "outside the diagonal blocks of size 2"),
                                  ("symplectic", np.eye(6), "W†J + JW"),
                                  ("pseudo_unitary", np.ones((5, 5)), "W†J + JW")):
            with self.subTest(name):
                path = self.path("W.npy")
                np.save(path, wrong.astype(complex))
                with self.unchanged():
                    self.assert_refused(self.integrate(*arguments(name), "--time", "1", "--initial", path), path, part)


class Module(unittest.TestCase):
    def test_each_runs_as_integrate_does_and_stays_as_it_is(self):
        self.assertEqual(isosyrk.scenes(), ["smooth", "rough", *SCENES])
        for name, parameters in SCENES.items():
            with self.subTest(name):
                scene = isosyrk.scene(name, **parameters)
                method = isosyrk.integrator(scene, "algebra2")
                W, report = method.run(scene.initial, 0.1, 20)
                answer = strict_json(run([program("integrate"), *METHOD, *arguments(name), "--time", "2",
                                          "--json"]).stdout)
                self.assertEqual(scene.hbar, None)
                self.assertEqual(report.steps, answer["steps"])
                self.assertLess(abs(scene.energy(W) / scene.energy(scene.initial) - 1), 1e-5)
                again = isosyrk.scene(name, initial=W, **parameters)
                np.testing.assert_array_equal(again.initial, W)
                np.testing.assert_array_equal(W[scene.initial == 0], 0)  # blocks stay blocks
                if not np.any(scene.initial.imag):
                    np.testing.assert_array_equal(W.imag, 0)  # real stays exactly real
                np.testing.assert_allclose(method.step(W, -0.1), method.run(scene.initial, 0.1, 19)[0], atol=1e-12)

    def test_bad_values_are_refused(self):
        body = isosyrk.scene("rigid_body", n=4)
        chain = isosyrk.scene("spin_chain", n=6)
        for call, part in (
                (lambda: isosyrk.scene("rigid_body"), "n is missing"),
                (lambda: isosyrk.scene("rigid_body", n=4, hbar="paper"), "hbar: goes with Euler-Zeitlin"),
                (lambda: isosyrk.scene("rigid_body", n=4, modes=[(1, 0, 1, 0)]), "modes: go with Euler-Zeitlin"),
                (lambda: isosyrk.scene("rigid_body", n=4, signature=(2, 2)), "goes with pseudo_unitary"),
                (lambda: isosyrk.scene("smooth", n=9, signature=(5, 4)), "goes with pseudo_unitary"),
                (lambda: isosyrk.scene(initial=body.initial, signature=(2, 2)), "goes with the scene pseudo_unitary"),
                (lambda: isosyrk.scene("pseudo_unitary", n=4, signature=(4, 1)), "P + Q = n = 4"),
                (lambda: isosyrk.scene("pseudo_unitary", n=4, signature=3), "must be (p, q)"),
                (lambda: isosyrk.scene("euler_top", n=4), "n = 3"),
                (lambda: isosyrk.scene("rigid_body", initial=1j * np.eye(4)), "must be real"),
                (lambda: isosyrk.scene("rigid_body", n=5, initial=body.initial), "shape is (4, 4)"),
                (lambda: isosyrk.integrator(body, "group2", solver="fast"), "no generator in split storage"),
                (lambda: isosyrk.integrator(body, "group2_frame"), "for Euler-Zeitlin only"),
                (lambda: isosyrk.integrator(body, "group2").step(1j * np.eye(4), 0.1), "must be real"),
                (lambda: isosyrk.integrator(chain, "group2").step(1j * np.fliplr(np.eye(6)), 0.1),
                 "outside the diagonal"),
                (lambda: body.generator_norms(co_rotating=True), "for Euler-Zeitlin only"),
                (lambda: isosyrk.scene("symplectic", n=4).generator_norms(), "J = I only")):
            with self.subTest(part), self.assertRaises(ValueError) as caught:
                call()
            self.assertIn(part, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))

    def test_a_sweep_of_the_chain_costs_as_many_products_of_blocks_as_there_are_spins(self):
        scenes = [isosyrk.scene("spin_chain", n=n) for n in (256, 1024)]
        methods = [isosyrk.integrator(scene, "group1") for scene in scenes]
        # In turns, and the least of many: what others do on this machine comes to both, and is in neither.
        times = [[method.timed_run(scene.initial, 0.1, 20, repetitions=1)[0] for method, scene in zip(methods, scenes)]
                 for _ in range(12)]
        small, large = map(min, zip(*times))
        self.assertLess(large / small, 24)  # O(N): 4; dense products: 64


if __name__ == "__main__":
    unittest.main()
