"""Tests of the study of the paper's claims, of its model of threads, and of what changes its findings."""

import argparse
import json
import os
import shutil
import sys
import unittest
from collections import defaultdict
from unittest import mock

from programs import BUILD, DONE, MEASURE, RENDER, ROOT, FolderTest, run_script, text_of
from claims_documents import RATES, tables, write_claims

sys.path.insert(0, os.path.join(BUILD, "python"))

import isosyrk  # noqa: F401 (CTest leaves this file out where there is no module)
from studies.claims import report as claims_report, judge as claims_table
from lib.records import formats
from studies.claims import run as claims_study
from studies.claims.judge import cell_text, read_claims_table
from lib.programs.command_line import Stop
from lib.records.findings import read_findings
from lib.records.formats import FORMULATIONS, parse_json
from studies.theorem.judge import Findings as Theorem
from studies.turbulence.judge import Findings as Turbulence
from lib.programs.messages import UnusableFile
from studies.claims.parallel_model import (PROCESSORS, Rates, makespan, path_products, phases, sweep_seconds,
                                           work_seconds)
from lib.judging.verdicts import FAILS, FEWEST, HOLDS, TIE

STUDY = MEASURE, "claims"
RENDERING = RENDER, "claims"
RECORDED = os.path.join(ROOT, "results", "recorded")
CELLS = ("cotangent2", "group2", "algebra2")


CHANGED = "IIIA–IIIB, IIIA, s = 2"  # a partitioned pair


def found_by(study, kind):
    """Returns the Findings of a recorded study."""
    return read_findings(os.path.join(RECORDED, study, "findings.json"), study, kind)


def avx2_raw():
    """Returns the recorded raw file of both tables as if AVX2 kernels had written it."""
    raw = parse_json(text_of(RECORDED, "tables", "raw.json"))
    raw["context"].update(blas_kernels="Haswell", products="split, avx2 kernels")
    return raw


class Model(unittest.TestCase):
    def test_products_of_a_sweep_are_those_that_the_fast_forms_count(self):
        scene = isosyrk.scene("smooth", n=17)
        for form in FORMULATIONS:
            for s in (2, 3):
                method = isosyrk.integrator(scene, f"{form}{s}", solver="fast",
                                            without=("predictor", "newton", "bands"))
                counts = [method.run(scene.initial, h, 1)[1] for h in (0.1, 0.3)]
                self.assertGreater(counts[1].sweeps, counts[0].sweeps)
                a_sweep = ((counts[1].equivalent_products - counts[0].equivalent_products)
                           / (counts[1].sweeps - counts[0].sweeps))
                modelled = sum(task.products for phase in phases(form, s) for task in phase)
                self.assertAlmostEqual(modelled, a_sweep, msg=f"{form}{s}")

    def test_a_makespan_is_that_of_whole_tasks(self):
        for durations, processors, wanted in (([1.0] * 5, 1, 5.0), ([1.0] * 5, 2, 3.0), ([1.0] * 5, 64, 1.0),
                                              ([2.0, 1.0, 1.0], 2, 2.0), ([], 3, 0.0)):
            self.assertEqual(makespan(durations, processors), wanted)

    def test_more_processors_take_less_down_to_the_critical_path(self):
        for form in FORMULATIONS:
            for s in (1, 2, 3):
                times = [sweep_seconds(form, s, RATES, p) for p in PROCESSORS]
                self.assertEqual(times, sorted(times, reverse=True))
                self.assertAlmostEqual(times[0], work_seconds(form, s, RATES, 1))
                self.assertTrue(all(each >= work_seconds(form, s, RATES, p) * (1 - 1e-12)
                                    for each, p in zip(times, PROCESSORS)))
                self.assertAlmostEqual(sweep_seconds(form, s, Rates(1.0, 0.0), 64), path_products(form, s))
        self.assertEqual([path_products(form, 3) for form in FORMULATIONS], [1.5, 2.5, 1.0])


