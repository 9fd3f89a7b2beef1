"""
A measured record on the base
=============================

An accelerometer's file becomes the motion of the base. The record is made up, so that the right answer is known.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# A struck deck of 14 Hz, as a logger would write it: 5000 samples a second, five digits, and an offset of 0.05 g.

deck = wr.DecayingSine(frequency=14.0, damping=0.05, velocity=0.8, direction="z", impact_duration=0.004, start=0.1)
time = np.arange(0.0, 2.5, 2e-4)
reading = deck.acceleration(time)[:, 2] / wr.STANDARD_GRAVITY + 0.05
rows = [f"{t:.4f}, {a:.5f}" for t, a in zip(time, reading, strict=True)]

# %%
# The record is read from a file with units in its header. Its baseline is the level of the quiet part at its beginning.

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder, "deck.csv")
    path.write_text("\n".join(["time [s], z [g]", *rows]) + "\n", encoding="utf-8")
    record = wr.load_record(path, channels={"z": "z"}, baseline="rest")

# %%
# The offset is gone: the peak is the deck's, and its velocity after the blow that of the deck, but for what straight
# lines between 20 samples leave out of a half-sine, :math:`(\pi / 20)^2 / 12` of it.

error = np.abs(record.acceleration(time)[:, 2] - deck.acceleration(time)[:, 2]).max()
print(f"largest error {error:.4f} m/s^2 of {np.abs(deck.acceleration(time)).max():.0f} m/s^2")
assert error < 0.01
assert np.isclose(record.velocity(time)[:, 2].max(), deck.velocity(time)[:, 2].max(), rtol=4e-3)

# %%
# The block of ``shock_table`` does not tell the record from the deck.

system = wr.load_system("shock_table")
measured, known = (wr.simulate(system, motion, duration=1.0, accuracy=1e-3) for motion in (record, deck))
peaks = [one.peaks.bodies["block"].acceleration.value for one in (measured, known)]
print(f"block: {peaks[0]:.2f} m/s^2 under the record, {peaks[1]:.2f} m/s^2 under the deck")
assert np.isclose(*peaks, rtol=2e-3)

# %%
plt.plot(known.time, known.bodies["block"].acceleration[:, 2], color="0.6", lw=4, label="under the deck as it is known")
plt.plot(measured.time, measured.bodies["block"].acceleration[:, 2], label="under its record")
plt.xlabel("time [s]")
plt.ylabel("acceleration of the block [m/s²]")
plt.legend()
plt.show()
