"""Turbulence: energies of one flow by degree, from the study fluid, and what statistics cost, from turbulence."""

from lib.judging.verdicts import FEWEST
from lib.pages.integrate_line import integrate_line, start_of_code
from lib.pages.numbers import percentage
from lib.records.findings import DIGITS
from lib.records.formats import to_digits
from lib.records.integrators import KEPT, name_with_order
from lib.records.settings import steps_to
from report_page.charts import (DOTTED, FILLED, OPEN, Axis, Chart, Column, Option, Selector, as_plotly, look_of,
                                options_of)
from report_page.of_accuracy import marked
from studies.fluid.charts import START_COLOUR
from studies.turbulence.judge import NOT_JUDGED

IMPORTS, DRAWN_STATE = "from studies.turbulence.single_runs import drawn_scene", "drawn_scene({}, {}).initial"
SMALLEST = 1e-9  # share of the energy that is drawn, as in the still chart
START = "t = 0"
FAITHFUL, NOT_FAITHFUL = "faithful", "not faithful"
VERDICTS = {FAITHFUL: FILLED, NOT_FAITHFUL: OPEN, NOT_JUDGED: DOTTED}  # and how marks are filled


def start_at(n, sample):
    return start_of_code(f"drawn_n{n}_{sample}", IMPORTS, DRAWN_STATE.format(n, sample))


def spectra(fluid):
    """Returns the Chart of the energy of each degree l, at the start and at the end by each method."""
    n, sample = fluid.settings.n, fluid.settings.sample
    start, total = start_at(n, sample), sum(fluid.start.energies)
    states = [(START, None, fluid.start.energies, start.first.removesuffix(" && "))]
    for name, end in fluid.ends.items():
        integrator = fluid.integrators[name]
        states.append((name_with_order(integrator), end, end.energies, integrate_line(
            start, n, name, end.step, end.time, end.tolerance, integrator.best_form)))
    rows = [(label, end, degree, energy / total, line) for label, end, energies, line in states
            for degree, energy in enumerate(energies, 1) if energy / total > SMALLEST]
    looks = {START: as_plotly({"color": START_COLOUR})}
    looks |= {name_with_order(fluid.integrators[name]): look_of(fluid.integrators[name], end.tolerance)
              for name, end in fluid.ends.items()}
    return Chart(
        "spectra", "Energy by degree, at the start and late", Axis("degree", "degree l"),
        Axis("energy", "energy E(l) over all energy"),
        {"state": Column("state", [label for label, *_ in rows]),
         "time": Column("t", [end.time if end else 0 for _, end, *_ in rows]),
         "step": Column("step h", [end and end.step for _, end, *_ in rows]),
         "degree": Column("l", [degree for _, _, degree, *_ in rows]),
         "energy": Column("E(l) over all energy", [energy for *_, energy, _ in rows]),
         "lost": Column("enstrophy lost", [end and max(0.0, 1 - end.enstrophy) for _, end, *_ in rows]),
         "series": Column("", [label for label, *_ in rows])},
        (), looks, [line for *_, line in rows],
        note=f"One turbulent flow, n = {n}. What a method loses of the spectrum of W is missing at the small scales.")


# ---- what statistics cost


def statistics(study, found):
    """Returns the Chart of how far the statistics of settings are off, against what they cost."""
    trust = {each.n: each for each in found.trust}
    rows = [row for row in found.settings if row.distance is not None and row.over_baseline is not None]
    verdicts = [verdict_of(trust[row.n], row) for row in rows]
    sizes = sorted({row.n for row in rows})
    first = max((place for place, n in enumerate(sizes) if trust[n].decides), default=len(sizes) - 1)
    methods = dict.fromkeys(row.integrator for row in rows)
    return Chart(
        "statistics", "How far statistics are off, against cost", Axis("cost", "CPU time over that of the baseline"),
        Axis("distance", "distance from the reference, over chance"),
        {"integrator": Column("method", [row.integrator for row in rows]),
         "n": Column("n", [row.n for row in rows]), "step": Column("step h", [row.step for row in rows]),
         "tolerance": Column("tolerance", [row.tolerance for row in rows]),
         "keeps": Column("keeps", [KEPT[row.keeps] for row in rows]),
         "verdict": Column("statistics", verdicts),
         "distance": Column("distance over chance", [row.distance / trust[row.n].threshold for row in rows]),
         "cost": Column("time over the baseline's", [row.over_baseline for row in rows]),
         "products": Column("full products a unit of time", [row.products for row in rows]),
         "energy": Column("energy off, at worst", [row.energy_worst for row in rows]),
         "enstrophy": Column("enstrophy off, at worst", [row.enstrophy_worst for row in rows]),
         "spectrum": Column("spectrum error", [row.spectrum_error for row in rows]),
         "fill": Column("", [VERDICTS[verdict] for verdict in verdicts]),
         "series": Column("", [name_with_order(study.integrators[row.integrator]) for row in rows])},
        (Selector("n", "n", options_of(sizes, str), first),
         Selector("verdict", "statistics", (Option("all", None), *options_of(
             [verdict for verdict in VERDICTS if verdict in verdicts])))),
        {name_with_order(study.integrators[name]): marked(study.integrators[name], place, FILLED)
         for place, name in enumerate(methods)},
        [line_of(study, row) for row in rows],
        band=(None, 1.0),
        note="A mark is a method with a step, over all samples; its command runs the first sample. Shaded: within"
             " chance of the reference. Filled: faithful, that is there, with energy and enstrophy kept to 1 % in every"
             f" sample. Chance calls {alarms_text(found)} of right settings not faithful."
             " Baseline: isospectral midpoint, h = ħ/4. Settings that lost a sample have no statistics; with fewer"
             f" than {FEWEST} samples nothing is judged, which a dot says.")


def alarms_text(found):
    """Writes which share of right settings is called wrong, where anything is judged."""
    return " and ".join(f"{percentage(each.false_positives)} (n = {each.n})" for each in found.trust
                        if each.decides) or "some share"


def line_of(study, row):
    """Returns the command of a setting, whose step findings give with fewer digits than the runs."""
    step = next(each.step for each in study.ensembles[row.n] if each.integrator == row.integrator
                and to_digits(each.step, DIGITS) == to_digits(row.step, DIGITS) and each.tolerance == row.tolerance)
    return integrate_line(start_at(row.n, 0), row.n, row.integrator, step,
                          steps_to(study.sizes[row.n].time, step) * step, row.tolerance,
                          study.integrators[row.integrator].best_form)


def verdict_of(trust, row):
    """Returns whether the statistics of a setting are faithful, of VERDICTS, given how far its n is to be trusted."""
    if not trust.decides:
        return NOT_JUDGED
    return FAITHFUL if row.faithful else NOT_FAITHFUL
