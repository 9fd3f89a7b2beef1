"""Faults of a rig, put into made-up records one at a time: each is named with its size, and none in a clean record."""

import numpy as np
import pytest
from rig_records import rig_record, write_record

import wirerope_mj as wr
from wirerope_mj.mounts.test_rig.faults import hum_in, record_faults, without_hum

LAW = wr.BoucWen.from_normalised(z_max=800.0, x_y=2e-3, sigma=0.7, n=1.4, k=5e4)
NI = wr.AsymmetricBoucWen(alpha=4e5, beta=200.0, gamma=60.0, n=1.0, k1=4e4, k2=1e6, k3=2e8, b=1.0, c=1.0)
SIZES = [1e-3, 3e-3, 8e-3]


def said(time, deflection, force):
    return list(record_faults(time, deflection, force))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("law", [LAW, NI])
def test_a_clean_record_has_no_faults(law, seed):
    assert said(*rig_record(law, SIZES, seed=seed, points=400.0)) == []


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


@pytest.mark.parametrize("samples", [6, -6])
def test_a_lag_between_the_channels_is_named_with_its_size(samples):
    time, deflection, force = rig_record(LAW, SIZES, points=400.0)
    (text,) = said(time, deflection, np.interp(time - samples / 400.0, time, force))
    assert ("the force channel lags" in text) == (samples > 0)
    assert float(text.split("by about ")[1].split(" ms")[0]) == pytest.approx(15.0, abs=3.5)  # 0.35 % of the cycle


def test_noise_is_named():
    (text,) = said(*rig_record(LAW, SIZES, points=400.0, noise=0.12))
    assert text.startswith("noise of the force")


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
