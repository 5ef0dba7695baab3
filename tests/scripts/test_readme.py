"""README.md shows what is recorded, and names what exists."""

import os
import re
import subprocess
import sys
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))


def readme():
    with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as file:
        return file.read()


class Readme(unittest.TestCase):
    def test_shows_the_recorded_table(self):
        check = subprocess.run([sys.executable, os.path.join(ROOT, "scripts", "update_readme"), "--check"],
                               capture_output=True, encoding="utf-8")
        self.assertEqual((check.returncode, check.stderr), (0, ""))

    def test_integrate_warns_by_the_recorded_limits(self):
        check = subprocess.run([sys.executable, os.path.join(ROOT, "scripts", "update_limits"), "--check"],
                               capture_output=True, encoding="utf-8")
        self.assertEqual((check.returncode, check.stderr), (0, ""))

    def test_names_only_files_that_exist(self):
        named = re.findall(r"`((?:core|benchmarks|tests|scripts|results)/[\w./-]*)`", readme())
        self.assertGreater(len(named), 10)
        for name in named:
            if not name.startswith("results/latest"):
                self.assertTrue(os.path.exists(os.path.join(ROOT, name)), name)

    def test_map_names_every_source_of_core(self):
        text = readme()
        for name in os.listdir(os.path.join(ROOT, "core")):
            stem = name.partition(".")[0]
            if stem != "CMakeLists":
                self.assertRegex(text, rf"`{stem}(\.h)?`", name)

    def test_links_lead_somewhere(self):
        for target in re.findall(r"\]\(([^)#:]+)\)", readme()):
            self.assertTrue(os.path.exists(os.path.join(ROOT, target)), target)


if __name__ == "__main__":
    unittest.main()
