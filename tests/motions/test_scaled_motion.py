"""Base motions at another level and in another direction; what holds for every motion is in test_motion.py."""

import math
from pathlib import Path

import house
import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.motions import motion_from_dict
from wirerope_mj.motions.records.record import records_in
from wirerope_mj.runs.scenario_file import system_and_motion

pytestmark = pytest.mark.quick

DATA = Path(__file__).parents[1] / "data"
G = 9.80665
PULSE = wr.HalfSine(peak=15 * G, duration=0.011, direction="z", start=0.02)
SHOCK = PULSE + wr.VelocityStep(velocity=2.0, direction="x", start=0.05)
TIME = np.linspace(-0.01, 0.1, 223)
QUARTER_TURN = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
"""By 90 degrees about z: x goes to y, y to -x."""


def values(motion, time=TIME):
    return np.stack([motion.acceleration(time), motion.velocity(time), motion.displacement(time)])


def test_a_scaled_motion_is_the_closed_form_with_the_scaled_level():
    scaled = wr.Scaled(PULSE, 1.3)
    written = wr.HalfSine(peak=1.3 * 15 * G, duration=0.011, direction="z", start=0.02)
    # One rounding of each of the two products; the displacement sums a few more.
    np.testing.assert_allclose(values(scaled), values(written), rtol=4e-16 * 4, atol=0)
    assert values(scaled)[1].max() == pytest.approx(1.3 * 2 * 15 * G * 0.011 / math.pi, rel=1e-15)


def test_a_power_of_two_is_exact():
    written = wr.HalfSine(peak=-4.0 * 15 * G, duration=0.011, direction="z", start=0.02)
    np.testing.assert_array_equal(values(wr.Scaled(PULSE, -4.0)), values(written))


def test_instants_stay_and_velocity_jumps_are_scaled():
    scaled = wr.Scaled(SHOCK, -0.5)
    np.testing.assert_array_equal(scaled.corners, SHOCK.corners)
    assert (scaled.duration, scaled.end, scaled.shortest_time) == (SHOCK.duration, SHOCK.end, SHOCK.shortest_time)
    assert scaled.events == SHOCK.events
    ((time, jump),) = scaled.velocity_jumps
    assert time == 0.05
    np.testing.assert_array_equal(jump, [-1.0, 0.0, 0.0])


def test_a_rotation_turns_every_vector():
    turned = wr.Turned(SHOCK, rotation=QUARTER_TURN)
    written = PULSE + wr.VelocityStep(velocity=2.0, direction="y", start=0.05)
    np.testing.assert_array_equal(values(turned), values(written))
    np.testing.assert_array_equal(turned.corners, SHOCK.corners)
    np.testing.assert_array_equal(turned.velocity_jumps[0][1], [0.0, 2.0, 0.0])
    back = wr.Turned(turned, rotation=np.transpose(QUARTER_TURN))
    np.testing.assert_array_equal(values(back), values(SHOCK))


