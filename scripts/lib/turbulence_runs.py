"""Single runs of the study of turbulence: drawn initial data, runs with their averages, and how fast two runs part.

Needs NumPy and isosyrk. Every state is computed anew from its number.
"""

import functools
import math

import isosyrk
import numpy
from lib import trials
from lib.formats import CONVERGED, FAST, UNSTABLE, to_digits
from lib.initial_states import modes_of_sizes
from lib.problems import encoded, energies_by_degree
from lib.turbulence_files import PARTED

DEGREES = range(6, 11)  # of the modes that are drawn
SEED = 33  # of all draws, before their number: apart from those of lib.initial_states
# Along the coadjoint orbit, relative to ‖W₀‖ in the Frobenius norm: of reference ensembles, and a smaller one.
DISPLACEMENTS = DISPLACEMENT, SMALL_DISPLACEMENT = 1e-6, 1e-8
SAMPLE_TIME = 2.0  # between two looks at a run
ENERGY_LOSS = 0.1  # relative
CONVERGENCE_TIME = 20.0
# A step of a fast form, whose fallback sweeps too. One that takes more is expensive, and shorter steps are cheaper.
# Runs that this ends might go on with the default of 1000; their status tells them from failures of the solver.
MAX_SWEEPS = 30
PUBLISHED_SWEEPS = 1000
DIGITS = 6  # that averages are recorded with, but for E(l), whose
SPECTRUM_DIGITS = 4  # are enough beside the hundredths that ensembles are apart


# ---- initial data


@functools.lru_cache(maxsize=4)
def drawn_scene(n, draw):
    """Returns the scene of a draw: modes of DEGREES, whose complex coefficients have equal variance, ‖W₀‖₂ = 1.

    The coefficients are the same at every n. W is that of a real vorticity: a mode with m = 0 has a real coefficient.
    """
    return isosyrk.scene("drawn", n=n, modes=modes_of_sizes(dict.fromkeys(DEGREES, 1.0), (SEED, draw)))


def displaced(W, size, seed):
    """Returns Q W Q† for a random unitary Q, such that it differs from W by `size`, relative, in the Frobenius norm.

    The spectrum stays to rounding. `seed` is a sequence of whole numbers. `size` is small beside 1.
    """
    rng = numpy.random.default_rng(seed)
    A = rng.standard_normal(W.shape) + 1j * rng.standard_normal(W.shape)
    eigenvalues, U = numpy.linalg.eigh(A + A.conj().T)
    generator = 1j * (U * eigenvalues) @ U.conj().T
    tangent = generator @ W - W @ generator
    angle = size * numpy.linalg.norm(W) / numpy.linalg.norm(tangent)
    Q = (U * numpy.exp(1j * angle * eigenvalues)) @ U.conj().T
    moved = Q @ W @ Q.conj().T
    return (moved - moved.conj().T) / 2


def begun(job):
    """Returns the scene of a job, and its initial data: displaced for a reference ensemble."""
    scene = drawn_scene(job["n"], job["draw"])
    if "ensemble" not in job:
        return scene, scene.initial
    return scene, displaced(scene.initial, DISPLACEMENT, (job["draw"], job["n"], job["ensemble"]))


def method_of(job, scene):
    """Returns the integrator of a job, in the form that its solver names; fast if it names none."""
    solver = job.get("solver", FAST)
    return isosyrk.integrator(scene, job["integrator"], solver=solver, tolerance=job["tolerance"],
                              max_sweeps=MAX_SWEEPS if solver == FAST else PUBLISHED_SWEEPS)


# ---- a run with its averages


