"""Tests of build/benchmarks/integrate from outside: what it refuses, what it answers, and how it fails.

Run with: python3 -m unittest discover -s tests/scripts
"""

import csv
import math
import os
import signal
import stat
import struct
import subprocess
import unittest

from programs import (DATA, DONE, FORMULATIONS, SANITIZED, SOLVER_FAILED, FolderTest, end, program, read_npy, run,
                      snapshot, start, strict_json)

# The project's answers must agree with the references to 1e-11; see tests/data.
TOLERANCE = 1e-11
SHORT = {"n": "17", "stages": "2", "formulation": "group", "step": "0.1", "time": "0.5"}
# For answers compared bit for bit: which backend is the fastest, two runs may find differently.
SAME_PRODUCTS = {**SHORT, "products": "openblas"}
WHOLE = {**SHORT, "time": "5"}
DIVERGING = {**SHORT, "n": "129", "step": "0.4", "time": "4"}
PROMISED_KEYS = {"n", "stages", "formulation", "step", "steps", "tolerance", "converged", "status", "sweeps_total",
                 "products", "seconds", "spectrum_error", "skew_defect", "energy_error"}
EARLIER = "an earlier result"


def command(arguments, *flags, **changes):
    """Returns a command line; a change to None drops the argument, and max_sweeps stands for --max-sweeps."""
    line = [program("integrate")]
    for name, value in {**arguments, **changes}.items():
        if value is not None:
            line += ["--" + name.replace("_", "-"), value]
    return line + list(flags)


def read_reference(name):
    """Returns the rows of a reference matrix, given as CSV lines i,j,re,im."""
    with open(os.path.join(DATA, name), newline="", encoding="utf-8") as stream:
        entries = {(int(row["i"]), int(row["j"])): complex(float(row["re"]), float(row["im"]))
                   for row in csv.DictReader(stream)}
    n = 1 + max(i for i, _ in entries)
    return [[entries[i, j] for j in range(n)] for i in range(n)]


def distance(W, other):
    """Returns the largest entry of the difference of two matrices; infinite for one of another shape or with a NaN."""
    if [len(row) for row in W] != [len(row) for row in other]:
        return math.inf
    entries = [abs(a - b) for row, other_row in zip(W, other) for a, b in zip(row, other_row)]
    return math.inf if any(map(math.isnan, entries)) else max(entries)


class IntegrateTest(FolderTest):
    def result(self, arguments, *flags, **changes):
        """Runs to the end and returns the JSON object and W."""
        output = self.path("W.npy")
        done = run(command(arguments, "--json", "--output", output, *flags, **changes))
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertEqual(done.stderr, "")
        return strict_json(done.stdout), read_npy(output)

    def assert_agrees(self, W, reference, tolerance):
        self.assertLessEqual(distance(W, reference), tolerance)


class RefusalTest(IntegrateTest):
    """Every refusal stands beside an earlier output file, which must stay as it was, alone in its folder."""

    def setUp(self):
        super().setUp()
        self.output = self.write("out/W.npy", EARLIER)

    def assert_refused_alone(self, line, *parts):
        before = snapshot(self.folder)
        self.assert_refused(run(line), *parts)
        self.assertEqual(snapshot(self.folder), before)


