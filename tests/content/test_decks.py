"""What a report says of decks that bend: the peaks on four panels if asked, or why they were not looked at."""

from dataclasses import replace

import pytest

import wirerope_mj as wr
from wirerope_mj.content.blocks import Statement
from wirerope_mj.content.decks import DECKS, decks_blocks
from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.foundation.tables import Mark, Table

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

PULSE = wr.HalfSine(peak=150.0, duration=0.011, direction="z", start=0.05)


def blocks(system, motion=PULSE, *, decks=True, **how):
    """Return the blocks on decks of a run."""
    response = wr.simulate(system, motion, **({"duration": 0.2, "timestep": 2e-4} | how))
    return response, list(decks_blocks(replace(judged_run(system, motion, response, {}), decks=decks)))


@pytest.mark.quick
def test_the_peaks_on_panels_are_those_of_runs_on_them():
    system = wr.load_system("cabinet")
    response, (table, answer) = blocks(system, timestep=1e-4)
    assert isinstance(table, Table)
    assert [row[0] for row in table.rows] == ["rigid", "8.00 Hz", "12.0 Hz", "18.0 Hz", "25.0 Hz"]
    names = {"rack", *response.points}
    for row, frequency in zip(table.rows[1:], DECKS, strict=True):
        on = wr.simulate(wr.on_deck(system, f"{frequency} Hz 1700 kg 4 %"), PULSE, duration=0.2, timestep=1e-4)
        peaks = on.peaks.bodies | on.peaks.points
        largest = max(peaks[name].acceleration.value for name in names)
        assert row[1] == pytest.approx(largest, rel=1e-9)  # the same steps
        travel = max(on.peaks.mounts[mount.name].deflection.value for mount in on.scene.isolating)
        assert row[4] == pytest.approx(travel, rel=1e-9)
        assert isinstance(row[3], Mark)
        assert row[3].content == pytest.approx(row[1] / table.rows[0][1], rel=1e-12)
    factor = max(row[column].content for row in table.rows for column in (3, 6))
    assert answer.values["largest_factor"] == pytest.approx(factor, rel=1e-12)
    assert f"grows to {100 * factor:.0f} %" in answer.text


@pytest.mark.quick
def test_nothing_is_simulated_on_decks_unless_it_is_asked_for(monkeypatch):
    monkeypatch.delattr("wirerope_mj.content.decks.peaks_on_decks")
    _, (statement,) = blocks(wr.load_system("cabinet"), decks=False)
    assert isinstance(statement, Statement)
    assert "--decks" in statement.text
    assert "8 to 25 Hz" in statement.text


@pytest.mark.quick
@pytest.mark.parametrize(
    ("motion", "how", "why"),
    [
        (wr.VelocityStep(velocity=0.5, direction="z", start=0.02), {}, "velocity jumps"),
        (wr.HalfSine(peak=50.0, duration=0.011, direction="x", start=0.05), {}, "does not move along z"),
        (PULSE, {"engine": "mujoco"}, "MuJoCo computed the run"),
        (PULSE, {"duration": 10.5, "timestep": 1e-3, "sample_rate": 50.0}, "longer than 10 s"),
    ],
)
def test_what_was_not_looked_at_is_said_with_its_reason(motion, how, why):
    _, (statement,) = blocks(wr.load_system("cabinet"), motion, **how)
    assert isinstance(statement, Statement)
    assert why in statement.text
    assert "--deck" in statement.text


@pytest.mark.quick
def test_a_model_on_a_deck_that_bends_is_not_told_to_look_for_one():
    _, found = blocks(wr.on_deck(wr.load_system("cabinet"), "18 Hz 1700 kg"))
    assert found == []
