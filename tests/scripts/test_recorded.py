"""What is recorded under results/ is what its raw files give, and README.md shows it."""

import os
import re
import subprocess
import sys
import tempfile
import unittest

from programs import ROOT

from lib import scaling_table
from lib.accuracy_lines import read_accuracy
from lib.accuracy_report import accuracy_sections
from lib.document import as_markdown
from lib.stability_files import FAST, read_long_runs, read_map
from lib.stability_report import stability_sections

RECORDED = os.path.join(ROOT, "results", "recorded")
MOST_BYTES = 8_000_000


def text(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


def raw(study, name="raw.json"):
    return os.path.join(RECORDED, study, name)


def charts(study):
    return {name[:-4] for name in os.listdir(os.path.join(RECORDED, study)) if name.endswith(".svg")}


class Recorded(unittest.TestCase):
    def test_reports_are_what_the_raw_files_give(self):
        failures, fast = read_map(raw("stability", "map.json")), read_map(raw("stability", "fast_map.json"), FAST)
        runs = read_long_runs(raw("stability", "long_runs.json"))
        for study, report in (("accuracy", accuracy_sections(read_accuracy(raw("accuracy")), charts("accuracy"))),
                              ("scaling", scaling_table.document(raw("scaling"))),
                              ("stability", stability_sections(failures, runs, charts("stability"), fast=fast))):
            with self.subTest(study=study):
                self.assertTrue(text(RECORDED, study, "report.md") == as_markdown(report), "render it again")

    def test_tables_and_verdicts_are_what_the_raw_file_gives(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, os.path.join(ROOT, "scripts", "render_tables"), raw("tables"), "--out", folder],
                           capture_output=True, encoding="utf-8", check=True)
            self.assertEqual(sorted([*os.listdir(folder), "raw.json"]), sorted(os.listdir(os.path.join(RECORDED, "tables"))))
            for name in os.listdir(folder):
                self.assertTrue(text(RECORDED, "tables", name) == text(folder, name), f"render {name} again")

    def test_lines_show_the_order_of_their_integrator(self):
        study = read_accuracy(raw("accuracy"))
        found = [(order - study.integrators[name].order, problem, name) for problem, name, solver in study.lines
                 if (order := study.observed_order(problem, name, solver)) is not None
                 and problem.time == 5 and problem.n <= 129]  # with the fine steps that show it
        self.assertGreater(len(found), 250)
        for difference, problem, name in found:
            with self.subTest(problem=str(problem), name=name):
                self.assertLess(abs(difference), 0.25)

    def test_every_chart_of_a_report_is_there(self):
        for study in ("accuracy", "stability"):
            shown = re.findall(r"^!\[.*\]\((.*)\.svg\)$", text(RECORDED, study, "report.md"), re.M)
            self.assertEqual((set(shown), len(shown) > 1), (charts(study), True))

    def test_only_what_is_compact_is_tracked(self):
        listed = subprocess.run(["git", "ls-files", "-z", "results"], cwd=ROOT, capture_output=True, encoding="utf-8")
        if listed.returncode != 0:
            self.skipTest("not a checkout")
        files = [name for name in listed.stdout.split("\0") if name]
        self.assertEqual({name.rpartition(".")[2] for name in files}, {"csv", "json", "md", "npy", "svg"})
        self.assertLess(sum(os.path.getsize(os.path.join(ROOT, name)) for name in files), MOST_BYTES)


class Pages(unittest.TestCase):
    def test_what_is_kept_up_to_date_is(self):
        for script in ("update_readme", "update_limits"):
            check = subprocess.run([sys.executable, os.path.join(ROOT, "scripts", script), "--check"],
                                   capture_output=True, encoding="utf-8", check=False)
            self.assertEqual((check.returncode, check.stderr), (0, ""), script)

    def test_pages_name_only_files_that_exist(self):
        named = []
        for folder in ("", "results", "core", "benchmarks", "scripts", "tests"):
            page = text(folder, "README.md")
            named += re.findall(r"`((?:core|benchmarks|tests|scripts|results)/[\w./-]*)`", page)
            named += [os.path.join(folder, target) for target in re.findall(r"\]\(([^)#:]+)\)", page)]
        self.assertGreater(len(named), 30)
        for name in named:
            self.assertTrue(os.path.exists(os.path.join(ROOT, name)) or name.startswith("results/latest")
                            or "NAME" in name, name)


if __name__ == "__main__":
    unittest.main()
