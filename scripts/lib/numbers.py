"""How reports write numbers; comparison has how Table 1 writes them."""

from lib.comparison import three_digits


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
