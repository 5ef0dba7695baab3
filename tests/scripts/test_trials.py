"""Tests of lib/trials.py and of the timing of lib/duels.py with made-up outcomes and times.

Run with: python3 -m unittest test_trials (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import os
import sys
import unittest
from unittest import mock

from programs import BUILD

sys.path.insert(0, os.path.join(BUILD, "python"))

from lib import duels, formats, trials
from lib.formats import CONVERGED

FAILED = "diverged"


class Grid(unittest.TestCase):
    def places_tried(self, work):
        """Returns how often GRID_STEP is in each trial over GRID_START, where these places work and others fail."""
        tried = []

        def outcome(h_norm_B):
            place = next(each for each in range(-99, 99)
                         if abs(trials.GRID_START * trials.GRID_STEP**each / h_norm_B - 1) < 1e-9)
            tried.append(place)
            return CONVERGED if place in work else FAILED

        found = trials.grid_of(outcome)
        self.assertEqual(list(found), sorted(found))
        return sorted(tried)

    def test_islands_of_steps_that_work_are_found_while_fewer_failures_lie_between(self):
        between = trials.FAILURES_THAT_END
        islands = (0, between, 2 * between)  # with one failure less than what ends the grid before each
        self.assertEqual(self.places_tried(islands), list(range(3 * between + 1)))
        # The control: one more failure ends it.
        self.assertEqual(self.places_tried((0, between + 1)), list(range(between + 1)))

    def test_it_begins_below_where_the_first_trial_fails(self):
        self.assertEqual(self.places_tried((-2,))[0], -2)


class Times(unittest.TestCase):
    def test_the_least_of_the_repetitions_counts(self):
        block = {"problem": ("smooth", 1.0, 9), "references": None, "process": 0, "rows": ["one"],
                 "runs": {"one": {"steps": 4, "integrator": "rk4", "solver": "fast"}}}
        for seconds in ((0.2, 0.1), (0.1, 0.2)):
            with mock.patch.object(duels, "scene_of"), mock.patch.object(duels.isosyrk, "integrator"), \
                    mock.patch.object(duels.study, "seconds_of", side_effect=seconds):
                self.assertEqual(duels.time_block(block), [0.1])

    def test_the_least_repetition_of_each_process_is_its_time(self):
        rows = [{"run_name": "table1/group/n:17/s:1", "time_unit": "ms", "cpu_time": milliseconds, "process": process}
                for process, milliseconds in ((0, 3.0), (0, 2.0), (1, 4.0), (0, 5.0), (1, 6.0))]
        found = formats.measurement(rows, (), ())
        self.assertEqual(found.times, {0: 2e-3, 1: 4e-3})


if __name__ == "__main__":
    unittest.main()
