"""Draws the study of long runs: errors against cost, a line a method, and energy errors of long runs against time."""

from matplotlib.ticker import LogLocator

from lib.records.settings import keeping_tolerance
from lib.pages.chart_panels import KEEPING, cross, draw_line, equals, label_ends, logarithmic, look, new_figure, note
from lib.judging.drift import BOUNDED, GROWS, MIN_GROWTH
from lib.records.integrators import is_new, name_with_order
from studies.longruns.schema import COSTS, ENERGY, SCENES, SPECTRUM
from studies.longruns.judge import places_of
from lib.pages.numbers import power, scientific

SIZES = (33, 129)  # of the panels against cost, where there are such
MIN_ERROR = 1e-16  # where an exact 0 is drawn
# The methods that are drawn, by name; new ones are too. The others are in tables.
AGAINST_COST = ("group2", "elp4_tight", "elp6", "magnus5", "rk8_projected", "rk4", "rk8")
AGAINST_TIME = ("group2", "elp4_tight", "elp6_tight", "elp6", "magnus5", "rk8_projected", "rk8")
KEPT_BELOW = 1e-11  # spectrum errors whose lines have one label


def drawn(runs, found, names):
    """Returns those of some lines or runs, by method, that are named or of new integrators."""
    return {method: each for method, each in found.items()
            if method in names or is_new(runs.integrator_of(first_of(each)))}


def first_of(each):
    """Returns the first run of a line, or a run itself."""
    return each[0] if isinstance(each, list) else each


def label_of(runs, run):
    """Returns the name of a method, with its tolerance where that is loose or may be."""
    integrator = runs.integrator_of(run)
    tight, usual = (keeping_tolerance(integrator, each) for each in ("poisson", "spectrum"))
    several = run.tolerance > usual or (integrator.lie_poisson and tight < usual)
    name = name_with_order(integrator)
    return f"{name}, {power(run.tolerance)}" if several else name


def look_of(runs, run):
    """Returns how the line of a run's method is drawn."""
    return look(runs.integrator_of(run), run.tolerance)


# ---- errors against cost


def energy_against_cost(runs):
    """Draws the largest energy errors of runs against products a unit of time."""
    return against_cost(runs, ENERGY, f"Energy error against cost: keeping the structure is cheaper than any explicit"
                        f" method {where_it_pays(runs, ENERGY)}", "largest relative energy error")


def spectrum_against_cost(runs):
    """Draws the spectrum errors at the end of runs against products a unit of time."""
    return against_cost(runs, SPECTRUM, "Eigenvalues at the end: keeping the structure is cheaper than any explicit"
                        f" method without projection {where_it_pays(runs, SPECTRUM)}", "largest error of an eigenvalue")


def where_it_pays(runs, quantity):
    places = places_of(runs, quantity)
    return f"in {sum(place.pays for place in places)} of {len(places)} places (error, n, scene)"


def against_cost(runs, quantity, title, label):
    """Draws errors of a quantity against cost, a row of panels a scene and a column an n."""
    sizes = [n for n in SIZES if n in runs.plans] or list(runs.plans)[:1]
    scenes = [scene for scene in SCENES if (sizes[0], scene) in runs.settings()]
    names = {label_of(runs, line[0]) for line in drawn(runs, {key[-1]: line for key, line in runs.lines.items()},
                                                       AGAINST_COST).values()}
    figure, panels = new_figure(title, len(scenes), len(sizes), 5.4, keys=2, labels=names, sharex=True, sharey=True)
    for row, scene in zip(panels, scenes):
        for axes, n in zip(row, sizes):
            logarithmic(axes)
            axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5), numticks=12))
            axes.xaxis.set_major_formatter("{x:g}")
            axes.set(title=f"{scene} scene, n = {n}, T = {runs.plans[n].time:g}",
                     xlabel="full products a unit of time")
            axes.ends, kept = [], None
            for method, line in drawn(runs, runs.lines_at(scene, n), AGAINST_COST).items():
                points = [(point.equivalent_products, max(point.error(quantity), MIN_ERROR))
                          for point in line if point.usable]
                style = look_of(runs, line[0])
                if not draw_line(axes, method, points, **style):
                    continue
                if quantity == ENERGY or max(error for _, error in points) > KEPT_BELOW:
                    axes.ends.append((points[-1], label_of(runs, line[0]), style["color"]))
                else:
                    kept = points[-1]
            axes.ends += [(kept, "all others", "0.3")] if kept else []
        row[0].set_ylabel(label)
    for axes in filter(lambda axes: axes.ends, panels.flat):
        label_ends(axes, axes.ends, in_one_column=True)
    others = f" All others: below {KEPT_BELOW:g}." if quantity == SPECTRUM else ""
    note(figure, "In the co-rotating frame, fast forms, from the initial data of a scene. Tolerance 1e-13, of magnus5"
         f" 1e-8, unless said; lighter where a method keeps less at its tolerance. {KEEPING}{others}")
    return figure


