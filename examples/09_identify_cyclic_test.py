"""
Identify a law from a cyclic test
=================================

From force and deflection over time to the parameters of a law, each with its standard error. The test is made up, so
that the right answer is known.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# A device in a virtual rig: five cycles of each of four amplitudes at 1 Hz, 200 samples a second, 5 N of noise.

true = {"z_max": 800.0, "x_y": 2e-3, "sigma": 0.7, "n": 1.4, "k": 5e4}
device = wr.BoucWen.from_normalised(**true)
time = np.arange(0.0, 20.0, 0.005)
deflection = np.repeat([0.5e-3, 1.5e-3, 4e-3, 8e-3], 1000) * np.sin(2.0 * np.pi * time)
noise = np.random.default_rng(1).normal(0.0, 5.0, time.size)
force = device.trace(deflection).force + noise

# %%
# The record is cut into one steady loop for each amplitude, and the law is fitted to all of them.

loops = wr.steady_loops(deflection, force, time=time)
fit = wr.identify(loops, law=wr.BoucWen)
assert len(loops) == 4
assert fit.converged

# %%
# Every parameter comes back within three standard errors.

for name, value in true.items():
    found = fit.parameters[name]
    print(f"{name:6s} {found.value:10.5g} +- {found.standard_error:.2g}   (true {value:g})")
    assert abs(found.value - value) < 3.0 * found.standard_error
    assert abs(found.value / value - 1.0) < 0.05

# %%
# What counts in the end: the energy of the largest cycle, against that of the device.

energy = device.trace(8e-3 * np.sin(np.linspace(0.0, 6.0 * np.pi, 1201))).work
assert np.isclose(wr.cyclic_test(fit.law, [8e-3])[0].dissipated_energy, energy[1200] - energy[800], rtol=5e-3)

# %%
for number, loop in enumerate(wr.cyclic_test(fit.law, [0.5e-3, 1.5e-3, 4e-3, 8e-3])):
    plt.plot(1e3 * loop.deflection, 1e-3 * loop.force, "C0", label="identified law" if number == 0 else None)
plt.plot(1e3 * deflection[::7], 1e-3 * force[::7], ".", color="C1", markersize=3, label="record")
plt.xlabel("deflection [mm]")
plt.ylabel("force [kN]")
plt.legend()
plt.show()
