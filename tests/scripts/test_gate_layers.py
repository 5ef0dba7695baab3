"""Tests of the regression gate's layers on made-up builds: what each lets pass, and what it catches by name."""

import copy
import functools
import itertools
import json
import os
import unittest

from programs import DATA, ROOT, FolderTest, text_of

from lib.messages import UnusableFile
from lib.command_line import Stop
from lib.gate_cells import (FAST, SIZES, baseline_of, cells_of, json_text, read_baseline, read_build, report_of,
                        write_baseline)
from gate_documents import build_document, cell_of, change
from lib.gate_layers import NOT_JUDGED, PASSED, REGRESSION, Layer, accuracy_layer, exact_layer, exit_code
from lib.gate_timing import FULL, QUICK, Server, is_slower, judge_times, steps_of, time_cells

NAMES = cells_of(SIZES)
CELL = "algebra/n:33/s:2"
FAST_CELL = FAST + CELL
COMMIT = "0123456789abcdef" * 2 + "01234567"


def baseline():
    return baseline_of(read_build(build_document()), COMMIT)


class LayerTest(unittest.TestCase):
    def failures(self, document):
        return [check.line() for check in self.layer(read_build(document)).failures()]

    def assert_caught(self, document, *parts):
        failures = self.failures(document)
        self.assertTrue(any(all(part in line for part in parts) for line in failures), failures)


class Exact(LayerTest):
    def layer(self, build):
        return exact_layer(baseline(), build, NAMES)

    def moved(self, name, count, step, **context):
        """A build in which one count is another by a step."""
        document = build_document()
        document["context"].update(context)
        return change(document, name, **{count: cell_of(document, name)[count] + step})

    def test_the_same_counts_pass_and_each_that_moves_is_named_with_its_cell(self):
        self.assertEqual(self.failures(build_document()), [])
        for name, products in ((CELL, "products"), (FAST_CELL, "equivalent_products")):
            for count, step in itertools.product(("sweeps", products, "poisson_solves"), (-1, 1)):
                self.assert_caught(self.moved(name, count, step), name, count)
            self.assert_caught(self.moved(name, "allocations", 1), name, "allocations 1, allowed 0")
        self.assert_caught(self.moved(FAST_CELL, "equivalent_products", 1e-7), FAST_CELL, "equivalent_products")

    def test_other_kernels_or_for_a_fast_form_another_compiler_may_do_other_work(self):
        kernels = ({"blas_kernels": "Haswell"}, {"vector_units": "avx512f"})
        # The work of 3 of 533 sweeps, each of 6 products and 2 solves; of 10 of 100.
        for name, others, allowed in (
                (CELL, kernels, {"sweeps": 3, "products": 19, "poisson_solves": 6}),
                (FAST_CELL, (*kernels, {"compiler": "GNU 11.4.0"}),
                 {"sweeps": 3, "equivalent_products": 80, "poisson_solves": 40})):
            for other, (count, most), sign in itertools.product(others, allowed.items(), (-1, 1)):
                self.assertEqual(self.failures(self.moved(name, count, sign * most, **other)), [])
                self.assert_caught(self.moved(name, count, sign * (most + 1), **other), name, count, "±")
        self.assert_caught(self.moved(CELL, "sweeps", 1, compiler="GNU 11.4.0"), CELL, "sweeps")

    def test_a_cell_that_failed_or_is_missing_is_named(self):
        self.assert_caught(change(build_document(), CELL, status="stagnated"), CELL, "stagnated")
        document = build_document()
        document["cells"] = [cell for cell in document["cells"] if cell["name"] != CELL]
        self.assert_caught(document, CELL, "missing")


class Accuracy(LayerTest):
    def layer(self, build):
        return accuracy_layer(build, NAMES, DATA)

    def test_small_errors_pass_and_each_beyond_its_bound_is_named_with_its_cell(self):
        self.assertEqual(self.failures(build_document()), [])

        def off_the_reference(name):
            W = copy.deepcopy(cell_of(build_document(), name)["W"])
            W[200][1] += 1e-11
            return W

        for cell, quantity, value in (
                ("group/n:33/s:2", "spectrum_error", 1e-11), (CELL, "spectrum_error", 2e-13),
                ("cotangent/n:33/s:2", "skew_defect", 1e-12), (FAST_CELL, "spectrum_error", 2e-13),
                *(("cotangent/n:65/s:1", "distance_to_group", value) for value in (1e-11, None)),
                *((FAST_CELL, "distance_to_published", value) for value in (1e-9, None)),
                # Exactly zero for algebra and for fast forms.
                ("algebra/n:17/s:3", "skew_defect", 1e-25), (FAST + "cotangent/n:17/s:3", "skew_defect", 1e-25),
                *((name, "W", W) for name in ("group/n:17/s:3", "fast_group/n:17/s:2")
                  for W in (off_the_reference(name), None))):
            (failure,) = self.failures(change(build_document(), cell, **{quantity: value}))
            shown = "error against the reference answer" if quantity == "W" else quantity.replace("_", " ")
            self.assertIn(f"{cell}: {shown}", failure)
        self.assertEqual(self.failures(change(build_document(), "group/n:33/s:1", status="diverged")),
                         ["group/n:33/s:1: answer none, allowed one"])

    def test_bounds_follow_the_tolerance_and_the_contraction(self):
        for values in ({"tolerance": 1e-11}, {"contraction": 0.99}, {"contraction": 1.0}):  # with 1 there is no bound
            document = change(build_document(), "group/n:33/s:2", spectrum_error=1e-11, **values)
            self.assertEqual(self.failures(document), [])

    def test_a_fast_answer_is_bound_to_the_published_one_whatever_the_contraction(self):
        for distance, passes in ((0.9e-11, True), (1.1e-11, False)):
            document = change(build_document(), CELL, contraction=0.99)
            change(document, FAST_CELL, contraction=0.99, distance_to_published=distance)
            self.assertEqual(self.failures(document) == [], passes)


