"""`wirerope compare RUN TEST`: from files to agreement, page and recording; what is wrong is said in one message."""

import re
import shutil
import warnings

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.runs.board.board import Board
from wirerope_mj.runs.board.opened import opened
from wirerope_mj.runs.folder import alterations
from wirerope_mj.runs.measured import tests_of as stored_tests  # pytest would take it for a test

RATE = 10_000.0
G = wr.STANDARD_GRAVITY
CLIPPED = 1.5  # [g]
MAP = ("B=base z g", "T=point/mass_top z g", "D=mount/m1 axial mm", "F=mount/m1 axial kN")


@pytest.fixture(scope="module")
def drop(tmp_path_factory):
    """Returns a test at 10 kHz: mount 20 % stiffer than the model's, offsets, a sensor that clips, and noise."""
    path = tmp_path_factory.mktemp("test") / "drop.csv"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        system = wr.load_system("sdof_shaker")
        truth = wr.varied(system, isolators={name: one.isolator.scaled(1.2) for name, one in system.mounts.items()})
        motion = wr.HalfSine(peak=4.0 * G, duration=0.011, direction="z", start=0.05)
        answer = wr.simulate(truth, motion, duration=0.6, sample_rate=RATE)
    rng = np.random.default_rng(5)
    mount, payload = answer.mounts["m1"], answer.points["mass_top"].acceleration[:, 2] / G
    columns = {
        "time [s]": answer.time + 12.0,
        "B": answer.base.acceleration[:, 2] / G + 0.05,
        "T": np.clip(payload - 0.1, -np.inf, 0.8 * payload.max()),
        "D": 1e3 * (mount.deflection[:, 2] - mount.deflection[0, 2]),
        "F": 1e-3 * mount.force[:, 2],
    }
    for name, noise in (("B", 0.005), ("D", 0.005), ("F", 0.002)):
        columns[name] = columns[name] + noise * rng.standard_normal(answer.time.size)
    write(path, columns)
    return path


def write(path, columns):
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="", fmt="%.10g")


@pytest.fixture(scope="module")
def run(drop, tmp_path_factory):
    """Returns the run of the model on the measured base."""
    folder = tmp_path_factory.mktemp("run") / "shaker"
    options = ["--record", str(drop), "--channels", "B=z", "--unit", "g", "--baseline", "rest"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert main(["shock", "sdof_shaker", *options, "--duration", "0.6", "--out", str(folder)]) == 0
    return folder


@pytest.fixture
def compared(run, drop, tmp_path, capfd):
    """Returns a copy of the run, and what comparing it with the test prints."""
    folder = tmp_path / "shaker"
    shutil.copytree(run, folder)
    capfd.readouterr()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert main(["compare", str(folder), str(drop), "--map", *MAP, "--baseline", "rest", "--all"]) == 0
    return folder, capfd.readouterr().out


@pytest.mark.slow
def test_files_become_agreement_page_and_recording(compared):
    folder, printed = compared
    assert re.search(r"drop: Model \d+ % high between .* Hz \(mount m1, axial deflection\); lowest ISO/TS 18571", printed)
    for column in ("base, z", "point mass_top, z", "mount m1, axial deflection", "mount m1, axial force"):
        assert column in printed
    assert 'column "T" was saturated' in printed
    page = (folder / "correlation.html").read_text(encoding="utf-8")
    for name in ("histories-drop", "spectra-drop", "transmissibility-drop", "loops-drop", "correlation-drop"):
        assert f'data-id="{name}"' in page
    assert (folder / "correlation.rrd").stat().st_size > 100_000
    # A mount that is a fifth stiffer: about sqrt(1.2) less deflection, 1.10; friction and geometry move it by less than that.
    peak = float(re.search(r"mount m1, axial deflection +([\d.]+)", printed)[1])
    assert 1.03 < peak < 1.25


@pytest.mark.slow
def test_tests_stand_in_the_run_with_checksums_and_it_replays(compared, drop):
    folder, _ = compared
    assert (folder / "measured" / "drop.csv").read_bytes() == drop.read_bytes()
    known = alterations(folder)
    assert known.intact
    assert not known.added
    assert wr.replay(folder).identical
    with pytest.warns(wr.RecordWarning, match="stand at exactly"):
        (again,) = stored_tests(folder)
    assert again.phrases == dict(item.split("=", 1) for item in MAP)
    assert again.baseline == "rest"
    (folder / "measured" / "drop.csv").write_text("time [s],B\n0,1\n")
    assert "altered measured/drop.csv" in alterations(folder).text


@pytest.mark.slow
def test_the_report_of_the_run_says_how_it_agrees(compared):
    folder, _ = compared
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        (page,) = wr.write_report(folder)
    text = page.read_text(encoding="utf-8")
    assert "Against measurements" in text
    assert 'data-id="agreement-drop"' in text


@pytest.mark.slow
def test_a_board_draws_what_was_measured_beside_every_new_run(compared):
    folder, _ = compared
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        board = Board(opened(folder))
        told = [message for _, message in board.act({"do": "judge"})]
    html = told[-1]["html"]["compared"]
    assert "drop: Model " in html
    assert "mount m1, axial deflection" in html
    board.close()


@pytest.mark.slow
def test_a_map_may_be_a_file_and_tests_several(run, drop, tmp_path, capfd):
    folder = tmp_path / "shaker"
    shutil.copytree(run, folder)
    listed = "\n".join(f'{column} = "{phrase}"' for column, phrase in (item.split("=", 1) for item in MAP))
    (tmp_path / "map.toml").write_text(f'baseline = "rest"\n[channels]\n{listed}\n')
    (tmp_path / "again.csv").write_bytes(drop.read_bytes())
    both = [str(drop), str(tmp_path / "again.csv")]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert main(["compare", str(folder), *both, "--map", str(tmp_path / "map.toml"), "--out", str(tmp_path / "both")]) == 0
    assert "lowest ISO/TS 18571" in capfd.readouterr().out
    assert {path.name for path in (tmp_path / "both").iterdir()} == {"correlation.html", "correlation.rrd"}
    page = (tmp_path / "both" / "correlation.html").read_text(encoding="utf-8")
    assert "shaker against drop and again" in page
    assert 'data-id="agreement-drop"' in page
    assert 'data-id="agreement-again"' in page


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--map", "T=point/mass_top z"], 'column "T" has no unit. State it in the header'),
        (
            ["--map", "T=point/mast z g"],
            "mapped to the point 'mast', which this run does not have; its points: mass_top",
        ),
        (["--map", "T=point/mass_top axial g"], "the axis of a point is x, y or z"),
        (["--map", "Q=point/mass_top z g"], 'there is no column "Q"; the columns are B, T, D, F'),
        (["--map", "T=point/mass_top z g", "T=base z g"], "must say once what a column is, got 'T' twice"),
        (["--map", "nonsense"], "`--map` must be COLUMN=PHRASE"),
        (["--map", "missing.toml"], "missing.toml: cannot read this map of a measurement"),
        (["--map", "B=base z g", "--out", "."], "this folder exists and is not a comparison with tests"),
        ([], "drop.csv is no run. If it was measured, say what its columns are"),
        (["--start", "1"], "`--start` is for measured tests, whose columns --map names"),
    ],
)
def test_what_is_wrong_is_one_message(run, drop, capfd, options, message):
    before = sorted(path.name for path in run.iterdir())
    capfd.readouterr()
    assert main(["compare", str(run), str(drop), *options]) == 2
    said = capfd.readouterr().err
    assert message in said
    assert "Traceback" not in said
    assert sorted(path.name for path in run.iterdir()) == before


