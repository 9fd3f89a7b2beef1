"""
A batch of levels
=================

The same block under fifteen levels of one shock, all at once. A spring answers in proportion; a wire-rope mount does
not.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The block of 50 kg of ``shock_table`` on its catalogue mount, and on a spring; half-sines of 11 ms from 1 to 15 g.

g = wr.STANDARD_GRAVITY
levels = np.linspace(1.0, 15.0, 15)
pulses = [wr.HalfSine(peak=level * g, duration=0.011, direction="z", start=0.01) for level in levels]
stiffness = 110e3  # [N/m], the vendor's shock stiffness
spring = wr.Isolator(name="spring", axial=wr.KelvinVoigt(k=stiffness, c=0.0))
systems = {
    "spring": wr.load_system("shock_table", isolators={"wr12_400": spring}),
    "rope": wr.load_system("shock_table"),
}
peaks = {}
for name, system in systems.items():
    batch = wr.simulate_batch(system, pulses, duration=0.15, timestep=2.5e-4)
    peaks[name] = np.array([one.peaks.bodies["block"].acceleration.value for one in batch])

# %%
# Closed form of an undamped mass after a half-sine A of length D: :math:`A |2 r \cos(\pi f D) / (1 - r^2)|` with
# :math:`r = 2 f D`.

f = np.sqrt(stiffness / 50.0) / (2.0 * np.pi)
r = 2.0 * f * 0.011
factor = np.abs(2.0 * r * np.cos(np.pi * f * 0.011) / (1.0 - r**2))
print(f"spring: {peaks['spring'][0] / levels[0] / g:.5f} of the level, by hand {factor:.5f}")
assert np.allclose(peaks["spring"], levels * g * factor, rtol=1e-3)

# %%
# One of them simulated by itself is the same to the last digits. And the rope passes on a smaller part of a high level.

alone = wr.simulate(systems["rope"], pulses[7], duration=0.15, timestep=2.5e-4)
assert np.isclose(alone.peaks.bodies["block"].acceleration.value, peaks["rope"][7], rtol=1e-9)
passed = peaks["rope"] / (levels * g)
print(f"rope: {passed[0]:.3f} of 1 g, {passed[-1]:.3f} of 15 g")
assert (np.diff(passed) < 0.0).all()

# %%
for name, values in peaks.items():
    plt.plot(levels, values / (levels * g), "o", label=name)
plt.axhline(factor, color="0.6", label="closed form of the spring")
plt.xlabel("peak of the half-sine [g]")
plt.ylabel("acceleration of the block / of the base [-]")
plt.legend()
plt.show()
