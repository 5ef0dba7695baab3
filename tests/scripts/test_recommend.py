"""Tests of scripts/recommend on the made-up study of study_documents.py, whose answers are worked out by hand.

There h is 1, 1/2, 1/4, 1/10, 1/20, 1/40, and errors and seconds are, with N = 5/h steps,
rk4 1e-2 h⁴ and 1e-4 N; rkmk4 1e-3 h⁴ and 1e-3 N; group2 0.1 h⁴ and 4e-3 N; group1 h² and 1.5e-3 N;
cotangent1 h² and 2e-3 N. group1 fails at h = 1; at n = 33, but not at n = 17, rk4 is unstable there.
"""

import os
import re
import shutil
import sys
import unittest

from programs import ROOT, FolderTest, run, run_script, strict_json
from study_documents import accuracy_of, run_of, study_document, write_study

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
import recommendation  # noqa: E402
from document import as_text  # noqa: E402
from study_file import CONVERGED, STATUSES  # noqa: E402

SCRIPT = os.path.join(ROOT, "scripts", "recommend")
UNANSWERABLE = 3


class RecommendTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.document = study_document()

    def recommend(self, *arguments, **options):
        """Runs the script on the document as it is now."""
        raw = write_study(self.folder, self.document)
        if options:
            return run([sys.executable, "-B", SCRIPT, "--raw", raw, *arguments], **options)
        return run_script(SCRIPT, "--raw", raw, *arguments)

    def winner(self, n, error, structure="nothing"):
        """Returns the name and number of steps of the run that is offered; None where there is none."""
        found = recommendation.ranking(accuracy_of(self.document), n, error, structure)
        return (found[0].integrator, found[0].steps) if found else None


class Winner(RecommendTest):
    def test_the_cheapest_for_each_structure_and_error(self):
        # 1e-3 is reached by rk4 from h = 1/2 on, by rkmk4 from h = 1 on, by group2 from h = 1/4 on.
        # Of the Lie–Poisson methods group1 needs h = 1/2 for 0.3 (15 ms), group2 h = 1 (20 ms).
        # h‖ad_B‖ of rk4 at h = 1 is 2.80 at n = 17 and 5.44 at n = 33, its limit 2.83; its error is 1e-2 in both.
        for n, error, structure, expected in (
                (33, 1e-3, "nothing", ("rk4", 10)), (33, 1e-3, "spectrum", ("rkmk4", 5)),
                (33, 1e-3, "poisson", ("group2", 20)), (17, 0.3, "poisson", ("group1", 10)),
                (17, 0.01, "poisson", ("group2", 10)), (17, 2e-5, "poisson", ("group2", 50)),
                (17, 0.01, "nothing", ("rk4", 5)), (33, 0.01, "nothing", ("rk4", 10))):
            with self.subTest(n=n, error=error, structure=structure):
                self.assertEqual(self.winner(n, error, structure), expected)

    def test_what_decides(self):
        error = run_of(self.document, "group2", 17, 20)["error"]  # one that is equal to the wanted one reaches it
        both_times = run_of(self.document, "rkmk4", 17, 5)["cpu_seconds"]
        for question, changed, changes, before, after in (
                ((17, error, "poisson"), ("group2", 17, 20), {"error": error * (1 + 1e-15)}, ("group2", 20), ("group2", 50)),
                # the median, and of equal times the better error
                ((17, 1e-3, "spectrum"), ("rkmk4", 17, 5), {"cpu_seconds": [1e-6, 2.0, 3.0]}, ("rkmk4", 5),
                 ("rkmk4", 10)),
                ((17, 1e-3, "spectrum"), ("rkmk4", 17, 10), {"cpu_seconds": both_times}, ("rkmk4", 5), ("rkmk4", 10)),
                ((33, 0.01, "nothing"), ("rk4", 33, 5), {"beyond_limit": False}, ("rk4", 10), ("rk4", 5)),
                # group1 would win if it reached 1e-3, but not once it failed or its step is too long
                *(((17, 1e-3, "poisson"), ("group1", 17, 10), {"error": 1e-4, "status": status}, ("group2", 20),
                   ("group1", 10) if status == CONVERGED else ("group2", 20)) for status in STATUSES),
                ((17, 1e-3, "poisson"), ("group1", 17, 10), {"error": 1e-4, "beyond_limit": True}, ("group2", 20),
                 ("group2", 20))):
            with self.subTest(question=question, changes=changes):
                self.document = study_document()
                self.assertEqual(self.winner(*question), before)
                run_of(self.document, *changed).update(changes)
                self.assertEqual(self.winner(*question), after)

    def test_an_error_below_the_uncertainty_of_the_reference_is_not_known(self):
        for uncertainty, winner in ((1e-9, ("rkmk4", 200)), (2e-9, None)):
            self.document["references"][0]["uncertainty"] = uncertainty
            self.assertEqual(self.winner(17, 1e-9, "spectrum"), winner)


