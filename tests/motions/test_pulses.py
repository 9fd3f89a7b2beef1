"""Pulses against the closed forms and tables of the shock standards."""

import numpy as np
import pytest

from wirerope_mj.motions import HalfSine, Sawtooth, Trapezoid, VelocityStep

pytestmark = pytest.mark.quick

G = 9.80665


@pytest.mark.parametrize(
    ("pulse", "velocity_change"),
    [
        # Tabulated severities with the velocity change as printed in such tables; the last digit is rounded.
        (HalfSine(peak=15 * G, duration=0.011, direction="z"), 1.030),
        (HalfSine(peak=20 * G, duration=0.011, direction="z"), 1.3735),
        (HalfSine(peak=30 * G, duration=0.011, direction="z"), 2.060),
        (HalfSine(peak=50 * G, duration=0.011, direction="z"), 3.434),
        (HalfSine(peak=75 * G, duration=0.006, direction="z"), 2.809),
        (Sawtooth(peak=20 * G, duration=0.011, direction="z"), 1.0787),
        (Sawtooth(peak=40 * G, duration=0.011, direction="z"), 2.157),
        (Trapezoid(peak=50 * G, duration=0.011, rise=0.0011, direction="z"), 0.9 * 50 * G * 0.011),
    ],
)
def test_velocity_change_is_that_of_the_tables(pulse, velocity_change):
    assert pulse.velocity(1.0)[0, 2] == pytest.approx(velocity_change, abs=5e-4)
    assert pulse.velocity_change == pytest.approx(pulse.velocity(1.0)[0, 2], rel=1e-14)


def test_a_half_sine_is_half_a_sine():
    pulse = HalfSine(peak=8.0, duration=0.02, direction="x", start=0.5)
    acceleration = pulse.acceleration([0.49, 0.5, 0.5 + 0.02 / 6, 0.51, 0.515, 0.53])[:, 0]
    np.testing.assert_allclose(acceleration, [0, 0, 4, 8, 8 * np.sqrt(0.5), 0], atol=1e-12)


def test_a_half_sine_moves_the_base_by_half_its_velocity_change_times_its_length():
    pulse = HalfSine(peak=8.0, duration=0.02, direction="x")
    assert pulse.displacement(0.02)[0, 0] == pytest.approx(2 * 8.0 * 0.02 / np.pi * 0.02 / 2, rel=1e-14)


def test_the_start_of_a_half_sine_has_no_cancellation():
    pulse = HalfSine(peak=8.0, duration=0.02, direction="x")
    t = 1e-8  # a = A pi t / D to 1 part in 1e12 here, so v = A pi t^2 / 2 D
    assert pulse.velocity(t)[0, 0] == pytest.approx(8.0 * np.pi * t**2 / 0.04, rel=1e-11)


def test_a_sawtooth_ends_at_its_peak():
    pulse = Sawtooth(peak=-8.0, duration=0.02, direction="z", start=0.1)
    np.testing.assert_allclose(pulse.acceleration([0.1, 0.105, 0.12 - 1e-12])[:, 2], [0, -2, -8], rtol=1e-9)
    assert pulse.acceleration(pulse.end)[0, 2] == 0.0
    # A t^3 / 6 D at the end
    assert pulse.displacement(pulse.end)[0, 2] == pytest.approx(-8.0 * 0.02**2 / 6, rel=1e-12)
    np.testing.assert_array_equal(pulse.corners, [0.1, pulse.end])


def test_a_trapezoid_rises_holds_and_falls():
    pulse = Trapezoid(peak=10.0, duration=0.01, rise=0.002, direction="z")
    acceleration = pulse.acceleration([0.001, 0.002, 0.005, 0.008, 0.009, 0.01])[:, 2]
    np.testing.assert_allclose(acceleration, [5, 10, 10, 10, 5, 0], atol=1e-12)
    np.testing.assert_allclose(pulse.corners, [0.0, 0.002, 0.008, 0.01], rtol=1e-15)


