"""Tests of findings.json and figures.json: what is written is read, to six digits; damaged findings are refused."""

import copy
import json
import math
import os
import unittest
from typing import List, NamedTuple

from programs import ROOT, FolderTest, text_of

from lib.pages import figures
from lib.programs.messages import UnusableFile
from lib.records.findings import FILE, as_json, read_findings, record_classes
from lib.records.formats import finite, list_of, number, one_of, optional, text, truth, whole
from studies.accuracy import judge as accuracy
from studies.practice import judge as practice
from studies.theorem import judge as theorem
from studies.turbulence import judge as turbulence

RECORDED = os.path.join(ROOT, "results", "recorded")
FINDINGS = {"accuracy": accuracy.Findings, "theorem": theorem.Findings, "turbulence": turbulence.Findings,
            "practice": practice.Findings}
HOMES = ("sea", "land")


class Bird(NamedTuple):
    name: text
    wings: whole(1)
    weight: optional(number)
    flies: truth
    home: one_of(*HOMES)
    journeys: list_of(finite)


class Nest(NamedTuple):
    eggs: whole()


class Findings(NamedTuple):
    birds: List[Bird]
    nests: List[Nest]


FOUND = Findings([Bird("tern", 2, 0.123456789, True, "sea", [-1.5, 1 / 3]),
                  Bird("rail", 2, None, False, "land", [])], [])


class File(FolderTest):
    def read(self, document):
        return read_findings(self.write(FILE, json.dumps(document)), "birds", Findings)

    def test_what_is_written_is_read_to_six_digits(self):
        path = self.write(FILE, as_json("birds", FOUND))
        self.assertEqual(text_of(path), '''{"format":"isosyrk findings 1","study":"birds","tables":{
"birds":{"columns":["name","wings","weight","flies","home","journeys"],"rows":[
["tern",2,0.123457,true,"sea",[-1.5,0.333333]],
["rail",2,null,false,"land",[]]
]},
"nests":{"columns":["eggs"],"rows":[

]}
}}
''')
        tern, rail = FOUND.birds
        self.assertEqual(read_findings(path, "birds", Findings), Findings(
            [tern._replace(weight=0.123457, journeys=(-1.5, 0.333333)), rail._replace(journeys=())], []))

    def test_what_is_no_finding_is_not_written(self):
        tern, _ = FOUND.birds
        for wrong, problem in ((tern._replace(wings=0), UnusableFile), (tern._replace(home="sky"), UnusableFile),
                               (tern._replace(weight=math.nan), ValueError),
                               (tern._replace(journeys=[math.inf]), ValueError)):
            with self.subTest(wrong=wrong), self.assertRaises(problem):
                as_json("birds", FOUND._replace(birds=[wrong]))

    def test_another_file_is_refused(self):
        whole_file = json.loads(as_json("birds", FOUND))
        for changes, part in (({"format": "isosyrk study 1"}, "no file of findings of the study birds"),
                              ({"study": "bees"}, '"bees"'), ({"tables": []}, "an object"),
                              ({"tables": {**whole_file["tables"], "hives": {}}}, "table of hives")):
            with self.subTest(part=part), self.assertRaises(UnusableFile) as caught:
                self.read({**whole_file, **changes})
            self.assert_one_line(f"{caught.exception}\n", FILE, part)


class Figures(FolderTest):
    def test_what_is_written_is_read_to_six_digits(self):
        path = self.write("figures.json", figures.as_json({"b": 1.23456789e-7, "a": 47}))
        self.assertEqual(text_of(path), '{\n  "a": 47,\n  "b": 1.23457e-07\n}\n')
        self.assertEqual(figures.read_figures(path), {"a": 47, "b": 1.23457e-7})  # damage: test_damage
        for value in (math.nan, math.inf):
            with self.assertRaises(ValueError):
                figures.as_json({"a": value})


class Recorded(FolderTest):
    """Every table and column of every recorded file, damaged."""

    def assert_damage(self, study, document, *parts):
        with self.assertRaises(UnusableFile) as caught:
            read_findings(self.write(FILE, json.dumps(document)), study, FINDINGS[study])
        self.assert_one_line(f"{caught.exception}\n", FILE, *parts)

    def test_damage_is_refused(self):
        for study, kind in FINDINGS.items():
            whole_file = json.loads(text_of(RECORDED, study, FILE))
            self.assertEqual(list(whole_file["tables"]), list(record_classes(kind)))
            for name in whole_file["tables"]:
                # One row is enough to damage.
                whole_file["tables"][name]["rows"] = whole_file["tables"][name]["rows"][:1]
            for name, table in whole_file["tables"].items():
                damaged = copy.deepcopy(whole_file)
                del damaged["tables"][name]
                self.assert_damage(study, damaged, f"no {name}")
                for place, column in enumerate(table["columns"]):
                    with self.subTest(study=study, table=name, column=column):
                        damaged = copy.deepcopy(whole_file)
                        damaged["tables"][name]["rows"][0][place] = {}
                        self.assert_damage(study, damaged, f"a row of {name} has {column}")
                        damaged["tables"][name]["columns"][place] = "unknown"
                        self.assert_damage(study, damaged, f"table of {name} has other columns")


if __name__ == "__main__":
    unittest.main()
