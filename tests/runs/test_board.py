"""A board without its page: what edits, undoing, saving and other people's changes make of files, statics and verdict."""

import json
import re
import shutil
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.content.job import job_headline
from wirerope_mj.foundation.errors import ModelError, SimulationError
from wirerope_mj.runs.board.board import Board
from wirerope_mj.runs.board.documents import JOURNAL
from wirerope_mj.runs.board.opened import from_template, opened
from wirerope_mj.runs.board.parts import _tried as parts_tried
from wirerope_mj.runs.job_file import load_job
from wirerope_mj.runs.room import overlapping
from wirerope_mj.runs.scenario import load_scenario

JOB = """# two mounts more would do
model = "."

[limits]
"acceleration/equipment" = "3 g"

[[case]]
name = "shock"
half-sine = "10 g 11 ms z"
[case.simulate]
"""
JOB = JOB.replace("[case.simulate]\n", "duration = 0.4\n")


@pytest.fixture
def folder(tmp_path):
    made = from_template("genset", tmp_path / "genset")
    (made / "job.toml").write_text(JOB, encoding="utf-8")
    return made


@pytest.fixture
def board(folder):
    made = Board(opened(folder))
    yield made
    made.close()


def texts(folder):
    return {path.name: path.read_bytes() for path in folder.glob("*.*") if path.suffix in (".csv", ".toml")}


def act(board, **action):
    """Return all that an action is answered by, as one message; the last word counts."""
    told: dict = {"html": {}}
    for _, message in board.act(action):
        if isinstance(message, Future):
            message.result()
            continue
        json.dumps(message, allow_nan=False)
        told = {**told, **message, "html": told["html"] | message.get("html", {})}
    return told


def mount(message, name):
    return next(each for each in message["scene"]["items"] if each.get("name") == f"mount/{name}")


def centre(message, mark):
    return next(each["position"] for each in message["scene"]["items"] if each.get("mark") == mark)


def test_what_is_saved_gives_the_same_verdict_by_the_command(board, folder, tmp_path):
    act(board, do="move", names=["mount/m1", "mount/m4"], by=[40, 0, 0])
    shown = act(board, do="judge")["html"]["verdict"]
    assert act(board, do="save")["said"] == f"Saved: mounts.csv, in {folder}."
    run = wr.run_job(folder / "job.toml", tmp_path / "run", workers=1)
    said = json.loads((tmp_path / "run" / "cases" / "shock" / "summary.json").read_text())["content"]["headline"]["text"]
    assert said.replace(" %", "\u00a0%") in shown
    assert run.headline == job_headline(run.job.verdicts).text


@pytest.mark.slow
def test_undone_to_the_beginning_the_files_are_those_of_before(board, folder):
    before = texts(folder)
    edits = [
        {"do": "move", "names": ["mount/m1"], "by": [13, 7, -2]},
        {"do": "turn", "names": ["mount/m2"], "degrees": 90},
        {"do": "turn", "names": ["mass/alternator"], "degrees": 90},
        {"do": "stand", "names": ["mount/m3"], "on": "wall"},
        {"do": "duplicate", "names": ["mount/m6"]},
        {"do": "align", "names": ["mount/m4", "mount/m5"], "axis": "y"},
        {"do": "cell", "table": "masses", "row": "frame", "column": "mass", "value": "210"},
        {"do": "case", "case": "0", "key": "motions", "value": "half-sine 11 g 11 ms z"},
        {"do": "add-limit", "value": "load/m3 = 50 kN"},
        {"do": "remove", "names": ["point/terminal_box"]},
    ]
    for edit in edits:
        assert "refused" not in act(board, **edit), edit
    act(board, do="save")
    assert texts(folder) != before
    for _ in edits:
        act(board, do="undo")
    told = act(board, do="undo")
    assert (told["said"], "refused" in told) == ("There is nothing to undo.", False)
    act(board, do="save")
    assert texts(folder) == before
    assert act(board, do="redo")["said"].startswith("Done again: moved m1")


