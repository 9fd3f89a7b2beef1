"""Random vibration with the damage of a history: the density that made it comes back, and its file is one that --psd takes."""

import numpy as np
import pytest
from commands import refused

import wirerope_mj as wr
from wirerope_mj.assessment.durability.cycles import equivalent_vibration
from wirerope_mj.cli import main
from wirerope_mj.motions.spectra import equivalent_psd, vibration_response_spectrum

PSD = [(5.0, 1.0), (20.0, 4.0), (100.0, 4.0), (200.0, 0.5)]


@pytest.mark.quick
@pytest.mark.parametrize("method", ["dirlik", "narrow-band"])
@pytest.mark.parametrize("exponent", [4.0, 8.0])
def test_a_density_comes_back_from_its_damage(method, exponent):
    """The damage is that of another integration, by quadrature; the points between the corners are those of the density."""
    frequencies = np.geomspace(5.0, 200.0, 12)
    damage = vibration_response_spectrum(PSD, frequencies).fatigue_damage(exponent, 60.0, method=method)
    points, error = equivalent_psd(frequencies, damage, exponent=exponent, duration=60.0, method=method)
    assert error < 1e-3
    spectrum = vibration_response_spectrum(points, frequencies).fatigue_damage(exponent, 60.0, method=method)
    assert spectrum == pytest.approx(damage, rel=5e-3)
    away = [1, 2, 6, 7, 8]  # from the corners, which lie between the frequencies
    levels = np.array([level for _, level in points])
    assert levels[away] == pytest.approx(wr.motions.psd_level(PSD, frequencies)[away], rel=0.05)


@pytest.mark.quick
def test_twice_the_time_needs_less_by_the_root_of_the_exponent():
    frequencies = np.geomspace(10.0, 80.0, 7)
    damage = vibration_response_spectrum(PSD, frequencies).fatigue_damage(5.0, 60.0)
    once, twice = (np.array(equivalent_psd(frequencies, damage, exponent=5.0, duration=t)[0]) for t in (60.0, 120.0))
    assert twice[:, 1] == pytest.approx(once[:, 1] * 2.0 ** (-2.0 / 5.0), rel=5e-3)


@pytest.fixture(scope="module")
def shaken(tmp_path_factory):
    folder = tmp_path_factory.mktemp("equivalent") / "run"
    psd = [(4.0, 0.2), (60.0, 0.2)]
    motion = wr.RandomVibration(psd=psd, duration=120.0, seed=3, direction="z")
    system = wr.load_system("sdof_shaker")
    wr.simulate(system, motion, duration=120.0, sample_rate=2000.0, timestep=5e-4).save(folder)
    return folder


@pytest.mark.slow
def test_the_base_of_a_run_needs_its_own_density(shaken, tmp_path, capsys):
    """One history's damage scatters: its density is known to 30 % at a frequency, and to 5 % in the mean."""
    assert main([
        "durability", str(shaken), "--exponent", "4", "--equivalent-psd", "base 120 s 5 to 50 Hz z", "--out",
        str(tmp_path / "psd.csv"),
    ]) == 0  # fmt: skip
    assert "do the damage that the run does at base" in " ".join(capsys.readouterr().out.split())
    levels = np.loadtxt(tmp_path / "psd.csv", delimiter=",", skiprows=1)[:, 1] * wr.STANDARD_GRAVITY**2
    assert levels == pytest.approx(0.2, rel=0.4)
    assert levels.mean() == pytest.approx(0.2, rel=0.08)
    motion = wr.motions.spoken.motion_from_phrase("psd", f"{tmp_path / 'psd.csv'} 10 s z seed 1")
    assert motion.duration == 10.0


@pytest.mark.slow
def test_what_is_not_understood_is_named_with_an_example(shaken, capsys):
    for text, said in (
        ("desk 60 s 5 to 50 Hz z", "no body or point 'desk'; it has table, mass"),
        ("mass 60 s z", "one time, two frequencies and one direction"),
        ("mass 60 s 5 to 50 Hz xz", "one time, two frequencies and one direction"),
        ("mass 60 s 5 to 500 Hz z", "a tenth of the sampling rate"),
        ("mass 60 s 5 to 5.1 Hz z", "a third of an octave apart"),
        ("mass 60 5 to 50 Hz z", "has no unit"),
    ):
        message = refused(capsys, "durability", shaken, "--exponent", "4", "--equivalent-psd", text)
        assert said in message
        assert message.rstrip().endswith('It is written like "rack 3600 s 5 to 80 Hz z".')
    assert "`--exponent`" in refused(capsys, "durability", shaken, "--equivalent-psd", "mass 60 s 5 to 50 Hz z")
    assert "equivalent vibration" in refused(capsys, "durability", shaken, "--exponent", "4", "--out", "a.csv")
    system = wr.load_system("sdof_shaker")
    still = wr.simulate(system, wr.HalfSine(peak=1.0, duration=0.011, direction="z"), duration=0.2)
    with pytest.raises(ValueError, match="damage"):
        equivalent_vibration(still, "mass 60 s 5 to 50 Hz x", exponent=4.0)
