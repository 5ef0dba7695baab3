"""Tests of the module as people get it: by pip from the repository, and by its CMake target.

Run with: python3 -m unittest test_pip (in tests/scripts; what is compiled is taken from ISOSYRK_BUILD, or from build/)
"""

import glob
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from compiled import launcher
from programs import HAS_MODULE, ROOT, FolderTest, environment, run, snapshot, text_of

PACKAGE = os.path.join(ROOT, "core", "python")
VERSION = re.search(r"project\(isosyrk VERSION ([0-9.]+) ", text_of(ROOT, "CMakeLists.txt")).group(1)
NEEDED = ("ensurepip", "pip", "setuptools", "wheel", "numpy")
MISSING = [name for name in NEEDED if importlib.util.find_spec(name) is None]


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
        cls.build = os.path.join(cls.root, "build")
        copied, cls.settings = launcher(cls.root, cls.build)
        cls.before = snapshot(PACKAGE)
        # As if there were nothing that only tests and programs need.
        hidden = ("GTest", "benchmark", "CLI11", "nlohmann_json")
        options = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in hidden]
        cls.installed = cls.pip("install", PACKAGE, CMAKE_ARGS=" ".join((copied, *options)))

    @classmethod
    def pip(cls, command, package, **settings):
        """Runs pip with what the distribution has, so without a network."""
        settings = {**cls.settings, "ISOSYRK_PIP_BUILD": cls.build, "PIP_DISABLE_PIP_VERSION_CHECK": "1", **settings}
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
        for name in ("__init__.py", "_core.pyi", "fluid.py", "py.typed", "quflow.py"):
            self.assertIn(f"'{name}'", files)

    def test_the_extension_that_measures_is_there_or_its_absence_is_said(self):
        code = ("import isosyrk\n"
                "try:\n"
                "    print(isosyrk.conditions()['isosyrk_program'], isosyrk.product_rate(9) > 0)\n"
                "except RuntimeError as error:\n"
                "    print(error)\n"
                "scene = isosyrk.scene('smooth', n=9)\n"
                "for products in ('openblas', 'fastest'):\n"
                "    try:\n"
                "        method = isosyrk.integrator(scene, 'group1', products=products)\n"
                "        print(method.run(scene.initial, 0.1, 2)[1].steps)\n"
                "    except RuntimeError as error:\n"
                "        print(error)\n")

        def printed():
            done = run([self.python, "-B", "-c", code], cwd=self.folder)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            return done.stdout.splitlines()

        self.assertEqual(printed(), ["python module True", "2", "2"])
        (extension,) = glob.glob(os.path.join(self.root, "venv", "lib", "**", "_conditions.*.so"), recursive=True)
        self.addCleanup(os.rename, extension + ".away", extension)
        os.rename(extension, extension + ".away")
        why = "isosyrk: was built without the extension that measures; its CMake target is isosyrk_conditions"
        self.assertEqual(printed(), [why, "2", why])

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
