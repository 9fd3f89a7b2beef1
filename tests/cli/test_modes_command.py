"""`wirerope modes`: the table, the folder, the recording of the shapes in motion, and what is refused."""

import json
import subprocess
import tomllib

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli.app import main
from wirerope_mj.dynamics.modes import modes
from wirerope_mj.dynamics.modes.animation import PERIODS, ROWS, animated_modes
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.views.recording.frequencies import MODE, mode_text, record_modes
from wirerope_mj.views.recording.program import viewer_binary


@pytest.fixture(scope="module")
def cabinet():
    """Return the cabinet and its modes."""
    system = wr.load_system(models_folder() / "cabinet.xml")
    return system, modes(system)


@pytest.fixture
def recordable(monkeypatch):
    """Let recordings be made whatever the environment says."""
    monkeypatch.delenv("RERUN", raising=False)


def test_the_command_prints_every_mode_and_writes_a_folder(capsys, tmp_path, recordable):
    folder = tmp_path / "modes"
    assert main(["modes", "shock_table", "--amplitude-mm", "1", "5", "--out", str(folder)]) == 0
    shown = capsys.readouterr().out
    system = wr.load_system(models_folder() / "shock_table.xml")
    small, *large = (modes(system, amplitude=size) for size in (None, 1e-3, 5e-3))
    rows = [f"{1e3 * m.amplitude:g} {m.frequencies[2]:.3f} {100 * m.damping_ratio[2]:.1f}" for m in large]
    rows.append(f"small {small.frequencies[2]:.3f} 0.0")
    words = " ".join(shown.split())
    for expected in (*(f"3 bounce z {row}" for row in rows), "Quote the small-amplitude natural frequency"):
        assert expected in words
    assert "Stability: stable, large margin." in shown
    assert {path.name for path in folder.iterdir()} == {"settings.toml", "modes.json", "run.rrd", "model"}
    results = json.loads((folder / "modes.json").read_text())["results"]
    assert [result["amplitude_m"] for result in results] == [None, 0.001, 0.005]
    assert [mode["word"] for mode in results[0]["modes"]] == ["sway x", "sway y", "bounce z"]
    assert tomllib.loads((folder / "settings.toml").read_text())["question"]["history"] == "virgin"
    again = wr.load_system(folder / "model" / "shock_table.xml")
    assert modes(again).frequencies[2] == results[0]["modes"][2]["frequency_Hz"]


def test_amplitudes_beyond_a_rated_travel_are_said(capsys, tmp_path, recordable):
    """shock_table's m1 is rated 40.1 mm in compression, and its sag counts."""
    assert main(["modes", "shock_table", "--amplitude-mm", "5", "60", "--out", str(tmp_path / "modes")]) == 0
    shown = capsys.readouterr().out
    system = wr.load_system(models_folder() / "shock_table.xml")
    isolator, sag = system.mounts["m1"].isolator, -1e3 * wr.equilibrium(system).mounts["m1"].deflection[2]
    assert sag > 1.0  # a per cent and more of the travel: left out, it would show
    compression, tension = isolator.rated_travel("axial")
    shares = [(60.0 + sag) / (1e3 * compression)] + ([] if tension is None else [(60.0 - sag) / (1e3 * tension)])
    assert "60 mm takes mounts beyond their rated travel: m1" in shown
    assert f"up to {100 * max(*shares, 60.0 / (1e3 * isolator.rated_travel('roll')[0])):.0f} % of it" in shown
    assert "\n  5 mm takes" not in shown


