"""Builds the module as a package: CMake compiles the compiled half, for the Python that runs this.

It needs the whole repository around it, and what the library needs (README.md). It heeds CMAKE_ARGS, arguments of the
configuration, and CMAKE_BUILD_PARALLEL_LEVEL. ISOSYRK_PIP_BUILD is the folder to build in, build-pip if it is not set:
a second installation then compiles only what has changed.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
BUILD = os.path.abspath(os.environ.get("ISOSYRK_PIP_BUILD") or os.path.join(ROOT, "build-pip"))


def version():
    try:
        with open(os.path.join(ROOT, "CMakeLists.txt"), encoding="utf-8") as file:
            return re.search(r"^project\(isosyrk VERSION ([0-9.]+)", file.read(), re.M).group(1)
    except (OSError, AttributeError):
        sys.exit(f"isosyrk: {ROOT} is not its repository; core/python is installed from there")


def run(*line, **changes):
    """Runs a command to its end; its output is pip's to show, with -v or on failure."""
    status = subprocess.run(line, env={**os.environ, **changes}, check=False).returncode
    if status != 0:
        sys.exit(f"isosyrk: {shlex.join(line)}: exit status {status}")


class CMakeBuild(build_ext):
    """Compiles the extensions by CMake, and takes them from its build."""

    def build_extensions(self):
        if shutil.which("cmake") is None:
            sys.exit("isosyrk: needs cmake, and what README.md names")
        arguments = ["-DISOSYRK_TESTS=OFF", "-DISOSYRK_PROGRAMS=OFF", *shlex.split(os.environ.get("CMAKE_ARGS", ""))]
        try:
            import pybind11
            arguments.append(f"-Dpybind11_DIR={pybind11.get_cmake_dir()}")
        except ImportError:
            pass  # CMake finds that of the distribution
        run("cmake", "-S", ROOT, "-B", BUILD, *arguments, ISOSYRK_PYTHON=sys.executable)
        cores = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or str(len(os.sched_getaffinity(0)))
        run("cmake", "--build", BUILD, "--target", "isosyrk_python", "--parallel", cores)
        for ext in self.extensions:
            target = self.get_ext_fullpath(ext.name)
            os.makedirs(os.path.dirname(target), exist_ok=True)
            shutil.copyfile(os.path.join(BUILD, "python", "isosyrk", os.path.basename(target)), target)


packaging = os.path.join(BUILD, "setuptools")
os.makedirs(packaging, exist_ok=True)
setup(version=version(), cmdclass={"build_ext": CMakeBuild},
      ext_modules=[Extension(f"isosyrk.{name}", sources=[]) for name in ("_core", "_conditions")],
      options={"build": {"build_base": packaging}, "egg_info": {"egg_base": packaging}})
