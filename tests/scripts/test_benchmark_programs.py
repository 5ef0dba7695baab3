"""Tests of build/benchmarks/table1 and build/benchmarks/kernels from outside."""

import math
import os
import platform
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import threading
import unittest

import numpy

from programs import (DATA, DONE, FORMULATIONS, ROOT, SANITIZED, SOLVER_FAILED, FolderTest, end, environment, program,
                      run, run_script, start, strict_json, text_of)

PROGRAMS = ("table1", "table2", "kernels")
BACKENDS = ("openblas", "eigen")
BRIEF = ("--benchmark_filter=n:17", "--benchmark_min_time=0.01")
ONE_ROW = ("--benchmark_filter=table1/group/n:17/s:1", "--benchmark_min_time=0.01")
COUNTERS = ("sweeps_per_step", "products", "poisson_solves", "spectrum_error", "skew_defect", "energy_error",
            "h_norm_B", "product_share", "stolen")
MACHINE_CONTEXT = ("isosyrk_program", "isosyrk_format", "version", "commit", "dirty", "compiler", "flags",
                   "build_type", "cpu", "vector_units", "load_average", "blas_library", "blas_kernels",
                   "blas_threads", "split_kernels", "environment", "products", "product_rate", "peak_gflops", "notice")
SOLVER_CONTEXT = ("tolerance", "norm", "start", "update_order", "hbar", "modes_hash")
VERSION = re.search(r"project\(isosyrk VERSION ([0-9.]+) ", text_of(ROOT, "CMakeLists.txt")).group(1)
REFERENCES = os.path.join(ROOT, "results", "recorded", "references")
EARLIER = "an earlier result"


def measure(name, path, *arguments, **changes):
    """Runs a program with --benchmark_out and returns how it ended and its raw file."""
    done = run([program(name), f"--benchmark_out={path}", *arguments], env=environment(**changes))
    return done, strict_json(text_of(path))


class MeasuredTest(unittest.TestCase):
    """One run for all tests of a class."""

    program = "table1"
    arguments = BRIEF

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="isosyrk-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.path = os.path.join(cls.folder, "raw.json")
        cls.done, cls.raw = measure(cls.program, cls.path, *cls.arguments)
        cls.context, cls.rows = cls.raw["context"], cls.raw["benchmarks"]

    def assert_conditions(self, *fields):
        for field in fields:
            self.assertIsInstance(self.context[field], str, field)
            self.assertTrue(self.context[field] or field == "notice", field)
        self.assertEqual((self.context["isosyrk_program"], self.context["isosyrk_format"]), (self.program, "1"))
        self.assertEqual(self.context["blas_threads"], "1")
        # What programs set themselves, and nothing inherited.
        kept = [f"{name}={os.environ[name]}" for name in ("OPENBLAS_CORETYPE",) if name in os.environ]
        self.assertEqual(self.context["environment"].split(), ["GOMP_SPINCOUNT=1500", *kept, "OPENBLAS_NUM_THREADS=1"])
        self.assertEqual(self.context["version"], VERSION)
        self.assertIn(self.context["dirty"], ("yes", "no", "unknown"))
        # A virtual machine gives one name to processors that differ, and are tuned for differently.
        told = dict(re.findall(r"(?m)^(cpu family|model|model name|stepping)\s*: (.*)$", text_of("/proc/cpuinfo")))
        name = told.pop("model name", "unknown")
        self.assertEqual(self.context["cpu"], ", ".join([name, *(" ".join(pair) for pair in told.items())]))
        for backend in BACKENDS:
            self.assertIn(backend, self.context["product_rate"])


def expected_error():
    """Returns the relative distance of the reference answers of s = 2 and, 10⁴ times closer to the truth, s = 3."""
    two, three = (numpy.loadtxt(os.path.join(DATA, f"W_t5_h0.1_n17_s{s}.csv"), delimiter=",", skiprows=1,
                                usecols=(2, 3)) for s in (2, 3))
    return numpy.linalg.norm(two - three) / numpy.linalg.norm(three)


