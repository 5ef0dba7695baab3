"""What the studies of scripts/studies share: command line, untimed work on all cores, timed work on one.

Untimed work goes to an executor: processes of this machine, or with --scheduler a Dask cluster, whose workers need a
Python with the module isosyrk. It may not depend on the clock, so that both give the same raw file. What is finished
stands in a journal beside the raw file, and an interrupted study goes on from there.
"""

import argparse
import asyncio
import concurrent.futures
import contextlib
import functools
import json
import logging
import math
import multiprocessing
import os
import pickle
import re
import signal
import site
import statistics
import sys
import tempfile
import threading
from functools import partial

from lib.programs import chart_python, command_line
from lib.programs.command_line import INTERRUPTED, NO_ANSWER, OneLineParser, Stop, say, whole_number
from lib.programs.messages import one_line
from lib.programs.output import replace_file
from lib.programs.places import BUILD, MODULE, ROOT
from lib.records.formats import FAST, PUBLISHED, Integrator
from lib.running import fresh_process

JOURNAL = "isosyrk journal 1"
PROCESS = "--process"  # the hidden mode of a study: what follows is one block to time
RESULTS_DEPEND_ON = ("commit", "dirty")  # conditions, of all work
TIMES_DEPEND_ON = ("cpu", "blas_kernels", "split_kernels")  # and of timed work
NOT_OF_THE_STUDY = ("out", "scheduler", "workers", "repetitions", "processes")  # options that leave results as they are
MOST_LOSSES = 3  # of workers, without a job finished between
LOST = "a worker was lost; its jobs are done again"
ENOUGH_TIMED = 0.6  # CPU seconds of timed work on a point, after which it is repeated no more
WARM_STEPS = 32  # untimed, of a method with a predictor, which knows 24 past steps at most (core/solver/tuning.h)
LEAST_SECONDS = 0.01  # that a repetition fills with runs, so that clock and interruptions do not weigh


# ---- starting


def require_module(program, modules=("isosyrk", "numpy", "tqdm")):
    """Returns where isosyrk can be imported; otherwise starts this script again where it can, or exits with 2."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # NumPy's; the module's products take one thread anyway
    if os.path.isdir(MODULE):
        sys.path.insert(0, MODULE)
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (MODULE, os.environ.get("PYTHONPATH"))))
    chart_python.require(program, modules,
                         "build it with scripts/reproduce accuracy, or install python3-numpy and python3-tqdm")


def program(name):
    """Returns the path of a program of the build. Throws Stop where it is not there."""
    path = os.path.join(BUILD, "benchmarks", name)
    if not os.access(path, os.X_OK):
        raise Stop(f"{one_line(path)}: is not built; build it with cmake --build, or with scripts/reproduce scaling")
    return path


def parser(program, description, out="FILE", largest_n=513):
    """Returns a parser with the options that all studies have. `out` is FILE or FOLDER."""
    options = OneLineParser(prog=program, description=description, allow_abbrev=False)
    options.add_argument("--out", metavar=out, required=True,
                        help="what to write; a journal beside it keeps what is done")
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


@functools.lru_cache(maxsize=None)
def integrators():
    """Returns the Integrators of the module's list by name."""
    import isosyrk
    found = ({field: getattr(each, field) for field in Integrator._fields} for each in isosyrk.integrators())
    return {each["name"]: Integrator(**{**each, "stability_limit": finite_or_none(each["stability_limit"])})
            for each in found}


def finite_or_none(value):
    return value if math.isfinite(value) else None


def entries(names, frames=False):
    """Returns the Integrators of these names in the module's list. Throws Stop for an unknown name.

    None stands for all; for those in the co-rotating frame only where `frames` says so, since each doubles a study.
    """
    for name in names or ():
        if name not in integrators():
            raise Stop(f"--integrator {one_line(name)!r}: must be one of {', '.join(integrators())}")
    every = (name for name, each in integrators().items() if frames or not each.co_rotating)
    return [integrators()[name] for name in dict.fromkeys(names or every)]


def solver_of(name):
    """Returns the solver of the best form of an integrator: fast where there is one."""
    return FAST if integrators()[name].has_fast_form else PUBLISHED


