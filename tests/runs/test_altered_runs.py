"""Run folders that were edited or damaged since they were written."""

import json
import shutil
import subprocess
import tomllib
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import tomli_w
from house import hysteresis, sdof_text

import wirerope_mj as wr
from wirerope_mj.cli.app import main
from wirerope_mj.foundation.errors import RecordError, RecordWarning
from wirerope_mj.runs import replay, run_scenario
from wirerope_mj.runs.folder import CHECKSUMS, alterations
from wirerope_mj.runs.report import write_report
from wirerope_mj.runs.scenario import Scenario

KEY = b"wirerope_mj"


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Path:
    """Return the run of a mass on one mount, which is struck from below."""
    folder = tmp_path_factory.mktemp("runs") / "run"
    isolator = wr.Isolator(name="a", axial=wr.BoucWen(**hysteresis(alpha=6e4, z_max=40.0), k=2e4))
    motion = wr.HalfSine(peak=60.0, duration=0.01, direction="z", start=0.005)
    simulate = {"duration": 0.05, "timestep": 1e-3, "sample_rate": 500.0}
    text = sdof_text(gravity=9.80665)
    run_scenario(Scenario("How far?", text, motion, simulate, isolators={"a": isolator}, options={"level": 6.0}), folder)
    return folder


@pytest.fixture
def run(written, tmp_path) -> Path:
    return Path(shutil.copytree(written, tmp_path / "run"))


def edit_scenario(run: Path, table: str, **values) -> None:
    path = run / "scenario.toml"
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    content[table] |= values
    path.write_text(tomli_w.dumps(content), encoding="utf-8")


def edit_metadata(run: Path, edit) -> None:
    path = run / "response.parquet"
    table, content = pq.read_table(path), json.loads(pq.read_metadata(path).metadata[KEY])
    edit(content)
    pq.write_table(table.replace_schema_metadata({KEY: json.dumps(content).encode()}), path)


def edit_summary(run: Path, edit) -> None:
    content = json.loads((run / "summary.json").read_text(encoding="utf-8"))
    edit(content)
    (run / "summary.json").write_text(json.dumps(content, indent=2), encoding="utf-8")


def as_an_older_version(run: Path) -> Path:
    """Return the run without what tells which files were altered: then the numbers alone must tell."""
    (run / CHECKSUMS).unlink()
    return run


def test_checksums_are_those_of_sha256sum(run):
    subprocess.run(["sha256sum", "--check", "--strict", "--quiet", CHECKSUMS], cwd=run, check=True)
    listed = {line.split("  ")[1] for line in (run / CHECKSUMS).read_text(encoding="utf-8").splitlines()}
    there = {path.relative_to(run).as_posix() for path in run.rglob("*") if path.is_file()}
    assert listed == there - {CHECKSUMS}
    assert "model/a.toml" in listed


def test_replay_of_a_run_as_written_is_identical_and_intact(run, capsys):
    result = replay(run)
    assert (result.identical, result.intact, result.column) == (True, True, "")
    assert main(["replay", str(run)]) == 0
    assert "No file was altered" in capsys.readouterr().out


def test_replay_names_the_files_that_were_altered_added_and_removed(run, capsys):
    (run / "histories.png").write_bytes(b"another picture")
    (run / "loops.png").unlink()
    (run / "notes.txt").write_text("seen", encoding="utf-8")
    result = replay(run)
    assert result.identical
    assert not result.intact
    assert result.alterations.altered == ("histories.png",)
    assert result.alterations.missing == ("loops.png",)
    assert result.alterations.added == ("notes.txt",)
    assert main(["replay", str(run)]) == 1
    assert "altered histories.png; missing loops.png; added notes.txt" in capsys.readouterr().out


def test_replay_of_an_older_run_says_that_alterations_are_not_known(run, capsys):
    assert replay(as_an_older_version(run)).alterations is None
    assert main(["replay", str(run)]) == 0
    assert "not known" in capsys.readouterr().out


def raise_peak(content):
    content["peaks"]["bodies"]["mass"]["acceleration"][0] *= 1.0 + 1e-6


def change_instant(content):
    content["peaks"]["mounts"]["m1"]["force"][1] += 1e-6


def change_state(content):
    content["states"][1][1] = content["states"][0][1]


def change_travel(content):
    content["scene"]["mounts"][0]["travel"]["compression"] = 0.1


@pytest.mark.parametrize(
    ("edit", "where"),
    [
        (raise_peak, "peaks.bodies.mass.acceleration"),
        (change_instant, "peaks.mounts.m1.force"),
        (change_state, "final_state"),
        (change_travel, "scene mounts.m1.travel"),
        (lambda content: content["numerics"].update(steps=7), "numerics steps"),
    ],
)
def test_replay_finds_a_number_that_was_changed_beside_the_samples(run, edit, where, capsys):
    edit_metadata(as_an_older_version(run), edit)
    result = replay(run)
    assert not result.agrees
    assert main(["replay", str(run)]) == 1
    assert "do not agree" in capsys.readouterr().out
    assert where in result.column  # and not in summary.json, which repeats it


def test_replay_finds_a_verdict_that_was_changed_in_the_summary(run):
    edit_summary(as_an_older_version(run), lambda content: content["mounts"][0]["extreme_force_N"].update(axial=1.0))
    result = replay(run)
    assert not result.agrees
    assert "summary.json mounts.m1.extreme_force_N.axial" in result.column


