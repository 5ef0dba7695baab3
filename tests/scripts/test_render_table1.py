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


class TimesTest(ScriptTest):
    def times(self, data=None):
        return section(self.render(data), "CPU seconds")

    def test_shows_the_median_cpu_time_in_seconds(self):
        self.assertTrue(entries(self.times(), 17, "group")[0].startswith("0.00300 ±"))

    def test_median_ignores_an_outlier(self):
        times = repeated(0.003)[:-1] + [0.5]
        self.assertTrue(entries(self.times(raw(cells={("group", 17, 1): times})), 17, "group")[0]
                        .startswith("0.00300 ±"))

    def test_spread_is_half_the_interquartile_range_in_percent(self):
        # Seven equidistant times, ± 10 % in all: the quartiles are halfway between the median and the ends.
        times = repeated(0.003, 7, spread=0.10)
        self.assertEqual(entries(self.times(raw(cells={("group", 17, 1): times})), 17, "group")[0],
                         "0.00300 ±5.0 %")

    def test_every_time_unit_means_the_same_seconds(self):
        for unit, factor in (("ns", 1e9), ("us", 1e6), ("s", 1.0)):
            with self.subTest(unit=unit):
                rows = rows_of("group", 17, 1, repeated(0.003))
                for row in rows:
                    row.update(time_unit=unit, cpu_time=row["cpu_time"] * 1e-3 * factor)
                self.assertEqual(self.times(raw(cells={("group", 17, 1): rows})), self.times())

    def test_aggregate_rows_change_nothing(self):
        data = raw()
        data["benchmarks"] = [row for row in data["benchmarks"] if row["run_type"] == "iteration"]
        self.assertEqual(self.render(data), self.render())

    def test_nan_in_an_aggregate_row_is_harmless(self):
        # Google Benchmark divides by the mean for its "cv" rows: bare NaN for a skew defect of exactly 0.
        data = raw()
        for row in data["benchmarks"]:
            if row["run_type"] == "aggregate":
                row["skew_defect"] = math.nan
        self.assertEqual(self.render(data), self.render())

    def test_suffixes_of_the_run_name_change_nothing(self):
        data = raw()
        for row in data["benchmarks"]:
            row["run_name"] += "/min_time:0.500/repeats:7"
        self.assertEqual(self.render(data), self.render())

    def test_the_name_field_is_never_read(self):
        data = raw()
        for row in data["benchmarks"]:
            row["name"] = "nonsense"
        self.assertEqual(self.render(data), self.render())

    def test_a_digit_after_the_stages_is_not_a_suffix(self):
        data = raw()
        data["benchmarks"][0]["run_name"] = "table1/cotangent/n:17/s:1x"
        self.assert_refused(data, "s:1x")

    def test_order_of_rows_changes_nothing(self):
        data = raw()
        data["benchmarks"].reverse()
        self.assertEqual(self.render(data), self.render())

    def test_the_fastest_row_is_marked(self):
        self.assertEqual([entries(self.times(), 33, "algebra")[0][-1], entries(self.times(), 33, "group")[1][-1]],
                         ["*", "*"])

    def test_a_slower_row_is_not_marked(self):
        self.assertNotIn("*", "".join(entries(self.times(), 33, "cotangent")))

    def test_rows_the_rank_test_does_not_separate_are_both_marked(self):
        overlapping = [time * 1.001 for time in repeated(0.002)]
        times = self.times(raw(cells={("group", 17, 1): overlapping}))
        self.assertTrue(all(entries(times, 17, name)[0].endswith("*") for name in ("group", "algebra")))

    def test_legend_says_that_unseparated_rows_are_marked_too(self):
        self.assertIn("does\nnot separate", self.times())

    def test_legend_states_the_number_of_repetitions(self):
        self.assertIn("Medians of 6 repetitions", self.times(raw(repetitions=6)))

    def test_too_few_repetitions_are_named_in_the_legend(self):
        self.assertIn("marked untested", self.times(raw(repetitions=4)))

    def test_enough_repetitions_leave_the_legend_silent(self):
        self.assertNotIn("untested", self.times(raw(repetitions=5)))

    def test_a_lone_repetition_has_no_spread(self):
        self.assertNotIn("±", "".join(entries(self.times(raw(repetitions=1)), 17, "group")))

    def test_the_papers_seconds_stand_beside_ours(self):
        with open(os.path.join(ROOT, "results", "paper", "table1.csv"), encoding="utf-8") as stream:
            published = {(row["n"], row["formulation"], row["stages"]): float(row["seconds"])
                         for row in csv.DictReader(stream)}
        times = self.times()
        for (n, formulation, stages), seconds in published.items():
            shown = entries(times, n, formulation)[2 + int(stages)].rstrip("*")
            self.assertEqual(shown, three_digits(seconds))

    def test_the_papers_own_winner_is_marked(self):
        self.assertEqual(entries(self.times(), 129, "group")[3:], ["19.5", "26.8*", "31.3*"])

    def test_a_size_the_paper_lacks_is_shown_without_its_seconds(self):
        self.assertEqual(entries(self.times(raw(sizes=(9,))), 9, "group")[3:], ["–", "–", "–"])


