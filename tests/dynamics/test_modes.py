"""Modes about the sagged position: closed forms of rigid bodies on springs, tipping over, histories and what is refused."""

import re

import mujoco
import numpy as np
import pytest
from house import deck, mjcf, rack_on_floor_text, sdof
from scipy.optimize import brentq

import wirerope_mj as wr
from wirerope_mj.dynamics.modes import modes, natural_frequencies
from wirerope_mj.dynamics.modes.rest import linearise
from wirerope_mj.engine.control import installed

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY
PLACES = {"p1": (0.5, 0.4), "p2": (0.5, -0.3), "p3": (-0.6, 0.4), "p4": (-0.6, -0.3)}
HALF = (0.35, 0.45, 0.25)
"""Half lengths of the box [m]."""


def box_text(*, places, height, mass=120.0, gravity=G, turned=""):
    """Return a free box whose centre stands `height` above mounts at `places`; `turned` are attributes of all base sites."""
    sites = {f"b{name}": f'pos="{x} {y} 1" {turned}' for name, (x, y) in places.items()}
    points = "".join(f'<site name="{name}" pos="{x} {y} {-height}"/>' for name, (x, y) in places.items())
    size = " ".join(map(str, HALF))
    box = f'<body name="box" pos="0 0 {1 + height}"><freejoint/><geom type="box" size="{size}" mass="{mass}"/>{points}</body>'
    return mjcf(deck(sites) + box, [(f"m{n}", n, f"b{n}", "a") for n in places], gravity=gravity)


def springs(roll, shear, axial, c=0.0):
    """Return an isolator of linear springs [N/m] with dampers [N s/m]."""
    laws = {name: wr.KelvinVoigt(k=k, c=c) for name, k in (("roll", roll), ("shear", shear), ("axial", axial))}
    return {"a": wr.Isolator(name="a", **laws)}


def rigid_stiffness(places, height, k, axes, *, weight):
    """Return K = sum G^T R diag(k) R^T G - W h on roll and pitch, about the centre of mass, (6, 6)."""
    total = np.zeros((6, 6))
    for x, y in places.values():
        rx, ry, rz = x, y, -height
        skew = np.array([[0, -rz, ry], [rz, 0, -rx], [-ry, rx, 0]])
        g = np.hstack([np.eye(3), -skew])
        total += g.T @ axes @ np.diag(k) @ axes.T @ g
    total[3, 3] -= weight * height
    total[4, 4] -= weight * height
    return total


def box_mass(mass):
    """Return the mass matrix of the box about its centre, (6, 6)."""
    x, y, z = (2.0 * half for half in HALF)
    inertia = mass / 12.0 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    return np.diag([mass] * 3 + inertia.tolist())


def frequencies_of(stiffness, mass):
    values = np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)
    return np.sqrt(values) / (2.0 * np.pi)


def test_a_box_on_springs_has_the_six_frequencies_of_the_textbook():
    # Places symmetric about x = -0.05 and y = 0.05 would tilt the box: without gravity the closed form is exact.
    k = (3e4, 5e4, 9e4)
    s = wr.load_system(box_text(places=PLACES, height=0.3, gravity=0.0), isolators=springs(*k))
    expected = frequencies_of(rigid_stiffness(PLACES, 0.3, k, np.eye(3), weight=0.0), box_mass(120.0))
    # Central differences of 1e-6 leave 1e-9 of the stiffness; the site's coordinates are exact.
    np.testing.assert_allclose(modes(s).frequencies, expected, rtol=1e-7)


def test_turned_mounts_act_along_their_own_axes():
    k = (3e4, 5e4, 9e4)
    axes = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]])  # x of the site is (0.6, 0, -0.8)
    text = box_text(places=PLACES, height=0.3, gravity=0.0, turned='xyaxes="0.6 0 -0.8 0 1 0"')
    expected = frequencies_of(rigid_stiffness(PLACES, 0.3, k, axes, weight=0.0), box_mass(120.0))
    np.testing.assert_allclose(modes(wr.load_system(text, isolators=springs(*k))).frequencies, expected, rtol=1e-7)


