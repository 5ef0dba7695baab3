"""Every study as a user runs it, once and small: what it writes, what is rendered of it, and what its rows must show.

A study runs when the first test asks for its raw file. What its functions do by themselves is tested beside them.
"""

import collections
import contextlib
import io
import itertools
import json
import os
import shutil
import sys
import tempfile
import unittest

import drawing
from page_documents import MISSING
from programs import (BUILD, DONE, HAS_MODULE, MEASURE, PATIENCE, RENDER, ROOT, SANITIZED, FolderTest, environment, run,
                      snapshot, text_of)

from lib.programs import command_line
import studies
from studies.theorem import schema as theorem_table
from lib.records.settings import Problem
from studies.accuracy.lines import read_accuracy
from studies.claims.schema import read_claims
from lib.records.formats import FORMULATIONS, listed, read_study
from studies.limits.schema import read_limits
from studies.longruns.schema import read_longruns
from studies.longruns.judge import figures as longruns_figures
from studies.practice.schema import read_practice
from studies.scaling.schema import read_rough, read_scaling, ablations_of
from studies.threads.schema import read_threads
from studies.turbulence.schema import LOOSE, Setting, read_turbulence
from lib.judging.verdicts import FEWEST
from test_studies import HAS_DASK, start_cluster

RECORDED = os.path.join(ROOT, "results", "recorded")
if HAS_MODULE:
    sys.path.insert(0, os.path.join(BUILD, "python"))
    import isosyrk
    from studies.accuracy import single_runs as accuracy_runs, comparisons as comparisons
    from lib.running import built, initial_states, trials

LINES = ["group2", "rk4", "group2_frame", "rk4_frame", "elp4_frame"]  # of accuracy
OF_LIMITS = ("group2", "algebra1", "rk4", "rkmk4")
OF_CLAIMS = ("group1", "algebra1")  # which Octave takes least time for
# The arguments of each run, with few processes and repetitions; those of a study that is not here are --quick.
RUNS = {
    "accuracy": ("--n", "17", "--scene", "smooth", "--time", "5", "--integrator", *LINES, "--repetitions", "2",
                 "--processes", "1"),
    "claims": ("--quick", "--n", "17", "--integrator", *OF_CLAIMS, "--processes", "1"),
    "limits": ("--quick", "--n", "9", "--integrator", *OF_LIMITS),
    "longruns": ("--quick", "--integrator", "rk4", "elp4"),
    "practice": ("--quick", "--n", "17", "--scene", "rough", "turbulence", "--integrator", "rk8", "elp4"),
    "scaling": ("--n", "9", "--integrator", "group1", "elp4", "rk4", "--repetitions", "2"),
    "theorem": ("--quick", "--n", "9", "--processes", "1", "--integrator", "group2", "algebra2", "yoshida4", "--scene",
                "rigid_body", "spin_chain"),
    "threads": ("--quick", "--n", "17"),
    "turbulence": ("--quick", "--n", "11", "--integrator", "rk4", "--processes", "1")}
READERS = {"accuracy": read_accuracy, "claims": read_claims, "limits": read_limits, "longruns": read_longruns,
           "practice": read_practice, "scaling": read_scaling,
           "theorem": lambda path: read_study(path, theorem_table.SCHEMA), "threads": read_threads,
           "turbulence": read_turbulence}
# What is rendered of each alone, and the charts that it draws from so little.
CHARTS = {"accuracy": ("error_against_time", "performance_profile", "time_against_n"), "claims": (),
          "fluid": ("energy_spectra",), "limits": (),
          "longruns": ("energy_against_cost", "energy_against_time", "spectrum_against_cost"),
          "practice": (), "scaling": (),
          "theorem": (), "turbulence": ()}
# What of each is drawn on the page of a run.
ON_PAGES = {"accuracy": ["speed", "kept"], "fluid": ["spectra"], "limits": ["limits"], "longruns": ["kept"],
            "practice": ["practice"], "turbulence": ["statistics"]}
STUDIES = {*studies.PACKAGES} - {"references", "tables"}
NEEDS = {"claims": (shutil.which("octave-cli"), "needs GNU Octave"),
         "threads": (len(os.sched_getaffinity(0)) > 1 and not SANITIZED, "there is one core only, or a sanitizer")}


