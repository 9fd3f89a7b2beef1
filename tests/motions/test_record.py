"""Measured records: units, channels, baselines, and one clear message for everything that is wrong with a file."""

import os
import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from wirerope_mj.foundation.errors import RecordError, RecordWarning
from wirerope_mj.motions import HalfSine, load_record, motion_from_dict

pytestmark = pytest.mark.quick

DATA = Path(__file__).parents[1] / "data"
G = 9.80665


@pytest.fixture
def record_file(tmp_path):
    """Writes a record and returns its path."""

    def write(text, name="record.csv"):
        path = tmp_path / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    return write


def test_units_and_channels_are_those_of_the_header():
    record = load_record(DATA / "deck_shock.csv", channels={"ax": "x", "ch3": "z"}, start=0.5)
    # milliseconds, m/s^2 along x and g along z; the first sample is played at 0.5 s whatever the file's clock says
    np.testing.assert_allclose(record.time, [0.5, 0.501, 0.502, 0.503, 0.504], rtol=1e-15)
    expected = [[0, 0, 0], [2, 0, G], [2, 0, 2 * G], [2, 0, 3 * G], [-1, 0, 0]]
    np.testing.assert_allclose(record.samples, expected, rtol=1e-15)
    np.testing.assert_allclose(record.acceleration(0.502), [[2.0, 0.0, 2 * G]], rtol=1e-9)
    assert record.duration == pytest.approx(0.004, rel=1e-12)
    assert record.end == 0.504
    np.testing.assert_array_equal(record.corners, record.time)
    assert record.shortest_time == pytest.approx(0.004, rel=1e-9)  # four times the interval of 1 ms


def test_without_channels_the_columns_named_after_axes_are_used():
    record = load_record(DATA / "deck_shock.csv")
    np.testing.assert_array_equal(record.samples[:, 0], [0.0, 2.0, 2.0, 2.0, -1.0])
    np.testing.assert_array_equal(record.samples[:, 1:], 0.0)


@pytest.mark.parametrize("name", ["z", "Z", "az", "a_z", "acc_z", "acceleration_z", "Acceleration Z"])
def test_axis_names_are_understood(record_file, name):
    record = load_record(record_file(f"Time [s],{name} [g]\n0,1\n1,1\n"))
    np.testing.assert_allclose(record.samples, [[0, 0, G], [0, 0, G]])


@pytest.mark.parametrize(
    ("unit", "factor"), [("m/s^2", 1.0), ("m/s2", 1.0), ("m/s²", 1.0), ("g", G), ("mm/s^2", 1e-3), ("mm/s2", 1e-3)]
)
@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_units_and_delimiters_are_understood(record_file, unit, factor, delimiter):
    text = f'\ufeff# a comment, with; signs\n\n"t [s]"{delimiter}"y [{unit}]"\r\n0{delimiter}-2\r\n\r\n1{delimiter} 3 \r\n'
    record = load_record(record_file(text))
    np.testing.assert_allclose(record.samples[:, 1], [-2 * factor, 3 * factor], rtol=1e-15)


def test_a_comment_in_another_encoding_does_not_hurt(record_file):
    record = load_record(record_file("# H\xf6he\ntime [s],z [g]\n0,1\n1,1\n".encode("latin-1")))
    assert record.samples[0, 2] == G


def test_a_sampled_half_sine_moves_the_base_like_the_half_sine(tmp_path):
    pulse = HalfSine(peak=15 * G, duration=0.011, direction="z")
    time = np.linspace(0.0, 0.011, 1101)
    path = tmp_path / "pulse.csv"
    np.savetxt(
        path, np.column_stack([time, pulse.acceleration(time)[:, 2]]), delimiter=",",
        header="time [s],z [m/s^2]", comments="", fmt="%.17g",
    )  # fmt: skip
    record = load_record(path)
    # Straight lines between samples cut off A (pi h / D)^2 / 12 of the sine's area at most: 7e-7 at 1100 intervals.
    for at in (0.004, 0.011, 0.5):
        np.testing.assert_allclose(record.velocity(at), pulse.velocity(at), rtol=1e-6)
        np.testing.assert_allclose(record.displacement(at), pulse.displacement(at), rtol=1e-6)


