"""Properties of what is read from raw files and told of them: limits, prices, costs, ensembles, threads and claims, for
values that hypothesis draws."""

import math
import random
import unittest

import numpy
from hypothesis import strategies as draw
from properties import NEAR_ONE, SEEDS, decades, holds_for, times_of_rows

from studies.turbulence import against_reference
from studies.turbulence import judge as turbulence_judge
from studies.claims.judge import cheapest_settings, competitive, order_finding
from lib.records.formats import CONVERGED, FAST, FORMULATIONS, Study, listed
from lib.records.formats import CONVERGED as WORKS
from studies.limits.schema import LETTERS, Limit, Line, State, Survived, limits_of
from studies.limits.judge import figures as limits_figures
from studies.longruns.schema import COST_MARGIN, ENERGY, LOST, QUANTITIES, price_on
from studies.longruns.judge import defect_at
from studies.scaling.schema import Scaling
from studies.theorem.schema import Coincidence
from studies.theorem import judge as theorem_judge
from studies.threads.schema import Settings, Threads
from studies.turbulence.statistics import MIN_SPREAD, Reference, Spreads, drifts_of
from lib.judging.verdicts import (FAILS, FASTER, FEWEST, HOLDS, MARGIN, SLOWER, TIE, UNDECIDED, compared, fastest,
                                  ratio_of)
from limits_documents import limits_study
from scaling_documents import point
from test_longruns import made_long_run, made_point
from threads_documents import run as of_threads

LETTER = LETTERS[WORKS]
STEPS = draw.floats(0.1, 10.0)  # h‖B‖₂


class Limits(unittest.TestCase):
    @holds_for(grid=draw.lists(draw.sampled_from("+ds"), min_size=1, max_size=12).map("".join))
    def test_an_island_is_a_step_that_works_beyond_one_that_does_not(self, grid):
        limit = Limit(FAST, "smooth", 9, "rk4", 0, 0.5, grid, None, None, None)
        outcomes = [outcome == WORKS for _, outcome in limit.trials(2**0.5)]
        self.assertEqual(limit.has_island, any(works for works in outcomes[outcomes.index(False):])
                         if False in outcomes else False)

    @holds_for(works=draw.dictionaries(draw.sampled_from((9, 17, 33, 65)), draw.tuples(STEPS, STEPS), min_size=1),
               n=draw.integers(5, 100))
    def test_no_step_is_told_that_did_not_survive_at_a_recorded_n_beside_or_from_a_drawn_state(self, works, n):
        made = limits_study()
        limits = [Limit(FAST, "smooth", at, "rk4", state, 0.5, "+d", step, 1.03 * step, "diverged")
                  for at, (own, drawn) in works.items() for state, step in enumerate((own, drawn))]
        survived = [Survived(FAST, "smooth", at, "rk4", own, 1.1 * own, "diverged", 0.0)
                    for at, (own, _) in works.items()]
        found = limits_of(Study({}, made.settings, {
            "integrators": [listed("rk4")], "limits": limits, "survived": survived, "theory": [],
            "states": [State("smooth", at, state, 1.0, 2.0) for at in works for state in (0, 1)]}))
        held = {at: min(pair) for at, pair in works.items()}
        around = found.survived_around(FAST, "smooth", n, "rk4")
        beside = [held[at] for at in (max((at for at in held if at <= n), default=None),
                                      min((at for at in held if at >= n), default=None)) if at]
        self.assertEqual(around, min(beside))
        self.assertIsNone(found.survived_around(FAST, "rough", n, "rk4"))
        self.assertEqual(found.min_survived(), {("rk4", FAST, at): held[at] for at in sorted(held)})
        for at, (own, drawn) in works.items():
            self.assertEqual(found.own(FAST, "smooth", at, "rk4"), own)
            line = found.lines[FAST, "smooth", at, "rk4"]
            self.assertEqual((line.minimum, line.largest), (min(own, drawn), max(own, drawn)))

    @holds_for(works=draw.lists(STEPS, min_size=2, max_size=4), share=draw.floats(0.5, 1.0))
    def test_counts_of_limits_below_and_within_others(self, works, share):
        made = limits_study()
        limits = [Limit(FAST, "smooth", 9, "rk4", state, 0.5, "+d", step, 1.03 * step, "diverged")
                  for state, step in enumerate(works)]
        survived = Survived(FAST, "smooth", 9, "rk4", share * works[0], 1.1 * share * works[0], "diverged", 0.0)
        found = limits_figures(limits_of(Study({}, made.settings, {
            "integrators": [listed("rk4")], "limits": limits, "survived": [survived], "theory": [],
            "states": [State("smooth", 9, state, 1.0, 2.0) for state in range(len(works))]})))
        self.assertEqual(found["survived_below_critical"], 1.1 * share <= 1)  # not within what bisection leaves open
        own, *drawn = works
        self.assertEqual(found["own_state_within_drawn"], min(drawn) <= 1.03 * own and 1.03 * max(drawn) >= own)
        self.assertAlmostEqual(found["spread.largest"], max(works) / min(works))

    def test_lines_without_a_limit_have_none(self):
        line = Line((Limit(FAST, "smooth", 9, "rk4", 0, 0.5, "dd", None, None, None),))
        self.assertEqual((line.minimum, line.largest, line.has_island), (None, None, False))


