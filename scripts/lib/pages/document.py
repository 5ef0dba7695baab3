"""A small document (headings, paragraphs, lists, tables) and its three writers: text, Markdown, LaTeX.

Tables and verdicts are built once as data; only the writers know a format, and each escapes what it is given.
"""

import itertools
import re
import textwrap
from typing import List, NamedTuple, Tuple

TEXT_WIDTH = 100
WIDEST_ALIGNED = 128  # columns of a row of Markdown; the source of a wider table is not aligned, only what it shows


class Heading(NamedTuple):
    text: str
    level: int = 2


class Paragraph(NamedTuple):
    text: str


class Items(NamedTuple):
    """A list; each entry is a few words that stand out, and the rest with its own punctuation."""

    items: List[Tuple[str, str]]


class Figure(NamedTuple):
    """An image beside the document, and what it shows."""

    path: str
    caption: str


class Column(NamedTuple):
    heading: str
    group: str = ""
    align: str = "right"


class Entry(NamedTuple):
    """One table entry; `marked` is what stands out: bold, or a star in plain text."""

    text: str
    marked: bool = False


class Table(NamedTuple):
    """Rows of entries, in blocks set apart from one another."""

    columns: Tuple[Column, ...]
    blocks: List[List[List[Entry]]]

    def rows(self):
        return list(itertools.chain.from_iterable(self.blocks))

    def groups(self):
        """Returns (group, first column, number of columns) of each run of columns in one group."""
        runs = itertools.groupby(range(len(self.columns)), lambda index: self.columns[index].group)
        return [(group, members[0], len(members)) for group, members in ((group, list(run)) for group, run in runs)]


def padded(texts, widths, columns):
    return [text.rjust(width) if column.align == "right" else text.ljust(width)
            for text, width, column in zip(texts, widths, columns)]


def column_widths(rows):
    return [max(map(len, texts)) for texts in zip(*rows)]


def plain_table(columns, rows):
    """Returns a table of one block, none of its entries marked, from rows of texts."""
    return Table(columns, [[[Entry(text) for text in row] for row in rows]])


def shown(captions, charts):
    """Returns the figures of those of some charts, given as (name, caption), that exist."""
    return [Figure(f"{name}.svg", caption) for name, caption in captions if name in charts]


def conditions(context):
    """Says in a line what a study was measured with."""
    return Paragraph("Measured with " + ", ".join(f"{field} {context[field]}" for field in
                                                  ("cpu", "blas_kernels", "compiler", "commit")
                                                  if field in context) + ".")


def written(document, writers):
    """Joins what the writers of a format make of the parts of a document, each by its class."""
    return "\n\n".join(writers[type(part)](part) for part in document) + "\n"


# ---- plain text


def as_text(document):
    """Writes plain text of at most 110 columns: paragraphs are filled, tables as wide as they are."""
    return written(document, {
        Heading: text_heading,
        Paragraph: lambda part: fill(part.text),
        Items: lambda part: "\n".join(fill(strong + rest, "  ", "- ") for strong, rest in part.items),
        Table: text_table,
        Figure: lambda part: fill(f"[{part.path}] {part.caption}")})


def text_heading(heading):
    underline = {1: "=", 2: "-"}.get(heading.level)
    return heading.text + ("\n" + underline * len(heading.text) if underline else "")


def fill(text, indent="", first=""):
    """Breaks lines, but not inside an equation such as p = 0.01."""
    glued = text.replace(" = ", "\xa0=\xa0")
    lines = textwrap.fill(glued, TEXT_WIDTH, initial_indent=first, subsequent_indent=indent, break_on_hyphens=False)
    return lines.replace("\xa0", " ")


def text_table(table):
    starred = [any(row[i].marked for row in table.rows()) for i in range(len(table.columns))]
    star = [" " if has_star else "" for has_star in starred]
    headings = [column.heading + blank for column, blank in zip(table.columns, star)]
    blocks = [[[entry.text + ("*" if entry.marked else blank) for entry, blank in zip(row, star)] for row in block]
              for block in table.blocks]
    widths = column_widths([headings] + [row for block in blocks for row in block])

    def line(texts):
        return "  ".join(padded(texts, widths, table.columns)).rstrip()

    top = [line(headings), "  ".join("-" * width for width in widths)]
    if any(column.group for column in table.columns):
        top.insert(0, text_groups(table, widths))
    return "\n".join(top) + "\n" + "\n\n".join("\n".join(map(line, block)) for block in blocks)


def text_groups(table, widths):
    """Writes the names of column groups, each across its columns."""
    labels = []
    for group, first, size in table.groups():
        width = sum(widths[first:first + size]) + 2 * (size - 1)
        labels.append(f" {group} ".center(width, "-") if group else " " * width)
    return "  ".join(labels).rstrip()


# ---- Markdown


