"""Tests of the installed library: what a user's project finds, compiles without our flags, and runs."""

import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from programs import BUILD, HAS_MODULE, ROOT, SANITIZED, FolderTest, environment, run, strict_json, text_of

USER = os.path.join(ROOT, "tests", "install")
VERSION = re.search(r"project\(isosyrk VERSION ([0-9.]+) ", text_of(ROOT, "CMakeLists.txt")).group(1)
OWN_METHOD = os.path.join(BUILD, "tests", "own_method")
BEGIN, END = "<!-- example.cpp:begin -->\n```cpp\n", "```\n<!-- example.cpp:end -->\n"
INTERNAL_ROOMS = ("split", "solver", "fast")


def command(*line):
    """Runs a command without flags from the environment; returns its exit code and all it printed."""
    done = run(line, env=environment(CXXFLAGS=None, CPPFLAGS=None, LDFLAGS=None), stderr=subprocess.STDOUT, timeout=600)
    return done.returncode, done.stdout


class InstalledLibrary(FolderTest):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, folder)
        cls.prefix = os.path.join(folder, "prefix")
        cls.build = os.path.join(folder, "build")
        scene = os.path.join(folder, "scene")
        os.mkdir(scene)
        _, after = text_of(ROOT, "core", "README.md").split(BEGIN.replace("example", "bloch_iserles"))
        with_lines = text_of(ROOT, "core", "scenes", "scene_list.cpp")
        for last in ("Scene pseudo_unitary(const SceneParameters& parameters);\n",
                     "    {\"pseudo_unitary\", &scenes::pseudo_unitary},\n"):
            before, after_last = with_lines.split(last)
            with_lines = before + last + last.replace("pseudo_unitary", "bloch_iserles") + after_last
        for name, text in {"bloch_iserles": after.split("```\n")[0], "scene_list": with_lines}.items():
            with open(os.path.join(scene, f"{name}.cpp"), "w", encoding="utf-8") as file:
                file.write(text)
        cls.done("cmake", "--install", BUILD, "--prefix", cls.prefix)
        cls.configure = ("cmake", "-S", USER, f"-DCMAKE_PREFIX_PATH={cls.prefix}", f"-DSCENE={scene}",
                         f"-DMETHOD={os.path.join(OWN_METHOD, 'include', 'isosyrk', 'integrators')}",
                         "-DCMAKE_BUILD_TYPE=", "-DCMAKE_CXX_FLAGS=-O0")
        cls.done(*cls.configure, "-B", cls.build, f"-DEXPECTED_VERSION={VERSION}")
        cls.done("cmake", "--build", cls.build)

    @classmethod
    def done(cls, *line):
        code, printed = command(*line)
        if code != 0:
            raise AssertionError(f"{' '.join(line)}: exit {code}\n{printed}")
        return printed

    def test_module_is_installed(self):
        (package,) = glob.glob(os.path.join(self.prefix, "lib", "**", "isosyrk", "__init__.py"), recursive=True)
        python = re.search(r"^_?Python_EXECUTABLE:\w+=(.*)$", text_of(BUILD, "CMakeCache.txt"), re.M).group(1)
        printed = self.done("env", f"PYTHONPATH={os.path.dirname(os.path.dirname(package))}", python, "-c",
                            "import isosyrk; print(isosyrk.__file__, isosyrk.scene('smooth', n=9).initial.shape,"
                            " isosyrk.conditions()['version'], isosyrk.quflow.integrator('elp4').name)")
        self.assertEqual(printed, f"{package} (9, 9) {VERSION} elp4\n")

    def test_module_is_built_for_the_python_that_has_numpy(self):
        # Without packages, and so without NumPy.
        self.write("python3", f"#!/bin/sh\nexec {sys.executable} -S \"$@\"\n", executable=True)
        printed = self.done("env", "-u", "ISOSYRK_PYTHON", f"PATH={self.folder}:{os.environ['PATH']}", "cmake", "-S",
                            ROOT, "-B", self.path("build"), "-DISOSYRK_TESTS=OFF", "-DISOSYRK_PROGRAMS=OFF")
        self.assertRegex(printed, r"-- NumPy module: built for /usr/bin/python3 \(Python 3")

    def test_a_user_s_programs_run(self):
        for name, printed in (("example", "[0-9]+ sweeps, spectrum error [0-9.]+e-1[2-9]"),
                              ("memory", "sound"),  # goes to and fro
                              ("own_flow", "kept"), ("own_scene", "coincide"),  # a scene is one file and one line
                              ("own_method", "order 2")):
            with self.subTest(name):
                self.assertRegex(self.done(os.path.join(self.build, name)), f"^{printed}\n$")

    def test_example_is_the_one_of_the_readme(self):
        _, after = text_of(ROOT, "README.md").split(BEGIN)
        self.assertEqual(after.split(END)[0], text_of(USER, "example.cpp"))

    def test_the_version_is_that_of_the_project_wherever_it_is_shown(self):
        code, printed = command(*self.configure, "-B", self.path("build"), "-DEXPECTED_VERSION=0.1.9")
        self.assertNotEqual(code, 0)
        self.assertIn(f"isosyrk {VERSION} was found, not 0.1.9", printed)
        self.assertIn(f"\n## {VERSION}\n", text_of(ROOT, "core", "CHANGELOG.md"))
        self.assertIn(f"\nversion: {VERSION}\n", text_of(ROOT, "CITATION.cff"))
        self.assertIn(f"find_package(isosyrk {VERSION.rpartition('.')[0]})", text_of(ROOT, "README.md"))

    def test_what_a_user_s_machine_lacks_is_named_in_one_line(self):
        for variable, needed in (("ISOSYRK_OPENBLAS_LIBRARY", "OpenBLAS (libopenblas-dev)"),
                                 ("ISOSYRK_LAPACKE_INCLUDE_DIR", "LAPACKE (liblapacke-dev)")):
            code, printed = command(*self.configure, "-B", self.path(variable), f"-DEXPECTED_VERSION={VERSION}",
                                    f"-D{variable}=")
            self.assertNotEqual(code, 0)
            self.assertIn(f"isosyrk needs {needed}\n", printed)
            self.assertEqual(printed.count("CMake Error"), 1, printed)

    def test_openblas_is_found_without_its_cmake_package(self):
        broken = self.path("broken")
        self.write("broken/OpenBLASConfig.cmake", 'set(OpenBLAS_LIBRARIES "/lib/lib/libopenblas.so")\n')
        self.done(*self.configure, "-B", self.path("build"), f"-DEXPECTED_VERSION={VERSION}",
                  f"-DOpenBLAS_DIR={broken}")
        found = re.search(r"^ISOSYRK_OPENBLAS_LIBRARY:\w+=(.*)$", text_of(self.path("build", "CMakeCache.txt")), re.M)
        self.assertTrue(os.path.exists(found[1]), found[1])

    def test_internals_are_not_installed(self):
        rooms = os.path.join(self.prefix, "include", "isosyrk")
        self.assertFalse(set(os.listdir(rooms)) & set(INTERNAL_ROOMS))
        code, printed = command("cmake", "--build", self.build, "--target", "internal")
        self.assertNotEqual(code, 0)
        self.assertIn("isosyrk/split/split_matrix.h", printed)

    def test_public_headers_include_no_others(self):
        rooms = os.path.join(self.prefix, "include")
        for folder, _, names in os.walk(rooms):
            for name in names:
                for included in re.findall('^#include "(isosyrk/.*)"', text_of(folder, name), re.M):
                    self.assertTrue(os.path.exists(os.path.join(rooms, included)), f"{folder}/{name}: {included}")


