"""Messages of one line, whatever they quote, and the error that a file cannot be used."""

import contextlib
import json
import unicodedata

LONGEST_TEXT = 60  # of a name that is shown


class UnusableFile(Exception):
    """A file that cannot be used; the message is one line naming the file and what is wrong."""


@contextlib.contextmanager
def naming(path):
    """Has an UnusableFile that is thrown within name the file."""
    try:
        yield
    except UnusableFile as problem:
        raise UnusableFile(f"{one_line(path)}: {problem}") from None


def quoted(value):
    """Shows a foreign value in a message, cut so that the message stays one short line."""
    if isinstance(value, (list, dict)):
        return "a JSON list" if isinstance(value, list) else "a JSON object"
    return shortened(json.dumps(value, ensure_ascii=False))


def shortened(value):
    line = one_line(value)
    return line if len(line) <= LONGEST_TEXT else line[:LONGEST_TEXT - 3] + "..."


def one_line(value):
    """Makes foreign text safe to print: no line breaks, control codes or lone surrogates."""
    visible = ("\ufffd" if "\ud800" <= c <= "\udfff" else " " if unicodedata.category(c)[0] == "C" else c
               for c in str(value))
    return " ".join("".join(visible).split())
