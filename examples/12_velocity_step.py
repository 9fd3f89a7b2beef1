"""
A shock on a linear mount: v times omega
========================================

The base under a mass suddenly moves with 1 m/s. A spring without damping answers with a known travel and acceleration;
a wire-rope mount of the same stiffness does better.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The block of 50 kg of the shipped model ``shock_table`` on a linear spring of 8 Hz.

mass, omega, velocity = 50.0, 2.0 * np.pi * 8.0, 1.0
stiffness = mass * omega**2
spring = wr.Isolator(name="spring", axial=wr.KelvinVoigt(k=stiffness, c=0.0))
system = wr.load_system("shock_table", isolators={"wr12_400": spring})
step = wr.VelocityStep(velocity=velocity, direction="z", start=0.02)
response = wr.simulate(system, step, duration=0.3)

# %%
# Closed form: v / omega of travel beyond the sag, and v omega of acceleration.

travel = -response.peaks.mounts["m1"].deflection.minimum[2] - wr.STANDARD_GRAVITY / omega**2
acceleration = response.peaks.bodies["block"].acceleration.value
print(f"travel {1e3 * travel:.3f} mm, v/w = {1e3 * velocity / omega:.3f} mm")
print(f"acceleration {acceleration:.3f} m/s^2, v w = {velocity * omega:.3f} m/s^2")
assert np.isclose(travel, velocity / omega, rtol=1e-4)
assert np.isclose(acceleration, velocity * omega, rtol=1e-4)

# %%
# A law with friction, whose secant at this travel is the same stiffness, takes energy out on the way.

friction = 500.0  # [N], reached over 2 mm
k = stiffness - friction * np.tanh(travel / 2e-3) / travel
rope = wr.Isolator(name="rope", axial=wr.EnhancedDryFriction(k=k, d=friction, u_c=2e-3))
damped = wr.simulate(wr.load_system("shock_table", isolators={"wr12_400": rope}), step, duration=0.3)
assert damped.peaks.bodies["block"].acceleration.value < 0.95 * velocity * omega

# %%
for one, name in ((response, "spring"), (damped, "with friction")):
    plt.plot(1e3 * one.time, one.bodies["block"].acceleration[:, 2], label=name)
plt.axhline(velocity * omega, color="0.6", linestyle="--", label=r"$v\,\omega$")
plt.xlabel("time [ms]")
plt.ylabel("acceleration of the block [m/s²]")
plt.ylim(-60.0, 80.0)
plt.legend(loc="upper right", ncols=3)
plt.show()
