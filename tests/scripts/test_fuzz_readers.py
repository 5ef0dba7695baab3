"""Damaged files: each reader of scripts/ refuses one in a line, or what it returns can be rendered.

Every damaged file follows from its number, so that a failure comes again. $ISOSYRK_FUZZ_CASES is how many are tried
in all; a few thousand if it is not set.
"""

import copy
import json
import os
import random
import re
import signal
import sys
import tempfile
import unittest

import test_render_table1
from programs import ROOT, FolderTest
from stability_documents import SETTINGS, long_document, map_document
from study_documents import study_document

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
import accuracy_report  # noqa: E402
import comparison  # noqa: E402
import paper_table  # noqa: E402
import recommendation  # noqa: E402
import stability  # noqa: E402
import stability_report  # noqa: E402
import work_precision  # noqa: E402
from benchmark_json import FORMULATIONS, UnusableFile, read_run  # noqa: E402
from document import WRITERS  # noqa: E402

CASES = int(os.environ.get("ISOSYRK_FUZZ_CASES", "2000"))
NO_NUMBER = re.compile(r"(?i)(?<![a-z])(nan|inf)")
LONGEST_SECONDS = 10  # that reading and rendering a small file may take before it counts as endless

STRANGE = (None, True, False, 0, -1, 1, 2, 17, 10**14, 10**30, 10**400, -10**400, 0.5, 1e-320, 1e-100, 1e100, 1e308,
           -1e308, float("nan"), float("inf"), float("-inf"), "", "x", "0", "1e3", "converged", "unstable", "aggregate",
           "group2", "algebra", "a\nb", "\ud800", "\x00\x1b[2J", "x" * 5000, [], [1.0], [float("nan")], [[]], {},
           {"n": 17}, [[{}, [None]]])
FACTORS = (-1, 1e-300, 1e-20, 1e-3, 0.999999, 1.5, 1e3, 1e20, 1e300)
TOKENS = (b"NaN", b"Infinity", b"-Infinity", b"null", b"true", b"{}", b"[]", b'""', b"0", b"-", b"e9", b"1e999",
          b"9" * 30, b"9" * 5000, b"\\ud800", b"\\u0000", b"\\", b'"', b",", b":", b"\n", b"\r", b"\x00", b"\xff",
          b"\xef\xbb\xbf", "é".encode(), "\u2028".encode(), b"[" * 3000, b'{"a":' * 900, b"[" * 900 + b"]" * 900)
# Stand in a document for what json.dumps does not write.
DOUBLED, NESTED = "(doubled)", "(nested)"


# ---- damage


def some_place(document, choose):
    """Returns a list or object of a JSON document; a long list is no likelier than a short one."""
    place = document
    while True:
        inside = place.values() if isinstance(place, dict) else place
        deeper = [each for each in inside if isinstance(each, (dict, list)) and each]
        if not deeper or choose.random() < 0.4:
            return place
        place = choose.choice(deeper)


def strange(value, choose):
    """Returns a value to stand for another, as often as not one of its own type."""
    alike = [each for each in STRANGE if type(each) is type(value)]
    return copy.deepcopy(choose.choice(choose.choice((alike or STRANGE, STRANGE))))


def damage_place(place, key, other, choose):
    """Damages what stands at one key of a list or object."""
    kind = choose.choice(("replace", "replace", "replace", "scale", "scale", "remove", "rename", "swap", "copy", "wrap",
                          "nest", "double"))
    if kind == "scale" and type(place[key]) in (int, float) and abs(place[key]) < 1e300:
        place[key] *= choose.choice(FACTORS)
    elif kind == "remove":
        del place[key]
    elif kind == "swap":
        place[key], place[other] = place[other], place[key]
    elif kind == "copy":
        place[other] = copy.deepcopy(place[key])
    elif kind == "wrap":
        place[key] = choose.choice(([place[key]], {"n": place[key]}))
    elif kind == "nest":
        place[key] = f"{NESTED}{choose.choice((10, 500, *range(900, 1000)))}"
    elif isinstance(place, list) and kind in ("rename", "double"):
        place.insert(other, copy.deepcopy(place[key]))
    elif kind == "rename":
        place[choose.choice((f"{key}2", key[:-1], key.upper(), other))] = place.pop(key)
    elif kind == "double":
        place[key + DOUBLED] = choose.choice((copy.deepcopy(place[key]), strange(place[key], choose)))
    else:
        place[key] = strange(place[key], choose)


