"""Tests of build/benchmarks/integrate from outside: what it refuses, what it answers, and how it fails."""

import io
import math
import os
import resource
import select
import signal
import stat
import subprocess
import sys
import time
import unittest

import numpy

from programs import (BAD_ARGUMENTS, DATA, DONE, FORMULATIONS, SANITIZED, SOLVER_FAILED, FolderTest, default_signals,
                      end, environment, open_terminal, program, run, run_on_full_disk, start, strict_json)

# The project's answers must agree with the references to 1e-11; see tests/data.
TOLERANCE = 1e-11
SHORT = {"n": "17", "stages": "2", "formulation": "group", "step": "0.1", "time": "0.5"}
NAMED = {**SHORT, "stages": None, "formulation": None}  # goes with "integrator"
# For answers compared bit for bit: which backend is the fastest, two runs may find differently.
SAME_PRODUCTS = {**SHORT, "products": "openblas"}
WHOLE = {**SHORT, "time": "5"}
PROMISED_KEYS = {"n", "stages", "formulation", "step", "steps", "tolerance", "converged", "status", "sweeps_total",
                 "products", "seconds", "spectrum_error", "skew_defect", "energy_error"}
EARLIER = "an earlier result"
EXPONENTIAL = ("elp2", "elp4", "elp6", "magnus4", "magnus5", "rk4_projected")
MODES = "l,m,re,im\n2,0,1,0\n2,1,0.5,0\n"


def command(arguments, *flags, **changes):
    """Returns a command line; a change to None drops the argument, and max_sweeps stands for --max-sweeps."""
    line = [program("integrate")]
    for name, value in {**arguments, **changes}.items():
        if value is not None:
            line += ["--" + name.replace("_", "-"), value]
    return line + list(flags)


def cpu_seconds_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def reference(name):
    """Returns a reference matrix, given as CSV lines i,j,re,im."""
    rows = numpy.genfromtxt(os.path.join(DATA, name), delimiter=",", names=True)
    n = 1 + int(rows["i"].max())
    W = numpy.full((n, n), numpy.nan + 0j)
    W[rows["i"].astype(int), rows["j"].astype(int)] = rows["re"] + 1j * rows["im"]
    return W


class IntegrateTest(FolderTest):
    """An earlier output file, which what is refused or fails must leave as it was, alone in its folder."""

    def setUp(self):
        super().setUp()
        self.output = self.write("out/W.npy", EARLIER)

    def refuses(self, changes, *parts, flags=(), **options):
        with self.subTest(changes=changes, flags=flags, parts=parts), self.unchanged():
            self.assert_refused(run(command({**SHORT, "output": self.output, **changes}, *flags), **options), *parts)

    def result(self, arguments, *flags, **changes):
        """Runs to the end and returns the JSON object and W."""
        output = self.path("W.npy")
        done = run(command(arguments, "--json", "--output", output, *flags, **changes))
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        return strict_json(done.stdout), numpy.load(output)

    def assert_agrees(self, W, other, tolerance=TOLERANCE):
        numpy.testing.assert_allclose(W, other, rtol=0, atol=tolerance)

    def assert_same(self, W, other):
        self.assertEqual(W.tobytes(), other.tobytes())


