"""Tests of scripts/render_table1 on generated raw files; refusals and output by running it as a user does.

Run with: python3 -m unittest discover -s tests/scripts
"""

import copy
import csv
import importlib.machinery
import importlib.util
import itertools
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest

import programs

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCRIPT = os.path.join(ROOT, "scripts", "render_table1")


def load(path):
    """Imports a script, which has no .py in its name; it makes its library findable on the way."""
    loader = importlib.machinery.SourceFileLoader("render_table1", path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


sys.dont_write_bytecode = True
script = load(SCRIPT)
import benchmark_json  # noqa: E402
import comparison  # noqa: E402
import document  # noqa: E402
import statistics_of_repetitions as statistics  # noqa: E402
from comparison import three_digits  # noqa: E402

FORMULATIONS = ("cotangent", "group", "algebra")
HOST_NAME = "a-host-to-keep-private"
CONTEXT = {
    "date": "2024-05-01T10:00:00+00:00", "host_name": HOST_NAME, "executable": "/some/where/table1", "num_cpus": 8,
    "mhz_per_cpu": 3000, "caches": [{"type": "Data", "level": 1}], "load_avg": [0.25, 0.5, 0.75],
    "library_build_type": "debug", "isosyrk_program": "table1", "isosyrk_format": "1", "commit": "0123abcd",
    "dirty": "no", "compiler": "g++ 12.2.0", "flags": "-O3 -march=native", "build_type": "Release",
    "cpu": "Some CPU", "vector_units": "avx2", "blas_library": "OpenBLAS 0.3.21", "blas_kernels": "Haswell",
    "blas_threads": "1", "environment": "", "products": "zgemm", "product_rate": "n=17: 44 GFLOP/s",
    "peak_gflops": "130", "tolerance": "1e-13", "norm": "Frobenius", "start": "cold", "update_order": "Jacobi",
    "hbar": "paper", "modes_hash": "feedc0de", "notice": "",
}
COUNTERS = {"sweeps_per_step": 14.04, "products": 2100.0, "poisson_solves": 700.0, "spectrum_error": 1.2345e-14,
            "skew_defect": 2e-16, "energy_error": 3.21e-5, "h_norm_B": 0.14, "product_share": 0.4321}
# Seconds by which the paper's claims hold everywhere: algebra wins s = 1, group the rest, algebra is poor at s = 3.
SECONDS = {("cotangent", 1): 0.004, ("group", 1): 0.003, ("algebra", 1): 0.002,
           ("cotangent", 2): 0.008, ("group", 2): 0.006, ("algebra", 2): 0.009,
           ("cotangent", 3): 0.012, ("group", 3): 0.010, ("algebra", 3): 0.030}


def repeated(seconds, repetitions=7, spread=0.01):
    """Returns distinct times around `seconds`, within ± spread of it, with the median on it."""
    half = (repetitions - 1) / 2 or 1
    return [seconds * (1 + spread * (i - (repetitions - 1) / 2) / half) for i in range(repetitions)]


def rows_of(formulation, n, stages, times, **changes):
    """Returns the rows Google Benchmark writes for one cell, in milliseconds, with an aggregate at the end."""
    name = f"table1/{formulation}/n:{n}/s:{stages}"
    rows = [{"name": f"{name}/repeats:{len(times)}", "run_name": name, "run_type": "iteration",
             "repetitions": len(times), "repetition_index": i, "threads": 1, "iterations": 40,
             "real_time": 2e3 * time, "cpu_time": 1e3 * time, "time_unit": "ms", **COUNTERS, **changes}
            for i, time in enumerate(times)]
    aggregate = {**rows[0], "name": f"{name}_median", "run_type": "aggregate", "aggregate_name": "median",
                 "cpu_time": 777777.0}
    del aggregate["repetition_index"]
    return rows + [aggregate]


def failed_rows(formulation, n, stages, message="diverged at step 3 (last change 1e7)"):
    name = f"table1/{formulation}/n:{n}/s:{stages}"
    return [{"name": name, "run_name": name, "run_type": "iteration", "repetitions": 1, "repetition_index": 0,
             "threads": 1, "error_occurred": True, "error_message": message, "iterations": 1, "real_time": 0.0,
             "cpu_time": 0.0, "time_unit": "ms"}]


def raw(sizes=(17, 33, 65, 129), repetitions=7, cells=None, **context):
    """Returns a raw file; `cells` maps (formulation, n, s) to rows, to times in seconds, or to None: missing."""
    cells = cells or {}
    rows = []
    for n, (formulation, stages) in itertools.product(sizes, SECONDS):
        times = repeated(SECONDS[formulation, stages] * (n / 17) ** 3, repetitions)
        cell = cells.get((formulation, n, stages), times)
        if cell is not None:
            rows += cell if isinstance(cell[0], dict) else rows_of(formulation, n, stages, cell)
    return {"context": {**CONTEXT, **context}, "benchmarks": rows}


def without_context(*fields):
    data = raw()
    for field in fields:
        del data["context"][field]
    return data


class ScriptTest(unittest.TestCase):
    """Runs the script on generated files in a temporary folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.path = os.path.join(self.folder, "raw.json")

    def write(self, data):
        content = data if isinstance(data, bytes) else json.dumps(data).encode()
        with open(self.path, "wb") as stream:
            stream.write(content)

    def run_script(self, *arguments, **options):
        if not options:
            done = programs.run_script(SCRIPT, *arguments)
            return subprocess.CompletedProcess(done.args, done.returncode, done.stdout.encode(), done.stderr.encode())
        command = [sys.executable, "-B", SCRIPT, *arguments]
        return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60, check=False,
                              **options)

    def render(self, data=None, style="text"):
        """Returns the rendered file; made in this process, for the sake of speed."""
        self.write(raw() if data is None else data)
        return document.WRITERS[style](script.table1(self.path))

    def assert_refused(self, data, *words):
        self.write(data)
        self.assert_one_line(self.run_script(self.path), "raw.json", *words)

    def assert_one_line(self, result, *words):
        message = result.stderr.decode("utf-8")
        self.assertEqual(result.returncode, 2, message)
        self.assertEqual(result.stdout, b"")
        self.assertRegex(message, r"\Arender_table1: [^\n]+\n\Z")
        self.assertNotIn("Traceback", message)
        for word in words:
            self.assertIn(word, message)


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


def verdict(text, claim, n, stages):
    """Returns a verdict with its evidence, as one line."""
    part = text.split(f"Claim ({claim}):", 1)[1].split("Claim (")[0].split("Measurement conditions")[0]
    item = part.split(f"- n = {n}, s = {stages}: ", 1)[1].split("\n- ")[0].split("\n\n")[0]
    return " ".join(item.split())


class TableTest(ScriptTest):
    """Times, ratios and counters."""

    COUNTERS = "What the time went into, and how good the answer is"

    def times(self, data=None):
        return section(self.render(data), "CPU seconds")

    def test_a_time_is_the_median_with_half_its_interquartile_range(self):
        # Seven equidistant times, ± 10 % in all: the quartiles are halfway between the median and the ends.
        for times, shown in ((repeated(0.003, spread=0.10), "0.00300 ±5.0 %"), (repeated(0.003)[:-1] + [0.5], "0.00300 ±"),
                             ([0.003], "0.00300")):
            found = entries(self.times(raw(cells={("group", 17, 1): times})), 17, "group")[0].rstrip("*")
            self.assertTrue(found.startswith(shown) and (len(times) > 1 or found == shown), found)

    def test_what_changes_nothing(self):
        def suffixed(row):
            row["run_name"] += "/min_time:0.500/repeats:7"

        def named(row):
            row["name"] = "nonsense"

        def cv(row):  # Google Benchmark divides by the mean for these: bare NaN for a skew defect of exactly 0
            if row["run_type"] == "aggregate":
                row["skew_defect"] = math.nan

        def scaled(unit, factor):
            return lambda row: row.update(time_unit=unit, cpu_time=row["cpu_time"] * 1e-3 * factor)

        plain = self.render()
        for change in (suffixed, named, cv, scaled("ns", 1e9), scaled("us", 1e6), scaled("s", 1.0)):
            data = raw()
            for row in data["benchmarks"]:
                change(row)
            self.assertEqual(self.render(data), plain, change)
        data = raw()
        data["benchmarks"] = [row for row in reversed(data["benchmarks"]) if row["run_type"] == "iteration"]
        self.assertEqual(self.render(data), plain)

    def test_the_fastest_row_is_marked_and_what_the_rank_test_does_not_separate(self):
        times = self.times()
        self.assertEqual([entries(times, 33, "algebra")[0][-1], entries(times, 33, "group")[1][-1]], ["*", "*"])
        self.assertNotIn("*", "".join(entries(times, 33, "cotangent")))
        overlapping = [time * 1.001 for time in repeated(0.002)]
        times = self.times(raw(cells={("group", 17, 1): overlapping}))
        self.assertTrue(all(entries(times, 17, name)[0].endswith("*") for name in ("group", "algebra")))

        times = self.times(raw(cells={("cotangent", 17, 1): None, ("algebra", 17, 1): None}))  # no rival
        self.assertFalse(entries(times, 17, "group")[0].endswith("*"))

    def test_the_legend_states_repetitions(self):
        self.assertIn("Medians of 6 repetitions", self.times(raw(repetitions=6)))

    def test_the_papers_seconds_and_winners_stand_beside_ours(self):
        with open(os.path.join(ROOT, "results", "paper", "table1.csv"), encoding="utf-8") as stream:
            published = {(row["n"], row["formulation"], row["stages"]): float(row["seconds"])
                         for row in csv.DictReader(stream)}
        times = self.times()
        for (n, formulation, stages), seconds in published.items():
            self.assertEqual(entries(times, n, formulation)[2 + int(stages)].rstrip("*"), three_digits(seconds))
        self.assertEqual(entries(times, 129, "group")[3:], ["19.5", "26.8*", "31.3*"])
        self.assertEqual(entries(self.times(raw(sizes=(9,))), 9, "group")[3:], ["–", "–", "–"])

    def test_ratios_are_to_the_fastest_row_of_the_block(self):
        ratios = section(self.render(), "Ratios to the fastest row of the block")
        self.assertEqual(entries(ratios, 17, "cotangent")[:3], ["2.00", "1.33", "1.20"])
        self.assertEqual(entries(ratios, 17, "algebra")[3:], ["1.00*", "2.92", "3.92"])

    def test_what_was_not_measured_is_shown_as_missing(self):
        self.assertEqual(entries(self.times(raw(sizes=(17, 33))), 65, "group")[:3], ["–", "–", "–"])
        self.assertEqual(entries(self.times(raw(cells={("group", 17, 2): None})), 17, "group")[1], "–")

    def test_a_failed_cell_points_to_a_footnote_that_says_how(self):
        text = self.render(raw(cells={("group", 129, 1): failed_rows("group", 129, 1)}))
        self.assertEqual(entries(section(text, "CPU seconds"), 129, "group")[0], "failed (1)")
        self.assertIn("(1) group, n = 129, s = 1: failed: diverged at step 3 (last change 1e7)", text)
        self.assertRegex(section(text, self.COUNTERS), r"group +failed \(1\)( +–){5}\n")
        rows = rows_of("group", 17, 1, repeated(0.003))
        rows[3] = {**failed_rows("group", 17, 1)[0], "repetition_index": 3}  # one failed repetition fails the cell
        self.assertIn("failed: diverged at step 3 (last change 1e7) (1 of 7 repetitions)",
                      self.render(raw(cells={("group", 17, 1): rows})))
        cells = {(name, 17, s): failed_rows(name, 17, s) for name in FORMULATIONS for s in (1, 2, 3)}
        self.assertIn("failed (9)", self.render(raw(sizes=(17,), cells=cells)))

    def test_counters_are_medians_with_three_digits(self):
        rows = rows_of("cotangent", 17, 1, repeated(0.004))
        for row, sweeps in zip(rows, (1, 900, 2, 13, 800, 3, 700)):
            row["sweeps_per_step"] = sweeps
        counters = section(self.render(raw(cells={("cotangent", 17, 1): rows})), self.COUNTERS)
        self.assertRegex(counters, r"17 +1 +cotangent +13\.0 +1\.23e-14 +43\.2 % +2\.00e-16 +3\.21e-05 +0\.140\n")

    def test_errors_stand_where_a_run_was_given_reference_solutions(self):
        cells = {(name, 17, 2): rows_of(name, 17, 2, repeated(0.005), relative_error=error, reference_uncertainty=2.1e-14)
                 for name, error in (("group", 3.1e-6), ("algebra", 3.4e-6))}
        text = self.render(raw(cells=cells))
        self.assertRegex(section(text, "Error at T = 5"), r"17 +– +3\.4e-06 +– +2e-14\n")  # the largest of the three
        self.assertRegex(section(text, self.COUNTERS), r"2 +cotangent +14\.0 +– [^\n]*\n +group +14\.0 +3\.10e-06 ")
        rows = rows_of("group", 17, 2, repeated(0.005), relative_error=1e-6)
        del rows[0]["relative_error"]
        for data in (None, raw(cells={("group", 17, 2): rows})):
            self.assertNotIn("error at t", self.render(data).lower())


class VerdictTest(ScriptTest):
    """By SECONDS all claims hold at every n; a case changes some cells at n = 17."""

    CASES = (
        ("a", 1, {}, "holds – "),
        ("a", 1, {"algebra": repeated(0.003), "group": repeated(0.002)}, "does not hold – "),
        ("a", 1, {"group": [time * 1.001 for time in repeated(0.002)]}, "too close to call – "),
        # Two of seven repetitions disturbed: medians 2 % apart, ranks not separated.
        ("a", 1, {"group": repeated(0.00204, spread=0.03)}, "too close to call – "),
        ("a", 1, {"group": repeated(0.002)}, "too close to call – "),
        ("a", 1, {"group": repeated(0.001), "cotangent": repeated(0.002)}, "does not hold – "),
        ("a", 1, {"cotangent": repeated(0.004, 2)}, "too close to call (2 repetitions; 5 needed)"),
        ("a", 1, {"group": failed_rows("group", 17, 1, "stagnated at step 2")}, "not judged: group failed: stagnated at"),
        ("a", 1, {"cotangent": None}, "not judged: cotangent not measured"),
        ("b", 2, {}, "holds"), ("b", 3, {"algebra": repeated(0.005)}, "does not hold"),
        ("c", 3, {}, "holds – algebra takes 3.00 times as long as group"),
        ("c", 3, {"algebra": repeated(0.019)}, "does not hold – "),
        ("c", 3, {"algebra": repeated(0.0201, spread=0.03)}, "too close to call – "),
    )

    def test_outcomes(self):
        for claim, stages, cells, expected in self.CASES:
            with self.subTest(claim=claim, cells=list(cells)):
                text = self.render(raw(cells={(name, 17, stages): cell for name, cell in cells.items()}))
                found = verdict(text, claim, 17, stages)
                self.assertTrue(found.startswith(expected), found)
                self.assertTrue(verdict(text, claim, 33, stages).startswith("holds – "))

    def test_repetitions_that_are_enough(self):
        for repetitions, expected in ((4, "too close to call (4 repetitions; 5 needed) – "), (5, "holds – ")):
            self.assertTrue(verdict(self.render(raw(repetitions=repetitions)), "a", 17, 1).startswith(expected))

    def test_evidence(self):
        # Complete separation of seven from seven: p = 1/C(14,7) = 1/3432.
        text = self.render()
        self.assertIn("group takes 1.50 times as long as algebra (p = 0.000291)", verdict(text, "a", 17, 1))
        self.assertIn("paper: 3.92 times", verdict(text, "c", 17, 3))
        text = self.render(raw(cells={("cotangent", 17, 3): repeated(0.009)}))
        self.assertIn("as long as cotangent, the fastest other row", verdict(text, "c", 17, 3))
        self.assertEqual(verdict(self.render(raw(sizes=(17,))), "b", 129, 3), "not judged: not measured")

    def test_overall_names_every_outcome_and_tells_the_stages_apart(self):
        cells = {("group", 33, 1): repeated(0.002 * (33 / 17) ** 3), ("group", 65, 1): repeated(0.001),
                 ("algebra", 17, 3): repeated(0.005)}
        text = " ".join(self.render(raw(sizes=(17, 33, 65), cells=cells)).split())
        self.assertIn("Overall: holds at n = 17; does not hold at n = 65; too close to call at n = 33;"
                      " not judged at n = 129.", text)
        self.assertIn("Overall: holds at n = 17 (s = 2) and n = 33, 65 (s = 2, 3); does not hold at n = 17 (s = 3);", text)


class ConditionsTest(ScriptTest):
    def test_every_recorded_condition_is_printed_but_no_host_and_no_path(self):
        own = {key: f"recorded {key}" for key, value in CONTEXT.items()
               if isinstance(value, str) and key not in ("host_name", "executable", "dirty", "library_build_type",
                                                         "isosyrk_program", "isosyrk_format")}
        for style in document.WRITERS:
            text = self.render(raw(**own), style)
            self.assertNotIn("host", text)
            self.assertNotIn("/some/where", text)
        text = " ".join(self.render(raw(**own)).split())
        for value in own.values():
            self.assertIn(value, text)

    def test_what_the_conditions_say(self):
        for data, part in ((without_context("commit"), "- commit: not recorded"),
                           (raw(dirty="yes"), "0123abcd, with uncommitted changes"),
                           (raw(notice="no AVX-512"), "- notice: no AVX-512"), (raw(), "without NDEBUG"),
                           (raw(flags="-O2\n\x1b[31m"), "flags -O2 [31m"), (raw(cpu="\ud800"), "\ufffd")):
            self.assertIn(part, self.render(data).replace("\n  ", " "))
        self.assertNotIn("notice", self.render())
        self.assertNotIn("NDEBUG", self.render(raw(library_build_type="release")))


class FormatsTest(ScriptTest):
    NASTY = r"a_b %d & 50% #1 {x} $y$ ~z^2 \cmd <i> |p| --param=`q` * [1] é"

    def test_text_is_at_most_110_columns_wide(self):
        failed = {("group", 129, 1): failed_rows("group", 129, 1, "diverged " * 40)}
        text = self.render(raw(cells=failed, flags="-Wword " * 60 + "x" * 300))
        self.assertLessEqual(max(map(len, text.splitlines())), 110)

    def test_each_format_reaches_standard_output_whatever_the_locale(self):
        for style in document.WRITERS:
            expected = self.render(style=style).encode("utf-8")
            result = self.run_script(self.path, "--format", style)
            self.assertEqual((result.returncode, result.stderr, result.stdout), (0, b"", expected))
        result = self.run_script(self.path, env={"LC_ALL": "C", "PYTHONIOENCODING": "ascii"})
        self.assertEqual((result.returncode, result.stdout), (0, self.render().encode("utf-8")))

    def test_markdown(self):
        text = self.render(raw(flags=self.NASTY), "markdown")
        rows = [line for line in text.splitlines() if line.startswith("|")]
        self.assertEqual({len(re.findall(r"(?<!\\)\|", line)) - 1 for line in rows}, {8, 9})
        self.assertLessEqual(len(set(map(len, rows))), 3)  # three tables, aligned in the source
        self.assertTrue(any("| **0.00200 ±0.5 %** |" in line for line in rows))
        line = next(line for line in text.splitlines() if "flags" in line)
        self.assertEqual(re.findall(r"(?<!\\)[`_|<\[~$#&]|(?<!\\)\*(?!\*|build)", line.replace("**build**", "")), [])

    def test_latex_tables_are_whole(self):
        text = self.render(raw(flags=self.NASTY), "latex")
        self.assertTrue(text.isascii())
        self.assertIn(r"& \textbf{0.00200 $\pm$0.5 \%} &", text)
        tabulars = re.findall(r"\\begin\{tabular\}\{([rl]+)\}(.*?)\\end\{tabular\}", text, re.S)
        self.assertEqual(len(tabulars), 3)
        for columns, body in tabulars:
            for row in re.findall(r"^.*\\\\$", body, re.M):
                spanned = sum(int(size) - 1 for size in re.findall(r"\\multicolumn\{(\d)\}", row))
                self.assertEqual(len(re.findall(r"(?<!\\)&", row)) + 1 + spanned, len(columns), row)
        bare = re.sub(r"\\[{}$\\%&#_]", "", text)
        depth = list(itertools.accumulate({"{": 1, "}": -1}.get(c, 0) for c in bare))
        self.assertEqual((min(depth), depth[-1], bare.count("$") % 2), (0, 0, 0))
        self.assertEqual(text.split("flags ", 1)[1].split("\n")[0],
                         r"a\_b \%d \& 50\% \#1 \{x\} \$y\$ \textasciitilde{}z\textasciicircum{}2 "
                         r"\textbackslash{}cmd \textless{}i\textgreater{} \textbar{}p\textbar{} "
                         r"-{}-param=`q` * {[}1{]} (U+00E9)")


class RefusalTest(ScriptTest):
    """Broken and foreign files: one line that says what is wrong, exit 2, nothing on standard output."""

    ROW = "table1/cotangent/n:17/s:1"

    def with_row(self, **changes):
        data = raw()
        data["benchmarks"][2].update(changes)
        return data

    def test_files(self):
        self.assert_one_line(self.run_script(self.path), "raw.json", "No such file")
        self.assert_one_line(self.run_script(self.folder), self.folder, "directory")
        aggregates = raw()
        aggregates["benchmarks"] = [row for row in aggregates["benchmarks"] if row["run_type"] == "aggregate"]
        for data, *words in (
                (b"", "is empty"), (json.dumps(raw()).encode()[:-100], "is not whole JSON"),
                (b"n,formulation\n17,group\n", "is not whole JSON"), (b'{"context": "\xff\xfe"}', "is not UTF-8"),
                ([raw()], "no JSON object at the top"), (b"[" * 200000, "is not usable JSON"),
                ({"context": CONTEXT}, "no list of benchmarks"),
                ({**raw(), "benchmarks": [7]}, "row that is no object but 7"),
                (raw(isosyrk_program="stability"), "stability", "table1"),
                (without_context("isosyrk_program"), "no isosyrk_program"), (raw(isosyrk_format="2"), "isosyrk_format"),
                (raw(sizes=()), "no measured row"), (aggregates, "no measured row")):
            with self.subTest(words=words):
                self.assert_refused(data, *words)

    def test_rows(self):
        self.render(self.with_row())  # a sound one
        twice, untyped = raw(), raw()
        twice["benchmarks"].append(copy.deepcopy(twice["benchmarks"][2]))
        del untyped["benchmarks"][2]["run_type"]
        huge = json.dumps(self.with_row(products=-123456)).replace("-123456", "9" * 10000).encode()
        for data, *words in (
                (twice, self.ROW, "repetition 2 stands twice"), (untyped, "run_type"), (huge,),
                (self.with_row(run_name="table1/magic/n:17/s:1"), "no place for magic"),
                (self.with_row(run_name="table1/group/n:17/s:4"), "no place for group with s = 4"),
                (self.with_row(run_name="table1/cotangent/n:17/s:1x"), "s:1x"),
                (self.with_row(run_name="table1/\n\nboom"), "boom"),
                (self.with_row(run_name="table1/group/n:17/s:1/" + 1000 * "x", products=-1), "group/n:17", "xxx...:"),
                (self.with_row(spectrum_error=math.nan), "spectrum_error is nan"),
                (self.with_row(spectrum_error=math.inf), "spectrum_error is inf"),
                (self.with_row(products="many"), 'products is "many", not a number'),
                (self.with_row(products=True), "products is true, not a number"),
                (self.with_row(skew_defect=-1e-16), "skew_defect is -1e-16"),
                (self.with_row(products=1e300), "products is 1e+300"), (self.with_row(products=10**400), "products is inf"),
                (self.with_row(relative_error=math.nan), "relative_error"),
                (self.with_row(time_unit="h"), 'time_unit "h"'),
                *((self.with_row(cpu_time=time), self.ROW, "cpu_time")
                  for time in (0, -1.0, 1e300, 1e-300, math.nan, "fast", None)),
                *((raw(cells={("group", 17, 1): failed_rows("group", 17, 1, message)}), "table1/group/n:17/s:1",
                   "error_message") for message in (7, None, {}))):
            with self.subTest(words=words):
                self.assert_refused(data, *words)

    def test_every_counter_is_required(self):
        for counter in COUNTERS:
            data = raw()
            del data["benchmarks"][2][counter]
            self.assert_refused(data, self.ROW, f"has no {counter}")

    def test_arguments(self):
        self.write(raw())
        self.assert_one_line(self.run_script(self.path, "--format", "html"), "--format")
        self.assert_one_line(self.run_script(), "RAW.json")


class OutputTest(ScriptTest):
    def setUp(self):
        super().setUp()
        self.write(raw())
        self.output = os.path.join(self.folder, "table.txt")

    def test_output_holds_what_standard_output_would_and_stays_when_the_file_breaks(self):
        expected = self.run_script(self.path).stdout
        self.assertEqual(self.run_script(self.path, "--output", self.output).stdout, b"")
        self.write(b"{")
        self.run_script(self.path, "--output", self.output)
        with open(self.output, "rb") as stream:
            self.assertEqual(stream.read(), expected)
        self.assertEqual(sorted(os.listdir(self.folder)), ["raw.json", "table.txt"])

    def test_where_nothing_can_be_written(self):
        for output, *words in ((os.path.join(self.folder, "nowhere", "table.txt"), "nowhere", "No such file"),
                               (self.folder, "directory"), (self.path, "is the raw file itself")):
            self.assert_one_line(self.run_script(self.path, "--output", output), *words)

    @unittest.skipUnless(os.path.exists("/dev/full"), "needs a device that is always full")
    def test_full_standard_output(self):
        with open("/dev/full", "wb") as full:
            result = subprocess.run([sys.executable, "-B", SCRIPT, self.path], stdout=full, stderr=subprocess.PIPE,
                                    timeout=60, check=False)
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr.decode(), r"\Arender_table1: standard output: cannot be written: [^\n]+\n\Z")


class StatisticsTest(unittest.TestCase):
    def test_rank_test_equals_enumeration(self):
        # Every way to deal six distinct values into sides of 2 and 4, and of 3 and 3.
        for side in (2, 3):
            deals = [set(deal) for deal in itertools.combinations(range(6), side)]
            wrong = [sum(x > y for x in deal for y in set(range(6)) - deal) for deal in deals]
            for deal, own in zip(deals, wrong):
                expected = sum(other <= own for other in wrong) / len(deals)
                self.assertAlmostEqual(statistics.rank_test(sorted(deal), sorted(set(range(6)) - deal)), expected)

    def test_complete_separation(self):
        self.assertAlmostEqual(statistics.rank_test(range(5), range(5, 10)), 1 / 252)
        self.assertEqual(statistics.rank_test(range(5, 10), range(5)), 1.0)
        self.assertGreater(statistics.rank_test(range(4), range(4, 8)), statistics.LEVEL)  # four cannot reach it

    def test_sides_of_unequal_size_may_stand_either_way(self):
        self.assertAlmostEqual(statistics.rank_test([1, 2], [3, 4, 5, 6, 7]),
                               statistics.rank_test([1, 2, 3, 4, 5], [6, 7]))

    def test_a_tie_counts_against_either_claim(self):
        self.assertGreater(statistics.rank_test([1, 2, 3], [3, 4, 5]), statistics.rank_test([1, 2, 3], [3.1, 4, 5]))
        self.assertGreater(statistics.rank_test([3, 4, 5], [1, 2, 3]), statistics.rank_test([2.9, 4, 5], [1, 2, 3]))
        self.assertEqual(statistics.rank_test([1] * 9, [1] * 9), 1.0)

    def test_decision_has_three_ways(self):
        low, high = [1, 2, 3, 4, 5], [6, 7, 8, 9, 10]
        self.assertEqual([statistics.compare(*pair).outcome for pair in ((low, high), (high, low), (low, low))],
                         [statistics.FASTER, statistics.SLOWER, statistics.UNDECIDED])

    def test_half_interquartile_range(self):
        self.assertEqual([statistics.half_interquartile_range(values) for values in ([5, 1, 4, 2, 3], [5])], [1.0, 0.0])


class NumbersTest(ScriptTest):
    def read(self, seconds):
        self.write(f"n,formulation,stages,seconds\n17,group,1,{seconds}\n".encode())
        return comparison.read_published(self.path)

    def test_published_times(self):
        self.assertEqual(self.read("0.5"), {("group", 17, 1): 0.5})
        for seconds in ("0", "-1", "nan", "inf", "1e300", "1e-300", "fast", ""):
            with self.subTest(seconds=seconds), self.assertRaisesRegex(benchmark_json.UnusableFile, "published times"):
                self.read(seconds)

    def test_three_digits(self):
        for value, text in ((0, "0"), (0.0031234, "0.00312"), (0.0999999, "0.100"), (9.995, "9.99"), (9.996, "10.0"),
                            (108.42, "108"), (12345, "12300"), (1.2345e-14, "1.23e-14"), (1e7, "1.00e+07")):
            with self.subTest(value=value):
                self.assertEqual(three_digits(value), text)


class ReaderTest(ScriptTest):
    def test_cells_hold_counters_and_times_in_the_order_of_repetition(self):
        data = raw(sizes=(17,))
        data["benchmarks"].reverse()
        self.write(data)
        run = benchmark_json.read_run(self.path, "table1", ("products",))
        cell = run.measurements[benchmark_json.CellKey("group", 17, 1)]
        self.assertEqual((len(cell.times), cell.counters, cell.failure), (7, {"products": 2100.0}, None))
        self.assertEqual(list(cell.times), sorted(cell.times))


if __name__ == "__main__":
    unittest.main()
