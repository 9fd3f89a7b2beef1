"""Baseline corrections: what the high-pass filter takes and leaves, and the picture that shows it."""

import numpy as np
import pytest

from wirerope_mj.excitation import HalfSine, load_record
from wirerope_mj.plots.record_baseline import records_of, save_record_baseline

RATE = 1000.0
TIME = np.arange(20_001) / RATE


@pytest.fixture
def csv(tmp_path):
    def write(values):
        path = tmp_path / "record.csv"
        np.savetxt(
            path, np.column_stack([TIME, values]), delimiter=",", header="time [s],x [m/s^2]", comments="", fmt="%.12g"
        )
        return path

    return write


def burst(frequency):
    """A wave of twenty periods and more under a smooth window that is zero at both ends."""
    return np.sin(np.pi * TIME / TIME[-1]) ** 4 * np.sin(2 * np.pi * frequency * TIME)


@pytest.mark.parametrize(("frequency", "gain"), [(10.0, 1.0), (2.0, 16.0 / 17.0), (1.0, 0.5), (0.5, 1.0 / 17.0)])
def test_the_high_pass_has_the_gain_of_its_order_and_no_phase(csv, frequency, gain):
    record = load_record(csv(burst(frequency)), baseline="highpass", highpass=1.0)
    middle = (TIME > 5.0) & (TIME < 15.0)
    # Butterworth of order 2, forward and backward: 1 / (1 + (fc/f)^4). The window widens the wave's line by some 0.1 Hz, over
    # which the gain changes by up to 0.04; one pass alone would have 0.7 at the cutoff, and 90 degrees of phase.
    np.testing.assert_allclose(record.samples[middle, 0], gain * burst(frequency)[middle], atol=0.04)


def test_the_high_pass_takes_an_offset_off_and_leaves_the_ends_in_peace(csv):
    record = load_record(csv(3.0 + burst(10.0)), baseline="highpass", highpass=0.5)
    np.testing.assert_allclose(record.samples[:, 0], burst(10.0), atol=1e-3)
    assert abs(record.velocity(record.end)[0, 0]) < 1e-3  # 60 m/s with the offset


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"baseline": "highpass"}, 'baseline="highpass" needs its cutoff'),
        ({"highpass": 1.0}, "`highpass` is the cutoff of baseline=\"highpass\"; the baseline is 'none'"),
        ({"baseline": "highpass", "highpass": -1.0}, "`highpass` must be > 0"),
        ({"baseline": "highpass", "highpass": 500.0}, "`highpass` must be below half the sampling rate, 500, got 500"),
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
        np.testing.assert_array_equal(corrected.as_measured().samples, plain.samples)
    assert plain.as_measured() is plain


def test_the_picture_shows_both_versions_on_every_moving_axis(csv, tmp_path, monkeypatch):
    from matplotlib.figure import Figure

    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, path: figures.append(figure))
    record = load_record(csv(0.1 + burst(10.0)), baseline="velocity")  # without it the drift is doubted
    save_record_baseline(record, tmp_path / "p.png", title="Deck")
    (figure,) = figures
    assert len(figure.axes) == 3  # acceleration, velocity, displacement along x
    velocity = figure.axes[1]
    texts = [text.get_text() for text in velocity.get_legend().get_texts()]
    assert texts[0].startswith("as measured: ends at +2 m/s, +20")  # 0.1 m/s^2 for 20 s: 2 m/s and 20 m
    assert texts[1].startswith("as played: ends at +0 m/s")
    # a long acceleration is drawn by its extremes, and none of them is lost
    drawn = figure.axes[0].get_lines()[1].get_ydata()
    assert len(drawn) < 5000
    assert drawn.max() == pytest.approx(record.samples[:, 0].max() / 9.80665, rel=1e-12)
    assert "no final velocity" in figure.get_suptitle()


def test_the_records_in_a_sum_are_found(csv):
    record = load_record(csv(burst(10.0)))
    pulse = HalfSine(peak=1.0, duration=0.1, direction="z")
    assert records_of(record + pulse) == [record]
    assert records_of(pulse) == []