class RefusedArguments(IntegrateTest):
    CASES = (
        ("n", ("x", "17.0", "0x11", " 17", "", "-3", "1", "4097", "9" * 30), "2 to 4096"),
        ("stages", ("0", "-1", "21", "2.5", "1e0"), "1 to 20"),
        ("step", ("0", "-0", "-0.1", "nan", "inf", "0.1x", "1e400"), "positive and finite"),
        ("time", ("-0.1", "nan", "inf", "x"), "0 or positive, and finite"),
        ("time", ("0.55", "0.5001"), "whole number"), ("time", ("1e+300",), "at most"),
        ("tolerance", ("0", "nan", "inf", "9.99e-16", "x"), "at least 1e-15"),
        ("max_sweeps", ("0", "2.5", "9" * 30), "1 to "), ("formulation", ("quotient", "Group", ""), *FORMULATIONS),
        ("hbar", ("planck", "Paper"), "paper", "standard"),
        ("products", ("abacus", "Eigen"), "fastest", "openblas", "eigen"),
        ("scene", ("calm", "", "Smooth"), "rough"), ("solver", ("quick", "", "Fast"), "published", "fast"),
    )

    def test_values(self):
        for argument, values, *allowed in self.CASES:
            for value in values:
                self.refuses({argument: value}, "--" + argument.replace("_", "-"), value, *allowed)
        for value in ("0", "-1", "65", "x", "1.5", "", "9" * 30):
            self.refuses({"solver": "fast", "threads": value}, "--threads", value, "1 to 64")

    def test_what_is_missing_twice_or_unknown_is_named(self):
        for flags, part in ((("--tolerance",), "--tolerance"), (("--n", "33"), "--n"), (("--jso",), "--jso"),
                            (("-x",), "-x"), (("--stepsize=3",), "--stepsize"), (("perhaps",), "perhaps")):
            self.refuses({}, part, flags=flags)
        for argument in SHORT:
            self.refuses({argument: None}, f"--{argument} ")

    def test_what_does_not_go_together(self):
        modes = self.write("modes.csv", MODES)
        for changes, *parts in (
                *(({"n": n}, f"--n {n}", "n >= 5", "--modes", "--initial") for n in ("2", "4")),
                ({"modes": modes, "scene": "rough"}, "--modes", "--scene", "one of them"),
                ({"initial": "W.npy", "scene": "rough"}, "--initial", "--scene", "one of them"),
                ({"initial": "W.npy", "modes": modes}, "--initial", "--modes", "one of them"),
                ({**NAMED, "integrator": "euler"}, "--integrator 'euler'", "rkmk4", "group2"),
                *(({**NAMED, "integrator": "rk4", other: SHORT[other]}, "--integrator", "must stand alone")
                  for other in ("stages", "formulation")),
                ({**NAMED, "solver": "fast", "integrator": "algebra2_two_products"}, "algebra2_two_products",
                 "no fast form"),
                *(({**NAMED, "integrator": name, "scene": "symplectic", "n": "6"}, f"{name}: ", "J = I")
                  for name in EXPONENTIAL),
                ({**NAMED, "integrator": "elp4_frame", "scene": "rigid_body"}, "Euler-Zeitlin only"),
                ({"solver": "fast", "products": "eigen"}, "--solver fast", "--products eigen"),
                ({"threads": "2"}, "--threads 2", "--solver fast")):
            self.refuses(changes, *parts)

    def test_modes(self):
        self.refuses({"modes": self.path("nowhere.csv")}, "--modes", "nowhere.csv", "cannot be read")
        # More lines and modes that are none: tests/modes_file_test.cpp and tests/scene_test.cpp.
        for row, *parts in (("2,0,1", "line 2"), ("2147483647,0,1,0", "line 2", "l=2147483647", "1 to n-1"),
                            ("2,-1,1,0", "line 2", "m=-1", "0 to l")):
            modes = self.write("modes.csv", f"l,m,re,im\n{row}\n")
            self.refuses({"modes": modes}, "--modes", modes, *parts)

    def test_outputs_that_cannot_be_written(self):
        # What else cannot be written is refused where the file is opened; see tests/output_file_test.cpp.
        os.symlink("loop.npy", self.path("loop.npy"))
        os.mkfifo(self.path("pipe"))
        for path, *parts in ((self.path("nowhere", "W.npy"),), ("", "file"), (self.path("loop.npy"),),
                             (self.path("pipe"), "file"), ("/dev/null", "file")):
            # Were the run begun before the output is looked at, the test would time out.
            self.refuses({"output": path, "time": "100000000"}, "--output", path, *parts, timeout=20)
        self.assertTrue(stat.S_ISCHR(os.stat("/dev/null").st_mode))
        # The file for an interrupted run is looked at before the run, too.
        os.mkdir(self.path("out", "W.interrupted.npy"))
        self.refuses({"output": self.output}, "--output", self.path("out", "W.interrupted.npy"), "file")

    @unittest.skipIf(SANITIZED, "a sanitizer reserves terabytes of address space")
    def test_a_run_that_needs_more_memory_than_there_is(self):
        # About 0.6 GB for 548 matrices of 257 x 257; past steps of the predictor are counted.
        huge = {**SHORT, "n": "257", "stages": "20", "formulation": "algebra", "output": self.output}
        for kilobytes, changes, *parts in (
                (100_000_000, {"n": "4096"}, "--n 4096", "algebra20", "GB", "n or stages must be smaller"),
                (500_000, {}, "--n 257", "ulimit -v"),
                # More than 0.4 GB, and OpenBLAS's buffers leave at most 0.3 GB of the limit in any release.
                (500_000, {"n": "513", "stages": "3", "solver": "fast"}, "--n 513", "fast_algebra3", "ulimit -v")):
            script = f'ulimit -v {kilobytes}; OPENBLAS_NUM_THREADS=1 exec "$@"'
            with self.subTest(changes=changes):
                self.assert_refused(run(["bash", "-c", script, "bash", *command({**huge, **changes})]), *parts)

    @unittest.skipIf(SANITIZED, "a sanitizer reserves terabytes of address space")
    def test_an_address_space_too_small_for_openblas(self):
        # OpenBLAS tries for ever to get its buffers: a run that got that far would time out. Release 0.3.21 takes 134
        # MB at the first product, 0.3.29 takes 134 MB more when it is loaded.
        codes = {}
        for kilobytes in (120_000, 150_000, 180_000, 220_000, 250_000, 300_000, 400_000, 600_000):
            for threads in ("", "OPENBLAS_NUM_THREADS=1", "OPENBLAS_NUM_THREADS=2", "--ignore-signal=CHLD"):
                script = f'ulimit -v {kilobytes}; exec env {threads} "$@"'
                line = command(SHORT, n="9", stages="1", formulation="algebra", time="0.2")
                done = run(["bash", "-c", script, "bash", *line])
                codes[kilobytes] = done.returncode
                with self.subTest(kilobytes=kilobytes, threads=threads):
                    if done.returncode != DONE:
                        self.assert_refused(done, "OpenBLAS", "MB", "ulimit -v")
        self.assertEqual((codes[120_000], codes[600_000]), (BAD_ARGUMENTS, DONE))


