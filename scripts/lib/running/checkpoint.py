"""What a study has done so far, in a file beside its raw file: an interrupted study goes on from there."""

import contextlib
import glob
import hashlib
import json
import os
import re

from lib.programs.command_line import Stop, say
from lib.programs.messages import one_line
from lib.programs.output import replace_file
from lib.programs.places import ROOT

FORMAT = "isosyrk checkpoint 1"
RESULTS_DEPEND_ON = ("commit", "dirty")  # conditions, of all work
TIMES_DEPEND_ON = ("cpu", "blas_kernels", "split_kernels")  # and of timed work
NOT_OF_THE_STUDY = ("out", "scheduler", "workers", "repetitions", "processes")  # options that leave results as they are


class Checkpoint:
    """Finished work of an unfinished study, as JSON lines: what it belongs to, then a key and a result each.

    One that belongs to anything else, as another commit or another text of the studies, is begun anew, and that is
    told. On another processor untimed work is kept and timed work is done again. `context` holds the conditions of the
    first start on this processor. `processes` and `disturbed` count those that timed, over all timed parts of the
    study.
    """

    def __init__(self, study, options, conditions):
        """`conditions()` returns the context of a raw file, as isosyrk.conditions does; it is called now.

        Throws Stop if --out cannot be written.
        """
        require_writable(options.out)
        self.path = f"{options.out}.checkpoint"
        now = conditions()
        arguments = {name: value for name, value in vars(options).items() if name not in NOT_OF_THE_STUDY}
        head = {"format": FORMAT, "study": study, "arguments": arguments,
                "conditions": {name: now.get(name) for name in RESULTS_DEPEND_ON}, "scripts": text_of_studies()}
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
        """Removes the file, when the raw file has been written."""
        os.unlink(self.path)

    def products(self, n):
        """Returns the product backend that was the faster as the study began, at n or the nearest n that was tried."""
        chosen = {int(tried): backend for tried, backend in re.findall(r"n=(\d+) (\w+)", self.context["products"])}
        return chosen[min(chosen, key=lambda tried: abs(tried - n))]

    def key_of_timed(self, what, job):
        """Returns the key of a result that only this processor can give."""
        return key_of(f"{what} on {', '.join(str(self.context.get(name)) for name in TIMES_DEPEND_ON)}", job)


def text_of_studies():
    """Returns a hash of the modules that studies are made of. The commit does not tell them: it is the build's."""
    found = hashlib.sha256()
    for folder in ("lib", "studies"):
        for path in sorted(glob.glob(os.path.join(ROOT, "scripts", folder, "**", "*.py"), recursive=True)):
            with open(path, "rb") as file:
                found.update(file.read())
    return found.hexdigest()


def key_of(what, job):
    """Returns the key of the result of a job, which is what JSON can hold."""
    return json.dumps([what, job], sort_keys=True)


def require_writable(path):
    """Throws Stop unless a file can be written at a path."""
    folder = os.path.dirname(os.path.abspath(path))
    for holds, why in ((os.path.isdir(path), "is a folder"), (not os.path.isdir(folder), "its folder does not exist"),
                       (not os.access(folder, os.W_OK), "its folder is not writable")):
        if holds:
            raise Stop(f"--out {one_line(path)}: cannot be written, {why}")