def test_a_mount_stands_as_it_was_turned_mirrored_and_lifted(board):
    turned = act(board, do="turn", names=["mount/m2"], degrees=90)
    np.testing.assert_allclose(mount(turned, "m2")["axial"], [-0.5, 0.0, np.sqrt(0.75)], atol=1e-5)
    wall = act(board, do="stand", names=["mount/m2"], on="wall")
    assert mount(wall, "m2")["axial"] == [0.0, 1.0, 0.0]
    assert wall["said"] == "Placed m2 at the wall towards \u2212y, the side of the equipment that was nearest."
    ceiling = act(board, do="stand", names=["mount/m2"], on="ceiling")
    np.testing.assert_allclose(mount(ceiling, "m2")["axial"], [0.0, 0.0, -1.0], atol=1e-9)
    assert mount(wall, "m2")["position"][1] == round(mount(wall, "m2")["position"][1])
    act(board, do="remove", names=["mount/m3"])
    low, high = -1082.575, 1082.575  # of the frame's box along x
    mirrored = act(board, do="mirror", names=["mount/m1"], axis="x")
    assert mount(mirrored, "m1")["position"][0] == pytest.approx(low + high + 800.0, abs=0.01)


@pytest.mark.parametrize(("name", "y"), [("m1", -372.0), ("m5", 372.0)])
def test_on_the_floor_after_the_wall_a_mount_stands_below_the_equipment(board, name, y):
    floor, wall, back = (
        mount(next(board.act({"do": "stand", "names": [f"mount/{name}"], "on": on}))[1], name)
        for on in ("floor", "wall", "floor")
    )
    assert abs(wall["position"][1]) > 402.0
    assert back["axial"] == [0.0, 0.0, 1.0]
    assert back["position"] == [floor["position"][0], y, floor["position"][2]]


def test_a_row_is_found_by_the_name_that_it_had(board):
    act(board, do="cell", table="masses", row="frame", column="name", value="skid")
    assert "skid, mass 90" in act(board, do="cell", table="masses", row="frame", column="mass", value="90")["said"].lower()
    act(board, do="undo")
    act(board, do="undo")
    assert "frame, mass 91" in act(board, do="cell", table="masses", row="frame", column="mass", value="91")["said"]


def test_what_was_saved_says_what_is_no_more(board, folder):
    stops = [item["name"] for item in board.open()["scene"]["items"] if item["kind"] == "stop" and item["movable"]]
    act(board, do="remove", names=[name for name in stops if name.partition("/")[2] in (folder / "stops.csv").read_text()])
    assert act(board, do="save")["said"] == f"Saved: stops.csv (taken away), in {folder}."
    assert not (folder / "stops.csv").exists()


def test_what_was_dragged_where_nothing_may_stand_shows_again_what_stands(board):
    shown = act(board, do="judge")
    act(board, do="drag", names=["mount/m1"], by=[750, 0, 0])
    told = act(board, do="move", names=["mount/m1"], by=[750, 0, 0])
    assert told["refused"] is None
    for key in ("statics", "verdict"):
        assert told["html"][key] == shown["html"][key]
    assert (told["scene"], told["stale"]) == (shown["scene"], False)


def test_an_absurd_level_is_given_up_with_the_statics_of_what_stands(board, monkeypatch):
    monkeypatch.setattr("wirerope_mj.runs.board.loaded._LONGEST", 0.0)  # every finer step is too long
    told = act(board, do="case", case="0", key="motions", value="half-sine 1e6 g 11 ms z")
    assert "No verdict: steps down to" in told["html"]["verdict"]
    assert "At rest" in told["html"]["statics"]
    monkeypatch.undo()
    assert "No verdict" not in act(board, do="undo")["html"]["verdict"]


def test_what_is_doubtful_about_a_phrase_is_said_below_it(board, recwarn, monkeypatch):
    monkeypatch.setattr("wirerope_mj.runs.board.loaded._LONGEST", 0.0)
    phrase = "half-sine 1e6 g 11 ms z"
    form = act(board, do="case", case="0", key="motions", value=phrase)["html"]["left"]
    below = form.partition(f'value="{phrase}"')[2].partition("</div>")[0]
    assert "more than shock tests do" in below
    assert form.count("more than shock tests do") == 1
    assert "less than a footstep" in act(board, do="limit", key="acceleration/equipment", value="1 mm/s^2")["html"]["left"]
    form = act(board, do="case", case="0", key="motions", value="half-sine 5 g 11 ms z")["html"]["left"]
    assert "more than shock tests do" not in form
    assert not recwarn.list  # nothing of it on the terminal alone