def damaged_values(text, choose):
    """Returns a JSON document in which a few values or keys are others, as the bytes of a file."""
    document = json.loads(text)
    for _ in range(choose.choice((1, 1, 1, 2, 3))):
        place = some_place(document, choose)
        keys = list(place) if isinstance(place, dict) else range(len(place))
        if keys:
            damage_place(place, choose.choice(keys), choose.choice(keys), choose)
    text = json.dumps(document).replace(DOUBLED, "")
    nest = choose.choice(("[]", ('{"a":', "}")))
    text = re.sub(rf'"{re.escape(NESTED)}(\d+)"', lambda match: nest[0] * int(match[1]) + "0" + nest[1] * int(match[1]),
                  text)
    return text.encode()


def damaged_bytes(whole, choose):
    """Returns the bytes of a file, some of which are lost, changed, doubled, or out of their place."""
    data = bytearray(whole)
    for _ in range(choose.choice((1, 1, 1, 2, 4))):
        begin, middle, end = sorted(choose.randrange(len(data) + 1) for _ in range(3))
        short = slice(begin, begin + choose.choice((1, 1, 2, 5, 20, 300)))
        kind = choose.choice(("cut", "flip", "digit", "overwrite", "insert", "delete", "double", "swap"))
        if kind == "cut":
            del data[choose.choice((begin, middle, end)):]
        elif kind == "flip" and begin < len(data):
            data[begin] ^= 1 << choose.randrange(8)
        elif kind == "digit":
            places = [match.start() for match in re.finditer(rb"[0-9.+-]", data)]
            if places:
                data[choose.choice(places)] = choose.choice(b"0123456789.-e")
        elif kind == "overwrite":
            data[short] = choose.choice(TOKENS)
        elif kind == "insert":
            data[begin:begin] = choose.choice(TOKENS)
        elif kind == "delete":
            del data[short]
        elif kind == "double":
            data[begin:begin] = data[short]
        elif kind == "swap":
            data[begin:end] = data[middle:end] + data[begin:middle]
    return bytes(data)


# ---- sound files, and all that is made of them


def table1_document():
    """Returns a raw file of table1 at one n: with reference errors, a failed cell, and too few repetitions of some."""
    cells = {(formulation, 17, 3): test_render_table1.rows_of(formulation, 17, 3, test_render_table1.repeated(0.01, 2),
                                                              relative_error=1e-5, reference_uncertainty=1e-14)
             for formulation in FORMULATIONS}
    cells["group", 17, 2] = test_render_table1.failed_rows("group", 17, 2)
    return test_render_table1.raw(sizes=(17,), repetitions=5, cells=cells)


def small_study_document():
    """Returns a study of few points: enough for an observed order and for every sentence of the report."""
    document = study_document()
    document["points"] = [each for each in document["points"] if each["steps"] in (5, 10, 50, 100)]
    document["tolerance_points"] = [each for each in document["tolerance_points"]
                                    if each["tolerance"] in (1e-4, 1e-8, 1e-13)]
    return document


def few_integrators(document, measured):
    """Keeps two integrators and what was measured of them."""
    kept = ("group1", "rk4")
    document["integrators"] = [each for each in document["integrators"] if each["name"] in kept]
    document[measured] = [each for each in document[measured] if each["integrator"] in kept]
    return document


def small_map():
    """Returns a map with few trials, so that many damaged ones take little time."""
    document = few_integrators(map_document(SETTINGS[:2]), "maps")
    for each in document["maps"]:
        each["trials"] = each["trials"][::4]
    return document


def small_long_runs():
    document = few_integrators(long_document(), "runs")
    for each in document["runs"]:
        each["samples"] = each["samples"][::6]
    return document


def published_bytes():
    with open(paper_table.PUBLISHED, "rb") as stream:
        return stream.read()


def read_table1(path):
    """Renders a file as scripts/render_table1 does; returns what is made of its numbers, without the conditions."""
    document = test_render_table1.script.table1(path)
    return [write(document).partition("Measurement conditions")[0] for write in WRITERS.values()]