class RefusedArguments(RefusalTest):
    def refuses(self, argument, values, *allowed):
        for value in values:
            with self.subTest(argument=argument, value=value):
                line = command(SHORT, "--output", self.output, **{argument: value})
                self.assert_refused_alone(line, "--" + argument.replace("_", "-"), value, *allowed)

    CASES = (
        ("n", ("x", "17.0", "0x11", " 17", "", "-3", "1", "4097", "9" * 30), "2 to 4096"),
        ("stages", ("0", "-1", "21", "2.5", "1e0"), "1 to 20"),
        ("step", ("0", "-0", "-0.1", "nan", "inf", "0.1x", "1e400"), "positive and finite"),
        ("time", ("-0.1", "nan", "inf", "x"), "0 or positive, and finite"),
        ("time", ("0.55", "0.5001"), "whole number"), ("time", ("1e+300",), "at most"),
        ("tolerance", ("0", "nan", "inf", "9.99e-16", "x"), "at least 1e-15"),
        ("max_sweeps", ("0", "2.5", "9" * 30), "1 to "), ("formulation", ("quotient", "Group", ""), *FORMULATIONS),
        ("hbar", ("planck", "Paper"), "paper", "standard"), ("products", ("abacus", "Eigen"), "fastest", "openblas", "eigen"),
    )

    def test_values(self):
        for argument, values, *allowed in self.CASES:
            self.refuses(argument, values, *allowed)

    def test_what_is_missing_twice_or_unknown_is_named(self):
        for flags, part in ((("--tolerance",), "--tolerance"), (("--n", "33"), "--n"), (("--jso",), "--jso"), (("-x",), "-x"),
                            (("--stepsize=3",), "--stepsize"), (("perhaps",), "perhaps")):
            self.assert_refused_alone(command(SHORT, "--output", self.output, *flags), part)
        for argument in SHORT:
            self.assert_refused_alone(command(SHORT, "--output", self.output, **{argument: None}), f"--{argument} ")

    def test_what_does_not_go_together_or_is_no_choice(self):
        modes = self.write("modes.csv", "l,m,re,im\n2,0,1,0\n2,1,0.5,0\n")
        named = {"stages": None, "formulation": None}
        for changes, *parts in (
                *(({"n": n}, f"--n {n}", "n >= 5", "--modes", "--initial") for n in ("2", "4")),
                *(({"scene": scene}, "--scene", scene) for scene in ("calm", "", "Smooth")),
                ({"modes": modes, "scene": "rough"}, "--modes", "--scene", "one of them"),
                ({"initial": "W.npy", "scene": "rough"}, "--initial", "--scene", "one of them"),
                ({"initial": "W.npy", "modes": modes}, "--initial", "--modes", "one of them"),
                ({**named, "integrator": "euler"}, "--integrator 'euler'", "rkmk4", "group2"),
                *(({**named, "integrator": "rk4", other: SHORT[other]}, "--integrator", "must stand alone")
                  for other in named),
                *(({"solver": solver}, "--solver", "published", "fast") for solver in ("quick", "", "Fast")),
                ({**named, "solver": "fast", "integrator": "algebra2_two_products"}, "algebra2_two_products", "no fast form"),
                ({"solver": "fast", "products": "eigen"}, "--solver fast", "--products eigen"),
                ({"threads": "2"}, "--threads 2", "--solver fast"),
                *(({"solver": "fast", "threads": value}, "--threads", value, "1 to 64")
                  for value in ("0", "-1", "65", "x", "1.5", "", "9" * 30))):
            with self.subTest(changes=changes):
                self.assert_refused_alone(command(SHORT, "--output", self.output, **changes), *parts)


class BeyondTheMeasuredLimit(FolderTest):
    """A note before the run where its step is longer than any that worked everywhere."""

    def noted(self, **changes):
        done = run(command(SHORT, **changes))
        for line in done.stderr.splitlines():
            self.assertTrue(line.startswith("integrate: "), line)
        return done

    def test_a_step_beyond_it_is_noted_and_the_run_goes_on(self):
        done = self.noted(n="33", step="0.6", time="0.6")
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assert_one_line(done.stderr, "note", "h_norm_B = 1.52", "group2", "results/README.md")

    def test_notes_beside_other_ends(self):
        for lines, changes in ((2, {"step": "5", "time": "5"}),  # fails: both are named
                               (0, {"step": "0.5"}), (0, {"step": "0.5", "scene": "rough"}),
                               (1, {"stages": "7", "step": "5", "time": "5"})):  # was not mapped, and is not judged
            self.assertEqual(len(self.noted(**changes).stderr.splitlines()), lines, changes)


