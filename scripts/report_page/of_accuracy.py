"""Speed against accuracy, and what runs keep: from the studies of accuracy and of long runs."""

from lib.pages.chart_panels import FORMULATION_COLOURS, colour_and_size
from lib.pages.integrate_line import integrate_line, start_of
from lib.pages.numbers import power
from lib.records.integrators import GAUSS, KEPT
from lib.records.settings import keeps
from report_page.charts import (KEEPING, MARKS, OPEN, Axis, Chart, Column, Option, Selector, as_plotly, mark_of,
                                options_of)
from studies.accuracy.charts import ERROR_LABEL, SECONDS_LABEL, WORK_PRECISION_OF, label_of

SHOWN_N = 65  # at first
STRUCTURES = tuple(KEPT)
KEEPS = Selector("structure", "keeps at least", at_least=True,
                 options=tuple(Option(words, place) for place, words in enumerate(KEPT.values())))


def structure_of(integrator, tolerance):
    """Returns the place in STRUCTURES of the strongest one that an Integrator keeps at a tolerance."""
    return max(place for place, each in enumerate(STRUCTURES) if keeps(integrator, tolerance, each))


def problem_text(problem):
    return f"{problem.scene}, T = {problem.time:g}"


def tolerances_of(runs):
    """Returns the Selector of the tolerances of some runs."""
    found = sorted({run.tolerance for run in runs})
    return Selector("tolerance", "tolerance", (Option("any", None), *options_of(found, power)))


def line_of(run, scene, solver):
    return integrate_line(start_of(scene, run.n), run.n, run.integrator, run.step, run.time, run.tolerance, solver)


def chosen_at(options, value):
    """Returns the place of the Option with a value, else the first."""
    return next((place for place, each in enumerate(options) if each.value == value), 0)


def speed(study):
    """Returns the Chart of seconds against errors: of every line above its floor, up to the method's limit."""
    runs = [run for problem in study.problems() for form in study.forms()
            for stretch in study.stretches(problem, *form) for run in stretch]
    scenes, sizes = (options_of(values) for values in ((problem_text(run.problem) for run in runs),
                                                       sorted({run.n for run in runs})))
    kept = [structure_of(study.integrators[run.integrator], run.tolerance) for run in runs]
    shown = "{}, T = {:g}".format(*WORK_PRECISION_OF)
    return Chart(
        "speed", "CPU time against error: methods that none beats in both",
        Axis("error", ERROR_LABEL, is_reversed=True), Axis("seconds", SECONDS_LABEL),
        {"integrator": Column("method", [run.integrator for run in runs]),
         "form": Column("form", [run.solver for run in runs]),
         "step": Column("step h", [run.step for run in runs]),
         "steps": Column("steps", [run.steps for run in runs]),
         "error": Column("error", [run.error for run in runs]),
         "seconds": Column("CPU seconds", [run.seconds for run in runs]),
         "products": Column("full products", [run.equivalent_products for run in runs]),
         "sweeps": Column("sweeps", [run.sweeps for run in runs]),
         "kept": Column("keeps", [KEPT[STRUCTURES[each]] for each in kept]),
         "tolerance": Column("tolerance", [run.tolerance for run in runs]),
         "scene": Column("", [problem_text(run.problem) for run in runs]),
         "n": Column("n", [run.n for run in runs]),
         "structure": Column("", kept),
         "series": Column("", [label_of(study, run.form) for run in runs])},
        (Selector("scene", "scene", scenes, chosen_at(scenes, shown)),
         Selector("n", "n", sizes, chosen_at(sizes, SHOWN_N)), KEEPS, tolerances_of(runs)),
        {label_of(study, form): mark_of(study.integrators[form.integrator], form.tolerance)
         for form in study.forms()},
        [line_of(run, run.scene, run.solver) for run in runs], has_front=True,
        note="Errors fall to the right. In colour: points that no other of the selection beats in time and in error."
             f" Grey: all others. {KEEPING} In the co-rotating frame, but where a name says"
             " otherwise. Errors below the floor of the reference solution, and steps beyond a"
             " method's stability limit, are left out. Times are the least of the repetitions; of runs of much work"
             " the first steps are timed, and scaled by products.")


