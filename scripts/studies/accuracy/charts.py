"""Draws the lines of the study of accuracy: a work–precision diagram, and the error of one step size against n."""

import math

from matplotlib.ticker import LogLocator, NullFormatter

from studies.accuracy.schema import CUT, GOOD_ENOUGH, Form
from lib.records.settings import ENERGY_BOUNDED, LOOSE_EXPONENTIAL, TABLE1_STEP, keeping_tolerance
from lib.pages.chart_panels import (KEEPING, cross, draw_line, equals, label_ends, label_sizes, logarithmic, look,
                                    new_figure, note, unbroken)
from studies.accuracy.candidates import EXPLICIT
from studies.accuracy.equal_error import headline_problems, ratio_in, runs_at_table1_step
from lib.records.formats import FAST
from lib.records.integrators import chosen, is_new, name_with_order, strongest_structure
from lib.pages.numbers import power, two_digits

ERROR_LABEL = "relative error of W(T)"
SECONDS_LABEL = "CPU seconds"
TOLD_ERROR, TOLD_ERROR_WORD = 1e-6, "1e-6"  # of the title of error_against_time
ERROR_TICKS = (1, 1e-3, 1e-6, 1e-9)  # of an axis of errors
MARGIN = 0.15  # decades beyond the lines

# The lines of the work–precision diagram, in the frame if it was run there. Those of new integrators are added.
WORK_PRECISION = (Form("group4"), Form("elp4", ENERGY_BOUNDED), Form("elp6", LOOSE_EXPONENTIAL),
                  Form("magnus5", LOOSE_EXPONENTIAL), Form("rk4"), Form("rk8"))
WORK_PRECISION_OF = ("smooth", 50.0)
SIZES = (17, 65, 129)
CUT_MARK = {"marker": ">", "markersize": 8, "markerfacecolor": "white", "zorder": 5, "linestyle": "none"}

# The lines of error_against_n, not in the frame, at the tight tolerance. Those of new integrators are added.
AGAINST_N = ("group1", "group2", "elp4", "elp6", "rkmk4", "rk4", "rk8")
TOLD = ("group2", "elp4", "rkmk4")  # in its title
GROWS = 10  # a factor beyond which the title says that an error depends on n


# ---- work–precision diagram


def error_against_time(study):
    """Draws the CPU seconds of errors: a panel for each of up to three n, smooth scene to T = 50, or else to T = 5.

    Lines are drawn above their floors, and broken at failures and limits. Filled marks are the rows of the comparison
    at equal error that a method of a line has, which are what the title tells of. None if there are no lines.
    """
    forms = forms_to_draw(study)
    lines = {problem: {form: drawn for form in forms if (drawn := visible(study, problem, form))}
             for problem in problems_to_draw(study)}
    lines = {problem: drawn for problem, drawn in lines.items() if drawn}
    if not lines:
        return None
    figure, (panels,) = new_figure(price_title(study, lines), 1, len(lines), 5.2, keys=3,
                                   labels=[label_of(study, form) for form in forms])
    spans = {problem: span_of([seconds for line in drawn.values() for _, seconds in line])
             for problem, drawn in lines.items()}
    decades = max(high - low for low, high in spans.values()) + 2 * MARGIN
    maximum = max(error for drawn in lines.values() for line in drawn.values() for error, _ in line)
    for axes, (problem, drawn) in zip(panels, lines.items()):
        logarithmic(axes)
        axes.yaxis.set_minor_locator(LogLocator(subs=range(2, 10), numticks=12))
        axes.yaxis.set_minor_formatter(NullFormatter())
        low, high = spans[problem]
        axes.set(title=f"n = {problem.n}", xlabel=ERROR_LABEL, xticks=ERROR_TICKS,
                 xlim=(10 ** math.ceil(math.log10(maximum)), GOOD_ENOUGH),
                 ylim=[10 ** ((low + high + sign * decades) / 2) for sign in (-1, 1)])
        axes.axvline(TOLD_ERROR, color="0.6", linewidth=0.9, zorder=1, label="_told")
        for form in drawn:
            draw_form(axes, study, problem, form)
        label_ends(axes, [(line[-1], label_of(study, form), style_of(study, form)["color"])
                          for form, line in drawn.items()], in_one_column=True)
    panels[0].set_ylabel(SECONDS_LABEL)
    note(figure, f"Smooth scene to T = {next(iter(lines)).time:g}, in the co-rotating frame. Errors fall to the right."
         f" Tolerance 1e-13, or as said. {KEEPING} Filled marks: timed in fresh processes at the error"
         f" {TOLD_ERROR_WORD}. A line turns up at its left end where longer steps take more sweeps. Open triangle: the"
         " line was cut, as the next run would take too long.", study.context)
    return figure


