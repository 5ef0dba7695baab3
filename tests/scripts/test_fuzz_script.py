"""Tests of scripts/fuzz in a copy of the repository whose tools and fuzzers are stand-ins, as in test_reproduce."""

import os
import unittest

from programs import BAD_ARGUMENTS, DONE, snapshot
from test_reproduce import CopyTest

READERS = ("modes_file", "arguments")

# Writes down its arguments, and does as libFuzzer does: its log goes to stderr.
FUZZER = """
echo "$(basename "$0") $*" >>"$CALLS"
echo "INFO: seed corpus: files: 9" >&2
echo "#9 INITED cov: 300 ft: 400 corp: 9/1Kb" >&2
case $FUZZER in
  *"$(basename "$0")"*)
    echo "does not hold: 1 <= l < n" >&2
    echo "artifact_prefix='findings/'; Test unit written to findings/crash-1234" >&2
    status=77 ;;
  *) echo "#5000 DONE cov: 321 ft: 450 corp: 12/2Kb" >&2 ;;
esac
echo "stat::number_of_executed_units: 5000" >&2
exit "${status:-0}"
"""


class FuzzTest(CopyTest):
    def setUp(self):
        super().setUp()
        for reader in READERS:
            self.write(f"root/build-fuzz/tests/fuzz/{reader}_fuzzer", "#!/bin/sh\n" + FUZZER, executable=True)

    def fuzz(self, *arguments, **changes):
        return self.script("fuzz", *arguments, **{"FUZZER": "", **changes})


class BadArguments(FuzzTest):
    def refuses(self, arguments, *parts, **changes):
        with self.subTest(arguments=arguments):
            before = snapshot(self.folder)
            self.assert_refused(self.fuzz(*arguments, **changes), "fuzz", *parts)
            self.assertEqual(snapshot(self.folder), before)

    def test_an_unknown_argument_and_what_is_allowed(self):
        for argument in ("modes_file", "--second", "--seconds=5", "-s", ""):
            self.refuses([argument], argument, "--seconds", "--no-install")

    def test_seconds_are_a_whole_number(self):
        for value in ("", "0", "-1", "1.5", "x", "30s", "1e3", "1000000", "--no-install"):
            self.refuses(["--seconds", value], "--seconds", value, "1 to 999999")
        self.refuses(["--seconds"], "--seconds")

    def test_a_bad_argument_after_good_ones_is_still_found_first(self):
        self.refuses(["--seconds", "5", "--no-install", "perhaps"], "perhaps", MISSING="clang")

    def test_no_install_names_what_is_missing(self):
        self.refuses(["--no-install"], "--no-install", "clang", MISSING="clang")

    def test_help_explains_the_options(self):
        done = self.fuzz("--help")
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        for option in ("--seconds", "--no-install"):
            self.assertIn(option, done.stdout)


class Runs(FuzzTest):
    def test_it_builds_with_clang_in_a_folder_of_its_own(self):
        self.fuzz()
        configure, build = self.calls("cmake")
        folder = self.path("root", "build-fuzz")
        for part in (f"-B {folder} ", "-DCMAKE_CXX_COMPILER=clang++", "-DISOSYRK_FUZZ=ON"):
            self.assertIn(part, configure)
        self.assertIn(f"--build {folder} ", build)

    def test_each_runs_as_long_as_asked_and_says_how_much_it_tried(self):
        done = self.fuzz("--seconds", "7")
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertEqual(done.stdout, "".join(f"{reader}: 5000 executions, 321 edges covered\n"
                                              for reader in READERS))
        for reader in READERS:
            self.assertIn(" -max_total_time=7 ", *self.calls(reader))

    def test_what_is_learnt_goes_to_the_build_folder_and_seeds_are_read(self):
        self.fuzz()
        for reader in READERS:
            (call,) = self.calls(reader)
            self.assertEqual(call.split()[-2:], [self.path("root", "build-fuzz", "corpus", reader),
                                                 self.path("root", "tests", "fuzz", "corpus", reader)])

    def test_a_broken_property_is_named_with_its_input_and_the_others_still_run(self):
        done = self.fuzz(FUZZER="modes_file_fuzzer")
        self.assertEqual(done.returncode, 1)
        for part in ("does not hold: 1 <= l < n", "modes_file: ended with 77", "findings/crash-1234"):
            self.assertIn(part, done.stderr)
        self.assertEqual(len(self.calls("arguments")), 1)

    def test_a_fuzzer_that_cannot_be_run_is_no_success(self):
        os.unlink(self.path("root", "build-fuzz", "tests", "fuzz", "arguments_fuzzer"))
        self.assertEqual(self.fuzz().returncode, 1)

    def test_a_failed_build_fuzzes_nothing(self):
        done = self.fuzz(CMAKE_STATUS="1")
        self.assertEqual(done.returncode, BAD_ARGUMENTS)
        self.assertIn("chatter of cmake", done.stderr)
        self.assertEqual([self.calls(reader) for reader in READERS], [[], []])


if __name__ == "__main__":
    unittest.main()
