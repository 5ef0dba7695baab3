"""Verdicts on who is faster, from processes. They are the unit of repetition: what one is given stays for its life.

Memory placement moves the ratio of two rows by some percent from one process to the next, and by a tenth of that within
one. So each process gives one ratio of two rows that it timed interleaved. The figure is the geometric mean of these
ratios, with a 95 % interval by Student's t of their logarithms. Standard library only, as render_table1 is: hence
Student's t here.
"""

import functools
import math
import statistics
from typing import NamedTuple

LEVEL = 0.95  # of the interval
MARGIN = 1.05  # ratios nearer to 1 are a tie
FEWEST, MAXIMUM, MORE = 6, 12, 2  # processes at first and at last, and how many are added while a ratio is undecided

FASTER, SLOWER, TIE, UNDECIDED = "faster", "slower", "tie", "undecided"
HOLDS, FAILS = "holds", "fails"


class Ratio(NamedTuple):
    """A geometric mean of ratios with its interval; without enough processes for one, low is 0 and high infinite."""

    ratio: float
    low: float
    high: float
    processes: int


def ratio_of(times, others):
    """Returns the Ratio of two rows' times, lists with an entry for each process, in the same order of processes."""
    logarithms = [math.log(time / other) for time, other in zip(times, others, strict=True)]
    mean, count = statistics.fmean(logarithms), len(logarithms)
    if count < 2:
        return Ratio(math.exp(mean), 0.0, math.inf, count)
    half = student_t(LEVEL, count - 1) * statistics.stdev(logarithms) / math.sqrt(count)
    return Ratio(math.exp(mean), math.exp(mean - half), math.exp(mean + half), count)


def verdict(found):
    """Says of the Ratio of a row's time to another's if the row is FASTER or SLOWER, if it is a TIE, or UNDECIDED."""
    if found.processes < FEWEST:
        return UNDECIDED
    if found.high < 1 / MARGIN:
        return FASTER
    if found.low > MARGIN:
        return SLOWER
    return TIE if 1 / MARGIN <= found.low and found.high <= MARGIN else UNDECIDED


def compared(times, others):
    """Returns the verdict on a row's times against another's, by process."""
    return verdict(ratio_of(times, others))


def fastest(times):
    """Returns the row whose times, by process, have the least geometric mean. `times` is a dict by row."""
    return min(times, key=lambda row: statistics.geometric_mean(times[row]))


def level_rows(times):
    """Returns the fastest row with every row that ties with it, and the rows not decided against it, as two sets.

    A row with no rival has won nothing.
    """
    if len(times) < 2:
        return set(), set()
    best = fastest(times)
    found = {row: compared(times[row], times[best]) for row in times if row != best}
    return ({best, *(row for row, said in found.items() if said == TIE)},
            {row for row, said in found.items() if said == UNDECIDED})


def more_processes(count, verdicts):
    """Returns how many further processes are wanted after `count` of them, given the verdicts on all pairs."""
    if count < FEWEST:
        return FEWEST - count
    return min(MORE, MAXIMUM - count) if UNDECIDED in verdicts else 0


def further_processes(maximum, seconds, verdicts_on):
    """Returns how many further processes rows want, `most` in all at most, given their seconds by process so far.

    All rows have as many processes; `verdicts_on(seconds)` returns the verdicts that are to be decided.
    """
    done = len(next(iter(seconds.values())))
    return max(0, min(maximum - done, more_processes(done, verdicts_on(seconds) if done >= FEWEST else ())))


# ---- claims


def claim_of_fastest(row, times):
    """Judges "`row` is fastest": its Ratio is that of the fastest other row to it, above 1 where it is faster.

    FAILS if any other is faster; HOLDS if it is faster than all others; TIE if it ties with one.
    """
    rivals = {other: found for other, found in times.items() if other != row}
    said = {compared(times[row], found) for found in rivals.values()}
    result = FAILS if SLOWER in said else HOLDS if said == {FASTER} else TIE if TIE in said else UNDECIDED
    return result, ratio_of(rivals[fastest(rivals)], times[row])


def claim_of_multiple(row, factor, times):
    """Judges "`row` takes more than `factor` times as long as the fastest other row", with the Ratio of the two."""
    rivals = {other: found for other, found in times.items() if other != row}
    found = ratio_of(times[row], rivals[fastest(rivals)])
    if found.processes < FEWEST or found.low <= factor <= found.high:
        return UNDECIDED, found
    return HOLDS if found.low > factor else FAILS, found


# ---- Student's t


@functools.lru_cache(maxsize=None)
def student_t(level, freedom):
    """Returns t with P(|T| < t) = level for Student's T with a whole number of degrees of freedom, by bisection."""
    low, high = 0.0, 1.0
    while within(high, freedom) < level:
        high *= 2
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if within(middle, freedom) < level else (low, middle)
    return high


def within(t, freedom):
    """Returns P(|T| < t). Source: Abramowitz and Stegun, 26.7.3 and 26.7.4."""
    angle = math.atan2(t, math.sqrt(freedom))
    cosine_squared = math.cos(angle)**2
    odd = freedom % 2
    term, total = 1.0, 0.0
    for k in range(freedom // 2):
        total += term
        term *= cosine_squared * (2 * k + 1 + odd) / (2 * k + 2 + odd)
    if odd:
        return 2 / math.pi * (angle + math.sin(angle) * math.cos(angle) * total)
    return math.sin(angle) * total
