"""
A hardening mount: folds, jumps and what is stable
==================================================

Where the response curve leans over there are three motions at one frequency, and one of them cannot be seen: a sweep
jumps.
"""

import matplotlib.pyplot as plt
import numpy as np

import wirerope_mj as wr

# %%
# One mass on a law that hardens (cubic spring) and is little damped, in SI units of a made-up size.

law = wr.SymmetricBoucWen(alpha=1.0, beta=0.5, gamma=-0.2, n=2.0, k1=1.0, k2=0.0, k3=0.5)
model = """<mujoco><option gravity="0 0 0"/><default><geom contype="0" conaffinity="0"/></default><worldbody>
<body name="deck"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="5"/><site name="b" pos="0 0 .2"/></body>
<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="1"/>
<site name="p" pos="0 0 -.1"/></body></worldbody><custom><text name="isolator/a" data="a.toml"/><tuple name="mount/m1">
<element objtype="site" objname="p"/><element objtype="site" objname="b"/>
<element objtype="text" objname="isolator/a"/></tuple></custom></mujoco>"""
system = wr.load_system(model, isolators={"a": wr.Isolator(name="a", axial=law)})
branch = wr.follow_branch(system, start=0.25, stop=0.35, acceleration=0.8, direction="z", payload="mass")
up, down = branch.folds
print([event.description for event in branch.bifurcations])

# %%
# Between its two folds the branch is unstable, elsewhere stable. Within 0.1 % of a fold the steps in time cannot tell.

middle = np.zeros(branch.frequency.size, dtype=bool)
middle[up.index : down.index] = True
near = np.min(np.abs(branch.frequency[:, None] / [up.frequency, down.frequency] - 1.0), axis=1) < 1e-3
assert (branch.stable == ~middle)[~near].all()
assert np.count_nonzero(middle & ~near) > 10
assert [jump.rising for jump in branch.jumps] == [True, False]

# %%
# Harmonic balance knows no stability, but it turns back at the same frequencies.

balance = wr.follow_harmonic_balance(law, mass=1.0, start=0.25, stop=0.35, acceleration=0.8, harmonics=11)
folds = [fold.frequency for fold in balance.folds]
print("folds", [f"{f:.5f} Hz" for f in folds], f"and {up.frequency:.5f}, {down.frequency:.5f} Hz")
assert np.allclose(folds, [up.frequency, down.frequency], rtol=1e-3)

# %%
plt.plot(branch.frequency, np.where(middle, np.nan, branch.amplitude), label="stable")
plt.plot(branch.frequency, np.where(middle, branch.amplitude, np.nan), "--", label="unstable")
for jump in branch.jumps:
    plt.annotate("", (jump.parameter, jump.landing), (jump.parameter, jump.amplitude), arrowprops={"arrowstyle": "->"})
plt.xlabel("frequency [Hz]")
plt.ylabel("acceleration of the mass [m/s²]")
plt.legend()
plt.show()
