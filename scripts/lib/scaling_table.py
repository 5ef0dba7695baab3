"""The raw file of scripts/studies/scaling.py, and its table: what a step costs, and what each idea buys."""

import statistics
from typing import NamedTuple

from lib import formats
from lib.formats import FAST, FORMULATIONS, PUBLISHED, Schema, keyed, list_of, number, one_of, positive, text, whole
from lib.messages import UnusableFile
from lib.comparison import MISSING, three_digits, time_with_spread
from lib.document import Column, Entry, Heading, Paragraph, Table, conditions

# A rung: the solver, and what its fast form goes without.
RUNGS = {
    PUBLISHED: (PUBLISHED, ()),
    "without any": (FAST, ("bands", "predictor", "newton")),
    "without newton": (FAST, ("newton",)),
    "without predictor": (FAST, ("predictor",)),
    "without bands": (FAST, ("bands",)),
    FAST: (FAST, ()),
}
STAGES = (1, 2, 3)  # of the cells of Table 1
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
    return formats.read_study(path, SCHEMA, sections)


def points_of(study):
    """Returns the points by (integrator, n, rung). Throws UnusableFile."""
    points = keyed(study.tables["points"], "integrator", "n", "rung")
    if not points or not all(point.seconds for point in points.values()):
        raise UnusableFile("has no points, or one without a time")
    return points


def claims(path):
    """Returns what a raw file says, as Items. Throws UnusableFile."""
    points = formats.read_study(path, SCHEMA, points_of)
    sizes = list(dict.fromkeys(n for _, n, _ in points))
    cells = {form: [f"{form}{s}" for s in STAGES] for form in FORMULATIONS}

    def gain(rung, n, names):
        """Returns the geometric mean over integrators of a rung's time over that of the fast form; None without any."""
        times = [statistics.median(ratios(points, name, n, rung)) for name in names if ratios(points, name, n, rung)]
        return statistics.geometric_mean(times) if times else None

    def by_size(rung):
        means = [(n, gain(rung, n, sum(cells.values(), []))) for n in sizes]
        return ", ".join(f"{mean:.2g} at n = {n}" for n, mean in means if mean)

    ideas = [rung for rung in RUNGS if rung not in (PUBLISHED, FAST)]
    times = {(rung, n, form): gain(rung, n, cells[form]) for rung in ideas for n in sizes for form in FORMULATIONS}
    found = [("Times of the published form over those of the fast form",
              f": {by_size(PUBLISHED)} (a step, geometric mean over the cells of Table 1, smooth scene, first steps)."),
             ("Times without an idea over those with all", f": {'; '.join(f'{each}, {by_size(each)}' for each in ideas)}.")]
    cheaper = [(mean, key) for key, mean in times.items() if mean and mean < 1]
    if cheaper:
        least, (rung, n, form) = min(cheaper)
        found.append((f"At most {1 / least - 1:.1%} faster is a form that leaves an idea out",
                      f", in the mean over s, at any n: {form} {rung} at n = {n}."))
    return found


def sections(study):
    points = points_of(study)
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
        found = ratios(points, name, n, rung)
        return time_with_spread(found) if found else MISSING

    texts = ([three_digits(fast.sweeps), three_digits(fast.equivalent_products), time_with_spread(fast.seconds)]
             if fast else [MISSING] * 3)
    return [Entry(each) for each in (str(n), name, *texts, *(ratio(rung) for rung in RUNGS if rung != FAST))]


def ratios(points, name, n, rung):
    """Returns the times of a rung over those of the fast form, each within a round; none where one failed."""
    rung, fast = points.get((name, n, rung)), points.get((name, n, FAST))
    return [theirs / ours for theirs, ours in zip(rung.seconds, fast.seconds)] if rung and fast else []