class MissingAndFailedTest(ScriptTest):
    def test_sizes_not_run_are_shown_as_missing(self):
        times = section(self.render(raw(sizes=(17, 33))), "CPU seconds")
        self.assertEqual(entries(times, 65, "group")[:3], ["–", "–", "–"])

    def test_one_missing_cell_is_shown_as_missing(self):
        times = section(self.render(raw(cells={("group", 17, 2): None})), "CPU seconds")
        self.assertEqual(entries(times, 17, "group")[1], "–")

    def test_the_missing_mark_is_explained(self):
        self.assertIn('"–" means not measured', self.render(raw(sizes=(17,))))

    def test_a_whole_table_explains_no_missing_mark(self):
        self.assertNotIn("not measured", self.render())

    def test_a_failed_cell_points_to_its_footnote(self):
        text = self.render(raw(cells={("group", 129, 1): failed_rows("group", 129, 1)}))
        self.assertEqual(entries(section(text, "CPU seconds"), 129, "group")[0], "failed (1)")

    def test_the_footnote_says_how_it_failed(self):
        text = self.render(raw(cells={("group", 129, 1): failed_rows("group", 129, 1)}))
        self.assertIn("(1) group, n = 129, s = 1: failed: diverged at step 3 (last change 1e7)", text)

    def test_one_failed_repetition_fails_the_cell(self):
        rows = rows_of("group", 17, 1, repeated(0.003))
        rows[3] = {**failed_rows("group", 17, 1)[0], "repetition_index": 3}
        text = self.render(raw(cells={("group", 17, 1): rows}))
        self.assertIn("failed: diverged at step 3 (last change 1e7) (1 of 7 repetitions)", text)

    def test_a_file_of_failures_only_is_rendered(self):
        cells = {(name, n, s): failed_rows(name, n, s) for name in FORMULATIONS for n in (17,) for s in (1, 2, 3)}
        self.assertIn("failed (9)", self.render(raw(sizes=(17,), cells=cells)))

    def test_a_row_without_rival_is_not_marked(self):
        cells = {("cotangent", 17, 1): None, ("algebra", 17, 1): None}
        times = section(self.render(raw(cells=cells)), "CPU seconds")
        self.assertFalse(entries(times, 17, "group")[0].endswith("*"))

    def test_ratios_name_the_blocks_that_lack_a_row(self):
        text = section(self.render(raw(cells={("group", 17, 2): None})), "Ratios to the fastest row of the block")
        self.assertIn("left out of its block's comparison: n = 17, s = 2.", " ".join(text.split()))


class RatiosTest(ScriptTest):
    def ratios(self):
        return section(self.render(), "Ratios to the fastest row of the block")

    def test_ratios_are_to_the_fastest_row_of_the_block(self):
        self.assertEqual(entries(self.ratios(), 17, "cotangent")[:3], ["2.00", "1.33", "1.20"])

    def test_the_papers_ratios_stand_beside_ours(self):
        self.assertEqual(entries(self.ratios(), 17, "algebra")[3:], ["1.00*", "2.92", "3.92"])


