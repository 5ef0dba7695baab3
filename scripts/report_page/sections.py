"""The sections of a page, in their order: what each shows of the studies that there are, and what it misses."""

import base64
import os
from html import escape
from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

from lib.pages.document import Paragraph, as_markdown
from lib.programs.messages import UnusableFile, naming, one_line
from lib.programs.places import RECORDED, ROOT
from lib.records import findings
from lib.records.formats import FAST, an_object, checked, printable_context, read_bytes, read_json, read_text, require
from report_page import of_accuracy, of_flows, of_history, of_limits, of_practice, of_tables
from report_page.charts import Chart
from report_page.markup import as_html, section_of
from studies import STUDIES
from studies.accuracy.lines import read_accuracy
from studies.claims.judge import EXPLAINED, claims_table, read_claims_table
from studies.fluid.schema import read_fluid
from studies.limits.schema import read_limits
from studies.longruns.schema import read_longruns
from studies.practice.schema import read_practice
from studies.tables.comparison import CONDITIONS
from studies.turbulence.judge import Findings as TurbulenceFindings
from studies.turbulence.schema import read_turbulence

RAW, REPORT = "raw.json", "report.md"
# Of the conditions in raw files those that are told: a file of tables has the name of the host too.
TOLD = (*CONDITIONS, "timed_on", "threads_timed_on", "split_kernels", "version")
PICTURE, PNG = "methods.png", b"\x89PNG\r\n"  # and how its file begins
TABLES = "tables"  # whose raw file is not of the format of the other studies
NO_HISTORY = ("No history was given: <code>scripts/reproduce report --history FILE</code> draws one, which"
              " <code>scripts/reproduce table1 --history FILE</code> and"
              " <code>scripts/check_regression --history FILE</code> write.")


class Section(NamedTuple):
    name: str  # its place in the page
    heading: str
    html: str = ""  # before the charts
    below: str = ""  # and below them
    charts: Tuple[Chart, ...] = ()
    folded: Tuple[Tuple[str, str], ...] = ()  # summaries, and HTML that they open
    missing: Tuple[str, ...] = ()  # HTML of what is not there, and how it is got


class Sources(NamedTuple):
    """Where the studies of a page are: the folder of each, by the package that renders it."""

    folders: Dict[str, str]
    is_whole: bool  # of all recorded runs
    history: Optional[list] = None  # Lines

    def path(self, study, name=RAW):
        """Returns the path of a file of a study, None where that is not there."""
        path = os.path.join(self.folders[study], name) if study in self.folders else ""
        return path if os.path.exists(path) else None

    def read(self, study, reader):
        """Returns what a reader makes of the raw file of a study, None where there is none."""
        path = self.path(study)
        return reader(path) if path else None


def recorded_sources(folder=RECORDED, history=None):
    """Returns the Sources of all studies that are recorded in a folder."""
    homes = dict.fromkeys(study.home for study in STUDIES)
    return Sources({home: os.path.join(folder, home) for home in homes
                    if os.path.exists(os.path.join(folder, home, RAW))}, True, history)


# ---- what is missing


def missing(sources, *homes):
    """Returns of each study that is not there how it is got."""
    return tuple(f"Not on this page: {study.title}. <code>scripts/reproduce {study.name}</code> measures it, in about"
                 f" {study.minutes:g} minutes." for study in STUDIES
                 if study.home in homes and sources.path(study.home) is None)


# ---- sections


def answer(sources):
    readme, results = (text_in(os.path.join(ROOT, *path)) for path in (("README.md",), ("results", "README.md")))
    about = as_html(readme.partition("\n## ")[0].partition("\n\n")[2])
    words = (("Scenes, and words of this page", as_html(section_of(results, "Scenes and words"))),)
    if not sources.is_whole:
        names = ", ".join(sources.folders)
        return Section("answer", "The answer", f"{about}<p>This page shows one run: {names}. The answers of the project"
                       " rest on all recorded studies; <code>scripts/reproduce report</code> makes their page.</p>",
                       folded=words)
    lacking = [study.name for study in STUDIES if sources.path(study.home) is None]
    return Section("answer", "The answer", about + as_html(section_of(readme, "Three answers")), folded=words, missing=(
        f"The answers rest on all studies as they were recorded; of these {', '.join(lacking)} are not on this page.",
    ) if lacking else ())


def tables(sources):
    path = sources.path("tables")
    if path is None:
        return Section("table-1-and-table-2", "Table 1 and Table 2", missing=missing(sources, "tables"))
    found = of_tables.comparisons(path)
    shown, rules, pairs = map(as_html, of_tables.tables(found))
    lacking = () if FAST in found else (
        "Not in this run: the fast forms. <code>scripts/reproduce table2</code> measures them too.",)
    return Section("table-1-and-table-2", "Table 1 and Table 2", below=shown, charts=(of_tables.formulations(found),),
                   folded=(("How the claims are judged", rules), ("Every pair of rows", pairs)), missing=lacking)


def speed(sources):
    study = sources.read("accuracy", read_accuracy)
    return Section("speed-against-accuracy", "Speed against accuracy", missing=missing(sources, "accuracy"),
                   charts=(of_accuracy.speed(study),) if study else ())


