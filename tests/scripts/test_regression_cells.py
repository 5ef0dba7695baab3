"""Tests of the program regression_cells from outside: what it reports, what it serves, what it refuses."""

from programs import BAD_ARGUMENTS, DATA, DONE, FolderTest, environment, program, run, strict_json

from gate.cells import cells_of, read_build
from gate.layers import accuracy_layer

NAMES = cells_of((17,))


class RegressionCellsTest(FolderTest):
    def report(self, *names, **changes):
        done = run([program("regression_cells"), *names], env=environment(**changes))
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        return strict_json(done.stdout)


class Report(RegressionCellsTest):
    def test_holds_every_cell_and_passes_the_accuracy_layer(self):
        build = read_build(self.report(*NAMES))
        self.assertEqual(list(build.cells), NAMES)
        layer = accuracy_layer(build, NAMES, DATA)
        self.assertEqual([check.line() for check in layer.failures()], [])
        self.assertEqual(len(layer.checks), 9 * 3 + 6 + 9 * 4)  # only published group is compared with nothing

    def test_counts_are_those_of_integrate(self):
        for name, options, counts in (
                ("group/n:17/s:2", ("--products", "openblas"), ("products", "poisson_solves")),
                ("fast_group/n:17/s:2", ("--solver", "fast"), ("equivalent_products", "poisson_solves"))):
            cell = self.report(name)["cells"][0]
            done = run([program("integrate"), "--n", "17", "--stages", "2", "--formulation", "group", "--step", "0.1",
                        "--time", "5", *options, "--json"])
            found = strict_json(done.stdout)
            self.assertEqual([cell["sweeps"], *(cell[count] for count in counts)],
                             [found["sweeps_total"], *(found[count] for count in counts)])
            self.assertEqual(cell["allocations"], 0)

    def test_contraction_is_between_0_and_1_and_grows_with_n(self):
        small, large = (self.report(name)["cells"][0]["contraction"] for name in ("group/n:17/s:1", "group/n:33/s:1"))
        self.assertTrue(0.0 < small < large < 1.0, (small, large))


class Server(FolderTest):
    def serve(self, *lines):
        """Runs the server with these requests."""
        path = self.write("requests", "".join(lines))
        with open(path, encoding="utf-8") as requests:
            return run([program("regression_cells"), "--serve", NAMES[0], "fast_group/n:17/s:2"], stdin=requests)

    def test_answers_each_line_with_seconds(self):
        one, many = "0 2 1\n", "0 2 20\n"
        done = self.serve("1 50 3\n", *(one, many) * 10)
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        ready, *seconds = done.stdout.split()
        self.assertEqual((ready, len(seconds)), ("ready", 21))
        # The least of ten has nothing of a busy machine.
        self.assertGreater(min(map(float, seconds[2::2])), 5 * min(map(float, seconds[1::2])))

    def test_another_request_is_refused(self):
        for line in ("2 1 1\n", "0 0 1\n", "0 1\n"):
            done = self.serve(line)
            self.assertEqual((done.returncode, done.stdout), (BAD_ARGUMENTS, "ready\n"), line)
            self.assertEqual(done.stderr.count("\n"), 1)
            self.assertIn("must be CELL STEPS RUNS", done.stderr)


class Refusals(FolderTest):
    def test_other_names(self):
        for name in ("group/n:17", "fast_quotient/n:17/s:1", "group/n:4/s:1", "group/n:17/s:21", "group/n:17/s:1x", ""):
            self.assert_refused(run([program("regression_cells"), name]), "regression_cells: ")
        self.assert_refused(run([program("regression_cells")]), "cells")
