"""Tests of how drift is judged, of the study of long runs, and of its report and charts, as a user runs them."""

import math
import os
import random
import sys
import unittest
from unittest import mock

from drawing import DrawingTest, lines_of
from programs import BUILD, DONE, HAS_MODULE, ROOT, FolderTest, environment, run, text_of

from lib import formats
from lib.drift import ALL_LOST, BOUNDED, FAILED, GROWS, KEPT, LOST, ROUNDING, growth_of, in_blocks, judged
from lib.figures import read_figures
from lib.formats import Integrator, Study
from lib.longruns_files import (COARSE, ENERGY, FINE, LEVELS, ONE_STEP, SCHEMA, SPECTRUM, Plan, Run, Settings,
                                long_runs, read_longruns)
from lib.messages import UnusableFile
from lib.verdicts import UNDECIDED

STUDY = os.path.join(ROOT, "scripts", "studies", "longruns.py")
TIMES = [5.0 * k for k in range(1, 201)]  # of 200 windows to T = 1000
SAMPLES = [25.0 * k for k in range(1, 41)]


# ---- how drift is judged


def noise(generator, correlation=0.0):
    """Yields standard normal noise, each value with this correlation to the one before."""
    value = generator.gauss(0, 1)
    while True:
        yield value
        value = correlation * value + math.sqrt(1 - correlation**2) * generator.gauss(0, 1)


def bounded(seed, correlation=0.0, size=1e-6):
    """Returns a series of maxima that fluctuate by a tenth around a size."""
    found = noise(random.Random(seed), correlation)
    return [(time, size * math.exp(0.1 * next(found))) for time in TIMES]


def drifting(seed, power, at_the_end=1e-4):
    """Returns the same around a power of time."""
    return [(time, error * at_the_end / 1e-6 * (time / TIMES[-1])**power) for time, error in bounded(seed)]


def walk(seed, size=1e-6):
    """Returns the largest |x| in each window of 20 steps of a random walk x."""
    generator = random.Random(seed)
    x, series = 0.0, []
    for time in TIMES:
        largest = 0.0
        for _ in range(20):
            x += size * generator.gauss(0, 1)
            largest = max(largest, abs(x))
        series.append((time, largest))
    return series


def shares(make, seeds=range(200)):
    """Returns the share of each verdict on the series that `make` makes of seeds."""
    found = [judged(make(seed)).verdict for seed in seeds]
    return {verdict: found.count(verdict) / len(found) for verdict in set(found)}


