"""Tables 1 and 2 as documents, from the raw file of table1 or of table2 --published."""

from lib.records.formats import FORMULATIONS
from lib.judging.verdicts import fastest, ratio_of
from lib.pages.document import Column, Entry, Heading, Paragraph, Table, as_markdown
from lib.pages.numbers import MISSING
from lib.pages.rendering import Rendering, render_table, verdicts_text
from studies.tables.comparison import STAGES, ratio_text, ratios_section, read_published, times_section
from studies.tables.judge import figures, verdict_data
from studies.tables.paper import COUNTERS, PUBLISHED, beside_the_paper, closing_sections

SHOWN_OF_TABLE1 = ("sweeps_per_step", "relative_error", "spectrum_error", "product_share", "skew_defect",
                   "energy_error", "h_norm_B")
SHOWN_OF_TABLE2 = ("sweeps_per_step", "equivalent_products", "relative_error", "spectrum_error", "product_share",
                   "energy_error")
TABLES = {"published": "table1", "fast": "table2"}  # whose rows are of which implementation
OF_EVERY_ROW = {"published": ("products", "product_share"),
                "fast": ("products", "product_share", "equivalent_products")}


def runs_of(path, implementations=tuple(TABLES)):
    """Returns the Runs in a raw file by implementation, "published" and "fast"."""
    return {each: beside_the_paper(path, TABLES[each], OF_EVERY_ROW[each]).run for each in implementations}


def table1(path):
    """Returns Table 1 made from the raw file at `path`, as a document."""
    comparison = beside_the_paper(path, "table1")
    return [
        Heading("Table 1: three formulations of isospectral symplectic Runge–Kutta methods", 1),
        *times_section(comparison, "CPU seconds", "The 50-step run (T = 5, h = 0.1) with the s-stage Gauss method."),
        *ratios_section(comparison),
        *closing_sections(comparison, SHOWN_OF_TABLE1),
    ]


def table2(path):
    """Returns Table 2 made from the raw file at `path`, as a document."""
    fast = beside_the_paper(path, "table2", (*COUNTERS, "equivalent_products"))
    published = beside_the_paper(path, "table1")
    return [
        Heading("Table 2: the same answers by the fast form of each formulation", 1),
        *times_section(fast, "CPU seconds", "The 50-step run (T = 5, h = 0.1) with the s-stage Gauss method, the first"
                       " steps started cold."),
        *gains_section(fast, published),
        *ratios_section(fast),
        *closing_sections(fast, SHOWN_OF_TABLE2),
    ]


def gains_section(fast, published):
    """How often each cell's published time holds its fast time, and each block's fastest row the fastest fast one."""
    def block(n):
        rows = [*((name, [Entry(gain(published, fast, n, stages, name)) for stages in STAGES])
                  for name in FORMULATIONS),
                ("fastest row", [marked(gain(published, fast, n, stages)) for stages in STAGES])]
        return [[Entry("" if index else str(n)), Entry(name), *entries] for index, (name, entries) in enumerate(rows)]

    columns = (Column("n"), Column("formulation", align="left"), *(Column(f"s = {stages}") for stages in STAGES))
    return [Heading("Table 1 over Table 2"),
            Paragraph("Time of the published form, with the faster library's products, over that of the fast form, both"
                      " measured interleaved: geometric means over processes with their interval. The last row of a"
                      " block: the fastest published row over the fastest fast one."),
            Table(columns, list(map(block, fast.sizes())))]


def marked(text):
    """Returns an entry that is marked where there is something to mark."""
    return Entry(text, text != MISSING)


def gain(published, fast, n, stages, name=None):
    """Writes the ratio of a row, or of the fastest rows of both sides, with its interval."""
    before, after = (side.run.times(n, stages) for side in (published, fast))
    if not before or not after or name not in (None, *before.keys() & after.keys()):
        return MISSING
    slow, quick = before[name or fastest(before)], after[name or fastest(after)]
    return ratio_text(ratio_of(slow, quick)) if len(slow) == len(quick) else MISSING


DESCRIPTIONS = {
    "table1": "Renders a raw file of table1 or table2: our Table 1 beside the paper's, ratios, and verdicts.",
    "table2": "Renders a raw file of table2: the fast forms beside the published ones and the paper, and verdicts."}


def render_one(program, name, arguments):
    """Renders one of the two tables, in the format that the arguments ask for."""
    table, implementations = {"table1": (table1, ("published",)), "table2": (table2, tuple(TABLES))}[name]
    render_table(program, DESCRIPTIONS[name], table, lambda raw: verdict_data(runs_of(raw, implementations)), arguments)


def rendered(raw, _recorded):
    """Returns the Rendering of a raw file of table2 --published: both tables, their verdicts and their chart."""
    runs, paper = runs_of(raw), read_published(PUBLISHED)
    from studies.tables.charts import formulations  # only now: it needs matplotlib

    files = {f"{table.__name__}.md": as_markdown(table(raw)).encode("utf-8") for table in (table1, table2)}
    files["verdicts.json"] = verdicts_text(verdict_data(runs)).encode("utf-8")
    return Rendering(None, figures({"paper": paper, "plain": runs["published"], "optimised": runs["fast"]}),
                     {"formulations": formulations(runs["published"], runs["fast"], paper)}, files)
