"""Even intervals: printed digits are no jitter, gaps are named, uneven sampling is resampled, other rates do not alias."""

import warnings

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from wirerope_mj.foundation.errors import RecordError, RecordWarning
from wirerope_mj.motions import load_record


@pytest.fixture
def csv(tmp_path):
    """Writes times and accelerations along z and returns the file's path."""

    def write(time, values, fmt="%.9g", name="record.csv"):
        path = tmp_path / name
        head = "time [s],z [m/s^2]"
        np.savetxt(path, np.column_stack([time, values]), delimiter=",", header=head, comments="", fmt=fmt)
        return path

    return write


def test_jitter_of_printed_digits_is_no_uneven_sampling(csv):
    true = np.arange(3001) / 3000.0  # intervals of 0.333 ms, printed as 0.0003 and 0.0004
    record = load_record(csv(true, np.sin(2 * np.pi * 10.0 * true), fmt=["%.4f", "%.9g"]))
    np.testing.assert_allclose(record.time, true, atol=1e-12)  # a record of whole seconds: its ends are printed exactly


def test_uneven_sampling_is_resampled_at_the_usual_interval_and_said(csv):
    rng = np.random.default_rng(2)
    time = np.cumsum(np.where(rng.random(3000) < 0.3, 0.5e-3, 1e-3))
    wave = np.sin(2 * np.pi * 5.0 * (time - time[0])) * (time < 2.0)
    with pytest.warns(RecordWarning, match="not uniform, its intervals lie between 0.0005 and 0.001 s; resampled at the usual"):
        record = load_record(csv(time, wave))
    np.testing.assert_allclose(np.diff(record.time), 1e-3, rtol=1e-9)
    inner = (record.time > 0.1) & (record.time < 1.7)
    # straight lines would cut off (2 pi 5 Hz 1 ms)^2 / 8 = 1.2e-4 of the wave's height
    np.testing.assert_allclose(record.samples[inner, 2], np.sin(2 * np.pi * 5.0 * record.time[inner]), atol=1e-4)


def jittered():
    time = np.arange(4000) * 1e-3
    time[1:-1] += np.random.default_rng(1).uniform(-0.3e-3, 0.3e-3, 3998)
    return time


@pytest.mark.filterwarnings("ignore::wirerope_mj.foundation.errors.RecordWarning")
@pytest.mark.parametrize(("frequency", "loss"), [(50.0, 0.002), (150.0, 0.02), (250.0, 0.11)])
def test_waves_that_are_sampled_unevenly_keep_their_height(csv, frequency, loss):
    """Straight lines lose 1, 8 and 22 % (averages of sinc^2 over the intervals); the warning says what curves lose."""
    time = jittered()
    record = load_record(csv(time, np.sin(2 * np.pi * frequency * time + 0.3), fmt="%.17g"))
    inner = (record.time > 1.0) & (record.time < 3.0)
    phase = 2 * np.pi * frequency * record.time[inner]
    parts = np.linalg.lstsq(np.column_stack([np.sin(phase), np.cos(phase)]), record.samples[inner, 2], rcond=None)[0]
    assert np.hypot(*parts) == pytest.approx(1.0, abs=loss)
    assert np.arctan2(parts[1], parts[0]) == pytest.approx(0.3, abs=0.01)


@pytest.mark.filterwarnings("ignore::wirerope_mj.foundation.errors.RecordWarning")
def test_curves_through_uneven_samples_do_not_swing_beside_a_step_nor_where_samples_are_sparse(csv):
    time = jittered()
    record = load_record(csv(time, np.where((time > 1.0) & (time < 1.0155), 100.0, 0.0), fmt="%.17g"))
    # The filter's own overshoot, of what it cannot pass, is 9 % (Gibbs); a spline would add its 13 %.
    assert -10.0 < record.samples.min() <= record.samples[:, 2].max() < 110.0
    sparse = np.concatenate([time[time < 2.0], [2.2, 2.3], 0.5 + time[time > 2.0]])
    wave = np.where((sparse > 2.0) & (sparse < 2.5), 0.0, 100.0 * np.sin(2 * np.pi * 40.0 * sparse))
    record = load_record(csv(sparse, wave, fmt="%.17g"))
    between = (record.time > 2.05) & (record.time < 2.45)
    lines = np.interp(record.time[between], sparse, wave)
    np.testing.assert_allclose(record.samples[between, 2], lines, atol=0.5)  # of 100; the filter rounds the lines' corners


