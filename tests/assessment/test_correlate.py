"""A run against a test of it: clocks brought together, signs suspected, and what was not measured of this model refused."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from house import sdof
from made_up_floor import floor_response
from scipy.interpolate import CubicSpline

import wirerope_mj as wr

pytestmark = pytest.mark.quick

RATE = 10_000.0


@pytest.fixture(scope="module")
def floor():
    return floor_response(mounts=2, equipment=1, rows=801)


CHANNELS = {
    "B": "base z m/s^2", "T": "point/rack_top z m/s^2", "D": "mount/m01 axial m", "F": "mount/m01 axial N",
    "R": "point/rack_top displacement z m",
}  # fmt: skip


def histories(response):
    return {
        "B": response.base.acceleration[:, 2], "T": response.points["rack_top"].acceleration[:, 2],
        "D": response.mounts["m01"].deflection[:, 2], "F": response.mounts["m01"].force[:, 2],
        "R": response.points["rack_top"].relative_displacement[:, 2],
    }  # fmt: skip


def measured_of(tmp_path, response, *, late=0.0, channels=CHANNELS, change=lambda name, values: values, **options):
    """Returns the run's own histories as a test at 10 kHz whose clock is `late` [s]."""
    time = np.arange(int(RATE * response.time[-1])) / RATE
    columns = {name: change(name, np.interp(time - late, response.time, y)) for name, y in histories(response).items()}
    path = Path(tmp_path) / "drop.csv"
    np.savetxt(
        path, np.column_stack([time, *columns.values()]), delimiter=",", header="time [s]," + ",".join(columns),
        comments="", fmt="%.12g",
    )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wr.RecordWarning)
        return wr.load_measured(path, channels=channels, **options)


def test_a_run_agrees_with_itself(tmp_path, floor):
    found = wr.correlate(floor, measured_of(tmp_path, floor))
    assert found.aligned_by == "base, z"
    assert abs(found.delay) < 2e-5  # a fifth of the test's samples, a fiftieth of the run's
    for one in found.channels:
        # straight lines between samples of 1 kHz at 10 kHz, filtered: an 11 ms half-sine loses 0.5 %, its peak 1.2 %
        assert one.peak_ratio == pytest.approx(1.0, abs=0.015), one.label
        assert one.rms_ratio == pytest.approx(1.0, abs=0.01), one.label
        assert one.rating.grade == "excellent", one.label
        assert one.frac > 0.99, one.label
    assert found.statement == "Model within 10 % of the measurement from 3.7 to 23 Hz in all 4 channels."
    assert not found.warnings


@pytest.mark.parametrize("late", [-0.02, 0.0003, 0.05])
def test_the_delay_of_the_clock_is_found_by_the_base(tmp_path, floor, late):
    found = wr.correlate(floor, measured_of(tmp_path, floor, late=late))
    assert found.delay == pytest.approx(late, abs=5e-5)  # half a sample of the test
    assert min(one.rating.overall for one in found.channels) > 0.94
    still = wr.correlate(floor, measured_of(tmp_path, floor, late=late), align=False)
    assert still.delay == 0.0
    assert still.aligned_by == ""


@pytest.mark.parametrize("rate", [0.0, 1e-4, -4e-4])
def test_the_rate_of_the_clock_is_found_by_the_base(tmp_path, rate):
    law = wr.BoucWen.from_normalised(z_max=60.0, x_y=2e-3, sigma=0.6, n=1.0, k=1e4)
    psd = [(5.0, 0.5), (60.0, 0.5)]
    motion = wr.RandomVibration(psd=psd, duration=20.0, seed=4, direction="z")
    run = wr.simulate(sdof(law), motion, duration=20.0, sample_rate=1000.0, accuracy=1e-3)
    rng, stamps = np.random.default_rng(2), np.arange(20_000) / 1000.0
    columns = {"B": run.base.acceleration[:, 2], "T": run.bodies["mass"].acceleration[:, 2]}
    of_run = stamps * (1.0 + rate) - 0.02  # its clock is 0.02 s ahead, and a second of it lasts 1 + rate
    told = [CubicSpline(run.time, y)(of_run) * (of_run > 0.0) + 0.05 * rng.standard_normal(20_000) for y in columns.values()]
    path = tmp_path / "long.csv"
    np.savetxt(path, np.column_stack([stamps, *told]), delimiter=",", header="time [s],B,T", comments="", fmt="%.8g")
    phrases = {"B": "base z m/s^2", "T": "body/mass z m/s^2"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wr.RecordWarning)
        test = wr.load_measured(path, channels=phrases)
        found = wr.correlate(run, test)
        again = wr.correlate(run, wr.load_measured(path, channels=phrases, start=-found.delay, clock=found.clock))
    # noise of 2 % moves the lag of a twelfth of the record by a fiftieth of a sample: 2e-5 s in 20 s
    assert found.clock - 1.0 == pytest.approx(rate, abs=2e-6)
    assert found.delay == pytest.approx(0.02, abs=1e-4)
    assert min(one.rating.overall for one in found.channels) > 0.94
    assert again.clock == pytest.approx(1.0, abs=2e-6)
    assert again.delay == pytest.approx(0.0, abs=1e-4)


