"""What integrators are, and what they keep: said by the fields of an Integrator, never by its name, which is a key."""

from lib.records.formats import FORMULATIONS

# The families of the list that plans and charts choose from (core/catalogue/family.h).
GAUSS, DIRECT_GAUSS, COMPOSITION = "Gauss", "direct Gauss", "composition"
EXPONENTIAL, BOGFJELLMO, CROUCH_GROSSMAN = "exponential Lie–Poisson", "Bogfjellmo–Marthinsen", "Crouch–Grossman"
MAGNUS, RKMK, RUNGE_KUTTA, ADAMS = "explicit Magnus", "RKMK", "Runge–Kutta", "Adams–Bashforth–Moulton"
FAMILIES = (GAUSS, DIRECT_GAUSS, COMPOSITION, EXPONENTIAL, BOGFJELLMO, CROUCH_GROSSMAN, MAGNUS, RKMK, RUNGE_KUTTA,
            ADAMS)
NAMED = (BOGFJELLMO, CROUCH_GROSSMAN)  # the Lie–Poisson methods that the paper names
IMPLICIT_EXPONENTIAL = (EXPONENTIAL, *NAMED)  # those that solve for Ω
BY_STAGES = (GAUSS, DIRECT_GAUSS, BOGFJELLMO)  # whose number is that of stages

# A row for each s, a column for each formulation.
TABLE1_CELLS = tuple(f"{formulation}{s}" for s in (1, 2, 3) for formulation in FORMULATIONS)

# What can be asked for, from the least to the most: a Lie–Poisson integrator keeps the spectrum too.
KEPT = {"nothing": "nothing", "spectrum": "the spectrum", "poisson": "the Lie–Poisson structure"}


def strongest_structure(integrator):
    """Returns the strongest structure that an integrator keeps."""
    return next(structure for structure in reversed(KEPT) if integrator.keeps(structure))


def is_new(integrator):
    """Tells whether an integrator is of none of FAMILIES: then it is in every plan and chart."""
    return integrator.family not in FAMILIES


def is_fastest_formulation(integrator):
    """Tells whether no other formulation of its Gauss method has a faster fast form, as Table 2 shows.

    That is g for one stage and G for more. Other methods have no rival.
    """
    return integrator.family != GAUSS or integrator.formulation == ("algebra" if integrator.stages == 1 else "group")


def chosen(integrators, names, in_frame=False):
    """Returns what is run or drawn of some integrators, as Integrators by name: those named, and every new one.

    `names` are those of methods; with `in_frame` each is taken in the co-rotating frame, and without where it has none.
    """
    names = [*names, *dict.fromkeys(each.method for each in integrators if is_new(each))]
    found = {}
    for framed in (True, False) if in_frame else (False,):
        for each in integrators:
            if each.co_rotating == framed:
                found.setdefault(each.method, each)
    return {found[name].name: found[name] for name in names if name in found}


def name_with_order(integrator):
    """Returns what charts call a method: its name, framed or not, with its order where the number in it is another."""
    order = f" (order {integrator.order})" if integrator.family in BY_STAGES else ""
    return f"{integrator.method}{order}"
