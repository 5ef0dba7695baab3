"""The raw file of what threads gain: times by numbers of threads, and whether answers stay the same."""

import statistics
from typing import NamedTuple

from lib.programs.messages import UnusableFile
from lib.records import formats
from lib.records.formats import (INTEGRATORS, Integrator, Schema, is_number, keyed, kind_of, list_of, number, positive,
                                 text, truth, whole)
from lib.judging.verdicts import compared, ratio_of

share = kind_of("a share from 0 to 1", lambda value: is_number(value, 0, 1), float)


class Settings(NamedTuple):
    scene: text
    cores: whole(1)  # that the study had: with one alone nothing is timed


class Run(NamedTuple):
    """A fast form by one number of threads. Lists have an entry a process, in the same order for each number."""

    n: whole(2)
    integrator: text
    threads: whole(1)
    step: positive
    tolerance: positive
    warmup: whole()  # steps before those that are timed
    steps: whole(1)  # that are timed
    seconds: list_of(positive)  # that pass for a step, the least of the process's repetitions
    looking: list_of(number)  # that pass until a state is there, the least of the same
    operations: list_of(number)  # that threads share in a step
    serial: list_of(share)  # of a step's time, outside operations
    waiting: list_of(share)  # of the threads' time within operations, in which they did not work
    same: list_of(truth)  # whether the last state has the bits that the process's first number of threads gave

    @property
    def time(self):
        """Returns the seconds of a step, the geometric mean over processes."""
        return statistics.geometric_mean(self.seconds)

    @property
    def share_of_looking(self):
        """Returns the time of a look at the state over that of a step, the median over processes."""
        return statistics.median(look / step for look, step in zip(self.looking, self.seconds))


BY_PROCESS = ("seconds", "looking", "operations", "serial", "waiting", "same")
SCHEMA = Schema("threads", Settings, {INTEGRATORS: Integrator, "runs": Run})


class Threads:
    """A raw file, with its runs by (n, integrator, threads)."""

    def __init__(self, study):
        """Throws UnusableFile for runs that cannot be compared with one thread, process by process."""
        self.context, self.settings = study.context, study.settings
        self.runs = keyed(study.tables["runs"], "n", "integrator", "threads")
        identities = keyed(study.tables[INTEGRATORS], "name")
        if len(self.runs) < len(study.tables["runs"]):
            raise UnusableFile("has a run twice")
        for run in self.runs.values():
            where = f"{run.integrator} at n = {run.n}"
            if run.integrator not in identities:
                raise UnusableFile(f"has runs of {run.integrator} without its integrator")
            one = self.runs.get((run.n, run.integrator, 1))
            if one is None:
                raise UnusableFile(f"has runs of {where} and none by one thread")
            if not run.seconds or {len(getattr(run, name)) for name in BY_PROCESS} != {len(one.seconds)}:
                raise UnusableFile(f"has runs of {where} that are not of the same processes")

    def gain(self, run):
        """Returns the Ratio of the time by one thread to that of a run."""
        return ratio_of(self.runs[run.n, run.integrator, 1].seconds, run.seconds)

    def than_fewer(self, run):
        """Returns the verdict on a run against that by the next smaller number of threads; None for one thread."""
        fewer = [each for each in self.runs.values()
                 if (each.n, each.integrator) == (run.n, run.integrator) and each.threads < run.threads]
        return compared(run.seconds, max(fewer, key=lambda each: each.threads).seconds) if fewer else None

    def different(self):
        """Returns the runs that had other bits in any process."""
        return [run for run in self.runs.values() if not all(run.same)]


def read_threads(path):
    """Returns the Threads in a raw file. Throws UnusableFile with one line that names the file."""
    return formats.read_study(path, SCHEMA, Threads)
