"""Untimed work of a study on all cores, by Dask: a cluster of processes on this machine, or with --scheduler another.

It may not depend on the clock, so that every cluster gives the same raw file. Workers of another cluster need a Python
with the module isosyrk. What is finished goes to the checkpoint at once.
"""

import asyncio
import concurrent.futures
import contextlib
import logging
import multiprocessing
import os
import pickle
import queue
import signal
import site
import sys
import tempfile
import time
from functools import partial
from multiprocessing import forkserver, resource_tracker

from lib.programs.command_line import NO_ANSWER, Stop
from lib.programs.messages import one_line
from lib.programs.places import MODULE, ROOT
from lib.running.checkpoint import key_of
from lib.running.program import progress

MAX_LOSSES = 3  # of workers, without a job finished between
LOST = "a worker was lost; its jobs are done again"
NO_WORKERS = "the Dask scheduler has no workers; waiting for one"
LOOK_SECONDS = 1.0  # between two looks at which workers there are

# Of the cluster on this machine. Workers are forked from a process that has only imported Dask: forked from this one
# they would hang in OpenMP, and spawned each would import it again, for a second. A worker in a long run is not lost.
# No pages are served, and Dask is to set no variables of this process, which those that are timed later inherit.
SETTINGS = {"distributed.worker.multiprocessing-method": "forkserver", "distributed.scheduler.worker-ttl": None,
            "distributed.scheduler.allowed-failures": 0,
            "distributed.worker.profile.enabled": False,
            "distributed.worker.http.routes": [], "distributed.scheduler.http.routes": [],
            "distributed.nanny.environ": {}, "distributed.nanny.pre-spawn-environ": {}}


def results(jobs, work, checkpoint, options, what):
    """Returns work(job) of each job, in their order. Jobs and results are what JSON can hold.

    `work` is a function of the study's module. The last jobs are begun first: they tend to be the longest. A lost
    worker is told and its jobs are done again. Throws Stop where workers are lost one after another, or where there is
    no cluster.
    """
    keys = [key_of(what, job) for job in jobs]
    left = {key: job for key, job in zip(keys, jobs) if key not in checkpoint.found}
    if left:
        with Cluster(options) as cluster, progress(len(jobs), what) as bar:
            bar.update(len(jobs) - len(left))
            for key, result in cluster.as_finished(work, left, what, partial(bar.write, file=sys.stderr)):
                checkpoint.add(key, result)
                bar.update()
    return [checkpoint.found[key] for key in keys]


