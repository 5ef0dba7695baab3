"""Tests of the options of the build: a package is asked for only where something that needs it is built, and found
by what is there."""

import os
import platform
import re
import shutil
import unittest

from compiled import launcher
from programs import ROOT, FolderTest, environment, run, text_of

NEEDED = {"ISOSYRK_TESTS": {"GTest": "libgtest-dev"},
          "ISOSYRK_PROGRAMS": {"benchmark": "libbenchmark-dev", "CLI11": "libcli11-dev",
                               "nlohmann_json": "nlohmann-json3-dev"}}
OPTIONS = (*NEEDED, "ISOSYRK_MODULE")
PACKAGES = [package for packages in NEEDED.values() for package in packages] + ["Python", "Python3", "pybind11"]

IS_X86 = platform.machine() in ("x86_64", "AMD64")


class Options(FolderTest):
    def setUp(self):
        super().setUp()
        self.build = self.path("build")
        self.copied, self.settings = launcher(self.folder, self.build)

    def configured(self, on, hidden, *further):
        """Configures with only the options `on`, as if the packages `hidden` were not installed."""
        options = [f"-D{option}={'ON' if option in on else 'OFF'}" for option in OPTIONS]
        options += [f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}={'ON' if package in hidden else 'OFF'}"
                    for package in PACKAGES]
        return run(["cmake", "-S", ROOT, "-B", self.build, self.copied, "-DCMAKE_BUILD_TYPE=Release", *options,
                    *further],
                   env=environment(**self.settings), timeout=300)

    def compiled(self):
        return text_of(self.build, "compile_commands.json")

    def test_the_library_alone_needs_none_of_them(self):
        done = self.configured((), PACKAGES)
        self.assertEqual(done.returncode, 0, done.stderr)
        for folder in ("benchmarks", "tests", "core/python"):
            self.assertNotIn(f"{ROOT}/{folder}/", self.compiled())
        for command in (["--build", self.build, "--parallel", "2"],
                        ["--install", self.build, "--prefix", self.path("prefix")]):
            done = run(["cmake", *command], env=environment(**self.settings), timeout=550)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        found = {name for _, _, names in os.walk(self.path("prefix")) for name in names}
        self.assertLessEqual({"libisosyrk.a", "make_integrator.h", "isosyrk-config.cmake"}, found)
        self.assertNotIn("__init__.py", found)

    def test_what_is_built_needs_its_packages_and_says_so_in_one_line(self):
        for option, packages in NEEDED.items():
            for package, debian in packages.items():
                with self.subTest(package):
                    done = self.configured((option,), [package])
                    self.assertNotEqual(done.returncode, 0)
                    self.assertIn(f"\n  {option}: needs {package} ({debian}), or must be OFF\n", done.stderr)
                    self.assertEqual(done.stderr.count("CMake Error"), 1, done.stderr)

    def test_what_the_library_needs_is_named_in_one_line(self):
        for setting, needed in (("-DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON", "Eigen3 (libeigen3-dev)"),
                                ("-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON", "fmt (libfmt-dev)"),
                                ("-DCMAKE_DISABLE_FIND_PACKAGE_OpenMP=ON", "OpenMP (that of the compiler;"),
                                ("-DISOSYRK_OPENBLAS_LIBRARY=", "OpenBLAS (libopenblas-dev)"),
                                ("-DISOSYRK_LAPACKE_INCLUDE_DIR=", "LAPACKE (liblapacke-dev)")):
            with self.subTest(needed):
                done = self.configured((), PACKAGES, setting)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(f"\n  isosyrk needs {needed}", done.stderr)
                self.assertEqual(done.stderr.count("CMake Error"), 1, done.stderr)
                shutil.rmtree(self.build)

    def test_openblas_is_found_by_what_is_there(self):
        # Not by its CMake package: that of Debian 13 names a library in a folder that does not exist.
        self.write("broken/OpenBLASConfig.cmake", 'set(OpenBLAS_LIBRARIES "/lib/lib/libopenblas.so")\n')
        done = self.configured((), PACKAGES, f"-DOpenBLAS_DIR={self.path('broken')}")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = dict(re.findall(r"^(ISOSYRK_\w+)(?:_LIBRARY|_INCLUDE_DIR):\w+=(.*)$",
                                text_of(self.build, "CMakeCache.txt"), re.M))
        self.assertEqual(set(found), {"ISOSYRK_OPENBLAS", "ISOSYRK_LAPACKE"})
        for path in found.values():
            self.assertTrue(os.path.exists(path), path)

    def test_kernels_are_compiled_in_as_chosen(self):
        for chosen, absent in (("all", ()), ("avx2", ("avx512",)), ("portable", ("avx512", "avx2"))):
            done = self.configured((), PACKAGES, f"-DISOSYRK_KERNELS={chosen}")
            self.assertEqual(done.returncode, 0, done.stderr)
            for unit in ("avx512", "avx2", "portable"):
                with self.subTest(chosen=chosen, unit=unit):
                    self.assertEqual(f"gemm_kernel_{unit}.cpp" in self.compiled(),
                                     unit not in absent and (unit == "portable" or IS_X86))
        done = self.configured((), PACKAGES, "-DISOSYRK_KERNELS=avx")
        self.assertIn("\n  ISOSYRK_KERNELS=avx: must be all, avx2 or portable\n", done.stderr)

    def test_each_part_is_built_without_the_others(self):
        programs = NEEDED["ISOSYRK_PROGRAMS"]
        for on, hidden, there, absent in (
                ("ISOSYRK_TESTS", programs, "tests/order_test.cpp", "benchmarks/arguments.cpp"),
                ("ISOSYRK_PROGRAMS", ("GTest",), "benchmarks/integrate/integrate.cpp", "tests/support.cpp")):
            with self.subTest(on):
                done = self.configured((on,), hidden)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertIn(f"{ROOT}/{there}", self.compiled())
                self.assertNotIn(f"{ROOT}/{absent}", self.compiled())
        self.configured(("ISOSYRK_TESTS",), programs)
        listed = run(["ctest", "-N", "--test-dir", self.build]).stdout
        self.assertIn("rooms.upward_include", listed)
        self.assertNotIn("scripts.", listed)


if __name__ == "__main__":
    unittest.main()
