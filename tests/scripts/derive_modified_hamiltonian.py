#!/usr/bin/env python3
"""Derives the coefficients of the modified Hamiltonian F of the exponential Lie-Poisson methods, in exact fractions.

The flow is W' = [B(W), W] with B linear and self-adjoint in <a, b> = -tr(ab), and H(W) = <W, BW>/2. The method is

    Omega = h grad F(mu),    mu = phi1(ad Omega) W0,    W1 = W0 + [Omega, mu],    phi1(z) = (e^z - 1)/z,

with F = H + h^2 F2 + h^4 F4, and with v = B mu, f = [v, mu], v1 = Bf, p = [v, f], c = [v1, mu], w = [v, v1]

    F2 = x <f, Bf>,    F4 = y1 <p, Bp> + y2 <p, Bc> + y3 <c, Bc> + y4 <p, w> + y5 <c, w>.

What is asked: x and y1 ... y5 such that W1 agrees with the exact flow up to h^3 and h^5.

How: W1 and the exact W(h) are expanded in powers of h for a flow on so(n) with random rational B and W0. B multiplies
the entry (i, j) by a number c_ij = c_ji. An unknown enters the coefficient of h^3 or h^5 for the first time with

    [grad T(W0), W0]    for its term T,

because Omega has h^3 x grad T(mu) or h^5 y grad T(mu), and mu = W0 + O(h). So the coefficient of W1 - W(h) is linear
in the unknowns: one equation for each entry of a matrix in so(n). There are more equations than unknowns, and the
solution is required to be the only one and to solve them all. With it, the coefficients of h^2 and h^4 vanish too.

Gradients are taken by differentiating forwards, along each element of a basis of so(n). The C++ code differentiates
backwards by hand; nothing of its formulas is used here.

core/integrators/EXPONENTIAL.md derives the same coefficients from the Hamilton-Jacobi equation d(hF)/dh = H(W1), with
W1 as a function of mu and Omega. hamilton_jacobi_defect() checks that equation.

    derive_modified_hamiltonian.py    prints the coefficients
"""

import random
from fractions import Fraction

HIGHEST = 5  # powers of h that are kept


# ---- matrices of fractions, as tuples of rows

def add(*matrices):
    return tuple(tuple(map(sum, zip(*rows))) for rows in zip(*matrices))


def times(number, A):
    return tuple(tuple(number * entry for entry in row) for row in A)


def bracket_of_matrices(A, C):
    n = range(len(A))
    return tuple(tuple(sum(A[i][k] * C[k][j] - C[i][k] * A[k][j] for k in n) for j in n) for i in n)


def zero(n):
    return ((Fraction(0),) * n,) * n


def basis(n):
    """Returns the E_ij - E_ji, i < j: orthogonal, <E, E> = 2."""
    def element(i, j):
        return tuple(tuple(Fraction((r, c) == (i, j)) - Fraction((r, c) == (j, i)) for c in range(n)) for r in range(n))
    return [element(i, j) for i in range(n) for j in range(i + 1, n)]


# ---- power series in h, as lists of coefficients

def series(A):
    return [A] + [zero(len(A))] * HIGHEST


def sum_of(*all_series):
    return [add(*each) for each in zip(*all_series)]


def scaled(number, X):
    return [times(number, each) for each in X]


def times_power_of_h(power, X):
    return [zero(len(X[0]))] * power + X[:len(X) - power]


def bracket(X, Y):
    result = series(zero(len(X[0])))
    for i, A in enumerate(X):
        for k, C in enumerate(Y[:len(Y) - i], i):
            if any(map(any, A)) and any(map(any, C)):
                result[k] = add(result[k], bracket_of_matrices(A, C))
    return result


def pairing(X, Y):
    """Returns <X, Y> = -tr(XY), a list of numbers."""
    n = range(len(X[0]))

    def of_matrices(A, C):
        return -sum(A[i][j] * C[j][i] for i in n for j in n)
    return [sum(of_matrices(X[i], Y[k - i]) for i in range(k + 1)) for k in range(HIGHEST + 1)]


# ---- the same with a derivative along one direction: pairs (value, derivative)

class Dual:
    """A power series of matrices that depends on mu, and its derivative."""

    def __init__(self, value, derivative):
        self.value, self.derivative = value, derivative

    def bracket(self, other):
        return Dual(bracket(self.value, other.value),
                    sum_of(bracket(self.value, other.derivative), bracket(self.derivative, other.value)))

    def under(self, B):
        return Dual(B(self.value), B(self.derivative))

    def derivative_of_pairing(self, other):
        return [a + b for a, b in zip(pairing(self.value, other.derivative), pairing(self.derivative, other.value))]


TERMS = {"f_Bf": 2, "p_Bp": 4, "p_Bc": 4, "c_Bc": 4, "p_w": 4, "c_w": 4}  # and the power of h that goes with each


def factors_of(terms, mu, B):
    """Returns the two factors of each of these terms, and perhaps of others, at mu, a Dual."""
    f = mu.under(B).bracket(mu)
    factors = {"f_Bf": (f, f.under(B))}
    if set(terms) - set(factors):
        v, v1 = mu.under(B), f.under(B)
        p, c, w = v.bracket(f), v1.bracket(mu), v.bracket(v1)
        Bp, Bc = p.under(B), c.under(B)
        factors.update({"p_Bp": (p, Bp), "p_Bc": (p, Bc), "c_Bc": (c, Bc), "p_w": (p, w), "c_w": (c, w)})
    return factors


def derivative_of(terms, mu, direction, B):
    """Returns the derivatives of these terms at mu, a power series, along a constant direction."""
    factors = factors_of(terms, Dual(mu, series(direction)), B)
    return {name: factors[name][0].derivative_of_pairing(factors[name][1]) for name in terms}


