"""A study of accuracy against cost as a document: what it says, charts and tables."""

import math

from accuracy_claims import claims, loosest_tolerances, scientific, two_digits
from accuracy_lines import FAST, FLOOR_MARGIN, PUBLISHED, TABLE1_STEP
from benchmark_json import FORMULATIONS
from comparison import MISSING, percentage, three_digits
from document import Column, Entry, Heading, Items, Paragraph, Table, conditions, plain_table, shown
from equal_error import (EXPONENTS, MEAN_EXPONENTS, STRUCTURES, cheapest, forms_of, frame_gains, headline_problems,
                         keeping, mean, means_by_problem, prices, published_gains, ratio_of, strongest)
from integrator_names import frameless, gauss_stages
from recommendation import recommendation_tables

SHOWN_EXPONENTS = EXPONENTS[::2]
CARE_ERROR = 1e-6  # near which equal care is shown, ...
CARE_SIZE = 129  # ... at the largest n up to this

WORK_PRECISION = ("A thin line is one integrator in its fast form (a Gauss method: group, or at order 2 algebra where a"
                  " step is cheaper), with dots in the co-rotating frame; it ends where the reference can no longer"
                  f" tell its error ({FLOOR_MARGIN} times the uncertainty), where the error stops falling, or where"
                  " runs take too long, and breaks at failures and limits. Thick: the cheapest with this error or a smaller"
                  " one; it is upright above the longest step that ran. All panels have equal decades.")
CHARTS = (
    ("error_against_time", f"Error against CPU time, smooth scene, T = 5. {WORK_PRECISION}"),
    ("error_against_time_others", "The same for the other problems."),
    ("energy_against_time", "The same for the energy error, the largest over the steps, in the smooth scene."),
    ("error_against_n", "Error at the step of Table 1 against n, and of every step against h‖B(W₀)‖₂, smooth scene,"
     " T = 5. Lines of all n that coincide say that h‖B‖₂ decides, not n."),
    ("tolerance", "Errors and time against the tolerance of the fixed point, at the step size of Table 1, h ="
     f" {TABLE1_STEP}. Solver error: distance from the answer with the tightest tolerance that converged. The diagonal"
     " is where an error equals the tolerance."),
    ("table1_accuracy", "Tables 1 and 2 with their accuracy: every cell that did not fail as time against error, the"
     " published form hollow, the fast one filled, timed in turns. Dotted lines join the forms with one answer. Bars"
     " span the quartiles."),
)
KEEPS = {"poisson": "Lie–Poisson", "spectrum": "spectrum", "nothing": "neither"}
# What was tried and paid, by what the name of an integrator begins with.
CARE = {
    **dict.fromkeys(FORMULATIONS, "predictor, inexact Newton in single precision, triangles, bands"),
    **dict.fromkeys(("yoshida", "suzuki", "kahan_li"), "a predictor for each substep, inexact Newton, bands"),
    "direct": "predictor, inexact Newton in single precision, bands",
    "rkmk": "late terms of the series in single precision, bands",
    "rk": "one product a stage in split-complex storage, bands",
}


def accuracy_sections(study, charts):
    """Returns the document; `charts` are the names of the charts beside it."""
    return [
        Heading("Accuracy against cost", 1),
        Paragraph("Every integrator over step sizes on every problem; errors are relative, in the Frobenius norm, and"
                  " costs at an error are interpolated between two neighbouring runs that worked. Ratios: geometric"
                  " mean (from fastest over slowest repetitions to slowest over fastest)."),
        Items([(strong, rest.replace("`", "")) for strong, rest in claims(study)]),
        *shown(CHARTS, charts),
        *references_section(study),
        *structures_section(study),
        *prices_section(study),
        *orders_section(study),
        *gains_section(study),
        *care_section(study),
        *integrators_section(study),
        *fixed_step_section(study),
        *tolerance_section(study),
        Heading("The cheapest sufficient method"),
        *recommendation_tables(study),
        *limits_section(study),
        *failures_section(study),
        conditions(study.context),
    ]


def by_problem(study, heading, text, names, entry, columns=(), problems=None,
               group=lambda problem: f"{problem.scene}, T = {problem.time:g}"):
    """Returns a section with a row for each integrator and a column for each problem, after some (heading, text)."""
    problems = study.problems() if problems is None else problems
    rows = [[name, *(show(study.integrators[name]) for _, show in columns),
             *(entry(problem, name) for problem in problems)] for name in names]
    heads = (Column("integrator", align="left"), *(Column(name) for name, _ in columns),
             *(Column(f"n = {problem.n}", group(problem)) for problem in problems))
    return [Heading(heading), Paragraph(text), plain_table(heads, rows)] if rows else []


def references_section(study):
    columns = (Column("problem", align="left"), Column("from", align="left"), Column("which differ by"))
    rows = [[str(problem),
             " and ".join(f"{name} in {steps} steps" for name, steps in zip(each.integrators, each.steps)),
             scientific(each.uncertainty)] for problem in study.problems() for each in (study.references[problem],)]
    return [Heading("Reference solutions"), plain_table(columns, rows)]