def require_writable(path):
    folder = os.path.dirname(os.path.abspath(path))
    if os.path.isdir(path) or not os.path.isdir(folder) or not os.access(folder, os.W_OK):
        raise Stop(f"--out {one_line(path)}: cannot be written")


def process_command(package, block, process, **further):
    """Returns the command by which a fresh process times a block, by time_block() of a package of studies.

    The block gets the fields `process`, its number, and `further`.
    """
    return [sys.executable, "-B", os.path.join(ROOT, "scripts", "measure"), package, PROCESS,
            json.dumps({**block, "process": process, **further})]


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


def progress(total, what):
    """Returns a bar with the time left, on stderr."""
    from tqdm import tqdm  # only now: a Python without it can still say which one has it
    return tqdm(total=total, desc=what, file=sys.stderr, dynamic_ncols=True)


# ---- the journal


class Journal:
    """Finished work of an unfinished study, as JSON lines: what it belongs to, then a key and a result each.

    One that belongs to anything else, as another commit, is begun anew, and that is told. On another processor untimed
    work is kept and timed work is done again. `context` holds the conditions of the first start on this processor.
    `processes` and `disturbed` count those that timed, over all timed parts of the study.
    """

    def __init__(self, study, options, conditions):
        """`conditions()` returns the context of a raw file, as isosyrk.conditions does; it is called now."""
        require_writable(options.out)
        self.path = f"{options.out}.journal"
        now = conditions()
        arguments = {name: value for name, value in vars(options).items() if name not in NOT_OF_THE_STUDY}
        head = {"format": JOURNAL, "study": study, "arguments": arguments,
                "conditions": {name: now.get(name) for name in RESULTS_DEPEND_ON}}
        begun, *results = self._lines() or [{}]
        goes_on = {**begun, "context": None} == {**head, "context": None}
        same_processor = goes_on and all(begun["context"].get(name) == now.get(name) for name in TIMES_DEPEND_ON)
        if goes_on:
            say(f"{one_line(self.path)}: going on after {len(results)} results")
        elif os.path.exists(self.path):
            say(f"{one_line(self.path)}: belongs to something else, begun anew")
        if goes_on and not same_processor:
            say(f"{one_line(self.path)}: begun on another processor, timed work is done again")
            now["untimed_work_begun_on"] = begun["context"].get("cpu", "an unknown processor")
        self.context = begun["context"] if same_processor else now
        self.found = dict(results) if goes_on else {}
        self.processes = self.disturbed = 0
        # Anew, without a last line that was cut.
        lines = (json.dumps(each) + "\n" for each in ({**head, "context": self.context}, *self.found.items()))
        replace_file(self.path, "".join(lines).encode("utf-8"))

    def _lines(self):
        """Returns the whole lines of the file, up to one that was cut."""
        lines = []
        with contextlib.suppress(FileNotFoundError, ValueError), open(self.path, encoding="utf-8") as file:
            lines.extend(map(json.loads, file))
        return lines if lines and isinstance(lines[0], dict) else []

    def add(self, key, result):
        """Keeps a result."""
        line = json.dumps([key, result], allow_nan=False)
        with open(self.path, "a", encoding="utf-8") as file:
            file.write(line + "\n")
        self.found[key] = json.loads(line)[1]

    def remove(self):
        os.unlink(self.path)

    def products(self, n):
        """Returns the product backend that was the faster as the study began, at n or the nearest n that was tried."""
        chosen = {int(tried): backend for tried, backend in re.findall(r"n=(\d+) (\w+)", self.context["products"])}
        return chosen[min(chosen, key=lambda tried: abs(tried - n))]

    def key_of_timed(self, what, job):
        """Returns the key of a result that only this processor can give."""
        return key_of(f"{what} on {', '.join(str(self.context.get(name)) for name in TIMES_DEPEND_ON)}", job)


def key_of(what, job):
    return json.dumps([what, job], sort_keys=True)


# ---- untimed work


