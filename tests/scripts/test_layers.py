"""No module of scripts/lib imports against the list of modules in scripts/README.md, which names them all."""

import ast
import os
import re
import unittest

from programs import ROOT, text_of

LIB = os.path.join(ROOT, "scripts", "lib")
MODULES = [name[:-3] for name in os.listdir(LIB) if name.endswith(".py") and name != "__init__.py"]


def listed():
    """Returns the modules of the list, the lowest first."""
    section = text_of(ROOT, "scripts", "README.md").split("\n## The modules of lib\n")[1].split("\n## ")[0]
    return re.findall(r"^- `([a-z0-9_]+)`: \S", section, re.MULTILINE)


def imported(source):
    """Returns the modules of lib that a source imports, inside functions too."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            module = ".".join(filter(None, ("lib" * bool(node.level), node.module)))
            found += [f"lib.{alias.name}" for alias in node.names] if module == "lib" else [module]
    return [name.split(".")[1] for name in found if name.startswith("lib.")]


def upward(order, sources):
    """Returns (module, import) where a module imports what does not stand above it."""
    return [(module, each) for module in order for each in imported(sources[module])
            if each not in order[:order.index(module)]]


class Layers(unittest.TestCase):
    def test_the_list_names_every_module_once(self):
        self.assertEqual(sorted(listed()), sorted(MODULES))

    def test_no_import_against_the_list(self):
        order = listed()
        sources = {name: text_of(LIB, f"{name}.py") for name in order}
        self.assertEqual(upward(order, sources), [])
        self.assertGreater(sum(len(imported(source)) for source in sources.values()), 80)
        # Controls: each way to write an import that goes up.
        for line in ("from lib.charts import AGAINST_N", "from lib import charts", "import lib.charts",
                     "from . import charts", "from .charts import AGAINST_N",
                     "def later():\n    from lib import charts"):
            with self.subTest(line=line):
                wrong = {**sources, "formats": f"{sources['formats']}\n{line}\n"}
                self.assertEqual(upward(order, wrong), [("formats", "charts")])
        wrong = {**sources, "charts": f"{sources['charts']}\nfrom lib.gone import it\nfrom lib import charts\n"}
        self.assertEqual(upward(order, wrong), [("charts", "gone"), ("charts", "charts")])
        reversed_order = order[::-1]
        self.assertGreater(len(upward(reversed_order, sources)), 50)


if __name__ == "__main__":
    unittest.main()
