"""Tests of scripts/render_scaling, as a user runs it."""

import os

from programs import DONE, ROOT, FolderTest, run_script

from lib import scaling_table
from lib import formats
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


class Table(FolderTest):
    def render(self, rungs=RUNGS):
        return run_script(RENDER, write_scaling(self.folder, rungs))

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
        path = write_scaling(self.folder)
        (_, published), (_, ideas) = scaling_table.claims(path)
        self.assertIn(": 5 at n = 17 (", published)
        self.assertIn("without bands, 2.5 at n = 17", ideas)
        TIMES_AS_FAST["without newton"] = 5.5
        *_, (best, which) = scaling_table.claims(write_scaling(self.folder))
        self.assertEqual((best[:20], which.partition(": ")[2]), ("At most 10.0% faster", "group without newton at n = 17."))
        del TIMES_AS_FAST["without newton"]
        scaling_table.claims(write_scaling(self.folder, ["published"]))  # says less, without harm

    def test_a_file_without_points_is_refused(self):
        self.assert_refused(self.render([]), "raw.json", "no points")