SYMMETRIC = {"p1": (0.3, 0.2), "p2": (0.3, -0.2), "p3": (-0.3, 0.2), "p4": (-0.3, -0.2)}


def test_weight_above_the_mounts_takes_w_times_h_from_the_tilting_stiffness():
    k, weight = (6e4, 6e4, 4e4), 120.0 * G
    s = wr.load_system(box_text(places=SYMMETRIC, height=0.4), isolators=springs(*k))
    expected = rigid_stiffness(SYMMETRIC, 0.4, k, np.eye(3), weight=weight)
    found = modes(s)
    np.testing.assert_allclose(found.frequencies, frequencies_of(expected, box_mass(120.0)), rtol=1e-7)
    without = frequencies_of(rigid_stiffness(SYMMETRIC, 0.4, k, np.eye(3), weight=0.0), box_mass(120.0))
    assert np.abs(without / found.frequencies - 1.0).max() > 1e-2  # the term is seen in this test


def test_gravity_factor_and_rise_are_those_of_a_body_on_four_springs():
    """det of sway and tilt vanishes where W h equals the tilting stiffness of the axial springs about the mount plane."""
    weight, height, axial = 120.0 * G, 0.4, 4e4
    s = wr.load_system(box_text(places=SYMMETRIC, height=height), isolators=springs(6e4, 6e4, axial))
    tilting = 4.0 * axial * 0.2**2  # the softer one: about x, arms of 0.2 m
    stability = modes(s).stability
    assert stability.stable
    assert stability.word == "stable"
    assert stability.gravity_factor == pytest.approx(tilting / (weight * height), rel=1e-6)
    assert stability.rise == pytest.approx(tilting / weight - height, rel=1e-6)


def pendulum(*, spring, arm, mass=20.0, carrier=50.0, sideways=2e4):
    """Return a carrier that slides along x on a mount, with a mass `arm` (x, z) from a hinge that has a spring [N m/rad]."""
    inner = (
        f'<body name="pendulum"><joint type="hinge" axis="0 1 0" stiffness="{spring}"/>'
        f'<inertial pos="{arm[0]} 0 {arm[1]}" mass="{mass}" diaginertia=".3 .3 .3"/></body>'
    )
    payload = (
        '<body name="carrier" pos="0 0 .3"><joint type="slide" axis="1 0 0"/>'
        f'<inertial pos="0 0 0" mass="{carrier}" diaginertia="1 1 1"/><site name="p" pos="0 0 -.1"/>{inner}</body>'
    )
    text = mjcf(deck({"b": 'pos="0 0 .2"'}, slides="x") + payload, [("m1", "p", "b", "a")], gravity=G)
    system = wr.load_system(text, isolators={"a": wr.Isolator(name="a", roll=wr.KelvinVoigt(k=sideways, c=0.0))})
    length, lean = float(np.hypot(*arm)), float(np.arctan2(*arm))  # of the arm from upright, spring unloaded
    turn = brentq(lambda turn: spring * turn - mass * G * length * np.sin(lean + turn), -1.5, 1.5, xtol=1e-14)
    return system, length * np.cos(lean + turn)


@pytest.mark.parametrize(
    ("spring", "arm"), [(400.0, (0.3, 0.4)), (150.0, (0.2, 0.4)), (200.0, (0.3, 0.1)), (400.0, (0.0, 0.4))]
)
def test_a_jointed_pendulum_on_a_loaded_spring_has_its_closed_forms(spring, arm):
    """The hinge is held by k - W h, h being the height above it: it tips at k / (W h) times W, or k / W - h higher."""
    system, height = pendulum(spring=spring, arm=arm)
    found, weight = modes(system), 20.0 * G
    rest = linearise(system, found.equilibrium)
    # Central differences leave 1e-9 of the largest stiffness, and k / (W h) is as ill-conditioned as h is small.
    np.testing.assert_allclose(rest.other, np.diag([0.0, spring]), atol=1e-6 * spring)
    np.testing.assert_allclose(rest.weight, np.diag([0.0, -weight * height]), atol=1e-6 * spring)
    stability = found.stability
    assert stability.gravity_factor == pytest.approx(spring / (weight * height), rel=1e-6)
    assert stability.softest == pytest.approx(spring / (weight * height), rel=1e-6)
    assert stability.rise == pytest.approx(spring / weight - height, rel=1e-6)
    assert stability.word == ("slender" if spring < 3.0 * weight * height else "stable")


