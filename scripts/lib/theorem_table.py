"""The raw file of scripts/studies/theorem.py, and its report: where the formulations coincide, and what they cost."""

import math
import statistics
from typing import NamedTuple

from lib import formats
from lib.formats import FORMULATIONS, Schema, keyed, list_of, number, one_of, optional, positive, text, whole
from lib.messages import UnusableFile
from lib.comparison import MISSING, fastest_rows, three_digits, time_with_spread
from lib.numbers import scientific, span
from lib.document import Column, Entry, Heading, Items, Paragraph, Table, conditions, plain_table

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


class Settings(NamedTuple):
    steps: whole(1)  # of a run
    tolerance: positive
    h_norm_B: positive  # h‖B(W₀)‖₂ of what is timed
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
    """A method, "s = 2" of Gauss or a composition of midpoint steps, in one formulation; costs are those of a step."""

    scene: text
    n: whole(2)
    method: text
    formulation: one_of(*FORMULATIONS)
    sweeps: number
    products: number
    difference: number  # from the answer on g: largest entry
    seconds: list_of(positive)  # CPU time, one for each repetition


SCHEMA = Schema("theorem", Settings, {"coincidence": Coincidence, "ends": End, "cost": Timed, "dirk": Timed})


def document(path):
    """Returns the document of a raw file. Throws UnusableFile with one line that names the file and what is wrong."""
    return formats.read_study(path, SCHEMA, sections)


def claims(path):
    """Returns what a raw file says, as Items. Throws UnusableFile."""
    return formats.read_study(path, SCHEMA, verdicts)


def sections(study):
    settings, tables = study.settings, study.tables
    return [
        Heading("The theorem on every quadratic algebra, and where it ends", 1),
        Items(verdicts(study)),
        Heading("Where the formulations coincide"),
        Paragraph(f"Gauss with s = 1, 2, 3 in every formulation: {settings.steps} steps at each h‖B(W₀)‖₂, tolerance"
                  f" {settings.tolerance:g}; the largest over s and h. Difference: entries of W between two forms."
                  " Its bound is steps · tolerance / (1 − contraction). From g: entries of W†J + JW. Casimirs: tr Wᵏ,"
                  " k = 2 … 5, relative to Σ|λ|ᵏ."),
        coincidence_table(tables["coincidence"]),
        Heading("What they cost"),
        Paragraph(f"Gauss at h‖B(W₀)‖₂ = {settings.h_norm_B:g}: CPU milliseconds a step, medians ± half the"
                  " interquartile range of repetitions in turns, and Picard sweeps a step. Bold, in text a star: the"
                  " fastest of the three, and what repetitions do not tell from it. Cotangent multiplies by no J."),
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


def times_of(block):
    return {row.formulation: row.seconds for row in block}


def cost_table(rows):
    """Returns a block for each scene and n, a row for each formulation and a column for each method."""
    methods, blocks = [method for method, in by(rows, "method")], []
    for (scene, n), found in by(rows, "scene", "n").items():
        best = {method: fastest_rows(times_of(block)) for (method,), block in by(found, "method").items()}
        for form in FORMULATIONS:
            cells = {row.method: row for row in found if row.formulation == form}
            times = [Entry(time_with_spread([1e3 * each for each in cells[method].seconds]), form in best[method])
                     if method in cells else Entry(MISSING) for method in methods]
            sweeps = [Entry(three_digits(cells[method].sweeps) if method in cells else MISSING) for method in methods]
            if form == FORMULATIONS[0]:
                blocks.append([])
            blocks[-1].append([Entry(scene), Entry(str(n)), Entry(form), *times, *sweeps])
    return Table((*lefts("scene"), Column("n"), *lefts("formulation"), *(
        Column(method, group) for group in ("ms a step", "sweeps") for method in methods)), blocks)


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


# ---- verdicts


def verdicts(study):
    """Returns a line for each question, as Items. Throws UnusableFile for a study without a row to answer it."""
    tables = study.tables
    for name, rows in tables.items():
        if not rows and name in ("coincidence", "ends") or not all(getattr(row, "seconds", True) for row in rows):
            raise UnusableFile(f"has no rows of {name}, or one without a time")
    for name in ("cost", "dirk"):
        keyed(tables[name], "scene", "n", "method", "formulation")
    cost, rows = tables["cost"], tables["coincidence"]
    failed = [f"{form} of {row.scene} at s = {row.stages}, h‖B(W₀)‖₂ = {row.h_norm_B:g}" for row in rows
              for form, sweeps in zip(FORMULATIONS, row.sweeps) if sweeps is None]
    return [
        ("The three formulations coincide", f" within the bound of their iterations in"
         f" {sum(row.difference <= row.bound for row in rows)} of {len(rows)} settings of scene, s and h, to"
         f" {largest(rows, 'difference')}; W stays in g to {largest(rows, 'algebra_defect')}, Casimirs to"
         f" {largest(rows, 'casimir_error')}. Left out, since Picard sweeps fail: {', '.join(failed) or 'nothing'}."),
        fastest("Claim (a), algebra is fastest at s = 1", [row for row in cost if row.method == "s = 1"], "algebra"),
        fastest("Claim (b), group is fastest at s ≥ 2", [row for row in cost if row.method != "s = 1"], "group"),
        *linear([row for row in cost if row.scene == "spin_chain"]),
        fastest("The footnote, isospectral DIRK is fastest on g", tables["dirk"], "algebra"),
        ("Where the theorem ends", ", by what is changed: " + "; ".join(
            f"{changed}: {zero(PAIRS, [row.differences for row in found])} coincide, spectrum kept by"
            f" {zero(FORMULATIONS, [row.casimir_errors for row in found])}"
            for (changed,), found in by(tables["ends"], "changed").items()) + ".")]


def zero(names, rows):
    """Returns the names of the columns that are zero in all rows, up to rounding."""
    found = [name for name, values in zip(names, zip(*rows)) if max(values) < AT_ROUNDING]
    return "all" if len(found) == len(names) else ", ".join(found) or "none"


def fastest(claim, rows, wanted):
    """Says of each scene in how many blocks of one n and method a formulation is fastest, and by how much."""
    told = []
    for (scene,), here in by(rows, "scene").items():
        blocks = [times_of(block) for block in by(here, "n", "method").values()]
        blocks = [times for times in blocks if wanted in times and len(times) > 1]
        winners = [fastest_rows(times) for times in blocks]
        alone, level = winners.count({wanted}), sum(wanted in each and len(each) > 1 for each in winners)
        ratios = {rival: [statistics.median(a / b for a, b in zip(times[rival], times[wanted]))
                          for times in blocks if rival in times] for rival in FORMULATIONS if rival != wanted}
        if blocks:
            told.append(f"{scene} won {alone}, tied {level} of {len(blocks)} ("
                        + ", ".join(f"{rival} {span(found)}" for rival, found in ratios.items() if found) + ")")
    return claim, ": " + ("; ".join(told) or "too little was timed") + f". In brackets: time over that of {wanted}."


def linear(rows):
    """Says how the time of a sweep grows with n, if there are two sizes."""
    cost = {n: statistics.geometric_mean(statistics.median(row.seconds) / row.sweeps for row in found)
            for (n,), found in sorted(by(rows, "n").items())}
    if len(cost) < 2:
        return []
    (small, first), *_, (large, last) = cost.items()
    return [("A sweep on a chain of N spins costs O(N)", f": from N = {small // 2} to {large // 2} its time grows as N"
             f" to the power {math.log(last / first, large / small):.2f}.")]
