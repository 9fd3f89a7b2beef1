"""Tables as other programs write them: read by position and unit whatever the container, or refused by name with a remedy."""

import datetime
import re
import sys
import warnings

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.engine.from_tables.sheet import read_sheet
from wirerope_mj.foundation.units import UNITS, find_unit, split_unit
from wirerope_mj.motions.psd_lines import psd_points

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY
STEP, COUNT, PEAK = 1e-3, 400, 9.75
TIME = STEP * np.arange(COUNT)
WAVE = np.where((TIME > 0.1) & (TIME < 0.15), PEAK * np.sin(np.pi * (TIME - 0.1) / 0.05), 0.0)
WAVE[125] = PEAK


def text(header, columns, separator=",", decimal=".", end="", encoding="utf-8", newline="\n"):
    """Return a file of text: arrays are printed with five digits, or as the format beside them says."""
    cells = []
    for column in columns:
        values, form = column if isinstance(column, tuple) else (column, "{:.5f}")
        cells.append([v if isinstance(v, str) else form.format(v).replace(".", decimal) for v in values])
    return newline.join([header, *(separator.join(row) + end for row in zip(*cells, strict=True)), ""]).encode(encoding)


def quoted(values):
    return [f'"{value:.5f}"'.replace(".", ",") for value in values]


CLOCK = [f"2026-02-01 23:59:59.{700 + i:03d}" if i < 300 else f"2026-02-02 00:00:00.{i - 300:03d}" for i in range(COUNT)]
PEER = "PEER NGA STRONG MOTION DATABASE RECORD\ninvented\nACCELERATION TIME SERIES IN UNITS OF G\n{}\n" + "\n".join(
    " ".join(f"{v:.7E}" for v in WAVE[i : i + 5]) for i in range(0, COUNT, 5)
)
VALUES = "\n".join("".join(f"{v:10.5f}" for v in G * WAVE[i : i + 8]) for i in range(0, COUNT, 8)) + "\n"
CSMIP = "Corrected accelerogram  Chan  1: 90 Deg\n" + 24 * "text\n" + 19 * "   0   0\n"
CSMIP += f"  400 points of accel data equally spaced at  .001 sec, in m/sec2. (8f10.5)\n{VALUES}"
REAL = [-999.0] * 33 + [1e3 * STEP] + [-999.0] * 66
COSMOS = (
    "Corrected acceleration (Format v01.20 with 13 text lines)\n 100 Real-header values follow on  20 lines, Format= (5F14.6)\n"
)
COSMOS += "".join("".join(f"{v:14.6f}" for v in REAL[i : i + 5]) + "\n" for i in range(0, 100, 5))
COSMOS += f"  400 acceleration pts, approx   0 secs, units=m/sec2(04),Format=(8F10.5)\n{VALUES}End-of-data\n"


def labview(columns, decimal):
    head = f"LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t{decimal}\nX_Columns\t{columns}\n"
    head += "***End_of_Header***\t\n\t\nChannels\t2\t\nY_Unit_Label\tN\tg\t\n"
    head += "X0\t0.0\t0.0\t\nDelta_X\t0.001\t0.001\t\n***End_of_Header***\t\t\t\n"
    names = "X_Value\tForce\tX_Value\tz\tComment" if columns == "Multi" else "X_Value\tForce\tz\tComment"
    rows = {
        "No": [f"\t{v / 2:.5f}\t{v:.5f}" for v in WAVE],
        "One": [f"{t:.5f}\t{v / 2:.5f}\t{v:.5f}" for t, v in zip(TIME, WAVE, strict=True)],
        "Multi": [f"{t:.5f}\t{v / 2:.5f}\t{t:.5f}\t{v:.5f}\t" for t, v in zip(TIME, WAVE, strict=True)],
    }
    return (f"{head}{names}\n" + "\n".join(rows[columns])).replace(".", decimal).encode()


