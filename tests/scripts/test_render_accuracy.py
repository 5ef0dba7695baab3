"""Tests of what accuracy renders, on a made-up study: by running it as a user does, and by what its charts draw."""

import math
import os
import shutil
import sys
import unittest
from unittest import mock

import programs
from drawing import PYTHON, DrawingTest, finite_points, lines_of
from programs import snapshot
from study_documents import (INTEGRATORS, ROUGH, accuracy_of, comparison_row, run_of, small_study, study_document,
                             write_study)

from studies.accuracy.schema import CUT
from lib.records.formats import LISTED, listed

MODULES = {"error_against_time": "charts", "error_against_n": "charts", "time_against_n": "equal_error_charts",
           "performance_profile": "equal_error_charts"}
CHARTS = tuple(MODULES)
KINDS = ("svg", "png")


def with_sizes(sizes):
    """Returns the document with problems of other n, {n: whose data they have}."""
    document = study_document()
    for table, rows in document.items():
        if isinstance(rows, list) and "n" in rows[0]:
            document[table] = [{**row, "n": n} for n, like in sizes.items() for row in rows if row["n"] == like]
    return document


def comparison_of(document, candidate, n, wanted=1e-6, scene="smooth"):
    """Returns a row of a comparison, to be changed there."""
    row = {"candidate": candidate, "n": n, "wanted": wanted, "scene": scene}
    return next(each for each in document["comparisons"] if row.items() <= each.items())


def slower(row, factor):
    row.update(cpu_seconds=[factor * seconds for seconds in row["cpu_seconds"]])


def texts(panel):
    return [text.get_text() for text in panel.texts]


def title_of(panel):
    return " ".join(panel.figure.texts[0].get_text().split())


def panel_note(panels):
    """Returns the note under some panels."""
    return next(iter(panels.values())).figure.texts[-1].get_text()


def marks(panel, label):
    """Returns the points of marks that are no line."""
    return [point for line in panel.lines if line.get_label() == label for point in finite_points(line)]


class AccuracyTest(DrawingTest):
    package = "accuracy"

    def small(self):
        """Returns the raw file of a study that is drawn in a second or two, where only the files matter."""
        return write_study(self.folder, small_study(), "small.json")

    def without(self):
        """Returns a folder for PYTHONPATH with which a Python has no matplotlib."""
        self.write("broken/matplotlib.py", "raise ImportError('not here')\n")
        return self.path("broken")

    def drawn(self, chart, document):
        """Returns the panels of a chart by their titles."""
        panels = self.panels(f"studies.accuracy.{MODULES[chart]}", chart, accuracy_of(document))
        return {title: panel for title, (panel,) in panels.items()}


class Files(AccuracyTest):
    def test_whole_and_the_same_by_a_chosen_python_under_a_user_s_own_settings_on_other_kernels(self):
        study = write_study(self.folder)
        files = self.rendered("plain", study)
        self.assertEqual(set(files), {"report.md", "figures.json", "findings.json", *(
            f"{chart}.{kind}" for chart in CHARTS for kind in KINDS)})
        for chart in CHARTS:
            self.assert_whole(files, chart)
            self.assertIn(f"({chart}.svg)".encode(), files["report.md"])
        for name, contents in files.items():
            for word in (b"<dc:date", b"Software", b"Matplotlib v", self.folder.encode()):
                self.assertNotIn(word, contents, name)
        self.write("matplotlib/matplotlibrc", "lines.linewidth: 9\nfont.size: 30\naxes.facecolor: red\n")
        chosen = self.write("bin/chosen", f'#!/bin/sh\necho chosen >> {self.path("calls")}\nunset PYTHONPATH\n'
                                          f'exec {PYTHON} "$@"\n', executable=True)
        again = self.rendered("new/charts", study, PYTHONPATH=self.without(), ISOSYRK_PYTHON=chosen,
                              OPENBLAS_CORETYPE="Haswell")
        self.assertTrue(os.path.exists(self.path("calls")))
        self.assertTrue(again == files)  # some megabytes

    def test_what_is_recorded_is_svg_and_markdown_only(self):
        shutil.copytree(os.path.join(programs.ROOT, "scripts"), self.path("root", "scripts"))  # whose results/ this is
        limits = ("results", "recorded", "limits")
        shutil.copytree(os.path.join(programs.ROOT, *limits), self.path("root", *limits))
        shutil.copy(LISTED, self.path("root", "results", "recorded"))
        out = self.path("root", "results", "recorded", "study")
        with mock.patch.object(programs, "RENDER", self.path("root", "scripts", "render")):
            self.assertEqual(self.render(write_study(self.folder), "--out", out).returncode, 0)
        self.assertEqual(set(os.listdir(out)), {"report.md", "figures.json", "findings.json",
                                                *(f"{chart}.svg" for chart in CHARTS)})

    def test_no_chart_without_data(self):
        def drawn(document):
            study = accuracy_of(document)
            return {name for name, module in MODULES.items()
                    if getattr(self.module(f"studies.accuracy.{module}"), name)(study)}

        one_size = small_study()
        self.assertEqual(drawn(one_size), {"error_against_time", "time_against_n"})
        one_size["comparisons"] = [row for row in one_size["comparisons"] if row["wanted"] != 1e-6]
        self.assertEqual(drawn(one_size), {"error_against_time"})
        none = small_study()
        none["comparisons"] = []
        for table in ("runs", "lines"):
            none[table] = [row for row in none[table] if row["integrator"] == "group1"]
        self.assertEqual(drawn(none), set())


