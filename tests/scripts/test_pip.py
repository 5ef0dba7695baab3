"""Tests of the module as people get it: by pip from the repository, and by its CMake target.

Run with: python3 -m unittest test_pip (in tests/scripts; what is compiled is taken from ISOSYRK_BUILD, or from build/)
"""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from programs import BUILD, HAS_MODULE, ROOT, FolderTest, environment, run, snapshot, text_of

PACKAGE = os.path.join(ROOT, "core", "python")
VERSION = re.search(r"project\(isosyrk VERSION ([0-9.]+) ", text_of(ROOT, "CMakeLists.txt")).group(1)
NEEDED = ("ensurepip", "pip", "setuptools", "wheel", "numpy")
MISSING = [name for name in NEEDED if importlib.util.find_spec(name) is None]

# In place of the compiler: an object that the build under test has already is not compiled once more.
LAUNCHER = """#!/bin/sh
previous=
for argument; do
  [ "$previous" = -o ] && output=$PWD/$argument
  previous=$argument
done
found=$COMPILED/${output#"$ISOSYRK_PIP_BUILD"/}
case $output in
  *.o) [ -f "$found" ] && exec cp "$found" "$output" ;;
esac
exec "$@"
"""


@unittest.skipUnless(HAS_MODULE, "the module is not built")
@unittest.skipIf(MISSING, f"this Python has no {' '.join(MISSING)} (python3-venv, python3-pip, python3-setuptools)")
class Pip(FolderTest):
    @classmethod
    def setUpClass(cls):
        cls.root = os.path.realpath(tempfile.mkdtemp(prefix="isosyrk-"))
        cls.addClassCleanup(shutil.rmtree, cls.root)
        cls.python = os.path.join(cls.root, "venv", "bin", "python")
        done = run([sys.executable, "-m", "venv", "--system-site-packages", os.path.join(cls.root, "venv")],
                   timeout=300)
        if done.returncode != 0:
            raise AssertionError(done.stdout + done.stderr)
        launcher = os.path.join(cls.root, "launcher")
        with open(launcher, "w", encoding="ascii") as file:
            file.write(LAUNCHER)
        os.chmod(launcher, 0o755)
        cls.build = os.path.join(cls.root, "build")
        cls.before = snapshot(PACKAGE)
        # As if there were no GoogleTest.
        cls.installed = cls.pip("install", PACKAGE, CMAKE_ARGS=f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}"
                                " -DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON")

    @classmethod
    def pip(cls, command, package, **settings):
        """Runs pip with what the distribution has, so without a network."""
        settings = {"COMPILED": os.path.realpath(BUILD), "ISOSYRK_PIP_BUILD": cls.build,
                    "PIP_DISABLE_PIP_VERSION_CHECK": "1", **settings}
        return run([cls.python, "-m", "pip", command, "--no-build-isolation", "--no-deps", package], timeout=550,
                   env=environment(**settings), stderr=subprocess.STDOUT)

    def test_it_is_installed_and_runs(self):
        self.assertEqual(self.installed.returncode, 0, self.installed.stdout)
        code = ("import importlib.metadata, isosyrk, os\n"
                "scene = isosyrk.scene('smooth', n=17)\n"
                "W, report = isosyrk.integrator(scene, 'group2', solver='fast').run(scene.initial, 0.1, 5)\n"
                "print(isosyrk.__file__, isosyrk.__version__, importlib.metadata.version('isosyrk'), report.steps)\n"
                "print(sorted(os.listdir(os.path.dirname(isosyrk.__file__))))\n")
        done = run([self.python, "-B", "-c", code], cwd=self.folder)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        line, files = done.stdout.splitlines()
        path, *found = line.split()
        self.assertTrue(path.startswith(os.path.join(self.root, "venv")), path)
        self.assertEqual(found, [VERSION, VERSION, "5"])
        for name in ("__init__.py", "_core.pyi", "py.typed"):
            self.assertIn(f"'{name}'", files)

    def test_the_folder_stays_as_it_was(self):
        self.assertEqual(snapshot(PACKAGE), self.before)

    def test_tests_are_not_built_and_need_googletest_where_they_are(self):
        self.assertFalse(os.path.exists(os.path.join(self.build, "tests")))
        done = run(["cmake", "-S", ROOT, "-B", self.path("with_tests"), "-DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON"],
                   timeout=300)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("GTest", done.stderr)

    def test_what_fails_is_said(self):
        done = self.pip("wheel", PACKAGE, CMAKE_ARGS="-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON",
                        ISOSYRK_PIP_BUILD=self.path("broken"))
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stdout, r"(?m)^ *isosyrk: cmake -S .*: exit status 1$")
        copy = self.path("alone", "core", "python")
        shutil.copytree(PACKAGE, copy)
        done = self.pip("wheel", copy)
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stdout, r"(?m)^ *isosyrk: .*/alone is not its repository; core/python is installed")


class Target(FolderTest):
    """The Python that the module is built for, without it being built."""

    def configured(self, **settings):
        """Returns what the configuration says of the module."""
        done = run(["cmake", "-S", ROOT, "-B", self.path("build"), "-DISOSYRK_TESTS=OFF"], timeout=300,
                   env=environment(**settings))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("NumPy", done.stderr)
        (line,) = re.findall("^-- (NumPy module: .*)$", done.stdout, re.M)
        return line

    @unittest.skipUnless(HAS_MODULE, "the module is not built")
    def test_the_python_that_is_named_is_taken(self):
        named = self.write("named/python", f"#!/bin/sh\nexec {sys.executable} \"$@\"\n", executable=True)
        self.write("first/python3", "#!/bin/sh\nexit 1\n", executable=True)
        path = f"{self.path('first')}:{os.environ['PATH']}"
        line = self.configured(ISOSYRK_PYTHON=named, PATH=path)
        self.assertRegex(line, f"^NumPy module: built for {sys.executable} ")
        self.assertIn("core/python/stepper.cpp", text_of(self.path("build", "compile_commands.json")))

    def test_no_other_is_taken_if_it_has_no_numpy(self):
        named = self.write("named/python", f"#!/bin/sh\nexec {sys.executable} -S \"$@\"\n", executable=True)
        for python in (named, self.path("nowhere")):
            with self.subTest(python):
                line = self.configured(ISOSYRK_PYTHON=python)
                self.assertEqual(line, f"NumPy module: not built, ISOSYRK_PYTHON={python} is no Python with NumPy")
                done = run(["cmake", "--build", self.path("build"), "--target", "isosyrk_python"])
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(f"{line}\n", done.stdout)
                self.assertNotIn("core/python/stepper.cpp", text_of(self.path("build", "compile_commands.json")))


if __name__ == "__main__":
    unittest.main()
