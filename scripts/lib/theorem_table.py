"""The raw file of scripts/studies/theorem.py, its report and its figures: where the formulations coincide, which is the
fastest, what they cost, and where the theorem ends."""

import itertools
import math
import statistics
from typing import NamedTuple

from lib import formats
from lib.formats import (FORMULATIONS, INTEGRATORS, Integrator, Schema, list_of, number, one_of, optional, positive,
                         text, whole)
from lib.messages import UnusableFile
from lib.comparison import MISSING, UNDECIDED_MARK, marks, spread_text, three_digits
from lib.document import Column, Entry, Heading, Paragraph, Table, conditions, plain_table
from lib.numbers import scientific
from lib.verdicts import FEWEST, HOLDS, MARGIN, UNDECIDED, claim_of_fastest, ratio_of

PAIRS = ("cotangent–group", "group–algebra", "cotangent–algebra")
SCENES = {  # the algebra, and the arithmetic of its steps
    "smooth": ("su(n)", "complex, Poisson solves"), "rough": ("su(n)", "complex, Poisson solves"),
    "euler_top": ("so(3)", "real"), "rigid_body": ("so(n)", "real"), "spin_chain": ("su(2)^N", "complex 2 × 2 blocks"),
    "symplectic": ("sp(n)", "real, products with J"), "pseudo_unitary": ("su(p,q)", "complex, products with J")}
NOTHING, PRINTED_K, PRINTED_W = "nothing", "K as printed", "W̃ as printed"  # of what is changed
MISPRINTS = (  # what is changed, in which formulation; where, as printed, right
    (PRINTED_K, "algebra", "ISOSYRK, Kᵢⱼ", "h B(W̃ᵢ)(…)", "h B(W̃ⱼ)(…)"),
    (PRINTED_W, "group", "theorem, item 3", "Q W₀ J Q J⁻¹", "Q† W₀ J Q J⁻¹"),
    (None, None, "introduction, g", "W ∈ GL(n,ℂ)", "W ∈ M(n,ℂ)"))
AT_ROUNDING = 1e-12  # differences of one step that are below stem from rounding
# Name, the table and the methods it is about (None: all that the table has), and the formulation said to be fastest.
CLAIMS = (
    ("(a)", "cost", ("s = 1",), "algebra"), ("(b)", "cost", ("s = 2", "s = 3"), "group"),
    ("footnote", "dirk", None, "algebra"))
NO_STEP = "no step"  # shown for a row whose Picard sweeps fail
CHAIN = "spin_chain"


class Settings(NamedTuple):
    steps: whole(1)  # of a run in which the formulations are compared
    timed_steps: whole(1)  # of a timed run; the spin chain's are longer
    tolerance: positive
    ends_n: whole(2)  # of the rigid body on which the theorem ends
    ends_step: positive


class Coincidence(NamedTuple):
    """Runs of the three formulations with s-stage Gauss; errors are the largest over those that converge."""

    scene: text
    n: whole(2)
    stages: whole(1)
    h_norm_B: positive
    difference: number  # largest entry of the difference of two of them
    algebra_defect: number  # largest entry of |W†J + JW|
    casimir_error: number  # largest |tr Wᵏ - tr W₀ᵏ| / Σ|λ|ᵏ, k = 2 … 5
    sweeps: list_of(optional(number), 3)  # of a step, by formulation; None for one that fails
    bound: number  # of the difference: steps · tolerance / (1 - contraction)


class End(NamedTuple):
    """One step of the plain formulations, with one thing changed."""

    changed: text
    case: text
    stages: whole(1)
    differences: list_of(number, 3)  # of PAIRS: largest entry
    casimir_errors: list_of(number, 3)  # of FORMULATIONS
    algebra_defect: number  # largest of the three
    order: optional(number)  # observed, of the form on g


class Timed(NamedTuple):
    """A method, "s = 2" of Gauss or a composition of midpoint steps, in one formulation; costs are those of a step.

    Where the Picard sweeps of a step fail, there are no costs and no times.
    """

    scene: text
    n: whole(2)
    h_norm_B: positive  # h‖B(W₀)‖₂
    method: text
    formulation: one_of(*FORMULATIONS)
    sweeps: optional(number)
    products: optional(number)
    difference: optional(number)  # from the answer on g: largest entry; None where either fails
    # CPU seconds, one entry a process: the median of its repetitions. The processes of the formulations of one method
    # are the same, in the same order.
    seconds: list_of(positive)


SCHEMA = Schema("theorem", Settings, {INTEGRATORS: Integrator, "coincidence": Coincidence, "ends": End, "cost": Timed,
                                      "dirk": Timed}, later=(INTEGRATORS,))


