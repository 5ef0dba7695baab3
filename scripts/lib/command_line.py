"""What the scripts' command lines share: refusals of one line, and checked numbers."""

import argparse
import re

from checked_json import one_line


class OneLineParser(argparse.ArgumentParser):
    """Reports a wrong argument in one line, as everything else here does."""

    def error(self, message):
        self.exit(2, f"{self.prog}: {one_line(message)} (see --help)\n")


def raw_file_parser(program, description, wrote, others):
    """Returns the parser of a script that renders what `wrote` wrote.

    `others` are options that name further raw files, with their help.
    """
    parser = OneLineParser(prog=program, description=description)
    parser.add_argument("raw", metavar="RAW.json", help=f"what {wrote} wrote")
    for name, wrote_it in others.items():
        parser.add_argument(f"--{name}", metavar=f"{name.upper()}.json", help=wrote_it)
    return parser


def whole_number(least, most):
    """Returns a reader of arguments that must be whole numbers from `least` to `most`."""
    def read(text):
        if not re.fullmatch(r"[0-9]{1,18}", text) or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {least} to {most}")
        return int(text)
    return read


def number(least, most):
    """Returns a reader of arguments that must be numbers from `least` to `most`; what only Python calls one is refused."""
    def read(text):
        plain = re.fullmatch(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?", text)
        if not plain or not least <= float(text) <= most:
            raise argparse.ArgumentTypeError(f"{text!r} is not a number from {least:g} to {most:g}")
        return float(text)
    return read


def joined_values(arguments, options):
    """Joins each of these options with its value, so that argparse takes -1e-6 for a value, not for an option."""
    joined = []
    for argument in arguments:
        if joined and joined[-1] in options and not argument.startswith("--"):
            joined[-1] += "=" + argument
        else:
            joined.append(argument)
    return joined
