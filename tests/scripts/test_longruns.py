"""Tests of how drift is judged, of the symplectic defect, of the study of long runs, and of its report and charts."""

import math
import os
import random
import sys
import unittest

from drawing import DrawingTest, lines_of
from programs import BUILD, HAS_MODULE, MEASURE, FolderTest

from lib.records import formats
from lib.pages.document import as_markdown
from lib.judging.drift import BOUNDED, GROWS, growth_of, judged, trend_of
from lib.records.formats import Study, listed
from studies.longruns.schema import (CLASSES, COSTS, ENERGY, EXPLICIT, EXPLICIT_LIE, EXPONENTIAL, EXPONENTIAL_LOOSE,
                                     GAUSS, GAUSS_LOOSE, PROJECTED, SCHEMA, STRUCTURE, LongRun, Plan, Point, Settings,
                                     class_of, long_runs)
from studies.longruns.report import sections
from studies.longruns.judge import places_of

STUDY = MEASURE, "longruns"
TIMES = [50.0 * k for k in range(1, 201)]  # of 200 windows to T = 1e4


# ---- how drift is judged


def noise(seed, correlation=0.0):
    """Yields standard normal noise, each value with this correlation to the one before."""
    generator = random.Random(seed)
    value = generator.gauss(0, 1)
    while True:
        yield value
        value = correlation * value + math.sqrt(1 - correlation**2) * generator.gauss(0, 1)


def bounded(seed, correlation=0.0, size=1e-6):
    """Returns a series of maxima that fluctuate by a tenth around a size."""
    found = noise(seed, correlation)
    return [(time, size * math.exp(0.1 * next(found))) for time in TIMES]


def means(seed, drift=0.0, size=1e-6):
    """Returns means with their sign, around half the size of bounded(), which drift by a share of it in the run."""
    found = noise(1000 + seed)
    return [(time, size * (0.5 + 0.1 * next(found) + drift * time / TIMES[-1])) for time in TIMES]


def drifting(seed, power, at_the_end=1e-4):
    """Returns maxima around a power of time."""
    return [(time, error * at_the_end / 1e-6 * (time / TIMES[-1])**power) for time, error in bounded(seed)]


def walk(seed, size=1e-6):
    """Returns the largest |x| and the mean of x in each window of 20 steps of a random walk x."""
    generator = random.Random(seed)
    x, series, signed = 0.0, [], []
    for time in TIMES:
        values = []
        for _ in range(20):
            x += size * generator.gauss(0, 1)
            values.append(x)
        series.append((time, max(map(abs, values))))
        signed.append((time, math.fsum(values) / len(values)))
    return series, signed


def shares(judge, seeds=range(100)):
    """Returns the share of each verdict that `judge` finds on seeds."""
    found = [judge(seed).verdict for seed in seeds]
    return {verdict: found.count(verdict) / len(found) for verdict in set(found)}


class Drift(unittest.TestCase):
    def test_bounded_noise_is_bounded_or_undecided_and_never_grows(self):
        self.assertGreater(shares(lambda seed: judged(bounded(seed)))[BOUNDED], 0.9)
        self.assertGreater(shares(lambda seed: judged(bounded(seed), True, means(seed)))[BOUNDED], 0.85)
        self.assertNotIn(GROWS, shares(lambda seed: judged(bounded(seed, 0.8), True, means(seed))))
        inside = [trend.low <= 0 <= trend.high for trend in (trend_of(bounded(seed), 1.0) for seed in range(300))]
        self.assertGreater(inside.count(True) / 300, 0.90)  # 0.95, but for 300 draws and ten blocks
        self.assertLess(inside.count(True) / 300, 0.99)

    def test_a_power_is_found_and_grows(self):
        for power in (0.3, 0.5, 1.0, 2.0):
            with self.subTest(power=power):
                self.assertEqual(shares(lambda seed: judged(drifting(seed, power))), {GROWS: 1.0})
                growth = growth_of(drifting(1, power))
                self.assertAlmostEqual(growth.value, power, delta=0.05)
                self.assertTrue(growth.low < growth.value < growth.high)

    def test_a_random_walk_is_seldom_called_bounded(self):
        # It may stay where it is by chance.
        for found in (shares(lambda seed: judged(walk(seed)[0])), shares(lambda seed: judged(walk(seed)[0], True,
                                                                                             walk(seed)[1]))):
            self.assertLess(found.get(BOUNDED, 0), 0.15)


