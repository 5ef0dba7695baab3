"""Figures of what threads gain, by key; results/README.md says what they mean."""

import math
import statistics


def thread_figures(threads):
    """Returns the figures that pages may quote, by key.

    threads.NAME.nN.pP.* are of a method by P threads: ms a step, gain over one thread with its interval, operations a
    step, and shares: serial, waiting, looking. threads.different counts the runs with other bits.
    """
    found = {"threads.different": len(threads.different())}
    for run in threads.runs.values():
        gain = threads.gain(run)
        values = {"ms": 1e3 * run.time, "gain": gain.ratio, "looking": run.share_of_looking,
                  **{name: statistics.median(getattr(run, name)) for name in ("operations", "serial", "waiting")}}
        if math.isfinite(gain.high):
            values.update({"gain.low": gain.low, "gain.high": gain.high})
        found.update({f"threads.{run.integrator}.n{run.n}.p{run.threads}.{name}": value
                      for name, value in values.items()})
    return found
