"""The figures that a study found, by key, and the check that a page prints them as they are.

The renderer of a study writes `figures.json` beside its report: one object, from keys to numbers. Pages are written by
hand. After each figure, or after a few of them, a page names their keys in a comment, which no reader sees:

    takes 0.69, 0.94 and 1.2<!-- accuracy:price.n17 accuracy:price.n33 accuracy:price.n65 --> times as long

`accuracy:` names the folder of figures.json under results/recorded. Between one such comment and the next stand as many
figures as the second has keys, in their order. A figure is any number that EXCEPTED does not excuse. It is compared
with as many digits as are printed; before % it is a hundred times the figure.

Checked is what stands between <!-- figures:begin --> and <!-- figures:end -->, or all of a page. What scripts write
between other markers, <!-- NAME:begin --> and <!-- NAME:end -->, never is.
"""

import json
import math
import os
import re
from decimal import ROUND_HALF_EVEN, Decimal

from lib.programs.messages import UnusableFile
from lib.records.formats import LARGEST, checked, is_number, kind_of, read_json

FILE = "figures.json"
DIGITS = 6  # that are written: the last ones of a double depend on the machine

finite = kind_of("a finite number", lambda value: is_number(value, -LARGEST))

KEYS = re.compile(r"<!--((?:\s+[a-z0-9_]+:[\w.+-]+)+)\s+-->")
MARKER = re.compile(r"<!-- ([a-z0-9_.]+):(begin|end) -->")
NUMBER = re.compile(r"(?<![\w.])[-−+]?[0-9]+(?:,[0-9]{3})*(?:\.[0-9]+)?(?:e[-+]?[0-9]+)?(?:\s?%)?")

# ---- what needs no key

VALUE = r"[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?"
# A further value of a list must end there: in "n = 129, 12 times" the second number is a figure.
ENDS = r"(?=\s*(?:[,;:)|…–]|\.(?![0-9])|$|(?:and|or|to)\b))"
SEPARATOR = r"(?:\s*(?:,|…|–)\s*(?:and\s+)?|\s+(?:and|or|to)\s+)"
RELATION = r"\s*(?:[=≤≥<>]|up\s+to)\s*"
POWERS = r"1e-[0-9]+(?![0-9]|\.[0-9])"
MONTHS = "January|February|March|April|May|June|July|August|September|October|November|December"
EXCEPTED = tuple(re.compile(pattern, re.MULTILINE) for pattern in (
    r"```[\s\S]*?(?:\n```|\Z)|`[^`]*`",  # code
    r"(?<=\])\([^)]*\)|https?://\S+",  # targets of links
    r"^\s*[0-9]+\. ",  # numbers of lists
    r"[A-Za-z]{1,2}\([0-9]+(?:,\s*[0-9]+)*\)|\b[A-Za-z]+-[0-9]+|[0-9]+(?:st|nd|rd|th)\b",  # W(5), so(3), AVX-512, 5th
    rf"(?<!\w)[nslmkNpq]{RELATION}[0-9]+(?:{SEPARATOR}[0-9]+{ENDS})*",  # n = 17, 33 and 65; s ≥ 2
    # h = 0.1, T = 5 and 50, a state at t = 5, h‖B‖₂ up to 0.6
    rf"(?<!\w)(?:[htT]|h‖B(?:\(W₀\))?‖₂?){RELATION}{VALUE}(?:\s+(?:and|or|to)\s+{VALUE}{ENDS})*",
    rf"\b[Tt]olerance(?:\s+of)?\s+{VALUE}",
    # the errors compared at
    rf"\b[Aa]t\s+(?:(?:an?\s+|equal\s+)?errors?\s+(?:of\s+)?)?{POWERS}(?:{SEPARATOR}{POWERS})*",
    rf"\b[Oo]rders?\s+[0-9]+(?:{SEPARATOR}[0-9]+{ENDS})*",
    rf"[0-9]{{1,2}}\s+(?:{MONTHS})\s+[0-9]{{4}}|(?:{MONTHS})\s+[0-9]{{4}}|[0-9]{{4}}-[0-9]{{2}}-[0-9]{{2}}",
    r"\bcommit\s+[0-9a-f]{7,40}\b|\b(?=[0-9a-f]*[a-f])(?=[0-9a-f]*[0-9])[0-9a-f]{7,40}\b",
    r"\b(?:Tables?|Figures?|[Ss]ections?)\s+[0-9]+(?:\s+(?:and|or|to)\s+[0-9]+)?",
    r"\b(?:GNU|GCC|Debian|Ubuntu|Python|Eigen|OpenBLAS)\s+[0-9][0-9.]*|C\+\+[0-9]+",
    r"[0-9]+\s+×\s+[0-9]+"))  # the shape of a matrix
