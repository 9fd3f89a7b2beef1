"""
Rainflow cycles of a mount
==========================

Durability asks for cycles: how many, how large. They are counted as ASTM E1049 says, first on its own example.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The example of ASTM E1049-85: one closed cycle and half cycles, of ranges 3 to 9.

cycles = wr.rainflow_cycles([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
counted = {float(size): float(cycles.counts[cycles.ranges == size].sum()) for size in np.unique(cycles.ranges)}
print("ASTM E1049:", counted)
assert counted == {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}

# %%
# The block of ``shock_table`` on a linear mount, on a base of 2 m/s^2 at 5 Hz for 20 s.

mass, k, c, f = 50.0, 200e3, 1000.0, 5.0
linear = wr.Isolator(name="linear", axial=wr.KelvinVoigt(k=k, c=c))
system = wr.load_system("shock_table", isolators={"wr12_400": linear})
sine = wr.Sine(frequency=f, acceleration=2.0, direction="z", duration=20.0)
response = wr.simulate(system, sine, duration=20.0, accuracy=1e-3)
found = next(one for one in wr.mount_cycles(response) if one.mount == "m1" and one.axis == "axial").cycles

# %%
# By hand: twice the amplitude :math:`a / |k/m - \omega^2 + i \omega c/m|` is the range, 100 cycles of it in 20 s; with
# the exponent 5 they do the damage :math:`100 A^5`. The start-up adds a little.

omega = 2.0 * np.pi * f
amplitude = 2.0 / np.abs(k / mass - omega**2 + 1j * omega * c / mass)
print(f"{found.total:.1f} cycles, median range {1e3 * np.median(found.ranges):.4f} mm ({2e3 * amplitude:.4f} mm by hand)")
assert np.isclose(np.median(found.ranges), 2.0 * amplitude, rtol=2e-3)
large = found.ranges > amplitude
assert np.isclose(found.counts[large].sum(), 100.0, atol=1.5)
assert np.isclose(found.damage(5.0), 100.0 * amplitude**5, rtol=0.1)

# %%
plt.bar(list(counted), list(counted.values()), width=0.6)
plt.xlabel("range of the cycles of ASTM's example [-]")
plt.ylabel("number of cycles [-]")
plt.show()
