"""A new study, as scripts/README.md adds one: a folder, and one line in the list; no other file knows its name."""

import os
import re
import shutil
import sys
import unittest

import drawing
from programs import BUILD, DONE, HAS_MODULE, ROOT, SANITIZED, FolderTest, environment, run, snapshot, text_of

NAME = "reversal"
BEFORE = '    Study("theorem"'  # the place in the list


def example(name):
    """Returns a file of the example on the page."""
    page = text_of(ROOT, "scripts", "README.md")
    return re.search(rf"<!-- {NAME}/{re.escape(name)}:begin -->\n```python\n(.*?)```\n", page, re.DOTALL)[1]


@unittest.skipUnless(HAS_MODULE and not SANITIZED, "without the module, or with a sanitizer's libraries")
class NewStudy(FolderTest):
    def setUp(self):
        super().setUp()
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(os.path.join(ROOT, "scripts"), self.path("scripts"), ignore=ignored)
        os.makedirs(self.path("results", "recorded"))
        shutil.copy(os.path.join(ROOT, "results", "recorded", "integrators.json"), self.path("results", "recorded"))
        self.before = snapshot(self.path("scripts"))
        for name in ("schema.py", "run.py", "report.py", "charts.py"):
            self.write(f"scripts/studies/{NAME}/{name}", example(name))
        listed = text_of(self.path("scripts", "studies", "__init__.py"))
        self.assertEqual(listed.count(BEFORE), 1)
        self.write("scripts/studies/__init__.py", listed.replace(BEFORE, example("record") + BEFORE))

    def script(self, name, *arguments):
        return run([drawing.PYTHON, "-B", self.path("scripts", name), *arguments], timeout=300,
                   env=environment(ISOSYRK_BUILD=BUILD, MPLCONFIGDIR=self.path("matplotlib")))

    def test_it_is_measured_rendered_and_listed(self):
        raw, out = self.path("raw.json"), self.path("out")
        done = self.script("measure", NAME, "--out", raw, "--n", "9", "17", "--integrator", "group2", "rk4", "rk8")
        self.assertEqual((done.returncode, done.stdout), (DONE, ""), done.stderr)
        done = self.script("render", NAME, raw, "--out", out)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (DONE, "", ""))
        self.assertEqual({*os.listdir(out)}, {"report.md", "figures.json", *(f"distance_against_n.{kind}"
                                                                             for kind in ("svg", "png"))})
        report = text_of(out, "report.md")
        self.assertIn("![Distance from the start", report)
        # What it is to show: a symmetric method comes back, to its iteration's tolerance, one that is not does not.
        distances = dict(re.findall(r"\| +17 \| (\w+) +\| +(\S+) \|", report))
        self.assertLess(float(distances["group2"]), 1e-11)
        self.assertGreater(float(distances["rk4"]), 1e-9)
        usage = run([sys.executable, "-B", self.path("scripts", "studies"), "usage"]).stdout
        self.assertIn("how far from its start a run ends", usage)
        parts = run([sys.executable, "-B", self.path("scripts", "studies"), "parts", NAME, "yes"]).stdout
        self.assertEqual(parts, f"Going back\t{NAME}\traw.json\t-\t--quick\n")

    def test_one_line_outside_its_folder(self):
        after = snapshot(self.path("scripts"))
        changed = [name for name, data in after.items() if data != self.before.get(name) and data is not None]
        mine = os.path.join("studies", NAME)
        self.assertEqual([name for name in changed if not name.startswith(mine)], ["studies/__init__.py"])
        lines = after["studies/__init__.py"].count(b"\n") - self.before["studies/__init__.py"].count(b"\n")
        self.assertEqual(lines, 1)

    def test_what_is_no_study_is_refused(self):  # so that the list decides
        self.write("scripts/studies/__init__.py", self.before["studies/__init__.py"])
        done = self.script("measure", NAME, "--out", self.path("raw.json"))
        self.assert_refused(done, NAME, "must be one of")


if __name__ == "__main__":
    unittest.main()
