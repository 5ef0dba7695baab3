"""Pages from templates: what a template may look up, what ends the rendering, and that the pages are rendered."""

import collections
import os
import re
import unittest

from programs import ROOT, FolderTest, text_of

from lib.pages import templates
from lib.programs.messages import UnusableFile
from lib.pages.templates import (Figures, aligned, count, digits, exponent, matching, page, percent, ratio,
                                 recorded_figures, span)

PAGES = ("README.md.in", os.path.join("results", "README.md.in"), os.path.join("results", "simulate.md.in"))
FIGURES = Figures("results/recorded/study/figures.json",
                  {"ratio": 1.8461, "cases": 47, "error": 2.28e-13, "share": 0.0643, "drift": -0.2512, "none": 0})


class Filters(unittest.TestCase):
    def test_figures_are_rounded_as_they_are_written(self):
        for written, expected in (
                (ratio(1.8461), "1.8"), (ratio(0.9964), "1.0"), (ratio(12.6), "13"), (ratio(0.00721), "0.0072"),
                (ratio(2), "2.0"), (ratio(99.6), "100"), (ratio(0), "0"), (digits(0.9964, 3), "0.996"),
                (digits(1564.2, 4), "1,564"), (digits(1564.2, 2), "1,600"), (digits(-0.25, 1), "−0.2"),
                (digits(1.05, 2), "1.0"), (digits(1.15, 2), "1.2"),  # half to even, of the decimal number
                (exponent(7.24e-6), "7.2e-6"), (exponent(9.96e-6), "1.0e-5"), (exponent(2.28e-13, 1), "2e-13"),
                (exponent(-7.24e-6), "−7.2e-6"), (exponent(1.05e-7, 3), "1.05e-7"), (exponent(38.7), "3.9e1"),
                (percent(0.0643), "6.4 %"), (percent(-0.163), "−16 %"), (percent(0.339), "34 %"),
                (percent(1.0), "100 %"), (count(8008), "8,008"), (count(0), "0"), (count(47.0), "47"),
                (count(-1200), "−1,200")):
            self.assertEqual(written, expected)

    def test_what_cannot_be_written_is_refused(self):
        for filter_of, value in ((ratio, "1.8"), (ratio, None), (percent, True), (count, "3"), (exponent, [1.0])):
            with self.subTest(value=value), self.assertRaises(TypeError):
                filter_of(value)
        with self.assertRaises(ValueError):
            count(1.5)

    def test_ranges_are_those_of_the_keys_that_match(self):
        figures = Figures("figures.json", {"gain.n17": 1.21, "gain.n129": 0.996, "gain.n33": 3.4, "gains": 9.9})
        self.assertEqual(sorted(matching(figures, "gain.n*")), [0.996, 1.21, 3.4])
        self.assertEqual(matching(figures, "gain.n17", "gain.n33"), [1.21, 3.4])
        self.assertEqual(span(matching(figures, "gain.n*")), "1.0–3.4")
        self.assertEqual(span([0.1, 0.32], "percent"), "10 %–32 %")
        self.assertEqual(span([1.01, 1.04]), "1.0")
        with self.assertRaisesRegex(ValueError, 'figures.json has no figure like "loss.*"'):
            matching(figures, "gain.*", "loss.*")

    def test_tables_are_aligned(self):
        table = "| a | b |\n| :-- | --: |\n| `x\\|y` | 1 |\n|  | 10.5 |\n"
        self.assertEqual(aligned(f"text | of\n\n{table}"),
                         "text | of\n\n| a      |    b |\n| :----- | ---: |\n| `x\\|y` |    1 |\n|        | 10.5 |\n")
        self.assertEqual(aligned(aligned(table)), aligned(table))
        with self.assertRaisesRegex(ValueError, "other numbers of cells"):
            aligned(table + "| 1 |\n")


