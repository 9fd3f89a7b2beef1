"""
Bouc-Wen in plain MuJoCo
========================

Two callbacks in Python integrate the thesis' law for any n as an activation of MuJoCo; a sweep and a shock, logged to rerun.
"""

import matplotlib.pyplot as plt
import mujoco
import numpy as np
import rerun as rr

import wirerope_mj as wr

# %%
# A block on a driven base. The state z is the activation of an actuator that itself exerts nothing.
law = wr.BoucWen(alpha=6e4, beta=300.0, gamma=100.0, n=0.7, k=3e4)
text = """<mujoco><option timestep="1e-4" integrator="RK4"/><default><geom contype="0" conaffinity="0"/></default><worldbody>
<body name="base"><joint name="b" type="slide" axis="0 0 1" armature="1e10"/><geom size=".1" mass="5"/><site name="s"/></body>
<body name="block"><joint name="p" type="slide" axis="0 0 1"/><geom size=".1" mass="10"/><site name="t"/></body></worldbody>"""
own = '<actuator><general joint="p" dyntype="user" actdim="1" gainprm="0"/></actuator></mujoco>'
model = mujoco.MjModel.from_xml_string(text + own)
data, log, rows = mujoco.MjData(model), rr.RecordingStream("bouc_wen"), []
memory = log.memory_recording()  # log.save("run.rrd") instead writes the file that "rerun run.rrd" shows


def control(model, data):
    """Drive the base by a sweep from 5 Hz, an octave a second, and a half-sine at 1 s; exert the mount's force."""
    a = 3.0 * np.sin(10.0 * np.pi * (2.0**data.time - 1.0) / np.log(2.0))
    a += 80.0 * np.sin(np.pi * (data.time - 1.0) / 0.011) * (1.0 < data.time < 1.011)
    data.qfrc_applied[:] = 1e10 * a + data.qfrc_bias[0], -law.k * (data.qpos[1] - data.qpos[0]) - data.act[0]


def _rate(model, data, actuator):  # dz/dt, thesis (3.7)
    v, z = data.qvel[1] - data.qvel[0], data.act[0]
    return (law.alpha - (law.gamma + law.beta * np.sign(v * z)) * abs(z) ** law.n) * v


mujoco.set_mjcb_control(control)
mujoco.set_mjcb_act_dyn(_rate)
for _ in range(15000):
    rows.append((data.qpos[1] - data.qpos[0], data.act[0]))
    log.set_time("time", duration=data.time)
    log.log("z", rr.Scalars(data.act[0]))
    mujoco.mj_step(model, data)
mujoco.set_mjcb_control(None)
mujoco.set_mjcb_act_dyn(None)
(x, z), recording = np.array(rows).T, memory.drain_as_bytes()
# %%
# The same with this library: a mount in the model's text, and the motion from its parts.
mount = """<custom><text name="isolator/a" data="a"/><tuple name="mount/m1"><element objtype="site" objname="t"/>
<element objtype="site" objname="s"/><element objtype="text" objname="isolator/a"/></tuple></custom></mujoco>"""
system = wr.load_system(text + mount, isolators={"a": wr.Isolator(name="a", axial=law)})
sweep = wr.Sweep(start=5.0, stop=20.0, rate=60.0, acceleration=3.0, direction="z")
motion = sweep + wr.HalfSine(peak=80.0, duration=0.011, direction="z", start=1.0)
run = wr.simulate(system, motion, duration=1.5, initial="unloaded", timestep=1e-4, sample_rate=10000, engine="mujoco")
assert np.abs(run.mounts["m1"].deflection[:-1, 2] - x).max() < 1e-6 * np.abs(x).max()
plt.plot(1e3 * x, law.k * x + z)[0].axes.set(xlabel="deflection [mm]", ylabel="force [N]")
plt.show()
