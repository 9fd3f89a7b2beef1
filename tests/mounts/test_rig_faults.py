"""Faults of a rig, put into made-up records one at a time: each is named with its size, and none in a clean record."""

import re

import numpy as np
import pytest
from rig_faults import DEVICES, LAW, NI, SIZES, foreign_record
from rig_records import rig_record, write_record

import wirerope_mj as wr
from wirerope_mj.mounts.identification.records import loop_warnings
from wirerope_mj.mounts.test_rig.faults import checked_record, hum_in, without_hum
from wirerope_mj.mounts.test_rig.lag import lag_in


def said(time, deflection, force):
    return checked_record(time, deflection, force).faults


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("law", [LAW, NI])
def test_a_clean_record_has_no_faults(law, seed):
    assert said(*rig_record(law, SIZES, seed=seed, points=400.0)) == []


@pytest.mark.slow
@pytest.mark.parametrize("frequency", [50.0, 49.93, 60.02])
def test_hum_is_found_named_and_taken_out(frequency):
    time, deflection, force = rig_record(LAW, SIZES, points=400.0)
    hummed = force + 9.0 * np.sin(2.0 * np.pi * frequency * time + 0.4)
    hum = hum_in(time, hummed)
    assert hum.frequency == pytest.approx(frequency, abs=0.01)
    assert hum.amplitude == pytest.approx(9.0, rel=0.05)
    (text,) = said(time, deflection, hummed)
    assert text.startswith("hum of ")
    assert "taken out" in text
    left = without_hum(time, hummed, hum) - force
    assert np.std(left) < 0.06 * 9.0


def test_a_drift_is_named_with_its_size():
    (text,) = said(*rig_record(LAW, SIZES, points=400.0, drift=120.0))
    size = float(text.split("drifts by ")[1].split(" N")[0])
    assert size == pytest.approx(120.0, rel=0.15)  # the means of hysteretic cycles fade besides


@pytest.mark.parametrize("rate", [37.3, 400.0])
@pytest.mark.parametrize("law", [LAW, NI])
def test_an_offset_is_no_drift(law, rate):
    """The means of cycles that are not whole differ, and so do those of a device that forgets its way to -3 mm."""
    time, deflection, force = rig_record(law, SIZES, points=400.0, operating_point=-3e-3, zero=12.0, noise=0.0)
    even = np.arange(0.0, time[-1] - 0.1, 1.0 / rate)
    assert said(even, np.interp(even, time, deflection), np.interp(even, time, force)) == []


@pytest.mark.slow
@pytest.mark.parametrize("samples", [6, -6])
def test_a_lag_between_the_channels_is_named_with_its_size(samples):
    time, deflection, force = rig_record(LAW, SIZES, points=400.0)
    (text,) = said(time, deflection, np.interp(time - samples / 400.0, time, force))
    assert ("the force channel lags" in text) == (samples > 0)
    error = 10.0 * float(text.split("+- ")[1].split(" %")[0])
    assert float(text.split("by about ")[1].split(" ms")[0]) == pytest.approx(15.0, abs=3.0 * error)
    assert error < 3.0


@pytest.mark.slow
@pytest.mark.parametrize("lag", [0.0, 0.001, -0.004])
@pytest.mark.parametrize("name", DEVICES)
def test_the_lag_of_any_rate_independent_device_is_named_from_a_thousandth_of_a_cycle(name, lag):
    texts = said(*foreign_record(name, lag=lag, noise=0.0))
    if lag == 0.0:
        assert texts == []
        return
    (text,) = texts
    assert ("the force channel lags" in text) == (lag > 0.0)
    assert float(text.split("by about ")[1].split(" ms")[0]) == pytest.approx(1e3 * abs(lag), rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("name", DEVICES)
def test_noise_makes_no_lag_and_hides_none_of_a_hundredth_of_a_cycle(name):
    for seed in range(3):
        assert said(*foreign_record(name, lag=0.0, noise=0.003, seed=seed)) == []
        found = lag_in(*foreign_record(name, lag=0.01, noise=0.003, seed=seed))
        assert found.delay == pytest.approx(0.01, abs=4.0 * found.error)
        assert found.error < 0.002


@pytest.mark.slow
def test_a_lag_of_a_thousandth_is_named_in_most_records_whose_noise_lets_it():
    """Where the window's choice counted noise as bias it was in 10 of these 30."""
    named = [
        any("the force channel lags" in text for text in said(*foreign_record(name, lag=0.001, noise=0.003, seed=seed)))
        for name in ("iwan", "lugre", "bouc-wen")
        for seed in range(10)
    ]
    assert sum(named) >= 15


@pytest.mark.slow
def test_the_least_lag_that_a_record_would_show_grows_with_its_noise():
    least = [checked_record(*rig_record(LAW, SIZES, points=400.0, noise=noise)).least_lag for noise in (0.0, 0.01, 0.02)]
    assert least[0] == pytest.approx(9e-4)  # a thousandth, told to a tenth
    assert least[0] < least[1] < least[2] < 0.02


def test_that_no_lag_can_be_told_is_said_where_reversals_are_too_few(tmp_path):
    few = tmp_path / "few.csv"
    write_record(few, *rig_record(LAW, SIZES, points=400.0, cycles=2))
    loops = wr.load_cycles(few)
    _, said_of = loop_warnings({few: loops}, wr.identify(loops, law=wr.BoucWen, profiles=False))
    assert "a lag between its channels, of whatever size, cannot be told" in said_of[few]


@pytest.mark.slow
def test_noise_is_named():
    (text,) = said(*rig_record(LAW, SIZES, points=400.0, noise=0.12))
    assert text.startswith("noise of the force")


@pytest.mark.slow
def test_the_command_takes_hum_out_and_says_it(tmp_path, capsys):
    from wirerope_mj.cli import main

    time, deflection, force = rig_record(LAW, SIZES, points=400.0)
    hummed = force + 25.0 * np.sin(2.0 * np.pi * 50.0 * time)
    write_record(tmp_path / "hum.csv", time, deflection, hummed)
    write_record(tmp_path / "clean.csv", time, deflection, force)
    fits = [wr.identify(wr.load_cycles(tmp_path / name), law=wr.BoucWen) for name in ("hum.csv", "clean.csv")]
    assert fits[0].residual == pytest.approx(fits[1].residual, rel=0.2)
    code = main(["identify", str(tmp_path / "hum.csv"), "--law", "bouc-wen", "--out", str(tmp_path / "a.toml")])
    printed = " ".join(capsys.readouterr().out.split())
    assert code == 0
    assert "at 50 Hz" in printed
    assert "taken out by a notch" in printed
    page = (tmp_path / "a-report" / "report.html").read_text(encoding="utf-8")
    assert re.search(r"a lag between its channels is named from 0\.\d+ % of a cycle on", page)
