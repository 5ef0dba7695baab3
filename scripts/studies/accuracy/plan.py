"""What the study `accuracy` runs: methods on each problem, their steps, and where a line ends."""

import math

from lib.records.formats import FAST
from lib.records.integrators import GAUSS, TABLE1_CELLS, is_fastest_formulation, is_new
from lib.records.settings import TABLE1_STEP
from lib.running import built
from studies.accuracy.candidates import CLASSES, all_forms, members
from studies.accuracy.judge import told_against_n
from studies.accuracy.lines import FLOOR_MARGIN, is_floor
from studies.accuracy.schema import BELOW, FLOOR, GOOD_ENOUGH, Form

# On the main problem, every integrator has a line up to this n, and up to the next one the cells of Table 1 and the
# methods whose errors at its step are told; at larger n these run with Table 1's step alone.
LARGEST_OF_ALL, LARGEST_OF_TABLE1 = 33, 65
QUICK_ORDER, QUICK_ORDER_IN_FRAME = 4, 8  # of the quick study's methods, or as near as there are
# Steps to T = 5: about a factor 1.6 apart, with Table 1's 50 among them.
UNIT = 5.0
STEPS = (2, 3, 5, 8, 12, 20, 32, 50, 80, 125, 200, 320, 500, 800, 1250, 2000, 3200, 5000)
# Where a line takes long, at n = 257 and to T = 50, a factor of 2 must do; so it must in the quick study.
COARSE_STEPS = (3, 6, 12, 25, 50, 100, 200, 400, 800, 1600, 3200, 6400)
# A line is cut by the first run, of Table 1's step or a shorter one, that takes so much work: floating-point operations
# of its products. A core does some 5e10 to 1.2e11 a second.
ENOUGH_WORK = ((33, 5e9), (65, 15e9), (129, 40e9), (math.inf, 80e9))  # by the largest n, to T = 5 in the frame
LONG_TIMES, PLAIN_TIMES, QUICK_TIMES = 4, 0.3, 0.25  # times that: to T = 50, out of the frame, in the quick study


def steps_of(job):
    """Returns the numbers of steps to T = 5 that a line is tried with."""
    if job["table1_step"]:
        return (round(UNIT / TABLE1_STEP),)
    return COARSE_STEPS if job["n"] > 129 or job["time"] > UNIT or job["quick"] else STEPS


def end_of(runs, uncertainty, order):
    """Returns how a line has ended with the last of its usable runs, or None if it goes on."""
    if runs[-1].error < FLOOR_MARGIN * uncertainty or (len(runs) > 1 and is_floor(*runs[-2:], order)):
        return FLOOR
    return BELOW if runs[-1].error < GOOD_ENOUGH else None


def took_enough(run, quick):
    """Tells whether a run took the work that cuts a line."""
    enough = next(work for largest, work in ENOUGH_WORK if run.n <= largest)
    co_rotating = built.integrators()[run.integrator].co_rotating
    for holds, times in ((run.time > UNIT, LONG_TIMES), (not co_rotating, PLAIN_TIMES), (quick, QUICK_TIMES)):
        enough *= times if holds else 1
    return 8 * run.n**3 * run.equivalent_products >= enough


def quick_integrators(listed):
    """Returns all that the quick study has of some Integrators.

    These are the cells of Table 1, one of each family that has fast forms, one in the co-rotating frame for each class
    of comparisons, and every new one.
    """
    families = {}
    for each in listed:
        if each.has_fast_form and not each.co_rotating:
            families.setdefault((each.family, each.projected), []).append(each)
    kept = [nearest(QUICK_ORDER, found) for found in families.values()]
    for candidate in CLASSES:
        if found := members(listed, candidate, FAST):
            kept.append(nearest(QUICK_ORDER_IN_FRAME, found))
    return [each for each in listed if each.name in TABLE1_CELLS or each in kept or is_new(each)]


def nearest(order, listed):
    """Returns the first of the Integrators whose order is the nearest."""
    return min(listed, key=lambda each: abs(each.order - order))


def is_order_two(entry):
    """Tells whether it is the fastest Gauss method of order 2: claims on orders need it on every problem."""
    return entry.co_rotating and (entry.family, entry.order) == (GAUSS, 2) and is_fastest_formulation(entry)


def is_main(problem):
    return (problem.scene, problem.time) == ("smooth", UNIT)


def lines_of(problem, entries, asked):
    """Returns the Forms of the lines of a problem, and those of them that run with Table 1's step alone.

    Those of a class of comparisons by their fast form have a line on every problem, others on the main problem only,
    unless they were asked for.
    """
    forms = all_forms(entry for entry in entries if entry.has_fast_form)
    forms += [Form(entry.name) for entry in entries if is_order_two(entry)]
    alone, against_n = [], told_against_n(entries)
    for entry in entries if asked or is_main(problem) else ():
        told = entry.name in against_n
        if asked or problem.n <= LARGEST_OF_ALL or (problem.n <= LARGEST_OF_TABLE1
                                                    and (told or entry.name in TABLE1_CELLS)):
            forms.append(Form(entry.name))
        elif told and Form(entry.name) not in forms:
            alone.append(Form(entry.name))
    return list(dict.fromkeys([*forms, *alone])), alone