def test_two_equal_modes_show_equal_damping_in_percent(capsys, tmp_path, recordable):
    assert main(["modes", "shock_table_frame", "--out", str(tmp_path / "modes")]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    found = modes(wr.load_system(models_folder() / "shock_table_frame.xml"))
    assert found.descriptions[3] == "frame: bounce z"
    assert f"frame: bounce z {found.frequencies[3]:.3f} {100 * found.damping_ratio[3]:.1f} " in shown
    assert 0.01 < found.damping_ratio[3] < 0.03  # the frame's own 2 %; that of the block's rope is none in small cycles


def test_what_is_there_is_replaced_only_by_force(capsys, tmp_path, recordable):
    file = tmp_path / "shapes.rrd"
    assert main(["modes", "sdof_shaker", "--out", str(file)]) == 0
    assert main(["modes", "sdof_shaker", "--out", str(file)]) == 2
    assert "--force" in capsys.readouterr().err
    assert main(["modes", "sdof_shaker", "--out", str(file), "--force"]) == 0
    foreign = tmp_path / "mine"
    foreign.mkdir()
    (foreign / "thesis.txt").write_text("do not touch")
    assert main(["modes", "sdof_shaker", "--out", str(foreign), "--force"]) == 2
    assert (foreign / "thesis.txt").read_text() == "do not touch"


@pytest.mark.parametrize("arguments", [["--amplitude-mm", "0"], ["--amplitude-mm", "-3"], ["--history", "old"]])
def test_bad_input_is_one_message(capsys, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    assert main(["modes", "sdof_shaker", *arguments]) == 2
    assert capsys.readouterr().err.count("\n") <= 2
    assert not list(tmp_path.iterdir())


def test_the_recording_is_whole_and_holds_every_mode(tmp_path, cabinet, recordable):
    from rerun.chunk import RrdReader

    path = record_modes(animated_modes(*cabinet), tmp_path)
    assert path == tmp_path / "run.rrd"
    assert subprocess.run([str(viewer_binary()), "rrd", "verify", str(path)], capture_output=True).returncode == 0
    texts, moving = [], set()
    for chunk in RrdReader(path).stream():
        batch = chunk.to_record_batch()
        if str(chunk.entity_path) == f"/{MODE}":
            texts += [text[0] for text in batch.column("TextDocument:text").to_pylist()]
        if str(chunk.entity_path) == "/world/deck/rack" and not chunk.is_static:
            moving |= set(batch.column(MODE).to_pylist())
    assert [text.split("\n")[0] for text in texts] == [
        f"### Mode {number + 1}: {word}" for number, word in enumerate(cabinet[1].descriptions)
    ]
    assert moving == {1, 2, 3, 4, 5, 6}


def test_no_mount_is_judged_by_the_amplitude_that_is_drawn(tmp_path, recordable):
    from rerun.chunk import RrdReader

    system = wr.load_system("floating_floor")
    path = record_modes(animated_modes(system, modes(system)), tmp_path)
    labels, entities, coloured = [], set(), []
    for chunk in RrdReader(path).stream():
        entities.add(str(chunk.entity_path).rsplit("/", 1)[-1])
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if name.endswith(":labels"):
                labels += batch[name].flatten().to_pylist()
            if name == "Boxes3D:colors" and not chunk.is_static:
                coloured.append(str(chunk.entity_path))
    assert "m16" in labels
    assert not [label for label in labels if "%" in label]
    assert not entities & {"worst", "ring"}
    assert not coloured, "bars that change colour say what is used of limits"


def test_the_film_shows_the_shapes_and_ropes_end_on_the_rack(cabinet):
    system, found = cabinet
    film = animated_modes(system, found)
    rack = film.response.bodies["rack"].position
    rest = found.equilibrium
    for mode in range(6):
        first = mode * PERIODS * ROWS
        swing = rack[first] - rack[first + ROWS // 2]  # from one extreme to the other
        expected = 2.0 * film.amplitude * found.payloads["rack"].translation[mode]
        # Turning by up to 0.1 rad bends the way by its square.
        np.testing.assert_allclose(swing, expected, atol=0.02 * film.amplitude)
        moved = np.array([m.deflection[first] - rest.mounts[name].deflection for name, m in film.response.mounts.items()])
        assert np.linalg.norm(moved, axis=1).max() == pytest.approx(film.amplitude, rel=1e-9)


def test_the_text_of_a_mode_has_its_figures(cabinet):
    found = cabinet[1]
    bounce = found.descriptions.index("bounce z")
    text = mode_text(found, bounce)
    frequencies = [f"{values[bounce]:.3f} Hz" for values in (found.frequencies, found.loading, found.unloading)]
    mass = f"{100 * found.participation[bounce, 2]:.1f} % z"
    for expected in ("bounce z", *frequencies, mass, "| m01 |"):
        assert expected in text
    assert found.loading[bounce] < found.frequencies[bounce] < found.unloading[bounce]
