"""Answers of scripts/recommend from the recorded study, executed: each has the error that it promised."""

import math
import os
import shlex
import unittest

import numpy
from programs import DONE, ROOT, SANITIZED, SOLVER_FAILED, FolderTest, program, run, run_script, strict_json

SCRIPT = os.path.join(ROOT, "scripts", "recommend")
SLACK = 1.5  # over the promised error; answers keep margins for interpolation beside
# Scene, n, time, error, what is to be kept. n = 20, 24 and 48 and T = 10 and 20 are interpolated.
QUESTIONS = (
    ("smooth", 17, 5, 1e-4, "nothing"), ("smooth", 17, 5, 1e-8, "poisson"), ("smooth", 17, 50, 1e-4, "poisson"),
    ("smooth", 17, 20, 1e-5, "spectrum"), ("smooth", 24, 5, 1e-6, "poisson"), ("smooth", 33, 5, 1e-6, "nothing"),
    ("smooth", 33, 5, 1e-2, "poisson"), ("smooth", 48, 10, 1e-4, "spectrum"), ("rough", 17, 5, 1e-6, "poisson"),
    ("rough", 33, 5, 1e-4, "nothing"), ("rough", 20, 5, 1e-3, "spectrum"), ("developed", 17, 5, 1e-4, "poisson"))
REFERENCE = {"integrator": "group5", "step": 0.025}  # solves them to far below their errors


class Answers(FolderTest):
    def answer(self, scene, n, time, error, keep):
        done = run_script(SCRIPT, "--scene", scene, "--n", str(n), "--time", str(time), "--error", str(error),
                          "--keep", keep, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return strict_json(done.stdout)

    def state(self, found, integrator, step):
        """Returns the last state of an answer's command line by another integrator and step, or None.

        Another integrator has the default tolerance.
        """
        *before, line = found["command"].split(" && ")  # before it a scene is developed
        words = shlex.split(line)
        if integrator != found["integrator"] and "--tolerance" in words:
            at = words.index("--tolerance")
            del words[at:at + 2]
        for option, value in (("--integrator", integrator), ("--step", repr(step))):
            words[words.index(option) + 1] = value
        for command in (*map(shlex.split, before), [*words, "--output", "W.npy"]):
            done = run([program("integrate"), *command[1:]], timeout=300, cwd=self.folder)
            if done.returncode == SOLVER_FAILED:
                return None
            self.assertEqual(done.returncode, DONE, done.stderr)
        return numpy.load(self.path("W.npy"))

    def test_each_has_the_error_that_it_promised(self):
        for question in QUESTIONS:
            if SANITIZED and question[1] > 33:
                continue
            with self.subTest(question=question):
                found = self.answer(*question)
                exact = self.state(found, **REFERENCE)

                def error(step):
                    W = self.state(found, found["integrator"], step)
                    return math.inf if W is None else numpy.linalg.norm(W - exact) / numpy.linalg.norm(exact)

                self.assertLessEqual(found["expected_error"], question[3])
                self.assertLessEqual(error(found["step"]), SLACK * found["expected_error"])
                # Control: with half as many steps it has not.
                self.assertGreater(error(question[2] / max(1, found["steps"] // 2)), SLACK * found["expected_error"])


if __name__ == "__main__":
    unittest.main()
