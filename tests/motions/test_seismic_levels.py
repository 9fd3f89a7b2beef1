"""Levels of earthquakes: the numbers of the standards' formulas, and motions whose spectra envelop them."""

import numpy as np
import pytest
import scipy.signal

from wirerope_mj.cli import main
from wirerope_mj.motions.registry import motion_of_levels
from wirerope_mj.motions.target_spectra import ac156_levels, en1998_levels

G = 9.80665


def table(text):
    return np.array([[float(cell) for cell in line.split(",")] for line in text.splitlines()[1:]])


@pytest.mark.quick
@pytest.mark.parametrize(("z_h", "horizontal"), [(0.0, (1.2, 0.48)), (0.2, (1.68, 0.672)), (1.0, (1.92, 1.44))])
def test_ac156_has_the_numbers_of_its_formulas(z_h, horizontal):
    files = ac156_levels(sds=1.2, z_h=z_h)
    frequencies, levels = table(files["ac156_horizontal.csv"]).T
    assert frequencies.tolist() == [1.3, 8.3, 33.3, 50.0]
    np.testing.assert_allclose(levels[[0, 1, 2, 3]], np.take(horizontal, [0, 0, 1, 1]), rtol=1e-5)
    np.testing.assert_allclose(table(files["ac156_vertical.csv"])[[0, 3], 1], [0.67 * 1.2, 0.27 * 1.2], rtol=1e-5)


@pytest.mark.quick
def test_en1998_has_the_numbers_of_its_formulas():
    files = en1998_levels(ag=0.25, ground="C")
    frequencies, levels = table(files["en1998_horizontal.csv"]).T
    plateau = 2.5 * 0.25 * 1.15
    for period, expected in (
        (4.0, plateau * 0.6 * 2.0 / 16.0),
        (1.0, plateau * 0.6),
        (0.3, plateau),
        (0.1, 0.2875 * (1 + 0.5 * 1.5)),
    ):
        assert np.interp(1.0 / period, frequencies, levels) == pytest.approx(expected, rel=3e-3)  # straight between points
    for period, expected in ((0.6, plateau), (0.2, plateau), (2.0, plateau * 0.3)):  # corners
        assert np.interp(1.0 / period, frequencies, levels) == pytest.approx(expected, rel=1e-5)
    frequencies, levels = table(files["en1998_vertical.csv"]).T
    for period, expected in ((0.1, 0.675), (0.3, 0.3375), (0.025, 0.225 * 2.0)):
        assert np.interp(1.0 / period, frequencies, levels) == pytest.approx(expected, rel=3e-3)


@pytest.mark.quick
@pytest.mark.parametrize(("words", "fault"), [
    (["ac156", "--sds", "1.2"], "ac156 needs --z-h"), (["bv_043", "--sds", "1"], "ac156 alone takes --sds"),
    (["en1998", "--ag", "0.2"], "en1998 needs --ground"), (["ac156", "--sds", "1", "--z-h", "2"], "0 and 1"),
    (["ac157"], "there are no levels 'ac157'"),
])  # fmt: skip
def test_numbers_of_another_site_are_refused(tmp_path, monkeypatch, capsys, words, fault):
    monkeypatch.chdir(tmp_path)
    assert main(["levels", *words]) == 2
    assert fault in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.quick
@pytest.mark.parametrize(("name", "first", "second"), [
    ("ac156", ["--sds", "1.2", "--z-h", "1"], ["--sds", "0.4", "--z-h", "0"]),
    ("en1998", ["--ag", "0.25", "--ground", "B"], ["--ag", "0.1", "--ground", "B"]),
])  # fmt: skip
def test_levels_of_two_sites_stand_in_one_folder(tmp_path, name, first, second):
    for stem, site in (("site1", first), ("site 2", second)):
        assert main(["levels", name, *site, "--out", str(tmp_path / f"{stem}.toml")]) == 0
    kinds = ("horizontal", "vertical")
    assert {path.name for path in tmp_path.iterdir()} == {
        *(f"{stem}_{kind}.csv" for stem in ("site1", "site 2") for kind in kinds), "site1.toml", "site 2.toml",
    }  # fmt: skip
    horizontal, weaker = (
        table((tmp_path / f"{stem}_horizontal.csv").read_text(encoding="utf-8"))[:, 1].max() for stem in ("site1", "site 2")
    )
    assert weaker < 0.5 * horizontal
    motion = motion_of_levels(tmp_path / "site 2.toml")
    assert motion.end > 20.0


def spectrum(time, acceleration, frequencies):
    """Find peaks of absolute acceleration of oscillators of 5 % damping by their state-space solution."""
    peaks = []
    for frequency in frequencies:
        omega = 2.0 * np.pi * frequency
        oscillator = scipy.signal.lti([0.1 * omega, omega**2], [1.0, 0.1 * omega, omega**2])
        peaks.append(np.abs(scipy.signal.lsim(oscillator, acceleration, time)[1]).max())
    return np.array(peaks)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 7])
def test_the_motions_envelop_what_is_required(tmp_path, monkeypatch, seed):
    monkeypatch.chdir(tmp_path)
    assert main(["levels", "ac156", "--sds", "1.2", "--z-h", "1"]) == 0
    levels = tmp_path / "ac156.toml"
    text = levels.read_text(encoding="utf-8")
    for number in (3, 2, 1):
        text = text.replace(f"seed {number} ", f"seed {10 * seed + number} ")
    levels.write_text(text, encoding="utf-8")
    motion = motion_of_levels(levels)
    assert motion.end == 30.0
    time = np.arange(0.0, 31.0, 1e-3)
    acceleration = motion.acceleration(time) / G
    frequencies = np.geomspace(1.3, 33.3, 29)  # a sixth of an octave apart
    for axis, kind in enumerate(("horizontal", "horizontal", "vertical")):
        points = table((tmp_path / f"ac156_{kind}.csv").read_text(encoding="utf-8"))
        required = np.exp(np.interp(np.log(frequencies), *np.log(points).T))
        achieved = spectrum(time, acceleration[:, axis], frequencies)
        assert (achieved / required).min() > 0.999
        assert (achieved / required).max() < 1.35
    together = np.corrcoef(acceleration[(time > 5.0) & (time < 25.0)].T)
    assert np.abs(together[np.triu_indices(3, 1)]).max() < 0.3  # independent axes
