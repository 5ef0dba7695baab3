"""Tests of the study of one turbulent flow: its pictures show what its raw file holds, and its grid is the sphere's."""

import json
import os
import sys
import unittest

import drawing
from programs import BUILD, HAS_MODULE, RENDER, FolderTest, environment, run, snapshot, text_of
from test_damage import write_fluid

from studies.fluid.schema import COLUMNS, ROWS, SCALE

if HAS_MODULE:
    sys.path.insert(0, os.path.join(BUILD, "python"))
    import isosyrk
    import numpy
    from studies.fluid import run as fluid_study


class Pictures(FolderTest):
    def test_another_vorticity_changes_the_pictures_and_nothing_else(self):
        path = write_fluid(self.folder)
        first = self.rendered(path, "first")
        document = json.loads(text_of(path))
        self.assertEqual(self.rendered(path, "again"), first)  # the control
        row = document["tables"]["ends"]["rows"][0]
        field = row[document["tables"]["ends"]["columns"].index("vorticity")]
        field[len(field) // 4:len(field) // 3] = [SCALE] * (len(field) // 3 - len(field) // 4)
        self.write("raw.json", json.dumps(document))
        changed = self.rendered(path, "changed")
        self.assertEqual({name for name in first if first[name] != changed[name]}, {"methods.png"} & set(first))

    def rendered(self, path, name):
        done = run([drawing.PYTHON, "-B", RENDER, "fluid", path, "--out", self.path(name)], timeout=100,
                   env=environment(MPLCONFIGDIR=self.path("matplotlib")))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return snapshot(self.path(name))


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class Grid(unittest.TestCase):
    def test_cells_are_those_of_the_sphere_and_shares_of_the_largest_vorticity(self):
        """A harmonic of degree 1 is sin θ: rows rise from the south pole, and columns are alike."""
        scene = isosyrk.scene("one", n=9, modes=[(1, 0, 1.0, 0.0)])
        state = fluid_study.state_of(scene.initial, fluid_study.largest_of(scene))
        field = numpy.reshape(state["vorticity"], (ROWS, COLUMNS))
        latitudes = numpy.pi * ((numpy.arange(ROWS) + 0.5) / ROWS - 0.5)
        sign = numpy.sign(field[-1, 0])
        expected = sign * SCALE * numpy.sin(latitudes) / numpy.sin(latitudes[-1])
        self.assertLessEqual(abs(field - expected[:, numpy.newaxis]).max(), 1)
        self.assertGreater(abs(field + expected[:, numpy.newaxis]).max(), SCALE)  # the control: upside down

    def test_a_run_that_fails_has_no_end(self):
        job = {"n": 11, "sample": 0, "integrator": "group2", "step": 50.0, "tolerance": 1e-8, "time": 100.0}
        self.assertIsNone(fluid_study.end_of(job))
        found = fluid_study.end_of({**job, "step": 0.5, "time": 5.0})
        self.assertLess(found["spectrum_error"], 1e-7)