def problems_to_draw(study):
    """Returns the problems with n of SIZES; without any, the smallest, the middle and the largest."""
    long = [problem for problem in study.problems() if problem[:2] == WORK_PRECISION_OF]
    problems = long or headline_problems(study)
    found = [problem for problem in problems if problem.n in SIZES]
    if found or not problems:
        return found
    return list(dict.fromkeys((problems[0], problems[len(problems) // 2], problems[-1])))


def forms_to_draw(study):
    """Returns those of WORK_PRECISION and of new integrators that have a line; out of the frame where none is in it."""
    problems, found = problems_to_draw(study), []
    drawn = {form for form in study.forms() if any(study.line(problem, *form) for problem in problems)}
    framed_first = sorted(study.integrators.values(), key=lambda each: not each.co_rotating)
    new = dict.fromkeys(each.method for each in framed_first if is_new(each))
    for method, tolerance in (*WORK_PRECISION, *map(Form, new)):
        own = [Form(each.name, tolerance) for each in framed_first if each.method == method]
        found += [form for form in own if form in drawn][:1]
    return found


def label_of(study, form):
    """Returns what the chart calls a Form: its method, its tolerance where that is loose or may be, "no frame"."""
    integrator = study.integrators[form.integrator]
    tight = keeping_tolerance(integrator, strongest_structure(integrator))
    several = tight < keeping_tolerance(integrator) or form.tolerance > tight
    frame = "" if integrator.co_rotating else ", no frame"
    return name_with_order(integrator) + (f", {power(form.tolerance)}" if several else "") + frame


def style_of(study, form):
    """Returns how the line of a Form is drawn."""
    return look(study.integrators[form.integrator], form.tolerance)


def points_of(stretch):
    return [(run.error, run.seconds) for run in stretch]


def visible(study, problem, form):
    """Returns the points of a line in its panel. A line that leaves the panel has a last point at its edge."""
    points = []
    for stretch in study.stretches(problem, *form):
        line = points_of(stretch)
        points += [point for point in line if point[0] >= GOOD_ENOUGH]
        points += [point_at_edge(*pair) for pair in zip(line, line[1:]) if pair[0][0] >= GOOD_ENOUGH > pair[1][0]]
    return points


def point_at_edge(before, after):
    """Returns the point with the error GOOD_ENOUGH between two points, on a line of the logarithms."""
    (error, seconds), (next_error, next_seconds) = before, after
    share = math.log(error / GOOD_ENOUGH) / math.log(error / next_error)
    return GOOD_ENOUGH, seconds ** (1 - share) * next_seconds ** share


def draw_form(axes, study, problem, form):
    """Draws a line, with a mark at its end if it was cut, and with the row that it has in the comparison."""
    style = style_of(study, form)
    stretches = study.stretches(problem, *form)
    for stretch in stretches:
        draw_line(axes, f"{form.integrator} at {form.tolerance:g}", points_of(stretch), **style)
    if study.ends[(problem, *form)] == CUT:
        axes.plot(*points_of(stretches[-1])[-1], **{**CUT_MARK, "color": style["color"], "label": "_cut"})
    for row in study.comparison(problem, TOLD_ERROR).values():
        if (row.integrator, row.solver, row.tolerance) == (form.integrator, FAST, form.tolerance):
            axes.plot(row.error, row.seconds, label="_timed", zorder=6,
                      **{**style, "linestyle": "none", "markerfacecolor": style["color"], "markersize": 7})


def span_of(values):
    """Returns the logarithms of the least and the largest value."""
    return math.log10(min(values)), math.log10(max(values))


def price_title(study, problems):
    """Returns what structure costs against the best explicit method, at the largest n where both were compared."""
    for problem in reversed(list(problems)):
        rows = study.comparison(problem, TOLD_ERROR)
        told = [(words, rows[candidate], ratio) for words, candidate in (("with bounded energy", "elp_bounded"),
                                                                        ("the best Gauss method", "gauss"))
                if (ratio := written_ratio(rows, candidate, EXPLICIT))]
        if told:
            (words, row, ratio), *others = told
            best = method_of(study, rows[EXPLICIT])
            return (f"What structure costs: at {equals('n', problem.n)} and error {TOLD_ERROR_WORD}"
                    f" {method_of(study, row)}, {words}, takes {as_long(ratio)} as {best}, the best explicit method"
                    + "".join(f"; {method_of(study, row)}, {words}, {as_long(ratio)}" for words, row, ratio in others))
    return "What structure costs: CPU seconds of errors"


def method_of(study, row):
    """Returns what charts call the method of a row of a comparison."""
    return name_with_order(study.integrators[row.integrator])


def written_ratio(rows, first, second):
    """Returns the time of a class over another's in a comparison as text; None where one has no row."""
    found = ratio_in(rows, first, second)
    return found and two_digits(found[0].ratio)


def as_long(ratio):
    """Returns how long one takes as another, from a written ratio: "12 times as long", for 1 "as long"."""
    return "as long" if ratio == "1" else f"{ratio} times as long"


# ---- the same step at every n


def error_against_n(study):
    """Draws the error at Table 1's step against n, smooth scene to T = 5. None without two n.

    A line is broken, and marked as failing, where the step fails or is beyond the integrator's limit.
    """
    sizes = [problem.n for problem in headline_problems(study)]
    lines = {name: {run.n: run for run in runs} for name in chosen(study.integrators.values(), AGAINST_N)
             if (runs := runs_at_table1_step(study, name))}
    if len({n for runs in lines.values() for n in runs}) < 2:
        return None
    labels = {name: name_with_order(study.integrators[name]) for name in lines}
    figure, ((axes,),) = new_figure(growth_title(lines), 1, 1, 5.2, keys=2, labels=labels.values())
    logarithmic(axes)
    axes.set(xlabel="n", ylabel=f"{ERROR_LABEL} at h = {TABLE1_STEP}")
    label_sizes([axes], sizes)
    ends = []
    for name, runs in lines.items():
        style = look(study.integrators[name])
        for stretch in unbroken([(n, runs[n].error if n in runs else None) for n in sizes]):
            draw_line(axes, name, stretch, **style)
            if fails_after(study, name, stretch[-1][0]):
                cross(axes, stretch[-1])
        ends.append((stretch[-1], labels[name], style["color"]))
    label_ends(axes, ends)
    note(figure, f"Smooth scene to T = 5, not in the co-rotating frame, tolerance 1e-13. {KEEPING} Cross: at the next n"
         " the step fails, or is beyond the method's stability limit. A fixed h is a growing h‖B‖.")
    return figure


def fails_after(study, name, n):
    """Tells whether Table 1's step was tried at the next n, and is not among the runs that work."""
    problem = next((problem for problem in headline_problems(study) if problem.n > n), None)
    run = problem and study.at_step(problem, name, TABLE1_STEP)
    return bool(run) and (not run.usable or run.beyond_limit)


def growth_title(lines):
    """Returns by how much the error changes from the least to the largest n of the methods of TOLD."""
    told = {name: lines[name] for name in TOLD if name in lines}
    common = set.intersection(*map(set, told.values())) if told else set()
    if len(common) < 2:
        return f"Error of one step size, h = {TABLE1_STEP}, against n"
    growth = {name: runs[max(common)].error / runs[min(common)].error for name, runs in told.items()}
    message = "One step size is not one accuracy" if max(growth.values()) > GROWS else "The error of one step size"
    factors = [f"by {two_digits(factor)} for {name}" for name, factor in growth.items()]
    return (f"{message}: from {equals('n', min(common))} to {equals('n', max(common))} the error at"
            f" {equals('h', TABLE1_STEP)} is multiplied"
            f" {', '.join(factors[:-1])}{' and ' * (len(factors) > 1)}{factors[-1]}")
