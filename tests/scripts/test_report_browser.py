"""The page to open, in a headless Chromium: what its controls draw, what it tells of a point, and that it asks nobody.

Where no Chromium is installed this is skipped. One browser serves all tests, and one page.
"""

import json
import os
import shutil
import tempfile
import time
import unittest

import programs  # noqa: F401, which makes lib importable
from browser import CHROMIUM, Browser
from page_documents import MISSING, column, commands, page_of, write_results

from lib.judging.verdicts import Ratio
from lib.records.history import GATE, TABLE1, line_of

LONGEST = 20  # seconds until a page is there; on an idle machine it takes under 3, and here others run too
DRAWN = "JSON.stringify(chart.plot.data.map(({name, x, y, text}) => [name, x, y, text]))"
MOST = 12  # options of a selector that are tried: of 70 methods too
PHONE, WIDE = (390, 800), (1400, 1000)


def history():
    """Returns the Lines of two processors and two programs."""
    return [line_of(program, {"cpu": cpu, "commit": commit, "dirty": dirty}, "kernels", [
        (what, Ratio(ratio, 0.9 * ratio, 1.1 * ratio, 6)) for what in ("first", "second")])
        for program, cpu, commit, dirty, ratio in (
            (TABLE1, "one", "a", "no", 2.0), (TABLE1, "one", "b", "yes", 2.1), (TABLE1, "two", "c", "no", 4.0),
            (GATE, "one", "d", "no", 1.01))]


def setUpModule():
    if CHROMIUM is None:
        raise unittest.SkipTest("no Chromium is installed")
    if MISSING:
        raise unittest.SkipTest(f"this Python has no {', '.join(MISSING)}")
    from report_page.page import page
    from report_page.sections import recorded_sources

    folder = tempfile.mkdtemp(prefix="isosyrk-")
    unittest.addModuleCleanup(shutil.rmtree, folder, ignore_errors=True)
    text = page(recorded_sources(write_results(os.path.join(folder, "results")), history())).decode("utf-8")
    # Control: a page that asks for a picture, and whose script fails.
    broken = text.replace("</main>", '<img src="http://127.0.0.1:9/picture.png"><script>nobody();</script></main>')
    for name, contents in (("report.html", text), ("broken.html", broken)):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as stream:
            stream.write(contents)
    BrowserTest.charts = page_of(text)[1]
    BrowserTest.url, BrowserTest.broken = (f"file://{folder}/{name}.html" for name in ("report", "broken"))
    BrowserTest.browser = Browser(os.path.join(folder, "profile"))
    unittest.addModuleCleanup(BrowserTest.browser.close)


class BrowserTest(unittest.TestCase):
    """Tests by the browser, and the page, that setUpModule() makes."""

    is_open = False  # as it was made, but for what was chosen

    def open(self, address="", size=WIDE, scheme="light"):
        """Has the page open, with all charts drawn as an address says. Loading it takes most of the time of a test."""
        if not BrowserTest.is_open:
            self.load(self.url)
        self.browser.look_as(*size, scheme)
        self.browser.problems.clear()
        self.value(f"history.replaceState(null, '', location.pathname + {json.dumps(address)}); address.read();"
                   "charts.forEach(chart => { chart.begin(); chart.details.open = false; chart.restore(); })")

    def load(self, url):
        """Opens a page anew; returns the seconds until it was there."""
        self.browser.look_as(*WIDE, "light")
        self.browser.open("about:blank")
        self.browser.requests.clear()
        self.browser.problems.clear()
        seconds = self.browser.open(url)
        BrowserTest.is_open = url == self.url
        return seconds

    def value(self, expression):
        return self.browser.value(expression)

    def of(self, name, expression):
        """Returns the value of an expression of a chart."""
        return self.value(f"(() => {{ const chart = charts.find(each => each.spec.name === '{name}');"
                          f" return {expression}; }})()")

    def drawn(self, name):
        return self.of(name, DRAWN)

    def select(self, name, selector, label):
        """Chooses an option as a reader does."""
        self.of(name, f"""(select => {{
            [...select.options].find(each => each.value === {json.dumps(label)}).selected = true;
            select.dispatchEvent(new Event("change")); }})(chart.control("{selector}"))""")

    def place_of(self, name, row):
        """Returns where a point of a chart is in the window, in pixels."""
        return self.of(name, f"""(() => {{
            chart.figure.scrollIntoView();
            const box = chart.plot.getBoundingClientRect(), {{xaxis, yaxis}} = chart.plot._fullLayout;
            const at = (axis, of) => axis._offset + axis.d2p(chart.columns[of.column][{row}]);
            return [box.left + at(xaxis, chart.spec.x), box.top + at(yaxis, chart.spec.y)]; }})()""")

    def awaited(self, expression):
        """Returns the value of an expression once that is true."""
        for _ in range(100):
            found = self.value(expression)
            if found:
                return found
            time.sleep(0.05)
        return self.fail(f"never true: {expression}")


