"""Report and figures of the study `limits`."""

import statistics

from lib.comparison import MISSING, three_digits
from lib.document import Column, Heading, Paragraph, conditions, plain_table, shown
from lib.formats import FAST, PUBLISHED, SWEEP_CAP
from lib.limits_files import SCENES
from lib.numbers import span

CHARTS = {"limits": "Critical h‖B(W₀)‖₂ against n, published and fast forms.",
          "failure_map": "How steps of published `algebra1` end, smooth scene."}
CAP, ISLAND, NONE = "*", "°", "none"
# Whose critical steps pages may quote.
QUOTED = ("group1", "group2", "group3", "algebra1", "algebra2", "algebra3", "elp4", "elp6", "rkmk4", "magnus5",
          "rk4_projected", "rk4", "group2_frame", "group3_frame", "elp4_frame", "elp6_frame", "magnus5_frame",
          "rk4_frame")
FORMS = {PUBLISHED: "Published forms", FAST: "Fast forms"}


def sections(limits, charts):
    """Returns the report as a document; `charts` are the names of the charts beside it."""
    settings = limits.settings
    return [
        Heading("Up to which step methods work", 1),
        Paragraph(f"A trial lasts to T = {settings.time:g}, in {settings.implicit_steps} steps at least, of explicit"
                  f" methods {settings.explicit_steps}. It fails by its solver: diverged, stagnated, or sweep cap,"
                  " after a thousand sweeps. Or it converges and loses what is conserved: an entry is not finite, the"
                  " spectrum is off by more than 1e-6 where the method keeps it and by 0.1 elsewhere, or the energy by"
                  " more than a tenth. The critical step is the first failure on a grid of steps, each"
                  f" {settings.grid_step:.3g} times the one before, narrowed to {settings.close:.3g}. The safe step is"
                  f" the same to T = {settings.safe_time:g}, narrowed to {settings.safe_close:.3g}. It is the longest"
                  " step whose run survived, and promises neither accuracy nor a longer run. A long step gives both"
                  " trials the least number of steps, and then they are one run: only"
                  f" {sum(map(limits.is_longer, limits.safe))} of {len(limits.safe)} trials to"
                  f" T = {settings.safe_time:g} last longer."),
        Paragraph("Step sizes are given as h‖B(W₀)‖₂ of the flow without co-rotating frame, also for methods in the"
                  " frame; tables show the step that still works. A range is that over initial states: the scene's own"
                  " and drawn ones. Tolerance 1e-13."
                  f' "{CAP}": a state fails at the cap of sweeps, which sets the limit. "{ISLAND}": a longer step works'
                  f' again beyond a failure. "{NONE}": no step that was tried works. "{MISSING}": not tried.'),
        *shown(list(CHARTS.items()), charts),
        *safe_step_section(limits),
        *(part for solver in FORMS if limits.sizes(solver) for part in critical_sections(limits, solver)),
        *(part for solver in FORMS for part in safe_sections(limits, solver)),
        *coverage_section(limits),
        *states_section(limits),
        conditions(limits.context),
    ]


def critical_sections(limits, solver):
    parts = [Heading(f"{FORMS[solver]}: critical h‖B(W₀)‖₂")]
    sizes = limits.sizes(solver)
    for scene in limits.scenes():
        rows = []
        for name in limits.names(solver):
            lines = [limits.lines.get((solver, scene, n, name)) for n in sizes]
            if any(lines):
                ways = dict.fromkeys(way for line in lines if line for way in line.fails_as)
                rows.append([name, *map(range_text, lines), ", ".join(ways) or MISSING])
        columns = (Column("integrator", align="left"), *(Column(f"n = {n}") for n in sizes),
                   Column("fails as", align="left"))
        parts += [Heading(f"{scene.capitalize()} scene", 3), plain_table(columns, rows)]
    return parts


def range_text(line):
    """Returns the range of critical h‖B‖₂ over states, with its marks."""
    if line is None:
        return MISSING
    if line.least is None:
        return NONE
    return (span([line.least, line.largest], three_digits) + CAP * line.set_by_cap + ISLAND * line.has_island)


def safe_sections(limits, solver):
    """Returns the safe h‖B‖₂ of every integrator that has one: a column for each scene and n."""
    found = {key: safe for key, safe in limits.safe.items() if key[0] == solver}
    if not found:
        return []
    places = [(scene, n) for scene in SCENES for n in sorted({key[2] for key in found}) if
              any(key[1:3] == (scene, n) for key in found)]
    rows = []
    for name in limits.integrators:
        values = [found.get((solver, scene, n, name)) for scene, n in places]
        if any(values):
            rows.append([name, *(safe_text(each) for each in values)])
    columns = (Column("integrator", align="left"), *(Column(f"n = {n}", scene) for scene, n in places))
    return [Heading(f"{FORMS[solver]}: safe h‖B(W₀)‖₂"), plain_table(columns, rows)]


