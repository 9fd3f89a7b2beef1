"""Motions made for a response spectrum, and the spectra that earthquake standards ask for."""

import math
import pickle

import numpy as np
import pytest

from wirerope_mj.foundation.errors import ConvergenceError
from wirerope_mj.motions import EN1998_TYPE_1, ac156_spectrum, en1998_spectrum, match_spectrum, motion_from_dict
from wirerope_mj.motions.spectra import shock_response_spectrum
from wirerope_mj.motions.spectrum_match import too_steep

pytestmark = pytest.mark.quick

GRID = np.geomspace(1.3, 33.3, 60)
TARGET = list(zip(GRID, ac156_spectrum(GRID, s_ds=10.0, height_ratio=1.0), strict=True))


@pytest.fixture(scope="module")
def match():
    return match_spectrum(TARGET, duration=10.0, seed=3, direction="x", start=0.5)


def spectrum(motion, frequencies, damping=0.05):
    # 60 samples in the shortest period, three times the search's own; three seconds of rest after the end.
    time = np.arange(0.0, 14.0, 1 / (60 * 33.3))
    acceleration = motion.acceleration(time)[:, 0]
    return shock_response_spectrum(time, acceleration, frequencies, q=1 / (2 * damping)).maximax


def test_the_spectrum_of_the_motion_is_the_target_within_the_tolerance(match):
    assert match.largest_mismatch <= 0.02
    assert match.frequencies[0] == pytest.approx(1.3)
    assert match.frequencies[-1] == pytest.approx(33.3)
    assert np.diff(np.log2(match.frequencies)).max() <= 1 / 12 + 1e-12
    np.testing.assert_allclose(match.target, ac156_spectrum(match.frequencies, s_ds=10.0, height_ratio=1.0), rtol=1e-2)
    # The search samples 20 times a period and says what it achieved; finer sampling adds what peaks between samples have,
    # of which the spectrum's own refinement leaves about 1 - sinc(1/20)^2 = 0.8 % at the highest frequency.
    np.testing.assert_allclose(spectrum(match.motion, match.frequencies), match.achieved, rtol=0.01)
    np.testing.assert_allclose(match.mismatch, match.achieved / match.target - 1, rtol=1e-15)


def test_between_the_frequencies_of_the_comparison_the_target_is_nearly_met(match):
    between = np.sqrt(match.frequencies[1:] * match.frequencies[:-1])
    ratio = spectrum(match.motion, between) / ac156_spectrum(between, s_ds=10.0, height_ratio=1.0)
    assert np.abs(ratio - 1).max() < 0.15  # seen: 6 to 10 %


def test_the_base_starts_and_ends_at_rest(match):
    motion = match.motion
    assert (motion.start, motion.end) == (0.5, 10.5)
    for function in (motion.acceleration, motion.velocity, motion.displacement):
        np.testing.assert_array_equal(function([0.0, 0.5, 10.5, 20.0]), np.zeros((4, 3)))
    time = np.linspace(0.0, 11.0, 4001)
    # No drift: a displacement of more than the target's own, S_a/w^2 at the lowest frequency, would be one.
    assert np.abs(motion.displacement(time)).max() < 16.0 / (2 * math.pi * 1.3) ** 2
    np.testing.assert_array_equal(motion.directions, [[1.0, 0.0, 0.0]])


def test_the_motion_is_stored_with_its_amplitudes(match):
    rebuilt = motion_from_dict(match.motion.to_dict())
    time = np.linspace(0.0, 11.0, 1001)
    assert rebuilt.acceleration(time).tobytes() == match.motion.acceleration(time).tobytes()
    assert pickle.loads(pickle.dumps(match)).largest_mismatch == match.largest_mismatch


