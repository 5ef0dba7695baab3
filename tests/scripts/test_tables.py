"""Tests of what is rendered of Tables 1 and 2, on made-up raw files; what is refused as a user meets it."""

import itertools
import json
import math
import os
import re
import sys
import unittest

from programs import (DONE, FORMULATIONS, RENDER, ROOT, FolderTest, environment, run, run_script, strict_json,
                      text_of)

from lib.pages import document
from lib.pages.numbers import three_digits
from studies.tables.report import table1, table2
from test_reproduce import HOST_NAME, raw_file

SCRIPT = os.path.join(ROOT, "scripts", "render_table1")

# Seconds by which the paper's claims hold everywhere: algebra wins s = 1, group the rest, algebra is poor at s = 3.
SECONDS = {("cotangent", 1): 0.004, ("group", 1): 0.003, ("algebra", 1): 0.002,
           ("cotangent", 2): 0.008, ("group", 2): 0.006, ("algebra", 2): 0.009,
           ("cotangent", 3): 0.012, ("group", 3): 0.010, ("algebra", 3): 0.030}
COUNTERS = "What the time went into, and how good the answer is"


def repeated(seconds, processes=6, spread=0.0):
    """Returns the times of processes with the geometric mean `seconds`, in turn off it by `spread` down and up."""
    return [seconds * math.exp(spread if process % 2 else -spread) for process in range(processes)]


def name_of(formulation, n, stages):
    return f"table1/{formulation}/n:{n}/s:{stages}"


def rows_of(data, cell):
    return [row for row in data["benchmarks"] if row["run_name"] == name_of(*cell)]


def raw(sizes=(17, 33, 65, 129), processes=6, cells=None, **context):
    """Returns a raw file; `cells` maps (formulation, n, s) to seconds by process, to why it failed, or to None.

    Every cell ends with an aggregate, as Google Benchmark writes it: with a NaN, which is not JSON.
    """
    data = raw_file(sizes=sizes)
    data["context"].update(context)
    rows = []
    for n, (formulation, stages) in itertools.product(sizes, SECONDS):
        cell = (formulation, n, stages)
        times = (cells or {}).get(cell, repeated(SECONDS[formulation, stages] * (n / 17) ** 3, processes))
        if times is None:
            continue
        like = rows_of(data, cell)[0]
        if isinstance(times, str):
            rows.append({**like, "error_occurred": True, "error_message": times, "cpu_time": 0.0})
            continue
        rows += [{**like, "process": process, "repetition_index": 0, "cpu_time": 1e3 * time}
                 for process, time in enumerate(times)]
        rows.append({**rows[-1], "run_type": "aggregate", "cpu_time": 777777.0, "skew_defect": math.nan})
    return {**data, "benchmarks": rows}


def changed(cell, **values):
    """Returns a raw file in which every row of a cell has other values; None takes a field out."""
    data = raw()
    for row in rows_of(data, cell):
        row.update(values)
        for name in [name for name, value in values.items() if value is None]:
            del row[name]
    return data


def section(text, heading):
    """Returns one section of the text rendering, up to the next underlined heading."""
    after = text.split(f"\n{heading}\n", 1)[1].split("\n", 1)[1]
    return re.split(r"\n[^\n]+\n-+\n\n", after)[0]


def entries(text, n, formulation):
    """Returns a text table's entries of one row, found below the row that names n."""
    lines = text.splitlines()
    start = next(i for i, line in enumerate(lines) if line.split()[:2] == [str(n), "cotangent"])
    line = lines[start + FORMULATIONS.index(formulation)]
    return re.split(r"\s{2,}", line.split(formulation, 1)[1].strip())


def claim_cell(text, claim, n, stages):
    """Returns what the table of claims says at one n and s: its result and its ratio."""
    lines = (re.split(r"\s{2,}", line.strip()) for line in section(text, "The paper's claims").splitlines())
    cells = next(line for line in lines if line[0] == str(n))
    return cells[1 + (("a", 1), ("b", 2), ("b", 3), ("c", 3)).index((claim, stages))]