def test_the_page_says_what_combined_travel_is(board):
    assert "root of the sum of the squares" in act(board, do="judge")["html"]["verdict"]


def test_a_limit_may_lack_its_sign_and_one_that_limits_nothing_is_refused(board):
    assert "acceleration/equipment" in act(board, do="add-limit", value="acceleration/equipment 4 g")["html"]["left"]
    assert act(board, do="judge")["html"]["verdict"] != ""
    for text in ("4 g", "acceleration", "acceleration/rack"):
        assert act(board, do="add-limit", value=text, id="1")["refused"] == "1"


def test_what_is_not_judged_has_no_share_and_one_share_is_written_by_one_rule(board):
    board._verdicts.used = {"m1": 1.19496}  # to four digits first it would be 120 %
    words = mount(board.open(), "m1")["words"]
    assert words.endswith("119 % used")
    next(board.act({"do": "case", "case": "0", "key": "motions", "value": "half-sine 5 g 11 ms z"}))
    hung = mount(act(board, do="stand", names=[f"mount/m{n}" for n in range(1, 7)], on="ceiling"), "m1")
    assert (hung["used"], hung["tone"]) == (None, "quiet")


def test_every_load_case_says_its_motion_and_what_came_out(board):
    next(board.act({"do": "add-case"}))
    verdict = act(board, do="case", case="1", key="motions", value="half-sine 2 g 11 ms x")["html"]["verdict"]
    assert "shock\nhalf-sine 10 g 11 ms along z → " in verdict
    assert "case 1\nhalf-sine 2 g 11 ms along x → " in verdict
    assert '<details id="of-case-1"><summary>case 1: <span class="' in verdict


def test_parts_are_found_and_tried_in_all_places(board, monkeypatch):
    def futures(function, questions, stop):
        made = [Future() for _ in questions]
        for future, question in zip(made, questions, strict=True):
            future.set_result(function(question))
        return made

    monkeypatch.setattr("wirerope_mj.studies.engines.local.futures_of_processes", futures)
    assert "CB1400-10" in act(board, do="find", value="cb1400")["html"]["found"]
    assert "No part" in act(board, do="find", value="WR99")["html"]["found"]
    assert "<svg" in act(board, do="loops", value="WR12-400")["html"]["loops"]
    tried = act(board, do="try-parts", value="WR16-[46]00")["html"]["tried"]
    assert "WR16-400" in tried
    assert "stop-trial" not in tried
    rows = tried[tried.index("<table") :]
    assert rows in act(board, do="move", names=["mount/m1"], by=[10, 0, 0])["html"]["left"]
    assert "no part" in act(board, do="loops", value="x")["said"]


def test_parts_that_are_tried_are_counted_and_of_the_position_as_they_were_asked_for(board, monkeypatch):
    made = [Future(), Future()]
    monkeypatch.setattr("wirerope_mj.studies.engines.local.futures_of_processes", lambda function, questions, stop: made)
    asked = board.act({"do": "try-parts", "value": "WR1*"})
    begun = next(asked)[1]["html"]["tried"]
    assert "Tried 0 of 16 parts." in begun
    assert "stop-trial" in begun
    assert next(asked)[1] is made[0]
    made[0].set_result(parts_tried(board._loaded.job.system, {}, {f"WR1{n}": "no isolator" for n in range(8)}))
    assert "Tried 8 of 16 parts." in next(asked)[1]["html"]["tried"]
    assert next(asked)[1] is made[1]
    note = "of the position before"
    assert note in next(board.act({"do": "move", "names": ["mount/m1"], "by": [10, 0, 0]}))[1]["html"]["left"]
    assert note not in next(board.act({"do": "undo"}))[1]["html"]["left"]
    stopped = act(board, do="stop-trial")["html"]["tried"]
    assert "Stopped: tried 8 of 16 parts." in stopped
    assert "stop-trial" not in stopped
    made[1].cancel()
    assert not [*asked]


@pytest.mark.slow
def test_other_processes_try_parts_until_they_are_stopped(board):
    asked = board.act({"do": "try-parts", "value": "*"})
    answers = [next(message for _, message in asked if isinstance(message, Future)) for _ in range(2)]
    answers[0].result()
    act(board, do="stop-trial")
    for _, message in asked:
        with suppress(CancelledError):
            assert isinstance(message, dict) or message.result()
    with pytest.raises(CancelledError):
        board._trial._answers[-1].result()


