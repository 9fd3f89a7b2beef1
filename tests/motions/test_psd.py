"""Power spectral densities: known processes, how certain they are, and what a record must be."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

import wirerope_mj as wr

pytestmark = pytest.mark.quick

RATE = 1000.0


def noise(seconds, *, density=1.0, seed=1, channels=None):
    """Return white noise with a one-sided density [(m/s^2)^2/Hz]: its variance is the density times half the rate."""
    size = int(seconds * RATE)
    values = np.random.default_rng(seed).normal(size=size if channels is None else (size, channels))
    return np.arange(size) / RATE, math.sqrt(0.5 * RATE * density) * values


def oscillator(frequency, q, seconds, *, seed=1, density=1.0):
    """Return the absolute acceleration of an oscillator on a base with white noise, by the filter of ISO 18431-4."""
    time, x = noise(seconds, seed=seed, density=density)
    w, z = 2.0 * np.pi * frequency, 0.5 / q
    wd = w * np.sqrt(1.0 - z * z)
    e, k = np.exp(-z * w / RATE), wd / RATE
    c, s = e * np.cos(k), e * np.sin(k) / k
    return time, lfilter([1.0 - s, 2.0 * (s - c), e * e - s], [1.0, -2.0 * c, e * e], x)


def test_white_noise_has_its_density_and_rms():
    found = wr.power_spectral_density(*noise(200.0, density=3.0), resolution=2.0)
    inside = found.density[2:-2]  # the removed mean takes from the first lines
    # 4 standard errors of the mean of all lines: 1/sqrt(bandwidth duration), 1/sqrt(500 Hz 200 s) = 0.3 %
    assert inside.mean() == pytest.approx(3.0, rel=4.0 / math.sqrt(500.0 * 200.0))
    assert found.rms == pytest.approx(math.sqrt(3.0 * 500.0), rel=2.0 / math.sqrt(500.0 * 200.0))
    assert found.rms_between(100.0, 200.0) == pytest.approx(math.sqrt(300.0), rel=2.0 / math.sqrt(100.0 * 200.0))


def test_the_scatter_of_the_lines_is_the_standard_error_stated():
    found = wr.power_spectral_density(*noise(200.0), resolution=2.0)
    lines = found.density[2:-2:2]  # neighbours of a Hann window are correlated, the next but one hardly
    # The scatter of 124 lines is itself uncertain by 1/sqrt(2 124) = 6 %: four of those.
    assert np.std(lines) / np.mean(lines) == pytest.approx(found.standard_error, rel=0.25)
    # 799 half-overlapping segments: 2 K / (1 + 2/36) up to the ends
    assert found.segments == 799
    assert found.degrees_of_freedom == pytest.approx(2.0 * 799 / (1.0 + 2.0 / 36.0), rel=1e-3)


def test_the_error_of_the_rms_is_what_many_records_scatter_by():
    """The rms of an oscillator with a bandwidth of 2 pi zeta f = 3.1 Hz scatters by 1/(2 sqrt(B T))."""
    runs = [wr.power_spectral_density(*oscillator(20.0, 20.0, 20.0, seed=s), discard=2.0, resolution=0.5) for s in range(80)]
    values = np.array([run.rms for run in runs])
    stated = np.mean([run.rms_error for run in runs])
    exact = 0.5 / math.sqrt(math.pi / 20.0 * 20.0 * 18.0)
    # The scatter of 80 records is known to 1/sqrt(160) = 8 %: three of those; the blur of the window is taken out to 5 %.
    assert values.std() / values.mean() == pytest.approx(exact, rel=0.25)
    assert stated == pytest.approx(exact, rel=0.05)


@pytest.mark.parametrize(("seconds", "damping"), [(10.0, 0.05), (10.0, 0.1), (40.0, 0.05)])
def test_the_error_of_the_rms_is_that_of_the_resonance_and_not_of_the_window(seconds, damping):
    """At 8 Hz with 5 % the bandwidth is 2.5 Hz; the default resolution of 10 s, 0.8 Hz, blurs it to 3.6 Hz."""
    runs = [wr.power_spectral_density(*oscillator(8.0, 0.5 / damping, seconds + 3.0, seed=s), discard=3.0) for s in range(60)]
    bandwidth = 2.0 * np.pi * damping * 8.0
    exact = 0.5 / math.sqrt(bandwidth * seconds)
    # 60 stated errors, each from a bandwidth that scatters by some 20 %: 2 %; the power of the blur is right to 4 %.
    assert np.mean([run.rms_error for run in runs]) == pytest.approx(exact, rel=0.06)
    assert np.mean([run.settling for run in runs]) == pytest.approx(3.0 / bandwidth, rel=0.12)


def test_a_sine_has_the_least_bandwidth_that_its_length_can_tell():
    time = np.arange(8000) / RATE
    found = wr.power_spectral_density(time, np.sin(2.0 * np.pi * 50.0 * time), resolution=1.0)
    # A mean square with two degrees of freedom, known to a half; what is left of the window is a fifth of that.
    assert 1.0 / 8.0 <= found.bandwidth < 1.2 / 8.0
    assert found.rms_error == pytest.approx(0.5, rel=0.1)


def test_an_oscillator_has_the_rms_of_miles():
    """Miles: rms^2 = pi/2 f Q G; the exact integral of the absolute acceleration is (1 + 1/Q^2) times that."""
    f, q, density = 20.0, 10.0, 0.5
    found = wr.power_spectral_density(*oscillator(f, q, 600.0, density=density), discard=5.0, resolution=0.25)
    miles = math.sqrt(0.5 * math.pi * f * q * density)
    # 4 standard errors 1/(2 sqrt(2 pi zeta f T)) = 2.6 %, and 1 % for straight lines between samples 50 to a period
    assert found.rms == pytest.approx(miles, rel=0.035)
    assert found.frequency[found.density.argmax()] == pytest.approx(f, abs=1.0)
    assert found.density.max() == pytest.approx(density * (q**2 + 1.0), rel=4.0 * found.standard_error)


def test_a_sine_has_its_mean_square_in_its_band():
    time = np.arange(8000) / RATE
    found = wr.power_spectral_density(time, 9.0 + 4.0 * np.sin(2.0 * np.pi * 50.0 * time), resolution=1.0)
    assert found.rms == pytest.approx(4.0 / math.sqrt(2.0), rel=1e-9)  # the mean is gone, whole periods in a segment
    assert found.rms_between(48.0, 52.0) == pytest.approx(4.0 / math.sqrt(2.0), rel=1e-9)
    assert found.rms_between(60.0, 500.0) < 1e-6


def test_what_is_discarded_does_not_count():
    time, values = noise(20.0)
    loud = np.where(time < 5.0, 100.0 * values, values)
    found = wr.power_spectral_density(time, loud, discard=5.0, resolution=1.0)
    same = wr.power_spectral_density(time[:-5000], values[5000:], resolution=1.0)
    assert found.duration == pytest.approx(15.0)
    np.testing.assert_array_equal(found.density, same.density)


def test_columns_are_taken_by_themselves():
    time, values = noise(4.0, channels=3)
    found = wr.power_spectral_density(time, values)
    one = wr.power_spectral_density(time, values[:, 1])
    assert found.density.shape == (found.frequency.size, 3)
    np.testing.assert_allclose(found.density[:, 1], one.density, rtol=1e-12)
    assert found.rms.shape == found.rms_error.shape == (3,)
    assert found.rms[1] == pytest.approx(one.rms, rel=1e-12)
    assert found.segments == 15
    assert found.standard_error == pytest.approx(math.sqrt(2.0 / 28.5), rel=0.01)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"discard": 0.995}, r"too short for a density: of 1 s the first 0\.995 s do not count; at least 1\.003 s are needed"),
        ({"resolution": 0.5}, r"too short for a density at 0\.5 Hz.* at least 2 s are needed"),
        ({"resolution": 300.0}, "`resolution` must leave at least 8 samples to a segment: at most 125 Hz"),
        ({"resolution": 0.0}, "`resolution` must be > 0"),
        ({"discard": -1.0}, "`discard` must be >= 0"),
        ({"discard": 5.0}, r"too short for a density: of 1 s the first 5 s do not count; at least 5\.008 s"),
    ],
)
def test_bad_input_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        wr.power_spectral_density(*noise(1.0), **changes)


def test_a_band_has_a_beginning_before_its_end():
    with pytest.raises(ValueError, match="0 <= low < high"):
        wr.power_spectral_density(*noise(1.0)).rms_between(20.0, 10.0)
