"""Tests of scripts/render scaling, as a user runs it, and of what its figures are made of."""

import os
import sys
import unittest


import drawing
from programs import DONE, RENDER, environment, run, run_script
from scaling_documents import failed, point, write_scaling, write_tables

from lib.pages.figures import read_figures
from lib.records.formats import listed
from studies.scaling.schema import ABLATIONS, Rate, TwoThreads, read_scaling, ablations_of, without

RENDERING = RENDER, "scaling"


class ScalingTest(drawing.DrawingTest):
    package = "scaling"

    def report(self, **tables):
        """Returns the lines of the report on these tables, as lists of cells."""
        self.files = self.rendered("out", write_tables(self.path("raw.json"), **tables))
        lines = self.files["report.md"].decode("utf-8").splitlines()
        return [[cell.strip() for cell in each.strip("|").split("|")] for each in lines]

    def text(self):
        return self.files["report.md"].decode("utf-8")

    def study(self, **tables):
        return read_scaling(write_tables(self.path("raw.json"), **tables))


class Report(ScalingTest):
    def test_what_failed_has_no_figures(self):
        lines = self.report(points=[point(ablation="without bands"), failed(ablation="fast")])
        self.assertIn(["5", "17", "group2", *"––––––"], lines)
        self.assertEqual([key for key in read_figures(self.path("out", "figures.json")) if "n17" in key], [])

    def test_every_single_timing_is_marked(self):
        lines = self.report(points=[point(ablation="fast"), point(ablation="published", seconds=[3.4e-6]),
                                    point("rk4", 17, "fast", seconds=[1e-6])])
        group2, rk4 = (next(cells for cells in lines if cells[1:3] == ["17", name]) for name in ("group2", "rk4"))
        self.assertEqual((group2[6], group2[7]), ("0.00374 ±6.8 %", "1.00¹"))
        self.assertEqual(rk4[6], "0.00100¹")
        self.assertIn(["published", "1.00¹"], lines)  # of the means too
        self.assertIn("2 of 3 points were timed once", self.text())
        found = read_figures(self.path("out", "figures.json"))
        self.assertEqual((found["single"], found["points"]), (2, 3))

    def test_the_rough_scene_beside_the_smooth_one(self):
        times = {"smooth": 2e-6, "rough": 3e-6}
        paths = {scene: write_tables(self.path(f"{scene}.json"), scene, rates=[Rate(257, "fast", [1e-8])],
                                     points=[point("elp4_frame", 257, seconds=[time] * 3)])
                 for scene, time in times.items()}
        self.files = self.rendered("out", paths["smooth"])  # the other is found beside it
        smooth, rough = self.text().split("## A step against n, rough scene")
        self.assertRegex(smooth, r"0\.00200 ±0\.0 % \| +12\.0 \| +20\.0 \| +10\.0 % ")
        self.assertRegex(rough, r"0\.00300 ±0\.0 % \| +12\.0 \| +20\.0 \| +6\.67 % ")
        found = read_figures(self.path("out", "figures.json"))
        for key, value in (("step", 2e-3), ("products", 20), ("share", 0.1), ("rough.step", 3e-3),
                           ("rough.products", 20), ("rough.share", 0.2 / 3)):
            self.assertAlmostEqual(found[f"{key}.elp4_frame.fast.n257.t5"], value, places=6)
        os.remove(paths["rough"])
        self.report(points=[point("elp4_frame", 129)])
        self.assertNotIn("rough scene", self.text())
        self.assertFalse({key for key in read_figures(self.path("out", "figures.json")) if "products." in key})

    def test_two_threads_of_older_files_have_an_interval_and_undecided_ones_a_mark(self):
        one = [1.8e-3, 1.82e-3, 1.78e-3, 1.8e-3, 1.81e-3, 1.79e-3]
        rows = [TwoThreads(50.0, 129, "group2_frame", 0.1, 1e-13, one, [1e-3] * 6),
                TwoThreads(50.0, 65, "group2_frame", 0.1, 1e-13, one[:2], [1e-3] * 2)]
        lines = self.report(points=[point()], threads=rows)
        decided, undecided = (next(cells for cells in lines if cells[:2] == ["group2\\_frame", n])
                              for n in ("129", "65"))
        self.assertEqual((decided[3:5], decided[6]), (["1.78", "1.00"], "6"))
        self.assertRegex(decided[5], r"^1\.80 ±0\.8 %$")
        self.assertEqual(undecided[5], "1.81 †")
        found = read_figures(self.path("out", "figures.json"))
        keys = [f"threads.group2_frame.n129.t50{end}" for end in (".low", "", ".high")]
        self.assertEqual([found[key] for key in keys], sorted(found[key] for key in keys))
        self.assertAlmostEqual(found[keys[1]], 1.8, places=3)

    def test_without_scipy_it_says_what_to_install(self):
        self.write("without/scipy.py", "raise ImportError\n")
        found = run([sys.executable, "-B", *RENDERING, write_scaling(self.folder)],
                    env=environment(PYTHONPATH=self.path("without"), ISOSYRK_PYTHON=None))
        self.assert_refused(found, "render scaling: no Python with scipy found", "install python3-scipy")

    def test_ablations(self):
        self.assertEqual(ablations_of(listed("group2")), ("published", "without any", "without newton",
                                                      "without predictor",
                                                      "without bands", "fast"))
        # What fast forms no longer do without is read in older files, and not timed again.
        self.assertEqual({*ABLATIONS} - {*ablations_of(listed("elp6"))}, {"without single precision"})
        self.assertEqual(ablations_of(listed("magnus5")), ("published", "without bands", "fast"))
        self.assertEqual(ablations_of(listed("rkmk4")), ("published", "without any", "without graded series",
                                                     "without bands", "fast"))
        for name in ("group5", "elp4_frame", "rk4"):
            self.assertEqual(ablations_of(listed(name)), ("published", "without bands", "fast"))
        self.assertEqual(ablations_of(listed("bm2")), ("published",))  # it has no fast form
        self.assertEqual([without(listed(name), "without any") for name in ("group2", "rk4", "magnus4")],
                         [("bands", "predictor", "newton"), ("bands",), ("bands",)])


class Refused(ScalingTest):
    def refused(self, *parts, **tables):
        self.assert_refused(run_script(*RENDERING, write_tables(self.path("raw.json"), **tables), "--out",
                                       self.path("out")), "raw.json", *parts)
        self.assertFalse(os.path.exists(self.path("out")))

    def test_folders_that_cannot_be_written(self):
        self.assert_refused(run_script(*RENDERING, write_scaling(self.folder), "--out", self.write("taken", "")),
                            "taken")
        self.assertEqual(run_script(*RENDERING, write_scaling(self.folder), "--out", self.path("out")).returncode, DONE)


if __name__ == "__main__":
    unittest.main()