def test_without_the_base_the_channel_that_fits_best_aligns(tmp_path, floor):
    only = {"T": CHANNELS["T"], "D": CHANNELS["D"]}
    found = wr.correlate(floor, measured_of(tmp_path, floor, late=0.004, channels=only))
    assert found.delay == pytest.approx(0.004, abs=1e-4)  # a tenth of the run's samples
    assert found.aligned_by in ("point rack_top, z", "mount m01, axial deflection")
    assert all(one.base is None for one in found.channels)


def test_the_statement_says_where_the_model_is_low(tmp_path, floor):
    louder = measured_of(tmp_path, floor, change=lambda name, values: values / 0.75 if name == "T" else values)
    found = wr.correlate(floor, louder)
    assert found.statement == "Model 25 % low between 2.6 and 99 Hz (point rack_top, z)."
    marks = {row[0][0]: row for row in found.table.marks()}
    assert float(marks["point rack_top, z"][2][0]) == pytest.approx(0.75, abs=0.01)
    assert len(found.ratings.rows) == len(found.channels) == 5


def test_a_sensor_upside_down_is_suspected(tmp_path, floor):
    found = wr.correlate(floor, measured_of(tmp_path, floor, change=lambda name, y: -y if name == "T" else y))
    (said,) = found.warnings
    assert said == 'drop: column "T" fits point rack_top, z better upside down: is its axis -z?'
    where = "from 3.7 to 23 Hz in 3 of 4 channels, not in point rack_top, z (better upside down)"
    assert found.statement == f"Model within 10 % of the measurement {where}."
    alone = wr.correlate(floor, measured_of(tmp_path, floor, change=lambda name, y: -y, channels={"T": CHANNELS["T"]}))
    assert alone.statement == "Model in no channel as measured: point rack_top, z (better upside down)."


@pytest.mark.parametrize("channels", [("B", "T"), ("T",)], ids="+".join)
@pytest.mark.parametrize("first", [-0.3, -0.03, 0.0, 0.01, 0.02])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_sign_is_sought_wherever_the_record_begins(tmp_path, floor, channels, first, sign):
    test = measured_of(
        tmp_path, floor, late=-first, channels={name: CHANNELS[name] for name in channels},
        change=lambda name, y: sign * y if name == "T" else y,
    )  # fmt: skip
    found = wr.correlate(floor, test)
    assert [one.delay.upside_down for one in found.channels] == [False] * (len(channels) - 1) + [sign < 0.0]
    assert found.delay == pytest.approx(-first, abs=1e-4)  # a tenth of the run's samples


@pytest.mark.parametrize("channels", [("B", "T"), ("T",), ("D",)], ids="+".join)
@pytest.mark.parametrize("first", [0.058, 0.07, 0.12, 0.18, 0.3])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_record_that_begins_behind_the_shock_is_told_rightly_or_not_compared(tmp_path, floor, channels, first, sign):
    rng = np.random.default_rng(5)

    def change(name, values):
        return (
            (1.0 if name == "B" else sign) * values
            + 0.01 * np.std(values) * rng.standard_normal(values.size)
            + (0.2 * rng.standard_normal(values.size) if name == "B" else 0.0)
        )

    mapped = {name: CHANNELS[name] for name in channels}
    test = measured_of(tmp_path, floor, late=-first, channels=mapped, change=change)
    stated = wr.correlate(floor, measured_of(tmp_path, floor, late=-first, channels=mapped, change=change, start=first))
    response = stated.channels[-1]
    assert response.delay.value == pytest.approx(0.0, abs=1e-3)
    assert response.delay.upside_down == (sign < 0.0)
    try:
        found = wr.correlate(floor, test)
    except wr.RecordError as error:
        assert f'column "{channels[-1]}" is not compared' in str(error)  # noqa: PT017
        assert "(--start)" in str(error)  # noqa: PT017
        assert first > 0.06 or channels == ("D",)  # the end of the pulse itself is told, in accelerations
        return
    for one in found.channels[channels[0] == "B" :]:
        assert one.delay.value == pytest.approx(-first, abs=1e-3)
        assert one.delay.upside_down == (sign < 0.0)