class RunnersUp(RecommendTest):
    def runners_up(self):
        study = accuracy_of(self.document)
        found = recommendation.ranking(study, 33, 1e-3, "nothing")
        data = recommendation.answer_data(study, found, 33, 1e-3, "nothing", "raw.json")
        return [(each["integrator"], each["steps"], round(each["ratio"], 9), each["separated"])
                for each in data["runners_up"]]

    def test_the_best_runs_of_four_other_integrators(self):
        # To 1 ms of rk4: 5, 80, 300 and 400 ms.
        all_others = [("rkmk4", 5, 5, True), ("group2", 20, 80, True), ("group1", 200, 300, True),
                      ("cotangent1", 200, 400, True)]
        self.assertEqual(self.runners_up(), all_others)
        listed = next(each for each in self.document["integrators"] if each["name"] == "rk4")
        self.document["integrators"].append({**listed, "name": "rival"})
        self.document["runs"].append({**run_of(self.document, "rk4", 33, 20), "integrator": "rival"})
        self.assertEqual(self.runners_up()[1:], all_others[:3])

    def test_overlapping_or_lone_repetitions_do_not_separate(self):
        # rk4 takes 0.99, 1.00 and 1.02 ms; as much as a tie is an overlap.
        slowest = max(run_of(self.document, "rk4", 33, 10)["cpu_seconds"])
        for times, ratio, separated in (([1.2e-3, 1.0e-3, 1.1e-3], 1.1, False), ([1.2e-3, slowest, 1.1e-3], 1.1, False),
                                        ([1.2e-3, 1.021e-3, 1.1e-3], 1.1, True), ([5e-3], 5, False)):
            with self.subTest(times=times):
                run_of(self.document, "rkmk4", 33, 5)["cpu_seconds"] = times
                self.assertEqual(self.runners_up()[0], ("rkmk4", 5, ratio, separated))


class Text(RecommendTest):
    def test_the_whole_answer(self):
        # Of three equidistant times the quartiles are halfway between the median and the ends.
        run_of(self.document, "rk4", 33, 10)["cpu_seconds"] = [0.98e-3, 1.0e-3, 1.02e-3]
        run_of(self.document, "rkmk4", 33, 5)["cpu_seconds"] = [1.0e-3, 1.1e-3, 1.2e-3]
        self.document["context"]["dirty"] = "yes"
        result = self.recommend("--n", "33", "--time", "5", "--error", "1e-3",
                                env={"LC_ALL": "C", "PYTHONIOENCODING": "ascii"})  # it writes UTF-8 all the same
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for line in ("- method: rk4, order 4, keeps nothing", "- step: h = 0.5 (10 steps)",
                     "- expected error: 0.000625 (the reference is good to 1e-14)", "- CPU seconds: 0.00100 ±1.0 %",
                     f"Measured: {self.path('raw.json')}, processor a processor, commit 0123456789ab with changes."):
            self.assertIn(line, " ".join(result.stdout.split()))
        rows = [re.split(r"\s{2,}", line) for line in result.stdout.splitlines()]
        self.assertIn(["rkmk4", "4", "the spectrum", "h = 1 (5 steps)", "0.001", "0.00110 ±4.5 %", "1.10",
                       "not separated"], rows)

    def test_json(self):
        result = self.recommend("--n", "33", "--error", "1e-3", "--keep", "spectrum", "--json")
        answer = strict_json(result.stdout)
        self.assertEqual(answer["question"], {"n": 33, "time": 5.0, "error": 1e-3, "keep": "spectrum"})
        winner = answer["winner"]
        self.assertAlmostEqual(winner.pop("half_interquartile_range"), 0.0075 * 5e-3)
        self.assertEqual(winner, {"integrator": "rkmk4", "order": 4, "keeps": "spectrum", "step": 1.0, "steps": 5,
                                  "error": 1e-3, "spectrum_error": 1e-15, "seconds": 5e-3, "repetitions": 3,
                                  "products": 20, "poisson_solves": 20})
        self.assertEqual([each["integrator"] for each in answer["runners_up"]], ["group2", "group1", "cotangent1"])
        self.assertEqual(answer["source"], {"raw": self.path("raw.json"), "cpu": "a processor",
                                            "commit": "0123456789ab", "dirty": "no"})
        result = self.recommend("--n", "33", "--error", "3e-9", "--keep", "spectrum", "--json")
        self.assertEqual(strict_json(result.stdout)["runners_up"], [])

    def test_a_table_has_a_row_of_each_structure_and_n(self):
        run_of(self.document, "rk4", 33, 50)["error"] = 9e-7  # 1e-6 otherwise, to rounding
        run_of(self.document, "rkmk4", 33, 10)["cpu_seconds"] = [2.01e-3, 2.02e-3, 2.03e-3]  # as long as rk4: no mark
        self.document["runs"] = [each for each in self.document["runs"] if each["n"] == 33]
        text = as_text(recommendation.recommendation_tables(accuracy_of(self.document)))
        rows = {n: [re.split(r"\s{2,}", line)[1:] for line in text.splitlines() if line.startswith(f"{n}  ")]
                for n in (17, 33)}
        self.assertEqual(rows[17], [["–"] * 4] * 3)
        self.assertEqual(rows[33], [
            ["rk4, h = 0.5, 0.00100 s*", "rk4, h = 0.25, 0.00200 s", "rk4, h = 0.1, 0.00500 s*",
             "rk4, h = 0.025, 0.0200 s*"],
            ["rkmk4, h = 0.5, 0.00202 s*", "rkmk4, h = 0.5, 0.00202 s*", "rkmk4, h = 0.1, 0.0500 s*",
             "rkmk4, h = 0.05, 0.100 s"],
            ["group2, h = 0.5, 0.0400 s*", "group2, h = 0.1, 0.200 s", "group2, h = 0.05, 0.400 s", "–"]])