BOTH = (TIME, WAVE)
TEXTS = {
    "decimal commas": text("Zeit (s)\tZ (g)", BOTH, "\t", ","),
    "spaces": text("time [s] z [g]", BOTH, "  "),
    "bars": text("time [s]|z [g]", BOTH, "|"),
    "header in the last comment": b"# by hand\n" + text("# time [s], z [g]", BOTH),
    "comma comment over spaces": text("% time [s], z [g]", BOTH, " "),
    "units in a second row": text("Time,Z\ns,g", BOTH),
    "units in brackets in a second row": text("Time;Z\n[s];[g]", BOTH, ";"),
    "below a logger's own lines": text("Logger 7\nSerial,4711\nRate,1000\n\nTime,T,Z\ns,°C,g", (TIME, 0.0 * TIME + 20.0, WAVE)),
    "milliseconds": text("Time (ms),Z (g)", (1e3 * TIME, WAVE)),
    "microseconds, latin-1": text("Time (µs),Z (m/s²)", (1e6 * TIME, G * WAVE), encoding="latin-1"),
    "minutes": text("Time [min],Z [g]", ((TIME / 60.0, "{:.10f}"), WAVE)),
    "slash": text("t/s;a_z/(m/s²)", (TIME, G * WAVE), ";"),
    "spaced slash": text("Zeit / s;Z / g", BOTH, ";"),
    "word": text("Zeit in s;Z in g", BOTH, ";", ","),
    "underscores": text("time_ms,acc_z_g", (1e3 * TIME, WAVE)),
    "capitals": text("TIME (SEC),Z (G)", BOTH),
    "UTF-16": text("time [s]\tz [g]", BOTH, "\t", encoding="utf-16"),
    "UTF-16 without its mark": text("time [s]\tz [g]", BOTH, "\t", encoding="utf-16-le"),
    "unnamed index": text(",time [s],z [g]", (([str(i) for i in range(COUNT)]), *BOTH)),
    "unnamed column": text("time [s],,z [g]", (TIME, WAVE / 2.0, WAVE)),
    "separator behind the header": text("time [s],z [g],", BOTH),
    "separator behind the rows": text("time [s];z [g]", BOTH, ";", ",", end=";"),
    "separator behind all": text("time [s],z [g],", BOTH, end=","),
    "rows of empty cells": text("time [s],z [g]", BOTH, end="\n,"),
    "quoted decimal commas": text('"time [s]","z [g]"', (quoted(TIME), quoted(WAVE))),
    "line break in a quoted name": text('"time\n[s]","z\n[g]"', BOTH),
    "two rows of names": text("Time [s],Acceleration [g],\n,x,z", (TIME, WAVE / 2.0, WAVE)),
    "two rows of names above units": text("Time,Acceleration,\n,x,z\ns,g,g", (TIME, WAVE / 2.0, WAVE)),
    "repeated names": text("time [s],acc [g],acc [g]\n,x,z", (TIME, WAVE / 2.0, WAVE)),
    "time behind": text("z [g],time [s]", (WAVE, TIME)),
    "date and time": text("Timestamp,z [g]", (CLOCK, WAVE)),
    "German date": text("Datum/Zeit;z [g]", ([f"01.02.2026 10:00:00,{i:03d}" for i in range(COUNT)], WAVE), ";", ","),
    "time of day": text("Date,Time,z [g]", (["2026-02-01"] * COUNT, [f"10:00:00.{i:03d}" for i in range(COUNT)], WAVE)),
    "old ends of lines": text("time [s],z [g]", BOTH, newline="\r"),
    "separator said": text("sep=;\ntime [s];z [g]", BOTH, ";", ","),
    **{f"LabVIEW {columns} {sign}": labview(columns, sign) for columns in ("No", "One", "Multi") for sign in ".,"},
}
EARTHQUAKES = {
    "PEER": PEER.format("NPTS=    400, DT=   .0010 SEC").encode(),
    "older PEER": PEER.format("  400   0.0010    NPTS, DT").encode(),
    "CSMIP": CSMIP.encode(),
    "CSMIP with velocities": (CSMIP + CSMIP[CSMIP.index("  400") :].replace("accel", "veloc").replace("sec2", "sec")).encode(),
    "COSMOS": COSMOS.encode(),
}


