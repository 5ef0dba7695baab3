"""Integrators for isospectral flows W' = [B(W), W], on NumPy arrays.

    import isosyrk

    scene = isosyrk.scene("smooth", n=33)
    method = isosyrk.integrator(scene, "group2", solver="fast")
    W, report = method.run(scene.initial, h=0.1, steps=50)
    isosyrk.plot(W)

A vorticity matrix W is an array of shape (n, n), skew-Hermitian to 1e-10 relative, and comes back as complex128. Input
may be real or complex of any precision that complex128 holds; it is converted once a run, read in any memory layout and
never modified. Only `out` is written, and must be complex128, writable and in C order. W may be of any norm: the
tolerance of an iteration is relative to it. Steps release the GIL. Ctrl-C ends a run after the sweep at hand (an
explicit method: after the step at hand) or within a tenth of a second, whichever is later; making a scene, spectra and
fields cannot be interrupted. The KeyboardInterrupt, as any exception that ends a run, has the attributes W, the state
after the last step done, and report, the work so far. Bad values raise ValueError with one line that names the value
and what is allowed, other types TypeError.
"""

import atexit
import contextlib
import importlib
import math
import operator
import os
from typing import Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

# OpenMP reads this when it is loaded, with _core: threads then sleep after a short spin at a barrier, not after
# milliseconds, which on a busy machine are another program's (see benchmarks/thread_settings.h). It is kept from the
# processes that this one starts.
_waits_as_asked = "GOMP_SPINCOUNT" in os.environ or "OMP_WAIT_POLICY" in os.environ
if not _waits_as_asked:
    os.environ["GOMP_SPINCOUNT"] = "1500"
from . import _core  # noqa: E402
if not _waits_as_asked:
    del os.environ["GOMP_SPINCOUNT"]

__all__ = ["Integrator", "IntegratorRecord", "Report", "Scene", "SolverError", "angular_momentum_error",
           "casimir_errors", "conditions", "energy_spectrum", "integrator", "integrators", "laplace", "measured_limit",
           "modes", "plot", "product_rate", "quflow", "relative_error", "scene", "scenes", "skew_defect",
           "solve_poisson", "spectrum", "spectrum_error", "vorticity"]

__version__ = _core.version

Matrix = NDArray[np.complex128]
Mode = Tuple[int, int, float, float]

SOLVERS = ("published", "fast")
PRODUCTS = ("fastest", "openblas", "eigen")
SWITCHES = tuple(_core.switch_names())
LARGEST_N = 4096
SKEW = 1e-10  # a matrix may be so far from skew-Hermitian, relative to its largest entry

atexit.register(_core.end_runs)


class Report(NamedTuple):
    """The work of a run, or of the part of it that is done."""

    steps: int  # completed
    sweeps: int  # Picard sweeps of all steps; 0 for explicit methods
    products: int  # n x n complex matrix products
    equivalent_products: float  # their work in full products in double precision
    poisson_solves: int  # evaluations of B
    projections: int  # onto the spectrum, each with all eigenvectors of a matrix beside its products
    seconds: float  # CPU time of this process, without `observe` and `between`
    contraction: float  # largest over all steps; 0 for explicit methods
    last_change: float  # of the last sweep: largest change of an unknown, as for the tolerance of integrator()


class SolverError(RuntimeError):
    """A step did not converge.

    step: the step that failed, counted from 1.  status: "diverged", "stagnated" or "sweep cap".  last_change: of its
    last sweep.  W: the state before it, complex128, shape (n, n) (`out`, if that was given).  report: the work so far.
    """

    def __init__(self, step, status, last_change, W, report):
        super().__init__(f"{status} at step {step} after {report.sweeps} sweeps in all, last change {last_change:.3g}")
        self.step = step
        self.status = status
        self.last_change = last_change
        self.W = W
        self.report = report

    def __reduce__(self):
        return SolverError, (self.step, self.status, self.last_change, self.W, self.report)