def test_why_parts_cannot_be_tried_is_said(board):
    endless = {"hum": wr.Sine(acceleration=1.0, frequency=10.0, direction="z")}
    assert "has no end" in parts_tried(board._loaded.job.system, endless, {"WR16-400": wr.load_isolator("WR16-400")})
    assert act(board, do="try-parts", value="nothing", id="1")["refused"] == "1"


def test_where_two_mounts_would_stand_in_each_other_nothing_moves(board, folder):
    before = texts(folder)
    told = act(board, do="move", names=["mount/m1"], by=[750, 0, 0], id="7")
    assert (told["refused"], told["said"]) == ("7", "Mounts m1 and m2 would stand in each other.")
    act(board, do="save")
    assert texts(folder) == before
    preview = act(board, do="drag", names=["mount/m1"], by=[750, 0, 0])
    assert [each["label"] for each in preview["scene"]["items"] if each.get("collides")] == ["m1", "m2"]


def test_the_preview_of_a_drag_is_the_statics_of_where_it_ends(board):
    preview = act(board, do="drag", names=["mount/m1"], by=[100, 0, 0])
    assert (preview["scene"]["names"], preview["scene"]["by"]) == (["mount/m1"], [100, 0, 0])
    moved = act(board, do="move", names=["mount/m1"], by=[100, 0, 0])
    assert preview["html"]["statics"] == moved["html"]["statics"]
    assert moved["scene"]["names"] == []
    assert centre(preview, "stiffness") == centre(moved, "stiffness")
    assert mount(preview, "m1")["position"] == mount(moved, "m1")["position"] == [-700.0, -300.0, 100.0]


@pytest.mark.parametrize("names", [["mount/m1"], ["mass/engine"]])
def test_the_preview_has_deck_and_sliders_of_what_stands(board, names):
    act(board, do="job", key="deck", value="10 Hz 800 kg 4 %")
    act(board, do="slide", key="mass", value="1.2")
    still = act(board, do="drag", names=names, by=[0.0, 0.0, 0.0])
    assert still["html"]["statics"] == act(board, do="judge")["html"]["statics"]
    assert act(board, do="drag", names=names, by=[100.0, 0.0, 0.0])["html"]["statics"] != still["html"]["statics"]


def test_a_mount_in_thin_air_is_told_while_it_is_dragged_and_after(board):
    assert "from the equipment" not in act(board, do="judge")["html"]["statics"]
    way = {"names": ["mount/m1"], "by": [-700, 0, 0]}
    dragged = act(board, do="drag", **way)["html"]["statics"]
    assert "m1 stands" in dragged
    assert "mm from the equipment" in dragged
    assert "m1 stands" in act(board, do="move", **way)["html"]["statics"]


def test_a_verdict_with_steps_of_the_last_position_says_so_until_its_own_follows(board):
    act(board, do="judge")
    verdicts = [
        message["html"]["verdict"] for _, message in board.act({"do": "move", "names": ["mount/m1"], "by": [10, 0, 0]})
        if "verdict" in message.get("html", {})
    ]  # fmt: skip
    assert ["A preliminary verdict" in verdict for verdict in verdicts] == [True, False]


def test_inertia_turns_and_mirrors_with_its_mass(board):
    def inertia():
        mass = next(mass for mass in board._loaded.layout.masses if mass.name == "engine")
        return mass.properties.inertia

    np.testing.assert_allclose(inertia(), [[50.0, 0.0, 4.0], [0.0, 90.0, 0.0], [4.0, 0.0, 80.0]])
    act(board, do="turn", names=["mass/engine"], degrees=90)  # x goes to y, y to -x
    np.testing.assert_allclose(inertia(), [[90.0, 0.0, 0.0], [0.0, 50.0, 4.0], [0.0, 4.0, 80.0]], atol=1e-9)
    act(board, do="mirror", names=["mass/engine"], axis="y")
    np.testing.assert_allclose(inertia(), [[90.0, 0.0, 0.0], [0.0, 50.0, -4.0], [0.0, -4.0, 80.0]], atol=1e-9)


