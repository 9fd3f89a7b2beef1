"""
A shaker finds the resonance of a softening mount
=================================================

Steps of a sine through the resonance, once with a low level and once with a high one. The resonance moves down.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The shipped shaker model: 3.5 kg on an isolator that is tuned to a thesis' resonance of 36.2 Hz, under 0.5 g.

system = wr.load_system("sdof_shaker")
levels = {0.25: np.linspace(33.0, 42.0, 19), 0.5: np.linspace(33.0, 42.0, 19)}
g = wr.STANDARD_GRAVITY
found = {
    level: wr.stepped_sine(
        system, frequencies=f, acceleration=level * g, direction="z", payload="mass", settled=1e-3, accuracy=1e-3
    )
    for level, f in levels.items()
}
resonance = {level: one.frequency[np.argmax(one.amplitude)] for level, one in found.items()}
print({f"{level} g": f"{f:.1f} Hz" for level, f in resonance.items()})
assert np.isclose(resonance[0.5], 36.2, atol=0.5)  # a step of the grid
assert np.isclose(resonance[0.25], 37.6, atol=0.5)

# %%
# Harmonic balance finds the same motions without a model and without time: Fourier series of the same law.

law = system.mounts["m1"].isolator.axial
for level, one in found.items():
    for index in (0, 6, 18):
        orbit = wr.harmonic_balance(law, mass=3.5, frequency=one.frequency[index], acceleration=level * g, gravity=g)
        assert np.isclose(one.amplitude[index], orbit.amplitude, rtol=5e-3)

# %%
for level, one in found.items():
    plt.plot(one.frequency, one.transmissibility, ".-", label=f"{level} g")
plt.xlabel("frequency [Hz]")
plt.ylabel("transmissibility [-]")
plt.legend(title="base")
plt.show()
