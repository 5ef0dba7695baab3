"""A small study of limits, made up: two forms of three integrators, from two states of each scene."""

import os

import programs  # noqa: F401 (finds the modules of scripts/lib)

from lib.records import formats
from lib.records.formats import FAST, PUBLISHED, listed
from studies.limits.schema import SCHEMA, Limit, Settings, State, Survived, Theory

SIZES = (9, 17)
SCENES = ("smooth", "developed")
STATES = 2
GRID_STEP, CLOSE, LONG_CLOSE = 2**0.5, 1.03, 1.10
NORM_B = 2.0
INTEGRATORS = {name: listed(name) for name in ("group2", "algebra1", "elp4_frame", "rk4")}
# Of the published form at n = 9: the critical h‖B‖₂, how it fails there, and the outcomes on the grid.
CRITICAL = {"group2": (1.5, "diverged", "++++dddd"), "algebra1": (1.2, "sweep cap", "+++csdd"),
            "rk4": (0.6, "spectrum lost", "+pppd"), "elp4_frame": (5.0, "energy lost", "+++++++ee+eeee")}


def limits_study():
    """Returns the Study: the fast form works to twice the step, n = 17 to 1.5 times, state 1 to 1.1 times."""
    limits, survived = [], []
    for solver, gain in ((PUBLISHED, 1.0), (FAST, 2.0)):
        for scene in SCENES:
            for n in SIZES:
                for name, (critical, status, grid) in CRITICAL.items():
                    if name == "elp4_frame" and solver == PUBLISHED:
                        continue
                    works = critical * gain * (1.5 if n == 17 else 1.0)
                    for state in range(STATES):
                        value = works * 1.1**state
                        limits.append(Limit(solver, scene, n, name, state, 0.5, grid, value, value * CLOSE, status))
                    survived.append(Survived(solver, scene, n, name, 0.8 * works, 0.85 * works, status, 0.02))
    settings = Settings(False, 5.0, 50, 400, 10, GRID_STEP, CLOSE, LONG_CLOSE)
    states = [State(scene, n, state, NORM_B, 3.0) for scene in SCENES for n in SIZES for state in range(STATES)]
    theory = [Theory("smooth", n, name, 3.4) for n in SIZES for name in ("group2", "rk4")]
    return formats.Study({"commit": "0123456789ab", "dirty": "no", "cpu": "a processor"}, settings,
                         {"integrators": list(INTEGRATORS.values()), "states": states, "limits": limits,
                          "survived": survived, "theory": theory})


def write(folder, study, name="limits.json"):
    """Writes the raw file of a study and returns its path."""
    path = os.path.join(folder, name)
    formats.write_study(path, SCHEMA, study.context, study.settings, study.tables)
    return path
