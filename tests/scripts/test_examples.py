"""Tests of core/python/examples: a long run that is killed goes on to the same bits, and noise keeps the spectrum."""

import os
import re
import signal
import sys
import time
import unittest

from programs import BUILD, HAS_MODULE, ROOT, FolderTest, end, environment, run, start

if HAS_MODULE:
    sys.path.insert(0, os.path.join(BUILD, "python"))
    import isosyrk
    import numpy

EXAMPLES = os.path.join(ROOT, "core", "python", "examples")
ENVIRONMENT = environment(PYTHONPATH=os.path.join(BUILD, "python"))


def has_matplotlib():
    return run([sys.executable, "-c", "import matplotlib"]).returncode == 0


@unittest.skipUnless(HAS_MODULE and has_matplotlib(), "needs the module and matplotlib")
class Examples(FolderTest):
    def command(self, folder, length):
        return [sys.executable, os.path.join(EXAMPLES, "turbulence.py"), self.path(folder), "17", str(length)]

    def states(self, folder):
        names = os.listdir(self.path(folder)) if os.path.isdir(self.path(folder)) else []
        return {name: numpy.load(self.path(folder, name)) for name in sorted(names) if name.startswith("W")}

    def ran(self, folder, length):
        done = run(self.command(folder, length), env=ENVIRONMENT, timeout=100)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLessEqual({"vorticity.png", "spectrum.png"}, set(os.listdir(self.path(folder))))
        return self.states(folder)

    def test_a_run_that_was_killed_goes_on_to_the_same_states(self):
        whole = self.ran("whole", 4000)
        self.assertEqual(len(whole), 100)
        killed = start(self.command("killed", 4000), env=ENVIRONMENT)
        try:
            while len(self.states("killed")) < 3:
                self.assertIsNone(killed.poll())
                time.sleep(0.01)
            killed.send_signal(signal.SIGKILL)
            killed.wait()
        finally:
            end(killed)
        self.assertLess(len(self.states("killed")), len(whole))
        again = self.ran("killed", 4000)
        self.assertEqual(list(again), list(whole))
        for name, W in whole.items():
            numpy.testing.assert_array_equal(again[name], W)
        first, *_, last = whole.values()
        self.assertGreater(isosyrk.relative_error(last, first), 0.1)  # the control: they are not all alike

    def test_conjugation_keeps_the_spectrum_and_moves_the_energy(self):
        done = run([sys.executable, os.path.join(EXAMPLES, "conserving_noise.py")], env=ENVIRONMENT, timeout=100)
        spectrum, energy = re.fullmatch(r"spectrum error (\S+), energy by (\S+)\n", done.stdout).groups()
        self.assertLess(float(spectrum), 1e-12)
        self.assertGreater(abs(float(energy)), 1e-3)  # the control: it is no noise that does nothing


if __name__ == "__main__":
    unittest.main()