class CountersTest(ScriptTest):
    HEADING = "What the time went into, and how good the answer is"

    def test_counters_are_shown_with_three_digits(self):
        counters = section(self.render(), self.HEADING)
        self.assertRegex(counters, r"17 +1 +cotangent +14\.0 +1\.23e-14 +43\.2 % +2\.00e-16 +3\.21e-05 +0\.140\n")

    def test_a_counter_is_the_median_of_its_repetitions(self):
        rows = rows_of("cotangent", 17, 1, repeated(0.004))
        for row, sweeps in zip(rows, (1, 900, 2, 13, 800, 3, 700)):
            row["sweeps_per_step"] = sweeps
        counters = section(self.render(raw(cells={("cotangent", 17, 1): rows})), self.HEADING)
        self.assertRegex(counters, r"17 +1 +cotangent +13\.0 ")

    def test_a_failed_cell_has_no_counters(self):
        counters = section(self.render(raw(cells={("cotangent", 17, 1): failed_rows("cotangent", 17, 1)})),
                           self.HEADING)
        self.assertRegex(counters, r"17 +1 +cotangent +failed \(1\)( +–){5}\n")


class ErrorTest(ScriptTest):
    """The error at T, which only a run that was given reference solutions has."""

    HEADING = "Error at T = 5"

    def rendered(self, **errors):
        """Renders a file whose group and algebra rows at n = 17, s = 2 have these errors."""
        cells = {(name, 17, 2): rows_of(name, 17, 2, repeated(0.005), relative_error=error,
                                        reference_uncertainty=2.1e-14) for name, error in errors.items()}
        return self.render(raw(cells=cells))

    def test_the_largest_of_the_formulations_is_shown(self):
        text = section(self.rendered(group=3.1e-6, algebra=3.4e-6), self.HEADING)
        self.assertRegex(text, r"17 +– +3\.4e-06 +– +2e-14\n")

    def test_each_cell_shows_its_own(self):
        text = section(self.rendered(group=3.1e-6), CountersTest.HEADING)
        self.assertRegex(text, r"2 +cotangent +14\.0 +– ")
        self.assertRegex(text, r"group +14\.0 +3\.10e-06 ")

    def test_a_file_without_errors_has_no_such_section(self):
        self.assertNotIn("Error at T", self.render())
        self.assertNotIn("error at T", self.render())

    def test_a_cell_of_which_some_repetitions_have_none_has_none(self):
        rows = rows_of("group", 17, 2, repeated(0.005), relative_error=1e-6)
        del rows[0]["relative_error"]
        self.assertNotIn("Error at T", self.render(raw(cells={("group", 17, 2): rows})))

    def test_an_error_that_is_no_number_is_refused(self):
        rows = rows_of("group", 17, 2, repeated(0.005), relative_error=float("nan"))
        self.assert_refused(raw(cells={("group", 17, 2): rows}), "relative_error")