def test_baselines_take_off_what_they_say(record_file):
    path = record_file("time [s],x [m/s^2],z [m/s^2]\n0,1,3\n1,2,3\n2,4,3\n3,6,3\n")
    as_measured = load_record(path)
    assert as_measured.velocity(3.0)[0, 0] == pytest.approx(9.5, rel=1e-15)  # 1.5 + 8
    mean = load_record(path, baseline="mean")
    np.testing.assert_allclose(mean.samples[:, 0], np.array([1.0, 2.0, 4.0, 6.0]) - 13.0 / 4.0, atol=1e-15)
    np.testing.assert_array_equal(mean.samples[:, 2], 0.0)
    still = load_record(path, baseline="velocity")
    np.testing.assert_allclose(still.samples[:, 0], np.array([1.0, 2.0, 4.0, 6.0]) - 9.5 / 3, rtol=1e-14)
    np.testing.assert_allclose(still.velocity(9.0), 0.0, atol=1e-14)


def test_scale_multiplies_the_acceleration(record_file):
    path = record_file("time [s],x [m/s^2]\n0,1\n1,2\n")
    np.testing.assert_array_equal(load_record(path, scale=-3.0).samples[:, 0], [-3.0, -6.0])


def test_a_record_is_at_rest_before_it_starts_and_coasts_after_it():
    record = load_record(DATA / "deck_shock.csv", start=1.0)
    np.testing.assert_array_equal(record.acceleration([0.0, record.end, 2.0]), 0.0)
    np.testing.assert_array_equal(record.displacement([0.0, 1.0]), 0.0)
    velocity = 1e-3 * (1.0 + 4.0 + 0.5)
    np.testing.assert_allclose(record.velocity(2.0), [[velocity, 0.0, 0.0]], rtol=1e-9)
    moved = record.displacement(3.0) - record.displacement(2.0)
    np.testing.assert_allclose(moved, [[velocity, 0.0, 0.0]], rtol=1e-9)


def test_a_stored_record_can_point_to_a_copy_of_its_file(tmp_path):
    record = load_record(DATA / "deck_shock.csv", channels={"ch3": (0, 1, 1)}, scale=2.0, baseline="mean", start=0.1)
    total = record + HalfSine(peak=1.0, duration=0.1, direction="x")
    (source,) = total.files
    assert source == (DATA / "deck_shock.csv").absolute()
    (tmp_path / "motion.csv").write_bytes(source.read_bytes())

    stored = total.to_dict(files={source: "motion.csv"})
    assert stored["terms"][0] == {
        "kind": "record", "path": "motion.csv", "channels": {"ch3": [0.0, 1.0, 1.0]},
        "scale": 2.0, "baseline": "mean", "start": 0.1,
    }  # fmt: skip
    rebuilt = motion_from_dict(stored, folder=tmp_path)
    assert rebuilt.files == (tmp_path / "motion.csv",)
    time = np.linspace(0.0, 0.2, 100)
    np.testing.assert_array_equal(rebuilt.acceleration(time), total.acceleration(time))


def test_description_and_events_are_for_people():
    record = load_record(DATA / "deck_shock.csv", channels={"ch3": "z"})
    assert record.description == "record deck_shock.csv, 0.004 s, peak 3 g"
    assert [text for _, text in record.events] == ["record deck_shock.csv begins", "record deck_shock.csv ends"]


