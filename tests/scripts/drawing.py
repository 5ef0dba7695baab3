"""What the tests of the scripts that draw share. The Python that draws may be another than the one that runs the
tests."""

import importlib
import os
import struct
import sys
import xml.etree.ElementTree

import programs
from programs import FolderTest, environment, run, snapshot

from lib.programs import chart_python

FOUND = chart_python.find()
PYTHON = FOUND or sys.executable  # the one that draws, so that a script need not look for it


def lines_of(axes):
    """Returns the points of each line of a panel that carries a name."""
    return {line.get_label(): finite_points(line) for line in axes.lines if not line.get_label().startswith("_")}


def finite_points(line):
    return [[float(x), float(y)] for x, y in line.get_xydata() if x == x and y == y]


class DrawingTest(FolderTest):
    """Runs the script named by `script`."""

    python = PYTHON

    def assert_whole(self, files, chart):
        """Both files of a chart are whole, and wide enough for a page."""
        root = xml.etree.ElementTree.fromstring(files[f"{chart}.svg"])
        self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
        png = files[f"{chart}.png"]
        self.assertEqual((png[:8], png[-8:-4]), (b"\x89PNG\r\n\x1a\n", b"IEND"), chart)
        width, height = struct.unpack(">II", png[16:24])
        self.assertEqual((width, height > 450), (1600, True), chart)

    def module(self, name):
        """Returns a module of scripts/lib that draws; skips the test where this Python has no matplotlib."""
        self.assertIsNotNone(FOUND, chart_python.complaint())
        if os.path.realpath(FOUND) != os.path.realpath(sys.executable):
            self.skipTest(f"to be run by {FOUND}, which has matplotlib")
        os.environ.setdefault("MPLCONFIGDIR", self.path("matplotlib"))
        return importlib.import_module(name)

    def panels(self, module, chart, *arguments):
        """Draws a chart of a module of scripts/lib; returns its panels, in lists by their titles."""
        with self.module("lib.pages.chart_panels").own_style():
            figure = getattr(self.module(module), chart)(*arguments)
        found = {}
        for axes in figure.axes:
            found.setdefault(axes.get_title(loc="left"), []).append(axes)
        return found

    def render(self, *arguments, **changes):
        """Runs the script to its end, with changes of the environment."""
        settings = environment(**{"MPLCONFIGDIR": self.path("matplotlib"), "PYTHONDONTWRITEBYTECODE": "1", **changes})
        return run([self.python, programs.RENDER, self.package, *arguments], timeout=300, env=settings)

    def rendered(self, folder, *arguments, **changes):
        """Returns the files that the script makes of its arguments in a folder of this test, without a word."""
        done = self.render(*arguments, "--out", self.path(folder), **changes)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        return snapshot(self.path(folder))