class VerdictTest(ScriptTest):
    def verdict(self, claim, n, stages, data=None):
        return verdict(self.render(data), claim, n, stages)

    def test_claim_a_holds_where_algebra_beats_each_rival(self):
        self.assertTrue(self.verdict("a", 17, 1).startswith("holds – "))

    def test_claim_a_falls_when_two_cells_are_swapped(self):
        swapped = {("algebra", 17, 1): repeated(0.003), ("group", 17, 1): repeated(0.002)}
        self.assertTrue(self.verdict("a", 17, 1, raw(cells=swapped)).startswith("does not hold – "))

    def test_claim_a_elsewhere_is_untouched_by_the_swap(self):
        swapped = {("algebra", 17, 1): repeated(0.003), ("group", 17, 1): repeated(0.002)}
        self.assertTrue(self.verdict("a", 33, 1, raw(cells=swapped)).startswith("holds – "))

    def test_overlapping_repetitions_are_too_close_to_call(self):
        overlapping = {("group", 17, 1): [time * 1.001 for time in repeated(0.002)]}
        self.assertTrue(self.verdict("a", 17, 1, raw(cells=overlapping)).startswith("too close to call – "))

    def test_a_lower_median_alone_does_not_decide(self):
        # Two of seven repetitions disturbed: medians 2 % apart, ranks not separated.
        times = {("group", 17, 1): repeated(0.00204, spread=0.03)}
        self.assertTrue(self.verdict("a", 17, 1, raw(cells=times)).startswith("too close to call – "))

    def test_equal_times_are_too_close_to_call(self):
        self.assertTrue(self.verdict("a", 17, 1, raw(cells={("group", 17, 1): repeated(0.002)}))
                        .startswith("too close to call – "))

    def test_one_rival_that_wins_refutes_though_another_ties(self):
        times = {("group", 17, 1): repeated(0.001), ("cotangent", 17, 1): repeated(0.002)}
        self.assertTrue(self.verdict("a", 17, 1, raw(cells=times)).startswith("does not hold – "))

    def test_four_repetitions_are_too_few(self):
        self.assertTrue(self.verdict("a", 17, 1, raw(repetitions=4))
                        .startswith("too close to call (4 repetitions; 5 needed) – "))

    def test_five_repetitions_are_enough(self):
        self.assertTrue(self.verdict("a", 17, 1, raw(repetitions=5)).startswith("holds – "))

    def test_the_cell_with_fewest_repetitions_counts(self):
        few = {("cotangent", 17, 1): repeated(0.004, 2)}
        self.assertTrue(self.verdict("a", 17, 1, raw(cells=few))
                        .startswith("too close to call (2 repetitions; 5 needed)"))

    def test_evidence_states_ratio_and_p(self):
        # Complete separation of seven from seven: p = 1/C(14,7) = 1/3432.
        self.assertIn("group takes 1.50 times as long as algebra (p = 0.000291)", self.verdict("a", 17, 1))

    def test_a_failed_rival_leaves_the_claim_unjudged(self):
        failed = {("group", 17, 1): failed_rows("group", 17, 1, "stagnated at step 2")}
        self.assertEqual(self.verdict("a", 17, 1, raw(cells=failed)),
                         "not judged: group failed: stagnated at step 2")

    def test_a_missing_rival_leaves_the_claim_unjudged(self):
        self.assertEqual(self.verdict("a", 17, 1, raw(cells={("cotangent", 17, 1): None})),
                         "not judged: cotangent not measured")

    def test_a_size_not_run_leaves_the_claim_unjudged(self):
        self.assertEqual(self.verdict("b", 129, 3, raw(sizes=(17, 33))), "not judged: not measured")

    def test_claim_b_is_judged_for_each_number_of_stages(self):
        times = {("algebra", 17, 3): repeated(0.005)}
        text = self.render(raw(cells=times))
        self.assertTrue(verdict(text, "b", 17, 2).startswith("holds"))
        self.assertTrue(verdict(text, "b", 17, 3).startswith("does not hold"))

    def test_claim_c_holds_above_twice_the_fastest_rival(self):
        self.assertTrue(self.verdict("c", 65, 3).startswith("holds – algebra takes 3.00 times as long as group"))

    def test_claim_c_fails_below_twice_though_algebra_is_slowest(self):
        times = {("algebra", 17, 3): repeated(0.019)}
        self.assertTrue(self.verdict("c", 17, 3, raw(cells=times)).startswith("does not hold – "))

    def test_claim_c_is_too_close_to_call_at_twice(self):
        times = {("algebra", 17, 3): repeated(0.0201, spread=0.03)}
        self.assertTrue(self.verdict("c", 17, 3, raw(cells=times)).startswith("too close to call – "))

    def test_claim_c_takes_the_fastest_of_both_rivals(self):
        times = {("cotangent", 17, 3): repeated(0.009)}
        self.assertIn("as long as cotangent, the fastest other row", self.verdict("c", 17, 3, raw(cells=times)))

    def test_claim_c_quotes_the_papers_ratio(self):
        self.assertIn("paper: 3.92 times", self.verdict("c", 17, 3))

    def test_overall_sums_up_where_a_claim_holds(self):
        self.assertIn("Overall: holds at n = 17, 33, 65, 129.", self.render())

    def test_overall_names_every_outcome(self):
        cells = {("group", 33, 1): repeated(0.002 * (33 / 17) ** 3), ("group", 65, 1): repeated(0.001)}
        text = " ".join(self.render(raw(sizes=(17, 33, 65), cells=cells)).split())
        self.assertIn("Overall: holds at n = 17; does not hold at n = 65; too close to call at n = 33;"
                      " not judged at n = 129.", text)

    def test_overall_of_claim_b_tells_the_stages_apart(self):
        text = " ".join(self.render(raw(cells={("algebra", 17, 3): repeated(0.005)})).split())
        self.assertIn("Overall: holds at n = 17 (s = 2) and n = 33, 65, 129 (s = 2, 3);"
                      " does not hold at n = 17 (s = 3).", text)


