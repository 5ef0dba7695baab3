"""What a vorticity matrix W says of the fluid: coefficients, energies of scales, ω on the sphere, Δ and its inverse.

Its functions are those of isosyrk: modes(), energy_spectrum(), vorticity(), plot(), laplace(), solve_poisson(). They
take any W of shape (n, n), 2 <= n <= 4096, finite and skew-Hermitian to 1e-10 relative, and read its upper triangle;
another one is a ValueError. None depends on ħ. README.md has the conventions, and how they go with quflow's.
"""

from typing import List, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import LARGEST_N, Matrix, Mode, _core, _real, _skew_hermitian, _text, _times_power_of_two

__all__ = ["energy_spectrum", "laplace", "modes", "plot", "solve_poisson", "vorticity"]

PROJECTIONS = ("mollweide", "orthographic")
MIN_ROWS, MAX_ROWS = 180, 720  # of the grid that plot() draws: four a wave of the smallest scale, within these


def modes(W: ArrayLike) -> List[Mode]:
    """Returns the coefficients of W as (l, m, re, im) for l = 1 … n - 1 and m = 0 … l, as scene(modes=…) takes them.

    W = i Σ_l [ω_l0 T_l0 + Σ_{m>0} (ω_lm T_lm + conj(ω_lm) T_lm†)] + (tr W/n) I with ω_lm = re + i im: T_lm has
    Frobenius norm 1, on diagonal m, and its first entry has the sign (-1)^m. The trace of W is in no mode.
    scene(modes=modes(W), n=n).initial is W without its trace, over the 2-norm of that, to rounding.
    """
    coefficients = _core.harmonic_coefficients(_vorticity_matrix(W))
    real, imaginary = coefficients.real.tolist(), coefficients.imag.tolist()
    return [(l, m, real[l][m], imaginary[l][m]) for l in range(1, len(coefficients)) for m in range(l + 1)]


def energy_spectrum(W: ArrayLike) -> NDArray[np.float64]:
    """Returns the energies E(l) of the degrees l = 0 … n - 1, shape (n,); E(0) is 0.

    E(l) = Σ_m |ω_lm|²/(2 l(l+1)) over m = -l … l, with ω_lm as modes() has it. Their sum is the energy of a scene,
    scene.energy(W). Raises ValueError where no double holds it: for norms beyond about 1e154 and below 1e-154.
    """
    W = _vorticity_matrix(W)
    # Squares overflow at 1e154, and a power of two as unit changes no digit.
    _, exponent = np.frexp(np.abs(W).max())
    squares = np.abs(_core.harmonic_coefficients(_times_power_of_two(W, -exponent)))**2
    degrees = np.arange(1, len(W))
    energies = np.zeros(len(W))
    energies[1:] = (squares[1:, 0] + 2 * squares[1:, 1:].sum(axis=1)) / (2 * degrees * (degrees + 1))
    with np.errstate(over="ignore"):
        scaled = _times_power_of_two(energies, 2 * exponent)
    total = scaled.sum()
    if energies.any() and not np.finfo(float).tiny <= total < np.inf:
        raise ValueError(f"W: its energies are about 1e{np.log10(energies.max()) + 2 * exponent * np.log10(2):.0f},"
                         " which no double holds; those of c W are c^2 times as large")
    return scaled


