"""Tests of what is made of the raw files of stability and long runs: refusals, report, charts, and render_stability."""

import os
import unittest

from drawing import DrawingTest, finite_points, lines_of
from stability_documents import CONTROL, SETTINGS, long_study, map_study, write

from lib.messages import UnusableFile
from lib.document import as_markdown
from lib.formats import FAST, PUBLISHED
from lib.integrator_names import TABLE1_CELLS
from lib.stability_files import Sample, failure_map, long_runs
from lib.stability_report import stability_sections

MAPS = tuple(f"failure_map{kind}_{scene}" for kind in ("", "_others") for scene in ("smooth", "rough"))
FAST_MAPS = ("failure_map_fast_smooth", "failure_map_fast_rough")
LONG_RUNS = ("long_runs_n17", "long_runs_n17_controls")
FEW = ("group1", "rk4")  # where only the files matter, less is drawn faster


class RawFiles(unittest.TestCase):
    def test_files_without_content_are_refused(self):
        for make, read, table in ((map_study, lambda study: failure_map(study, PUBLISHED), "maps"),
                                  (long_study, long_runs, "runs")):
            study = make()
            study.tables[table] = []
            with self.subTest(table=table), self.assertRaisesRegex(UnusableFile, f"no {table}"):
                read(study)


class Report(unittest.TestCase):
    def setUp(self):
        self.map, self.long = map_study(SETTINGS, FEW), long_study()

    def row(self, name, heading):
        """Returns the cells of an integrator in the first table after a heading that has it."""
        report = as_markdown(stability_sections(failure_map(self.map, PUBLISHED), long_runs(self.long), ()))
        lines = report.replace("\\", "").split(f"# {heading}", 1)[1].splitlines()
        line = next(line for line in lines if line.startswith(f"| {name} "))
        return [cell.strip() for cell in line.strip("|").split(" | ")]

    def test_methods_that_always_or_never_work(self):
        tables = self.map.tables
        tables["maps"] = [each._replace(works=None, fails=None, fails_as=None) for each in tables["maps"]]
        for status, largest, fails_as in (("converged", "> 11.3", "–"), ("unstable", "< 0.125", "unstable")):
            tables["trials"] = [each._replace(status=status) for each in tables["trials"]]
            self.assertEqual(self.row("rk4", "Smooth scene"), ["rk4", largest, largest, fails_as])

    def test_largest_errors_of_long_runs(self):
        first, second = self.long.tables["runs"][:2]
        self.long.tables["runs"][:2] = first._replace(status="unstable", steps=7), second._replace(status="converged")
        samples = [Sample(1, 1, 1e-15, 2e-15, 1e-3, 0.0), Sample(1, 2, 4e-15, None, 1e-4, 0.0)]
        self.long.tables["samples"] = samples  # the first run has none
        self.assertEqual(self.row(first.integrator, "Largest errors of long runs")[1:],
                         ["unstable", "7", *"––––", "converged", str(second.steps), "4.0e-15", "0",
                          "2.0e-15", "1.0e-3"])

    def test_energy_of_the_runs_that_came_through(self):
        self.long.tables["runs"] = [run._replace(status="converged" if run.integrator == "group1" else "unstable")
                                    for run in self.long.tables["runs"]]
        numbers = [number for number, run in enumerate(self.long.tables["runs"]) if run.integrator == "group1"]
        self.long.tables["samples"] = [Sample(number, 1, 0.0, 0.0, 1e-3 * (place + 1), 0.0)
                                       for place, number in enumerate(numbers)]
        self.assertEqual(self.row("the Lie–Poisson structure", "Largest errors of long runs"),
                         ["the Lie–Poisson structure", str(len(numbers)), "1.0e-3", f"{len(numbers)}.0e-3"])


