"""Tests of scripts/lib/stability_files.py: what its readers refuse, and what they find in made-up files."""

import sys
import unittest

from programs import FolderTest

sys.dont_write_bytecode = True
from stability_documents import (BISECTED, CONTROL, GRID, LISTED, LONG_STEPS, LOST_AT, SETTINGS, SHARES, long_study,
                                 map_study, norm, write)

import stability_files  # noqa: E402  (stability_documents finds it)
from benchmark_json import UnusableFile


class SoundFiles(FolderTest):
    def test_the_map_is_read(self):
        failures = stability_files.read_map(write(self.folder, map_study(), "map.json"))
        self.assertEqual((failures.scenes(), failures.sizes("smooth"), tuple(failures.integrators), len(failures.maps)),
                         (["smooth", "rough"], [17, 129], LISTED, len(SETTINGS) * len(LISTED)))
        each = failures.at("smooth", 129, "algebra2")
        self.assertEqual((each.edge.works, each.edge.fails, each.largest_working, each.first_failure),
                         (1.9, BISECTED * 1.9, 1.9, "diverged"))
        self.assertEqual([trial.h_norm_B for trial in each.trials], GRID)

    def test_the_long_runs_are_read(self):
        runs = stability_files.read_long_runs(write(self.folder, long_study(), "long_runs.json"))
        self.assertEqual((runs.steps, runs.settings(), tuple(runs.shares()), len(runs.runs)),
                         (LONG_STEPS, [("smooth", 17)], SHARES, 2 * (len(LISTED) + 1)))
        run = runs.at("smooth", 17, 0.9, "rk4")
        self.assertEqual((run.survived, run.row.failed_step, run.row.steps, run.samples[-1].step),
                         (False, LOST_AT, LOST_AT - 1, 398))
        self.assertEqual(run.series("spectrum_error")[0], (0.9 * 2.0 / norm(17), run.samples[0].spectrum_error))
        self.assertTrue(runs.at("smooth", 17, 0.3, CONTROL).survived)

    def test_what_was_not_finite_or_beyond_all_bounds_is_left_out_of_a_series(self):
        study = long_study(("group1",))
        samples = study.tables["samples"]
        samples[3] = samples[3]._replace(energy_error=None, casimir_error=None)
        samples[4] = samples[4]._replace(skew_defect=1e200, casimir_error=1e30)
        read = stability_files.read_long_runs(write(self.folder, study, "long_runs.json"))
        run = read.at("smooth", 17, 0.9, "group1")
        lengths = [len(run.series(quantity)) for quantity in stability_files.QUANTITIES]
        self.assertEqual([len(run.samples) - length for length in lengths], [0, 1, 2, 1])


class Refusals(unittest.TestCase):
    def test_tables_that_do_not_fit_together(self):
        def as_map(study):
            return stability_files.failure_map(study, "published")

        for make, read, table, change, words in (
                (map_study, as_map, "integrators", lambda rows: rows[1:], "map of an integrator it does not list"),
                (map_study, as_map, "settings", lambda rows: rows[1:], "smooth at n = 17"),
                (map_study, as_map, "maps", lambda rows: rows[1:], "trials of no map"),
                (map_study, as_map, "maps", lambda rows: [*rows, rows[0]._replace()], "twice"),
                (map_study, as_map, "trials", lambda rows: rows[len(GRID):], "map without trials"),
                (long_study, stability_files.long_runs, "integrators", lambda rows: rows[1:], "a run of an integrator"),
                (long_study, stability_files.long_runs, "runs", lambda rows: rows[:-1], "does not list"),
                (long_study, stability_files.long_runs, "runs", lambda rows: [*rows, rows[0]._replace()], "twice"),
                (long_study, stability_files.long_runs, "runs", lambda rows: [], "no runs")):
            with self.subTest(table=table, words=words):
                study = make()
                study.tables[table] = change(study.tables[table])
                with self.assertRaisesRegex(UnusableFile, words):
                    read(study)


if __name__ == "__main__":
    unittest.main()
