"""Tests of the study of turbulence: its draws and runs, how ensembles are judged, and its study and report as a user
runs them.

Run with: python3 -m unittest test_turbulence (in tests/scripts; the module is that of ISOSYRK_BUILD, or of build/)
"""

import math
import os
import random
import sys
import tempfile
import unittest
from unittest import mock

from drawing import DrawingTest, lines_of
from programs import BUILD, DONE, ROOT, FolderTest, environment, run, run_script

sys.path[:0] = [os.path.join(BUILD, "python"), os.path.join(ROOT, "scripts", "studies")]
import numpy as np

import isosyrk
import turbulence
from lib import (formats, problems, turbulence_chart, turbulence_figures, turbulence_report, turbulence_runs,
                 turbulence_statistics)
from lib.figures import read_figures
from lib.formats import CONVERGED, FAST, PUBLISHED, SWEEP_CAP, UNSTABLE
from lib.messages import UnusableFile
from lib.turbulence_files import (LOOSE, METHOD, PRACTICE, REFERENCE, SCHEMA, TIGHT, Cost, Parting, RunRow, Setting,
                                  Settings, Size, read_turbulence)
from lib.turbulence_statistics import LEVEL, reference_of
from lib.verdicts import FEWEST

SCRIPT = os.path.join(ROOT, "scripts", "studies", "turbulence.py")
RENDER = os.path.join(ROOT, "scripts", "render_turbulence")
SHORT = {"n": 17, "draw": 0, "integrator": "group2", "step": 0.25, "tolerance": 1e-10, "time": 20.0}


class Draws(unittest.TestCase):
    def test_a_draw_is_made_anew_and_has_norm_1_and_its_degrees_alone(self):
        states = []
        for n in (17, 33):
            W = turbulence_runs.drawn_scene(n, 3).initial
            turbulence_runs.drawn_scene.cache_clear()
            self.assertTrue((turbulence_runs.drawn_scene(n, 3).initial == W).all())
            self.assertAlmostEqual(np.linalg.norm(W, 2), 1, 12)
            energies = problems.energies_by_degree(W)
            self.assertAlmostEqual(energies[5:10].sum() / energies.sum(), 1, 12)
            self.assertGreater(energies[5:10].min(), 1e-3 * energies.sum())
            states.append(energies[5:10] / energies.sum())
        self.assertLess(abs(states[0] - states[1]).max(), 1e-12)  # the same coefficients at every n
        other = turbulence_runs.drawn_scene(33, 4).initial
        self.assertGreater(isosyrk.relative_error(other, W), 0.5)

    def test_coefficients_have_equal_variance(self):
        """Of a mode with energy e the enstrophy is l(l + 1) e, and the l-th degree has 2l + 1 real coefficients."""
        totals = np.zeros(5)
        for draw in range(300):
            energies = problems.energies_by_degree(turbulence_runs.drawn_scene(13, draw).initial)[5:10]
            enstrophies = np.array([l * (l + 1) for l in range(6, 11)]) * energies
            totals += enstrophies / enstrophies.sum()
        expected = np.array([2 * l + 1 for l in range(6, 11)]) / 85
        self.assertLess(abs(totals / 300 / expected - 1).max(), 0.1)

    def test_a_displacement_keeps_the_spectrum_and_has_its_size(self):
        W = turbulence_runs.drawn_scene(17, 0).initial
        for size in (1e-3, 1e-6, 1e-8):
            moved = turbulence_runs.displaced(W, size, (0, 17, 1))
            self.assertAlmostEqual(isosyrk.relative_error(moved, W) / size, 1, 2)
            self.assertLess(isosyrk.spectrum_error(moved, W), 1e-14)
            self.assertLess(isosyrk.skew_defect(moved), 1e-16)
            # Control: the same amount in another direction.
            self.assertGreater(isosyrk.spectrum_error(W + size * W, W), 0.5 * size)
        other = turbulence_runs.displaced(W, 1e-3, (0, 17, 2))
        self.assertGreater(isosyrk.relative_error(other, turbulence_runs.displaced(W, 1e-3, (0, 17, 1))), 1e-3)


