"""Tests of what is made of the raw file of the study of limits: report, figures, charts, advice."""

import unittest

from drawing import DrawingTest, lines_of
from limits_documents import CLOSE, CRITICAL, NORM_B, SIZES, limits_study

from lib.pages.document import as_markdown
from lib.records.formats import FAST, PUBLISHED
from studies.limits.schema import LETTERS, OUTCOMES, limits_of
from studies.limits.report import sections
from studies.limits.judge import figures


class RawFiles(unittest.TestCase):
    def test_every_outcome_has_a_letter_of_its_own(self):
        self.assertEqual(set(LETTERS), set(OUTCOMES))
        self.assertEqual(len(set(LETTERS.values())), len(OUTCOMES))


class Questions(unittest.TestCase):
    def setUp(self):
        self.limits = limits_of(limits_study())

    def test_what_survived_is_in_the_order_of_the_list_and_of_n(self):
        keys = [key for key in self.limits.min_survived() if key[1] == FAST]
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

    def test_a_form_of_which_no_step_works_and_one_that_was_not_tried(self):
        study = limits_study()
        study.tables["limits"] = [limit._replace(works=None, fails=None, fails_as=None, grid="dddd")
                                  if limit.integrator == "group2" else limit for limit in study.tables["limits"]
                                  if (limit.integrator, limit.n, limit.solver) != ("rk4", 17, PUBLISHED)]
        study.tables["survived"] = []
        self.report = as_markdown(sections(limits_of(study), ()))
        self.assertEqual(self.row("group2", "Published forms: critical")[1:3], ["none", "none"])
        self.assertEqual(self.row("rk4", "Published forms: critical")[2], "–")

    def test_steps_that_survived_in_h_with_their_energy_errors_at_the_largest_n(self):
        heading = "Longest step that survived to T = 50, n = 17, fast forms"
        row = self.row("group2", heading)
        self.assertEqual((row[1], row[-1]), ("1.80", "2e-02"))  # 0.8 · 4.5 / ‖B‖₂
        self.assertEqual(self.row("algebra1", "Fast forms: longest h‖B(W₀)‖₂ that survived")[1], "1.92* (2e-02)")
        self.assertNotIn("safe", self.report.lower())

    def test_figures(self):
        found = figures(limits_of(limits_study()))
        self.assertAlmostEqual(found["critical.fast.smooth.group2.n9.min"], 3.0)
        self.assertAlmostEqual(found["critical.fast.smooth.group2.n9.largest"], 3.3)
        self.assertAlmostEqual(found["survived_step.fast.smooth.rk4.n9"], 0.96 / NORM_B)
        self.assertEqual(found["survived_energy_error.fast.smooth.rk4.n9"], 0.02)
        self.assertAlmostEqual(found["spread.median"], 1.1)
        self.assertEqual((found["limits"], found["lines"], found["survived"]), (56, 28, 28))
        self.assertEqual((found["lines_set_by_cap"], found["lines_with_island"]), (8, 4))
        self.assertEqual(found["survived_below_critical"], 28)
        # State 1 is 1.1 times as far, beyond what bisection leaves open.
        self.assertEqual((found["own_state_within_drawn"], found["lines_of_several_states"]), (0, 28))

    def test_a_limit_within_those_of_drawn_states_is_counted(self):
        study = limits_study()
        study.tables["limits"] = [limit._replace(works=1.0, fails=CLOSE) for limit in study.tables["limits"]]
        found = figures(limits_of(study))
        self.assertEqual(found["own_state_within_drawn"], found["lines_of_several_states"])


class Chart(DrawingTest):
    def drawn(self, study):
        panels = self.panels("studies.limits.charts", "limits", limits_of(study))
        return {title: panel for title, (panel,) in panels.items()}

    def test_lines_are_the_limits_of_the_own_state_by_fast_forms(self):
        panels = self.drawn(limits_study())
        self.assertEqual(list(panels), ["smooth scene", "developed scene"])
        lines = lines_of(panels["smooth scene"])
        self.assertEqual(set(lines), {"group2", "elp4_frame", "rk4"})
        for name, points in lines.items():
            critical, _, _ = CRITICAL[name]
            self.assertEqual([n for n, _ in points], list(SIZES))
            self.assertAlmostEqual(points[0][1], 2 * critical)

    def test_a_line_that_ends_early_says_up_to_where_it_was_tried(self):
        study = limits_study()
        study.tables["limits"] = [each for each in study.tables["limits"] if (each.integrator, each.n) != ("rk4", 17)]
        study.tables["survived"] = []
        panel = self.drawn(study)["smooth scene"]
        self.assertEqual({text.get_text() for text in panel.texts},
                         {"group2 (order 4), no frame", "elp4", "rk4, no frame, tried to 9"})


if __name__ == "__main__":
    unittest.main()