class NamedScene(RefusalTest):
    """--scene NAME."""

    def test_rough_is_another_scene_and_keeps_its_spectrum(self):
        rough, rough_W = self.result(SAME_PRODUCTS, scene="rough")
        smooth, W = self.result(SAME_PRODUCTS)
        self.assertEqual((self.result(SAME_PRODUCTS, scene="smooth")[1], smooth["scene"]), (W, "smooth"))  # the default
        self.assertNotEqual(rough_W, W)
        self.assertNotEqual(rough["modes_hash"], smooth["modes_hash"])
        self.assertEqual(rough["scene"], "rough")
        self.assertLess(rough["spectrum_error"], 1e-11)
        for n in ("2", "3", "4"):
            self.assertTrue(self.result(SHORT, scene="rough", n=n)[0]["converged"])

    def test_modes_are_a_scene_of_their_own(self):
        modes = self.write("modes.csv", "l,m,re,im\n2,0,1,0\n2,1,0.5,0\n")
        self.assertEqual(self.result(SHORT, modes=modes)[0]["scene"], "modes")


class NamedIntegrator(RefusalTest):
    """--integrator NAME in place of --formulation and --stages."""

    NAMED = {**SHORT, "stages": None, "formulation": None}

    def test_a_formulation_by_its_name_is_the_same_method(self):
        named, named_W = self.result(self.NAMED, integrator="group2", products="openblas")
        chosen, W = self.result(SAME_PRODUCTS)
        self.assertEqual(named_W, W)
        self.assertEqual((named["integrator"], named["stages"]), (chosen["integrator"], chosen["stages"]))

    def test_an_explicit_method_takes_no_sweeps(self):
        result, _ = self.result(self.NAMED, integrator="rkmk4")
        self.assertEqual((result["sweeps_total"], result["formulation"]), (0, None))
        self.assertLess(result["spectrum_error"], 1e-13)

    def test_an_explicit_run_that_explodes_diverges(self):
        line = command({**self.NAMED, "n": "33", "step": "4", "time": "400"}, "--output", self.output,
                       integrator="rk4")
        before = snapshot(self.folder)
        done = run(line)
        self.assertEqual(done.returncode, SOLVER_FAILED)
        self.assertIn("diverged at step", done.stderr)
        self.assertEqual(snapshot(self.folder), before)


class FastSolver(RefusalTest):
    """--solver fast."""

    def test_gives_the_published_answers_in_fewer_sweeps(self):
        for formulation in FORMULATIONS:
            for s in ("1", "2", "3"):
                with self.subTest(formulation=formulation, s=s):
                    plain, expected = self.result(WHOLE, formulation=formulation, stages=s)
                    fast, W = self.result(WHOLE, formulation=formulation, stages=s, solver="fast")
                    self.assert_agrees(W, expected, TOLERANCE)
                    self.assertLess(fast["sweeps_total"], plain["sweeps_total"])
                    self.assertLess(fast["equivalent_products"], fast["products"])
                    self.assertEqual((plain["solver"], fast["solver"]), ("published", "fast"))
                    self.assertEqual(fast["skew_defect"], 0.0)

    def test_goes_with_every_kind_of_name_and_has_one_thread(self):
        for name in ("rk4", "rkmk4", "suzuki4", "direct2"):
            _, published = self.result(SHORT, formulation=None, stages=None, integrator=name)
            _, fast = self.result(SHORT, solver="fast", formulation=None, stages=None, integrator=name)
            self.assert_agrees(fast, published, TOLERANCE)
        by_name, W_by_name = self.result(SHORT, solver="fast", formulation=None, stages=None, integrator="group2")
        by_formulation, W = self.result(SHORT, solver="fast", formulation="group", stages="2")
        self.assertEqual(W_by_name, W)
        self.assertEqual((by_name["sweeps_total"], by_name["threads"]), (by_formulation["sweeps_total"], 1))

    def test_a_diverging_run_ends_as_the_published_one_does(self):
        failed = run(command(DIVERGING, "--output", self.output, n="33", step="2", solver="fast"))
        self.assertEqual(failed.returncode, SOLVER_FAILED)
        self.assertIn("at step 1", failed.stderr)
        with open(self.output, encoding="utf-8") as file:
            self.assertEqual(file.read(), EARLIER)

    def test_more_threads_than_cores_are_allowed_and_noted(self):
        pinned = ["taskset", "-c", str(min(os.sched_getaffinity(0))), *command(SHORT, "--json", solver="fast", threads="2")]
        done = run(pinned)
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertRegex(done.stderr, r"^integrate: note: 2 threads on 1 core: [^\n]*\n$")


