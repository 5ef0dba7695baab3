"""Tests of long runs of build/benchmarks/integrate: snapshots, series, and what goes on after kill -9."""

import csv
import json
import os
import random
import re
import resource
import select
import signal
import subprocess
import time
import unittest

import numpy

from programs import (DONE, SANITIZED, SOLVER_FAILED, FolderTest, end, open_terminal, program, run,
                      start, strict_json)

COLUMNS = ["t", "energy", "spectrum_error", "enstrophy", "sweeps", "seconds"]
BASE = {"n": "17", "integrator": "group2", "step": "0.1", "time": "2", "scene": "rough", "every": "6",
        "products": "openblas"}
FAST = {"solver": "fast", "products": None}
# What each of these keeps between two steps, no other one does: the frame and the choice of start values; V before its
# projection; past steps; an inverse; solutions of past steps.
METHODS = ({"integrator": "elp4_frame", "tolerance": "1e-8", **FAST}, {"integrator": "rk4_projected"},
           {"integrator": "abm8_projected_frame", **FAST}, {"integrator": "suzuki4", **FAST},
           {"integrator": "group2_frame", **FAST}, {"integrator": "group2"})


def snapshot_name(step):
    return f"W_{step:010d}.npy"


class LongRunTest(FolderTest):
    def setUp(self):
        super().setUp()
        self.snapshots, self.series = self.path("run"), self.path("series.csv")

    def command(self, *flags, place="", **changes):
        """Returns a command line with snapshots and series in a place; a change to None drops the argument."""
        line = [program("integrate")]
        files = {"snapshots": self.snapshots + place, "series": self.series + place}
        for name, value in {**BASE, **files, **changes}.items():
            if value is not None:
                line += ["--" + name.replace("_", "-"), value]
        return line + list(flags)

    def finished(self, *flags, **changes):
        """Runs to the end, and returns the JSON object and W."""
        output = self.path("W.npy")
        done = run(self.command("--json", *flags, output=output, **changes))
        self.assertEqual((done.returncode, done.stderr), (DONE, ""))
        return strict_json(done.stdout), numpy.load(output)

    def rows(self, place=""):
        with open(self.series + place, encoding="ascii", newline="") as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            self.assertEqual(list(row), COLUMNS)
        return [{name: float(value) for name, value in row.items()} for row in rows]

    def lines_but_for_seconds(self, place=""):
        with open(self.series + place, encoding="ascii") as file:
            text = file.read()
        self.assertTrue(text.endswith("\n"))
        return [line.rpartition(",")[0] for line in text.splitlines()]

    def steps_written(self, place=""):
        # What a killed run was writing stays beside, under a name that says so.
        names = sorted(name for name in os.listdir(self.snapshots + place) if not name.endswith(".partial"))
        self.assertEqual(names[-1], "checkpoint")
        return [int(re.fullmatch(r"W_([0-9]{10})\.npy", name)[1]) for name in names[:-1]]

    def snapshot(self, step, place=""):
        return numpy.load(os.path.join(self.snapshots + place, snapshot_name(step)))

    def refuses(self, *flags, parts, **changes):
        with self.subTest(flags=flags, changes=changes), self.unchanged():
            self.assert_refused(run(self.command(*flags, **changes), timeout=20), *parts)


