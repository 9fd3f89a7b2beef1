"""
An earthquake made for a response spectrum
==========================================

A standard gives a response spectrum; a simulation needs a motion. Many lines with fitted amplitudes have the spectrum
wanted.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The elastic spectrum of EN 1998-1, type 1, ground B, for a ground acceleration of 2 m/s^2. By hand: between the corner
# periods of 0.15 and 0.5 s the plateau is 2.5 a_g S; above 0.5 s it falls with the period.

ground, soil, corners = 2.0, 1.2, (0.15, 0.5, 2.0)
frequencies = np.geomspace(0.5, 50.0, 60)
target = wr.en1998_spectrum(frequencies, ground_acceleration=ground, soil_factor=soil, corner_periods=corners)
period = 1.0 / frequencies
plateau = (period > 0.15) & (period < 0.5)
falling = (period >= 0.5) & (period < 2.0)
assert np.allclose(target[plateau], 2.5 * ground * soil)
assert np.allclose(target[falling], 2.5 * ground * soil * 0.5 / period[falling])

# %%
# A motion of 12 s along x whose spectrum is within 2 % of it.

match = wr.match_spectrum(list(zip(frequencies, target, strict=True)), duration=12.0, seed=1, direction="x")
print(f"{match.largest_mismatch:.1%} at most, after {match.iterations} corrections")
assert match.largest_mismatch <= 0.02

# %%
# Its spectrum once more, from 24 000 samples of its acceleration as another program would get them, at the frequencies
# of the match. The base ends at rest, where it was.

time = np.arange(0.0, 12.0, 5e-4)
acceleration = match.motion.acceleration(time)[:, 0]
spectrum = wr.shock_response_spectrum(time, acceleration, match.frequencies, q=10)
assert np.allclose(spectrum.maximax / match.target, 1.0, atol=0.02)
end = np.array([match.motion.duration])
assert np.allclose([match.motion.velocity(end)[0, 0], match.motion.displacement(end)[0, 0]], 0.0, atol=1e-9)

# %%
plt.loglog(match.frequencies, spectrum.maximax, label="spectrum of the motion")
plt.loglog(frequencies, target, "k--", label="EN 1998-1, type 1, ground B")
plt.xlabel("natural frequency [Hz]")
plt.ylabel("largest acceleration [m/s²]")
plt.ylim(1.0, 20.0)
plt.legend()
plt.show()
