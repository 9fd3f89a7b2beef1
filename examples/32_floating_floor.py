"""
A floating floor with many mounts
=================================

3.3 t of floor, racks and people on 24 mounts, under a shock along three axes at once. What reaches the deck's bolts is
mass times acceleration, whatever the mounts do.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The shipped model: 16 wire-rope mounts below the floor, eight mounts at its sides, and bump stops.

g = wr.STANDARD_GRAVITY
system = wr.load_system("floating_floor")
pulses = [wr.HalfSine(peak=10.0 * g, duration=0.011, direction=axis, start=0.05) for axis in "xyz"]
response = wr.simulate(system, pulses[0] + pulses[1] + pulses[2], duration=0.5, accuracy=1e-3)

# %%
# The sum of the forces of all mounts, turned into the world's axes. Tension pulls the floor down.

force = sum(response.mounts[name].force @ mount.axes.T for name, mount in system.mounts.items())

# %%
# By hand: mass times acceleration of every body that the mounts carry, and their weight.

masses = {name: system.model.body(name).mass[0] for name in response.bodies if name != system.base}
inertia = sum(mass * response.bodies[name].acceleration for name, mass in masses.items())
weight = np.array([0.0, 0.0, sum(masses.values()) * g])
error = np.abs(force + inertia + weight).max() / np.abs(force).max()
print(f"{sum(masses.values()):.0f} kg; largest force {1e-3 * np.linalg.norm(force, axis=1).max():.1f} kN, error {error:.1e}")
assert np.isclose(sum(masses.values()), 3300.0, rtol=0.02)
assert error < 1e-6

# %%
# Before the shock the mounts carry the weight and nothing else, and afterwards every verdict has its limit beside it.

assert np.allclose(force[0], -weight, atol=1e-4 * weight[2])
for verdict in sorted(wr.judge(response), key=lambda one: -(one.utilisation or 0.0))[:3]:
    print(verdict.criterion, verdict.subject, f"{verdict.utilisation:.0%}", verdict.verdict)

# %%
plt.plot(response.time, response.base.acceleration[:, 2] / g, color="0.7", label="deck")
plt.plot(response.time, response.bodies["rack_1"].acceleration[:, 2] / g, label="rack 1")
plt.plot(response.time, -(force + weight)[:, 2] / weight[2], "--", label="forces of the mounts over weight")
plt.xlabel("time [s]")
plt.ylabel("vertical acceleration [g]")
plt.legend()
plt.show()
