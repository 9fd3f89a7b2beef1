"""ISO 6954: its weighting, its limits, and lines and histories of the same vibration."""

import math

import numpy as np
import pytest

from wirerope_mj.assessment.comfort import (
    RMS_2000,
    WEIGHTINGS,
    iso_6954_1984,
    iso_6954_2000,
    velocity_lines,
)

pytestmark = pytest.mark.quick


def weighting(frequency):
    return abs(complex(WEIGHTINGS["Wm"].gain(frequency)))


def overall(lines):
    """Return the weighted rms velocity [m/s] of lines, peak velocities by frequency: an acceleration times 28 ms."""
    return math.sqrt(0.5 * sum((0.028 * weighting(f) * 2.0 * math.pi * f * v) ** 2 for f, v in lines.items()))


def test_the_weighting_is_that_of_the_standard():
    """ISO 8041 gives 0.3362 at 15.915 Hz (100 rad/s); half a decade below 0.79 Hz it falls by 40 dB a decade."""
    assert weighting(100.0 / (2.0 * math.pi)) == pytest.approx(0.3362, abs=5e-5)
    assert weighting(1.0) == pytest.approx(0.833, abs=5e-4)  # ISO 2631-2, table of factors
    low, high = 10.0**-0.1, 100.0
    # at the corners of the band limits, 3 dB below the passage from acceleration to velocity
    assert weighting(low) * math.hypot(1.0, 0.028 * 2.0 * math.pi * low) == pytest.approx(math.sqrt(0.5), rel=1e-4)
    assert weighting(high) * math.hypot(1.0, 0.028 * 2.0 * math.pi * high) == pytest.approx(math.sqrt(0.5), rel=1e-4)
    assert weighting(0.02) / weighting(0.01) == pytest.approx(4.0, rel=1e-3)


def test_the_limits_of_velocity_and_acceleration_belong_together():
    """The standard's limits of acceleration, 71.5 to 286 mm/s^2, are those of velocity times 1 / 0.028 s, rounded."""
    pairs = {2e-3: 0.0715, 4e-3: 0.143, 3e-3: 0.107, 6e-3: 0.214, 8e-3: 0.286}
    for velocity in (limit for pair in RMS_2000.values() for limit in pair):
        assert velocity / 0.028 == pytest.approx(pairs[velocity], rel=2e-3)


@pytest.mark.parametrize(
    ("frequency", "lower", "upper"),
    [
        (5.0, 4e-3, 9e-3),
        (80.0, 4e-3, 9e-3),
        (2.5, 0.126 / (2.0 * math.pi * 2.5), 0.285 / (2.0 * math.pi * 2.5)),
    ],
)
def test_peaks_of_1984(frequency, lower, upper):
    for factor, words in ((0.99, ("within", "within")), (1.01, ("exceeded", "within"))):
        found = iso_6954_1984([frequency], [factor * lower], subject="deck")
        assert tuple(v.verdict for v in found) == words
        assert [v.limit for v in found] == pytest.approx([lower, upper])
    assert iso_6954_1984([frequency], [1.01 * upper], subject="deck")[1].verdict == "exceeded"


def test_the_worst_line_of_1984_counts_and_those_outside_do_not():
    found = iso_6954_1984([0.5, 3.0, 20.0, 150.0], [1.0, 4e-3, 3e-3, 1.0], subject="deck")
    assert found[0].value == 3e-3  # 3 of 4 mm/s at 20 Hz is more than 4 of 6.7 at 3 Hz
    assert "at 20 Hz" in found[0].note
    with pytest.raises(ValueError, match="a line from 1 to 100 Hz, got 0.5 to 0.5"):
        iso_6954_1984([0.5], [1.0], subject="deck")


def test_a_fast_line_of_2000_counts_as_its_velocity():
    """At 30 Hz the weighting for velocity is 0.98."""
    factor = 30.0 / math.hypot(30.0, 1.0 / (0.028 * 2.0 * math.pi)) / math.hypot(1.0, 0.3**2)
    assert overall({30.0: 4e-3 * math.sqrt(2.0)}) == pytest.approx(4e-3 * factor, rel=1e-6)


@pytest.mark.parametrize(("space", "lower", "upper"), [("A", 2e-3, 4e-3), ("B", 3e-3, 6e-3), ("C", 4e-3, 8e-3)])
def test_spaces_have_their_limits(space, lower, upper):
    time = np.arange(5000) / 500.0
    found = iso_6954_2000(time, np.sin(2.0 * np.pi * 10.0 * time), subject="deck", space=space)
    assert [v.limit for v in found] == [lower, upper]
    assert "probable" in found[0].note


