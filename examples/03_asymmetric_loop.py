"""
Ni's loop: stiffer in tension than in compression
=================================================

A wire-rope isolator straightens when it is pulled and folds when it is pressed. Ni's law multiplies force and friction
by exp(c x ln b) for that.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import wirerope_mj as wr

# %%
# The law of a catalogue part along its axis, and its steady loops of 5, 10 and 20 mm about the unloaded height.

law = wr.load_isolator("enidine_wr16_400").axial
amplitudes = np.array([5e-3, 10e-3, 20e-3])
loops = wr.cyclic_test(law, amplitudes)

# %%
# The law is a sum of two, whose friction yields at two scales. With n = 2 and gamma = 0 the friction of each at the tips
# is :math:`z_{max} \tanh u` with :math:`\arctan \tanh u + u = 2 A / x_y`. So the two tip forces are known without the
# simulation, and their ratio is :math:`e^{2 c A \ln b}` whatever the rest of the law, as c is common.

tip = np.zeros(3)
for part in law.components:
    z_max, x_y = np.sqrt(part.alpha / part.beta), 1.0 / np.sqrt(part.alpha * part.beta)
    u = [brentq(lambda u, s=2.0 * a / x_y: np.arctan(np.tanh(u)) + u - s, 0.0, 2.0 * a / x_y) for a in amplitudes]
    tip += z_max * np.tanh(u) + part.k1 * amplitudes + part.k3 * amplitudes**3
shift = law.components[0].c * np.log(law.components[0].b) * amplitudes
for loop, force, exponent in zip(loops, tip, shift, strict=True):
    assert np.isclose(loop.force.max(), force * np.exp(exponent), rtol=1e-6)
    assert np.isclose(loop.force.min(), -force * np.exp(-exponent), rtol=1e-6)
    ratio = -loop.force.max() / loop.force.min()
    print(f"{1e3 * loop.deflection.max():4.0f} mm: {ratio:.3f} times as much force in tension as in compression")
    assert np.isclose(ratio, np.exp(2.0 * exponent), rtol=1e-6)

# %%
# The energy of a loop is its area, summed here by trapezoids over its 400 points.

area = [np.trapezoid(loop.force, loop.deflection) for loop in loops]
assert np.allclose([loop.dissipated_energy for loop in loops], area, rtol=2e-3)

# %%
for loop in loops:
    plt.plot(1e3 * loop.deflection, 1e-3 * loop.force, label=f"{loop.dissipated_energy:.1f} J a cycle")
plt.xlabel("deflection, tension positive [mm]")
plt.ylabel("force [kN]")
plt.legend()
plt.show()
