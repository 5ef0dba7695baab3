"""Tests of scripts/render_scaling, as a user runs it."""

import json
import os
import unittest
from unittest import mock

from programs import DONE, ROOT, FolderTest, run_script, text_of

from lib import formats
from lib.figures import read_figures
from lib.scaling_table import (EXPONENTIAL_RUNGS, RUNGS, SCHEMA, ExponentialPoint, LargePoint, Point, Settings,
                               exponential_rungs)

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
    return write_tables(path, points=points)


def write_tables(path, **tables):
    """Writes a raw file with these tables and returns its path."""
    formats.write_study(path, SCHEMA, {"cpu": "a processor"}, Settings("smooth", 0.1, 20), {"points": [], **tables})
    return path


def exponential_points(name, n, unit=1.0):
    """Returns made-up points of all rungs: a step takes two, three ... times as long as that of the fast form."""
    rungs = [rung for rung in exponential_rungs(name) if rung != "fast"]
    times = {"fast": 1.0, **{rung: float(k) for k, rung in enumerate(rungs, 2)}}
    return [ExponentialPoint(name, n, rung, 0.5, 1e-8, 1.0, 30.0, [unit * time * 1e-4] * 2)
            for rung, time in times.items()]


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

    def lines_of(self, **tables):
        """Returns the cells of each line of the report on these tables."""
        done = run_script(RENDER, write_tables(self.path("raw.json"), **tables), "--out", self.path("out"))
        self.assertEqual((done.returncode, done.stdout, done.stderr), (DONE, "", ""))
        lines = text_of(self.path("out", "report.md")).splitlines()
        return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]

    def test_exponential_methods_have_a_table_of_their_own(self):
        points = [*exponential_points("elp2", 17), *exponential_points("elp4", 17),
                  *exponential_points("elp4", 33, 8.0), *exponential_points("rkmk4", 33)]
        lines = self.lines_of(exponential=points)
        self.assertIn(["elp4", "without explicit start", "6.00 ±0.0 %", "6.00 ±0.0 %"], lines)
        self.assertIn(["rkmk4", "without graded series", "–", "5.00 ±0.0 %"], lines)
        self.assertNotIn("without newton", [line[1] for line in lines if line[0] == "rkmk4"])
        self.assertIn(["33", "elp4", "1.00", "30.0", "0.000800 ±0.0 %"], lines)
        text = text_of(self.path("out", "report.md"))
        for part in ("h = 0.5", "1e-08", "## Every exponential method"):
            self.assertIn(part, text)
        self.assertNotIn("h = 0.1,", text)
        found = read_figures(self.path("out", "figures.json"))
        self.assertEqual(found["exponential.without_predictor.n17"], 5)
        self.assertEqual(found["exponential.without_graded_series.n33.rkmk4"], 5)
        self.assertAlmostEqual(found["exponential.without_graded_series.n33"], 10)  # without rkmk4
        self.assertNotIn("costliest_idea", found)

    def test_rungs_of_exponential_methods(self):
        self.assertEqual(exponential_rungs("elp6_frame"), list(EXPONENTIAL_RUNGS))
        self.assertEqual(exponential_rungs("magnus5"), ["published", "without bands", "fast"])
        self.assertEqual(exponential_rungs("rkmk4"), ["published", "without any", "without single precision",
                                                      "without graded series", "without bands", "fast"])

    def test_large_n(self):
        lines = self.lines_of(large=[LargePoint("rough", "elp4_frame", 513, 0.5, 1e-8, 1.0, 20.0, 40.0, 0.8),
                                     LargePoint("rough", "rk4_frame", 513, 0.5, 1e-8, None, None, 40.0, None)])
        self.assertIn(["513", "rough", "rk4\\_frame", "0.5", "1e-08", *"––––"], lines)
        self.assertIn(["513", "rough", "elp4\\_frame", "0.5", "1e-08", "1.00", "20.0", "62.5 %", "0.800"], lines)

    def test_a_file_of_before_has_neither(self):
        write_scaling(self.folder)
        document = json.loads(text_of(self.path("raw.json")))
        self.assertEqual(list(document["tables"]), ["points"])
        self.assertNotIn("xponential", " ".join(map(str, self.row())))
        self.assertNotIn("xponential", text_of(self.path("out", "report.md")))

    def test_a_file_that_cannot_be_used_and_a_folder_that_cannot_be_written(self):
        self.assert_refused(self.render([]), "raw.json", "no points")
        self.assert_refused(run_script(RENDER, self.path("none.json"), "--out", self.path("out")), "none.json")
        self.assert_refused(run_script(RENDER, write_scaling(self.folder)), "--out")
        self.assertFalse(os.path.exists(self.path("out")))
        self.assert_refused(run_script(RENDER, write_scaling(self.folder), "--out", self.write("taken", "")), "taken")


if __name__ == "__main__":
    unittest.main()
