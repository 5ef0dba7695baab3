"""Tests of the study of what threads gain, and of its section in the report of `scaling`."""

import os
import signal
import sys
import time
import unittest
from unittest import mock

import drawing
from programs import (BUILD, DONE, HAS_MODULE, MEASURE, PATIENCE, RENDER, SANITIZED, FolderTest, end, environment,
                      start, text_of)
from programs import run as run_command
from scaling_documents import point, write_tables
from threads_documents import run, write_threads

from lib.pages.figures import read_figures
from lib.records.formats import listed
from studies.scaling.schema import TwoThreads
from studies.threads.schema import read_threads

RENDERING = RENDER, "scaling"
CORES = sorted(os.sched_getaffinity(0))
NO_ANSWER, INTERRUPTED = 3, 130

# In place of the program: tells in LOG what it is asked for, and prints steps that p threads take 1/p of. It waits with
# the method WAIT, and with FAIL it fails, or prints something else.
STAND_IN = f"""#!{sys.executable} -B
import json, os, sys, time
options = [(sys.argv[k], sys.argv[k + 1]) for k in range(1, len(sys.argv), 2)]
named, threads = dict(options), [int(value) for name, value in options if name == "--threads"]
with open(os.environ["LOG"], "a") as log:
    log.write(f"{{os.getpid()}} {{named['--integrator']}} {{named['--n']}} {{' '.join(map(str, threads))}}\\n")
if named["--integrator"] == os.environ.get("WAIT"):
    time.sleep(600)
if "FAIL" in os.environ:
    sys.exit("threads: step 1 failed") if os.environ["FAIL"] == "1" else print("{{}}")
else:
    print(json.dumps({{"rows": [{{"threads": p, "seconds": [3 / p, 2 / p], "looking": [0.5, 0.25], "operations": 80.5,
                                  "serial": -1e-9, "waiting": 0.125, "same": p < 2}} for p in threads]}}))
"""


class Report(drawing.DrawingTest):
    package = "scaling"

    def report(self, runs, cores=2, two_threads=()):
        """Returns the lines of the report with these runs, as lists of cells."""
        smooth = write_tables(self.path("raw.json"), points=[point()], threads=list(two_threads))
        write_threads(self.path("threads.json"), runs, cores)
        files = self.rendered("out", smooth)
        self.text = files["report.md"].decode("utf-8")
        self.figures = read_figures(self.path("out", "figures.json"))
        return [[cell.strip() for cell in each.strip("|").split("|")] for each in self.text.splitlines()]

    def test_other_bits_in_one_process_are_seen(self):
        lines = self.report([run(), run(2, same=[True] * 5 + [False])])
        self.assertIn("Answers are NOT the same bit for bit: elp4\\_frame at n = 257 by 2 threads.", self.text)
        self.assertEqual([cells[-2] for cells in lines if cells[0] == "257"], ["same", "**NOT the same**"])
        self.assertEqual(self.figures["threads.different"], 1)

    def test_one_core(self):
        self.report([], cores=1)
        self.assertIn("one core only", self.text)

    def test_two_threads_of_an_older_file_are_shown_where_there_is_nothing_newer(self):
        rows = [TwoThreads(50.0, 129, "group2_frame", 0.1, 1e-13, [2e-3] * 6, [1e-3] * 6)]
        self.report([run(), run(2)], two_threads=rows)
        self.assertNotIn("## Two threads", self.text)
        self.assertIn("## Threads", self.text)
        # Pages that quote the older file are right still.
        self.assertEqual(self.figures["threads.group2_frame.n129.t50"], 2)
        os.remove(self.path("threads.json"))
        older = self.rendered("older", write_tables(self.path("raw.json"), points=[point()], threads=rows))
        self.assertIn(b"## Two threads", older["report.md"])
        self.assertNotIn(b"## Threads", older["report.md"])


