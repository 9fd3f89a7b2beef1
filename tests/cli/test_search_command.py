"""`wirerope study` of a search: the front is printed and drawn, its designs become runs, and a page says it all."""

from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest
from small_search import SEARCH_FILE, beam_search

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.content.search import front_chart, search_content
from wirerope_mj.runs.study import write_study_report
from wirerope_mj.studies.search.result import SearchResult


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """Return the folder that the command has written."""
    place = tmp_path_factory.mktemp("searches")
    (place / "places.py").write_text(SEARCH_FILE, encoding="utf-8")
    command = ["study", str(place / "places.py"), "--workers", "1", "--open-worst", "2", "--out", str(place / "out")]
    assert main(command) == 0
    return place / "out"


@pytest.mark.slow
def test_a_search_becomes_one_folder_with_table_pictures_and_runs_of_its_best(done):
    files = {path.name for path in done.iterdir() if path.is_file()}
    assert files >= {"variants.parquet", "study.toml", "summary.json", "front.png", "placements.png"}
    result = wr.load_study(done)
    runs = {path.name for path in (done / "worst").iterdir() if path.is_dir()}
    assert runs == {f"variant-{number:06d}" for number in result.chosen[:2]}
    run = wr.load_response(done / "worst" / f"variant-{result.knee:06d}")
    row = result.table.slice(result.knee, 1).to_pylist()[0]
    # The run takes the study's steps, as its message says: the same bits.
    assert run.peaks.bodies["beam"].acceleration.value == row["acceleration"]


@pytest.mark.slow
def test_resuming_prints_the_front_again(done, capsys):
    file = done.parent / "places.py"
    assert main(["study", str(file), "--resume", "--out", str(done), "--all"]) == 0
    out = capsys.readouterr().out
    result = wr.load_study(done)
    assert " ".join(out.split()).count(result.message) == 1
    assert "knee" in out
    assert "given" in out
    for row in result.front.to_pylist():
        assert f"{100.0 * row['travel']:.3g}" in out


def test_a_search_without_a_design_within_its_limits_says_which_is_nearest(done, capsys):
    command = ["study", str(done.parent / "places.py"), "--travel", "0.001", "--workers", "1", "--generations", "1"]
    assert main([*command, "--out", str(done.parent / "none")]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "none within the limits. The nearest is design" in out
    assert "above its limit of 100 %" in out
    assert not (done.parent / "none" / "placements.png").exists()
    assert "e+" not in out
    result = wr.load_study(done.parent / "none")
    shares = np.where(np.asarray(result.table["status"]) == "done", np.asarray(result.table["travel"]), np.inf)
    assert result.chosen[:3] == np.argsort(shares, kind="stable")[:3].tolist()  # nearest to the one limit there is
    chart = front_chart(result)
    panel = chart.rows[0][0]
    named = {curve.name for curve in panel.curves} | {name for name, _ in panel.xlimits}
    assert named == {"beyond a limit", "given", "limit"}  # nothing that is not there
    assert "front" not in chart.caption
    assert [block.id for block in search_content(result).sections[2].blocks] == ["front"]
    assert panel.xlim[1] > 100.0 * np.sort(shares)[4]  # the nearest ones are shown


def test_designs_are_not_ordered_by_another_measure(done, capsys):
    assert main(["study", str(done.parent / "places.py"), "--resume", "--out", str(done), "--by", "mounts"]) == 2
    assert "`--by` is for studies" in capsys.readouterr().err
    assert main(["study-report", str(done), "--by", "mounts"]) == 2
    assert "`by` is for studies" in capsys.readouterr().err


def test_the_report_holds_front_and_designs(done):
    page = write_study_report(done)[0].read_text(encoding="utf-8")
    result = wr.load_study(done)
    assert "The front: designs within the limits that no other one beats" in page
    assert "positions without a mount" in page
    assert result.inputs["search"]["optimiser"] in page
    assert page.count('class="chart"') == 1
    assert page.count('class="scene in2"') >= 2
    assert "5.00" not in page  # mounts are whole


def test_axes_and_labels_say_what_they_are(done):
    result = wr.load_study(done)
    (panel,), (whole,) = front_chart(result).rows
    assert panel.xlabel == whole.xlabel == "largest utilisation of a rated travel along one axis [%]"
    assert panel.ylabel == "acceleration [g]"
    assert any(f"design {result.knee}" in text for *_, text, _ in panel.notes)
    assert any(curve.name == "knee of the front" for curve in panel.curves)


def test_every_design_that_was_computed_is_drawn(done):
    """The chart ended around the front: "not shown: 404 designs farther out"."""
    result = wr.load_study(done)
    whole = front_chart(result).rows[-1][0]
    marks = {(x, y) for curve in whole.curves if curve.marks for x, y in zip(curve.x, curve.y, strict=True)}
    assert len(result.failed) > 0
    computed, failed = result.table.num_rows - len(result.failed), len(result.failed)
    assert whole.title == f"all {computed} designs; {failed} failed designs are not drawn"
    for row in result.table.to_pylist():
        if row["status"] == "done":
            x, y = 100.0 * row["travel"], row["acceleration"] / wr.STANDARD_GRAVITY
            assert any(np.allclose((x, y), mark, rtol=1e-9) for mark in marks)  # units of the table, rounded once
            assert whole.xlim[0] < x < whole.xlim[1]
            assert whole.ylim[0] < y < whole.ylim[1]


@pytest.mark.parametrize(("middle", "knee"), [(0.4, 1), (0.5, None), (0.6, None)])
def test_a_front_without_a_design_below_the_line_between_its_ends_has_no_knee(middle, knee):
    front = pa.table({"variant": [0, 1, 2], "a": [0.0, middle, 1.0], "b": [1.0, middle, 0.0]})
    assert SearchResult.knee.func(SimpleNamespace(minimise=("a", "b"), front=front)) == knee


def test_a_search_for_one_measure_is_drawn_design_by_design(tmp_path):
    result = beam_search(minimise="acceleration", generations=2).run(tmp_path / "out", workers=1)
    assert result.front.num_rows == 1
    assert result.knee is None
    assert front_chart(result).rows[0][0].xlabel == "design"
