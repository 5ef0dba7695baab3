"""Tests of scripts/render_stability on made-up files: by running it as a user does, and by what its charts draw."""

import os
import unittest

from drawing import DrawingTest, finite_points, lines_of
from integrator_names import TABLE1_CELLS, others
from stability_documents import CONTROL, GRID, LOST_AT, SETTINGS, long_study, map_study, norm, write

from stability_files import FAST, failure_map, long_runs

MAPS = tuple(f"failure_map{kind}_{scene}" for kind in ("", "_others") for scene in ("smooth", "rough"))
FAST_MAPS = ("failure_map_fast_smooth", "failure_map_fast_rough")
LONG_RUNS = ("long_runs_n17", "long_runs_n17_controls")
FEW = ("group1", "rk4")  # where only the files matter, less is drawn faster


def files_of(*charts):
    return {"report.md", "report.txt", *(f"{chart}.{kind}" for chart in charts for kind in ("svg", "png"))}


class StabilityTest(DrawingTest):
    script = "render_stability"

    def raw(self, solver="published", names=FEW):
        study = map_study((SETTINGS[0], SETTINGS[2]), names, solver)
        return write(self.folder, study, f"{solver}.json")

    def raw_long(self):
        return write(self.folder, long_study((*FEW, CONTROL)), "long.json")


class Files(StabilityTest):
    def test_every_chart_is_whole_and_shown_and_the_same_under_a_user_s_own_settings_on_other_kernels(self):
        arguments = (self.raw(), "--long", self.raw_long(), "--fast", self.raw(FAST, FEW[:1]))
        files = self.rendered("plain", *arguments)
        charts = (*MAPS, *FAST_MAPS, *LONG_RUNS)
        self.assertEqual(set(files), files_of(*charts))
        for chart in charts:
            self.assert_whole(files, chart)
            self.assertIn(f"({chart}.svg)".encode(), files["report.md"])
        self.assertIn("Critical h‖B(W₀)‖₂ of the fast forms\n", files["report.txt"].decode())
        self.write("matplotlib/matplotlibrc", "lines.linewidth: 9\nfont.size: 30\nhatch.linewidth: 5\n")
        self.assertTrue(self.rendered("own/charts", *arguments, OPENBLAS_CORETYPE="Haswell") == files)

    def test_long_runs_and_fast_forms_may_be_left_out(self):
        self.assertEqual(set(self.rendered("maps", self.raw())), files_of(*MAPS))

    def test_one_file_is_not_taken_for_another(self):
        for arguments, words in (([self.raw_long()], "no raw file of the study stability"),
                                 ([self.raw(), "--long", self.raw()], "no raw file of the study long_runs"),
                                 ([self.raw(), "--fast", self.raw()], "no map of the fast"),
                                 ([self.raw(FAST)], "no map of the published")):
            self.assert_refused(self.render(*arguments, "--out", self.path("charts")), ".json", words)
            self.assertFalse(os.path.exists(self.path("charts")))


class Charts(StabilityTest):
    def test_failure_maps(self):
        study = map_study()
        trials = study.tables["trials"]
        last = max(k for k, each in enumerate(trials) if each[:3] == ("smooth", 129, "group2"))
        trials[last - 1] = trials[last - 1]._replace(status="sweep cap")
        trials[last] = trials[last]._replace(status="stagnated")
        failures = failure_map(study, "published")
        smooth, rest = (self.panels("stability_charts", "failure_map", failures, "smooth", names, "Map")
                        for names in (TABLE1_CELLS, others(failures.integrators)))
        self.assertEqual((list(smooth), list(rest)), (list(TABLE1_CELLS), ["yoshida4", "rkmk4", "rk4"]))
        (panel,) = smooth["group2"]
        with self.subTest("a cell for each trial, around its h‖B‖₂, coloured by what became of it"):
            self.assertEqual(len(panel.patches), 2 * len(GRID))
            for patch, h_norm_B in zip(panel.patches, [*GRID, *GRID]):
                self.assertTrue(patch.get_y() < h_norm_B < patch.get_y() + patch.get_height())
            colours = [patch.get_facecolor() for patch in panel.patches]
            works = {colour for colour, h_norm_B in zip(colours, [*GRID, *GRID]) if h_norm_B <= 1.5}
            failed = {colour for colour, h_norm_B in zip(colours, [*GRID, *GRID]) if h_norm_B > 1.5}
            self.assertEqual((len(failed), works & failed), (3, set()))
        with self.subTest("the critical line and linear theory, and none where nothing failed"):
            self.assertEqual(lines_of(panel)["measured critical"], [[x, 1.5] for x in (-0.5, 0.5, 0.5, 1.5)])
            (midpoint,) = smooth["algebra1"]
            self.assertEqual({y for _, y in lines_of(midpoint)["linear theory"]}, {2.0})
            self.assertEqual(lines_of(rest["rkmk4"][0]), {"measured critical": [], "linear theory": []})

    def test_long_runs(self):
        runs = long_runs(long_study())
        kept, controls = (self.panels("stability_charts", "long_runs", runs, "smooth", 17, isospectral)
                          for isospectral in (True, False))
        (panel,) = kept["0.3 of the critical step"]
        with self.subTest("a point for each sample"):
            run = runs.at("smooth", 17, 0.3, "group2")
            self.assertEqual(lines_of(panel)["group2"],
                             [[each.step * run.row.step, each.spectrum_error] for each in run.samples])
        with self.subTest("integrators that lose the spectrum are apart"):
            self.assertNotIn("rk4", lines_of(panel))
            (lost,) = controls["0.9 of the critical step"]
            self.assertEqual(set(lines_of(lost)), {"rk4", CONTROL})
        with self.subTest("a failure is drawn up to its step and marked there"):
            last = lines_of(lost)["rk4"][-1]
            self.assertLess(last[0], LOST_AT * 0.9 * 2.0 / norm(17))
            self.assertEqual([finite_points(line) for line in lost.lines if line.get_label() == "_failure"], [[last]])


if __name__ == "__main__":
    unittest.main()
