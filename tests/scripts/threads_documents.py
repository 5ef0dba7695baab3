"""Made-up raw files of the study threads."""

import programs  # noqa: F401, which makes lib importable

from lib.records import formats
from lib.records.formats import INTEGRATORS, listed
from studies.threads.schema import SCHEMA, Run, Settings

NOISE = (1.0, 1.01, 0.99, 1.02, 0.98, 1.0)


def run(threads=1, name="elp4_frame", n=257, seconds=0.2, noise=NOISE, **others):
    """Returns a Run whose steps take `seconds` times the noise of each process, and whose looks a tenth of that."""
    times = [seconds * each for each in noise]
    values = {"n": n, "integrator": name, "threads": threads, "step": 0.25, "tolerance": 1e-8, "warmup": 8, "steps": 8,
              "seconds": times, "looking": [time / 10 for time in times], "operations": [140.0] * len(times),
              "serial": [0.02] * len(times), "waiting": [0.05 * (threads - 1)] * len(times),
              "same": [True] * len(times), **others}
    return Run(**values)


def write_threads(path, runs, cores=2):
    """Writes a raw file with these runs and returns its path."""
    names = dict.fromkeys(each.integrator for each in runs)
    formats.write_study(path, SCHEMA, {"cpu": "a processor"}, Settings("rough", cores),
                        {INTEGRATORS: list(map(listed, names)), "runs": runs})
    return path
