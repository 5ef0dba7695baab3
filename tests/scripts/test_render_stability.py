"""Tests of scripts/render_stability on made-up files: by running it as a user does, and by what its charts draw."""

import copy
import json
import os
import unittest

import programs
from drawing import LIBRARY, PYTHON, DrawingTest
from programs import run, snapshot
from stability_documents import CONTROL, GRID, long_document, map_document, norm, trial, write_document

MAPS = tuple(f"failure_map{others}_{scene}" for scene in ("smooth", "rough") for others in ("", "_others"))
LONG_RUNS = ("long_runs_n17", "long_runs_n17_controls")
MAP_ONLY = {"report.md", "report.txt", *(f"{chart}.{kind}" for chart in MAPS for kind in ("svg", "png"))}
FILES = MAP_ONLY | {f"{chart}.{kind}" for chart in LONG_RUNS for kind in ("svg", "png")}

# Prints what each panel of some charts draws: lines, crosses and cells, by the panel's title. The charts and their files
# come as JSON: [[function, file, arguments], ...].
DESCRIBE = """
import json, sys
sys.path.insert(0, sys.argv[1])
import stability_charts
from matplotlib.patches import Rectangle
from stability import read_long_runs, read_map
def finite(points):
    return [[float(x), float(y)] for x, y in points if x == x and y == y]
found = []
for draw, path, arguments in json.loads(sys.argv[2]):
    read = read_map if draw.startswith("failure") else read_long_runs
    figure = getattr(stability_charts, draw)(read(path), *arguments)
    panels = {}
    for axes in figure.axes:
        if axes.get_visible():
            panels.setdefault(axes.get_title(loc="left"), []).append({
                "lines": {line.get_label(): finite(line.get_xydata()) for line in axes.lines
                          if not line.get_label().startswith("_")},
                "crosses": [finite(line.get_xydata())[0] for line in axes.lines if line.get_label() == "_failure"],
                "cells": [[patch.get_x() + 0.5, patch.get_y(), patch.get_y() + patch.get_height(), patch.get_hatch()]
                          for patch in axes.patches if isinstance(patch, Rectangle)]})
    found.append({"panels": panels})
print(json.dumps(found))
"""

PLAIN = {}


class StabilityTest(DrawingTest):
    script = "render_stability"

    def setUp(self):
        super().setUp()
        self.map, self.long = map_document(), long_document()

    def leave(self, *names):
        """Leaves these integrators and one n: where only the files matter, less is drawn faster."""
        self.map["maps"] = [each for each in self.map["maps"] if each["n"] == 17]
        for document, kind in ((self.map, "maps"), (self.long, "runs")):
            document["integrators"] = [each for each in document["integrators"] if each["name"] in names]
            document[kind] = [each for each in document[kind] if each["integrator"] in names]
        self.map["settings"] = [each for each in self.map["settings"] if each["n"] == 17]

    def raw(self):
        return write_document(self.folder, self.map, "map.json")

    def raw_long(self):
        return write_document(self.folder, self.long, "long.json")

    def assert_renders(self, *arguments, **changes):
        result = self.render(*arguments, **changes)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def render_plain(self, folder, **changes):
        """Renders the documents as they are and returns the files."""
        self.assert_renders(self.raw(), "--long", self.raw_long(), "--out", folder, **changes)
        return snapshot(folder)

    def plain(self):
        """Returns these files, rendered once for all tests: drawing takes seconds."""
        if not PLAIN:
            PLAIN.update(self.render_plain(self.path("plain")))
        return PLAIN

    def drawn(self, *charts):
        """Returns what each of some charts draws; a chart is its function's name and arguments."""
        self.require_drawing()
        paths = {"failure": self.raw(), "long": self.raw_long()}
        wanted = [[draw, paths[draw.split("_")[0]], arguments] for draw, *arguments in charts]
        found = run([PYTHON, "-c", DESCRIBE, LIBRARY, json.dumps(wanted)], timeout=300,
                    env={**self.settings, "OPENBLAS_NUM_THREADS": "1"})
        self.assertEqual(found.returncode, 0, found.stderr)
        return json.loads(found.stdout)


class FastForms(StabilityTest):
    """A map of the fast forms beside that of the published ones."""

    def setUp(self):
        super().setUp()
        self.leave("group1", "algebra1")
        fast = copy.deepcopy(self.map)
        fast["context"]["solver"] = "fast"
        self.fast = write_document(self.folder, fast, "fast.json")

    def test_is_drawn_and_has_its_table(self):
        self.assert_renders(self.raw(), "--fast", self.fast, "--out", self.path("charts"))
        files = snapshot(self.path("charts"))
        self.assertIn("failure_map_fast_smooth.svg", files)
        self.assertIn("Critical h‖B(W₀)‖₂ of the fast forms\n", files["report.txt"].decode())

    def test_one_is_not_taken_for_the_other(self):
        self.assert_refused(self.render(self.raw(), "--fast", self.raw(), "--out", self.path("charts")), "no map of the fast")
        self.assert_refused(self.render(self.fast, "--out", self.path("charts")), "no map of the published")
        self.assertFalse(os.path.exists(self.path("charts")))


