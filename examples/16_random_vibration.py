"""
A mass under random vibration, simulated
========================================

The rms of a simulated history, against the integral of the transfer function over the density.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# A block of 50 kg on a linear mount of 10 Hz and 8 % damping, shaken for 60 s.

mass, omega, damping = 50.0, 2.0 * np.pi * 10.0, 0.08
law = wr.KelvinVoigt(k=mass * omega**2, c=2.0 * damping * mass * omega)
system = wr.load_system("shock_table", isolators={"wr12_400": wr.Isolator(name="linear", axial=law)})
points = [(2.0, 0.0005), (60.0, 0.0005)]  # Hz, g^2/Hz
motion = wr.RandomVibration(psd=wr.motions.psd_from_g(points), duration=60.0, seed=1, direction="z")
response = wr.simulate(system, motion, duration=60.0, accuracy=1e-3)

# %%
# Only the stationary part counts. ``judge_random`` finds it by itself; here it is cut by hand.

begin, end = motion.steady
steady = (response.time > begin + 1.0) & (response.time < end)
history = response.bodies["block"].acceleration[:, 2]
rms = np.sqrt(np.mean(history[steady] ** 2))

# %%
# By hand: :math:`|T|^2` of a mass on spring and damper, times the density, over the band.

f = np.linspace(2.0, 60.0, 20001)
r = f / 10.0
transfer = (1.0 + (2.0 * damping * r) ** 2) / ((1.0 - r**2) ** 2 + (2.0 * damping * r) ** 2)
expected = np.sqrt(np.trapezoid(transfer * 0.0005, f)) * wr.STANDARD_GRAVITY
print(f"rms {rms:.4f} m/s^2, by hand {expected:.4f} m/s^2")
assert np.isclose(rms, expected, rtol=0.04)  # three standard deviations of 50 s out of 60 s at this damping

# %%
density = wr.power_spectral_density(response.time[steady], history[steady], resolution=0.5)
plt.loglog(density.frequency, density.density / wr.STANDARD_GRAVITY**2, label="simulated block")
plt.loglog(f, transfer * 0.0005, "k--", label="transfer function")
plt.loglog(*zip(*points, strict=True), color="0.6", label="base")
plt.xlim(1.0, 100.0)
plt.ylim(1e-6, 1e-1)
plt.xlabel("frequency [Hz]")
plt.ylabel("density [g²/Hz]")
plt.legend()
plt.show()
