"""Times a step of every integrator against n, published and fast, and without each part of the fast form in turn.

The timed steps start at t = 5 and t = 50 of the smooth scene unless others are asked for, from states that the study
computes first. A repetition repeats the same steps from the same state. Before them a fast form with a memory runs
there by itself, for its predictor saves more with every past step. What threads gain is timed by threads.py.
"""

import contextlib
import math
import resource
from functools import lru_cache, partial

import isosyrk

from lib.programs.command_line import NO_ANSWER, Stop, whole_number
from lib.records import formats
from lib.records.formats import FAST, INTEGRATORS, PUBLISHED
from lib.running import built, program, timed, untimed
from lib.running.checkpoint import Checkpoint
from lib.running.problems import decoded, encoded
from studies.scaling.plan import (LARGEST_OF_ALL, QUICK_REPETITIONS, REPETITIONS, SCENES, SIZES, STARTS, WARMUP,
                                  begin_of, entries_asked_for, points_of, sizes_asked_for, warm_steps)
from studies.scaling.schema import SCHEMA, Memory, Point, Rate, Settings, without
from studies.threads.plan import shrunk


ENOUGH = 1.2  # CPU seconds of timed steps of a point, after which it is repeated no more

# States: an exponential method of order 6 at steps that are far more accurate than a state for timing must be.
STATES_BY, STATES_STEP, STATES_TOLERANCE = "elp6_frame", 0.25, 1e-10
MAX_HALVINGS = 3  # of that step, where it fails


# ---- what is timed


@lru_cache(maxsize=1)
def scene_of(scene, n):
    return isosyrk.scene(scene, n=n)


def made(point):
    """Returns the integrator of a point as new, so that no repetition knows of the one before."""
    if point["ablation"] == PUBLISHED:
        options = {"solver": PUBLISHED, "products": point["products"]}
    else:
        options = {"solver": FAST, "without": without(built.integrators()[point["integrator"]], point["ablation"])}
    return isosyrk.integrator(scene_of(point["scene"], point["n"]), point["integrator"], tolerance=point["tolerance"],
                              **options)


# ---- untimed: the states, and counts from them


def states_of(scene, n, times):
    """Returns the states of a scene at times, by time. Throws Stop where no step leads there."""
    found, W, now = {}, scene_of(scene, n).initial, 0.0
    for each in sorted(times):
        W = state_after(scene, n, W, each - now)
        found[each], now = W, each
    return found


def state_after(scene, n, W, length):
    """Returns the state a time after W, with half the step as often as one fails."""
    integrator = isosyrk.integrator(scene_of(scene, n), STATES_BY, solver=FAST, tolerance=STATES_TOLERANCE)
    steps = math.ceil(length / shrunk(n, STATES_STEP) - 1e-9)
    for halvings in range(MAX_HALVINGS + 1):
        with contextlib.suppress(isosyrk.SolverError):
            return integrator.run(W, length / steps / 2**halvings, steps * 2**halvings)[0]
    raise Stop(f"states at n = {n}: {STATES_BY} fails with h = {length / steps / 2**MAX_HALVINGS:.3g} too", NO_ANSWER)


def count(point, W):
    """Returns the counts of a point over its timed steps, each for a step; None where a step fails."""
    warm, steps, seen = warm_steps(point), point["steps"], {0: (0, 0.0)}

    def look(step, _, report):
        seen[step] = report.sweeps, report.equivalent_products

    try:
        made(point).run(W, point["step"], warm + steps, look)
    except isosyrk.SolverError:
        return None
    sweeps, products = (last - first for first, last in zip(seen[warm], seen[warm + steps]))
    return {"sweeps": sweeps / steps, "equivalent_products": products / steps}


def prepare(job):
    """Returns the states of one scene and n as texts by time, and the counts of its points.

    The states are rounded to what a text keeps of them, so that counts and times begin alike.
    """
    times = set(map(begin_of, job["points"]))
    states = {f"{at:g}": encoded(W) for at, W in states_of(job["scene"], job["n"], times).items()}
    matrices = {at: decoded(text, job["n"]) for at, text in states.items()}
    return {"states": states, "counts": [count(point, matrices[f"{begin_of(point):g}"]) for point in job["points"]]}


# ---- timed, interleaved


