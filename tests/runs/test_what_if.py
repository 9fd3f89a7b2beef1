"""A what-if: sliders, and what they do to system and motion."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.engine.statics.payloads import payloads_of
from wirerope_mj.runs.board.what_if import frequency_ratio, groups_of, sliders_of, variant, with_slider

FLOOR = wr.load_system("floating_floor")
ALONG_X = wr.HalfSine(peak=100.0, duration=0.011, direction="x")
ALONG_Z = wr.HalfSine(peak=100.0, duration=0.011, direction="z")


def keys(system, motion):
    return [slider.key for slider in sliders_of(system, motion)]


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
    system, motion = variant(FLOOR, ALONG_X, {slider.key: slider.nominal for slider in sliders_of(FLOOR, ALONG_X)})
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
    assert with_slider(sliders, {"mass": 1.5}, "level", 1e9) == {"mass": 1.5, "level": 2.0}
    assert with_slider(sliders, {}, "mass", "-4") == {"mass": 0.5}


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("volume", 1.0, "there is no slider 'volume'; there are level, direction, mass"),
        (None, 1.0, "there is no slider 'None'"),
        ("level", "1 g", "'level' must be a finite number, got '1 g'"),
        ("level", float("nan"), "'level' must be a finite number, got nan"),
        ("level", float("inf"), "'level' must be a finite number, got inf"),
        ("level", None, "'level' must be a finite number, got None"),
    ],
)
def test_values_that_are_none_are_refused(key, value, words):
    with pytest.raises(ValueError, match=words):
        with_slider(sliders_of(FLOOR, ALONG_X), {}, key, value)


def test_the_step_shrinks_as_much_as_the_fastest_motion_speeds_up():
    assert frequency_ratio({"stiffness/a": 0.5, "mass": 2.0, "damping": 0.5}) == 1.0
    assert frequency_ratio({"stiffness/a": 2.0, "stiffness/b": 1.0, "mass": 0.5}) == pytest.approx(2.0)