def line_by_chance(seed):
    """Returns a line of long runs, with more and more steps; some failed or lost energy or spectrum."""
    chance = random.Random(seed)
    found = []
    for place in range(chance.randint(1, 6)):
        energy, spectrum = (10.0**chance.uniform(-9, 0) for _ in range(2))
        good = chance.random() > 0.2
        found.append(made_point("rk4", 500 * 2**place, equivalent_products=10.0**chance.uniform(0, 3),
                                status=CONVERGED if good else "diverged", energy_error=energy if good else None,
                                spectrum_error=spectrum if good else None,
                                symplectic_defect=10.0**chance.uniform(-9, 0) if good else None))
    return found


LINES = SEEDS.map(line_by_chance)


class LongRuns(unittest.TestCase):
    @holds_for(line=LINES, error=decades(-9.0, -1.0), larger=draw.floats(1.0, 30.0))
    def test_a_price_is_of_runs_that_keep_energy_and_spectrum_and_falls_with_the_error(self, line, error, larger):
        for quantity in QUANTITIES:
            price = price_on(line, quantity, error, "rk4")
            usable = [each for each in line if each.status == CONVERGED
                      and max(each.energy_error, each.spectrum_error) < LOST]
            good = [each.equivalent_products for each in usable if each.error(quantity) <= error]
            self.assertEqual(price is None, not good)
            if price:
                self.assertLessEqual(price.products, min(good))
                self.assertGreaterEqual(price.products * (1 + 1e-12), min(each.equivalent_products for each in usable))
                other = price_on(line, quantity, larger * error, "rk4")
                self.assertLessEqual(other.products, price.products * (1 + 1e-9))

    @holds_for(power=draw.floats(1.0, 8.0), place=draw.floats(0.01, 4.99))
    def test_a_price_is_exact_on_powers(self, power, place):
        line = [made_point("rk4", 500 * 2**k, equivalent_products=3.0 * 2**k, energy_error=1e-2 * 2.0**(-power * k),
                           spectrum_error=1e-15) for k in range(6)]
        price = price_on(line, ENERGY, 1e-2 * 2.0**(-power * place), "rk4")
        self.assertAlmostEqual(price.products / (3.0 * 2**place), 1)
        self.assertFalse(price.at_most)

    @holds_for(line=LINES, products=decades(0.0, 3.0))
    def test_of_several_steps_at_a_cost_the_defect_is_that_of_the_shortest(self, line, products):
        points = [each for each in line if each.symplectic_defect]
        rising = [(coarse, fine) for coarse, fine in zip(points, points[1:])
                  if coarse.equivalent_products <= products <= fine.equivalent_products
                  and coarse.equivalent_products < fine.equivalent_products]
        found = defect_at(line, products)
        self.assertEqual(found is None, not rising)
        if rising:
            ends = sorted(each.symplectic_defect for each in rising[-1])
            self.assertTrue(ends[0] * (1 - 1e-9) <= found <= ends[1] * (1 + 1e-9))

    @holds_for(defects=draw.lists(decades(-9.0, -1.0), min_size=4, max_size=4), products=draw.floats(2.1, 3.9))
    def test_a_cost_of_two_stretches_is_taken_of_the_later_one(self, defects, products):
        line = [made_point("rk4", 500 * 2**place, equivalent_products=cost, symplectic_defect=each)
                for place, (cost, each) in enumerate(zip((1.0, 4.0, 2.0, 8.0), defects))]
        self.assertAlmostEqual(defect_at(line, products) / defect_at(line[2:], products), 1)
        same = math.isclose(defect_at(line[:2], products), defect_at(line[2:], products))
        self.assertEqual(math.isclose(defect_at(line, products), defect_at(line[:2], products)), same)

    @holds_for(share=draw.floats(-0.3, 0.3))
    def test_a_run_off_its_cost_is_so_whichever_way(self, share):
        run = made_long_run("rk4", cost=150, equivalent_products=150.0 * (1 + share))
        if abs(abs(share) - COST_MARGIN) > 1e-9:
            self.assertEqual(run.at_cost, abs(share) < COST_MARGIN)


