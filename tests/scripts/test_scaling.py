"""Tests of scripts/render_scaling, as a user runs it."""

import os
import unittest
from unittest import mock

from programs import DONE, ROOT, FolderTest, run_script, text_of

from lib import formats
from lib.figures import read_figures
from lib.scaling_table import RUNGS, SCHEMA, Point, Settings

RENDER = os.path.join(ROOT, "scripts", "render_scaling")
TIMES_AS_FAST = {"published": 1.0, "fast": 5.0}


def write_scaling(folder, rungs=tuple(RUNGS)):
    """Writes a raw file with these rungs at n = 17, a made-up one, and returns its path.

    A step of group2 takes 17 microseconds in the published form, a fifth of it in the fast one, and half of it on the
    rungs between.
    """
    path = os.path.join(folder, "raw.json")
    points = [Point("group2", 17, rung, 12.0, 100.0 / TIMES_AS_FAST.get(rung, 2.0),
                    [noise * 17e-6 / TIMES_AS_FAST.get(rung, 2.0) for noise in (1.0, 1.1, 1.3)]) for rung in rungs]
    formats.write_study(path, SCHEMA, {"cpu": "a processor"}, Settings("smooth", 0.1, 20), {"points": points})
    return path


class Report(FolderTest):
    def render(self, rungs=RUNGS):
        return run_script(RENDER, write_scaling(self.folder, rungs), "--out", self.path("out"))

    def row(self, rungs=RUNGS):
        """Returns the cells of the row of group2."""
        done = self.render(rungs)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (DONE, "", ""))
        self.assertEqual(set(os.listdir(self.path("out"))), {"report.md", "figures.json"})
        lines = text_of(self.path("out", "report.md")).splitlines()
        return [cell.strip() for cell in next(line for line in lines if "| group2" in line).strip("|").split("|")]

    def figures(self, **seconds):
        """Returns the figures of a file whose rungs take so many times as long as they do."""
        with mock.patch.dict(TIMES_AS_FAST, seconds):
            self.render()
        return read_figures(self.path("out", "figures.json"))

    def test_ratios_are_of_the_same_round(self):
        # However much slower a round was, both forms were so.
        self.assertEqual(self.row(), ["17", "group2", "12.0", "20.0", "3.74e-06 ±6.8 %", "5.00 ±0.0 %",
                                      *["2.50 ±0.0 %"] * 4])

    def test_what_failed_has_no_figures(self):
        self.assertEqual(self.row(["without any", "fast"])[5:], ["–", "2.50 ±0.0 %", "–", "–", "–"])
        self.assertEqual(self.row(["published"])[2:], ["–"] * 8)
        self.assertEqual(read_figures(self.path("out", "figures.json")), {})

    def test_means(self):
        found = self.figures()
        self.assertEqual([found[key] for key in ("published.n17", "published.n17.group", "without_bands.n17")],
                         [5, 5, 2.5])
        self.assertNotIn("published.n17.algebra", found)  # it was not timed
        self.assertEqual(found["costliest_idea"], 0)
        self.assertAlmostEqual(self.figures(**{"without newton": 5.5})["costliest_idea"], 0.1)
        self.assertIn("| published         |   5.00 |", text_of(self.path("out", "report.md")))

    def test_a_file_that_cannot_be_used_and_a_folder_that_cannot_be_written(self):
        self.assert_refused(self.render([]), "raw.json", "no points")
        self.assert_refused(run_script(RENDER, self.path("none.json"), "--out", self.path("out")), "none.json")
        self.assert_refused(run_script(RENDER, write_scaling(self.folder)), "--out")
        self.assertFalse(os.path.exists(self.path("out")))
        self.assert_refused(run_script(RENDER, write_scaling(self.folder), "--out", self.write("taken", "")), "taken")


if __name__ == "__main__":
    unittest.main()
