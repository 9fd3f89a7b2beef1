"""
Rubber: stiffness and damping that depend on the frequency
==========================================================

A wire rope makes the same loop at every speed. Rubber does not: Zener's law is soft when moved slowly and stiff when
moved quickly, and its loop is widest in between.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# A spring of 100 kN/m beside a spring of 300 kN/m in series with a damper; cyclic tests of 1 mm at 25 frequencies.

k0, k1, c = 100e3, 300e3, 1.5e3
rubber = wr.Zener(k0=k0, k1=k1, c=c)
frequencies = np.geomspace(0.5, 500.0, 25)
amplitude = 1e-3
energy = [wr.cyclic_test(rubber, [amplitude], frequency=f)[0].dissipated_energy for f in frequencies]

# %%
# Its complex stiffness is :math:`k_0 + k_1 i \omega c / (k_1 + i \omega c)`. The energy of a cycle is :math:`\pi A^2`
# times the imaginary part.

omega = 2j * np.pi * frequencies
stiffness = k0 + k1 * omega * c / (k1 + omega * c)
expected = np.pi * amplitude**2 * stiffness.imag
assert np.allclose(energy, expected, rtol=1e-4)

# %%
# The loss is largest where :math:`\omega c = k_1`, at 31.8 Hz.

best = k1 / c / (2.0 * np.pi)
print(f"widest loop at {best:.1f} Hz; the test that comes nearest: {frequencies[np.argmax(energy)]:.1f} Hz")
assert abs(np.log(frequencies[np.argmax(energy)] / best)) < np.log(frequencies[1] / frequencies[0])

# %%
# A wire-rope law does not see the frequency at all.

rope = wr.BoucWen.from_normalised(z_max=100.0, x_y=1e-3, sigma=1.0, n=1.0, k=50e3)
slow, fast = (wr.cyclic_test(rope, [amplitude], frequency=f)[0].dissipated_energy for f in (0.01, 100.0))
assert slow == fast

# %%
plt.semilogx(frequencies, 1e3 * expected, label="rubber, closed form")
plt.semilogx(frequencies, 1e3 * np.array(energy), "o", label="rubber, cyclic tests")
plt.axhline(1e3 * slow, color="C2", label="wire rope")
plt.xlabel("frequency [Hz]")
plt.ylabel("energy of a cycle of 1 mm [mJ]")
plt.legend()
plt.show()