class Turbulence(unittest.TestCase):
    @holds_for(worst=draw.tuples(draw.floats(0.0, 0.03), draw.floats(0.0, 0.03)))
    def test_a_setting_conserves_if_energy_and_enstrophy_do(self, worst):
        found = against_reference.Judged(None, None, 1.0, worst=dict(zip(against_reference.INVARIANTS, worst)))
        self.assertEqual(found.conserves, all(each <= against_reference.TOLERANCE for each in worst))
        self.assertFalse(against_reference.Judged(None, None, 1.0).conserves)

    @holds_for(low=draw.floats(0.3, 1.2), width=draw.floats(0.0, 1.0))
    def test_references_are_independent_by_the_lower_end_of_their_spread(self, low, width):
        spreads = Spreads(*(numpy.array([1.0, each]) for each in (low + width / 2, low, low + width)))
        self.assertEqual(spreads.are_independent, low >= MIN_SPREAD)

    @holds_for(seed=SEEDS, shift=draw.floats(-3.0, 3.0), unit=draw.floats(0.1, 10.0), ensembles=draw.integers(3, 8))
    def test_scores_do_not_depend_on_units_and_origins_and_turn_with_the_sign(self, seed, shift, unit, ensembles):
        rng = numpy.random.default_rng(seed)
        means, own, deviations = rng.standard_normal((6, 4)), rng.standard_normal((6, 4)), rng.uniform(0.5, 2, 4)
        found = Reference(means, deviations, ensembles, 1.0)
        other = Reference(unit * means + shift, unit * deviations, ensembles, 1.0)
        numpy.testing.assert_allclose(other.scores(unit * own + shift), found.scores(own), rtol=1e-9, atol=1e-12)
        turned = Reference(-means, deviations, ensembles, 1.0)
        numpy.testing.assert_allclose(turned.scores(-own), -found.scores(own), rtol=1e-12)
        self.assertAlmostEqual(turned.distance(-own), found.distance(own))
        # More reference ensembles leave less to chance.
        self.assertLess(found.distance(own), found._replace(ensembles=ensembles + 1).distance(own))

    @holds_for(bands=draw.integers(1, 6), seed=SEEDS, examples=20)
    def test_a_change_of_energy_is_judged_over_all_bands(self, bands, seed):
        rng = numpy.random.default_rng(seed)
        energies = numpy.exp(0.1 * rng.standard_normal((8, 5, 4, bands)))
        found = drifts_of(energies)
        self.assertEqual({each.critical for each in found}, {found[0].critical})
        one, more = drifts_of(energies[..., :1])[0].critical, found[0].critical
        self.assertTrue(more > one if bands > 1 else more == one)
        self.assertEqual([each.is_stationary for each in found], [abs(each.score) <= more for each in found])
        backwards = drifts_of(energies[:, :, ::-1])
        for each, turned in zip(found, backwards):
            self.assertAlmostEqual(each.score, -turned.score)


FORMS = draw.sampled_from(FORMULATIONS)


