"""Tests of build/benchmarks/stability and long_runs from outside."""

import unittest

from programs import DONE, FolderTest, program, run, snapshot, strict_json

SHARED_KEYS = {"name", "stages", "order", "isospectral", "lie_poisson", "symmetric", "explicit"}


class StudyTest(FolderTest):
    def study(self, name, *arguments, timeout=120):
        path = self.path("raw.json")
        done = run([program(name), "--out", path, *arguments], timeout=timeout)
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertEqual(done.stdout, "")
        with open(path, encoding="utf-8") as file:
            return strict_json(file.read()), done.stderr

    def refuses(self, name, *arguments, parts):
        with self.subTest(program=name, arguments=arguments):
            before = snapshot(self.folder)
            self.assert_refused(run([program(name), *arguments]), *parts)
            self.assertEqual(snapshot(self.folder), before)


class FailureMap(StudyTest):
    def test_outcomes_critical_steps_and_theory(self):
        raw, progress = self.study("stability", "--n", "9", "--integrator", "group1", "--integrator", "algebra2",
                                   "--integrator", "rkmk4")
        self.assertIn("6 of 6]", progress)
        self.assertEqual([entry["name"] for entry in raw["integrators"]], ["group1", "algebra2", "rkmk4"])
        self.assertLessEqual(SHARED_KEYS, raw["integrators"][0].keys())
        self.assertEqual([(place["scene"], place["n"]) for place in raw["settings"]], [("smooth", 9), ("rough", 9)])
        self.assertEqual(len(raw["maps"]), 6)
        for each in raw["maps"]:
            trials = each["trials"]
            steps = [trial["h_norm_B"] for trial in trials]
            self.assertEqual(steps, sorted(steps))
            for trial in trials:
                self.assertEqual("failed_step" in trial, trial["status"] not in ("converged", "unstable"))
            self.assertEqual(trials[0]["status"], "converged")
            self.assertNotEqual(trials[-1]["status"], "converged")  # nothing works at h‖B‖ = 11
            works, fails = each["critical"]["works"], each["critical"]["fails"]
            self.assertEqual(works["status"], "converged")
            self.assertNotEqual(fails["status"], "converged")
            self.assertLessEqual(fails["h_norm_B"] / works["h_norm_B"], 1.0201)
            self.assertEqual(each["linear_limit"] is None, each["integrator"] == "rkmk4")
            if each["integrator"] == "group1":
                self.assertAlmostEqual(each["linear_limit"], 2.0)
                self.assertGreater(works["contraction"], 0.0)

    def test_fast_forms_under_the_names_of_the_published_ones(self):
        arguments = ("--n", "17", "--scene", "smooth", "--integrator", "group2")
        fast, _ = self.study("stability", *arguments, "--solver", "fast")
        published, _ = self.study("stability", *arguments)
        self.assertEqual([raw["context"]["solver"] for raw in (fast, published)], ["fast", "published"])
        critical = [raw["maps"][0]["critical"]["works"]["h_norm_B"] for raw in (fast, published)]
        self.assertGreater(critical[0], 1.1 * critical[1])  # what fails is tried again with acceleration
        self.assertEqual(fast["integrators"], published["integrators"])

    def test_processes_do_not_change_what_is_found(self):
        arguments = ("--n", "9", "--integrator", "group1", "--integrator", "rk4", "--products", "openblas", "--processes")
        self.assertEqual(self.study("stability", *arguments, "1")[0]["maps"],
                         self.study("stability", *arguments, "2")[0]["maps"])


class LongRuns(StudyTest):
    def test_samples_shares_and_controls(self):
        raw, progress = self.study("long_runs", "--n", "9", "--steps", "300", "--integrator", "group1")
        self.assertIn("3 of 3]", progress)
        names = ["group1", "algebra2_two_products", "algebra3_two_products"]
        self.assertEqual([entry["name"] for entry in raw["integrators"]], names)
        self.assertEqual([(each["integrator"], each["share"]) for each in raw["runs"]],
                         [(name, share) for name in names for share in (0.9, 0.3)])
        for each in raw["runs"]:
            self.assertAlmostEqual(each["h_norm_B"], each["share"] * each["critical"])
            steps = [sample["step"] for sample in each["samples"]]
            self.assertEqual(steps, sorted(set(steps)))
            self.assertEqual(steps[0], 1)
        kept, lost = raw["runs"][1], raw["runs"][2]
        self.assertEqual((kept["status"], kept["samples"][-1]["step"]), ("converged", 300))
        self.assertLess(kept["samples"][-1]["spectrum_error"], 1e-10)
        # The control is seen to lose skewness where nothing else fails.
        self.assertGreater(lost["samples"][-1]["skew_defect"], 1e3 * lost["samples"][0]["skew_defect"])


class Refusals(StudyTest):
    def test_bad_arguments(self):
        out = ("--out", self.path("raw.json"))
        both = (((), "--out"), (("--out", self.path("missing", "raw.json")), "--out", "missing"),
                *(((*out, "--n", n), "--n", n, "5 to 513") for n in ("4", "514", "x", "1e9")),
                ((*out, "--integrator", "euler"), "integrator 'euler'", "rkmk4"),
                ((*out, "--products", "abacus"), "--products", "abacus"),
                *(((*out, "--processes", number), "--processes", number) for number in ("0", "x", "-1")),
                ((*out, "perhaps"), "perhaps"))
        for name, cases in (
                ("stability", (*both, ((*out, "--solver", "slow"), "--solver 'slow'", "published or fast"),
                               ((*out, "--solver", "fast", "--integrator", "rk4"), "'rk4'", "no fast form"),
                               ((*out, "--scene", "calm"), "--scene 'calm'", "smooth or rough"))),
                ("long_runs", (*both, ((*out, "--solver", "fast"), "--solver"),
                               *(((*out, "--steps", steps), "--steps", steps) for steps in ("9", "0", "x", "1000001"))))):
            for arguments, *parts in cases:
                self.refuses(name, *arguments, parts=parts)


if __name__ == "__main__":
    unittest.main()
