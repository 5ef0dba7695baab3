"""Draws a study of accuracy as charts."""

import itertools
import math

from matplotlib.ticker import LogLocator, NullFormatter

from lib.records.integrators import MAGNUS, chosen, is_new, short_name, strongest_structure
from lib.records.settings import ENERGY_BOUNDED, LOOSE_EXPONENTIAL, TABLE1_STEP, keeping_tolerance, keeps
from lib.pages.chart_panels import (BLACK, EXPONENTIAL_RED, FAMILY_COLOURS, GROUP, LINES, cross, draw_line, equals,
                                    extended, label_ends, label_sizes, logarithmic, look, new_figure, note)
from lib.pages.numbers import power, span, two_digits
from studies.accuracy.candidates import CLASSES, EXPLICIT
from studies.accuracy.equal_error import HEADLINE, beaten_by, headline_problems, ratio_in, runs_at_table1_step
from studies.accuracy.schema import CUT, GOOD_ENOUGH, OTHER, Form

ERROR_LABEL = "relative error of W(T)"
SECONDS_LABEL = "CPU seconds"
DUEL_ERROR, DUEL_ERROR_WORD = 1e-6, "1e-6"  # of the titles and of time_against_n
EXPONENTIAL = "exponential Lie–Poisson"
ERROR_TICKS = (1, 1e-3, 1e-6, 1e-9)  # of an axis of errors
MARGIN = 0.15  # decades beyond the lines
ROOM_FOR_LABELS = 4  # above the lines of time_against_n, whose labels are spread upwards from the highest

# The lines of the work–precision diagram, in the frame if it was run there. Those of new integrators are added.
WORK_PRECISION = (Form("group2"), Form("group4"), Form("elp6", ENERGY_BOUNDED), Form("elp6", LOOSE_EXPONENTIAL),
                  Form("magnus5", LOOSE_EXPONENTIAL), Form("rk4"), Form("rk8"))
WORK_PRECISION_OF = ("smooth", 50.0)
SIZES = (17, 65, 129)
CUT_MARK = {"marker": ">", "markersize": 8, "markerfacecolor": "white", "zorder": 5, "linestyle": "none"}

# The lines of time_against_n: a class of methods, its colour and how it is drawn.
POISSON, SPECTRUM, NOTHING = ({"linestyle": LINES[each]} for each in ("poisson", "spectrum", "nothing"))
DRAWN = {
    "gauss": (GROUP, {**POISSON, "linewidth": 2.4, "marker": "s"}),
    "elp_bounded": (EXPONENTIAL_RED, {**POISSON, "linewidth": 2.4, "marker": "D"}),
    "elp": (EXPONENTIAL_RED, {**SPECTRUM, "marker": "D", "markerfacecolor": "white"}),
    "magnus": (FAMILY_COLOURS[MAGNUS][0], {**SPECTRUM, "marker": "v"}),
    "projected": ("0.45", {**SPECTRUM, "marker": "^"}),
    "rk4": ("0.45", {**NOTHING, "marker": "o", "markerfacecolor": "white"}),
    "explicit": (BLACK, {**NOTHING, "linewidth": 2.4, "marker": "o"}),
    OTHER: ("#c06a28", {**NOTHING, "linestyle": "-.", "marker": "P"})}

# The lines of error_against_n, not in the frame, at the tight tolerance; those with words are told in the title. Those
# of new integrators are added.
AGAINST_N = {"group1": None, "group2": "the Gauss method of order 4", "elp4": "the exponential method of order 4",
             "elp6": None, "rkmk4": "RKMK4", "rk4": None, "rk8": None}
GROWS = 10  # a factor beyond which the title says that an error depends on n


# ---- work–precision diagram


