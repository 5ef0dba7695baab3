"""Builds for the regression gate: this tree, and a tree of another revision beside it."""

import os
import shutil
import subprocess
import sys

from lib.programs.command_line import Stop, say
from lib.programs.messages import one_line
from lib.programs.places import ROOT, SETUP

PROGRAM = "check_regression"
CORETYPE = "OPENBLAS_CORETYPE"  # chooses the kernels of OpenBLAS
# What the cells' programs are compiled from.
COMPILED = "CMakeLists.txt", "core", "benchmarks", ":(exclude)*.md", ":(exclude)core/python"
ANSWERS = os.path.join(ROOT, "tests", "data")  # reference answers
MACHINES = NATIVE, *_ = "native", "x86-64-v3", "x86-64"  # those of choose_machine in setup.sh
# Chooses the kernels of split products in a tree that has no ISOSYRK_KERNELS yet: what the compiler is said to lack.
KERNELS_OF_BEFORE = {NATIVE: [], "x86-64-v3": ["-DISOSYRK_COMPILER_HAS_AVX512=OFF"],
                     "x86-64": ["-DISOSYRK_COMPILER_HAS_AVX512=OFF", "-DISOSYRK_COMPILER_HAS_AVX2=OFF"]}


def git(*arguments):
    """Returns what git prints, or None where it fails or there is none."""
    try:
        done = subprocess.run(["git", "-C", ROOT, *arguments], stdin=subprocess.DEVNULL, capture_output=True,
                              encoding="utf-8", errors="replace", check=False)
    except OSError:
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def has_repository():
    # The folder itself, not one around it.
    top = git("rev-parse", "--show-toplevel")
    return top is not None and os.path.realpath(top) == ROOT


def commit_of(revision):
    """Returns the full hash of a revision, or None."""
    if not has_repository() or revision.startswith("-"):
        return None
    return git("rev-parse", "--verify", "--quiet", f"{revision}^{{commit}}") or None


def is_dirty():
    return git("status", "--porcelain", "--untracked-files=no") != ""


def compiles_as(commit):
    """Returns whether this tree's programs would be compiled from the same text as that commit's."""
    return (git("diff", "--quiet", commit, "--", *COMPILED) is not None
            and git("ls-files", "--others", "--exclude-standard", "--", *COMPILED) == "")


def in_setup(commands, *arguments):
    """Runs shell commands with the functions of setup.sh; what they print goes to stderr, at once. Throws Stop."""
    script = f'set -euo pipefail; ROOT=$1; shift; . {SETUP!r}; {commands}'
    reason = ""
    with subprocess.Popen(["bash", "-c", script, PROGRAM, *arguments], stdin=subprocess.DEVNULL, stdout=sys.stderr,
                          stderr=subprocess.PIPE, encoding="utf-8", errors="replace") as process:
        for line in process.stderr:
            if line.startswith(f"{PROGRAM}: "):  # why it ends, which is for Stop
                reason = line.partition(": ")[2]
            else:
                say(line.rstrip("\n"))
    if process.returncode:
        raise Stop(one_line(reason) or f"set-up failed with {process.returncode}")


def install(allowed):
    in_setup('install_packages "$1"', ROOT, "yes" if allowed else "no")


def folder_of(machine, place=ROOT):
    """Returns where a tree in `place` is built for a machine."""
    return os.path.join(place, "build" if machine == NATIVE else f"build-{machine}")


def build(folder, target, machine, source=ROOT):
    """Configures and builds a target of the tree at `source` in `folder`. Throws Stop."""
    before = [] if knows_kernels(source) else KERNELS_OF_BEFORE[machine]
    in_setup('choose_machine "$1"; shift; build "$@" "${MACHINE_OPTIONS[@]}"', source, machine, folder, target,
             "-DCMAKE_BUILD_TYPE=Release", *before)


def knows_kernels(source):
    with open(os.path.join(source, "CMakeLists.txt"), encoding="utf-8") as file:
        return "ISOSYRK_KERNELS" in file.read()


def cells_program(folder):
    return os.path.join(folder, "benchmarks", "regression_cells")


def program_environment(keep_coretype):
    """Returns the environment of what is measured: one thread, and OpenBLAS picks its kernels for this processor, if
    none were chosen that are to be kept."""
    steering = ("OPENBLAS_", "OMP_", "BENCHMARK_")
    kept = {name: value for name, value in os.environ.items()
            if not name.startswith(steering) or keep_coretype and name == CORETYPE}
    return {**kept, "OPENBLAS_NUM_THREADS": "1"}


def build_base(commit, machine):
    """Returns the folder of a commit's programs; kept, so that the next gate finds them. Throws Stop."""
    home = os.path.join(ROOT, "build-base")
    place = os.path.join(home, commit)
    folder = folder_of(machine, place)
    if os.path.exists(cells_program(folder)):
        return folder
    source = os.path.join(place, "source")
    try:
        if not os.path.exists(source):
            shutil.rmtree(home, ignore_errors=True)  # of an earlier base, or a part of this one
            part = f"{source}.part"
            os.makedirs(part)
            in_setup('git -C "$ROOT" archive "$1" | tar -x -C "$2"', ROOT, commit, part)
            os.replace(part, source)
        build(folder, "regression_cells", machine, source)
    except Stop as problem:
        raise Stop(f"base {commit[:12]}: {problem}") from None
    return folder