def untimed(jobs, work, journal, options, what):
    """Returns work(job) of each job, in their order. Jobs and results are what JSON can hold.

    `work` is a function of the study's module. The last jobs are begun first: they tend to be the longest. A lost
    worker is told and its jobs are done again.
    """
    keys = [key_of(what, job) for job in jobs]
    losses = 0
    with progress(len(jobs), what) as bar:
        while True:
            left = {key: job for key, job in zip(keys, jobs) if key not in journal.found}
            bar.update(len(jobs) - len(left) - bar.n)
            if not left:
                return [journal.found[key] for key in keys]
            if losses > MOST_LOSSES:
                raise Stop(f"{what}: a worker was lost {losses} times without a job finished between", NO_ANSWER)
            with executor(options) as (pool, watch, lost):
                futures = {pool.submit(work, job): key for key, job in reversed(left.items())}
                broken = False
                while futures:
                    done, _ = concurrent.futures.wait(futures, 1.0, concurrent.futures.FIRST_COMPLETED)
                    for line in watch():
                        bar.write(line, file=sys.stderr)
                    for future in done:
                        key = futures.pop(future)
                        try:
                            journal.add(key, future.result())
                            bar.update()
                            losses = 0
                        except lost:
                            broken = True
            if broken:
                losses += 1
                bar.write(LOST, file=sys.stderr)


def executor(options):
    folders = (MODULE, os.path.join(ROOT, "scripts"))
    return dask(options.scheduler, folders) if options.scheduler else processes(options.workers)


@contextlib.contextmanager
def processes(workers):
    """Yields an executor on this machine, a watch that returns what is to be told, and the errors of a lost job.

    Its processes are spawned, because OpenMP hangs in a forked child.
    """
    pool = concurrent.futures.ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"), follow_parent)
    try:
        yield pool, lambda: (), concurrent.futures.BrokenExecutor
        pool.shutdown()
    finally:  # at once, whatever they do; then the pool's own thread is waited for, which would complain at exit
        for child in multiprocessing.active_children():
            child.terminate()
        pool.shutdown(cancel_futures=True)