def check(path, tolerance=1e-6, **options):
    """Load a record and hold it against the wave, within five printed digits."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wr.RecordWarning)
        record = wr.load_record(path, **options)
    np.testing.assert_allclose(record.samples[:, 2], G * WAVE, atol=2.0 * G * 1e-5)
    np.testing.assert_allclose(record.time, TIME, atol=tolerance)
    return record


@pytest.mark.parametrize("content", TEXTS.values(), ids=TEXTS)
def test_texts_are_read_by_position_and_unit(tmp_path, content):
    (tmp_path / "r.csv").write_bytes(content)
    check(tmp_path / "r.csv")


@pytest.mark.parametrize("content", EARTHQUAKES.values(), ids=EARTHQUAKES)
def test_records_of_earthquakes_are_read(tmp_path, content):
    (tmp_path / "r.txt").write_bytes(content)
    check(tmp_path / "r.txt", channels={"acceleration": "z"})


def workbook(path, rows, *, merged=(), cover=False):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    if cover:
        book.active.append(["tested by", "a person"])
        book.create_sheet("data")
    sheet = book.worksheets[-1]
    for row in rows:
        sheet.append(row)
    for cells in merged:
        sheet.merge_cells(cells)
    book.save(path)


NUMBERS = [list(row) for row in zip(TIME.tolist(), (WAVE / 2.0).tolist(), WAVE.tolist(), strict=True)]
START = datetime.datetime(2026, 2, 1, 10)
BOOKS = {
    "empty cell in the header": ([["time [s]", None, "z [g]"], *NUMBERS], {}),
    "unnamed index": ([[None, "time [s]", "x [g]", "z [g]"], *([i, *row] for i, row in enumerate(NUMBERS))], {}),
    "merged cells": (
        [["Time [s]", "Acceleration [g]"], [None, "x", "z"], *NUMBERS], {"merged": ("A1:A2", "B1:C1")},
    ),
    "title, empty rows and a row of units": (
        [["Drop test"], [], [None, "Time", "x", "z"], [None, "s", "g", "g"], *([None, *row] for row in NUMBERS)],
        {"merged": ("A1:D1",)},
    ),
    "cover": ([["time [s]", "x [g]", "z [g]"], *NUMBERS], {"cover": True}),
    "notes": ([["time [s]", "note", "z [g]"], *([t, "start" if t == 0.0 else None, z] for t, _, z in NUMBERS)], {}),
    "numbers as text": ([["time [s]", "z [g]"], *([f"{n:.5f}".replace(".", ",") for n in (t, z)] for t, _, z in NUMBERS)], {}),
    "dates": ([["Time", "z [g]"], *([START + datetime.timedelta(seconds=t), z] for t, _, z in NUMBERS)], {}),
}  # fmt: skip


@pytest.mark.parametrize("name", BOOKS)
@pytest.mark.parametrize("file", ["r.xlsx", "r.csv"])
def test_a_grid_of_a_workbook_is_read_by_position(tmp_path, name, file):
    rows, options = BOOKS[name]
    workbook(tmp_path / "r.xlsx", rows, **options)
    check((tmp_path / "r.xlsx").rename(tmp_path / file))


def test_fields_of_structs_and_columns_of_matrices_are_channels(tmp_path):
    from scipy.io import savemat

    path = tmp_path / "r.mat"
    savemat(path, {"test": {"time_s": TIME, "acc": WAVE, "fs": 1000.0}})
    for name in ("acc", "test.acc"):
        check(path, channels={name: "z"}, unit="g")
    savemat(path, {"run": {"dt": STEP, "acc_z_m_s2": G * WAVE}})
    check(path)
    called = {"names": np.array(["time", "x", "z"], object), "units": np.array(["s", "g", "g"], object)}
    savemat(path, {"data": np.column_stack([TIME, WAVE / 2.0, WAVE])} | called)
    check(path)
    savemat(path, {"runs": [{"t_s": TIME, "a": WAVE}, {"t_s": TIME + 1.0, "a": -WAVE}]})
    check(path, channels={"runs(1).a": "z"}, unit="g")
    savemat(path, {"test": {"time": TIME, "acc": WAVE}})
    with pytest.raises(wr.RecordError, match=r"no column is named x, y or z; the columns are test\.time, test\.acc"):
        wr.load_record(path, unit="g")
    with pytest.raises(wr.RecordError, match='column "test.time" has no unit. .* "test.time_s"'):
        wr.load_record(path, channels={"acc": "z"}, unit="g")


def write_tdms(path):
    from nptdms import ChannelObject, TdmsWriter

    stated = {"wf_increment": STEP, "unit_string": "g"}
    slow = ChannelObject("rig", "warmth", np.arange(9.0), {"wf_increment": 0.1, "unit_string": "degC"})
    with TdmsWriter(path) as file:
        file.write_segment([slow, ChannelObject("rig", "z", WAVE, stated), ChannelObject("rig", "x", WAVE / 2.0, stated)])


def write_hdf5(path):
    import h5py

    with h5py.File(path, "w") as file:
        channel = file.create_dataset("run 1/table/acc_z", data=G * WAVE)
        channel.attrs.update({"units": "m/s^2", "sample_rate": 1.0 / STEP})


def write_matlab_73(path):
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in {"test/t_s": TIME, "test/acc_z_g": WAVE}.items():
            file.create_dataset(name, data=values[np.newaxis]).attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")


def write_seismic(kind):
    def write(path):
        with warnings.catch_warnings(action="ignore"):  # of its own
            from obspy import Stream, Trace
        Stream([Trace(WAVE.astype(np.float32), {"channel": "Z", "delta": STEP})]).write(str(path), format=kind)

    return write


def write_knet(path):
    said = {
        "Origin Time": "2026/01/02 03:04:05", "Lat.": "38.9", "Long.": "140.6", "Depth. (km)": "10", "Mag.": "5.9",
        "Station Code": "AKT019", "Station Lat.": "39.0", "Station Long.": "140.5", "Station Height(m)": "96",
        "Record Time": "2026/01/02 03:04:20", "Sampling Freq(Hz)": f"{1.0 / STEP:.0f}Hz", "Duration Time(s)": "1",
        "Dir.": "U-D", "Scale Factor": "7840(gal)/8223790", "Max. Acc. (gal)": "980.0",
        "Last Correction": "2026/01/02 03:04:05", "Memo.": "",
    }  # fmt: skip
    counts = np.rint(G * WAVE * 100.0 * 8223790 / 7840).astype(int)
    lines = [f"{name:<18}{value}".rstrip() for name, value in said.items()]
    lines += ["".join(f"{count:9d}" for count in counts[i : i + 8]) for i in range(0, counts.size, 8)]
    path.write_text("\n".join(lines) + "\n")


def write_wav(path):
    from scipy.io import wavfile

    wavfile.write(path, round(1.0 / STEP), np.rint(WAVE / 16.0 * 2**31).astype(np.int32))  # full scale: 16 g


LIBRARIES = {
    "r.tdms": (write_tdms, {"channels": {"z": "z"}}),
    "r.h5": (write_hdf5, {}),
    "v73.mat": (write_matlab_73, {}),
    "r.npz": (lambda path: np.savez(path, time_s=TIME, z_g=WAVE), {}),
    "r.mseed": (write_seismic("MSEED"), {"unit": "g"}),
    "r.sac": (write_seismic("SAC"), {"unit": "g"}),
    "r.slist": (write_seismic("SLIST"), {"unit": "g"}),
    "AKT019.UD": (write_knet, {"channels": {"UD": "z"}}),
    "r.wav": (write_wav, {"channels": {"channel": "z"}, "unit": "g", "scale": 16.0}),
}


@pytest.mark.parametrize("name", LIBRARIES)
def test_files_of_other_libraries_are_read_and_say_what_they_lack(tmp_path, name):
    write, asked = LIBRARIES[name]
    write(path := tmp_path / name)
    check(path, **asked)
    if "unit" in asked:
        with pytest.raises(wr.RecordError, match=r'has no unit\. Say it with unit="g" \(--unit g\)'):
            wr.load_record(path, **{key: value for key, value in asked.items() if key != "unit"})


def hdf5(path, columns, **attributes):
    """Write datasets, each with its own attributes, and attributes of the file."""
    import h5py

    with h5py.File(path, "w") as file:
        file.attrs.update(attributes)
        for name, (values, own) in columns.items():
            file.create_dataset(name, data=values).attrs.update(own)


def test_an_axis_of_another_length_is_never_left_out_in_silence(tmp_path):
    path, g = tmp_path / "r.h5", {"unit": "g"}
    hdf5(path, {"x": (WAVE[:-1], g), "y": (WAVE[:-1], g), "z": (WAVE, g)}, fs=1.0 / STEP)
    with pytest.raises(wr.RecordError, match="z has another number of samples than the other columns"):
        wr.load_record(path)
    check(path, channels={"z": "z"})
    with pytest.raises(wr.RecordError, match="different numbers of samples, x 399, z 400"):
        wr.load_record(path, channels={"x": "x", "z": "z"})
    np.savez(tmp_path / "r.npz", x_g=WAVE, z=WAVE.astype(complex), fs=1.0 / STEP)
    with pytest.raises(wr.RecordError, match=r"z has another .* or holds no numbers"):
        wr.load_record(tmp_path / "r.npz")


def test_channels_that_begin_at_different_instants_are_not_played_in_phase(tmp_path):
    from nptdms import ChannelObject, TdmsWriter

    def late(path, *, in_offset):
        with TdmsWriter(path) as file:
            for name, start in (("x", 0.25), ("z", 0.0)):
                stated = {"wf_increment": STEP, "unit_string": "g", "wf_start_offset": start * in_offset}
                after = np.timedelta64(round(1e6 * start * (1 - in_offset)), "us")
                stated["wf_start_time"] = np.datetime64("2026-01-01T00:00:00", "us") + after
                file.write_segment([ChannelObject("rig", name, WAVE, stated)])

    for in_offset in (0, 1):
        late(tmp_path / "r.tdms", in_offset=in_offset)
        with pytest.raises(wr.RecordError, match="begin up to 0.25 s after each other. Use a file for each, with `start`"):
            wr.load_record(tmp_path / "r.tdms")
        check(tmp_path / "r.tdms", channels={"z": "z"})
    hdf5(path := tmp_path / "r.h5", {"x": (WAVE, {"unit": "g", "t0": 0.25}), "z": (WAVE, {"unit": "g", "t0": 0.0})}, fs=1000.0)
    with pytest.raises(wr.RecordError, match="begin up to 0.25 s after"):
        wr.load_record(path)
    with warnings.catch_warnings(action="ignore"):  # of its own
        from obspy import Stream, Trace, UTCDateTime
    begins = {"X": UTCDateTime(2026, 1, 1) + 0.25, "Z": UTCDateTime(2026, 1, 1)}
    traces = [Trace(WAVE.astype(np.float32), {"channel": c, "delta": STEP, "starttime": t}) for c, t in begins.items()]
    Stream(traces).write(str(tmp_path / "r.mseed"), format="MSEED")
    with pytest.raises(wr.RecordError, match="begin up to 0.25 s after"):
        wr.load_record(tmp_path / "r.mseed", unit="g")


def test_starts_of_clocks_that_round_are_one_instant(tmp_path):
    begins = {"x": 0.25, "z": 0.25 + 0.05 * STEP}  # a twentieth of a sample
    hdf5(path := tmp_path / "r.h5", {name: (WAVE, {"unit": "g", "t0": begin}) for name, begin in begins.items()}, fs=1.0 / STEP)
    check(path, channels={"z": "z"})
    assert wr.load_record(path).samples.shape == (WAVE.size, 3)
    hdf5(path, {"x": (WAVE, {"unit": "g", "t0": 0.0}), "z": (WAVE, {"unit": "g", "t0": 0.2 * STEP})}, fs=1.0 / STEP)
    with pytest.raises(wr.RecordError, match="begin up to"):
        wr.load_record(path)


def test_a_channel_is_not_read_over_the_time_of_another_group_without_a_word(tmp_path):
    time, path = STEP * np.arange(WAVE.size), tmp_path / "r.h5"
    hdf5(path, {"a/t": (time, {"unit": "s"}), "a/x": (WAVE, {"unit": "g"}), "b/z": (WAVE, {"unit": "g"})})
    with pytest.warns(
        wr.RecordWarning, match=r"b\.z without a time of its own is read over a\.t, which stands in another group"
    ):
        wr.load_record(path, channels={"b.z": "z"})
    with warnings.catch_warnings(action="error"):
        wr.load_record(path, channels={"a.x": "x"})
        hdf5(path, {"t": (time, {"unit": "s"}), "a/x": (WAVE, {"unit": "g"}), "b/z": (WAVE, {"unit": "g"})})
        wr.load_record(path)
        # what states a rate keeps it
        hdf5(path, {"a/t": (time, {"unit": "s"}), "a/x": (WAVE, {"unit": "g"}), "b/z": (WAVE, {"unit": "g", "fs": 0.5 / STEP})})
        record = wr.load_record(path, channels={"b.z": "z"})
        assert record.time[1] - record.time[0] == pytest.approx(2.0 * STEP, rel=1e-9)
    with pytest.raises(wr.RecordError, match=r"b\.z has a rate of its own and is not over a\.t"):
        wr.load_record(path, channels={"a.x": "x", "b.z": "z"})
    with pytest.raises(wr.RecordError, match=r"z has another number of samples"):
        wr.load_record(path)


def test_counts_intervals_and_rates_are_those_that_the_file_states(tmp_path):
    path = tmp_path / "r.h5"
    counts, factor = np.rint(WAVE / PEAK * 30000).astype(np.int16), PEAK / 30000
    hdf5(path, {"z": (counts, {"units": "g", "scale_factor": factor, "dt": 1e3 * STEP, "dt_unit": "ms"})})
    np.testing.assert_allclose(wr.load_record(path).samples[:, 2], G * counts * factor, rtol=1e-12)
    hdf5(path, {"z": (counts, {"units": np.array([b"g"]), "gain": 2.0})}, fs=1.0 / STEP)
    with pytest.raises(wr.RecordError, match="/z holds counts, and its gain is not applied"):
        wr.load_record(path)
    hdf5(path, {"z": (WAVE, {"unit": "g", "dt": STEP, "dt_unit": "Hz"})})
    with pytest.raises(wr.RecordError, match="dt is in Hz; known units: s, ms"):
        wr.load_record(path)
    hdf5(path, {"a/z": (WAVE, {"unit": "g", "fs": 1000.0}), "b/x": (WAVE, {"unit": "g", "fs": 500.0})})
    with pytest.raises(wr.RecordError, match=r"a\.z, b\.x have different rates, or some have none"):
        wr.load_record(path)
    check(path, channels={"a.z": "z"})
    hdf5(path, {"acc": (np.column_stack([WAVE, WAVE]), {"unit": "g"}), "fs": (1000.0, {})})
    check(path, channels={"acc(:,2)": "z"})
    np.savez(tmp_path / "r.npz", z_g=WAVE, fs=1000.0, about="text")
    check(tmp_path / "r.npz")


def test_a_library_that_is_missing_is_named_with_the_extra(tmp_path, monkeypatch):
    write_tdms(path := tmp_path / "r.tdms")
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(wr.RecordError, match=r'a TDMS file, which nptdms reads: pip install "wirerope-mj\[loggers\]"'):
        wr.load_record(path)


@pytest.mark.parametrize("ending", ["csv", "h5", "mat"])
def test_our_own_exports_are_read_back(tmp_path, ending):
    pulse = wr.HalfSine(peak=50.0, duration=0.011, direction="z", start=0.01)
    r = wr.simulate(wr.load_system("shock_table"), pulse, duration=0.1, timestep=5e-4)
    path = r.export(tmp_path / f"r.{ending}")
    record = wr.load_record(path, channels={"base.acceleration.z" if ending == "h5" else "base/acceleration/z": "z"})
    np.testing.assert_allclose(record.samples[:, 2], r.base.acceleration[:, 2], rtol=1e-12)


def test_a_formula_without_its_value_is_named(tmp_path):
    import openpyxl

    book = openpyxl.Workbook()
    for row in (["time [s]", "raw [V]", "z [g]"], [0.0, 0.1, "=B2*10"], [0.001, 0.2, "=B3*10"]):
        book.active.append(row)
    book.save(tmp_path / "r.xlsx")
    with pytest.raises(
        wr.RecordError, match=r'row 2: "=B2\*10" in column "z" is not a number. The value of this formula is not'
    ):
        wr.load_record(tmp_path / "r.xlsx")


def test_columns_without_a_name_or_with_one_name_can_be_chosen(tmp_path):
    (tmp_path / "r.csv").write_bytes(text("time [s],z [g],z [g]", (TIME, WAVE / 2.0, WAVE)))
    for name in ("z#2", "column 3"):
        check(tmp_path / "r.csv", channels={name: "z"})
    with pytest.raises(wr.RecordError, match=r'there are 2 columns "z"; the columns are z, z. Say which: "z#1" or "z#2"'):
        wr.load_record(tmp_path / "r.csv", channels={"z": "z"})
    (tmp_path / "r.csv").write_bytes(text("time [s],,y [g]", (TIME, WAVE, WAVE)))
    check(tmp_path / "r.csv", channels={"column 2": "z"}, unit="g")


REFUSED = {
    "a.tdms": (b"TDSm\x0e\0\0\0", "the file holds no columns of numbers; it holds nothing that is a number. Export it again"),
    "a.h5": (b"\x89HDF\r\n\x1a\n" + bytes(64), "this is no HDF5 file that can be read"),
    "a.mseed": (b"000001D " + bytes(64), "this is no seismic file that can be read"),
    "a.wav": (b"RIFF\x24\0\0\0WAVE", "this is no WAV file that can be read"),
    "a.json": (b'[{"time [s]":0.0,"z [g]":1.0}]', "a JSON file"),
    "numbers.txt": (b"0.0 1.0\n0.1 2.0\n", "line 1: numbers begin here and no header stands above them"),
    "a.xls": (b"\xd0\xcf\x11\xe0" + bytes(600), "a workbook of old Excel"),
    "b.xls": (b"<html><table>", "an HTML page"),
    "a.csv": (b"\x1f\x8b\x08\0", "compressed by gzip.* Unpack it"),
    "a.dat": (
        bytes(range(256)),
        r"control characters \(NUL\) stand where a table has text, as in a binary file, one that was cut",
    ),
    "b.dat": (b"\n".join(b"%d,%d" % (i, i) for i in range(9)), "line 1: numbers begin here and no header stands above them"),
    "b.csv": (
        b"time [us];z [g]\n0;1\n500;2\n1,000;3\n1,500;3\n",
        'such as "1,000", have a comma that may separate thousands or',
    ),
    "c.csv": (b"time [s]\tz [mg]\n0\t0.5\n1\t1,250.5\n", '"1,250.5" in column "z" is not a number. Write thousands without'),
    "d.csv": (b"time [s],z [g]\n0,1\n1,#N/A\n", '#N/A in column "z"; have such samples filled'),
    "e.csv": (b"Elapsed,z [g]\n0,1\n1,2\n", "no column is the time; one alone is called time or t, or has a unit of time"),
    "a.AT2": (PEER.format("NPTS= 500, DT= .0010 SEC").encode(), "acceleration has 400 values where line 4 says 500"),
    "a.lvm": (labview("One", ".") + b"\n" + labview("One", ".").partition(b"\n\t\n")[2], "holds 2 measurements one after"),
    "k.txt": (b"Origin Time\nSampling Freq(Hz)  100Hz\n", "the file holds no columns of numbers"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_read_is_refused_by_name(tmp_path, name):
    content, message = REFUSED[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(wr.RecordError, match=message):
        wr.load_record(tmp_path / name)


def test_missing_values_of_every_spelling_are_filled_on_request(tmp_path):
    words = ["#N/A", "NaN", "-nan(ind)", "null", "--", ""]
    values = [words[i - 5] if 5 <= i < 5 + len(words) else f"{v:.5f}" for i, v in enumerate(WAVE)]
    (tmp_path / "r.csv").write_bytes(text("time [s],z [g]", (TIME, values)))
    record = check(tmp_path / "r.csv", gaps="fill")
    assert f'{len(words)} samples missing in column "z"' in record.warnings[0]


@pytest.mark.parametrize(
    "heading", ["PSD (g^2/Hz)", "PSD [g²/Hz]", "PSD / g^2/Hz", "G**2/HZ (G^2/HZ)", "asd_g2/Hz [grms^2/Hz]"]
)
@pytest.mark.parametrize("reverse", [False, True])
def test_densities_have_the_same_notation(tmp_path, heading, reverse):
    columns = [("Frequency (Hz)", heading), ("20", "0.01"), ("200", "0.02"), ("", "")]
    (tmp_path / "p.csv").write_text("\n".join(",".join(row[::-1] if reverse else row) for row in columns), encoding="utf-8")
    assert psd_points(tmp_path / "p.csv") == ((20.0, pytest.approx(0.01 * G**2)), (200.0, pytest.approx(0.02 * G**2)))


@pytest.mark.parametrize(
    "header",
    [
        "Actuator force,Actuator displacement\nkN,mm",
        "Last / kN;Weg / mm",
        "Load (KN)\tLVDT 1 (mm)",
        "Load cell [kN],x [mm],Temperature [°C]",
    ],
)
def test_loops_have_the_same_notation_and_the_words_of_rigs(tmp_path, header):
    angle = np.linspace(0.0, 2.0 * np.pi, 101)
    sign = next(one for one in "\t;," if one in header)
    columns = [1.2 * np.sin(angle + 0.2), 3.0 * np.sin(angle), 0.0 * angle][: header.partition("\n")[0].count(sign) + 1]
    (tmp_path / "r.csv").write_bytes(text(header, columns, sign))
    (loop,) = wr.load_cyclic_test(tmp_path / "r.csv")
    assert (loop.deflection.max(), loop.force.max()) == (
        pytest.approx(3e-3, rel=1e-4),
        pytest.approx(1200.0, rel=2e-3),
    )  # a sample
    (tmp_path / "r.csv").write_bytes(text("Disp 1 [mm],Disp 2 [mm],Load [kN]", [angle, angle, angle]))
    with pytest.raises(
        wr.RecordError, match='"Disp 1" and "Disp 2" may all be the deflection: call the one that is meant "defl'
    ):
        wr.load_cyclic_test(tmp_path / "r.csv")


@pytest.mark.parametrize("ending", ["csv", "xlsx"])
def test_tables_of_a_model_skip_empty_rows_and_columns_and_name_unnamed_ones(tmp_path, ending):
    rows = [["name", None, "mass [kg]", None], ["pump", None, 400.0, None], [None] * 4, ["frame", None, 200.0, None]]

    def read():
        path = tmp_path / f"m.{ending}"
        if ending == "xlsx":
            workbook(path, rows)
        else:
            path.write_text("\n".join(",".join("" if cell is None else str(cell) for cell in row) for row in rows))
        return read_sheet(path, kind="table of masses", needed={"name": "text", "mass": "mass"}, further={})

    assert [(row.text("name"), row.number("mass")) for row in read()] == [("pump", 400.0), ("frame", 200.0)]
    rows[1][1] = 5.0
    called = "column B" if ending == "xlsx" else "column 2"
    with pytest.raises(wr.RecordError, match=f"{called} has no name and holds something"):
        read()


def test_a_universal_file_may_hold_runs_of_one_node(tmp_path):
    import pyuff

    path = tmp_path / "r.uff"
    for number, scale in ((1, 0.5), (2, 1.0)):
        pyuff.UFF(str(path)).write_sets(
            {
                "type": 58, "func_type": 1, "rsp_node": 1, "rsp_dir": 3, "ref_dir": 3, "ref_node": 1, "data": scale * G * WAVE,
                "x": TIME, "id1": f"run {number}", "rsp_ent_name": "NONE", "ref_ent_name": "NONE", "abscissa_spacing": 1,
                "abscissa_spec_data_type": 17, "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 0,
                "ordinate_axis_units_lab": "m/s2",
            },
            "add",
        )  # fmt: skip
    for name in ("1:z#2", "1:z#run 2"):
        check(path, channels={name: "z"})
    with pytest.raises(
        wr.RecordError, match=re.escape("choose one by its number or its ID line; the file holds 1:z#1 (run 1), 1")
    ):
        wr.load_record(path, channels={"1:z": "z"})
    measured = wr.load_measured(path, channels={"1:z#2": "base z m/s^2"})
    assert np.abs(measured.channels[0].values).max() == pytest.approx(G * PEAK, rel=1e-5)


@pytest.mark.parametrize(
    ("quantity", "spelled", "unit"),
    [
        ("time", "µs", "us"), ("time", "Sec", "s"), ("time", "MS", "ms"), ("acceleration", "m/s/s", "m/s^2"),
        ("acceleration", "m s⁻²", "m/s^2"), ("acceleration", "cm/sec2", "cm/s^2"), ("acceleration", "G's", "g"),
        ("force", "lbs", "lbf"),
        ("force", "KN", "kN"), ("length", "inches", "in"), ("inertia", "kg·m²", "kg m^2"), ("density", "G^2/HZ", "g^2/Hz"),
        ("stiffness", "mN/m", None), ("acceleration", "V", None), ("force", "mN", None),
    ],
)  # fmt: skip
def test_units_are_known_by_every_usual_spelling_and_no_other(quantity, spelled, unit):
    found = find_unit(spelled, UNITS[quantity])
    assert (found and UNITS[quantity][found]) == (unit and UNITS[quantity][unit])


@pytest.mark.parametrize(
    ("cell", "parts"),
    [
        ("z [g]", ("z", "g")), ("PSD ((m/s^2)^2/Hz)", ("PSD", "(m/s^2)^2/Hz")), ("a/(m/s2)", ("a", "m/s2")),
        ("F/N", ("F", "N")),
        ("Z (100g)", ("Z", "100g")), ("Sensor (A)", ("Sensor (A)", None)), ("m/s^2", ("m/s^2", None)),
        ("bodies/rack/acceleration/z", ("bodies/rack/acceleration/z", None)), ("Zeit in s", ("Zeit", "s")), ("[g]", ("", "g")),
    ],
)  # fmt: skip
def test_a_heading_is_split_into_name_and_unit(cell, parts):
    assert split_unit(cell) == parts


@pytest.mark.parametrize(
    "rows", ["20,0.01\n24.914619,0.01\n31.036911,0.01\n38.663641,0.01\n48.164494,0.01\n60,0.01\n", "1,2\n3,4\n"]
)
def test_a_density_of_numbers_alone_is_refused_in_words(rows, here):
    (here / "p.csv").write_text(rows)
    with pytest.raises(wr.RecordError, match="no header stands above them"):
        wr.motions.registry.motion_from_phrase("psd", "p.csv 0.4 s z seed 1", folder=here)


def test_units_of_labview_stand_in_the_cells_of_their_columns(tmp_path):
    """A file of several columns of time has a cell for each of these, too: the third channel had the second one's unit."""
    rows = [f"{t:.5f}\t{v / 2:.5f}\t{t:.5f}\t{v / 3:.5f}\t{t:.5f}\t{v:.5f}\t" for t, v in zip(TIME, WAVE, strict=True)]
    head = labview("Multi", ".").decode().split("Channels")[0]
    head += (
        "Channels\t3\nY_Unit_Label\tN\t\tm/s^2\t\tg\t\n***End_of_Header***\nX_Value\tForce\tX_Value\tx\tX_Value\tz\tComment\n"
    )
    (tmp_path / "r.lvm").write_text(head + "\n".join(rows) + "\n")
    for channel, peak in (("x", PEAK / 3.0), ("z", G * PEAK)):
        record = wr.load_record(tmp_path / "r.lvm", channels={channel: "z"})
        assert np.abs(record.samples).max() == pytest.approx(peak, rel=1e-4)


