"""Tests of what the studies share (the raw file, untimed work on clusters, the checkpoint,
interruptions), and of the functions of scaling, accuracy and limits. Each study as a user runs it: test_every_study."""

import concurrent.futures
import importlib.util
import json
import math
import os
import re
import signal
import sys
import time
import unittest
from types import SimpleNamespace
from unittest import mock

import study_documents
from programs import BUILD, DONE, HAS_MODULE, MEASURE, ROOT, FolderTest, end, environment, run, start, text_of
from study_documents import raw, study_document

from lib.programs.command_line import Stop
from lib.records import formats
from lib.programs.messages import UnusableFile
from studies.scaling import schema as scaling_table
from lib.records.formats import FAST, PUBLISHED, listed
from lib.records.integrators import NAMED, TABLE1_CELLS
from studies.accuracy.lines import FLOOR_MARGIN
from studies.accuracy.schema import GOOD_ENOUGH, SCHEMA, Form
from lib.records.settings import Problem

if HAS_MODULE:
    sys.path.insert(0, os.path.join(BUILD, "python"))
    import isosyrk
    import numpy
    from studies.threads import plan
    from studies.accuracy import candidates, comparisons, single_runs as accuracy_runs
    from lib.running import built, initial_states, problems, timed, trials

RECORDED = os.path.join(ROOT, "results", "recorded", "accuracy", "raw.json")
REFERENCES = os.path.join(ROOT, "results", "recorded", "references")
HAS_DASK = importlib.util.find_spec("distributed") is not None
NO_ANSWER, INTERRUPTED, TERMINATED = 3, 130, 143

# A study of squares, of timed points and of fresh processes: a job is told in LOG, takes a while, and kills its process
# the first times where it is told to. So is a fresh process, which prints how many seconds it took.
SQUARES = """
import importlib, multiprocessing, os, sys, time
sys.path.insert(0, %r)
from lib.running import program, timed, untimed
from lib.running.checkpoint import Checkpoint

def square(job):
    with open(os.environ["LOG"], "a") as log:
        log.write(f"{job['number']}\\n")
        log.flush()
    with open(os.environ["LOG"]) as log:
        deadly = len([line for line in log if line == f"{job['number']}\\n"]) <= job["deaths"]
    if deadly:
        os.kill(os.getpid(), 9)
    time.sleep(0.2)
    return job["number"]**2

def main(arguments):
    parser = program.parser("squares", "Squares.")
    parser.add_argument("--deaths", type=int, default=0)
    options = parser.parse_args(arguments)
    checkpoint = Checkpoint("squares", options, lambda: {"commit": "1"})
    jobs = [{"number": number, "deaths": options.deaths if number == 7 else 0} for number in range(12)]
    before = {**os.environ}
    squares = untimed.results(jobs, importlib.import_module("squares").square, checkpoint, options, "squares")
    # Whatever is timed next runs alone, as if there had been no cluster.
    print({name for name in os.environ if os.environ[name] != before.get(name)} - {"DASK_PARENT"},
          multiprocessing.active_children(), file=sys.stderr)
    seconds = timed.interleaved([1, 3], 3, lambda point: point * 0.25, checkpoint, "turns")
    def command(block, process):
        return ["sh", "-c", f"echo process{process} >>$LOG; sleep 0.3; echo [{process + 1}.5]"]
    times = timed.by_processes([{"rows": ["row"]}], command, lambda found: {"row": 3 - len(found["row"])}, checkpoint,
                               "processes")
    print(squares, seconds, checkpoint.context["timed_on"], times[0]["row"])
    checkpoint.remove()

if __name__ == "__main__":
    program.run("squares", main, sys.argv[1:])
""" % os.path.join(ROOT, "scripts")
# 0.25 s are timed three times, 0.75 s are enough at once.
RESULT = (f"{[number**2 for number in range(12)]} {[[1 * 0.25] * 3, [3 * 0.25]]} core {max(os.sched_getaffinity(0))}"
          " [1.5, 2.5, 3.5]\n")
UNTIMED, TIMED = 12, 4 + 3  # results of squares; of points and processes