# ---- a made-up study


INTEGRATORS = {name: listed(name) for name in ("rk4_frame", "rk4_projected_frame", "rkmk4_frame", "elp6_frame",
                                               "group2_frame")}
KINDS = {("rk4_frame", 1e-13): EXPLICIT, ("rk4_projected_frame", 1e-13): PROJECTED,
         ("rkmk4_frame", 1e-13): EXPLICIT_LIE, ("elp6_frame", 1e-8): EXPONENTIAL_LOOSE,
         ("elp6_frame", 1e-13): EXPONENTIAL, ("group2_frame", 1e-13): GAUSS, ("group2_frame", 1e-7): GAUSS_LOOSE}
MADE = {  # method: integrator, tolerance, products a step, energy error C h^p, whether the spectrum is kept
    "rk4": ("rk4_frame", 1e-13, 4, 1e-3, 4, False),
    "rk4_projected": ("rk4_projected_frame", 1e-13, 4, 5e-3, 4, True),
    "rkmk4": ("rkmk4_frame", 1e-13, 20, 1e-2, 4, True),
    "elp6": ("elp6_frame", 1e-8, 30, 1e-6, 6, True),
    "elp6_tight": ("elp6_frame", 1e-13, 60, 1e-6, 6, True),
    "group2": ("group2_frame", 1e-13, 50, 1e-3, 4, True)}
STEPS = (500, 1000, 2000, 4000, 8000)


def made_point(method, steps, scene="smooth", n=33, **changes):
    name, tolerance, products, factor, power, keeps = MADE[method]
    h = 1000 / steps
    error = factor * h**power
    return Point(scene, n, 1000.0, name, tolerance, steps, "converged", products / h, 0.0, 0.0, error,
                 1e-15 if keeps else 5 * error, error)._replace(**changes)


def made_long_run(method, scene="smooth", cost=COSTS[-1], power=0.0, **changes):
    name, tolerance, products, *_ = MADE[method]
    errors = [1e-6 * (time / TIMES[-1])**power * math.exp(0.1 * value)
              for time, value in zip(TIMES, noise(1))] if power else [error for _, error in bounded(1)]
    return LongRun(scene, 33, 1e4, 200, name, tolerance, cost, 10**5, "converged", None, float(cost), 0.0, 1.0,
                   -errors[-1], errors, [-error / 2 for error in errors], [1e-14] * 200)._replace(**changes)


def made_study(points=None, runs=None):
    if points is None:
        points = [made_point(method, steps, scene) for scene in ("smooth", "rough") for method in MADE
                  for steps in STEPS]
    if runs is None:
        runs = [made_long_run(method, scene, power=1.0 if method in ("rk4", "rkmk4") else 0.0)
                for scene in ("smooth", "rough") for method in MADE]
    return Study({"cpu": "a processor"}, Settings(False),
                 {"integrators": list(INTEGRATORS.values()), "plans": [Plan(33, 1000.0, 500, 200, 300.0)],
                  "points": points, "long_runs": runs})


def report_of(study):
    """Returns the report of a Study without charts."""
    return as_markdown(sections(long_runs(study), ()))


def write_longruns(folder, study=None, name="raw.json"):
    """Writes a raw file, by default the made-up one, and returns its path."""
    study, path = study or made_study(), os.path.join(folder, name)
    formats.write_study(path, SCHEMA, study.context, study.settings, study.tables)
    return path