class IntegratorRecord(NamedTuple):
    """An integrator of the list, and what it keeps."""

    name: str
    stages: int
    order: int
    isospectral: bool  # keeps the spectrum of W
    lie_poisson: bool  # a step is a Poisson map
    symmetric: bool  # a step of -h inverts a step of h
    explicit: bool  # no iteration
    stability_limit: float  # largest stable h*norm(ad_B) for a constant generator; inf if there is none
    has_fast_form: bool  # for solver "fast"
    method: str  # name of the same method outside the co-rotating frame
    family: str  # "Gauss", "explicit Magnus", …; "other" is a family of its own
    formulation: Optional[str]  # "cotangent", "group" or "algebra", of Gauss methods and compositions
    co_rotating: bool  # runs in the co-rotating frame
    projected: bool  # projects onto the spectrum
    spectrum_at_any_tolerance: bool  # keeps the spectrum to rounding; other isospectral ones to the tolerance


class Scene:
    """A flow with initial data. Made by scene().

    It pickles and copies as the arguments of scene() that it was made with: a generator of the user's own must pickle,
    and modes are summed again.
    """

    def __init__(self, core, hbar, modes_hash, generator=None, hamiltonian=None):
        self._core = core
        self._arguments = {}  # of scene(), which sets them; `initial` is None where there is one
        self._generator = generator  # kept here, since the compiled half only borrows it
        self._hamiltonian = hamiltonian
        self.name: str = core.name
        self.n: int = core.n
        self.time: float = core.time  # the end of its time span
        self.hbar: Optional[str] = hbar  # "paper" or "standard"; None for a generator of the user's own
        self.modes_hash: Optional[str] = modes_hash  # tells initial modes apart; None where there are none

    @property
    def initial(self) -> Matrix:
        """W at time 0, shape (n, n), read-only. Named scenes have spectral norm 1."""
        return self._core.initial

    def energy(self, W: ArrayLike) -> float:
        """Returns the Hamiltonian H(W), for W of any norm; NaN where a user's own flow has none.

        Raises ValueError where no double holds it: for norms beyond about 1e154 and below 1e-154.
        """
        W = _square(W, self.n)
        if self._hamiltonian is not None:
            return _real(self._hamiltonian(W.copy()), "hamiltonian: its result", finite=False)
        return self._core.energy(W)

    def generator(self, W: ArrayLike) -> Matrix:
        """Returns B(W), shape (n, n)."""
        return self._core.generator(_square(W, self.n))

    def generator_norms(self, co_rotating: bool = False) -> Tuple[float, float]:
        """Returns the 2-norms of B and of ad_B = [B, .] at the initial data. Raises ValueError unless J = I.

        co_rotating: of the generator in the co-rotating frame, which is B without its l = 1 part; for Euler-Zeitlin
        only.
        """
        if co_rotating and self.hbar is None:
            raise ValueError("co_rotating: for Euler-Zeitlin only")
        return self._core.generator_norms(bool(co_rotating))

    def __reduce__(self):
        arguments = dict(self._arguments)
        if "initial" in arguments:
            arguments["initial"] = self.initial
        return _scene_again, (arguments,)

    def __repr__(self):
        return f"<isosyrk.Scene {self.name}, n = {self.n}>"


def _scene_again(arguments):
    return scene(**arguments)


