"""What the scripts that render one table from one raw file share: arguments, writing, and how they fail."""

import os
import sys

from checked_json import UnusableFile, one_line
from command_line import raw_file_parser
from document import WRITERS, replace_file, write_standard_output


def save(data, options, raw_files):
    """Writes the result where it was asked for, never over the measurements."""
    if options.output is None:
        write_standard_output(data)
    elif os.path.exists(options.output) and any(os.path.samefile(each, options.output) for each in raw_files):
        raise OSError(0, "is the raw file itself")
    else:
        replace_file(options.output, data)


def render(program, description, wrote, table, arguments, others=None):
    """Renders the document `table(path of the raw file)` as asked; returns the exit code.

    `others` are options that name further raw files, with their help; `table` takes those given by name.
    """
    parser = raw_file_parser(program, description, wrote, others or {})
    parser.add_argument("--format", choices=tuple(WRITERS), default="text")
    parser.add_argument("--output", metavar="FILE", help="write here instead of to standard output")
    options = parser.parse_args(arguments)
    further = {name: getattr(options, name) for name in others or {} if getattr(options, name) is not None}
    try:
        data = WRITERS[options.format](table(options.raw, **further)).encode("utf-8")
        save(data, options, (options.raw, *further.values()))
    except UnusableFile as problem:
        print(f"{program}: {problem}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        return 1  # The reader of a pipe, such as head, has seen enough.
    except OSError as problem:
        where = "standard output" if options.output is None else one_line(options.output)
        print(f"{program}: {where}: cannot be written: {problem.strerror}", file=sys.stderr)
        return 2
    return 0
