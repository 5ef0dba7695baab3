"""The figures of a study that pages look up, by key: figures.json, which its renderer writes beside its report.

Programs read findings.json (lib/records/findings.py).
"""

import json
import math

from lib.programs.messages import UnusableFile
from lib.records.findings import DIGITS
from lib.records.formats import checked, finite, read_json

FILE = "figures.json"


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