def pair_row(text, n, stages, row, other):
    """Returns the entries of a pair of rows: ratio, processes, verdict."""
    lines = (re.split(r"\s{2,}", line.strip()) for line in section(text, "Every pair of rows").splitlines())
    return next(line[4:] for line in lines if line[:4] == [str(n), str(stages), row, other])


class TableTest(FolderTest):
    def put(self, data):
        return self.write("raw.json", data if isinstance(data, str) else json.dumps(data))

    def render(self, data=None, style="text"):
        return document.WRITERS[style](table1(self.put(data or raw())))

    def times(self, data=None):
        return section(self.render(data), "CPU seconds")


class WhatIsShown(TableTest):
    def test_what_changes_nothing(self):
        plain = self.render()
        for change in (lambda row: row.update(run_name=row["run_name"] + "/min_time:0.500/repeats:7"),
                       lambda row: row.update(time_unit="us", cpu_time=1e3 * row["cpu_time"])):
            data = raw()
            for row in data["benchmarks"]:
                change(row)
            self.assertEqual(self.render(data), plain)
        data = raw()
        data["benchmarks"] = [row for row in reversed(data["benchmarks"]) if row["run_type"] == "iteration"]
        self.assertEqual(self.render(data), plain)

    def test_the_fastest_row_is_marked_with_what_ties_and_what_is_undecided_has_a_dagger(self):
        times = self.times()
        self.assertEqual([entries(times, 33, "algebra")[0][-1], entries(times, 33, "group")[1][-1]], ["*", "*"])
        self.assertNotIn("*", "".join(entries(times, 33, "cotangent")))
        self.assertNotIn("†", times.split("Geometric means")[0])
        times = self.times(raw(cells={("group", 17, 1): repeated(0.00204, spread=0.01)}))
        self.assertEqual([entries(times, 17, name)[0][-1] for name in FORMULATIONS], ["%", "*", "*"])
        times = self.times(raw(cells={("group", 17, 1): repeated(0.0021, spread=0.03)}))
        self.assertEqual([entries(times, 17, name)[0][-1] for name in FORMULATIONS], ["%", "†", "*"])
        times = self.times(raw(cells={("cotangent", 17, 1): None, ("algebra", 17, 1): None}))
        self.assertNotIn("*", entries(times, 17, "group")[0])  # no rival

    def test_with_fewer_than_six_processes_everything_is_undecided(self):
        text = self.render(raw(processes=5))
        times = section(text, "CPU seconds")
        for name in FORMULATIONS:
            self.assertEqual([entry[-1] for entry in entries(times, 65, name)[:3]], ["†"] * 3)
        self.assertNotIn("*", "".join(entry for name in FORMULATIONS for entry in entries(times, 65, name)[:3]))
        self.assertEqual(pair_row(text, 17, 1, "cotangent", "algebra"), ["2.00 (2.00–2.00)", "5", "undecided"])
        self.assertTrue(claim_cell(text, "a", 17, 1).startswith("undecided"))

    def test_what_was_not_measured_is_shown_as_missing(self):
        times = self.times(raw(sizes=(17,), processes=7, cells={("group", 17, 2): None}))
        self.assertEqual(entries(times, 65, "group")[:3], ["–"] * 3)
        self.assertEqual(entries(times, 17, "group")[1], "–")
        self.assertIn("Geometric means of 7 processes", times)

    def test_a_failed_cell_points_to_a_footnote_that_says_how(self):
        why = "diverged at step 3 (last change 1e7)"
        text = self.render(raw(cells={("group", 129, 1): why}))
        self.assertEqual(entries(section(text, "CPU seconds"), 129, "group")[0], "failed (1)")
        self.assertIn(f"(1) group, n = 129, s = 1: failed: {why}", text)
        self.assertRegex(section(text, COUNTERS), r"group +failed \(1\)( +–){5}\n")
        data = raw()
        rows_of(data, ("group", 17, 1))[3].update(error_occurred=True, error_message=why)  # fails the cell
        self.assertIn(f"failed: {why} (1 of 6 repetitions)", " ".join(self.render(data).split()))

    def test_errors_stand_where_a_run_was_given_reference_solutions(self):
        data = changed(("group", 17, 2), relative_error=3.1e-6, reference_uncertainty=2.1e-14)
        for row in rows_of(data, ("algebra", 17, 2)):
            row.update(relative_error=3.4e-6, reference_uncertainty=2.1e-14)
        text = self.render(data)
        self.assertRegex(section(text, "Error at T = 5"), r"17 +– +3\.4e-06 +– +2e-14\n")  # the largest of the three
        self.assertRegex(section(text, COUNTERS), r"2 +cotangent +\S+ +– [^\n]*\n +group +\S+ +3\.10e-06 ")
        one_without = changed(("group", 17, 2), relative_error=1e-6)
        del rows_of(one_without, ("group", 17, 2))[0]["relative_error"]
        for data in (raw(), one_without):
            self.assertNotIn("error at t", self.render(data).lower())

    def test_conditions_are_printed_but_no_host(self):
        for style in document.WRITERS:
            self.assertNotIn(HOST_NAME, self.render(style=style))
        data = raw(dirty="yes", cpu="\ud800", flags="-O2\n\x1b[31m", notice="", modes_hash="a hash")
        del data["context"]["commit"]
        conditions = section(self.render(data), "Measurement conditions")
        for part in ("- commit: not recorded\n", "- dirty: yes\n", "flags: -O2 [31m\n", "\ufffd", "- notice: none",
                     "- modes hash: a hash\n", "- library build type: debug\n"):
            self.assertIn(part, conditions)


