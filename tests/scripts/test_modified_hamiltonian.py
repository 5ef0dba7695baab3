"""The coefficients of the modified Hamiltonian that core/ uses are those that a derivation in fractions gives."""

import os
import re
import unittest
from fractions import Fraction

import derive_modified_hamiltonian as derivation

HEADER = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "core", "integrators",
                      "modified_gradient.h")


def coefficients_of(header):
    """Returns {term: coefficient} of the table in the text of a header."""
    table = re.search(r"namespace modified_hamiltonian \{\n(.*?)\}", header, re.S)[1]
    lines = [line for line in table.splitlines() if line]
    found = [re.fullmatch(r"inline constexpr double (\w+) = (\d+)\.0 / (\d+)\.0;", line) for line in lines]
    return {name: Fraction(int(above), int(below)) for name, above, below in (each.groups() for each in found)}


class ModifiedHamiltonian(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(HEADER, encoding="utf-8") as file:
            cls.header = file.read()
        cls.derived = derivation.derived()
        cls.halved = {name: number / 2 if name != "f_Bf" else number for name, number in cls.derived.items()}

    def test_the_coefficients_of_the_header_are_the_derived_ones(self):
        self.assertEqual(coefficients_of(self.header), self.derived)
        changed = self.header.replace("p_Bc = 2.0", "p_Bc = 3.0")
        self.assertNotEqual(coefficients_of(changed), self.derived)

    def test_the_order_is_6_with_them_and_less_with_others(self):
        # None of those that the coefficients were derived from; the controls are quick on a small one.
        large, small = derivation.Flow(4, 7), derivation.Flow(3, 7)

        def order(coefficients, flow=small):
            difference = flow.difference(coefficients)
            return next((k for k, A in enumerate(difference) if any(map(any, A))), derivation.HIGHEST + 1) - 1

        self.assertEqual(order({}), 2)
        self.assertEqual(order({"f_Bf": self.derived["f_Bf"]}), 4)
        self.assertEqual(order(self.derived, large), derivation.HIGHEST)  # at least: nothing is left of the powers kept
        self.assertEqual(order({"f_Bf": self.derived["f_Bf"] * Fraction(11, 10)}), 2)
        self.assertEqual(order(self.halved), 4)

    def test_no_term_can_be_left_out(self):
        with self.assertRaisesRegex(ArithmeticError, "no solution"):
            derivation.solution([((), right) for _, right in derivation.Flow(4, 1).equations({}, ["f_Bf"])])
        terms = [name for name in derivation.TERMS if name != "f_Bf"]
        rows = derivation.Flow(5, 2).equations({"f_Bf": self.derived["f_Bf"]}, terms)
        self.assertEqual(derivation.solution(rows), [self.derived[name] for name in terms])
        for k, name in enumerate(terms):
            with self.subTest(name), self.assertRaisesRegex(ArithmeticError, "no solution"):
                derivation.solution([(left[:k] + left[k + 1:], right) for left, right in rows])

    def test_the_hamilton_jacobi_equation_holds(self):
        flow = derivation.Flow(4, 8)
        self.assertEqual(set(flow.hamilton_jacobi_defect(self.derived)), {0})
        defect = flow.hamilton_jacobi_defect(self.halved)
        self.assertEqual(next(k for k, number in enumerate(defect) if number), 4)


if __name__ == "__main__":
    unittest.main()
