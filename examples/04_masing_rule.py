"""
Masing's rule: every branch is the first loading, twice as large
================================================================

Springs in series with friction sliders, side by side, make a loop that remembers where it turned back. Its branches
and its energy are known without any integration.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# Three elements: each has a stiffness and a force at which it slips.

stiffness = np.array([80e3, 40e3, 20e3])
slip_force = np.array([40.0, 60.0, 80.0])
law = wr.Masing(stiffness=stiffness, slip_force=slip_force, k=10e3)
amplitude = 6e-3
loop = wr.cyclic_test(law, [amplitude])[0]

# %%
# An element that slips at the deflection :math:`h / c` dissipates :math:`4 h (A - h / c)` in a cycle of amplitude A.

energy = np.sum(4.0 * slip_force * (amplitude - slip_force / stiffness))
print(f"energy of a cycle {loop.dissipated_energy:.6f} J, by hand {energy:.6f} J")
assert np.isclose(loop.dissipated_energy, energy, rtol=1e-9)

# %%
# Masing's rule: measured from the point of reversal, the way back is the first loading at twice its size.


def first_loading(x):
    """Return the force over a deflection of either sign [N]."""
    sliding = np.clip(np.multiply.outer(x, stiffness), -slip_force, slip_force)
    return 10e3 * x + sliding.sum(axis=-1)


turn = np.argmax(loop.deflection)
back = loop.deflection[turn : turn + 200] - loop.deflection[turn]
rule = loop.force[turn] + 2.0 * first_loading(back / 2.0)
assert np.allclose(loop.force[turn : turn + 200], rule, atol=1e-6)

# %%
x = np.linspace(0.0, amplitude, 200)
plt.plot(1e3 * loop.deflection, loop.force, label="loop of the cyclic test")
plt.plot(1e3 * x, first_loading(x), "k--", label="first loading")
plt.plot(1e3 * (back[::20] + loop.deflection[turn]), rule[::20], "o", color="C3", label="Masing's rule")
plt.xlabel("deflection [mm]")
plt.ylabel("force [N]")
plt.legend()
plt.show()
