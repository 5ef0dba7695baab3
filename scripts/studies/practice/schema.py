"""The raw file of the study `practice`: what people run, and what reaches its error, or a tenth of it, for less.

The *practice* is the isospectral midpoint with h = ħ/4. A *method* has two rows on each problem: with the fewest steps
that reach the error of the practice, and those that reach a tenth of it.
"""

import math
import statistics
from typing import NamedTuple

from lib.programs.messages import UnusableFile
from lib.records import formats
from lib.records.formats import (INTEGRATORS, Integrator, Schema, keyed, list_of, number, one_of, optional, positive,
                                 text, truth, whole)

SMOOTH, ROUGH, TURBULENCE = SCENES = ("smooth", "rough", "turbulence")
PRACTICE, QUFLOW, METHOD = ROLES = ("practice", "quflow", "method")
BASELINE_INTEGRATOR, BASELINE_SHARE, BASELINE_TOLERANCE = "algebra1", 0.25, 1e-8  # h over ħ
AT_PRACTICE, AT_TENTH = WANTED = ("same", "tenth")  # the errors that methods are brought to: the practice's, and
TENTH = 0.1  # this share of it


class Settings(NamedTuple):
    quick: truth
    quflow: optional(text)  # commit of the checkout whose step was run; None where there was none
    cores: whole(1)  # that the study had: with one alone nothing is timed by threads
    lowest_degree: whole(1)  # l of the modes that turbulence is drawn with
    highest_degree: whole(1)
    sample: whole()  # number of what is drawn
    tail_from: positive  # the tail of E(l) begins at this share of the largest l; it is filled once it has
    tail_share: positive  # this share of the enstrophy
    largest_whole: whole(2)  # n up to which whole runs are timed
    places: whole(1)  # beyond it some steps are timed at so many places of a run
    largest_whole_quflow: optional(whole(2)) = None  # as largest_whole, of quflow's step; older files: the same


class Problem(NamedTuple):
    """A scene at an n, and the solution that errors are measured against."""

    scene: one_of(*SCENES)
    n: whole(2)
    time: positive  # T
    in_frame: truth  # whether methods run in the co-rotating frame, where that makes the generator smaller
    norm_ad_B: positive  # ‖ad_B‖₂ at the start, in that frame
    developed: number  # time before the start, in which turbulence filled the tail of E(l); 0 for a named scene
    tail: number  # share of the enstrophy in the tail at the start
    initial: text  # hash of W(0)
    reference: text  # hash of the solution
    references: list_of(text, 2)  # integrators of two kinds that found it; errors are measured against the first
    reference_steps: list_of(whole(1), 2)
    reference_errors: list_of(number, 2)  # relative, of each as its last two numbers of steps tell it
    difference: number  # relative, of the two

    @property
    def key(self):
        return self.scene, self.n


class Row(NamedTuple):
    """A run of the practice, of quflow's own step, or of a method at a wanted error. None where none reaches it."""

    scene: one_of(*SCENES)
    n: whole(2)
    role: one_of(*ROLES)
    wanted: one_of(*WANTED)  # the practice and quflow: their own error
    integrator: text
    tolerance: positive  # of quflow's step: that of its last change, relative to ‖W₀‖∞, as it chose it
    steps: optional(whole(1))
    error: optional(number)  # ‖W(T) − reference‖_F / ‖reference‖_F
    energy_error: optional(number)  # relative, the largest that was seen
    spectrum_error: optional(number)
    sweeps: optional(whole())
    products: optional(positive)  # equivalent ones; of quflow's step, those that it forms
    capped: optional(whole())  # steps that ended at the largest number of iterations
    cpu_seconds: list_of(positive)  # of the whole run, by process

    @property
    def form(self):
        return self.role, self.integrator, self.tolerance

    @property
    def seconds(self):
        """The geometric mean over the processes."""
        return statistics.geometric_mean(self.cpu_seconds)


