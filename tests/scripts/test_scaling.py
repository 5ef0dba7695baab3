"""Tests of scripts/studies/scaling.py and of scripts/render_scaling, as a user runs them."""

import os
import sys
import unittest

from programs import DONE, HAS_MODULE, ROOT, FolderTest, run, run_script

sys.dont_write_bytecode = True
from scaling_document import points, write_scaling

from scaling_table import RUNGS, SCHEMA  # noqa: E402  (scaling_document finds it)
import study_file

STUDY = os.path.join(ROOT, "scripts", "studies", "scaling.py")
RENDER = os.path.join(ROOT, "scripts", "render_scaling")


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class Study(FolderTest):
    def test_every_rung_on_the_same_stretch(self):
        path = self.path("raw.json")
        done = run([sys.executable, STUDY, "--out", path, "--n", "9", "--integrator", "group1", "--repetitions", "2"])
        self.assertEqual(done.returncode, DONE, done.stderr)
        found = study_file.read(path, SCHEMA)
        self.assertEqual([(point.integrator, point.n, point.rung) for point in found.tables["points"]],
                         [("group1", 9, rung) for rung in RUNGS])
        self.assertEqual({len(point.seconds) for point in found.tables["points"]}, {2})
        self.assertIn("timed_on", found.context)
        sweeps = {point.rung: point.sweeps for point in found.tables["points"]}
        self.assertEqual(round(sweeps["without any"]), round(sweeps["published"]))  # plain sweeps from a cold start
        self.assertLess(sweeps["fast"], 0.5 * sweeps["published"])
        self.assertEqual(os.listdir(self.folder), ["raw.json"])


class Table(FolderTest):
    def render(self, rows=None):
        return run_script(RENDER, write_scaling(self.folder, "raw.json", rows))

    def row(self, text, n, rung):
        return next(line for line in text.splitlines() if line.split()[:1] == [str(n)] and f" {rung} " in line).split()

    def test_times_as_fast_are_of_the_same_round(self):
        done = self.render()
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        # However much slower a round was, the published form was so too.
        self.assertEqual(self.row(done.stdout, 17, "fast"),
                         ["17", "group2", "fast", "12.0", "20.0", "3.74e-06", "±6.8", "%", "5.00", "±0.0", "%"])

    def test_a_rung_that_failed_has_no_figures(self):
        done = self.render([point for point in points() if (point.n, point.rung) != (17, "published")])
        self.assertEqual(self.row(done.stdout, 17, "published")[3:], ["–"] * 4)
        self.assertEqual(self.row(done.stdout, 17, "fast")[-1], "–")

    def test_a_file_without_points_is_refused(self):
        self.assert_refused(self.render([]), "raw.json", "no points")


if __name__ == "__main__":
    unittest.main()
