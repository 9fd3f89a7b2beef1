"""
Naval shock: a design spectrum becomes a double pulse
=====================================================

Three numbers of a specification, displacement, velocity and acceleration, and a motion of the deck that ends at rest.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The levels are an example: 50 mm, 3 m/s, 100 g. The pulse takes 1.05, 0.75 and 0.6 of them, as we remember the
# literature on BV 043.

g = wr.STANDARD_GRAVITY
spectrum = wr.DesignSpectrum(displacement=0.05, velocity=3.0, acceleration=100.0 * g)
pulse = spectrum.double_half_sine(direction="z", factors=(0.6, 0.75, 1.05))

# %%
# By hand, with a1 = 60 g, V = 2.25 m/s and D = 52.5 mm: :math:`t_1 = \pi V / (2 a_1)`, :math:`t_2 = 2 D / V -
# t_1`, :math:`a_2 = a_1 t_1 / t_2`.

first = np.pi * 2.25 / (2.0 * 60.0 * g)
second = 2.0 * 0.0525 / 2.25 - first
opposite = 60.0 * g * first / second
print(f"{1e3 * first:.4f} ms up to 60 g, {1e3 * second:.4f} ms down to {opposite / g:.4f} g")
time = np.linspace(0.0, 1.2 * (first + second), 6001)
acceleration = pulse.acceleration(time)[:, 2]
assert np.isclose(pulse.corners[-1], first + second)
assert np.isclose(acceleration.max(), 60.0 * g, rtol=1e-3)
assert np.isclose(-acceleration.min(), opposite, rtol=1e-3)
assert np.isclose(pulse.velocity(np.array([first]))[0, 2], 2.25)
assert np.allclose([pulse.velocity(time)[-1, 2], pulse.displacement(time)[-1, 2]], [0.0, 0.0525])

# %%
# The undamped spectrum of this motion beside the three branches: 1.05 d0 at low frequencies.

frequencies = np.geomspace(0.5, 500.0, 90)
found = wr.shock_response_spectrum(time, acceleration, frequencies, q=1e6)
branches = np.minimum(np.minimum(0.05 * (2.0 * np.pi * frequencies), 3.0), 100.0 * g / (2.0 * np.pi * frequencies))
pseudo_velocity = found.maximax / (2.0 * np.pi * frequencies)
assert np.isclose(pseudo_velocity[0] / branches[0], 1.05, atol=0.02)

# %%
plt.loglog(frequencies, branches, "k--", label="design spectrum")
plt.loglog(frequencies, pseudo_velocity, label="double half-sine")
plt.ylim(0.1, 10.0)
plt.xlabel("natural frequency [Hz]")
plt.ylabel("pseudo-velocity [m/s]")
plt.legend()
plt.show()
