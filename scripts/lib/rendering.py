"""What the scripts that render raw files share: one table in a format, or a folder of charts and a report."""

import json
import os
import sys

from lib.chart_python import require_matplotlib
from lib.command_line import OneLineParser, run
from lib.document import WRITERS, as_markdown, as_text
from lib.output import replace_file, write_folder, write_standard_output

RECORDED = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__)))), "results",
                        "recorded")


def raw_file_parser(program, description, wrote):
    """Returns the parser of a script that renders what `wrote` wrote."""
    parser = OneLineParser(prog=program, description=description)
    parser.add_argument("raw", metavar="RAW.json", help=f"what {wrote} wrote")
    return parser


EXTENSIONS = {"text": "txt", "markdown": "md", "latex": "tex"}


def render_table(program, description, wrote, table, verdicts=None):
    """Runs a script that renders the document `table(raw file)` in a format, to where that is wanted.

    With --out every format goes into a folder, and verdicts.json, with `verdicts(raw file)`, beside it.
    """
    def main(arguments):
        parser = raw_file_parser(program, description, wrote)
        parser.add_argument("--format", choices=tuple(WRITERS), default="text")
        where = parser.add_mutually_exclusive_group()
        where.add_argument("--output", metavar="FILE", help="write here instead of to standard output")
        where.add_argument("--out", metavar="DIR", help="write the table in every format here"
                           + (", and verdicts.json" if verdicts else ""))
        options = parser.parse_args(arguments)
        if options.out is not None:
            document = table(options.raw)
            files = {f"table.{EXTENSIONS[each]}": write(document).encode("utf-8") for each, write in WRITERS.items()}
            if verdicts:
                files["verdicts.json"] = verdicts_text(verdicts(options.raw)).encode("utf-8")
            write_folder(options.out, files)
            return
        data = WRITERS[options.format](table(options.raw)).encode("utf-8")
        if options.output is None:
            write_standard_output(data)
        elif os.path.realpath(options.output) == os.path.realpath(options.raw):
            raise OSError(0, "is the raw file itself", options.output)
        else:
            replace_file(options.output, data)

    run(program, main, sys.argv[1:])


def verdicts_text(data):
    """Returns verdicts.json, an object a line."""
    lists = (f'"{name}": [\n' + ",\n".join(json.dumps(each) for each in found) + "\n]" for name, found in data.items())
    return "{\n" + ",\n".join(lists) + "\n}\n"


def render_study(program, description, wrote, drawn, **others):
    """Runs a script that renders a study into a folder; all of it is made before any is written.

    `drawn(raw file, *further ones)` returns figures by name (None: there is nothing to draw) and a function from the
    names of those that there are to the report. `others` are options that name the further files, with their help.
    """
    def main(arguments):
        parser = raw_file_parser(program, description, wrote)
        for name, wrote_it in others.items():
            parser.add_argument(f"--{name}", metavar=f"{name.upper()}.json", help=wrote_it)
        parser.add_argument("--out", metavar="DIR", required=True, help="folder for charts and report; made if missing."
                            " In results/recorded: SVG and Markdown only")
        options = parser.parse_args(arguments)
        require_matplotlib(program)
        from lib.chart_panels import encode, own_style  # only now: it needs matplotlib

        recorded = os.path.realpath(options.out).startswith(os.path.realpath(RECORDED) + os.sep)
        with own_style():
            figures, report = drawn(options.raw, *(getattr(options, name) for name in others))
            figures = {name: figure for name, figure in figures.items() if figure}
            contents = {f"{name}.{kind}": encode(figure, kind) for name, figure in figures.items()
                        for kind in (("svg",) if recorded else ("svg", "png"))}
        document = report(set(figures))
        contents["report.md"] = as_markdown(document).encode("utf-8")
        if not recorded:
            contents["report.txt"] = as_text(document).encode("utf-8")
        write_folder(options.out, contents)

    run(program, main, sys.argv[1:])