def scene(name: Optional[str] = None, n: Optional[int] = None, hbar: Optional[str] = None, *,
          modes: Optional[Iterable[Mode]] = None, initial: Optional[ArrayLike] = None,
          signature: Optional[Tuple[int, int]] = None,
          generator: Optional[Callable[[Matrix], ArrayLike]] = None,
          hamiltonian: Optional[Callable[[Matrix], float]] = None) -> Scene:
    """Returns the Euler-Zeitlin equations W' = [B(W), W], with B = inverse Laplacian of W over hbar, and initial data.

    One of these says what the initial data are:
      name     "smooth" (the paper's Table 1; n >= 5) or "rough"; needs n. Beside modes or initial these names, and any
               that is not in scenes(), are a label only.
      modes    coefficients (l, m, re, im) with 1 <= l < n, 0 <= m <= l, im = 0 where m = 0; needs n. W is scaled to
               norm 1.
      initial  W itself, shape (n, n), skew-Hermitian to 1e-10 relative; taken as it is. A trace costs nothing:
               integrators set the part icI aside, which B ignores, and add it again. In other equations they do not.
    hbar is "paper" (the default, 2/sqrt(n(n-1))) or "standard" (2/sqrt(n^2-1), as quflow has it).

    Other names of scenes() have equations of their own; n is always the size of W:
      "euler_top"       so(3), n = 3           "rigid_body"  so(n), Manakov's inertia, n >= 3
      "spin_chain"      Heisenberg's ring of N spins on su(2)^N, n = 2 N, N >= 3
      "symplectic"      a rigid body on sp(n), n even, real
      "pseudo_unitary"  a rigid body on su(p, q), p + q = n, with signature=(p, q)
    They have no hbar and no modes; `initial` replaces their initial data. Published forms integrate them, in real
    arithmetic and on blocks where the scene is real or block diagonal.

    With `initial`, `generator` makes a flow of your own: a function that takes W (a complex128 array of shape (n, n), a
    copy, exactly skew-Hermitian) and returns B(W), skew-Hermitian. All published forms integrate it, but elp4 and elp6
    only if it is linear and self-adjoint, tr(A B(C)) = tr(B(A) C): they try it on random matrices, to 1e-10, when the
    first of them is made. `hamiltonian` maps W to a number.
    Raises ValueError for values out of range.
    """
    if modes is not None:
        modes = list(modes)
    made = _made_scene(name, n, hbar, modes, initial, signature, generator, hamiltonian)
    arguments = dict(name=name, n=n, hbar=hbar, modes=modes, initial=initial, signature=signature, generator=generator,
                     hamiltonian=hamiltonian)
    made._arguments = {what: value for what, value in arguments.items() if value is not None}
    if initial is not None:
        made._arguments["initial"] = None  # the scene has it
    return made


def _made_scene(name, n, hbar, modes, initial, signature, generator, hamiltonian):
    """Returns the scene of these arguments of scene()."""
    if modes is not None and initial is not None:
        raise ValueError("scene: has modes and initial; must have one of them")
    if name is None and modes is None and initial is None:
        raise ValueError("scene: must have a name, modes or initial")
    if generator is None and hamiltonian is not None:
        raise ValueError("hamiltonian: goes with a generator")
    if signature is not None and (generator is not None or name is None):
        raise ValueError("signature: goes with the scene pseudo_unitary")
    if generator is not None:
        return _own_scene(name, initial, n, hbar, generator, hamiltonian)
    label = None if name is None else _text(name, "scene")
    if signature is not None or (label in scenes() and not _core.is_euler_zeitlin(label)):
        return _named_scene(label, n, hbar, modes, initial, signature)
    hbar = "paper" if hbar is None else _text(hbar, "hbar")
    if initial is not None:
        return Scene(_core.scene_of_initial(label or "initial", _initial(initial, n), hbar), hbar, None)
    if n is None:
        raise ValueError("scene: n is missing")
    n = _whole(n, "n", 2, LARGEST_N)
    if modes is not None:
        modes = [_mode(mode) for mode in modes]
        return Scene(_core.scene_of_modes(label or "modes", modes, n, hbar), hbar, _core.hash_of_modes(modes))
    if label == "smooth" and n < 5:
        raise ValueError(f"n = {n}: the default modes (l <= 4) need n >= 5; smaller n needs modes")
    return Scene(_core.scene_by_name(label, n, hbar, None), hbar, _core.hash_of_scene(label, n))


def scenes() -> List[str]:
    """Returns the names of all scenes; those of Euler-Zeitlin come first."""
    return _core.scene_names()


