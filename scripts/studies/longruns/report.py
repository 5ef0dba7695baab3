"""The study of long runs as a document, and its figures."""

import math

from lib.judging.drift import (ALL_LOST, BLOCKS, BOUNDED, FAILED, GROWS, KEPT, MIN_DRIFT, MIN_GROWTH, LOST,
                               MAX_TREND, ROUNDING)
from lib.judging.verdicts import UNDECIDED
from lib.pages.document import Column, Entry, Heading, Items, Paragraph, Table, conditions, plain_table, shown
from lib.pages.numbers import MISSING, power, scientific, three_digits, two_digits
from lib.pages.rendering import Rendering
from studies.longruns.judge import RIVALS, defects, figures, places_of
from studies.longruns.schema import (COSTS, COST_MARGIN, ENERGY, EXPLICIT, EXPLICIT_LIE, EXPONENTIAL, EXPONENTIAL_LOOSE,
                                     GAUSS, PLAIN, PROJECTED, QUANTITIES, SCENES, SPECTRUM, STRUCTURE, read_longruns)

CHARTS = (
    ("energy_against_cost", "Largest energy error of a run against its cost, a line for each of the chief methods; all"
     " others are in tables. Below left is best."),
    ("spectrum_against_cost", "Error of the eigenvalues at the end of the same runs."),
    ("energy_against_time", "Largest energy error in each window of the long runs of the chief methods, all at"
     f" {COSTS[-1]} products a unit of time."),
)
CLASS_TITLES = {EXPLICIT: "explicit", PROJECTED: "explicit, projected", EXPLICIT_LIE: "RKMK, Magnus",
                EXPONENTIAL_LOOSE: "exponential, 1e-8", EXPONENTIAL: "exponential, 1e-13", GAUSS: "Gauss, 1e-13"}
SHOWN = {ENERGY: tuple(CLASS_TITLES), SPECTRUM: tuple(each for each in CLASS_TITLES if each != PROJECTED)}
RULES = (
    (FAILED, ": the solver failed, or the energy was off by its own size"),
    (ALL_LOST, f": an error of {LOST:g} or more"),
    (KEPT, f": always below {ROUNDING:g}"),
    (GROWS, f": like t^p, and the interval of p lies above {MIN_GROWTH:g}; or the mean error drifts by more than"
     f" {MIN_DRIFT:g} of its size, which is told instead of p"),
    (BOUNDED, f": the straight lines through error and mean error have slopes whose intervals hold 0, and gain less"
     f" than {MAX_TREND:g} of the error in the whole run"),
    (UNDECIDED, ": anything else"))


# ---- does structure pay?


def prices_table(runs, quantity, places):
    """Returns the table of the cheapest methods at all Places of a quantity, the cheapest of each row marked."""
    columns = [Column("n"), Column("T"), Column("scene", align="left"), Column(f"{quantity} error")]
    columns += [Column(CLASS_TITLES[each], align="left") for each in SHOWN[quantity]]
    columns += [Column("structure over explicit")] + [Column("over projected")] * (quantity == ENERGY)
    blocks = {}
    for place in places:
        prices = [place.prices[each] for each in SHOWN[quantity]]
        minimum = min((price.products for price in prices if price), default=None)
        row = [Entry(text) for text in (str(place.n), f"{runs.plans[place.n].time:g}", place.scene,
                                        power(place.error))]
        row += [Entry(price_text(price), bool(price) and price.products == minimum) for price in prices]
        row += [Entry(ratio_text(place.ratio((each,)))) for each in RIVALS[quantity]]
        blocks.setdefault((place.n, place.scene), []).append(row)
    return Table(tuple(columns), list(blocks.values()))


def price_text(price):
    if price is None:
        return MISSING
    return f"{'≤ ' if price.at_most else ''}{three_digits(price.products)} {price.method}"


def ratio_text(ratio):
    return MISSING if ratio is None else two_digits(ratio)


# ---- the document


