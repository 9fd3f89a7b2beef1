"""What looks wrong about a record is said with its reason, and sound records are left in peace."""

import warnings

import numpy as np
import pytest

from wirerope_mj.errors import RecordWarning
from wirerope_mj.excitation import HalfSine, Sawtooth, Trapezoid, load_record

G = 9.80665
RATE = 5000.0
TIME = np.arange(5000) / RATE


@pytest.fixture
def doubts(tmp_path):
    """Loads accelerations [m/s^2] along z and returns the texts of the warnings."""

    def load(values, *, time=TIME, header="time [s],z [m/s^2]", **arguments):
        path = tmp_path / "record.csv"
        np.savetxt(
            path, np.column_stack([time[: len(values)], values]), delimiter=",", header=header, comments="", fmt="%.9g"
        )
        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always")
            load_record(path, **arguments)
        assert all(issubclass(item.category, RecordWarning) for item in found)
        assert all(item.filename == __file__ for item in found)  # the line that loaded it
        return [str(item.message) for item in found]

    return load


def along_z(motion, time=TIME):
    return motion.acceleration(time)[:, 2]


def noise(rms, seed=0, size=TIME.size):
    return rms * np.random.default_rng(seed).standard_normal(size)


PULSE = HalfSine(peak=15 * G, duration=0.011, direction="z", start=0.1)


@pytest.mark.parametrize(
    "values",
    [
        along_z(PULSE),
        along_z(PULSE) + noise(1.0),
        along_z(Sawtooth(peak=20 * G, duration=0.011, direction="z", start=0.1)),
        np.round((along_z(PULSE) + noise(0.5)) / 1.0)
        * 1.0,  # a converter of steps of 1 m/s^2: flat tops, but no clipping
        np.round(10.0 * np.sin(2 * np.pi * 3.0 * TIME) / 0.08) * 0.08,  # a slow sine at 8 bits
        noise(3.0),
        noise(3.0, seed=1) * np.sin(np.pi * TIME),
        along_z(HalfSine(peak=15 * G, duration=0.0998, direction="z"))[:500],  # nothing but the pulse
        30.0 * np.exp(-4.0 * TIME) * np.sin(2 * np.pi * 12.0 * TIME),
    ],
    ids=[
        "pulse",
        "noisy pulse",
        "sawtooth",
        "coarse pulse",
        "coarse sine",
        "ride",
        "faded ride",
        "bare pulse",
        "ringing",
    ],
)
def test_sound_records_are_left_in_peace(doubts, values):
    assert doubts(values) == []


def test_a_record_that_is_shorter_than_its_pulse_is_said(doubts):
    (words,) = doubts(along_z(PULSE)[: int(0.1055 * RATE) + 1])
    assert "along z it ends at 100 % of its peak: it is shorter than its pulse, and after it" in words
    (words,) = doubts(along_z(PULSE)[int(0.103 * RATE) :])
    assert "along z it begins at 76 % of its peak" in words  # sin(pi 3 / 11)
    (words,) = doubts(np.sin(2 * np.pi * 50.0 * TIME[: int(0.105 * RATE) + 1]) * 10.0)
    assert "it was cut out of a longer one" in words


@pytest.mark.parametrize(("level", "bits"), [(0.9, None), (0.9, 12), (0.97, None), (0.7, 8)])
def test_a_saturated_sensor_is_said(doubts, level, bits):
    values = along_z(PULSE) + noise(0.3)
    if bits:
        step = 15 * G / 2 ** (bits - 1)
        values = np.round(values / step) * step
    values = np.clip(values, None, level * 15 * G)
    found = doubts(values)
    assert len(found) == 1
    assert "samples in a row stand at exactly" in found[0]
    assert "saturated, and the true peak is higher" in found[0]


