"""Runs over each other: every run's own samples and scene, what is shared in the same axes, and what differs in words."""

import json
import re
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from made_up_floor import floor_response, peak

from wirerope_mj.assessment.comparison import (
    BASE,
    Component,
    acceleration_rows,
    combined_rows,
    compare_runs,
    difference,
    identical,
    largest_of,
    travel_rows,
)
from wirerope_mj.cli import main
from wirerope_mj.content.comparison import better_run, comparison_content, comparison_lines, difference_text, different_inputs
from wirerope_mj.engine.response.histories import MemorySamples
from wirerope_mj.engine.response.peaks import BodyPeaks, MountPeaks, Peaks, PointPeaks
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.views.colours import RUNS
from wirerope_mj.views.markdown import markdown_blocks
from wirerope_mj.views.recording import read_state, record_overlay, record_rerun
from wirerope_mj.views.recording.animation import with_values
from wirerope_mj.views.recording.drawn_runs import several_runs
from wirerope_mj.views.recording.ghosts import ghost_factor
from wirerope_mj.views.recording.program import viewer_binary

pytestmark = pytest.mark.quick

G = STANDARD_GRAVITY


def louder(response, factor):
    """Return a response whose accelerations, deflections and forces are `factor` times as large, peaks included."""
    names = response.samples.names
    values = response.samples.columns(0, len(names)).copy()
    for column, name in enumerate(names):
        if "acceleration" in name or "deflection" in name or "force" in name:
            values[:, column] *= factor
    changed = with_values(response, values)
    peaks = Peaks(
        bodies={
            n: BodyPeaks(acceleration=peak(changed.time, b.acceleration)) for n, b in changed.bodies.items()
        },
        points={
            n: PointPeaks(
                acceleration=peak(changed.time, p.acceleration),
                relative_displacement=response.peaks.points[n].relative_displacement,
            )
            for n, p in changed.points.items()
        },
        mounts={
            n: MountPeaks(deflection=peak(changed.time, m.deflection), force=peak(changed.time, m.force))
            for n, m in changed.mounts.items()
        },
    )  # fmt: skip
    return replace(changed, peaks=peaks, events=response.events)


def later(response, seconds):
    """Return the response of a simulation whose shock came later, everything else alike."""
    names = response.samples.names
    moved = with_values(response, response.samples.columns(0, len(names)))
    return replace(moved, events=tuple((time + seconds, text) for time, text in response.events))


@pytest.fixture(scope="module")
def floor():
    return floor_response(mounts=3, equipment=1)


@pytest.fixture(scope="module")
def runs(floor):
    return {"A": floor, "run B/2": louder(floor, 1.5)}


@pytest.fixture(scope="module")
def recording(runs, tmp_path_factory):
    return record_overlay(runs, tmp_path_factory.mktemp("overlay"), inputs={"A": {"level_g": "15"}}, state=True)


@pytest.fixture(scope="module")
def entities(recording):
    from rerun.chunk import RrdReader

    found: dict[str, list] = {}
    for chunk in RrdReader(str(recording)).stream():
        found.setdefault(str(chunk.entity_path), []).append(chunk.to_record_batch())
    return found


def column(batches, name):
    return next(batch[name] for batch in batches if name in batch.schema.names)


def drawn(batches):
    """Return instants [s] and values of the one series of an entity."""
    values = column(batches, "Scalars:scalars")
    batch = next(batch for batch in batches if "Scalars:scalars" in batch.schema.names)
    return batch["sim_time"].cast("int64").to_numpy() * 1e-9, values.flatten().to_numpy()