def _named_scene(name, n, hbar, modes, initial, signature):
    """Returns a scene whose equations are not those of Euler-Zeitlin."""
    if modes is not None:
        raise ValueError(f"modes: go with Euler-Zeitlin, not with {name}")
    if hbar is not None:
        raise ValueError(f"hbar: goes with Euler-Zeitlin, not with {name}")
    if initial is not None:
        initial = _square(initial, None if n is None else _whole(n, "n", 2, LARGEST_N))
        n = len(initial)
    if n is None:
        raise ValueError("scene: n is missing")
    if signature is not None:
        try:
            p, q = signature
        except (TypeError, ValueError):
            raise ValueError(f"signature {signature!r}: must be (p, q)") from None
        signature = _whole(p, "p", 1, LARGEST_N), _whole(q, "q", 1, LARGEST_N)
    core = _core.scene_by_name(name, _whole(n, "n", 2, LARGEST_N), None, signature)
    return Scene(core if initial is None else core.starting_at(initial), None, None)


def _own_scene(name, initial, n, hbar, generator, hamiltonian):
    if initial is None:
        raise ValueError("generator: needs initial, the matrix to begin with")
    if hbar is not None:
        raise ValueError("hbar: goes with Euler-Zeitlin only, not with a generator of your own")
    for what, function in (("generator", generator), ("hamiltonian", hamiltonian)):
        if function is not None and not callable(function):
            raise TypeError(f"{what}: is a {type(function).__name__}, must be a function of W")
    label = "generator" if name is None else _text(name, "scene")
    return Scene(_core.scene_of_generator(label, _initial(initial, n), generator), None, None, generator, hamiltonian)


# OpenMP hangs in a child that was forked after a parallel region of its parent.
_used_threads = _hangs = False


def _after_fork():
    global _hangs
    _hangs = _used_threads


os.register_at_fork(after_in_child=_after_fork)


