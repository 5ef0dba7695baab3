"""What the scripts' command lines share: how they end, refusals of one line, and checked numbers."""

import argparse
import os
import re
import signal
import sys
import threading

from lib.programs.messages import UnusableFile, one_line

BAD_ARGUMENTS, NO_ANSWER, INTERRUPTED, TERMINATED = 2, 3, 130, 143  # exit statuses


class Stop(Exception):
    """Ends a script with one line and an exit status."""

    def __init__(self, message, status=BAD_ARGUMENTS):
        super().__init__(message)
        self.status = status


class Terminated(BaseException):
    """SIGTERM came. No Exception, since libraries catch those wherever a signal may arrive, as tqdm does in drawing."""


def run(program, main, arguments):
    """Exits with what main(arguments) returns, None for success. What the user can mend is told in one line."""
    try:
        sys.exit(main(arguments))
    except (Stop, UnusableFile) as problem:
        say(f"{program}: {one_line(problem)}")
        sys.exit(getattr(problem, "status", BAD_ARGUMENTS))
    except BrokenPipeError:
        sys.exit(1)  # The reader of a pipe, such as head, has seen enough.
    except OSError as problem:
        where = f"{one_line(problem.filename)}: cannot be written: " if problem.filename else ""
        say(f"{program}: {where}{problem.strerror or one_line(problem)}")
        sys.exit(BAD_ARGUMENTS)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except Terminated:
        say(f"{program}: terminated; the same command goes on from here")
        sys.exit(TERMINATED)


def raise_when_terminated():
    """Makes SIGTERM end a run() as Ctrl-C does: by an exception, so that processes and files are looked after.

    Python ignores exceptions in finalisers and in what runs at a fork. If one of the two was lost there, its signal is
    sent again.
    """
    def terminate(*_):
        raise Terminated

    def send_again(unraisable):
        lost = {Terminated: signal.SIGTERM, KeyboardInterrupt: signal.SIGINT}.get(unraisable.exc_type)
        if lost is None:
            sys.__unraisablehook__(unraisable)
        else:  # by another thread, when this one is out of what ignores exceptions
            threading.Timer(0.05, os.kill, (os.getpid(), lost)).start()

    signal.signal(signal.SIGTERM, terminate)
    sys.unraisablehook = send_again


def say(line):
    print(line, file=sys.stderr, flush=True)


class OneLineParser(argparse.ArgumentParser):
    """Reports a wrong argument in one line, as everything else here does."""

    def error(self, message):
        self.exit(BAD_ARGUMENTS, f"{self.prog}: {one_line(message)} (see --help)\n")


def whole_number(minimum, maximum):
    """Returns a reader of arguments that must be whole numbers from `least` to `most`."""
    def read(text):
        if not re.fullmatch(r"[0-9]{1,18}", text) or not minimum <= int(text) <= maximum:
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {minimum} to {maximum}")
        return int(text)
    return read


def number(minimum, maximum):
    """Returns a reader of arguments that must be decimal numbers from `least` to `most`."""
    def read(text):
        plain = re.fullmatch(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?", text)
        if not plain or not minimum <= float(text) <= maximum:
            raise argparse.ArgumentTypeError(f"{text!r} is not a number from {minimum:g} to {maximum:g}")
        return float(text)
    return read