class Runs(unittest.TestCase):
    def test_averages_are_those_of_the_second_half(self):
        found = turbulence_runs.carry_out(SHORT)
        scene = turbulence_runs.drawn_scene(17, 0)
        spectra = []

        def watch(step, W, _):
            if step > 40:
                spectra.append(problems.energies_by_degree(W))

        isosyrk.integrator(scene, "group2", solver="fast", tolerance=1e-10).run(scene.initial, 0.25, 80, watch, 8)
        self.assertEqual((found["status"], found["time"], len(spectra)), (CONVERGED, 20.0, 5))
        self.assertEqual(found["energy_by_degree"], [float(f"{each:.4g}") for each in np.mean(spectra, axis=0)])
        for name in ("energy", "enstrophy", "quartic"):
            self.assertAlmostEqual(found[name], 1, 4)
        self.assertLess(max(found["energy_error"], found["spectrum_error"]), 1e-4)
        total = scene.energy(scene.initial)
        self.assertAlmostEqual(sum(found["energy_by_degree"]) / total, found["energy"], 4)

    def test_invariants_by_their_definitions(self):
        scene = turbulence_runs.drawn_scene(17, 0)
        W = scene.initial
        watch = turbulence_runs.Averages(scene, W, 0)
        expected = [scene.energy(W), -0.5 * np.trace(W @ W).real, np.trace(W @ W @ W @ W).real]
        np.testing.assert_allclose(watch.initial, expected, rtol=1e-12)
        watch(1, 1.01 * W, None)
        np.testing.assert_allclose(watch.found[0][-3:], [1.01**2, 1.01**2, 1.01**4], rtol=1e-12)

    def test_a_displaced_ensemble_is_another_run_of_the_same_flow(self):
        spectra = [turbulence_runs.carry_out({**SHORT, "ensemble": k})["energy_by_degree"] for k in (0, 0, 1)]
        self.assertEqual(spectra[0], spectra[1])
        self.assertNotEqual(spectra[0], spectra[2])

    def test_failures_are_told_and_have_no_average(self):
        lost = turbulence_runs.carry_out({**SHORT, "integrator": "rk4", "step": 10.0, "time": 2000.0})
        self.assertEqual((lost["status"], lost["energy_by_degree"]), (UNSTABLE, None))
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
        self.assertEqual(len(watch.found), 1)

    def test_steps_reach_the_time(self):
        self.assertEqual(turbulence_runs.steps_of({"step": 0.1, "time": 1000.0}), 10000)
        self.assertEqual(turbulence_runs.steps_of({"step": 0.3, "time": 1.0}), 4)
        self.assertEqual(turbulence_figures.steps_to(1000.0, 0.1), 10000)

    def test_runs_part(self):
        (time, at_window), (small_time, small) = turbulence_runs.part({**SHORT, "time": 40.0})
        self.assertEqual((time, small_time), (None, None))
        self.assertTrue(1e-6 < at_window < 1e-4 and 1e-8 < small < 1e-6, (at_window, small))
        with mock.patch.object(turbulence_runs, "PARTED", 1e-7):
            (time, _), (small_time, _) = turbulence_runs.part({**SHORT, "time": 60.0})
        self.assertEqual(time, 2.0)  # the first look
        self.assertGreater(small_time, time)

    def test_the_reference_converges(self):
        errors = [turbulence_runs.converge({**SHORT, "step": step}) for step in (1.0, 0.5)]
        self.assertLess(errors[1], errors[0] / 8)  # order 4
        self.assertGreater(errors[1], 0)


# ---- how ensembles are judged


def spectrum(random_numbers, noise, tilt=0.0):
    """Returns a made-up time average: E(l) ~ 2^(−l/4), noise in the logarithm that neighbours share, and a tilt."""
    shared = random_numbers.gauss(0, noise)
    return [2 ** (-l / 4) * math.exp(shared + random_numbers.gauss(0, noise) + tilt * l) for l in range(1, 25)]