def test_uneven_instants_on_a_common_grid_leave_the_motion_as_it_is(csv):
    path = csv([0.0, 0.001, 0.003, 0.004], [0.0, 1.0, 3.0, -1.0])
    with pytest.warns(RecordWarning, match="not uniform"):
        record = load_record(path)
    np.testing.assert_allclose(record.samples[:, 2], [0.0, 1.0, 2.0, 3.0, -1.0], atol=1e-12)


def gappy():
    time = np.arange(2000) * 1e-3
    kept = np.ones(2000, dtype=bool)
    kept[300:350] = kept[1000] = False
    return time[kept], 10.0 * np.sin(2 * np.pi * 2.0 * time[kept])


def test_a_gap_is_an_error_that_says_where_it_is(csv):
    with pytest.raises(RecordError, match=r"2 gaps \(0.299 to 0.35 s, 0.999 to 1.001 s\) of 51 samples .* gaps=\"fill\""):
        load_record(csv(*gappy()))


def test_gaps_are_filled_with_straight_lines_on_request_and_said(csv):
    path = csv(*gappy())
    with pytest.warns(RecordWarning, match=r"2 gaps .* filled with straight lines"):
        record = load_record(path, gaps="fill")
    assert record.time.size == 2000
    a, b = 10.0 * np.sin(2 * np.pi * 2.0 * np.array([0.299, 0.35]))
    assert record.samples[325, 2] == pytest.approx(a + (b - a) * 26 / 51, rel=1e-8)  # printed with nine digits
    assert record.to_dict()["gaps"] == "fill"


@pytest.mark.parametrize("rate", [1000.0, 750.0, 16000.0])
def test_another_rate_keeps_what_lies_below_its_nyquist_frequency(csv, rate):
    time = np.arange(8001) / 4000.0
    window = np.sin(np.pi * time / 2.0) ** 2
    low = window * np.sin(2 * np.pi * 200.0 * time)
    record = load_record(csv(time, low), resample=rate)
    assert 1.0 / np.diff(record.time)[0] == pytest.approx(rate, rel=1e-12)
    exact = np.sin(np.pi * record.time / 2.0) ** 2 * np.sin(2 * np.pi * 200.0 * record.time)
    # the filter's 80 dB in the pass band, to which 200 Hz belongs at each of these rates
    np.testing.assert_allclose(record.samples[:, 2], exact, atol=2e-4)


def test_what_lies_above_the_new_nyquist_frequency_does_not_come_back_as_an_alias(csv):
    time = np.arange(8001) / 4000.0
    high = np.sin(np.pi * time / 2.0) ** 2 * np.sin(2 * np.pi * 900.0 * time)  # would appear at 100 Hz
    record = load_record(csv(time, high), resample=1000.0)
    assert np.abs(record.samples).max() < 2e-4  # 80 dB


@pytest.mark.filterwarnings("ignore::wirerope_mj.foundation.errors.RecordWarning")
@pytest.mark.parametrize(("rate", "frequency"), [(500.0, 5.0), (500.0, 195.0), (4000.0, 50.0), (4000.0, 390.0), (750.0, 150.0)])
@pytest.mark.parametrize("phase", [0.3, 1.2, 2.5])
def test_another_rate_is_right_up_to_the_ends_of_a_vibration_that_was_cut_out(csv, rate, frequency, phase):
    time = np.arange(4000) / 1000.0
    record = load_record(csv(time, 2.0 + np.sin(2 * np.pi * frequency * time + phase), fmt="%.17g"), resample=rate)
    exact = 2.0 + np.sin(2 * np.pi * frequency * record.time + phase)
    # 80 dB in the pass band, and as much again for what is predicted; a line between the ends errs by 0.6 to 36 %
    np.testing.assert_allclose(record.samples[:, 2], exact, atol=3e-4)


