"""What looks wrong about a record is said with its reason, and sound records are left in peace."""

import re
import warnings

import numpy as np
import pytest

from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.motions import HalfSine, Sawtooth, Trapezoid, load_record
from wirerope_mj.motions.records.checks import flat_tops

G = 9.80665
RATE = 5000.0
TIME = np.arange(5000) / RATE


@pytest.fixture
def doubts(tmp_path):
    """Loads accelerations [m/s^2] along z and returns the texts of the warnings."""

    def load(values, *, time=TIME, header="time [s],z [m/s^2]", **arguments):
        path = tmp_path / "record.csv"
        np.savetxt(path, np.column_stack([time[: len(values)], values]), delimiter=",", header=header, comments="", fmt="%.9g")
        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always")
            record = load_record(path, **arguments)
        assert record.warnings == tuple(str(item.message).replace(str(path), path.name) for item in found)
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
        np.round((along_z(PULSE) + noise(0.5)) / 1.0) * 1.0,  # a converter of steps of 1 m/s^2: flat tops, but no clipping
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
    assert "may have been saturated, and the true peak be higher" in found[0]  # it cannot be known


@pytest.mark.parametrize("level", [0.005, 0.02])
def test_a_limit_that_noise_leaves_again_and_again_is_said(level):
    # a response whose noise takes it off the limit every few samples; with its whole peak it is left in peace
    time, generator = np.arange(6000) / 1e4, np.random.default_rng(3)
    values = np.exp(-5.0 * time) * np.sin(2 * np.pi * 12.0 * time) + level * generator.standard_normal(time.size)
    limit = 0.95 * float(values.max())
    assert not list(flat_tops(values))
    assert [extreme for extreme, _ in flat_tops(np.minimum(values, limit))] == [limit]
    coarse = np.round(np.minimum(values, limit) * 1000.0) / 1000.0
    assert [extreme for extreme, _ in flat_tops(coarse)] == [coarse.max()]


def test_a_trapezoid_that_was_not_measured_is_doubted_too(doubts):
    """A perfectly flat top cannot be told from a saturated sensor; no sensor ever gave one."""
    (words,) = doubts(along_z(Trapezoid(peak=100.0, duration=0.02, rise=0.002, direction="z", start=0.1)))
    assert "stand at exactly 100 m/s^2" in words


def test_figures_are_given_in_the_units_of_the_file(doubts):
    """Saturated at 10 g, at rest at 1 g, and a spike of 500 g: none of the messages speaks of m/s^2."""
    flat = along_z(Trapezoid(peak=10.0, duration=0.02, rise=0.002, direction="z", start=0.1))
    spike = np.where(np.arange(TIME.size) == 700, 500.0, flat)
    found = [text for values in (flat, flat + 1.0, spike) for text in doubts(values, header="time [s],z [g]")]
    assert not [text for text in found if re.search(r"\d m/s\^2", text)]
    assert "stand at exactly 10 g" in found[0]
    assert any("rests at 1 g" in text or "by 1 g" in text for text in found)
    assert any("one sample of 500 g" in text for text in found)


@pytest.mark.parametrize("rest", [0.0, G])
@pytest.mark.parametrize("low", [0.0, -60.0])
def test_a_rectangle_is_not_taken_for_a_saturated_sensor(doubts, rest, low):
    """It jumps by its full height from one sample to the next, to rest or to a rectangle on the other side."""
    values = np.full(TIME.size, rest)
    values[1000:1040] += 100.0
    values[1040:1100] += low
    assert not [words for words in doubts(values) if "saturated" in words]
    values[999] = values[1040] = rest + 50.0  # flanks, and it may have been measured
    assert len([words for words in doubts(values) if "saturated" in words]) == 1