class ConditionsTest(ScriptTest):
    def test_the_host_name_is_never_printed(self):
        for style in document.WRITERS:
            with self.subTest(style=style):
                self.assertNotIn("host", self.render(style=style))

    def test_the_path_of_the_program_is_never_printed(self):
        self.assertNotIn("/some/where", self.render())

    def test_every_recorded_condition_is_printed(self):
        own = {key: f"recorded {key}" for key, value in CONTEXT.items()
               if isinstance(value, str) and key not in ("host_name", "executable", "dirty", "library_build_type",
                                                         "isosyrk_program", "isosyrk_format")}
        text = " ".join(self.render(raw(**own)).split())
        for value in own.values():
            self.assertIn(value, text)

    def test_a_missing_condition_is_said_to_be_missing(self):
        self.assertIn("- commit: not recorded", self.render(without_context("commit")))

    def test_uncommitted_changes_are_told(self):
        self.assertIn("0123abcd, with uncommitted changes", self.render(raw(dirty="yes")))

    def test_the_debug_word_of_the_library_is_explained_once(self):
        self.assertEqual(self.render().count("without NDEBUG") + self.render().count("without\n  NDEBUG"), 1)

    def test_a_release_library_needs_no_explanation(self):
        self.assertNotIn("NDEBUG", self.render(raw(library_build_type="release")))

    def test_a_notice_is_printed(self):
        self.assertIn("- notice: kernels do not use AVX-512", self.render(raw(notice="kernels do not use AVX-512")))

    def test_an_empty_notice_is_not_printed(self):
        self.assertNotIn("notice", self.render())

    def test_control_codes_do_not_reach_the_terminal(self):
        self.assertIn("flags -O2 [31m", self.render(raw(flags="-O2\n\x1b[31m")))

    def test_a_lone_surrogate_is_replaced(self):
        self.assertIn("\ufffd", self.render(raw(cpu="\ud800")))


class FormatsTest(ScriptTest):
    NASTY = r"a_b %d & 50% #1 {x} $y$ ~z^2 \cmd <i> |p| --param=`q` * [1] é"

    def test_text_is_at_most_110_columns_wide(self):
        failed = {("group", 129, 1): failed_rows("group", 129, 1, "diverged " * 40)}
        text = self.render(raw(cells=failed, flags="-Wword " * 60 + "x" * 300))
        self.assertLessEqual(max(map(len, text.splitlines())), 110)

    def test_each_format_reaches_standard_output(self):
        for style in document.WRITERS:
            with self.subTest(style=style):
                expected = self.render(style=style).encode("utf-8")
                result = self.run_script(self.path, "--format", style)
                self.assertEqual((result.returncode, result.stderr, result.stdout), (0, b"", expected))

    def test_text_is_the_default_format(self):
        expected = self.render().encode("utf-8")
        self.assertEqual(self.run_script(self.path).stdout, expected)

    def test_rendering_needs_no_utf8_locale(self):
        self.write(raw())
        result = self.run_script(self.path, env={"LC_ALL": "C", "PYTHONIOENCODING": "ascii"})
        self.assertEqual((result.returncode, result.stderr), (0, b""))

    def markdown_rows(self, data=None):
        return [line for line in self.render(data, "markdown").splitlines() if line.startswith("|")]

    def test_markdown_tables_have_as_many_cells_in_each_row(self):
        widths = [len(re.findall(r"(?<!\\)\|", line)) - 1 for line in self.markdown_rows()]
        self.assertEqual(sorted(set(widths)), [8, 9])

    def test_markdown_columns_are_aligned_in_the_source(self):
        lengths = [len(line) for line in self.markdown_rows()]
        self.assertLessEqual(len(set(lengths)), 3)  # three tables

    def test_markdown_winners_are_bold(self):
        self.assertTrue(any("| **0.00200 ±0.5 %** |" in line for line in self.markdown_rows()))

    def test_markdown_is_not_opened_up_by_a_context_string(self):
        line = next(line for line in self.render(raw(flags=self.NASTY), "markdown").splitlines() if "flags" in line)
        self.assertEqual(re.findall(r"(?<!\\)[`_|<\[~$#&]|(?<!\\)\*(?!\*|build)", line.replace("**build**", "")), [])

    def latex(self, data=None):
        return self.render(data, "latex")

    def test_latex_winners_are_bold(self):
        self.assertIn(r"& \textbf{0.00200 $\pm$0.5 \%} &", self.latex())

    def test_latex_names_the_package_it_needs(self):
        self.assertIn(r"% A fragment to \input; needs \usepackage{booktabs}.", self.latex())

    def test_latex_is_ascii(self):
        self.assertTrue(self.latex(raw(flags=self.NASTY)).isascii())

    def test_latex_rows_have_as_many_cells_as_their_tabular_has_columns(self):
        tabulars = re.findall(r"\\begin\{tabular\}\{([rl]+)\}(.*?)\\end\{tabular\}", self.latex(), re.S)
        self.assertEqual(len(tabulars), 3)
        for columns, body in tabulars:
            for row in re.findall(r"^.*\\\\$", body, re.M):
                spanned = sum(int(size) - 1 for size in re.findall(r"\\multicolumn\{(\d)\}", row))
                self.assertEqual(len(re.findall(r"(?<!\\)&", row)) + 1 + spanned, len(columns), row)

    def test_latex_braces_and_dollars_balance(self):
        bare = re.sub(r"\\[{}$\\%&#_]", "", self.latex(raw(flags=self.NASTY)))
        depth = list(itertools.accumulate({"{": 1, "}": -1}.get(c, 0) for c in bare))
        self.assertEqual((min(depth), depth[-1], bare.count("$") % 2), (0, 0, 0))

    def test_latex_environments_are_closed_in_order(self):
        stack = []
        for what, name in re.findall(r"\\(begin|end)\{(\w+)\}", self.latex()):
            if what == "begin":
                stack.append(name)
            else:
                self.assertEqual(stack.pop(), name)
        self.assertEqual(stack, [])

    def test_latex_escapes_a_context_string(self):
        body = self.latex(raw(flags=self.NASTY)).split("flags ", 1)[1].split("\n")[0]
        self.assertEqual(body, r"a\_b \%d \& 50\% \#1 \{x\} \$y\$ \textasciitilde{}z\textasciicircum{}2 "
                               r"\textbackslash{}cmd \textless{}i\textgreater{} \textbar{}p\textbar{} "
                               r"-{}-param=`q` * {[}1{]} (U+00E9)")


