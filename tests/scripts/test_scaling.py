"""Tests of scripts/render_scaling, as a user runs it."""

import os

from programs import DONE, ROOT, FolderTest, run_script
from scaling_document import RUNGS, write_scaling

RENDER = os.path.join(ROOT, "scripts", "render_scaling")


class Table(FolderTest):
    def render(self, rungs=RUNGS):
        return run_script(RENDER, write_scaling(self.folder, "raw.json", rungs))

    def row(self, text, rung):
        return next(line for line in text.splitlines() if line.split()[:1] == ["17"] and f" {rung} " in line).split()

    def test_times_as_fast_are_of_the_same_round(self):
        done = self.render()
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        # However much slower a round was, the published form was so too.
        self.assertEqual(self.row(done.stdout, "fast"),
                         ["17", "group2", "fast", "12.0", "20.0", "3.74e-06", "±6.8", "%", "5.00", "±0.0", "%"])

    def test_a_rung_that_failed_has_no_figures(self):
        done = self.render(["without any", "fast"])
        self.assertEqual(self.row(done.stdout, "published")[3:], ["–"] * 4)
        self.assertEqual(self.row(done.stdout, "fast")[-1], "–")

    def test_a_file_without_points_is_refused(self):
        self.assert_refused(self.render([]), "raw.json", "no points")
