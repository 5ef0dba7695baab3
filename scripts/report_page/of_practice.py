"""What people run, and what reaches a tenth of its error for less: from the study of practice."""

from lib.pages.integrate_line import integrate_line, start_of, start_of_code
from report_page.charts import Axis, Chart, Column, Option, Selector, as_plotly, options_of
from report_page.of_accuracy import chosen_at
from studies.practice.charts import DRAWN
from studies.practice.judge import findings, leading_results
from studies.practice.report import quflow_whole_text
from studies.practice.schema import AT_PRACTICE, AT_TENTH, METHOD, QUFLOW, ROUGH, TURBULENCE

ERRORS = (Option("a tenth of the practice's error", AT_TENTH), Option("the practice's error", AT_PRACTICE))
IMPORTS, DEVELOPED = "from studies.practice.single_runs import develop", "develop({})[0]"


def practice(study):
    """Returns the Chart of CPU time for a unit of simulated time against n: the practice, and the best of classes."""
    found = findings(study)
    leaders = [(each.group, each.wanted, row) for each, row in leading_results(found) if each.group in DRAWN]
    own = [(row.role, option.value, row) for row in found.results if row.role != METHOD for option in ERRORS]
    rows = sorted(((wanted, DRAWN[group][0], row) for group, wanted, row in (*own, *leaders)),
                  key=lambda each: each[2].n)

    def told(name):
        return [getattr(row, name) for *_, row in rows]

    scenes = options_of(row.scene for *_, row in rows)
    return Chart(
        "practice", "CPU time for a unit of simulated time, against n", Axis("n", "n", has_ticks=True),
        Axis("seconds", "CPU seconds for a unit of simulated time"),
        {"integrator": Column("method", ["quflow" if row.role == QUFLOW else row.integrator for *_, row in rows]),
         "class": Column("drawn as", [label for _, label, _ in rows]),
         "n": Column("n", told("n")), "step": Column("step h", told("step")), "steps": Column("steps", told("steps")),
         "error": Column("error", told("error")),
         "seconds": Column("CPU seconds a unit", told("seconds")),
         "time": Column("T", [study.problems[row.scene, row.n].time for *_, row in rows]),
         "products": Column("full products of the run", told("products")),
         "sweeps": Column("sweeps a step", told("sweeps")),
         "tolerance": Column("tolerance", told("tolerance")),
         "gain": Column("practice takes, times", told("gain_over_practice")),
         "low": Column("95 % from", told("gain_over_practice_low")), "high": Column("to",
                                                                                   told("gain_over_practice_high")),
         "quflow": Column("quflow takes, times", told("gain_over_quflow")),
         "scene": Column("", told("scene")), "wanted": Column("", [wanted for wanted, *_ in rows]),
         "series": Column("", [label for _, label, _ in rows])},
        (Selector("scene", "scene", scenes, chosen_at(scenes, ROUGH)), Selector("wanted", "methods at", ERRORS)),
        {label: as_plotly({"color": colour, **style}) for label, colour, style in DRAWN.values()},
        [line_of(study, row) for *_, row in rows],
        note="The practice: isospectral midpoint, h = ħ/4, tolerance 1e-8. Others: the cheapest method of a class at"
             f" the chosen error, at T = {times_text(study)}. Whole runs are timed up to"
             f" n = {study.settings.largest_whole}{quflow_whole_text(study.settings)}; beyond, some steps of a run, and"
             " scaled. Turbulence: a flow that was developed until its small scales were filled.")


def times_text(study):
    """Writes each time T of runs with the n that have it."""
    times = {}
    for problem in study.problems.values():
        times.setdefault(problem.time, set()).add(problem.n)
    return ", ".join(f"{time:g} (n = {', '.join(map(str, sorted(sizes)))})" for time, sizes in times.items())


def line_of(study, row):
    """Returns the command of a Result; quflow's own step has none."""
    if row.role == QUFLOW:
        return ""
    start = (start_of_code(f"turbulence_n{row.n}", IMPORTS, DEVELOPED.format(row.n)) if row.scene == TURBULENCE
             else start_of(row.scene, row.n))
    return integrate_line(start, row.n, row.integrator, row.step, study.problems[row.scene, row.n].time,
                          row.tolerance, study.integrators[row.integrator].best_form)


def sizes_text(study):
    return f"n = {min(n for _, n in study.problems)} … {max(n for _, n in study.problems)}"