class OwnMethod(FolderTest):
    """The method of core/README.md, added as that page says, in programs, tests and module."""

    NAME = "cayley_midpoint"
    ARGUMENTS = ("--n", "9", "--step", "0.1", "--time", "1")

    def ran(self, program, tests):
        """Runs tests of the list with the method in it; returns the exit code, their number and what was printed."""
        done = run([os.path.join(OWN_METHOD, "tests", program), f"--gtest_filter={tests}"], timeout=300,
                   env=environment(OMP_WAIT_POLICY="passive"))
        return done.returncode, int(re.search(r"Running (\d+) test", done.stdout).group(1)), done.stdout

    def test_order_and_structure(self):
        self.assertEqual(self.ran("core_tests", f"*EachIntegrator.*/{self.NAME}")[:2], (0, 6))
        self.assertEqual(self.ran("core_tests", f"*/{self.NAME}_frame")[1], 0)  # it loses what turns the frame
        # Every test that goes over the list, and the method in none that compares fast forms.
        code, count, printed = self.ran("core_tests", "Step.*:LinearLimits.*:FastForms.*Form:FastForms.*One")
        self.assertEqual(code, 0, printed)
        self.assertGreaterEqual(count, 5)
        self.assertEqual(self.ran("core_tests", f"*EachListedFastForm*{self.NAME}*")[1], 0)
        if not SANITIZED:
            tests = f"*BackendAndSize/{self.NAME}:Memory.*PublishedForm*"
            self.assertEqual(self.ran("allocation_tests", tests)[:2], (0, 2))

    def test_what_an_entry_says_falsely_is_seen(self):
        code, _, printed = self.ran("core_tests", "*EachIntegrator.*/misjudged")
        self.assertNotEqual(code, 0)
        failed = set(re.findall(r"FAILED  \] List/EachIntegrator\.(\w+)/misjudged,", printed))
        self.assertEqual(failed, {"HasItsOrder", "IsAPoissonMapIfAndOnlyIfItSaysSo"})

    def test_integrate(self):
        integrate = [os.path.join(OWN_METHOD, "benchmarks", "integrate"), "--integrator", self.NAME, *self.ARGUMENTS]
        done = run([*integrate, "--json"])
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        result = strict_json(done.stdout)
        self.assertEqual((result["integrator"], result["solver"]), (self.NAME, "published"))
        self.assertLess(result["spectrum_error"], 1e-11)
        self.assert_refused(run([*integrate, "--solver", "fast"]), f"integrator '{self.NAME}': has no fast form")

    @unittest.skipUnless(HAS_MODULE and not SANITIZED, "without the module, or with a sanitizer's libraries")
    def test_module(self):
        python = re.search(r"^_?Python_EXECUTABLE:\w+=(.*)$", text_of(BUILD, "CMakeCache.txt"), re.M).group(1)
        code = f"""if True:
            import isosyrk
            entry = next(each for each in isosyrk.integrators() if each.name == "{self.NAME}")
            assert (entry.order, entry.has_fast_form) == (2, False)
            assert isosyrk.measured_limit("{self.NAME}", 33) is None
            scene = isosyrk.scene("smooth", n=9)
            W, report = isosyrk.integrator(scene, "{self.NAME}").run(scene.initial, 0.1, 10)
            assert isosyrk.spectrum_error(W, scene.initial) < 1e-11
            try:
                isosyrk.integrator(scene, "{self.NAME}", solver="fast")
            except ValueError as error:
                print(error)
            """
        done = run([python, "-c", code], env=environment(PYTHONPATH=os.path.join(OWN_METHOD, "python")))
        self.assertEqual((done.stdout, done.stderr), (f"integrator '{self.NAME}': has no fast form\n", ""))
