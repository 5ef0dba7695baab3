"""Properties of what is concluded from lines of the study of accuracy: costs, comparisons at equal error, and what is
recommended, for lines that hypothesis draws."""

import itertools
import math
import random
import unittest

from hypothesis import strategies as draw
from properties import SEEDS, decades, holds_for, times_of_rows
from study_documents import INTEGRATORS, accuracy_of, study_document

from studies.accuracy import cheapest as recommendation
from studies.accuracy.schema import ALONE, BELOW, CUT, FLOOR, Comparison, Form, Line, Reference, Run, Settings
from studies.accuracy.lines import FLOOR_MARGIN, ORDER_POINTS, accuracy, compared, fitted_order
from lib.records.settings import LOOSE, TIGHT, Problem, keeping_tolerance, keeps
from studies.accuracy.candidates import CLASSES, MIN_ORDER, members
from studies.accuracy.equal_error import AS_EXPLICIT, beaten_by, cheap_forms, ratio_in
from lib.records.formats import CONVERGED, FAST, Study, listed, listed_integrators
from lib.records.integrators import IMPLICIT_EXPONENTIAL, KEPT, MAGNUS
from studies.accuracy.cheapest import MARGIN, MARGIN_OF_N, Question, Recorded, blend, energy_growth, neighbours
from lib.judging.verdicts import FASTER, SLOWER, TIE, UNDECIDED, compared as compared_times

PROBLEM = Problem("smooth", 5.0, 17)
METHODS = ("rk4_frame", "rkmk4_frame", "elp4_frame", "group2_frame")
ERRORS = decades(-9.0, -1.0)
EVERY = draw.sampled_from([*listed_integrators().values()])


def run(name, steps, error, seconds, status=CONVERGED, beyond=False, problem=PROBLEM):
    usable = status == CONVERGED
    return Run(*problem, name, FAST, steps, TIGHT, status, error if usable else None, None, 1e-15 if usable else None,
               1e-15 if usable else None, 0.1, beyond, 0, 4 * steps, 4.0 * steps, (seconds,) if usable else ())


def study_of(lines, ends=(), uncertainty=1e-14):
    """Returns an Accuracy of lines on one problem, lists of Runs by name."""
    names, ends = dict.fromkeys(lines), dict(ends)
    return accuracy(Study({}, Settings(False), {
        "references": [Reference(*PROBLEM, uncertainty, ["group5", "rkmk4"], [200, 400])], "rates": [],
        "integrators": list(map(listed, names)), "tolerance_runs": [], "comparisons": [],
        "runs": [each for line in lines.values() for each in line],
        "lines": [Line(*PROBLEM, name, TIGHT, ends.get(name, BELOW)) for name in names]}))


def line_by_chance(name, seed):
    """Returns a line with rising steps; some runs fail, some are beyond a limit, and errors mostly fall."""
    chance = random.Random(seed)
    found, steps, error = [], 0, 10.0**chance.uniform(-3, 0)
    for _ in range(chance.randint(1, 8)):
        steps += chance.randint(1, 50)
        error *= 10.0**chance.uniform(-3, 0.5)
        status = "diverged" if chance.random() < 0.15 else CONVERGED
        found.append(run(name, steps, error, 10.0**chance.uniform(-4, 0), status, chance.random() < 0.15))
    return found


def lines_by_chance(seed):
    return {name: line_by_chance(name, seed + place) for place, name in enumerate(METHODS)}


LINES = SEEDS.map(lines_by_chance)