class Files(FolderTest):
    def test_the_verdict_on_the_energy_looks_at_its_sign(self):
        run = made_long_run("group2")
        self.assertEqual(run.judged(ENERGY).verdict, BOUNDED)
        drifts = run._replace(energy_means=[2e-6 * time / 1e4 for time in TIMES])
        self.assertEqual(drifts.judged(ENERGY).verdict, GROWS)

    def test_classes_come_from_what_a_method_keeps(self):
        for (name, tolerance), kind in KINDS.items():
            with self.subTest(name=name, tolerance=tolerance):
                self.assertEqual(class_of(INTEGRATORS[name], tolerance), kind)
        self.assertEqual(set(KINDS.values()), set(CLASSES))
        # Not from its name: one that is said to keep nothing is explicit; an implicit one without structure is none.
        self.assertEqual(class_of(INTEGRATORS["rkmk4_frame"]._replace(isospectral=False), 1e-13), EXPLICIT)
        self.assertIsNone(class_of(listed("direct2"), 1e-13))
        self.assertIsNone(class_of(listed("yoshida4_frame"), 1e-13))

    def test_where_structure_pays(self):
        runs = long_runs(made_study())
        places = {place.error: place for place in places_of(runs, ENERGY) if place.scene == "smooth"}
        self.assertEqual([place.pays for place in places.values()], [False, False, False, False, True, True])
        place = places[1e-8]  # where rk4 does not come to
        self.assertIsNone(place.ratio((EXPLICIT,)))
        self.assertEqual(place.structure.method, "elp6_tight")
        self.assertAlmostEqual(place.structure.products, 60 * 100**(1 / 6))
        place = places[1e-6]
        self.assertAlmostEqual(place.ratio((EXPLICIT,)), 15 / 1000**0.25)
        self.assertEqual(runs.price("smooth", 33, ENERGY, 1e-6, STRUCTURE).products, 60.0)


class Render(DrawingTest):
    def cells(self, study, *start):
        """Returns the rests of the rows of the report that start with some cells."""
        lines = [[cell.strip() for cell in line.strip("|").split("|")]
                 for line in report_of(study).splitlines() if line.startswith("|")]
        return [line[len(start):] for line in lines if line[:len(start)] == list(start)]

    def test_a_failed_run_and_a_drift_are_shown_as_such(self):
        failed = made_long_run("rk4", status="diverged", failed_step=7, energy_change=None, energy_errors=[],
                               energy_means=[], spectrum_errors=[])
        drifts = made_long_run("elp6", energy_means=[-2e-6 * time / 1e4 for time in TIMES])
        study = made_study(runs=[failed, drifts])
        self.assertEqual(self.cells(study, "smooth", "150", "rk4"),
                         [["0.100", "150", "–", "–", "diverged at step 7", "–", "diverged at step 7"]])
        self.assertRegex(self.cells(study, "smooth", "150", "elp6")[0][4], r"^growing, drift -[12]\.\d\d \(-")

    def test_the_title_names_the_least_energy_error_and_the_least_that_is_bounded(self):
        def title(*growing):
            runs = [made_long_run(method, power=1.0 if method in growing else 0.0) for method in ("elp6", "group2")]
            runs[0] = runs[0]._replace(energy_errors=[error / 10 for error in runs[0].energy_errors],
                                       energy_means=[error / 10 for error in runs[0].energy_means])
            ((panel,),) = self.panels("studies.longruns.charts", "energy_against_time",
                                      long_runs(made_study(runs=runs))).values()
            return " ".join(panel.figure.texts[0].get_text().split())

        self.assertRegex(title(), r"the least energy error is \S+ in the smooth scene \(elp6, 1e-8\); the least bounded"
                                  r" one \S+ in the smooth scene \(elp6, 1e-8\)")
        self.assertRegex(title("elp6"), r"least bounded one \S+ in the smooth scene \(group2 \(order 4\)\)")
        self.assertNotIn("bounded", title("elp6", "group2"))

    def test_an_exact_spectrum_is_drawn_at_the_edge_and_a_failed_run_ends_with_a_cross(self):
        errors = [error for _, error in bounded(1)][:45]
        runs = long_runs(made_study([made_point("elp6", 500, spectrum_error=0.0), made_point("elp6", 1000)], [
            made_long_run("group2", status="unstable", failed_step=900, energy_errors=errors, energy_means=errors)]))
        ((panel,),) = self.panels("studies.longruns.charts", "spectrum_against_cost", runs).values()
        self.assertEqual(lines_of(panel)["elp6"][0], [15.0, 1e-16])
        self.assertEqual([text.get_text() for text in panel.texts], ["all others"])
        ((panel,),) = self.panels("studies.longruns.charts", "energy_against_time", runs).values()
        crosses = [line.get_xydata().tolist() for line in panel.lines if line.get_label() == "_failure"]
        self.assertEqual(crosses, [[lines_of(panel)["group2"][-1]]])
        self.assertIn("group2 (order 4) (failed)", [text.get_text() for text in panel.texts])

    def test_lines_alone_have_a_report(self):
        study = made_study(runs=[])
        self.assertNotIn("in long runs", report_of(study))
        self.assertEqual(self.panels("studies.longruns.charts", "energy_against_cost", long_runs(study)).keys(),
                         self.panels("studies.longruns.charts", "energy_against_cost", long_runs(made_study())).keys())
        from studies.longruns import charts as longruns_charts  # only now: it needs matplotlib
        self.assertIsNone(longruns_charts.energy_against_time(long_runs(study)))


