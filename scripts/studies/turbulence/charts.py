"""Draws the study of turbulence: statistical error against cost."""

from lib.records.integrators import chosen, short_name
from lib.pages.chart_panels import (FORMULATION_COLOURS, LABEL_SIZE, cross, draw_line, equals, logarithmic, look,
                                    new_figure, note)
from lib.pages.numbers import two_digits
from studies.turbulence.judge import TOLERANCE, line_of

PLAIN_TITLE = "Error of the statistics of turbulence against cost"
# Methods with a line; new ones have one too.
LINES = ("algebra1", "group2", "elp4", "rkmk4", "rk4", "rk8", "rk4_projected")
CAP = {"marker": "+", "markersize": 8, "color": "black", "zorder": 7, "label": "_cap"}
STAR = {"marker": "*", "markersize": 15, "linestyle": "none", "zorder": 6}
RING = {"marker": "o", "markersize": 11, "markerfacecolor": "none", "color": "#c00000", "linestyle": "none",
        "zorder": 5, "label": "_invariants"}


def statistical_error(study, found):
    """Draws the largest |z| against the CPU time of a run over that of the practice, a panel an n.

    `found` are its Findings by n. Only an n at which some method has two steps has a panel. None if there is none.
    """
    lines = {n: {name: points for name in chosen(study.integrators.values(), LINES)
                 if (points := points_of(findings, name))}
             for n, findings in found.items()}
    lines = {n: drawn for n, drawn in lines.items() if any(len(points) > 1 for points in drawn.values())}
    if not lines:
        return None
    figure, (panels,) = new_figure(title_of(study, {n: found[n] for n in lines}), 1, len(lines), 5.0, keys=2,
                                   sharex=True, sharey=True)
    for axes, (n, drawn) in zip(panels, lines.items()):
        logarithmic(axes)
        axes.set(title=f"n = {n}", xlabel="CPU time of a run over that of the practice")
        for name, points in drawn.items():
            draw_line(axes, name, points, **look(study.integrators[name]))
            draw_failure(axes, found[n], name)
            if off := points_of(found[n], name, lambda judged: not judged.conserves):
                axes.plot(*zip(*off), **RING)
        practice = found[n].practice
        if practice and practice.distance:
            axes.plot(1, practice.distance, color=FORMULATION_COLOURS["algebra"][0], label="_practice", **STAR)
    low, high = limits(lines, found)
    panels[0].set(ylabel="largest |z| of the statistics", ylim=(low, high))
    least = min(cost for drawn in lines.values() for points in drawn.values() for cost, _ in points)
    most = max(cost for drawn in lines.values() for points in drawn.values() for cost, _ in points)
    panels[0].set_xlim(least / 1.2, 1.05 * max(1.0, most))
    panels[0].set_yticks(*ticks(low, high, "{:g}".format))
    panels[0].set_xticks(*ticks(*panels[0].get_xlim(), "{:g}".format))
    for axes, (n, drawn) in zip(panels, lines.items()):
        if found[n].decides:
            axes.axhspan(low, found[n].reference.threshold, color="0.92", zorder=0, label="_faithful")
            axes.text(0.02, 0.02, "within chance", transform=axes.transAxes, color="0.35")
        for name, points in drawn.items():  # beside the longest step: there lines are furthest apart
            axes.annotate(short_name(study.integrators[name]), points[0], (9, 3), textcoords="offset points",
                          color=look(study.integrators[name])["color"], fontsize=LABEL_SIZE)
    note(figure, "Star: the practice, isospectral midpoint with h = ħ/4, at the end of the line of Gauss 2. Tolerance"
         " 1e-8; numbers are orders. Red ring: energy or enstrophy of a draw is off by more than"
         f" {TOLERANCE:.0%}. Cross: the next longer step loses a draw; plus: it takes more than"
         f" {study.settings.max_sweeps} sweeps. Solid: keeps the Lie–Poisson structure; dashed: the spectrum only;"
         " dotted: nothing.")
    return figure


def points_of(findings, integrator, drawn=lambda judged: True):
    """Returns (cost over the practice's, distance) of the settings of a line that have both, the longest step first.

    Only those that are `drawn`.
    """
    return [(over.ratio, judged.distance) for judged in line_of(findings, integrator)
            if judged.distance and drawn(judged) and (over := findings.over_practice(judged))]


def draw_failure(axes, findings, integrator):
    """Marks the longest step that works, if the next longer one fails; apart if the sweep cap alone ends its runs."""
    line = [judged.ensemble for judged in line_of(findings, integrator)]
    longest = max((ensemble.setting.step for ensemble in line if ensemble.works), default=0.0)
    longer = [ensemble for ensemble in line if ensemble.setting.step > longest]
    points = points_of(findings, integrator)
    if not longer or not points:
        return
    if longer[-1].capped == longer[-1].failed:
        axes.plot(*points[0], **CAP)
    else:
        cross(axes, points[0])


def limits(lines, found):
    """Returns the ends of the axis of distances, which hold every point and threshold."""
    values = [distance for drawn in lines.values() for points in drawn.values() for _, distance in points]
    values += [found[n].reference.threshold for n in lines]
    return min(values) / 1.5, max(values) * 1.5


def ticks(low, high, write):
    """Returns ticks at 1, 2 and 5 of each decade of a logarithmic axis, and their labels by `write`."""
    places = [digit * 10.0 ** power for power in range(-6, 3) for digit in (1, 2, 5)]
    inside = [place for place in places if low <= place <= high]
    return inside, list(map(write, inside))


def title_of(study, found):
    """Returns what the cheapest faithful run costs, with its name if no other is level with it.

    At the largest n that has one; a plain title without any.
    """
    n = max((n for n in found if found[n].over_practice(found[n].cheapest())), default=None)
    if n is None:
        return PLAIN_TITLE
    findings, best = found[n], found[n].cheapest()
    over = findings.over_practice(best)
    over, setting = two_digits(over.ratio), best.setting
    run = f"Turbulence at {equals('n', n)} to {equals('T', format(study.sizes[n].time, 'g'))}"
    if any(findings.level_with_cheapest()):
        return f"{run}: the cheapest faithful runs take {over} of the practice's cost"
    name = short_name(study.integrators[setting.integrator])
    return f"{run}: {name} with {equals('h', format(setting.step, 'g'))} is faithful at {over} of the practice's cost"
