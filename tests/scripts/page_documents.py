"""What the tests of the page to open share: results to make it of, and what is in a page."""

import os
import re

from practice_documents import NOISE, problem, rows, write_practice
from programs import strict_json, text_of

from lib.programs import chart_python
from lib.programs.places import RECORDED

MODULES = ("jinja2", "markdown", "plotly", "matplotlib")
MISSING = [each for each in MODULES if not chart_python.can_import([each])]
NOISES = {"rough": NOISE, "turbulence": tuple(2 * each for each in NOISE)}
PRACTICE = [("rough", 33), ("rough", 65), ("turbulence", 33), ("turbulence", 65)]  # that is made up


def write_results(folder):
    """Makes a folder of results: the recorded ones, with made-up practice where none is recorded yet."""
    os.mkdir(folder)
    for name in os.listdir(RECORDED):
        os.symlink(os.path.join(RECORDED, name), os.path.join(folder, name))
    if not os.path.exists(os.path.join(folder, "practice")):
        os.mkdir(os.path.join(folder, "practice"))
        write_practice(os.path.join(folder, "practice", "raw.json"), [problem(n, scene) for scene, n in PRACTICE],
                       [each for scene, n in PRACTICE for each in rows(n, scene=scene, noise=NOISES[scene])], [])
    return folder


def page_of(text):
    """Returns the parts of a page: its HTML without scripts, and the data of its charts by name."""
    data = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)[1]
    return re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL), {each["name"]: each for each in strict_json(data)}


def page_in(*path):
    return page_of(text_of(*path))


def column(chart, name):
    """Returns the values of a column of a chart, point by point."""
    found = next(each for each in chart["columns"] if each["name"] == name)
    return [found["values"][place] for place in found["places"]] if "places" in found else found["values"]


def commands(chart):
    return [" --".join(chart["parts"][part] for part in line) for line in chart["commands"]]
