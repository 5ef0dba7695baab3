"""Tests of scripts/reproduce and scripts/test in a copy of the repository whose tools are stand-ins.

The copy has the real scripts; package tools, CMake, CTest and the benchmark program are small shell scripts that
write down how they were called.
"""

import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time

from programs import (BAD_ARGUMENTS, DONE, PATIENCE, ROOT, SOLVER_FAILED, FolderTest, end, environment, open_terminal,
                      run, snapshot, start, text_of)
from limits_documents import limits_study
from limits_documents import write as write_limits
from scaling_documents import point, write_scaling, write_tables
from threads_documents import run as of_threads
from threads_documents import write_threads

from studies import STUDIES

HOST_NAME = "a-host-to-keep-private"
PAGE = "report.html"
RESULTS = {"raw.json", "table.txt", "table.md", "table.tex", "verdicts.json", PAGE}
STUDY_RESULTS = {"raw.json", "report.md", "figures.json", PAGE}
TABLE_PROGRAMS = "build/benchmarks/table1", "build/benchmarks/table2", "build-avx2/benchmarks/table2"
BUILDS = ("build", "build-sanitize", "build-threads", "build-x86-64", "build-x86-64-v3", "build-x86-64-v3-sanitize")
CORES = len(os.sched_getaffinity(0))

STAND_INS = {
    # Knows every package but those in $MISSING, and of $REMOVED only the configuration.
    "dpkg-query": """
status=0
for package; do
  case " $MISSING : $REMOVED " in
    *" $package "*:*) echo "dpkg-query: no packages found matching $package" >&2; status=1 ;;
    *:*" $package "*) echo "$package deinstall ok config-files" ;;
    *) echo "$package install ok installed" ;;
  esac
done
exit $status
""",
    # As sudo does unless told otherwise, it passes on hardly anything of the environment.
    "sudo": """
echo "sudo $*" >>"$CALLS"
exec env -i PATH="$PATH" CALLS="$CALLS" "$@"
""",
    "id": """
echo "${USER_ID:-0}"
""",
    "apt-cache": """
for package; do :; done
[ "$package" != "$ABSENT" ]
""",
    "lscpu": """
echo "Flags: fpu avx2 ${UNITS-avx512f}"
""",
    **dict.fromkeys(("apt-get", "cmake", "ctest"), """
tool=${0##*/}
echo "$tool[${DEBIAN_FRONTEND:-}] $*" >>"$CALLS"
echo "chatter of $tool"
[ "$tool" != "$FAILING" ]
"""),
}

# What a build says of its kernels.
KERNEL_SETS = """#!/bin/sh
[ "$FAILING" != kernel_sets ] || exit 1
echo "OpenBLAS ${OPENBLAS_CORETYPE:-Zen}, split products avx2, in $0"
"""

# scripts/measure, but for the tables: writes down how it was called, then does what $BENCHMARK says, and fails if the
# study, or its file, is $FAILING. What it measured is prepared under its name.
MEASURED = """#!/bin/sh
[ "$1" != tables ] || exec "$0.real" "$@"
program=$1
shift
echo "$program[${OPENBLAS_CORETYPE-none}] $* on $(nproc) cores" >>"$CALLS"
file=$program
while [ $# -gt 0 ]; do
  case $1 in --out) out=$2 ;; --scene) file=$program-$2 ;; esac
  shift
done
echo "chatter of $program"
case $FAILING in "$program"|"$file") echo "some reason"; exit 7 ;; esac
case $BENCHMARK in
  finish) cp "$PREPARED/$file.json" "$out" ;;
  scribble) echo '{"context": {' >"$out" ;;
  die) echo half >"$out.1.partial"; kill -KILL $$ ;;
  wait) echo half >"$out.1.partial"; echo started >>"$CALLS"; exec sleep 600 ;;
esac
exit "${BENCHMARK_STATUS:-0}"
"""

# A benchmark program: the same, but of what is prepared it writes the rows that its filter leaves in.
TABLE_PROGRAM = """#!%s -SE
import json, os, re, signal, sys, time

program, options = os.path.basename(sys.argv[0]), dict(each.partition("=")[::2] for each in sys.argv[1:])
told = os.environ.get("OPENBLAS_CORETYPE", "none"), " ".join(sys.argv[1:]), len(os.sched_getaffinity(0))
with open(os.environ["CALLS"], "a") as calls:
    calls.write("%%s[%%s] %%s on %%d cores\\n" %% (program, *told))
print("chatter of", program)
if program == os.environ.get("FAILING"):
    print("some reason")
    sys.exit(7)
with open(os.path.join(os.environ["PREPARED"], program + ".json")) as file:
    found = json.load(file)
found["benchmarks"] = [row for row in found["benchmarks"]
                       if re.search(options["--benchmark_filter"], row["run_name"] + "/")]
what = os.environ["BENCHMARK"]
with open(options["--benchmark_out"] + ("" if what in ("finish", "scribble") else ".1.partial"), "w") as file:
    file.write(json.dumps(found) if what == "finish" else '{"context": {')
if what == "die":
    os.kill(os.getpid(), signal.SIGKILL)
if what == "wait":
    with open(os.environ["CALLS"], "a") as calls:
        calls.write("started\\n")
    time.sleep(600)
sys.exit(int(os.environ.get("BENCHMARK_STATUS", "0")))
""" % sys.executable

# scripts/page, since it takes seconds: writes down how it was called, and one word; or $PAGE is what becomes of it.
PAGED = """#!/bin/sh
echo "page[] $*" >>"$CALLS"
while [ $# -gt 0 ]; do
  case $1 in --out) out=$2 ;; esac
  shift
done
case $PAGE in
  none) echo "page: no report.html: no Python with plotly found" >&2 ;;
  wait) echo started >>"$CALLS"; exec sleep 600 ;;
  fail) echo "page: $out/raw.json: is wrong" >&2; exit 2 ;;
  *) mkdir -p "$out" && echo drawn >"$out/report.html" ;;
esac
"""

