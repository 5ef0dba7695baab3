"""Values that no field of a kind may have, for the tests of readers."""

import math

NAN, INFINITY = math.nan, math.inf
NO_NUMBERS = (None, True, "1", [], {}, NAN, INFINITY, -INFINITY, -1, -1e-30, 1e300, 10**400)

# What no field of a kind may be, in the objects whose every field is read.
WRONG = {
    "text": (None, True, 7, [], {}, "", "two\nlines", "x" * 61),
    "truth": (None, 0, 1, "true", [], {}, NAN),
    "not negative": NO_NUMBERS,
    "positive": (*NO_NUMBERS, 0, 5e-324, 1e-300),
    "optional": tuple(value for value in NO_NUMBERS if value is not None),
    "count": (*NO_NUMBERS, 1.5, 1.0, 10**15),
    "positive count": (*NO_NUMBERS, 1.5, 1.0, 10**15, 0),
    "casimirs": (None, True, 1, "1", {}, [], [1e-15] * 3, [1e-15] * 5, [1e-15, 1e-15, 1e-15, NAN],
                 [1e-15, 1e-15, 1e-15, -1], [1e-15, 1e-15, 1e-15, None], [1e-15, 1e-15, 1e-15, INFINITY]),
    "object": (None, True, 1, "group5", []),
}