class Loading(BrowserTest):
    def test_it_is_there_soon_without_an_error_and_asks_for_nothing(self):
        self.assertLess(self.load(self.url), LONGEST)
        self.value("charts.forEach(chart => chart.begin())")
        self.assertEqual(self.value("charts.map(chart => chart.plot.data.length > 0)"), [True] * len(self.charts))
        self.assertEqual(len(self.charts), 8)
        self.assertEqual(self.browser.problems, [])
        self.assertEqual([each for each in self.browser.requests if not each.startswith("data:")], [self.url])
        # So that the test can fail:
        self.load(self.broken)
        self.assertTrue(any("nobody is not defined" in each for each in self.browser.problems))
        self.assertTrue(any("picture.png" in each for each in self.browser.problems))

    def test_charts_are_drawn_when_they_come_near(self):
        self.load(self.url)
        self.assertLess(self.value("begun().length"), len(self.charts))
        for name in self.charts:
            self.value(f"document.getElementById('{name}').scrollIntoView()")
            self.awaited(f"begun().some(chart => chart.spec.name === '{name}')")


class Selectors(BrowserTest):
    def test_each_option_changes_what_is_drawn(self):
        self.open()
        for name, chart in self.charts.items():
            for selector in chart["selectors"]:
                seen = self.of(name, f"""(select => [...select.options]
                    .filter(each => !each.disabled).slice(0, {MOST})
                    .map(option => {{ option.selected = true; chart.draw(); return [option.value, {DRAWN}]; }})
                    )(chart.control("{selector['column']}"))""")
                with self.subTest(chart=name, selector=selector["column"]):
                    self.assertGreater(len(seen), 1)
                    self.assertEqual(len({drawn for _, drawn in seen}), len(seen), [label for label, _ in seen])
                self.of(name, "chart.restore()")

    def test_an_option_that_leaves_nothing_is_disabled(self):
        self.open()
        self.select("speed", "scene", "smooth, T = 50")
        disabled = self.of("speed", "[...chart.control('n').options].filter(each => each.disabled)")
        self.assertEqual(len(disabled), 1)
        self.select("speed", "scene", "smooth, T = 5")
        self.select("speed", "n", "257")
        self.select("speed", "scene", "smooth, T = 50")  # then another n is chosen
        self.assertNotEqual(self.of("speed", "chart.control('n').value"), "257")
        self.assertGreater(self.of("speed", "chart.rows.length"), 0)

    def test_the_front_is_in_colour_and_what_is_beaten_is_grey(self):
        self.open("#speed.scene=smooth%2C+T+%3D+5&speed.n=33")
        chart = self.charts["speed"]
        rows = [row for row, place in enumerate(zip(column(chart, "scene"), column(chart, "n")))
                if place == ("smooth, T = 5", 33)]
        errors, seconds = column(chart, "error"), column(chart, "seconds")
        front = {row for row in rows if not any(
            errors[other] <= errors[row] and seconds[other] <= seconds[row] and other != row for other in rows)}
        grey, *colours = self.of("speed", "chart.plot.data.map(({marker, customdata}) => [marker.color, customdata])")
        self.assertEqual({row for _, drawn in colours for row in drawn}, front)
        self.assertEqual({*grey[1]}, {*rows} - front)
        looks = {each["color"] for name, each in chart["looks"].items() if name != chart["beaten"]}
        self.assertLessEqual({colour for colour, _ in colours}, looks)
        self.assertNotIn(grey[0], looks)

    def test_no_two_series_that_are_drawn_are_alike_in_grey(self):
        self.open()
        looks = "chart.plot.data.map(({mode, marker, line}) => JSON.stringify([mode, [marker.symbol].flat()[0]"\
                ".replace(/-open.*/, ''), [marker.symbol].flat()[0], line.dash, line.width]))"
        for name in self.charts:
            options = {selector: self.of(name, f"[...chart.control('{selector}').options].map(each => each.value)")
                       for selector in ("scene", "n") if self.of(name, f"!!chart.control('{selector}')")}
            for scene in options.get("scene", [""]):
                for n in options.get("n", [""]):
                    for selector, value in (("scene", scene), ("n", n)):
                        if value:
                            self.select(name, selector, value)
                    drawn = self.of(name, looks)
                    with self.subTest(chart=name, scene=scene, n=n):
                        self.assertEqual(len(set(drawn)), len(drawn), drawn)

    def test_by_keyboard(self):
        self.open()
        before = self.drawn("tables")
        self.of("tables", "chart.control('stages').focus()")
        self.browser.press("ArrowUp", 38)
        self.assertNotEqual(self.drawn("tables"), before)
        first = self.of("tables", "chart.command.value")
        self.of("tables", "chart.points.focus()")
        self.browser.press("ArrowDown", 40)
        self.assertNotEqual(self.of("tables", "chart.command.value"), first)
        # All that acts on a chart is reached by the tabulator.
        self.assertEqual(self.value("[...document.querySelectorAll('figure :is(select, input, button, summary)')]"
                                    ".filter(each => each.tabIndex < 0).length"), 0)


