"""
Which input decides: Sobol's indices
====================================

Level and stiffness vary. What part of the variance of the acceleration does each of them explain?
"""

import tempfile

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The block of ``shock_table`` on an undamped spring under a velocity step. All inputs are uniform: level from 0.5 to
# 1.5, stiffness from 0.5 to 1.5 of nominal.

stiffness = 50.0 * (2.0 * np.pi * 8.0) ** 2
spring = wr.Isolator(name="spring", axial=wr.KelvinVoigt(k=stiffness, c=0.0))
study = wr.Study(
    model="shock_table.xml",
    isolators={"wr12_400": spring},
    motion=wr.VelocityStep(velocity=0.6, direction="z", start=0.005),
    duration=0.1,
    timestep=5e-4,
    vary={"mount/m1/axial/k": wr.Uniform(0.5, 1.5, relative=True), "motion/level": wr.Uniform(0.5, 1.5)},
    sampling="sobol-indices",
    variants=64 * (2 + 2),
)
with tempfile.TemporaryDirectory() as folder:
    indices = wr.sobol_indices(study.run(folder, workers=1), "acceleration")

# %%
# Closed form: the acceleration is a product x y of the level x and :math:`y = \sqrt{k}`. A product of independent
# inputs has the first-order indices :math:`V(x) E(y)^2 / V` and :math:`V(y) E(x)^2 / V`, and :math:`V(x) V(y) / V` is
# what only both together explain.

mean_y, square_y = np.array([2.0 / 3.0 * (1.5**1.5 - 0.5**1.5), 1.0])
variance_x, variance_y = 1.0 / 12.0, square_y - mean_y**2
total = (1.0 / 12.0 + 1.0) * square_y - mean_y**2
both = variance_x * variance_y / total
by_hand = {"motion/level": variance_x * mean_y**2 / total, "mount/m1/axial/k": variance_y / total}
for factor in indices.factors:
    alone, together = by_hand[factor.name], by_hand[factor.name] + both
    print(f"{factor.name}: {factor.first:.3f} alone ({alone:.3f}), {factor.total:.3f} in all ({together:.3f})")
    assert np.isclose(factor.first, alone, atol=0.02)
    assert np.isclose(factor.total, together, atol=0.02)

# %%
places = np.arange(len(indices.factors))
plt.bar(places - 0.2, [100 * one.first for one in indices.factors], 0.35, label="alone")
plt.bar(places + 0.2, [100 * one.total for one in indices.factors], 0.35, label="with the others")
plt.plot(places - 0.2, [100 * by_hand[one.name] for one in indices.factors], "ko", label="closed form")
plt.xticks(places, [{"motion/level": "level of the shock"}.get(one.name, "stiffness") for one in indices.factors])
plt.xlabel("what varies [-]")
plt.ylabel("part of the variance [%]")
plt.legend()
plt.show()
