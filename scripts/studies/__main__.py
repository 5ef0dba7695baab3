"""Answers what scripts/reproduce asks of the list of studies: usage, names, or the lines of one study.

    names                one name a line
    usage                what the studies measure and how long that takes, a text
    needs NAME           packages besides those of the build, by a name in setup.sh
    shown NAME           which of its results is printed at the end
    parts NAME yes|no    a line for each part, of fields set apart by tabs: what is said, package, raw file, build,
                         arguments; `yes` for the quick study
"""

import os
import sys
import textwrap

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

from studies import BY_NAME, STUDIES

WIDTH, INDENT = 112, 19


def usage():
    """Returns a list of what there is, with times."""
    entries = [(each.name, f"{each.title}: {minutes(each.minutes)}, quick {minutes(each.quick_minutes)}")
               for each in STUDIES]
    entries.append(("all", "everything, each into a folder of its own"))
    return "\n".join(textwrap.fill(text, WIDTH, initial_indent=f"  {name}".ljust(INDENT),
                                   subsequent_indent=" " * INDENT) for name, text in entries)


def minutes(number):
    return "half a minute" if number == 0.5 else f"about {number:g} minute{'s' if number != 1 else ''}"


def parts(name, quick):
    found = BY_NAME[name].parts
    for number, part in enumerate(found, 1):
        counted = f" ({number} of {len(found)})" if len(found) > 1 else ""
        arguments = part.arguments if part.quick_arguments is None or not quick else part.quick_arguments
        arguments += ("--quick",) if quick else ()
        yield "\t".join((part.saying + counted, part.package, part.file, part.build or "-", " ".join(arguments)))


def answer(question, *arguments):
    if question == "names":
        return "\n".join(BY_NAME)
    if question == "usage":
        return usage()
    if question in ("needs", "shown"):
        return getattr(BY_NAME[arguments[0]], question)
    return "\n".join(parts(arguments[0], arguments[1] == "yes"))


if __name__ == "__main__":
    print(answer(*sys.argv[1:]))
