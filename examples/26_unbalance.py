"""
What a machine passes on to its foundation
==========================================

An unbalance shakes a machine from within. Above its resonance a soft mount keeps the force to itself.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# A block of 50 kg on a linear mount of 10 Hz, guided along z, with a site ``force/engine`` at which forces act.

mass, k, c = 50.0, 2e5, 1200.0
model = f"""<mujoco><option gravity="0 0 0"/><default><geom contype="0" conaffinity="0"/></default><worldbody>
<body name="base"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="5"/><site name="b"/></body>
<body name="block"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="{mass}"/><site name="p"/>
<site name="force/engine" pos="0 0 .1"/></body></worldbody><custom><text name="isolator/a" data="a"/>
<tuple name="mount/m1"><element objtype="site" objname="p"/><element objtype="site" objname="b"/>
<element objtype="text" objname="isolator/a"/></tuple></custom></mujoco>"""
system = wr.load_system(model, isolators={"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=k, c=c))})

# %%
# An unbalance of 20 kg mm turns at six speeds; the force of the mount is fitted by a sine over its last two turns.

unbalance, frequencies, passed = 0.02, np.array([5.0, 8.0, 10.0, 14.0, 20.0, 30.0]), []
for f in frequencies:
    duration = np.ceil(1.2 * f) / f
    motion = wr.Unbalance(site="engine", unbalance=unbalance, frequency=f, line="z")
    response = wr.simulate(system, motion, duration=duration, timestep=1e-3)
    last = response.time > duration - 2.00001 / f
    omega, time = 2.0 * np.pi * f, response.time[last]
    waves = np.stack([np.sin(omega * time), np.cos(omega * time)], axis=1)
    passed.append(np.hypot(*np.linalg.lstsq(waves, response.mounts["m1"].force[last, 2], rcond=None)[0]))

# %%
# Closed form: of the force :math:`m e \omega^2` the fraction :math:`|k + i \omega c| / |k - M \omega^2 + i \omega c|`
# reaches the foundation.


def transmissibility(f):
    """Return force on the foundation over force of the unbalance [-]."""
    carried = k + 2j * np.pi * f * c
    return np.abs(carried / (carried - mass * (2.0 * np.pi * f) ** 2))


found = np.array(passed) / (unbalance * (2.0 * np.pi * frequencies) ** 2)
assert np.allclose(found, transmissibility(frequencies), rtol=2e-3)

# %%
plt.semilogy(np.arange(2.0, 32.0, 0.1), transmissibility(np.arange(2.0, 32.0, 0.1)), label="closed form")
plt.semilogy(frequencies, found, "o", label="simulation")
plt.xlabel("speed of the machine [Hz]")
plt.ylabel("transmissibility of the force [-]")
plt.ylim(0.1, 10.0)
plt.legend()
plt.show()
