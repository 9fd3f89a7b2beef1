"""Records in universal files: axes by node and direction, units by label or by dataset 164, and what cannot be read."""

import re

import numpy as np
import pytest
from uff_files import history, units

from wirerope_mj.foundation.errors import RecordError, RecordWarning
from wirerope_mj.motions import load_record, motion_from_dict
from wirerope_mj.motions.records.record import record_channels

G = 9.80665
TIME = np.arange(200) * 1e-3
WAVE = np.sin(2 * np.pi * 20.0 * TIME) * np.exp(-((TIME - 0.1) ** 2) / 2e-3)


@pytest.fixture
def uff(tmp_path):
    """Writes datasets one after the other and returns the file's path."""

    def write(*datasets, name="deck.unv"):
        path = tmp_path / name
        path.write_bytes(b"".join(datasets))
        return path

    return write


@pytest.mark.parametrize("binary", [False, True])
def test_three_axes_are_read_at_once_along_their_directions(uff, binary):
    path = uff(
        history(12, "-x", 1.0 * WAVE, unit="m/s^2", binary=binary),
        history(12, "y", 2.0 * WAVE, unit="g", binary=binary),
        history(12, "z", 3.0 * WAVE, unit="mm/s^2", binary=binary),
    )
    record = load_record(path)
    # text holds 12 digits
    np.testing.assert_allclose(record.samples, np.outer(WAVE, [-1.0, 2.0 * G, 3e-3]), atol=1e-11 * G)
    np.testing.assert_allclose(record.time, TIME, atol=1e-15)
    assert record_channels(path) == ("12:-x", "12:y", "12:z")


def test_dataset_164_gives_the_unit_where_no_label_does(uff):
    path = uff(units(5, 1000.0), history(1, "z", 1000.0 * WAVE))
    np.testing.assert_allclose(load_record(path).samples[:, 2], WAVE, atol=1e-11)
    labelled = uff(units(5, 1000.0), history(1, "z", WAVE, unit="G"), name="labelled.uff")
    np.testing.assert_allclose(load_record(labelled).samples[:, 2], G * WAVE, atol=1e-11 * G)
    said = uff(units(1, 3.28), history(1, "z", WAVE), name="said.uff")
    np.testing.assert_allclose(load_record(said, unit="g").samples[:, 2], G * WAVE, atol=1e-11 * G)
    with pytest.raises(RecordError, match="dataset 164 contradicts itself: units code 1, but 3.28 units of length"):
        load_record(said)


def test_channels_choose_among_nodes_and_turn_them(uff):
    path = uff(
        history(1, "z", WAVE, unit="m/s^2"),
        history(2, "z", 2.0 * WAVE, unit="m/s^2"),
        history(3, "scalar", 5.0 * WAVE, unit="m/s^2"),
    )
    with pytest.raises(
        RecordError,
        match=r"which of 1:z, 2:z, 3 move the base.* for instance channels=\{\"1:z\": \"z\"\} \(--channels 1:z=z\)",
    ):
        load_record(path)
    record = load_record(path, channels={"2:z": "x", "3": (0.0, 0.0, -1.0)})
    np.testing.assert_allclose(record.samples, np.outer(WAVE, [2.0, 0.0, -5.0]), atol=1e-10)
    with pytest.raises(RecordError, match='there is no history "4:z"; the file holds 1:z, 2:z, 3'):
        load_record(path, channels={"4:z": "z"})
    twice = uff(history(1, "z", WAVE, unit="g"), history(1, "z", WAVE, unit="g"), name="twice.uff")
    with pytest.raises(RecordError, match='there are 2 histories "1:z"'):
        load_record(twice, channels={"1:z": "z"})


def test_forces_spectra_and_rotations_are_no_records_of_a_base(uff):
    path = uff(
        history(1, "z", WAVE, unit="N", kind=13),
        history(1, "z", WAVE, unit="g", function=2),
        history(1, "rz", WAVE, unit="rad/s^2"),
    )
    with pytest.raises(RecordError, match="holds no time history of an acceleration .* its datasets are 58, 58, 58"):
        load_record(path)
    general = uff(history(1, "z", WAVE, kind=1), name="general.uff")
    np.testing.assert_allclose(load_record(general, unit="m/s^2").samples[:, 2], WAVE, atol=1e-11)


def test_an_uneven_abscissa_is_resampled_and_said(uff):
    times = TIME + 2e-4 * np.sin(np.arange(TIME.size))
    path = uff(history(1, "z", np.interp(times, TIME, WAVE), times=times, unit="m/s^2"))
    with pytest.warns(RecordWarning, match="the sampling is not uniform, its intervals lie between"):
        record = load_record(path)
    np.testing.assert_allclose(np.diff(record.time), np.diff(record.time)[0], rtol=1e-9)
    # straight lines between samples 1 ms apart cut off (2 pi 20 Hz 1 ms)^2 / 8 = 0.002 of a wave, twice here
    np.testing.assert_allclose(record.acceleration(TIME[5:-5])[:, 2], WAVE[5:-5], atol=0.02)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            history(7, "z", WAVE),
            "neither 7:z nor a dataset 164 says the unit of the accelerations. Say it, for instance unit=",
        ),
        (history(7, "z", WAVE, unit="V"), '7:z has the unknown unit "V". Say which is meant, for instance unit="g"'),
        (history(7, "z", WAVE, unit="g", count=500), "7:z holds 200 values where its header says 500"),
        (b"    -1\n    58\nno header\n    -1\n", "this universal file cannot be read"),
        (history(7, "z", WAVE, unit="g")[:-40], "holds no complete dataset: it was cut off before the line -1"),
        (
            b"    -1\n   151\n    -1\n" + history(7, "z", WAVE, unit="g")[:3000],
            "no complete time history of an acceleration",
        ),
        (b"    -1\n   151\n    -1\n", "no time history of an acceleration"),
        (
            history(7, "x", WAVE, unit="g") + history(7, "z", WAVE, unit="g", step=2e-3),
            "7:z is sampled at other instants than 7:x",
        ),
    ],
)
def test_a_bad_file_gets_one_clear_message(uff, content, message):
    with pytest.raises(RecordError, match=r"deck\.unv: .*" + re.escape(message)):
        load_record(uff(content))


def test_a_universal_file_that_lost_its_end_is_said(uff):
    path = uff(history(1, "x", WAVE, unit="g"), history(1, "z", WAVE, unit="g")[:3000])
    with pytest.warns(RecordWarning, match=r"deck\.unv: the end of this universal file is missing; what was cut off"):
        record = load_record(path)
    assert not record.samples[:, 2].any()
    assert record.samples[:, 0].any()


def test_a_stored_record_is_read_again_bit_for_bit(uff, tmp_path):
    path = uff(history(2, "z", WAVE), history(2, "x", 0.5 * WAVE), name="two axes.uff")
    record = load_record(path, unit="g", resample=500.0, baseline="highpass", highpass=2.0, start=0.25, scale=-2.0)
    stored = record.to_dict(files={path: "inputs.uff"})
    assert stored == {
        "kind": "record", "path": "inputs.uff", "scale": -2.0, "baseline": "highpass", "start": 0.25,
        "highpass": 2.0, "resample": 500.0, "unit": "g",
    }  # fmt: skip
    (tmp_path / "copy").mkdir()
    (tmp_path / "copy" / "inputs.uff").write_bytes(path.read_bytes())
    again = motion_from_dict(stored, folder=tmp_path / "copy")
    np.testing.assert_array_equal(again.samples, record.samples)
    np.testing.assert_array_equal(again.time, record.time)