def test_the_file_is_whole_and_alone(recording):
    done = subprocess.run([viewer_binary(), "rrd", "verify", recording], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert [path.name for path in recording.parent.iterdir()] == ["overlay.rrd"]


def test_every_run_keeps_its_samples_bit_for_bit(runs, recording):
    for name, response in runs.items():
        state = read_state(recording, run=name)
        assert list(state) == response.samples.names
        for number, key in enumerate(response.samples.names):
            expected = np.ascontiguousarray(response.samples.columns(number, number + 1)[:, 0])
            assert state[key].tobytes() == expected.tobytes(), (name, key)
    with pytest.raises(RecordError, match="no samples under /runs/C/state"):
        read_state(recording, run="C")


def test_each_scene_is_that_of_a_recording_of_its_own(floor, recording, entities, tmp_path):
    """The same entities with the same rows below the run's root, but for colours of mounts and arrows."""
    from rerun.chunk import RrdReader

    alone: dict[str, list] = {}
    for chunk in RrdReader(str(record_rerun(floor, tmp_path / "alone.rrd"))).stream():
        alone.setdefault(str(chunk.entity_path), []).append(chunk.to_record_batch())
    scene = {path for path in alone if path.startswith("/world/")}
    assert "/world/deck/floor/rack_0" in scene
    assert {path.removeprefix("/runs/A") for path in entities if path.startswith("/runs/A/world/")} == scene
    assert {path for path in entities if path.startswith("/runs/run\\ B\\/2/world/")}
    for path, name in (("/world/deck/floor", "Transform3D:translation"), ("/world/deck/forces", "Arrows3D:vectors")):
        assert column(entities["/runs/A" + path], name).to_pylist() == column(alone[path], name).to_pylist()


def test_shared_histories_stand_in_the_same_axes_in_their_units(runs, entities):
    for path, history in (
        ("/histories/acceleration/total/body/floor", lambda r: np.linalg.norm(r.bodies["floor"].acceleration, axis=1) / G),
        ("/histories/acceleration/z/point/rack_top", lambda r: r.points["rack_top"].acceleration[:, 2] / G),
        ("/histories/acceleration/x/base/base", lambda r: r.base.acceleration[:, 0] / G),
        ("/histories/deflection/axial/m02", lambda r: r.mounts["m02"].deflection[:, 2] * 1e3),
        ("/histories/force/shear/m01", lambda r: r.mounts["m01"].force[:, 1] * 1e-3),
    ):  # fmt: skip
        for name, escaped in (("A", "2/A"), ("run B/2", "1/run\\ B\\/2")):  # the first in front
            time, values = drawn(entities[f"{path}/{escaped}"])
            exact = history(runs[name])
            whole = np.interp(runs[name].time, time, values)
            assert np.abs(whole - exact).max() <= max(np.ptp(history(r)) for r in runs.values()) / 400 * 1.001, path


def test_colours_and_peaks_of_a_run_are_the_same_in_every_view(runs, entities):
    blue, orange = RUNS[:2]
    for rank, name, color in ((2, "A", blue), (1, "run\\ B\\/2", orange)):
        packed = (color[0] << 24) + (color[1] << 16) + (color[2] << 8) + 255
        for path, component in (
            (f"/histories/deflection/axial/m01/{rank}/{name}", "SeriesLines:colors"),
            (f"/histories/deflection/axial/m01/{rank}/{name}/peak", "SeriesPoints:colors"),
            (f"/loops/axial/m01/data/{name}/trail", "LineStrips2D:colors"),
            (f"/loops/axial/m01/data/{name}/cursor", "Points2D:colors"),
            (f"/runs/{name}/world/deck/forces", "Arrows3D:colors"),
        ):
            assert set(column(entities[path], component)[0].as_py()) == {packed}, path
    value = runs["run B/2"].peaks.mounts["m01"].deflection
    farther = value.maximum[2] if value.maximum[2] >= -value.minimum[2] else value.minimum[2]
    marker = drawn(entities["/histories/deflection/axial/m01/1/run\\ B\\/2/peak"])[1][0]
    assert marker == farther / 1e-3


def test_differences_over_time_are_the_norm_of_what_lies_between_the_histories(runs):
    overlay = compare_runs(runs, "start")
    first, other = overlay.runs
    floor = Component(kind="body", name="floor")
    time, distance = difference(floor, first, other)
    expected = 0.5 * np.linalg.norm(runs["A"].bodies["floor"].acceleration, axis=1)
    np.testing.assert_array_equal(time, runs["A"].time)
    np.testing.assert_allclose(distance, expected, atol=1e-12 * expected.max())  # roundoff
    coarse = replace(other, response=floor_response(mounts=3, equipment=1, rows=101, rate=500.0))
    time, distance = difference("m01", first, coarse)
    assert time[-1] == coarse.response.time[-1]  # only where both are
    # Linear between samples 2 ms apart of at most 9 Hz and 45 mm: (2 pi 9)^2 0.045 (2e-3)^2 / 8, twice that with the decay.
    assert distance.max() < 2 * 72e-6


def test_peaks_side_by_side_give_the_change_to_the_first(runs):
    overlay = compare_runs(runs, "start")
    rows = {row.label: row for row in acceleration_rows(overlay)}
    assert list(rows)[0] == "base"
    row = rows["point rack_top"]
    assert row.values[0] == runs["A"].peaks.points["rack_top"].acceleration.value
    assert row.difference(1) == pytest.approx(0.5, rel=1e-12)
    assert difference_text(row, 1) == "+50.0 %"
    along = {row.label: row for row in acceleration_rows(overlay, 0)}["floor"]
    extremes = runs["A"].peaks.bodies["floor"].acceleration
    assert along.values[0] == max(extremes.maximum[0], -extremes.minimum[0])
    shares = {row.label: row for row in travel_rows(overlay)}
    deflection = runs["A"].peaks.mounts["m01"].deflection
    ratios = {"compression": -deflection.minimum[2] / 0.04, "tension": deflection.maximum[2] / 0.02}
    assert shares["m01"].values[0] == pytest.approx(max(ratios.values()), rel=1e-12)
    assert shares["m01"].notes[0] == max(ratios, key=ratios.get)
    most = largest_of(travel_rows(overlay))
    assert most.values[1] == pytest.approx(1.5 * most.values[0], rel=1e-12)
    assert most.notes[0].startswith(travel_rows(overlay)[0].label)
    together = {row.label: row for row in combined_rows(overlay)}
    assert together["m01"].values[1] == pytest.approx(1.5 * together["m01"].values[0], rel=1e-12)
    assert together["m01"].values[0] > shares["m01"].values[0]  # all axes at once use more than any one


def test_words_say_where_and_when_runs_differ(runs):
    lines = comparison_lines(compare_runs(runs, "start"))
    norm = np.linalg.norm(runs["A"].points["rack_top"].acceleration, axis=1)
    when = 1e3 * runs["A"].time[norm.argmax()]
    bodies = np.linalg.norm(runs["A"].bodies["floor"].acceleration, axis=1)
    assert norm.max() > bodies.max()
    # All accelerations grow alike: 50 % of the first's peak at whichever part comes first, at the instant of its peak.
    assert any("accelerations differ most from those of A" in line and f"{when:.1f} ms, 50 % of A's" in line for line in lines)
    assert not any("exceeds 100 %" in line for line in lines)  # every mount of both exceeds its tension


def test_words_say_which_run_exceeds_its_rated_travel():
    lowest = [-entry.deflection.minimum[2] for entry in floor_response(mounts=1).peaks.mounts.values()]
    response = floor_response(mounts=1, travel={"compression": 1.1 * max(lowest)})
    lines = comparison_lines(compare_runs({"A": response, "B": louder(response, 1.5)}, "start"))
    assert "Travel along single axes exceeds 100 %: A: none; B: m01." in lines


def test_the_better_run_exceeds_less_and_is_named_with_its_grounds(runs):
    comparison = compare_runs(dict(reversed(runs.items())))
    said = better_run(comparison)
    assert said.values == {"better": "A"}
    assert said.text.startswith("A is better. run B/2: ")
    assert re.search(r"most critical \w+ combined travel \d+ %", said.text)
    unrated = {name: floor_response(mounts=1, travel={}) for name in ("A", "B")}
    unrated["B"] = louder(unrated["B"], 1.5)
    assert better_run(compare_runs(unrated)).text.startswith("Limits are not stated in every run; A has the smallest peak")


def test_the_same_run_twice_is_said_to_be_identical(floor):
    again = floor_response(mounts=3, equipment=1)
    overlay = compare_runs({"A": floor, "B": again}, "start")
    assert comparison_lines(overlay) == ["B and A are identical: every sample and every peak has the same bits."]
    assert all(difference_text(row, 1) == "=" for row in acceleration_rows(overlay))
    values = again.samples.columns(0, len(again.samples.names)).copy()
    values[7, -1] = np.nextafter(values[7, -1], np.inf)
    assert not identical(floor, replace(again, samples=MemorySamples(again.samples.names, values)))


def test_a_shock_that_comes_later_is_moved_to_the_first_and_its_samples_stay(floor, tmp_path):
    pair = {"A": floor, "B": later(floor, 0.02)}
    overlay = compare_runs(pair, "shock")
    moved = overlay.runs[1]
    assert moved.moved == pytest.approx(-0.02, abs=1e-15)
    np.testing.assert_allclose(moved.response.time, floor.time - 0.02, atol=1e-15)
    assert moved.response.events[0][0] == pytest.approx(0.05, abs=1e-15)
    peaks = moved.response.peaks.bodies["floor"].acceleration
    assert peaks.time == pytest.approx(floor.peaks.bodies["floor"].acceleration.time - 0.02, abs=1e-15)
    assert "B is moved by -20 ms to the shock of A." in comparison_lines(overlay)
    path = record_overlay(pair, tmp_path / "moved.rrd", align="shock", state=True)
    np.testing.assert_array_equal(read_state(path, run="B")["time"], floor.time)
    quiet = floor_response(mounts=1, equipment=0, events=False)
    with pytest.raises(RecordError, match="quiet: nothing begins in this run"):
        compare_runs({"A": floor, "quiet": quiet}, "shock")


def test_different_models_share_what_is_called_alike_and_the_rest_is_listed(floor, tmp_path):
    other = floor_response(mounts=4, equipment=2, travel={})
    overlay = compare_runs({"A": floor, "B": other, "C": floor}, "start")
    assert overlay.alone == {"A": (), "B": (Component(kind="body", name="rack_1"), "m04"), "C": ()}
    assert overlay.components[0] == BASE
    assert "Only in B: body rack_1; mount m04." in comparison_lines(overlay)
    content = comparison_content(overlay, {})
    text = markdown_blocks(block for section in content.sections if section.id == "mounts" for block in section.blocks)
    assert "| m04 | **-** | " in text
    path = record_overlay({"A": floor, "B": other, "C": floor}, tmp_path / "three.rrd", inputs={})
    assert subprocess.run([viewer_binary(), "rrd", "verify", path], capture_output=True).returncode == 0


def test_ghosts_ride_in_the_frame_of_the_base_and_move_larger_by_a_round_factor(runs, entities):
    overlay = several_runs(runs, "start")
    factor = ghost_factor(overlay)
    assert factor in {1.0, 2.0, 5.0, 10.0}
    assert "Transform3D:translation" not in {
        name for batch in entities["/ghosts/A/world/deck/geoms/box"] for name in batch.schema.names
    }
    assert "/ghosts/A/world/deck" not in entities  # the frame of the base is the view's own
    assert "/ghosts/run\\ B\\/2/world/deck/geoms/box" not in entities  # the same base would flicker through itself
    batches = entities["/ghosts/A/world/deck/floor"]
    batch = next(batch for batch in batches if "Transform3D:translation" in batch.schema.names)
    rows = np.round(batch["sim_time"].cast("int64").to_numpy() * 1e-6).astype(int)
    places = np.array([row.as_py()[0] for row in batch["Transform3D:translation"]])
    relative = (runs["A"].bodies["floor"].position - runs["A"].bodies["deck"].position)[rows]
    modelled = np.array([0.0, 0.0, 0.18])  # floor over deck where both stand before the shock
    np.testing.assert_allclose(places, modelled + factor * (relative - modelled), atol=1e-6)  # float32


def test_inputs_that_are_alike_are_not_shown(floor):
    overlay = compare_runs({"A": floor, "B": floor}, "start")
    given = {"A": {"level_g": "15", "direction": "z"}, "B": {"level_g": "20", "direction": "z", "pulse_ms": "5"}}
    assert different_inputs(overlay, given) == [("level_g", ("15", "20")), ("pulse_ms", ("-", "5"))]


def test_long_inputs_stand_below_the_table_which_breaks_no_line(floor):
    overlay = compare_runs({"A": floor, "B": floor}, "start")
    motions = {"A": {"motion": "half-sine 15 g 11 ms along z", "n": "1"}, "B": {"motion": "half-sine 20 g", "n": "2"}}
    (differences,) = [section for section in comparison_content(overlay, motions).sections if section.id == "differences"]
    text = markdown_blocks(differences.blocks)
    assert "| n | 1 | 2 |" in text
    assert "- motion: A: half-sine 15 g 11 ms along z; B: half-sine 20 g" in text
    assert "| motion" not in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"responses": ["A"]}, "`responses` must be two to 8, got 1"),
        ({"responses": list("ABCDEFGHI")}, "`responses` must be two to 8, got 9"),
        ({"align": "end"}, "`align` must be one of 'start', 'shock', got 'end'"),
        ({"tab": "Loops"}, "`tab` must be one of Overview, Accelerations, Deflections, .*Peaks, got 'Loops'"),
        ({"scene": "Top"}, "`scene` must be one of Worst mount, Side by side, Ghosts, got 'Top'"),
    ],
)
def test_a_bad_argument_is_named_and_leaves_nothing(floor, tmp_path, arguments, message):
    names = arguments.pop("responses", ["A", "B"])
    with pytest.raises(ValueError, match=message):
        record_overlay(dict.fromkeys(names, floor), tmp_path / "x.rrd", **arguments)
    assert list(tmp_path.iterdir()) == []


