"""Tables 1 and 2: times with their intervals, verdicts, and the time of each formulation over that of group."""

from typing import NamedTuple

from lib.judging.verdicts import MARGIN
from lib.pages.chart_panels import FORMULATION_COLOURS, mixed
from lib.pages.document import as_markdown
from lib.pages.integrate_line import formulation_line
from lib.records.formats import FAST, FORMULATIONS, PUBLISHED
from lib.records.settings import TABLE1_STEP
from report_page.charts import FILLED, OPEN, Axis, Chart, Column, Selector, as_plotly, options_of
from studies.tables.charts import BASE, PAPER_LIGHTER, STYLES, relative
from studies.tables.comparison import STAGES, read_published, times_section
from studies.tables.paper import PUBLISHED as PAPER_SECONDS
from studies.tables.paper import beside_the_paper, claims_section, pairs_section
from studies.tables.report import OF_EVERY_ROW, TABLES

TIME = 5.0  # T of a cell
HEADINGS = {"table1": "Table 1: published forms, CPU seconds", "table2": "Table 2: fast forms, CPU seconds"}
PAPER = "paper"  # the side of its seconds
WORDS = "The 50-step run (T = 5, h = 0.1) with the s-stage Gauss method. Bold: fastest, or a tie with it."


def comparisons(path):
    """Returns the Comparison of each table in a raw file, by implementation; that of table1 has no fast forms."""
    found = {PUBLISHED: beside_the_paper(path, TABLES[PUBLISHED], OF_EVERY_ROW[PUBLISHED])}
    if found[PUBLISHED].run.context["isosyrk_program"] == TABLES[FAST]:
        found[FAST] = beside_the_paper(path, TABLES[FAST], OF_EVERY_ROW[FAST])
    return found


class Shown(NamedTuple):
    """Parts of a section as Markdown."""

    tables: str  # with the verdicts on the paper's claims
    rules: str  # of verdicts
    pairs: str  # of rows


def tables(found):
    """Returns what is Shown of some Comparisons."""
    shown, pairs = [], []
    for implementation, comparison in found.items():
        shown += times_section(comparison, HEADINGS[TABLES[implementation]], WORDS)
        heading, *rules, verdicts = claims_section(comparison)
        shown += [heading._replace(text=f"{heading.text}, by {implementation} forms", level=3), *rules[:1], verdicts]
        heading, *rest = pairs_section(comparison)
        pairs += [heading._replace(text=f"{heading.text}, {implementation} forms", level=3), *rest]
    return Shown(*map(as_markdown, (shown, rules[1:], pairs)))


def formulations(found):
    """Returns the Chart of the time of each formulation over that of group, against n."""
    sides = {PAPER: read_published(PAPER_SECONDS), **{each: one.run for each, one in found.items()}}
    rows = [(name, side, stages, n, over) for side, run in sides.items() for name in FORMULATIONS if name != BASE
            for stages in STAGES for n, over in relative(run, name, stages)]
    has_interval = [0 < over.low and over.high < float("inf") for *_, over in rows]

    def seconds(name, side, stages, n):
        return sides[side].cell(name, n, stages).seconds

    def line(name, side, stages, n):
        return formulation_line(n, name, stages, TABLE1_STEP, TIME, side) if side in (PUBLISHED, FAST) else ""

    cells = [row[:4] for row in rows]
    return Chart(
        "tables", f"Time of a formulation over that of {BASE}", Axis("n", "n", has_ticks=True),
        Axis("ratio", f"time over that of {BASE}"),
        {"formulation": Column("formulation", [name for name, *_ in rows]),
         "side": Column("code", [side for _, side, *_ in rows]),
         "stages": Column("stages s", [stages for _, _, stages, *_ in rows]),
         "n": Column("n", [n for _, _, _, n, _ in rows]),
         "seconds": Column("CPU seconds", [seconds(*cell) for cell in cells]),
         "ratio": Column(f"over {BASE}", [over.ratio for *_, over in rows]),
         "low": Column("95 % from", [over.low if known else None for (*_, over), known in zip(rows, has_interval)]),
         "high": Column("to", [over.high if known else None for (*_, over), known in zip(rows, has_interval)]),
         "series": Column("", [f"{name}, {side}" for name, side, *_ in rows])},
        (Selector("stages", "stages s", options_of(STAGES), len(STAGES) - 1),),
        {f"{name}, {side}": look_of_side(name, side) for name in FORMULATIONS if name != BASE for side in sides},
        [line(*cell) for cell in cells], bars=("low", "high"), band=(1 / MARGIN, MARGIN),
        note="Light with circles and diamonds: the seconds that the paper prints. Thin: published forms. Thick: fast"
             f" forms. Bars: 95 % intervals over processes. Shaded: a tie with {BASE}.")


def look_of_side(name, side):
    colour = FORMULATION_COLOURS[name][0]
    marks = ("o", "D") if side == PAPER else ("s", "^")
    return as_plotly({"color": mixed(colour, "white", PAPER_LIGHTER) if side == PAPER else colour, "markersize": 4,
                      **STYLES[side], "marker": marks[name != FORMULATIONS[0]]}, fill=FILLED if side == FAST else OPEN)