def rendered(path):
    """Returns the document of a raw file and its figures. Throws UnusableFile with one line that names the file."""
    return formats.read_study(path, SCHEMA, lambda study: (sections(checked(study)), figures(study)))


def checked(study):
    """Returns a study. Throws UnusableFile for one without rows, or with times that are not of the same processes."""
    for name in ("coincidence", "ends"):
        if not study.tables[name]:
            raise UnusableFile(f"has no rows of {name}")
    for name in ("cost", "dirk"):
        for row in study.tables[name]:
            if (row.sweeps is None) == bool(row.seconds):
                raise UnusableFile(f"has a row of {name} with sweeps and no time, or with times and no sweeps")
        for block in comparisons(study.tables[name]).values():
            if len({len(row.seconds) for row in block if row.seconds}) > 1:
                raise UnusableFile(f"has formulations of {name} that were not timed by the same processes")
    return study


def sections(study):
    settings, tables = study.settings, study.tables
    return [
        Heading("The theorem on every quadratic algebra, and where it ends", 1),
        Paragraph("Which formulation is fastest on each algebra; whether all three give the same answers; one step"
                  " with one thing changed, for which they do not. What it means is said in results/README.md."),
        Heading("Which formulation is fastest"),
        Paragraph("Claim (a): algebra is fastest at s = 1; (b): group is fastest at s ≥ 2; the footnote: isospectral"
                  " DIRK methods are fastest on g (algebra). The ratio is the time of the fastest other formulation"
                  " over that of the claimed one. A claim holds if its formulation is faster than both others (the"
                  f" whole 95 % interval of the ratio lies beyond {MARGIN:g}), fails if it is slower than one, and is a"
                  f" tie if it ties with one. Bold, in text a star: it holds. {UNDECIDED_MARK}: undecided. Each"
                  f' row was timed in {number_of_processes(study)} processes. "{NO_STEP}": its Picard sweeps fail.'),
        claims_table(tables),
        Heading("Where the formulations coincide"),
        Paragraph(f"Gauss with s = 1, 2, 3 in every formulation: {settings.steps} steps at each h‖B(W₀)‖₂, tolerance"
                  f" {settings.tolerance:g}; the largest over s and h. Difference: entries of W between two forms."
                  " Its bound is steps · tolerance / (1 − contraction). From g: entries of W†J + JW. Casimirs: tr Wᵏ,"
                  " k = 2 … 5, relative to Σ|λ|ᵏ."),
        coincidence_table(tables["coincidence"]),
        Heading("What they cost"),
        Paragraph(f"Gauss: CPU milliseconds a step, over {settings.timed_steps} steps from the initial data; the time"
                  " over that of group, both geometric means over processes, ± half the 95 % interval; Picard sweeps."
                  " Bold, in text a star: the fastest of the three, and every one that ties with it;"
                  f" {UNDECIDED_MARK}: not decided against the fastest. Cotangent multiplies by no J."),
        cost_table(tables["cost"]),
        Heading("DIRK methods"),
        Paragraph("The isospectral DIRK methods of the paper's footnote are compositions of midpoint steps. Each"
                  " substep is solved on T*G (cotangent), on G (group) or on g (algebra). Read as the table above."),
        cost_table(tables["dirk"]),
        Heading("Where the theorem ends"),
        Paragraph(f"One step of h = {settings.ends_step:g} of the rigid body in so({settings.ends_n}), by the equations"
                  " as they stand, with one thing changed. Bold, in text a star: zero up to rounding. IIIA–IIIB is a"
                  " partitioned pair for Q and P on T*G; the forms on G and on g have the tableau named last. IIIB"
                  " with s = 2 is the midpoint rule. From g: the largest of the three. Where B is outside g, the flow"
                  " itself leaves g."),
        ends_table(tables["ends"]),
        Heading("Misprints of the paper"),
        Paragraph("As printed against the form that is right, in the steps above; the order is observed, beside that of"
                  " the right form. The last needs no measurement: no matrix of so(n) with odd n is invertible."),
        misprints_table(tables["ends"]),
        conditions(study.context),
    ]


# ---- tables


def by(rows, *fields):
    """Returns lists of the rows that agree in some fields, by the tuple of these."""
    found = {}
    for row in rows:
        found.setdefault(tuple(getattr(row, field) for field in fields), []).append(row)
    return found


def largest(rows, field):
    return scientific(max(getattr(row, field) for row in rows))


def lefts(*headings):
    return tuple(Column(heading, align="left") for heading in headings)


