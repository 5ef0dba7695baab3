"""Draws a study of accuracy, and Tables 1 and 2, as charts."""

import math

from lib.accuracy_figures import AGAINST_N
from lib.accuracy_lines import NEAR_ROUNDING, TABLE1_STEP
from lib.chart_panels import FAMILIES, draw_line, handle, key, logarithmic, new_figure
from lib.equal_error import headline_problems, runs_at_table1_step
from lib.formats import FAST, FORMULATIONS, PUBLISHED
from lib.integrator_names import FRAME, KEPT, gauss_stages, in_frame, method_name, strongest_structure

ERROR_LABEL = "relative error of W(T)"
SECONDS_LABEL = "CPU seconds"
LEAST_ERROR, LEAST_ENERGY_ERROR = 1e-12, 1e-14  # where the axes end
LEAP = 1.6  # in seconds, from one level of an envelope to the next: a line of order 2 rises by 10^(1/8)

# One colour for each method, none of them a formulation's (chart_panels), and a mark at the end of its line.
METHODS = {**{f"Gauss, order {2 * s}": (colour, str(2 * s)) for s, colour in enumerate(
    ("#8fd3e8", "#58b4dd", "#2f93cf", "#2271b8", "#1f5a99", "#1b477b", "#16355d", "#102440"), 1)},
    "Yoshida, order 4": ("#b9b42d", "Y"), "Suzuki, order 4": ("#8f8a1c", "S"), "Kahan–Li, order 6": ("#5f5c10", "K"),
    "RKMK, order 4": ("#0b8a67", "RKMK4"), "Runge–Kutta, order 4": ("#000000", "RK4"),
    **{f"direct Gauss, order {order}": (colour, f"d{order}")
       for order, colour in ((2, "#e3a5c7"), (4, "#cf6aa3"), (6, "#a83a7c"))}}
ENVELOPES = {structure: {"color": colour, "linewidth": 5, "alpha": 0.4, "solid_capstyle": "round", "zorder": 3}
             for structure, colour in (("poisson", "#2f93cf"), ("spectrum", "#0b8a67"), ("nothing", "#444444"))}
PALE = {"linewidth": 0.6, "alpha": 0.45}  # a line not in the frame
GHOST = {"color": "0.72", "linewidth": 0.7, "linestyle": (0, (3, 2)), "zorder": 1}


# ---- work–precision diagrams


def error_against_time(study):
    """Draws a panel for each n of the smooth scene to T = 5, published forms as ghosts."""
    problems = headline_problems(study)
    return work_precision(study, problems, "error", "Error of W(T) against CPU time, smooth scene to T = 5",
                          ghosts=True)


def error_against_time_others(study):
    """Draws the two largest n of every other scene and time; None without any."""
    others = [problem for problem in study.problems() if problem not in headline_problems(study)]
    problems = [problem for problem in others
                if sum(each[:2] == problem[:2] and each.n > problem.n for each in others) < 2]
    title = "Error of W(T) against CPU time, other scenes and times"
    return work_precision(study, problems, "error", title) if problems else None


def energy_against_time(study):
    """Draws the energy error of the smooth scene at the largest n of each time."""
    largest = {problem.time: problem for problem in study.problems() if problem.scene == "smooth"}
    return work_precision(study, list(largest.values()), "energy_error", "Energy error against CPU time, smooth scene")


