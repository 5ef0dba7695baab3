"""Builds for the regression gate: this tree, and a tree of another revision beside it."""

import os
import shutil
import subprocess
import sys

from lib.messages import one_line
from lib.command_line import Stop, say

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
HEAD = os.path.join(ROOT, "build")  # where this tree is built
ANSWERS = os.path.join(ROOT, "tests", "data")  # reference answers
SETUP = os.path.join(ROOT, "scripts", "lib", "setup.sh")


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


def in_setup(commands, *arguments):
    """Runs shell commands with the functions of setup.sh; what they print goes to stderr. Throws Stop."""
    script = f'set -euo pipefail; ROOT=$1; shift; . {SETUP!r}; {commands}'
    done = subprocess.run(["bash", "-c", script, "check_regression", *arguments], stdin=subprocess.DEVNULL,
                          stdout=sys.stderr, stderr=subprocess.PIPE, encoding="utf-8", errors="replace", check=False)
    lines = done.stderr.splitlines()
    reason = lines.pop().partition(": ")[2] if done.returncode and lines else ""
    for line in lines:
        say(line)
    if done.returncode:
        raise Stop(one_line(reason) or f"set-up failed with {done.returncode}")


def install(allowed):
    in_setup('install_packages "$1"', ROOT, "yes" if allowed else "no")


def build(folder, target, source=ROOT):
    """Configures and builds a target of the tree at `source` in `folder`. Throws Stop."""
    in_setup('build "$@"', source, folder, target, "-DCMAKE_BUILD_TYPE=Release")


def cells_program(folder):
    return os.path.join(folder, "benchmarks", "regression_cells")


def program_environment():
    """Returns the environment of what is measured: OpenBLAS picks its kernels for this processor, one thread."""
    steering = ("OPENBLAS_", "OMP_", "BENCHMARK_")
    kept = {name: value for name, value in os.environ.items() if not name.startswith(steering)}
    return {**kept, "OPENBLAS_NUM_THREADS": "1"}


def build_base(commit):
    """Returns the folder of a commit's programs; kept, so that the next gate finds them. Throws Stop."""
    home = os.path.join(ROOT, "build-base")
    place = os.path.join(home, commit)
    folder = os.path.join(place, "build")
    if os.path.exists(cells_program(folder)):
        return folder
    shutil.rmtree(home, ignore_errors=True)  # of an earlier base
    source = os.path.join(place, "source")
    os.makedirs(source)
    try:
        in_setup('git -C "$ROOT" archive "$1" | tar -x -C "$2"', ROOT, commit, source)
        build(folder, "regression_cells", source)
    except Stop as problem:
        raise Stop(f"base {commit[:12]}: {problem}") from None
    return folder
