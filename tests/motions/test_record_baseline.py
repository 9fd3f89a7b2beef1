"""Baseline corrections: what the high-pass filter takes and leaves, and the picture that shows it."""

import re

import numpy as np
import pytest

from wirerope_mj.content.base import record_chart
from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.motions import HalfSine, load_record, motion_from_dict
from wirerope_mj.motions.records.record import records_in
from wirerope_mj.views.plots.svg_chart import chart_svg

pytestmark = pytest.mark.quick

RATE = 1000.0
TIME = np.arange(20_001) / RATE


@pytest.fixture
def csv(tmp_path):
    def write(values):
        path = tmp_path / "record.csv"
        np.savetxt(path, np.column_stack([TIME, values]), delimiter=",", header="time [s],x [m/s^2]", comments="", fmt="%.12g")
        return path

    return write


def burst(frequency):
    """A wave of twenty periods and more under a smooth window that is zero at both ends."""
    return np.sin(np.pi * TIME / TIME[-1]) ** 4 * np.sin(2 * np.pi * frequency * TIME)


@pytest.mark.parametrize(("frequency", "gain"), [(10.0, 1.0), (2.0, 16.0 / 17.0), (1.0, 0.5), (0.5, 1.0 / 17.0)])
def test_the_high_pass_has_the_gain_of_its_order_and_no_phase(csv, frequency, gain):
    record = load_record(csv(burst(frequency)), baseline="highpass", highpass=1.0, start=-2.0)  # 2 s are added before
    np.testing.assert_allclose(record.time[2000:22_001], TIME, atol=1e-9)
    middle = (TIME > 5.0) & (TIME < 15.0)
    # Butterworth of order 2, forward and backward: 1 / (1 + (fc/f)^4). The window widens the wave's line by some 0.1 Hz, over
    # which the gain changes by up to 0.04; one pass alone would have 0.7 at the cutoff, and 90 degrees of phase.
    np.testing.assert_allclose(record.samples[2000:-2000][middle, 0], gain * burst(frequency)[middle], atol=0.04)


def test_the_high_pass_takes_an_offset_off_and_leaves_the_ends_in_peace(csv):
    record = load_record(csv(3.0 + burst(10.0)), baseline="highpass", highpass=0.5)
    np.testing.assert_allclose(record.samples[4000:-4000, 0], burst(10.0), atol=1e-3)
    assert abs(record.velocity(record.end)[0, 0]) < 1e-3  # 60 m/s with the offset


def half_sine(before, after, *, peak=100.0, duration=0.011, offset=0.0, rate=1000.0):
    time = np.arange(round((before + after) * rate)) / rate
    inside = (time >= before) & (time < before + duration)
    return time, offset + np.where(inside, peak * np.sin(np.pi * (time - before) / duration), 0.0)


@pytest.mark.parametrize("offset", [0.0, 0.5, 9.80665])
@pytest.mark.parametrize(
    ("before", "after", "cutoff"),
    [(0.05, 0.5, 1.0), (0.1, 2.0, 1.0), (0.5, 4.0, 0.5), (0.5, 4.0, 1.0), (4.0, 4.0, 0.5)],
)
def test_after_a_high_pass_the_base_comes_to_rest_however_short_the_rest_before_the_shock(
    tmp_path, before, after, cutoff, offset
):
    path = tmp_path / "shock.csv"
    time, values = half_sine(before, after, offset=offset)
    np.savetxt(path, np.column_stack([time, values]), delimiter=",", header="time [s],z [m/s^2]", comments="", fmt="%.12g")
    record = load_record(path, baseline="highpass", highpass=cutoff, start=0.2)
    assert record.start == record.time[0] == 0.2
    assert record.duration == pytest.approx(time[-1] + 4.0 / cutoff, rel=1e-9)
    # The filter has died away to exp(-2 * 4.44) = 1.4e-4 after two periods; the shock changes the velocity by 0.7 m/s.
    assert abs(record.velocity(record.end)[0, 2]) < 1e-4 * 0.7
    assert abs(record.displacement(record.end)[0, 2]) < 1e-2 * np.abs(record.displacement(record.time)).max()
    # What was fast stays: the pulse loses no more than the filter takes of a pulse that is short against its period.
    assert record.samples[:, 2].max() == pytest.approx(values.max() - offset, rel=0.02)
    pulse = record.time[record.samples[:, 2].argmax()] - 0.2
    assert pulse == pytest.approx(before + 0.0055 + 2.0 / cutoff, abs=1.1e-3)


