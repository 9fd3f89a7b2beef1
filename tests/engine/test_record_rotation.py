"""Records of six channels: sensors on a base that moves and turns, played back, against integrations written here."""

import itertools
import math
import warnings

import numpy as np
import pytest
from rolling_boxes import GRAVITY, boxed, integrated, ship
from scipy.spatial.transform import Rotation

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.foundation.errors import RecordError, RecordWarning
from wirerope_mj.motions.registry import motion_from_dict

UP = np.array([0.0, 0.0, 1.0])


def pose(motion, time):
    """Return the rotations of a base, its angular velocity and acceleration in its own axes."""
    turn = Rotation.from_euler("ZYX", motion.angular_displacement(time)[:, ::-1])
    return turn, turn.inv().apply(motion.angular_velocity(time)), turn.inv().apply(motion.angular_acceleration(time))


def sensors(path, motion, *, rate, kind="deg/s", gravity=0.0, own=True, until=None, place=None):
    """Write what six sensors at the base's own origin measure, which turn with it or keep the world's axes."""
    time = np.arange(round((until or motion.end) * rate) + 1) / rate
    turn, spin, alpha = pose(motion, time)
    moved = motion.acceleration(time) + gravity * UP
    if place is not None:
        arm, w = turn.apply(place), motion.angular_velocity(time)
        moved += np.cross(motion.angular_acceleration(time), arm) + np.cross(w, np.cross(w, arm))
    if own:
        moved = turn.inv().apply(moved)
    else:
        spin, alpha = motion.angular_velocity(time), motion.angular_acceleration(time)
    angular = {"deg/s": np.degrees(spin), "rad/s": spin, "rad/s^2": alpha}[kind]
    header = (
        "time [s],"
        + ",".join(f"acc {axis} [m/s^2]" for axis in "xyz")
        + ","
        + ",".join(f"gyro {axis} [{kind}]" for axis in "xyz")
    )
    np.savetxt(path, np.column_stack([time, moved, angular]), fmt="%.14g", delimiter=",", header=header, comments="")
    return path


def loaded(file, **options):
    """Load a record without its warnings, which it keeps."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        return wr.load_record(file, **options)


def turned(channels, step, *, accelerations, own):
    """Integrate q' = q w / 2 of the base's own axes, or w q / 2 of the world's, by Runge and Kutta, channels being straight."""
    sign, q, w = 1.0 if own else -1.0, np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3)
    turns = [q]

    def slope(q, w):
        x, y, z, s = q
        return 0.5 * np.array([[s, -sign * z, sign * y], [sign * z, s, -sign * x], [-sign * y, sign * x, s], [-x, -y, -z]]) @ w

    for a, b in itertools.pairwise(channels):
        if accelerations:
            rates = [w + u * step * a + 0.5 * u**2 * step * (b - a) for u in (0.0, 0.5, 1.0)]
        else:
            rates = [a, 0.5 * (a + b), b]
        k1 = slope(q, rates[0])
        k2 = slope(q + 0.5 * step * k1, rates[1])
        k3 = slope(q + 0.5 * step * k2, rates[1])
        q, w = q + step / 6.0 * (k1 + 2.0 * (k2 + k3) + slope(q + step * k3, rates[2])), rates[2]
        turns.append(q)
    return Rotation.from_quat(turns).as_matrix()


@pytest.fixture(scope="module")
def ended():
    """Return a ship's motion that begins and ends at rest, angles of which are not small."""
    return ship(duration=2.4)


@pytest.mark.parametrize(("kind", "own"), [("deg/s", True), ("rad/s", False), ("rad/s^2", True), ("rad/s^2", False)])
def test_angles_are_those_of_an_integration_of_the_channels(tmp_path, ended, kind, own):
    rate = 400.0
    file = sensors(tmp_path / "imu.csv", ended, rate=rate, kind=kind, own=own)
    played = wr.load_record(file, rotation="base" if own else "world")
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    time, channels = table[:, 0], table[:, 4:] * (math.pi / 180.0 if kind == "deg/s" else 1.0)

    expected = turned(channels, 1.0 / rate, accelerations=kind == "rad/s^2", own=own)
    turn = Rotation.from_euler("ZYX", played.angular_displacement(time)[:, ::-1]).as_matrix()
    # both are of fourth order: (2 rad/s 2.5 ms)^5 / 120 of a step are 3e-14, of 960 of them 3e-11
    np.testing.assert_allclose(turn, expected, rtol=0.0, atol=3e-10)
    # and of the motion itself: straight lines between samples lack (2 pi 0.8 Hz / 400 Hz)^2 / 12 = 1.3e-5 of up to 2 rad/s or
    # 10 rad/s^2, and that adds up over 2.4 s
    truth, _, _ = pose(ended, time)
    assert np.abs(played.angular_displacement(time) - ended.angular_displacement(time)).max() < 1e-4
    assert np.abs(played.angular_velocity(time[1:-1]) - ended.angular_velocity(time[1:-1])).max() < 2e-4
    assert (
        np.abs(played.acceleration(time[:-1]) - ended.acceleration(time[:-1])).max() < 1e-3
    )  # of up to 8 m/s^2 turned by them
    assert (
        np.abs(truth.as_matrix() - Rotation.from_euler("ZYX", ended.angular_displacement(time)[:, ::-1]).as_matrix()).max()
        < 1e-12
    )


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["kernel", "mujoco"])
def test_box_on_the_recorded_deck_moves_as_newton_and_euler_have_it(tmp_path, ended, engine):
    played = wr.load_record(sensors(tmp_path / "imu.csv", ended, rate=2000.0), rotation="base")
    response = wr.simulate(boxed(), played, duration=1.2, timestep=2.5e-4, sample_rate=50.0, engine=engine)
    box = response.bodies["box"]
    start = (*box.position[0], *box.velocity[0], *np.roll(box.orientation[0], -1), 0.0, 0.0, 0.0)
    y, acceleration = integrated(ended, tuple(response.time), start)
    # straight lines between samples at 2 kHz: (2 pi 0.8 Hz / 2000 Hz)^2 / 12 = 5e-7 of the motion, whose offsets add up
    for got, expected in ((box.position, y[:, :3]), (box.velocity, y[:, 3:6]), (box.acceleration, acceleration)):
        assert np.abs(got - expected).max() < 1e-5 * np.abs(expected).max()
    turn = Rotation.from_quat(y[:, 6:10])
    assert np.abs(Rotation.from_quat(np.roll(box.orientation, -1, axis=1)).as_matrix() - turn.as_matrix()).max() < 1e-5