class Table1(MeasuredTest):
    arguments = (*BRIEF, "--references", REFERENCES)

    def test_a_complete_run_ends_with_0_and_leaves_nothing_but_the_raw_file(self):
        self.assertEqual(self.done.returncode, DONE, self.done.stderr)
        self.assertRegex(self.done.stderr, r"(?m)^Run on ")  # what Google Benchmark says of the machine
        self.assertNotIn("built as DEBUG", self.done.stdout + self.done.stderr)  # but not how it was packaged
        self.assertEqual(os.listdir(self.folder), ["raw.json"])
        self.assert_conditions(*MACHINE_CONTEXT, *SOLVER_CONTEXT)

    def test_every_formulation_and_stage_count_has_one_row(self):
        expected = [f"{self.program}/{formulation}/n:17/s:{s}" for formulation in FORMULATIONS for s in (1, 2, 3)]
        self.assertEqual(sorted(row["run_name"].split("/min_time")[0] for row in self.rows), sorted(expected))

    def test_every_row_has_every_counter_finite_and_the_counts_of_50_steps(self):
        for row in self.rows:
            with self.subTest(row=row["run_name"]):
                for counter in COUNTERS:
                    self.assertTrue(math.isfinite(row[counter]), counter)
                self.assertGreater(row["cpu_time"], 0)
                self.assertGreater(row["product_share"], 0)
                self.assertLess(row["product_share"], 1.5)  # the rate is measured beside the run: above 1 by noise
                self.assertLessEqual(row["spectrum_error"], 1e-11)
                self.assertIn(row["run_name"], self.done.stderr)  # progress names it
                sweeps = 50 * row["sweeps_per_step"]
                self.assertAlmostEqual(sweeps, round(sweeps), places=6)
                self.assertGreaterEqual(row["products"], 2 * round(sweeps))
                self.assertGreaterEqual(row["poisson_solves"], round(sweeps))
                if "/algebra/" in row["run_name"]:
                    self.assertEqual(row["skew_defect"], 0.0)

    def test_rows_have_the_error_at_the_end(self):
        (row,) = [row for row in self.rows if "/group/n:17/s:2" in row["run_name"]]
        self.assertLess(abs(row["relative_error"] / expected_error() - 1), 1e-3)
        self.assertLess(row["reference_uncertainty"], 1e-12)

    def test_the_renderer_reads_it(self):
        rendered = run_script(os.path.join(ROOT, "scripts", "render_table1"), self.path)
        self.assertEqual((rendered.returncode, rendered.stderr), (DONE, ""))
        self.assertIn("Table 1", rendered.stdout)
        self.assertNotIn(" failed", rendered.stdout.replace("a row failed or was not measured", ""))


class Table2(Table1):
    program = "table2"

    test_the_renderer_reads_it = None  # its own needs the rows of --published

    def test_every_formulation_keeps_the_algebra_exactly_and_tells_full_products(self):
        for row in self.rows:
            self.assertEqual(row["skew_defect"], 0.0)
            self.assertLess(row["products"] / 2, row["equivalent_products"])
            self.assertLess(row["equivalent_products"], row["products"])
        for field, part in (("products", "split"), ("start", "fitted"), ("update_order", "single precision")):
            self.assertIn(part, self.context[field])

    def test_cells_of_several_threads_are_timed_beside_those_of_one(self):
        _, two = measure("table2", os.path.join(self.folder, "two.json"), "--threads", "2",
                         "--benchmark_filter=table2/group/n:17/s:1", "--benchmark_min_time=0.01")
        os.remove(os.path.join(self.folder, "two.json"))
        self.assertEqual([row["run_name"].partition("/threads:")[2] for row in two["benchmarks"]], ["", "2"])


