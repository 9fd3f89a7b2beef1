"""
Where the energy of a shock goes
================================

A velocity step gives a block kinetic energy. Springs and weight hand it back and forth until friction has taken all of
it.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import cumulative_trapezoid

import wirerope_mj as wr

# %%
# The block of 50 kg on its catalogue mount, two Ni laws in parallel; the base drops by 1.5 m/s, so that the block moves
# up in its frame.

mass, g = 50.0, wr.STANDARD_GRAVITY
system = wr.load_system("shock_table")
step = wr.VelocityStep(velocity=-1.5, direction="z", start=0.01)
response = wr.simulate(system, step, duration=0.5, sample_rate=20_000.0)
mount, law = response.mounts["m1"], system.mounts["m1"].isolator.axial
after = response.time >= 0.01
time, deflection, force = response.time[after], mount.deflection[after, 2], mount.force[after, 2]

# %%
# Energies in the frame of the base, which moves steadily after the step. The elastic part of the law is :math:`e^{c x
# \ln b} (k_1 x + k_3 x^3)`; all other work of the mount went into friction, or is still held by it.

velocity = (response.bodies["block"].velocity - response.base.velocity)[after, 2]
kinetic, weight = mass * velocity**2 / 2.0, mass * g * (deflection - deflection[0])
elastic = sum(
    np.exp(one.c * np.log(one.b) * deflection) * (one.k1 * deflection + one.k3 * deflection**3) for one in law.components
)
stored = cumulative_trapezoid(elastic, deflection, initial=0.0)
friction = cumulative_trapezoid(force - elastic, deflection, initial=0.0)
total = kinetic + weight + stored + friction

# %%
# The step gives :math:`m v^2 / 2` = 56.25 J; the sum stays at that.

print(f"sum of energies {total.min():.3f} to {total.max():.3f} J, by hand {mass * 1.5**2 / 2:.3f} J")
assert np.allclose(total, mass * 1.5**2 / 2.0, rtol=1e-3)
turn = np.argmax(deflection)
print(f"first turn: {stored[turn]:.1f} J in the spring, {weight[turn]:.1f} J in the weight, {friction[turn]:.1f} J lost")

# %%
labels = ["kinetic", "weight", "elastic", "friction"]
plt.plot(1e3 * time, np.transpose([kinetic, weight, stored, friction]), label=labels)
plt.plot(1e3 * time, total, "k--", label="sum")
plt.xlabel("time [ms]")
plt.ylabel("energy [J]")
plt.legend()
plt.show()
