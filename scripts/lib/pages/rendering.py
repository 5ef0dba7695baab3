"""What the scripts that render raw files share: one table in a format, or a folder with a report and its figures."""

import contextlib
import json
import os
from typing import Any, Callable, Dict, NamedTuple, Optional

from lib.programs.chart_python import require_to_render
from lib.programs.command_line import OneLineParser
from lib.programs.output import replace_file, write_folder, write_standard_output
from lib.programs.places import RECORDED
from lib.pages.document import WRITERS, as_markdown
from lib.pages.figures import FILE, as_json


def raw_file_parser(program, description, wrote):
    """Returns the parser of a script that renders what `wrote` wrote."""
    parser = OneLineParser(prog=program, description=description)
    parser.add_argument("raw", metavar="RAW.json", help=f"what {wrote} wrote")
    return parser


EXTENSIONS = {"text": "txt", "markdown": "md", "latex": "tex"}


def render_table(program, description, table, verdicts, arguments):
    """Renders the document `table(raw file)` in a format, to where that is wanted.

    With --out every format goes into a folder, and verdicts.json, with `verdicts(raw file)`, beside it.
    """
    parser = raw_file_parser(program, description, "scripts/reproduce table1 or table2")
    parser.add_argument("--format", choices=tuple(WRITERS), default="text")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--output", metavar="FILE", help="write here instead of to standard output")
    where.add_argument("--out", metavar="DIR", help="write the table in every format here, and verdicts.json")
    options = parser.parse_args(arguments)
    if options.out is not None:
        document = table(options.raw)
        files = {f"table.{EXTENSIONS[each]}": write(document).encode("utf-8") for each, write in WRITERS.items()}
        files["verdicts.json"] = verdicts_text(verdicts(options.raw)).encode("utf-8")
        return write_folder(options.out, files)
    data = WRITERS[options.format](table(options.raw)).encode("utf-8")
    if options.output is None:
        write_standard_output(data)
    elif os.path.realpath(options.output) == os.path.realpath(options.raw):
        raise OSError(0, "is the raw file itself", options.output)
    else:
        replace_file(options.output, data)


def verdicts_text(data):
    """Returns verdicts.json, an object a line."""
    lists = (f'"{name}": [\n' + ",\n".join(json.dumps(each) for each in found) + "\n]" for name, found in data.items())
    return "{\n" + ",\n".join(lists) + "\n}\n"


class Rendering(NamedTuple):
    """What a study's raw files give."""

    document: Optional[Callable[[set], list]]  # from the names of the charts that there are; None: there is no report
    figures: Optional[dict] = None  # by key; None for a study that no page quotes
    charts: Dict[str, Any] = {}  # figures of matplotlib by name; None where there is nothing to draw
    files: Dict[str, bytes] = {}  # further ones
    pictures: Dict[str, Any] = {}  # figures of matplotlib by name that are PNG everywhere: maps, too large as SVG


def beside(raw, name):
    """Returns the path of a further raw file of a study, which stands beside its first one; None if there is none."""
    path = os.path.join(os.path.dirname(raw), name)
    return path if os.path.exists(path) else None


def render_study(program, rendered, modules, arguments):
    """Renders a study's raw file by its `rendered(raw file, folder of recorded studies)`, which returns a Rendering.

    It needs these modules; with matplotlib it may have charts. Without --out the report goes to standard output. All of
    it is made before any is written.
    """
    parser = raw_file_parser(program, "Renders a raw file of a study: report, figures and charts.",
                             "scripts/measure; further raw files of the study are found beside it")
    parser.add_argument("--out", metavar="DIR", help="folder for all of it, with PNG unless it is in results/recorded;"
                        " made if missing (default: the report alone, to standard output)")
    parser.add_argument("--recorded", metavar="DIR", default=RECORDED,
                        help="recorded studies that some reports quote (default: results/recorded)")
    options = parser.parse_args(arguments)
    if modules:
        require_to_render(program, modules)
    has_charts = "matplotlib" in modules
    if has_charts:
        from lib.pages.chart_panels import own_style  # only now: it needs matplotlib
    with own_style() if has_charts else contextlib.nullcontext():
        found = rendered(options.raw, options.recorded)
        charts = {name: chart for name, chart in found.charts.items() if chart}
        reports = {"report.md": found.document(set(charts) if options.out else set())} if found.document else {}
        reports = {name: as_markdown(document).encode("utf-8") for name, document in reports.items()}
        if not options.out:
            return write_standard_output(next(iter((reports or found.files).values())))
        is_recorded = os.path.realpath(options.out).startswith(os.path.realpath(RECORDED) + os.sep)
        files = {**found.files, **reports, **drawn(charts, ("svg",) if is_recorded else ("svg", "png")),
                 **drawn(found.pictures, ("png",))}
    if found.figures is not None:
        files[FILE] = as_json(found.figures)
    write_folder(options.out, files)


def drawn(charts, kinds):
    """Returns the files of charts, as bytes by name."""
    if not charts:
        return {}
    from lib.pages.chart_panels import encode  # only now: it needs matplotlib
    return {f"{name}.{kind}": encode(chart, kind) for name, chart in charts.items() for kind in kinds}