class Costs(unittest.TestCase):
    @holds_for(lines=LINES, error=ERRORS, uncertainty=decades(-14.0, -4.0), examples=150)
    def test_a_cost_is_between_two_neighbours_that_work_and_none_that_reaches_the_error_is_cheaper(self, lines, error,
                                                                                                  uncertainty):
        study = study_of(lines, uncertainty=uncertainty)
        for name in METHODS:
            for beyond in (False, True):
                stretches = study.stretches(PROBLEM, name, beyond=beyond)
                reach = [each for stretch in stretches for each in stretch if each.error <= error]
                cost = study.cost(PROBLEM, name, error, beyond=beyond)
                self.assertEqual(cost is None, not reach)
                if cost is None:
                    continue
                self.assertLessEqual(cost.seconds, min(each.seconds for each in reach) * (1 + 1e-9))
                for each in (cost.coarse, cost.fine):
                    self.assertTrue(each.usable and (beyond or not each.beyond_limit))
                    self.assertGreaterEqual(each.error, FLOOR_MARGIN * uncertainty)
                self.assertLessEqual(cost.fine.error, error)
                ends = sorted((cost.coarse.seconds, cost.fine.seconds))
                self.assertTrue(ends[0] * (1 - 1e-9) <= cost.seconds <= ends[1] * (1 + 1e-9))
                if cost.coarse is not cost.fine:
                    self.assertGreaterEqual(cost.coarse.error, error)
                    line = study.line(PROBLEM, name)
                    self.assertEqual(line.index(cost.fine), line.index(cost.coarse) + 1)

    @holds_for(lines=LINES, error=ERRORS, larger=draw.floats(1.0, 100.0), unit=draw.floats(1e-3, 1e3))
    def test_a_larger_error_costs_no_more_and_units_of_time_do_not_count(self, lines, error, larger, unit):
        study = study_of(lines)
        scaled = study_of({name: [each._replace(cpu_seconds=tuple(unit * time for time in each.cpu_seconds))
                                  for each in line] for name, line in lines.items()})
        for name in METHODS:
            cost, other = (study.cost(PROBLEM, name, each) for each in (error, larger * error))
            if cost:
                self.assertLessEqual(other.seconds, cost.seconds * (1 + 1e-9))
                self.assertAlmostEqual(scaled.cost(PROBLEM, name, error).seconds / (unit * cost.seconds), 1)

    @holds_for(order=draw.floats(1.0, 10.0), factor=decades(-5.0, 0.0), pace=decades(-5.0, -2.0),
               share=draw.floats(0.01, 0.99), place=draw.integers(0, 4),
               noise=draw.lists(decades(-3.0, 0.0), min_size=2, max_size=2))
    def test_powers_are_interpolated_exactly_and_have_the_order_of_the_shortest_steps(self, order, factor, pace, share,
                                                                                      place, noise):
        steps = (5, 10, 20, 40, 80, 160)
        line = [run("rkmk4_frame", each, factor * (5.0 / each)**order, pace * each) for each in steps]
        study = study_of({"rkmk4_frame": line}, uncertainty=1e-40)
        between = steps[place]**(1 - share) * steps[place + 1]**share
        cost = study.cost(PROBLEM, "rkmk4_frame", factor * (5.0 / between)**order)
        self.assertAlmostEqual(cost.seconds / (pace * between), 1)
        self.assertAlmostEqual(cost.step / (5.0 / between), 1)
        first = [each._replace(error=error) for each, error in zip(line, noise)]
        self.assertAlmostEqual(fitted_order([*first, *line[2:]]), order)
        self.assertIsNone(fitted_order(line[:ORDER_POINTS - 1]))

    @holds_for(seconds=draw.lists(decades(-5.0, 2.0), min_size=1, max_size=5))
    def test_of_repetitions_the_least_counts(self, seconds):
        self.assertEqual(run("rk4", 5, 0.1, 1.0)._replace(cpu_seconds=tuple(seconds)).seconds, min(seconds))


ENDS = draw.tuples(*[draw.sampled_from((CUT, FLOOR, BELOW, ALONE))] * len(METHODS))