def test_samples_that_are_not_numbers_are_never_identical(run):
    path = as_an_older_version(run) / "response.parquet"
    table = pq.read_table(path)
    place = table.column_names.index("bodies/mass/velocity/z")
    values = table.column(place).to_numpy().copy()
    values[3] = np.nan
    changed = table.set_column(place, pa.field("bodies/mass/velocity/z", pa.float64()), pa.array(values))
    pq.write_table(changed.replace_schema_metadata({KEY: pq.read_metadata(path).metadata[KEY]}), path)
    with pytest.raises(RecordError, match=r"response\.parquet: column 'bodies/mass/velocity/z' is not finite at sample 3"):
        replay(run)


@pytest.mark.parametrize(
    ("table", "values", "message"),
    [
        ("simulate", {"durration": 1.0}, "[simulate] `durration` is unknown; known: duration"),
        ("simulate", {"sample_rate": float("nan")}, "[simulate] `sample_rate` must be a finite number > 0 [Hz], got nan"),
        ("simulate", {"duration": 1e9}, "make 500000000001 samples, and response.parquet holds 26"),
        ("simulate", {"timestep": 1e-9}, "`simulate.timestep` is 1e-09, and response.parquet was computed with 0.001"),
        ("model", {"file": 3}, "[model] `file` must be a text, got 3"),
        ("model", {"file": "../../model.xml"}, "model file '../../model.xml' is not in this folder"),
        ("model", {"file": "\0"}, "is not in this folder"),
        ("motion", {"peak": 90.0}, "`motion.peak` is 90.0, and response.parquet was computed with 60.0"),
        ("motion", {"terms": 3}, "`motion.terms` must be a list, got 3"),
        ("motion", {"peak": float("inf")}, "scenario.toml: `motion`: `peak` must be a finite number, got inf"),
    ],
)
def test_a_scenario_that_was_edited_is_refused_by_file_and_key(run, table, values, message):
    edit_scenario(run, table, **values)
    with pytest.raises(RecordError) as refused:
        replay(run)
    assert message in str(refused.value)
    assert "altered scenario.toml" in str(refused.value)
    with pytest.warns(RecordWarning, match=r"altered scenario\.toml"), pytest.raises(RecordError) as refused:
        write_report(run)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (
            lambda c: c["peaks"]["mounts"]["m1"]["deflection"].pop(),
            r"\[peaks\.mounts\.m1\.deflection\] it must be 17 finite",
        ),
        (lambda c: c["peaks"]["bodies"].pop("mass"), "`peaks` `bodies` must be of deck, mass"),
        (
            lambda c: c["scene"]["bodies"][1]["geoms"][0].update(size=[0.1]),
            r"\[scene\.bodies\.1\.geoms\.0\] `size` must be 3 finite numbers",
        ),
        (
            lambda c: c["scene"]["mounts"][0].update(colour=1),
            r"\[\[scene\.mounts\]\] 1 `colour` is unknown; known: name",
        ),
        (
            lambda c: c["scene"]["mounts"][0]["travel"].update(up=1.0),
            "`scene.mounts.m1.travel` must be .*, got 'up'",
        ),
        (lambda c: c["events"].append([1.0]), "`events` must be a list of"),
        (lambda c: c.update(motion=[]), "`motion` must be a table"),
        (lambda c: c["states"][0].__setitem__(1, "AAAA"), r"`states` must be float64 numbers"),
        (lambda c: c["numerics"].update(timestep="x"), r"\[numerics\] `timestep` must be a finite number > 0, got"),
        (lambda c: c["bodies"].reverse(), "its columns are not those of its bodies, points and mounts: their order"),
    ],
)
def test_metadata_of_the_wrong_shape_is_refused_by_file_and_key(run, edit, message):
    edit_metadata(run, edit)
    with pytest.raises(RecordError, match=rf"response\.parquet: {message}.* take it from another copy"):
        wr.load_response(run)


def test_damaged_pages_of_samples_are_named_when_they_are_read(run):
    path = run / "response.parquet"
    content = bytearray(path.read_bytes())
    column = pq.read_metadata(path).row_group(0).column(12)
    content[column.data_page_offset + column.total_compressed_size - 1] ^= 0xFF
    path.write_bytes(bytes(content))
    response = wr.load_response(run)
    name = response.samples.names[12]
    with pytest.raises(RecordError, match=f"response.parquet: the samples are damaged in column '{name}'"):
        response.samples.columns(12, 13)


def test_a_report_that_is_made_again_keeps_the_checksums(run):
    write_report(run)
    found = alterations(run)
    assert found.intact
    assert found.added == ()
    write_report(run, out=run / "second.html")
    assert alterations(run).added == ()


def test_report_and_comparison_warn_of_altered_files(written, run, tmp_path, capsys):
    edit_metadata(run, raise_peak)
    assert main(["report", str(run)]) == 0
    assert main(["compare", str(written), str(run), "--out", str(tmp_path / "both.rrd")]) == 0
    warnings = [line for line in capsys.readouterr().err.splitlines() if "altered response.parquet" in line]
    assert len(warnings) == 2


def test_damaged_checksums_are_refused_by_line(run):
    text = (run / CHECKSUMS).read_text(encoding="utf-8")
    (run / CHECKSUMS).write_text(text.replace("  model/a.toml", " "), encoding="utf-8")
    with pytest.raises(RecordError, match=r"checksums\.txt: line \d+ is not a SHA-256 checksum .* remove it"):
        replay(run)
