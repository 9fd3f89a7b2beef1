"""
A genset on six inclined mounts
===============================

A genset of 1200 kg hangs between two rows of mounts that lean inwards. How far does it sink, and what does each mount
carry?
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# The model is a text. Every mount joins a site of the deck to one of the genset; its axial direction is turned about x.


def genset(angle):
    """Return the model with mounts inclined by an angle [deg]."""
    places = [(x, y) for y in (-0.3, 0.3) for x in (-0.8, 0.0, 0.8)]
    deck = payload = mounts = ""
    for n, (x, y) in enumerate(places):
        deck += f'<site name="b{n}" pos="{x} {y} .1" euler="{-np.sign(y) * angle} 0 0"/>'
        payload += f'<site name="p{n}" pos="{x} {y} 0"/>'
        ends = "".join(f'<element objtype="site" objname="{side}{n}"/>' for side in "pb")
        mounts += f'<tuple name="mount/m{n}">{ends}<element objtype="text" objname="isolator/rope"/></tuple>'
    return f"""<mujoco><option gravity="0 0 -9.80665"/><worldbody><body name="deck"><joint type="slide" axis="0 0 1"/>
    <geom size=".1" mass="5" contype="0" conaffinity="0"/>{deck}</body><body name="genset" pos="0 0 .1"><freejoint/>
    <inertial pos="0 0 .35" mass="1200" diaginertia="180 420 440"/>{payload}</body></worldbody>
    <custom><text name="isolator/rope" data="rope.toml"/>{mounts}</custom></mujoco>"""


# %%
# Springs of 300 kN/m along a mount and 100 kN/m across. By hand: inclined by a, a mount has the vertical stiffness
# :math:`k \cos^2 a + k_s \sin^2 a`, and six of them carry the weight.

k, across = 300e3, 100e3
side = wr.KelvinVoigt(k=across, c=0.0)
rope = wr.Isolator(name="rope", roll=side, shear=side, axial=wr.KelvinVoigt(k=k, c=0.0))
angles, weight, sags = [0, 15, 30, 45, 60], 1200.0 * wr.STANDARD_GRAVITY, []
by_hand = lambda a: weight / 6.0 / (k * np.cos(np.radians(a)) ** 2 + across * np.sin(np.radians(a)) ** 2)  # noqa: E731
for angle in angles:
    system = wr.load_system(genset(angle), isolators={"rope": rope})
    rest = wr.equilibrium(system)
    lifts = [(system.mounts[name].axes @ mount.force)[2] for name, mount in rest.mounts.items()]
    assert np.allclose(lifts, -weight / 6.0, rtol=1e-6)  # 1.96 kN each
    sags.append(-(system.mounts["m0"].axes @ rest.mounts["m0"].deflection)[2])
print("sag", np.round(1e3 * np.array(sags), 3), "mm")
assert np.allclose(sags, by_hand(np.array(angles)), rtol=1e-6)

# %%
plt.plot(np.arange(61), 1e3 * by_hand(np.arange(61)), label="by hand")
plt.plot(angles, 1e3 * np.array(sags), "o", label="equilibrium of the model")
plt.xlabel("inclination of the mounts [deg]")
plt.ylabel("sag [mm]")
plt.legend()
plt.show()