class Speed(unittest.TestCase):
    @holds_for(times=times_of_rows(rows=3, minimum=1))
    def test_algebra_is_competitive_if_it_is_faster_than_the_fastest_other_or_ties(self, times):
        rows = dict(zip(("cotangent", "group", "algebra"), times))
        others = {name: each for name, each in rows.items() if name != "algebra"}
        said = compared(rows["algebra"], others[fastest(others)])
        result, ratio = competitive(rows)
        if said == UNDECIDED and ratio.processes >= FEWEST and ratio.low >= 1 / MARGIN:
            said = TIE  # or faster
        self.assertEqual(result, {FASTER: HOLDS, TIE: HOLDS, SLOWER: FAILS, UNDECIDED: UNDECIDED}[said])
        self.assertEqual(ratio, min((ratio_of(each, rows["algebra"]) for each in others.values()),
                                    key=lambda each: each.ratio))

    @holds_for(settings=draw.lists(draw.tuples(
        draw.sampled_from((17, 33)), draw.sampled_from(("algebra1", "group2", "group3", "rk4", "elp4")),
        draw.booleans(), draw.one_of(draw.none(), draw.floats(0.1, 3.0))), max_size=8))
    def test_the_cheapest_in_turbulence_are_faithful_and_one_a_method(self, settings):
        results = [turbulence_judge.SettingResult(
            n, name, listed(name).order, listed(name).family, "nothing", 0.1, 1e-8, name == "algebra1", 0, 0, None,
            None, 1.0, faithful, over_baseline=cost) for n, name, faithful, cost in settings]
        found = cheapest_settings(turbulence_judge.Findings([], [], results, []), 33)
        costs = {}
        for n, name, faithful, cost in settings:
            if n == 33 and faithful and cost:
                costs[name] = min(cost, costs.get(name, cost))
        self.assertEqual({each.integrator: each.over_baseline for each in found}, costs)
        self.assertEqual(len(found), len(costs))
        if found:
            best = order_finding(33, found, len(found))
            self.assertEqual(costs[best.where.split("(")[1].rstrip(")")], min(costs.values()))

    @holds_for(times=times_of_rows(rows=3, minimum=2), numbers=draw.sampled_from(((1, 2, 4), (1, 3, 8), (1, 2, 16))))
    def test_threads_are_judged_against_the_next_smaller_number_and_their_gain_against_one(self, times, numbers):
        runs = [of_threads(number, noise=each, seconds=1.0) for number, each in zip(numbers, times)]
        runs = [each._replace(**{name: tuple(getattr(each, name)) for name in ("seconds", "same")}) for each in runs]
        found = Threads(Study({}, Settings("rough", 16), {"integrators": [listed("elp4_frame")], "runs": runs}))
        one, two, three = runs
        self.assertEqual([found.than_fewer(each) for each in runs],
                         [None, compared(two.seconds, one.seconds), compared(three.seconds, two.seconds)])
        for each in runs:
            self.assertEqual(found.gain(each), ratio_of(one.seconds, each.seconds))

    @holds_for(same=draw.lists(draw.booleans(), min_size=6, max_size=6))
    def test_other_bits_in_any_process_are_other_bits(self, same):
        found = Threads(Study({}, Settings("rough", 2), {"integrators": [listed("elp4_frame")],
                                                        "runs": [of_threads(), of_threads(2, same=same)]}))
        self.assertEqual(len(found.different()), not all(same))

    @holds_for(ratios=draw.lists(NEAR_ONE, min_size=3, max_size=5), seed=SEEDS)
    def test_gains_of_ablations_are_within_a_round_and_over_the_fast_form(self, ratios, seed):
        noise = random.Random(seed)
        paces = [noise.uniform(1e-6, 1e-3) for _ in ratios]
        points = [point(ablation="fast", seconds=paces),
                  point(ablation="published", seconds=[pace * ratio for pace, ratio in zip(paces, ratios)])]
        found = Scaling(Study({}, None, {"points": points, "integrators": [listed("group2")], "rates": [], "memory": [],
                                         "threads": []}))
        for each, ratio in zip(found.ratios(5.0, 17, "group2", "published"), ratios, strict=True):
            self.assertAlmostEqual(each, ratio)
        self.assertAlmostEqual(found.gain(5.0, 17, "published", ["group2"]), sorted(ratios)[len(ratios) // 2]
                               if len(ratios) % 2 else sum(sorted(ratios)[len(ratios) // 2 - 1:][:2]) / 2)


class Theorem(unittest.TestCase):
    @holds_for(shares=draw.lists(draw.floats(0.01, 2.0), min_size=1, max_size=5))
    def test_settings_within_their_bound_are_counted(self, shares):
        rows = [Coincidence("rigid_body", 6, place + 1, 0.1, share * 1e-12, 1e-16, 1e-15, (9.0, 9.0, None), 1e-12)
                for place, share in enumerate(shares)]
        study = Study({}, None, {"coincidence": rows, "ends": [], "cost": [], "dirk": []})
        found = theorem_judge.figures(theorem_judge.findings(study))
        self.assertEqual((found["coincidence.settings"], found["coincidence.within"], found["coincidence.failed"]),
                         (len(shares), sum(share <= 1 for share in shares), len(shares)))


if __name__ == "__main__":
    unittest.main()