class Servers:
    """A made-up build: a run takes 10 ms times a factor, which may be another whenever it is started."""

    def __init__(self, *factors, name="", asked=None):
        self.factors = itertools.cycle(factors)
        self.name, self.asked = name, [] if asked is None else asked

    def __call__(self, cells):
        self.factor = next(self.factors)
        return self

    def seconds(self, cell, runs):
        self.asked.append(self.name)
        return 0.01 * runs * self.factor

    def close(self):
        pass


class Times(FolderTest):
    CELLS = ["group/n:17/s:2", FAST_CELL]

    def test_a_build_not_slower_by_more_than_the_limit_passes_at_once(self):
        for factor in (0.5, 1.0, 1.02):
            layer = judge_times(Servers(1.0), Servers(factor), self.CELLS)
            self.assertEqual((layer.verdict(), layer.notes), ("passed", []))

    def test_a_slower_build_is_named_by_cell_and_ratio_after_a_second_measurement(self):
        layer = judge_times(Servers(1.0), Servers(1.031), self.CELLS)
        self.assertEqual([check.cell for check in layer.failures()], self.CELLS)
        self.assertIn("1.031", layer.failures()[0].found)
        self.assertEqual(layer.notes, ["measured twice: " + ", ".join(f"{cell} (first 1.031)" for cell in self.CELLS)])

    def test_what_was_slower_only_once_passes(self):
        layer = judge_times(Servers(1.0), Servers(*[1.2] * 6, *[1.0] * 6), self.CELLS)
        self.assertEqual((layer.verdict(), len(layer.notes)), ("passed", 1))

    def test_half_of_the_pairs_slower_is_scatter_and_passes(self):
        self.assertTrue(is_slower([1.1] * 8))
        self.assertFalse(is_slower([1.1] * 5 + [0.99] * 3))
        self.assertFalse(is_slower([1.029] * 8))

    def test_turns_alternate(self):
        asked = []
        time_cells(*(Servers(1.0, name=name, asked=asked) for name in ("base", "head")), self.CELLS[:1],
                   launches=1, pairs_of_each=2)
        # After two runs of base to see how long one takes.
        self.assertEqual(asked[2:], ["base", "head", "head", "base", "head", "base", "base", "head"])

    def test_a_build_that_gives_no_times_cannot_be_judged(self):
        for script, part in (("echo no such cell >&2", "no such cell"),
                             *((f"echo ready; read line; echo {answer}", "a time was expected")
                               for answer in ("0", "nan"))):
            path = self.write("regression_cells", "#!/bin/sh\n" + script, executable=True)
            with self.subTest(script), self.assertRaisesRegex(Stop, f"regression_cells: said .*{part}"):
                judge_times(Servers(1.0), functools.partial(Server, [path], None), self.CELLS)

    def test_all_cells_exist_and_fast_ones_are_timed_over_the_whole_run(self):
        self.assertTrue(set(QUICK) <= set(cells_of((17, 33))))
        self.assertTrue(set(FULL) <= set(NAMES))
        self.assertEqual((steps_of("group/n:129/s:1"), steps_of(FAST + "group/n:129/s:1")), (1, 50))


class ExitCodes(unittest.TestCase):
    def test_a_regression_outweighs_what_was_not_judged(self):
        good, bad, not_judged = Layer("good"), Layer("bad"), Layer("timing", not_judged="why")
        good.add("cell", "quantity", 1, 1, True)
        bad.add("cell", "quantity", 2, 1, False)
        for layers, code in (([good], PASSED), ([good, not_judged], NOT_JUDGED), ([bad, not_judged], REGRESSION)):
            self.assertEqual(exit_code(layers), code)


class BaselineFile(FolderTest):
    def setUp(self):
        super().setUp()
        self.file = self.path("baseline", "baseline.json")
        write_baseline(self.file, baseline())

    def test_is_read_as_written_and_the_recorded_one_is_of_this_version(self):
        self.assertEqual(read_baseline(self.file), baseline())
        self.assertEqual(set(read_baseline(os.path.join(ROOT, "results", "baseline", "baseline.json")).counts),
                         set(NAMES))

    def test_damaged_of_another_version_or_of_other_cells_is_refused(self):
        good = json.loads(text_of(self.file))
        first, second, *rest = good["cells"]
        for changes, *parts in (({"format": "isosyrk baseline 1"}, "version", "isosyrk baseline 1"),
                                ({"commit": 7}, "commit"), ({"cells": [first, *rest]}, "other cells"),
                                ({"cells": [first, first, *rest]}, "other cells"),
                                ({"cells": [{**first, "sweeps": -1}, second, *rest]}, "sweeps")):
            path = self.write("other.json", json_text({**good, **changes}))
            with self.subTest(parts=parts), self.assertRaises(UnusableFile) as caught:
                read_baseline(path)
            self.assert_one_line(f"{caught.exception}\n", "other.json", *parts)


class Reports(FolderTest):
    def report(self, script):
        return report_of(self.write("regression_cells", "#!/bin/sh\n" + script, executable=True), NAMES[:1])

    def test_a_program_that_fails_or_says_something_else_cannot_be_judged(self):
        for script, part in (("echo 'regression_cells: no such cell' >&2; exit 2", "no such cell"),
                             ("echo '{'", "whole JSON"), ("echo '{}'", "is no document of"), ("true", "empty")):
            with self.assertRaisesRegex(Stop, part):
                self.report(script)
        with self.assertRaisesRegex(Stop, "cannot be run"):
            report_of(self.path("none"), NAMES)
