"""The raw file of scripts/studies/scaling.py, its tables and figures: what a step costs, and what each idea buys."""

import re
import statistics
from typing import NamedTuple

from lib import formats
from lib.formats import (FAST, FORMULATIONS, PUBLISHED, Schema, keyed, list_of, number, one_of, optional, positive,
                         text, whole)
from lib.messages import UnusableFile
from lib.comparison import MISSING, percentage, three_digits, time_with_spread
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

# Exponential methods: the ideas of each family.
LIE_POISSON = "elp"
FAMILIES = {
    LIE_POISSON: ("bands", "predictor", "newton", "explicit_start", "error_estimates", "single_precision",
                  "graded_series"),
    "magnus": ("bands",),  # and single precision, from a tolerance of 1e-6 on
    "rkmk": ("bands", "single_precision", "graded_series"),
}
EXPONENTIAL_RUNGS = {
    PUBLISHED: (PUBLISHED, ()),
    "without any": (FAST, FAMILIES[LIE_POISSON]),
    "without newton": (FAST, ("newton",)),
    "without predictor": (FAST, ("predictor",)),
    "without explicit start": (FAST, ("explicit_start",)),
    "without either start": (FAST, ("predictor", "explicit_start")),
    "without estimates": (FAST, ("error_estimates",)),
    "without single precision": (FAST, ("single_precision",)),
    "without graded series": (FAST, ("graded_series",)),
    "without bands": (FAST, ("bands",)),
    FAST: (FAST, ()),
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
    seconds: list_of(positive)  # CPU time, one for each repetition, at least one


class ExponentialPoint(NamedTuple):
    """The same of an exponential method, on a stretch of its own."""

    integrator: text
    n: whole(2)
    rung: one_of(*EXPONENTIAL_RUNGS)
    step: positive
    tolerance: positive
    sweeps: number
    equivalent_products: number
    seconds: list_of(positive)


class LargePoint(NamedTuple):
    """A fast form at a large n, timed once; all costs are those of a step, and None where one fails."""

    scene: text
    integrator: text
    n: whole(2)
    step: positive
    tolerance: positive
    sweeps: optional(number)
    equivalent_products: optional(number)
    product_rate: positive  # products a second, by themselves
    seconds: optional(positive)

    @property
    def share_of_products(self):
        """Returns the part of the time that the products would take by themselves."""
        return self.equivalent_products / self.product_rate / self.seconds


SCHEMA = Schema("scaling", Settings, {"points": Point, "exponential": ExponentialPoint, "large": LargePoint},
                later=("exponential", "large"))


def family_of(integrator):
    """Returns the family of an exponential method, in the frame or not, or None for any other."""
    match = re.match("[a-z]+", integrator)
    return match[0] if match and match[0] in FAMILIES else None


def exponential_rungs(integrator):
    """Returns the rungs of an exponential method. Without any: where that is more than without bands."""
    ideas = {*FAMILIES[family_of(integrator)]}
    return [rung for rung, (_, without) in EXPONENTIAL_RUNGS.items()
            if {*without} <= ideas or (rung == "without any" and len(ideas) > 1)]


def rendered(path):
    """Returns the document of a raw file and its figures. Throws UnusableFile with one line that names the file."""
    return formats.read_study(path, SCHEMA, lambda study: (sections(study), all_figures(study)))


def points_of(study):
    """Returns the points by (integrator, n, rung). Throws UnusableFile."""
    points = keyed(study.tables["points"], "integrator", "n", "rung")
    if not points and not any(study.tables.values()):
        raise UnusableFile("has no points")
    return points


def exponential_points_of(study):
    """Returns the points of exponential methods by (integrator, n, rung)."""
    return keyed(study.tables["exponential"], "integrator", "n", "rung")


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


def exponential_gain(points, rung, n, names):
    """Returns the geometric mean, over exponential methods, of a rung's time over the fast form's, or None."""
    found = [ratios(points, name, n, rung) for name in names]
    times = [statistics.median(each) for each in found if each]
    return statistics.geometric_mean(times) if times else None


def exponential_figures(points):
    """Returns the gains by key: of each method, and the mean over those that are Lie–Poisson."""
    names = names_of(points)
    groups = {"": [name for name in names if family_of(name) == LIE_POISSON], **{f".{name}": [name] for name in names}}
    found = {f"exponential.{rung.replace(' ', '_')}.n{n}{suffix}": exponential_gain(points, rung, n, members)
             for rung in EXPONENTIAL_RUNGS if rung != FAST for n in sizes_of(points)
             for suffix, members in groups.items()}
    return {key: mean for key, mean in found.items() if mean}


def all_figures(study):
    return {**figures(points_of(study)), **exponential_figures(exponential_points_of(study))}


def names_of(points):
    return list(dict.fromkeys(name for name, _, _ in points))


def means_table(points):
    rows = [[rung, *(MISSING if mean is None else three_digits(mean) for mean in
                     (gain(points, rung, n) for n in sizes_of(points)))] for rung in RUNGS if rung != FAST]
    return plain_table((Column("form", align="left"), *(Column(f"n = {n}") for n in sizes_of(points))), rows)


# ---- the document


def sections(study):
    points, exponential = points_of(study), exponential_points_of(study)
    return [Heading("What a step costs, and what each idea buys", 1),
            *(sections_on_all(points, study.settings) if points else []),
            *(exponential_sections(exponential, study.settings) if exponential else []),
            *(large_sections(study.tables["large"], study.settings) if study.tables["large"] else []),
            conditions(study.context)]


def sections_on_all(points, settings):
    columns = (Column("n"), Column("integrator", align="left"), Column("sweeps"), Column("equivalent products"),
               Column("CPU seconds"),
               *(Column(rung, "time over that of the fast form") for rung in RUNGS if rung != FAST))
    return [
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
    ]


def exponential_sections(points, settings):
    steps, tolerances = ({getattr(point, name) for point in points.values()} for name in ("step", "tolerance"))
    names, sizes = names_of(points), sizes_of(points)
    rungs = [rung for rung in EXPONENTIAL_RUNGS if rung != FAST]

    def ratio(name, n, rung):
        found = ratios(points, name, n, rung)
        return time_with_spread(found) if found else MISSING

    blocks = [[[Entry(each) for each in (name, rung, *(ratio(name, n, rung) for n in sizes))]
               for rung in rungs if any((name, n, rung) in points for n in sizes)] for name in names]
    costs = [[[Entry(each) for each in (str(n), name, *costs_of(points.get((name, n, FAST))))] for name in names
              if any(key[:2] == (name, n) for key in points)] for n in sizes]
    return [
        Heading("What each idea buys, exponential methods"),
        Paragraph("Time over that of the fast form. These methods are for long steps, and keep the spectrum at any"
                  f" tolerance: the first {settings.steps} steps from the initial data of the {settings.scene} scene"
                  f" with h = {listed(steps)} and a tolerance of {listed(tolerances)}, published forms too. Without"
                  " newton: plain Picard sweeps. Without predictor: no start values from past steps. Without explicit"
                  " start: none from a step of an explicit Magnus method. Without either start: a cold start each step."
                  " Without estimates: a correction is accepted by one more sweep, not by its estimated error. Without"
                  " single precision: late terms of series, start values and corrections in double precision. Without"
                  " graded series: each is summed to rounding, not to the accuracy that is wanted of it. Without bands:"
                  " full products. Without any: of all that the method has. Below 1 an idea does not pay in these"
                  " steps."),
        Table((Column("integrator", align="left"), Column("form", align="left"),
               *(Column(f"n = {n}") for n in sizes)), blocks),
        Heading("Every exponential method"),
        Paragraph("A step of the fast form on that stretch. Medians ± half the interquartile range of repetitions in"
                  f" turns. {MISSING}: steps that fail."),
        Table((Column("n"), Column("integrator", align="left"), Column("sweeps"), Column("equivalent products"),
               Column("CPU seconds")), costs),
    ]


def listed(numbers):
    return " and ".join(f"{each:g}" for each in sorted(numbers))


def large_sections(points, settings):
    def costs(point):
        if point.seconds is None:
            return [MISSING] * 4
        return [three_digits(point.sweeps), three_digits(point.equivalent_products),
                percentage(point.share_of_products), three_digits(point.seconds)]

    rows = [[str(point.n), point.scene, point.integrator, f"{point.step:g}", f"{point.tolerance:g}", *costs(point)]
            for point in points]
    return [
        Heading("Large n"),
        Paragraph(f"A step of fast forms: the mean of the first {settings.steps}, timed once: a disturbed minute shows."
                  " Share of products: what the equivalent products would take by themselves, at the rate of"
                  f" products measured here. {MISSING}: steps that fail."),
        plain_table((Column("n"), Column("scene", align="left"), Column("integrator", align="left"), Column("h"),
                     Column("tolerance"), Column("sweeps"), Column("equivalent products"), Column("share of products"),
                     Column("CPU seconds")), rows),
    ]


def costs_of(fast):
    """Returns the texts of the costs of a fast form's step; None stands for one that failed."""
    return ([three_digits(fast.sweeps), three_digits(fast.equivalent_products), time_with_spread(fast.seconds)]
            if fast else [MISSING] * 3)


def row(points, name, n):
    """Returns the row of an integrator at one n; what failed is shown without figures."""
    fast = points.get((name, n, FAST))

    def ratio(rung):
        found = ratios(points, name, n, rung)
        return time_with_spread(found) if found else MISSING

    return [Entry(each) for each in (str(n), name, *costs_of(fast), *(ratio(rung) for rung in RUNGS if rung != FAST))]


def ratios(points, name, n, rung):
    """Returns the times of a rung over those of the fast form, each within a round; none where one failed."""
    rung, fast = points.get((name, n, rung)), points.get((name, n, FAST))
    return [theirs / ours for theirs, ours in zip(rung.seconds, fast.seconds)] if rung and fast else []