def npy_bytes(W, version=(1, 0)):
    file = io.BytesIO()
    numpy.lib.format.write_array(file, W, version)
    return file.getvalue()


class InitialData(IntegrateTest):
    """--initial W.npy."""

    def test_a_run_goes_on_from_its_own_output(self):
        for solver in ("published", "fast"):
            with self.subTest(solver=solver):
                _, whole = self.result(WHOLE, solver=solver)
                _, half = self.result(WHOLE, solver=solver, time="2.5")
                result, W = self.result(WHOLE, solver=solver, time="2.5", initial=self.write("W0.npy", npy_bytes(half)))
                self.assert_agrees(W, whole, 1e-12 * numpy.abs(whole).max())
                self.assertEqual((result["scene"], result["modes_hash"], result["steps"]), ("initial", None, 25))
                self.assertLess(result["skew_defect"], 1e-13)

    def test_every_layout_is_read_as_it_is_meant(self):
        W = reference("W0_n17.csv")
        for contents in (npy_bytes(W), npy_bytes(W, (2, 0)), npy_bytes(numpy.asfortranarray(W))):
            self.assert_same(self.result(SHORT, time="0", initial=self.write("W0.npy", contents))[1], W)
        first, second, third = b"'descr': '<c16', ", b"'fortran_order': False, ", b"'shape': (17, 17), "
        for keys in (third + first + second, second + third[:-2] + b", " + first, first + third + second[:-2] + b"  "):
            contents = npy_bytes(W).replace(first + second + third, keys)
            self.assertNotEqual(contents, npy_bytes(W))
            self.assert_same(self.result(SHORT, time="0", initial=self.write("W0.npy", contents))[1], W)

    def test_what_is_refused(self):
        W = reference("W0_n17.csv")
        good = npy_bytes(W)
        for contents, *parts in (
                (b"", "empty"), (b"l,m,re,im\n", "not a .npy file"), (good[:7], "not a .npy file"),
                (npy_bytes(W, (3, 0)), "format 3"), (good.replace(b"False", b"Maybe"), "header"), (good[:60], "header"),
                (good.replace(b"'fortran_order': False, ", b"'spare_order__': False, "), "header"),
                (good.replace(b", }    ", b",'a':1}"), "header"), (good.replace(b"(17, 17)", b"(17, 17,"), "header"),
                (npy_bytes(W.astype(">c16")), "'>c16'", "'<c16'"),
                (npy_bytes(W.view([("W", "<c16")])), "[('W','<c16')]"),
                (npy_bytes(W[:-1]), "(16,17)", "(17,17)"), (npy_bytes(W.ravel()), "(289,)"),
                (good[:-1], "4623 bytes", "4624"), (good + b"\0", "4625 bytes", "4624"),
                # More matrices that are none: tests/scene_test.cpp.
                (npy_bytes(0 * W), "all entries are 0"), (npy_bytes(W * numpy.nan), "finite"),
                (npy_bytes(1j * W), "skew-Hermitian", "is 2 of")):
            path = self.write("W0.npy", contents)
            self.refuses({"initial": path}, "--initial", path, *parts)
        self.refuses({"initial": self.path("nowhere.npy")}, "--initial", "cannot be read")