def test_a_pendulum_that_hangs_is_held_by_its_weight_but_may_be_raised():
    system, height = pendulum(spring=400.0, arm=(0.0, -0.4))
    stability = modes(system).stability
    assert np.isinf(stability.gravity_factor)
    assert stability.rise == pytest.approx(400.0 / (20.0 * G) - height, rel=1e-6)
    assert height == pytest.approx(-0.4)
    assert "inf" not in stability.description
    assert stability.description.startswith("stable; it would tip over with its centre of mass")


def test_forces_that_the_mounts_leave_in_the_state_are_not_stiffness():
    """A box without joints other than its own has none but its mounts' and -W h, wherever MuJoCo keeps the mounts' forces."""
    text = box_text(places=SYMMETRIC, height=0.4).replace('<geom type="box"', '<geom type="box" pos="0 0 0.2"')
    s = wr.load_system(text, isolators=springs(6e4, 6e4, 4e4))
    rest = linearise(s, modes(s).equilibrium)
    weight = 120.0 * G * (0.4 + 0.2)  # W h: the centre stands above the body's own origin
    assert np.abs(rest.other).max() < 1e-6 * weight
    np.testing.assert_allclose(rest.weight, np.diag([0, 0, 0, -weight, -weight, 0]), atol=1e-6 * weight)


def test_what_long_vibration_leaves_holds_half_as_high():
    """Half of the initial stiffness is hysteretic: about the virgin position alpha + k holds, about the relaxed one k alone."""
    alpha, k, height, arm = 4e4, 5e4, 0.8, 0.2
    axial = wr.BoucWen(alpha=alpha, beta=20.0, gamma=20.0, n=1.0, k=k)
    stiff = wr.KelvinVoigt(k=1e9, c=0.0)  # no sway: the box tilts about the plane of its mounts
    device = wr.Isolator(name="a", roll=stiff, shear=stiff, axial=axial)
    s = wr.load_system(box_text(places=SYMMETRIC, height=height), isolators={"a": device})
    virgin, relaxed = (modes(s, history=history).stability for history in ("virgin", "relaxed"))
    weight, lever = 120.0 * G, 4 * arm**2  # the softer tilt, about x
    # 1e9 N/m against 1e5 N/m leaves 1e-4 of sway, and the sag of millimetres a share of the lever.
    assert relaxed.rise == pytest.approx(k * lever / weight - height, rel=5e-3)
    assert virgin.rise == pytest.approx((alpha + k) * lever / weight - height, rel=5e-3)
    assert relaxed.gravity_factor < virgin.gravity_factor


def test_a_body_that_is_too_high_tips_over():
    s = wr.load_system(box_text(places=SYMMETRIC, height=1.2), isolators=springs(6e4, 6e4, 3e3))
    found = modes(s)
    assert 120.0 * G * 1.2 > 4.0 * 3e3 * 0.2**2
    assert found.stability.word == "tips over"
    assert not found.stability.stable
    assert np.isnan(found.frequencies[0])
    assert np.isnan(found.damping_ratio[0])
    assert np.abs(found.payloads["box"].rotation[0] @ [1.0, 0.0, 0.0]) > 0.5  # it tilts about x, the narrow way
    assert np.isfinite(found.frequencies[2:]).all()


def test_shapes_are_scaled_by_the_mount_that_moves_most_and_participation_sums_to_the_mass():
    s = wr.load_system(box_text(places=PLACES, height=0.3), isolators=springs(3e4, 5e4, 9e4))
    found = modes(s)
    largest = np.max([np.linalg.norm(shape, axis=1) for shape in found.mounts.values()], axis=0)
    np.testing.assert_allclose(largest, 1.0, rtol=1e-12)
    np.testing.assert_allclose(found.participation.sum(axis=0), 1.0, rtol=1e-9)
    assert found.shapes.shape == (s.model.nv, 6)
    np.testing.assert_array_equal(found.shapes[s.assembly.driven_dofs], 0.0)


