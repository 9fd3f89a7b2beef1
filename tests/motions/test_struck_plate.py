"""Plates struck by an underwater shock wave, against an integration of Taylor's equation and its closed forms."""

import math

import numpy as np
import pytest
import scipy

import wirerope_mj as wr

pytestmark = pytest.mark.quick

WATER = 1025.0 * 1500.0


def plate_of(psi, **changed):
    return wr.StruckPlate(**{"pressure": 14e6, "decay": 0.9e-3, "areal_mass": WATER * 0.9e-3 / psi, "direction": "z"} | changed)


@pytest.mark.parametrize("psi", [0.1, 0.7, 1.0, 4.3, 30.0])
def test_the_kick_is_that_of_taylors_equation_until_the_water_lets_go(psi):
    plate = plate_of(psi, start=0.002)

    def rates(t, state):
        return [state[1], (2.0 * plate.pressure * math.exp(-t / plate.decay) - WATER * state[1]) / plate.areal_mass]

    def in_tension(t, state):
        return rates(t, state)[1]

    in_tension.terminal, in_tension.direction = True, -1
    kick = scipy.integrate.solve_ivp(rates, (0.0, 0.1), (0.0, 0.0), events=in_tension, rtol=1e-11, atol=1e-14, method="DOP853")
    lets_go, (moved, velocity) = kick.t_events[0][0], kick.y_events[0][0]
    assert plate.duration == pytest.approx(lets_go, rel=1e-8)
    assert plate.velocity_change == pytest.approx(velocity, rel=1e-9)
    after = plate.displacement([plate.end + 0.1])[0, 2]
    assert after == pytest.approx(moved + 0.1 * velocity, rel=1e-9)


def test_the_largest_velocity_is_the_closed_form():
    plate = plate_of(4.3)
    assert plate.velocity_change == pytest.approx(2.0 * 14e6 / WATER * 4.3 ** (1.0 / (1.0 - 4.3)), rel=1e-12)


def test_a_heavy_plate_takes_twice_the_impulse_of_the_wave():
    plate = plate_of(1e-5)
    assert plate.areal_mass * plate.velocity_change == pytest.approx(2.0 * 14e6 * 0.9e-3, rel=2e-4)


def test_acceleration_ends_where_the_water_lets_go():
    plate = plate_of(4.3)
    assert plate.acceleration([0.0])[0, 2] == pytest.approx(2.0 * 14e6 / plate.areal_mass)
    assert plate.acceleration([0.999999 * plate.duration])[0, 2] == pytest.approx(0.0, abs=1e-4 * 14e6 / plate.areal_mass)
    assert not np.any(plate.acceleration([1.001 * plate.duration]))


@pytest.mark.parametrize(
    ("changed", "said"),
    [({"pressure": 0.0}, "pressure"), ({"decay": -1.0}, "decay"), ({"areal_mass": 0.0}, "areal_mass"),
     ({"impedance": math.nan}, "impedance"), ({"direction": "w"}, "direction")],
)  # fmt: skip
def test_a_plate_that_cannot_be_is_refused(changed, said):
    with pytest.raises(ValueError, match=f"`{said}`"):
        plate_of(2.0, **changed)
