"""Tests of the study of accuracy on a made-up one: ends of lines, methods that stand for a class, figures by hand."""

import unittest

from programs import FolderTest
from study_documents import SMOOTH, STEPS, accuracy_of, run_of, small_study, study_document

from studies.accuracy.judge import figures, findings
from studies.accuracy.schema import CANDIDATES as ALL_CANDIDATES
from lib.records.settings import ENERGY_BOUNDED, LOOSE_EXPONENTIAL, TIGHT
from studies.accuracy.schema import Form
from studies.accuracy.report import accuracy_sections
from studies.accuracy.candidates import CLASSES, all_forms, members
from lib.records.formats import listed
from lib.pages.document import as_markdown


class LineTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.document = study_document()

    def study(self):
        return accuracy_of(self.document)

    def set_errors(self, errors):
        """Gives the line of rkmk4 at n = 17 these errors, the longest step first."""
        for steps, error in zip(STEPS, errors):
            run_of(self.document, "rkmk4", 17, steps)["error"] = error

    def test_where_a_line_ends_and_the_order_there(self):
        def power(order):
            return [1e-3 * (5 / steps) ** order for steps in STEPS]

        for uncertainty, errors, kept, order in (
                (1e-14, power(4), 6, 4), (1e-14, power(3), 6, 3),  # powers of the step to rounding
                (1e-6, power(4), 2, None), (1e-3, power(4), 0, None),  # too few for an order
                (1e-9, power(4), 4, 4),  # 1e-7 at 50 steps, 6.25e-9 at 100: ten times the uncertainty lies between them
                (1e-14, (1e-3, 6e-5, 4e-6, 3e-9, 2.9e-9, 1e-9), 4, "no power"),  # rounding stops the error from falling
                (1e-14, (1e-3, 6e-5, 5.9e-5, 5.8e-5, 6e-9, 4e-10), 6, "no power"),  # a plateau far above is no floor
                (1e-14, [*power(2)[:3], *power(4)[3:]], 6, 4)):  # an order is fitted on the smallest steps
            with self.subTest(uncertainty=uncertainty, errors=errors):
                self.document["references"][0]["uncertainty"] = uncertainty
                self.set_errors(errors)
                self.assertEqual([run.steps for run in self.study().above_floor(SMOOTH[0], "rkmk4")],
                                 list(STEPS[:kept]))
                if order != "no power":
                    found = self.study().observed_order(SMOOTH[0], "rkmk4")
                    self.assertEqual(found and round(found, 12), order)


def report(document):
    return as_markdown(accuracy_sections(accuracy_of(document), ()))


def figures_of(document):
    return figures(findings(accuracy_of(document)))


class Classes(unittest.TestCase):
    """Of methods that compete, found by rule."""

    RK4, PROJECTED = listed("rk4_frame"), listed("rk4_projected_frame")
    LISTED = (RK4._replace(name="rk12_frame", order=12), RK4, RK4._replace(name="rk12", order=12, co_rotating=False),
              RK4._replace(name="rk2_frame", order=2), PROJECTED._replace(name="rk12_projected_frame", order=12),
              *map(listed, ("rkmk4_frame", "magnus5_frame", "elp6_frame", "elp2_frame", "group2_frame",
                            "algebra2_frame", "group4_frame", "cotangent2_frame", "bm2_frame", "cg4_frame")),
              listed("direct2")._replace(name="direct2_frame", co_rotating=True),
              listed("elp4_frame")._replace(name="elp8_frame", family="of another kind"))

    def test_each_finds_its_methods_in_the_frame_from_order_four_on(self):
        self.assertEqual(list(CLASSES), list(ALL_CANDIDATES))
        found = {each: [method.name.removesuffix("_frame") for method in members(self.LISTED, each)]
                 for each in CLASSES}
        exponential, gauss = dict.fromkeys(("elp", "elp_matched", "elp_bounded"), ["elp6"]), ["group2", "group4"]
        self.assertEqual(found, {
            "explicit": ["rk12", "rk4"], "rk4": ["rk4"], "projected": ["rk12_projected"], "rkmk": ["rkmk4"],
            "magnus": ["magnus5"], **exponential, **dict.fromkeys(("gauss", "gauss_loose", "gauss_matched"), gauss),
            "gauss_published": ["group2", "algebra2"], "named_published": ["bm2", "cg4"],
            "other": ["elp8"]})
        self.assertEqual(all_forms(self.LISTED), [Form(f"{name}_frame", tolerance) for name, tolerance in (
            ("rk12", TIGHT), ("rk4", TIGHT), ("rk12_projected", TIGHT), ("rkmk4", TIGHT),
            ("magnus5", LOOSE_EXPONENTIAL), ("elp6", LOOSE_EXPONENTIAL), ("elp6", ENERGY_BOUNDED), ("group2", TIGHT),
            ("group4", TIGHT), ("elp8", TIGHT))])