class RefusalTest(ScriptTest):
    """Broken and foreign files: one line that says what is wrong, exit 2, nothing on standard output."""

    def with_row(self, **changes):
        data = raw()
        data["benchmarks"][2].update(changes)
        return data

    def test_a_sound_file_is_not_refused(self):
        self.render(self.with_row())

    def test_missing_file(self):
        self.assert_one_line(self.run_script(self.path), "raw.json", "No such file")

    def test_directory(self):
        self.assert_one_line(self.run_script(self.folder), self.folder, "directory")

    def test_empty_file(self):
        self.assert_refused(b"", "is empty")

    def test_truncated_json(self):
        self.assert_refused(json.dumps(raw()).encode()[:-100], "is not whole JSON")

    def test_no_json(self):
        self.assert_refused(b"n,formulation\n17,group\n", "is not whole JSON")

    def test_bytes_that_are_not_utf8(self):
        self.assert_refused(b'{"context": "\xff\xfe"}', "is not UTF-8")

    def test_json_list(self):
        self.assert_refused([raw()], "no JSON object at the top")

    def test_deeply_nested_json(self):
        self.assert_refused(b"[" * 200000, "is not usable JSON")

    def test_json_without_benchmarks(self):
        self.assert_refused({"context": CONTEXT}, "no list of benchmarks")

    def test_row_that_is_no_object(self):
        data = raw()
        data["benchmarks"].append(7)
        self.assert_refused(data, "row that is no object but 7")

    def test_file_of_another_program(self):
        self.assert_refused(raw(isosyrk_program="stability"), "stability", "table1")

    def test_file_of_no_program_of_ours(self):
        self.assert_refused(without_context("isosyrk_program"), "no isosyrk_program")

    def test_later_format(self):
        self.assert_refused(raw(isosyrk_format="2"), "isosyrk_format")

    def test_file_without_measured_rows(self):
        self.assert_refused(raw(sizes=()), "no measured row")

    def test_file_of_aggregates_only(self):
        data = raw()
        data["benchmarks"] = [row for row in data["benchmarks"] if row["run_type"] == "aggregate"]
        self.assert_refused(data, "no measured row")

    def test_unknown_formulation(self):
        self.assert_refused(self.with_row(run_name="table1/magic/n:17/s:1"), "no place for magic")

    def test_unknown_number_of_stages(self):
        self.assert_refused(self.with_row(run_name="table1/group/n:17/s:4"), "no place for group with s = 4")

    def test_row_without_run_type(self):
        data = raw()
        del data["benchmarks"][2]["run_type"]
        self.assert_refused(data, "run_type")

    def test_repetition_that_stands_twice(self):
        data = raw()
        data["benchmarks"].append(copy.deepcopy(data["benchmarks"][2]))
        self.assert_refused(data, "table1/cotangent/n:17/s:1", "repetition 2 stands twice")

    def test_every_counter_is_required(self):
        for counter in COUNTERS:
            with self.subTest(counter=counter):
                data = raw()
                del data["benchmarks"][2][counter]
                self.assert_refused(data, "table1/cotangent/n:17/s:1", f"has no {counter}")

    def test_counter_that_is_bare_nan(self):
        self.assert_refused(self.with_row(spectrum_error=math.nan), "spectrum_error is nan")

    def test_counter_that_is_infinite(self):
        self.assert_refused(self.with_row(spectrum_error=math.inf), "spectrum_error is inf")

    def test_counter_that_is_text(self):
        self.assert_refused(self.with_row(products="many"), 'products is "many", not a number')

    def test_counter_that_is_a_boolean(self):
        self.assert_refused(self.with_row(products=True), "products is true, not a number")

    def test_counter_that_is_negative(self):
        self.assert_refused(self.with_row(skew_defect=-1e-16), "skew_defect is -1e-16")

    def test_counter_that_is_huge(self):
        self.assert_refused(self.with_row(products=1e300), "products is 1e+300")

    def test_integer_too_large_for_a_float(self):
        self.assert_refused(self.with_row(products=10 ** 400), "products is inf")

    def test_integer_of_ten_thousand_digits(self):
        text = json.dumps(self.with_row(products=-123456)).replace("-123456", "9" * 10000)
        self.assert_refused(text.encode())

    def test_impossible_times(self):
        for time in (0, -1.0, 1e300, 1e-300, math.nan, "fast", None):
            with self.subTest(time=time):
                self.assert_refused(self.with_row(cpu_time=time), "table1/cotangent/n:17/s:1", "cpu_time")

    def test_unknown_time_unit(self):
        self.assert_refused(self.with_row(time_unit="h"), 'time_unit "h"')

    def test_line_breaks_in_a_name_do_not_break_the_message(self):
        self.assert_refused(self.with_row(run_name="table1/\n\nboom"), "boom")

    def test_a_long_name_does_not_make_the_message_long(self):
        self.assert_refused(self.with_row(run_name="table1/group/n:17/s:1/" + 1000 * "x", products=-1), "group/n:17",
                            "xxx...:")

    def test_error_message_that_is_no_text(self):
        for message in (7, None, ["diverged"], {}):
            with self.subTest(message=message):
                rows = failed_rows("group", 17, 1, message)
                self.assert_refused(raw(cells={("group", 17, 1): rows}), "table1/group/n:17/s:1", "error_message")

    def test_unknown_format(self):
        self.write(raw())
        self.assert_one_line(self.run_script(self.path, "--format", "html"), "--format")

    def test_no_arguments(self):
        self.assert_one_line(self.run_script(), "RAW.json")


