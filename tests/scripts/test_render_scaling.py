"""Tests of scripts/render_scaling on a made-up study: its figures by their rule, its files, and what it refuses."""

import json
import os
import unittest

import programs
from drawing import DrawingTest
from programs import DONE, FolderTest, run, snapshot
from scaling_documents import PEAK_GFLOPS, PRODUCT_SECONDS, scaling_document

from document import as_text
from scaling import ladder, read_scaling, scaling
from scaling_report import scaling_sections

FILES = {"report.md", "report.txt", *(f"{chart}.{kind}" for chart in ("cost_against_n", "ladder_of_ideas") for kind in ("svg", "png"))}


class Figures(unittest.TestCase):
    def setUp(self):
        self.study = scaling(scaling_document())

    def test_the_floor_lies_below_the_products(self):
        for point in self.study.points:
            self.assertAlmostEqual(point.cubic, point.products * PRODUCT_SECONDS * point.n**3)
            self.assertAlmostEqual(point.floor, 8 * point.products * point.n**3 / (1e9 * PEAK_GFLOPS))
            self.assertLess(point.floor, point.cubic)

    def test_the_ladder_has_what_the_default_takes(self):
        rungs = [idea for idea, _ in ladder(self.study.ideas["group", 17, 1])]
        self.assertEqual(rungs, ["published", "structure and planar products", "start values", "corrections in single precision"])
        rungs = [idea for idea, _ in ladder(self.study.ideas["algebra", 17, 1])]
        self.assertEqual(rungs, ["published", "structure and planar products", "start values"])

    def test_what_is_left_out_is_told_with_its_figures(self):
        text = as_text(scaling_sections(self.study, ()))
        rest = text.split("What did not pay")[1]
        self.assertRegex(rest, r"acceleration +41\.0 +41\.0")
        self.assertRegex(rest, r"start order 4 +80\.0 +80\.0")
        self.assertNotIn("corrections", rest)


class Files(DrawingTest):
    script = "render_scaling"

    def render_study(self, document, *arguments, **options):
        raw = document if isinstance(document, str) else self.write("raw.json", json.dumps(document))
        return self.render(raw, *arguments, **options)

    def test_charts_and_reports_are_whole_and_the_same_every_time(self):
        for folder, apart in (("one", False), ("two", True)):
            done = self.render_study(scaling_document(sizes=(17, 65, 129)), "--out", self.path(folder), apart=apart)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (DONE, "", ""))
        files = snapshot(self.path("one"))
        self.assertEqual(set(files), FILES)
        self.assertTrue(files == snapshot(self.path("two")))
        self.assertTrue(all(files[name].endswith(b"IEND\xaeB`\x82") for name in files if name.endswith(".png")))

    def test_unusable_files(self):
        def without(field):
            document = scaling_document()
            del document[field]
            return document

        def changed(**fields):
            document = scaling_document()
            document["points"][3].update(fields)
            return document

        twice = scaling_document()
        twice["points"].append(twice["points"][0])
        no_default = scaling_document()
        no_default["ideas"] = [each for each in no_default["ideas"] if each["idea"] != "by default"]
        for document, *parts in (
                ("missing.json", "missing.json", "No such file"), (without("h_norm_B"), "h_norm_B"),
                ({**scaling_document(), "points": []}, "no points"), (twice, "two points of one cell"),
                (no_default, "by default"), (changed(formulation="other"), "point 4", "formulation"),
                (changed(seconds_per_step=[]), "point 4", "seconds_per_step"),
                (changed(seconds_per_step=[float("nan")]), "point 4", "seconds_per_step"),
                (changed(product_seconds=[0]), "point 4", "product_seconds"), (changed(n=True), "point 4 has n"),
                (changed(peak_gflops="fast"), "point 4", "peak_gflops")):
            with self.subTest(parts=parts):
                self.assert_refused(self.render_study(document, "--out", self.path("charts")), "render_scaling: ", *parts)
                self.assertFalse(os.path.exists(self.path("charts")))

    def test_arguments(self):
        self.assert_refused(self.render_study(scaling_document()), "--out")
        self.assert_refused(self.render_study(scaling_document(), "--out", self.write("taken", "")), "cannot be written")


@unittest.skipIf(programs.SANITIZED, "times nothing")
class Program(FolderTest):
    def test_what_the_program_writes_is_read(self):
        out = self.path("raw.json")
        done = run([programs.program("scaling"), "--quick", "--n", "9", "--n", "17", "--seconds", "1e-3", "--out", out], timeout=300)
        self.assertEqual((done.returncode, done.stdout), (DONE, ""), done.stderr)
        study = read_scaling(out)
        self.assertEqual((study.sizes(), study.idea_sizes()), ([9, 17], [17]))
        self.assertEqual(len(study.points), 18)
        for cell in study.ideas.values():
            self.assertLess(cell["predictor"].sweeps, cell["structure and split products"].sweeps)

    def test_bad_arguments(self):
        for arguments, part in ((("--out", self.path("no", "raw.json")), "--out"), (("--n", "4"), "--n"), ((), "--out"),
                                (("--n", "x"), "--n"), (("--seconds", "0"), "--seconds")):
            with self.subTest(arguments=arguments):
                out = () if "--out" in arguments or not arguments else ("--out", self.path("raw.json"))
                self.assert_refused(run([programs.program("scaling"), *arguments, *out]), part)
                self.assertFalse(os.path.exists(self.path("raw.json")))


if __name__ == "__main__":
    unittest.main()