class ErrorAgainstTime(AccuracyTest):
    def test_lines_tolerances_and_labels(self):
        document = study_document()
        document["integrators"].append(listed("elp6_frame")._asdict())
        for table in ("runs", "lines"):
            document[table] += [{**row, "integrator": "elp6_frame"} for row in document[table]
                                if (row["integrator"], row["tolerance"]) == ("elp4_frame", 1e-8)]
        (panel,) = self.drawn("error_against_time", document).values()
        self.assertEqual(panel.get_title(loc="left"), "n = 17")  # 33 is not of the sizes drawn
        lines = lines_of(panel)
        self.assertEqual(list(lines), ["elp4_frame at 1e-13", "elp6_frame at 1e-08", "rk4 at 1e-13"])
        self.assertEqual(sorted(texts(panel)), ["elp4, 1e-13", "elp6, 1e-8", "rk4, no frame"])
        styles = {line.get_label(): line.get_linestyle() for line in panel.lines}
        # A loose exponential method keeps the spectrum only.
        self.assertEqual([styles[name] for name in lines], ["-", "--", ":"])
        for name, seconds_a_step in (("elp4_frame at 1e-13", 2e-3), ("elp6_frame at 1e-08", 1e-3)):
            for error, seconds in lines[name]:
                steps = seconds / seconds_a_step / 0.99  # the least of the repetitions
                self.assertAlmostEqual(error / (1e-2 * (5 / steps)**4), 1)

    def test_marks_are_the_rows_at_equal_error_that_the_title_compares(self):
        document = study_document()
        (panel,) = self.drawn("error_against_time", document).values()
        rows = [comparison_of(document, candidate, 17) for candidate in ("elp_bounded", "explicit")]  # that have a line
        means = [row["cpu_seconds"][2] for row in rows]
        self.assertEqual(len(marks(panel, "_timed")), 2)
        for (error, seconds), row, mean in zip(marks(panel, "_timed"), rows, means):
            self.assertEqual(error, row["error"])
            self.assertAlmostEqual(seconds / mean, 1, 2)
        self.assertIn(f"{means[0] / means[1]:.2g} times as long", title_of(panel))

    def test_no_line_across_a_failure_or_beyond_a_limit(self):
        document = study_document()
        run_of(document, "rk4", 17, 20)["beyond_limit"] = True
        run_of(document, "rk4", 17, 100).update(status="diverged", cpu_seconds=[])
        (panel,) = self.drawn("error_against_time", document).values()
        lines = [line.get_ydata() / INTEGRATORS["rk4"][-1] for line in panel.lines
                 if line.get_label() == "rk4 at 1e-13"]
        self.assertEqual([[round(steps / 0.99) for steps in line] for line in lines], [[5, 10], [50], [200]])

    def test_the_end_of_a_cut_line_is_marked(self):
        document = with_sizes({17: 17, 65: 33})
        self.assertEqual(marks(self.drawn("error_against_time", document)["n = 65"], "_cut"), [])
        for line in document["lines"]:
            line.update(end=CUT if (line["integrator"], line["n"]) == ("rk4", 65) else line["end"])
        panels = self.drawn("error_against_time", document)
        ends = marks(panels["n = 65"], "_cut")
        self.assertEqual(ends, lines_of(panels["n = 65"])["rk4 at 1e-13"][-1:])
        self.assertEqual(marks(panels["n = 17"], "_cut"), [])

    def test_panels_have_equal_decades_and_no_labels_overlap(self):
        document = with_sizes({17: 17, 33: 33, 65: 33, 129: 33})
        for run in document["runs"]:
            run.update(cpu_seconds=[run["n"]**2 * seconds for seconds in run["cpu_seconds"]])
        panels = self.drawn("error_against_time", document)
        self.assertEqual(list(panels), ["n = 17", "n = 65", "n = 129"])
        decades = {round(math.log10(panel.get_ylim()[1] / panel.get_ylim()[0]), 9) for panel in panels.values()}
        self.assertEqual((len(decades), {panel.get_xlim() for panel in panels.values()}), (1, {(1e-2, 1e-9)}))
        for panel in panels.values():
            places = sorted(text.xy[1] * panel.bbox.height for text in panel.texts)
            high = panel.texts[0].get_fontsize() / 72 * panel.figure.dpi
            self.assertTrue(all(above - below > high for below, above in zip(places, places[1:])), places)

    def test_other_sizes(self):
        for sizes, drawn in (((5, 9), (5, 9)), ((5, 9, 33, 131), (5, 33, 131)), ((9, 17, 131), (17,))):
            panels = self.drawn("error_against_time", with_sizes(dict.fromkeys(sizes, 17)))
            self.assertEqual(list(panels), [f"n = {n}" for n in drawn])

    def test_the_title_tells_of_the_largest_size(self):
        def title():
            return title_of(next(iter(self.drawn("error_against_time", document).values())))

        document = with_sizes({17: 17, 65: 33})
        told = ("What structure costs: at n = 65 and error 1e-6 elp4, with bounded energy, takes {}as long as rk4, the"
                " best explicit method; group2 (order 4), the best Gauss method, 40 times as long")
        self.assertEqual(title(), told.format("20 times "))
        slower(comparison_of(document, "elp_bounded", 65), 3)
        self.assertEqual(title(), told.format("60 times "))
        slower(comparison_of(document, "elp_bounded", 17), 3)  # of no panel that the title tells of
        self.assertEqual(title(), told.format("60 times "))
        slower(comparison_of(document, "elp_bounded", 65), 1 / 60)
        self.assertEqual(title(), told.format(""))
        document["comparisons"].remove(comparison_of(document, "elp_bounded", 65))
        self.assertIn("group2 (order 4), the best Gauss method, takes 40 times as long as rk4", title())
        document["comparisons"] = [row for row in document["comparisons"] if row["candidate"] != "explicit"]
        self.assertEqual(title(), "What structure costs: CPU seconds of errors")

    def test_long_times_are_drawn_where_there_are_any(self):
        document = study_document()
        for table in ("references", "lines", "runs"):
            document[table] += [{**row, "time": 50.0} for row in document[table]
                                if (row["scene"], row["n"]) == ("smooth", 17)]
        for row in document["runs"]:
            if row["time"] == 50.0 and row["cpu_seconds"]:
                slower(row, 10)
        (panel,) = self.drawn("error_against_time", document).values()
        (_, long), *_ = lines_of(panel)["rk4 at 1e-13"]
        (panel,) = self.drawn("error_against_time", study_document()).values()
        self.assertAlmostEqual(long / lines_of(panel)["rk4 at 1e-13"][0][1], 10)
        self.assertIn("T = 50", panel_note(self.drawn("error_against_time", document)))