GOOD = "time [s],z [g]\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "record.csv: the file is empty. Expected a header"),
        ("# only a comment\n", "record.csv: the file is empty"),
        (GOOD, "record.csv: a record needs at least 2 rows of numbers, this one has 0"),
        (GOOD + "0,1\n", "a record needs at least 2 rows of numbers, this one has 1"),
        ("# c\n" + GOOD + "0,1\n\n1,nan\n2,1\n", 'line 5: nan in column "z"'),
        (GOOD + "0,1\n1,-inf\n", 'line 3: -inf in column "z"'),
        (GOOD + "0,1\nnan,1\n", 'line 3: nan in column "time"'),
        (GOOD + "0,1\n1,1\n0.5,1\n", "line 4: time 0.5 comes after 1.0; times must increase"),
        (GOOD + "0,1\n1,1\n1,2\n", "line 4: time 1.0 repeats the row before"),
        (GOOD + "0,1\n1,high\n", 'line 3: "high" in column "z" is not a number'),
        (
            GOOD + "0,1\n1,\n",
            'line 3: an empty cell in column "z"; have such samples filled.* gaps="fill" (--gaps fill)',
        ),
        (GOOD + "0,1\n,1\n", 'line 3: an empty cell in column "time"; its time is needed'),
        (
            "time [s];z [g]\n0;1.0\n1;1,5\n",
            'line 3: "1,5" in column "z" is not a number. Decimals are written with a point',
        ),
        (GOOD + "0,1\n1\n", "line 3: 1 cells where the header has 2 columns"),
        (GOOD + "0,1\n1_0,1\n", 'line 3: "1_0" in column "time" is not a number'),
        (
            "time [s],z\n0,1\n1,1\n",
            'line 1: column "z" has no unit. Say it with unit="g" (--unit g), or write it behind the name, for instance "z [',
        ),
        ("time,z [g]\n0,1\n1,1\n", 'line 1: column "time" has no unit.* known units: s, ms, us, min, h'),
        ("time [s],z [V]\n0,1\n1,1\n", 'column "z" has the unknown unit "V". Known units: m/s^2, m/s2, m/s²'),
        ("time [mm],z [g]\n0,1\n1,1\n", 'column "time" has the unknown unit "mm". Known units: s, ms, us, min, h'),
        ("z [g],x [g]\n1,0\n1,1\n", "line 1: no column is the time; one alone is called.* the columns are z [g], x [g]"),
        ("0,1\n1,1\n", "line 1: numbers begin here and no header stands above them"),
        (
            "time [s],ch1 [g]\n0,1\n1,1\n",
            "no column is named x, y or z; the columns are time, ch1. Say which one moves the base where, for instance "
            'channels={"ch1": "z"} (--channels ch1=z or, with one column, --direction z)',
        ),
        ("time [s]\n0\n1\n", "no column is named x, y or z; the columns are time"),
        ("time [s],x [g],ax [g]\n0,1,1\n1,1,1\n", '"ax" is a second column for direction x'),
        (bytes(range(256)), "line 1: control characters (NUL) stand where a table has text, as in a binary file, one that was"),
        (b"\x80\xff,b\n0,1\n", "line 1: no column is the time"),
        (b"PAR1\x15\x04,1\n0,1\n", "this is not a Parquet file, or it is damaged"),
        (GOOD + "0,1\n1,2,3\n", "line 3: 3 cells where the header has 2 columns. Decimals are written with a point"),
        (
            "time [s];z [g]\n0,1\n1,1\n",
            "line 2: 1 cells .* The header's cells are separated by semicolons, those of this",
        ),
        (GOOD + "0,1\n0.001,1e300\n", 'line 3: 1e300 in column "z" is no measured value; cut or repair'),
        (GOOD + "0,1\n1e300,1\n", 'line 3: 1e300 in column "time" is no measured value'),
    ],
)
def test_a_bad_file_gets_one_clear_message(record_file, text, message):
    pattern = re.escape(message).replace(r"\.\*", ".*")
    with pytest.raises(RecordError, match=pattern):
        load_record(record_file(text))


@pytest.mark.parametrize(
    ("header", "row"),
    [
        ("time [s],z [g]", "{t},{a}"),
        ("time [s],x [g],z [g]", "{t},{a},{a}"),
        ("time [s],z [g],note", "{t},{a},"),
    ],
)
def test_decimal_commas_between_commas_never_play_another_motion(record_file, header, row):
    rows = [row.format(t=f"{0.001 * i:.3f}", a=f"{np.sin(0.1 * i):.4f}").replace(".", ",") for i in range(200)]
    with pytest.raises(RecordError, match=r"line 2: \d cells where .* Decimals are written with a point"):
        load_record(record_file("\n".join([header, *rows])))


def test_rows_that_lack_a_cell_are_refused_even_if_it_is_not_used(record_file):
    text = "time [s],y [g],z [g],temperature\n0,1,2,20\n1,2,20\n"  # which one is missing, nobody knows
    with pytest.raises(RecordError, match="line 3: 3 cells where the header has 4 columns"):
        load_record(record_file(text))


