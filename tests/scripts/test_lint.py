"""Tests of scripts/lint, and of scripts/test --werror, in a small repository whose tools are stand-ins.

The tools write down how they were called, and find something if they are $FINDING.
"""

import os
import shutil
import subprocess

from programs import BAD_ARGUMENTS, DONE, ROOT, FolderTest, environment, run

FOUND = 1
TOOL = """#!/bin/sh
tool=${0##*/}
echo "$tool $*" >>"$CALLS"
[ "$tool" != "$FINDING" ] || { echo "chatter of $tool" >&2; exit 1; }
"""
TOOLS = ("cmake", "ctest", "clang-format-14", "clang-tidy-14", "flake8")
PACKAGES = """#!/bin/sh
for package; do :; done
[ "$package" != "$MISSING" ] || exit 1
echo "install ok installed"
"""
CPP = ("core/integrators/form.cpp", "core/integrators/form.h", "core/fast/form.cpp", "tests/form_test.cpp")
PYTHON = ("core/module.py", "core/module.pyi", "scripts/studies/accuracy/charts.py", "scripts/render")
OTHERS = ("README.md", "scripts/data", "scripts/shell")


class LintTest(FolderTest):
    def setUp(self):
        super().setUp()
        for name in ("lint", "test", os.path.join("lib", "setup.sh")):
            path = self.path("root", "scripts", name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            shutil.copy2(os.path.join(ROOT, "scripts", name), path)
        for name in (*CPP, *PYTHON, *OTHERS):
            self.write(f"root/{name}", {"scripts/render": "#!/usr/bin/env python3\n",
                                        "scripts/shell": "#!/usr/bin/env bash\n"}.get(name, "1\n"))
        for args in (("init", "-q"), ("add", ".")):
            subprocess.run(["git", *args], cwd=self.path("root"), check=True)
        self.write("root/core/integrators/not_tracked.cpp", "")
        for tool in TOOLS:
            self.write(f"tools/{tool}", TOOL, executable=True)
        self.write("tools/dpkg-query", PACKAGES, executable=True)
        for folder in ("build", "build-sanitize", "build-threads"):
            self.write(f"root/{folder}/benchmarks/kernel_sets", "#!/bin/sh\necho some\n", executable=True)
        self.calls = self.write("calls", "")

    def script(self, name, *arguments, **changes):
        path = f"{self.path('tools')}:{os.environ['PATH']}"
        return run([self.path("root", "scripts", name), *arguments],
                   env=environment(PATH=path, CALLS=self.calls, **{"FINDING": "", "MISSING": "", **changes}))

    def called(self, tool):
        """Returns the arguments of each call of a tool, sorted."""
        with open(self.calls, encoding="utf-8") as lines:
            return sorted(line.split()[1:] for line in lines if line.split()[0] == tool)

    def test_each_tool_reads_the_tracked_files_that_are_its_own(self):
        done = self.script("lint")
        self.assertEqual((done.returncode, done.stdout), (DONE, ""), done.stderr)
        (formatted,), (read,) = self.called("clang-format-14"), self.called("flake8")
        self.assertEqual(sorted(formatted), ["--Werror", "--dry-run", *sorted(CPP)])
        self.assertEqual(sorted(read), sorted(PYTHON))
        (tidied,) = self.called("clang-tidy-14")
        self.assertEqual(tidied[-1], "core/integrators/form.cpp")
        (configured,) = self.called("cmake")
        self.assertNotIn("--build", configured)

    def test_what_one_finds_is_shown_and_the_others_go_on(self):
        for tool in ("clang-format-14", "clang-tidy-14", "flake8"):
            with self.subTest(tool=tool):
                self.write("calls", "")
                done = self.script("lint", FINDING=tool)
                self.assertEqual((done.returncode, done.stdout), (FOUND, ""))
                self.assertIn(f"chatter of {tool}\n", done.stderr)
                self.assertIn(tool.removesuffix("-14") + ": see above\n", done.stderr)
                for other in ("clang-format-14", "clang-tidy-14", "flake8"):
                    self.assertEqual(len(self.called(other)), 1, other)

    def test_what_keeps_it_from_running_is_told(self):
        self.assert_refused(self.script("lint", "--fix"), "lint: '--fix'", "--no-install")
        self.assert_refused(self.script("lint", "--no-install", MISSING="flake8"), "flake8")
        for tool in ("apt-get", "apt-cache"):
            self.write(f"tools/{tool}", "#!/bin/sh\n[ $1 = update ]\n", executable=True)
        self.write("tools/id", "#!/bin/sh\necho 0\n", executable=True)
        done = self.script("lint", MISSING="clang-format-14")
        self.assertEqual(done.returncode, BAD_ARGUMENTS)
        self.assertRegex(done.stderr, "\nlint: no package of this release: clang-format-14; lint on Debian 12 or .*\n$")
        done = self.script("lint", FINDING="cmake")
        self.assertEqual(done.returncode, BAD_ARGUMENTS)
        self.assertIn("chatter of cmake", done.stderr)
        self.write("calls", "")
        shutil.rmtree(self.path("root", ".git"))
        done = self.script("lint")
        self.assertEqual(done.returncode, BAD_ARGUMENTS)
        self.assertIn("needs its git repository", done.stderr)
        self.assertEqual(self.called("clang-format-14"), [])

    def test_warnings_are_errors_if_asked(self):
        for arguments in ((), ("--sanitize",), ("--threads",)):
            for werror in ("OFF", "ON"):
                with self.subTest(arguments=arguments, werror=werror):
                    self.write("calls", "")
                    done = self.script("test", *arguments, *(("--werror",) if werror == "ON" else ()))
                    self.assertEqual(done.returncode, DONE, done.stderr)
                    configured, _ = sorted(self.called("cmake"), key=lambda call: "--build" in call)
                    self.assertIn(f"-DISOSYRK_WERROR={werror}", configured)