class Lines(BrowserTest):
    def test_a_line_is_broken_where_a_method_has_no_point(self):
        self.open()
        BrowserTest.is_open = False  # for others, since it loses a point
        middle = self.of("tables", """(() => {
            const {n, stages, series} = chart.columns;
            const gone = n.findIndex((size, row) =>
                size === 65 && stages[row] === 3 && series[row] === "algebra, fast");
            chart.all = chart.all.filter(row => row !== gone);
            chart.draw();
            return chart.plot.data.find(each => each.name === "algebra, fast"); })()""")
        self.assertEqual((middle["x"], middle["y"][2], middle["customdata"][2]), ([17, 33, None, 129], None, None))
        other = self.of("tables", "chart.plot.data.find(each => each.name === 'cotangent, fast')")
        self.assertEqual((other["x"], self.browser.problems), ([17, 33, 65, 129], []))


class Points(BrowserTest):
    def test_hover_tells_the_figures_of_the_raw_file(self):
        self.open()
        for name, told in (("speed", ("integrator", "form", "step", "error", "seconds", "products", "sweeps")),
                           ("limits", ("integrator", "outcome", "norm"))):
            row = self.of(name, "chart.order[0]")
            self.browser.move_to(5, 5)
            self.browser.move_to(*self.place_of(name, row))
            text = self.awaited(f"document.querySelector('#{name} .hoverlayer .hovertext')?.textContent")
            with self.subTest(chart=name):
                for each in told:
                    value = column(self.charts[name], each)[row]
                    shown = self.value(f"String(told({json.dumps(value)}))")
                    self.assertIn(shown, text)
                    if isinstance(value, float):
                        self.assertAlmostEqual(float(shown) / value, 1, places=3)

    def test_a_click_shows_the_command_which_can_be_copied(self):
        self.open()
        rows = self.of("speed", "[...chart.plot.data.at(-1).customdata]")
        self.browser.click(*self.place_of("speed", rows[0]))
        self.awaited("/speed.point=[a-z0-9]/.test(location.hash)")
        line = commands(self.charts["speed"])[rows[0]]
        self.assertEqual(self.of("speed", "chart.command.value"), line)
        self.assertEqual(self.of("speed", "Number(chart.points.value)"), rows[0])
        self.of("speed", "chart.figure.querySelector('button').click()")
        self.assertEqual(self.value("getSelection().toString() || document.activeElement.value"), line)

    def test_the_chart_tells_of_a_point_that_is_chosen_from_the_list(self):
        self.open()
        self.of("speed", "chart.figure.scrollIntoView()")
        row = self.of("speed", "chart.order.at(-1)")
        self.of("speed", f"(chart.points.value = {row}, chart.points.dispatchEvent(new Event('change')))")
        text = self.awaited("document.querySelector('#speed .hoverlayer .hovertext')?.textContent")
        self.assertIn(self.value(f"told({json.dumps(column(self.charts['speed'], 'error')[row])})"), text)

    def test_enter_in_the_command_does_nothing(self):
        self.open()
        self.of("speed", "chart.command.focus()")
        self.browser.press("Enter", 13)
        time.sleep(0.2)
        self.assertEqual(self.value("location.search + document.querySelectorAll('form').length"), "0")

    def test_the_table_behind_has_what_is_drawn(self):
        self.open()
        for name in self.charts:
            self.of(name, "chart.details.open = true")
            rows = self.of(name, "chart.rows.length")
            self.awaited(f"document.querySelectorAll('#{name} .behind tr').length === {rows + 1}")
        cells = self.of("speed", "[...chart.details.querySelectorAll('tr')[1].children].map(each => each.textContent)")
        row = self.of("speed", "chart.order[0]")
        self.assertEqual((cells[0], cells[-1]), (column(self.charts["speed"], "integrator")[row],
                                                 commands(self.charts["speed"])[row]))