class Integrator:
    """A one-step method for the flow of a scene, with its workspace. Made by integrator().

    A fast integrator predicts from its past steps, so that a run is cheaper than as many single steps from other
    states. A run from the W that the call before has returned goes on: runs in parts are the run in one go, bit by bit.
    One call at a time: a second one from another thread, or from `observe`, raises RuntimeError.
    It pickles and copies as its scene and options: the copy has no past steps.
    """

    def __init__(self, scene, entry, solver, threads, core, options):
        self.scene: Scene = scene
        self.name: str = entry.name
        self.stages: int = entry.stages
        self.solver: str = solver
        self.threads: int = threads
        self._entry = entry
        self._core = core
        self._options = options  # of integrator(), beside scene and name

    def step(self, W: ArrayLike, h: float, out: Optional[Matrix] = None) -> Matrix:
        """Returns the state after one step of size h, which may be negative, from W. `out` as in run()."""
        return self.run(W, h, 1, out=out)[0]

    def run(self, W: ArrayLike, h: float, steps: int, observe: Optional[Callable[[int, Matrix, Report], object]] = None,
            every: int = 1, out: Optional[Matrix] = None, between: Optional[Callable[[int, Matrix], object]] = None,
            progress: bool = False) -> Tuple[Matrix, Report]:
        """Takes `steps` steps of size h from W; returns the last state, shape (n, n), and the work.

        observe(step, W, report) is called after every `every` steps and after the last; W is then a read-only view, to
        be copied if it is to be kept. The run ends where it returns True.
        out: the array to work in and return, which may be W itself; otherwise a new one.
        between(step, W) may change W in place after every step, before `observe` sees it: forcing, damping, splitting.
        After a small change a fast method still predicts from its past steps. W must stay in the algebra of the scene;
        otherwise ValueError.
        progress: shows a bar by tqdm on stderr; ImportError if that is not installed.

        Raises SolverError if a step does not converge. Whatever exception ends the run, of `observe` and `between` and
        KeyboardInterrupt too, has the attributes W (`out`, if that was given) and report. A step is done when its
        `between` is; W is the state after the report.steps steps that are. From there the run can go on. A SolverError
        of another run, begun in `observe` or `between`, keeps its own.
        """
        state = _state(W, self.scene)
        h, steps, every = _real(h, "h"), _whole(steps, "steps", 0), _whole(every, "every", 1)
        if observe is not None and not callable(observe):
            raise TypeError(f"observe: is a {type(observe).__name__}, must be a function of step, W and report")
        if between is not None and not callable(between):
            raise TypeError(f"between: is a {type(between).__name__}, must be a function of step and W")
        if not isinstance(progress, (bool, np.bool_)):
            raise TypeError(f"progress: is a {type(progress).__name__}, must be True or False")
        self._require_threads()
        if out is None:
            out = np.empty((self.scene.n, self.scene.n), np.complex128)
        result = _output(out, self.scene.n)
        outcome = _core.Outcome()
        with _Bar(steps, outcome) if progress else contextlib.nullcontext() as advance:
            calls = _core.Calls(None if between is None else _amender(between, result),
                                None if observe is None else _observer(observe, result), every, advance)
            try:
                self._core.run(state, result, h, steps, calls, outcome)
            except BaseException as error:
                if outcome.begun and not isinstance(error, SolverError):
                    with contextlib.suppress(AttributeError, TypeError):  # a class of exceptions may have none
                        error.W, error.report = out, _report(outcome)
                raise
        return out, self._report(outcome, out)

    def timed_run(self, W: ArrayLike, h: float, steps: int, repetitions: int = 7, warmup: int = 0) -> List[float]:
        """Returns the CPU seconds of `repetitions` runs, measured in C++.

        Each repetition begins at W with `warmup` untimed steps, then times `steps` steps. Raises SolverError.
        """
        self._require_threads()
        W = _state(W, self.scene)
        state = np.empty_like(W)
        outcome, times = self._core.timed_run(W, state, _real(h, "h"), _whole(steps, "steps", 1),
                                              _whole(repetitions, "repetitions", 1), _whole(warmup, "warmup", 0))
        self._report(outcome, state)
        return times

    def _require_threads(self):
        """Raises RuntimeError where a parallel region would hang."""
        global _used_threads
        if self.threads > 1:
            if _hangs:
                raise RuntimeError(f"threads = {self.threads}: hang in a process forked after others ran;"
                                   " start it by spawn")
            _used_threads = True

    def linear_limit(self) -> Optional[float]:
        """Returns the largest h*norm(B) that linear theory allows at the scene's initial data (2-norm), or None.

        Raises ValueError unless J = I.
        """
        return self._entry.linear_limit(self.scene._core)

    def __reduce__(self):
        return _integrator_again, (self.scene, self.name, self._options)

    def __repr__(self):
        return f"<isosyrk.Integrator {self.name}, {self.solver}, n = {self.scene.n}>"

    @staticmethod
    def _report(outcome, W):
        report = _report(outcome)
        if outcome.status != "converged":
            raise SolverError(outcome.failed_step, outcome.status, outcome.last_change, W, report)
        return report


def _integrator_again(scene, name, options):
    return integrator(scene, name, **options)