def limits(sources):
    study = sources.read("limits", read_limits)
    return Section("where-methods-fail", "Where methods fail", charts=(of_limits.limits(study),) if study else (),
                   missing=missing(sources, "limits"))


def kept(sources):
    accuracy, longruns = sources.read("accuracy", read_accuracy), sources.read("longruns", read_longruns)
    return Section("energy-against-spectrum", "Energy error against spectrum error",
                   charts=(of_accuracy.kept(accuracy, longruns),) if accuracy or longruns else (),
                   missing=missing(sources, "accuracy", "longruns"))


def practice(sources):
    study = sources.read("practice", read_practice)
    heading = "What people run" + (f", {of_practice.sizes_text(study)}" if study else "")
    return Section("what-people-run", heading, charts=(of_practice.practice(study),) if study else (),
                   missing=missing(sources, "practice"))


def turbulence(sources):
    fluid, study = sources.read("fluid", read_fluid), sources.read("turbulence", read_turbulence)
    charts, html, lacking = [], "", [*missing(sources, "fluid", "turbulence")]
    if fluid:
        charts.append(of_flows.spectra(fluid))
        if picture := sources.path("fluid", PICTURE):
            html = picture_html(picture)
        else:
            lacking.append(rendered_anew("fluid", PICTURE))
    if study:
        if path := sources.path("turbulence", findings.FILE):
            found = findings.read_findings(path, "turbulence", TurbulenceFindings)
            charts.append(of_flows.statistics(study, found))
        else:
            lacking.append(rendered_anew("turbulence", findings.FILE))
    return Section("turbulence", "Turbulence", html, charts=tuple(charts), missing=tuple(lacking))


def rendered_anew(study, file):
    """Says that a file beside a raw file is not there, and how it is made."""
    return (f"Not on this page: {file} of the study {study}. <code>scripts/render {study}</code> makes it from the raw"
            " file.")


def picture_html(path):
    """Returns the HTML of the picture of a flow. Throws UnusableFile."""
    with naming(path):
        data = read_bytes(path)
        if not data.startswith(PNG):
            raise UnusableFile("is no PNG")
    return ('<div class="wide" tabindex="0"><img alt="Vorticity on the sphere, at the start and late by each method."'
            f' src="data:image/png;base64,{base64.b64encode(data).decode("ascii")}"></div>')


def claims(sources):
    path = sources.path("claims", "claims.json")
    if path is None:
        return Section("claims", "The paper's claims", missing=missing(sources, "claims"))
    rows, _ = read_claims_table(path)
    return Section("claims", "The paper's claims", as_html(as_markdown([Paragraph(EXPLAINED), claims_table(rows)])))


def history(sources):
    lines = sources.history
    if not lines:
        return Section("history", "History", missing=(
            NO_HISTORY if lines is None else "The history that was given has no run yet.",))
    return Section("history", "History", charts=(of_history.history(lines),))


DRAWN = ("accuracy", "limits", "longruns", "practice", "turbulence", "fluid", "claims")  # in sections of their own


def reports(sources):
    """Shows the reports of the studies: of a whole page those that no section above draws."""
    found = [(home, sources.path(home, REPORT)) for home in sources.folders
             if not sources.is_whole or home not in DRAWN]
    return Section("reports", "Reports", folded=tuple((title_of(home), as_html(text_in(path)))
                                                      for home, path in found if path))


def text_in(path):
    """Returns the text of a file. Throws UnusableFile, which names it."""
    with naming(path):
        return read_text(path)


def conditions(sources):
    folded = []
    for home in sources.folders:
        context = read_json(sources.path(home), lambda document, home=home: context_of(document, home))
        rows = "".join(f"<tr><th>{name.replace('_', ' ')}</th><td>{escape(one_line(context[name]))}</td></tr>"
                       for name in TOLD if context.get(name))
        folded.append((title_of(home), f'<div class="wide" tabindex="0"><table>{rows}</table></div>'))
    return Section("conditions", "Conditions of each run", folded=tuple(folded))


def context_of(document, home):
    if home != TABLES:
        require(document, f"raw file of the study {home}", "study", home)
    return printable_context(checked(document, {"context": an_object}, "it")["context"])


def title_of(home):
    """Returns the names of the studies of a package, and what they measure."""
    found = [study for study in STUDIES if study.home == home]
    title = found[0].title if len(found) == 1 else "the tables of the paper"
    return f"{', '.join(study.name for study in found)}: {title}"


SECTIONS: List[Callable] = [answer, tables, speed, limits, kept, practice, turbulence, claims, history, reports,
                            conditions]


def sections(sources):
    """Returns all Sections; those with nothing to show, and nothing missing, are left out. Throws UnusableFile."""
    found = [without_empty_charts(make(sources)) for make in SECTIONS]
    return [each for each in found if each.html or each.charts or each.below or each.folded or each.missing]


def without_empty_charts(section):
    """Returns a Section whose charts all have points; of the others it says that the run has none."""
    return section._replace(
        charts=tuple(chart for chart in section.charts if chart.commands),
        missing=(*section.missing, *(f"Not in this run: {chart.title}. It has no point to draw."
                                     for chart in section.charts if not chart.commands)))
