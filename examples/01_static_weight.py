"""
The sag of one mass on one mount
================================

A block of 50 kg stands on a wire-rope mount. How far does it sink, and does the sag agree with the curve of the mount?
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import wirerope_mj as wr

# %%
# The mount follows Bouc and Wen's law: stiff at first, because its strands stick, then softer, because they slip. The
# numbers say just that: the hysteretic force reaches at most 300 N, over a yield deflection of 1.5 mm, beside a spring
# of 60 kN/m.

law = wr.BoucWen.from_normalised(z_max=300.0, x_y=1.5e-3, sigma=1.0, n=1.0, k=60e3)
mount = wr.Isolator(name="my mount", axial=law)

# %%
# The shipped model ``shock_table`` is a block of 50 kg on one mount. It gets this mount in place of its own.

system = wr.load_system("shock_table", isolators={"wr12_400": mount})
rest = wr.equilibrium(system)
deflection = rest.mounts["m1"].deflection[2]  # axial; compression is negative
force = rest.mounts["m1"].force[2]

# %%
# On the first loading, and with n = 1, the law has a closed form: :math:`F = k x + z_{max} (1 - e^{-x / x_y})`. The
# sag is where this equals the weight.

weight = 50.0 * wr.STANDARD_GRAVITY


def first_loading(x):
    """Return the force of the mount on its first loading [N]."""
    return 60e3 * x + 300.0 * (1.0 - np.exp(-x / 1.5e-3))


sag = brentq(lambda x: first_loading(x) - weight, 0.0, 0.1)
print(f"sag {-1e3 * deflection:.4f} mm, by hand {1e3 * sag:.4f} mm; force {force:.3f} N, weight {weight:.3f} N")
assert np.isclose(-deflection, sag, rtol=1e-6)
assert np.isclose(-force, weight, rtol=1e-6)

# %%
x = np.linspace(0.0, 8e-3, 200)
plt.plot(1e3 * x, first_loading(x), label="first loading")
plt.axhline(weight, color="0.6", label="weight of 50 kg")
plt.plot(-1e3 * deflection, -force, "o", color="C3", label="static equilibrium")
plt.xlabel("compression [mm]")
plt.ylabel("force [N]")
plt.legend()
plt.show()
