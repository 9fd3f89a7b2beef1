"""Slips of a working day: each is refused before anything is computed or written, with one message that says what to change."""

import re
from pathlib import Path

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.assessment.comfort import exposure
from wirerope_mj.cli import main
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.motions import motion_from_dict

pytestmark = pytest.mark.quick

JOB = """
model = "shock_table"

[[case]]
name = "first"
half-sine = "5 g 11 ms -z"

[[case]]
name = "second"
half-sine = "5 g 11 ms -z"
"""


def said(capsys, *arguments):
    """Return what a refused command says."""
    assert main([str(argument) for argument in arguments]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    return " ".join(shown.err.split())


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('hammer = "engine 3 kN.s 1 ms z"', "no site 'force/engine'"),
        ("sample_rate = -1000.0", "`sample_rate` must be > 0"),
        ("accuracy = 0.0", "`accuracy` must be > 0"),
    ],
)
def test_a_fault_of_the_last_case_is_found_before_the_first_is_simulated(here, capsys, line, message):
    Path("job.toml").write_text(f"{JOB}{line}\n", encoding="utf-8")
    text = said(capsys, "cases", "job.toml", "--out", "out")
    assert re.search(r"job\.toml, line \d+: \[\[case\]\] 2 'second'", text)
    assert message in text
    assert not Path("out").exists()


@pytest.mark.parametrize(
    ("option", "phrase", "message"),
    [
        (
            "--amplitude-table",
            "bands.csv 10 s z",
            "the band from 14 to 25 Hz begins within the one before, which ends at 15 Hz",
        ),
        ("--psd", "row.csv 10 s z seed 1", "must have at least 2 points, got 1"),
        ("--hammer", "3 kN.s 1 ms z", "the name of a site for forces must stand first, got '3'"),
        ("--struck-plate", "14 MPa 0.9 ms z", "an areal mass must stand there"),
    ],
)
def test_a_motion_that_is_half_said(here, capsys, option, phrase, message):
    Path("bands.csv").write_text("from [Hz], to [Hz], displacement [mm]\n4, 15, 0.8\n14, 25, 0.5\n", encoding="utf-8")
    Path("row.csv").write_text("frequency [Hz], psd [g^2/Hz]\n5, 0.01\n", encoding="utf-8")
    text = said(capsys, "shock", "shock_table", option, phrase)
    assert message in text
    assert "Hz after" not in text


def test_a_part_that_is_none_and_a_folder_that_stands_are_refused_before_parts_are_tried(here, capsys):
    asked = ("select", "--mass", "400", "--mounts", "4", "--shock", "half-sine 15 g 11 ms z")
    assert "Near it: CB1400-15" in said(capsys, *asked, "--take", "CB1400-155")
    Path("out").mkdir()
    Path("out", "thesis.txt").write_text("mine", encoding="utf-8")
    assert "out" in said(capsys, *asked, "--out", "out")


def test_a_point_in_millimetres_that_were_taken_for_metres_is_named(here, capsys):
    Path("mounts.csv").write_text(
        "name,x [m],y [m],z [m],isolator\n"
        + "".join(f"m{i}{j},{0.3 * i},{0.25 * j},0.05,WR16-400\n" for i in (-1, 1) for j in (-1, 1)),
        encoding="utf-8",
    )
    Path("masses.csv").write_text(
        "name,mass [kg],x [m],y [m],z [m],size_x [m],size_y [m],size_z [m]\nrack,400,0,0,0.5,0.6,0.5,0.8\n"
    )
    Path("points.csv").write_text("name,x [m],y [m],z [m]\ntop,0,0,1908\n", encoding="utf-8")
    text = said(capsys, "new", "rack", "--mounts", "mounts.csv", "--masses", "masses.csv", "--points", "points.csv")
    assert 'points.csv, line 2: "top" stands outside, 1908 m' in text
    assert not Path("rack").exists()


def test_less_than_a_second_has_no_running_rms_and_roundoff_no_crest():
    time = np.arange(0.0, 0.5, 1e-3)
    shaken = np.zeros((time.size, 3))
    shaken[:, 2] = np.sin(2 * np.pi * 8.0 * time)
    shaken[:, 0] = 1e-17 * shaken[:, 2]
    felt = exposure(time, shaken)
    assert np.isnan(felt.running).all()
    assert np.isnan(felt.crest[:2]).all()
    assert felt.crest[2] > 1.0


@pytest.mark.parametrize(
    ("folder", "message"),
    [("nowhere", "there is no such folder"), ("job", "the runs of this job are cases/down"), (".", "a run folder holds one.")],
)
def test_a_folder_that_is_no_run_says_what_it_is(here, capsys, folder, message):
    Path("job/cases/down").mkdir(parents=True)
    Path("job/cases/down/response.parquet").write_bytes(b"")
    assert message in said(capsys, "comfort", folder, "top")


def test_a_blow_is_stored_and_read_back():
    blow = wr.Blow(site="anvil", impulse=3300.0, duration=1e-3, direction=(0.0, 0.0, -1.0), start=0.1)
    assert motion_from_dict(blow.to_dict()) == blow
    with pytest.raises(ModelError, match="impuls"):
        motion_from_dict({**blow.to_dict(), "impuls": 1.0})
