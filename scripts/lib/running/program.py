"""The program of a study: its command line, how it starts and ends, and what it shows meanwhile."""

import argparse
import json
import os
import re
import sys

from lib.programs import command_line
from lib.programs.command_line import INTERRUPTED, OneLineParser, Stop, whole_number
from lib.programs.places import ROOT

PROCESS = "--process"  # the hidden mode of a study: what follows is one block to time


def parser(program, description, out="FILE", largest_n=513):
    """Returns a parser with the options that all studies have. `out` is FILE or FOLDER."""
    options = OneLineParser(prog=program, description=description, allow_abbrev=False)
    options.add_argument("--out", metavar=out, required=True,
                        help="what to write; a checkpoint beside it keeps what is done")
    options.add_argument("--quick", action="store_true", help="the smaller study")
    options.add_argument("--n", metavar="N", type=whole_number(5, largest_n), nargs="+", action="extend",
                         help="matrix sizes")
    options.add_argument("--integrator", metavar="NAME", nargs="+", action="extend", help="integrators (default: all)")
    options.add_argument("--scheduler", metavar="tcp://HOST:PORT", type=address,
                        help="Dask scheduler that untimed work is given to")
    options.add_argument("--workers", metavar="K", type=whole_number(1, 1024), default=len(os.sched_getaffinity(0)),
                        help="processes for untimed work without --scheduler (default: one for each core)")
    return options


def address(value):
    """Reads the argument of --scheduler."""
    if not re.fullmatch(r"tcp://[^\s/]+:[0-9]{1,5}", value):
        raise argparse.ArgumentTypeError(f"{value!r} is not tcp://HOST:PORT")
    return value


def run(program, main, arguments, time_block=None):
    """Runs a study's main and exits. What the user can mend is one line; Ctrl-C and SIGTERM end all its processes.

    In a process of process_command() it prints what `time_block` returns of the block instead.
    """
    if arguments[:1] == [PROCESS]:
        command_line.run(program, lambda block: print(json.dumps(time_block(json.loads(block)))), arguments[1])

    def resumable(arguments):
        try:
            return main(arguments)
        except KeyboardInterrupt:
            raise Stop("interrupted; the same command goes on from here", INTERRUPTED) from None

    command_line.raise_when_terminated()
    command_line.run(program, resumable, arguments)


def process_command(package, block, process, **further):
    """Returns the command by which a fresh process times a block, by time_block() of a package of studies.

    The block gets the fields `process`, its number, and `further`.
    """
    return [sys.executable, "-B", os.path.join(ROOT, "scripts", "measure"), package, PROCESS,
            json.dumps({**block, "process": process, **further})]


def progress(total, what):
    """Returns a bar with the time left, on stderr."""
    from tqdm import tqdm  # only now: a Python without it can still say which one has it
    return tqdm(total=total, desc=what, file=sys.stderr, dynamic_ncols=True)