def safe_text(safe):
    if safe is None:
        return MISSING
    return three_digits(safe.works) + CAP * (safe.fails_as == SWEEP_CAP)


def safe_step_section(limits):
    """Returns the safe steps of fast forms as h, at the largest n that has them in every scene."""
    sizes = {n for solver, _, n, _ in limits.safe if solver == FAST
             and {scene for by, scene, at, _ in limits.safe if (by, at) == (FAST, n)} >= set(limits.scenes())}
    if not sizes:
        return []
    n = max(sizes)
    scenes = limits.scenes()
    rows = []
    for name in limits.integrators:
        steps = [safe_step(limits, FAST, scene, n, name) for scene in scenes]
        if any(steps):
            rows.append([name, *(three_digits(step) if step else MISSING for step in steps)])
    columns = (Column("integrator", align="left"), *(Column(scene, "h up to") for scene in scenes))
    return [Heading(f"Safe steps at n = {n}, fast forms"), plain_table(columns, rows)]


def safe_step(limits, solver, scene, n, name):
    """Returns the safe step h from a scene's own initial data, or None."""
    safe = limits.safe.get((solver, scene, n, name))
    return safe and safe.works / limits.states[scene, n, 0].norm_B


def coverage_section(limits):
    """Returns what was tried: for each solver, n and scene the integrators by how many states they have."""
    counts = {}
    for (solver, scene, n, _), line in limits.lines.items():
        place = counts.setdefault((solver, n, scene), {})
        place[len(line.limits)] = place.get(len(line.limits), 0) + 1
    safe = [(solver, n, scene) for solver, scene, n, _ in limits.safe]
    rows = [[solver, str(n), scene, str(integrators), str(states), str(safe.count((solver, n, scene)))]
            for (solver, n, scene), place in sorted(counts.items()) for states, integrators in sorted(place.items())]
    columns = (Column("forms", align="left"), Column("n"), Column("scene", align="left"), Column("integrators"),
               Column("states of each"), Column("safe steps in this scene"))
    return [Heading("What was tried"), plain_table(columns, rows)]


def states_section(limits):
    rows = [[state.scene, str(state.n), "own" if state.state == 0 else str(state.state), three_digits(state.norm_B),
             three_digits(state.norm_ad_B)] for state in limits.states.values()]
    return [Heading("Initial states"), plain_table((Column("scene", align="left"), Column("n"), Column("state"),
                                                    Column("‖B(W₀)‖₂"), Column("‖ad_B‖₂")), rows)]


def figures(limits):
    """Returns figures by key, such as critical.fast.smooth.group2.n65.least and safe_step.fast.smooth.group2.n65.

    Critical values are h‖B(W₀)‖₂, least and largest over the states of a scene, and theory is what linear theory has in
    their place; safe steps are h. Then counts, and the spread of a limit over states: largest over least, as its median
    over all lines of several states.
    """
    found = {}
    for (solver, scene, n, name), line in limits.lines.items():
        if name in QUOTED and line.least:
            key = f"critical.{solver}.{scene}.{name}.n{n}"
            found |= {f"{key}.least": line.least, f"{key}.largest": line.largest}
    found |= {f"theory.{scene}.{name}.n{n}": limit for (scene, n, name), limit in limits.theory.items()
              if name in QUOTED}
    for solver, scene, n, name in limits.safe:
        found[f"safe_step.{solver}.{scene}.{name}.n{n}"] = safe_step(limits, solver, scene, n, name)
    every = list(limits.lines.values())
    several = [line for line in every if len(line.limits) > 1 and all(limit.works for limit in line.limits)]
    counted = {"limits": sum(len(line.limits) for line in every), "lines": len(every),
               "lines_set_by_cap": sum(line.set_by_cap for line in every),
               "lines_with_island": sum(line.has_island for line in every),
               "lines_of_several_states": len(several), "own_state_within_drawn": sum(map(own_within_drawn, several)),
               "safe": len(limits.safe), "safe_below_critical": sum(map(falls, limits.safe_and_critical())),
               "safe_of_longer_runs": sum(map(limits.is_longer, limits.safe))}
    if several:
        spreads = [line.largest / line.least for line in several]
        found |= {"spread.median": statistics.median(spreads), "spread.largest": max(spreads)}
    return {**found, **counted}


def own_within_drawn(line):
    """Tells whether the limit of the scene's own state lies within the range of the drawn ones, to bisection."""
    own, *drawn = line.limits
    return min(each.works for each in drawn) <= own.fails and max(each.fails for each in drawn) >= own.works


def falls(pair):
    """Tells whether a safe step is below the critical one by more than bisection."""
    safe, critical = pair
    return safe.fails <= critical.works
