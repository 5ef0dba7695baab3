"""Integrators for quflow.solve: every method of isosyrk.integrators(), called as quflow calls its own.

    import isosyrk, quflow

    method = isosyrk.quflow.integrator("elp6_frame", tolerance=1e-8)
    quflow.solve(W, dt=0.1, simtime=10.0, integrator=method)

Written for quflow's commit b42eede of June 2026. It needs nothing of quflow's, which is not imported.
"""

from typing import Callable, Optional

import numpy as np

from . import SKEW, _core, _real, _whole, integrator as _integrator_of_scene, scene as _scene

__all__ = ["Integrator", "integrator"]

# quflow makes W in single precision by sums of up to n terms, each with a rounding of 6e-8.
SKEW_IN_SINGLE_PRECISION = 1e-5

# What quflow's own integrators take and these do not: the value that changes nothing, and what to do instead.
_ELSEWHERE = {
    "forcing": (None, "use between=f of isosyrk.integrator(…).run(…), f(step, W) changing W after each step"),
    "strang_splitting": (None, "use between=f of isosyrk.integrator(…).run(…), with half a step before and after"),
    "tol": ("auto", "use isosyrk.quflow.integrator(…, tolerance=…), which is relative to W"),
    "maxit": (10, "use isosyrk.quflow.integrator(…, max_sweeps=…)"),
    "minit": (1, "leave it out; a step ends where it meets the tolerance"),
    "compsum": (False, "leave it out, and choose isosyrk.quflow.integrator(…, tolerance=…)"),
    "reinitialize": (False, "use isosyrk.quflow.integrator(…, without='predictor')"),
}


class Integrator:
    """A method of isosyrk for quflow.solve(..., integrator=...). Made by integrator().

    Calls on the state that the last call left go on as one run: a fast method predicts from its past steps. It pickles,
    also into a QuSimulation, and copies as its name and options, without past steps.
    """

    def __init__(self, name, options):
        self.name: str = name
        self.options: dict = options
        self._methods = {}  # by n
        self._unrounded = {}  # by n: the last state in double precision, of which a complex64 W is the rounding

    def __call__(self, W: np.ndarray, dt: float, steps: int = 100, hamiltonian: Optional[Callable] = None,
                 time: Optional[float] = None, forcing: None = None, strang_splitting: None = None,
                 stats: Optional[dict] = None, callback: Optional[Callable] = None, tol="auto", maxit: int = 10,
                 minit: int = 1, verbatim: bool = False, compsum: bool = False, reinitialize: bool = False):
        """Takes `steps` steps of dt, in quflow's units of time, from W; overwrites W and returns it.

        W            complex128 or complex64, shape (N, N), skew-Hermitian; any memory layout. Steps are in double
                     precision.
        hamiltonian  quflow's solve_poisson, or None for the same.
        time         without effect, for the equations do not depend on it.
        stats        a dictionary that gets iterations (sweeps a step; 0 for explicit methods), number_of_maxit (0) and
                     tol_auto (the tolerance, relative to W or as isosyrk.integrator() says).
        callback     called as callback(W, dW) after each step, with read-only copies of the state before the step and
                     its change.
        verbatim     prints the sweeps a step.
        The other arguments of quflow's isomp must have the values that it gives them by default.

        Raises ValueError or TypeError before the first step, in one line that says what to do instead;
        isosyrk.SolverError where a step does not converge. W is then the state after the last step done.
        """
        _require_poisson(hamiltonian)
        given = dict(forcing=forcing, strang_splitting=strang_splitting, tol=_automatic(tol), maxit=maxit, minit=minit,
                     compsum=compsum, reinitialize=reinitialize)
        for what, (default, instead) in _ELSEWHERE.items():
            if given[what] is not default and not (np.isscalar(given[what]) and given[what] == default):
                raise ValueError(f"{what}: not taken here; {instead}")
        for what, value in (("stats", stats), ("callback", callback)):
            _require_kind(what, value)
        _require_matrix(W)
        dt, steps = _real(dt, "dt"), _whole(steps, "steps", 0)
        state = self._state(W)
        method = self._method(state)
        observe = None if callback is None else _observer(callback, state, W.dtype)
        try:
            _, report = method.run(state, dt, steps, observe=observe, out=state)
        except BaseException as error:
            if getattr(error, "W", None) is state:
                error.W = W
            if not np.array_equal(state, self._state(W)):  # a run that did not begin leaves W as it is
                W[...] = state
            raise
        W[...] = state
        if W.dtype == np.complex64:
            self._unrounded[len(W)] = state
        sweeps = report.sweeps / max(steps, 1)
        if stats is not None:
            stats.update(iterations=sweeps, number_of_maxit=0.0, tol_auto=method._options["tolerance"])
        if verbatim:
            print(f"{sweeps:.2f} sweeps a step")
        return W

    def _state(self, W):
        """Returns W as a new complex128 array in C order; where W is the rounding of the last state, that state."""
        if W.dtype == np.complex128:
            return np.array(W, order="C", subok=False)
        unrounded = self._unrounded.get(len(W))
        if unrounded is not None and np.array_equal(unrounded.astype(np.complex64), W):
            return unrounded
        state = np.array(W, np.complex128, order="C", subok=False)
        return (state - state.conj().T) / 2

    def _method(self, state):
        if len(state) not in self._methods:
            scene = _scene("quflow", initial=state, hbar="standard")
            self._methods[len(state)] = _integrator_of_scene(scene, self.name, **self.options)
        return self._methods[len(state)]

    def __reduce__(self):
        return _integrator_again, (self.name, self.options)

    def __repr__(self):
        options = "".join(f", {what}={value!r}" for what, value in self.options.items())
        return f"isosyrk.quflow.integrator({self.name!r}{options})"


