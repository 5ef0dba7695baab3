"""Tests of the report on accuracy: every table follows from the raw file."""

import os
import sys
import unittest

from programs import ROOT
from study_documents import accuracy_of, run_of, small_study, study_document

sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))

import accuracy_claims  # noqa: E402
from accuracy_report import accuracy_sections  # noqa: E402
from document import as_text  # noqa: E402


def report(document):
    return as_text(accuracy_sections(accuracy_of(document), ()))


class Tables(unittest.TestCase):
    def test_what_a_change_of_a_run_does(self):
        for run, change, before, after in (
                (("rk4", 17, 5), {"beyond_limit": True}, "n = 17 +fast +group1 1.00 diverged\n",
                 "n = 17 .*; rk4 1.00 beyond its"),
                (("rkmk4", 17, 50), {"error": 3.3e-3}, "rkmk4 +1.0e-7 +1.0e-7", "rkmk4 +3.3e-3 +1.0e-7")):
            with self.subTest(change=change):
                document = study_document()
                self.assertRegex(report(document), before)
                self.assertNotRegex(report(document), after)
                run_of(document, *run).update(change)
                self.assertRegex(report(document), after)

    def test_the_loosest_harmless_tolerance(self):
        # Errors 0.01 (s = 1) and 1e-5 (s = 2); a solver error is a tenth of the tolerance, 1e-4 at most.
        self.assertRegex(report(study_document()), r"17  group +1  published +1\.0e-2 +1e-04 ")
        self.assertRegex(report(study_document()), r"17  group +2  published +1\.0e-5 +1e-05 ")

    def test_comparisons_at_equal_error(self):
        # C h^4 in S/h seconds: at 1e-8 group2_frame costs 4e-3 (1e-2)^(1/4) / (1e-3 (1e-3)^(1/4)) = 7.1 times rkmk4.
        text = report(study_document())
        self.assertRegex(text, r"n = 17 +1e-2 .* rkmk4 0\.00500 † .*\n +1e-4 +group2_frame 0\.0632 ")
        self.assertRegex(text, r"\n +1e-8 +group2_frame 0\.632 +rkmk4 0\.0889 +rk4 0\.0158\* +7\.1 \(6\.9–7\.3\)")
        self.assertRegex(text, r"What the co-rotating frame buys[^*]*group2 +1\.8 +1\.8 +1\.8\n")  # (1e-1 / 1e-2)^(1/4)
        self.assertRegex(text, r"What the fast forms buy[^*]*group2 +4 +4\n")

    def test_equal_care(self):
        # 100 steps of group2 have an error of 6.3e-7, 400 equivalent products, 0.4 s; the rate is 2e9 / 33^3 = 55,653.
        self.assertRegex(report(study_document()), r"group2 +0\.0500 +6\.3e-7 +0\.400 +400 +1\.80 % +4\.00 +predictor")

    def test_a_study_of_one_problem_without_tolerances_makes_a_report(self):
        document = small_study()
        document["tolerance_runs"] = document["limits"] = document["rates"] = []
        self.assertIn("Runs that failed", report(document))


class Claims(unittest.TestCase):
    def test_figures_are_of_the_data(self):
        document = study_document()
        study = accuracy_of(document)
        said = dict(accuracy_claims.claims(study))
        self.assertIn("farthest from its order", said["Observed orders."])
        # From 1e-4 to 1e-8 every comparison of group2_frame with rkmk4 gives 7.1.
        self.assertIn("takes 7.1 (6.9–7.3) times `rkmk4`'s time over 10 comparisons", said["The price of structure."])
        self.assertIn("cheaper than every Lie–Poisson method in 14 of 14", said["Exponential or not."])
        self.assertEqual(accuracy_claims.price_title(study, study.problems()[:1]),
                         "At equal error Gauss methods take 7.1 × RKMK4's time and 40 × RK4's time")
        for run in document["runs"]:
            if run["integrator"] == "rkmk4":
                run["cpu_seconds"] = [100 * time for time in run["cpu_seconds"]]
        study = accuracy_of(document)
        self.assertIn("in 0 of 14 comparisons", dict(accuracy_claims.claims(study))["Exponential or not."])
        self.assertIn("take 0.071 × RKMK4", accuracy_claims.price_title(study, study.problems()[:1]))

    def test_equal_tolerance_is_compared_at_the_usual_one(self):
        document = study_document()
        # Without algebra there is nothing to compare.
        self.assertIn("tolerance of the fixed-point", accuracy_claims.tolerance_title(accuracy_of(document)))
        group = next(run for run in document["tolerance_runs"] if run["tolerance"] == 1e-13)
        document["integrators"].append({**document["integrators"][1], "name": "algebra1"})
        document["tolerance_runs"].append({**group, "integrator": "algebra1", "spectrum_error": 1e-16})
        for run in document["tolerance_runs"]:
            if run["integrator"] == "group1":
                run["spectrum_error"] = run["tolerance"] * (5 if run["tolerance"] == 1e-13 else 1e5)
        self.assertIn("up to 5000 times less than group's (n = 17, s = 1)",
                      accuracy_claims.tolerance_title(accuracy_of(document)))


if __name__ == "__main__":
    unittest.main()
