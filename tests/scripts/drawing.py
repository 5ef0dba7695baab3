"""What the tests of the scripts that draw share. The Python that draws may be another than the one that runs the tests."""

import atexit
import functools
import importlib
import os
import shutil
import struct
import sys
import tempfile
import xml.etree.ElementTree

import programs
from programs import FolderTest, environment, run, run_script

LIBRARY = os.path.join(programs.ROOT, "scripts", "lib")
sys.dont_write_bytecode = True
sys.path.insert(0, LIBRARY)
import chart_python  # noqa: E402

FOUND = chart_python.find()
PYTHON = FOUND or sys.executable  # the one that draws, so that a script need not look for it


@functools.lru_cache(maxsize=None)
def load_matplotlib():
    """Loads it here, so that a copy of this process need not; tells whether this is the Python that draws."""
    if not FOUND or os.path.realpath(FOUND) != os.path.realpath(sys.executable):
        return False
    # Its files away from the user's, and no threads: a copy would have none of them.
    os.environ.update(MPLCONFIGDIR=tempfile.mkdtemp(prefix="isosyrk-"), OPENBLAS_NUM_THREADS="1")
    chart_python.settle_arithmetic()
    atexit.register(shutil.rmtree, os.environ["MPLCONFIGDIR"], ignore_errors=True)
    import matplotlib.backends.backend_agg
    import matplotlib.backends.backend_svg  # noqa: F401
    return True


def lines_of(axes):
    """Returns the points of each line of a panel that carries a name."""
    return {line.get_label(): finite_points(line) for line in axes.lines if not line.get_label().startswith("_")}


def finite_points(line):
    return [[float(x), float(y)] for x, y in line.get_xydata() if x == x and y == y]


class DrawingTest(FolderTest):
    """Runs the script named by `script`."""

    python = PYTHON

    def setUp(self):
        super().setUp()
        self.settings = environment(MPLCONFIGDIR=self.path("matplotlib"), PYTHONDONTWRITEBYTECODE="1")

    def assert_whole(self, files, chart):
        """Both files of a chart are whole, and wide enough for a page."""
        root = xml.etree.ElementTree.fromstring(files[f"{chart}.svg"])
        self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
        png = files[f"{chart}.png"]
        self.assertEqual((png[:8], png[-8:-4]), (b"\x89PNG\r\n\x1a\n", b"IEND"), chart)
        width, height = struct.unpack(">II", png[16:24])
        self.assertEqual((width, height > 450), (1600, True), chart)

    def panels(self, module, chart, *arguments):
        """Draws a chart of a module of scripts/lib; returns its panels that are seen, in lists by their titles."""
        self.assertIsNotNone(FOUND, chart_python.complaint())
        if not load_matplotlib():
            self.skipTest(f"to be run by {FOUND}, which has matplotlib")
        with importlib.import_module("chart_panels").own_style():
            figure = getattr(importlib.import_module(module), chart)(*arguments)
        found = {}
        for axes in figure.axes:
            found.setdefault(axes.get_title(loc="left"), []).append(axes)
        return found

    def render(self, *arguments, **changes):
        """Runs the script to its end, if possible in a copy of this process, which starts sooner.

        With changes of the environment it runs as a user has it.
        """
        script = os.path.join(programs.ROOT, "scripts", self.script)
        if changes or not load_matplotlib():
            return run([self.python, script, *arguments], timeout=300, env={**self.settings, **changes})
        return run_script(script, *arguments, timeout=300)
