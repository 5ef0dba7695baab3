"""Rooms: the imports of scripts/ against the table of its rooms, and the rooms of core/ against its README.md.

No module imports from a room above its own, nor a study from one that stands after it. CMake enforces core's rooms.
"""

import ast
import os
import re
import unittest

from programs import ROOT, text_of

from studies import PACKAGES

SCRIPTS = os.path.join(ROOT, "scripts")


def rooms_of_scripts():
    """Returns the rooms of the table in scripts/README.md as packages, the lowest first, a room for each study."""
    table = text_of(SCRIPTS, "README.md").split("\n| room | contents |\n")[1].split("\n\n")[0]
    rooms = re.findall(r"^\| `([\w./]+)` \|", table, re.MULTILINE)
    place = rooms.index("studies")
    return [*rooms[:place], *(f"studies/{package}" for package in PACKAGES), *rooms[place + 1:]]


def package_of(module, rooms):
    """Returns the place in `rooms` of a module as it is imported; None for one of another project."""
    path = module.replace(".", "/")
    return next((place for place, room in enumerate(rooms) if path == room or path.startswith(f"{room}/")), None)


def imported(source):
    """Returns the modules that a source imports, inside functions too, each with the names that it takes."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found += [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            found.append("relative")
    return found


def upward(sources, rooms):
    """Returns (module, import) where a module imports from a room above its own."""
    return [(module, each) for module, source in sources.items() for each in imported(source)
            if each == "relative" or (package_of(each, rooms) or 0) > package_of(module, rooms)]


class ScriptRooms(unittest.TestCase):
    def setUp(self):
        self.rooms = rooms_of_scripts()
        self.sources = {os.path.relpath(os.path.join(folder, name), SCRIPTS)[:-3].replace("/", "."):
                        text_of(folder, name) for folder, _, names in os.walk(SCRIPTS) for name in names
                        if name.endswith(".py") and folder != SCRIPTS and not name.startswith("__")}

    def test_every_module_is_in_a_room(self):
        self.assertEqual([module for module in self.sources if package_of(module, self.rooms) is None], [])
        self.assertEqual([room for room in self.rooms if not os.path.isdir(os.path.join(SCRIPTS, room))], [])

    def test_no_import_goes_up(self):
        self.assertEqual(upward(self.sources, self.rooms), [])
        self.assertGreater(sum(len(imported(source)) for source in self.sources.values()), 300)
        # Controls: each way to write an import that goes up.
        for line in ("from lib.pages.document import Table", "from lib.pages import document", "import gate.cells",
                     "from . import output", "def later():\n    from studies.claims import judge"):
            with self.subTest(line=line):
                wrong = {**self.sources, "lib.records.formats": f"{self.sources['lib.records.formats']}\n{line}\n"}
                self.assertEqual([module for module, _ in upward(wrong, self.rooms)], ["lib.records.formats"])
        self.assertGreater(len(upward(self.sources, self.rooms[::-1])), 100)


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