def as_markdown(document):
    escape = markdown_escape
    return written(document, {
        Heading: lambda part: f"{'#' * part.level} {escape(part.text)}",
        Paragraph: lambda part: escape(part.text),
        Items: lambda part: "\n".join(f"- {markdown_strong(strong)}{escape(rest)}" for strong, rest in part.items),
        Table: markdown_table,
        Figure: lambda part: f"![{escape(part.caption)}]({part.path})\n\n*{escape(part.caption)}*"})


def markdown_escape(text):
    return re.sub(r"([\\`*_\[\]<>|~$#&])", r"\\\1", text)


def markdown_strong(text):
    return f"**{markdown_escape(text)}**" if text else ""


def markdown_table(table):
    """Writes a pipe table, whose source is aligned too if it is not too wide to be read in a terminal.

    It has one heading row, so groups go into the names.
    """
    headings = [markdown_escape(f"{column.group}, {column.heading}" if column.group else column.heading)
                for column in table.columns]
    rows = [[markdown_strong(entry.text) if entry.marked else markdown_escape(entry.text) for entry in row]
            for row in table.rows()]
    widths = [max(width, 3) for width in column_widths([headings] + rows)]
    if sum(widths) + 3 * len(widths) + 1 > WIDEST_ALIGNED:
        widths = [0] * len(widths)
    rules = ["-" * max(width - 1, 2) for width in widths]
    rule = [dashes + ":" if column.align == "right" else ":" + dashes for dashes, column in zip(rules, table.columns)]
    lines = [padded(headings, widths, table.columns), rule]
    lines += [padded(row, widths, table.columns) for row in rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


# ---- LaTeX

LATEX_CHARACTERS = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "_": r"\_",
    "%": r"\%", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\textless{}",
    ">": r"\textgreater{}", "|": r"\textbar{}", '"': "''", "[": "{[}", "]": "{]}", "-": "-{}",
    "±": r"$\pm$", "–": "--", "—": "---", "×": r"$\times$", "·": r"$\cdot$", "≤": r"$\le$", "≥": r"$\ge$",
    "ħ": r"$\hbar$", "‖": r"$\|$", "…": r"\dots{}", "²": r"$^2$", "³": r"$^3$", "µ": r"$\mu$", "Δ": r"$\Delta$",
}


def as_latex(document):
    """Writes a fragment to \\input: whole tabular environments, ASCII only. It knows no figures."""
    commands = {1: "section", 2: "subsection"}
    return "% A fragment to \\input; needs \\usepackage{booktabs}.\n\n" + written(document, {
        Heading: lambda part: rf"\{commands.get(part.level, 'subsubsection')}*{{{latex_escape(part.text)}}}",
        Paragraph: lambda part: latex_escape(part.text),
        Items: latex_items,
        Table: latex_table})


def latex_escape(text):
    """Escapes text for any pdflatex; a character it cannot print is named by its code, never lost.

    A hyphen is touched only before another one, where the two would become a dash.
    """
    return re.sub(r"-(?=-)|[^-]", lambda match: latex_character(match[0]), text)


def latex_character(character):
    plain = character if character.isascii() else f"(U+{ord(character):04X})"
    return LATEX_CHARACTERS.get(character, plain)


def latex_strong(text):
    return rf"\textbf{{{latex_escape(text)}}}" if text else ""


def latex_items(items):
    lines = [rf"  \item {latex_strong(strong)}{latex_escape(rest)}" for strong, rest in items.items]
    return "\n".join([r"\begin{itemize}", *lines, r"\end{itemize}"])


def latex_row(texts):
    return " & ".join(texts) + r" \\"


def latex_table(table):
    alignment = "".join("r" if column.align == "right" else "l" for column in table.columns)
    blocks = ["\n".join(latex_row([latex_strong(entry.text) if entry.marked else latex_escape(entry.text)
                                   for entry in row]) for row in block) for block in table.blocks]
    return "\n".join([
        r"\begin{center}\footnotesize", rf"\begin{{tabular}}{{{alignment}}}", r"\toprule", *latex_groups(table),
        latex_row([latex_escape(column.heading) for column in table.columns]), r"\midrule",
        "\n\\addlinespace\n".join(blocks), r"\bottomrule", r"\end{tabular}", r"\end{center}"])


def latex_groups(table):
    """Writes the row that names column groups, with a rule under each; nothing where there are none."""
    groups = table.groups()
    if not any(group for group, _, _ in groups):
        return []
    names = [rf"\multicolumn{{{size}}}{{c}}{{{latex_escape(group)}}}" for group, _, size in groups]
    rules = [rf"\cmidrule(lr){{{first + 1}-{first + size}}}" for group, first, size in groups if group]
    return [latex_row(names), "".join(rules)]


WRITERS = {"text": as_text, "markdown": as_markdown, "latex": as_latex}
