"""Tests of the check of pages: a figure is printed as it was found, with its key, and is in figures.json."""

import unittest

from programs import FolderTest

from lib.pages.figures import as_json, faults, read_figures
from lib.programs.messages import UnusableFile

FIGURES = {"study:ratio": 1.8461, "study:other": 1.5, "study:cases": 47, "study:all": 75, "study:error": 2.28e-13,
           "study:share": 0.0643, "study:drift": -0.25, "study:steps": 10000}


class Page(unittest.TestCase):
    def assert_faults(self, page, *parts, whole=True):
        found = faults(page, FIGURES, whole)
        self.assertEqual(len(found), len(parts), (page, found))
        for fault, part in zip(found, parts):
            self.assertIn(part, fault)

    def test_figures_as_printed(self):
        for page in ("1.8<!-- study:ratio --> times", "1.85<!-- study:ratio -->", "2<!-- study:ratio -->",
                     "1.5–1.8<!-- study:other study:ratio -->", "1.5-1.8<!-- study:other study:ratio -->",
                     "47 of 75<!-- study:cases study:all -->", "**2e-13<!-- study:error -->**",
                     "2.3e-13<!-- study:error -->", "6.4 %<!-- study:share -->", "6%<!-- study:share -->",
                     "−0.25<!-- study:drift -->", "10,000<!-- study:steps --> steps",
                     "| group | 1.8 | 47<!-- study:ratio\nstudy:cases --> |"):
            with self.subTest(page=page):
                self.assert_faults(page)

    def test_a_wrong_digit(self):
        for page, *told in (("1.9<!-- study:ratio -->", "1.9 is printed where study:ratio is 1.8461"),
                           ("1.84<!-- study:ratio -->", "1.84"), ("1.80<!-- study:ratio -->", "1.80"),
                           ("3e-13<!-- study:error -->", "2.28e-13"), ("2e-12<!-- study:error -->", "2e-12"),
                           ("2.2e-13<!-- study:error -->", "2.2e-13"), ("6.5 %<!-- study:share -->", "6.43 %"),
                           ("6.4<!-- study:share -->", "0.0643"), ("0.25<!-- study:drift -->", "-0.25"),
                           ("75 of 47<!-- study:cases study:all -->", "75 is", "47 is"),
                            ("48<!-- study:cases -->", "48")):
            with self.subTest(page=page):
                self.assert_faults(page, *told)
        self.assert_faults("a\nb\n1.8 and\n1.9<!-- study:ratio study:other -->", "line 4: 1.9")

    def test_a_missing_key(self):
        for page in ("takes 1.8 times", "1.8<!-- a comment --> times", "1.8<!-- study.ratio -->", "- 7 problems",
                     "1.8<!-- study:ratio --> to 1.9", "# 3 answers", "| n | time |\n| --: | --: |\n| 17 | 1.8 |",
                     "n = 129, 12 times", "n = 17 and 1.8 times", "an error 1e-12", "h‖B‖₂ between 1.58 and", "T 50",
                     "at 1e-4.5"):
            with self.subTest(page=page):
                self.assert_faults(page, "without a key")
        for page in ("1.8 and 1.9<!-- study:ratio -->", "<!-- study:ratio -->", "1.8<!-- study:ratio study:other -->"):
            with self.subTest(page=page):
                self.assert_faults(page, " before study:ratio")

    def test_an_unknown_key(self):
        self.assert_faults("1.8<!-- study:ratios -->", "study:ratios is in no figures.json")
        self.assert_faults("1.8<!-- other:ratio -->", "other:ratio")

    def test_what_needs_no_key(self):
        for page in ("at n = 17, 33 and 65.", "n = 17 to 257, s ≥ 2, s = 1, 2, 3;", "h = 0.1 to T = 5", "T = 5 and 50,",
                     "from t = 5 and t = 50 on",
                     "h‖B(W₀)‖₂ = 0.25", "h‖B‖₂ up to 0.6", "tolerance 1e-13", "tolerance of 1e-13", "At 1e-6 the",
                     "at an error of 1e-6", "at errors 1e-4 … 1e-8.", "order 4", "orders 4 and 6,",
                     "on 23 November 2026", "2026-11-23",
                     "commit 0f714c93e0c6", "51d0c50e6a43", "1. first\n2. second", "Table 1", "Tables 1 and 2",
                     "`--n 17`", "```sh\nrun 17\n```", "[a](b/17.md)", "group6, RKMK4, AVX-512, AVX2", "W(5), so(3)",
                     "GNU 12.2.0, Debian 12, C++20", "2 × 2 blocks", "| n | s |\n| --: | --: |\n| 17 | 1 |",
                     "| s = 1 | s = 2 |\n| --- | --- |\n", "<!-- written 17 times -->", "n =\n129"):
            with self.subTest(page=page):
                self.assert_faults(page)

    def test_what_is_looked_at(self):
        page = "7\n<!-- table1:begin -->\n8\n<!-- table1:end -->\n<!-- figures:begin -->\n9\n<!-- figures:end -->\n"
        self.assert_faults(page, "line 6: 9 without", whole=False)
        self.assert_faults(page, "line 1: 7, 9 without")
        for broken in (page.replace("figures:end", "table1:end"), page.replace("<!-- table1:end -->", ""),
                       page.replace("<!-- figures:end -->", ""), page.replace("table1:begin", "table1:end")):
            with self.subTest(page=broken), self.assertRaises(ValueError):
                faults(broken, FIGURES)


class File(FolderTest):
    def test_what_is_written_is_read(self):
        path = self.write("figures.json", as_json({"b": 1.23456789e-7, "a": 47}))
        with open(path, encoding="utf-8") as file:
            self.assertEqual(file.read(), '{\n  "a": 47,\n  "b": 1.23457e-07\n}\n')
        self.assertEqual(read_figures(path), {"a": 47, "b": 1.23457e-7})
        for value in (float("nan"), float("inf")):
            with self.assertRaises(ValueError):
                as_json({"a": value})

    def test_what_is_no_file_of_figures(self):
        for text, part in (("", "is empty"), ("[]", "no object"), ('{"a": "1"}', "it has a"),
                           ('{"a": NaN}', "it has a"),
                           ('{"a": 1', "whole JSON")):
            path = self.write("figures.json", text)
            with self.subTest(text=text), self.assertRaises(UnusableFile) as caught:
                read_figures(path)
            self.assert_one_line(f"{caught.exception}\n", path, part)


if __name__ == "__main__":
    unittest.main()
