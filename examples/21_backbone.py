"""
Backbone: where a mount resonates at every level
================================================

The more a wire-rope mount moves, the softer it is. The peaks of its response curves lie on one line, which a cyclic
test knows already.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# Response curves of one mass by equivalent linearisation: at every frequency the amplitude whose own secant stiffness
# and damping give that amplitude.

mass = 50.0
law = wr.BoucWen.from_normalised(z_max=300.0, x_y=2e-3, sigma=1.0, n=1.0, k=200e3)
frequencies = np.linspace(8.0, 16.0, 161)
levels = [0.25, 0.5, 1.0, 2.0, 4.0]  # [m/s^2]
curves = [wr.equivalent_linear(law, mass=mass, frequencies=frequencies, acceleration=level) for level in levels]
largest = [np.nanmax(curve.deflection, axis=1) for curve in curves]
deflection = np.array([one.max() for one in largest])
resonance = frequencies[np.argmax(largest, axis=1)]

# %%
# By hand: a cyclic test of that amplitude gives the secant K, and with it the frequency :math:`\sqrt{K/m} / 2 \pi`.

secant = np.array([loop.secant_stiffness for loop in wr.cyclic_test(law, deflection)])
by_hand = np.sqrt(secant / mass) / (2.0 * np.pi)
print("resonance", np.round(resonance, 2), "by hand", np.round(by_hand, 2), "Hz")
assert (np.diff(resonance) < 0.0).all()
assert np.allclose(resonance, by_hand, rtol=0.02)

# %%
# At resonance the loop takes what the base puts in: :math:`\pi m a D` each cycle, as the base is a quarter of a period
# ahead.

energy = np.array([loop.dissipated_energy for loop in wr.cyclic_test(law, deflection)])
assert np.allclose(energy, np.pi * mass * np.array(levels) * deflection, rtol=1e-3)

# %%
for level, one in zip(levels, largest, strict=True):
    plt.semilogy(frequencies, 1e3 * one, label=f"{level} m/s²")
plt.semilogy(by_hand, 1e3 * deflection, "ko--", label="cyclic tests")
plt.xlabel("frequency [Hz]")
plt.ylabel("amplitude of the mount [mm]")
plt.ylim(0.04, 30.0)
plt.legend(ncols=3)
plt.show()
