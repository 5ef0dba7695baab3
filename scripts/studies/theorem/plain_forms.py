"""One step of the three formulations, written plainly: a check of core/ that shares nothing with it, and a means to go
where the theorem ends. Source: the paper; equations as in core/README.md.

Everywhere: a (s, s) and b (s,) are the tableau; B maps a matrix (n, n) to its generator; W0 and J are (n, n). Arrays of
stages are (s, n, n). Picard sweeps from a cold start; all new unknowns come from the old ones.
"""

from typing import NamedTuple

import numpy as np

SWEEPS, CHANGE = 300, 1e-15  # a step takes so many sweeps, fewer if the largest change of an entry is below this
ROUNDING = 1e-13  # a larger change in the last sweep is a failure, not rounding


class Step(NamedTuple):
    W1: np.ndarray
    Q1: np.ndarray = None  # of cotangent and group
    M: np.ndarray = None  # of algebra: M_jk = h B_j (X_k + Σ_m a_jm M_mk), (s, s, n, n)


def gauss(s):
    """Returns (a, b) of the Gauss tableau with s stages: a_ij integrates the j-th Lagrange polynomial from 0 to c_i."""
    x, w = np.polynomial.legendre.leggauss(s)
    c, k = (1 + x) / 2, np.arange(s)
    return (c[:, None] ** (k + 1) / (k + 1)) @ np.linalg.inv(c[:, None] ** k), w / 2


def _tableau(rows, weights, divisor):
    return np.array(rows) / divisor, np.array(weights) / divisor


# Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.4, and Hairer, Wanner, IV.5 for IIIC.
RADAU_IIA = _tableau([[5, -1], [9, 3]], [9, 3], 12)
LOBATTO_IIIA = {2: _tableau([[0, 0], [1, 1]], [1, 1], 2),
                3: _tableau([[0, 0, 0], [5, 8, -1], [4, 16, 4]], [4, 16, 4], 24)}
LOBATTO_IIIB = {2: _tableau([[1, 0], [1, 0]], [1, 1], 2),
                3: _tableau([[1, -1, 0], [1, 2, 0], [1, 5, 0]], [1, 4, 1], 6)}
LOBATTO_IIIC = {2: _tableau([[1, -1], [1, 1]], [1, 1], 2),
                3: _tableau([[2, -4, 2], [2, 5, -1], [2, 8, 2]], [2, 8, 2], 12)}


def dagger(X):
    """Returns the conjugate transpose of each matrix of an array (..., n, n)."""
    return np.swapaxes(X, -1, -2).conj()


def weighted(a, X):
    """Returns Σ_j a_ij X_j for every i, or Σ_j b_j X_j for weights b."""
    return np.tensordot(a, X, 1)


def each_stage(B, W):
    return np.array([B(each) for each in W])


def solved(sweep, *unknowns):
    """Returns the fixed point of a sweep of arrays. Raises ArithmeticError if it does not converge."""
    unknowns = [np.array(each) for each in unknowns]
    for _ in range(SWEEPS):
        before, unknowns = unknowns, sweep(*unknowns)
        change = max(abs(new - old).max() for new, old in zip(unknowns, before))
        if not change >= CHANGE:
            break
    if not change < ROUNDING:
        raise ArithmeticError(f"a step does not converge: the last change is {change:.1e}")
    return unknowns


def cotangent(a, b, B, W0, h, a_hat=None):
    """Returns the Step on T*G; a_hat is the tableau of P in a partitioned pair, by default that of Q."""
    I, a_hat = np.eye(len(W0)), a if a_hat is None else a_hat

    def moved(of_Q, of_P, Q, P):
        Bs = each_stage(B, dagger(Q) @ P)
        return I + h * weighted(of_Q, Q @ dagger(Bs)), W0 - h * weighted(of_P, P @ Bs)

    Q1, P1 = moved(b, b, *solved(lambda Q, P: moved(a, a_hat, Q, P), [I] * len(b), [W0] * len(b)))
    return Step(dagger(Q1) @ P1, Q1)


def group(a, b, B, W0, h, J, adjoint=dagger):
    """Returns the Step on G. Another `adjoint`, the identity, makes the printed W̃ = Q W₀ J Q J⁻¹."""
    I, J_inverse = np.eye(len(W0)), np.linalg.inv(J)

    def transported(Q):
        return adjoint(Q) @ W0 @ J @ Q @ J_inverse

    def moved(weights, Q):
        return I + h * weighted(weights, Q @ dagger(each_stage(B, transported(Q))))

    Q1 = moved(b, *solved(lambda Q: (moved(a, Q),), [I] * len(b)))
    return Step(transported(Q1), Q1)


def algebra(a, b, B, W0, h, J, printed=False):
    """Returns the Step on g; `printed` takes h B(W̃_i) for h B(W̃_j) in K_ij, as the paper prints it."""
    J_inverse = np.linalg.inv(J)

    def sweep(X, K, W):
        Bs = each_stage(B, W)
        X_sum, K_sum = weighted(a, X), np.einsum("jm,imab->ijab", a, K)
        X = -h * (W0 + X_sum) @ Bs
        K = h * (Bs[:, None] if printed else Bs[None]) @ (X_sum[:, None] + K_sum)
        return X, K, W0 + weighted(a, X - J_inverse @ dagger(X) @ J) + np.einsum("ij,ijab->iab", a, K)

    X = np.zeros((len(b), *np.shape(W0)))
    K = np.zeros((len(b), *X.shape))
    X, K, W = solved(sweep, X, K, [W0] * len(b))
    Bs = each_stage(B, W)
    M, = solved(lambda M: (h * Bs[:, None] @ (X[None] + weighted(a, M)),), K)
    return Step(W0 + h * weighted(b, Bs @ W - W @ Bs), M=M)
