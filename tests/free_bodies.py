"""Bodies with six degrees of freedom: two joined by one mount, a block on four, a plate that sinks onto its stops."""

import mujoco
import numpy as np
from house import deck, hysteresis, mjcf, quiet, rotation

import wirerope_mj as wr

G = wr.STANDARD_GRAVITY
STATE = mujoco.mjtState.mjSTATE_INTEGRATION


def free_pair(law):
    """Return two free bodies joined by one mount off both centres of mass; a deck stands apart and only names the base."""
    a = '<inertial pos="0 0 0" mass="3" diaginertia=".05 .08 .11"/>'
    b = '<inertial pos=".02 0 .01" mass="5" diaginertia=".2 .12 .25"/>'
    world = (
        '<body name="deck" pos="9 0 0"><joint type="slide" axis="0 0 1"/><geom size=".1"/></body>'
        f'<body name="a" pos="0 0 1.2"><freejoint/>{a}<site name="sa" pos=".1 .05 -.1"/>'
        '<site name="point/tip" pos=".3 -.2 .4"/></body>'
        f'<body name="b" pos="0 0 1"><freejoint/>{b}<site name="sb" pos=".1 .05 .1"/></body>'
    )
    base = '<tuple name="base"><element objtype="body" objname="deck"/></tuple>'
    text = mjcf(world, [("m", "sa", "sb", "i")], custom=base)
    return wr.load_system(text, isolators={"i": wr.Isolator(name="i", roll=law, shear=law, axial=law)})


def spinning(system):
    """Return a state in which both bodies drift apart and tumble."""
    values = wr.simulate(system, quiet(), duration=1e-3, timestep=1e-3, initial="unloaded").initial_state.values
    data = mujoco.MjData(system.model)
    mujoco.mj_setState(system.model, data, values, STATE)
    for name, velocity in (("a", [0.4, -0.3, 0.2, 2.0, -3.0, 1.5]), ("b", [-0.2, 0.5, 0.1, -1.0, 2.0, 2.5])):
        first = int(system.model.body(name).dofadr[0])
        data.qvel[first : first + 6] = velocity
    values = np.empty_like(values)
    mujoco.mj_getState(system.model, data, values, STATE)
    return wr.State(values=values, time=0.0)


PRINCIPAL = {"a": (3.0, np.array([0.05, 0.08, 0.11])), "b": (5.0, np.array([0.2, 0.12, 0.25]))}


def momenta(r):
    """Return momentum and angular momentum about the origin of both bodies, (n_t, 3) each."""
    momentum = angular = 0.0
    for name, (mass, inertia) in PRINCIPAL.items():
        body = r.bodies[name]
        turn = rotation(body.orientation)
        spin = np.einsum("tji,tj->ti", turn, body.angular_velocity)
        own = np.einsum("tij,tj->ti", turn, inertia * spin)
        momentum = momentum + mass * body.velocity
        angular = angular + mass * np.cross(body.position, body.velocity) + own
    return momentum, angular


def free_block():
    """Return a block with six degrees of freedom on four inclined mounts, its site for forces off its centre of mass."""
    places = [(-0.3, -0.2), (0.3, -0.2), (-0.3, 0.2), (0.25, 0.25)]
    sites = [f'<site name="{{}}/m{n}" pos="{x} {y} -.1" euler="10 -20 0"/>' for n, (x, y) in enumerate(places)]
    tuples = [
        f'<tuple name="mount/m{n}"><element objtype="site" objname="block/m{n}"/><element objtype="site" objname="base/m{n}"/>'
        '<element objtype="text" objname="isolator/a"/></tuple>'
        for n in range(4)
    ]
    text = f"""
<mujoco><worldbody>
  <body name="base"><joint type="slide" axis="0 0 1"/>
    <geom size=".5 .5 .02" type="box" pos="0 0 -.2" contype="0" conaffinity="0"/>
    {"".join(sites).format(*["base"] * 4)}</body>
  <body name="block"><freejoint/><inertial mass="80" pos=".02 -.03 .05" fullinertia="3 4 5 .2 -.1 .3"/>
    <geom type="box" size=".4 .3 .1" contype="0" conaffinity="0"/>{"".join(sites).format(*["block"] * 4)}
    <site name="force/engine" pos=".1 .05 .2" euler="30 40 50"/></body>
</worldbody><custom><text name="isolator/a" data="a"/>{"".join(tuples)}</custom></mujoco>"""
    law = wr.BoucWen(alpha=5e4, beta=40.0, gamma=10.0, n=1.0, k=4e4)
    return wr.load_system(text, isolators={"a": wr.Isolator(name="a", roll=law, shear=law, axial=law)})


def floor_on_stops():
    """Return a 400 kg plate that its four soft mounts let down onto four bump stops."""
    corners = [(0.8, 0.5), (0.8, -0.5), (-0.6, 0.5), (-0.6, -0.5)]
    pads = "".join(f'<geom name="pad{i}" type="box" size=".1 .1 .01" pos="{x} {y} -.01"/>' for i, (x, y) in enumerate(corners))
    stops = "".join(
        f'<geom name="stop{i}" type="sphere" size=".04" mass="0" pos="{x} {y} -.05"/>' for i, (x, y) in enumerate(corners)
    )
    sites = {f"d{i}": f'pos="{x} {y} .05"' for i, (x, y) in enumerate(corners)}
    own = "".join(f'<site name="p{i}" pos="{x} {y} -.05"/>' for i, (x, y) in enumerate(corners))
    plate = '<inertial pos="0 0 0" mass="400" diaginertia="40 80 110"/>'
    world = deck(sites, inside=pads) + f'<body name="plate" pos="0 0 .1"><freejoint/>{plate}{stops}{own}</body>'
    pairs = "".join(
        f'<pair geom1="stop{i}" geom2="pad{i}" condim="1" solref="-9000 -40" solimp=".001 .001 .001"/>' for i in range(4)
    )
    text = mjcf(world, [(f"m{i}", f"p{i}", f"d{i}", "a") for i in range(4)], gravity=G, other=f"<contact>{pairs}</contact>")
    law = wr.BoucWen(**hysteresis(alpha=4e4, z_max=200.0), k=2e4)
    return wr.load_system(text, isolators={"a": wr.Isolator(name="a", roll=law, shear=law, axial=law)})