@unittest.skipUnless(HAS_MODULE, "the module is not built, because pybind11 was not found")
class StudyTest(FolderTest):
    folders = {}  # of the studies that were run

    def ran(self, name, *arguments, file="raw.json", build=BUILD):
        """Runs a study into the folder of the test; returns its path, having written nothing else."""
        path = self.path(file)
        done = run([sys.executable, "-B", MEASURE, name, "--out", path, *arguments],
                   timeout=2 * PATIENCE, env=environment(ISOSYRK_BUILD=build))
        self.assertEqual((done.returncode, done.stdout), (DONE, ""), done.stderr)
        self.assertFalse(os.path.exists(f"{path}.checkpoint"))
        return path

    def raw(self, name):
        """Returns the raw file of a study, which runs if it did not yet."""
        able, why = NEEDS.get(name, (True, ""))
        if not able:
            self.skipTest(why)
        if name not in self.folders:
            folder = tempfile.mkdtemp(prefix="isosyrk-")
            unittest.addModuleCleanup(shutil.rmtree, folder)
            path = self.ran(name, *RUNS.get(name, ("--quick",)), file=f"{name}.json")
            os.rename(path, os.path.join(folder, "raw.json"))
            self.folders[name] = os.path.join(folder, "raw.json")
        return self.folders[name]

    def found(self, name):
        return READERS[name](self.raw(name))


class Every(StudyTest):
    def test_a_study_writes_one_file_that_says_how_it_was_measured(self):
        self.assertLessEqual(set(RUNS), STUDIES)
        for name in STUDIES:
            with self.subTest(study=name):
                document = json.loads(text_of(self.raw(name)))
                self.assertEqual(document["study"], name)
                self.assertLessEqual({"commit", "dirty", "cpu", "compiler", "blas_kernels"}, set(document["context"]))
                listed_there = {row[0] for row in document["tables"]["integrators"]["rows"]}
                for table in document["tables"].values():
                    if "integrator" in table["columns"]:
                        place = table["columns"].index("integrator")
                        self.assertLessEqual({row[place] for row in table["rows"]}, listed_there)

    def test_it_is_rendered_with_charts_and_figures(self):
        for name, charts in CHARTS.items():
            with self.subTest(study=name):
                out = self.path(name)
                done = run([drawing.PYTHON, "-B", RENDER, name, self.raw(name), "--out", out],
                           timeout=PATIENCE, env=environment(MPLCONFIGDIR=self.path("matplotlib")))
                self.assertEqual((done.returncode, done.stdout, done.stderr), (DONE, "", ""))
                files = snapshot(out)
                kept = {"report.md", "figures.json", *(["claims.json"] if name == "claims" else ()),
                        *(["findings.json"] if name in ("accuracy", "practice", "theorem", "turbulence")
                          else ()),
                        *(["fluid.png", "methods.png"] if name == "fluid" else ()),
                        *(f"{chart}.{kind}" for chart in charts for kind in ("svg", "png"))}
                self.assertEqual(set(files), kept)
                report = files["report.md"].decode("utf-8")
                self.assertIn(json.loads(text_of(self.raw(name)))["context"]["commit"], report)
                for chart in charts:
                    self.assertIn(f"({chart}.svg)", report)
                self.assertTrue(json.loads(files["figures.json"]))
                shutil.copy(self.raw(name), os.path.join(out, "raw.json"))
                self.assert_is_on_a_page(name, out)

    def assert_is_on_a_page(self, name, folder):
        """What a run has is drawn on its page, and what it has not is said there."""
        if MISSING:
            return
        from report_page.charts import as_data
        from report_page.sections import Sources, sections
        found = sections(Sources({name: folder}, False))
        self.assertEqual([as_data(chart)["name"] for section in found for chart in section.charts],
                         ON_PAGES.get(name, []))
        self.assertIn("reports", [section.name for section in found])
        self.assertGreater(sum(len(section.missing) for section in found), 5)


