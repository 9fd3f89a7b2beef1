"""Several lines at once: amplitudes in the quantity given, phases, and a start and end at rest."""

import math
import tracemalloc

import numpy as np
import pytest

from wirerope_mj.motions import Sine, VibrationLines, banded_lines
from wirerope_mj.motions.envelope import random_phases

pytestmark = pytest.mark.quick


def test_one_endless_line_is_a_sine():
    line = VibrationLines(acceleration=[(7.0, 3.0)], direction="z")
    sine = Sine(frequency=7.0, acceleration=3.0, direction="z")
    time = np.linspace(-0.5, 2.0, 1001)
    for quantity in ("acceleration", "velocity", "displacement"):
        ours, theirs = getattr(line, quantity)(time), getattr(sine, quantity)(time)
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-13 * np.abs(theirs).max())
    assert line.duration == line.end == math.inf
    assert line.corners.size == 0


@pytest.mark.parametrize(("quantity", "order"), [("displacement", 0), ("velocity", 1), ("acceleration", 2)])
def test_amplitudes_are_those_of_the_quantity_given(quantity, order):
    lines = [(5.0, 0.3), (12.5, 0.7)]
    motion = VibrationLines(**{quantity: lines}, direction="x", phases=[0.4, 2.0])
    # 0.4 s hold 2 and 5 whole periods: the Fourier sums of equally spaced samples find every line exactly.
    time = np.arange(400) / 1000
    spectrum = np.fft.rfft(getattr(motion, quantity)(time)[:, 0]) / 200
    np.testing.assert_allclose(np.abs(spectrum[[2, 5]]), [0.3, 0.7], rtol=1e-12)
    # acceleration A sin(w t + phi): the phase of the sine is that of the exponential plus 90 degrees
    acceleration = np.fft.rfft(motion.acceleration(time)[:, 0])
    np.testing.assert_allclose(np.angle(1j * acceleration[[2, 5]]), [0.4, 2.0], rtol=1e-10)
    assert np.abs(np.delete(spectrum, [2, 5])).max() < 1e-13


def test_the_peak_of_a_long_vibration_is_said_from_few_samples_at_once():
    motion = VibrationLines(acceleration=[(10.0, 1.0), (250.0, 1.0)], direction="z", duration=300.0)
    tracemalloc.start()
    try:
        assert "peak acceleration 2 m/s^2" in motion.description
        assert tracemalloc.get_traced_memory()[1] < 10e6  # 2.4 million samples are 19 MB
    finally:
        tracemalloc.stop()


def test_lines_of_a_while_start_and_end_at_rest():
    motion = VibrationLines(velocity=[(5.0, 0.01), (9.0, 0.02)], direction="z", duration=6.0, start=1.0, seed=5)
    assert (motion.rise, motion.fall) == pytest.approx((0.6, 0.6))  # a tenth of the duration, less than ten periods of 0.2 s
    for function in (motion.acceleration, motion.velocity, motion.displacement):
        np.testing.assert_array_equal(function([0.0, 1.0, 7.0, 50.0]), np.zeros((4, 3)))
    steady = VibrationLines(velocity=[(5.0, 0.01), (9.0, 0.02)], direction="z", seed=5)
    time = np.linspace(1.6, 6.4, 997)
    np.testing.assert_allclose(motion.velocity(time), steady.velocity(time), rtol=0, atol=1e-15)
    np.testing.assert_allclose(motion.corners, [1.0, 1.6, 6.4, 7.0])


def test_the_envelope_is_half_way_up_in_the_middle_of_its_rise():
    motion = VibrationLines(displacement=[(50.0, 1e-3)], direction="z", duration=4.0, rise=1.0, phases=[math.pi / 2])
    # -E X cos(w t): 0.5 s and 3.8 s are whole periods, the latter in the middle of the fall of ten periods
    np.testing.assert_allclose(motion.displacement([0.5, 2.0, 3.9])[:, 2], [-0.5e-3, -1e-3, -0.5e-3], rtol=1e-12)


