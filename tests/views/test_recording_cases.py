"""The recording of a job: a recording with a layout of its own for each case."""

import re
import shutil
import threading
from types import SimpleNamespace

import pytest
from made_up_floor import floor_response
from rerun.chunk import RrdReader

import wirerope_mj as wr
from wirerope_mj.assessment.criteria import body_peaks
from wirerope_mj.content.first_sheet import panel_over_frequency
from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.content.selection import select
from wirerope_mj.foundation.half_written import clear_half_written
from wirerope_mj.views.recording import record, record_rerun, show, viewer
from wirerope_mj.views.recording.record import record_cases
from wirerope_mj.views.share.server import cursors_of

UP, ACROSS = "upwards, 10 g", "athwartships"


@pytest.fixture(scope="module")
def runs():
    """Return two cases, one of which moves the cabinet up and down, the other to and fro."""
    system = wr.load_system("cabinet")
    runs = {}
    for name, peak, direction in ((UP, 10.0, "z"), (ACROSS, 6.0, "y")):
        motion = wr.HalfSine(peak=peak * wr.STANDARD_GRAVITY, duration=0.011, direction=direction, start=0.02)
        runs[name] = judged_run(system, motion, wr.simulate(system, motion, duration=0.2, accuracy=1e-2))
    return runs


@pytest.fixture(scope="module")
def recorded(runs, tmp_path_factory):
    path = tmp_path_factory.mktemp("cases") / "job.rrd"
    record_cases(runs, path, notes={UP: "clause 5.1", ACROSS: ""})
    return path


def test_what_a_killed_process_leaves_of_a_recording_is_removed_by_the_next(runs, tmp_path, monkeypatch):
    left = tmp_path / "left"

    def copy(parts, path):
        assert all(part.is_file() for part in parts)
        shutil.copytree(path.parent, left)

    monkeypatch.setattr(record, "join_recordings", copy)
    (tmp_path / "job").mkdir()
    record_cases(runs, tmp_path / "job" / "job.rrd", notes={UP: "", ACROSS: ""})
    assert list(left.iterdir())
    clear_half_written(left)
    assert not list(left.iterdir())


@pytest.fixture(scope="module")
def columns(recorded):
    """Return the columns of every entity, by store: its kind and its number in the file."""
    reader = RrdReader(str(recorded))
    found = {}
    for kind, stores in (("recording", reader.recordings()), ("blueprint", reader.blueprints())):
        for number, store in enumerate(stores):
            entities = found.setdefault((kind, number), {})
            for chunk in reader.stream(store=store):
                batch = chunk.to_record_batch()
                entities.setdefault(str(chunk.entity_path), {}).update({name: batch[name] for name in batch.schema.names})
    return found


def texts(columns, kind, number, path, component):
    return columns[kind, number][path][component].flatten().to_pylist()


def test_every_case_has_a_layout_of_its_own(recorded):
    reader = RrdReader(str(recorded))
    applications = [[store.application_id for store in stores] for stores in (reader.recordings(), reader.blueprints())]
    assert len(set(applications[0])) == 2
    assert sorted(applications[0]) == sorted(applications[1])


def test_every_recording_has_the_name_and_the_verdict_of_its_case(columns):
    names = [texts(columns, "recording", n, "/__properties", "RecordingInfo:name")[0] for n in range(2)]
    assert sorted(names) == sorted([UP, ACROSS])
    for number, name in enumerate(names):
        assert texts(columns, "recording", number, "/verdict", "TextDocument:text")[0].startswith(f"{name}: ")


def test_the_views_of_a_case_find_its_entities_and_their_titles_hold_for_any_case(recorded):
    """A viewer that opens the file by its name shows every case in one layout: figures of a case stand in its data."""
    reader = RrdReader(str(recorded))
    for store in reader.recordings():
        logged = [str(chunk.entity_path) for chunk in reader.stream(store=store)]
        (layout,) = [blueprint for blueprint in reader.blueprints() if blueprint.application_id == store.application_id]
        origins, names = set(), set()
        for chunk in reader.stream(store=layout):
            batch = chunk.to_record_batch()
            if "/view/" in str(chunk.entity_path) and "ViewBlueprint:space_origin" in batch.schema.names:
                origins.add(batch["ViewBlueprint:space_origin"].flatten().to_pylist()[0])
                names.add(batch["ViewBlueprint:display_name"].flatten().to_pylist()[0])
        assert {origin.split("/")[1] for origin in origins} >= {
            "loops",
            "histories",
            "verdict",
            "frequencies",
            "plan",
            "cursor",
        }
        assert not [origin for origin in origins if not any(path.startswith(origin) for path in logged)]
        axis = "z" if store.application_id.endswith(UP.replace(",", "-")) else "y"
        assert not [name for name in names if re.search(r"\d+ ?%|\d times", name)]
        assert {"Over frequency [Hz]", "Used of the limits [%]", "Motion enlarged"} <= names
        said = [
            label
            for chunk in reader.stream(store=store)
            for name in ("Points2D:labels", "Points3D:labels")
            if name in (batch := chunk.to_record_batch()).schema.names
            for label in batch[name].flatten().to_pylist()
        ]
        assert f"SRS, Q = 10: [g] along {axis}" in said
        assert any(re.fullmatch(r"motion \d+ times larger", str(label)) for label in said)