def vorticity(W: ArrayLike, latitudes: ArrayLike, longitudes: ArrayLike, berezin: bool = False) -> NDArray[np.float64]:
    """Returns the vorticity ω of W on a grid, real, shape (len(latitudes), len(longitudes)).

    latitudes   in radians, from -π/2 to π/2 (the north pole); any numbers, in any order.
    longitudes  in radians, any numbers.
    berezin     damps degree l by √(Π_{k<=l} (n-k)/(n+k)), about exp(-l²/2n), as quflow does by default since June 2026:
                ω at a point is then the expectation of -iW in the coherent state there, within the spectrum of -iW.
                Without it, mean squares are kept: that of ω over the sphere is ‖W‖²_F/n.

    At longitude λ and latitude β, ω = Σ_l (-1)^l [ω_l0 P_l0 + 2 Re Σ_{m>0} ω_lm P_lm exp(-imλ)]/√n with ω_lm as modes()
    has it and ω_00 = tr W/(i√n). P_lm is the associated Legendre function of sin β without the phase of Condon and
    Shortley, and P_lm exp(imλ) has mean square 1 over the sphere. So iI stands for 1, and iħS_x, -iħS_y and -iħS_z for
    the coordinates x, y and z, with spin matrices S_a and ħ = 2/√(n²-1). Values are those of quflow's
    shr2fun(mat2shr(W), berezin=…) at colatitude π/2 - β, and the fluid turns anticlockwise, seen from outside, where
    ω > 0.

    It takes O(n²) operations for each latitude, and memory for about n (2n + 2k) complex numbers for k latitudes and
    longitudes in all, beside the result.
    """
    W = _vorticity_matrix(W)
    latitudes, longitudes = _angles(latitudes, "latitudes"), _angles(longitudes, "longitudes")
    if not isinstance(berezin, (bool, np.bool_)):
        raise TypeError(f"berezin: is a {type(berezin).__name__}, must be True or False")
    outside = latitudes[np.abs(latitudes) > np.pi / 2]
    if outside.size:
        raise ValueError(f"latitudes: {outside[0]:g} is among them, must be -pi/2 to pi/2 (radians)")
    n = len(W)
    coefficients = _core.harmonic_coefficients(W)
    weights = (-1.0)**np.arange(n) / np.sqrt(n)
    if berezin:
        weights *= _berezin_weights(n)
    coefficients *= weights[:, np.newaxis]
    waves = _core.along_latitudes(coefficients, latitudes)
    waves[:, 1:] *= 2
    angles = np.multiply.outer(np.arange(n), longitudes)
    # Contiguous, as BLAS needs them: otherwise NumPy multiplies by a plain loop.
    real, imaginary = np.ascontiguousarray(waves.real), np.ascontiguousarray(waves.imag)
    return real @ np.cos(angles) + imaginary @ np.sin(angles)


def plot(W: ArrayLike, projection: str = "mollweide", center: Tuple[float, float] = (0.0, 0.0), *,
         title: Optional[str] = None, vmax: Optional[float] = None, berezin: bool = False, axes=None):
    """Returns a matplotlib figure of the vorticity of W, as vorticity() has it; north is up, and east is right.

    It is one of matplotlib.pyplot, which keeps it until pyplot.close(figure).

    projection  "mollweide" (of equal areas, the whole sphere) or "orthographic" (the half seen from above center).
    center      latitude and longitude in the middle, in radians; with mollweide the latitude is 0.
    title       above the picture.
    vmax        colours are symmetric, from -vmax to vmax; by default the largest |ω| of the grid that is drawn.
    axes        where to draw, in place of a new figure with a colour bar: axes of matplotlib's projection "mollweide",
                or ordinary ones for orthographic. Their figure is returned.

    Raises ImportError without matplotlib, which only this function needs.
    """
    if _text(projection, "projection") not in PROJECTIONS:
        raise ValueError(f"projection '{projection}': must be {' or '.join(PROJECTIONS)}")
    latitude, longitude = _center(center)
    if projection == "mollweide" and latitude != 0:
        raise ValueError(f"center: its latitude is {latitude:g}, must be 0 with mollweide")
    if abs(latitude) > np.pi / 2:
        raise ValueError(f"center: its latitude is {latitude:g}, must be -pi/2 to pi/2 (radians)")
    if title is not None and not isinstance(title, str):
        raise TypeError(f"title: is a {type(title).__name__}, must be a text")
    vmax = None if vmax is None else _real(vmax, "vmax")
    if vmax is not None and vmax <= 0:
        raise ValueError(f"vmax = {vmax:g}: must be above 0")
    if axes is not None and not hasattr(axes, "pcolormesh"):
        raise TypeError(f"axes: is a {type(axes).__name__}, must be axes of matplotlib")
    try:
        from matplotlib import pyplot
    except ImportError:
        raise ImportError("plot: needs matplotlib (the package python3-matplotlib, or pip install matplotlib)"
                          ) from None
    W = _vorticity_matrix(W)
    rows = min(max(2 * len(W), MIN_ROWS), MAX_ROWS)
    edges = np.linspace(-np.pi / 2, np.pi / 2, rows + 1), np.linspace(-np.pi, np.pi, 2 * rows + 1)
    middles = [(each[1:] + each[:-1]) / 2 for each in edges]
    field = vorticity(W, middles[0], middles[1] + longitude, berezin)
    vmax = vmax or np.abs(field).max() or 1.0
    is_new = axes is None
    if is_new:
        figure = pyplot.figure(figsize=(8, 4.2) if projection == "mollweide" else (5.4, 4.6), layout="constrained")
        axes = figure.add_subplot(projection="mollweide" if projection == "mollweide" else None)
    elif (axes.name == "mollweide") != (projection == "mollweide"):
        raise ValueError("axes: must be of matplotlib's projection mollweide" if projection == "mollweide" else
                         "axes: are of matplotlib's projection mollweide, must be ordinary ones with orthographic")
    colours = {"cmap": "RdBu_r", "vmin": -vmax, "vmax": vmax, "rasterized": True}
    if projection == "mollweide":
        mesh = _draw_whole(axes, edges, field, colours)
    else:
        mesh = _draw_half(axes, latitude, edges, field, colours)
    if title is not None:
        axes.set_title(title)
    if is_new:
        figure.colorbar(mesh, ax=axes, label="vorticity", shrink=0.8)
    return axes.figure


