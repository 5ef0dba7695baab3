"""A new integrator, added to the list by one line, is in every study, chart and report that its properties allow.

It is the method of core/README.md, in the module of tests/CMakeLists.txt that has it; no script knows its name.
"""

import json
import os
import subprocess
import sys
import unittest

import drawing
from programs import BUILD, DONE, HAS_MODULE, MEASURE, RENDER, ROOT, SANITIZED, FolderTest, environment, run, text_of

from studies import PACKAGES

NAME, MISJUDGED = "cayley_midpoint", "misjudged"  # the latter is another entry of that module, a control of others
OWN_METHOD = os.path.join(BUILD, "tests", "own_method")
# Prints the integrators that each study plans with --quick. An argument names a family that plans are to know: its
# members are then no new ones, and a plan has those alone that it names.
PLANS = f"""
import json, sys
from types import SimpleNamespace
sys.path.insert(0, {os.path.join(ROOT, "scripts")!r})
from lib.records import integrators
from lib.running import built
integrators.FAMILIES += tuple(sys.argv[1:])
import studies
accuracy, limits, longruns, practice, scaling, turbulence = (
    studies.module(name, "plan") for name in ("accuracy", "limits", "longruns", "practice", "scaling", "turbulence"))
options = SimpleNamespace(quick=True, integrator=None, n=None, solver=None, scene=None, no_large=False)
points = scaling.points_of(scaling.entries_asked_for(options), scaling.QUICK_SIZES, lambda n: "eigen")
settings = turbulence.settings_of(33, turbulence.plan_of(33, True), turbulence.names_of(None))
plans = {{
    "accuracy": [each.name for each in accuracy.quick_integrators(built.entries(None, frames=True))],
    "limits": [job["integrator"] for job in limits.jobs_of(options)],
    "longruns": [job["integrator"] for job in longruns.lines_of((17,), longruns.asked_for(options)[1])],
    "practice": [each.name for each in practice.methods_of(33, True)],
    "scaling": [point["integrator"] for point in points],
    "turbulence": [setting.integrator for _, setting in settings]}}
print(json.dumps({{name: sorted(set(found)) for name, found in plans.items()}}))
"""
# Of each study: the arguments of a quick run at a small n, and the charts that show a line of the integrator.
RUNS = {"accuracy": (("--n", "17", "--scene", "smooth", "--repetitions", "1"), ("error_against_time",)),
        "limits": (("--n", "9", "17"), ("limits",)),
        "longruns": ((), ("energy_against_cost",)),
        "practice": (("--n", "17", "--scene", "rough"), ()),
        "scaling": (("--n", "9", "--repetitions", "1", "--start", "5"), ()),
        "turbulence": (("--n", "11", "--processes", "1"), ())}  # nothing is faithful by so few samples
# These compare the formulations of Gauss methods and of compositions; any other method has none.
OF_FORMULATIONS = ("claims", "theorem")
OF_FAST_FORMS = ("threads",)  # the method has none; test_threads has one with it


@unittest.skipUnless(HAS_MODULE and not SANITIZED, "without the module, or with a sanitizer's libraries")
class NewIntegrator(FolderTest):
    def plans(self, build, *families):
        done = run([sys.executable, "-B", "-c", PLANS, *families],
                   env=environment(PYTHONPATH=os.path.join(build, "python"), ISOSYRK_BUILD=build))
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        return json.loads(done.stdout)

    def test_every_study_plans_it(self):
        without, found = self.plans(BUILD), self.plans(OWN_METHOD)
        self.assertLessEqual({*found, *OF_FORMULATIONS, *OF_FAST_FORMS}, {*PACKAGES})
        for name, planned in found.items():
            self.assertEqual({*planned} - {*without[name]}, {NAME, MISJUDGED}, name)
        # Control: a plan that chooses by names, families or orders that it knows has not got it.
        self.assertEqual(self.plans(OWN_METHOD, "other"), without)

    def test_no_script_names_it(self):
        listed = subprocess.run(["git", "ls-files", "scripts", "results"], cwd=ROOT, capture_output=True,
                                encoding="utf-8", check=False).stdout.split()
        for path in filter(lambda path: not path.endswith((".npy", ".png")), listed):
            self.assertNotIn("cayley", text_of(ROOT, path), path)

    def test_raw_files_charts_and_reports_show_it(self):
        for name, (arguments, charts) in RUNS.items():
            with self.subTest(study=name):
                raw, out = self.path(f"{name}.json"), self.path(name)
                done = run([sys.executable, "-B", MEASURE, name, "--quick", *arguments,
                            "--integrator", NAME, "--out", raw], timeout=300, env=environment(ISOSYRK_BUILD=OWN_METHOD))
                self.assertEqual(done.returncode, DONE, done.stderr)
                table = json.loads(text_of(raw))["tables"]["integrators"]
                rows = {row[0]: dict(zip(table["columns"], row)) for row in table["rows"]}
                self.assertEqual((rows[NAME]["family"], rows[NAME]["order"]), ("other", 2))
                done = run([drawing.PYTHON, "-B", RENDER, name, raw, "--out", out],
                           timeout=300, env=environment(MPLCONFIGDIR=self.path("matplotlib")))
                self.assertEqual((done.returncode, done.stderr), (DONE, ""))
                self.assertIn("cayley\\_midpoint", text_of(out, "report.md").replace(NAME, "cayley\\_midpoint"))
                for chart in charts:
                    self.assertIn(NAME, text_of(out, f"{chart}.svg"))


if __name__ == "__main__":
    unittest.main()
