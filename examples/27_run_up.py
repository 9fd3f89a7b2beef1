"""
A machine runs up through its resonance
=======================================

From 2 to 20 Hz in three seconds: how far does it swing on the way? The equation of motion by SciPy says the same.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import wirerope_mj as wr

# %%
# A block of 50 kg on a linear mount of 10 Hz, guided along z; the unbalance of 20 kg mm acts along the same line.

mass, k, c, unbalance = 50.0, 2e5, 600.0, 0.02
model = f"""<mujoco><option gravity="0 0 0"/><default><geom contype="0" conaffinity="0"/></default><worldbody>
<body name="base"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="5"/><site name="b"/></body>
<body name="block"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="{mass}"/><site name="p"/>
<site name="force/engine" pos="0 0 .1"/></body></worldbody><custom><text name="isolator/a" data="a"/>
<tuple name="mount/m1"><element objtype="site" objname="p"/><element objtype="site" objname="b"/>
<element objtype="text" objname="isolator/a"/></tuple></custom></mujoco>"""
system = wr.load_system(model, isolators={"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=k, c=c))})
motion = wr.Unbalance(site="engine", unbalance=unbalance, frequency=2.0, final_frequency=20.0, run_up=3.0, line="z")
response = wr.simulate(system, motion, duration=3.0, timestep=5e-4)
deflection = response.mounts["m1"].deflection[:, 2]

# %%
# By hand: the force is minus the acceleration of m e cos(angle), with the angle of a steady run-up.


def rate(time, state):
    """Return rate and acceleration of the block."""
    angle = 2.0 * np.pi * (2.0 * time + 3.0 * time**2)
    speed, growth = 2.0 * np.pi * (2.0 + 6.0 * time), 2.0 * np.pi * 6.0
    force = unbalance * (speed**2 * np.cos(angle) + growth * np.sin(angle))
    return [state[1], (force - k * state[0] - c * state[1]) / mass]


by_hand = solve_ivp(rate, (0.0, 3.0), [0.0, 0.0], t_eval=response.time, rtol=1e-9, atol=1e-12, method="DOP853").y[0]
error = np.abs(deflection - by_hand).max() / np.abs(by_hand).max()
top = response.time[np.argmax(np.abs(deflection))]
print(f"largest swing {1e3 * np.abs(deflection).max():.3f} mm at {2 + 6 * top:.1f} Hz; error {error:.1e}")
assert error < 1e-4
assert 10.0 < 2.0 + 6.0 * top < 12.0  # later than the resonance of 10.07 Hz: a run-up drags it along

# %%
plt.plot(2.0 + 6.0 * response.time, 1e3 * deflection, label="simulation")
plt.plot(2.0 + 6.0 * response.time[::40], 1e3 * by_hand[::40], ".", color="C3", label="SciPy")
plt.xlabel("speed of the machine [Hz]")
plt.ylabel("deflection of the mount [mm]")
plt.legend()
plt.show()