def test_runs_that_share_nothing_are_refused():
    one = floor_response(mounts=1, equipment=0, base="", rows=60)
    scene = replace(one.scene, mounts=())
    peaks = Peaks(bodies={"block": one.peaks.bodies["floor"]}, points={}, mounts={})
    other = replace(one, scene=scene, peaks=peaks, mounts={}, points={}, bodies={})
    with pytest.raises(RecordError, match="A, B: these runs share no base, body, point or mount"):
        compare_runs({"A": one, "B": other}, "start")


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """Two short runs of a scenario that ships with the package."""
    place = tmp_path_factory.mktemp("runs")
    for level in ("10", "12"):
        code = main(["run", "shock_table", "--duration", "0.12", "--level-g", level, "--out", str(place / f"g{level}")])
        assert code == 0
    return place


@pytest.mark.slow
def test_compare_writes_a_folder_as_every_command_does(saved, tmp_path, capsys):
    out = tmp_path / "both"
    command = ["compare", str(saved / "g10"), str(saved / "g12"), "--out", str(out)]
    assert main(command) == 0
    printed = capsys.readouterr().out
    assert f"wirerope show {out}" in printed
    assert "report.html, with every table" in printed  # so that nothing is computed again for them
    assert "the same with --force" not in printed
    assert {path.name for path in out.iterdir()} == {"comparison.json", "report.html", "run.rrd"}
    figures = json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    page = (out / "report.html").read_text(encoding="utf-8")
    for name in ("findings", "accelerations"):
        assert name in figures
        assert f'data-id="{name}"' in page
    assert main(command) == 2
    assert "there is a comparison already. Replace it with --force" in capsys.readouterr().err
    assert main([*command, "--force"]) == 0


