"""Tests of the report on accuracy: every claim and table follows from the raw file."""

import copy
import os
import sys
import unittest

from programs import DONE, ROOT, FolderTest, environment, run
from study_documents import point, study_document, write_study

sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))

from accuracy_report import accuracy_sections, claims  # noqa: E402
from document import as_text  # noqa: E402
from work_precision import study  # noqa: E402


def claim_texts(document):
    return [claim.strong + claim.rest if claim else None for claim in claims(study(document))]


def report(document):
    return as_text(accuracy_sections(study(document), {}))


class ClaimTest(unittest.TestCase):
    """One claim, by its place in the list; `change` alters points of a copy of the made-up study."""

    def claim(self, change=None):
        document = copy.deepcopy(study_document())
        if change:
            for each in document["points"]:
                change(each)
        return claim_texts(document)[self.place]


class Orders(ClaimTest):
    place = 0

    def test_every_line_has_its_order(self):
        # Ten lines of five integrators at two n.
        self.assertTrue(self.claim().startswith("Every line has its order: 10 of 10"))

    def test_a_line_of_another_order_turns_it(self):
        def flatten(each):
            if (each["integrator"], each["n"]) == ("group2", 33) and each["error"]:
                each["error"] = each["step"]
        self.assertRegex(self.claim(flatten), r"^Not every line has its order: 9 of 10 .* group2 at n = 33 with 1\.00 for 4")


class Growth(ClaimTest):
    place = 1

    def test_errors_that_do_not_grow(self):
        self.assertIn("hardly depends on n", self.claim())

    def test_growing_errors_turn_it_and_are_quoted(self):
        def grow(each):
            if each["n"] == 33 and each["error"]:
                each["error"] *= 5
        claim = self.claim(grow)
        self.assertTrue(claim.startswith("One step size is not one accuracy"))
        self.assertIn("group1 by 5.00 (1.0e-2 to 5.0e-2)", claim)

    def test_a_failed_run_leaves_its_method_out(self):
        def fail(each):
            if (each["integrator"], each["steps"]) == ("group2", 50):
                each.update(point("group2", each["n"], 50, "diverged"))
        self.assertNotIn("group2", self.claim(fail))


class Price(ClaimTest):
    place = 2

    def test_the_cheapest_of_each_structure(self):
        # 1e-6: group2 at h = 0.05 (6e-7), 0.4 s; rkmk4 at h = 0.1 (1e-7), 0.05 s; rk4 at h = 0.05, 0.01 s.
        claim = self.claim()
        self.assertTrue(claim.startswith("Structure has a price: at n = 33"))
        for part in ("0.400 s", "group2, h = 0.0500", "0.0500 s", "rkmk4, h = 0.100", "0.0100 s", "rk4, h = 0.0500"):
            self.assertIn(part, claim)

    def test_a_structured_method_that_is_cheapest_turns_it(self):
        def hurry(each):
            if each["integrator"] == "group2":
                each["cpu_seconds"] = [1e-4] * 3 if each["cpu_seconds"] else []
        self.assertTrue(self.claim(hurry).startswith("Structure is free"))


class Exponential(ClaimTest):
    place = 3

    def test_the_ratio_of_times(self):
        self.assertRegex(self.claim(), r"^The exponential is not what makes a method slow.* 8\.00 times as long")

    def test_a_slow_exponential_turns_it(self):
        def slow(each):
            if each["integrator"] == "rkmk4":
                each["cpu_seconds"] = [100 * seconds for seconds in each["cpu_seconds"]]
        self.assertTrue(self.claim(slow).startswith("The exponential makes the method slow"))


class Tolerance(ClaimTest):
    place = 4

    def test_the_loosest_harmless_tolerance(self):
        # The tolerance adds a tenth of itself: 1e-4 is harmless for 1e-2 (s = 1), as for 1e-5 (s = 2) is 1e-5.
        claim = self.claim()
        self.assertTrue(claim.startswith("A tolerance of 1e-13 buys no accuracy"))
        self.assertIn("s = 1: 1e-04 suffices", claim)
        self.assertIn("s = 2: 1e-05 suffices", claim)

    def test_a_tolerance_that_harms_turns_it(self):
        document = copy.deepcopy(study_document())
        for each in document["tolerance_points"]:
            each["solver_error"] = 0.0 if each["tolerance"] < 1e-12 else 1.0
        self.assertTrue(claim_texts(document)[self.place].startswith("A tolerance near 1e-13 is needed"))


