"""Tests of the report on accuracy: every table follows from the raw file."""

import os
import sys
import unittest

from programs import ROOT
from study_documents import accuracy_of, study_document

sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))

from accuracy_report import accuracy_sections  # noqa: E402
from document import as_text  # noqa: E402


def report(document):
    return as_text(accuracy_sections(accuracy_of(document), ()))


class Tables(unittest.TestCase):
    def test_failures_are_listed(self):
        self.assertRegex(report(study_document()), r"17  group1 +1\.00 diverged")

    def test_a_run_beyond_its_limit_is_counted_apart(self):
        document = study_document()
        for each in document["runs"]:
            each["beyond_limit"] = (each["integrator"], each["steps"]) == ("rk4", 5)
        self.assertIn("2 more came to an end beyond their stability limit", report(document).replace("\n", " "))

    def test_the_error_at_the_step_of_table_1(self):
        before, document = report(study_document()), study_document()
        for each in document["runs"]:
            if (each["integrator"], each["n"], each["steps"]) == ("rkmk4", 17, 50):
                each["error"] = 3.3e-3
        self.assertRegex(before, r"rkmk4 +1\.0e-7 +1\.0e-7")
        self.assertRegex(report(document), r"rkmk4 +3\.3e-3 +1\.0e-7")

    def test_a_study_of_one_size_without_explicit_methods_makes_a_report(self):
        document = study_document()
        document["references"] = document["references"][:1]
        document["integrators"] = document["integrators"][:2]
        names = {each["name"] for each in document["integrators"]}
        document["runs"] = [each for each in document["runs"] if each["integrator"] in names and each["n"] == 17]
        document["tolerance_runs"] = []
        self.assertIn("Runs that failed", report(document))


if __name__ == "__main__":
    unittest.main()
