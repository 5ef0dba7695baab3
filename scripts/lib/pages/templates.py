"""Pages from templates: sentences by hand, figures looked up and rounded, and the conditions under which they are true.

A page such as README.md is rendered from README.md.in by Jinja2. In it stand

    {{ accuracy["gauss_over_elp.smooth_t5.n33.at_1e-6"] | ratio }}   a figure of results/recorded/accuracy/figures.json
    {% expect accuracy["rk4_over_explicit.slower"] > 30 %}            a condition; where it fails, there is no page

A sentence whose wording depends on data has its condition beside it. A figure that no file has, a name that nothing
has, and a condition that does not hold or cannot be told each end the rendering with one line: template, line, which.

Filters write figures. They round the decimal digits that the file has, half to even:

    digits(n)    n significant digits, without exponent, thousands apart: 0.0072, 1.10, 13, 1,564
    ratio        two significant digits: 0.97, 1.1, 13
    exponent     two significant digits and a power of ten: 7.2e-6; exponent(n) takes n
    percent      a share, by two significant digits: 7.6 %, −16 %; percent(n) takes n
    count        a whole number: 8,008
    matching(p)  of the figures of a study those whose keys match a pattern, such as "gain.s?.n*": a list
    span         the range of a list, its ends as ratios: 2.8–11; span("percent") takes another filter for them
    aligned      {% filter aligned %} … {% endfilter %}: the tables inside with aligned columns
"""

import fnmatch
import itertools
import json
import os
import re
from decimal import ROUND_HALF_EVEN, Decimal

import jinja2
from jinja2 import ext, nodes

from lib.pages.figures import FILE, read_figures
from lib.programs.messages import UnusableFile, one_line

MINUS = "−"
RECORDED = os.path.join("results", "recorded")

# ---- figures


class Figures(dict):
    """The figures of a study, by key. One that it has not throws UnusableFile; `key in figures` asks."""

    def __init__(self, path, figures):
        super().__init__(figures)
        self.path = path

    def __missing__(self, key):
        raise UnusableFile(f"{self.path} has no figure {json.dumps(key)}")


def recorded_figures(root):
    """Returns the Figures of every study with a figures.json under results/recorded of `root`, by study.

    Throws UnusableFile.
    """
    paths = {study: os.path.join(RECORDED, study, FILE) for study in sorted(os.listdir(os.path.join(root, RECORDED)))}
    return {study: Figures(path, read_figures(os.path.join(root, path))) for study, path in paths.items()
            if os.path.exists(os.path.join(root, path))}


# ---- how they are written


def digits(value, number):
    """Writes a figure with `number` significant digits, without exponent, with a comma every three whole digits."""
    return f"{rounded(value, number):,f}".replace("-", MINUS)


def ratio(value):
    return digits(value, 2)


def exponent(value, number=2):
    """Writes a figure with `number` significant digits and a power of ten, as 7.2e-6."""
    mantissa, _, power = f"{rounded(value, number):.{number - 1}e}".partition("e")
    return f"{mantissa}e{int(power)}".replace("-", MINUS, 1 if mantissa.startswith("-") else 0)


def percent(value, number=2):
    return f"{digits(100 * exact(value), number)} %"


def count(value):
    """Writes a whole number. Throws ValueError for another."""
    if exact(value) != exact(value).to_integral_value():
        raise ValueError(f"{value} is no whole number")
    return f"{int(value):,}".replace("-", MINUS)


def exact(value):
    """Returns the decimal number that stands in the file. Throws TypeError for what is no number."""
    if isinstance(value, bool) or not isinstance(value, (int, float, Decimal)):
        raise TypeError(f"{value!r} is no number")
    return value if isinstance(value, Decimal) else Decimal(repr(value))


def rounded(value, number):
    """Returns a decimal number of `number` significant digits; where they end before the point, zeros follow."""
    shown = exact(value)
    if shown == 0:
        return Decimal(0)
    for _ in range(2):  # the first may round up to a further digit: 0.996 to 1.00
        shown = shown.quantize(Decimal(1).scaleb(shown.adjusted() - number + 1), ROUND_HALF_EVEN)
    return shown


def matching(figures, *patterns):
    """Returns the values of those of some Figures whose keys match a pattern. Throws ValueError if none does."""
    found = []
    for pattern in patterns:
        keys = fnmatch.filter(figures, pattern)
        if not keys:
            raise ValueError(f"{figures.path} has no figure like {json.dumps(pattern)}")
        found += [figures[key] for key in keys]
    return found


def span(values, name="ratio"):
    """Writes the least and the largest of some values by the filter with this name; once, if written alike."""
    ends = dict.fromkeys(FILTERS[name](each) for each in (min(values), max(values)))
    return "–".join(ends)


