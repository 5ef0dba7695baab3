"""Tests of scripts/render_accuracy on a made-up study: by running it as a user does, and by what its charts draw."""

import json
import os
import sys
import tempfile
import unittest

import programs
from drawing import PYTHON, DrawingTest, lines_of, panels_of
from programs import snapshot
from study_documents import UNCERTAINTY, accuracy_of, small_study, study_document, write_study
from test_reproduce import raw_file

from benchmark_json import read_run

CHARTS = ("error_against_time", "tolerance")
FILES = {"report.md", "report.txt", *(f"{chart}.{kind}" for chart in CHARTS for kind in ("svg", "png"))}
TABLE1_CHART = "table1_accuracy"
WITH_TABLE1 = FILES | {f"{TABLE1_CHART}.{kind}" for kind in ("svg", "png")}
FLOOR = 10 * UNCERTAINTY

PLAIN = {}  # the files of the small study, rendered once for all tests: drawing takes seconds


class AccuracyTest(DrawingTest):
    script = "render_accuracy"

    def assert_renders(self, *arguments, **changes):
        result = self.render(*arguments, **changes)
        self.assertEqual((result.returncode, result.stdout), (0, ""), result.stderr)
        return result

    def drawn(self, change=lambda document: None, chart="error_against_time"):
        """Returns a chart of the study after a change."""
        document = study_document()
        change(document)
        return getattr(self.module("charts"), chart)(accuracy_of(document))

    def lines(self, title, *arguments):
        """Returns the lines of the first panel with this title."""
        return lines_of(panels_of(self.drawn(*arguments))[title][0])

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

    def render_plain(self, folder, **changes):
        """Renders the small study with Table 1 and returns the files."""
        done = self.assert_renders(self.small(), "--out", folder, "--table1", self.table1(), **changes)
        self.assertEqual(done.stderr, "")
        return snapshot(folder)

    def plain(self):
        """Returns these files, rendered once for all tests."""
        if not PLAIN:
            PLAIN.update(self.render_plain(self.path("plain")))
        return PLAIN

class Files(AccuracyTest):
    def test_every_chart_is_a_whole_svg_and_png(self):
        files = self.plain()
        self.assertEqual(set(files), WITH_TABLE1)
        for chart in (*CHARTS, TABLE1_CHART):
            self.assert_whole(files, chart)

    def test_what_is_recorded_is_svg_and_markdown_only(self):
        recorded = os.path.join(programs.ROOT, "results", "recorded")
        with tempfile.TemporaryDirectory(dir=recorded) as folder:
            self.assert_renders(self.small(), "--out", folder)
            self.assertEqual(set(os.listdir(folder)), {name for name in FILES if name.endswith((".svg", ".md"))})

    def test_the_same_bytes_by_a_chosen_python_under_a_user_s_own_settings(self):
        self.write("matplotlib/matplotlibrc", "lines.linewidth: 9\nfont.size: 30\naxes.facecolor: red\n")
        chosen = self.write("bin/chosen", f'#!/bin/sh\necho chosen >> {self.path("calls")}\nunset PYTHONPATH\n'
                                          f'exec {PYTHON} "$@"\n', executable=True)
        files = self.render_plain(self.path("new", "charts"), PYTHONPATH=self.without(), ISOSYRK_PYTHON=chosen)
        self.assertTrue(os.path.exists(self.path("calls")))
        self.assertTrue(files == self.plain())  # some megabytes

    def test_files_name_no_date_and_no_program(self):
        for name, contents in self.plain().items():
            for word in (b"<dc:date", b"Software", b"Matplotlib v", self.folder.encode()):
                self.assertNotIn(word, contents, name)

    def test_without_errors_table_1_is_left_out_and_said_so(self):
        table1 = self.table1(lambda s: {})
        result = self.assert_renders(self.small(), "--out", self.path("charts"), "--table1", table1)
        self.assert_one_line(result.stderr, table1, "relative_error", TABLE1_CHART)
        self.assertEqual(set(os.listdir(self.path("charts"))), FILES)


def texts_of(figure):
    """Returns all texts of a figure, in one line."""
    texts = [text for axes in figure.axes for text in axes.texts] + figure.texts
    return " ".join(" ".join(text.get_text().split()) for text in texts)