class Verdicts(TableTest):
    """By SECONDS all claims hold at every n; a case changes some cells at n = 17."""

    def test_verdicts_as_data_say_the_same(self):
        data = raw(sizes=(17, 33), cells={("group", 17, 1): repeated(0.00204, spread=0.01), ("algebra", 33, 3): None})
        run_script(SCRIPT, self.put(data), "--out", self.path("out"))
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["table.md", "table.tex", "table.txt", "verdicts.json"])
        found = strict_json(text_of(self.path("out", "verdicts.json")))
        self.assertEqual({name: len(each) for name, each in found.items()}, {"verdicts": 16, "claims": 6})
        pair = next(each for each in found["verdicts"] if (each["n"], each["s"], each["row"]) == (17, 1, "group"))
        self.assertEqual({name: pair[name] for name in ("implementation", "other", "verdict", "processes")},
                         {"implementation": "published", "other": "algebra", "verdict": "tie", "processes": 6})
        self.assertAlmostEqual(pair["ratio"], 1.02)
        self.assertLess(pair["low"], pair["ratio"])
        self.assertLess(pair["ratio"], pair["high"])
        claim = next(each for each in found["claims"] if (each["claim"], each["n"]) == ("c", 17))
        self.assertEqual((claim["s"], claim["result"]), (3, "holds"))
        self.assertAlmostEqual(claim["ratio"], 3.0)

    def test_one_process_has_a_ratio_and_no_interval(self):
        run_script(SCRIPT, self.put(raw(sizes=(17,), processes=1)), "--out", self.path("out"))
        found = strict_json(text_of(self.path("out", "verdicts.json")))
        self.assertEqual({(each["low"], each["high"], each["verdict"]) for each in found["verdicts"]},
                         {(None, None, "undecided")})


