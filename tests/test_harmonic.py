"""Sine and sweep: steady from the first instant, at the right frequency, without drift."""

import math

import numpy as np
import pytest
from scipy.special import exp1

from wirerope_mj.excitation import Sine, Sweep
from wirerope_mj.excitation.sweep_integrals import oscillating_tails

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


def test_the_first_integral_is_the_exponential_integral():
    u = np.concatenate([np.geomspace(0.01, 1e5, 301), [49.999999, 50.0]])
    first, _ = oscillating_tails(u)
    # scipy's E1 of a complex argument is an implementation of its own; both claim about 1e-15 of the value, and the
    # product with the fast factor adds the roundoff of the phase, u times 1e-16.
    error = np.abs(first - exp1(-1j * u) * np.exp(-1j * u)) / np.abs(first)
    assert np.all(error < 5e-15 + 4e-16 * u)


def test_series_and_quadrature_meet():
    below, above = oscillating_tails(np.array([50 * (1 - 1e-12)])), oscillating_tails(np.array([50.0]))
    for h_below, h_above in zip(below, above, strict=True):
        # The functions themselves change by 2e-12 relative over the gap; a bad crossover is off by more.
        np.testing.assert_allclose(h_below, h_above, rtol=1e-11)


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
    sine = Sine(frequency=10.0, acceleration=9.80665, direction="x", duration=2.0)
    assert sine.description == "sine 10 Hz 1 g along x"
    assert sine.events == ((0.0, "sine of 10 Hz begins"), (2.0, "sine ends"))
