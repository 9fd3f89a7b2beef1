"""
Shock response spectrum of a half-sine
======================================

What a shock does to equipment of any natural frequency. For a half-sine of 15 g and 11 ms the answer is in every
handbook.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The pulse, sampled 200 times in its 11 ms, and its spectrum for Q = 10 (5 % damping) and for hardly any damping.

peak, duration = 15.0 * wr.STANDARD_GRAVITY, 0.011
pulse = wr.HalfSine(peak=peak, duration=duration, direction="z")
time = np.linspace(0.0, 2.0 * duration, 401)
history = pulse.acceleration(time)[:, 2]
frequencies = np.geomspace(1.0, 1000.0, 121)
usual = wr.shock_response_spectrum(time, history, frequencies, q=10)
undamped = wr.shock_response_spectrum(time, history, frequencies, q=1e6)

# %%
# Closed form of what follows the pulse, without damping: :math:`|2 r \cos(\pi f D) / (1 - r^2)|` with :math:`r = 2 f
# D`. It holds beyond the pulse; below f D = 0.5 it is the largest value of all.

r = 2.0 * frequencies * duration
residual = peak * np.abs(2.0 * r * np.cos(np.pi * frequencies * duration) / (1.0 - r**2))
low = frequencies * duration < 0.45
assert np.allclose(undamped.residual[low], residual[low], rtol=2e-3)

# %%
# The largest values of handbooks: 1.768 of the peak at f D = 0.81 without damping, 1.652 at f D = 0.82 with Q = 10.

for spectrum, expected in ((undamped, 1.7684), (usual, 1.652)):
    top = np.argmax(spectrum.maximax)
    print(f"{spectrum.maximax[top] / peak:.4f} of the peak at f D = {frequencies[top] * duration:.2f}")
    assert np.isclose(spectrum.maximax[top] / peak, expected, rtol=2e-3)

# %%
# Soft equipment sees nothing but the velocity change :math:`2 A D / \pi` = 1.03 m/s: it answers with omega times that.

change = 2.0 * peak * duration / np.pi
assert np.isclose(undamped.maximax[0], 2.0 * np.pi * change, rtol=2e-3)

# %%
plt.loglog(frequencies, undamped.maximax / wr.STANDARD_GRAVITY, label="no damping")
plt.loglog(frequencies, usual.maximax / wr.STANDARD_GRAVITY, label="Q = 10")
plt.loglog(frequencies, 2.0 * np.pi * frequencies * change / wr.STANDARD_GRAVITY, "k:", label="velocity change")
plt.ylim(0.5, 50.0)
plt.xlabel("natural frequency [Hz]")
plt.ylabel("largest acceleration [g]")
plt.legend()
plt.show()
