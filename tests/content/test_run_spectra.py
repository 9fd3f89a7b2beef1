"""Which spectra of a run are shown, and over which stretch."""

import math

import numpy as np
import pytest
from house import sdof

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.content.run_spectra import run_densities, run_spectra
from wirerope_mj.content.selection import select
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.motions.spectra import power_spectral_density


def test_the_pseudo_velocity_of_a_jump_is_that_of_damped_oscillators():
    """The words name what the spectrum of a pulse of 0.1 ms, a jump but for its length, has: 0.927 at Q = 10."""
    step = wr.VelocityStep(velocity=1.0, direction="z", start=0.02)
    response = wr.simulate(sdof(wr.KelvinVoigt(k=4000.0, c=20.0)), step, duration=0.1, timestep=1e-3)
    spectra = run_spectra(step, response, ["mass"], 1000.0)
    time = np.arange(0.0, 1.0, 1e-5)
    pulse = np.where(time < 1.05e-4, 1.0 / 1.05e-4, 0.0)  # straight lines between samples: half a step more
    found = wr.shock_response_spectrum(time, pulse, [2.0, 5.0, 10.0], q=10.0).pseudo_velocity
    assert isinstance(spectra, Absent)
    assert "0.927 of it at Q = 10 (the jump itself without damping)" in spectra.reason
    assert found == pytest.approx(0.927, rel=5e-3)  # 10 Hz and a pulse of 0.1 ms: less than 0.1 %, and the rounding


def test_an_exported_spectrum_of_the_base_is_that_of_the_report(tmp_path, capsys):
    pulse = wr.HalfSine(peak=150.0, duration=0.011, direction="z", start=0.0203)
    response = wr.simulate(sdof(wr.KelvinVoigt(k=4000.0, c=20.0)), pulse, duration=0.2, timestep=1e-3)
    response.save(tmp_path / "run")
    assert main(["export", str(tmp_path / "run"), str(tmp_path / "s.csv"), "--spectrum", "base"]) == 0
    assert "10000 samples a second hold it within 1 % up to " in capsys.readouterr().out
    table = np.genfromtxt(tmp_path / "s.csv", delimiter=",", skip_header=1)
    with (tmp_path / "s.csv").open(encoding="utf-8") as file:
        lines = table[:, next(n for n, name in enumerate(file.readline().split(",")) if "z/acceleration/maximax" in name)]
    of_report = run_spectra(pulse, response, ["mass"], 1000.0)["z"]["base"]
    np.testing.assert_array_equal(lines, of_report.maximax)
    time = np.arange(0.0, 0.2, 5e-6)
    low = table[:, 0] < 100.0
    exact = wr.shock_response_spectrum(time, pulse.acceleration(time)[:, 2], table[low, 0], q=10.0).maximax
    # straight lines over h take (pi h / T)^2 / 12 off the pulse: 7e-5 at 10 kHz, and 7e-3 at the run's 1 kHz
    np.testing.assert_allclose(lines[low], exact, rtol=3e-4)


def test_densities_begin_where_the_response_has_settled():
    """A base that reaches its level in 0.2 s: 10 Hz with 4 % follow with 2.5 1/s, and settle in three times 0.4 s."""
    stiffness = 3.5 * (2.0 * math.pi * 10.0) ** 2
    system = sdof(wr.KelvinVoigt(k=stiffness, c=2.0 * 0.04 * math.sqrt(3.5 * stiffness)), mass=3.5)
    motion = wr.RandomVibration(psd=[(5.0, 1.0), (50.0, 1.0)], duration=20.0, seed=1, direction="z", rise=0.2, fall=0.2)
    response = wr.simulate(system, motion, duration=20.0, timestep=1e-3, sample_rate=500.0)
    found = run_densities(motion, response, ["mass"])["z"]
    first, falls = motion.steady
    assert found["mass"].duration == found["base"].duration
    # The decay is found from the width of one record's peak: 20 s of 2.5 Hz are known to some 20 %.
    assert falls - first - found["mass"].duration == pytest.approx(1.2, rel=0.3)
    rows = (response.time >= falls - found["mass"].duration - 1e-9) & (response.time < falls)
    later = power_spectral_density(response.time[rows], response.bodies["mass"].acceleration[rows, 2])
    assert found["mass"].rms == pytest.approx(later.rms, rel=1e-6)
    assert run_densities(motion + wr.HalfSine(peak=5.0, duration=0.011, direction="z"), response, ["mass"]) == {}


def test_pictures_last_as_long_as_the_base_moves():
    """A stiff mass barely answers the end of a vibration, and what the base does there is shown all the same."""
    soft = wr.Sine(frequency=30.0, acceleration=10.0, direction="z", duration=0.3)
    late = wr.VibrationLines(acceleration=[(400.0, 10.0)], direction="z", duration=1.2, start=0.3)
    response = wr.simulate(wr.load_system("sdof_shaker"), soft + late, duration=1.7)
    assert select(response).window[1] == pytest.approx(1.5, abs=0.01)