def sections(runs, charts):
    """Returns the document; `charts` are the names of the charts beside it."""
    plain = [name for name, each in runs.integrators.items() if not (each.has_fast_form and each.co_rotating)]
    but = f", but {', '.join(plain)}" if plain else ""
    return [
        Heading("Long runs", 1),
        Paragraph("What methods keep, against what they cost, from the initial data of a scene. Every method has its"
                  f" fast form and the co-rotating frame{but}. Tolerance 1e-13 of Gauss methods, 1e-7 where the name"
                  " ends in _loose; 1e-8 of exponential and Magnus methods, 1e-13 where it ends in _tight. Costs are"
                  " full products of n × n matrices a unit of time. The eigenvectors that a projection computes are not"
                  " in them."),
        *shown(CHARTS, charts),
        *prices_sections(runs),
        *long_sections(runs),
        *defect_sections(runs),
        *lines_sections(runs),
        conditions(runs.context),
    ]


def prices_sections(runs):
    places = {quantity: places_of(runs, quantity) for quantity in QUANTITIES}
    counts = {quantity: (sum(place.pays for place in found), len(found)) for quantity, found in places.items()}
    return [
        Heading("Does structure pay?"),
        Paragraph("The least cost of an energy error, the largest of a run, in each class of methods. Interpolated"
                  " in the logarithms between neighbouring runs of a line, beyond no line. ≤: the longest step tried"
                  " has the error already. A run that loses a tenth of the energy or of the spectrum, as RK4 with long"
                  " steps does, counts nowhere. Structure: the cheaper of exponential and Gauss methods at the"
                  " tolerance 1e-13. It is cheaper than every explicit method, projected or not,"
                  f" in {counts[ENERGY][0]} of {counts[ENERGY][1]} places. Bold: the cheapest of a row."),
        prices_table(runs, ENERGY, places[ENERGY]),
        Heading("Does the spectrum?"),
        Paragraph("The same for the spectrum error at the end. All but explicit methods keep the spectrum whatever the"
                  " step, and projected ones by force. Keeping the structure is cheaper than every explicit method"
                  f" without projection in {counts[SPECTRUM][0]} of {counts[SPECTRUM][1]} places, and cheaper than"
                  f" keeping the spectrum alone, by RKMK or Magnus, in"
                  f" {sum(place.is_cheaper_than_spectrum for place in places[SPECTRUM])}."),
        prices_table(runs, SPECTRUM, places[SPECTRUM]),
    ]


def long_sections(runs):
    if not runs.long_runs:
        return []
    times = ", ".join(f"n = {n} to T = {time:g}"
                      for n, time in sorted({(run.n, run.time) for run in runs.long_runs.values()}))
    return [
        Heading("Energy and spectrum in long runs"),
        Paragraph(f"{times}, at equal costs. Steps were found by counts. Energy error: the largest in the last window."
                  " Change: that of the whole run, with its sign. p: the power of time of the last decade. Every"
                  f" interval is 95 %, by a jackknife over {BLOCKS} blocks of neighbouring windows. Slopes are those"
                  " of the second half. The words:"),
        Items(list(RULES)),
        Paragraph(f"Lie–Poisson methods: {bounded_text(runs, STRUCTURE)} at the tolerance 1e-13, and"
                  f" {bounded_text(runs, (EXPONENTIAL_LOOSE,))} at 1e-8. Explicit steps of W, projected or not:"
                  f" {bounded_text(runs, PLAIN)}."),
        long_table(runs),
    ]


def bounded_text(runs, classes):
    """Writes in how many long runs of some classes the energy is bounded or at rounding, and in how many it grows."""
    verdicts = [run.judged(ENERGY).verdict for run in runs.long_runs.values() if runs.class_of(run) in classes]
    return (f"the energy is bounded or at rounding in {verdicts.count(BOUNDED) + verdicts.count(KEPT)} of"
            f" {len(verdicts)} runs and grows in {verdicts.count(GROWS)}")


def long_table(runs):
    """Returns the table of long runs, a block for each scene and cost."""
    columns = (Column("scene", align="left"), Column("cost"), Column("method", align="left"), Column("h"),
               Column("products"), Column("error", ENERGY), Column("change", ENERGY), Column("verdict", ENERGY, "left"),
               Column("error", SPECTRUM), Column("verdict", SPECTRUM, "left"))
    blocks = []
    for scene in SCENES:
        for cost in COSTS:
            found = runs.long_at(scene, cost)
            blocks.append([[Entry(text) for text in (scene, str(cost), method, *long_texts(found.get(method)))]
                           for method in runs.long_methods()])
    return Table(columns, blocks)