# ---- energy against time


def energy_against_time(runs):
    """Draws the largest energy error of each window of the long runs at the larger cost. None without one."""
    cost = COSTS[-1]
    found = {scene: chosen for scene in SCENES if (chosen := drawn(runs, runs.long_at(scene, cost), AGAINST_TIME))}
    if not found:
        return None
    labels = {(scene, method): f"{label_of(runs, run)} ({drift_of(run)})" for scene, each in found.items()
              for method, run in each.items()}
    first = next(iter(next(iter(found.values())).values()))
    figure, (panels,) = new_figure(time_title(runs, found), 1, len(found), 5.4, keys=2, labels=labels.values(),
                                   sharex=True, sharey=True)
    for axes, (scene, each) in zip(panels, found.items()):
        logarithmic(axes)
        axes.set(title=f"{scene} scene", xlabel="time")
        axes.ends = []
        for method, run in each.items():
            style = {**look_of(runs, run), "marker": ""}
            points = draw_line(axes, method, run.series(ENERGY), **style)
            if not points:
                continue
            if not run.finished:
                cross(axes, points[-1])
            axes.ends.append((points[-1], labels[scene, method], style["color"]))
    panels[0].set_ylabel("relative energy error, largest in a window")
    for axes in filter(lambda axes: axes.ends, panels):
        label_ends(axes, axes.ends)
    note(figure, f"{cost} full products a unit of time, {first.windows} windows. In brackets: the power of time by"
         " which the error grows, or how it is judged. Cross: the run failed. Lighter where a method keeps less at its"
         f" tolerance. {KEEPING}")
    return figure


def time_title(runs, found):
    """Returns the least energy errors at the end of the runs drawn, in dicts by method: of all, and of bounded ones."""
    first = next(iter(next(iter(found.values())).values()))
    ended = {scene: [run for run in each.values() if run.finished] for scene, each in found.items()}
    bounded = {scene: [run for run in each if run.judged(ENERGY).verdict == BOUNDED] for scene, each in ended.items()}
    told = [f"{words} {', '.join(min_text(runs, scene, each) for scene, each in some.items() if each)}"
            for words, some in (("the least energy error is", ended), ("the least bounded one", bounded))
            if any(some.values())]
    return f"At equal cost ({equals('n', first.n)}, {equals('T', format(first.time, 'g'))}) {'; '.join(told)}"


def min_text(runs, scene, some):
    """Writes the least energy error at the end of some runs in a scene."""
    minimum = min(some, key=lambda run: run.last(ENERGY))
    return f"{scientific(minimum.last(ENERGY))} in the {scene} scene ({label_of(runs, minimum)})"


def drift_of(run):
    """Writes the power of time by which an energy error grows if it has one; otherwise the verdict."""
    verdict, growth, *_ = run.judged(ENERGY)
    return f"t^{growth.value:.1f}" if verdict == GROWS and growth and growth.low > MIN_GROWTH else verdict
