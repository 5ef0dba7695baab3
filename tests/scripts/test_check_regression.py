"""Tests of scripts/check_regression from outside, in a copy of the repository whose tools and programs are stand-ins.

The copy is a git repository of its own with two commits; what is built of the first is the base.
"""

import copy
import json
import os
import shutil
import signal
import subprocess
import sys
import time

from programs import BAD_ARGUMENTS, DATA, DONE, end, run, snapshot, start, strict_json, text_of
from test_reproduce import CopyTest

from gate.cells import baseline_of, read_build, write_baseline
from gate_documents import build_document, change

REGRESSION, NOT_JUDGED = 1, 3
BASELINE = os.path.join("results", "baseline", "baseline.json")

# Of head it is $FACTOR times slower than of base; base reports what stands in $REPORT_OF_BASE, if that is set.
REGRESSION_CELLS = f"""#!{sys.executable} -SE
import json, os, sys, time
is_base = "build-base" in os.path.abspath(sys.argv[0])
with open(os.environ["CALLS"], "a") as calls:
    calls.write("regression_cells" + (" of base " if is_base else " ") + " ".join(sys.argv[1:])
                + " with " + os.environ.get("OPENBLAS_CORETYPE", "its own") + "\\n")
if sys.argv[1] == "--help":
    print("--roundings")
    sys.exit()
if sys.argv[1] != "--serve":
    with open(is_base and os.environ.get("REPORT_OF_BASE") or os.environ["REPORT"]) as file:
        document = json.load(file)
    document["cells"] = [cell for cell in document["cells"] if cell["name"] in sys.argv[1:]]
    json.dump(document, sys.stdout)
    sys.exit()
print("ready", flush=True)
for line in sys.stdin:
    runs = int(line.split()[2])
    time.sleep(float(os.environ.get("SLEEP", "0")))
    print(0.01 * runs * (1.0 if is_base else float(os.environ.get("FACTOR", "1"))), flush=True)
"""

# Builds what is not there yet: the stand-in for regression_cells.
CMAKE = """#!/bin/sh
echo "cmake $*" >>"$CALLS"
case "$*" in *build-base*) [ -z "$BASE_FAILS" ] || { echo "no such target"; exit 1; } ;; esac
[ "$1" = --build ] && mkdir -p "$2/benchmarks" && cp -n "$PROGRAM" "$2/benchmarks/regression_cells"
exit "${CMAKE_STATUS:-0}"
"""


class GateTest(CopyTest):
    def setUp(self):
        super().setUp()
        self.root = self.path("root")
        self.program = self.write("regression_cells", REGRESSION_CELLS, executable=True)
        self.write("root/build/benchmarks/regression_cells", REGRESSION_CELLS, executable=True)
        self.write("tools/cmake", CMAKE, executable=True)
        self.write("root/.gitignore", "/build*/\n")
        self.write("root/CMakeLists.txt", "set(ISOSYRK_KERNELS all)\n")
        shutil.copytree(DATA, os.path.join(self.root, "tests", "data"))
        self.report(build_document())
        self.git("init", "-q")
        self.first = self.commit("first")
        write_baseline(os.path.join(self.root, BASELINE), baseline_of(read_build(build_document()), self.first))
        self.write("root/core/step.cpp", "")
        self.second = self.commit("second")

    def git(self, *arguments):
        identity = ("-c", "user.name=some", "-c", "user.email=some@example.org")
        done = subprocess.run(["git", *identity, "-C", self.root, *arguments], check=True, capture_output=True,
                              encoding="utf-8")
        return done.stdout.strip()

    def commit(self, message):
        self.git("add", "-A")
        self.git("commit", "-q", "--allow-empty", "-m", message)
        return self.git("rev-parse", "HEAD")

    def report(self, document, name="report.json"):
        return self.write(name, json.dumps(document))

    def on_other_kernels(self, document, name="report.json"):
        document["context"]["blas_kernels"] = "Haswell"
        return self.report(document, name)

    def settings(self, **changes):
        return self.surroundings(**{"REPORT": self.path("report.json"), "PROGRAM": self.program, **changes})

    def check(self, *arguments, **changes):
        return run(self.line("check_regression", *arguments), env=self.settings(**changes), cwd=self.folder,
                   timeout=120)

    def refuses(self, arguments, *parts, **changes):
        with self.subTest(arguments=arguments, changes=changes):
            before = snapshot(self.path("root", "results"))
            done = self.check(*arguments, **changes)
            self.assertEqual((done.returncode, done.stdout), (BAD_ARGUMENTS, ""), done.stderr)
            last = done.stderr.splitlines()[-1]
            for part in ("check_regression: ", *parts):
                self.assertIn(part, last)
            self.assertEqual(sum(line.startswith("check_regression: ") for line in done.stderr.splitlines()), 1)
            self.assertEqual(snapshot(self.path("root", "results")), before)