class Drift(unittest.TestCase):
    def test_bounded_noise_is_bounded_and_its_interval_holds_zero(self):
        for correlation in (0.0, 0.8):
            with self.subTest(correlation=correlation):
                self.assertEqual(shares(lambda seed: bounded(seed, correlation)), {BOUNDED: 1.0})
        inside = [growth.low <= 0 <= growth.high for growth in (growth_of(bounded(seed)) for seed in range(300))]
        self.assertGreater(inside.count(True) / 300, 0.90)  # 0.95, but for 300 draws and ten blocks
        self.assertLess(inside.count(True) / 300, 0.99)

    def test_an_interval_by_shorter_blocks_would_be_too_short(self):
        # The control of the blocks: on noise with a correlation, blocks of three points miss 0 far more often.
        def misses(count):
            with mock.patch("lib.drift.BLOCKS", count):
                found = [growth_of(bounded(seed, 0.8)) for seed in range(100)]
            return sum(not growth.low <= 0 <= growth.high for growth in found)

        self.assertGreater(misses(60), 2 * misses(10))

    def test_a_power_is_found_and_grows(self):
        for power in (0.3, 0.5, 1.0, 2.0):
            with self.subTest(power=power):
                self.assertEqual(shares(lambda seed: drifting(seed, power)), {GROWS: 1.0})
                growth = growth_of(drifting(1, power))
                self.assertAlmostEqual(growth.power, power, delta=0.05)
                self.assertTrue(growth.low < growth.power < growth.high)

    def test_a_linear_drift_hidden_by_a_bounded_error_is_not_called_growth_before_it_shows(self):
        def hidden(share):
            return [(time, error + share * 1e-6 * time / TIMES[-1]) for time, error in bounded(3)]

        self.assertEqual(judged(hidden(0.01)).verdict, BOUNDED)
        self.assertEqual(judged(hidden(10)).verdict, GROWS)

    def test_a_random_walk_is_seldom_called_bounded(self):
        # It may stay where it is by chance; bounded noise of the same size never is anything else.
        found = shares(walk)
        self.assertLess(found.get(BOUNDED, 0), 0.2)
        self.assertGreater(found[GROWS] + found.get(UNDECIDED, 0), 0.75)

    def test_a_loss_is_a_loss_even_if_it_is_bounded(self):
        lost = bounded(1, size=0.97)
        self.assertEqual(judged(lost).verdict, ALL_LOST)
        self.assertAlmostEqual(judged(lost).growth.power, 0, delta=0.1)
        # Total: all energy goes within a few windows, and nothing grows after that.
        self.assertEqual(judged([(time, -math.expm1(-time)) for time in TIMES]).verdict, ALL_LOST)
        self.assertNotEqual(judged(bounded(1, size=LOST / 2)).verdict, ALL_LOST)

    def test_what_stays_at_rounding_is_kept_whatever_its_power(self):
        self.assertEqual(judged(drifting(1, 1.0, at_the_end=ROUNDING / 10)).verdict, KEPT)
        self.assertEqual(judged([(time, 0.0) for time in TIMES]), (KEPT, None))
        self.assertNotEqual(judged(drifting(1, 1.0, at_the_end=ROUNDING * 10)).verdict, KEPT)

    def test_a_run_that_failed_and_one_too_short(self):
        self.assertEqual(judged(bounded(1)[:50], finished=False).verdict, FAILED)
        self.assertEqual(judged([], finished=True), (FAILED, None))
        self.assertEqual(judged(bounded(1)[:20]), (UNDECIDED, None))
        self.assertEqual(judged([(time, 1e-6) for time in SAMPLES]).verdict, BOUNDED)

    def test_only_the_last_decade_counts(self):
        series = bounded(1)
        early = [(time, error * 1e3 if time <= 100 else error) for time, error in series]
        self.assertEqual(growth_of(early), growth_of(series))
        late = [(time, error * 1e3 if time <= 200 else error) for time, error in series]
        self.assertNotEqual(growth_of(late), growth_of(series))

    def test_blocks(self):
        self.assertEqual(in_blocks(list(range(7)), 3), [[0, 1], [2, 3], [4, 5, 6]])


# ---- a made-up study


def integrator(name, order, isospectral, lie_poisson, explicit):
    return Integrator(name, 1, order, isospectral, lie_poisson, False, explicit, None)


INTEGRATORS = [integrator("group2_frame", 4, True, True, False), integrator("elp6_frame", 6, True, True, False),
               integrator("rkmk4_frame", 4, True, False, True), integrator("rk4_frame", 4, False, False, True)]
MADE = {  # method: integrator, tolerance, energy error at the end and its power, the same of the spectrum
    "group2": ("group2_frame", 1e-13, (1e-6, 0), (1e-14, 0)),
    "group2_loose": ("group2_frame", 1e-7, (1e-6, 0), (1e-5, 1)),
    "elp6": ("elp6_frame", 1e-8, (2e-8, 0), (0.0, 0)),
    "rkmk4": ("rkmk4_frame", 1e-13, (3e-3, 1), (1e-14, 0)),
    "rk4": ("rk4_frame", 1e-13, (5e-3, 1), (2e-1, 1))}


def of_power(times, at_the_end, power):
    return [at_the_end * (time / times[-1])**power for time in times]


