"""Noise that keeps the spectrum of W: after each step W becomes Q W Q† with a random unitary Q near the identity."""
import numpy as np

import isosyrk

N, STEP, STRENGTH = 33, 0.25, 0.05
scene = isosyrk.scene("smooth", n=N)


def conjugate(step, W):
    """Changes W after a step by Cayley's map of a random generator of degrees l <= 4, whose seed is the step."""
    random = np.random.default_rng(step)
    modes = [(l, m, random.standard_normal(), m and random.standard_normal())
             for l in range(1, 5) for m in range(l + 1)]
    A = STRENGTH * np.sqrt(STEP) / 2 * isosyrk.scene("noise", n=N, modes=modes).initial
    Q = np.linalg.solve(np.eye(N) - A, np.eye(N) + A)
    W[:] = Q @ W @ Q.conj().T
    W -= W.conj().T  # what rounding left
    W /= 2


W, _ = isosyrk.integrator(scene, "elp4", solver="fast").run(scene.initial, STEP, 200, between=conjugate)
print(f"spectrum error {isosyrk.spectrum_error(W, scene.initial):.1e}, energy by"
      f" {scene.energy(W) / scene.energy(scene.initial) - 1:+.2f}")
