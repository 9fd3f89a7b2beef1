"""A motion that repeats itself after four periods of the base only, where a pair of multipliers leaves the unit circle."""

from fractions import Fraction

import numpy as np
import pytest
from house import sdof

import wirerope_mj as wr
from wirerope_mj.dynamics.periodic import harmonic_content

# A lightly damped, strongly hardening mount, far below its resonance: the second superharmonic resonance.
LAW = wr.SymmetricBoucWen(alpha=0.3, beta=0.15, gamma=0.15, n=1.0, k1=0.2, k2=0.0, k3=0.5)
FREQUENCY, LEVEL = 0.1303, 4.0


@pytest.fixture(scope="module")
def system():
    return sdof(LAW, mass=1.0)


@pytest.fixture(scope="module")
def once(system):
    return wr.periodic_orbit(system, frequency=FREQUENCY, acceleration=LEVEL, direction="z", accuracy=1e-5)


@pytest.fixture(scope="module")
def subharmonic(system, once):
    """What is left after 400 periods: started on the unstable motion, rounding alone drives the system away from it."""
    settled = wr.simulate(
        system, once.motion, duration=400.0 / FREQUENCY, initial=once.state, timestep=1.0 / (256 * FREQUENCY),
        sample_rate=10.0 * FREQUENCY,
    )  # fmt: skip
    guess = wr.State(values=settled.final_state.values, time=0.0)
    return wr.periodic_orbit(
        system, frequency=FREQUENCY, acceleration=LEVEL, direction="z", periods=4, guess=guess, accuracy=1e-5
    )


def test_a_pair_of_multipliers_stands_outside_the_unit_circle_near_its_fourth_roots(once):
    pair = once.floquet_multipliers[:2]
    assert not once.stable
    assert np.abs(pair) == pytest.approx([1.0966, 1.0966], abs=1e-3)  # 1.09679 with 1280 steps per period
    assert np.degrees(np.abs(np.angle(pair))) == pytest.approx([88.4, 88.4], abs=0.1)
    # The volume shrinks over every period all the same: the third multiplier pays for the pair.
    assert np.prod(once.floquet_multipliers).real < 1.0


def test_the_system_settles_on_a_stable_subharmonic_of_order_one_fourth(subharmonic, once):
    content = harmonic_content(subharmonic, payload="mass", highest=4)
    assert subharmonic.stable
    assert "settling" not in subharmonic.message
    assert content.of(Fraction(9, 4)) > 0.5 * content.of(1)  # the free motion, locked to nine fourths of the base's frequency
    assert content.of(Fraction(1, 4)) > 3e-3 * content.of(1)
    assert {"subharmonic 1/4", "ultrasubharmonic 9/4"} < set(content.names)
    alone = harmonic_content(once, payload="mass", highest=4)
    assert alone.of(Fraction(9, 4)) == 0.0
    assert np.hypot(alone.of(2), alone.of(3)) > 0.5 * alone.of(1)  # superharmonics of a hardening mount


def test_the_circle_is_left_and_entered_again_along_the_branch(system, once):
    branch = wr.follow_branch(
        system, start=FREQUENCY, stop=0.098, acceleration=LEVEL, direction="z", payload="mass", guess=once.state
    )
    (event,) = branch.bifurcations
    assert event.kind == "Neimark-Sacker"
    assert (event.before, event.after) == (2, 0)
    # 0.09968 Hz with steps for 1e-6; 128 steps move the multiplier by 4e-4, and with it the crossing by 2e-4
    assert event.frequency == pytest.approx(0.0997, abs=3e-4)
    assert "stability is regained" in event.description
