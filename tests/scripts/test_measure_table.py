"""Tests of scripts/measure tables with a stand-in for the benchmark program, and of what counts as disturbed."""

import json
import os
import signal
import subprocess
import sys
import time
import unittest
from unittest import mock

from programs import (BAD_ARGUMENTS, DONE, MEASURE, ROOT, SOLVER_FAILED, FolderTest, end, environment, run, start,
                      text_of)

from lib.running import fresh_process
from lib.programs.command_line import Stop
from lib.records.table_file import read_run
from lib.running.fresh_process import MAX_SWITCHES, Disturbance, run_on
from studies.tables.processes import Plan, measure, quickest
from lib.judging.verdicts import FEWEST, MAXIMUM

QUIET, BUSY = Disturbance(0.0, 1.0), Disturbance(0.0, 100.0)

# Writes down how it was called, and rows as $PLAN says: milliseconds of each formulation at each n, one for each
# process in turn; a text makes a failed row.
PROGRAM = """#!%s
import json, os, re, sys, time
with open(os.environ["CALLS"], "a") as calls:
    calls.write(" ".join(sys.argv[1:]) + "\\n")
options = dict(argument.partition("=")[::2] for argument in sys.argv[1:])
with open(os.environ["CALLS"]) as calls:
    earlier = [line for line in calls if options["--benchmark_filter"] in line]
with open(os.environ["PLAN"]) as file:
    plan = json.load(file)
n = re.findall("[0-9]+", options["--benchmark_filter"])[0]
if plan.get("wait") == len(earlier) - 1:
    time.sleep(60)
if plan.get("die") == len(earlier) - 1:
    print("***WARNING*** Library was built as DEBUG. Timings may be affected.")
    print("some reason")
    sys.exit(7)
rows, status = [], 0
for form in ("cotangent", "group", "algebra"):
    found = plan["times"][n][form]
    for repetition in range(int(options["--benchmark_repetitions"])):
        row = {"run_name": "table1/%%s/n:%%s/s:1/repeats:3" %% (form, n), "run_type": "iteration", "family_index": 1,
               "repetition_index": repetition, "time_unit": "ms", "spectrum_error": 1e-14, "skew_defect": 0.0,
               "sweeps_per_step": 10.0}
        if isinstance(found, str):
            status = 3
            row.update(error_occurred=True, error_message=found, cpu_time=0.0)
        else:
            row["cpu_time"] = found[(len(earlier) - 1) %% len(found)]
            if "--no-warm-run" not in sys.argv:
                row["energy_error"] = 1e-5
        rows.append(row)
context = {"isosyrk_program": "table1", "isosyrk_format": "1", "host_name": "a-private-host", "commit": "0123456789ab",
           "products": "the faster by measurement: n=17 eigen, n=33 eigen, n=129 openblas"}
with open(options["--benchmark_out"], "w") as file:
    json.dump({"context": context, "benchmarks": rows}, file)
sys.exit(status)
""" % sys.executable

DECIDED = {"cotangent": [4.0], "group": [3.0], "algebra": [2.0]}
UNCERTAIN = {**DECIDED, "group": [2.0, 2.2]}  # against algebra: 1 to 1.1


class MeasureTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.program = self.write("build/benchmarks/table1", PROGRAM, executable=True)
        self.calls_path = self.write("calls", "")
        os.mkdir(self.path("kept"))
        quiet = mock.patch.object(Disturbance, "__bool__", lambda disturbance: disturbance is BUSY)
        quiet.start()  # whatever this machine does
        self.addCleanup(quiet.stop)

    def plan(self, *sizes, **plan):
        self.write("plan.json", json.dumps(plan))
        return Plan(self.program, ("table1",), sizes, ("--references", "here"), 0.05, self.path("kept"))

    def measured(self, *sizes, **plan):
        """Returns the document, the exit status, and the rows."""
        with mock.patch.dict(os.environ, CALLS=self.calls_path, PLAN=self.path("plan.json")), \
                mock.patch("studies.tables.processes.say") as said:
            try:
                document, status = measure(self.plan(*sizes, **plan))
            finally:
                self.told = [call.args[0] for call in said.call_args_list if not call.args[0].startswith(("[", "n = "))]
        return document, status, document["benchmarks"]

    def calls(self, n):
        with open(self.calls_path, encoding="utf-8") as calls:
            return [line for line in calls if f"/n:{n}/" in line]


