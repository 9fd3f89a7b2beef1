"""The struck deck: the oscillator's own equation, its blow, and that it comes to rest by itself."""

import math

import numpy as np
import pytest

from wirerope_mj.motions import DecayingSine

pytestmark = pytest.mark.quick

OMEGA = 2 * math.pi * 14.0


@pytest.mark.parametrize("impact_duration", [0.0, 0.002, 0.5 / 14.0, 0.2])
@pytest.mark.parametrize("damping", [0.01, 0.05, 0.7])
def test_the_deck_obeys_its_equation_of_motion(damping, impact_duration):
    deck = DecayingSine(frequency=14.0, damping=damping, velocity=2.0, direction="z", impact_duration=impact_duration)
    t = np.linspace(0.0, 0.5, 4001)
    a, v, x = (function(t)[:, 2] for function in (deck.acceleration, deck.velocity, deck.displacement))
    blow = np.zeros_like(t)
    if impact_duration:  # a half-sine whose area is the velocity
        blow = math.pi * 2.0 / (2 * impact_duration) * np.sin(math.pi * t / impact_duration) * (t < impact_duration)
    # Terms of the size w V = 176 m/s^2, ten times that during the shortest blow; 1e-11 is their roundoff with room for
    # the cancellation between forced and free oscillation, which grows as 1/damping.
    np.testing.assert_allclose(a + 2 * damping * OMEGA * v + OMEGA**2 * x, blow, rtol=0, atol=1e-9)


def test_an_instant_blow_makes_the_velocity_jump_from_rest():
    deck = DecayingSine(frequency=14.0, damping=0.05, velocity=2.0, direction="x", start=0.3)
    ((instant, jump),) = deck.velocity_jumps
    assert instant == 0.3
    np.testing.assert_allclose(jump, [2.0, 0.0, 0.0], rtol=1e-15)
    before, after = deck.velocity([0.3 - 1e-9, 0.3])[:, 0]
    assert before == 0.0
    assert after == pytest.approx(2.0, rel=1e-14)
    assert deck.displacement(0.3)[0, 0] == 0.0


def test_the_oscillation_decays_by_the_logarithmic_decrement():
    deck = DecayingSine(frequency=14.0, damping=0.05, velocity=2.0, direction="z")
    period = 1 / (14.0 * math.sqrt(1 - 0.05**2))
    first, second = deck.displacement([0.01, 0.01 + period])[:, 2]
    assert second / first == pytest.approx(math.exp(-2 * math.pi * 0.05 / math.sqrt(1 - 0.05**2)), rel=1e-12)


@pytest.mark.parametrize("impact_duration", [0.0, 0.01])
def test_the_deck_comes_to_rest_where_it_was(impact_duration):
    deck = DecayingSine(frequency=14.0, damping=0.05, velocity=2.0, direction="z", impact_duration=impact_duration)
    time = np.linspace(deck.end, deck.end + 1.0, 2001)
    assert np.abs(deck.velocity(time)).max() <= 2.0e-3  # a thousandth at `end`
    assert np.abs(deck.displacement(deck.end + 10.0)).max() < 1e-20
    assert np.abs(deck.velocity(deck.end + 10.0)).max() < 1e-18


def test_a_short_blow_is_an_instant_one():
    instant = DecayingSine(frequency=14.0, damping=0.05, velocity=2.0, direction="z")
    short = DecayingSine(frequency=14.0, damping=0.05, velocity=2.0, direction="z", impact_duration=1e-5)
    time = np.linspace(0.001, 0.5, 500)
    # Half its length later: what the velocity changes in 5e-6 s is 5e-6 w of it, and the rest is quadratic.
    np.testing.assert_allclose(short.velocity(time + 0.5e-5), instant.velocity(time), rtol=0, atol=2.0 * (1e-5 * OMEGA) ** 2)


@pytest.mark.parametrize("impact_duration", [0.0, 0.02])
def test_an_acceleration_level_is_the_envelope_at_the_start(impact_duration):
    level = 120.0
    deck = DecayingSine(frequency=14.0, damping=0.05, acceleration=level, direction="z", impact_duration=impact_duration)
    time = np.linspace(0.05, 0.5, 200_001)  # free oscillation; its crests are met within 2e-4 rad, 2e-8 of the value
    crests = np.abs(deck.acceleration(time)[:, 2]) * np.exp(0.05 * OMEGA * time)
    assert crests.max() == pytest.approx(level, rel=1e-7)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"damping": 0.0}, "`damping` must lie above 0 and below 1"),
        ({"damping": 1.0}, "`damping` must lie above 0 and below 1"),
        ({"frequency": -1.0}, "`frequency` must be > 0"),
        ({"velocity": None}, "exactly one of `velocity` and `acceleration` must be given, got none"),
        ({"acceleration": 1.0}, "got `velocity` and `acceleration`"),
        ({"impact_duration": -0.1}, "`impact_duration` must be >= 0, got -0.1"),
    ],
)
def test_arguments_out_of_range_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        DecayingSine(**{"frequency": 14.0, "damping": 0.05, "velocity": 1.0, "direction": "z", **change})


def test_descriptions_and_events_are_for_people():
    deck = DecayingSine(frequency=14.0, damping=0.05, velocity=2.0, direction="z", impact_duration=0.005, start=0.1)
    assert deck.description == "deck of 14 Hz, damping 0.05, struck to 2 m/s in 5 ms along z at 0.1 s"
    assert deck.events[0] == (0.1, "deck of 14 Hz is struck")
    assert deck.shortest_time == 0.005
