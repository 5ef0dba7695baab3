"""Small parts of the recorded studies of stability and long runs, for tests that change them or need raw files."""

import os

from programs import ROOT  # which finds the modules of scripts/lib

from lib import formats
from lib.integrator_names import TABLE1_CELLS
from lib.stability_files import LONG_RUNS_SCHEMA, MAP_SCHEMA

RECORDED = os.path.join(ROOT, "results", "recorded", "stability")
SETTINGS = (("smooth", 17), ("smooth", 129), ("rough", 17))
CONTROL = "algebra2_two_products"


def part(name, schema, names):
    """Returns a recorded Study with only some of its integrators, as if of a commit without changes."""
    study = formats.read_study(os.path.join(RECORDED, name), schema)
    study.context.update(commit="0123456789ab", dirty="no")
    study.tables["integrators"] = [each for each in study.tables["integrators"] if each.name in names]
    return study


def map_study(settings=SETTINGS, names=(*TABLE1_CELLS, "yoshida4", "rkmk4", "rk4"), solver="published"):
    """Returns the Study of a map in some settings."""
    study = part("map.json" if solver == "published" else "fast_map.json", MAP_SCHEMA, names)
    for table in ("settings", "maps", "trials"):
        study.tables[table] = [each for each in study.tables[table] if (each.scene, each.n) in settings
                               and getattr(each, "integrator", names[0]) in names]
    return study


def long_study(names=("group1", "group2", "rk4", CONTROL)):
    """Returns the Study of long runs at n = 17."""
    study = part("long_runs.json", LONG_RUNS_SCHEMA, names)
    runs, samples = study.tables["runs"], study.tables["samples"]
    kept = [number for number, run in enumerate(runs) if run.n == 17 and run.integrator in names]
    study.tables["runs"] = [runs[number] for number in kept]
    study.tables["samples"] = [each._replace(run=kept.index(each.run)) for each in samples if each.run in kept]
    return study


def write(folder, study, name):
    """Writes a study's raw file and returns its path."""
    path = os.path.join(folder, name)
    schema = MAP_SCHEMA if "maps" in study.tables else LONG_RUNS_SCHEMA
    formats.write_study(path, schema, study.context, study.settings, study.tables)
    return path
