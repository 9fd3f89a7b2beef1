"""
Results for other programs: CSV and HDF5
========================================

The samples of a run as a table that any program reads, and the same numbers back.
"""

import csv
import tempfile
from pathlib import Path

import h5py
import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# A block on its mount under a half-sine of 20 g and 11 ms.

pulse = wr.HalfSine(peak=20.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="z", start=0.02)
response = wr.simulate(wr.load_system("shock_table"), pulse, duration=0.2, sample_rate=5e3)

# %%
# Both files, read by programs that know nothing of this one. Columns have their unit in the header, or beside the
# dataset.

name = "bodies/block/acceleration/z"
with tempfile.TemporaryDirectory() as folder:
    response.to_csv(Path(folder, "run.csv"))
    response.to_hdf5(Path(folder, "run.h5"))
    with open(Path(folder, "run.csv"), encoding="utf-8", newline="") as file:
        rows = list(csv.reader(row for row in file if not row.startswith("#")))
    with h5py.File(Path(folder, "run.h5")) as file:
        stored = file[name][:]
column = next(i for i, title in enumerate(rows[0]) if title.startswith(name))
read = np.array([float(row[column]) for row in rows[1:]])
print(f"{len(rows) - 1} rows of {len(rows[0])} columns, for instance {rows[0][column]!r}")
assert "m/s^2" in rows[0][column]
assert np.array_equal(stored, response.bodies["block"].acceleration[:, 2])
assert np.allclose(read, stored, rtol=1e-12)

# %%
# What another program may do with them: the velocity of the base, from its acceleration. A half-sine of peak A and
# length D leaves :math:`2 A D / \pi`.

by_hand = 2.0 * 20.0 * wr.STANDARD_GRAVITY * 0.011 / np.pi
change = np.trapezoid(response.base.acceleration[:, 2], response.time)
print(f"velocity change {change:.4f} m/s, by hand {by_hand:.4f} m/s")
assert np.isclose(change, by_hand, rtol=1e-3)

# %%
plt.plot(1e3 * response.time, read)
plt.xlabel("time [ms]")
plt.ylabel("acceleration of the block [m/s²]")
plt.show()
