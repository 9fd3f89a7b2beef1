"""What a motion achieves of a required spectrum, and how independent its axes are, against SciPy's own figures."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.signal

from wirerope_mj.motions import HalfSine, Scaled, Turned, VibrationLines, ac156_spectrum, match_spectrum, motion_from_dict
from wirerope_mj.motions.achieved_spectra import achieved_spectra, axis_pairs

pytestmark = pytest.mark.quick

POINTS = [(f, float(ac156_spectrum(f, s_ds=11.768, height_ratio=1.0))) for f in (1.3, 8.3, 33.3, 50.0)]
LOW = [(f, 0.4 * a) for f, a in POINTS]


@pytest.fixture(scope="module")
def motion():
    """AC156 at 1.2 g on the roof along x and z, 16 s."""
    along = ((1, "x", POINTS), (3, "z", LOW))
    return sum(
        (match_spectrum(points, duration=16.0, seed=seed, direction=axis).enveloping for seed, axis, points in along[1:]),
        start=match_spectrum(POINTS, duration=16.0, seed=1, direction="x").enveloping,
    )


def own(motion, axis):
    time = np.arange(0.0, motion.end + 1.0, 5e-4)  # 40 samples in the shortest period
    return time, motion.acceleration(time)[:, axis]


@pytest.mark.slow
@pytest.mark.parametrize(("number", "axis", "points"), [(0, 0, POINTS), (1, 2, LOW)])
def test_achieved_and_required_spectra_are_those_of_state_space_oscillators(motion, number, axis, points):
    found = achieved_spectra(motion)[number]
    assert (found.direction, found.damping) == ("xyz"[axis], 0.05)
    time, acceleration = own(motion, axis)
    rows = np.linspace(0, found.frequencies.size - 1, 5).astype(int)
    for frequency, achieved, required in zip(found.frequencies[rows], found.achieved[rows], found.required[rows], strict=True):
        omega = 2.0 * np.pi * frequency
        oscillator = scipy.signal.lti([0.1 * omega, omega**2], [1.0, 0.1 * omega, omega**2])
        peak = np.abs(scipy.signal.lsim(oscillator, acceleration, time)[1]).max()
        assert achieved == pytest.approx(peak, rel=0.01)  # peaks between its 20 samples a period are up to 0.8 % higher
        assert required == pytest.approx(np.exp(np.interp(np.log(frequency), *np.log(points).T)), rel=1e-12)
    ratio, frequency = found.lowest
    assert ratio >= 0.99
    assert ratio == found.ratio.min()
    assert frequency in found.frequencies
    assert found.peak == pytest.approx(np.abs(acceleration).max(), rel=0.01)


def test_strong_motion_and_arias_intensity_end_where_their_fractions_are_reached(motion):
    found = achieved_spectra(motion)[0]
    time, acceleration = own(motion, 0)
    above = time[np.abs(acceleration) >= 0.25 * np.abs(acceleration).max()]
    assert found.strong == pytest.approx((above[0], above[-1]), abs=0.02)  # the peaks beside it are that far apart
    energy = np.cumsum(acceleration**2)
    ends = time[np.searchsorted(energy, np.array([0.05, 0.95]) * energy[-1])]
    assert found.significant == pytest.approx(ends, abs=2e-3)  # its samples are 1 ms apart


def test_correlation_and_coherence_are_those_of_scipy(motion):
    spectra = achieved_spectra(motion)
    (pair,) = axis_pairs(motion, spectra)
    assert pair.directions == ("x", "z")
    time = np.arange(0.0, motion.end + 1.0, 1e-3)  # as it samples
    begin, end = max(one.significant[0] for one in spectra), min(one.significant[1] for one in spectra)
    rows = (time >= begin - 1e-9) & (time <= end + 1e-9)
    x, z = motion.acceleration(time)[rows][:, (0, 2)].T
    assert pair.correlation == pytest.approx(np.corrcoef(x, z)[0, 1], abs=1e-6)
    x, z = x - x.mean(), z - z.mean()
    delayed = [x[k:] @ z[: x.size - k] for k in range(x.size // 2)] + [z[k:] @ x[: x.size - k] for k in range(x.size // 2)]
    largest = np.abs(delayed).max() / np.sqrt((x @ x) * (z @ z))
    assert pair.largest_correlation == pytest.approx(largest, rel=1e-6)
    length = int(np.count_nonzero(rows) / 12)
    frequency, coherence = scipy.signal.coherence(x, z, fs=1000.0, nperseg=length)
    inside = (frequency >= 1.3) & (frequency <= 50.0)
    assert pair.coherence == pytest.approx(coherence[inside].max(), rel=1e-6)
    assert pair.frequency == pytest.approx(frequency[inside][np.argmax(coherence[inside])], rel=1e-6)
    assert pair.resolution == pytest.approx(1000.0 / length)
    assert pair.coherence < 0.5  # independent, as IEEE 344 has it: no line in common
    assert pair.largest_correlation < 0.3
    for segments in (10, 12, 16, 20):  # whatever the estimator's setting: relative phases do not repeat
        size = int(np.count_nonzero(rows) / segments)
        for overlap in (0.5, 0.75, 0.9):
            frequency, values = scipy.signal.coherence(x, z, fs=1000.0, nperseg=size, noverlap=int(overlap * size))
            assert values[(frequency >= 1.3) & (frequency <= 50.0)].max() < 0.5, (segments, overlap)


def test_the_peak_reaches_the_zero_period_acceleration_of_a_spectrum_that_ends_level(motion):
    for found in achieved_spectra(motion):
        assert found.peak >= 0.99 * found.required[-1]
    matched = match_spectrum(LOW[:3], duration=16.0, seed=1, direction="x")  # ends on its slope: states none
    assert np.abs(own(matched.enveloping, 0)[1]).max() < 0.9 * LOW[2][1]
    assert matched.largest_mismatch <= 0.02


@pytest.mark.slow
def test_axes_that_move_alike_are_coherent():
    """One motion along both axes: every measure is 1."""
    along = match_spectrum(POINTS, duration=16.0, seed=1, direction="x").motion
    both = along + Turned(along, direction="y")
    first, second = achieved_spectra(both)
    assert (first.direction, second.direction) == ("x", "y")
    np.testing.assert_allclose(first.achieved, second.achieved, rtol=1e-9)
    (pair,) = axis_pairs(both, (first, second))
    assert (pair.correlation, pair.largest_correlation, pair.coherence) == pytest.approx((1.0, 1.0, 1.0), rel=1e-9)


def test_a_target_stays_at_its_level_and_is_stored(motion):
    spectra = achieved_spectra(motion)
    halved = achieved_spectra(Scaled(motion, 0.5))
    np.testing.assert_allclose(halved[0].ratio, 0.5 * spectra[0].ratio, rtol=1e-9)
    again = achieved_spectra(motion_from_dict(motion.to_dict()))
    assert again[1].achieved.tobytes() == spectra[1].achieved.tobytes()
    assert motion_from_dict(motion.to_dict()) == motion


def test_what_other_parts_add_is_achieved_and_what_is_not_simulated_is_not(motion):
    shaken = motion + HalfSine(peak=500.0, duration=0.011, direction="z", start=2.0)
    before, after = achieved_spectra(motion)[1], achieved_spectra(shaken)[1]
    assert after.peak > 450.0 > before.peak
    early = achieved_spectra(motion, until=1.0)[0]
    assert early.ratio.max() < achieved_spectra(motion)[0].ratio.max()


def test_motions_without_a_target_have_none():
    lines = VibrationLines(acceleration=[(5.0, 1.0)], duration=4.0, direction="x")
    assert achieved_spectra(lines) == ()
    assert "target" not in lines.to_dict()
    with pytest.raises(ValueError, match="`target` and `damping` belong together"):
        VibrationLines(acceleration=[(5.0, 1.0)], duration=4.0, direction="x", target=POINTS)
    with pytest.raises(ValueError, match="`damping` must be > 0"):
        VibrationLines(acceleration=[(5.0, 1.0)], duration=4.0, direction="x", target=POINTS, damping=0.0)


def test_too_short_a_motion_says_nothing_of_its_axes(motion):
    spectra = achieved_spectra(motion, until=4.0)
    assert axis_pairs(motion, [replace(one, significant=(1.0, 2.0)) for one in spectra], until=4.0) == ()
