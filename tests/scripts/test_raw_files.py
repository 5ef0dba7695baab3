"""What every reader of a study's raw file refuses: files that are missing, cut or of something else."""

import json
import os
import sys
import unittest

from programs import ROOT, FolderTest
from study_documents import study_document
from wrong_values import WRONG

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
from benchmark_json import UnusableFile  # noqa: E402
from raw_files import Fields  # noqa: E402
from work_precision import read_study  # noqa: E402

# The program, its reader, a sound document, and the lists of objects that it has.
STUDIES = (("work_precision", read_study, study_document, ("references", "integrators", "points", "tolerance_points")),)

# What the programs write and no reader needs, and what may be left out.
NOT_NEEDED = {"scene", "norm_ad_B", "linear_limit", "critical", "failed_step", 
              "poisson_solves_per_step"}
# How a kind of field is read, of those in wrong_values.py.
KINDS = {"text": Fields.text, "truth": Fields.truth, "not negative": Fields.not_negative, "positive": Fields.positive,
         "optional": Fields.optional, "count": Fields.whole, "positive count": lambda fields, name: fields.whole(name, 1),
         "casimirs": lambda fields, name: fields.numbers(name, 4), "object": Fields.object}


class RawFiles(FolderTest):
    def assert_unusable(self, read, contents, *words):
        """Refused in one line that names the file and has every one of `words` in it."""
        path = self.write("raw.json", contents if isinstance(contents, str) else json.dumps(contents))
        with self.assertRaises(UnusableFile) as caught:
            read(path)
        self.assert_one_line(f"{caught.exception}\n", path, *words)

    def test_every_study(self):
        for program, read, make, lists in STUDIES:
            document = make()
            with self.subTest(program=program):
                read(self.write("sound.json", json.dumps(document)))
                with self.assertRaisesRegex(UnusableFile, r"none\.json: cannot be read: No such file"):
                    read(self.path("none.json"))
                self.assert_unusable(read, " \n", "is empty")
                whole = json.dumps(document)
                for length in (1, 100, len(whole) // 2, len(whole) - 1):
                    self.assert_unusable(read, whole[:length], "is not whole JSON")
                foreign = (7, None, [], {}, '"text"', *(other() for name, _, other, _ in STUDIES if name != program))
                for value in foreign:
                    self.assert_unusable(read, value, f"was not written by {program}")
                for value in (None, 1, [], f"isosyrk {program} 9"):
                    self.assert_unusable(read, {**document, "format": value}, f"was not written by {program}")
                for value in (None, [], "context", 3):
                    self.assert_unusable(read, {**document, "context": value}, "context")
                for name in lists:
                    for value in (None, {}, "points", 3, [None], [[]], [3]):
                        self.assert_unusable(read, {**document, name: value}, name)
                    self.assert_unusable(read, {key: value for key, value in document.items() if key != name}, name)

    def test_every_field_of_every_object_is_required(self):
        for _, read, make, lists in STUDIES:
            document = make()
            for name in lists:
                each = document[name][0]
                for field in set(each) - NOT_NEEDED:
                    sound = each.pop(field)
                    self.assert_unusable(read, document, field)
                    each[field] = sound
            read(self.write("sound.json", json.dumps(document)))

    def test_a_field_must_be_of_its_kind(self):
        for kind, read in KINDS.items():
            for value in WRONG[kind]:
                with self.subTest(kind=kind, value=str(value)[:20]), self.assertRaisesRegex(UnusableFile, "a thing has x"):
                    read(Fields({"x": value}, "a thing"), "x")
            with self.assertRaisesRegex(UnusableFile, "a thing has no x"):
                read(Fields({}, "a thing"), "x")

    def test_a_table_is_read_as_its_rows(self):
        for _, read, make, lists in STUDIES:
            document = make()
            expected = read(self.write("sound.json", json.dumps(document)))
            name = lists[-1]
            columns = list(dict.fromkeys(key for each in document[name] for key in each))
            rows = [[each.get(key) for key in columns] for each in document[name]]
            document[name] = {"columns": columns, "rows": rows}
            self.assertEqual(read(self.write("table.json", json.dumps(document))), expected)
            rows[1].pop()
            self.assert_unusable(read, document, f"rows of {name}")
            rows[1].append(None)
            columns[0] = 1
            self.assert_unusable(read, document, f"columns of {name}")


if __name__ == "__main__":
    unittest.main()
