"""
Choose a law
============

Several laws are fitted to the same loops, and each is asked for the amplitude that it has not seen.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# Loops of a device that hardens in shear (Ni's symmetric law), with 2 N of noise.

device = wr.SymmetricBoucWen(alpha=2e5, beta=500.0, gamma=100.0, n=1.0, k1=3e4, k2=0.0, k3=6e8)
amplitudes = np.array([1e-3, 3e-3, 6e-3, 10e-3])
time = np.arange(0.0, 20.0, 0.005)
deflection = np.repeat(amplitudes, 1000) * np.sin(2.0 * np.pi * time)
force = device.trace(deflection).force + np.random.default_rng(2).normal(0.0, 2.0, time.size)
loops = wr.steady_loops(deflection, force, time=time)

# %%
# The comparison prints the misfit of each law, once with all loops and once for the amplitude left out.

table = wr.compare_laws(loops, laws=[wr.EnhancedDryFriction, wr.BoucWen, wr.SymmetricBoucWen])
print(table)
assert table.best.law == "symmetric-bouc-wen"
assert table.most_general.law == "symmetric-bouc-wen"

# %%
# The other two have a straight spring. A cubic one of k3 = 6e8 N/m^3 adds 600 N at 10 mm, which no straight line
# through all amplitudes follows; the law that has it finds k3.

k3 = table.best.fit.parameters["k3"].value
print(f"k3 = {k3:.3g} N/m^3 (true 6e8)")
assert np.isclose(k3, 6e8, rtol=0.03)

# %%
for row in table.rows:
    plt.semilogy(1e3 * amplitudes, 100.0 * row.errors_left_out, "o-", label=row.law)
plt.xlabel("amplitude that was left out [mm]")
plt.ylabel("error on it, of its force range [%]")
plt.legend()
plt.show()