def coincidence_table(rows):
    headings = ("n", "difference", "of its bound", "from g", "Casimirs")
    return plain_table((*lefts("scene", "algebra", "arithmetic"), *map(Column, headings)), [
        [scene, *SCENES.get(scene, (MISSING, MISSING)), str(n), largest(found, "difference"),
         f"{100 * max(row.difference / row.bound for row in found):.2g} %", largest(found, "algebra_defect"),
         largest(found, "casimir_error")] for (scene, n), found in by(rows, "scene", "n").items()])


def comparisons(rows):
    """Returns the rows that are compared with one another, by scene, n, h‖B‖ and method."""
    return by(rows, "scene", "n", "h_norm_B", "method")


def methods_of(rows):
    return list(dict.fromkeys(row.method for row in rows))


def times_of(block):
    """Returns the seconds of the formulations that converge, by formulation."""
    return {row.formulation: row.seconds for row in block if row.seconds}


def number_of_processes(study):
    counts = {len(row.seconds) for name in ("cost", "dirk") for row in study.tables[name] if row.seconds}
    return f"{min(counts)} to {max(counts)}" if len(counts) > 1 else str(*counts or (0,))


def claims_table(tables):
    """Returns a row for each scene, n and claim, and a column for each h‖B‖: the result and its ratio."""
    norms, blocks = sorted({row.h_norm_B for name in ("cost", "dirk") for row in tables[name]}), []
    found = {name: comparisons(tables[name]) for name in ("cost", "dirk")}
    for scene, n in dict.fromkeys((row.scene, row.n) for row in tables["cost"] + tables["dirk"]):
        blocks.append([])
        for claim, name, methods, wanted in CLAIMS:
            for method in methods or methods_of(tables[name]):
                there = [found[name].get((scene, n, norm, method), ()) for norm in norms]
                if any(there):
                    blocks[-1].append([Entry(scene), Entry(str(n)), Entry(f"{claim}, {method}"), Entry(wanted),
                                       *(claim_entry(wanted, block) for block in there)])
    return Table((*lefts("scene"), Column("n"), *lefts("claim", "fastest is"), *(
        Column(f"h‖B‖ = {norm:g}") for norm in norms)), blocks)


def claim_entry(wanted, block):
    """Shows whether `wanted` is fastest in a block, and the ratio."""
    times = times_of(block)
    if any(row.formulation == wanted and not row.seconds for row in block):
        return Entry(NO_STEP)
    if wanted not in times or len(times) < 2:
        return Entry(MISSING)
    result, ratio = claim_of_fastest(wanted, times)
    digits = three_digits(ratio.ratio)
    return Entry(f"{digits} {UNDECIDED_MARK}" if result == UNDECIDED else f"{result} {digits}", result == HOLDS)


def cost_table(rows):
    """Returns a block for each scene, n and h‖B‖, a row for each formulation and columns for each method."""
    methods, blocks = methods_of(rows), []
    for (scene, n, norm), found in by(rows, "scene", "n", "h_norm_B").items():
        cells = {(row.method, row.formulation): row for row in found}
        level = {method: marks(times_of(block)) for (method,), block in by(found, "method").items()}
        blocks.append([[Entry(scene), Entry(str(n)), Entry(f"{norm:g}"), Entry(form), *(
            show(cells, method, form, *level.get(method, (set(), set())))
            for show in (time_entry, ratio_entry, sweeps_entry) for method in methods)] for form in FORMULATIONS])
    return Table((*lefts("scene"), Column("n"), Column("h‖B‖"), *lefts("formulation"), *(
        Column(method, group) for group in ("ms a step", "over group's", "sweeps") for method in methods)), blocks)


def time_entry(cells, method, form, best, undecided):
    """Shows the milliseconds of a cell, marked where it is among the fastest; `cells` are rows by method and form."""
    cell = cells.get((method, form))
    if not cell:
        return Entry(MISSING)
    if not cell.seconds:
        return Entry(NO_STEP)
    milliseconds = three_digits(1e3 * statistics.geometric_mean(cell.seconds))
    return Entry(f"{milliseconds} {UNDECIDED_MARK}" if form in undecided else milliseconds, form in best)


def ratio_entry(cells, method, form, *_):
    cell, group = cells.get((method, form)), cells.get((method, "group"))
    if form == "group" or not (cell and group and cell.seconds and group.seconds):
        return Entry(MISSING)
    ratio = ratio_of(cell.seconds, group.seconds)
    if ratio.processes < FEWEST:
        return Entry(three_digits(ratio.ratio))
    return Entry(spread_text(three_digits(ratio.ratio), 100 * (ratio.high / ratio.ratio - 1)))


def sweeps_entry(cells, method, form, *_):
    cell = cells.get((method, form))
    return Entry(three_digits(cell.sweeps) if cell and cell.seconds else MISSING)