class Templates(FolderTest):
    def page(self, text, **names):
        self.write("page.md.in", text)
        return page(self.folder, "page.md.in", {"study": FIGURES, **names})

    def assert_no_page(self, text, *parts, **names):
        with self.subTest(text=text), self.assertRaises(UnusableFile) as caught:
            self.page(text, **names)
        self.assert_one_line(f"{caught.exception}\n", "page.md.in", *parts)

    def test_a_page_has_its_figures_and_no_trace_of_conditions(self):
        text = ("It takes\n  {% expect study['ratio'] > 1 %}\n{{ study['ratio'] | ratio }}–{{ table() }} <!-- a -->\n"
                "{# gone #}\n{% for key in ('cases', 'none') %}\n- {{ study[key] | count }}\n{% endfor %}\n"
                "{{ 'yes' if 'cases' in study else 'no' }}, {{ 'yes' if 'case' in study else 'no' }}\n")
        self.assertEqual(self.page(text, table=lambda: "| 1 |"),
                         "It takes\n1.8–| 1 | <!-- a -->\n- 47\n- 0\nyes, no\n")

    def test_a_condition_that_does_not_hold_names_its_place_and_text(self):
        for condition, written in (("study['ratio']<1", 'study["ratio"] < 1'),
                                   ("not (study['cases'] in [47, 48])", 'not (study["cases"] in [47, 48])'),
                                   ("study.ratio | ratio == '1.9'", 'study.ratio | ratio == "1.9"'),
                                   ("study['none']", 'study["none"]')):
            self.assert_no_page(f"one\n\n  {{% expect {condition} %}}\n", "line 3", f"expected {written}")
        # Several lines of one condition, and one in a loop.
        self.assert_no_page("{% for key in study %}\n{% expect study[key]\n   > 0 %}\n{% endfor %}", "line 2",
                            "expected study[key] > 0")

    def test_a_condition_that_cannot_be_told_does_not_hold(self):
        for condition, part in (("study['ratios'] < 2", 'figures.json has no figure "ratios"'),
                                ("studies['ratio'] < 2", "'studies' is undefined"),
                                ("1 / study['none'] > 0", "zero"), ("study['ratio'] < 'a'", "not supported"),
                                ("'a' | ratio == 1", "no number")):
            self.assert_no_page(f"one\n{{% expect {condition} %}}\n", "line 2", "expected ", part)
        for condition in ("", "study[", "1 2", "1 | nothing"):
            self.assert_no_page(f"one\n{{% expect {condition} %}}\n", "line 2")

    def test_errors_are_told_in_one_line(self):
        for text, *parts in (("{{ study['ratios'] | ratio }}", 'results/recorded/study/figures.json has no figure'),
                             ("{{ studies }}", "'studies' is undefined"),
                             ("{{ study['ratio'] | count }}", "whole number"),
                             ("{{ study['ratio'] | round_up }}", "round_up"), ("{% if %}", "xpect"),
                             ("{% expects 1 %}", "expects"), ("{{ table() }}", "a file | is damaged")):
            def table():
                raise UnusableFile("a file\n| is damaged")
            self.assert_no_page(f"one\n{text}\n", "line 2", *parts, table=table)
        with self.assertRaises(UnusableFile) as caught:
            page(self.folder, "none.md.in", {})
        self.assert_one_line(f"{caught.exception}\n", "none.md.in", "cannot be read")

    def test_figures_of_every_study_are_found_and_damaged_ones_refused(self):
        self.write("results/recorded/one/figures.json", '{"a": 1}')
        self.write("results/recorded/two/report.md", "")
        self.assertEqual(recorded_figures(self.folder), {"one": {"a": 1}})
        self.write("results/recorded/two/figures.json", '{"a": "1"}')
        with self.assertRaises(UnusableFile) as caught:
            recorded_figures(self.folder)
        self.assert_one_line(f"{caught.exception}\n", "two/figures.json")


class Named(float):
    """A figure that knows its key."""

    def __new__(cls, value, key):
        made = super().__new__(cls, value)
        made.key = key
        return made


class LookedUp(Figures):
    """Figures that remember which of them were looked up, and give them as Named ones."""

    def __init__(self, study, figures):
        super().__init__(figures.path, figures)
        self.study, self.keys_seen = study, set()

    def __getitem__(self, key):
        self.keys_seen.add(key)
        return Named(super().__getitem__(key), self.name(key))

    def name(self, key):
        return f"[{self.study}: {key}]"


NAMES = {"table_of_verdicts": str, "table_of_claims": str, "exists": lambda path: True,
         "verdicts": collections.defaultdict(dict)}
EVERY = 5  # so many keys one is changed


class Pages(FolderTest):
    """The figures of the pages, in copies of their templates without conditions."""

    def template(self, name, **filters):
        self.write("page.md.in", re.sub(r"\{%-?\s*expect\b.*?%\}", "", text_of(ROOT, name), flags=re.S))
        environment = templates.environment_of(self.folder)
        environment.filters.update(filters)
        return environment.get_template("page.md.in")

    def by_key(self, name, span):
        """Returns a page with keys for figures, and the figures that were looked up. `span` writes ranges of them."""
        template = self.template(name, span=span, **dict.fromkeys(
            ("digits", "ratio", "exponent", "percent", "count"), lambda figure, *_: figure.key))
        figures = {study: LookedUp(study, found) for study, found in recorded_figures(ROOT).items()}
        return template.render({**figures, **NAMES}), figures

    def test_every_figure_that_a_page_looks_up_is_written_by_a_filter(self):
        for name in PAGES:
            shown, figures = self.by_key(name, lambda found, *_: "".join(figure.key for figure in found))
            for found in figures.values():
                for key in sorted(found.keys_seen):
                    self.assertIn(found.name(key), shown, name)

    def test_a_figure_that_has_changed_gives_another_page(self):
        for name in PAGES:
            by_key, figures = self.by_key(name, lambda *_: "")  # a range changes with its ends only
            named = [(study, key) for study, found in figures.items() for key in sorted(found.keys_seen)
                     if found.name(key) in by_key]
            self.assertGreater(len(named), 3 * EVERY, name)
            template, recorded = self.template(name), recorded_figures(ROOT)
            shown = template.render({**recorded, **NAMES})
            for study, key in named[::EVERY]:
                other = {**recorded[study], key: changed(recorded[study][key])}
                with self.subTest(page=name, study=study, key=key):
                    self.assertTrue(template.render({**recorded, **NAMES, study: Figures("", other)}) != shown)


def changed(figure):
    """Returns a figure that is a tenth larger, a whole one by one at least."""
    return 1.1 * figure if isinstance(figure, float) else figure + max(1, figure // 10)


if __name__ == "__main__":
    unittest.main()