class GoodRuns(IntegrateTest):
    def test_json_repeats_what_was_asked_and_holds_every_promised_key(self):
        result, _ = self.result(SHORT, tolerance="1e-12")
        self.assertEqual(set(os.listdir(self.folder)), {"W.npy", "out"})
        self.assertLessEqual(PROMISED_KEYS, set(result))
        asked = {"n": 17, "stages": 2, "formulation": "group", "step": 0.1, "steps": 5, "tolerance": 1e-12,
                 "converged": True, "status": "converged"}
        self.assertEqual({key: result[key] for key in asked}, asked)
        self.assertNotIn("failed_step", result)
        for key, value in result.items():
            self.assertIsInstance(value, (str, bool, int, float), key)
            self.assertTrue(not isinstance(value, float) or math.isfinite(value), key)

    def test_text_says_what_the_json_says(self):
        result, _ = self.result(SAME_PRODUCTS)
        text = run(command(SAME_PRODUCTS))
        self.assertEqual(text.returncode, DONE)
        shown = dict(line.split(None, 1) for line in text.stdout.splitlines())
        self.assertEqual(list(shown), list(result))
        for key in ("n", "formulation", "steps", "status", "sweeps_total", "products", "modes_hash"):
            self.assertEqual(shown[key], str(result[key]))

    def test_both_solvers_agree_with_the_references_and_keep_the_invariants_the_fast_one_with_less_work(self):
        for stages in ("1", "2", "3"):
            answer = reference(f"W_t5_h0.1_n17_s{stages}.csv")
            for formulation in FORMULATIONS:
                with self.subTest(stages=stages, formulation=formulation):
                    found = {}
                    for solver in ("published", "fast"):
                        found[solver], W = self.result(WHOLE, stages=stages, formulation=formulation, solver=solver)
                        self.assert_agrees(W, answer)
                        self.assertEqual(found[solver]["solver"], solver)
                        for error, bound in (("spectrum_error", 1e-11), ("skew_defect", 1e-13), ("energy_error", 1e-3)):
                            self.assertLessEqual(found[solver][error], bound)
                    fast = found["fast"]
                    self.assertLess(fast["sweeps_total"], found["published"]["sweeps_total"])
                    self.assertLess(fast["equivalent_products"], fast["products"])
                    self.assertEqual(fast["skew_defect"], 0.0)

    def test_no_time_gives_the_initial_vorticity(self):
        result, W = self.result(SHORT, time="0")
        self.assert_agrees(W, reference("W0_n17.csv"), 1e-14)
        self.assertEqual((result["steps"], result["sweeps_total"]), (0, 0))

    def test_both_product_backends_agree(self):
        eigen, W_eigen = self.result(WHOLE, products="eigen")
        openblas, W_openblas = self.result(WHOLE, products="openblas")
        self.assert_agrees(W_eigen, W_openblas)
        self.assertEqual((eigen["product_backend"], openblas["product_backend"]), ("eigen", "openblas"))

    def test_other_scenes_give_other_answers_and_the_default_one_by_its_name_or_from_a_file_the_same(self):
        smooth, W = self.result(SAME_PRODUCTS)
        modes = self.write("modes.csv", MODES)
        for changes, scene in (({"hbar": "standard"}, "smooth"), ({"modes": modes}, "modes"),
                               ({"scene": "rough"}, "rough")):
            result, other = self.result(SAME_PRODUCTS, **changes)
            self.assertGreater(numpy.abs(other - W).max(), 1e-6)
            self.assertEqual((result["scene"], result["modes_hash"] == smooth["modes_hash"]),
                             (scene, scene == "smooth"))
            self.assertLess(result["spectrum_error"], 1e-11)
        for changes in ({"scene": "smooth"}, {"modes": os.path.join(DATA, "initial_modes.csv")}):
            result, same = self.result(SAME_PRODUCTS, **changes)
            self.assert_same(same, W)
            self.assertEqual(result["modes_hash"], smooth["modes_hash"])

    def test_the_smallest_n_run_with_modes_of_their_own_or_the_rough_scene(self):
        modes = self.write("modes.csv", "l,m,re,im\n1,0,1,0\n1,1,0.5,-0.25\n")
        for changes in ({"modes": modes}, {"scene": "rough"}):
            result, W = self.result(SHORT, n="2", **changes)
            self.assertEqual((W.shape, result["converged"]), ((2, 2), True))

    def test_a_formulation_by_its_name_is_the_same_method(self):
        for solver in ({"solver": "fast"}, {"products": "openblas"}):
            named, named_W = self.result(NAMED, integrator="group2", **solver)
            chosen, W = self.result(SHORT, **solver)
            self.assert_same(named_W, W)
            for key in ("integrator", "stages", "sweeps_total"):
                self.assertEqual(named[key], chosen[key])
        self.assertEqual(self.result(SHORT, solver="fast")[0]["threads"], 1)

    def test_other_integrators_have_a_fast_form_and_an_explicit_one_takes_no_sweeps(self):
        for name in ("suzuki4", "rkmk4"):
            published, W = self.result(NAMED, integrator=name)
            _, fast = self.result(NAMED, integrator=name, solver="fast")
            self.assert_agrees(fast, W)
        self.assertEqual((published["sweeps_total"], published["formulation"]), (0, None))

    def test_exponential_methods_and_projections_keep_the_spectrum_at_any_tolerance(self):
        for name in EXPONENTIAL:
            for scene, solver in (("smooth", "published"), ("rigid_body", "published"), ("smooth", "fast")):
                with self.subTest(name=name, scene=scene, solver=solver):
                    result, _ = self.result(NAMED, integrator=name, scene=scene, solver=solver, tolerance="1e-3")
                    self.assertLess(result["spectrum_error"], 1e-13)
                    self.assertEqual(result["sweeps_total"] > 0, name.startswith("elp"))
        self.assertGreater(self.result(NAMED, integrator="group2", tolerance="1e-3")[0]["spectrum_error"], 1e-9)

    def test_the_seconds_of_steps_leave_out_what_watching_takes(self):
        """At n = 5 a step of RK4 takes twice as long as the energy after it: steps have 0.64 of the process's time."""
        before = cpu_seconds_of_children()
        seconds = self.result(NAMED, n="5", integrator="rk4", step="1e-4", time="10")[0]["seconds"]
        self.assertLess(seconds, 0.85 * (cpu_seconds_of_children() - before))

    def test_help_explains_every_argument(self):
        done = run([program("integrate"), "--help"])
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        for argument in (*SHORT, "tolerance", "max-sweeps", "hbar", "products", "modes", "output", "json"):
            self.assertIn(f"--{argument}", done.stdout)

    def test_an_answer_that_could_not_be_printed_is_no_success(self):
        self.assertNotEqual(run_on_full_disk(command(SHORT, "--json")).returncode, DONE)


