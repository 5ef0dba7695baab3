"""Made-up raw files of the study scaling."""

import os

import programs  # noqa: F401, which makes lib importable

from lib.records import formats
from lib.records.formats import INTEGRATORS, listed
from studies.scaling.schema import SCHEMA, Point, Settings

TIMES_AS_FAST = {"published": 1.0, "fast": 5.0}
NOISE = (1.0, 1.1, 1.3)


def point(name="group2", n=17, ablation="fast", start=5.0, seconds=None, **others):
    """Returns a point: a step takes 17 µs published, a fifth of it fast, and half of it on other ablations.

    `seconds` are taken in place of these times.
    """
    times = TIMES_AS_FAST.get(ablation, 2.0)
    found = [noise * 17e-6 / times for noise in NOISE] if seconds is None else seconds
    values = {"start": start, "n": n, "integrator": name, "ablation": ablation, "step": 0.1, "tolerance": 1e-13,
              "steps": 8, "sweeps": 12.0, "equivalent_products": 100.0 / times, "seconds": found, **others}
    return Point(**values)


def failed(**values):
    return point(**values, seconds=[], sweeps=None, equivalent_products=None)


def write_tables(path, scene="smooth", **tables):
    """Writes a raw file with these tables, and that of the integrators of its points, and returns its path."""
    names = dict.fromkeys(each.integrator for each in tables.get("points", ()))
    formats.write_study(path, SCHEMA, {"cpu": "a processor"}, Settings(scene, 2.0),
                        {**{name: [] for name in SCHEMA.tables}, INTEGRATORS: list(map(listed, names)), **tables})
    return path


def write_scaling(folder, ablations=("published", "without any", "without bands", "fast")):
    """Writes a raw file with these ablations of group2 at n = 17 and returns its path."""
    return write_tables(os.path.join(folder, "raw.json"), points=[point(ablation=ablation) for ablation in ablations])