def test_the_centre_of_stiffness_is_over_the_mean_of_equal_mounts_with_equal_loads(tmp_path):
    for name, text in {
        "mounts": "\n".join(["name, x [mm], y [mm], z [mm], isolator"] + [
            f"m{n}, {x}, {y}, 0, WR2-800" for n, (x, y) in enumerate([(-60, -40), (60, -40), (-60, 40), (60, 40)])
        ]),
        "masses": "name, mass [kg], x [mm], y [mm], z [mm], size_x [mm], size_y [mm], size_z [mm]\n"
        "box, 2.4, 0, 0, 60, 120, 80, 100",
    }.items():  # fmt: skip
        (tmp_path / f"{name}.csv").write_text(text + "\n")
    made = Board(opened(tmp_path))
    told = made.open()
    made.close()
    np.testing.assert_allclose(centre(told, "stiffness"), [0.0, 0.0, 0.0], atol=1e-2)
    assert centre(told, "mass") == [0.0, 0.0, 60.0]


def test_a_wrong_word_is_named_and_changes_nothing(board, folder):
    told = act(board, do="case", case="0", key="motions", value="half-sine 15 gg 11 ms z", id="3")
    assert (told["refused"], told["word"], told["tone"]) == ("3", "gg", "bad")
    assert '"gg" is no unit' in told["said"]
    assert str(board._documents.copies) not in told["said"]
    assert act(board, do="save")["said"] == "Saved: nothing has changed."


@pytest.mark.parametrize(
    ("said", "action"),
    [
        (
            'For example "half-sine 15 g 11 ms z". "gg" is no unit known here; known are m/s^2',
            {"do": "case", "case": "0", "key": "motions", "value": "half-sine 15 gg 11 ms z"},
        ),
        (
            'For example "random 1 g rms 5 to 200 Hz 30 s z seed 1". A time must stand there',
            {"do": "case", "case": "0", "key": "motions", "value": "random 1 g 5 to 20 Hz z"},
        ),
        (
            'For example "half-sine 15 g 11 ms z". "15" is no motion; a case begins with one of half-sine, ',
            {"do": "case", "case": "0", "key": "motions", "value": "15 g 11 ms z"},
        ),
        ("For example \"load/m3 = 5 kN\". 'g' is no unit of load", {"do": "add-limit", "value": "load/m1 = 5 g"}),
        ('For example "10 Hz 800 kg 4 %". A deck has one frequency', {"do": "job", "key": "deck", "value": "10 Hz"}),
        ("'cold' is no unit of temperature", {"do": "job", "key": "temperature", "value": "cold"}),
        (
            'The table of mounts: "wide" in column "x" is not a number.',
            {"do": "cell", "table": "mounts", "row": "m1", "column": "x", "value": "wide"},
        ),
        (
            "The table of mounts: column \"isolator\": there is no isolator 'WR99'. The catalogue holds",
            {"do": "cell", "table": "mounts", "row": "m1", "column": "isolator", "value": "WR99"},
        ),
    ],
)  # fmt: skip
def test_a_refusal_begins_with_an_example_and_names_no_line_of_a_file(board, said, action):
    told = act(board, **action, id="1")["said"]
    assert told.startswith(said)
    assert not re.search(r"line \d|\.csv|\.toml|It is written like", told)


@pytest.mark.parametrize(
    "action",
    [
        {"do": "fly"}, {"do": "move"}, {"do": "move", "names": ["mount/nobody"], "by": [1, 2, 3]},
        {"do": "move", "names": ["mount/m1"], "by": [1, 2]}, {"do": "move", "names": ["mount/m1"], "by": "far"},
        {"do": "cell", "table": "mounts", "row": "m1", "column": "x", "value": "wide"},
        {"do": "cell", "table": "mounts", "row": "m1", "column": "__class__", "value": "1"},
        {"do": "cell", "table": "../x", "row": "m1", "column": "x", "value": "1"},
        {"do": "turn", "names": ["mount/m1"], "degrees": "x"}, {"do": "align", "names": ["mount/m1"], "axis": "w"},
        {"do": "stand", "names": ["mass/engine"], "on": "wall"}, {"do": "case", "case": "9", "key": "name", "value": "x"},
        {"do": "slide", "key": "level", "value": "much"}, {"do": "slide", "key": "nothing", "value": 1.0},
        {"do": "job", "key": "model", "value": "cabinet"}, {"do": "part", "value": "WR99-1"}, {"do": "add", "table": "job"},
        {"do": "limit", "key": "", "value": "1 g"}, {"do": "add-limit", "value": "acceleration/nobody = 1 g"},
    ],
)  # fmt: skip
def test_what_cannot_be_done_is_refused_in_words(board, folder, action):
    before = texts(folder)
    told = act(board, **action, id="1")
    assert told["refused"] == "1"
    assert told["said"]
    act(board, do="save")
    assert texts(folder) == before


