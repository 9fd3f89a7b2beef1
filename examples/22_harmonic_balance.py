"""
Harmonic balance beside shooting
================================

Two ways to the motion that repeats itself: Fourier series that balance, and a simulation that comes back to where it
began. Both against a plain integration by SciPy.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import wirerope_mj as wr

# %%
# One mass of 1 kg on a Bouc-Wen law with a spring (alpha = 1, beta = gamma = 0.5, n = 1, k = 0.1, all SI), a base of
# 0.3 m/s^2 at 0.8 rad/s. SciPy integrates it over 60 periods; the last one counts.

law = wr.BoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0, k=0.1)
drive = {"frequency": 0.8 / (2.0 * np.pi), "acceleration": 0.3}
balance = wr.harmonic_balance(law, mass=1.0, **drive)


def rate(t, state):
    """Return the rates of deflection, velocity and hysteretic force."""
    d, v, z = state
    return [v, 0.3 * np.sin(0.8 * t) - 0.1 * d - z, v - 0.5 * abs(v) * z - 0.5 * v * abs(z)]


end = 60 * 2.0 * np.pi / 0.8
last = np.linspace(end * 59 / 60, end, 4001)
direct = solve_ivp(rate, (0.0, end), [0.0, 0.0, 0.0], t_eval=last, rtol=1e-8, atol=1e-10).y[0]
assert np.isclose(balance.largest_deflection, direct.max(), rtol=1e-4)

# %%
# The same law in a model of MuJoCo, shot at until a period closes.

model = """<mujoco><option gravity="0 0 0"/><default><geom contype="0" conaffinity="0"/></default><worldbody>
<body name="deck"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="5"/><site name="b" pos="0 0 .2"/></body>
<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="1"/>
<site name="p" pos="0 0 -.1"/></body></worldbody><custom><text name="isolator/a" data="a.toml"/><tuple name="mount/m1">
<element objtype="site" objname="p"/><element objtype="site" objname="b"/>
<element objtype="text" objname="isolator/a"/></tuple></custom></mujoco>"""
system = wr.load_system(model, isolators={"a": wr.Isolator(name="a", axial=law)})
orbit = wr.periodic_orbit(system, direction="z", accuracy=1e-5, **drive)
peak = orbit.response.peaks.mounts["m1"].deflection
print(f"shooting {peak.maximum[2]:.6f} m, balance {balance.largest_deflection:.6f} m, SciPy {direct.max():.6f} m")
assert np.isclose(peak.maximum[2], direct.max(), rtol=1e-4)
assert orbit.stable
assert (np.abs(orbit.floquet_multipliers) < 1.0).all()

# %%
mount = orbit.response.mounts["m1"]
plt.plot(mount.deflection[:, 2], mount.force[:, 2], label="shooting")
plt.plot(balance.deflection, balance.force, "k--", label="harmonic balance")
plt.xlabel("deflection [m]")
plt.ylabel("force [N]")
plt.legend()
plt.show()
