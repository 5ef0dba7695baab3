"""Tests of lib/templates.py: how figures are written, conditions, errors in one line, and figures of the pages."""

import os
import re
import unittest

from programs import ROOT, FolderTest, text_of

from lib import templates
from lib.messages import UnusableFile
from lib.templates import Figures, count, digits, exponent, page, percent, ratio, recorded_figures

PAGES = ("README.md.in", os.path.join("results", "README.md.in"))
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


class Templates(FolderTest):
    def page(self, text, **names):
        self.write("page.md.in", text)
        return page(self.folder, "page.md.in", {"study": FIGURES, **names})

    def assert_no_page(self, text, *parts, **names):
        with self.subTest(text=text), self.assertRaises(UnusableFile) as caught:
            self.page(text, **names)
        self.assert_one_line(f"{caught.exception}\n", "page.md.in", *parts)

    def test_a_page_has_its_figures_and_no_trace_of_conditions(self):
        text = ("It takes\n  {% expect study['ratio'] > 1 %}\n{{ study['ratio'] | ratio }}–{{ table() }} <!-- kept -->\n"
                "{# gone #}\n{% for key in ('cases', 'none') %}\n- {{ study[key] | count }}\n{% endfor %}\n"
                "{{ 'yes' if 'cases' in study else 'no' }}, {{ 'yes' if 'case' in study else 'no' }}\n")
        self.assertEqual(self.page(text, table=lambda: "| 1 |"),
                         "It takes\n1.8–| 1 | <!-- kept -->\n- 47\n- 0\nyes, no\n")

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


class Printed(Figures):
    """Figures that remember which of them a page looked up."""

    def __init__(self, figures):
        super().__init__(figures.path, figures)
        self.keys_seen = set()

    def __getitem__(self, key):
        self.keys_seen.add(key)
        return super().__getitem__(key)


class Pages(FolderTest):
    """The figures of README.md and results/README.md, in copies of their templates without conditions."""

    def test_every_figure_that_a_page_prints_can_be_wrong(self):
        tables = dict.fromkeys(("table1", "verdicts", "claims_table"), lambda: "")
        for name in PAGES:
            self.write("page.md.in", re.sub(r"\{%-?\s*expect\b.*?%\}", "", text_of(ROOT, name), flags=re.S))
            template = templates.environment_of(self.folder).get_template("page.md.in")
            figures = {study: Printed(found) for study, found in recorded_figures(ROOT).items()}
            shown = template.render({**figures, **tables})
            used = [(study, key) for study, found in figures.items() for key in sorted(found.keys_seen)]
            self.assertGreater(len(used), 20, name)
            for study, key in used:
                other = Figures("", figures[study])
                other[key] = 1.1 * other[key] if isinstance(other[key], float) else other[key] + 1
                with self.subTest(page=name, study=study, key=key):
                    self.assertTrue(template.render({**figures, **tables, study: other}) != shown)


if __name__ == "__main__":
    unittest.main()