def test_what_cannot_be_simulated_is_shown_and_can_be_undone(board, monkeypatch):
    def fail(case, loaded, timestep=None):
        raise SimulationError("m1 went to where its law does not hold")

    with monkeypatch.context() as patched:
        patched.setattr("wirerope_mj.runs.board.verdicts.judged_case", fail)
        told = act(board, do="move", names=["mount/m1"], by=[10, 0, 0])
    assert "refused" not in told
    assert "No verdict: m1 went" in told["html"]["verdict"]
    assert "No verdict" not in act(board, do="undo")["html"]["verdict"]


@pytest.mark.slow
def test_a_report_is_of_what_stood_as_it_was_asked_for_and_holds_up_nothing(board, folder):
    asked = board.act({"do": "report"})
    next(asked)
    writing = next(asked)[1]
    assert isinstance(writing, Future)
    after = board.act({"do": "tables"})
    next(after)
    assert next(after)[1] is writing  # one at a time
    act(board, do="drag", names=["mount/m1"], by=[50, 0, 0])
    act(board, do="move", names=["mount/m1"], by=[50, 0, 0])
    writing.result()
    assert next(asked)[1]["open"] == "/files/report.html"
    stored = (folder / "runs" / "job" / "cases" / "shock" / "model" / "equipment.xml").read_text()
    assert 'name="equipment/m1" class="mount_site" pos="-0.8 -0.3 0.1"' in stored


def test_a_report_that_cannot_be_written_is_refused_without_the_folder_of_copies(board, folder):
    (folder / "runs").write_text("in the way")
    told = act(board, do="report", id="1")
    assert told["refused"] == "1"
    assert "wirerope-board-" not in told["said"]


def test_sliders_show_what_would_be_and_no_file_has_it(board, folder):
    before = texts(folder)
    nominal = act(board, do="judge")["html"]["verdict"]
    higher = act(board, do="slide", key="level", value="1.5")["html"]["verdict"]
    assert "What if: Base motion level" in higher
    assert higher != nominal
    act(board, do="save")
    assert texts(folder) == before
    assert act(board, do="slide", key="level", value="1")["html"]["verdict"] == nominal
    act(board, do="slide", key="mass", value="1.2")
    assert "set them back" in act(board, do="report")["said"]
    assert "sliders are back" in act(board, do="move", names=["mount/m1"], by=[10, 0, 0])["said"]
    for asked in ("undo", "redo"):
        act(board, do="slide", key="level", value="1.5")
        told = act(board, do=asked)
        assert "sliders are back" in told["said"]
        assert 'value="1.5"' not in told["html"]["left"]


def test_a_file_that_others_change_is_shown_and_one_changed_here_too_is_kept(board, folder):
    assert board.changed_outside() is None
    mounts = folder / "mounts.csv"
    mounts.write_text(mounts.read_text().replace("-800, -300", "-790, -300"))
    told = board.changed_outside()
    assert mount(told, "m1")["position"][0] == -790.0
    assert not told["dirty"]
    assert board.changed_outside() is None
    act(board, do="move", names=["mount/m1"], by=[5, 0, 0])
    mounts.write_text(mounts.read_text().replace("-790, -300", "-780, -300"))
    assert "changed outside, and here, too" in board.changed_outside()["said"]
    assert mount(board.open(), "m1")["position"][0] == -785.0
    mounts.write_text("nonsense")
    act(board, do="save")
    assert "-785, -300" in mounts.read_text()


def test_a_file_that_others_break_is_said_and_what_was_shown_stays(board, folder):
    (folder / "mounts.csv").write_text("name\nm1\n")
    told = board.changed_outside()
    assert (told["tone"], "is wrong" in told["said"]) == ("bad", True)
    assert len([each for each in board.open()["scene"]["items"] if each["kind"] == "mount"]) == 6


