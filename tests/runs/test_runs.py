import json
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import mount_peaks
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.resources import catalogue_folder, models_folder
from wirerope_mj.runs import replay, run_scenario
from wirerope_mj.runs import write as write_module
from wirerope_mj.runs.folder import digest_of
from wirerope_mj.runs.scenario import Scenario, load_scenario
from wirerope_mj.runs.scenario_file import scenario_content

FILES = {
    "scenario.toml", "response.parquet", "summary.json", "run.rrd", "histories.png", "loops.png", "report.html", "model",
    "checksums.txt",
}  # fmt: skip


def short_table(**options) -> Scenario:
    return load_scenario("shock_table").make(duration=0.4, **options)


@pytest.fixture(scope="module")
def table(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "table"
    run_scenario(short_table(), folder)
    return folder


def copy(folder: Path, place: Path) -> Path:
    return Path(shutil.copytree(folder, place / "copy"))


def test_a_run_folder_holds_everything(table):
    assert {path.name for path in table.iterdir()} == FILES
    assert (table / "model" / "isolators" / "enidine_wr12_400.toml").is_file()
    assert not [path for path in table.parent.iterdir() if path != table]  # nothing is left beside it


def test_run_scenario_returns_the_response_that_lies_in_the_folder(tmp_path):
    response = wr.run_scenario(short_table(), tmp_path / "run")
    stored = wr.load_response(tmp_path / "run")
    columns = len(stored.samples.names)
    np.testing.assert_array_equal(response.samples.columns(0, columns), stored.samples.columns(0, columns))


def test_scenario_toml_resolves_every_input(table):
    content = tomllib.loads((table / "scenario.toml").read_text(encoding="utf-8"))
    assert content["question"].startswith("How far")
    assert content["options"]["level_g"] == 20.0
    assert content["model"]["file"] == "model/shock_table.xml"
    assert content["simulate"]["timestep"] == wr.load_response(table).timestep
    assert content["simulate"]["initial"] == "settled"
    assert content["motion"]["peak"] == 20.0 * wr.STANDARD_GRAVITY
    assert {"mujoco", "wirerope-mj"} <= set(content["versions"])


@pytest.mark.quick
def test_the_copied_model_loads_by_itself_with_the_same_isolator(table, monkeypatch, tmp_path):
    monkeypatch.setattr("wirerope_mj.mounts.vendor_parts.parts.catalogue_folder", lambda: tmp_path)
    copied = wr.load_system(table / "model" / "shock_table.xml")
    original = wr.load_isolator(catalogue_folder() / "enidine_wr12_400.toml")
    assert copied.mounts["m1"].isolator == original


def test_summary_judges_the_peaks_against_the_rated_travel(table):
    content = json.loads((table / "summary.json").read_text(encoding="utf-8"))
    mount, response = content["mounts"][0], wr.load_response(table)
    lowest = response.peaks.mounts["m1"].deflection.minimum[2]
    assert mount["lowest_deflection_m"]["axial"] == lowest < 0.0  # a mass that is struck from below compresses its mount
    assert mount["share_of_travel"]["compression"] == -lowest / 0.0401
    assert mount["share_of_travel"]["tension"] is None
    block = next(row for row in content["accelerations"] if row["name"] == "block")
    assert block["peak_g"] == response.peaks.bodies["block"].acceleration.value / wr.STANDARD_GRAVITY


def test_a_mount_beyond_its_travel_is_said_to_exceed_it(tmp_path):
    response = run_scenario(short_table(level_g=60.0), tmp_path / "run")
    row = mount_peaks(response)[0]
    assert row.utilisation > 1.0
    assert row.exceeded == ["compression"]
    content = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))
    assert content["mounts"][0]["verdict"] == "exceeds compression"
    assert any("exceeded in compression by m1" in line for line in content["verdicts"])


@pytest.mark.quick
def test_replay_is_bit_identical_from_the_folder_alone(table, tmp_path, monkeypatch):
    moved = copy(table, tmp_path)
    nothing = tmp_path / "nothing"
    monkeypatch.setattr("wirerope_mj.mounts.vendor_parts.parts.catalogue_folder", lambda: nothing)
    monkeypatch.setattr("wirerope_mj.foundation.resources._PACKAGE", nothing)
    result = replay(moved)
    assert result.identical
    assert result.largest_difference == 0.0