class Cluster:
    """The cluster that --scheduler names, or one on this machine, which ends with the study, as a context manager.

    Workers import from the folders of this checkout, where they have them. Throws Stop where there is no cluster.
    """

    def __init__(self, options):
        self.scheduler, self.count = options.scheduler, options.workers
        self.workers, self.looked_at = None, -LOOK_SECONDS

    def __enter__(self):
        try:
            import distributed
        except ImportError:
            raise Stop("this Python has no distributed, by which work is run: install python3-distributed") from None
        for name in ("distributed", "distributed.client", "asyncio"):  # what a user has to know is told in one line
            logging.getLogger(name).setLevel(logging.CRITICAL)
        with contextlib.ExitStack() as begun:
            address = self.scheduler or begun.enter_context(processes(self.count))
            try:
                self.client = begun.enter_context(distributed.Client(address, timeout=10, set_as_default=False))
            except (OSError, ValueError, TypeError) as problem:
                raise Stop(f"--scheduler {one_line(address)}: cannot be reached ({one_line(problem)})") from None
            for folder in (MODULE, os.path.join(ROOT, "scripts")):
                self.client.register_worker_callbacks(partial(site.addsitedir, folder))
            self.ending = begun.pop_all()
        self.workers, self.looked_at = None, -LOOK_SECONDS
        return self

    def __exit__(self, *_):
        self.ending.close()

    def as_finished(self, work, jobs, what, tell):
        """Yields the key and work(job) of each of `jobs`, a dict by key, in the order in which they end.

        `tell` gets a line for each lost worker. The scheduler gives its jobs to others, but gives up on those that saw
        several losses: these are submitted again, and where the cluster is our own all that are left, to a new one.
        """
        from distributed.scheduler import KilledWorker
        waiting, losses = dict(jobs), 0
        ended = self.submitted(work, waiting, tell)
        while waiting:
            lost = 0
            with contextlib.suppress(queue.Empty):
                key, future = ended.get(timeout=LOOK_SECONDS)
                try:
                    yield key, future.result()
                    del waiting[key]
                    losses = 0
                except (concurrent.futures.CancelledError, asyncio.CancelledError):
                    raise self.gone() from None
                except KilledWorker:
                    lost = 1
                    if self.scheduler:
                        self.submit(work, key, waiting[key], ended)
            lost = max(lost, self.lost_workers(tell))
            losses += lost
            for _ in range(lost):
                tell(LOST)
            if losses > MAX_LOSSES:
                raise Stop(f"{what}: a worker was lost {losses} times without a job finished between", NO_ANSWER)
            if lost and not self.scheduler:
                self.__exit__()
                self.__enter__()
                ended = self.submitted(work, waiting, tell)

    def submitted(self, work, jobs, tell):
        """Submits jobs, a dict by key, the last ones first. Returns a queue that gets (key, future) as each ends."""
        self.lost_workers(tell)  # none yet; but which there are
        ended = queue.SimpleQueue()
        self.futures = {}  # Dask cancels what nobody keeps
        for key, job in reversed(jobs.items()):
            self.submit(work, key, job, ended)
        return ended

    def submit(self, work, key, job, ended):
        call = pickle.dumps(Call(work, job))
        future = self.client.submit(pickle.loads, call, pure=False, priority=-len(self.futures))
        self.futures[key] = future
        future.add_done_callback(lambda future: ended.put((key, future)))

    def lost_workers(self, tell):
        """Returns how many workers have gone since the last look, 0 where that is no LOOK_SECONDS ago.

        `tell` gets a line where none is left. Throws Stop if the scheduler has gone.
        """
        if time.monotonic() - self.looked_at < LOOK_SECONDS:
            return 0
        try:
            before, self.workers = self.workers, set(self.client.nthreads())
        except (OSError, asyncio.TimeoutError):
            raise self.gone() from None
        self.looked_at = time.monotonic()
        if self.scheduler and not self.workers and before != self.workers:
            tell(NO_WORKERS)
        return len((before or set()) - self.workers)

    def gone(self):
        return Stop(f"--scheduler {one_line(self.scheduler)}: is gone; the same command goes on from here")


class Call:
    """work(job) as a pickle: who loads it makes the call and gets its result.

    Schedulers of newer releases load what they pass on, and know neither the study nor the module isosyrk: so they get
    bytes.
    """

    def __init__(self, work, job):
        self.work, self.job = work, job

    def __reduce__(self):
        return self.work, (self.job,)


@contextlib.contextmanager
def processes(count):
    """Yields the address of a scheduler in this process, with so many workers, each a process with one thread.

    They end with this process, however it ends, since each waits for the end of a pipe; one that is lost is not
    replaced.
    """
    import dask
    import distributed
    start_fork_server()
    local = None
    with tempfile.TemporaryDirectory(prefix="isosyrk-") as folder:
        try:
            with held(signal.SIGINT, signal.SIGTERM), dask.config.set(SETTINGS):  # a cluster half begun cannot be ended
                local = distributed.LocalCluster(
                    n_workers=count, threads_per_worker=1, memory_limit=0, local_directory=folder,
                    silence_logs=logging.CRITICAL, dashboard_address="127.0.0.1:0",
                    scheduler_kwargs={"dashboard": False})
                for nanny in local.workers.values():
                    nanny.close_gracefully()  # when its worker has ended
            yield local.scheduler_address
        finally:  # at once, whatever they do
            for child in multiprocessing.active_children():
                child.kill()
            if local:
                local.close()


def start_fork_server():
    """Starts the process that workers are forked from. Ctrl-C, which is for this process, reaches neither."""
    resource_tracker.ensure_running()  # before, since it lets signals through
    multiprocessing.get_context("forkserver").set_forkserver_preload(["distributed"])
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # which a new process inherits
    try:
        forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def held(*signals):
    """Acts on signals that come meanwhile at the end."""
    came = []
    before = {each: signal.signal(each, lambda number, _: came.append(number)) for each in signals}
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
        for each in came:
            signal.raise_signal(each)