@unittest.skipIf(SANITIZED, "a sanitizer reserves terabytes of address space")
class Memory(RefusalTest):
    """A run that needs more memory than there is, which the kernel would kill, is refused before it starts."""

    HUGE = {"n": "4096", "stages": "20", "formulation": "algebra", "step": "0.1", "time": "0.1"}

    def limited(self, kilobytes, arguments, *flags, **changes):
        script = 'ulimit -v "$1"; shift; OPENBLAS_NUM_THREADS=1 exec "$@"'
        return run(["bash", "-c", script, "bash", str(kilobytes), *command(arguments, *flags, **changes)])

    def test_is_told_and_refused(self):
        # About 0.6 GB for 548 matrices of 257 x 257; past steps of the predictor are counted.
        for kilobytes, changes, *parts in (
                (100_000_000, {}, "--n 4096", "algebra20", "GB", "n or stages must be smaller"),
                (500_000, {"n": "257"}, "--n 257", "ulimit -v"),
                (300_000, {"n": "257", "stages": "3", "solver": "fast"}, "--n 257", "fast_algebra3", "ulimit -v")):
            with self.subTest(changes=changes):
                self.assert_refused(self.limited(kilobytes, {**self.HUGE, **changes}, "--output", self.output), *parts)


class RefusedModes(RefusalTest):
    """Modes files: the line names the file and what is wrong."""

    HEADER = "l,m,re,im\n"

    def refuses_modes(self, text, *parts):
        modes = self.write("modes.csv", text)
        line = command(SHORT, "--output", self.output, "--modes", modes)
        self.assert_refused_alone(line, "--modes", modes, *parts)

    def refuses_path(self, path, *parts):
        line = command(SHORT, "--output", self.output, "--modes", path)
        self.assert_refused_alone(line, "--modes", path, *parts)

    def test_paths(self):
        for path, *parts in ((self.path("nowhere.csv"), "cannot be read"), ("",), (self.path("out"), "directory"),
                             (os.path.join(self.output, "modes.csv"), "cannot be read")):
            self.refuses_path(path, *parts)

    def test_contents(self):
        # What is no line of four numbers is refused where the file is read; see tests/modes_file_test.cpp.
        for row, *parts in (
                ("2,0,1", "line 2"), *((f"{l},0,1,0", f"l={l}", "1 to n-1") for l in ("0", "-1", "17", "2147483647")),
                *((f"2,{m},1,0", f"m={m}", "0 to l") for m in ("-1", "3")),
                *((row, "l=2", "m=1", "finite") for row in ("2,1,nan,0", "2,1,0,-inf")),
                ("2,0,1,0.5", "l=2", "m=0", "0.5", "must be 0"), ("2,1,1,0\n3,0,1,0\n2,1,0.5,0", "l=2", "m=1", "twice"),
                ("2,0,0,0\n3,1,-0,0", "nonzero")):
            with self.subTest(row=row):
                self.refuses_modes(self.HEADER + row + "\n", *parts)

    def test_finite_values_whose_squares_are_not_are_used_or_refused_by_name(self):
        for value in ("1e200", "1e-320"):
            with self.subTest(value=value):
                modes = self.write("modes.csv", self.HEADER + f"2,1,{value},0\n")
                done = run(command(SHORT, "--json", "--modes", modes))
                if done.returncode == DONE:
                    energy_error = strict_json(done.stdout)["energy_error"]
                    self.assertTrue(isinstance(energy_error, float) and math.isfinite(energy_error), done.stdout)
                else:
                    self.assert_refused(done, "--modes", modes)


def npy_bytes(rows, descr="<c16", fortran_order=False, shape=None, version=1):
    """Returns a .npy file of complex numbers, its header as given."""
    header = repr({"descr": descr, "fortran_order": fortran_order, "shape": shape or (len(rows), len(rows[0]))})
    length = struct.pack("<H" if version == 1 else "<I", len(header) + 1)
    numbers = [part for row in rows for entry in row for part in (entry.real, entry.imag)]
    return (b"\x93NUMPY" + bytes((version, 0)) + length + header.encode() + b"\n"
            + struct.pack(f"<{len(numbers)}d", *numbers))


