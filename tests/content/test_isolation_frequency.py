"""Transmissibility, isolation frequency and bands of random vibration, how far the payload moves, dwells that were found."""

import json
import math

import numpy as np
import openpyxl
import pytest
import scipy.signal
from house import sdof

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.content.random_vibration import random_blocks, transmissibility_of
from wirerope_mj.content.response_curve import response_content
from wirerope_mj.content.run import payload_moves
from wirerope_mj.dynamics.frequency_response import ResponseOptions, frequency_response
from wirerope_mj.dynamics.frequency_response.summary import level_summaries
from wirerope_mj.motions.spectra.psd import isolation_frequency
from wirerope_mj.runs.analyses import write_frequency_response

MASS, NATURAL = 3.5, 10.0
STIFFNESS = MASS * (2.0 * math.pi * NATURAL) ** 2


@pytest.fixture(scope="module", params=[0.05, 0.2])
def run(request):
    """A linear mount of 10 Hz, 5 and 20 % damping, on a base that vibrates from 3 to 200 Hz."""
    system = sdof(wr.KelvinVoigt(k=STIFFNESS, c=2.0 * request.param * math.sqrt(MASS * STIFFNESS)), mass=MASS)
    motion = wr.RandomVibration(psd=[(3.0, 1.0), (200.0, 1.0)], duration=20.0, seed=1, direction="z")
    return judged_run(system, motion, wr.simulate(system, motion, duration=20.0, timestep=1e-3)), request.param


def blocks(run):
    return {block.id: block for block in random_blocks(run)}


def test_a_linear_mount_isolates_from_root_two_times_its_natural_frequency_on(run):
    """Absolute transmissibility of any damping is 1 at sqrt(2) f_n."""
    (row,) = blocks(run[0])["transmissibility"].rows
    assert row[:2] == ("mass", "z")
    assert row[-1] == pytest.approx(math.sqrt(2.0) * NATURAL, rel=0.01)


def test_transmissibility_is_that_of_the_closed_form(run):
    judged, damping = run
    along = judged.spectra.densities["z"]
    frequency, ratio = transmissibility_of(along["base"], along["mass"], (3.0, 200.0))
    r = frequency / NATURAL
    expected = np.sqrt((1.0 + (2.0 * damping * r) ** 2) / ((1.0 - r**2) ** 2 + (2.0 * damping * r) ** 2))
    away = (r > 0.5) & (r < 3.0) & (np.abs(r - 1.0) > 0.3)  # at the peak and in the depths the window's width counts
    np.testing.assert_allclose(ratio[away], expected[away], rtol=0.06)


def test_octave_bands_are_the_rms_behind_band_pass_filters(run):
    judged, _ = run
    response = judged.response
    frequency = 1.0 / float(response.time[1])
    rows = (response.time > 4.0) & (response.time < 18.0)  # stationary: rise and fall last two seconds
    table = blocks(judged)["octave-bands"]
    assert [column.heading for column in table.columns] == ["axis", "octave", "base", "mass", "out / in"]
    for axis, middle, base, mass, ratio in table.rows:
        if not 20.0 < middle < 100.0:  # below, the window's width moves a part of the resonance across the band's edge
            continue
        band = [middle / math.sqrt(2.0), middle * math.sqrt(2.0)]
        sos = scipy.signal.butter(12, band, "bandpass", fs=frequency, output="sos")
        for value, history in ((base, response.base.acceleration), (mass, response.bodies["mass"].acceleration)):
            filtered = scipy.signal.sosfiltfilt(sos, history[:, "xyz".index(axis)])[rows]
            assert value == pytest.approx(filtered.std(), rel=0.06)  # flanks of the filter, of a steep response
        assert ratio == pytest.approx(mass / base)


def test_a_payload_that_is_isolated_in_the_whole_band_is_not_said_to_lack_isolation():
    """Of 10 Hz, above which the base vibrates: its transmissibility is below 1 everywhere, and no frequency is crossed."""
    system = sdof(wr.KelvinVoigt(k=STIFFNESS, c=0.1 * math.sqrt(MASS * STIFFNESS)), mass=MASS)
    motion = wr.RandomVibration(psd=[(30.0, 1.0), (100.0, 1.0)], duration=6.0, seed=1, direction="z")
    judged = judged_run(system, motion, wr.simulate(system, motion, duration=6.0, timestep=1e-3))
    assert "mass along z isolates throughout the base's band, transmissibility 0." in blocks(judged)["isolation"].text


def test_samples_that_are_too_slow_for_the_base_tell_no_transmissibility():
    """The base's density folds back at half the rate of the samples: at 1.2 times the resonance it read half the ratio."""
    system = sdof(wr.KelvinVoigt(k=STIFFNESS, c=0.1 * math.sqrt(MASS * STIFFNESS)), mass=MASS)
    motion = wr.RandomVibration(psd=[(3.0, 1.0), (200.0, 1.0)], duration=4.0, seed=1, direction="z")
    with pytest.warns(wr.AccuracyWarning, match="samples a second tell nothing above 100 Hz"):
        response = wr.simulate(system, motion, duration=4.0, timestep=1e-3, sample_rate=200.0)
    (statement,) = random_blocks(judged_run(system, motion, response))
    assert "no transmissibility and no bands are stated; the base moves at up to 200 Hz" in statement.text
    assert "Give a `sample_rate` of at least" in statement.text