def test_another_base_is_said_before_the_model(tmp_path, floor):
    found = wr.correlate(floor, measured_of(tmp_path, floor, change=lambda name, y: 1.2 * y if name == "B" else y))
    base, model = found.statement.split(". ", 1)
    # 1 / 1.2, 0.5 % of which straight lines between samples lose; m = 1.2 - 1 / 1.2 and log10(1 + m) sqrt(pi) / 2 = 0.120
    assert base == "The base of the run does not move as the measured one does along z (rms 0.84 times, Russell 0.12)"
    assert model == "Model within 10 % of the measurement from 3.7 to 23 Hz in all 4 channels."


@pytest.mark.parametrize(("size", "said"), [(0.05, ""), (0.5, " along y (rms 0.00 times, Russell inf).")])
def test_a_direction_in_which_the_base_hardly_moves_makes_no_other_base(tmp_path, floor, size, said):
    time = np.arange(int(RATE * floor.time[-1])) / RATE
    velocity = {"D": np.where(time > 0.05, 1.0, 0.0), "R": size * np.sin(300.0 * time)}  # the run's along z; along y it rests
    channels = {"B": CHANNELS["B"], "T": CHANNELS["T"], "D": "base z m/s", "R": "base y m/s"}
    test = measured_of(tmp_path, floor, channels=channels, change=lambda name, values: velocity.get(name, values))
    assert wr.correlate(floor, test).other_base == (
        said and f"The base of the run does not move as the measured one does{said}"
    )


def test_a_channel_on_another_clock_is_named(tmp_path, floor):
    found = wr.correlate(floor, measured_of(tmp_path, floor, change=lambda n, y: np.roll(y, 2500) if n == "D" else y))
    assert any('column "D" fits +250' in text and "another clock" in text for text in found.warnings)


def test_another_test_is_not_aligned(tmp_path, floor):
    rng = np.random.default_rng(3)
    found = wr.correlate(floor, measured_of(tmp_path, floor, change=lambda n, y: rng.standard_normal(y.size)))
    assert found.delay == 0.0
    assert any("no delay makes column" in text and "(--start, --clock)" in text for text in found.warnings)
    assert found.statement.startswith("The base of the run does not move as the measured one")


def test_dead_and_saturated_channels_are_named(tmp_path, floor):
    def change(name, values):
        return 0.0 * values if name == "F" else np.clip(values, None, 0.6 * values.max()) if name == "T" else values

    found = wr.correlate(floor, measured_of(tmp_path, floor, change=change))
    assert [one.channel.column for one in found.channels] == ["B", "T", "D", "R"]
    assert any('column "F" is dead' in text for text in found.warnings)
    assert any('column "T" was saturated: its true peak is higher' in text for text in found.warnings)


def test_deflections_and_forces_count_from_the_start(tmp_path, floor):
    resting = {"D": -0.004, "F": -800.0, "R": 0.5}  # an instrument's own zero
    found = wr.correlate(floor, measured_of(tmp_path, floor, change=lambda n, y: y + resting.get(n, 0.0)))
    assert {one.rating.grade for one in found.channels} == {"excellent"}
    absolute = {**CHANNELS, "F": "mount/m01 axial absolute N"}
    found = wr.correlate(floor, measured_of(tmp_path, floor, change=lambda n, y: y + resting.get(n, 0.0), channels=absolute))
    force = next(one for one in found.channels if one.channel.column == "F")
    assert force.pair.measured[0] == pytest.approx(-800.0, abs=1.0)  # the run's force begins at zero


def test_what_this_run_does_not_have_is_another_models(tmp_path, floor):
    other = measured_of(tmp_path, floor, channels={"T": "point/mast z g"})
    with pytest.raises(wr.RecordError, match=r"mapped to the point 'mast', which this run does not have; its points: rack_top"):
        wr.correlate(floor, other)


def test_a_test_at_another_time_is_too_short_to_compare(tmp_path, floor):
    later = measured_of(tmp_path, floor, start=100.0)
    with pytest.raises(wr.RecordError, match=r"lasts from 100 to .* too short to compare. .*\(--start\)"):
        wr.correlate(floor, later, align=False)
