#!/usr/bin/env python3
"""Runs every integrator for many steps, near its critical step size and well inside, and watches the invariants.

The critical h‖B(W₀)‖₂ of an integrator is found here as in the map of the study `stability`; where all steps that are
tried work, it is the longest of them. Nothing here is timed.
"""

import os
import sys
from functools import partial

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from lib import study

PROGRAM = "long_runs"
if __name__ == "__main__":
    study.require_module(PROGRAM)

import isosyrk
from lib import formats
from lib.formats import UNSTABLE
from lib import trials
from lib.command_line import whole_number
from lib.stability_files import LONG_RUNS_SCHEMA, LongRunSettings, RunRow, Sample

SCENE = "smooth"
SIZES, QUICK_SIZES = (17, 33), (17,)
STEPS, QUICK_STEPS = 10000, 1000
SHARES = (0.9, 0.3)  # of the critical step: near the edge, well inside
# Controls beside the list: their update B W̃ - W̃ B does not keep W skew-Hermitian. Each is tried at the edge of the
# integrator behind its name.
CONTROLS = {"algebra2_two_products": "algebra2", "algebra3_two_products": "algebra3"}
EVERYTHING = 1.0  # an error of this size: all is lost, since the norm of the data is 1


def sample_steps(steps):
    """Returns about ten steps a decade, every 250th and the last."""
    decades = (round(10 ** (k / 10)) for k in range(61))
    return {step for step in (*decades, *range(250, steps, 250)) if step < steps} | {steps}


def carry_out(job):
    """Returns the runs of one integrator at each share, with the samples of each; none where no step works."""
    setting = trials.Setting(isosyrk.scene(SCENE, n=job["n"]))
    tried, bracket = trials.find_edge(setting, CONTROLS.get(job["integrator"], job["integrator"]))
    longest = bracket[0] if bracket else tried[-1]
    if not trials.works(longest):
        return []
    integrator = setting.integrator(job["integrator"])
    place = {"scene": SCENE, "n": job["n"], "integrator": job["integrator"], "critical": longest["h_norm_B"]}
    return [{**place, "share": share, **long_run(setting, integrator, share * longest["h_norm_B"], job["steps"])}
            for share in SHARES]


def long_run(setting, integrator, h_norm_B, steps):
    """Runs until the steps are done, one fails, or an invariant is lost altogether."""
    W0, h = setting.scene.initial, h_norm_B / setting.norm_B
    wanted = sample_steps(steps)
    samples = []
    energy_error, lost = 0.0, False

    def watch(step, W, _report):
        nonlocal energy_error, lost
        energy_error = trials.larger(energy_error, setting.energy_error(W))
        if step in wanted:
            errors = {**setting.errors(W), "energy_error": energy_error}
            casimir_error = max(isosyrk.casimir_errors(W, W0))
            samples.append({"step": step, "casimir_error": trials.finite(casimir_error),
                            **{name: trials.finite(error) for name, error in errors.items()}})
            energy_error = 0.0
            lost = not all(error < EVERYTHING for error in errors.values())  # so that NaN is a loss
        return lost

    _, report, status, failed_step = trials.run(integrator, W0, h, steps, watch)
    return {"h_norm_B": h_norm_B, "step": h, "status": UNSTABLE if lost else status, "steps": report.steps,
            "sweeps_per_step": trials.sweeps_per_step(report),
            "failed_step": report.steps if lost else failed_step, "samples": samples}


def main(arguments):
    parser = study.parser(PROGRAM, __doc__.splitlines()[0])
    parser.add_argument("--steps", type=whole_number(10, 1000000), help=f"of a run (default: {STEPS})")
    options = parser.parse_args(arguments)
    steps = options.steps or (QUICK_STEPS if options.quick else STEPS)
    sizes = sorted(set(options.n or (QUICK_SIZES if options.quick else SIZES)))
    rows = [study.record_of(entry) for entry in study.entries(options.integrator)]
    for name, entry in zip(CONTROLS, study.entries(CONTROLS.values())):
        rows.append(study.record_of(entry)._replace(name=name, isospectral=False, lie_poisson=False))

    journal = study.Journal(PROGRAM, options, partial(isosyrk.conditions, products="openblas", sizes=sizes))
    jobs = [{"n": n, "integrator": row.name, "steps": steps} for n in sizes for row in rows]
    runs = [run for found in study.untimed(jobs, carry_out, journal, options, "long runs") for run in found]
    samples = [Sample(run=number, **sample) for number, run in enumerate(runs) for sample in run.pop("samples")]
    formats.write_study(options.out, LONG_RUNS_SCHEMA, journal.context, LongRunSettings(steps, trials.MAX_SWEEPS),
                     {"integrators": rows, "runs": [RunRow(**run) for run in runs], "samples": samples})
    journal.remove()


if __name__ == "__main__":
    study.run(PROGRAM, main, sys.argv[1:])