class Notes(IntegrateTest):
    """A line before the run, which goes on."""

    def test_a_step_longer_than_any_that_worked_everywhere(self):
        rk4 = {"stages": None, "formulation": None, "integrator": "rk4", "n": "17", "step": "1", "time": "1"}
        done = run(command(SHORT, **rk4))
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assert_one_line(done.stderr, "integrate: note", "h_norm_B = 1.4", "published form of rk4",
                             "results/README.md")
        self.assert_one_line(run(command(SHORT, solver="fast", **rk4)).stderr, "fast form of rk4")
        for lines, changes in ((2, {"step": "5", "time": "5"}),  # fails: both are named
                               (0, {"step": "0.5"}), (0, {"step": "0.5", "scene": "rough"}),
                               (0, {**rk4, "step": "0.1", "time": "0.1"}),
                               (0, {**rk4, "n": "129", "solver": "published"}),  # beyond the recorded n of this form
                               (1, {"n": "65", "stages": "7", "step": "5", "time": "5"})):  # which was not tried
            errors = run(command(SHORT, **changes)).stderr.splitlines()
            self.assertEqual([line[:11] for line in errors], ["integrate: "] * lines, changes)

    def test_more_threads_than_cores(self):
        core = str(min(os.sched_getaffinity(0)))
        done = run(["taskset", "-c", core, *command(SHORT, "--json", solver="fast", threads="2")])
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertRegex(done.stderr, r"^integrate: note: 2 threads on 1 core: [^\n]*\n$")