# scripts/render, but for some studies, since drawing takes seconds: for them it does what is said at the end.
RENDERED = """#!/bin/sh
case " %s " in *" $1 "*) ;; *) exec "$0.real" "$@" ;; esac
for out; do :; done
%s
"""
# Leaves one word in each file of the folder that it is told last.
DRAW = """
echo drawn >"$out/report.md"
echo drawn >"$out/figures.json"
case $1 in claims) echo drawn >"$out/claims.json" ;; esac
"""


def raw_file(failed=False, tables=("table1",), sizes=(17,)):
    """Returns the rows of tables at some n in the recorded raw file, as the first of them would have written it.

    As if made on a host with a name and without reference solutions, with the algebra rows failed or not.
    """
    raw = json.loads(text_of(ROOT, "results", "recorded", "tables", "raw.json"))
    raw["context"] = {"host_name": HOST_NAME, **raw["context"], "isosyrk_program": tables[0]}
    if tables[0] == "table1":
        raw["context"]["products"] = raw["context"].pop("published_products")
    raw["benchmarks"] = [row for row in raw["benchmarks"] if re.fullmatch(
        rf"({'|'.join(tables)})/.*/n:({'|'.join(map(str, sizes))})/.*", row["run_name"])]
    for row in raw["benchmarks"]:
        del row["relative_error"], row["reference_uncertainty"]
        if failed and "/algebra/" in row["run_name"]:
            row.update(error_occurred=True, error_message="sweep cap at step 1", cpu_time=0)
    return raw


def one_process(failed=False, tables=("table1",)):
    """Returns the rows of one process at every n, as a program writes them."""
    raw = raw_file(failed, tables, (17, 33, 65, 129))
    raw["benchmarks"] = [row for row in raw["benchmarks"] if row["process"] == 0]
    for row in raw["benchmarks"]:
        del row["process"]
    return raw


class CopyTest(FolderTest):
    """A copy of the repository, and the tools that its scripts call."""

    def setUp(self):
        super().setUp()
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(os.path.join(ROOT, "scripts"), self.path("root", "scripts"), ignore=ignored)
        shutil.copytree(os.path.join(ROOT, "results", "paper"), self.path("root", "results", "paper"))
        for name, body in STAND_INS.items():
            self.write(f"tools/{name}", "#!/bin/sh\n" + body, executable=True)
        for folder in BUILDS:
            self.write(f"root/{folder}/benchmarks/kernel_sets", KERNEL_SETS, executable=True)
        os.mkdir(self.path("tmp"))
        self.calls_path = self.write("calls", "")
        self.out = self.path("out")

    def line(self, script, *arguments):
        return [self.path("root", "scripts", script), *arguments]

    def surroundings(self, **changes):
        settings = {"PATH": self.path("tools") + os.pathsep + environment()["PATH"], "TMPDIR": self.path("tmp"),
                    "CALLS": self.calls_path, "BENCHMARK": "finish", "PREPARED": self.folder,
                    "PYTHONDONTWRITEBYTECODE": "1", "DEBIAN_FRONTEND": None, "ASAN_OPTIONS": None,
                    "OPENBLAS_CORETYPE": None}
        return environment(**{**settings, **changes})

    def script(self, name, *arguments, **changes):
        return run(self.line(name, *arguments), env=self.surroundings(**changes), cwd=self.folder)

    def calls(self, tool=""):
        return [line for line in text_of(self.calls_path).splitlines() if line.startswith(tool)]

    def await_start(self):
        """Waits until a stand-in has written down that it started."""
        deadline = time.monotonic() + PATIENCE
        while "started" not in self.calls():
            self.assertLess(time.monotonic(), deadline, "nothing was started")
            time.sleep(0.02)

    def assert_all_end(self, process):
        """All that a script started has ended soon after it."""
        with self.assertRaises(ProcessLookupError, msg="something went on"):
            for _ in range(10 * PATIENCE):
                os.killpg(process.pid, 0)
                time.sleep(0.1)


