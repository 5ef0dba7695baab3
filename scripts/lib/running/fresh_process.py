"""Runs a measurement in a fresh process on chosen cores, again where something disturbed it. Standard library only.

Whether a process was disturbed is told by the operating system, and never by what it measured: a rule that saw the
ratios would choose among them.
"""

import os
import signal
import subprocess
import time
from typing import NamedTuple

# Share of the time that passed which the host of a virtual machine gave to others, on this core, and how often in a
# second another program took the core. Quiet machines show less than a third of either, one with a busy neighbour on
# the same core more than ten times as much.
MAX_STOLEN, MAX_SWITCHES = 0.02, 30.0
# Starts the command behind the number of the process that starts it and a list of cores. Python's own way, a function
# between fork and exec, may hang where other threads run. If that process has ended already, no signal will come.
LAUNCHER = ("setpriv", "--pdeathsig", "KILL", "--", "sh", "-c",
            '[ "$PPID" = "$1" ] || exit 1; shift; exec taskset --cpu-list "$@"', "sh")
MAX_TRIES = 2  # of one process, since a busy machine may stay busy; the less disturbed is kept then, and that is told


class Disturbance(NamedTuple):
    stolen: float  # share of the time that passed
    switches: float  # involuntary, a second

    def __bool__(self):
        return self.stolen > MAX_STOLEN or self.switches > MAX_SWITCHES

    def __str__(self):
        return f"{100 * self.stolen:.1f} % of its time was stolen, {self.switches:.0f} involuntary switches a second"

    @property
    def size(self):
        """The larger of the two, as a multiple of its bound."""
        return max(self.stolen / MAX_STOLEN, self.switches / MAX_SWITCHES)


def last_core():
    """Returns the last core that this process may use; the first tends to serve interrupts."""
    return max(os.sched_getaffinity(0))


def undisturbed(measure, say):
    """Returns what measure() returns, (result, Disturbance), of its first undisturbed call.

    After MAX_TRIES calls it is that of the least disturbed one. `say` gets a line for each call that is repeated.
    """
    tries = []
    while len(tries) < MAX_TRIES:
        tries.append(measure())
        disturbance = tries[-1][1]
        if not disturbance:
            return tries[-1]
        say(f"disturbed ({disturbance}): " + ("measured again" if len(tries) < MAX_TRIES else
                                              f"the least disturbed of {MAX_TRIES} is kept"))
    return min(tries, key=lambda each: each[1].size)


def run_on(core, command, **streams):
    """Runs a command on one core, or on those of a set.

    Returns its exit status, negative for a signal, and the Disturbance meanwhile: the mean over the cores.

    The process ends with this one, however it ends.
    """
    cores = {core} if isinstance(core, int) else core
    launch = [*LAUNCHER, str(os.getpid()), ",".join(map(str, sorted(cores)))]
    before, begun = sum(map(stolen_seconds, cores)), time.monotonic()
    process = subprocess.Popen([*launch, *command], stdin=subprocess.DEVNULL, **streams)
    try:
        _, status, used = os.wait4(process.pid, 0)
    except BaseException:
        process.send_signal(signal.SIGTERM)
        process.wait()
        raise
    process.returncode = os.waitstatus_to_exitcode(status)  # so that nobody waits for it again
    passed = max(time.monotonic() - begun, 1e-3)
    stolen = sum(map(stolen_seconds, cores)) - before
    return process.returncode, Disturbance(stolen / len(cores) / passed, used.ru_nivcsw / passed)


def stolen_seconds(core):
    """Returns the seconds stolen from a core since the machine started; 0 where it is not told. Source: proc(5)."""
    try:
        with open("/proc/stat", encoding="ascii") as stat:
            fields = next(line.split() for line in stat if line.startswith(f"cpu{core} "))
        return int(fields[8]) / os.sysconf("SC_CLK_TCK")
    except (OSError, StopIteration, IndexError, ValueError):
        return 0.0