class Spectrum(ClaimTest):
    place = 5

    def test_the_worst_isospectral_run(self):
        self.assertRegex(self.claim(), r"^Isospectral is to the solver's tolerance.* 1\.0e-15")

    def test_one_that_loses_it_turns_it(self):
        def lose(each):
            if (each["integrator"], each["n"], each["steps"]) == ("group1", 33, 100):
                each["spectrum_error"] = 1e-6
        self.assertRegex(self.claim(lose), r"^Not every isospectral method keeps the spectrum.* 1\.0e-6 \(group1, n = 33")


class Tables(unittest.TestCase):
    def test_failures_are_listed(self):
        self.assertRegex(report(study_document()), r"17  group1 +1\.00 diverged")

    def test_a_run_beyond_its_limit_is_counted_apart(self):
        document = copy.deepcopy(study_document())
        for each in document["points"]:
            each["beyond_limit"] = (each["integrator"], each["steps"]) == ("rk4", 5)
        self.assertIn("2 more came to an end beyond their stability limit", report(document).replace("\n", " "))

    def test_the_error_at_the_step_of_table_1(self):
        before, document = report(study_document()), copy.deepcopy(study_document())
        for each in document["points"]:
            if (each["integrator"], each["n"], each["steps"]) == ("rkmk4", 17, 50):
                each["error"] = 3.3e-3
        self.assertRegex(before, r"rkmk4 +1\.0e-7 +1\.0e-7")
        self.assertRegex(report(document), r"rkmk4 +3\.3e-3 +1\.0e-7")

    def test_a_study_of_one_size_without_explicit_methods_makes_a_report(self):
        document = copy.deepcopy(study_document())
        document["references"] = document["references"][:1]
        document["integrators"] = document["integrators"][:2]
        names = {each["name"] for each in document["integrators"]}
        document["points"] = [each for each in document["points"] if each["integrator"] in names and each["n"] == 17]
        document["tolerance_points"] = []
        self.assertIn("Runs that failed", report(document))


class Report(FolderTest):
    """scripts/render_report in a folder of its own."""

    def setUp(self):
        super().setUp()
        os.makedirs(self.path("recorded", "accuracy"))
        write_study(self.path("recorded", "accuracy"))

    def render(self, *arguments):
        return run([os.path.join(ROOT, "scripts", "render_report"), *arguments],
                   env=environment(ISOSYRK_RESULTS=self.folder, PYTHONDONTWRITEBYTECODE="1"))

    def text(self):
        with open(self.path("README.md"), encoding="utf-8") as file:
            return file.read()

    def test_it_is_written_and_then_checks(self):
        self.assertEqual(self.render("--check").returncode, 1)
        self.assertEqual(self.render().returncode, DONE)
        self.assertIn("# Results", self.text())
        self.assertEqual(self.render("--check").returncode, DONE)

    def test_a_changed_raw_file_is_noticed(self):
        self.render()
        document = study_document()
        next(each for each in document["points"] if each["steps"] == 50)["error"] = 0.5
        write_study(self.path("recorded", "accuracy"), document)
        self.assertEqual(self.render("--check").returncode, 1)

    def test_charts_that_exist_are_shown(self):
        self.write("recorded/accuracy/tolerance.svg", "<svg/>")
        self.render()
        self.assertIn("(recorded/accuracy/tolerance.svg)", self.text())
        self.assertNotIn("error_against_n.svg", self.text())

    def test_what_cannot_be_used_is_told_in_a_line(self):
        self.write("recorded/accuracy/raw.json", "{")
        self.assert_refused(self.render(), "raw.json")
        self.assert_refused(self.render("--perhaps"), "--check")
        self.assertFalse(os.path.exists(self.path("README.md")))


class Recorded(unittest.TestCase):
    def test_the_report_shows_the_recorded_runs(self):
        done = run([os.path.join(ROOT, "scripts", "render_report"), "--check"],
                   env=environment(PYTHONDONTWRITEBYTECODE="1"))
        self.assertEqual(done.returncode, DONE, done.stderr)


if __name__ == "__main__":
    unittest.main()