PARAMETERS = ("n", "s", "h", "T", "N")  # head columns of tables whose entries need no key


# ---- the file


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


def recorded_figures(folder):
    """Returns the figures of every study that has a folder with figures.json under `folder`, by "study:key"."""
    return {f"{study}:{key}": value for study in sorted(os.listdir(folder))
            if os.path.exists(path := os.path.join(folder, study, FILE)) for key, value in read_figures(path).items()}


# ---- the check of a page


def faults(page, figures, whole=False):
    """Returns what is wrong with a page, one line each: figures that are not as printed, or have no key.

    `figures` are by "study:key". `whole` checks all of the page, else what it marks is. Throws ValueError for a marker
    without its other.
    """
    text = checked_part(page, whole)
    numbers = NUMBER.finditer(without_exceptions(KEYS.sub(masked, text)))
    found, waiting = [], []
    for token in sorted([*KEYS.finditer(text), *numbers], key=lambda match: match.start()):
        if token.re is NUMBER:
            waiting.append(token)
            continue
        keys = token[1].split()
        if len(keys) == len(waiting):
            found += [f"line {line_of(text, number.start())}: {fault}" for number, key in zip(waiting, keys)
                      if (fault := fault_of(number[0], key, figures))]
        else:
            found.append(f"line {line_of(text, token.start())}: {printed(waiting)} before {', '.join(keys)}")
        waiting = []
    if waiting:
        found.append(f"line {line_of(text, waiting[0].start())}: {printed(waiting)} without a key")
    return found


def printed(numbers):
    return ", ".join(number[0].strip() for number in numbers) or "no figure"


def line_of(text, place):
    return text.count("\n", 0, place) + 1


def fault_of(text, key, figures):
    """Returns what is wrong with a printed figure, or None."""
    if key not in figures:
        return f"{key} is in no {FILE}"
    number, percent = re.fullmatch(r"(.*?)(\s?%)?", text).groups()
    value = figures[key] * 100 if percent else figures[key]
    if reads(number.replace(",", "").replace("−", "-"), value):
        return None
    return f"{text} is printed where {key} is {number_text(value)}{percent or ''}"


def reads(text, value):
    """Tells whether a value, rounded to the digits of a printed number, is that number."""
    shown = Decimal(text)
    exact = Decimal(number_text(value))
    if "e" in text:  # as many digits as the mantissa has, whatever the power of ten
        digits = len(text.split("e")[0].lstrip("-+").replace(".", ""))
        return Decimal(f"{exact:.{digits - 1}e}") == shown
    return exact.quantize(Decimal(1).scaleb(shown.as_tuple().exponent), ROUND_HALF_EVEN) == shown


# ---- what is looked at, with all else made blank so that lines stay where they are


def blank(match):
    return re.sub(r"[^\n]", " ", match[0])


def masked(match):
    """Puts letters of no alphabet in the place of a comment with keys, which no pattern then matches across."""
    return re.sub(r"[^\n]", "\ue000", match[0])


def checked_part(page, whole):
    """Returns a page with all that is not to be checked made blank. Throws ValueError for a lone marker."""
    kept, inside, at = [], None, 0

    def keep(end):
        stretch = re.match(r"[\s\S]*", page[at:end])
        is_checked = inside == "figures" or whole and inside is None
        kept.append(stretch[0] if is_checked else blank(stretch))

    for marker in MARKER.finditer(page):
        name, which = marker.groups()
        if inside != (None if which == "begin" else name):
            raise ValueError(f"line {line_of(page, marker.start())}: {marker[0]} is out of place")
        keep(marker.start())
        kept.append(blank(marker))
        inside, at = (name if which == "begin" else None), marker.end()
    if inside:
        raise ValueError(f"<!-- {inside}:end --> is missing")
    keep(len(page))
    return "".join(kept)


def without_exceptions(text):
    """Returns a text with the numbers that need no key made blank, and comments."""
    text = without_parameters(re.sub(r"<!--[\s\S]*?-->", blank, text))
    for pattern in EXCEPTED:
        text = pattern.sub(blank, text)
    return text


def without_parameters(text):
    """Makes blank the columns of tables that are headed by a parameter, as n."""
    lines, columns = text.split("\n"), ()
    for index, line in enumerate(lines):
        if not line.startswith("|"):
            columns = ()
        elif index + 1 < len(lines) and re.fullmatch(r"\|(?:\s*:?-+:?\s*\|)+\s*", lines[index + 1]):
            columns = [number for number, cell in enumerate(line.split("|")) if cell.strip() in PARAMETERS]
        elif columns:
            lines[index] = "|".join(" " * len(cell) if number in columns else cell
                                    for number, cell in enumerate(line.split("|")))
    return "\n".join(lines)