class Files(LongRunTest):
    """What a run that ends leaves."""

    def test_a_row_and_a_snapshot_every_so_many_steps_and_at_the_end(self):
        result, W = self.finished()
        self.assertEqual(self.steps_written(), [0, 6, 12, 18, 20])
        self.assertEqual(self.snapshot(20).tobytes(), W.tobytes())
        rows = self.rows()
        numpy.testing.assert_allclose([row["t"] for row in rows], [0, 0.6, 1.2, 1.8, 2.0], rtol=1e-14)
        for step, row in zip(self.steps_written(), rows):
            self.assertAlmostEqual(row["enstrophy"], 0.5 * numpy.linalg.norm(self.snapshot(step)) ** 2, delta=1e-14)
            error = numpy.abs(numpy.linalg.eigvalsh(1j * self.snapshot(step))
                              - numpy.linalg.eigvalsh(1j * self.snapshot(0))).max()
            self.assertAlmostEqual(row["spectrum_error"], error, delta=1e-14)
        self.assertEqual((rows[0]["sweeps"], rows[0]["seconds"]), (0, 0))
        self.assertEqual(rows[-1]["sweeps"], result["sweeps_total"])
        self.assertEqual(rows[-1]["spectrum_error"], result["spectrum_error"])
        self.assertTrue(0 < rows[1]["seconds"] < rows[-1]["seconds"] <= result["seconds"])
        # The energy keeps to what the method keeps it to, and is another from one scene to another.
        self.assertLess(max(abs(row["energy"] / rows[0]["energy"] - 1) for row in rows), 1e-3)
        self.finished(place=".smooth", scene="smooth")
        self.assertNotAlmostEqual(self.rows(".smooth")[0]["energy"], rows[0]["energy"], delta=1e-4)

    def test_they_change_no_run(self):
        """Bit for bit, in a frame and with a projection too, whose states are asked for on the way."""
        for method in METHODS:
            with self.subTest(method=method):
                place = "." + method["integrator"] + method.get("solver", "")
                observed, W = self.finished(place=place, **method)
                alone, W_alone = self.finished(**{**method, "every": None, "snapshots": None, "series": None})
                self.assertEqual(W.tobytes(), W_alone.tobytes())
                for result in (observed, alone):
                    result.pop("seconds")
                self.assertEqual(observed, alone)

    def test_either_stands_alone(self):
        self.finished(series=None)
        self.assertFalse(os.path.exists(self.series))
        self.finished(place=".2", snapshots=None)
        self.assertEqual((len(self.rows(".2")), os.path.exists(self.snapshots + ".2")), (5, False))

    def test_a_series_in_the_folder_of_snapshots_beside_other_files(self):
        self.finished(series=os.path.join(self.snapshots, "series.csv"))
        notes = self.write("run.2/notes.txt", "mine")
        self.finished(snapshots=os.path.dirname(notes), place=".2")
        with open(notes, encoding="ascii") as file:
            self.assertEqual(file.read(), "mine")

    def test_no_time_and_fewer_steps_than_every(self):
        for time_, steps in (("0", [0]), ("0.3", [0, 3]), ("0.6", [0, 6])):
            self.finished(place=time_, time=time_)
            self.assertEqual((self.steps_written(time_), len(self.rows(time_))), (steps, len(steps)))

    def test_other_scenes(self):
        self.finished(n="6", scene="rigid_body", place=".body")
        self.assertEqual(len(self.rows(".body")), 5)
        self.finished(n="4", scene="symplectic", place=".symplectic")
        self.assertLess(self.rows(".symplectic")[-1]["spectrum_error"], 1e-11)

    def test_a_failed_step_leaves_whole_files_up_to_it(self):
        unstable = {"integrator": "rk4", "step": "2.5", "time": "1000", "every": "1"}
        done = run(self.command("--json", **unstable))
        self.assertEqual(done.returncode, SOLVER_FAILED, done.stderr)
        failed = strict_json(done.stdout)["failed_step"]
        self.assertGreater(failed, 2)
        self.assertEqual(len(self.rows()), failed)
        self.assertEqual(self.steps_written(), list(range(failed)))
        again = run(self.command("--json", "--resume", **unstable))
        self.assertEqual((again.returncode, strict_json(again.stdout)["failed_step"]), (SOLVER_FAILED, failed))


