"""Single runs of the study of turbulence: drawn initial data, and runs with their averages.

Needs NumPy and isosyrk. Every state is computed anew from its number.
"""

import functools
import math

import isosyrk
import numpy

from lib.records.formats import CONVERGED, UNSTABLE, to_digits
from lib.records.settings import steps_to
from lib.running import built, trials
from lib.running.initial_states import modes_of_sizes
from lib.running.problems import encoded
from studies.turbulence.schema import FAR, QUARTERS, REFERENCE, bands_of

DEGREES = range(6, 11)  # of the modes that are drawn
SEED = 33  # of all samples, before their number: apart from those of lib.initial_states
# Along the coadjoint orbit at constant energy, relative to ‖W₀‖ in the Frobenius norm.
DISPLACEMENTS = {REFERENCE: 1e-3, FAR: 1e-1}
NEWTON_STEPS = 4  # to the energy of the data, from a relative error of some 1e-2: it squares in each
# Between two looks at a run; a look is after a whole number of steps. All listed steps divide 3 or 4, and so the lags.
SAMPLE_TIME = 3.0
CORRELATED_DEGREE = 4  # l of the coefficients whose decorrelation is recorded, over
LAGS = (12.0, 24.0)
ENERGY_LOSS = 0.1  # relative
CONVERGENCE_TIME = 20.0
# A step of a fast form, whose fallback sweeps too. One that takes more is expensive, and shorter steps are cheaper.
# Runs that this ends might go on with the default of 1000; their status tells them from failures of the solver.
MAX_SWEEPS = 30
DIGITS = 6  # that averages are recorded with


# ---- initial data


@functools.lru_cache(maxsize=4)
def drawn_scene(n, sample):
    """Returns the scene of a sample: modes of DEGREES, whose complex coefficients have equal variance, ‖W₀‖₂ = 1.

    The coefficients are the same at every n. W is that of a real vorticity: a mode with m = 0 has a real coefficient.
    """
    return isosyrk.scene("drawn", n=n, modes=modes_of_sizes(dict.fromkeys(DEGREES, 1.0), (SEED, sample)))


def rotated(W, generator, angle):
    """Returns Q W Q† for Q = exp(angle · generator), a skew-Hermitian matrix. The spectrum stays to rounding."""
    eigenvalues, U = numpy.linalg.eigh(-1j * generator)
    Q = (U * numpy.exp(1j * angle * eigenvalues)) @ U.conj().T
    moved = Q @ W @ Q.conj().T
    return (moved - moved.conj().T) / 2


def displaced(scene, size, seed):
    """Returns the initial data W of a scene moved at random to Q W Q†, by `size`, relative, in the Frobenius norm.

    Q is unitary. Spectrum and energy stay, so that runs from both have the same averages if these depend on nothing
    else. `seed` is a sequence of whole numbers. `size` is small beside 1.
    """
    W, rng = scene.initial, numpy.random.default_rng(seed)
    A = rng.standard_normal(W.shape) + 1j * rng.standard_normal(W.shape)
    generator = 1j * (A + A.conj().T)
    moved = rotated(W, generator, size * numpy.linalg.norm(W) / numpy.linalg.norm(generator @ W - W @ generator))
    for _ in range(NEWTON_STEPS):  # along the orbit, where the energy changes fastest
        B = scene.generator(moved)
        uphill = B @ moved - moved @ B
        tangent = uphill @ moved - moved @ uphill
        slope = (scene.energy(moved + tangent) - scene.energy(moved - tangent)) / 2  # exact: the energy is quadratic
        moved = rotated(moved, uphill, (scene.energy(W) - scene.energy(moved)) / slope)
    return moved


def begun(job):
    """Returns the scene of a job, and its initial data: displaced for an ensemble of a role of DISPLACEMENTS."""
    scene = drawn_scene(job["n"], job["sample"])
    if "ensemble" not in job:
        return scene, scene.initial
    place = list(DISPLACEMENTS).index(job["role"])
    return scene, displaced(scene, DISPLACEMENTS[job["role"]], (job["sample"], job["n"], job["ensemble"], place))


def method_of(job, scene):
    """Returns the integrator of a job, in its fast form where it has one."""
    name = job["integrator"]
    return isosyrk.integrator(scene, name, solver=built.solver_of(name), tolerance=job["tolerance"],
                              max_sweeps=MAX_SWEEPS)