def integrator(scene: Scene, name: str, solver: str = "published", tolerance: float = 1e-13, threads: int = 1, *,
               max_sweeps: int = 1000, products: str = "openblas", without: Sequence[str] = ()) -> Integrator:
    """Returns the integrator with this name of integrators(), for the flow of a scene.

    Beside the list there are controls, as published forms only: "algebra2_two_products" and "algebra3_two_products",
    and compositions with their substeps on the group or on T*G, as "yoshida4_group" and "yoshida4_cotangent".

    solver     "published": the paper's equations, solved by Picard sweeps. "fast": the same answer to the tolerance,
               several times sooner; for Euler-Zeitlin, otherwise ValueError.
    tolerance  of the iteration, at least 1e-15: the largest change of an unknown, Frobenius norm. Unknowns that scale
               with W are measured in units of the power of two nearest to the 2-norm of W; those of the group are
               absolute; Omega of elp2, elp4 and elp6 is relative to its own norm, in the frame at least to the
               rounding of the rotation that the frame takes away.
    threads    of the fast solver, 1 to 64; the answer is bit for bit the same. A process forked after a run with
               several threads raises RuntimeError: OpenMP hangs there.
    max_sweeps of a step, 1 to 1000000.
    products   of published forms: "openblas", "eigen", or "fastest" of the two as measured here.
    without    of the fast solver, for studies: "predictor" (past steps), "newton", "bands"; of elp2, elp4 and elp6 also
               "explicit_start" and "error_estimates" (acceptance by the estimated error); of these and rkmk4
               "graded_series" (each ends at the wanted accuracy). A form that does not have a part ignores its name.
    Raises ValueError for values out of range, and if there is not enough memory.
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: is a {type(scene).__name__}, must come from isosyrk.scene()")
    entry = _core.integrator_entry(_text(name, "integrator"))
    solver = _solver(solver)
    without = (without,) if isinstance(without, str) else tuple(without)
    for each in without:
        if each not in SWITCHES:
            raise ValueError(f"without '{each}': must be of {', '.join(SWITCHES)}")
    tolerance = _real(tolerance, "tolerance")
    if tolerance < 1e-15:
        raise ValueError(f"tolerance {tolerance:g}: must be at least 1e-15, and finite")
    threads = _whole(threads, "threads", 1, 64)
    if solver == "published" and (threads != 1 or without):
        raise ValueError(f"{'threads' if threads != 1 else 'without'}: goes with solver 'fast' only")
    if solver == "fast" and scene._generator is not None:
        raise ValueError("solver 'fast': not for a generator of your own; must be published")
    if solver == "fast" and products != "openblas":
        raise ValueError("products: goes with solver 'published' only; fast forms have products of their own")
    options = dict(solver=solver, tolerance=tolerance, threads=threads, without=without,
                   max_sweeps=_whole(max_sweeps, "max_sweeps", 1, 10**6), products=_products(products, scene.n))
    core = _core.Stepper(scene._core, entry.name, **{**options, "without": set(without)})
    return Integrator(scene, entry, solver, threads, core, options)


def integrators() -> List[IntegratorRecord]:
    """Returns the list of integrators."""
    return [IntegratorRecord(*(getattr(entry, field) for field in IntegratorRecord._fields))
            for entry in _core.integrators()]


def measured_limit(name: str, n: int, solver: str = "published") -> Optional[float]:
    """Returns the largest h*norm(B(W0)) (2-norm) at which a form of an integrator survived every recorded run.

    The longest step that survived says nothing of accuracy: a run may not fail, lose a tenth of its energy, or its
    spectrum. The runs were of Euler-Zeitlin: to T = 50 or longer, in 500 steps at least, of explicit methods 4000, from
    the smooth, rough and developed scene (n = 129: smooth), and a tenth as long from drawn states. Taken is the lesser
    value of the recorded n on both sides of n. B is that of the flow without co-rotating frame. None beyond the
    recorded n, and where the form was not tried, as published forms in the frame, or no step survived. Raises
    ValueError for an unknown integrator or solver. Source: results/recorded/limits.
    """
    return _core.measured_limit(_text(name, "name"), _solver(solver), _whole(n, "n", 2, LARGEST_N))


def conditions(products: str = "fastest", sizes: Iterable[int] = ()) -> Dict[str, str]:
    """Returns the conditions of a measurement, as text: commit, compiler, processor, BLAS and its kernels, environment.

    Product rates are measured at the given n, about half a second each. Raises RuntimeError where the module was built
    without its extension that measures.
    """
    return _measuring().conditions(_text(products, "products"), [_whole(n, "n", 2, LARGEST_N) for n in sizes])


def product_rate(n: int, solver: str = "fast") -> float:
    """Returns the products of n x n matrices per CPU second, as measured here in a twentieth of a second: of the fast
    forms' products, or of published forms' with the faster backend. Raises RuntimeError as conditions()."""
    return _measuring().product_rate(_whole(n, "n", 2, LARGEST_N), _solver(solver))


def spectrum(W: ArrayLike) -> NDArray[np.float64]:
    """Returns the eigenvalues of -iW, ascending, shape (n,), for a finite W of shape (n, n) that is skew-Hermitian to
    1e-10 relative. Raises ValueError for another W."""
    return _core.spectrum(_skew_hermitian(W))


def spectrum_error(W: ArrayLike, W0: ArrayLike) -> float:
    """Returns the largest difference of the sorted spectra of two skew-Hermitian matrices: absolute, in units of W."""
    W = _square(W)
    return _core.spectrum_error(W, _square(W0, len(W)))


def skew_defect(W: ArrayLike) -> float:
    """Returns the largest entry of |W + W^dagger|."""
    return _core.skew_defect(_square(W))


def casimir_errors(W: ArrayLike, W0: ArrayLike) -> List[float]:
    """Returns |tr W^k - tr W0^k| over the sum of |lambda|^k, for k = 2 ... 5, with lambda the eigenvalues of W0.

    Both have shape (n, n), are skew-Hermitian and of any norm. Raises ValueError unless W0 is finite.
    """
    W = _square(W)
    return _core.casimir_errors(W, _square(W0, len(W)))


def angular_momentum_error(W: ArrayLike, W0: ArrayLike) -> float:
    """Returns the largest change of a component of the angular momentum, relative to its norm at W0; n >= 2.

    Where W0 has no part with l = 1, the result says nothing: rounding over rounding, inf or NaN.
    """
    W = _square(W)
    if len(W) < 2:
        raise ValueError("W: its shape is (1, 1), must be (n, n) with n >= 2")
    return _core.angular_momentum_error(W, _square(W0, len(W)))


def relative_error(W: ArrayLike, reference: ArrayLike) -> float:
    """Returns the Frobenius norm of W - reference over that of the reference, right at any norm."""
    reference = _square(reference)
    # Squares overflow at 1e154, and a power of two as unit changes no digit.
    _, exponent = np.frexp(np.abs(reference).max())
    reference = _times_power_of_two(reference, -exponent)
    W = _times_power_of_two(_square(W, len(reference)), -exponent)
    return float(np.linalg.norm(W - reference) / np.linalg.norm(reference))


def _times_power_of_two(W, exponent):
    """Returns 2^exponent W. Each half of the exponent is that of a double, also where the whole is not."""
    half = int(exponent) // 2
    return W * 2.0**half * 2.0**(int(exponent) - half)


def _measuring():
    """Returns the extension that measures, built in benchmarks/ beside the programs that do."""
    try:
        return importlib.import_module("._conditions", __name__)
    except ModuleNotFoundError:
        raise RuntimeError("isosyrk: was built without the extension that measures; its CMake target is"
                           " isosyrk_conditions") from None


# ---- arguments


def _observer(observe, W):
    view = W.view()
    view.flags.writeable = False

    def called(outcome):
        result = observe(outcome.steps, view, _report(outcome))
        return isinstance(result, (bool, np.bool_)) and bool(result)

    return called


def _amender(between, W):
    def called(step):
        view = W.view()
        result = between(step, view)
        if result is not None and result is not view:
            raise TypeError(f"between: returned a {type(result).__name__}, must change W in place and return None")

    return called


class _Bar:
    """A bar of progress. In a `with` it is what a run calls with the number of steps done."""

    def __init__(self, steps, outcome):
        try:
            from tqdm.auto import tqdm
        except ImportError:
            raise ImportError("progress: needs tqdm (the package python3-tqdm, or pip install tqdm)") from None
        self._bar = tqdm(total=steps, unit="step")
        self._outcome = outcome

    def __enter__(self):
        return self._show

    def _show(self, step):
        self._bar.update(step - self._bar.n)

    def __exit__(self, *_):
        self._show(self._outcome.steps)
        self._bar.close()


def _report(outcome):
    return Report(*(getattr(outcome, field) for field in Report._fields))


def _square(W, n=None, what="W"):
    """Returns a matrix of numbers as a complex128 array in C order, of shape (n, n) if n is given."""
    if isinstance(W, np.ma.MaskedArray):
        raise TypeError(f"{what}: is a masked array, must have all its entries")
    array = np.asarray(W)
    if array.dtype.kind not in "iufc" or not np.can_cast(array.dtype, np.complex128):
        raise ValueError(f"{what}: its dtype is {array.dtype}, must be real or complex, complex128 at most")
    size = n or (array.shape[0] if array.ndim == 2 else 0)
    if array.shape != (size, size) or not size:
        raise ValueError(f"{what}: its shape is {array.shape}, must be ({n or 'n'}, {n or 'n'})")
    return np.require(array, np.complex128, ("C", "A"))


def _skew_hermitian(W, what="W"):
    """Returns a square matrix, finite and skew-Hermitian to SKEW, as _square() does."""
    W = _square(W, what=what)
    if not np.isfinite(W).all():
        i, k = np.argwhere(~np.isfinite(W))[0]
        raise ValueError(f"{what}: entry ({i}, {k}) is {W[i, k]}, must be finite")
    defect, largest = _core.skew_defect(W), np.abs(W).max()
    if defect > SKEW * largest:
        raise ValueError(f"{what}: the largest entry of |{what} + {what}†| is {defect / largest:.3g} of the largest of"
                         f" |{what}|; must be at most {SKEW:.0e} (skew-Hermitian)")
    return W


def _state(W, scene):
    """Returns a matrix that a step can begin with; its figures are in the message if it cannot."""
    array = _square(W, scene.n)
    scene._core.require_initial_data(array)
    return array


def _initial(W, n):
    array = _square(W, None if n is None else _whole(n, "n", 2, LARGEST_N))
    if not 2 <= len(array) <= LARGEST_N:
        raise ValueError(f"initial: n = {len(array)}, must be 2 to {LARGEST_N}")
    _core.require_initial_data(array)
    return array


def _output(out, n):
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out: is a {type(out).__name__}, must be an array")
    if out.dtype != np.complex128 or out.shape != (n, n):
        raise ValueError(f"out: is {out.dtype} of shape {out.shape}, must be complex128 of shape ({n}, {n})")
    if not out.flags.c_contiguous or not out.flags.writeable or not out.flags.aligned:
        raise ValueError("out: must be writable, in C order and aligned")
    return out.view(np.ndarray)


def _mode(mode):
    try:
        l, m, re, im = mode
    except (TypeError, ValueError):
        raise ValueError(f"mode {mode!r}: must be (l, m, re, im)") from None
    return _whole(l, "l", 1, LARGEST_N), _whole(m, "m", 0, LARGEST_N), _real(re, "re"), _real(im, "im")


def _text(value, what):
    if not isinstance(value, str):
        raise TypeError(f"{what}: is a {type(value).__name__}, must be a text")
    if not value.isprintable():
        raise ValueError(f"{what} {value!a}: must be printable")
    return value


def _solver(value):
    if _text(value, "solver") not in SOLVERS:
        raise ValueError(f"solver '{value}': must be published or fast")
    return value


def _products(value, n):
    """Returns the backend of a choice of products for n x n matrices, measured if that is "fastest"."""
    if _text(value, "products") not in PRODUCTS:
        raise ValueError(f"products '{value}': must be fastest, openblas or eigen")
    return _measuring().fastest_products(n) if value == "fastest" else value


def _whole(value, what, least, most=10**15):
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{what}: is a {type(value).__name__}, must be a whole number") from None
    if not least <= number <= most:
        raise ValueError(f"{what} = {number}: must be {least} to {most}")
    return number


def _real(value, what, finite=True):
    try:
        if np.asarray(value).dtype.kind not in "biufO":
            raise TypeError
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{what}: is a {type(value).__name__}, must be a number") from None
    except OverflowError:
        raise ValueError(f"{what}: is too large, must be finite") from None
    if finite and not math.isfinite(number):
        raise ValueError(f"{what} = {number}: must be finite")
    return number


# They use what stands above.
from . import quflow  # noqa: E402
from .fluid import energy_spectrum, laplace, modes, plot, solve_poisson, vorticity  # noqa: E402
