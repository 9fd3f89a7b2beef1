"""
Natural frequencies that depend on the amplitude
================================================

A modal test with a hammer finds another frequency than the shaker. Modes for a given amplitude say how far apart they
are.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The block of 50 kg of ``shock_table`` on one Bouc-Wen mount with the same law along all axes.

k, friction, yields = 60e3, 300.0, 1.5e-3
law = wr.BoucWen.from_normalised(z_max=friction, x_y=yields, sigma=1.0, n=1.0, k=k)
mount = wr.Isolator(name="mount", roll=law, shear=law, axial=law)
system = wr.load_system("shock_table", isolators={"wr12_400": mount})
amplitudes = np.geomspace(0.05e-3, 20e-3, 12)
found = [wr.modes(system, amplitude=a) for a in amplitudes]
frequencies = np.array([one.frequencies[0] for one in found])
damping = np.array([one.damping_ratio[0] for one in found])

# %%
# By hand, with n = 1 and gamma = 0: the part of the friction in phase with a sine of amplitude A is that of the first
# harmonic of the loop. Its energy is :math:`4 z_{max} (A - x_y \tanh(A / x_y))`.

phase = np.linspace(0.0, np.pi, 20001)
by_hand = []
for a in amplitudes:
    x, tip = a * np.cos(phase), friction * np.tanh(a / yields)
    back = -friction + (tip + friction) * np.exp(-(a - x) / yields)  # from the tip down
    in_phase = 2.0 / np.pi / a * np.trapezoid(back * np.cos(phase), phase)
    by_hand.append(np.sqrt((k + in_phase) / 50.0) / (2.0 * np.pi))
print("modes  ", np.round(frequencies, 2), "Hz")
print("by hand", np.round(by_hand, 2), "Hz")
assert np.allclose(frequencies, by_hand, rtol=2e-3)

# %%
# Small cycles feel the friction as a spring, alpha = z_max / x_y = 200 kN/m more; large ones feel the spring alone.

assert np.isclose(wr.modes(system).frequencies[0], np.sqrt((k + friction / yields) / 50.0) / (2.0 * np.pi), rtol=1e-6)
energy = 4.0 * friction * (amplitudes - yields * np.tanh(amplitudes / yields))
stiffness = 50.0 * (2.0 * np.pi * np.array(by_hand)) ** 2
assert np.allclose(damping, energy / (2.0 * np.pi * stiffness * amplitudes**2), rtol=5e-3)

# %%
plt.semilogx(1e3 * amplitudes, by_hand, label="first harmonic by hand")
plt.semilogx(1e3 * amplitudes, frequencies, "o", label="modes")
plt.xlabel("amplitude of the mount [mm]")
plt.ylabel("natural frequency [Hz]")
plt.legend()
plt.show()