def ensembles(seed, draws, count, tilt=0.0):
    numbers = random.Random(seed)
    return [[spectrum(numbers, 0.1, tilt) for _ in range(count)] for _ in range(draws)]


@mock.patch.object(turbulence_statistics, "COUNT", 300)
class Faithful(unittest.TestCase):
    def share(self, draws, tilt=0.0):
        """Returns the share of 200 ensembles that are faithful, each against five reference ensembles of its own."""
        found = 0
        for seed in range(200):
            *references, own = zip(*ensembles(seed, draws, 6))
            own = [[value * math.exp(tilt * l) for l, value in enumerate(each, 1)] for each in own]
            found += reference_of(list(zip(*references))).is_faithful(own)
        return found / 200

    def test_a_fresh_reference_ensemble_is_faithful_in_95_of_100_cases(self):
        # 200 cases: ± 1.5 % is a standard error.
        self.assertTrue(0.91 <= self.share(10) <= 0.99, self.share(10))
        self.assertTrue(0.88 <= self.share(3) <= 0.99, self.share(3))
        self.assertEqual(LEVEL, 0.95)

    def test_a_distorted_ensemble_is_not(self):
        self.assertLess(self.share(10, tilt=0.02), 0.02)
        self.assertLess(self.share(10, tilt=-0.02), 0.02)

    def test_the_distance_is_the_relative_error_of_the_spectrum(self):
        exact = [[[2.0 ** -l for l in range(1, 9)]] * 3 for _ in range(4)]
        reference = reference_of(exact)
        self.assertLess(reference.threshold, 1e-14)
        wrong = [[math.exp(0.05) * value for value in draw[0]] for draw in exact]
        self.assertAlmostEqual(reference.distance(wrong), 0.05)
        # Errors of opposite sign in half of the draws are noise; in half of the degrees they are an error.
        signs = [1, -1, 1, -1]
        noise = [[math.exp(0.05 * sign) * value for value in draw[0]] for sign, draw in zip(signs, exact)]
        self.assertAlmostEqual(reference.distance(noise), 0)
        wave = [[math.exp(0.05 * (-1) ** l) * value for l, value in enumerate(draw[0])] for draw in exact]
        self.assertAlmostEqual(reference.distance(wave), 0.05)
        self.assertTrue(reference.is_faithful([draw[0] for draw in exact]))
        self.assertFalse(reference.is_faithful(wave))
        self.assertEqual(reference.distance([[0.0, *draw[0][1:]] for draw in exact]), math.inf)

    def test_degrees_without_energy_do_not_count(self):
        exact = [[[1e-15, 1.0, 0.5, 2e-6, 1e-9]] * 2] * 3
        self.assertEqual(reference_of(exact).degrees, (2, 3, 4))

    def test_one_reference_ensemble_tells_nothing(self):
        with self.assertRaisesRegex(ValueError, "fewer than two"):
            reference_of([[[1.0, 0.5]]] * 3)

    def test_the_same_data_give_the_same_threshold(self):
        data = ensembles(1, 4, 3)
        self.assertEqual(reference_of(data), reference_of(data))


# ---- the raw file, the report and the figures

ENTRIES = ("algebra1", "elp4", "rk4", "rkmk4", "elp6")
HBAR_OVER_4 = 0.02
N = 33


def rows_of(role, setting, spectra, **changes):
    """Returns the runs of a setting: one with each spectrum, a draw each; a spectrum of None is a run that failed."""
    found = []
    for draw, energies in enumerate(spectra):
        row = RunRow(N, role, *setting, draw, 0, CONVERGED, 100.0, 1e-3, 1e-9, 1.0, 1.0, 1.0, energies)
        if energies is None:
            row = row._replace(status=UNSTABLE, time=40.0 + draw, energy=None, enstrophy=None, quartic=None)
        found.append(row._replace(**changes) if energies else row)
    return found