@pytest.mark.quick
def test_a_run_of_an_older_version_without_checksums_or_contacts_is_replayed():
    result = replay(Path(__file__).parents[1] / "data" / "run_before_checksums")
    assert result.agrees  # bit for bit where it was written; another processor may round otherwise
    assert result.alterations is None
    assert result.response.peaks.contacts is not None


def test_replay_of_a_streamed_run_is_bit_identical(tmp_path, monkeypatch):
    monkeypatch.setattr(write_module, "STREAM_SAMPLES", 100)
    response = run_scenario(short_table(), tmp_path / "run")
    assert response.time.size == 801  # 0.4 s at 2 kHz, both ends
    assert replay(tmp_path / "run").identical


@pytest.mark.quick
def test_replay_names_the_difference_that_a_changed_isolator_makes(table, tmp_path):
    moved = copy(table, tmp_path)
    file = moved / "model" / "isolators" / "enidine_wr12_400.toml"
    content = tomllib.loads(file.read_text(encoding="utf-8"))
    content["axial"]["laws"][0]["alpha"] *= 1.01
    wr.Isolator.from_dict(content).save(file)
    result = replay(moved)
    assert not result.agrees
    assert 1e-5 < result.largest_difference < 1.0  # one per cent of a stiffness is seen, and does not change the physics
    assert result.column


@pytest.mark.quick
def test_replay_refuses_a_folder_that_lacks_an_isolator(table, tmp_path):
    moved = copy(table, tmp_path)
    (moved / "model" / "isolators" / "enidine_wr12_400.toml").unlink()
    with pytest.raises(RecordError, match="isolator file 'isolators/enidine_wr12_400.toml' is missing"):
        replay(moved)


def test_replay_refuses_a_damaged_scenario(table, tmp_path):
    moved = copy(table, tmp_path)
    (moved / "scenario.toml").write_text("format = 1\n", encoding="utf-8")
    with pytest.raises(RecordError, match=r"scenario\.toml: `name` is missing; needed: .* take the file from another copy"):
        replay(moved)


def test_an_existing_run_is_replaced_only_with_force(table, tmp_path):
    moved = copy(table, tmp_path)
    before = (moved / "response.parquet").read_bytes()
    with pytest.raises(RecordError, match="there is a run already. Replace it with --force"):
        run_scenario(short_table(), moved)
    assert (moved / "response.parquet").read_bytes() == before
    run_scenario(short_table(level_g=10.0), moved, force=True)
    assert tomllib.loads((moved / "scenario.toml").read_text(encoding="utf-8"))["options"]["level_g"] == 10.0
    assert list(tmp_path.iterdir()) == [moved]


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_that_is_not_a_run_is_never_touched(tmp_path, force):
    (tmp_path / "thesis.txt").write_text("years of work", encoding="utf-8")
    with pytest.raises(RecordError, match="exists and is not a run"):
        run_scenario(short_table(), tmp_path, force=force)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_an_empty_folder_may_become_a_run(tmp_path):
    run_scenario(short_table(), tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == FILES


@pytest.mark.quick
@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError("no space left")])
def test_a_run_that_does_not_end_leaves_nothing_and_keeps_the_old_one(table, tmp_path, monkeypatch, error):
    moved = copy(table, tmp_path)
    before = sorted((path.name, path.stat().st_mtime_ns) for path in moved.iterdir())

    def fail(*_, **__):
        raise error

    monkeypatch.setattr("wirerope_mj.views.recording.record.record_run", fail)
    for folder, force in ((tmp_path / "deep" / "new", False), (moved, True)):
        with pytest.raises(type(error) if isinstance(error, OSError) else error):
            run_scenario(short_table(), folder, force=force)
    assert list(tmp_path.iterdir()) == [moved]
    assert sorted((path.name, path.stat().st_mtime_ns) for path in moved.iterdir()) == before


