#!/usr/bin/env python3
"""Maps, for every integrator, n and scene, which step sizes work and how the others fail.

A map is one integrator at one n in one scene: trials of some steps each on a grid of h‖B(W₀)‖₂, which grows like n at
fixed h, and the critical value by bisection. Nothing here is timed.
"""

import os
import sys
from functools import partial

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from lib import study

PROGRAM = "stability"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
from lib import formats
from lib import trials
from lib.command_line import Stop
from lib.integrator_names import TABLE1_CELLS
from lib.formats import FAST, PUBLISHED, SOLVERS
from lib.stability_files import MAP_SCHEMA, SCENES, Edge, MapSettings, Setting, Trial

SIZES, QUICK_SIZES = (9, 17, 33, 65, 129, 257), (9, 17, 33)


def draw(job):
    """Returns the map of one integrator in one setting: its edge, and its trials, as fields of their records."""
    setting = trials.Setting(isosyrk.scene(job["scene"], n=job["n"]))
    tried, bracket = trials.find_edge(setting, job["integrator"], job["solver"])
    works, fails = bracket or ({}, {})
    place = {name: job[name] for name in ("scene", "n", "integrator")}
    edge = {**place, "linear_limit": setting.integrator(job["integrator"]).linear_limit(),
            "works": works.get("h_norm_B"), "fails": fails.get("h_norm_B"), "fails_as": fails.get("status")}
    return {"edge": edge, "trials": [{**place, **trial} for trial in tried]}


def described(scene, n):
    """Returns the row of a setting."""
    setting = trials.Setting(isosyrk.scene(scene, n=n))
    return Setting(scene, n, setting.norm_B, setting.norm_ad_B, trials.trial_steps(n, True),
                   trials.trial_steps(n, False))


def main(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--scene", choices=SCENES, nargs="+", action="extend", help="(default: both)")
    parser.add_argument("--solver", choices=SOLVERS, default=PUBLISHED, help="fast: the fast forms (by default those"
                                                                             " of Table 1)")
    options = parser.parse_args(arguments)
    sizes = sorted(set(options.n or (QUICK_SIZES if options.quick else SIZES)))
    scenes = [scene for scene in SCENES if scene in (options.scene or SCENES)]
    entries = study.entries(options.integrator or (TABLE1_CELLS if options.solver == FAST else None))
    for entry in entries:
        if options.solver == FAST and not entry.has_fast_form:
            raise Stop(f"--solver fast: {entry.name} has no fast form")

    journal = study.Journal(PROGRAM, options, partial(isosyrk.conditions, products="openblas", sizes=sizes))
    jobs = [{"scene": scene, "n": n, "integrator": entry.name, "solver": options.solver}
            for n in sizes for scene in scenes for entry in entries]
    maps = study.untimed(jobs, draw, journal, options, "stability maps")
    formats.write_study(options.out, MAP_SCHEMA, journal.context, MapSettings(options.solver, trials.MAX_SWEEPS), {
        "integrators": list(map(study.record_of, entries)),
        "settings": [described(scene, n) for n in sizes for scene in scenes],
        "maps": [Edge(**each["edge"]) for each in maps],
        "trials": [Trial(**trial) for each in maps for trial in each["trials"]]})
    journal.remove()


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