def test_a_rotation_keeps_lengths_and_angles():
    a, b = 0.3, 1.1
    about_x = np.array([[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])
    about_y = np.array([[math.cos(b), 0, math.sin(b)], [0, 1, 0], [-math.sin(b), 0, math.cos(b)]])
    record = wr.load_record(DATA / "deck_shock.csv", channels={"ax": "x", "ch3": (0.0, 1.0, 1.0)})
    turned = wr.Turned(record, rotation=about_y @ about_x)
    time = record.time[::3]
    before, after = record.acceleration(time), turned.acceleration(time)
    # Roundoff of sums of three products.
    np.testing.assert_allclose(after @ after.T, before @ before.T, rtol=0, atol=1e-13 * np.abs(before).max() ** 2)
    np.testing.assert_allclose(after, before @ (about_y @ about_x).T, rtol=0, atol=1e-14 * np.abs(before).max())
    assert len(turned.directions) == len(record.directions)


@pytest.mark.parametrize("direction", ["x", "y", (0.0, 3.0, -4.0), (1.0, 2.0, 3.0)])
def test_a_motion_along_an_axis_turned_to_a_direction_is_the_one_written_with_it_to_the_last_bit(direction):
    written = wr.HalfSine(peak=15 * G, duration=0.011, direction=direction, start=0.02)
    np.testing.assert_array_equal(values(wr.Turned(PULSE, direction=direction)), values(written))


def test_an_oblique_motion_is_turned_to_a_direction_with_its_sense():
    oblique = wr.HalfSine(peak=-15 * G, duration=0.011, direction=(1.0, 2.0, -0.5), start=0.02)
    written = wr.HalfSine(peak=-15 * G, duration=0.011, direction="y", start=0.02)
    turned = wr.Turned(oblique, direction="y")
    # The level comes from three products with a unit vector that is itself rounded.
    np.testing.assert_allclose(values(turned), values(written), rtol=1e-15, atol=0)


def test_a_value_does_not_depend_on_how_many_instants_are_asked_for():
    turned = wr.Turned(SHOCK, rotation=[[0.0, -0.8, 0.6], [1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])
    alone = np.concatenate([turned.velocity(time) for time in TIME])
    np.testing.assert_array_equal(alone, turned.velocity(TIME))


def test_descriptions_say_what_was_done():
    half_sine = "half-sine 15 g 11 ms along z at 0.02 s"
    assert wr.Scaled(PULSE, 1.5).description == f"1.5 x {half_sine}"
    assert wr.Scaled(SHOCK, 2.0).description == f"2 x ({half_sine} + velocity step 2 m/s along x at 0.05 s)"
    assert wr.Turned(PULSE, direction=(0, 1, 1)).description == f"{half_sine}, turned to (0, 1, 1)"
    turned = wr.Turned(PULSE, rotation=QUARTER_TURN)
    assert turned.description == f"{half_sine}, turned by 90 deg about (0, 0, 1)"
    assert wr.Turned(PULSE, rotation=np.eye(3)).description == f"{half_sine}, turned by 0 deg"


def test_scaled_and_turned_records_are_rebuilt_from_the_copy_of_their_file(tmp_path):
    record = wr.load_record(DATA / "deck_shock.csv", channels={"ax": "x"})
    motion = PULSE + wr.Turned(wr.Scaled(record, 2.0), direction="z")
    assert motion.files == record.files
    assert records_in(motion) == [record]
    (tmp_path / "copy.csv").write_bytes((DATA / "deck_shock.csv").read_bytes())
    stored = motion.to_dict(files={record.files[0]: "copy.csv"})
    rebuilt = motion_from_dict(stored, folder=tmp_path)
    np.testing.assert_array_equal(values(rebuilt), values(motion))
    assert rebuilt.files == (tmp_path / "copy.csv",)


def test_a_run_reads_no_scaled_record_outside_its_folder(tmp_path):
    (tmp_path / "model.xml").write_text("<mujoco/>")
    record = wr.load_record(DATA / "deck_shock.csv", channels={"ax": "x"})
    stored = (PULSE + wr.Scaled(wr.Scaled(record, 2.0), 0.5)).to_dict()
    content = {"model": {"file": "model.xml"}, "motion": {"description": "", **stored}}
    with pytest.raises(RecordError, match="deck_shock.csv' is not in this folder"):
        system_and_motion(tmp_path, content)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: wr.Scaled(PULSE, 0.0), "`factor` must not be zero"),
        (lambda: wr.Scaled(PULSE, math.nan), "`factor` must be a finite number, got nan"),
        (lambda: wr.Scaled(15.0, 2.0), "`motion` must be a base motion, got 15.0"),
        (lambda: wr.Turned(PULSE), "exactly one of `rotation` and `direction` must be given, got none"),
        (lambda: wr.Turned(PULSE, rotation=np.eye(3), direction="x"), "must be given, got both"),
        (lambda: wr.Turned(PULSE, direction="w"), "`direction` must be"),
        (lambda: wr.Turned(PULSE, rotation=[1.0, 0.0, 0.0]), "`rotation` must be a rotation matrix of 3 x 3"),
        (lambda: wr.Turned(PULSE, rotation=2 * np.eye(3)), "`rotation` must be orthonormal and not mirror"),
        (lambda: wr.Turned(PULSE, rotation=np.diag([1.0, 1.0, -1.0])), "`rotation` must be orthonormal and not mirror"),
        (lambda: wr.Turned(SHOCK, direction="x"), "along one line, and this one moves along 2 directions: half-sine"),
    ],
)
def test_what_cannot_be_scaled_or_turned_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_stored_parameters_that_are_missing_are_named():
    with pytest.raises(ModelError, match="'scaled': missing factor; its parameters are motion, factor"):
        motion_from_dict({"kind": "scaled", "motion": PULSE.to_dict()})
    with pytest.raises(ModelError, match="'turned': unknown angle; its parameters are motion, rotation, direction"):
        motion_from_dict({"kind": "turned", "motion": PULSE.to_dict(), "angle": 3.0})


LAW = wr.BoucWen(**house.hysteresis(alpha=2e5, z_max=300.0), k=8e4)


@pytest.mark.parametrize("jump", [False, True], ids=["half-sine", "with a velocity step"])
def test_a_scaled_motion_gives_the_same_bits_as_the_motion_written_with_the_level(jump):
    def shock(level):
        pulse = wr.HalfSine(peak=15 * G * level, duration=0.011, direction="z", start=0.01)
        return pulse + wr.VelocityStep(velocity=0.3 * level, direction="z", start=0.03) if jump else pulse

    system = house.sdof(LAW, gravity=G)
    scaled, written = (
        wr.simulate(system, motion, duration=0.06, timestep=5e-4) for motion in (wr.Scaled(shock(1.0), 2.0), shock(2.0))
    )
    assert scaled.peaks.to_dict() == written.peaks.to_dict()
    np.testing.assert_array_equal(scaled.mounts["m1"].force, written.mounts["m1"].force)
    np.testing.assert_array_equal(scaled.base.velocity, written.base.velocity)
    assert scaled.peaks.bodies["mass"].acceleration.value > 1.5 * 9.0  # the pulse itself has arrived