def cost(setting, seconds, solver=FAST, processes=6):
    """Returns a Cost whose times alternate by 1 % from process to process, as those of all others do."""
    times = [] if seconds is None else [seconds * 1.01 ** (-1) ** process for process in range(processes)]
    return Cost(N, *setting, solver, 40, None if seconds is None else 20.0, times)


def write_turbulence(path, at_window=1.3, **changed):
    """Writes a made-up raw file; `changed` tables are functions of their rows.

    algebra1, the practice, takes 0.05 s a run, elp4 with h = 1 a fifth of it, with h = 0.5 two fifths; rk4 takes a
    tenth of the practice's time with h = 0.5, and loses some enstrophy and a fifth of E(l).
    """
    data = ensembles(7, 4, 7)
    references = [draw[:5] for draw in data]
    faithful = [draw[5] for draw in data]
    wrong = [[0.8 * value for value in draw[5]] for draw in data]
    tables = {
        "integrators": [turbulence.study.record_of(entry) for entry in turbulence.study.entries(ENTRIES)],
        "sizes": [Size(n=N, draws=4, references=5, time=100.0, reference_integrator="elp6", reference_step=0.25,
                       reference_error=1e-9, norm_B=0.24)],
        "partings": [Parting(N, draw, size, time, at_window) for draw in range(4)
                     for size, time in ((1e-6, 30.0 + draw), (1e-8, None))],
        "runs": [RunRow(N, REFERENCE, "elp6", 0.25, 1e-10, draw, ensemble, CONVERGED, 100.0, 1e-9, 1e-15, 1.0, 1.0,
                        1.0, references[draw][ensemble]) for draw in range(4) for ensemble in range(5)]
        + rows_of(PRACTICE, ("algebra1", HBAR_OVER_4, LOOSE), faithful)
        + rows_of(PRACTICE, ("algebra1", HBAR_OVER_4, TIGHT), faithful)
        + rows_of(METHOD, ("elp4", 0.5, LOOSE), faithful) + rows_of(METHOD, ("elp4", 1.0, LOOSE), faithful)
        + rows_of(METHOD, ("elp4", 0.5, 1e-6), faithful)
        + rows_of(METHOD, ("elp4", 2.0, LOOSE), [*faithful[:2], None, None])
        + rows_of(METHOD, ("rkmk4", 1.0, LOOSE), faithful, energy=1.02)
        + rows_of(METHOD, ("rk4", 0.5, LOOSE), wrong, enstrophy=0.95),
        "costs": [cost(Setting("algebra1", HBAR_OVER_4, LOOSE), 1e-5),
                  cost(Setting("algebra1", HBAR_OVER_4, LOOSE), 4e-5, PUBLISHED),
                  cost(Setting("algebra1", HBAR_OVER_4, TIGHT), 2e-5),
                  cost(Setting("elp4", 0.5, LOOSE), 1e-4), cost(Setting("elp4", 1.0, LOOSE), 1e-4),
                  cost(Setting("elp4", 0.5, 1e-6), None), cost(Setting("rkmk4", 1.0, LOOSE), 5e-5),
                  cost(Setting("rk4", 0.5, LOOSE), 2.5e-5)]}
    for name, change in changed.items():
        tables[name] = change(tables[name])
    settings = Settings(lowest_degree=6, highest_degree=10, displacement=1e-6, small_displacement=1e-8, energy_loss=0.1,
                        max_sweeps=60, warm_steps=32)
    formats.write_study(path, SCHEMA, {"cpu": "a processor"}, settings, tables)
    return path


class Judged(unittest.TestCase):
    def test_what_is_lost_is_conserved_no_better_than_what_is_gained(self):
        close = turbulence_figures.CLOSE
        for change, conserves in ((-0.5, False), (0.5, False), (-0.9 * close, True), (0.9 * close, True)):
            judged = turbulence_figures.Judged(None, None, None, changes={"energy": 0.0, "enstrophy": change})
            self.assertEqual(judged.conserves, conserves, change)


