"""Tests of the plain formulations, of where the theorem ends, of what its study times, and of its report.

Run with: python3 -m unittest test_theorem (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import json
import os
import sys
import types
import unittest
from unittest import mock

from programs import BUILD, FORMULATIONS, RENDER, FolderTest

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np

import isosyrk
from studies.theorem import plain_forms
from lib.programs.command_line import NO_ANSWER, Stop
from lib.records import formats
from lib.running import timed
from lib.running.checkpoint import Checkpoint
from studies.theorem import plan as theorem_plan, run as theorem
from lib.pages.document import Table, as_markdown
from lib.running.fresh_process import MAX_SWITCHES, MAX_TRIES, Disturbance
from studies.theorem.plain_forms import dagger, gauss
from studies.theorem.judge import findings
from studies.theorem.report import rendered
from studies.theorem.schema import NOTHING, PAIRS, PRINTED_K, PRINTED_W, SCHEMA, Coincidence, Settings, Timed
from lib.judging.verdicts import FEWEST, MORE, MAXIMUM

RENDERING = RENDER, "theorem"
ROUNDING = 1e-13  # of one step with entries of about 1, and of its iteration
CHANGED = 1e-9  # the least that a change makes: Lobatto methods of order 4 differ by h⁵ times small constants


def defects(a, b, c, k):
    """Returns the largest residual of each k-th simplifying condition, B, C and D, of a tableau (s, s), (s,), (s,).

    Source: Hairer, Wanner, Solving Ordinary Differential Equations II, IV.5.
    """
    powers = c ** (k - 1)
    missed = {"B": b @ powers - 1 / k, "C": a @ powers - c**k / k, "D": (b * powers) @ a - b * (1 - c**k) / k}
    return {name: abs(each).max() for name, each in missed.items()}


class PlainForms(unittest.TestCase):
    """The module and plain_forms share nothing: tableaux, iteration and products are written twice."""

    def test_they_equal_the_module_in_every_scene(self):
        self.assertEqual(set(theorem_plan.SMALL), set(isosyrk.scenes()))
        for name, n in theorem_plan.SMALL.items():
            scene = isosyrk.scene(name, n=n)
            W0, J = scene.initial, theorem.J_of(scene)
            h = 0.3 / np.linalg.norm(scene.generator(W0), 2)
            for s in (1, 2, 3):
                with self.subTest(scene=name, s=s):
                    steps = {"cotangent": plain_forms.cotangent(*gauss(s), scene.generator, W0, h),
                             "group": plain_forms.group(*gauss(s), scene.generator, W0, h, J),
                             "algebra": plain_forms.algebra(*gauss(s), scene.generator, W0, h, J)}
                    for form, step in steps.items():
                        W1 = isosyrk.integrator(scene, f"{form}{s}", tolerance=1e-14).step(W0, h)
                        self.assertLess(abs(W1 - step.W1).max(), 1e-12)
                        self.assertLess(theorem.algebra_defect(step.W1, J), ROUNDING)
                        self.assertLess(theorem.casimir_error(step.W1, W0), ROUNDING)
                    for form in ("cotangent", "group"):
                        Q1 = steps[form].Q1
                        self.assertLess(abs(dagger(Q1) @ J @ Q1 - J).max(), ROUNDING)
                    # The structural identity: only pairs j ≤ k need a product.
                    M = steps["algebra"].M
                    self.assertLess(abs(np.swapaxes(M, 0, 1) + np.linalg.inv(J) @ dagger(M) @ J).max(), ROUNDING)
                    # Controls: it moved, and what is printed is something else.
                    self.assertGreater(abs(W1 - W0).max(), 1e-2)
                    self.assertGreater(abs(M).max(), 1e-3)
                    if s > 1:
                        printed = plain_forms.algebra(*gauss(s), scene.generator, W0, h, J, printed=True)
                        self.assertGreater(abs(W1 - printed.W1).max(), 1e-7)

    def test_a_step_without_a_fixed_point_is_an_error(self):
        scene = isosyrk.scene("rigid_body", n=6)
        with self.assertRaisesRegex(ArithmeticError, "does not converge"), np.errstate(all="ignore"):
            plain_forms.cotangent(*gauss(1), scene.generator, scene.initial, 100.0)

    def test_tableaux_have_the_order_of_their_name(self):
        # The largest p, q, r with B(p), C(q), D(r).
        nodes = {2: np.array([0.0, 1.0]), 3: np.array([0.0, 0.5, 1.0])}
        expected = [(gauss(s), gauss(s)[0].sum(1), (2 * s, s, s)) for s in (1, 2, 3)]
        expected.append((plain_forms.RADAU_IIA, np.array([1 / 3, 1.0]), (3, 2, 1)))
        for s, c in nodes.items():
            expected += [(plain_forms.LOBATTO_IIIA[s], c, (2 * s - 2, s, s - 2)),
                         (plain_forms.LOBATTO_IIIB[s], c, (2 * s - 2, s - 2, s)),
                         (plain_forms.LOBATTO_IIIC[s], c, (2 * s - 2, s - 1, s - 1))]
        for (a, b), c, orders in expected:
            for name, order in zip("BCD", orders):
                with self.subTest(a=a.tolist(), condition=name, order=order):
                    for k in range(1, order + 1):
                        self.assertLess(defects(a, b, c, k)[name], 1e-14)
                    self.assertGreater(defects(a, b, c, order + 1)[name], 1e-4)  # the control


class Ends(unittest.TestCase):
    """Each row has one thing changed; the control is that of NOTHING, by the same code."""

    # Which pairs coincide, and which formulations keep the spectrum. IIIB with s = 2 is the midpoint rule.
    EXPECTED = {
        NOTHING: (PAIRS, FORMULATIONS),
        "a tableau that is not symplectic": (("cotangent–group",), ()),
        "a partitioned pair on T*G": ((), ("cotangent",)),
        "IIIA–IIIB, IIIB, s = 2": (("group–algebra",), FORMULATIONS),
        "J² no multiple of I": (("cotangent–algebra",), ("cotangent", "algebra")),
        "B outside g": ((), ("cotangent",)),
        PRINTED_K: (("cotangent–group",), ("cotangent", "group")),
        PRINTED_W: (("cotangent–algebra",), ("cotangent", "algebra"))}

    def test_what_coincides_and_what_keeps_the_spectrum(self):
        rows = theorem.ends()
        self.assertEqual(len({row.case for row in rows}), len(rows))
        self.assertLess(set(self.EXPECTED), {name for row in rows for name in (row.changed, row.case)})
        for row in rows:
            pairs, kept = self.EXPECTED.get(row.case, self.EXPECTED[row.changed])
            for names, values, zero in ((PAIRS, row.differences, pairs), (FORMULATIONS, row.casimir_errors, kept)):
                for name, value in zip(names, values):
                    with self.subTest(case=row.case, name=name):
                        (self.assertLess if name in zero else self.assertGreater)(
                            value, ROUNDING if name in zero else CHANGED)
            if row.order:
                expected = 3 if row.changed == PRINTED_K else 2 * row.stages
                self.assertAlmostEqual(row.order, expected, delta=0.1)
        self.assertEqual([bool(row.order) for row in rows if row.changed in (NOTHING, PRINTED_K)], [True] * 4)

    def test_the_printed_index_of_K_lets_the_spectrum_drift(self):
        scene = isosyrk.scene("smooth", n=9)
        errors = {}
        for printed in (False, True):
            W = scene.initial
            for steps in (5, 10):
                for _ in range(5):
                    W = plain_forms.algebra(*gauss(2), scene.generator, W, 0.3, np.eye(9), printed).W1
                errors[printed, steps] = theorem.casimir_error(W, scene.initial)
        self.assertLess(errors[False, 10], 1e-12)
        self.assertGreater(errors[True, 10], 1.5 * errors[True, 5])


# ---- timing by processes

QUIET, BUSY = Disturbance(0.0, 0.0), Disturbance(0.0, 2 * MAX_SWITCHES)


def noisy(ratio, spread, count=FEWEST):
    """Returns times of so many processes; the logarithms of their ratios to 1 lie evenly about that of `ratio`."""
    return [ratio * (1 + spread * (2 * k / (count - 1) - 1)) for k in range(count)]


class FurtherProcesses(unittest.TestCase):
    """Rows of one method stop together, and those of others go on without them."""

    @staticmethod
    def further(**seconds):
        return theorem.further_processes(MAXIMUM, seconds)

    def test_decided_and_undecided(self):
        level, close = noisy(1, 0), noisy(1.05, 0.05)
        for others, wanted in ((noisy(1.01, 0), 0), (noisy(1.3, 0.02), 0), (close, MORE)):
            with self.subTest(others=others):
                self.assertEqual(self.further(group1=level, algebra1=others), {"group1": wanted, "algebra1": wanted})
        self.assertEqual(self.further(group1=level, algebra1=close, group2=level, algebra2=level),
                         {"group1": MORE, "algebra1": MORE, "group2": 0, "algebra2": 0})


class ByProcesses(FolderTest):
    """timed.by_processes with made-up processes: each row has its time, and each process adds its number to it."""

    BLOCKS = ({"scene": "first", "rows": ["a", "b"]}, {"scene": "second", "rows": ["b"]})

    def setUp(self):
        super().setUp()
        self.runs = []  # (scene, rows, process) of each run
        self.enter(mock.patch.object(timed, "progress", lambda total, what: mock.MagicMock(
            __enter__=lambda bar: types.SimpleNamespace(n=0, total=total, write=self.told, update=lambda: None))))
        self.enter(mock.patch("lib.running.checkpoint.say"))
        self.told_lines = []

    def enter(self, patch):
        patch.start()
        self.addCleanup(patch.stop)

    def told(self, line, **_):
        self.told_lines.append(line)

    def by_processes(self, further, disturbances=(), fails=False, cores=None, parts=("timing",)):
        """Returns the seconds of the last part and the context; `disturbances` are those of the first runs."""
        disturbances = iter(disturbances)

        def run_on(core, told, stdout, stderr):
            block, process = told
            self.ran_on = core
            self.runs.append((block["scene"], tuple(block["rows"]), process))
            if fails:  # though it has printed times
                stdout.write(json.dumps([1.0] * len(block["rows"])).encode())
                stderr.write(b"a long story\nno such scene\n")
                return 1, QUIET
            # A run that is repeated gives other times.
            times = [{"a": 1.0, "b": 2.0}[row] + process + 100 * self.runs[:-1].count(self.runs[-1])
                     for row in block["rows"]]
            stdout.write(json.dumps(times).encode())
            return 0, next(disturbances, QUIET)

        options = types.SimpleNamespace(out=self.path("raw.json"))
        checkpoint = Checkpoint("made up", options, lambda: {"commit": "1"})
        with mock.patch("lib.running.fresh_process.run_on", run_on):
            for what in parts:
                found = timed.by_processes(self.BLOCKS, lambda *told: told, further, checkpoint, what, cores)
        return found, checkpoint.context

    @staticmethod
    def until(counts):
        """Returns a `further` by which each row has so many processes, in one go."""
        return lambda seconds: {row: counts[row] - len(found) for row, found in seconds.items()}

    def test_every_block_gets_its_first_process_before_any_gets_its_second(self):
        seconds, context = self.by_processes(self.until({"a": 1, "b": 2}))
        self.assertEqual(seconds, [{"a": [1.0], "b": [2.0, 3.0]}, {"b": [2.0, 3.0]}])
        self.assertEqual(self.runs, [("first", ("a", "b"), 0), ("second", ("b",), 0), ("first", ("b",), 1),
                                     ("second", ("b",), 1)])
        self.assertEqual(context["timed_on"], f"core {max(os.sched_getaffinity(0))}")

    def test_processes_have_the_last_core_or_those_that_are_named(self):
        self.by_processes(self.until({"a": 1, "b": 1}))
        self.assertEqual(self.ran_on, {max(os.sched_getaffinity(0))})
        _, context = self.by_processes(self.until({"a": 2, "b": 2}), cores={3, 5})
        self.assertEqual((self.ran_on, context["timing_timed_on"]), ({3, 5}, "cores 3, 5"))
        self.assertNotIn("timed_on", context)

    def test_further_processes_are_asked_for_only_when_the_last_ones_are_done(self):
        asked = []

        def further(seconds):
            asked.append(len(seconds["b"]))
            return {row: {0: 2, 2: 1}.get(len(found), 0) for row, found in seconds.items()}

        seconds, _ = self.by_processes(further)
        self.assertEqual([len(each["b"]) for each in seconds], [3, 3])
        self.assertEqual(set(asked), {0, 2, 3})

    def test_what_a_checkpoint_has_is_not_run_again(self):
        before, _ = self.by_processes(self.until({"a": 1, "b": 1}))
        self.runs.clear()
        after, _ = self.by_processes(self.until({"a": 3, "b": 3}))
        self.assertEqual({process for *_, process in self.runs}, {1, 2})
        for first, whole in zip(before, after):
            for row, found in whole.items():
                self.assertEqual((found[:1], len(found)), (first[row], 3))
        again, _ = self.by_processes(self.until({"a": 3, "b": 3}))
        self.assertEqual((again, len(self.runs)), (after, 4))

    def test_a_disturbed_process_is_repeated(self):
        seconds, context = self.by_processes(self.until({"a": 1, "b": 1}), [BUSY])
        self.assertEqual(self.runs, [("first", ("a", "b"), 0)] * 2 + [("second", ("b",), 0)])
        self.assertEqual((seconds[0], context["disturbed_processes"]), ({"a": [101.0], "b": [102.0]}, "0 of 2"))
        self.assertRegex(self.told_lines.pop(), "disturbed .* measured again")
        self.assertEqual(self.told_lines, [])

    def test_one_that_stays_disturbed_is_kept_and_counted_also_after_an_interruption(self):
        for _ in range(2):
            _, context = self.by_processes(self.until({"a": 1, "b": 1}), [BUSY] * MAX_TRIES)
            self.assertEqual((len(self.runs), context["disturbed_processes"]), (MAX_TRIES + 1, "1 of 2"))

    def test_disturbed_processes_are_counted_over_all_parts_of_a_study(self):
        for _ in range(2):
            _, context = self.by_processes(self.until({"a": 1, "b": 1}), [BUSY] * MAX_TRIES, parts=("one", "two"))
            self.assertEqual(context["disturbed_processes"], "1 of 4")

    def test_a_process_that_fails_ends_the_study(self):
        with self.assertRaisesRegex(Stop, "timing: .*status 1.*: no such scene$") as caught:
            self.by_processes(self.until({"a": 1, "b": 1}), fails=True)
        self.assertEqual(caught.exception.status, NO_ANSWER)


class TimedBlock(unittest.TestCase):
    def test_rows_are_timed_in_turns_in_changing_order(self):
        for small in (True, False):
            with self.subTest(small=small):
                timed, orders = [], []
                block = {"scene": "rigid_body", "n": 6, "h_norm_B": 0.1, "products": "eigen", "steps": 5,
                         "repetitions": 3 if small else 1, "warm": small, "rows": ["group1", "group2", "algebra2"]}

                class Integrator:
                    def __init__(self, name):
                        self.name = name

                    def timed_run(self, W, h, steps, repetitions):
                        timed.append((self.name, repetitions))
                        return [steps * {"group1": 1e-3, "group2": 2e-3, "algebra2": 4e-5}[self.name]] * repetitions

                with mock.patch.object(isosyrk, "integrator", lambda scene, name, **_: Integrator(name)):
                    for process in range(6):
                        timed.clear()
                        self.assertEqual([round(each, 9) for each in theorem.time_block({**block, "process": process})],
                                         [1e-3, 2e-3, 4e-5])
                        first, turns = timed[:3 * small], timed[3 * small:]
                        self.assertEqual(first, [(name, 1) for name in block["rows"]][:len(first)])
                        # 0.2 ms are run as often as fill 4 ms, where there was a warm run to tell.
                        self.assertEqual(dict(turns), {"group1": 1, "group2": 1, "algebra2": 20 if small else 1})
                        each = [tuple(name for name, _ in turns[k:k + 3]) for k in range(0, len(turns), 3)]
                        self.assertEqual([sorted(order) for order in each],
                                         [sorted(block["rows"])] * block["repetitions"])
                        orders += each
                self.assertGreater(len(set(orders)), 1)


# ---- the report


def made_up(rows):
    """Returns a study whose timed rows are (table, scene, n, h‖B‖, method, times by formulation)."""
    tables = {"coincidence": [Coincidence("rigid_body", 6, 1, 0.1, 1e-14, 1e-16, 1e-15, (9.0, 9.0, None), 1e-12)],
              "ends": theorem.ends(), "cost": [], "dirk": []}
    for name, scene, n, norm, method, times in rows:
        tables[name] += [Timed(scene, n, norm, method, form, *((8.0, 16.0, 1e-15) if seconds else (None,) * 3),
                               tuple(seconds)) for form, seconds in times.items()]
    return formats.Study({"cpu": "made up"}, Settings(10, 5, 1e-13, 6, 0.3), tables)


class Claims(unittest.TestCase):
    def test_one_is_judged_where_a_rival_converges_too(self):
        times = {"algebra": noisy(1.0, 0.0), "group": noisy(3.0, 0.01), "cotangent": noisy(3.1, 0.01)}
        for converge, expected in ((("algebra",), None), (("group", "cotangent"), None),
                                   (("algebra", "group"), "holds"), (tuple(times), "holds")):
            row = {form: times[form] if form in converge else () for form in times}
            found = findings(made_up([("cost", "rigid_body", 65, 0.1, "s = 1", row)])).claims
            self.assertEqual([each.result for each in found if each.method == "s = 1"], [expected], converge)


class Report(FolderTest):
    """Made-up processes: the ratios to the formulation claimed are known, and so is what the tables must say."""

    ROWS = (
        # Claim (a): algebra is 3 times as fast; (b): group ties with cotangent; at 0.5 it is undecided, then slower.
        ("cost", "rigid_body", 65, 0.1, "s = 1", {"cotangent": noisy(3.1, 0.01), "group": noisy(3.0, 0.01),
                                                  "algebra": noisy(1.0, 0.0)}),
        ("cost", "rigid_body", 65, 0.1, "s = 2", {"cotangent": noisy(1.01, 0.01), "group": noisy(1.0, 0.0),
                                                  "algebra": noisy(1.5, 0.01)}),
        ("cost", "rigid_body", 65, 0.5, "s = 2", {"cotangent": noisy(2.0, 0.01), "group": noisy(1.0, 0.0),
                                                  "algebra": noisy(1.05, 0.05)}),
        ("cost", "rigid_body", 65, 0.5, "s = 3", {"cotangent": noisy(1.0, 0.0), "group": noisy(1.25, 0.01),
                                                  "algebra": noisy(2.0, 0.01)}),
        # A size twice as large takes twice the time, and on g the sweeps of one method fail.
        ("cost", "spin_chain", 256, 0.1, "s = 1", {"cotangent": noisy(1.0, 0), "group": noisy(1.0, 0),
                                                   "algebra": noisy(2.0, 0)}),
        ("cost", "spin_chain", 512, 0.1, "s = 1", {"cotangent": noisy(2.0, 0), "group": noisy(2.0, 0),
                                                   "algebra": noisy(4.0, 0)}),
        ("dirk", "spin_chain", 512, 0.5, "yoshida4", {"cotangent": noisy(1.0, 0), "group": noisy(1.0, 0),
                                                      "algebra": ()}))

    def setUp(self):
        super().setUp()
        path = self.path("raw.json")
        self.study = made_up(self.ROWS)
        formats.write_study(path, SCHEMA, self.study.context, self.study.settings, self.study.tables)
        found = rendered(path, None)
        self.document, self.figures = found.document(set()), found.figures

    def rows(self, heading):
        """Returns the rows of the first table after a heading, as lists of text with a star for what is marked."""
        headings = [getattr(part, "text", None) for part in self.document]
        table = next(part for part in self.document[headings.index(heading):] if isinstance(part, Table))
        return [[entry.text + "*" * entry.marked for entry in row] for row in table.rows()]

    def test_claims(self):
        self.assertEqual(self.rows("Which formulation is fastest"), [
            ["rigid_body", "65", "(a), s = 1", "algebra", "holds 3.00*", "–"],
            ["rigid_body", "65", "(b), s = 2", "group", "tie 1.01", "1.05 †"],
            ["rigid_body", "65", "(b), s = 3", "group", "–", "fails 0.800"],
            ["spin_chain", "256", "(a), s = 1", "algebra", "fails 0.500", "–"],
            ["spin_chain", "512", "(a), s = 1", "algebra", "fails 0.500", "–"],
            ["spin_chain", "512", "footnote, yoshida4", "algebra", "–", "no step"]])
        self.assertIn("Each row was timed in 6 processes.", " ".join(as_markdown(self.document).split()))


if __name__ == "__main__":
    unittest.main()
