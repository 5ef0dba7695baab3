"""What is recorded under results/ is what its raw files give, and pages show it."""

import json
import os
import re
import subprocess
import unittest

import drawing
from programs import RENDER, ROOT, FolderTest, environment, run, run_script, snapshot

from studies.accuracy.schema import CUT
from lib.records.settings import TIGHT
from studies.accuracy.lines import read_accuracy
from lib.records.integrators import ADAMS
from studies.scaling.schema import read_scaling
from lib.judging.trend import trend_of

import studies

RECORDED = os.path.join(ROOT, "results", "recorded")
MAX_BYTES = 8 * 10**6


def text(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


def raw(study, name="raw.json"):
    return os.path.join(RECORDED, study, name)


STUDIES = tuple(name for name in dict.fromkeys(study.home for study in studies.STUDIES)
                if os.path.isdir(os.path.join(RECORDED, name)))  # a new study may not be recorded yet
RAW_FILES = {study: {part.file for each in studies.STUDIES if study == each.home for part in each.parts}
             for study in STUDIES}
DRAWN_BY = "3.6"  # matplotlib: another one draws other bytes


class Recorded(FolderTest):
    def rendered(self, study):
        """Returns the files that the raw files of a study give."""
        done = run([drawing.PYTHON, "-B", RENDER, study, raw(study), "--out", self.path(study)], timeout=300,
                   env=environment(MPLCONFIGDIR=self.path("matplotlib")))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        found = snapshot(self.path(study))
        return {name: data for name, data in found.items() if f"{os.path.splitext(name)[0]}.svg" not in found
                or not name.endswith(".png")}

    def test_reports_figures_and_charts_are_what_the_raw_files_give(self):
        version = run([drawing.PYTHON, "-c", "import matplotlib; print(matplotlib.__version__)"]).stdout
        self.assertGreater(len(STUDIES), 7)
        for study in STUDIES:
            found, kept = self.rendered(study), snapshot(os.path.join(RECORDED, study))
            with self.subTest(study=study):
                self.assertEqual(set(found) | RAW_FILES[study], set(kept))
                self.assertGreater(len(kept), 2)
                for name, data in found.items():
                    if version.startswith(f"{DRAWN_BY}.") or not name.endswith((".svg", ".png")):
                        self.assertTrue(data == kept[name], f"{study}/{name}: render it again")

    def test_a_changed_raw_file_gives_another_report_and_figures(self):  # so the comparison can fail
        document = json.loads(text(raw("theorem")))
        table = document["tables"]["cost"]
        at = table["columns"].index("seconds")
        table["rows"][0][at] = [1.1 * seconds for seconds in table["rows"][0][at]]
        path = self.write("raw.json", json.dumps(document))
        done = run_script(RENDER, "theorem", path, "--out", self.path("theorem"))
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("report.md", "figures.json"):
            self.assertNotEqual(text(self.path("theorem", name)), text(RECORDED, "theorem", name))

    def test_repetitions_show_no_trend(self):
        study = read_scaling(raw("scaling"))
        trend = study.trend()
        self.assertFalse(trend.is_shown(), trend)
        self.assertGreater(trend.series, 500)
        # Control: times that rise by 3 % a repetition are caught. With six rounds on a noisy machine 2 % are not, which
        # the page says.
        rising = [[time * 1.03**k for k, time in enumerate(point.seconds)] for point in study.points.values()]
        self.assertTrue(trend_of(rising).is_shown())

    def test_lines_show_the_order_of_their_integrator(self):
        study = read_accuracy(raw("accuracy"))
        # Of lines with the fine steps that show it, and not cut before. A method of order 10 is at rounding before its
        # order shows, and one of several steps is still begun by another in most of so few.
        found = [(order - study.integrators[name].order, problem, name) for problem, name, tolerance in study.lines
                 if tolerance == TIGHT and study.ends[problem, name, tolerance] != CUT
                 and problem.time == 5 and problem.n <= 129
                 and study.integrators[name].order < 10 and study.integrators[name].family != ADAMS
                 and (order := study.observed_order(problem, name)) is not None]
        self.assertGreater(len(found), 200)  # of the record, most of its lines
        for difference, problem, name in found:
            with self.subTest(problem=str(problem), name=name):
                self.assertLess(abs(difference), 0.25)

    def test_every_chart_of_a_report_is_there(self):
        for study in ("accuracy", "limits", "longruns", "turbulence"):
            charts = {name[:-4] for name in os.listdir(os.path.join(RECORDED, study)) if name.endswith(".svg")}
            shown = re.findall(r"^!\[.*\]\((.*)\.svg\)$", text(RECORDED, study, "report.md"), re.M)
            self.assertEqual((set(shown), bool(shown)), (charts, True), study)

    def test_only_what_is_compact_is_tracked(self):
        listed = subprocess.run(["git", "ls-files", "-z", "results"], cwd=ROOT, capture_output=True, encoding="utf-8")
        if listed.returncode != 0:
            self.skipTest("not a checkout")
        files = [name for name in listed.stdout.split("\0") if name]
        self.assertEqual({name.rpartition(".")[2] for name in files}, {"csv", "in", "json", "md", "npy", "png", "svg"})
        self.assertEqual({name for name in files if name.endswith(".png")},
                         {f"results/recorded/fluid/{name}.png" for name in ("fluid", "methods")})  # maps: large as SVG
        self.assertLess(sum(os.path.getsize(os.path.join(ROOT, name)) for name in files), MAX_BYTES)


EXAMPLE = {"<!-- example.cpp:begin -->", "<!-- example.cpp:end -->"}
LONGEST_LINE = 200  # of prose


def too_long(page, maximum):
    """Returns which lines of a page outside tables are too long, and whether it has too many."""
    lines = page.splitlines()
    found = [f"line {number}" for number, line in enumerate(lines, 1)
             if len(line) > LONGEST_LINE and not line.startswith("|")]
    return found + [f"more than {maximum} lines"] * (len(lines) > maximum)


class Pages(unittest.TestCase):
    def test_what_is_kept_up_to_date_is(self):
        check = run_script(os.path.join(ROOT, "scripts", "update"), "--check")
        self.assertEqual((check.returncode, check.stderr), (0, ""))

    def test_pages_read_well_raw(self):
        """README.md is short; no line of prose is long, and comments only mark the example that a test compiles."""
        for page, longest in (("README.md", 120), (os.path.join("results", "README.md"), 260),
                              (os.path.join("results", "simulate.md"), 100)):
            self.assertEqual(too_long(text(page), longest), [], page)
            self.assertEqual(set(re.findall(r"<!--.*?-->", text(page))) - EXAMPLE, set(), page)
            self.assertEqual(too_long(text(page), 30), ["more than 30 lines"])
        self.assertEqual(too_long(f"| {'cell ' * 60} |\n{'word ' * 41}\n", 2), ["line 2"])

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