def follow_parent():
    """Leaves Ctrl-C to the process that started this one, and ends with it, however it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    threading.Thread(target=lambda: (parent.join(), os._exit(1)), daemon=True).start()


class Call:
    """work(job) as a pickle: who loads it makes the call and gets its result."""

    def __init__(self, work, job):
        self.work, self.job = work, job

    def __reduce__(self):
        return self.work, (self.job,)


class DaskExecutor:
    """Submits calls to a Dask cluster as bytes.

    Schedulers of newer releases load what they pass on, and know neither the study nor the module isosyrk.
    """

    def __init__(self, client):
        self.executor = client.get_executor(pure=False)

    def submit(self, work, job):
        return self.executor.submit(pickle.loads, pickle.dumps(Call(work, job)))


@contextlib.contextmanager
def dask(address, folders):
    """Yields the same for a Dask cluster, whose scheduler gives the jobs of a lost worker to others, up to three times.

    Its workers import from these folders too, where they have them.
    """
    try:
        import distributed
    except ImportError:
        raise Stop("--scheduler: this Python has no distributed; install python3-distributed") from None
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = distributed.Client(address, timeout=10, set_as_default=False)
    except (OSError, ValueError, TypeError) as problem:
        raise Stop(f"--scheduler {one_line(address)}: cannot be reached ({one_line(problem)})") from None
    for folder in folders:
        client.register_worker_callbacks(partial(site.addsitedir, folder))
    workers = {None}  # so that a cluster without any is told

    def watch():
        nonlocal workers
        try:
            before, workers = workers, set(client.scheduler_info()["workers"])
        except (OSError, asyncio.TimeoutError):
            raise Stop(f"--scheduler {address}: is gone; the same command goes on from here") from None
        told = [LOST] * len(before - workers - {None})
        return told if workers or not before else [*told, "the Dask scheduler has no workers; waiting for one"]

    lost = (distributed.scheduler.KilledWorker, concurrent.futures.CancelledError)
    try:
        yield DaskExecutor(client), watch, lost
    finally:
        client.close()


# ---- timed work


def seconds_of(method, W, h, steps, warmup=0):
    """Returns the CPU seconds of a run after `warmup` untimed steps: the mean of as many as fill LEAST_SECONDS."""
    first = method.timed_run(W, h, steps, repetitions=1, warmup=warmup)[0]
    if first >= LEAST_SECONDS:
        return first
    repetitions = math.ceil(LEAST_SECONDS / max(first, 1e-6))
    return statistics.fmean(method.timed_run(W, h, steps, repetitions=repetitions, warmup=warmup))


def in_turns(points, repetitions, time_one, journal, what, enough=ENOUGH_TIMED):
    """Returns the CPU seconds of each point, a list of so many repetitions, by time_one(point).

    All points are timed once, in their order, then again: a slow minute of the machine falls on all alike. This process
    is kept on the last core meanwhile. A point on which `enough` seconds were spent is not repeated.
    """
    cores = os.sched_getaffinity(0)
    journal.context["timed_on"] = f"core {max(cores)}"
    os.sched_setaffinity(0, {max(cores)})
    seconds = [[] for _ in points]
    try:
        with progress(len(points) * repetitions, what) as bar:
            for repetition in range(repetitions):
                for point, found in zip(points, seconds):
                    if sum(found) < enough:
                        key = journal.key_of_timed(f"{what} {repetition}", point)
                        if key not in journal.found:
                            journal.add(key, time_one(point))
                        found.append(journal.found[key])
                    bar.update()
    finally:
        os.sched_setaffinity(0, cores)
    return seconds


def by_processes(blocks, command, further, journal, what, cores=None, results=lambda printed, rows: printed):
    """Returns the CPU seconds of the rows of each block, as dicts from a row to a list with an entry for each process.

    A block is an object of JSON whose "rows" are names. `command(block, process)` is a command that times the rows of a
    block in turns and prints their seconds, a list of JSON; `process` counts from 0. Where it prints other JSON,
    `results(printed, rows)` makes of it the list that is kept, an entry a row, in place of seconds. `further(seconds)`
    returns, given the dict of a block so far, how many further processes each row wants; it is asked again when these
    are done. Every block gets its first process, then every block its second: a slow minute of the machine falls on all
    alike. They run on the last core, or on `cores`, a set; the journal's context names them, a set under WHAT_timed_on.
    A disturbed process is repeated; those that stayed disturbed are counted in the journal's context, over all parts of
    the study.
    """
    where = "timed_on" if cores is None else f"{what.replace(' ', '_')}_timed_on"
    cores = cores or {fresh_process.last_core()}
    seconds = [{row: [] for row in block["rows"]} for block in blocks]
    wanted = [further(found) for found in seconds]
    done = process = 0
    with progress(sum(most(each) for each in wanted), what) as bar:
        while any(map(most, wanted)):
            for block, found, each in zip(blocks, seconds, wanted):
                part = {**block, "rows": [row for row in block["rows"] if each[row] > 0]}
                if not part["rows"]:
                    continue
                key = journal.key_of_timed(f"{what}, process {process}", part)
                if key not in journal.found:
                    times, disturbance = fresh_process.undisturbed(
                        partial(printed, cores, command(part, process), part["rows"], what, results),
                        partial(bar.write, file=sys.stderr))
                    journal.add(key, {"seconds": times, "disturbed": bool(disturbance)})
                journal.processes += 1
                journal.disturbed += journal.found[key]["disturbed"]
                for row, passed in zip(part["rows"], journal.found[key]["seconds"]):
                    found[row].append(passed)
                    each[row] -= 1
                done += 1
                bar.update()
            process += 1
            wanted = [each if most(each) else further(found) for found, each in zip(seconds, wanted)]
            bar.total = done + sum(map(most, wanted))
    named = f"core{'s' if len(cores) > 1 else ''} {', '.join(map(str, sorted(cores)))}"
    journal.context.update({where: named, "disturbed_processes": f"{journal.disturbed} of {journal.processes}"})
    return seconds


def most(counts):
    return max(counts.values(), default=0)


def printed(cores, command, rows, what, results):
    """Runs a command on cores. Returns results(what it printed, rows), an entry a row, and the Disturbance."""
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        status, disturbance = fresh_process.run_on(cores, command, stdout=output, stderr=errors)
        output.seek(0)
        errors.seek(0)
        *_, last = [""] + errors.read().decode("utf-8", "replace").split("\n")[:-1]
        with contextlib.suppress(ValueError, TypeError, KeyError):
            found = results(json.loads(output.read()), rows)
            if status == 0 and len(found) == len(rows):
                return found, disturbance
    raise Stop(f"{what}: a process ended with status {status} and without its times: {one_line(last)}", NO_ANSWER)
