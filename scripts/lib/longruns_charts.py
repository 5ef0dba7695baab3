"""Draws the study of long runs: energy errors against time, and energy against spectrum errors at the end."""

from matplotlib.ticker import LogLocator

from lib.chart_panels import (cross, draw_line, label_ends, logarithmic, look, mixed, new_figure, note, short_name,
                              spread)
from lib.drift import BOUNDED, GROWS, KEPT, ROUNDING
from lib.longruns_files import COARSE, ENERGY, LOOSE, ONE_STEP, SCENES, SPECTRUM, TIGHTER
from lib.numbers import scientific

AGAINST_TIME = ("algebra1", "group2", "elp6", "elp6_tight", "rkmk4", "rk4_projected", "rk4")  # lines of the first chart
DOT_TITLE = (("rk4", SPECTRUM), ("rkmk4", ENERGY), ("elp6", ENERGY))  # errors in the title of the second
PREFERRED_N = 33  # of the charts; else the smallest that there is
LEAST_SPECTRUM = 1e-16  # where an exact 0 is drawn
LABEL_POINTS = 10
DOT_GAP = 1.25  # least distance of two labels, over their size


def chart_n(runs):
    """Returns the n that the charts show."""
    sizes = [n for n, _ in runs.settings()]
    return PREFERRED_N if PREFERRED_N in sizes else sizes[0]


def name_of(runs, run):
    """Returns the short name of a long run's method, with the tolerance where that is not the usual one."""
    name = short_name(runs.integrator_of(run))
    return f"{name}, {written_tolerance(run)}" if run.run.is_variant else name


def colour_of(runs, run):
    """Returns the colour of a method: of its integrator, lighter at a looser tolerance and darker at a tighter one."""
    colour = look(runs.integrator_of(run))["color"]
    if run.run.method.endswith(LOOSE):
        return mixed(colour, "white", 0.4)
    return mixed(colour, "black", 0.4) if run.run.method.endswith(TIGHTER) else colour


def written_tolerance(run):
    return f"{run.run.tolerance:.0e}".replace("e-0", "e-")


# ---- energy against time


def energy_against_time(runs, scene="smooth"):
    """Draws the largest energy error of each window against time, at the coarse equal cost. None without a line."""
    n = chart_n(runs)
    found = runs.at(scene, n, COARSE)
    lines = {method: found[method] for method in AGAINST_TIME if method in found and found[method].series(ENERGY)}
    if not lines:
        return None
    labels = {method: f"{name_of(runs, run)} ({drift_of(run)})" for method, run in lines.items()}
    figure, ((axes,),) = new_figure(time_title(lines, n), 1, 1, 5.4, keys=2, labels=labels.values())
    logarithmic(axes)
    axes.set(xlabel="time", ylabel="relative energy error, largest in a window")
    ends = []
    for method, run in lines.items():
        style = {**look(runs.integrator_of(run)), "marker": "", "linewidth": 1.6, "color": colour_of(runs, run)}
        points = draw_line(axes, method, run.series(ENERGY), **style)
        if not points:
            continue
        if not run.run.finished:
            cross(axes, points[-1])
        ends.append((points[-1], labels[method], style["color"]))
    label_ends(axes, ends)
    plan = runs.plans[n]
    note(figure, f"n = {n}, {scene} scene, in the co-rotating frame, equal CPU time for all methods, {plan.windows}"
         " windows. Tolerance 1e-13 of Gauss, 1e-8 of exponential and Magnus methods; numbers are orders. Solid: keeps"
         " the Lie–Poisson structure; dashed: the spectrum only; dotted: neither. In brackets: how the error grows over"
         " the last decade of time, or how it is judged. Cross: the run failed.")
    return figure


def drift_of(run):
    """Writes the power of time by which an energy error grows if it is judged to grow; otherwise the verdict."""
    verdict, growth = run.judged(ENERGY)
    return f"t^{growth.power:.1f}" if verdict == GROWS else verdict


def time_title(lines, n):
    """Returns for how many of the lines the energy error is bounded."""
    bounded = [run for run in lines.values() if run.judged(ENERGY).verdict in (KEPT, BOUNDED)]
    return f"Energy error at equal cost, n = {n}: bounded for {len(bounded)} of {len(lines)} methods"


