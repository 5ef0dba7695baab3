"""A small study of scaling, made up: a step of group2 takes 17 microseconds in the published form, a fifth of it in the
fast one, and half of it on the rungs between."""

import os

import programs  # finds the modules of scripts/lib

import study_file
from scaling_table import RUNGS, SCHEMA, Point, Settings

TIMES_AS_FAST = {"published": 1.0, "fast": 5.0}


def write_scaling(folder, name, rungs=tuple(RUNGS)):
    """Writes a raw file with these rungs at n = 17 and returns its path."""
    path = os.path.join(folder, name)
    points = [Point("group2", 17, rung, 12.0, 100.0 / TIMES_AS_FAST.get(rung, 2.0),
                    [noise * 17e-6 / TIMES_AS_FAST.get(rung, 2.0) for noise in (1.0, 1.1, 1.3)]) for rung in rungs]
    study_file.write(path, SCHEMA, {"cpu": "a processor"}, Settings("smooth", 0.1, 20), {"points": points})
    return path
