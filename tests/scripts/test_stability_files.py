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
        each = failures.at("smooth", 129, "algebra2")
        self.assertEqual((each.linear_limit, each.critical.works.h_norm_B, each.critical.fails.h_norm_B, each.largest_working,
                          each.critical.fails.status), (1.9, 1.9, BISECTED * 1.9, 1.9, "diverged"))
        self.assertEqual([trial.h_norm_B for trial in each.trials], GRID)
        self.assertEqual((each.trials[0].sweeps_per_step, each.trials[0].steps, each.trials[-1].failed_step),
                         (50 * GRID[0], 5, 3))

    def test_integrators_that_always_or_never_work(self):
        each = self.map_of("rk4")
        each.update(critical=None, trials=[trial for trial in each["trials"] if trial["status"] != "converged"])
        failures = stability.failure_map(self.map)
        self.assertEqual([failures.at("smooth", 17, name).largest_working for name in ("rkmk4", "rk4")], [GRID[-1], None])

    def test_the_long_runs_are_read(self):
        runs = stability.read_long_runs(write_document(self.folder, self.long, "long_runs.json"))
        self.assertEqual((runs.steps, runs.settings(), tuple(runs.shares()), len(runs.runs)),
                         (LONG_STEPS, [("smooth", 17)], SHARES, 2 * (len(INTEGRATORS) + 1)))
        run = runs.at("smooth", 17, 0.9, "rk4")
        self.assertEqual((run.status, run.survived, run.failed_step, run.steps, run.step),
                         ("unstable", False, 500, 499, 0.9 * 2.0 / norm(17)))
        self.assertEqual((run.samples[0].step, run.samples[0].casimir_error), (1, run.samples[0].spectrum_error))

    def test_what_was_not_finite_or_beyond_all_bounds_is_left_out_of_a_series(self):
        samples = self.run_of("group1", 0.9)["samples"]
        samples[3].update(energy_error=None, casimir_errors=[1e-15, None, 1e-15, 1e-15])
        samples[-1].update(skew_defect=1e200, casimir_errors=[1e-3, 1e30, 1e-3, 1e-3])
        run = stability.long_runs(self.long).at("smooth", 17, 0.9, "group1")
        lengths = [len(quantity.series(run)) for quantity in stability.QUANTITIES]
        self.assertEqual([len(run.samples) - length for length in lengths], [0, 1, 2, 1])

    def test_a_failed_run_without_samples_is_sound(self):
        fail(self.run_of("group1", 0.9), 1, "diverged")
        self.assertEqual(stability.long_runs(self.long).at("smooth", 17, 0.9, "group1").samples, ())


class RefusalTest(ReaderTest):
    def test_maps(self):
        for field, value, *words in (
                ("scene", "stormy", "stormy", "smooth"), ("integrator", "magic", "magic"), ("n", 33, "smooth at n = 33"),
                ("trials", [], "without trials")):
            with self.subTest(field=field):
                self.map = map_document()
                self.map_of("group1")[field] = value
                self.map_refused(*words)
        for field, value, *words in (("status", "finished", "finished", "converged", "sweep cap"),
                                     ("energy_error", None, "is converged and has no value of energy_error")):
            with self.subTest(field=field):
                self.map = map_document()
                self.map_of("group1")["trials"][0][field] = value
                self.map_refused(*words)

    def test_long_runs(self):
        for field, value, *words in (("status", "finished", "finished", "converged", "sweep cap"),
                                     ("integrator", "magic", "magic")):
            with self.subTest(field=field):
                self.long = long_document()
                self.run_of("rk4", 0.9)[field] = value
                self.long_refused(*words)

    def test_doubled_entries(self):
        for name in ("integrators", "settings", "maps"):
            with self.subTest(list=name):
                self.map = map_document()
                self.map[name].append(copy.deepcopy(self.map[name][0]))
                self.map_refused("twice")
        self.long["runs"].append(copy.deepcopy(self.long["runs"][0]))
        self.long_refused("twice")


if __name__ == "__main__":
    unittest.main()
