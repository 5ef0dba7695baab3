"""How far a map of an orbit {U W U†} is from symplectic, in the form of Kirillov and Kostant: ω(v, w) = tr(W [a, b]).

Tangent vectors at W are v = [a, W] and w = [b, W], with a and b in su(n). A map φ is symplectic if ω at φ(W), of the
images Dφ v and Dφ w, is ω at W of v and w. Images are found by central differences along the orbit, between states
U W U† that have the spectrum of W. Where φ loses the spectrum, an image has a part that is not tangent; it is left out
here, and the error of the spectrum tells it. Needs NumPy.
"""

import numpy

PAIRS = 3  # of tangent vectors
# The tolerance and the rounding of a step are divided by the displacement, and the error of differences grows like its
# sixth power. Of exact solutions (n = 33, T = 2) the defect is 1e-12 so, and at half or twice of it up to 4e-12.
DISPLACEMENT = 1e-2
STENCIL = ((1, 3 / 4), (-1, -3 / 4), (2, -3 / 20), (-2, 3 / 20), (3, 1 / 60), (-3, -1 / 60))  # a first derivative
SAME = 1e-12  # eigenvalues nearer than this, relative to the largest, are one: no tangent vector parts them


def symplectic_defect(map_of, W, seed=0):
    """Returns the defect of φ = `map_of` at W, both skew-Hermitian of shape (n, n); φ must be smooth near W.

    It is the root mean square of ω(Dφ v, Dφ w) - ω(v, w) over PAIRS of random tangent vectors, with ‖a‖_F = ‖b‖_F = 1,
    over that of ω(v, w) as expected. So 0 is symplectic, and a map that has nothing of ω has about 1.
    """
    random = numpy.random.default_rng(seed)
    there, square, expected = map_of(W), 0.0, 0.0
    for _ in range(PAIRS):
        directions = [random_direction(random, len(W)) for _ in range(2)]
        tangents = [a @ W - W @ a for a in directions]
        images = [derivative(map_of, W, a) for a in directions]
        square += (form(there, *images) - form(W, *tangents))**2
        expected += numpy.mean([numpy.linalg.norm(v)**2 for v in tangents]) / (len(W)**2 - 1)
    return float(numpy.sqrt(square / expected))


def random_direction(random, n):
    """Returns a random element of su(n) with Frobenius norm 1."""
    a = random.standard_normal((n, n)) + 1j * random.standard_normal((n, n))
    a -= a.conj().T
    a -= numpy.trace(a) / n * numpy.eye(n)
    return a / numpy.linalg.norm(a)


def derivative(map_of, W, a):
    """Returns Dφ [a, W], by differences of φ(exp(s a) W exp(-s a))."""
    angles, vectors = numpy.linalg.eigh(-1j * a)

    def displaced(s):
        U = (vectors * numpy.exp(1j * s * angles)) @ vectors.conj().T
        state = U @ W @ U.conj().T
        return (state - state.conj().T) / 2

    return sum(weight * map_of(displaced(shift * DISPLACEMENT)) for shift, weight in STENCIL) / DISPLACEMENT


def form(W, v, w):
    """Returns ω(v, w) at W: tr(W [a, b]) with [a, W] and [b, W] the parts of v and w that are tangent."""
    eigenvalues, vectors = numpy.linalg.eigh(-1j * W)
    v, w = (vectors.conj().T @ each @ vectors for each in (v, w))
    gaps = 1j * (eigenvalues[None, :] - eigenvalues[:, None])
    apart = abs(gaps) > SAME * abs(eigenvalues).max()
    b = numpy.divide(w, gaps, out=numpy.zeros_like(w), where=apart)
    return float(-numpy.sum(numpy.where(apart, v, 0) * b.T).real)