# ---- a run with its averages


class Averages:
    """Watches a run: averages over its second half, and the largest error of the energy.

    It ends a run whose energy is off by more than ENERGY_LOSS, or not finite.
    """

    def __init__(self, scene, W0, half):
        self.scene, self.half = scene, half  # steps
        self.initial = self.invariants(W0)
        self.energy_error, self.lost = 0.0, False
        # A sample each: energy and enstrophy over the initial ones; energy of each band; coefficients of one degree.
        self.invariant_samples, self.bands, self.coefficients = [], [], []

    def invariants(self, W):
        """Returns energy and enstrophy, an array."""
        return numpy.array([trials.energy(self.scene, W), 0.5 * numpy.linalg.norm(W) ** 2])

    def __call__(self, step, W, _report):
        found = self.invariants(W) / self.initial
        self.energy_error = trials.larger(self.energy_error, abs(found[0] - 1))
        self.lost = not abs(found[0] - 1) <= ENERGY_LOSS  # so that NaN is a loss
        if step > self.half and not self.lost:
            energies = isosyrk.energy_spectrum(W)
            self.invariant_samples.append(found)
            self.bands.append([energies[low:high + 1].sum() for low, high in bands_of(len(W))])
            self.coefficients.append(coefficients(W, CORRELATED_DEGREE))
        return self.lost

    def means(self, interval):
        """Returns the averages as columns of a row, given the time between two samples."""
        energy, enstrophy = numpy.mean(self.invariant_samples, axis=0)
        quarters = [quarter.mean(axis=0) for quarter in numpy.array_split(self.bands, QUARTERS)]
        return {"energy": recorded(energy), "enstrophy": recorded(enstrophy),
                "bands": [list(map(recorded, quarter)) for quarter in quarters],
                "decorrelations": [recorded(decorrelation(numpy.array(self.coefficients), round(lag / interval)))
                                   for lag in LAGS]}


def coefficients(W, degree):
    """Returns the coefficients of a degree l, an array over m = 0 … l, such that ‖·‖² is the sum over m = −l … l."""
    found = numpy.array([complex(re, im) for l, m, re, im in isosyrk.modes(W) if l == degree])
    found[1:] *= math.sqrt(2)
    return found


def decorrelation(samples, lag):
    """Returns the mean |ω(t + lag) − ω(t)|² over twice the mean |ω|², given samples × coefficients, lag in samples.

    It is 0 for what stays, and about 1 for what forgets and has mean 0.
    """
    lag = min(lag, len(samples) - 1)
    differences = samples[lag:] - samples[:len(samples) - lag]
    return (abs(differences) ** 2).sum(axis=1).mean() / (2 * (abs(samples) ** 2).sum(axis=1).mean())


def carry_out(job):
    """Returns what a run gave, as columns of a row: its status, errors, and averages over T/2 … T.

    A job is a dict of n, sample, integrator, step, tolerance and time; for displaced data also of the role and the
    number of an ensemble.
    """
    scene, W0 = begun(job)
    h = job["step"]
    steps, every = steps_to(job["time"], job["step"]), max(1, round(SAMPLE_TIME / h))
    watch = Averages(scene, W0, steps / 2)
    with numpy.errstate(all="ignore"):
        W, report, status, _ = trials.run(method_of(job, scene), W0, h, steps, watch, every)
        if watch.lost and status == CONVERGED:
            status = UNSTABLE
        spectrum_error = isosyrk.spectrum_error(W, W0) if numpy.isfinite(W).all() else math.inf
    averages = ("energy", "enstrophy", "bands", "decorrelations")
    products = report.equivalent_products / (max(1, report.steps) * h)
    return {"status": status, "time": recorded(report.steps * h), "products": recorded(products),
            "energy_error": error_of(watch.energy_error), "spectrum_error": error_of(spectrum_error),
            **(watch.means(every * h) if status == CONVERGED else dict.fromkeys(averages))}


def recorded(value, digits=DIGITS):
    return to_digits(value, digits)


def error_of(value):
    """Returns an error with two digits, or None where it is NaN or beyond all measure."""
    found = trials.finite(value)
    return found if found is None else to_digits(found, 2)


# ---- the reference


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