class Formats(TableTest):
    NASTY = r"a_b %d & 50% #1 {x} $y$ ~z^2 \cmd <i> |p| --param=`q` * [1] é"

    def test_text_is_at_most_110_columns_wide(self):
        text = self.render(raw(cells={("group", 129, 1): "diverged " * 40}, flags="-Wword " * 60 + "x" * 300))
        self.assertLessEqual(max(map(len, text.splitlines())), 110)

    def test_each_format_reaches_standard_output_whatever_the_locale(self):
        for style in document.WRITERS:
            expected = self.render(style=style)
            done = run([sys.executable, SCRIPT, self.path("raw.json"), "--format", style],
                       env=environment(LC_ALL="C", PYTHONIOENCODING="ascii"))
            self.assertEqual((done.returncode, done.stderr, done.stdout), (DONE, "", expected))

    def test_markdown(self):
        text = self.render(raw(flags=self.NASTY), "markdown")
        self.assertIn("| **0.00200 ±0.0 %** |", text)  # more of it is recorded
        line = next(line for line in text.splitlines() if "flags" in line)
        self.assertEqual(re.findall(r"(?<!\\)[`_|<\[~$#&]|(?<!\\)\*(?!\*|flags)", line.replace("**flags**", "")), [])

    def test_markdown_tables_are_aligned_unless_a_row_is_wider_than_a_terminal(self):
        def lines(text):
            columns = document.Column("a", align="left"), document.Column("b")
            return document.markdown_table(document.plain_table(columns, [["x", text], ["longer", "1"]])).splitlines()

        fits = document.WIDEST_ALIGNED - len("| longer |  |")
        self.assertEqual(set(map(len, lines("y" * fits))), {document.WIDEST_ALIGNED})
        self.assertEqual(lines("y" * (fits + 1)),
                         ["| a | b |", "| :-- | --: |", f"| x | {'y' * (fits + 1)} |", "| longer | 1 |"])

    def test_latex_tables_are_whole(self):
        text = self.render(raw(flags=self.NASTY), "latex")
        self.assertTrue(text.isascii())
        self.assertIn(r"& \textbf{0.00200 $\pm$0.0 \%} &", text)
        tabulars = re.findall(r"\\begin\{tabular\}\{([rl]+)\}(.*?)\\end\{tabular\}", text, re.S)
        self.assertEqual(len(tabulars), 5)
        for columns, body in tabulars:
            for row in re.findall(r"^.*\\\\$", body, re.M):
                spanned = sum(int(size) - 1 for size in re.findall(r"\\multicolumn\{(\d)\}", row))
                self.assertEqual(len(re.findall(r"(?<!\\)&", row)) + 1 + spanned, len(columns), row)
        self.assertEqual(text.split("{flags}: ", 1)[1].split("\n")[0],
                         r"a\_b \%d \& 50\% \#1 \{x\} \$y\$ \textasciitilde{}z\textasciicircum{}2 "
                         r"\textbackslash{}cmd \textless{}i\textgreater{} \textbar{}p\textbar{} "
                         r"-{}-param=`q` * {[}1{]} (U+00E9)")


class Refusals(TableTest):
    """Broken and foreign files: one line that says what is wrong, exit 2, nothing on standard output."""

    CELL = ("cotangent", 17, 1)

    def refuses(self, data, *words):
        with self.subTest(words=words):
            self.assert_refused(run_script(SCRIPT, self.put(data)), "render_table1: ", "raw.json", *words)

    def test_files(self):
        self.assert_refused(run_script(SCRIPT, self.path("none.json")), "none.json", "No such file")
        self.assert_refused(run_script(SCRIPT, self.write("raw.json", b"\xff\xfe")), "is not UTF-8")
        aggregates = raw()
        aggregates["benchmarks"] = [row for row in aggregates["benchmarks"] if row["run_type"] == "aggregate"]
        for data, *words in (
                ("", "is empty"), (json.dumps(raw())[:-100], "is not whole JSON"), ("[" * 200000, "is not usable JSON"),
                ({"context": raw()["context"]}, "no benchmarks"),
                ({**raw(), "benchmarks": [7]}, "each of it an object"),
                (raw(isosyrk_program="stability"), "stability", "table1"), (aggregates, "no measured row")):
            self.refuses(data, *words)

    def test_rows(self):
        twice = raw()
        twice["benchmarks"].append(twice["benchmarks"][2])
        self.refuses(twice, name_of(*self.CELL), "repetition 0 of process 2 stands twice")
        for name, *words in (("table1/group/n:17/s:4", "no place for group with s = 4"), ("table1/\n\nboom", "boom"),
                             (None, "run_name")):
            data = raw()
            data["benchmarks"][2]["run_name"] = name
            self.refuses(data, *words)
        for field, value, *words in (
                ("error_occurred", "yes"), ("products", None, "has no products"), ("time_unit", "h", 'time_unit "h"'),
                ("spectrum_error", math.nan, "spectrum_error NaN"), ("relative_error", math.nan), ("cpu_time", 0)):
            self.refuses(changed(self.CELL, **{field: value}), field, *words)

    def test_arguments_and_where_nothing_can_be_written(self):
        path = self.put(raw())
        for arguments, *words in (((path, "--format", "html"), "--format"), ((), "RAW.json"),
                                  ((path, "--output", self.path("nowhere", "table.txt")), "nowhere", "No such file"),
                                  ((path, "--output", self.folder), "directory"),
                                  ((path, "--output", path), "is the raw file itself")):
            self.assert_refused(run_script(SCRIPT, *arguments), "render_table1: ", *words)

    def test_output_holds_what_standard_output_would_and_stays_when_the_file_breaks(self):
        output = self.path("table.txt")
        expected = self.render()
        self.assertEqual(run_script(SCRIPT, self.path("raw.json"), "--output", output).stdout, "")
        self.put("{")
        run_script(SCRIPT, self.path("raw.json"), "--output", output)
        self.assertEqual(text_of(output), expected)
        self.assertEqual(sorted(os.listdir(self.folder)), ["raw.json", "table.txt"])