class Choices(FolderTest):
    """What is asked of table1 is done and recorded."""

    def measure(self, *arguments, **changes):
        """Returns how a run ended, the context and the rows of its raw file."""
        done, raw = measure("table1", self.path("raw.json"), *arguments, **changes)
        return done, raw["context"], raw["benchmarks"]

    def test_without_enough_sweeps_every_row_is_an_error_row_without_time_or_counters(self):
        done, context, rows = self.measure(*BRIEF, "--max-sweeps", "5")
        self.assertEqual((done.returncode, len(rows), context["max_sweeps"]), (SOLVER_FAILED, 9, "5"))
        for row in rows:
            self.assertIs(row["error_occurred"], True)
            self.assertIn("sweep cap", row["error_message"])
            self.assertEqual((row["iterations"], row["cpu_time"], row["real_time"]), (0, 0, 0))
            self.assertFalse(set(COUNTERS) & set(row))

    def test_products_are_those_of_the_library_asked_for(self):
        errors = []
        for backend, other in (BACKENDS, BACKENDS[::-1]):
            _, context, rows = self.measure(*BRIEF, "--products", backend)
            self.assertIn("as asked", context["products"])
            self.assertIn(f"n=17 {backend}", context["products"])
            self.assertNotIn(other, context["products"])
            self.assertFalse({"relative_error", "reference_uncertainty"} & set(rows[0]))  # without references
            errors.append([(row["spectrum_error"], row["skew_defect"]) for row in rows])
        # Two libraries add in different orders; the rounding that remains tells them apart.
        self.assertNotEqual(*errors)

    @unittest.skipIf(SANITIZED, "every start measures rates up to n = 129")
    @unittest.skipIf(platform.machine() not in ("x86_64", "AMD64"), "Nehalem kernels are for x86-64")
    def test_an_inherited_kernel_choice_is_told_with_the_kernels_really_picked(self):
        done, context, _ = self.measure(*ONE_ROW, OPENBLAS_CORETYPE="Nehalem")
        if "DYNAMIC_ARCH" not in context["blas_library"]:
            self.skipTest("this OpenBLAS has one set of kernels")
        for text in (context["environment"], context["notice"], done.stderr):
            self.assertIn("OPENBLAS_CORETYPE=Nehalem", text)
        self.assertEqual(context["blas_kernels"], "Nehalem")

        _, context, _ = self.measure(*ONE_ROW, OPENBLAS_CORETYPE="Abacus", OPENBLAS_NUM_THREADS="2")
        for text in ("OPENBLAS_CORETYPE=Abacus", context["blas_kernels"]):
            self.assertIn(text, context["notice"])
        self.assertIn("OPENBLAS_NUM_THREADS=1", context["environment"])  # more threads are none of the program's
        self.assertEqual(context["blas_threads"], "1")

        if " avx2 " in text_of("/proc/cpuinfo"):  # without it this processor may run Nehalem kernels by itself
            _, context, _ = self.measure(*ONE_ROW, OPENBLAS_CORETYPE=None)
            self.assertNotEqual(context["blas_kernels"], "Nehalem")
            # An OpenBLAS that does not know the processor: the notice says what has it run others, and they do.
            if "which do not use it" in context["notice"]:
                self.assertIn("OPENBLAS_CORETYPE=SkylakeX", context["notice"])
                _, context, _ = self.measure(*ONE_ROW, OPENBLAS_CORETYPE="SkylakeX")
                self.assertEqual(context["blas_kernels"], "SkylakeX")
                self.assertNotIn("do not use it", context["notice"])


class Kernels(MeasuredTest):
    program = "kernels"
    arguments = ("--benchmark_filter=n:17$|peak", "--benchmark_min_time=0.01")

    def test_a_complete_run_ends_with_0(self):
        self.assertEqual(self.done.returncode, DONE, self.done.stderr)
        self.assert_conditions(*MACHINE_CONTEXT)

    def test_peak_products_and_poisson_solve_have_one_row_each(self):
        names = [row["run_name"] for row in self.rows]
        units = [name.split("_")[1].split("/")[0] for name in names if name.startswith("kernels/product/split_")]
        self.assertEqual(units[-1], "portable")  # runs everywhere; others by what the processor has
        self.assertLessEqual(set(units), {"avx512", "avx2", "portable"})
        expected = ["kernels/peak", "kernels/poisson/n:17", "kernels/poisson/split/n:17",
                    *(f"kernels/product/{each}/n:17" for each in BACKENDS),
                    *(f"kernels/{part}/split_{unit}/n:17" for unit in units
                      for part in ("product", "adjoint", "triangle", "single"))]
        self.assertEqual(sorted(names), sorted(expected))

    def test_every_product_is_accurate_and_its_share_of_the_peak_a_share(self):
        for row in self.rows:
            if not row["run_name"].startswith(("kernels/product/", "kernels/adjoint/", "kernels/single/")):
                continue
            with self.subTest(row=row["run_name"]):
                # ‖C - AB‖ ≤ (n + 2) √2 u ‖A‖ ‖B‖ for complex products; in units of u ‖A‖ ‖B‖ below 2 (n + 2).
                self.assertLess(row["error_in_roundoffs"], 2 * (17 + 2))
                self.assertGreater(row["share_of_peak"], 0)
                if not SANITIZED:  # else the peak is that of sanitised code, and OpenBLAS is not sanitised
                    self.assertLess(row["share_of_peak"], 1.2)  # both are measured: above 1 by noise

    def test_peak_and_poisson_residual(self):
        rows = {row["run_name"]: row for row in self.rows}
        self.assertGreater(rows["kernels/peak"]["gflops"], 0)
        # The condition of the Laplacian grows as n², the residual in units of roundoff no faster.
        self.assertLess(rows["kernels/poisson/n:17"]["residual"], 17 * 17 * 2.0 ** -53)


