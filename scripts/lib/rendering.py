"""What the scripts that render raw files share: one table in a format, or a folder with a report and its figures."""

import json
import os
import sys

from lib.chart_python import require_matplotlib
from lib.command_line import OneLineParser, run
from lib.document import WRITERS, as_markdown
from lib.figures import FILE, as_json
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


def render_report(program, description, wrote, made, **others):
    """Runs a script that renders a study without charts.

    `made(raw file, *further ones)` returns its document and its figures or None. `others` are options that name the
    further files, with their help.
    """
    def main(arguments):
        parser = folder_parser(program, description, wrote, "report and figures")
        add_further_files(parser, others)
        options = parser.parse_args(arguments)
        write_folder(options.out, report_files(*made(options.raw, *(getattr(options, name) for name in others))))

    run(program, main, sys.argv[1:])


def render_study(program, description, wrote, drawn, **others):
    """Runs a script that renders a study with charts; all of it is made before any is written.

    `drawn(raw file, *further ones)` returns charts by name (None: there is nothing to draw), a function from the names
    of those that there are to the report, and the figures or None. `others` are options that name the further files,
    with their help.
    """
    def main(arguments):
        parser = folder_parser(program, description, wrote, "charts, report and figures, no PNG in results/recorded")
        add_further_files(parser, others)
        options = parser.parse_args(arguments)
        require_matplotlib(program)
        from lib.chart_panels import encode, own_style  # only now: it needs matplotlib

        recorded = os.path.realpath(options.out).startswith(os.path.realpath(RECORDED) + os.sep)
        with own_style():
            charts, report, figures = drawn(options.raw, *(getattr(options, name) for name in others))
            charts = {name: chart for name, chart in charts.items() if chart}
            contents = {f"{name}.{kind}": encode(chart, kind) for name, chart in charts.items()
                        for kind in (("svg",) if recorded else ("svg", "png"))}
        write_folder(options.out, {**contents, **report_files(report(set(charts)), figures)})

    run(program, main, sys.argv[1:])


def add_further_files(parser, others):
    for name, wrote in others.items():
        parser.add_argument(f"--{name}", metavar=f"{name.upper()}.json", help=wrote)


def folder_parser(program, description, wrote, what):
    parser = raw_file_parser(program, description, wrote)
    parser.add_argument("--out", metavar="DIR", required=True, help=f"folder for {what}; made if missing")
    return parser


def report_files(document, figures):
    """Returns the files of a report, as bytes by name. `figures` is None for a study that no page quotes."""
    files = {"report.md": as_markdown(document).encode("utf-8")}
    return files if figures is None else {**files, FILE: as_json(figures)}