class Judging(unittest.TestCase):
    def test_partitioned_pairs_are_judged_by_rounding(self):
        def findings(**changes):
            ends = [end._replace(**changes) if end.case == CHANGED else end for end in theorem.ends]
            return [[(each.result, each.count) for each in row.findings["plain"]]
                    for row in claims_table.partitioned_rows(theorem._replace(ends=ends))]

        theorem = found_by("theorem", Theorem)
        self.assertEqual(findings(), [[(HOLDS, 4)], [(HOLDS, 4)]])
        self.assertEqual(findings(casimir_errors=(1e-6, 0, 0)), [[(HOLDS, 3), (FAILS, 1)], [(HOLDS, 4)]])
        self.assertEqual(findings(differences=(1e-15, 1, 1)), [[(HOLDS, 4)], [(HOLDS, 3), (FAILS, 1)]])

    def test_order_in_turbulence_is_that_of_the_cheapest_faithful_setting(self):
        def turbulence(samples):
            sizes = {33: samples, 65: FEWEST, 129: 10}
            return Turbulence([trust._replace(n=n, samples=count) for n, count in sizes.items()], [], [
                setting(33, "algebra1", 1.0), setting(33, "algebra1", 0.5), setting(33, "group2", 0.2),
                setting(33, "group3", 0.4), setting(33, "rk4", 0.1), setting(33, "rk4", 0.3),
                setting(33, "elp4", 0.01, faithful=False), setting(65, "algebra1", 1.0), setting(65, "group3", 2.0),
                setting(65, "elp4", None), setting(129, "algebra1", 1.0, faithful=False)], [])

        def setting(n, name, over_baseline, **changes):
            entry = formats.listed(name)
            return one._replace(**{"n": n, "integrator": name, "order": entry.order, "family": entry.family,
                                   "faithful": True, "over_baseline": over_baseline, **changes})

        recorded = found_by("turbulence", Turbulence)
        trust, one = recorded.trust[0], recorded.settings[0]
        orders, prices, winners = claims_table.order_rows(turbulence(10))
        self.assertEqual(cell_text(orders.findings["optimised"], True), "4 at n = 33 (group2), 2 at n = 65 (algebra1)")
        self.assertEqual([each.ratio for each in prices.findings["optimised"]], [2.5, 0.5])
        self.assertEqual(cell_text(winners.findings["optimised"], True), "4 at n = 33 (rk4), 2 at n = 65 (algebra1)")
        self.assertEqual([row.has_orders for row in (orders, prices, winners)], [True, False, True])
        self.assertEqual(orders.evidence, ("recorded/turbulence/report.md",))
        self.assertEqual(claims_table.order_rows(None), [])
        # By fewer samples than that, no order is named, and none is compared with another.
        orders, prices, winners = claims_table.order_rows(turbulence(FEWEST - 1))
        for row in (orders, winners):
            self.assertRegex(cell_text(row.findings["optimised"], True), r"^undecided at n = 33, 2 at n = 65")
        self.assertEqual([each.where for each in prices.findings["optimised"]], ["n = 65"])