def error_against_time(study):
    """Draws the CPU seconds of errors: a panel for each of up to three n, smooth scene to T = 50, or else to T = 5.

    Lines are drawn above their floors, and broken at failures and limits. None if there are none.
    """
    forms = forms_to_draw(study)
    lines = {problem: {form: drawn for form in forms if (drawn := visible(study, problem, form))}
             for problem in problems_to_draw(study)}
    lines = {problem: drawn for problem, drawn in lines.items() if drawn}
    if not lines:
        return None
    figure, (panels,) = new_figure(price_title(study, lines), 1, len(lines), 5.2, keys=2,
                                   labels=[label_of(study, form) for form in forms])
    spans = {problem: span_of([seconds for line in drawn.values() for _, seconds in line])
             for problem, drawn in lines.items()}
    decades = max(high - low for low, high in spans.values()) + 2 * MARGIN
    most = max(error for drawn in lines.values() for line in drawn.values() for error, _ in line)
    for axes, (problem, drawn) in zip(panels, lines.items()):
        logarithmic(axes)
        axes.yaxis.set_minor_locator(LogLocator(subs=range(2, 10), numticks=12))
        axes.yaxis.set_minor_formatter(NullFormatter())
        low, high = spans[problem]
        axes.set(title=f"n = {problem.n}", xlabel=ERROR_LABEL, xticks=ERROR_TICKS,
                 xlim=(10 ** math.ceil(math.log10(most)), GOOD_ENOUGH),
                 ylim=[10 ** ((low + high + sign * decades) / 2) for sign in (-1, 1)])
        axes.axvline(DUEL_ERROR, color="0.6", linewidth=0.9, zorder=1, label="_duels")
        for form, line in drawn.items():
            draw_form(axes, study, problem, form)
        label_ends(axes, [(line[-1], label_of(study, form), style_of(study, form)["color"])
                          for form, line in drawn.items()])
    panels[0].set_ylabel(SECONDS_LABEL)
    note(figure, f"Smooth scene to T = {next(iter(lines)).time:g}. In the co-rotating frame; tolerance 1e-13, of"
         " Magnus methods 1e-8, unless said; numbers are orders. Solid: keeps the Lie–Poisson structure; dashed:"
         " the spectrum only; dotted: nothing. Open triangle: the line was cut, as the next run would take too long.")
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
    """Returns the short name of a Form, with what the note under the panels does not say of it."""
    integrator = study.integrators[form.integrator]
    loose = form.tolerance > keeping_tolerance(integrator, strongest_structure(integrator))
    frame = "" if integrator.co_rotating else ", no frame"
    return short_name(integrator) + (f", {power(form.tolerance)}" if loose else "") + frame


def style_of(study, form):
    """Returns how the line of a Form is drawn: by what it keeps at its tolerance."""
    integrator = study.integrators[form.integrator]
    return {**look(integrator),
            "linestyle": next(LINES[each] for each in LINES if keeps(integrator, form.tolerance, each))}


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
    """Draws a line, with a mark at its end if it was cut."""
    style = style_of(study, form)
    stretches = study.stretches(problem, *form)
    for stretch in stretches:
        draw_line(axes, f"{form.integrator} at {form.tolerance:g}", points_of(stretch), **style)
    if study.ends[(problem, *form)] == CUT:
        axes.plot(*points_of(stretches[-1])[-1], **{**CUT_MARK, "color": style["color"], "label": "_cut"})


def span_of(values):
    """Returns the logarithms of the least and the largest value."""
    return math.log10(min(values)), math.log10(max(values))


def price_title(study, problems):
    """Returns what structure costs against the best explicit method, at the largest n that has a duel with it."""
    for problem in reversed(list(problems)):
        duel = study.duel(problem, DUEL_ERROR)
        told = [(words, ratio) for words, contender in (
            (f"{EXPONENTIAL} methods with bounded energy", "elp_bounded"), ("Gauss methods", "gauss"))
            if (ratio := written_ratio(duel, contender, EXPLICIT))]
        if told:
            (words, ratio), *others = told
            return (f"What structure costs: at {equals('n', problem.n)} and error {DUEL_ERROR_WORD} {words} take"
                    f" {as_long(ratio)} as the best explicit method"
                    + "".join(f", {words} {as_long(ratio)}" for words, ratio in others))
    return "What structure costs: CPU seconds of errors"


def written_ratio(duel, first, second):
    """Returns the time of a contender over another's in a duel as text; None where one has no row."""
    found = ratio_in(duel, first, second)
    return found and two_digits(found[0].ratio)


def as_long(ratio):
    """Returns how long one takes as another, from a written ratio: "12 times as long", for 1 "as long"."""
    return "as long" if ratio == "1" else f"{ratio} times as long"


# ---- time against n