@pytest.mark.quick
def test_an_isolation_frequency_is_the_last_crossing_of_one():
    frequency = np.geomspace(1.0, 100.0, 400)
    r = frequency / 10.0
    assert isolation_frequency(frequency, np.abs(1.0 / (1.0 - r**2))) == pytest.approx(math.sqrt(2.0) * 10.0, rel=1e-3)
    assert isolation_frequency(np.array([1.0, 2.0, 3.0, 4.0, 6.0]), np.array([2.0, 0.5, 2.0, 0.5, 0.4])) == pytest.approx(
        math.sqrt(12.0)
    )
    folded = isolation_frequency(np.array([1.0, 12.0, 10.0, 20.0]), np.array([1.5, 4.0, 0.5, 0.1]))  # back at a fold
    assert folded == pytest.approx(math.exp(math.log(12.0) + 2.0 / 3.0 * math.log(10.0 / 12.0)))
    assert math.isnan(isolation_frequency(np.array([1.0, 2.0]), np.array([1.5, 1.2])))
    assert math.isnan(isolation_frequency(np.array([1.0, 2.0]), np.array([0.5, 0.2])))


def test_the_payload_moves_as_far_as_its_centre_does(run):
    response = run[0].response
    body = next(body for body in response.scene.bodies if body.name == "mass")
    moved = response.bodies["mass"].position - body.position - response.base.displacement
    # the corners of a body that does not turn move as its centre does; the parabola adds what lies between samples
    assert payload_moves(response).values["displacement_m"] == pytest.approx(np.linalg.norm(moved, axis=1).max(), rel=1e-3)


@pytest.mark.slow
def test_terminal_and_summary_have_transmissibility_dwells_and_how_far_the_payload_moves(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "psd.csv").write_text("frequency [Hz],psd [g^2/Hz]\n5,0.001\n100,0.001\n", encoding="utf-8")
    (tmp_path / "table.csv").write_text("from [Hz],to [Hz],displacement [mm]\n8,11,0.3\n", encoding="utf-8")
    assert main(["shock", "shock_table", "--psd", "psd.csv 8 s z seed 1", "--out", "psd", "--accuracy", "1e-3", "--all"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "Random vibration: block" in text
    assert "isolates from" in text
    assert "The payload moves up to" in text
    content = json.loads((tmp_path / "psd" / "summary.json").read_text(encoding="utf-8"))["content"]
    assert content["transmissibility"]["rows"][0][-1] > 5.0
    assert content["octave-bands"]["rows"]
    assert content["payload-moves"]["values"]["displacement_m"] > 0.0
    assert "Rms accelerations by octave band" in (tmp_path / "psd" / "report.html").read_text(encoding="utf-8")
    words = ["shock_table", "--amplitude-table", "table.csv 2 s z dwell 3 s", "--out", "dwell", "--accuracy", "1e-3", "--all"]
    assert main(["shock", *words]) == 0
    assert "Dwells of 3 s at 1" in capsys.readouterr().out


def test_a_frequency_response_states_its_isolation_frequency_and_is_exported(tmp_path, capsys):
    system = sdof(wr.KelvinVoigt(k=STIFFNESS, c=0.2 * math.sqrt(MASS * STIFFNESS)), mass=MASS)
    result = frequency_response(system, ResponseOptions(accelerations=(1.0, 2.0), start=5.0, stop=30.0), name="linear")
    findings = level_summaries(result)
    expected = pytest.approx(math.sqrt(2.0) * NATURAL, rel=1e-3)  # interpolated between points that lie 2 % apart
    assert [summary.isolation for summary in findings] == [expected, expected]
    content = response_content(result, findings)
    assert "isolates from 14.14 Hz on" in content.verdict.text
    write_frequency_response(result, findings, content, tmp_path / "frf")
    stored = json.loads((tmp_path / "frf" / "frequency_response.json").read_text(encoding="utf-8"))
    assert stored["levels"][1]["isolation_frequency"] == expected
    for name in ("curve.csv", "curve.xlsx"):
        assert main(["export", str(tmp_path / "frf"), str(tmp_path / name)]) == 0
    capsys.readouterr()
    table = np.genfromtxt(tmp_path / "curve.csv", delimiter=",", names=True, usecols=range(6))
    np.testing.assert_array_equal(table["frequency_Hz"][table["level"] == 0.0], result.levels[0].branch.frequency)
    book = openpyxl.load_workbook(tmp_path / "curve.xlsx")
    assert {"summary", "peaks", "samples"} <= set(book.sheetnames)
    assert book["samples"].cell(2, 3).value == pytest.approx(5.0)
    assert book["samples"].cell(1, 3).value == "frequency [Hz]"


def test_a_range_that_ends_before_isolation_says_so():
    system = sdof(wr.KelvinVoigt(k=STIFFNESS, c=0.2 * math.sqrt(MASS * STIFFNESS)), mass=MASS)
    result = frequency_response(system, ResponseOptions(accelerations=(1.0,), start=8.0, stop=13.0))
    content = response_content(result, level_summaries(result))
    (statement,) = [block for block in content.blocks() if block.id == "level-1"]
    assert statement.text == "Level 1 m/s²: transmissibility does not fall below 1 within the range"
    assert "isolates" not in content.verdict.text


def test_a_range_that_begins_beyond_the_isolation_frequency_says_so():
    system = sdof(wr.KelvinVoigt(k=STIFFNESS, c=0.2 * math.sqrt(MASS * STIFFNESS)), mass=MASS)
    result = frequency_response(system, ResponseOptions(accelerations=(1.0,), start=20.0, stop=30.0))
    content = response_content(result, level_summaries(result))
    (statement,) = [block for block in content.blocks() if block.id == "level-1"]
    assert statement.text == "Level 1 m/s²: isolates throughout the range"