def test_seeded_phases_are_those_of_the_seed():
    seeded = VibrationLines(acceleration=[(5.0, 1.0), (6.0, 2.0)], direction="z", seed=9)
    given = VibrationLines(acceleration=[(5.0, 1.0), (6.0, 2.0)], direction="z", phases=random_phases(9, 2))
    time = np.linspace(0, 1, 101)
    np.testing.assert_array_equal(seeded.acceleration(time), given.acceleration(time))


def test_bands_of_constant_amplitude_become_lines_at_every_step():
    # Single amplitudes of MIL-STD-167-1A type I, from memory: 0.030, 0.020 and 0.010 in.
    inch = 0.0254
    lines = banded_lines([(4, 15, 0.030 * inch), (16, 25, 0.020 * inch), (26, 33, 0.010 * inch)])
    assert [frequency for frequency, _ in lines] == list(range(4, 34))
    amplitudes = dict(lines)
    assert [amplitudes[f] for f in (4, 15, 16, 25, 26, 33)] == pytest.approx(
        [0.762e-3, 0.762e-3, 0.508e-3, 0.508e-3, 0.254e-3, 0.254e-3]
    )
    assert len(banded_lines([(1.0, 2.0, 1.0)], step=0.1)) == 11
    VibrationLines(displacement=lines, direction="z", seed=1)


@pytest.mark.parametrize(
    ("bands", "message"),
    [
        ([(4, 15)], "`bands` must hold a first frequency, a last frequency and an amplitude"),
        ([4, 15, 1.0], "`bands` must hold a first frequency, a last frequency and an amplitude"),
        ([(15, 4, 1.0)], "a band must end above its start, got 15 to 4 Hz"),
        ([(4, 15, 1.0), (15, 20, 0.5)], "the band from 15 to 20 Hz begins within the one before, which ends at 15 Hz"),
        ([], "`bands` must have at least 1 point, got 0"),
    ],
)
def test_bands_that_make_no_lines_are_refused(bands, message):
    with pytest.raises(ValueError, match=message):
        banded_lines(bands)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"acceleration": None},
            "exactly one of `acceleration`, `velocity` and `displacement` must be given, got none",
        ),
        ({"velocity": [(1, 1)]}, "got `acceleration` and `velocity`"),
        ({"acceleration": [(5, 1), (4, 1)]}, "frequencies of `acceleration` must increase"),
        ({"acceleration": [(5, -1)]}, r"`acceleration`, point 1: `amplitude \[m/s\^2\]` must be > 0, got -1.0"),
        ({"phases": [1.0]}, "`phases` must hold one phase for each of the 2 lines, got 1"),
        ({"phases": [1.0, 2.0], "seed": 1}, "at most one of `phases` and `seed`"),
        ({"seed": -1}, "`seed` must be an integer"),
        ({"fall": 1.0}, "`fall` needs a `duration`"),
        ({"rise": 0.1}, "`rise` must be at least one period of the lowest frequency, 0.2 s"),
        ({"duration": 0.3}, "`duration` must leave room for rise and fall"),
    ],
)
def test_arguments_out_of_range_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        VibrationLines(**{"acceleration": [(5, 1), (6, 1)], "direction": "z", **change})


def test_descriptions_and_events_are_for_people():
    motion = VibrationLines(velocity=[(5.0, 0.01), (9.0, 0.02)], direction="z", duration=6.0)
    assert motion.description == "2 lines from 5 to 9 Hz, each up to 0.02 m/s, peak acceleration 1.45 m/s^2, 6 s along z"
    assert VibrationLines(acceleration=[(5.0, 1.0)], direction="x").description == (
        "1 line of 5 Hz, acceleration 1 m/s^2 along x"
    )
    assert motion.events == ((0.0, "vibration begins"), (6.0, "vibration ends"))