class Verdicts(GateTest):
    def test_quick_leaves_larger_n_out(self):
        self.report(change(build_document(), "group/n:129/s:2", sweeps=1))
        quick = self.check("--quick")
        self.assertEqual(quick.returncode, DONE)
        self.assertIn("timed: 12 of 36 cells", quick.stdout)
        self.assertEqual(self.check().returncode, REGRESSION)

    def test_each_layer_names_a_regression_by_cell_and_figure_as_text_markdown_and_json(self):
        report = change(build_document(), "fast_group/n:33/s:2", sweeps=101)
        self.report(change(report, "algebra/n:33/s:2", skew_defect=1e-20))
        done = self.check("--quick", "--out", self.out, FACTOR="1.06")
        self.assertEqual(done.returncode, REGRESSION, done.stderr)
        for name, figure in (("fast_group/n:33/s:2", r"sweeps\*? +101\*? +100"),
                             ("algebra/n:33/s:2", r"skew defect\*? +1e-20"),
                             ("algebra/n:33/s:1", r"CPU time, head over base\*? +1\.060"),
                             ("fast_algebra/n:33/s:1", r"CPU time, head over base\*? +1\.060")):
            self.assertRegex(done.stdout, rf"\b{name}\*? +{figure}")
        files = snapshot(self.out)
        self.assertEqual(set(files), {"report.txt", "report.md", "report.json"})
        self.assertEqual(files["report.txt"].decode(), done.stdout)
        found = strict_json(files["report.json"])
        self.assertEqual((found["exit_code"], found["base"]), (REGRESSION, self.first[:12]))
        self.assertEqual([(layer["name"], layer["verdict"], len(layer["checks"]) > 5) for layer in found["layers"]],
                         [(name, "regression", True) for name in ("exact", "accuracy", "timing")])

    def test_kernels_of_head_and_base_are_shown(self):
        base = build_document()
        base["context"]["flags"] = "-O2"
        done = self.check("--quick", REPORT_OF_BASE=self.report(base, "base.json"))
        for what, flags in (("head", "-O3"), ("base", "-O2")):
            kernels = f"OpenBLAS Zen, split products avx2, compiled for AVX2 with FMA; GNU 12.2.0 {flags}"
            self.assertIn(f"Kernels of {what}: {kernels}\n", done.stderr)
            self.assertIn(f"{what}: {kernels}", " ".join(done.stdout.split()))

    def test_on_other_kernels_counts_are_those_of_base(self):
        moved = change(build_document(), "fast_group/n:33/s:2", sweeps=110, equivalent_products=880.0,
                       poisson_solves=440)
        self.on_other_kernels(moved)
        base = self.on_other_kernels(copy.deepcopy(moved), "base.json")
        for options in ([], ["--no-timing"]):
            done = self.check("--quick", *options, REPORT_OF_BASE=base)
            self.assertEqual(done.returncode, NOT_JUDGED if options else DONE, done.stderr)
            self.assertIn("head is counted against base", " ".join(done.stdout.split()))
        asked = [call for call in self.calls("regression_cells") if "--roundings 4" in call]
        self.assertEqual([" of base " in call for call in asked], [False, True] * 2)
        done = self.check("--quick", REPORT_OF_BASE=self.on_other_kernels(build_document(), "base.json"))
        self.assertEqual(done.returncode, REGRESSION)
        self.assertRegex(done.stdout, r"fast_group/n:33/s:2\*? +sweeps\*? +110\*? +100 ± 2")

    def test_a_base_of_other_kernels_than_head_judges_neither_counts_nor_times(self):
        self.on_other_kernels(build_document())
        done = self.check("--quick", REPORT_OF_BASE=self.report(build_document(), "base.json"))
        self.assertEqual(done.returncode, NOT_JUDGED, done.stderr)
        for layer in ("exact", "timing"):
            self.assertIn(f"{layer} not judged: base runs other kernels: blas_kernels Zen for Haswell",
                          " ".join(done.stdout.split()))
        self.assertEqual([call for call in self.calls("regression_cells") if "--serve" in call], [])

    def test_ctrl_c_ends_it_and_what_it_started(self):
        process = start(self.line("check_regression", "--quick"), env=self.settings(SLEEP="60"), cwd=self.folder,
                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(end, process)
        for _ in range(600):
            if any("--serve" in call for call in self.calls("regression_cells")):
                break
            time.sleep(0.1)
        os.killpg(process.pid, signal.SIGINT)
        self.assertEqual(process.wait(timeout=20), 130)


class Base(GateTest):
    def test_is_the_baseline_s_revision_built_beside_once_until_another_is_named(self):
        for _ in range(2):
            done = self.check("--quick")
            self.assertEqual(done.returncode, DONE, done.stderr)
            for text in ("No regression.", "exact: passed", "accuracy: passed", "timing: passed", self.first[:12]):
                self.assertIn(text, done.stdout)
            (build,) = [call for call in self.calls("cmake --build") if "build-base" in call]
            self.assertIn(f"build-base/{self.first}/build --target regression_cells", build)
        source = os.path.join(self.root, "build-base", self.first, "source")
        self.assertTrue(os.path.exists(os.path.join(source, "scripts", "check_regression")))
        shutil.rmtree(os.path.dirname(source))  # and one whose unpacking was interrupted is unpacked anew
        os.makedirs(f"{source}.part/core")
        self.assertEqual(self.check("--quick").returncode, DONE)
        self.assertTrue(os.path.exists(os.path.join(source, "scripts", "check_regression")))
        self.assertFalse(os.path.exists(f"{source}.part"))

        self.write("root/core/step.cpp", "// not committed\n")
        done = self.check("--quick", "--base", "HEAD")
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertIn(self.second[:12], done.stdout)
        self.assertEqual(os.listdir(os.path.join(self.root, "build-base")), [self.second])

    def test_is_this_tree_s_own_build_where_nothing_that_is_compiled_has_changed_since(self):
        self.write("root/core/README.md", "a page\n")
        self.write("root/scripts/some.py", "")
        self.commit("pages and scripts")
        own = "nothing that is compiled has changed since base: its programs are head's"
        done = self.check("--quick", "--base", self.second)
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertIn(own, " ".join(done.stdout.split()))
        self.assertIn(f"Base: {self.second[:12]}", done.stdout)
        self.assertFalse(os.path.exists(os.path.join(self.root, "build-base")))
        for path in ("core/step.cpp", "benchmarks/new.cpp", "CMakeLists.txt"):  # changed, or new, and not committed
            with self.subTest(path=path):
                text = text_of(self.root, path) if os.path.exists(self.path("root", path)) else None
                self.write(f"root/{path}", f"{text or ''}# a change\n")
                done = self.check("--quick", "--base", self.second)
                self.assertEqual(done.returncode, DONE, done.stderr)
                self.assertNotIn(own, " ".join(done.stdout.split()))
                self.assertEqual(os.listdir(os.path.join(self.root, "build-base")), [self.second])
                shutil.rmtree(os.path.join(self.root, "build-base"))
                if text is None:
                    os.remove(self.path("root", path))
                else:
                    self.write(f"root/{path}", text)

    def test_a_clone_without_it_is_not_judged_in_time_and_says_why(self):
        shallow = self.path("shallow")
        subprocess.run(["git", "clone", "-q", "--depth", "1", "file://" + self.root, shallow], check=True)
        shutil.move(os.path.join(self.root, ".git"), self.path("whole.git"))
        for why in ("this tree is no git repository",
                    f"the baseline's revision {self.first[:12]} is not in this clone"):
            done = self.check("--quick")
            self.assertEqual(done.returncode, NOT_JUDGED, done.stderr)
            for text in (f"timing not judged: {why}", "exact: passed", "not every layer was judged"):
                self.assertIn(text, " ".join(done.stdout.split()))
            if not os.path.exists(os.path.join(self.root, ".git")):
                shutil.move(os.path.join(shallow, ".git"), os.path.join(self.root, ".git"))

    def test_a_clone_without_it_on_other_kernels_is_not_judged_in_counts_either(self):
        self.on_other_kernels(change(build_document(), "group/n:17/s:2", sweeps=9))
        shutil.move(os.path.join(self.root, ".git"), self.path("whole.git"))
        done = self.check("--quick")
        self.assertEqual(done.returncode, NOT_JUDGED, done.stderr)
        self.assertIn("exact not judged: these are not the recorded kernels, and this tree is no git repository",
                      " ".join(done.stdout.split()))

    def test_of_a_build_for_another_machine_is_built_for_that_too(self):
        done = self.check("--quick", "--machine", "x86-64-v3")
        self.assertEqual(done.returncode, DONE, done.stderr)
        configured = [call for call in self.calls("cmake -S")]
        self.assertEqual(len(configured), 2)
        for call, folder in zip(configured, ("root/build-x86-64-v3", f"build-base/{self.first}/build-x86-64-v3")):
            self.assertIn(f"{folder} -DCMAKE_BUILD_TYPE=Release", call)
            for option in ("-DISOSYRK_NATIVE=OFF", "-DISOSYRK_KERNELS=avx2", "-march=x86-64-v3 -ffp-contract=off"):
                self.assertIn(option, call)
            self.assertNotIn("ISOSYRK_COMPILER_HAS", call)
        self.assertEqual(self.check("--quick").returncode, DONE)
        self.assertEqual(set(os.listdir(os.path.join(self.root, "build-base", self.first))),
                         {"source", "build", "build-x86-64-v3"})

    def test_from_before_the_choice_of_kernels_gets_the_same_by_other_means(self):
        self.write("root/CMakeLists.txt", "")
        before = self.commit("before")
        self.write("root/CMakeLists.txt", "set(ISOSYRK_KERNELS all)\n")
        self.commit("after")
        self.assertEqual(self.check("--quick", "--machine", "x86-64", "--base", before).returncode, DONE)
        head, base = self.calls("cmake -S")
        for option in ("-DISOSYRK_COMPILER_HAS_AVX512=OFF", "-DISOSYRK_COMPILER_HAS_AVX2=OFF"):
            self.assertIn(option, base)
            self.assertNotIn(option, head)

    def test_no_timing_times_nothing_and_json_is_printed_in_place_of_text(self):
        done = self.check("--quick", "--no-timing", "--json")
        self.assertEqual(done.returncode, NOT_JUDGED, done.stderr)
        found = strict_json(done.stdout)
        self.assertEqual((found["exit_code"], found["layers"][2]["not_judged"]), (NOT_JUDGED, "--no-timing was given"))
        self.assertEqual([call for call in self.calls("regression_cells") if "--serve" in call], [])

    def test_an_inherited_kernel_choice_is_cleared_or_kept_in_every_process_and_said(self):
        for options, told, ran in (([], "cleared the inherited", "with its own"),
                                   (["--keep-coretype"], "kept the inherited", "with Nehalem")):
            self.write("calls", "")
            done = self.check("--quick", *options, OPENBLAS_CORETYPE="Nehalem")
            self.assertEqual(done.returncode, DONE, done.stderr)
            self.assertIn(f"Note: {told} OPENBLAS_CORETYPE=Nehalem", done.stderr)
            calls = self.calls("regression_cells")
            self.assertGreater(len(calls), 5)
            self.assertEqual([call for call in calls if not call.endswith(ran)], [])


class History(GateTest):
    def test_a_run_appends_its_ratios(self):
        path = self.path("history.jsonl")
        for runs in (1, 2):
            done = self.check("--quick", "--history", path, FACTOR="1.02")
            self.assertEqual(done.returncode, DONE, done.stderr)
            lines = [strict_json(line) for line in text_of(path).splitlines()]
            self.assertEqual(len(lines), runs)
        self.assertEqual((lines[1]["program"], len(lines[1]["ratios"])), ("check_regression", 12))
        for each in lines[1]["ratios"]:
            self.assertAlmostEqual(each["ratio"], 1.02, places=5)
            self.assertLessEqual(each["low"], each["ratio"])
        self.assertIn("OpenBLAS Zen, split products avx2", lines[1]["kernels"])

    def test_one_that_cannot_be_used_is_refused_before_anything_is_built(self):
        path = self.write("damaged", "{}\n")
        self.refuses(["--quick", "--history", path], path, "line 1")
        self.refuses(["--quick", "--history", self.path("none", "history")], "--history", "cannot be written")
        for option in ("--no-timing", "--update-baseline"):
            self.refuses([option, "--history", path], "--history" if option == "--no-timing" else option)
        self.assertEqual((self.calls(), text_of(path)), ([], "{}\n"))

    def test_times_that_were_not_judged_are_not_appended(self):
        shutil.move(os.path.join(self.root, ".git"), self.path("whole.git"))
        done = self.check("--quick", "--history", self.path("history.jsonl"))
        self.assertEqual(done.returncode, NOT_JUDGED, done.stderr)
        self.assertIn("nothing is appended, as no times were judged: this tree is no git", done.stderr.splitlines()[-1])
        self.assertFalse(os.path.exists(self.path("history.jsonl")))


class BadInput(GateTest):
    def test_arguments(self):
        for arguments, part in ((["--fast"], "--fast"), (["--update-baseline", "--quick"], "--update-baseline"),
                                (["--update-baseline", "--machine", "x86-64"], "--update-baseline"),
                                (["--update-baseline", "--keep-coretype"], "--update-baseline"),
                                (["--machine", "i386"], "--machine")):
            self.refuses(arguments, part)

    def test_an_unknown_revision(self):
        for revision in ("no-such-branch", "--all", "HEAD:scripts"):
            self.refuses([f"--base={revision}"], revision, "no revision")

    def test_a_baseline_that_is_missing(self):
        os.unlink(os.path.join(self.root, BASELINE))
        self.refuses(["--quick"], BASELINE, "cannot be read")

    def test_what_cannot_be_run(self):
        self.refuses([], "build", CMAKE_STATUS="1")
        self.refuses(["--quick"], f"base {self.first[:12]}", "build", BASE_FAILS="1")
        self.refuses(["--no-install"], "libfmt-dev", MISSING="libfmt-dev")
        self.write("taken", "")
        self.refuses(["--quick", "--out", self.path("taken", "out")], "--out", "cannot be written")


class UpdateBaseline(GateTest):
    def baseline(self):
        return strict_json(text_of(self.root, BASELINE))

    def test_records_this_commit_and_prints_what_moves(self):
        self.report(change(build_document(), "group/n:33/s:2", allocations=3))
        done = self.check("--update-baseline")
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertRegex(done.stdout, r'"group/n:33/s:2",\n( .*\n)+-   "allocations": 0\n\+   "allocations": 3\n')
        self.assertRegex(done.stdout, f'-.*{self.first}.*\n\\+.*{self.second}')
        self.assertEqual(self.baseline()["commit"], self.second)

    def test_refuses_a_tree_with_changes_and_one_without_repository(self):
        self.write("root/results/paper/table1.csv", "changed")
        self.refuses(["--update-baseline"], "not committed")
        self.git("checkout", "-q", ".")
        shutil.move(os.path.join(self.root, ".git"), self.path("whole.git"))
        self.refuses(["--update-baseline"], "no git repository")

    def test_refuses_a_build_that_is_not_accurate(self):
        self.report(change(build_document(), "algebra/n:33/s:2", skew_defect=1e-20))
        before = self.baseline()
        done = self.check("--update-baseline")
        self.assertEqual((done.returncode, done.stdout), (REGRESSION, ""))
        self.assertIn("algebra/n:33/s:2: skew defect 1e-20", done.stderr)
        self.assertEqual(self.baseline(), before)

    def test_replaces_one_that_cannot_be_read(self):
        self.write(os.path.join("root", BASELINE), "{")
        self.commit("damaged")
        done = self.check("--update-baseline")
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertEqual([len(self.baseline()[section]) for section in ("cells", "fast_cells")], [36, 36])
