"""Measured responses: columns become channels in SI with the signs of a run; units, axes and signs are asked for."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import scipy.io
from uff_files import history

import wirerope_mj as wr
from wirerope_mj.foundation.xlsx_rows import xlsx_rows

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY
TIME = np.arange(2000) / 1000.0
WAVE = 3.0 * np.exp(-2.0 * TIME) * np.sin(2.0 * np.pi * 8.0 * TIME)
BASE = np.where(TIME < 0.02, 10.0 * np.sin(np.pi * TIME / 0.02), 0.0)
MAP = {"A0": "base z g", "A1": "point/rack_top -z g", "F1": "mount/m1 axial kN", "D1": "mount/m1 axial mm"}


def table():
    return {"time [s]": TIME + 5.0, "A0": BASE, "A1": WAVE, "F1": WAVE / 3.0, "D1": 2.0 * WAVE}


def write(path, columns=None):
    columns = columns or table()
    if path.suffix == ".csv":
        np.savetxt(
            path,
            np.column_stack(list(columns.values())),
            delimiter=",",
            header=",".join(columns),
            comments="",
            fmt="%.17g",
        )
    elif path.suffix == ".mat":
        scipy.io.savemat(path, {name.partition(" ")[0]: values for name, values in columns.items()} | {"note": "test"})
    elif path.suffix == ".parquet":
        pq.write_table(pa.table({name.replace(" [s]", "_s"): values for name, values in columns.items()}), path)
    else:
        import openpyxl

        book = openpyxl.Workbook()
        book.active.append(list(columns))
        for row in zip(*columns.values(), strict=True):
            book.active.append([float(value) for value in row])
        book.save(path)
    return path


@pytest.mark.parametrize("ending", ["csv", "parquet", "xlsx", "mat"])
def test_columns_become_channels_in_si_with_the_signs_of_the_map(tmp_path, ending):
    path = write(tmp_path / f"test.{ending}")
    channels = dict(MAP)
    if ending == "mat":  # MATLAB's names hold no unit, not even the time's
        columns = table()
        scipy.io.savemat(path, {"t_s": columns.pop("time [s]"), **columns})
    measured = wr.load_measured(path, channels=channels)
    assert [one.key for one in measured.channels] == [
        "base acceleration z", "point/rack_top acceleration z", "mount/m1 force z", "mount/m1 deflection z",
    ]  # fmt: skip
    # to a rounding of a product of two factors
    np.testing.assert_allclose(measured["A1"].values, -WAVE * G, rtol=1e-15)
    np.testing.assert_allclose(measured["mount/m1 force z"].values, WAVE / 3.0 * 1e3, rtol=1e-15)
    np.testing.assert_allclose(measured["D1"].values, 2.0 * WAVE * 1e-3, rtol=1e-15)
    assert measured["A0"].time[0] == 0.0  # the first sample is at `start`, whatever the file's clock says
    assert measured["A0"].rate == pytest.approx(1000.0, rel=1e-12)
    assert measured.name == "test"
    assert not measured.warnings


@pytest.mark.parametrize("ending", ["csv", "parquet", "xlsx"])
def test_the_base_of_a_file_is_a_motion(tmp_path, ending):
    measured = wr.load_measured(write(tmp_path / f"t.{ending}"), channels=MAP, start=0.5)
    base = measured.base
    assert base.start == 0.5
    np.testing.assert_allclose(base.acceleration(TIME + 0.5)[:, 2], BASE * G, atol=1e-9 * G)  # instants shift by roundings
    again = wr.motions.motion_from_dict(base.to_dict())
    np.testing.assert_array_equal(again.samples, base.samples)


def test_a_sensor_upside_down_moves_the_base_the_other_way(tmp_path):
    measured = wr.load_measured(write(tmp_path / "t.csv"), channels={"A0": "base -x g"})
    np.testing.assert_allclose(measured.base.samples[:, 0], -BASE * G, rtol=1e-15, atol=0.0)


def test_universal_files_hold_every_quantity(tmp_path):
    path = tmp_path / "t.uff"
    parts = [
        history(1, "z", BASE, unit="g"),
        history(7, "x", WAVE, unit="mm", kind=8),
        history(7, "z", WAVE, unit="N", kind=13),
    ]
    path.write_bytes(b"".join(parts))
    measured = wr.load_measured(
        path, channels={"1:z": "base z", "7:x displacement": "body/floor x", "7:z force": "mount/m1 shear"}
    )
    assert [one.quantity for one in measured.channels] == ["acceleration", "displacement", "force"]
    np.testing.assert_allclose(measured["7:x displacement"].values, 1e-3 * WAVE, atol=1e-9)  # the text has six digits
    with pytest.raises(wr.RecordError, match=r'no history "7:x"; the file holds 1:z, 7:x displacement, 7:z force'):
        wr.load_measured(path, channels={"7:x": "body/floor x mm"})


def test_the_clock_has_a_start_and_a_rate_of_its_own(tmp_path):
    measured = wr.load_measured(write(tmp_path / "t.csv"), channels={"A1": "point/p z g"}, start=-0.1, clock=1.0001)
    np.testing.assert_allclose(measured["A1"].time, -0.1 + 1.0001 * TIME, rtol=0, atol=1e-12)
    for clock in ({"start": 9e15}, {"clock": 1e-323}, {"clock": 1e308}):
        with pytest.raises(ValueError, match="must leave the samples apart|`clock` must lie between"):
            wr.load_measured(write(tmp_path / "t.csv"), channels={"A1": "point/p z g"}, **clock)


def test_what_looks_wrong_is_said_of_the_column(tmp_path):
    high = np.clip(WAVE, None, 1.5)
    rng = np.random.default_rng(1)
    spiky = 0.01 * rng.standard_normal(TIME.size)
    spiky[700] = 4.0
    fast = np.sin(2.0 * np.pi * 470.0 * TIME)
    columns = {
        "time [s]": TIME,
        "A1 [g]": high,
        "A2 [g]": 0.0 * TIME,
        "A3 [g]": spiky,
        "A4 [g]": fast,
        "A5 [g]": WAVE + 0.5,
    }
    path = write(tmp_path / "t.csv", columns)
    phrases = {f"A{n}": f"point/p{n} z" for n in range(1, 6)}
    with pytest.warns(wr.RecordWarning) as caught:
        measured = wr.load_measured(path, channels=phrases)
    said = "\n".join(str(one.message) for one in caught)
    assert len(measured.warnings) == len(caught) == 5
    for text in (
        '"A1" 40 samples in a row', '"A2" all samples are 0', '"A3" one sample of 4 g', '"A4" its energy lies about 47',
        '"A5" it rests at 0.4983 g',
    ):  # fmt: skip
        assert text in said, (text, said)
    assert measured["A1"].saturated.sum() == np.count_nonzero(high == 1.5)
    with pytest.warns(wr.RecordWarning):
        taken_off = wr.load_measured(path, channels=phrases, baseline="rest")
    assert abs(taken_off["A5"].values[-500:].mean()) < 0.01 * G  # what is left of the wave there
    assert not any('"A5"' in text for text in taken_off.warnings)


@pytest.mark.parametrize(
    ("channels", "error", "message"),
    [
        (
            {"A1": "point/p z"},
            wr.RecordError,
            r'column "A1" has no unit. State it in the header, "A1 ',
        ),
        ({"B1": "point/p z g"}, wr.RecordError, r'no column "B1"; the columns are A0, A1, F1, D1'),
        ({"A1": "rack z g"}, ValueError, "begins with 'rack', which is neither base nor body/, point/ or mount/NAME"),
        ({"A1": "point/p g"}, ValueError, "does not say the axis"),
        ({"A1": "point/p x z g"}, ValueError, "states two of axis: x and z"),
        ({"A1": "mount/m1 z mm"}, ValueError, "the axis of a mount is roll, shear or axial"),
        ({"A1": "point/p axial g"}, ValueError, "the axis of a point is x, y or z"),
        ({"A1": "mount/m1 axial g"}, ValueError, "has the unit g, which is none of anything measured at a mount"),
        ({"A1": "point/p force z N"}, ValueError, "asks for the force of a point, which has acceleration"),
        ({"A1": "point/p z furlong"}, ValueError, "has the word 'furlong', which is no axis, quantity or unit"),
        ({"A1": ""}, ValueError, "does not say what the column is"),
        ({}, ValueError, "must say what at least one column is"),
        ({"A0": "base z g", "A1": "base z g"}, ValueError, "'base acceleration z' for A0 and A1"),
    ],
)
def test_what_is_not_said_is_asked_for(tmp_path, channels, error, message):
    with pytest.raises(error, match=message):
        wr.load_measured(write(tmp_path / "t.csv"), channels=channels)


def test_a_phrase_overrules_the_unit_of_the_header(tmp_path):
    path = write(tmp_path / "t.csv", {"time [s]": TIME, "A1 [V]": WAVE})
    assert wr.load_measured(path, channels={"A1": "point/p z g"})["A1"].unit == "g"
    with pytest.raises(wr.RecordError, match=r'has the unit "V", which is none of what point/p can have'):
        wr.load_measured(path, channels={"A1": "point/p z"})


def test_too_few_samples_are_no_response(tmp_path):
    path = write(tmp_path / "t.csv", {"time [s]": TIME[:9], "A1 [g]": WAVE[:9]})
    with pytest.raises(wr.RecordError, match="needs at least 16 samples, this one has 9"):
        wr.load_measured(path, channels={"A1": "point/p z"})


def test_a_base_is_played_on_its_own_clock_or_not_at_all(tmp_path):
    path = write(tmp_path / "t.csv")
    with pytest.raises(wr.RecordError, match="its clock is changed by 1.001"):
        _ = wr.load_measured(path, channels=MAP, clock=1.001).base
    with pytest.raises(wr.RecordError, match="no column is mapped to the base's acceleration"):
        _ = wr.load_measured(path, channels={"A1": "point/p z g"}).base


def test_tables_without_one_time_are_refused(tmp_path):
    path = tmp_path / "t.parquet"
    pq.write_table(pa.table({"A1 [g]": WAVE, "A2 [g]": WAVE}), path)
    with pytest.raises(wr.RecordError, match="no column is the time"):
        wr.load_measured(path, channels={"A1": "point/p z"})
    pq.write_table(pa.table({"t [s]": TIME[::-1].copy(), "A1 [g]": WAVE}), path)
    with pytest.raises(wr.RecordError, match="times must increase"):
        wr.load_measured(path, channels={"A1": "point/p z"})


def test_sheets_have_one_reader(tmp_path):
    path = write(tmp_path / "t.xlsx", {"time [s]": TIME[:3], "A1 [g]": WAVE[:3]})
    assert xlsx_rows(path)[1][0] == (1, ["time [s]", "A1 [g]"])


@pytest.mark.parametrize("late", [0.0, 0.01])
def test_a_response_that_rings_to_its_end_rests_where_it_stood_before(tmp_path, late):
    # it is near its level for 6 % of its time only, and swings too few times to be a vibration, whose mean would do
    time = np.linspace(0.0, 0.6, 6001)
    after = np.maximum(time - 0.04 - late, 0.0)
    values = 0.1 + np.where(after > 0.0, 0.88 * np.exp(-4.0 * after) * np.sin(41.0 * after), 0.0)
    values += 0.01 * np.random.default_rng(1).standard_normal(time.size)
    np.savetxt(tmp_path / "t.csv", np.column_stack([time, values]), delimiter=",", header="time [s],A [g]", comments="")
    channel = wr.load_measured(tmp_path / "t.csv", channels={"A": "body/rack z"}, baseline="rest")["A"]
    left = channel.values[: int(1e4 * (0.04 + late))].mean() / wr.STANDARD_GRAVITY
    assert abs(left) < 4.0 * 0.01 / np.sqrt(400)  # four standard errors of the mean of what stands before
