"""The report of the study `theorem`: where the formulations coincide, what they cost, and where the theorem ends."""

import statistics

from lib.records.findings import FILE, as_json
from lib.records.formats import FORMULATIONS
from lib.judging.verdicts import FEWEST, HOLDS, MARGIN, UNDECIDED, claim_of_fastest, ratio_of
from lib.pages.document import Column, Entry, Heading, Paragraph, Table, conditions, plain_table
from lib.pages.numbers import MISSING, scientific, three_digits
from lib.pages.rendering import Rendering
from studies.tables.comparison import UNDECIDED_MARK, marks, spread_text
from studies.theorem.judge import figures, findings
from studies.theorem.schema import (AT_ROUNDING, CLAIMS, NOTHING, PAIRS, PRINTED_K, PRINTED_W, SCENES, by, comparisons,
                                    methods_of, read_theorem, times_of)


MISPRINTS = (  # what is changed, in which formulation; where, as printed, right
    (PRINTED_K, "algebra", "ISOSYRK, Kᵢⱼ", "h B(W̃ᵢ)(…)", "h B(W̃ⱼ)(…)"),
    (PRINTED_W, "group", "theorem, item 3", "Q W₀ J Q J⁻¹", "Q† W₀ J Q J⁻¹"),
    (None, None, "introduction, g", "W ∈ GL(n,ℂ)", "W ∈ M(n,ℂ)"))
NO_STEP = "no step"  # shown for a row whose Picard sweeps fail


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
        found += [[*texts, str(row.stages), scientific(row.difference("group–algebra")),
                   scientific(row.casimir_error(form)),
                   f"{row.order:.1f}, {orders[row.stages]:.1f}" if row.order and orders.get(row.stages) else MISSING]
                  for row in rows if row.changed == changed] or [[*texts, *[MISSING] * 4]]
    headings = ("s", "difference", "Casimirs", "orders")
    return plain_table((*lefts("where", "printed", "right"), *map(Column, headings)), found)


def rendered(raw, _recorded):
    """Returns the Rendering of a raw file."""
    study = read_theorem(raw)
    found = findings(study)
    return Rendering(lambda _: sections(study), figures(found), files={FILE: as_json("theorem", found)})