class Refused(LongRunTest):
    """Exit 2 and one line, before anything is computed or written."""

    def test_what_does_not_go_together(self):
        none = {"snapshots": None, "series": None}
        self.refuses(parts=("--every 6", "--snapshots", "--series"), **none)
        self.refuses(parts=("--snapshots", "--every"), every=None)
        self.refuses(parts=("--series", "--every"), every=None, snapshots=None)
        self.refuses("--resume", parts=("--resume", "--snapshots"), snapshots=None)
        self.refuses("--resume", parts=("--resume", "--snapshots"), **none, every=None)
        self.refuses(parts=("--series " + self.series, "--output"), output=self.series)
        self.refuses(parts=("--series " + self.series, "--snapshots"), snapshots=self.series)
        for every in ("0", "-1", "1.5", "", "x", "9" * 30):
            self.refuses(parts=("--every", every, "1 to "), every=every)

    def test_what_cannot_be_written(self):
        file = self.write("file", "mine")
        for folder in (file, os.path.join(file, "run"), self.path("nowhere", "run"), "", "/dev/null"):
            self.refuses(parts=("--snapshots " + folder,), snapshots=folder)
        for series in (self.path("nowhere", "series.csv"), "", self.folder, "/dev/full"):
            self.refuses(parts=("--series " + series,), series=series)
        self.refuses(parts=("--snapshots",), snapshots="/proc/run", series=None)
        self.assertFalse(os.path.exists(self.snapshots))

    def test_files_of_another_run(self):
        self.finished()
        self.refuses(parts=("--snapshots " + self.snapshots, "--resume", "another folder"))
        self.refuses(parts=("--series " + self.series, "--resume", "another file"), snapshots=self.path("other"))
        self.refuses(parts=("--series " + self.series, "another file"), snapshots=None)
        os.unlink(os.path.join(self.snapshots, "checkpoint"))
        self.refuses(parts=("--snapshots " + self.snapshots, "another folder"), series=None)

    def test_nothing_to_go_on_from(self):
        checkpoint = os.path.join(self.snapshots, "checkpoint")
        self.refuses("--resume", parts=("--resume", checkpoint, "nothing to go on from"))
        os.mkdir(self.snapshots)
        self.refuses("--resume", parts=("--resume", "nothing to go on from"))

    def test_a_checkpoint_of_another_command(self):
        self.finished()
        for key, changes in (("n", {"n": "9"}), ("integrator", {"integrator": "group3"}), ("step", {"step": "0.05"}),
                             ("scene", {"scene": "smooth"}), ("tolerance", {"tolerance": "1e-9"}),
                             ("every", {"every": "7"}), ("solver", {"solver": "fast", "products": None}),
                             ("products", {"products": "eigen"}), ("hbar", {"hbar": "standard"}),
                             ("max_sweeps", {"max_sweeps": "99"}), ("series", {"series": None})):
            self.refuses("--resume", parts=("--resume", "checkpoint", f"of a run with {key} "), **changes)
        self.refuses("--resume", parts=("--resume", "step 20", "--time 1"), time="1")
        modes = "l,m,re,im\n2,0,1,0\n2,1,0.5,0\n"
        self.finished(scene=None, modes=self.write("modes.csv", modes), place=".modes")
        self.refuses("--resume", parts=("modes_hash",), scene=None, place=".modes",
                     modes=self.write("other.csv", modes.replace("0.5", "0.6")))
        initial = os.path.join(self.snapshots, snapshot_name(6))
        self.finished(scene=None, initial=initial, place=".initial")
        self.refuses("--resume", parts=("initial_hash",), scene=None, place=".initial",
                     initial=os.path.join(self.snapshots, snapshot_name(12)))

    def test_a_damaged_checkpoint(self):
        self.finished()
        checkpoint = os.path.join(self.snapshots, "checkpoint")
        with open(checkpoint, "rb") as file:
            good = file.read()
        for damaged in (b"", good[:7], good[:-1], good + b"\0", good[:100] + b"?" + good[101:],
                        good[:-9] + b"?" + good[-8:]):
            with open(checkpoint, "wb") as file:
                file.write(damaged)
            self.refuses("--resume", parts=("--resume", checkpoint, "damaged"))

    def test_a_series_of_another_run(self):
        self.finished()
        with open(self.series, encoding="ascii") as file:
            good = file.read()
        for other in (good[:-2] + "\n", good.replace("0.6", "0.7", 1), ""):
            with open(self.series, "w", encoding="ascii") as file:
                file.write(other)
            self.refuses("--resume", parts=("--series " + self.series, "--resume"))
        os.unlink(self.series)
        self.refuses("--resume", parts=("--series " + self.series, "--resume"))

    def test_a_folder_that_another_process_has(self):
        process = start(self.command(time="100000"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(end, process)
        wait_for(lambda: os.path.exists(os.path.join(self.snapshots, "checkpoint")))
        for flags in ((), ("--resume",)):
            done = run(self.command(*flags, time="100000", series=None), timeout=20)
            self.assert_refused(done, "--snapshots " + self.snapshots, "another process")


def wait_for(condition, seconds=60):
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError(f"not in {seconds} seconds")
        time.sleep(0.002)


class Resumed(LongRunTest):
    """A run that is ended at any moment goes on as if it had not been, bit for bit."""

    def assert_same_answer(self, result, W, whole, W_whole):
        self.assertEqual(W.tobytes(), W_whole.tobytes())
        self.assertEqual({**result, "seconds": 0}, {**whole, "seconds": 0})

    def assert_same_files(self, place, whole_place):
        self.assertEqual(self.lines_but_for_seconds(place), self.lines_but_for_seconds(whole_place))
        steps = self.steps_written(whole_place)
        # A killed run may have come further than the one that goes on from its checkpoint.
        self.assertEqual([step for step in self.steps_written(place) if step <= steps[-1]], steps)
        for step in steps:
            self.assertEqual(self.snapshot(step, place).tobytes(), self.snapshot(step, whole_place).tobytes())

    def step_of_checkpoint(self, place):
        """Returns the step of the checkpoint in a place, or -1."""
        try:
            with open(os.path.join(self.snapshots + place, "checkpoint"), "rb") as file:
                file.readline()
                return json.loads(file.readline())["step"]
        except FileNotFoundError:
            return -1

    def kill_after_a_checkpoint(self, *flags, pause, place, **changes):
        """Kills a run with SIGKILL some time after a checkpoint that is later than the one that it begins from."""
        before = max(0, self.step_of_checkpoint(place))
        process = start(self.command(*flags, place=place, **changes), stdout=subprocess.DEVNULL,
                        stderr=subprocess.DEVNULL)
        try:
            wait_for(lambda: self.step_of_checkpoint(place) > before)
            time.sleep(pause)
            process.kill()
            self.assertEqual(process.wait(timeout=20), -signal.SIGKILL)
        finally:
            end(process)

    def test_after_kill_nine_by_every_kind_of_method(self):
        moments = random.Random(57)
        for method in METHODS:
            with self.subTest(method=method):
                place = "." + method["integrator"] + method.get("solver", "")
                # A run of hours, that ends by a shorter --time soon after its last checkpoint.
                settings = {**method, "n": "9", "every": "50"}
                for flags in ((), ("--resume",)):
                    self.kill_after_a_checkpoint(*flags, pause=moments.uniform(0.0, 0.05), place=place,
                                                 **settings, time="100000")
                settings["time"] = f"{self.step_of_checkpoint(place) / 10 + 20:.1f}"
                answer = self.finished("--resume", place=place, **settings)
                self.assert_same_answer(*answer, *self.finished(place=place + ".whole", **settings))
                self.assert_same_files(place, place + ".whole")

    def test_a_full_disk_leaves_whole_files_and_the_run_goes_on_when_there_is_room(self):
        """A limit on the size of files, for the disk: it is met by the series, in the middle of a row."""
        def limit(size):
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

        settings = {"n": "9", "every": "1", "time": "9"}
        whole, W_whole = self.finished(place=".whole", **settings)
        size = os.path.getsize(os.path.join(self.snapshots + ".whole", "checkpoint")) + 100
        self.assertLess(size, os.path.getsize(self.series + ".whole"))
        for place, snapshots in (("", {}), (".alone", {"snapshots": None})):
            done = run(self.command(place=place, **{**settings, **snapshots}), prepare=lambda: limit(size))
            self.assert_refused(done, "--series " + self.series, "cannot be written (File too large)")
            rows = self.lines_but_for_seconds(place)
            self.assertEqual(rows, self.lines_but_for_seconds(".whole")[:len(rows)])
            self.assertGreater(len(rows), 20)
        self.assertFalse([name for name in os.listdir(self.snapshots) if name.endswith(".partial")])
        result, W = self.finished("--resume", **settings)
        self.assert_same_answer(result, W, whole, W_whole)
        self.assert_same_files("", ".whole")

    def test_a_folder_without_room_for_a_snapshot(self):
        done = run(self.command(), prepare=lambda: (signal.signal(signal.SIGXFSZ, signal.SIG_IGN),
                                                    resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000))))
        self.assert_refused(done, "--snapshots " + self.snapshots, snapshot_name(0), "(File too large)")
        self.assertEqual(os.listdir(self.snapshots), [])

    def test_rows_after_the_checkpoint_are_cut(self):
        self.finished(place=".whole")
        result, W = self.finished()
        with open(self.series, "a", encoding="ascii") as file:
            file.write("2.1,1,1,1,1,1\n2.2,1,")
        again, W_again = self.finished("--resume")
        self.assert_same_answer(again, W_again, result, W)
        self.assertEqual(self.lines_but_for_seconds(), self.lines_but_for_seconds(".whole"))

    def test_control_from_a_snapshot_alone_a_run_goes_on_otherwise(self):
        """Which is why there is a checkpoint."""
        method = {**METHODS[2], "time": "6"}
        _, whole = self.finished(**method)
        _, W = self.finished(**{**method, "time": "4.2", "scene": None}, place=".rest",
                             initial=os.path.join(self.snapshots, snapshot_name(18)))
        self.assertLess(numpy.abs(W - whole).max(), 1e-3)
        self.assertNotEqual(W.tobytes(), whole.tobytes())

    def test_a_longer_time(self):
        for first in ("1.2", "1.3"):  # 12 and 13 steps of which every sixth is written
            result, W = self.finished(place=first + ".whole")
            self.finished(place=first, time=first)
            longer, W_longer = self.finished("--resume", place=first)
            self.assert_same_answer(longer, W_longer, result, W)
            left = set(self.lines_but_for_seconds(first)) - set(self.lines_but_for_seconds(first + ".whole"))
            self.assertEqual(len(left), int(first == "1.3"))  # the last row of the shorter run

    def test_a_signal_leaves_a_checkpoint_of_the_last_step(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                place = f".{number}"
                settings = {**METHODS[0], "time": "20000", "every": "1000000", "place": place}
                process = start(self.command("--json", **settings), stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                self.addCleanup(end, process)
                wait_for(lambda path=self.snapshots + place: os.path.exists(os.path.join(path, "checkpoint")))
                time.sleep(0.2)
                process.send_signal(number)
                output, errors = process.communicate(timeout=20)
                self.assertEqual(process.returncode, 128 + number, errors)
                done = strict_json(output)["steps_done"]
                self.assertGreater(done, 0)
                self.assert_one_line(errors, f"after step {done} of 200000", "--resume")
                settings["time"] = f"{(done + 3) / 10:.1f}"
                _, W = self.finished("--resume", **settings)
                _, whole = self.finished(**{**settings, "place": place + ".whole"})
                self.assertEqual(W.tobytes(), whole.tobytes())

    @unittest.skipIf(SANITIZED, "n > 33 takes too long")
    def test_on_another_number_of_threads_without_json_and_output(self):
        settings = {**METHODS[0], "n": "97", "time": "0.4", "every": "2"}  # two threads from n = 96 on
        whole, W_whole = self.finished(place=".whole", **settings)
        self.finished(**{**settings, "time": "0.2"})
        done = run(self.command("--resume", threads="2", **settings))
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertEqual(self.snapshot(4).tobytes(), W_whole.tobytes())
        self.assertIn(f"sweeps_total     {whole['sweeps_total']}\n", done.stdout)

    def test_the_products_that_were_chosen_at_the_start(self):
        """By measurement two runs may choose differently."""
        for products in ("eigen", "openblas"):
            self.finished(products=products, place="." + products, time="1")
            result, _ = self.finished("--resume", products=None, place="." + products)
            self.assertEqual(result["product_backend"], products)

    def exchange(self, key):
        """Exchanges what the checkpoint says of its run, with a checksum that fits."""
        checkpoint = os.path.join(self.snapshots, "checkpoint")
        with open(checkpoint, "rb") as file:
            head, name, tail = file.read()[:-8].partition(f'"{key}":"'.encode())
        other = head + name + b"other" + tail[tail.index(b'"'):]
        with open(checkpoint, "wb") as file:
            file.write(other + fnv1a(other).to_bytes(8, "little"))

    def test_on_other_kernels_with_a_note_and_by_no_other_version(self):
        self.finished(time="1")
        self.exchange("kernels")
        done = run(self.command("--resume"))
        self.assertEqual(done.returncode, DONE)
        self.assert_one_line(done.stderr, "note", "other kernels", "not bit for bit")
        self.exchange("version")
        self.assert_refused(run(self.command("--resume")), "--resume", 'of a run with version "other", not')


def fnv1a(contents):
    value = 0xcbf29ce484222325
    for byte in contents:
        value = (value ^ byte) * 0x100000001b3 % 2 ** 64
    return value


class Terminal(LongRunTest):
    def test_the_line_has_energy_and_sweeps_and_the_width_of_the_terminal(self):
        terminal, stderr = open_terminal(self)
        os.set_blocking(terminal, True)
        subprocess.run(["stty", "cols", "60"], stdin=stderr, check=True)
        process = start(self.command(time="100000", every="1000"), stdout=subprocess.DEVNULL, stderr=stderr)
        self.addCleanup(end, process)
        os.close(stderr)
        shown = b""
        while shown.count(b"\r") < 4:
            self.assertTrue(select.select([terminal], [], [], 60)[0])
            shown += os.read(terminal, 4096)
        process.kill()
        os.close(terminal)
        lines = shown.decode().split("\r\x1b[K")[1:-1]
        for line in lines:
            self.assertRegex(line, r"^step \d+ of 1000000 \(0 %\), t = [0-9.e+]+, energy 0\.\d+")
            self.assertLessEqual(len(line), 59)
        self.assertEqual(len(lines[-1]), 59)


class Help(LongRunTest):
    def test_it_explains_each_option_and_where_the_checkpoint_is(self):
        text = " ".join(run([program("integrate"), "--help"]).stdout.split())
        for option in ("--every K", "--snapshots", "--series", "--resume"):
            self.assertIn(option, text)
        self.assertIn("checkpoint in the folder of --snapshots", text)


if __name__ == "__main__":
    unittest.main()