@pytest.mark.slow
def test_a_record_is_copied_and_read_from_the_folder(tmp_path):
    source = tmp_path / "elsewhere" / "deck.csv"
    source.parent.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "data" / "deck_shock.csv", source)
    motion = wr.load_record(source)
    scenario = Scenario("?", "floating_floor.xml", motion, {"duration": 0.1, "timestep": 1e-3}, name="measured")
    run_scenario(scenario, tmp_path / "run")
    shutil.rmtree(source.parent)
    assert (tmp_path / "run" / "inputs" / "deck.csv").is_file()
    assert replay(tmp_path / "run").identical


def mjcf(file: str) -> str:
    text = (models_folder() / "shock_table.xml").read_text(encoding="utf-8")
    return text.replace('data="isolators/enidine_wr12_400.toml"', f'data="{file}"')


@pytest.mark.slow
@pytest.mark.parametrize("file", ["isolators/made_up.toml", "made_up", "../outside/made_up.toml", "/nowhere/made_up.toml"])
def test_isolators_in_memory_are_kept_with_the_model_text_that_names_them(tmp_path, file):
    made_up = wr.Isolator(name="made up", axial=wr.BoucWen(alpha=2e5, beta=100.0, gamma=0.0, n=1.0, k=2e5))
    motion = wr.HalfSine(peak=50.0, duration=0.011, direction="z")
    scenario = Scenario("?", mjcf(file), motion, {"duration": 0.05}, isolators={"wr12_400": made_up})
    run_scenario(scenario, tmp_path / "run")
    (model,) = (tmp_path / "run" / "model").glob("*.xml")
    assert wr.load_system(model).mounts["m1"].isolator == made_up
    assert not (tmp_path / "outside").exists()
    assert replay(tmp_path / "run").identical


def test_included_files_and_meshes_travel_with_the_model(tmp_path):
    source = tmp_path / "source"
    (source / "assets").mkdir(parents=True)
    vertices = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    (source / "assets" / "wedge.obj").write_text(vertices, encoding="utf-8")
    (source / "part.xml").write_text(
        '<mujocoinclude><asset><mesh name="wedge" file="wedge.obj"/></asset></mujocoinclude>', encoding="utf-8"
    )
    text = mjcf("isolators/enidine_wr12_400.toml").replace(
        "<worldbody>",
        '<compiler meshdir="assets"/><include file="part.xml"/><worldbody><geom type="mesh" mesh="wedge"/>',
    )
    (source / "main.xml").write_text(text, encoding="utf-8")
    motion = wr.HalfSine(peak=50.0, duration=0.011, direction="z")
    run_scenario(Scenario("?", source / "main.xml", motion, {"duration": 0.02}), tmp_path / "run")
    shutil.rmtree(source)
    assert replay(tmp_path / "run").identical


def test_arguments_that_the_run_decides_are_refused(tmp_path):
    motion = wr.HalfSine(peak=50.0, duration=0.011, direction="z")
    with pytest.raises(ModelError, match="takes duration, initial.*got 'out'"):
        run_scenario(Scenario("?", "shock_table", motion, {"duration": 1.0, "out": "x"}), tmp_path / "run")
    with pytest.raises(ModelError, match="must say the duration"):
        run_scenario(Scenario("?", "shock_table", motion, {}), tmp_path / "run")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b'format = "1"\n\xff', r"scenario\.toml, line 2: .*it is not a text file in UTF-8"),
        (b"format = 1,5", r"scenario\.toml: not valid TOML: .*line 1"),
        (b"a = " + b"[" * 20_000, r"scenario\.toml: not valid TOML: .*too deeply"),
    ],
)
def test_a_scenario_that_is_no_toml_is_named_with_line_and_remedy(tmp_path, content, said):
    (tmp_path / "scenario.toml").write_bytes(content)
    with pytest.raises(RecordError, match=f"{said}.* take the file from another copy"):
        scenario_content(tmp_path)


def test_a_file_of_a_run_that_the_system_does_not_read_is_named(tmp_path, monkeypatch):
    with pytest.raises(RecordError, match=f"{tmp_path}: this is a folder. Name a file in it"):
        digest_of(tmp_path)

    def refused(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refused)
    with pytest.raises(RecordError, match=r"deck\.xml: you have no permission to read it"):
        digest_of(tmp_path / "deck.xml")