@unittest.skipUnless(HAS_MODULE and not SANITIZED, "without the module, or with a sanitizer's libraries")
class Study(FolderTest):
    def setUp(self):
        super().setUp()
        sys.path.insert(0, os.path.join(BUILD, "python"))
        from studies.threads import run as threads
        self.threads = threads
        os.makedirs(self.path("build"))
        os.symlink(os.path.join(os.path.abspath(BUILD), "python"), self.path("build", "python"))
        self.write("build/benchmarks/threads", STAND_IN, executable=True)
        self.out, self.log = self.path("threads.json"), self.write("log", "")

    def command(self, *arguments):
        return [sys.executable, "-B", MEASURE, "threads", "--out", self.out, *arguments]

    def study(self, *arguments, prepare=None, build=None, **changes):
        return run_command(self.command(*arguments), prepare=prepare,
                           env=environment(ISOSYRK_BUILD=build or self.path("build"), LOG=self.log, **changes))

    def told(self):
        return [line.split() for line in text_of(self.log).splitlines()]

    @unittest.skipIf(len(CORES) < 2, "there is one core only")
    def test_what_a_process_printed_is_kept_and_the_order_changes(self):
        done = self.study("--n", "9", "--integrator", "rk8_frame")
        self.assertEqual(done.returncode, DONE, done.stderr)
        one, two, *_ = read_threads(self.out).runs.values()
        self.assertEqual((one.seconds, two.seconds), ((2.0,) * 6, (1.0,) * 6))  # decided by six
        self.assertEqual((two.looking[0], two.operations[0], two.serial[0], two.waiting[0]), (0.25, 80.5, 0.0, 0.125))
        self.assertEqual((one.same[0], two.same[0]), (True, False))
        orders = [each[3:] for each in self.told()]
        self.assertEqual({*map(tuple, orders)}, {tuple(orders[0]), tuple(orders[0][::-1])})
        self.assertFalse(os.path.exists(f"{self.out}.checkpoint"))

    @unittest.skipIf(len(CORES) < 2, "there is one core only")
    def test_an_interrupted_study_goes_on_and_leaves_no_process(self):
        arguments = ("--n", "9", "--processes", "1", "--integrator", "rk8_frame", "elp4_frame", "group2")
        process = start(self.command(*arguments), stderr=-1, env=environment(
            ISOSYRK_BUILD=self.path("build"), LOG=self.log, WAIT="group2"))
        self.addCleanup(end, process)
        deadline = time.monotonic() + PATIENCE
        while "group2" not in text_of(self.log):
            self.assertTrue(process.poll() is None and time.monotonic() < deadline)
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, INTERRUPTED, errors)
        self.assertIn("the same command goes on", errors)
        with self.assertRaises(ProcessLookupError):
            os.kill(int(self.told()[-1][0]), 0)
        self.write("log", "")
        self.assertEqual(self.study(*arguments).returncode, DONE)
        self.assertEqual({name for _, name, *_ in self.told()}, {"group2"})
        self.assertEqual({name for _, name, _ in read_threads(self.out).runs}, {"rk8_frame", "elp4_frame", "group2"})

    def test_one_core_times_nothing_and_tells(self):
        done = self.study("--quick", prepare=lambda: os.sched_setaffinity(0, {CORES[-1]}))
        self.assertEqual((done.returncode, done.stdout), (DONE, ""), done.stderr)
        self.assertIn("threads are not timed: there is one core only\n", done.stderr)
        self.assertEqual((self.told(), read_threads(self.out).runs), ([], {}))

    @unittest.skipIf(len(CORES) < 2, "there is one core only")
    def test_a_program_that_fails(self):
        for what, part in (("1", "threads: step 1 failed"), ("2", "without its times")):
            done = self.study("--quick", FAIL=what)
            self.assertEqual(done.returncode, NO_ANSWER)
            self.assertIn(part, done.stderr.splitlines()[-1])
            self.assertFalse(os.path.exists(self.out))

    def test_a_program_that_is_not_built(self):
        os.unlink(self.path("build", "benchmarks", "threads"))
        self.assert_refused(self.study("--quick"), "threads: ", "benchmarks/threads: is not built")

    def test_the_plan(self):
        blocks = self.threads.blocks_of([listed("elp4_frame"), listed("group2")], self.threads.SIZES, (1, 2))
        found = {(block["n"], block["integrator"]): (block["step"], block["tolerance"], block["warmup"], block["steps"])
                 for block in blocks}
        self.assertEqual(found[129, "elp4_frame"], (0.25, 1e-8, 8, 8))
        self.assertEqual(found[513, "group2"], (0.05, 1e-13, 1, 2))
        self.assertEqual(found[1025, "elp4_frame"], (0.0625, 1e-8, 0, 1))
        self.assertEqual([self.threads.numbers_of(cores) for cores in (2, 6, 16, 64)],
                         [[1, 2], [1, 2, 4], [1, 2, 4, 8, 16], [1, 2, 4, 8, 16]])

    def test_a_new_method_is_timed_where_it_has_a_fast_form(self):
        new = [listed("rk4")._replace(name=name, family="other", has_fast_form=fast)
               for name, fast in (("novel", True), ("plain", False))]
        listing = {each.name: each for each in (*map(listed, (*self.threads.METHODS, "rk4")), *new)}
        with mock.patch.object(self.threads.built, "integrators", lambda: listing):
            names = [each.name for each in self.threads.entries_asked_for(None)]
        self.assertEqual({*names}, {*self.threads.METHODS, "novel"})


if __name__ == "__main__":
    unittest.main()
