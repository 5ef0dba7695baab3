"""verdicts.json and claims.json say the same of the paper's claims on speed, each from its own judge.

Pages and tables show these two: test_recorded renders them anew.
"""

import json
import os
import unittest

from programs import ROOT, text_of

from studies.claims.judge import read_claims_table

RECORDED = os.path.join(ROOT, "results", "recorded")
CODES = {"published": "plain", "fast": "optimised"}  # of claims.json, by implementation


def said_by_verdicts(document):
    """Returns the result and the ratio by (claim, s, n, code)."""
    return {(each["claim"], each["s"], each["n"], CODES[each["implementation"]]): (each["result"], each["ratio"])
            for each in document["claims"]}


def said_by_claims(rows):
    return {(row.claim[1], row.stages, int(each.where.removeprefix("n = ")), code): (each.result, each.ratio)
            for row in rows if row.claim in ("(a)", "(b)", "(c)") for code in CODES.values()
            for each in row.findings.get(code, ())}


def differences(one, other):
    """Returns the keys of which they say another thing, or only one of them something."""
    return {key for key in {*one, *other} if key not in one or key not in other or one[key][0] != other[key][0]
            or abs(one[key][1] / other[key][1] - 1) > 1e-4}


class Agreement(unittest.TestCase):
    def test_both_say_the_same(self):
        verdicts = said_by_verdicts(json.loads(text_of(RECORDED, "tables", "verdicts.json")))
        claims = said_by_claims(read_claims_table(os.path.join(RECORDED, "claims", "claims.json"))[0])
        self.assertEqual(len(verdicts), 4 * 4 * 2)  # claims with their s, n, and codes
        self.assertEqual(differences(verdicts, claims), set())
        # Controls: another result, another ratio, and one that is missing.
        key = next(iter(verdicts))
        result, ratio = verdicts[key]
        for wrong in ({key: ("undecided", ratio)}, {key: (result, 1.01 * ratio)}):
            self.assertEqual(differences({**verdicts, **wrong}, claims), {key})
        del verdicts[key]
        self.assertEqual(differences(verdicts, claims), {key})


if __name__ == "__main__":
    unittest.main()