@pytest.mark.parametrize(
    ("rest", "header", "message"),
    [
        (G, "time [s],z [m/s^2]", "as if gravity were in it, which the model has already"),
        (-1.0, "time [s],z [g]", "as if gravity were in it"),
        (1.0, "time [s],z [m/s^2]", "which is gravity if the values are in g and not in m/s^2"),
        (386.09, "time [s],z [m/s^2]", "which is gravity if the values are in in/s^2 and not in m/s^2"),
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
        left = doubts(values, header=header, baseline="rest")
        assert [text.partition(": it is ")[2][:11] for text in left] == (["upside down"] if rest < 0.0 else [])


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
    assert "its unit may be another one, by a factor of 9.81 or 1000" in found[0]


def test_seconds_for_milliseconds_are_doubted(doubts):
    assert any("0.005 samples a second: is its time in another unit" in w for w in doubts(noise(1.0), time=1e6 * TIME))
    # A time in s under a header of ms: five million samples a second.
    found = doubts(noise(1.0), header="time [ms],z [m/s^2]")
    assert any("5e+06 samples a second" in words for words in found)


def test_an_offset_at_rest_is_said_and_corrections_end_it(doubts):
    values = 0.2 * along_z(PULSE) + 1.5 + noise(0.2)  # the pulse itself leaves 0.206 m/s after 1 s
    (words,) = doubts(values)
    assert "along z the base would reach 1.7" in words
    stands = float(re.search(r"stands off zero by (\S+) m/s\^2 where it rests", words)[1])
    assert stands == pytest.approx(1.5, abs=0.012)  # four standard errors of a mean of 5000; with the pulse 1.706
    for more in ({"baseline": "rest"}, {"baseline": "highpass", "highpass": 2.0}):
        assert doubts(values, **more) == []


@pytest.mark.parametrize("offset", [0.15 * G, -0.15 * G, G])
@pytest.mark.parametrize("size", [2500, 5000])
def test_a_small_offset_under_a_large_pulse_is_said_with_its_level_at_rest(doubts, offset, size):
    found = doubts(along_z(PULSE)[:size] + offset)
    assert len([w for w in found if f"stands off zero by {offset:.4g} m/s^2 where it rests" in w]) == 1
    assert all('"mean"' not in words for words in found)  # which would take a part of the pulse off


def test_a_mean_that_holds_the_pulse_is_said(doubts):
    values = along_z(PULSE)[:2500] + G
    gained = 2.0 / np.pi * 15.0 * G * 0.011  # the half-sine's velocity change: 1.03 m/s
    for baseline in ("mean", "velocity"):
        (words,) = doubts(values, baseline=baseline)
        level = float(re.search(r"the quiet part stands at (\S+) m/s\^2 after", words)[1])
        assert level == pytest.approx(-gained / 0.5, rel=1e-2)  # straight lines between samples take less than that off
        assert 'baseline="rest" (--baseline rest)' in words
    waves = np.where((TIME > 0.1) & (TIME < 0.2), 30.0 * np.sin(2 * np.pi * 50.0 * TIME), 0.0)
    assert doubts(waves - 0.5, baseline="velocity") == []  # five waves: no velocity that could be spread


@pytest.mark.parametrize("ripple", [0.0, 0.3])
def test_coasting_after_a_pulse_is_no_drift(doubts, ripple):
    long = np.arange(50_000) / RATE  # 10 s: the base goes on for 30 m
    trapezoid = Trapezoid(peak=200.0, duration=0.02, rise=0.002, direction="z", start=1.0)
    values = along_z(trapezoid, long) + noise(ripple, size=long.size)
    assert not [words for words in doubts(values, time=long) if "the base would" in words]
    plate = np.where(along_z(PULSE) > 0.0, 100.0, 0.0)
    assert not [words for words in doubts(plate) if "the base would" in words]
    top = along_z(Trapezoid(peak=50.0, duration=0.9, rise=0.05, direction="z", start=0.05))  # mostly at its top
    assert not [words for words in doubts(top) if "rests" in words]


def test_a_growing_drift_of_a_ride_is_said(doubts):
    (words,) = doubts(noise(3.0) + 4.0 * TIME)
    assert "by 1.99 m/s^2 all along" in words  # half of 4 m/s^2, and the noise's mean
    assert doubts(noise(3.0) + 4.0 * TIME, baseline="highpass", highpass=2.0) == []


def test_a_record_without_motion_is_said_once(doubts):
    (words,) = doubts(0.0 * TIME)
    assert words.endswith("all of its samples are zero: the base does not move.")


def test_a_pulse_that_is_too_weak_by_a_thousand_is_doubted(doubts):
    (words,) = doubts(along_z(PULSE), header="time [s],z [mm/s^2]")
    assert 'if the values are in m/s^2 and not in mm/s^2, say unit="m/s^2"' in words
    assert doubts(1000.0 * along_z(PULSE), header="time [s],z [mm/s^2]") == []
    assert doubts(100.0 * noise(1.0), header="time [s],z [mm/s^2]") == []  # a quiet floor, but no pulse


def test_every_axis_is_judged(tmp_path):
    path = tmp_path / "three.csv"
    values = np.column_stack([TIME, along_z(PULSE), G + noise(0.01), np.clip(along_z(PULSE) + noise(1.0), None, 100.0)])
    np.savetxt(path, values, delimiter=",", header="time [s],x [m/s^2],y [m/s^2],z [m/s^2]", comments="", fmt="%.9g")
    with pytest.warns(RecordWarning) as found:
        load_record(path, baseline="rest")
    turned, words = (str(item.message) for item in found)
    assert "along y" in turned
    assert "that acts along z" in turned
    assert "along z" in words
    assert "stand at exactly 100 m/s^2" in words
    with pytest.warns(RecordWarning) as found:
        load_record(path)
    assert sum("along y it rests at 9.8" in str(item.message) for item in found) == 1


def slow(motion, rate):
    """Return two seconds along z at a lower rate, and their instants."""
    time = np.arange(int(2.0 * rate)) / rate
    return along_z(motion, time), time


@pytest.mark.parametrize("start", [0.1, 0.1012, 0.1025])
def test_a_pulse_of_two_samples_is_said_with_what_its_velocity_makes_of_it(doubts, start):
    values, time = slow(HalfSine(peak=15 * G, duration=0.011, direction="z", start=start), 200.0)
    (words,) = doubts(values, time=time)
    assert "has 2 samples at 200 samples a second: its peak is not known" in words
    about = float(re.search(r"would be about (\S+) m/s\^2", words)[1])
    # The sum of samples is the area but for 2 cos(2.2 pi) / (1 - 4 x 2.2^2), 9 %, the transform at the rate and its image; the
    # length of 2.2 intervals is taken for 2.14, 3 %.
    assert about == pytest.approx(15 * G, rel=0.12)


@pytest.mark.parametrize(("samples", "said"), [(3.2, 35), (4.2, 13)])
@pytest.mark.parametrize("phase", [0.0, 0.25, 0.5, 0.75])
def test_how_far_the_peak_of_a_coarse_pulse_may_be_off_is_a_bound(doubts, samples, said, phase):
    values, time = slow(HalfSine(peak=100.0, duration=samples / 500.0, direction="z", start=0.3 + phase / 500.0), 500.0)
    (words,) = doubts(values, time=time)
    found = int(re.search(r"its true peak may be up to (\d+) % higher", words)[1])
    assert found in (35, 13)  # of three samples, and of four
    assert 100.0 * (100.0 / values.max() - 1.0) <= found
    assert found >= said


@pytest.mark.parametrize("shape", [HalfSine, Sawtooth])
@pytest.mark.parametrize("at", [100, 520, 4000], ids=["before", "within", "after"])
def test_a_sample_that_stands_alone_is_said(doubts, shape, at):
    values = along_z(shape(peak=15 * G, duration=0.011, direction="z", start=0.1)) + noise(0.5)
    assert not [words for words in doubts(values) if "stands alone" in words]
    values[at] = 500.0 * G
    (words,) = [words for words in doubts(values) if "stands alone" in words]
    assert f"along z one sample of 4903 m/s^2, {at / RATE:.6g} s after the first, stands alone" in words
    values[at] = values[at - 1]
    values[600] = values[3000] = -40.0 * G
    (words,) = [words for words in doubts(values) if "stands alone" in words]
    assert "and 1 more like it" in words


def test_a_vibration_near_half_the_sampling_rate_is_said(doubts):
    (words,) = [words for words in doubts(10.0 * np.sin(2.0 * np.pi * 2000.0 * TIME)) if "cut out" not in words]
    assert "its energy lies about 2000 Hz, near the 2500 Hz that 5000 samples a second can hold" in words
    assert "play 57 % of such a vibration" in words  # (sin(0.4 pi) / 0.4 pi)^2
    assert not [words for words in doubts(10.0 * np.sin(2.0 * np.pi * 1000.0 * TIME)) if "its energy" in words]


@pytest.mark.parametrize("seed", range(8))
def test_steps_bursts_and_pyroshock_are_no_faults_of_sampling(doubts, seed):
    random = np.random.default_rng(seed)
    start = random.uniform(0.05, 0.3)
    later = np.maximum(TIME - start, 0.0)
    rings = [np.exp(-2.0 * np.pi * f * later * 0.05) * np.sin(2.0 * np.pi * f * later) for f in (50.0, 170.0, 500.0)]
    pyroshock = 3e3 * random.standard_normal(3) @ np.array(rings) + noise(1.0, seed)
    saw = along_z(Sawtooth(peak=15 * G, duration=0.006, direction="z", start=start))
    white = noise(3.0, seed)
    burst = np.where((later > 0.0) & (later < 0.1), white, 0.0)
    for values in (pyroshock, saw, saw[::-1], white * np.exp(-10.0 * TIME), burst, random.laplace(size=TIME.size)):
        found = doubts(values)
        assert not [words for words in found if re.search("stands alone|shortest pulse|its energy lies", words)]