def integrator(name: str = "algebra1", **options) -> Integrator:
    """Returns the integrator with this name of isosyrk.integrators() for quflow.solve(W, ..., integrator=...).

    name     "algebra1" is the method of quflow's isomp; "elp6_frame" with tolerance=1e-8 is for small errors.
    options  of isosyrk.integrator(): tolerance, threads, max_sweeps, without, products, and solver, here "fast" unless
             said otherwise.
    Raises as isosyrk.integrator().
    """
    options.setdefault("solver", "fast")
    # A wrong name or option is told here, not in the first call.
    _integrator_of_scene(_scene("smooth", n=5, hbar="standard"), name, **options)
    return Integrator(name, options)


def _integrator_again(name, options):
    return integrator(name, **options)


def _require_poisson(hamiltonian):
    """Raises ValueError unless this is None or the solve_poisson of one of quflow's laplacians on the CPU."""
    if hamiltonian is None:
        return
    module, name = getattr(hamiltonian, "__module__", None), getattr(hamiltonian, "__name__", None)
    module = str(module)
    if name != "solve_poisson" or not module.startswith("quflow.laplacian.") or module.endswith(".gpu"):
        raise ValueError("hamiltonian: must be quflow's solve_poisson; for a P(W) of your own run isosyrk.integrator()"
                         " on isosyrk.scene(initial=W, generator=lambda W: P(W) / hbar)")


def _automatic(tol):
    """Returns "auto" for what quflow takes as such."""
    return "auto" if isinstance(tol, (int, float, np.number)) and tol < 0 else tol


def _require_kind(what, value):
    if value is None:
        return
    if what == "stats" and not isinstance(value, dict):
        raise TypeError(f"stats: is a {type(value).__name__}, must be a dictionary to fill, or left out")
    if what == "callback" and not callable(value):
        raise TypeError(f"callback: is a {type(value).__name__}, must be a function of W and dW, or left out")


def _require_matrix(W):
    """Raises unless W can be overwritten by the end of a run that begins with it."""
    if not isinstance(W, np.ndarray) or isinstance(W, np.ma.MaskedArray):
        raise TypeError(f"W: is a {type(W).__name__}, must be a NumPy array; one on a GPU goes with quflow's IsompCUDA")
    if W.dtype not in (np.complex128, np.complex64):
        raise ValueError(f"W: its dtype is {W.dtype}, must be complex128 or complex64; W.astype(complex) is")
    if W.ndim != 2 or W.shape[0] != W.shape[1]:
        raise ValueError(f"W: its shape is {W.shape}, must be (N, N); call it once for each matrix of a stack")
    if not W.flags.writeable:
        raise ValueError("W: is read-only, and is overwritten; pass W.copy()")
    limit = SKEW if W.dtype == np.complex128 else SKEW_IN_SINGLE_PRECISION
    defect, largest = _core.skew_defect(W.astype(np.complex128, order="C")), np.abs(W).max(initial=0.0)
    if defect > limit * largest:
        raise ValueError(f"W: the largest entry of |W + W†| is {defect / largest:.3g} of the largest of |W|; must be at"
                         f" most {limit:.0e}; pass (W - W.conj().T) / 2")


def _observer(callback, state, dtype):
    """Returns what calls quflow's callback(W, dW) where a run calls observe(step, W, report)."""
    before = state.copy()

    def observe(step, W, report):
        nonlocal before
        arguments = before.astype(dtype), (W - before).astype(dtype)
        for array in arguments:
            array.flags.writeable = False  # a change of them would be lost
        callback(*arguments)
        before = W.copy()

    return observe