class TimeAgainstN(AccuracyTest):
    def test_classes_by_size(self):
        document = study_document()
        document["comparisons"].append({**comparison_of(document, "rkmk", 33), "candidate": "magnus"})
        slower(document["comparisons"][-1], 0.5)
        (panel,) = self.drawn("time_against_n", document).values()
        self.assertEqual(panel.get_title(loc="left"), "smooth scene, T = 5")
        lines = lines_of(panel)
        self.assertEqual(set(lines), set(texts(panel)))
        self.assertEqual(list(lines), ["Gauss", "exponential, bounded energy", "exponential, 1e-8", "Magnus",
                                       "best explicit"])
        ratios = {name: [value for _, value in line] for name, line in lines.items()}
        for name, expected in (("Gauss", (40, 40)), ("best explicit", (1, 1)), ("Magnus", (2.9,)),
                               ("exponential, bounded energy", (20, 20)), ("exponential, 1e-8", (10, 10))):
            for found, wanted in zip(ratios[name], expected, strict=True):
                self.assertAlmostEqual(found / wanted, 1, 2)
        self.assertEqual({tuple(n for n, _ in line) for name, line in lines.items() if name != "Magnus"}, {(17, 33)})

    def test_other_problems_than_the_main_one_on_equal_axes(self):
        document = study_document()
        document["references"].append({**document["references"][-1], "scene": "developed"})
        for scene in ("rough", "developed"):
            document["comparisons"] += [{**comparison_row(ROUGH, 1e-6, candidate), "scene": scene}
                                  for candidate in ("elp", "explicit")]
        slower(document["comparisons"][-1], 1e3)
        panels = self.drawn("time_against_n", document)
        self.assertEqual(list(panels), ["rough scene, T = 5", "developed scene, T = 5"])
        self.assertEqual(len({(panel.get_xlim(), panel.get_ylim()) for panel in panels.values()}), 1)
        self.assertEqual([set(texts(panel)) for panel in panels.values()],  # each label once
                         [set(), {"exponential, 1e-8", "best explicit"}])

    def test_a_line_is_broken_where_its_class_has_no_row(self):
        document = with_sizes({17: 17, 33: 33, 65: 33})
        document["comparisons"].remove(comparison_of(document, "gauss", 33))
        (panel,) = self.drawn("time_against_n", document).values()
        sizes = [list(line.get_xdata()) for line in panel.lines if line.get_label() == "Gauss"]
        self.assertEqual(sizes, [[17], [65]])

    def test_the_title_follows_the_rows(self):
        def title():
            return title_of(next(iter(self.drawn("time_against_n", document).values())))

        document = study_document()
        first = "In {} of 2 cases no class is faster than the best explicit method; exponential methods with bounded"
        self.assertEqual(title(), first.format(2) + " energy take 20 times its time; Gauss methods take 40 times its"
                         " time")
        slower(comparison_of(document, "explicit", 33), 80)
        self.assertEqual(title(), first.format(1) + " energy take 0.25 to 20 times its time; Gauss methods take 0.5 to"
                         " 40 times its time")
        document["comparisons"] = [row for row in document["comparisons"] if row["candidate"] == "gauss"]
        self.assertIsNone(self.module("studies.accuracy.equal_error_charts").time_against_n(accuracy_of(document)))