def made_run(method, scene="smooth", level=COARSE, n=33, seconds=(1e-3, 1.1e-3, 1e-3), **changes):
    name, tolerance, energy, spectrum = MADE[method]
    return Run(scene, n, name, tolerance, level, 4000, 0.25, "converged", None, 3.0, 100.0, -energy[0],
               of_power(TIMES, *energy), of_power(SAMPLES, *spectrum), of_power(SAMPLES, *spectrum),
               list(seconds))._replace(**changes)


def made_study(runs=None):
    if runs is None:
        runs = [made_run(method, scene, level) for scene in ("smooth", "rough") for level in LEVELS for method in MADE]
    return Study({"cpu": "a processor"}, Settings(False, 5),
                 {"integrators": INTEGRATORS, "plans": [Plan(33, 1000.0, 200)], "runs": runs})


def write_longruns(folder, study=None, name="raw.json"):
    """Writes a raw file, by default the made-up one, and returns its path."""
    study, path = study or made_study(), os.path.join(folder, name)
    formats.write_study(path, SCHEMA, study.context, study.settings, study.tables)
    return path


class Files(FolderTest):
    def test_runs_by_method_and_level(self):
        found = read_longruns(write_longruns(self.folder))
        self.assertEqual(found.methods(), list(MADE))
        self.assertEqual(found.settings(), [(33, "smooth"), (33, "rough")])
        run = found.at("smooth", 33, COARSE)["rkmk4"]
        self.assertEqual(run.series(ENERGY)[0][0], 5.0)
        self.assertEqual([time for time, _ in run.series(SPECTRUM)], SAMPLES)
        self.assertEqual((run.last(ENERGY), run.judged(ENERGY).verdict), (3e-3, GROWS))
        self.assertEqual(found.at("smooth", 33, COARSE)["rk4"].judged(SPECTRUM).verdict, ALL_LOST)

    def test_equal_costs_are_compared_with_their_median(self):
        runs = [made_run(method) for method in MADE]
        runs[1] = made_run("group2_loose", seconds=[1.2e-3])
        runs.append(made_run("rk4", level=ONE_STEP, seconds=[1e-5]))
        found = long_runs(made_study(runs))
        (loose, other), one = ((found.at("smooth", 33, COARSE)[name] for name in ("group2_loose", "rk4")),
                               found.at("smooth", 33, ONE_STEP)["rk4"])
        self.assertAlmostEqual(found.cost_share(loose), 1.2)
        self.assertEqual([found.is_unequal(each) for each in (loose, other, one)], [True, False, False])
        self.assertIsNone(found.cost_share(one))

    def test_damage(self):
        for study, part in ((made_study([]), "no runs"),
                            (made_study([made_run("rk4", n=65)]), "without its plan")):
            with self.subTest(part), self.assertRaisesRegex(UnusableFile, part):
                long_runs(study)