def test_words_say_what_moves():
    places = {**SYMMETRIC}
    found = modes(wr.load_system(box_text(places=places, height=0.0, gravity=0.0), isolators=springs(2e4, 3e4, 4e4)))
    # The mount plane passes through the centre: all six are decoupled.
    assert set(found.descriptions) == {
        "sway x", "sway y", "bounce z", "rocking about x", "rocking about y", "yaw about z",
    }  # fmt: skip
    place = found.descriptions.index("bounce z")
    assert found.frequencies[place] == pytest.approx(np.sqrt(4 * 4e4 / 120.0) / (2 * np.pi), rel=1e-8)
    np.testing.assert_allclose(found.payloads["box"].translation[place], [0.0, 0.0, 1.0], atol=1e-9)
    np.testing.assert_allclose(found.participation[place], [0.0, 0.0, 1.0], atol=1e-9)
    rocking = found.descriptions.index("rocking about x")
    # one metre at a mount 0.2 m beside the axis: 5 rad
    np.testing.assert_allclose(np.abs(found.payloads["box"].rotation[rocking]), [5.0, 0.0, 0.0], atol=1e-8)


def chain_text():
    """Return a mass on a mount that carries another mass on a joint with a spring and a damper."""
    inner = (
        '<body name="top" pos="0 0 .3"><joint type="slide" axis="0 0 1" stiffness="7000" damping="30"/>'
        '<geom size=".1" mass="2"/></body>'
    )
    payload = (
        '<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="5"/>'
        f'<site name="p" pos="0 0 -.1"/>{inner}</body>'
    )
    return mjcf(deck({"b": 'pos="0 0 .2"'}, slides="z") + payload, [("m1", "p", "b", "a")], gravity=0.0)


def test_a_mass_on_a_jointed_payload_gives_the_two_frequencies_of_a_chain():
    s = wr.load_system(chain_text(), isolators={"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=20e3, c=0.0))})
    mass, stiffness = np.diag([5.0, 2.0]), np.array([[27e3, -7e3], [-7e3, 7e3]])
    found = modes(s)
    np.testing.assert_allclose(found.frequencies, frequencies_of(stiffness, mass), rtol=1e-7)
    # Damping of the joint alone: c (phi_top - phi_mass)^2 / (2 w m_modal), in the joint's own coordinate.
    shape, omega = found.shapes[s.assembly.driven_dofs[0] + 1 :, 0], 2 * np.pi * found.frequencies[0]
    modal = shape @ found.mass @ shape
    assert found.damping_ratio[0] == pytest.approx(30.0 * shape[1] ** 2 / (2.0 * omega * modal), rel=1e-7)
    assert "top on mass" in found.descriptions[1]
    assert found.payloads["mass"].mass == pytest.approx(7.0)
    own = 7.0 * 0.4 * 0.1**2  # of both balls, and their parallel axes, 0.3 m apart: m1 m2 / (m1 + m2) d^2
    np.testing.assert_allclose(found.payloads["mass"].inertia, own + np.array([1.0, 1.0, 0.0]) * 10.0 / 7.0 * 0.09, rtol=1e-9)


def test_two_payloads_are_named():
    def mass(name, x, m):
        return (
            f'<body name="{name}" pos="{x} 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="{m}"/>'
            f'<site name="p{name}" pos="0 0 -.1"/></body>'
        )

    sites = {"bone": 'pos="0 0 .2"', "btwo": 'pos="1 0 .2"'}
    world = deck(sites, slides="z") + mass("one", 0, 4) + mass("two", 1, 9)
    text = mjcf(world, [("m1", "pone", "bone", "a"), ("m2", "ptwo", "btwo", "a")], gravity=G)
    found = modes(wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=1e4, c=0.0))}))
    assert found.descriptions == ("two: bounce z", "one: bounce z")
    np.testing.assert_allclose(found.frequencies, np.sqrt(1e4 / np.array([9.0, 4.0])) / (2 * np.pi), rtol=1e-7)
    np.testing.assert_allclose(found.participation[:, 2], [9 / 13, 4 / 13], rtol=1e-9)


