"""Tests of what is made of the raw file of the study of limits: refusals, report, figures, charts, advice."""

import unittest

from drawing import DrawingTest, lines_of
from limits_documents import CLOSE, CRITICAL, NORM_B, SIZES, limits_study, write

from lib.document import as_markdown
from lib.formats import FAST, PUBLISHED
from lib.limits_files import LETTERS, limits_of
from lib.limits_report import figures, sections
from lib.messages import UnusableFile


class RawFiles(unittest.TestCase):
    def test_what_cannot_be_used_is_refused(self):
        study = limits_study()
        study.tables["limits"][0] = study.tables["limits"][0]._replace(grid="++?")
        with self.assertRaisesRegex(UnusableFile, "unknown outcomes"):
            limits_of(study)
        study.tables["limits"] = []
        with self.assertRaisesRegex(UnusableFile, "no limits"):
            limits_of(study)

    def test_every_outcome_has_a_letter_of_its_own(self):
        self.assertEqual(len(set(LETTERS.values())), len(LETTERS))


class Questions(unittest.TestCase):
    def setUp(self):
        self.limits = limits_of(limits_study())

    def test_the_least_over_states_and_scenes(self):
        self.assertAlmostEqual(self.limits.critical(PUBLISHED, 9, "group2"), 1.5)
        self.assertAlmostEqual(self.limits.critical(FAST, 17, "group2"), 4.5)
        self.assertIsNone(self.limits.critical(PUBLISHED, 9, "elp4_frame"))

    def test_safe_steps_around_an_n(self):
        around = self.limits.safe_around
        self.assertAlmostEqual(around(FAST, "smooth", 9, "rk4"), 0.96)
        self.assertAlmostEqual(around(FAST, "smooth", 13, "rk4"), 0.96)  # the lesser one
        self.assertAlmostEqual(around(FAST, "smooth", 17, "rk4"), 1.44)
        for unknown in (("smooth", 33, "rk4"), ("smooth", 5, "rk4"), ("rough", 9, "rk4"), ("smooth", 9, "rkmk4")):
            self.assertIsNone(around(FAST, *unknown))

    def test_least_safe_is_in_the_order_of_the_list_and_of_n(self):
        keys = [key for key in self.limits.least_safe() if key[1] == FAST]
        self.assertEqual(keys, [(name, FAST, n) for name in self.limits.integrators for n in SIZES])


class Report(unittest.TestCase):
    def setUp(self):
        self.report = as_markdown(sections(limits_of(limits_study()), ())).replace("\\", "")

    def row(self, name, heading):
        line = next(line for line in self.report.split(f"# {heading}", 1)[1].splitlines()
                    if line.startswith(f"| {name} "))
        return [cell.strip() for cell in line.strip("|").split(" | ")]

    def test_ranges_with_their_marks(self):
        self.assertEqual(self.row("group2", "Published forms: critical"),
                         ["group2", "1.50 to 1.65", "2.25 to 2.48", "diverged"])
        self.assertEqual(self.row("algebra1", "Published forms: critical")[1], "1.20 to 1.32*")
        self.assertEqual(self.row("elp4_frame", "Fast forms: critical")[1], "10.0 to 11.0°")

    def test_safe_steps_in_h_at_the_largest_n(self):
        self.assertIn("Safe steps at n = 17, fast forms", self.report)
        self.assertEqual(self.row("group2", "Safe steps at n = 17")[1], "1.80")  # 0.8 · 4.5 / ‖B‖₂

    def test_figures(self):
        found = figures(limits_of(limits_study()))
        self.assertAlmostEqual(found["critical.fast.group2.n9.least"], 3.0)
        self.assertAlmostEqual(found["critical.fast.group2.n9.largest"], 3.3)
        self.assertAlmostEqual(found["safe_step.fast.smooth.rk4.n9"], 0.96 / NORM_B)
        self.assertAlmostEqual(found["spread.median"], 1.1)
        self.assertEqual((found["limits"], found["lines"], found["safe"]), (56, 28, 28))
        self.assertEqual((found["lines_set_by_cap"], found["lines_with_island"]), (8, 4))
        self.assertEqual(found["safe_below_critical"], 28)
        # State 1 is 1.1 times as far, beyond what bisection leaves open.
        self.assertEqual((found["own_state_within_drawn"], found["lines_of_several_states"]), (0, 28))

    def test_a_limit_within_those_of_drawn_states_is_counted(self):
        study = limits_study()
        study.tables["limits"] = [limit._replace(works=1.0, fails=CLOSE) for limit in study.tables["limits"]]
        found = figures(limits_of(study))
        self.assertEqual(found["own_state_within_drawn"], found["lines_of_several_states"])


class Files(DrawingTest):
    script = "render_limits"

    def test_every_chart_is_whole_and_shown(self):
        files = self.rendered("plain", write(self.folder, limits_study()))
        charts = ("limits", "failure_map")
        self.assertEqual(set(files), {"report.md", "figures.json",
                                      *(f"{chart}.{kind}" for chart in charts for kind in ("svg", "png"))})
        for chart in charts:
            self.assert_whole(files, chart)
            self.assertIn(f"({chart}.svg)".encode(), files["report.md"])

    def test_another_file_is_refused(self):
        path = self.write("other.json", "{}")
        self.assert_refused(self.render(path, "--out", self.path("charts")), "other.json",
                            "raw file of the study limits")


class Charts(DrawingTest):
    def test_lines_are_the_least_limits_and_theory_is_apart(self):
        panels = self.panels("limits_charts", "critical_steps", limits_of(limits_study()))
        (published,), (fast,) = panels["published forms"], panels["fast forms"]
        self.assertEqual(set(lines_of(published)), {"group2", "algebra1", "rk4"})
        self.assertEqual(set(lines_of(fast)), {"group2", "algebra1", "rk4", "elp4_frame"})
        for name, (critical, _, _) in CRITICAL.items():
            points = lines_of(fast)[name]
            self.assertEqual([n for n, _ in points], list(SIZES))
            self.assertAlmostEqual(points[0][1], 2 * critical)
        self.assertEqual(len([line for line in published.lines if line.get_label() == "_theory"]), 2)

    def test_a_cell_for_each_trial(self):
        ((panel,),) = self.panels("limits_charts", "failure_map", limits_of(limits_study())).values()
        self.assertEqual(len(panel.patches), len(SIZES) * len(CRITICAL["algebra1"][2]))
        self.assertEqual(len({patch.get_facecolor() for patch in panel.patches}), 4)


if __name__ == "__main__":
    unittest.main()