def test_a_lengthened_record_is_played_again_bit_by_bit_and_lies_over_the_measured_one(tmp_path):
    path = tmp_path / "shock.csv"
    np.savetxt(
        path,
        np.column_stack(half_sine(0.05, 0.5)),
        delimiter=",",
        header="time [s],z [m/s^2]",
        comments="",
        fmt="%.12g",
    )
    record = load_record(path, baseline="highpass", highpass=0.7, start=0.3, scale=2.0, resample=2000.0)
    again = motion_from_dict(record.to_dict())
    np.testing.assert_array_equal(again.samples, record.samples)
    np.testing.assert_array_equal(again.time, record.time)
    assert again.description == record.description == f"record shock.csv, {record.duration:.4g} s, peak 20.15 g"
    measured = record.as_measured
    assert measured.start == measured.time[0]
    peaks = [part.time[part.samples[:, 2].argmax()] for part in (measured, record)]
    assert peaks[0] == pytest.approx(peaks[1], abs=1e-9)


def test_a_high_pass_of_a_record_that_begins_amid_its_pulse_is_warned_of(tmp_path):
    path = tmp_path / "shock.csv"
    time, values = half_sine(0.05, 0.5)
    np.savetxt(
        path,
        np.column_stack([time[:-55], values[55:]]),
        delimiter=",",
        header="time [s],z [m/s^2]",
        comments="",
        fmt="%g",
    )
    with pytest.warns(RecordWarning, match="begins at 100 % of its peak"):
        load_record(path, baseline="highpass", highpass=1.0)


def pulse_of(start, stop):
    """A half-sine of 147 m/s^2 between two samples."""
    inside = (start <= TIME) & (stop >= TIME)
    return np.where(inside, 147.0 * np.sin(np.pi * (TIME - start) / (stop - start)), 0.0)


@pytest.mark.parametrize("offset", [12.3, -12.3, 1.47])
def test_the_level_at_rest_leaves_a_pulse_its_velocity(csv, offset):
    pulse = pulse_of(3.0, 3.011)
    record = load_record(csv(offset + pulse), baseline="rest")
    np.testing.assert_allclose(record.samples[:, 0], pulse, atol=1e-10)  # 12 printed digits
    # a median of the noise lies within 1.25 sigma / sqrt(n) = 0.0009; its mean within 0.0007; the pulse's mean is 0.05
    noise = 0.1 * np.random.default_rng(3).standard_normal(TIME.size)
    noisy = load_record(csv(offset + pulse + noise), baseline="rest")
    assert abs(float(np.mean(noisy.samples[:, 0] - pulse - (noise - noise.mean())))) < 4 * 0.0009


def test_the_level_at_rest_of_a_coarse_converter_is_a_mean_of_its_steps(csv):
    step, rng = 0.5, np.random.default_rng(5)
    level = np.round((1.1 + 0.2 * rng.standard_normal(TIME.size)) / step) * step  # 1.0 mostly, sometimes 1.5 and 0.5
    record = load_record(csv(level + pulse_of(3.0, 3.011)), baseline="rest")
    assert float(level.mean()) > 1.05  # a median would be 1.0
    np.testing.assert_allclose(record.samples[0, 0], level[0] - level.mean(), atol=2e-3)