class Report(DrawingTest):
    script = "render_turbulence"

    def raw(self, **changes):
        return write_turbulence(self.path("raw.json"), **changes)

    def figures(self, **changes):
        return turbulence_figures.figures(read_turbulence(self.raw(**changes)))

    def test_costs_and_winners(self):
        found = self.figures()
        self.assertAlmostEqual(found["n33.practice.seconds"], 0.05)
        self.assertAlmostEqual(found["n33.practice.published_over_fast"], 4)
        self.assertAlmostEqual(found["n33.practice_1e-13.over_practice"], 2)
        self.assertNotIn("n33.practice_1e-13.published_over_fast", found)  # not timed
        for structure, name, over in (("nothing", "rkmk4.h1", 0.1), ("spectrum", "rkmk4.h1", 0.1),
                                      ("nothing.close", "elp4.h1", 0.2), ("poisson", "elp4.h1", 0.2)):
            self.assertAlmostEqual(found[f"n33.cheapest.{structure}.{name}.over_practice"], over)
            self.assertAlmostEqual(found[f"n33.cheapest.{structure}.{name}.practice_over"], 1 / over)
        # rk4 is the cheapest of all, and not faithful.
        self.assertAlmostEqual(found["n33.rk4.h0.5.over_practice"], 0.1)
        self.assertEqual(len([key for key in found if key.startswith("n33.cheapest.nothing.rkmk4")]), 7)
        self.assertEqual((found["n33.cheapest.nothing.ties"], found["n33.cheapest.nothing.undecided"]), (0, 0))
        self.assertAlmostEqual(found["n33.cheapest_of.elp4.over_practice"], 0.2)
        self.assertEqual(found["n33.cheapest_of.elp4.step"], 1)

    def test_costs_within_5_percent_tie(self):
        def elp4(share, spread=1.0):
            """Gives elp4 with h = 1 a cost that is a share of that of rkmk4, with another spread over processes."""
            return lambda rows: [row._replace(seconds=[share * 5e-5 * 1.01 ** (-1) ** k * spread ** (k % 3 - 1)
                                                       for k in range(6)])
                                 if (row.integrator, row.step) == ("elp4", 1.0) else row for row in rows]

        for costs, ties, undecided in ((elp4(1.03), 1, 0), (elp4(1.2), 0, 0), (elp4(1.04, spread=1.1), 0, 1)):
            found = self.figures(costs=costs)
            self.assertEqual((found["n33.cheapest.nothing.ties"], found["n33.cheapest.nothing.undecided"]),
                             (ties, undecided))
            self.assertEqual("n33.cheapest.nothing.tie.elp4.h1.over_practice" in found, bool(ties))
            self.assertIn("n33.cheapest.nothing.rkmk4.h1.over_practice", found)
        self.assertLess(found["n33.elp4.h1.over_practice_low"], found["n33.elp4.h1.over_practice"])
        self.assertGreater(found["n33.elp4.h1.over_practice_high"], found["n33.elp4.h1.over_practice"])
        report = self.rendered("out", self.raw(costs=elp4(1.03)))["report.md"].decode()
        self.assertIn("elp4 with h = 1 |", report)

    def test_few_processes_decide_nothing(self):
        found = self.figures(costs=lambda rows: [row._replace(seconds=row.seconds[:3]) for row in rows])
        self.assertEqual((found["n33.cheapest.nothing.ties"], found["n33.cheapest.nothing.undecided"]), (0, 2))
        self.assertNotIn("n33.elp4.h1.over_practice_low", found)

    def test_what_the_sweep_cap_ends_is_told_apart(self):
        def capped(rows):
            return [row._replace(status=SWEEP_CAP) if row.status == UNSTABLE else row for row in rows]

        for change, label in ((list, "_failure"), (capped, "_cap")):
            raw = self.raw(runs=change)
            study = read_turbulence(raw)
            found = turbulence_figures.figures(study)
            self.assertEqual((found["n33.elp4.h2.failed"], found["n33.elp4.h2.capped"]),
                             (2, 2 if label == "_cap" else 0))
            (axes,), = self.panels("turbulence_chart", "statistical_error", study).values()
            self.assertEqual([line.get_label() for line in axes.lines if line.get_label() in ("_failure", "_cap")],
                             [label])
        self.assertIn("2 of 4 sweep cap", self.rendered("out", raw)["report.md"].decode())

    def test_what_is_faithful(self):
        found = self.figures()
        self.assertEqual([found[f"n33.{key}.faithful"] for key in (
            "practice", "practice_1e-13", "elp4.h0.5", "elp4.h0.5.tolerance_1e-6", "elp4.h2", "rkmk4.h1",
            "rk4.h0.5")], [1, 1, 1, 1, 0, 1, 0])
        self.assertEqual(found["n33.largest_faithful.elp4"], 1)
        self.assertNotIn("n33.largest_faithful.rk4", found)
        self.assertAlmostEqual(found["n33.rk4.h0.5.enstrophy"], -0.05)
        self.assertAlmostEqual(found["n33.rkmk4.h1.energy"], 0.02)
        self.assertAlmostEqual(found["n33.rk4.h0.5.tail"], 0.8 * (1 + found["n33.elp4.h0.5.tail"]) - 1)
        self.assertEqual(found["n33.elp4.h2.failed"], 2)
        self.assertNotIn("n33.elp4.h2.distance", found)
        self.assertGreater(found["n33.rk4.h0.5.distance"], found["n33.threshold"])

    def test_parting(self):
        found = self.figures()
        self.assertEqual([found[f"n33.parted.1e-6.{key}"] for key in ("draws", "least", "most")], [4, 30, 33])
        self.assertEqual(found["n33.parted.1e-8.draws"], 0)
        self.assertNotIn("n33.parted.1e-8.least", found)

    def test_nothing_is_judged_where_runs_have_not_parted(self):
        found = self.figures(at_window=1e-3)
        self.assertEqual({value for key, value in found.items() if key.endswith(".faithful")}, {0})
        self.assertFalse(any(".cheapest" in key or ".largest" in key for key in found))
        files = self.rendered("out", self.raw(at_window=1e-3))
        self.assertIn("Nothing is judged here", files["report.md"].decode())

    def test_every_draw_is_to_be_independent(self):
        def nearer(difference):
            return lambda rows: [row._replace(at_window=difference) if row[1:3] == (2, 1e-6) else row for row in rows]

        for difference, judged in ((1.0, True), (0.99, False), (0.5, False)):  # correlations 0.5, 0.51 and 0.875
            with self.subTest(difference=difference):
                study = read_turbulence(self.raw(partings=nearer(difference)))
                self.assertEqual(study.is_unpredictable(N), judged)

    def test_the_report(self):
        files = self.rendered("out", self.raw())
        self.assertEqual(set(files), {"report.md", "figures.json", "statistical_error.svg", "statistical_error.png"})
        self.assert_whole(files, "statistical_error")
        report = files["report.md"].decode()
        self.assertNotIn("Nothing is judged", report)
        cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in report.splitlines()
                 if line.startswith("|")]
        self.assertIn(["33", "any", "rkmk4", "1", "1e-08", "0.00500", "0.100 (0.100–0.100)"],
                      [row[:7] for row in cells])
        self.assertIn(["33", "any, close", "elp4", "1", "1e-08", "0.0100", "0.200 (0.200–0.200)"],
                      [row[:7] for row in cells])
        self.assertIn(["settings judged", "8"], cells)
        self.assertIn(["draws", "4"], cells)
        self.assertIn(["33", "1e-06", "4 of 4", "30 to 33", "1.3", "1.3"], cells)
        self.assertIn(["33", "1e-08", "0 of 4", "–", "1.3", "1.3"], cells)
        self.assertIn(["elp4", "1"], cells)
        self.assertIn(["rk4", "–"], cells)
        self.assertIn(["elp4", "2", "1e-08", "–", "–", "2 of 4 unstable, t = 42 to 43", *"–––––"], cells)
        practice = next(row for row in cells if row[:3] == ["algebra1", "0.02", "1e-08"])
        self.assertEqual(practice[3:5], ["0.0500", "1.00 (1.00–1.00)"])
        self.assertTrue(practice[5].startswith("**"), practice)
        rk4 = next(row for row in cells if row[:2] == ["rk4", "0.5"])
        self.assertFalse(rk4[5].startswith("**"), rk4)
        self.assertEqual(rk4[8], "-5 %")
        self.assertIn(["33", "0.02", "1e-08", "0.200", "4.00 (4.00–4.00)"], cells)
        self.assertIn(["33", "fast", "6", "40", "0.8 to 40"], cells)
        self.assertEqual(read_figures(self.path("out", "figures.json"))["n33.draws"], 4)

    def test_the_chart(self):
        (axes,), = self.panels("turbulence_chart", "statistical_error", read_turbulence(self.raw())).values()
        drawn = lines_of(axes)
        self.assertEqual(set(drawn), {"algebra1", "elp4", "rkmk4", "rk4"})
        np.testing.assert_allclose([x for x, _ in drawn["elp4"]], [0.2, 0.4])
        np.testing.assert_allclose([x for x, _ in drawn["algebra1"]], [1.0])
        failures = [line for line in axes.lines if line.get_label() == "_failure"]
        np.testing.assert_allclose([line.get_xdata()[0] for line in failures], [0.2])  # that of elp4

    def test_few_draws_decide_nothing(self):
        few = read_turbulence(self.raw())  # four draws
        enough = few._replace(sizes={N: few.sizes[N]._replace(draws=FEWEST)})
        for study, is_decided in ((few, False), (enough, True)):
            title = turbulence_chart.title_of(study, {N: turbulence_figures.findings_of(study, N)})
            self.assertEqual("faithful" in title, is_decided, title)
            self.assertEqual(bool(turbulence_report.few_draws_paragraphs(study)), not is_decided)

    def test_no_chart_without_a_line(self):
        self.assertEqual(set(self.rendered("out", self.raw(
            runs=lambda rows: [row for row in rows if row.integrator != "elp4"]))), {"report.md", "figures.json"})

    def test_files_that_cannot_be_used(self):
        def without(**field):
            (name, value), = field.items()
            return lambda rows: [row for row in rows if getattr(row, name) != value]

        for changes, told in (
                ({"runs": lambda rows: []}, "no runs"),
                ({"sizes": lambda rows: []}, "runs at n = 33"),
                ({"partings": without(displacement=1e-6)}, "how two runs of every draw part at n = 33"),
                ({"partings": lambda rows: [row for row in rows if row[1:3] != (2, 1e-6)]}, "of every draw part"),
                ({"integrators": without(name="rk4")}, "does not list the integrator rk4"),
                ({"integrators": without(name="elp6")}, "does not list the integrator elp6"),
                ({"runs": lambda rows: [row for row in rows if (row.role, row.draw) != (METHOD, 1)]},
                 "not every draw of elp4"),
                ({"runs": lambda rows: rows[1:]}, "not every reference run at n = 33"),
                ({"costs": lambda rows: [rows[0]._replace(seconds=[1e-5]), *rows[1:]]}, "numbers of processes")):
            with self.subTest(told=told):
                raw = self.raw(**changes)
                with self.assertRaisesRegex(UnusableFile, told):
                    read_turbulence(raw)
                self.assert_refused(run_script(RENDER, raw, "--out", self.path("out")), "raw.json", told)
        self.assert_refused(run_script(RENDER, self.path("none.json"), "--out", self.path("out")), "none.json")
        self.assert_refused(run_script(RENDER, self.raw(), "--out", self.write("taken", "")), "taken")


