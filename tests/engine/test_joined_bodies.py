"""What joins two bodies, in every room: modes, statics, payloads, the kernel and MuJoCo's run, against a body made by hand."""

import mujoco
import numpy as np
import pytest

import wirerope_mj as wr
from tests.house import deck, mjcf
from wirerope_mj.engine.control import installed
from wirerope_mj.engine.kernel.equations import not_held
from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.engine.statics import model_warnings, static_table
from wirerope_mj.engine.statics.linear import linear_system
from wirerope_mj.engine.statics.payloads import payloads_of

G, K, C = 9.80665, 2.0e5, 40.0
PLATE, BLOCK = 0.5, 3.0
LAW = wr.Isolator(name="a", axial=wr.KelvinVoigt(k=K, c=C), limits=wr.Limits(static_load=50.0))
PULSE = wr.HalfSine(peak=10 * G, duration=0.011, direction="z", start=0.02)
SPRING, DAMPER = 3.0e4, 25.0


def two_bodies(other="", *, joint="", block_geom="", plate_geom="", on_plate=False, rack=""):
    """Make a plate on a mount and a block on a slide, of the world or of the plate; `rack` stands beside them on a mount."""
    block = (
        f'<body name="block" pos="0 0 {0.05 if on_plate else 0.35}"><joint name="jb" type="slide" axis="0 0 1" {joint}/>'
        f'<geom name="b" type="box" size=".02 .02 .02" mass="{BLOCK}" {block_geom}/><site name="sb"/></body>'
    )
    world = deck({"d": 'pos="0 0 .2"', "dr": 'pos="1 0 .2"'}, slides="z") + (
        f'<body name="plate" pos="0 0 .3"><joint name="jp" type="slide" axis="0 0 1"/>'
        f'<geom name="p" type="box" size=".05 .05 .03" mass="{PLATE}" {plate_geom}/><site name="u" pos="0 0 -.1"/>'
        f'<site name="sp"/>{block if on_plate else ""}</body>{"" if on_plate else block}{rack}'
    )
    mounts = [("m1", "u", "d", "a"), *([("m2", "ur", "dr", "a")] if rack else [])]
    return wr.load_system(mjcf(world, mounts, gravity=G, other=other), isolators={"a": LAW})


def one_body(mass=PLATE + BLOCK):
    world = deck({"d": 'pos="0 0 .2"', "dr": 'pos="1 0 .2"'}, slides="z") + (
        f'<body name="plate" pos="0 0 .3"><joint name="jp" type="slide" axis="0 0 1"/><geom size=".05" mass="{mass}"/>'
        '<site name="u" pos="0 0 -.1"/></body>'
    )
    return wr.load_system(mjcf(world, [("m1", "u", "d", "a")], gravity=G), isolators={"a": LAW})


