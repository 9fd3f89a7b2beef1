"""Ship motion: derivatives of its angles, order and signs of its rotations, its phrase, and what adds."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import wirerope_mj as wr
from wirerope_mj.motions.registry import motion_from_phrase
from wirerope_mj.motions.rotation import rotation_of

SHIP = wr.ShipMotion(
    roll=(0.4, 9.0), pitch=(0.2, 7.0), yaw=(0.3, 11.0), heave=(1.0, 8.0), position=(20.0, 3.0, 8.0), ramp=3.0, duration=30.0
)
STEP = 1e-5  # [s]: differences err by its square times the third derivative, 1e-10


def slope(function, times):
    return (function(times + STEP) - function(times - STEP)) / (2.0 * STEP)


def test_velocities_and_accelerations_are_derivatives_of_large_angles_and_of_the_swing():
    times = np.linspace(0.05, 31.0, 311)
    for one, other in ((SHIP.displacement, SHIP.velocity), (SHIP.velocity, SHIP.acceleration)):
        assert np.allclose(slope(one, times), other(times), rtol=0.0, atol=1e-7)
    turns = rotation_of(SHIP.angular_displacement(times))
    spin = slope(lambda t: rotation_of(SHIP.angular_displacement(t)), times) @ np.swapaxes(turns, 1, 2)
    assert np.allclose(spin[:, [2, 0, 1], [1, 2, 0]], SHIP.angular_velocity(times), rtol=0.0, atol=1e-8)
    assert np.allclose(slope(SHIP.angular_velocity, times), SHIP.angular_acceleration(times), rtol=0.0, atol=1e-8)
    for t in (0.0, SHIP.end):  # begins and ends upright at rest
        every = (SHIP.displacement, SHIP.velocity, SHIP.acceleration, SHIP.angular_displacement, SHIP.angular_velocity)
        assert all(np.abs(one([t])).max() < 1e-12 for one in every)


def test_roll_comes_first_then_pitch_then_yaw_about_axes_that_stay():
    angles = np.array([0.5, -0.3, 1.2])
    expected = Rotation.from_euler("xyz", angles).as_matrix()  # lower case: about fixed axes, in this order
    assert np.allclose(rotation_of(angles[np.newaxis])[0], expected, rtol=0.0, atol=1e-15)
    starboard, bow = np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.0, 0.0])
    assert (rotation_of(np.array([[0.1, 0.0, 0.0]]))[0] @ starboard)[2] < 0.0
    assert (rotation_of(np.array([[0.0, 0.1, 0.0]]))[0] @ bow)[2] < 0.0


def test_the_phrase_says_amplitudes_periods_and_the_place_aboard():
    motion = motion_from_phrase("ship-motion", "roll 20 deg 9 s pitch 0.1 rad 7 s heave 1 m 8 s above 10 m ramp 5 s for 40 s")
    expected = wr.ShipMotion(
        roll=(math.radians(20.0), 9.0), pitch=(0.1, 7.0), heave=(1.0, 8.0), position=(0.0, 0.0, 10.0), ramp=5.0, duration=40.0
    )
    assert motion.to_dict()["pitch"] == expected.to_dict()["pitch"]
    assert motion.roll == pytest.approx(expected.roll, rel=1e-11)  # degrees to twelve digits, as all units
    assert np.allclose(motion.acceleration([11.0]), expected.acceleration([11.0]), rtol=1e-10)
    for text, message in {
        "roll 20 deg": "a period must stand behind each of roll, got 0",
        "roll 20 m 9 s": '"m" is no unit known here',
        "above 10 m for 40 s": "one of roll, pitch, yaw",
        "roll 20 deg 9 s for 5 s": "must hold both ramps, of 9 s each",
        "roll 20 deg 0.05 s": "`roll` must have a period of 0.5 to 1000 s, got 0.05: waves move boats in 1 s",
        "heave 1 m 1 h": "`heave` must have a period of 0.5 to 1000 s, got 3600",
        "roll 95 deg 9 s": "at most 89 deg, got 95",
    }.items():
        with pytest.raises(ValueError, match=message):
            motion_from_phrase("ship-motion", text)


def test_motions_add_about_one_point_and_are_scaled_but_not_turned():
    shock = wr.HalfSine(peak=100.0, duration=0.011, direction="y", start=5.0)
    both, times = SHIP + shock, np.linspace(0.0, 12.0, 50)
    assert both.rotates
    assert np.allclose(both.velocity(times), SHIP.velocity(times) + shock.velocity(times), rtol=0.0, atol=1e-12)
    assert np.array_equal(both.angular_displacement(times), SHIP.angular_displacement(times))
    half = wr.Scaled(SHIP, 0.5)
    assert np.allclose(half.angular_displacement(times), 0.5 * SHIP.angular_displacement(times), rtol=0.0, atol=1e-15)
    with pytest.raises(ValueError, match="rotates about one point"):
        SHIP + wr.ShipMotion(roll=(0.1, 5.0))
    with pytest.raises(ValueError, match="is not turned: write it about other axes"):
        wr.Turned(SHIP, rotation=np.eye(3))