class Plan(unittest.TestCase):
    def test_settings(self):
        whole = turbulence.settings_of(33, turbulence.WHOLE, turbulence.STEPS)
        self.assertEqual(len(set(whole)), len(whole))
        steps = {setting.step for role, setting in whole if role == PRACTICE}
        self.assertAlmostEqual(steps.pop(), 0.5 / math.sqrt(33 * 32))
        self.assertEqual(steps, set())
        self.assertEqual(len(turbulence.settings_of(129, turbulence.LARGE, turbulence.STEPS)), 8)
        few = turbulence.settings_of(33, turbulence.WHOLE, ["rk4"])
        self.assertEqual({setting.integrator for _, setting in few}, {"rk4", "algebra1"})
        self.assertEqual([turbulence.plan_of(n, False).draws for n in (33, 65, 129)], [10, 10, 3])

    def test_what_is_timed_are_settings_whose_runs_all_work(self):
        plan = turbulence.QUICK
        spectra = [[1.0, 0.5]] * plan.draws
        rows = [row for role, setting in turbulence.settings_of(N, plan, ["rk4"])
                for row in rows_of(role, setting, [None, *spectra[1:]] if setting.step == 0.5 else spectra)]
        points = [(point["integrator"], point["step"], point["solver"])
                  for point in turbulence.points_of(N, plan, rows)]
        step = 0.5 / math.sqrt(33 * 32)
        self.assertEqual(points, [*[("algebra1", step, FAST)] * 2, ("rk4", 0.25, FAST),
                                  *[("algebra1", step, PUBLISHED)] * 2])

    def test_the_timed_stretch(self):
        self.assertEqual([turbulence.timed_steps(step, FAST) for step in (0.01, 0.5, 4.0)], [1000, 20, 8])
        self.assertEqual(turbulence.timed_steps(0.01, PUBLISHED), 100)

    def test_counts_and_times_of_a_step(self):
        point = {**Setting("elp4", 0.5, LOOSE)._asdict(), "n": 17, "solver": FAST, "steps": 8}
        prepared = turbulence.prepare({**SHORT, "points": [point, {**point, "step": 50.0}]})
        self.assertGreater(prepared["counts"][0], 1)
        self.assertIsNone(prepared["counts"][1])
        W = problems.decoded(prepared["state"], 17)
        self.assertLess(isosyrk.spectrum_error(W, turbulence_runs.drawn_scene(17, 0).initial),
                        40 * 1e-10)  # that many steps to T/2, at that tolerance
        block, = turbulence.blocks_of([point, {**point, "step": 0.25}])
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "W.npy")
            np.save(path, W)
            seconds = turbulence.time_block({**block, "process": 0, "state": path})
        self.assertEqual(len(seconds), 2)
        self.assertGreater(min(seconds), 0)