class InitialData(RefusalTest):
    """--initial W.npy."""

    def initial(self, contents):
        path = self.path("initial.npy")
        with open(path, "wb") as file:
            file.write(contents)
        return path

    def test_a_run_goes_on_from_its_own_output(self):
        for solver in ("published", "fast"):
            with self.subTest(solver=solver):
                _, whole = self.result(WHOLE, solver=solver)
                _, half = self.result(WHOLE, solver=solver, time="2.5")
                result, W = self.result(WHOLE, solver=solver, time="2.5", initial=self.initial(npy_bytes(half)))
                self.assert_agrees(W, whole, 1e-12 * max(abs(entry) for row in whole for entry in row))
                self.assertEqual((result["scene"], result["modes_hash"], result["steps"]), ("initial", None, 25))
                self.assertLess(result["skew_defect"], 1e-13)

    def test_every_layout_is_read_as_it_is_meant(self):
        W = read_reference("W0_n17.csv")
        columns = [list(column) for column in zip(*W)]
        for contents in (npy_bytes(W), npy_bytes(W, version=2), npy_bytes(columns, fortran_order=True)):
            self.assertEqual(self.result(SHORT, time="0", initial=self.initial(contents))[1], W)

    def test_what_is_refused(self):
        def changed(value):
            rows = [list(row) for row in W]
            rows[3][1] = value
            return npy_bytes(rows)

        W = read_reference("W0_n17.csv")
        good = npy_bytes(W)
        for contents, *parts in (
                (b"", "empty"), (b"l,m,re,im\n", "not a .npy file"), (good[:7], "not a .npy file"),
                (npy_bytes(W, version=3), "format 3"), (good.replace(b"False", b"Maybe"), "header"),
                (good.replace(b"}\n", b",\n"), "header"), (good.replace(b"{'", b"{{'"), "header"), (good[:60], "header"),
                (npy_bytes(W, descr="<f8"), "'<f8'", "'<c16'"),
                (npy_bytes(W, descr=">c16"), "'>c16'"), (npy_bytes(W, descr=[("W", "<c16")]), "dtype [('W','<c16')]"),
                (npy_bytes(W[:-1]), "(16,17)", "(17,17)"), (npy_bytes(W, shape=(289,)), "(289,)"),
                (npy_bytes(W, shape=(17, 17, 1)), "(17,17,1)"), (npy_bytes([[1j] * 33] * 33), "(33,33)"),
                (good[:-1], "4623 bytes", "4624"), (good + b"\0", "4625 bytes", "4624"),
                (changed(complex(math.nan, 1)), "entry (3, 1) is nan+1i"), (changed(complex(0, -math.inf)), "-infi"),
                (npy_bytes([[0j] * 17] * 17), "all entries are 0"), (changed(W[3][1] + 1e-6), "skew-Hermitian", "e-06"),
                (npy_bytes([[1j * entry for entry in row] for row in W]), "skew-Hermitian", "is 2 of")):
            with self.subTest(parts=parts):
                path = self.initial(contents)
                line = command(SHORT, "--output", self.output, initial=path)
                self.assert_refused_alone(line, "--initial", path, *parts)

    def test_paths(self):
        for path in (self.path("nowhere.npy"), self.folder, ""):
            line = command(SHORT, "--output", self.output, initial=path)
            self.assert_refused_alone(line, "--initial", "cannot be read")


class RefusedOutput(IntegrateTest):
    """Output paths that cannot be written are found before the run."""

    # Were the run begun before the path is looked at, the test would time out.
    ENDLESS = {**SHORT, "time": "100000000"}

    def refuses(self, path, *parts):
        before = snapshot(self.folder)
        self.assert_refused(run(command(self.ENDLESS, "--output", path), timeout=20), "--output", path, *parts)
        self.assertEqual(snapshot(self.folder), before)

    def test_paths(self):
        # What else cannot be written is refused where the file is opened; see tests/output_file_test.cpp.
        os.symlink("loop.npy", self.path("loop.npy"))
        os.mkfifo(self.path("pipe"))
        for path, *parts in ((self.path("nowhere", "W.npy"),), (self.folder, "file"), ("", "file"),
                             (self.path("W" * 300),), (self.path("loop.npy"),), (self.path("pipe"), "file"), ("/dev/null", "file")):
            self.refuses(path, *parts)
        self.assertTrue(stat.S_ISCHR(os.stat("/dev/null").st_mode))

    @unittest.skipIf(os.geteuid() == 0, "root writes everywhere")
    def test_what_is_read_only(self):
        os.mkdir(self.path("closed"), 0o555)
        self.refuses(self.path("closed", "W.npy"))
        os.chmod(self.write("W.npy", EARLIER), 0o444)
        self.refuses(self.path("W.npy"))


