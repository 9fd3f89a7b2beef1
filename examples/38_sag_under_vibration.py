"""
Why a floor sinks under vibration
=================================

On first loading the friction of a mount carries a part of the weight. Vibration takes that part away: the sag grows
until the springs carry all of it.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import wirerope_mj as wr

# %%
# The block of 50 kg on a Bouc-Wen mount (n = 1): a spring of 60 kN/m and friction of at most 300 N.

k, friction, yields = 60e3, 300.0, 1.5e-3
law = wr.BoucWen.from_normalised(z_max=friction, x_y=yields, sigma=1.0, n=1.0, k=k)
system = wr.load_system("shock_table", isolators={"wr12_400": wr.Isolator(name="mount", axial=law)})
table = wr.static_table(system)
virgin, relaxed = (-one.mounts["m1"].deflection[2] for one in (table.virgin, table.relaxed))

# %%
# By hand: the weight is :math:`k x + z_{max} (1 - e^{-x / x_y})` at first, and k x in the end.

weight = 50.0 * wr.STANDARD_GRAVITY
first = brentq(lambda x: k * x + friction * (1.0 - np.exp(-x / yields)) - weight, 0.0, 0.1)
print(f"sag {1e3 * virgin:.3f} mm at first (by hand {1e3 * first:.3f}), {1e3 * relaxed:.3f} mm relaxed")
assert np.isclose(virgin, first, rtol=1e-6)
assert np.isclose(relaxed, weight / k, rtol=1e-6)

# %%
# The way from one to the other: ten seconds of 0.6 m/s^2 at 25 Hz. The mean of each second, from the virgin sag on.

shaken = wr.simulate(system, wr.Sine(frequency=25.0, acceleration=0.6, direction="z"), duration=10.0, accuracy=1e-3)
sag = -shaken.mounts["m1"].deflection[:-1, 2]
means = sag.reshape(10, -1).mean(axis=1)
print("mean sag of each second", np.round(1e3 * means, 2), "mm")
assert (np.diff(means) > 0.0).all()
assert virgin < means[0] < means[-1]
assert np.isclose(means[-1], relaxed, rtol=0.01)

# %%
plt.plot(shaken.time[:-1], 1e3 * sag, color="0.5", linewidth=0.5, label="sag under vibration")
plt.plot(np.arange(10) + 0.5, 1e3 * means, "o", label="mean of a second")
plt.axhline(1e3 * virgin, color="C2", label="virgin sag")
plt.axhline(1e3 * relaxed, color="C3", label="relaxed sag")
plt.xlabel("time [s]")
plt.ylabel("sag [mm]")
plt.legend()
plt.show()
