"""A study of what a step of the fast forms costs as a document: charts and tables."""

from benchmark_json import FORMULATIONS
from comparison import MISSING, three_digits
from document import Column, Entry, Heading, Paragraph, Table, conditions, shown
from scaling import BY_DEFAULT, PUBLISHED, ladder

CHARTS = (
    ("cost_against_n", "A step of each fast form against n, and the floor of its products."),
    ("ladder_of_ideas", "What each idea bought, from the published form to the fast one."),
)


def scaling_sections(study, charts, level=1):
    """Returns the document; `charts` are the names of the charts beside it."""
    return [
        Heading("What a step of the fast forms costs", level),
        Paragraph(f"Steps at n = {', '.join(map(str, study.sizes()))} such that h‖B(W₀)‖₂ = {study.h_norm_B:g}, with"
                  f" {study.kernels} kernels, on one core."),
        *shown(CHARTS[:1], charts),
        *floor_section(study, level + 1),
        Heading("What each idea bought", level + 1),
        *shown(CHARTS[1:], charts),
        *ladder_section(study),
        *rest_section(study, level + 1),
        conditions(study.context),
    ]


def floor_section(study, level):
    columns = (Column("n"), Column("formulation", align="left"),
               *(Column(f"s = {s}", group) for group in ("share of the floor", "share of the products")
                 for s in study.stage_counts()))
    blocks = []
    for n in study.sizes():
        rows = []
        for formulation in FORMULATIONS:
            points = {point.stages: point for s in study.stage_counts() for point in study.line(formulation, s)
                      if point.n == n}
            texts = [share(points.get(s), part) for part in (lambda point: point.floor, lambda point: point.cubic)
                     for s in study.stage_counts()]
            rows.append([Entry(str(n) if not rows else ""), Entry(formulation), *map(Entry, texts)])
        blocks.append(rows)
    return [Heading("The floor", level),
            Paragraph("Of the time of a step: the share that its products would take at the measured peak of the core, and"
                      " the share that they take at the rate of products alone."),
            Table(columns, blocks)]


def share(point, part):
    return MISSING if point is None else f"{100 * part(point) / point.seconds:.0f} %"


def ladder_section(study):
    columns = (Column("n"), Column("s"), Column("formulation", align="left"), Column("with", align="left"), Column("sweeps"),
               Column("full products"), Column("time"), Column("times as fast"))
    blocks = []
    for n in study.idea_sizes():
        for s in study.stage_counts():
            rows = []
            for formulation in FORMULATIONS:
                cell = study.ideas.get((formulation, n, s))
                rungs = ladder(cell) if cell else []
                for index, (idea, cost) in enumerate(rungs):
                    rows.append([Entry(str(n) if not rows else ""), Entry(str(s) if not rows else ""),
                                 Entry(formulation if index == 0 else ""), Entry(idea if index == 0 else f"+ {idea}"),
                                 *figures_of(cost), Entry(three_digits(rungs[0][1].seconds / cost.seconds))])
            blocks.append(rows)
    return [Paragraph("Each row has one idea more than the one above. Sweeps, products and CPU seconds are those of a step,"
                      " at h = 0.1, once start values have all their past steps; the last column compares with the published form."),
            Table(columns, [block for block in blocks if block])]


def figures_of(cost):
    return Entry(three_digits(cost.sweeps)), Entry(three_digits(cost.products)), Entry(three_digits(cost.seconds))


def rest_section(study, level):
    """Ideas apart from the ladder: what each would change where it is not, or in place of what is, the default."""
    columns = (Column("n"), Column("s"), Column("formulation", align="left"), Column("instead", align="left"),
               Column("sweeps"), Column("full products"), Column("time"), Column("of the default"))
    blocks = []
    for (formulation, n, s), cell in sorted(study.ideas.items(), key=lambda item: (item[0][1], item[0][2])):
        default = cell[BY_DEFAULT]
        rows = []
        for idea, cost in cell.items():
            if idea in (PUBLISHED, BY_DEFAULT) or cost.rung:
                continue
            rows.append([Entry(str(n) if not rows else ""), Entry(str(s) if not rows else ""),
                         Entry(formulation if not rows else ""), Entry(idea),
                         *figures_of(cost), Entry(three_digits(cost.seconds / default.seconds))])
        if rows:
            blocks.append(rows)
    if not blocks:
        return []
    return [Heading("What did not pay, or only here", level),
            Paragraph("Other choices in place of the default's, one at a time; the last column is their time over the"
                      " default's, above 1 where they are slower."),
            Table(columns, blocks)]
