"""Tests of the report on accuracy: every table follows from the raw file."""

import os
import sys
import unittest

from programs import ROOT
from study_documents import accuracy_of, run_of, study_document

sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))

from accuracy_report import accuracy_sections  # noqa: E402
from document import as_text  # noqa: E402


def report(document):
    return as_text(accuracy_sections(accuracy_of(document), ()))


class Tables(unittest.TestCase):
    def test_what_a_change_of_a_run_does(self):
        for run, change, before, after in (
                (("rk4", 17, 5), {"beyond_limit": True}, "17  group1 +1.00 diverged\n", "17  rk4 +1.00 beyond its"),
                (("rkmk4", 17, 50), {"error": 3.3e-3}, "rkmk4 +1.0e-7 +1.0e-7", "rkmk4 +3.3e-3 +1.0e-7")):
            with self.subTest(change=change):
                document = study_document()
                self.assertRegex(report(document), before)
                self.assertNotRegex(report(document), after)
                run_of(document, *run).update(change)
                self.assertRegex(report(document), after)

    def test_the_loosest_harmless_tolerance(self):
        # Errors 0.01 (s = 1) and 1e-5 (s = 2); a solver error is a tenth of the tolerance, 1e-4 at most.
        self.assertRegex(report(study_document()), r"17  group +1 +1\.0e-2 +1e-04 ")
        self.assertRegex(report(study_document()), r"17  group +2 +1\.0e-5 +1e-05 ")

    def test_a_study_of_one_size_without_tolerances_makes_a_report(self):
        document = study_document()
        document["references"] = document["references"][:1]
        document["runs"] = [each for each in document["runs"] if each["n"] == 17]
        document["tolerance_runs"] = []
        self.assertIn("Runs that failed", report(document))


if __name__ == "__main__":
    unittest.main()
