"""The figures that a study found, by key: the file figures.json, which its renderer writes beside its report."""

import json
import math

from lib.programs.messages import UnusableFile
from lib.records.formats import LARGEST, checked, is_number, kind_of, read_json

FILE = "figures.json"
DIGITS = 6  # that are written: the last ones of a double depend on the machine

finite = kind_of("a finite number", lambda value: is_number(value, -LARGEST))


def as_json(figures):
    """Returns figures.json, one figure a line, as bytes."""
    lines = (f"  {json.dumps(key)}: {number_text(figures[key])}" for key in sorted(figures))
    return ("{\n" + ",\n".join(lines) + "\n}\n").encode("utf-8")


def number_text(value):
    if not math.isfinite(value):
        raise ValueError(f"{value} is no figure")
    return str(value) if isinstance(value, int) else f"{value:.{DIGITS}g}"


def read_figures(path):
    """Returns the figures in a file, by key. Throws UnusableFile."""
    return read_json(path, figures_of)


def figures_of(document):
    if not isinstance(document, dict):
        raise UnusableFile("is no object of figures")
    return checked(document, dict.fromkeys(document, finite), "it")
