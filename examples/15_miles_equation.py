"""
Random vibration and Miles' equation
====================================

How hard equipment of one natural frequency is shaken by broad-band noise, without a simulation.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The "general minimum integrity" density of MIL-STD-810H 514.8: 0.04 g^2/Hz from 20 to 1000 Hz, falling by 6 dB an
# octave to 2000 Hz. Its rms is 7.69 g.

psd = wr.motions.psd_from_g([(20.0, 0.04), (1000.0, 0.04), (2000.0, 0.01)])
rms = wr.motions.psd_rms(psd) / wr.STANDARD_GRAVITY
print(f"rms of the density {rms:.3f} g")
assert np.isclose(rms, 7.69, atol=0.01)

# %%
# The vibration response spectrum integrates the squared transfer function over this density. Miles' equation does it
# for a density that is flat from 0 to infinity: :math:`\sqrt{\pi f Q S / 2}`.

frequencies = np.geomspace(10.0, 2000.0, 60)
q = 10.0
spectrum = wr.vibration_response_spectrum(psd, frequencies, q=q)
miles = np.sqrt(np.pi / 2.0 * frequencies * q * 0.04)

# %%
# Within the flat part both agree to 1 % (Miles' own rule leaves out :math:`1/Q^2`, which is 1 % of the square);
# outside, they do not.

flat = (frequencies > 60.0) & (frequencies < 500.0)
ratio = spectrum.acceleration[flat] / wr.STANDARD_GRAVITY / miles[flat]
print(f"spectrum over Miles between 60 and 500 Hz: {ratio.min():.4f} to {ratio.max():.4f}")
assert np.allclose(ratio, 1.0, atol=0.01)
assert spectrum.acceleration[0] / wr.STANDARD_GRAVITY < 0.5 * miles[0]

# %%
plt.loglog(frequencies, spectrum.acceleration / wr.STANDARD_GRAVITY, label="response spectrum, Q = 10")
plt.loglog(frequencies, miles, "k--", label="Miles' equation")
plt.xlabel("natural frequency [Hz]")
plt.ylabel("rms acceleration [g]")
plt.legend()
plt.show()