class OutputFile(FolderTest):
    """What stands at --benchmark_out stays until the new file is complete."""

    def setUp(self):
        super().setUp()
        self.output = self.write("out/raw.json", EARLIER)

    def refuses(self, name, arguments, *parts, path=None, **options):
        with self.subTest(program=name, arguments=arguments, path=path), self.unchanged():
            out = f"--benchmark_out={self.output if path is None else path}"
            self.assert_refused(run([program(name), out, *arguments], **options), *parts)

    def test_bad_arguments_are_refused(self):
        for name in PROGRAMS:
            for argument, *parts in (("--benchmark_filter=nothing", "--benchmark_filter", "nothing"),
                                     ("--benchmark_filter=n:17/(", "--benchmark_filter", "n:17/("),
                                     ("--benchmark_fliter=x", "--benchmark_fliter"), ("perhaps", "perhaps")):
                self.refuses(name, [argument], *parts)
        for option, value, *allowed in (("--products", "abacus", "fastest", *BACKENDS), ("--max-sweeps", "0", "1 to ")):
            self.refuses("table1", [option], option)
            self.refuses("table1", [option, value], option, value, *allowed)
        self.refuses("table1", ["--references", self.folder], "--references", "references.json")
        for argument in ("--benchmark_repetitions=0", "--benchmark_min_time=nan", "--benchmark_time_unit=parsec"):
            self.refuses("table1", [ONE_ROW[0], argument], *argument.split("="), timeout=5)

    def test_outputs_that_cannot_be_written(self):
        # Others are refused where the file is opened: tests/scripts/test_integrate.py.
        for path, *parts in ((self.path("nowhere", "raw.json"),), ("", "value")):
            self.refuses("table1", BRIEF, "--benchmark_out", path, *parts, path=path)

    def test_help_is_no_error(self):
        for name in PROGRAMS:
            done = run([program(name), "--help"])
            self.assertEqual((done.returncode, done.stderr), (DONE, ""))
            self.assertIn("benchmark", done.stdout)

    def test_a_signal_leaves_it_alone(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            process = start([program("table1"), "--benchmark_filter=n:17/", "--benchmark_min_time=20",
                             f"--benchmark_out={self.output}"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            self.addCleanup(end, process)
            watchdog = threading.Timer(40, process.kill)
            watchdog.start()
            self.addCleanup(watchdog.cancel)
            for line in process.stderr:
                if "s a run" in line:  # a row is being measured
                    break
            self.assertIsNone(process.poll(), "ended before it could be interrupted")
            process.send_signal(number)
            self.assertNotEqual(process.wait(timeout=20), DONE)
            self.assertEqual(text_of(self.output), EARLIER)

    def test_listing_the_names_leaves_it_alone(self):
        with self.unchanged():
            done = run([program("table1"), "--benchmark_list_tests", f"--benchmark_out={self.output}"])
        self.assertLessEqual({f"table1/{formulation}/n:{n}/s:{s}" for formulation in FORMULATIONS
                              for n in (17, 33, 65, 129) for s in (1, 2, 3)}, set(done.stdout.split()))

    def test_a_full_disk_leaves_it_alone_and_is_no_success(self):
        def small_files_only():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # writing fails as on a full disk
            resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024))

        done = run([program("table1"), f"--benchmark_out={self.output}", *ONE_ROW], prepare=small_files_only)
        self.assertEqual(text_of(self.output), EARLIER)
        self.assertNotEqual(done.returncode, DONE)
