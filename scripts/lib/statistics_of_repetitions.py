"""Statistics of repeated timings, and the three-way decision between two sets of them.

Timings are few, skewed and sometimes tied, so nothing here assumes a distribution: medians, and an exact
rank test.
"""

import functools
import math
import statistics

LEVEL = 0.01
# Four repetitions a side cannot reach the level: 1/C(8,4) = 0.014; five can: 1/C(10,5) = 0.004.
FEWEST_REPETITIONS = 5

FASTER, SLOWER, UNDECIDED = "faster", "slower", "undecided"

median = statistics.median


@functools.lru_cache(maxsize=None)
def orders(first, second, wrong):
    """Counts the orders of two samples of these sizes in which exactly `wrong` pairs are the wrong way round.

    The last of all is either of the first sample, which puts it behind all of the second, or of the second.
    """
    if wrong < 0 or not first or not second:
        return int(wrong == 0)
    return orders(first - 1, second, wrong - second) + orders(first, second - 1, wrong)


def rank_test(smaller, larger):
    """Returns the exact one-sided Mann–Whitney p for the claim that `smaller` tends to lie below `larger`.

    A tied pair counts against the claim. With ties broken at random the test is exact, and breaking each of
    them against the claim can only raise p: the result is never too favourable.
    """
    wrong = sum(1 for x in smaller for y in larger if x >= y)
    as_good = sum(orders(len(smaller), len(larger), fewer) for fewer in range(wrong + 1))
    return as_good / math.comb(len(smaller) + len(larger), len(smaller))


def compare(first, second):
    """Returns FASTER or SLOWER, as `first` is against `second`, or UNDECIDED where the repetitions do not tell, and p.

    It is the p of the direction in which the ranks lean.
    """
    p_faster, p_slower = rank_test(first, second), rank_test(second, first)
    p = min(p_faster, p_slower)
    if p > LEVEL or min(len(first), len(second)) < FEWEST_REPETITIONS:
        return UNDECIDED, p
    return (FASTER if p_faster < p_slower else SLOWER), p
