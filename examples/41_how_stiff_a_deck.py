"""
How stiff a deck?
=================

The block of ``shock_table`` on a deck panel instead of a rigid table: how its peak acceleration depends on the panel's
natural frequency, and on how heavy the panel is.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# A half-sine of 11 ms and 15 g, on the rigid table and on panels of 50, 100 and 400 kg, tuned alone to 6 to 100 Hz.

pulse = wr.HalfSine(peak=15.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="z", start=0.01)
rigid = wr.load_system("shock_table")


def peak(system):
    """Return the block's largest acceleration."""
    return wr.simulate(system, pulse, duration=0.3, timestep=2.5e-4).peaks.bodies["block"].acceleration.value


frequencies = np.geomspace(6.0, 100.0, 15)
factors = {}
for mass in (50.0, 100.0, 400.0):
    panel = wr.on_deck(rigid, f"10 Hz {mass} kg 4 %")
    tuned = [wr.varied(panel, tunings={"deck_panel": frequency / 10.0}) for frequency in frequencies]
    factors[mass] = np.array([peak(system) for system in tuned]) / peak(rigid)

# %%
# A stiff panel is a rigid one; a panel near the pulse and the mount multiplies the peak.

for mass, values in factors.items():
    print(
        f"{mass:.0f} kg: up to {values.max():.2f} times at {frequencies[values.argmax()]:.0f} Hz, {values[-1]:.2f} at 100 Hz"
    )
    assert abs(values[-1] - 1.0) < 0.05
assert max(values.max() for values in factors.values()) > 1.3

# %%
# Two masses on linear springs swing at the roots of a quadratic; the model's are those.

spring = wr.Isolator(name="spring", axial=wr.KelvinVoigt(k=110e3, c=0.0))
linear = wr.on_deck(wr.load_system("shock_table", isolators={"wr12_400": spring}), "10 Hz 100 kg 0 %")
p, e = (2.0 * np.pi * 10.0) ** 2, 110e3 / 50.0
roots = np.sqrt(np.roots([1.0, -(p + 1.5 * e), p * e])) / (2.0 * np.pi)
found = wr.modes(linear).frequencies  # among those across, in which the mount does not act
assert all(np.isclose(found, root, rtol=1e-6).any() for root in roots)

# %%
for mass, values in factors.items():
    plt.semilogx(frequencies, values, label=f"panel of {mass:.0f} kg under 50 kg")
plt.xlabel("natural frequency of the panel alone [Hz]")
plt.ylabel("peak acceleration over that on a rigid deck [-]")
plt.legend()
plt.show()
