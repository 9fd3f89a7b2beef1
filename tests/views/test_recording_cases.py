"""The recording of a job: a recording for each case, one layout in which each is shown under its own titles."""

import re
import shutil
import threading

import pytest
from made_up_floor import floor_response
from rerun.chunk import RrdReader

import wirerope_mj as wr
from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.content.selection import select
from wirerope_mj.foundation.half_written import clear_half_written
from wirerope_mj.views.recording import record, record_rerun, show, viewer
from wirerope_mj.views.recording.record import record_cases

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


def test_all_cases_are_recordings_of_one_application_in_one_layout(recorded):
    reader = RrdReader(str(recorded))
    assert len(reader.recordings()) == 2
    assert len(reader.blueprints()) == 1
    assert len({store.application_id for store in (*reader.recordings(), *reader.blueprints())}) == 1


def test_every_recording_has_the_name_and_the_verdict_of_its_case(columns):
    names = [texts(columns, "recording", n, "/__properties", "RecordingInfo:name")[0] for n in range(2)]
    assert sorted(names) == sorted([UP, ACROSS])
    for number, name in enumerate(names):
        assert texts(columns, "recording", number, "/verdict", "TextDocument:text")[0].startswith(f"{name}: ")


def test_no_name_of_the_common_layout_says_what_holds_for_one_case_alone(columns):
    views = [batch for batch in columns["blueprint", 0].values() if "ViewBlueprint:display_name" in batch]
    names = [batch["ViewBlueprint:display_name"].flatten().to_pylist()[0] for batch in views]
    assert len(names) > 20
    for name in names:
        assert not re.search(r"\d %|of its limit|used of", name), name
    assert "Spectra, over frequency [Hz]" in names  # along z of one, along y of the other: each plot says which
    titles = [texts(columns, "recording", n, "/frequencies/title", "Points2D:labels")[0] for n in range(2)]
    assert {title[-7:] for title in titles} == {"along y", "along z"}


def test_every_view_of_the_layout_finds_its_entities_in_every_case(columns):
    views = [
        batch for path, batch in columns["blueprint", 0].items() if "/view/" in path and "ViewBlueprint:space_origin" in batch
    ]
    origins = {batch["ViewBlueprint:space_origin"].flatten().to_pylist()[0] for batch in views}
    assert {origin.split("/")[1] for origin in origins} >= {"loops", "histories", "verdict", "frequencies", "plan", "cursor"}
    for number in range(2):
        logged = columns["recording", number]
        assert not [origin for origin in origins if not any(path.startswith(origin) for path in logged)]


def test_the_viewer_is_given_the_whole_file_as_it_opens_one_recording_of_a_file_that_it_opens_by_name(recorded, monkeypatch):
    calls = []
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(viewer, "_run_viewer", lambda command, recording: calls.append((command[-1], recording.read(3))))
    show(recorded)
    assert calls == [("-", b"RRF")]


def test_the_viewer_opens_at_the_most_critical_instant(tmp_path, monkeypatch):
    response = floor_response()
    path = record_rerun(response, tmp_path / "run.rrd")
    worst = select(response).used[0].governing
    assert viewer.opening_instant(path) == worst.time > 0.0
    moved, answered = [], threading.Event()

    class Starting:
        """A viewer that answers at the third time."""

        calls = 0

        def __init__(self, url):
            Starting.calls += 1
            if Starting.calls < 3:
                raise ConnectionError("transport error")

        def set_time(self, timeline, **cursor):
            moved.append((timeline, cursor))
            answered.set()

    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(viewer, "ViewerClient", Starting)
    monkeypatch.setattr(viewer, "_run_viewer", lambda command, recording: answered.wait(120.0))
    show(path)
    assert moved == [("sim_time", {"duration": worst.time, "play_state": "paused"})]
