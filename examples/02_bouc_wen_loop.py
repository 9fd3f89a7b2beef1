"""
A Bouc-Wen loop and the energy inside it
========================================

What one closed cycle dissipates is the area of its loop. Two laws that load along the same line may differ in it by
40 %.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

import wirerope_mj as wr

# %%
# Both laws have alpha = 1, n = 1 and beta + gamma = 1 (in units of their own: 1 N and 1 m).

laws = {beta: wr.BoucWen(alpha=1.0, beta=beta, gamma=1.0 - beta, n=1.0) for beta in (0.8, 0.5)}
loops = {beta: wr.cyclic_test(law, [1.0])[0] for beta, law in laws.items()}

# %%
# By hand, for n = 1: the force grows with the slope 1 - z while it is positive, and falls with the slope
# 1 + (beta - gamma) z when the mount turns back. The largest force z0 is the one for which both ways together are as
# long as the stroke of 2 m, and the area follows from the same two slopes.


def hand(beta):
    """Return the largest force [N] and the energy of a cycle of 1 m [J]."""
    difference = 2.0 * beta - 1.0
    path = lambda z: quad(lambda s: 1 / (1 - s) + 1 / (1 + difference * s), 0, z)[0]  # noqa: E731
    z0 = brentq(lambda z: path(z) - 2.0, 0.1, 0.99, xtol=1e-12)
    return z0, 2.0 * quad(lambda s: s * (1 / (1 - s) - 1 / (1 + difference * s)), 0, z0)[0]


for beta, loop in loops.items():
    z0, energy = hand(beta)
    print(f"beta {beta}: force {loop.force.max():.8f} N, energy {loop.dissipated_energy:.8f} J (by hand {energy:.8f} J)")
    assert np.isclose(loop.force.max(), z0, rtol=1e-8)
    assert np.isclose(loop.dissipated_energy, energy, rtol=1e-8)

assert np.isclose(loops[0.8].dissipated_energy / loops[0.5].dissipated_energy, 1.40, atol=0.005)

# %%
for beta, loop in loops.items():
    plt.plot(loop.deflection, loop.force, label=rf"$\beta$ = {beta}: {loop.dissipated_energy:.3f} J")
plt.xlabel("deflection [m]")
plt.ylabel("hysteretic force [N]")
plt.legend()
plt.show()
