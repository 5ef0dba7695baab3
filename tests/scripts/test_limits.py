"""Tests of what is made of a raw file of limits in which some forms do not work or were not tried."""

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
    def test_a_form_of_which_no_step_works_and_one_that_was_not_tried(self):
        study = limits_study()
        study.tables["limits"] = [limit._replace(works=None, fails=None, fails_as=None, grid="dddd")
                                  if limit.integrator == "group2" else limit for limit in study.tables["limits"]
                                  if (limit.integrator, limit.n, limit.solver) != ("rk4", 17, PUBLISHED)]
        study.tables["survived"] = []
        report = as_markdown(sections(limits_of(study), ()))
        section = report.split("# Published forms: critical", 1)[1].split("# Fast forms", 1)[0]
        rows = {cells[1].strip(): [cell.strip() for cell in cells[2:4]]
                for line in section.splitlines() if len(cells := line.split("|")) > 3}
        self.assertEqual(rows["group2"], ["none", "none"])
        self.assertEqual(rows["rk4"][1], "–")


class Chart(DrawingTest):
    def test_a_line_that_ends_early_says_up_to_where_it_was_tried(self):
        study = limits_study()
        study.tables["limits"] = [each for each in study.tables["limits"] if (each.integrator, each.n) != ("rk4", 17)]
        study.tables["survived"] = []
        (panel,) = self.panels("studies.limits.charts", "limits", limits_of(study))["smooth scene"]
        self.assertEqual({text.get_text() for text in panel.texts},
                         {"group2 (order 4), no frame", "elp4", "rk4, no frame, tried to 9"})


if __name__ == "__main__":
    unittest.main()