class Averages:
    """Watches a run: averages over its second half, and the largest error of the energy.

    It ends a run whose energy is off by more than ENERGY_LOSS, or not finite.
    """

    def __init__(self, scene, W0, half):
        self.scene, self.half = scene, half  # steps
        self.initial = self.invariants(W0)
        self.energy_error, self.lost = 0.0, False
        self.found = []  # one vector a sample: E(l), then energy, enstrophy and tr W⁴

    def invariants(self, W):
        """Returns energy, enstrophy and tr W⁴, an array."""
        return numpy.array([self.scene.energy(W), 0.5 * numpy.linalg.norm(W) ** 2, numpy.linalg.norm(W @ W) ** 2])

    def __call__(self, step, W, _report):
        error = abs(self.scene.energy(W) / self.initial[0] - 1)
        self.energy_error = trials.larger(self.energy_error, error)
        self.lost = not error <= ENERGY_LOSS  # so that NaN is a loss
        if step > self.half and not self.lost:
            self.found.append(numpy.concatenate((energies_by_degree(W), self.invariants(W) / self.initial)))
        return self.lost

    def means(self):
        """Returns the averages as columns of a row."""
        *spectrum, energy, enstrophy, quartic = numpy.mean(self.found, axis=0)
        return {"energy": recorded(energy), "enstrophy": recorded(enstrophy), "quartic": recorded(quartic),
                "energy_by_degree": [recorded(each, SPECTRUM_DIGITS) for each in spectrum]}


def carry_out(job):
    """Returns what a run gave, as columns of a row: its status, errors, and averages over T/2 … T.

    A job is a dict of n, draw, integrator, step, tolerance and time, and of the number of a reference ensemble for
    displaced data.
    """
    scene, W0 = begun(job)
    h = job["step"]
    steps, every = steps_of(job), max(1, round(SAMPLE_TIME / h))
    watch = Averages(scene, W0, steps / 2)
    with numpy.errstate(all="ignore"):
        W, report, status, _ = trials.run(method_of(job, scene), W0, h, steps, watch, every)
        if watch.lost and status == CONVERGED:
            status = UNSTABLE
        spectrum_error = isosyrk.spectrum_error(W, W0) if numpy.isfinite(W).all() else math.inf
    averages = ("energy", "enstrophy", "quartic", "energy_by_degree")
    return {"status": status, "time": recorded(report.steps * h), "energy_error": error_of(watch.energy_error),
            "spectrum_error": error_of(spectrum_error),
            **(watch.means() if status == CONVERGED else dict.fromkeys(averages))}


def steps_of(job):
    """Returns the least number of steps that reach T."""
    return math.ceil(job["time"] / job["step"] * (1 - 1e-12))


def recorded(value, digits=DIGITS):
    return to_digits(value, digits)


def error_of(value):
    """Returns an error with two digits, or None where it is NaN or beyond all measure."""
    found = trials.finite(value)
    return found if found is None else to_digits(found, 2)


# ---- predictability, and the reference


def part(job):
    """Returns how runs from displaced data part from that of a draw: for each of DISPLACEMENTS a list of the time at
    which they have parted, or None, and of their relative difference at T/2.
    """
    scene, W = begun(job)
    states = [W.copy(), *(displaced(W, size, (job["draw"], job["n"])) for size in DISPLACEMENTS)]
    methods = [method_of(job, scene) for _ in states]
    every, steps, done = max(1, round(SAMPLE_TIME / job["step"])), steps_of(job), 0
    parted, at_window = [None] * len(DISPLACEMENTS), None
    while at_window is None or (None in parted and done < steps):
        for method, state in zip(methods, states):
            method.run(state, job["step"], every, out=state)
        done += every
        differences = [isosyrk.relative_error(state, states[0]) for state in states[1:]]
        parted = [recorded(done * job["step"]) if before is None and now >= PARTED else before
                  for before, now in zip(parted, differences)]
        if at_window is None and 2 * done >= steps:
            at_window = list(map(recorded, differences))
    return [list(pair) for pair in zip(parted, at_window)]


def converge(job):
    """Returns the relative difference of W(CONVERGENCE_TIME) at a step and at half of it."""
    scene, W0 = begun(job)
    ends = [method_of(job, scene).run(W0, job["step"] / parts, parts * round(CONVERGENCE_TIME / job["step"]))[0]
            for parts in (1, 2)]
    return error_of(isosyrk.relative_error(*ends))


# ---- cost


def developed(job):
    """Returns the state of a job at T/2, as the text of lib.problems.encoded()."""
    scene, W0 = begun(job)
    return encoded(method_of(job, scene).run(W0, job["step"], round(job["time"] / 2 / job["step"]))[0])
