"""Sine and sweep: steady from the first instant, at the right frequency, without drift."""

import math

import numpy as np
import pytest
from scipy.special import exp1

from wirerope_mj.motions import Sine, Sweep, motion_from_dict
from wirerope_mj.motions.sweep import oscillating_tail

THESIS = {"start": 0.1, "stop": 30.0, "rate": 2.0, "acceleration": 1.0, "direction": "z"}


def test_a_sine_oscillates_about_rest_from_the_first_instant():
    sine = Sine(frequency=5.0, acceleration=4.0, direction="y")
    omega = 2 * math.pi * 5.0
    quarter = 0.05
    np.testing.assert_allclose(sine.acceleration([0.0, quarter])[:, 1], [0.0, 4.0], atol=1e-14)
    np.testing.assert_allclose(sine.velocity([0.0, quarter])[:, 1], [-4 / omega, 0.0], atol=1e-15)
    np.testing.assert_allclose(sine.displacement([0.0, quarter])[:, 1], [0.0, -4 / omega**2], atol=1e-15)
    assert sine.duration == sine.end == math.inf
    assert sine.corners.size == 0
    assert sine.shortest_time == 0.2


def test_a_sine_that_ends_leaves_the_base_coasting():
    sine = Sine(frequency=5.0, acceleration=4.0, direction="y", duration=0.4)
    assert sine.acceleration(0.45)[0, 1] == 0.0
    coasting = -4.0 / (2 * math.pi * 5.0)  # whole periods end at the velocity of the start
    np.testing.assert_allclose(sine.velocity(9.0)[0, 1], coasting, rtol=1e-13)
    np.testing.assert_allclose(sine.displacement(1.4)[0, 1], coasting * 1.0, rtol=1e-12)
    still = Sine(frequency=5.0, acceleration=4.0, direction="y", duration=0.45)  # nine quarter periods
    assert abs(still.velocity(9.0)[0, 1]) < 1e-14


def test_the_sweep_reaches_its_frequencies_when_the_formula_says():
    sweep = Sweep(**THESIS)
    # f = 0.1 * 4^(t/60), so 30 Hz after 60 log4(300) s
    assert sweep.duration == pytest.approx(246.9, abs=0.05)
    time = np.array([0.0, 30.0, 60.0, 120.0, 240.0])
    np.testing.assert_allclose(sweep.frequency(time), 0.1 * 4.0 ** (time / 60), rtol=1e-13)
    np.testing.assert_array_equal(sweep.frequency([sweep.duration, 300.0]), [30.0, 30.0])
    down = Sweep(**{**THESIS, "start": 30.0, "stop": 0.1})
    assert down.duration == sweep.duration
    np.testing.assert_allclose(down.frequency(60.0), 30.0 / 4.0, rtol=1e-13)


def test_the_sweep_has_the_phase_of_the_formula():
    time = np.linspace(0.0, 246.0, 5000)
    phase = 2 * np.pi * 0.1 * 60 / np.log(4) * (4 ** (time / 60) - 1)
    # The phase ends near 8000 rad, whose roundoff is 1e-12; the formula here loses some more by its subtraction.
    np.testing.assert_allclose(Sweep(**THESIS).acceleration(time)[:, 2], np.sin(phase), atol=1e-10)


@pytest.mark.parametrize(("start", "stop"), [(0.1, 30.0), (30.0, 0.1)])
def test_a_long_sweep_does_not_drift(start, stop):
    sweep = Sweep(**{**THESIS, "start": start, "stop": stop})
    time = np.linspace(0.0, sweep.duration, 200_001)
    omega = 2 * np.pi * sweep.frequency(time)
    u = omega / (2 * np.log(2) / 60)
    acceleration = sweep.acceleration(time)[:, 2]
    velocity = sweep.velocity(time)[:, 2] * omega
    displacement = sweep.displacement(time)[:, 2] * omega**2
    # The envelopes are u |h1| = 1 - 3/(2 u^2) and u^2 |h2| = 1 - 13/(2 u^2) to leading order, so never above 1; a sweep
    # that starts from rest ends 1/w0 = 1.6 m/s and hundreds of metres away from that. 1e-9 is roundoff of the phase.
    assert 0.999 < np.abs(velocity).max() < 1 + 1e-9
    assert 0.999 < np.abs(displacement).max() < 1 + 1e-9
    # v = -(cos + sin/u) A/w to leading order, whose square and that of sin(phase) add up to 1 within 1/u.
    assert np.all(np.abs(velocity**2 + acceleration**2 - 1) < 1.1 / u)
    assert np.all(np.abs(displacement + acceleration) < 3.1 / u)  # x = -(sin - 3 cos/u) A/w^2


def test_a_sweep_starts_on_the_steady_oscillation():
    sweep = Sweep(start=5.0, stop=20.0, rate=1.0, acceleration=3.0, direction="x")
    omega = 2 * np.pi * 5.0
    u = omega / (np.log(2) / 60)
    assert sweep.acceleration(0.0)[0, 0] == 0.0
    assert sweep.velocity(0.0)[0, 0] == pytest.approx(-3.0 / omega, rel=3 / u**2)  # -A/w (1 - 2/u^2 + ...)
    assert abs(sweep.displacement(0.0)[0, 0]) < 4 / u * 3.0 / omega**2  # 3/u of the amplitude A/w^2


