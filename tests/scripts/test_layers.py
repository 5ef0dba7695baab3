"""Layers: scripts/lib against the list of modules in scripts/README.md, and the rooms of core/ against its README.md.

No module of scripts/lib imports against the list, which names them all. The table of rooms says what CMake enforces.
"""

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


def rooms_of_cmake(text):
    """Returns {room: the rooms that it may see} in the order of core/CMakeLists.txt."""
    lines = re.findall(r"^isosyrk_room\((\w+)(?: MAY_SEE ([\w ]+))?\)$", text, re.MULTILINE)
    return {room: set(seen.split()) for room, seen in lines}


def rooms_of_page(text):
    """Returns the same from the table of core/README.md."""
    table = text.split("\n| room | may see | contents |\n")[1].split("\n\n")[0]
    rooms = {}
    for room, seen in re.findall(r"^\| `(\w+)` \| ([^|]+) \|", table, re.MULTILINE):
        above, _, but = seen.partition(" but ")
        if above == "all above":
            rooms[room] = set(rooms) - set(re.findall(r"`(\w+)`", but))
        else:
            rooms[room] = set() if seen == "–" else set(seen.split(", "))
    return rooms


def names_of_no_file(page):
    """Returns (room, name) where the contents of a room have a name that none of its headers and sources has."""
    table = page.split("\n| room | may see | contents |\n")[1].split("\n\n")[0]
    rows = re.findall(r"^\| `(\w+)` \| [^|]+ \| (.*) \|$", table, re.MULTILINE)
    return [(room, name) for room, contents in rows for name in re.findall(r"`(\w+)`", contents)
            if not any(os.path.exists(os.path.join(ROOT, "core", room, name + end)) for end in (".h", ".cpp"))]


class Rooms(unittest.TestCase):
    def test_the_page_names_what_is_there(self):
        page = text_of(ROOT, "core", "README.md")
        self.assertEqual(names_of_no_file(page), [])
        self.assertGreater(len(re.findall(r"`\w+`", page.split("\n## ")[0])), 70)
        # Control: a file that has gone.
        self.assertEqual(names_of_no_file(page.replace("`spectrum`", "`spectre`")), [("linalg", "spectre")])

    def test_the_page_says_what_cmake_enforces(self):
        page, cmake = text_of(ROOT, "core", "README.md"), text_of(ROOT, "core", "CMakeLists.txt")
        told, built = rooms_of_page(page), rooms_of_cmake(cmake)
        told.pop("python")  # not a library
        self.assertEqual(list(told.items()), list(built.items()))
        self.assertGreater(len(built), 9)
        # Controls: a room that may see more than the page says, one that the page forgets, another order.
        for line, wrong in (("(scenes MAY_SEE linalg flows)", "(scenes MAY_SEE linalg flows split)"),
                            ("isosyrk_room(iteration)\n", ""),
                            ("isosyrk_room(iteration)\nisosyrk_room(linalg)\n",
                             "isosyrk_room(linalg)\nisosyrk_room(iteration)\n")):
            with self.subTest(line):
                self.assertEqual(cmake.count(line), 1)
                self.assertNotEqual(list(told.items()), list(rooms_of_cmake(cmake.replace(line, wrong)).items()))

    def test_nothing_in_core_includes_the_programs(self):
        core = os.path.join(ROOT, "core")
        sources = {os.path.join(folder, name): text_of(folder, name)
                   for folder, _, names in os.walk(core) for name in names if name.endswith((".h", ".cpp"))}
        include = re.compile(r'^ *# *include *["<](?:\.\./)*benchmarks/', re.MULTILINE)
        self.assertGreater(len(sources), 150)
        self.assertEqual([path for path, text in sources.items() if include.search(text)], [])
        # Control: what includes them is seen.
        self.assertTrue(include.search(text_of(ROOT, "benchmarks", "conditions_module.cpp")))


if __name__ == "__main__":
    unittest.main()
