"""
The same mount in plain MuJoCo
==============================

A mount needs no magic: a model of MuJoCo, a callback of your own, and the law in three lines.
"""

import matplotlib.pyplot as plt
import mujoco
import numpy as np

import wirerope_mj as wr

# %%
# A block of 50 kg on a Bouc-Wen mount that starts with 1 m/s. First with this library.

mass, alpha, beta, k = 50.0, 2e5, 400.0, 1e5
model_text = f"""<mujoco><option gravity="0 0 0" timestep="2e-5" integrator="Euler"/>
<default><geom contype="0" conaffinity="0"/></default><worldbody>
<body name="base"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="5"/><site name="b"/></body>
<body name="block"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="{mass}"/><site name="p"/></body></worldbody>
<custom><text name="isolator/a" data="a"/><tuple name="mount/m1"><element objtype="site" objname="p"/>
<element objtype="site" objname="b"/><element objtype="text" objname="isolator/a"/></tuple></custom></mujoco>"""
law = wr.BoucWen(alpha=alpha, beta=beta, gamma=0.0, n=1.0, k=k)
system = wr.load_system(model_text, isolators={"a": wr.Isolator(name="a", axial=law)})
response = wr.simulate(system, wr.VelocityStep(velocity=-1.0, direction="z"), duration=0.3, accuracy=1e-6)

# %%
# Then without it: the same text, and a passive force on the block's joint, with z along the path in closed form.
model = mujoco.MjModel.from_xml_string(model_text)
data, memory, path = mujoco.MjData(model), {"x": 0.0, "z": 0.0}, []
data.qvel[1] = 1.0


def mount(model, data):
    """Add the force of the mount; called once in every step."""
    x = data.qpos[1]
    limit = np.sign(x - memory["x"]) * alpha / beta
    memory.update(x=x, z=limit + (memory["z"] - limit) * np.exp(-beta * abs(x - memory["x"])))
    data.qfrc_passive[1] -= k * x + memory["z"]


mujoco.set_mjcb_passive(mount)
for _ in range(15_000):
    mujoco.mj_step(model, data)
    path.append((data.time, data.qpos[1]))
mujoco.set_mjcb_passive(None)
time, deflection = np.array(path).T
error = np.abs(np.interp(response.time[1:], time, deflection) - response.mounts["m1"].deflection[1:, 2]).max()
print(f"largest difference {1e6 * error:.3f} um of {1e3 * deflection.max():.2f} mm")
assert error < 1e-5 * deflection.max()

# %%
plt.plot(1e3 * time, 1e3 * deflection, label="plain MuJoCo")
plt.plot(1e3 * response.time, 1e3 * response.mounts["m1"].deflection[:, 2], "--", label="wirerope_mj")
plt.xlabel("time [ms]")
plt.ylabel("deflection [mm]")
plt.legend()
plt.show()
