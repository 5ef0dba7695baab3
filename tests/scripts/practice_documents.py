"""Made-up raw files of the study practice, whose every answer can be worked out by hand.

A run takes so many seconds, times the noise of each process. The practice takes 20, quflow 100; of the methods at a
tenth of its error rk8 takes 1, elp4 2, with bounded energy 4, group2 5; at the practice's error half of that. rk5
reaches the practice's error only.
"""

import programs  # noqa: F401, which makes lib importable

from lib.records import formats
from lib.records.formats import INTEGRATORS, listed
from studies.practice.schema import SCHEMA, Problem, Row, Settings, ThreadRow

NOISE = (1.0, 1.01, 0.99, 1.02, 0.98, 1.0)
TIME, ERROR = 2.0, 1e-3  # of each problem; the practice's error
SECONDS = {("rk8_frame", 1e-13): 1.0, ("elp4_frame", 1e-8): 2.0, ("elp4_frame", 1e-13): 4.0,
           ("group2_frame", 1e-13): 5.0, ("rk5_frame", 1e-13): None}
SETTINGS = Settings(quick=False, quflow="0123456789ab", cores=2, lowest_degree=6, highest_degree=10, sample=0,
                    tail_from=0.9, tail_share=0.02, largest_whole=257, places=3, largest_whole_quflow=129)


def problem(n=33, scene="rough", **others):
    values = {"scene": scene, "n": n, "time": TIME, "in_frame": True, "norm_ad_B": 8.0, "developed": 0.0, "tail": 0.02,
              "initial": "0" * 16, "reference": "1" * 16, "references": ["rk8_frame", "magnus5_frame"],
              "reference_steps": [12, 24], "reference_errors": [1e-9, 1e-8], "difference": 1e-8}
    return Problem(**{**values, **others})


def row(n=33, role="method", wanted="same", form=("algebra1", 1e-8), seconds=20.0, steps=130, error=ERROR, noise=NOISE,
        scene="rough", **others):
    """Returns a Row; one without steps where `seconds` are None."""
    values = {"scene": scene, "n": n, "role": role, "wanted": wanted, "integrator": form[0], "tolerance": form[1],
              "steps": steps, "error": error, "energy_error": 1e-6, "spectrum_error": 1e-12, "sweeps": 2 * steps,
              "products": 4.0 * steps, "capped": 0}
    if seconds is None:
        values.update(dict.fromkeys(("steps", "error", "energy_error", "spectrum_error", "sweeps", "products",
                                     "capped")))
    times = [] if seconds is None else [seconds * each for each in noise]
    return Row(**{**values, "cpu_seconds": times, **others})


def rows(n=33, quflow=True, noise=NOISE, scene="rough"):
    """Returns the rows of a problem."""
    both = {"n": n, "noise": noise, "scene": scene}
    found = [row(role="practice", **both)]
    if quflow:
        found.append(row(role="quflow", form=("algebra1", 3.7e-9), seconds=100.0, **both, capped=3))
    for form, seconds in SECONDS.items():
        half = 3.0 if seconds is None else seconds / 2
        found += [row(form=form, seconds=half, steps=5, **both),
                  row(wanted="tenth", form=form, seconds=seconds, steps=8, error=ERROR / 10, **both)]
    return found


def threads(n=33, noise=NOISE):
    """Returns the rows of threads of one method: two take 0.6 of the time of one."""
    return [ThreadRow("rough", n, "elp4_frame", 1e-8, 8, number, [seconds * each for each in noise])
            for number, seconds in ((1, 2.0), (2, 1.2))]


def write_practice(path, problems=(problem(),), runs=None, by_threads=None, settings=SETTINGS):
    """Writes a raw file with these problems and rows and returns its path."""
    runs = [each for found in problems for each in rows(found.n)] if runs is None else runs
    by_threads = threads(problems[0].n) if by_threads is None else by_threads
    names = dict.fromkeys([*(name for each in problems for name in each.references),
                           *(each.integrator for each in runs)])
    formats.write_study(path, SCHEMA, {"cpu": "a processor", "commit": "0123456789ab"}, settings, {
        INTEGRATORS: list(map(listed, names)), "problems": list(problems), "runs": runs, "threads": by_threads})
    return path