class Accuracy(StudyTest):
    PROBLEM = Problem("smooth", 5.0, 17)

    def test_counts_and_errors_are_those_of_the_recorded_study(self):
        found, recorded = self.found("accuracy"), read_accuracy(os.path.join(RECORDED, "accuracy", "raw.json"))
        self.assertEqual((list(found.integrators), found.problems()), (LINES, [self.PROBLEM]))
        self.assertEqual(len(found.forms()), 6)  # one has a loose tolerance too
        pairs = list(zip(found.tolerance_runs, [each for each in recorded.tolerance_runs
                                                if (each.integrator, each.n) == ("group2", 17)]))
        for form in found.forms():
            here, there = (each.line(self.PROBLEM, *form) for each in (found, recorded))
            self.assertLessEqual(abs(len(here) - len(there)), 1)  # rounding decides where a line is at its floor
            pairs += zip(here, there)
        for here, there in pairs:
            with self.subTest(form=here.form, solver=here.solver, steps=here.steps):
                # How a run fails that does not contract is for rounding to decide; that it fails is not.
                self.assertEqual(*((each.steps, each.tolerance, each.usable, each.beyond_limit)
                                   for each in (here, there)))
                self.assert_counts_of_other_kernels(here, there)
                if there.usable and there.error > max(1e-10, 100 * here.tolerance):
                    self.assertLess(abs(here.error / there.error - 1), 1e-3)
                self.assertIn(len(here.cpu_seconds), (1, 2) if here.usable else (0,))
        self.assertLessEqual({"product_rate", "timed_on"}, set(found.context))
        # What the study wrote is what the same kernels count in a run of their own.
        scene = isosyrk.scene("smooth", n=17)
        converged = [each for name in ("group2", "elp4_frame", "rk4") for each in found.line(self.PROBLEM, name)
                     if each.usable]
        self.assertGreater(len(converged), 30)
        for each in converged:
            method = isosyrk.integrator(scene, each.integrator, solver=each.solver, tolerance=each.tolerance)
            _, report = method.run(scene.initial, 5.0 / each.steps, each.steps)
            self.assertEqual((each.sweeps, each.products), (report.sweeps, report.products), each)

    def assert_counts_of_other_kernels(self, here, there):
        """Counts of a run are those that other kernels recorded, but for sweeps that rounding moves.

        An iteration ends a sweep sooner or later where its last change lies near the tolerance: in some steps, not in
        all, so that one sweep more in every step is seen. The work moves with it, by a sweep's share a step. At a
        tolerance near rounding, where changes stop to fall, rounding alone decides. Steps of 2.5 begin far from the
        solution, where since the record was made sweeps with B frozen follow Picard sweeps that grow.
        """
        if not there.sweeps:  # explicit methods
            self.assertEqual((here.sweeps, here.products), (there.sweeps, there.products))
        elif there.usable and here.tolerance >= 1e-13 and here.steps > 2:
            self.assertLess(abs(here.sweeps - there.sweeps), here.steps)
            self.assertLess(abs(here.products - there.products), here.steps * there.products / there.sweeps)

    def test_counts_of_other_kernels_can_be_told_from_those_of_another_method(self):
        recorded = read_accuracy(os.path.join(RECORDED, "accuracy", "raw.json"))
        of_50 = {name: next(each for each in recorded.line(self.PROBLEM, name) if each.steps == 50)
                 for name in ("group2", "rk4")}
        for name, changes in (("group2", {"sweeps": of_50["group2"].sweeps + 50}),
                              ("group2", {"products": 2 * of_50["group2"].products}),
                              ("rk4", {"products": of_50["rk4"].products + 1})):
            with self.assertRaises(AssertionError):
                self.assert_counts_of_other_kernels(of_50[name]._replace(**changes), of_50[name])

    def test_comparisons_take_the_steps_that_reach_the_error_with_least_work(self):
        found = self.found("accuracy")
        self.assertEqual({wanted for _, wanted in found.comparisons}, set(comparisons.WANTED))
        for wanted in comparisons.WANTED:
            comparison = found.comparison(self.PROBLEM, wanted)
            self.assertEqual(set(comparison), {"explicit", "rk4", "gauss", "gauss_loose", "elp", "elp_bounded",
                                         *(["gauss_published"] if wanted == comparisons.WANTED_PUBLISHED else
                                           ["gauss_matched", "elp_matched"])})
            for candidate, row in comparison.items():
                with self.subTest(wanted=wanted, candidate=candidate):
                    self.assertTrue(listed(row.integrator).co_rotating)
                    self.assertLessEqual(row.error, wanted)
                    self.assertEqual(len(row.cpu_seconds), 1)
                    job = {**self.PROBLEM._asdict(), "integrator": row.integrator, "solver": row.solver,
                           "references": os.path.join(RECORDED, "references")}
                    setting = accuracy_runs.Setting(job)
                    again, _ = setting.look(setting.method(row.tolerance), row.steps, row.tolerance)
                    self.assertLess(abs(again.error / row.error - 1), 1e-3 + 100 * row.tolerance / row.error)
        comparison = found.comparison(self.PROBLEM, 1e-4)
        for loose, matched in (("gauss_loose", "gauss_matched"), ("elp", "elp_matched")):
            self.assertEqual(comparison[matched].tolerance, 1e-6)
            self.assertLess(comparison[matched].equivalent_products, comparison[loose].equivalent_products)

    @unittest.skipUnless(HAS_DASK, "this Python has no distributed (python3-distributed)")
    def test_a_cluster_gives_what_this_machine_gives(self):
        some = ("group2",)
        there = read_accuracy(self.ran("accuracy", "--n", "17", "--scene", "smooth", "--time", "5", "--processes", "1",
                                       "--integrator", *some, "--scheduler", start_cluster(self)))
        here = self.found("accuracy")
        for runs in ("runs", "tolerance_runs"):
            found, expected = ([each._replace(cpu_seconds=()) for each in getattr(study, runs)
                                if each.integrator in some] for study in (there, here))
            self.assertEqual(found, expected)
            self.assertTrue(found)
        self.assertEqual(there.ends, {line: end for line, end in here.ends.items() if line[1] in some})

    def test_the_quick_study_has_lines_of_its_methods_and_a_row_for_each_candidate(self):
        accuracy, plan = (studies.module("accuracy", name) for name in ("run", "plan"))
        self.assertEqual(accuracy.parse(["--out", "x", "--quick"]).processes, FEWEST)  # enough for a verdict
        found = read_accuracy(self.ran("accuracy", "--quick", "--n", "17", "--scene", "rough", "--processes", "1"))
        self.assertEqual(found.problems(), [Problem("rough", 5.0, 17)])
        quick = plan.quick_integrators(built.entries(None, frames=True))
        self.assertEqual(list(found.integrators.values()), quick)
        drawn = {each.integrator for each in found.runs}
        self.assertEqual(drawn, {each.name for each in quick if each.co_rotating})  # others: the main problem
        self.assertLessEqual({each.steps for each in found.runs}, set(plan.COARSE_STEPS))
        for problem, *form in found.lines:
            self.assertGreaterEqual(len(found.line(problem, *form)), 4)
        for comparison in found.comparisons.values():
            self.assertEqual({*comparison, "gauss_published", "named_published", "gauss_matched", "elp_matched",
                              "other"},
                             {*comparisons.CLASSES})
            self.assertEqual({len(row.cpu_seconds) for row in comparison.values()}, {1})

    def test_references_that_are_kept_missing_or_of_another_scene(self):
        asked = ("--scene", "smooth", "developed", "--time", "5", "--n")
        folder = self.ran("references", *asked, "17", file="references")
        path = os.path.join(folder, "references.json")
        text = text_of(path)
        self.assertLess(json.loads(text)["references"][0]["uncertainty"], 1e-12)

        def script(name, *arguments):
            return run([sys.executable, "-B", MEASURE, name, *arguments], timeout=PATIENCE,
                       env=environment(ISOSYRK_BUILD=BUILD))

        def again():
            return script("references", "--out", folder, *asked, "17").stderr

        def refused(*parts, n="17"):
            self.assert_refused(script("accuracy", "--references", folder, "--out", self.path("raw.json"), *asked, n),
                                *parts)

        self.assertEqual(again().count("n = 17: kept"), 2)
        refused("n = 33", "measure references --n 33", n="33")
        self.write("references/references.json", text.replace('"scene": "smooth"', '"scene": "rough"'))
        refused("references.json", "scene")
        os.unlink(os.path.join(folder, "smooth_n17.npy"))
        self.write("references/references.json", text)
        refused("smooth_n17.npy", "cannot be read")
        self.assertIn("n = 17: computed", again())
        # Initial data of the developed scene that are not those whose energies are listed.
        shutil.copy(os.path.join(folder, "developed_t5", "developed_n17.npy"),
                    os.path.join(folder, "developed_t5", "initial_n17.npy"))
        refused("initial_n17.npy", "energies")


