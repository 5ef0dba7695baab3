"""What the study `scaling` times: integrators, ablations and starts at each n."""

from lib.records.formats import FAST, PUBLISHED
from lib.records.integrators import TABLE1_CELLS, chosen
from lib.running import built
from studies.scaling.schema import ANY, BANDS, BASIC, PARTS, lines_of, ablations_of, without
from studies.threads.plan import FEW, ONCE, ONCE_START, affordable, shrunk, step_of

SCENES, STARTS = ("smooth", "rough"), (5.0, 50.0)  # the first scene by default
WARMUP = 1.5  # time before the timed steps; predictors save more up to some 16 steps of a Gauss method
SIZES, QUICK_SIZES = (9, 17, 33, 65, 129, 257, 513, 1025), (9, 17, 33)
QUICK_METHODS = ("cotangent2", "group2", "algebra2", "elp4", "magnus5", "rkmk4", "rk4")  # new ones, and lines, besides
# What is affordable. Every integrator up to n = 129, but those whose parts are not told apart as fast forms only beyond
# 65; beyond 129 the lines against n; from LARGE on no published forms, and bands apart only of FEW; they alone at ONCE.
LARGEST_OF_ALL, LARGEST_OF_OTHERS = 129, 65
STEPS, STEPS_LARGE, LARGE = 8, 2, 513  # that are timed; fewer from LARGE on
REPETITIONS, QUICK_REPETITIONS = 6, 3


def points_of(entries, sizes, products, scene=SCENES[0], starts=STARTS):
    """Returns the points as objects of JSON. `products(n)` names the backend of published forms."""
    return [{"scene": scene, "start": start, "n": n, "integrator": entry.name, "ablation": ablation,
             **step_of(entry, n), "steps": STEPS if n < LARGE else STEPS_LARGE, "products": products(n)}
            for n in sizes for start in starts for entry in entries for ablation in ablations_at(entry, n, start)]


def ablations_at(entry, n, start):
    """Returns the ablations of an integrator that are timed at an n."""
    name, has_line = entry.name, entry.name in lines()
    if n == ONCE:
        ablations = (FAST,) if name in FEW and start == ONCE_START else ()
    elif n >= LARGE:
        ablations = () if not has_line else (BANDS, FAST) if name in FEW else (FAST,)
    elif n > LARGEST_OF_ALL:
        ablations = BASIC if has_line else ()
    elif n > LARGEST_OF_OTHERS and not (name in TABLE1_CELLS or has_line or entry.family in PARTS):
        ablations = (FAST,)
    else:
        ablations = ablations_of(entry)
    return ablations if entry.has_fast_form else tuple(ablation for ablation in ablations if ablation == PUBLISHED)


def lines():
    """Returns the names of the integrators with a line against n."""
    return lines_of(built.integrators().values())


def has_memory(point):
    """Tells whether the past steps of a run make the next one cheaper, so that it has to be warm."""
    entry, ablation = built.integrators()[point["integrator"]], point["ablation"]
    without_memory = entry.explicit or {"predictor", "newton"} <= {*without(entry, ablation)}
    return ablation not in (PUBLISHED, ANY) and not without_memory


def warm_steps(point):
    """Returns the steps of a point before those that are timed."""
    return round(shrunk(point["n"], WARMUP) / point["step"]) if has_memory(point) else 0


def begin_of(point):
    """Returns the time of the state from which a point begins."""
    return point["start"] - (shrunk(point["n"], WARMUP) if has_memory(point) else 0.0)


def sizes_asked_for(options):
    """Returns the n of the study, the smallest first."""
    sizes = options.n or (QUICK_SIZES if options.quick else SIZES)
    return affordable(n for n in sizes if n <= LARGEST_OF_ALL or not options.no_large)


def entries_asked_for(options):
    """Returns the module's records of those integrators, by default of all and of the lines."""
    if options.integrator:
        return built.entries(options.integrator)
    methods = chosen(built.integrators().values(), QUICK_METHODS).values() if options.quick else built.entries(None)
    return built.entries([*(each.name for each in methods), *lines()])