class Address(BrowserTest):
    def test_what_is_chosen_is_in_it_and_is_found_again(self):
        self.open()
        first = self.drawn("speed")
        self.select("speed", "n", "33")
        self.select("limits", "scene", "rough")
        address = self.value("location.hash")
        self.assertIn("speed.n=33", address)
        chosen = self.drawn("speed"), self.drawn("limits")
        self.assertNotEqual(chosen[0], first)
        self.load(self.url + address)
        self.value("charts.forEach(chart => chart.begin())")
        self.assertEqual((self.drawn("speed"), self.drawn("limits")), chosen)
        self.value("location.hash = '#speed.n=129'")  # another one, and what it does not say is as at first
        self.awaited("charts.find(each => each.spec.name === 'speed').control('n').value === '129'")
        self.assertEqual(self.of("limits", "chart.control('scene').value"), "smooth")
        self.open("#speed.n=12345&nobody=1&turbulence")
        self.assertEqual((self.drawn("speed"), self.browser.problems), (first, []))

    def test_a_link_to_a_section_keeps_what_is_chosen(self):
        self.open("#speed.n=33")
        chosen = self.drawn("speed")
        self.value("document.querySelector('nav a[href=\"#turbulence\"]').click()")
        self.awaited("location.hash.includes('at=turbulence')")
        self.assertEqual(self.drawn("speed"), chosen)
        self.select("limits", "scene", "rough")
        self.assertIn("speed.n=33", self.value("location.hash"))
        self.value("location.hash = '#turbulence'")
        self.awaited("location.hash.includes('at=turbulence')")
        self.load(self.url + self.value("location.hash"))
        self.assertLess(abs(self.value("document.getElementById('turbulence').getBoundingClientRect().top")), 50)
        self.value("charts.forEach(chart => chart.begin())")
        self.assertEqual(self.drawn("speed"), chosen)
        self.load(self.url + "#limits.scene=rough")  # to its chart, though nothing says `at`
        self.assertLess(abs(self.value("document.getElementById('limits').getBoundingClientRect().top")), 50)

    def test_it_says_what_is_drawn_when_another_option_had_to_be_chosen(self):
        self.open()
        self.select("speed", "scene", "smooth, T = 5")
        self.select("speed", "n", "257")
        self.select("speed", "scene", "smooth, T = 50")
        self.assertEqual(self.of("speed", "chart.control('n').value"), "65")  # the one of first sight
        self.assertIn("speed.n=65", self.value("location.hash"))

    def test_a_point_is_found_again_by_its_run_and_forgotten_with_the_selection(self):
        self.open()
        row = self.of("speed", "chart.order[3]")
        self.of("speed", f"chart.show({row}, true)")
        address = self.value("location.hash")
        self.load(self.url + address)
        self.value("charts.forEach(chart => chart.begin())")
        self.assertEqual(self.of("speed", "Number(chart.points.value)"), row)
        self.select("speed", "n", "33")
        self.select("speed", "n", "65")
        self.assertNotEqual(self.of("speed", "Number(chart.points.value)"), row)
        names = self.of("speed", "chart.rows.map(chart.named)")
        self.assertEqual(len(set(names)), len(names))


class Looks(BrowserTest):
    def test_light_and_dark_as_the_reader_prefers(self):
        self.open()
        seen = {}
        for scheme in ("light", "dark", "light"):
            self.browser.look_as(*WIDE, scheme)
            ground = self.awaited(f"matchMedia('(prefers-color-scheme: {scheme})').matches"
                                  " && getComputedStyle(document.body).backgroundColor")
            trace = self.of("tables", "chart.plot.data.at(-1)")
            look = self.charts["tables"]["looks"][trace["name"]]
            self.assertEqual(trace["line"]["color"], look["dark" if scheme == "dark" else "color"])
            seen[scheme] = ground, self.of("tables", "chart.plot._fullLayout.paper_bgcolor")
        self.assertNotEqual(*seen.values())
        self.assertNotEqual(*(paper for _, paper in seen.values()))

    def test_a_phone_has_it_without_scrolling_sideways(self):
        self.open(size=PHONE)
        # Plotly fits its charts to a window a moment after that has changed.
        self.awaited(f"charts.every(chart => chart.plot._fullLayout.width <= {PHONE[0]})")
        self.assertLessEqual(self.value("document.documentElement.scrollWidth"), PHONE[0])
        for name in self.charts:  # the chart itself is large enough beside its key
            width, height = self.of(name, "[chart.plot._fullLayout._size.w, chart.plot._fullLayout._size.h]")
            self.assertGreater(min(width, height), 120, name)


if __name__ == "__main__":
    unittest.main()