def test_after_the_sweep_the_oscillation_goes_on_without_a_jump():
    sweep = Sweep(start=2.0, stop=10.0, rate=20.0, acceleration=1.0, direction="z")
    end = sweep.duration
    for function in (sweep.acceleration, sweep.velocity, sweep.displacement):
        before, after = function([end - 1e-9, end + 1e-9])
        np.testing.assert_allclose(before, after, atol=1e-6)  # 2e-9 s times the largest rate, 63 m/s^3
    period = 0.1
    np.testing.assert_allclose(sweep.acceleration(end + 0.03), sweep.acceleration(end + 0.03 + 5 * period), atol=1e-12)
    # The drift that remains is at most 1/u of the velocity amplitude.
    omega, growth = 2 * np.pi * 10.0, 20 * np.log(2) / 60
    drift = sweep.displacement(end + 0.03 + 5 * period) - sweep.displacement(end + 0.03)
    assert np.abs(drift / (5 * period)).max() < growth / omega / omega


LEVELS = {"acceleration": 3.0, "velocity": 0.05, "displacement": 1e-3}
COURSES = {"up": (2.0, 11.0), "down": (11.0, 2.0)}
every_level = pytest.mark.parametrize("quantity", LEVELS)
every_course = pytest.mark.parametrize("course", COURSES)


def levelled(quantity, course="up", rate=30.0, **more):
    start, stop = COURSES[course]
    return Sweep(start=start, stop=stop, rate=rate, direction="z", **{quantity: LEVELS[quantity]}, **more)


def derivative(function, time, h=1e-4):
    """Differences of sixth order: h^6 w^6 / 140 is 1e-15 of the value for the 11 Hz that occur here."""
    shifts, weights = np.array([-3, -2, -1, 1, 2, 3]), np.array([-1, 9, -45, 45, -9, 1]) / 60
    return sum(weight * function(time + shift * h)[:, 2] for shift, weight in zip(shifts, weights, strict=True)) / h


@every_level
@every_course
def test_velocity_and_acceleration_are_the_derivatives_whatever_is_constant(quantity, course):
    sweep = levelled(quantity, course)
    end = sweep.duration
    time = np.concatenate([np.linspace(0.01, end - 0.01, 2000), np.linspace(end + 0.01, end + 1.0, 200)])
    # Roundoff of the differences: 1e-16 of the largest value over 1e-4 s, that is 1e-12 times the ratio of the largest
    # to the typical derivative; a term of 1/u that is missing or has the wrong sign is 1e-3 to 1e-2 here.
    for upper, lower in ((sweep.velocity, sweep.displacement), (sweep.acceleration, sweep.velocity)):
        value = upper(time)[:, 2]
        assert np.abs(derivative(lower, time) - value).max() < 1e-9 * np.abs(value).max()


@every_level
@every_course
def test_the_amplitude_is_constant_in_what_the_sweep_says(quantity, course):
    sweep = levelled(quantity, course)
    time = np.linspace(0.0, sweep.duration, 400_001)
    values = getattr(sweep, quantity)(time)[:, 2]
    cycles = np.floor(np.abs(sweep.course.phase(time)) / (2 * np.pi)).astype(int)
    highest = np.array([np.abs(values[cycles == cycle]).max() for cycle in range(cycles[-1])])
    # 400 000 instants over some 40 cycles per second at most: the crest is met within 3e-4 rad, whose square is 1e-7.
    np.testing.assert_allclose(highest, LEVELS[quantity], rtol=1e-6)
    assert np.abs(values).max() <= LEVELS[quantity] * (1 + 1e-12)


@every_level
@every_course
def test_no_sweep_drifts_over_hours(quantity, course):
    sweep = levelled(quantity, course, rate=0.05)
    assert sweep.duration > 2900.0
    time = np.linspace(0.0, sweep.duration, 300_001)
    omega = 2 * np.pi * sweep.frequency(time)
    power = {"acceleration": 0, "velocity": 1, "displacement": 2}[quantity]
    steady = LEVELS[quantity] * omega**power  # acceleration amplitude of the steady sine of that frequency
    phase = sweep.course.phase(time)
    u = omega / sweep.course.growth  # at least 2e4: what differs from the steady sine is at most 3/u of it
    for function, shape in (
        (sweep.acceleration, steady * np.sin(phase)),
        (sweep.velocity, -steady / omega * np.cos(phase)),
        (sweep.displacement, -steady / omega**2 * np.sin(phase)),
    ):
        envelope = steady / omega ** [sweep.acceleration, sweep.velocity, sweep.displacement].index(function)
        assert np.all(np.abs(function(time)[:, 2] - shape) < 3.1 / u * envelope)


