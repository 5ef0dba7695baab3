"""Measures table1 or table2 in fresh processes, one matrix size each, until the verdicts are decided. Standard library.

A process times the cells of its n interleaved, in an order of its own. Further ones are started only for an n with an
undecided pair of rows, or an undecided claim. What a process gave is kept in a file of its own, so that an interrupted
measurement goes on.
"""

import json
import os
import re
import time
from typing import NamedTuple, Tuple

from lib.programs.command_line import BAD_ARGUMENTS, Stop, say
from lib.programs.messages import UnusableFile, one_line
from lib.programs.output import replace_file
from lib.records.formats import parse_json, read_text, to_digits
from lib.records.table_file import run_of
from lib.judging.verdicts import FEWEST, MAXIMUM, more_processes
from lib.running import fresh_process
from studies.tables.judge import block_verdicts

COLD_FROM = 129  # from this n on a process times one run, without a warm one before
KEPT_FIELDS = ("run_name", "run_type", "repetition_index", "iterations",
               "real_time", "cpu_time", "time_unit", "error_occurred", "error_message")  # of a row, beside its counters
CONDITIONS = ("commit", "dirty", "flags", "cpu", "blas_kernels")  # which all processes must share


class Plan(NamedTuple):
    """What is to be measured."""

    program: str  # path of the benchmark program
    tables: Tuple[str, ...]  # that the rows are named by, "table1" and "table2"
    sizes: Tuple[int, ...]
    arguments: Tuple[str, ...]  # of every process
    min_time: float  # seconds that a repetition fills with runs
    kept: str  # folder for what the processes gave

    @property
    def name(self):
        return os.path.basename(self.program)


def measure(plan):
    """Returns a document in Google Benchmark's form, each row with its process, and the largest exit status.

    Of the repetitions within a process the document has the quickest, unless one of them failed.

    Throws Stop if a process gives no rows.
    """
    core = fresh_process.last_core()
    progress, processes = Progress(len(plan.sizes) * FEWEST), {n: [] for n in plan.sizes}
    disturbed = []
    wanted = dict.fromkeys(plan.sizes, FEWEST)
    while any(wanted.values()):
        for n in [n for n, more in wanted.items() if more]:
            number = len(processes[n])
            found = kept_process(plan, n, number)
            if found is None:
                found = one_process(plan, core, n, number, processes)
            processes[n].append(found)
            if found["disturbed"]:
                disturbed.append(f"n={n} process {number}")
            progress.finished(n, number, found["seconds"])
            wanted[n] -= 1
        for n in plan.sizes:
            if not wanted[n]:
                wanted[n] = more_processes(len(processes[n]), verdicts_at(plan, n, processes[n]))
                progress.expect(wanted[n])
    return merged(processes, core, disturbed), max(each["status"] for found in processes.values() for each in found)


def verdicts_at(plan, n, found):
    """Returns every verdict at n by the processes so far."""
    document = {"context": found[0]["context"], "benchmarks": [row for each in found for row in each["benchmarks"]]}
    verdicts = set()
    for table in plan.tables:
        try:
            run = run_of(document, (plan.name,), (), (), table)
        except UnusableFile as problem:
            raise Stop(f"what {plan.program} wrote {problem}") from None
        verdicts |= block_verdicts(run, n)
    return verdicts


def one_process(plan, core, n, number, processes):
    """Returns what a fresh process gave at n: context, rows, exit status, seconds, and whether it was disturbed."""
    raw, log = os.path.join(plan.kept, "running.json"), os.path.join(plan.kept, "log.txt")
    cold = n >= COLD_FROM
    command = [plan.program, *plan.arguments, f"--benchmark_filter=/n:{n}/", f"--benchmark_out={raw}",
               f"--benchmark_min_time={plan.min_time}", f"--benchmark_repetitions={1 if cold else 3}",
               "--benchmark_enable_random_interleaving=true"]
    first = next((each[0] for each in processes.values() if each), None)
    if first:  # the backend is chosen once, so that all processes do the same work
        command.append(f"--products={backend(first['context'], n)}")
    if cold and number:
        command.append("--no-warm-run")

    def run():
        begun = time.monotonic()
        with open(log, "wb") as output:
            status, disturbance = fresh_process.run_on(core, command, stdout=output, stderr=output)
        try:
            document = parse_json(read_text(raw))
            os.unlink(raw)
            found = {"context": document["context"], "benchmarks": measured_rows(document["benchmarks"], number)}
        except (UnusableFile, KeyError, TypeError) as problem:
            say(log_end(log))
            code = status if status >= 0 else 128 - status
            raise Stop(f"{plan.program} failed with exit status {code}: its raw file {one_line(problem)}",
                       code or BAD_ARGUMENTS) from None
        return {**found, "status": status, "seconds": time.monotonic() - begun}, disturbance

    found, disturbance = fresh_process.undisturbed(run, lambda line: say(f"n = {n}, process {number}: {line}"))
    if first and conditions(found) != conditions(first):
        raise Stop(f"{plan.kept}: what was measured before was under other conditions; remove it and begin anew")
    found.update(disturbed=bool(disturbance), plan=identity(plan))
    if cold and number:
        take_energy_errors(found["benchmarks"], processes[n][0]["benchmarks"])
    replace_file(kept_path(plan, n, number), json.dumps(found).encode("utf-8"))
    return found


