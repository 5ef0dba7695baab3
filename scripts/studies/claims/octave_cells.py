"""Runs cells of Table 1 in GNU Octave, by benchmarks/octave/run_cells.m. Standard library only."""

import json
import os
import re
import shutil
import subprocess

from lib.programs.command_line import BAD_ARGUMENTS, NO_ANSWER, Stop
from lib.programs.messages import one_line
from lib.programs.places import ROOT

PROGRAM = "octave-cli"
SCRIPT = os.path.join(ROOT, "benchmarks", "octave", "run_cells.m")
NO_FILES = "-"  # in place of a folder: W at the end is not written


def run(initial, cells, step, steps, repetitions=1, folder=NO_FILES, hbar="paper"):
    """Returns what run_cells.m prints of cells such as "group2", a dict. `initial` is the .npy file of W(0).

    Octave has one thread, and the core that this process has. Throws Stop for a run that fails.
    """
    numbers = repr(step), str(steps), str(repetitions)
    command = [path_of_program(), "-qf", SCRIPT, initial, hbar, *numbers, folder, *cells]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8", errors="replace",
                          env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}, check=False)
    if done.returncode != 0:
        said = [line for line in done.stderr.splitlines() if line.startswith(("run_cells:", "error:"))]
        raise Stop(f"{PROGRAM}: exit status {done.returncode}: {one_line(said[0] if said else 'no reason given')}"
                   + failed_cell(done.stdout), NO_ANSWER)
    return json.loads(done.stdout)


def path_of_program():
    program = shutil.which(PROGRAM)
    if program is None:
        raise Stop(f"{PROGRAM}: not found; install octave, or scripts/reproduce claims does", BAD_ARGUMENTS)
    return program


def version():
    """Returns the version of GNU Octave here, such as "7.3.0"."""
    done = subprocess.run([path_of_program(), "-qf", "--eval", "disp(version())"], stdin=subprocess.DEVNULL,
                          capture_output=True, encoding="utf-8", errors="replace", check=False)
    if done.returncode != 0:
        raise Stop(f"{PROGRAM}: exit status {done.returncode}: {one_line(done.stderr)}", NO_ANSWER)
    return done.stdout.strip()


def failed_cell(output):
    """Returns which cell failed, from what run_cells.m printed; nothing if none did."""
    for cell, status, step in re.findall(r'"cell": "(\w+)", "status": "([\w ]+)", "failed_step": (\d+)', output):
        if status != "converged":
            return f": {cell} {status} at step {step}"
    return ""


def kernels(blas):
    """Returns the OpenBLAS kernel set that Octave names, such as "Haswell", or None for another library."""
    found = re.search(r"OpenBLAS [\d.]+ (?:[A-Z_]+ )*([A-Z][\w]*) MAX_THREADS", blas)
    return found[1] if found else None
