"""The chart of the study `limits`."""

import math

from lib.pages.chart_panels import KEEPING, draw_line, label_ends, label_sizes, logarithmic, look, new_figure, note
from lib.pages.numbers import three_digits
from lib.records.integrators import chosen, name_with_order

# Fast forms, in the co-rotating frame where the list has them there. New integrators are added, in published form where
# they have no other.
DRAWN = ("group2", "elp4", "rkmk4", "magnus5", "rk4", "rk8")
TOLD = ("elp4", "group2")  # in the title, at the largest n of the first scene
TICKS = (0.5, 1, 2, 5, 10, 20)


def limits(study):
    """Draws the critical h‖B(W₀)‖₂ from a scene's own initial data against n, a panel a scene.

    A label says up to which n a method was tried, where that is not the largest of its panel. None without two n.
    """
    forms = chosen(study.integrators.values(), DRAWN, in_frame=True)
    lines = {scene: {name: points for name in forms if (points := line_of(study, scene, forms[name]))}
             for scene in study.scenes()}
    lines = {scene: found for scene, found in lines.items() if len(sizes_of(found)) > 1}
    if not lines:
        return None
    labels = {scene: {name: label_of(forms[name], points, sizes_of(found)[-1]) for name, points in found.items()}
              for scene, found in lines.items()}
    *inner, last = ([text for name, text in labels[scene].items() if found[name][-1][0] == sizes_of(found)[-1]]
                    for scene, found in lines.items())
    decades = [math.log(sizes_of(found)[-1] / sizes_of(found)[0]) for found in lines.values()]
    figure, (panels,) = new_figure(title_of(study, lines), 1, len(lines), 5.2, keys=2, labels=sum(inner, []),
                                   last_labels=last, sharey=True, gridspec_kw={"width_ratios": decades})
    for axes, (scene, found) in zip(panels, lines.items()):
        logarithmic(axes)
        axes.set(title=f"{scene} scene", xlabel="n")
        for name, points in found.items():
            draw_line(axes, name, points, **look(forms[name]))
        label_sizes([axes], sizes_of(found))
    panels[0].set_ylabel("critical h‖B(W₀)‖₂")
    panels[0].set_yticks(TICKS, list(map(str, TICKS)))
    for axes, (scene, found) in zip(panels, lines.items()):
        label_ends(axes, [(points[-1], labels[scene][name], look(forms[name])["color"])
                          for name, points in found.items()])
    note(figure, "Fast forms, in the co-rotating frame, where ‖B‖ is still that of the flow without it; each scene's"
         f" own initial data, short runs. A line spans the n that were tried: its ends are no failures. {KEEPING}")
    return figure


def sizes_of(lines):
    """Returns the n of some lines, rising."""
    return sorted({n for points in lines.values() for n, _ in points})


def line_of(study, scene, integrator):
    """Returns (n, critical h‖B‖₂), n rising, where a step failed."""
    solver = integrator.best_form
    points = [(n, study.own(solver, scene, n, integrator.name)) for n in study.sizes(solver)]
    return [(n, value) for n, value in points if value]


def label_of(integrator, points, largest):
    """Returns the name of a method with what of its line is not that of all others."""
    form = "" if integrator.has_fast_form else ", published"
    frame = "" if integrator.co_rotating else ", no frame"
    end = f", tried to {points[-1][0]}" if points[-1][0] < largest else ""
    return f"{name_with_order(integrator)}{form}{frame}{end}"


def title_of(study, lines):
    """Returns up to which step the methods of TOLD work, at the largest n of the first scene where both were tried."""
    scene, found = next(iter(lines.items()))
    told = [{"name": name_with_order(study.integrators[name]), **dict(points)} for method in TOLD
            for name, points in found.items() if study.integrators[name].method == method]
    sizes = [n for n in sizes_of(found) if len(told) == len(TOLD) and all(n in each for each in told)]
    if not sizes:
        return "Critical step against n"
    first, second = (f"{each['name']} works up to h‖B‖₂ = {three_digits(each[sizes[-1]])}" for each in told)
    return f"{scene.capitalize()} scene, n = {sizes[-1]}: {first}, {second.replace(' works', '')}"
