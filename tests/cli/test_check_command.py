"""`wirerope check`: several faults in several files at once, exit codes for scripts, the same as JSON and from Python."""

import json
import shutil

import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.foundation.resources import models_folder

GENSET = models_folder() / "templates" / "genset"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def said(capsys, *arguments):
    """Return the exit code and the lines that the command prints."""
    code = main(["check", *map(str, arguments)])
    shown = capsys.readouterr()
    assert shown.err == ""
    return code, shown.out.splitlines()


def test_faults_of_all_files_are_said_at_once_by_file_and_line(here, capsys):
    (here / "soft.toml").write_text('name = "Soft"\n[axial]\nlaw = "kelvin-voigt"\nk = -1e5\nc = 0.0\n')
    (here / "levels.toml").write_text('[[motion]]\nhalf-sine = "15 g 11 mm z"\n')
    (here / "deck.csv").write_text("time [s], z [g]\n0, 0\n0.001, what\n")
    (here / "notes.csv").write_text("colour, taste\nred, sweet\n")
    code, lines = said(capsys, *sorted(path.name for path in here.iterdir()), "absent.xml", "--json", "found.json")
    assert code == 2
    assert [line.split(":")[:2] for line in lines[:-1]] == [
        ["refused", " deck.csv, line 3"], ["refused", " levels.toml, line 1"], ["refused", " notes.csv"],
        ["refused", " soft.toml, line 4"], ["refused", " absent.xml"],
    ]  # fmt: skip
    assert "cyclic test (table of deflection [mm] and force [N])" in lines[2]  # what kinds there are, and how one is told
    assert lines[-1] == "5 refused, 0 implausible; checked: record 1, levels 1, unknown 1, isolator 1, unreadable 1"
    found = json.loads((here / "found.json").read_text())
    assert (found["refused"], found["implausible"]) == (5, 0)
    assert found["findings"][3]["where"] == "line 4"
    assert [str(finding) for finding in wr.check("deck.csv")] == [lines[0].removeprefix("refused: ")]


def test_what_is_only_implausible_exits_1_and_a_clean_file_0(here, capsys):
    text = (models_folder() / "shock_table.xml").read_text().replace('gravity="0 0 -9.80665"', 'gravity="0 0 9.80665"')
    (here / "sky.xml").write_text(text)
    code, lines = said(capsys, "sky.xml")
    assert code == 1
    assert lines[0].startswith("implausible: sky.xml: ")
    assert "gravity points upwards" in lines[0]
    assert said(capsys, "shock_table") == (0, ["0 refused, 0 implausible; checked: model 1"])


def test_every_fault_of_a_job_is_said_and_of_the_files_that_it_names(here, capsys):
    (here / "levels.toml").write_text('[[motion]]\nhalf-sine = "15 g 11 mm z"\n[[motion]]\nhalf-sine = "15 g"\n')
    (here / "deck.csv").write_text("time [s], z [g]\n0, 0\n0.001, what\n")
    (here / "job.toml").write_text(
        'model = "absent.xml"\n[limits]\n"acceleration/rack" = "15 h"\n[[case]]\nname = "right"\nhalf-sine = "9 g 11 ms z"\n'
        '[[case]]\nname = "files"\nlevels = "levels.toml"\nrecord = "deck.csv"\n[[case]]\nname = "said"\nhalf-sine = "9 z"\n'
    )
    code, lines = said(capsys, "job.toml")
    assert code == 2
    expected = ("15 h", "absent.xml", "[[case]] 2 'files': levels.toml, line 1", "levels.toml, line 3", "deck.csv, line 3",
                "[[case]] 3 'said'")  # fmt: skip
    assert len(lines) == len(expected) + 1
    for line, text in zip(lines, expected, strict=False):
        assert line.startswith("refused: job.toml")
        assert text in line
    assert main(["cases", "job.toml"]) == 2
    assert capsys.readouterr().err.count("\n") == len(expected)  # the command itself says all of it, too


def test_every_wrong_row_and_every_wrong_key_is_said(here, capsys):
    text = (GENSET / "masses.csv").read_text().replace(", 600,", ", -600,", 1).replace(", 220,", ", some,", 1)
    (here / "masses.csv").write_text(text)
    (here / "job.toml").write_text('model = "cabinet"\n[simulate]\ndurration = 1.0\naccuracy = "fine"\n')
    code, lines = said(capsys, "masses.csv", "job.toml")
    assert code == 2
    assert [line.partition(":")[2].split(":")[0] for line in lines[:-1]] == [
        " masses.csv, line 3", " masses.csv, line 5", " job.toml, line 3", " job.toml, line 4",
    ]  # fmt: skip


def test_folder_of_tables_is_checked_as_a_model_beside_the_files_in_it(here, capsys):
    shutil.copytree(GENSET, here / "genset")
    assert said(capsys, "genset") == (0, ["0 refused, 0 implausible; checked: folder of tables 1"])
    masses = here / "genset" / "masses.csv"
    masses.write_text(masses.read_text().replace(", 600,", ", -600,", 1))
    (here / "genset" / "job.toml").write_text('model = "."\n[[case]]\nname = "a"\nhalf-sine = "9 z"\n')
    code, lines = said(capsys, "genset")
    assert code == 2
    assert all(line.startswith("refused: genset/") for line in lines[:-1])
    assert "must be > 0" in lines[0]


def test_mounts_in_each_other_and_far_from_the_equipment_are_said(here, capsys):
    shutil.copytree(GENSET, here / "genset")
    mounts = here / "genset" / "mounts.csv"
    mounts.write_text(mounts.read_text().replace("m2,    0,", "m2, -750,").replace("m3,  800, -300", "m3, 1700, -300"))
    code, lines = said(capsys, "genset")
    assert code == 1
    assert any("mounts m1 and m2 stand in each other" in line for line in lines)
    assert any("m3 stands 6" in line and "mm from the equipment" in line for line in lines)
    (here / "job.toml").write_text('model = "genset"\n[[case]]\nname = "a"\nhalf-sine = "9 g 11 ms z"\n')
    assert said(capsys, "job.toml")[1][:-1] == [line.replace("genset:", "job.toml:", 1) for line in lines[:-1]]
