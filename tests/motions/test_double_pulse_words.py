"""What double pulses show of themselves."""

import pytest

from wirerope_mj.motions import DoubleHalfSine, DoubleTriangle

LEVELS = {"peak": 600.0, "velocity": 2.25, "displacement": 0.0525}
PULSES = [
    DoubleHalfSine(**LEVELS, direction="z"),
    DoubleTriangle(**LEVELS, direction=(0.6, 0.0, 0.8), start=0.1, r2=0.6),
]


@pytest.mark.parametrize("pulse", PULSES, ids=["half-sine", "triangle"])
def test_what_a_double_pulse_shows_of_itself_makes_it_again(pulse):
    again = eval(repr(pulse), {"DoubleHalfSine": DoubleHalfSine, "DoubleTriangle": DoubleTriangle})
    assert again == pulse
    assert "velocity=2.25" in repr(pulse)
    assert "peak_velocity" not in repr(pulse)
