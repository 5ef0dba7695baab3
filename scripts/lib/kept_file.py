"""Files that a script keeps up to date: alone it writes them, with --check it only tells if they are as they should be."""

from command_line import Stop
from output import replace_file


def keep(arguments, path, wanted, complaint):
    """Keeps the file at `path`. `wanted` returns the text that it should have, given the one it has, or throws Stop.

    Throws Stop: with status 1 and `complaint` if --check finds another text.
    """
    if arguments not in ([], ["--check"]):
        raise Stop("takes no argument but --check")
    with open(path, encoding="utf-8") as file:
        found = file.read()
    updated = wanted(found)
    if updated != found and arguments:
        raise Stop(complaint, 1)
    if updated != found:
        replace_file(path, updated.encode("utf-8"))


def between(text, begin, end, what, inside):
    """Returns `text` with what stands between two markers replaced. Throws Stop without them."""
    before, found_begin, rest = text.partition(begin)
    _, found_end, after = rest.partition(end)
    if not found_begin or not found_end:
        raise Stop(f"{what} markers are missing")
    return before + begin + inside + end + after
