"""The chart of the study `practice`: time for a unit of simulated time against n."""

from lib.pages.chart_panels import (FAMILY_COLOURS, FORMULATION_COLOURS, KEEPING, LINES, draw_line, label_ends,
                                    label_sizes, logarithmic, mixed, new_figure, note, unbroken)
from lib.pages.numbers import span
from lib.records.integrators import EXPONENTIAL, MAGNUS
from studies.practice.judge import BEST, cheapest, gains
from studies.practice.schema import AT_TENTH, SCENES, TURBULENCE

PURPLE = FORMULATION_COLOURS["algebra"][0]
POISSON, SPECTRUM, NOTHING = ({"linestyle": LINES[each]} for each in ("poisson", "spectrum", "nothing"))
# What is drawn, each with its label, colour and style: the practice, quflow, and groups of methods at AT_TENTH.
DRAWN = {
    "quflow": ("quflow", mixed(PURPLE, "white", 0.45), {**POISSON, "linewidth": 2.4, "marker": "s"}),
    "practice": ("practice", PURPLE, {**POISSON, "linewidth": 2.4, "marker": "o"}),
    "gauss": ("Gauss", FORMULATION_COLOURS["group"][0], {**POISSON, "marker": "s"}),
    "exponential": ("exponential", FAMILY_COLOURS[EXPONENTIAL][0], {**SPECTRUM, "marker": "D"}),
    "magnus": ("Magnus", FAMILY_COLOURS[MAGNUS][0], {**SPECTRUM, "marker": "v"}),
    "explicit": ("explicit", "#000000", {**NOTHING, "linewidth": 2.0, "marker": "o", "markerfacecolor": "white"})}


def rows_of(study, scene):
    """Returns for each of DRAWN its points (n, row or None) in a scene, n rising."""
    found = {each: [] for each in DRAWN}
    for key in sorted(key for key in study.problems if key[0] == scene):
        rows = {"practice": study.practice(key), "quflow": study.quflow(key)}
        for each, points in found.items():
            points.append((key[1], rows[each] if each in rows else cheapest(study, key, AT_TENTH, each)))
    return {each: points for each, points in found.items() if any(row for _, row in points)}


def time_against_n(study):
    """Draws CPU seconds for a unit of simulated time against n, a panel a scene. None for fewer than two n."""
    sizes = {scene: {n for each, n in study.problems if each == scene} for scene in SCENES}
    scenes = [scene for scene in SCENES if len(sizes[scene]) > 1]
    if not scenes:
        return None
    drawn = {scene: rows_of(study, scene) for scene in scenes}
    labels = [DRAWN[each][0] for each in DRAWN]
    figure, (panels,) = new_figure(title_of(study, scenes), 1, len(scenes), 5.2, keys=3, sharey=True, labels=labels)
    ends = []  # of the lines of each panel, labelled when all are drawn, since they share an axis
    for axes, (scene, lines) in zip(panels, drawn.items()):
        logarithmic(axes)
        axes.set(title=f"{scene} scene" if scene != TURBULENCE else "developed turbulence", xlabel="n")
        ends.append([])
        for each, points in lines.items():
            label, colour, style = DRAWN[each]
            for stretch in unbroken(points):
                line = [(n, row.seconds / study.problems[scene, n].time) for n, row in stretch]
                draw_line(axes, label, line, color=colour, **style)
            ends[-1].append((line[-1], label, colour))
        label_sizes([axes], sizes[scene])
    for axes, found in zip(panels, ends):
        label_ends(axes, found, in_one_column=True)
    panels[0].set_ylabel("CPU seconds for a unit of simulated time")
    note(figure, "Practice and quflow: isospectral midpoint, h = ħ/4, tolerance 1e-8 and quflow's default. Others: the"
         " cheapest method of a class at a tenth of the practice's error, at the tolerance that it needs; Gauss methods"
         f" keep the spectrum to their tolerance. {KEEPING}", study.context)
    return figure


def title_of(study, scenes):
    """Returns how many times as long the practice and quflow take as the best method at a tenth of the error."""
    pairs = [(key, best) for key in study.problems if key[0] in scenes
             and (best := cheapest(study, key, AT_TENTH, BEST)) is not None]
    text = "No method reaches a tenth of the practice's error"
    if pairs:
        over = [gains("practice", study.practice(key), best)["gain_over_practice"] for key, best in pairs]
        text = f"The practice takes {span(over)} times as long as the best method for a tenth of its error"
    over = [found["gain_over_quflow"] for key, best in pairs
            if (found := gains("quflow", study.quflow(key), best))]
    return text + (f", and quflow {span(over)} times" if over else "")