# ---- comparisons at equal error


def by_error(study, choices, more=(), ratios=lambda best: ()):
    """Returns a table of the cheapest of each choice (by its heading, names of integrators) for each problem and error.

    Marked: the cheapest of the row. Columns `more` show `ratios` of a row's (name, Cost), None where there is none.
    """
    columns = (Column("problem", align="left"), Column("error"), *(Column(each, align="left") for each in choices),
               *map(Column, more))
    blocks = []
    for problem in study.problems():
        rows = []
        for error in (10.0**exponent for exponent in SHOWN_EXPONENTS):
            best = [cheapest(study, problem, error, names, or_less=True) for names in choices.values()]
            least = min((each[1].seconds for each in best if each), default=None)
            texts = [each and f"{each[0]} {three_digits(each[1].seconds)}" + " †" * (each[1].coarse.error < error)
                     for each in best]
            rows.append([Entry("" if rows else str(problem)), Entry(f"{error:.0e}".replace("e-0", "e-")),
                         *(Entry(text, each[1].seconds == least) if each else Entry(MISSING)
                           for text, each in zip(texts, best)),
                         *(Entry(str(ratio or MISSING)) for ratio in ratios(best))])
        blocks.append(rows)
    return Table(columns, blocks)


def structures_section(study):
    """Shows the cheapest integrator of each structure kept at each error, and what the stronger structure costs."""
    choices = {f"keeps {kept}": keeping(study, structure) for structure, kept in STRUCTURES.items()}
    return [Heading("What a structure costs at equal error"),
            Paragraph("The cheapest integrator, in its fast form, and its CPU seconds; marked: the cheapest of the row."
                      " †: its longest step that ran errs less than asked. Ratios of seconds, with their spread."),
            by_error(study, choices, ("Lie–Poisson over spectrum", "Lie–Poisson over neither"), lambda best: (
                ratio_of(best[0][1], other[1]) if best[0] and other else None for other in best[1:]))]


def prices_section(study):
    """Shows the best Gauss form over RKMK4's and RK4's best forms, by problem."""
    found = prices(study, study.problems())
    means = {other: means_by_problem(each) for other, each in found.items()}
    rows = [[str(problem), *(str(means[other].get(problem, MISSING)) for other in found)]
            for problem in study.problems()]
    headline = set(headline_problems(study))
    overall = {other: mean([ratio for (problem, _), ratio in each.items() if problem in headline])
               for other, each in found.items()}
    rows.append(["smooth, T = 5, every n", *(str(each or MISSING) for each in overall.values())])
    return [Heading("The price of structure"),
            Paragraph(f"The best Gauss form's time over the other method's best form, 1e{MEAN_EXPONENTS[0]} to"
                      f" 1e{MEAN_EXPONENTS[-1]}, each error that both lines enclose."),
            plain_table((Column("problem", align="left"), Column("over rkmk4"), Column("over rk4")), rows)]


def orders_section(study):
    """Shows the cheapest Gauss form of each order at each error, the cheapest order marked."""
    choices = {}
    for name in forms_of(study, "gauss"):
        choices.setdefault(f"order {2 * gauss_stages(frameless(name))}", []).append(name)
    return [Heading("Which order pays"),
            Paragraph("The cheapest form of the Gauss method of each order, in the frame or not, and its CPU seconds, as"
                      f' above. "{MISSING}": no two neighbouring runs enclose the error.'),
            by_error(study, dict(sorted(choices.items(), key=lambda each: int(each[0].split()[1]))))]


def gains_section(study):
    """Shows what the co-rotating frame and the fast forms divide the time at equal error by."""
    parts = []
    for heading, text, gains in (
            ("What the co-rotating frame buys", "Time without the frame over time in it", frame_gains),
            ("What the fast forms buy", "Time of the published form over that of the fast form", published_gains)):
        found = {name: means_by_problem(each) for name, each in gains(study, study.problems()).items() if each}
        problems = [problem for problem in study.problems() if any(problem in each for each in found.values())]
        where = f"at equal error, 1e{MEAN_EXPONENTS[0]} to 1e{MEAN_EXPONENTS[-1]}"
        parts += by_problem(study, heading, f"{text}, {where}.", found,
                            lambda problem, name, found=found: two_digits(found[name][problem].value)
                            if problem in found[name] else MISSING, problems=problems)
    return parts


