"""Draws the comparisons at equal error of the study of accuracy, a line for each class of methods.

A case is an error of a problem at which classes of methods were timed.
"""

from typing import Dict, NamedTuple

from matplotlib.ticker import NullLocator

from studies.accuracy.schema import CANDIDATES, OTHER
from lib.records.settings import ENERGY_BOUNDED, LOOSE_EXPONENTIAL
from lib.pages.chart_panels import (FAMILY_COLOURS, FORMULATION_COLOURS, KEEPING, LABEL_SIZE, LINES, LOOSE_LIGHTER,
                                    PROJECTED, draw_line, label_ends, label_sizes, logarithmic, mixed, new_figure, note,
                                    percent, tie_band, unbroken)
from studies.accuracy.candidates import CLASSES, EXPLICIT
from studies.accuracy.equal_error import HEADLINE, beaten_by, comparison_errors, ratio_in
from lib.records.formats import FAST
from lib.records.integrators import EXPONENTIAL, MAGNUS, RUNGE_KUTTA
from lib.pages.numbers import power, span
from lib.judging.verdicts import MARGIN

ERROR, ERROR_WORD = 1e-6, "1e-6"  # of time_against_n
TIMES = (1, 1.5, 2, 3, 5, 7, 10, 15, 20, 30, 50, 100)  # ticks of ratios of times
TOLD_FACTORS = (2, 5)  # in the key of the profile, and the last in its title
MARKED = (0.25, 0.5, 0.75)  # shares near which a line of the profile carries its mark
TOLD = {"elp": "exponential methods at 1e-8", "elp_bounded": "at 1e-13", "gauss": "Gauss methods"}  # in its title
POISSON, SPECTRUM, NOTHING = ({"linestyle": LINES[each]} for each in ("poisson", "spectrum", "nothing"))
BLACK, GREY = "#000000", FAMILY_COLOURS[RUNGE_KUTTA][0]
RED, LIGHT_RED = (mixed(FAMILY_COLOURS[EXPONENTIAL][0], "white", share) for share in (0, LOOSE_LIGHTER))
# The classes that are drawn, each with its colour and style.
DRAWN = {
    "gauss": (FORMULATION_COLOURS["group"][0], {**POISSON, "linewidth": 2.4, "marker": "s"}),
    "elp_bounded": (RED, {**POISSON, "linewidth": 2.4, "marker": "D"}),
    "elp": (LIGHT_RED, {**SPECTRUM, "marker": "D", "markerfacecolor": "white"}),
    "magnus": (FAMILY_COLOURS[MAGNUS][0], {**SPECTRUM, "marker": "v"}),
    "projected": (PROJECTED[0], {**SPECTRUM, "marker": "^"}),
    "rk4": (GREY, {**NOTHING, "marker": "o", "markerfacecolor": "white"}),
    "explicit": (BLACK, {**NOTHING, "linewidth": 2.4, "marker": "o"}),
    OTHER: ("#1f9e9e", {"linestyle": "-.", "marker": "P"})}
TOLERANCES = (f"Exponential methods keep their energy bounded at the tolerance {power(ENERGY_BOUNDED)}, and let it"
              f" drift at {power(LOOSE_EXPONENTIAL)}.")


def name_of(candidate):
    """Returns what charts call a class: the one of a single method as that method."""
    return "rk4" if candidate == "rk4" else CLASSES[candidate].label


def write_ratios(axis, low, high):
    """Gives an axis of ratios of times those of TIMES between its ends as ticks."""
    ticks = [ratio for ratio in TIMES if low <= ratio <= high]
    axis.set_ticks(ticks, list(map("{:g}".format, ticks)))


# ---- time against n


