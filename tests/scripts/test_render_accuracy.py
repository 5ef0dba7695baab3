"""Tests of scripts/render_accuracy on a made-up study: by running it as a user does, and by what its charts draw."""

import json
import os
import sys
import tempfile
import unittest

import programs
from drawing import PYTHON, DrawingTest, finite_points, lines_of
from programs import snapshot
from study_documents import UNCERTAINTY, accuracy_of, run_of, small_study, study_document, write_study
from test_reproduce import raw_file

from benchmark_json import read_run

CHARTS = ("error_against_time", "tolerance", "table1_accuracy")
FLOOR = 10 * UNCERTAINTY


class AccuracyTest(DrawingTest):
    script = "render_accuracy"

    def small(self):
        """Returns the raw file of a study that is drawn in a second or two, where only the files matter."""
        return write_study(self.folder, small_study(), "small.json")

    def table1(self, counters=lambda s: {"relative_error": 10.0**(-3 * s)}, drop=()):
        """Returns a raw file of Table 1 whose rows have these counters; cells of `drop` failed."""
        document = raw_file(sizes=(17, 33))
        for row in document["benchmarks"]:
            row.update(counters(int(row["run_name"][-1])))
            if row["run_name"] in drop:
                row.update(error_occurred=True, error_message="diverged at step 3")
        return self.write("table1.json", json.dumps(document))

    def without(self):
        """Returns a folder for PYTHONPATH with which a Python has no matplotlib."""
        self.write("broken/matplotlib.py", "raise ImportError('not here')\n")
        return self.path("broken")


class Files(AccuracyTest):
    def test_whole_and_the_same_by_a_chosen_python_under_a_user_s_own_settings(self):
        arguments = (self.small(), "--table1", self.table1())
        files = self.rendered("plain", *arguments)
        self.assertEqual(set(files), {"report.md", "report.txt", *(f"{chart}.{kind}" for chart in CHARTS
                                                                   for kind in ("svg", "png"))})
        for chart in CHARTS:
            self.assert_whole(files, chart)
        for name, contents in files.items():
            for word in (b"<dc:date", b"Software", b"Matplotlib v", self.folder.encode()):
                self.assertNotIn(word, contents, name)
        self.write("matplotlib/matplotlibrc", "lines.linewidth: 9\nfont.size: 30\naxes.facecolor: red\n")
        chosen = self.write("bin/chosen", f'#!/bin/sh\necho chosen >> {self.path("calls")}\nunset PYTHONPATH\n'
                                          f'exec {PYTHON} "$@"\n', executable=True)
        again = self.rendered("new/charts", *arguments, PYTHONPATH=self.without(), ISOSYRK_PYTHON=chosen)
        self.assertTrue(os.path.exists(self.path("calls")))
        self.assertTrue(again == files)  # some megabytes

    def test_what_is_recorded_is_svg_and_markdown_only(self):
        recorded = os.path.join(programs.ROOT, "results", "recorded")
        with tempfile.TemporaryDirectory(dir=recorded) as folder:
            self.assertEqual(self.render(self.small(), "--out", folder).returncode, 0)
            self.assertEqual(set(os.listdir(folder)), {"report.md", "error_against_time.svg", "tolerance.svg"})

    def test_without_errors_table_1_is_left_out_and_said_so(self):
        table1 = self.table1(lambda s: {})
        result = self.render(self.small(), "--out", self.path("charts"), "--table1", table1)
        self.assertEqual(result.returncode, 0)
        self.assert_one_line(result.stderr, table1, "relative_error", "table1_accuracy")
        self.assertNotIn("table1_accuracy.svg", os.listdir(self.path("charts")))