class Limits(StudyTest):
    def test_critical_steps_and_those_that_survived(self):
        found = self.found("limits")
        self.assertEqual(set(found.lines), {(solver, "smooth", 9, name) for name in OF_LIMITS
                                            for solver in ("published", "fast")})
        for key, line in found.lines.items():
            with self.subTest(key):
                self.assertEqual([limit.state for limit in line.limits], [0, 1])
                for limit in line.limits:
                    outcomes = [outcome for _, outcome in limit.trials(found.settings.grid_step)]
                    self.assertTrue(1 < limit.fails / limit.works <= 1.0301)
                    self.assertEqual((outcomes[0], "converged" in outcomes[-4:]), ("converged", False))
                survived = found.survived[key]
                self.assertTrue(1 < survived.fails / survived.works <= 1.1001)
                self.assertLessEqual(survived.works, line.limits[0].works)
                self.assertLessEqual(survived.energy_error, trials.ENERGY_LOSS)
        self.assertAlmostEqual(found.theory["smooth", 9, "group2"], 12**0.5)
        self.assertNotIn(("smooth", 9, "rkmk4"), found.theory)
        # RK4 loses the spectrum, long before linear theory says that it fails; RKMK4 loses the energy.
        self.assertEqual(found.lines["published", "smooth", 9, "rk4"].fails_as, ["spectrum lost"])
        self.assertLess(found.own("published", "smooth", 9, "rk4"), 0.6 * found.theory["smooth", 9, "rk4"])
        self.assertEqual(found.lines["published", "smooth", 9, "rkmk4"].fails_as[0], "energy lost")

    # Critical h‖B‖₂ of published forms in the smooth scene at n = 17, found by an independent earlier program, which
    # judged the energy to a factor of two. These methods do not lose it before the step fails.
    CRITICAL = {"group2": 1.54, "algebra1": 1.23}

    def test_critical_steps_are_those_of_another_program_and_fast_forms_work_with_longer_ones(self):
        setting = trials.Setting(initial_states.scene_of("smooth", 17, 0))
        for name, expected in self.CRITICAL.items():
            _, (works, _, _) = trials.critical(trials.Method(setting, name, "published").outcome)
            self.assertLess(max(works, expected) / min(works, expected), 1.05)  # two bisections to 2 and 3 %
        _, (fast, _, _) = trials.critical(trials.Method(setting, "group2", "fast").outcome)
        self.assertGreater(fast, 1.4 * self.CRITICAL["group2"])

    def test_a_trial_in_another_process_gives_the_same(self):
        key = {"solver": "fast", "scene": "smooth", "n": 9, "integrator": "group2"}
        again = studies.module("limits", "run").find({**key, "state": 0, "long": True})
        own = self.found("limits").lines[tuple(key.values())].limits[0]
        self.assertEqual(again["limit"], {name: getattr(own, name) for name in again["limit"]})
        self.assertEqual(again["survived"], self.found("limits").survived[tuple(key.values())][len(key):])