class RawFile(FolderTest):
    def test_what_was_written_is_read(self):
        study = formats.study_of(raw(study_document()), SCHEMA)
        path = self.path("raw.json")
        formats.write_study(path, SCHEMA, study.context, study.settings, study.tables)
        self.assertEqual(formats.read_study(path, SCHEMA), study)
        before = os.stat(path).st_mtime_ns
        broken = {**study.tables, "runs": [study.tables["runs"][0]._replace(error=float("nan"))]}
        with self.assertRaises((ValueError, UnusableFile)):
            formats.write_study(path, SCHEMA, study.context, study.settings, broken)
        self.assertEqual((os.stat(path).st_mtime_ns, os.listdir(self.folder)), (before, ["raw.json"]))

    def test_kinds(self):
        no_numbers = (True, "1", math.nan, math.inf, -1, 1e300, 10**400)
        for kind, wrong in (
                (formats.text, (7, "", "two\nlines", "x" * 61)), (formats.truth, (0, "true")),
                (formats.number, (None, *no_numbers)), (formats.positive, (0, 5e-324)),
                (formats.optional(formats.number), no_numbers), (formats.whole(1), (1.0, 0, 10**15)),
                (formats.list_of(formats.number, 2), ({}, [0], [0] * 3, [0, "1"])),
                (formats.an_object, (None, []))):
            for value in wrong:
                with self.subTest(value=str(value)[:9]), self.assertRaisesRegex(UnusableFile, "a thing has x"):
                    formats.checked({"x": value}, {"x": kind}, "a thing")


class SquaresTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.script = self.write("squares.py", SQUARES)
        self.log = self.path("log")

    def command(self, *arguments):
        return [sys.executable, "-B", self.script, "--out", self.path("raw.json"), *arguments]

    def squares(self, *arguments):
        return run(self.command(*arguments), env=environment(LOG=self.log))

    def assert_result(self, done):
        self.assertEqual((done.returncode, done.stdout), (0, RESULT), done.stderr)
        self.assertFalse(os.path.exists(self.path("raw.json.checkpoint")))

    def begun(self):
        """Returns how often each job was begun, and each fresh process: once where it was measured again, disturbed."""
        numbers = text_of(self.log).split()
        return {number: 1 if number.startswith("process") else numbers.count(number) for number in numbers}


@unittest.skipUnless(HAS_DASK, "this Python has no distributed (python3-distributed)")
class Work(SquaresTest):
    def test_every_job_once_in_order_with_time_left(self):
        done = self.squares()
        self.assert_result(done)
        self.assertEqual(set(self.begun().values()), {1})
        self.assertRegex(done.stderr, r"squares: +[1-9][0-9]%.*\[[0-9:]+<[0-9:]+,")
        self.assertIn("\nset() []\n", done.stderr)

    def test_an_interrupted_study_goes_on_and_leaves_no_process(self):
        """Ctrl-C, SIGTERM and kill -9, among untimed work and while a fresh process is timed."""
        for sent, status, told, after, other in (
                (signal.SIGINT, INTERRUPTED, "interrupted", 4, ""),
                (signal.SIGTERM, TERMINATED, "terminated", 4, "commit"),  # of another program
                (signal.SIGKILL, -signal.SIGKILL, "", 4, "scripts"),  # of other studies
                (signal.SIGKILL, -signal.SIGKILL, "", UNTIMED + TIMED - 1, "")):
            with self.subTest(signal=sent, after=after):
                finished = self.interrupted(sent, status, told, after)
                begun, *results = finished
                self.assertLess(len(results), UNTIMED + TIMED)
                os.unlink(self.log)
                # A last line that was cut does no harm.
                begun, changed = re.subn(f'"{other}": "[0-9a-f]+"', f'"{other}": "0"', begun)
                self.assertEqual(bool(changed), bool(other))
                lines = [begun, *results, '["squa']
                self.write("raw.json.checkpoint", "\n".join(lines))
                done = self.squares()
                self.assert_result(done)
                kept = 0 if other else len(results)
                self.assertIn(f"going on after {kept} results" if kept else "belongs to something else", done.stderr)
                timed = sum(json.loads(json.loads(line)[0])[0].startswith("turns") for line in results) if kept else 0
                self.assertEqual(sum(self.begun().values()), UNTIMED + 3 - (kept - timed))
                self.assertEqual(set(self.begun().values()), {1})
                os.unlink(self.log)

    def interrupted(self, sent, status, told, after):
        """Sends a signal once a study has more than so many results, and returns the lines of its checkpoint."""
        process = start(self.command(), env=environment(LOG=self.log), stderr=-1)
        try:
            while len(self.checkpoint()) <= after:
                self.assertIsNone(process.poll())
                time.sleep(0.02)
            process.send_signal(sent)
            _, errors = process.communicate(timeout=20)  # until every process of it has let go of stderr
            self.assertEqual(process.returncode, status)
            if told:
                self.assert_one_line(re.split(r"it/s\]|s/it\]", errors)[-1].lstrip("\n"), f"squares: {told}")
        finally:
            end(process)
        return [line for line in self.checkpoint() if line.endswith(("}", "]"))]

    def test_another_processor_keeps_untimed_work_and_times_anew(self):
        ends = "    print(squares, seconds,"
        for cpu, anew in ((None, 0), ("another", TIMED)):
            with self.subTest(cpu=cpu):
                self.write("squares.py", SQUARES.replace(ends, f"    raise KeyboardInterrupt\n{ends}"))
                self.assertEqual(self.squares().returncode, INTERRUPTED)
                begun, *finished = self.checkpoint()
                self.assertEqual(len(finished), UNTIMED + TIMED)
                if cpu:
                    begun = begun.replace('"context": {', f'"context": {{"cpu": "{cpu}", ')
                    finished = [line.replace("on None", f"on {cpu}") for line in finished]
                self.write("raw.json.checkpoint", "\n".join([begun, *finished, ""]))
                os.unlink(self.log)
                counted = "    print(len(checkpoint.found), file=sys.stderr)\n"
                self.write("squares.py", SQUARES.replace(ends, counted + ends))
                done = self.squares()
                self.assert_result(done)
                # No square was done again.
                again = set(text_of(self.log).split()) if os.path.exists(self.log) else set()
                self.assertEqual(again, {"process0", "process1", "process2"} if cpu else set())
                self.assertEqual("begun on another processor" in done.stderr, bool(cpu))
                self.assertRegex(done.stderr, f"\\n{UNTIMED + TIMED + anew}\\n")

    def test_sigterm_ends_a_study_also_within_what_catches_every_exception(self):
        catching = "try:\n        os.kill(os.getpid(), 15)\n    except Exception:\n        pass\n    options ="
        self.assert_ends(catching, TERMINATED, "squares: terminated; the same command goes on")

    def test_a_signal_that_came_where_python_ignores_exceptions_is_sent_again(self):
        for number, status, told in ((15, TERMINATED, "terminated"), (2, INTERRUPTED, "interrupted")):
            at_a_fork = (f"""import subprocess
    os.register_at_fork(after_in_parent=lambda: os.kill(os.getpid(), {number}))
    subprocess.run(["true"], preexec_fn=int)
    time.sleep(20)
    options =""")
            with self.subTest(signal=told):
                self.assert_ends(at_a_fork, status, f"squares: {told}; the same command goes on")

    def assert_ends(self, code, status, told):
        """Runs a study that does so before anything else."""
        self.write("squares.py", SQUARES.replace("options =", code))
        done = self.squares()
        self.assertEqual((done.returncode, done.stdout, os.listdir(self.folder)), (status, "", ["squares.py"]))
        self.assert_one_line(done.stderr, told)

    def checkpoint(self):
        path = self.path("raw.json.checkpoint")
        return text_of(path).splitlines() if os.path.exists(path) else []

    def test_without_dask_it_says_what_to_install(self):
        self.write("distributed.py", "raise ImportError\n")
        self.assert_refused(self.squares(), "squares: this Python has no distributed", "install python3-distributed")

    def test_a_lost_worker_is_told_and_its_jobs_are_done_again_for_some_time(self):
        done = self.squares("--deaths", "1")
        self.assert_result(done)
        self.assertIn("a worker was lost; its jobs are done again", done.stderr)
        self.assertEqual(self.begun()["7"], 2)
        done = self.squares("--deaths", "100")  # one that loses every worker
        self.assertEqual((done.returncode, done.stdout), (NO_ANSWER, ""), done.stderr)
        self.assertIn("squares: a worker was lost", done.stderr)