@pytest.mark.filterwarnings("ignore::wirerope_mj.foundation.errors.RecordWarning")
@pytest.mark.parametrize(("rate", "error"), [(100.0, 0.02), (4000.0, 0.02), (1.0, 0.3)])
def test_another_rate_of_noise_that_was_cut_out_is_nearly_that_of_the_whole(csv, rate, error):
    """Noise ten times slower than its sampling, whose prediction is ill-conditioned: with every weight it would explode."""
    sections = butter(8, 35.0, fs=1000.0, output="sos")
    noise = sosfiltfilt(sections, np.random.default_rng(0).standard_normal(24_000))
    noise /= noise.std()
    time = np.arange(24_000) / 1000.0
    whole = load_record(csv(time, noise, fmt="%.17g"), resample=rate)
    part = load_record(csv(time[:8001], noise[8000:16_001], fmt="%.17g"), resample=rate)
    first = round(8.0 * rate)
    same = whole.samples[first : first + part.time.size, 2]
    # What comes after the end of noise is only told for a while: some 0.003 is lacking, with a line between the ends 0.2. At
    # one sample a second the filter reaches over the whole record and finds some 0.1 of what is slower.
    np.testing.assert_allclose(part.samples[:, 2], same, atol=error)


@pytest.mark.parametrize("offset", [0.0, 0.7])
@pytest.mark.parametrize("rate", [500.0, 250.0, 4000.0])
def test_another_rate_keeps_the_velocity_change_of_a_pulse_that_begins_with_the_record(csv, rate, offset):
    time = np.arange(4001) / 1000.0
    path = csv(time, offset + np.where(time < 0.011, 100.0 * np.sin(np.pi * time / 0.011), 0.0), fmt="%.17g")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)  # the offset drifts
        plain, record = load_record(path), load_record(path, resample=rate)
    # What the filter moves beyond the first sample comes back from its mirror image; 1e-5 is its ripple.
    np.testing.assert_allclose(record.velocity(4.0), plain.velocity(4.0), rtol=2e-5)


def test_a_rate_that_is_no_simple_fraction_is_refused(csv):
    path = csv(np.arange(100) * 1e-3, np.sin(np.arange(100.0)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        with pytest.raises(ValueError, match="`resample` must be a simple fraction of the record's 1000 Hz"):
            load_record(path, resample=0.01)
        with pytest.raises(ValueError, match="`resample` must be > 0"):
            load_record(path, resample=-5.0)
        with pytest.raises(ValueError, match="`gaps` must be one of 'refuse', 'fill', got 'cut'"):
            load_record(path, gaps="cut")
        with pytest.raises(ValueError, match=r"`unit` must be one of 'm/s\^2', .*'mg', got 'V'"):
            load_record(path, unit="V")


@pytest.mark.parametrize("gaps", ["refuse", "fill"])
@pytest.mark.parametrize("place", [9, 4])
@pytest.mark.parametrize("jitter", [0.0, 0.3])
def test_a_time_stamp_far_from_all_others_is_refused_and_asks_for_no_memory(csv, gaps, place, jitter):
    time = (np.arange(10) + jitter * (np.arange(10) % 2)) * 1e-3
    time[place:] += 2e10  # as a clock that was set in between
    path = csv(time, np.ones(10), fmt="%.17g")
    with pytest.raises(RecordError, match=r"its time goes from 0\.00\d+ to 2e\+10 s in one row.* Is a time stamp wrong"):
        load_record(path, gaps=gaps)


def test_a_rate_that_asks_for_more_than_ten_million_samples_is_refused(csv):
    path = csv(np.arange(5000) * 1e-3, np.ones(5000))
    with pytest.raises(ValueError, match=r"`resample` would make 5e\+07 samples of 5000, got 10000000"):
        load_record(path, resample=1e7)
