"""Where methods fail: from the study of limits, the critical step against n, and of one method every step tried."""

from lib.pages.integrate_line import integrate_line, start_of
from lib.records.formats import CONVERGED, SWEEP_CAP
from lib.records.integrators import chosen, name_with_order
from lib.records.settings import TIGHT, steps_to
from report_page.charts import Axis, Chart, Column, Option, Selector, as_plotly, look_of, options_of
from studies.limits.charts import DRAWN

CHIEF = "chief methods: the first step that fails"
LONGEST = "longest that survived a long trial"
# What became of a step, each with a mark of its own; a step that failed is black, or white on a dark page.
MARKS = {CONVERGED: "o", "diverged": "x", "stagnated": "D", SWEEP_CAP: "s", "not finite": "v", "spectrum lost": "^",
         "energy lost": "P"}
WORKS, FAILS, SURVIVED = "#1f67ad", "#222222", "#0b8a67"


def limits(study):
    """Returns the Chart of h‖B(W₀)‖₂ against n, from the initial data of each scene."""
    rows = [*critical_rows(study), *tried_rows(study)]
    views = options_of([CHIEF, *(view for view, *_ in rows if view != CHIEF)])
    forms = sorted({row[1][0] for row in rows})
    steps = [value / study.states[key[1], key[2], 0].norm_B for _, key, value, *_ in rows]
    counts = [steps_of(study, key, h) * (study.settings.longer if series == LONGEST else 1)
              for (_, key, _, series, _), h in zip(rows, steps)]
    return Chart(
        "limits", "h‖B(W₀)‖₂ of steps that work and fail, against n", Axis("n", "n", has_ticks=True),
        Axis("norm", "h‖B(W₀)‖₂"),
        {"integrator": Column("method", [key[3] for _, key, *_ in rows]),
         "form": Column("form", [key[0] for _, key, *_ in rows]),
         "n": Column("n", [key[2] for _, key, *_ in rows]),
         "norm": Column("h‖B(W₀)‖₂", [value for _, _, value, *_ in rows]),
         "step": Column("step h", steps),
         "outcome": Column("outcome", [outcome for *_, outcome in rows]),
         "scene": Column("", [key[1] for _, key, *_ in rows]),
         "view": Column("", [view for view, *_ in rows]),
         "series": Column("", [series for _, _, _, series, _ in rows])},
        (Selector("scene", "scene", options_of(study.scenes())),
         Selector("form", "form", tuple(Option(each, each) for each in forms)),
         Selector("view", "method", views)),
        looks_of(study),
        [integrate_line(start_of(key[1], key[2]), key[2], key[3], h, count * h, TIGHT, key[0])
         for (_, key, *_), h, count in zip(rows, steps, counts)],
        note="Each scene's own initial data; ‖B‖₂ is that of the flow without the co-rotating frame. Chief methods: the"
             " first step that fails in short runs (T = 5 at least), with how it fails. One method: every step that was"
             " tried, and the longest that survived ten times as many steps, which says nothing of its accuracy. A line"
             " ends where larger n were not tried.")


def steps_of(study, key, h):
    """Returns how many steps a short trial takes."""
    settings, integrator = study.settings, study.integrators[key[3]]
    fewest = settings.explicit_steps if integrator.explicit else settings.implicit_steps
    return max(fewest, steps_to(settings.time, h))


def critical_rows(study):
    """Returns (view, key, h‖B‖₂, series, outcome) of the first failing step of the chief methods."""
    forms = chosen(study.integrators.values(), DRAWN, in_frame=True)
    return [(CHIEF, key, limit.fails, name_with_order(forms[key[3]]), limit.fails_as)
            for key, line in sorted(study.lines.items(), key=lambda each: each[0][2])
            if key[3] in forms and (limit := line.limits[0]).fails]


def tried_rows(study):
    """Returns the same of every step that was tried from a scene's own initial data, and of survived ones."""
    rows = []
    for key, line in study.lines.items():
        trials = line.limits[0].trials(study.settings.grid_step)
        rows += [(key[3], key, value, outcome, outcome) for value, outcome in trials]
        if key in study.survived:
            rows.append((key[3], key, study.survived[key].works, LONGEST, "survived a long trial"))
    return rows


def looks_of(study):
    """Returns the looks of the chief methods, of outcomes, and of what survived."""
    forms = chosen(study.integrators.values(), DRAWN, in_frame=True)
    return {**{name_with_order(each): look_of(each, TIGHT) for each in forms.values()},
            **{outcome: as_plotly({"color": WORKS if outcome == CONVERGED else FAILS, "marker": mark,
                                   "markersize": 4.5}, joined=False) for outcome, mark in MARKS.items()},
            LONGEST: as_plotly({"color": SURVIVED, "linestyle": "--"})}