def start_cluster(test, **settings):
    """Returns the address of a Dask scheduler with two workers, each a process of this machine, until a test ends."""
    import distributed
    sys.path.append(test.folder)  # which workers take over, as one on another machine has the scripts
    test.addCleanup(sys.path.remove, test.folder)
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0",
                                       silence_logs="CRITICAL", local_directory=test.folder,
                                       env=environment(**settings))
    test.addCleanup(cluster.close)
    return cluster.scheduler_address


@unittest.skipUnless(HAS_DASK, "this Python has no distributed (python3-distributed)")
class Dask(SquaresTest):
    def test_a_worker_that_is_killed_costs_nothing_but_time(self):
        done = self.squares("--scheduler", start_cluster(self, LOG=self.log), "--deaths", "1")
        self.assert_result(done)
        self.assertEqual(self.begun()["7"], 2)
        self.assertIn("a worker was lost; its jobs are done again", done.stderr)

    def test_a_scheduler_that_has_gone_or_has_no_workers_is_told(self):
        from lib.running import untimed
        for workers, cancelled in (({"one": 1}, True), ({}, False)):
            future, told = concurrent.futures.Future(), []
            future.cancel() if cancelled else future.set_result(4)
            cluster = untimed.Cluster(SimpleNamespace(scheduler="tcp://127.0.0.1:9", workers=1))
            cluster.client = mock.Mock(submit=mock.Mock(return_value=future), nthreads=lambda: workers)
            found = cluster.as_finished(abs, {"key": -4}, "squares", told.append)
            if cancelled:
                with self.assertRaisesRegex(Stop, "^--scheduler tcp://127.0.0.1:9: is gone; the same command goes on"):
                    list(found)
            else:
                self.assertEqual((list(found), told), ([("key", 4)], [untimed.NO_WORKERS]))

    def test_a_scheduler_that_is_not_there(self):
        done = self.squares("--scheduler", "tcp://127.0.0.1:9")
        self.assertEqual(done.returncode, 2)
        self.assertIn("squares: --scheduler tcp://127.0.0.1:9: cannot be reached", done.stderr)


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class StudyTest(FolderTest):
    def script(self, name, *arguments):
        return run([sys.executable, "-B", MEASURE, name, *arguments], timeout=120,
                   env=environment(ISOSYRK_BUILD=BUILD))

    def made(self, name, *arguments, file="raw.json"):
        """Returns the path of what a study wrote, without a word on stdout."""
        path = self.path(file)
        done = self.script(name, "--out", path, *arguments)
        self.assertEqual((done.returncode, done.stdout), (DONE, ""), done.stderr)
        self.assertFalse(os.path.exists(f"{path}.checkpoint"))
        return path


