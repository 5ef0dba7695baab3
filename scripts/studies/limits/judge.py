"""Figures of the study `limits`, by key; results/README.md says what they mean."""

import statistics

from lib.records.integrators import is_new


def figures(limits):
    """Returns figures by key, such as critical.fast.smooth.group2.n65.min and survived_step.fast.smooth.group2.n65.

    Critical values are h‖B(W₀)‖₂, least and largest over the states of a scene, and theory is what linear theory has in
    their place. Steps that survived are h, each with its energy error. Then counts, and the spread of a limit over
    states: largest over least, as its median over all lines of several states.
    """
    found, quoted = {}, {*QUOTED, *(name for name, each in limits.integrators.items() if is_new(each))}
    for (solver, scene, n, name), line in limits.lines.items():
        if name in quoted and line.minimum:
            key = f"critical.{solver}.{scene}.{name}.n{n}"
            found |= {f"{key}.min": line.minimum, f"{key}.largest": line.largest}
    found |= {f"theory.{scene}.{name}.n{n}": limit for (scene, n, name), limit in limits.theory.items()
              if name in quoted}
    for (solver, scene, n, name), survived in limits.survived.items():
        if name in quoted:
            form = f"{solver}.{scene}.{name}.n{n}"
            found |= {f"survived_step.{form}": survived_step(limits, survived),
                      f"survived_energy_error.{form}": survived.energy_error}
    every = list(limits.lines.values())
    several = [line for line in every if len(line.limits) > 1 and all(limit.works for limit in line.limits)]
    counted = {"limits": sum(len(line.limits) for line in every), "lines": len(every),
               "lines_set_by_cap": sum(line.set_by_cap for line in every),
               "lines_with_island": sum(line.has_island for line in every),
               "lines_of_several_states": len(several), "own_state_within_drawn": sum(map(own_within_drawn, several)),
               "survived": len(limits.survived),
               "survived_below_critical": sum(map(falls, limits.survived_and_critical()))}
    if several:
        spreads = [line.largest / line.minimum for line in several]
        found |= {"spread.median": statistics.median(spreads), "spread.largest": max(spreads)}
    return {**found, **counted}


def own_within_drawn(line):
    """Tells whether the limit of the scene's own state lies within the range of the drawn ones, to bisection."""
    own, *drawn = line.limits
    return min(each.works for each in drawn) <= own.fails and max(each.fails for each in drawn) >= own.works


def falls(pair):
    """Tells whether the step that survived is below the critical one by more than bisection."""
    survived, critical = pair
    return survived.fails <= critical.works


# Whose steps pages may quote; those of new integrators too.
QUOTED = ("group1", "group2", "group3", "algebra1", "algebra2", "algebra3", "elp4", "elp6", "bm2", "bm3", "cg4",
          "rkmk4", "magnus5", "rk4_projected", "rk8_projected", "rk4", "rk5", "rk8", "rk10", "abm8", "group2_frame",
          "group3_frame", "elp4_frame", "elp6_frame", "magnus5_frame", "rk4_frame", "rk5_frame", "rk8_frame",
          "abm8_frame")


def survived_step(limits, survived):
    """Returns h of a Survived."""
    return survived.works / limits.states[survived.scene, survived.n, 0].norm_B