class Scaling(StudyTest):
    def test_every_ablation_from_both_starts(self):
        found = self.found("scaling")
        expected = [(at, 9, name, ablation) for at in (5.0, 50.0)
                    for name in ("group1", "elp4", "rk4") for ablation in ablations_of(listed(name))]
        self.assertEqual(sorted(found.points), sorted(expected))
        self.assertEqual({len(point.seconds) for point in found.points.values()}, {2})
        self.assertIn("timed_on", found.context)
        self.assertEqual((found.memory, found.threads), ([], []))
        self.assertEqual({key for key in found.rates}, {(9, "fast"), (9, "published")})
        # Counts are those of one step; all steps of an explicit method form the same number of products.
        scene = isosyrk.scene("smooth", n=9)
        _, report = isosyrk.integrator(scene, "rk4").run(scene.initial, 0.1, 1)
        self.assertEqual({found.points[at, 9, "rk4", "fast"].equivalent_products for at in found.starts()},
                         {report.equivalent_products})
        for at in found.starts():
            sweeps = {ablation: point.sweeps for (begin, _, name, ablation), point in found.points.items()
                      if (begin, name) == (at, "group1")}
            # From a cold start: products that round otherwise end a step a sweep sooner or later, not every step.
            self.assertLess(abs(sweeps["without any"] - sweeps["published"]), 1)
            self.assertLess(sweeps["fast"], 0.5 * sweeps["published"])
            steps = {(point.integrator, point.step, point.tolerance) for point in found.points.values()}
            self.assertEqual(steps, {("group1", 0.1, 1e-13), ("elp4", 0.25, 1e-8), ("rk4", 0.1, 1e-13)})
            for ablation in ablations_of(listed("elp4")):
                point = found.points[at, 9, "elp4", ablation]
                if ablation in ("published", "without any", "without either start", "without graded series"):
                    fast = found.points[at, 9, "elp4", "fast"].equivalent_products
                    self.assertGreater(point.equivalent_products, 1.05 * fast, (at, ablation))

    def test_another_scene_and_one_start(self):
        scaling, plan = (studies.module("scaling", name) for name in ("run", "plan"))
        found = read_rough(self.ran("scaling", "--n", "33", "--scene", "rough", "--start", "5", "--integrator",
                                    "group2_frame", "--repetitions", "1"))
        self.assertEqual({start for start, *_ in found.points}, {5.0})
        # Steps of another flow, whose bands are full: the fast form forms other numbers of products.
        (point,) = (each for each in plan.points_of(built.entries(["group2_frame"]), [33], lambda n: "eigen", "rough",
                                                    (5.0,)) if each["ablation"] == "fast")
        counted = {}
        for scene in ("smooth", "rough"):
            (W,) = scaling.states_of(scene, 33, (3.5,)).values()
            counted[scene] = scaling.count({**point, "scene": scene}, W)
        point = found.points[5.0, 33, "group2_frame", "fast"]
        self.assertEqual(point.sweeps, counted["rough"]["sweeps"])
        self.assertAlmostEqual(point.equivalent_products, counted["rough"]["equivalent_products"], 9)
        self.assertGreater(counted["rough"]["equivalent_products"], 1.1 * counted["smooth"]["equivalent_products"])