def time_against_n(study):
    """Draws the time of classes over that of the best explicit method at ERROR against n, a panel a scene and time.

    The main problem, whose runs are of few steps, has one only where there is no other. A line is broken where the
    class has no row; bars are 95 % intervals. None if nothing is compared with the best explicit method.
    """
    scenes = dict.fromkeys(problem[:2] for problem in study.problems())
    lines = {scene: drawn for scene in scenes if (drawn := ratios_in_scene(study, scene))}
    if len(lines) > 1:
        lines.pop(HEADLINE, None)
    if not lines:
        return None
    labelled = labels_by_scene(lines)
    *inner, last = ([name_of(each) for each in found] for found in labelled.values())
    figure, (panels,) = new_figure(trend_title(study, lines), 1, len(lines), 5.2, keys=3, sharex=True, sharey=True,
                                   labels=sum(inner, []), last_labels=last)
    for axes, ((scene, time), drawn) in zip(panels, lines.items()):
        logarithmic(axes)
        tie_band(axes)
        axes.set(title=f"{scene} scene, T = {time:g}", xlabel="n")
        for each, points in drawn.items():
            colour, style = DRAWN[each]
            for stretch in unbroken(points):
                draw_line(axes, name_of(each), [(n, found.ratio) for n, found in stretch], color=colour, **style)
                for n, found in stretch:
                    if found.low > 0:  # enough processes for an interval
                        axes.vlines(n, found.low, found.high, color=colour, linewidth=1)
    every = [found.ratio for drawn in lines.values() for points in drawn.values() for _, found in points if found]
    panels[0].set(ylabel=f"time over that of the best explicit method, error {ERROR_WORD}",
                  ylim=(min(every) / 1.15, max(every) * 1.15))
    write_ratios(panels[0].yaxis, *panels[0].get_ylim())
    label_sizes(panels, {n for drawn in lines.values() for points in drawn.values() for n, _ in points})
    for axes, drawn, names in zip(panels, lines.values(), labelled.values()):
        ends = {each: unbroken(drawn[each])[-1][-1] for each in names}
        if ends:
            label_ends(axes, [((n, found.ratio), name_of(each), DRAWN[each][0]) for each, (n, found) in ends.items()])
    note(figure, "CPU time of whole runs, interleaved in fresh processes, in the co-rotating frame, with the steps that"
         " reach the error with least work. Bars: 95 % intervals. A line ends where no method of its class was timed."
         f" Grey: a tie, within {percent(MARGIN - 1)}. {TOLERANCES} {KEEPING}", study.context)
    return figure


def ratios_in_scene(study, scene):
    """Returns for each of DRAWN that has rows in a scene to a time its points (n, Ratio or None), n rising."""
    cases = {problem.n: rows for problem in study.problems() if problem[:2] == scene
             and (rows := study.comparison(problem, ERROR)) and EXPLICIT in rows}
    found = {each: [(n, over[0] if (over := ratio_in(rows, each, EXPLICIT)) else None) for n, rows in cases.items()]
             for each in DRAWN}
    return {each: points for each, points in found.items() if any(over for _, over in points)}


def labels_by_scene(lines):
    """Returns the classes that are labelled in each panel: every one in the last panel that has it."""
    last = {each: scene for scene, drawn in lines.items() for each in drawn}
    return {scene: [each for each in drawn if last[each] == scene] for scene, drawn in lines.items()}


def trend_title(study, scenes):
    """Returns in how many of the cases drawn no class is faster than the best explicit method, and how many times as
    long methods with structure take."""
    cases = [rows for problem in study.problems() if problem[:2] in scenes and (
        rows := study.comparison(problem, ERROR)) and EXPLICIT in rows]
    title = (f"In {sum(not beaten_by(rows) for rows in cases)} of {len(cases)} cases no class is faster than the best"
             " explicit method")
    for words, candidate in (("exponential methods with bounded energy", "elp_bounded"), ("Gauss methods", "gauss")):
        ratios = [found[0].ratio for rows in cases if (found := ratio_in(rows, candidate, EXPLICIT))]
        title += f"; {words} take {span(ratios)} times its time" if ratios else ""
    return title


# ---- performance profile


class Profile(NamedTuple):
    """How near classes of methods come to the cheapest, over all cases.

    Source: Dolan, Moré, Benchmarking optimization software with performance profiles, Mathematical Programming 91
    (2002).
    """

    factors: Dict[str, list]  # by class: its time over that of the cheapest method, rising, of the cases with a row
    cases: int

    def share(self, candidate, factor):
        """Returns the share of all cases that a class solves within a factor of the cheapest method's time."""
        return sum(each <= factor for each in self.factors[candidate]) / self.cases


