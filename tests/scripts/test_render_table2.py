"""Tests of scripts/render_table2 on made-up raw files, by running it as a user does."""

import json
import os
import sys
import unittest

from programs import DONE, ROOT, FolderTest, run
from test_reproduce import raw_file

SCRIPT = os.path.join(ROOT, "scripts", "render_table2")


class RenderTable2(FolderTest):
    def render(self, raw, *arguments):
        return run([sys.executable, SCRIPT, self.write("raw.json", json.dumps(raw)), *arguments])

    def rendered(self, raw, *arguments):
        done = self.render(raw, *arguments)
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        return done.stdout

    def gains(self, raw):
        """Returns the rows of n = 17 in "Table 1 over Table 2": {row: three texts}."""
        section = self.rendered(raw).split("Table 1 over Table 2\n")[1].split("Ratios to the fastest")[0]
        lines = [line.split() for line in section.splitlines()]
        start = next(index for index, words in enumerate(lines) if words[:1] == ["17"])
        return {" ".join(words[:-3]).removeprefix("17 "): words[-3:] for words in lines[start:start + 4]}

    def both(self):
        return raw_file(tables=("table2", "table1"))

    def test_gains_are_ratios_of_medians(self):
        self.assertEqual(self.gains(self.both())["group"], ["2.00"] * 3)

    def test_the_last_row_compares_the_fastest_of_each_side(self):
        raw = self.both()
        for row in raw["benchmarks"]:
            if row["run_name"] == "table2/algebra/n:17/s:1":
                row["cpu_time"] = 0.5  # cotangent, the fastest published row, takes 2.03
        gains = self.gains(raw)
        self.assertEqual(gains["fastest row"], ["4.06*", "2.00*", "2.00*"])
        self.assertEqual(gains["algebra"][0], "8.06")

    def test_a_failed_cell_has_no_gain(self):
        raw = self.both()
        for row in raw["benchmarks"]:
            if row["run_name"] == "table1/group/n:17/s:2":
                row.update(error_occurred=True, error_message="diverged at step 3")
        self.assertEqual(self.gains(raw)["group"], ["2.00", "–", "2.00"])

    def test_claims_are_judged_on_the_fast_forms(self):
        raw = self.both()
        for row in raw["benchmarks"]:
            if row["run_name"].startswith("table2/algebra"):
                row["cpu_time"] /= 10
        claims = self.rendered(raw).split("The paper's claims")[1]
        self.assertRegex(claims, "17  2  does not hold")
        self.assertRegex(claims, "17  1  holds")

    def test_every_format_is_written(self):
        for form, mark in (("markdown", "| --:"), ("latex", "\\toprule"), ("text", "Table 2")):
            self.assertIn(mark, self.rendered(self.both(), "--format", form))

    def one_and_two(self):
        """Returns a run with one and with two threads."""
        return raw_file(tables=("table2",), threads=(1, 2))

    def with_threads(self, two=None):
        return ("--threads", self.write("threads.json", json.dumps(two or self.one_and_two())))

    def threads_section(self, two=None):
        return self.rendered(self.both(), *self.with_threads(two)).split("One thread over two\n")[1]

    def test_two_threads_are_compared_by_the_time_that_passes(self):
        section = self.threads_section()
        self.assertRegex(section, r"17 +cotangent +1\.60 \(1\.60\) +1\.60 \(1\.60\) +1\.60 \(1\.60\)")
        self.assertIn("Left out: 0 of 63 pairs", section)
        self.assertNotIn("One thread over two", self.rendered(self.both()))

    def test_two_threads_are_compared_run_by_run(self):
        two = self.one_and_two()
        times = {"table2/group/n:17/s:2": (1, 1, 1, 1, 10, 10, 10),
                 "table2/group/n:17/s:2/threads:2": (0.5, 0.5, 0.5, 5, 5, 5, 5)}  # medians: 1 over 5
        for row in two["benchmarks"]:
            if row["run_name"] in times:
                row["real_time"] = times[row["run_name"]][row["repetition_index"]]
        self.assertIn("1.60 (1.60)  2.00 (2.00)", self.threads_section(two))

    def disturbed(self, name, values, threads):
        """Returns a comparison with these values of a counter in the repetitions of group, s = 2.

        Times are twice as long where the host took more than 2 % or left less than 1.8 cores.
        """
        two = self.one_and_two()
        for row in two["benchmarks"]:
            row[name] = {"stolen": 0.0, "cores_at_once": 1.97}[name]
            if row["run_name"] == "table2/group/n:17/s:2" + ("/threads:2" if threads == 2 else ""):
                row[name] = values[row["repetition_index"]]
                row["real_time"] *= 2 if (row[name] > 0.02 if name == "stolen" else row[name] < 1.8) else 1
        return " ".join(self.threads_section(two).split())

    def test_pairs_that_the_host_disturbed_or_put_on_one_core_are_left_out(self):
        for name, values, threads in (("stolen", (0.3, 0.02, 0, 0, 0.021, 0, 0), 2),
                                      *(("cores_at_once", (2.05, 1.0, 1.8, 1.9, 1.79, 2, 2), each) for each in (1, 2))):
            section = self.disturbed(name, values, threads)
            self.assertIn("Left out: 2 of 63 pairs", section)
            self.assertIn("group 1.60 (1.60) 1.60 (1.60)", section)

    def test_a_cell_with_few_undisturbed_pairs_is_left_out(self):
        section = self.disturbed("stolen", (0.3, 0.3, 0.3, 0, 0, 0, 0), 2)
        self.assertIn("Left out: 3 of 63 pairs", section)
        self.assertIn("group 1.60 (1.60) – 1.60 (1.60)", section)

    def test_a_cell_that_failed_with_two_threads_has_no_speed_up(self):
        two = self.one_and_two()
        for row in two["benchmarks"]:
            if row["run_name"] == "table2/group/n:17/s:2/threads:2":
                row.update(error_occurred=True, error_message="diverged at step 3")
        section = self.threads_section(two)
        self.assertRegex(section, r"group +1\.60 \(1\.60\) +– +1\.60")

    def test_rows_of_two_threads_do_not_enter_the_table(self):
        raw = self.both()
        raw["benchmarks"] += raw_file(tables=("table2",), threads=(2,))["benchmarks"]
        self.assertEqual(self.rendered(raw), self.rendered(self.both()))

    def test_what_is_refused(self):
        option, path = self.with_threads()
        one = self.write("one.json", json.dumps(raw_file(tables=("table2",))))
        for raw, further, *parts in (
                (self.both(), (option, one), "one.json", "table2/"),
                (self.both(), (option, path, "--output", path), "is the raw file itself"),
                (raw_file(tables=("table2",)), (), "raw.json", "table1/"), (raw_file(), (), "raw.json", "table1", "table2")):
            self.assert_refused(self.render(raw, *further), *parts)


if __name__ == "__main__":
    unittest.main()
