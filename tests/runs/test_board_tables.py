"""Tables and jobs edited as texts: what is not touched stays as it was written."""

from pathlib import Path

import pytest

from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.runs.board.job_text import edited_job, motions_of, parsed
from wirerope_mj.runs.board.table_text import TableText

MOUNTS = """# mounts of a test
name, x [mm],  y [mm], z [in], isolator   # no comment here

m1, -100,   50, 1.0, "WR2-800"
# the second
m2,  100,   50, 1.0, WR2-800
"""
GERMAN = "name;x;y;z;isolator\n;mm;mm;mm;\nm1;1,5;2;3;WR2-800\nm2; 4 ;5;6;WR2-800"
JOB = """# job
model = "."  # tables beside it

[limits]
"acceleration/equipment" = "15 g"  # of the data sheet

[[case]]
name = "a"  # first
half-sine = "15 g 11 ms z"  # by the specification

[[case]]
name = "b"
half-sine = ["1 g 11 ms z", "2 g 11 ms x"]
sawtooth = "3 g 6 ms y"
"""


@pytest.fixture
def table(tmp_path):
    def read(text, kind="mounts"):
        path = tmp_path / f"{kind}.csv"
        path.write_bytes(text.encode())
        return TableText.read(kind, path)

    return read


def test_a_cell_is_written_in_its_unit_and_nothing_else_changes(table):
    mounts = table(MOUNTS.replace("   # no comment here", ""))
    moved = mounts.with_cells("m2", {"x": 0.1235, "z": 0.0508})
    assert moved.text == mounts.text.replace("m2,  100,   50, 1.0", "m2,  123.5,   50, 2")


def test_decimal_commas_and_units_in_a_row_of_their_own_are_kept(table):
    mounts = table(GERMAN)
    text = mounts.with_cells("m2", {"x": -0.0125, "inclination": "30"}).text
    assert text == "name;x;y;z;isolator;inclination\n;mm;mm;mm;;deg\nm1;1,5;2;3;WR2-800;\nm2; -12,5 ;5;6;WR2-800;30"
    assert table(text).rows["m2"]["inclination"] == "30"


def test_rows_are_copied_renamed_and_taken_away(table):
    mounts = table(GERMAN)
    copied = mounts.with_row("m3", like="m2").with_cells("m3", {"x": "7"})
    assert copied.text == GERMAN + "\nm3; 7 ;5;6;WR2-800"
    assert copied.with_cells("m3", {"name": "left"}).rows["left"]["y"] == "5"
    assert copied.without_row("m1").without_row("m3").text == "name;x;y;z;isolator\n;mm;mm;mm;\nm2; 4 ;5;6;WR2-800\n"


@pytest.mark.parametrize("sign", [",", ";", "\t"])
def test_a_name_that_holds_the_separator_stands_in_quotation_marks(table, sign):
    text = "name, x [mm], y [mm], z [mm], isolator\nm1, 1, 2, 3, a\n".replace(", ", sign)
    written = table(text).with_cells("m1", {"isolator": f"left{sign}right"})
    assert table(written.text).rows["m1"]["isolator"] == f"left{sign}right"
    with pytest.raises(RecordError, match="cannot stand in a cell"):
        table(text).with_cells("m1", {"isolator": 'a "b"'})


def test_line_ends_of_windows_stay(table):
    text = "name, x [mm], y [mm], z [mm], isolator\r\nm1, 1, 2, 3, a\r\n"
    assert table(text).with_cells("m1", {"x": "5", "bars_x": "1"}).text == (
        "name, x [mm], y [mm], z [mm], isolator, bars_x\r\nm1, 5, 2, 3, a, 1\r\n".replace("a, 1", "a,1")
    )


def edited(text, asked, **action):
    return edited_job(text, asked, action)[0]


def test_a_motion_is_said_in_one_line_and_comments_stay():
    assert motions_of(parsed(JOB)["case"][1]) == "half-sine 1 g 11 ms z; half-sine 2 g 11 ms x; sawtooth 3 g 6 ms y"
    text = edited(JOB, "case", case="0", key="motions", value="half-sine 20 g 11 ms z")
    assert text == JOB.replace('"15 g 11 ms z"', '"20 g 11 ms z"')
    changed = edited(text, "case", case="1", key="motions", value="sawtooth 4 g 6 ms y; velocity-step 2 m/s z")
    assert parsed(changed)["case"][1].unwrap() == {"name": "b", "sawtooth": "4 g 6 ms y", "velocity-step": "2 m/s z"}
    with pytest.raises(ModelError, match='"half-sin" is no motion'):
        edited(JOB, "case", case="0", key="motions", value="half-sin 20 g 11 ms z")


def test_values_are_written_and_taken_away_key_by_key():
    text = edited(JOB, "limit", key="load/m3", value="5 kN")
    assert edited(text, "limit", key="load/m3", value="") == JOB
    assert parsed(edited(JOB, "job", key="document.project", value="F130"))["document"]["project"] == "F130"
    assert edited(JOB, "job", key="deck", value="") == JOB


def test_a_case_is_added_below_the_others_with_an_empty_line_between():
    text = edited(f"{JOB}\n[simulate]\nduration = 0.3\n", "add-case")
    case = '[[case]]\nname = "case 1"\nhalf-sine = "15 g 11 ms z"\n'
    assert text == f"{JOB}\n{case}\n[simulate]\nduration = 0.3\n"
    assert edited(JOB, "add-case") == f"{JOB}\n{case}"
    cases = parsed(edited(text, "remove-case", case="0"))["case"].unwrap()
    assert [case["name"] for case in cases] == ["b", "case 1"]


def test_a_job_that_is_no_toml_is_refused():
    with pytest.raises(ModelError, match="no TOML"):
        edited("model = ", "job", key="deck", value="10 Hz")


def test_every_shipped_template_is_read_and_written_alike():
    for path in sorted(Path("models/templates/genset").glob("*.csv")):
        table = TableText.read(path.stem, path)
        row = next(iter(table.rows))
        assert table.with_cells(row, {"name": row}).text == path.read_text(encoding="utf-8")