class EqualError(unittest.TestCase):
    @holds_for(lines=LINES, ends=ENDS, error=ERRORS, within=draw.floats(1.0, 10.0), examples=150)
    def test_nothing_is_compared_where_a_cut_line_may_be_the_cheapest(self, lines, ends, error, within):
        study = study_of(lines, zip(METHODS, ends))
        forms = [Form(name) for name in METHODS]
        costs = {form: cost.seconds for form in forms if (cost := study.cost(PROBLEM, form.integrator, error))}
        minimum = min(costs.values(), default=math.inf)
        unknown = False
        for name, end in zip(METHODS, ends):
            usable = [each for each in lines[name] if each.usable]
            unknown |= end == CUT and not [each for each in usable if each.error <= error or each.seconds >= minimum]
        expected = [] if unknown else sorted((form for form in costs if costs[form] <= within * minimum), key=costs.get)
        self.assertEqual([form for form, _ in cheap_forms(study, PROBLEM, error, forms, within)], expected)

    @holds_for(times=times_of_rows(rows=2, minimum=6), more=draw.integers(0, 6))
    def test_a_comparison_is_by_the_first_processes_that_timed_both(self, times, more):
        row, other = (Comparison(*PROBLEM, 1e-6, "rk4", "rk4_frame", FAST, TIGHT, 9, 1e-7, 0.0, False, 1.0, tuple(each))
                      for each in times)
        ratio, said = compared(row, other)
        self.assertEqual(said, compared_times(*times))
        longer = row._replace(cpu_seconds=(*row.cpu_seconds, *[77.0] * more))
        self.assertEqual((compared(longer, other), ratio.processes), ((ratio, said), len(times[0])))
        comparison = {"explicit": row, "elp": other}
        self.assertEqual(ratio_in(comparison, "explicit", "elp"), (ratio, said))
        mirrored = {FASTER: SLOWER, SLOWER: FASTER, TIE: TIE, UNDECIDED: UNDECIDED}[said]
        self.assertEqual(ratio_in(comparison, "elp", "explicit")[1], mirrored)
        self.assertEqual(beaten_by(comparison), ["elp"] if mirrored == FASTER else [])
        self.assertEqual(beaten_by({"explicit": row, AS_EXPLICIT[1]: other}), [])
        self.assertIsNone(ratio_in(comparison, "elp", "gauss"))


class Structure(unittest.TestCase):
    @holds_for(integrator=EVERY, tolerance=decades(-15.0, -4.0), tighter=draw.floats(0.0, 1.0))
    def test_what_is_kept_is_kept_at_every_tighter_tolerance_with_all_that_is_less(self, integrator, tolerance,
                                                                                   tighter):
        kept = [keeps(integrator, tolerance, structure) for structure in KEPT]
        self.assertEqual(kept, sorted(kept, reverse=True))
        self.assertTrue(kept[0])
        for structure, found in zip(KEPT, kept):
            if found:
                self.assertTrue(keeps(integrator, tighter * tolerance, structure))
                self.assertTrue(integrator.keeps(structure))
            self.assertEqual(keeps(integrator, TIGHT, structure), integrator.keeps(structure))
            best = keeping_tolerance(integrator, structure)
            self.assertTrue(keeps(integrator, best, structure) or not integrator.keeps(structure))
            self.assertIn(best, (TIGHT, LOOSE.get(integrator.family, TIGHT)))
        # Beside the tolerances that methods are run at, what is looser keeps no Poisson structure.
        self.assertFalse(kept[2] and tolerance > TIGHT)

    @holds_for(error=decades(-14.0, 0.0))
    def test_a_class_matches_its_tolerance_to_an_error_only_where_that_makes_another_method(self, error):
        for name, kind in CLASSES.items():
            tolerance = kind.tolerance_for(error)
            if not kind.matched:
                self.assertEqual(tolerance, kind.tolerance)
            elif tolerance is not None:
                self.assertTrue(tolerance > kind.tolerance or error < 10 * kind.tolerance, name)
                self.assertLess(tolerance, error / 10)
            self.assertTrue(tolerance is None or kind.line_tolerance(error) in (kind.line, TIGHT))

    def test_methods_of_a_class_are_in_the_frame_and_of_order_four_or_more(self):
        every = listed_integrators().values()
        found = {name: members(every, name) for name in CLASSES}
        for each in itertools.chain(*found.values()):
            self.assertTrue(each.co_rotating and each.order >= MIN_ORDER)
        self.assertEqual([each.name for each in found["rk4"]], ["rk4_frame"])
        self.assertIn(MIN_ORDER, {each.order for each in found["gauss"]})