def test_a_trapezoid_that_was_not_measured_is_doubted_too(doubts):
    """A perfectly flat top cannot be told from a saturated sensor; no sensor ever gave one."""
    (words,) = doubts(along_z(Trapezoid(peak=100.0, duration=0.02, rise=0.002, direction="z", start=0.1)))
    assert "stand at exactly 100 m/s^2" in words


@pytest.mark.parametrize(
    ("rest", "header", "message"),
    [
        (G, "time [s],z [m/s^2]", "as if gravity were in it, which the model has already"),
        (-1.0, "time [s],z [g]", "as if gravity were in it"),
        (1.0, "time [s],z [m/s^2]", "which is gravity if the values are in g and not in m/s^2"),
        (-G, "time [s],z [g]", "which is gravity if the values are in m/s^2 and not in g"),
        (1000.0 * G, "time [s],z [m/s^2]", "which is gravity if the values are in mm/s^2 and not in m/s^2"),
        (G, "time [s],z [mm/s^2]", "which is gravity if the values are in m/s^2 and not in mm/s^2"),
    ],
)
def test_a_record_that_rests_at_gravity_tells_its_unit(doubts, rest, header, message):
    values = abs(rest) * (along_z(PULSE) / G + noise(0.02)) + rest
    found = doubts(values, header=header)
    assert len([words for words in found if message in words]) == 1
    if "gravity were in it" in message:  # the correction that it asks for ends it
        assert doubts(values, header=header, baseline="mean") == []


@pytest.mark.parametrize(
    ("factor", "message"),
    [
        (1000.0, "its peak of 1.47e+05 m/s^2 is beyond any base's: are the values in another unit than m/s^2"),
        (1e-5, "its peak is 0.00147 m/s^2, less than most sensors' noise"),
    ],
)
def test_peaks_that_no_base_has_are_doubted(doubts, factor, message):
    assert any(message in words for words in doubts(factor * along_z(PULSE)))


def test_a_factor_of_1000_below_the_largest_peak_shows_in_the_speed(doubts):
    found = doubts(1000.0 / 15.0 * along_z(PULSE))  # 1 g in mm/s^2: 9807 "m/s^2", 68.7 m/s
    assert len(found) == 1
    assert "along z the base would reach 68.7 m/s" in found[0]
    assert "its unit is another one, by a factor of 9.81 or 1000" in found[0]


def test_seconds_for_milliseconds_are_doubted(doubts):
    assert any("0.005 samples a second: is its time in another unit" in w for w in doubts(noise(1.0), time=1e6 * TIME))
    # A time in s under a header of ms: five million samples a second.
    found = doubts(noise(1.0), header="time [ms],z [m/s^2]")
    assert any("5e+06 samples a second" in words for words in found)


def test_a_drift_is_said_and_corrections_end_it(doubts):
    values = 0.2 * along_z(PULSE) + 1.5 + noise(0.2)  # the pulse itself leaves 0.206 m/s after 1 s
    (words,) = doubts(values)
    assert "along z the base would reach" in words
    assert "the acceleration stands off zero by 1.71 m/s^2 all along" in words
    for more in ({"baseline": "mean"}, {"baseline": "velocity"}, {"baseline": "highpass", "highpass": 2.0}):
        assert doubts(values, **more) == []


def test_every_axis_is_judged(tmp_path):
    path = tmp_path / "three.csv"
    values = np.column_stack([TIME, along_z(PULSE), G + noise(0.01), np.clip(along_z(PULSE) + noise(1.0), None, 100.0)])
    np.savetxt(path, values, delimiter=",", header="time [s],x [m/s^2],y [m/s^2],z [m/s^2]", comments="", fmt="%.9g")
    with pytest.warns(RecordWarning) as found:
        load_record(path, baseline="mean")
    (words,) = (str(item.message) for item in found)
    assert "along z" in words
    assert "stand at exactly 100 m/s^2" in words
    with pytest.warns(RecordWarning) as found:
        load_record(path)
    assert sum("along y it rests at 9.8" in str(item.message) for item in found) == 1
