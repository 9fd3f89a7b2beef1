"""
How damping depends on the amplitude
====================================

Friction that builds up over a deflection: three parameters, and a formula for the energy of every cycle. Small cycles
have nearly no damping, large ones neither; in between lies a largest value.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# TNO's law: a spring k beside a friction d that builds up over the deflection u_c. Cyclic tests of 30 amplitudes.

k, d, u_c = 50e3, 200.0, 1e-3
law = wr.EnhancedDryFriction(k=k, d=d, u_c=u_c)
amplitudes = np.geomspace(0.02e-3, 50e-3, 30)
loops = wr.cyclic_test(law, amplitudes)
energy = np.array([loop.dissipated_energy for loop in loops])
damping_ratio = np.array([loop.damping_ratio for loop in loops])

# %%
# Closed form: a cycle of amplitude A dissipates :math:`4 d (A - u_c \tanh(A / u_c))`, and its tips are joined by the
# secant :math:`k + d \tanh(A / u_c) / A`. The damping ratio is :math:`W / (2 \pi K A^2)`.

saturation = np.tanh(amplitudes / u_c)
expected = 4.0 * d * (amplitudes - u_c * saturation)
secant = k + d * saturation / amplitudes
assert np.allclose(energy, expected, rtol=1e-9)
assert np.allclose([loop.secant_stiffness for loop in loops], secant, rtol=1e-6)
assert np.allclose(damping_ratio, expected / (2.0 * np.pi * secant * amplitudes**2), rtol=1e-6)

# %%
# The largest damping ratio lies where the friction has just built up, at a few times u_c.

best = np.argmax(damping_ratio)
print(f"largest damping ratio {100 * damping_ratio[best]:.1f} % at {1e3 * amplitudes[best]:.2f} mm")
assert 1.0 < amplitudes[best] / u_c < 5.0

# %%
plt.semilogx(1e3 * amplitudes, 100 * expected / (2 * np.pi * secant * amplitudes**2), label="closed form")
plt.semilogx(1e3 * amplitudes, 100 * damping_ratio, "o", label="cyclic tests")
plt.xlabel("amplitude [mm]")
plt.ylabel("damping ratio [%]")
plt.legend()
plt.show()
