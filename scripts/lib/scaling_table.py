"""The raw file of scripts/studies/scaling.py, its tables and figures: what a step costs, and what each idea buys."""

import statistics
from typing import NamedTuple

from lib import formats
from lib.formats import FAST, FORMULATIONS, PUBLISHED, Schema, keyed, list_of, number, one_of, positive, text, whole
from lib.messages import UnusableFile
from lib.comparison import MISSING, three_digits, time_with_spread
from lib.document import Column, Entry, Heading, Paragraph, Table, conditions, plain_table

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
    seconds: list_of(positive)  # CPU time, one for each repetition, at least one


SCHEMA = Schema("scaling", Settings, {"points": Point})


def rendered(path):
    """Returns the document of a raw file and its figures. Throws UnusableFile with one line that names the file."""
    return formats.read_study(path, SCHEMA, lambda study: (sections(study), figures(points_of(study))))


def points_of(study):
    """Returns the points by (integrator, n, rung). Throws UnusableFile."""
    points = keyed(study.tables["points"], "integrator", "n", "rung")
    if not points:
        raise UnusableFile("has no points")
    return points


# ---- means over the cells of Table 1


def sizes_of(points):
    return list(dict.fromkeys(n for _, n, _ in points))


def gain(points, rung, n, forms=FORMULATIONS):
    """Returns the geometric mean, over s and over formulations, of a rung's time over the fast form's, or None."""
    found = [ratios(points, f"{form}{s}", n, rung) for form in forms for s in STAGES]
    times = [statistics.median(each) for each in found if each]
    return statistics.geometric_mean(times) if times else None


def figures(points):
    """Returns the means by key: over the formulations, of each, and what an idea costs that costs the most."""
    found = {f"{rung.replace(' ', '_')}.n{n}{suffix}": gain(points, rung, n, forms)
             for rung in RUNGS if rung != FAST for n in sizes_of(points)
             for suffix, forms in (("", FORMULATIONS), *((f".{form}", (form,)) for form in FORMULATIONS))}
    known = {key: mean for key, mean in found.items() if mean}
    ideas = [mean for key, mean in known.items() if key.startswith("without") and key.endswith(FORMULATIONS)]
    return {**known, **({"costliest_idea": max(0.0, 1 / min(ideas) - 1)} if ideas else {})}


def means_table(points):
    rows = [[rung, *(MISSING if mean is None else three_digits(mean) for mean in
                     (gain(points, rung, n) for n in sizes_of(points)))] for rung in RUNGS if rung != FAST]
    return plain_table((Column("form", align="left"), *(Column(f"n = {n}") for n in sizes_of(points))), rows)


# ---- the document


def sections(study):
    points, settings = points_of(study), study.settings
    columns = (Column("n"), Column("integrator", align="left"), Column("sweeps"), Column("equivalent products"),
               Column("CPU seconds"),
               *(Column(rung, "time over that of the fast form") for rung in RUNGS if rung != FAST))
    return [
        Heading("What a step costs, and what each idea buys", 1),
        Paragraph(f"The first {settings.steps} steps from the initial data of the {settings.scene} scene, h ="
                  f" {settings.step:g}, the same stretch everywhere."),
        Heading("Time over that of the fast form"),
        Paragraph("Geometric means over the cells of Table 1. Published: the published form. Without newton: plain"
                  " Picard sweeps. Without predictor: a cold start each step. Without bands: full products. Without"
                  " any: split-complex storage, its products, triangles and single precision of late terms are left."
                  " Below 1 an idea does not pay in these steps."),
        means_table(points),
        Heading("Every integrator"),
        Paragraph("All figures are those of a step; sweeps, products and CPU seconds are those of the fast form."
                  " Equivalent products: multiplications in units of one full complex product. Medians ± half the"
                  " interquartile range of repetitions in turns; ratios are within the same round. No range: single"
                  f" timing. {MISSING}: steps that fail, and ideas that an explicit method has no use for."),
        Table(columns, [[row(points, name, n) for name in dict.fromkeys(name for name, size, _ in points if size == n)]
                        for n in sizes_of(points)]),
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