class GoodRuns(IntegrateTest):
    def test_json_repeats_what_was_asked_and_holds_every_promised_key(self):
        result, _ = self.result(SHORT, tolerance="1e-12")
        self.assertEqual(os.listdir(self.folder), ["W.npy"])
        self.assertLessEqual(PROMISED_KEYS, set(result))
        asked = {"n": 17, "stages": 2, "formulation": "group", "step": 0.1, "steps": 5, "tolerance": 1e-12,
                 "converged": True, "status": "converged"}
        self.assertEqual({key: result[key] for key in asked}, asked)
        self.assertNotIn("failed_step", result)
        for key, value in result.items():
            self.assertIsInstance(value, (str, bool, int, float), key)
            self.assertTrue(not isinstance(value, float) or math.isfinite(value), key)

    def test_invariants_are_kept(self):
        for formulation in FORMULATIONS:
            with self.subTest(formulation=formulation):
                result, _ = self.result(WHOLE, formulation=formulation)
                self.assertLessEqual(result["spectrum_error"], 1e-11)
                self.assertLessEqual(result["skew_defect"], 1e-13)
                self.assertLessEqual(result["energy_error"], 1e-3)

    def test_text_says_what_the_json_says(self):
        result, _ = self.result(SAME_PRODUCTS)
        text = run(command(SAME_PRODUCTS))
        self.assertEqual(text.returncode, DONE)
        shown = dict(line.split(None, 1) for line in text.stdout.splitlines())
        self.assertEqual(list(shown), list(result))
        for key in ("n", "formulation", "steps", "status", "sweeps_total", "products", "modes_hash"):
            self.assertEqual(shown[key], str(result[key]))

    def test_output_agrees_with_the_references(self):
        for stages in ("1", "2", "3"):
            reference = read_reference(f"W_t5_h0.1_n17_s{stages}.csv")
            for formulation in FORMULATIONS:
                with self.subTest(stages=stages, formulation=formulation):
                    _, W = self.result(WHOLE, stages=stages, formulation=formulation)
                    self.assert_agrees(W, reference, TOLERANCE)

    def test_no_time_gives_the_initial_vorticity(self):
        reference = read_reference("W0_n17.csv")
        for formulation in FORMULATIONS:
            with self.subTest(formulation=formulation):
                result, W = self.result(SHORT, formulation=formulation, time="0")
                self.assert_agrees(W, reference, 1e-14)
                self.assertEqual((result["steps"], result["sweeps_total"]), (0, 0))

    def test_both_product_backends_agree(self):
        eigen, W_eigen = self.result(WHOLE, products="eigen")
        openblas, W_openblas = self.result(WHOLE, products="openblas")
        self.assert_agrees(W_eigen, W_openblas, TOLERANCE)
        self.assertEqual((eigen["product_backend"], openblas["product_backend"]), ("eigen", "openblas"))

    def test_the_other_hbar_and_other_modes_give_other_answers_and_the_default_ones_from_a_file_the_same(self):
        default, W = self.result(SAME_PRODUCTS)
        _, other = self.result(SAME_PRODUCTS, hbar="standard")
        self.assertGreater(distance(other, W), 1e-6)
        modes = self.write("modes.csv", "l,m,re,im\n1,0,1,0\n2,1,0.5,0.5\n")
        result, other = self.result(SAME_PRODUCTS, modes=modes)
        self.assertGreater(distance(other, W), 1e-6)
        self.assertNotEqual(result["modes_hash"], default["modes_hash"])
        result, same = self.result(SAME_PRODUCTS, modes=os.path.join(DATA, "initial_modes.csv"))
        self.assertEqual((same, result["modes_hash"]), (W, default["modes_hash"]))

    def test_the_smallest_n_runs_with_modes_of_its_own(self):
        modes = self.write("modes.csv", "l,m,re,im\n1,0,1,0\n1,1,0.5,-0.25\n")
        for formulation in FORMULATIONS:
            _, W = self.result(SHORT, n="2", formulation=formulation, modes=modes)
            self.assertEqual([len(row) for row in W], [2, 2])

    def test_help_explains_every_argument(self):
        done = run([program("integrate"), "--help"])
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        for argument in (*SHORT, "tolerance", "max-sweeps", "hbar", "products", "modes", "output", "json"):
            self.assertIn(f"--{argument}", done.stdout)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full here")
    def test_an_answer_that_could_not_be_printed_is_no_success(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = run(command(SHORT, "--json"), stdout=full)
        self.assertNotEqual(done.returncode, DONE)


class TheCheckItself(unittest.TestCase):
    def test_what_is_noticed(self):
        """Negative controls of `distance`, on which the tests above rest."""
        reference = read_reference("W_t5_h0.1_n17_s2.csv")
        for i, j, value in ((3, 5, 10 * TOLERANCE), (-1, -1, 10j * TOLERANCE), (0, 0, math.nan)):
            W = [list(row) for row in reference]
            self.assertEqual(distance(W, reference), 0.0)
            W[i][j] += value
            self.assertGreater(distance(W, reference), TOLERANCE)
        for W in ([list(column) for column in zip(*reference)], reference[:-1], read_reference("W_t5_h0.1_n17_s3.csv")):
            self.assertGreater(distance(W, reference), TOLERANCE)


class FailedRuns(IntegrateTest):
    """Exit 3, one line on stderr that says which step and how, one JSON object, and no output file.

    Before it stands the note on a step beyond the measured limit, where it is (see BeyondTheMeasuredLimit).
    """

    def assert_fails(self, arguments, status, **changes):
        output = self.write("out/W.npy", EARLIER)
        before = snapshot(self.folder)
        done = run(command(arguments, "--json", "--output", output, **changes), timeout=60)
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
        self.assertEqual(snapshot(self.folder), before)
        return result

    def test_a_step_far_too_long_diverges(self):
        for formulation in FORMULATIONS:
            with self.subTest(formulation=formulation):
                self.assert_fails(SHORT, "diverged", formulation=formulation, step="20", time="20")
                if not SANITIZED:  # n = 129 takes too long when sanitised
                    self.assert_fails(DIVERGING, "diverged", formulation=formulation)

    def test_too_few_sweeps_end_as_sweep_cap(self):
        for formulation in FORMULATIONS:
            with self.subTest(formulation=formulation):
                result = self.assert_fails(SHORT, "sweep cap", formulation=formulation, max_sweeps="3")
                self.assertEqual(result["sweeps_total"], 3)
        self.assertIn("failed_step", run(command(SHORT, max_sweeps="3")).stdout)  # as text too

    def test_a_tolerance_at_the_rounding_floor_ends(self):
        for formulation in FORMULATIONS:
            for stages in ("1", "2", "3"):
                with self.subTest(formulation=formulation, stages=stages):
                    done = run(command(WHOLE, "--json", formulation=formulation, stages=stages, tolerance="1e-15"))
                    status = strict_json(done.stdout)["status"]
                    self.assertIn((done.returncode, status), ((DONE, "converged"), (SOLVER_FAILED, "stagnated")))


class InterruptedRuns(IntegrateTest):
    LONG = {**SHORT, "n": "33", "time": "100000"}

    def test_a_signal_leaves_the_earlier_file_alone(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            output = self.write("W.npy", EARLIER)
            process = start(command(self.LONG, "--output", output), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            self.addCleanup(end, process)
            with self.assertRaises(subprocess.TimeoutExpired):
                process.wait(timeout=1)  # it is running, and goes on for minutes
            process.send_signal(number)
            self.assertNotEqual(process.wait(timeout=20), DONE)
            self.assertEqual(snapshot(self.folder), {"W.npy": EARLIER.encode()})


if __name__ == "__main__":
    unittest.main()
