"""
Six modes of a cabinet, and the same by hand
============================================

A rigid body on springs has six natural frequencies. The stiffness matrix of a handbook gives them too.
"""

import matplotlib.pyplot as plt
import numpy as np
import scipy

import wirerope_mj as wr

# %%
# The shipped rack of 850 kg on six mounts and four stabilisers, here on springs: 600 kN/m along the mounts, 250 kN/m
# across.

across, along = wr.KelvinVoigt(k=250e3, c=0.0), wr.KelvinVoigt(k=600e3, c=0.0)
spring = wr.Isolator(name="spring", roll=across, shear=across, axial=along)
system = wr.load_system("cabinet", isolators={"cb1400_15": spring})
modes = wr.modes(system)

# %%
# By hand: every spring gives :math:`G^T R \, \mathrm{diag}(k) R^T G`, with its place r from the centre of mass in
# :math:`G = [I, -\mathrm{skew}(r)]`. The forces that carry the weight turn with the rack; that adds
# :math:`\mathrm{skew}(F) \, \mathrm{skew}(r)` to the rotations. Places are those before the sag, which costs up to 0.1 %.


def skew(r):
    """Return the matrix of the cross product with r, (3, 3)."""
    return np.cross(np.eye(3), r)


rack = modes.payloads["rack"]
body = system.model.body("rack").id
turn = scipy.spatial.transform.Rotation.from_quat(system.model.body_iquat[body], scalar_first=True).as_matrix()
mass = scipy.linalg.block_diag(rack.mass * np.eye(3), turn @ np.diag(system.model.body_inertia[body]) @ turn.T)
stiffness = np.zeros((6, 6))
for name, mount in system.mounts.items():
    if mount.isolator_name != "cb1400_15":
        continue  # bump stops do not touch
    r = mount.position - rack.centre
    g = np.hstack([np.eye(3), -skew(r)])
    stiffness += g.T @ mount.axes @ np.diag([250e3, 250e3, 600e3]) @ mount.axes.T @ g
    stiffness[3:, 3:] += skew(mount.axes @ modes.equilibrium.mounts[name].force) @ skew(r)
stiffness = (stiffness + stiffness.T) / 2.0
by_hand = np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True)) / (2.0 * np.pi)
for frequency, hand, text in zip(modes.frequencies, by_hand, modes.descriptions, strict=True):
    print(f"{frequency:7.3f} Hz, by hand {hand:7.3f} Hz: {text}")
assert np.allclose(modes.frequencies, by_hand, rtol=1e-3)

# %%
plt.plot(np.arange(1, 7), by_hand, "o", markersize=12, fillstyle="none", label="by hand")
plt.plot(np.arange(1, 7), modes.frequencies, "x", label="modes of the model")
plt.xlabel("mode [-]")
plt.ylabel("natural frequency [Hz]")
plt.legend()
plt.show()
