"""Finds a Python that has what a script needs: it may be the system's own while another stands first on PATH."""

import importlib
import os
import platform
import shutil
import subprocess
import sys

CHOICE = "ISOSYRK_PYTHON"
LONGEST_START = 120  # seconds; the first import of matplotlib on a cold disk takes several
MISSING = 2  # exit status
KERNELS_OF_ANY_X86_64 = "Prescott"  # as OpenBLAS calls them


def candidates():
    """Returns the Pythons to try, in order: the user's choice, the one on PATH, the system's own."""
    wanted = [os.environ.get(CHOICE), "python3", "/usr/bin/python3"]
    return list(dict.fromkeys(each for each in wanted if each))


def has(python, modules):
    try:
        return subprocess.run([python, "-c", f"import {', '.join(modules)}"], stdin=subprocess.DEVNULL,
                              timeout=LONGEST_START, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              check=False).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


def find(modules=("matplotlib",)):
    """Returns the path of the first candidate that can import these modules, or None."""
    return next((shutil.which(each) for each in candidates() if shutil.which(each) and has(each, modules)), None)


def complaint(modules=("matplotlib",), remedy="install python3-matplotlib"):
    return f"no Python with {', '.join(modules)} found (tried {', '.join(candidates())}); {remedy}"


def require(program, modules, remedy):
    """Returns where these modules can be imported; otherwise starts the script again where they can, or exits."""
    if can_import(modules):
        return
    python = find(modules)
    if python is None:
        print(f"{program}: {complaint(modules, remedy)}", file=sys.stderr)
        sys.exit(MISSING)
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(python, [python, *sys.argv])


def require_to_render(program, modules):
    """As require(), with NumPy's arithmetic settled before it is loaded."""
    settle_arithmetic()
    require(program, modules, f"install {', '.join(f'python3-{module}' for module in modules)}")


def settle_arithmetic():
    """Says how NumPy's OpenBLAS is to work, which must not have been loaded yet.

    By one thread: more would only wait for work, at the cost of other processes. And by the same kernels whatever the
    processor or the user's own choice: how they round moves what a chart puts where a pixel ends.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if platform.machine() in ("x86_64", "AMD64"):
        os.environ["OPENBLAS_CORETYPE"] = KERNELS_OF_ANY_X86_64


def can_import(modules):
    try:
        for each in modules:
            importlib.import_module(each)
    except Exception:  # a damaged or mismatched installation fails in ways of its own
        return False
    return True