def test_the_viewer_is_given_the_whole_file_as_it_opens_one_recording_of_a_file_that_it_opens_by_name(recorded, monkeypatch):
    calls = []
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(viewer, "_run_viewer", lambda command, recording: calls.append((command[-1], recording.read(3))))
    show(recorded)
    assert calls == [("-", b"RRF")]


class Starting:
    """A viewer that answers at the third time, with recordings of given ids."""

    def __init__(self, recordings):
        self.recordings, self.calls, self.done, self.answered = recordings, 0, [], threading.Event()

    def __call__(self, url):
        self.calls += 1
        if self.calls < 3:
            raise ConnectionError("transport error")
        return self

    def get_state(self):
        timelines = [SimpleNamespace(name="sim_time")]
        found = [
            SimpleNamespace(store_id=f"Recording:a b:{name}", location=name, timelines=timelines) for name in self.recordings
        ]
        return SimpleNamespace(recordings=found)

    def set_time(self, timeline, *, recording, **cursor):
        self.done.append((recording, timeline, cursor))
        if len(self.done) == len(self.recordings) == 1:
            self.answered.set()

    def set_location(self, location):
        self.done.append(location)
        self.answered.set()


def opened(path, monkeypatch):
    """Show a recording in a viewer that is starting; return what it is told."""
    starting = Starting([store.recording_id for store in RrdReader(str(path)).recordings()])
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(viewer, "ViewerClient", starting)
    monkeypatch.setattr(viewer, "_run_viewer", lambda command, recording: starting.answered.wait(120.0))
    show(path)
    return starting.done


def test_the_viewer_opens_at_the_most_critical_instant(tmp_path, monkeypatch):
    response = floor_response()
    path = record_rerun(response, tmp_path / "run.rrd")
    worst = max(select(response).used, key=lambda used: used.largest).governing
    ((_, timeline, cursor),) = opened(path, monkeypatch)
    assert (timeline, cursor) == ("sim_time", {"duration": worst.time, "play_state": "paused"})
    assert worst.time > 0.0


def test_every_case_opens_at_its_most_critical_instant_and_the_worst_case_is_in_front(runs, recorded, monkeypatch):
    *moved, front = opened(recorded, monkeypatch)
    used = {name: max(run.selection.used, key=lambda entry: entry.largest) for name, run in runs.items()}
    assert {cursor["duration"] for *_, cursor in moved} == {entry.governing.time for entry in used.values()}
    worst = max(used.values(), key=lambda entry: entry.largest).governing.time
    ((store, *_),) = [move for move in moved if move[2]["duration"] == worst]
    assert store.endswith(front)


def test_a_browser_is_told_where_every_case_opens_by_the_names_of_the_viewer(recorded):
    cursors = cursors_of(viewer.openings_of(recorded))
    stores = {f"Recording:{store.application_id}:{store.recording_id}" for store in RrdReader(str(recorded)).recordings()}
    assert {name for *_, name in cursors} == stores
    assert all(timeline == "sim_time" and 10**7 < instant < 2 * 10**8 for timeline, instant, _ in cursors)


def test_a_run_without_limits_opens_at_the_largest_acceleration_of_what_stands_on_the_mounts(tmp_path):
    response = floor_response(travel={})
    (opening,) = viewer.openings_of(record_rerun(response, tmp_path / "run.rrd"))
    peaks = [response.peaks.bodies[name].acceleration for name in select(response).bodies]
    peaks += [peak.acceleration for peak in response.peaks.points.values()]
    assert opening.at == max(peaks, key=lambda peak: peak.value).time


def test_spectra_of_a_base_that_moves_along_several_axes_are_those_along_the_largest_peak_of_the_payload():
    system, up, across = wr.load_system("cabinet"), 8.0 * wr.STANDARD_GRAVITY, 3.0 * wr.STANDARD_GRAVITY
    motion = wr.HalfSine(peak=across, duration=0.011, direction="x") + wr.HalfSine(peak=up, duration=0.011, direction="z")
    run = judged_run(system, motion, wr.simulate(system, motion, duration=0.1, accuracy=1e-2))
    worst = max((row for row in body_peaks(run.response) if row.kind != "base"), key=lambda row: row.value)
    assert worst.axes[2] > worst.axes[0]
    assert panel_over_frequency(run).ylabel.endswith("along z")
