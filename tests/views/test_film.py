"""The film of a run: its instants, what its frames say, and what is refused."""

import re
import struct
import sys
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.assessment.criteria.verdict import against_limit
from wirerope_mj.cli import main
from wirerope_mj.content.film import LENGTH, PAUSE, RATE, film_of
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.runs.scenario_file import judged_folder
from wirerope_mj.views import film as film_file
from wirerope_mj.views.film import SIZE, Frames
from wirerope_mj.views.plots.letters import text_of


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a run whose mount travels too far some 0.5 s after its beginning."""
    folder = tmp_path_factory.mktemp("runs") / "a<b>&run"
    pulse = wr.HalfSine(peak=600.0, duration=0.011, direction="z", start=0.5)
    wr.run_scenario(wr.Scenario("?", "shock_table", pulse, {"duration": 1.2, "accuracy": 1e-3}), folder)
    return folder


@pytest.fixture(scope="module")
def run(folder):
    return judged_folder(folder)


def svg(content):
    """Return drawings as one element: text in them that is markup raises ParseError."""
    return ElementTree.fromstring(f'<svg xmlns="http://www.w3.org/2000/svg">{content}</svg>')


def test_the_film_is_of_400_ms_about_the_worst_instant_and_pauses_there(run):
    film = film_of({"run": run})
    critical = film.runs[0].critical
    assert critical.verdict == "exceeded"
    assert film.instants[film.worst] == critical.time
    np.testing.assert_allclose(np.diff(film.instants), 1.0 / (RATE * 20.0), rtol=1e-9)  # 20 times slower
    assert LENGTH - 1.0 / (RATE * 20.0) < np.ptp(film.instants) <= LENGTH + 1e-9
    assert "20 times slower" in film.caption
    assert film.runs[0].motion.factor == 1.0
    assert "displacements in true scale" in film.caption
    middle = film_of({"run": run}, at=0.7)
    assert (middle.instants[0], middle.instants[middle.worst]) == pytest.approx((0.5, 0.7))


def test_a_frame_holds_the_verdict_and_from_its_instant_on_what_was_exceeded(run):
    film = film_of({"run": run})
    frames, critical = Frames(film), film.runs[0].critical
    assert film.runs[0].verdict.text in " ".join(text_of(frames.still).split())
    said = [text_of("".join(part for _, part in frames.moving(film.worst + step))) for step in (-1, 0, 1)]
    assert [against_limit(critical) in text for text in said] == [False, True, True]
    # the cursor stands at the instant in both panels, and its value is that of the curve
    for (box, part), (panel, (left, _, width, _), ranges) in zip(
        [entry for entry in frames.moving(film.worst) if entry[1].startswith("<path")], frames._stages[0]._panels, strict=True
    ):
        x = float(re.match(r'<path .*? d="M([\d.]+) ', part)[1])
        instant = ranges[0] + (x - left) / width * (ranges[1] - ranges[0])
        assert instant == pytest.approx(film.instants[film.worst], abs=LENGTH / width)  # a pixel
        assert box[0] < x < box[0] + box[2]
        assert len(svg(part)) == 1 + len(panel.curves)


def test_the_scene_moves_as_the_response_does_times_the_factor(run):
    filmed, response = film_of({"run": run}).runs[0], run.response
    number = int(np.searchsorted(response.time, filmed.critical.time))
    block = next(body for body in response.scene.bodies if body.name == "block")
    moved = next(body for body in filmed.motion.at(response.time[number]).bodies if body.name == "block")
    travel = response.displacement_from_base(response.bodies["block"].position, block.position)[number]
    np.testing.assert_allclose(moved.position - block.position, filmed.motion.factor * travel, rtol=1e-12, atol=1e-15)


def test_two_runs_stand_beside_each_other_in_one_scale_and_names_stay_text(run, folder):
    film = film_of({folder.name: run, "other": replace(run, verdicts=run.verdicts)})
    frames = Frames(film)
    assert folder.name in text_of(frames.still)
    svg(frames.still)
    parts = frames.moving(0)
    for _, part in parts:
        svg(part)
    half = SIZE[0] / 2
    assert sum(box[0] < half for box, _ in parts) == sum(box[0] >= half for box, _ in parts)
    assert film.runs[0].panels[0].ylim == film.runs[1].panels[0].ylim


def test_what_has_no_worst_instant_or_does_not_move_is_refused_with_the_remedy(run, folder, tmp_path, capsys, monkeypatch):
    with pytest.raises(RecordError, match='no worst instant. State a limit .* or say an instant, --at "120 ms"'):
        film_of({"run": replace(run, verdicts=())})
    assert film_of({"run": replace(run, verdicts=())}, at=0.6).runs[0].critical is None
    with pytest.raises(RecordError, match="the load is still"):
        film_of({"run": run}, at=0.2)
    there = tmp_path / "there.mp4"
    there.write_bytes(b"there")
    (tmp_path / "o.gif").write_bytes(b"there")
    for words, message in (
        ([folder, there], "the file exists"),
        ([folder, tmp_path / "o.mp4", "--gif"], "the file exists"),
        ([folder, tmp_path / "o.avi"], "a film is made of one run or two, and its file ends with .mp4"),
        ([folder, folder, folder, tmp_path / "n.mp4"], "a film is made of one run or two"),
        ([tmp_path, tmp_path / "n.mp4"], "scenario.toml"),
        ([folder, tmp_path / "n.mp4", "--at", "9 s"], "`at` must be a time within the run, 0 to 1.2 s"),
    ):
        assert main(["film", *map(str, words)]) == 2
        assert message in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    assert main(["film", str(folder), str(tmp_path / "n.mp4")]) == 2
    assert "pip install 'wirerope-mj[film]'" in capsys.readouterr().err
    assert there.read_bytes() == b"there"
    assert not list(tmp_path.glob("*n.mp4"))


def test_an_interrupted_film_leaves_no_file(folder, tmp_path, monkeypatch, capsys):
    pytest.importorskip("imageio_ffmpeg")

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(Frames, "write", interrupted)
    assert main(["film", str(folder), str(tmp_path / "o.mp4"), "--gif"]) == 130
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_the_file_has_its_size_rate_and_frames(folder, run, tmp_path, monkeypatch):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    out = tmp_path / "a:film %d.mp4"
    assert main(["film", str(folder), str(out), "--gif"]) == 0
    frames = film_of({"run": run}).instants.size + PAUSE
    meta = next(reader := imageio_ffmpeg.read_frames(str(out)))
    reader.close()
    assert (meta["size"], meta["fps"]) == (SIZE, RATE)
    assert imageio_ffmpeg.count_frames_and_secs(str(out)) == (frames, pytest.approx(frames / RATE))
    content = out.with_suffix(".gif").read_bytes()
    assert struct.unpack("<HH", content[6:10]) == (SIZE[0] // 2, SIZE[1] // 2)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a:film %d.gif", "a:film %d.mp4"]
    monkeypatch.setattr(film_file, "_GIF", "no such filter")
    assert main(["film", str(folder), str(out), "--gif", "--force"]) == 2
    assert out.with_suffix(".gif").read_bytes() == content
