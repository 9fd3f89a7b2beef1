"""Measures of agreement against closed forms, and ratings against the published implementation of ISO/TS 18571."""

import math

import numpy as np
import pytest

from wirerope_mj.assessment.correlation import iso_rating, russell, sprague_geers
from wirerope_mj.assessment.correlation.over_frequency import (
    assurance,
    coherence,
    density_ratio,
    is_transient,
    shock_ratio,
    transmissibility,
)
from wirerope_mj.assessment.correlation.pairs import Pair
from wirerope_mj.motions import MeasuredChannel

pytestmark = pytest.mark.quick

SINE = np.sin(2.0 * np.pi * 5.0 * np.arange(4000) / 4000.0)  # five whole periods


def pair(measured, model, *, rate=1000.0, quantity="acceleration", subject="point/p"):
    time = np.arange(measured.size) / rate
    channel = MeasuredChannel(
        subject=subject, quantity=quantity, axis="z", time=time, values=measured,
        saturated=np.zeros(time.size, dtype=bool), column="A1", unit="g",
    )  # fmt: skip
    return Pair(channel=channel, time=time, measured=measured, model=model)


@pytest.mark.parametrize("factor", [0.5, 0.8, 1.0, 1.25, 3.0])
def test_a_factor_is_an_error_of_magnitude_alone(factor):
    both = sprague_geers(SINE, factor * SINE)
    assert both.magnitude == pytest.approx(factor - 1.0, abs=1e-14)
    assert both.phase == pytest.approx(0.0, abs=1e-8)  # the arc cosine next to 1 has half the digits
    assert both.comprehensive == pytest.approx(abs(factor - 1.0), abs=1e-8)
    of_russell = russell(SINE, factor * SINE)
    size = math.log10(1.0 + abs(factor**2 - 1.0) / factor)
    assert of_russell.magnitude == pytest.approx(math.copysign(size, factor - 1.0), abs=1e-14)
    assert of_russell.comprehensive == pytest.approx(math.sqrt(math.pi / 4.0) * size, abs=1e-8)


@pytest.mark.parametrize("samples", [0, 50, 200, 400])
def test_a_shift_is_an_error_of_phase_alone(samples):
    moved = np.roll(SINE, samples)  # whole periods: a shift by samples / 800 of one
    for measure in (sprague_geers, russell):
        found = measure(SINE, moved)
        assert found.phase == pytest.approx(2.0 * samples / 800.0, abs=1e-8)
        assert found.magnitude == pytest.approx(0.0, abs=1e-12)


def test_russell_is_as_large_for_half_as_for_twice():
    assert russell(SINE, 2.0 * SINE).magnitude == pytest.approx(-russell(SINE, 0.5 * SINE).magnitude, abs=1e-14)


def test_a_dead_channel_is_compared_with_nothing():
    with pytest.raises(ValueError, match="must not be zero throughout"):
        sprague_geers(0.0 * SINE, SINE)


def test_ratings_of_a_level_are_closed_forms():
    rating = iso_rating(np.ones(500), 1.2 * np.ones(500))
    assert rating.corridor == pytest.approx(((0.5 - 0.2) / 0.45) ** 2, abs=1e-12)
    assert rating.magnitude == pytest.approx(1.0 - 0.2 / 0.5, abs=1e-12)
    assert rating.phase == rating.slope == 1.0
    assert rating.overall == pytest.approx(0.4 * rating.corridor + 0.2 * (1.0 + rating.magnitude + 1.0), abs=1e-12)


@pytest.mark.parametrize("late", [-120, -7, 0, 60, 199])
def test_a_pulse_that_comes_late_loses_phase_alone(late):
    measured = np.zeros(1000)
    measured[400:500] = np.sin(np.pi * np.arange(100) / 100.0)
    rating = iso_rating(measured, np.roll(measured, late))
    assert rating.phase == pytest.approx(1.0 - abs(late) / 200.0, abs=1e-12)
    assert rating.magnitude == pytest.approx(1.0, abs=1e-12)
    assert rating.slope == pytest.approx(1.0, abs=1e-12)


TIME = np.arange(1500) * 1e-4


def ring(frequency, decay, start, size=1.0):
    since = np.maximum(TIME - start, 0.0)
    return size * np.exp(-decay * since) * np.sin(2.0 * np.pi * frequency * since)


@pytest.mark.parametrize(
    ("computed", "expected"),
    [
        (1.2 * ring(12, 15, 0.01), (0.882396, 1.0, 0.898354, 0.9, 0.912629)),
        (ring(12, 15, 0.013), (0.856488, 0.9, 1.0, 1.0, 0.922595)),
        (ring(13.2, 15, 0.01), (0.72323, 0.903333, 0.961743, 0.814649, 0.825237)),
        (ring(12, 15, 0.006, 0.8), (0.737865, 0.866667, 0.874614, 0.9, 0.823402)),
        (ring(12, 15, 0.01) + 0.1, (0.661428, 1.0, 0.787007, 1.0, 0.821972)),
        (ring(20, 5, 0.02, 1.5), (0.176753, 0.86, 0.0, 0.0, 0.242701)),
    ],
)
def test_ratings_are_those_of_the_published_implementation(computed, expected):
    """The figures are those of objective-rating-metrics 1.3 (VSI, TU Graz) for these curves, to its six digits."""
    found = iso_rating(ring(12, 15, 0.01), computed)
    parts = (found.corridor, found.phase, found.magnitude, found.slope, found.overall)
    assert parts == pytest.approx(expected, abs=1.1e-6)


