"""The drop table: velocity change of fall and rebound, at once, on a programmer, and after the fall itself."""

import math

import numpy as np
import pytest

from wirerope_mj.motions import ShockTableImpact

pytestmark = pytest.mark.quick

G = 9.80665
V = math.sqrt(2 * G * 0.5)  # 3.1316 m/s


@pytest.mark.parametrize("rebound", [0.0, 0.25, 1.0])
@pytest.mark.parametrize("pulse_duration", [None, 0.006])
def test_the_velocity_change_is_that_of_the_fall_and_the_rebound(rebound, pulse_duration):
    table = ShockTableImpact(drop_height=0.5, rebound=rebound, pulse_duration=pulse_duration, start=0.1)
    assert table.impact_velocity == pytest.approx(V, rel=1e-15)
    before, after = table.velocity([0.1 - 1e-9, table.end])[:, 2]
    assert before == 0.0
    assert after == pytest.approx(V * (1 + rebound), rel=1e-14) == table.velocity_change


def test_the_programmer_makes_a_half_sine_of_that_velocity_change():
    table = ShockTableImpact(drop_height=0.5, rebound=0.25, pulse_duration=0.006, direction="x")
    # The area of a half-sine is 2 A D/pi.
    assert table.peak == pytest.approx(math.pi * 1.25 * V / (2 * 0.006), rel=1e-14)
    np.testing.assert_allclose(table.acceleration([0.001, 0.003])[:, 0], [table.peak / 2, table.peak], rtol=1e-12)
    assert table.velocity_jumps == ()


def test_without_a_programmer_the_velocity_jumps():
    table = ShockTableImpact(drop_height=0.5, rebound=0.25, direction=(0, 0, -2))
    ((instant, jump),) = table.velocity_jumps
    assert instant == 0.0
    np.testing.assert_allclose(jump, [0.0, 0.0, -1.25 * V], rtol=1e-15)
    assert table.peak == table.shortest_time == math.inf


@pytest.mark.parametrize("pulse_duration", [None, 0.006])
def test_the_fall_is_weightless_and_ends_at_the_height_and_the_velocity(pulse_duration):
    table = ShockTableImpact(drop_height=0.5, rebound=0.25, pulse_duration=pulse_duration, start=0.1, fall=True)
    assert table.impact == pytest.approx(0.1 + math.sqrt(2 * 0.5 / G), rel=1e-14)
    falling = np.linspace(0.1, table.impact - 1e-9, 50)
    np.testing.assert_array_equal(table.acceleration(falling)[:, 2], -G)  # what gravity alone would do
    np.testing.assert_allclose(table.displacement(table.impact)[0, 2], -0.5, rtol=1e-13)
    # 1e-9 s before the impact the table lacks G * 1e-9 m/s.
    assert table.velocity(falling[-1])[0, 2] == pytest.approx(-V, rel=1e-8)
    np.testing.assert_allclose(table.velocity([table.end, 3.0])[:, 2], 0.25 * V, rtol=1e-13)


def test_a_table_without_rebound_stays_where_it_stopped():
    table = ShockTableImpact(drop_height=0.5, fall=True)
    np.testing.assert_allclose(table.displacement([table.impact, 5.0])[:, 2], -0.5, rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"drop_height": 0.0}, "`drop_height` must be > 0, got 0.0"),
        ({"rebound": 1.1}, "`rebound` must lie between 0 and 1, got 1.1"),
        ({"rebound": -0.1}, "`rebound` must lie between 0 and 1, got -0.1"),
        ({"pulse_duration": 0.0}, "`pulse_duration` must be > 0, got 0.0"),
        ({"gravity": -9.8}, "`gravity` must be > 0, got -9.8"),
    ],
)
def test_arguments_out_of_range_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        ShockTableImpact(**{"drop_height": 0.5, **change})


def test_descriptions_and_events_are_for_people():
    table = ShockTableImpact(drop_height=0.5, rebound=0.2, pulse_duration=0.011, fall=True)
    assert table.description == "drop table 0.5 m, rebound 0.2, 3.758 m/s in 11 ms after its fall along z"
    assert [text for _, text in table.events] == ["table falls", "table strikes", "impact ends"]