class Timer:
    """Times points from prepared states, and keeps in the checkpoint how much memory the process has taken."""

    def __init__(self, texts, checkpoint):
        """`texts` are the states by n and time."""
        self.texts, self.checkpoint, self.largest = texts, checkpoint, 0
        self.state = lru_cache(maxsize=8)(lambda n, at: decoded(texts[n][at], n))

    def __call__(self, point):
        """Returns the CPU seconds of the timed steps of a point, or of a product if it is one."""
        if "solver" in point:
            return 1 / isosyrk.product_rate(point["n"], point["solver"])
        W, integrator = self.state(point["n"], f"{begin_of(point):g}"), made(point)
        warm = warm_steps(point)
        if not warm:
            integrator.step(W, point["step"])  # so that its workspace is in place
        seconds = timed.seconds_of(integrator, W, point["step"], point["steps"], warm)
        self.look_at_memory(point["n"])
        return seconds

    def look_at_memory(self, n):
        """Keeps the most memory that this process has taken, unless a larger n was timed before."""
        self.largest = max(self.largest, n)
        if n == self.largest > LARGEST_OF_ALL:
            taken = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            self.checkpoint.add(self.memory_key(n), max(taken, self.memory(n) or 0))

    def memory_key(self, n):
        return self.checkpoint.key_of_timed("memory", n)

    def memory(self, n):
        """Returns the bytes that the process had taken when it had timed n and nothing larger; None if not known."""
        return self.checkpoint.found.get(self.memory_key(n))


# ---- the study


def main(arguments):
    parser = program.parser("scaling", __doc__.splitlines()[0], largest_n=SIZES[-1])
    parser.add_argument("--repetitions", type=whole_number(1, 1000),
                        help=f"(default: {REPETITIONS}, quick {QUICK_REPETITIONS})")
    parser.add_argument("--scene", choices=SCENES, default=SCENES[0])
    parser.add_argument("--start", type=float, choices=STARTS, nargs="+", default=STARTS, metavar="T",
                        help=f"times from which steps are timed, of {', '.join(f'{start:g}' for start in STARTS)}"
                        " (default: all)")
    parser.add_argument("--no-large", action="store_true", help=f"no n above {LARGEST_OF_ALL}")
    options = parser.parse_args(arguments)
    repetitions = options.repetitions or (QUICK_REPETITIONS if options.quick else REPETITIONS)
    sizes, entries = sizes_asked_for(options), entries_asked_for(options)

    checkpoint = Checkpoint("scaling", options, partial(isosyrk.conditions, products="fastest",
                                                      sizes=sorted({min(n, 257) for n in sizes})))
    points = points_of(entries, sizes, checkpoint.products, options.scene, sorted(set(options.start)))
    jobs = [{"scene": options.scene, "n": n, "points": found} for n in sizes
            if (found := [each for each in points if each["n"] == n])]
    prepared = untimed.results(jobs, prepare, checkpoint, options, "states and counts")
    texts = {job["n"]: each["states"] for job, each in zip(jobs, prepared)}
    counts = [found for each in prepared for found in each["counts"]]

    timer = Timer(texts, checkpoint)
    working = [point for point, found in zip(points, counts) if found]
    products = [{"n": job["n"], "solver": solver} for job in jobs for solver in (FAST, PUBLISHED)]
    times = timed.interleaved([*products, *working], repetitions, timer, checkpoint, "timing", ENOUGH)
    rates, seconds = times[:len(products)], iter(times[len(products):])
    tables = {INTEGRATORS: entries,
              "points": [record(point, found, next(seconds) if found else []) for point, found in zip(points, counts)],
              "rates": [Rate(each["n"], each["solver"], rounded(found)) for each, found in zip(products, rates)],
              "memory": [Memory(n, taken) for n in sizes if (taken := timer.memory(n))]}
    formats.write_study(options.out, SCHEMA, checkpoint.context, Settings(options.scene, WARMUP), tables)
    checkpoint.remove()


def record(point, found, seconds):
    """Returns a point as a row of its table; `seconds` are those of all its steps, by repetition."""
    costs = found or dict.fromkeys(("sweeps", "equivalent_products"))
    values = {**point, **costs, "seconds": rounded(each / point["steps"] for each in seconds)}
    return Point(*(values[name] for name in Point._fields))


def rounded(seconds):
    """Returns times with five digits, far more than they are worth."""
    return [formats.to_digits(each, 5) for each in seconds]