class ReproduceTest(CopyTest):
    def setUp(self):
        super().setUp()
        for program in TABLE_PROGRAMS:
            self.write(f"root/{program}", TABLE_PROGRAM, executable=True)
        self.stand_in("measure", MEASURED)
        self.stand_in("page", PAGED)
        self.prepare("table1", one_process())
        self.prepare("table2", one_process(tables=("table2", "table1")))
        write_limits(self.folder, limits_study())
        shutil.copy(write_scaling(self.folder), self.path("scaling.json"))
        write_tables(self.path("scaling-rough.json"), "rough", points=[point("elp4_frame", 257)])
        write_threads(self.path("threads.json"), [of_threads(), of_threads(2)])
        for name in ("accuracy", "theorem", "longruns", "turbulence", "fluid", "practice", "claims"):  # not rendered
            self.write(f"{name}.json", "{}")

    def prepare(self, program, raw):
        self.write(f"{program}.json", json.dumps(raw))

    def stand_in(self, name, body):
        """Puts a stand-in for a script, which finds the script itself beside it."""
        if not os.path.exists(self.path("root", "scripts", f"{name}.real")):
            os.rename(self.path("root", "scripts", name), self.path("root", "scripts", f"{name}.real"))
        self.write(f"root/scripts/{name}", body, executable=True)

    def draws(self, *names, body=DRAW):
        """Puts a stand-in for the rendering of these studies."""
        self.stand_in("render", RENDERED % (" ".join(names), body))

    def reproduce(self, *arguments, **changes):
        return self.script("reproduce", "--out", self.out, *arguments, **changes)

    def waiting(self, job):
        """Starts the script, quick, and returns it once something that it started waits."""
        line = self.line("reproduce", job, "--quick", "--out", self.out)
        process = start(line, env=self.surroundings(BENCHMARK="wait"),
                        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(end, process)
        self.await_start()
        return process

    def reproduced(self, *arguments):
        done = self.reproduce(*arguments)
        self.assertEqual(done.returncode, DONE, done.stderr)
        return done


class Arguments(CopyTest):
    def refuses(self, script, arguments, *parts, **changes):
        with self.subTest(script=script, arguments=arguments), self.unchanged():
            self.assert_refused(self.script(script, *arguments, **changes), script, *parts)

    def test_what_is_wrong_and_what_is_allowed_are_named(self):
        # Found before it is told that CMake is missing.
        for argument in ("table3", "--quik", "--quick=yes", ""):
            self.refuses("reproduce", ["--quick", argument], argument, "table1", "table2", "accuracy", "limits",
                         "longruns", "scaling",
                         "--quick", "--out", "--no-install", MISSING="cmake")
        path = self.write("plain", "a file")
        for arguments, *parts in ((["table1", "all"], "all"), (["--out"], "--out"), (["--out", ""], "--out"),
                                  (["--out", "--quick"], "--out"), (["--out", path], "--out", path),
                                  (["--out", os.path.join(path, "results")], "--out", path),
                                  (["--out", "/proc/results"], "--out", "/proc/results"),  # where nobody may write
                                  (["--history"], "--history"), (["limits", "--history", "x"], "--history", "table1"),
                                  (["all", "--history", "x"], "--history"), (["report", "--quick"], "--quick"),
                                  (["report", "--machine", "native"], "--machine")):
            self.refuses("reproduce", arguments, *parts)
        for argument in ("all", "--sanitise"):
            self.refuses("test", ["--sanitize", argument], argument, "--sanitize", "--no-install", MISSING="cmake")
        for script in ("reproduce", "test"):
            for arguments in (["--machine"], ["--machine", ""], ["--machine", "x86-64-v4"], ["--machine", "--quick"]):
                self.refuses(script, arguments, "--machine", *arguments[1:], "native", "x86-64-v3", "x86-64")
        for what in ("--sanitize", "--threads"):
            self.refuses("test", [what, "--rounding"], "--rounding", what)
        for arguments in (["--threads", "--machine", "x86-64"], ["--machine", "native", "--threads"]):
            self.refuses("test", arguments, "--machine", "--threads")

    def test_help_explains_the_options(self):
        for script, *options in (("reproduce", "table1", "--quick", "--out", "--no-install", "--keep-coretype",
                                  "--machine", "report ", "--history"),
                                 ("test", "--sanitize", "--machine", "x86-64-v3", "--no-install", "--keep-coretype")):
            with self.unchanged():
                done = self.script(script, "--help")
            self.assertEqual((done.returncode, done.stderr), (DONE, ""))
            for option in options:
                self.assertIn(option, done.stdout)


class MissingPackages(CopyTest):
    BASICS = ("bash", "sh", "dirname", "basename", "realpath", "mkdir", "grep")

    def install(self, **changes):
        """Runs up to a build that fails: by then everything is installed, or not."""
        return self.script("reproduce", **{"FAILING": "cmake", **changes})

    def test_no_install_names_what_is_missing_and_calls_no_other_tool(self):
        for script in ("reproduce", "test"):
            done = self.script(script, "--no-install", MISSING="libfmt-dev git", REMOVED="libgtest-dev")
            self.assert_refused(done, "--no-install", "git", "libfmt-dev", "libgtest-dev")
            self.assertNotIn("cmake", done.stderr)
        self.assertEqual(self.calls(), [])

    def test_just_what_is_missing_is_installed_and_said_and_the_run_goes_on(self):
        for user, through in (("0", 0), ("1000", 2)):  # root needs no sudo
            self.write("calls", "")
            self.assertIn("libfmt-dev", self.install(MISSING="libfmt-dev git", USER_ID=user).stderr)
            self.assertEqual((len(self.calls("cmake")), len(self.calls("sudo"))), (1, through))
            update, install = (call.split() for call in self.calls("apt-get[noninteractive]"))
            self.assertIn("update", update)
            self.assertEqual([word for word in install[1:] if not word.startswith("-")],
                             ["install", "git", "libfmt-dev"])
        self.write("calls", "")
        self.install()
        self.assertEqual((len(self.calls("cmake")), self.calls("apt-get")), (1, []))

    def test_a_machine_where_nothing_can_be_installed_is_told_what_is_missing(self):
        os.mkdir(self.path("few"))  # of programs
        for name in self.BASICS:
            os.symlink(shutil.which(name, path=self.surroundings()["PATH"]), self.path("few", name))
        for tool, part in (("id", "dpkg-query"), ("dpkg-query", "sudo")):
            os.symlink(self.path("tools", tool), self.path("few", tool))
            done = self.install(MISSING="libfmt-dev", USER_ID="1000", PATH=self.path("few"))
            self.assert_refused(done, part, "libfmt-dev")

    def test_what_this_release_does_not_have_is_named(self):
        done = self.install(MISSING="libfmt-dev git", ABSENT="libfmt-dev")
        self.assertEqual(done.returncode, BAD_ARGUMENTS)
        self.assertEqual(done.stderr.splitlines()[-1], "reproduce: no package of this release: libfmt-dev")
        self.assertEqual(len(self.calls("apt-get")), 1)  # which brings the lists up to date

    def test_a_failed_installation_ends_there(self):
        done = self.install(MISSING="libfmt-dev", FAILING="apt-get")
        self.assertEqual((done.returncode, done.stdout), (BAD_ARGUMENTS, ""))
        self.assertIn("apt-get", done.stderr.splitlines()[-1])
        self.assertEqual(self.calls("cmake"), [])


class EndToEnd(ReproduceTest):
    def test_an_inherited_kernel_choice_is_cleared_or_kept_and_said(self):
        for arguments, asked_for, said in (((), "none", "(?i)cleared.*OPENBLAS_CORETYPE=Nehalem"),
                                           (("--keep-coretype",), "Nehalem", "(?i)OPENBLAS_CORETYPE=Nehalem.*kept")):
            self.write("calls", "")
            done = self.reproduce(*arguments, FAILING="table1", OPENBLAS_CORETYPE="Nehalem")
            call = self.calls("table1")[0]
            self.assertTrue(call.startswith(f"table1[{asked_for}]"), call)
            self.assertRegex(done.stderr, said)
        self.assertNotIn("OPENBLAS_CORETYPE", self.reproduce(FAILING="table1").stderr)

    def test_another_machine_has_a_build_of_its_own_and_its_kernels_are_said(self):
        folder = "build-x86-64-v3"  # of each machine: TestScript
        self.write(f"root/{folder}/benchmarks/table1", TABLE_PROGRAM, executable=True)
        done = self.reproduce("--machine", "x86-64-v3", "--quick", FAILING="table1")
        self.assertRegex(done.stderr, f"Kernels: OpenBLAS Zen, split products avx2, in .*/{folder}/benchmarks/")
        self.assertIn(f"-B {self.path('root', folder)} ", self.calls("cmake")[0])
        self.assertTrue(self.calls("table1"))
        self.assertIn("cannot tell the kernels", self.reproduce("--quick", FAILING="kernel_sets").stderr)

    def test_results_replace_earlier_ones_and_other_files_stay(self):
        self.out = self.path("my results", "of today")
        for name in (*RESULTS, "notes"):
            self.write(os.path.join(self.out, name), f"earlier {name}")
        done = self.reproduced("--quick")
        results = {name: text.decode() for name, text in snapshot(self.out).items()}
        self.assertEqual(results.pop("notes"), "earlier notes")
        self.assertEqual(set(results), RESULTS)
        rows = json.loads(results["raw.json"])["benchmarks"]
        self.assertEqual({row["process"] for row in rows}, set(range(6)))
        self.assertEqual(len(rows), 6 * len(one_process()["benchmarks"]) // 2)  # of two of four n
        self.assertEqual(len(json.loads(results["verdicts.json"])["claims"]), 8)
        for name, text in results.items():
            self.assertNotIn(HOST_NAME, text, name)
        for name, start_of_it in (("txt", "Table 1"), ("md", "# Table 1"), ("tex", "% A fragment")):
            self.assertTrue(results[f"table.{name}"].startswith(start_of_it))
        self.assertEqual(done.stdout, results["table.txt"])
        self.assertIn(self.out, done.stderr.splitlines()[-1])
        self.assertEqual(os.listdir(self.path("tmp")), [])
        # On one screen: the table, then where it is.
        screen = run(self.line("reproduce", "--quick", "--out", self.out), env=self.surroundings(), cwd=self.folder,
                     stderr=subprocess.STDOUT).stdout
        self.assertTrue(screen.endswith(f"{results['table.txt'].splitlines()[-1]}\nResults are in {self.out}\n"
                                        f"The page to open: {self.out}/{PAGE}\n"))
        configure, build = self.calls("cmake")[:2]
        for part in (f"-S {self.path('root')}", "-DCMAKE_BUILD_TYPE=Release"):
            self.assertIn(part, configure)
        self.assertIn(f"--build {self.path('root', 'build')}", build)

    def test_without_out_results_are_under_results_latest(self):
        for arguments, name, results in ((("scaling",), "scaling", {*STUDY_RESULTS, "rough.json", "threads.json"}),
                                         (("--quick",), "table1-quick", RESULTS)):
            self.assertEqual(self.script("reproduce", *arguments).returncode, DONE)
            self.assertEqual(set(os.listdir(self.path("root", "results", "latest", name))), results)

    def test_all_makes_a_folder_for_each_job(self):
        raw = one_process(tables=("table2", "table1"))
        for row in raw["benchmarks"]:
            row.update(relative_error=1e-3, reference_uncertainty=1e-14)
        self.prepare("table2", raw)
        self.draws("accuracy", "limits", "longruns", "theorem", "claims", "turbulence", "fluid", "practice")
        told = self.reproduced("all", "--quick").stderr.splitlines()
        self.assertIn(f"Job 2 of {len(STUDIES)}: table2", told)
        self.assertEqual(told[-1], f"All results are in {self.out}")
        found = {job: set(os.listdir(self.path("out", job))) for job in os.listdir(self.out)}
        self.assertEqual(found, {"table1": RESULTS, "table2": RESULTS, "theorem": STUDY_RESULTS,
                                 "scaling": {*STUDY_RESULTS, "rough.json", "threads.json"}, "limits": STUDY_RESULTS,
                                 "accuracy": STUDY_RESULTS, "longruns": STUDY_RESULTS, "turbulence": STUDY_RESULTS,
                                 "fluid": STUDY_RESULTS, "practice": STUDY_RESULTS,
                                 "claims": {*STUDY_RESULTS, "avx2.json", "claims.json"}})
        self.assertTrue(all("--published" in call for call in self.calls("table2")))

    def test_a_study_measures_and_ends_with_its_report(self):
        done = self.reproduced("limits")
        found = snapshot(self.out)
        charts = {name for name in found if name.endswith((".svg", ".png"))}
        self.assertEqual(charts, {"limits.svg", "limits.png"})
        self.assertEqual(set(found) - charts, STUDY_RESULTS)
        self.assertEqual(done.stdout, found["report.md"].decode())
        self.assertIn("Up to which step methods work", done.stdout)
        self.assertEqual([call.endswith(f" on {CORES} cores") for call in self.calls("limits[")], [True])
        self.assertFalse(any("--quick" in call for call in self.calls()))

    def test_a_step_is_timed_in_the_rough_scene_and_by_several_threads_too(self):
        done = self.reproduced("scaling", "--quick")
        self.assertIn("A step against n, rough scene", done.stdout)
        self.assertIn("\n## Threads\n", done.stdout)
        (threads,) = self.calls("threads[")
        self.assertTrue(threads.endswith(f"--quick on {CORES} cores"), threads)
        smooth, rough = self.calls("scaling[")
        self.assertNotIn("--scene", smooth)
        for option in ("--scene rough", "--start 5", "--n 33", "--integrator algebra1_frame", "--quick"):
            self.assertIn(option, rough)
        self.reproduced("scaling")
        self.assertIn("--n 257 513", self.calls("scaling[")[-1])

    def test_claims_are_measured_with_avx2_kernels_too_where_there_are_others(self):
        self.draws("claims")
        done = self.reproduced("claims")
        self.assertEqual(set(os.listdir(self.out)), {*STUDY_RESULTS, "avx2.json", "claims.json"})
        self.assertEqual(done.stdout, text_of(self.out, "report.md"))
        self.assertTrue(all(call.startswith("table2[Haswell]") for call in self.calls("table2")))
        self.assertGreaterEqual(len(self.calls("table2")), 4 * 6)
        configured = next(call for call in self.calls("cmake") if f"-B {self.path('root', 'build-avx2')}" in call)
        for option in ("-DISOSYRK_NATIVE=OFF", "-march=x86-64-v3", "-DISOSYRK_KERNELS=avx2"):
            self.assertIn(option, configured)
        self.assertTrue(self.calls("claims[none]"))  # on the kernels of this processor
        self.write("calls", "")
        self.out = self.path("without")
        done = self.reproduce("claims", UNITS="")
        self.assertEqual((done.returncode, self.calls("table2")), (DONE, []))
        self.assertIn("no AVX-512", done.stderr)
        self.assertEqual(set(os.listdir(self.out)), {*STUDY_RESULTS, "claims.json"})

    def test_only_claims_need_octave(self):
        for job, status in (("claims", BAD_ARGUMENTS), ("all", BAD_ARGUMENTS), ("theorem", DONE)):
            self.draws("theorem")
            done = self.reproduce(job, "--no-install", MISSING="octave")
            self.assertEqual((done.returncode, "octave" in done.stderr), (status, status != DONE), done.stderr)

    def test_every_size_is_measured_in_enough_processes_on_one_core(self):
        self.reproduced()
        filters = [re.search(r"--benchmark_filter=/n:(\d+)/", call)[1] for call in self.calls("table1")]
        self.assertEqual(set(filters), {"17", "33", "65", "129"})
        self.assertGreaterEqual(min(map(filters.count, filters)), 6)
        self.assertTrue(all(call.endswith(" on 1 cores") for call in self.calls("table1")))


class PageToOpen(ReproduceTest):
    """Whatever becomes of the page, results are there; and none of an earlier run stands beside them."""

    def setUp(self):
        super().setUp()
        self.draws("limits")

    def test_it_is_made_of_this_run_and_named_last(self):
        done = self.reproduced("limits")
        self.assertEqual(done.stderr.splitlines()[-1], f"The page to open: {self.out}/{PAGE}")
        self.assertEqual(self.calls("page["),
                         [f"page[] --out {self.out} --study limits --results {self.out} --optional"])

    def test_a_record_has_none_of_its_own(self):
        self.out = self.path("root", "results", "recorded", "limits")
        done = self.reproduced("limits")
        self.assertEqual(set(os.listdir(self.out)), STUDY_RESULTS - {PAGE})
        self.assertEqual((self.calls("page["), done.stderr.splitlines()[-1]), ([], f"Results are in {self.out}"))

    def test_without_one_the_run_succeeds_and_says_so(self):
        self.write(f"out/{PAGE}", "of an earlier run")
        done = self.reproduce("limits", PAGE="none")
        self.assertEqual((done.returncode, set(os.listdir(self.out))), (DONE, STUDY_RESULTS - {PAGE}), done.stderr)
        self.assertEqual(done.stderr.splitlines()[-1], "page: no report.html: no Python with plotly found")

    def test_one_that_fails_costs_no_result(self):
        done = self.reproduce("limits", PAGE="fail")
        self.assertEqual((done.returncode, set(os.listdir(self.out))), (BAD_ARGUMENTS, STUDY_RESULTS - {PAGE}))
        self.assertIn("is wrong", done.stderr.splitlines()[-1])
        done = self.reproduce("limits", PAGE="fail", BENCHMARK_STATUS="3")
        self.assertEqual(done.returncode, SOLVER_FAILED)

    def test_an_interruption_while_it_is_made_leaves_the_results(self):
        process = start(self.line("reproduce", "limits", "--out", self.out), env=self.surroundings(PAGE="wait"),
                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(end, process)
        self.await_start()
        process.terminate()
        self.assertEqual(process.wait(timeout=PATIENCE), 128 + signal.SIGTERM)
        self.assert_all_end(process)
        self.assertEqual(set(os.listdir(self.out)), STUDY_RESULTS - {PAGE})

    def test_of_all_recorded_runs_nothing_is_built_or_measured(self):
        done = self.reproduced("report")
        self.assertEqual((os.listdir(self.out), done.stdout), ([PAGE], ""))
        self.assertEqual(done.stderr, f"The page to open: {self.out}/{PAGE}\n")
        self.assertEqual(self.calls(), [f"page[] --out {self.out}"])
        self.assertEqual(self.script("reproduce", "report").returncode, DONE)
        self.assertEqual(os.listdir(self.path("root", "results", "latest", "report")), [PAGE])
        done = self.reproduce("report", PAGE="fail")  # the page before it is not named
        self.assertEqual((done.returncode, "The page to open" in done.stderr), (BAD_ARGUMENTS, False))

    def test_what_it_needs_is_installed_where_that_can_be(self):
        done = self.reproduce("limits", MISSING="python3-plotly")
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertIn("python3-plotly", self.calls("apt-get")[-1])
        for changes in ({"ABSENT": "python3-plotly"}, {"FAILING": "apt-get"}):
            self.assertEqual(self.reproduce("limits", MISSING="python3-plotly", **changes).returncode, DONE)
        self.write("calls", "")
        self.assertEqual(self.reproduce("limits", "--no-install", MISSING="python3-plotly").returncode, DONE)
        self.assertEqual(self.calls("apt-get"), [])
        done = self.reproduce("report", "--no-install", MISSING="python3-plotly")
        self.assertEqual((done.returncode, "python3-plotly" in done.stderr), (BAD_ARGUMENTS, True))


class History(ReproduceTest):
    def test_each_run_of_table_1_appends_a_line(self):
        path = self.path("history.jsonl")
        for runs in (1, 2):
            done = self.reproduced("--quick", "--history", path)
            lines = [json.loads(line) for line in text_of(path).splitlines()]
            self.assertEqual(len(lines), runs)
        self.assertEqual((lines[1]["program"], len(lines[1]["ratios"])), ("table1", 18))  # of two n
        self.assertEqual({*lines[1]["ratios"][0]}, {"what", "ratio", "low", "high"})
        self.assertEqual(done.stderr.splitlines()[-1], f"The page to open: {self.out}/{PAGE}")
        self.assertIn(f"--history {path}", self.calls("page[")[-1])
        self.reproduced("report", "--history", path)
        self.assertEqual(self.calls("page[")[-1], f"page[] --out {self.out} --history {path}")

    def test_one_that_cannot_be_used_is_refused_before_the_run(self):
        damaged = self.write("damaged", '{"format": "isosyrk hist')
        for path, *told in ((damaged, "line 1"), (self.path("none", "history"), "cannot be written"), (self.folder,)):
            with self.subTest(path=path):
                done = self.reproduce("--quick", "--history", path)
                self.assert_refused(done, path, *told)
        self.assertEqual((self.calls(), os.path.exists(self.out)), ([], False))
        self.assertEqual(text_of(damaged), '{"format": "isosyrk hist')

    def test_a_run_that_fails_appends_nothing(self):
        path = self.path("history.jsonl")
        self.assertEqual(self.reproduce("--quick", "--history", path, FAILING="table1").returncode, 7)
        self.assertFalse(os.path.exists(path))


class FailedRuns(ReproduceTest):
    """Whatever goes wrong, earlier results stay as they were and nothing stray is left."""

    def setUp(self):
        super().setUp()
        for name in RESULTS:
            self.write(f"out/{name}", f"earlier {name}")
        self.before = snapshot(self.out)

    def assert_earlier_results(self):
        found = snapshot(self.out)
        self.assertEqual({name: found[name] for name in found if not name.startswith(".kept")}, self.before)
        self.assertEqual(os.listdir(self.path("tmp")), [])

    def ends(self, job, status, *told, **changes):
        with self.subTest(job=job, changes=changes):
            done = self.reproduce(job, **changes)
            self.assertEqual((done.returncode, done.stdout), (status, ""))
            for part in told:
                self.assertIn(part, done.stderr)
            self.assertNotIn("Traceback", done.stderr)
            self.assert_earlier_results()

    def test_a_failed_build_shows_its_log(self):
        self.ends("table1", BAD_ARGUMENTS, "chatter of cmake", "reproduce: the build in", FAILING="cmake")

    def test_a_failed_or_killed_program_passes_its_status_on(self):
        self.ends("table1", 7, "some reason", "exit status 7", FAILING="table1")
        self.ends("table1", 128 + signal.SIGKILL, "exit status 137", BENCHMARK="die")
        self.ends("limits", 7, "some reason", FAILING="limits")

    def test_a_raw_file_that_cannot_be_used_is_told(self):
        for job in ("table1", "limits"):
            self.ends(job, BAD_ARGUMENTS, "is not whole JSON", BENCHMARK="scribble")
        self.prepare("table1", {"context": {}, "benchmarks": []})
        self.ends("table1", BAD_ARGUMENTS, "table1 wrote is no raw file of table1")

    def test_what_a_study_has_finished_at_this_commit_is_not_done_again(self):
        for commit, runs in (("0123456789ab", 1), ("ba9876543210", 2)):  # the files are of the first
            self.write("tools/git", f"#!/bin/sh\necho {commit}\n", executable=True)
            self.write("calls", "")
            for body in ("exit 1", DRAW):
                self.draws("limits", body=body)
                self.reproduce("limits")
            self.assertEqual(len(self.calls("limits[")), runs)

    def test_rows_that_did_not_converge_are_shown_and_end_with_3(self):
        self.prepare("table1", one_process(failed=True))
        done = self.reproduce("--quick", BENCHMARK_STATUS="3")
        self.assertEqual(done.returncode, SOLVER_FAILED)
        self.assertIn("sweep cap at step 1", done.stdout)
        self.assertEqual(set(os.listdir(self.out)), RESULTS)

    def interrupted(self, send, number):
        """Starts, sends a signal by `send(process, number)` while the program runs, and returns the ended process."""
        process = self.waiting("table1")
        send(process, number)
        _, errors = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 128 + number)
        last = errors.splitlines()[-1]
        self.assertRegex(last, "^reproduce: (interrupted|terminated); .*the same command goes on: ")
        self.assertIn(f"reproduce table1 --quick --out {self.out}", last)
        self.assert_earlier_results()
        return process

    def test_ctrl_c_leaves_earlier_results(self):
        self.interrupted(lambda process, number: os.killpg(process.pid, number), signal.SIGINT)

    def test_a_termination_of_the_script_alone_ends_the_benchmark_with_it(self):
        self.assert_all_end(self.interrupted(subprocess.Popen.send_signal, signal.SIGTERM))


class KilledRuns(ReproduceTest):
    """kill -9 of the script alone, which can do nothing any more."""

    def test_what_it_started_ends_and_the_same_command_goes_on(self):
        for job, expected in (("table1", RESULTS), ("limits", STUDY_RESULTS)):
            with self.subTest(job=job):
                self.out = self.path("out", job)
                self.write("calls", "")
                process = self.waiting(job)
                process.kill()
                process.wait()
                self.assert_all_end(process)
                left = [name for name in os.listdir(self.out) if name.startswith(".unfinished")]
                self.assertEqual(len(left), 1)
                done = self.reproduced(job, "--quick")
                self.assertNotIn("unbound variable", done.stderr)
                found = set(os.listdir(self.out))
                self.assertEqual({name for name in found if not name.endswith((".svg", ".png"))}, expected)

    def test_what_was_finished_but_not_drawn(self):
        # Killed between the last study and the end: no study is left that could set a status.
        self.write("tools/git", "#!/bin/sh\necho 0123456789ab\n", executable=True)
        for body in ("exit 1", DRAW):
            self.draws("limits", body=body)
            done = self.reproduce("limits")
        self.assertEqual((done.returncode, done.stdout), (DONE, "drawn\n"), done.stderr)
        self.assertEqual(len(self.calls("limits[")), 1)

    def test_a_build_ends_too(self):
        self.write("tools/cmake", """#!/bin/sh
while :; do
  echo "[ 12%] Building CXX object part.o"
  grep -q started "$CALLS" || echo started >>"$CALLS"
  sleep 0.1
done
""", executable=True)
        process = self.waiting("table1")
        process.kill()
        process.wait()
        self.assert_all_end(process)


class OneAtATime(ReproduceTest):
    def test_a_second_run_into_the_same_folder_is_refused(self):
        process = self.waiting("table1")
        for job in ("table1", "limits"):
            with self.subTest(job=job), self.unchanged():
                self.assert_refused(self.reproduce(job), "--out", self.out, "another run")
        other = self.script("reproduce", "--quick", "--out", self.path("elsewhere"))  # beside it another may run
        self.assertEqual(other.returncode, DONE, other.stderr)
        end(process)  # with all that it started: kill -9
        self.assert_all_end(process)  # and with it the lock that they hold
        self.reproduced("--quick")

    def test_a_second_build_in_the_same_folder_waits(self):
        os.makedirs(self.path("root", "build"), exist_ok=True)
        with subprocess.Popen(["flock", self.path("root", "build"), "sh", "-c", "echo locked; exec sleep 600"],
                              stdout=subprocess.PIPE, start_new_session=True) as holder:
            self.assertEqual(holder.stdout.readline(), b"locked\n")
            process = start(self.line("reproduce", "--quick", "--out", self.out), env=self.surroundings(),
                            stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
            self.addCleanup(end, process)
            self.assertIn("Building", process.stderr.readline())
            self.assertIn("waiting for its end", process.stderr.readline())
            self.assertEqual(self.calls("cmake"), [])
            os.killpg(holder.pid, signal.SIGKILL)
        _, errors = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, DONE, errors)


class Build(ReproduceTest):
    """How far a build is, is seen."""

    def setUp(self):
        super().setUp()
        self.write("tools/cmake", """#!/bin/sh
echo "-- NumPy module: built"
for percent in 7 50 100; do echo "[$(printf %3d $percent)%] Building CXX object $percent.o"; done
echo "[3/12] Building CXX object of Ninja"
""", executable=True)

    def test_on_a_terminal_by_one_line(self):
        terminal, stderr = open_terminal(self)
        process = start(self.line("reproduce", "--out", self.out), env=self.surroundings(FAILING="table1"),
                        stdout=subprocess.DEVNULL, stderr=stderr)
        self.addCleanup(end, process)
        os.close(stderr)
        shown = b""
        with contextlib.suppress(OSError):  # the other end is closed
            while read := os.read(terminal, 4096):
                shown += read
        os.close(terminal)
        self.assertIn("\r\x1b[K[ 50%] Building CXX object 50.o\r\x1b[K[100%] Building", shown.decode())
        self.assertIn("Ninja\r\x1b[K", shown.decode())

    def test_elsewhere_now_and_then(self):
        setup = self.path("root", "scripts", "lib", "setup.sh")
        text = text_of(setup)
        for seconds in (1000, 0):  # in place of 20, which the build may take on a busy machine
            self.write(setup, text.replace("SECONDS + 20", f"SECONDS + {seconds}"))
            done = self.reproduce(FAILING="table1")
            self.assertEqual("% built" in done.stderr, not seconds)
        self.assertIn("\n  7 % built\n  50 % built\n  100 % built\n  25 % built\n", done.stderr)
        self.assertIn("NumPy module: built", done.stderr)

    def test_all_that_it_said_is_kept(self):
        self.write("tools/cmake", "#!/bin/sh\nseq 1000\nexit 1\n", executable=True)
        done = self.reproduce()
        self.assertEqual(done.returncode, BAD_ARGUMENTS)
        log = self.path("root", "build", "build.log")
        self.assertEqual(text_of(log).split(), [str(number) for number in range(1, 1001)])
        failed = f"reproduce: the build in {self.path('root', 'build')} failed; all that it said is in {log}"
        self.assertEqual(done.stderr.splitlines()[-2:], ["1000", failed])


class SymbolicLinks(CopyTest):
    def test_every_script_finds_its_modules_through_one(self):
        os.mkdir(self.path("bin"))
        folder = self.path("root", "scripts")
        scripts = [name for name in sorted(os.listdir(folder)) if os.access(os.path.join(folder, name), os.X_OK)
                   and os.path.isfile(os.path.join(folder, name))]
        self.assertGreater(len(scripts), 8)
        for name in scripts:
            with self.subTest(script=name):
                os.symlink(os.path.join(folder, name), self.path("bin", name))
                done = run([self.path("bin", name), "--help"], env=self.surroundings(), cwd=self.folder)
                self.assertEqual(done.returncode, DONE, done.stderr)
                self.assertNotIn("Traceback", done.stderr)


class TestScript(CopyTest):
    def test_the_suite_runs_in_the_ordinary_build_or_a_sanitized_one_beside_it_and_its_status_is_passed_on(self):
        for arguments, folder, failing, status in (((), "build", "none", DONE), ((), "build", "ctest", 1),
                                                   (("--sanitize",), "build-sanitize", "none", DONE)):
            self.write("calls", "")
            self.assertEqual(self.script("test", *arguments, FAILING=failing).returncode, status)
            self.assertIn(f"-B {self.path('root', folder)} ", self.calls("cmake")[0])
            self.assertEqual("-DISOSYRK_SANITIZE=ON" in self.calls("cmake")[0], bool(arguments))
            self.assertIn(f"--test-dir {self.path('root', folder)} ", self.calls("ctest")[0])

    def test_warnings_are_errors_if_asked(self):
        for arguments, werror in (((), "OFF"), (("--werror",), "ON"), (("--threads", "--werror"), "ON")):
            with self.subTest(arguments=arguments):
                self.write("calls", "")
                done = self.script("test", *arguments)
                self.assertEqual(done.returncode, DONE, done.stderr)
                self.assertIn(f"-DISOSYRK_WERROR={werror}", self.calls("cmake")[0])

    def test_rounding_is_varied_by_the_machine_built_for_and_by_a_kept_choice_of_kernels(self):
        for machine, folder, options in (
                ("native", "build", ()),
                ("x86-64-v3", "build-x86-64-v3", ("-DISOSYRK_NATIVE=OFF", "-DISOSYRK_KERNELS=avx2",
                                                  "-DCMAKE_CXX_FLAGS=-march=x86-64-v3 -ffp-contract=off")),
                ("x86-64", "build-x86-64", ("-DISOSYRK_NATIVE=OFF", "-DISOSYRK_KERNELS=portable")),
                ("x86-64-v3 --sanitize", "build-x86-64-v3-sanitize", ("-DISOSYRK_KERNELS=avx2",
                                                                      "-DISOSYRK_SANITIZE=ON"))):
            kept, kernels, said = (("--keep-coretype",), "Nehalem", "kept") if machine == "x86-64" else (
                (), "Zen", "cleared")
            self.write("calls", "")
            done = self.script("test", "--machine", *machine.split(), *kept, OPENBLAS_CORETYPE="Nehalem")
            self.assertEqual(done.returncode, DONE, done.stderr)
            self.assertRegex(done.stderr, f"Kernels: OpenBLAS {kernels}, .* in .*/{folder}/benchmarks/")
            self.assertIn(said, done.stderr)
            self.assertIn(f"-B {self.path('root', folder)} ", self.calls("cmake")[0])
            self.assertIn(f"--test-dir {self.path('root', folder)} ", self.calls("ctest")[0])
            for option in options:
                self.assertIn(option, self.calls("cmake")[0])
            self.assertEqual("-DISOSYRK_KERNELS" in self.calls("cmake")[0], machine != "native")

    def test_what_rounding_may_change_is_run_by_itself(self):
        self.assertEqual(self.script("test", "--rounding", "--machine", "x86-64-v3").returncode, DONE)
        (_, built), (tested,) = self.calls("cmake"), self.calls("ctest")
        self.assertIn(f"--build {self.path('root', 'build-x86-64-v3')} --target rounding ", built)
        self.assertRegex(tested, "--label-regex [a-z_|]*rounding")

    def test_a_browser_is_installed_where_there_is_one_and_is_not_needed(self):
        for arguments, changes, installed in (((), {}, True), ((), {"ABSENT": "chromium"}, False),
                                              (("--no-install",), {}, False), (("--sanitize",), {}, False)):
            with self.subTest(arguments=arguments, changes=changes):
                self.write("calls", "")
                self.assertEqual(self.script("test", *arguments, MISSING="chromium", **changes).returncode, DONE)
                self.assertEqual(any("install" in call and "chromium" in call for call in self.calls("apt-get")),
                                 installed)

    def test_kernels_that_cannot_be_told_end_it_before_the_tests(self):
        done = self.script("test", FAILING="kernel_sets")
        self.assertEqual(done.returncode, BAD_ARGUMENTS)
        self.assertIn("cannot tell the kernels", done.stderr.splitlines()[-1])
        self.assertEqual(self.calls("ctest"), [])

    def test_what_failed_is_said_once_more_at_the_end(self):
        self.write("root/build/Testing/Temporary/LastTest.log", """12/13 Testing: scripts.test_some
FAIL: test_a_thing (test_some.Some)
Traceback (most recent call last):
  File "test_some.py", line 7, in test_a_thing
AssertionError: 1 != 2
[  FAILED  ] Some.Other (2 ms)
[       OK ] Some.Third (2 ms)
""")
        told = self.script("test", FAILING="ctest").stderr.splitlines()
        self.assertEqual(told[-3:], ["FAIL: test_a_thing (test_some.Some)", "AssertionError: 1 != 2",
                                     "[  FAILED  ] Some.Other (2 ms)"])
        self.assertNotIn("FAIL", self.script("test").stderr)

    def test_a_termination_ends_the_suite_with_it(self):
        self.write("tools/ctest", '#!/bin/sh\necho started >>"$CALLS"\nexec sleep 600\n', executable=True)
        process = start(self.line("test"), env=self.surroundings(), stdout=subprocess.DEVNULL,
                        stderr=subprocess.DEVNULL)
        self.addCleanup(end, process)
        self.await_start()
        process.terminate()
        self.assertEqual(process.wait(timeout=PATIENCE), -signal.SIGTERM)
        self.assert_all_end(process)

    def test_a_failed_build_runs_no_tests(self):
        done = self.script("test", FAILING="cmake")
        self.assertEqual(done.returncode, BAD_ARGUMENTS)
        self.assertIn("chatter of cmake", done.stderr)
        self.assertEqual(self.calls("ctest"), [])
