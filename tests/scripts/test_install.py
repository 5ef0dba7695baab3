"""Tests of the installed library: what a user's project finds, compiles without our flags, and runs.

Run with: python3 -m unittest discover -s tests/scripts
"""

import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from programs import BUILD, ROOT

USER = os.path.join(ROOT, "tests", "install")
README = os.path.join(ROOT, "README.md")
BEGIN, END = "<!-- example.cpp:begin -->\n```cpp\n", "```\n<!-- example.cpp:end -->\n"
INTERNAL_ROOMS = ("split", "solver", "fast")


def command(*line):
    """Runs a command without flags from the environment; returns its exit code and all it printed."""
    plain = {name: value for name, value in os.environ.items() if name not in ("CXXFLAGS", "CPPFLAGS", "LDFLAGS")}
    done = subprocess.run(line, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                          env={**plain, "LC_ALL": "C"})
    return done.returncode, done.stdout


class InstalledLibrary(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.prefix = os.path.join(cls.folder, "prefix")
        cls.build = os.path.join(cls.folder, "build")
        cls.done("cmake", "--install", BUILD, "--prefix", cls.prefix)
        cls.done("cmake", "-S", USER, "-B", cls.build, f"-DCMAKE_PREFIX_PATH={cls.prefix}",
                 "-DCMAKE_BUILD_TYPE=", "-DCMAKE_CXX_FLAGS=-O0")
        cls.done("cmake", "--build", cls.build)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def done(cls, *line):
        code, printed = command(*line)
        if code != 0:
            raise AssertionError(f"{' '.join(line)}: exit {code}\n{printed}")
        return printed

    def run_user(self, name):
        return self.done(os.path.join(self.build, name))

    def test_module_is_installed(self):
        (package,) = glob.glob(os.path.join(self.prefix, "lib", "**", "isosyrk", "__init__.py"), recursive=True)
        with open(os.path.join(BUILD, "CMakeCache.txt"), encoding="utf-8") as cache:
            python = re.search(r"^_?Python_EXECUTABLE:\w+=(.*)$", cache.read(), re.M).group(1)
        printed = self.done("env", f"PYTHONPATH={os.path.dirname(os.path.dirname(package))}", python, "-c",
                            "import isosyrk; print(isosyrk.__file__, isosyrk.scene('smooth', n=9).initial.shape)")
        self.assertEqual(printed, f"{package} (9, 9)\n")

    def test_module_is_built_for_the_python_that_has_numpy(self):
        with tempfile.TemporaryDirectory() as folder:
            without = os.path.join(folder, "python3")
            with open(without, "w", encoding="utf-8") as script:
                script.write(f"#!/bin/sh\nexec {sys.executable} -S -I \"$@\"\n")  # no packages: no NumPy
            os.chmod(without, 0o755)
            printed = self.done("env", "-u", "ISOSYRK_PYTHON", f"PATH={folder}:{os.environ['PATH']}", "cmake", "-S", ROOT, "-B",
                                os.path.join(folder, "build"))
        self.assertRegex(printed, r"-- NumPy module: built for /usr/bin/python3 \(Python 3")

    def test_example_runs(self):
        printed = self.run_user("example")
        self.assertRegex(printed, r"^[0-9]+ sweeps, spectrum error [0-9.]+e-1[2-9]\n$")

    def test_example_is_the_one_of_the_readme(self):
        with open(README, encoding="utf-8") as stream:
            readme = stream.read()
        self.assertEqual(readme.count(BEGIN), 1)
        block = readme.split(BEGIN)[1].split(END)[0]
        with open(os.path.join(USER, "example.cpp"), encoding="utf-8") as stream:
            self.assertEqual(block, stream.read())

    def test_memory_goes_to_and_fro(self):
        self.assertEqual(self.run_user("memory"), "sound\n")

    def test_a_flow_of_the_user_is_integrated(self):
        self.assertEqual(self.run_user("own_flow"), "kept\n")

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
                header = os.path.join(folder, name)
                with open(header, encoding="utf-8") as stream:
                    for line in stream:
                        if line.startswith("#include \"isosyrk/"):
                            included = line.split('"')[1]
                            self.assertTrue(os.path.exists(os.path.join(rooms, included)), f"{header}: {included}")


if __name__ == "__main__":
    unittest.main()
