"""One file of HTML with all that it needs: data, styles, our script and Plotly's. It asks nothing of a network.

Needs Jinja2, Markdown, Plotly (for its script) and matplotlib (for the looks of the still charts).
"""

import json
import os

import jinja2
from plotly.offline import get_plotlyjs

from lib.records.formats import read_text
from report_page.charts import as_data
from report_page.sections import sections

FILE = "report.html"
HERE = os.path.dirname(os.path.realpath(__file__))


def in_script(text):
    """Returns a script, or data in one, that no browser takes the end of the script for."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def page(sources):
    """Returns the page of some Sources as bytes. Throws UnusableFile."""
    found = sections(sources)
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(HERE), undefined=jinja2.StrictUndefined,
                                     autoescape=True, trim_blocks=True, lstrip_blocks=True)
    data = [as_data(chart) for section in found for chart in section.charts]
    text = environment.get_template("page.html.in").render(
        sections=found, title="isosyrk" if sources.is_whole else f"isosyrk: {', '.join(sources.folders)}",
        style=read_text(os.path.join(HERE, "page.css")), script=in_script(read_text(os.path.join(HERE, "page.js"))),
        plotly=in_script(get_plotlyjs()), data=in_script(json.dumps(data, separators=(",", ":"), allow_nan=False)))
    return text.encode("utf-8")
