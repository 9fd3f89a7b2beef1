"""A what-if: sliders, what they do to system and motion, and the last two runs."""

from dataclasses import replace

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.engine.statics.payloads import payloads_of
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.payload_limits import PayloadLimit
from wirerope_mj.runs.explore import (
    Exploration,
    checked_values,
    frequency_ratio,
    groups_of,
    scenario_or_model,
    sliders_of,
    variant,
)
from wirerope_mj.runs.scenario import load_scenario
from wirerope_mj.views.explore.server import OvertakenError

FLOOR = wr.load_system("floating_floor")
TABLE = load_scenario("shock_table").make()
ALONG_X = wr.HalfSine(peak=100.0, duration=0.011, direction="x")
ALONG_Z = wr.HalfSine(peak=100.0, duration=0.011, direction="z")


def keys(system, motion):
    return [slider.key for slider in sliders_of(system, motion)]


@pytest.fixture(scope="module")
def explored():
    """Return a what-if of the shock table, whose runs take a twentieth of a second; tests begin with all sliders nominal."""
    return Exploration(TABLE)


def test_there_is_a_slider_for_each_kind_of_isolator_and_none_for_stops():
    stiffness = [f"stiffness/{group}" for group in ("wr16_400", "wr12_400", "rubber")]
    assert keys(FLOOR, ALONG_X) == ["level", "direction", "mass", *stiffness, "damping"]
    assert {"bump_stop_24mn", "bump_stop_24mn_side"} <= {mount.isolator_name for mount in FLOOR.mounts.values()}
    assert len(groups_of(FLOOR)["wr16_400"]) == 16


def test_a_direction_is_turned_only_where_that_does_something_and_the_base_follows():
    assert "direction" not in keys(FLOOR, ALONG_Z)
    assert "direction" not in keys(wr.load_system("sdof_shaker"), ALONG_X)
    assert "direction" in keys(FLOOR, ALONG_X + ALONG_Z)


def test_a_drop_has_neither_level_nor_direction():
    system = wr.load_system("cabinet")
    assert not {"level", "direction"} & set(keys(system, wr.Drop(drop_height=0.3)))
    assert "level" in keys(system, wr.VelocityStep(velocity=2.0, direction="z"))


def test_nominal_sliders_leave_everything_as_it_is():
    system, motion = variant(FLOOR, ALONG_X, checked_values(sliders_of(FLOOR, ALONG_X), {}))
    assert system is FLOOR
    assert motion is ALONG_X


def test_sliders_change_what_they_say():
    values = {"level": 0.5, "direction": 90.0, "mass": 1.5, "stiffness/wr12_400": 2.0, "damping": 3.0}
    system, motion = variant(FLOOR, ALONG_X, values)
    time = np.array([5e-3])
    np.testing.assert_allclose(motion.acceleration(time), [[0.0, 0.5 * ALONG_X.acceleration(time)[0, 0], 0.0]], atol=1e-12)
    (before,), (after,) = payloads_of(FLOOR), payloads_of(system)
    assert after.mass == pytest.approx(1.5 * before.mass, rel=1e-12)
    for name, mount in system.mounts.items():
        written = FLOOR.mounts[name].written
        factor = 2.0 if mount.isolator_name == "wr12_400" else 1.0
        if written.is_stop:
            assert mount.written == written
        else:
            assert mount.written == written.scaled(factor).with_damping(3.0)
            assert mount.written.limits == written.limits


def test_values_are_brought_into_their_ranges():
    sliders = sliders_of(FLOOR, ALONG_X)
    assert checked_values(sliders, {"level": 1e9, "mass": -4})["level"] == 2.0
    assert checked_values(sliders, {"level": 1e9, "mass": -4})["mass"] == 0.5


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (None, "must be a table such as .*, got None"),
        ([1.0], "must be a table such as .*, got \\[1.0\\]"),
        ({"volume": 1.0}, "there is no slider 'volume'; there are level, direction, mass"),
        ({"level": "1"}, "'level' must be a finite number, got '1'"),
        ({"level": True}, "'level' must be a finite number, got True"),
        ({"level": float("nan")}, "'level' must be a finite number, got nan"),
        ({"level": float("inf")}, "'level' must be a finite number, got inf"),
        ({"level": None}, "'level' must be a finite number, got None"),
    ],
)
def test_values_that_are_none_are_refused(values, words):
    with pytest.raises(ValueError, match=words):
        checked_values(sliders_of(FLOOR, ALONG_X), values)


def test_the_step_shrinks_as_much_as_the_fastest_motion_speeds_up():
    assert frequency_ratio({"stiffness/a": 0.5, "mass": 2.0, "damping": 0.5}) == 1.0
    assert frequency_ratio({"stiffness/a": 2.0, "stiffness/b": 1.0, "mass": 0.5}) == pytest.approx(2.0)


def test_the_first_run_is_that_of_the_command():
    response = wr.simulate(wr.load_system("shock_table"), TABLE.motion, **TABLE.simulate)
    shown = Exploration(TABLE)._shown[0].response
    for name in response.mounts:
        np.testing.assert_array_equal(shown.mounts[name].deflection, response.mounts[name].deflection)
    assert shown.numerics == response.numerics


