"""Tests of what is made of the raw file of the study of limits: report, figures, charts, advice."""

import unittest

from drawing import DrawingTest
from limits_documents import limits_study

from lib.pages.document import as_markdown
from lib.records.formats import PUBLISHED
from studies.limits.schema import LETTERS, OUTCOMES, limits_of
from studies.limits.report import sections


class RawFiles(unittest.TestCase):
    def test_every_outcome_has_a_letter_of_its_own(self):
        self.assertEqual(set(LETTERS), set(OUTCOMES))
        self.assertEqual(len(set(LETTERS.values())), len(OUTCOMES))


class Report(unittest.TestCase):
    def setUp(self):
        self.report = as_markdown(sections(limits_of(limits_study()), ())).replace("\\", "")

    def row(self, name, heading):
        line = next(line for line in self.report.split(f"# {heading}", 1)[1].splitlines()
                    if line.startswith(f"| {name} "))
        return [cell.strip() for cell in line.strip("|").split(" | ")]

    def test_a_form_of_which_no_step_works_and_one_that_was_not_tried(self):
        study = limits_study()
        study.tables["limits"] = [limit._replace(works=None, fails=None, fails_as=None, grid="dddd")
                                  if limit.integrator == "group2" else limit for limit in study.tables["limits"]
                                  if (limit.integrator, limit.n, limit.solver) != ("rk4", 17, PUBLISHED)]
        study.tables["survived"] = []
        self.report = as_markdown(sections(limits_of(study), ()))
        self.assertEqual(self.row("group2", "Published forms: critical")[1:3], ["none", "none"])
        self.assertEqual(self.row("rk4", "Published forms: critical")[2], "–")


class Chart(DrawingTest):
    def drawn(self, study):
        panels = self.panels("studies.limits.charts", "limits", limits_of(study))
        return {title: panel for title, (panel,) in panels.items()}

    def test_a_line_that_ends_early_says_up_to_where_it_was_tried(self):
        study = limits_study()
        study.tables["limits"] = [each for each in study.tables["limits"] if (each.integrator, each.n) != ("rk4", 17)]
        study.tables["survived"] = []
        panel = self.drawn(study)["smooth scene"]
        self.assertEqual({text.get_text() for text in panel.texts},
                         {"group2 (order 4), no frame", "elp4", "rk4, no frame, tried to 9"})


if __name__ == "__main__":
    unittest.main()
