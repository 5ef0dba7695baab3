"""Tests of the study of turbulence: its samples and runs, how ensembles are judged, and its report.

Run with: python3 -m unittest test_turbulence (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import math
import os
import sys
import tempfile
import unittest
from unittest import mock

from drawing import DrawingTest
from programs import BUILD, DONE, MEASURE, RENDER, FolderTest, environment, run

sys.path.insert(0, os.path.join(BUILD, "python"))
import numpy as np

import isosyrk
from studies.turbulence import plan as turbulence_plan, run as turbulence
from lib.programs.command_line import Stop
from lib.records import formats
from lib.running import problems
from studies.turbulence import (against_reference, charts as turbulence_chart, judge as turbulence_judge,
                                report as turbulence_report, single_runs as turbulence_runs,
                                statistics as turbulence_statistics)
from lib.pages.document import as_markdown
from lib.records.formats import CONVERGED, UNSTABLE
from lib.records.settings import steps_to
from studies.turbulence.schema import (FAR, LOOSE, METHOD, BASELINE, REFERENCE, SCHEMA, Cost, RunRow, Setting, Settings,
                                       Size, bands_of, read_turbulence)
from studies.turbulence.statistics import LEVEL, drifts_of, false_positives, held_out, reference_of, spreads_of
from lib.judging.verdicts import FEWEST

SCRIPT = MEASURE, "turbulence"
RENDERING = RENDER, "turbulence"
SHORT = {"n": 17, "sample": 0, "integrator": "group2", "step": 0.25, "tolerance": 1e-10, "time": 48.0}


class Draws(unittest.TestCase):
    def test_a_draw_is_made_anew_and_has_norm_1_and_its_degrees_alone(self):
        states = []
        for n in (17, 33):
            W = turbulence_runs.drawn_scene(n, 3).initial
            turbulence_runs.drawn_scene.cache_clear()
            self.assertTrue((turbulence_runs.drawn_scene(n, 3).initial == W).all())
            self.assertAlmostEqual(np.linalg.norm(W, 2), 1, 12)
            energies = isosyrk.energy_spectrum(W)
            self.assertAlmostEqual(energies[6:11].sum() / energies.sum(), 1, 12)
            self.assertGreater(energies[6:11].min(), 1e-3 * energies.sum())
            states.append(energies[6:11] / energies.sum())
        self.assertLess(abs(states[0] - states[1]).max(), 1e-12)  # the same coefficients at every n
        other = turbulence_runs.drawn_scene(33, 4).initial
        self.assertGreater(isosyrk.relative_error(other, W), 0.5)

    def test_coefficients_have_equal_variance(self):
        """Of a mode with energy e the enstrophy is l(l + 1) e, and the l-th degree has 2l + 1 real coefficients."""
        totals = np.zeros(5)
        for sample in range(300):
            energies = isosyrk.energy_spectrum(turbulence_runs.drawn_scene(13, sample).initial)[6:11]
            enstrophies = np.array([l * (l + 1) for l in range(6, 11)]) * energies
            totals += enstrophies / enstrophies.sum()
        expected = np.array([2 * l + 1 for l in range(6, 11)]) / 85
        self.assertLess(abs(totals / 300 / expected - 1).max(), 0.1)

    def test_a_displacement_keeps_spectrum_and_energy_and_has_its_size(self):
        scene = turbulence_runs.drawn_scene(17, 0)
        W = scene.initial
        for size in (1e-1, 1e-3, 1e-6):
            moved = turbulence_runs.displaced(scene, size, (0, 17, 1))
            self.assertAlmostEqual(isosyrk.relative_error(moved, W) / size, 1, 1)
            self.assertLess(isosyrk.spectrum_error(moved, W), 1e-13)
            self.assertLess(abs(scene.energy(moved) / scene.energy(W) - 1), 1e-13)
            self.assertLess(isosyrk.skew_defect(moved), 1e-15)
            # Control: the same amount in another direction.
            self.assertGreater(isosyrk.spectrum_error(W + size * W, W), 0.5 * size)
        with mock.patch.object(turbulence_runs, "NEWTON_STEPS", 0):  # control: the orbit alone does not keep the energy
            moved = turbulence_runs.displaced(scene, 1e-1, (0, 17, 1))
        self.assertGreater(abs(scene.energy(moved) / scene.energy(W) - 1), 1e-4)
        other = turbulence_runs.displaced(scene, 1e-3, (0, 17, 2))
        self.assertGreater(isosyrk.relative_error(other, turbulence_runs.displaced(scene, 1e-3, (0, 17, 1))), 1e-3)


class Runs(unittest.TestCase):
    def test_averages_are_those_of_the_second_half(self):
        found = turbulence_runs.carry_out(SHORT)
        scene = turbulence_runs.drawn_scene(17, 0)
        states = []

        def watch(step, W, _):
            if step > 96:
                states.append(W.copy())

        method = isosyrk.integrator(scene, "group2", solver="fast", tolerance=1e-10)
        _, report = method.run(scene.initial, 0.25, 192, watch, 12)
        self.assertEqual((found["status"], found["time"], len(states)), (CONVERGED, 48.0, 8))
        self.assertAlmostEqual(found["products"], report.equivalent_products / 48, 3)
        spectra = np.array([isosyrk.energy_spectrum(W)[1:] for W in states])
        for quarter, own in enumerate(found["bands"]):
            means = spectra[2 * quarter:2 * quarter + 2].mean(axis=0)
            np.testing.assert_allclose(own, [means[:2].sum(), means[2:5].sum(), means[5:10].sum(), means[10:].sum()],
                                       rtol=1e-5)
        for name in ("energy", "enstrophy"):
            self.assertAlmostEqual(found[name], 1, 4)
        self.assertLess(max(found["energy_error"], found["spectrum_error"]), 1e-4)
        total = scene.energy(scene.initial)
        self.assertAlmostEqual(np.sum(found["bands"]) / 4 / total, found["energy"], 4)

    def test_bands_hold_every_degree_once(self):
        for n in (17, 33, 65, 129, 513):
            self.assertEqual([l for low, high in bands_of(n) for l in range(low, high + 1)], list(range(1, n)))
        self.assertEqual(bands_of(33), [(1, 2), (3, 5), (6, 10), (11, 20), (21, 32)])

    def test_coefficients_have_the_energy_of_their_degree(self):
        W = turbulence_runs.drawn_scene(17, 0).initial
        for degree in (6, 7):
            found = turbulence_runs.coefficients(W, degree)
            self.assertEqual(len(found), degree + 1)
            self.assertAlmostEqual(np.linalg.norm(found) ** 2 / (2 * degree * (degree + 1)),
                                   isosyrk.energy_spectrum(W)[degree], 12)
        self.assertLess(np.linalg.norm(turbulence_runs.coefficients(W, 4)), 1e-12)  # not one of the drawn ones

    def test_decorrelation_of_what_stays_turns_and_forgets(self):
        rng = np.random.default_rng(1)
        noise = rng.standard_normal((4000, 5)) + 1j * rng.standard_normal((4000, 5))
        turning = np.exp(2j * np.pi * np.arange(40)[:, None] / 8) * np.ones(3)
        for samples, lag, expected in ((np.ones((9, 3)), 4, 0.0), (turning, 4, 2.0), (turning, 8, 0.0),
                                       (turning, 2, 1.0), (noise, 3, 1.0)):
            self.assertAlmostEqual(turbulence_runs.decorrelation(samples, lag), expected, 1)

    def test_every_listed_step_divides_the_lags(self):
        for n in (33, 65, 129, 257):
            plan = turbulence_plan.plan_of(n, False)
            for step in {plan.reference.step, *(step for steps in plan.steps.values() for step in steps)}:
                interval = max(1, round(turbulence_runs.SAMPLE_TIME / step)) * step
                for lag in turbulence_runs.LAGS:
                    self.assertAlmostEqual(round(lag / interval) * interval, lag, 9, step)

    def test_invariants_by_their_definitions(self):
        scene = turbulence_runs.drawn_scene(17, 0)
        W = scene.initial
        watch = turbulence_runs.Averages(scene, W, 0)
        np.testing.assert_allclose(watch.initial, [scene.energy(W), -0.5 * np.trace(W @ W).real], rtol=1e-12)
        watch(1, 1.01 * W, None)
        np.testing.assert_allclose(watch.invariant_samples[0], [1.01**2, 1.01**2], rtol=1e-12)

    def test_a_displaced_ensemble_is_another_run_of_the_same_flow(self):
        bands = [turbulence_runs.carry_out({**SHORT, "role": role, "ensemble": k})["bands"]
                 for role, k in ((REFERENCE, 0), (REFERENCE, 0), (REFERENCE, 1), (FAR, 0))]
        self.assertEqual(bands[0], bands[1])
        self.assertNotEqual(bands[0], bands[2])
        near, far = (np.abs(np.subtract(bands[0], each)).max() for each in (bands[2], bands[3]))
        self.assertGreater(far, 10 * near)  # in a run as short as this

    def test_failures_are_told_and_have_no_average(self):
        lost = turbulence_runs.carry_out({**SHORT, "integrator": "rk4", "step": 10.0, "time": 2000.0})
        self.assertEqual((lost["status"], lost["bands"]), (UNSTABLE, None))
        self.assertLess(lost["time"], 2000)
        solver = turbulence_runs.carry_out({**SHORT, "step": 20.0})
        self.assertNotIn(solver["status"], (CONVERGED, UNSTABLE))
        self.assertEqual((solver["time"], solver["energy"]), (0.0, None))

    def test_energy_beyond_a_tenth_ends_a_run(self):
        scene = turbulence_runs.drawn_scene(17, 0)
        watch = turbulence_runs.Averages(scene, scene.initial, 0)
        self.assertFalse(watch(1, math.sqrt(1.09) * scene.initial, None))
        self.assertTrue(watch(2, math.sqrt(1.11) * scene.initial, None))
        with np.errstate(all="ignore"):
            self.assertTrue(watch(3, np.nan * scene.initial, None))
        self.assertEqual(len(watch.bands), 1)

    def test_steps_reach_the_time(self):
        self.assertEqual(steps_to(1000.0, 0.1), 10000)
        self.assertEqual(steps_to(1.0, 0.3), 4)
        self.assertEqual(steps_to(999.0, 0.75), 1332)

    def test_the_reference_converges(self):
        errors = [turbulence_runs.converge({**SHORT, "step": step}) for step in (1.0, 0.5)]
        self.assertLess(errors[1], errors[0] / 8)  # order 4
        self.assertGreater(errors[1], 0)


# ---- how ensembles are judged


def made_up(seed, samples, ensembles, quantities=8):
    """Returns made-up values of right runs, samples × ensembles × quantities.

    Draws differ by much, runs of a sample by 0.1 to 0.8 with the quantity, and neighbouring quantities share noise.
    """
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal((samples, ensembles, quantities)) + rng.standard_normal((samples, ensembles, 1))
    return 3 * rng.standard_normal((samples, 1, quantities)) + 0.1 * np.arange(1, quantities + 1) * noise


class Faithful(unittest.TestCase):
    def share(self, samples, ensembles=5, shift=0.0):
        """Returns the share of 300 ensembles beyond the threshold, each with a reference of its own.

        The shift is in standard deviations of a run, of the first quantity alone.
        """
        found = 0
        for seed in range(300):
            values = made_up(seed, samples, ensembles + 1)
            reference = reference_of(values[:, 1:], 300, seed)
            values[:, 0, 0] += shift * 0.1 * math.sqrt(2)
            found += reference.distance(values[:, 0]) > reference.threshold
        return found / 300

    def test_a_right_ensemble_is_called_wrong_in_5_of_100_cases(self):
        for samples, ensembles in ((10, 5), (12, 6), (6, 4)):  # 300 cases: 1.3 % is a standard error
            self.assertTrue(0.02 <= self.share(samples, ensembles) <= 0.085, (samples, self.share(samples, ensembles)))
        self.assertEqual(LEVEL, 0.95)

    def test_an_ensemble_with_one_wrong_quantity_is_found(self):
        self.assertGreater(self.share(10, shift=2.0), 0.98)
        self.assertGreater(self.share(10, shift=-2.0), 0.98)
        # What lies far below the noise of a run passes: the test has its limits.
        self.assertLess(self.share(10, shift=0.2), 0.2)

    def test_scores_by_their_definition(self):
        values = made_up(1, 6, 4)
        reference = reference_of(values)
        own = values[:, 0] + 1.0
        expected = (own - values.mean(axis=1)).mean(axis=0) / (
            np.sqrt([np.mean([np.var(each[:, k], ddof=1) for each in values]) for k in range(8)]) * math.sqrt(5 / 24))
        np.testing.assert_allclose(reference.scores(own), expected)
        self.assertAlmostEqual(reference.distance(own), abs(expected).max())

    def test_an_ensemble_that_is_held_out_is_judged_as_a_setting_is(self):
        values, chosen = made_up(2, 5, 4), np.array([[0, 3, 1, 1, 2], [2, 2, 0, 3, 1]])
        for found, each in zip(held_out(values, chosen), chosen):
            own = np.array([sample[taken] for sample, taken in zip(values, each)])
            others = np.array([np.delete(sample, taken, axis=0) for sample, taken in zip(values, each)])
            self.assertAlmostEqual(found, reference_of(others, 10).distance(own), 10)

    def test_the_measured_rate_of_false_positives(self):
        with mock.patch.multiple(turbulence_statistics, TRIALS=300, TRIAL_COUNT=200):
            values = made_up(3, 10, 8)
            self.assertTrue(0.02 <= false_positives(values, 5) <= 0.085)
            with mock.patch.object(turbulence_statistics, "LEVEL", 0.8):  # control: a lower threshold
                self.assertTrue(0.12 <= false_positives(values, 5) <= 0.28)

    def test_references_that_share_a_history_are_told(self):
        told = 0
        for seed in range(50):
            values = made_up(seed, 10, 9)
            told += spreads_of(values[:, :6], values[:, 6:]).are_independent
            means = values[:, :6].mean(axis=1, keepdims=True)
            shared = spreads_of(means + 0.5 * (values[:, :6] - means), values[:, 6:])
            self.assertFalse(shared.are_independent)
            self.assertTrue(shared.low[-1] < 0.5 * 1.3 and 0.5 / 1.3 < shared.high[-1])
        self.assertGreater(told, 42)

    def test_drifts(self):
        """Right in 95 of 100 cases over all bands, and found where a band falls by a sixth."""
        rng = np.random.default_rng(4)
        stationary = 0
        for _ in range(200):
            energies = np.exp(0.1 * rng.standard_normal((10, 5, 4, 6)))
            stationary += all(drift.is_stationary for drift in drifts_of(energies))
            energies[:, :, 3, 1] *= 5 / 6
            falling = drifts_of(energies)[1]
            self.assertFalse(falling.is_stationary)
            self.assertLess(abs(falling.change + 1 / 6), 0.08)
        self.assertTrue(0.9 <= stationary / 200 <= 0.99, stationary)

    def test_two_reference_ensembles_tell_nothing(self):
        with self.assertRaisesRegex(ValueError, "fewer than three"):
            reference_of(made_up(1, 5, 2))

    def test_the_same_data_give_the_same_threshold(self):
        self.assertEqual(reference_of(made_up(1, 4, 3)).threshold, reference_of(made_up(1, 4, 3)).threshold)


# ---- the raw file, the report and the figures

ENTRIES = ("algebra1", "group2", "elp4", "rk4", "rkmk4", "rk8")
HBAR_OVER_4 = 0.02
N, SAMPLES, NEAR, FURTHER = 33, 8, 6, 4


def averages(rng, sample, factor=1.0, drift=0.0):
    """Returns the averages of a made-up run: bands by quarters, their energy times `factor`, and decorrelations.

    The second band grows by `drift` in all, from quarter to quarter.
    """
    bands = 0.01 * (1 + 0.1 * sample) * 2.0 ** -np.arange(5) * np.exp(0.05 * rng.standard_normal(5)) * factor
    quarters = bands * np.exp(0.02 * rng.standard_normal((4, 5)))
    quarters[:, 1] *= np.exp(drift * np.linspace(-0.5, 0.5, 4))
    return {"bands": quarters.tolist(), "decorrelations": (0.8 + 0.05 * rng.standard_normal(2)).tolist()}


def rows_of(role, setting, seed, count=1, lost=(), factor=1.0, drift=0.0, **changes):
    """Returns the runs of a setting, of `count` ensembles; `lost` samples failed."""
    rng, found = np.random.default_rng((seed, 33)), []
    for sample in range(SAMPLES):
        for ensemble in range(count):
            row = RunRow(N, role, *setting, sample, ensemble, CONVERGED, 100.0, 24.0, 1e-3, 1e-9, 1.0, 1.0,
                         **averages(rng, sample, factor, drift))
            failed = {"status": UNSTABLE, "time": 40.0 + sample, "energy_error": 0.11, **dict.fromkeys(
                ("energy", "enstrophy", "bands", "decorrelations"))}
            found.append(row._replace(**failed) if sample in lost else row._replace(**changes))
    return found


def cost(setting, seconds, processes=6):
    """Returns a Cost whose times alternate by 1 % from process to process, as those of all others do."""
    return Cost(N, *setting, 40, [seconds * 1.01 ** (-1) ** process for process in range(processes)])


def write_turbulence(path, far=None, drift=0.0, **changed):
    """Writes a made-up raw file; `changed` tables are functions of their rows, `far` one of the rows of far runs.

    algebra1, the baseline, takes 0.05 s a run, elp4 with h = 1 a fifth of it, with h = 0.5 two fifths; group2 as much
    as the baseline. rk4 with h = 0.5 takes a tenth of it, with a fifth less energy in each band; rkmk4 an eighth, and
    its energy is off by 5 % though no band is.
    """
    loose = [Setting("elp4", 0.5, LOOSE), Setting("elp4", 1.0, LOOSE), Setting("group2", 0.5, LOOSE)]
    further = rows_of(FAR, ("rk8", 0.25, 1e-10), 2, FURTHER, drift=drift)
    tables = {
        "integrators": turbulence.built.entries(ENTRIES),
        "sizes": [Size(n=N, samples=SAMPLES, references=NEAR, far=FURTHER, time=100.0, reference_integrator="rk8",
                       reference_step=0.25, reference_error=1e-9, norm_B=0.24)],
        "runs": rows_of(REFERENCE, ("rk8", 0.25, 1e-10), 1, NEAR, drift=drift)
        + (far(further) if far else further)
        + rows_of(BASELINE, ("algebra1", HBAR_OVER_4, LOOSE), 3)
        + [row for seed, setting in enumerate(loose, 4) for row in rows_of(METHOD, setting, seed)]
        + rows_of(METHOD, ("elp4", 0.5, 1e-4), 7)
        + rows_of(METHOD, ("elp4", 2.0, LOOSE), 8, lost=(2, 5))
        + rows_of(METHOD, ("rkmk4", 1.0, LOOSE), 9, energy=1.05)
        + rows_of(METHOD, ("rk4", 0.5, LOOSE), 10, factor=0.8, enstrophy=0.94),
        "costs": [cost(Setting("algebra1", HBAR_OVER_4, LOOSE), 1e-5), cost(loose[0], 1e-4), cost(loose[1], 1e-4),
                  cost(loose[2], 2.5e-4), cost(Setting("rkmk4", 1.0, LOOSE), 6.25e-5),
                  cost(Setting("rk4", 0.5, LOOSE), 2.5e-5)]}
    for name, change in changed.items():
        tables[name] = change(tables[name])
    settings = Settings(lowest_degree=6, highest_degree=10, displacement=1e-3, far_displacement=0.1,
                        correlated_degree=4, lags=[12.0, 24.0], energy_loss=0.1, max_sweeps=60, warm_steps=32)
    formats.write_study(path, SCHEMA, {"cpu": "a processor"}, settings, tables)
    return path


@mock.patch.multiple(turbulence_statistics, TRIALS=40, TRIAL_COUNT=100)
class Report(DrawingTest):
    package = "turbulence"

    def raw(self, **changes):
        return write_turbulence(self.path("raw.json"), **changes)

    def judgements(self, **changes):
        study = read_turbulence(self.raw(**changes))
        return study, {n: against_reference.judgement_of(study, n) for n in study.sizes}

    def figures(self, **changes):
        return turbulence_judge.figures(turbulence_judge.findings(*self.judgements(**changes)))

    def report(self, **changes):
        """Returns the report as Markdown."""
        return as_markdown(turbulence_report.turbulence_sections(*self.judgements(**changes), ()))

    @staticmethod
    def cells(report):
        return [[cell.strip() for cell in line.strip("|").split("|")]
                for line in report.splitlines() if line.startswith("|")]

    def test_costs_and_winners(self):
        found = self.figures()
        self.assertAlmostEqual(found["n33.baseline.seconds"], 0.05)
        for structure in ("nothing", "spectrum", "poisson"):  # rk4 and rkmk4 are cheaper, and not faithful
            self.assertAlmostEqual(found[f"n33.cheapest.{structure}.elp4.h1.over_baseline"], 0.2)
            self.assertAlmostEqual(found[f"n33.cheapest.{structure}.elp4.h1.baseline_over"], 5)
            self.assertEqual(found[f"n33.cheapest.{structure}.elp4.h1.products"], 24)
        self.assertAlmostEqual(found["n33.rk4.h0.5.over_baseline"], 0.1)
        self.assertEqual((found["n33.cheapest.nothing.ties"], found["n33.cheapest.nothing.undecided"]), (0, 0))
        self.assertAlmostEqual(found["n33.cheapest_of.elp4.over_baseline"], 0.2)
        self.assertEqual(found["n33.cheapest_of.elp4.step"], 1)
        self.assertNotIn("n33.cheapest_of.rk4.step", found)

    def test_costs_within_5_percent_tie(self):
        def group2(share, spread=1.0):
            """Gives group2 a cost that is a share of that of elp4 with h = 1, with another spread over processes."""
            return lambda rows: [row._replace(seconds=[share * 5e-5 * 1.01 ** (-1) ** k * spread ** (k % 3 - 1)
                                                       for k in range(6)])
                                 if row.integrator == "group2" else row for row in rows]

        for costs, ties, undecided in ((group2(1.03), 1, 0), (group2(1.2), 0, 0), (group2(1.04, spread=1.1), 0, 1)):
            found = self.figures(costs=costs)
            self.assertEqual((found["n33.cheapest.nothing.ties"], found["n33.cheapest.nothing.undecided"]),
                             (ties, undecided))
            self.assertEqual("n33.cheapest.nothing.tie.group2.h0.5.over_baseline" in found, bool(ties))

    def test_what_is_faithful(self):
        found = self.figures()
        self.assertEqual([found[f"n33.{key}.faithful"] for key in (
            "baseline", "elp4.h0.5", "elp4.h0.5.tolerance_1e-4", "elp4.h2", "rkmk4.h1", "rk4.h0.5")],
            [1, 1, 1, 0, 0, 0])
        # An energy that is off by 5 % is found, though no band tells; so is a spectrum that is off.
        self.assertEqual([found[f"n33.{key}.within_chance"] for key in ("rkmk4.h1", "rk4.h0.5")], [1, 0])
        self.assertAlmostEqual(found["n33.rkmk4.h1.energy"], 0.05)
        self.assertAlmostEqual(found["n33.rk4.h0.5.enstrophy"], -0.06)
        self.assertGreater(found["n33.rk4.h0.5.distance"], 2 * found["n33.threshold"])
        self.assertEqual(found["n33.rk4.h0.5.distance"], max(abs(found[f"n33.rk4.h0.5.{key}.score"]) for key in (
            "l1-2", "l3-5", "l6-10", "l11-20", "l21-32", "l4.lag12", "l4.lag24")))
        self.assertLess(found["n33.rk4.h0.5.l1-2.score"], 0)
        self.assertNotIn("n33.elp4.h2.distance", found)
        self.assertEqual(found["n33.elp4.h2.products"], 24)

    def test_one_draw_whose_energy_is_off_is_enough(self):
        for change, faithful in ((0.009, 1), (-0.009, 1), (0.011, 0), (-0.011, 0)):
            def changed(rows, change=change):
                return [row._replace(energy=1 + change) if (row.integrator, row.step, row.sample) == ("elp4", 1.0, 3)
                        else row for row in rows]

            self.assertEqual(self.figures(runs=changed)["n33.elp4.h1.faithful"], faithful, change)

    def test_independence_and_stationarity(self):
        found = self.figures()
        self.assertEqual((found["n33.are_independent"], found["n33.stationary"], found["n33.samples"]), (1, 1, SAMPLES))
        self.assertTrue(found["n33.independent_low"] < found["n33.independent"] < found["n33.independent_high"])
        self.assertTrue(0.75 < found["n33.independent"] < 1.35)
        self.assertTrue(found["n33.l3-5.spread_low"] < found["n33.l3-5.spread"] < found["n33.l3-5.spread_high"])
        self.assertTrue(0.03 < found["n33.l3-5.deviation"] < 0.07, found["n33.l3-5.deviation"])
        self.assertTrue(0 <= found["n33.false_positives"] < 0.2)
        falling = self.figures(drift=math.log(0.84))
        self.assertEqual((falling["n33.stationary"], falling["n33.are_independent"]), (0, 1))
        self.assertTrue(-0.19 < falling["n33.l3-5.quarters"] < -0.13, falling["n33.l3-5.quarters"])
        self.assertIn("at n = 33, T = 100 the averages are those of a transient", self.report(drift=math.log(0.84)))
        self.assertIn("No band changes beyond chance", self.report())

    def test_the_wider_spread_counts_where_references_share_a_history(self):
        def wider(rows):
            """Far runs spread three times as much as reference runs."""
            return [row._replace(bands=[[0.01 * (each / 0.01) ** 3 for each in quarter] for quarter in row.bands],
                                 decorrelations=[0.8 + 3 * (each - 0.8) for each in row.decorrelations])
                    for row in rows]

        found, close = self.figures(far=wider), self.figures()
        self.assertEqual((found["n33.are_independent"], found["n33.baseline.faithful"]), (0, 1))
        self.assertTrue(0.25 < found["n33.independent"] < 0.45)
        for key in ("l1-2", "l4.lag24"):
            self.assertAlmostEqual(found[f"n33.{key}.deviation"] / close[f"n33.{key}.deviation"], 3, 0)
            self.assertAlmostEqual(close[f"n33.rk4.h0.5.{key}.score"] / found[f"n33.rk4.h0.5.{key}.score"], 3, 0)
        note = "share a history here"
        self.assertIn(note, self.report(far=wider))
        self.assertNotIn(note, self.report())

    def test_few_draws_judge_nothing(self):
        few = {"runs": lambda rows: [row for row in rows if row.sample < FEWEST - 1],
               "sizes": lambda rows: [row._replace(samples=FEWEST - 1) for row in rows]}
        found = self.figures(**few)
        self.assertEqual({value for key, value in found.items() if key.endswith(".faithful")}, {0})
        self.assertFalse(any(".cheapest" in key for key in found))
        report = self.report(**few)
        self.assertIn("Nothing is judged here", report)
        self.assertIn("not judged", {row[-1] for row in self.cells(report)})

    def test_what_is_not_faithful_says_why_and_every_sentence_on_averages_the_time(self):
        report = self.report()
        self.assertNotIn("Nothing is judged", report)
        rows = {tuple(row[:3]): row for row in self.cells(report) if row[0] in ENTRIES}
        self.assertEqual(rows["elp4", "2", "1e-08"][-1], "no: 2 of 8 samples lost")
        self.assertEqual(rows["rkmk4", "1", "1e-08"][-1], "no: energy")
        self.assertEqual(rows["rk4", "0.5", "1e-08"][-1], "no: statistics, enstrophy")
        self.assertEqual(rows["algebra1", "0.02", "1e-08"][-1], "**yes**")
        for heading in ("The cheapest faithful settings", "Gauss methods by order"):
            self.assertIn("T = 100", report.split(f"## {heading}\n")[1].split("\n|")[0])
        self.assertIn("## Every setting, n = 33, T = 100", report)

    def test_a_method_without_a_faithful_setting_is_named_and_where_there_is_none_there_is_no_chart(self):
        (axes,), = self.panels("studies.turbulence.charts", "cheapest_faithful", *self.judgements()).values()
        labels = [text.get_text() for text in axes.texts]
        for method in ("rk4", "rkmk4"):  # which loses the enstrophy, the energy
            self.assertIn(f"{method}: no setting that was tried is faithful", labels)
        none = {"runs": lambda rows: [row for row in rows if row.integrator not in ("elp4", "group2")]}
        self.assertIsNone(turbulence_chart.cheapest_faithful(*self.judgements(**none)))
        self.assertIn("Samples that were lost", self.report())
        self.assertNotIn("Samples that were lost", self.report(**none))

    def test_the_title_names_the_cheapest(self):
        study, found = self.judgements()
        title = turbulence_chart.title_of(study, found)
        for part in ("T\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}100", "0.2 of the baseline's time (elp4)"):
            self.assertIn(part, title)
        none = found[N]._replace(judged={})
        self.assertEqual(turbulence_chart.title_of(study, {N: none}), turbulence_chart.PLAIN_TITLE)

    def test_a_python_without_numpy_can_start_another(self):
        self.write("hidden/numpy.py", "raise ImportError")
        done = self.render("--help", PYTHONPATH=self.path("hidden"))
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        control = run([self.python, "-c", "import numpy"], env=environment(PYTHONPATH=self.path("hidden")))
        self.assertNotEqual(control.returncode, DONE)


class Plan(unittest.TestCase):
    def test_settings(self):
        for n, samples, shorter in ((33, 12, 1), (65, 10, 2)):
            plan = turbulence_plan.plan_of(n, False)
            whole = turbulence_plan.settings_of(n, plan, turbulence_plan.STEPS)
            self.assertEqual(len(set(whole)), len(whole))
            (baseline,) = [setting for role, setting in whole if role == BASELINE]
            self.assertAlmostEqual(baseline.step, 0.5 / math.sqrt(n * (n - 1)))
            self.assertEqual((plan.samples, plan.time), (samples, 1000.0))
            self.assertIn(Setting("rk8", 1.5 / shorter, LOOSE), [setting for _, setting in whole])
            self.assertIn(Setting("elp4", 1.0 / shorter, 1e-4), [setting for _, setting in whole])
        few = turbulence_plan.settings_of(33, turbulence_plan.plan_of(33, False), ["rk4"])
        self.assertEqual({setting.integrator for _, setting in few}, {"rk4", "algebra1"})
        for n, samples, step, settings in ((129, 6, 0.25, 11), (257, 2, 0.125, 5), (513, 2, 0.0625, 5)):
            large = turbulence_plan.plan_of(n, False)
            self.assertEqual((large.samples, large.reference, len(turbulence_plan.settings_of(
                n, large, turbulence_plan.STEPS))), (samples, Setting("rk8", step, 1e-10), settings))
        self.assertEqual({setting for _, setting in turbulence_plan.settings_of(
            257, turbulence_plan.plan_of(257, False), turbulence_plan.STEPS)[1:]},
            {Setting("rk8", 0.1875, LOOSE), Setting("rk8_projected", 0.1875, LOOSE),
             Setting("algebra1", 0.03125, LOOSE), Setting("elp4", 0.125, 1e-4)})
        self.assertEqual(turbulence_plan.SIZES, (33, 65, 257))

    def test_the_smallest_n_holds_all_modes_that_are_drawn(self):
        self.assertEqual(turbulence_plan.sizes_of([33, 11, 33]), [11, 33])
        with self.assertRaisesRegex(Stop, "--n 10: must be at least 11"):
            turbulence_plan.sizes_of([10])

    def test_the_raw_file_takes_what_is_planned(self):
        for n in (33, 65, 129, 257, 513):
            plan = turbulence_plan.plan_of(n, False)._asdict()
            for name in ("samples", "references", "far", "time"):
                self.assertEqual(Size.__annotations__[name](plan[name]), plan[name])

    def test_every_row_is_timed_by_as_many_processes(self):
        done = {"row": [1.0] * 6, "other": [1.0] * 4}
        self.assertEqual(turbulence.further_processes(6, done), {"row": 0, "other": 2})

    def test_what_is_timed_are_settings_whose_runs_all_work(self):
        plan = turbulence_plan.plan_of(N, True)
        rows = [row for role, setting in turbulence_plan.settings_of(N, plan, ["rk4"])
                for row in rows_of(role, setting, 1, lost=(0,) if setting.step == 0.5 else ())]
        points = [(point["integrator"], point["step"]) for point in turbulence.points_of(N, plan, rows)]
        self.assertEqual(points, [("algebra1", 0.5 / math.sqrt(33 * 32)), ("rk4", 0.25)])
        self.assertEqual([point["steps"] for point in turbulence.points_of(N, plan, rows)], [650, 40])

    def test_states_and_times_of_a_step(self):
        point = {**Setting("elp4", 0.5, LOOSE)._asdict(), "n": 17, "steps": 8}
        prepared = turbulence.prepare({**SHORT, "points": [point, {**point, "step": 50.0}]})
        self.assertEqual(prepared["points"], [point])  # the other one fails
        W = problems.decoded(prepared["state"], 17)
        self.assertLess(isosyrk.spectrum_error(W, turbulence_runs.drawn_scene(17, 0).initial),
                        96 * 1e-10)  # that many steps to T/2, at that tolerance
        block, = turbulence.blocks_of([point, {**point, "step": 0.25}])
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "W.npy")
            np.save(path, W)
            seconds = turbulence.time_block({**block, "process": 0, "state": path})
        self.assertEqual(len(seconds), 2)
        self.assertGreater(min(seconds), 0)


class Study(FolderTest):
    def test_a_wrong_setting_is_found(self):
        """RK4 with a long step against its reference, in runs as they are; a right setting passes."""
        plan = {"n": N, "time": 150.0, "tolerance": 1e-8}

        def ensemble(integrator, step, **further):
            return [turbulence_runs.carry_out({**plan, "integrator": integrator, "step": step, "sample": sample,
                                               **further})
                    for sample in range(5)]

        def values(runs):
            rows = [[RunRow(N, METHOD, "rk4", 1.0, 1e-8, 0, 0, **run)] for run in runs]
            return against_reference.values_of(rows)[:, 0]

        references = np.stack([values(ensemble("rk8", 1.0, role=FAR, ensemble=k)) for k in range(4)], axis=1)
        reference = reference_of(references, 500)
        right, wrong = ensemble("rk8", 0.75), ensemble("rk4", 1.0)
        self.assertLess(reference.distance(values(right)), reference.threshold)
        self.assertGreater(reference.distance(values(wrong)), 1.3 * reference.threshold)
        self.assertLess(max(abs(run["enstrophy"] - 1) for run in right), against_reference.TOLERANCE)
        self.assertGreater(max(abs(run["enstrophy"] - 1) for run in wrong), against_reference.TOLERANCE)


if __name__ == "__main__":
    unittest.main()