@pytest.mark.slow
def test_a_table_of_measurements_is_no_damaged_run(run, tmp_path, capfd):
    path = tmp_path / "drop.parquet"
    pq.write_table(pa.table({"time_s": np.arange(100) / 1e3, "A1": np.ones(100)}), path)
    assert main(["compare", str(run), str(path)]) == 2
    assert "drop.parquet is no run. If it was measured, say what its columns are" in capfd.readouterr().err


@pytest.mark.slow
def test_a_clock_that_cannot_be_aligned_and_a_test_too_short_are_said(run, drop, tmp_path, capfd):
    folder = tmp_path / "shaker"
    shutil.copytree(run, folder)
    lines = drop.read_text().splitlines()
    short = tmp_path / "short.csv"
    short.write_text("\n".join(lines[:10]) + "\n")
    assert main(["compare", str(folder), str(short), "--map", "B=base z g"]) == 2
    assert "needs at least 16 samples, this one has 9" in capfd.readouterr().err
    noise = tmp_path / "noise.csv"
    rng = np.random.default_rng(1)
    write(noise, {"time [s]": np.arange(6000) / RATE, "B": rng.standard_normal(6000)})
    assert main(["compare", str(folder), str(noise), "--map", "B=base z g"]) == 0
    assert "no delay makes column" in capfd.readouterr().out


@pytest.mark.slow
def test_another_test_of_the_same_name_is_kept(compared, tmp_path, capfd):
    folder, _ = compared
    other = tmp_path / "other" / "drop.csv"
    other.parent.mkdir()
    lines = (folder / "measured" / "drop.csv").read_text().splitlines()
    other.write_text("\n".join(lines[:-5]) + "\n")
    kept = (folder / "measured" / "drop.csv").read_bytes()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert main(["compare", str(folder), str(other), "--map", *MAP]) == 2
        assert "another test of this name was compared" in capfd.readouterr().err
        assert (folder / "measured" / "drop.csv").read_bytes() == kept
        assert main(["compare", str(folder), str(other), "--map", *MAP, "--names", "second"]) == 0
    assert (folder / "measured" / "second.csv").is_file()