class Scaling(StudyTest):
    def setUp(self):
        super().setUp()
        from studies.scaling import plan as scaling_plan, run as scaling
        self.scaling, self.plan = scaling, scaling_plan

    def options(self, **values):
        return SimpleNamespace(**{"n": None, "quick": False, "no_large": False, "integrator": None, **values})

    def point(self, **values):
        return {"scene": "smooth", "start": 5.0, "n": 17, "integrator": "group2", "ablation": "fast", "step": 0.1,
                "tolerance": 1e-13, "steps": 8, "products": "eigen", **values}

    def test_states_are_those_of_the_flow(self):
        states = self.scaling.states_of("smooth", 17, (3.5, 5.0, 50.0))
        for at, bound in ((5.0, 1e-7), (50.0, 1e-5)):
            reference, _ = problems.reference_of(Problem("smooth", at, 17), REFERENCES)
            self.assertLess(self.scaling.isosyrk.relative_error(states[at], reference), bound)
            self.assertGreater(self.scaling.isosyrk.relative_error(states[3.5], reference), 1e-2)  # the control
        W = self.scaling.decoded(self.scaling.encoded(states[5.0]), 17)
        self.assertLess(abs(W - states[5.0]).max(), 1e-15)
        self.assertEqual(abs(W + W.conj().T).max(), 0)

    def test_states_are_reached_by_shorter_steps_where_one_fails(self):
        expected, calls = self.scaling.states_of("smooth", 9, (5.0,))[5.0], []

        class Method:
            """Fails with steps above `longest`."""

            def run(self, W, h, steps):
                calls.append(h)
                if h > longest:
                    raise isosyrk.SolverError(1, "diverged", 1.0, W, mock.Mock(sweeps=9))
                return real.run(W, h, steps)

        real = isosyrk.integrator(self.scaling.scene_of("smooth", 9), "elp6_frame", solver="fast", tolerance=1e-10)
        with mock.patch.object(self.scaling.isosyrk, "integrator", lambda *_, **options: Method()):
            longest = 0.1
            found = self.scaling.states_of("smooth", 9, (5.0,))[5.0]
            self.assertEqual(calls, [0.25, 0.125, 0.0625])
            self.assertLess(isosyrk.relative_error(found, expected), 1e-7)
            longest = 0.0
            told = "^states at n = 9: elp6_frame fails with h = 0.0312 too$"
            with self.assertRaisesRegex(Stop, told) as caught:
                self.scaling.states_of("smooth", 9, (5.0,))
            self.assertEqual(caught.exception.status, NO_ANSWER)

    def test_forms_with_a_memory_are_warm_when_the_timed_steps_start(self):
        for changes, memory in (({}, True), ({"ablation": "without bands"}, True),
                                ({"ablation": "without predictor"}, True),
                                ({"ablation": "published"}, False), ({"ablation": "without any"}, False),
                                ({"integrator": "rk4"}, False)):
            point = self.point(**changes)
            with self.subTest(changes=changes):
                self.assertEqual((self.plan.has_memory(point), self.plan.warm_steps(point)),
                                 (memory, 15 if memory else 0))
                self.assertAlmostEqual(self.plan.begin_of(point) + point["step"] * self.plan.warm_steps(point),
                                       point["start"])
        # And that is worth it: cold, the same steps take more products.
        states = self.scaling.states_of("smooth", 17, (3.5, 5.0))
        warm = self.scaling.count(self.point(), states[3.5])
        with mock.patch.object(self.scaling, "warm_steps", lambda point: 0):
            cold = self.scaling.count(self.point(), states[5.0])
        self.assertGreater(cold["equivalent_products"], 1.2 * warm["equivalent_products"])

    def test_a_step_that_fails_has_no_counts(self):
        W = self.scaling.states_of("smooth", 17, (5.0,))[5.0]
        self.assertIsNone(self.scaling.count(self.point(ablation="published", step=50.0), W))
        self.assertEqual(self.scaling.record(self.point(), None, []).seconds, [])

    def test_repetitions_begin_at_the_same_state(self):
        begun = []
        W = self.scaling.states_of("smooth", 17, (3.5,))[3.5]
        timer = self.scaling.Timer({17: {"3.5": self.scaling.encoded(W)}}, mock.Mock())
        with mock.patch.object(timed, "seconds_of", lambda method, W, h, steps, warmup: begun.append(
                (W.tobytes(), h, steps, warmup)) or 1.0):
            self.assertEqual([timer(self.point()) for _ in range(3)], [1.0] * 3)
        self.assertEqual(len(set(begun)), 1)
        self.assertEqual(begun[0][1:], (0.1, 8, 15))

    def test_memory_is_that_of_no_larger_n(self):
        checkpoint = mock.Mock(found={}, key_of_timed=lambda what, n: n, add=lambda key, value: checkpoint.found.update(
            {key: value}))
        timer, peaks = self.scaling.Timer({}, checkpoint), iter((1000, 2000, 3000))
        usage = mock.Mock(side_effect=lambda who: SimpleNamespace(ru_maxrss=next(peaks)))
        with mock.patch.object(self.scaling.resource, "getrusage", usage):
            for n in (129, 257, 513, 129, 257, 513):
                timer.look_at_memory(n)
        self.assertEqual([timer.memory(n) for n in (129, 257, 513)], [None, 1000 * 1024, 3000 * 1024])

    def test_what_is_timed_at_large_n(self):
        entries = self.plan.entries_asked_for(self.options())
        points = self.plan.points_of(entries, self.plan.SIZES, lambda n: "eigen")
        found = {n: {(each["integrator"], each["ablation"]) for each in points if each["n"] == n}
                 for n in self.plan.SIZES}
        self.assertEqual(found[1025], {("group2_frame", "fast"), ("elp4_frame", "fast")})
        self.assertEqual({each["start"] for each in points if each["n"] == 1025}, {5.0})
        self.assertEqual(len(found[513]), 6)
        steps = {(each["n"], each["integrator"]): each["step"] for each in points if each["n"] >= 257}
        self.assertEqual([(steps[n, "group2_frame"], steps[n, "elp4_frame"]) for n in (257, 513, 1025)],
                         [(0.1, 0.25), (0.05, 0.125), (0.025, 0.0625)])
        self.assertEqual({(self.plan.warm_steps(each), self.plan.begin_of(each)) for each in points
                          if each["n"] == 1025}, {(15, 4.625), (6, 4.625)})
        self.assertEqual(self.plan.lines(), ["algebra1_frame", "group2_frame", "elp4_frame", "rk4_frame"])
        self.assertEqual(found[257], {(name, ablation) for name in self.plan.lines()
                                      for ablation in scaling_table.BASIC})
        self.assertEqual({name for name, _ in found[129]}, {entry.name for entry in entries if entry.has_fast_form})
        self.assertEqual({name for name, _ in found[65]}, {entry.name for entry in entries})
        self.assertLess(found[129], found[65])

    def test_short_memory_leaves_out_the_largest_n_and_tells(self):
        for free, largest, told in ((1e12, 1025, 0), (1e9, 513, 1)):
            with mock.patch.object(plan, "free_memory", lambda: free), \
                    mock.patch.object(plan, "say") as say:
                self.assertEqual(max(self.plan.sizes_asked_for(self.options())), largest)
                self.assertEqual(say.call_count, told)
        self.assertEqual(max(self.plan.sizes_asked_for(self.options(no_large=True))), 129)
        self.assertGreater(plan.free_memory(), 1e6)