class WhatIsDrawn(AccuracyTest):
    def test_points_are_time_and_error(self):
        point = next(each for each in study_document()["runs"]
                     if (each["integrator"], each["n"], each["steps"]) == ("group2", 17, 50))
        self.assertIn([sorted(point["cpu_seconds"])[1], point["error"]], self.lines("n = 17")["group2"])

    def test_lines_end_above_the_floor(self):
        for n, (panel,) in panels_of(self.drawn()).items():
            self.assertEqual(set(lines_of(panel)), {"cotangent1", "group1", "group2", "rkmk4", "rk4"}, n)
            for name, points in lines_of(panel).items():
                self.assertGreaterEqual(min(error for _, error in points), FLOOR, (n, name))

    def test_a_point_below_the_floor_is_dropped_and_one_above_drawn(self):
        def with_error(error):
            def change(document):
                for point in document["runs"]:
                    if (point["integrator"], point["steps"]) == ("rkmk4", 200):
                        point["error"] = error
            return self.lines("n = 33", change)["rkmk4"]
        self.assertEqual(len(with_error(0.9 * FLOOR)), 5)
        above = with_error(1.1 * FLOOR)
        self.assertEqual(len(above), 6)
        self.assertAlmostEqual(above[-1][1] / FLOOR, 1.1)

    def test_a_failed_run_is_marked_and_not_drawn(self):
        (panel,) = panels_of(self.drawn())["n = 17"]
        lines = lines_of(panel)
        self.assertEqual((len(lines["group1"]), len(lines["cotangent1"])), (5, 6))
        self.assertEqual(sum(line.get_label() == "_failure" for line in panel.lines), 1)

    def test_tolerance_chart_has_error_solver_error_and_time(self):
        lines = self.lines("s = 2, order 4", lambda document: None, "tolerance")
        self.assertEqual(set(lines), {"group: error", "group: solver error"})
        for tolerance, error in lines["group: solver error"]:
            self.assertAlmostEqual(error / tolerance, 0.1)

    def test_a_study_without_tolerances_is_drawn(self):
        found = self.drawn(lambda document: document["tolerance_runs"].clear(), "tolerance")
        self.assertEqual(panels_of(found), {})


class Table1(AccuracyTest):
    def chart(self, *arguments, **options):
        run = read_run(self.table1(*arguments, **options), "table1", (), optional=("relative_error", "reference_uncertainty"))
        return self.module("charts").table1_accuracy(run)

    def test_every_cell_is_drawn_at_its_time_and_error(self):
        found = self.chart(lambda s: {"relative_error": 10.0**(-3 * s), "reference_uncertainty": 1.5e-14})
        lines = lines_of(panels_of(found)[""][0])
        self.assertEqual(set(lines), {f"{each}, n = {n}" for each in programs.FORMULATIONS for n in (17, 33)})
        for (time, error), s in zip(lines["cotangent, n = 33"], (1, 2, 3)):
            self.assertAlmostEqual(time, (2.0 * s + 0.03) * 1e-3)
            self.assertAlmostEqual(error / 10.0**(-3 * s), 1)
        for text in ("n = 33, s = 3", "uncertain by 1.5e-14 at most. No cell failed."):
            self.assertIn(text, texts_of(found))

    def test_a_failed_cell_is_named_and_not_drawn(self):
        found = self.chart(drop=("table1/group/n:33/s:2",))
        self.assertEqual(len(lines_of(panels_of(found)[""][0])["group, n = 33"]), 2)
        self.assertIn("Failed: group at n = 33, s = 2.", texts_of(found))


class Refusals(AccuracyTest):
    def assert_nothing_written(self, raw, *parts):
        os.mkdir(self.path("charts"))
        self.assert_refused(self.render(raw, "--out", self.path("charts")), *parts)
        self.assertEqual(os.listdir(self.path("charts")), [])

    def test_raw_file_with_an_impossible_value(self):
        document = small_study()
        document["runs"][0]["error"] = -1.0
        self.assert_nothing_written(write_study(self.folder, document), "error")

    def test_out_is_a_file(self):
        self.assert_refused(self.render(self.small(), "--out", self.write("taken", "kept")), "taken", "cannot be written")
        with open(self.path("taken"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "kept")

    def test_out_may_not_be_written(self):
        folder = "/proc/isosyrk-charts" if os.geteuid() == 0 else self.path("closed")
        if os.geteuid() != 0:
            os.mkdir(folder, 0o500)
        self.assert_refused(self.render(self.small(), "--out", folder), "cannot be written")

    def test_missing_and_unknown_arguments(self):
        self.assert_refused(self.render(self.small()), "--out")
        self.assert_refused(self.render(self.small(), "--out", self.path("charts"), "--colour"), "--colour")


class Python(AccuracyTest):
    """Which Python draws. A module that fails stands in for a Python without matplotlib."""

    python = sys.executable

    def test_no_matplotlib_anywhere_is_one_line(self):
        result = self.render(self.small(), "--out", self.path("charts"), PYTHONPATH=self.without(),
                             ISOSYRK_PYTHON=sys.executable, PATH=self.path("empty"))
        self.assert_refused(result, "no Python with matplotlib found", sys.executable, "/usr/bin/python3",
                            "install python3-matplotlib")
        self.assertFalse(os.path.exists(self.path("charts")))

    def test_a_chosen_python_that_does_not_exist_is_passed_over(self):
        result = self.render(self.path("none.json"), "--out", self.path("charts"), ISOSYRK_PYTHON=self.path("none"))
        self.assert_refused(result, "none.json", "cannot be read")  # by the Python that would have drawn it

    def test_help_needs_no_matplotlib(self):
        result = self.render("--help", PYTHONPATH=self.without(), PATH=self.path("empty"))
        self.assertEqual((result.returncode, result.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