class Files(DrawingTest):
    script = "render_stability"

    def raw(self, solver=PUBLISHED, names=FEW):
        study = map_study((SETTINGS[0], SETTINGS[2]), names, solver)
        return write(self.folder, study, f"{solver}.json")

    def raw_long(self):
        return write(self.folder, long_study((*FEW, CONTROL)), "long.json")

    def test_every_chart_is_whole_and_shown(self):
        arguments = (self.raw(), "--long", self.raw_long(), "--fast", self.raw(FAST, FEW[:1]))
        files = self.rendered("plain", *arguments)
        charts = (*MAPS, *FAST_MAPS, *LONG_RUNS)
        self.assertEqual(set(files), {"report.md", *(f"{chart}.{kind}" for chart in charts for kind in ("svg", "png"))})
        for chart in charts:
            self.assert_whole(files, chart)
            self.assertIn(f"({chart}.svg)".encode(), files["report.md"])
        self.assertIn("# Critical h‖B(W₀)‖₂ of the fast forms\n", files["report.md"].decode())

    def test_long_runs_and_fast_forms_may_be_left_out(self):
        files = self.rendered("maps", self.raw())
        self.assertEqual({name[:-4] for name in files if name.endswith(".svg")}, set(MAPS))
        self.assertNotIn(b"Largest errors", files["report.md"])

    def test_one_file_is_not_taken_for_another(self):
        for arguments, words in (([self.raw_long()], "no raw file of the study stability"),
                                 ([self.raw(), "--long", self.raw()], "no raw file of the study long_runs"),
                                 ([self.raw(), "--fast", self.raw()], "no map of the fast"),
                                 ([self.raw(FAST)], "no map of the published")):
            self.assert_refused(self.render(*arguments, "--out", self.path("charts")), ".json", words)
            self.assertFalse(os.path.exists(self.path("charts")))


class Charts(DrawingTest):
    def test_failure_maps(self):
        study = map_study()
        trials, edges = study.tables["trials"], study.tables["maps"]
        last = max(k for k, each in enumerate(trials) if each[:3] == ("smooth", 129, "group2"))
        trials[last - 2:last + 1] = [each._replace(status=status) for each, status in
                                     zip(trials[last - 2:], ("diverged", "sweep cap", "stagnated"))]
        edges[:] = [each if each.integrator != "rkmk4" else each._replace(works=None) for each in edges]
        failures = failure_map(study, PUBLISHED)
        smooth, rest = (self.panels("stability_charts", "failure_map", failures, "smooth", names, "Map")
                        for names in (TABLE1_CELLS, [name for name in failures.integrators
                                                     if name not in TABLE1_CELLS]))
        self.assertEqual((list(smooth), list(rest)), (list(TABLE1_CELLS), ["yoshida4", "rkmk4", "rk4"]))
        (panel,) = smooth["group2"]
        maps = failures.line("smooth", "group2")
        with self.subTest("a cell for each trial, around its h‖B‖₂, coloured by what became of it"):
            colours = {True: set(), False: set()}
            trials = [trial for each in maps for trial in each.trials]
            self.assertEqual(len(panel.patches), len(trials))
            for patch, trial in zip(panel.patches, trials):
                self.assertTrue(patch.get_y() < trial.h_norm_B < patch.get_y() + patch.get_height())
                colours[trial.works].add(patch.get_facecolor())
            self.assertGreaterEqual(len(colours[False]), 3)
            self.assertEqual(colours[True] & colours[False], set())
        with self.subTest("the critical line and linear theory, and none where nothing failed"):
            for label, level in (("measured critical", "works"), ("linear theory", "linear_limit")):
                values = [getattr(each.edge, level) for each in maps for _ in range(2)]
                self.assertEqual(lines_of(panel)[label], [list(each) for each in zip((-0.5, 0.5, 0.5, 1.5), values)])
            self.assertEqual(lines_of(rest["rkmk4"][0]), {"measured critical": [], "linear theory": []})

    def test_long_runs(self):
        study = long_study()
        rows = study.tables["runs"]
        rows[:] = [each._replace(status="unstable" if (each.integrator, each.share) == ("rk4", 0.9) else "converged")
                   for each in rows]
        runs = long_runs(study)
        kept, controls = (self.panels("stability_charts", "long_runs", runs, "smooth", 17, isospectral)
                          for isospectral in (True, False))
        (panel,) = kept["0.3 of the critical step"]
        with self.subTest("a point for each sample"):
            run = runs.runs["smooth", 17, "group2", 0.3]
            self.assertEqual(lines_of(panel)["group2"],
                             [[each.step * run.row.step, each.spectrum_error] for each in run.samples])
        with self.subTest("integrators that lose the spectrum are apart"):
            self.assertNotIn("rk4", lines_of(panel))
            (lost,) = controls["0.9 of the critical step"]
            self.assertEqual(set(lines_of(lost)), {"rk4", CONTROL})
        with self.subTest("a failure is marked after its last state"):
            self.assertEqual([finite_points(line) for line in lost.lines if line.get_label() == "_failure"],
                             [[lines_of(lost)["rk4"][-1]]])