class OutputTest(ScriptTest):
    def setUp(self):
        super().setUp()
        self.write(raw())
        self.output = os.path.join(self.folder, "table.txt")

    def test_output_holds_what_standard_output_would(self):
        self.run_script(self.path, "--output", self.output)
        with open(self.output, "rb") as stream:
            self.assertEqual(stream.read(), self.run_script(self.path).stdout)

    def test_output_leaves_standard_output_empty(self):
        self.assertEqual(self.run_script(self.path, "--output", self.output).stdout, b"")

    def test_no_temporary_file_stays_behind(self):
        self.run_script(self.path, "--output", self.output)
        self.assertEqual(sorted(os.listdir(self.folder)), ["raw.json", "table.txt"])

    def test_a_broken_file_leaves_the_old_output_alone(self):
        self.run_script(self.path, "--output", self.output)
        self.write(b"{")
        self.run_script(self.path, "--output", self.output)
        self.assertGreater(os.path.getsize(self.output), 1000)

    def test_output_in_a_folder_that_does_not_exist(self):
        missing = os.path.join(self.folder, "nowhere", "table.txt")
        self.assert_one_line(self.run_script(self.path, "--output", missing), "nowhere", "No such file")

    def test_output_that_is_a_folder(self):
        self.assert_one_line(self.run_script(self.path, "--output", self.folder), self.folder, "directory")

    def test_output_never_replaces_the_raw_file(self):
        self.assert_one_line(self.run_script(self.path, "--output", self.path), "is the raw file itself")

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

    def test_complete_separation_of_five_from_five(self):
        self.assertAlmostEqual(statistics.rank_test(range(5), range(5, 10)), 1 / 252)

    def test_complete_separation_the_wrong_way(self):
        self.assertEqual(statistics.rank_test(range(5, 10), range(5)), 1.0)

    def test_sides_of_unequal_size_may_stand_either_way(self):
        self.assertAlmostEqual(statistics.rank_test([1, 2], [3, 4, 5, 6, 7]),
                               statistics.rank_test([1, 2, 3, 4, 5], [6, 7]))

    def test_a_tie_counts_against_the_claim(self):
        self.assertGreater(statistics.rank_test([1, 2, 3], [3, 4, 5]), statistics.rank_test([1, 2, 3], [3.1, 4, 5]))

    def test_a_tie_counts_against_the_opposite_claim_too(self):
        self.assertGreater(statistics.rank_test([3, 4, 5], [1, 2, 3]), statistics.rank_test([2.9, 4, 5], [1, 2, 3]))

    def test_equal_samples_prove_nothing(self):
        self.assertEqual(statistics.rank_test([1] * 9, [1] * 9), 1.0)

    def test_four_repetitions_cannot_reach_the_level(self):
        self.assertGreater(statistics.rank_test(range(4), range(4, 8)), statistics.LEVEL)

    def test_decision_has_three_ways(self):
        low, high = [1, 2, 3, 4, 5], [6, 7, 8, 9, 10]
        self.assertEqual([statistics.compare(*pair).outcome for pair in ((low, high), (high, low), (low, low))],
                         [statistics.FASTER, statistics.SLOWER, statistics.UNDECIDED])

    def test_half_interquartile_range(self):
        self.assertEqual(statistics.half_interquartile_range([5, 1, 4, 2, 3]), 1.0)

    def test_one_value_has_no_spread(self):
        self.assertEqual(statistics.half_interquartile_range([5]), 0.0)