class Render(DrawingTest):
    script = "render_longruns"
    CHARTS = ("energy_against_time", "energy_against_spectrum")

    def test_charts_report_and_figures(self):
        files = self.rendered("out", write_longruns(self.folder))
        self.assertEqual(set(files), {"report.md", "figures.json", *(f"{chart}.{kind}" for chart in self.CHARTS
                                                                     for kind in ("svg", "png"))})
        for chart in self.CHARTS:
            self.assert_whole(files, chart)
            self.assertIn(f"({chart}.svg)".encode(), files["report.md"])
        figures = read_figures(self.path("out", "figures.json"))
        for key, value in (("smooth.n33.coarse.rkmk4.energy_error", 3e-3),
                           ("rough.n33.one_step.rk4.spectrum_error", 0.2),
                           ("energy.lie_poisson.runs", 12), ("energy.lie_poisson.bounded", 12),
                           ("energy.rkmk4.grows", 6), ("energy.rkmk4.n33.grows", 6), ("energy.rkmk4.n33.runs", 6),
                           ("spectrum.rk4.lost", 6), ("spectrum.rk4.n33.grows", 0), ("equal_cost.unequal", 0),
                           ("smooth.n33.coarse.elp6.energy_change", -2e-8)):
            self.assertAlmostEqual(figures[key], value, msg=key)
        self.assertAlmostEqual(figures["smooth.n33.coarse.rkmk4.energy_power"], 1, places=5)

    def cells(self, study, *start):
        """Returns the rest of the row of the report that starts with some cells, in its last table that has one."""
        self.render(write_longruns(self.folder, study), "--out", self.path("out"))
        lines = [[cell.strip() for cell in line.strip("|").split("|")]
                 for line in text_of(self.path("out", "report.md")).splitlines() if line.startswith("|")]
        return [line[len(start):] for line in lines if line[:len(start)] == list(start)]

    def test_findings_and_runs_in_the_report(self):
        (findings,) = self.cells(made_study(), "33", "smooth", "1000", "fine equal cost")
        self.assertEqual(findings, ["3.0e-3 (t^1.00)", "2.0e-1 (lost)", "–", "1.0e-6 (bounded)", "2.0e-8 (bounded)",
                                    "–", "0 (kept)"])
        row = self.cells(made_study(), "fine equal cost", "group2\\_loose")[0]
        self.assertEqual(row, ["0.250", "1.0e-6", "-1.0e-6", "0.00 (0.00 to 0.00)", "bounded", "1.0e-5",
                               "1.00 (1.00 to 1.00)", "grows", "1.0e-5"])

    def test_a_failed_run_is_shown_as_such_and_has_no_cost(self):
        runs = [made_run(method) for method in MADE]
        runs[-1] = made_run("rk4", status="diverged", failed_step=7, seconds=(), energy_change=None, energy_errors=[],
                            spectrum_errors=[], casimir_errors=[])
        row, cost = self.cells(made_study(runs), "coarse equal cost", "rk4")
        self.assertEqual(row, ["0.250", "–", "–", "–", "diverged at step 7", "–", "–", "diverged at step 7", "–"])
        self.assertEqual(cost, ["–"])

    def test_unequal_costs_are_marked(self):
        runs = [made_run(method) for method in MADE]
        runs[0] = made_run("group2", seconds=[1.3e-3])
        self.assertEqual(self.cells(made_study(runs), "coarse equal cost", "group2")[-1], ["1.30 (130 %, unequal)"])

    def test_lines_and_dots(self):
        runs = long_runs(made_study())
        (panel,) = self.panels("longruns_charts", "energy_against_time", runs)[""]
        lines = lines_of(panel)
        self.assertEqual(list(lines), ["group2", "elp6", "rkmk4", "rk4"])
        self.assertEqual(lines["rkmk4"], [[time, error] for time, error in zip(TIMES, of_power(TIMES, 3e-3, 1))])
        self.assertEqual(panel.figure.texts[0].get_text().replace("\n", " "),
                         "Energy error at equal cost, n = 33: bounded for 2 of 4 methods")
        labels = [text.get_text() for text in panel.texts]
        for label in ("Gauss 4 (bounded)", "exponential 6 (bounded)", "RKMK4 (t^1.0)", "RK4 (t^1.0)"):
            self.assertIn(label, labels)
        panels = self.panels("longruns_charts", "energy_against_spectrum", runs)
        self.assertEqual(list(panels), ["smooth scene", "rough scene"])
        (smooth,), (rough,) = panels.values()
        self.assertEqual(smooth.figure.texts[0].get_text().replace("\n", " "),
                         "At the end (n = 33, smooth) RK4 is off by 2.0e-1 in an eigenvalue; in energy RKMK4 by 3.0e-3,"
                         " exponential 6 by 2.0e-8")
        dots = lines_of(smooth)
        self.assertEqual(dots["RK4"], [[0.2, 5e-3]])
        self.assertEqual(dots["Gauss 4, 1e-7"], [[1e-5, 1e-6]])
        self.assertEqual(dots["exponential 6"], [[1e-16, 2e-8]])  # an exact 0 is drawn at the edge
        self.assertEqual(smooth.get_xlim(), rough.get_xlim())
        self.assertEqual(smooth.get_ylim(), rough.get_ylim())

    def test_a_failed_run_ends_with_a_cross_and_has_no_dot(self):
        runs = [made_run(method, level=level) for level in (ONE_STEP, COARSE) for method in MADE]
        at = {(each.method, each.level): number for number, each in enumerate(runs)}
        for level in (ONE_STEP, COARSE):
            runs[at["rk4", level]] = made_run("rk4", level=level, status="unstable", failed_step=900, seconds=(),
                                              energy_errors=of_power(TIMES, 5e-3, 1)[:45], spectrum_errors=[1e-3] * 9)
        found = long_runs(made_study(runs))
        (panel,) = self.panels("longruns_charts", "energy_against_time", found)[""]
        crosses = [line.get_xydata().tolist() for line in panel.lines if line.get_label() == "_failure"]
        self.assertEqual(crosses, [[lines_of(panel)["rk4"][-1]]])
        self.assertIn("RK4 (failed)", [text.get_text() for text in panel.texts])
        (dots,) = self.panels("longruns_charts", "energy_against_spectrum", found)["smooth scene"]
        self.assertNotIn("RK4", lines_of(dots))
        self.assertEqual(dots.figure.texts[0].get_text(), "Errors at the end, n = 33")

    def test_a_file_that_cannot_be_used(self):
        for path, *parts in ((self.path("none.json"), "none.json"),
                             (write_longruns(self.folder, made_study([])), "raw.json", "no runs"),
                             (self.write("half.json", '{"format": '), "half.json", "whole JSON")):
            with self.subTest(parts=parts):
                self.assert_refused(self.render(path, "--out", self.path("out")), *parts)
                self.assertFalse(os.path.exists(self.path("out")))
        self.assert_refused(self.render(write_longruns(self.folder)), "--out")


