"""Where results go: whole files and folders, standard output, and files that a script keeps up to date."""

import os
import tempfile

from lib.programs.command_line import Stop
from lib.programs.messages import one_line


def replace_file(path, data):
    """Writes to a temporary neighbour and renames it, so that nobody ever sees half a file."""
    target = os.path.realpath(path)
    if os.path.exists(target) and not os.path.isfile(target):
        raise OSError(0, "is a directory or a device, not a file", path)
    temporary = f"{target}.{os.getpid()}.partial"
    try:
        with open(temporary, "xb") as stream:
            stream.write(data)
        os.replace(temporary, target)
    except BaseException as problem:
        if os.path.exists(temporary):
            os.unlink(temporary)
        problem.filename = path
        raise


def write_folder(folder, contents):
    """Writes files, a dict from names to bytes, into a folder, which is made if missing."""
    os.makedirs(folder, exist_ok=True)
    for name, data in contents.items():
        replace_file(os.path.join(folder, name), data)


def make_folder(option, folder):
    """Makes a folder that is to be written later. Throws Stop, before any work, for one that cannot be."""
    try:
        os.makedirs(folder, exist_ok=True)
        os.rmdir(tempfile.mkdtemp(dir=folder))
    except OSError as problem:
        raise Stop(f"{option} {one_line(folder)}: cannot be written: {problem.strerror}") from None


def write_standard_output(data):
    """Writes past Python's buffer, which would report a full disk only after the exit status is settled."""
    view = memoryview(data)
    try:
        while view:
            view = view[os.write(1, view):]
    except OSError as problem:
        problem.filename = "standard output"
        raise


# ---- files that a script keeps up to date


def keep(check, path, wanted, complaint):
    """Brings the file at `path` up to date: `wanted` returns the text that it should have, given the one it has.

    With `check` nothing is written, and another text throws Stop with status 1 and `complaint`.
    """
    with open(path, encoding="utf-8") as file:
        found = file.read()
    updated = wanted(found)
    if updated != found and check:
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