def test_a_guided_panel_does_not_count_along_axes_in_which_it_cannot_move():
    panel = (
        '<body name="panel" pos="3 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="800"/>'
        '<site name="pp" pos="0 0 -.1"/></body>'
    )
    block = '<body name="block" pos="0 0 .3">{}<geom size=".1" mass="100"/><site name="pb" pos="0 0 -.1"/></body>'.format(
        "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 0 1"))
    )
    world = deck({"bb": 'pos="0 0 .2"', "bp": 'pos="3 0 .2"'}, slides="xyz") + block + panel
    text = mjcf(world, [("m1", "pb", "bb", "a"), ("m2", "pp", "bp", "a")], gravity=G)
    found = modes(wr.load_system(text, isolators={"a": springs(3e5, 3e5, 9e5)["a"]}))
    np.testing.assert_allclose(found.moving_mass, [100.0, 0.0, 900.0], rtol=1e-9)
    np.testing.assert_allclose(found.participation.sum(axis=0), [1.0, 0.0, 1.0], rtol=1e-9)  # of 100 kg along x, not of 900
    np.testing.assert_allclose(sorted(found.participation[:, 2])[1:], [1 / 9, 8 / 9], rtol=1e-9)


def test_a_frame_below_the_mount_takes_part():
    frame = (
        '<body name="frame" pos="0 0 .2"><joint type="slide" axis="0 0 1" stiffness="40000"/>'
        '<geom size=".05" mass="3"/><site name="b"/></body>'
    )
    mass = (
        '<body name="mass" pos="0 0 .3"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="5"/>'
        '<site name="p" pos="0 0 -.1"/></body>'
    )
    text = mjcf(deck({}, slides="z", inside=frame) + mass, [("m1", "p", "b", "a")], gravity=G)
    found = modes(wr.load_system(text, isolators={"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=2e4, c=0.0))}))
    mass_matrix, stiffness = np.diag([3.0, 5.0]), np.array([[6e4, -2e4], [-2e4, 2e4]])
    np.testing.assert_allclose(found.frequencies, frequencies_of(stiffness, mass_matrix), rtol=1e-7)
    np.testing.assert_allclose(found.participation[:, 2].sum(), 1.0, rtol=1e-9)
    assert found.descriptions[0].startswith("mass: bounce z")
    assert found.descriptions[1].startswith("frame: bounce z")
    assert set(found.payloads) == {"mass"}


def test_a_rack_on_mounts_on_a_floor_on_mounts_is_a_chain():
    laws = {name: wr.Isolator(name=name, axial=wr.KelvinVoigt(k=k, c=0.0)) for name, k in (("floor", 4e4), ("rack", 9e3))}
    found = modes(wr.load_system(rack_on_floor_text(gravity=G), isolators=laws))
    mass, stiffness = np.diag([8.0, 3.0]), np.array([[4.9e4, -9e3], [-9e3, 9e3]])
    np.testing.assert_allclose(found.frequencies, frequencies_of(stiffness, mass), rtol=1e-7)
    assert found.descriptions[0].startswith("rack: bounce z")
    np.testing.assert_allclose(found.participation[:, 2].sum(), 1.0, rtol=1e-9)


def test_a_base_that_is_the_world_needs_no_deck():
    k = (3e4, 5e4, 9e4)
    text = box_text(places=PLACES, height=0.3, gravity=0.0)
    joints = [line for line in text.split("<joint ") if 'name="deck_' in line]
    for joint in joints:
        text = text.replace("<joint " + joint.split("/>")[0] + "/>", "")
    found = modes(wr.load_system(text, isolators=springs(*k)))
    expected = frequencies_of(rigid_stiffness(PLACES, 0.3, k, np.eye(3), weight=0.0), box_mass(120.0))
    np.testing.assert_allclose(found.frequencies, expected, rtol=1e-7)
    assert found.shapes.shape == (6, 6)


def test_callbacks_of_another_thread_change_nothing():
    s = wr.load_system(box_text(places=SYMMETRIC, height=0.4), isolators=springs(6e4, 6e4, 4e4))
    alone = modes(s)
    with installed(s.model, mujoco.MjData(s.model)):
        np.testing.assert_array_equal(modes(s).frequencies, alone.frequencies)


def test_a_body_that_hangs_below_its_mounts_is_held_by_its_weight():
    k, weight = (6e4, 6e4, 4e4), 120.0 * G
    s = wr.load_system(box_text(places=SYMMETRIC, height=-0.4), isolators=springs(*k))
    found = modes(s)
    expected = rigid_stiffness(SYMMETRIC, -0.4, k, np.eye(3), weight=weight)
    np.testing.assert_allclose(found.frequencies, frequencies_of(expected, box_mass(120.0)), rtol=1e-7)
    assert np.isinf(found.stability.gravity_factor)


def test_a_viscous_mount_gives_its_damping_ratio_and_a_zener_mount_its_storage_stiffness():
    k, c, mass = 2e4, 60.0, 3.5
    found = modes(sdof(wr.KelvinVoigt(k=k, c=c), mass=mass, gravity=G))
    assert found.damping_ratio[0] == pytest.approx(c / (2.0 * np.sqrt(k * mass)), rel=1e-7)
    law = wr.Zener(k0=2e4, k1=3e4, c=200.0)
    zener = modes(sdof(law, mass=mass, gravity=G))
    omega = 2.0 * np.pi * zener.frequencies[0]
    complex_stiffness = law.k0 + law.k1 * 1j * omega / (law.k1 / law.c + 1j * omega)
    assert omega**2 * mass == pytest.approx(complex_stiffness.real, rel=1e-6)
    assert zener.damping_ratio[0] == pytest.approx(complex_stiffness.imag / (2.0 * complex_stiffness.real), rel=1e-6)


LAW = wr.AsymmetricBoucWen(alpha=1e5, beta=900.0, gamma=-200.0, n=1.3, k1=6e4, k2=1e6, k3=2e8, b=np.e, c=12.0)


@pytest.mark.parametrize("history", ["virgin", "relaxed"])
def test_small_amplitudes_see_alpha_and_the_history_its_own_tangents(history):
    """Closed forms of domain knowledge: F2 (slope of z + F1') + lambda F, with z of the history in the tangents."""
    s = sdof(LAW, mass=20.0, gravity=G)
    found = modes(s, history=history)
    x = found.equilibrium.mounts["m1"].deflection[2]
    f2, size = np.exp(12.0 * x), abs(x)
    f1, f1_slope = x * (6e4 + 1e6 * size + 2e8 * x * x), 6e4 + 2e6 * size + 6e8 * x * x
    z = 0.0 if history == "relaxed" else -20.0 * G / f2 - f1
    assert found.equilibrium.mounts["m1"].force[2] == pytest.approx(-20.0 * G, rel=1e-9)

    def frequency(slope, z):
        return np.sqrt((f2 * (slope + f1_slope) + 12.0 * f2 * (z + f1)) / 20.0) / (2 * np.pi)

    power = abs(z) ** 1.3
    assert found.frequencies[0] == pytest.approx(frequency(1e5, 0.0), rel=1e-7)
    assert found.loading[0] == pytest.approx(frequency(1e5 - 700.0 * power, z), rel=1e-7)
    assert found.unloading[0] == pytest.approx(frequency(1e5 + 1100.0 * power, z), rel=1e-7)
    if history == "virgin":
        assert found.loading[0] < 0.98 * found.frequencies[0] < 0.96 * found.unloading[0]
    assert found.damping_ratio[0] == 0.0


def test_masings_sliders_stick_in_small_cycles():
    law = wr.Masing(stiffness=[3e4, 2e4], slip_force=[20.0, 200.0], k=1e4)
    found = modes(sdof(law, mass=7.0, gravity=G))
    assert found.frequencies[0] == pytest.approx(np.sqrt(6e4 / 7.0) / (2 * np.pi), rel=1e-7)
    # Under 69 N the first slides: further loading moves the rest only.
    assert found.loading[0] == pytest.approx(np.sqrt(3e4 / 7.0) / (2 * np.pi), rel=1e-7)
    assert found.unloading[0] == pytest.approx(found.frequencies[0], rel=1e-7)


def test_what_nothing_holds_is_not_called_stable():
    iso = {"a": wr.Isolator(name="a", axial=wr.KelvinVoigt(k=1e4, c=0.0))}
    found = modes(wr.load_system(box_text(places=SYMMETRIC, height=0.0, gravity=0.0), isolators=iso))
    assert found.stability.word == "not held"
    assert (found.frequencies[:3] == 0.0).all()  # both sways and yaw


IN_LINE = {"p1": (0.5, 0.0), "p2": (-0.5, 0.0)}


@pytest.mark.parametrize(
    ("places", "words", "gone"),
    [
        ({"p1": (0.0, 0.0)}, r"a rotation about x or a rotation about y", 2),
        (IN_LINE, r"resists a rotation about x; ", 1),
    ],
)
def test_a_body_on_one_mount_or_on_two_in_line_is_said_to_tip_over(places, words, gone):
    """Its centre stands above them, and nothing else holds it: an inverted pendulum, which has no natural frequency."""
    s = wr.load_system(box_text(places=places, height=0.4), isolators=springs(6e4, 6e4, 4e4))
    with pytest.warns(wr.ModelWarning) as said:
        e = wr.equilibrium(s)
    assert [str(one.message) for one in said] == list(e.free)
    assert re.search(rf"body 'box' on 'mp1'.*{words}.*its weight tips it over", e.free[0])
    with pytest.warns(wr.ModelWarning, match="body 'box'"):
        found = modes(s)
    assert np.isfinite(found.frequencies).all()
    assert (found.frequencies[:gone] == 0.0).all()
    assert all(word.endswith("(tips over)") for word in found.descriptions[:gone])


def test_a_body_that_hangs_from_two_mounts_in_line_is_held_by_its_weight():
    s = wr.load_system(box_text(places=IN_LINE, height=-0.4), isolators=springs(6e4, 6e4, 4e4))
    assert wr.equilibrium(s).free == ()
    assert (modes(s).frequencies > 0.0).all()


def test_a_body_on_two_mounts_in_line_without_weight_is_free():
    s = wr.load_system(box_text(places=IN_LINE, height=0.4, gravity=0.0), isolators=springs(6e4, 6e4, 4e4))
    with pytest.warns(wr.ModelWarning, match=r"body 'box'.*a rotation about x; it is free"):
        found = modes(s)
    assert found.frequencies[0] == 0.0
    assert found.descriptions[0].endswith("(free)")


@pytest.mark.parametrize("amplitude", [0.0, -1e-3, np.nan, np.inf])
def test_amplitudes_that_are_none_are_refused(amplitude):
    with pytest.raises(ValueError, match=r"`amplitude` must be (> 0|a finite number)"):
        modes(sdof(LAW, gravity=G), amplitude=amplitude)


def test_histories_that_are_none_are_refused():
    with pytest.raises(ValueError, match="`history` must be"):
        modes(sdof(LAW, gravity=G), history="young")


def test_a_law_without_elastic_part_has_modes_but_no_relaxed_ones():
    s = sdof(wr.BoucWen(alpha=1e5, beta=500.0, gamma=500.0, n=1.0), mass=3.5, gravity=G)  # carries 100 N
    assert modes(s).frequencies[0] == pytest.approx(np.sqrt(1e5 / 3.5) / (2 * np.pi), rel=1e-7)
    with pytest.raises(wr.ConvergenceError, match="no relaxed equilibrium"):
        modes(s, history="relaxed")


@pytest.mark.parametrize("loss", [0.0, 4e4])  # of laws that depend on the rate the stiffness depends on the frequency
def test_natural_frequencies_are_those_of_modes(loss):
    zener = wr.Zener(k0=4e4, k1=loss, c=300.0) if loss else wr.KelvinVoigt(k=4e4, c=0.0)
    rope = wr.load_isolator("enidine_wr16_400").axes["axial"]
    isolators = {"a": wr.Isolator(name="a", roll=zener, shear=wr.KelvinVoigt(k=3e4, c=0.0), axial=rope)}
    system = wr.load_system(box_text(places=PLACES, height=0.2), isolators=isolators)
    alone, whole = natural_frequencies(system), modes(system)
    np.testing.assert_allclose(alone.frequencies, whole.frequencies, rtol=1e-12)  # rounding of the same eigenvalues
    assert alone.descriptions == whole.descriptions