# ---- the study itself

if HAS_MODULE:
    sys.path.insert(0, os.path.join(BUILD, "python"))
    import isosyrk
    from studies.longruns import plan as longruns_plan, run as longruns
    import numpy
    from studies.longruns import symplectic_defect
    from studies.longruns.symplectic_defect import derivative, form, random_direction


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class SymplecticDefect(unittest.TestCase):
    def setUp(self):
        self.scene = isosyrk.scene("rough", n=9)
        self.W = self.scene.initial

    def defect(self, map_of):
        return symplectic_defect.symplectic_defect(map_of, self.W)

    def of_method(self, name, h, tolerance=1e-13, solver="published"):
        method = isosyrk.integrator(self.scene, name, solver=solver, tolerance=tolerance)
        return self.defect(lambda W: method.run(W, h, round(1 / h))[0])

    def test_the_form_is_that_of_its_definition(self):
        random = numpy.random.default_rng(3)
        a, b = (random_direction(random, 9) for _ in range(2))
        W = self.W
        expected = numpy.trace(W @ (a @ b - b @ a)).real
        self.assertAlmostEqual(form(W, a @ W - W @ a, b @ W - W @ b), expected, places=13)
        self.assertGreater(abs(expected), 1e-3)

    def test_differences_along_the_orbit_are_derivatives(self):
        a = random_direction(numpy.random.default_rng(4), 9)
        v = a @ self.W - self.W @ a
        found = derivative(lambda W: W @ W @ W, self.W, a)
        expected = v @ self.W @ self.W + self.W @ v @ self.W + self.W @ self.W @ v
        self.assertLess(numpy.linalg.norm(found - expected), 1e-11)

    def test_symplectic_maps_have_none(self):
        U = numpy.linalg.qr(numpy.random.default_rng(5).standard_normal((9, 9)))[0]
        for map_of in (lambda W: W, lambda W: U @ W @ U.T, numpy.conj):
            self.assertLess(self.defect(map_of), 1e-11)

    def test_what_keeps_the_spectrum_alone_has_one(self):
        # The transpose has the same spectrum, and turns the sign of the form.
        self.assertGreater(self.defect(lambda W: W.T.copy()), 0.5)
        # So has exp(s C(W)) W exp(-s C(W)), where C is no gradient, by the size of s.
        C = numpy.diag(1j * numpy.arange(9.0))

        def turned(s):
            def map_of(W):
                angles, vectors = numpy.linalg.eigh(-1j * s * abs(W[0, 0]) * C)
                U = (vectors * numpy.exp(1j * angles)) @ vectors.conj().T
                return U @ W @ U.conj().T
            return map_of

        large, small = self.defect(turned(0.1)), self.defect(turned(0.01))
        self.assertGreater(large, 1e-4)
        self.assertAlmostEqual(large / small, 10, delta=0.5)

    def test_lie_poisson_methods_have_none_and_others_have_their_order(self):
        for name in ("elp4", "group1", "group2", "algebra1"):
            with self.subTest(name=name):
                self.assertLess(self.of_method(name, 0.25), 1e-10)
        for name, order, h in (("rk4", 4, 0.5), ("rk8", 8, 1.0), ("rkmk4", 4, 0.5), ("rk8_projected", 8, 1.0)):
            with self.subTest(name=name):
                coarse, fine = self.of_method(name, h), self.of_method(name, h / 2)
                self.assertGreater(fine, 1e-11)
                self.assertGreater(math.log2(coarse / fine), order - 1.2)
        self.assertGreater(self.of_method("rk4", 0.5), 1e-4)

    def test_a_loose_tolerance_shows(self):
        self.assertGreater(self.of_method("elp4", 0.25, 1e-6, "fast"), 1e-8)

    def test_equal_eigenvalues_part_no_tangent_vectors(self):
        W = numpy.diag([1j, 1j, -2j])
        a = random_direction(numpy.random.default_rng(6), 3)
        v = a @ W - W @ a
        self.assertTrue(math.isfinite(form(W, v, v)))
        self.assertAlmostEqual(form(W, v, v), 0)


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class Runs(FolderTest):
    def test_windows_hold_the_largest_energy_errors_and_their_means(self):
        scene = isosyrk.scene("smooth", n=9)
        energy = scene.energy(scene.initial)
        states = {}
        isosyrk.integrator(scene, "rk4").run(scene.initial, 0.3, 30,
                                             lambda step, W, _: states.update({step: W.copy()}))
        watch = longruns.Watch(scene, 3, 20)
        for step, W in states.items():
            watch(step, W, None)
        changes = [scene.energy(states[step]) / energy - 1 for step in range(1, 31)]
        for window, (error, mean) in enumerate(zip(watch.found["energy_errors"], watch.found["energy_means"])):
            expected = changes[3 * window:3 * window + 3]
            self.assertAlmostEqual(error / max(map(abs, expected)), 1, delta=0.01)  # three digits are written
            self.assertAlmostEqual(mean / (sum(expected) / 3), 1, delta=0.01)
        self.assertEqual(len(watch.found["energy_errors"]), 10)
        self.assertAlmostEqual(watch.found["spectrum_errors"][-1] / isosyrk.spectrum_error(states[30], scene.initial),
                               1, delta=0.01)

    def test_a_lost_energy_ends_a_run(self):
        scene = isosyrk.scene("smooth", n=9)
        for factor, gone in ((1.3, False), (1.5, True), (math.nan, True)):  # energy goes like the square
            watch = longruns.Watch(scene, 1, 20)
            self.assertEqual((watch(1, factor * scene.initial, None), watch.gone), (gone, gone))
        job = longruns_plan.job_of("smooth", 17, longruns_plan.Method(listed("rk4_frame"), 1e-13))
        found = longruns.watched(job, 500.0, 50, 1, 20)  # h = 10
        self.assertNotEqual(found["status"], "converged")
        self.assertLess(found["failed_step"], 50)
        point = longruns.point_of(job, longruns_plan.PLANS[17], 5)
        self.assertEqual((point["energy_error"], point["spectrum_error"], point["symplectic_defect"]), (None,) * 3)
        self.assertNotEqual(point["status"], "converged")

    def test_energies_are_seen_at_the_ends_of_windows_and_often_enough(self):
        for steps in range(1, 1200):
            every = longruns.steps_between_energies(steps, 20)
            self.assertEqual(steps % every, 0)
            self.assertGreaterEqual(steps // every, min(steps, 20))
        self.assertEqual([longruns.steps_between_energies(steps, 20) for steps in (7, 20, 40, 450, 475)],
                         [1, 1, 2, 18, 19])

    def test_how_a_line_ends(self):
        def points(*costs, error=1e-6):
            return [{"status": "converged" if cost else "diverged", "equivalent_products": cost, "energy_error": error,
                     "spectrum_error": 0.0} for cost in costs]

        for costs, ended in (((), False), ((200,), False), ((40, 80), False), ((80, 160), True), ((0, 0, 250), False),
                             ((400, 200), False), ((200, 210), False), ((280, 290), True), ((40, 0), False),
                             ((0,) * 12, True)):
            with self.subTest(costs=costs):
                self.assertEqual(longruns.has_ended(points(*costs), 300), ended)
        self.assertTrue(longruns.has_ended(points(10, error=1e-14), 300))

    def test_steps_at_a_cost(self):
        self.assertAlmostEqual(longruns.steps_at_cost(lambda steps: 4 * steps / 50, 50.0, 50), 625, delta=0.02 * 625)

        # Cheapest at 100 steps, with 80 products: the shorter of two steps that cost 150, and none that costs 50.
        def valley(steps):
            return 40 * (steps / 100 + 100 / steps) if steps > 30 else 0.0

        found = longruns.steps_at_cost(valley, 50.0, 150)
        self.assertAlmostEqual(valley(found) / 150, 1, delta=0.03)
        self.assertGreater(found, 100)
        self.assertIsNone(longruns.steps_at_cost(valley, 50.0, 50))
        # Whole numbers of steps may leave no cost near enough.
        self.assertIsNone(longruns.steps_at_cost(lambda steps: 40.0 * steps, 3.0, 140))
        self.assertEqual(longruns.steps_at_cost(lambda steps: 40.0 * steps, 3.0, 150), 4)

    def test_every_method_has_its_lines(self):
        methods = longruns_plan.methods_of(longruns.built.integrators().values())
        self.assertEqual([method.name for method in methods], [
            "rk4", "rk5", "rk8", "rk10", "abm8", "rk4_projected", "rk8_projected", "rkmk4", "magnus5", "elp2_tight",
            "elp4", "elp4_tight", "elp6", "elp6_tight", "algebra1", "group2", "group2_loose", "group3"])
        jobs = longruns_plan.lines_of(longruns_plan.SIZES, methods)
        places = {(job["scene"], job["n"]) for job in jobs}
        self.assertEqual(places, {*((scene, n) for scene in ("smooth", "rough") for n in (33, 65, 129, 257)),
                                  ("rough", 513)})
        self.assertEqual(jobs[-1]["n"], 513)  # the longest last
        counts = {n: sum(job["n"] == n for job in jobs) for n in longruns_plan.SIZES}
        self.assertEqual(counts, {33: 36, 65: 34, 129: 34, 257: 14, 513: 7})
        for job in jobs:
            integrator = listed(job["integrator"])
            self.assertTrue(integrator.has_fast_form and integrator.co_rotating)
        self.assertEqual({class_of(listed(job["integrator"]), job["tolerance"]) for job in jobs}, set(CLASSES))
        self.assertEqual(len(longruns_plan.long_runs_of(longruns_plan.SIZES, methods)), 40)
        self.assertEqual({job["n"] for job in longruns_plan.long_runs_of((17, 33, 65), methods)}, {33})
        self.assertEqual(longruns_plan.long_runs_of((65,), methods), [])

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