def laplace(P: ArrayLike) -> Matrix:
    """Returns ΔP = -Σ_a [S_a, [S_a, P]] with the spin matrices S_a, shape (n, n), in O(n²) operations.

    Δ has the eigenvalues -l(l+1), with the T_lm of modes() as eigenvectors. It takes a multiple of I to 0.
    """
    return _core.laplace(_vorticity_matrix(P, "P"))


def solve_poisson(W: ArrayLike) -> Matrix:
    """Returns the stream matrix P with ΔP = W and trace 0, shape (n, n), in O(n²) operations.

    The multiple of I in W, (tr W/n) I, is not in the range of Δ and is left out. P/ħ is the generator B(W) of a scene.
    """
    return _core.solve_poisson(_vorticity_matrix(W))


def _vorticity_matrix(W, what="W"):
    """Returns W as a complex128 array in C order, if it is one that the functions of this file take."""
    W = _skew_hermitian(W, what)
    if not 2 <= len(W) <= LARGEST_N:
        raise ValueError(f"{what}: n = {len(W)}, must be 2 to {LARGEST_N}")
    return W


def _angles(values, what):
    array = np.asarray(values)
    if array.dtype.kind not in "iuf" and array.size:
        raise TypeError(f"{what}: dtype is {array.dtype}, must be real numbers (radians)")
    if array.ndim != 1:
        raise ValueError(f"{what}: shape is {array.shape}, must be (k,)")
    array = array.astype(float)
    if not np.isfinite(array).all():
        raise ValueError(f"{what}: must be finite")
    return array


def _center(center):
    try:
        latitude, longitude = center
    except (TypeError, ValueError):
        raise ValueError(f"center {center!r}: must be (latitude, longitude)") from None
    return _real(latitude, "center: its latitude"), _real(longitude, "center: its longitude")


def _berezin_weights(n):
    """Returns √(Π_{k=1…l} (n-k)/(n+k)) for l = 0 … n - 1."""
    k = np.arange(1, n)
    return np.sqrt(np.concatenate([[1.0], np.cumprod((n - k) / (n + k))]))


def _draw_whole(axes, edges, field, colours):
    """Draws cells with these edges of latitude and longitude in axes of matplotlib's projection mollweide."""
    axes.grid(False)  # which would lie below
    mesh = axes.pcolormesh(*np.meshgrid(edges[1], edges[0]), field, **colours)
    axes.grid(alpha=0.2, color="black")
    axes.set(xticklabels=[], yticklabels=[])
    return mesh


def _draw_half(axes, latitude, edges, field, colours):
    """Draws the cells that are seen from above a latitude, on the meridian 0, in orthographic projection."""
    x, y, is_hidden = _seen_from_above(latitude, *edges)
    mesh = axes.pcolormesh(x, y, np.ma.array(field, mask=is_hidden), **colours)
    rim = np.linspace(0, 2 * np.pi, 361)
    axes.plot(np.cos(rim), np.sin(rim), color="black", linewidth=0.8)
    axes.set(aspect="equal", xlim=(-1.02, 1.02), ylim=(-1.02, 1.02))
    axes.axis("off")
    return mesh


def _seen_from_above(latitude, latitudes, longitudes):
    """Returns where the corners of cells are seen from above a latitude on the meridian 0, x and y, and which cells are
    not seen. Corners behind are drawn to the rim, so that cells across it end there.
    """
    latitudes = latitudes[:, np.newaxis]
    x = np.cos(latitudes) * np.sin(longitudes)
    y = (np.cos(latitude) * np.sin(latitudes) - np.sin(latitude) * np.cos(latitudes) * np.cos(longitudes))
    depth = np.sin(latitude) * np.sin(latitudes) + np.cos(latitude) * np.cos(latitudes) * np.cos(longitudes)
    is_behind = depth < 0
    radius = np.where(is_behind, np.maximum(np.hypot(x, y), np.finfo(float).tiny), 1.0)
    is_hidden = is_behind[1:, 1:] & is_behind[1:, :-1] & is_behind[:-1, 1:] & is_behind[:-1, :-1]
    return x / radius, y / radius, is_hidden
