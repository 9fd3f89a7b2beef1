"""
How stiff a deck?
=================

The block of ``shock_table`` on a deck panel instead of a rigid table: how its peak acceleration depends on the panel's
natural frequency, and on how heavy the panel is, for three shocks.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# A short and a long half-sine and a double pulse, on the rigid table and on panels as heavy as the block, twice and eight
# times as heavy, tuned alone to 6 to 100 Hz.

g, z = wr.STANDARD_GRAVITY, {"direction": "z", "start": 0.01}
shocks = {
    "half-sine, 50 g, 3 ms": wr.HalfSine(peak=50.0 * g, duration=0.003, **z),
    "half-sine, 15 g, 11 ms": wr.HalfSine(peak=15.0 * g, duration=0.011, **z),
    "double pulse, 20 g": wr.DoubleHalfSine(peak=20.0 * g, velocity=1.2, displacement=0.03, **z),
}
rigid = wr.load_system("shock_table")
frequencies, ratios = np.geomspace(6.0, 100.0, 9), (1.0, 2.0, 8.0)
panels = [wr.on_deck(rigid, f"10 Hz {50.0 * ratio} kg 4 %") for ratio in ratios]
tuned = [[wr.varied(panel, tunings={"deck_panel": f / 10.0}) for f in frequencies] for panel in panels]


def peak(system, shock):
    """Return the block's largest acceleration."""
    return wr.simulate(system, shock, duration=0.3).peaks.bodies["block"].acceleration.value


# %%
# Two masses on linear springs swing at the roots of a quadratic; the model's are those.

spring = wr.Isolator(name="spring", axial=wr.KelvinVoigt(k=110e3, c=0.0))
linear = wr.on_deck(wr.load_system("shock_table", isolators={"wr12_400": spring}), "10 Hz 100 kg 0 %")
p, e = (2.0 * np.pi * 10.0) ** 2, 110e3 / 50.0
roots = np.sqrt(np.roots([1.0, -(p + 1.5 * e), p * e])) / (2.0 * np.pi)
assert all(np.isclose(wr.modes(linear).frequencies, root, rtol=1e-6).any() for root in roots)

# %%
# A stiff panel is a rigid one; a panel near the pulse and the mount multiplies the peak, most where it closes the stops.

figure, axes = plt.subplots(1, 3, figsize=(11, 3.6), sharey=True, layout="constrained")
for ax, (name, shock) in zip(axes, shocks.items(), strict=True):
    factors = np.array([[peak(system, shock) for system in row] for row in tuned]) / peak(rigid, shock)
    assert abs(factors[:, -1] - 1.0).max() < 0.05
    for ratio, values in zip(ratios, factors, strict=True):
        print(f"{name}, {ratio:g} times as heavy: up to {values.max():.2f} at {frequencies[values.argmax()]:.0f} Hz")
        ax.loglog(frequencies, values, label=f"panel {ratio:g} times as heavy")
    ax.set(title=name, xlabel="panel's frequency alone [Hz]", ylabel="peak over that on a rigid deck [-]")
axes[0].legend()
plt.show()
