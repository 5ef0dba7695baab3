"""Tests of scripts/render_stability on made-up files: by running it as a user does, and by what its charts draw."""

import copy
import os
import unittest

import programs
from drawing import DrawingTest, finite_points, lines_of, panels_of
from programs import snapshot
from stability_documents import CONTROL, GRID, long_document, map_document, norm, write_document

from stability import failure_map, long_runs

MAPS = tuple(f"failure_map{others}_{scene}" for scene in ("smooth", "rough") for others in ("", "_others"))
LONG_RUNS = ("long_runs_n17", "long_runs_n17_controls")
MAP_ONLY = {"report.md", "report.txt", *(f"{chart}.{kind}" for chart in MAPS for kind in ("svg", "png"))}
FILES = MAP_ONLY | {f"{chart}.{kind}" for chart in LONG_RUNS for kind in ("svg", "png")}

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

    def drawn(self, chart, *arguments):
        """Returns the panels of a chart, in lists by their titles."""
        study = failure_map(self.map) if chart.startswith("failure") else long_runs(self.long)
        return panels_of(getattr(self.module("stability_charts"), chart)(study, *arguments))


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

    def test_the_same_bytes_on_other_kernels_under_a_user_s_own_settings(self):
        self.write("matplotlib/matplotlibrc", "lines.linewidth: 9\nfont.size: 30\nhatch.linewidth: 5\n")
        self.assertTrue(self.render_plain(self.path("own", "charts"), OPENBLAS_CORETYPE="Haswell") == self.plain())

    def test_long_runs_may_be_left_out(self):
        self.assert_renders(self.raw(), "--out", self.path("second"))
        self.assertEqual(set(os.listdir(self.path("second"))), MAP_ONLY)


class FailureMaps(StabilityTest):
    def test_what_is_drawn(self):
        each = next(each for each in self.map["maps"]
                    if (each["scene"], each["n"], each["integrator"]) == ("smooth", 129, "group2"))
        each["trials"][-1]["status"], each["trials"][-2]["status"] = "stagnated", "sweep cap"
        smooth, others = self.drawn("failure_map", "smooth"), self.drawn("failure_map_others", "smooth")
        self.assertEqual(list(smooth), [f"{each}{s}" for s in (1, 2, 3) for each in programs.FORMULATIONS])
        self.assertEqual(list(others), ["yoshida4", "rkmk4", "rk4"])
        (panel,) = smooth["group2"]
        with self.subTest("a cell for each trial, around its h‖B‖₂, hatched by what became of it"):
            cells = [(patch, h_norm_B) for patch, h_norm_B in zip(panel.patches, [*GRID, *GRID])]
            self.assertEqual(len(panel.patches), 2 * len(GRID))
            for patch, h_norm_B in cells:
                self.assertTrue(patch.get_y() < h_norm_B < patch.get_y() + patch.get_height())
                self.assertEqual(not patch.get_hatch(), h_norm_B <= 1.5)
            hatches = [patch.get_hatch() for patch, _ in cells[len(GRID):] if patch.get_hatch()]
            self.assertEqual((len(hatches), len(set(hatches))), (6, 3))
        with self.subTest("the critical line and linear theory, and none where nothing failed"):
            self.assertEqual(lines_of(panel)["measured critical"], [[x, 1.5] for x in (-0.5, 0.5, 0.5, 1.5)])
            (midpoint,) = smooth["algebra1"]
            self.assertEqual({y for _, y in lines_of(midpoint)["linear theory"]}, {2.0})
            self.assertEqual(lines_of(others["rkmk4"][0]), {"measured critical": [], "linear theory": []})


class LongRuns(StabilityTest):
    def test_what_is_drawn(self):
        kept, controls = (self.drawn(chart, "smooth", 17) for chart in ("long_runs", "long_runs_controls"))
        (panel,) = kept["spectrum error, 0.3 of the critical step"]
        run = next(each for each in self.long["runs"] if (each["integrator"], each["share"]) == ("group2", 0.3))
        with self.subTest("a point for each sample"):
            self.assertEqual(lines_of(panel)["group2"],
                             [[each["time"], each["spectrum_error"]] for each in run["samples"]])
        with self.subTest("integrators that lose the spectrum are apart"):
            self.assertNotIn("rk4", lines_of(panel))
            (lost,) = controls["spectrum error, 0.3 of the critical step"]
            self.assertEqual(set(lines_of(lost)), {"rk4", CONTROL})
        with self.subTest("a failure is drawn up to its step and marked there"):
            (lost,) = controls["spectrum error, 0.9 of the critical step"]
            last = lines_of(lost)["rk4"][-1]
            self.assertLess(last[0], 500 * 0.9 * 2.0 / norm(17))
            self.assertEqual([finite_points(line) for line in lost.lines if line.get_label() == "_failure"], [[last]])


class Refusals(StabilityTest):
    def assert_nothing_written(self, arguments, *parts):
        self.assert_refused(self.render(*arguments, "--out", self.path("charts")), *parts)
        self.assertFalse(os.path.exists(self.path("charts")))

    def test_one_file_for_the_other(self):
        self.assert_nothing_written([self.raw_long()], "long.json", "was not written by stability")
        self.assert_nothing_written([self.raw(), "--long", self.raw()], "map.json", "was not written by long_runs")


if __name__ == "__main__":
    unittest.main()
