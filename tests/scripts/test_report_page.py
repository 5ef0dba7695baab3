"""The page to open, report.html: what it is made of, what its commands repeat, and what it says is missing.

Nothing here needs a browser; test_report_browser.py has what does.
"""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

from page_documents import MISSING, column, commands, page_in, page_of, write_results
from programs import BUILD, DONE, HAS_MODULE, ROOT, SANITIZED, FolderTest, environment, program, run, text_of

from lib.judging.verdicts import Ratio
from lib.programs.messages import UnusableFile
from lib.programs.places import RECORDED
from lib.records import findings, history
from lib.records.formats import listed_integrators
from lib.records.settings import TIGHT

PAGE, HISTORY = (os.path.join(ROOT, "scripts", name) for name in ("page", "history"))
HERE = os.path.join(ROOT, "scripts", "report_page")
INTEGRATE = program("integrate")
MAX_BYTES, MAX_LINES = 12 * 10**6, 200
SEEN = 3  # least contrast of marks that are no text, by WCAG 2.1
IN_ORDER = ["The answer", "Table 1 and Table 2", "Speed against accuracy", "Where methods fail",
            "Energy error against spectrum error", "What people run", "Turbulence", "The paper's claims", "History",
            "Reports", "Conditions of each run"]
CHARTS = ["tables", "speed", "limits", "kept", "practice", "spectra", "statistics"]
OPTIONS = {"n", "integrator", "formulation", "stages", "solver", "step", "time", "tolerance", "scene", "initial",
           "output"}


def options_of(command):
    """Returns the options of the last program in a line, by name; throws ValueError for what is none."""
    name, *words = shlex.split(command.rpartition(" && ")[2])
    if name != "build/benchmarks/integrate" or len(words) % 2:
        raise ValueError(f"no line of the program integrate: {command}")
    found = dict(zip(words[::2], words[1::2]))
    if unknown := {each.removeprefix("--") for each in found} - OPTIONS:
        raise ValueError(f"has --{min(unknown)}: {command}")
    return {option.removeprefix("--"): value for option, value in found.items()}


@unittest.skipIf(MISSING, f"this Python has no {', '.join(MISSING)}")
class PageTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.settings = tempfile.mkdtemp(prefix="isosyrk-")  # of matplotlib
        self.addCleanup(shutil.rmtree, self.settings, ignore_errors=True)

    def page(self, *arguments, **changes):
        """Runs scripts/page to its end."""
        return run([sys.executable, "-B", PAGE, *arguments],
                   env=environment(**{"MPLCONFIGDIR": self.settings, **changes}))

    def page_of_study(self, home, folder=None):
        """Returns the parts of the page of a run of one study, by default the recorded one."""
        from report_page.page import page
        from report_page.sections import Sources
        return page_of(page(Sources({home: folder or os.path.join(RECORDED, home)}, False)).decode("utf-8"))


