"""The section of the report of `scaling` on what threads gain."""

import statistics

from lib.judging.verdicts import FEWEST, MARGIN
from lib.pages.document import Column, Entry, Heading, Paragraph, Table, conditions
from lib.pages.numbers import MISSING, percentage, three_digits
from studies.tables.comparison import ratio_text

DIFFERENT = "NOT the same"


def thread_sections(threads):
    """Returns the section on Threads with the conditions of its own raw file."""
    if not threads.runs:
        return [Heading("Threads"), Paragraph("Nothing was timed: the study had one core only."),
                conditions(threads.context)]
    return [
        Heading("Threads"),
        Paragraph(f"A step of fast forms by several numbers of threads, {threads.settings.scene} scene, on"
                  f" {threads.settings.cores} cores. Runs begin at t = 0 and are short; in a long run a step that"
                  " starts from past ones takes less. A process runs all numbers of threads, in rising or in falling"
                  " order; times are those that pass, geometric means over processes. Speed-up: the time by one thread"
                  " over that of the row, with its 95 % interval. Than fewer: the verdict against the row above it;"
                  f" {100 * (MARGIN - 1):.0f} % are a tie, and fewer than {FEWEST} processes decide nothing."
                  " Operations: what threads share in a step. Serial: the share of a step's time outside operations."
                  " Waiting: the share of the threads' time within operations in which they do not work. Threads that"
                  " a size is too small for wait all the time. Look: the time until a state is there, over that of a"
                  " step."),
        Paragraph(bits_text(threads)),
        table_of(threads),
        conditions(threads.context),
    ]


def bits_text(threads):
    different = threads.different()
    if not different:
        return "Every number of threads gives the same answer bit for bit."
    places = ", ".join(f"{run.integrator} at n = {run.n} by {run.threads} threads" for run in different)
    return f"Answers are {DIFFERENT} bit for bit: {places}."


def table_of(threads):
    columns = (Column("n"), Column("integrator", align="left"), Column("h"), Column("threads"), Column("ms a step"),
               Column("speed-up"), Column("than fewer", align="left"), Column("operations"), Column("serial"),
               Column("waiting"), Column("look"), Column("bits", align="left"), Column("processes"))
    runs = sorted(threads.runs.values(), key=lambda run: run.n)  # otherwise as in the file
    return Table(columns, [[row_of(threads, run) for run in runs if run.n == n]
                           for n in dict.fromkeys(run.n for run in runs)])


def row_of(threads, run):
    different = not all(run.same)
    shares = [percentage(statistics.median(each)) for each in (run.serial, run.waiting)]
    return [Entry(str(run.n)), Entry(run.integrator), Entry(f"{run.step:g}"), Entry(str(run.threads)),
            Entry(three_digits(1e3 * run.time)),
            Entry(ratio_text(threads.gain(run)) if run.threads > 1 else MISSING),
            Entry(threads.than_fewer(run) or MISSING), Entry(three_digits(statistics.median(run.operations))),
            *map(Entry, shares), Entry(percentage(run.share_of_looking)),
            Entry(DIFFERENT if different else "same", marked=different), Entry(str(len(run.seconds)))]
