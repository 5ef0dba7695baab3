"""JSON that is checked before any of it is used, so that a table or chart is made from a sound file or not at all.

What a value has to be is its *kind*: a function that returns the value as it is used, or raises Wrong with what is
needed instead.
"""

import json
import unicodedata

# Errors, norms, counts and step sizes that are not 0 lie far inside; others are damage, and quotients of them overflow.
SMALLEST, LARGEST = 1e-30, 1e18
LONGEST_TEXT = 60  # of a name


class UnusableFile(Exception):
    """A file that cannot be used; the message is one line naming the file and what is wrong."""


class Wrong(Exception):
    """A value is not of its kind; the message says what is needed."""


# ---- reading


def read_json(path, make):
    """Returns what `make` makes of the JSON in `path`. Throws UnusableFile with one line that names the file."""
    try:
        return make(parse_json(read_text(path)))
    except UnusableFile as problem:
        raise UnusableFile(f"{one_line(path)}: {problem}") from None


def read_text(path):
    """Returns the text of a file, or says in one line why there is none."""
    try:
        with open(path, "rb") as stream:
            return stream.read().decode("utf-8")
    except OSError as problem:
        raise UnusableFile(f"cannot be read: {problem.strerror}") from None
    except UnicodeDecodeError as problem:
        raise UnusableFile(f"is not UTF-8 text (byte {problem.start})") from None


def parse_json(text):
    """Parses JSON, bare NaN allowed: it stands in aggregate rows, and is refused where it would be used."""
    if not text.strip():
        raise UnusableFile("is empty")
    try:
        return json.loads(text)
    except json.JSONDecodeError as problem:
        raise UnusableFile(f"is not whole JSON (line {problem.lineno}: {problem.msg})") from None
    except (ValueError, RecursionError) as problem:
        raise UnusableFile(f"is not usable JSON ({one_line(problem)})") from None


# ---- kinds


def kind_of(needed, allowed, made=lambda value: value):
    """Returns the kind of the values that are `allowed`, which are read as `made` says."""
    def read(value):
        if not allowed(value):
            raise Wrong(needed)
        return made(value)
    return read


def is_number(value, least=0, most=LARGEST):
    """Tells whether a value is a number within bounds, which NaN is not."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and least <= value <= most


# Errors, norms, counts and times are finite and never negative.
number = kind_of(f"a number from 0 to {LARGEST:g}", is_number, float)
positive = kind_of(f"a number from {SMALLEST:g} to {LARGEST:g}", lambda value: is_number(value, SMALLEST), float)
anything = kind_of("anything", lambda value: True)
truth = kind_of("true or false", lambda value: isinstance(value, bool))
any_text = kind_of("a text", lambda value: isinstance(value, str))
text = kind_of("a short text", lambda value: (isinstance(value, str) and one_line(value) == value
                                              and 0 < len(value) <= LONGEST_TEXT))
an_object = kind_of("an object", lambda value: isinstance(value, dict))


def one_of(*allowed):
    return kind_of(f"one of {', '.join(allowed)}", lambda value: isinstance(value, str) and value in allowed)


def whole(least=0):
    return kind_of(f"a whole number from {least} on",
                   lambda value: isinstance(value, int) and is_number(value, least, 10**15 - 1))


def optional(kind):
    return lambda value: None if value is None else kind(value)


def list_of(kind, length=None):
    def kind_of_list(value):
        if not isinstance(value, list) or length not in (None, len(value)):
            raise Wrong("a list" if length is None else f"a list of {length}")
        try:
            return tuple(map(kind, value))
        except Wrong as wrong:
            raise Wrong(f"a list, each of it {wrong},") from None
    return kind_of_list


# ---- records


def require(document, what, name, wanted):
    """Throws UnusableFile, saying that a document is no `what`, if a field of it is not `wanted`."""
    found = document.get(name) if isinstance(document, dict) else None
    if found != wanted:
        raise UnusableFile(f"is no {what} (its {name} is {quoted(found)}, not {quoted(wanted)})")


def checked(values, kinds, what):
    """Returns the fields of an object that have `kinds`, a dict by name. Throws UnusableFile, naming it `what`."""
    found = {}
    for name, kind in kinds.items():
        if name not in values:
            raise UnusableFile(f"{what} has no {name}")
        try:
            found[name] = kind(values[name])
        except Wrong as wrong:
            raise UnusableFile(f"{what} has {name} {quoted(values[name])} where {wrong} is needed") from None
    return found


def keyed(records, *names):
    """Returns records by the value of one field, or by the tuple of several. Throws UnusableFile for two of one key."""
    found = {}
    for record in records:
        key = tuple(getattr(record, name) for name in names)
        if found.setdefault(key if len(key) > 1 else key[0], record) is not record:
            raise UnusableFile(f"has {', '.join(f'{name} {value}' for name, value in zip(names, key))} twice")
    return found


# ---- foreign text


def printable_context(context):
    """Returns the texts and numbers of a context as text, each in one line; the list of caches has no place in one."""
    return {key: one_line(value) for key, value in context.items() if isinstance(value, (str, int, float))}


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
