"""Test that each study takes with --n whatever n it has by default.

Run with: python3 -m unittest test_study_sizes (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import importlib
import os
import sys
import unittest

from programs import BAD_ARGUMENTS, BUILD, MEASURE, run_script

sys.path.insert(0, os.path.join(BUILD, "python"))


class Sizes(unittest.TestCase):
    def test_the_largest_n_of_a_study_is_taken_and_a_larger_one_than_any_is_not(self):
        for name in ("claims", "longruns", "scaling", "theorem", "threads", "turbulence"):
            largest = max(importlib.import_module(f"studies.{name}.run").SIZES)
            # What is refused then is the folder, which is looked at later.
            for n, named in ((largest, "--out"), (10**5, "--n")):
                done = run_script(MEASURE, name, "--n", str(n), "--out", "/missing/folder/raw.json")
                with self.subTest(name=name, n=n):
                    self.assertEqual(done.returncode, BAD_ARGUMENTS)
                    self.assertIn(named, done.stderr)


if __name__ == "__main__":
    unittest.main()