class WhatIsDrawn(AccuracyTest):
    def test_error_against_time(self):
        document = study_document()
        run_of(document, "rkmk4", 33, 200)["error"] = 0.9 * FLOOR
        panels = self.panels("charts", "error_against_time", accuracy_of(document))
        self.assertEqual(list(panels), ["n = 17", "n = 33"])
        lines = [lines_of(panels[f"n = {n}"][0]) for n in (17, 33)]
        self.assertEqual([len(each["rkmk4"]) for each in lines], [6, 5])
        point = run_of(document, "group2", 17, 50)
        self.assertIn([sorted(point["cpu_seconds"])[1], point["error"]], lines[0]["group2"])
        # A failed run is not drawn: a cross marks the next.
        self.assertEqual((len(lines[0]["group1"]), len(lines[0]["cotangent1"])), (5, 6))
        self.assertEqual([finite_points(line) for line in panels["n = 17"][0].lines if line.get_label() == "_failure"],
                         [lines[0]["group1"][:1]])

    def test_tolerance(self):
        (panel,) = self.panels("charts", "tolerance", accuracy_of(study_document()))["s = 2, order 4"]
        lines = lines_of(panel)
        self.assertEqual(set(lines), {"group2: error", "group2: solver_error"})
        for tolerance, error in lines["group2: solver_error"]:
            self.assertAlmostEqual(error / tolerance, 0.1)

    def test_table_1(self):
        def lines(drop=()):
            run = read_run(self.table1(drop=drop), "table1", (), optional=("relative_error",))
            return lines_of(self.panels("charts", "table1_accuracy", run)[""][0])

        self.assertEqual(set(lines()), {f"{each}, n = {n}" for each in programs.FORMULATIONS for n in (17, 33)})
        for (time, error), s in zip(lines()["cotangent, n = 33"], (1, 2, 3)):
            self.assertAlmostEqual(time, (2.0 * s + 0.03) * 1e-3)
            self.assertAlmostEqual(error / 10.0**(-3 * s), 1)
        self.assertEqual(len(lines(drop=("table1/group/n:33/s:2",))["group, n = 33"]), 2)


class Refusals(AccuracyTest):
    def test_one_line_and_nothing_written(self):
        damaged = small_study()
        damaged["runs"][0]["error"] = -1.0
        closed = "/proc/isosyrk-charts" if os.geteuid() == 0 else self.path("closed")
        if os.geteuid() != 0:
            os.mkdir(closed, 0o500)
        folder = ("--out", self.path("charts"))
        for arguments, *words in (((write_study(self.folder, damaged), *folder), "error"),
                                  ((self.small(), "--out", self.write("taken", "kept")), "taken", "cannot be written"),
                                  ((self.small(), "--out", closed), "cannot be written"), ((self.small(),), "--out"),
                                  ((self.small(), *folder, "--colour"), "--colour")):
            with self.subTest(words=words):
                self.assert_refused(self.render(*arguments), *words)
                self.assertFalse(os.path.exists(self.path("charts")))
        self.assertEqual(snapshot(self.folder)["taken"], b"kept")


class Python(AccuracyTest):
    """Which Python draws. A module that fails stands in for a Python without matplotlib."""

    python = sys.executable

    def test_no_matplotlib_anywhere_is_one_line_but_help_needs_none(self):
        without = {"PYTHONPATH": self.without(), "ISOSYRK_PYTHON": sys.executable, "PATH": self.path("empty")}
        self.assert_refused(self.render(self.small(), "--out", self.path("charts"), **without),
                            "no Python with matplotlib found", sys.executable, "/usr/bin/python3",
                            "install python3-matplotlib")
        self.assertFalse(os.path.exists(self.path("charts")))
        self.assertEqual(self.render("--help", **without).returncode, 0)

    def test_a_chosen_python_that_does_not_exist_is_passed_over(self):
        result = self.render(self.path("none.json"), "--out", self.path("charts"), ISOSYRK_PYTHON=self.path("none"))
        self.assert_refused(result, "none.json", "cannot be read")  # by the Python that would have drawn it


if __name__ == "__main__":
    unittest.main()