def profile_of(study):
    """Returns the Profile of the classes of DRAWN; the cheapest method of a case may be of any class of fast forms."""
    factors = {each: [] for each in DRAWN}
    for rows in study.comparisons.values():
        cheapest = min((rows[each].seconds for each in CANDIDATES if each in rows and CLASSES[each].solver == FAST),
                       default=None)
        for each in factors:
            if each in rows:
                factors[each].append(rows[each].seconds / cheapest)
    return Profile({each: sorted(found) for each, found in factors.items() if found}, len(study.comparisons))


def performance_profile(study):
    """Draws the Profile: the share of cases that a class solves within a factor. None without two classes.

    The key names the classes from the cheapest on, with their shares within TOLD_FACTORS.
    """
    profile = profile_of(study)
    if len(profile.factors) < 2:
        return None
    order = sorted(profile.factors, key=lambda each: [-profile.share(each, factor)
                                                      for factor in (MARGIN, *TOLD_FACTORS)])
    labels = {each: key_text(profile, each) for each in order}
    figure, ((axes,),) = new_figure(profile_title(profile), 1, 1, 5.4, keys=3,
                                    labels=["line " + label for label in labels.values()])
    maximum = 1.1 * max(found[-1] for found in profile.factors.values())
    axes.set(xscale="log", xlim=(1, maximum), ylim=(0, 1.02), xlabel="factor over the time of the cheapest method",
             ylabel="share of cases that a class solves within the factor")
    axes.yaxis.set_major_formatter(lambda share, _: percent(share))
    axes.axvspan(1, MARGIN, color="0.9", linewidth=0, zorder=0, label="_tie")
    for each in order:
        found, (colour, style) = profile.factors[each], DRAWN[each]
        steps = [(factor, profile.share(each, factor)) for factor in (1.0, *found, maximum)]
        marked = [min(range(len(steps)), key=lambda k, share=share: abs(steps[k][1] - share)) for share in MARKED]
        axes.plot(*zip(*steps), label=labels[each], color=colour, drawstyle="steps-post", clip_on=False,
                  **{**style, "markevery": marked, "markersize": 6})
    axes.xaxis.set_minor_locator(NullLocator())
    write_ratios(axes.xaxis, 1, maximum)
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=LABEL_SIZE, labelspacing=0.9)
    problems = {problem for problem, _ in study.comparisons}
    errors = ", ".join(map(power, comparison_errors(study)))
    note(figure, f"{profile.cases} cases: {len(problems)} problems (scene, T, n), each at those of the errors {errors}"
         " that were compared. A class stands by its best method in each case, fast forms in the co-rotating frame. Its"
         f" line ends below {percent(1)} where it has no row in some case. Grey: a tie with the cheapest,"
         f" within {percent(MARGIN - 1)}. {TOLERANCES} {KEEPING}", study.context)
    return figure


def key_text(profile, candidate):
    """Returns the name of a class with its shares within TOLD_FACTORS."""
    shares = [f"{percent(profile.share(candidate, factor))} within {factor}" for factor in TOLD_FACTORS]
    return f"{name_of(candidate)}:\n{', '.join(shares)}"


def profile_title(profile):
    """Returns how often the best explicit method ties with the cheapest, and how often others come near it."""
    told = [f"{words} in {percent(profile.share(each, TOLD_FACTORS[-1]))}" for each, words in TOLD.items()
            if each in profile.factors]
    first = (f"the best explicit method is within {percent(MARGIN - 1)} of the cheapest in"
             f" {percent(profile.share(EXPLICIT, MARGIN))}"
             if EXPLICIT in profile.factors else "time over that of the cheapest method")
    within = f"; within a factor of {TOLD_FACTORS[-1]} come {', '.join(told)}" if told else ""
    return f"Of {profile.cases} cases {first}{within}"
