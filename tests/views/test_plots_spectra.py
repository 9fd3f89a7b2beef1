"""Pictures of spectra: what the lines are, where the diagonals of the four-way paper lie, and files."""

import math

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.views.plots.spectra import (
    density_figure,
    four_way_figure,
    save_densities,
    save_four_way,
    save_shock_spectra,
    shock_spectra_figure,
)

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY
TIME = np.arange(4001) / 2000.0


def spectra():
    pulse = np.where(TIME < 0.011, 150.0 * np.sin(np.pi * TIME / 0.011), 0.0)
    ringing = 40.0 * np.exp(-8.0 * TIME) * np.sin(2.0 * np.pi * 7.0 * TIME)
    return {"base": wr.shock_response_spectrum(TIME, pulse), "rack": wr.shock_response_spectrum(TIME, ringing)}


def densities():
    rng = np.random.default_rng(1)
    return {name: wr.power_spectral_density(TIME, rng.normal(size=TIME.size)) for name in ("base", "rack")}


def lines(figure):
    return {line.get_label(): line for line in figure.axes[0].lines if not line.get_label().startswith("_")}


def test_four_way_paper_shows_pseudo_velocities():
    shown, drawn = spectra(), lines(four_way_figure(spectra(), title="floor"))
    assert set(drawn) == {"base", "rack"}
    for name, line in drawn.items():
        np.testing.assert_array_equal(line.get_ydata(), shown[name].pseudo_velocity)
        np.testing.assert_array_equal(line.get_xdata(), shown[name].frequencies)


def test_every_labelled_diagonal_goes_through_its_own_label():
    """A displacement d is the pseudo-velocity 2 pi f d, an acceleration a / (2 pi f)."""
    labels = four_way_figure(spectra()).axes[0].texts
    assert {text.get_text().split()[1] for text in labels} == {"mm", "g"}
    for text in labels:
        (f, v), (number, unit) = text.get_position(), text.get_text().split()
        found = v / (2.0 * math.pi * f) / 1e-3 if unit == "mm" else 2.0 * math.pi * f * v / G
        assert found == pytest.approx(float(number), rel=1e-9)
        assert text.get_rotation() == (45.0 if unit == "mm" else 315.0)


def test_accelerations_are_in_g_beside_a_test_spectrum():
    drawn = lines(shock_spectra_figure(spectra(), test=([10.0, 100.0], [G, 10.0 * G])))
    np.testing.assert_allclose(drawn["base"].get_ydata() * G, spectra()["base"].maximax)
    np.testing.assert_allclose(drawn["test spectrum"].get_ydata(), [1.0, 10.0])


def test_densities_say_their_rms():
    found = densities()
    drawn = lines(density_figure(found))
    label = next(label for label in drawn if label.startswith("rack"))
    assert float(label.split()[1]) * G == pytest.approx(float(found["rack"].rms), rel=5e-3)  # three digits
    np.testing.assert_allclose(drawn[label].get_ydata() * G**2, found["rack"].density[1:])


def test_pictures_are_written(tmp_path):
    save_four_way(spectra(), tmp_path / "four_way.svg", title="floor")
    save_shock_spectra(spectra(), tmp_path / "spectra.png")
    save_densities(densities(), tmp_path / "densities.png")
    assert (tmp_path / "four_way.svg").read_text().count("<path") > 10
    for name in ("spectra.png", "densities.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


def test_a_base_that_rests_is_drawn_as_empty_paper(tmp_path):
    still = {"base": wr.shock_response_spectrum(TIME, np.zeros_like(TIME))}
    save_four_way(still, tmp_path / "four_way.png")
    save_shock_spectra(still, tmp_path / "spectra.png")


def test_several_directions_at_once_are_refused():
    three = {"rack": wr.shock_response_spectrum(TIME, np.ones((TIME.size, 3)))}
    with pytest.raises(ValueError, match=r"'rack' must be of one acceleration, got the shape \(\d+, 3\)"):
        four_way_figure(three)