class Study(FolderTest):
    def study(self, *arguments):
        return run([sys.executable, "-B", SCRIPT, *arguments], timeout=300, env=environment(ISOSYRK_BUILD=BUILD))

    def test_a_quick_study_ends_with_a_report(self):
        raw = self.path("raw.json")
        done = self.study("--quick", "--n", "17", "--integrator", "rk4", "--processes", "1", "--out", raw)
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertEqual(os.listdir(self.folder), ["raw.json"])  # and no journal
        found = read_turbulence(raw)
        self.assertEqual((found.sizes[17].draws, found.sizes[17].references), (2, 3))
        self.assertEqual({setting.integrator for setting in found.ensembles[17]}, {"algebra1", "rk4"})
        self.assertTrue(found.cost(17, Setting("rk4", 0.25, LOOSE)))
        self.assertTrue(found.cost(17, found.practice(17).setting, PUBLISHED))
        self.assertFalse(found.is_unpredictable(17))  # T is short
        done = run_script(RENDER, raw, "--out", self.path("out"))
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))

    def test_refusals(self):
        out = ("--out", self.path("raw.json"))
        self.assert_refused(self.study("--n", "9", *out), "--n 9", "at least 11")
        self.assert_refused(self.study("--integrator", "suzuki4", *out), "--integrator 'suzuki4'", "rkmk4")
        self.assert_refused(self.study("--quick", "--out", self.path("none", "raw.json")), "--out")
        self.assertEqual(os.listdir(self.folder), [])


if __name__ == "__main__":
    unittest.main()
