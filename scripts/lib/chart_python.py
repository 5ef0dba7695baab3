"""Finds a Python that has matplotlib: it may be the system's own while another stands first on PATH."""

import importlib.util
import os
import platform
import shutil
import subprocess
import sys

CHOICE = "ISOSYRK_PYTHON"
LONGEST_START = 120  # seconds; the first import of matplotlib on a cold disk takes several
NO_MATPLOTLIB = 2
KERNELS_OF_ANY_X86_64 = "Prescott"  # as OpenBLAS calls them


def candidates():
    """Returns the Pythons to try, in order: the user's choice, the one on PATH, the system's own."""
    wanted = [os.environ.get(CHOICE), "python3", "/usr/bin/python3"]
    return list(dict.fromkeys(each for each in wanted if each))


def has_matplotlib(python):
    try:
        return subprocess.run([python, "-c", "import matplotlib"], stdin=subprocess.DEVNULL, timeout=LONGEST_START,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


def find():
    """Returns the path of the first candidate that has matplotlib, or None."""
    return next((shutil.which(each) for each in candidates() if shutil.which(each) and has_matplotlib(each)), None)


def complaint():
    return f"no Python with matplotlib found (tried {', '.join(candidates())}); install python3-matplotlib"


def require_matplotlib(program):
    """Returns where matplotlib can be imported; otherwise starts this script again where it can, or exits with 2."""
    if can_import():
        return
    python = find()
    if python is None:
        print(f"{program}: {complaint()}", file=sys.stderr)
        sys.exit(NO_MATPLOTLIB)
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(python, [python, *sys.argv])


def settle_arithmetic():
    """Says how NumPy's OpenBLAS is to work, which must not have been loaded yet.

    By one thread: more would only wait for work, at the cost of other processes. And by the same kernels whatever the
    processor or the user's own choice: how they round moves what a chart puts where a pixel ends.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if platform.machine() in ("x86_64", "AMD64"):
        os.environ["OPENBLAS_CORETYPE"] = KERNELS_OF_ANY_X86_64


def can_import():
    if importlib.util.find_spec("matplotlib") is None:
        return False
    settle_arithmetic()
    try:
        import matplotlib  # noqa: F401
    except Exception:  # a damaged or mismatched installation fails in ways of its own
        return False
    return True
