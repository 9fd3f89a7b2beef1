"""Results for other programs: what was written is read back equal, by libraries that know nothing of this one."""

import csv
import itertools
import signal
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.engine.response import histories
from wirerope_mj.foundation import exports
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.exports import Exported, _matlab_names, write_export
from wirerope_mj.foundation.unfailing_files import UnfailingFile

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

PULSE = wr.HalfSine(peak=100.0, duration=0.011, direction="z", start=0.01)


@pytest.fixture(scope="module")
def response():
    return wr.simulate(wr.load_system("shock_table"), PULSE, duration=0.05, timestep=5e-4)


@pytest.fixture(scope="module")
def streamed(tmp_path_factory):
    """Return the same response, its samples in a file."""
    return wr.simulate(
        wr.load_system("shock_table"), PULSE, duration=0.05, timestep=5e-4, out=tmp_path_factory.mktemp("streamed")
    )


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    vary = {"mount/m1/stiffness": wr.Uniform(0.5, 1.5)}
    made = wr.Study(model="shock_table.xml", motion=PULSE, duration=0.05, timestep=5e-4, vary=vary, variants=4)
    return made.run(tmp_path_factory.mktemp("studies") / "study", workers=1)


@pytest.mark.parametrize("kind", ["response", "streamed"])
def test_a_response_is_read_back_equal_to_the_last_bit(request, kind, tmp_path):
    result = request.getfixturevalue(kind)
    names = result.samples.names
    with result.to_csv(tmp_path / "r.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header[0] == "time [s]"
    assert [name.partition(" [")[0] for name in header] == names
    assert "bodies/block/acceleration/z [m/s^2]" in header
    np.testing.assert_array_equal(np.array(rows, dtype=float), result.samples.columns(0, len(names)))
    with h5py.File(result.to_hdf5(tmp_path / "r.h5")) as file:
        for number, name in enumerate(names):
            np.testing.assert_array_equal(file[name][:], result.samples.columns(number, number + 1)[:, 0])
        assert file["mounts/m1/force/axial"].attrs["unit"] == "N"
        assert file.attrs["model"] == "shock_table"
    mat = scipy.io.loadmat(result.to_mat(tmp_path / "r.mat"))
    for variable, name in zip(mat["variables"].ravel(), mat["names"].ravel(), strict=True):
        np.testing.assert_array_equal(mat[str(variable[0])].ravel(), result.column(str(name[0])))
    units = [str(unit[0]) if unit.size else "" for unit in mat["units"].ravel()]
    assert units[:2] == ["s", "m"]
    frame = result.to_dataframe()
    np.testing.assert_array_equal(frame.to_numpy(), result.samples.columns(0, len(names)))
    assert frame["time [s]"].iloc[-1] == 0.05


@pytest.mark.parametrize("kind", ["response", "streamed"])
def test_a_csv_file_written_in_many_parts_is_the_one_written_at_once(request, kind, tmp_path, monkeypatch):
    result = request.getfixturevalue(kind)
    whole, columns = result.to_csv(tmp_path / "whole.csv").read_text(), len(result.samples.names)
    monkeypatch.setattr(histories, "BLOCK_NUMBERS", 7 * columns)
    sizes = [len(block) for block in result.samples.blocks(0, columns)]
    assert max(sizes) == 7
    assert sum(sizes) == len(result.time)
    assert result.to_csv(tmp_path / "parts.csv").read_text() == whole


def test_the_table_of_a_study_is_read_back_equal(study, tmp_path):
    table = study.table
    frame = pd.read_csv(study.to_csv(tmp_path / "s.csv"))
    assert frame["status"].tolist() == ["done"] * 4
    np.testing.assert_array_equal(frame["mount/m1/stiffness"], table["mount/m1/stiffness"].to_numpy())
    np.testing.assert_array_equal(frame["acceleration/block [m/s^2]"], table["acceleration/block"].to_numpy())
    with h5py.File(study.to_hdf5(tmp_path / "s.h5")) as file:
        np.testing.assert_array_equal(file["acceleration"][:], table["acceleration"].to_numpy())
        np.testing.assert_array_equal(file["acceleration.block"][:], table["acceleration/block"].to_numpy())
        assert file["status"].asstr()[:].tolist() == ["done"] * 4
    mat = scipy.io.loadmat(study.to_mat(tmp_path / "s.mat"))
    np.testing.assert_array_equal(mat["acceleration_block"].ravel(), table["acceleration/block"].to_numpy())
    assert study.to_dataframe()["variant"].tolist() == [0, 1, 2, 3]


def test_the_command_writes_what_the_ending_says_and_replaces_only_with_force(response, study, tmp_path, capsys):
    response.save(tmp_path / "run")
    for ending in ("csv", "h5", "mat"):
        out = str(tmp_path / f"r.{ending}")
        assert main(["export", str(tmp_path / "run"), out]) == 0
        assert main(["export", str(tmp_path / "run"), out]) == 2
        assert main(["export", str(tmp_path / "run"), out, "--force"]) == 0
    assert main(["export", str(study.folder), str(tmp_path / "s.csv")]) == 0
    assert main(["export", str(tmp_path / "run"), str(tmp_path / "r.xls")]) == 2
    assert ".csv, .h5, .hdf5, .mat" in capsys.readouterr().err
    assert main(["export", str(tmp_path / "nothing"), str(tmp_path / "n.csv")]) == 2
    assert not (tmp_path / "n.csv").exists()


def test_a_missing_package_is_named_and_nothing_is_written(response, tmp_path, monkeypatch):
    def missing(name):
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(exports, "import_module", missing)
    with pytest.raises(RecordError, match="needs h5py"):
        response.to_hdf5(tmp_path / "r.h5")
    with pytest.raises(RecordError, match="needs pandas"):
        response.to_dataframe()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.quick
def test_names_for_matlab_are_valid_and_each_another_one():
    names = ["a/b", "a_b", "a b", "1st", "x" * 80, "x" * 79 + "y", "names", "motor ü"]
    made = _matlab_names(names)
    assert made == ["a_b", "a_b_2", "a_b_3", "x_1st", "x" * 63, "x" * 61 + "_2", "names_2", "motor__"]
    assert all(name.isidentifier() and len(name) <= 63 for name in made)


def test_the_package_says_that_it_is_typed():
    assert (Path(wr.__file__).parent / "py.typed").is_file()


def test_the_spectra_of_a_point_of_a_run_are_those_of_its_acceleration(response, tmp_path, capsys):
    response.save(tmp_path / "run")
    name = next(iter(response.bodies))
    assert main(["export", str(tmp_path / "run"), str(tmp_path / "s.csv"), "--spectrum", name, "--q", "20"]) == 0
    frame = pd.read_csv(tmp_path / "s.csv")
    own = wr.shock_response_spectrum(response.time, response.bodies[name].acceleration[:, 2], q=20)
    np.testing.assert_array_equal(frame["frequency [Hz]"], own.frequencies)
    np.testing.assert_allclose(frame["z/acceleration/maximax [m/s^2]"], own.maximax, rtol=1e-12)
    pseudo = 2 * np.pi * own.frequencies * own.relative_displacement
    np.testing.assert_allclose(frame["z/pseudo_velocity/maximax [m/s]"], pseudo, rtol=1e-12)
    assert main(["export", str(tmp_path / "run"), str(tmp_path / "t.csv"), "--spectrum", "roof"]) == 2
    assert "nothing is called 'roof'; there are base, " in capsys.readouterr().err
    assert not (tmp_path / "t.csv").exists()


@pytest.mark.parametrize("number", [1, 3, 5])
def test_an_interrupt_while_hdf5_writes_comes_when_it_has_written(number, tmp_path, monkeypatch):
    pytest.importorskip("h5py")
    count, write = itertools.count(1), UnfailingFile.write

    def interrupted(file, content):
        if next(count) == number:
            signal.raise_signal(signal.SIGINT)
        return write(file, content)

    monkeypatch.setattr(UnfailingFile, "write", interrupted)
    table = Exported(
        names=["a", "b"], units=["m", ""], column=lambda n: np.arange(10_000.0), blocks=lambda: iter(()), about={"name": "x"}
    )
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # as where these tests run in the background
    try:
        with pytest.raises(KeyboardInterrupt):
            write_export(table, tmp_path / "o.h5")
    finally:
        signal.signal(signal.SIGINT, before)
    assert list(tmp_path.iterdir()) == []