def test_two_matrices_beside_one_list_of_names_are_told_apart(tmp_path):
    from scipy.io import savemat

    raw = np.column_stack([TIME, 0.5 * WAVE, WAVE])
    names = np.array(["time [s]", "x [g]", "z [g]"], dtype=object)
    savemat(tmp_path / "r.mat", {"raw": raw, "filtered": 0.25 * raw, "channels": names})
    with pytest.raises(wr.RecordError, match=r"raw\.time.*raw\.z.*filtered\.time"):
        wr.load_record(tmp_path / "r.mat", channels={"z": "z"})


def test_a_factor_before_a_unit_is_no_range_of_a_sensor(tmp_path):
    (tmp_path / "r.csv").write_bytes(text("time [s],z [9.81 m/s^2]", [TIME, WAVE]))
    with pytest.raises(wr.RecordError, match=r"9\.81 m/s\^2"):
        wr.load_record(tmp_path / "r.csv")


def test_responses_beyond_the_range_of_their_sensor_are_refused(tmp_path):
    (tmp_path / "r.csv").write_bytes(text("time [s],A1 (100g)", [TIME, 25.0 * WAVE]))
    with pytest.raises(wr.RecordError, match="243.8 g stands in a column of a sensor whose range is 100 g"):
        wr.load_measured(tmp_path / "r.csv", channels={"A1": "body/block z"})