class Interpolation(unittest.TestCase):
    @holds_for(values=draw.sets(draw.integers(5, 513), min_size=1, max_size=5), wanted=draw.floats(2.0, 1000.0))
    def test_the_weights_of_neighbours_give_the_wanted_value_back(self, values, wanted):
        weights = neighbours(values, wanted)
        inside = min(max(wanted, min(values)), max(values))
        self.assertAlmostEqual(sum(weights.values()), 1)
        self.assertAlmostEqual(blend(weights.values(), weights) / inside, 1)
        self.assertFalse([each for each in values if min(weights) < each < max(weights)])

    @holds_for(integrator=EVERY, known=draw.floats(1.0, 500.0), time=draw.floats(1.0, 5000.0),
               later=draw.floats(1.0, 4.0))
    def test_the_energy_error_grows_with_time_as_far_as_that_is_known(self, integrator, known, time, later):
        found = energy_growth(integrator, known, time)
        self.assertGreaterEqual(found, 1)
        self.assertLessEqual(found, energy_growth(integrator, known, later * time))
        if time <= known:
            self.assertEqual(found, 1)
        if time > known and (integrator.family == MAGNUS or integrator.projected):
            self.assertEqual(found, math.inf)
        elif time > known >= recommendation.SETTLED and not integrator.lie_poisson:
            self.assertAlmostEqual(found, (time / known)**recommendation.POWER)
        elif time > known and integrator.lie_poisson and integrator.family not in IMPLICIT_EXPONENTIAL:
            # Bounded: it grows while the scene develops, and little after that.
            self.assertLessEqual(found, recommendation.MAX_YOUNG * recommendation.MAX_OLD)
        elif time > known >= recommendation.SETTLED and integrator.family in IMPLICIT_EXPONENTIAL:
            self.assertAlmostEqual(found, recommendation.EXPONENTIAL_OLD * (time / known)**recommendation.POWER)


DOCUMENT = study_document()
STUDY = accuracy_of(DOCUMENT)
MINIMUM = 0.99  # the least of a run's repetitions over its usual time
STRUCTURES = draw.sampled_from(tuple(KEPT))


def best(n, error, keep, time=5.0, limits=None):
    return Recorded(STUDY, Question("smooth", n, time, error, keep), limits).ranking()


