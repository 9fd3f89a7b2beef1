"""The comfort of people at points of a run: printed from its folder, with the limits of ISO 6954 or the reason for none."""

import numpy as np
import pytest
from commands import refused

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.content.comfort import comfort_content


@pytest.fixture(scope="module")
def shaken(tmp_path_factory):
    """Return the folder of a shaker that moves a mass at 8 Hz for 12 s, and its response."""
    folder = tmp_path_factory.mktemp("comfort") / "run"
    motion = wr.Sine(frequency=8.0, acceleration=0.5, direction="z", duration=12.0)
    response = wr.simulate(wr.load_system("sdof_shaker"), motion, duration=12.0, sample_rate=500.0, timestep=5e-4)
    response.save(folder)
    return folder, response


def test_what_is_printed_is_what_the_history_holds(shaken, capsys):
    folder, response = shaken
    assert main(["comfort", str(folder), "mass", "--space", "B", "--discard", "6"]) == 0
    printed = capsys.readouterr().out
    content = comfort_content("run", response, ["mass"], spaces=("B",), discard=6.0)
    late = response.bodies["mass"].acceleration[response.time > 6.0, 2]
    table = content.table("comfort")
    assert table.rows[2][3] == pytest.approx(1.036 * late.std(), rel=0.01)  # Wk at 8 Hz
    ship = content.table("ship-habitability")
    assert [row[0] for row in ship.rows] == ["1984", "2000 B"]
    turns = np.exp(-16j * np.pi * response.time[response.time > 6.0])  # rope adds harmonics, which are lines of their own
    amplitude = 2.0 * abs(np.mean(late * turns)) / (16.0 * np.pi)
    assert ship.rows[0][3] == pytest.approx(amplitude, rel=2e-3)
    assert content.verdict.text in " ".join(printed.split())


def test_a_run_too_short_for_a_line_says_so(shaken):
    content = comfort_content("run", shaken[1], ["mass"], discard=11.5)
    assert content.table("ship-habitability") is None
    assert any("ISO 6954 is not judged" in block.text for block in content.blocks() if hasattr(block, "text"))


def test_unknown_points_and_lengths_are_refused(shaken, capsys):
    folder, _ = shaken
    assert "no body or point 'desk'; it has table, mass, mass_top" in refused(capsys, "comfort", folder, "desk")
    assert "must leave something of the 12 s" in refused(capsys, "comfort", folder, "--discard", "99")
