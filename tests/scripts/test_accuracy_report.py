"""Tests of the report on accuracy: every table follows from the raw file."""

import os
import sys
import unittest

from programs import ROOT
from study_documents import accuracy_of, study_document

sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))

from accuracy_report import accuracy_sections  # noqa: E402
from document import as_text  # noqa: E402


def report(change=lambda run: None):
    """Returns the report on the study after a change of its runs."""
    document = study_document()
    for run in document["runs"]:
        change(run)
    return as_text(accuracy_sections(accuracy_of(document), ()))


class Tables(unittest.TestCase):
    def test_failures_and_runs_beyond_their_limit_are_listed(self):
        beyond = report(lambda run: run.update(beyond_limit=(run["integrator"], run["steps"]) == ("rk4", 5)))
        self.assertRegex(beyond, r"17  group1 +1\.00 diverged\n")
        self.assertRegex(beyond, r"17  rk4 +1\.00 beyond its limit\n")
        self.assertNotIn("17  rk4  ", report().split("Runs that failed")[1])

    def test_the_error_at_the_step_of_table_1(self):
        def change(run):
            if (run["integrator"], run["n"], run["steps"]) == ("rkmk4", 17, 50):
                run["error"] = 3.3e-3

        self.assertRegex(report(), r"rkmk4 +1\.0e-7 +1\.0e-7")
        self.assertRegex(report(change), r"rkmk4 +3\.3e-3 +1\.0e-7")

    def test_the_loosest_harmless_tolerance(self):
        # Errors 0.01 (s = 1) and 1e-5 (s = 2); a solver error is a tenth of the tolerance, 1e-4 at most.
        self.assertRegex(report(), r"17  group +1 +1\.0e-2 +1e-04 ")
        self.assertRegex(report(), r"17  group +2 +1\.0e-5 +1e-05 ")

    def test_a_study_of_one_size_without_tolerances_makes_a_report(self):
        document = study_document()
        document["references"] = document["references"][:1]
        document["runs"] = [each for each in document["runs"] if each["n"] == 17]
        document["tolerance_runs"] = []
        self.assertIn("Runs that failed", as_text(accuracy_sections(accuracy_of(document), ())))


if __name__ == "__main__":
    unittest.main()
