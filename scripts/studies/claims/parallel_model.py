"""A model of the time of a Picard sweep on p processors: products and sums as tasks, phase by phase.

A sweep of a formulation is a list of phases. The tasks of a phase are independent of one another, and a phase begins
when the one before has ended. A task is a whole matrix: a product, a Poisson solve or a linear combination. It counts
products, in full complex products, and passes, in sums of two n x n matrices into a third. The phases are those of the
fast forms with plain sweeps (core/fast): products with a skew-Hermitian result form one triangle and count half, and
algebra forms M_jk for j <= k alone, s + s(s+1)/2 products for the paper's s + s².

The model is an idealisation, and bounds no library: processors share no memory bandwidth, and starting and ending a
phase costs nothing. Two cases are modelled: whole tasks (no product is split), and split ones (p even parts).

Seconds are added by math.fsum, here as elsewhere in scripts/: the built-in sum rounds otherwise from Python 3.12 on.
"""

import heapq
import math
from typing import NamedTuple

PROCESSORS = (1, 2, 4, 8, 16, 32, 64)
TRIANGLE = 0.5  # of a full product
POISSON = 2.0  # passes of a Poisson solve: forward elimination and back substitution
# Matrices that a residual moves beside the new value: the old one, the change (single precision) and its addition.
RESIDUAL = 4.0


class Task(NamedTuple):
    products: float = 0.0
    passes: float = 0.0


def combination(*matrices):
    """Returns the task of linear combinations that move so many matrices; a pass moves three."""
    return Task(passes=sum(matrices) / 3)


def phases(formulation, s):
    """Returns the phases of a sweep, lists of Tasks, of "cotangent", "group" or "algebra" with s stages."""
    full, triangle, poisson = [Task(1.0)] * s, [Task(TRIANGLE)] * s, [Task(passes=POISSON)] * s
    if formulation == "cotangent":  # Q†P; B; QB and PB; new Q and P
        return [triangle, poisson, full + full, [combination(s + 1, RESIDUAL)] * (2 * s)]
    if formulation == "group":  # W₀Q; Q†(W₀Q); B; QB; new Q
        return [full, triangle, poisson, full, [combination(s + 1, RESIDUAL)] * s]
    pairs = s * (s - 1) // 2
    stage = combination(s + 1, pairs + 2, 2, s + 3)  # ΣaX; with pairs; skew part; W̃
    factors = [combination(3)] * s + [combination(s + 2)] * s + [combination(s + 4)] * pairs  # W₀ + ΣaX; Y_jj; Y_jk
    change_of_stage = combination((s + pairs + 1) / 2, 1, (s + 2) / 2)  # in single precision
    return [[stage] * s, poisson, factors, full + triangle + [Task(1.0)] * pairs,
            [combination(1, RESIDUAL)] * (2 * s + pairs), [change_of_stage] * s]


def makespan(durations, processors):
    """Returns when the last task ends if the longest tasks are begun first, each on the first free processor."""
    free = [0.0] * min(processors, max(1, len(durations)))
    for duration in sorted(durations, reverse=True):
        heapq.heapreplace(free, free[0] + duration)
    return max(free)


class Rates(NamedTuple):
    """Seconds of a product and of a pass."""

    product: float
    single_pass: float

    def seconds(self, task):
        return task.products * self.product + task.passes * self.single_pass


def sweep_seconds(formulation, s, rates, processors):
    """Returns the seconds of a sweep on so many processors, no task being split."""
    return math.fsum(makespan([rates.seconds(task) for task in phase], processors) for phase in phases(formulation, s))


def work_seconds(formulation, s, rates, processors):
    """Returns the seconds of a sweep if all its work were split evenly, at the rates of one processor."""
    return math.fsum(rates.seconds(task) for phase in phases(formulation, s) for task in phase) / processors


def path_products(formulation, s):
    """Returns the products on the critical path of a sweep: with as many processors as it has tasks."""
    return sum(max(task.products for task in phase) for phase in phases(formulation, s))
