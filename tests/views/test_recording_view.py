import signal
import socket
import sys
import time
import urllib.error
import urllib.request
from dataclasses import replace

import numpy as np
import pytest
from kills import interruptible
from made_up_floor import floor_response

from wirerope_mj.assessment.criteria import EXCEEDED, Criterion, Verdict, judge, verdict_lines
from wirerope_mj.assessment.criteria.ended import used_limits
from wirerope_mj.assessment.criteria.verdict import against_limit
from wirerope_mj.content.blocks import Curve, Panel
from wirerope_mj.content.events import at_cursor, events_of, first_above, main_instants
from wirerope_mj.content.judged_run import RunResult, judged_run
from wirerope_mj.content.selection import select
from wirerope_mj.dynamics.modes import modes
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.system import load_system
from wirerope_mj.foundation.errors import RecordError, WireRopeError
from wirerope_mj.foundation.ticks import linear_ticks
from wirerope_mj.motions import HalfSine
from wirerope_mj.views.recording import loops, record_rerun, show
from wirerope_mj.views.recording.drawn_runs import run_texts
from wirerope_mj.views.recording.now import cursor_rows
from wirerope_mj.views.recording.panels import log_panel
from wirerope_mj.views.recording.paths import POINT, known_letters
from wirerope_mj.views.recording.program import free_port
from wirerope_mj.views.recording.shapes import quaternion_of, rotate
from wirerope_mj.views.recording.viewer import Opening, openings_of
from wirerope_mj.views.share.server import address_of
from wirerope_mj.views.thin import rows_of_extremes, rows_of_line, rows_of_steps


def test_drawn_lines_stay_within_their_tolerance():
    time = np.linspace(0.0, 3.0, 3001)
    values = np.column_stack([np.exp(-2 * time) * np.sin(40 * time), np.where(time > 1, 1.0, 0.0)])
    rows = rows_of_line(time, values, 0.01)
    drawn = np.column_stack([np.interp(time, time[rows], values[rows, k]) for k in range(2)])
    assert np.abs(drawn - values).max() <= 0.01
    assert rows.size < 600
    assert rows[0] == 0
    assert rows[-1] == 3000


def test_held_poses_stay_within_their_tolerance_even_when_the_motion_is_straight():
    time = np.linspace(0.0, 3.0, 3001)
    values = np.column_stack([time, np.zeros_like(time)])  # a line is drawn by its two ends, a pose is not
    rows = rows_of_steps(time, values, 0.01)
    held = values[rows[np.searchsorted(rows, np.arange(3001), side="right") - 1]]
    assert np.abs(held - values).max() <= 0.01
    assert rows_of_line(time, values, 0.01).size < 30


def test_long_series_keep_their_extremes():
    values = np.random.default_rng(1).standard_normal((200_000, 3))
    rows = rows_of_extremes(values, 20_000)
    assert rows.size <= 20_002
    np.testing.assert_array_equal(values[rows].max(axis=0), values.max(axis=0))
    np.testing.assert_array_equal(values[rows].min(axis=0), values.min(axis=0))


@pytest.fixture(scope="module")
def floor():
    return floor_response()


def texts(response, verdicts=None):
    """Return the texts of a run alone by their entities."""
    run = RunResult(response=response, verdicts=tuple(judge(response) if verdicts is None else verdicts))
    return {"/".join(text.path): text.text for text in run_texts(run, title="", scenario_text="")}


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    response = floor_response(mounts=1, equipment=0, rows=80)
    return record_rerun(response, tmp_path_factory.mktemp("run") / "run.rrd")


def test_long_loops_are_exact_around_the_largest_deflection(floor, monkeypatch):
    monkeypatch.setattr(loops, "MOST_TRAIL_ROWS", 40)
    monkeypatch.setattr(loops, "_SHORT_TRAIL", 20)
    loop = next(loop for loop in loops.loops_of(floor, select(floor)) if loop.plot is not None and loop.axis == "axial")
    deflection = floor.mounts[loop.mount].deflection[:, 2] * 1e3
    largest = floor.time[np.abs(deflection).argmax()]
    near = np.abs(loop.time - largest) < 0.01
    assert np.diff(loop.time[near]).max() < 0.0025  # steps of a hundredth of the range are taken every few samples
    assert loop.time[[0, -1]].tolist() == floor.time[[0, -1]].tolist()
    assert 0.0 < loop.trail < 0.1