def care_section(study):
    """Shows what each fast form spends its time on, at one problem and near one error."""
    problem = next((each for each in reversed(headline_problems(study)) if each.n <= CARE_SIZE), None)
    rate = problem and study.rates.get(problem.n)
    rows = []
    for name in study.integrators if rate else ():
        runs = [run for run in study.above_floor(problem, name) if not run.beyond_limit]
        if not runs:
            continue
        run = min(runs, key=lambda each: abs(scale(each.error) - scale(CARE_ERROR)))
        published = study.at_step(problem, name, run.step, PUBLISHED)
        family = max((each for each in CARE if name.startswith(each)), key=len, default=None)
        rows.append([name, three_digits(run.step), scientific(run.error), three_digits(run.seconds),
                     f"{run.equivalent_products:.0f}", percentage(run.equivalent_products / rate.fast / run.seconds),
                     three_digits(published.seconds / run.seconds) if published and published.usable else MISSING,
                     CARE.get(family, MISSING)])
    columns = (Column("integrator", align="left"), *map(Column, (
        "step", "error", "CPU seconds", "equivalent products", "product share", "published over fast")),
               Column("what makes it fast", align="left"))
    return [Heading("Equal care"),
            Paragraph(f"{problem}, the run nearest to {CARE_ERROR:g}. Product share: the time of its products, at the"
                      " rate of products alone, over all its time; bands and triangles count as the part that they are."),
            plain_table(columns, rows)] if rows else []


def scale(error):
    return math.log(error)


# ---- each integrator


def integrators_section(study):
    def order(problem, name):
        observed = study.observed_order(problem, name)
        return f"{observed:.2f}" if observed else MISSING

    return by_problem(
        study, "What each integrator is, and its observed order",
        "The order is fitted on the last points above the floor; – where fewer than three are.", study.integrators,
        order, (("order", lambda each: str(each.order)), ("keeps", lambda each: KEEPS[strongest(each)]),
         ("symmetric", lambda each: "yes" if each.symmetric else "no"),
         ("explicit", lambda each: "yes" if each.explicit else "no")))


def fixed_step_section(study):
    def error_at(problem, name):
        run = study.at_step(problem, name, TABLE1_STEP)
        if run is None:
            return MISSING
        return scientific(run.error) if run.usable else run.status

    return by_problem(study, f"Error at h = {TABLE1_STEP}", "The step size of Table 1. What a method did instead of"
                      " converging is named.", study.integrators, error_at)


def tolerance_section(study):
    """Shows for each cell the loosest tolerance that hardly adds to its error, and what it saves."""
    rows = [[str(loosest.n), loosest.formulation, str(loosest.stages), loosest.solver, scientific(error),
             f"{loosest.tolerance:.0e}", f"{loosest.sweeps}/{usual.sweeps}",
             three_digits(loosest.seconds / usual.seconds), scientific(loosest.spectrum_error)]
            for loosest, usual, error in sorted(loosest_tolerances(study), key=lambda each: (
                each[0].n, FORMULATIONS.index(each[0].formulation), each[0].stages))]
    if not rows:
        return []
    columns = (Column("n"), Column("formulation", align="left"), Column("s"), Column("form", align="left"),
               Column(f"error at h = {TABLE1_STEP}"), Column("loosest tolerance"), Column("sweeps against 1e-13"),
               Column("time against 1e-13"), Column("spectrum error there"))
    failed = sum(not run.usable for run in study.tolerance_runs)
    return [Heading("Which tolerance an accuracy needs"),
            Paragraph("The loosest tolerance of the fixed point that adds less than a tenth to the error which the step"
                      f" size makes, and so do all tighter ones. {failed} of {len(study.tolerance_runs)} runs did not"
                      " converge."),
            plain_table(columns, rows)]


def limits_section(study):
    places = [problem for problem in study.problems()
              if any((problem.scene, problem.n) == key[:2] for key in study.limits)]
    places = list({(each.scene, each.n): each for each in reversed(places)}.values())[::-1]

    def limit(problem, name):
        found = study.limits.get((problem.scene, problem.n, name, FAST))
        return MISSING if found is None else three_digits(found.h_norm_B) if found.h_norm_B else "none"

    return by_problem(study, "Steps that work", "The largest h‖B(W₀)‖₂ that works in every trial up to it, fast forms;"
                      " none: the first trial failed.", study.integrators if places else (), limit, problems=places,
                      group=lambda problem: f"{problem.scene} scene")


def failures_section(study):
    """Names every line with a run that failed or is beyond its limit: who hides failures recommends them."""
    rows = []
    for problem in study.problems():
        for solver in (FAST, PUBLISHED):
            found = []
            for name in study.integrators:
                bad = [run for run in study.line(problem, name, solver) if not run.usable or run.beyond_limit]
                if bad:
                    how = dict.fromkeys("beyond its limit" if run.usable else run.status for run in reversed(bad))
                    found.append(f"{name} {three_digits(bad[-1].step)} {', '.join(how)}")
            if found:
                rows.append([str(problem), solver, "; ".join(found)])
    columns = (Column("problem", align="left"), Column("form", align="left"),
               Column("smallest step that failed, and how this and longer ones did", align="left"))
    return [Heading("Runs that failed"),
            Paragraph(f"{sum(not run.usable for run in study.runs)} of {len(study.runs)} runs. A step beyond the"
                      " stability limit may come to an end because T is short; such a run is never recommended."),
            plain_table(columns, rows)]
