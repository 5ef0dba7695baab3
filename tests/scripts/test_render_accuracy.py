"""Tests of scripts/render_accuracy on a made-up study: by running it as a user does, and by what its charts draw."""

import json
import math
import os
import shutil
import sys
import unittest
from unittest import mock

import programs
from drawing import PYTHON, DrawingTest, lines_of
from programs import snapshot
from study_documents import INTEGRATORS, accuracy_of, run_of, small_study, study_document, write_study
from test_reproduce import raw_file

from lib.formats import read_run

CHARTS = ("error_against_time", "energy_against_time", "error_against_n", "table1_accuracy")


class AccuracyTest(DrawingTest):
    script = "render_accuracy"

    def small(self):
        """Returns the raw file of a study that is drawn in a second or two, where only the files matter."""
        return write_study(self.folder, small_study(), "small.json")

    def table2(self, counters=lambda s: {"relative_error": 10.0**(-3 * s)}, failed=False):
        """Returns a raw file of Table 2 with Table 1's rows, which take twice as long; the rows of algebra may fail."""
        document = raw_file(failed, ("table2", "table1"), sizes=(17, 33))
        for row in document["benchmarks"]:
            row.update(counters(int(row["run_name"][-1])))
        return self.write("table2.json", json.dumps(document))

    def without(self):
        """Returns a folder for PYTHONPATH with which a Python has no matplotlib."""
        self.write("broken/matplotlib.py", "raise ImportError('not here')\n")
        return self.path("broken")


class Files(AccuracyTest):
    def test_whole_and_the_same_by_a_chosen_python_under_a_user_s_own_settings_on_other_kernels(self):
        arguments = (self.small(), "--table2", self.table2())
        files = self.rendered("plain", *arguments)
        self.assertEqual(set(files), {"report.md", "figures.json", *(f"{chart}.{kind}" for chart in CHARTS
                                                                     for kind in ("svg", "png"))})
        for chart in CHARTS:
            self.assert_whole(files, chart)
        for name, contents in files.items():
            for word in (b"<dc:date", b"Software", b"Matplotlib v", self.folder.encode()):
                self.assertNotIn(word, contents, name)
        self.write("matplotlib/matplotlibrc", "lines.linewidth: 9\nfont.size: 30\naxes.facecolor: red\n")
        chosen = self.write("bin/chosen", f'#!/bin/sh\necho chosen >> {self.path("calls")}\nunset PYTHONPATH\n'
                                          f'exec {PYTHON} "$@"\n', executable=True)
        again = self.rendered("new/charts", *arguments, PYTHONPATH=self.without(), ISOSYRK_PYTHON=chosen,
                              OPENBLAS_CORETYPE="Haswell")
        self.assertTrue(os.path.exists(self.path("calls")))
        self.assertTrue(again == files)  # some megabytes

    def test_what_is_recorded_is_svg_and_markdown_only(self):
        shutil.copytree(os.path.join(programs.ROOT, "scripts"), self.path("root", "scripts"))  # whose results/ this is
        out = self.path("root", "results", "recorded", "study")
        with mock.patch.object(programs, "ROOT", self.path("root")):
            self.assertEqual(self.render(self.small(), "--out", out).returncode, 0)
        self.assertEqual(set(os.listdir(out)), {"report.md", "figures.json",
                                                *(f"{chart}.svg" for chart in CHARTS[:-1])})

    def test_without_errors_table_1_is_left_out_and_said_so(self):
        table2 = self.table2(lambda s: {})
        result = self.render(self.small(), "--out", self.path("charts"), "--table2", table2)
        self.assertEqual(result.returncode, 0)
        self.assert_one_line(result.stderr, table2, "relative_error", "table1_accuracy")
        self.assertNotIn("table1_accuracy.svg", os.listdir(self.path("charts")))


