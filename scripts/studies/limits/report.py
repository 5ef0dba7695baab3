"""Report and figures of the study `limits`."""

from lib.records.formats import FAST, PUBLISHED, SWEEP_CAP
from lib.pages.document import Column, Heading, Paragraph, conditions, plain_table, shown
from lib.pages.numbers import MISSING, span, three_digits
from lib.pages.rendering import Rendering
from studies.limits.judge import figures, survived_step
from studies.limits.schema import SCENES, read_limits

CHART = "limits"
CAPTION = ("Critical h‖B(W₀)‖₂ against n, fast forms in the co-rotating frame, a panel for each scene. A line spans the"
           " n that were tried.")
CAP, ISLAND, NONE = "*", "°", "none"
FORMS = {PUBLISHED: "Published forms", FAST: "Fast forms"}


def sections(limits, charts):
    """Returns the report as a document; `charts` are the names of the charts beside it."""
    settings = limits.settings
    return [
        Heading("Up to which step methods work", 1),
        Paragraph(f"A short trial lasts to T = {settings.time:g}, in {settings.implicit_steps} steps at least, of"
                  f" explicit methods {settings.explicit_steps}. It fails by its solver: diverged, stagnated, or"
                  " sweep cap, after a thousand sweeps. Or it converges and loses what is conserved: an entry is not"
                  " finite, the spectrum is off by more than 1e-6 where the method keeps it and by 0.1 elsewhere, or"
                  " the energy by more than a tenth. The critical step is the first failure on a grid of steps, each"
                  f" {settings.grid_step:.3g} times the one before, narrowed to {settings.close:.3g}."),
        Paragraph(f"A long trial has {settings.longer} times the steps of the short one with the same step size, so it"
                  f" lasts to T = {settings.long_time:g} at least. The step that survived is the longest, up to the"
                  f" critical one, whose long trial did not fail, narrowed to {settings.long_close:.3g}. It promises"
                  " neither accuracy nor a longer run: the relative energy error at the end of that trial stands beside"
                  " it."),
        Paragraph("Step sizes are given as h‖B(W₀)‖₂ of the flow without co-rotating frame, also for methods in the"
                  " frame; tables show the step that still works. A range is that over initial states: the scene's own"
                  " and drawn ones. Tolerance 1e-13."
                  f' "{CAP}": a state fails at the cap of sweeps, which sets the limit. "{ISLAND}": a longer step works'
                  f' again beyond a failure. "{NONE}": no step that was tried works. "{MISSING}": not tried.'),
        *shown([(CHART, CAPTION)], charts),
        *survived_step_section(limits),
        *(part for solver in FORMS if limits.sizes(solver) for part in critical_sections(limits, solver)),
        *(part for solver in FORMS for part in survived_sections(limits, solver)),
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
    if line.minimum is None:
        return NONE
    return (span([line.minimum, line.largest], three_digits) + CAP * line.set_by_cap + ISLAND * line.has_island)


def survived_sections(limits, solver):
    """Returns the h‖B‖₂ that survived, of every integrator that has one: a column for each scene and n."""
    found = {key: survived for key, survived in limits.survived.items() if key[0] == solver}
    if not found:
        return []
    places = [(scene, n) for scene in SCENES for n in sorted({key[2] for key in found}) if
              any(key[1:3] == (scene, n) for key in found)]
    rows = []
    for name in limits.integrators:
        values = [found.get((solver, scene, n, name)) for scene, n in places]
        if any(values):
            rows.append([name, *(survived_text(each) for each in values)])
    columns = (Column("integrator", align="left"), *(Column(f"n = {n}", scene) for scene, n in places))
    return [Heading(f"{FORMS[solver]}: longest h‖B(W₀)‖₂ that survived"),
            Paragraph("In brackets: the relative energy error at the end of that trial."), plain_table(columns, rows)]


def survived_text(survived):
    if survived is None:
        return MISSING
    mark = CAP * (survived.fails_as == SWEEP_CAP)
    return f"{three_digits(survived.works)}{mark} ({survived.energy_error:.0e})"


def survived_step_section(limits):
    """Returns the steps that survived, of fast forms, as h, at the largest n that has them in every scene."""
    sizes = {n for solver, _, n, _ in limits.survived if solver == FAST
             and {scene for by, scene, at, _ in limits.survived if (by, at) == (FAST, n)} >= set(limits.scenes())}
    if not sizes:
        return []
    n = max(sizes)
    scenes = limits.scenes()
    rows = []
    for name in limits.integrators:
        found = [limits.survived.get((FAST, scene, n, name)) for scene in scenes]
        if any(found):
            steps = [three_digits(survived_step(limits, each)) if each else MISSING for each in found]
            errors = [f"{each.energy_error:.0e}" if each else MISSING for each in found]
            rows.append([name, *steps, *errors])
    columns = (Column("integrator", align="left"), *(Column(scene, "h up to") for scene in scenes),
               *(Column(scene, "energy error at the end") for scene in scenes))
    return [Heading(f"Longest step that survived to T = {limits.settings.long_time:g}, n = {n}, fast forms"),
            plain_table(columns, rows)]


def coverage_section(limits):
    """Returns what was tried: for each solver, n and scene the integrators by how many states they have."""
    counts = {}
    for (solver, scene, n, _), line in limits.lines.items():
        place = counts.setdefault((solver, n, scene), {})
        place[len(line.limits)] = place.get(len(line.limits), 0) + 1
    survived = [(solver, n, scene) for solver, scene, n, _ in limits.survived]
    rows = [[solver, str(n), scene, str(integrators), str(states), str(survived.count((solver, n, scene)))]
            for (solver, n, scene), place in sorted(counts.items()) for states, integrators in sorted(place.items())]
    columns = (Column("forms", align="left"), Column("n"), Column("scene", align="left"), Column("integrators"),
               Column("states of each"), Column("steps that survived in this scene"))
    return [Heading("What was tried"), plain_table(columns, rows)]


def states_section(limits):
    rows = [[state.scene, str(state.n), "own" if state.state == 0 else str(state.state), three_digits(state.norm_B),
             three_digits(state.norm_ad_B)] for state in limits.states.values()]
    return [Heading("Initial states"), plain_table((Column("scene", align="left"), Column("n"), Column("state"),
                                                    Column("‖B(W₀)‖₂"), Column("‖ad_B‖₂")), rows)]


def rendered(raw, _recorded):
    """Returns the Rendering of a raw file."""
    limits = read_limits(raw)
    from studies.limits import charts  # only now: it needs matplotlib

    return Rendering(lambda names: sections(limits, names), figures(limits),
                     {CHART: charts.limits(limits)})