def test_gravity_in_sensors_that_turn_is_a_constant_of_the_world(tmp_path):
    motion = ship(duration=2.4, start=2.0)  # rests at both ends for most of the record
    file = sensors(tmp_path / "imu.csv", motion, rate=1000.0, gravity=GRAVITY, until=6.4)
    time = np.arange(0.0, 6.4, 0.01)
    raw = loaded(file, rotation="base")
    assert any("9.807" in message for message in raw.warnings), raw.warnings
    assert np.abs(raw.acceleration(time) - motion.acceleration(time) - GRAVITY * UP).max() < 1e-3
    played = wr.load_record(file, rotation="base", baseline="rest")
    assert np.abs(played.acceleration(time) - motion.acceleration(time)).max() < 1e-3
    # without its rotation a roll of 25 deg brings g sin 25 deg athwartships
    flat = loaded(file, baseline="rest")
    assert any('gyro x, gyro y, gyro z, which turn nothing: play them with rotation="base"' in text for text in flat.warnings)
    assert np.abs(flat.acceleration(time) - motion.acceleration(time)).max() > 2.0
    assert not flat.rotates


def test_sensors_away_from_the_origin_give_the_motion_of_the_origin(tmp_path, ended):
    place = np.array([0.4, -0.7, 1.2])
    file = sensors(tmp_path / "imu.csv", ended, rate=1000.0, place=place)
    played = wr.load_record(file, rotation="base", sensors_at=place)
    time = np.arange(0.0, 2.4, 0.01)
    # of up to 10 m/s^2 at 1 kHz, where straight lines lack 2e-6, and of 1.4 m times the jumps of angular accelerations, 0.02
    away = played.acceleration(time) - ended.acceleration(time)
    assert np.abs(away).max() < 0.05
    assert np.abs(played.displacement(time) - ended.displacement(time)).max() < 1e-4
    assert len(played.directions) == 3
    again = motion_from_dict(played.to_dict())
    assert np.array_equal(again.acceleration(time), played.acceleration(time))
    at_origin = wr.load_record(file, rotation="base")
    assert np.abs(at_origin.displacement(time) - ended.displacement(time)).max() > 0.1
    with pytest.raises(ValueError, match='no channel turns it: rotation="base"'):
        loaded(file, sensors_at=place)


def test_angles_are_integrals_of_each_other_and_coast(tmp_path, ended):
    played = wr.load_record(
        sensors(tmp_path / "imu.csv", ended, rate=50.0, kind="rad/s^2"), rotation="base", start=0.3, scale=0.5
    )
    t, h = np.linspace(0.2, 3.5, 400) + 1.23e-4, 1e-5
    for order in (0, 1):
        slope = (played._angles(t + h, order) - played._angles(t - h, order)) / (2.0 * h)
        np.testing.assert_allclose(slope, played._angles(t, order + 1), rtol=0.0, atol=1e-6)
    assert not played._angles(np.array([0.0, 0.3]), 0).any()
    end = played._angles(np.array([played.end, played.end + 1.0]), 1)
    np.testing.assert_allclose(end[0], end[1], rtol=1e-9)
    whole = wr.load_record(tmp_path / "imu.csv", rotation="base", start=0.3)
    np.testing.assert_allclose(played._angles(t, 0), 0.5 * whole._angles(t, 0), rtol=1e-12, atol=1e-15)
    again = motion_from_dict(played.to_dict())
    for order in range(3):
        assert np.array_equal(again._angles(t, order), played._angles(t, order))
        assert np.array_equal(again._derivative(t, order), played._derivative(t, order))