class Recommended(unittest.TestCase):
    """In the made-up study errors and seconds of a line are exact powers of the step."""

    @holds_for(n=draw.integers(17, 33), error=decades(-7.0, -1.0), keep=STRUCTURES, larger=draw.floats(1.0, 30.0),
               time=draw.floats(0.5, 5.0), examples=40)
    def test_offers_have_the_error_keep_what_is_asked_for_and_come_by_their_cost(self, n, error, keep, larger, time):
        offers = best(n, error, keep, time)
        self.assertEqual(offers, sorted(offers, key=lambda offer: offer.seconds))
        for offer in offers:
            self.assertTrue(keeps(offer.integrator, offer.tolerance, keep))
            self.assertTrue(0 < offer.error <= error / MARGIN * (1 + 1e-9))
            self.assertAlmostEqual(offer.steps * offer.step, time)
            self.assertLessEqual(offer.step, 1.0 + 1e-9)  # the longest that was run
        looser = best(n, larger * error, keep, time)
        if offers:
            self.assertLessEqual(looser[0].seconds, offers[0].seconds * (1 + 1e-9))
            # What keeps nothing costs no more.
            self.assertLessEqual(best(n, error, "nothing", time)[0].seconds, offers[0].seconds * (1 + 1e-9))

    @holds_for(name=draw.sampled_from(("rkmk4", "group1", "group2", "cotangent1")), error=decades(-6.0, -3.0))
    def test_a_step_that_fits_into_the_time_has_error_and_seconds_of_its_own_size(self, name, error):
        offer = Recorded(STUDY, Question("smooth", 17, 5.0, error, "nothing")).offer(Form(name))
        factor, seconds_a_step = INTEGRATORS[name]
        order = listed(name).order
        wanted = (error / MARGIN / factor) ** (1 / order)
        if offer is None or wanted > 0.9 or wanted < 0.026:
            return
        self.assertEqual(offer.steps, math.ceil(5.0 / wanted * (1 - 1e-9)))
        self.assertAlmostEqual(offer.error / (factor * offer.step**order), 1, 6)
        self.assertAlmostEqual(offer.seconds / (MINIMUM * seconds_a_step * offer.steps), 1, 6)

    @holds_for(n=draw.integers(18, 32), error=decades(-6.0, -3.0), time=draw.floats(0.5, 4.9))
    def test_margins_for_n_and_for_errors_add_up(self, n, error, time):
        found = Recorded(STUDY, Question("smooth", n, 5.0, error, "spectrum"))
        self.assertAlmostEqual(found.margin, MARGIN * MARGIN_OF_N)
        both = Recorded(STUDY, Question("smooth", n, time, error, "spectrum"))
        self.assertAlmostEqual(both.margin, MARGIN * MARGIN_OF_N * recommendation.MARGIN_OF_TIME)
        # A time share of the shortest recorded one has that share of the error.
        (line,) = (line for form, (line, *_) in both.lines.items() if form == Form("rkmk4"))
        (recorded,) = (line for form, (line, *_) in found.lines.items() if form == Form("rkmk4"))
        uncertainty = 1e-14
        for one, whole in zip(line, recorded):
            self.assertAlmostEqual((one.error - uncertainty) / (whole.error - uncertainty), time / 5.0, 4)
            self.assertGreater(one.error, uncertainty)

    @holds_for(uncertainty=decades(-8.0, -4.0), keep=STRUCTURES)
    def test_what_the_reference_may_be_off_by_is_added_to_every_error(self, uncertainty, keep):
        found = []
        for each in (0.0, uncertainty):
            references = {problem: row._replace(uncertainty=each) for problem, row in STUDY.references.items()}
            recorded = Recorded(STUDY._replace(references=references), Question("smooth", 17, 5.0, 1e-2, keep))
            found.append({form: [run.error for run in line] for form, (line, *_) in recorded.lines.items()})
        exact, blurred = found
        for form, errors in exact.items():
            for one, other in zip(errors, blurred[form]):
                self.assertAlmostEqual((other - one) / uncertainty, 1, 6)

    @holds_for(rate=decades(3.0, 9.0), error=decades(-5.0, -2.0), n=draw.sampled_from((17, 33)), examples=20)
    def test_seconds_here_are_those_recorded_over_the_speed_up(self, rate, error, n):
        question = Question("smooth", n, 5.0, error, "spectrum")
        found = recommendation.answer(STUDY, question, "raw", lambda sizes: [rate] * len(sizes))
        faster = rate / STUDY.rates[n].fast
        self.assertAlmostEqual((found["seconds"] - recommendation.COLD) * faster / found["seconds_recorded"], 1)

    @holds_for(cut=draw.sets(draw.sampled_from((17, 33)), min_size=1), error=decades(-5.0, -4.0), examples=10)
    def test_a_line_that_was_cut_at_one_n_is_told_between_two(self, cut, error):
        document = study_document()
        for table in ("runs", "lines"):
            document[table] = [row for row in document[table] if not (
                row["integrator"] == "cotangent1" and row["n"] in cut and row.get("steps", 0) > 5)]
        found = Recorded(accuracy_of(document), Question("smooth", 24, 5.0, error, "poisson"))
        self.assertIn("not known whether cotangent1", " ".join(found.statements))

    @holds_for(maximum=draw.floats(0.1, 3.0), n=draw.integers(17, 33), time=draw.sampled_from((5.0, 6.0)),
               error=decades(-3.0, 0.0), examples=30)
    def test_no_step_is_longer_than_what_survived_unless_it_was_run_as_long_at_this_n(self, maximum, n, time, error):
        class Limits:
            @staticmethod
            def survived_around(*_):
                return maximum

        offers = best(n, error, "spectrum", time, Limits)
        longest = 1.4 * n / 17  # h‖B(W₀)‖₂ of h = 1
        for offer in offers:
            if n in (17, 33) and time == 5.0:
                continue  # it worked there
            self.assertLessEqual(offer.step * longest, maximum * (1 + 1e-6))


if __name__ == "__main__":
    unittest.main()
