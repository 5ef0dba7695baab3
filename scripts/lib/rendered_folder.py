"""The folder that a render script fills: charts and a report, as SVG and Markdown, and as PNG and text too."""

import os
import sys
import tempfile

from chart_python import require_matplotlib
from checked_json import UnusableFile, one_line
from command_line import raw_file_parser
from document import as_markdown, as_text, replace_file

RECORDED = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__)))), "results",
                        "recorded")


def render_study(program, description, arguments, raw, others, drawn):
    """Runs a script that renders a study; returns its command line and what it wrote, by name.

    `raw` names the program that wrote the raw file, `others` are options that name further ones, with their help.
    `drawn(options)` returns figures by name (None: there is nothing to draw) and a function from the names of those
    that there are to the report.
    """
    parser = raw_file_parser(program, description, raw, others)
    parser.add_argument("--out", metavar="DIR", required=True, help="folder for charts and report; made if missing."
                        " In results/recorded: SVG and Markdown only")
    options = parser.parse_args(arguments)
    require_matplotlib(program)
    return options, write_folder(program, options.out, lambda: files(drawn, options))


def files(drawn, options):
    """Returns the files of the charts and of their report, by name, and their contents."""
    from chart_panels import encode, own_style  # only now: it needs matplotlib

    recorded = os.path.realpath(options.out).startswith(os.path.realpath(RECORDED) + os.sep)
    with own_style():
        figures, report = drawn(options)
        figures = {name: figure for name, figure in figures.items() if figure}
        found = {f"{name}.{kind}": encode(figure, kind) for name, figure in figures.items()
                 for kind in (("svg",) if recorded else ("svg", "png"))}
    document = report(set(figures))
    found["report.md"] = as_markdown(document).encode("utf-8")
    if not recorded:
        found["report.txt"] = as_text(document).encode("utf-8")
    return found


def write_folder(program, folder, files):
    """Writes what `files()` returns, all of it made before any is written. What goes wrong is one line and exit 2."""
    try:
        contents = files()
    except UnusableFile as problem:
        fail(program, problem)
    try:
        os.makedirs(folder, exist_ok=True)
        for name, data in contents.items():
            replace_file(os.path.join(folder, name), data)
    except OSError as problem:
        fail(program, f"{one_line(problem.filename or folder)}: cannot be written: {problem.strerror}")
    return contents


def output_folder(program, option, folder):
    """Makes a folder that is to be written later; one that cannot be is one line and exit 2, before any work."""
    try:
        os.makedirs(folder, exist_ok=True)
        os.rmdir(tempfile.mkdtemp(dir=folder))
    except OSError as problem:
        fail(program, f"{option} {one_line(folder)}: cannot be written: {problem.strerror}")


def fail(program, problem):
    print(f"{program}: {problem}", file=sys.stderr)
    sys.exit(2)