def test_mounts_are_ranked_by_their_share_of_the_rated_travel(floor):
    selection = select(floor)
    assert selection.axes[0] == "axial"
    ratios = [selection.utilisation(name, "axial") for name in selection.ranked["axial"]]
    assert ratios == sorted(ratios, reverse=True)
    lowest = min(peaks.deflection.minimum[2] for peaks in floor.peaks.mounts.values())
    highest = max(peaks.deflection.maximum[2] for peaks in floor.peaks.mounts.values())
    # Tension counts against its own limit.
    assert ratios[0] == pytest.approx(max(-lowest / 0.04, highest / 0.02), rel=1e-12)


def test_exceeded_travel_is_an_error_and_says_which_mount_and_by_how_much():
    response = floor_response(travel={"compression": 0.01, "tension": 0.5})
    selection = select(response)
    events = events_of(response, selection)
    failed = [row for row in selection.verdicts if row.verdict == EXCEEDED]
    assert len(failed) == 16  # compression, and all axes at once
    for row in failed:
        (passed,) = [event for event in events if event.text == f"{row.subject}: {row.criterion} passes its limit"]
        (peak,) = [event for event in events if event.text == f"maximum: {against_limit(row)}"]
        assert passed.level == peak.level == "ERROR"
        assert passed.time <= peak.time == row.time
    assert "exceeded" in texts(response)["peaks"]


def test_what_is_nearest_to_its_limit_may_be_a_static_load():
    """Loads at rest do not change over time, and have no lane; the answer names them nevertheless."""
    response = floor_response()
    load = Verdict(
        criterion=Criterion("static load in compression", sense="relaxed"),
        subject="m07",
        value=2.6e3,
        limit=2e3,
        unit="N",
    )
    verdicts = (*judge(response), load)
    words = texts(response, verdicts)["verdict"]
    assert "FAIL: m07 static load in compression, relaxed 2.60 kN, limit 2 kN (130 %)" in words
    lines = verdict_lines(response, verdicts)
    assert "Static load: exceeded; most used m07, 130 % of rated static load in compression, relaxed." in lines


def test_nothing_is_judged_where_nothing_is_rated():
    response = floor_response(travel={})
    selection = select(response)
    assert {event.level for event in events_of(response, selection)} == {"INFO"}
    assert np.isnan(selection.utilisations).all()
    assert not selection.used  # its isolators do not state their bars either
    assert "not judged" in texts(response)["peaks"]


def test_the_instant_at_which_a_limit_is_passed_lies_between_samples():
    time = np.linspace(0.0, 1.0, 11)
    assert first_above(time, 2.0 * time, 0.9) == pytest.approx(0.45, abs=1e-15)
    assert first_above(time, 2.0 * time, 2.1) is None
    assert first_above(time, 1.0 + time, 0.9) == 0.0


def test_utilisation_over_time_peaks_where_the_verdict_does(floor):
    used = used_limits(floor, judge(floor))
    assert used
    for one in used:
        assert one.course.max() == pytest.approx(one.largest, rel=2e-3)  # peaks between samples of 1 kHz


def test_forces_are_ranked_by_force_over_all_mounts(floor):
    selection = select(floor)
    names = selection.leading["force", "axial"]
    peaks = [np.abs(floor.mounts[name].force[:, 2]).max() for name in names]
    assert set(names) == set(selection.ranked["axial"])
    assert peaks == sorted(peaks, reverse=True)


class Kept:
    """A stream that keeps what is sent by entity: instants [s] and values."""

    def __init__(self):
        self.rows, self.names = {}, {}

    def log(self, path, look, *, static):
        names = next((b for b in look.as_component_batches() if "names" in str(b.component_descriptor())), None)
        self.names[path] = names.as_arrow_array().to_pylist() if names is not None else []

    def send_columns(self, path, index, columns):
        time = index[0].as_arrow_array().cast("int64").to_numpy() * 1e-9
        self.rows[path] = time, next(iter(columns)).as_arrow_array().flatten().to_numpy()