@unittest.skipIf(SANITIZED, "a sanitizer's threads take times of their own, and busy processes slow all other tests")
class Threads(IntegrateTest):
    """Threads that wait for work sleep, so that on a busy machine they take no more time than they work."""

    MAXIMUM = 3.0  # CPU time of two threads over that of one, beside one busy process on each core

    def setUp(self):
        super().setUp()
        cores = os.sched_getaffinity(0)
        if len(cores) < 2:
            self.skipTest("on one core OpenMP does not spin")
        for core in cores:
            busy = start([sys.executable, "-c", f"import os\nos.sched_setaffinity(0, [{core}])\n"
                          "parent = os.getppid()\nwhile os.getppid() == parent: pass"],
                         stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            self.addCleanup(end, busy)

    @staticmethod
    def line(threads):
        # Of this size, since waking a thread takes a time of its own. At n = 129, where all takes 30 ms, two threads
        # take up to 3.3 times the time of one on a fast processor, however shortly they spin; here 1.2 to 1.6.
        return command({**NAMED, "n": "257", "step": "0.1", "time": "0.2", "integrator": "group2"}, "--json",
                       solver="fast", threads=threads)

    def seconds(self, threads, **settings):
        """Returns the CPU time of the steps of a run."""
        done = run(self.line(threads), env=environment(**settings), timeout=120)
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        return strict_json(done.stdout)["seconds"]

    def test_two_threads_beside_busy_processes(self):
        # In turns: the least of several is what a run takes when nobody disturbs it further. Three are enough.
        one, two, passive = [], [], []
        while len(one) < 3 and (not one or max(min(two), min(passive)) >= self.MAXIMUM * min(one)):
            one.append(self.seconds("1"))
            two.append(self.seconds("2"))
            passive.append(self.seconds("2", OMP_WAIT_POLICY="passive"))
        self.assertLess(min(two), self.MAXIMUM * min(one))
        self.assertLess(min(passive), self.MAXIMUM * min(one))  # what is asked for is done
        # Since a step is one parallel region, the setting of OpenMP's spins no longer decides this. The control, a
        # thread that is held up, is in tests/parallel_test.cpp.


class FailedRuns(IntegrateTest):
    """Exit 3, one line on stderr that says which step and how, one JSON object, and no output file.

    Before it stands the note on a step beyond the measured limit, where it is (see Notes).
    """

    def assert_fails(self, status, **changes):
        with self.unchanged():
            done = run(command(SHORT, "--json", "--output", self.output, **changes))
        self.assertEqual(done.returncode, SOLVER_FAILED, done.stderr)
        result = strict_json(done.stdout)
        self.assertLessEqual(PROMISED_KEYS, set(result))
        self.assertIs(result["converged"], False)
        self.assertEqual(result["status"], status)
        self.assertGreaterEqual(result["failed_step"], 1)
        note, _, failure = done.stderr.rpartition("; see results/README.md\n")
        self.assertEqual(note.count("\n"), 0)
        self.assertEqual(note.startswith("integrate: note: h_norm_B"), bool(note))
        self.assert_one_line(failure, status, f"step {result['failed_step']}", "last change")
        return result

    def test_a_step_far_too_long_diverges(self):
        for formulation in FORMULATIONS:
            with self.subTest(formulation=formulation):
                self.assert_fails("diverged", formulation=formulation, step="20", time="20")
                if not SANITIZED:  # n = 129 takes too long when sanitised
                    self.assert_fails("diverged", formulation=formulation, n="129", step="0.4", time="4")
        self.assertEqual(self.assert_fails("diverged", n="33", step="2", time="4", solver="fast")["failed_step"], 1)
        self.assert_fails("diverged", **{**NAMED, "n": "33", "step": "4", "time": "400"}, integrator="rk4")
        for name in ("elp2", "elp6", "magnus4", "magnus5"):
            self.assert_fails("diverged", **{**NAMED, "step": "200", "time": "200"}, integrator=name)

    def test_a_change_that_is_not_a_number_has_no_sign(self):
        result = self.assert_fails("diverged", **{**SHORT, "step": "1e200", "time": "1e200"})
        done = run(command({**SHORT, "step": "1e200", "time": "1e200"}))
        self.assertIsNone(result["last_change"])
        self.assertRegex(done.stdout, r"(?m)^last_change +not finite$")
        self.assertIn("last change not finite;", done.stderr)

    def test_too_few_sweeps_end_as_sweep_cap(self):
        for formulation in FORMULATIONS:
            result = self.assert_fails("sweep cap", formulation=formulation, max_sweeps="3")
            self.assertEqual(result["sweeps_total"], 3)
        self.assert_fails("sweep cap", **NAMED, integrator="elp4", max_sweeps="3")
        self.assertIn("failed_step", run(command(SHORT, max_sweeps="3")).stdout)  # as text too


def has_handler(process, number):
    """Tells whether a process handles a signal by now."""
    with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
        handled = next(line for line in status if line.startswith("SigCgt:"))
    return bool(int(handled.split()[1], 16) >> (number - 1) & 1)


def wait_for(condition, what, seconds=30):
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError(f"{what}: not in {seconds} seconds")
        time.sleep(0.005)


class Interrupted(IntegrateTest):
    """A run that a signal ends says how far it came, and keeps its last state where there is an --output."""

    LONG = {**SAME_PRODUCTS, "time": "100000"}  # hours
    KEPT = "W.interrupted.npy"

    def interrupted(self, number, *flags, pause=0.2, **changes):
        """Returns exit status, stdout and stderr of a run that gets a signal once it has begun."""
        process = start(command(self.LONG, *flags, **changes), stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(end, process)
        wait_for(lambda: has_handler(process, number), "the run")
        time.sleep(pause)
        process.send_signal(number)
        output, errors = process.communicate(timeout=20)
        return process.returncode, output, errors

    def test_the_last_state_is_that_of_the_steps_done(self):
        for number, solver in ((signal.SIGINT, {}), (signal.SIGTERM, {"solver": "fast", "products": None})):
            with self.subTest(signal=number):
                status, output, errors = self.interrupted(number, "--json", "--output", self.output, **solver)
                self.assertEqual(status, 128 + number, errors)
                result = strict_json(output)
                done = result["steps_done"]
                self.assertEqual((result["converged"], result["status"], result["steps"]),
                                 (False, "interrupted", 1000000))
                self.assertNotIn("failed_step", result)
                self.assertTrue(0 < done < 1000000)
                self.assertAlmostEqual(result["time_done"], 0.1 * done, delta=1e-9 * done)
                kept = self.path("out", self.KEPT)
                self.assert_one_line(errors, f"after step {done} of 1000000, t = {done / 10:g}", kept,
                                     f"--time {(1000000 - done) / 10:.10g} is left")
                self.assertEqual(set(os.listdir(self.path("out"))), {"W.npy", self.KEPT})
                with open(self.output, encoding="utf-8") as file:
                    self.assertEqual(file.read(), EARLIER)
                _, W = self.result(self.LONG, time=f"{done / 10:.1f}", **solver)
                self.assert_same(numpy.load(kept), W)
                # What is left begins from there.
                self.result(NAMED, integrator="group2", initial=kept)
                os.unlink(kept)

    @unittest.skipIf(SANITIZED, "n > 33 takes too long")
    def test_a_long_step_ends_at_its_next_sweep(self):
        one_step = {"n": "513", "stages": "3", "step": "0.02", "time": "0.02", "tolerance": "1e-15"}
        status, output, errors = self.interrupted(signal.SIGINT, "--json", "--output", self.path("W"), pause=0,
                                                  **one_step)
        self.assertEqual((status, strict_json(output)["steps_done"]), (130, 0), errors)
        self.assert_one_line(errors, "after step 0 of 1", "t = 0;", self.path(self.KEPT))
        _, initial = self.result(self.LONG, **{**one_step, "time": "0"})
        self.assert_same(numpy.load(self.path(self.KEPT)), initial)

    def test_without_an_output_nothing_is_written(self):
        with self.unchanged():
            status, output, errors = self.interrupted(signal.SIGTERM)
        self.assertEqual(status, 143)
        self.assertRegex(output, r"\nstatus +interrupted\n")
        self.assert_one_line(errors, "interrupted after step", "nothing written", "--output")

    def test_what_was_ignored_at_the_start_stays_ignored(self):
        def in_background():
            default_signals()
            signal.signal(signal.SIGINT, signal.SIG_IGN)

        with subprocess.Popen(command(self.LONG), preexec_fn=in_background, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE) as process:
            wait_for(lambda: has_handler(process, signal.SIGTERM), "the run")
            process.send_signal(signal.SIGINT)
            time.sleep(0.2)
            self.assertIsNone(process.poll())
            process.send_signal(signal.SIGTERM)
            self.assertEqual(process.wait(timeout=20), 143)


class Terminal(IntegrateTest):
    """Progress on stderr where that is a terminal."""

    LINE = (r"step [0-9]+ of 1000000 \([0-9]+ %\), t = [0-9.e+]+, energy 0\.[0-9]+, [0-9.]+ sweeps a step,"
            r" about [0-9a-z ]+ left")

    def seen(self, *flags, lines=0, **streams):
        """Returns what a terminal shows of a run that gets Ctrl-C after so many lines, and after half a second."""
        terminal, stderr = open_terminal(self)
        process = start(command(Interrupted.LONG, *flags), stderr=stderr, **streams)
        self.addCleanup(end, process)
        os.close(stderr)
        wait_for(lambda: has_handler(process, signal.SIGINT), "the run")
        time.sleep(0.5)
        shown = b""
        while shown.count(b"\r") < lines:
            self.assertTrue(select.select([terminal], [], [], 60)[0], f"no line {lines}: {shown}")
            shown += os.read(terminal, 4096)
        process.send_signal(signal.SIGINT)
        while True:
            try:
                shown += os.read(terminal, 4096)
            except OSError:  # the other end is closed
                break
        os.close(terminal)
        self.assertEqual(process.wait(timeout=20), 130)
        return shown.decode()

    def test_a_line_is_rewritten_a_few_times_a_second_and_gone_at_the_end(self):
        begun = time.monotonic()
        shown = self.seen(lines=4, stdout=subprocess.DEVNULL)
        first, *lines = shown.split("\r\x1b[K")
        self.assertEqual(first, "")
        self.assertRegex(lines[0], r"^step 0 of 1000000 \(0 %\), t = 0, energy 0\.[0-9]+$")
        self.assertLessEqual(len(lines), 4 * (time.monotonic() - begun) + 3)
        for line in lines[1:-1]:
            self.assertRegex(line, rf"^{self.LINE}$")
        self.assertRegex(lines[-1], r"^integrate: interrupted [^\r\n]*\r\n$")

    def test_nothing_beside_an_object_for_another_program(self):
        shown = self.seen("--json", stdout=subprocess.DEVNULL)
        self.assertRegex(shown, r"^integrate: interrupted [^\r\n]*\r\n$")


if __name__ == "__main__":
    unittest.main()
