"""How reports write numbers."""

import math

MISSING = "–"  # in place of a number


def three_digits(value):
    """Writes a number with three significant digits, plainly where that is short."""
    if value == 0:
        return "0"
    rounded = float(f"{value:.2e}")
    exponent = math.floor(math.log10(abs(rounded)))
    if not -5 < exponent < 6:
        return f"{value:.2e}"
    return f"{rounded:.{max(0, 2 - exponent)}f}"


def percentage(share):
    return f"{three_digits(100 * share)} %"


def scientific(value):
    """Writes an error with two digits, as 5.3e-4."""
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}" if value else "0"


def power(value):
    """Writes a power of ten or a multiple of one, as 1e-8."""
    return f"{value:.0e}".replace("e-0", "e-")


def two_digits(value):
    return f"{value:.2g}" if value < 99.5 else three_digits(value)


def span(values, write=two_digits):
    """Writes the smallest and the largest of some values, once where they read the same."""
    ends = [write(each) for each in (min(values), max(values))]
    return " to ".join(dict.fromkeys(ends))