def test_a_higher_level_changes_the_verdict_and_the_last_two_runs_are_kept(explored):
    first = explored.run({})
    assert first["now"]["headline"].startswith("PASS of the mounts: most critical m1 ")
    second = explored.run({"level": 2.0})
    assert second["now"]["headline"].startswith("FAIL: m1 ")
    assert second["now"]["tone"] == "exceeded"
    assert second["now"]["lines"]
    assert second["before"]["headline"] == first["now"]["headline"]
    assert second["now"]["changes"] == {"Base motion level": "×\N{NO-BREAK SPACE}2"}
    third = explored.run({"level": 0.5})
    assert third["before"]["values"]["level"] == 2.0
    assert [line["role"] for line in third["curves"][0]["lines"]] == ["before", "now"]
    assert len(explored._shown) == 2


def test_a_run_on_the_way_gives_way_to_the_next_one(explored):
    explored.run({})
    for level in (1.1, 1.2, 1.3):
        answer = explored.run({"level": level}, passing=True)
        assert answer["before"]["values"]["level"] == 1.0
    rest = explored.run({"level": 1.3})
    assert rest["now"]["number"] == answer["now"]["number"], "where the slider rests nothing is simulated again"
    assert rest["before"]["values"]["level"] == 1.0
    assert explored.run({"level": 1.0})["before"]["values"]["level"] == 1.3


def test_a_check_of_the_accuracy_takes_the_place_of_its_run(explored):
    explored.run({})
    quick = explored.run({"level": 1.4})
    assert quick["now"]["step"].endswith("(the step is that of the first run).")
    exact = explored.run({"level": 1.4}, exact=True)
    assert exact["now"]["exact"]
    assert "estimated error" in exact["now"]["step"]
    assert exact["before"]["values"]["level"] == 1.0
    # Verdicts and peaks do not depend on which of the two steps it was.
    assert columns_now(exact) == columns_now(quick)


def columns_now(answer):
    """Return the last column of the table of figures, of the run that is shown."""
    (table,) = [table for table in answer["tables"] if table["id"] == "figures"]
    return [(row[0], row[-1]) for row in table["rows"]]


def test_limits_of_one_axis_stand_in_the_table_and_in_the_curve():
    limit = PayloadLimit(name="block", kind="acceleration", values=(0.0, 0.0, 50.0))
    answer = Exploration(replace(TABLE, limits=[limit])).start()["answer"]
    (table,) = [table for table in answer["tables"] if table["id"] == "accelerations"]
    (row,) = [row for row in table["rows"] if row[0][0] == "block"]
    assert [cell[0] for cell in row[-2:]] == ["5.10", "z"]
    curve = answer["curves"][1]
    assert curve["title"].startswith("block: acceleration along z [g]")
    np.testing.assert_allclose(curve["limits"], [-50.0 / 9.80665, 50.0 / 9.80665])


def test_what_cannot_be_simulated_leaves_the_last_run(explored, monkeypatch):
    shown = explored._shown
    monkeypatch.setattr(explored, "_arguments", {**explored._arguments, "initial": "nonsense"})
    with pytest.raises(ValueError, match="initial"):
        explored.run({"level": 1.7})
    assert explored._shown is shown


def test_a_recording_is_of_the_last_run_only(explored):
    number = explored.run({"level": 0.7})["now"]["number"]
    with pytest.raises(OvertakenError):
        explored.recording(number - 1)


@pytest.mark.slow
def test_the_recording_of_two_runs_is_one_that_the_viewer_opens(explored):
    explored.run({"level": 0.8})
    number = explored.run({"level": 0.9})["now"]["number"]
    try:
        assert explored.recording(number).startswith(b"RRF")
    finally:
        explored.close()


def test_an_argument_that_simulate_does_not_take_is_named():
    with pytest.raises(ModelError, match="`simulate` takes duration"):
        Exploration(replace(TABLE, simulate={"durations": 1.0}))


def test_a_model_alone_is_struck_by_a_half_sine():
    made = scenario_or_model("cabinet").make(level_g=20.0, direction="xz", pulse_ms=6.0)
    assert made.motion.description == "half-sine 20 g 6 ms along x at 0.05 s + half-sine 20 g 6 ms along z at 0.05 s"
    assert 0.5 < made.simulate["duration"] < 2.0
    assert made.question == "Do payload and mounts keep their limits under a half-sine that strikes the base?"
    assert scenario_or_model("cabinet").make(duration=0.2).simulate == {"duration": 0.2}
    assert scenario_or_model("shock_table").make().simulate == TABLE.simulate, "a scenario goes before a model"


def test_what_is_neither_scenario_nor_model_is_refused():
    with pytest.raises(ModelError, match="no scenario and no model 'nothing'.*floating_floor_shock.*cabinet"):
        scenario_or_model("nothing")
    with pytest.raises(ModelError, match="`direction` must name axes"):
        scenario_or_model("cabinet").make(direction="up")
