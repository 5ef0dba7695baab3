"""Tests of scripts/lib/stability.py: what its readers refuse, and what they find in made-up files."""

import copy
import os
import sys
import unittest

from programs import ROOT, FolderTest
from stability_documents import (BISECTED, GRID, INTEGRATORS, LONG_STEPS, SETTINGS, SHARES, fail, long_document,
                                 map_document, norm, write_document)

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
import stability  # noqa: E402
from benchmark_json import UnusableFile  # noqa: E402


class ReaderTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.map, self.long = map_document(), long_document()

    def assert_refused(self, analyse, document, *words):
        """Refused, in one short line that has every one of `words` in it."""
        with self.assertRaises(UnusableFile) as caught:
            analyse(document)
        self.assert_one_line(f"{caught.exception}\n", *words)
        self.assertLess(len(str(caught.exception)), 300)

    def map_refused(self, *words):
        self.assert_refused(stability.failure_map, self.map, *words)

    def long_refused(self, *words):
        self.assert_refused(stability.long_runs, self.long, *words)

    def map_of(self, name, scene="smooth", n=17):
        return next(each for each in self.map["maps"]
                    if (each["integrator"], each["scene"], each["n"]) == (name, scene, n))

    def run_of(self, name, share):
        return next(each for each in self.long["runs"] if (each["integrator"], each["share"]) == (name, share))


class SoundFileTest(ReaderTest):
    def test_the_map_is_read(self):
        failures = stability.read_map(write_document(self.folder, self.map, "map.json"))
        self.assertEqual((failures.scenes(), failures.sizes("smooth"), list(failures.integrators), len(failures.maps)),
                         (["smooth", "rough"], [17, 129], list(INTEGRATORS), len(SETTINGS) * len(INTEGRATORS)))

    def test_values_stand_where_they_belong(self):
        each = stability.failure_map(self.map).at("smooth", 129, "algebra2")
        self.assertEqual((each.linear_limit, each.critical.works.h_norm_B, each.critical.fails.h_norm_B, each.largest_working,
                          each.critical.fails.status), (1.9, 1.9, BISECTED * 1.9, 1.9, "diverged"))
        self.assertEqual([trial.h_norm_B for trial in each.trials], GRID)
        self.assertEqual((each.trials[0].sweeps_per_step, each.trials[0].steps, each.trials[-1].failed_step),
                         (50 * GRID[0], 5, 3))

    def test_an_integrator_that_never_fails(self):
        each = stability.failure_map(self.map).at("smooth", 17, "rkmk4")
        self.assertEqual((each.critical, each.always_works, each.largest_working), (None, True, GRID[-1]))

    def test_an_integrator_that_never_works(self):
        each = self.map_of("rk4")
        each.update(critical=None, trials=[trial for trial in each["trials"] if trial["status"] != "converged"])
        self.assertIsNone(stability.failure_map(self.map).at("smooth", 17, "rk4").largest_working)

    def test_the_long_runs_are_read(self):
        runs = stability.read_long_runs(write_document(self.folder, self.long, "long_runs.json"))
        self.assertEqual((runs.steps, runs.settings(), tuple(runs.shares()), len(runs.runs)),
                         (LONG_STEPS, [("smooth", 17)], SHARES, 2 * (len(INTEGRATORS) + 1)))
        run = runs.at("smooth", 17, 0.9, "rk4")
        self.assertEqual((run.status, run.survived, run.failed_step, run.steps, run.step),
                         ("unstable", False, 500, 499, 0.9 * 2.0 / norm(17)))
        self.assertEqual((run.samples[0].step, run.samples[0].casimir_error), (1, run.samples[0].spectrum_error))

    def test_series_of_quantities_leave_out_what_was_not_finite(self):
        sample = self.run_of("group1", 0.9)["samples"][3]
        sample.update(energy_error=None, casimir_errors=[1e-15, None, 1e-15, 1e-15])
        run = stability.long_runs(self.long).at("smooth", 17, 0.9, "group1")
        lengths = [len(quantity.series(run)) for quantity in stability.QUANTITIES]
        self.assertEqual([len(run.samples) - length for length in lengths], [0, 0, 1, 1])

    def test_what_a_run_that_blew_up_last_came_to_is_no_number(self):
        run = self.run_of("rk4", 0.9)
        run["samples"][-1].update(skew_defect=1e200, casimir_errors=[1e-3, 1e30, 1e-3, 1e-3])
        sample = stability.long_runs(self.long).at("smooth", 17, 0.9, "rk4").samples[-1]
        self.assertEqual((sample.skew_defect, sample.casimir_error), (None, None))
        self.assertIsNotNone(sample.spectrum_error)


class RefusalTest(ReaderTest):
    def test_unknown_status_and_scene(self):
        self.map_of("group1")["trials"][0]["status"] = self.run_of("rk4", 0.9)["status"] = "finished"
        self.map_refused("finished", "converged", "sweep cap")
        self.long_refused("finished", "converged", "sweep cap")
        self.map = map_document()
        self.map_of("group1")["scene"] = "stormy"
        self.map_refused("stormy", "smooth")

    def test_unlisted_integrator(self):
        self.map_of("group1")["integrator"] = self.run_of("rk4", 0.9)["integrator"] = "magic"
        self.map_refused("magic")
        self.long_refused("magic")

    def test_unlisted_setting(self):
        self.map["settings"] = self.map["settings"][1:]
        self.map_refused("smooth at n = 17")

    def test_doubled_entries(self):
        for name in ("integrators", "settings", "maps"):
            with self.subTest(list=name):
                self.map = map_document()
                self.map[name].append(copy.deepcopy(self.map[name][0]))
                self.map_refused("twice")
        self.long["runs"].append(copy.deepcopy(self.long["runs"][0]))
        self.long_refused("twice")

    def test_no_trials(self):
        self.map_of("group1")["trials"] = []
        self.map_refused("without trials")

    def test_a_converged_trial_without_errors(self):
        self.map_of("group1")["trials"][0]["energy_error"] = None
        self.map_refused("is converged and has no value of energy_error")

    def test_a_failed_run_without_samples_is_sound(self):
        fail(self.run_of("group1", 0.9), 1, "diverged")
        self.assertEqual(stability.long_runs(self.long).at("smooth", 17, 0.9, "group1").samples, ())


if __name__ == "__main__":
    unittest.main()