class WhatIsDrawn(AccuracyTest):
    def test_no_line_across_a_failure_or_beyond_a_limit(self):
        document = study_document()
        run_of(document, "rkmk4", 17, 20)["beyond_limit"] = True
        run_of(document, "rkmk4", 17, 100).update(status="diverged", cpu_seconds=[])
        (panel,) = self.panels("charts", "error_against_time", accuracy_of(document))["smooth, T = 5, n = 17"]
        lines = [line.get_xdata() / INTEGRATORS["rkmk4"][-1] for line in panel.lines if line.get_label() == "rkmk4"]
        self.assertEqual([[round(steps) for steps in line] for line in lines], [[5, 10], [50], [200]])

    def test_envelopes_ghosts_and_decades(self):
        document = study_document()
        run_of(document, "group2", 17, 200).update(error=1e-12, cpu_seconds=[80.0])
        panels = self.panels("charts", "error_against_time", accuracy_of(document))
        self.assertEqual(list(panels), ["smooth, T = 5, n = 17", "smooth, T = 5, n = 33"])
        widths = [math.log10(panel.get_xlim()[1] / panel.get_xlim()[0]) for (panel,) in panels.values()]
        self.assertAlmostEqual(*widths)
        lines = lines_of(panels["smooth, T = 5, n = 17"][0])
        self.assertIn("group2, published", lines)
        self.assertNotIn("cotangent1", lines)  # group stands for its method
        # The spectrum is kept by rkmk4 alone: 1e-3 h^4 in 1e-3 T/h seconds, upright above its longest step.
        self.assertEqual(lines["spectrum"][-1][1], 1.0)
        for seconds, error in lines["spectrum"]:
            self.assertAlmostEqual(seconds, 5e-3 * max(1, (1e-3 / error) ** 0.25))
        # The envelope ends with its cheapest line, group2_frame at 4e-9, before only a much dearer one goes on.
        self.assertGreater(lines["poisson"][0][1], 3e-9)
        best = [line for name in ("group1", "group2", "group2_frame") for line in lines[name]]
        # Its levels are 4 a decade: within a factor 1.78 above each point there is one that is no dearer.
        self.assertTrue(all(any(x <= 1.0001 * seconds and error <= 1.0001 * y <= 1.79 * error
                                for x, y in lines["poisson"])
                            for seconds, error in best if error < 0.5 and seconds < 80))

    def test_the_legend_lists_what_is_drawn(self):
        document = study_document()
        for run in document["runs"]:
            # Below the panel, and in it.
            run.update(energy_error=1e-15 if run["integrator"].startswith("group") else 1e-6)
        (panel,) = self.panels("charts", "energy_against_time", accuracy_of(document))["smooth, T = 5, n = 33"]
        self.assertEqual({text.get_text() for text in panel.figure.legends[0].get_texts()}, {
            "best that keeps the spectrum", "best that keeps nothing", "best that keeps the Lie–Poisson structure",
            "not in it (pale)", "RKMK4: RKMK, order 4", "RK4: Runge–Kutta, order 4"})

    def test_other_problems_energy_and_size(self):
        study = accuracy_of(study_document())
        self.assertEqual(list(self.panels("charts", "error_against_time_others", study)), ["rough, T = 5, n = 17"])
        self.assertEqual(list(self.panels("charts", "energy_against_time", study)), ["smooth, T = 5, n = 33"])
        panels = self.panels("charts", "error_against_n", study)
        at_step = lines_of(panels["at h = 0.1"][0])
        self.assertEqual([n for n, _ in at_step["group2_frame"]], [17, 33])
        self.assertAlmostEqual(at_step["group2"][0][1] / at_step["group2_frame"][0][1], 10)
        against_norm = lines_of(panels["every h, not in the frame; thicker: larger n"][0])
        self.assertEqual({line for line in against_norm if line.startswith("group2")},
                         {"group2, n = 17", "group2, n = 33"})

    def test_tables_1_and_2(self):
        def lines(failed=False):
            runs = [read_run(self.table2(failed=failed), ("table2",), (), ("relative_error",), table)
                    for table in ("table1", "table2")]
            return lines_of(self.panels("charts", "table1_accuracy", *runs)[""][0])

        self.assertEqual(set(lines()), {f"{each}{s}, n = {n}, {form}" for each in programs.FORMULATIONS
                                        for s in (1, 2, 3) for n in (17, 33) for form in ("published", "fast")})
        ((before, error),), ((after, same),) = (lines()[f"cotangent2, n = 33, {form}"]
                                                for form in ("published", "fast"))
        self.assertAlmostEqual(error, 1e-6)
        self.assertEqual(same, error)
        self.assertGreater(before, after)
        self.assertEqual({line.split(",")[0].rstrip("123") for line in lines(failed=True)}, {"cotangent", "group"})


class Refusals(AccuracyTest):
    def test_one_line_and_nothing_written(self):
        damaged = small_study()
        damaged["runs"][0]["error"] = -1.0
        folder = ("--out", self.path("charts"))
        nowhere = {"PYTHONPATH": self.without(), "ISOSYRK_PYTHON": sys.executable, "PATH": self.path("empty")}
        for arguments, changes, *words in (
                ((write_study(self.folder, damaged), *folder), {}, "error"),
                ((self.small(), "--out", self.write("taken", "kept")), {}, "taken", "cannot be written"),
                ((self.small(),), {}, "--out"), ((self.small(), *folder, "--colour"), {}, "--colour"),
                ((self.small(), *folder), nowhere, "no Python with matplotlib found", sys.executable,
                 "/usr/bin/python3",
                 "install python3-matplotlib")):
            with self.subTest(words=words):
                self.assert_refused(self.render(*arguments, **changes), *words)
                self.assertFalse(os.path.exists(self.path("charts")))
        self.assertEqual(snapshot(self.folder)["taken"], b"kept")
        self.assertEqual(self.render("--help", **nowhere).returncode, 0)  # which needs no matplotlib


if __name__ == "__main__":
    unittest.main()
