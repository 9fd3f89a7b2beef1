"""
A law from points of a vendor's curve
=====================================

Some data sheets print a force-deflection curve. It becomes a law as it stands, with the damping that belongs to it.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# Socitec's CB1390-20 in compression: 2.82 kN at 6.8 mm (static) and 8.46 kN at 36 mm (shock). The area of its loop is
# not published; 230 J at 36 mm is an example.

points, force = np.array([0.0, 6.8e-3, 36e-3]), np.array([0.0, 2820.0, 8460.0])
yields, amplitude, area = 1e-3, 36e-3, 230.0
law = wr.Tabulated(
    deflection=points, force=force, symmetric=True, amplitudes=[amplitude], areas=[area], yield_deflection=yields
)

# %%
# The first loading goes through the points, and the closed cycle encloses the area.

first = law.trace(np.union1d(np.linspace(0.0, 36e-3, 200), points))
assert np.allclose(np.interp(points, first.deflection, first.force), force, rtol=1e-9, atol=1e-6)
assert np.isclose(wr.cyclic_test(law, [amplitude])[0].dissipated_energy, area, rtol=1e-6)

# %%
# With a loop of constant half-width h the area is :math:`W = 4 h (A - x_y \tanh(A / x_y))`. So one area says what
# every smaller cycle dissipates.

half_width = area / (4.0 * (amplitude - yields * np.tanh(amplitude / yields)))
smaller = np.array([3e-3, 10e-3, 20e-3])
loops = wr.cyclic_test(law, smaller)
expected = 4.0 * half_width * (smaller - yields * np.tanh(smaller / yields))
for loop, energy in zip(loops, expected, strict=True):
    print(f"{1e3 * loop.deflection.max():4.0f} mm: {loop.dissipated_energy:7.3f} J, by hand {energy:7.3f} J")
    assert np.isclose(loop.dissipated_energy, energy, rtol=1e-6)

# %%
for loop in loops:
    plt.plot(1e3 * loop.deflection, 1e-3 * loop.force, color="0.6")
plt.plot(1e3 * first.deflection, 1e-3 * first.force, label="first loading")
plt.plot(1e3 * points, 1e-3 * force, "o", color="C3", label="data sheet")
plt.xlabel("deflection [mm]")
plt.ylabel("force [kN]")
plt.legend()
plt.show()
