"""Few break points over the spectrum of a record: above every line, low, as specifications print them, and read back."""

import numpy as np
import pytest
import scipy.signal

from wirerope_mj.cli import main
from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.motions import HalfSine, RandomVibration, load_record, psd_from_g
from wirerope_mj.motions.break_points import R20, break_points, record_envelopes
from wirerope_mj.motions.psd_lines import psd_level, psd_points, spectrum_points
from wirerope_mj.motions.registry import motion_from_phrase

G = 9.80665
NAVMAT = [(20.0, 0.01), (80.0, 0.04), (350.0, 0.04), (2000.0, 0.007)]
TONE = [(10.0, 0.001), (100.0, 0.002), (120.0, 0.05), (140.0, 0.002), (1000.0, 0.0005)]


def written(path, rate, **columns):
    """Write accelerations [g] as a record."""
    time = np.arange(len(next(iter(columns.values())))) / rate
    header = ",".join(["time [s]", *(f"{name} [g]" for name in columns)])
    np.savetxt(path, np.column_stack([time, *columns.values()]), fmt="%.8g", delimiter=",", header=header, comments="")
    return path


@pytest.fixture(scope="module")
def vibration(tmp_path_factory):
    time = np.arange(0.0, 10.0, 1.0 / 5000.0)
    motions = [
        RandomVibration(psd=psd_from_g(points), duration=10.0, seed=seed, direction=axis).acceleration(time)[:, row] / G
        for seed, axis, row, points in ((1, "x", 0, TONE), (2, "z", 2, NAVMAT))
    ]
    return written(tmp_path_factory.mktemp("record") / "deck.csv", 5000.0, x=motions[0], z=motions[1])


@pytest.mark.quick
def test_smooth_specification_gives_its_own_points_back():
    frequencies = np.arange(20.0, 2000.5, 5.0)
    points = break_points(frequencies, psd_level(NAVMAT, frequencies), (20.0, 2000.0), most=8)
    # 80 and 355 Hz are of R20; slopes of 3 dB/octave where the specification's are 3.0 and 3.01
    assert [f for f, _ in points] == [20.0, 80.0, 355.0, 2000.0]
    np.testing.assert_allclose([level for _, level in points], [0.01, 0.04, 0.04, 0.007], rtol=0.06)


@pytest.mark.slow
@pytest.mark.parametrize("most", [2, 3, 5, 8])
@pytest.mark.parametrize("amplitude", [False, True])
def test_no_line_of_any_spectrum_is_above_its_curve(most, amplitude):
    for seed in range(3):
        random = np.random.default_rng(seed)
        frequencies = np.sort(random.uniform(3.0, 900.0, size=random.integers(2, 400)))
        levels = np.exp(np.cumsum(random.normal(size=frequencies.size)) * 0.3 + random.normal(size=frequencies.size))
        levels[random.integers(0, 2, frequencies.size) > 0] *= random.choice([1.0, 0.0, 1e-9])
        levels[-1] = 1.0  # not all of them zero
        band = float(frequencies[0]), float(frequencies[-1])
        points = break_points(frequencies, levels, band, most=most, amplitude=amplitude)
        curve = psd_level(points, frequencies)
        assert np.all(curve >= levels)
        assert 2 <= len(points) <= most
        assert (curve / np.maximum(levels, 1e-300)).min() < 1.012  # it touches, but for the third digit
        assert (points[0][0], points[-1][0]) == band
        f, level = np.array(points).T
        assert all(any(abs(x / 10.0 ** np.floor(np.log10(x)) - r) < 1e-6 for r in R20) for x in f[1:-1])
        decibels = (20.0 if amplitude else 10.0) * np.diff(np.log10(level))
        octaves = np.diff(np.log2(f))
        # whole slopes meet the levels within a quarter of a decibel, and rounding to three digits, 0.087 dB of an amplitude
        assert np.all(np.abs(decibels - octaves * np.round(decibels / octaves)) <= 0.25 + 0.087)