@pytest.mark.parametrize("error", ["#N/A", "#DIV/0!", "#REF!", "#NAME?"])
@pytest.mark.parametrize("ending", ["csv", "xlsx"])
def test_errors_of_a_spreadsheet_in_the_first_column_are_no_comments(tmp_path, error, ending):
    deflection = [error if 90 < i < 110 else f"{5.0 * np.sin(i / 100.0 * np.pi):.5f}" for i in range(201)]
    rows = ["deflection [mm],force [N]", *(f"{d},{i}" for i, d in enumerate(deflection))]
    path = tmp_path / f"loop.{ending}"
    if ending == "csv":
        path.write_text("\n".join(rows))
    else:
        openpyxl = pytest.importorskip("openpyxl")
        book = openpyxl.Workbook()
        for row in rows:
            book.active.append([cell if cell.startswith(("#", "d", "f")) else float(cell) for cell in row.split(",")])
        book.save(path)
    with pytest.raises(wr.RecordError, match=rf'"{re.escape(error)}" in column "deflection" is not a number. Its value is mis'):
        wr.read_cyclic_test(path)


def test_an_inch_sign_above_the_header_opens_no_cell(tmp_path):
    (tmp_path / "r.csv").write_bytes(b'Cable 3/8" diameter\n' + text("time [s],z [g]", [TIME, WAVE]))
    assert wr.load_record(tmp_path / "r.csv").samples.shape[0] == COUNT