class Rendering(FolderTest):
    def render(self, path, *arguments):
        return run_script(*RENDERING, path, "--out", self.path("out"), *arguments)

    def rendered(self, made=None, *arguments):
        done = self.render(write_claims(self.folder, made), *arguments)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (DONE, "", ""))
        self.assertEqual(set(os.listdir(self.path("out"))), {"report.md", "figures.json", "claims.json"})
        return {(row.claim, row.stages, row.statement): row.findings
                for row in read_claims_table(self.path("out", "claims.json"))[0]}

    def by_claim(self, rows, claim, stages):
        found, = [findings for (label, s, _), findings in rows.items() if (label, s) == (claim, stages)]
        return found

    def test_formulations_that_differ_in_octave_are_counted(self):
        made = tables()
        made["octave_pairs"][0] = made["octave_pairs"][0]._replace(difference=1e-9)
        found = self.by_claim(self.rendered(made), "theorem", None)["octave"]
        self.assertEqual([(each.result, each.count) for each in found], [(HOLDS, 17), (FAILS, 1)])

    def test_avx2_tables_are_codes_of_their_own_and_other_kernels_are_refused(self):
        raw = avx2_raw()
        self.write("avx2.json", json.dumps(raw))  # found beside the raw file
        rows = self.rendered()
        found = self.by_claim(rows, "(c)", 3)
        self.assertEqual(list(found)[-2:], ["plain_avx2", "optimised_avx2"])
        self.assertEqual(found["plain_avx2"], found["plain"])  # the raw file is the same
        report = text_of(self.path("out", "report.md"))
        self.assertNotIn(claims_report.NOT_MEASURED, report)
        self.assertNotIn(claims_report.NO_AVX2, report)
        for change in ({"blas_kernels": "Cooperlake"}, {"products": "split, avx512 kernels"}):
            wrong = {**raw, "context": {**raw["context"], **change}}
            self.write("avx2.json", json.dumps(wrong))
            self.assert_refused(self.render(write_claims(self.folder)), "avx2.json", "AVX2")

    def test_processors_are_compared(self):
        here = {"cpu": "a processor", "blas_kernels": "Cooperlake"}
        other, avx2 = {**here, "cpu": "another"}, {**here, "blas_kernels": "Haswell"}
        for processors, is_told in (({"claims": here, "tables": here, "avx2": avx2}, False),
                                    ({"claims": here, "tables": other}, True), ({"claims": avx2, "tables": here}, True),
                                    ({"claims": here, "tables": here, "avx2": {**avx2, "cpu": "another"}}, True)):
            self.assertEqual(bool(claims_report.processor_sections(processors)), is_told)

    def test_parts_that_are_missing_are_left_out(self):
        rows = self.rendered({name: [] for name in tables()})
        self.assertNotIn("octave", self.by_claim(rows, "(a)", 1))
        self.assertIn("paper", self.by_claim(rows, "(a)", 1))

    def test_files_that_cannot_be_used_are_refused(self):
        self.assert_refused(self.render(self.path("none.json")), "none.json")
        self.assert_refused(self.render(self.write("half.json", "{")), "half.json", "whole JSON")
        self.assert_refused(self.render(write_claims(self.folder), "--recorded", self.path("nowhere")), "nowhere")
        for text, part in (('{"format": "x"}', "table of claims"), ('{"format": "isosyrk claims 1"}', "no claims")):
            with self.assertRaisesRegex(UnusableFile, part):
                read_claims_table(self.write("claims.json", text))

    def test_recorded_findings_that_are_damaged_or_missing_are_refused(self):
        recorded = self.path("recorded")
        shutil.copytree(RECORDED, recorded, ignore=shutil.ignore_patterns("*.svg", "*.npy"))
        raw = write_claims(self.folder)
        for study in ("theorem", "accuracy", "turbulence"):
            path = os.path.join(recorded, study, "findings.json")
            whole_file = text_of(path)
            self.write(path, whole_file[:-100])
            self.assert_refused(self.render(raw, "--recorded", recorded), f"{study}/findings.json", "not whole JSON")
            self.write(path, whole_file)
        os.unlink(path)  # of turbulence, which may not be recorded yet
        self.assertEqual(self.render(raw, "--recorded", recorded).returncode, DONE)
        os.unlink(os.path.join(recorded, "theorem", "findings.json"))
        self.assert_refused(self.render(raw, "--recorded", recorded), "theorem/findings.json", "cannot be read")

    def test_a_finding_that_changes_changes_claims(self):
        def claims():
            return claims_report.rendered(raw, recorded).files["claims.json"]

        recorded, raw = self.path("recorded"), write_claims(self.folder)
        shutil.copytree(RECORDED, recorded, ignore=shutil.ignore_patterns("*.svg", "*.npy"))
        before = claims()
        for study, table, column, value in (
                ("theorem", "coincidence", "within", 1), ("theorem", "ends", "changed", "nothing"),
                ("theorem", "claims", "result", FAILS), ("accuracy", "comparisons", "verdict", TIE),
                ("accuracy", "comparisons", "ratio", 0.5), ("accuracy", "gauss_order", "median", 3),
                ("turbulence", "settings", "faithful", False), ("turbulence", "settings", "order", 3),
                ("turbulence", "trust", "samples", 3)):
            path = os.path.join(recorded, study, "findings.json")
            whole_file = text_of(path)
            document = json.loads(whole_file)
            found = document["tables"][table]
            for row in found["rows"]:
                row[found["columns"].index(column)] = value
            self.write(path, json.dumps(document))
            with self.subTest(study=study, table=table, column=column):
                self.assertNotEqual(claims(), before)
            self.write(path, whole_file)
        self.assertEqual(claims(), before)