def test_density_of_a_record_is_enveloped_and_read_back(vibration, tmp_path, capsys):
    out = tmp_path / "deck_psd.csv"
    assert main(["levels", "from", str(vibration), "--band", "10 to 1000 Hz", "--resolution", "4", "--out", str(out)]) == 0
    shown = capsys.readouterr().out
    assert "0 of 248 lines from 10 to 1000 Hz exceed it" in shown
    assert 'MODEL --psd "deck_psd_x.csv 60 s x' in shown
    record = np.loadtxt(vibration, delimiter=",", skiprows=1)
    for axis, column in (("x", 1), ("z", 2)):
        points = psd_points(tmp_path / f"deck_psd_{axis}.csv")
        frequencies, density = scipy.signal.welch(record[:, column] * G, fs=5000.0, nperseg=1250)
        rows = (frequencies >= 10.0) & (frequencies <= 1000.0)
        curve = psd_level(points, frequencies[rows])
        assert np.all(curve >= density[rows])
        assert len(points) <= 8
        (envelope,) = (
            e for e in record_envelopes(load_record(vibration), band=(10.0, 1000.0), resolution=4.0) if e.axis == axis
        )
        np.testing.assert_allclose(envelope.points, points, rtol=1e-11)  # a file is read to twelve digits
        assert envelope.exceedances == 0
        # own rms of both, by the trapezoidal rule on a fine grid
        fine = np.linspace(10.0, 1000.0, 200_001)
        own = np.sqrt(np.trapezoid(psd_level(points, fine), fine)), np.sqrt(np.trapezoid(density[rows], frequencies[rows]))
        assert envelope.rms == pytest.approx(own, rel=1e-4)
        assert f"{own[0] / own[1]:.3g} times the measured" in shown
        assert motion_from_phrase("psd", f"deck_psd_{axis}.csv 5 s {axis}", folder=tmp_path).psd == points


@pytest.mark.slow
def test_shock_response_spectrum_of_a_pulse_is_enveloped(tmp_path, capsys):
    time = np.arange(0.0, 0.5, 1.0 / 20_000.0)
    pulse = HalfSine(peak=15.0 * G, duration=0.011, direction="z", start=0.02)
    file = written(tmp_path / "shock.csv", 20_000.0, z=pulse.acceleration(time)[:, 2] / G)
    out = tmp_path / "srs.csv"
    assert (
        main(["levels", "from", str(file), "--srs", "--q", "25", "--points", "4", "--band", "5 to 1000 Hz", "--out", str(out)])
        == 0
    )
    assert 'MODEL --required-spectrum "srs.csv 30 s z damping 2 %"' in capsys.readouterr().out
    points = spectrum_points(out)
    assert len(points) <= 4
    for frequency in np.geomspace(5.0, 1000.0, 20):  # own oscillators, each on a fine grid of its own
        omega, zeta = 2.0 * np.pi * frequency, 0.02
        system = scipy.signal.lti([2.0 * zeta * omega, omega**2], [1.0, 2.0 * zeta * omega, omega**2])
        grid = np.arange(0.0, 0.5, min(1.0 / frequency / 200.0, 2e-5))
        response = scipy.signal.lsim(system, pulse.acceleration(grid)[:, 2], grid)[1]
        # lines are a 24th of an octave apart: between them the smooth spectrum of a pulse rises by less than 0.1 %
        assert np.abs(response).max() <= 1.001 * psd_level(points, frequency)
    with pytest.warns(RecordWarning, match="along z it is a pulse and no vibration"):
        record_envelopes(load_record(file))


@pytest.mark.quick
@pytest.mark.parametrize(("words", "fault"), [
    (["--band", "20 Hz"], "20 to 2000 Hz"), (["--band", "1 to 9000 Hz"], "which the record holds"),
    (["--srs", "--resolution", "2"], "--resolution"), (["--points", "1"], "integer >= 2"), (["--q", "0.2", "--srs"], "> 0.5"),
])  # fmt: skip
def test_what_cannot_be_enveloped_is_refused(tmp_path, capsys, words, fault):
    random = np.random.default_rng(1)
    file = written(tmp_path / "deck.csv", 1000.0, z=random.normal(size=4000))
    assert main(["levels", "from", str(file), *words, "--out", str(tmp_path / "out.csv")]) == 2
    assert fault in capsys.readouterr().err
    assert not (tmp_path / "out.csv").exists()


@pytest.mark.quick
def test_what_is_there_is_kept(tmp_path, capsys):
    file = written(tmp_path / "deck.csv", 1000.0, z=np.random.default_rng(1).normal(size=4000))
    assert main(["levels", "from", str(file), "--out", str(file)]) == 2
    assert "--force replaces it" in capsys.readouterr().err
