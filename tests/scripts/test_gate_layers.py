"""Tests of the regression gate's layers on made-up builds: what each lets pass, and what it catches by name."""

import copy
import functools
import itertools
import json
import os
import re
import unittest

from programs import DATA, ROOT, FolderTest, text_of

from lib.programs.messages import UnusableFile
from lib.programs.command_line import Stop
from gate.cells import (FAST, ROUNDING, SIZES, baseline_of, cells_of, json_text, read_baseline, read_build, report_of,
                        write_baseline)
from gate_documents import CONTEXT, build_document, cell_of, change, with_other_roundings
from gate.layers import NOT_JUDGED, PASSED, REGRESSION, Layer, accuracy_layer, answer_bound, exact_layer, exit_code
from gate.timing import FULL, QUICK, Server, is_slower, judge_times, steps_of, time_cells

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
        return exact_layer(baseline(), build, None, NAMES)

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

    def test_a_cell_that_failed_or_is_missing_is_named(self):
        self.assert_caught(change(build_document(), CELL, status="stagnated"), CELL, "stagnated")
        document = build_document()
        document["cells"] = [cell for cell in document["cells"] if cell["name"] != CELL]
        self.assert_caught(document, CELL, "missing")


class ExactOnOtherKernels(LayerTest):
    """Head against base on kernels that are not the recorded ones; a sweep takes 6 products and 2 solves, a fast one 8
    and 4."""

    OTHER = {"blas_kernels": "Haswell"}
    COUNTS = {CELL: {"sweeps": 1, "products": 6, "poisson_solves": 2},
              FAST_CELL: {"sweeps": 1, "equivalent_products": 8, "poisson_solves": 4}}

    def setUp(self):
        self.base = self.document()

    def document(self, **context):
        document = build_document()
        document["context"].update({**self.OTHER, **context})
        return document

    def layer(self, build):
        return exact_layer(baseline(), build, read_build(self.base), NAMES)

    def moved(self, name, sweeps, *others):
        """A build whose runs of a cell take so many sweeps more, with their work, and other roundings yet more."""
        document = self.document()
        cell = cell_of(document, name)
        change(document, name, **{count: cell[count] + sweeps * of_a_sweep
                                  for count, of_a_sweep in self.COUNTS[name].items()})
        return with_other_roundings(document, name, *others)

    def test_counts_that_are_equal_pass_whatever_the_record_has(self):
        for name in (CELL, FAST_CELL):
            self.base = self.moved(name, 30)
            self.assertEqual(self.failures(self.moved(name, 30)), [])
        (note,) = self.layer(read_build(self.document())).notes
        self.assertIn("head is counted against base", note)
        self.assertIn(f"on {CONTEXT['cpu']})", note)  # of the record

    def test_each_that_decides_how_a_build_rounds_makes_them_other_kernels(self):
        for field in ROUNDING:
            with self.subTest(field=field):
                self.OTHER = {field: "another"}
                self.base = self.moved(CELL, 30)
                self.assertEqual(self.failures(self.moved(CELL, 30)), [])
        self.OTHER = {}  # the control: the recorded ones
        self.assert_caught(self.moved(CELL, 30), CELL, "sweeps")

    def test_two_sweeps_may_move_where_rounding_is_seen_to_move_none_and_no_more(self):
        for name, counts in self.COUNTS.items():
            for sign in (-1, 1):
                self.assertEqual(self.failures(self.moved(name, 2 * sign)), [])
                for count in counts:
                    self.assert_caught(self.moved(name, 3 * sign), name, count, "±")
            for count, of_a_sweep in counts.items():  # each by itself
                document = self.document()
                found = cell_of(document, name)[count] + 2.1 * of_a_sweep + 1
                self.assert_caught(change(document, name, **{count: round(found)}), name, count)

    def test_medians_may_lie_apart_by_what_rounding_moves_in_head_or_in_base(self):
        for spread_of_base, spread_of_head in ((4, 0), (0, 4), (4, 4)):
            self.base = with_other_roundings(self.document(), FAST_CELL, 0, spread_of_base)
            for gap, passes in ((6, True), (7, False)):
                with self.subTest(base=spread_of_base, head=spread_of_head, gap=gap):
                    document = self.moved(FAST_CELL, gap, 0, spread_of_head)
                    self.assertEqual(self.failures(document) == [], passes)

    def test_faults_are_seen_through_what_rounding_moves(self):
        self.base = with_other_roundings(self.document(), FAST_CELL, 1, 4, 2, 3)
        with_other_roundings(self.base, CELL, 0, 1, 0, 0)
        self.assert_caught(self.moved(CELL, 50, 0, 1, 1, 0), CELL, "sweeps", "to")  # one sweep more a step
        self.assert_caught(self.moved(FAST_CELL, 20, 3, 1, 4, 2), FAST_CELL, "sweeps", "to")  # as 0.9 K does

    def test_a_base_of_before_takes_no_other_runs(self):
        del self.base["context"]["split_kernels"]
        self.assertEqual(self.failures(self.moved(FAST_CELL, 3, 1, 2, 3, 1)), [])
        self.assert_caught(self.moved(FAST_CELL, 20, 1, 2, 3, 1), FAST_CELL, "sweeps")

    def test_allocations_are_those_of_the_record(self):
        self.assert_caught(change(self.document(), CELL, allocations=1), CELL, "allocations 1, allowed 0")

    def test_a_cell_that_base_does_not_have_is_not_judged_and_the_others_are(self):
        change(self.base, CELL, status="stagnated")
        layer = self.layer(read_build(self.document()))
        self.assertEqual((layer.verdict(), layer.not_judged), ("not judged", f"{CELL}: base has no counts, stagnated"))
        self.assertIn(FAST_CELL, {check.cell for check in layer.checks if check.quantity == "sweeps"})

    def test_without_base_or_with_one_of_other_kernels_it_is_not_judged_and_says_why(self):
        head = read_build(change(self.moved(CELL, 50), FAST_CELL, status="converged"))
        other = read_build(self.document(split_kernels="portable"))
        for base, why_none, part in ((None, "this tree is no git repository", "no git repository"),
                                     (other, None, "base runs other kernels: split_kernels portable for avx2")):
            layer = exact_layer(baseline(), head, base, NAMES, why_none)
            self.assertEqual(layer.verdict(), "not judged")
            self.assertIn(part, layer.not_judged)
            self.assertEqual({check.quantity for check in layer.checks}, {"status", "allocations"})


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

    def test_only_a_fast_form_may_be_off_by_what_its_bands_leave_out(self):
        cells = build_document()
        for name in (CELL, FAST_CELL):
            change(cells, name, contraction=0.0, tolerance=1e-8)
        cells = {cell.name: cell for cell in read_build(cells).cells.values()}
        published, fast = (answer_bound(cells[name]) for name in (CELL, FAST_CELL))
        self.assertLess(published, 1e-10)
        self.assertAlmostEqual((fast - published) / (2 * cells[CELL].steps * 0.1 * 1e-8), 1)

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
        for cells, sizes in ((QUICK, ("17", "33")), (FULL, ("17", "33", "65", "129"))):  # what --help says of them
            timed = [re.fullmatch(r"((?:fast_)?[a-z]+)/n:(\d+)/s:(\d)", cell).groups() for cell in cells]
            for found, all_of_them in zip(map(set, zip(*timed)), ({name.split("/")[0] for name in NAMES}, set(sizes),
                                                                  set("123"))):
                self.assertEqual(found, all_of_them)
            self.assertEqual(3 * len(set(cells)), 18 * len(sizes))
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
        for changes, *parts in (({"format": "isosyrk baseline 2"}, "version", "isosyrk baseline 2"),
                                ({"rounding": {}}, "rounding", "cpu"),
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

    def test_other_roundings_are_asked_for_where_the_program_knows_them(self):
        report = self.write("report.json", json.dumps(build_document()))
        for knows in (True, False):
            script = (f"""#!/bin/sh
[ "$1" != --help ] || {{ echo {'--roundings' if knows else 'nothing'}; exit; }}
echo "$1" >{self.path("first")}
cat {report}
""")
            report_of(self.write("regression_cells", script, executable=True), NAMES[:1], roundings=4)
            self.assertEqual(text_of(self.path("first")).strip(), "--roundings" if knows else NAMES[0])
