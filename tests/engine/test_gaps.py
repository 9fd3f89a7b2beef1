"""Gaps of pairs of geoms at samples, beside MuJoCo's own distances there."""

import mujoco
import numpy as np
import pytest
from house import deck, mjcf

import wirerope_mj as wr
from wirerope_mj.engine.control import layout as at
from wirerope_mj.engine.simulation.recorder import Gaps

GEOMS = {
    "plane": 'type="plane" size="1 1 1" quat="0.9 0.3 0.2 0.1"',
    "box": 'type="box" size=".3 .2 .1" quat="0.7 -0.3 0.5 0.1"',
    "sphere": 'type="sphere" size=".2"',
    "capsule": 'type="capsule" size=".1 .3"',
}


@pytest.mark.parametrize(
    ("of_base", "of_payload"), [("plane", "sphere"), ("box", "sphere"), ("sphere", "box"), ("sphere", "capsule")]
)
def test_gaps_are_mujocos_distances_to_rounding(of_base, of_payload):
    """In front of, within and behind each other; spheres by closed forms, others by MuJoCo itself."""
    one = f'<geom name="one" pos=".02 .03 .01" {GEOMS[of_base]} mass="0"/>'
    fixed = of_base == "plane"  # planes stand in the world alone
    world = (
        (one if fixed else "")
        + deck({"b": 'pos="0 0 .2"'}, inside="" if fixed else one)
        + (
            '<body name="block" pos="0 0 .2"><freejoint/><geom size=".1" mass="4"/><site name="p"/>'
            f'<geom name="other" pos=".01 -.02 .03" {GEOMS[of_payload]} mass="0"/></body>'
        )
    )
    pair = '<contact><pair geom1="one" geom2="other"/></contact>'
    law = wr.KelvinVoigt(k=1e4, c=10.0)
    system = wr.load_system(mjcf(world, [("m1", "p", "b", "a")], other=pair), isolators={"a": wr.Isolator(name="a", axial=law)})
    model, data, line = system.model, mujoco.MjData(system.model), np.empty(6)
    rng = np.random.default_rng(3)
    values, expected = np.zeros((400, at.KINEMATICS * len(system.assembly.subjects.bodies))), np.empty(400)
    for row in range(400):
        data.qpos[:3] = rng.normal(size=3)
        data.qpos[3:6] = data.qpos[:3] + rng.normal(size=3) * rng.choice([0.1, 0.5, 3.0])
        turn = rng.normal(size=4)
        data.qpos[6:10] = turn / np.linalg.norm(turn)
        mujoco.mj_kinematics(model, data)
        for number, body in enumerate(system.assembly.subjects.bodies):
            values[row, at.KINEMATICS * number :][:3] = data.xipos[body]
            values[row, at.KINEMATICS * number :][3:7] = data.xquat[body]
        one, other = (model.geom(name).id for name in ("one", "other"))
        expected[row] = mujoco.mj_geomDistance(model, data, one, other, 1e3, line)
    gaps = Gaps(system).of(values)[:, 0]
    assert (expected < 0.0).any()
    assert (expected > 0.5).any()
    np.testing.assert_allclose(gaps, expected, rtol=0.0, atol=1e-14)
