"""Figures of the study `longruns`, by key, and where structure pays."""

import math
from typing import NamedTuple

from lib.judging.drift import VERDICTS
from lib.pages.numbers import power
from studies.longruns.schema import (CLASSES, COSTS, ENERGY, EXPLICIT, EXPLICIT_LIE, EXPONENTIAL_LOOSE, PLAIN,
                                     PROJECTED, QUANTITIES, SPECTRUM, STRUCTURE)


ERRORS = {ENERGY: (1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-9), SPECTRUM: (1e-4, 1e-6, 1e-8, 1e-10)}
RIVALS = {ENERGY: PLAIN, SPECTRUM: (EXPLICIT,)}  # that structure is compared with: a projection has no spectrum error


class Place(NamedTuple):
    """What an error of a quantity costs in one scene at one n."""

    scene: str
    n: int
    quantity: str
    error: float
    prices: dict  # a Price or None by class

    @property
    def structure(self):
        """The least Price of keeping the structure, or None."""
        return self.cheapest_of(STRUCTURE)

    def cheapest_of(self, classes):
        """Returns the least Price of some classes, or None."""
        return min((price for each in classes if (price := self.prices[each])), key=lambda price: price.products,
                   default=None)

    def ratio(self, classes):
        """Returns the cost of keeping the structure over that of these classes; None where either has none."""
        rival = self.cheapest_of(classes)
        return self.structure.products / rival.products if self.structure and rival else None

    @property
    def pays(self):
        """Tells whether structure is the cheapest; where no rival reaches the error at all it is."""
        ratio = self.ratio(RIVALS[self.quantity])
        return bool(self.structure) and (ratio is None or ratio < 1)

    @property
    def loose_pays(self):
        """Tells whether exponential methods at a loose tolerance, whose energy drifts, are the cheapest."""
        loose, rival = self.prices[EXPONENTIAL_LOOSE], self.cheapest_of(PLAIN)
        return bool(loose) and (rival is None or loose.products < rival.products)

    @property
    def is_cheaper_than_spectrum(self):
        """Tells whether structure is cheaper than methods that keep the spectrum alone."""
        ratio = self.ratio((EXPLICIT_LIE,))
        return ratio is not None and ratio < 1


def places_of(runs, quantity):
    """Returns the Places of a quantity: by n, scene and falling error."""
    found = []
    for n, scene in runs.settings():
        for error in ERRORS[quantity]:
            prices = {each: runs.price(scene, n, quantity, error, (each,)) for each in CLASSES}
            found.append(Place(scene, n, quantity, error, prices))
    return found


def defect_at(line, products):
    """Returns the symplectic defect of a line at a cost, interpolated in the logarithms; None beyond its runs.

    Of several stretches with this cost that with the shortest steps counts.
    """
    points = [point for point in line if point.symplectic_defect]
    for coarse, fine in reversed(list(zip(points, points[1:]))):
        low, high = coarse.equivalent_products, fine.equivalent_products
        if low <= products <= high and low < high:
            share = math.log(products / low) / math.log(high / low)
            return coarse.symplectic_defect**(1 - share) * fine.symplectic_defect**share
    return None


def defects(runs):
    """Returns (scene, n, method, cost, defect) of all lines with defects."""
    return [(scene, n, method, cost, defect_at(line, cost)) for (scene, n, method), line in runs.lines.items()
            if any(point.symplectic_defect is not None for point in line) for cost in COSTS]


def figures(runs):
    """Returns the figures by key: of prices, of where structure pays, of long runs, of defects and of verdicts."""
    found = {}
    for quantity in QUANTITIES:
        found.update(figures_of_places(places_of(runs, quantity), quantity))
        found.update(counts_of(runs, quantity))
    for (scene, cost, method), run in runs.long_runs.items():
        found.update(figures_of_long_run(f"{scene}.long.{cost}.{method}", run))
    for scene, n, method, cost, defect in defects(runs):
        found[f"{scene}.n{n}.defect.{method}.p{cost}"] = defect
    return {key: value for key, value in found.items() if value is not None}


def figures_of_places(places, quantity):
    found = {}
    for place in places:
        key = f"{place.scene}.n{place.n}.{quantity}.{power(place.error)}"
        found.update({f"{key}.{name}.products": price and price.products for name, price in place.prices.items()})
        found[f"{key}.structure_over_explicit"] = place.ratio((EXPLICIT,))
        if quantity == SPECTRUM:
            found[f"{key}.structure_over_lie"] = place.ratio((EXPLICIT_LIE,))
        else:
            found[f"{key}.structure_over_projected"] = place.ratio((PROJECTED,))
    for name, some in {"": places, **{f"n{n}.": [place for place in places if place.n == n]
                                      for n in {place.n for place in places}}}.items():
        found[f"pays.{quantity}.{name}places"] = len(some)
        found[f"pays.{quantity}.{name}cells"] = sum(place.pays for place in some)
        if quantity == ENERGY:
            found[f"pays.{quantity}.{name}loose_cells"] = sum(place.loose_pays for place in some)
    return found


def figures_of_long_run(key, run):
    found = {f"{key}.step": run.step, f"{key}.products": run.equivalent_products,
             f"{key}.energy_change": run.energy_change}
    for quantity in QUANTITIES:
        verdict, growth, *_ = run.judged(quantity)
        found[f"{key}.{quantity}_error"] = run.last(quantity)
        found[f"{key}.{quantity}_power"] = growth and growth.value
        found[f"{key}.{quantity}.{verdict.replace(' ', '_')}"] = 1  # a figure is a number, so the verdict is a key
    return found


def counts_of(runs, quantity):
    """Returns, by key, how many long runs there are of each method and each class, and how they were judged."""
    groups = {}
    for (_, _, method), run in runs.long_runs.items():
        for name in (method, runs.class_of(run)):
            groups.setdefault(name, []).append(run.judged(quantity).verdict)
    found = {}
    for name, verdicts in groups.items():
        found[f"long.{quantity}.{name}.runs"] = len(verdicts)
        found.update({f"long.{quantity}.{name}.{verdict.replace(' ', '_')}": verdicts.count(verdict)
                      for verdict in VERDICTS})
    return found