# ---- what runs keep


def class_of(integrator):
    """Returns the name of the class of an Integrator, as the key has it."""
    if integrator.family == GAUSS:
        return f"Gauss, {integrator.formulation}"
    return f"{integrator.family}, projected" if integrator.projected else integrator.family


def kept(accuracy, longruns):
    """Returns the Chart of energy errors against spectrum errors, of either study or both; a study may be None."""
    found, integrators = [], {}
    if accuracy:
        integrators.update(accuracy.integrators)
        found += [(run, problem_text(run.problem), run.solver, run.equivalent_products / run.time)
                  for run in accuracy.runs if run.usable]
    if longruns:
        integrators.update(longruns.integrators)
        found += [(point, f"{point.scene}, long runs",
                   longruns.integrators[point.integrator].best_form,
                   point.equivalent_products)
                  for line in longruns.lines.values() for point in line if point.usable]
    runs = [run for run, *_ in found]
    scenes, sizes = options_of(scene for _, scene, _, _ in found), options_of(sorted({run.n for run in runs}))
    kept_at = [structure_of(integrators[run.integrator], run.tolerance) for run in runs]
    return Chart(
        "kept", "What each run lost of the energy, and of the spectrum",
        Axis("spectrum", "spectrum error at the end"),
        Axis("energy", "largest energy error"),
        {"integrator": Column("method", [run.integrator for run in runs]),
         "form": Column("form", [form for _, _, form, _ in found]),
         "step": Column("step h", [run.step for run in runs]),
         "steps": Column("steps", [run.steps for run in runs]),
         "time": Column("T", [run.time for run in runs]),
         "energy": Column("energy error", [run.energy_error for run in runs]),
         "spectrum": Column("spectrum error", [run.spectrum_error for run in runs]),
         "products": Column("full products a unit of time", [products for *_, products in found]),
         "tolerance": Column("tolerance", [run.tolerance for run in runs]),
         "kept": Column("keeps", [KEPT[STRUCTURES[each]] for each in kept_at]),
         "scene": Column("", [scene for _, scene, _, _ in found]),
         "n": Column("n", [run.n for run in runs]),
         "structure": Column("", kept_at),
         "series": Column("", [class_of(integrators[run.integrator]) for run in runs])},
        (Selector("scene", "scene", scenes, chosen_at(scenes, "smooth, long runs")),
         Selector("n", "n", sizes, 0), KEEPS, tolerances_of(runs)),
        looks_of_classes(integrators),
        [line_of(run, run.scene, form) for run, _, form, _ in found],
        note="Each mark is a run: the largest relative error of the energy, and of an eigenvalue at the end. On the"
             " left the spectrum is kept to rounding. Long runs take T = 1000 at n = 33 and less at larger n, as each"
             " point says; those that lost all their energy or spectrum are left out.")


def looks_of_classes(integrators):
    """Returns the look of each class, in the colour of its family and with a mark of its own."""
    classes = {}
    for each in integrators.values():
        classes.setdefault(class_of(each), each)
    order = [*(f"Gauss, {each}" for each in FORMULATION_COLOURS if f"Gauss, {each}" in classes),
             *(name for name, each in classes.items() if each.family != GAUSS)]
    return {name: marked(classes[name], place) for place, name in enumerate(order)}


def marked(integrator, place, fill=OPEN):
    """Returns the look of points in the colour of an Integrator's family, with the mark of a place in a key."""
    look = as_plotly({"color": colour_and_size(integrator)[0], "marker": "o", "markersize": 4.5}, joined=False)
    return {**look, "symbol": MARKS[place % len(MARKS)] + fill}
