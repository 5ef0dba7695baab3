"""Pages and data say the same of the paper's claims: README.md, results/README.md, the pages of the tables,
verdicts.json, and claims.json once the study of claims is recorded.

Each place is read into one form: from (claim, s, n, code) to its result and its ratio with three digits.
"""

import json
import os
import re
import unittest

from programs import ROOT, text_of

from lib.claims_table import read_claims_table
from lib.comparison import three_digits

RECORDED = os.path.join(ROOT, "results", "recorded")
CODES = {"published": "plain", "fast": "optimised"}  # by implementation
ALL_CLAIMS = os.path.join(RECORDED, "claims", "claims.json")


def rows_of(text, heading):
    """Returns the cells of the Markdown table whose head row begins with `heading`, that row included."""
    lines = text.splitlines()
    begin = next(number for number, line in enumerate(lines) if re.match(rf"\| +{re.escape(heading)} +\|", line))
    end = next((number for number in range(begin, len(lines)) if not lines[number].startswith("|")), len(lines))
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[begin:end]
            if not line.startswith("| :-")]


def said_by_page(text):
    """Returns what the table of verdicts of a page says. A row without a claim is of the claim above it."""
    verdicts = text.partition("<!-- verdicts:begin -->")[2].partition("<!-- verdicts:end -->")[0]
    head, *rows = rows_of(verdicts, "claim")
    sizes = [int(name.removeprefix("n = ")) for name in head[3:]]
    found, claim, stages = {}, None, None
    for name, s, code, *cells in rows:
        claim, stages = (name[1], int(s)) if name else (claim, stages)
        if code != "paper":
            found.update({(claim, stages, n, code): tuple(cell.split()) for n, cell in zip(sizes, cells)})
    return found


def said_by_table(text, code):
    """Returns what the table of claims of table1.md or table2.md says."""
    section = text.partition("## The paper's claims")[2]
    head, *rows = [row for row in rows_of(section, "n") if not row[0].startswith("-")]
    keys = [re.match(r"\((\w)\), s = (\d)", name).groups() for name in head[1:]]
    return {(claim, int(stages), int(n), code): tuple(cell.split(", "))
            for n, *cells in rows for (claim, stages), cell in zip(keys, cells)}


def said_by_verdicts(document):
    return {(each["claim"], each["s"], each["n"], CODES[each["implementation"]]):
            (each["result"], three_digits(each["ratio"])) for each in document["claims"]}


def said_by_claims(rows):
    """Returns what the Rows of claims.json say of plain and optimised code."""
    return {(row.claim[1], row.stages, int(each.where.removeprefix("n = ")), code):
            (each.result, three_digits(each.ratio))
            for row in rows if row.claim in ("(a)", "(b)", "(c)") for code in CODES.values()
            for each in row.findings.get(code, ())}


def sayings():
    """Returns what each place says, by its name."""
    found = {name: said_by_page(text_of(ROOT, name)) for name in ("README.md", os.path.join("results", "README.md"))}
    tables = {code: said_by_table(text_of(RECORDED, "tables", f"{table}.md"), code)
              for table, code in (("table1", "plain"), ("table2", "optimised"))}
    found["table1.md and table2.md"] = {**tables["plain"], **tables["optimised"]}
    found["verdicts.json"] = said_by_verdicts(json.loads(text_of(RECORDED, "tables", "verdicts.json")))
    if os.path.exists(ALL_CLAIMS):
        found["claims.json"] = said_by_claims(read_claims_table(ALL_CLAIMS)[0])
    return found


def differences(found):
    """Returns (place, key) wherever a place says another thing than the first one, or nothing."""
    first = next(iter(found.values()))
    return [(name, key) for name, said in found.items() for key in {*first, *said} if said.get(key) != first.get(key)]


class Agreement(unittest.TestCase):
    def test_every_place_says_the_same(self):
        found = sayings()
        self.assertGreaterEqual(len(found), 4)
        self.assertEqual(len(next(iter(found.values()))), 4 * 4 * 2)  # claims with their s, n, and codes
        self.assertEqual(differences(found), [])

    def test_each_place_can_be_wrong(self):
        found = sayings()
        for name in list(found)[1:]:
            key = next(iter(found[name]))
            for other in (("undecided", found[name][key][1]), (found[name][key][0], "9.99"), None):
                with self.subTest(place=name, other=other):
                    self.assertEqual(differences({**found, name: {**found[name], key: other}}), [(name, key)])

    def test_a_page_that_was_edited_is_seen(self):
        page = text_of(ROOT, "README.md")
        head, marker, rest = page.partition("<!-- verdicts:begin -->")
        edited = head + marker + re.sub(r"\| (?:holds|fails|tie) +(\d)", r"| undecided \1", rest, count=1)
        self.assertEqual(len(differences({"as it is": said_by_page(page), "edited": said_by_page(edited)})), 1)


if __name__ == "__main__":
    unittest.main()
