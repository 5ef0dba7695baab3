"""Tests of trials.py, of what the study of limits tries, and of the timing of comparisons.py.

Outcomes and times are made up.

Run with: python3 -m unittest test_trials (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import math
import os
import sys
import unittest
from types import SimpleNamespace
from unittest import mock

from programs import BUILD

sys.path.insert(0, os.path.join(BUILD, "python"))

import isosyrk
from studies.limits import plan as limits_plan, run as limits
import numpy
from studies.accuracy import single_runs as accuracy_runs
from lib.records import formats
from lib.running import trials
from lib.records.formats import CONVERGED, FAST, PUBLISHED

FAILED = "diverged"


class Lengths(unittest.TestCase):
    STEPS = [10.0**(place / 40) for place in range(-120, 81)]  # h from 0.001 to 100

    def test_a_long_trial_has_more_steps_than_the_short_one_of_every_step_size(self):
        for explicit in (False, True):
            for h in self.STEPS:
                short, long = trials.short_steps(h, explicit), trials.long_steps(h, explicit)
                self.assertEqual(long, trials.LONGER * short)
                self.assertGreater(long, short)
                for steps, time in ((short, trials.TIME), (long, trials.LONGER * trials.TIME)):
                    self.assertGreaterEqual(steps * h, time * (1 - 1e-11))  # the rounding that short_steps forgives
                self.assertGreaterEqual(short, trials.MIN_STEPS[explicit])

    def test_trials_that_differ_in_time_alone_would_be_one_run_at_long_steps(self):
        """The control: the longer time with the same least number of steps."""
        for explicit, h in ((False, 1.0), (True, 0.125)):
            longer_time = trials.LONGER * trials.TIME
            self.assertEqual(max(math.ceil(longer_time / h), trials.MIN_STEPS[explicit]),
                             trials.short_steps(h, explicit))

    def test_both_trials_run_the_steps_they_should(self):
        method = trials.Method(trials.Setting(isosyrk.scene("smooth", n=9)), "rk4", FAST)
        taken = []

        def run(_integrator, W, _h, steps, *_):
            taken.append(steps)
            return W, None, CONVERGED, None

        with mock.patch.object(trials, "run", run):
            self.assertEqual(method.outcome(1.0), CONVERGED)
            self.assertEqual(method.trial(1.0, trials.long_steps), (CONVERGED, 0.0))
        self.assertEqual(taken, [400, 4000])

    def test_a_state_that_blew_up_has_no_energy_error_and_ends_a_trial(self):
        setting = trials.Setting(isosyrk.scene("smooth", n=9))
        for scale in (1e200, math.inf, math.nan):
            with self.subTest(scale=scale):
                W = numpy.full_like(setting.scene.initial, scale)
                self.assertTrue(math.isnan(setting.energy_error(W)))
                with mock.patch.object(trials, "run", return_value=(W, None, CONVERGED, None)):
                    method = trials.Method(setting, "rk8", FAST)
                    self.assertEqual(method.outcome(1.0), formats.NOT_FINITE)
        self.assertEqual(setting.energy_error(setting.scene.initial), 0.0)

    def test_a_state_that_blew_up_has_no_energy(self):
        scene = isosyrk.scene("smooth", n=9)
        self.assertEqual(trials.energy(scene, scene.initial), scene.energy(scene.initial))
        for gone in (1e204 * scene.initial, math.nan * scene.initial):
            self.assertTrue(math.isnan(trials.energy(scene, gone)))
        with self.assertRaises(ValueError):  # the control
            scene.energy(1e204 * scene.initial)


class Plans(unittest.TestCase):
    def setUp(self):
        self.jobs = limits_plan.jobs_of(SimpleNamespace(quick=False, integrator=None, n=None, solver=None, scene=None))

    def test_every_listed_form_has_long_trials_in_every_scene_but_published_ones_in_the_frame(self):
        """Those are not tried, as core/catalogue/measured_limits.h says."""
        listed = isosyrk.integrators()
        wanted = {*((each.name, PUBLISHED) for each in listed if not each.co_rotating),
                  *((each.name, FAST) for each in listed if each.has_fast_form)}
        for scene in limits.SCENES:
            self.assertEqual({(job["integrator"], job["solver"]) for job in self.jobs
                              if job["long"] and job["scene"] == scene}, wanted)

    def test_no_trial_is_made_twice_and_each_begins_with_the_own_state(self):
        keys = [tuple(job[name] for name in ("n", "solver", "integrator", "scene", "state")) for job in self.jobs]
        self.assertEqual(len(set(keys)), len(keys))
        for *place, _ in keys:
            self.assertIn((*place, 0), keys)

    def test_the_best_explicit_method_is_tried_wherever_others_are_at_large_n(self):
        tried = {(job["n"], job["scene"]) for job in self.jobs if job["solver"] == FAST and job["n"] >= 65}
        self.assertEqual({(job["n"], job["scene"]) for job in self.jobs if job["n"] >= 65
                          and (job["integrator"], job["solver"]) == ("rk8_frame", FAST)}, tried)


class Processes(unittest.TestCase):
    def test_a_run_of_much_work_is_timed_in_part(self):
        ran = []

        def run(W, h, steps):
            ran.append(steps)
            return W, SimpleNamespace(seconds=0.25 * steps, equivalent_products=2.0 * steps)

        W, method = numpy.zeros((10, 10)), SimpleNamespace(run=run)
        whole = accuracy_runs.PART_WORK / (8 * 10**3)  # products
        with mock.patch.object(accuracy_runs.timed, "seconds_of", return_value=7.0):
            self.assertEqual(accuracy_runs.seconds_of_part(method, W, 0.1, 100, whole), 7.0)
            self.assertEqual(ran, [])
            self.assertAlmostEqual(accuracy_runs.seconds_of_part(method, W, 0.1, 100, 10 * whole), 0.125 * 10 * whole)
        self.assertEqual(ran, [10])


if __name__ == "__main__":
    unittest.main()