class Flow:
    """W' = [B(W), W] on so(n) with random rational B, and a random rational W0."""

    def __init__(self, n, seed):
        numbers = random.Random(seed)

        def number():
            return Fraction(numbers.randint(-6, 6), numbers.randint(1, 4))
        self.basis = basis(n)
        c = [[Fraction(0)] * n for _ in range(n)]
        for i in range(n):
            for j in range(i):
                c[i][j] = c[j][i] = number()
        self.B = lambda X: [tuple(tuple(c[i][j] * A[i][j] for j in range(n)) for i in range(n)) for A in X]
        self.W0 = add(*(times(number(), E) for E in self.basis))

    def gradients(self, terms, mu):
        """Returns the gradients of these terms at mu, as power series of matrices."""
        along = [derivative_of(terms, mu, E, self.B) for E in self.basis] if terms else ()
        return {name: [add(*(times(each[name][k] / 2, E) for each, E in zip(along, self.basis)))
                       for k in range(HIGHEST + 1)] for name in terms}

    def exact(self):
        """Returns the power series of the exact solution: (k + 1) W_{k+1} = sum of [B W_i, W_{k-i}]."""
        W = [self.W0]
        for k in range(HIGHEST):
            BW = self.B(W)
            W.append(times(Fraction(1, k + 1), add(*(bracket_of_matrices(BW[i], W[k - i]) for i in range(k + 1)))))
        return W

    def mapped(self, coefficients):
        """Returns the power series of W1 of the method, for these coefficients of F; those not given are 0."""
        W0 = series(self.W0)
        Omega = times_power_of_h(1, series(zero(len(self.W0))))
        for _ in range(HIGHEST):  # each repetition gives one more power of h
            mu = term = W0
            for k in range(1, HIGHEST + 1):  # phi1(ad Omega) W0 = sum of T_k / (k + 1)
                term = scaled(Fraction(1, k), bracket(Omega, term))
                mu = sum_of(mu, scaled(Fraction(1, k + 1), term))
            Omega = self.Omega_of(mu, coefficients)
        return sum_of(W0, bracket(Omega, mu))

    def difference(self, coefficients):
        """Returns the power series of W1 - W(h)."""
        return sum_of(self.mapped(coefficients), scaled(-1, self.exact()))

    def Omega_of(self, mu, coefficients):
        """Returns the power series of h grad F(mu), for these coefficients of F; those not given are 0."""
        gradients = self.gradients(list(coefficients), mu)
        parts = (times_power_of_h(TERMS[name], scaled(coefficients[name], gradients[name])) for name in gradients)
        return times_power_of_h(1, sum_of(self.B(mu), *parts))  # B mu is the gradient of H

    def hamilton_jacobi_defect(self, coefficients):
        """Returns the power series of d(hF)/dh - H(W1) at mu = W0, with W1 = z/(1 - e^-z) mu and z = ad Omega."""
        mu = series(self.W0)
        Omega = self.Omega_of(mu, coefficients)
        W1, term = mu, mu
        for number in (Fraction(1, 2), Fraction(1, 12), 0, Fraction(-1, 720), 0):  # z/(1 - e^-z) = 1 + z/2 + z^2/12 ...
            term = bracket(Omega, term)
            W1 = sum_of(W1, scaled(number, term))
        F = [pairing(mu, self.B(mu))[0] / 2] + [Fraction(0)] * HIGHEST
        for name, (left, right) in factors_of(coefficients, Dual(mu, series(zero(len(self.W0)))), self.B).items():
            F[TERMS[name]] += coefficients.get(name, 0) * pairing(left.value, right.value)[0]
        H = [number / 2 for number in pairing(W1, self.B(W1))]
        return [(k + 1) * F[k] - H[k] for k in range(HIGHEST + 1)]

    def equations(self, known, unknown):
        """Returns rows (coefficients of the unknowns, right-hand side): one for each entry above the diagonal."""
        power = TERMS[unknown[0]] + 1
        difference = self.difference(known)
        assert not any(map(any, add(*(difference[k] for k in range(power))))), "lower powers must vanish"
        gradients = self.gradients(unknown, series(self.W0))
        columns = [bracket_of_matrices(gradients[name][0], self.W0) for name in unknown]
        n = len(self.W0)
        return [([column[i][j] for column in columns], -difference[power][i][j]) for i in range(n) for j in range(i)]


def solution(rows):
    """Returns the only solution of linear equations. Raises ArithmeticError if there is none, or more than one."""
    rows = [[*left, right] for left, right in rows]
    unknowns = len(rows[0]) - 1
    for k in range(unknowns):
        pivot = next((i for i in range(k, len(rows)) if rows[i][k]), None)
        if pivot is None:
            raise ArithmeticError("more than one solution")
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [entry / rows[k][k] for entry in rows[k]]
        for i, row in enumerate(rows):
            if i != k and row[k]:
                rows[i] = [entry - row[k] * other for entry, other in zip(row, rows[k])]
    if any(row[unknowns] for row in rows[unknowns:]):
        raise ArithmeticError("no solution")
    return [row[unknowns] for row in rows[:unknowns]]


FLOWS = ((4, 1), (5, 2))  # n and seed


def derived(terms=tuple(TERMS), flows=FLOWS):
    """Returns {term: coefficient}, from the lowest power of h to the highest."""
    flows = [Flow(*each) for each in flows]
    found = {}
    for power in sorted(set(TERMS.values())):
        unknown = [name for name in terms if TERMS[name] == power]
        rows = [row for flow in flows for row in flow.equations(found, unknown)]
        found = {**found, **dict(zip(unknown, solution(rows)))}
    return found


if __name__ == "__main__":
    for name, number in derived().items():
        print(f"{name:5} {number}")