def measured_rows(rows, number):
    """Returns the rows of the repetitions, with their process and without what says nothing of them."""
    return [{"process": number, **{name: rounded(value) for name, value in row.items()
                                   if name in KEPT_FIELDS or isinstance(value, float)}}
            for row in rows if row["run_type"] == "iteration"]


def rounded(value):
    """Returns a number to the digits that are measured, which keeps raw files small."""
    return to_digits(value, 7) if isinstance(value, float) else value


def take_energy_errors(rows, first):
    """Gives rows without a warm run the energy error of the first process, whose run was the same to the last bit."""
    known = {row["run_name"]: row for row in first}
    for row in rows:
        like = known.get(row["run_name"], {})
        if all(row.get(name) == like.get(name) for name in ("spectrum_error", "skew_defect", "sweeps_per_step")):
            row.update({"energy_error": like["energy_error"]} if "energy_error" in like else {})


def backend(context, n):
    """Returns the library of products of published forms that the first process found the faster at n."""
    chosen = context.get("published_products") or context.get("products", "")
    return dict(re.findall(r"n=(\d+) (\w+)", chosen)).get(str(n), "fastest")


def merged(processes, core, disturbed):
    """Returns one document of all processes, with the context of the first and how many there were."""
    context = dict(next(iter(processes.values()))[0]["context"])
    context.pop("host_name", None)  # whose machine it was is nobody's business
    context["processes"] = "; ".join(f"n={n}: {len(found)}" for n, found in processes.items())
    context["disturbed_processes"] = ", ".join(disturbed)
    context["pinned_to"] = f"core {core}"
    rows = [row for found in processes.values() for each in found for row in quickest(each["benchmarks"])]
    return {"context": context, "benchmarks": rows}


def quickest(rows):
    """Returns of the rows of a process the quickest repetition of each cell, which counts; all of one that failed."""
    cells = {}
    for row in rows:
        cells.setdefault(row["run_name"], []).append(row)
    kept = []
    for cell in cells.values():
        failed = any(row.get("error_occurred") for row in cell)
        kept += cell if failed else [min(cell, key=lambda row: row["cpu_time"])]
    return kept


# ---- what is kept


def kept_path(plan, n, number):
    return os.path.join(plan.kept, f"n{n}_process{number}.json")


def identity(plan):
    """Returns what kept processes depend on: the program as it was built, and what it was asked."""
    built = os.stat(plan.program)
    return [plan.program, built.st_size, built.st_mtime, list(plan.arguments), plan.min_time]


def conditions(found):
    return [found["context"].get(name) for name in CONDITIONS]


def kept_process(plan, n, number):
    """Returns what this process gave before an interruption, by the same program; or None."""
    try:
        found = parse_json(read_text(kept_path(plan, n, number)))
    except UnusableFile:
        return None
    return found if found["plan"] == identity(plan) else None


class Progress:
    """Says after each process how many there are to come, and how long they take."""

    def __init__(self, total):
        self.total, self.done, self.seconds = total, 0, {}

    def expect(self, more):
        self.total += more

    def finished(self, n, number, seconds):
        self.done += 1
        self.seconds.setdefault(n, []).append(seconds)
        known = [sum(each) / len(each) for each in self.seconds.values()]
        left = (self.total - self.done) * sum(known) / len(known)
        say(f"[{self.done} of {self.total}] n = {n}, process {number}: {seconds:.1f} s, about {left:.0f} s left"
            + (f" (at most {MAXIMUM} processes an n)" if number >= FEWEST else ""))


def log_end(path, lines=5):
    """Returns the last lines of what a program said, to be told before its end.

    Without Google Benchmark's warning of how its package was built: benchmarks/README.md.
    """
    with open(path, encoding="utf-8", errors="replace") as file:
        return "".join([line for line in file if "Library was built as DEBUG" not in line][-lines:])