class Theorem(StudyTest):
    def test_formulations_are_compared_counted_and_timed(self):
        tables = self.found("theorem").tables
        blocks = {(scene, n, norm) for scene, n in (("rigid_body", 9), ("spin_chain", 32)) for norm in (0.1, 0.5)}
        for name, methods, forms in (("cost", ["s = 2"], ["group", "algebra"]), ("dirk", ["yoshida4"], FORMULATIONS)):
            self.assertEqual({(row.scene, row.n, row.h_norm_B, row.method, row.formulation) for row in tables[name]},
                             {(*block, *pair) for block in blocks for pair in itertools.product(methods, forms)})
        # The substeps of Yoshida's scheme are longer than h: on the chain the midpoint's sweeps do not contract at 0.5.
        diverging = [row for row in tables["dirk"] if (row.scene, row.h_norm_B) == ("spin_chain", 0.5)]
        self.assertEqual({row[5:] for row in diverging}, {(None, None, None, ())})
        for name in ("cost", "dirk"):
            differences = collections.defaultdict(list)
            for block in theorem_table.comparisons([row for row in tables[name] if row not in diverging]).values():
                rows = {row.formulation: row for row in block}
                for form, row in rows.items():
                    self.assertEqual((len(row.seconds), row.difference > 0), (1, form != "algebra"), row)
                    self.assertLess(row.difference, 1e-11)
                    differences[form].append(row.difference)
                self.assertNotEqual(rows["group"].products, rows["algebra"].products)
            # What is compared with the form on g is another form: rounding tells, though not in every block.
            self.assertEqual(len(set(map(tuple, differences.values()))), len(differences))
        for row in tables["coincidence"]:
            self.assertLess(row.difference, row.bound)
        failed = [(row.scene, row.stages, row.h_norm_B) for row in tables["coincidence"] if None in row.sweeps]
        self.assertEqual((len(tables["coincidence"]), failed), (18, [("spin_chain", 1, 0.6)]))


class LongRuns(StudyTest):
    def test_lines_and_long_runs_of_two_methods(self):
        found = self.found("longruns")
        self.assertEqual((found.methods(), found.settings()),
                         (["rk4", "elp4", "elp4_tight"], [(17, "smooth"), (17, "rough")]))
        for (scene, n, method), line in found.lines.items():
            with self.subTest(scene=scene, method=method):
                self.assertEqual([point.steps for point in line], [25 * 2**k for k in range(len(line))])
                self.assertGreater(len(line), 2)
                self.assertTrue(all(point.symplectic_defect for point in line))
                self.assertEqual(line[-1].spectrum_error < 1e-13, method != "rk4")
                self.assertEqual(line[-1].symplectic_defect < 1e-10, method == "elp4_tight")
        for key, each in found.long_runs.items():
            with self.subTest(key):
                self.assertEqual((each.status, len(each.energy_errors), len(each.energy_means),
                                  len(each.spectrum_errors)), ("converged", 40, 40, 40))
                self.assertGreaterEqual(each.energy_errors[-1], abs(each.energy_change))
                self.assertLess(abs(each.equivalent_products / each.cost - 1), 0.2)  # trials to t = 20 only
        self.assertNotIn(("smooth", 50, "elp4_tight"), found.long_runs)
        self.assertIn(("smooth", 150, "elp4_tight"), found.long_runs)
        self.assertTrue(longruns_figures(found))