def time_against_n(study):
    """Draws the CPU seconds of duels at DUEL_ERROR against n: a panel for each scene and time.

    The main problem, whose runs are of few steps, has one only where there is no other. A line for each class of
    methods, broken where a duel has no row of it. None if there are no such duels.
    """
    scenes = dict.fromkeys(problem[:2] for problem in study.problems())
    lines = {scene: drawn for scene in scenes if (drawn := lines_of_duels(study, scene))}
    if len(lines) > 1:
        lines.pop(HEADLINE, None)
    if not lines:
        return None
    figure, (panels,) = new_figure(trend_title(study, lines), 1, len(lines), 5.2, keys=2, sharex=True, sharey=True,
                                   labels=[CLASSES[each].label for each in DRAWN])
    for axes, ((scene, time), drawn) in zip(panels, lines.items()):
        logarithmic(axes)
        axes.set(title=f"{scene} scene, T = {time:g}", xlabel="n")
        for each, stretches in drawn:
            colour, style = DRAWN[each]
            for stretch in stretches:
                draw_line(axes, CLASSES[each].label, stretch, color=colour, **style)
    panels[0].set_ylabel(f"{SECONDS_LABEL} to an error of {DUEL_ERROR_WORD}")
    sizes = {n for drawn in lines.values() for _, stretches in drawn for stretch in stretches for n, _ in stretch}
    label_sizes(panels, sizes)
    panels[0].set_ylim(top=ROOM_FOR_LABELS * panels[0].get_ylim()[1])
    for axes, drawn in zip(panels, lines.values()):
        largest = max(stretches[-1][-1][0] for _, stretches in drawn)
        label_ends(axes, [(extended(stretches[-1], largest), CLASSES[each].label, DRAWN[each][0])
                          for each, stretches in drawn])
    note(figure, "The methods ran in turns, in fresh processes and in the co-rotating frame, with the steps that reach"
         " the error with least work. Exponential methods keep their energy bounded at the tolerance"
         f" {power(ENERGY_BOUNDED)}, and let it drift at {power(LOOSE_EXPONENTIAL)}. Solid: keeps the Lie–Poisson"
         " structure; dashed: the spectrum only; dotted: nothing.")
    return figure


def lines_of_duels(study, scene):
    """Returns (class, its stretches of (n, seconds)) for each of DRAWN that has rows in a scene to a time."""
    duels = {problem.n: duel for problem in study.problems() if problem[:2] == scene
             and (duel := study.duel(problem, DUEL_ERROR))}
    found = []
    for each in DRAWN:
        stretches = unbroken([(n, duel[each].seconds if each in duel else None) for n, duel in duels.items()])
        found += [(each, stretches)] if stretches else []
    return found


def unbroken(points):
    """Returns points as lists of neighbours, parted where a value is None."""
    groups = itertools.groupby(points, lambda point: point[1] is not None)
    return [list(group) for good, group in groups if good]


def trend_title(study, scenes):
    """Returns in how many of the duels drawn no class is faster than the best explicit method, and how many times as
    long methods with structure take."""
    duels = [duel for problem in study.problems() if problem[:2] in scenes and (
        duel := study.duel(problem, DUEL_ERROR)) and EXPLICIT in duel]
    if not duels:
        return f"CPU seconds to an error of {DUEL_ERROR_WORD}, by class of methods"
    title = (f"In {sum(not beaten_by(duel) for duel in duels)} of {len(duels)} cases no class is faster than the best"
             " explicit method")
    for words, contender in (("exponential methods with bounded energy", "elp_bounded"), ("Gauss methods", "gauss")):
        ratios = [found[0].ratio for duel in duels if (found := ratio_in(duel, contender, EXPLICIT))]
        title += f"; {words} take {span(ratios)} times its time" if ratios else ""
    return title


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
    labels = {name: short_name(study.integrators[name]) for name in lines}
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
        ends.append((extended(stretch, sizes[-1]), labels[name], style["color"]))
    label_ends(axes, ends)
    note(figure, "Smooth scene to T = 5, not in the co-rotating frame, tolerance 1e-13; numbers are orders. Solid:"
         " keeps the Lie–Poisson structure; dashed: the spectrum only; dotted: nothing. Cross: at the next n the step"
         " fails, or is beyond the method's stability limit.")
    return figure


def fails_after(study, name, n):
    """Tells whether Table 1's step was tried at the next n, and is not among the runs that work."""
    problem = next((problem for problem in headline_problems(study) if problem.n > n), None)
    run = problem and study.at_step(problem, name, TABLE1_STEP)
    return bool(run) and (not run.usable or run.beyond_limit)


def growth_title(lines):
    """Returns by how much the error changes from the least to the largest n of the methods that AGAINST_N tells of."""
    told = {name: runs for name, runs in lines.items() if AGAINST_N.get(name)}
    common = set.intersection(*map(set, told.values())) if told else set()
    if len(common) < 2:
        return f"Error of one step size, h = {TABLE1_STEP}, against n"
    growth = {name: runs[max(common)].error / runs[min(common)].error for name, runs in told.items()}
    message = "One step size is not one accuracy" if max(growth.values()) > GROWS else "The error of one step size"
    factors = [f"by {two_digits(factor)} for {AGAINST_N[name]}" for name, factor in growth.items()]
    return (f"{message}: from {equals('n', min(common))} to {equals('n', max(common))} the error at"
            f" {equals('h', TABLE1_STEP)} is multiplied"
            f" {', '.join(factors[:-1])}{' and ' * (len(factors) > 1)}{factors[-1]}")