class WholePage(PageTest):
    """The page of all recorded runs, made once."""

    @classmethod
    def setUpClass(cls):
        if MISSING:
            return
        from report_page.page import page
        from report_page.sections import recorded_sources

        folder = tempfile.mkdtemp(prefix="isosyrk-")
        cls.addClassCleanup(shutil.rmtree, folder, ignore_errors=True)
        cls.bytes = page(recorded_sources(write_results(os.path.join(folder, "results"))))
        cls.html, cls.charts = page_of(cls.bytes.decode("utf-8"))

    def test_sections_stand_in_their_order_and_what_there_is_none_of_is_said(self):
        headings = [each.replace("&#39;", "'") for each in re.findall(r"<h2>(.*?)</h2>", self.html)]
        self.assertEqual([each.partition(",")[0] for each in headings], IN_ORDER)
        self.assertEqual(list(self.charts), CHARTS)
        self.assertEqual(re.findall(r'<p class="missing">(.{20})', self.html), ["No history was given"])

    def test_the_answer_is_that_of_the_readme(self):
        answer = re.search(r'<section id="answer".*?</section>', self.html, re.DOTALL)[0]
        bold = re.findall(r"^\d\. \*\*(.*?)\*\*", text_of(ROOT, "README.md"), re.MULTILINE)
        self.assertEqual((len(bold), answer.count("<li>")), (3, 3))
        for each in bold:
            self.assertIn(f"<strong>{each}</strong>", answer)
        self.assertNotIn("(more", answer)  # a link into the repository

    def test_nothing_is_asked_of_a_network_and_it_is_small(self):
        self.assertLess(len(self.bytes), MAX_BYTES)
        self.assertGreater(len(self.bytes), 3 * 10**6)  # Plotly is in it
        sources = re.findall(r'(?:src|href|action|poster|srcset)="([^"]*)"', self.html)
        self.assertGreater(len(sources), 10)
        for value in sources:
            self.assertRegex(value, "^(#|data:|https://arxiv.org)")
        self.assertIn("default-src 'none'", self.html)
        self.assertNotRegex(text_of(HERE, "page.js"), r"fetch\(|XMLHttp|https?:|import\(")

    def test_scripts_are_whole_whatever_they_quote(self):
        self.assertEqual(self.bytes.count(b"</script>"), 3)  # data, Plotly's, ours
        self.assertEqual(self.html.count("<script"), 0)

    def test_our_script_is_short(self):
        self.assertLessEqual(len(text_of(HERE, "page.js").splitlines()), MAX_LINES)

    def test_points_look_as_in_the_still_charts_and_stand_out_from_a_dark_page(self):
        from lib.pages.chart_panels import FAMILY_COLOURS, FORMULATION_COLOURS, look
        from lib.records.integrators import EXPONENTIAL
        from report_page.charts import BEATEN, CONTRAST, DARK_GROUND, GREY, contrast

        integrators = listed_integrators()
        speed, tables = (self.charts[name]["looks"] for name in ("speed", "tables"))
        for label, name, tolerance in (("rk8", "rk8_frame", TIGHT), ("elp4, 1e-13", "elp4_frame", TIGHT),
                                       ("elp4, 1e-8", "elp4_frame", 1e-8)):
            self.assertEqual(speed[label]["color"], look(integrators[name], tolerance)["color"])
        for label, symbol in (("rk8", "triangle-right"), ("elp4, 1e-13", "diamond-open"),
                              ("elp4, 1e-8", "diamond-open-dot")):
            self.assertEqual(speed[label]["symbol"], symbol)  # by what they keep
        self.assertEqual(tables["algebra, fast"]["color"], FORMULATION_COLOURS["algebra"][0])
        self.assertEqual(self.charts["kept"]["looks"]["exponential Lie–Poisson"]["color"],
                         FAMILY_COLOURS[EXPONENTIAL][0])
        for name, chart in self.charts.items():
            for series, each in chart["looks"].items():
                least = SEEN if series == BEATEN else CONTRAST
                self.assertGreaterEqual(contrast(each["dark"], DARK_GROUND), least, (name, series))
        self.assertGreaterEqual(contrast(GREY["color"], "#ffffff"), SEEN)
        # In grey, series are told apart by their marks.
        for name in ("kept", "statistics"):
            marks = [each["symbol"] for each in self.charts[name]["looks"].values()]
            self.assertEqual(len(set(marks)), len(marks))
            self.assertGreater(len(marks), 7)

    def test_points_are_those_of_the_raw_file(self):
        raw = json.loads(text_of(RECORDED, "accuracy", "raw.json"))["tables"]["runs"]
        runs = {}
        for row in raw["rows"]:
            run_of = dict(zip(raw["columns"], row))
            runs[run_of["integrator"], run_of["n"], run_of["steps"], run_of["tolerance"], run_of["error"]] = run_of
        chart = self.charts["speed"]
        points = list(zip(*(column(chart, name) for name in ("integrator", "n", "steps", "tolerance", "error",
                                                            "seconds", "products", "sweeps"))))
        self.assertGreater(len(points), len(runs) // 2)
        for *key, seconds, products, sweeps in points:
            found = runs[tuple(key)]
            self.assertEqual((min(found["cpu_seconds"]), found["sweeps"]), (seconds, sweeps))
            self.assertAlmostEqual(found["equivalent_products"] / products, 1, places=5)

    def test_settings_of_turbulence_are_repeated_by_the_steps_that_were_taken(self):
        raw = json.loads(text_of(RECORDED, "turbulence", "raw.json"))["tables"]["runs"]
        steps = {row[raw["columns"].index("step")] for row in raw["rows"]}
        self.assertGreater(len([each for each in steps if len(repr(each)) > 10]), 1)  # not all are short
        self.assertLessEqual({float(options_of(line)["step"]) for line in commands(self.charts["statistics"])}, steps)

    def test_the_start_of_the_flow_is_at_0_and_its_ends_are_late(self):
        times = dict(zip(column(self.charts["spectra"], "state"), column(self.charts["spectra"], "time")))
        self.assertEqual(times.pop("t = 0"), 0)
        self.assertGreater(min(times.values()), 900)

    def test_the_energies_of_the_flow_are_all_but_the_tiniest(self):
        chart = self.charts["spectra"]
        of_states = {}
        for state, energy in zip(column(chart, "state"), column(chart, "energy")):
            of_states.setdefault(state, []).append(energy)
        self.assertAlmostEqual(sum(of_states["t = 0"]), 1, places=4)
        for energies in of_states.values():
            self.assertGreater(min(energies), 1e-9)
            self.assertGreater(sum(energies), 0.9)
        lost = dict(zip(column(chart, "state"), column(chart, "lost")))
        figures = json.loads(text_of(RECORDED, "fluid", "figures.json"))
        self.assertIsNone(lost.pop("t = 0"))
        for found, expected in zip(sorted(lost.values()), sorted(
                figures[f"{name}.enstrophy_lost"] for name in ("rk4", "rk8", "elp4"))):
            self.assertAlmostEqual(found, expected, places=4)

    def test_bars_end_where_intervals_do(self):
        chart = self.charts["tables"]
        points = list(zip(*(column(chart, name) for name in ("low", chart["y"]["column"], "high", "below", "above"))))
        self.assertGreater(len(points), 10)
        for low, at, high, below, above in points:
            self.assertAlmostEqual(at - below, at if low is None else low, places=4)
            self.assertAlmostEqual(at + above, at if high is None else high, places=4)

    def test_what_is_within_chance_is_shaded_from_below_all_points(self):
        chart = self.charts["statistics"]
        (shape,) = chart["shapes"]
        self.assertEqual(shape["y1"], 1)
        self.assertLess(shape["y0"], min(column(chart, "distance")))
        self.assertEqual([self.charts[name]["shapes"] for name in ("speed", "kept")], [[], []])

    def test_words_are_said_before_they_are_used(self):
        answer = re.search(r'<section id="answer".*?</section>', self.html, re.DOTALL)[0]
        for word in ("isospectral", "arXiv:2509.20620", "<code>_frame</code>", "ħ is about 2/n", "<em>Published</em>",
                     "<em>sweep</em>", "<em>product</em>", "developed", "rough"):
            self.assertIn(word, answer)

    def test_few_samples_judge_nothing(self):
        from report_page.of_flows import statistics
        from studies.turbulence.judge import Findings
        from studies.turbulence.schema import read_turbulence

        folder = os.path.join(RECORDED, "turbulence")
        study = read_turbulence(os.path.join(folder, "raw.json"))
        found = findings.read_findings(os.path.join(folder, findings.FILE), "turbulence", Findings)
        largest = max(each.n for each in found.trust if each.decides)

        def first_and_verdicts(found):
            """Returns the n that is shown first, and the verdicts on settings at the largest n that is judged now."""
            chart = statistics(study, found)
            rows = zip(chart.columns["n"].values, chart.columns["verdict"].values)
            selector = chart.selectors[0]
            return selector.options[selector.chosen].value, {said for n, said in rows if n == largest}

        self.assertEqual(first_and_verdicts(found), (largest, {"faithful", "not faithful"}))
        few = found._replace(trust=[each._replace(samples=2) if each.n == largest else each for each in found.trust])
        first, verdicts = first_and_verdicts(few)
        self.assertEqual(verdicts, {"not judged"})
        self.assertLess(first, largest)

    def test_every_command_is_one_that_integrate_takes(self):
        integrators, shapes = listed_integrators(), {}
        for name, chart in self.charts.items():
            lines = commands(chart)
            self.assertGreater(sum(map(bool, lines)), 0.6 * len(lines), name)
            for line in filter(None, lines):
                if "integrate" not in line:  # the start of the flow itself
                    self.assertEqual(name, "spectra")
                    continue
                found = options_of(line)
                steps = float(found["time"]) / float(found["step"])
                self.assertAlmostEqual(steps, round(steps), delta=1e-9 * steps, msg=line)
                if "integrator" in found and found["solver"] == "fast":
                    self.assertTrue(integrators[found["integrator"]].has_fast_form, line)
                shapes.setdefault((name, *sorted(found)), line)
        with self.assertRaises(ValueError):  # so that a wrong one is seen
            options_of("build/benchmarks/integrate --n 17 --integrators rk4")
        self.assertGreater(len(shapes), 8)
        for line in shapes.values():
            found = options_of(line)
            if found.pop("initial", None):  # which is made by what stands before
                found["scene"] = "smooth"
            words = [word for option, value in {**found, "n": 9, "time": 0}.items()
                     for word in (f"--{option}", str(value))]
            done = run([INTEGRATE, *words])
            self.assertEqual(done.returncode, DONE, f"{line}: {done.stderr}")

    def test_a_command_repeats_its_run(self):
        chart = self.charts["kept"]
        at = next(row for row, (name, scene, n, steps) in enumerate(zip(*(
            column(chart, each) for each in ("integrator", "scene", "n", "steps"))))
            if (name, scene, n) == ("rk4_frame", "smooth, T = 5", 17) and steps > 10)
        line = commands(chart)[at].replace("build/benchmarks/integrate", shlex.quote(INTEGRATE))
        done = run([*shlex.split(line), "--json"])
        self.assertEqual(done.returncode, DONE, done.stderr)
        found = json.loads(done.stdout)
        for name in ("energy", "spectrum"):
            self.assertAlmostEqual(found[f"{name}_error"] / column(chart, name)[at], 1, delta=0.01)

    @unittest.skipUnless(HAS_MODULE and not SANITIZED, "without the module, or with a sanitizer's libraries")
    def test_what_a_command_needs_first_is_made_by_it(self):
        from report_page.of_flows import start_at
        start = start_at(17, 0)
        line = (start.first.removesuffix(" && ").replace("scripts:build/python", f"{ROOT}/scripts:{BUILD}/python")
                .replace("python3", shlex.quote(sys.executable), 1))
        done = run(["sh", "-c", line], cwd=self.folder)
        self.assertEqual((done.returncode, os.listdir(self.folder)), (DONE, [start.arguments[1]]), done.stderr)
        done = run([INTEGRATE, "--n", "17", *start.arguments, "--integrator", "rk8", "--solver", "fast",
                    "--step", "0.1", "--time", "0.2"], cwd=self.folder)
        self.assertEqual(done.returncode, DONE, done.stderr)


class Markup(PageTest):
    def test_what_reports_escape_is_shown_and_is_no_html(self):
        from lib.pages.document import Figure, Heading, Paragraph, as_markdown
        from report_page.markup import as_html, section_of

        text = "<script>nobody()</script> & a|b ~ $5 #1 *x* h_norm `c` [d]"
        html = as_html(as_markdown([Heading("A < B", 1), Paragraph(text), Figure("chart.svg", "a caption")]))
        self.assertIn("<h3>A &lt; B</h3>", html)
        self.assertIn("<p>&lt;script&gt;nobody()&lt;/script&gt; &amp; a|b ~ $5 #1 *x* h_norm `c` [d]</p>", html)
        self.assertNotIn("chart.svg", html)
        self.assertNotIn("caption", html)
        self.assertEqual(as_html("seen ([more](results/README.md#a)) and [there](https://arxiv.org)"),
                         '<p>seen and <a href="https://arxiv.org">there</a></p>')
        self.assertEqual(as_html("<b onclick='x()'>a</b>\n\n<script>b()</script>"),
                         "<p>&lt;b onclick='x()'&gt;a&lt;/b&gt;</p>\n<p>&lt;script&gt;b()&lt;/script&gt;</p>")
        self.assertEqual(section_of("# a\n\n## b\n\nc\n\n## d\n", "b"), "c")


class Lines(unittest.TestCase):
    def test_names_are_no_shell_text(self):
        from lib.pages.integrate_line import integrate_line, start_of
        line = integrate_line(start_of("smooth", 9), 9, "rk4; touch x", 0.1, 1.0)
        self.assertEqual(shlex.split(line)[shlex.split(line).index("--integrator") + 1], "rk4; touch x")


class OneRun(PageTest):
    def test_what_a_run_has_not_is_said_with_the_command_that_measures_it(self):
        html, charts = self.page_of_study("limits")
        self.assertEqual(list(charts), ["limits"])
        for name in ("table1", "accuracy", "practice", "fluid", "turbulence", "claims"):
            self.assertIn(f"scripts/reproduce {name}</code>", html)
        self.assertNotIn("scripts/reproduce limits</code>", html)
        self.assertIn("This page shows one run: limits.", html)
        self.assertIn("Up to which step methods work", html)  # its report

    def test_table_1_alone_says_that_there_are_no_fast_forms(self):
        raw = json.loads(text_of(RECORDED, "tables", "raw.json"))
        raw["context"]["isosyrk_program"] = "table1"
        raw["benchmarks"] = [row for row in raw["benchmarks"] if row["run_name"].startswith("table1/")]
        raw["context"]["host_name"] = "a-host-to-keep-private"
        self.write("run/raw.json", json.dumps(raw))
        html, charts = self.page_of_study("tables", self.path("run"))
        self.assertIn("Not in this run: the fast forms.", html)
        self.assertEqual(set(column(charts["tables"], "side")), {"paper", "published"})
        self.assertNotIn("a-host-to-keep-private", html)
        self.assertIn("AMD EPYC", html)

    def test_a_changed_figure_changes_the_page(self):
        document = json.loads(text_of(RECORDED, "longruns", "raw.json"))
        table = document["tables"]["points"]
        at = table["columns"].index("energy_error")
        row = next(row for row in table["rows"] if row[at] is not None and row[at] < 1e-3)
        row[at] *= 1.5
        self.write("run/raw.json", json.dumps(document))
        (_, old), (_, new) = self.page_of_study("longruns"), self.page_of_study("longruns", self.path("run"))
        pairs = [pair for pair in zip(column(old["kept"], "energy"), column(new["kept"], "energy")) if len({*pair}) > 1]
        self.assertEqual(len(pairs), 1)
        self.assertAlmostEqual(pairs[0][1] / pairs[0][0], 1.5, places=4)

    def test_what_lies_beside_a_raw_file_is_missed_too(self):
        for home, file in (("turbulence", "findings.json"), ("fluid", "methods.png")):
            shutil.copytree(os.path.join(RECORDED, home), self.path(home))
            self.assertNotIn(f"Not on this page: {file}", self.page_of_study(home, self.path(home))[0])
            os.remove(self.path(home, file))
            self.assertIn(f"Not on this page: {file} of the study {home}",
                          self.page_of_study(home, self.path(home))[0])

    def test_a_page_that_lacks_studies_says_so_beside_its_answers(self):
        from report_page.page import page
        from report_page.sections import recorded_sources
        shutil.copytree(os.path.join(RECORDED, "fluid"), self.path("results", "fluid"))
        html, _ = page_of(page(recorded_sources(self.path("results"))).decode("utf-8"))
        self.assertRegex(html, "The answers rest on all studies .* table1, table2, limits, accuracy, .* are not on")

    def test_a_study_without_a_point_is_said(self):
        document = json.loads(text_of(RECORDED, "turbulence", "findings.json"))
        document["tables"]["settings"]["rows"].clear()
        for name in ("raw.json", "report.md"):
            shutil.copy(os.path.join(RECORDED, "turbulence", name), self.folder)
        self.write("findings.json", json.dumps(document))
        html, charts = self.page_of_study("turbulence", self.folder)
        self.assertIn("It has no point to draw", html)
        self.assertEqual(charts, {})


class Program(PageTest):
    def without(self, module):
        """Returns a folder for PYTHONPATH with which no Python has a module."""
        self.write(f"hidden/{module}.py", "raise ImportError('not here')\n")
        return self.path("hidden")

    def test_without_plotly_a_run_is_told_so_in_a_line_and_goes_on(self):
        limits = ("--study", "limits", "--results", os.path.join(RECORDED, "limits"))
        for module in ("plotly", "jinja2"):
            hidden = self.without(module)
            done = self.page(*limits, "--out", self.path("out"), "--optional", PYTHONPATH=hidden)
            self.assertEqual((done.returncode, done.stdout), (DONE, ""))
            self.assert_one_line(done.stderr, "no report.html", "plotly", "python3-plotly")
            done = self.page(*limits, "--out", self.path("out"), PYTHONPATH=hidden)
            self.assert_refused(done, "plotly", "python3-plotly")
        self.assertFalse(os.path.exists(self.path("out")))

    def test_a_page_is_written_without_a_word(self):
        results = os.path.join(RECORDED, "theorem")
        done = self.page("--study", "theorem", "--results", results, "--out", self.path("out"))
        self.assertEqual((done.returncode, done.stdout, done.stderr), (DONE, "", ""))
        self.assertEqual(os.listdir(self.path("out")), ["report.html"])
        self.assertIn("<h1>isosyrk: theorem</h1>", page_in(self.path("out", "report.html"))[0])

    def test_what_is_wrong_is_said_in_a_line(self):
        self.write("run/raw.json", "{}")
        bad = self.write("history", "not one\n")
        for arguments, *parts in (((), "--out"), (("--out", "x", "--study", "limits"), "--results"),
                                  (("--out", "x", "--study", "no"), "--study"),
                                  (("--out", "x", "--results", self.folder), self.folder, "no study"),
                                  (("--out", "x", "--history", bad), bad, "line 1"),
                                  (("--out", "x", "--history", self.path("none")), self.path("none")),
                                  (("--out", "x", "--study", "limits", "--results", self.path("run")), "raw.json"),
                                  (("--out", "x", "--study", "limits", "--results", self.folder), "raw.json"),
                                  (("--out", "x", "--study", "scaling", "--results",
                                    os.path.join(RECORDED, "theorem")), "raw file of the study scaling"),
                                  *((("--out", "x", "--study", name, "--results", self.path("run")), "raw.json")
                                    for name in ("table1", "theorem"))):
            with self.subTest(arguments=arguments), self.unchanged():
                self.assert_refused(self.page(*arguments), "page: ", *parts)
        for home, file, contents, *parts in (("fluid", "methods.png", "no picture", "methods.png", "no PNG"),
                                             ("theorem", "report.md", b"\xff", "report.md", "UTF-8")):
            shutil.copytree(os.path.join(RECORDED, home), self.path(home))
            with open(self.path(home, file), "wb") as stream:
                stream.write(contents if isinstance(contents, bytes) else contents.encode("utf-8"))
            self.assert_refused(self.page("--study", home, "--results", self.path(home), "--out", "x"), "page: ",
                                *parts)


class History(FolderTest):
    RATIOS = [("algebra over group, s = 3, n = 33", Ratio(2.1, 2.0, 2.2, 6)),
              ("head over base, x", Ratio(1, 0.0, float("inf"), 1))]

    def line(self, cpu="one", commit="0123456789ab", program_name=history.TABLE1):
        return history.line_of(program_name, {"cpu": cpu, "commit": commit, "dirty": "no"}, "kernels", self.RATIOS)

    def test_a_line_is_read_as_it_was_appended(self):
        path = self.path("history")
        lines = [self.line(), self.line("another", program_name=history.GATE)]
        for each in lines:
            history.require_history(path)
            history.append(path, each)
        self.assertEqual(history.read_history(path), lines)
        self.assertEqual(lines[0].ratios[1], history.Entry("head over base, x", 1.0, None, None))
        self.assertEqual(text_of(path).count("\n"), 2)

    def test_runs_at_the_same_time_leave_whole_lines(self):
        path = self.path("history")
        folders = [os.path.join(ROOT, "scripts"), os.path.dirname(os.path.abspath(__file__))]
        code = (f"import sys; sys.path[:0] = {folders}\n"
                "from test_report_page import History\nfrom lib.records import history\n"
                f"for _ in range(20): history.append({path!r}, History().line(cpu=sys.argv[1] * 5000))\n")
        several = [subprocess.Popen([sys.executable, "-B", "-c", code, each]) for each in "abc"]
        self.assertEqual([each.wait() for each in several], [0, 0, 0])
        self.assertEqual(sorted(each.cpu[0] for each in history.read_history(path)), [*20 * "a", *20 * "b", *20 * "c"])

    def test_what_is_none_of_ours_is_refused_and_stays(self):
        history.append(self.path("good"), self.line())
        good = text_of(self.path("good"))
        for name, text, told in (("foreign", '{"a": 1}\n', "line 1 is no line of a history"), ("text", "x\n", "line 1"),
                                 ("cut", good + good[:50], "line 2 has no end"),
                                 ("other", good + good.replace('"ratio":2.1', '"ratio":"2.1"'), "line 2 a ratio")):
            path = self.write(name, text)
            with self.subTest(name), self.unchanged():
                with self.assertRaisesRegex(UnusableFile, told):
                    history.require_history(path)
                with self.assertRaisesRegex(UnusableFile, told):
                    history.append(path, self.line())
                done = run([sys.executable, "-B", HISTORY, "check", path])
                self.assert_refused(done, "history: ", path, told)
        for path in (self.folder, self.path("none", "history")):
            self.assert_refused(run([sys.executable, "-B", HISTORY, "check", path]), path)

    def test_the_program_appends_the_pairs_of_a_run(self):
        raw, path = os.path.join(RECORDED, "tables", "raw.json"), self.path("history")
        done = run([sys.executable, "-B", HISTORY, "append", path, raw])
        self.assertEqual((done.returncode, done.stdout, done.stderr), (DONE, "", ""))
        (line,) = history.read_history(path)
        self.assertEqual((line.program, line.cpu, len(line.ratios)), (history.TABLE1, "AMD EPYC", 36))
        figures = json.loads(text_of(RECORDED, "tables", "figures.json"))
        found = {each.what: each.ratio for each in line.ratios}
        self.assertAlmostEqual(1 / found["group over algebra, s = 3, n = 129"],
                               figures["plain.s3.algebra_over_group.n129"], places=4)

    @unittest.skipIf(MISSING, f"this Python has no {', '.join(MISSING)}")
    def test_the_page_draws_it_for_each_processor_by_itself(self):
        from report_page.charts import as_data
        from report_page.of_history import history as drawn

        lines = [self.line(cpu, commit) for cpu, commit in (("one", "a"), ("two", "b"), ("one", "c"))]
        chart = as_data(drawn(lines))
        machines = [each.machine for each in lines]
        self.assertEqual(column(chart, "commit"), ["a", "a", "b", "b", "c", "c"])
        self.assertEqual(column(chart, "run"), [1, 1, 1, 1, 2, 2])  # counted on each
        selector = chart["selectors"][0]
        self.assertEqual((selector["column"], selector["options"]), ("machine", [*dict.fromkeys(machines)]))
        self.assertNotIn(None, selector["options"])  # no choice shows two processors at once


if __name__ == "__main__":
    unittest.main()