def test_a_history_says_what_its_lines_say():
    """Four sines, three of them between the lines; weighted, and as peaks."""
    time = np.arange(60000) / 1000.0
    lines = {2.2: 1e-3, 9.3: 3e-3, 24.0: 2e-3, 93.1: 1e-3}
    acceleration = 1.0 + sum(2.0 * np.pi * f * v * np.sin(2.0 * np.pi * f * time) for f, v in lines.items())
    counted = {f: v for f, v in lines.items() if f < 89.1}
    from_history = iso_6954_2000(time, acceleration, subject="deck", space="B", discard=1.0)[0]
    assert from_history.value == pytest.approx(overall(counted), rel=2e-3)  # segments without whole periods
    f, v = velocity_lines(time, acceleration)
    for frequency, velocity in lines.items():
        near = np.abs(f - frequency) < 1.0
        assert v[near].max() == pytest.approx(velocity, rel=2e-3)  # the ripple of the filter, 0.1 %
    worst = iso_6954_1984(f, v, subject="deck")[0]
    assert worst.value == pytest.approx(3e-3, rel=2e-3)
    assert worst.verdict == "within"


def modulated(depth, rate, *, seconds=60.0):
    """Return 8 Hz of 3 mm/s whose amplitude swings by `depth` at `rate` [Hz], as acceleration."""
    time = np.arange(int(1000 * seconds)) / 1000.0
    phases = 2.0 * np.pi * np.array([8.0 - rate, 8.0, 8.0 + rate])
    sizes = 3e-3 * np.array([0.5 * depth, 1.0, 0.5 * depth])
    return time, np.cos(np.outer(time, phases)) @ (phases * sizes)  # the derivative of a sum of sines


@pytest.mark.parametrize("rate", [0.05, 0.2, 0.5])
def test_the_largest_amplitude_of_a_modulated_sine_counts(rate):
    """Averaged, 3 mm/s modulated by 80 % is 3 mm/s and within 4; it repeats 5.4 mm/s twice a second."""
    f, v = velocity_lines(*modulated(0.8, rate))
    lower, upper = iso_6954_1984(f, v, subject="deck")
    assert lower.value == pytest.approx(5.4e-3, rel=5e-3)  # ripple of the filter, and up to 0.1 % between two windows
    assert (lower.verdict, upper.verdict) == ("exceeded", "within")
    assert "at 8 Hz, taken as the largest that repeats" in lower.note


def test_a_line_keeps_its_frequency():
    """Below 5 Hz the limit falls with the frequency: a line at 2 Hz is judged there, and not where its skirt ends."""
    time = np.arange(60000) / 1000.0
    for factor, word in ((0.98, "within"), (1.02, "exceeded")):
        f, v = velocity_lines(time, factor * 0.126 * np.sin(2.0 * np.pi * 2.0 * time))
        lower = iso_6954_1984(f, v, subject="deck")[0]
        assert lower.verdict == word
        assert lower.limit == pytest.approx(0.126 / (2.0 * np.pi * 2.0))


def test_beats_faster_than_the_resolution_are_lines_of_their_own():
    f, v = velocity_lines(*modulated(0.8, 2.0))
    assert [float(v[np.abs(f - place).argmin()]) for place in (6.0, 8.0, 10.0)] == pytest.approx(
        [1.2e-3, 3e-3, 1.2e-3], rel=5e-3
    )
    f, v = velocity_lines(*modulated(0.8, 2.0), resolution=1.0)
    assert v.max() == pytest.approx(5.4e-3, rel=5e-3)


def test_what_lies_outside_1_to_80_hz_does_not_count_for_2000():
    """At 100 Hz the weighting still lets 71 % of a velocity through; the range ends with the band of 80 Hz."""
    time = np.arange(60000) / 1000.0
    outside = sum(2.0 * np.pi * f * 7e-3 * np.sin(2.0 * np.pi * f * time) for f in (0.4, 100.0))
    inside = sum(2.0 * np.pi * f * 1e-3 * np.sin(2.0 * np.pi * f * time) for f in (1.5, 80.0))
    found = iso_6954_2000(time, inside + outside, subject="deck", space="B")[0]
    # A resolution of 0.25 Hz: the skirt of 0.4 Hz, two lines away, brings 2 % of 7 mm/s weighted by 0.1
    assert found.value == pytest.approx(overall({1.5: 1e-3, 80.0: 1e-3}), rel=0.03)
    assert found.verdict == "within"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: iso_6954_2000(np.arange(1000) / 100.0, np.zeros(1000), subject="deck", space="D"),
            "`space` must be one of 'A', 'B', 'C', got 'D'",
        ),
        (lambda: iso_6954_1984([10.0], [1e-3, 1e-3], subject="deck"), "rows of the same length"),
        (lambda: iso_6954_1984([-10.0], [1e-3], subject="deck"), "`frequency` must be finite and > 0 Hz"),
        (
            lambda: iso_6954_2000(np.arange(100) / 100.0, np.zeros(100), subject="deck", space="A"),
            "too short for a density at 0.25 Hz",
        ),
        (
            lambda: velocity_lines(np.arange(1000) / 100.0, np.zeros(1000), resolution=10.0),
            "`resolution` must leave a line between six",
        ),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