class Files(StabilityTest):
    def setUp(self):
        super().setUp()
        self.leave("group1", "algebra1", "rk4", CONTROL)

    def test_every_chart_is_a_whole_svg_and_png(self):
        files = self.plain()
        self.assertEqual(set(files), FILES)
        for chart in (*MAPS, *LONG_RUNS):
            self.assert_whole(files, chart)

    def test_the_report_shows_the_charts(self):
        for chart in (*MAPS, *LONG_RUNS):
            self.assertIn(f"({chart}.svg)".encode(), self.plain()["report.md"])

    def test_the_same_raw_files_give_the_same_bytes_whatever_the_user_s_own_settings(self):
        self.write("matplotlib/matplotlibrc", "lines.linewidth: 9\nfont.size: 30\nhatch.linewidth: 5\n")
        for kernels in ("Haswell", "SkylakeX"):  # two, since one of them may be what NumPy takes anyway
            with self.subTest(kernels):
                own = self.render_plain(self.path(kernels, "charts"), OPENBLAS_CORETYPE=kernels)
                self.assertTrue(own == self.plain())  # some megabytes

    def test_other_measurements_give_other_files_and_long_runs_may_be_left_out(self):
        plain = self.plain()
        for each in self.map["maps"]:
            each["critical"] = None
            each["trials"] = [trial(each["integrator"], each["n"], h_norm_B, 0.3) for h_norm_B in GRID]
        self.assert_renders(self.raw(), "--out", self.path("second"))
        second = snapshot(self.path("second"))
        self.assertEqual(set(second), MAP_ONLY)
        for name, contents in second.items():
            self.assertTrue(contents != plain[name], name)  # without printing them


class FailureMaps(StabilityTest):
    def test_what_is_drawn(self):
        each = next(each for each in self.map["maps"]
                    if (each["scene"], each["n"], each["integrator"]) == ("smooth", 129, "group2"))
        each["trials"][-1]["status"], each["trials"][-2]["status"] = "stagnated", "sweep cap"
        smooth, others = self.drawn(("failure_map", "smooth"), ("failure_map_others", "smooth"))
        self.assertEqual(list(smooth["panels"]), [f"{each}{s}" for s in (1, 2, 3) for each in programs.FORMULATIONS])
        self.assertEqual(list(others["panels"]), ["yoshida4", "rkmk4", "rk4"])
        (panel,) = smooth["panels"]["group2"]
        with self.subTest("a cell for each trial, around its h‖B‖₂, hatched by what became of it"):
            self.assertEqual(len(panel["cells"]), 2 * len(GRID))
            for (column, bottom, top, hatch), h_norm_B in zip(panel["cells"], [*GRID, *GRID]):
                self.assertTrue(bottom < h_norm_B < top)
                self.assertEqual(not hatch, h_norm_B <= 1.5, (column, h_norm_B))
            hatches = [hatch for column, _, _, hatch in panel["cells"] if column == 1 and hatch]
            self.assertEqual((len(hatches), len(set(hatches))), (6, 3))
        with self.subTest("the critical line and linear theory, and none where nothing failed"):
            self.assertEqual(panel["lines"]["measured critical"], [[x, 1.5] for x in (-0.5, 0.5, 0.5, 1.5)])
            (midpoint,) = smooth["panels"]["algebra1"]
            self.assertEqual({y for _, y in midpoint["lines"]["linear theory"]}, {2.0})
            self.assertEqual(others["panels"]["rkmk4"][0]["lines"], {"measured critical": [], "linear theory": []})


class LongRuns(StabilityTest):
    def test_what_is_drawn(self):
        kept, controls = self.drawn(("long_runs", "smooth", 17), ("long_runs_controls", "smooth", 17))
        edge, inside = "{}, 0.9 of the critical step", "{}, 0.3 of the critical step"
        (panel,) = kept["panels"][inside.format("spectrum error")]
        run = next(each for each in self.long["runs"] if (each["integrator"], each["share"]) == ("group2", 0.3))
        with self.subTest("a point for each sample"):
            self.assertEqual(panel["lines"]["group2"],
                             [[each["time"], each["spectrum_error"]] for each in run["samples"]])
        with self.subTest("integrators that lose the spectrum are apart"):
            self.assertNotIn("rk4", panel["lines"])
            (lost,) = controls["panels"][inside.format("spectrum error")]
            self.assertEqual(set(lost["lines"]), {"rk4", CONTROL})
        with self.subTest("a failure is drawn up to its step and marked there"):
            (lost,) = controls["panels"][edge.format("spectrum error")]
            self.assertLess(lost["lines"]["rk4"][-1][0], 500 * 0.9 * 2.0 / norm(17))
            self.assertEqual(lost["crosses"], [lost["lines"]["rk4"][-1]])


class Refusals(StabilityTest):
    def assert_nothing_written(self, arguments, *parts):
        self.assert_refused(self.render(*arguments, "--out", self.path("charts")), *parts)
        self.assertFalse(os.path.exists(self.path("charts")))

    def test_one_file_for_the_other(self):
        self.assert_nothing_written([self.raw_long()], "long.json", "was not written by stability")
        self.assert_nothing_written([self.raw(), "--long", self.raw()], "map.json", "was not written by long_runs")


if __name__ == "__main__":
    unittest.main()
