import errno
import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from kills import interruptible
from made_up_floor import floor_response
from recordings import column, entities

from wirerope_mj.engine.response import Response
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.views.recording import read_state, record_rerun
from wirerope_mj.views.recording.program import viewer_binary
from wirerope_mj.views.recording.shapes import frames_of, rotate

pytestmark = pytest.mark.quick


@pytest.fixture(scope="module")
def floor() -> Response:
    return floor_response()


@pytest.fixture(scope="module")
def recording(floor, tmp_path_factory) -> Path:
    return record_rerun(
        floor, tmp_path_factory.mktemp("run"), title="Floor", scenario_text="[shock]\npeak_g = 15.0", state=True
    )


def test_state_holds_every_column_bit_for_bit(floor, recording):
    state = read_state(recording)
    values = floor.samples.columns(0, len(floor.samples.names))
    assert list(state) == floor.samples.names
    for number, name in enumerate(floor.samples.names):
        assert state[name].tobytes() == np.ascontiguousarray(values[:, number]).tobytes(), name


@pytest.mark.parametrize("fails", [(rr.RecordingStream, "save"), (threading.Thread, "start")], ids=["save", "thread"])
def test_a_recording_that_cannot_begin_ends_at_once_and_leaves_nothing(fails, tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise OSError(errno.EMFILE, "Too many open files")

    response = floor_response(mounts=1, equipment=0, rows=50)
    monkeypatch.setattr(*fails, refuse)
    with pytest.raises(OSError, match="Too many open files"):
        record_rerun(response, tmp_path / "floor.rrd")
    assert not list(tmp_path.iterdir())


def test_state_keeps_bits_that_are_no_ordinary_numbers(tmp_path):
    response = floor_response(mounts=1, equipment=0, rows=50)
    odd = np.random.default_rng(3).integers(0, 2**64, 50, dtype=np.uint64).view(np.float64)  # NaN payloads, subnormals
    last = len(response.samples.names) - 1
    response.samples.values[:, last] = odd  # a hysteretic state: kept, not drawn
    record_rerun(response, tmp_path / "odd.rrd", state=True)
    assert read_state(tmp_path / "odd.rrd")[response.samples.names[last]].tobytes() == odd.tobytes()


def test_state_agrees_with_the_parquet_file_bit_for_bit(floor, recording, tmp_path):
    import pyarrow.parquet as pq

    floor.save(tmp_path)
    table = pq.read_table(tmp_path / "response.parquet")
    state = read_state(recording)
    assert table.column_names == list(state)
    assert all(table[name].to_numpy().tobytes() == state[name].tobytes() for name in state)


def test_rerun_verifies_the_file(recording):
    done = subprocess.run([viewer_binary(), "rrd", "verify", recording], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_times_are_rounded_to_nanoseconds_and_not_cut(tmp_path):
    response = floor_response(mounts=1, equipment=0, rows=2000, rate=1e4)  # some lie just below a whole nanosecond
    record_rerun(response, tmp_path / "fine.rrd", state=True)
    stamps = column(entities(tmp_path / "fine.rrd")["/state/time"], "sim_time").cast("int64").to_numpy()
    np.testing.assert_array_equal(stamps, np.arange(2000) * 100_000)


def test_blueprint_comes_before_the_data(recording):
    done = subprocess.run([viewer_binary(), "rrd", "print", recording], capture_output=True, text=True, check=True)
    assert 0 <= done.stdout.find("BlueprintActivationCommand") < done.stdout.find("/state/time")
    assert "make_default: true" in done.stdout


def test_bodies_ride_on_the_base_and_fixed_bodies_hang_on_their_carrier(floor):
    frames = frames_of(floor)
    assert frames["floor"].path == "/world/deck/floor"
    assert frames["rack_1"].path == "/world/deck/floor/rack_1"
    assert frames["rack_1"].fixed
    assert not frames["floor"].fixed
    # The tree put together again is the pose in the world.
    deck, carrier, rack = floor.bodies["deck"], frames["floor"], frames["rack_1"]
    in_base = carrier.position + rotate(carrier.orientation, rack.position)
    np.testing.assert_allclose(deck.position + in_base, floor.bodies["rack_1"].position, atol=1e-12)  # roundoff


def test_ropes_reach_from_the_base_bar_to_the_payload_bar(floor, recording):
    """The top of every drawn rope is where the payload's bar stands: half a height above the payload's site."""
    found = entities(recording)["/world/deck/mounts/WR"]
    times = column(found, "sim_time").cast("int64").to_numpy()
    row = int(np.abs(times - 90_000_000).argmin())
    sample = round(times[row] * 1e-6)
    maps = np.array(column(found, "InstancePoses3D:mat3x3")[row].as_py()).reshape(-1, 3, 3)  # columns of each matrix
    feet = np.array(column(found, "InstancePoses3D:translations")[row].as_py())
    for number, mount in enumerate(floor.scene.mounts):
        body = floor.bodies["floor"]
        site = body.position[sample] + rotate(body.orientation[sample], mount.payload_point)
        expected = site - floor.bodies["deck"].position[sample] + [0.0, 0.0, 0.5 * mount.height]
        # float32, and the deflection is turned by at most 0.004 rad over 45 mm
        np.testing.assert_allclose(feet[number] + maps[number, 2], expected, atol=2e-6)
    assert abs(maps[:, 2, 2] - 0.089).max() > 5e-3  # it does stretch


def test_payload_side_of_a_sheared_mount_moves_with_the_sign_of_the_deflection(floor, recording):
    found = entities(recording)["/world/deck/mounts/WR"]
    times = column(found, "sim_time").cast("int64").to_numpy()
    first = np.array([np.array(row.as_py()).reshape(-1, 3, 3)[0, 2] for row in column(found, "InstancePoses3D:mat3x3")])
    deflection = floor.mounts["m01"].deflection[np.round(times * 1e-6).astype(int)]
    np.testing.assert_allclose(first - [0.0, 0.0, 0.089], deflection, atol=1e-8)  # float32 of a tenth of a metre


def test_forces_point_against_the_deflection(floor, recording):
    found = entities(recording)["/world/deck/forces"]
    times = column(found, "sim_time").cast("int64").to_numpy()
    arrows = np.array([np.array(row.as_py())[0] for row in column(found, "Arrows3D:vectors")])
    force = floor.mounts["m01"].force[np.round(times * 1e-6).astype(int)]
    assert np.all(arrows[:, 2] * force[:, 2] <= 0.0)
    assert np.any(arrows[:, 2] * force[:, 2] < 0.0)


def test_loops_are_in_millimetres_and_kilonewtons_and_end_at_the_last_sample(floor, recording):
    found = entities(recording)["/loops/axial/m01/data/cursor"]
    points = np.array([row.as_py()[0] for row in column(found, "Points2D:positions")])
    times = np.round(column(found, "sim_time").cast("int64").to_numpy() * 1e-6).astype(int)
    mount = floor.mounts["m01"]
    exact = np.column_stack([mount.deflection[times, 2] * 1e3, mount.force[times, 2] * 1e-3])
    np.testing.assert_allclose(points, exact, rtol=1e-6, atol=1e-6)  # float32
    assert times[0] == 0
    assert times[-1] == floor.time.size - 1


def test_accelerations_are_in_g_with_the_refined_peak_marked(floor, recording):
    found = entities(recording)
    (path,) = [path for path in found if path.startswith("/histories/acceleration/total/") and path.endswith("/peak")]
    marker = column(found[path], "Scalars:scalars")[0].as_py()[0]
    assert marker == floor.peaks.points["rack_top"].acceleration.value / 9.80665
    text = column(found[path], "SeriesPoints:names")[0].as_py()[0]
    assert text.startswith(f"point rack_top {marker:.1f} g at ")


@pytest.mark.parametrize(
    "options",
    [
        {"mounts": 1, "equipment": 0, "axial_only": True, "rows": 60},
        {"mounts": 40, "rows": 120},
        {"mounts": 2, "base": "", "rows": 80},
        {"mounts": 3, "travel": {}, "events": False, "rows": 80},
        {"mounts": 2, "rows": 2},
    ],
)
def test_any_model_can_be_recorded(options, tmp_path):
    response = floor_response(**options)
    path = record_rerun(response, tmp_path / "run.rrd")
    assert subprocess.run([viewer_binary(), "rrd", "verify", path], capture_output=True).returncode == 0
    views = {name for name in entities(path) if name.startswith("/loops/axial/") and name.endswith("/data")}
    assert len(views) <= 9
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.rrd"]


def test_file_grows_linearly_with_rows(tmp_path):
    sizes = []
    for rows in (1001, 2001, 3001):
        response = floor_response(mounts=4, equipment=1, rows=rows)
        # Incompressible samples, as the ring-down of a real floor is; the drawn rows stay few.
        noise = np.random.default_rng(0).standard_normal((rows, len(response.samples.names) - 1))
        response.samples.values[:, 1:] *= 1.0 + 1e-9 * noise
        sizes.append(record_rerun(response, tmp_path / f"{rows}.rrd", state=True).stat().st_size)
    growth = np.diff(sizes)
    per_row = 8 * len(response.samples.names) + 5 * 30  # float64 and what an entity of /state costs for each row
    assert growth[1] <= 1.2 * growth[0]  # drawn rows cost less the longer the ring-down is
    assert max(growth) <= 1.4 * per_row * 1000


def test_a_recording_that_fails_leaves_nothing_behind(floor, tmp_path, monkeypatch):
    monkeypatch.setattr("wirerope_mj.views.recording.record.log_state", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        record_rerun(floor, tmp_path / "run.rrd", state=True)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="counts threads as Linux lists them")
def test_recordings_one_after_the_other_leave_no_thread(floor, tmp_path):
    record_rerun(floor, tmp_path / "run.rrd")  # what rerun starts once for all
    before = len(os.listdir("/proc/self/task"))
    for _ in range(4):
        record_rerun(floor, tmp_path / "run.rrd")
    assert len(os.listdir("/proc/self/task")) <= before


INTERRUPTED = """
import pathlib, signal, sys, threading
import rerun as rr
from wirerope_mj.views.recording.viewer import atomic_recording

def disturbed(ordinary):
    def call(*arguments, **how):
        signal.raise_signal(signal.SIGINT)
        return ordinary(*arguments, **how)
    return call

for name in ("disconnect", "send_columns", "flush"):
    signal.signal(signal.SIGINT, signal.default_int_handler)
    ordinary = getattr(rr.RecordingStream, name)
    try:
        with atomic_recording(pathlib.Path(sys.argv[1])) as rec:
            setattr(rr.RecordingStream, name, disturbed(ordinary))
            rec.log("text", rr.TextLog("text"))
            rec.send_columns("rows", [rr.TimeColumn("t", sequence=[1])], rr.Scalars.columns(scalars=[1.0]))
    except KeyboardInterrupt:
        pass
    setattr(rr.RecordingStream, name, ordinary)
    print(name, threading.active_count(), pathlib.Path(sys.argv[1]).exists())
"""


def test_an_interrupt_while_a_recording_is_written_or_ended_makes_nobody_wait(tmp_path):
    with interruptible([sys.executable, "-c", INTERRUPTED, str(tmp_path / "run.rrd")]) as process:
        said, told = process.communicate(timeout=120)
    assert told == ""
    # It ends without that flush, and so is whole then.
    assert said.splitlines() == ["disconnect 1 False", "send_columns 1 False", "flush 1 True"]


def test_an_unknown_tab_lists_those_that_exist(floor, tmp_path):
    with pytest.raises(ValueError, match=r"`tab` must be one of Overview, .*Axial loops.*, got 'Loops'"):
        record_rerun(floor, tmp_path / "run.rrd", tab="Loops")


def test_state_of_a_file_without_samples_is_an_error(tmp_path):
    import rerun as rr

    with rr.RecordingStream("other") as rec:
        rec.save(tmp_path / "other.rrd")
        rec.log("a", rr.TextDocument("nothing"), static=True)
    with pytest.raises(RecordError, match="no samples under /state"):
        read_state(tmp_path / "other.rrd")
