"""What the tests of readers share: values that no field may have, and files damaged at random."""

import copy
import json
import math
import os
import random
import sys

from programs import ROOT

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
from benchmark_json import UnusableFile, parse_json  # noqa: E402

NAN, INFINITY = math.nan, math.inf
NO_NUMBERS = (None, True, "1", [], {}, NAN, INFINITY, -INFINITY, -1, -1e-30, 1e300, 10**400)
TOO_SMALL = (0, 5e-324, 1e-300)

# What no field of a kind may be, in the objects whose every field is read.
WRONG = {
    "text": (None, True, 7, [], {}, "", "two\nlines", "x" * 61),
    "formulation": (None, True, 7, [], {}, "", "group1", "quotient"),
    "truth": (None, 0, 1, "true", [], {}, NAN),
    "not negative": NO_NUMBERS,
    "positive": (*NO_NUMBERS, *TOO_SMALL),
    "optional": tuple(value for value in NO_NUMBERS if value is not None),
    "count": (*NO_NUMBERS, 1.5, 1.0, 10**15),
    "positive count": (*NO_NUMBERS, 1.5, 1.0, 10**15, 0),
    "casimirs": (None, True, 1, "1", {}, [], [1e-15] * 3, [1e-15] * 5, [1e-15, 1e-15, 1e-15, NAN],
                 [1e-15, 1e-15, 1e-15, -1], [1e-15, 1e-15, 1e-15, None], [1e-15, 1e-15, 1e-15, INFINITY]),
    "times": (None, True, 1, "1", {}, [], [0], [1, -1], [1, NAN], [1, INFINITY], [1, "1"], [1, None],
              [1e300], [1e-300]),
    "object": (None, True, 1, "group5", [], {}),
}

STRANGE = (None, True, 0, -1, 1, 2, 17, 10**14, 10**30, 10**400, 0.5, 1e-320, 1e308, NAN, INFINITY, -INFINITY, "", "x",
           "converged", "unstable", "group2", "a\nb", "\ud800", [], [1.0], [NAN], [[]], {}, {"n": 17})


def containers(value):
    """Returns every list and object inside a JSON value, itself included."""
    inside = value.values() if isinstance(value, dict) else value if isinstance(value, list) else None
    if inside is None:
        return []
    return [value] + [found for each in inside for found in containers(each)]


def mutate(document, choose):
    """Damages one place of a document: a value replaced, removed, doubled, or swapped with a neighbour."""
    place = choose.choice([each for each in containers(document) if each])
    keys = list(place) if isinstance(place, dict) else list(range(len(place)))
    key, other = choose.choice(keys), choose.choice(keys)
    kind = choose.choice(("replace", "replace", "remove", "swap", "double"))
    if kind == "replace":
        place[key] = copy.deepcopy(choose.choice(STRANGE))
    elif kind == "remove":
        del place[key]
    elif kind == "swap":
        place[key], place[other] = place[other], place[key]
    elif isinstance(place, list):
        place.insert(other, copy.deepcopy(place[key]))
    else:
        place[f"{key}2"] = copy.deepcopy(place[key])


class DamageTests:
    """Damaged files are refused as unusable or are sound enough to analyse: nothing else is ever raised.

    A test case of a reader derives from this too; its document() returns a small sound document, and its analyse(document)
    reads one and does with it whatever is done with one.
    """

    cases = 1500

    def outcome(self, text):
        """Returns whether a damaged text was accepted; the analysis of what was accepted must not raise either."""
        try:
            self.analyse(parse_json(text))
        except UnusableFile as problem:
            self.assertNotIn("\n", str(problem))
            self.assertLess(len(str(problem)), 300)
            return False
        return True

    def assert_both_outcomes(self, outcomes):
        """A generator that is always refused, or never, tries nothing."""
        self.assertGreater(outcomes.count(True), len(outcomes) // 100)
        self.assertGreater(outcomes.count(False), len(outcomes) // 100)

    def test_damaged_values(self):
        choose = random.Random(1)
        text = json.dumps(self.document())
        outcomes = []
        for _ in range(self.cases):
            document = json.loads(text)
            for _ in range(choose.choice((1, 1, 2, 3))):
                mutate(document, choose)
            outcomes.append(self.outcome(json.dumps(document)))
        self.assert_both_outcomes(outcomes)

    def test_damaged_characters(self):
        choose = random.Random(2)
        text = json.dumps(self.document())
        outcomes = []
        for _ in range(self.cases):
            damaged = list(text)
            for _ in range(choose.choice((1, 1, 2))):
                damaged[choose.randrange(len(damaged))] = choose.choice('0123456789-+.eE"{}[],: \nxN\\\ud800é')
            outcomes.append(self.outcome("".join(damaged)))
        self.assert_both_outcomes(outcomes)