def ends_table(rows):
    columns = (*lefts("case"), *(Column(pair, "difference") for pair in PAIRS),
               *(Column(name, "Casimir error") for name in FORMULATIONS), Column("from g"))
    return Table(columns, [[[Entry(row.case), *(Entry(scientific(value), value < AT_ROUNDING) for value in (
        *row.differences, *row.casimir_errors, row.algebra_defect))] for row in found]
        for found in by(rows, "changed").values()])


def misprints_table(rows):
    orders = {row.stages: row.order for row in rows if row.changed == NOTHING}
    found = []
    for changed, form, *texts in MISPRINTS:
        found += [[*texts, str(row.stages), scientific(row.differences[1]),
                   scientific(row.casimir_errors[FORMULATIONS.index(form)]),
                   f"{row.order:.1f}, {orders[row.stages]:.1f}" if row.order and orders.get(row.stages) else MISSING]
                  for row in rows if row.changed == changed] or [[*texts, *[MISSING] * 4]]
    headings = ("s", "difference", "Casimirs", "orders")
    return plain_table((*lefts("where", "printed", "right"), *map(Column, headings)), found)


# ---- figures


def figures(study):
    """Returns the figures that results/README.md may quote, by key.

    cost.SCENE.sS.FORM-over-OTHER.least and .most are the ratio of two formulations' times, one of them group, over all
    n and h. All scenes but the spin chain stand under others too, and these and the chain at one h under others.H and
    spin_chain.H.
    """
    tables = study.tables
    rows, found = tables["coincidence"], {}
    found.update({"coincidence.settings": len(rows),
                  "coincidence.within": sum(row.difference <= row.bound for row in rows),
                  "coincidence.failed": sum(sweeps is None for row in rows for sweeps in row.sweeps)})
    for field in ("difference", "algebra_defect", "casimir_error"):
        found[f"coincidence.{field}"] = max(getattr(row, field) for row in rows)
    for row in tables["ends"]:
        key = f"ends.{key_part(row.case)}"
        found.update({f"{key}.{pair.replace('–', '-')}": value for pair, value in zip(PAIRS, row.differences)})
        found.update({f"{key}.casimirs.{form}": value for form, value in zip(FORMULATIONS, row.casimir_errors)})
        found[f"{key}.from_g"] = row.algebra_defect
        if row.order:
            found[f"{key}.order"] = row.order
    found.update(ratio_figures(tables["cost"]))
    for claim, name, methods, wanted in CLAIMS:
        found.update(claim_figures(claim.strip("()"), comparisons(tables[name]), methods, wanted))
    return {**found, **chain_power([row for row in tables["cost"] if row.scene == CHAIN and row.seconds])}


def key_part(name):
    """Writes a name as part of a key: small ASCII letters and digits, and an underscore for all else between them."""
    plain = "".join(c if c.isascii() and c.isalnum() else " " for c in name.replace("s = ", "s").lower())
    return "_".join(plain.split())


def ratio_figures(rows):
    spans = {}
    for (scene, _, norm, method), block in comparisons(rows).items():
        times, method = times_of(block), key_part(method)
        for form, other in (pair for pair in itertools.permutations(times, 2) if "group" in pair):
            pair, ratio = f"{method}.{form}-over-{other}", ratio_of(times[form], times[other]).ratio
            together = CHAIN if scene == CHAIN else "others"
            for over in dict.fromkeys((scene, together, f"{together}.{norm:g}")):
                spans.setdefault(f"cost.{over}.{pair}", []).append(ratio)
    found = {f"{key}.least": min(values) for key, values in spans.items()}
    found.update({f"{key}.most": max(values) for key, values in spans.items()})
    return found


def claim_figures(claim, blocks, methods, wanted):
    """Returns in how many of the blocks a claim comes out how, by scene; `none` where it could not be judged."""
    found = {}
    for (scene, _, _, method), block in blocks.items():
        if methods is None or method in methods:
            times = times_of(block)
            result = claim_of_fastest(wanted, times)[0] if wanted in times and len(times) > 1 else "none"
            for each in (result, "of"):
                key = f"claims.{claim}.{scene}.{each}"
                found[key] = found.get(key, 0) + 1
    return found


def chain_power(rows):
    """Returns the power of N with which the time of a sweep grows on the chain, if there are two sizes."""
    cost = {n: statistics.geometric_mean(second / row.sweeps for row in found for second in row.seconds)
            for (n,), found in sorted(by(rows, "n").items())}
    if len(cost) < 2:
        return {}
    (small, first), *_, (large, last) = cost.items()
    return {"chain.smallest": small // 2, "chain.largest": large // 2,
            "chain.power": math.log(last / first, large / small)}
