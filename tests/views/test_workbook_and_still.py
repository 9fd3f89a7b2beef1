"""A run and a study as workbooks, columns by pattern, and the scene at an instant as a picture."""

import json
import struct

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.foundation.exports import picked
from wirerope_mj.foundation.units import STANDARD_GRAVITY


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run") / "shock"
    pulse = wr.HalfSine(peak=50.0, duration=0.011, direction="z", start=0.02)
    scenario = wr.Scenario("?", "shock_table", pulse, {"duration": 0.3, "accuracy": 1e-3})
    wr.run_scenario(scenario, folder)
    return folder


def sheets(path):
    openpyxl = pytest.importorskip("openpyxl")
    return {sheet.title: list(sheet.iter_rows(values_only=True)) for sheet in openpyxl.load_workbook(path)}


def test_a_workbook_holds_the_tables_of_the_report_in_shown_units_and_the_chosen_samples(run, tmp_path, capsys):
    out = tmp_path / "run.xlsx"
    assert main(["export", str(run), str(out), "--channels", "bodies/block/acceleration/z"]) == 0
    book, response = sheets(out), wr.load_response(run)
    headline = json.loads((run / "summary.json").read_text(encoding="utf-8"))["content"]["headline"]["text"]
    assert book["summary"][1][0] == headline
    _, heading, *rows = book["peak-accelerations"]
    peak = response.peaks.bodies["block"].acceleration.value
    assert next(row for row in rows if row[0] == "block")[heading.index("peak [g]")] == pytest.approx(
        peak / STANDARD_GRAVITY, rel=1e-12
    )
    heading, *rows = book["samples"]
    assert heading == ("time [s]", "bodies/block/acceleration/z [m/s^2]")
    # a workbook keeps sixteen digits
    np.testing.assert_allclose(
        np.array(rows, dtype=float)[:, 1], response.bodies["block"].acceleration[:, 2], rtol=1e-15, atol=0.0
    )
    assert main(["export", str(run), str(out)]) == 2
    assert "the file exists" in capsys.readouterr().err


def test_columns_are_chosen_by_patterns_and_time_stays(run, tmp_path, capsys):
    table = wr.load_response(run).exported
    some = picked(table, ["mounts/*/force/*"])
    assert some.names[0] == "time"
    assert len(some.names) == 1 + 3 * len(wr.load_response(run).mounts)
    index = table.names.index(some.names[2])
    np.testing.assert_array_equal(some.column(2), table.column(index))
    np.testing.assert_array_equal(np.concatenate([block[2] for block in some.blocks()]), table.column(index))
    assert main(["export", str(run), str(tmp_path / "some.csv"), "--channels", "mount/*"]) == 2
    assert "no column matches 'mount/*'; there are mounts/" in capsys.readouterr().err


def test_a_still_shows_the_scene_at_any_instant(run, tmp_path, capsys):
    pictures = {}
    for at in ("25 ms", "40 ms"):
        out = tmp_path / f"{at}.png"
        assert main(["export", str(run), str(out), "--at", at]) == 0
        content = out.read_bytes()
        assert struct.unpack(">II", content[16:24])[0] == 1216
        pictures[at] = content
    assert pictures["25 ms"] != pictures["40 ms"]
    capsys.readouterr()
    for at in ("9 s", "5 mm"):
        assert main(["export", str(run), str(tmp_path / "none.png"), "--at", at]) == 2
        assert "`at` must be a time within the run, 0 to 0.3 s" in capsys.readouterr().err
    assert not (tmp_path / "none.png").exists()
