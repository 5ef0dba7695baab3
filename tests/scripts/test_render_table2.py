"""Tests of scripts/render_table2 on made-up raw files: what it shows in this process, the rest as a user meets it."""

import json
import re

from programs import FORMULATIONS, RENDER, FolderTest, run_script, text_of
from lib.pages.document import as_text
from studies.tables.report import table2
from test_reproduce import raw_file

RENDERING = RENDER, "table2"


class RenderTable2(FolderTest):
    def setUp(self):
        super().setUp()
        self.raw = raw_file(tables=("table2", "table1"))
        for row in self.raw["benchmarks"]:
            table, formulation, _, stages = row["run_name"].split("/")
            milliseconds = 2.0 * int(stages[-1]) + FORMULATIONS.index(formulation)
            row["cpu_time"] = milliseconds / (2 if table == "table2" else 1)

    def put(self, name, raw):
        return self.write(name, json.dumps(raw))

    def rows(self, name):
        """Returns the rows of this name, to be changed there."""
        return [row for row in self.raw["benchmarks"] if row["run_name"] == name]

    def text(self):
        return as_text(table2(self.put("raw.json", self.raw)))

    def gains(self):
        """Returns the rows of n = 17 in "Table 1 over Table 2": {row: three texts}."""
        section = self.text().split("Table 1 over Table 2\n")[1].split("Ratios to the fastest")[0]
        lines = [re.sub(r" \([^ ]*\)", "", line).split() for line in section.splitlines()]  # without the intervals
        start = next(index for index, words in enumerate(lines) if words[:1] == ["17"])
        return {" ".join(words[:-3]).removeprefix("17 "): words[-3:] for words in lines[start:start + 4]}

    def test_gains_are_ratios_of_medians_and_the_last_row_compares_the_fastest_of_each_side(self):
        for row in self.rows("table2/algebra/n:17/s:1"):
            row["cpu_time"] = 0.5  # cotangent, the fastest published row, takes 2
        self.assertEqual(self.gains(), {"cotangent": ["2.00"] * 3, "group": ["2.00"] * 3,
                                        "algebra": ["8.00", "2.00", "2.00"],
                                        "fastest row": ["4.00*", "2.00*", "2.00*"]})

    def test_a_failed_cell_has_no_gain(self):
        for row in self.rows("table1/group/n:17/s:2"):
            row.update(error_occurred=True, error_message="diverged at step 3")
        self.assertEqual(self.gains()["group"], ["2.00", "–", "2.00"])

    def test_what_is_not_measured_is_not_marked(self):
        text = self.text()  # the rows of n = 33 and more
        self.assertRegex(text, r"fastest row .*\*\n")
        self.assertRegex(text, r"fastest row +– +– +–\n")
        self.assertNotIn("–*", text)

    def test_claims_are_judged_on_the_fast_forms(self):
        for stages in (1, 2, 3):
            for row in self.rows(f"table2/algebra/n:17/s:{stages}"):
                row["cpu_time"] /= 10
        claims = self.text().split("The paper's claims")[1]
        self.assertRegex(claims, r"17  holds, \S+ +fails, \S+ +fails, \S+ +fails, ")

    def test_verdicts_have_both_implementations(self):
        run_script(*RENDERING, self.put("raw.json", self.raw), "--out", self.path("out"))
        found = json.loads(text_of(self.path("out", "verdicts.json")))
        sides = [each["implementation"] for each in found["verdicts"]]
        self.assertEqual((sides.count("published"), sides.count("fast")), (9, 9))

    def test_rows_of_two_threads_do_not_enter_the_table(self):
        alone = self.text()
        self.raw["benchmarks"] += [{**row, "run_name": f"{row['run_name']}/threads:2", "cpu_time": 2 * row["cpu_time"]}
                                   for row in self.raw["benchmarks"]]
        self.assertEqual(self.text(), alone)

    def test_foreign_files_are_refused(self):
        one = self.put("one.json", raw_file(tables=("table2",)))
        table1 = self.put("table1.json", raw_file())
        for raw, *parts in ((one, "one.json", "table1/"), (table1, "table1.json", "table1", "table2")):
            self.assert_refused(run_script(*RENDERING, raw), *parts)
