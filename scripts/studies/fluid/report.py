"""The report of the study `fluid`."""

from lib.pages.document import Column, Heading, Paragraph, conditions, plain_table, shown
from lib.pages.numbers import MISSING, percentage, power, scientific, three_digits
from lib.pages.rendering import Rendering
from studies.fluid.schema import read_fluid

STRUCTURE = "elp4"  # the method of the picture on the README
CHARTS = (("energy_spectra", "Energy of each degree l, at the start and late by each method."),)


def rendered(raw, _recorded):
    """Returns the Rendering of a raw file."""
    fluid = read_fluid(raw)
    from studies.fluid.charts import energy_spectra, spheres  # only now: it needs matplotlib
    charts = {"energy_spectra": energy_spectra(fluid)}
    pictures = {"fluid": spheres(fluid, [STRUCTURE]), "methods": spheres(fluid, fluid.ends)}
    return Rendering(lambda charts: document(fluid, charts), figures(fluid), charts, pictures=pictures)


def document(fluid, charts):
    columns = (Column("integrator", align="left"), Column("h"), Column("tolerance"), Column("products"),
               Column("energy error"), Column("enstrophy lost"), Column("spectrum error"))
    rows = [(name, f"{end.step:g}", MISSING if fluid.integrators[name].explicit else power(end.tolerance),
             three_digits(end.products), scientific(end.energy_error), percentage(max(0.0, 1 - end.enstrophy)),
             scientific(end.spectrum_error)) for name, end in fluid.ends.items()]
    times = " and ".join(f"{time:g}" for time in dict.fromkeys(end.time for end in fluid.ends.values()))
    return [
        Heading("One turbulent flow by several methods", 1),
        Paragraph(f"Sample {fluid.settings.sample} of the study of turbulence at n = {fluid.settings.n}, run to"
                  f" t = {times}. Trajectories of a turbulent flow part, so the pictures differ in their places; what"
                  " may be compared is their texture, and E(l). Enstrophy: ‖W‖², which the spectrum of W fixes."),
        *shown(CHARTS, charts), plain_table(columns, rows), conditions(fluid.context)]


def figures(fluid):
    """Returns n, and by method errors at the end, products, and as work these over the least of any method."""
    found = {"n": fluid.settings.n}
    for name, end in fluid.ends.items():
        found |= {f"{name}.{what}": getattr(end, what) for what in ("step", "time", "products", "energy_error",
                                                                    "spectrum_error")}
        found[f"{name}.enstrophy_lost"] = max(0.0, 1 - end.enstrophy)
        found[f"{name}.work"] = end.products / min(each.products for each in fluid.ends.values())
    return found