class Claims(StudyTest):
    def test_octave_draws_and_threads(self):
        claims = studies.module("claims", "run")
        found = self.found("claims")
        self.assertEqual([f"{cell.formulation}{cell.stages}" for cell in found.tables["octave"]], list(OF_CLAIMS))
        for cell in found.tables["octave"]:
            self.assertEqual((cell.n, len(cell.seconds)), (17, 1))
            self.assertLess(cell.difference, claims.EQUAL)
        (pair,) = found.tables["octave_pairs"]
        self.assertEqual((pair.row, pair.other, pair.stages), ("group", "algebra", 1))
        self.assertTrue(0 < pair.difference < claims.EQUAL)
        samples = {(cell.hbar, cell.sample) for cell in found.tables["samples"]}
        self.assertEqual(len(samples), 2 * claims.plan.QUICK_SAMPLES)
        self.assertEqual(found.settings.octave_kernels, found.context["blas_kernels"])


class Threads(StudyTest):
    def test_answers_are_the_same_by_any_number(self):
        threads = studies.module("threads", "run")
        found, cores = self.found("threads"), len(os.sched_getaffinity(0))
        self.assertEqual({*found.runs}, {(17, name, p) for name in threads.METHODS for p in threads.numbers_of(cores)})
        for each in found.runs.values():
            self.assertEqual(len(each.seconds), 2)
            self.assertTrue(min(each.operations) > 1 and all(each.same), each)
        self.assertFalse(found.different())
        self.assertEqual((found.settings.scene, found.settings.cores), ("rough", cores))


class Practice(StudyTest):
    def test_methods_reach_the_wanted_errors(self):
        found = self.found("practice")
        self.assertEqual(set(found.problems), {("rough", 17), ("turbulence", 17)})
        for key, problem in found.problems.items():
            framed = "_frame" if problem.in_frame else ""
            practice = found.practice(key)
            self.assertEqual((problem.in_frame, problem.developed > 0), (key[0] == "rough", key[0] == "turbulence"))
            self.assertLess(problem.difference, 1e-3 * practice.error)
            for wanted, share in (("same", 1.0), ("tenth", 0.1)):
                rows = found.methods(key, wanted)
                self.assertEqual([row.integrator for row in rows], [f"rk8{framed}", *[f"elp4{framed}"] * 2])
                for row in rows:
                    with self.subTest(key=key, row=row.form, wanted=wanted):
                        self.assertLessEqual(row.error, share * practice.error * 1.001)
                        self.assertEqual(len(row.cpu_seconds), 1)
                        self.assertLess(row.steps, practice.steps / 4)
                self.assertEqual(rows[1].steps, rows[2].steps)
        self.assertEqual({row.integrator for row in found.threads}, {"rk8_frame", "elp4_frame"} if len(
            os.sched_getaffinity(0)) > 1 else set())


class Turbulence(StudyTest):
    def test_draws_references_and_costs(self):
        found = self.found("turbulence")
        self.assertEqual((found.sizes[11].samples, found.sizes[11].references, found.sizes[11].far), (3, 3, 4))
        self.assertEqual({setting.integrator for setting in found.ensembles[11]}, {"algebra1", "rk4"})
        self.assertTrue(found.cost(11, Setting("rk4", 0.25, LOOSE)))


# ---- what is refused


def refusal(name, *arguments):
    """Returns the exit status of a study, and what it printed, run in this process."""
    module = studies.module(name, "run")
    with contextlib.redirect_stdout(io.StringIO()) as printed, contextlib.redirect_stderr(io.StringIO()) as said:
        try:
            command_line.run(f"measure {name}", module.main, list(arguments))
        except SystemExit as ended:
            return ended.code, printed.getvalue(), said.getvalue()
    return DONE, printed.getvalue(), said.getvalue()