def test_a_scale_beyond_all_measure_is_refused(record_file):
    with pytest.raises(ValueError, match=r"`scale` makes 1e\+300 times a peak of 9.807 m/s\^2"):
        load_record(record_file(GOOD + "0,0\n1,1\n"), scale=1e300)


def test_a_start_where_samples_fall_on_one_instant_is_refused(record_file):
    path = record_file(GOOD + "0,0\n0.001,1\n0.002,0\n")
    with pytest.raises(ValueError, match=r"`start` is so far from 0 that its last digit, 1\.6e\+04 s.* the 0\.001 s between"):
        load_record(path, start=1e20)
    assert load_record(path, start=-1.7e8 + 0.1).time[0] == -1.7e8 + 0.1


def test_empty_cells_and_nan_are_filled_with_straight_lines_only_on_request(record_file):
    rows = ["0,1,0", "1,2,", "2,NaN,4", "3, ,6", "4,8,8"]
    path = record_file("time [s],x [m/s^2],z [m/s^2]\n" + "\n".join(rows))
    with pytest.raises(RecordError, match='line 3: an empty cell in column "z"'):
        load_record(path)
    with pytest.warns(RecordWarning) as found:
        record = load_record(path, gaps="fill")
    assert [str(item.message).split(": ", 1)[1] for item in found] == [
        '2 samples missing in column "x" (at 2 s) filled with straight lines.',
        '1 sample missing in column "z" (at 1 s) filled with straight lines.',
    ]
    assert all(item.filename == __file__ for item in found)  # the line that loaded it
    # each column on its own: what is there in one is not lost because the other has a gap
    np.testing.assert_allclose(record.samples[:, 0], [1.0, 2.0, 4.0, 6.0, 8.0], rtol=1e-15)
    np.testing.assert_allclose(record.samples[:, 2], [0.0, 2.0, 4.0, 6.0, 8.0], rtol=1e-15)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("0,\n1,1\n2,1\n", '1 sample missing in column "z", also at the beginning, where no straight line'),
        ("0,1\n1,1\n2,nan\n", "also at the end, where no straight line"),
        ("0,1\n,1\n2,\n", 'line 3: an empty cell in column "time"'),
        ("0,1\n1,\n2,inf\n", 'line 4: inf in column "z"'),
        ("0,1\n1,\n2,high\n", 'line 4: "high" in column "z" is not a number'),
        ("0,1\n1,\n1,1\n", "line 4: time 1.0 repeats the row before"),
    ],
)
def test_what_is_wrong_beside_a_gap_is_still_refused(record_file, rows, message):
    with pytest.raises(RecordError, match=re.escape(message)):
        load_record(record_file(GOOD + rows), gaps="fill")


def test_the_bad_line_of_a_long_record_is_found(record_file):
    rows = [f"{i / 1000},1" for i in range(20_000)]
    rows[12_345] = "12.345,NaN"
    with pytest.raises(RecordError, match="line 12347: NaN in column"):
        load_record(record_file(GOOD + "\n".join(rows)))


def test_columns_that_are_not_used_may_hold_anything(record_file):
    path = record_file("time [s],z [g],note\n0,1,ok\n1,1,nan\n")
    assert load_record(path).samples[1, 2] == G


def test_a_channel_that_does_not_exist_is_named(record_file):
    path = record_file("time [s],ch1 [g],ch2 [g],ch2 [g]\n0,1,1,1\n1,1,1,1\n")
    with pytest.raises(RecordError, match='line 1: there is no column "ch3"; the columns are ch1, ch2, ch2'):
        load_record(path, channels={"ch3": "z"})
    with pytest.raises(RecordError, match='there is no column "time"'):
        load_record(path, channels={"time": "z"})
    with pytest.raises(RecordError, match='there are 2 columns "ch2"'):
        load_record(path, channels={"ch2": "z"})


def test_a_missing_file_and_a_folder_are_no_records(tmp_path):
    with pytest.raises(RecordError, match="gone.csv: no such file"):
        load_record(tmp_path / "gone.csv")
    with pytest.raises(RecordError, match="cannot be read"):
        load_record(tmp_path)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"baseline": "linear"}, "`baseline` must be one of 'none', .*'highpass', got 'linear'"),
        ({"scale": 0.0}, "`scale` must not be zero"),
        ({"start": np.nan}, "`start` must be a finite number, got nan"),
        ({"channels": {}}, "`channels` must name at least one column"),
        ({"channels": {"a": "z", "b": (0, 0, 2)}}, "`channels` gives a and b the same direction z"),
        ({"channels": {"a": "up"}}, "`direction` must be"),
    ],
)
def test_arguments_out_of_range_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        load_record(DATA / "deck_shock.csv", **arguments)