def accuracy_of_lines(seconds):
    """Returns an Accuracy of integrators with lines on one problem that take so many seconds a step and err as h⁴; one
    with None has no line."""
    document = study_documents.small_study()
    document["integrators"] = [listed(name)._asdict() for name in seconds]
    lines = [name for name in seconds if seconds[name]]
    (end,) = [each for each in document["lines"] if each["integrator"] == "rk4"]
    document["lines"] = [{**end, "integrator": name} for name in lines]
    document["runs"] = [{**run, "integrator": name, "beyond_limit": False,
                         "cpu_seconds": [seconds[name] * run["steps"]]}
                        for name in lines for run in document["runs"] if run["integrator"] == "rk4"]
    document["tolerance_runs"] = document["comparisons"] = []
    return study_documents.accuracy_of(document)


class Accuracy(StudyTest):
    PROBLEM = Problem("smooth", 5.0, 17)

    def setUp(self):
        super().setUp()
        from studies.accuracy import plan as accuracy_plan, run as accuracy
        self.accuracy, self.plan = accuracy, accuracy_plan

    def test_how_the_steps_of_a_comparison_are_sought(self):
        # One step less errs by more.
        job = {**self.PROBLEM._asdict(), "wanted": 1e-6, "candidate": "rk4", "integrator": "rk4_frame", "solver": FAST,
               "tolerance": 1e-13, "references": REFERENCES}
        row = comparisons.cheapest_steps({**job, "steps": 200})
        setting = accuracy_runs.Setting(job)
        fewer = comparisons.run_of(job, setting, row["steps"] - 1)
        self.assertGreater(fewer.error, 1e-6)
        self.assertEqual(comparisons.cheapest_steps({**job, "steps": row["steps"]}), row)
        # Steps that are too few, as they may be at a looser tolerance, become more; none reach an error below rounding.
        self.assertEqual(comparisons.cheapest_steps({**job, "steps": row["steps"] // 2}), row)
        self.assertIsNone(comparisons.cheapest_steps({**job, "wanted": 1e-17, "steps": 20}))
        # Work that rises and falls again: the least of all that are tried, not the first that the next does not better.
        jagged = {**job, "wanted": 1.5e-3, "candidate": "gauss_loose", "integrator": "group2_frame", "tolerance": 1e-7,
                  "steps": 4}
        setting = accuracy_runs.Setting(jagged)
        work = {steps: comparisons.run_of(jagged, setting, steps).equivalent_products for steps in range(4, 7)}
        self.assertEqual(work[comparisons.cheapest_steps(jagged)["steps"]], min(work.values()))

    def test_no_neighbour_of_the_steps_of_a_comparison_is_cheaper_by_two_per_cent(self):
        for name, candidate, tolerance, wanted in (("rk8_frame", "explicit", 1e-13, 1e-6),
                                                   ("group3_frame", "gauss", 1e-13, 1e-6),
                                                   ("elp6_frame", "elp", 1e-8, 1e-4),
                                                   ("magnus5_frame", "magnus", 1e-8, 1e-6)):
            with self.subTest(integrator=name):
                job = {**self.PROBLEM._asdict(), "scene": "rough", "wanted": wanted, "candidate": candidate,
                       "integrator": name, "solver": FAST, "tolerance": tolerance, "references": REFERENCES,
                       "steps": 12}
                row = comparisons.cheapest_steps(job)
                setting = accuracy_runs.Setting(job)
                for steps in range(max(1, math.floor(0.8 * row["steps"])), math.ceil(1.1 * row["steps"]) + 1):
                    run = comparisons.run_of(job, setting, steps)
                    if comparisons.is_reached(wanted, run):
                        self.assertGreater(run.equivalent_products, 0.98 * row["equivalent_products"], steps)

    def test_the_explicit_method_of_order_8_takes_the_steps_that_others_counted(self):
        # Of DOP853 by another implementation, rough scene.
        for n, steps in ((33, 9), (65, 16), (129, 29)):
            job = {**Problem("rough", 5.0, n)._asdict(), "wanted": 1e-6, "candidate": "explicit", "solver": FAST,
                   "integrator": "rk8_frame", "tolerance": 1e-13, "references": REFERENCES, "steps": steps + 2}
            self.assertEqual(comparisons.cheapest_steps(job)["steps"], steps)

    def test_steps_beyond_a_linear_limit_are_tried_and_marked(self):
        job = {**Problem("smooth", 5.0, 129)._asdict(), "wanted": 1e-4, "candidate": "rk4", "integrator": "rk4_frame",
               "solver": FAST, "tolerance": 1e-13, "references": REFERENCES}
        row = comparisons.cheapest_steps({**job, "steps": 16})
        self.assertEqual((row["steps"], row["beyond_limit"]), (8, True))
        setting = accuracy_runs.Setting(job)
        self.assertFalse(comparisons.run_of(job, setting, 16).beyond_limit)
        # A line tells of such runs too, where they are asked for.
        document = study_documents.study_document()
        study_documents.run_of(document, "rk4", 17, 10)["beyond_limit"] = True
        found = study_documents.accuracy_of(document)
        error = 1.01 * 1e-2 * 0.5**4
        self.assertEqual([found.cost(self.PROBLEM, "rk4", error, beyond=beyond).fine.steps for beyond in (True, False)],
                         [10, 20])

    def test_which_methods_may_stand_in_a_comparison(self):
        found = accuracy_of_lines({"group2_frame": 4e-3, "group3_frame": 4.5e-3, "group4_frame": 9e-3,
                                   "rk4_frame": 5e-3, "rk8_frame": 2e-3, "bm2_frame": None, "elp2_frame": 1e-6,
                                   "rk8": 1e-6})

        def standing(wanted, problem=self.PROBLEM):
            jobs = comparisons.jobs_of(found, problem, wanted, REFERENCES)
            return {candidate: [job["integrator"] for job in jobs if job["candidate"] == candidate]
                    for candidate in dict.fromkeys(job["candidate"] for job in jobs)}

        # Those within CLOSE_COST of the least, but none of order 2 or out of the frame.
        usual = {"explicit": ["rk8_frame"], "rk4": ["rk4_frame"], "gauss": ["group2_frame", "group3_frame"],
                 "gauss_loose": ["group2_frame", "group3_frame"]}
        published = {"gauss_published": ["group2_frame", "group3_frame"], "named_published": ["bm2_frame"]}
        self.assertEqual(standing(1e-4), {**usual, "gauss_matched": ["group2_frame", "group3_frame"]})
        self.assertEqual(standing(1e-6), {**usual, **published})
        # A line of a published form tells nothing of fast ones.
        slow = found._replace(lines={key: [run._replace(solver=PUBLISHED) for run in runs]
                                     for key, runs in found.lines.items()})
        self.assertEqual(comparisons.jobs_of(slow, self.PROBLEM, 1e-4, REFERENCES), [])
        self.assertEqual(comparisons.wanted_of(Problem("rough", 5.0, 65)), (1e-4, 1e-6, 1e-8))
        for problem in (self.PROBLEM, Problem("rough", 5.0, 129), Problem("developed", 5.0, 17)):
            self.assertEqual(comparisons.wanted_of(problem), (1e-4, 1e-6))
        for problem, wanted, competes in ((Problem("smooth", 5.0, 129), 1e-6, True),
                                          (Problem("smooth", 5.0, 257), 1e-6, False), (self.PROBLEM, 1e-4, False),
                                          (Problem("smooth", 50.0, 17), 1e-6, False)):
            self.assertEqual(comparisons.is_published_comparison(problem, wanted), competes)

    def test_how_a_line_ends(self):
        job = {**self.PROBLEM._asdict(), "solver": FAST, "references": REFERENCES, "quick": False,
               "table1_step": False}
        for name, tolerance, ends in (("group5_frame", 1e-13, "below"), ("group2_frame", 1e-4, "floor"),
                                      ("group1", 1e-13, "cut")):
            with self.subTest(name=name):
                line = self.accuracy.draw_line({**job, "integrator": name, "tolerance": tolerance})
                self.assertEqual(line["end"], ends)
                errors = [run["error"] for run in line["runs"] if run["error"]]
                self.assertEqual(errors[-1] < GOOD_ENOUGH, ends == "below")
        line = self.accuracy.draw_line({**job, "integrator": "group1", "tolerance": 1e-13, "table1_step": True})
        self.assertEqual(([run["steps"] for run in line["runs"]], line["end"]), ([50], "alone"))

    def test_an_error_that_the_reference_does_not_tell_from_none_ends_a_line_and_so_does_one_that_is_small_enough(self):
        for uncertainty, error, ends in ((1e-3, 0.9e-3 * FLOOR_MARGIN, "floor"), (1e-3, 1.1e-3 * FLOOR_MARGIN, None),
                                         (1e-20, 0.9 * GOOD_ENOUGH, "below")):
            self.assertEqual(self.plan.end_of([SimpleNamespace(error=error)], uncertainty, 4), ends)

    def test_out_of_the_frame_and_in_the_quick_study_less_work_is_enough_and_more_in_long_runs(self):
        def minimum(integrator="rk4_frame", time=5.0, quick=False, n=17):
            """Returns the equivalent products from which a line is cut."""
            return min(products for products in (2.0**k for k in range(60)) if self.plan.took_enough(
                SimpleNamespace(integrator=integrator, time=time, n=n, equivalent_products=products), quick))

        self.assertLess(minimum("rk4"), minimum())
        self.assertLess(minimum(quick=True), minimum())
        self.assertGreater(minimum(time=50.0), minimum())
        self.assertLess(minimum(n=129), minimum(n=65))  # a product is dearer

    def test_which_lines_a_problem_has(self):
        every = built.entries(None, frames=True)

        def lines(problem, entries=every, asked=False):
            forms, alone = self.plan.lines_of(problem, entries, asked)
            self.assertEqual(len(forms), len(set(forms)))
            self.assertLessEqual({*alone}, {*forms})
            return {*forms} - {*alone}, {*alone}

        needed = {Form("algebra1_frame"),
                  *candidates.all_forms(each for each in every if each.has_fast_form)}
        self.assertEqual(lines(Problem("rough", 5.0, 17)), (needed, set()))
        drawn, none = lines(self.PROBLEM)
        self.assertEqual(drawn - needed, {Form(each.name) for each in every} - needed)
        self.assertEqual(none, set())
        some, alone = lines(Problem("smooth", 5.0, 257))
        self.assertEqual(some, needed)
        self.assertTrue({Form("rk8"), Form("group1_frame")} <= alone)
        # What was asked for has a line on every problem.
        asked, _ = lines(Problem("rough", 5.0, 17),
                         [listed("rk4"), listed("elp6_frame")], True)
        self.assertEqual(asked, {Form("rk4"), Form("elp6_frame", 1e-13), Form("elp6_frame", 1e-8)})

    def test_the_quick_study_has_some_of_every_kind(self):
        # It compares fast forms; families that have none yet are in the full study.
        known = built.entries(None, frames=True)
        quick = self.plan.quick_integrators(known)

        def kinds(entries):
            return {(each.family, each.formulation, each.projected) for each in entries if each.family not in NAMED}

        self.assertEqual(kinds(quick), kinds(known))
        self.assertLessEqual({*TABLE1_CELLS, "yoshida4", "rk4_frame", "rk8_frame", "elp6_frame", "group4_frame"},
                             {each.name for each in quick})
        self.assertLess(3 * len(quick), len(known))


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class Trials(unittest.TestCase):
    def test_each_loss_is_told_apart(self):
        W0 = isosyrk.scene("smooth", n=9).initial

        def off_by(error):
            """Returns W₀ with one eigenvalue of −iW moved."""
            values, vectors = numpy.linalg.eigh(-1j * W0)
            values[-1] += error
            return 1j * (vectors * values) @ vectors.conj().T

        for W, energy_lost, isospectral, expected in (
                (off_by(9e-7), False, True, "converged"), (off_by(1.1e-6), False, True, "spectrum lost"),
                (off_by(0.09), False, False, "converged"), (off_by(0.11), False, False, "spectrum lost"),
                (W0, True, True, "energy lost"), (W0 * math.nan, False, True, "not finite")):
            self.assertEqual(trials.loss(W, W0, energy_lost, isospectral), expected)

    def test_a_trial_that_loses_a_tenth_of_the_energy_fails(self):
        setting = trials.Setting(isosyrk.scene("smooth", n=9))
        method = trials.Method(setting, "group1", PUBLISHED)
        for error, expected in ((0.11, "energy lost"), (0.09, "converged"), (math.nan, "energy lost")):
            with self.subTest(error=error), mock.patch.object(setting, "energy_error", return_value=error):
                self.assertEqual(method.outcome(0.25), expected)


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class InitialStates(unittest.TestCase):
    def test_drawn_states_repeat_differ_and_are_of_their_kind(self):
        for scene in initial_states.SCENES:
            states = [initial_states.scene_of(scene, 17, number).initial for number in range(initial_states.STATES)]
            initial_states.scene_of.cache_clear()
            again = initial_states.scene_of(scene, 17, 1).initial
            self.assertTrue(numpy.array_equal(states[1], again))
            for number, W in enumerate(states):
                self.assertAlmostEqual(numpy.linalg.norm(W, 2), 1.0)
                self.assertGreater(min(numpy.abs(W - other).max() for other in states[:number] or [0 * W]), 0.1)
        self.assertTrue(numpy.array_equal(initial_states.scene_of("rough", 17, 0).initial,
                                          isosyrk.scene("rough", n=17).initial))

    def test_a_drawn_mode_is_the_same_for_every_n(self):
        small, large = (initial_states.drawn_modes("rough", n, 2) for n in (9, 17))
        self.assertEqual(small, large[:len(small)])
        self.assertNotEqual(small, initial_states.drawn_modes("rough", 9, 3))


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class Problems(unittest.TestCase):
    def test_every_problem_has_a_recorded_solution(self):
        listed = problems.asked_for(SimpleNamespace(n=None, quick=False, scene=None, time=None))
        self.assertEqual(len(listed), 17)
        for problem in listed:
            with self.subTest(str(problem)):
                scene = problems.scene_of(problem, REFERENCES)  # which checks the energies of a developed one
                W, record = problems.reference_of(problem, REFERENCES)
                self.assertLess(record["uncertainty"], problems.UNCERTAINTIES[problem.scene, problem.time])
                # The flow keeps spectrum and energy, and moves.
                self.assertLess(isosyrk.spectrum_error(W, scene.initial), 1e-12)
                self.assertLess(abs(scene.energy(W) / scene.energy(scene.initial) - 1), 1e-11)
                self.assertGreater(isosyrk.relative_error(W, scene.initial), 0.1)

    def test_packing_loses_nothing(self):
        for modes in ([(2, 1, 0.5, -0.3)], [(1, 0, 1.0, 0.0), (8, 8, 0.2, 0.1)]):
            W = isosyrk.scene(n=9, modes=modes).initial
            self.assertTrue((problems.unpacked(problems.packed(W)) == W).all())
