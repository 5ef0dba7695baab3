"""Tests that scenes and integrators pickle and copy, and go to other processes.

Run with: python3 -m unittest test_pickling (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import copy
import os
import pickle
import subprocess
import sys
import tempfile
import unittest

from programs import BUILD, environment

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np

import isosyrk

SMOOTH = isosyrk.scene("smooth", n=9)
FREQUENCIES = np.linspace(0.5, 2.0, 9)
COPIES = {"pickle": lambda it: pickle.loads(pickle.dumps(it)), "deepcopy": copy.deepcopy, "copy": copy.copy}


def own_generator(W):
    return W / (FREQUENCIES[:, None] + FREQUENCIES)


def own_hamiltonian(W):
    return 0.5 * np.vdot(W, own_generator(W)).real


def turned(W):
    """Returns a state of the same algebra that is not the scene's own."""
    return isosyrk.integrator(SMOOTH, "algebra1").step(W, 0.5)


def scenes():
    modes = [(1, 0, 0.3, 0.0), (2, 1, 0.2, -0.1), (3, 3, 0.1, 0.4)]
    body = isosyrk.scene("rigid_body", n=5)
    return {
        "named": SMOOTH,
        "standard": isosyrk.scene("rough", n=9, hbar="standard"),
        "modes": isosyrk.scene(modes=iter(modes), n=9),
        "labelled modes": isosyrk.scene("mine", modes=modes, n=9, hbar="standard"),
        "initial": isosyrk.scene(initial=7.0 * turned(SMOOTH.initial), hbar="standard"),
        "labelled initial": isosyrk.scene("mine", initial=turned(SMOOTH.initial)),
        "spin chain": isosyrk.scene("spin_chain", n=8),
        "body, initial": isosyrk.scene("rigid_body", initial=2 * body.initial),
        "signature": isosyrk.scene("pseudo_unitary", n=5, signature=(3, 2)),
        "own": isosyrk.scene(initial=SMOOTH.initial, generator=own_generator, hamiltonian=own_hamiltonian),
        "own, no energy": isosyrk.scene("mine", initial=SMOOTH.initial, generator=own_generator),
    }


class Copies(unittest.TestCase):
    def test_scenes(self):
        for what, scene in scenes().items():
            for how, copied in COPIES.items():
                with self.subTest(scene=what, how=how):
                    again = copied(scene)
                    for field in ("name", "n", "time", "hbar", "modes_hash"):
                        self.assertEqual(getattr(again, field), getattr(scene, field), field)
                    self.assertTrue(np.array_equal(again.initial, scene.initial))
                    W = scene.initial
                    self.assertTrue(np.array_equal(again.generator(W), scene.generator(W)))
                    np.testing.assert_equal(again.energy(W), scene.energy(W))
                    self.assertTrue(np.array_equal(copied(again).initial, scene.initial))

    def test_integrators_have_their_options_and_no_past_steps(self):
        cases = [("named", "group2", dict(solver="fast", tolerance=1e-9, threads=2, without=("bands",))),
                 ("initial", "elp6_frame", dict(solver="fast", tolerance=1e-8)),
                 ("modes", "group2_frame", dict(max_sweeps=77, products="eigen")),
                 ("signature", "algebra2", dict(tolerance=1e-11)), ("own", "elp4", {})]
        made = scenes()
        for what, name, options in cases:
            for how, copied in COPIES.items():
                with self.subTest(name=name, how=how):
                    method = isosyrk.integrator(made[what], name, **options)
                    W = method.scene.initial
                    wanted, report = method.run(W, 0.05, 6)
                    again = copied(method)  # after a run, which leaves nothing in the copy
                    self.assertEqual((repr(again), again.threads), (repr(method), method.threads))
                    found, again_report = again.run(W, 0.05, 6)
                    self.assertTrue(np.array_equal(found, wanted))
                    self.assertEqual(again_report[:5], report[:5])
        # The control: options tell.
        loose = isosyrk.integrator(SMOOTH, "group2", tolerance=1e-5)
        tight = isosyrk.integrator(SMOOTH, "group2")
        runs = [each.run(SMOOTH.initial, 0.1, 6)[1].sweeps for each in (loose, copy.deepcopy(loose), tight)]
        self.assertEqual(runs[0], runs[1])
        self.assertLess(runs[0], runs[2])

    def test_one_scene_stays_one(self):
        scene, method = pickle.loads(pickle.dumps((SMOOTH, isosyrk.integrator(SMOOTH, "rk4"))))
        self.assertIs(method.scene, scene)

    def test_a_max_sweeps_that_ends_a_run_ends_that_of_the_copy(self):
        method = copy.deepcopy(isosyrk.integrator(SMOOTH, "group2", max_sweeps=2))
        with self.assertRaisesRegex(isosyrk.SolverError, "sweep cap at step 1"):
            method.step(SMOOTH.initial, 0.5)

    def test_a_generator_that_does_not_pickle_is_named_in_one_line(self):
        def inner(W):
            return own_generator(W)

        for generator in (inner, lambda W: own_generator(W)):
            scene = isosyrk.scene(initial=SMOOTH.initial, generator=generator)
            for it in (scene, isosyrk.integrator(scene, "group2")):
                with self.assertRaisesRegex((pickle.PicklingError, AttributeError),
                                            generator.__name__.strip("<>")) as raised:
                    pickle.dumps(it)
                self.assertNotIn("\n", str(raised.exception))
                copy.deepcopy(it)  # which functions survive

    def test_a_model_that_holds_its_scene_copies(self):
        again = pickle.loads(pickle.dumps(Model()))
        self.assertIs(again.scene._generator.__self__, again)
        again = copy.deepcopy(again)
        self.assertIs(again.scene._generator.__self__, again)


class Model:
    def __init__(self):
        self.scene = isosyrk.scene(initial=SMOOTH.initial, generator=self.B)

    def B(self, W):
        return own_generator(W)


class OtherProcesses(unittest.TestCase):
    def test_a_pool_by_spawn_runs_them(self):
        code = ("import isosyrk, multiprocessing, numpy as np\n"
                "def ended(method):\n"
                "    return method.run(method.scene.initial, 0.1, 5)[0]\n"
                "def B(W):\n"
                "    return W / np.arange(1, 1 + len(W))[:, None] + W / np.arange(1, 1 + len(W))\n"
                "if __name__ == '__main__':\n"
                "    smooth = isosyrk.scene('smooth', n=17)\n"
                "    methods = [isosyrk.integrator(smooth, 'group2', solver='fast', threads=2),\n"
                "               isosyrk.integrator(isosyrk.scene(initial=smooth.initial), 'elp4_frame'),\n"
                "               isosyrk.integrator(isosyrk.scene(initial=smooth.initial, generator=B), 'algebra1')]\n"
                "    wanted = [ended(method) for method in methods]\n"
                "    with multiprocessing.get_context('spawn').Pool(2) as pool:\n"
                "        for found, each in zip(pool.map(ended, methods), wanted):\n"
                "            print(np.array_equal(found, each))\n")
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "pool.py")
            with open(path, "w", encoding="utf-8") as file:
                file.write(code)
            done = subprocess.run([sys.executable, path], env=environment(PYTHONPATH=os.path.join(BUILD, "python")),
                                  capture_output=True, text=True, timeout=180, check=False)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "True\n" * 3, ""))