class Study(FolderTest):
    def test_threads_and_their_rates(self):
        block = {"n": 65, "step": 0.1, "steps": 2, "process": 0,
                 "rows": ["product", "pass", "sweeps group2 1", "whole algebra2 1"]}
        product, single_pass, sweeps, whole = claims_study.time_threads(block)
        self.assertLess(single_pass, product)
        self.assertGreater(sweeps, product)
        self.assertGreater(whole, 0)
        counts = [claims_study.count_threads({"n": 65, "name": "group2", "code": code, "step": 0.1, "steps": 2})
                  for code in ("sweeps", "whole")]
        self.assertGreater(counts[0]["sweeps"], counts[1]["sweeps"])

    def test_threads_have_all_cores_from_the_beginning_of_their_process(self):
        options, checkpoint = argparse.Namespace(processes=1), argparse.Namespace(context={})
        counts = [{"sweeps": 1, "equivalent_products": 1.0}] * 2
        with mock.patch("lib.running.untimed.results", return_value=counts), \
                mock.patch("lib.running.timed.by_processes", return_value=[defaultdict(lambda: [1.0])]) as measured:
            claims_study.thread_tables(options, (65,), ["group2"], checkpoint)
            self.assertEqual(measured.call_args.args[-1], os.sched_getaffinity(0))
            claims_study.times_of([{"rows": ["group2"]}], claims_study.of_samples, checkpoint, options, "samples")
            self.assertIsNone(measured.call_args.args[-1])  # which means the last core alone

    def test_another_blas_and_other_answers_are_refused(self):
        with self.assertRaisesRegex(Stop, "unknown or reference.*update-alternatives"):
            claims_study.require_same_kernels("unknown or reference", "Haswell")
        blas = "OpenBLAS (config: OpenBLAS 0.3.21 DYNAMIC_ARCH Haswell MAX_THREADS=64)"
        claims_study.require_same_kernels(blas, "Haswell")
        claims_study.require_equal(17, "group2", {"difference": 1e-12})
        for difference in (1e-10, float("nan")):
            with self.assertRaisesRegex(Stop, "group2 at n = 17"):
                claims_study.require_equal(17, "group2", {"difference": difference})

    def test_without_octave_it_says_what_to_install(self):
        with mock.patch("shutil.which", return_value=None), self.assertRaisesRegex(Stop, "install octave"):
            claims_study.octave_cells.run("initial.npy", ["group1"], 0.1, 1)


class Reports(unittest.TestCase):
    def test_kernels(self):
        claims_report.require_avx2({"blas_kernels": "Haswell", "products": "split, avx2 kernels"})
        for context in ({}, {"blas_kernels": "Haswell"}, {"blas_kernels": "SkylakeX", "products": "split, avx2"}):
            with self.assertRaises(UnusableFile):
                claims_report.require_avx2(context)


if __name__ == "__main__":
    unittest.main()