def test_what_oscillates_too_often_for_a_line_fills_a_band_between_its_extremes():
    time = np.linspace(0.0, 100.0, 100_001)
    size = 1.0 + 0.5 * np.sin(2.0 * np.pi * 0.02 * time)
    curve = Curve(x=time, y=size * np.sin(2.0 * np.pi * 20.0 * time), name="one", kind=0, peak=(12.5, 1.5))
    stream = Kept()
    log_panel(stream, "/p", Panel(curves=[curve], ylabel="", unit="g"), (0.0, 100.0), every=False)
    at, values = stream.rows["/p/1/one"]
    assert at.size < 2000
    assert stream.names["/p/1/one"] == stream.names["/p/1/one/peak"]  # one entry in the legend
    assert stream.names["/p/1/one"][0].endswith("(band)")
    for sign in (1.0, -1.0):
        outer = sign * values > 0.4  # the first and the last sample are kept, too
        # An interval lasts 0.14 s, in which the size changes by at most 0.14 * 0.5 * 2 pi 0.02 = 0.009; 1 kHz misses 0.2 %.
        np.testing.assert_allclose(sign * values[outer], np.interp(at[outer], time, size), atol=0.012)
        assert np.diff(at[outer]).max() < 0.35


def test_the_table_at_the_cursor_holds_the_sample_or_the_largest_of_an_interval_without_gaps(floor):
    run = RunResult(response=floor, verdicts=tuple(judge(floor)))
    rows = cursor_rows(floor.time, run.selection, 1000)
    first, last = np.searchsorted(floor.time, run.selection.window)
    assert set(range(first, min(last, floor.time.size - 1))) <= set(rows.tolist())  # every sample of the event
    now, table = at_cursor(run, 90, 91)
    assert now.text.startswith(f"{floor.time[90]:.4f} s: base ")
    worst = table.rows[0][0]
    assert table.rows[0][1] == floor.mounts[worst].deflection[90, 2]
    among, table = at_cursor(run, 80, 120)
    assert "largest sizes" in among.text
    assert table.rows[0][1] == np.abs(floor.mounts[worst].deflection[80:120, 2]).max()


def test_the_timeline_of_events_has_a_row_at_each_of_the_few_that_matter(floor, tmp_path):
    from rerun.chunk import RrdReader

    path = record_rerun(floor, tmp_path / "run.rrd")
    instants = main_instants(floor, select(floor))
    assert 3 <= instants.size <= 15
    found: dict[str, set[int]] = {}
    for chunk in RrdReader(str(path)).stream():
        batch = chunk.to_record_batch()
        if "event" in batch.schema.names:
            assert "sim_time" not in batch.schema.names
            found.setdefault(str(chunk.entity_path), set()).update(batch["event"].cast("int64").to_pylist())
    assert found["/world/deck/floor"] == set(np.round(instants * 1e9).astype(int).tolist())


def test_axis_numbers_are_round_and_about_as_many_as_asked():
    np.testing.assert_allclose(linear_ticks(-42.6, 17.9, most=6), [-40, -30, -20, -10, 0, 10], atol=1e-12)
    np.testing.assert_allclose(linear_ticks(-5.1, 4.2, most=5), [-4, -2, 0, 2, 4], atol=1e-12)


def test_quaternion_of_a_rotation_turns_as_the_matrix_does():
    rng = np.random.default_rng(5)
    for _ in range(20):
        matrix = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        matrix *= np.sign(np.linalg.det(matrix))
        vector = rng.standard_normal(3)
        np.testing.assert_allclose(rotate(quaternion_of(matrix), vector), matrix @ vector, atol=1e-12)  # roundoff