TENDONS = (
    '<tendon><fixed name="tp"><joint joint="jp" coef="1"/></fixed>'
    '<fixed name="tb"><joint joint="jb" coef="1"/></fixed></tendon>'
)
EQUALITIES = {
    "weld": '<equality><weld body1="plate" body2="block"/></equality>',
    "stiffer weld": '<equality><weld body1="plate" body2="block" solref=".002 1"/></equality>',
    "connect": '<equality><connect body1="plate" body2="block" anchor="0 0 .05"/></equality>',
    "joint": '<equality><joint joint1="jb" joint2="jp"/></equality>',
    "tendon": TENDONS + '<equality><tendon tendon1="tb" tendon2="tp"/></equality>',
}
PRESSED = 'contype="1" conaffinity="1" condim="1" solimp="0.9999 0.9999"'
RIGID = {
    **{name: {"other": text} for name, text in EQUALITIES.items()},
    # what rests on something, as rigid as MuJoCo can have it
    "contact": {"block_geom": PRESSED, "plate_geom": PRESSED},
    "limit": {"joint": 'limited="true" range="0 1" solimplimit="0.9999 0.9999"', "on_plate": True},
    "tendon's limit": {
        "other": '<tendon><fixed limited="true" range="0 1" solimplimit="0.9999 0.9999"><joint joint="jb" coef="1"/>'
        '<joint joint="jp" coef="-1"/></fixed></tendon>',
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def reference():
    return one_body(), wr.simulate(one_body(), PULSE, duration=0.2, sample_rate=5000.0)


def accelerations_of_the_run(system, found, mode, step):
    """Return what MuJoCo accelerates where a mode's shape displaces the system at rest by `step`, over the shape."""
    model, data, free = system.model, mujoco.MjData(system.model), found.free
    sides = []
    with installed(model, data):
        for side in (step, -step):
            mujoco.mj_setState(model, data, found.equilibrium.state.values, mujoco.mjtState.mjSTATE_INTEGRATION)
            mujoco.mj_integratePos(model, data.qpos, side * found.shapes[:, mode], 1.0)
            mujoco.mj_forward(model, data)
            sides.append(data.qacc[free].copy())
    shape = found.shapes[free, mode]
    return (sides[0] - sides[1]) / (2.0 * step) @ shape / (shape @ shape)


@pytest.mark.parametrize("element", RIGID)
def test_what_joins_two_bodies_rigidly_makes_them_one_in_every_room(element, reference):
    single, expected = reference
    system = two_bodies(**RIGID[element])
    found = wr.modes(system)
    frequency = np.sqrt(K / (PLATE + BLOCK)) / (2 * np.pi)
    nearest = int(np.argmin(np.abs(found.frequencies - frequency)))
    # a contact's reference, of 8 Hz and damped critically, moves it by 1e-4 of itself times the ratio of masses
    assert found.frequencies[nearest] == pytest.approx(frequency, rel=1e-3)
    assert found.damping_ratio[nearest] == pytest.approx(C / (2 * np.sqrt(K * (PLATE + BLOCK))), rel=0.02)
    assert found.frequencies.size == (1 if element in EQUALITIES else 2)
    sag = static_table(system).virgin
    assert sag.weight == pytest.approx((PLATE + BLOCK) * G, rel=1e-12)
    assert sag.mounts["m1"].split == pytest.approx(1.0, rel=1e-6)
    assert sag.elsewhere + sag.on_contacts == pytest.approx(0.0, abs=1e-6 * sag.weight)
    assert sag.payloads["plate"].mass == pytest.approx(PLATE + BLOCK)
    assert sag.equilibrium.mounts["m1"].deflection[2] == pytest.approx(-(PLATE + BLOCK) * G / K, rel=1e-6)
    if element in EQUALITIES:
        assert [one.mass for one in payloads_of(system)] == [PLATE + BLOCK]
        assert "equality constraints" in not_held(system)
        assert slowest_period(system) == pytest.approx(slowest_period(single), rel=1e-6)
        assert accelerations_of_the_run(system, found, 0, 1e-6) == pytest.approx(-((2 * np.pi * frequency) ** 2), rel=2e-3)
    assert model_warnings(system) == ()
    if element in EQUALITIES:  # the others part in the pulse
        response = wr.simulate(system, PULSE, duration=0.2, sample_rate=5000.0)
        assert response.numerics.engine == "mujoco"
        for body in ("plate", "block"):
            peak = response.peaks.bodies[body].acceleration.value
            assert peak == pytest.approx(expected.peaks.bodies["plate"].acceleration.value, rel=2e-3)


SOFTER = PRESSED.replace("0.9999 0.9999", "0.9 0.95")
SOFT = {
    "contact": {"block_geom": SOFTER, "plate_geom": SOFTER},
    "limit": {"joint": 'limited="true" range="0 1"', "on_plate": True},
}  # fmt: skip


@pytest.mark.parametrize("element", SOFT)
def test_a_contact_at_rest_is_as_soft_in_modes_as_in_a_run_and_that_is_said(element):
    system = two_bodies(**SOFT[element])
    with pytest.warns(wr.ModelWarning, match=r"gives way as MuJoCo has it.* frequency of 38\.\d+ Hz, if it were rigid, is"):
        found = wr.modes(system)
    for mode in range(2):
        a = accelerations_of_the_run(system, found, mode, 1e-8)
        assert a == pytest.approx(-((2 * np.pi * found.frequencies[mode]) ** 2), rel=1e-5)  # differences of 1e-8 m


def test_a_weld_that_is_written_soft_is_rigid_in_modes_and_its_figure_in_a_run_is_said():
    """By hand: with D = d / (1 - d) / (1/m + 1/M) the run's mass is M + J^T D J, and its stiffness K + J^T D k J."""
    system = two_bodies('<equality><weld name="w" body1="plate" body2="block" solimp="0.9 0.94"/></equality>')
    assert wr.modes(system).frequencies == pytest.approx([np.sqrt(K / 3.5) / (2 * np.pi)], rel=1e-6)
    reduced = 1.0 / (1.0 / PLATE + 1.0 / BLOCK)
    weight, relative = 0.9 / 0.1 * reduced, np.array([[1.0, -1.0], [-1.0, 1.0]])
    mass = np.diag([PLATE, BLOCK]) + weight * relative
    stiffness = np.diag([K, 0.0]) + weight * 0.9 / (0.94 * 0.02) ** 2 * relative
    soft = np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real.max()) / (2 * np.pi)
    (said,) = model_warnings(system)
    assert "equality 'w' (weld of 'plate' and 'block')" in said
    assert f"38.05 Hz is {soft:.4g} Hz there" in said
    with pytest.warns(wr.ModelWarning, match="gives way in a simulation"):
        wr.simulate(system, PULSE, duration=0.05)


RACK = (
    '<body name="rack" pos="1 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="60"/>'
    '<site name="ur" pos="0 0 -.1"/></body>'
)


def test_what_gives_way_is_said_by_the_frequency_that_it_moves_most():
    soft = 'solimp="0.9 0.95 0.001 0.5 3"'
    welded = two_bodies(f'<equality><weld body1="plate" body2="block" {soft}/></equality>', rack=RACK)
    rigid = np.sqrt(K / (PLATE + BLOCK)) / (2 * np.pi)
    assert wr.modes(welded).frequencies == pytest.approx([np.sqrt(K / 60.0) / (2 * np.pi), rigid], rel=1e-6)
    assert any(f"gives way in a simulation: the natural frequency of {rigid:.4g} Hz" in line for line in model_warnings(welded))
    pressed = f'contype="1" conaffinity="1" condim="1" {soft}'
    with pytest.warns(wr.ModelWarning, match=f"gives way as MuJoCo has it.* frequency of {rigid:.4g} Hz, if it were rigid"):
        wr.modes(two_bodies(block_geom=pressed, plate_geom=pressed, rack=RACK))


def test_mounts_count_once_beside_a_tendon_while_callbacks_are_installed():
    system = two_bodies('<tendon><fixed name="t" stiffness="0"><joint joint="jb" coef="1"/></fixed></tendon>')
    alone = linear_system(system, closed=False).stiffness
    with installed(system.model, mujoco.MjData(system.model)):  # as another thread does that simulates
        np.testing.assert_allclose(linear_system(system, closed=False).stiffness, alone, rtol=1e-9, atol=1e-9 * K)


def test_springs_and_dampers_of_tendons_and_actuators_count_in_modes_and_run_alike():
    tendon = (
        f'<tendon><fixed name="t" stiffness="{SPRING}" damping="{DAMPER}"><joint joint="jb" coef="1"/>'
        '<joint joint="jp" coef="-1"/></fixed></tendon>'
    )
    servo = (
        '<actuator><general joint="jb" gaintype="fixed" gainprm="0" biastype="affine" '
        f'biasprm="0 {-SPRING} {-DAMPER}"/></actuator>'
    )
    along = {"tendon": np.array([[1.0, -1.0], [-1.0, 1.0]]), "actuator": np.diag([0.0, 1.0])}
    for element, text in (("tendon", tendon), ("actuator", servo)):
        system = two_bodies(text)
        found = wr.modes(system)
        mass, stiffness = np.diag([PLATE, BLOCK]), np.diag([K, 0.0]) + SPRING * along[element]
        damping = np.diag([C, 0.0]) + DAMPER * along[element]
        values, shapes = np.linalg.eig(np.linalg.solve(mass, stiffness))
        order = np.argsort(values)
        assert found.frequencies == pytest.approx(np.sqrt(values[order]) / (2 * np.pi), rel=1e-6)  # of central differences
        for mode, column in enumerate(order):
            shape, omega = shapes[:, column], np.sqrt(values[column])
            ratio = shape @ damping @ shape / (2 * omega * (shape @ mass @ shape))
            assert found.damping_ratio[mode] == pytest.approx(ratio, rel=1e-5)
            a = accelerations_of_the_run(system, found, mode, 1e-6)
            assert a == pytest.approx(-values[column], rel=1e-6)
        assert slowest_period(system) == pytest.approx(1.0 / found.frequencies[0], rel=2e-3)  # damped there
        assert not_held(system)
        sag = static_table(system).virgin
        assert sag.mounts["m1"].split == pytest.approx(1.0, rel=1e-6)


def test_dry_friction_of_a_joint_is_named_with_what_is_without_it():
    (said,) = model_warnings(two_bodies(joint='frictionloss="5" stiffness="1000"', on_plate=True))
    assert said.startswith("joint 'jb': `frictionloss` acts in a simulation alone.")


def test_an_equality_on_the_driven_base_alone_is_refused_by_name():
    with pytest.raises(wr.ModelError, match=r"equality 'e' \(joint of 'deck_z'\) holds the driven base 'deck'"):
        two_bodies('<equality><joint name="e" joint1="deck_z"/></equality>')
