"""Tables 1 and 2 as documents, from the raw file of table1 or of table2 --published."""

from lib.comparison import MISSING, STAGES, ratio_text, ratios_section, times_section
from lib.document import Column, Entry, Heading, Paragraph, Table
from lib.formats import FORMULATIONS
from lib.paper_table import COUNTERS, beside_the_paper, closing_sections
from lib.verdicts import fastest, ratio_of

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
                ("fastest row", [Entry(gain(published, fast, n, stages), True) for stages in STAGES])]
        return [[Entry("" if index else str(n)), Entry(name), *entries] for index, (name, entries) in enumerate(rows)]

    columns = (Column("n"), Column("formulation", align="left"), *(Column(f"s = {stages}") for stages in STAGES))
    return [Heading("Table 1 over Table 2"),
            Paragraph("Time of the published form, with the faster library's products, over that of the fast form, both"
                      " measured in turns: geometric means over processes with their interval. The last row of a block:"
                      " the fastest published row over the fastest fast one."),
            Table(columns, list(map(block, fast.sizes())))]


def gain(published, fast, n, stages, name=None):
    """Writes the ratio of a row, or of the fastest rows of both sides, with its interval."""
    before, after = (side.run.times(n, stages) for side in (published, fast))
    if not before or not after or name not in (None, *before.keys() & after.keys()):
        return MISSING
    slow, quick = before[name or fastest(before)], after[name or fastest(after)]
    return ratio_text(ratio_of(slow, quick)) if len(slow) == len(quick) else MISSING
