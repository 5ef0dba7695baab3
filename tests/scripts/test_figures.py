"""Tests of figures.json: what is written is read, and what is no file of figures is refused."""

import unittest

from programs import FolderTest

from lib.pages.figures import as_json, read_figures
from lib.programs.messages import UnusableFile


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