def test_the_seed_chooses_the_motion(match):
    again = match_spectrum(TARGET, duration=10.0, seed=3, direction="x", start=0.5)
    other = match_spectrum(TARGET, duration=10.0, seed=4, direction="x", start=0.5)
    time = np.linspace(2.0, 8.0, 501)
    np.testing.assert_array_equal(again.motion.acceleration(time), match.motion.acceleration(time))
    assert np.corrcoef(other.motion.acceleration(time)[:, 0], match.motion.acceleration(time)[:, 0])[0, 1] < 0.5


def test_little_damping_takes_more_lines():
    lightly = match_spectrum([(3.0, 2.0), (8.0, 2.0)], duration=6.0, seed=1, direction="x", damping=0.02)
    assert np.diff(np.log(lightly.frequencies)).max() <= 1.2 * 0.02
    assert lightly.damping == 0.02
    np.testing.assert_allclose(spectrum(lightly.motion, lightly.frequencies, 0.02), 2.0, rtol=0.03)


def test_a_target_that_cannot_be_met_is_said_so():
    # A factor 1000 within a twelfth of an octave: an oscillator of 5 % beside the peak answers to it too.
    steep = [(5.0, 0.01), (5.3, 10.0), (5.6, 0.01)]
    with pytest.raises(
        ConvergenceError, match=r"within 2 %; the best of 60 .* % away, farthest at .* Hz: .* m/s\^2 instead of"
    ):
        match_spectrum(steep, duration=5.0, seed=1, direction="x")


def test_a_flank_that_no_motion_has_is_named_with_its_figures():
    """A steady sine r = 1, 1/2 and 2 times the oscillator's frequency: |1 + 2 i zeta r| / |1 - r^2 + 2 i zeta r|."""
    frequencies = np.array([2.0, 4.0])
    at_resonance = np.sqrt(1 + 10.0**2)
    below, above = np.sqrt(1.0025 / (0.75**2 + 0.0025)), np.sqrt(1.04 / (9.0 + 0.04))  # sine at half and at twice, 5 %
    rise, fall = at_resonance / above, at_resonance / below
    assert too_steep(frequencies, np.array([1.0, 0.99 * rise]), 0.05) == ""
    assert too_steep(frequencies, np.array([0.99 * fall, 1.0]), 0.05) == ""
    said = too_steep(frequencies, np.array([1.0, 1.5 * rise]), 0.05)
    assert said.startswith(f"The target rises by {20 * np.log10(1.5 * rise):.3g} dB from 2 to 4 Hz")
    assert f"steady sine of 4 Hz sets oscillators there no more than {20 * np.log10(rise):.3g} dB apart" in said
    assert "The target falls by" in too_steep(frequencies, np.array([1.5 * fall, 1.0]), 0.05)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"target": [(3.0, 1.0), (2.0, 1.0)]}, "frequencies of `target` must increase"),
        ({"target": [(3.0, 1.0), (4.0, 0.0)]}, r"`target`, point 2: `acceleration \[m/s\^2\]` must be > 0, got 0.0"),
        ({"damping": 0.005}, "`damping` must be at least 0.01 .* and below 1, got 0.005"),
        ({"damping": 1.0}, "`damping` must be at least 0.01 .* and below 1, got 1.0"),
        ({"tolerance": 0.0}, "`tolerance` must be > 0, got 0.0"),
        ({"duration": 0.5}, "`duration` must leave room for rise and fall"),
        ({"duration": 0.3}, "`duration` must leave room for rise and fall"),
        ({"rise": 0.1}, "`rise` must be at least one period"),
        ({"seed": -1}, "`seed` must be an integer"),
        ({"direction": "w"}, "`direction` must be"),
    ],
)
def test_arguments_out_of_range_are_refused(change, message):
    good = {"target": [(3.0, 1.0), (8.0, 1.0)], "duration": 5.0, "seed": 0, "direction": "x"}
    with pytest.raises(ValueError, match=message):
        match_spectrum(**{**good, **change})