@pytest.mark.parametrize(
    ("spelled", "unit"),
    [("M/SEC**2", "m/s^2"), ("M/SEC^2", "m/s^2"), ("M/S/S", "m/s^2"), ("G'S", "g"), ("IN/SEC**2", "in/s^2")],
)
def test_units_in_capitals_are_known(spelled, unit):
    accelerations = UNITS["acceleration"]
    assert accelerations[find_unit(spelled, accelerations)] == accelerations[unit]


def test_peer_is_read_in_small_letters_and_no_comment_is_taken_for_it(tmp_path):
    (tmp_path / "r.at2").write_text(PEER.format("NPTS=  400, DT= .0010000 SEC").lower())
    record = wr.load_record(tmp_path / "r.at2", channels={"acceleration": "z"})
    assert np.abs(record.samples).max() == pytest.approx(G * PEAK, rel=1e-4)
    head = b"# acceleration time history in units of g\n# DT 0.001 s\nSampling Freq(Hz),1000\n"
    (tmp_path / "r.csv").write_bytes(head + text("time [s],z [g]", [TIME, WAVE]))
    assert np.abs(wr.load_record(tmp_path / "r.csv").samples).max() == pytest.approx(G * PEAK, rel=1e-4)


def test_a_table_that_begins_with_cdf_is_no_netcdf(tmp_path):
    (tmp_path / "r.csv").write_bytes(text("cdf [g],time [s],z [g]", [WAVE, TIME, WAVE]))
    assert wr.load_record(tmp_path / "r.csv", channels={"z": "z"}).samples.shape[0] == COUNT


