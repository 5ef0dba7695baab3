"""README.md, results/README.md and results/simulate.md, each rendered from its template, which has .in behind its name.

Sentences stand in the templates; figures and tables come from results/recorded. lib/pages/templates.py says how a
template is written, and names() what it may look up. Needs Jinja2.
"""

import os
from functools import partial

from lib.pages.document import Column, Entry, Table, as_markdown, plain_table
from lib.pages.numbers import MISSING, three_digits
from lib.pages.templates import Figures, page, recorded_figures
from lib.programs.output import keep
from lib.programs.places import ROOT
from lib.records.formats import FAST, PUBLISHED
from studies.claims.judge import range_text, read_claims_table, results_text
from studies.tables.judge import CLAIMS, judged
from studies.tables.paper import beside_the_paper

RAW = os.path.join("results", "recorded", "tables", "raw.json")
ALL_CLAIMS = os.path.join("results", "recorded", "claims", "claims.json")
SHORT = {"a": "algebra is fastest", "b": "group is fastest", "c": "algebra over twice the best"}  # claims
CLAIM_NAMES = [f"({label})" for label in SHORT]  # in claims.json
CODES = {"paper": "paper's MATLAB", "octave": "Octave", "plain": PUBLISHED, "optimised": FAST}  # of claims.json
PAPER = "paper"  # whose printed seconds have no verdict
JUDGED = ("octave", "plain", "optimised", "plain_avx2", "optimised_avx2")


def table_of_verdicts():
    """Returns the verdicts on the paper's claims, by published and by fast code, beside the range of its own ratios."""
    published, fast = (beside_the_paper(os.path.join(ROOT, RAW), table, ()) for table in ("table1", "table2"))
    runs = {PAPER: published.published, PUBLISHED: published.run, FAST: fast.run}
    sizes = published.sizes()
    found = {(code, each.claim.label, each.stages, n): each for code, run in runs.items() for n in sizes
             for each in judged(run, n)}
    blocks = []
    for claim in CLAIMS:
        for stages in claim.stages:
            cells = {code: [found.get((code, claim.label, stages, n)) for n in sizes] for code in runs}
            heads = [f"({claim.label}) {SHORT[claim.label]}", str(stages),
                     range_text([each.ratio.ratio for each in cells.pop(PAPER) if each])]
            blocks.append([[*map(Entry, heads if code == PUBLISHED else [""] * len(heads)), Entry(code),
                            *(Entry(cell_text(each)) for each in row)] for code, row in cells.items()])
    columns = (Column("claim", align="left"), Column("s"), Column("paper"), Column("code", align="left"),
               *(Column(f"n = {n}", align="left") for n in sizes))
    return as_markdown([Table(columns, blocks)]).strip()


def cell_text(found):
    """Writes a claim's result and ratio."""
    return f"{found.result} {three_digits(found.ratio.ratio)}" if found else MISSING


def table_of_claims(rows):
    """Returns what became of the claims on speed, by each code: the results by n and the range of ratios."""
    columns = (Column("claim", align="left"), Column("s"), *(Column(name, align="left") for name in CODES.values()))
    return as_markdown([plain_table(columns, [
        [f"{row.claim} {SHORT[row.claim[1]]}", str(row.stages),
         *(findings_text(row.findings.get(code)) for code in CODES)]
        for row in rows if row.claim in CLAIM_NAMES])]).strip()


def findings_text(findings):
    """Writes the results by n and the range of ratios."""
    if not findings:
        return MISSING
    return f"{results_text(findings)} {range_text([each.ratio for each in findings])}".strip()


def verdicts_by_code(rows):
    """Returns the results of the claims on speed, by code and by keys such as "b.s3.n33"."""
    return {code: Figures(ALL_CLAIMS, {f"{row.claim[1]}.s{row.stages}.{each.where.replace(' = ', '')}": each.result
                                       for row in rows if row.claim in CLAIM_NAMES
                                       for each in row.findings.get(code, ())})
            for code in JUDGED}


PAGES = ("README.md", os.path.join("results", "README.md"), os.path.join("results", "simulate.md"))


def names():
    """Returns what templates look up: figures by study, verdicts by code, tables, and whether a file exists."""
    rows, _ = read_claims_table(os.path.join(ROOT, ALL_CLAIMS))
    return {**recorded_figures(ROOT), "verdicts": verdicts_by_code(rows), "table_of_verdicts": table_of_verdicts,
            "table_of_claims": partial(table_of_claims, rows),
            "exists": lambda path: os.path.exists(os.path.join(ROOT, path))}


def update(check):
    """Writes the pages; with `check` throws Stop, with status 1, where one is another than its template gives."""
    found = names()
    for each in PAGES:
        text = page(ROOT, f"{each}.in", found)
        keep(check, os.path.join(ROOT, each), lambda _, text=text: text,
             f"{each} is not what {each}.in and results/recorded give; run scripts/update")