def aligned(text):
    """Returns a text in which the columns of each table have one width, by the rule in its second line."""
    blocks = itertools.groupby(text.splitlines(), lambda line: line.startswith("|"))
    return "\n".join(line for is_table, lines in blocks
                     for line in (aligned_table(list(lines)) if is_table else lines)) + "\n"


def aligned_table(lines):
    """Returns the lines of a table with aligned columns. Throws ValueError where a row has another number of cells."""
    rows = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]] for line in lines]
    if len({len(row) for row in rows}) != 1:
        raise ValueError(f"a table whose rows have other numbers of cells, at {lines[0]}")
    heading, rule, *rest = rows
    widths = [max(3, *map(len, column)) for column in zip(heading, *rest)]
    dashes = [":" * cell.startswith(":") + "-" * (width - cell.count(":")) + ":" * cell.endswith(":")
              for cell, width in zip(rule, widths)]
    padded = [[cell.rjust(width) if way.endswith(":") else cell.ljust(width)
               for cell, width, way in zip(row, widths, rule)] for row in (heading, *rest)]
    return ["| " + " | ".join(row) + " |" for row in (padded[0], dashes, *padded[1:])]


FILTERS = {each.__name__: each for each in (digits, ratio, exponent, percent, count, matching, span, aligned)}

# ---- conditions

# Of a condition's text: what no space stands before, what none stands after, and what looks like a call and is none.
CLOSING, OPENING, KEYWORDS = (")", "]", ",", "."), ("(", "[", "."), ("not", "and", "or", "in", "is", "if", "else")


class Expect(ext.Extension):
    """{% expect CONDITION %} writes nothing, and ends the rendering where CONDITION is not true."""

    tags = {"expect"}

    def filter_stream(self, stream):
        """Puts the text of a condition before it, as a string: a parser no longer sees what was written."""
        for token in stream:
            yield token
            if token.type == "block_begin" and stream.current.test("name:expect"):
                yield next(stream)
                written = []
                while stream.current.type not in ("block_end", "eof"):
                    written.append(next(stream))
                yield type(token)(token.lineno, "string", condition_text(written))
                yield from written

    def parse(self, parser):
        line = next(parser.stream).lineno
        text = parser.stream.expect("string").value
        condition = parser.parse_expression()
        # As the body of a call, which is not run before met() runs it: so that met() can say where it failed.
        body = nodes.Output([nodes.CondExpr(condition, nodes.Const("true"), nodes.Const(""))])
        arguments = [nodes.Const(f"{parser.name}, line {line}"), nodes.Const(text)]
        return nodes.CallBlock(self.call_method("met", arguments), [], [], [body]).set_lineno(line)

    @staticmethod
    def met(place, text, caller):
        try:
            holds = caller()
        except Exception as problem:  # whatever a condition can throw: a figure that is missing, a division by zero
            raise Unmet(f"{place}: expected {text}: {one_line(problem)}") from None
        if not holds:
            raise Unmet(f"{place}: expected {text}")
        return ""


class Unmet(UnusableFile):
    """An expectation that is not met; its message has the place."""


def condition_text(tokens):
    """Returns the text of a condition from its tokens, with spaces as one writes them."""
    text, before = "", None
    for token in tokens:
        word = json.dumps(token.value, ensure_ascii=False) if token.type == "string" else str(token.value)
        is_call = word in ("(", "[") and before is not None and before.value not in KEYWORDS and (
            before.type == "name" or before.value in (")", "]"))
        if text and not is_call and word not in CLOSING and before.value not in OPENING:
            text += " "
        text, before = text + word, token
    return text


# ---- pages


def page(folder, name, names):
    """Returns the page that a template gives: `name` in `folder`, with `names` for what it looks up.

    Throws UnusableFile, whose message is one line with the place in the template.
    """
    environment = environment_of(folder)
    try:
        return environment.get_template(name).render(names)
    except jinja2.TemplateNotFound as problem:
        raise UnusableFile(f"{os.path.join(folder, problem.name)}: cannot be read") from None
    except jinja2.TemplateSyntaxError as problem:
        raise UnusableFile(f"{problem.name}, line {problem.lineno}: {one_line(problem.message)}") from None
    except Unmet:
        raise
    except Exception as problem:  # a filter on what is no number, an undefined name, a figure that is missing
        place = f"{name}, line {line_in(problem, os.path.join(folder, name))}"
        raise UnusableFile(f"{place}: {one_line(problem)}") from problem


def environment_of(folder):
    """Returns the environment of Jinja2 that pages have: nothing undefined, nothing escaped, no lines of tags alone."""
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(folder), undefined=jinja2.StrictUndefined,
                                     autoescape=False, trim_blocks=True, lstrip_blocks=True,
                                     keep_trailing_newline=True, extensions=[Expect])
    environment.filters.update(FILTERS)
    return environment


def line_in(problem, path):
    """Returns the line of a template where an exception came from."""
    line, trace = 0, problem.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == path:
            line = trace.tb_lineno
        trace = trace.tb_next
    return line