class PublishedTest(ScriptTest):
    def read(self, seconds):
        self.write(f"n,formulation,stages,seconds\n17,group,1,{seconds}\n".encode())
        return comparison.read_published(self.path)

    def test_a_time_is_read(self):
        self.assertEqual(self.read("0.5"), {("group", 17, 1): 0.5})

    def test_impossible_times(self):
        for seconds in ("0", "-1", "nan", "inf", "1e300", "1e-300", "fast", ""):
            with self.subTest(seconds=seconds), self.assertRaisesRegex(benchmark_json.UnusableFile, "published times"):
                self.read(seconds)


class NumbersTest(unittest.TestCase):
    def test_three_digits(self):
        for value, text in ((0, "0"), (0.0031234, "0.00312"), (0.0999999, "0.100"), (9.995, "9.99"), (9.996, "10.0"),
                            (108.42, "108"), (12345, "12300"), (1.2345e-14, "1.23e-14"), (1e7, "1.00e+07")):
            with self.subTest(value=value):
                self.assertEqual(three_digits(value), text)


class ReaderTest(ScriptTest):
    def test_cells_hold_times_and_counters(self):
        self.write(raw(sizes=(17,)))
        run = benchmark_json.read_run(self.path, "table1", ("products",))
        cell = run.measurements[benchmark_json.CellKey("group", 17, 1)]
        self.assertEqual((len(cell.times), cell.counters, cell.failure), (7, {"products": 2100.0}, None))

    def test_times_are_in_the_order_of_repetition(self):
        data = raw(sizes=(17,))
        data["benchmarks"].reverse()
        self.write(data)
        times = benchmark_json.read_run(self.path, "table1", ()).measurements["group", 17, 1].times
        self.assertEqual(list(times), sorted(times))


if __name__ == "__main__":
    unittest.main()
