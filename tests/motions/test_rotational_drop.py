"""The rotational edge drop: the pendulum of a rigid box about its edge, and what stands on it as it lands."""

import math

import numpy as np
import pytest
from rolling_boxes import boxed, integrated
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import wirerope_mj as wr
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions.registry import motion_from_phrase

LENGTH, HEIGHT, RAISED, BELOW = 0.8, 0.6, 0.3, 0.05


def drop(**changes):
    values = {"drop_height": RAISED, "raised": "-x", "length": LENGTH, "height": HEIGHT, "below": BELOW} | changes
    return wr.RotationalDrop(**values)


def test_the_case_falls_as_a_box_about_its_edge_does():
    motion = drop()
    inertia = (LENGTH**2 + HEIGHT**2) / 3.0  # about the edge, of unit mass
    lever = lambda a: 0.5 * (LENGTH * math.cos(a) - HEIGHT * math.sin(a))  # noqa: E731  of the weight

    def landed(t, y):
        return y[0]

    landed.terminal = True  # type: ignore[attr-defined]
    start = [math.asin(RAISED / LENGTH), 0.0]
    fall = solve_ivp(
        lambda t, y: [y[1], -STANDARD_GRAVITY * lever(y[0]) / inertia], (3.0, 5.0), start, events=landed, rtol=1e-12,
        atol=1e-13, dense_output=True,
    )  # fmt: skip
    assert motion.end == pytest.approx(fall.t[-1], abs=1e-11)
    assert motion.landing_rate == pytest.approx(-fall.y[1, -1], rel=1e-11)
    times = np.linspace(3.0, motion.end - 1e-6, 50)
    assert np.allclose(motion.angular_displacement(times)[:, 1], fall.sol(times)[0], rtol=0.0, atol=1e-11)
    lost = 0.5 * RAISED * 1.0 + 0.5 * HEIGHT * (math.cos(start[0]) - 1.0)  # height that the box's centre loses
    assert 0.5 * inertia * motion.landing_rate**2 == pytest.approx(STANDARD_GRAVITY * lost, rel=1e-12)


@pytest.mark.parametrize(("raised", "stays"), [("-x", (0.4, 0)), ("+x", (-0.4, 0)), ("-y", (0, 0.4)), ("+y", (0, -0.4))])
def test_one_edge_stays_and_the_opposite_one_is_raised(raised, stays):
    motion = drop(raised=raised)
    edge, other = np.array([*stays, -BELOW]), np.array([-stays[0], -stays[1], -BELOW])
    for t in (0.0, 1.3, 2.7, 3.2, motion.end, motion.end + 1.0):
        roll, pitch, yaw = motion.angular_displacement([t])[0]
        c, s = np.cos([roll, pitch]), np.sin([roll, pitch])
        turn = np.array([[c[1], s[1] * s[0], s[1] * c[0]], [0.0, c[0], -s[0]], [-s[1], c[1] * s[0], c[1] * c[0]]])
        assert yaw == 0.0
        origin = motion.displacement([t])[0]
        assert np.allclose(origin + turn @ edge, edge, rtol=0.0, atol=1e-15)
        if t == 2.7:  # held
            assert (origin + turn @ other)[2] + BELOW == pytest.approx(RAISED, abs=1e-12)
    ((instant, jump),) = motion.velocity_jumps
    assert instant == motion.end
    assert np.allclose(jump, -motion.velocity([motion.end - 1e-9])[0], rtol=0.0, atol=1e-7)


@pytest.mark.slow
def test_a_box_on_mounts_is_thrown_as_an_integration_of_its_own_has_it():
    motion = drop()
    response = wr.simulate(boxed(), motion, duration=motion.end + 0.3, timestep=2.5e-4, sample_rate=400.0)
    assert response.numerics.engine == "kernel"
    box, time = response.bodies["box"], response.time
    begin = int(np.searchsorted(time, 3.1))  # in the fall
    start = (*box.position[begin], *box.velocity[begin], *np.roll(box.orientation[begin], -1))
    turn = Rotation.from_quat(np.roll(box.orientation[begin], -1))
    start = (*start, *turn.inv().apply(box.angular_velocity[begin]))
    before = tuple(t for t in time[begin:] if t < motion.end)
    y, _ = integrated(motion, (*before, motion.end - 1e-9), start)
    after = tuple(t for t in time if t > motion.end)
    z, acceleration = integrated(motion, (motion.end, *after), tuple(y[-1]))
    n = len(time) - len(after)
    expected = np.concatenate([y[:-1, :3], z[1:, :3]])
    assert np.abs(box.position[begin:] - expected).max() < 1e-6  # [m], of a fall of 0.3 m
    got = box.acceleration[n:]
    assert np.abs(got - acceleration[1:]).max() < 1e-5 * np.abs(got).max()  # the landing is known to 1e-9 s here
    deck = response.bodies["deck"]
    assert np.abs(deck.velocity[n:]).max() < 1e-12
    assert np.abs(deck.angular_velocity[n:]).max() < 1e-12


def test_phrases_say_the_case_and_what_no_case_can_do_is_refused():
    motion = motion_from_phrase("rotational-drop", "300 mm -x length 800 mm height 600 mm below 50 mm")
    assert motion.to_dict() == drop().to_dict()
    for text, message in {
        "300 mm length 800 mm height 600 mm": "one side that is raised",
        "300 mm -x length 800 mm": '"height" and its value',
        "700 mm -x length 800 mm height 600 mm": "topples over the other way",
        "-300 mm -x length 800 mm height 600 mm": "`drop_height` must be > 0",
    }.items():
        with pytest.raises(ValueError, match=message):
            motion_from_phrase("rotational-drop", text)