class Table2(TableTest):
    def raw_of_both(self):
        return raw_file(tables=("table2", "table1"))

    def text(self, data):
        return document.as_text(table2(self.put(data)))

    def gains(self, data):
        """Returns the rows of n = 17 in "Table 1 over Table 2": {row: three texts}."""
        part = self.text(data).split("Table 1 over Table 2\n")[1].split("Ratios to the fastest")[0]
        lines = [re.sub(r" \([^ ]*\)", "", line).split() for line in part.splitlines()]  # without the intervals
        start = next(index for index, words in enumerate(lines) if words[:1] == ["17"])
        return {" ".join(words[:-3]).removeprefix("17 "): words[-3:] for words in lines[start:start + 4]}

    def test_the_last_row_compares_the_fastest_of_each_side_and_a_failed_cell_has_no_gain(self):
        data = self.raw_of_both()
        for row in data["benchmarks"]:
            table, formulation, n, stages = row["run_name"].split("/")
            milliseconds = 2.0 * int(stages[-1]) + FORMULATIONS.index(formulation)
            row["cpu_time"] = milliseconds / (2 if table == "table2" else 1)
            if row["run_name"] == "table2/algebra/n:17/s:1":
                row["cpu_time"] = 0.5  # cotangent, the fastest published row, takes 2
            if row["run_name"] == "table1/group/n:17/s:2":
                row.update(error_occurred=True, error_message="diverged at step 3")
        self.assertEqual(self.gains(data), {"cotangent": ["2.00"] * 3, "group": ["2.00", "–", "2.00"],
                                            "algebra": ["8.00", "2.00", "2.00"],
                                            "fastest row": ["4.00*", "2.00*", "2.00*"]})

    def test_rows_of_two_threads_do_not_enter_the_table(self):
        data = self.raw_of_both()
        alone = self.text(data)
        data["benchmarks"] += [{**row, "run_name": f"{row['run_name']}/threads:2", "cpu_time": 2 * row["cpu_time"]}
                               for row in data["benchmarks"]]
        self.assertEqual(self.text(data), alone)

    def test_foreign_files_are_refused(self):
        one = self.write("one.json", json.dumps(raw_file(tables=("table2",))))
        other = self.write("table1.json", json.dumps(raw_file()))
        for path, *parts in ((one, "one.json", "table1/"), (other, "table1.json", "table1", "table2")):
            self.assert_refused(run_script(RENDER, "table2", path), *parts)


class Numbers(unittest.TestCase):
    def test_three_digits(self):
        for value, text in ((0, "0"), (0.0031234, "0.00312"), (0.0999999, "0.100"), (9.995, "9.99"), (9.996, "10.0"),
                            (108.42, "108"), (12345, "12300"), (1.2345e-14, "1.23e-14"), (1e7, "1.00e+07")):
            self.assertEqual(three_digits(value), text)
