"""The classes of methods that compete at equal error, each found by rule in the list of integrators.

A class says which integrators belong to it, by what the list says of them, at which tolerance they compete for an
error, and by which form. All compete in the co-rotating frame. Standard library only.
"""

from typing import Callable, NamedTuple

from lib.records.formats import FAST, PUBLISHED, Integrator
from lib.records.integrators import EXPONENTIAL, GAUSS, MAGNUS, NAMED, RKMK, RUNGE_KUTTA, is_fastest_formulation, is_new
from lib.records.settings import ENERGY_BOUNDED, LOOSE_EXPONENTIAL, LOOSE_GAUSS, MATCHED, TIGHT
from studies.accuracy.schema import CANDIDATES, Form

# Methods of a lower order take ten times the work and more at the errors of comparisons, so they are not tried.
MIN_ORDER = 4
LARGEST_PUBLISHED_STAGES = 3  # of Gauss methods in published form: those of Table 1
REACHED = 10  # an error is reached at a tolerance so many times smaller at least


class Candidate(NamedTuple):
    """A class of methods."""

    label: str  # in tables and charts
    holds: Callable[[Integrator], bool]  # whether an integrator of MIN_ORDER or above belongs to it
    tolerance: float = TIGHT
    line: float = TIGHT  # the tolerance of the lines that tell which methods may stand for it
    # At a tolerance MATCHED times smaller than the error instead, where that is looser or where this one is too loose.
    matched: bool = False
    solver: str = FAST
    even: bool = False  # whether a step takes the same work at any step size

    def tolerance_for(self, error):
        """Returns the tolerance for an error; None where the class does not compete."""
        if not self.matched:
            return self.tolerance
        matched = error / MATCHED
        return matched if matched > self.tolerance or error < REACHED * self.tolerance else None

    def line_tolerance(self, error):
        """Returns the tolerance of the lines that tell which methods may stand for the class at an error."""
        return TIGHT if self.matched and error < REACHED * self.tolerance else self.line


def of_family(*families):
    return lambda integrator: integrator.family in families


def is_rk4(integrator):
    return (integrator.family, integrator.order, integrator.projected) == (RUNGE_KUTTA, 4, False)


def is_gauss(integrator):
    """Tells whether it is a Gauss method in the formulation whose fast form is the fastest."""
    return integrator.family == GAUSS and is_fastest_formulation(integrator)


def is_table1_gauss(integrator):
    """Tells whether it is a Gauss method of Table 1 on g or on G; that on T*G needs the products of the one on G."""
    return integrator.formulation in ("algebra", "group") and integrator.family == GAUSS and (
        integrator.stages <= LARGEST_PUBLISHED_STAGES)


CLASSES = dict(zip(CANDIDATES, (
    Candidate("best explicit", lambda each: each.explicit and not each.isospectral, even=True),
    Candidate("RK4", is_rk4, even=True),
    Candidate("projected", lambda each: each.projected, even=True),
    Candidate("RKMK", of_family(RKMK)),
    Candidate("Magnus", of_family(MAGNUS), LOOSE_EXPONENTIAL, LOOSE_EXPONENTIAL),
    Candidate("exponential, 1e-8", of_family(EXPONENTIAL), LOOSE_EXPONENTIAL, LOOSE_EXPONENTIAL),
    Candidate("exponential, matched", of_family(EXPONENTIAL), LOOSE_EXPONENTIAL, LOOSE_EXPONENTIAL, matched=True),
    Candidate("exponential, bounded energy", of_family(EXPONENTIAL), ENERGY_BOUNDED, ENERGY_BOUNDED),
    Candidate("Gauss", is_gauss),
    Candidate("Gauss, 1e-7", is_gauss, LOOSE_GAUSS),
    Candidate("Gauss, matched", is_gauss, LOOSE_GAUSS, matched=True),
    Candidate("Gauss, published form", is_table1_gauss, solver=PUBLISHED),
    Candidate("named methods, published form", of_family(*NAMED), solver=PUBLISHED),
    Candidate("other families", is_new))))
EXPLICIT = "explicit"  # the class that all others are compared with


def candidates(integrators, candidate, solver=None):
    """Returns those of some Integrators that may stand for a class; none where its form is not `solver`, if given."""
    kind = CLASSES[candidate]
    return [each for each in integrators if solver in (None, kind.solver)
            and each.co_rotating and each.order >= MIN_ORDER and kind.holds(each)]


def forms(integrators, candidate):
    """Returns the Forms whose lines tell which of some Integrators may stand for a class by its fast form."""
    return [Form(each.name, CLASSES[candidate].line) for each in candidates(integrators, candidate, FAST)]


def all_forms(integrators):
    """Returns the Forms of the lines that comparisons need, each once."""
    integrators = list(integrators)
    return list(dict.fromkeys(form for candidate in CANDIDATES for form in forms(integrators, candidate)))