def test_grades_are_those_of_the_standard():
    assert iso_rating(SINE, SINE).grade == "excellent"
    assert iso_rating(SINE, -3.0 * SINE + 1.0).grade == "poor"


def test_a_factor_is_the_ratio_of_spectra_at_every_frequency():
    time = np.arange(3000) / 1000.0
    decaying = np.exp(-4.0 * time) * np.sin(2.0 * np.pi * 8.0 * time)
    for found in (shock_ratio(pair(decaying, 0.75 * decaying)), density_ratio(pair(decaying, 0.75 * decaying))):
        np.testing.assert_allclose(found.ratio, 0.75, rtol=1e-9)
        (band,) = found.bands
        assert band.deviation == pytest.approx(-0.25, rel=1e-9)
        assert (band.first, band.last) == pytest.approx((found.frequency[0], found.frequency[-1]), rel=0.06)  # half a band
        assert found.within_3db == 1.0
    assert shock_ratio(pair(decaying, 0.7 * decaying)).within_3db == 0.0  # 3 dB are 0.7079


def test_a_model_that_does_not_move_is_60_db_low_and_a_dead_channel_has_no_spectrum():
    time = np.arange(3000) / 1000.0
    decaying, still = np.exp(-4.0 * time) * np.sin(2.0 * np.pi * 8.0 * time), np.zeros(3000)
    for found in (shock_ratio(pair(decaying, still)), density_ratio(pair(decaying, still))):
        np.testing.assert_array_equal(found.ratio, 1e-3)
        assert [band.deviation for band in found.bands] == [-1.0]
    assert shock_ratio(pair(still, decaying)) is None
    assert density_ratio(pair(still, decaying)) is None


def test_an_event_of_few_cycles_that_rings_to_its_end_has_a_shock_spectrum_at_its_own_frequency():
    time = np.arange(400) / 1000.0
    ringing = np.sin(2.0 * np.pi * 7.0 * time)
    assert shock_ratio(pair(ringing, ringing)).frequency[0] < 7.0  # two of its periods last 0.29 s
    stationary = np.sin(2.0 * np.pi * 70.0 * time)
    assert shock_ratio(pair(stationary, stationary)) is None  # 28 cycles


def test_a_band_is_where_the_model_is_low():
    rng = np.random.default_rng(7)
    time = np.arange(60_000) / 1000.0
    low, high = (np.zeros(time.size // 2 + 1, dtype=complex) for _ in range(2))
    lines = np.fft.rfftfreq(time.size, 1e-3)
    for part, (first, last) in ((low, (6.0, 9.0)), (high, (1.0, 100.0))):
        inside = (lines >= first) & (lines < last)
        part[inside] = np.exp(2j * np.pi * rng.random(np.count_nonzero(inside)))
    high[low != 0.0] = 0.0
    measured, model = np.fft.irfft(low + high), np.fft.irfft(0.75 * low + high)
    assert not is_transient(measured)
    found = density_ratio(pair(measured, model))
    band = found.bands[0]
    assert band.deviation == pytest.approx(-0.25, abs=0.05)  # the bands at both ends are partly outside
    assert (band.first, band.last) == pytest.approx((6.0, 9.0), rel=0.12)  # the width of a band, a sixth of an octave
    assert len(found.bands) == 1


def test_coherence_is_the_ratio_of_signal_and_noise():
    rng = np.random.default_rng(2)
    signal, noise = rng.standard_normal((2, 40_000))
    assert coherence(pair(signal, 3.0 * signal)) == pytest.approx(1.0, abs=1e-12)
    found = coherence(pair(signal, signal + noise))
    # 1 / (1 + 1), and the bias of 14 independent segments, (1 - g)^2 (1 + 2 g) / 14
    assert found == pytest.approx(0.5 + 0.5 / 14.0, abs=0.02)
    assert coherence(pair(signal[:100], signal[:100])) is None


def test_transmissibility_is_that_of_the_filter_between():
    rng = np.random.default_rng(4)
    drive = rng.standard_normal(20_000)

    def answer(echo):
        return drive + echo * np.roll(drive, 1)

    base = pair(drive, drive, subject="base")
    found = transmissibility(base, pair(answer(0.5), answer(-0.5)))
    turn = np.exp(-2j * np.pi * found.frequency / 1000.0)
    np.testing.assert_allclose(found.measured, 1.0 + 0.5 * turn, atol=0.01)  # of the windows' ends
    np.testing.assert_allclose(found.model, 1.0 - 0.5 * turn, atol=0.01)
    assert found.frac == pytest.approx(assurance(1.0 + 0.5 * turn, 1.0 - 0.5 * turn), abs=0.01)
    assert transmissibility(base, pair(drive, drive, quantity="displacement")) is None


def test_assurance_knows_factors_and_orthogonal_functions():
    one = np.exp(2j * np.pi * np.arange(64) / 64.0)
    assert assurance(one, (0.3 - 2j) * one) == pytest.approx(1.0, abs=1e-14)
    assert assurance(one, one**2) == pytest.approx(0.0, abs=1e-14)