def test_a_comment_between_rows_may_hold_separators(tmp_path):
    lines = text("time [s],z [g]", [TIME, WAVE]).decode().splitlines()
    (tmp_path / "r.csv").write_text("\n".join([*lines[:200], "# note, restarted", *lines[200:]]))
    assert wr.load_record(tmp_path / "r.csv").samples.shape[0] == COUNT


@pytest.mark.parametrize("dates", ["31/01/2026 01/02/2026", "01/02/2026 02/02/2026", "01/31/2026 02/01/2026"])
def test_dates_are_read_in_the_order_that_fits_all_of_them(tmp_path, dates):
    first, second = dates.split()
    clock = [f"{first} 23:59:59.{700 + i:03d}" if i < 300 else f"{second} 00:00:00.{i - 300:03d}" for i in range(COUNT)]
    (tmp_path / "r.csv").write_bytes(text("time,z [g]", [clock, WAVE]))
    assert wr.load_record(tmp_path / "r.csv").duration == pytest.approx((COUNT - 1) * STEP)


@pytest.mark.parametrize("date", ["2026-02-30", "31/Xyz/2026"])
def test_a_date_of_no_calendar_is_named(tmp_path, date):
    (tmp_path / "r.csv").write_bytes(text("time,z [g]", [[f"{date} 10:00:00.{i:03d}" for i in range(COUNT)], WAVE]))
    with pytest.raises(wr.RecordError, match=rf'r\.csv, line 1: "{date} 10:00:00.000" below it is no instant'):
        wr.load_record(tmp_path / "r.csv")