def long_texts(run):
    """Returns what became of a long run as texts; None is one whose every step costs something else."""
    if run is None:
        return [MISSING, "no such step", *[MISSING] * 5]
    off = "" if run.at_cost else f" (off by more than {COST_MARGIN:.0%})"
    return [three_digits(run.step), three_digits(run.equivalent_products) + off, error_text(run.last(ENERGY)),
            signed_text(run.energy_change), verdict_text(run, ENERGY), error_text(run.last(SPECTRUM)),
            verdict_text(run, SPECTRUM)]


def error_text(error):
    return MISSING if error is None else scientific(error)


def signed_text(change):
    if change is None:
        return MISSING
    return ("-" if change < 0 else "+") + scientific(abs(change))


def verdict_text(run, quantity):
    """Writes the verdict, of a failed run with its status, where it grows with the power or the drift."""
    verdict, growth, _, drift = run.judged(quantity)
    if verdict == FAILED:
        return f"{run.status} at step {run.failed_step}"
    if verdict != GROWS:
        return verdict
    if growth and growth.low > MIN_GROWTH:
        return "growing, p = {} ({} to {})".format(*map(two_places, growth))
    return "growing, drift {} ({} to {})".format(*map(two_places, drift))


def two_places(value):
    """Writes a number with two places, without a sign before 0."""
    return f"{round(value, 2) + 0.0:.2f}"


# ---- the symplectic defect


def defect_sections(runs):
    found = {(n, scene, method, cost): defect for scene, n, method, cost, defect in defects(runs)}
    if not found:
        return []
    places = [(n, scene) for n, scene in runs.settings() if any(key[:2] == (n, scene) for key in found)]
    columns = [Column("method", align="left")]
    columns += [Column(f"{cost} products", f"n = {n}, {scene}") for n, scene in places for cost in COSTS]
    rows = [[method, *(error_text(found.get((n, scene, method, cost))) for n, scene in places for cost in COSTS)]
            for method in runs.methods()]
    return [
        Heading("Symplectic defect"),
        Paragraph("Of the steps from t = 0 to t = 2: by how much the form of Kirillov and Kostant on three random pairs"
                  " of tangent vectors changes, over its usual size on such pairs. Measured by differences, which"
                  " leave some 1e-12, and more where the tolerance of a step makes it rough. Interpolated along the"
                  f" lines. {MISSING}: no step costs that."),
        plain_table(columns, rows),
    ]


# ---- all runs


def lines_sections(runs):
    parts = [Heading("All runs"),
             Paragraph("Products a unit of time: energy error, spectrum error. A run that failed, or whose energy was"
                       " off by its own size, has its status.")]
    for n, scene in runs.settings():
        lines = runs.lines_at(scene, n)
        steps = sorted({point.step for line in lines.values() for point in line}, reverse=True)
        rows = [[method, *(cell_of(line, step) for step in steps)] for method, line in lines.items()]
        parts += [Heading(f"n = {n}, {scene} scene, T = {runs.plans[n].time:g}", 3),
                  plain_table([Column("method", align="left"),
                               *(Column(f"h = {step:.4g}", align="left") for step in steps)], rows)]
    return parts


def cell_of(line, step):
    point = next((point for point in line if math.isclose(point.step, step)), None)
    if point is None:
        return ""
    if point.energy_error is None:
        return point.status
    return (f"{three_digits(point.equivalent_products)}: {scientific(point.energy_error)},"
            f" {scientific(point.spectrum_error)}")


# ---- figures


def rendered(raw, _recorded):
    """Returns the Rendering of a raw file."""
    runs = read_longruns(raw)
    from studies.longruns import charts  # only now: it needs matplotlib

    return Rendering(lambda names: sections(runs, names), figures(runs),
                     {name: getattr(charts, name)(runs) for name, _ in CHARTS})