class Figures(unittest.TestCase):
    def test_they_can_be_worked_out_by_hand(self):
        found = figures_of(study_document())
        # At 1e-4 group2_frame and elp4_frame need 5 (1e-2 / 1e-4)^(1/4) = 15.8 steps, of 4 ms, and 1 ms at the loose
        # tolerance; rkmk4 8.9 steps of 1 ms; rk4 15.8 of 0.1 ms. At 1e-6: 50, 28.1 and 50 steps.
        for key, wanted in {
                "problems": 3, "gauss_over_elp.smooth_t5.n17.at_1e-4": 4,
                "gauss_loose_over_elp.smooth_t5.n17.at_1e-4": 2, "elp_matched_over_elp.smooth_t5.n17.at_1e-4": 1,
                "gauss_matched_over_elp_matched.smooth_t5.n17.at_1e-4": 2,
                "gauss_published_over_gauss.smooth_t5.n33.at_1e-6": 4,
                "rkmk_over_explicit.smooth_t5.n17.at_1e-4": 90 / 16,
                "elp_over_explicit.smooth_t5.n33.at_1e-6": 10, "elp_bounded_over_explicit.smooth_t5.n33.at_1e-6": 20,
                "named_published_over_gauss_published.smooth_t5.n33.at_1e-6": 89 / 50,
                "named_published_over_gauss_published.products.smooth_t5.n33.at_1e-6": 89 / 50,
                "elp_over_explicit.slower": 4, "elp_over_explicit.faster": 0, "elp_over_explicit.undecided": 0,
                "elp_over_explicit.comparisons": 4, "rows": 40, "rows.of_few_steps": 2,  # rkmk4 at 1e-4
                "explicit_fastest.at_1e-6": 2, "explicit_fastest.at_1e-6.comparisons": 2,
                "seconds.elp.smooth_t5.n17.at_1e-6": 0.05, "steps.elp.smooth_t5.n17.at_1e-6": 50,
                "spectrum.gauss_loose.smooth_t5.n17.at_1e-6": 1e-7, "spectrum.elp.smooth_t5.n17.at_1e-6": 1e-15,
                "frame_gain": 10**0.25, "frame_gain.comparisons": 8,  # group2 itself ends above 1e-8
                "gauss_order.at_1e-2.min": 4, "gauss_order.at_1e-8.largest": 4,
                "error.group2.n17": 1e-5, "error.group2_frame.n33": 1e-6,
                # Errors 0.01 (s = 1) and 1e-5 (s = 2); a solver error is a tenth of the tolerance, 1e-4 at most.
                "tolerance.group1.n17": 1e-4, "tolerance.group2.n33": 1e-5, "tolerance.time": 1,
                "tolerance.spectrum_error": 1e-15, "spectrum_error.group1.n33": 1e-15}.items():
            with self.subTest(key=key):
                self.assertAlmostEqual(found[key], wanted, delta=1e-3 * wanted)
        self.assertFalse([key for key in found if "magnus" in key or "projected" in key])  # which nobody sent


class Report(unittest.TestCase):
    def test_a_study_of_one_problem_without_tolerances_makes_a_report(self):
        document = small_study()
        document["tolerance_runs"] = document["comparisons"] = document["rates"] = []
        self.assertIn("Runs that failed", report(document))
        self.assertEqual(figures_of(document)["problems"], 1)


if __name__ == "__main__":
    unittest.main()