def read_study(path):
    """Renders a file as render_accuracy (but for its charts) and recommend do."""
    study = work_precision.read_study(path)
    texts = [write(accuracy_report.accuracy_sections(study, {})) for write in WRITERS.values()]
    for n in study.sizes():
        for structure in recommendation.KEPT:
            question = (n, 1e-3, structure)
            try:
                found = recommendation.answer(study, n, None, *question[1:])
            except recommendation.Unanswerable as problem:
                texts.append(f"{problem}\n")
                continue
            texts.append(WRITERS["text"](recommendation.answer_document(study, found, *question, path)))
            json.dumps(recommendation.answer_data(study, found, *question, path), allow_nan=False)
    return texts


def rendered_stability(failures, runs=None):
    sections = stability_report.stability_sections(failures, runs, {})
    return [write(sections) for write in WRITERS.values()]


def read_map(path):
    """Renders a file as render_stability does, but for its charts."""
    return rendered_stability(stability.read_map(path))


def read_long_runs(path):
    """Renders a file beside a sound map."""
    return rendered_stability(stability.failure_map(small_map()), stability.read_long_runs(path))


class DamageTest(FolderTest):
    TESTS = 7

    def setUp(self):
        super().setUp()
        self.file = self.path("raw.json")
        self.addCleanup(signal.signal, signal.SIGALRM, signal.signal(signal.SIGALRM, self.too_long))
        self.addCleanup(signal.alarm, 0)

    def too_long(self, _number, _frame):
        raise TimeoutError(f"takes more than {LONGEST_SECONDS} seconds")

    def outcome(self, read, contents):
        """Returns whether a file was accepted."""
        with open(self.file, "wb") as stream:
            stream.write(contents)
        signal.alarm(LONGEST_SECONDS)
        try:
            texts = read(self.file)
        except UnusableFile as problem:
            self.assertNotRegex(str(problem), r"[\x00-\x1f\x7f-\x9f\u2028\u2029]")
            self.assertTrue(str(problem).startswith(self.file + ": "), str(problem)[:200])
            self.assertLess(len(str(problem)), 600)
            return False
        finally:
            signal.alarm(0)
        if not NO_NUMBER.search(contents.decode()):
            self.assertIsNone(NO_NUMBER.search("".join(texts)))
        return True

    def try_damaged(self, read, damage):
        """Tries this test's share of the cases; `damage` makes the contents of one."""
        self.assertTrue(self.outcome(read, damage(None)), "a sound file is refused")
        cases = max(100, CASES // self.TESTS)
        accepted = 0
        for number in range(cases):
            contents = damage(random.Random(number))
            try:
                accepted += self.outcome(read, contents)
            except Exception as problem:
                kept = tempfile.NamedTemporaryFile(prefix="isosyrk-damaged-", delete=False)
                with kept:
                    kept.write(contents)
                self.fail(f"case {number}, kept in {kept.name}: {type(problem).__name__}: {problem}")
        # Damage that is always refused, or never, tries nothing.
        self.assertTrue(cases // 100 < accepted < cases - cases // 100, f"{accepted} of {cases} accepted")

    def values_of(self, document):
        text = json.dumps(document)
        return lambda choose: damaged_values(text, choose) if choose else text.encode()

    def bytes_of(self, whole):
        return lambda choose: damaged_bytes(whole, choose) if choose else whole


class DamagedFilesTest(DamageTest):
    def test_values_of_a_table1(self):
        self.try_damaged(read_table1, self.values_of(table1_document()))

    def test_bytes_of_a_table1(self):
        self.try_damaged(read_table1, self.bytes_of(json.dumps(table1_document(), indent=1).encode()))

    def test_values_of_a_study(self):
        self.try_damaged(read_study, self.values_of(small_study_document()))

    def test_bytes_of_a_study(self):
        self.try_damaged(read_study, self.bytes_of(json.dumps(small_study_document()).encode()))

    def test_values_of_a_map(self):
        self.try_damaged(read_map, self.values_of(small_map()))

    def test_values_of_long_runs(self):
        self.try_damaged(read_long_runs, self.values_of(small_long_runs()))

    def test_bytes_of_the_published_table(self):
        raw = self.path("table1.json")
        with open(raw, "w", encoding="utf-8") as stream:
            json.dump(table1_document(), stream)
        run = read_run(raw, "table1", ())

        def read(path):
            table = comparison.Comparison(run, comparison.read_published(path), FORMULATIONS, (1, 2, 3))
            sections = [*comparison.times_section(table, "Times", "…"), *comparison.ratios_section(table)]
            return [write(sections) for write in WRITERS.values()]

        self.try_damaged(read, self.bytes_of(published_bytes()))


if __name__ == "__main__":
    unittest.main()
