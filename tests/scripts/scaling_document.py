"""A small study of scaling, made up: a step of group2 takes n microseconds in the published form, a fifth of it in the
fast one, and half of it on the rungs between."""

import os
import sys

from programs import ROOT

sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
import study_file  # noqa: E402
from scaling_table import RUNGS, SCHEMA, Point, Settings  # noqa: E402

TIMES_AS_FAST = {"published": 1.0, "fast": 5.0}


def points(sizes=(9, 17)):
    return [Point("group2", n, rung, 12.0, 100.0 / TIMES_AS_FAST.get(rung, 2.0),
                  [noise * 1e-6 * n / TIMES_AS_FAST.get(rung, 2.0) for noise in (1.0, 1.1, 1.3)])
            for n in sizes for rung in RUNGS]


def write_scaling(folder, name, rows=None):
    """Writes a raw file and returns its path."""
    path = os.path.join(folder, name)
    study_file.write(path, SCHEMA, {"cpu": "a processor"}, Settings("smooth", 0.1, 20),
                     {"points": points() if rows is None else rows})
    return path
