"""Tests of the installed library: what a user's project finds, compiles without our flags, and runs."""

import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile

from programs import BUILD, ROOT, FolderTest, environment, run, text_of

USER = os.path.join(ROOT, "tests", "install")
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
        last = "SCENE(pseudo_unitary)"
        with_line = text_of(ROOT, "core", "flows", "scene_list.cpp").replace(last, f"{last} SCENE(bloch_iserles)")
        for name, text in {"bloch_iserles": after.split("```\n")[0], "scene_list": with_line}.items():
            with open(os.path.join(scene, f"{name}.cpp"), "w", encoding="utf-8") as file:
                file.write(text)
        cls.done("cmake", "--install", BUILD, "--prefix", cls.prefix)
        cls.done("cmake", "-S", USER, "-B", cls.build, f"-DCMAKE_PREFIX_PATH={cls.prefix}", f"-DSCENE={scene}",
                 "-DCMAKE_BUILD_TYPE=", "-DCMAKE_CXX_FLAGS=-O0")
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
                            "import isosyrk; print(isosyrk.__file__, isosyrk.scene('smooth', n=9).initial.shape)")
        self.assertEqual(printed, f"{package} (9, 9)\n")

    def test_module_is_built_for_the_python_that_has_numpy(self):
        # Without packages, and so without NumPy.
        self.write("python3", f"#!/bin/sh\nexec {sys.executable} -S \"$@\"\n", executable=True)
        printed = self.done("env", "-u", "ISOSYRK_PYTHON", f"PATH={self.folder}:{os.environ['PATH']}", "cmake", "-S",
                            ROOT,
                            "-B", self.path("build"))
        self.assertRegex(printed, r"-- NumPy module: built for /usr/bin/python3 \(Python 3")

    def test_a_user_s_programs_run(self):
        for name, printed in (("example", "[0-9]+ sweeps, spectrum error [0-9.]+e-1[2-9]"),
                              ("memory", "sound"),  # goes to and fro
                              ("own_flow", "kept"), ("own_scene", "coincide")):  # a scene is one file and one line
            with self.subTest(name):
                self.assertRegex(self.done(os.path.join(self.build, name)), f"^{printed}\n$")

    def test_example_is_the_one_of_the_readme(self):
        _, after = text_of(ROOT, "README.md").split(BEGIN)
        self.assertEqual(after.split(END)[0], text_of(USER, "example.cpp"))

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
