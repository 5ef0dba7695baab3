"""Files that a script keeps up to date: alone it writes it, with --check it only tells if it is as it should be."""

import sys

from checked_json import UnusableFile
from document import replace_file


def keep(program, arguments, path, wanted, complaint):
    """Runs such a script and returns its exit status.

    `wanted` returns the text that the file should have, given the one it has (none: ""), or throws UnusableFile.
    `complaint` is what --check says of another.
    """
    if arguments not in ([], ["--check"]):
        return complain(program, "takes no argument but --check", 2)
    found = read(path)
    try:
        updated = wanted(found)
    except UnusableFile as problem:
        return complain(program, problem, 2)
    if updated == found:
        return 0
    if arguments == ["--check"]:
        return complain(program, complaint, 1)
    replace_file(path, updated.encode("utf-8"))
    return 0


def complain(program, problem, status):
    print(f"{program}: {problem}", file=sys.stderr)
    return status


def read(path):
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except (OSError, UnicodeDecodeError):
        return ""


def between(text, begin, end, what, inside):
    """Returns `text` with what stands between two markers replaced. Throws UnusableFile without them."""
    before, found_begin, rest = text.partition(begin)
    _, found_end, after = rest.partition(end)
    if not found_begin or not found_end:
        raise UnusableFile(f"{what} markers are missing")
    return before + begin + inside + end + after
