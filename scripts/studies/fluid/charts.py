"""The pictures of the study `fluid`: vorticity on the sphere, and energies of its scales."""

import math

from matplotlib.figure import Figure

from lib.pages.chart_panels import (DOTS_PER_INCH, draw_line, label_ends, logarithmic, look, new_figure, note,
                                    percent)
from lib.records.integrators import name_with_order
from studies.fluid.schema import COLUMNS, ROWS, SCALE

INCHES = 2.65, 1.5  # of one sphere
COLOURS, START_COLOUR = "RdBu_r", "0.55"


def spheres(fluid, names):
    """Draws ω at the start, and at the end by some methods, in Mollweide's projection of equal areas."""
    states = [fluid.start, *(fluid.ends[name] for name in names if name in fluid.ends)]
    width, height = INCHES
    figure = Figure(figsize=(width * len(states), height + 0.75), dpi=DOTS_PER_INCH)
    edges = [[math.pi * scale * (place / count - 0.5) for place in range(count + 1)]
             for count, scale in ((COLUMNS, 2), (ROWS, 1))]
    for place, state in enumerate(states):
        axes = figure.add_axes((place / len(states) + 0.006, 0.26, 1 / len(states) - 0.012, 0.6),
                               projection="mollweide")
        field = [[value / SCALE for value in state.vorticity[row * COLUMNS:(row + 1) * COLUMNS]]
                 for row in range(ROWS)]
        axes.pcolormesh(*edges, field, cmap=COLOURS, vmin=-1, vmax=1, rasterized=True)
        axes.set(xticks=[], yticks=[])
        title, kept = words_of(fluid, state)
        axes.set_title(title, loc="center")
        axes.text(0.5, -0.1, kept, transform=axes.transAxes, ha="center", va="top")
    figure.text(0.01, 0.03, f"Vorticity, n = {fluid.settings.n}: red turns anticlockwise, blue clockwise.",
                color="0.25")
    return figure


def words_of(fluid, state):
    """Returns the title of a picture, and what stands under it."""
    if state is fluid.start:
        return "t = 0", ""
    lost = 1 - state.enstrophy
    return (f"t = {state.time:g}, {name_with_order(fluid.integrators[state.integrator])}",
            f"{percent(lost)} of the enstrophy lost" if lost > 0.005 else "enstrophy kept")


def energy_spectra(fluid):
    """Draws E(l) at the start and at the end by each method. None without an end."""
    if not fluid.ends:
        return None
    ends = {name_with_order(fluid.integrators[name]): state for name, state in fluid.ends.items()}
    figure, ((axes,),) = new_figure("What a method loses of the spectrum of W is missing at the small scales", 1, 1,
                                    4.6, last_labels=["t = 0", *ends])
    logarithmic(axes)
    axes.set(xlabel="degree l", ylabel="energy E(l) over all energy")
    total = sum(fluid.start.energies)
    labels = []
    for label, state, style in (
            ("t = 0", fluid.start, {"color": START_COLOUR, "linestyle": "-"}),
            *((label, state, look(fluid.integrators[state.integrator], state.tolerance))
              for label, state in ends.items())):
        points = [(degree, energy / total) for degree, energy in enumerate(state.energies, 1)]
        style = {**style, "marker": ""}
        shown = draw_line(axes, label, [point for point in points if point[1] > 1e-9], **style)
        labels.append((shown[-1], label, style["color"]))
    label_ends(axes, labels, in_one_column=True)
    note(figure, f"One turbulent flow, n = {fluid.settings.n}, at t = 0 and at t ="
         f" {max(state.time for state in fluid.ends.values()):g}; l = 6 … 10 at the start. At its tolerance elp4 keeps"
         " the spectrum; at 1e-13 the Lie–Poisson structure too.")
    return figure