def test_what_was_not_saved_is_there_after_a_crash(folder):
    first = Board(opened(folder))
    act(first, do="move", names=["mount/m1"], by=[20, 0, 0])
    assert (folder / JOURNAL).exists()
    second = Board(opened(folder))  # the first one was killed
    assert mount(second.open(), "m1")["position"][0] == -780.0
    assert "not saved last time" in second.open()["said"]
    act(second, do="undo")
    assert mount(second.open(), "m1")["position"][0] == -800.0
    assert not (folder / JOURNAL).exists()
    (folder / JOURNAL).write_text("{broken")
    for made in (first, second, Board(opened(folder))):
        made.close()


def test_a_model_is_shown_with_a_job_of_its_own_and_not_moved(here):
    made = Board(opened(Path("cabinet")))
    assert not made.open()["scene"]["movable"]
    assert "not moved" in act(made, do="move", names=["mount/m1"], by=[1, 0, 0])["said"]
    assert "half-sine 11 g" in act(made, do="case", case="0", key="motions", value="half-sine 11 g 11 ms z")["html"]["left"]
    act(made, do="save")
    made.close()
    assert load_job(here / "cabinet.toml").cases[0].scenario.motion.description == "half-sine 11 g 11 ms along z"


def test_a_scenario_is_shown_behind_sliders_alone():
    made = Board(opened(Path("cabinet_shock")))
    told = made.open()
    assert told["scene"]["items"]
    assert "as it is" in act(made, do="save")["said"]
    assert "slider-level" in told["html"]["left"]
    made.close()


def test_templates_and_folders_that_are_none_are_refused(tmp_path):
    with pytest.raises(ModelError, match="nothing that a board can open"):
        opened(tmp_path)
    with pytest.raises(ModelError, match="exists; give another folder"):
        from_template("genset", tmp_path)


def test_boxes_overlap_as_they_stand(board):
    assert overlapping(board._loaded.system) == []


def test_a_job_on_a_folder_of_tables_is_that_of_the_written_model(folder, tmp_path):
    from wirerope_mj.runs.new_model import new_model, tables_in

    job = load_job(folder / "job.toml")
    new_model(tmp_path / "equipment", tables_in(folder))
    written = wr.load_system(tmp_path / "equipment" / "equipment.xml")
    assert job.system.mjcf == written.mjcf
    assert job.system.isolators == written.isolators
    shutil.copy(folder / "job.toml", tmp_path / "deck.toml")
    text = (tmp_path / "deck.toml").read_text().replace('model = "."', 'model = "genset"\ndeck = "10 Hz 800 kg 4 %"')
    (tmp_path / "deck.toml").write_text(text)
    assert "deck" in load_job(tmp_path / "deck.toml").system.mjcf
    (tmp_path / "deck.toml").write_text(text.replace("10 Hz 800 kg", "10 Hz"))
    with pytest.raises(ModelError, match="`deck`"):
        load_job(tmp_path / "deck.toml")


@pytest.mark.slow  # runs a scenario with its pages, and a board of it
def test_a_run_of_a_variant_is_shown_as_it_was_and_varied_again(tmp_path):
    scenario = load_scenario("cabinet_shock").make()
    heavier = wr.varied(wr.load_system(scenario.model_source()), masses={"rack": 1.2})
    short = {**scenario.simulate, "duration": 0.1}
    wr.run_scenario(replace(scenario, changes=heavier.changes, simulate=short, folder=None, model=heavier.mjcf,
                            isolators=heavier.isolators), tmp_path / "run")  # fmt: skip
    made = Board(opened(tmp_path / "run"))
    stored = json.loads((tmp_path / "run" / "summary.json").read_text())["content"]["headline"]["text"]
    assert stored.replace(" %", "\u00a0%") in act(made, do="judge")["html"]["verdict"]
    act(made, do="slide", key="mass", value="1.1")
    again = act(made, do="report")
    assert again["open"] == "/files/report.html"
    repeated = Board(opened(made.file("report.html").parent))  # what was written has both changes, once each
    first = wr.load_system("cabinet").model.body("rack").mass[0]
    assert repeated._loaded.system.model.body("rack").mass[0] == pytest.approx(1.32 * first, rel=1e-12)
    repeated.close()
    made.close()