def test_without_a_screen_the_message_says_what_to_do(recording, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(WireRopeError, match=r"--web, or copy the file.* open it there: rerun run\.rrd$"):
        show(recording)


def test_without_a_screen_the_file_is_named_that_is_to_be_opened(tmp_path, monkeypatch):
    monkeypatch.setattr("wirerope_mj.views.recording.viewer.has_display", lambda: False)
    (tmp_path / "worst").mkdir()
    for name in ("study.toml", "worst/worst.rrd"):
        (tmp_path / name).touch()
    with pytest.raises(WireRopeError, match=r"open it there: rerun worst\.rrd$"):
        show(tmp_path)


def test_a_folder_without_a_recording_is_named(tmp_path):
    with pytest.raises(RecordError, match=r"run\.rrd: there is no such recording"):
        show(tmp_path)


def test_the_browser_gets_recording_and_viewer_from_this_machine_only_and_opens_at_the_most_critical_instant(recording):
    (opening,) = openings_of(recording)
    code = f"from wirerope_mj.views.share.server import show_in_browser as show; show({str(recording)!r})"
    with interruptible([sys.executable, "-c", code]) as process:
        address = process.stdout.readline().split()[1]
        page = fetch(address, process)
        root = address.partition("/viewer/")[0]
        assert fetch(f"{root}/run.rrd", process) == recording.read_bytes()
        assert fetch(f"{root}/viewer/re_viewer_bg.wasm", process).startswith(b"\0asm")
        foreign = urllib.request.Request(f"{root}/run.rrd", headers={"Host": "example.org"})
        with pytest.raises(urllib.error.HTTPError, match="for this machine only"):
            urllib.request.urlopen(foreign, timeout=120)
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=120) == 0
    assert address.startswith("http://127.0.0.1:")
    assert address.endswith(f"/viewer/index.html#{opening.at:.9g}")
    assert b"<html" in page.lower()


def fetch(address, process) -> bytes:
    while process.poll() is None:
        try:
            with urllib.request.urlopen(address, timeout=120) as answer:
                return answer.read()
        except OSError:
            time.sleep(0.1)  # the server needs a moment
    raise AssertionError(f"{address} does not answer")


def test_a_port_in_use_is_avoided():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        taken = listener.getsockname()[1]
        assert free_port(taken) != taken
    assert address_of(2, [Opening("id", POINT, 34)]) == "http://127.0.0.1:2/viewer/index.html#point@34"


def test_letters_that_the_viewer_lacks_are_spelled_wherever_they_stand(tmp_path):
    import pyarrow as pa
    from rerun.chunk import RrdReader

    response = floor_response(mounts=2, equipment=1, rows=80)
    names = {"m01": "安装 1", "m02": "Dämpfer α"}
    scene = replace(response.scene, mounts=tuple(replace(m, name=names[m.name]) for m in response.scene.mounts))
    mounts = {names[name]: mount for name, mount in response.mounts.items()}
    peaks = replace(response.peaks, mounts={names[name]: peak for name, peak in response.peaks.mounts.items()})
    samples = replace(
        response.samples,
        names=[n.replace("m01", names["m01"]).replace("m02", names["m02"]) for n in response.samples.names],
    )
    response = replace(response, scene=scene, mounts=mounts, peaks=peaks, samples=samples)
    path = record_rerun(response, tmp_path / "run.rrd", title="❌", scenario_text="[a]\nb = '𝛼'")
    texts = []
    for chunk in RrdReader(str(path)).stream():
        texts.append(str(chunk.entity_path))
        for column in chunk.to_record_batch().columns:
            values = column.flatten() if pa.types.is_list(column.type) else column
            texts += [text for text in values.to_pylist() if text] if pa.types.is_string(values.type) else []
    everything = "".join(texts)
    assert "U+5B89U+88C5 1" in everything
    assert "Dämpfer α" in everything
    assert "U+274C" in everything
    assert known_letters(everything) == everything


def test_a_run_whose_system_is_at_hand_says_its_natural_frequencies():
    system, shock = load_system("sdof_shaker"), HalfSine(peak=10.0, duration=0.011, direction="z")
    run = judged_run(system, shock, simulate(system, shock, duration=0.02, timestep=5e-4))
    texts = {text.name: text for text in run_texts(run, title="", scenario_text="")}
    assert texts["Modes"].place == "Modes"
    frequency = modes(system).frequencies[0]
    assert f"{frequency:.3f}" in texts["Modes"].text
    assert "Quote the small-amplitude natural frequency for small vibration" in texts["Modes"].text
    alone = RunResult(response=run.response, verdicts=())
    assert "Modes" not in {text.name for text in run_texts(alone, title="", scenario_text="")}