# ---- the study itself

if HAS_MODULE:
    sys.path[:0] = [os.path.join(BUILD, "python"), os.path.dirname(STUDY)]
    import isosyrk
    import longruns


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class Runs(FolderTest):
    def study(self, *arguments):
        return run([sys.executable, "-B", STUDY, "--out", self.path("raw.json"), *arguments], timeout=120,
                   env=environment(ISOSYRK_BUILD=BUILD))

    def test_quick_runs_of_two_methods(self):
        done = self.study("--quick", "--integrator", "rk4", "elp4", "--repetitions", "2")
        self.assertEqual((done.returncode, done.stdout), (DONE, ""), done.stderr)
        self.assertEqual(os.listdir(self.folder), ["raw.json"])
        found = read_longruns(self.path("raw.json"))
        self.assertEqual((found.methods(), found.settings()), (["elp4", "rk4"], [(17, "smooth"), (17, "rough")]))
        self.assertEqual(len(found.runs), 2 * 2 * len(LEVELS))
        self.assertIn("timed_on", found.context)
        for (scene, n, method, level), each in found.runs.items():
            with self.subTest(scene=scene, method=method, level=level):
                self.assertEqual(each.run.status, "converged")
                self.assertEqual((len(each.run.energy_errors), len(each.run.spectrum_errors)), (50, 10))
                self.assertAlmostEqual(each.run.steps * each.run.step, 50.0)
                self.assertTrue(1 <= len(each.run.cpu_seconds) <= 2)
                self.assertGreaterEqual(max(each.run.energy_errors), abs(each.run.energy_change))
                spectrum = each.last(SPECTRUM)
                self.assertTrue(spectrum < 1e-13 if method == "elp4" else spectrum > 1e-11)

    def test_windows_hold_the_largest_energy_errors(self):
        scene = isosyrk.scene("smooth", n=9)
        energy = scene.energy(scene.initial)
        states = {}
        isosyrk.integrator(scene, "rk4").run(scene.initial, 0.3, 30,
                                             lambda step, W, _: states.update({step: W.copy()}))
        watch = longruns.Watch(scene, 3)
        for step, W in states.items():
            watch(step, W, None)
        errors = [abs(scene.energy(states[step]) / energy - 1) for step in range(1, 31)]
        expected = [max(errors[k:k + 3]) for k in range(0, 30, 3)]
        for found, each in zip(watch.found["energy_errors"], expected):
            self.assertAlmostEqual(found / each, 1, delta=0.01)  # three digits are written
        self.assertEqual(len(watch.found["spectrum_errors"]), 10 // longruns.WINDOWS_A_SAMPLE)
        self.assertAlmostEqual(watch.found["spectrum_errors"][-1] / isosyrk.spectrum_error(states[30], scene.initial),
                               1, delta=0.01)

    def test_energy_without_measure_ends_a_run(self):
        scene = isosyrk.scene("smooth", n=9)
        for factor, gone in ((2.0, False), (1e4, True), (math.nan, True)):
            watch = longruns.Watch(scene, 1)
            self.assertEqual((watch(1, factor * scene.initial, None), watch.gone), (gone, gone))
        job = {"scene": "smooth", "n": 17, "integrator": "rk4_frame", "tolerance": 1e-13, "time": 500.0,
               "steps_a_window": 1}  # h = 10
        found = longruns.carry_out(job)
        self.assertNotEqual(found["status"], "converged")
        self.assertLess(found["failed_step"], 50)

    def test_energies_are_seen_at_the_ends_of_windows_and_often_enough(self):
        for steps in range(1, 1200):
            every = longruns.steps_between_energies(steps)
            self.assertEqual(steps % every, 0)
            self.assertGreaterEqual(steps // every, min(steps, longruns.ENERGIES_A_WINDOW))
        self.assertEqual([longruns.steps_between_energies(steps) for steps in (7, 20, 40, 450, 475)], [1, 1, 2, 18, 19])

    def test_every_method_has_steps_at_every_n(self):
        self.assertEqual(set(longruns.STEPS_AT_EQUAL_COST),
                         {(n, scene) for n in longruns.PLANS for scene in ("smooth", "rough")})
        for place, steps in longruns.STEPS_AT_EQUAL_COST.items():
            self.assertEqual(set(steps), set(longruns.METHODS), place)
            for coarse, fine in steps.values():
                self.assertLess(coarse, fine)
        self.assertEqual(set(longruns.STEPS_AT_ONE_STEP), set(longruns.PLANS))
        levels = [job["level"] for job in longruns.jobs_of(33, longruns.METHODS)]
        self.assertEqual({level: levels.count(level) for level in LEVELS}, dict.fromkeys(LEVELS, 22))
        self.assertEqual(set(levels[-22:]), {FINE})  # the longest last

    def test_methods_are_named_in_files_as_in_the_study(self):
        for method in longruns.METHODS:
            name, tolerance = longruns.integrator_of(method)
            row = made_run("rk4", integrator=name, tolerance=tolerance)
            self.assertEqual(row.method, method)

    def test_bad_arguments(self):
        for arguments, *parts in ((("--n", "21"), "--n 21", "17, 33, 65, 129"), (("--integrator", "euler"), "'euler'"),
                                  (("--integrator", "group1"), "--integrator group1", "group2"),
                                  (("--repetitions", "0"), "--repetitions"), (("--steps", "9"), "--steps")):
            with self.subTest(arguments=arguments):
                self.assert_refused(self.study(*arguments), *parts)
                self.assertEqual(os.listdir(self.folder), [])

    def test_an_update_by_two_products_loses_skewness_and_the_one_in_use_does_not(self):
        scene = isosyrk.scene("smooth", n=17)
        h = 0.5 / scene.generator_norms()[0]
        defects = {}
        for name in ("algebra2", "algebra2_two_products", "algebra3", "algebra3_two_products"):
            W, _ = isosyrk.integrator(scene, name).run(scene.initial, h, 100)
            defects[name] = isosyrk.skew_defect(W)
        for name in ("algebra2", "algebra3"):
            self.assertEqual(defects[name], 0)
            self.assertGreater(defects[f"{name}_two_products"], 1e-12)


if __name__ == "__main__":
    unittest.main()
