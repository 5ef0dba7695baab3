"""Tests of scripts/render_scaling, as a user runs it."""

import os

from programs import DONE, ROOT, FolderTest, run_script
import scaling_document
import scaling_table
from scaling_document import RUNGS, write_scaling

RENDER = os.path.join(ROOT, "scripts", "render_scaling")


class Table(FolderTest):
    def render(self, rungs=RUNGS):
        return run_script(RENDER, write_scaling(self.folder, "raw.json", rungs))

    def row(self, text):
        return next(line for line in text.splitlines() if line.split()[:1] == ["17"]).split()

    def test_ratios_are_of_the_same_round(self):
        done = self.render()
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        # However much slower a round was, both forms were so.
        self.assertEqual(self.row(done.stdout), ["17", "group2", "12.0", "20.0", "3.74e-06", "±6.8", "%",
                                                 "5.00", "±0.0", "%", *(["2.50", "±0.0", "%"] * 4)])

    def test_what_failed_has_no_figures(self):
        self.assertEqual(self.row(self.render(["without any", "fast"]).stdout)[7:],
                         ["–", "2.50", "±0.0", "%", "–", "–", "–"])
        self.assertEqual(self.row(self.render(["published"]).stdout)[2:], ["–"] * 8)

    def test_what_it_says(self):
        path = write_scaling(self.folder, "raw.json")
        (_, published), (_, ideas) = scaling_table.claims(path)
        self.assertIn(": 5 at n = 17 (", published)
        self.assertIn("without bands, 2.5 at n = 17", ideas)
        scaling_document.TIMES_AS_FAST["without newton"] = 5.5
        *_, (best, which) = scaling_table.claims(write_scaling(self.folder, "raw.json"))
        self.assertEqual((best[:20], which.partition(": ")[2]), ("At most 10.0% faster", "group without newton at n = 17."))
        del scaling_document.TIMES_AS_FAST["without newton"]
        scaling_table.claims(write_scaling(self.folder, "raw.json", ["published"]))  # says less, without harm

    def test_a_file_without_points_is_refused(self):
        self.assert_refused(self.render([]), "raw.json", "no points")
