"""
Select an isolator by the vendors' worksheet
============================================

200 kg on four mounts fall 0.15 m, may feel 15 g, and stand beside a machine of 2400 rpm. Which parts will do?
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The worksheet treats the mount as a spring. It is that of a vendor's own example, whose answers are known.

g = 9.81
selection = wr.select_isolators(mass=200.0, mounts=4, drop=0.15, fragility=15.0 * g, disturbance=2400.0 / 60.0)
sheet = selection.worksheet
print(f"{len(selection.candidates)} parts will do, {len(selection.rejected)} will not")

# %%
# By hand: the velocity of the fall, the travel that 15 g needs, and the stiffest mounts allowed. The frequency must
# be a third of 40 Hz.

load, velocity = 50.0 * g, np.sqrt(2.0 * g * 0.15)
assert np.isclose(sheet.velocity, velocity)  # 1.716 m/s
assert np.isclose(sheet.smallest_travel, velocity**2 / (15.0 * g))  # 20.0 mm
assert np.isclose(sheet.largest_vibration_stiffness, 50.0 * (2.0 * np.pi * 40.0 / 3.0) ** 2)  # 351 N/mm
assert np.isclose(sheet.largest_shock_stiffness, 50.0 * (15.0 * g / velocity) ** 2)  # 368 N/mm

# %%
# The vendor's part has 60 N/mm under shock. Energy says how far it moves; the example prints 49.5 mm and 6.1 g.

part = next(one for one in selection.candidates if one.part.name == "WR12-606-06")
travel = velocity / np.sqrt(60e3 / 50.0)
print(f"WR12-606-06: {1e3 * part.travel:.1f} mm of {1e3 * 0.0498:.1f} mm, {part.acceleration / g:.1f} g")
assert np.isclose(part.travel, travel, rtol=0.005)
assert np.isclose(part.travel, 49.5e-3, atol=0.05e-3)
assert np.isclose(part.acceleration / g, 6.1, atol=0.05)

# %%
# Travel times acceleration is velocity squared for every spring, so all parts lie on one curve.

travels = np.array([one.travel for one in selection.candidates])
accelerations = np.array([one.acceleration for one in selection.candidates])
assert np.allclose(travels * accelerations, velocity**2)

# %%
plt.plot(1e3 * travels, accelerations / g, "o", label="parts that will do")
plt.plot(1e3 * part.travel, part.acceleration / g, "o", color="C3", label="WR12-606-06")
plt.xlabel("dynamic travel [mm]")
plt.ylabel("acceleration of the equipment [g]")
plt.legend()
plt.show()
