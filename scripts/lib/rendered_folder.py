"""The folder that a render script fills: charts as SVG and PNG, a report as Markdown and text."""

import errno
import os
import sys
import tempfile

from benchmark_json import UnusableFile, one_line
from document import as_markdown, as_text, replace_file

KINDS = ("svg", "png")


def chart_files(figures):
    """Returns the files of some charts, by name, and their contents."""
    from chart_panels import encode  # only now: it needs matplotlib

    return {f"{name}.{kind}": encode(figure, kind) for name, figure in figures.items() for kind in KINDS}


def report_files(report):
    return {"report.md": as_markdown(report).encode("utf-8"), "report.txt": as_text(report).encode("utf-8")}


def write_folder(program, folder, files):
    """Writes what `files()` returns, all of it made before any is written. What goes wrong is one line and exit 2."""
    try:
        require_room(folder)
        contents = files()
        os.makedirs(folder, exist_ok=True)
        for name, data in contents.items():
            replace_file(os.path.join(folder, name), data)
    except UnusableFile as problem:
        fail(program, problem)
    except OSError as problem:
        fail(program, f"{one_line(problem.filename or folder)}: cannot be written: {problem.strerror}")
    return contents


def require_room(folder):
    """Raises OSError if a folder cannot be there or be filled, as far as that is seen without making it: it is tried."""
    nearest = os.path.abspath(folder)
    while not os.path.lexists(nearest):
        nearest = os.path.dirname(nearest)
    if not os.path.isdir(nearest):
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), nearest)
    try:
        os.rmdir(tempfile.mkdtemp(dir=nearest))
    except OSError as problem:
        raise OSError(problem.errno, problem.strerror, nearest) from None


def output_folder(program, option, folder):
    """Makes a folder that is to be written later; one that cannot be is one line and exit 2, before any work."""
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as problem:
        fail(program, f"{option} {one_line(folder)}: cannot be made: {problem.strerror}")
    try:
        require_room(folder)
    except OSError:
        fail(program, f"{option} {one_line(folder)}: cannot be written")


def fail(program, problem):
    print(f"{program}: {problem}", file=sys.stderr)
    sys.exit(2)