def test_compare_prints_what_differs_and_writes_one_file(saved, tmp_path, capsys):
    from rerun.chunk import RrdReader

    out = tmp_path / "both.rrd"
    capsys.readouterr()
    assert main(["compare", str(saved / "g10"), str(saved / "g12"), "--out", str(out), "--all"]) == 0
    printed = capsys.readouterr().out
    assert "Inputs that differ" in printed
    assert any(line.split()[:3] == ["level_g", "10", "12"] for line in printed.splitlines())
    base = next(line for line in printed.splitlines() if line.strip().startswith("base"))
    assert "10.00" in base
    assert "12.00" in base
    assert "+20.0 %" in base
    assert f"wirerope show {out}" in printed
    assert out.is_file()
    assert main(["compare", str(saved / "g10"), str(saved / "g12"), "--out", str(out)]) == 2
    assert capsys.readouterr().err.endswith("Replace it with --force (`force=True`), or choose another name.\n")
    arguments = [
        "compare",
        str(saved / "g10"),
        str(saved / "g10"),
        "--names",
        "old",
        "new",
        "--out",
        str(out),
        "--force",
    ]
    assert main(arguments) == 0
    assert "new and old are identical" in capsys.readouterr().out
    assert any(str(chunk.entity_path).startswith("/runs/new/world") for chunk in RrdReader(str(out)).stream())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["g10"], "compare takes two runs or more, got 1"),
        (["g10", "."], "there is no response.parquet here; a run folder holds one"),
        (["g10", "g12", "--names", "A", "A"], "`--names` must be different names, got 'A' 2 times"),
        (["g10", "g12", "--names", "A"], "`--names` must be one for each of the 2 runs, got 1"),
        (["g10", "g12", "--names", "A", " "], "`--names` must not be empty"),
        (["g10", "g12", "--out", "."], "this folder exists and is not a comparison; nothing in it was touched"),
        (["g10", "g12", "--out", "folder.rrd"], "this is a folder; a file is written here"),
        (["g10", "g12", "--out", "new/both.rrd"], "there is no folder"),
        (["g10", "g12", "--align", "end"], "Invalid value"),
    ],
)
def test_a_bad_comparison_gets_one_message_and_leaves_nothing(saved, tmp_path, monkeypatch, capsys, arguments, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.rrd").mkdir()
    places = [str(saved / word) if word.startswith("g1") else word for word in arguments]
    capsys.readouterr()
    assert main(["compare", *places]) == 2
    printed = capsys.readouterr()
    assert printed.err.count("\n") == 1
    assert message in printed.err
    assert printed.out == ""
    assert [path.name for path in tmp_path.iterdir()] == ["folder.rrd"]


def test_folders_of_one_name_are_told_apart(saved, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for place in ("a", "b"):
        (tmp_path / place).mkdir()
        (tmp_path / place / "run").symlink_to(saved / "g10")
    capsys.readouterr()
    assert main(["compare", "a/run", "b/run", "--out", "x.rrd", "--all"]) == 0
    assert "b/run and a/run are identical" in capsys.readouterr().out
