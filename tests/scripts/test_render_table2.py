"""Tests of scripts/render_table2 on made-up raw files: what it shows in this process, the rest as a user meets it."""

import json
import os
import runpy

from programs import ROOT, FolderTest, run_script
from document import as_text
from test_reproduce import raw_file

SCRIPT = os.path.join(ROOT, "scripts", "render_table2")
table2 = runpy.run_path(SCRIPT)["table2"]
GROUP2 = "table2/group/n:17/s:2"


class RenderTable2(FolderTest):
    def setUp(self):
        super().setUp()
        self.raw = raw_file(tables=("table2", "table1"))
        self.two = raw_file(tables=("table2",), threads=(1, 2))  # with one and with two threads

    def put(self, name, raw):
        return self.write(name, json.dumps(raw))

    def rows(self, name):
        """Returns the rows of this name, to be changed there."""
        return [row for raw in (self.raw, self.two) for row in raw["benchmarks"] if row["run_name"] == name]

    def text(self):
        return as_text(table2(self.put("raw.json", self.raw)))

    def gains(self):
        """Returns the rows of n = 17 in "Table 1 over Table 2": {row: three texts}."""
        section = self.text().split("Table 1 over Table 2\n")[1].split("Ratios to the fastest")[0]
        lines = [line.split() for line in section.splitlines()]
        start = next(index for index, words in enumerate(lines) if words[:1] == ["17"])
        return {" ".join(words[:-3]).removeprefix("17 "): words[-3:] for words in lines[start:start + 4]}

    def threads_section(self):
        text = as_text(table2(self.put("raw.json", self.raw), self.put("threads.json", self.two)))
        return " ".join(text.split("One thread over two\n")[1].split())

    def test_gains_are_ratios_of_medians_and_the_last_row_compares_the_fastest_of_each_side(self):
        for row in self.rows("table2/algebra/n:17/s:1"):
            row["cpu_time"] = 0.5  # cotangent, the fastest published row, takes 2.03
        self.assertEqual(self.gains(), {"cotangent": ["2.00"] * 3, "group": ["2.00"] * 3, "algebra": ["8.06", "2.00", "2.00"],
                                        "fastest row": ["4.06*", "2.00*", "2.00*"]})

    def test_a_failed_cell_has_no_gain(self):
        for row in self.rows("table1/group/n:17/s:2"):
            row.update(error_occurred=True, error_message="diverged at step 3")
        self.assertEqual(self.gains()["group"], ["2.00", "–", "2.00"])

    def test_claims_are_judged_on_the_fast_forms(self):
        for stages in (1, 2, 3):
            for row in self.rows(f"table2/algebra/n:17/s:{stages}"):
                row["cpu_time"] /= 10
        claims = self.text().split("The paper's claims")[1]
        self.assertRegex(claims, "17  2  does not hold")
        self.assertRegex(claims, "17  1  holds")

    def test_two_threads_are_compared_by_the_time_that_passes_run_by_run(self):
        times = {GROUP2: (1, 1, 1, 1, 10, 10, 10), f"{GROUP2}/threads:2": (0.5, 0.5, 0.5, 5, 5, 5, 5)}  # medians: 1 over 5
        for name in times:
            for row in self.rows(name):
                row["real_time"] = times[name][row["repetition_index"]]
        section = self.threads_section()
        self.assertIn("17 cotangent 1.60 (1.60) 1.60 (1.60) 1.60 (1.60) group 1.60 (1.60) 2.00 (2.00)", section)
        self.assertIn("Left out: 0 of 63 pairs", section)
        self.assertNotIn("One thread over two", self.text())

    def test_pairs_that_the_host_disturbed_or_put_on_one_core_are_left_out(self):
        quiet = {"stolen": 0.0, "cores_at_once": 1.97}
        # More than 2 % of the time, fewer than 1.8 cores: then a run takes twice as long.
        for counter, values, disturbed, threads, shown in (
                ("stolen", (0.3, 0.02, 0, 0, 0.021, 0, 0), (0, 4), 2, "1.60 (1.60)"),
                *(("cores_at_once", (2.05, 1.0, 1.8, 1.9, 1.79, 2, 2), (1, 4), each, "1.60 (1.60)") for each in (1, 2)),
                ("stolen", (0.3, 0.3, 0.3, 0, 0, 0, 0), (0, 1, 2), 2, "–")):  # too few are left
            self.two = raw_file(tables=("table2",), threads=(1, 2))
            for row in self.two["benchmarks"]:
                row.update(quiet)
            for row, value in zip(self.rows(GROUP2 + ("/threads:2" if threads == 2 else ""))[-7:], values):
                row[counter] = value
                row["real_time"] *= 2 if row["repetition_index"] in disturbed else 1
            section = self.threads_section()
            self.assertIn(f"Left out: {len(disturbed)} of 63 pairs", section)
            self.assertIn(f"group 1.60 (1.60) {shown} 1.60 (1.60)", section)

    def test_a_cell_that_failed_with_two_threads_has_no_speed_up(self):
        for row in self.rows(f"{GROUP2}/threads:2"):
            row.update(error_occurred=True, error_message="diverged at step 3")
        self.assertIn("group 1.60 (1.60) – 1.60 (1.60)", self.threads_section())

    def test_rows_of_two_threads_do_not_enter_the_table(self):
        alone = self.text()
        self.raw["benchmarks"] += raw_file(tables=("table2",), threads=(2,))["benchmarks"]
        self.assertEqual(self.text(), alone)

    def test_foreign_files_are_refused(self):
        raw, two = self.put("raw.json", self.raw), self.put("two.json", self.two)
        one = self.put("one.json", raw_file(tables=("table2",)))
        table1 = self.put("table1.json", raw_file())
        for arguments, *parts in (((raw, "--threads", one), "one.json", "table2/"),
                                  ((raw, "--threads", two, "--output", two), "is the raw file itself"),
                                  ((one,), "one.json", "table1/"), ((table1,), "table1.json", "table1", "table2")):
            self.assert_refused(run_script(SCRIPT, *arguments), *parts)
