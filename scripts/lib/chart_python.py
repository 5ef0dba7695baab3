"""Finds a Python that has matplotlib: it may be the system's own while another stands first on PATH."""

import importlib.util
import os
import shutil
import subprocess
import sys

CHOICE = "ISOSYRK_PYTHON"
LONGEST_START = 120  # seconds; the first import of matplotlib on a cold disk takes several
NO_MATPLOTLIB = 2


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


def can_import():
    if importlib.util.find_spec("matplotlib") is None:
        return False
    # Charts are drawn by one thread: more of NumPy's would only wait for work, at the cost of other processes.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        import matplotlib  # noqa: F401
    except Exception:  # a damaged or mismatched installation fails in ways of its own
        return False
    return True
