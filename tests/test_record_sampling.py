"""Even intervals: printed digits are no jitter, gaps are named, uneven sampling is resampled, other rates do not alias."""

import warnings

import numpy as np
import pytest

from wirerope_mj.errors import RecordError, RecordWarning
from wirerope_mj.excitation import load_record


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
    with pytest.warns(
        RecordWarning, match="not uniform, its intervals lie between 0.0005 and 0.001 s; resampled at the usual"
    ):
        record = load_record(csv(time, wave))
    np.testing.assert_allclose(np.diff(record.time), 1e-3, rtol=1e-9)
    inner = (record.time > 0.1) & (record.time < 1.7)
    # straight lines cut off (2 pi 5 Hz 1 ms)^2 / 8 = 1.2e-4 of the wave's height
    np.testing.assert_allclose(record.samples[inner, 2], np.sin(2 * np.pi * 5.0 * record.time[inner]), atol=5e-4)


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
    with pytest.raises(
        RecordError, match=r"2 gaps \(0.299 to 0.35 s, 0.999 to 1.001 s\) of 51 samples .* gaps=\"fill\""
    ):
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


def test_a_rate_that_is_no_simple_fraction_is_refused(csv):
    path = csv(np.arange(100) * 1e-3, np.sin(np.arange(100.0)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        with pytest.raises(ValueError, match="`resample` must be a simple fraction of the record's 1000 Hz"):
            load_record(path, resample=0.01)
        with pytest.raises(ValueError, match="`resample` must be > 0"):
            load_record(path, resample=-5.0)
        with pytest.raises(ValueError, match='`gaps` must be "refuse" or "fill", got \'cut\''):
            load_record(path, gaps="cut")
        with pytest.raises(ValueError, match='`unit` must be "m/s\\^2", .*"ft/s\\^2", got \'V\''):
            load_record(path, unit="V")
