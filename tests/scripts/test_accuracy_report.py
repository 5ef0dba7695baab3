"""Tests of the report on accuracy: every figure follows from the raw file."""

import os
import sys
import unittest

from programs import ROOT
from study_documents import accuracy_of, run_of, small_study, study_document

sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))

from accuracy_report import accuracy_sections  # noqa: E402
from document import as_text  # noqa: E402


def report(document):
    return as_text(accuracy_sections(accuracy_of(document), ()))


def rkmk4_dearer(document):
    for run in document["runs"]:
        if run["integrator"] == "rkmk4":
            run["cpu_seconds"] = [100 * time for time in run["cpu_seconds"]]


def algebra_at_the_usual_tolerance(document):
    """Gives algebra1 a run at 1e-13, with a better spectrum than group1's, which is worse at other tolerances."""
    group = next(run for run in document["tolerance_runs"] if run["tolerance"] == 1e-13)
    document["integrators"].append({**document["integrators"][1], "name": "algebra1"})
    document["tolerance_runs"].append({**group, "integrator": "algebra1", "spectrum_error": 1e-16})
    for run in document["tolerance_runs"]:
        if run["integrator"] == "group1":
            run["spectrum_error"] = run["tolerance"] * (5 if run["tolerance"] == 1e-13 else 1e5)


class Report(unittest.TestCase):
    def test_figures_can_be_worked_out_by_hand(self):
        text = report(study_document())
        for pattern in (
                # C h^4 in S/h seconds: group2_frame costs 4e-3 (1e-2)^(1/4) / (1e-3 (1e-3)^(1/4)) = 7.1 times rkmk4.
                r"takes 7\.1 × RKMK4's time and 40 × RK4's time\.", r" 7\.1 \(6\.9–7\.3\) times RKMK4's over 10 comp",
                r"The price of structure[^*]*\nrkmk4 +7\.1 \(6\.9–7\.3\) +7\.1 \(6\.9–7\.3\) +7\.1 \(6\.9–7\.3\)\n",
                r"What the co-rotating frame buys[^*]*group2 +1\.8 +1\.8 +1\.8\n",  # (1e-1 / 1e-2)^(1/4)
                r"cheaper than the best Gauss form in 14 of 14",
                # Errors 0.01 (s = 1) and 1e-5 (s = 2); a solver error is a tenth of the tolerance, 1e-4 at most.
                r"17  group +1 +1\.0e-2 +1e-04 ", r"17  group +2 +1\.0e-5 +1e-05 ",
                # 100 steps of group2: an error of 6.3e-7, 400 equivalent products, 0.4 s; the rate is 2e9 / 33^3 = 55,653.
                r"group2 +0\.0500 +6\.3e-7 +0\.400 +400 +1\.80 % +4\.00 +predictor"):
            with self.subTest(pattern=pattern):
                self.assertRegex(text, pattern)

    def test_a_change_of_a_run_changes_them(self):
        for change, after in (
                (lambda document: run_of(document, "rk4", 17, 5).update(beyond_limit=True),
                 r"\nrk4 +1\.00 beyond its limit +1\.00 beyond its limit "),
                (lambda document: run_of(document, "rkmk4", 17, 50).update(error=3.3e-3),
                 r"goes from [^.]*[^;]*; 3\.3e-3 to 1\.0e-7 \(rkmk4\)"),
                (rkmk4_dearer, r"takes 0\.071 × RKMK4's time"), (rkmk4_dearer, r"in 0 of 14"),
                (algebra_at_the_usual_tolerance, r"algebra's spectrum errs up to 5000 times less")):
            with self.subTest(after=after):
                document = study_document()
                self.assertNotRegex(report(document), after)
                change(document)
                self.assertRegex(report(document), after)

    def test_a_study_of_one_problem_without_tolerances_makes_a_report(self):
        document = small_study()
        document["tolerance_runs"] = document["limits"] = document["rates"] = []
        self.assertIn("Runs that failed", report(document))


if __name__ == "__main__":
    unittest.main()
