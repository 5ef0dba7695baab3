"""A turbulent flow with drag and forcing: drawn, run, saved as it goes, gone on with after an interruption, plotted.

    python3 turbulence.py DIR N TIME        the same command goes on from the last state in DIR
"""
import os
import sys

import matplotlib
import numpy as np

import isosyrk

matplotlib.use("Agg")  # no display is needed
DIR, N, TIME = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
STEP, EVERY, DRAG = 32 / (N - 1), 20, 1e-3  # h = 0.5 at n = 65; a state is saved every so many steps


def drawn(degrees, seed):
    """Returns W of 2-norm 1 whose modes of some degrees l are random, as a scene."""
    random = np.random.default_rng(seed)
    return isosyrk.scene("drawn", n=N, modes=[(l, m, random.standard_normal(), m and random.standard_normal())
                                              for l in degrees for m in range(l + 1)])


def drag_and_force(step, W):
    """Changes W after a step: drag on all scales, and white noise at l = 8 … 10 whose seed is the step."""
    W *= np.exp(-DRAG * STEP)
    W += np.sqrt(2 * DRAG * STEP) * drawn(range(8, 11), done + step).initial


def save(step, W, _report):
    """Saves a state under another name first: what bears its own is always whole."""
    np.save(f"{DIR}/next.npy", W)
    os.replace(f"{DIR}/next.npy", f"{DIR}/W{done + step:08d}.npy")


os.makedirs(DIR, exist_ok=True)
scene, saved = drawn(range(6, 11), 2026), sorted(name for name in os.listdir(DIR) if name.startswith("W"))
done, W = (int(saved[-1][1:9]), np.load(f"{DIR}/{saved[-1]}")) if saved else (0, scene.initial)
method = isosyrk.integrator(scene, "rk8", solver="fast")
W, _ = method.run(W, STEP, round(TIME / STEP) - done, observe=save, every=EVERY, between=drag_and_force, progress=True)

figure = isosyrk.plot(W, title=f"t = {TIME:g}")
figure.savefig(f"{DIR}/vorticity.png")
axes = matplotlib.figure.Figure().subplots()
axes.loglog(range(1, N), isosyrk.energy_spectrum(W)[1:])
axes.set(xlabel="degree l", ylabel="energy E(l)")
axes.figure.savefig(f"{DIR}/spectrum.png")