def work_precision(study, problems, quantity, title, ghosts=False):
    """Draws a panel for each problem: lines of methods thin, the envelope of each structure thick.

    A line is drawn above the floor of its error, and broken at failures and limits. All panels have equal decades.
    """
    columns = min(len(problems), 2)
    rows = -(-len(problems) // columns)
    label, least = (ERROR_LABEL, LEAST_ERROR) if quantity == "error" else ("energy error", LEAST_ENERGY_ERROR)
    figure, panels = new_figure(title, rows, columns, 5.2, keys=6, sharey=True)
    spans, marks, shown = [], [], set()
    for axes, problem in zip(panels.flat, problems):
        logarithmic(axes)
        axes.set(title=str(problem), xlabel=SECONDS_LABEL, ylabel=label, ylim=(least, 2))
        drawn = [draw_method(axes, study, problem, each, quantity) for each in drawn_integrators(study, problem)]
        for name in study.integrators if ghosts else ():
            for stretch in study.stretches(problem, name, PUBLISHED) if gauss_stages(name) else ():
                draw_line(axes, f"{name}, published", [(run.seconds, run.error) for run in stretch], **GHOST)
                shown.add(PUBLISHED)
        for structure, style in ENVELOPES.items():
            points = envelope([line for each, lines in drawn if strongest_structure(each) == structure
                               for line in lines], least)
            shown.update([structure] if draw_line(axes, structure, points, **style) else [])
        ends = {}
        for each, lines in sorted(drawn, key=lambda line: in_frame(line[0].name)):  # a mark stands at the last, in it
            points = [at for line in lines for at in line if at[1] >= least]
            shown.update([method_name(each), in_frame(each.name)] if points else [])
            ends.setdefault(method_name(each), []).extend(points)
        marks.append(ends)
        seconds = [math.log10(x) for points in ends.values() for x, _ in points] or [0]
        spans.append((min(seconds), max(seconds)))
    decades = max(high - low for low, high in spans) + 0.4
    for axes, (low, high), ends in zip(panels.flat, spans, marks):
        axes.set_xlim(*(10 ** ((low + high + sign * decades) / 2) for sign in (-1, 1)))
        mark_lines(axes, ends)
    for axes in panels.flat[len(problems):]:
        axes.remove()
    handles = {**{each: handle(f"best that keeps {KEPT[each]}", **style) for each, style in ENVELOPES.items()},
               True: handle("in the co-rotating frame", color="0.3", linewidth=1, marker="o", markersize=3),
               False: handle("not in it (pale)", color="0.3", **PALE),
               PUBLISHED: handle("Gauss, published forms", **GHOST),
               **method_handles()}
    key(figure, [each for what, each in handles.items() if what in shown], 6)
    return figure


def method_handles():
    return {name: handle(f"{mark}: {name}", color=colour) for name, (colour, mark) in METHODS.items()}


def draw_method(axes, study, problem, integrator, quantity):
    """Draws the stretches of a line, with markers if it is in the frame; returns the integrator and their points."""
    colour, _ = METHODS.get(method_name(integrator), ("0.5", None))
    framed = in_frame(integrator.name)
    lines = [draw_line(axes, integrator.name, [(run.seconds, getattr(run, quantity)) for run in stretch], color=colour,
                       marker="o" if framed or len(stretch) == 1 else None, markersize=2.2,
                       **({"linewidth": 1} if framed else PALE))
             for stretch in study.stretches(problem, integrator.name)]
    return integrator, list(filter(None, lines))


def mark_lines(axes, marks):
    """Writes the mark of each method beside its line, at the last of its points where no other mark stands."""
    taken = []
    to_share = axes.transAxes.inverted().transform
    for method, points in marks.items():
        colour, mark = METHODS.get(method, ("0.5", method))
        for point in reversed(points):
            x, y = to_share(axes.transData.transform(point))
            if all(abs(x - at_x) > 0.02 * (1 + max(len(mark), len(other))) or abs(y - at_y) > 0.035
                   for at_x, at_y, other in taken):
                taken.append((x, y, mark))
                axes.annotate(mark, point, xytext=(3, 1), textcoords="offset points", color=colour, zorder=6)
                break


def drawn_integrators(study, problem):
    """Returns of each method, in the frame and not, the form whose step is the cheapest."""
    cheapest = {}
    for name, each in study.integrators.items():
        seconds = min((run.seconds / run.steps for run in study.line(problem, name) if run.usable), default=math.inf)
        cheapest.setdefault((method_name(each), in_frame(name)), []).append((seconds, name))
    return [study.integrators[min(forms)[1]] for forms in cheapest.values()]


def envelope(lines, least, in_a_decade=4):
    """Returns the least seconds in which one of some lines has an error or a smaller one, interpolated along them.

    It ends where the cheapest line is at its floor and only dearer ones go on.
    """
    points, best = [], math.inf
    for step in range(round(-math.log10(least)) * in_a_decade, -1, -1):
        level = -step / in_a_decade
        for line in lines:
            logs = [(math.log10(x), math.log10(y)) for x, y in line]
            best = min((best, *(x + (level - y) / (next_y - y) * (next_x - x) if next_y != y else x
                                for (x, y), (next_x, next_y) in zip(logs, logs[1:]) if y >= level >= next_y),
                        *(x for x, y in logs[:1] if y <= level)))
        points += [(10**best, 10**level)] if best < math.inf else []
    ends = [index for index, ((dearer, error), (cheaper, _)) in enumerate(zip(points, points[1:]), 1)
            if error < NEAR_ROUNDING and dearer > LEAP * cheaper]
    return points[max(ends, default=0):]


# ---- the same step at every n


def error_against_n(study):
    """Draws the error at Table 1's step against n, and those of all steps, not in the frame, against h‖B(W₀)‖₂."""
    problems = headline_problems(study)
    figure, ((at_step, at_norm),) = new_figure("One step size is not one accuracy: error of W(5), smooth scene", 1, 2,
                                               5.2, keys=2, sharey=True)
    for axes in (at_step, at_norm):
        logarithmic(axes)
        axes.set_ylim(LEAST_ERROR, 2)
    at_step.set(title=f"at h = {TABLE1_STEP}", xlabel="n", ylabel=ERROR_LABEL)
    at_step.set_xticks([problem.n for problem in problems], [str(problem.n) for problem in problems])
    at_norm.set(title="every h, not in the frame; thicker: larger n", xlabel="h‖B(W₀)‖₂")
    methods = {}
    for name in (f"{each}{suffix}" for each in AGAINST_N for suffix in ("", FRAME)):
        if name not in study.integrators:
            continue
        method = method_name(study.integrators[name])
        colour, framed = METHODS[method][0], in_frame(name)
        points = draw_line(at_step, name, [(run.n, run.error) for run in runs_at_table1_step(study, name)], marker="o",
                           color=colour, linestyle="-" if framed else "--")
        methods.setdefault(method, []).extend(points)
        for index, problem in enumerate([] if framed else problems):
            for stretch in study.stretches(problem, name):
                draw_line(at_norm, f"{name}, n = {problem.n}", [(run.h_norm_B, run.error) for run in stretch],
                          linewidth=0.5 + 0.4 * index, color=colour)
    mark_lines(at_step, methods)
    key(figure, [*(each for method, each in method_handles().items() if method in methods),
                 handle("not in the frame", color="0.3", linestyle="--"),
                 handle("in the frame", color="0.3")], 2)
    return figure


# ---- Tables 1 and 2


def table1_accuracy(published, fast):
    """Draws each cell of a run of Table 1 as its time against its error, hollow, and of Table 2 filled.

    None where no cell has an error in both.
    """
    sides = {which: {key: cell for key, cell in run.measurements.items()
                     if cell.failure is None and cell.counters.get("relative_error", 0) > 0}
             for which, run in ((PUBLISHED, published), (FAST, fast))}
    if not sides[PUBLISHED].keys() & sides[FAST].keys():
        return None
    figure, ((axes,),) = new_figure("Table 1 with its accuracy: the fast forms give the same errors sooner", 1, 1, 6.5)
    logarithmic(axes)
    axes.set(xlabel=f"{SECONDS_LABEL} of 50 steps", ylabel="relative error of W(5)")
    axes.margins(x=0.12)
    same = {}
    for which, cells in sides.items():
        for cell_key, cell in sorted(cells.items()):
            colour, size = FAMILIES[cell_key.formulation]
            seconds, error = cell.seconds, cell.counters["relative_error"]
            axes.plot(seconds, error, marker="o", color=colour, markersize=size + 2,
                      markerfacecolor=colour if which == FAST else "none", linestyle="none",
                      label=f"{cell_key.formulation}{cell_key.stages}, n = {cell_key.n}, {which}")
            same.setdefault((cell_key.n, cell_key.stages), []).append((seconds, error))
    for (n, s), points in same.items():
        axes.plot(*zip(*sorted(points)), color="0.45", linestyle=":", zorder=1, label="_same answer")
        axes.annotate(f"n = {n}, s = {s}", max(points), xytext=(10, -4), textcoords="offset points")
    dot = {"color": "0.3", "marker": "o", "linestyle": "none"}
    key(figure, [*(handle(each, color=FAMILIES[each][0], marker="o", markersize=FAMILIES[each][1],
                          markerfacecolor="none", linestyle="none") for each in FORMULATIONS),
                 handle("published form", markerfacecolor="none", **dot), handle("fast form", **dot)])
    return figure