@every_level
@every_course
def test_a_sweep_ends_without_a_jump_whatever_is_constant(quantity, course):
    sweep = levelled(quantity, course)
    end = np.array([sweep.duration - 1e-9, sweep.duration + 1e-9])
    omega = 2 * np.pi * 11.0
    for order, function in enumerate((sweep.displacement, sweep.velocity)):
        before, after = function(end)[:, 2]
        # 2e-9 s times the rate of change, which is the amplitude times w: 1.4e-7 of it.
        assert abs(after - before) < 1e-6 * LEVELS[quantity] * omega ** (order + 1)
    long = sweep.duration + 1000.0 / sweep.stop
    steady = np.array([sweep.duration + 0.1 / sweep.stop, long + 0.1 / sweep.stop])
    first, last = sweep.displacement(steady)[:, 2]
    u = 2 * np.pi * sweep.stop / sweep.course.growth
    drift = 0.0 if quantity != "acceleration" else LEVELS[quantity] / (2 * np.pi * sweep.stop) / u * (steady[1] - steady[0])
    assert abs(last - first) <= drift + 1e-9 * LEVELS[quantity]


@every_level
def test_the_level_survives_being_stored(quantity):
    sweep = levelled(quantity)
    stored = sweep.to_dict()
    assert stored[quantity] == LEVELS[quantity]
    assert not ({*LEVELS} - {quantity}) & set(stored)
    again = motion_from_dict(stored)
    assert again == sweep
    time = np.linspace(0.0, sweep.duration, 101)
    assert again.displacement(time).tobytes() == sweep.displacement(time).tobytes()


@every_course
def test_whole_cycles_begin_where_the_phase_has_turned_around(course):
    sweep = levelled("velocity", course)
    instants = sweep.course.whole_cycles()
    turns = np.abs(sweep.course.phase(instants)) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.arange(turns.size), atol=1e-10)  # phases near 2000 rad
    rest = np.abs(sweep.course.phase(np.array([sweep.duration]))[0]) / (2 * np.pi) - turns[-1]
    assert 0.0 <= rest < 1.0


@pytest.mark.parametrize(
    ("levels", "got"),
    [({}, "none"), ({"acceleration": 1.0, "velocity": 1.0}, "`acceleration` and `velocity`")],
)
def test_exactly_one_level_is_given(levels, got):
    message = f"exactly one of `acceleration`, `velocity` and `displacement` must be given, got {got}"
    with pytest.raises(ValueError, match=message):
        Sweep(start=1.0, stop=2.0, rate=1.0, direction="z", **levels)
    with pytest.raises(ValueError, match="`displacement` must not be zero"):
        Sweep(start=1.0, stop=2.0, rate=1.0, direction="z", displacement=0.0)


def test_the_first_integral_is_the_exponential_integral():
    u = np.concatenate([np.geomspace(0.01, 1e5, 301), [49.999999, 50.0]])
    first = oscillating_tail(u, 1)
    # scipy's E1 of a complex argument is an implementation of its own; both claim about 1e-15 of the value, and the
    # product with the fast factor adds the roundoff of the phase, u times 1e-16.
    error = np.abs(first - exp1(-1j * u) * np.exp(-1j * u)) / np.abs(first)
    assert np.all(error < 5e-15 + 4e-16 * u)


@pytest.mark.parametrize("order", [1, 2])
def test_series_and_quadrature_meet(order):
    below, above = (oscillating_tail(np.array([u]), order) for u in (50 * (1 - 1e-12), 50.0))
    # The functions themselves change by 2e-12 relative over the gap; a bad crossover is off by more.
    np.testing.assert_allclose(below, above, rtol=1e-11)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"stop": 0.1}, "`stop` must differ from `start`, got 0.1 Hz for both"),
        ({"start": 0.0}, "`start` must be > 0, got 0.0"),
        ({"stop": -1.0}, "`stop` must be > 0, got -1.0"),
        ({"rate": 0.0}, "`rate` must be > 0, got 0.0"),
        ({"acceleration": 0.0}, "`acceleration` must not be zero"),
    ],
)
def test_arguments_out_of_range_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Sweep(**{**THESIS, **arguments})


def test_a_sine_without_frequency_is_refused():
    with pytest.raises(ValueError, match="`frequency` must be > 0, got 0.0"):
        Sine(frequency=0.0, acceleration=1.0, direction="z")
    with pytest.raises(ValueError, match="`duration` must be > 0, got -1.0"):
        Sine(frequency=1.0, acceleration=1.0, direction="z", duration=-1.0)


def test_descriptions_and_events_are_for_people():
    sweep = Sweep(**{**THESIS, "acceleration": 0.980665})
    assert sweep.description == "sweep 0.1 to 30 Hz, 2 octaves/min, 0.1 g along z"
    assert sweep.events == ((0.0, "sweep begins at 0.1 Hz"), (sweep.duration, "sweep reaches 30 Hz"))
    ends = {"velocity": "50 mm/s along z", "displacement": "1 mm along z"}
    for quantity, end in ends.items():
        assert levelled(quantity).description == f"sweep 2 to 11 Hz, 30 octaves/min, {end}"
    sine = Sine(frequency=10.0, acceleration=9.80665, direction="x", duration=2.0)
    assert sine.description == "sine 10 Hz 1 g along x"
    assert sine.events == ((0.0, "sine of 10 Hz begins"), (2.0, "sine ends"))