class PerformanceProfile(AccuracyTest):
    def shares(self, document):
        """Returns the points (factor, share) of each line, by the first line of its label."""
        (panel,) = self.drawn("performance_profile", document).values()
        return {line.get_label().split(":")[0]: finite_points(line) for line in panel.lines}, title_of(panel)

    def test_a_line_rises_at_the_factors_of_its_class(self):
        document = study_document()
        slower(comparison_of(document, "elp", 33), 2)
        lines, title = self.shares(document)
        self.assertIn("Of 4 cases", title)
        times = {(row["n"], row["wanted"]): row["cpu_seconds"][2] for row in document["comparisons"]
                 if row["candidate"] == "explicit"}
        factors = sorted(row["cpu_seconds"][2] / times[row["n"], row["wanted"]] for row in document["comparisons"]
                         if row["candidate"] == "elp")
        (_, first), *steps, (_, last) = lines["exponential, 1e-8"]
        self.assertEqual((first, last), (0, 1))
        for (factor, share), wanted, count in zip(steps, factors, (1, 2, 3, 4), strict=True):
            self.assertAlmostEqual(factor / wanted, 1)
            self.assertGreaterEqual(share, count / 4)
        self.assertEqual(lines["best explicit"][0], [1, 1])  # the cheapest everywhere

    def test_a_class_without_a_row_has_not_solved_the_case(self):
        document = study_document()
        document["comparisons"].remove(comparison_of(document, "gauss", 33))
        lines, _ = self.shares(document)
        self.assertEqual((lines["Gauss"][-1][1], lines["best explicit"][-1][1]), (0.75, 1))

    def test_the_cheapest_method_may_be_of_any_class_of_fast_forms(self):
        document = study_document()
        for candidate in ("gauss_matched", "named_published"):  # neither is drawn; published forms do not count
            slower(comparison_of(document, candidate, 33), 1e-4)
        lines, title = self.shares(document)
        self.assertEqual(lines["best explicit"][0], [1, 0.75])
        self.assertIn("in 75 %", title)
        self.assertGreater(lines["best explicit"][-2][0], 1.05)

    def test_the_report_says_how_to_read_it_and_of_which_cases(self):
        report = self.rendered("out", write_study(self.folder))["report.md"].decode()
        self.assertIn("smooth scene, T = 5, n = 17 to 33; errors 1e-4, 1e-6.](performance_profile.svg)", report)