def test_baselines_take_offsets_off_the_channels_of_rotation_too(tmp_path, ended):
    file = sensors(tmp_path / "imu.csv", ended, rate=200.0, kind="deg/s")
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    quiet = np.zeros((400, 7))
    table = np.concatenate([quiet, table, quiet])
    table[:, 0] = np.arange(len(table)) / 200.0
    table[:, 4] += 3.0  # deg/s
    header = file.read_text().splitlines()[0]
    np.savetxt(file, table, fmt="%.10g", delimiter=",", header=header, comments="")
    with pytest.raises(RecordError, match=r"begins while the base turns at 3 deg/s.*--fade 1.*--baseline rest"):
        loaded(file, rotation="base")
    time = np.arange(2.1, 4.4, 0.01)
    played = loaded(file, rotation="base", baseline="rest")
    assert np.abs(played.angular_displacement(time) - ended.angular_displacement(time - 2.0)).max() < 2e-4
    drifting = loaded(file, rotation="base", fade=0.5)
    assert any("its roll ends at" in text and "a small offset adds up" in text for text in drifting.warnings)
    assert drifting.angular_displacement([6.4])[0, 0] > math.radians(4.0)
    assert not drifting.acceleration([0.0, 6.4]).any()
    filtered = loaded(file, rotation="base", baseline="highpass", highpass=0.05)
    assert filtered.turning.time.size == filtered.time.size > table.shape[0]


@pytest.mark.slow
def test_command_plays_six_channels_by_headers_and_by_a_map(tmp_path, ended, capsys):
    file = sensors(tmp_path / "imu.csv", ended, rate=200.0)
    runs = {
        "headers": ["--rotation", "base"],
        "map": ["--channels", "acc x=x", "acc y=y", "acc z=z", "gyro x=roll", "gyro y=pitch", "gyro z=yaw"],
    }
    peaks = []
    for name, words in runs.items():
        out = tmp_path / name
        options = ["--duration", "1", "--timestep", "1e-3", "--out", str(out)]
        assert main(["shock", "cabinet", "--record", str(file), *words, *options]) == 0
        peaks.append({name: peak.acceleration.value for name, peak in wr.load_response(out).peaks.bodies.items()})
        assert "roll to" in capsys.readouterr().out
    assert peaks[0] == peaks[1]
    assert main(["replay", str(tmp_path / "map")]) == 0


@pytest.mark.quick
@pytest.mark.parametrize(("header", "channels", "rotation", "fault"), [
    ("time [s],x [g],gx [deg]", {"x": "x", "gx": "roll"}, None, "gx are angles. Export the rates"),
    ("time [s],x [g],gx [deg/s]", {"x": "x", "gx": "z"}, None, 'column "gx" has the unknown unit "deg/s"'),
    ("time [s],x [g],gx [g]", None, "base", r"no column is an angular rate \[deg/s, rad/s\]"),
    ("time [s],gx [deg/s],gy [rad/s^2]", {"gx": "roll", "gy": "pitch"}, None, "angular rates, all"),
    ("time [s],gx [deg/s],rate x [deg/s]", None, "base", '"rate x" is a second column of roll'),
    ("time [s],x [g],gx [deg/s]", None, "deck", "`rotation` must be one of 'base', 'world'"),
    ("time [s],x [g],gx [deg/s]", {"x": "roll", "gx": "-roll"}, None, "angular rates, all"),
    ("time [s],gx [deg/s],gy [deg/s]", {"gx": "-roll", "gy": "-roll"}, None, "the same direction -roll"),
])  # fmt: skip
def test_what_turns_nothing_is_refused_with_the_remedy(tmp_path, header, channels, rotation, fault):
    file = tmp_path / "imu.csv"
    time = np.arange(100) / 100.0
    wave = np.sin(2.0 * np.pi * time) ** 2
    np.savetxt(file, np.column_stack([time, wave, wave]), delimiter=",", header=header, comments="")
    with pytest.raises((RecordError, ValueError), match=fault):
        wr.load_record(file, channels=channels, rotation=rotation)


@pytest.mark.quick
def test_rotation_alone_and_the_other_way_round(tmp_path):
    time = np.arange(1001) / 500.0
    rate = 30.0 * np.sin(2.0 * np.pi * time)
    file = tmp_path / "gyro.csv"
    np.savetxt(file, np.column_stack([time, rate]), delimiter=",", header="time [s],wy [deg/s]", comments="")
    one = wr.load_record(file, rotation="base")
    # the integral of straight lines, whose error is (2 pi / 500)^2 / 12
    expected = math.radians(30.0) / (2.0 * np.pi) * (1.0 - np.cos(2.0 * np.pi * time))
    np.testing.assert_allclose(one.angular_displacement(time)[:, 1], expected, rtol=0.0, atol=2e-5)
    assert not one.angular_displacement(time)[:, [0, 2]].any()
    other = wr.load_record(file, channels={"wy": "-pitch"})
    np.testing.assert_allclose(other.angular_displacement(time), -one.angular_displacement(time), rtol=0.0, atol=1e-15)
    assert one.description.endswith("pitch to 9.55 deg")
