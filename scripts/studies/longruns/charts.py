"""Draws the study of long runs: errors against cost, a line a method, and energy errors of long runs against time."""

from matplotlib.ticker import LogLocator

from lib.records.integrators import RKMK
from lib.records.settings import keeping_tolerance
from lib.judging.drift import BOUNDED, GROWS, KEPT, LEAST_GROWTH
from lib.pages.chart_panels import (BLACK, EXPONENTIAL_RED, FAMILY_COLOURS, GROUP, LINES, cross, draw_line, equals,
                                    label_ends, logarithmic, look, mixed, new_figure, note)
from lib.pages.numbers import power
from studies.longruns.judge import places_of
from studies.longruns.schema import (COSTS, ENERGY, EXPLICIT, EXPLICIT_LIE, EXPONENTIAL, EXPONENTIAL_LOOSE, GAUSS,
                                     GAUSS_LOOSE, PROJECTED, SCENES, SPECTRUM)

SIZES = (33, 129)  # of the panels against cost, where there are such
LEAST_ERROR = 1e-16  # where an exact 0 is drawn
COLOURS = {EXPLICIT: BLACK, PROJECTED: "#8a3b12", EXPLICIT_LIE: FAMILY_COLOURS[RKMK][0],
           EXPONENTIAL: mixed(EXPONENTIAL_RED, "black", 0.25),
           EXPONENTIAL_LOOSE: mixed(EXPONENTIAL_RED, "white", 0.35), GAUSS: GROUP,
           GAUSS_LOOSE: mixed(GROUP, "white", 0.45)}
MARKERS = {"o": "○", "s": "□", "D": "◇", "^": "△", "v": "▽"}  # of the methods of a class, in their order, as in labels
KEPT_BELOW = 1e-11  # spectrum errors whose lines have one label
KINDS = ("Black: explicit; brown: projected; green: explicit and isospectral; red: exponential Lie–Poisson, lighter at"
         " 1e-8; blue: Gauss, lighter at 1e-7. Solid: keeps the Lie–Poisson structure; dashed: the spectrum only;"
         " dotted: neither.")


def label_of(runs, run):
    """Returns the name of a method, with its tolerance where that is loose or may be."""
    integrator = runs.integrator_of(run)
    tight, usual = (keeping_tolerance(integrator, each) for each in ("poisson", "spectrum"))
    several = run.tolerance > usual or (integrator.lie_poisson and tight < usual)
    return f"{integrator.method}, {power(run.tolerance)}" if several else integrator.method


def styles(runs, drawn):
    """Returns how the line of each method is drawn, given a run of each: a colour a class, a marker a method."""
    found, seen = {}, {}
    for method, run in drawn.items():
        kind, integrator = runs.class_of(run), runs.integrator_of(run)
        number = seen[kind] = seen.get(kind, -1) + 1
        found[method] = {"color": COLOURS.get(kind) or look(integrator)["color"],
                         "marker": list(MARKERS)[number % len(MARKERS)],
                         "markerfacecolor": "none",
                         "linestyle": next(LINES[each] for each in LINES if integrator.keeps(each))}
    return found


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
    looks = styles(runs, {method: line[0] for (_, _, method), line in runs.lines.items()})
    names = {method: f"{MARKERS[looks[method]['marker']]} {label_of(runs, line[0])}"
             for (_, _, method), line in runs.lines.items()}
    figure, panels = new_figure(title, len(scenes), len(sizes), 5.4, keys=2, labels=names.values(), sharex=True,
                                sharey=True)
    for row, scene in zip(panels, scenes):
        for axes, n in zip(row, sizes):
            logarithmic(axes)
            axes.xaxis.set_major_locator(LogLocator(numticks=6))
            axes.set(title=f"{scene} scene, n = {n}, T = {runs.plans[n].time:g}",
                     xlabel="full products a unit of time")
            ends, kept = [], None
            for method, line in runs.lines_at(scene, n).items():
                points = [(point.equivalent_products, max(point.error(quantity), LEAST_ERROR))
                          for point in line if point.usable]
                if not draw_line(axes, method, points, **looks[method]):
                    continue
                if quantity == ENERGY or max(error for _, error in points) > KEPT_BELOW:
                    ends.append((points[-1], names[method], looks[method]["color"]))
                else:
                    kept = points[-1]
            axes.ends = ends + ([(kept, "all others", "0.3")] if kept else [])
        row[0].set_ylabel(label)
    right = max((x for axes in panels.flat for (x, _), _, _ in axes.ends), default=1.0)
    for axes in filter(lambda axes: axes.ends, panels.flat):
        label_ends(axes, [((right, y), *label) for (_, y), *label in axes.ends])
    others = f" All others: below {KEPT_BELOW:g}." if quantity == SPECTRUM else ""
    note(figure, f"In the co-rotating frame, fast forms, from the initial data of a scene. {KINDS}{others}")
    return figure


# ---- energy against time


def energy_against_time(runs):
    """Draws the largest energy error of each window of the long runs at the larger cost. None without one."""
    cost = COSTS[-1]
    found = {scene: drawn for scene in SCENES if (drawn := runs.long_at(scene, cost))}
    if not found:
        return None
    labels = {(scene, method): f"{label_of(runs, run)} ({drift_of(run)})" for scene, drawn in found.items()
              for method, run in drawn.items()}
    looks = styles(runs, {method: run for drawn in found.values() for method, run in drawn.items()})
    first = next(iter(next(iter(found.values())).values()))
    figure, (panels,) = new_figure(time_title(found), 1, len(found), 5.4, keys=2, labels=labels.values(),
                                   sharex=True, sharey=True)
    for axes, (scene, drawn) in zip(panels, found.items()):
        logarithmic(axes)
        axes.set(title=f"{scene} scene", xlabel="time")
        axes.ends = []
        for method, run in drawn.items():
            style = {**looks[method], "marker": ""}
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
         f" which the error grows, or how it is judged. Cross: the run failed. {KINDS}")
    return figure


def time_title(found):
    """Returns how many of the runs, in dicts by method, stay at rounding or bounded, and how many grow."""
    drawn = [run for each in found.values() for run in each.values()]
    verdicts = [run.judged(ENERGY).verdict for run in drawn]
    return (f"Energy error at equal cost ({equals('n', drawn[0].n)}): of {len(drawn)} runs {verdicts.count(KEPT)} are"
            f" at rounding, {verdicts.count(BOUNDED)} bounded, {verdicts.count(GROWS)} growing")


def drift_of(run):
    """Writes the power of time by which an energy error grows if it has one; otherwise the verdict."""
    verdict, growth, *_ = run.judged(ENERGY)
    return f"t^{growth.value:.1f}" if verdict == GROWS and growth and growth.low > LEAST_GROWTH else verdict