# ---- energy against spectrum, a dot a method


def energy_against_spectrum(runs):
    """Draws the energy error against the spectrum error at the end, a dot a method and a panel a scene.

    All methods take the same step; None without a run that came to its end.
    """
    n = chart_n(runs)
    dots = {scene: found for scene in SCENES if (found := dots_of(runs, scene, n))}
    if not dots:
        return None
    labels = [label for found in dots.values() for _, label, _, _ in found]
    figure, (panels,) = new_figure(dot_title(runs, dots, n), 1, len(dots), 5.4, keys=2, labels=labels, sharex=True,
                                   sharey=True)
    for axes, (scene, found) in zip(panels, dots.items()):
        logarithmic(axes)
        axes.xaxis.set_major_locator(LogLocator(numticks=7))
        axes.axvline(ROUNDING, color="0.6", linewidth=0.9, zorder=1, label="_kept")
        axes.set(title=f"{scene} scene", xlabel="largest error of an eigenvalue at the end")
        for place, label, colour, marker in found:
            axes.plot(*place, marker=marker, color=colour, markersize=8, linestyle="none", label=label, zorder=3)
    panels[0].set_ylabel("relative energy error at the end")
    for axes, found in zip(panels, dots.values()):
        label_dots(axes, found)
    step = next(iter(runs.at(next(iter(dots)), n, ONE_STEP).values())).run.step
    note(figure, f"n = {n}, h = {step:g} for all methods, T = {runs.plans[n].time:g}, in the co-rotating frame; numbers"
         " are orders. Bottom left is best. Left of the grey line the spectrum is kept. The energy error is the largest"
         " in the last window. Costs differ: the report has them, and the same at equal cost.")
    return figure


def dots_of(runs, scene, n):
    """Returns (place, label, colour, marker) of each method that came to the end with the one step.

    A tighter tolerance keeps the same spectrum and has no dot of its own.
    """
    found = []
    for run in runs.at(scene, n, ONE_STEP).values():
        energy, spectrum = run.last(ENERGY), run.last(SPECTRUM)
        if not run.run.finished or not energy or spectrum is None or run.run.method.endswith(TIGHTER):
            continue
        marker = look(runs.integrator_of(run))["marker"]
        found.append(((max(spectrum, LEAST_SPECTRUM), energy), name_of(runs, run), colour_of(runs, run), marker))
    return found


def label_dots(axes, dots):
    """Writes a label right of each dot, moved up or down where two would overlap."""
    axes.autoscale_view()
    to_pixels = axes.transData.transform
    gap = DOT_GAP * LABEL_POINTS / 72 * axes.figure.dpi
    for group in columns_of([(*to_pixels(place), label, colour) for place, label, colour, _ in dots]):
        heights = spread([y for _, y, _, _ in group], gap)
        for (x, y, label, colour), height in zip(group, heights):
            shift = (height - y) / axes.figure.dpi * 72
            axes.annotate(label, axes.transData.inverted().transform((x, y)), xytext=(8, shift),
                          textcoords="offset points", va="center", color=colour, fontsize=LABEL_POINTS,
                          annotation_clip=False)


def columns_of(places, width=150):
    """Returns places (x, y, …) in groups whose x lie within so many pixels, each with rising y."""
    groups = []
    for place in sorted(places):
        if groups and place[0] - groups[-1][0][0] <= width:
            groups[-1].append(place)
        else:
            groups.append([place])
    return [sorted(group, key=lambda place: place[1]) for group in groups]


def dot_title(runs, dots, n):
    """Returns the errors of RK4, RKMK4 and the exponential method of order 6 in the first scene drawn.

    If one of them did not come to its end, the title has no figures.
    """
    scene = next(iter(dots))
    found = runs.at(scene, n, ONE_STEP)
    told = [found[method].last(quantity) for method, quantity in DOT_TITLE
            if method in found and found[method].run.finished]
    if len(told) < len(DOT_TITLE) or None in told:
        return f"Errors at the end, n = {n}"
    spectrum, energy, exponential = map(scientific, told)
    return (f"At the end (n = {n}, {scene}) RK4 is off by {spectrum} in an eigenvalue; in energy RKMK4 by {energy},"
            f" exponential 6 by {exponential}")
