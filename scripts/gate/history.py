"""The line that a run of the gate leaves in a history: head's time over base's in each cell that was timed."""

import statistics

from lib.judging.verdicts import ratio_of
from lib.records.history import GATE, line_of
from gate.cells import in_words
from gate.timing import PAIRS


def line_of_run(head, timing):
    """Returns the Line of head's Build and its timing Layer, whose unit of repetition is the launch."""
    return line_of(GATE, head.context, in_words(head.rounding), [
        (f"head over base, {cell}", ratio_of(launches, [1.0] * len(launches)))
        for cell, launches in ((cell, by_launch(ratios)) for cell, ratios in timing.pairs.items())])


def by_launch(ratios):
    """Returns the geometric mean of the pairs of each launch."""
    return [statistics.geometric_mean(ratios[place:place + PAIRS]) for place in range(0, len(ratios), PAIRS)]