def test_nothing_is_taken_off_a_pulse_that_fills_its_record_and_the_mean_off_a_vibration(csv):
    bare = 1e-4 * pulse_of(0.0, TIME[-1])  # 20 s long: 0.19 m/s
    np.testing.assert_allclose(load_record(csv(bare), baseline="rest").samples[:, 0], bare, atol=1e-9)
    plate = np.clip(0.04 * np.sin(np.pi * TIME / TIME[-1]), None, 0.012)  # at its top most of the time
    record = load_record(csv(plate), baseline="rest")
    np.testing.assert_allclose(record.samples[:, 0], plate, atol=1e-9)
    wave = np.sin(2 * np.pi * 5.0 * TIME)
    record = load_record(csv(wave + 0.7), baseline="rest")
    np.testing.assert_allclose(record.samples[:, 0], wave, atol=1e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"baseline": "highpass"},
            'baseline="highpass" needs its cutoff .Hz., for instance highpass=1.0 .--highpass 1.',
        ),
        (
            {"highpass": 1.0},
            "`highpass` is the cutoff of baseline=\"highpass\" .--baseline highpass.; the baseline is 'none'",
        ),
        ({"baseline": "highpass", "highpass": -1.0}, "`highpass` must be > 0"),
        ({"baseline": "highpass", "highpass": 500.0}, "`highpass` must be below half the sampling rate, 500, got 500"),
        ({"baseline": "highpass", "highpass": 1e-6}, "`highpass` must be at least 0.0002 Hz at 1000 samples a second"),
    ],
)
def test_cutoffs_that_cannot_be_meant_are_refused(csv, arguments, message):
    with pytest.raises(ValueError, match=message):
        load_record(csv(burst(10.0)), **arguments)


def test_the_record_as_measured_can_be_had_again(csv):
    path = csv(0.001 + burst(10.0))
    plain = load_record(path, scale=2.0, start=0.3)
    for more in ({"baseline": "mean"}, {"baseline": "velocity"}, {"baseline": "highpass", "highpass": 1.0}):
        corrected = load_record(path, scale=2.0, start=0.3, **more)
        assert not np.array_equal(corrected.samples, plain.samples)
        np.testing.assert_array_equal(corrected.as_measured.samples, plain.samples)
    assert plain.as_measured is plain


def test_the_chart_shows_both_versions_on_every_moving_axis(csv):
    record = load_record(csv(0.1 + burst(10.0)), baseline="velocity")  # without it the drift is doubted
    chart = record_chart(record)
    assert len(chart.rows) == 3  # acceleration, velocity, displacement along x
    assert sorted(curve.name for curve in chart.rows[1][0].curves) == ["as measured", "as played"]
    played, measured = chart.rows[1][0].curves
    assert measured.y[-1] == pytest.approx(2.0, rel=1e-3)  # 0.1 m/s^2 for 20 s
    assert played.y[-1] == pytest.approx(0.0, abs=1e-9)
    assert "that leaves no final velocity. At its end +0 m/s and" in chart.caption
    # a long acceleration is drawn by its extremes, and none of them is lost
    svg = chart_svg(chart)
    ranges, area = (re.search(rf'data-{name}="([^"]*)"', svg)[1].split(" ") for name in ("ranges", "area"))
    high = np.array(re.search(r'data-name="as played" d="M([^"]*)"', svg)[1].split(" "), dtype=float).reshape(-1, 2)
    assert len(high) < 5000
    top = float(ranges[3]) - (high[:, 1].min() - float(area[1])) / float(area[3]) * (float(ranges[3]) - float(ranges[2]))
    # places are rounded to a tenth of a unit
    assert top == pytest.approx(record.samples[:, 0].max() / 9.80665, rel=2e-3)


def test_the_records_in_a_sum_are_found(csv):
    record = load_record(csv(burst(10.0)))
    pulse = HalfSine(peak=1.0, duration=0.1, direction="z")
    assert records_in(record + pulse) == [record]
    assert records_in(pulse) == []