def test_the_path_that_is_stored_does_not_depend_on_the_current_folder(record_file, monkeypatch):
    path = record_file("time [s],x [m/s^2]\n0,1\n1,2\n")
    monkeypatch.chdir(path.parent)
    stored = load_record(path.name).to_dict()
    monkeypatch.chdir(os.sep)
    assert motion_from_dict(stored).samples[1, 0] == 2.0


NUMBERS = np.sin(np.linspace(0.0, 9.0, 40)).round(4)  # [g]


@pytest.mark.parametrize(("text", "stated"), [
    ("\n".join(f"{0.005 * i:.3f} {v}" for i, v in enumerate(NUMBERS)), {"columns": "time [s], z [g]"}),
    ("\n".join(f"{5 * i},{v}" for i, v in enumerate(NUMBERS)), {"columns": "time [ms], z [g]"}),
    ("\n".join(f"{5 * i};{v}".replace(".", ",") for i, v in enumerate(NUMBERS)), {"columns": "t [ms], z [g]"}),
    ("\n".join(map(str, NUMBERS)), {"columns": "z [g]", "interval": 0.005}),
    ("\n".join(str(v).replace(".", ",") for v in NUMBERS), {"columns": "z [g]", "interval": 0.005}),
    ("# rig 7\n" + "\n".join(f"{v}, 0.0" for v in NUMBERS), {"columns": "z [g], x [g]", "interval": 0.005}),
    ("40 0.005\n" + "\n".join(map(str, NUMBERS)), {"columns": "z [g]"}),
    ("40 0.005\n" + "\n".join(" ".join(map(str, row)) for row in NUMBERS.reshape(5, 8)), {"columns": "z [g]"}),
    ("40, 0.005\n" + "\n".join(f"{v},0" for v in NUMBERS), {"columns": "z [g], y [g]"}),
    ("\n".join(map(str, NUMBERS)), {"interval": 0.005, "unit": "g", "channels": {"column 1": "z"}}),
])  # fmt: skip
def test_numbers_without_a_header_are_the_columns_that_are_stated(tmp_path, text, stated):
    path = tmp_path / "r.txt"
    path.write_text(text, encoding="utf-8")
    with warnings.catch_warnings(action="ignore"):
        record = load_record(path, **stated)
        again = motion_from_dict(record.to_dict())  # as a run's folder holds it
    np.testing.assert_allclose(record.samples[:, 2], G * NUMBERS, rtol=1e-12)
    np.testing.assert_allclose(record.time, 0.005 * np.arange(40), atol=1e-12)
    np.testing.assert_array_equal(again.samples, record.samples)


@pytest.mark.parametrize(("text", "stated", "message"), [
    ("0 1\n1 2", {}, r"say it by columns=\"time \[s\], z \[g\]\" \(--columns\), or without a time interval="),
    ("1\n2\n3", {"columns": "z [g]"}, r"no column is the time. Say the seconds from sample to sample by interval="),
    ("3 0.1\n1\n2\n3", {"columns": "z [g]", "interval": 0.2}, "3 samples 0.1 s apart, and interval= says 0.2 s"),
    ("0 1\n1 2 3\n2 1", {"columns": "time [s], z [g]"}, "line 2: there are not 2 numbers here"),
    ("t, z\n0, 1\n1, 2", {"columns": "time [s], z [g]"}, r"line 1: \"t, z\" is no row of numbers. columns= and interval="),
    ("0 1\n1 2", {"columns": "time [s], z [g]", "interval": 1.0}, "holds a time, and interval= .* states another"),
    ("1\n2", {"interval": 0.1, "channels": {"column 1": "z"}}, r"no unit. Say it with unit=\"g\" \(--unit g\)"),
])  # fmt: skip
def test_numbers_without_a_header_that_do_not_fit_what_is_stated_are_refused(tmp_path, text, stated, message):
    path = tmp_path / "r.txt"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RecordError, match=message):
        load_record(path, **stated)