class Refusals(StudyTest):
    CASES = {
        "accuracy": ((("--integrator", "euler"), "'euler'", "rkmk4"), (("--processes", "0"), "--processes")),
        "claims": ((("--n", "21"), "21", "17", "257"), (("--integrator", "rk4"), "rk4", "group1"),
                   (("--processes", "0"), "--processes")),
        "limits": ((("--scene", "calm"), "calm", "smooth"), (("--solver", "slow"), "--solver"),
                   (("--n", "257", "--integrator", "rkmk4"), "nothing is tried")),
        "longruns": ((("--n", "21"), "--n 21", "17, 33, 65, 129"), (("--integrator", "euler"), "'euler'"),
                     (("--integrator", "group1"), "--integrator group1", "group2"),
                     (("--repetitions", "2"), "--repetitions"), (("--steps", "9"), "--steps")),
        "practice": ((("--n", "9"), "--n 9", "at least 11"), (("--integrator", "euler"), "'euler'", "rkmk4"),
                     (("--scene", "calm"), "calm", "turbulence"), (("--processes", "0"), "--processes"),
                     (("--n", "513", "--scene", "smooth"), "no problem"), (("--n", "1026"), "--n", "5 to 1025")),
        "references": ((("--integrator", "rk4"), "--integrator"), (("--n", "21", "--scene", "rough"), "no problem")),
        "scaling": ((("--n", "4"), "--n", "5 to 1025"), (("--workers", "0"), "--workers"),
                    (("--scheduler", "here"), "--scheduler", "'here'"), (("--scale",), "--scale"),
                    (("--integrator", "euler"), "'euler'", "rkmk4"), (("--scene", "developed"), "--scene", "rough"),
                    (("--start", "7"), "--start", "50"), (("--n", "1026"), "--n", "5 to 1025"),
                    (("--repetitions", "none"), "--repetitions")),
        "theorem": ((("--scene", "calm"), "'calm'", "spin_chain"), (("--n", "4"), "--n", "5 to 513"),
                    (("--integrator", "rk4"), "--integrator 'rk4'", "kahan_li6"),
                    (("--processes", "0"), "--processes")),
        "threads": ((("--n", "1026"), "--n", "5 to 1025"), (("--processes", "0"), "--processes"),
                    (("--integrator", "euler"), "'euler'"), (("--integrator", "bm2"), "no fast form")),
        "turbulence": ((("--n", "9"), "--n 9", "at least 11"),
                       (("--integrator", "suzuki4"), "--integrator 'suzuki4'", "rkmk4"))}

    def assert_told(self, said, *parts):
        status, printed, line = said
        self.assertEqual((status, printed), (2, ""), line)
        self.assert_one_line(line, *parts)
        self.assertEqual(os.listdir(self.folder), [])

    def test_bad_arguments(self):
        for name, cases in self.CASES.items():
            for arguments, *parts in cases:
                with self.subTest(study=name, arguments=arguments):
                    self.assert_told(refusal(name, "--out", self.path("out"), *arguments), f"{name}: ", *parts)

    def test_an_unknown_option(self):
        for name in (*RUNS, "references"):
            with self.subTest(study=name):
                self.assert_told(refusal(name, "--out", self.path("out"), "--nn"), f"{name}: ", "--nn")

    def test_where_nothing_can_be_written(self):
        for name in (*RUNS, "references"):
            for out in (self.folder, self.path("none", "raw.json")) if name != "references" else ("/proc/none",):
                with self.subTest(study=name, out=out):
                    self.assert_told(refusal(name, "--quick", "--out", out), "--out", out)

    def test_the_largest_n_of_a_study_is_taken_and_a_larger_one_than_any_is_not(self):
        for name in RUNS:
            sizes = getattr(studies.module(name, "run"), "SIZES", None)
            for n, named in ((max(sizes), "--out"), (10**5, "--n")) if sizes else ((10**5, "--n"),):
                with self.subTest(study=name, n=n):  # what is refused then is the folder, which is looked at later
                    self.assert_told(refusal(name, "--n", str(n), "--out", "/missing/folder/raw.json"), named)

    def test_as_a_program_of_its_own(self):
        line = [sys.executable, "-B", MEASURE, "scaling", "--out", self.path("out"), "--nn"]
        self.assert_refused(run(line, env=environment(ISOSYRK_BUILD=BUILD)), "scaling: ", "--nn")


if __name__ == "__main__":
    unittest.main()
