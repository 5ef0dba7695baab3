"""The raw file of scripts/studies/scaling.py, and its table: what a step costs, and what each idea buys."""

from typing import NamedTuple

import study_file
from benchmark_json import UnusableFile
from comparison import MISSING, three_digits, time_with_spread
from document import Column, Entry, Heading, Paragraph, Table, conditions
from study_file import Schema, keyed, list_of, number, one_of, positive, text, whole

PUBLISHED, FAST = "published", "fast"
# A rung: the solver, and what its fast form goes without.
RUNGS = {
    PUBLISHED: (PUBLISHED, ()),
    "without any": (FAST, ("bands", "predictor", "newton")),
    "without newton": (FAST, ("newton",)),
    "without predictor": (FAST, ("predictor",)),
    "without bands": (FAST, ("bands",)),
    FAST: (FAST, ()),
}
NEEDS_ITERATION = {"newton", "predictor"}  # ideas that explicit methods have no use for


class Settings(NamedTuple):
    scene: text
    step: positive
    steps: whole(1)  # of the stretch that is timed, from the initial data


class Point(NamedTuple):
    """A rung of an integrator at one n; all costs are those of a step."""

    integrator: text
    n: whole(2)
    rung: one_of(*RUNGS)
    sweeps: number
    equivalent_products: number
    seconds: list_of(positive)  # CPU time, one for each repetition


SCHEMA = Schema("scaling", Settings, {"points": Point})


def document(path):
    """Returns the document of a raw file. Throws UnusableFile with one line that names the file and what is wrong."""
    return study_file.read(path, SCHEMA, sections)


def sections(study):
    points = keyed(study.tables["points"], "integrator", "n", "rung")
    if not points or not all(point.seconds for point in points.values()):
        raise UnusableFile("has no points, or one without a time")
    columns = (Column("n"), Column("integrator", align="left"), Column("sweeps"), Column("equivalent products"),
               Column("CPU seconds"), *(Column(rung, "time over that of the fast form") for rung in RUNGS if rung != FAST))
    settings = study.settings
    sizes = dict.fromkeys(n for _, n, _ in points)
    return [
        Heading("What a step costs, and what each idea buys", 1),
        Paragraph(f"The first {settings.steps} steps from the initial data of the {settings.scene} scene, h ="
                  f" {settings.step:g}, the same stretch everywhere; all figures are those of a step, and sweeps, products"
                  " and CPU seconds those of the fast form. Equivalent products: multiplications in units of one full"
                  " complex product. Without newton: plain Picard sweeps. Without predictor: a cold start each step."
                  " Without bands: full products. Without any: split-complex storage, its products, triangles and"
                  " single precision of late terms are left. Below 1 an idea does not pay in these steps. Medians ± half"
                  " the interquartile range of repetitions in turns, ratios within the same round. – stands for steps"
                  " that fail, and for ideas that an explicit method has no use for."),
        Table(columns, [[row(points, name, n) for name in dict.fromkeys(name for name, size, _ in points if size == n)]
                        for n in sizes]),
        conditions(study.context),
    ]


def row(points, name, n):
    """Returns the row of an integrator at one n; what failed is shown without figures."""
    fast = points.get((name, n, FAST))

    def ratio(rung):
        other = points.get((name, n, rung))
        if not (fast and other):
            return MISSING
        return time_with_spread([theirs / ours for theirs, ours in zip(other.seconds, fast.seconds)])

    texts = ([three_digits(fast.sweeps), three_digits(fast.equivalent_products), time_with_spread(fast.seconds)]
             if fast else [MISSING] * 3)
    return [Entry(each) for each in (str(n), name, *texts, *(ratio(rung) for rung in RUNGS if rung != FAST))]
