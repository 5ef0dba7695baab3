"""Tests of what the regression gate catches: the real program, and the same with a fault in the library under it.

Whatever kernels run here, counts of two builds on the same kernels part only where one is another algorithm.
"""

import os
import unittest

from programs import BUILD, DATA, environment, program

from gate.cells import Baseline, UNKNOWN, cells_of, report_of
from gate.layers import OTHER_ROUNDINGS, accuracy_layer, exact_layer

NAMES = cells_of((17,))
ELSEWHERE = Baseline("0" * 40, {}, {name: {"allocations": 0} for name in NAMES})  # of other kernels, wherever this runs
OTHER_KERNELS = ("Nehalem", "Haswell")  # of OpenBLAS; every x86-64 processor has the first


def faulty(name):
    return os.path.join(BUILD, "tests", "faults", name, "regression_cells")


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.base = cls.report(program("regression_cells"))

    @staticmethod
    def report(path, names=tuple(NAMES), **changes):
        return report_of(path, names, environment(**changes), OTHER_ROUNDINGS)

    def exact(self, head, base=None):
        """Returns the layer of head on kernels that are not the recorded ones."""
        return exact_layer(ELSEWHERE._replace(rounding=dict.fromkeys(head.rounding, UNKNOWN)), head, base or self.base,
                           NAMES)

    def failures(self, layer):
        return [check.line() for check in layer.failures()]

    def test_another_rounding_is_no_regression(self):
        none = self.report(faulty("none"))
        self.assertEqual(self.failures(self.exact(none)), [])
        self.assertEqual(self.failures(accuracy_layer(none, NAMES, DATA)), [])
        for kernels in OTHER_KERNELS:
            with self.subTest(kernels=kernels):
                other = self.report(program("regression_cells"), OPENBLAS_CORETYPE=kernels)
                same = other._replace(rounding=self.base.rounding)  # as if they could be compared
                self.assertEqual(self.failures(self.exact(same)), [])
                self.assertEqual(self.failures(accuracy_layer(other, NAMES, DATA)), [])

    def test_one_sweep_more_in_every_step_is_one_in_every_cell_of_it(self):
        layer = self.exact(self.report(faulty("sweep")))
        self.assertEqual({check.cell for check in layer.failures() if check.quantity == "sweeps"}, set(NAMES))

    def test_a_coupling_that_is_wrong_by_a_tenth_is_one(self):
        layer = self.exact(self.report(faulty("coupling")))
        self.assertEqual({check.cell for check in layer.failures()}, {f"fast_group/n:17/s:{s}" for s in (1, 2, 3)})

    def test_a_coefficient_off_by_1e_10_is_one_by_counts_and_by_accuracy(self):
        head = self.report(faulty("tableau"))
        self.assertNotEqual(self.failures(self.exact(head)), [])
        cells = {check.cell for check in accuracy_layer(head, NAMES, DATA).failures()}
        self.assertLessEqual({name for name in NAMES if name.split("/")[0] in ("group", "cotangent", "fast_group")},
                             cells)


if __name__ == "__main__":
    unittest.main()