def test_a_trapezoid_without_rise_is_a_rectangle():
    pulse = Trapezoid(peak=10.0, duration=0.01, rise=0.0, direction="z", start=0.03)
    np.testing.assert_array_equal(pulse.acceleration([0.03 - 1e-9, 0.03, 0.035, pulse.end])[:, 2], [0, 10, 10, 0])
    np.testing.assert_array_equal(pulse.corners, [0.03, 0.04])


@pytest.mark.parametrize("start", [0.0, -0.3, 0.1, 7.7, 1 / 3])
@pytest.mark.parametrize("shape", [HalfSine, Sawtooth])
def test_a_pulse_is_over_at_its_end_wherever_it_starts(shape, start):
    pulse = shape(peak=10.0, duration=0.011, direction="z", start=start)
    np.testing.assert_array_equal(pulse.acceleration(pulse.corners[-1]), [[0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(pulse.velocity(start), [[0.0, 0.0, 0.0]])
    # After the end the base coasts.
    velocity = pulse.velocity(pulse.end + 2.0)[0, 2]
    coasted = pulse.displacement(pulse.end + 2.0) - pulse.displacement(pulse.end)
    assert coasted[0, 2] == pytest.approx(2.0 * velocity, rel=1e-12)


def test_a_velocity_step_is_a_jump_and_no_acceleration():
    step = VelocityStep(velocity=-2.0, direction=(1.0, 0.0, 1.0), start=0.5)
    share = -2.0 * np.sqrt(0.5)
    np.testing.assert_array_equal(step.acceleration([0.0, 0.5, 1.0]), np.zeros((3, 3)))
    np.testing.assert_allclose(step.velocity([0.4999, 0.5])[:, 0], [0.0, share], rtol=1e-15)
    np.testing.assert_allclose(step.displacement([0.5, 1.5])[:, 2], [0.0, share], rtol=1e-15)
    ((time, jump),) = step.velocity_jumps
    assert time == 0.5
    np.testing.assert_allclose(jump, [share, 0.0, share], rtol=1e-15)
    assert step.duration == 0.0
    assert step.end == 0.5


def test_descriptions_and_events_are_for_people():
    pulse = HalfSine(peak=15 * G, duration=0.011, direction="z")
    assert pulse.description == "half-sine 15 g 11 ms along z"
    assert pulse.events == ((0.0, "half-sine begins"), (0.011, "half-sine ends"))
    late = Sawtooth(peak=-G, duration=0.011, direction=(1, 1, 0), start=0.25)
    assert late.description == "sawtooth -1 g 11 ms along (1, 1, 0) at 0.25 s"
    assert VelocityStep(velocity=2.0, direction="x").description == "velocity step 2 m/s along x"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"peak": 0.0}, "`peak` must not be zero"),
        ({"peak": float("nan")}, "`peak` must be a finite number, got nan"),
        ({"peak": "15"}, "`peak` must be a finite number, got '15'"),
        ({"peak": None}, "`peak` must be a finite number, got None"),
        ({"duration": 0.0}, "`duration` must be > 0, got 0.0"),
        ({"duration": -1}, "`duration` must be > 0, got -1.0"),
        ({"start": float("inf")}, "`start` must be a finite number, got inf"),
        ({"rise": 0.006}, "`rise` must lie between 0 and half the duration, 0.005 s, got 0.006"),
        ({"rise": -0.001}, "`rise` must lie between 0 and half the duration"),
    ],
)
def test_arguments_out_of_range_are_refused(arguments, message):
    good = {"peak": 1.0, "duration": 0.01, "rise": 0.001, "direction": "z"}
    with pytest.raises(ValueError, match=message):
        Trapezoid(**{**good, **arguments})


def test_a_velocity_step_of_nothing_is_refused():
    with pytest.raises(ValueError, match="`velocity` must not be zero"):
        VelocityStep(velocity=0.0, direction="z")