class Unanswered(RecommendTest):
    def test_what_no_recorded_run_answers(self):
        def beyond_limit(document):
            run_of(self.document, "rkmk4", 17, 200)["beyond_limit"] = True

        def only_rk4_ended(document):
            for each in document["runs"]:
                if each["n"] == 17 and each["integrator"] != "rk4":
                    each["status"] = "diverged"

        def only_33(document):
            document["runs"] = [each for each in document["runs"] if each["n"] == 33]

        def nothing(document):
            pass

        for change, options, *words in (
                (nothing, {"--error": "1e-12"}, "n = 17", "1e-12", "the best has 3.91e-10", "by rkmk4 with h = 0.025"),
                (nothing, {"--error": "1e-12", "--keep": "poisson"}, "the best has 3.91e-08", "by group2 with"),
                (beyond_limit, {"--error": "1e-12"}, "the best has 3.91e-09", "by rk4 with"),
                (only_rk4_ended, {"--keep": "spectrum"}, "no recorded run at n = 17 that keeps the spectrum came to"),
                *((nothing, options, "is not recorded", "time 5", "n = 17, 33", "nothing is extrapolated")
                  for options in ({"--n": "2"}, {"--n": "18"}, {"--time": "4.99"}, {"--time": "1e300"})),
                (only_33, {}, "n = 17 is not recorded", "n = 33)")):
            with self.subTest(options=options, change=change.__name__):
                self.document = study_document()
                change(self.document)
                question = [word for pair in {"--n": "17", "--error": "1", **options}.items() for word in pair]
                result = self.recommend(*question)
                self.assertEqual((result.returncode, result.stdout), (UNANSWERABLE, ""), result.stderr)
                self.assert_one_line(result.stderr, *words)
        self.document = study_document()
        self.assertEqual(self.recommend("--n", "17", "--error", "1", "--time", "0.5e1").returncode, 0)


class Refusals(RecommendTest):
    def test_bad_arguments(self):
        question = ("--n", "17", "--error", "1")
        for arguments, *parts in (
                *((("--n", value, "--error", "1"), "--n", f"'{value}'", "a whole number from 2 to 4096")
                  for value in ("1", "-17", "17.0", "4097", "")),
                *((("--n", "17", "--error", value), "--error", f"'{value}'", "above 0")
                  for value in ("0", "-1e-6", "nan", "1e999", "x", "")),
                ((*question, "--time", "0"), "--time", "'0'", "above 0"),
                (("--error", "1"), "--n"), (("--n", "17"), "--error"), (("--n", "--error", "1"), "--n"),
                ((*question, "--keep", "energy"), "--keep", "'energy'", "nothing", "spectrum", "poisson"),
                ((*question, "17"), "17"), ((*question, "--err", "1"), "--err"), ((*question, "two\nlines"), "two")):
            with self.subTest(arguments=arguments):
                self.assert_refused(self.recommend(*arguments), *parts)

    def test_files_that_cannot_be_used(self):
        for raw, *parts in ((self.path("two\nlines.json"), "two lines.json", "No such file"),
                            (self.write("foreign.json", '{"benchmarks": []}'), "recommend: ", "foreign.json: ")):
            self.assert_refused(run_script(SCRIPT, "--n", "17", "--error", "1", "--raw", raw), *parts)

    def test_the_recorded_run_is_the_default(self):
        # In a copy of scripts/, so that whatever is recorded in this tree does not matter.
        shutil.copytree(os.path.join(ROOT, "scripts"), self.path("scripts"))
        script = [self.path("scripts", "recommend"), "--n", "17", "--error", "1e-3"]
        self.assert_refused(run(script), os.path.join("results", "recorded", "accuracy", "raw.json"))
        recorded = self.path("results", "recorded", "accuracy")
        os.makedirs(recorded)
        write_study(recorded, self.document)
        self.assertIn("method: rk4", run(script).stdout)

    def test_output_that_is_closed_or_full(self):
        reader, writer = os.pipe()
        os.close(reader)
        result = self.recommend("--n", "17", "--error", "1", stdout=writer)
        os.close(writer)
        self.assertEqual((result.returncode, result.stderr), (1, ""))  # its reader has seen enough
        with open("/dev/full", "wb") as full:
            result = self.recommend("--n", "17", "--error", "1", stdout=full)
        self.assertEqual(result.returncode, 2)
        self.assert_one_line(result.stderr, "recommend: standard output: cannot be written")


if __name__ == "__main__":
    unittest.main()