class Processes(MeasureTest):
    def test_a_decided_n_takes_six_processes_and_an_undecided_one_twelve(self):
        document, status, rows = self.measured(17, 33, times={"17": DECIDED, "33": UNCERTAIN})
        self.assertEqual((status, len(self.calls(17)), len(self.calls(33))), (DONE, FEWEST, MAXIMUM))
        self.assertEqual(document["context"]["processes"], f"n=17: {FEWEST}; n=33: {MAXIMUM}")
        self.assertNotIn("host_name", document["context"])
        self.assertEqual(len(rows), 3 * (FEWEST + MAXIMUM))  # of each cell the quickest of three repetitions
        self.assertNotIn("family_index", rows[0])
        path = self.write("raw.json", json.dumps(document))
        found = read_run(path, ("table1",), ("energy_error",), (), "table1")
        times = found.cell("group", 33, 1).times
        self.assertEqual([round(1e3 * times[process], 6) for process in range(MAXIMUM)], [2.0, 2.2] * (MAXIMUM // 2))

    def test_every_process_does_the_same_work_in_turns(self):
        self.measured(17, times={"17": DECIDED})
        first, *others = self.calls(17)
        self.assertNotIn("--products", first)
        for call in others:
            self.assertIn("--products=eigen", call)
        for call in (first, *others):
            for part in ("--references here", "--benchmark_repetitions=3",
                         "--benchmark_enable_random_interleaving=true"):
                self.assertIn(part, call)
            self.assertNotIn("--no-warm-run", call)

    def test_at_129_a_process_has_one_repetition_and_only_the_first_a_warm_run(self):
        _, _, rows = self.measured(129, times={"129": DECIDED})
        first, *others = self.calls(129)
        self.assertNotIn("--no-warm-run", first)
        self.assertTrue(all("--no-warm-run" in call and "--products=openblas" in call for call in others))
        self.assertTrue(all("--benchmark_repetitions=1" in call for call in (first, *others)))
        # Their runs are the same to the last bit, and so is the energy error.
        self.assertEqual([row["energy_error"] for row in rows], [1e-5] * len(rows))

    def test_of_repetitions_the_quickest_is_kept(self):
        rows = [{"run_name": name, "cpu_time": seconds, "product_share": share}
                for name, seconds, share in (("a", 2.0, 0.5), ("b", 3.0, 0.6), ("a", 1.9, 0.4), ("b", 3.1, 0.7))]
        self.assertEqual(quickest(rows), [rows[2], rows[1]])
        rows[1]["error_occurred"] = True
        self.assertEqual(quickest(rows), [rows[2], rows[1], rows[3]])

    def test_a_failed_row_is_kept_and_ends_with_3(self):
        _, status, rows = self.measured(17, times={"17": {**DECIDED, "group": "diverged at step 3"}})
        self.assertEqual(status, SOLVER_FAILED)
        self.assertEqual({row.get("error_message") for row in rows}, {None, "diverged at step 3"})
        self.assertEqual(len([row for row in rows if "error_message" in row]), 3 * FEWEST)  # each repetition
        self.assertEqual(len(self.calls(17)), FEWEST)

    def test_a_program_that_dies_ends_the_measurement_and_what_ended_before_is_kept(self):
        with self.assertRaises(Stop) as raised:
            self.measured(17, times={"17": DECIDED}, die=3)
        self.assertEqual(raised.exception.status, 7)
        self.assertIn("exit status 7", str(raised.exception))
        self.assertEqual(self.told, ["some reason\n"])  # not how Google Benchmark was packaged
        self.measured(17, times={"17": DECIDED})
        self.assertEqual(len(self.calls(17)), FEWEST + 1)  # the one that died, again

    def test_what_another_program_kept_is_not_taken(self):
        self.measured(17, times={"17": DECIDED})
        os.utime(self.program, (1, 1))  # built anew
        self.measured(17, times={"17": DECIDED})
        self.assertEqual(len(self.calls(17)), 2 * FEWEST)

    def test_processes_under_other_conditions_are_not_mixed(self):
        with self.assertRaises(Stop):
            self.measured(17, times={"17": DECIDED}, die=3)
        path = next(os.path.join(folder, name) for folder, _, names in os.walk(self.path("kept"))
                    for name in sorted(names) if name.endswith(".json"))
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
        found["context"]["cpu"] = "another"
        self.write(path, json.dumps(found))
        with self.assertRaisesRegex(Stop, "under other conditions"):
            self.measured(17, times={"17": DECIDED})

    def test_a_disturbed_process_is_measured_again_and_told_if_it_stays_disturbed(self):
        real, seen = fresh_process.run_on, []

        def disturbed(core, command, **streams):
            seen.append(command)
            return real(core, command, **streams)[0], BUSY if len(seen) in (1, 3, 4) else QUIET

        with mock.patch("lib.running.fresh_process.run_on", disturbed):
            document, _, _ = self.measured(17, times={"17": DECIDED})
        self.assertEqual(len(seen), FEWEST + 2)  # the second process stays disturbed
        self.assertEqual(document["context"]["disturbed_processes"], "n=17 process 1")


def state_of(number):
    """Returns the state of a process as proc(5) has it: Z once it ended and nobody has asked how."""
    try:
        with open(f"/proc/{number}/stat", encoding="ascii") as file:
            return file.read().rpartition(")")[2].split()[0]
    except OSError:
        return "Z"


class Disturbances(unittest.TestCase):
    def test_a_busy_neighbour_on_the_core_is_noticed(self):
        core = fresh_process.last_core()
        spin = [sys.executable, "-c", "import time\nend = time.process_time() + 0.4\n"
                "while time.process_time() < end: pass"]
        neighbour = subprocess.Popen([sys.executable, "-c", "import os\nparent = os.getppid()\n"
                                      "while os.getppid() == parent: pass"],
                                     preexec_fn=lambda: os.sched_setaffinity(0, {core}))
        try:
            status, disturbance = run_on(core, spin)
        finally:
            neighbour.kill()
            neighbour.wait()
        self.assertEqual(status, 0)
        self.assertGreater(disturbance.switches, MAX_SWITCHES)

    def test_a_process_ends_with_the_one_that_started_it_even_if_that_is_killed(self):
        # The inner one writes down its number, and would wait for ten minutes.
        outer = f"""
import sys
sys.path.insert(0, {os.path.join(ROOT, 'scripts')!r})
from lib.running.fresh_process import run_on
run_on({fresh_process.last_core()}, ["sh", "-c", "echo $$; exec sleep 600"])
"""
        with subprocess.Popen([sys.executable, "-B", "-c", outer], stdout=subprocess.PIPE, encoding="ascii") as process:
            inner = int(process.stdout.readline())
            os.kill(inner, 0)
            process.kill()
        deadline = time.monotonic() + 60
        while os.path.exists(f"/proc/{inner}") and "Z" not in state_of(inner):
            self.assertLess(time.monotonic(), deadline, "it went on")
            time.sleep(0.02)

    def test_it_starts_beside_other_threads_without_a_fork_of_python_s_own(self):
        # Python 3.12 and newer warn of such a fork; nothing else may run then, since the child may hang.
        beside_a_thread = f"""
import os, sys, threading
sys.path.insert(0, {os.path.join(ROOT, 'scripts')!r})
from lib.running.fresh_process import last_core, run_on
os.register_at_fork(before=lambda: os._exit(9))
threading.Thread(target=threading.Event().wait, daemon=True).start()
sys.exit(run_on(last_core(), ["true"])[0])
"""
        self.assertEqual(run([sys.executable, "-W", "error", "-B", "-c", beside_a_thread]).returncode, 0)

    def test_a_process_runs_on_the_cores_of_a_set(self):
        cores = os.sched_getaffinity(0)
        tell = "import os, sys; sys.exit(len(os.sched_getaffinity(0)))"
        self.assertEqual(run_on(cores, [sys.executable, "-c", tell])[0], len(cores))
        self.assertEqual(run_on(max(cores), [sys.executable, "-c", tell])[0], 1)

    def test_exit_statuses_and_signals_are_returned(self):
        self.assertEqual(run_on(0, ["sh", "-c", "exit 5"])[0], 5)
        self.assertEqual(run_on(0, ["sh", "-c", "kill -KILL $$"])[0], -signal.SIGKILL)


class Script(MeasureTest):
    def line(self, *arguments):
        return [sys.executable, "-B", MEASURE, "tables", "table1", "--quick", *arguments]

    def surroundings(self):
        return environment(ISOSYRK_BUILD=self.path("build"), CALLS=self.calls_path, PLAN=self.path("plan.json"))

    def test_a_signal_ends_the_program_and_the_same_command_goes_on(self):
        self.write("plan.json", json.dumps({"times": {"17": DECIDED, "33": DECIDED}, "wait": 2}))
        process = start(self.line("--out", self.path("raw.json")), env=self.surroundings(), stderr=subprocess.PIPE)
        self.addCleanup(end, process)
        deadline = time.monotonic() + 60
        while len(self.calls(17)) < 3:
            self.assertLess(time.monotonic(), deadline, "the third process did not start")
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGTERM)
        self.assertEqual(process.wait(timeout=60), 143)
        self.assertIn("the same command goes on from here", process.stderr.read())
        self.assertFalse(os.path.exists(self.path("raw.json")))
        kept = self.path("raw.json.processes", "n17_process0.json")
        told = json.loads(text_of(kept))
        told["benchmarks"][0]["spectrum_error"] = 0.5  # which is then seen not to be measured again
        self.write(os.path.relpath(kept, self.folder), json.dumps(told))
        self.write("plan.json", json.dumps({"times": {"17": DECIDED, "33": DECIDED}}))
        done = run(self.line("--out", self.path("raw.json")), env=self.surroundings())
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertIn('"spectrum_error":0.5', text_of(self.path("raw.json")))
        self.assertFalse(os.path.exists(self.path("raw.json.processes")))
        self.assertRegex(done.stderr, r"\[12 of 12\]")

    def test_only_the_sizes_that_are_named_are_measured(self):
        self.write("plan.json", json.dumps({"times": {"17": DECIDED, "33": DECIDED}}))
        done = run(self.line("--out", self.path("raw.json"), "--n", "33"), env=self.surroundings())
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertEqual((len(self.calls(17)), len(self.calls(33)) >= FEWEST), (0, True))

    def test_wrong_arguments_are_refused(self):
        plain = self.write("plain", "")
        for arguments, part in ((("--out", "x", "--quik"), "--quik"), ((), "--out"), (("--n", "21"), "--n"),
                                (("--out", os.path.join(plain, "raw.json")), "--out")):
            done = run(self.line(*arguments), env=self.surroundings())
            self.assertEqual(done.returncode, BAD_ARGUMENTS)
            self.assert_one_line(done.stderr, "measure tables", part)


if __name__ == "__main__":
    unittest.main()
