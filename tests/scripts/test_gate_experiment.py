"""Tests of the trial of the regression gate: its file, its section of the report, and its plan."""

import importlib.machinery
import importlib.util
import json
import os
import sys
import unittest

import wrong_values
from programs import ROOT, FolderTest, run

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "lib"))
from benchmark_json import UnusableFile  # noqa: E402
from document import as_markdown  # noqa: E402
from gate_experiment_file import FAULTS, FORMAT, SLOWDOWNS, read_experiment  # noqa: E402
from gate_section import gate_sections  # noqa: E402

SCRIPT = os.path.join(ROOT, "scripts", "gate_experiment")
CELL = "group/n:17/s:2"


def script():
    """Returns scripts/gate_experiment as a module."""
    loader = importlib.machinery.SourceFileLoader("gate_experiment", SCRIPT)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("gate_experiment", loader))
    loader.exec_module(module)
    return module


def timed(kind, *medians, caught=False, busy=False, **values):
    return {"kind": kind, "busy": busy, "caught": caught, "seconds": 12.0,
            "cells": {CELL: [{"median": median, "lower_quartile": median - 0.01} for median in medians]}, **values}


def document():
    runs = [timed("same build", 1.001), timed("same build", 1.04, 1.002),
            timed("same build", 1.05, 1.04, caught=True, busy=True),
            *(timed("slowdown", 1.0 + share, 1.0 + share, caught=share > 0.03, share=share) for share in SLOWDOWNS),
            *({"kind": "fault", "fault": fault, "caught": True, "seconds": 3.0, "failures": {"exact": 2, "accuracy": 0},
               "first": {"exact": f"{CELL}: sweeps 611, allowed 561"}} for fault in FAULTS)]
    return {"format": FORMAT, "context": {"cpu": "some"}, "commit": "0" * 40, "runs": runs}


class ExperimentTest(FolderTest):
    def read(self, contents):
        return read_experiment(self.write("runs.json", json.dumps(contents)))


class File(ExperimentTest):
    def test_is_read(self):
        found = self.read(document())
        self.assertEqual(len(found.of("slowdown", share=0.05)), 1)
        self.assertEqual(len(found.of("same build", busy=False)), 2)

    def test_damaged_is_refused(self):
        def refuses(change):
            contents = document()
            change(contents)
            with self.assertRaises(UnusableFile) as caught:
                self.read(contents)
            self.assertNotIn("\n", str(caught.exception))
        refuses(lambda contents: contents.update(format="isosyrk gate_experiment 2"))
        refuses(lambda contents: contents.update(runs={}))
        for wrong in wrong_values.WRONG["truth"]:
            refuses(lambda contents: contents["runs"][0].update(caught=wrong))
        for wrong in wrong_values.WRONG["positive"]:
            refuses(lambda contents: contents["runs"][0].update(seconds=wrong))
            refuses(lambda contents: contents["runs"][3].update(share=wrong))
            refuses(lambda contents: contents["runs"][3]["cells"][CELL][0].update(median=wrong))
        for wrong in (None, [], [1], "text", [{}] * 3, [{}]):
            refuses(lambda contents: contents["runs"][0]["cells"].update({CELL: wrong}))
        refuses(lambda contents: contents["runs"][-1].update(fault="another"))
        refuses(lambda contents: contents["runs"][-1].update(kind="another"))
        refuses(lambda contents: contents["runs"][-1].update(first={"exact": 7}))
        refuses(lambda contents: contents["runs"][-1].pop("first"))


class Section(ExperimentTest):
    def test_counts_alarms_suspicions_and_what_was_caught(self):
        text = " ".join(as_markdown(gate_sections(self.read(document()))).split())
        for row in ("| same build | 2 | 1 | 0 | 0% | 1.020 | 1.001 – 1.040 |",
                    "| same build, other core busy | 1 | 1 | 1 | 100% | 1.050 | 1.050 – 1.050 |",
                    "| slower by 2% | 1 | 1 | 0 | 0% |", "| slower by 5% | 1 | 1 | 1 | 100% |",
                    "sweeps 611, allowed 561"):
            self.assertIn(row, text)

    def test_a_fault_that_passed_is_shown_as_such(self):
        contents = document()
        contents["runs"][-1].update(caught=False, first={})
        self.assertRegex(as_markdown(gate_sections(self.read(contents))), r"allocation[^|]*\| +1 \| +0 \| nothing")


class Plan(unittest.TestCase):
    def test_has_enough_runs_of_each_kind(self):
        planned = script().planned()
        same = [run for run in planned if run["kind"] == "same build"]
        self.assertGreaterEqual(len(same), 40)
        self.assertEqual(sum(run["busy"] for run in same) * 2, len(same))
        for share in SLOWDOWNS:
            self.assertGreaterEqual(sum(run.get("share") == share for run in planned), 20)
        for fault in FAULTS:
            self.assertGreaterEqual(sum(run.get("fault") == fault for run in planned), 1)

    def test_goes_on_where_it_was_stopped(self):
        module = script()
        planned = module.planned()
        done = [{**run, "caught": True, "seconds": 1.0} for run in planned[:30]]
        self.assertEqual(module.left_to_do(done), planned[30:])

    def test_a_slowdown_is_of_a_build_with_faults_against_itself(self):
        module = script()

        class Builds:
            sound, faulty = "sound", "faulty"
            asked = []

            def contestant(self, folder, fault=None):
                self.asked.append((folder, fault))
                return folder

        def judge(base, head, plan):
            return None
        module.judge_times = judge
        for run_, wanted in (({"kind": "slowdown", "share": 0.05, "busy": False},
                              [("faulty", None), ("faulty", "slowdown:0.05")]),
                             ({"kind": "same build", "busy": False}, [("sound", None)])):
            Builds.asked = []
            with self.assertRaises(AttributeError):  # of the verdict that this one never gives
                module.timing_outcome(run_, Builds())
            self.assertEqual(Builds.asked, wanted)


class Arguments(FolderTest):
    def test_bad_ones_are_refused(self):
        for arguments, part in ((["--fast"], "--fast"), (["--out"], "--out"), (["here"], "here")):
            self.assert_refused(run([SCRIPT, *arguments]), "gate_experiment", part)


if __name__ == "__main__":
    unittest.main()
