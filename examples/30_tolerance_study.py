"""
A tolerance study
=================

No two mounts are alike. How much does the acceleration scatter when the stiffness and the level do, and how likely is
it beyond a limit?
"""

import tempfile

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import ndtr

import wirerope_mj as wr

# %%
# The block of ``shock_table`` on a spring of 8 Hz whose stiffness scatters by 10 %, struck by a velocity step of 1 m/s
# that scatters by 5 %. 256 variants, from Sobol's sequence.

velocity, stiffness = 1.0, 50.0 * (2.0 * np.pi * 8.0) ** 2
limit = 1.1 * velocity * np.sqrt(stiffness / 50.0)
spring = wr.Isolator(name="spring", axial=wr.KelvinVoigt(k=stiffness, c=0.0))
study = wr.Study(
    model="shock_table.xml",
    isolators={"wr12_400": spring},
    motion=wr.VelocityStep(velocity=velocity, direction="z", start=0.005),
    duration=0.08,
    timestep=5e-4,
    vary={"mount/m1/axial/k": wr.Normal(1.0, 0.1, relative=True), "motion/level": wr.Normal(1.0, 0.05)},
    variants=256,
)
with tempfile.TemporaryDirectory() as folder:
    result = study.run(folder, workers=1)
    acceleration = np.array(result.table["acceleration"])
    beyond = result.exceedance("acceleration", limit)

# %%
# Closed form: the acceleration is :math:`v \sqrt{k / m}`. To first order its coefficient of variation is that of
# :math:`\sqrt{0.05^2 + (0.1 / 2)^2}` = 7.1 %, so that 10 % above its nominal value is 1.41 standard deviations away.

deviation = np.hypot(0.05, 0.05)
scatter = acceleration.std() / acceleration.mean()
probability = ndtr(-0.1 / deviation)
print(f"scatter {scatter:.2%} (by hand {deviation:.2%})")
print(f"{beyond.count} of {beyond.n} beyond: {beyond.low:.1%} to {beyond.high:.1%} (by hand {probability:.1%})")
assert np.isclose(scatter, deviation, rtol=0.05)
assert beyond.low < probability < beyond.high

# %%
u = np.linspace(-3.0, 3.0, 200)  # standard deviations
plt.hist(acceleration, bins=20, density=True, color="0.8", label="256 variants")
mean, spread = limit / 1.1, limit / 1.1 * deviation
plt.plot(mean + spread * u, np.exp(-(u**2) / 2.0) / np.sqrt(2.0 * np.pi) / spread, label="first order")
plt.axvline(limit, color="C3", linestyle="--", label="limit")
plt.xlabel("largest acceleration [m/s²]")
plt.ylabel("probability density [s²/m]")
plt.legend()
plt.show()