class ThreadRow(NamedTuple):
    """Seconds that pass for a run of a method at a tenth of the practice's error, by a number of threads."""

    scene: one_of(*SCENES)
    n: whole(2)
    integrator: text
    tolerance: positive
    steps: whole(1)
    threads: whole(1)
    seconds: list_of(positive)  # by process


SCHEMA = Schema("practice", Settings, {INTEGRATORS: Integrator, "problems": Problem, "runs": Row, "threads": ThreadRow})


class Practice:
    """A raw file, with its problems and rows by (scene, n)."""

    def __init__(self, study):
        """Throws UnusableFile for rows that cannot be compared with the practice, process by process."""
        self.context, self.settings = study.context, study.settings
        self.integrators = keyed(study.tables[INTEGRATORS], "name")
        self.problems = {each.key: each for each in study.tables["problems"]}
        self.rows = {key: [row for row in study.tables["runs"] if (row.scene, row.n) == key] for key in self.problems}
        self.threads = study.tables["threads"]
        if not self.problems:
            raise UnusableFile("has no problems")
        if len(self.problems) < len(study.tables["problems"]):
            raise UnusableFile("has a problem twice")
        for row in (*study.tables["runs"], *self.threads):
            if row.integrator not in self.integrators:
                raise UnusableFile(f"has runs of {row.integrator} without its integrator")
            if (row.scene, row.n) not in self.problems:
                raise UnusableFile(f"has runs of the {row.scene} scene at n = {row.n} without the problem")
        for key in self.problems:
            require_comparable(self.rows[key], "{} scene at n = {}".format(*key))
        for (*where, form), found in self.thread_blocks().items():
            if 1 not in found or len({len(row.seconds) for row in found.values()}) > 1 or not found[1].seconds:
                raise UnusableFile("has threads of the {} scene at n = {} that are not of the same processes as one"
                                   " thread".format(*where))

    def practice(self, key):
        """Returns the row of the practice on a problem."""
        return next(row for row in self.rows[key] if row.role == PRACTICE)

    def quflow(self, key):
        """Returns the row of quflow's own step on a problem, or None."""
        return next((row for row in self.rows[key] if row.role == QUFLOW), None)

    def methods(self, key, wanted):
        """Returns the rows of methods on a problem at a wanted error."""
        return [row for row in self.rows[key] if row.role == METHOD and row.wanted == wanted]

    def thread_blocks(self):
        """Returns dicts of rows by number of threads, by (scene, n, (integrator, tolerance))."""
        blocks = {}
        for row in self.threads:
            form = row.integrator, row.tolerance
            blocks.setdefault((row.scene, row.n, form), {})[row.threads] = row
        return blocks


MEASURED = ("error", "energy_error", "spectrum_error", "sweeps", "products", "capped")  # by a run that has steps


def require_comparable(rows, where):
    """Throws UnusableFile unless some rows are of one problem, timed by the same processes."""
    if [row.role for row in rows].count(PRACTICE) != 1:
        raise UnusableFile(f"has not one run of the practice, {where}")
    if len({(row.form, row.wanted) for row in rows}) < len(rows):
        raise UnusableFile(f"has a run twice, {where}")
    for row in rows:
        if any((getattr(row, name) is None) != (row.steps is None) for name in MEASURED):
            raise UnusableFile(f"has a run of {row.integrator} with steps and without errors, or the reverse, {where}")
        if row.role != METHOD and row.steps is None:
            raise UnusableFile(f"has not one run of the practice, {where}")
    counts = {len(row.cpu_seconds) for row in rows if row.steps is not None}
    if len(counts) > 1 or 0 in counts or any(row.cpu_seconds for row in rows if row.steps is None):
        raise UnusableFile(f"has runs that are not timed by the same processes, {where}")


def read_practice(path):
    """Returns the Practice in a raw file. Throws UnusableFile with one line that names the file."""
    return formats.read_study(path, SCHEMA, Practice)


def finite_or_none(value):
    return value if math.isfinite(value) else None