class ErrorAgainstN(AccuracyTest):
    def test_the_same_step_at_each_n_in_the_tight_tolerance(self):
        document = study_document()
        for line in ("runs", "lines"):  # a line at a loose tolerance, which is not drawn
            document[line] += [{**row, "tolerance": 1e-7, **({"error": 0.5} if line == "runs" else {})}
                               for row in document[line] if row["integrator"] == "group2"]
        (panel,) = self.drawn("error_against_n", document).values()
        lines = lines_of(panel)
        self.assertEqual({name: [n for n, _ in line] for name, line in lines.items()},
                         dict.fromkeys(("group1", "group2", "rkmk4", "rk4"), [17, 33]))
        for name, error in (("group1", 1e-2), ("group2", 1e-5), ("rkmk4", 1e-7), ("rk4", 1e-6)):
            self.assertAlmostEqual(lines[name][0][1] / error, 1)
        self.assertEqual(sorted(texts(panel)), ["group1 (order 2)", "group2 (order 4)", "rk4", "rkmk4"])
        self.assertEqual(marks(panel, "_failure"), [])

    def test_failures_break_lines_and_are_marked(self):
        document = with_sizes({17: 17, 33: 33, 65: 33})
        run_of(document, "rk4", 33, 50)["beyond_limit"] = True
        run_of(document, "group1", 65, 50).update(status="diverged", cpu_seconds=[])
        document["runs"].remove(run_of(document, "rkmk4", 65, 50))  # not tried
        (panel,) = self.drawn("error_against_n", document).values()
        sizes = {name: [list(line.get_xdata()) for line in panel.lines if line.get_label() == name]
                 for name in ("rk4", "group1", "rkmk4", "group2")}
        self.assertEqual(sizes, {"rk4": [[17], [65]], "group1": [[17, 33]], "rkmk4": [[17, 33]],
                                 "group2": [[17, 33, 65]]})
        lines = lines_of(panel)
        self.assertEqual(sorted(marks(panel, "_failure")), sorted((
            [17, run_of(document, "rk4", 17, 50)["error"]], lines["group1"][-1])))

    def test_the_title_follows_the_errors(self):
        def title():
            return title_of(next(iter(self.drawn("error_against_n", document).values())))

        document = study_document()
        told = "from n = 17 to n = 33 the error at h = 0.1 is multiplied by {} for group2 and by {} for rkmk4"
        self.assertEqual(title(), f"The error of one step size: {told.format(1, 1)}")
        run_of(document, "group2", 33, 50)["error"] *= 50
        run_of(document, "rkmk4", 33, 50)["error"] /= 2
        self.assertEqual(title(), f"One step size is not one accuracy: {told.format(50, 0.5)}")
        for name in ("group2", "rkmk4"):
            document["runs"].remove(run_of(document, name, 33, 50))
        self.assertEqual(title(), "Error of one step size, h = 0.1, against n")


class Refusals(AccuracyTest):
    def test_one_line_and_nothing_written(self):
        folder = ("--out", self.path("charts"))
        nowhere = {"PYTHONPATH": self.without(), "ISOSYRK_PYTHON": sys.executable, "PATH": self.path("empty")}
        for arguments, changes, *words in (
                ((self.small(), "--out", self.write("taken", "kept")), {}, "taken", "cannot be written"),
                ((self.small(), *folder, "--colour"), {}, "--colour"),
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
