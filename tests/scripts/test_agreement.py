"""Pages and data say the same of the paper's claims: README.md, results/README.md, the pages of the tables,
verdicts.json and claims.json.

Each place is read into one form: from (claim, s, n, code) to its result and its ratio with three digits. The table of
results/README.md has results by n, but of the ratios the range: in_ranges() gives that of the others.
"""

import json
import os
import re
import unittest

from programs import ROOT, text_of

from studies.claims.judge import read_claims_table
from lib.pages.numbers import three_digits

RECORDED = os.path.join(ROOT, "results", "recorded")
CODES = {"published": "plain", "fast": "optimised"}  # of the pages of tables, by implementation
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
    head, *rows = rows_of(text, "claim")
    sizes = [int(name.removeprefix("n = ")) for name in head[4:]]
    found, claim, stages = {}, None, None
    for name, s, _, code, *cells in rows:
        claim, stages = (name[1], int(s)) if name else (claim, stages)
        found.update({(claim, stages, n, CODES[code]): tuple(cell.split()) for n, cell in zip(sizes, cells)})
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


def said_by_table_of_claims(text):
    """Returns what the table of all claims says of plain and optimised code, as in_ranges() does."""
    head, *rows = rows_of(text, "claim")
    found = {}
    for label, stages, *cells in rows:
        for name, code in CODES.items():
            said = re.match(r"(.*?) ?([0-9.]+(?:–[0-9.]+)?)$", cells[head.index(name) - 2])
            places = re.findall(r"(\w+) \(n = ([0-9, ]+)\)", said[1])
            by_n = {int(n): result for result, sizes in places for n in sizes.split(", ")}
            found[label[1], int(stages), code] = by_n or {None: said[1]}, said[2]
    return found


def in_ranges(said):
    """Returns what a place says as (claim, s, code): results by n, or the one of them all, and the range of ratios."""
    found = {}
    for (claim, stages, n, code), (result, ratio) in said.items():
        by_n, ratios = found.setdefault((claim, stages, code), ({}, []))
        by_n[n] = result
        ratios.append(ratio)
    return {key: (by_n if len(set(by_n.values())) > 1 else {None: next(iter(by_n.values()))},
                  "–".join(dict.fromkeys((min(ratios, key=float), max(ratios, key=float)))))
            for key, (by_n, ratios) in found.items()}


def sayings():
    """Returns what each place says, by its name."""
    found = {"README.md": said_by_page(text_of(ROOT, "README.md"))}
    tables = {code: said_by_table(text_of(RECORDED, "tables", f"{table}.md"), code)
              for table, code in (("table1", "plain"), ("table2", "optimised"))}
    found["table1.md and table2.md"] = {**tables["plain"], **tables["optimised"]}
    found["verdicts.json"] = said_by_verdicts(json.loads(text_of(RECORDED, "tables", "verdicts.json")))
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

    def test_the_table_of_all_claims_says_the_same(self):
        page = text_of(ROOT, "results", "README.md")
        wanted = in_ranges(sayings()["README.md"])
        self.assertEqual(len(wanted), 4 * 2)
        self.assertEqual(said_by_table_of_claims(page), wanted)
        head, name, rest = page.partition("| (a) ")
        row, end, rest = rest.partition("\n")
        for said, other in (("holds ", "fails "), (r"\) ([0-9.]+)–", r") 1\1–"), (r"tie \(", "undecided (")):
            edited = head + name + re.sub(said, other, row) + end + rest
            self.assertNotEqual(said_by_table_of_claims(edited), wanted, said)

    def test_each_place_can_be_wrong(self):
        found = sayings()
        for name in list(found)[1:]:
            key = next(iter(found[name]))
            for other in (("undecided", found[name][key][1]), (found[name][key][0], "9.99"), None):
                with self.subTest(place=name, other=other):
                    self.assertEqual(differences({**found, name: {**found[name], key: other}}), [(name, key)])

    def test_a_page_that_was_edited_is_seen(self):
        page = text_of(ROOT, "README.md")
        head, marker, rest = page.partition("| claim ")
        edited = head + marker + re.sub(r"\| (?:holds|fails|tie) +(\d)", r"| undecided \1", rest, count=1)
        self.assertEqual(len(differences({"as it is": said_by_page(page), "edited": said_by_page(edited)})), 1)


if __name__ == "__main__":
    unittest.main()
