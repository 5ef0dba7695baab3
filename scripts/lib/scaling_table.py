"""The raw file of scripts/studies/scaling.py, and its table: what a step costs against n, and what each idea buys."""

from typing import NamedTuple

import study_file
from benchmark_json import UnusableFile
from comparison import MISSING, three_digits, time_with_spread
from document import Column, Entry, Heading, Paragraph, Table, conditions
from study_file import Schema, keyed, list_of, number, one_of, positive, text, whole

PUBLISHED = "published"
# A rung: the solver, and what its fast form goes without.
RUNGS = {
    PUBLISHED: ("published", ()),
    "without any": ("fast", ("bands", "predictor", "newton")),
    "without newton": ("fast", ("newton",)),
    "without predictor": ("fast", ("predictor",)),
    "without bands": ("fast", ("bands",)),
    "fast": ("fast", ()),
}


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
    columns = (Column("n"), Column("integrator", align="left"), Column("form", align="left"), Column("sweeps"),
               Column("equivalent products"), Column("CPU seconds"), Column("times as fast"))
    settings = study.settings
    return [
        Heading("What a step costs", 1),
        Paragraph(f"The first {settings.steps} steps from the initial data of the {settings.scene} scene, h ="
                  f" {settings.step:g}, the same stretch for every row; all figures are those of a step. Without"
                  " newton: plain Picard sweeps. Without predictor: a cold start each step. Without bands: full"
                  " products. Times are medians ± half the interquartile range of repetitions in turns. Times as fast:"
                  " the published form's time over the row's, in the same round. Equivalent products count the"
                  " multiplications in units of one full complex product. No exponents are fitted: a slope against n"
                  " would be one of this stretch, not of the method."),
        Table(columns, [[row(points, name, n, rung) for rung in RUNGS]
                        for name, n in dict.fromkeys((name, n) for name, n, _ in points)]),
        conditions(study.context),
    ]


def row(points, name, n, rung):
    """Returns the row of a rung; one whose steps failed is shown without figures."""
    point, published = points.get((name, n, rung)), points.get((name, n, PUBLISHED))
    texts = [MISSING] * 4
    if point:
        ratios = [theirs / ours for theirs, ours in zip(published.seconds if published else (), point.seconds)]
        texts = [three_digits(point.sweeps), three_digits(point.equivalent_products), time_with_spread(point.seconds),
                 time_with_spread(ratios) if ratios else MISSING]
    return [Entry(each) for each in (str(n), name, rung, *texts)]