def test_the_european_spectrum_has_its_branches():
    ground = EN1998_TYPE_1["B"]
    periods = np.array([1e-9, 0.075, 0.15, 0.3, 0.5, 1.0, 2.0, 4.0])
    levels = en1998_spectrum(1 / periods, ground_acceleration=2.0, **ground)
    # ag S = 2.4: 1 at T = 0, half way to 2.5 at TB/2, the plateau, then TC/T and TC TD/T^2
    np.testing.assert_allclose(levels / 2.4, [1.0, 1.75, 2.5, 2.5, 2.5, 1.25, 0.625, 0.15625], rtol=1e-7)


def test_damping_lowers_the_plateau_of_the_european_spectrum():
    ground = EN1998_TYPE_1["A"]
    plateau = [en1998_spectrum(5.0, ground_acceleration=1.0, damping=damping, **ground) for damping in (0.02, 0.05, 0.1, 0.5)]
    expected = [2.5 * math.sqrt(10 / 7), 2.5, 2.5 * math.sqrt(10 / 15), 2.5 * 0.55]  # the last by its lower limit
    np.testing.assert_allclose(plateau, expected, rtol=1e-14)


def test_the_equipment_spectrum_depends_on_the_height_up_to_its_limits():
    ground, middle, roof = (ac156_spectrum([1.3, 8.3, 33.3, 100.0], s_ds=10.0, height_ratio=z) for z in (0, 0.25, 1))
    np.testing.assert_allclose(ground, [10.0, 10.0, 4.0, 4.0], rtol=1e-14)
    np.testing.assert_allclose(middle, [15.0, 15.0, 6.0, 6.0], rtol=1e-14)
    np.testing.assert_allclose(roof, [16.0, 16.0, 12.0, 12.0], rtol=1e-14)
    vertical = ac156_spectrum([5.0, 33.3], s_ds=10.0, height_ratio=1.0, vertical=True)
    np.testing.assert_allclose(vertical, [6.7, 2.7], rtol=1e-14)
    half_way = ac156_spectrum(math.sqrt(8.3 * 33.3), s_ds=10.0, height_ratio=0.0)
    assert half_way == pytest.approx(10 * math.sqrt(0.4), rel=1e-12)


def test_spectra_outside_their_range_are_refused():
    with pytest.raises(ValueError, match=r"`frequencies` must be at least 0.25 Hz: .* ends at 4 s; got 0.2 Hz"):
        en1998_spectrum([0.2, 1.0], ground_acceleration=1.0, **EN1998_TYPE_1["A"])
    with pytest.raises(ValueError, match="`corner_periods` must increase"):
        en1998_spectrum(1.0, ground_acceleration=1.0, soil_factor=1.0, corner_periods=(0.5, 0.4, 2.0))
    with pytest.raises(ValueError, match=r"`frequencies` must be at least 1.3 Hz: .*; got 1 Hz"):
        ac156_spectrum(1.0, s_ds=1.0, height_ratio=0.0)
    with pytest.raises(ValueError, match="`height_ratio` must lie between 0 and 1, got 1.5"):
        ac156_spectrum(2.0, s_ds=1.0, height_ratio=1.5)


def test_the_enveloping_motion_lies_nowhere_below_and_not_far_above(match):
    """IEEE 344's sixth of an octave and closer; its shape is the match's, which between the lines was seen 15 % away."""
    fine = np.geomspace(1.3, 33.3, 400)
    wanted = ac156_spectrum(fine, s_ds=10.0, height_ratio=1.0)
    ratio = spectrum(match.enveloping, fine) / wanted
    assert ratio.min() > 0.99  # a dip that lies between two looks
    assert np.median(ratio) < 1.25
    grown = match.enveloping.acceleration([3.0, 4.0])[:, 0] / match.motion.acceleration([3.0, 4.0])[:, 0]
    assert grown == pytest.approx(np.full(2, grown[0]), rel=1e-12)
    assert 1.0 <= grown[0] < 1.25
    assert motion_from_dict(match.enveloping.to_dict()).acceleration([3.0]) == pytest.approx(
        match.enveloping.acceleration([3.0])
    )
